//! Models on the far side of a discontinuity near the trim (M5).

use std::collections::BTreeMap;

use crate::response::median;

use super::absolute_deviations::{FitError, least_absolute_deviations};
use super::distance::BundleDistance;

/// Discontinuity ratio above which a model is suggested as an outlier.
pub const SUGGESTION_RATIO: f64 = 2.5;
/// Fewest models of a bundle in which outliers are looked for.
const LEAST_MODELS: usize = 5;

/// How much faster than the perturbation explains each model of a physics bundle differs from the others.
#[derive(Clone, Debug, PartialEq)]
pub struct Discontinuity {
    /// `r_a`, one for each model: near 1 in a smooth bundle. `None` for a model set aside, and where no pair has a fitted distance.
    pub ratios: Vec<Option<f64>>,
    /// What the fit explains distance by, one for each coordinate in which some model is perturbed.
    pub weights: Vec<CoordinateWeight>,
}

/// What one coordinate of the perturbation explains of the squared distance.
#[derive(Clone, Debug, PartialEq)]
pub struct CoordinateWeight {
    /// Name of the coordinate ("airspeed_kt").
    pub name: String,
    /// Its largest magnitude in the bundle, by which it is divided.
    pub largest: f64,
    /// `w_k`.
    pub weight: f64,
}

/// Why no discontinuity ratio could be had.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum DiscontinuityError {
    /// The bundle is too small for a fit.
    #[error("outliers are suggested from {LEAST_MODELS} physics models on, this bundle has {found}")]
    TooFewModels {
        /// Number of models.
        found: usize,
    },
    /// A model does not say at which trim it was linearised.
    #[error("outliers cannot be suggested: model \"{model}\" gives no perturbation")]
    NoPerturbation {
        /// The model's name.
        model: String,
    },
    /// All models were linearised at the same trim.
    #[error("outliers cannot be suggested: every perturbation is zero")]
    AllZero,
    /// There is no fit.
    #[error("outliers cannot be suggested: {0}")]
    Fit(#[from] FitError),
}

impl Discontinuity {
    /// Ratios of a whole bundle, whatever is rejected, as if the models set aside were not there; `perturbations` are the models'
    /// names and trim offsets in bundle order.
    ///
    /// Each coordinate is divided by its largest magnitude. The fit `d(a,b)^2 ~ sum_k w_k (p_ak - p_bk)^2`, `w >= 0`, is the
    /// least in absolute deviations over all pairs (of equally good ones, the one whose fitted distances come nearest to the
    /// distances in least squares); `r_ab = d(a,b) / sqrt(fitted)`, `r_a = median over b of r_ab`, pairs of zero fitted
    /// distance skipped. A coordinate that a model does not name counts as zero. The fit, over half a million pairs of a thousand
    /// models, ends without a result once it is `cancelled`.
    pub fn of(
        distance: &BundleDistance,
        perturbations: &[(&str, Option<&BTreeMap<String, f64>>)],
        cancelled: &dyn Fn() -> bool,
    ) -> Result<Self, DiscontinuityError> {
        let models = distance.measured().compared_models();
        if models.len() < LEAST_MODELS {
            return Err(DiscontinuityError::TooFewModels { found: models.len() });
        }
        let perturbations: Vec<_> = models.iter().map(|&model| perturbations[model]).collect();
        let (largest, coordinates) = scaled_coordinates(&perturbations)?;
        let (mut rows, mut squares) = (Vec::new(), Vec::new());
        for (a, b) in model_pairs(models.len()) {
            if let Some(distance) = distance.between(models[a], models[b]) {
                squares.push(distance.powi(2));
                rows.push(squared_offsets(&coordinates[a], &coordinates[b]));
            }
        }
        let weights = least_absolute_deviations(&rows, &squares, cancelled)?;
        let ratio = |a: usize, b: usize| {
            let offsets = squared_offsets(&coordinates[a], &coordinates[b]);
            let fitted: f64 = offsets.iter().zip(&weights).map(|(offset, weight)| offset * weight).sum();
            let distance = distance.between(models[a], models[b])?;
            (fitted > 0.0).then(|| distance / fitted.sqrt())
        };
        let mut ratios = vec![None; distance.measured().lacks.len()];
        for (a, &model) in models.iter().enumerate() {
            let mut others: Vec<f64> = (0..models.len()).filter(|&b| b != a).filter_map(|b| ratio(a, b)).collect();
            ratios[model] = (!others.is_empty()).then(|| median(&mut others));
        }
        let named = largest.into_iter().zip(weights);
        let weights =
            named.map(|((name, largest), weight)| CoordinateWeight { name: name.to_owned(), largest, weight });
        Ok(Self { ratios, weights: weights.collect() })
    }

    /// `sqrt(sum_k w_k (p_ak - p_bk)^2)` of two trims: the distance that their perturbations explain.
    pub fn fitted_distance(&self, a: &BTreeMap<String, f64>, b: &BTreeMap<String, f64>) -> f64 {
        let at = |of: &BTreeMap<String, f64>, name: &str| of.get(name).copied().unwrap_or_default();
        let square = |of: &CoordinateWeight| of.weight * ((at(a, &of.name) - at(b, &of.name)) / of.largest).powi(2);
        self.weights.iter().map(square).sum::<f64>().sqrt()
    }

    /// Models whose ratio exceeds [`SUGGESTION_RATIO`], in bundle order.
    pub fn suggested(&self) -> Vec<usize> {
        let above = |model: &usize| self.ratios[*model].is_some_and(|ratio| ratio > SUGGESTION_RATIO);
        (0..self.ratios.len()).filter(above).collect()
    }
}

fn model_pairs(models: usize) -> impl Iterator<Item = (usize, usize)> {
    (0..models).flat_map(move |a| (a + 1..models).map(move |b| (a, b)))
}

/// The largest magnitude of each coordinate, and the coordinates of each model divided by them.
type Coordinates<'a> = (BTreeMap<&'a str, f64>, Vec<Vec<f64>>);

fn scaled_coordinates<'a>(
    perturbations: &[(&str, Option<&'a BTreeMap<String, f64>>)],
) -> Result<Coordinates<'a>, DiscontinuityError> {
    let mut largest: BTreeMap<&str, f64> = BTreeMap::new();
    for (model, perturbation) in perturbations {
        let Some(perturbation) = perturbation else {
            return Err(DiscontinuityError::NoPerturbation { model: (*model).to_owned() });
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
        largest.iter().map(|(name, magnitude)| perturbation.get(*name).map_or(0.0, |value| value / magnitude)).collect()
    };
    let scaled = perturbations.iter().filter_map(|(_, perturbation)| perturbation.map(scaled)).collect();
    Ok((largest, scaled))
}

fn squared_offsets(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).collect()
}

#[cfg(test)]
mod tests {
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
        assert_eq!(error, DiscontinuityError::NoPerturbation { model: "V+5kt".to_owned() });
    }
}
