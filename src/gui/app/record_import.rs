//! Flight records in the window: reads them in a thread and carries out the commands of the Records
//! view.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use gdcm_io::files::dataset_file::add_dataset;
use gdcm_io::import::record_files::{example_records, load_records, read_records, relative_entry};
use gdcm_io::reading_budget::ReadingBudget;
use gdcm_io::{DatasetOrigin, FileError, FolderProgress};
use gdcm_model::dataset::condition::{ChannelRemedy, ConditionRecord};
use gdcm_model::dataset::{Band, ConditionId, Dataset};
use gdcm_model::names::ChannelRule;
use gdcm_model::simulation::Signal;
use gdcm_study::Edit;
use gdcm_study::decisions::adopted_models::{AdoptedModels, OfferedModels};
use gdcm_study::jobs::identification_jobs::IdentifyJob;
use gdcm_sysid::identification::{Identification, IdentificationError};
use gdcm_sysid::records::dataset_of_records::dataset_of_records;
use gdcm_sysid::records::{
    LaidOutRecord, RecordChannels, RecordLayout, RecordTable, TimeWish, leave_out_copies,
    with_topics_joined,
};

use super::GdcmApp;
use super::dialogs::DialogPurpose;
use super::document_files::DatasetOfRecords;
use super::readers::Untold;
use crate::gui::commands::records::RecordsCommand;
use crate::gui::commands::selection::SelectionCommand;
use crate::gui::state::forms::FormKind;
use crate::gui::state::records::{
    AddedRecord, ConditionRecords, RecordsBefore, RecordsPage, WantedDataset,
};
use crate::gui::state::requirements_page::RequirementsPage;
use crate::gui::state::view::View;

/// Records read, by condition, and the faults found.
#[derive(Default)]
struct ReadRecords {
    /// Records that belong to conditions without loaded records.
    own: BTreeMap<ConditionId, Vec<LaidOutRecord>>,
    /// Records from the added files.
    added: BTreeMap<ConditionId, Vec<LaidOutRecord>>,
    faults: Vec<String>,
    /// Paths of the files, by SHA-256.
    read_from: BTreeMap<String, PathBuf>,
}

/// Source of the records that belong to conditions, for a reading thread.
#[derive(Clone)]
struct OwnRecords {
    dataset: Arc<Dataset>,
    origin: DatasetOrigin,
}

impl GdcmApp {
    /// Carries out a command about flight records.
    pub(super) fn records(&mut self, command: RecordsCommand) {
        let condition = self.state.condition().id();
        match command {
            RecordsCommand::Add(paths) => self.add_records(paths),
            RecordsCommand::AskDataset => self.ask_record_dataset(),
            RecordsCommand::MakeDataset => self.make_record_dataset(),
            RecordsCommand::AskFiles => self.ask_path(DialogPurpose::RecordFolder, String::new()),
            RecordsCommand::Show(page) => self.state.records.page = page,
            RecordsCommand::ChooseParts(chooses) => self.state.records.chooses_parts = chooses,
            RecordsCommand::ShowSpectrogram(input) => self.state.records.spectrogram = input,
            RecordsCommand::ShowTimeModel(model, true) => {
                self.state.records.time_models.insert(model);
            }
            RecordsCommand::ShowTimeModel(model, false) => {
                self.state.records.time_models.remove(&model);
            }
            RecordsCommand::Identify => self.identify_conditions(&[condition]),
            RecordsCommand::IdentifyAll => {
                let all = self
                    .state
                    .records
                    .conditions
                    .iter()
                    .filter(|(_, of)| of.used_rows().next().is_some());
                let all: Vec<ConditionId> = all.map(|(id, _)| *id).collect();
                self.identify_conditions(&all);
            }
            RecordsCommand::Stop => self.stop_identifying(),
            RecordsCommand::Take(offered) => self.take_identified(&[condition], offered),
            RecordsCommand::TakeAll(offered) => {
                let all: Vec<ConditionId> = self.state.records.conditions.keys().copied().collect();
                self.take_identified(&all, offered);
            }
            RecordsCommand::Return => self.decide(&Edit::ReturnModels { condition }),
            RecordsCommand::ShowAdvanced(field) => self.state.records.advanced_field = Some(field),
            RecordsCommand::Choose(index) => {
                if let Some(records) = self.state.records.conditions.get_mut(&condition) {
                    records.choose(index);
                }
            }
            RecordsCommand::SetLayout(index, layout) => self.set_layout(condition, index, &layout),
            RecordsCommand::TakeDatasetUnits => self.take_dataset_units(),
            RecordsCommand::ShowUnclear => self.show_unclear(),
            said => self.edit_records(condition, said),
        }
    }

