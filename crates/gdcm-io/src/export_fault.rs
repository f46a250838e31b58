//! Reasons why an export is impossible.

use gdcm_method::schedule::ScheduleError;
use gdcm_model::dataset::ConditionId;
use gdcm_model::message_text::quoted;

use crate::reading_budget::VariableFault;

/// Reason why an export is impossible.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ExportFault {
    /// A scheduled curve contains a value that is not finite.
    #[error(
        "the {curve} of {channel} has a number that is not finite; correct it before it is exported"
    )]
    Curve {
        channel: String,
        /// "gain" or "delay".
        curve: &'static str,
    },
    /// The requested airspeeds are not finite and increasing, or there are none.
    #[error("the airspeeds of the table must be finite, increase, and be at least one")]
    Breakpoints,
    /// The file name of a MATLAB function is not a valid function name.
    #[error(
        "MATLAB calls a function by the name of its file: a letter, then letters, digits and _, 63 at most, and neither a \
         keyword nor a name that the file uses itself; found {}",
        quoted(found)
    )]
    FunctionName { found: String },
    /// The file extension does not belong to a format for models.
    #[error("models are written to a name that ends in .mat, .json or .npz")]
    ModelsFormat,
    /// The values cannot be written.
    #[error(transparent)]
    Variables(#[from] VariableFault),
    /// There is no schedule to export.
    #[error(transparent)]
    Schedule(#[from] ScheduleError),
    /// Couplings are requested but unavailable, so that the export would differ from the request.
    #[error(
        "the study asks for couplings, and there are none: {why}; correct that, or set couplings to none"
    )]
    NoCouplings { why: String },
    /// A condition has no result of its own.
    #[error("condition {condition}: {why}")]
    NoResult { condition: ConditionId, why: String },
    #[error("the dataset has no condition {condition}")]
    NoCondition { condition: ConditionId },
    #[error(
        "condition {condition} has no physics model \"{model}\"; name the condition that has it"
    )]
    NoModel {
        condition: ConditionId,
        model: String,
    },
    /// A model is a measured response, which has no matrices.
    #[error(
        "condition {condition}, model \"{model}\": it is a measured response and has no matrices to be exported"
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
        /// [`CorrectedModelError`](gdcm_method::correction::corrected_model::CorrectedModelError).
        words: String,
    },
}

impl ExportFault {
    /// Returns whether the analysis lacks the requested content; all other faults are in the
    /// request.
    pub fn is_of_analysis(&self) -> bool {
        matches!(
            self,
            Self::Schedule(_) | Self::NoResult { .. } | Self::Curve { .. }
        )
    }
}
