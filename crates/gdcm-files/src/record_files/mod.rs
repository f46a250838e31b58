//! Flight records in files of whatever format: tables of text, MATLAB, NumPy, JSON, and archives of them.
//!
//! ```text
//! bytes -> format, by what they begin with
//!       -> a table of columns, or variables, or the files of an archive      (text, mat, mat73, npy, zip, JSON)
//!       -> columns of one length: vectors and matrices beside one another, structs, timetables, iddata
//!       -> records of one table apart, by a column that numbers them or where time restarts
//! ```

mod record_columns;

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use gdcm_core::assembly::standard_patterns;
use gdcm_core::dataset::ConditionRecord;
use gdcm_core::records::{ModeSpan, RecordColumn, RecordGuess, RecordSource, RecordTable, Separation};

use crate::file_error::FileError;
use crate::importer::{
    Contents, FolderProgress, ImportedFile, MOST_MEMORY, import, import_bytes, import_file, of_file,
};
use crate::recognise::{Found, search};
use crate::record_files::record_columns::{columns_of, experiments, is_iddata, simulink_columns, timetable_columns};
use crate::study_file::relative_folder;
use crate::text::{NumberedText, TextTable, numbered_words, read_table, sections};
use crate::variables::{ReadingBudget, Variable, VariableFault};

/// Most records of one file.
pub(crate) const MOST_RECORDS: usize = 1000;
/// What was found in files of records.
#[derive(Clone, Debug, Default)]
pub struct FoundRecords {
    /// The records, in the order of their files.
    pub tables: Vec<RecordTable>,
    /// What could not be read, each with its place and why.
    pub faults: Vec<String>,
    /// What is no record, in words.
    pub ignored: Vec<String>,
    /// Number of files that were read.
    pub files: usize,
    /// The files asked for by name that could not be read, or not all that is in them.
    pub unread: Vec<PathBuf>,
}

/// The records of files and folders, folders with all that is in them. A file that cannot be read is a fault, and the rest is read;
/// where only one was asked for, it is an error.
pub fn read_records(paths: &[PathBuf], progress: &dyn FolderProgress) -> Result<FoundRecords, FileError> {
    let (mut found, mut whole) = (FoundRecords::default(), Vec::new());
    let (files, faults) = import(paths, progress, |file, budget| {
        let (path, records, faults) = (file.path.to_owned(), found.tables.len(), found.faults.len());
        found.take(file, budget)?;
        whole.extend((found.tables.len() > records && found.faults.len() == faults).then_some(path));
        Ok(())
    })?;
    found.faults.extend(faults);
    let unread = paths.iter().filter(|path| !path.is_dir() && !whole.contains(path)).cloned().collect();
    Ok(FoundRecords { files, unread, ..found })
}

/// The records in the bytes of a file of this name, within a budget.
pub fn records_of_bytes(bytes: &[u8], name: &str, budget: &ReadingBudget<'_>) -> Result<FoundRecords, FileError> {
    let mut found = FoundRecords { files: 1, ..FoundRecords::default() };
    found.take(import_bytes(bytes, Path::new(name), name, budget)?, budget)?;
    Ok(found)
}

/// Records of a file again, which is read once and within a budget: those that a dataset calls by these variables; none is the only
/// one.
///
/// # Errors
/// Those of reading; of a record that the file does not hold [`FileError::NoRecord`].
pub fn load_records(
    path: &Path,
    variables: &[Option<&str>],
    budget: &ReadingBudget<'_>,
) -> Result<Vec<Result<RecordTable, FileError>>, FileError> {
    let name = path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
    let mut found = FoundRecords::default();
    if path.is_dir() {
        import(&[path.to_owned()], &Stopped(budget.stop()), |file, budget| found.take(file, budget))?;
    } else {
        found.take(import_file(path, &name, budget)?, budget)?;
    }
    let held = found.tables.len();
    let record = |variable: &Option<&str>| {
        let record = found.tables.iter().find(|table| table.source.variable.as_deref() == *variable).cloned();
        let together = || variable.and_then(|variable| RecordTable::of_topics_called(&found.tables, variable));
        let record = record.or_else(together);
        record.ok_or_else(|| FileError::NoRecord { path: path.to_owned(), record: variable.map(str::to_owned), held })
    };
    Ok(variables.iter().map(record).collect())
}

