//! Saving the study.

use std::path::{Path, PathBuf};

use gdcm_io::output_set::OutputSet;
use gdcm_io::{Existing, FileError, save_study};
use gdcm_model::message_text::sanitized_path;

use super::GdcmApp;
use super::document_files::{SavedStudy, study_name, with_study_extension};
use super::file_dialogs::DialogPurpose;
use crate::gui::commands::command::Command;
use crate::gui::commands::file::FileCommand;
use crate::gui::state::forms::FormKind;
use crate::gui::state::notices::{Activity, NoticeAction};
use crate::message::Message;

impl GdcmApp {
    /// Saves the study to its file, or asks for a path if it has none.
    pub(super) fn save(&mut self) {
        match self.files.saved.path.clone() {
            Some(path) => self.save_as(path, Existing::Replace),
            None => self.ask_path(DialogPurpose::SaveStudy, self.files.proposed_name()),
        }
    }

    /// Saves the study to a file. Asks before overwriting any file other than the study's, unless
    /// the engineer has already agreed.
    pub(super) fn save_as(&mut self, path: PathBuf, existing: Existing) {
        let path = with_study_extension(self.files.at_home(path));
        let is_own = self.files.saved.path.as_ref() == Some(&path);
        let existing = if is_own { Existing::Replace } else { existing };
        match self.write_study(&path, existing) {
            Ok(()) => self.study_saved(path),
            Err(FileError::Exists { paths }) => {
                *self.state.forms.typed_in(FormKind::Save) = path.display().to_string();
                self.ask_to_overwrite(
                    &paths,
                    FormKind::Save,
                    Command::File(FileCommand::SaveStudyAs(path)),
                );
            }
            Err(error) => {
                self.postponed.forget_losing();
                let remedy = Some(NoticeAction::SaveElsewhere);
                self.notify_error_of(Activity::Saving, error, remedy);
            }
        }
    }

    fn write_study(&self, path: &Path, existing: Existing) -> Result<(), FileError> {
        OutputSet::new(existing, Vec::new()).check(&[path])?;
        save_study(&self.state.study, &self.files.loaded, path)
    }

    /// Records that the study is saved; carries out the action postponed until then.
    fn study_saved(&mut self, path: PathBuf) {
        self.state.forms.shown = None;
        self.state.study_name = study_name(Some(&path));
        self.state.unsaved = false;
        let text = format!("saved {}", sanitized_path(&path));
        self.notify_written_to(Activity::Saving, Message::new("saved", text), &path);
        self.files.saved = SavedStudy {
            path: Some(path),
            study: Some(self.state.study.clone()),
        };
        self.update_recovery_file();
        self.list_open_file_as_recent();
        if self.postponed.goes_on_once_saved {
            self.go_on();
        }
    }
}
