//! Inputs for comparing a condition's models, and the parts of the comparison that need only these
//! inputs: prepared models, cautions, representatives, mismatches.

use std::collections::BTreeSet;

use gdcm_method::fidelity::CostAverage;
use gdcm_method::fidelity::representative::Representative;
use gdcm_model::dataset::{BundleKind, Condition, Model};
use gdcm_model::response::GainDelay;

use super::compared_model::{ComparedModel, ComparisonGrid};
use super::condition_responses::ConditionResponses;
use super::model_cautions::BundleCautions;
use crate::decisions::choices::ConditionChoice;
use crate::results::analysis::ConditionFailure;
use crate::results::caution::Caution;
use crate::results::comparison::{BundleMetrics, ModelMismatch};

/// Inputs for comparing a condition's models.
#[derive(Clone, Copy)]
pub(crate) struct ComparisonInput<'a> {
    pub(crate) condition: &'a Condition,
    pub(crate) responses: &'a ConditionResponses,
    pub(crate) metrics: &'a BundleMetrics,
    pub(crate) grid: ComparisonGrid<'a>,
    pub(crate) choice: &'a ConditionChoice,
    /// Average over frequency in J.
    pub(crate) average: CostAverage,
}

impl ComparisonInput<'_> {
    /// Returns a model by its index in a bundle.
    pub(super) fn model(&self, kind: BundleKind, index: usize) -> &Model {
        &self.condition.bundle(kind)[index]
    }

    /// Prepares a bundle's model for comparison.
    pub(super) fn compared(&self, kind: BundleKind, index: usize) -> ComparedModel {
        ComparedModel::new(self.condition, self.responses, kind, index, self.grid)
    }

    /// Returns the cautions about both bundles' kept models.
    pub(super) fn model_cautions(&self) -> Vec<Caution> {
        let omega = self.grid.grid.omega();
        let mut cautions = Vec::new();
        for kind in BundleKind::BOTH {
            let bundle = BundleCautions {
                condition: self.condition,
                kind,
                choice: self.choice.bundle(kind),
                responses: self.responses,
                pairs: self.metrics.bundle(kind).measured(),
                band_top: omega.last().copied().unwrap_or_default(),
            };
            cautions.extend(bundle.find());
        }
        cautions
    }

    /// Selects a bundle's representative among its kept models.
    pub(super) fn representative(
        &self,
        kind: BundleKind,
    ) -> Result<Representative, ConditionFailure> {
        let choice = self.choice.bundle(kind);
        let position = |name: &String| self.condition.position(kind, name);
        let rejected: BTreeSet<usize> = choice.rejected.iter().filter_map(position).collect();
        let pinned = choice.pinned.as_ref().and_then(position);
        Representative::select(self.metrics.bundle(kind), &rejected, pinned)
            .ok_or(ConditionFailure::AllSetAside { bundle: kind })
    }

    /// Computes a physics model's mismatch against the identified representative, and J.
    pub(super) fn mismatch(
        &self,
        physics: &ComparedModel,
        identified: &ComparedModel,
    ) -> ModelMismatch {
        let mismatch = physics.mismatches(identified);
        let cost = mismatch.map(|_, entry| {
            entry
                .as_ref()
                .map(|entry| entry.cost(self.grid.grid.omega(), GainDelay::NONE, self.average))
        });
        ModelMismatch { mismatch, cost }
    }
}
