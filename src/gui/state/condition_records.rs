//! A condition's flight records: which records there are, and which are used.
//!
//! Each record and each part of a record (a time span) is a row; the parts follow their record and
//! have the same source. A row's `layout` assigns its columns to the channels; its `guess` says
//! what manoeuvre it is and whether it is held out, from its name or from the engineer.
//!
//! `record_parts.rs` extends [`ConditionRecords`] by adding, moving and removing parts,
//! `condition_identification.rs` by the identification.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Arc;

use gdcm_model::dataset::Dataset;
use gdcm_study::jobs::identification_jobs::IdentifyJob;
use gdcm_sysid::identification::{
    ChannelPreparation, Identification, IdentificationError, SearchSpace,
};
use gdcm_sysid::records::{LaidOutRecord, RecordChannels, RecordSource};

/// Outcome of adding a record.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AddedRecord {
    New,
    /// The record replaces the one previously read from the same file.
    ReadAgain,
    /// The record was already loaded.
    KnownAlready,
}

/// Search for the row that shows an input best (`excited_input.rs`). It is repeated for another
/// input, and once rows have been added or removed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RowSearch {
    pub input: usize,
    pub row_count: usize,
}

/// Identification that has ended, with the job that produced it.
#[derive(Clone, Debug)]
pub struct EndedIdentification {
    pub job: IdentifyJob,
    pub outcome: Result<Arc<Identification>, IdentificationError>,
}

/// A condition's flight records, and the models identified from them.
#[derive(Clone, Debug, Default)]
pub struct ConditionRecords {
    /// The records, each followed by its parts.
    pub rows: Vec<LaidOutRecord>,
    /// Index of the displayed row.
    pub chosen: usize,
    /// Whether the engineer has chosen the displayed row; otherwise it follows the input in focus.
    pub is_chosen: bool,
    /// Latest search for the row to display; `None` before the first.
    pub latest_search: Option<RowSearch>,
    /// Delay and hold for each input.
    pub inputs: Vec<ChannelPreparation>,
    /// Delay and hold for each output.
    pub outputs: Vec<ChannelPreparation>,
    /// Identification band \[rad/s\]; `None` selects the study's band.
    pub band: Option<[f64; 2]>,
    /// Columns with recorded references that excited the loop externally (M14.15:
    /// docs/identification.md).
    pub references: Vec<String>,
    /// Search settings that replace the defaults.
    pub search: SearchSpace,
    /// Latest identification that has ended, successful or not.
    pub latest: Option<EndedIdentification>,
    /// Whether records or settings have changed since the latest identification.
    pub changed_since_fit: bool,
    /// Upper band limit \[rad/s\] that determines the common clock for resampled topics; `None` if
    /// unknown for some records.
    pub clock_band_end: Option<f64>,
    /// Records that the engineer has left out; records that are unused only because parts replace
    /// them are not included.
    pub(super) left_out: Vec<RecordSource>,
}

impl ConditionRecords {
    /// Creates a condition's records, with a preparation for each channel in `dataset`.
    pub fn new(rows: Vec<LaidOutRecord>, dataset: &Dataset) -> Self {
        let (inputs, outputs) = dataset.input_and_output_names();
        Self {
            rows,
            inputs: inputs.into_iter().map(ChannelPreparation::named).collect(),
            outputs: outputs.into_iter().map(ChannelPreparation::named).collect(),
            ..Self::default()
        }
    }

    /// Uses a record, or leaves it out; returns whether the record exists. A used whole record
    /// replaces its parts, and a used part its whole record, so that no sample counts twice.
    pub fn set_used(&mut self, index: usize, used: bool) -> bool {
        let Some(row) = self.rows.get_mut(index) else {
            return false;
        };
        row.used = used;
        let source = row.table.source.clone();
        let is_whole = row.table.part_s.is_none();
        self.left_out.retain(|left_out| *left_out != source);
        if used {
            for other in &mut self.rows {
                if other.table.source == source && other.table.part_s.is_none() != is_whole {
                    other.used = false;
                }
            }
        } else if is_whole {
            self.left_out.push(source);
        }
        true
    }

    /// Adds a record; `read_from` gives the file paths by SHA-256:
    ///
    /// 1. already loaded: nothing changes;
    /// 2. read again from a changed file: replaces the earlier record, takes over its use and
    ///    manoeuvre, and its parts are cut anew;
    /// 3. otherwise: added at the end, with a number after its name if another record has the name.
    pub fn add_row(
        &mut self,
        mut row: LaidOutRecord,
        read_from: &BTreeMap<String, PathBuf>,
        channels: &RecordChannels,
    ) -> AddedRecord {
        // Step 1.
        if self
            .rows
            .iter()
            .any(|old| old.table.is_same_record(&row.table))
        {
            return AddedRecord::KnownAlready;
        }
        // Step 2.
        if let Some(old) = self
            .rows
            .iter_mut()
            .find(|old| is_read_again(old, &row, read_from))
        {
            row.used = old.used;
            row.guess = old.guess.clone();
            let old = std::mem::replace(old, row.clone());
            self.cut_parts_anew(&old.table.source, &row, channels);
            return AddedRecord::ReadAgain;
        }
        // Step 3.
        self.give_free_name(&mut row);
        self.rows.push(row);
        AddedRecord::New
    }

    /// Appends a number to the record's name if another record has the same name.
    fn give_free_name(&self, row: &mut LaidOutRecord) {
        let plain = row.table.name.clone();
        let mut number = 1;
        while self.has_name(&row.table.name) {
            number += 1;
            let name = format!("{plain} ({number})");
            if let Some(flight) = &mut row.flight {
                Arc::make_mut(flight).name.clone_from(&name);
            }
            Arc::make_mut(&mut row.table).name = name;
        }
    }

    fn has_name(&self, name: &str) -> bool {
        self.rows.iter().any(|row| row.table.name == name)
    }

    /// Returns the rows that are marked as used and have no problem that prevents it, with their
    /// indices.
    pub fn used_rows(&self) -> impl Iterator<Item = (usize, &LaidOutRecord)> {
        self.rows
            .iter()
            .enumerate()
            .filter(|(_, row)| row.used_flight().is_some())
    }

    /// Resamples topics to the common clock required by the identification band; if there are any,
    /// the latest identification is outdated.
    pub fn follow_band(&mut self, channels: &RecordChannels) {
        self.clock_band_end = channels.resampling.band_end;
        for row in &mut self.rows {
            if row.layout.is_resampled(&row.table, channels) {
                *row = row.laid_out(row.layout.clone(), channels);
                self.changed_since_fit = true;
            }
        }
    }

    /// Displays a row, or the last row if the index is too large.
    pub fn choose(&mut self, index: usize) {
        self.chosen = index.min(self.rows.len().saturating_sub(1));
    }
}

/// Returns whether `new` is the whole record `old`, read again after its file has changed.
fn is_read_again(
    old: &LaidOutRecord,
    new: &LaidOutRecord,
    read_from: &BTreeMap<String, PathBuf>,
) -> bool {
    let old_path = read_from.get(&old.table.source.sha256);
    let new_path = read_from.get(&new.table.source.sha256);
    old_path.is_some()
        && old_path == new_path
        && old.table.part_s.is_none()
        && old.table.source.variable == new.table.source.variable
}
