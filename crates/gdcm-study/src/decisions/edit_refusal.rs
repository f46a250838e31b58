//! Reasons for refusing a decision.

use gdcm_method::correction::Channel;
use gdcm_model::dataset::band::BandError;
use gdcm_model::dataset::{ConditionId, ModelId, Pair};
use gdcm_model::units::number;

/// Why a decision was refused; the study is unchanged.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum EditRefusal {
    #[error(
        "condition {condition}: \"{model}\" is the last model kept in its bundle; at least one \
        must remain"
    )]
    LastModel {
        condition: ConditionId,
        model: String,
    },
    #[error(
        "condition {condition}: \"{model}\" is rejected; restore it before using it as \
         representative"
    )]
    PinRejected {
        condition: ConditionId,
        model: String,
    },
    #[error(
        "condition {condition}: \"{model}\" is not rejected; only a rejected model can have a \
        reason"
    )]
    ReasonOfKept {
        condition: ConditionId,
        model: String,
    },
    #[error("{what}: expected at most {most} characters, found {found}")]
    TooLong {
        what: &'static str,
        most: usize,
        found: usize,
    },
    /// The models do not fit the condition.
    #[error("condition {condition}: {why}")]
    Models { condition: ConditionId, why: String },
    #[error("a variant needs a name")]
    VariantWithoutName,
    #[error("variant \"{name}\" already exists; choose another name")]
    VariantExists { name: String },
    #[error("there is no variant \"{name}\"")]
    NoVariant { name: String },
    #[error("{setting}: expected {expected}, found {}", number(*found))]
    OutOfRange {
        setting: &'static str,
        expected: String,
        found: f64,
    },
    #[error(
        "physics parameter \"{name}\": the dataset has no physics model linearised with it \
        changed; add one with the field \"parameter\""
    )]
    NoParameter { name: String },
    /// The band limits are invalid.
    #[error(transparent)]
    Band(#[from] BandError),
    #[error("{setting}: expected {expected}, found a value of another kind")]
    NotAValue {
        setting: &'static str,
        expected: String,
    },
    #[error("the dataset has no condition {condition}")]
    NoCondition { condition: ConditionId },
    #[error("condition {} has no {} model \"{}\"", model.condition, model.bundle, model.name)]
    NoModel { model: ModelId },
    #[error("the dataset has no {}", channel.name(&[], &[]))]
    NoChannel { channel: Channel },
    #[error(
        "the dataset has no response of output number {} to input number {}",
        pair.output + 1,
        pair.input + 1
    )]
    NoResponse { pair: Pair },
}

impl EditRefusal {
    /// Returns the stable code, for programs and tests.
    pub fn code(&self) -> &'static str {
        match self {
            Self::LastModel { .. } => "last-model",
            Self::PinRejected { .. } => "rejected-representative",
            Self::ReasonOfKept { .. } => "reason-of-kept-model",
            Self::TooLong { .. } => "text-too-long",
            Self::Models { .. } => "unsuitable-models",
            Self::VariantWithoutName => "variant-without-name",
            Self::VariantExists { .. } => "variant-exists",
            Self::NoVariant { .. } => "unknown-variant",
            Self::OutOfRange { .. } => "out-of-range",
            Self::NoParameter { .. } => "unknown-parameter",
            Self::Band(error) => error.code(),
            Self::NotAValue { .. } => "not-a-value",
            Self::NoCondition { .. } => "unknown-condition",
            Self::NoModel { .. } => "unknown-model",
            Self::NoChannel { .. } => "unknown-channel",
            Self::NoResponse { .. } => "unknown-response",
        }
    }
}

/// Returns an error if `text` has more than `most` characters.
pub(crate) fn check_length(what: &'static str, text: &str, most: usize) -> Result<(), EditRefusal> {
    let found = text.chars().count();
    if found > most {
        Err(EditRefusal::TooLong { what, most, found })
    } else {
        Ok(())
    }
}