    /// Applies an edit to the records of a condition as one undoable step.
    fn edit_records(&mut self, condition: ConditionId, command: RecordsCommand) {
        let channels = self.record_channels(condition);
        let before = self.state.records.before([condition]);
        let Some(records) = self.state.records.conditions.get_mut(&condition) else {
            return;
        };
        let label = format!("{} (condition {condition})", edit_words(records, &command));
        match say(records, command, &channels) {
            Ok(true) => {
                records.changed = true;
                self.record_edited(label, before);
                self.follow_band(condition);
            }
            Ok(false) => {}
            Err(why) => self.notify_error(why),
        }
    }

    /// Adds an edit of records to the history.
    fn record_edited(&mut self, label: String, before: RecordsBefore) {
        let study = self.state.study.clone();
        self.state.history.record_beside(study, label, before);
        self.state.notice = None;
    }

    /// Applies a layout to one record, and to every record whose columns have the same names.
    /// Records named in the dataset follow its layout, so a change spreads only among named records
    /// or only among unnamed ones.
    fn set_layout(&mut self, condition: ConditionId, index: usize, layout: &RecordLayout) {
        let dataset = Arc::clone(&self.state.study.dataset);
        let of_condition = self.state.records.conditions.get(&condition);
        let Some(row) = of_condition.and_then(|records| records.rows.get(index)) else {
            return;
        };
        let edited = (Arc::clone(&row.table), row.layout.clone());
        let table = &edited.0;
        let former = &edited.1;
        let is_named = table.entry_of_dataset(&dataset).is_some();
        let label = format!("columns of {}", table.name);
        let is_told = |id: ConditionId| id == condition || !is_named;
        self.edit_layouts(label, |id, of| {
            if Arc::ptr_eq(&of.table, table) && of.layout == *former {
                return Some(layout.clone());
            }
            let is_alike = of.table.entry_of_dataset(&dataset).is_some() == is_named;
            (is_told(id) && is_alike)
                .then(|| of.layout.following(&of.table, [former, layout], table))
        });
    }

    /// Assumes the dataset channel's unit wherever a file states none.
    fn take_dataset_units(&mut self) {
        let label = "units of the dataset's channels".to_owned();
        self.edit_layouts(label, |_, of| Some(of.layout.in_units_of_channels()));
    }

    /// Changes the layouts of records in all conditions as one undoable step.
    fn edit_layouts(
        &mut self,
        label: String,
        layout_of: impl Fn(ConditionId, &LaidOutRecord) -> Option<RecordLayout>,
    ) {
        let ids: Vec<ConditionId> = self.state.records.conditions.keys().copied().collect();
        let mut changed = RecordsBefore::default();
        for id in ids {
            let channels = self.record_channels(id);
            let before = self.state.records.conditions.get(&id).cloned();
            let Some(records) = self.state.records.conditions.get_mut(&id) else {
                continue;
            };
            let mut is_changed = false;
            let mut is_any_clear_now = false;
            for row in &mut records.rows {
                if let Some(layout) = layout_of(id, row).filter(|layout| *layout != row.layout) {
                    let was_clear = row.flight.is_some();
                    *row = row.laid_out(layout, &channels);
                    is_changed = true;
                    is_any_clear_now |= !was_clear && row.flight.is_some();
                }
            }
            if is_any_clear_now {
                leave_out_copies(&mut records.rows);
            }
            if is_changed {
                records.changed = true;
                changed.conditions.insert(id, before);
            }
        }
        if !changed.conditions.is_empty() {
            self.record_edited(label, changed);
        }
    }

    /// Shows the first record with missing units, on the Columns page.
    fn show_unclear(&mut self) {
        let Some(id) = self.state.records.open_units().and_then(|open| open.first) else {
            return;
        };
        if let Some(records) = self.state.records.conditions.get_mut(&id) {
            let is_unclear = |row: &LaidOutRecord| !row.problems.is_empty();
            let index = records
                .rows
                .iter()
                .position(is_unclear)
                .unwrap_or(records.chosen);
            records.choose(index);
        }
        self.state.records.page = RecordsPage::Columns;
        self.dispatch(SelectionCommand::SelectCondition(id));
    }

