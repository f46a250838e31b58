//! Why a command was not carried out, and the exit status that says so.

use std::path::PathBuf;

use gdcm_core::message_text::sanitized_path;
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
    /// A file of models, where a dataset or a study is asked for.
    #[error(
        "{path}: this is neither a dataset nor a study; a dataset is made of model files by gdcm assemble {path} --out \
         dataset.json.gz, or in the window by Import models"
    )]
    Models { path: String },
    /// Something is still to be said before files are a dataset.
    #[error("no dataset was made: {count} {} to complete; do so in {rules} and give it with --rules", if *count == 1 { "item" } else { "items" })]
    Incomplete { count: usize, rules: String },
    /// Records whose columns are not clear, or cannot be what they are taken for; each was told.
    #[error("{wrong} of {of} {} cannot be taken as they are: say which column is which (--inputs P=COLUMN, --time) and in which unit (--unit P=deg/s), or leave them out", if *of == 1 { "record" } else { "records" })]
    Records { wrong: usize, of: usize },
    /// Files of which nothing could be taken.
    #[error("{paths}: no {what} that could be taken")]
    Nothing { paths: String, what: &'static str },
    /// Records that were asked for by name could not be read, or not all that is in them; what could was used.
    #[error("{paths}: not read, or not all of it; what was made is without that")]
    Unread { paths: String },
    /// What was asked for was identified, and nothing of it is of use.
    #[error("no input is identified in these records: the models say nothing of {inputs}")]
    NotIdentified { inputs: String },
    /// No thread is to be had.
    #[error("no thread is to be had to compute with: {reason}")]
    NoThreads { reason: String },
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
    /// Nothing could be taken of files.
    pub(super) fn nothing_in(paths: &[PathBuf], what: &'static str) -> Self {
        Failure::Nothing { paths: listed_paths(paths), what }
    }

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
            | Failure::Unread { .. }
            | Failure::NotIdentified { .. }
            | Failure::NoThreads { .. }
            | Failure::Cancelled(_)
            | Failure::StandardOutput { .. } => NOT_DONE,
            Failure::File(FileError::Export { fault, .. }) if fault.is_of_analysis() => NOT_DONE,
            Failure::File(_)
            | Failure::Option { .. }
            | Failure::Different { .. }
            | Failure::Incomplete { .. }
            | Failure::Records { .. }
            | Failure::Nothing { .. }
            | Failure::Models { .. }
            | Failure::Faulty { .. } => WRONG_INPUT,
        }
    }
}

/// Paths with commas.
pub(super) fn listed_paths(paths: &[PathBuf]) -> String {
    paths.iter().map(|path| sanitized_path(path)).collect::<Vec<_>>().join(", ")
}
