//! Why held entries cannot all be held, and what would help.

use super::channel::{Channel, pair_names};
use super::clash::{ClashKind, Inconsistency};
use super::problem::{Bounds, Problem};
use super::quantity::{Quantity, three_digits_down, three_digits_up};
use crate::dataset::Pair;
use crate::units::{s_to_ms, telling, told_apart};

/// A smallest set of held entries and bounds that cannot hold together: without any one of them the rest can.
#[derive(Clone, Debug, PartialEq)]
pub struct Conflict {
    /// What is held: gains, or delays or signed delays in seconds.
    pub quantity: Quantity,
    /// The held entries: freeing any one of them resolves the conflict.
    pub entries: Vec<Pair>,
    /// The bounds as they are.
    pub bounds: Bounds,
    /// What is in the way.
    pub kind: ConflictKind,
}

/// How held entries and bounds exclude one another. Bounds that would do are rounded to three digits so that they still do.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ConflictKind {
    /// The entries fix what two channels have together above what the upper bound allows both.
    AboveUpper {
        /// The two channels.
        channels: (Channel, Channel),
        /// The product of gains, or the sum of delays, that the entries ask for.
        asked: f64,
        /// Least upper bound that would do.
        upper: f64,
    },
    /// The entries fix what two channels have together below what the lower bound allows both: of delays, phase lead.
    BelowLower {
        /// The two channels.
        channels: (Channel, Channel),
        /// The product of gains, or the (negative) sum of delays, that the entries ask for.
        asked: f64,
        /// Greatest lower bound that would do; none for delays.
        lower: Option<f64>,
    },
    /// The entries fix the ratio of two gains, or the difference of two delays, above what the bounds allow.
    TooFarApart {
        /// The channel with the greater value.
        greater: Channel,
        /// The channel with the lesser value.
        lesser: Channel,
        /// The ratio or the difference that the entries ask for.
        asked: f64,
        /// Least upper bound that would do with the lower bound as it is.
        upper: f64,
        /// Greatest lower bound that would do with the upper bound as it is; none for delays.
        lower: Option<f64>,
    },
    /// The entries form a loop, and what they ask for disagrees: no bound helps.
    Loop {
        /// By how many dB the product round the loop misses 1, or by how many seconds the sum misses 0.
        mismatch: f64,
    },
    /// The entries cannot all be held; rounding hides which of them are to blame.
    Unclear,
}

impl Conflict {
    /// The conflict of `problem` behind a clash of its held entries in its coordinate.
    pub(crate) fn new(clash: Inconsistency, problem: &Problem) -> Self {
        let (quantity, bounds, coordinate) = (problem.quantity, problem.bounds, problem.coordinate());
        let movable = |lower: f64| quantity.has_lower_bound().then(|| three_digits_down(lower));
        let kind = match clash.kind {
            ClashKind::SumAbove { channels, sum } => {
                let upper = three_digits_up(coordinate.value(0.5 * sum));
                ConflictKind::AboveUpper { channels, asked: coordinate.value(sum), upper }
            }
            ClashKind::SumBelow { channels, sum } => {
                let lower = movable(coordinate.value(0.5 * sum));
                ConflictKind::BelowLower { channels, asked: coordinate.value(sum), lower }
            }
            ClashKind::Apart { greater, lesser, difference } => {
                let asked = coordinate.value(difference);
                let upper = three_digits_up(quantity.net(bounds.lower, asked));
                let lower = match quantity {
                    Quantity::Gain(_) => bounds.upper / asked,
                    Quantity::Delay | Quantity::SignedDelay => bounds.upper - asked,
                };
                ConflictKind::TooFarApart { greater, lesser, asked, upper, lower: movable(lower) }
            }
            ClashKind::Loop { mismatch } => ConflictKind::Loop { mismatch: quantity.difference(mismatch, coordinate) },
        };
        Self { quantity, entries: clash.entries, bounds, kind }
    }

