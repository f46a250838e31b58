//! What the Records view holds: records by condition, and what was identified from them.

use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;
use std::sync::Arc;

use egui::Ui;

use gdcm_model::assembly::ChannelRule;
use gdcm_model::dataset::channel::ChannelSide;
use gdcm_model::dataset::condition::{ChannelRemedy, RecordKind};
use gdcm_model::dataset::{Band, ConditionId, Dataset};
use gdcm_model::simulation::Signal;
use gdcm_model::units::{number, telling};
use gdcm_study::study::changed_models::{AdoptedModels, OfferedModels};
use gdcm_study::study::job::{IdentificationRequest, IdentifyJob};
use gdcm_sysid::identification::{
    CautionNote, ChannelPreparation, Hold, Identification, IdentificationError, Preparation,
    SearchSpace,
};
use gdcm_sysid::records::record_channels::{ChannelList, SaidChannel};
use gdcm_sysid::records::resampling::ResamplingWish;
use gdcm_sysid::records::{
    ColumnUse, LaidOutRecord, LayoutProblem, RecordChannels, RecordColumn, RecordLayout,
    RecordSource, RecordTable,
};

use super::TimeModel;
use crate::view::controls::typed_number;
use crate::view::palette::Palette;
use crate::view::state::State;
use crate::view::tables::Sorting;

/// What a page of the view shows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum RecordsPage {
    /// Every channel of the chosen record over time.
    #[default]
    Histories,
    /// What was excited, and up to which frequency.
    Inputs,
    /// The measured response under the models.
    Response,
    /// Poles over the order.
    Stabilisation,
    /// The poles of the recommended model with their standard deviations.
    Poles,
    /// How well the model fits each record and output.
    Fit,
    /// Which columns are the channels.
    Columns,
    /// What was identified in every condition.
    Conditions,
}

impl RecordsPage {
    /// Every page, in the order in which they are offered.
    pub const ALL: [Self; 8] = [
        Self::Histories,
        Self::Inputs,
        Self::Response,
        Self::Stabilisation,
        Self::Poles,
        Self::Fit,
        Self::Columns,
        Self::Conditions,
    ];

    /// Its name; its name where there is little room, for all of them stand in one line; and what it shows, in a sentence.
    pub fn words(self) -> (&'static str, &'static str, &'static str) {
        match self {
            Self::Histories => (
                "Time",
                "Time",
                "Every channel of the chosen record over time; what was bridged or cut is marked",
            ),
            Self::Inputs => (
                "Inputs",
                "Inputs",
                "Which input was moved in which record, and up to which frequency",
            ),
            Self::Response => (
                "Response",
                "Response",
                "The measured response with its error bars, under the models and their bands",
            ),
            Self::Stabilisation => (
                "Stabilisation",
                "Orders",
                "Poles of the models of every order: those that stay are the aircraft's",
            ),
            Self::Poles => (
                "Identified poles",
                "Poles",
                "Poles of the recommended model with their standard deviations; grey: not determined",
            ),
            Self::Fit => (
                "Fit",
                "Fit",
                "How well the model fits each record and output, in frequency and in time",
            ),
            Self::Columns => (
                "Columns",
                "Columns",
                "Which columns of the chosen record are its time and its channels",
            ),
            Self::Conditions => (
                "Conditions",
                "Conditions",
                "What was identified in every condition; a click goes there",
            ),
        }
    }
}

