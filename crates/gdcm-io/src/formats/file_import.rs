//! Imports files and folders: each file is read in its format ([`importer_of`]), and its contents
//! are passed to the caller's `take`.
//!
//! [`import`] reads files and folders, [`import_file`] a single file, and [`import_bytes`] a file
//! whose bytes are in memory.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use crate::file_error::FileError;
use crate::file_reading::{read_bytes, sha256};
use crate::formats::folders::list_files;
use crate::formats::{Contents, importer_of};
use crate::reading_budget::ReadingBudget;

/// Maximum file size \[bytes\].
pub(crate) const LARGEST_FILE: u64 = 512 << 20;

/// Receives progress while files are read, and can cancel the reading.
pub trait FolderProgress {
    /// Called before a file is read, with its number (from 1), the number of files, and its name,
    /// relative to the given folder.
    fn reading(&self, number: usize, count: usize, name: &str);
    /// Receives the memory taken so far for the current file \[bytes\], whenever more is taken.
    fn taken(&self, _bytes: u64) {}
    /// Returns the flag that cancels the reading when set.
    fn stop(&self) -> Arc<AtomicBool> {
        Arc::default()
    }
}

/// A file that was read, with its contents.
pub(crate) struct ImportedFile<'f> {
    pub(crate) path: &'f Path,
    /// Path relative to the requested folder; for a file given by itself, its name.
    pub(crate) name: &'f str,
    /// SHA-256 of the file in lower-case hexadecimal.
    pub(crate) sha256: String,
    pub(crate) contents: Contents,
}

/// Reads a file whose bytes are in memory, in its format ([`importer_of`]).
pub(crate) fn import_bytes<'f>(
    bytes: &[u8],
    path: &'f Path,
    name: &'f str,
    budget: &ReadingBudget<'_>,
) -> Result<ImportedFile<'f>, FileError> {
    let contents = (importer_of(bytes, path).read)(bytes, path, budget)?;
    Ok(ImportedFile {
        path,
        name,
        sha256: sha256(bytes, path, budget)?,
        contents,
    })
}

/// Reads a file in its format ([`importer_of`]).
///
/// # Errors
/// [`FileError`] if the file exceeds `LARGEST_FILE`, or cannot be read.
pub(crate) fn import_file<'f>(
    path: &'f Path,
    name: &'f str,
    budget: &ReadingBudget<'_>,
) -> Result<ImportedFile<'f>, FileError> {
    import_bytes(&read_bytes(path, LARGEST_FILE, budget)?, path, name, budget)
}

/// Reads files and folders recursively and passes each file to `take`. A cancellation ends the
/// reading; it is reported, as that file's error, only if it occurs within a file. Returns the
/// number of files found, whether read or not, and the reasons why files were skipped or could not
/// be read.
///
/// # Errors
/// [`FileError`] if a folder cannot be listed. If a single path leads to a single file, also the
/// error from reading this file, or from `take`.
pub(crate) fn import(
    paths: &[PathBuf],
    progress: &dyn FolderProgress,
    mut take: impl FnMut(ImportedFile<'_>, &ReadingBudget<'_>) -> Result<(), FileError>,
) -> Result<(usize, Vec<String>), FileError> {
    let mut faults = Vec::new();
    let files = list_files(paths, &mut faults)?;
    let is_single = paths.len() == 1 && files.len() == 1;
    let stop = progress.stop();
    let report_memory = |taken| progress.taken(taken);
    for (index, file) in files.iter().enumerate() {
        if stop.load(Ordering::Relaxed) {
            break;
        }
        progress.reading(index + 1, files.len(), &file.name);
        let budget = ReadingBudget::default()
            .stopped_by(Arc::clone(&stop))
            .with_memory_callback(&report_memory);
        let read = import_file(&file.path, &file.name, &budget);
        match read.and_then(|imported| take(imported, &budget)) {
            Ok(()) => {}
            Err(error) if is_single => return Err(error),
            Err(error) => faults.push(error.to_string()),
        }
    }
    Ok((files.len(), faults))
}

/// Puts the file name before each remark that does not begin with it.
pub(crate) fn with_file_name(name: &str, remarks: Vec<String>) -> impl Iterator<Item = String> {
    remarks.into_iter().map(move |remark| {
        if remark.starts_with(name) {
            remark
        } else {
            format!("{name}: {remark}")
        }
    })
}
