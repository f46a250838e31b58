//! Why an expression has no value.

use super::token::Place;
use crate::variables::VariableFault;

/// Why an expression has no value.
#[derive(Debug)]
pub(super) enum Trouble {
    /// The expression is not understood; others can be.
    Words {
        /// What is wrong and what to write instead.
        what: String,
        /// Where, as soon as that is known.
        place: Option<Place>,
    },
    /// Reading ends.
    Fault(VariableFault),
}

impl Trouble {
    /// A trouble whose place is not known yet.
    pub(super) fn new(what: impl Into<String>) -> Self {
        Self::Words { what: what.into(), place: None }
    }

    /// Gives the place where none is known.
    pub(super) fn at(self, known: Place) -> Self {
        match self {
            Self::Words { what, place } => Self::Words { what, place: place.or(Some(known)) },
            fault => fault,
        }
    }
}

impl From<VariableFault> for Trouble {
    fn from(fault: VariableFault) -> Self {
        Self::Fault(fault)
    }
}
