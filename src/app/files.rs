//! Opening and saving; the desktop's file dialogs, and the list of recent files. What may take long is done in threads, so that the
//! window never waits.

use std::path::{Path, PathBuf};

use gdcm_io::output_set::OutputSet;
use gdcm_io::source::{at_home, file_exists};
use gdcm_io::study_file::{STUDY_EXTENSION, holds_models, open_study_of};
use gdcm_io::user_state::{add_recent_file, recent_files};
use gdcm_io::variables::ReadingBudget;
use gdcm_io::{Existing, FileError, LoadedDataset, Opened, embedded_example, load_any, save_study};
use gdcm_model::message_text::{sanitized, sanitized_path};
use gdcm_study::study::Study;
use gdcm_study::study::differences::Difference;

use super::GdcmApp;
use super::threads::caught;
use crate::view::assembling::AssemblingCommand;
use crate::view::records::RecordsCommand;
use crate::view::{Bar, Command, FormKind, Preferences, RecentFile, RequirementTable, State};

/// The study as it was saved last.
#[derive(Clone, Debug)]
pub(super) struct SavedStudy {
    /// Where; nowhere yet for a new study.
    pub(super) path: Option<PathBuf>,
    /// What was saved, or what a new study starts from; none of decisions that were restored.
    pub(super) study: Option<Study>,
}

/// What a file is read for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum ReadFor {
    /// To be shown in place of what is open.
    Opening,
    /// To take the place of the dataset that is open, which was read from it before.
    Reloading,
    /// To go on with decisions that were not saved, by the number of the offer.
    Restoring(usize),
}

/// What a dialog was opened for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum DialogPurpose {
    /// A dataset or a study to open.
    Open,
    /// A file to save the study to.
    SaveStudy,
    /// A folder to export to.
    ExportFolder,
    /// A folder of model files.
    ModelFolder,
    /// A folder of flight records.
    RecordFolder,
    /// A file of a table that requirements are asked with.
    RequirementTable(RequirementTable),
}

/// What waits for the answer whether the decisions that are not saved may be lost.
#[derive(Debug)]
pub(super) enum PendingAction {
    /// To show what was read, which is good.
    Show(ReadFor, Box<Opened>),
    /// To go back to the start page with nothing of what is open.
    Close,
    /// To close the window.
    Quit,
}