/// Whoever stops one reader stops that of a folder too.
struct Stopped<'s>(&'s Arc<AtomicBool>);

impl FolderProgress for Stopped<'_> {
    fn reading(&self, _: usize, _: usize, _: &str) {}

    fn stop(&self) -> Arc<AtomicBool> {
        Arc::clone(self.0)
    }
}

impl FoundRecords {
    fn take(&mut self, file: ImportedFile<'_>, budget: &ReadingBudget<'_>) -> Result<(), FileError> {
        let ImportedFile { path, name, sha256, contents } = file;
        let wrong = |fault| FileError::variables(path, fault);
        match contents {
            Contents::Variables { variables, notes, .. } => {
                self.add_found(search_records(&variables, budget).map_err(wrong)?, &notes, (name, &sha256));
            }
            Contents::Text(text) => {
                for columns in of_text(&text, budget).map_err(wrong)? {
                    self.add(columns.of_file(name, &sha256));
                }
            }
            Contents::Logs(logs) => logs.into_iter().for_each(|log| self.add(log.of_file(name, &sha256))),
            Contents::Dataset(_) | Contents::Models(_) => {
                self.ignored.push(format!("{name}: a dataset or models, not a record"));
            }
            Contents::Archive { variables, files, ignored } => {
                self.ignored.extend(ignored);
                for (inner, contents) in files {
                    let mut found = FoundRecords::default();
                    let taken = contents.and_then(|contents| {
                        let (path, sha256) = (Path::new(&inner), sha256.clone());
                        found.take(ImportedFile { path, name: &inner, sha256, contents }, budget)
                    });
                    match taken {
                        Err(stopped) if stopped.is_stopped() => return Err(stopped),
                        taken => self.faults.extend(taken.err().map(|error| error.to_string())),
                    }
                    self.faults.append(&mut found.faults);
                    self.ignored.append(&mut found.ignored);
                    // A file in the archive is what a variable is in others.
                    for mut table in found.tables {
                        let variable = table.source.variable.map(|variable| format!("{inner}, {variable}"));
                        let (file, variable) = (name.to_owned(), Some(variable.unwrap_or_else(|| inner.clone())));
                        table.source = RecordSource { file, variable, ..table.source };
                        self.tables.push(table);
                    }
                    if self.tables.len() > MOST_RECORDS {
                        return Err(wrong(VariableFault::TooLarge { variable: inner, most_mib: MOST_MEMORY >> 20 }));
                    }
                }
                if !variables.is_empty() {
                    self.add_found(search_records(&variables, budget).map_err(wrong)?, &[], (name, &sha256));
                }
            }
        }
        Ok(())
    }

    fn add_found(&mut self, found: Found<Columns>, notes: &[String], (name, sha256): (&str, &str)) {
        for mut columns in found.items {
            columns.notes.extend(notes.iter().cloned());
            self.add(columns.of_file(name, sha256));
        }
        self.faults.extend(of_file(name, found.faults));
        self.ignored.extend(of_file(name, found.ignored));
    }

    /// Adds a table, its records apart.
    fn add(&mut self, table: RecordTable) {
        let table = table.side_by_side();
        let separation = Separation::proposed(&table);
        self.tables.extend(table.separated(separation));
    }
}

/// Columns that belong together, before it is known of which file they are.
pub(crate) struct Columns {
    /// Where they lie in the file ("rec(2)"); empty where they are all of it.
    pub(crate) variable: String,
    /// They.
    pub(crate) columns: Vec<RecordColumn>,
    /// Whether the file names them.
    pub(crate) named: bool,
    /// Sample time \[s\], where the file says it.
    pub(crate) sample_time_s: Option<f64>,
    /// How they were read.
    pub(crate) notes: Vec<String>,
    /// What the system that logged them was at, when.
    pub(crate) modes: Vec<ModeSpan>,
}