    /// Returns the identification band of a condition: its own, or the study's.
    fn identified_band(&self, condition: ConditionId) -> [f64; 2] {
        let of_study = self.state.study.settings.band;
        let own = self
            .state
            .records
            .conditions
            .get(&condition)
            .and_then(|records| records.band);
        own.unwrap_or([of_study.min(), of_study.max()])
    }

    /// Resamples the topics of a condition to the clock that its band requires, if that has
    /// changed.
    fn follow_band(&mut self, condition: ConditionId) {
        let [_, end] = self.identified_band(condition);
        let known = self
            .state
            .records
            .conditions
            .get(&condition)
            .map(|records| records.clock_band_end);
        if known.is_none_or(|known| known == Some(end)) {
            return;
        }
        let channels = self.record_channels(condition);
        if let Some(records) = self.state.records.conditions.get_mut(&condition) {
            records.follow_band(&channels);
        }
    }

    /// Returns the channels expected from the records of a condition: the dataset's, located as
    /// specified when the dataset was made from records. Topics are resampled for the
    /// identification band.
    fn record_channels(&self, condition: ConditionId) -> RecordChannels {
        let mut channels = RecordChannels::of_dataset(&self.state.study.dataset);
        let [_, end] = self.identified_band(condition);
        channels.resampling.band_end = Some(end);
        if let Some(made) = self.made_of_records() {
            let said: Vec<&ChannelRule> = made
                .channels
                .inputs
                .iter()
                .chain(&made.channels.outputs)
                .collect();
            for rule in channels.inputs.iter_mut().chain(&mut channels.outputs) {
                if let Some(said) = said.iter().find(|said| said.name == rule.name) {
                    rule.aliases.clone_from(&said.aliases);
                    rule.unit_in_files.clone_from(&said.unit_in_files);
                }
            }
        }
        channels
    }

    /// Returns how the displayed dataset was made from records, if it was.
    fn made_of_records(&self) -> Option<&DatasetOfRecords> {
        self.files
            .made_of_records
            .as_ref()
            .filter(|made| self.files.loaded.path() == Some(&made.path))
    }

    /// Asks for the channels of a new dataset, with a proposal based on the displayed record.
    fn ask_record_dataset(&mut self) {
        let condition = self.state.condition().id();
        let Some(records) = self.state.records.conditions.get(&condition) else {
            return;
        };
        let beside = self
            .state
            .records
            .sources
            .first()
            .map(|path| path.with_extension("json.gz"));
        let path = beside.map_or(String::new(), |path| path.display().to_string());
        self.state.records.wanted =
            WantedDataset::proposed(records, self.state.study.settings.band, path);
        self.state.forms.shown = Some(FormKind::RecordDataset);
    }

    /// Makes a dataset with the requested channels from the added files, in a thread; writes and
    /// opens it.
    fn make_record_dataset(&mut self) {
        let records = &mut self.state.records;
        records.wanted.problems.clear();
        let (channels, band) = match records.wanted.channels() {
            Ok(said) => said,
            Err(why) => return records.wanted.problems.push(why),
        };
        let sources = records.sources.clone();
        let typed = PathBuf::from(records.wanted.path.trim());
        let path = self.files.at_home(typed);
        let (number, stop) = self.readers.record_reader.join();
        self.state.records.reading = Some("records".to_owned());
        let make = move || dataset_of_files(&sources, channels, band, path, &Untold(stop));
        self.in_thread("a dataset of records", make, move |app, made| {
            if !app.readers.record_reader.is_newest(number) {
                return;
            }
            app.state.records.reading = None;
            match made {
                Some(Ok((dataset, made))) => app.write_record_dataset(&dataset, made),
                Some(Err(problems)) => app.state.records.wanted.problems = problems,
                None => {}
            }
        });
    }

    fn write_record_dataset(&mut self, dataset: &Dataset, made: DatasetOfRecords) {
        match self.write_all(&[&made.path], |outputs| {
            add_dataset(dataset, &made.path, outputs)
        }) {
            Ok(()) => {
                self.state.forms.shown = None;
                self.open(made.path.clone(), None);
                self.files.made_of_records = Some(made);
            }
            Err(error) => self.written(
                Err(error),
                FormKind::RecordDataset,
                RecordsCommand::MakeDataset.into(),
            ),
        }
    }

