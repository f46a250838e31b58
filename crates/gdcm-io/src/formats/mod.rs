//! Number files from other programs: the format interface, the list of formats, and reading.
//!
//! ```text
//! bytes -> format, by the first bytes         (the ending decides only between text formats)
//!       -> variables, text or archived files  (the formats, independent of models and records)
//!       -> models or records                  (recognise)
//! ```
//!
//! A new format is an `Importer` in a file of its own in this folder, and an entry in `FORMATS`.

mod folders;
mod foreign_formats;
mod json_tree;
pub(crate) mod json_values;
pub(crate) mod logs;
pub mod mat;
pub(crate) mod mat73;
pub mod npy;
pub(crate) mod octave;
pub(crate) mod recorded_columns;
pub(crate) mod sparse_matrix;
pub mod strides;
pub mod text;
pub mod variables;
pub(crate) mod zip_files;

#[cfg(test)]
mod limits_tests;

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use gdcm_model::assembly::FoundModel;
use gdcm_model::dataset::Dataset;

use self::variables::Variable;
use crate::file_error::FileError;
use crate::formats::folders::list_files;
use crate::formats::foreign_formats::FOREIGN_FORMAT;
use crate::formats::json_values::JSON;
use crate::formats::logs::{BLACKBOX, DATAFLASH, DATAFLASH_TEXT, ULOG};
use crate::formats::mat::MAT;
use crate::formats::mat73::HDF5;
use crate::formats::npy::NPY;
use crate::formats::octave::{OCTAVE_BINARY, OCTAVE_TEXT};
use crate::formats::recorded_columns::Columns;
use crate::formats::text::{LITERALS, TEXT};
use crate::formats::zip_files::ZIP;
use crate::reading_budget::{ReadingBudget, VariableFault};
use crate::source::{read_bytes, sha256};

pub use folders::sources_folder;
#[cfg(test)]
pub(crate) use folders::{DEEPEST, MOST_FILES};

/// Maximum file size \[bytes\].
pub(crate) const LARGEST_FILE: u64 = 512 << 20;

/// A file format.
pub(crate) struct Importer {
    pub(crate) name: &'static str,
    /// File name endings, in lower case.
    pub(crate) endings: &'static [&'static str],
    /// Whether the bytes of a file with this ending have the format.
    pub(crate) recognises: fn(&[u8], &str) -> bool,
    /// Reads the contents of the bytes; takes memory from the budget before its use. The path names
    /// the file in errors.
    pub(crate) read: fn(&[u8], &Path, &ReadingBudget<'_>) -> Result<Contents, FileError>,
}

/// The formats; the first that recognises a file reads it, and the last recognises any file.
static FORMATS: [Importer; 14] = [
    NPY,
    ZIP,
    HDF5,
    OCTAVE_BINARY,
    ULOG,
    DATAFLASH,
    BLACKBOX,
    FOREIGN_FORMAT,
    MAT,
    OCTAVE_TEXT,
    DATAFLASH_TEXT,
    JSON,
    LITERALS,
    TEXT,
];

/// Contents of a file.
pub(crate) enum Contents {
    /// Named values.
    Variables {
        variables: Vec<Variable>,
        /// Remarks on non-obvious readings.
        notes: Vec<String>,
        /// Whether the first index of an array of more than two dimensions selects a matrix, as in
        /// NumPy.
        pages_first: bool,
    },
    /// Lines of numbers, whose meaning depends on the kind of data sought.
    Text(String),
    /// A dataset in this program's JSON format, with remarks on unknown keys.
    Dataset(Box<Dataset>, Vec<String>),
    /// Models in this program's JSON format, with remarks on unknown keys.
    Models(Vec<FoundModel>, Vec<String>),
    /// Aircraft logs: records whose columns may have different clocks.
    Logs(Vec<Columns>),
    Archive {
        /// Arrays in the archive, which belong together.
        variables: Vec<Variable>,
        /// Other files in the archive by path, each with its contents.
        files: Vec<(String, Result<Contents, FileError>)>,
        /// Descriptions of files with an unknown format.
        ignored: Vec<String>,
    },
}

impl Contents {
    /// Wraps row-major arrays from NumPy or JSON, or the fault.
    pub(crate) fn row_major(
        read: Result<Vec<Variable>, VariableFault>,
        path: &Path,
    ) -> Result<Self, FileError> {
        let variables = read.map_err(|fault| FileError::variables(path, fault))?;
        Ok(Self::Variables {
            variables,
            notes: Vec::new(),
            pages_first: true,
        })
    }

