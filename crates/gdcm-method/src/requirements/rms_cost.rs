//! The weighted rms error in time, `J_rms` (M17.4).
//!
//! ```text
//! J_rms = sqrt(1 / (n_t n_o) sum (y - y^)^T W (y - y^)),   W = 1 in deg/s, deg, ft/s^2, ft/s
//! ```
//!
//! With these weights, 1 deg counts as much as 1 deg/s and 1 ft/s^2.
//!
//! `y` are the flown and `y^` the simulated outputs over `n_t` samples, `n_o` counts the outputs
//! with a weight.
//!
//! Tischler & Remple, "Aircraft and Rotorcraft System Identification", 2nd ed. 2012, 14.3.

use gdcm_model::dataset::Channel;
use gdcm_model::simulation::ValidationWindow;
use gdcm_model::units::physical_unit::{Dimension, PhysicalUnit, conversion_factor};

/// The weighted rms error in time, `J_rms`.
#[derive(Clone, Debug, PartialEq)]
pub struct RmsCost {
    /// `J_rms` \[deg, deg/s, ft/s, ft/s^2\].
    pub value: f64,
    /// Outputs without a weight, by index: their units are unknown, or not those of an angle, an
    /// angular rate, a speed or an acceleration.
    pub left_out: Vec<usize>,
}

impl RmsCost {
    /// Computes the cost over all samples of `windows`; `None` without samples, or if no output has
    /// a weight.
    pub fn compute(windows: &[ValidationWindow], outputs: &[Channel]) -> Option<Self> {
        let mut counted: Vec<WeightedOutput> = Vec::new();
        let mut left_out = Vec::new();
        for (output, channel) in outputs.iter().enumerate() {
            match unit_factor(&channel.unit) {
                Some(factor) => counted.push(WeightedOutput { output, factor }),
                None => left_out.push(output),
            }
        }
        let mut sum = 0.0;
        // n_t n_o, if every window has all outputs.
        let mut count = 0;
        for window in windows {
            for &WeightedOutput { output, factor } in &counted {
                if output < window.measured.ncols() {
                    let error = window.measured.column(output) - window.simulated.column(output);
                    sum += factor * factor * error.norm_squared();
                    count += error.len();
                }
            }
        }
        if count == 0 {
            return None;
        }
        Some(Self {
            value: (sum / count as f64).sqrt(),
            left_out,
        })
    }
}

/// An output that counts in `J_rms`.
struct WeightedOutput {
    output: usize,
    /// Factor from the output's unit to deg, deg/s, ft/s or ft/s^2.
    factor: f64,
}

/// Returns the factor from a unit to deg, deg/s, ft/s or ft/s^2; `None` for any other unit.
fn unit_factor(unit: &str) -> Option<f64> {
    let counted = match PhysicalUnit::parse(unit)?.dimension {
        Dimension::Angle => "deg",
        Dimension::AngularRate => "deg/s",
        Dimension::Speed => "ft/s",
        Dimension::Acceleration => "ft/s^2",
        _ => return None,
    };
    conversion_factor(unit, counted)
}

#[cfg(test)]
mod tests {
    use nalgebra::DMatrix;

    use super::*;

    /// A window with three outputs, stored one after the other.
    fn window(measured: &[f64], simulated: &[f64]) -> ValidationWindow {
        let samples = measured.len() / 3;
        ValidationWindow {
            record: 0,
            start_s: 0.0,
            sample_time_s: 0.1,
            measured: DMatrix::from_column_slice(samples, 3, measured),
            simulated: DMatrix::from_column_slice(samples, 3, simulated),
        }
    }

    fn outputs() -> [Channel; 3] {
        [("P", "deg/s"), ("NZ", "m/s^2"), ("T", "N")].map(|(name, unit)| Channel::new(name, unit))
    }

    #[test]
    fn a_degree_counts_as_a_foot_a_second_squared() {
        // Errors of 3 deg/s and 1 ft/s^2 in both samples; the force has no weight.
        let windows = [window(
            &[3.0, -3.0, 0.3048, 0.0, 9.0, 9.0],
            &[0.0, 0.0, 0.0, 0.3048, 0.0, 0.0],
        )];
        let cost = RmsCost::compute(&windows, &outputs()).unwrap();
        assert!(
            (cost.value - 5.0_f64.sqrt()).abs() < 1e-13,
            "the root of (9 + 1) / 2: {cost:?}"
        );
        assert_eq!(cost.left_out, [2]);
        assert_eq!(RmsCost::compute(&[], &outputs()), None);
        assert_eq!(RmsCost::compute(&windows, &outputs()[2..]), None);
        let roll_only = ValidationWindow {
            measured: DMatrix::from_column_slice(1, 1, &[2.0]),
            simulated: DMatrix::zeros(1, 1),
            ..windows[0].clone()
        };
        let cost_of_roll = RmsCost::compute(&[roll_only], &outputs()).unwrap();
        assert_eq!(cost_of_roll.value, 2.0, "a missing output is not counted");
        let twice = [windows[0].clone(), windows[0].clone()];
        assert_eq!(
            RmsCost::compute(&twice, &outputs()).unwrap(),
            cost,
            "repeated data do not change a mean"
        );
    }
}
