//! Distances between the models of a bundle, its representative, and models beyond a discontinuity
//! (M5).

use std::cmp::Ordering;
use std::collections::{BTreeMap, BTreeSet};

use gdcm_model::dataset::{Pair, PairTable};
use gdcm_model::response::PolarResponse;
use gdcm_model::response::polar_response::PolarCurve;
use gdcm_model::statistics::median;

use super::absolute_deviations::{FitError, least_absolute_deviations};
use super::coherence_weights::CoherenceWeights;
use super::cost::{Cost, CostAverage, mean_cost};
use super::mismatch::Mismatch;

/// The responses compared to compute distances in a bundle, and the responses that each model lacks
/// (M5b).
#[derive(Clone, Debug, PartialEq)]
pub struct MeasuredPairs {
    /// The marked responses available in at least one model.
    pub compared: Vec<Pair>,
    /// Compared responses that each model lacks: zero or not finite somewhere in the band. A model
    /// that lacks any is *set aside*: it takes no part in distances, suggestions and
    /// representatives.
    pub lacks: Vec<Vec<Pair>>,
}

impl MeasuredPairs {
    /// Finds the available and the missing responses in a bundle's models among those marked in
    /// `measuring`.
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

    /// Returns the indices, in bundle order, of the models that are not set aside.
    pub fn compared_models(&self) -> Vec<usize> {
        (0..self.lacks.len())
            .filter(|&model| !self.is_set_aside(model))
            .collect()
    }

    /// Returns whether a model is set aside.
    pub fn is_set_aside(&self, model: usize) -> bool {
        !self.lacks[model].is_empty()
    }
}

/// Distances between all pairs of models in a bundle (M5): `d(a, b) = sqrt(mean over the compared
/// responses of J(a against b))`, J with the mean over frequency.
#[derive(Clone, Debug, PartialEq)]
pub struct BundleDistance {
    measured: MeasuredPairs,
    /// Number of models that are not set aside.
    count: usize,
    /// Position of each model among those not set aside; `None` if set aside.
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
        let row_start = low * (2 * self.count - low - 1) / 2;
        self.distances.get(row_start + high - low - 1).copied()
    }

    /// Returns the compared responses, and the responses that each model lacks.
    pub fn measured(&self) -> &MeasuredPairs {
        &self.measured
    }
}

/// A model whose distances from other models are computed.
#[derive(Clone, Copy, Debug)]
pub struct ComparedModel<'a> {
    pub responses: &'a PolarResponse,
    /// Frequency weights of each response, if measured with coherence (M4a).
    pub coherence_weights: Option<&'a PairTable<CoherenceWeights>>,
}

