//! Content faults in the program's own files, each with its place in the file.
//!
//! A content fault is an entry that is wrong in a file of the expected format, such as a
//! missing key or a number of another type. Its place, a [`Location`], names the condition, the
//! model and the entry. A fault does not contain the file path;
//! [`FileError`](crate::file_error::FileError) adds it.

use gdcm_method::requirements::tolerance_check::ToleranceError;
use gdcm_model::dataset::band::BandError;
use gdcm_model::dataset::draft_fault::{DraftError, DraftFault};
use gdcm_model::dataset::location::Location;
use gdcm_model::message_text::{quoted, sanitized};
use gdcm_study::decisions::edit_refusal::EditRefusal;

/// Fault in an entry of a file; most messages state the expected and the actual content.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ContentFault {
    #[error("expected {expected}, found {found} (line {line}, column {column})")]
    Type {
        expected: String,
        found: String,
        /// Line, counted from 1.
        line: usize,
        /// Column in bytes, counted from 1.
        column: usize,
    },
    /// A number is NaN, infinite, or too large for a 64-bit float.
    #[error("expected a finite number, found {found} (line {line}, column {column})")]
    NotFinite {
        found: String,
        /// Line, counted from 1.
        line: usize,
        /// Column in bytes, counted from 1.
        column: usize,
    },
    #[error(
        "lists or objects are nested too deeply; check the brackets (line {line}, column {column})"
    )]
    TooDeep {
        /// Line, counted from 1.
        line: usize,
        /// Column in bytes, counted from 1.
        column: usize,
    },
    #[error("the key \"{key}\" is missing; add it")]
    MissingKey { key: String },
    #[error("duplicate key {}; remove one", quoted(key))]
    DuplicateKey { key: String },
    /// Lists of numbers that must be equally long have different lengths.
    #[error(
        "expected {expected} entries, as in the first of these lists, found {found} (line {line}, \
        column {column})"
    )]
    ListLength {
        expected: usize,
        found: usize,
        /// Line, counted from 1.
        line: usize,
        /// Column in bytes, counted from 1.
        column: usize,
    },
    /// A list has more entries than permitted; reading ended at the first surplus entry.
    #[error("expected at most {most} entries, found more (line {line}, column {column})")]
    TooLong {
        most: usize,
        /// Line, counted from 1.
        line: usize,
        /// Column in bytes, counted from 1.
        column: usize,
    },
    /// Any other fault in the text.
    #[error("{reason} (line {line}, column {column})")]
    Text {
        reason: String,
        /// Line, counted from 1.
        line: usize,
        /// Column in bytes, counted from 1.
        column: usize,
    },
    /// A list has more entries than permitted.
    #[error("expected at most {most} entries, found {found}")]
    TooMany {
        most: usize,
        /// Number of entries in the list.
        found: usize,
    },
    /// A string is not one of the permitted words.
    #[error("expected {expected}, found {}", quoted(found))]
    Word {
        /// Permitted words, as displayed in the message.
        expected: String,
        found: String,
    },
    /// A row in a tolerance table is invalid.
    #[error(transparent)]
    Tolerance(#[from] ToleranceError),
    #[error(transparent)]
    Band(#[from] BandError),
    /// The content is not a valid dataset.
    #[error("{}", sanitized(&.0.to_string()))]
    Dataset(#[from] DraftFault),
    /// A study contains a condition twice.
    #[error("duplicate condition {id}; remove one")]
    DuplicateCondition { id: i64 },
    /// A study contains an invalid decision.
    #[error("{}", sanitized(&.0.to_string()))]
    Refused(#[from] EditRefusal),
}

impl ContentFault {
    /// Returns the stable code by which scripts and tests distinguish faults.
    pub fn code(&self) -> &'static str {
        match self {
            Self::Type { .. } => "wrong-type",
            Self::NotFinite { .. } => "number-not-finite",
            Self::TooDeep { .. } => "values-too-deep",
            Self::MissingKey { .. } => "missing-key",
            Self::DuplicateKey { .. } => "duplicate-key",
            Self::ListLength { .. } => "list-length",
            Self::Text { .. } => "invalid-entry",
            Self::TooLong { .. } | Self::TooMany { .. } => "too-many-entries",
            Self::Word { .. } => "unknown-word",
            Self::Tolerance(error) => error.code(),
            Self::Band(error) => error.code(),
            Self::Dataset(fault) => fault.code(),
            Self::DuplicateCondition { .. } => "duplicate-condition",
            Self::Refused(refusal) => refusal.code(),
        }
    }
}

/// A fault in a file, with its place. Both are boxed to keep `Result`s small.
#[derive(Debug)]
pub(super) struct ContentError {
    pub(super) place: Box<Location>,
    pub(super) fault: Box<ContentFault>,
}

impl ContentError {
    pub(super) fn new(place: Location, fault: impl Into<ContentFault>) -> Self {
        Self {
            place: Box::new(place),
            fault: Box::new(fault.into()),
        }
    }
}

impl From<DraftError> for ContentError {
    fn from(error: DraftError) -> Self {
        Self {
            place: error.place,
            fault: Box::new((*error.fault).into()),
        }
    }
}
