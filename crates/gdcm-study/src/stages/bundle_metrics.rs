//! Distances within each bundle, and discontinuity ratios for the physics bundle (M5).
//!
//! A *bundle* holds a condition's physics models or its identified models. The distance between two
//! of its models is the root of their mean J (M4); the discontinuity ratio of a physics model says
//! how much larger its distances are than its perturbed trim explains. Rejected models are
//! included; models *set aside*, which lack a response that another model of the bundle has (M5b),
//! are not.

use std::sync::Arc;

use gdcm_method::fidelity::absolute_deviations::FitError;
use gdcm_method::fidelity::discontinuity::{DiscontinuityError, PerturbedModel};
use gdcm_method::fidelity::distance::{
    BundleDistance, ComparedModel, MeasuredPairs, distances_from,
};
use gdcm_method::fidelity::{CoherenceWeights, Discontinuity};
use gdcm_model::dataset::{BundleKind, Condition, PairTable};
use gdcm_model::progress::Cancelled;
use gdcm_model::response::{FrequencyResponse, PolarResponse};

use super::compared_model::ComparisonGrid;
use super::condition_responses::ConditionResponses;
use crate::execution::Execution;
use crate::results::comparison::BundleMetrics;

impl BundleMetrics {
    /// Computes the distances within both bundles over the responses marked in `measuring`, and the
    /// discontinuity ratios; reports two progress steps per model. Measured models are compared
    /// with coherence weights if a minimum coherence is set (M4a).
    ///
    /// # Errors
    /// [`Cancelled`] where `execution` is cancelled.
    pub fn compute(
        condition: &Condition,
        responses: &ConditionResponses,
        measuring: &PairTable<bool>,
        grid: ComparisonGrid<'_>,
        execution: &Execution<'_>,
    ) -> Result<Self, Cancelled> {
        let distances = |kind| {
            let coherence_weights: Vec<Option<PairTable<CoherenceWeights>>> = condition
                .bundle(kind)
                .iter()
                .map(|model| {
                    CoherenceWeights::of_model(&model.dynamics, grid.grid.omega(), grid.coherence)
                })
                .collect();
            bundle_distance(
                responses.bundle(kind),
                &coherence_weights,
                measuring,
                execution,
            )
        };
        let physics = distances(BundleKind::Physics)?;
        let identified = distances(BundleKind::Identified)?;
        let models: Vec<PerturbedModel<'_>> = condition
            .bundle(BundleKind::Physics)
            .iter()
            .map(|model| PerturbedModel {
                name: &model.name,
                perturbation: model.perturbation(),
            })
            .collect();
        let discontinuity =
            Discontinuity::fit(&physics, &models, &|| execution.progress().cancelled());
        if discontinuity == Err(DiscontinuityError::Fit(FitError::Cancelled)) {
            return Err(Cancelled);
        }
        Ok(Self {
            physics,
            identified,
            discontinuity,
        })
    }
}

/// A bundle's frequency responses in polar form, and the output-input pairs in which the models are
/// compared.
pub(crate) struct MeasuredBundle {
    polar: Vec<PolarResponse>,
    pub(crate) measured: MeasuredPairs,
}

impl MeasuredBundle {
    /// Selects each model's marked responses, or all responses if no model has a marked response;
    /// reports one progress step per model.
    ///
    /// # Errors
    /// [`Cancelled`] where `execution` is cancelled.
    pub(crate) fn new(
        responses: &[Arc<FrequencyResponse>],
        measuring: &PairTable<bool>,
        execution: &Execution<'_>,
    ) -> Result<Self, Cancelled> {
        let polar = execution.each(responses.len(), 1, |model| {
            PolarResponse::from_marked(&responses[model], measuring)
        })?;
        let measured = MeasuredPairs::new(&polar, measuring);
        if !measured.compared.is_empty() {
            return Ok(Self { polar, measured });
        }
        let all_pairs = measuring.map(|_, _| true);
        let polar = execution.each(responses.len(), 0, |model| {
            PolarResponse::from_marked(&responses[model], &all_pairs)
        })?;
        let measured = MeasuredPairs::new(&polar, &all_pairs);
        Ok(Self { polar, measured })
    }
}

/// Computes the distances between all model pairs in a bundle; reports two progress steps per
/// model.
fn bundle_distance(
    responses: &[Arc<FrequencyResponse>],
    coherence_weights: &[Option<PairTable<CoherenceWeights>>],
    measuring: &PairTable<bool>,
    execution: &Execution<'_>,
) -> Result<BundleDistance, Cancelled> {
    let MeasuredBundle { polar, measured } = MeasuredBundle::new(responses, measuring, execution)?;
    let compared: Vec<ComparedModel<'_>> = measured
        .compared_models()
        .into_iter()
        .map(|model| ComparedModel {
            responses: &polar[model],
            coherence_weights: coherence_weights[model].as_ref(),
        })
        .collect();
    let rows = execution.each(compared.len(), 1, |index| {
        distances_from(index, &compared, &measured.compared)
    })?;
    // Models set aside have no distance row, but count as a step too.
    execution.step(polar.len() - compared.len());
    Ok(BundleDistance::from_rows(rows, measured))
}
