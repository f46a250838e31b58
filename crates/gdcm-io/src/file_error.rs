//! Reasons why a file could not be read or written.

use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use gdcm_model::dataset::location::Location;
use gdcm_model::message_text::{quoted, sanitized, sanitized_path};

use crate::content_fault::{ContentError, ContentFault};
use crate::export_fault::ExportFault;
use crate::json_location::line_of;
use crate::reading_budget::VariableFault;

/// Reason why a file could not be read or written; the message names the file and the place in it.
#[derive(Debug, thiserror::Error)]
pub enum FileError {
    #[error("{}: there is no such file", sanitized_path(path))]
    Missing { path: PathBuf },
    #[error(
        "{}: this is a directory; give the name of a file",
        sanitized_path(path)
    )]
    Directory { path: PathBuf },
    /// The path is neither a file nor a directory; reading it might never end.
    #[error(
        "{}: this is {kind}, not a file; save its content as a file, and give the name of that file",
        sanitized_path(path)
    )]
    NotAFile { path: PathBuf, kind: &'static str },
    /// The output path is a named pipe, a socket or a device.
    #[error(
        "{}: this is {kind}, not a file, so nothing is written to it; give the name of a file",
        sanitized_path(path)
    )]
    OutputNotAFile { path: PathBuf, kind: &'static str },
    /// The system does not permit reading the file, or fails to read it.
    #[error("{}: cannot be read: {reason}", sanitized_path(path))]
    Unreadable { path: PathBuf, reason: String },
    /// The size of the file, or of its uncompressed content, exceeds the limit.
    #[error(
        "{}: exceeds {most_mib} MiB, the limit for a file; split the file",
        sanitized_path(path)
    )]
    TooLarge { path: PathBuf, most_mib: u64 },
    #[error(
        "{}: the gzip data are damaged; compress or copy the file again",
        sanitized_path(path)
    )]
    Gzip { path: PathBuf },
    #[error(
        "{}: the gzip data end too early: the file is truncated; copy it again",
        sanitized_path(path)
    )]
    GzipCutOff { path: PathBuf },
    /// The text ends within a JSON value.
    #[error("{}: {}the JSON ends too early (line {line}, column {column}): the file is truncated; \
        copy it again", sanitized_path(path), place.before())]
    CutOff {
        path: PathBuf,
        /// Place in the content that the reader had reached.
        place: Box<Location>,
        /// Line, counted from 1.
        line: usize,
        /// Column in bytes, counted from 1.
        column: usize,
    },
    #[error("{}: {}this is not JSON (line {line}, column {column}: {reason}); correct it", sanitized_path(path), place.before())]
    NotJson {
        path: PathBuf,
        /// Place in the content that the reader had reached.
        place: Box<Location>,
        /// Line, counted from 1.
        line: usize,
        /// Column in bytes, counted from 1.
        column: usize,
        reason: String,
    },
    /// The file states a format other than expected.
    #[error(
        "{}: expected \"format\": \"{expected}\", found {found}; give a file of this format",
        sanitized_path(path)
    )]
    Format {
        path: PathBuf,
        /// Permitted format names.
        expected: &'static str,
        /// Stated format, as displayed in the message.
        found: String,
    },
    /// The file states a version that this program does not read.
    #[error(
        "{}: expected version {newest} of {format}, found {found}; {}",
        sanitized_path(path),
        version_remedy(*newest, found)
    )]
    Version {
        path: PathBuf,
        format: &'static str,
        /// Newest version that this program reads.
        newest: u64,
        /// Stated version, as displayed in the message.
        found: String,
    },
    /// The file has the expected format, but an invalid entry.
    #[error("{}: {}{fault}{}", sanitized_path(path), place.before(), line_words(*line))]
    Content {
        path: PathBuf,
        place: Box<Location>,
        fault: Box<ContentFault>,
        /// Line at which the condition or the model begins, counted from 1; `None` if it is
        /// unknown, or if the fault itself contains a line number.
        line: Option<usize>,
    },
    /// A file's contents cannot be read as variables, tables or logs, or variables cannot be
    /// written; also an exceeded limit or a cancellation in any reader.
    #[error("{}: {}", sanitized_path(path), variables_words(path, fault))]
    Variables { path: PathBuf, fault: VariableFault },
    /// Folders are nested more deeply than the search for files descends.
    #[error(
        "{}: too many folder levels below the given folder; give a folder nearer to this one",
        sanitized_path(path)
    )]
    FolderTooDeep { path: PathBuf },
    #[error("{}: {}", sanitized_path(path), no_record_words(record.as_deref(), *record_count))]
    NoRecord {
        path: PathBuf,
        /// Name of the requested record; `None` if the file should contain a single record.
        record: Option<String>,
        /// Number of records in the file.
        record_count: usize,
    },
    #[error(
        "{}: contains more than {most} files; give a folder with fewer files",
        sanitized_path(path)
    )]
    TooManyFiles { path: PathBuf, most: usize },
    /// The study's dataset cannot be read.
    #[error(
        "{}: the study's dataset cannot be opened: {dataset}; give its current path with --dataset",
        sanitized_path(path)
    )]
    StudyDataset {
        path: PathBuf,
        /// Reason, with the dataset's path.
        dataset: Box<FileError>,
    },
    /// A directory cannot be created because a file has its name.
    #[error(
        "{}: this directory cannot be created, because a file has its name; choose another directory",
        sanitized_path(path)
    )]
    NotADirectory { path: PathBuf },
    /// Output files exist, and replacing them was not requested.
    #[error("{}", existing_words(paths))]
    Exists { paths: Vec<PathBuf> },
    /// The output file is also read as an input.
    #[error(
        "{}: the data are read from this file, so it is not overwritten; choose another name or \
        directory",
        sanitized_path(path)
    )]
    Input { path: PathBuf },
    /// The file extension does not belong to a format for figures.
    #[error(
        "{}: the file name of a figure must end in .svg, .png, .pdf or .csv",
        sanitized_path(path)
    )]
    FigureFormat { path: PathBuf },
    /// A figure without values was to be written as CSV.
    #[error(
        "{}: \"{}\" has no values to write: none of the requested responses or channels has a \
        result; request others, or use .svg",
        sanitized_path(path),
        sanitized(title)
    )]
    FigureWithoutNumbers { path: PathBuf, title: String },
    #[error("{}: {}", sanitized_path(path), sanitized(&.fault.to_string()))]
    Export { path: PathBuf, fault: ExportFault },
    /// The file could not be written; an existing file is unchanged.
    #[error("{}: cannot be written: {reason}", sanitized_path(path))]
    Unwritable { path: PathBuf, reason: String },
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

    /// Creates the error for variables that cannot be read or written.
    pub(super) fn variables(path: &Path, fault: VariableFault) -> Self {
        FileError::Variables {
            path: path.to_owned(),
            fault,
        }
    }

    /// Returns the stable code by which scripts and tests distinguish errors.
    pub fn code(&self) -> &'static str {
        match self {
            Self::Missing { .. } => "missing-file",
            Self::Directory { .. } => "input-is-a-directory",
            Self::NotAFile { .. } => "input-not-a-file",
            Self::OutputNotAFile { .. } => "output-not-a-file",
            Self::Unreadable { .. } => "unreadable-file",
            Self::TooLarge { .. } => "file-too-large",
            Self::Gzip { .. } => "damaged-gzip",
            Self::GzipCutOff { .. } => "gzip-cut-off",
            Self::CutOff { .. } => "json-cut-off",
            Self::NotJson { .. } => "not-json",
            Self::Format { .. } => "other-format",
            Self::Version { .. } => "other-version",
            Self::Content { fault, .. } => fault.code(),
            Self::Variables { fault, .. } => fault.code(),
            Self::FolderTooDeep { .. } => "folder-too-deep",
            Self::NoRecord { .. } => "no-such-record",
            Self::TooManyFiles { .. } => "too-many-files",
            Self::StudyDataset { .. } => "dataset-of-study",
            Self::NotADirectory { .. } => "output-directory-is-a-file",
            Self::Exists { .. } => "output-exists",
            Self::Input { .. } => "output-is-an-input",
            Self::FigureFormat { .. } => "figure-format",
            Self::FigureWithoutNumbers { .. } => "figure-without-numbers",
            Self::Export { fault, .. } => fault.code(),
            Self::Unwritable { .. } => "not-writable",
        }
    }

    /// Returns the path that cannot be read or written; with several, the first.
    pub fn path(&self) -> Option<&Path> {
        match self {
            Self::Missing { path }
            | Self::Directory { path }
            | Self::NotAFile { path, .. }
            | Self::OutputNotAFile { path, .. }
            | Self::Unreadable { path, .. }
            | Self::TooLarge { path, .. }
            | Self::Gzip { path }
            | Self::GzipCutOff { path }
            | Self::CutOff { path, .. }
            | Self::NotJson { path, .. }
            | Self::Format { path, .. }
            | Self::Version { path, .. }
            | Self::Content { path, .. }
            | Self::Variables { path, .. }
            | Self::FolderTooDeep { path }
            | Self::NoRecord { path, .. }
            | Self::TooManyFiles { path, .. }
            | Self::StudyDataset { path, .. }
            | Self::NotADirectory { path }
            | Self::Input { path }
            | Self::FigureFormat { path }
            | Self::FigureWithoutNumbers { path, .. }
            | Self::Export { path, .. }
            | Self::Unwritable { path, .. } => Some(path),
            Self::Exists { paths } => paths.first().map(PathBuf::as_path),
        }
    }

    /// Returns the line with the fault, or at which the faulty condition or model begins, counted
    /// from 1. `None` if it is unknown, and if an invalid entry's fault contains its own line.
    pub fn line(&self) -> Option<usize> {
        match self {
            Self::CutOff { line, .. } | Self::NotJson { line, .. } => Some(*line),
            Self::Content { line, .. } => *line,
            _ => None,
        }
    }

    /// Returns the place within the file content; `None` if the error concerns the whole file.
    pub fn place(&self) -> Option<&Location> {
        match self {
            Self::CutOff { place, .. }
            | Self::NotJson { place, .. }
            | Self::Content { place, .. } => Some(place),
            _ => None,
        }
    }

    /// Returns whether reading was stopped at the caller's request.
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

    /// Creates the error for an invalid entry, without a line number.
    pub(super) fn content(path: &Path, error: ContentError) -> Self {
        FileError::Content {
            path: path.to_owned(),
            place: error.place,
            fault: error.fault,
            line: None,
        }
    }

    /// Creates the same error as [`FileError::content`], and adds the line at which the condition
    /// or the model begins in the JSON text.
    pub(super) fn content_with_line(path: &Path, error: ContentError, text: &[u8]) -> Self {
        FileError::Content {
            path: path.to_owned(),
            line: line_of(text, &error.place),
            place: error.place,
            fault: error.fault,
        }
    }
}