    /// Reads the records that belong to the displayed condition, once a view that needs them is
    /// shown.
    pub(super) fn look_for_records(&mut self) {
        let id = self.state.condition().id();
        self.follow_band(id);
        let display = &self.state.display;
        let is_compared = display.judging.requirements_page == RequirementsPage::Histories;
        let is_shown = display.layout.arrangement.is_shown(View::Records)
            || display.layout.arrangement.is_shown(View::Requirements) && is_compared;
        let bench = &self.state.records;
        if !is_shown || bench.reading.is_some() || bench.conditions.contains_key(&id) {
            return;
        }
        self.state.records.is_example = self.files.loaded.origin == DatasetOrigin::EmbeddedExample;
        let own = self.own_records();
        if !own.has_some(id) {
            self.records_of(id);
            return;
        }
        let name = format!("the records of condition {id}");
        let sources = self.state.records.sources.clone();
        self.read_in_thread(name, sources, move |channels, stop| {
            let mut found = ReadRecords::default();
            own.read(&[id], channels, &stop, &mut found)?;
            Ok(found)
        });
    }

    /// Returns the source of the records that belong to conditions.
    fn own_records(&self) -> OwnRecords {
        OwnRecords {
            dataset: Arc::clone(&self.state.study.dataset),
            origin: self.files.loaded.origin.clone(),
        }
    }

    fn add_records(&mut self, paths: Vec<PathBuf>) {
        let paths: Vec<PathBuf> = paths
            .into_iter()
            .map(|path| self.files.at_home(path))
            .collect();
        let sources = self.state.records.sources.clone();
        self.state.records.sources.extend(paths.iter().cloned());
        let name = paths
            .first()
            .map_or(String::new(), |path| path.display().to_string());
        let shown = self.state.condition().id();
        let known = self.state.records.conditions.keys().copied().collect();
        let own = self.own_records();
        self.read_in_thread(name, sources, move |channels, stop| {
            of_files((&own, channels), shown, &paths, &known, &Untold(stop))
        });
    }

    /// Reads records in a thread; `sources` are the files added earlier.
    fn read_in_thread(
        &mut self,
        name: String,
        sources: Vec<PathBuf>,
        read: impl FnOnce(&RecordChannels, Arc<AtomicBool>) -> Result<ReadRecords, FileError>
        + Send
        + 'static,
    ) {
        let channels = self.record_channels(self.state.condition().id());
        let clock_band_end = channels.resampling.band_end;
        let of = Arc::clone(self.state.study.file_dataset());
        self.state.records.reading = Some(name);
        let (number, stop) = self.readers.record_reader.join();
        let read = move || read(&channels, stop);
        self.in_thread("the reading of records", read, move |app, found| {
            if !app.readers.record_reader.is_newest(number)
                || !Arc::ptr_eq(&of, app.state.study.file_dataset())
            {
                return;
            }
            app.state.records.reading = None;
            if let Some(found) = found.and_then(|found| app.unless_error(found)) {
                app.take_records(found, clock_band_end, sources);
            }
            // An entry, even an empty one, prevents a repeated search.
            app.records_of(app.state.condition().id());
        });
    }

    /// Returns the records of a condition, initially empty.
    pub(super) fn records_of(&mut self, id: ConditionId) -> &mut ConditionRecords {
        let nothing = || ConditionRecords::new(Vec::new(), &self.state.study.dataset);
        self.state
            .records
            .conditions
            .entry(id)
            .or_insert_with(nothing)
    }

    fn take_records(
        &mut self,
        found: ReadRecords,
        clock_band_end: Option<f64>,
        sources: Vec<PathBuf>,
    ) {
        let ReadRecords {
            own,
            added,
            faults,
            read_from,
        } = found;
        let left_out = self
            .made_of_records()
            .into_iter()
            .flat_map(|made| made.left_out.iter().cloned());
        self.state.records.faults = faults.into_iter().chain(left_out).collect();
        self.state.records.read_from.extend(read_from);
        let own_count: usize = own.values().map(Vec::len).sum();
        for (id, rows) in own {
            if self.state.records.conditions.contains_key(&id) {
                continue;
            }
            let records = self.records_of(id);
            records.rows = rows;
            records.clock_band_end = clock_band_end;
            leave_out_copies(&mut records.rows);
            records.changed = true;
        }
        if added.is_empty() {
            if own_count > 0 {
                self.done(counted_records(own_count));
            }
            return;
        }
        self.add_read_records(added, clock_band_end, sources);
    }

