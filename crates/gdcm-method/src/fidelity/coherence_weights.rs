//! Frequency weights from a measured reference's coherence (M4a): a frequency with a coherence
//! below a threshold, or outside the response's valid band, is left out; the others are weighted by
//! `W` ([`coherence_weight`]).

use gdcm_model::dataset::{Dynamics, Pair, PairTable};
use gdcm_model::response::interpolation::coherence_at;

/// The frequencies at which a response has sufficient coherence, each with its weight.
#[derive(Clone, Debug, PartialEq)]
pub struct CoherenceWeights {
    /// Indices of these frequencies on the grid of all frequencies, ascending.
    grid_indices: Vec<usize>,
    /// The weighted frequencies \[rad/s\].
    pub omega: Vec<f64>,
    /// `W` at each frequency.
    pub weights: Vec<f64>,
}

/// Returns `W = [1.58 (1 - e^(-gamma^2))]^2` for a coherence `gamma^2` from 0 to 1 (Tischler &
/// Remple, "Aircraft and Rotorcraft System Identification", 2nd ed. 2012, chapter 11): 0.9975 at 1,
/// 0.508 at 0.6.
pub fn coherence_weight(coherence: f64) -> f64 {
    (1.58 * (1.0 - (-coherence).exp())).powi(2)
}

impl CoherenceWeights {
    /// Selects the frequencies in `omega` \[rad/s\] whose coherence is at least `threshold` and
    /// which lie in the response's valid band (`None`: any frequency). Frequencies with zero
    /// coherence are left out.
    pub fn select(
        omega: &[f64],
        coherence: &[f64],
        threshold: f64,
        valid_band: Option<[f64; 2]>,
    ) -> Self {
        let mut selected = Self {
            grid_indices: Vec::new(),
            omega: Vec::new(),
            weights: Vec::new(),
        };
        for (grid_index, (&omega, &coherence)) in omega.iter().zip(coherence).enumerate() {
            let is_valid = match valid_band {
                Some([low, high]) => (low..=high).contains(&omega),
                None => true,
            };
            let weight = coherence_weight(coherence);
            // A frequency with zero weight would only increase the count by which J is divided.
            if coherence >= threshold && weight > 0.0 && is_valid {
                selected.grid_indices.push(grid_index);
                selected.omega.push(omega);
                selected.weights.push(weight);
            }
        }
        selected
    }

    /// Returns the weights for every response in a model. `None`, for equal weights at all
    /// frequencies, unless the model is a measured response with coherence and `threshold` is
    /// given.
    pub fn of_model(
        dynamics: &Dynamics,
        omega: &[f64],
        threshold: Option<f64>,
    ) -> Option<PairTable<Self>> {
        let (Dynamics::Measured(response), Some(threshold)) = (dynamics, threshold) else {
            return None;
        };
        let coherence = coherence_at(response, omega)?;
        Some(coherence.map(|pair: Pair, coherence| {
            let valid_band = response.valid_bands().map(|bands| bands[pair]);
            Self::select(omega, coherence, threshold, valid_band)
        }))
    }

    /// Places values at these frequencies on the grid, which has `points` points; NaN elsewhere.
    pub fn on_grid(&self, values: &[f64], points: usize) -> Vec<f64> {
        let mut on_grid = vec![f64::NAN; points];
        for (&grid_index, &value) in self.grid_indices.iter().zip(values) {
            on_grid[grid_index] = value;
        }
        on_grid
    }

    /// Picks the values at these frequencies from a value at each grid point.
    pub(super) fn at_frequencies(&self, values: &[f64]) -> Vec<f64> {
        self.grid_indices
            .iter()
            .map(|&grid_index| values[grid_index])
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frequencies_under_the_threshold_or_outside_the_valid_band_are_left_out() {
        let omega = [1.0, 2.0, 3.0, 4.0, 5.0];
        let coherence = [1.0, 0.59, 0.6, 0.9, f64::NAN];
        let coherence_weights = CoherenceWeights::select(&omega, &coherence, 0.6, Some([1.5, 4.0]));
        assert_eq!(coherence_weights.omega, [3.0, 4.0]);
        assert_eq!(
            coherence_weights.weights,
            [coherence_weight(0.6), coherence_weight(0.9)]
        );
        assert_eq!(
            coherence_weights.at_frequencies(&[10.0, 20.0, 30.0, 40.0, 50.0]),
            [30.0, 40.0]
        );
        let on_grid = coherence_weights.on_grid(&[30.0, 40.0], 5);
        assert_eq!(on_grid[2..4], [30.0, 40.0]);
        for grid_index in [0, 1, 4] {
            assert!(on_grid[grid_index].is_nan());
        }
    }

    #[test]
    fn without_any_coherence_no_frequency_counts() {
        let omega = [1.0, 2.0, 3.0, 4.0, 5.0];
        let nothing = CoherenceWeights::select(&omega, &[0.0; 5], 0.0, None);
        assert!(nothing.omega.is_empty());
    }
}
