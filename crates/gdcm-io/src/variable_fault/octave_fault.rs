//! Faults in GNU Octave files, text or binary.

/// Fault in a GNU Octave file.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum OctaveFault {
    /// A line with this key, such as "# rows: 3", is missing.
    #[error("expected a line \"# {key}: …\"")]
    MissingKey { key: String },
    /// This key's value is not a whole number.
    #[error("{key}: expected a whole number, found \"{found}\"")]
    KeyNotWhole { key: String, found: String },
    #[error("expected a whole number, found \"{found}\"")]
    NotWhole { found: String },
    #[error("expected a number, found \"{found}\"")]
    NotANumber { found: String },
    #[error("expected a complex number, (re,im), found \"{found}\"")]
    NotComplex { found: String },
    #[error("expected at least two dimensions, found {found}")]
    Dimensions { found: usize },
    #[error("an element is outside the matrix")]
    ElementOutsideMatrix,
    #[error("the number of elements is too large")]
    ElementCount,
    #[error("expected three numbers in a range: base, limit and increment")]
    RangeNumbers,
    #[error("a field has more or fewer values than there are records")]
    FieldLength,
    #[error("a length is negative")]
    NegativeLength,
    #[error("the number type is unknown")]
    NumberType,
    #[error("expected the name of a type, found none")]
    UnnamedType,
    #[error("the sparse matrix is inconsistent")]
    SparseMatrix,
}
