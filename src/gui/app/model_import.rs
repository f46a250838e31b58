//! Import of models from files: reads them in a thread and carries out the commands of the import
//! view.

use std::cell::Cell;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use gdcm_io::files::dataset_file::add_dataset;
use gdcm_io::files::rules_file::{add_rules, load_rules, rules_path};
use gdcm_io::formats::sources_folder;
use gdcm_io::import::model_files::FoundModels;
use gdcm_io::relative_folder::relative_folder;
use gdcm_io::{FolderProgress, read_models};
use gdcm_model::assembly::Rules;
use gdcm_model::message_text::sanitized_path;
use gdcm_model::number_format::counted;

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
                && let Some(import) = &mut app.state.assembling
            {
                change(&mut import.reading);
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
    pub(super) fn carry_out_assembling(&mut self, command: AssemblingCommand) {
        let import = self
            .state
            .assembling
            .get_or_insert_with(AssemblyState::default);
        let headings = import.assembly().rules().headings.clone();
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
            AssemblingCommand::Change(rules) => import.change(*rules),
            AssemblingCommand::Undo => import.undo(),
            AssemblingCommand::Redo => import.redo(),
            AssemblingCommand::Select(part) => import.selected = part,
            AssemblingCommand::Sort(column) => import.sorting = import.sorting.clicked(column),
            AssemblingCommand::ShowResponse(place) => import.preview.response = place,
            AssemblingCommand::LoadRules(path) => self.take_rules(path),
            AssemblingCommand::SaveRules(path) => self.save_rules(path),
            AssemblingCommand::MakeDataset(path) => self.make_dataset(path),
        }
        if let Some(import) = &self.state.assembling
            && import.assembly().rules().headings != headings
        {
            self.read_models(Sources::Again(import.sources.clone()));
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
        if let Some(import) = &mut self.state.assembling {
            import.reading = Some(Reading::default());
        }
        self.in_thread("the reading of models", read, move |app, read| {
            if !app.readers.models.is_newest(number) {
                return;
            }
            let Some(import) = &mut app.state.assembling else {
                return;
            };
            import.reading = None;
            let Some((sources, found)) = read else { return };
            if let Some(found) = app.value_or_notify(found) {
                app.take_models(sources, found);
            }
        });
    }

    /// Adds the models that were read to the import.
    fn take_models(&mut self, sources: Sources, found: FoundModels) {
        let Some(import) = &mut self.state.assembling else {
            return;
        };
        let paths = match sources {
            Sources::More(paths) => paths,
            Sources::Again(_) if self.readers.models.is_stopped() => {
                return self.notify_done("stopped: the models read before are kept".to_owned());
            }
            Sources::Again(paths) => {
                import.forget_models();
                paths
            }
        };
        let name = match paths.first().and_then(|path| path.file_name()) {
            Some(name) => name.to_string_lossy().into_owned(),
            None => String::new(),
        };
        let models = found.models.len();
        let files = found.files;
        import.unused.extend(found.unused_words());
        import.add(&name, found.models);
        import.faults.extend(found.faults);
        import.ignored.extend(found.ignored);
        import.tables.extend(found.tables);
        import.unsaid.extend(found.unsaid);
        if import.dataset_path.is_empty()
            && let Some(first) = paths.first()
        {
            import.dataset_path = format!("{}.json.gz", first.with_extension("").display());
            import.rules_path = rules_path(Path::new(&import.dataset_path))
                .display()
                .to_string();
        }
        let mut new = paths;
        new.retain(|path| !import.sources.contains(path));
        import.sources.extend(new);
        self.notify_done(format!(
            "{} in {}",
            counted(models, "model"),
            counted(files, "file")
        ));
    }

    /// Reads rules from a file.
    fn take_rules(&mut self, path: PathBuf) {
        let path = self.files.at_home(path);
        let Some((rules, cautions)) = self.value_or_notify(load_rules(&path)) else {
            return;
        };
        if let Some(import) = &mut self.state.assembling {
            import.change(rules);
        }
        let mut message = format!("applied the rules in {}", sanitized_path(&path));
        for caution in cautions {
            message.push_str(&format!("; {caution}"));
        }
        self.notify_done(message);
    }

    fn import_rules(&self) -> Option<Rules> {
        let import = self.state.assembling.as_ref()?;
        Some(import.assembly().rules().clone())
    }

    /// Writes the rules to a file; asks before overwriting.
    fn save_rules(&mut self, path: PathBuf) {
        let Some(rules) = self.import_rules() else {
            return;
        };
        let path = self.files.at_home(path);
        let saved = self.write_all(&[], |outputs| add_rules(&rules, &path, outputs));
        self.notify_saved(
            saved,
            &path,
            FormKind::Models,
            AssemblingCommand::SaveRules(path.clone()).into(),
        );
    }

    /// Writes the dataset and its rules, and opens the dataset; asks before overwriting.
    fn make_dataset(&mut self, path: PathBuf) {
        let Some(import) = &self.state.assembling else {
            return;
        };
        let path = self.files.at_home(path);
        let folder = relative_folder(sources_folder(&import.sources), &path);
        let Some(dataset) = import.assembly().dataset(&folder) else {
            return self.notify_error(
                "complete the marked items before the dataset can be made".to_owned(),
            );
        };
        let rules = import.assembly().rules().clone();
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
            Err(error) => self.notify_written(
                Err(error),
                FormKind::Models,
                AssemblingCommand::MakeDataset(path).into(),
            ),
        }
    }
}
