//! Stability margin for the loop that a feedback closes: the smallest singular value of `I - K H`
//! (M16.4).

use nalgebra::{Complex, DMatrix};

use gdcm_model::dataset::Pair;
use gdcm_model::response::FrequencyResponse;

use super::coupling_matrices::CouplingMatrices;

/// The loop's stability margin: the smallest singular value of `I - K H`, minimised over frequency.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LoopMargin {
    /// Minimum singular value: 1 without feedback, 0 if a closed-loop pole is at `j omega`.
    pub least: f64,
    pub omega_rad_s: f64,
}

impl LoopMargin {
    /// Margin below which the loop is reported as close to ringing: disturbances at an input are
    /// then amplified more than twofold, because the loop's largest gain there is the reciprocal of
    /// the margin.
    pub const CAUTION: f64 = 0.5;

    /// Returns the minimum over singular values given at `omega` \[rad/s\]; `None` if no value is
    /// finite.
    pub fn find(singular_values: &[f64], omega: &[f64]) -> Option<Self> {
        let mut margin: Option<Self> = None;
        for (&least, &omega_rad_s) in singular_values.iter().zip(omega) {
            let is_smaller = margin.is_none_or(|margin| least < margin.least);
            if least.is_finite() && is_smaller {
                margin = Some(Self { least, omega_rad_s });
            }
        }
        margin
    }

    /// Returns whether the margin is below [`Self::CAUTION`].
    pub fn is_close_to_ringing(&self) -> bool {
        self.least < Self::CAUTION
    }
}

impl CouplingMatrices {
    /// Returns the smallest singular value of `I - K H` at each frequency; NaN if `H` lacks a
    /// fed-back response. The matrix is m x m, at the inputs, where all channels have the same
    /// unit.
    pub fn least_singular_values(&self, physics: &FrequencyResponse) -> Vec<f64> {
        let points = physics.curve(Pair::new(0, 0)).len();
        (0..points)
            .map(|k| self.least_singular_value(physics, k))
            .collect()
    }

    /// Returns the smallest singular value of `I - K H` at frequency index `k`.
    fn least_singular_value(&self, physics: &FrequencyResponse, k: usize) -> f64 {
        let (inputs, outputs) = self.feedback().shape();
        let difference = DMatrix::from_fn(inputs, inputs, |to, from| {
            // Skip responses that are not fed back, since they may be missing.
            let fed: Complex<f64> = (0..outputs)
                .filter(|&output| self.feedback()[(to, output)] != 0.0)
                .map(|output| {
                    physics.curve(Pair::new(output, from))[k] * self.feedback()[(to, output)]
                })
                .sum();
            let unit = if to == from { 1.0 } else { 0.0 };
            -fed + unit
        });
        if difference.iter().any(|entry| !entry.is_finite()) {
            return f64::NAN;
        }
        difference.singular_values().min()
    }
}
