//! State behind the Records view: flight records by condition.
//!
//! A row is a record, or a part (time span) of one. An identification job ([`IdentifyJob`])
//! identifies models from the records that a condition uses.

use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;

use gdcm_io::Example;
use gdcm_model::dataset::ConditionId;
use gdcm_study::jobs::identification_jobs::IdentifyJob;
use gdcm_study::results::required_modes::IdentifiedPoles;
use gdcm_study::results::time_histories::HistoryRecords;
use gdcm_sysid::records::LaidOutRecord;

pub use super::condition_records::ConditionRecords;
pub use super::dataset_form::DatasetForm;
pub use super::records_page::RecordsPage;
pub use super::time_role::TimeRole;

/// The records before or after an edit, which an undo or redo step restores. Only the conditions
/// changed by the edit are included.
#[derive(Clone, Debug, Default)]
pub struct RecordsSnapshot {
    /// Records by condition; `None` for a condition without loaded records.
    pub conditions: BTreeMap<ConditionId, Option<ConditionRecords>>,
    /// The added files and folders, if the edit changes them.
    pub sources: Option<Vec<PathBuf>>,
    /// Records without a condition, if the edit changes them.
    pub unassigned: Option<Vec<LaidOutRecord>>,
}

/// Section below the records that can be unfolded.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum RecordsFold {
    /// Columns and units in all records.
    Columns,
    /// Settings for identifying the displayed condition.
    Settings,
}

/// Returns whether a job runs: a running job reports its steps, a waiting job has none.
pub fn has_started(job: &IdentifyJob) -> bool {
    !job.news().step.is_empty()
}

/// State behind the Records view. Not saved: records stay in their files.
#[derive(Clone, Debug, Default)]
pub struct RecordsState {
    /// Records by condition; without an entry, a condition's records are not loaded yet.
    pub conditions: BTreeMap<ConditionId, ConditionRecords>,
    /// Embedded example, if the dataset is one: its records are part of the program.
    pub example: Option<Example>,
    pub page: RecordsPage,
    /// Roles whose curves over time are hidden.
    pub hidden_roles: BTreeSet<TimeRole>,
    /// Outputs drawn over time below the output in focus, by index, as far as there is room; `None`
    /// selects all others.
    pub more_outputs: Option<Vec<usize>>,
    /// Index of the input shown by the spectrogram; `None` hides it.
    pub spectrogram: Option<usize>,
    /// Search setting whose field is to be focused.
    pub advanced_field: Option<&'static str>,
    /// Section that is unfolded below the records.
    pub open_fold: Option<RecordsFold>,
    /// Added records that could not be assigned to a condition in the dataset.
    pub unassigned: Vec<LaidOutRecord>,
    /// The added files and folders.
    pub sources: Vec<PathBuf>,
    /// Paths to the files read, by SHA-256, to recognise changed files.
    pub read_from: BTreeMap<String, PathBuf>,
    /// Form for a dataset to be made from the added records.
    pub dataset_form: DatasetForm,
    /// Name under which the files being read are displayed.
    pub reading: Option<String>,
    /// Messages about unreadable content.
    pub faults: Vec<String>,
    /// Running and waiting identification jobs, ordered as requested.
    pub jobs: Vec<IdentifyJob>,
    /// Number of conditions requested since the queue was last empty.
    pub requested_count: usize,
}

impl RecordsState {
    /// Copies the given conditions' records, to be restored by an undo step.
    pub fn before(&self, conditions: impl IntoIterator<Item = ConditionId>) -> RecordsSnapshot {
        let conditions = conditions
            .into_iter()
            .map(|id| (id, self.conditions.get(&id).cloned()))
            .collect();
        RecordsSnapshot {
            conditions,
            sources: None,
            unassigned: None,
        }
    }

    /// Restores the records from a snapshot; returns a snapshot of the replaced records, which the
    /// opposite step (redo or undo) restores.
    pub fn exchange(&mut self, snapshot: RecordsSnapshot) -> RecordsSnapshot {
        let mut replaced = RecordsSnapshot::default();
        for (id, records) in snapshot.conditions {
            let present = self.conditions.remove(&id);
            if let Some(records) = records {
                self.conditions
                    .insert(id, records.restored(present.clone()));
            }
            replaced.conditions.insert(id, present);
        }
        replaced.sources = snapshot
            .sources
            .map(|sources| std::mem::replace(&mut self.sources, sources));
        replaced.unassigned = snapshot
            .unassigned
            .map(|unassigned| std::mem::replace(&mut self.unassigned, unassigned));
        replaced
    }

    /// Adds a record without a condition; returns false if the same record was added before.
    pub fn add_unassigned(&mut self, row: LaidOutRecord) -> bool {
        let is_known = self
            .unassigned
            .iter()
            .any(|other| other.table.is_same_record(&row.table));
        if !is_known {
            self.unassigned.push(row);
        }
        !is_known
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
    pub fn identified_poles(&self) -> IdentifiedPoles {
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

    /// Returns the held-out records in use, for the conditions that have some.
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
        let earlier_count = self.jobs.len();
        self.jobs.retain(|other| other.condition != job.condition);
        let replaces_none = self.jobs.len() == earlier_count;
        if replaces_none {
            self.requested_count += 1;
        }
        self.jobs.push(job);
    }

    /// Returns the running or waiting job for a condition.
    pub fn job_of(&self, condition: ConditionId) -> Option<&IdentifyJob> {
        self.jobs.iter().find(|job| job.condition == condition)
    }

    /// Returns the running job, once it has reported its first step.
    pub fn running_job(&self) -> Option<&IdentifyJob> {
        self.jobs.iter().find(|job| has_started(job))
    }

    /// Returns the identification jobs, the displayed condition first.
    pub fn by_urgency(&self, shown: ConditionId) -> Vec<IdentifyJob> {
        let mut jobs = self.jobs.clone();
        jobs.sort_by_key(|job| job.condition != shown);
        jobs
    }
}
