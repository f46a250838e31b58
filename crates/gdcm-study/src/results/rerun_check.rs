//! Compares a rerun with the prediction from the runs (M18.6, from which the limits are).
//!
//! A *run* is a physics model linearised again with one parameter moved, a *rerun* with several.
//! The prediction `H(z)` is the *base*, the model with all parameters nominal, changed according to
//! the runs; z are the parameters' changes. J is the mismatch cost; responses with J up to 50 are
//! next to indistinguishable (M4).

use gdcm_method::physics::ConditionOmission;
use gdcm_method::physics::increments::IncrementError;
use gdcm_model::dataset::ConditionId;
use gdcm_model::dataset::physics_parameter::ParameterChange;

use super::correction_costs::AxisCost;

/// J between prediction and rerun below which the prediction is good.
pub const GOOD_PREDICTION: f64 = 1.0;
/// J between prediction and rerun above which the parameters' effect is not linear enough.
pub const POOR_PREDICTION: f64 = 5.0;
/// Ratio of the prediction's J to the J of its base, both against the rerun, above which the
/// parameters' effect is not linear enough (unless the prediction is good).
pub const POOR_SHARE: f64 = 0.1;

/// A rerun, that is, a physics model with parameters moved together, compared with the prediction
/// for its values.
#[derive(Clone, Debug, PartialEq)]
pub struct RerunCheck {
    pub condition: ConditionId,
    pub model: String,
    pub changes: Vec<ParameterChange>,
    pub outcome: Result<RerunCost, RerunRefusal>,
}

/// J between a rerun and two models: the prediction `H(z)` for its values, and its base.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RerunCost {
    /// Mean J between prediction and rerun.
    pub prediction: AxisCost,
    /// Mean J between the base, with all parameters nominal, and the rerun.
    pub base: AxisCost,
}

/// Verdict on the prediction, from a rerun.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RerunVerdict {
    /// The prediction agrees with the rerun.
    Good,
    /// The prediction differs, but within the limits.
    Fair,
    /// The parameters' effect is not linear enough: a second run at the value found is needed, or
    /// the rerun must become the nominal model, with its own runs.
    NotLinear,
}

impl RerunVerdict {
    /// Returns the stable code, for files, programs and tests.
    pub fn code(self) -> &'static str {
        match self {
            Self::Good => "good",
            Self::Fair => "fair",
            Self::NotLinear => "not-linear",
        }
    }
}

impl RerunCost {
    /// Returns the worse of the verdicts on the on-axis and the off-axis mean. Each is good below
    /// [`GOOD_PREDICTION`]; else not linear above [`POOR_PREDICTION`], or above [`POOR_SHARE`] of
    /// the base's J; else fair.
    pub fn verdict(&self) -> RerunVerdict {
        let mut verdict = RerunVerdict::Good;
        for (prediction, base) in [
            (self.prediction.on_axis, self.base.on_axis),
            (self.prediction.others, self.base.others),
        ] {
            let Some(prediction) = prediction else {
                continue;
            };
            let is_large_share = match base {
                Some(base) => prediction > POOR_SHARE * base,
                None => false,
            };
            if prediction > POOR_PREDICTION || (prediction >= GOOD_PREDICTION && is_large_share) {
                return RerunVerdict::NotLinear;
            }
            if prediction >= GOOD_PREDICTION {
                verdict = RerunVerdict::Fair;
            }
        }
        verdict
    }
}

/// Why a rerun cannot be compared.
#[derive(Clone, Debug, PartialEq)]
pub enum RerunRefusal {
    /// No physics model in the condition has the rerun's perturbation.
    NoBase,
    /// The rerun moves a parameter for which the dataset has no run.
    UnknownParameter { name: String },
    /// A change is in another unit than the runs.
    Unit {
        name: String,
        expected: String,
        found: String,
    },
    /// The condition's runs do not suffice.
    Runs(ConditionOmission),
    /// The changes in the runs do not apply to the base.
    Increments(IncrementError),
    /// Prediction and rerun have no response that can be compared.
    NothingToCompare,
}

impl RerunRefusal {
    /// Returns the stable code, for programs and tests.
    pub fn code(&self) -> &'static str {
        match self {
            Self::NoBase => "rerun-without-base",
            Self::UnknownParameter { .. } => "rerun-unknown-parameter",
            Self::Unit { .. } => "rerun-unit-differs",
            Self::Runs(omission) => omission.code(),
            Self::Increments(error) => error.code(),
            Self::NothingToCompare => "rerun-nothing-to-compare",
        }
    }
}