/// What the engineer asks for in the Records view.
#[derive(Clone, Debug, PartialEq)]
pub enum RecordsCommand {
    /// Read files, and folders with all that is in them.
    Add(Vec<PathBuf>),
    /// Choose files with the desktop's dialog.
    AskFiles,
    /// Ask which channels of the records shown a dataset is to be made of.
    AskDataset,
    /// Make a dataset of the channels asked for, and open it.
    MakeDataset,
    /// Show a record.
    Choose(usize),
    /// Use a record, or leave it out.
    SetUsed(usize, bool),
    /// Keep a record from the fit, to judge it by; or not.
    SetHeldOut(usize, bool),
    /// Say which manoeuvre a record is of.
    SetKind(usize, RecordKind),
    /// Say which columns are the channels: of this record, and of all that have columns of these names.
    SetLayout(usize, RecordLayout),
    /// Say how late a channel is logged \[s\].
    SetDelay(Signal, f64),
    /// Put channels right in one record alone (M14.16).
    SetRemedies(usize, Vec<(Signal, ChannelRemedy)>),
    /// Say what the stairs in a channel are.
    SetHold(Signal, Hold),
    /// Identify over another band \[rad/s\]; none takes the study's.
    SetBand(Option<[f64; 2]>),
    /// Identify by way of these columns, recorded references that drove the loop from outside (M14.15); none goes the direct way.
    SetReferences(Vec<String>),
    /// Try these orders, past windows and poles.
    SetSearch(SearchSpace),
    /// Unfold what is searched, and go to the field of this name.
    ShowAdvanced(&'static str),
    /// Draw the response of a model to the same inputs, or not.
    ShowTimeModel(TimeModel, bool),
    /// Take every unit that no file says, in the records of all conditions, to be that of the dataset's channel.
    TakeDatasetUnits,
    /// Show a record, of whichever condition, whose columns are not clear, and its columns.
    ShowUnclear,
    /// Make the part of a record between two times \[s\] a record of its own, in place of the whole.
    AddPart(usize, [f64; 2]),
    /// Forget a part of a record.
    RemovePart(usize),
    /// Whether dragging in the charts over time chooses parts.
    ChooseParts(bool),
    /// Show the spectrogram of an input beside the records over time, or none.
    ShowSpectrogram(Option<usize>),
    /// Show a page.
    Show(RecordsPage),
    /// Identify models of the condition shown.
    Identify,
    /// Identify models of every condition that has records.
    IdentifyAll,
    /// Give up what is being identified.
    Stop,
    /// Put what was identified into the condition shown.
    Take(OfferedModels),
    /// Put what was identified into every condition that has something.
    TakeAll(OfferedModels),
    /// Put the models of the dataset's file back into the condition shown.
    Return,
}

/// What became of a record that was read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AddedRecord {
    /// It is new.
    New,
    /// It takes the place of the record that the same file held before.
    ReadAgain,
    /// It was there already.
    KnownAlready,
}

/// The records of one condition, and what was made of them.
#[derive(Clone, Debug, Default)]
pub struct ConditionRecords {
    /// The records.
    pub rows: Vec<LaidOutRecord>,
    /// Index of the one shown.
    pub chosen: usize,
    /// How inputs are prepared, where that is not as they are.
    pub inputs: Vec<ChannelPreparation>,
    /// How outputs are prepared.
    pub outputs: Vec<ChannelPreparation>,
    /// Band \[rad/s\]; none is the study's.
    pub band: Option<[f64; 2]>,
    /// Columns of recorded references that drove the loop from outside (M14.15).
    pub references: Vec<String>,
    /// What is tried in place of the defaults.
    pub search: SearchSpace,
    /// What was identified last, and from what.
    pub found: Option<(
        IdentifyJob,
        Result<Arc<Identification>, IdentificationError>,
    )>,
    /// Whether something else was said since.
    pub changed: bool,
    /// End of the band \[rad/s\] that topics were brought to a clock for; none where that is not known of all.
    pub clock_band_end: Option<f64>,
    /// Records that the engineer leaves out himself, whether or not they have parts.
    left_out: Vec<RecordSource>,
}

impl ConditionRecords {
    /// Records of a condition of `dataset`.
    pub fn new(rows: Vec<LaidOutRecord>, dataset: &Dataset) -> Self {
        let (inputs, outputs) = dataset.names_of_channels();
        let [inputs, outputs] =
            [inputs, outputs].map(|of| of.into_iter().map(ChannelPreparation::named).collect());
        Self {
            rows,
            inputs,
            outputs,
            ..Self::default()
        }
    }

    /// Uses a record, or leaves it out.
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

