//! Models beyond a discontinuity in the physics bundle: models that are further from the others
//! than their perturbed trim explains (M5). A *bundle* is a condition's models, linearised at the
//! trim and at perturbed trims; the *distance* `d(a, b)` of two of them is the root of the mean
//! cost J over the on-axis responses (`distance`).

use std::collections::BTreeMap;

use gdcm_model::statistics::median;

use super::absolute_deviations::{FitError, least_absolute_deviations};
use super::distance::BundleDistance;

/// Discontinuity ratio above which a model is suggested as an outlier. It is not from a source: in
/// the example, the three models beyond a discontinuity have ratios of 2.9 to 4.0, all others of
/// 0.93 to 1.12.
pub const SUGGESTION_RATIO: f64 = 2.5;
/// Minimum count of models for the outlier search, without those that are *set aside*
/// ([`MeasuredPairs`](super::distance::MeasuredPairs)). Five models have ten distances for the fit,
/// and a median over four ratios is not decided by one outlier among them.
const LEAST_MODELS: usize = 5;

/// A physics model's name and trim.
#[derive(Clone, Copy, Debug)]
pub struct PerturbedModel<'a> {
    pub name: &'a str,
    /// How far each trim coordinate is from its nominal value, by name; `None` if unknown.
    pub perturbation: Option<&'a BTreeMap<String, f64>>,
}

/// Each physics model's distance from the others, relative to the distance explained by its
/// perturbation.
#[derive(Clone, Debug, PartialEq)]
pub struct Discontinuity {
    /// `r_a` for each model: near 1 in a smooth bundle. `None` for a model that is set aside, or
    /// whose fitted distance from every other model is zero.
    pub ratios: Vec<Option<f64>>,
    /// Fitted weight for each perturbed coordinate.
    pub weights: Vec<CoordinateWeight>,
}

impl Discontinuity {
    /// Computes the ratios in a whole bundle, including rejected models but not those set aside;
    /// `bundle` lists the models in bundle order.
    ///
    /// ```text
    /// 1  p_ak: perturbation coordinate k of model a, divided by the coordinate's maximum
    ///    magnitude over these models; 0 where the model lacks it
    /// 2  fit d(a,b)^2 ~ sum_k w_k (p_ak - p_bk)^2, w >= 0, by least absolute deviations over all model pairs
    /// 3  r_ab = d(a,b) / sqrt(fitted), r_a = median over b of r_ab; pairs with zero fitted distance are skipped
    /// ```
    ///
    /// Among equally good fits, the fit with the minimum sum of squared differences between fitted
    /// and computed distances is taken. A thousand models make half a million pairs: the fit ends
    /// without a result once it is `cancelled`.
    ///
    /// # Errors
    /// [`DiscontinuityError`] if the bundle is too small, a model has no perturbation, every
    /// perturbation is zero, or the fit fails or is cancelled.
    pub fn fit(
        distances: &BundleDistance,
        bundle: &[PerturbedModel<'_>],
        cancelled: &dyn Fn() -> bool,
    ) -> Result<Self, DiscontinuityError> {
        let compared = distances.measured().compared_models();
        if compared.len() < LEAST_MODELS {
            return Err(DiscontinuityError::TooFewModels {
                found: compared.len(),
            });
        }
        let models: Vec<_> = compared.iter().map(|&model| bundle[model]).collect();
        let trims = ScaledTrims::new(&models)?;
        let weights = fit_weights(distances, &compared, &trims, cancelled)?;
        let mut ratios = vec![None; bundle.len()];
        for (place, &model) in compared.iter().enumerate() {
            ratios[model] = ratio(distances, &compared, &trims, &weights, place);
        }
        Ok(Self {
            ratios,
            weights: trims.coordinate_weights(weights),
        })
    }

    /// Returns `r_ab` of a model, given by its index in the bundle, for each other model `b` in
    /// bundle order (step 3): their median is `r_a`. Empty for a model that is set aside.
    ///
    /// `distances` and `bundle` are those of the fit.
    pub fn pair_ratios(
        &self,
        distances: &BundleDistance,
        bundle: &[PerturbedModel<'_>],
        model: usize,
    ) -> Vec<f64> {
        let compared = distances.measured().compared_models();
        let Some(place) = compared.iter().position(|&other| other == model) else {
            return Vec::new();
        };
        let models: Vec<_> = compared.iter().map(|&other| bundle[other]).collect();
        let Ok(trims) = ScaledTrims::new(&models) else {
            return Vec::new();
        };
        let weights: Vec<f64> = self
            .weights
            .iter()
            .map(|coordinate| coordinate.weight)
            .collect();
        pair_ratios(distances, &compared, &trims, &weights, place)
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

/// Step 2: fits the weights `w_k` to the squared distances between all compared models, which
/// `compared` lists by index in the bundle. Their index in `compared` is their *place*.
fn fit_weights(
    distances: &BundleDistance,
    compared: &[usize],
    trims: &ScaledTrims<'_>,
    cancelled: &dyn Fn() -> bool,
) -> Result<Vec<f64>, FitError> {
    let mut rows = Vec::new();
    let mut squares = Vec::new();
    // `a`, `b`: places, each pair of models once.
    for a in 0..compared.len() {
        for b in a + 1..compared.len() {
            if let Some(distance) = distances.between(compared[a], compared[b]) {
                squares.push(distance.powi(2));
                rows.push(trims.squared_offsets(a, b));
            }
        }
    }
    least_absolute_deviations(&rows, &squares, cancelled)
}

/// Step 3: computes `r_a` for the compared model at place `a`; `None` if it has no fitted distance
/// from any other model.
fn ratio(
    distances: &BundleDistance,
    compared: &[usize],
    trims: &ScaledTrims<'_>,
    weights: &[f64],
    a: usize,
) -> Option<f64> {
    let mut ratios = pair_ratios(distances, compared, trims, weights, a);
    if ratios.is_empty() {
        None
    } else {
        Some(median(&mut ratios))
    }
}

/// Step 3: computes `r_ab` for the compared model at place `a` and each other model `b` from which
/// its fitted distance is not zero.
fn pair_ratios(
    distances: &BundleDistance,
    compared: &[usize],
    trims: &ScaledTrims<'_>,
    weights: &[f64],
    a: usize,
) -> Vec<f64> {
    let mut ratios = Vec::new();
    for (b, &other) in compared.iter().enumerate() {
        let fitted_square = trims.fitted_square(a, b, weights);
        if b != a
            && fitted_square > 0.0
            && let Some(distance) = distances.between(compared[a], other)
        {
            ratios.push(distance / fitted_square.sqrt());
        }
    }
    ratios
}

/// A perturbation coordinate's contribution to the squared distance.
#[derive(Clone, Debug, PartialEq)]
pub struct CoordinateWeight {
    /// Coordinate name ("airspeed_kt").
    pub name: String,
    /// The coordinate's maximum magnitude over the compared models; perturbations are divided by
    /// it.
    pub largest: f64,
    /// Fitted weight `w_k`.
    pub weight: f64,
}

impl CoordinateWeight {
    /// Returns the coordinate in a perturbation; 0 where it is missing.
    fn value(&self, perturbation: &BTreeMap<String, f64>) -> f64 {
        perturbation.get(&self.name).copied().unwrap_or_default()
    }
}

/// Reasons for a missing discontinuity ratio.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum DiscontinuityError {
    /// The bundle has too few models, not counting those set aside.
    #[error(
        "outliers are suggested only in bundles of at least {LEAST_MODELS} physics models that \
        are not set aside; this bundle has {found}"
    )]
    TooFewModels {
        /// Models in the bundle that are not set aside.
        found: usize,
    },
    /// A model has no perturbation data.
    #[error(
        "outliers cannot be suggested: the trim offsets (\"perturbation\") of model \"{model}\" are not given"
    )]
    NoPerturbation { model: String },
    /// Every perturbation coordinate is zero: all models were linearised at the same trim.
    #[error(
        "outliers cannot be suggested: every trim offset (\"perturbation\") is zero, so all models \
        have the same trim"
    )]
    AllZero,
    #[error("outliers cannot be suggested: {0}")]
    Fit(#[from] FitError),
}

