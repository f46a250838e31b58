//! What would let every held gain be held.

use super::problem::GainBounds;
use crate::correction::channel::pair_name;
use crate::correction::remedy::Remedy;
use crate::correction::three_digits::{three_digits_down, three_digits_up};
use crate::dataset::Pair;

/// Single changes after which every held entry can be held at its `G`; empty where it takes several.
#[derive(Clone, Debug, PartialEq)]
pub struct GainRemedy {
    /// Least upper bound that does, the lower one as it is, rounded up to three digits.
    pub upper: Option<f64>,
    /// Greatest lower bound that does, the upper one as it is, rounded down to three digits.
    pub lower: Option<f64>,
    /// The held entries of which each, freed alone, does.
    pub free: Vec<Pair>,
}

impl GainRemedy {
    /// The remedy of the change `remedy`, given in logarithms.
    pub(crate) fn new(remedy: Remedy, bounds: GainBounds) -> Self {
        // A bound that is not the obstacle stays as it is.
        let upper = remedy.upper.map(|upper| three_digits_up(upper.exp()).max(bounds.upper));
        let lower = remedy.lower.map(|lower| three_digits_down(lower.exp()).min(bounds.lower));
        Self { upper, lower, free: remedy.free }
    }

    /// The remedies in words; empty where there is none.
    pub fn words(&self, inputs: &[String], outputs: &[String]) -> String {
        let upper = self.upper.map(|upper| format!("an upper bound of {upper}"));
        let lower = self.lower.map(|lower| format!("a lower bound of {lower}"));
        let free = self.free.iter().map(|&pair| format!("freeing {}", pair_name(pair, inputs, outputs)));
        let ways: Vec<String> = upper.into_iter().chain(lower).chain(free).collect();
        if ways.is_empty() { String::new() } else { format!("Any one of these lets all be held: {}.", ways.join("; ")) }
    }
}
