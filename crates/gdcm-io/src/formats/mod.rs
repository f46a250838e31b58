//! Number files of other programs: the format interface, the list of formats, and the reading of
//! files and folders.
//!
//! ```text
//! bytes -> format, by what they begin with              (the ending of the name decides only between texts)
//!       -> variables, a text, or the files of an archive    (the formats, which know nothing of models and records)
//!       -> models or records                                (recognise)
//! ```
//!
//! A new format is an `Importer` in a file of its own in this folder, and an entry in `FORMATS`.

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

use std::fs;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use gdcm_model::assembly::FoundModel;
use gdcm_model::dataset::Dataset;
use gdcm_model::message_text::sanitized;

use self::variables::Variable;
use crate::file_error::FileError;
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
use crate::source::{kind_of, read_bytes, sha256};

/// Largest file \[bytes\].
pub(crate) const LARGEST_FILE: u64 = 512 << 20;
/// Largest number of files examined, and deepest nesting of folders.
pub(crate) const MOST_FILES: usize = 20_000;
pub(crate) const DEEPEST: usize = 16;

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
        /// Whether the first index of an array of more than two dimensions counts its matrices, as
        /// in NumPy.
        pages_first: bool,
    },
    /// Lines of numbers, whose meaning depends on the kind of data sought.
    Text(String),
    /// A dataset of this program, with remarks on unknown parts.
    Dataset(Box<Dataset>, Vec<String>),
    /// Models of this program, with remarks on unknown parts.
    Models(Vec<FoundModel>, Vec<String>),
    /// Aircraft logs: records with any clocks.
    Logs(Vec<Columns>),
    Archive {
        /// Its arrays, which belong together.
        variables: Vec<Variable>,
        /// Its other files by path, each with its contents.
        files: Vec<(String, Result<Contents, FileError>)>,
        /// Descriptions of files of unknown kind.
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

/// Progress of reading files, and its cancellation.
pub trait FolderProgress {
    /// Called before a file is read, with its number from 1, the number of files and its name.
    fn reading(&self, number: usize, of: usize, name: &str);
    /// Called when memory is taken for the contents of a file.
    fn taken(&self, _bytes: u64) {}
    /// Ends the reading once it is set.
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
    let files = files_of(paths, &mut faults)?;
    let stop = progress.stop();
    let tell = |taken| progress.taken(taken);
    for (index, (path, name)) in files.iter().enumerate() {
        if stop.load(Ordering::Relaxed) {
            break;
        }
        progress.reading(index + 1, files.len(), name);
        let budget = ReadingBudget::default()
            .stopped_by(Arc::clone(&stop))
            .telling(&tell);
        match import_file(path, name, &budget).and_then(|file| take(file, &budget)) {
            Ok(()) => {}
            Err(error) if paths.len() == 1 && files.len() == 1 => return Err(error),
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

/// Returns the folder to which the file names of models are relative: the first folder given, or
/// the folder of a single file.
pub fn sources_folder(sources: &[PathBuf]) -> &Path {
    let here = Path::new(".");
    let first = sources.first().map_or(here, PathBuf::as_path);
    let folder = if first.is_dir() {
        first
    } else {
        first.parent().unwrap_or(here)
    };
    if folder.as_os_str().is_empty() {
        here
    } else {
        folder
    }
}

/// Finds the requested files, and the files with known endings in folders, sorted by name: their
/// paths, and their names relative to the requested path. Other entries are skipped with a message.
fn files_of(
    paths: &[PathBuf],
    skipped: &mut Vec<String>,
) -> Result<Vec<(PathBuf, String)>, FileError> {
    let mut files = Vec::new();
    for path in paths {
        if path.is_dir() {
            list(path, path, DEEPEST, &mut files, skipped)?;
        } else {
            let name = path
                .file_name()
                .map(|name| name.to_string_lossy().into_owned())
                .unwrap_or_default();
            files.push((path.clone(), name));
        }
    }
    Ok(files)
}

/// Lists the files below a folder, sorted by name, with their relative paths.
fn list(
    folder: &Path,
    root: &Path,
    deeper: usize,
    files: &mut Vec<(PathBuf, String)>,
    skipped: &mut Vec<String>,
) -> Result<(), FileError> {
    let failed = |error: std::io::Error| FileError::reading(folder, &error);
    let mut entries = fs::read_dir(folder)
        .map_err(failed)?
        .collect::<Result<Vec<_>, _>>()
        .map_err(failed)?;
    entries.sort_by_key(|entry| natural(&entry.file_name().to_string_lossy()));
    for entry in entries {
        let path = entry.path();
        let hidden = entry.file_name().to_string_lossy().starts_with('.');
        // Links could form cycles.
        let kind = entry.file_type().map_err(failed)?;
        if hidden || kind.is_symlink() && path.is_dir() {
            continue;
        }
        if kind.is_dir() {
            if deeper == 0 {
                return Err(FileError::FolderTooDeep { path });
            }
            list(&path, root, deeper - 1, files, skipped)?;
        } else if is_known(&path) && !is_other_log(&path) {
            let meant = fs::metadata(&path).map_or(kind, |metadata| metadata.file_type());
            let name = path
                .strip_prefix(root)
                .unwrap_or(&path)
                .to_string_lossy()
                .replace('\\', "/");
            match kind_of(meant) {
                Some(kind) => skipped.push(format!(
                    "{}: skipped, for this is {kind}, not a file",
                    sanitized(&name)
                )),
                None => files.push((path, name)),
            }
        }
        if files.len() > MOST_FILES {
            return Err(FileError::TooManyFiles {
                path: root.to_owned(),
                most: MOST_FILES,
            });
        }
    }
    Ok(())
}

/// Whether a file with a widely used ending (`.log`, `.bin`) has none of the supported formats.
fn is_other_log(path: &Path) -> bool {
    /// Formats with these endings are recognised by their first bytes.
    const FIRST: usize = 64;
    if !["bin", "log"].contains(&ending_of(path).as_str()) || !path.is_file() {
        return false;
    }
    let mut first = Vec::with_capacity(FIRST);
    let read =
        fs::File::open(path).and_then(|file| file.take(FIRST as u64).read_to_end(&mut first));
    read.is_ok() && importer_of(&first, path).name == TEXT.name
}

/// Whether a file name has the ending of a known format; studies are no sources of models or
/// records.
pub(crate) fn is_known(path: &Path) -> bool {
    let ending = ending_of(path);
    FORMATS
        .iter()
        .any(|format| format.endings.contains(&ending.as_str()))
        && !path.to_string_lossy().ends_with(".gdcm-study.json")
}

/// Returns the ending of a file name, in lower case.
fn ending_of(path: &Path) -> String {
    path.extension()
        .map(|ending| ending.to_string_lossy().to_lowercase())
        .unwrap_or_default()
}

/// Returns a sort key that puts "c2" before "c10".
fn natural(name: &str) -> Vec<(String, u64)> {
    let mut parts = Vec::new();
    let mut text = String::new();
    let mut digits = String::new();
    for letter in name.chars().chain(['\0']) {
        if letter.is_ascii_digit() && digits.len() < 18 {
            digits.push(letter);
            continue;
        }
        if !digits.is_empty() {
            parts.push((
                std::mem::take(&mut text),
                digits.parse().unwrap_or(u64::MAX),
            ));
            digits.clear();
        }
        text.extend(letter.to_lowercase());
    }
    parts.push((text, 0));
    parts
}

// Unsupported formats recognised by their first bytes: names and export instructions.

/// An unsupported format: signatures, name, and instructions.
type Foreign = (&'static [&'static [u8]], &'static str, &'static str);

const AS_TABLE: &str = "save it as text in columns (CSV)";
const UNPACK: &str = "unpack it, or pack it as .zip or .gz";
const FROM_FEATHER: &str = "save it as CSV: pandas.read_feather(\"{file}\").to_csv(\"{stem}.csv\")";
const FROM_PARQUET: &str = "save it as CSV: pandas.read_parquet(\"{file}\").to_csv(\"{stem}.csv\")";
const FROM_PICKLE: &str = "save its arrays: numpy.savez(\"{stem}.npz\", A=A, B=B, C=C, D=D)";
const FROM_NETCDF: &str =
    "save it as CSV or as netCDF-4, which is HDF5: nccopy -k nc4 \"{file}\" \"{stem}.h5\"";

const FOREIGN: [Foreign; 13] = [
    (&[b"PAR1"], "a Parquet file", FROM_PARQUET),
    (&[b"ARROW1"], "an Arrow or Feather file", FROM_FEATHER),
    (&[b"FEA1"], "a Feather file", FROM_FEATHER),
    (
        &[b"\x80\x02", b"\x80\x03", b"\x80\x04", b"\x80\x05"],
        "a pickle of Python",
        FROM_PICKLE,
    ),
    (
        &[b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1"],
        "an Excel workbook or another document of Microsoft Office",
        AS_TABLE,
    ),
    (&[b"SQLite format 3"], "a database of SQLite", AS_TABLE),
    (&[b"CDF\x01", b"CDF\x02"], "a netCDF file", FROM_NETCDF),
    (
        &[b"MDF     "],
        "an MDF file of measurements",
        "save it as CSV or MATLAB",
    ),
    (
        &[b"TDSm"],
        "a TDMS file of LabVIEW",
        "save it as CSV or MATLAB",
    ),
    (&[b"%PDF-"], "a PDF document", AS_TABLE),
    (
        &[b"\x89PNG"],
        "a picture",
        "save its numbers, not what they look like",
    ),
    (&[b"7z\xbc\xaf\x27"], "an archive of 7-Zip", UNPACK),
    (&[b"\xfd7zXZ"], "a file packed by xz", UNPACK),
];

/// Recognises unsupported formats.
pub(crate) const FOREIGN_FORMAT: Importer = Importer {
    name: "a file of a format that is not read",
    endings: &["parquet", "feather", "pkl"],
    recognises: |bytes, _| foreign(bytes).is_some(),
    read: |bytes, path, _| {
        let (what, remedy) =
            foreign(bytes).map_or(("a file", AS_TABLE), |(_, what, remedy)| (*what, *remedy));
        Err(FileError::variables(
            path,
            VariableFault::unsupported("", what, remedy),
        ))
    },
};

fn foreign(bytes: &[u8]) -> Option<&'static Foreign> {
    FOREIGN
        .iter()
        .find(|(marks, ..)| marks.iter().any(|mark| bytes.starts_with(mark)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_is_what_it_begins_with_whatever_it_is_called() {
        let of = |bytes: &[u8], name: &str| importer_of(bytes, Path::new(name)).name;
        assert_eq!(of(b"\x93NUMPY\x01\x00", "a.mat"), NPY.name);
        assert_eq!(of(b"PK\x03\x04", "a.txt"), ZIP.name);
        assert_eq!(of(b"\x89HDF\r\n\x1a\n", "a.mat"), HDF5.name);
        assert_eq!(of(b" {\"A\": 1}", "a.txt"), JSON.name);
        assert_eq!(of(b"A = [1 2];", "a.m"), LITERALS.name);
        assert_eq!(of(b"1,2\n3,4\n", "a.csv"), TEXT.name);
        // The ending does not affect how the same text is read.
        assert_eq!(of(b"% a model\nA = [1 2\n 3 4];", "a.txt"), LITERALS.name);
        assert_eq!(of(b"% omega, re, im\n1,2,3\n4,5,6\n", "a.m"), TEXT.name);
        assert_eq!(of(b"Fs = 50\nt,P\n0,1\n1,2\n", "a.txt"), TEXT.name);
        assert_eq!(of(b"A = [\n1 2\n3 4\n];", "a.m"), LITERALS.name);
        assert_eq!(
            of(
                b"# Created by Octave 7.3.0\n# name: A\n# type: matrix\n",
                "a.txt"
            ),
            OCTAVE_TEXT.name
        );
        let header = [&[b'M'; 124][..], &[0, 1, b'I', b'M']].concat();
        assert_eq!(of(&header, "no extension"), MAT.name);
    }
    #[test]
    fn names_are_sorted_as_people_count() {
        let mut names = ["c10", "c2", "C1b", "c1", "roll+5", "roll-5"];
        names.sort_by_key(|name| natural(name));
        assert_eq!(names, ["c1", "C1b", "c2", "c10", "roll+5", "roll-5"]);
    }
}

#[cfg(test)]
mod foreign_tests {
    use super::*;

    #[test]
    fn a_file_of_another_format_is_named_with_the_way_to_save_it_otherwise() {
        let read = (FOREIGN_FORMAT.read)(
            b"PAR1\x15\x04",
            Path::new("logs/flight 7.parquet"),
            &ReadingBudget::new(1 << 20),
        );
        let words = read
            .err()
            .map(|error| error.to_string())
            .unwrap_or_default();
        assert!(
            words.contains("a Parquet file cannot be read; save it as CSV"),
            "{words}"
        );
        assert!(
            words.ends_with("pandas.read_parquet(\"flight 7.parquet\").to_csv(\"flight 7.csv\")"),
            "{words}"
        );
        assert!(!(FOREIGN_FORMAT.recognises)(b"omega,re,im\n", "csv"));
    }
}
