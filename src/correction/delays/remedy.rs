//! What would let every held delay be held.

use crate::correction::channel::pair_name;
use crate::correction::remedy::Remedy;
use crate::correction::three_digits::three_digits_up;
use crate::dataset::Pair;

/// Single changes after which every held entry can be held at its `D`; empty where it takes several.
#[derive(Clone, Debug, PartialEq)]
pub struct DelayRemedy {
    /// Least upper bound in seconds that does, rounded up to three digits.
    pub upper_s: Option<f64>,
    /// The held entries of which each, freed alone, does.
    pub free: Vec<Pair>,
}

impl DelayRemedy {
    /// The remedy of the change `remedy`, given in units of `unit_s`.
    pub(crate) fn new(remedy: Remedy, unit_s: f64, bound_s: f64) -> Self {
        let upper_s = remedy.upper.map(|upper| three_digits_up(upper * unit_s).max(bound_s));
        Self { upper_s, free: remedy.free }
    }

    /// The remedies in words; empty where there is none.
    pub fn words(&self, inputs: &[String], outputs: &[String]) -> String {
        let upper = self.upper_s.map(|upper| format!("an upper bound of {upper} s"));
        let free = self.free.iter().map(|&pair| format!("freeing {}", pair_name(pair, inputs, outputs)));
        let ways: Vec<String> = upper.into_iter().chain(free).collect();
        if ways.is_empty() { String::new() } else { format!("Any one of these lets all be held: {}.", ways.join("; ")) }
    }
}
