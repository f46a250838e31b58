//! Distances between the models of a bundle, its representative, and models beyond a discontinuity
//! (M5).

use std::cmp::Ordering;
use std::collections::{BTreeMap, BTreeSet};

use gdcm_model::dataset::{Pair, PairTable};
use gdcm_model::response::PolarResponse;
use gdcm_model::response::frequency_response::PolarCurve;
use gdcm_model::statistics::median;

use super::absolute_deviations::{FitError, least_absolute_deviations};
use super::cost::{Cost, CostAverage, mean_cost};
use super::mismatch::{CoherenceWeights, Mismatch};

/// The responses that measure distance in a bundle, and those that each model lacks (M5b).
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
    /// Finds the available and the missing responses of the models of a bundle among those marked
    /// in `measuring`.
    pub fn of(responses: &[PolarResponse], measuring: &PairTable<bool>) -> Self {
        let some_has = |pair: &Pair| {
            responses
                .iter()
                .any(|response| response.curves()[*pair].is_some())
        };
        let compared: Vec<Pair> = measuring.marked().filter(some_has).collect();
        let lacking = |response: &PolarResponse| {
            compared
                .iter()
                .copied()
                .filter(|pair| response.curves()[*pair].is_none())
                .collect()
        };
        let lacks = responses.iter().map(lacking).collect();
        Self { compared, lacks }
    }

    /// Returns the indices of the models that are not set aside, in bundle order.
    pub fn compared_models(&self) -> Vec<usize> {
        (0..self.lacks.len())
            .filter(|&model| !self.is_set_aside(model))
            .collect()
    }

    /// Whether a model is set aside.
    pub fn is_set_aside(&self, model: usize) -> bool {
        !self.lacks[model].is_empty()
    }
}

/// The distance of every two models of a bundle (M5): `d(a, b) = sqrt(mean over the measuring pairs
/// of J(a against b))`, J with the mean over frequency.
#[derive(Clone, Debug, PartialEq)]
pub struct BundleDistance {
    measured: MeasuredPairs,
    /// Number of models that are not set aside.
    count: usize,
    /// Position of each model among them; `None` if set aside.
    places: Vec<Option<usize>>,
    /// Upper triangle by rows, without the models set aside: d(0,1), d(0,2), ..., d(1,2), ...
    distances: Vec<f64>,
}

impl BundleDistance {
    /// Creates the table from rows: row `a` is [`distances_from`] the `a`-th model that is not set
    /// aside.
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
        self.distances
            .get(low * (2 * self.count - low - 1) / 2 + high - low - 1)
            .copied()
    }

    /// Returns the compared responses and the missing ones of each model.
    pub fn measured(&self) -> &MeasuredPairs {
        &self.measured
    }
}

/// A model of a bundle as the distance compares it.
#[derive(Clone, Copy, Debug)]
pub struct ComparedModel<'a> {
    pub responses: &'a PolarResponse,
    /// Weights of the frequencies of each response, if measured with coherence (M4a).
    pub coherence_weights: Option<&'a PairTable<CoherenceWeights>>,
}

impl ComparedModel<'_> {
    /// Computes J with this model as the reference, weighted by its coherence; `None` without
    /// weighted frequencies.
    fn cost_as_reference(&self, a: &PolarCurve, b: &PolarCurve, pair: Pair) -> Option<f64> {
        let mismatch =
            Mismatch::new(a, b).coherence_weighted(Some(&self.coherence_weights?[pair]))?;
        let magnitude_db = mismatch.magnitude_db.iter().copied();
        let phase = mismatch.phase.iter().copied();
        Some(
            Cost::of(
                magnitude_db,
                phase,
                mismatch.weights(),
                CostAverage::Mean,
                &mut Vec::new(),
            )
            .total(),
        )
    }
}

/// Computes the distances of one model from each of the models after it: independent tasks for a
/// large bundle.
///
/// J is weighted by the coherence of the reference model (M4a), and in a bundle either model can be
/// the reference: if one of the two has coherence, J is the mean of both directions, so that a
/// distance does not depend on the order of the models. A response without any weighted frequency
/// is compared over all frequencies, because poorly measured models must not look alike.
pub fn distances_from(a: usize, models: &[ComparedModel<'_>], compared: &[Pair]) -> Vec<f64> {
    let of_pair = |b: &ComparedModel<'_>, pair: Pair| {
        let from = models[a].responses.curves()[pair].as_ref()?;
        let to = b.responses.curves()[pair].as_ref()?;
        if models[a].coherence_weights.is_none() && b.coherence_weights.is_none() {
            return Some(mean_cost(from, to));
        }
        let ways = [models[a], *b].map(|reference| reference.cost_as_reference(from, to, pair));
        let [one, other] = ways.map(|cost| cost.unwrap_or_else(|| mean_cost(from, to)));
        Some(0.5 * (one + other))
    };
    let distance = |b: &ComparedModel<'_>| {
        let sum: f64 = compared.iter().filter_map(|&pair| of_pair(b, pair)).sum();
        (sum / compared.len().max(1) as f64).sqrt()
    };
    models[a + 1..].iter().map(distance).collect()
}

