//! Mismatch between a simulated response and its reference, frequency by frequency.
//!
//! ```text
//! e_dB = |H_sim|_dB - |H_ref|_dB
//! Delta phi = arg(H_sim conj(H_ref)), unwrapped over frequency (M3, M6b)
//! ```
//!
//! `H_sim` is the simulated response, `H_ref` its reference. The errors cover the *grid*, all
//! compared frequencies, or only the frequencies with a coherence weight (M4a). Functions that take
//! `omega` or `grid` expect the whole grid.

use std::f64::consts::{PI, TAU};

use gdcm_model::response::phase_unwrapping::centred_unwrap;
use gdcm_model::response::polar_response::PolarCurve;
use gdcm_model::response::{GainDelay, wrap};
use gdcm_model::statistics::{median, weighted_median};

use super::coherence_weights::CoherenceWeights;
use super::cost::{Cost, CostAverage};
use super::pure_delay::nearest_pure_delay_s;

/// Difference between a simulated response and its reference, to be reduced by a gain and a delay.
#[derive(Clone, Debug, PartialEq)]
pub struct Mismatch {
    /// `|H_sim|_dB - |H_ref|_dB` at each frequency.
    pub magnitude_db: Vec<f64>,
    /// `arg(H_sim conj H_ref)` \[rad\], principal value at each frequency.
    pub phase: Vec<f64>,
    /// Frequencies with weights, if the reference has coherence (M4a); otherwise the errors cover
    /// the whole grid with equal weights.
    pub coherence_weights: Option<CoherenceWeights>,
    /// Whole turns \[rad\] that are added to `Delta phi` after phase unwrapping, set by
    /// [`Mismatch::align_branch`]; zero for the representatives (M13.1).
    pub turn: f64,
}

impl Mismatch {
    /// Computes the difference between `simulated` and `reference`, on the same frequencies.
    pub fn new(simulated: &PolarCurve, reference: &PolarCurve) -> Self {
        let magnitudes = simulated.magnitude_db.iter().zip(&reference.magnitude_db);
        let phases = simulated.phase.iter().zip(&reference.phase);
        Self {
            magnitude_db: magnitudes.map(|(a, b)| a - b).collect(),
            phase: phases.map(|(a, b)| wrap(a - b)).collect(),
            coherence_weights: None,
            turn: 0.0,
        }
    }

    /// Restricts the difference to the frequencies with a coherence weight (M4a); `None` if there
    /// are none. Without `coherence_weights`, the difference is not changed.
    pub fn coherence_weighted(self, coherence_weights: Option<&CoherenceWeights>) -> Option<Self> {
        let Some(coherence_weights) = coherence_weights else {
            return Some(self);
        };
        if coherence_weights.omega.is_empty() {
            return None;
        }
        Some(Self {
            magnitude_db: coherence_weights.at_frequencies(&self.magnitude_db),
            phase: coherence_weights.at_frequencies(&self.phase),
            coherence_weights: Some(coherence_weights.clone()),
            turn: self.turn,
        })
    }

    /// Returns the errors' frequencies \[rad/s\]: the whole grid or the weighted frequencies.
    pub fn omega<'a>(&'a self, grid: &'a [f64]) -> &'a [f64] {
        match &self.coherence_weights {
            Some(weights) => &weights.omega,
            None => grid,
        }
    }

    /// Returns the median over frequency, weighted if the frequencies have weights (M6, M4a).
    pub fn median(&self, values: &mut [f64]) -> f64 {
        match self.weights() {
            None => median(values),
            Some(weights) => weighted_median(values, weights),
        }
    }

    /// Places values at the errors' frequencies on the grid, which has `points` points; NaN at
    /// frequencies without weight.
    pub fn on_grid(&self, values: Vec<f64>, points: usize) -> Vec<f64> {
        match &self.coherence_weights {
            None => values,
            Some(coherence_weights) => coherence_weights.on_grid(&values, points),
        }
    }

    /// Returns a weight for each frequency; `None` if all weights are equal (M4a).
    pub fn weights(&self) -> Option<&[f64]> {
        self.coherence_weights
            .as_ref()
            .map(|weights| weights.weights.as_slice())
    }

