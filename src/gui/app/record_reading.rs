//! Reading flight records from files: the part that runs in the reading thread, without access to
//! the window.
//!
//! A record is read as a *table* of columns; its *layout* assigns columns to channels. A *row* is a
//! table with its layout, and with a *guess*: what the names of file and folder tell about
//! condition and manoeuvre. *Topics* are a log's tables with clocks of their own.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use gdcm_io::import::record_files::{example_records, load_records, read_records};
use gdcm_io::reading_budget::ReadingBudget;
use gdcm_io::{DatasetOrigin, FileError, FolderProgress};
use gdcm_model::dataset::condition::ConditionRecord;
use gdcm_model::dataset::{ConditionId, Dataset};
use gdcm_model::names::standard_patterns;
use gdcm_sysid::records::record_guess::RecordGuess;
use gdcm_sysid::records::{
    LaidOutRecord, RecordChannels, RecordTable, TimeSettings, with_topics_joined,
};

use super::readers::SilentProgress;

/// Records that were read, by condition, and the faults found.
#[derive(Default)]
pub(super) struct ReadRecords {
    /// The conditions' own records: listed by the dataset, or embedded in the example.
    pub(super) own: BTreeMap<ConditionId, Vec<LaidOutRecord>>,
    /// Records from the files that the engineer added.
    pub(super) added: BTreeMap<ConditionId, Vec<LaidOutRecord>>,
    /// Added records for which [`condition_of_added`] finds no condition.
    pub(super) unassigned: Vec<LaidOutRecord>,
    pub(super) faults: Vec<String>,
    /// File paths, by SHA-256.
    pub(super) read_from: BTreeMap<String, PathBuf>,
}

/// Source of the conditions' own records: the files that the dataset lists, or an embedded
/// example.
#[derive(Clone)]
pub(super) struct OwnRecords {
    pub(super) dataset: Arc<Dataset>,
    pub(super) origin: DatasetOrigin,
}

/// A record that the dataset lists, and its condition.
struct ListedRecord<'a> {
    condition: ConditionId,
    entry: &'a ConditionRecord,
}

impl OwnRecords {
    /// Returns whether a condition may have its own records.
    pub(super) fn may_have_records(&self, id: ConditionId) -> bool {
        match &self.origin {
            DatasetOrigin::EmbeddedExample(_) => true,
            DatasetOrigin::File(_) => !self.entries(id).is_empty(),
        }
    }

    fn entries(&self, id: ConditionId) -> &[ConditionRecord] {
        match self.dataset.condition(id) {
            Some(condition) => condition.records(),
            None => &[],
        }
    }

    /// Reads the own records of the conditions `ids` into `found`. Each of these conditions gets an
    /// entry, even if it has no records.
    ///
    /// # Errors
    /// The fault in an embedded record; faults in files are collected in `found`.
    pub(super) fn read(
        &self,
        ids: &[ConditionId],
        channels: &RecordChannels,
        stop: &Arc<AtomicBool>,
        found: &mut ReadRecords,
    ) -> Result<(), FileError> {
        // The dataset's own records are in the dataset's units unless their files say otherwise.
        let channels = channels.clone().of_named_records();
        for id in ids {
            let rows = found.own.entry(*id).or_default();
            if let DatasetOrigin::EmbeddedExample(example) = self.origin {
                for table in example_records(example, id.0)? {
                    rows.push(laid_out(table, &channels, None));
                }
            }
        }
        if let DatasetOrigin::File(path) = &self.origin {
            let folder = path.parent().unwrap_or(Path::new(""));
            for (file, records) in self.records_by_file(ids) {
                read_listed_records(&folder.join(file), &records, &channels, stop, found);
            }
        }
        Ok(())
    }

    /// Groups listed records by file, so that a file with several records is read once.
    fn records_by_file(&self, ids: &[ConditionId]) -> BTreeMap<&str, Vec<ListedRecord<'_>>> {
        let mut by_file: BTreeMap<&str, Vec<ListedRecord<'_>>> = BTreeMap::new();
        for id in ids {
            for entry in self.entries(*id) {
                let listed = ListedRecord {
                    condition: *id,
                    entry,
                };
                by_file.entry(&entry.file).or_default().push(listed);
            }
        }
        by_file
    }
}

