//! Flight records by condition, and the models identified from them.

use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;
use std::sync::Arc;

use egui::Color32;

use gdcm_model::dataset::channel::ChannelSide;
use gdcm_model::dataset::{Band, ConditionId, Dataset};
use gdcm_model::names::ChannelRule;
use gdcm_model::simulation::Signal;
use gdcm_model::units::{number, telling};
use gdcm_study::decisions::adopted_models::{AdoptedModels, OfferedModels};
use gdcm_study::jobs::identification_jobs::{IdentificationRequest, IdentifyJob};
use gdcm_study::results::required_modes::KnownPoles;
use gdcm_study::results::time_histories::HistoryRecords;
use gdcm_sysid::identification::{
    CautionNote, ChannelPreparation, Identification, IdentificationError, Preparation, SearchSpace,
};
use gdcm_sysid::records::channel_list::{ChannelList, SaidChannel};
use gdcm_sysid::records::record_channels::ResamplingWish;
use gdcm_sysid::records::{
    ColumnUse, LaidOutRecord, LayoutProblem, RecordChannels, RecordColumn, RecordSource,
    RecordTable,
};

use crate::gui::widgets::controls::typed_number;
use crate::gui::widgets::palette::Palette;
use crate::gui::widgets::tables::Sorting;

/// A page of the Records view.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum RecordsPage {
    /// Every channel of the selected record over time.
    #[default]
    Histories,
    /// Excitation of the inputs, and its highest frequency.
    Inputs,
    /// The measured response with the models.
    Response,
    /// Poles over the model order.
    Stabilisation,
    /// Poles of the recommended model with their standard deviations.
    Poles,
    /// Fit of the model to each record and output.
    Fit,
    /// Assignment of columns to channels.
    Columns,
    /// Results of identification in every condition.
    Conditions,
}

impl RecordsPage {
    /// All pages, in display order.
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

    /// Returns the name, a shorter name for narrow windows, and a sentence about the content.
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

/// Outcome of adding a record.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AddedRecord {
    New,
    /// It replaces the record previously read from the same file.
    ReadAgain,
    /// It was loaded already.
    KnownAlready,
}

/// Records of one condition, and the models identified from them.
#[derive(Clone, Debug, Default)]
pub struct ConditionRecords {
    pub rows: Vec<LaidOutRecord>,
    /// Index of the displayed record.
    pub chosen: usize,
    /// Preparation of the inputs, if changed.
    pub inputs: Vec<ChannelPreparation>,
    /// Preparation of the outputs.
    pub outputs: Vec<ChannelPreparation>,
    /// Band \[rad/s\]; `None` takes the study's.
    pub band: Option<[f64; 2]>,
    /// Columns of recorded references that excited the loop externally (M14.15).
    pub references: Vec<String>,
    /// Search settings that replace the defaults.
    pub search: SearchSpace,
    /// Latest identification, with the job that produced it.
    pub found: Option<(
        IdentifyJob,
        Result<Arc<Identification>, IdentificationError>,
    )>,
    /// Whether the settings have changed since.
    pub changed: bool,
    /// End of the band \[rad/s\] used to choose the clock of resampled topics; `None` if unknown
    /// for some records.
    pub clock_band_end: Option<f64>,
    /// Records that the engineer has left out, whether or not they have parts.
    left_out: Vec<RecordSource>,
}

impl ConditionRecords {
    /// Creates the records of a condition of `dataset`.
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

    /// Adds a part of a record as a record behind it; the whole is no longer used, because evidence
    /// counts once.
    ///
    /// # Errors
    /// A message, if the record has no samples at that time.
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

    /// Returns whether some records are parts of this one.
    fn has_parts(&self, source: &RecordSource) -> bool {
        self.rows
            .iter()
            .any(|row| row.table.part_s.is_some() && row.table.source == *source)
    }

    /// Adds a record unless it is already loaded. A record from a changed file replaces the earlier
    /// one; `read_from` gives the paths of files. A different record with the same name gets a
    /// number after its name.
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

    /// Removes a part of a record. If it was the last part, the whole record is used again, unless
    /// the engineer left it out.
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

    /// Returns the cautions about the identification, each with the rows it concerns, if any; none
    /// once the settings have changed.
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

    /// Returns short marks, with a caution sign, for the cautions with a code.
    pub fn marks(&self, code: &'static str) -> impl Iterator<Item = String> {
        self.cautions()
            .filter(move |(_, note)| note.code == code)
            .map(|(_, note)| format!("⚠ {}", note.mark()))
    }

    /// Resamples topics to the clock required by the identification band.
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

    /// Returns the row of a record of the identification.
    pub fn row_of_record(&self, record: usize) -> Option<usize> {
        self.used_rows().nth(record).map(|(index, _)| index)
    }

    /// Returns the preparation of a channel for editing.
    pub fn channel_mut(&mut self, signal: &Signal) -> Option<&mut ChannelPreparation> {
        match signal.role {
            ChannelSide::Input => self.inputs.get_mut(signal.index),
            ChannelSide::Output => self.outputs.get_mut(signal.index),
        }
    }

    /// Returns the preparation of the channels.
    pub fn preparation(&self) -> Preparation {
        Preparation {
            inputs: self.inputs.clone(),
            outputs: self.outputs.clone(),
            ..Preparation::of(&[], &[])
        }
    }

    /// Creates the identification job for the current settings, over a band \[rad/s\]; `channels`
    /// are those in the records.
    ///
    /// # Errors
    /// A message, if no record is used, all are held out, or one lacks a reference.
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

    /// Returns a record with the references added after its inputs.
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

