//! A condition whose requirements are computed.

use gdcm_method::correction::ChannelCorrection;
use gdcm_model::dataset::ConditionId;

use super::analysis::{Analysis, ConditionAnalysis};
use super::requirement_role::RequirementRole;

/// One condition with the models and results from which its requirements are computed.
pub(crate) struct RequestedCondition<'a> {
    pub(crate) analysis: &'a Analysis,
    pub(crate) result: &'a ConditionAnalysis,
    /// The schedule evaluated at the condition's airspeed; `None` without a schedule.
    pub(crate) scheduled: Option<ChannelCorrection>,
}

impl RequestedCondition<'_> {
    pub(crate) fn id(&self) -> ConditionId {
        self.result.condition.id()
    }

    pub(crate) fn airspeed_kt(&self) -> f64 {
        self.result.condition.flight_state().airspeed_kt
    }

    /// Names a role's model.
    pub(crate) fn model_name(&self, role: RequirementRole) -> String {
        self.result.representative_name(role.bundle()).to_owned()
    }

    /// Returns a role's correction; `None` for roles without a correction.
    pub(crate) fn correction(&self, role: RequirementRole) -> Option<&ChannelCorrection> {
        match role {
            RequirementRole::Corrected => Some(&self.result.correction),
            RequirementRole::Scheduled => self.scheduled.as_ref(),
            RequirementRole::Physics | RequirementRole::Identified => None,
        }
    }

    /// Returns the roles that have a model: the scheduled role only with a schedule.
    pub(crate) fn roles(&self) -> impl Iterator<Item = RequirementRole> + use<> {
        let has_schedule = self.scheduled.is_some();
        RequirementRole::ALL
            .into_iter()
            .filter(move |role| has_schedule || *role != RequirementRole::Scheduled)
    }
}
