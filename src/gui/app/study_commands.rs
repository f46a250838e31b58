//! Carries out commands about decisions and their history.
//!
//! A *decision* is a change of the study by an [`Edit`]; the undo history records it.

use std::sync::Arc;

use gdcm_study::{Edit, Study};

use super::GdcmApp;
use crate::gui::commands::study::StudyCommand;
use crate::gui::state::notices::Activity;
use crate::gui::state::records::RecordsState;
use crate::gui::state::window_state::{State, UndoHistory};

impl GdcmApp {
    pub(super) fn carry_out_study(&mut self, command: StudyCommand) {
        match command {
            StudyCommand::Edit(edit) => self.decide(&edit),
            StudyCommand::DragEdit => self.set_setting_dragged(true),
            StudyCommand::EndEdit => {
                self.set_setting_dragged(false);
                // The next edit of the same setting is a separate undo step.
                self.state.history.seal();
            }
            // A step may also contain an edit to flight records, which are not part of the study:
            // `exchange` restores them.
            StudyCommand::Undo => self.restore_study(|history, study, records| {
                history.undo(study, |before| records.exchange(before))
            }),
            StudyCommand::Redo => self.restore_study(|history, study, records| {
                history.redo(study, |before| records.exchange(before))
            }),
            // Withdraws the edit of a first click that has turned out to begin a double click.
            StudyCommand::Forget(edit) => {
                self.restore_study(|history, _, _| history.withdraw(&edit))
            }
        }
    }

    fn set_setting_dragged(&mut self, is_dragged: bool) {
        if let Some(session) = &mut self.state.settings_session {
            session.is_dragged = is_dragged;
        }
    }

    /// Applies a decision to the study and adds it to the history, unless it changes nothing;
    /// reports a refusal.
    pub(super) fn decide(&mut self, edit: &Edit) {
        let before = self.state.study.clone();
        match self.state.study.apply(edit) {
            Ok(()) if self.state.study == before => {}
            Ok(()) => {
                self.state.history.record(before, edit);
                self.study_changed();
            }
            Err(refusal) => self.notify_error_of(Activity::Decision, refusal, None),
        }
    }

    /// Replaces the study by the state that `find` takes from the history; does nothing if there is
    /// none.
    fn restore_study(
        &mut self,
        find: impl FnOnce(&mut UndoHistory, &Study, &mut RecordsState) -> Option<Study>,
    ) {
        let State {
            history,
            study,
            records,
            ..
        } = &mut self.state;
        if let Some(mut restored) = find(history, study, records) {
            // Export choices are not part of the undo history.
            restored.exports = Arc::clone(&study.exports);
            self.state.study = restored;
            self.study_changed();
        }
    }

    /// Updates everything that depends on the study: obsolete toasts, the responses that were ever
    /// constrained, the mark for unsaved decisions, the selected dataset file and the recovery
    /// file.
    pub(super) fn study_changed(&mut self) {
        self.state.notices.drop_obsolete_toasts();
        // Their net gains stay in the plot, so that a released response can be compared.
        self.state
            .display
            .gains
            .once_held
            .extend(self.state.study.settings.constrained.marked());
        self.state.unsaved = self.files.saved.study.as_ref() != Some(&self.state.study);
        self.select_dataset_file();
        self.update_recovery_file();
    }
}
