//! Path of a dataset in a study file: relative to the study file's directory, with `/` as the
//! separator, so that both can be moved together and opened on another system.

use std::fs;
use std::path::{Path, PathBuf};

use crate::file_error::FileError;

/// Returns the dataset's path as written in the study file `study`: relative if possible.
pub(super) fn path_text(dataset: &Path, study: &Path) -> Result<String, FileError> {
    let dataset = resolved(dataset)?;
    let resolved_study = resolved(study)?;
    // There is no relative path to another drive: use the absolute path.
    let relative = resolved_study
        .parent()
        .and_then(|directory| pathdiff::diff_paths(&dataset, directory))
        .unwrap_or(dataset);
    with_slashes(&relative, study)
}

/// Returns a path as text with `/` as the separator.
///
/// # Errors
/// [`FileError`] about the study file `study` if the path is not valid Unicode.
pub(super) fn with_slashes(path: &Path, study: &Path) -> Result<String, FileError> {
    match path.to_str() {
        Some(text) => Ok(text.replace(std::path::MAIN_SEPARATOR, "/")),
        None => Err(FileError::unwritable(
            study,
            "the dataset's path is not valid Unicode; rename the dataset or its folder",
        )),
    }
}

/// Returns a file's absolute path, with links in its directory resolved: `..` after an unresolved
/// link would lead elsewhere.
fn resolved(path: &Path) -> Result<PathBuf, FileError> {
    let failed = |error: std::io::Error| FileError::writing(path, &error);
    let absolute = std::path::absolute(path).map_err(failed)?;
    match (absolute.parent(), absolute.file_name()) {
        (Some(directory), Some(name)) => {
            Ok(fs::canonicalize(directory).map_err(failed)?.join(name))
        }
        _ => Err(FileError::unwritable(
            path,
            "the path does not end in a file name",
        )),
    }
}

/// Returns a dataset's absolute path with links in its directory resolved. If the directory is
/// inaccessible, links stay unresolved, so that the decisions can still be saved.
pub(super) fn resolved_or_absolute(dataset: &Path) -> PathBuf {
    if let Ok(resolved) = resolved(dataset) {
        return resolved;
    }
    std::path::absolute(dataset).unwrap_or(dataset.into())
}

/// Returns the dataset's path: as given in the study, or in the study file's directory if the
/// dataset exists only there.
pub(super) fn referenced_path(study: &Path, relative: &str) -> PathBuf {
    let directory = study.parent().unwrap_or(Path::new(""));
    let referenced = directory.join(relative);
    if let Some(name) = referenced.file_name() {
        let beside = directory.join(name);
        if !referenced.exists() && beside.exists() {
            return beside;
        }
    }
    referenced
}
