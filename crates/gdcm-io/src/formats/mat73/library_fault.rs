//! Converts HDF5 library errors to this program's errors.

use hdf5_pure::{Error, FormatError};

use crate::reading_budget::VariableFault;
use crate::variable_fault::damage::Damage;
use crate::variable_fault::unsupported_content::UnsupportedContent;

/// Converts a library error; `path` is the variable name in the error.
///
/// The library does not report the position in the file.
pub(super) fn library_fault(error: &Error, path: &str) -> VariableFault {
    match error {
        Error::Format(FormatError::NestingDepthExceeded) => VariableFault::too_deep(path),
        Error::Format(FormatError::UnexpectedEof { .. }) => damaged(path, Damage::PartBeyondEnd),
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
            let message = error.to_string();
            VariableFault::unsupported(path, UnsupportedContent::HdfDataset { message })
        }
        _ => damaged(
            path,
            Damage::Library {
                message: error.to_string(),
            },
        ),
    }
}

/// Returns the error for bytes that contradict the format, without their position.
pub(super) fn damaged(path: &str, damage: Damage) -> VariableFault {
    VariableFault::damaged(path, damage, 0)
}
