//! What the HDF5 library says, in the words of this program.

use hdf5_pure::{Error, FormatError};

use crate::variables::VariableFault;

/// The fault that an error of the library is; `path` is the variable.
///
/// The library does not tell where in the file it stopped.
pub(super) fn fault(error: &Error, path: &str) -> VariableFault {
    let variable = path.to_owned();
    match error {
        Error::Format(FormatError::NestingDepthExceeded) => VariableFault::TooDeep { variable },
        Error::Format(FormatError::UnexpectedEof { .. }) => damaged(path, "something lies beyond the end of the file"),
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
            // HDF5 2.0 chunks by a layout of its own where it is asked for its latest format.
            let remedy =
                "write it with compression gzip or none, in one file, in the format of HDF5 1.14 or earlier".to_owned();
            VariableFault::Unsupported { variable, what: format!("a dataset of this kind ({error})"), remedy }
        }
        _ => damaged(path, &error.to_string()),
    }
}

/// The bytes contradict the format.
pub(super) fn damaged(path: &str, what: &str) -> VariableFault {
    VariableFault::Damaged { variable: path.to_owned(), what: what.to_owned(), offset: 0 }
}