    /// A part of a record as a record of its own behind it; the whole is no longer used, for evidence counts once.
    ///
    /// # Errors
    /// In words: the record has no samples then.
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
        if part
            .flight
            .as_ref()
            .is_some_and(|flight| flight.time_s.len() < 2)
        {
            let [from, to] = part_s.map(number);
            let span = whole.span_s().map_or_else(String::new, |span_s| {
                let [first, last] = span_s.map(|time_s| telling(time_s, 2));
                format!(
                    "; it runs from {first} s to {last} s (+{from} +{to} counts from its start)"
                )
            });
            return Err(format!(
                "{}: no samples from {from} to {to} s{span}",
                whole.table.name
            ));
        }
        let source = whole.table.source.clone();
        let was_used = whole.used;
        if whole.table.part_s.is_none() {
            whole.used = false;
            if !was_used && !self.has_parts(&source) && !self.left_out.contains(&source) {
                self.left_out.push(source);
            }
        }
        let parts = self.rows[index + 1..]
            .iter()
            .take_while(|row| row.table.part_s.is_some())
            .count();
        self.rows.insert(index + 1 + parts, part);
        Ok(())
    }

    /// Whether parts of a record are records of their own.
    fn has_parts(&self, source: &RecordSource) -> bool {
        self.rows
            .iter()
            .any(|row| row.table.part_s.is_some() && row.table.source == *source)
    }

    /// Adds a record that was read, unless it is there already. A record of a file that has changed since takes the place of the one
    /// that was read before; `read_from` says where files lie. Another one of the same name gets a number behind it.
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
        let path = |of: &LaidOutRecord| read_from.get(&of.table.source.sha256);
        let is_read_again = |old: &LaidOutRecord| {
            let [old_source, new_source] = [&old.table.source, &row.table.source];
            let is_same_place = path(old).is_some() && path(old) == path(&row);
            is_same_place
                && old.table.part_s.is_none()
                && old_source.variable == new_source.variable
        };
        if let Some(index) = self.rows.iter().position(is_read_again) {
            let old = &self.rows[index];
            row.used = old.used;
            row.guess = old.guess.clone();
            self.rows[index] = row;
            return AddedRecord::ReadAgain;
        }
        let plain = row.table.name.clone();
        let mut number = 1;
        while self
            .rows
            .iter()
            .any(|other| other.table.name == row.table.name)
        {
            number += 1;
            let name = format!("{plain} ({number})");
            if let Some(flight) = &mut row.flight {
                Arc::make_mut(flight).name.clone_from(&name);
            }
            Arc::make_mut(&mut row.table).name = name;
        }
        self.rows.push(row);
        AddedRecord::New
    }

    /// Forgets a part of a record; the record that it was the last part of is used again, where the engineer did not leave it out.
    pub fn remove_part(&mut self, index: usize) -> bool {
        if self
            .rows
            .get(index)
            .is_none_or(|row| row.table.part_s.is_none())
        {
            return false;
        }
        let source = self.rows.remove(index).table.source.clone();
        if !self.has_parts(&source) && !self.left_out.contains(&source) {
            for whole in self
                .rows
                .iter_mut()
                .filter(|row| row.table.source == source)
            {
                whole.used = true;
            }
        }
        self.choose(self.chosen);
        true
    }

    /// What was identified, where that went well.
    pub fn identification(&self) -> Option<&Arc<Identification>> {
        self.found.as_ref()?.1.as_ref().ok()
    }

    /// The rows that are used, with their indices.
    pub fn used_rows(&self) -> impl Iterator<Item = (usize, &LaidOutRecord)> {
        self.rows
            .iter()
            .enumerate()
            .filter(|(_, row)| row.used_flight().is_some())
    }

    /// What speaks against what was identified, and of which rows where it is of some; nothing once something else was said.
    pub fn cautions(&self) -> impl Iterator<Item = (Vec<usize>, CautionNote)> {
        let found = self.identification().filter(|_| !self.changed);
        found
            .into_iter()
            .flat_map(|found| &found.cautions)
            .map(|caution| {
                let note = caution.note();
                let named =
                    |name: &String| self.rows.iter().position(|row| row.table.name == *name);
                (note.records.iter().filter_map(named).collect(), note)
            })
    }

    /// What cautions of a code say, with the sign of a caution and in a few words.
    pub(super) fn marks(&self, code: &'static str) -> impl Iterator<Item = String> {
        self.cautions()
            .filter(move |(_, note)| note.code == code)
            .map(|(_, note)| format!("⚠ {}", note.mark()))
    }

    /// Brings topics to the clock that the band takes which is identified over.
    pub fn follow_band(&mut self, channels: &RecordChannels) {
        self.clock_band_end = channels.resampling.band_end;
        for row in &mut self.rows {
            if row.layout.is_resampled(&row.table, channels) {
                *row = row.laid_out(row.layout.clone(), channels);
                self.changed = true;
            }
        }
    }

    /// Shows a row, or the last where there is none of this index.
    pub fn choose(&mut self, index: usize) {
        self.chosen = index.min(self.rows.len().saturating_sub(1));
    }

    /// The row of a record of the identification.
    pub fn row_of_record(&self, record: usize) -> Option<usize> {
        self.used_rows().nth(record).map(|(index, _)| index)
    }

    /// How a channel is prepared, to change.
    pub fn channel_mut(&mut self, signal: &Signal) -> Option<&mut ChannelPreparation> {
        match signal.role {
            ChannelSide::Input => self.inputs.get_mut(signal.index),
            ChannelSide::Output => self.outputs.get_mut(signal.index),
        }
    }

    /// How the channels are prepared.
    pub fn preparation(&self) -> Preparation {
        Preparation {
            inputs: self.inputs.clone(),
            outputs: self.outputs.clone(),
            ..Preparation::of(&[], &[])
        }
    }

    /// The job of what is said now, over a band \[rad/s\]; `channels` are those that the records give.
    ///
    /// # Errors
    /// In words: no record is used, all are held out, or one lacks a reference.
    pub fn job(
        &self,
        condition: ConditionId,
        band: [f64; 2],
        channels: &RecordChannels,
    ) -> Result<IdentifyJob, String> {
        let mut preparation = self.preparation();
        preparation
            .inputs
            .extend(self.references.iter().map(ChannelPreparation::named));
        let rows: Vec<LaidOutRecord> = self
            .used_rows()
            .map(|(_, row)| self.with_references(row, channels))
            .collect::<Result<_, _>>()?;
        let request = IdentificationRequest::of(rows.iter(), preparation, band);
        let mut request = request.map_err(|why| why.to_string())?;
        request.options.references = self.references.len();
        self.search.set(&mut request.options);
        Ok(IdentifyJob::new(condition, request))
    }

    /// A record with the references behind its inputs.
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
            let column = row.table.find(reference);
            let column = column
                .ok_or_else(|| format!("{}: there is no column \"{reference}\"", row.table.name))?;
            layout.inputs.push(Some(ColumnUse::as_it_is(column)));
            channels.inputs.push(ChannelRule::named(reference));
        }
        let row = LaidOutRecord::new(Arc::clone(&row.table), layout, row.guess.clone(), &channels);
        match row.problems.first() {
            Some(problem) => Err(format!("{}: {problem}", row.table.name)),
            None => Ok(row),
        }
    }

    /// What is taken into the condition, where something was identified.
    pub fn taken(
        &self,
        offered: OfferedModels,
        channels: &RecordChannels,
    ) -> Option<Arc<AdoptedModels>> {
        let found = self.identification()?;
        let entries = self
            .used_rows()
            .zip(&found.record_uses)
            .map(|((_, row), used)| row.entry(used, channels));
        Some(Arc::new(AdoptedModels::of(
            found,
            offered,
            entries.collect(),
        )))
    }
}

