//! Outcome of moving a condition's physics models by the physics parameters (M18.5).

use gdcm_method::physics::ConditionOmission;
use gdcm_method::physics::increments::IncrementError;

/// Outcome for a condition's physics models.
#[derive(Clone, Debug, PartialEq)]
pub enum MovedModels {
    /// Models are moved, except those in `kept`.
    Moved {
        /// The models that keep their response, with the reasons.
        kept: Vec<UnmovedModel>,
        /// Parameters whose effect is curved: the curvature contributes more than half as much as
        /// the slope (M18.7). A second run at the value found would help.
        bends: Vec<BendingParameter>,
    },
    /// The condition keeps its physics models.
    NotMoved(ConditionOmission),
}

/// A physics model that keeps its response.
#[derive(Clone, Debug, PartialEq)]
pub struct UnmovedModel {
    pub model: String,
    pub why: IncrementError,
}

/// A parameter whose effect is curved at the applied value.
#[derive(Clone, Debug, PartialEq)]
pub struct BendingParameter {
    pub name: String,
    /// `|z| ||Q|| / ||L||` for the matrix A (symbols: [`applied_physics`](super::applied_physics)).
    pub curvature: f64,
}
