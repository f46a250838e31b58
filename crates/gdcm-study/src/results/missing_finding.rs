//! Reasons for missing results, as typed facts with stable codes. The sentences are in the crate
//! `gdcm-words`; the export writes them instead of the codes. A role is a version of the model:
//! physics, corrected, scheduled or identified.

use serde::{Serialize, Serializer};

use gdcm_method::couplings::CoupledModelError;
use gdcm_method::requirements::tolerance_check::{ToleranceCheckError, ToleranceError};
use gdcm_method::schedule::ScheduleError;
use gdcm_model::dataset::ConditionId;
use gdcm_model::response::mode::ModesError;
use gdcm_model::simulation::ValidationError;
use gdcm_sysid::spectra::preparation_settings::PreparationError;

use super::analysis::NoResult;
use super::requirement_role::{RequirementRole, RoleModelError};

/// A missing result, in one condition or in all.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct MissingFinding {
    /// The condition; `None` for all conditions.
    pub condition: Option<ConditionId>,
    pub what: MissingPart,
    pub why: MissingReason,
}

/// Part of the requirements that is missing; exported by its name in lower case.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum MissingPart {
    /// Every result in the condition.
    All,
    /// Values with the schedule.
    Scheduled,
    Modes,
    #[serde(rename = "time histories")]
    TimeHistories,
}

/// Why a result is missing.
#[derive(Clone, Debug, PartialEq)]
pub enum MissingReason {
    NoSchedule(ScheduleError),
    NoResult(NoResult),
    NoModes(NoModes),
    /// No flight record was given for any condition.
    NoRecord,
    NoRecordOfCondition,
    /// A tolerance row is not applicable.
    ToleranceNotApplied(ToleranceError),
    RecordNotPrepared {
        record: String,
        why: PreparationError,
    },
    NoRoleModel(NoRoleModel),
    /// A model is not compared with a record.
    NotCompared {
        role: RequirementRole,
        record: String,
        why: NotCompared,
    },
}

/// Why a condition has no modes to compare.
#[derive(Clone, Debug, PartialEq)]
pub enum NoModes {
    /// The model is a measured response.
    Measured { model: String },
    /// A model's modes, without or with couplings, cannot be computed.
    NotComputed {
        model: String,
        is_coupled: bool,
        why: ModesError,
    },
    /// The couplings cannot be applied to the physics model.
    NotCoupled {
        model: String,
        why: CoupledModelError,
    },
}

/// Why a role has no model for simulation.
#[derive(Clone, Debug, PartialEq)]
pub struct NoRoleModel {
    pub role: RequirementRole,
    pub why: RoleModelError,
}

/// Why a simulation is not compared with a record.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum NotCompared {
    NotSimulated(ValidationError),
    NotChecked(ToleranceCheckError),
    NoSamples,
}

impl MissingReason {
    /// Returns the stable code, for programs and tests.
    pub fn code(&self) -> &'static str {
        match self {
            Self::NoSchedule(_) => "no-schedule",
            Self::NoResult(why) => why.code(),
            Self::NoModes(_) => "no-modes",
            Self::NoRecord => "no-record",
            Self::NoRecordOfCondition => "no-record-of-condition",
            Self::ToleranceNotApplied(_) => "tolerance-not-applied",
            Self::RecordNotPrepared { .. } => "record-not-prepared",
            Self::NoRoleModel(_) => "no-role-model",
            Self::NotCompared { .. } => "not-compared",
        }
    }
}

/// Writes the code, which the export replaces by a sentence.
impl Serialize for MissingReason {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.code())
    }
}