impl Columns {
    /// Columns with names, of which nothing else is known.
    pub(crate) fn new(variable: String, columns: Vec<RecordColumn>) -> Self {
        Self { variable, columns, named: true, sample_time_s: None, notes: Vec::new(), modes: Vec::new() }
    }

    /// The record of these columns in a file.
    fn of_file(self, name: &str, sha256: &str) -> RecordTable {
        let file = name.rsplit('/').next().unwrap_or(name);
        let stem = file.rsplit_once('.').map_or(file, |(stem, _)| stem);
        let stem = stem.strip_suffix(".csv").unwrap_or(stem);
        let Self { variable, columns, named, sample_time_s, notes, modes } = self;
        let variable = Some(variable).filter(|variable| !variable.is_empty());
        let name_of_record =
            variable.as_ref().map_or_else(|| stem.to_owned(), |variable| format!("{stem}, {variable}"));
        RecordTable {
            named,
            sample_time_s,
            source: RecordSource { file: name.to_owned(), sha256: sha256.to_owned(), variable },
            notes,
            modes,
            ..RecordTable::new(name_of_record, columns)
        }
    }
}

/// The columns of a text; where these change on the way, of every part that is long enough to be a record.
fn of_text(text: &str, budget: &ReadingBudget<'_>) -> Result<Vec<Columns>, VariableFault> {
    let first = match of_whole_text(text, budget) {
        Err(fault @ (VariableFault::Line { .. } | VariableFault::Format { .. })) => fault,
        whole => return whole.map(|columns| vec![columns]),
    };
    let parts = sections(text);
    let count = parts.len();
    let mut found = Vec::new();
    for (index, (line, part)) in parts.into_iter().enumerate().filter(|_| count > 1) {
        match of_whole_text(part, budget) {
            Ok(columns) if columns.columns.first().is_some_and(|column| column.values.len() >= Separation::FEWEST) => {
                let note = format!("one of {count} tables in the file, from line {line}");
                let notes = [vec![note], columns.notes].concat();
                found.push(Columns { variable: format!("table {}", index + 1), notes, ..columns });
            }
            Err(fault) if fault.is_of_the_budget() => return Err(fault),
            _ => {}
        }
    }
    if found.is_empty() { Err(first) } else { Ok(found) }
}

/// The columns of one table: of one with words or times of the clock among its numbers, with numbers in their place.
fn of_whole_text(text: &str, budget: &ReadingBudget<'_>) -> Result<Columns, VariableFault> {
    let first = match read_table(text, budget) {
        Err(fault @ (VariableFault::Line { .. } | VariableFault::Format { .. })) => fault,
        table => return table.map(of_table),
    };
    let Some(NumberedText { text, notes }) = numbered_words(text, budget)? else { return Err(first) };
    // What is wrong in the text as it stands says more than what is wrong in this one.
    let mut columns = of_table(read_table(&text, budget).map_err(|_| first)?);
    columns.notes.extend(notes);
    Ok(columns)
}

/// The columns of a table of text.
fn of_table(table: TextTable) -> Columns {
    let TextTable { names, units, columns, notes, .. } = table;
    let named = names.is_some();
    let names = names.unwrap_or_default();
    let (columns, mut notes) = (columns, notes);
    let columns = if named { columns } else { without_numbers(columns, &mut notes) };
    let columns = columns.into_iter().enumerate().map(|(index, values)| {
        let name = names.get(index).filter(|name| !name.is_empty()).cloned();
        let name = name.unwrap_or_else(|| format!("column {}", index + 1));
        RecordColumn { unit: units.get(index).cloned().flatten(), ..RecordColumn::new(name, values) }
    });
    Columns { named, notes, ..Columns::new(String::new(), columns.collect()) }
}

