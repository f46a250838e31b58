//! What the physics parameters did to the physics models of a condition (M18.5).

use gdcm_method::physics::ConditionOmission;
use gdcm_method::physics::increments::IncrementError;

/// What happened to the physics models of a condition.
#[derive(Clone, Debug, PartialEq)]
pub enum MovedModels {
    /// Models are moved, except those listed.
    Moved {
        /// The models that keep their response, with the reasons.
        kept: Vec<UnmovedModel>,
        /// The parameters whose effect bends: the curvature has more than half of the share of the
        /// slope (M18.7). A second run at the value found would help.
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

/// A parameter whose effect bends at the value applied.
#[derive(Clone, Debug, PartialEq)]
pub struct BendingParameter {
    pub name: String,
    /// `|z| ||Q|| / ||L||` of A.
    pub curvature: f64,
}