    /// The channels whose bounds are in the way; none of a loop.
    pub fn channels(&self) -> Vec<Channel> {
        match self.kind {
            ConflictKind::AboveUpper { channels, .. } | ConflictKind::BelowLower { channels, .. } => {
                vec![channels.0, channels.1]
            }
            ConflictKind::TooFarApart { greater, lesser, .. } => vec![greater, lesser],
            ConflictKind::Loop { .. } | ConflictKind::Unclear => Vec::new(),
        }
    }

    /// Whether a lone entry asks for phase lead, which says everything.
    pub fn is_lone_lead(&self) -> bool {
        self.quantity == Quantity::Delay
            && self.entries.len() == 1
            && matches!(self.kind, ConflictKind::BelowLower { .. })
    }

    /// Whether it is a loop that disagrees by no more than `tolerance`, in dB or in seconds.
    pub(crate) fn agrees_within(&self, tolerance: f64) -> bool {
        matches!(self.kind, ConflictKind::Loop { mismatch } if mismatch.abs() <= tolerance)
    }

    /// A loop that agrees within the tolerance, in words.
    pub fn agreement_words(&self, inputs: &[String], outputs: &[String]) -> String {
        let entries = pair_names(&self.entries, inputs, outputs);
        let (what, mismatch) = match (self.quantity, self.kind) {
            (Quantity::Gain(_), ConflictKind::Loop { mismatch }) => {
                ("ratios", format!("{} dB", telling(mismatch.abs(), 1)))
            }
            (Quantity::Delay | Quantity::SignedDelay, ConflictKind::Loop { mismatch }) => {
                ("delays", format!("{} ms", telling(s_to_ms(mismatch.abs()), 1)))
            }
            _ => return String::new(),
        };
        format!(
            "{entries} form a loop: their {what} agree to {mismatch}, and count as agreeing; each is held at the nearest that does."
        )
    }

    /// The conflict and what would resolve it, in words.
    pub fn words(&self, inputs: &[String], outputs: &[String]) -> String {
        let names = |channels: (Channel, Channel)| {
            let name = |channel: Channel| format!("{}_{}", self.quantity.symbol(), channel.name(inputs, outputs));
            (name(channels.0), name(channels.1))
        };
        let entries = pair_names(&self.entries, inputs, outputs);
        let (cannot, free) = match self.entries.len() {
            1 => (format!("{entries} cannot be held"), "free it"),
            2 => (format!("{entries} cannot both be held"), "free one of them"),
            _ => (format!("{entries} cannot all be held"), "free one of them"),
        };
        let sentence = match self.quantity {
            Quantity::Gain(_) => self.gain_sentence(&entries, names),
            Quantity::Delay => self.delay_sentence(&entries, names),
            Quantity::SignedDelay => self.signed_delay_sentence(&entries, names),
        };
        match self.kind {
            ConflictKind::Loop { .. } => format!("{sentence}; free one of them."),
            ConflictKind::Unclear => format!("{cannot}; free one of them."),
            ConflictKind::BelowLower { .. } if self.quantity == Quantity::SignedDelay => {
                format!("{cannot}: {sentence} or {free}.")
            }
            _ if self.is_lone_lead() => format!("{sentence}; {free}."),
            ConflictKind::BelowLower { lower: None, .. } => format!("{cannot}: {sentence}; {free}."),
            ConflictKind::TooFarApart { lower: Some(_), .. } => format!("{cannot}: {sentence}, or {free}."),
            _ => format!("{cannot}: {sentence} or {free}."),
        }
    }

