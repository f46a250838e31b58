//! How one response differs from its reference, frequency by frequency.

use crate::response::{GainDelay, PolarCurve, centred_unwrap, wrap};

use super::cost::{Cost, CostAverage};

/// What a gain and a delay have to act upon: the difference of a simulated response from its reference.
#[derive(Clone, Debug, PartialEq)]
pub struct Mismatch {
    /// `|H_sim|_dB - |H_ref|_dB` at each frequency.
    pub magnitude_db: Vec<f64>,
    /// Principal value of `arg(H_sim conj H_ref)` \[rad\] at each frequency.
    pub phase: Vec<f64>,
}

impl Mismatch {
    /// The difference of `simulated` from `reference`, on the same frequencies.
    pub fn new(simulated: &PolarCurve, reference: &PolarCurve) -> Self {
        let difference = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a - b).collect::<Vec<f64>>();
        let mut phase = difference(&simulated.phase, &reference.phase);
        phase.iter_mut().for_each(|angle| *angle = wrap(*angle));
        Self { magnitude_db: difference(&simulated.magnitude_db, &reference.magnitude_db), phase }
    }

    /// J after a correction of the simulated response (M4, M10). Its phase is unwrapped anew: the phase difference is that of the
    /// corrected response, not the corrected phase difference.
    pub fn cost(&self, omega: &[f64], correction: GainDelay, average: CostAverage) -> Cost {
        let mut scratch = Vec::with_capacity(omega.len());
        let mut phase: Vec<f64> = correction.phases(&self.phase, omega).map(wrap).collect();
        centred_unwrap(&mut phase, &mut scratch);
        Cost::of(correction.magnitudes_db(&self.magnitude_db), phase.into_iter(), average, &mut scratch)
    }

    /// The phase difference of M3, `Delta phi(sim, ref)` \[rad\].
    pub fn phase_difference(&self) -> Vec<f64> {
        let mut phase = self.phase.clone();
        centred_unwrap(&mut phase, &mut Vec::new());
        phase
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::units::db_to_ratio;

    fn curve(gain_db: f64, delay_s: f64, omega: &[f64]) -> PolarCurve {
        PolarCurve {
            magnitude_db: vec![gain_db; omega.len()],
            phase: omega.iter().map(|omega| wrap(-omega * delay_s)).collect(),
        }
    }

    #[test]
    fn the_right_gain_and_delay_leave_no_cost() {
        let omega: Vec<f64> = (1..60).map(|k| 0.2 * f64::from(k)).collect();
        let mismatch = Mismatch::new(&curve(0.0, 0.0, &omega), &curve(2.0, 0.4, &omega));
        assert!(mismatch.cost(&omega, GainDelay::NONE, CostAverage::Mean).total() > 100.0);
        // Squares of rounding errors of angles up to 12 * 0.4 rad.
        assert!(mismatch.cost(&omega, GainDelay::new(db_to_ratio(2.0), 0.4), CostAverage::Mean).total() < 1e-20);
    }

    #[test]
    fn a_response_that_leads_has_a_positive_phase_difference() {
        let omega = [1.0, 2.0];
        let mismatch = Mismatch::new(&curve(0.0, 0.0, &omega), &curve(0.0, 0.1, &omega));
        assert!(
            mismatch.phase_difference().iter().zip(omega).all(|(phase, omega)| (phase - 0.1 * omega).abs() < 1e-15)
        );
    }
}
