//! Cost J for a mismatch between two responses, eq. (14)-(19): `J = 20 average(W_g e_dB^2) + 20
//! average(W_p e_deg^2)`, where `e_dB` and `e_deg` are the errors in magnitude and phase of a
//! simulated response against its reference at each frequency.

use std::f64::consts::{PI, TAU};

use pulp::{Arch, Simd, WithSimd};
use serde::{Deserialize, Serialize};

use gdcm_model::response::polar_response::PolarCurve;
use gdcm_model::statistics::{mean, median, weighted_median};

/// `W_g`: weight for the squared magnitude error \[dB^2\] (Tischler & Remple 2012, chapter 11).
const MAGNITUDE_WEIGHT: f64 = 1.0;
/// `W_p`: weight for the squared phase error \[deg^2\].
const PHASE_WEIGHT: f64 = 0.0175;
/// J up to which a model is acceptable (Tischler & Remple, "Aircraft and Rotorcraft System
/// Identification", 2nd ed. 2012, chapter 11; given for the mean over frequency).
pub const ACCEPTABLE: f64 = 100.0;

/// Common factor in both parts of J.
const COST_SCALE: f64 = 20.0;

/// Returns the summand of J at a single frequency, before averaging: `20 (W_g e_dB^2 + W_p
/// e_deg^2)` (M4).
pub fn summand(error_db: f64, error_deg: f64) -> f64 {
    COST_SCALE * (MAGNITUDE_WEIGHT * error_db * error_db + PHASE_WEIGHT * error_deg * error_deg)
}

/// How the squared errors are averaged over frequency.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum CostAverage {
    /// The median (eq. (14) to (19)).
    Median,
    /// The mean (Tischler's original).
    Mean,
}

impl CostAverage {
    /// Averages the squared errors, weighted by M4a if `weights` is given; overwrites `squares`.
    fn average(self, squares: &mut [f64], weights: Option<&[f64]>) -> f64 {
        match (self, weights) {
            (CostAverage::Median, None) => median(squares),
            (CostAverage::Mean, None) => mean(squares),
            (CostAverage::Median, Some(weights)) => weighted_median(squares, weights),
            // Divided by the frequency count, not by the summed weights: Tischler's form.
            (CostAverage::Mean, Some(weights)) => {
                for (square, weight) in squares.iter_mut().zip(weights) {
                    *square *= weight;
                }
                mean(squares)
            }
        }
    }
}

/// Both parts of J; `J = J_mag + J_phase` (M4). With weights the average is weighted (M4a).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cost {
    /// `J_mag = 20 W_g average(e_dB^2)`.
    pub magnitude: f64,
    /// `J_phase = 20 W_p average(e_deg^2)`.
    pub phase: f64,
}

impl Cost {
    /// Computes J from the magnitude errors \[dB\] and the phase errors \[rad\] at each frequency.
    ///
    /// `weights` has a weight for each frequency; `None` where all weights are equal.
    pub fn from_errors(
        magnitude_error_db: impl Iterator<Item = f64>,
        phase_error: impl Iterator<Item = f64>,
        weights: Option<&[f64]>,
        average: CostAverage,
    ) -> Self {
        let mut squares: Vec<f64> = magnitude_error_db.map(|error| error * error).collect();
        let magnitude = COST_SCALE * MAGNITUDE_WEIGHT * average.average(&mut squares, weights);
        squares.clear();
        squares.extend(phase_error.map(f64::to_degrees).map(|error| error * error));
        let phase = COST_SCALE * PHASE_WEIGHT * average.average(&mut squares, weights);
        Self { magnitude, phase }
    }

    /// Returns the factors `20 W_g` and `20 W_p` in front of the averaged squared errors, as text.
    pub fn factors() -> [String; 2] {
        [MAGNITUDE_WEIGHT, PHASE_WEIGHT].map(|weight| format!("{COST_SCALE} · {weight}"))
    }

    /// Returns the averaged squared errors \[dB^2, deg^2\].
    pub fn averages(self) -> [f64; 2] {
        [
            self.magnitude / (COST_SCALE * MAGNITUDE_WEIGHT),
            self.phase / (COST_SCALE * PHASE_WEIGHT),
        ]
    }

    /// Returns `J = J_mag + J_phase`.
    pub fn total(self) -> f64 {
        self.magnitude + self.phase
    }
}

/// Computes J for `simulated` against `reference`, on the same `N` frequencies: `J = 20 / N sum_k
/// (W_g e_dB,k^2 + W_p e_deg,k^2)` (M4, M5).
///
/// Equals [`super::mismatch::Mismatch::cost`] with the mean, without gain or delay. Separate for
/// speed: distances within a bundle with `n` models evaluate it `n (n - 1) / 2` times per response,
/// a dozen operations per frequency.
pub(super) fn mean_cost(simulated: &PolarCurve, reference: &PolarCurve) -> f64 {
    let [magnitude, phase] = Arch::new().dispatch(SquaredDifferences {
        simulated,
        reference,
    });
    let squared_degrees = 180.0 / PI * 180.0 / PI * phase;
    COST_SCALE / simulated.phase.len() as f64
        * (MAGNITUDE_WEIGHT * magnitude + PHASE_WEIGHT * squared_degrees)
}