    fn gain_sentence(&self, entries: &str, names: impl Fn((Channel, Channel)) -> (String, String)) -> String {
        let Bounds { lower: low, upper: high } = self.bounds;
        match self.kind {
            ConflictKind::AboveUpper { channels, asked, upper } => {
                let (first, second) = names(channels);
                let (most, asked) = told_apart(high.powi(2), asked, 3);
                format!(
                    "with gains <= {high:.3} the product {first} {second} is at most {most}, not {asked}; set the upper \
                     bound to {upper}"
                )
            }
            ConflictKind::BelowLower { channels, asked, lower } => {
                let (first, second) = names(channels);
                let ((least, asked), lower) = (told_apart(low.powi(2), asked, 3), lower.unwrap_or(low));
                format!(
                    "with gains >= {low:.3} the product {first} {second} is at least {least}, not {asked}; set the lower \
                     bound to {lower}"
                )
            }
            ConflictKind::TooFarApart { greater, lesser, asked, upper, lower } => {
                let (greater, lesser) = names((greater, lesser));
                let ((most, asked), lower) = (told_apart(high / low, asked, 3), lower.unwrap_or(low));
                format!(
                    "with {greater} <= {high:.3} and {lesser} >= {low:.3} their ratio is at most {most}, not {asked}; set \
                     the upper bound to {upper}, or the lower bound to {lower}"
                )
            }
            ConflictKind::Loop { mismatch } => {
                format!("{entries} form a loop: their ratios disagree by {} dB", telling(mismatch.abs(), 1))
            }
            ConflictKind::Unclear => String::new(),
        }
    }

    fn delay_sentence(&self, entries: &str, names: impl Fn((Channel, Channel)) -> (String, String)) -> String {
        let ms = |seconds: f64| telling(s_to_ms(seconds), 1);
        let ms_apart = |a: f64, b: f64| told_apart(s_to_ms(a), s_to_ms(b), 1);
        match self.kind {
            ConflictKind::BelowLower { asked, .. } if self.entries.len() == 1 => {
                format!("{entries} needs {} ms of lead: a delay cannot give it", ms(-asked))
            }
            ConflictKind::BelowLower { channels, asked, .. } => {
                let ((first, second), lead) = (names(channels), ms(-asked));
                format!("{first} and {second} would have to give {lead} ms of lead together, and a delay cannot")
            }
            ConflictKind::AboveUpper { channels, asked, upper } => {
                let ((first, second), (most, asked)) = (names(channels), ms_apart(2.0 * self.bounds.upper, asked));
                format!(
                    "{first} and {second} give at most {most} ms together, not {asked}; set the upper bound to {upper} s"
                )
            }
            ConflictKind::TooFarApart { greater, lesser, asked, upper, .. } => {
                let ((greater, lesser), (most, asked)) = (names((greater, lesser)), ms_apart(self.bounds.upper, asked));
                format!(
                    "{greater} cannot be {asked} ms above {lesser} with delays <= {most} ms; set the upper bound to {upper} s"
                )
            }
            ConflictKind::Loop { mismatch } => {
                format!("{entries} form a loop: their delays disagree by {} ms", ms(mismatch.abs()))
            }
            ConflictKind::Unclear => String::new(),
        }
    }

    fn signed_delay_sentence(&self, entries: &str, names: impl Fn((Channel, Channel)) -> (String, String)) -> String {
        const HELP: &str = "a larger R_max or a smaller n gives more";
        let ms = |seconds: f64| telling(s_to_ms(seconds), 1);
        let Bounds { lower: low, upper: high } = self.bounds;
        match self.kind {
            ConflictKind::BelowLower { channels, asked, .. } => {
                let (first, second) = names(channels);
                let (most, asked) = told_apart(s_to_ms(-2.0 * low), s_to_ms(-asked), 1);
                format!("R_max lets {first} and {second} give {most} ms of lead together, not {asked}: {HELP},")
            }
            ConflictKind::AboveUpper { channels, asked, upper } => {
                let (first, second) = names(channels);
                let (most, asked) = told_apart(s_to_ms(2.0 * high), s_to_ms(asked), 1);
                format!(
                    "{first} and {second} give at most {most} ms of delay together, not {asked}; set the upper bound to {upper} s"
                )
            }
            ConflictKind::TooFarApart { greater, lesser, asked, upper, .. } => {
                let (greater, lesser) = names((greater, lesser));
                let (most, asked) = told_apart(s_to_ms(high - low), s_to_ms(asked), 1);
                format!(
                    "{greater} cannot be {asked} ms above {lesser}: with at most {} ms of lead and {} ms of delay a channel it is \
                     {most} ms; set the upper bound to {upper} s; {HELP}",
                    ms(-low),
                    ms(high)
                )
            }
            ConflictKind::Loop { .. } | ConflictKind::Unclear => self.delay_sentence(entries, names),
        }
    }
}
