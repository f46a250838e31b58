//! Why a command was not carried out, and the exit status that says so.

use gdcm_core::study::{Cancelled, EditRefusal};
use gdcm_files::FileError;

/// Exit status where the analysis could not be done.
pub(super) const NOT_DONE: u8 = 1;
/// Exit status where the command line or a file is wrong.
pub(super) const WRONG_INPUT: u8 = 2;

/// Why a command was not carried out.
#[derive(Debug, thiserror::Error)]
pub(super) enum Failure {
    /// A file cannot be read or written.
    #[error("{0}{remedy}", remedy = if matches!(.0, FileError::Exists { .. }) { "; --force overwrites" } else { "" })]
    File(#[from] FileError),
    /// An option's value is wrong for this dataset.
    #[error("{option}: {reason}")]
    Option { option: &'static str, reason: String },
    /// The dataset of a study is not the one that it was made with.
    #[error("{path}: {count} differences from what the study was made with, and --strict asks for none")]
    Different { path: String, count: usize },
    /// A dataset has several faults, which were told.
    #[error("{path}: {count} faults; once they are mended, check the file again")]
    Faulty { path: String, count: usize },
    /// Something is still to be said before files are a dataset.
    #[error("no dataset was made: {count} {} to complete; do so in {rules} and give it with --rules", if *count == 1 { "item" } else { "items" })]
    Incomplete { count: usize, rules: String },
    /// Records whose columns are not clear, or cannot be what they are taken for; each was told.
    #[error("{wrong} of {of} {} cannot be taken as they are: say which column is which (--inputs P=COLUMN, --time), or leave them out", if *of == 1 { "record" } else { "records" })]
    Records { wrong: usize, of: usize },
    /// No model was identified.
    #[error("no model was identified: {reason}")]
    NoModels { reason: String },
    /// No condition has a result.
    #[error("the analysis has no result: {reason}")]
    NoResult { reason: String },
    /// The analysis was stopped.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
    /// Standard output cannot be written.
    #[error("standard output cannot be written: {reason}")]
    StandardOutput { reason: String },
}

impl Failure {
    /// A decision that an option asks for was refused.
    pub(super) fn refused(option: &'static str) -> impl Fn(EditRefusal) -> Self {
        move |refusal| Failure::Option { option, reason: refusal.to_string() }
    }

    /// The exit status.
    pub(super) fn status(&self) -> u8 {
        match self {
            Failure::File(FileError::Unwritable { .. })
            | Failure::NoResult { .. }
            | Failure::NoModels { .. }
            | Failure::Cancelled(_)
            | Failure::StandardOutput { .. } => NOT_DONE,
            Failure::File(FileError::Export { fault, .. }) if fault.is_of_analysis() => NOT_DONE,
            Failure::File(_)
            | Failure::Option { .. }
            | Failure::Different { .. }
            | Failure::Incomplete { .. }
            | Failure::Records { .. }
            | Failure::Faulty { .. } => WRONG_INPUT,
        }
    }
}
