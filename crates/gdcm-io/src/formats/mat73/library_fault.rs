//! Conversion of HDF5 library errors to errors of this program.

use hdf5_pure::{Error, FormatError};

use crate::reading_budget::VariableFault;

/// Converts an error of the library; `path` is the variable name in the error.
///
/// The library does not report the position in the file.
pub(super) fn library_fault(error: &Error, path: &str) -> VariableFault {
    match error {
        Error::Format(FormatError::NestingDepthExceeded) => VariableFault::too_deep(path),
        Error::Format(FormatError::UnexpectedEof { .. }) => {
            damaged(path, "a part begins or ends beyond the end of the file")
        }
        Error::Format(
            FormatError::UnsupportedFilter(_)
            | FormatError::UnsupportedVirtualLayout
            | FormatError::UnsupportedExternalStorage
            | FormatError::UnsupportedMessage(_)
            | FormatError::UnsupportedFilteredHeapObject
            | FormatError::UnsupportedVersion(_)
            | FormatError::InvalidLayoutVersion(_)
            | FormatError::UnsupportedZfp(_),
        ) => {
            // A program that requests the latest format of HDF5 2.0 writes a new chunk layout.
            let remedy = "write it with gzip compression or none, in a single file, in the format \
                of HDF5 1.14 or earlier";
            VariableFault::unsupported(path, format!("a dataset of this kind ({error})"), remedy)
        }
        _ => damaged(path, &error.to_string()),
    }
}

/// Returns the error for bytes that contradict the format, without their position.
pub(super) fn damaged(path: &str, what: &str) -> VariableFault {
    VariableFault::damaged(path, what, 0)
}