/// Returns the message for a fault; its remedy mentions the file name.
fn variables_words(path: &Path, fault: &VariableFault) -> String {
    let file = file_name(path);
    let stem = file_name(&path.with_extension(""));
    sanitized(&fault.words_for_file(&file, &stem))
}

fn file_name(path: &Path) -> String {
    sanitized(&path.file_name().unwrap_or_default().to_string_lossy())
}

/// Returns the remedy for a version that this program does not read: a later version needs a newer
/// program, any other entry is wrong.
fn version_remedy(newest: u64, found: &str) -> &'static str {
    match found.parse::<f64>() {
        Ok(version) if version > newest as f64 => "a newer gdcm may be able to read it",
        _ => "correct the version",
    }
}

fn line_words(line: Option<usize>) -> String {
    match line {
        Some(line) => format!(" (line {line})"),
        None => String::new(),
    }
}

fn no_record_words(record: Option<&str>, count: usize) -> String {
    let contents = match count {
        0 => "contains no records".to_owned(),
        1 => "contains only another record".to_owned(),
        _ => format!("contains {count} records"),
    };
    match record {
        Some(record) => {
            let key = if count == 0 { "file" } else { "variable" };
            format!(
                "the record {} is not in this file, which {contents}; correct \"{key}\" of the \
                record in the dataset",
                quoted(record)
            )
        }
        None if count < 2 => "the file contains no records; correct \"file\" of the record in the \
            dataset"
            .to_owned(),
        None => format!(
            "a single record is required, but the file {contents}; name one as \"variable\" of the record \
            in the dataset"
        ),
    }
}

fn existing_words(paths: &[PathBuf]) -> String {
    let listed: Vec<String> = paths.iter().map(|path| sanitized_path(path)).collect();
    let verb = if paths.len() == 1 { "exists" } else { "exist" };
    format!("{} {verb} already", listed.join(", "))
}

/// Describes an error from the operating system: common causes, such as a full disk, in this
/// program's words; else the system's message without the error number.
pub fn system_words(error: &std::io::Error) -> String {
    let words = match error.kind() {
        ErrorKind::StorageFull => "the disk is full",
        ErrorKind::QuotaExceeded => "the disk quota is exceeded",
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
