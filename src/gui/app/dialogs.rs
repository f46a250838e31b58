//! Dialogs and questions that wait for the engineer's answer.

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

/// Open desktop dialog, and actions postponed until the engineer answers a question.
pub(super) struct Dialogs {
    /// Whether a desktop dialog is open; there is at most one.
    pub(super) dialog_open: bool,
    /// Action postponed until the engineer confirms that unsaved decisions may be lost.
    pub(super) postponed: Option<PendingAction>,
    /// Whether the postponed action is carried out once the study is saved.
    pub(super) goes_on_once_saved: bool,
    /// Command postponed until the engineer confirms that files may be overwritten.
    pub(super) overwriting: Option<Command>,
    /// Treatment of existing files: replaced only during a command for which the engineer has
    /// confirmed it.
    pub(super) existing: Existing,
    /// Whether the window is closing: the engineer has already been asked about unsaved decisions.
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
