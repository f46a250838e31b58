//! Stable codes for problems and cautions about record columns, and messages from file errors and
//! refused decisions, which have codes of their own.

use gdcm_io::file_error::FileError;
use gdcm_study::decisions::edit_refusal::EditRefusal;
use gdcm_sysid::records::layout_problem::{LayoutCaution, LayoutProblem};

use crate::message::Message;

impl From<FileError> for Message {
    fn from(error: FileError) -> Self {
        Self::new(error.code(), error.to_string())
    }
}

impl From<EditRefusal> for Message {
    fn from(refusal: EditRefusal) -> Self {
        Self::new(refusal.code(), refusal.to_string())
    }
}

/// Returns the stable code for a problem with a record's columns.
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
        LayoutProblem::UnitNotGiven { .. } => "unknown-unit",
        LayoutProblem::Conversion { .. } => "no-conversion",
        LayoutProblem::OneColumn { .. } => "shared-column",
        LayoutProblem::Empty { .. } => "empty-column",
        LayoutProblem::Factor { .. } => "wrong-factor",
        LayoutProblem::Delay { .. } => "wrong-delay",
        LayoutProblem::Magnitude { .. } => "implausible-magnitude",
        LayoutProblem::Topics(_) => "topics-not-combined",
    }
}

/// Returns the stable code for a caution about a record's columns.
pub fn layout_caution_code(caution: &LayoutCaution) -> &'static str {
    match caution {
        LayoutCaution::Constant { .. } => "constant-channel",
        LayoutCaution::Same { .. } => "equal-channels",
        LayoutCaution::Copy { .. } => "duplicate",
        LayoutCaution::Missing { .. } => "missing-samples",
        LayoutCaution::MissingTime { .. } => "missing-time",
        LayoutCaution::UnitAssumed { .. } => "unit-assumed",
    }
}
