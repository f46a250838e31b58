//! Why something cannot be exported.

use gdcm_core::dataset::ConditionId;
use gdcm_core::message_text::quoted;
use gdcm_core::schedule::ScheduleError;

use crate::variables::VariableFault;

/// Why something cannot be exported.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ExportFault {
    /// A curve cannot be computed.
    #[error("the {curve} of {channel} has a number that is not finite; correct it before it is exported")]
    Curve {
        /// The channel.
        channel: String,
        /// "gain" or "delay".
        curve: &'static str,
    },
    /// The airspeeds asked for make no table.
    #[error("the airspeeds of the table must be finite, increase, and be at least one")]
    Breakpoints,
    /// A file of MATLAB has a name that no function can have.
    #[error(
        "MATLAB calls a function by the name of its file: a letter, then letters, digits and _, 63 at most, and neither a \
         keyword nor a name that the file uses itself; found {}",
        quoted(found)
    )]
    FunctionName {
        /// The name of the file without its ending.
        found: String,
    },
    /// The name of the file says none of the formats that models are written in.
    #[error("models are written to a name that ends in .mat, .json or .npz")]
    ModelsFormat,
    /// The values cannot be written.
    #[error(transparent)]
    Variables(#[from] VariableFault),
    /// There is no schedule to be exported.
    #[error(transparent)]
    Schedule(#[from] ScheduleError),
    /// The study asks for couplings and has none: what would be exported is not what was asked for.
    #[error("the study asks for couplings, and there are none: {why}; mend that, or set couplings to none")]
    NoCouplings {
        /// Why there are none.
        why: String,
    },
    /// A condition has no result of its own.
    #[error("condition {condition}: {why}")]
    NoResult {
        /// The condition.
        condition: ConditionId,
        /// Why not.
        why: String,
    },
    /// The dataset has no such condition.
    #[error("the dataset has no condition {condition}")]
    NoCondition {
        /// The id asked for.
        condition: ConditionId,
    },
    /// A condition has no physics model of this name.
    #[error("condition {condition} has no physics model \"{model}\"; name the condition that has it")]
    NoModel {
        /// The condition.
        condition: ConditionId,
        /// The name asked for.
        model: String,
    },
    /// A model is known by its response only.
    #[error("condition {condition}, model \"{model}\": it is a measured response and has no matrices to be exported")]
    NoMatrices {
        /// The condition.
        condition: ConditionId,
        /// The model.
        model: String,
    },
    /// A corrected model cannot be written as matrices.
    #[error("condition {condition}, model \"{model}\": {words}")]
    Model {
        /// The condition.
        condition: ConditionId,
        /// The model.
        model: String,
        /// Why not; see [`CorrectedModelError`](gdcm_core::correction::CorrectedModelError).
        words: String,
    },
}

impl ExportFault {
    /// Whether it is the analysis that has not what is asked for; otherwise something else would have to be asked.
    pub fn is_of_analysis(&self) -> bool {
        matches!(self, Self::Schedule(_) | Self::NoResult { .. } | Self::Curve { .. })
    }
}
