//! Why a file could not be read or written.

use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use super::content_fault::ContentFault;
use super::flaw::Flaw;
use super::place::Place;

/// Why a file could not be read or written: one line that names the file, and the place in it.
#[derive(Debug, thiserror::Error)]
pub enum FileError {
    /// There is no file of this name.
    #[error("{}: there is no such file", path.display())]
    Missing {
        /// The file.
        path: PathBuf,
    },
    /// The path is a directory.
    #[error("{}: this is a directory; give the name of a file", path.display())]
    Directory {
        /// The directory.
        path: PathBuf,
    },
    /// The system does not let the file be read.
    #[error("{}: cannot be read: {reason}", path.display())]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// What the system says.
        reason: String,
    },
    /// The file, or what it unpacks to, is larger than the program takes.
    #[error("{}: holds more than {most_mib} MiB of text, which is the most that is read; split the file", path.display())]
    TooLarge {
        /// The file.
        path: PathBuf,
        /// The limit \[MiB\].
        most_mib: u64,
    },
    /// The packed data are damaged.
    #[error("{}: the gzip data are damaged ({reason}); pack or copy the file again", path.display())]
    Gzip {
        /// The file.
        path: PathBuf,
        /// What is wrong with them.
        reason: String,
    },
    /// The packed data end too early.
    #[error("{}: the gzip data end too early, the file is cut off; copy it again", path.display())]
    GzipCutOff {
        /// The file.
        path: PathBuf,
    },
    /// The text ends before the JSON does.
    #[error("{}: {}the JSON ends too early (line {line}, column {column}), the file is cut off; copy it again", path.display(), place.before())]
    CutOff {
        /// The file.
        path: PathBuf,
        /// What was being read.
        place: Box<Place>,
        /// Line, counted from 1.
        line: usize,
        /// Column in bytes, counted from 1.
        column: usize,
    },
    /// The text is not JSON.
    #[error("{}: {}this is not JSON (line {line}, column {column}: {reason})", path.display(), place.before())]
    NotJson {
        /// The file.
        path: PathBuf,
        /// What was being read.
        place: Box<Place>,
        /// Line, counted from 1.
        line: usize,
        /// Column in bytes, counted from 1.
        column: usize,
        /// What is wrong there.
        reason: String,
    },
    /// The file is of another kind.
    #[error("{}: expected \"format\": \"{expected}\", found {found}", path.display())]
    Format {
        /// The file.
        path: PathBuf,
        /// The format asked for, or the formats.
        expected: &'static str,
        /// What the file says, in words.
        found: String,
    },
    /// The file is of a version this program does not know.
    #[error("{}: expected version {newest} of {format}, found {found}; a newer gdcm may be able to read it", path.display())]
    Version {
        /// The file.
        path: PathBuf,
        /// The format.
        format: &'static str,
        /// The version this program reads.
        newest: u64,
        /// What the file says, in words.
        found: String,
    },
    /// Something in the file is not what it has to be.
    #[error("{}: {}{fault}", path.display(), place.before())]
    Content {
        /// The file.
        path: PathBuf,
        /// Where in the file.
        place: Box<Place>,
        /// What is wrong there.
        fault: Box<ContentFault>,
    },
    /// The dataset of a study cannot be read.
    #[error("{}: the study's dataset cannot be opened: {dataset}; say where it is now (--dataset FILE)", path.display())]
    StudyDataset {
        /// The study.
        path: PathBuf,
        /// Why not, with the dataset's path.
        dataset: Box<FileError>,
    },
    /// The file could not be written; what was there before is still there.
    #[error("{}: cannot be written: {reason}", path.display())]
    Unwritable {
        /// The file.
        path: PathBuf,
        /// What the system says.
        reason: String,
    },
}

impl FileError {
    pub(super) fn reading(path: &Path, error: &std::io::Error) -> Self {
        let path = path.to_owned();
        match error.kind() {
            ErrorKind::NotFound => FileError::Missing { path },
            ErrorKind::IsADirectory => FileError::Directory { path },
            _ => FileError::Unreadable { path, reason: error.to_string() },
        }
    }

    pub(super) fn writing(path: &Path, reason: impl ToString) -> Self {
        FileError::Unwritable { path: path.to_owned(), reason: reason.to_string() }
    }

    pub(super) fn content(path: &Path, flaw: Flaw) -> Self {
        let Flaw { place, fault } = flaw;
        FileError::Content { path: path.to_owned(), place, fault }
    }
}
