//! J with the mean over frequency, without anything kept.

use std::f64::consts::{PI, TAU};

use pulp::{Arch, Simd, WithSimd};

use crate::response::{PolarCurve, centred_unwrap};

use super::cost::{MAGNITUDE_WEIGHT, PHASE_WEIGHT, SCALE};

/// Measures J of many pairs of curves, `J = 20 / N sum_k (W_g e_dB,k^2 + W_p e_deg,k^2)` (M4, M5).
///
/// It is [`super::Mismatch::cost`] with the mean, without gain or delay, in the same memory for every pair: distances within
/// a bundle of `n` models take `n (n - 1) / 2` of these for each response, and a dozen operations for each frequency.
#[derive(Debug, Default)]
pub(super) struct MeanCost {
    phase: Vec<f64>,
    scratch: Vec<f64>,
}

impl MeanCost {
    /// J of `simulated` against `reference`, on the same frequencies.
    pub(super) fn of(&mut self, simulated: &PolarCurve, reference: &PolarCurve) -> f64 {
        let count = simulated.phase.len();
        self.phase.resize(count, 0.0);
        let differences = Differences { simulated, reference, phase: &mut self.phase };
        let Sums { magnitude, mut phase, spread } = Arch::new().dispatch(differences);
        if spread > PI {
            centred_unwrap(&mut self.phase, &mut self.scratch);
            phase = self.phase.iter().map(|error| error * error).sum();
        }
        let squared_degrees = 180.0 / PI * 180.0 / PI * phase;
        SCALE / count as f64 * (MAGNITUDE_WEIGHT * magnitude + PHASE_WEIGHT * squared_degrees)
    }
}

/// What is summed over the frequencies.
struct Sums {
    /// Squared differences of the magnitudes \[dB^2\].
    magnitude: f64,
    /// Squared principal values of the differences of the phases \[rad^2\].
    phase: f64,
    /// The greatest less the least of these values. Up to half a turn no step between neighbours exceeds it either: they are
    /// unwrapped as they are, and their median lies where M3 wants it.
    spread: f64,
}

/// The differences of two curves, as many frequencies at once as the processor's vectors hold.
struct Differences<'a> {
    simulated: &'a PolarCurve,
    reference: &'a PolarCurve,
    /// Where the principal phase differences go.
    phase: &'a mut [f64],
}

impl WithSimd for Differences<'_> {
    type Output = Sums;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Sums {
        let zero = simd.splat_f64s(0.0);
        let (mut magnitude, mut phase, mut least, mut greatest) = (zero, zero, zero, zero);
        let Self { simulated, reference, phase: differences } = self;
        let magnitudes = [&simulated.magnitude_db, &reference.magnitude_db].map(|all| all.chunks(S::F64_LANES));
        let [ours, theirs] = magnitudes;
        for (a, b) in ours.zip(theirs) {
            let error = simd.sub_f64s(simd.partial_load_f64s(a), simd.partial_load_f64s(b));
            magnitude = simd.mul_add_e_f64s(error, error, magnitude);
        }
        let phases = simulated.phase.chunks(S::F64_LANES).zip(reference.phase.chunks(S::F64_LANES));
        for ((a, b), to) in phases.zip(differences.chunks_mut(S::F64_LANES)) {
            // Lanes past the end hold zero, which adds nothing to the sum and at most leaves the spread too large.
            let error = principal(simd, simd.sub_f64s(simd.partial_load_f64s(a), simd.partial_load_f64s(b)));
            simd.partial_store_f64s(to, error);
            phase = simd.mul_add_e_f64s(error, error, phase);
            (least, greatest) = (simd.min_f64s(least, error), simd.max_f64s(greatest, error));
        }
        let spread = simd.reduce_max_f64s(greatest) - simd.reduce_min_f64s(least);
        Sums { magnitude: simd.reduce_sum_f64s(magnitude), phase: simd.reduce_sum_f64s(phase), spread }
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
        let mut meter = MeanCost::default();
        for (a, b) in [(0.1, 0.2), (-3.0, 2.0), (1.0, 1.0), (3.1, -3.1)].map(|(a, b)| (curve(a), curve(b))) {
            let expected = Mismatch::new(&a, &b).cost(&[0.0; 53], GainDelay::NONE, CostAverage::Mean).total();
            let found = meter.of(&a, &b);
            // The same sums of 53 squares in another order.
            assert!((found - expected).abs() <= 1e-13 * expected, "{found} {expected}");
        }
    }
}
