//! Qualification criteria for a model (M17): bandwidth and phase delay, time histories within
//! tolerances, modes, summary costs.
//!
//! J measures the distance between two models; accepting a simulator or a flight control law needs
//! other criteria. Each is evaluated here for one model and never changes a correction. Times in s,
//! frequencies in rad/s, internal angles in rad. A response is evaluated exactly (models) or
//! interpolated inside its frequencies (measured), never extrapolated.
//!
//! | file | content | standard |
//! |---|---|---|
//! | `attitude_response`, `sampled_response` | response from which bandwidths are read | |
//! | `bandwidth`, `phase_delay`, `bandwidth_deviation`, `substitution_bar`, `level_boundary` | bandwidth, phase delay, their uncertainty and levels | ADS-33E-PRF 3.3.2, 3.4.1; MIL-DTL-32742 |
//! | `mode_comparison`, `mode_pairing`, `mode_name`, `mode_values`, `mode_tolerance` | modes | 14 CFR part 60, appendix C, table C2A, 2.c.3.a, 2.d.3.a |
//! | `summary`, `rms_cost` | J, rms in time, Theil's coefficients, MUAD | MIL-STD-1797A, appendix A, 4.2.1.2 |
//! | `test_input`, `test_response` | steps and doublets; simulated responses to them | |
//! | `tolerance_table`, `tolerance_check` | time histories within tolerances | 14 CFR part 60, appendix C, table C2A; CS-FSTD(H) |

pub mod attitude_response;
pub mod bandwidth;
mod bandwidth_deviation;
mod bandwidth_metric;
#[cfg(test)]
mod bandwidth_tests;
pub mod level_boundary;
mod level_boundary_error;
pub mod mode_comparison;
#[cfg(test)]
mod mode_comparison_tests;
pub mod mode_name;
pub mod mode_pairing;
mod mode_tolerance;
mod mode_values;
mod phase_delay;
mod positive_number;
pub mod rms_cost;
mod root_search;
pub mod sampled_response;
mod substitution_bar;
pub mod summary;
pub mod test_input;
mod test_response;
pub mod tolerance_check;
#[cfg(test)]
mod tolerance_check_tests;
mod tolerance_table;

pub use attitude_response::AttitudeOutput;
pub use bandwidth::BandwidthRule;
pub use level_boundary::LevelBoundaries;
pub use mode_comparison::{ModeToleranceTable, ModeVerdict};
pub use mode_name::{ModeName, NamedBy};
pub use test_input::{TestInput, TestInputShape};
pub use tolerance_check::{RecordCheck, Tolerance, ToleranceTable};

/// Reference results for M17, from independent code.
#[cfg(test)]
mod known_answers {
    use nalgebra::Complex;
    use serde_json::Value;

    /// Reads the file of reference results.
    pub(super) fn answers() -> Value {
        serde_json::from_str(include_str!(
            "../../../../tests/data/reference/requirements.json"
        ))
        .unwrap()
    }

    /// Returns the number with this name in a case.
    pub(super) fn number(case: &Value, name: &str) -> f64 {
        case[name].as_f64().unwrap()
    }

    /// Returns the attitude responses for the cases in the file of reference results.
    pub(super) fn attitudes() -> [fn(Complex<f64>) -> Complex<f64>; 4] {
        fn second_order(
            gain: f64,
            omega: f64,
            damping: f64,
            delay_s: f64,
            s: Complex<f64>,
        ) -> Complex<f64> {
            gain * omega * omega * (-delay_s * s).exp()
                / (s * (s * s + 2.0 * damping * omega * s + omega * omega))
        }
        [
            |s| second_order(1.2, 2.5, 0.5, 0.09, s),
            |s| second_order(0.8, 3.0, 0.12, 0.05, s),
            |s| 5.0 * (-0.06 * s).exp() / (s * (s + 3.0)) * 400.0 / (s * s + 28.0 * s + 400.0),
            |s| second_order(1.0, 4.0, 0.7, 0.02, s),
        ]
    }
}
