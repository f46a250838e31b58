//! What a qualification asks of a model (M17): bandwidth and phase delay, time histories within tolerances, modes, summary costs.
//!
//! J says how far two models are apart; whoever accepts a simulator or a flight control law asks other questions. Each is answered
//! of one model here; nothing of it changes a correction. Times in s, frequencies in rad/s, angles inside in rad. A response is taken
//! exactly (models) or interpolated inside its frequencies (measured); nothing is extrapolated.
//!
//! | file | answers | standard |
//! |---|---|---|
//! | `bandwidth` | bandwidth, phase delay | ADS-33E-PRF 3.3.2, 3.4.1; MIL-DTL-32742 |
//! | `mode_comparison`, `mode_tolerance`, `mode_name` | modes | 14 CFR part 60, appendix C, table C2A, 2.c.3.a, 2.d.3.a |
//! | `summary` | J, rms in time, Theil's coefficients, MUAD | MIL-STD-1797A, appendix A, 4.2.1.2 |
//! | `tolerance`, `tolerance_check` | time histories within tolerances | 14 CFR part 60, appendix C, table C2A; CS-FSTD(H) |

mod attitude_response;
mod bandwidth;
mod bandwidth_deviation;
#[cfg(test)]
mod bandwidth_tests;
#[cfg(test)]
mod known_answers_tests;
mod level_boundary;
mod mode_comparison;
mod mode_name;
#[cfg(test)]
mod mode_tests;
mod mode_tolerance;
mod sampled_model;
mod summary;
mod test_input;
mod tolerance;
mod tolerance_check;
#[cfg(test)]
mod tolerance_tests;

pub use attitude_response::*;
pub use bandwidth::*;
pub use bandwidth_deviation::*;
pub use level_boundary::*;
pub use mode_comparison::*;
pub use mode_name::*;
pub use mode_tolerance::*;
pub use sampled_model::*;
pub use summary::*;
pub use test_input::*;
pub use tolerance::*;
pub use tolerance_check::*;
