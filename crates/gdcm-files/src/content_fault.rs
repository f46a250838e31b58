//! What can be wrong at a place in a file.

use gdcm_core::dataset::{BandError, DraftFault};
use gdcm_core::study::EditRefusal;

use gdcm_core::message_text::{quoted, sanitized};

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
