//! How the objective changes if a single entry is toggled: constrained if it is free, released if
//! it is constrained. The problem is solved again for each entry. An entry is a response; if
//! constrained, its channels together give it exactly its delta, the gain or delay that it needs.

use gdcm_model::dataset::Pair;

use super::branch_and_bound::proof_budget::ProofBudget;
use super::problem::{Problem, ProblemError};
use super::solution::{Outcome, Solution};
use super::solve::solve;

/// Effect on the solution if one entry is toggled: a free entry constrained, or a constrained entry
/// released.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Toggle {
    pub pair: Pair,
    /// Whether the entry is constrained before the toggle.
    pub held_now: bool,
    /// Minimum objective before the toggle.
    pub before: f64,
    /// Minimum objective after the toggle.
    pub after: f64,
    /// Count of unmatched entries ([`Solution::unmatched`]) after the toggle.
    pub unmatched_after: usize,
    /// Whether the toggled entry meets its delta after the toggle; true if it was released.
    pub matched_after: bool,
    /// Whether the objective after the toggle is proven.
    pub outcome: Outcome,
}

impl Toggle {
    /// Returns the change in the objective relative to its value before the toggle; infinite if
    /// that value is 0 and the objective changes.
    pub fn share(&self) -> f64 {
        let change = self.after - self.before;
        if change == 0.0 {
            0.0
        } else {
            change / self.before
        }
    }
}

/// Solves `problem` with each entry that has a delta toggled in turn, row by row, until `stop`
/// returns true.
///
/// This is meant to run in the background while `solution` is displayed. If it is stopped, the list
/// does not contain every entry.
///
/// # Errors
/// [`ProblemError`], as in [`solve`]; a stopped solution only ends the list.
pub fn toggles(
    problem: &Problem,
    solution: &Solution,
    budget: ProofBudget,
    stop: &dyn Fn() -> bool,
) -> Result<Vec<Toggle>, ProblemError> {
    let mut toggles = Vec::new();
    let mut toggled = problem.clone();
    for (pair, delta) in problem.delta.iter() {
        if delta.is_none() {
            continue;
        }
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
