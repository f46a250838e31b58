//! Opening, saving and exporting.

use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, Sender, channel};

use egui::Context;

use crate::io::{
    DatasetOrigin, Existing, FileError, LoadedDataset, Opened, OutputSet, STUDY_EXTENSION, embedded_example, load_any,
    open_study_of, plain, plain_path, save_study, write_results,
};
use crate::study::{Difference, Study};
use crate::view::command::{Command, FormKind};
use crate::view::state::State;

use super::dialogs::{DialogAnswer, DialogPurpose};
use super::window::GdcmApp;

/// The study as it was saved last.
#[derive(Clone, Debug)]
pub(super) struct SavedStudy {
    /// Where; nowhere yet for a new study.
    pub(super) path: Option<PathBuf>,
    /// What was saved, or what a new study starts from.
    pub(super) study: Study,
}

/// The threads that read files, and where their answers arrive.
pub(super) struct Readers {
    sender: Sender<Result<Opened, FileError>>,
    receiver: Receiver<Result<Opened, FileError>>,
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
        (state, loaded, SavedStudy { path, study })
    }

    /// Shows what was opened in place of what is open.
    fn show(&mut self, opened: Opened) {
        let (state, loaded, saved) = Self::parts_of(opened);
        let requested = self.state.results.requested;
        let name = loaded.origin.to_string();
        self.state = state;
        // Request numbers go on, so that late answers about the old dataset are told apart.
        self.state.results.requested = requested;
        self.state.results.received = requested;
        self.loaded = loaded;
        self.saved = saved;
        self.done(format!("opened {name}"));
    }

    /// Reads a file in a thread of its own; what is open stays until it is read. The dataset of a study may have moved.
    pub(super) fn open(&mut self, path: PathBuf, moved: Option<PathBuf>, ctx: &Context) {
        self.state.forms.shown = None;
        self.state.opening = Some(plain_path(&path));
        let (sender, wake) = (self.readers.sender.clone(), ctx.clone());
        let read = move || {
            // The window may be gone by now.
            let _ = sender.send(match moved {
                Some(dataset) => open_study_of(&path, &dataset).map(Opened::Study),
                None => load_any(&path),
            });
            wake.request_repaint();
        };
        if let Err(error) = std::thread::Builder::new().name("reading".to_owned()).spawn(read) {
            self.state.opening = None;
            self.trouble(format!("the file cannot be read: {error}"));
        }
    }

    pub(super) fn open_example(&mut self) {
        self.answer_opened(embedded_example().map(Opened::Dataset));
    }

    fn answer_opened(&mut self, opened: Result<Opened, FileError>) {
        self.state.opening = None;
        match opened {
            Ok(opened) => self.show(opened),
            Err(FileError::StudyDataset { path, dataset }) => {
                self.state.forms.lost_dataset = Some((path, dataset.to_string()));
                self.state.forms.shown = Some(FormKind::FindDataset);
            }
            Err(error) => self.trouble(error.to_string()),
        }
    }

    /// Takes what files and dialogs have answered since the last frame.
    pub(super) fn receive_files(&mut self, ctx: &Context) {
        while let Ok(opened) = self.readers.receiver.try_recv() {
            self.answer_opened(opened);
        }
        while let Some(answer) = self.dialogs.answer() {
            match answer {
                DialogAnswer::Chosen(DialogPurpose::Open, path) => self.open(path, None, ctx),
                DialogAnswer::Chosen(DialogPurpose::SaveStudy, path) => {
                    // The dialog has asked about the name as it was chosen.
                    let is_asked = with_study_extension(path.clone()) == path;
                    self.save_as(path, if is_asked { Existing::Replace } else { Existing::Keep });
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
                DialogAnswer::Nothing(DialogPurpose::ExportFolder) => {}
            }
        }
    }

    /// Saves the study where it was saved last, or asks where.
    pub(super) fn save(&mut self, ctx: &Context) {
        match self.saved.path.clone() {
            Some(path) => self.save_as(path, Existing::Replace),
            None => self.dialogs.ask(DialogPurpose::SaveStudy, self.proposed_name(), ctx),
        }
    }

    /// Saves the study to a file; asks before it overwrites one that is not the study's own, unless that was asked already.
    pub(super) fn save_as(&mut self, path: PathBuf, existing: Existing) {
        let path = with_study_extension(path);
        let is_own = self.saved.path.as_ref() == Some(&path);
        let place = OutputSet::new(if is_own { Existing::Replace } else { existing }, Vec::new());
        match place.check(&[&path]).and_then(|()| save_study(&self.state.study, &self.loaded, &path)) {
            Ok(()) => {
                self.state.forms.shown = None;
                self.state.study_name = study_name(Some(&path));
                self.state.unsaved = false;
                self.done(format!("saved {}", plain_path(&path)));
                self.saved = SavedStudy { path: Some(path), study: self.state.study.clone() };
            }
            Err(FileError::Exists { paths }) => {
                self.state.forms.save_path = path.display().to_string();
                self.ask_to_overwrite(&paths, FormKind::Save, Command::SaveStudyAs(path));
            }
            Err(error) => self.trouble(error.to_string()),
        }
    }

    /// Asks in a form whether to overwrite files, which `command` would do.
    fn ask_to_overwrite(&mut self, paths: &[PathBuf], form: FormKind, command: Command) {
        self.state.forms.existing = paths.iter().map(|path| plain_path(path)).collect();
        self.state.forms.shown = Some(form);
        self.postponed = Some(command);
    }

    /// A name for the study's file.
    pub(super) fn proposed_name(&self) -> String {
        if let Some(path) = &self.saved.path {
            return path.display().to_string();
        }
        let stem = match &self.loaded.origin {
            DatasetOrigin::File(path) => path.file_stem().map(|stem| stem.to_string_lossy().into_owned()),
            DatasetOrigin::EmbeddedExample => None,
        };
        let stem = stem.unwrap_or_else(|| "example".to_owned());
        format!("{}.{STUDY_EXTENSION}", stem.trim_end_matches(".json"))
    }

    /// Writes the corrections of the conditions chosen in the form.
    pub(super) fn export(&mut self, existing: Existing) {
        if self.state.results.stopped {
            let left = self.state.after_stop();
            return self.trouble(format!("{left}, for computing was stopped; compute first"));
        }
        if self.state.results.is_waiting() {
            return self.trouble("the newest results are still being computed; export again in a moment".to_owned());
        }
        let Some(analysis) = self.state.results.analysis.clone() else {
            return;
        };
        let form = &self.state.forms.export;
        let chosen = form.chosen.clone();
        let folder = PathBuf::from(form.folder.trim());
        let inputs = self.saved.path.iter().cloned().chain(self.loaded.origin.file());
        let outputs = OutputSet::new(existing, inputs.collect());
        match write_results(&analysis, &self.loaded.sha256, &chosen, &folder, outputs) {
            Ok(()) => {
                self.state.forms.shown = None;
                self.done(format!("exported {} conditions to {}", chosen.len(), plain_path(&folder)));
            }
            Err(FileError::Exists { paths }) => self.ask_to_overwrite(&paths, FormKind::Export, Command::Export),
            Err(error) => self.trouble(error.to_string()),
        }
    }
}

fn study_name(path: Option<&Path>) -> String {
    let name = path.and_then(|path| path.file_name()).map(|name| plain(&name.to_string_lossy()));
    name.unwrap_or_else(|| "untitled study".to_owned())
}

fn with_study_extension(path: PathBuf) -> PathBuf {
    let name = path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
    if name.ends_with(".json") { path } else { path.with_file_name(format!("{name}.{STUDY_EXTENSION}")) }
}
