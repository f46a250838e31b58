//! Flight records of a condition, and the models identified from them.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Arc;

use gdcm_model::dataset::channel::ChannelSide;
use gdcm_model::dataset::{ConditionId, Dataset};
use gdcm_model::names::ChannelRule;
use gdcm_model::simulation::Signal;
use gdcm_model::units::{number, telling};
use gdcm_study::decisions::adopted_models::{AdoptedModels, OfferedModels};
use gdcm_study::jobs::identification_jobs::{IdentificationRequest, IdentifyJob};
use gdcm_sysid::identification::{
    CautionNote, ChannelPreparation, Identification, IdentificationError, Preparation, SearchSpace,
};
use gdcm_sysid::records::{ColumnUse, LaidOutRecord, RecordChannels, RecordSource};

/// Result of adding a record.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AddedRecord {
    New,
    /// The record replaces the one previously read from the same file.
    ReadAgain,
    /// The record was already loaded.
    KnownAlready,
}

/// Flight records of a condition, and the models identified from them.
#[derive(Clone, Debug, Default)]
pub struct ConditionRecords {
    pub rows: Vec<LaidOutRecord>,
    /// Index of the displayed record.
    pub chosen: usize,
    pub inputs: Vec<ChannelPreparation>,
    pub outputs: Vec<ChannelPreparation>,
    /// Identification band \[rad/s\]; `None` selects the band of the study.
    pub band: Option<[f64; 2]>,
    /// Columns with recorded references that excited the loop externally (M14.15).
    pub references: Vec<String>,
    /// Search settings that replace the defaults.
    pub search: SearchSpace,
    /// Latest identification, with the job that produced it.
    pub found: Option<(
        IdentifyJob,
        Result<Arc<Identification>, IdentificationError>,
    )>,
    /// Whether the settings have changed since the latest identification.
    pub changed: bool,
    /// Upper band limit \[rad/s\] from which the common clock of resampled topics is chosen; `None`
    /// if unknown for some records.
    pub clock_band_end: Option<f64>,
    /// Records that the engineer has left out; records that are unused only because parts replace
    /// them are not included.
    left_out: Vec<RecordSource>,
}

impl ConditionRecords {
    /// Creates the records of a condition in `dataset`.
    pub fn new(rows: Vec<LaidOutRecord>, dataset: &Dataset) -> Self {
        let (inputs, outputs) = dataset.names_of_channels();
        Self {
            rows,
            inputs: inputs.into_iter().map(ChannelPreparation::named).collect(),
            outputs: outputs.into_iter().map(ChannelPreparation::named).collect(),
            ..Self::default()
        }
    }

    /// Uses a record, or leaves it out; returns whether the record exists.
    pub fn set_used(&mut self, index: usize, used: bool) -> bool {
        let Some(row) = self.rows.get_mut(index) else {
            return false;
        };
        row.used = used;
        self.left_out.retain(|source| *source != row.table.source);
        if !used && row.table.part_s.is_none() {
            self.left_out.push(row.table.source.clone());
        }
        true
    }

    /// Adds a part behind its record. The whole record is no longer used, so that no sample counts
    /// twice.
    ///
    /// # Errors
    /// A message, if the record has no samples in that time span.
    pub fn add_part(
        &mut self,
        index: usize,
        part_s: [f64; 2],
        channels: &RecordChannels,
    ) -> Result<(), String> {
        let Some(whole) = self.rows.get_mut(index) else {
            return Err("there is no such record".to_owned());
        };
        let part_s = part_s.map(|time_s| (100.0 * time_s).round() / 100.0);
        let table = Arc::new(whole.table.part_of_time(part_s));
        let part = LaidOutRecord::new(table, whole.layout.clone(), whole.guess.clone(), channels);
        if let Some(flight) = &part.flight
            && flight.time_s.len() < 2
        {
            return Err(no_samples(whole, part_s));
        }
        let source = whole.table.source.clone();
        let was_used = whole.used;
        if whole.table.part_s.is_none() {
            whole.used = false;
            if !was_used && !self.has_parts(&source) && !self.left_out.contains(&source) {
                self.left_out.push(source);
            }
        }
        // Insert after the earlier parts of the record.
        let mut position = index + 1;
        while self.is_part(position) {
            position += 1;
        }
        self.rows.insert(position, part);
        Ok(())
    }

