//! Why held gains cannot all be held, and what would help.

use super::problem::GainBounds;
use crate::correction::channel::{Channel, pair_names};
use crate::correction::conflict::{Clash, ClashKind};
use crate::correction::three_digits::{three_digits_down, three_digits_up};
use crate::dataset::Pair;

/// A smallest set of held entries and bounds that cannot hold together: without any one of them the rest can.
#[derive(Clone, Debug, PartialEq)]
pub enum GainConflict {
    /// The entries fix the product of two channel gains above the square of the upper bound.
    ProductTooGreat {
        /// The held entries, of which one must be freed.
        entries: Vec<Pair>,
        /// The channels whose product is fixed.
        channels: (Channel, Channel),
        /// The product that the entries ask for.
        product: f64,
        /// The bounds as they are.
        bounds: GainBounds,
        /// Least upper bound that would do, rounded up to three digits.
        upper: f64,
    },
    /// The entries fix the product of two channel gains below the square of the lower bound.
    ProductTooSmall {
        /// The held entries, of which one must be freed.
        entries: Vec<Pair>,
        /// The channels whose product is fixed.
        channels: (Channel, Channel),
        /// The product that the entries ask for.
        product: f64,
        /// The bounds as they are.
        bounds: GainBounds,
        /// Greatest lower bound that would do, rounded down to three digits.
        lower: f64,
    },
    /// The entries fix the ratio of two channel gains above that of the bounds.
    RatioTooGreat {
        /// The held entries, of which one must be freed.
        entries: Vec<Pair>,
        /// The channel with the greater gain.
        greater: Channel,
        /// The channel with the lesser gain.
        lesser: Channel,
        /// The ratio that the entries ask for.
        ratio: f64,
        /// The bounds as they are.
        bounds: GainBounds,
        /// Least upper bound that would do with the lower bound as it is, rounded up to three digits.
        upper: f64,
        /// Greatest lower bound that would do with the upper bound as it is, rounded down to three digits.
        lower: f64,
    },
    /// The entries form a loop, and their ratios disagree: no bound helps.
    Loop {
        /// The held entries, of which one must be freed.
        entries: Vec<Pair>,
        /// By how many dB the product round the loop misses 1.
        mismatch_db: f64,
    },
    /// The entries cannot all be held; rounding hides which of them are to blame.
    Unclear {
        /// The held entries.
        entries: Vec<Pair>,
    },
}

/// dB in a natural logarithm.
pub(crate) const DECIBEL: f64 = 20.0 / std::f64::consts::LN_10;

impl GainConflict {
    pub(crate) fn new(clash: Clash, bounds: GainBounds) -> Self {
        let entries = clash.entries;
        match clash.kind {
            ClashKind::SumAbove { channels, sum } => {
                let upper = three_digits_up((0.5 * sum).exp());
                GainConflict::ProductTooGreat { entries, channels, product: sum.exp(), bounds, upper }
            }
            ClashKind::SumBelow { channels, sum } => {
                let lower = three_digits_down((0.5 * sum).exp());
                GainConflict::ProductTooSmall { entries, channels, product: sum.exp(), bounds, lower }
            }
            ClashKind::Apart { greater, lesser, difference } => {
                let ratio = difference.exp();
                let (upper, lower) = (three_digits_up(bounds.lower * ratio), three_digits_down(bounds.upper / ratio));
                GainConflict::RatioTooGreat { entries, greater, lesser, ratio, bounds, upper, lower }
            }
            ClashKind::Loop { mismatch } => GainConflict::Loop { entries, mismatch_db: mismatch * DECIBEL },
        }
    }

    /// The held entries of the conflict: freeing any one of them resolves it.
    pub fn entries(&self) -> &[Pair] {
        match self {
            GainConflict::ProductTooGreat { entries, .. }
            | GainConflict::ProductTooSmall { entries, .. }
            | GainConflict::RatioTooGreat { entries, .. }
            | GainConflict::Loop { entries, .. }
            | GainConflict::Unclear { entries } => entries,
        }
    }

    /// The channels whose bounds are in the way; none of a loop.
    pub fn channels(&self) -> Vec<Channel> {
        match *self {
            GainConflict::ProductTooGreat { channels, .. } | GainConflict::ProductTooSmall { channels, .. } => {
                vec![channels.0, channels.1]
            }
            GainConflict::RatioTooGreat { greater, lesser, .. } => vec![greater, lesser],
            GainConflict::Loop { .. } | GainConflict::Unclear { .. } => Vec::new(),
        }
    }

    /// The conflict and what would resolve it, in words.
    pub fn words(&self, inputs: &[String], outputs: &[String]) -> String {
        let name = |channel: &Channel| format!("k_{}", channel.name(inputs, outputs));
        let pairs = |entries: &[Pair]| pair_names(entries, inputs, outputs);
        let cannot = |entries: &[Pair]| match entries {
            [_] => format!("{} cannot be held", pairs(entries)),
            [_, _] => format!("{} cannot both be held", pairs(entries)),
            _ => format!("{} cannot all be held", pairs(entries)),
        };
        let free = |entries: &[Pair]| {
            if entries.len() == 1 { "free it" } else { "free one of them" }
        };
        match self {
            GainConflict::ProductTooGreat { entries, channels: (first, second), product, bounds, upper } => format!(
                "{}: with gains <= {:.3} the product {} {} is at most {:.3}, not {product:.3}; set the upper bound to {upper} or {}.",
                cannot(entries),
                bounds.upper,
                name(first),
                name(second),
                bounds.upper.powi(2),
                free(entries)
            ),
            GainConflict::ProductTooSmall { entries, channels: (first, second), product, bounds, lower } => format!(
                "{}: with gains >= {:.3} the product {} {} is at least {:.3}, not {product:.3}; set the lower bound to {lower} or {}.",
                cannot(entries),
                bounds.lower,
                name(first),
                name(second),
                bounds.lower.powi(2),
                free(entries)
            ),
            GainConflict::RatioTooGreat { entries, greater, lesser, ratio, bounds, upper, lower } => format!(
                "{}: with {} <= {:.3} and {} >= {:.3} their ratio is at most {:.3}, not {ratio:.3}; set the upper bound to {upper}, \
                 or the lower bound to {lower}, or {}.",
                cannot(entries),
                name(greater),
                bounds.upper,
                name(lesser),
                bounds.lower,
                bounds.upper / bounds.lower,
                free(entries)
            ),
            GainConflict::Loop { entries, mismatch_db } => {
                format!(
                    "{} form a loop: their ratios disagree by {:.1} dB; free one of them.",
                    pairs(entries),
                    mismatch_db.abs()
                )
            }
            GainConflict::Unclear { entries } => format!("{}; free one of them.", cannot(entries)),
        }
    }
}