    /// Adds the records read to their conditions as one undoable step.
    fn add_read_records(
        &mut self,
        added: BTreeMap<ConditionId, Vec<LaidOutRecord>>,
        clock_band_end: Option<f64>,
        sources: Vec<PathBuf>,
    ) {
        let mut before = self.state.records.before(added.keys().copied());
        before.sources = Some(sources);
        let mut counts = AddedCounts::default();
        let read_from = self.state.records.read_from.clone();
        for (id, rows) in added {
            let records = self.records_of(id);
            let is_known = records.rows.is_empty() || records.clock_band_end == clock_band_end;
            let mut is_changed = false;
            for row in rows {
                let became = records.add_row(row, &read_from);
                is_changed |= became != AddedRecord::KnownAlready;
                counts.count(became);
            }
            if is_changed {
                records.clock_band_end = clock_band_end.filter(|_| is_known);
                leave_out_copies(&mut records.rows);
                records.choose(records.chosen);
                records.changed = true;
                counts.conditions += 1;
            } else {
                before.conditions.remove(&id);
            }
        }
        if !before.conditions.is_empty() {
            self.record_edited(
                format!("add {}", counted_records(counts.new + counts.read_again)),
                before,
            );
        }
        self.done(counts.words());
    }

    /// Stops running and waiting identification jobs; they can be started again.
    pub(super) fn stop_identifying(&mut self) {
        let left = std::mem::take(&mut self.state.records.running).len();
        let asked = self.state.records.asked;
        if asked > 1 && left > 0 {
            self.done(format!(
                "stopped identifying after {} of {asked} conditions",
                asked.saturating_sub(left)
            ));
        }
    }

    fn identify_conditions(&mut self, conditions: &[ConditionId]) {
        if self.state.records.running.is_empty() {
            self.state.records.asked = 0;
        }
        let mut refusal = None;
        for id in conditions {
            self.follow_band(*id);
            let band = self.identified_band(*id);
            let channels = self.record_channels(*id);
            let Some(records) = self.state.records.conditions.get(id) else {
                continue;
            };
            match records.job(*id, band, &channels) {
                Ok(job) => {
                    let waiting = self.state.records.running.len();
                    self.state
                        .records
                        .running
                        .retain(|other| other.condition != *id);
                    self.state.records.asked +=
                        usize::from(waiting == self.state.records.running.len());
                    self.state.records.running.push(job);
                }
                Err(why) => refusal = Some(format!("condition {id}: {why}")),
            }
        }
        self.state.records.page = match self.state.records.page {
            RecordsPage::Histories | RecordsPage::Columns | RecordsPage::Inputs => {
                RecordsPage::Response
            }
            page => page,
        };
        if let Some(why) = refusal {
            self.notify_error(why);
        }
    }

    /// Stores the outcome of an identification.
    pub(super) fn identified(
        &mut self,
        job: IdentifyJob,
        found: Result<Arc<Identification>, IdentificationError>,
    ) {
        if !self.state.records.running.contains(&job) {
            // Stopped in the meantime.
            return;
        }
        self.state.records.running.retain(|other| *other != job);
        if self.state.records.running.is_empty() && self.state.records.asked > 1 {
            self.done(format!(
                "finished: models of {} conditions identified",
                self.state.records.asked
            ));
            self.state.records.page = RecordsPage::Conditions;
        }
        if let Some(records) = self.state.records.conditions.get_mut(&job.condition) {
            records.changed = false;
            records.found = Some((job, found));
        }
    }

