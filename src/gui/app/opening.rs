//! Opening datasets and studies. Files are read in threads, so the window never blocks.
//!
//! 1. `open` chooses the purpose: to show the file, or to restore lost decisions. `recovery.rs` and
//!    `reload.rs` start with their own purposes.
//! 2. `read` reads in a thread.
//! 3. `answer_opened` asks first if unsaved decisions would be lost, and reports an error.
//! 4. `show_read` shows the content: by `show`, `show_reloaded` or `show_restored`.

use std::path::PathBuf;

use gdcm_io::files::opened_file::holds_models;
use gdcm_io::files::study_file::open_study_of;
use gdcm_io::reading_budget::ReadingBudget;
use gdcm_io::{
    Example, FileError, LoadedDataset, Opened, embedded_example, load_any, load_example,
};
use gdcm_model::message_text::sanitized_path;
use gdcm_study::decisions::dataset_differences::Difference;

use super::GdcmApp;
use super::document_files::{ReadFor, SavedStudy, study_name};
use super::postponed_actions::PendingAction;
use crate::gui::state::forms::FormKind;
use crate::gui::state::notices::{Activity, MessageBar, NoticeAction};
use crate::gui::state::preferences::Preferences;
use crate::gui::state::window_state::State;
use crate::message::Message;

impl GdcmApp {
    /// Returns the initial window state, the dataset and the saved study for an opened file.
    pub(super) fn parts_of(opened: Opened) -> (State, LoadedDataset, SavedStudy) {
        let path = match &opened {
            Opened::Dataset(_) => None,
            Opened::Study(opened) => Some(opened.path.clone()),
        };
        let (study, loaded, differences) = opened.into_study();
        let mut state = State::new(
            study.clone(),
            study_name(path.as_deref()),
            loaded.cautions.clone(),
        );
        // Decisions that do not apply to the dataset would be lost by saving, so the study counts
        // as unsaved.
        state.unsaved = differences
            .iter()
            .any(|difference| matches!(difference, Difference::NotApplied { .. }));
        if !differences.is_empty() {
            state.forms.shown = Some(FormKind::Differences);
        }
        state.differences = differences;
        state.example = loaded.origin.example();
        let study = if state.unsaved { None } else { Some(study) };
        let saved = SavedStudy { path, study };
        (state, loaded, saved)
    }

    /// Replaces the open study with `opened`.
    pub(super) fn show(&mut self, opened: Opened) {
        let (mut state, loaded, saved) = Self::parts_of(opened);
        let requested = self.state.results.requested;
        let name = match &saved.path {
            Some(path) => sanitized_path(path),
            None => match loaded.origin.example() {
                Some(example) => format!("the {}", example.name()),
                None => loaded.origin.to_string(),
            },
        };
        state.recent = std::mem::take(&mut self.state.recent);
        state.notices = std::mem::take(&mut self.state.notices);
        state.notices.drop_obsolete_toasts();
        Preferences::from_display(&self.state.display).apply(&mut state.display);
        // Keep the offers to restore lost decisions; the other bars concern the previous study.
        state
            .notices
            .close_bars(|bar| !matches!(bar, MessageBar::Recovery(_)));
        self.state = state;
        self.readers.record_reader.give_up();
        // Request numbers continue, so that late replies about the old dataset can be recognised.
        self.state.results.requested = requested;
        self.state.results.received = requested;
        self.files.loaded = loaded;
        // A reload of the previous study can no longer be undone.
        self.files.replaced_datasets.clear();
        self.files.saved = saved;
        self.update_recovery_file();
        let message = Message::new("opened", format!("opened {name}"));
        self.notify_done_with(Activity::Opening, message, None);
    }

    /// Opens a dataset or a study; the open study remains until the file is read. `moved` is the
    /// new path for a study's dataset.
    pub(super) fn open(&mut self, path: PathBuf, moved: Option<PathBuf>) {
        let path = self.files.at_home(path);
        let moved = moved.map(|dataset| self.files.at_home(dataset));
        // A path without an extension, usually a folder, gets the message of `load_any`.
        if path.extension().is_some() && holds_models(&path) {
            let path = sanitized_path(&path);
            let text = format!(
                "{path}: neither a dataset nor a study; to make a dataset from model files, \
                choose Import models in the File menu"
            );
            let message = Message::new("model-file", text);
            let remedy = Some(NoticeAction::OpenAnother);
            return self.notify_error_of(Activity::Opening, message, remedy);
        }
        let purpose = match self.recovery.offer_of(&path) {
            Some(offer) => ReadFor::Restoring(offer),
            None => ReadFor::Opening,
        };
        self.state.forms.shown = None;
        let name = sanitized_path(&path);
        self.read(purpose, name, move |budget| match moved {
            Some(dataset) => open_study_of(&path, &dataset, budget).map(Opened::Study),
            None => load_any(&path, budget),
        });
    }

    /// Reads a file in a separate thread, within the file size limit. Replaces a reading in
    /// progress.
    pub(super) fn read(
        &mut self,
        purpose: ReadFor,
        name: String,
        read: impl FnOnce(&ReadingBudget<'_>) -> Result<Opened, FileError> + Send + 'static,
    ) {
        self.state.opening = Some(name);
        let reading = self.readers.opener.begin();
        let number = reading.number;
        let read = move || read(&ReadingBudget::default().stopped_by(reading.stop));
        self.in_thread("the reading of a file", read, move |app, opened| {
            if !app.readers.opener.is_newest(number) {
                return;
            }
            app.state.opening = None;
            if let Some(opened) = opened {
                app.answer_opened(purpose, opened);
            }
        });
    }

    pub(super) fn open_example(&mut self, example: Example) {
        self.answer_opened(ReadFor::Opening, load_example(example).map(Opened::Dataset));
    }

    /// Closes the study: shows the start page, with the simulated example behind it.
    pub(super) fn close_study(&mut self) {
        let Some(example) = self.value_or_notify(embedded_example()) else {
            return;
        };
        self.show(Opened::Dataset(example));
        self.state.on_start_page = true;
        self.state.notices.dismiss_all();
        self.refresh_recent_files(None);
    }

    fn answer_opened(&mut self, purpose: ReadFor, opened: Result<Opened, FileError>) {
        match opened {
            Ok(opened) if purpose != ReadFor::Reloading && self.state.unsaved => {
                self.ask_to_lose(PendingAction::Show(purpose, Box::new(opened)));
            }
            Ok(opened) => self.show_read(purpose, opened),
            Err(error) => self.open_failed(error),
        }
    }

    pub(super) fn show_read(&mut self, purpose: ReadFor, opened: Opened) {
        match purpose {
            ReadFor::Opening => {
                self.show(opened);
                self.list_open_file_as_recent();
            }
            ReadFor::Reloading => self.show_reloaded(opened.into_study().1),
            ReadFor::Restoring(offer) => self.show_restored(offer, opened),
        }
    }

    /// Reports why a file was not opened, or asks for a study's dataset; the open study remains.
    fn open_failed(&mut self, error: FileError) {
        // The file may have been a recent file that no longer exists.
        self.refresh_recent_files(None);
        match error {
            FileError::StudyDataset { path, dataset } => {
                self.state.forms.lost_dataset = Some((path, dataset.to_string()));
                self.state.forms.shown = Some(FormKind::FindDataset);
            }
            error => {
                let remedy = Some(NoticeAction::OpenAnother);
                self.notify_error_of(Activity::Opening, error, remedy);
            }
        }
    }
}