/// The medoid of the accepted models, or the model pinned by the analyst, with the score of every
/// accepted model (M5).
#[derive(Clone, Debug, PartialEq)]
pub struct Representative {
    /// Index of the representative in the bundle.
    pub model: usize,
    /// `s_a = mean over b != a of d(a, b)` over the accepted models; `None` for a model that is
    /// rejected or set aside. Zero for a single accepted model.
    pub scores: Vec<Option<f64>>,
}

impl Representative {
    /// Returns the accepted model with the smallest score (ties: the first in file order), or
    /// `pinned`; `None` if every model is rejected or set aside. A pinned model that is set aside
    /// is ignored.
    pub fn of(
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
        let by_score = |&&a: &&usize, &&b: &&usize| {
            scores[a].partial_cmp(&scores[b]).unwrap_or(Ordering::Equal)
        };
        let medoid = *kept.iter().min_by(by_score)?;
        Some(Self {
            model: pinned
                .filter(|model| kept.contains(model))
                .unwrap_or(medoid),
            scores,
        })
    }
}

/// Discontinuity ratio above which a model is suggested as an outlier.
pub const SUGGESTION_RATIO: f64 = 2.5;
/// Fewest models of a bundle for the outlier search.
const LEAST_MODELS: usize = 5;

/// Ratio of each physics model's distance from the others to the distance explained by its
/// perturbation.
#[derive(Clone, Debug, PartialEq)]
pub struct Discontinuity {
    /// `r_a`, one per model: near 1 in a smooth bundle. `None` for a model set aside, and if no
    /// pair has a fitted distance.
    pub ratios: Vec<Option<f64>>,
    /// Weights of the fit, one for each perturbed coordinate.
    pub weights: Vec<CoordinateWeight>,
}

/// Contribution of one perturbation coordinate to the squared distance.
#[derive(Clone, Debug, PartialEq)]
pub struct CoordinateWeight {
    /// Name of the coordinate ("airspeed_kt").
    pub name: String,
    /// Its largest magnitude in the bundle, used as the scale.
    pub largest: f64,
    /// `w_k`.
    pub weight: f64,
}

/// Reasons for a missing discontinuity ratio.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum DiscontinuityError {
    /// The bundle is too small for a fit.
    #[error(
        "outliers are suggested from {LEAST_MODELS} physics models on, this bundle has {found}"
    )]
    TooFewModels {
        /// Number of models in the bundle.
        found: usize,
    },
    /// A model does not state the trim of its linearisation.
    #[error("outliers cannot be suggested: model \"{model}\" gives no perturbation")]
    NoPerturbation {
        /// Name of the model.
        model: String,
    },
    /// All models were linearised at the same trim.
    #[error("outliers cannot be suggested: every perturbation is zero")]
    AllZero,
    #[error("outliers cannot be suggested: {0}")]
    Fit(#[from] FitError),
}

impl Discontinuity {
    /// Computes the ratios of a whole bundle, including rejected models but not those set aside;
    /// `perturbations` are the models' names and trim offsets in bundle order.
    ///
    /// Each coordinate is divided by its largest magnitude. The fit `d(a,b)^2 ~ sum_k w_k (p_ak -
    /// p_bk)^2`, `w >= 0`, minimises the absolute deviations over all pairs (ties: the fit whose
    /// fitted distances are closest to the distances in least squares); `r_ab = d(a,b) /
    /// sqrt(fitted)`, `r_a = median over b of r_ab`; pairs with zero fitted distance are skipped. A
    /// coordinate missing from a model counts as zero. The fit, over half a million pairs for a
    /// thousand models, ends without a result once it is `cancelled`.
    pub fn of(
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
        let (largest, coordinates) = scaled_coordinates(&perturbations)?;
        let mut rows = Vec::new();
        let mut squares = Vec::new();
        for (a, b) in model_pairs(models.len()) {
            if let Some(distance) = distance.between(models[a], models[b]) {
                squares.push(distance.powi(2));
                rows.push(squared_offsets(&coordinates[a], &coordinates[b]));
            }
        }
        let weights = least_absolute_deviations(&rows, &squares, cancelled)?;
        let ratio = |a: usize, b: usize| {
            let offsets = squared_offsets(&coordinates[a], &coordinates[b]);
            let fitted: f64 = offsets
                .iter()
                .zip(&weights)
                .map(|(offset, weight)| offset * weight)
                .sum();
            let distance = distance.between(models[a], models[b])?;
            (fitted > 0.0).then(|| distance / fitted.sqrt())
        };
        let mut ratios = vec![None; distance.measured().lacks.len()];
        for (a, &model) in models.iter().enumerate() {
            let mut others: Vec<f64> = (0..models.len())
                .filter(|&b| b != a)
                .filter_map(|b| ratio(a, b))
                .collect();
            ratios[model] = (!others.is_empty()).then(|| median(&mut others));
        }
        let named = largest.into_iter().zip(weights);
        let weights = named.map(|((name, largest), weight)| CoordinateWeight {
            name: name.to_owned(),
            largest,
            weight,
        });
        Ok(Self {
            ratios,
            weights: weights.collect(),
        })
    }