    fn take_identified(&mut self, conditions: &[ConditionId], offered: OfferedModels) {
        let of = |id: &ConditionId| {
            let records = self.state.records.conditions.get(id)?;
            Some((*id, records.taken(offered, &self.record_channels(*id))?))
        };
        let taken: Vec<(ConditionId, Arc<AdoptedModels>)> =
            conditions.iter().filter_map(of).collect();
        if taken.is_empty() {
            return self.notify_error("nothing was identified yet".to_owned());
        }
        let models: usize = taken.iter().map(|(_, models)| models.models.len()).sum();
        let names: Vec<String> = taken.iter().map(|(id, _)| id.to_string()).collect();
        let before = self.state.study.clone();
        self.decide(&Edit::TakeModels(taken));
        if self.state.study != before {
            let conditions = if names.len() == 1 {
                "condition"
            } else {
                "conditions"
            };
            self.done(format!(
                "took {models} models into {conditions} {}",
                names.join(", ")
            ));
        }
    }
}

/// Applies `change` to a value if it exists.
fn set<T>(of: Option<&mut T>, change: impl FnOnce(&mut T)) {
    if let Some(of) = of {
        change(of);
    }
}

/// Counts of added records by outcome, and of conditions with new records.
#[derive(Default)]
struct AddedCounts {
    new: usize,
    read_again: usize,
    known: usize,
    conditions: usize,
}

impl AddedCounts {
    fn count(&mut self, became: AddedRecord) {
        match became {
            AddedRecord::New => self.new += 1,
            AddedRecord::ReadAgain => self.read_again += 1,
            AddedRecord::KnownAlready => self.known += 1,
        }
    }

    /// "81 records of 9 conditions added; 18 were there already".
    fn words(&self) -> String {
        let of = if self.conditions > 1 {
            format!(" of {} conditions", self.conditions)
        } else {
            String::new()
        };
        let mut parts = Vec::new();
        if self.new > 0 {
            parts.push(format!("{}{of} added", counted_records(self.new)));
        }
        if self.read_again > 0 {
            parts.push(format!("{} read again", counted_records(self.read_again)));
        }
        if self.known > 0 && parts.is_empty() {
            parts.push(format!(
                "nothing added: {} there already",
                counted_records(self.known)
            ));
        } else if self.known > 0 {
            parts.push(format!("{} there already", self.known));
        }
        parts.join("; ")
    }
}

fn counted_records(count: usize) -> String {
    if count == 1 {
        "1 record".to_owned()
    } else {
        format!("{count} records")
    }
}

/// Returns the undo label of an edit of records.
fn edit_words(records: &ConditionRecords, command: &RecordsCommand) -> String {
    let name = |index: &usize| {
        records
            .rows
            .get(*index)
            .map_or("a record", |row| row.table.name.as_str())
    };
    match command {
        RecordsCommand::SetKind(index, kind) => format!("{} is a {}", name(index), kind.word()),
        RecordsCommand::SetUsed(index, true) => format!("use {}", name(index)),
        RecordsCommand::SetUsed(index, false) => format!("leave {} out", name(index)),
        RecordsCommand::SetHeldOut(index, true) => format!("hold {} out", name(index)),
        RecordsCommand::SetHeldOut(index, false) => format!("fit {}", name(index)),
        RecordsCommand::SetDelay(signal, _) => format!("time skew of {}", signal.name),
        RecordsCommand::SetRemedies(index, _) => format!("put {} right", name(index)),
        RecordsCommand::SetHold(signal, _) => format!("hold of {}", signal.name),
        RecordsCommand::SetBand(_) => "band of the identification".to_owned(),
        RecordsCommand::SetSearch(_) => "search of the identification".to_owned(),
        RecordsCommand::SetReferences(_) => "references".to_owned(),
        RecordsCommand::AddPart(index, _) => format!("part of {}", name(index)),
        RecordsCommand::RemovePart(index) => format!("remove {}", name(index)),
        _ => "records".to_owned(),
    }
}

/// Applies an edit to the records of a condition; returns whether the command is such an edit.
///
/// # Errors
/// A message, if the edit is impossible.
fn say(
    records: &mut ConditionRecords,
    command: RecordsCommand,
    channels: &RecordChannels,
) -> Result<bool, String> {
    match command {
        RecordsCommand::SetUsed(index, used) => return Ok(records.set_used(index, used)),
        RecordsCommand::AddPart(index, part_s) => {
            return records.add_part(index, part_s, channels).map(|()| true);
        }
        RecordsCommand::RemovePart(index) => return Ok(records.remove_part(index)),
        RecordsCommand::SetKind(index, kind) => {
            set(records.rows.get_mut(index), |row| row.guess.kind = kind)
        }
        RecordsCommand::SetHeldOut(index, held_out) => {
            set(records.rows.get_mut(index), |row| {
                row.guess.held_out = held_out
            });
        }
        RecordsCommand::SetDelay(signal, delay_s) => {
            set(records.channel_mut(&signal), |channel| {
                channel.delay_s = delay_s
            });
        }
        RecordsCommand::SetRemedies(index, remedies) => {
            set_remedies(records, index, &remedies, channels)
        }
        RecordsCommand::SetHold(signal, hold) => {
            set(records.channel_mut(&signal), |channel| channel.hold = hold)
        }
        RecordsCommand::SetBand(band) => records.band = band,
        RecordsCommand::SetSearch(search) => records.search = search,
        RecordsCommand::SetReferences(references) => records.references = references,
        _ => return Ok(false),
    }
    Ok(true)
}

