//! Distances between the models in a bundle (M5).
//!
//! ```text
//! d(a, b) = sqrt(mean over the compared responses of J),   J with the mean over frequency
//! J = J(a against b); if either has coherence, (J with a's weights + J with b's weights) / 2
//! ```
//!
//! A *bundle* is a condition's physics models, or its identified models; J is the cost of the
//! errors in magnitude and phase (`cost`).

use gdcm_model::dataset::{Pair, PairTable};
use gdcm_model::response::PolarResponse;
use gdcm_model::response::polar_response::PolarCurve;

use super::coherence_weights::CoherenceWeights;
use super::cost::{Cost, CostAverage, mean_cost};
use super::mismatch::Mismatch;

/// A model whose distances from other models are computed.
#[derive(Clone, Copy, Debug)]
pub struct ComparedModel<'a> {
    pub responses: &'a PolarResponse,
    /// Frequency weights for each response, if measured with coherence (M4a).
    pub coherence_weights: Option<&'a PairTable<CoherenceWeights>>,
}

impl ComparedModel<'_> {
    /// Computes J for `a` against `b`, as the mean over frequency, with this model's coherence
    /// weights; over all frequencies, equally weighted, if none has a weight.
    fn weighted_cost(&self, a: &PolarCurve, b: &PolarCurve, pair: Pair) -> f64 {
        let Some(weights) = self.coherence_weights else {
            return mean_cost(a, b);
        };
        let Some(mismatch) = Mismatch::new(a, b).coherence_weighted(Some(&weights[pair])) else {
            return mean_cost(a, b);
        };
        Cost::from_errors(
            mismatch.magnitude_db.iter().copied(),
            mismatch.phase.iter().copied(),
            mismatch.weights(),
            CostAverage::Mean,
        )
        .total()
    }
}