/// Reads the listed records in a file into `found`.
fn read_listed_records(
    path: &Path,
    records: &[ListedRecord<'_>],
    channels: &RecordChannels,
    stop: &Arc<AtomicBool>,
    found: &mut ReadRecords,
) {
    let variables: Vec<Option<&str>> = records
        .iter()
        .map(|listed| listed.entry.variable.as_deref())
        .collect();
    let budget = ReadingBudget::default().stopped_by(Arc::clone(stop));
    let tables = match load_records(path, &variables, &budget) {
        Ok(tables) => tables,
        Err(error) => {
            found.faults.push(error.to_string());
            return;
        }
    };
    for (ListedRecord { condition, entry }, table) in records.iter().zip(tables) {
        let table = match table {
            Ok(table) => table,
            Err(error) => {
                found.faults.push(error.to_string());
                continue;
            }
        };
        let sha256 = table.source.sha256.clone();
        found.read_from.insert(sha256, canonical_path(path));
        let table = RecordTable {
            name: entry.name.clone(),
            part_s: entry.part_s,
            ..table
        };
        let row = laid_out(table, channels, None).with_entry(entry, channels);
        found.own.entry(*condition).or_default().push(row);
    }
}

/// Files that the engineer added.
pub(super) struct AddedFiles {
    pub(super) paths: Vec<PathBuf>,
    pub(super) own: OwnRecords,
    /// Conditions whose own records are already loaded.
    pub(super) loaded: BTreeSet<ConditionId>,
}

impl AddedFiles {
    /// Reads the records in the files:
    ///
    /// 1. read tables; what is no record becomes a fault;
    /// 2. combine tables that are topics of one record;
    /// 3. assign columns to channels; units that neither the files nor the samples determine are
    ///    assumed to be the dataset's;
    /// 4. assign each record to its condition ([`condition_of_added`]); others remain unassigned;
    /// 5. read these conditions' own records if they are not yet loaded.
    ///
    /// # Errors
    /// The fault in a path; faults in single files are collected.
    pub(super) fn read(
        &self,
        channels: &RecordChannels,
        progress: &SilentProgress,
    ) -> Result<ReadRecords, FileError> {
        // Step 1.
        let read = read_records(&self.paths, progress)?;
        let mut found = ReadRecords {
            faults: read.faults,
            ..ReadRecords::default()
        };
        for words in read.ignored {
            found.faults.push(format!("no record: {words}"));
        }
        // Steps 2 to 4.
        for table in with_topics_joined(read.tables, channels, &TimeSettings::default()) {
            let file = find_file(&table.source.file, &self.paths);
            if let Some(path) = &file {
                found
                    .read_from
                    .insert(table.source.sha256.clone(), path.clone());
            }
            let row = laid_out(table, channels, Some(&self.own.dataset));
            let layout = row.layout.assuming_units_of_channels();
            let row = if layout == row.layout {
                row
            } else {
                row.laid_out(layout, channels)
            };
            match condition_of_added(&row, file.as_deref(), &self.own.dataset) {
                Some(id) => found.added.entry(id).or_default().push(row),
                None => found.unassigned.push(row),
            }
        }
        // Step 5.
        let mut unloaded: Vec<ConditionId> = found.added.keys().copied().collect();
        unloaded.retain(|id| !self.loaded.contains(id));
        self.own
            .read(&unloaded, channels, &progress.stop(), &mut found)?;
        Ok(found)
    }
}

/// Returns an added record's condition, by the first rule that applies:
///
/// 1. the dataset has only one condition: that;
/// 2. a condition's entry in the dataset lists the record: that condition;
/// 3. the name of the record or its file, else of its folder, states a number: the condition with
///    this number, or none, because an airspeed must not hide a wrong number;
/// 4. one of these names states an airspeed: the only condition at this airspeed, if there is one;
/// 5. none.
fn condition_of_added(
    row: &LaidOutRecord,
    file: Option<&Path>,
    dataset: &Dataset,
) -> Option<ConditionId> {
    // Rule 1.
    if let [only] = dataset.conditions() {
        return Some(only.id());
    }
    // Rule 2.
    if let Some((listed, _)) = row.table.entry_of_dataset(dataset) {
        return Some(listed);
    }
    let mut guesses = vec![row.guess.clone()];
    let folder = file
        .and_then(|path| path.parent())
        .and_then(|parent| parent.file_name());
    if let Some(folder) = folder {
        let name = folder.to_string_lossy();
        guesses.push(RecordGuess::from_name(&name, standard_patterns()));
    }
    // Rule 3.
    for guess in &guesses {
        if let Some(id) = guess.condition_of(dataset) {
            return Some(id);
        }
        if guess.condition.is_some() {
            return None;
        }
    }
    // Rule 4.
    for guess in &guesses {
        if let Some(airspeed_kt) = guess.airspeed_kt {
            return only_condition_at(airspeed_kt, dataset);
        }
    }
    None
}

/// Returns the only condition at an airspeed \[kt\]; `None` if there are none or several.
fn only_condition_at(airspeed_kt: f64, dataset: &Dataset) -> Option<ConditionId> {
    let mut at_airspeed = dataset
        .conditions()
        .iter()
        .filter(|condition| condition.flight_state().airspeed_kt == airspeed_kt);
    let first = at_airspeed.next()?;
    if at_airspeed.next().is_some() {
        return None;
    }
    Some(first.id())
}

/// Assigns a record's columns to channels: as `dataset` states for a record that it names; other
/// records by a proposal. A resampled record keeps the notes about its resampling.
fn laid_out(
    table: RecordTable,
    channels: &RecordChannels,
    dataset: Option<&Dataset>,
) -> LaidOutRecord {
    let time = TimeSettings::default();
    let (mut row, notes) = match dataset {
        Some(dataset) => LaidOutRecord::proposed_for_dataset(table, channels, dataset, &time),
        None => LaidOutRecord::proposed(table, channels, &time),
    };
    if row.layout.is_resampled(&row.table, channels) {
        Arc::make_mut(&mut row.table).notes.extend(notes);
    }
    row
}

/// Returns the canonical path, or the path as given if the file system cannot resolve it.
fn canonical_path(path: &Path) -> PathBuf {
    path.canonicalize().unwrap_or_else(|_| path.to_owned())
}

/// Finds a record's file, by its name, among the added paths: a path itself, or a file directly
/// inside an added folder; the first that fits.
fn find_file(name: &str, paths: &[PathBuf]) -> Option<PathBuf> {
    for path in paths {
        let own_name = path.file_name().map(|name| name.to_string_lossy());
        if own_name.is_some_and(|own_name| own_name == name) {
            return Some(canonical_path(path));
        }
        let inside = path.join(name);
        if inside.is_file() {
            return Some(canonical_path(&inside));
        }
    }
    None
}
