//! Opening and saving, the desktop's file dialogs, and the recent-files list. Slow operations
//! run in threads, so the window never blocks.

use std::path::{Path, PathBuf};

use gdcm_io::files::opened_file::holds_models;
use gdcm_io::files::recent_files::{add_recent_file, recent_files};
use gdcm_io::files::study_file::{STUDY_EXTENSION, open_study_of};
use gdcm_io::output_set::OutputSet;
use gdcm_io::reading_budget::ReadingBudget;
use gdcm_io::user_paths::file_exists;
use gdcm_io::{Existing, FileError, LoadedDataset, Opened, embedded_example, load_any, save_study};
use gdcm_model::message_text::{sanitized, sanitized_path};
use gdcm_study::decisions::dataset_differences::Difference;

use super::GdcmApp;
use super::dialogs::{DialogPurpose, PendingAction};
use super::document_files::{ReadFor, SavedStudy};
use super::threads::caught;
use crate::gui::commands::assembling::AssemblingCommand;
use crate::gui::commands::command::Command;
use crate::gui::commands::file::FileCommand;
use crate::gui::commands::records::RecordsCommand;
use crate::gui::state::forms::{FormKind, RequirementTable};
use crate::gui::state::notices::Bar;
use crate::gui::state::preferences::Preferences;
use crate::gui::state::window_state::{RecentFile, State};

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
        state.is_example = loaded.path().is_none();
        let study = if state.unsaved { None } else { Some(study) };
        let saved = SavedStudy { path, study };
        (state, loaded, saved)
    }

    /// Replaces the open study with `opened`.
    pub(super) fn show(&mut self, opened: Opened) {
        let (mut state, loaded, saved) = Self::parts_of(opened);
        let requested = self.state.results.requested;
        let name = loaded.origin.to_string();
        state.recent = std::mem::take(&mut self.state.recent);
        Preferences::from_display(&self.state.display).apply(&mut state.display);
        // Keep the offers to restore lost decisions; the other bars concern the previous study.
        state.bars = std::mem::take(&mut self.state.bars);
        state.bars.retain(|bar| matches!(bar, Bar::Recovery { .. }));
        self.state = state;
        self.readers.record_reader.give_up();
        // Request numbers continue, so that late replies about the old dataset can be recognised.
        self.state.results.requested = requested;
        self.state.results.received = requested;
        self.files.loaded = loaded;
        self.files.earlier.clear();
        self.files.saved = saved;
        self.keep_unsaved();
        self.done(format!("opened {name}"));
    }

    /// Puts the open study, or else the open dataset, first in the recent-files list.
    pub(super) fn look_for_recent(&self) {
        let study = self.files.saved.path.as_deref();
        let newest = study.or(self.files.loaded.path());
        self.read_recent(newest.map(Path::to_owned));
    }

    /// Reads the recent-files list and checks which files exist; puts `newest` first. Runs in a
    /// separate thread, because a network drive may be slow.
    pub(super) fn read_recent(&self, newest: Option<PathBuf>) {
        let Some(directory) = self.files.directory.clone() else {
            return;
        };
        let read = move || read_recent_files(&directory, newest.as_deref());
        self.in_thread("the reading of recent files", read, |app, read| {
            if let Some(files) = read.and_then(|read| app.unless_error(read)) {
                app.state.recent = files;
            }
        });
    }

    /// Opens a dataset or a study; the open study remains until the file is read. `moved` is the
    /// new path of a study's dataset.
    pub(super) fn open(&mut self, path: PathBuf, moved: Option<PathBuf>) {
        let path = self.files.at_home(path);
        let moved = moved.map(|dataset| self.files.at_home(dataset));
        if path.extension().is_some() && holds_models(&path) {
            let path = sanitized_path(&path);
            return self.notify_error(format!(
                "{path}: neither a dataset nor a study; to make a dataset from model files, use \
                Import models in the menu File"
            ));
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

    /// Reads a file in a separate thread, within the size limit of a file. Replaces a reading in
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

    /// Opens the embedded example.
    pub(super) fn open_example(&mut self) {
        self.answer_opened(ReadFor::Opening, embedded_example().map(Opened::Dataset));
    }

    /// Closes the study: shows the start page, with the example behind it.
    pub(super) fn close_study(&mut self) {
        let Some(example) = self.unless_error(embedded_example()) else {
            return;
        };
        self.show(Opened::Dataset(example));
        self.state.on_start_page = true;
        self.state.notice = None;
        self.read_recent(None);
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

    fn show_read(&mut self, purpose: ReadFor, opened: Opened) {
        match purpose {
            ReadFor::Opening => {
                self.show(opened);
                self.look_for_recent();
            }
            ReadFor::Reloading => self.show_reloaded(opened.into_study().1),
            ReadFor::Restoring(offer) => self.show_restored(offer, opened),
        }
    }

    /// Asks whether the postponed action may discard unsaved decisions.
    pub(super) fn ask_to_lose(&mut self, postponed: PendingAction) {
        self.dialogs.postponed = Some(postponed);
        self.dialogs.goes_on_once_saved = false;
        self.state.forms.shown = Some(FormKind::Unsaved);
    }

    /// Saves the study, then carries out the action postponed until it is saved.
    pub(super) fn save_and_go_on(&mut self) {
        self.state.forms.shown = None;
        self.dialogs.goes_on_once_saved = true;
        self.save();
    }

    /// Carries out the action that was postponed because of unsaved decisions.
    pub(super) fn go_on(&mut self) {
        self.dialogs.goes_on_once_saved = false;
        match self.dialogs.postponed.take() {
            Some(PendingAction::Show(purpose, opened)) => self.show_read(purpose, *opened),
            Some(PendingAction::Close) => self.close_study(),
            Some(PendingAction::Quit) => self.quit(),
            None => {}
        }
    }

    /// Reports why a file was not opened, or asks for the dataset of a study; the open study
    /// remains.
    fn open_failed(&mut self, error: FileError) {
        self.read_recent(None);
        match error {
            FileError::StudyDataset { path, dataset } => {
                self.state.forms.lost_dataset = Some((path, dataset.to_string()));
                self.state.forms.shown = Some(FormKind::FindDataset);
            }
            error => self.notify_error(error.to_string()),
        }
    }

    /// Opens a desktop file dialog unless a dialog is open; a save dialog proposes `file_name`.
    pub(super) fn ask_path(&mut self, purpose: DialogPurpose, file_name: String) {
        if self.dialogs.dialog_open {
            return;
        }
        self.dialogs.dialog_open = true;
        // Without desktop dialogs, the call fails or panics; this counts as a dialog closed without
        // a choice.
        let ask = move || caught(|| dialog(purpose, &file_name)).ok().flatten();
        self.in_thread("the dialog", ask, move |app, chosen| {
            app.dialogs.dialog_open = false;
            match chosen.flatten() {
                Some(path) => app.path_chosen(purpose, path),
                None => app.nothing_chosen(purpose),
            }
        });
    }

    fn path_chosen(&mut self, purpose: DialogPurpose, path: PathBuf) {
        match purpose {
            DialogPurpose::Open => self.open(path, None),
            DialogPurpose::SaveStudy => {
                // The dialog has asked only about the chosen name, not about the name with the
                // extension that is added here.
                let existing = if with_study_extension(path.clone()) == path {
                    Existing::Replace
                } else {
                    Existing::Keep
                };
                self.save_as(path, existing);
            }
            DialogPurpose::ExportFolder => {
                *self.state.forms.typed_in(FormKind::Export) = path.display().to_string()
            }
            DialogPurpose::ModelFolder => self.assemble(AssemblingCommand::Add(vec![path])),
            DialogPurpose::RecordFolder => self.records(RecordsCommand::Add(vec![path])),
            DialogPurpose::RequirementTable(table) => self.read_requirement_table(table, path),
        }
    }

    /// Handles a dialog without a choice. A cancelled dialog and a desktop without dialogs look
    /// alike, so the path can be typed instead.
    fn nothing_chosen(&mut self, purpose: DialogPurpose) {
        match purpose {
            DialogPurpose::Open => self.state.forms.shown = Some(FormKind::Open),
            DialogPurpose::SaveStudy => {
                *self.state.forms.typed_in(FormKind::Save) = self.files.proposed_name();
                self.state.forms.shown = Some(FormKind::Save);
            }
            DialogPurpose::RequirementTable(table) => {
                self.state.forms.shown = Some(FormKind::ReadRequirementTable(table));
            }
            DialogPurpose::ExportFolder
            | DialogPurpose::ModelFolder
            | DialogPurpose::RecordFolder => {}
        }
    }

    /// Saves the study to the file from which it was opened, or asks for a path.
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
                self.dialogs.goes_on_once_saved = false;
                self.dialogs.postponed = None;
                self.notify_error(error.to_string());
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
        self.done(format!("saved {}", sanitized_path(&path)));
        self.files.saved = SavedStudy {
            path: Some(path),
            study: Some(self.state.study.clone()),
        };
        self.keep_unsaved();
        self.look_for_recent();
        if self.dialogs.goes_on_once_saved {
            self.go_on();
        }
    }
}

/// Reads the recent-files list and puts `newest` first.
fn read_recent_files(
    directory: &Path,
    newest: Option<&Path>,
) -> Result<Vec<RecentFile>, FileError> {
    if let Some(newest) = newest {
        add_recent_file(directory, newest)?;
    }
    Ok(recent_files(directory)
        .into_iter()
        .map(recent_file)
        .collect())
}

/// Returns a study's file name, or a substitute without a path.
pub(super) fn study_name(path: Option<&Path>) -> String {
    match path.and_then(Path::file_name) {
        Some(name) => sanitized(&name.to_string_lossy()),
        None => "untitled study".to_owned(),
    }
}

/// Adds the study extension, unless the name ends in ".json".
fn with_study_extension(path: PathBuf) -> PathBuf {
    let name = path
        .file_name()
        .map(|name| name.to_string_lossy().into_owned())
        .unwrap_or_default();
    if name.ends_with(".json") {
        path
    } else {
        path.with_file_name(format!("{name}.{STUDY_EXTENSION}"))
    }
}

fn recent_file(path: PathBuf) -> RecentFile {
    let name = path
        .file_name()
        .map(|name| sanitized(&name.to_string_lossy()))
        .unwrap_or_default();
    let folder = path.parent().map(sanitized_path).unwrap_or_default();
    RecentFile {
        missing: !file_exists(&path),
        path,
        name,
        folder,
    }
}

/// Shows a desktop file dialog; returns `None` if nothing was chosen.
fn dialog(purpose: DialogPurpose, file_name: &str) -> Option<PathBuf> {
    let dialog = rfd::FileDialog::new();
    match purpose {
        DialogPurpose::Open => dialog
            .set_title("Open a dataset or a study")
            .add_filter("datasets and studies", &["json", "gz"])
            .add_filter("all files", &["*"])
            .pick_file(),
        DialogPurpose::SaveStudy => dialog
            .set_title("Save the study")
            .add_filter("studies", &["json"])
            .set_file_name(file_name)
            .save_file(),
        DialogPurpose::ModelFolder => dialog
            .set_title("Choose a folder with model files")
            .pick_folder(),
        DialogPurpose::RecordFolder => dialog
            .set_title("Choose a folder with flight records")
            .pick_folder(),
        DialogPurpose::RequirementTable(table) => {
            let title = match table {
                RequirementTable::Levels => "Open levels of bandwidth and phase delay",
                RequirementTable::Tolerances => "Open tolerances of time histories",
            };
            dialog
                .set_title(title)
                .add_filter("tables", &["json"])
                .pick_file()
        }
        DialogPurpose::ExportFolder => dialog
            .set_title("Export corrections to a folder")
            .pick_folder(),
    }
}
