//! J with the mean over frequency, without anything kept.

use crate::response::{PolarCurve, centred_unwrap, wrap};

use super::cost::{MAGNITUDE_WEIGHT, PHASE_WEIGHT, SCALE};

/// Measures J of many pairs of curves, `J = 20 / N sum_k (W_g e_dB,k^2 + W_p e_deg,k^2)` (M4, M5).
///
/// It is [`super::Mismatch::cost`] with the mean, without gain or delay, in the same memory for every pair: distances within
/// a bundle of `n` models take `n (n - 1) / 2` of these for each response.
#[derive(Debug, Default)]
pub(super) struct MeanCost {
    phase: Vec<f64>,
    scratch: Vec<f64>,
}

impl MeanCost {
    /// J of `simulated` against `reference`, on the same frequencies.
    pub(super) fn of(&mut self, simulated: &PolarCurve, reference: &PolarCurve) -> f64 {
        let magnitude = sum_of_squared_differences(&simulated.magnitude_db, &reference.magnitude_db);
        self.phase.clear();
        self.phase.extend(simulated.phase.iter().zip(&reference.phase).map(|(a, b)| wrap(a - b)));
        centred_unwrap(&mut self.phase, &mut self.scratch);
        let phase: f64 = self.phase.iter().map(|error| error * error).sum();
        let squared_degrees = 180.0 / std::f64::consts::PI * 180.0 / std::f64::consts::PI;
        SCALE / self.phase.len() as f64 * (MAGNITUDE_WEIGHT * magnitude + PHASE_WEIGHT * squared_degrees * phase)
    }
}

fn sum_of_squared_differences(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fidelity::{CostAverage, Mismatch};

    #[test]
    fn it_is_the_cost_of_the_mismatch_with_the_mean() {
        let curve = |seed: f64| PolarCurve {
            magnitude_db: (0..50).map(|k| 20.0 * (seed + 0.3 * f64::from(k)).sin()).collect(),
            phase: (0..50).map(|k| wrap(seed - 0.4 * seed * f64::from(k))).collect(),
        };
        let mut meter = MeanCost::default();
        for (a, b) in [(curve(0.1), curve(0.2)), (curve(-3.0), curve(2.0)), (curve(1.0), curve(1.0))] {
            let expected = Mismatch::new(&a, &b).cost(&[0.0; 50], 0.0, 0.0, CostAverage::Mean).total();
            let found = meter.of(&a, &b);
            // The same sums of 50 squares in another order of factors.
            assert!((found - expected).abs() <= 1e-13 * expected, "{found} {expected}");
        }
    }
}
