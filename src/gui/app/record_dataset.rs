//! Makes a dataset from flight records, in a thread.
//!
//! A record is read as a *table* of columns; its *layout* assigns columns to channels, and its
//! *guess* is what the names of its files tell about the manoeuvre. *Topics* are tables from one
//! log with clocks of their own, which are combined into one record. An *entry* lists a record in
//! the dataset. The *wanted* dataset is the content of the form, as typed.

use std::path::{Path, PathBuf};

use gdcm_io::files::dataset_file::add_dataset;
use gdcm_io::import::record_files::{read_records, relative_entry};
use gdcm_model::dataset::{Band, Dataset};
use gdcm_sysid::records::dataset_of_records::dataset_of_records;
use gdcm_sysid::records::{LaidOutRecord, RecordChannels, TimeSettings, with_topics_joined};

use super::GdcmApp;
use super::document_files::DatasetOfRecords;
use super::readers::SilentProgress;
use crate::gui::commands::records::RecordsCommand;
use crate::gui::state::dataset_form::DatasetForm;
use crate::gui::state::forms::FormKind;
use crate::message::Message;
use crate::message_codes::layout_problem_code;

/// Maximum count of reported problems if no record is suitable: the form lists each on a line of
/// its own, and the first few show what is wrong.
const MOST_PROBLEMS: usize = 6;

/// Sources and settings of a dataset that is to be made from records.
struct DatasetRequest {
    sources: Vec<PathBuf>,
    channels: RecordChannels,
    band: Band,
    /// Path to the dataset file to be written.
    path: PathBuf,
}

/// A dataset made from records, with its origin.
struct MadeDataset {
    dataset: Dataset,
    origin: DatasetOfRecords,
}

impl GdcmApp {
    /// Returns how the displayed dataset was made from records; `None` if it was not.
    pub(super) fn made_of_records(&self) -> Option<&DatasetOfRecords> {
        self.files
            .made_of_records
            .as_ref()
            .filter(|made| self.files.loaded.path() == Some(&made.path))
    }

    /// Opens the form for a new dataset's channels, with a proposal based on the records without a
    /// condition, and on the displayed condition's records that do not fit the open dataset.
    pub(super) fn ask_record_dataset(&mut self) {
        let condition = self.state.condition().id();
        let mut rows: Vec<&LaidOutRecord> = self.state.records.unassigned.iter().collect();
        if let Some(records) = self.state.records.conditions.get(&condition) {
            // Records that fit the open dataset need no other dataset.
            rows.extend(records.rows.iter().filter(|row| row.flight.is_none()));
        }
        let path = match self.state.records.sources.first() {
            Some(source) => source.with_extension("json.gz").display().to_string(),
            None => String::new(),
        };
        self.state.records.dataset_form =
            DatasetForm::proposed(rows, self.state.study.settings.band, path);
        self.state.forms.shown = Some(FormKind::RecordDataset);
    }

    /// Makes a dataset with the requested channels from the added files in a thread, writes it and
    /// opens it.
    pub(super) fn make_record_dataset(&mut self) {
        let records = &mut self.state.records;
        records.dataset_form.problems.clear();
        let (channels, band) = match records.dataset_form.channels() {
            Ok(parsed) => parsed,
            Err(problem) => return records.dataset_form.problems.push(problem),
        };
        let typed = PathBuf::from(records.dataset_form.path.trim());
        let request = DatasetRequest {
            sources: records.sources.clone(),
            channels,
            band,
            path: self.files.at_home(typed),
        };
        let reading = self.readers.record_reader.join();
        let number = reading.number;
        self.state.records.reading = Some("records".to_owned());
        let make = move || request.make(&SilentProgress(reading.stop));
        self.in_thread("the creation of a dataset", make, move |app, made| {
            if !app.readers.record_reader.is_newest(number) {
                return;
            }
            app.state.records.reading = None;
            match made {
                Some(Ok(made)) => app.write_record_dataset(made),
                Some(Err(problems)) => app.state.records.dataset_form.problems = problems,
                None => {}
            }
        });
    }

    /// Writes a dataset and opens it.
    fn write_record_dataset(&mut self, made: MadeDataset) {
        let MadeDataset { dataset, origin } = made;
        let written = self.write_all(&[&origin.path], |outputs| {
            add_dataset(&dataset, &origin.path, outputs)
        });
        match written {
            Ok(()) => {
                self.state.forms.shown = None;
                self.open(origin.path.clone(), None);
                self.files.made_of_records = Some(origin);
            }
            Err(error) => self.notify_not_written(
                error,
                FormKind::RecordDataset,
                RecordsCommand::MakeDataset.into(),
            ),
        }
    }
}

impl DatasetRequest {
    /// Builds a dataset from the records that contain the requested channels:
    ///
    /// 1. read the files; each unreadable file becomes a problem;
    /// 2. combine tables that are topics of one record, and propose a layout for each record;
    /// 3. make each record without problems an entry in the dataset, and take missing channel units
    ///    from it;
    /// 4. build the dataset, and list the problems of what it leaves out.
    ///
    /// # Errors
    /// At most [`MOST_PROBLEMS`] problems in the records, if no record is suitable; otherwise the
    /// fault in reading or in the dataset.
    fn make(self, progress: &SilentProgress) -> Result<MadeDataset, Vec<Message>> {
        let Self {
            sources,
            mut channels,
            band,
            path,
        } = self;
        // Step 1.
        let read = read_records(&sources, progress).map_err(|error| vec![error.into()])?;
        let mut problems = Vec::new();
        for fault in read.faults {
            problems.push(Message::new("not-read", fault));
        }
        let mut entries = Vec::new();
        // Steps 2 and 3.
        for table in with_topics_joined(read.tables, &channels, &TimeSettings::default()) {
            let (row, _) = LaidOutRecord::proposed(table, &channels, &TimeSettings::default());
            for problem in &row.problems {
                let text = format!("{}: {problem}", row.table.name);
                problems.push(Message::new(layout_problem_code(problem), text));
            }
            if row.problems.is_empty() {
                channels.take_units(&row.layout, &row.table);
                let entry = row
                    .layout
                    .condition_record(&row.table, &row.guess, &channels);
                entries.push(relative_entry(entry, &sources, &path));
            }
        }
        // Step 4.
        if entries.is_empty() {
            problems.truncate(MOST_PROBLEMS);
            return Err(problems);
        }
        let dataset = dataset_of_records(&dataset_name(&path), &channels, band, entries)
            .map_err(|error| vec![Message::new("wrong-dataset", error.to_string())])?;
        let left_out = problems
            .into_iter()
            .map(|problem| format!("left out of the dataset: {}", problem.text))
            .collect();
        let origin = DatasetOfRecords {
            path,
            channels,
            left_out,
        };
        Ok(MadeDataset { dataset, origin })
    }
}

/// Returns the file name up to the first dot.
fn dataset_name(path: &Path) -> String {
    let Some(name) = path.file_name() else {
        return String::new();
    };
    let name = name.to_string_lossy();
    name.split('.').next().unwrap_or_default().to_owned()
}
