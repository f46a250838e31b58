//! Whether a file is still what it was.

use std::fs;
use std::path::Path;
use std::time::SystemTime;

use super::file_error::FileError;
use super::source::Source;

/// What changes when a file is written: cheap to look at, also on a network drive.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FileStamp {
    modified: Option<SystemTime>,
    length: u64,
}

impl FileStamp {
    /// The stamp of a file; none while there is no such file.
    pub fn of(path: &Path) -> Option<Self> {
        let metadata = fs::metadata(path).ok().filter(fs::Metadata::is_file)?;
        Some(Self { modified: metadata.modified().ok(), length: metadata.len() })
    }
}

/// SHA-256 of a file's bytes as they are stored, in lower-case hexadecimal.
///
/// # Errors
/// Where the file cannot be read.
pub fn file_sha256(path: &Path) -> Result<String, FileError> {
    Ok(Source::read(path)?.sha256)
}

/// Whether there is such a file.
pub fn file_exists(path: &Path) -> bool {
    path.is_file()
}