    /// Computes J after a correction to the simulated response (M4, M10). The correction removes
    /// `omega tau` from the phase, and the principal value is used: a zero that lies on the other
    /// side of the imaginary axis must not add a whole turn to the error.
    pub fn cost(&self, omega: &[f64], correction: GainDelay, average: CostAverage) -> Cost {
        let omega = self.omega(omega);
        let phase = correction.phases(&self.phase, omega).map(wrap);
        let magnitude = correction.magnitudes_db(&self.magnitude_db, omega);
        Cost::from_errors(magnitude, phase, self.weights(), average)
    }

    /// Returns the remaining difference after multiplying the simulated response by a factor with
    /// these magnitudes \[dB\] and phases \[rad\] at each grid frequency (M15.5).
    pub fn multiplied(&self, magnitude_db: &[f64], phase: &[f64]) -> Self {
        let mut multiplied = self.clone();
        for (error, factor) in multiplied
            .magnitude_db
            .iter_mut()
            .zip(self.at_errors(magnitude_db))
        {
            *error += factor;
        }
        for (error, factor) in multiplied.phase.iter_mut().zip(self.at_errors(phase)) {
            *error = wrap(*error + factor);
        }
        multiplied
    }

    /// Picks the values at the errors' frequencies from a value at each grid point; inverts
    /// [`Mismatch::on_grid`].
    fn at_errors(&self, values: &[f64]) -> Vec<f64> {
        match &self.coherence_weights {
            Some(weights) => weights.at_frequencies(values),
            None => values.to_vec(),
        }
    }

    /// Returns whether the unwrapped `Delta phi` (M3) exceeds half a turn somewhere; then M6b
    /// chooses the turns.
    pub fn leaves_half_a_turn(&self) -> bool {
        self.unwrapped().iter().any(|phase| phase.abs() > PI)
    }

    /// Returns `Delta phi(sim, ref)` \[rad\] by M3.
    fn unwrapped(&self) -> Vec<f64> {
        let mut phase = self.phase.clone();
        centred_unwrap(&mut phase, &mut Vec::new());
        phase
    }

    /// Returns `Delta phi(sim, ref)` \[rad\], whose slope over `omega` is the delay: by M3 if it
    /// stays within half a turn, otherwise at each frequency the turn nearest to the best-fitting
    /// pure delay (M6b); [`Self::turn`] is added.
    pub fn phase_difference(&self, omega: &[f64]) -> Vec<f64> {
        let mut phase = self.unwrapped();
        let omega = self.omega(omega);
        // Branch: the whole turns at each frequency (M6b).
        if phase.iter().any(|phase| phase.abs() > PI) {
            let delay_s = nearest_pure_delay_s(&phase, omega);
            for (phase, omega) in phase.iter_mut().zip(omega) {
                *phase += TAU * ((omega * delay_s - *phase) / TAU).round();
            }
        }
        if self.turn != 0.0 {
            for phase in &mut phase {
                *phase += self.turn;
            }
        }
        phase
    }

    /// Returns the median `Delta phi` \[rad\] over frequency, without weights.
    pub fn median_phase(&self, omega: &[f64]) -> f64 {
        median(&mut self.phase_difference(omega))
    }

    /// Shifts the phase by whole turns so that its median is nearest to `median_phase` \[rad\]:
    /// aligns a substituted pair of models with the representatives (M13.1).
    pub fn align_branch(mut self, omega: &[f64], median_phase: f64) -> Self {
        self.turn += TAU * ((median_phase - self.median_phase(omega)) / TAU).round();
        self
    }
}

#[cfg(test)]
mod tests {
    use gdcm_model::units::db_to_ratio;

