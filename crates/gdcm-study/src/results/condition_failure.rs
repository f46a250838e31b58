//! Reasons why a condition has no result or is left out of an assessment.
//!
//! A *bundle* contains a condition's physics models, or its identified models; in each bundle the
//! *kept* models, those not rejected, are compared, unless they are *set aside* because they lack a
//! compared response (M5b).

use gdcm_method::correction::problem::ProblemError;
use gdcm_method::schedule::ScheduleError;
use gdcm_model::dataset::BundleKind;

use super::caution::Caution;

/// Why an analysis contains no result for a condition.
#[derive(Clone, Debug, PartialEq)]
pub enum NoResult {
    NotAnalysed,
    Failed(ConditionFailure),
}

impl NoResult {
    /// Returns the stable code, for programs and tests.
    pub fn code(&self) -> &'static str {
        match self {
            Self::NotAnalysed => "not-analysed",
            Self::Failed(failure) => failure.code(),
        }
    }
}

/// Why a condition has no result.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ConditionFailure {
    #[error(
        "no identified models yet, so there is no reference to compare the physics models with; \
         identify them from the condition's flight records (gdcm identify RECORDS --into DATASET, \
         or Identify from records in the window), or add identified models"
    )]
    NoReference,
    /// The two representatives have no response in common that is defined over the whole band.
    #[error(
        "no response of \"{physics}\" can be compared with \"{identified}\" over the whole band: \
        each is zero, not finite or outside the range of computable gains at some frequency; \
        choose another representative, or another band"
    )]
    NothingToCompare {
        physics: String,
        identified: String,
        /// Cautions about the model responses, which explain the failure.
        cautions: Vec<Caution>,
    },
    /// Every kept model is set aside (M5b).
    #[error(
        "no {bundle} model is left to compare: each kept model lacks a compared response that \
        another model of the bundle has; restore a model that has them all, or narrow the band"
    )]
    AllSetAside { bundle: BundleKind },
    #[error("the gains could not be computed: {0}")]
    Gains(ProblemError),
    #[error("the delays could not be computed: {0}")]
    Delays(ProblemError),
}

impl ConditionFailure {
    /// Returns the reason's stable code, for programs and tests.
    pub fn code(&self) -> &'static str {
        match self {
            Self::NoReference => "no-reference",
            Self::NothingToCompare { .. } => "nothing-to-compare",
            Self::AllSetAside { .. } => "all-set-aside",
            Self::Gains(_) => "gains-not-computed",
            Self::Delays(_) => "delays-not-computed",
        }
    }
}

/// Why an assessment leaves a condition out.
#[derive(Clone, Debug, PartialEq)]
pub enum NotAssessed {
    NotAnalysed,
    NominalRejected,
    NoResult(ConditionFailure),
    NoSchedule(ScheduleError),
}

impl NotAssessed {
    /// Returns the stable code, for programs and tests.
    pub fn code(&self) -> &'static str {
        match self {
            Self::NotAnalysed => "not-analysed",
            Self::NominalRejected => "nominal-rejected",
            Self::NoResult(failure) => failure.code(),
            Self::NoSchedule(_) => "no-schedule",
        }
    }
}
