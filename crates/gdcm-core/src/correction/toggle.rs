//! What holding or freeing each entry would cost.

use super::branch_and_bound::ProofBudget;
use super::channel::pair_name;
use super::problem::{Problem, ProblemError};
use super::solution::{Outcome, Solution};
use super::solve::solve;
use crate::dataset::Pair;

/// The answer with one entry held that is free now, or freed that is held now.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Toggle {
    /// The entry.
    pub pair: Pair,
    /// Whether it is held now.
    pub held_now: bool,
    /// The least objective without the toggle.
    pub before: f64,
    /// The least objective after it.
    pub after: f64,
    /// How many held entries cannot be matched after it.
    pub unmatched_after: usize,
    /// Whether the entry itself can be matched, if the toggle holds it.
    pub matched_after: bool,
    /// Whether the objective after the toggle is proven.
    pub outcome: Outcome,
}

impl Toggle {
    /// Change of the objective as a share of the objective now; infinite where that is 0 and something changes.
    pub fn share(&self) -> f64 {
        let change = self.after - self.before;
        if change == 0.0 { 0.0 } else { change / self.before }
    }

    /// The cost in words: what is held costs something, what is free would.
    pub fn words(&self, inputs: &[String], outputs: &[String]) -> String {
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

/// Solves `problem` with every entry that has a delta toggled in turn, row by row, until `stop` says so.
///
/// The table for the matrix of entries: to be computed in the background of the live answer `solution`. A shorter list than
/// entries means that it was stopped.
///
/// # Errors
/// As [`solve`].
pub fn toggles(
    problem: &Problem,
    solution: &Solution,
    budget: ProofBudget,
    stop: &dyn Fn() -> bool,
) -> Result<Vec<Toggle>, ProblemError> {
    let mut toggles = Vec::new();
    let mut toggled = problem.clone();
    for (pair, _) in problem.delta.iter().filter(|(_, delta)| delta.is_some()) {
        let held_now = problem.constrained[pair];
        toggled.constrained[pair] = !held_now;
        let after = match solve(&toggled, budget, stop) {
            Err(ProblemError::Stopped) => break,
            after => after?,
        };
        toggled.constrained[pair] = held_now;
        toggles.push(Toggle {
            pair,
            held_now,
            before: solution.objective,
            after: after.objective,
            unmatched_after: after.unmatched.len(),
            matched_after: after.unmatched.iter().all(|miss| miss.pair != pair),
            outcome: after.proof.outcome,
        });
    }
    Ok(toggles)
}
