//! Weight `q` for a response at a frequency (step 4 in `physics`, M18.2).
//!
//! ```text
//! s_q = w_p / sqrt(1 + (sd / 0.06)^2)
//! q   = s_q w_gamma min(1, |H^ / R|) / (1 + (e s_q / 10)^2)^(1/4)
//! ```
//!
//! | symbol | meaning |
//! |---|---|
//! | `R`, `H^` | flight response; physics response with parameters and channels of the present pass |
//! | `w_p` | 2 for an on-axis response, otherwise 1 |
//! | `sd` | standard deviation of the identified model's `ln H` |
//! | `w_gamma^2` | weight from the coherence (M4a) |
//! | `e^2` | summand of J: squared errors of `H^` against `R` in dB and deg (M4) |
//!
//! `min(1, |H^ / R|)` keeps a zero of `H^`, where the error `ln(R / H^)` has no limit, from
//! dominating the fit; the last factor does the same for outliers.

use std::f64::consts::LN_10;

use nalgebra::Complex;

use gdcm_model::dataset::Pair;

use super::problem::{PhysicsCondition, PhysicsProblem};
use crate::fidelity::summand;

/// `w_p`: an on-axis response's weight relative to the others.
const ON_AXIS_WEIGHT: f64 = 2.0;
/// Standard deviation of `ln H` that halves `s_q^2`: 0.5 dB in magnitude, 3.4 deg in phase.
const HALVING_DEVIATION: f64 = 0.06;
/// Value of `e s_q` at which `q` is reduced by the factor `2^(-1/4)`; larger errors are reduced
/// further, as outliers. For `s_q = 1` it is an error with J = 100, the limit for an acceptable
/// model (M4).
const OUTLIER_ERROR: f64 = 10.0;

/// Weight factors that do not change between passes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct FixedWeight {
    /// `s_q`; 0 for a response without weight.
    s_q: f64,
    /// Coherence weight `W = w_gamma^2` (M4a).
    coherence: f64,
}

impl FixedWeight {
    /// Returns a response's fixed weights at all frequencies.
    pub(super) fn for_response(
        problem: &PhysicsProblem,
        condition: &PhysicsCondition,
        pair: Pair,
    ) -> Vec<Self> {
        let points = problem.omega.len();
        let coherence = condition
            .coherence
            .as_ref()
            .map(|table| table[pair].on_grid(&table[pair].weights, points));
        let w_p = if problem.on_axis[pair] {
            ON_AXIS_WEIGHT
        } else {
            1.0
        };
        let mut weights = Vec::with_capacity(points);
        for k in 0..points {
            if !condition.usable[pair] {
                weights.push(Self::default());
                continue;
            }
            let deviation = match &condition.deviation {
                Some(table) => table[pair][k],
                None => 0.0,
            };
            weights.push(Self {
                // `max` turns a deviation that is NaN into weight 0.
                s_q: (w_p / (1.0 + (deviation / HALVING_DEVIATION).powi(2)).sqrt()).max(0.0),
                coherence: match &coherence {
                    Some(weights) => weights[k].max(0.0),
                    None => 1.0,
                },
            });
        }
        weights
    }

    /// Returns whether the response has a weight at this frequency.
    pub(super) fn counts(self) -> bool {
        self.s_q > 0.0 && self.coherence > 0.0
    }

    /// Returns `q^2` for the error `error = ln(R / H^)`; 0 where it is not finite.
    pub(super) fn squared(self, error: Complex<f64>) -> f64 {
        let error_db = error.re * 20.0 / LN_10;
        let robust = (1.0
            + summand(error_db, error.im.to_degrees()) * (self.s_q / OUTLIER_ERROR).powi(2))
        .sqrt();
        // |H^ / R|^2, at most 1.
        let scale = (-2.0 * error.re).exp().min(1.0);
        let squared = self.s_q * self.s_q * self.coherence * scale / robust;
        if squared.is_finite() { squared } else { 0.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_response_above_flight_keeps_its_weight_and_one_below_loses_it() {
        let weight = FixedWeight {
            s_q: 1.0,
            coherence: 1.0,
        };
        let above = weight.squared(Complex::new(-0.5, 0.0));
        let below = weight.squared(Complex::new(0.5, 0.0));
        assert!((below / above - (-1.0_f64).exp()).abs() < 1e-15);
        assert_eq!(weight.squared(Complex::new(0.0, 0.0)), 1.0);
        assert_eq!(weight.squared(Complex::new(f64::NAN, 0.0)), 0.0);
    }
}
