//! The price of holding or freeing one entry.

use super::channel::pair_name;
use crate::dataset::Pair;

/// One toggle, in objectives.
pub(crate) struct Price {
    pub(crate) pair: Pair,
    pub(crate) held_now: bool,
    pub(crate) matched_after: bool,
    pub(crate) before: f64,
    pub(crate) after: f64,
}

impl Price {
    /// Change of the objective as a share of the objective now; infinite where that is 0 and something changes.
    pub(crate) fn share(&self) -> f64 {
        let change = self.after - self.before;
        if change == 0.0 { 0.0 } else { change / self.before }
    }

    /// The price in words: what is held costs something, what is free would.
    pub(crate) fn words(&self, inputs: &[String], outputs: &[String]) -> String {
        let pair = pair_name(self.pair, inputs, outputs);
        // Without the sum, no change would read -0.0.
        let percent = 100.0 * self.share() + 0.0;
        match (self.held_now, self.matched_after) {
            (true, _) if self.after <= self.before => {
                format!("holding {pair} costs {:.1} % of the objective", 0.0 - percent)
            }
            (true, _) => {
                format!("freeing {pair} would raise the objective by {percent:.1} %: others are then held better")
            }
            (false, true) => format!("holding {pair} would change the objective by {percent:+.1} %"),
            (false, false) => {
                format!("{pair} cannot be held besides what is held; trying changes the objective by {percent:+.1} %")
            }
        }
    }
}