    /// Returns `sqrt(sum_k w_k (p_ak - p_bk)^2)` for two trims: the distance explained by their
    /// perturbations.
    pub fn fitted_distance(&self, a: &BTreeMap<String, f64>, b: &BTreeMap<String, f64>) -> f64 {
        let at = |of: &BTreeMap<String, f64>, name: &str| of.get(name).copied().unwrap_or_default();
        let square = |of: &CoordinateWeight| {
            of.weight * ((at(a, &of.name) - at(b, &of.name)) / of.largest).powi(2)
        };
        self.weights.iter().map(square).sum::<f64>().sqrt()
    }

    /// Returns the models whose ratio exceeds [`SUGGESTION_RATIO`], in bundle order.
    pub fn suggested(&self) -> Vec<usize> {
        let above =
            |model: &usize| self.ratios[*model].is_some_and(|ratio| ratio > SUGGESTION_RATIO);
        (0..self.ratios.len()).filter(above).collect()
    }
}

fn model_pairs(models: usize) -> impl Iterator<Item = (usize, usize)> {
    (0..models).flat_map(move |a| (a + 1..models).map(move |b| (a, b)))
}

/// The largest magnitude of each coordinate, and each model's coordinates divided by it.
type Coordinates<'a> = (BTreeMap<&'a str, f64>, Vec<Vec<f64>>);

fn scaled_coordinates<'a>(
    perturbations: &[(&str, Option<&'a BTreeMap<String, f64>>)],
) -> Result<Coordinates<'a>, DiscontinuityError> {
    let mut largest: BTreeMap<&str, f64> = BTreeMap::new();
    for (model, perturbation) in perturbations {
        let Some(perturbation) = perturbation else {
            return Err(DiscontinuityError::NoPerturbation {
                model: (*model).to_owned(),
            });
        };
        for (name, value) in *perturbation {
            let entry = largest.entry(name).or_default();
            *entry = entry.max(value.abs());
        }
    }
    largest.retain(|_, magnitude| *magnitude > 0.0);
    if largest.is_empty() {
        return Err(DiscontinuityError::AllZero);
    }
    let scaled = |perturbation: &BTreeMap<String, f64>| {
        largest
            .iter()
            .map(|(name, magnitude)| {
                perturbation
                    .get(*name)
                    .map_or(0.0, |value| value / magnitude)
            })
            .collect()
    };
    let scaled = perturbations
        .iter()
        .filter_map(|(_, perturbation)| perturbation.map(scaled))
        .collect();
    Ok((largest, scaled))
}

fn squared_offsets(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).collect()
}

#[cfg(test)]
mod tests {
    use gdcm_model::dataset::Dynamics;
    use gdcm_model::dataset::measured_response::MeasuredResponse;
    use gdcm_model::response::{FrequencyGrid, FrequencyResponse};

    use super::*;

    /// A response equal to 1, except in the upper half of the band: `upper`, with this coherence.
    fn measured(upper: f64, coherence: f64) -> Dynamics {
        let table = |low: f64, high: f64| PairTable::filled(1, 1, vec![low, low, high, high]);
        let coherence = Some(table(1.0, coherence));
        let omega = vec![1.0, 2.99, 3.01, 9.0];
        Dynamics::Measured(
            MeasuredResponse::new(omega, &table(1.0, upper), &table(0.0, 0.0), coherence).unwrap(),
        )
    }

    fn distances(models: &[Dynamics], threshold: Option<f64>) -> Vec<f64> {
        let grid =
            FrequencyGrid::logarithmic(gdcm_model::dataset::Band::new(1.0, 9.0).unwrap(), 100);
        let of = |model| PolarResponse::new(&FrequencyResponse::of(model, &grid));
        let responses: Vec<PolarResponse> = models.iter().map(of).collect();
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
    fn what_was_not_measured_counts_in_a_distance_one_way_only_where_the_other_model_has_it() {
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
        // One direction contributes half of J at the weight 0.879, the other nothing.
        assert!(
            (weighed / apart - (0.5 * super::super::mismatch::coherence_weight(0.9)).sqrt()).abs()
                < 0.01
        );
    }
}

#[cfg(test)]
mod discontinuity_tests {
    use super::*;

    #[test]
    fn a_coordinate_no_model_is_perturbed_in_does_not_count() {
        let still = BTreeMap::from([("roll_deg".to_owned(), 0.0)]);
        let error = scaled_coordinates(&[("nominal", Some(&still))]).unwrap_err();
        assert_eq!(error, DiscontinuityError::AllZero);
    }

    #[test]
    fn a_model_without_perturbation_is_named() {
        let error = scaled_coordinates(&[("V+5kt", None)]).unwrap_err();
        assert_eq!(
            error,
            DiscontinuityError::NoPerturbation {
                model: "V+5kt".to_owned()
            }
        );
    }
}
