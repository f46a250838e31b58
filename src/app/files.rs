//! Opening and saving.

use gdcm_core::message_text::{sanitized, sanitized_path};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, Sender, channel};

use egui::Context;

use crate::view::assembling::AssemblingCommand;
use crate::view::bars::Bar;
use crate::view::command::{Command, FormKind};
use crate::view::display::Preferences;
use crate::view::records::RecordsCommand;
use crate::view::state::State;
use gdcm_core::study::{Analysis, Difference, Study, Table};
use gdcm_files::{
    Existing, FileError, LoadedDataset, Opened, OutputSet, STUDY_EXTENSION, at_home, embedded_example, load_any,
    open_study_of, save_study, save_table,
};

use super::dialogs::{DialogAnswer, DialogPurpose};
use super::fault::{Fault, caught};
use super::window::GdcmApp;

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

/// What waits for the answer whether the decisions that are not saved may be lost.
#[derive(Debug)]
pub(super) enum PendingAction {
    /// To show what was read, which is good.
    Show(ReadFor, Box<Opened>),
    /// To close the window.
    Quit,
}

/// What was read, or why not; a fault where reading panicked.
type Answer = (ReadFor, Result<Result<Opened, FileError>, Fault>);

/// The threads that read files, and where their answers arrive.
pub(super) struct Readers {
    sender: Sender<Answer>,
    receiver: Receiver<Answer>,
}

impl Default for Readers {
    fn default() -> Self {
        let (sender, receiver) = channel();
        Self { sender, receiver }
    }
}

