//! Command failures, with their codes and exit statuses.

use std::path::PathBuf;

use gdcm_io::FileError;
use gdcm_io::export_fault::ExportFault;
use gdcm_model::number_format::counted;
use gdcm_model::progress::Cancelled;
use gdcm_sysid::records::record_table::shortened_list;

use super::printed_lines::listed_paths;

/// Exit status if the command produced no complete result.
pub(super) const NOT_DONE: u8 = 1;
/// Exit status if the command line or an input file is wrong.
pub(super) const WRONG_INPUT: u8 = 2;

/// Reason why a command failed, in some cases after it has written its files.
#[derive(Debug, thiserror::Error)]
pub(super) enum Failure {
    #[error("{0}{remedy}", remedy = file_remedy(.0))]
    File(#[from] FileError),
    /// An export, such as a corrected model, is impossible.
    #[error(transparent)]
    Export(#[from] ExportFault),
    /// A call's options cannot be read.
    #[error("{words}")]
    CommandLine { words: String },
    #[error("{option}: {reason}")]
    Option {
        option: &'static str,
        code: &'static str,
        reason: String,
    },
    /// The first argument is neither a command nor a file, but resembles a command.
    #[error("{found}: no such command or file; did you mean gdcm {suggestion}?")]
    UnknownCommand { found: String, suggestion: String },
    /// The dataset has changed since the study was saved, and `--strict` was given.
    #[error("{path}: {} from the dataset of the study, not accepted with --strict", counted(*count, "difference"))]
    Different { path: String, count: usize },
    /// Several faults in a dataset, each of which has already been reported.
    #[error("{path}: {count} faults; correct them and check the file again")]
    Faulty { path: String, count: usize },
    /// The file contains models, but neither a dataset nor a study.
    #[error(
        "{path}: neither a dataset nor a study; make a dataset of model files with gdcm assemble \
         {path} --out dataset.json.gz, or with Import models in the window"
    )]
    Models { path: String },
    /// The rules lack items, so no dataset can be made from the files.
    #[error("no dataset was written: complete {} in {rules}, and pass the rules with --rules", counted(*count, "item"))]
    Incomplete { count: usize, rules: String },
    /// Some records' columns are unclear or invalid, which has already been reported for each
    /// record.
    #[error(
        "{wrong} of {} cannot be used: give their columns (--inputs P=COLUMN, --time) and units \
         (--unit P=deg/s), or leave them out",
        counted(*count, "record")
    )]
    Records { wrong: usize, count: usize },
    /// The files have no usable content.
    #[error("{paths}: no usable {noun}")]
    Nothing { paths: String, noun: &'static str },
    /// Some requested records could not be read completely; the others were used.
    #[error("{paths}: not read, or read only in part; the results do not include the missing data")]
    Unread { paths: String },
    /// Identification was completed, but the records identify no input.
    #[error(
        "no input can be identified from the records: the models do not describe the responses to \
        {inputs}; add records with sweeps of these inputs"
    )]
    NotIdentified { inputs: String },
    #[error("no thread can be started: {reason}")]
    NoThreads { reason: String },
    /// No model was identified, or the identified models cannot be added to the dataset.
    #[error("{reason}")]
    NoModels { reason: String },
    #[error("no flight can be planned: {reason}")]
    NoPlan { reason: String },
    #[error("no result: {reason}")]
    NoResult { reason: String },
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
    /// The program does not compute what independent code computed.
    #[error("{failed} of {} failed: do not use results of this program on this machine", counted(*count, "comparison"))]
    Deviating { failed: usize, count: usize },
    #[error("standard output cannot be written: {reason}")]
    StandardOutput { reason: String },
}

/// Returns a hint for a file error's message: the option that solves the problem.
fn file_remedy(error: &FileError) -> &'static str {
    match error {
        FileError::Exists { .. } => "; --force overwrites",
        _ => "",
    }
}

impl Failure {
    /// Returns the failure for files without any usable `noun`.
    pub(super) fn nothing_in(paths: &[PathBuf], noun: &'static str) -> Self {
        Failure::Nothing {
            paths: listed_paths(paths),
            noun,
        }
    }

    /// Returns the failure for an invalid option value.
    pub(super) fn option(option: &'static str, reason: impl ToString) -> Self {
        Self::coded_option(option, "wrong-option", reason)
    }

    /// Returns the failure for an invalid option value, with a specific code.
    pub(super) fn coded_option(
        option: &'static str,
        code: &'static str,
        reason: impl ToString,
    ) -> Self {
        Failure::Option {
            option,
            code,
            reason: reason.to_string(),
        }
    }

    /// Returns the failure for an option that is given twice for the same subject.
    pub(super) fn given_twice(option: &'static str, subject: &str) -> Self {
        Self::coded_option(option, "given-twice", format!("{subject} is given twice"))
    }

    /// Returns the failure for an option that names an unknown record.
    pub(super) fn unknown_record(option: &'static str, record: &str, names: &[&str]) -> Self {
        let reason = format!(
            "no record is called \"{record}\"; records are {}",
            shortened_list(names)
        );
        Self::coded_option(option, "unknown-record", reason)
    }

    /// Returns the stable code for scripts.
    pub(super) fn code(&self) -> &'static str {
        match self {
            Failure::File(error) => error.code(),
            Failure::Export(fault) => fault.code(),
            Failure::CommandLine { .. } => "wrong-command-line",
            Failure::Option { code, .. } => code,
            Failure::UnknownCommand { .. } => "unknown-command",
            Failure::Different { .. } => "different-dataset",
            Failure::Faulty { .. } => "faulty-dataset",
            Failure::Models { .. } => "model-file",
            Failure::Incomplete { .. } => "incomplete-rules",
            Failure::Records { .. } => "unclear-records",
            Failure::Nothing { .. } => "nothing-found",
            Failure::Unread { .. } => "not-read",
            Failure::NotIdentified { .. } => "nothing-identified",
            Failure::NoThreads { .. } => "no-threads",
            Failure::NoModels { .. } => "no-models",
            Failure::NoPlan { .. } => "no-plan",
            Failure::NoResult { .. } => "no-result",
            Failure::Cancelled(_) => "stopped",
            Failure::Deviating { .. } => "verification-failed",
            Failure::StandardOutput { .. } => "standard-output",
        }
    }

    /// Returns the program's exit status.
    pub(super) fn status(&self) -> u8 {
        match self {
            Failure::File(FileError::Unwritable { .. })
            | Failure::NoResult { .. }
            | Failure::NoModels { .. }
            | Failure::NoPlan { .. }
            | Failure::Unread { .. }
            | Failure::NotIdentified { .. }
            | Failure::NoThreads { .. }
            | Failure::Cancelled(_)
            | Failure::Deviating { .. }
            | Failure::StandardOutput { .. } => NOT_DONE,
            // An analysis without a result is no wrong input.
            Failure::File(FileError::Export { fault, .. }) | Failure::Export(fault)
                if fault.is_of_analysis() =>
            {
                NOT_DONE
            }
            Failure::File(_)
            | Failure::Export(_)
            | Failure::CommandLine { .. }
            | Failure::Option { .. }
            | Failure::UnknownCommand { .. }
            | Failure::Different { .. }
            | Failure::Incomplete { .. }
            | Failure::Records { .. }
            | Failure::Nothing { .. }
            | Failure::Models { .. }
            | Failure::Faulty { .. } => WRONG_INPUT,
        }
    }
}
