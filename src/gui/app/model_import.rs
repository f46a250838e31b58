//! Import of models from files: reads them in a thread and carries out the commands of the import
//! view.

use std::cell::Cell;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use gdcm_io::files::dataset_file::add_dataset;
use gdcm_io::files::rules_file::{add_rules, load_rules, rules_path};
use gdcm_io::files::study_file::relative_folder;
use gdcm_io::formats::sources_folder;
use gdcm_io::import::model_files::FoundModels;
use gdcm_io::{FolderProgress, read_models};
use gdcm_model::assembly::Rules;
use gdcm_model::message_text::sanitized_path;

use super::GdcmApp;
use super::dialogs::DialogPurpose;
use super::threads::ReplySender;
use crate::gui::commands::assembling::AssemblingCommand;
use crate::gui::state::assembling::{AssemblyState, Reading};
use crate::gui::state::forms::FormKind;

/// Number of bytes read between two progress reports.
const REPORT_EVERY: u64 = 16 << 20;

/// Files to read: additional files, or all files again with other column headings.
#[derive(Clone, Debug)]
enum Sources {
    More(Vec<PathBuf>),
    Again(Vec<PathBuf>),
}

impl Sources {
    fn paths(&self) -> &[PathBuf] {
        let (Sources::More(paths) | Sources::Again(paths)) = self;
        paths
    }
}

/// Informs the window which file is being read.
struct ReadingReport {
    number: u64,
    replies: ReplySender,
    stop: Arc<AtomicBool>,
    /// Bytes read at the last progress report.
    reported: Cell<u64>,
}

impl ReadingReport {
    /// Changes the displayed progress, unless a newer reading has begun.
    fn send(&self, change: impl FnOnce(&mut Option<Reading>) + Send + 'static) {
        let number = self.number;
        self.replies.send(move |app| {
            if app.readers.models.is_newest(number)
                && let Some(bench) = &mut app.state.assembling
            {
                change(&mut bench.reading);
            }
        });
    }
}

impl FolderProgress for ReadingReport {
    fn reading(&self, number: usize, total: usize, name: &str) {
        self.reported.set(0);
        let reading = Reading {
            number,
            total,
            name: name.to_owned(),
            taken: 0,
        };
        self.send(|shown| *shown = Some(reading));
    }

    fn taken(&self, taken: u64) {
        if taken >= self.reported.get() + REPORT_EVERY {
            self.reported.set(taken);
            self.send(move |shown| {
                if let Some(reading) = shown {
                    reading.taken = taken;
                }
            });
        }
    }

    fn stop(&self) -> Arc<AtomicBool> {
        Arc::clone(&self.stop)
    }
}

impl GdcmApp {
    /// Carries out a command of the import view.
    pub(super) fn assemble(&mut self, command: AssemblingCommand) {
        let bench = self
            .state
            .assembling
            .get_or_insert_with(AssemblyState::default);
        let headings = bench.assembly().rules().headings.clone();
        match command {
            AssemblingCommand::Open => {}
            AssemblingCommand::Close => {
                self.readers.models.give_up();
                self.state.assembling = None;
            }
            AssemblingCommand::AskFolder => {
                self.ask_path(DialogPurpose::ModelFolder, String::new())
            }
            AssemblingCommand::Add(paths) => {
                let paths = paths
                    .into_iter()
                    .map(|path| self.files.at_home(path))
                    .collect();
                self.read_models(Sources::More(paths));
            }
            AssemblingCommand::StopReading => self.readers.models.stop(),
            AssemblingCommand::Change(rules) => bench.change(*rules),
            AssemblingCommand::Undo => bench.undo(),
            AssemblingCommand::Redo => bench.redo(),
            AssemblingCommand::Select(part) => bench.selected = part,
            AssemblingCommand::Sort(column) => bench.sorting = bench.sorting.clicked(column),
            AssemblingCommand::ShowResponse(place) => bench.preview.response = place,
            AssemblingCommand::LoadRules(path) => self.take_rules(path),
            AssemblingCommand::SaveRules(path) => self.save_rules(path),
            AssemblingCommand::MakeDataset(path) => self.make_dataset(path),
        }
        if let Some(bench) = &self.state.assembling
            && bench.assembly().rules().headings != headings
        {
            self.read_models(Sources::Again(bench.sources.clone()));
        }
    }

