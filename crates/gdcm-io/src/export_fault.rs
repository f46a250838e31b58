//! Reasons why an export is impossible.

use gdcm_method::schedule::ScheduleError;
use gdcm_model::dataset::ConditionId;
use gdcm_model::message_text::quoted;

use crate::reading_budget::VariableFault;

/// Reason why an export is impossible.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ExportFault {
    /// A curve contains a value that is not finite.
    #[error(
        "the {curve} of {channel} has a number that is not finite; correct it before it is exported"
    )]
    Curve {
        channel: String,
        /// "gain" or "delay".
        curve: &'static str,
    },
    /// The requested airspeeds do not form a table.
    #[error("the airspeeds of the table must be finite, increase, and be at least one")]
    Breakpoints,
    /// The name of a MATLAB file is not a valid function name.
    #[error(
        "MATLAB calls a function by the name of its file: a letter, then letters, digits and _, 63 at most, and neither a \
         keyword nor a name that the file uses itself; found {}",
        quoted(found)
    )]
    FunctionName { found: String },
    /// The file extension belongs to no model format.
    #[error("models are written to a name that ends in .mat, .json or .npz")]
    ModelsFormat,
    /// The values cannot be written.
    #[error(transparent)]
    Variables(#[from] VariableFault),
    /// There is no schedule to export.
    #[error(transparent)]
    Schedule(#[from] ScheduleError),
    /// The study requests couplings and has none, so that the export would differ from the request.
    #[error(
        "the study asks for couplings, and there are none: {why}; correct that, or set couplings to none"
    )]
    NoCouplings { why: String },
    /// A condition has no result of its own.
    #[error("condition {condition}: {why}")]
    NoResult { condition: ConditionId, why: String },
    /// The dataset has no such condition.
    #[error("the dataset has no condition {condition}")]
    NoCondition { condition: ConditionId },
    /// A condition has no physics model with this name.
    #[error(
        "condition {condition} has no physics model \"{model}\"; name the condition that has it"
    )]
    NoModel {
        condition: ConditionId,
        model: String,
    },
    /// A model is a measured response and has no matrices.
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
        /// Reason, see
        /// [`CorrectedModelError`](gdcm_method::correction::corrected_model::CorrectedModelError).
        words: String,
    },
}

impl ExportFault {
    /// Whether the analysis did not produce the requested content; any other fault is in the
    /// request.
    pub fn is_of_analysis(&self) -> bool {
        matches!(
            self,
            Self::Schedule(_) | Self::NoResult { .. } | Self::Curve { .. }
        )
    }
}
