//! Which frequencies of a measured response count, and how much (M4a).

use crate::dataset::{Dynamics, Pair, PairTable};
use crate::response::coherence_at;

/// The frequencies of one response at which its coherence says that it was measured, each with its weight.
#[derive(Clone, Debug, PartialEq)]
pub struct CountedFrequencies {
    /// Places on the grid, rising.
    places: Vec<usize>,
    omega: Vec<f64>,
    weights: Vec<f64>,
}

/// `W = [1.58 (1 - e^(-gamma^2))]^2` of a coherence `gamma^2` from 0 to 1 (Tischler & Remple, "Aircraft and Rotorcraft System
/// Identification", 2nd ed. 2012, chapter 11): 0.9975 of 1, 0.508 of 0.6.
pub fn coherence_weight(coherence: f64) -> f64 {
    (1.58 * (1.0 - (-coherence).exp())).powi(2)
}

impl CountedFrequencies {
    /// Those `omega` \[rad/s\] whose coherence is not under `threshold` and that lie in the response's valid band.
    pub fn of(omega: &[f64], coherence: &[f64], threshold: f64, valid_band: Option<[f64; 2]>) -> Self {
        let mut counted = Self { places: Vec::new(), omega: Vec::new(), weights: Vec::new() };
        let is_valid = |omega: f64| valid_band.is_none_or(|[low, high]| (low..=high).contains(&omega));
        for (place, (&omega, &coherence)) in omega.iter().zip(coherence).enumerate() {
            let weight = coherence_weight(coherence);
            // A weight of zero would count in N' and nowhere else.
            if coherence >= threshold && weight > 0.0 && is_valid(omega) {
                counted.places.push(place);
                counted.omega.push(omega);
                counted.weights.push(weight);
            }
        }
        counted
    }

    /// Those of every response of a model; none where it has no coherence, so that all frequencies count alike.
    pub fn of_model(dynamics: &Dynamics, omega: &[f64], threshold: Option<f64>) -> Option<PairTable<Self>> {
        let (Dynamics::Measured(response), Some(threshold)) = (dynamics, threshold) else { return None };
        let valid_band = |pair: Pair| response.valid_bands().map(|bands| bands[pair]);
        let coherence = coherence_at(response, omega)?;
        Some(coherence.map(|pair, coherence| Self::of(omega, coherence, threshold, valid_band(pair))))
    }

    /// The frequencies \[rad/s\].
    pub fn omega(&self) -> &[f64] {
        &self.omega
    }

    /// Weight of each.
    pub fn weights(&self) -> &[f64] {
        &self.weights
    }

    /// How many count, `N'`.
    pub fn len(&self) -> usize {
        self.places.len()
    }

    /// Whether none counts.
    pub fn is_empty(&self) -> bool {
        self.places.is_empty()
    }

    /// What stands at these frequencies in their places among `points` of the grid, not a number elsewhere.
    pub(super) fn spread(&self, values: &[f64], points: usize) -> Vec<f64> {
        let mut spread = vec![f64::NAN; points];
        self.places.iter().zip(values).for_each(|(&place, &value)| spread[place] = value);
        spread
    }

    /// What stands at these frequencies, of one value for each of the grid.
    pub(super) fn pick(&self, values: &[f64]) -> Vec<f64> {
        self.places.iter().map(|&place| values[place]).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_under_the_threshold_or_outside_the_valid_band_is_left_out() {
        let omega = [1.0, 2.0, 3.0, 4.0, 5.0];
        let coherence = [1.0, 0.59, 0.6, 0.9, f64::NAN];
        let counted = CountedFrequencies::of(&omega, &coherence, 0.6, Some([1.5, 4.0]));
        assert_eq!((counted.omega(), counted.len()), ([3.0, 4.0].as_slice(), 2));
        assert_eq!(counted.weights(), [coherence_weight(0.6), coherence_weight(0.9)]);
        assert_eq!(counted.pick(&[10.0, 20.0, 30.0, 40.0, 50.0]), [30.0, 40.0]);
        let spread = counted.spread(&[30.0, 40.0], 5);
        assert!(spread[2..4] == [30.0, 40.0] && [0, 1, 4].iter().all(|place: &usize| spread[*place].is_nan()));
        assert!(CountedFrequencies::of(&omega, &[0.0; 5], 0.0, None).is_empty(), "nothing was measured");
    }
}
