//! Commands about decisions.

use gdcm_study::Edit;

/// A decision about the study, or a step through the history of decisions.
#[derive(Clone, Debug, PartialEq)]
pub enum StudyCommand {
    /// Takes a decision about the study.
    Edit(Edit),
    /// Completes the current decision, for example when a slider is released.
    EndEdit,
    Undo,
    /// Removes a decision from the history if it is the last.
    Forget(Edit),
    Redo,
}
