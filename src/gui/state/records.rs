//! State of the Records view: flight records by condition.

use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;

use gdcm_io::Example;
use gdcm_model::dataset::ConditionId;
use gdcm_study::jobs::identification_jobs::IdentifyJob;
use gdcm_study::results::required_modes::KnownPoles;
use gdcm_study::results::time_histories::HistoryRecords;
use gdcm_sysid::records::LayoutProblem;

pub use super::condition_records::ConditionRecords;
pub use super::records_page::{RecordsPage, TimeModel};
pub use super::wanted_dataset::WantedDataset;
use crate::gui::widgets::tables::Sorting;

/// State of the records before or after an edit, which an undo or redo step restores. Only the
/// conditions changed by the edit are included.
#[derive(Clone, Debug, Default)]
pub struct RecordsBefore {
    /// Records by condition; `None` for a condition without loaded records.
    pub conditions: BTreeMap<ConditionId, Option<ConditionRecords>>,
    /// The added files and folders, if the edit changes them.
    pub sources: Option<Vec<PathBuf>>,
}

/// State of the Records view. Not saved: records stay in their files.
#[derive(Clone, Debug, Default)]
pub struct RecordsState {
    /// Records by condition; without an entry, the records of a condition are not loaded yet.
    pub conditions: BTreeMap<ConditionId, ConditionRecords>,
    /// The example that the dataset is, if any: its records are part of the program.
    pub example: Option<Example>,
    pub page: RecordsPage,
    /// Sorting of the table of conditions.
    pub sorting: Sorting,
    /// Models whose responses to the recorded inputs are drawn.
    pub time_models: BTreeSet<TimeModel>,
    /// Whether dragging in the time charts selects parts of the record.
    pub chooses_parts: bool,
    /// Index of the input shown by the spectrogram.
    pub spectrogram: Option<usize>,
    /// Search setting whose field is to be focused.
    pub advanced_field: Option<&'static str>,
    /// Typed path of record files.
    pub path: String,
    /// The added files and folders.
    pub sources: Vec<PathBuf>,
    /// Paths of the files read, by SHA-256, to recognise changed files.
    pub read_from: BTreeMap<String, PathBuf>,
    /// Form for a dataset made from the displayed records.
    pub wanted: WantedDataset,
    /// Name of the files being read.
    pub reading: Option<String>,
    /// Messages about unreadable content.
    pub faults: Vec<String>,
    /// Running and waiting identification jobs, in the order of the requests.
    pub running: Vec<IdentifyJob>,
    /// Number of conditions requested since the queue was last empty.
    pub requested_count: usize,
}

impl RecordsState {
    /// Returns a copy of the records of the given conditions, to be restored by an undo step.
    pub fn before(&self, conditions: impl IntoIterator<Item = ConditionId>) -> RecordsBefore {
        let conditions = conditions
            .into_iter()
            .map(|id| (id, self.conditions.get(&id).cloned()))
            .collect();
        RecordsBefore {
            conditions,
            sources: None,
        }
    }

    /// Restores the records before or after an edit; returns the replaced records.
    pub fn exchange(&mut self, before: RecordsBefore) -> RecordsBefore {
        let mut now = RecordsBefore::default();
        for (id, records) in before.conditions {
            let present = self.conditions.remove(&id);
            if let Some(records) = records {
                self.conditions
                    .insert(id, records.restored(present.clone()));
            }
            now.conditions.insert(id, present);
        }
        now.sources = before
            .sources
            .map(|sources| std::mem::replace(&mut self.sources, sources));
        now
    }

    /// Returns the channels that lack a unit, with the numbers of affected records and conditions;
    /// `None` if no unit is missing.
    pub fn open_units(&self) -> Option<OpenUnits> {
        let mut open = OpenUnits::default();
        for (id, records) in &self.conditions {
            let before = open.records;
            for row in &records.rows {
                if open.add_channels(&row.problems) {
                    open.records += 1;
                }
            }
            if open.records > before {
                open.conditions += 1;
                open.first.get_or_insert(*id);
            }
        }
        if open.records == 0 {
            return None;
        }
        Some(open)
    }

    /// Returns the conditions that have records in use.
    pub fn conditions_in_use(&self) -> Vec<ConditionId> {
        let mut conditions = Vec::new();
        for (id, records) in &self.conditions {
            if records.used_rows().next().is_some() {
                conditions.push(*id);
            }
        }
        conditions
    }

    /// Returns the poles identified in this session, condition by condition.
    pub fn known_poles(&self) -> KnownPoles {
        self.conditions
            .iter()
            .filter_map(|(id, records)| Some((*id, records.identification()?.poles.clone())))
            .collect()
    }

    /// Returns the flight records in use, by condition.
    pub fn history_records(&self) -> Vec<HistoryRecords> {
        let mut histories = Vec::new();
        for (id, records) in &self.conditions {
            let history = HistoryRecords::from_used(*id, &records.rows, records.preparation());
            if !history.records.is_empty() {
                histories.push(history);
            }
        }
        histories
    }

    /// Returns the held-out records in use, of the conditions that have some.
    pub fn held_out_records(&self) -> Vec<HistoryRecords> {
        let mut histories = self.history_records();
        for history in &mut histories {
            history.records.retain(|record| record.held_out);
        }
        histories.retain(|history| !history.records.is_empty());
        histories
    }

    /// Adds an identification job; it replaces a waiting or running job for the same condition.
    pub fn request_job(&mut self, job: IdentifyJob) {
        let before = self.running.len();
        self.running
            .retain(|other| other.condition != job.condition);
        if self.running.len() == before {
            self.requested_count += 1;
        }
        self.running.push(job);
    }

    /// Returns the running or waiting job for a condition.
    pub fn job_of(&self, condition: ConditionId) -> Option<&IdentifyJob> {
        self.running.iter().find(|job| job.condition == condition)
    }

    /// Returns the running job, once it has reported its first step.
    pub fn under_way(&self) -> Option<&IdentifyJob> {
        self.running.iter().find(|job| !job.news().step.is_empty())
    }

    /// Returns the identification jobs, the displayed condition first.
    pub fn by_urgency(&self, shown: ConditionId) -> Vec<IdentifyJob> {
        let mut jobs = self.running.clone();
        jobs.sort_by_key(|job| job.condition != shown);
        jobs
    }
}

/// Channels whose unit is missing in a record, summed over all records.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct OpenUnits {
    /// Names of the channels, with their units in the dataset.
    pub channels: Vec<(String, String)>,
    /// Number of affected records.
    pub records: usize,
    /// Number of affected conditions.
    pub conditions: usize,
    /// The first affected condition.
    pub first: Option<ConditionId>,
}

impl OpenUnits {
    /// Adds the channels whose unit is missing in a record; returns whether there are any.
    fn add_channels(&mut self, problems: &[LayoutProblem]) -> bool {
        let mut is_open = false;
        for problem in problems {
            let LayoutProblem::UnsaidUnit { channel, unit, .. } = problem else {
                continue;
            };
            is_open = true;
            if !self.channels.iter().any(|(known, _)| known == channel) {
                self.channels.push((channel.clone(), unit.clone()));
            }
        }
        is_open
    }
}
