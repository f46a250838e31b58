//! Actions that wait for the engineer's consent.
//!
//! An action that would lose unsaved decisions waits for the form `Unsaved`
//! ([`GdcmApp::ask_to_lose`]), which offers to save first, to go on, or to cancel. A command that
//! would overwrite files waits for the question in its own form ([`GdcmApp::ask_to_overwrite`]); if
//! confirmed, the command is repeated with permission to replace them. Opening another form forgets
//! both, except that the form Save keeps an action that continues after saving.

use std::path::PathBuf;

use gdcm_io::{Existing, Opened};
use gdcm_model::message_text::sanitized_path;

use super::GdcmApp;
use super::document_files::ReadFor;
use crate::gui::commands::command::Command;
use crate::gui::state::forms::FormKind;

/// Action that would lose unsaved decisions.
#[derive(Debug)]
pub(super) enum PendingAction {
    /// Shows a file that was read successfully.
    Show(ReadFor, Box<Opened>),
    /// Returns to the start page and closes everything that is open.
    Close,
    Quit,
}

/// Actions and commands that wait for the engineer's answer.
pub(super) struct PostponedActions {
    /// Action that waits until the engineer confirms that unsaved decisions may be lost.
    pub(super) losing: Option<PendingAction>,
    /// Whether the action `losing` is carried out once the study is saved: the engineer has chosen
    /// to save first, which may ask for a path.
    pub(super) goes_on_once_saved: bool,
    /// Command that waits until the engineer confirms that files may be overwritten.
    pub(super) overwriting: Option<Command>,
    /// Treatment of existing files: [`Existing::Replace`] only while a confirmed command is carried
    /// out.
    pub(super) existing: Existing,
    /// Whether the window is closing; the engineer is not asked again about unsaved decisions.
    pub(super) closing: bool,
}

impl PostponedActions {
    /// Creates the state without a waiting action.
    pub(super) fn new() -> Self {
        Self {
            losing: None,
            goes_on_once_saved: false,
            overwriting: None,
            existing: Existing::Keep,
            closing: false,
        }
    }

    /// Forgets the action that would lose unsaved decisions.
    pub(super) fn forget_losing(&mut self) {
        self.losing = None;
        self.goes_on_once_saved = false;
    }
}

impl GdcmApp {
    /// Asks whether the postponed action may discard unsaved decisions.
    pub(super) fn ask_to_lose(&mut self, postponed: PendingAction) {
        self.postponed.losing = Some(postponed);
        self.postponed.goes_on_once_saved = false;
        self.state.forms.shown = Some(FormKind::Unsaved);
    }

    /// Saves the study, then carries out the action postponed until it is saved.
    pub(super) fn save_and_go_on(&mut self) {
        self.state.forms.shown = None;
        self.postponed.goes_on_once_saved = true;
        self.save();
    }

    /// Carries out the action that was postponed because of unsaved decisions.
    pub(super) fn go_on(&mut self) {
        self.postponed.goes_on_once_saved = false;
        match self.postponed.losing.take() {
            Some(PendingAction::Show(purpose, opened)) => self.show_read(purpose, *opened),
            Some(PendingAction::Close) => self.close_study(),
            Some(PendingAction::Quit) => self.quit(),
            None => {}
        }
    }

    /// Asks in a form whether `command` may overwrite the files at `paths`.
    pub(super) fn ask_to_overwrite(&mut self, paths: &[PathBuf], form: FormKind, command: Command) {
        self.state.forms.existing = paths.iter().map(|path| sanitized_path(path)).collect();
        self.state.forms.shown = Some(form);
        self.postponed.overwriting = Some(command);
    }

    /// Repeats the command for which overwriting was confirmed.
    pub(super) fn overwrite(&mut self) {
        self.state.forms.existing.clear();
        if let Some(command) = self.postponed.overwriting.take() {
            self.postponed.existing = Existing::Replace;
            self.carry_out_command(command);
            self.postponed.existing = Existing::Keep;
        }
    }
}
