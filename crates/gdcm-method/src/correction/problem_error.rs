//! Reasons why gains or delays cannot be computed: an invalid problem, or a search that failed or
//! was stopped. A *delta* is the gain or delay that a response needs; a response whose channels
//! must give it exactly its delta is constrained, or *held*.

use gdcm_model::dataset::Pair;

use super::branch_and_bound::effort::SearchStopped;
use super::channel_bounds::Bounds;
use super::quantity::Quantity;

/// Reason why gains or delays cannot be computed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ProblemError {
    /// A table differs in shape from the delta table.
    #[error(
        "the table of {table} entries has {} outputs and {} inputs, but the {quantity}s have {} \
        and {}",
        found.0,
        found.1,
        expected.0,
        expected.1
    )]
    Shape {
        quantity: Quantity,
        table: &'static str,
        /// Outputs and inputs in the table.
        found: (usize, usize),
        /// Outputs and inputs in the delta table.
        expected: (usize, usize),
    },
    /// A constrained entry has no delta.
    #[error(
        "the response of output {} to input {} has no delta {quantity}, so its {quantity} cannot \
        be held",
        pair.output + 1,
        pair.input + 1
    )]
    ConstrainedUndefined { quantity: Quantity, pair: Pair },
    /// A delta gain is not a number from 1e-50 to 1e50.
    #[error(
        "the delta gain of output {} and input {} is {gain}; it must be from 1e-50 to 1e50",
        pair.output + 1,
        pair.input + 1
    )]
    Gain {
        pair: Pair,
        /// Delta gain; a ratio, not in dB.
        gain: f64,
    },
    /// A delta delay is not finite, or too large.
    #[error(
        "the delta delay of output {} and input {} is {delay_s} s; it must be a number below \
        1e50 s",
        pair.output + 1,
        pair.input + 1
    )]
    Delay { pair: Pair, delay_s: f64 },
    /// The bounds are invalid for the quantity, see [`Bounds`].
    #[error("{}", bounds_error(*quantity, *bounds))]
    Bounds { quantity: Quantity, bounds: Bounds },
    /// `alpha` is negative, too large or not a number.
    #[error("alpha is {alpha}; it must be a number from 0 to 1e12")]
    Alpha { alpha: f64 },
    #[error("the quadratic program for the delays was not solved: {reason}")]
    Program {
        /// Status reported by the solver.
        reason: String,
    },
    /// The search was stopped by its caller.
    #[error("the search for the optimum was stopped")]
    Stopped,
}

impl ProblemError {
    /// Returns the stable code by which scripts and tests distinguish the errors.
    pub fn code(&self) -> &'static str {
        match self {
            Self::Shape { .. } => "problem-shape",
            Self::ConstrainedUndefined { .. } => "constrained-undefined",
            Self::Gain { .. } => "held-gain",
            Self::Delay { .. } => "held-delay",
            Self::Bounds { .. } => "bounds",
            Self::Alpha { .. } => "alpha",
            Self::Program { .. } => "program",
            Self::Stopped => "stopped",
        }
    }
}

fn bounds_error(quantity: Quantity, bounds: Bounds) -> String {
    let Bounds { lower, upper } = bounds;
    match quantity {
        Quantity::Gain(_) => format!(
            "the gain bounds {lower} and {upper} must be from 1e-9 to 1e9, and the lower bound not \
            above the upper bound"
        ),
        Quantity::Delay => format!(
            "the delay bounds are {lower} s and {upper} s; the lower bound must be 0, the upper \
            bound from 0 to 1e50 s"
        ),
        Quantity::SignedDelay => format!(
            "the signed delay bounds are {lower} s and {upper} s; the lower bound must be from \
            -1e50 to 0 s, the upper bound from 0 to 1e50 s"
        ),
    }
}

impl From<SearchStopped> for ProblemError {
    fn from(_: SearchStopped) -> Self {
        ProblemError::Stopped
    }
}