impl ComparedModel<'_> {
    /// Computes J, as the mean over frequency, with this model as the reference: weighted by its
    /// coherence, or over all frequencies if none has a weight.
    fn cost_as_reference(&self, a: &PolarCurve, b: &PolarCurve, pair: Pair) -> f64 {
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

/// Computes the distances from a model to each later model: independent tasks for a large bundle.
///
/// J is weighted by the reference model's coherence (M4a), and in a bundle either model can be the
/// reference: if either has coherence, J is the mean over both directions, so that a distance does
/// not depend on the models' order. A response without any weighted frequency is compared over all
/// frequencies, so that poorly measured models do not appear similar.
pub fn distances_from(a: usize, models: &[ComparedModel<'_>], compared: &[Pair]) -> Vec<f64> {
    models[a + 1..]
        .iter()
        .map(|b| distance(&models[a], b, compared))
        .collect()
}

/// Computes `d(a, b)`.
fn distance(a: &ComparedModel<'_>, b: &ComparedModel<'_>, compared: &[Pair]) -> f64 {
    let sum: f64 = compared
        .iter()
        .filter_map(|&pair| cost_between(a, b, pair))
        .sum();
    (sum / compared.len().max(1) as f64).sqrt()
}

/// Computes J for a response of `a` against `b`; `None` where either lacks it.
fn cost_between(a: &ComparedModel<'_>, b: &ComparedModel<'_>, pair: Pair) -> Option<f64> {
    let from = a.responses.curves()[pair].as_ref()?;
    let to = b.responses.curves()[pair].as_ref()?;
    if a.coherence_weights.is_none() && b.coherence_weights.is_none() {
        return Some(mean_cost(from, to));
    }
    let against_a = a.cost_as_reference(from, to, pair);
    let against_b = b.cost_as_reference(from, to, pair);
    Some(0.5 * (against_a + against_b))
}

/// The medoid of the accepted models, or the model pinned by the analyst, with the score of every
/// accepted model (M5).
#[derive(Clone, Debug, PartialEq)]
pub struct Representative {
    /// The representative's index in the bundle.
    pub model: usize,
    /// `s_a = mean over b != a of d(a, b)` over the accepted models; `None` for a model that is
    /// rejected or set aside. Zero for a single accepted model.
    pub scores: Vec<Option<f64>>,
}

impl Representative {
    /// Returns the accepted model with the smallest score (ties: the first in file order), or
    /// `pinned`; `None` if every model is rejected or set aside. A pinned model that is set aside
    /// is ignored.
    pub fn select(
        distance: &BundleDistance,
        rejected: &BTreeSet<usize>,
        pinned: Option<usize>,
    ) -> Option<Self> {
        let mut kept = distance.measured.compared_models();
        kept.retain(|model| !rejected.contains(model));
        let mut scores = vec![None; distance.places.len()];
        for &a in &kept {
            let sum: f64 = kept.iter().filter_map(|&b| distance.between(a, b)).sum();
            scores[a] = Some(sum / kept.len().saturating_sub(1).max(1) as f64);
        }
        let medoid = kept
            .iter()
            .copied()
            .min_by(|&a, &b| scores[a].partial_cmp(&scores[b]).unwrap_or(Ordering::Equal))?;
        let model = match pinned {
            Some(pinned) if kept.contains(&pinned) => pinned,
            _ => medoid,
        };
        Some(Self { model, scores })
    }
}

/// Discontinuity ratio above which a model is suggested as an outlier.
pub const SUGGESTION_RATIO: f64 = 2.5;
/// Minimum number of models in a bundle for the outlier search.
const LEAST_MODELS: usize = 5;

/// Each physics model's distance from the others, relative to the distance explained by its
/// perturbation.
#[derive(Clone, Debug, PartialEq)]
pub struct Discontinuity {
    /// `r_a` for each model: near 1 in a smooth bundle. `None` for a model set aside, and where no
    /// two models have a fitted distance.
    pub ratios: Vec<Option<f64>>,
    /// Fitted weight of each perturbed coordinate.
    pub weights: Vec<CoordinateWeight>,
}

/// A perturbation coordinate's contribution to the squared distance.
#[derive(Clone, Debug, PartialEq)]
pub struct CoordinateWeight {
    /// Coordinate name ("airspeed_kt").
    pub name: String,
    /// Maximum magnitude of the coordinate in the bundle; the coordinate is divided by this value.
    pub largest: f64,
    /// Fitted weight `w_k`.
    pub weight: f64,
}

/// Reasons for a missing discontinuity ratio.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum DiscontinuityError {
    /// The bundle is too small for a fit.
    #[error(
        "outliers are suggested only in bundles of at least {LEAST_MODELS} physics models; this \
        bundle has {found}"
    )]
    TooFewModels {
        /// Number of models in the bundle.
        found: usize,
    },
    /// A model has no perturbation data.
    #[error("outliers cannot be suggested: model \"{model}\" has no perturbation data")]
    NoPerturbation { model: String },
    /// Every perturbation coordinate is zero: all models were linearised at the same trim.
    #[error(
        "outliers cannot be suggested: every perturbation is zero, so all models have the \
        same trim"
    )]
    AllZero,
    #[error("outliers cannot be suggested: {0}")]
    Fit(#[from] FitError),
}

impl Discontinuity {
    /// Computes the ratios in a whole bundle, including rejected models but not those set aside;
    /// `perturbations` are the models' names and trim offsets in bundle order.
    ///
    /// ```text
    /// 1  p: each perturbation coordinate, divided by its maximum magnitude in the bundle;
    ///    0 where a model lacks it
    /// 2  fit d(a,b)^2 ~ sum_k w_k (p_ak - p_bk)^2, w >= 0, by least absolute deviations over all model pairs
    /// 3  r_ab = d(a,b) / sqrt(fitted), r_a = median over b of r_ab; pairs with zero fitted distance are skipped
    /// ```
    ///
    /// Among equally good fits, the fit with the minimum sum of squared differences between fitted
    /// and computed distances is taken. A thousand models make half a million pairs: the fit ends
    /// without a result once it is `cancelled`.
    pub fn fit(
        distance: &BundleDistance,
        perturbations: &[(&str, Option<&BTreeMap<String, f64>>)],
        cancelled: &dyn Fn() -> bool,
    ) -> Result<Self, DiscontinuityError> {
        let models = distance.measured().compared_models();
        if models.len() < LEAST_MODELS {
            return Err(DiscontinuityError::TooFewModels {
                found: models.len(),
            });
        }
        let perturbations: Vec<_> = models.iter().map(|&model| perturbations[model]).collect();
        let coordinates = ScaledCoordinates::new(&perturbations)?;
        let mut rows = Vec::new();
        let mut squares = Vec::new();
        for a in 0..models.len() {
            for b in a + 1..models.len() {
                if let Some(distance) = distance.between(models[a], models[b]) {
                    squares.push(distance.powi(2));
                    rows.push(coordinates.squared_offsets(a, b));
                }
            }
        }
        let weights = least_absolute_deviations(&rows, &squares, cancelled)?;
        let mut ratios = vec![None; distance.measured().lacks.len()];
        for (a, &model) in models.iter().enumerate() {
            let mut to_others = Vec::new();
            for (b, &other) in models.iter().enumerate() {
                let fitted = coordinates.fitted_square(a, b, &weights);
                if b != a
                    && fitted > 0.0
                    && let Some(distance) = distance.between(model, other)
                {
                    to_others.push(distance / fitted.sqrt());
                }
            }
            if !to_others.is_empty() {
                ratios[model] = Some(median(&mut to_others));
            }
        }
        let mut coordinate_weights = Vec::new();
        for ((name, largest), weight) in coordinates.largest.into_iter().zip(weights) {
            coordinate_weights.push(CoordinateWeight {
                name: name.to_owned(),
                largest,
                weight,
            });
        }
        Ok(Self {
            ratios,
            weights: coordinate_weights,
        })
    }