/// Sets the remedies of channels in a single record.
fn set_remedies(
    records: &mut ConditionRecords,
    index: usize,
    remedies: &[(Signal, ChannelRemedy)],
    channels: &RecordChannels,
) {
    let Some(row) = records.rows.get_mut(index) else {
        return;
    };
    let mut layout = row.layout.clone();
    for (signal, remedy) in remedies {
        set(layout.channel_mut(signal.role, signal.index), |used| {
            used.remedy = *remedy
        });
    }
    *row = row.laid_out(layout, channels);
}

/// Lays out a record, following the dataset's entry for it if there is one.
fn row_of(
    table: RecordTable,
    channels: &RecordChannels,
    dataset: Option<&Dataset>,
) -> LaidOutRecord {
    let time = TimeWish::default();
    let (mut row, notes) = match dataset {
        Some(dataset) => LaidOutRecord::as_dataset_says(table, channels, dataset, &time),
        None => LaidOutRecord::proposed(table, channels, &time),
    };
    if row.layout.is_resampled(&row.table, channels) {
        Arc::make_mut(&mut row.table).notes.extend(notes);
    }
    row
}

impl OwnRecords {
    /// Returns whether a condition may have records of its own.
    fn has_some(&self, id: ConditionId) -> bool {
        match &self.origin {
            DatasetOrigin::EmbeddedExample => true,
            DatasetOrigin::File(_) => !self.entries(id).is_empty(),
        }
    }

    fn entries(&self, id: ConditionId) -> &[ConditionRecord] {
        self.dataset
            .condition(id)
            .map_or(&[], |condition| condition.records())
    }

    /// Reads the records of conditions: those named by the dataset, or the embedded ones of the
    /// example.
    fn read(
        &self,
        ids: &[ConditionId],
        channels: &RecordChannels,
        stop: &Arc<AtomicBool>,
        found: &mut ReadRecords,
    ) -> Result<(), FileError> {
        let channels = &channels.clone().of_named_records();
        for id in ids {
            let rows = found.own.entry(*id).or_default();
            if self.origin == DatasetOrigin::EmbeddedExample {
                rows.extend(
                    example_records(id.0)?
                        .into_iter()
                        .map(|table| row_of(table, channels, None)),
                );
            }
        }
        if let DatasetOrigin::File(path) = &self.origin {
            let folder = path.parent().unwrap_or(Path::new(""));
            self.read_entries(ids, channels, folder, stop, found);
        }
        Ok(())
    }

    /// Reads the records named by the dataset; a file with several records is read once.
    fn read_entries(
        &self,
        ids: &[ConditionId],
        channels: &RecordChannels,
        folder: &Path,
        stop: &Arc<AtomicBool>,
        found: &mut ReadRecords,
    ) {
        let mut of_files: BTreeMap<&str, Vec<(ConditionId, &ConditionRecord)>> = BTreeMap::new();
        for id in ids {
            for entry in self.entries(*id) {
                of_files.entry(&entry.file).or_default().push((*id, entry));
            }
        }
        for (file, entries) in of_files {
            let variables: Vec<Option<&str>> = entries
                .iter()
                .map(|(_, entry)| entry.variable.as_deref())
                .collect();
            let budget = ReadingBudget::default().stopped_by(Arc::clone(stop));
            let path = folder.join(file);
            let tables = match load_records(&path, &variables, &budget) {
                Ok(tables) => tables,
                Err(error) => {
                    found.faults.push(error.to_string());
                    continue;
                }
            };
            for ((id, entry), table) in entries.into_iter().zip(tables) {
                match table {
                    Ok(table) => {
                        found
                            .read_from
                            .insert(table.source.sha256.clone(), real_path(&path));
                        let table = RecordTable {
                            name: entry.name.clone(),
                            part_s: entry.part_s,
                            ..table
                        };
                        let row = row_of(table, channels, None).as_said(entry, channels);
                        found.own.entry(id).or_default().push(row);
                    }
                    Err(error) => found.faults.push(error.to_string()),
                }
            }
        }
    }
}