    /// Returns the models to put into the condition, if an identification succeeded.
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

/// Target of an undo or redo step: the records of conditions on the other side of an edit. Only the
/// conditions changed by the edit are included.
#[derive(Clone, Debug, Default)]
pub struct RecordsBefore {
    /// Records by condition; `None` for a condition without loaded records.
    pub conditions: BTreeMap<ConditionId, Option<ConditionRecords>>,
    /// The added files and folders, if the edit changes them.
    pub sources: Option<Vec<PathBuf>>,
}

impl ConditionRecords {
    /// Returns these records, restored instead of `now`. Models identified since stay, marked as
    /// results of other records.
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

/// State of the Records view. Not saved: records stay in their files.
#[derive(Clone, Debug, Default)]
pub struct RecordsState {
    /// Records by condition; no entry means that the condition's records are not loaded yet.
    pub conditions: BTreeMap<ConditionId, ConditionRecords>,
    /// Whether the dataset is the example, which has embedded records.
    pub is_example: bool,
    pub page: RecordsPage,
    /// Sorting of the table of conditions.
    pub sorting: Sorting,
    /// Models whose responses to the same inputs are drawn.
    pub time_models: BTreeSet<TimeModel>,
    /// Whether dragging in the time charts selects parts.
    pub chooses_parts: bool,
    /// Input of the displayed spectrogram.
    pub spectrogram: Option<usize>,
    /// Search field to focus.
    pub advanced_field: Option<&'static str>,
    /// Path of files, as typed.
    pub path: String,
    /// The added files and folders.
    pub sources: Vec<PathBuf>,
    /// Paths of the files read, by SHA-256, to read records of changed files again.
    pub read_from: BTreeMap<String, PathBuf>,
    /// Form for a dataset made from the displayed records.
    pub wanted: WantedDataset,
    /// Name of the files being read.
    pub reading: Option<String>,
    /// Messages about unreadable content.
    pub faults: Vec<String>,
    /// Running and waiting identification jobs.
    pub running: Vec<IdentifyJob>,
    /// Number of conditions requested since the queue was last empty.
    pub asked: usize,
}

impl RecordsState {
    /// Returns a copy of the records of these conditions.
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

    /// Restores the records on the other side of an edit; returns the current ones.
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

    /// Returns the channels that lack a unit, with the numbers of affected records and conditions.
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

    /// Returns the poles identified in this session, condition by condition.
    pub fn known_poles(&self) -> KnownPoles {
        let found = |(id, records): (&ConditionId, &ConditionRecords)| {
            Some((*id, records.identification()?.poles.clone()))
        };
        self.conditions.iter().filter_map(found).collect()
    }

    /// Returns the flight records in use of every condition.
    pub fn history_records(&self) -> Vec<HistoryRecords> {
        let of_condition = |(id, records): (&ConditionId, &ConditionRecords)| {
            HistoryRecords::of(*id, &records.rows, records.preparation())
        };
        let all = self.conditions.iter().map(of_condition);
        all.filter(|of| !of.records.is_empty()).collect()
    }

    /// Returns the running or waiting job of a condition.
    pub fn running(&self, condition: ConditionId) -> Option<&IdentifyJob> {
        self.running.iter().find(|job| job.condition == condition)
    }

    /// Returns the running job, once it has reported a step.
    pub fn under_way(&self) -> Option<&IdentifyJob> {
        self.running.iter().find(|job| !job.news().step.is_empty())
    }

    /// Returns the identification jobs, that of the displayed condition first.
    pub fn by_urgency(&self, shown: ConditionId) -> Vec<IdentifyJob> {
        let mut jobs = self.running.clone();
        jobs.sort_by_key(|job| job.condition != shown);
        jobs
    }
}

/// Missing units in the records of all conditions.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct OpenUnits {
    /// Channels with their units in the dataset.
    pub channels: Vec<(String, String)>,
    /// Number of records that lack some of these units.
    pub records: usize,
    /// Number of these records' conditions.
    pub conditions: usize,
    /// The first of these conditions.
    pub first: Option<ConditionId>,
}

/// Form for a dataset made from records, as typed.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct WantedDataset {
    /// Inputs, in the syntax of [`ChannelList`].
    pub inputs: String,
    /// Outputs, in the same syntax.
    pub outputs: String,
    /// Lower and upper end of the band \[rad/s\].
    pub band: [String; 2],
    pub path: String,
    /// Description of the records' columns.
    pub columns: Vec<String>,
    /// Reasons why the dataset could not be made.
    pub problems: Vec<String>,
}

impl WantedDataset {
    /// Creates a proposal from the records of a condition: the channels known from the
    /// documentation of their system; others must be typed.
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
        // Topics not yet joined to a channel are separate records, named after their variables.
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

    /// Parses the requested channels and the band.
    ///
    /// # Errors
    /// Messages about invalid channels or an invalid band.
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

/// A model that can be compared with a record in time.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum TimeModel {
    /// The recommended identified model.
    Identified,
    /// The physics representative.
    Physics,
    /// The corrected physics representative.
    Corrected,
}

impl TimeModel {
    /// All models, in display order.
    pub const ALL: [Self; 3] = [Self::Identified, Self::Physics, Self::Corrected];

    /// Returns the name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Identified => "identified",
            Self::Physics => "physics",
            Self::Corrected => "corrected",
        }
    }

    /// Returns the colour of the model's lines.
    pub fn color(self, palette: &Palette) -> Color32 {
        match self {
            Self::Identified => palette.accent,
            Self::Physics => palette.nominal,
            Self::Corrected => palette.corrected,
        }
    }
}
