//! What holding or freeing each entry would cost.

use super::problem::{GainError, GainProblem};
use super::solution::{GainSolution, Outcome, ProofBudget};
use super::solve::solve_gains_until;
use crate::correction::toggle::Price;
use crate::dataset::Pair;

/// The gains with one entry held that is free now, or freed that is held now.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GainToggle {
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

impl GainToggle {
    /// Change of the objective as a share of the objective now; infinite where that is 0 and something changes.
    pub fn share(&self) -> f64 {
        self.price().share()
    }

    /// The cost in words: what is held costs something, what is free would.
    pub fn words(&self, inputs: &[String], outputs: &[String]) -> String {
        self.price().words(inputs, outputs)
    }

    fn price(&self) -> Price {
        let Self { pair, held_now, matched_after, before, after, .. } = *self;
        Price { pair, held_now, matched_after, before, after }
    }
}

/// Solves the gains with every entry that has a delta gain toggled in turn, row by row, until `stop` says so.
///
/// The table for the matrix of entries: to be computed in the background of the live answer `solution`. A shorter list than
/// entries means that it was stopped.
///
/// # Errors
/// As [`super::solve_gains`].
pub fn gain_toggles(
    problem: &GainProblem,
    solution: &GainSolution,
    budget: ProofBudget,
    stop: &dyn Fn() -> bool,
) -> Result<Vec<GainToggle>, GainError> {
    let mut toggles = Vec::new();
    let mut toggled = problem.clone();
    for (pair, _) in problem.wanted.iter().filter(|(_, wanted)| wanted.is_some()) {
        let held_now = problem.constrained[pair];
        toggled.constrained[pair] = !held_now;
        let after = solve_gains_until(&toggled, budget, stop)?;
        toggled.constrained[pair] = held_now;
        if stop() {
            break;
        }
        toggles.push(GainToggle {
            pair,
            held_now,
            before: solution.objective,
            after: after.objective,
            unmatched_after: after.unmatched.len(),
            matched_after: after.unmatched.iter().all(|miss| miss.pair != pair),
            outcome: after.outcome,
        });
    }
    Ok(toggles)
}