/// What an edit of records is to be taken back to: the records of conditions as they are on the other side of it. An edit changes the
/// records of few conditions; nothing of the others is kept.
#[derive(Clone, Debug, Default)]
pub struct RecordsBefore {
    /// Records by condition; none of a condition that was not looked at yet.
    pub conditions: BTreeMap<ConditionId, Option<ConditionRecords>>,
    /// The files and folders that were added, where the edit changes them.
    pub sources: Option<Vec<PathBuf>>,
}

impl ConditionRecords {
    /// These records, taken up again in place of `now`: what was identified since stays, as something of other records.
    fn taken_up(mut self, now: Option<Self>) -> Self {
        let Some(now) = now else { return self };
        let job = |of: &Self| of.found.as_ref().map(|(job, _)| job.clone());
        if job(&self) != job(&now) {
            self.changed = now.found.is_some();
            self.found = now.found;
        }
        self.chosen = now.chosen;
        self.choose(self.chosen);
        self
    }
}

/// What the pages of the view draw: the records of the condition shown.
#[derive(Clone, Copy)]
pub(super) struct Page<'a> {
    /// What the window shows.
    pub(super) state: &'a State,
    /// The records of the condition shown.
    pub(super) records: &'a ConditionRecords,
    /// The colours of the theme.
    pub(super) palette: &'a Palette,
}