impl GdcmApp {
    /// What the window starts with when `opened` is shown.
    pub(super) fn parts_of(opened: Opened) -> (State, LoadedDataset, SavedStudy) {
        let path = match &opened {
            Opened::Dataset(_) => None,
            Opened::Study(opened) => Some(opened.path.clone()),
        };
        let (study, loaded, differences) = opened.into_study();
        let mut state = State::new(study.clone(), study_name(path.as_deref()), loaded.cautions.clone());
        // Saved now, the file would lose what does not apply.
        state.unsaved = differences.iter().any(|difference| matches!(difference, Difference::NotApplied { .. }));
        state.forms.shown = (!differences.is_empty()).then_some(FormKind::Differences);
        state.differences = differences;
        let saved = SavedStudy { path, study: (!state.unsaved).then_some(study) };
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
    pub(super) fn look_for_recent(&self, ctx: &Context) {
        let dataset = || self.loaded.path().map(Path::to_owned);
        self.recent.look(self.saved.path.clone().or_else(dataset), ctx);
    }

    /// Opens a dataset or a study; what is open stays until it is read. The dataset of a study may have moved.
    pub(super) fn open(&mut self, path: PathBuf, moved: Option<PathBuf>, ctx: &Context) {
        let (path, moved) = (self.at_home(path), moved.map(|dataset| self.at_home(dataset)));
        let lost = self.offers.iter().position(|lost| lost.as_ref().is_some_and(|lost| lost.path() == path));
        let purpose = lost.map_or(ReadFor::Opening, ReadFor::Restoring);
        self.state.forms.shown = None;
        let name = sanitized_path(&path);
        let read = move || match moved {
            Some(dataset) => open_study_of(&path, &dataset).map(Opened::Study),
            None => load_any(&path),
        };
        self.read(purpose, name, read, ctx);
    }

    /// Reads in a thread of its own.
    pub(super) fn read(
        &mut self,
        purpose: ReadFor,
        name: String,
        read: impl FnOnce() -> Result<Opened, FileError> + Send + 'static,
        ctx: &Context,
    ) {
        self.state.opening = Some(name);
        let (sender, wake) = (self.readers.sender.clone(), ctx.clone());
        let read = move || {
            // The window may be gone by now.
            let _ = sender.send((purpose, caught(read)));
            wake.request_repaint();
        };
        if let Err(error) = std::thread::Builder::new().name("reading".to_owned()).spawn(read) {
            self.state.opening = None;
            self.trouble(format!("the file cannot be read: {error}"));
        }
    }

    pub(super) fn open_example(&mut self, ctx: &Context) {
        self.answer_opened(ReadFor::Opening, embedded_example().map(Opened::Dataset), ctx);
    }

    fn answer_opened(&mut self, purpose: ReadFor, opened: Result<Opened, FileError>, ctx: &Context) {
        self.state.opening = None;
        match opened {
            Ok(opened) if purpose != ReadFor::Reloading && self.state.unsaved => {
                self.ask_to_lose(PendingAction::Show(purpose, Box::new(opened)));
            }
            Ok(opened) => self.show_read(purpose, opened, ctx),
            Err(error) => self.open_failed(error, ctx),
        }
    }

    fn show_read(&mut self, purpose: ReadFor, opened: Opened, ctx: &Context) {
        match purpose {
            ReadFor::Opening => {
                self.show(opened);
                self.look_for_recent(ctx);
            }
            ReadFor::Reloading => self.show_reloaded(opened.into_study().1),
            ReadFor::Restoring(offer) => self.show_restored(offer, opened, ctx),
        }
    }

    /// Asks whether the decisions that are not saved may be lost to what is to be done.
    pub(super) fn ask_to_lose(&mut self, postponed: PendingAction) {
        self.postponed = Some(postponed);
        self.goes_on_once_saved = false;
        self.state.forms.shown = Some(FormKind::Unsaved);
    }

    /// Saves the study, and does what waits for it once it is saved.
    pub(super) fn save_and_go_on(&mut self, ctx: &Context) {
        self.state.forms.shown = None;
        self.goes_on_once_saved = true;
        self.save(ctx);
    }

    /// Does what the decisions that are not saved kept waiting.
    pub(super) fn go_on(&mut self, ctx: &Context) {
        self.goes_on_once_saved = false;
        match self.postponed.take() {
            Some(PendingAction::Show(purpose, opened)) => self.show_read(purpose, *opened, ctx),
            Some(PendingAction::Quit) => self.quit(ctx),
            None => {}
        }
    }

    /// Says why nothing was opened, or asks where a study's dataset is; what is open stays.
    fn open_failed(&mut self, error: FileError, ctx: &Context) {
        self.recent.look(None, ctx);
        match error {
            FileError::StudyDataset { path, dataset } => {
                self.state.forms.lost_dataset = Some((path, dataset.to_string()));
                self.state.forms.shown = Some(FormKind::FindDataset);
            }
            error => self.trouble(error.to_string()),
        }
    }

    /// Takes what files and dialogs have answered since the last frame.
    pub(super) fn receive_files(&mut self, ctx: &Context) {
        while let Ok((purpose, read)) = self.readers.receiver.try_recv() {
            match read {
                Ok(opened) => self.answer_opened(purpose, opened, ctx),
                Err(fault) => {
                    self.state.opening = None;
                    self.tell_fault("the reading of a file", &fault);
                }
            }
        }
        while let Some(answer) = self.dialogs.answer() {
            match answer {
                DialogAnswer::Chosen(DialogPurpose::Open, path) => self.open(path, None, ctx),
                DialogAnswer::Chosen(DialogPurpose::SaveStudy, path) => {
                    // The dialog has asked about the name as it was chosen.
                    let is_asked = with_study_extension(path.clone()) == path;
                    self.save_as(path, if is_asked { Existing::Replace } else { Existing::Keep }, ctx);
                }
                DialogAnswer::Chosen(DialogPurpose::ExportFolder, path) => {
                    self.state.forms.export.folder = path.display().to_string();
                }
                // A desktop without dialogs answers like a cancelled one: offer the path as text.
                DialogAnswer::Nothing(DialogPurpose::Open) => self.state.forms.shown = Some(FormKind::Open),
                DialogAnswer::Nothing(DialogPurpose::SaveStudy) => {
                    self.state.forms.save_path = self.proposed_name();
                    self.state.forms.shown = Some(FormKind::Save);
                }
                DialogAnswer::Chosen(DialogPurpose::ModelFolder, path) => {
                    self.assemble(AssemblingCommand::Add(vec![path]), ctx);
                }
                DialogAnswer::Chosen(DialogPurpose::RecordFolder, path) => {
                    self.records(RecordsCommand::Add(vec![path]), ctx);
                }
                DialogAnswer::Nothing(
                    DialogPurpose::ExportFolder | DialogPurpose::ModelFolder | DialogPurpose::RecordFolder,
                ) => {}
            }
        }
    }

    /// Saves the study where it was saved last, or asks where.
    pub(super) fn save(&mut self, ctx: &Context) {
        match self.saved.path.clone() {
            Some(path) => self.save_as(path, Existing::Replace, ctx),
            None => self.dialogs.ask(DialogPurpose::SaveStudy, self.proposed_name(), ctx),
        }
    }

    /// Saves the study to a file; asks before it overwrites one that is not the study's own, unless that was asked already.
    pub(super) fn save_as(&mut self, path: PathBuf, existing: Existing, ctx: &Context) {
        let path = with_study_extension(self.at_home(path));
        let is_own = self.saved.path.as_ref() == Some(&path);
        let place = OutputSet::new(if is_own { Existing::Replace } else { existing }, Vec::new());
        match place.check(&[&path]).and_then(|()| save_study(&self.state.study, &self.loaded, &path)) {
            Ok(()) => {
                self.state.forms.shown = None;
                self.state.study_name = study_name(Some(&path));
                self.state.unsaved = false;
                self.done(format!("saved {}", sanitized_path(&path)));
                self.saved = SavedStudy { path: Some(path), study: Some(self.state.study.clone()) };
                self.keep_unsaved();
                self.look_for_recent(ctx);
                if self.goes_on_once_saved {
                    self.go_on(ctx);
                }
            }
            Err(FileError::Exists { paths }) => {
                self.state.forms.save_path = path.display().to_string();
                self.ask_to_overwrite(&paths, FormKind::Save, Command::SaveStudyAs(path));
            }
            Err(error) => {
                self.goes_on_once_saved = false;
                self.postponed = None;
                self.trouble(error.to_string());
            }
        }
    }

    /// Asks in a form whether to overwrite files, which `command` would do.
    pub(super) fn ask_to_overwrite(&mut self, paths: &[PathBuf], form: FormKind, command: Command) {
        self.state.forms.existing = paths.iter().map(|path| sanitized_path(path)).collect();
        self.state.forms.shown = Some(form);
        self.overwriting = Some(command);
    }

    /// A path as it is typed, with the home directory in the place of `~`.
    pub(super) fn at_home(&self, typed: PathBuf) -> PathBuf {
        at_home(&typed, self.home.as_deref())
    }

    /// What the program reads from, which is never overwritten by results.
    pub(super) fn inputs(&self) -> Vec<PathBuf> {
        self.saved.path.iter().cloned().chain(self.loaded.origin.file()).collect()
    }

    /// A name for the study's file.
    pub(super) fn proposed_name(&self) -> String {
        if let Some(path) = &self.saved.path {
            return path.display().to_string();
        }
        let stem = self.loaded.path().and_then(Path::file_stem).map(|stem| stem.to_string_lossy().into_owned());
        let stem = stem.unwrap_or_else(|| "example".to_owned());
        format!("{}.{STUDY_EXTENSION}", stem.trim_end_matches(".json"))
    }

    /// Asks where to save a table as it is now.
    pub(super) fn ask_save_table(&mut self, name: &str, table: Arc<Table>) {
        let name: String = name.chars().filter(|letter| letter.is_alphanumeric() || *letter == ' ').collect();
        self.state.forms.table = Some(table);
        self.state.forms.table_path = format!("{}.csv", name.replace(' ', "-"));
        self.state.forms.shown = Some(FormKind::SaveTable);
    }

    /// Saves a table of the window as CSV.
    pub(super) fn save_table(&mut self, table: Arc<Table>, path: PathBuf, existing: Existing) {
        let path = self.at_home(path);
        match save_table(&table, &path, OutputSet::new(existing, self.inputs())) {
            Ok(()) => {
                self.state.forms.shown = None;
                self.done(format!("saved {}", sanitized_path(&path)));
            }
            Err(FileError::Exists { paths }) => {
                self.ask_to_overwrite(&paths, FormKind::SaveTable, Command::SaveTable(table, path));
            }
            Err(error) => self.trouble(error.to_string()),
        }
    }

    /// The analysis, where it is complete and of what is decided now; otherwise a sentence that says why not. `what` could be done
    /// again once it is.
    pub(super) fn analysis_to_write(&self, what: &str) -> Result<Arc<Analysis>, String> {
        let results = &self.state.results;
        if results.stopped {
            return Err(format!("{}, for computing was stopped; compute first", self.state.after_stop()));
        }
        if !results.background.proofs.is_empty() {
            return Err(format!("the gains are still being proven; {what} again in a moment, or stop it"));
        }
        let analysis = results.analysis.clone().filter(|_| !results.is_waiting());
        analysis.ok_or_else(|| format!("the newest results are still being computed; {what} again in a moment"))
    }
}

pub(super) fn study_name(path: Option<&Path>) -> String {
    let name = path.and_then(|path| path.file_name()).map(|name| sanitized(&name.to_string_lossy()));
    name.unwrap_or_else(|| "untitled study".to_owned())
}

fn with_study_extension(path: PathBuf) -> PathBuf {
    let name = path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
    if name.ends_with(".json") { path } else { path.with_file_name(format!("{name}.{STUDY_EXTENSION}")) }
}