    /// Reads models in a thread; tables are read with the column headings declared in the rules.
    fn read_models(&mut self, sources: Sources) {
        let headings = match self.import_rules() {
            Some(rules) => rules.headings,
            None => Default::default(),
        };
        let reading = self.readers.models.begin();
        let number = reading.number;
        let report = ReadingReport {
            number,
            replies: self.work.replies.clone(),
            stop: reading.stop,
            reported: Cell::new(0),
        };
        let read = move || {
            let found = read_models(sources.paths(), &headings, &report);
            (sources, found)
        };
        if let Some(bench) = &mut self.state.assembling {
            bench.reading = Some(Reading::default());
        }
        self.in_thread("the reading of models", read, move |app, read| {
            if !app.readers.models.is_newest(number) {
                return;
            }
            let Some(bench) = &mut app.state.assembling else {
                return;
            };
            bench.reading = None;
            let Some((sources, found)) = read else { return };
            if let Some(found) = app.unless_error(found) {
                app.take_models(sources, found);
            }
        });
    }

    /// Adds the models that were read to the import.
    fn take_models(&mut self, sources: Sources, found: FoundModels) {
        let Some(bench) = &mut self.state.assembling else {
            return;
        };
        let paths = match sources {
            Sources::More(paths) => paths,
            Sources::Again(_) if self.readers.models.is_stopped() => {
                return self.done("stopped: the models read before are kept".to_owned());
            }
            Sources::Again(paths) => {
                bench.forget_models();
                paths
            }
        };
        let name = match paths.first().and_then(|path| path.file_name()) {
            Some(name) => name.to_string_lossy().into_owned(),
            None => String::new(),
        };
        let models = found.models.len();
        let files = found.files;
        bench.unused.extend(found.unused_words());
        bench.add(&name, found.models);
        bench.faults.extend(found.faults);
        bench.ignored.extend(found.ignored);
        bench.tables.extend(found.tables);
        bench.unsaid.extend(found.unsaid);
        if bench.dataset_path.is_empty()
            && let Some(first) = paths.first()
        {
            bench.dataset_path = format!("{}.json.gz", first.with_extension("").display());
            bench.rules_path = rules_path(Path::new(&bench.dataset_path))
                .display()
                .to_string();
        }
        let mut new = paths;
        new.retain(|path| !bench.sources.contains(path));
        bench.sources.extend(new);
        self.done(format!("{models} models in {files} files"));
    }

    /// Reads rules from a file.
    fn take_rules(&mut self, path: PathBuf) {
        let path = self.files.at_home(path);
        let Some((rules, cautions)) = self.unless_error(load_rules(&path)) else {
            return;
        };
        if let Some(bench) = &mut self.state.assembling {
            bench.change(rules);
        }
        let mut message = format!("applied the rules in {}", sanitized_path(&path));
        for caution in cautions {
            message.push_str(&format!("; {caution}"));
        }
        self.done(message);
    }

    fn import_rules(&self) -> Option<Rules> {
        let bench = self.state.assembling.as_ref()?;
        Some(bench.assembly().rules().clone())
    }

    /// Writes the rules to a file; asks before overwriting.
    fn save_rules(&mut self, path: PathBuf) {
        let Some(rules) = self.import_rules() else {
            return;
        };
        let path = self.files.at_home(path);
        let saved = self.write_all(&[], |outputs| add_rules(&rules, &path, outputs));
        self.saved_to(
            saved,
            &path,
            FormKind::Models,
            AssemblingCommand::SaveRules(path.clone()).into(),
        );
    }

    /// Writes the dataset and its rules, and opens the dataset; asks before overwriting.
    fn make_dataset(&mut self, path: PathBuf) {
        let Some(bench) = &self.state.assembling else {
            return;
        };
        let path = self.files.at_home(path);
        let folder = relative_folder(sources_folder(&bench.sources), &path);
        let Some(dataset) = bench.assembly().dataset(&folder) else {
            return self.notify_error(
                "complete the marked items before the dataset can be made".to_owned(),
            );
        };
        let rules = bench.assembly().rules().clone();
        let beside = rules_path(&path);
        let written = self.write_all(&[&path, &beside], |outputs| {
            add_dataset(&dataset, &path, outputs)?;
            add_rules(&rules, &beside, outputs)
        });
        match written {
            Ok(()) => {
                self.state.forms.shown = None;
                self.state.assembling = None;
                self.open(path, None);
            }
            Err(error) => self.written(
                Err(error),
                FormKind::Models,
                AssemblingCommand::MakeDataset(path).into(),
            ),
        }
    }
}
