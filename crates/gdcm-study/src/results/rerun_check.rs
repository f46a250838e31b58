//! Comparison of a rerun with the prediction of the runs (M18.6).

use gdcm_method::physics::ConditionOmission;
use gdcm_method::physics::increments::IncrementError;
use gdcm_model::dataset::ConditionId;
use gdcm_model::dataset::physics_parameter::ParameterChange;

use super::correction_costs::AxisCost;

/// J of the prediction against the rerun up to which the family of models is good.
pub const GOOD_PREDICTION: f64 = 1.0;
/// J of the prediction against the rerun above which the effect of the parameters is not linear
/// enough.
pub const POOR_PREDICTION: f64 = 5.0;
/// Share of the J by which the rerun differs from its base above which the effect of the parameters
/// is not linear enough.
pub const POOR_SHARE: f64 = 0.1;

/// A physics model with several parameters moved, compared with the prediction for its values.
#[derive(Clone, Debug, PartialEq)]
pub struct RerunCheck {
    pub condition: ConditionId,
    /// Name of the rerun.
    pub model: String,
    pub changes: Vec<ParameterChange>,
    pub outcome: Result<RerunCost, RerunRefusal>,
}

/// J between a rerun and two models: the prediction `H(z)` for its values, and its base.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RerunCost {
    /// Mean J of the prediction against the rerun.
    pub prediction: AxisCost,
    /// Mean J of the base, with all parameters nominal, against the rerun.
    pub base: AxisCost,
}

/// What a rerun says about the prediction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RerunVerdict {
    /// The prediction agrees with the rerun.
    Good,
    /// The prediction differs, but less than the limits.
    Fair,
    /// The effect of the parameters is not linear enough: a second run at the value found is
    /// needed, or the rerun as new nominal model with runs of its own.
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
    /// Decides from the larger of the on-axis and the off-axis mean.
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
    /// No physics model of the condition has the rerun's perturbation.
    NoBase,
    /// The dataset has no run of a parameter of the rerun.
    UnknownParameter { name: String },
    /// A change is in another unit than the runs.
    Unit {
        name: String,
        expected: String,
        found: String,
    },
    /// The runs of the condition do not suffice.
    Runs(ConditionOmission),
    /// The changes of the runs do not apply to the base.
    Increments(IncrementError),
    /// No response of the prediction can be compared with the rerun.
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
