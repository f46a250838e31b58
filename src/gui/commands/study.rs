//! Commands about decisions.

use gdcm_study::Edit;

/// A decision about the study, or a step through the decision history.
#[derive(Clone, Debug, PartialEq)]
pub enum StudyCommand {
    /// Takes a decision about the study.
    Edit(Edit),
    /// Reports that a setting is being dragged; long computations wait until `EndEdit`.
    DragEdit,
    /// Completes the current decision, for example when a slider is released.
    EndEdit,
    Undo,
    Redo,
    /// Undoes a decision if it is the last, and removes it from the history.
    Forget(Edit),
}
