//! Errors of the HDF5 library as faults of this program.

use hdf5_pure::{Error, FormatError};

use crate::reading_budget::VariableFault;

/// Converts an error of the library to a fault; `path` names the variable.
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
            // HDF5 2.0 uses a new chunk layout if its latest format is requested.
            let remedy = "write it with compression gzip or none, in a single file, in the format of HDF5 1.14 or earlier";
            VariableFault::unsupported(path, format!("a dataset of this kind ({error})"), remedy)
        }
        _ => damaged(path, &error.to_string()),
    }
}

/// Returns the fault for bytes that contradict the format; their position is unknown.
pub(super) fn damaged(path: &str, what: &str) -> VariableFault {
    VariableFault::damaged(path, what, 0)
}
