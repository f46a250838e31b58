//! Stable codes of errors from reading and writing files, and of cautions about records.

use gdcm_io::content_fault::ContentFault;
use gdcm_io::export_fault::ExportFault;
use gdcm_io::file_error::FileError;
use gdcm_study::decisions::edit_refusal::EditRefusal;
use gdcm_sysid::records::layout_problem::{LayoutCaution, LayoutProblem};

use crate::message::Message;

impl From<FileError> for Message {
    fn from(error: FileError) -> Self {
        Self::new(file_error_code(&error), error.to_string())
    }
}

impl From<EditRefusal> for Message {
    fn from(refusal: EditRefusal) -> Self {
        Self::new(refusal.code(), refusal.to_string())
    }
}

/// Returns the stable code of a file error.
pub fn file_error_code(error: &FileError) -> &'static str {
    if let Some(code) = error.code() {
        return code;
    }
    match error {
        FileError::Missing { .. } => "missing-file",
        FileError::Directory { .. } => "directory",
        FileError::Unreadable { .. } => "unreadable-file",
        FileError::TooLarge { .. } => "too-large",
        FileError::Gzip { .. } => "damaged-gzip",
        FileError::GzipCutOff { .. } => "truncated-gzip",
        FileError::CutOff { .. } => "truncated-json",
        FileError::NotJson { .. } => "not-json",
        FileError::Format { .. } => "wrong-format",
        FileError::Version { .. } => "wrong-version",
        FileError::Content { fault, .. } => content_fault_code(fault),
        FileError::Variables { .. } => "unreadable-variables",
        FileError::FolderTooDeep { .. } => "folder-too-deep",
        FileError::NoRecord { .. } => "no-record",
        FileError::TooManyFiles { .. } => "too-many-files",
        FileError::StudyDataset { .. } => "study-dataset",
        FileError::NotADirectory { .. } => "not-a-directory",
        FileError::Exists { .. } => "file-exists",
        FileError::Input { .. } => "input-as-output",
        FileError::FigureFormat { .. } => "figure-format",
        FileError::FigureWithoutNumbers { .. } => "figure-without-numbers",
        FileError::Export { fault, .. } => export_fault_code(fault),
        FileError::Unwritable { .. } => "unwritable-file",
        FileError::NotAFile { .. } | FileError::OutputNotAFile { .. } => "not-a-file",
    }
}

/// Returns the stable code of a fault in the content of a file.
fn content_fault_code(fault: &ContentFault) -> &'static str {
    match fault {
        ContentFault::Type { .. } => "wrong-type",
        ContentFault::NotFinite { .. } => "number-not-finite",
        ContentFault::TooDeep { .. } => "nested-too-deeply",
        ContentFault::MissingKey { .. } => "missing-key",
        ContentFault::DuplicateKey { .. } => "duplicate-key",
        ContentFault::Text { .. } => "wrong-text",
        ContentFault::TooMany { .. } => "too-many-entries",
        ContentFault::Word { .. } => "unknown-word",
        ContentFault::Tolerance(error) => error.code(),
        ContentFault::Band(_) => "wrong-band",
        ContentFault::Dataset(_) => "wrong-dataset",
        ContentFault::DuplicateCondition { .. } => "duplicate-condition",
        ContentFault::Refused(refusal) => refusal.code(),
    }
}

/// Returns the stable code of the reason why an export is impossible.
fn export_fault_code(fault: &ExportFault) -> &'static str {
    match fault {
        ExportFault::Curve { .. } => "curve-not-finite",
        ExportFault::Breakpoints => "wrong-breakpoints",
        ExportFault::FunctionName { .. } => "function-name",
        ExportFault::ModelsFormat => "models-format",
        ExportFault::Variables(_) => "unwritable-variables",
        ExportFault::Schedule(_) => "no-schedule",
        ExportFault::NoCouplings { .. } => "no-couplings",
        ExportFault::NoResult { .. } => "no-result",
        ExportFault::NoCondition { .. } => "unknown-condition",
        ExportFault::NoModel { .. } => "unknown-model",
        ExportFault::NoMatrices { .. } => "no-matrices",
        ExportFault::Model { .. } => "no-corrected-model",
    }
}

/// Returns the stable code of a problem with the columns of a record.
pub fn layout_problem_code(problem: &LayoutProblem) -> &'static str {
    match problem {
        LayoutProblem::NoTime(_) => "no-time",
        LayoutProblem::NoSuchColumn { .. } => "no-such-column",
        LayoutProblem::TimeOrder { .. } => "time-order",
        LayoutProblem::TimeStep { .. } => "time-step",
        LayoutProblem::SampleTime(_) => "wrong-sample-time",
        LayoutProblem::NoColumn { .. } => "no-column",
        LayoutProblem::SeveralColumns { .. } => "several-columns",
        LayoutProblem::Unnamed { .. } => "columns-without-names",
        LayoutProblem::Sign { .. } => "unknown-sign",
        LayoutProblem::UnsaidUnit { .. } => "unknown-unit",
        LayoutProblem::Conversion { .. } => "no-conversion",
        LayoutProblem::OneColumn { .. } => "shared-column",
        LayoutProblem::Empty { .. } => "empty-column",
        LayoutProblem::Factor { .. } => "wrong-factor",
        LayoutProblem::Delay { .. } => "wrong-delay",
        LayoutProblem::Magnitude { .. } => "implausible-magnitude",
        LayoutProblem::Topics(_) => "topics-not-combined",
    }
}

/// Returns the stable code of a caution about the columns of a record.
pub fn layout_caution_code(caution: &LayoutCaution) -> &'static str {
    match caution {
        LayoutCaution::Constant { .. } => "constant-channel",
        LayoutCaution::Same { .. } => "equal-channels",
        LayoutCaution::Copy { .. } => "duplicate",
        LayoutCaution::Missing { .. } => "missing-samples",
        LayoutCaution::MissingTime { .. } => "missing-time",
    }
}