impl Page<'_> {
    /// What was identified; where nothing was, that is said.
    pub(super) fn identification_ui(&self, ui: &mut Ui) -> Option<&Identification> {
        let found = self.records.identification();
        if found.is_none() {
            ui.label(
                self.palette
                    .dim("Nothing was identified yet: choose Identify above."),
            );
        }
        found.map(AsRef::as_ref)
    }
}

/// What the Records view holds. Not saved: records stay in their files.
#[derive(Clone, Debug, Default)]
pub struct RecordsState {
    /// Records by condition; a condition without an entry was not looked at yet.
    pub conditions: BTreeMap<ConditionId, ConditionRecords>,
    /// Whether the dataset is the example, of which the program holds some records.
    pub is_example: bool,
    /// The page shown.
    pub page: RecordsPage,
    /// How the table of conditions is sorted.
    pub sorting: Sorting,
    /// Models whose responses to the same inputs are drawn.
    pub time_models: BTreeSet<TimeModel>,
    /// Whether dragging in the charts over time chooses parts.
    pub chooses_parts: bool,
    /// The input whose spectrogram is drawn.
    pub spectrogram: Option<usize>,
    /// The field of what is searched that is to be gone to.
    pub advanced_field: Option<&'static str>,
    /// Path of files, as typed.
    pub path: String,
    /// The files and folders that were added.
    pub sources: Vec<PathBuf>,
    /// Where the files of records lie that were read, by their SHA-256: of a file that has changed since, records are read again.
    pub read_from: BTreeMap<String, PathBuf>,
    /// The dataset that is to be made of the records shown.
    pub wanted: WantedDataset,
    /// What is being read.
    pub reading: Option<String>,
    /// What could not be read, in words.
    pub faults: Vec<String>,
    /// What is being identified, and what is to be.
    pub running: Vec<IdentifyJob>,
    /// How many conditions were asked for since nothing was running.
    pub asked: usize,
}

impl RecordsState {
    /// The records of these conditions as they are.
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

    /// Takes up the records on the other side of an edit, and gives those of this side.
    pub fn exchange(&mut self, before: RecordsBefore) -> RecordsBefore {
        let mut now = RecordsBefore::default();
        for (id, records) in before.conditions {
            let present = self.conditions.remove(&id);
            if let Some(records) = records {
                self.conditions
                    .insert(id, records.taken_up(present.clone()));
            }
            now.conditions.insert(id, present);
        }
        now.sources = before
            .sources
            .map(|sources| std::mem::replace(&mut self.sources, sources));
        now
    }

    /// The records whose columns are not clear for want of a unit: their channels, how many records and of how many conditions.
    pub fn open_units(&self) -> Option<OpenUnits> {
        let mut open = OpenUnits::default();
        for (id, of) in &self.conditions {
            let mut is_open = false;
            for row in &of.rows {
                let mut count = 0;
                for problem in &row.problems {
                    if let LayoutProblem::UnsaidUnit { channel, unit, .. } = problem {
                        count += 1;
                        if !open.channels.iter().any(|(known, _)| known == channel) {
                            open.channels.push((channel.clone(), unit.clone()));
                        }
                    }
                }
                if count > 0 {
                    open.records += 1;
                    is_open = true;
                    open.first.get_or_insert(*id);
                }
            }
            if is_open {
                open.conditions += 1;
            }
        }
        (open.records > 0).then_some(open)
    }

    /// The job of a condition that is under way or waits.
    pub fn running(&self, condition: ConditionId) -> Option<&IdentifyJob> {
        self.running.iter().find(|job| job.condition == condition)
    }

