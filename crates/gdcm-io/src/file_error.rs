//! Why a file could not be read or written.

use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use gdcm_method::requirements::tolerance::ToleranceError;
use gdcm_model::dataset::channel::Location;
use gdcm_model::dataset::dataset::BandError;
use gdcm_model::dataset::unchecked_dataset::{DraftError, DraftFault};
use gdcm_model::message_text::{quoted, sanitized, sanitized_path};
use gdcm_study::study::edit::EditRefusal;

use crate::exports::ExportFault;
use crate::json_text::line_of;
use crate::variables::VariableFault;

/// Why a file could not be read or written: one line that names the file, and the place in it.
#[derive(Debug, thiserror::Error)]
pub enum FileError {
    /// There is no file of this name.
    #[error("{}: there is no such file", sanitized_path(path))]
    Missing {
        /// The file.
        path: PathBuf,
    },
    /// The path is a directory.
    #[error(
        "{}: this is a directory; give the name of a file",
        sanitized_path(path)
    )]
    Directory {
        /// The directory.
        path: PathBuf,
    },
    /// The path is neither a file nor a directory: reading it might never end.
    #[error(
        "{}: this is {kind}, not a file; save what it gives as a file, and give its name",
        sanitized_path(path)
    )]
    NotAFile {
        /// The path.
        path: PathBuf,
        /// What it is, in words.
        kind: &'static str,
    },
    /// A named pipe, a socket or a device stands where a file is to be written.
    #[error(
        "{}: this is {kind}, not a file, and is not written to; give the name of a file",
        sanitized_path(path)
    )]
    OutputNotAFile {
        /// The path.
        path: PathBuf,
        /// What it is, in words.
        kind: &'static str,
    },
    /// The system does not let the file be read.
    #[error("{}: cannot be read: {reason}", sanitized_path(path))]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// What the system says.
        reason: String,
    },
    /// The file, or what it unpacks to, is larger than the program takes.
    #[error(
        "{}: holds more than {most_mib} MiB, which is the most that is read; split the file",
        sanitized_path(path)
    )]
    TooLarge {
        /// The file.
        path: PathBuf,
        /// The limit \[MiB\].
        most_mib: u64,
    },
    /// The packed data are damaged.
    #[error(
        "{}: the gzip data are damaged; pack or copy the file again",
        sanitized_path(path)
    )]
    Gzip {
        /// The file.
        path: PathBuf,
    },
    /// The packed data end too early.
    #[error(
        "{}: the gzip data end too early, the file is cut off; copy it again",
        sanitized_path(path)
    )]
    GzipCutOff {
        /// The file.
        path: PathBuf,
    },
    /// The text ends before the JSON does.
    #[error("{}: {}the JSON ends too early (line {line}, column {column}), the file is cut off; copy it again", sanitized_path(path), place.before())]
    CutOff {
        /// The file.
        path: PathBuf,
        /// What was being read.
        place: Box<Location>,
        /// Line, counted from 1.
        line: usize,
        /// Column in bytes, counted from 1.
        column: usize,
    },
    /// The text is not JSON.
    #[error("{}: {}this is not JSON (line {line}, column {column}: {reason})", sanitized_path(path), place.before())]
    NotJson {
        /// The file.
        path: PathBuf,
        /// What was being read.
        place: Box<Location>,
        /// Line, counted from 1.
        line: usize,
        /// Column in bytes, counted from 1.
        column: usize,
        /// What is wrong there.
        reason: String,
    },
    /// The file is of another kind.
    #[error(
        "{}: expected \"format\": \"{expected}\", found {found}",
        sanitized_path(path)
    )]
    Format {
        /// The file.
        path: PathBuf,
        /// The format asked for, or the formats.
        expected: &'static str,
        /// What the file says, in words.
        found: String,
    },
    /// The file is of a version this program does not know.
    #[error(
        "{}: expected version {newest} of {format}, found {found}; a newer gdcm may be able to read it",
        sanitized_path(path)
    )]
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
    #[error("{}: {}{fault}{}", sanitized_path(path), place.before(), line.map(|line| format!(" (line {line})")).unwrap_or_default())]
    Content {
        /// The file.
        path: PathBuf,
        /// Where in the file.
        place: Box<Location>,
        /// What is wrong there.
        fault: Box<ContentFault>,
        /// Line at which the condition or the model begins, counted from 1; none where the fault names its own.
        line: Option<usize>,
    },
    /// A file of variables cannot be read, or not be written.
    #[error("{}: {}", sanitized_path(path), sanitized(&.fault.to_string()))]
    Variables {
        /// The file.
        path: PathBuf,
        /// Why not.
        fault: VariableFault,
    },
    /// Folders lie in folders, deeper than models are looked for.
    #[error(
        "{}: folders lie too deep inside one another; give a folder farther down",
        sanitized_path(path)
    )]
    FolderTooDeep {
        /// The folder.
        path: PathBuf,
    },
    /// A file of records does not hold the one that is asked for.
    #[error("{}: {}", sanitized_path(path), no_record_words(record.as_deref(), *held))]
    NoRecord {
        /// The file.
        path: PathBuf,
        /// The record; none for the only one.
        record: Option<String>,
        /// How many records it holds.
        held: usize,
    },
    /// A folder holds more files than are looked at.
    #[error(
        "{}: holds more than {most} files; give a folder with fewer",
        sanitized_path(path)
    )]
    TooManyFiles {
        /// The folder.
        path: PathBuf,
        /// The limit.
        most: usize,
    },
    /// The dataset of a study cannot be read.
    #[error(
        "{}: the study's dataset cannot be opened: {dataset}; say where it is now, with --dataset and its path",
        sanitized_path(path)
    )]
    StudyDataset {
        /// The study.
        path: PathBuf,
        /// Why not, with the dataset's path.
        dataset: Box<FileError>,
    },
    /// A file stands where a directory has to be made.
    #[error(
        "{}: cannot be written: a file stands where this directory would have to be made",
        sanitized_path(path)
    )]
    NotADirectory {
        /// The directory.
        path: PathBuf,
    },
    /// Files are there already, and were not asked to be replaced.
    #[error("{} {} already", listed(paths), if paths.len() == 1 { "exists" } else { "exist" })]
    Exists {
        /// The files.
        paths: Vec<PathBuf>,
    },
    /// The file is what the program reads from.
    #[error(
        "{}: the data are read from this file, so it is not overwritten; choose another name or directory",
        sanitized_path(path)
    )]
    Input {
        /// The file.
        path: PathBuf,
    },
    /// The name of a file does not say what a figure is to be written as.
    #[error(
        "{}: a figure is written to a name that ends in .svg, .png, .pdf or .csv",
        sanitized_path(path)
    )]
    FigureFormat {
        /// The file.
        path: PathBuf,
    },
    /// The numbers of a figure are asked for that shows none.
    #[error(
        "{}: \"{}\" shows no numbers that could be written: none of the responses or channels asked for has a result; ask for others, or \
         for .svg",
        sanitized_path(path),
        sanitized(title)
    )]
    FigureWithoutNumbers {
        /// The file.
        path: PathBuf,
        /// The title of the figure.
        title: String,
    },
    /// What was asked for cannot be exported.
    #[error("{}: {}", sanitized_path(path), sanitized(&.fault.to_string()))]
    Export {
        /// The file.
        path: PathBuf,
        /// Why not.
        fault: ExportFault,
    },
    /// The file could not be written; what was there before is still there.
    #[error("{}: cannot be written: {reason}", sanitized_path(path))]
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
            _ => FileError::Unreadable {
                path,
                reason: system_words(error),
            },
        }
    }

    pub(super) fn writing(path: &Path, error: &std::io::Error) -> Self {
        match error.kind() {
            ErrorKind::NotFound => Self::unwritable(path, "its directory does not exist"),
            _ => Self::unwritable(path, &system_words(error)),
        }
    }

    pub(super) fn unwritable(path: &Path, reason: &str) -> Self {
        FileError::Unwritable {
            path: path.to_owned(),
            reason: reason.to_owned(),
        }
    }

    /// Why the variables of a file cannot be read; a remedy names the file.
    pub(super) fn variables(path: &Path, mut fault: VariableFault) -> Self {
        if let VariableFault::Unsupported { remedy, .. } = &mut fault {
            let name =
                |path: &Path| sanitized(&path.file_name().unwrap_or_default().to_string_lossy());
            *remedy = remedy
                .replace("{file}", &name(path))
                .replace("{stem}", &name(&path.with_extension("")));
        }
        FileError::Variables {
            path: path.to_owned(),
            fault,
        }
    }

    /// The stable code of an error that scripts tell from others; none where there is none yet.
    pub fn code(&self) -> Option<&'static str> {
        match self {
            Self::NotAFile { .. } => Some("input-not-a-file"),
            Self::OutputNotAFile { .. } => Some("output-not-a-file"),
            _ => None,
        }
    }

    /// Whether the reader was stopped, by whoever asked for the file.
    pub fn is_stopped(&self) -> bool {
        matches!(
            self,
            Self::Variables {
                fault: VariableFault::Stopped,
                ..
            }
        )
    }

    pub(super) fn export(path: &Path, fault: ExportFault) -> Self {
        FileError::Export {
            path: path.to_owned(),
            fault,
        }
    }

    pub(super) fn content(path: &Path, flaw: ContentError) -> Self {
        let ContentError { place, fault } = flaw;
        FileError::Content {
            path: path.to_owned(),
            place,
            fault,
            line: None,
        }
    }

    /// As [`FileError::content`], with the line of the JSON text at which the condition or the model begins.
    pub(super) fn content_of(path: &Path, flaw: ContentError, text: &[u8]) -> Self {
        let ContentError { place, fault } = flaw;
        let line = line_of(text, &place);
        FileError::Content {
            path: path.to_owned(),
            place,
            fault,
            line,
        }
    }
}