/// Columns without a first line that counts them: 1, 2, 3, …
fn without_numbers(mut columns: Vec<Vec<f64>>, notes: &mut Vec<String>) -> Vec<Vec<f64>> {
    let counts = columns.iter().enumerate().all(|(index, values)| values.first() == Some(&(index as f64 + 1.0)));
    if counts && columns.len() > 2 {
        columns.iter_mut().for_each(|values| values.rotate_left(1));
        columns.iter_mut().for_each(|values| values.truncate(values.len() - 1));
        notes.push("the first line numbers the columns: it is no sample".to_owned());
    }
    columns
}

// The records of the embedded example.

/// The records of conditions 3 and 10 of the example: simulated sweeps and validation, one CSV each.
const ARCHIVE: &[u8] = include_bytes!("../../../../assets/example-records-3-and-10.zip");
/// What errors call them.
const NAME: &str = "(embedded example records).zip";

/// The conditions of the example whose records are inside the program.
pub const EXAMPLE_RECORD_CONDITIONS: [i64; 2] = [3, 10];

/// The records of a condition of the example: none but of [`EXAMPLE_RECORD_CONDITIONS`].
pub fn example_records(condition: i64) -> Result<Vec<RecordTable>, FileError> {
    if !EXAMPLE_RECORD_CONDITIONS.contains(&condition) {
        return Ok(Vec::new());
    }
    let patterns = standard_patterns();
    let found = records_of_bytes(ARCHIVE, NAME, &ReadingBudget::default())?;
    let is_of = |table: &RecordTable| RecordGuess::of(&table.name, patterns).condition == Some(condition);
    Ok(found.tables.into_iter().filter(is_of).collect())
}

/// Every record among the variables of a file.
pub(super) fn search_records(
    variables: &[Variable],
    budget: &ReadingBudget<'_>,
) -> Result<Found<Columns>, VariableFault> {
    search(variables, budget, &|record, variable| {
        if is_iddata(record) {
            return Some(match experiments(record, variable) {
                Ok(found) => found.into_iter().map(Ok).collect(),
                Err(why) => vec![Err(why)],
            });
        }
        let found = timetable_columns(record, variable)
            .or_else(|| simulink_columns(record, variable))
            .or_else(|| columns_of(record, variable));
        found.map(|columns| vec![Ok(columns)])
    })
}

/// What a dataset at `dataset` says of a record, its file relative to the dataset's; `asked` are the files and folders that were read.
pub fn relative_entry(mut entry: ConditionRecord, asked: &[PathBuf], dataset: &Path) -> ConditionRecord {
    // A file by itself, or below the folder that was asked for.
    let place = asked.iter().find_map(|path| {
        let own = path.file_name().is_some_and(|name| name.to_string_lossy() == entry.file.as_str());
        let below = path.join(&entry.file);
        if own { Some(path.clone()) } else { Some(below).filter(|_| path.is_dir()) }
    });
    // Topics of a folder whose files were given one by one.
    let together = || asked.first().and_then(|path| path.parent()).filter(|_| entry.file.is_empty());
    if let Some(place) = place.or_else(|| together().map(Path::to_owned)) {
        let folder = relative_folder(place.parent().unwrap_or(Path::new(".")), dataset);
        let name = place.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
        entry.file = if folder.is_empty() || folder == "." { name } else { format!("{folder}/{name}") };
    }
    entry
}

#[cfg(test)]
mod tests;

#[cfg(test)]
mod example_tests {
    use super::*;

    #[test]
    fn conditions_three_and_ten_have_eight_sweeps_and_one_validation_each() {
        for condition in EXAMPLE_RECORD_CONDITIONS {
            let records = example_records(condition).unwrap();
            let rows: Vec<usize> = records.iter().map(RecordTable::rows).collect();
            assert_eq!(rows, [[3001; 8].as_slice(), &[3301]].concat(), "60 s and 66 s at 50 Hz");
            assert!(records.iter().all(|record| record.columns.len() == 11 && record.named));
        }
        assert!(example_records(1).unwrap().is_empty());
    }
}
