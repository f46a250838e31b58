//! File formats: the interface for a format, the list of formats, and the choice among them.
//! `file_import.rs` reads files and folders with them.
//!
//! ```text
//! bytes -> format, by the first bytes         (extension: text formats and .mat only)
//!       -> variables, text or archived files  (the formats, independent of models and records)
//!       -> models or records                  (import)
//! ```
//!
//! Readers take memory and work from a `ReadingBudget` before they use it. The last argument to
//! `ReadingBudget::take` and `work` is the variable name for errors; where it is empty, a caller
//! adds the name or there is none. A factor of 2 allows for vectors, which grow by doubling.
//!
//! A new format is an `Importer` in its own file in this folder, and an entry in `FORMATS`.

pub mod element_order;
mod file_import;
mod folders;
mod foreign_formats;
mod json_and_gzip;
mod json_tree;
mod json_values;
pub(crate) mod logs;
pub mod mat;
pub(crate) mod mat73;
pub mod npy;
pub(crate) mod octave;
pub mod reading_note;
pub mod reading_reason;
pub(crate) mod recorded_columns;
pub(crate) mod sparse_matrix;
pub(crate) mod stored_number;
pub mod text;
pub mod variables;
pub(crate) mod zip_files;

#[cfg(test)]
mod limits_tests;

use std::path::Path;

use gdcm_model::assembly::FoundModel;
use gdcm_model::dataset::Dataset;

use self::variables::{PageIndex, Variable};
use crate::file_caution::FileCaution;
use crate::file_error::FileError;
use crate::formats::foreign_formats::FOREIGN_FORMAT;
use crate::formats::json_and_gzip::JSON;
use crate::formats::logs::{BLACKBOX, DATAFLASH, DATAFLASH_TEXT, ULOG};
use crate::formats::mat::MAT;
use crate::formats::mat73::HDF5;
use crate::formats::npy::NPY;
use crate::formats::octave::{OCTAVE_BINARY, OCTAVE_TEXT};
use crate::formats::reading_note::ReadingNote;
use crate::formats::recorded_columns::Columns;
use crate::formats::text::{MATLAB_STATEMENTS, TEXT};
use crate::formats::zip_files::ZIP;
use crate::reading_budget::{ReadingBudget, VariableFault};

pub use file_import::FolderProgress;
pub(crate) use file_import::{ImportedFile, import, import_bytes, import_file, with_file_name};
pub use folders::sources_folder;

/// A file format and the functions that recognise and read it.
pub(crate) struct Importer {
    pub(crate) name: &'static str,
    /// File name extensions in lower case, without the dot.
    pub(crate) endings: &'static [&'static str],
    /// Returns whether a file has the format, given its bytes and its extension.
    pub(crate) recognises: fn(&[u8], &str) -> bool,
    /// Reads the bytes of a file. Takes memory from the budget before using it. The path is for
    /// errors; some formats also take a variable's name or the format of compressed content from
    /// it.
    pub(crate) read: fn(&[u8], &Path, &ReadingBudget<'_>) -> Result<Contents, FileError>,
}

/// All formats. The first that recognises a file is used; the last recognises any file. `MAT`
/// recognises every file with the extension `.mat`: formats before it have priority for such files.
static FORMATS: [Importer; 14] = [
    NPY,
    ZIP,
    HDF5,
    OCTAVE_BINARY,
    ULOG,
    DATAFLASH,
    BLACKBOX,
    FOREIGN_FORMAT,
    // Before MAT, which takes every file named .mat: Octave's `save` writes text by default.
    OCTAVE_TEXT,
    MAT,
    DATAFLASH_TEXT,
    JSON,
    MATLAB_STATEMENTS,
    TEXT,
];

