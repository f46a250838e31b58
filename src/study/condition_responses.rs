//! Responses of every model of a condition.

use std::sync::OnceLock;

use crate::dataset::{BundleKind, Condition};
use crate::response::{FrequencyGrid, FrequencyResponse, PreparedModel};

use super::effort::Effort;
use super::watch::Stopped;

/// Responses of every model of a condition on one grid.
#[derive(Clone, Debug, PartialEq)]
pub struct ConditionResponses {
    /// Responses of the physics models, in file order.
    pub physics: Vec<FrequencyResponse>,
    /// Responses of the identified models, in file order.
    pub identified: Vec<FrequencyResponse>,
}

impl ConditionResponses {
    /// The responses of one bundle.
    pub fn bundle(&self, kind: BundleKind) -> &[FrequencyResponse] {
        match kind {
            BundleKind::Physics => &self.physics,
            BundleKind::Identified => &self.identified,
        }
    }
}

/// The models of a condition, each prepared the first time that it is asked for a response.
#[derive(Debug)]
pub struct PreparedCondition {
    physics: Vec<OnceLock<PreparedModel>>,
    identified: Vec<OnceLock<PreparedModel>>,
}

impl PreparedCondition {
    /// Room for the models of `condition`.
    pub fn of(condition: &Condition) -> Self {
        let room = |kind| condition.bundle(kind).iter().map(|_| OnceLock::new()).collect();
        Self { physics: room(BundleKind::Physics), identified: room(BundleKind::Identified) }
    }

    /// Responses of every model of the same condition, model by model; each is a step.
    pub fn responses(
        &self,
        condition: &Condition,
        grid: &FrequencyGrid,
        effort: &Effort<'_>,
    ) -> Result<ConditionResponses, Stopped> {
        let bundle = |kind, prepared: &[OnceLock<PreparedModel>]| {
            let models = condition.bundle(kind);
            let prepare = |index: usize| prepared[index].get_or_init(|| PreparedModel::of(&models[index].dynamics));
            effort.each(models.len(), 1, |index| prepare(index).response(grid))
        };
        let identified = bundle(BundleKind::Identified, &self.identified)?;
        Ok(ConditionResponses { physics: bundle(BundleKind::Physics, &self.physics)?, identified })
    }
}
