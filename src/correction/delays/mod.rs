//! The channel delays of the correction, equation (11), with their explanation (M9).

mod conflict;
mod problem;
mod program;
mod remedy;
mod sensitivity;
mod solution;
mod solve;
mod toggle;

pub use conflict::DelayConflict;
pub use problem::{DelayError, DelayProblem};
pub use remedy::DelayRemedy;
pub use sensitivity::{DelayRestraint, DelaySensitivity, delay_sensitivities};
pub use solution::{DelaySolution, UnmatchedDelay};
pub use solve::solve_delays;
pub use toggle::{DelayToggle, delay_toggles};