/// Computes the distances from model `a` to each later model, `d(a, a + 1), d(a, a + 2), ...`; the
/// calls for different `a` are independent tasks.
///
/// J does not depend on which model is the reference, but its coherence weights do (M4a), and in a
/// bundle either model can be the reference: if either has coherence, J is computed with the
/// weights of each and averaged, so that a distance does not depend on the models' order. A
/// response without any weighted frequency is compared over all frequencies, so that poorly
/// measured models do not appear similar.
pub fn distances_from(a: usize, models: &[ComparedModel<'_>], compared: &[Pair]) -> Vec<f64> {
    models[a + 1..]
        .iter()
        .map(|b| distance(&models[a], b, compared))
        .collect()
}

/// Computes `d(a, b)`. Both models have every compared response, because a model that lacks one is
/// set aside ([`MeasuredPairs`]).
fn distance(a: &ComparedModel<'_>, b: &ComparedModel<'_>, compared: &[Pair]) -> f64 {
    let sum: f64 = compared
        .iter()
        .filter_map(|&pair| cost_between(a, b, pair))
        .sum();
    (sum / compared.len().max(1) as f64).sqrt()
}

/// Computes J for one response in `a` against `b`; `None` if either lacks it.
fn cost_between(a: &ComparedModel<'_>, b: &ComparedModel<'_>, pair: Pair) -> Option<f64> {
    let curve_a = a.responses.curves()[pair].as_ref()?;
    let curve_b = b.responses.curves()[pair].as_ref()?;
    if a.coherence_weights.is_none() && b.coherence_weights.is_none() {
        return Some(mean_cost(curve_a, curve_b));
    }
    let weighted_by_a = a.weighted_cost(curve_a, curve_b, pair);
    let weighted_by_b = b.weighted_cost(curve_a, curve_b, pair);
    Some(0.5 * (weighted_by_a + weighted_by_b))
}

/// The responses compared to compute distances in a bundle, and the responses that each model lacks
/// (M5b).
#[derive(Clone, Debug, PartialEq)]
pub struct MeasuredPairs {
    /// The responses from which distances are computed, as far as at least one model has them.
    pub compared: Vec<Pair>,
    /// Compared responses that each model lacks: zero or not finite somewhere in the band. A model
    /// that lacks any is *set aside*: it takes no part in distances, suggestions and
    /// representatives.
    pub lacks: Vec<Vec<Pair>>,
}

impl MeasuredPairs {
    /// Finds the available and the missing responses in a bundle's models among those from which
    /// distances are computed, marked in `measuring`: the dataset's on-axis responses, or all if
    /// none is on-axis.
    pub fn new(responses: &[PolarResponse], measuring: &PairTable<bool>) -> Self {
        let compared: Vec<Pair> = measuring
            .marked()
            .filter(|pair| {
                responses
                    .iter()
                    .any(|response| response.curves()[*pair].is_some())
            })
            .collect();
        let mut lacks = Vec::with_capacity(responses.len());
        for response in responses {
            let mut lacking = compared.clone();
            lacking.retain(|pair| response.curves()[*pair].is_none());
            lacks.push(lacking);
        }
        Self { compared, lacks }
    }

    /// Returns the indices of the models that are not set aside, in bundle order.
    pub fn compared_models(&self) -> Vec<usize> {
        (0..self.lacks.len())
            .filter(|&model| !self.is_set_aside(model))
            .collect()
    }

    /// Returns whether a model is set aside, because it lacks a compared response.
    pub fn is_set_aside(&self, model: usize) -> bool {
        !self.lacks[model].is_empty()
    }
}

/// The distances `d(a, b)` between every two models in a bundle.
#[derive(Clone, Debug, PartialEq)]
pub struct BundleDistance {
    measured: MeasuredPairs,
    /// Count of models that are not set aside.
    count: usize,
    /// Each model's position among those not set aside; `None` if set aside.
    places: Vec<Option<usize>>,
    /// Upper triangle by rows, without the models set aside: d(0,1), d(0,2), ..., d(1,2), ...
    distances: Vec<f64>,
}

impl BundleDistance {
    /// Creates the table from rows: row `a` is [`distances_from`] model `a`, counting only models
    /// not set aside.
    pub fn from_rows(rows: Vec<Vec<f64>>, measured: MeasuredPairs) -> Self {
        let count = rows.len();
        let mut places = vec![None; measured.lacks.len()];
        for (place, model) in measured.compared_models().into_iter().enumerate() {
            places[model] = Some(place);
        }
        Self {
            measured,
            count,
            places,
            distances: rows.into_iter().flatten().collect(),
        }
    }

    /// Returns `d(a, b)`, zero for `a = b`; `None` if either model is set aside.
    pub fn between(&self, a: usize, b: usize) -> Option<f64> {
        let a = self.places[a]?;
        let b = self.places[b]?;
        let low = a.min(b);
        let high = a.max(b);
        if low == high {
            return Some(0.0);
        }
        // Row `low` follows the rows 0 to `low - 1`, which hold count - 1, count - 2, ...
        // distances.
        let row_start = low * (2 * self.count - low - 1) / 2;
        self.distances.get(row_start + high - low - 1).copied()
    }

    /// Returns the compared responses, and the responses that each model lacks.
    pub fn measured(&self) -> &MeasuredPairs {
        &self.measured
    }
}

#[cfg(test)]
mod tests {
    use gdcm_model::dataset::measured_response::MeasuredResponse;
    use gdcm_model::dataset::{Band, Dynamics};
    use gdcm_model::response::{FrequencyGrid, FrequencyResponse};

    use super::super::coherence_weights::coherence_weight;
    use super::*;

    /// A measured response equal to 1 with coherence 1 in the band's lower half, and equal to
    /// `upper` with the given coherence in the upper half.
    fn measured(upper: f64, coherence: f64) -> Dynamics {
        let omega = vec![1.0, 2.99, 3.01, 9.0];
        let magnitude = PairTable::filled(1, 1, vec![1.0, 1.0, upper, upper]);
        let phase = PairTable::filled(1, 1, vec![0.0; 4]);
        let coherence = PairTable::filled(1, 1, vec![1.0, 1.0, coherence, coherence]);
        Dynamics::Measured(
            MeasuredResponse::new(omega, &magnitude, &phase, Some(coherence)).unwrap(),
        )
    }

    fn distances(models: &[Dynamics], threshold: Option<f64>) -> Vec<f64> {
        let grid = FrequencyGrid::logarithmic(Band::new(1.0, 9.0).unwrap(), 100);
        let responses: Vec<PolarResponse> = models
            .iter()
            .map(|model| PolarResponse::new(&FrequencyResponse::from_dynamics(model, &grid)))
            .collect();
        let coherence_weights: Vec<_> = models
            .iter()
            .map(|model| CoherenceWeights::of_model(model, grid.omega(), threshold))
            .collect();
        let models: Vec<ComparedModel<'_>> = responses
            .iter()
            .zip(&coherence_weights)
            .map(|(responses, coherence_weights)| ComparedModel {
                responses,
                coherence_weights: coherence_weights.as_ref(),
            })
            .collect();
        (0..models.len())
            .flat_map(|a| distances_from(a, &models, &[Pair::new(0, 0)]))
            .collect()
    }

    #[test]
    fn unmeasured_frequencies_count_in_one_direction_where_the_other_model_has_them() {
        let good = measured(1.0, 0.9);
        let bad = measured(2.0, 0.1);
        let [apart] = distances(&[good.clone(), bad.clone()], None)[..] else {
            panic!("one distance")
        };
        let [weighed] = distances(&[good.clone(), bad.clone()], Some(0.6))[..] else {
            panic!("one distance")
        };
        let [turned] = distances(&[bad.clone(), good.clone()], Some(0.6))[..] else {
            panic!("one distance")
        };
        assert_eq!(weighed, turned, "whichever comes first");
        assert!(weighed > 0.0 && weighed < apart);
        // One direction contributes J/2, multiplied by its coherence weight; the other contributes
        // nothing.
        assert!((weighed / apart - (0.5 * coherence_weight(0.9)).sqrt()).abs() < 0.01);
    }
}
