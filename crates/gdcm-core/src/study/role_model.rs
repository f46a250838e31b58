//! The models of a condition that are compared, as matrices that a record can be simulated with (M17.2).

use crate::correction::{CorrectedModelError, Pade};
use crate::couplings::{CoupledModelError, without_delays};
use crate::dataset::{BundleKind, Model, StateSpace};
use crate::message_text::quoted;
use crate::schedule::ScheduleError;

use super::{Analysis, AssessedCorrection, ConditionAnalysis, RequirementRole};

/// Why the model of a role cannot be simulated.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum RoleModelError {
    /// It is a response that was measured.
    #[error("{} is a measured response: without matrices it answers to no record", quoted(model))]
    Measured {
        /// Its name.
        model: String,
    },
    /// It acts in discrete time.
    #[error("{} acts in discrete time: records are simulated in continuous time", quoted(model))]
    Discrete {
        /// Its name.
        model: String,
    },
    /// There is no schedule.
    #[error(transparent)]
    NoSchedule(#[from] ScheduleError),
    /// Delays or leads cannot become states.
    #[error(transparent)]
    Delays(#[from] CorrectedModelError),
    /// Couplings or a correction cannot be put on it.
    #[error(transparent)]
    Coupled(#[from] CoupledModelError),
}

impl Analysis {
    /// The model of a role of a condition in continuous time, its delays as states: the physics representative as it is, with the
    /// couplings of the study and a correction (`M_O H~ M_I`), or the identified representative.
    ///
    /// # Errors
    /// [`RoleModelError`] where the model has no matrices or acts in discrete time, there is no schedule, or matrices cannot be
    /// computed with.
    pub fn role_model(&self, of: &ConditionAnalysis, role: RequirementRole) -> Result<StateSpace, RoleModelError> {
        let representative = |kind: BundleKind| {
            let place = match kind {
                BundleKind::Physics => of.comparison.physics.model,
                BundleKind::Identified => of.comparison.identified.model,
            };
            continuous(&of.condition.bundle(kind)[place])
        };
        let corrected = |by: AssessedCorrection| -> Result<StateSpace, RoleModelError> {
            let correction = by.of(self, of)?;
            Ok(of.corrected_model(representative(BundleKind::Physics)?, &correction, Pade::default())?.model)
        };
        match role {
            RequirementRole::Physics => Ok(without_delays(representative(BundleKind::Physics)?, Pade::default())?),
            RequirementRole::Identified => {
                Ok(without_delays(representative(BundleKind::Identified)?, Pade::default())?)
            }
            RequirementRole::Corrected => corrected(AssessedCorrection::Own),
            RequirementRole::Scheduled => corrected(AssessedCorrection::Scheduled),
        }
    }
}

/// The matrices of a model of continuous time.
fn continuous(model: &Model) -> Result<&StateSpace, RoleModelError> {
    let name = || model.name.clone();
    let matrices = model.state_space().ok_or_else(|| RoleModelError::Measured { model: name() })?;
    match matrices.timing().sample_time_s {
        None => Ok(matrices),
        Some(_) => Err(RoleModelError::Discrete { model: name() }),
    }
}