/// The compared models' perturbation coordinates, scaled to at most 1 (step 1).
#[derive(Debug)]
struct ScaledTrims<'a> {
    /// Each coordinate's maximum magnitude over the compared models, by name; none is zero.
    largest_magnitudes: BTreeMap<&'a str, f64>,
    /// `p_ak`: coordinates `k`, ordered as in `largest_magnitudes`, for the model at place `a`.
    scaled: Vec<Vec<f64>>,
}

impl<'a> ScaledTrims<'a> {
    fn new(models: &[PerturbedModel<'a>]) -> Result<Self, DiscontinuityError> {
        let mut perturbations = Vec::new();
        for model in models {
            let Some(perturbation) = model.perturbation else {
                return Err(DiscontinuityError::NoPerturbation {
                    model: model.name.to_owned(),
                });
            };
            perturbations.push(perturbation);
        }
        let mut largest_magnitudes: BTreeMap<&str, f64> = BTreeMap::new();
        for perturbation in &perturbations {
            for (name, value) in *perturbation {
                let largest = largest_magnitudes.entry(name).or_default();
                *largest = largest.max(value.abs());
            }
        }
        largest_magnitudes.retain(|_, magnitude| *magnitude > 0.0);
        if largest_magnitudes.is_empty() {
            return Err(DiscontinuityError::AllZero);
        }
        let mut scaled = Vec::with_capacity(perturbations.len());
        for perturbation in perturbations {
            let mut coordinates = Vec::with_capacity(largest_magnitudes.len());
            for (name, magnitude) in &largest_magnitudes {
                coordinates.push(match perturbation.get(*name) {
                    Some(value) => value / magnitude,
                    None => 0.0,
                });
            }
            scaled.push(coordinates);
        }
        Ok(Self {
            largest_magnitudes,
            scaled,
        })
    }

    /// Returns `(p_ak - p_bk)^2` for each coordinate `k`.
    fn squared_offsets(&self, a: usize, b: usize) -> Vec<f64> {
        self.scaled[a]
            .iter()
            .zip(&self.scaled[b])
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

    /// Joins the fitted weights with their coordinates' names and magnitudes.
    fn coordinate_weights(self, weights: Vec<f64>) -> Vec<CoordinateWeight> {
        let mut joined = Vec::with_capacity(weights.len());
        for ((name, largest), weight) in self.largest_magnitudes.into_iter().zip(weights) {
            joined.push(CoordinateWeight {
                name: name.to_owned(),
                largest,
                weight,
            });
        }
        joined
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_coordinate_no_model_is_perturbed_in_does_not_count() {
        let still = BTreeMap::from([("roll_deg".to_owned(), 0.0)]);
        let nominal = PerturbedModel {
            name: "nominal",
            perturbation: Some(&still),
        };
        let error = ScaledTrims::new(&[nominal]).unwrap_err();
        assert_eq!(error, DiscontinuityError::AllZero);
    }

    #[test]
    fn a_model_without_perturbation_is_named() {
        let model = PerturbedModel {
            name: "V+5kt",
            perturbation: None,
        };
        let error = ScaledTrims::new(&[model]).unwrap_err();
        assert_eq!(
            error,
            DiscontinuityError::NoPerturbation {
                model: "V+5kt".to_owned()
            }
        );
    }
}