    /// Returns `sqrt(sum_k w_k (p_ak - p_bk)^2)` for two trims: the distance explained by their
    /// perturbations.
    pub fn fitted_distance(&self, a: &BTreeMap<String, f64>, b: &BTreeMap<String, f64>) -> f64 {
        self.weights
            .iter()
            .map(|coordinate| {
                let offset = coordinate.value(a) - coordinate.value(b);
                coordinate.weight * (offset / coordinate.largest).powi(2)
            })
            .sum::<f64>()
            .sqrt()
    }

    /// Returns the models whose ratio exceeds [`SUGGESTION_RATIO`], in bundle order.
    pub fn suggested(&self) -> Vec<usize> {
        let mut suggested = Vec::new();
        for (model, ratio) in self.ratios.iter().enumerate() {
            if ratio.is_some_and(|ratio| ratio > SUGGESTION_RATIO) {
                suggested.push(model);
            }
        }
        suggested
    }
}

impl CoordinateWeight {
    /// Returns the coordinate in a perturbation; 0 where it is missing.
    fn value(&self, perturbation: &BTreeMap<String, f64>) -> f64 {
        perturbation.get(&self.name).copied().unwrap_or_default()
    }
}

/// The models' perturbation coordinates, scaled to at most 1.
#[derive(Debug)]
struct ScaledCoordinates<'a> {
    /// Maximum magnitude of each coordinate, by name; none is zero.
    largest: BTreeMap<&'a str, f64>,
    /// Each model's coordinates divided by the maximum magnitude, in the order of `largest`.
    models: Vec<Vec<f64>>,
}

impl<'a> ScaledCoordinates<'a> {
    fn new(
        perturbations: &[(&str, Option<&'a BTreeMap<String, f64>>)],
    ) -> Result<Self, DiscontinuityError> {
        let mut known = Vec::new();
        for (model, perturbation) in perturbations {
            let Some(perturbation) = perturbation else {
                return Err(DiscontinuityError::NoPerturbation {
                    model: (*model).to_owned(),
                });
            };
            known.push(*perturbation);
        }
        let mut largest: BTreeMap<&str, f64> = BTreeMap::new();
        for perturbation in &known {
            for (name, value) in *perturbation {
                let entry = largest.entry(name).or_default();
                *entry = entry.max(value.abs());
            }
        }
        largest.retain(|_, magnitude| *magnitude > 0.0);
        if largest.is_empty() {
            return Err(DiscontinuityError::AllZero);
        }
        let mut models = Vec::with_capacity(known.len());
        for perturbation in known {
            let mut scaled = Vec::with_capacity(largest.len());
            for (name, magnitude) in &largest {
                scaled.push(match perturbation.get(*name) {
                    Some(value) => value / magnitude,
                    None => 0.0,
                });
            }
            models.push(scaled);
        }
        Ok(Self { largest, models })
    }

    /// Returns `(p_ak - p_bk)^2` for each coordinate.
    fn squared_offsets(&self, a: usize, b: usize) -> Vec<f64> {
        self.models[a]
            .iter()
            .zip(&self.models[b])
            .map(|(a, b)| (a - b).powi(2))
            .collect()
    }

    /// Returns `sum_k w_k (p_ak - p_bk)^2`.
    fn fitted_square(&self, a: usize, b: usize, weights: &[f64]) -> f64 {
        self.squared_offsets(a, b)
            .iter()
            .zip(weights)
            .map(|(offset, weight)| offset * weight)
            .sum()
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

#[cfg(test)]
mod discontinuity_tests {
    use super::*;

    #[test]
    fn a_coordinate_no_model_is_perturbed_in_does_not_count() {
        let still = BTreeMap::from([("roll_deg".to_owned(), 0.0)]);
        let error = ScaledCoordinates::new(&[("nominal", Some(&still))]).unwrap_err();
        assert_eq!(error, DiscontinuityError::AllZero);
    }

    #[test]
    fn a_model_without_perturbation_is_named() {
        let error = ScaledCoordinates::new(&[("V+5kt", None)]).unwrap_err();
        assert_eq!(
            error,
            DiscontinuityError::NoPerturbation {
                model: "V+5kt".to_owned()
            }
        );
    }
}