impl GdcmApp {
    /// What the window starts with when `opened` is shown.
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
        // Saved now, the file would lose what does not apply.
        state.unsaved = differences
            .iter()
            .any(|difference| matches!(difference, Difference::NotApplied { .. }));
        state.forms.shown = (!differences.is_empty()).then_some(FormKind::Differences);
        state.differences = differences;
        state.is_example = loaded.path().is_none();
        let saved = SavedStudy {
            path,
            study: (!state.unsaved).then_some(study),
        };
        (state, loaded, saved)
    }

    /// Shows what was opened in place of what is open.
    pub(super) fn show(&mut self, opened: Opened) {
        let (mut state, loaded, saved) = Self::parts_of(opened);
        let requested = self.state.results.requested;
        let name = loaded.origin.to_string();
        state.recent = std::mem::take(&mut self.state.recent);
        Preferences::of(&self.state.display).apply(&mut state.display);
        // What was lost is offered still; the other bars are about what was open.
        state.bars = std::mem::take(&mut self.state.bars);
        state.bars.retain(|bar| matches!(bar, Bar::Recovery { .. }));
        self.state = state;
        self.record_reader.give_up();
        // Request numbers go on, so that late answers about the old dataset are told apart.
        self.state.results.requested = requested;
        self.state.results.received = requested;
        self.loaded = loaded;
        self.earlier.clear();
        self.saved = saved;
        self.keep_unsaved();
        self.done(format!("opened {name}"));
    }

    /// Puts what is open in front of the recent files: the study, or else the dataset.
    pub(super) fn look_for_recent(&self) {
        let dataset = || self.loaded.path().map(Path::to_owned);
        self.read_recent(self.saved.path.clone().or_else(dataset));
    }

    /// Reads the list of recent files and looks which of them are there, in a thread of its own, for a network drive may keep it
    /// waiting; puts `newest` in front first.
    pub(super) fn read_recent(&self, newest: Option<PathBuf>) {
        let Some(directory) = self.directory.clone() else {
            return;
        };
        let read = move || -> Result<Vec<RecentFile>, FileError> {
            newest.map_or(Ok(()), |newest| add_recent_file(&directory, &newest))?;
            Ok(recent_files(&directory)
                .into_iter()
                .map(recent_file)
                .collect())
        };
        self.in_thread("the reading of recent files", read, |app, read| {
            if let Some(files) = read.and_then(|read| app.unless_error(read)) {
                app.state.recent = files;
            }
        });
    }

    /// Opens a dataset or a study; what is open stays until it is read. The dataset of a study may have moved.
    pub(super) fn open(&mut self, path: PathBuf, moved: Option<PathBuf>) {
        let path = self.at_home(path);
        let moved = moved.map(|dataset| self.at_home(dataset));
        if path.extension().is_some() && holds_models(&path) {
            let path = sanitized_path(&path);
            return self.notify_error(format!(
                "{path}: this is neither a dataset nor a study; Import models, in the menu File, makes a dataset of model files"
            ));
        }
        let lost = self
            .offers
            .iter()
            .position(|lost| lost.as_ref().is_some_and(|lost| lost.path() == path));
        let purpose = lost.map_or(ReadFor::Opening, ReadFor::Restoring);
        self.state.forms.shown = None;
        let name = sanitized_path(&path);
        let read = move |budget: &ReadingBudget<'_>| match moved {
            Some(dataset) => open_study_of(&path, &dataset, budget).map(Opened::Study),
            None => load_any(&path, budget),
        };
        self.read(purpose, name, read);
    }

    /// Reads in a thread of its own, within the budget of a file, in place of what was being opened.
    pub(super) fn read(
        &mut self,
        purpose: ReadFor,
        name: String,
        read: impl FnOnce(&ReadingBudget<'_>) -> Result<Opened, FileError> + Send + 'static,
    ) {
        self.state.opening = Some(name);
        let (number, stop) = self.opener.begin();
        let read = move || read(&ReadingBudget::default().stopped_by(stop));
        self.in_thread("the reading of a file", read, move |app, opened| {
            if !app.opener.is_newest(number) {
                return;
            }
            app.state.opening = None;
            opened
                .into_iter()
                .for_each(|opened| app.answer_opened(purpose, opened));
        });
    }

    pub(super) fn open_example(&mut self) {
        self.answer_opened(ReadFor::Opening, embedded_example().map(Opened::Dataset));
    }

    /// Puts the example in the place of what is open, behind the start page.
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

    /// Asks whether the decisions that are not saved may be lost to what is to be done.
    pub(super) fn ask_to_lose(&mut self, postponed: PendingAction) {
        self.postponed = Some(postponed);
        self.goes_on_once_saved = false;
        self.state.forms.shown = Some(FormKind::Unsaved);
    }

    /// Saves the study, and does what waits for it once it is saved.
    pub(super) fn save_and_go_on(&mut self) {
        self.state.forms.shown = None;
        self.goes_on_once_saved = true;
        self.save();
    }

    /// Does what the decisions that are not saved kept waiting.
    pub(super) fn go_on(&mut self) {
        self.goes_on_once_saved = false;
        match self.postponed.take() {
            Some(PendingAction::Show(purpose, opened)) => self.show_read(purpose, *opened),
            Some(PendingAction::Close) => self.close_study(),
            Some(PendingAction::Quit) => self.quit(),
            None => {}
        }
    }

    /// Says why nothing was opened, or asks where a study's dataset is; what is open stays.
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

    /// Opens a dialog of the desktop, unless one is open; it starts with `file_name` where it saves.
    pub(super) fn ask_path(&mut self, purpose: DialogPurpose, file_name: String) {
        if self.dialog_open {
            return;
        }
        self.dialog_open = true;
        // A desktop without dialogs is none that was left without a choice.
        let ask = move || caught(|| dialog(purpose, &file_name)).ok().flatten();
        self.in_thread("the dialog", ask, move |app, chosen| {
            app.dialog_open = false;
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
                // The dialog has asked about the name as it was chosen.
                let is_asked = with_study_extension(path.clone()) == path;
                self.save_as(
                    path,
                    if is_asked {
                        Existing::Replace
                    } else {
                        Existing::Keep
                    },
                );
            }
            DialogPurpose::ExportFolder => {
                *self.state.forms.typed_in(FormKind::Export) = path.display().to_string()
            }
            DialogPurpose::ModelFolder => self.assemble(AssemblingCommand::Add(vec![path])),
            DialogPurpose::RecordFolder => self.records(RecordsCommand::Add(vec![path])),
            DialogPurpose::RequirementTable(table) => self.read_requirement_table(table, path),
        }
    }

    /// Nothing was chosen, or there is no dialog on this desktop: both look alike, and the path is offered as text.
    fn nothing_chosen(&mut self, purpose: DialogPurpose) {
        match purpose {
            DialogPurpose::Open => self.state.forms.shown = Some(FormKind::Open),
            DialogPurpose::SaveStudy => {
                *self.state.forms.typed_in(FormKind::Save) = self.proposed_name();
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

    /// Saves the study where it was saved last, or asks where.
    pub(super) fn save(&mut self) {
        match self.saved.path.clone() {
            Some(path) => self.save_as(path, Existing::Replace),
            None => self.ask_path(DialogPurpose::SaveStudy, self.proposed_name()),
        }
    }

    /// Saves the study to a file; asks before it overwrites one that is not the study's own, unless that was asked already.
    pub(super) fn save_as(&mut self, path: PathBuf, existing: Existing) {
        let path = with_study_extension(self.at_home(path));
        let is_own = self.saved.path.as_ref() == Some(&path);
        let place = OutputSet::new(
            if is_own { Existing::Replace } else { existing },
            Vec::new(),
        );
        match place
            .check(&[&path])
            .and_then(|()| save_study(&self.state.study, &self.loaded, &path))
        {
            Ok(()) => {
                self.state.forms.shown = None;
                self.state.study_name = study_name(Some(&path));
                self.state.unsaved = false;
                self.done(format!("saved {}", sanitized_path(&path)));
                self.saved = SavedStudy {
                    path: Some(path),
                    study: Some(self.state.study.clone()),
                };
                self.keep_unsaved();
                self.look_for_recent();
                if self.goes_on_once_saved {
                    self.go_on();
                }
            }
            Err(FileError::Exists { paths }) => {
                *self.state.forms.typed_in(FormKind::Save) = path.display().to_string();
                self.ask_to_overwrite(&paths, FormKind::Save, Command::SaveStudyAs(path));
            }
            Err(error) => {
                self.goes_on_once_saved = false;
                self.postponed = None;
                self.notify_error(error.to_string());
            }
        }
    }

    /// A path as it is typed, with the home directory in the place of `~`.
    pub(super) fn at_home(&self, typed: PathBuf) -> PathBuf {
        at_home(&typed, self.home.as_deref())
    }

    /// A name for the study's file.
    pub(super) fn proposed_name(&self) -> String {
        if let Some(path) = &self.saved.path {
            return path.display().to_string();
        }
        format!("{}.{STUDY_EXTENSION}", self.stem())
    }

    /// What files about the dataset are called, without their ends.
    pub(super) fn stem(&self) -> String {
        let stem = self
            .loaded
            .path()
            .and_then(Path::file_stem)
            .map(|stem| stem.to_string_lossy().into_owned());
        stem.unwrap_or_else(|| "example".to_owned())
            .trim_end_matches(".json")
            .to_owned()
    }
}

pub(super) fn study_name(path: Option<&Path>) -> String {
    let name = path
        .and_then(|path| path.file_name())
        .map(|name| sanitized(&name.to_string_lossy()));
    name.unwrap_or_else(|| "untitled study".to_owned())
}

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
        DialogPurpose::ModelFolder => dialog.set_title("A folder of model files").pick_folder(),
        DialogPurpose::RecordFolder => dialog.set_title("A folder of flight records").pick_folder(),
        DialogPurpose::RequirementTable(table) => {
            let title = match table {
                RequirementTable::Levels => "Levels of bandwidth and phase delay",
                RequirementTable::Tolerances => "Tolerances of time histories",
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