    /// Returns whether a row exists and is a part of a record.
    fn is_part(&self, index: usize) -> bool {
        match self.rows.get(index) {
            Some(row) => row.table.part_s.is_some(),
            None => false,
        }
    }

    /// Returns whether the record has parts.
    fn has_parts(&self, source: &RecordSource) -> bool {
        self.rows
            .iter()
            .any(|row| row.table.part_s.is_some() && row.table.source == *source)
    }

    /// Adds a record unless it is already loaded. A record from a changed file replaces the earlier
    /// one; `read_from` gives the file paths by SHA-256. A different record with the same name gets
    /// a number after its name.
    pub fn add_row(
        &mut self,
        mut row: LaidOutRecord,
        read_from: &BTreeMap<String, PathBuf>,
    ) -> AddedRecord {
        if self
            .rows
            .iter()
            .any(|old| old.table.is_same_record(&row.table))
        {
            return AddedRecord::KnownAlready;
        }
        if let Some(old) = self
            .rows
            .iter_mut()
            .find(|old| is_read_again(old, &row, read_from))
        {
            row.used = old.used;
            row.guess = old.guess.clone();
            *old = row;
            return AddedRecord::ReadAgain;
        }
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

    /// Removes a part of a record; returns whether the row is a part. If it was the last part, the
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

    /// Returns the latest identification if it succeeded.
    pub fn identification(&self) -> Option<&Arc<Identification>> {
        self.found.as_ref()?.1.as_ref().ok()
    }

    /// Returns the used rows with their indices.
    pub fn used_rows(&self) -> impl Iterator<Item = (usize, &LaidOutRecord)> {
        self.rows
            .iter()
            .enumerate()
            .filter(|(_, row)| row.used_flight().is_some())
    }

    /// Returns the cautions about the identification, each with the rows that it concerns, if any;
    /// none once the settings have changed.
    pub fn cautions(&self) -> impl Iterator<Item = (Vec<usize>, CautionNote)> {
        let cautions = match self.identification() {
            Some(found) if !self.changed => found.cautions.as_slice(),
            _ => &[],
        };
        cautions.iter().map(|caution| {
            let note = caution.note();
            (self.rows_named(&note.records), note)
        })
    }

    /// Returns the rows with these names.
    fn rows_named(&self, names: &[String]) -> Vec<usize> {
        names
            .iter()
            .filter_map(|name| self.rows.iter().position(|row| row.table.name == *name))
            .collect()
    }

    /// Returns short marks, with a caution sign, for the cautions with this code.
    pub fn marks(&self, code: &'static str) -> impl Iterator<Item = String> {
        self.cautions()
            .filter(move |(_, note)| note.code == code)
            .map(|(_, note)| format!("⚠ {}", note.mark()))
    }

    /// Resamples topics to the common clock required by the identification band.
    pub fn follow_band(&mut self, channels: &RecordChannels) {
        self.clock_band_end = channels.resampling.band_end;
        for row in &mut self.rows {
            if row.layout.is_resampled(&row.table, channels) {
                *row = row.laid_out(row.layout.clone(), channels);
                self.changed = true;
            }
        }
    }

    /// Displays a row, or the last row if the index is too large.
    pub fn choose(&mut self, index: usize) {
        self.chosen = index.min(self.rows.len().saturating_sub(1));
    }

    /// Returns the index of the row that the identification used as record `record`, counted from
    /// 0.
    pub fn row_of_record(&self, record: usize) -> Option<usize> {
        self.used_rows().nth(record).map(|(index, _)| index)
    }

    /// Returns the preparation of a channel, for editing.
    pub fn channel_mut(&mut self, signal: &Signal) -> Option<&mut ChannelPreparation> {
        match signal.role {
            ChannelSide::Input => self.inputs.get_mut(signal.index),
            ChannelSide::Output => self.outputs.get_mut(signal.index),
        }
    }

    /// Returns the preparation of all channels.
    pub fn preparation(&self) -> Preparation {
        Preparation {
            inputs: self.inputs.clone(),
            outputs: self.outputs.clone(),
            ..Preparation::of(&[], &[])
        }
    }

    /// Creates the identification job for the current settings and a band \[rad/s\]; `channels` are
    /// the channels of the records.
    ///
    /// # Errors
    /// A message, if no record is used, if all are held out, or if a record lacks a reference.
    pub fn job(
        &self,
        condition: ConditionId,
        band: [f64; 2],
        channels: &RecordChannels,
    ) -> Result<IdentifyJob, String> {
        let mut preparation = self.preparation();
        for reference in &self.references {
            preparation
                .inputs
                .push(ChannelPreparation::named(reference));
        }
        let mut rows = Vec::new();
        for (_, row) in self.used_rows() {
            rows.push(self.with_references(row, channels)?);
        }
        let mut request = IdentificationRequest::of(rows.iter(), preparation, band)
            .map_err(|error| error.to_string())?;
        request.options.references = self.references.len();
        self.search.set(&mut request.options);
        Ok(IdentifyJob::new(condition, request))
    }

    /// Returns a record whose references are added after its inputs.
    fn with_references(
        &self,
        row: &LaidOutRecord,
        channels: &RecordChannels,
    ) -> Result<LaidOutRecord, String> {
        if self.references.is_empty() {
            return Ok(row.clone());
        }
        let mut layout = row.layout.clone();
        let mut channels = channels.clone();
        for reference in &self.references {
            let Some(column) = row.table.find(reference) else {
                let name = &row.table.name;
                return Err(format!("{name}: there is no column \"{reference}\""));
            };
            layout.inputs.push(Some(ColumnUse::as_it_is(column)));
            channels.inputs.push(ChannelRule::named(reference));
        }
        let row = LaidOutRecord::new(Arc::clone(&row.table), layout, row.guess.clone(), &channels);
        match row.problems.first() {
            Some(problem) => Err(format!("{}: {problem}", row.table.name)),
            None => Ok(row),
        }
    }

    /// Returns the identified models to put into the condition; `None` without a successful
    /// identification.
    pub fn adopted(
        &self,
        offered: OfferedModels,
        channels: &RecordChannels,
    ) -> Option<Arc<AdoptedModels>> {
        let found = self.identification()?;
        let mut entries = Vec::new();
        for ((_, row), record_use) in self.used_rows().zip(&found.record_uses) {
            entries.push(row.entry(record_use, channels));
        }
        Some(Arc::new(AdoptedModels::from_identification(
            found, offered, entries,
        )))
    }

    /// Returns the latest identification job.
    fn latest_job(&self) -> Option<&IdentifyJob> {
        let (job, _) = self.found.as_ref()?;
        Some(job)
    }

    /// Returns these records from the history, to replace the records `now`. Models identified in
    /// the meantime are kept, but marked as results of other settings.
    pub(super) fn restored(mut self, now: Option<Self>) -> Self {
        let Some(now) = now else {
            return self;
        };
        if self.latest_job() != now.latest_job() {
            self.changed = now.found.is_some();
            self.found = now.found;
        }
        self.choose(now.chosen);
        self
    }
}

/// Returns the message for a part \[s\] without samples.
fn no_samples(whole: &LaidOutRecord, part_s: [f64; 2]) -> String {
    let [from, to] = part_s.map(number);
    let mut message = format!("{}: no samples from {from} to {to} s", whole.table.name);
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