    /// The job under way, once it has told of a step.
    pub fn under_way(&self) -> Option<&IdentifyJob> {
        self.running.iter().find(|job| !job.told().step.is_empty())
    }

    /// What is to be identified, that of the condition shown first.
    pub fn by_urgency(&self, shown: ConditionId) -> Vec<IdentifyJob> {
        let mut jobs = self.running.clone();
        jobs.sort_by_key(|job| job.condition != shown);
        jobs
    }
}

/// Units that no file says, in the records of all conditions.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct OpenUnits {
    /// The channels with their units in the dataset.
    pub channels: Vec<(String, String)>,
    /// How many records lack some of them.
    pub records: usize,
    /// Of how many conditions.
    pub conditions: usize,
    /// The first of these.
    pub first: Option<ConditionId>,
}

/// A dataset that is to be made of records, as typed.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct WantedDataset {
    /// Inputs, as [`ChannelList`] reads them.
    pub inputs: String,
    /// Outputs, in the same way.
    pub outputs: String,
    /// Lower and upper end of the band \[rad/s\].
    pub band: [String; 2],
    /// Path of the dataset.
    pub path: String,
    /// The columns of the records, in words.
    pub columns: Vec<String>,
    /// Why it could not be made, in words.
    pub problems: Vec<String>,
}

impl WantedDataset {
    /// What is proposed for the records of a condition: the channels that the documentation of a system knows; others are to be
    /// typed.
    pub fn proposed(records: &ConditionRecords, band: Band, path: String) -> Self {
        let tables = || records.rows.iter().map(|row| row.table.as_ref());
        let known = |inputs: bool| {
            let of_side = |column: &&RecordColumn| match (column.side, column.meaning) {
                (Some(side), _) => (side == ChannelSide::Input) == inputs,
                (None, Some(meaning)) => {
                    ["LON", "LAT", "PED", "COL"].contains(&meaning) == inputs && meaning != "TARG"
                }
                (None, None) => false,
            };
            let name = |column: &RecordColumn| column.meaning.unwrap_or(&column.name).to_owned();
            let mut names: Vec<String> = tables()
                .flat_map(|table| &table.columns)
                .filter(of_side)
                .map(name)
                .collect();
            let mut seen = BTreeSet::new();
            names.retain(|name| seen.insert(name.clone()));
            names.join(", ")
        };
        // Topics that no channel has joined yet are records of their own, under the names of their variables.
        let words = |table: &RecordTable, column: &RecordColumn| {
            let topic = table
                .source
                .variable
                .as_ref()
                .map_or(String::new(), |variable| format!("{variable}."));
            let unit = column
                .unit
                .as_ref()
                .map_or(String::new(), |unit| format!(" [{unit}]"));
            format!("{topic}{}{unit}", column.name)
        };
        let columns: BTreeSet<String> = tables()
            .flat_map(|table| table.columns.iter().map(move |column| words(table, column)))
            .collect();
        Self {
            inputs: known(true),
            outputs: known(false),
            band: [band.min(), band.max()].map(number),
            path,
            columns: columns.into_iter().collect(),
            problems: Vec::new(),
        }
    }

    /// The channels and the band that are asked for.
    ///
    /// # Errors
    /// In words, what is no channel or no band.
    pub fn channels(&self) -> Result<(RecordChannels, Band), String> {
        let rules = |side: &str, text: &str| {
            let list: ChannelList = text.parse().map_err(|error| format!("{side}: {error}"))?;
            Ok::<_, String>(list.channels.iter().map(SaidChannel::rule).collect())
        };
        let inputs = rules("inputs", &self.inputs)?;
        let outputs = rules("outputs", &self.outputs)?;
        let end = |text: &String| typed_number(text).ok().flatten().unwrap_or(f64::NAN);
        let band =
            Band::new(end(&self.band[0]), end(&self.band[1])).map_err(|error| error.to_string())?;
        let resampling = ResamplingWish {
            band_end: Some(band.max()),
            ..ResamplingWish::default()
        };
        Ok((
            RecordChannels {
                inputs,
                outputs,
                resampling,
                ..RecordChannels::default()
            },
            band,
        ))
    }
}