    /// Wraps variables, or the fault.
    pub(crate) fn variables(
        read: Result<Vec<Variable>, VariableFault>,
        path: &Path,
    ) -> Result<Self, FileError> {
        let variables = read.map_err(|fault| FileError::variables(path, fault))?;
        Ok(Self::Variables {
            variables,
            notes: Vec::new(),
            pages_first: false,
        })
    }
}

/// Returns the format for the bytes of a file with this name.
pub(crate) fn importer_of(bytes: &[u8], path: &Path) -> &'static Importer {
    let ending = ending_of(path);
    FORMATS
        .iter()
        .find(|format| (format.recognises)(bytes, &ending))
        .unwrap_or(&TEXT)
}

/// Whether a file name has the ending of a known format, except that of studies, which hold neither
/// models nor records.
pub(crate) fn is_known(path: &Path) -> bool {
    if path.to_string_lossy().ends_with(".gdcm-study.json") {
        return false;
    }
    let ending = ending_of(path);
    FORMATS
        .iter()
        .any(|format| format.endings.contains(&ending.as_str()))
}

/// Returns the ending of a file name, in lower case.
fn ending_of(path: &Path) -> String {
    match path.extension() {
        Some(ending) => ending.to_string_lossy().to_lowercase(),
        None => String::new(),
    }
}

/// Progress of reading files, and its cancellation.
pub trait FolderProgress {
    /// Called before a file is read, with its number from 1, the number of files and its name.
    fn reading(&self, number: usize, count: usize, name: &str);
    /// Called when memory is taken for the contents of a file \[bytes\].
    fn taken(&self, _bytes: u64) {}
    /// Returns the flag that ends the reading when set.
    fn stop(&self) -> Arc<AtomicBool> {
        Arc::default()
    }
}

/// A file after reading.
pub(crate) struct ImportedFile<'f> {
    pub(crate) path: &'f Path,
    /// Name relative to the requested path.
    pub(crate) name: &'f str,
    /// SHA-256 of the bytes, in lower-case hexadecimal.
    pub(crate) sha256: String,
    pub(crate) contents: Contents,
}

/// Imports the bytes of a file.
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

/// Imports one file.
pub(crate) fn import_file<'f>(
    path: &'f Path,
    name: &'f str,
    budget: &ReadingBudget<'_>,
) -> Result<ImportedFile<'f>, FileError> {
    import_bytes(&read_bytes(path, LARGEST_FILE, budget)?, path, name, budget)
}

/// Reads files and folders recursively and passes each file to `take`; returns the number of files
/// and the reasons why some could not be read. With a single requested file, such a reason is an
/// error.
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

/// Prefixes remarks with the name of their file, unless they already begin with it.
pub(crate) fn of_file(name: &str, words: Vec<String>) -> impl Iterator<Item = String> {
    words.into_iter().map(move |words| {
        if words.starts_with(name) {
            words
        } else {
            format!("{name}: {words}")
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_bytes_decide_the_format_whatever_the_name() {
        let format = |bytes: &[u8], name: &str| importer_of(bytes, Path::new(name)).name;
        assert_eq!(format(b"\x93NUMPY\x01\x00", "a.mat"), NPY.name);
        assert_eq!(format(b"PK\x03\x04", "a.txt"), ZIP.name);
        assert_eq!(format(b"\x89HDF\r\n\x1a\n", "a.mat"), HDF5.name);
        assert_eq!(format(b" {\"A\": 1}", "a.txt"), JSON.name);
        assert_eq!(format(b"A = [1 2];", "a.m"), LITERALS.name);
        assert_eq!(format(b"1,2\n3,4\n", "a.csv"), TEXT.name);
        // These texts are recognised by their content, whatever the ending.
        assert_eq!(
            format(b"% a model\nA = [1 2\n 3 4];", "a.txt"),
            LITERALS.name
        );
        assert_eq!(format(b"% omega, re, im\n1,2,3\n4,5,6\n", "a.m"), TEXT.name);
        assert_eq!(format(b"Fs = 50\nt,P\n0,1\n1,2\n", "a.txt"), TEXT.name);
        assert_eq!(format(b"A = [\n1 2\n3 4\n];", "a.m"), LITERALS.name);
        assert_eq!(
            format(
                b"# Created by Octave 7.3.0\n# name: A\n# type: matrix\n",
                "a.txt"
            ),
            OCTAVE_TEXT.name
        );
        let header = [&[b'M'; 124][..], &[0, 1, b'I', b'M']].concat();
        assert_eq!(format(&header, "no extension"), MAT.name);
    }
}