fn no_record_words(record: Option<&str>, held: usize) -> String {
    let held = match held {
        0 => "holds no record".to_owned(),
        1 => "holds another record".to_owned(),
        _ => format!("holds {held} records"),
    };
    match record {
        Some(record) => format!("the record {} is not in it; it {held}", quoted(record)),
        None => format!("one record is asked for; it {held}"),
    }
}

fn listed(paths: &[PathBuf]) -> String {
    paths
        .iter()
        .map(|path| sanitized_path(path))
        .collect::<Vec<_>>()
        .join(", ")
}

/// What the system says, without its numbers.
pub fn system_words(error: &std::io::Error) -> String {
    let words = match error.kind() {
        ErrorKind::StorageFull => "the disk is full",
        ErrorKind::QuotaExceeded => "the disk quota is used up",
        ErrorKind::FileTooLarge => "it would be larger than the system allows (ulimit -f)",
        ErrorKind::PermissionDenied => "permission denied",
        ErrorKind::ReadOnlyFilesystem => "the file system is read-only",
        _ => {
            let text = error.to_string();
            return text.split(" (os error").next().unwrap_or(&text).to_owned();
        }
    };
    words.to_owned()
}

// What can be wrong at a place in a file.

/// What is wrong at a place in a file: expected, found, how to mend it.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ContentFault {
    /// Something of another type stands there.
    #[error("expected {expected}, found {found} (line {line}, column {column})")]
    Type {
        /// What has to stand there.
        expected: String,
        /// What stands there.
        found: String,
        /// Line, counted from 1.
        line: usize,
        /// Column in bytes, counted from 1.
        column: usize,
    },
    /// A number is NaN, infinite, or too large for a 64-bit number.
    #[error("expected a finite number, found {found} (line {line}, column {column})")]
    NotFinite {
        /// What stands there.
        found: String,
        /// Line, counted from 1.
        line: usize,
        /// Column in bytes, counted from 1.
        column: usize,
    },
    /// Lists stand inside lists, deeper than any file of this format.
    #[error("lists or objects are nested too deeply (line {line}, column {column})")]
    TooDeep {
        /// Line, counted from 1.
        line: usize,
        /// Column in bytes, counted from 1.
        column: usize,
    },
    /// A key that must be there is not.
    #[error("the key \"{key}\" is missing; add it")]
    MissingKey {
        /// The key.
        key: String,
    },
    /// A key stands twice.
    #[error("the key {} stands twice; remove one", quoted(key))]
    DuplicateKey {
        /// The key.
        key: String,
    },
    /// Any other complaint about the text.
    #[error("{reason} (line {line}, column {column})")]
    Text {
        /// The complaint.
        reason: String,
        /// Line, counted from 1.
        line: usize,
        /// Column in bytes, counted from 1.
        column: usize,
    },
    /// A list has more entries than the program takes.
    #[error("expected at most {most} entries, found {found}")]
    TooMany {
        /// The limit.
        most: usize,
        /// How many there are.
        found: usize,
    },
    /// A text is none of those that may stand there.
    #[error("expected {expected}, found {}", quoted(found))]
    Word {
        /// What may stand there.
        expected: String,
        /// What stands there.
        found: String,
    },
    /// A row of a table of tolerances is wrong.
    #[error(transparent)]
    Tolerance(#[from] ToleranceError),
    /// The ends of the band are wrong.
    #[error(transparent)]
    Band(#[from] BandError),
    /// What the file says is no dataset.
    #[error("{}", sanitized(&.0.to_string()))]
    Dataset(#[from] DraftFault),
    /// A study has a condition twice.
    #[error("condition {id} stands twice; remove one")]
    DuplicateCondition {
        /// The id.
        id: i64,
    },
    /// A study holds a decision that cannot be taken.
    #[error("{}", sanitized(&.0.to_string()))]
    Refused(#[from] EditRefusal),
}

// Something wrong in a file.

/// What is wrong in a file, and where. Boxed, so that results that are mostly right stay small.
#[derive(Debug)]
pub(super) struct ContentError {
    pub(super) place: Box<Location>,
    pub(super) fault: Box<ContentFault>,
}

impl From<DraftError> for ContentError {
    fn from(error: DraftError) -> Self {
        Self {
            place: error.place,
            fault: Box::new((*error.fault).into()),
        }
    }
}

impl ContentError {
    pub(super) fn new(place: Location, fault: impl Into<ContentFault>) -> Self {
        Self {
            place: Box::new(place),
            fault: Box::new(fault.into()),
        }
    }
}
