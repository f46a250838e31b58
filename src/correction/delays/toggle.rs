//! What holding or freeing each entry would cost.

use super::problem::{DelayError, DelayProblem};
use super::solution::DelaySolution;
use super::solve::solve_delays;
use crate::correction::toggle::Price;
use crate::dataset::Pair;

/// The delays with one entry held that is free now, or freed that is held now.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DelayToggle {
    /// The entry.
    pub pair: Pair,
    /// Whether it is held now.
    pub held_now: bool,
    /// The least objective (s²) without the toggle.
    pub before: f64,
    /// The least objective (s²) after it.
    pub after: f64,
    /// How many held entries cannot be matched after it.
    pub unmatched_after: usize,
    /// Whether the entry itself can be matched, if the toggle holds it.
    pub matched_after: bool,
}

impl DelayToggle {
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

/// Solves the delays with every entry that has a delta delay toggled in turn, row by row, until `stop` says so.
///
/// A shorter list than entries means that it was stopped.
///
/// # Errors
/// As [`solve_delays`].
pub fn delay_toggles(
    problem: &DelayProblem,
    solution: &DelaySolution,
    stop: &dyn Fn() -> bool,
) -> Result<Vec<DelayToggle>, DelayError> {
    let mut toggles = Vec::new();
    let mut toggled = problem.clone();
    for (pair, _) in problem.wanted_s.iter().filter(|(_, wanted)| wanted.is_some()) {
        if stop() {
            break;
        }
        let held_now = problem.constrained[pair];
        toggled.constrained[pair] = !held_now;
        let after = solve_delays(&toggled)?;
        toggled.constrained[pair] = held_now;
        toggles.push(DelayToggle {
            pair,
            held_now,
            before: solution.objective,
            after: after.objective,
            unmatched_after: after.unmatched.len(),
            matched_after: after.unmatched.iter().all(|miss| miss.pair != pair),
        });
    }
    Ok(toggles)
}
