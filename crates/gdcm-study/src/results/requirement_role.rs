//! Roles of a condition's models in the requirements, and each role's model for simulation.
//!
//! `H~` is the physics model with the study's couplings (M16), `M_O` and `M_I` are the gains,
//! delays and leads of its output and input channels. Simulation needs matrices, so that delays
//! become states, by Padé approximants.

use serde::Serialize;

use gdcm_method::correction::Pade;
use gdcm_method::correction::corrected_model::CorrectedModelError;
use gdcm_method::couplings::CoupledModelError;
use gdcm_method::couplings::coupled_model::without_delays;
use gdcm_method::schedule::ScheduleError;
use gdcm_model::dataset::{BundleKind, Model, StateSpace};

use super::analysis::{Analysis, ConditionAnalysis};
use super::assessment_table::AssessedCorrection;

/// Model version that is checked against the requirements in a condition.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum RequirementRole {
    /// The uncorrected physics representative.
    #[default]
    Physics,
    /// The physics representative under the condition's own correction.
    Corrected,
    /// The physics representative under the schedule at the condition's airspeed.
    Scheduled,
    Identified,
}

impl RequirementRole {
    /// Every role, in the order used in tables.
    pub const ALL: [Self; 4] = [
        Self::Physics,
        Self::Corrected,
        Self::Scheduled,
        Self::Identified,
    ];

    /// Returns the bundle that contains the role's representative.
    pub fn bundle(self) -> BundleKind {
        if self == Self::Identified {
            BundleKind::Identified
        } else {
            BundleKind::Physics
        }
    }

    /// Returns the role's name in files, tables and captions, such as "physics".
    pub fn name(self) -> &'static str {
        match self {
            Self::Physics => "physics",
            Self::Corrected => "corrected",
            Self::Scheduled => "scheduled",
            Self::Identified => "identified",
        }
    }
}

/// Why a role's model cannot be simulated.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum RoleModelError {
    /// The model is a measured response, without matrices.
    #[error("\"{model}\" is a measured response: without matrices it cannot be simulated")]
    Measured { model: String },
    /// The model is discrete-time; only continuous-time models are simulated.
    #[error("\"{model}\" is a discrete-time model: only continuous-time models can be simulated")]
    Discrete { model: String },
    #[error(transparent)]
    NoSchedule(#[from] ScheduleError),
    #[error(transparent)]
    Delays(#[from] CorrectedModelError),
    /// Couplings or a correction cannot be applied to the model.
    #[error(transparent)]
    Coupled(#[from] CoupledModelError),
}

impl RoleModelError {
    /// Returns the stable code by which scripts and tests distinguish the errors.
    pub fn code(&self) -> &'static str {
        match self {
            Self::Measured { .. } => "measured-response",
            Self::Discrete { .. } => "discrete-model",
            Self::NoSchedule(error) => error.code(),
            Self::Delays(error) => error.code(),
            Self::Coupled(error) => error.code(),
        }
    }
}

impl Analysis {
    /// Returns a role's model in continuous time, with delays as states: the physics
    /// representative, uncorrected or with the study's couplings and a correction (`M_O H~ M_I`);
    /// or the identified representative.
    ///
    /// # Errors
    /// [`RoleModelError`] where the model has no matrices or is discrete-time, there is no
    /// schedule, or delays, couplings or the correction cannot be applied to its matrices.
    pub fn role_model(
        &self,
        result: &ConditionAnalysis,
        role: RequirementRole,
    ) -> Result<StateSpace, RoleModelError> {
        let correction = match role {
            RequirementRole::Physics | RequirementRole::Identified => None,
            RequirementRole::Corrected => Some(AssessedCorrection::Own.correction(self, result)?),
            RequirementRole::Scheduled => {
                Some(AssessedCorrection::Scheduled.correction(self, result)?)
            }
        };
        let model = continuous(result.representative_model(role.bundle()))?;
        let pade = Pade::default();
        match correction {
            None => Ok(without_delays(model, pade)?),
            Some(correction) => Ok(result.corrected_model(model, &correction, pade)?.model),
        }
    }
}

/// Returns a continuous-time model's matrices; an error for any other model.
fn continuous(model: &Model) -> Result<&StateSpace, RoleModelError> {
    let name = || model.name.clone();
    let matrices = model
        .state_space()
        .ok_or_else(|| RoleModelError::Measured { model: name() })?;
    match matrices.timing().sample_time_s {
        None => Ok(matrices),
        Some(_) => Err(RoleModelError::Discrete { model: name() }),
    }
}
