//! Distances within each bundle, and discontinuity ratios for the physics bundle (M5).
//!
//! ```text
//! 1  magnitude and phase of the on-axis responses of each model; of all, if none has on-axis ones
//! 2  models set aside: those that lack a response which another model of the bundle has (M5b)
//! 3  distance of every two other models: the root of their mean J
//! 4  physics bundle only: each model's discontinuity ratio
//! ```
//!
//! A *bundle* holds a condition's physics models or its identified models; rejected models are
//! included. J is the mismatch cost (M4). The *discontinuity ratio* says how much larger a model's
//! distances are than its perturbed trim explains.

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
    /// Computes the distances within both bundles over the responses marked in `on_axis`, and the
    /// discontinuity ratios; reports two progress steps per model. Models that are measured
    /// responses are compared with coherence weights if a minimum coherence is set (M4a).
    ///
    /// # Errors
    /// [`Cancelled`] where `execution` is cancelled.
    pub fn compute(
        condition: &Condition,
        responses: &ConditionResponses,
        on_axis: &PairTable<bool>,
        grid: ComparisonGrid<'_>,
        execution: &Execution<'_>,
    ) -> Result<Self, Cancelled> {
        // Steps 1 to 3.
        let [physics_weights, identified_weights] =
            BundleKind::BOTH.map(|kind| coherence_weights(condition, kind, grid));
        let physics = bundle_distance(&responses.physics, &physics_weights, on_axis, execution)?;
        let identified = bundle_distance(
            &responses.identified,
            &identified_weights,
            on_axis,
            execution,
        )?;
        // Step 4.
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

/// Returns the coherence weights for each model in a bundle; `None` where coherence is not used.
fn coherence_weights(
    condition: &Condition,
    kind: BundleKind,
    grid: ComparisonGrid<'_>,
) -> Vec<Option<PairTable<CoherenceWeights>>> {
    let mut weights = Vec::new();
    for model in condition.bundle(kind) {
        let omega = grid.grid.omega();
        weights.push(CoherenceWeights::of_model(
            &model.dynamics,
            omega,
            grid.coherence,
        ));
    }
    weights
}

/// A bundle's frequency responses in polar form, and the output-input pairs in which the models are
/// compared.
pub(crate) struct ComparableBundle {
    polar: Vec<PolarResponse>,
    /// The compared pairs, and those that each model lacks.
    pub(crate) pairs: MeasuredPairs,
}

impl ComparableBundle {
    /// Selects each model's responses marked in `on_axis`, or all responses if no model has a
    /// marked response (steps 1 and 2); reports one progress step per model.
    ///
    /// # Errors
    /// [`Cancelled`] where `execution` is cancelled.
    pub(crate) fn new(
        responses: &[Arc<FrequencyResponse>],
        on_axis: &PairTable<bool>,
        execution: &Execution<'_>,
    ) -> Result<Self, Cancelled> {
        let polar = execution.each(responses.len(), 1, |model| {
            PolarResponse::from_marked(&responses[model], on_axis)
        })?;
        let pairs = MeasuredPairs::new(&polar, on_axis);
        if !pairs.compared.is_empty() {
            return Ok(Self { polar, pairs });
        }
        let all_pairs = on_axis.map(|_, _| true);
        // The models' steps are already reported.
        let polar = execution.each(responses.len(), 0, |model| {
            PolarResponse::from_marked(&responses[model], &all_pairs)
        })?;
        let pairs = MeasuredPairs::new(&polar, &all_pairs);
        Ok(Self { polar, pairs })
    }
}

/// Computes the distances between every two models in a bundle that are not set aside (steps 1 to
/// 3); reports two progress steps per model.
fn bundle_distance(
    responses: &[Arc<FrequencyResponse>],
    coherence_weights: &[Option<PairTable<CoherenceWeights>>],
    on_axis: &PairTable<bool>,
    execution: &Execution<'_>,
) -> Result<BundleDistance, Cancelled> {
    let ComparableBundle { polar, pairs } = ComparableBundle::new(responses, on_axis, execution)?;
    let compared: Vec<ComparedModel<'_>> = pairs
        .compared_models()
        .into_iter()
        .map(|model| ComparedModel {
            responses: &polar[model],
            coherence_weights: coherence_weights[model].as_ref(),
        })
        .collect();
    let rows = execution.each(compared.len(), 1, |index| {
        distances_from(index, &compared, &pairs.compared)
    })?;
    // Models set aside have no distance row, but count as a step too.
    execution.step(polar.len() - compared.len());
    Ok(BundleDistance::from_rows(rows, pairs))
}
