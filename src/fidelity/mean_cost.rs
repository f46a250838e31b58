//! J with the mean over frequency, without anything kept.

use std::f64::consts::{PI, TAU};

use pulp::Arch;

use crate::response::{PolarCurve, centred_unwrap};

use super::cost::{MAGNITUDE_WEIGHT, PHASE_WEIGHT, SCALE};

/// Sums are taken in so many parts, one to a lane of the widest vectors: the same bits whatever the processor has.
const PARTS: usize = 8;

/// Measures J of many pairs of curves, `J = 20 / N sum_k (W_g e_dB,k^2 + W_p e_deg,k^2)` (M4, M5).
///
/// It is [`super::Mismatch::cost`] with the mean, without gain or delay, in the same memory for every pair: distances within
/// a bundle of `n` models take `n (n - 1) / 2` of these for each response, and about 10 operations for each frequency.
#[derive(Debug, Default)]
pub(super) struct MeanCost {
    phase: Vec<f64>,
    scratch: Vec<f64>,
}

impl MeanCost {
    /// J of `simulated` against `reference`, on the same frequencies.
    pub(super) fn of(&mut self, simulated: &PolarCurve, reference: &PolarCurve) -> f64 {
        Arch::new().dispatch(|| self.of_inlined(simulated, reference))
    }

    /// What is compiled for each instruction set.
    #[inline(always)]
    fn of_inlined(&mut self, simulated: &PolarCurve, reference: &PolarCurve) -> f64 {
        let magnitude = sum_of_squared_differences(&simulated.magnitude_db, &reference.magnitude_db);
        principal_differences(&simulated.phase, &reference.phase, &mut self.phase);
        if has_jump(&self.phase) {
            centred_unwrap(&mut self.phase, &mut self.scratch);
        }
        let squared_degrees = 180.0 / PI * 180.0 / PI * sum_of_squares(&self.phase);
        SCALE / self.phase.len() as f64 * (MAGNITUDE_WEIGHT * magnitude + PHASE_WEIGHT * squared_degrees)
    }
}

/// `a - b` in (-pi, pi], of principal phases.
#[inline(always)]
fn principal_differences(a: &[f64], b: &[f64], differences: &mut Vec<f64>) {
    differences.clear();
    differences.extend(a.iter().zip(b).map(|(a, b)| {
        let difference = a - b;
        let above = if difference > PI { TAU } else { 0.0 };
        let below = if difference <= -PI { TAU } else { 0.0 };
        difference - above + below
    }));
}

/// Whether any step exceeds half a turn. Without one principal phases are unwrapped, and their median is where M3 wants it.
#[inline(always)]
fn has_jump(phase: &[f64]) -> bool {
    let steps = phase.iter().zip(&phase[1.min(phase.len())..]);
    steps.fold(false, |jump, (before, after)| jump | !(after - before > -PI && after - before <= PI))
}

#[inline(always)]
fn sum_of_squared_differences(a: &[f64], b: &[f64]) -> f64 {
    let (a_parts, b_parts) = (a.chunks_exact(PARTS), b.chunks_exact(PARTS));
    let rest = a_parts.remainder().iter().zip(b_parts.remainder());
    let rest: f64 = rest.map(|(a, b)| (a - b) * (a - b)).sum();
    let mut sums = [0.0; PARTS];
    for (a, b) in a_parts.zip(b_parts) {
        for part in 0..PARTS {
            sums[part] += (a[part] - b[part]) * (a[part] - b[part]);
        }
    }
    rest + sums.iter().sum::<f64>()
}

#[inline(always)]
fn sum_of_squares(values: &[f64]) -> f64 {
    let parts = values.chunks_exact(PARTS);
    let rest: f64 = parts.remainder().iter().map(|value| value * value).sum();
    let mut sums = [0.0; PARTS];
    for values in parts {
        for part in 0..PARTS {
            sums[part] += values[part] * values[part];
        }
    }
    rest + sums.iter().sum::<f64>()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fidelity::{CostAverage, Mismatch};
    use crate::response::wrap;

    #[test]
    fn it_is_the_cost_of_the_mismatch_with_the_mean() {
        let curve = |seed: f64| PolarCurve {
            magnitude_db: (0..53).map(|k| 20.0 * (seed + 0.3 * f64::from(k)).sin()).collect(),
            phase: (0..53).map(|k| wrap(seed - 0.4 * seed * f64::from(k))).collect(),
        };
        let mut meter = MeanCost::default();
        for (a, b) in [(0.1, 0.2), (-3.0, 2.0), (1.0, 1.0), (3.1, -3.1)].map(|(a, b)| (curve(a), curve(b))) {
            let expected = Mismatch::new(&a, &b).cost(&[0.0; 53], 0.0, 0.0, CostAverage::Mean).total();
            let found = meter.of(&a, &b);
            // The same sums of 53 squares in another order.
            assert!((found - expected).abs() <= 1e-13 * expected, "{found} {expected}");
        }
    }
}