    use super::*;

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
        let uncorrected = mismatch.cost(&omega, GainDelay::NONE, CostAverage::Mean);
        assert!(uncorrected.total() > 100.0);
        let correction = GainDelay::new(db_to_ratio(2.0), 0.4);
        let corrected = mismatch.cost(&omega, correction, CostAverage::Mean);
        // Squared rounding errors of angles up to 12 * 0.4 rad.
        assert!(corrected.total() < 1e-20);
    }

    #[test]
    fn a_response_that_leads_has_a_positive_phase_difference() {
        let omega = [1.0, 2.0];
        let mismatch = Mismatch::new(&curve(0.0, 0.0, &omega), &curve(0.0, 0.1, &omega));
        let phase = mismatch.phase_difference(&omega);
        assert!(
            phase
                .iter()
                .zip(omega)
                .all(|(phase, omega)| (phase - 0.1 * omega).abs() < 1e-15)
        );
    }

    #[test]
    fn a_zero_passed_on_the_other_side_costs_no_turn_and_leaves_the_delay_of_the_others() {
        // A lag of 70 ms, and an additional whole turn within a few frequencies around 2 rad/s.
        let omega: Vec<f64> = (1..=120).map(|k| 0.1 * f64::from(k)).collect();
        let phase = omega
            .iter()
            .map(|omega| {
                let turn = TAU / (1.0 + (-40.0 * (omega - 2.0)).exp());
                wrap(-0.07 * omega + turn)
            })
            .collect();
        let mismatch = Mismatch {
            magnitude_db: vec![0.0; 120],
            phase,
            coherence_weights: None,
            turn: 0.0,
        };
        let cost = mismatch.cost(&omega, GainDelay::new(1.0, -0.07), CostAverage::Median);
        // At the median frequency, 6 rad/s, the phase misses a whole turn by e^-160 turns.
        assert!(cost.phase < 1e-20, "{cost:?}");
        let delays = mismatch
            .phase_difference(&omega)
            .into_iter()
            .zip(&omega)
            .map(|(phase, omega)| phase / omega);
        let mut delays: Vec<f64> = delays.collect();
        assert!((median(&mut delays) + 0.07).abs() < 1e-12);
    }

    #[test]
    fn frequencies_that_do_not_count_move_neither_the_cost_nor_the_branch() {
        let omega: Vec<f64> = (1..=240).map(|k| 0.1 * f64::from(k)).collect();
        let mut reference = curve(1.0, 0.3, &omega);
        // Only noise from 5 to 8 rad/s.
        for (k, phase) in reference.phase.iter_mut().enumerate().take(80).skip(50) {
            *phase = wrap(2.3 * (k * k) as f64);
            reference.magnitude_db[k] = 40.0;
        }
        let coherence: Vec<f64> = (0..240)
            .map(|k| if (50..80).contains(&k) { 0.1 } else { 0.8 })
            .collect();
        let coherence_weights = CoherenceWeights::select(&omega, &coherence, 0.6, None);
        let mismatch = Mismatch::new(&curve(0.0, 0.0, &omega), &reference)
            .coherence_weighted(Some(&coherence_weights))
            .unwrap();
        let phase = mismatch.phase_difference(&omega);
        let left = mismatch.omega(&omega);
        assert_eq!(phase.len(), 210);
        assert_eq!(left.len(), 210);
        assert!(
            phase
                .iter()
                .zip(left)
                .all(|(phase, omega)| (phase - 0.3 * omega).abs() < 1e-13)
        );
        let right = GainDelay::new(db_to_ratio(1.0), 0.3);
        assert!(mismatch.cost(&omega, right, CostAverage::Mean).total() < 1e-20);
        let nothing = CoherenceWeights::select(&omega, &[0.0; 240], 0.6, None);
        assert_eq!(mismatch.coherence_weighted(Some(&nothing)), None);
    }

    #[test]
    fn a_long_pure_delay_is_found_whatever_turns_it_takes() {
        let omega: Vec<f64> = (1..=240).map(|k| 0.1 * f64::from(k)).collect();
        for delay_s in [-0.6, -0.4375, 0.31, 0.6] {
            let mismatch = Mismatch::new(&curve(0.0, 0.0, &omega), &curve(0.0, delay_s, &omega));
            let phase = mismatch.phase_difference(&omega);
            // A few rounding errors of angles up to 0.6 * 24 rad.
            assert!(
                phase
                    .iter()
                    .zip(&omega)
                    .all(|(phase, omega)| (phase - delay_s * omega).abs() < 1e-13),
                "{delay_s}"
            );
        }
    }
}
