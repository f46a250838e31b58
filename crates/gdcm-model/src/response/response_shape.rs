//! A response's magnitude and phase as plotted: unwrapped, aligned and corrected.

use std::sync::Arc;

use nalgebra::Complex;

use super::gain_delay::GainDelay;
use super::phase_unwrapping::{nearest_turn_offset, unwrap, wrap};
use crate::units::ratio_to_db;

/// A response's magnitude and unwrapped phase, for plots (M2).
#[derive(Clone, Debug, PartialEq)]
pub struct ResponseShape {
    /// Magnitude \[dB\] at each frequency; NaN where the value is zero or not finite.
    pub magnitude_db: Arc<[f64]>,
    /// Phase \[deg\] at each frequency; NaN where the value is zero or not finite.
    pub phase_deg: Arc<[f64]>,
}

impl ResponseShape {
    /// Computes magnitude and phase; NaN where a value is zero or not finite. The phase is
    /// principal at the first of the remaining values, then unwrapped (M2).
    pub fn new(values: &[Complex<f64>]) -> Self {
        let finite: Vec<usize> = (0..values.len())
            .filter(|&k| values[k].is_finite() && values[k].norm() > 0.0)
            .collect();
        let mut phase: Vec<f64> = finite.iter().map(|&k| values[k].arg()).collect();
        unwrap(&mut phase);
        let mut magnitude_db = vec![f64::NAN; values.len()];
        let mut phase_deg = vec![f64::NAN; values.len()];
        for (&k, phase) in finite.iter().zip(phase) {
            magnitude_db[k] = ratio_to_db(values[k].norm());
            phase_deg[k] = phase.to_degrees();
        }
        Self {
            magnitude_db: magnitude_db.into(),
            phase_deg: phase_deg.into(),
        }
    }

    /// Returns the shape with its phase shifted by whole turns, as close as possible to `reference`
    /// over the first `points` frequencies (M2). Callers pass those up to the end of a band, beyond
    /// which a measured phase may not be informative.
    pub fn phase_aligned(self, reference: &Self, points: usize) -> Self {
        let own = radians(self.phase_deg.iter().take(points));
        let other = radians(reference.phase_deg.iter().take(points));
        let offset = nearest_turn_offset(&own, &other).to_degrees();
        if offset == 0.0 {
            return self;
        }
        Self {
            phase_deg: self.phase_deg.iter().map(|phase| phase + offset).collect(),
            ..self
        }
    }

    /// Returns the shape over the first `points` frequencies; NaN at the others, which a plot
    /// leaves out.
    pub fn first_points(self, points: usize) -> Self {
        if points >= self.phase_deg.len() {
            return self;
        }
        Self {
            magnitude_db: first_values(&self.magnitude_db, points),
            phase_deg: first_values(&self.phase_deg, points),
        }
    }

    /// Returns the shape after a correction in gain, delay and leads (M10, M15.5).
    pub fn corrected(&self, omega: &[f64], correction: GainDelay) -> Self {
        let phase = radians(self.phase_deg.iter());
        Self {
            magnitude_db: correction
                .magnitudes_db(&self.magnitude_db, omega)
                .collect(),
            phase_deg: correction
                .phases(&phase, omega)
                .map(f64::to_degrees)
                .collect(),
        }
    }
}

fn radians<'v>(degrees: impl Iterator<Item = &'v f64>) -> Vec<f64> {
    degrees.map(|degrees| degrees.to_radians()).collect()
}

/// Returns the values with all but the first `points` replaced by NaN.
fn first_values(values: &[f64], points: usize) -> Arc<[f64]> {
    let mut first = values.to_vec();
    first[points..].fill(f64::NAN);
    first.into()
}

/// Wraps a continuous phase \[deg\] to -180 to 180 degrees. The value after each jump becomes NaN,
/// so that a plot shows a gap there instead of a line from edge to edge.
pub fn wrapped_deg(phase_deg: &[f64]) -> Vec<f64> {
    let wrapped: Vec<f64> = phase_deg
        .iter()
        .map(|phase| wrap(phase.to_radians()).to_degrees())
        .collect();
    let mut with_gaps = wrapped.clone();
    for k in 1..wrapped.len() {
        if (wrapped[k] - wrapped[k - 1]).abs() > 180.0 {
            with_gaps[k] = f64::NAN;
        }
    }
    with_gaps
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_phase_is_continuous_across_a_gap() {
        let turned = |degrees: f64| Complex::from_polar(10.0, degrees.to_radians());
        let shape = ResponseShape::new(&[turned(-170.0), Complex::new(0.0, 0.0), turned(170.0)]);
        assert!(shape.magnitude_db[1].is_nan() && shape.phase_deg[1].is_nan());
        // Tolerance: a few roundings of angles of about 3 rad.
        assert!(
            (shape.magnitude_db[2] - 20.0).abs() < 1e-12
                && (shape.phase_deg[2] + 190.0).abs() < 1e-12
        );
    }

    #[test]
    fn a_shape_is_shifted_by_whole_turns_only() {
        let shape = |phase: f64| ResponseShape {
            magnitude_db: [0.0, 0.0].into(),
            phase_deg: [phase, phase].into(),
        };
        let laid = shape(350.0).phase_aligned(&shape(-20.0), usize::MAX);
        assert!((laid.phase_deg[0] + 10.0).abs() < 1e-12);
    }
}
