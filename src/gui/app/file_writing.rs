//! Writes files without overwriting others unasked, and reports the outcome.

use std::path::Path;

use gdcm_io::FileError;
use gdcm_io::output_set::OutputSet;
use gdcm_model::message_text::sanitized_path;

use super::GdcmApp;
use crate::gui::commands::command::Command;
use crate::gui::state::forms::FormKind;
use crate::gui::state::notices::Activity;
use crate::message::Message;

impl GdcmApp {
    /// Creates an output set that never overwrites input files, and overwrites other files only
    /// after confirmation.
    pub(super) fn outputs(&self) -> OutputSet {
        OutputSet::new(self.postponed.existing, self.files.inputs())
    }

    /// Writes all files that `add` adds to the set, or none. First checks that none of `paths`
    /// would be overwritten without consent.
    pub(super) fn write_all(
        &self,
        paths: &[&Path],
        add: impl FnOnce(&mut OutputSet) -> Result<(), FileError>,
    ) -> Result<(), FileError> {
        let mut outputs = self.outputs();
        outputs.check(paths)?;
        add(&mut outputs)?;
        outputs.persist()
    }

    /// Reports why files were not written. If files exist, asks whether the command `again` may
    /// overwrite them.
    pub(super) fn notify_not_written(&mut self, error: FileError, form: FormKind, again: Command) {
        match error {
            FileError::Exists { paths } => self.ask_to_overwrite(&paths, form, again),
            error => self.notify_error(error),
        }
    }

    /// Closes the form, remembers the file's folder, and reports the file; or reports the error. If
    /// the file exists, asks whether the command `again` may overwrite it.
    pub(super) fn notify_file(
        &mut self,
        written: Result<Message, FileError>,
        path: &Path,
        form: FormKind,
        again: Command,
    ) {
        match written {
            Ok(message) => {
                self.state.forms.shown = None;
                self.files.last_folder = path.parent().map(Path::to_owned);
                self.notify_written_to(Activity::Other, message, path);
            }
            Err(error) => self.notify_not_written(error, form, again),
        }
    }

    /// Like [`Self::notify_file`], with the message that the file is saved.
    pub(super) fn notify_saved(
        &mut self,
        saved: Result<(), FileError>,
        path: &Path,
        form: FormKind,
        again: Command,
    ) {
        let message = Message::new("saved", format!("saved {}", sanitized_path(path)));
        self.notify_file(saved.map(|()| message), path, form, again);
    }
}
