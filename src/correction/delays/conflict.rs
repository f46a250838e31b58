//! Why held delays cannot all be held, and what would help.

use crate::correction::channel::{Channel, pair_names};
use crate::correction::conflict::{Clash, ClashKind};
use crate::correction::three_digits::three_digits_up;
use crate::dataset::Pair;

/// A smallest set of held entries and bounds that cannot hold together. All times in seconds.
#[derive(Clone, Debug, PartialEq)]
pub enum DelayConflict {
    /// The entries ask two channels for a negative delay: phase lead, which no bound allows.
    NeedsLead {
        /// The held entries, of which one must be freed.
        entries: Vec<Pair>,
        /// The channels whose sum is fixed.
        channels: (Channel, Channel),
        /// The lead that the two would have to give together.
        lead_s: f64,
    },
    /// The entries fix the sum of two channel delays above twice the upper bound.
    SumTooGreat {
        /// The held entries, of which one must be freed.
        entries: Vec<Pair>,
        /// The channels whose sum is fixed.
        channels: (Channel, Channel),
        /// The sum that the entries ask for.
        sum_s: f64,
        /// Upper bound as it is.
        bound_s: f64,
        /// Least upper bound that would do, rounded up to three digits.
        upper_s: f64,
    },
    /// The entries fix the difference of two channel delays above the upper bound.
    DifferenceTooGreat {
        /// The held entries, of which one must be freed.
        entries: Vec<Pair>,
        /// The channel with the greater delay.
        greater: Channel,
        /// The channel with the lesser delay.
        lesser: Channel,
        /// The difference that the entries ask for.
        difference_s: f64,
        /// Upper bound as it is.
        bound_s: f64,
        /// Least upper bound that would do, rounded up to three digits.
        upper_s: f64,
    },
    /// The entries form a loop, and their differences disagree: no bound helps.
    Loop {
        /// The held entries, of which one must be freed.
        entries: Vec<Pair>,
        /// By how much the sum round the loop misses 0.
        mismatch_s: f64,
    },
    /// The entries cannot all be held; rounding hides which of them are to blame.
    Unclear {
        /// The held entries.
        entries: Vec<Pair>,
    },
}

impl DelayConflict {
    /// The conflict of a clash whose times are in units of `unit_s`.
    pub(crate) fn new(clash: Clash, unit_s: f64, bound_s: f64) -> Self {
        let entries = clash.entries;
        match clash.kind {
            ClashKind::SumAbove { channels, sum } => {
                let sum_s = sum * unit_s;
                DelayConflict::SumTooGreat { entries, channels, sum_s, bound_s, upper_s: three_digits_up(0.5 * sum_s) }
            }
            ClashKind::SumBelow { channels, sum } => {
                DelayConflict::NeedsLead { entries, channels, lead_s: -sum * unit_s }
            }
            ClashKind::Apart { greater, lesser, difference } => {
                let difference_s = difference * unit_s;
                let upper_s = three_digits_up(difference_s);
                DelayConflict::DifferenceTooGreat { entries, greater, lesser, difference_s, bound_s, upper_s }
            }
            ClashKind::Loop { mismatch } => DelayConflict::Loop { entries, mismatch_s: mismatch * unit_s },
        }
    }

    /// The held entries of the conflict: freeing any one of them resolves it.
    pub fn entries(&self) -> &[Pair] {
        match self {
            DelayConflict::NeedsLead { entries, .. }
            | DelayConflict::SumTooGreat { entries, .. }
            | DelayConflict::DifferenceTooGreat { entries, .. }
            | DelayConflict::Loop { entries, .. }
            | DelayConflict::Unclear { entries } => entries,
        }
    }

    /// The channels whose bounds are in the way; none of a loop.
    pub fn channels(&self) -> Vec<Channel> {
        match *self {
            DelayConflict::NeedsLead { channels, .. } | DelayConflict::SumTooGreat { channels, .. } => {
                vec![channels.0, channels.1]
            }
            DelayConflict::DifferenceTooGreat { greater, lesser, .. } => vec![greater, lesser],
            DelayConflict::Loop { .. } | DelayConflict::Unclear { .. } => Vec::new(),
        }
    }

    /// The conflict and what would resolve it, in words.
    pub fn words(&self, inputs: &[String], outputs: &[String]) -> String {
        let name = |channel: &Channel| format!("tau_{}", channel.name(inputs, outputs));
        let pairs = |entries: &[Pair]| pair_names(entries, inputs, outputs);
        let cannot = |entries: &[Pair]| match entries {
            [_] => format!("{} cannot be held", pairs(entries)),
            [_, _] => format!("{} cannot both be held", pairs(entries)),
            _ => format!("{} cannot all be held", pairs(entries)),
        };
        let free = |entries: &[Pair]| {
            if entries.len() == 1 { "free it" } else { "free one of them" }
        };
        let ms = |seconds: f64| 1e3 * seconds;
        match self {
            DelayConflict::NeedsLead { entries, lead_s, .. } if entries.len() == 1 => {
                format!("{} needs {:.1} ms of lead: a delay cannot give it; free it.", pairs(entries), ms(*lead_s))
            }
            DelayConflict::NeedsLead { entries, channels: (first, second), lead_s } => format!(
                "{}: {} and {} would have to give {:.1} ms of lead together, and a delay cannot; free one of them.",
                cannot(entries),
                name(first),
                name(second),
                ms(*lead_s)
            ),
            DelayConflict::SumTooGreat { entries, channels: (first, second), sum_s, bound_s, upper_s } => format!(
                "{}: {} and {} give at most {:.1} ms together, not {:.1}; set the upper bound to {} s or {}.",
                cannot(entries),
                name(first),
                name(second),
                ms(2.0 * bound_s),
                ms(*sum_s),
                upper_s,
                free(entries)
            ),
            DelayConflict::DifferenceTooGreat { entries, greater, lesser, difference_s, bound_s, upper_s } => format!(
                "{}: {} cannot be {:.1} ms above {} with delays <= {:.1} ms; set the upper bound to {} s or {}.",
                cannot(entries),
                name(greater),
                ms(*difference_s),
                name(lesser),
                ms(*bound_s),
                upper_s,
                free(entries)
            ),
            DelayConflict::Loop { entries, mismatch_s } => {
                format!(
                    "{} form a loop: their delays disagree by {:.1} ms; free one of them.",
                    pairs(entries),
                    ms(mismatch_s.abs())
                )
            }
            DelayConflict::Unclear { entries } => format!("{}; free one of them.", cannot(entries)),
        }
    }
}
