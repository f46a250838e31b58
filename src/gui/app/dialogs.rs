//! Questions that wait for an answer.

use gdcm_io::{Existing, Opened};

use super::document_files::ReadFor;
use crate::gui::commands::command::Command;
use crate::gui::state::forms::RequirementTable;

/// Purpose for which a file dialog is open.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum DialogPurpose {
    Open,
    SaveStudy,
    ExportFolder,
    ModelFolder,
    RecordFolder,
    RequirementTable(RequirementTable),
}

/// Action postponed until the engineer confirms that unsaved decisions may be lost.
#[derive(Debug)]
pub(super) enum PendingAction {
    /// Shows a file that was read successfully.
    Show(ReadFor, Box<Opened>),
    /// Returns to the start page and closes everything that is open.
    Close,
    Quit,
}

/// Open desktop dialog, and actions that wait for the engineer's answer.
pub(super) struct Dialogs {
    pub(super) dialog_open: bool,
    /// Action waiting for the answer whether unsaved decisions may be lost.
    pub(super) postponed: Option<PendingAction>,
    /// Whether the postponed action is carried out after saving.
    pub(super) goes_on_once_saved: bool,
    /// Command waiting for the answer whether to overwrite files.
    pub(super) overwriting: Option<Command>,
    /// Treatment of existing files: they are replaced only during the command that the engineer
    /// confirmed.
    pub(super) existing: Existing,
    pub(super) closing: bool,
}

impl Dialogs {
    /// Creates the state without an open dialog and without a waiting action.
    pub(super) fn new() -> Self {
        Self {
            dialog_open: false,
            postponed: None,
            goes_on_once_saved: false,
            overwriting: None,
            existing: Existing::Keep,
            closing: false,
        }
    }
}
