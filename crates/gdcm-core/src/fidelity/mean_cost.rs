//! J with the mean over frequency, without anything kept.

use std::f64::consts::{PI, TAU};

use pulp::{Arch, Simd, WithSimd};

use crate::response::PolarCurve;

use super::cost::{MAGNITUDE_WEIGHT, PHASE_WEIGHT, SCALE};

/// J of `simulated` against `reference`, on the same frequencies:
/// `J = 20 / N sum_k (W_g e_dB,k^2 + W_p e_deg,k^2)` (M4, M5).
///
/// It is [`super::Mismatch::cost`] with the mean, without gain or delay: distances within a bundle of `n` models take
/// `n (n - 1) / 2` of these for each response, and a dozen operations for each frequency.
pub(super) fn mean_cost(simulated: &PolarCurve, reference: &PolarCurve) -> f64 {
    let [magnitude, phase] = Arch::new().dispatch(SquaredDifferences { simulated, reference });
    let squared_degrees = 180.0 / PI * 180.0 / PI * phase;
    SCALE / simulated.phase.len() as f64 * (MAGNITUDE_WEIGHT * magnitude + PHASE_WEIGHT * squared_degrees)
}

/// The sums over the frequencies of the squared differences of two curves, as many frequencies at once as the processor's
/// vectors hold: of the magnitudes \[dB^2\], and of the principal values of the phases \[rad^2\].
struct SquaredDifferences<'a> {
    simulated: &'a PolarCurve,
    reference: &'a PolarCurve,
}

impl WithSimd for SquaredDifferences<'_> {
    type Output = [f64; 2];

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> [f64; 2] {
        let [mut magnitude, mut phase] = [simd.splat_f64s(0.0); 2];
        let Self { simulated, reference } = self;
        for (a, b) in simulated.magnitude_db.chunks(S::F64_LANES).zip(reference.magnitude_db.chunks(S::F64_LANES)) {
            let error = simd.sub_f64s(simd.partial_load_f64s(a), simd.partial_load_f64s(b));
            magnitude = simd.mul_add_e_f64s(error, error, magnitude);
        }
        for (a, b) in simulated.phase.chunks(S::F64_LANES).zip(reference.phase.chunks(S::F64_LANES)) {
            // Lanes past the end hold zero, which adds nothing.
            let error = principal(simd, simd.sub_f64s(simd.partial_load_f64s(a), simd.partial_load_f64s(b)));
            phase = simd.mul_add_e_f64s(error, error, phase);
        }
        [simd.reduce_sum_f64s(magnitude), simd.reduce_sum_f64s(phase)]
    }
}

/// The principal value in (-pi, pi] of a difference of two.
#[inline(always)]
fn principal<S: Simd>(simd: S, difference: S::f64s) -> S::f64s {
    let (turn, zero) = (simd.splat_f64s(TAU), simd.splat_f64s(0.0));
    let above = simd.greater_than_f64s(difference, simd.splat_f64s(PI));
    let below = simd.less_than_or_equal_f64s(difference, simd.splat_f64s(-PI));
    let less = simd.sub_f64s(difference, simd.select_f64s(above, turn, zero));
    simd.add_f64s(less, simd.select_f64s(below, turn, zero))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fidelity::{CostAverage, Mismatch};
    use crate::response::{GainDelay, wrap};

    #[test]
    fn it_is_the_cost_of_the_mismatch_with_the_mean() {
        let curve = |seed: f64| PolarCurve {
            magnitude_db: (0..53).map(|k| 20.0 * (seed + 0.3 * f64::from(k)).sin()).collect(),
            phase: (0..53).map(|k| wrap(seed - 0.4 * seed * f64::from(k))).collect(),
        };
        for (a, b) in [(0.1, 0.2), (-3.0, 2.0), (1.0, 1.0), (3.1, -3.1)].map(|(a, b)| (curve(a), curve(b))) {
            let expected = Mismatch::new(&a, &b).cost(&[0.0; 53], GainDelay::NONE, CostAverage::Mean).total();
            let found = mean_cost(&a, &b);
            // The same sums of 53 squares in another order.
            assert!((found - expected).abs() <= 1e-13 * expected, "{found} {expected}");
        }
    }
}
