//! Reasons why an export is impossible.

use std::io;

use gdcm_method::schedule::ScheduleError;
use gdcm_model::dataset::ConditionId;
use gdcm_model::message_text::quoted;

use crate::reading_budget::VariableFault;

/// Reason why an export is impossible.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ExportFault {
    /// A scheduled curve contains a value that is not finite.
    #[error(
        "the scheduled {curve} of {channel} has values that are not finite; change the degree or \
        the conditions of the schedule"
    )]
    Curve {
        channel: String,
        /// "gain", "delay" or "lead numerator".
        curve: &'static str,
    },
    /// The requested airspeeds are not finite and increasing, or there are none.
    #[error(
        "airspeeds of the lookup table: expected at least one, all finite and in increasing order \
        (in kt)"
    )]
    Breakpoints,
    /// The file name for a MATLAB function is not a valid function name.
    #[error(
        "file name of a MATLAB function: expected a letter, then letters, digits and _ (at most 63 \
        characters), neither a keyword nor a name used inside the file; found {}",
        quoted(found)
    )]
    FunctionName { found: String },
    /// The file extension does not suit the requested format for models.
    #[error("the file name of exported models must end in {expected}")]
    ModelsFormat {
        /// The suitable extensions, as a list.
        expected: &'static str,
    },
    /// Variables for MATLAB or NumPy cannot be written.
    #[error(transparent)]
    Variables(#[from] VariableFault),
    /// The schedule that the export requires does not exist.
    #[error(transparent)]
    Schedule(#[from] ScheduleError),
    /// Couplings are requested but unavailable, so that the export would differ from the request.
    #[error(
        "the study requests couplings, but they are unavailable: {why}; correct this, or set \
        couplings to none"
    )]
    NoCouplings { why: String },
    /// The study requests physics parameters, but they are unavailable.
    #[error(
        "the study requests physics parameters, but they are unavailable: {why}; correct this, or \
        set the physics parameters to off"
    )]
    NoPhysics { why: String },
    /// A condition lacks its own result.
    #[error("condition {condition} has no result: {why}")]
    NoResult { condition: ConditionId, why: String },
    #[error("the dataset has no condition {condition}")]
    NoCondition { condition: ConditionId },
    #[error("condition {condition} has no physics model \"{model}\"; name a condition that has it")]
    NoModel {
        condition: ConditionId,
        model: String,
    },
    /// A model is a measured response, which has no matrices.
    #[error(
        "condition {condition}, model \"{model}\": a measured response has no matrices to export; \
        choose another model"
    )]
    NoMatrices {
        condition: ConditionId,
        model: String,
    },
    /// A corrected model cannot be written as matrices.
    #[error("condition {condition}, model \"{model}\": {words}")]
    Model {
        condition: ConditionId,
        model: String,
        /// Reason, from
        /// [`CoupledModelError`](gdcm_method::couplings::CoupledModelError).
        words: String,
    },
    #[error("the contents of the file cannot be written: {reason}")]
    Contents { reason: String },
}

impl ExportFault {
    /// Wraps the error for contents that cannot be written.
    pub(crate) fn contents(error: &io::Error) -> Self {
        Self::Contents {
            reason: error.to_string(),
        }
    }

    /// Returns the stable code by which scripts and tests distinguish the reasons.
    pub fn code(&self) -> &'static str {
        match self {
            Self::Curve { .. } => "curve-not-finite",
            Self::Breakpoints => "breakpoints",
            Self::FunctionName { .. } => "function-name",
            Self::ModelsFormat { .. } => "models-format",
            Self::Variables(fault) => fault.code(),
            Self::Schedule(error) => error.code(),
            Self::NoCouplings { .. } => "no-couplings",
            Self::NoPhysics { .. } => "no-physics",
            Self::NoResult { .. } => "no-result",
            Self::NoCondition { .. } => "unknown-condition",
            Self::NoModel { .. } => "unknown-model",
            Self::NoMatrices { .. } => "no-matrices",
            Self::Model { .. } => "corrected-model",
            Self::Contents { .. } => "export-contents",
        }
    }

    /// Returns whether the analysis gives no result to export (no schedule, no result for a
    /// condition, a curve that is not finite), for the exit status; all other faults count as wrong
    /// input.
    pub fn is_of_analysis(&self) -> bool {
        matches!(
            self,
            Self::Schedule(_) | Self::NoResult { .. } | Self::Curve { .. }
        )
    }
}
