//! From two models to one gain and one delay for each channel (M6 to M10).

mod bounds;
mod channel;
mod channel_correction;
mod components;
mod conflict;
mod delays;
mod delta;
mod gains;
mod reach;
mod scales;
mod three_digits;

pub use bounds::{delay_upper_s, gain_bounds};
pub use channel::Channel;
pub use channel_correction::ChannelCorrection;
pub use delays::{DelayConflict, DelayError, DelayProblem, DelaySolution, UnmatchedDelay, solve_delays};
pub use delta::{Delta, mismatch_table};
pub use gains::{
    GainBounds, GainConflict, GainError, GainObjective, GainProblem, GainSolution, LocalMinimum, Outcome, ProofBudget,
    UnmatchedGain, solve_gains, solve_gains_until,
};
