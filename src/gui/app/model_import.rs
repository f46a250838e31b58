//! Importing models from files: reads them in a thread and applies the commands of the assembling
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

/// Bytes of values between two progress reports while a file is read.
const TOLD_EVERY: u64 = 16 << 20;

/// Files to read: additional ones, or all of them again with other headings.
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

/// Reports to the window which file is being read.
struct Teller {
    number: u64,
    replies: ReplySender,
    stop: Arc<AtomicBool>,
    /// Bytes of the file's values at the last progress report.
    told: Cell<u64>,
}

impl Teller {
    fn tell(&self, change: impl FnOnce(&mut Option<Reading>) + Send + 'static) {
        let number = self.number;
        self.replies.send(move |app| {
            if let Some(bench) = app
                .state
                .assembling
                .as_mut()
                .filter(|_| app.readers.models.is_newest(number))
            {
                change(&mut bench.reading);
            }
        });
    }
}

impl FolderProgress for Teller {
    fn reading(&self, number: usize, of: usize, name: &str) {
        self.told.set(0);
        let reading = Reading {
            number,
            of,
            name: name.to_owned(),
            taken: 0,
        };
        self.tell(|shown| *shown = Some(reading));
    }

    fn taken(&self, taken: u64) {
        if taken >= self.told.get() + TOLD_EVERY {
            self.told.set(taken);
            self.tell(move |shown| shown.iter_mut().for_each(|reading| reading.taken = taken));
        }
    }

    fn stop(&self) -> Arc<AtomicBool> {
        Arc::clone(&self.stop)
    }
}

impl GdcmApp {
    /// Carries out a command of the assembling view.
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

    /// Reads models in a thread; tables are read with the headings given for them.
    fn read_models(&mut self, sources: Sources) {
        let headings = self.said().map(|rules| rules.headings).unwrap_or_default();
        let reading = self.readers.models.begin();
        let number = reading.number;
        let teller = Teller {
            number,
            replies: self.work.replies.clone(),
            stop: reading.stop,
            told: Cell::new(0),
        };
        let read = move || {
            let found = read_models(sources.paths(), &headings, &teller);
            (sources, found)
        };
        if let Some(bench) = &mut self.state.assembling {
            bench.reading = Some(Reading::default());
        }
        self.in_thread("the reading of models", read, move |app, read| {
            let Some(bench) = app
                .state
                .assembling
                .as_mut()
                .filter(|_| app.readers.models.is_newest(number))
            else {
                return;
            };
            bench.reading = None;
            let Some((sources, found)) = read else { return };
            if let Some(found) = app.unless_error(found) {
                app.take_models(sources, found);
            }
        });
    }

    fn take_models(&mut self, sources: Sources, found: FoundModels) {
        let Some(bench) = &mut self.state.assembling else {
            return;
        };
        let paths = match sources {
            Sources::More(paths) => paths,
            Sources::Again(_) if self.readers.models.is_stopped() => {
                return self.done("stopped: the models are those that were read before".to_owned());
            }
            Sources::Again(paths) => {
                bench.forget_models();
                paths
            }
        };
        let name = paths
            .first()
            .and_then(|path| path.file_name())
            .map(|name| name.to_string_lossy().into_owned());
        let models = found.models.len();
        let files = found.files;
        bench.unused.extend(found.unused_words());
        bench.add(&name.unwrap_or_default(), found.models);
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
        let new = paths
            .into_iter()
            .filter(|path| !bench.sources.contains(path))
            .collect::<Vec<_>>();
        bench.sources.extend(new);
        self.done(format!("{models} models in {files} files"));
    }

    fn take_rules(&mut self, path: PathBuf) {
        let path = self.files.at_home(path);
        let Some((rules, cautions)) = self.unless_error(load_rules(&path)) else {
            return;
        };
        if let Some(bench) = &mut self.state.assembling {
            bench.change(rules);
        }
        let cautions: String = cautions
            .iter()
            .map(|caution| format!("; {caution}"))
            .collect();
        self.done(format!(
            "took the rules of {}{cautions}",
            sanitized_path(&path)
        ));
    }

    fn said(&self) -> Option<Rules> {
        self.state
            .assembling
            .as_ref()
            .map(|bench| bench.assembly().rules().clone())
    }

    /// Writes the rules; asks before overwriting a file.
    fn save_rules(&mut self, path: PathBuf) {
        let Some(rules) = self.said() else { return };
        let path = self.files.at_home(path);
        let saved = self.write_all(&[], |outputs| add_rules(&rules, &path, outputs));
        self.saved_to(
            saved,
            &path,
            FormKind::Models,
            AssemblingCommand::SaveRules(path.clone()).into(),
        );
    }

    /// Writes the dataset and its rules, and opens the dataset; asks before overwriting a file.
    fn make_dataset(&mut self, path: PathBuf) {
        let Some(bench) = &self.state.assembling else {
            return;
        };
        let path = self.files.at_home(path);
        let folder = relative_folder(sources_folder(&bench.sources), &path);
        let Some(dataset) = bench.assembly().dataset(&folder) else {
            return self.notify_error(
                "items are to be completed before the dataset can be made".to_owned(),
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
