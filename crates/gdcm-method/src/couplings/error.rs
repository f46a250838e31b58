//! Reasons for a missing coupling fit: an input mixing `M` and an output feedback `K` that bring
//! the physics models closer to flight in all conditions.

use gdcm_model::dataset::ConditionId;
use gdcm_model::progress::Cancelled;
use gdcm_model::units::{number, telling};

/// Reasons why no couplings can be fitted (M16.2).
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum CouplingError {
    /// No condition has a response that both representatives contain, or there is no condition.
    #[error(
        "no coupling fit: none of the conditions ({conditions}) has a response that is available in \
        both its physics and its identified representative"
    )]
    NothingToFit { conditions: usize },
    /// Fewer conditions than error bars need.
    #[error("error bars of the couplings need at least {needed} conditions, found {found}")]
    TooFewConditions { needed: usize, found: usize },
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
    /// The loop cannot be closed: `I - K H` is singular.
    #[error(
        "the feedback makes the loop of condition {condition} singular at {} rad/s; choose mixing \
        without feedback",
        number(*omega_rad_s)
    )]
    SingularLoop {
        condition: ConditionId,
        omega_rad_s: f64,
    },
    /// The normal matrix has no Cholesky factors.
    #[error(
        "the responses do not determine the {unknowns} entries of the couplings (mixing, and feedback if chosen); use more conditions"
    )]
    SingularNormalMatrix { unknowns: usize },
    /// The mixing removes an input or reverses its sign.
    #[error(
        "the mixing multiplies input {input} by {} at {} kt; a factor of \
            zero or below removes or reverses an input: check its sign in both models, or switch \
            the couplings off",
        telling(*factor, 3),
        number(*airspeed_kt)
    )]
    ReversedInput {
        /// Input number, counted from 1.
        input: usize,
        airspeed_kt: f64,
        /// `M_ii` at `airspeed_kt`.
        factor: f64,
    },
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

impl CouplingError {
    /// Returns the stable code by which scripts and tests distinguish the errors.
    pub fn code(&self) -> &'static str {
        match self {
            Self::NothingToFit { .. } => "nothing-to-fit",
            Self::TooFewConditions { .. } => "too-few-conditions",
            Self::Shape { .. } => "coupling-shape",
            Self::SingularLoop { .. } => "singular-loop",
            Self::SingularNormalMatrix { .. } => "singular-normal-matrix",
            Self::ReversedInput { .. } => "reversed-input",
            Self::Cancelled(..) => "stopped",
        }
    }
}
