//! A condition's flight records: which records there are, the parts cut from them, and which are
//! used.
//!
//! Each record and each part is a row; the parts follow their record and have the same source. A
//! part replaces its whole record, so that no sample counts twice: once the first part is added,
//! the whole record is no longer used; once the last part is removed, it is used again. A record
//! that the engineer left out stays out.
//!
//! A row's `layout` assigns its columns to the channels; its `guess` says what manoeuvre it is and
//! whether it is held out, from its name or from the engineer.
//!
//! `condition_identification.rs` extends [`ConditionRecords`] by the identification.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Arc;

use gdcm_model::dataset::Dataset;
use gdcm_model::units::{number, telling};
use gdcm_study::jobs::identification_jobs::IdentifyJob;
use gdcm_sysid::identification::{
    ChannelPreparation, Identification, IdentificationError, SearchSpace,
};
use gdcm_sysid::records::{LaidOutRecord, RecordChannels, RecordSource};

use crate::message::Message;

/// Outcome of adding a record.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AddedRecord {
    New,
    /// The record replaces the one previously read from the same file.
    ReadAgain,
    /// The record was already loaded.
    KnownAlready,
}

/// Input and row count in the latest search for the row to display (`excited_input.rs`); another
/// input or count makes the search necessary again.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Opening {
    pub input: usize,
    pub records: usize,
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
    pub opening: Option<Opening>,
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
    /// Latest identification, with the job that produced it.
    pub found: Option<(
        IdentifyJob,
        Result<Arc<Identification>, IdentificationError>,
    )>,
    /// Whether records or settings have changed since the latest identification.
    pub changed_since_fit: bool,
    /// Upper band limit \[rad/s\] that determines the common clock for resampled topics; `None` if
    /// unknown for some records.
    pub clock_band_end: Option<f64>,
    /// Records that the engineer has left out; records that are unused only because parts replace
    /// them are not included.
    left_out: Vec<RecordSource>,
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

    /// Adds a part after its record and the earlier parts, and displays it. The whole record is no
    /// longer used, so that no sample counts twice. A part cut from a part belongs to the whole
    /// record.
    ///
    /// # Errors
    /// A message, if there is no such record, or if it has fewer than two samples in this time
    /// span.
    pub fn add_part(
        &mut self,
        index: usize,
        part_s: [f64; 2],
        channels: &RecordChannels,
    ) -> Result<(), Message> {
        let index = self.whole_index(index);
        let Some(whole) = self.rows.get_mut(index) else {
            return Err(Message::new("unknown-record", "there is no such record"));
        };
        let part = part_of(whole, part_s, channels)?;
        let source = whole.table.source.clone();
        let was_used = whole.used;
        if whole.table.part_s.is_none() {
            whole.used = false;
            // Without parts, an unused record was left out, for example because it is a copy;
            // removing its parts must not use it.
            if !was_used && !self.has_parts(&source) && !self.left_out.contains(&source) {
                self.left_out.push(source);
            }
        }
        // Insert after the record's earlier parts.
        let mut position = index + 1;
        while self.is_part(position) {
            position += 1;
        }
        self.rows.insert(position, part);
        self.chosen = position;
        self.is_chosen = true;
        Ok(())
    }

    /// Returns the index of the row's whole record, or of the row itself if the whole is not
    /// loaded.
    fn whole_index(&self, index: usize) -> usize {
        let Some(row) = self.rows.get(index) else {
            return index;
        };
        let source = &row.table.source;
        let whole = self
            .rows
            .iter()
            .position(|other| other.table.part_s.is_none() && other.table.source == *source);
        whole.unwrap_or(index)
    }

    /// Moves the ends of the part in a row \[s\]; its use and manoeuvre are kept.
    ///
    /// # Errors
    /// A message, if the row is no part, or if the record has fewer than two samples in that time
    /// span.
    pub fn move_part(
        &mut self,
        index: usize,
        part_s: [f64; 2],
        channels: &RecordChannels,
    ) -> Result<(), Message> {
        let row = match self.rows.get(index) {
            Some(row) if row.table.part_s.is_some() => row,
            _ => return Err(Message::new("unknown-record", "there is no such part")),
        };
        let whole = &self.rows[self.whole_index(index)];
        let mut part = part_of(whole, part_s, channels)?;
        part.used = row.used;
        part.guess = row.guess.clone();
        part.layout = row.layout.clone();
        self.rows[index] = part.laid_out(row.layout.clone(), channels);
        Ok(())
    }

    /// Returns whether a row exists and is only a part.
    fn is_part(&self, index: usize) -> bool {
        match self.rows.get(index) {
            Some(row) => row.table.part_s.is_some(),
            None => false,
        }
    }

    fn has_parts(&self, source: &RecordSource) -> bool {
        self.rows
            .iter()
            .any(|row| row.table.part_s.is_some() && row.table.source == *source)
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

    /// Cuts the parts of the record `old` from `whole`, which has replaced it; a part whose time
    /// span has no samples any more is removed. If the engineer left `old` out, `whole` counts as
    /// left out too.
    fn cut_parts_anew(
        &mut self,
        old: &RecordSource,
        whole: &LaidOutRecord,
        channels: &RecordChannels,
    ) {
        for source in &mut self.left_out {
            if source == old {
                *source = whole.table.source.clone();
            }
        }
        for index in (0..self.rows.len()).rev() {
            let row = &self.rows[index];
            let Some(part_s) = row.table.part_s else {
                continue;
            };
            if row.table.source != *old {
                continue;
            }
            match part_of(whole, part_s, channels) {
                Ok(mut part) => {
                    part.used = row.used;
                    part.guess = row.guess.clone();
                    self.rows[index] = part;
                }
                Err(_) => {
                    self.rows.remove(index);
                }
            }
        }
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

    /// Removes a part; returns whether the row is a part. If it was the record's last part, the
    /// whole record is used again, unless the engineer left it out.
    pub fn remove_part(&mut self, index: usize) -> bool {
        if !self.is_part(index) {
            return false;
        }
        let source = self.rows.remove(index).table.source.clone();
        if !self.has_parts(&source) && !self.left_out.contains(&source) {
            for row in &mut self.rows {
                if row.table.source == source {
                    row.used = true;
                }
            }
        }
        self.choose(self.chosen);
        true
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

/// Cuts the part between two times \[s\] from a record.
///
/// # Errors
/// A message, if the record has fewer than two samples in that time span.
fn part_of(
    whole: &LaidOutRecord,
    part_s: [f64; 2],
    channels: &RecordChannels,
) -> Result<LaidOutRecord, Message> {
    // A pointer gives more digits than anyone can read: hundredths of a second are enough.
    let part_s = part_s.map(|time_s| (100.0 * time_s).round() / 100.0);
    let table = Arc::new(whole.table.part_of_time(part_s));
    let part = LaidOutRecord::new(table, whole.layout.clone(), whole.guess.clone(), channels);
    if let Some(flight) = &part.flight
        && flight.time_s.len() < 2
    {
        return Err(Message::new("no-samples", no_samples(whole, part_s)));
    }
    Ok(part)
}

/// Returns the message for the part `part_s` \[s\] of a record, which has fewer than the two samples
/// that a record needs.
fn no_samples(whole: &LaidOutRecord, part_s: [f64; 2]) -> String {
    let [from, to] = part_s.map(number);
    let mut message = format!(
        "{}: fewer than 2 samples from {from} to {to} s",
        whole.table.name
    );
    if let Some(span_s) = whole.span_s() {
        let [first, last] = span_s.map(|time_s| telling(time_s, 2));
        message.push_str(&format!(
            "; the record runs from {first} s to {last} s (write +{from} and +{to} to count from \
            its start)"
        ));
    }
    message
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
