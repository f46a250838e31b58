//! From two models to one gain and one delay for each channel (M6 to M10).
//!
//! [`Delta`] says what each response would want; [`solve_gains`] minimises eq. (7) with a proof of the global minimum,
//! [`solve_delays`] the convex eq. (11). Both explain what cannot be held, what would help, and what each held entry costs.
//! Tables are `[output, input]`, gains are ratios, delays are seconds.

mod channel;
mod channel_correction;
mod components;
mod conflict;
mod delays;
mod delta;
mod gains;
mod multipliers;
mod reach;
mod remedy;
mod scales;
mod three_digits;
mod toggle;

pub use channel::Channel;
pub use channel_correction::ChannelCorrection;
pub use delays::{
    DelayConflict, DelayError, DelayProblem, DelayRemedy, DelayRestraint, DelaySensitivity, DelaySolution, DelayToggle,
    UnmatchedDelay, delay_sensitivities, delay_toggles, solve_delays,
};
pub use delta::{Delta, delay_upper_s, gain_bounds, mismatch_table};
pub use gains::{
    GainBounds, GainConflict, GainError, GainObjective, GainProblem, GainRemedy, GainRestraint, GainSensitivity,
    GainSolution, GainToggle, LocalMinimum, Outcome, ProofBudget, UnmatchedGain, gain_sensitivities, gain_toggles,
    solve_gains, solve_gains_until,
};
