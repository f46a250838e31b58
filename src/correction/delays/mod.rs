//! The channel delays of the correction, equation (11), with their explanation (M9).

mod conflict;
mod problem;
mod program;
mod solution;
mod solve;

pub use conflict::DelayConflict;
pub use problem::{DelayError, DelayProblem};
pub use solution::{DelaySolution, UnmatchedDelay};
pub use solve::solve_delays;
