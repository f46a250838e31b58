//! The channel gains of the correction, equation (7), with their proof and their explanation (M8).

mod conflict;
mod landscape;
mod problem;
mod remedy;
mod sensitivity;
mod solution;
mod solve;
mod toggle;

pub use conflict::GainConflict;
pub use problem::{GainBounds, GainError, GainObjective, GainProblem};
pub use remedy::GainRemedy;
pub use sensitivity::{GainRestraint, GainSensitivity, gain_sensitivities};
pub use solution::{GainSolution, LocalMinimum, Outcome, ProofBudget, UnmatchedGain};
pub use solve::{solve_gains, solve_gains_until};
pub use toggle::{GainToggle, gain_toggles};
