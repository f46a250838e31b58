//! Flight records in the window: reading them in a thread, and what becomes of the wishes about them.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use gdcm_core::assembly::ChannelRule;
use gdcm_core::dataset::{Band, ChannelRemedy, ConditionId, ConditionRecord, Dataset};
use gdcm_core::identification::{Identification, IdentificationError, Signal};
use gdcm_core::records::{
    LaidOutRecord, RecordChannels, RecordLayout, RecordTable, TimeWish, dataset_of_records, leave_out_copies,
    with_topics_joined,
};
use gdcm_core::study::{AdoptedModels, Edit, IdentifyJob, OfferedModels};
use gdcm_files::variables::ReadingBudget;
use gdcm_files::{DatasetOrigin, FileError, add_dataset, example_records, load_records, read_records, relative_entry};

use super::threads::Untold;
use super::{DialogPurpose, GdcmApp};
use crate::view::records::{ConditionRecords, RecordsCommand, RecordsPage, WantedDataset};
use crate::view::views::RequirementsPage;
use crate::view::{FormKind, View};

/// Records that were read, by condition, and what could not be.
#[derive(Default)]
struct ReadRecords {
    rows: BTreeMap<ConditionId, Vec<LaidOutRecord>>,
    faults: Vec<String>,
}

impl GdcmApp {
    /// Carries out a wish about flight records.
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
            RecordsCommand::ShowTimeModel(model, true) => drop(self.state.records.time_models.insert(model)),
            RecordsCommand::ShowTimeModel(model, false) => drop(self.state.records.time_models.remove(&model)),
            RecordsCommand::Identify => self.identify_conditions(&[condition]),
            RecordsCommand::IdentifyAll => {
                let all = self.state.records.conditions.iter().filter(|(_, of)| of.used_rows().next().is_some());
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
            said => {
                let channels = self.record_channels(condition);
                if let Some(records) = self.state.records.conditions.get_mut(&condition) {
                    say(records, said, &channels);
                }
                self.follow_band(condition);
            }
        }
    }

    /// The band that a condition is identified over: its own, or the study's.
    fn identified_band(&self, condition: ConditionId) -> [f64; 2] {
        let of_study = self.state.study.settings.band;
        let own = self.state.records.conditions.get(&condition).and_then(|records| records.band);
        own.unwrap_or([of_study.min(), of_study.max()])
    }

    /// Brings the topics of a condition to the clock that its band takes, where that has changed.
    fn follow_band(&mut self, condition: ConditionId) {
        let [_, end] = self.identified_band(condition);
        let known = self.state.records.conditions.get(&condition).map(|records| records.clock_band_end);
        if known.is_none_or(|known| known == Some(end)) {
            return;
        }
        let channels = self.record_channels(condition);
        if let Some(records) = self.state.records.conditions.get_mut(&condition) {
            records.follow_band(&channels);
        }
    }

    /// The channels that the records of a condition are to give: those of the dataset, found where it was said when the dataset was made
    /// of records; topics are brought to a clock for the band that is identified over.
    fn record_channels(&self, condition: ConditionId) -> RecordChannels {
        let mut channels = RecordChannels::of_dataset(&self.state.study.dataset);
        let [_, end] = self.identified_band(condition);
        channels.resampling.band_end = Some(end);
        if let Some(made) = self.made_of_records() {
            let said: Vec<&ChannelRule> = made.channels.inputs.iter().chain(&made.channels.outputs).collect();
            for rule in channels.inputs.iter_mut().chain(&mut channels.outputs) {
                if let Some(said) = said.iter().find(|said| said.name == rule.name) {
                    rule.aliases.clone_from(&said.aliases);
                    rule.unit_in_files.clone_from(&said.unit_in_files);
                }
            }
        }
        channels
    }

    /// How the dataset shown was made of records, where it was.
    fn made_of_records(&self) -> Option<&DatasetOfRecords> {
        self.made_of_records.as_ref().filter(|made| self.loaded.path() == Some(&made.path))
    }

    /// Asks of which channels a dataset is to be made, with what is proposed for the record shown.
    fn ask_record_dataset(&mut self) {
        let condition = self.state.condition().id();
        let Some(records) = self.state.records.conditions.get(&condition) else { return };
        let beside = self.state.records.sources.first().map(|path| path.with_extension("json.gz"));
        let path = beside.map_or(String::new(), |path| path.display().to_string());
        self.state.records.wanted = WantedDataset::proposed(records, self.state.study.settings.band, path);
        self.state.forms.shown = Some(FormKind::RecordDataset);
    }

    /// Makes a dataset of the channels asked for, from the files added, in a thread; it is written and opened.
    fn make_record_dataset(&mut self) {
        let records = &mut self.state.records;
        records.wanted.problems.clear();
        let (channels, band) = match records.wanted.channels() {
            Ok(said) => said,
            Err(why) => return records.wanted.problems.push(why),
        };
        let (sources, typed) = (records.sources.clone(), PathBuf::from(records.wanted.path.trim()));
        let path = self.at_home(typed);
        let (number, stop) = self.record_reader.join();
        self.state.records.reading = Some("records".to_owned());
        let make = move || dataset_of_files(&sources, channels, band, path, &Untold(stop));
        self.in_thread("a dataset of records", make, move |app, made| {
            if !app.record_reader.is_newest(number) {
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
        match self.write_all(&[&made.path], |outputs| add_dataset(dataset, &made.path, outputs)) {
            Ok(()) => {
                self.state.forms.shown = None;
                self.open(made.path.clone(), None);
                self.made_of_records = Some(made);
            }
            Err(error) => self.written(Err(error), FormKind::RecordDataset, RecordsCommand::MakeDataset.into()),
        }
    }

    /// Reads the records that belong to the condition shown, once a view that needs them is shown.
    pub(super) fn look_for_records(&mut self) {
        let id = self.state.condition().id();
        self.follow_band(id);
        let display = &self.state.display;
        let is_compared = display.requirements_page == RequirementsPage::Histories;
        let is_shown = display.arrangement.is_shown(View::Records)
            || display.arrangement.is_shown(View::Requirements) && is_compared;
        let bench = &self.state.records;
        if !is_shown || bench.reading.is_some() || bench.conditions.contains_key(&id) {
            return;
        }
        let entries = self.state.condition().records().to_vec();
        self.state.records.is_example = self.loaded.origin == DatasetOrigin::EmbeddedExample;
        let name = format!("the records of condition {id}");
        match &self.loaded.origin {
            DatasetOrigin::EmbeddedExample => self.read_in_thread(name, move |_, channels, _| of_example(channels, id)),
            DatasetOrigin::File(path) if !entries.is_empty() => {
                let folder = path.parent().unwrap_or(Path::new("")).to_owned();
                self.read_in_thread(name, move |_, channels, stop| {
                    Ok(of_entries((channels, id), &entries, &folder, &stop))
                });
            }
            DatasetOrigin::File(_) => drop(self.records_of(id)),
        }
    }

    fn add_records(&mut self, paths: Vec<PathBuf>) {
        let paths: Vec<PathBuf> = paths.into_iter().map(|path| self.at_home(path)).collect();
        self.state.records.sources.extend(paths.iter().cloned());
        let name = paths.first().map_or(String::new(), |path| path.display().to_string());
        let shown = self.state.condition().id();
        self.read_in_thread(name, move |dataset, channels, stop| {
            of_files((dataset, channels), shown, &paths, &Untold(stop))
        });
    }

    fn read_in_thread(
        &mut self,
        name: String,
        read: impl FnOnce(&Dataset, &RecordChannels, Arc<AtomicBool>) -> Result<ReadRecords, FileError> + Send + 'static,
    ) {
        let channels = self.record_channels(self.state.condition().id());
        let clock_band_end = channels.resampling.band_end;
        let dataset = Arc::clone(self.state.study.file_dataset());
        let of = Arc::clone(&dataset);
        self.state.records.reading = Some(name);
        let (number, stop) = self.record_reader.join();
        let read = move || read(&dataset, &channels, stop);
        self.in_thread("the reading of records", read, move |app, found| {
            if !app.record_reader.is_newest(number) || !Arc::ptr_eq(&of, app.state.study.file_dataset()) {
                return;
            }
            app.state.records.reading = None;
            if let Some(found) = found.and_then(|found| app.unless_error(found)) {
                app.take_records(found, clock_band_end);
            }
            // What was looked for is not looked for again, found or not.
            app.records_of(app.state.condition().id());
        });
    }

    /// The records of a condition, none at first.
    pub(super) fn records_of(&mut self, id: ConditionId) -> &mut ConditionRecords {
        let nothing = || ConditionRecords::new(Vec::new(), &self.state.study.dataset);
        self.state.records.conditions.entry(id).or_insert_with(nothing)
    }

    fn take_records(&mut self, found: ReadRecords, clock_band_end: Option<f64>) {
        let count: usize = found.rows.values().map(Vec::len).sum();
        let conditions = found.rows.len();
        for (id, rows) in found.rows {
            let records = self.records_of(id);
            // A record that is read again takes its place.
            records.rows.retain(|old| rows.iter().all(|new| new.table.name != old.table.name));
            let is_known = records.rows.is_empty() || records.clock_band_end == clock_band_end;
            records.clock_band_end = clock_band_end.filter(|_| is_known);
            records.rows.extend(rows);
            leave_out_copies(&mut records.rows);
            records.choose(records.chosen);
            records.changed = true;
        }
        let left_out = self.made_of_records().into_iter().flat_map(|made| made.left_out.iter().cloned());
        self.state.records.faults = found.faults.into_iter().chain(left_out).collect();
        if count == 0 {
            return;
        }
        let of = if conditions == 1 { String::new() } else { format!(" of {conditions} conditions") };
        let records = if count == 1 { "record" } else { "records" };
        self.done(format!("{count} {records}{of}"));
    }

    /// Gives up what is under way and what waits; it can be begun again.
    pub(super) fn stop_identifying(&mut self) {
        let left = std::mem::take(&mut self.state.records.running).len();
        let asked = self.state.records.asked;
        if asked > 1 && left > 0 {
            self.done(format!("stopped identifying after {} of {asked} conditions", asked.saturating_sub(left)));
        }
    }

    fn identify_conditions(&mut self, conditions: &[ConditionId]) {
        if self.state.records.running.is_empty() {
            self.state.records.asked = 0;
        }
        let mut refusal = None;
        for id in conditions {
            self.follow_band(*id);
            let (band, channels) = (self.identified_band(*id), self.record_channels(*id));
            let Some(records) = self.state.records.conditions.get(id) else { continue };
            match records.job(*id, band, &channels) {
                Ok(job) => {
                    let waiting = self.state.records.running.len();
                    self.state.records.running.retain(|other| other.condition != *id);
                    self.state.records.asked += usize::from(waiting == self.state.records.running.len());
                    self.state.records.running.push(job);
                }
                Err(why) => refusal = Some(format!("condition {id}: {why}")),
            }
        }
        self.state.records.page = match self.state.records.page {
            RecordsPage::Histories | RecordsPage::Columns | RecordsPage::Inputs => RecordsPage::Response,
            page => page,
        };
        if let Some(why) = refusal {
            self.notify_error(why);
        }
    }

    /// Takes what was identified.
    pub(super) fn identified(&mut self, job: IdentifyJob, found: Result<Arc<Identification>, IdentificationError>) {
        if !self.state.records.running.contains(&job) {
            // It was given up meanwhile.
            return;
        }
        self.state.records.running.retain(|other| *other != job);
        if self.state.records.running.is_empty() && self.state.records.asked > 1 {
            self.done(format!("finished: models of {} conditions identified", self.state.records.asked));
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
        let taken: Vec<(ConditionId, Arc<AdoptedModels>)> = conditions.iter().filter_map(of).collect();
        if taken.is_empty() {
            return self.notify_error("nothing was identified yet".to_owned());
        }
        let models: usize = taken.iter().map(|(_, models)| models.models.len()).sum();
        let names: Vec<String> = taken.iter().map(|(id, _)| id.to_string()).collect();
        let before = self.state.study.clone();
        self.decide(&Edit::TakeModels(taken));
        if self.state.study != before {
            let conditions = if names.len() == 1 { "condition" } else { "conditions" };
            self.done(format!("took {models} models into {conditions} {}", names.join(", ")));
        }
    }
}

/// Changes something, where it is there.
fn set<T>(of: Option<&mut T>, change: impl FnOnce(&mut T)) {
    if let Some(of) = of {
        change(of);
    }
}

/// What the engineer says of the records of a condition.
fn say(records: &mut ConditionRecords, command: RecordsCommand, channels: &RecordChannels) {
    match command {
        RecordsCommand::Choose(index) => return records.choose(index),
        RecordsCommand::SetKind(index, kind) => return set(records.rows.get_mut(index), |row| row.guess.kind = kind),
        RecordsCommand::SetUsed(index, used) => set(records.rows.get_mut(index), |row| row.used = used),
        RecordsCommand::SetHeldOut(index, held_out) => {
            set(records.rows.get_mut(index), |row| row.guess.held_out = held_out);
        }
        RecordsCommand::SetLayout(index, layout) => set_layout(records, index, &layout, channels),
        RecordsCommand::SetDelay(signal, delay_s) => {
            set(records.channel_mut(&signal), |channel| channel.delay_s = delay_s);
        }
        RecordsCommand::SetRemedies(index, remedies) => set_remedies(records, index, &remedies, channels),
        RecordsCommand::SetHold(signal, hold) => set(records.channel_mut(&signal), |channel| channel.hold = hold),
        RecordsCommand::SetBand(band) => records.band = band,
        RecordsCommand::SetSearch(search) => records.search = search,
        RecordsCommand::SetReferences(references) => records.references = references,
        RecordsCommand::AddPart(index, part_s) => add_part(records, index, part_s, channels),
        RecordsCommand::RemovePart(index) => {
            if records.rows.get(index).is_some_and(|row| row.table.part_s.is_some()) {
                records.rows.remove(index);
                records.choose(records.chosen);
            }
        }
        _ => return,
    }
    records.changed = true;
}

/// A part of a record as a record of its own behind it; the whole is no longer used, for evidence counts once.
fn add_part(records: &mut ConditionRecords, index: usize, part_s: [f64; 2], channels: &RecordChannels) {
    let Some(whole) = records.rows.get_mut(index) else { return };
    let table = Arc::new(whole.table.part_of_time(part_s.map(|time_s| (100.0 * time_s).round() / 100.0)));
    let part = LaidOutRecord::new(table, whole.layout.clone(), whole.guess.clone(), channels);
    whole.used &= whole.table.part_s.is_some();
    let parts = records.rows[index + 1..].iter().take_while(|row| row.table.part_s.is_some()).count();
    records.rows.insert(index + 1 + parts, part);
}

/// The columns of one record, and of all others that have columns of these names.
fn set_layout(records: &mut ConditionRecords, index: usize, layout: &RecordLayout, channels: &RecordChannels) {
    let Some(table) = records.rows.get(index).map(|row| Arc::clone(&row.table)) else { return };
    for row in &mut records.rows {
        let Some(carried) = layout.carried_to(&row.table, &table) else { continue };
        let carried = carried.with_remedies_of(&row.layout);
        *row = row.laid_out(carried, channels);
    }
}

/// Puts channels right in one record alone.
fn set_remedies(
    records: &mut ConditionRecords,
    index: usize,
    remedies: &[(Signal, ChannelRemedy)],
    channels: &RecordChannels,
) {
    let Some(row) = records.rows.get_mut(index) else { return };
    let mut layout = row.layout.clone();
    for (signal, remedy) in remedies {
        set(layout.channel_mut(signal.role, signal.index), |used| used.remedy = *remedy);
    }
    *row = row.laid_out(layout, channels);
}

fn row_of(table: RecordTable, channels: &RecordChannels) -> LaidOutRecord {
    let (mut row, notes) = LaidOutRecord::proposed(table, channels, &TimeWish::default());
    if row.layout.is_resampled(&row.table, channels) {
        Arc::make_mut(&mut row.table).notes.extend(notes);
    }
    row
}

/// The records of a condition of the example that are inside the program.
fn of_example(channels: &RecordChannels, id: ConditionId) -> Result<ReadRecords, FileError> {
    let channels = &channels.clone().of_named_records();
    let rows: Vec<LaidOutRecord> = example_records(id.0)?.into_iter().map(|table| row_of(table, channels)).collect();
    Ok(ReadRecords { rows: BTreeMap::from([(id, rows)]), faults: Vec::new() })
}

/// The records that a dataset names.
fn of_entries(
    (channels, id): (&RecordChannels, ConditionId),
    entries: &[ConditionRecord],
    folder: &Path,
    stop: &Arc<AtomicBool>,
) -> ReadRecords {
    let channels = &channels.clone().of_named_records();
    let mut found = ReadRecords::default();
    let mut left: Vec<&ConditionRecord> = entries.iter().collect();
    // A file that holds many of them is read once.
    while let Some(file) = left.first().map(|entry| entry.file.as_str()) {
        let of_file: Vec<&ConditionRecord> = left.extract_if(.., |entry| entry.file == file).collect();
        let variables: Vec<Option<&str>> = of_file.iter().map(|entry| entry.variable.as_deref()).collect();
        let budget = ReadingBudget::default().stopped_by(Arc::clone(stop));
        let tables = load_records(&folder.join(file), &variables, &budget);
        found.faults.extend(tables.as_ref().err().map(ToString::to_string));
        for (entry, table) in of_file.into_iter().zip(tables.into_iter().flatten()) {
            match table {
                Ok(table) => {
                    let table = RecordTable { name: entry.name.clone(), part_s: entry.part_s, ..table };
                    found.rows.entry(id).or_default().push(row_of(table, channels).as_said(entry, channels));
                }
                Err(error) => found.faults.push(error.to_string()),
            }
        }
    }
    found
}

/// The records of files: each of the condition that its name says, or else of the one shown.
fn of_files(
    (dataset, channels): (&Dataset, &RecordChannels),
    shown: ConditionId,
    paths: &[PathBuf],
    progress: &Untold,
) -> Result<ReadRecords, FileError> {
    let read = read_records(paths, progress)?;
    let mut found = ReadRecords { faults: read.faults, ..ReadRecords::default() };
    found.faults.extend(read.ignored.into_iter().map(|words| format!("no record: {words}")));
    for table in with_topics_joined(read.tables, channels, &TimeWish::default()) {
        let row = row_of(table, channels);
        let id = row.guess.condition_of(dataset).unwrap_or(shown);
        found.rows.entry(id).or_default().push(row);
    }
    Ok(found)
}

/// A dataset that was made of records.
pub(super) struct DatasetOfRecords {
    /// Its file.
    path: PathBuf,
    /// Where its channels are found in the records, and their units.
    channels: RecordChannels,
    /// The records that are not in it, and why.
    left_out: Vec<String>,
}

/// Most problems that are told.
const MOST_PROBLEMS: usize = 6;

/// A dataset of the records in these files that give the channels asked for, to be written to `path`; the channels have units then.
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
        problems.extend(row.problems.iter().map(|problem| format!("{}: {problem}", row.table.name)));
        if row.problems.is_empty() {
            channels.take_units(&row.layout, &row.table);
            let entry = row.layout.condition_record(&row.table, &row.guess, &channels);
            entries.push(relative_entry(entry, sources, &path));
        }
    }
    if entries.is_empty() {
        problems.truncate(MOST_PROBLEMS);
        return Err(problems);
    }
    let name = path.file_name().map_or(String::new(), |name| name.to_string_lossy().into_owned());
    let name = name.split('.').next().unwrap_or_default();
    let dataset = dataset_of_records(name, &channels, band, entries).map_err(|error| vec![error.to_string()])?;
    let left_out = problems.into_iter().map(|why| format!("left out of the dataset: {why}")).collect();
    Ok((dataset, DatasetOfRecords { path, channels, left_out }))
}
