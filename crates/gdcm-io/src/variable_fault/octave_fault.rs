//! Faults in GNU Octave files, text or binary.

/// Fault in a GNU Octave file.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum OctaveFault {
    /// A line with this key, such as "# rows: 3", is missing.
    #[error("expected \"# {key}: …\"")]
    MissingKey { key: String },
    /// This key's value is not a whole number.
    #[error("{key}: expected a whole number")]
    KeyNotWhole { key: String },
    #[error("expected a whole number")]
    NotWhole,
    #[error("expected a number")]
    NotANumber,
    #[error("expected a complex number, (re,im)")]
    NotComplex,
    #[error("expected at least two dimensions")]
    Dimensions,
    #[error("an element is outside the matrix")]
    ElementOutsideMatrix,
    #[error("the number of elements is too large")]
    ElementCount,
    #[error("a range does not have three numbers")]
    RangeNumbers,
    #[error("a field has more or fewer values than there are records")]
    FieldLength,
    #[error("a length is negative")]
    NegativeLength,
    #[error("the number type is unknown")]
    NumberType,
    #[error("the type of the value has no name")]
    UnnamedType,
    #[error("an array has fewer than two dimensions")]
    FewDimensions,
    #[error("the sparse matrix is inconsistent")]
    SparseMatrix,
}
