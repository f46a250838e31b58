//! A response as it is drawn.

use std::sync::Arc;

use nalgebra::Complex;

use crate::units::ratio_to_db;

use super::gain_delay::GainDelay;
use super::phase::{nearest_turn_offset, unwrap, wrap};

/// Magnitude \[dB\] and unwrapped phase \[deg\] of one response, as they are drawn (M2).
#[derive(Clone, Debug, PartialEq)]
pub struct ResponseShape {
    /// Magnitude \[dB\] at each frequency; a value that is not finite leaves a gap.
    pub magnitude_db: Arc<[f64]>,
    /// Phase \[deg\] at each frequency; a value that is not finite leaves a gap.
    pub phase_deg: Arc<[f64]>,
}

impl ResponseShape {
    /// The phase is principal at the first finite value, then unwrapped; a value that is not finite leaves a gap (M2).
    pub fn of(values: &[Complex<f64>]) -> Self {
        let finite: Vec<usize> =
            (0..values.len()).filter(|&k| values[k].is_finite() && values[k].norm() > 0.0).collect();
        let mut phase: Vec<f64> = finite.iter().map(|&k| values[k].arg()).collect();
        unwrap(&mut phase);
        let mut shape = (vec![f64::NAN; values.len()], vec![f64::NAN; values.len()]);
        for (&k, phase) in finite.iter().zip(phase) {
            shape.0[k] = ratio_to_db(values[k].norm());
            shape.1[k] = phase.to_degrees();
        }
        Self { magnitude_db: shape.0.into(), phase_deg: shape.1.into() }
    }

    /// The shape moved by whole turns as near to `reference` as they bring it (M2).
    pub fn laid_on(self, reference: &Self) -> Self {
        let radians = |phase: &[f64]| phase.iter().map(|degrees| degrees.to_radians()).collect::<Vec<f64>>();
        let offset = nearest_turn_offset(&radians(&self.phase_deg), &radians(&reference.phase_deg)).to_degrees();
        if offset == 0.0 {
            return self;
        }
        Self { phase_deg: self.phase_deg.iter().map(|phase| phase + offset).collect(), ..self }
    }

    /// The shape after a correction (M10).
    pub fn corrected(&self, omega: &[f64], correction: GainDelay) -> Self {
        let phase: Vec<f64> = self.phase_deg.iter().map(|degrees| degrees.to_radians()).collect();
        Self {
            magnitude_db: correction.magnitudes_db(&self.magnitude_db, omega).collect(),
            phase_deg: correction.phases(&phase, omega).map(f64::to_degrees).collect(),
        }
    }
}

/// A continuous phase \[deg\] between -180 and 180 degrees, with a gap where it jumps, in place of a line from edge to edge.
pub fn wrapped_deg(phase_deg: &[f64]) -> Vec<f64> {
    let wrapped: Vec<f64> = phase_deg.iter().map(|phase| wrap(phase.to_radians()).to_degrees()).collect();
    let jumps = |k: usize| k > 0 && (wrapped[k] - wrapped[k - 1]).abs() > 180.0;
    (0..wrapped.len()).map(|k| if jumps(k) { f64::NAN } else { wrapped[k] }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_gap_leaves_a_gap_and_the_phase_goes_on_behind_it() {
        let turned = |degrees: f64| Complex::from_polar(10.0, degrees.to_radians());
        let shape = ResponseShape::of(&[turned(-170.0), Complex::new(0.0, 0.0), turned(170.0)]);
        assert!(shape.magnitude_db[1].is_nan() && shape.phase_deg[1].is_nan());
        // A few roundings of angles of 3 rad.
        assert!((shape.magnitude_db[2] - 20.0).abs() < 1e-12 && (shape.phase_deg[2] + 190.0).abs() < 1e-12);
    }

    #[test]
    fn a_shape_is_moved_by_whole_turns_only() {
        let shape = |phase: f64| ResponseShape { magnitude_db: [0.0, 0.0].into(), phase_deg: [phase, phase].into() };
        let laid = shape(350.0).laid_on(&shape(-20.0));
        assert!((laid.phase_deg[0] + 10.0).abs() < 1e-12);
    }
}
