//! Possible faults of a dataset draft (a dataset before its checks), each with its location.

use super::band::BandError;
use super::condition::ConditionError;
use super::dataset::DatasetError;
use super::location::Location;
use super::measured_response::MeasuredResponseError;
use super::physics_parameter::ParameterError;
use super::state_space::StateSpaceError;
use crate::number_format::counted;

/// A fault in a dataset draft.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum DraftFault {
    #[error("expected at most {most} entries, found {found}")]
    TooMany { most: usize, found: usize },
    /// A table or matrix whose shape contradicts the channel count or state count.
    #[error("expected {expected}, found {found}")]
    Shape { expected: String, found: String },
    #[error("the dataset has no {kind} \"{name}\"; a pair is written [output, input]")]
    UnknownChannel {
        /// "output" or "input".
        kind: &'static str,
        name: String,
    },
    #[error("duplicate pair [\"{output}\", \"{input}\"]; remove one")]
    DuplicatePair { output: String, input: String },
    #[error("matrix {0} is missing; a model needs A, B, C and D")]
    MissingMatrix(char),
    #[error("both matrices and a measured response are given; keep one of them")]
    BothDynamics,
    #[error("neither matrices A, B, C, D nor a measured response is given; add one of them")]
    NoDynamics,
    #[error(
        "a measured response already includes all delays: remove sample_time_s, input_delays_s and output_delays_s, which belong to matrices \
         A, B, C, D"
    )]
    TimedResponse,
    #[error(
        "a physics model needs matrices A, B, C, D; only an identified model can be a measured \
        response"
    )]
    MeasuredPhysics,
    #[error(transparent)]
    Band(#[from] BandError),
    #[error(transparent)]
    StateSpace(#[from] StateSpaceError),
    #[error(transparent)]
    MeasuredResponse(#[from] MeasuredResponseError),
    #[error(transparent)]
    Parameter(#[from] ParameterError),
    #[error(transparent)]
    Condition(#[from] ConditionError),
    #[error(transparent)]
    Dataset(#[from] DatasetError),
}

impl DraftFault {
    /// Returns the stable code by which scripts and tests distinguish the faults.
    pub fn code(&self) -> &'static str {
        match self {
            Self::TooMany { .. } => "too-many-entries",
            Self::Shape { .. } => "table-shape",
            Self::UnknownChannel { .. } => "unknown-channel",
            Self::DuplicatePair { .. } => "duplicate-pair",
            Self::MissingMatrix(..) => "missing-matrix",
            Self::BothDynamics => "matrices-and-response",
            Self::NoDynamics => "neither-matrices-nor-response",
            Self::TimedResponse => "timed-response",
            Self::MeasuredPhysics => "measured-physics",
            Self::Parameter(error) => error.code(),
            Self::Band(error) => error.code(),
            Self::StateSpace(error) => error.code(),
            Self::MeasuredResponse(error) => error.code(),
            Self::Condition(error) => error.code(),
            Self::Dataset(error) => error.code(),
        }
    }
}

/// A fault in a dataset draft, with its location; boxed to keep `Result` small.
#[derive(Clone, Debug, PartialEq)]
pub struct DraftError {
    pub place: Box<Location>,
    pub fault: Box<DraftFault>,
}

impl DraftError {
    pub(super) fn new(place: Location, fault: impl Into<DraftFault>) -> Self {
        Self {
            place: Box::new(place),
            fault: Box::new(fault.into()),
        }
    }
}

/// An unusual but harmless property in a dataset draft, with its location.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Warning {
    pub place: Location,
    pub oddity: DraftOddity,
}

/// An unusual but harmless property of a model.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum DraftOddity {
    /// The order stated by the identification differs from the state count.
    #[error("the stated order is {stated}, but the matrices have {}; the matrices are used", counted(*states, "state"))]
    Order { stated: usize, states: usize },
    /// The number of state names differs from the state count.
    #[error(
        "{} for {}; the names are ignored",
        counted(*names, "state name"),
        counted(*states, "state")
    )]
    StateNames { names: usize, states: usize },
}

impl DraftOddity {
    /// Returns the stable code by which scripts and tests distinguish the oddities.
    pub fn code(self) -> &'static str {
        match self {
            Self::Order { .. } => "stated-order",
            Self::StateNames { .. } => "state-name-count",
        }
    }
}
