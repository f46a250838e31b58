//! Reads models from files in a thread, and adds them to the import.
//!
//! The *import* lists the models from which a dataset is to be assembled, and messages: *faults*
//! about unreadable content, *ignored* content that is not a model, *unused* content in model
//! files. A reading may be stopped, or replaced by a newer one, whose number is larger; see
//! `readers.rs`.

use std::cell::Cell;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use gdcm_io::files::rules_file::rules_path;
use gdcm_io::import::model_files::FoundModels;
use gdcm_io::{FolderProgress, read_models};
use gdcm_model::number_format::counted;

use super::GdcmApp;
use super::threads::ReplySender;
use crate::gui::state::assembling::ReadingProgress;
use crate::message::Message;

/// Files to read.
#[derive(Clone, Debug)]
pub(super) enum Sources {
    /// Additional files.
    More(Vec<PathBuf>),
    /// All files of the import, with changed column headings.
    Again(Vec<PathBuf>),
}

impl Sources {
    fn paths(&self) -> &[PathBuf] {
        let (Sources::More(paths) | Sources::Again(paths)) = self;
        paths
    }
}

impl GdcmApp {
    /// Reads models in a thread; tables are read with the column headings declared in the rules.
    pub(super) fn read_models(&mut self, sources: Sources) {
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
            reported_bytes: Cell::new(0),
        };
        let read = move || {
            let found = read_models(sources.paths(), &headings, &report);
            (sources, found)
        };
        if let Some(import) = &mut self.state.assembling {
            import.reading = Some(ReadingProgress::default());
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

    /// Adds the models found in the files to the import. Additional files count as far as they were
    /// read before a stop. Files read again replace all models, so after a stop they are ignored.
    fn take_models(&mut self, sources: Sources, found: FoundModels) {
        let Some(import) = &mut self.state.assembling else {
            return;
        };
        let paths = match sources {
            Sources::More(paths) => paths,
            Sources::Again(_) if self.readers.models.is_stopped() => {
                return self.notify_done(Message::new(
                    "reading-stopped",
                    "stopped: the models read before are kept",
                ));
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
        import.unused.extend(found.unused_variable_lines());
        import.add(&name, found.models);
        import.faults.extend(found.faults);
        import.ignored.extend(found.ignored);
        import.tables.extend(found.tables);
        // Units of columns that follow neither from headings nor from values.
        import.missing_units.extend(found.missing_units);
        // Propose paths for dataset and rules: beside the first file or folder, with its name.
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
        let text = format!(
            "read {} from {}",
            counted(models, "model"),
            counted(files, "file")
        );
        self.notify_done(Message::new("models-read", text));
    }
}

/// Bytes read between two progress reports.
const REPORT_EVERY: u64 = 16 << 20;

/// Informs the window which file is being read, and how far.
struct ReadingReport {
    number: u64,
    replies: ReplySender,
    stop: Arc<AtomicBool>,
    /// Bytes of the current file that had been read at the last progress report.
    reported_bytes: Cell<u64>,
}

impl ReadingReport {
    /// Changes the displayed progress, unless a newer reading has begun or the import has ended.
    fn send(&self, change: impl FnOnce(&mut Option<ReadingProgress>) + Send + 'static) {
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
        self.reported_bytes.set(0);
        let reading = ReadingProgress {
            number,
            total,
            name: name.to_owned(),
            read_bytes: 0,
        };
        self.send(|shown| *shown = Some(reading));
    }

    fn taken(&self, read_bytes: u64) {
        if read_bytes >= self.reported_bytes.get() + REPORT_EVERY {
            self.reported_bytes.set(read_bytes);
            self.send(move |shown| {
                if let Some(reading) = shown {
                    reading.read_bytes = read_bytes;
                }
            });
        }
    }

    fn stop(&self) -> Arc<AtomicBool> {
        Arc::clone(&self.stop)
    }
}
