//! Directories that files are written into.

use std::fs;
use std::io::ErrorKind;
use std::path::Path;

use super::file_error::FileError;

/// Makes a directory and those above it, where they are not there yet.
pub fn make_directory(path: &Path) -> Result<(), FileError> {
    fs::create_dir_all(path).map_err(|error| match error.kind() {
        ErrorKind::AlreadyExists | ErrorKind::NotADirectory => {
            FileError::writing(path, "a file stands where this directory would have to be made")
        }
        _ => FileError::writing(path, error),
    })
}