/// Squared differences between two curves, summed over the frequencies, vectorised (SIMD):
/// magnitudes \[dB^2\] and the phases' principal values \[rad^2\].
struct SquaredDifferences<'a> {
    simulated: &'a PolarCurve,
    reference: &'a PolarCurve,
}

impl WithSimd for SquaredDifferences<'_> {
    type Output = [f64; 2];

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> [f64; 2] {
        let [mut magnitude, mut phase] = [simd.splat_f64s(0.0); 2];
        let Self {
            simulated,
            reference,
        } = self;
        for (a, b) in simulated
            .magnitude_db
            .chunks(S::F64_LANES)
            .zip(reference.magnitude_db.chunks(S::F64_LANES))
        {
            let error = simd.sub_f64s(simd.partial_load_f64s(a), simd.partial_load_f64s(b));
            magnitude = simd.mul_add_e_f64s(error, error, magnitude);
        }
        for (a, b) in simulated
            .phase
            .chunks(S::F64_LANES)
            .zip(reference.phase.chunks(S::F64_LANES))
        {
            // Lanes past the end are zero and add nothing.
            let error = principal(
                simd,
                simd.sub_f64s(simd.partial_load_f64s(a), simd.partial_load_f64s(b)),
            );
            phase = simd.mul_add_e_f64s(error, error, phase);
        }
        [simd.reduce_sum_f64s(magnitude), simd.reduce_sum_f64s(phase)]
    }
}

/// Returns the principal value in (-pi, pi] for the difference between two principal values.
#[inline(always)]
fn principal<S: Simd>(simd: S, difference: S::f64s) -> S::f64s {
    let turn = simd.splat_f64s(TAU);
    let zero = simd.splat_f64s(0.0);
    let above = simd.greater_than_f64s(difference, simd.splat_f64s(PI));
    let below = simd.less_than_or_equal_f64s(difference, simd.splat_f64s(-PI));
    let less = simd.sub_f64s(difference, simd.select_f64s(above, turn, zero));
    simd.add_f64s(less, simd.select_f64s(below, turn, zero))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_constant_error_has_the_cost_of_the_definition() {
        let magnitude = [2.0; 5].into_iter();
        let phase = [0.1; 5].into_iter();
        let cost = Cost::from_errors(magnitude, phase, None, CostAverage::Median);
        assert_eq!(cost.magnitude, 80.0);
        // By hand: 20 * 0.0175 * (18 / pi)^2 = 11.48966...; the tolerance covers a few rounding
        // errors.
        assert!((cost.phase - 0.35 * (18.0 / std::f64::consts::PI).powi(2)).abs() < 1e-12);
    }

    #[test]
    fn the_median_ignores_a_bad_frequency_and_the_mean_does_not() {
        let [median, mean] = [CostAverage::Median, CostAverage::Mean].map(|average| {
            let magnitude = [1.0, 1.0, 10.0].into_iter();
            let phase = [0.0; 3].into_iter();
            Cost::from_errors(magnitude, phase, None, average).total()
        });
        assert_eq!(median, 20.0);
        assert_eq!(mean, 680.0);
    }

    #[test]
    fn weights_are_tischlers_in_the_mean_and_a_weighted_median_in_the_median() {
        let [median, mean] = [CostAverage::Median, CostAverage::Mean].map(|average| {
            let magnitude = [1.0, 3.0, 2.0].into_iter();
            let phase = [0.0; 3].into_iter();
            Cost::from_errors(magnitude, phase, Some(&[0.5, 1.0, 0.25]), average).total()
        });
        // 20 / 3 (0.5 + 9 + 1).
        assert!((mean - 70.0).abs() < 1e-13);
        // Weights 0.5, 0.25, 1 of the squares 1, 4, 9: the cumulative weight exceeds 1.75 / 2 only
        // at 9.
        assert_eq!(median, 180.0);
    }
}

#[cfg(test)]
mod mean_cost_tests {
    use gdcm_model::response::{GainDelay, wrap};

    use super::{CostAverage, *};
    use crate::fidelity::mismatch::Mismatch;

    fn curve(seed: f64) -> PolarCurve {
        PolarCurve {
            magnitude_db: (0..53)
                .map(|k| 20.0 * (seed + 0.3 * f64::from(k)).sin())
                .collect(),
            phase: (0..53)
                .map(|k| wrap(seed - 0.4 * seed * f64::from(k)))
                .collect(),
        }
    }

    #[test]
    fn it_is_the_cost_of_the_mismatch_with_the_mean() {
        for seeds in [[0.1, 0.2], [-3.0, 2.0], [1.0, 1.0], [3.1, -3.1]] {
            let [a, b] = seeds.map(curve);
            let expected = Mismatch::new(&a, &b)
                .cost(&[0.0; 53], GainDelay::NONE, CostAverage::Mean)
                .total();
            let found = mean_cost(&a, &b);
            // The 53 squares are summed in another order.
            assert!(
                (found - expected).abs() <= 1e-13 * expected,
                "{found} {expected}"
            );
        }
    }
}