/// Returns the canonical path, or the path as given if the file system cannot resolve it.
fn real_path(path: &Path) -> PathBuf {
    path.canonicalize().unwrap_or_else(|_| path.to_owned())
}

/// Finds the file of a record among the requested paths: a path itself, or a file inside a
/// requested folder.
fn place_of(file: &str, asked: &[PathBuf]) -> Option<PathBuf> {
    asked.iter().find_map(|path| {
        let is_it = path
            .file_name()
            .is_some_and(|name| name.to_string_lossy() == file);
        let below = path.join(file);
        if is_it {
            Some(real_path(path))
        } else if below.is_file() {
            Some(real_path(&below))
        } else {
            None
        }
    })
}

/// Reads the records of files and assigns each to the condition in its name, or else to the
/// displayed one. Also reads the own records of these conditions if they are not loaded yet.
fn of_files(
    (own, channels): (&OwnRecords, &RecordChannels),
    shown: ConditionId,
    paths: &[PathBuf],
    known: &BTreeSet<ConditionId>,
    progress: &Untold,
) -> Result<ReadRecords, FileError> {
    let read = read_records(paths, progress)?;
    let mut found = ReadRecords {
        faults: read.faults,
        ..ReadRecords::default()
    };
    found.faults.extend(
        read.ignored
            .into_iter()
            .map(|words| format!("no record: {words}")),
    );
    for table in with_topics_joined(read.tables, channels, &TimeWish::default()) {
        if let Some(path) = place_of(&table.source.file, paths) {
            found.read_from.insert(table.source.sha256.clone(), path);
        }
        let row = row_of(table, channels, Some(&own.dataset));
        let id = row.guess.condition_of(&own.dataset).unwrap_or(shown);
        found.added.entry(id).or_default().push(row);
    }
    let unknown: Vec<ConditionId> = found
        .added
        .keys()
        .copied()
        .filter(|id| !known.contains(id))
        .collect();
    own.read(&unknown, channels, &progress.stop(), &mut found)?;
    Ok(found)
}

/// Maximum number of reported problems.
const MOST_PROBLEMS: usize = 6;

/// Builds a dataset, to be written to `path`, from the records in these files that contain the
/// requested channels; fills in the units of the channels.
fn dataset_of_files(
    sources: &[PathBuf],
    mut channels: RecordChannels,
    band: Band,
    path: PathBuf,
    progress: &Untold,
) -> Result<(Dataset, DatasetOfRecords), Vec<String>> {
    let read = read_records(sources, progress).map_err(|error| vec![error.to_string()])?;
    let mut problems: Vec<String> = read.faults;
    let mut entries = Vec::new();
    for table in with_topics_joined(read.tables, &channels, &TimeWish::default()) {
        let (row, _) = LaidOutRecord::proposed(table, &channels, &TimeWish::default());
        problems.extend(
            row.problems
                .iter()
                .map(|problem| format!("{}: {problem}", row.table.name)),
        );
        if row.problems.is_empty() {
            channels.take_units(&row.layout, &row.table);
            let entry = row
                .layout
                .condition_record(&row.table, &row.guess, &channels);
            entries.push(relative_entry(entry, sources, &path));
        }
    }
    if entries.is_empty() {
        problems.truncate(MOST_PROBLEMS);
        return Err(problems);
    }
    let name = path
        .file_name()
        .map_or(String::new(), |name| name.to_string_lossy().into_owned());
    let name = name.split('.').next().unwrap_or_default();
    let dataset = dataset_of_records(name, &channels, band, entries)
        .map_err(|error| vec![error.to_string()])?;
    let left_out = problems
        .into_iter()
        .map(|why| format!("left out of the dataset: {why}"))
        .collect();
    Ok((
        dataset,
        DatasetOfRecords {
            path,
            channels,
            left_out,
        },
    ))
}
