//! Errors from reading a value in MATLAB or Octave statements, with their position in the text.

use crate::reading_budget::VariableFault;
use crate::variable_fault::matlab_value_fault::MatlabFault;

/// Maximum nesting depth of brackets and values, which are read recursively.
pub(super) const MOST_NESTED: usize = 64;

/// Line and column in the text, both counted from 1.
#[derive(Clone, Copy)]
pub(super) struct Position {
    pub(super) line: usize,
    pub(super) column: usize,
}

/// Reason why a value cannot be read.
pub(super) enum ValueError {
    /// The value at position `at` is not supported; reading continues with other values.
    NotUnderstood { fault: MatlabFault, at: Position },
    /// An error that ends the reading.
    Fault(VariableFault),
}

impl From<VariableFault> for ValueError {
    fn from(fault: VariableFault) -> Self {
        Self::Fault(fault)
    }
}

/// Returns the error that a value at a position is not supported.
pub(super) fn refused<T>(fault: MatlabFault, at: Position) -> Result<T, ValueError> {
    Err(ValueError::NotUnderstood { fault, at })
}
