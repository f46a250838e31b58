//! Reasons for a missing parameter fit.

use gdcm_model::dataset::ConditionId;
use gdcm_model::progress::Cancelled;

/// Reasons why parameters cannot be fitted (M18.2).
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum PhysicsError {
    /// No parameter is switched on.
    #[error("no fit of physics parameters: no parameter is switched on")]
    NoParameters,
    /// No response in any condition has a weight, usually because none is available in both
    /// representatives.
    #[error(
        "no fit of physics parameters: none of the conditions ({conditions}) has a response that is \
        available in both its physics and its identified representative"
    )]
    NothingToFit { conditions: usize },
    /// A condition's table does not have the expected shape.
    #[error(
        "condition {condition}: expected {} x {} responses at {} frequencies in every table, found {} x {} at {}",
        expected[0],
        expected[1],
        expected[2],
        found[0],
        found[1],
        found[2]
    )]
    Shape {
        condition: ConditionId,
        /// Outputs, inputs and frequencies expected.
        expected: [usize; 3],
        /// Outputs, inputs and frequencies found.
        found: [usize; 3],
    },
    /// A family and the problem differ in their parameter count.
    #[error("condition {condition}: expected runs of {expected} parameters, found {found}")]
    ParameterCount {
        condition: ConditionId,
        expected: usize,
        found: usize,
    },
    /// A value set by hand is not finite.
    #[error("parameter {parameter}: expected a finite value, found {value}")]
    HeldValue {
        /// Parameter number, counted from 1.
        parameter: usize,
        value: f64,
    },
    /// A setting is out of range.
    #[error("{setting}: expected a finite number not below zero, found {value}")]
    Option { setting: &'static str, value: f64 },
    /// The normal matrix has no Cholesky factors.
    #[error("the responses do not determine the {parameters} parameters; switch some off")]
    SingularNormalMatrix { parameters: usize },
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

impl PhysicsError {
    /// Returns the stable code used in files.
    pub fn code(&self) -> &'static str {
        match self {
            Self::NoParameters => "physics-without-parameters",
            Self::NothingToFit { .. } => "physics-without-responses",
            Self::Shape { .. } => "physics-table-shape",
            Self::ParameterCount { .. } => "physics-parameter-count",
            Self::HeldValue { .. } => "physics-held-value",
            Self::Option { .. } => "physics-option",
            Self::SingularNormalMatrix { .. } => "physics-singular",
            Self::Cancelled(_) => "stopped",
        }
    }
}