/// Contents of a file, as read by an importer.
pub(crate) enum Contents {
    /// Named values.
    Variables {
        variables: Vec<Variable>,
        /// Remarks on interpretations that are not obvious.
        notes: Vec<ReadingNote>,
        /// Index that selects a matrix in arrays with three dimensions.
        page_index: PageIndex,
    },
    /// Text with lines of numbers; their meaning depends on whether models or records are sought.
    Text(String),
    /// A dataset in this program's JSON format, with cautions about unknown keys.
    Dataset(Box<Dataset>, Vec<FileCaution>),
    /// Models in this program's JSON format, with cautions about unknown keys.
    Models(Vec<FoundModel>, Vec<FileCaution>),
    /// Autopilot logs: records whose columns may have different time axes.
    Logs(Vec<Columns>),
    Archive {
        /// NumPy arrays in the archive; together they form one set of variables.
        variables: Vec<Variable>,
        /// Other files in the archive: path, and contents or the error from reading them.
        files: Vec<(String, Result<Contents, FileError>)>,
        /// Messages about archived files that were not read: unsupported formats and nested
        /// archives.
        ignored: Vec<String>,
    },
}

impl Contents {
    /// Wraps variables in which the first index of arrays with three dimensions selects a matrix,
    /// as in NumPy and JSON.
    ///
    /// # Errors
    /// The error in `read`, with the path added.
    pub(crate) fn row_major(
        read: Result<Vec<Variable>, VariableFault>,
        path: &Path,
    ) -> Result<Self, FileError> {
        let variables = read.map_err(|fault| FileError::variables(path, fault))?;
        Ok(Self::Variables {
            variables,
            notes: Vec::new(),
            page_index: PageIndex::First,
        })
    }

    /// Wraps variables in which the last index of arrays with three dimensions selects a matrix, as
    /// in MATLAB.
    ///
    /// # Errors
    /// The error in `read`, with the path added.
    pub(crate) fn variables(
        read: Result<Vec<Variable>, VariableFault>,
        path: &Path,
    ) -> Result<Self, FileError> {
        let variables = read.map_err(|fault| FileError::variables(path, fault))?;
        Ok(Self::Variables {
            variables,
            notes: Vec::new(),
            page_index: PageIndex::Last,
        })
    }
}

/// Returns the importer for a file, by its bytes and the extension of `path`.
pub(crate) fn importer_of(bytes: &[u8], path: &Path) -> &'static Importer {
    let ending = ending_of(path);
    FORMATS
        .iter()
        .find(|format| (format.recognises)(bytes, &ending))
        .unwrap_or(&TEXT)
}

/// Returns whether a file name has an extension in `FORMATS`, which includes unsupported formats
/// that are recognised. Returns false for studies, which hold neither models nor records.
pub(crate) fn is_known(path: &Path) -> bool {
    if path.to_string_lossy().ends_with(".gdcm-study.json") {
        return false;
    }
    let ending = ending_of(path);
    FORMATS
        .iter()
        .any(|format| format.endings.contains(&ending.as_str()))
}

/// Returns the file name extension in lower case; empty if there is none.
fn ending_of(path: &Path) -> String {
    match path.extension() {
        Some(ending) => ending.to_string_lossy().to_lowercase(),
        None => String::new(),
    }
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
        assert_eq!(format(b"A = [1 2];", "a.m"), MATLAB_STATEMENTS.name);
        assert_eq!(format(b"1,2\n3,4\n", "a.csv"), TEXT.name);
        // The content decides, not the extension.
        assert_eq!(
            format(b"% a model\nA = [1 2\n 3 4];", "a.txt"),
            MATLAB_STATEMENTS.name
        );
        assert_eq!(format(b"% omega, re, im\n1,2,3\n4,5,6\n", "a.m"), TEXT.name);
        assert_eq!(format(b"Fs = 50\nt,P\n0,1\n1,2\n", "a.txt"), TEXT.name);
        assert_eq!(
            format(b"A = [\n1 2\n3 4\n];", "a.m"),
            MATLAB_STATEMENTS.name
        );
        for name in ["a.txt", "a.mat"] {
            let text = b"# Created by Octave 7.3.0\n# name: A\n# type: matrix\n";
            assert_eq!(format(text, name), OCTAVE_TEXT.name);
        }
        let header = [&[b'M'; 124][..], &[0, 1, b'I', b'M']].concat();
        assert_eq!(format(&header, "no extension"), MAT.name);
    }
}
