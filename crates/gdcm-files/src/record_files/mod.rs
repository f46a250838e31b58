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

use gdcm_core::assembly::standard_patterns;
use gdcm_core::records::{RecordColumn, RecordGuess, RecordSource, RecordTable, Separation};
use sha2::{Digest, Sha256};

use crate::file_error::FileError;
use crate::model_files::folder::files_of;
use crate::model_files::{Contents, FileFormat, FolderProgress, contents_of, variables_of};
use crate::npy::read_npy;
use crate::recognise::record::Record;
use crate::record_files::record_columns::{columns_of, experiments, is_iddata, simulink_columns, timetable_columns};
use crate::source::{Source, read_bytes};
use crate::text::{NumberedText, TextTable, decode, numbered_words, read_table, sections};
use crate::variables::{MemoryBudget, StructArray, Value, Variable, VariableFault};
use crate::zip_files::visit_files;

/// Memory that the columns of one file may take \[bytes\].
const MOST_MEMORY: u64 = 1 << 30;
/// Largest file of records \[bytes\].
const LARGEST_FILE: u64 = 512 << 20;
/// Most records of one file.
const MOST_RECORDS: usize = 1000;
/// Endings of files that may hold records.
const ENDINGS: [&str; 15] =
    ["csv", "txt", "tsv", "dat", "asc", "prn", "log", "out", "mat", "npz", "npy", "json", "gz", "zip", "h5"];

/// What was found in files of records.
#[derive(Clone, Debug, Default)]
pub struct FoundRecords {
    /// The records, in the order of their files.
    pub tables: Vec<RecordTable>,
    /// What could not be read, each with its place and why.
    pub faults: Vec<String>,
    /// What is no record, in words.
    pub passed_over: Vec<String>,
    /// Number of files that were read.
    pub files: usize,
}

/// The records of files and folders, folders with all that is in them. A file that cannot be read is a fault, and the rest is read;
/// where only one was asked for, it is an error.
pub fn read_records(paths: &[PathBuf], progress: &dyn FolderProgress) -> Result<FoundRecords, FileError> {
    let files = files_of(paths, &ENDINGS)?;
    let mut found = FoundRecords { files: files.len(), ..FoundRecords::default() };
    for (index, (path, name)) in files.iter().enumerate() {
        if progress.stopped(0) {
            break;
        }
        progress.reading(index + 1, files.len(), name);
        let bytes = read_bytes(path, LARGEST_FILE);
        match bytes.and_then(|bytes| {
            of_bytes(&bytes, path, name, &MemoryBudget::new(MOST_MEMORY, &|taken| progress.stopped(taken)))
        }) {
            Ok(of_file) => found.append(of_file, name),
            Err(error) if paths.len() == 1 && files.len() == 1 => return Err(error),
            Err(error) => found.faults.push(error.to_string()),
        }
    }
    Ok(found)
}

/// The records in the bytes of a file of this name, in no more than `most` bytes of memory for its columns.
pub fn records_of_bytes(bytes: &[u8], name: &str, most: u64) -> Result<FoundRecords, FileError> {
    let mut found = of_bytes(bytes, Path::new(name), name, &MemoryBudget::new(most, &|_| false))?;
    found.files = 1;
    Ok(found)
}

/// Records of a file again, which is read once: those that a dataset calls by these variables; none is the only one.
///
/// # Errors
/// Those of reading; of a record that the file does not hold [`FileError::NoRecord`].
pub fn load_records(path: &Path, variables: &[Option<&str>]) -> Result<Vec<Result<RecordTable, FileError>>, FileError> {
    let name = path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
    let bytes = read_bytes(path, LARGEST_FILE)?;
    let found = of_bytes(&bytes, path, &name, &MemoryBudget::new(MOST_MEMORY, &|_| false))?;
    let held = found.tables.len();
    let record = |variable: &Option<&str>| {
        let record = found.tables.iter().find(|table| table.source.variable.as_deref() == *variable).cloned();
        record.ok_or_else(|| FileError::NoRecord { path: path.to_owned(), record: variable.map(str::to_owned), held })
    };
    Ok(variables.iter().map(record).collect())
}

impl FoundRecords {
    fn append(&mut self, mut other: Self, name: &str) {
        let at = |words: String| if words.starts_with(name) { words } else { format!("{name}: {words}") };
        self.tables.append(&mut other.tables);
        self.faults.extend(other.faults.into_iter().map(at));
        self.passed_over.extend(other.passed_over.into_iter().map(at));
    }

    /// Adds a table, its records apart.
    fn add(&mut self, table: RecordTable) {
        let separation = Separation::proposed(&table);
        self.tables.extend(table.separated(separation));
    }
}

/// Columns that belong together, before it is known of which file they are.
pub(super) struct Columns {
    /// Where they lie in the file ("rec(2)"); empty where they are all of it.
    pub(super) variable: String,
    /// They.
    pub(super) columns: Vec<RecordColumn>,
    /// Whether the file names them.
    pub(super) named: bool,
    /// Sample time \[s\], where the file says it.
    pub(super) sample_time_s: Option<f64>,
    /// How they were read.
    pub(super) notes: Vec<String>,
}

impl Columns {
    /// The record of these columns in a file.
    fn of_file(self, name: &str, sha256: &str) -> RecordTable {
        let file = name.rsplit('/').next().unwrap_or(name);
        let stem = file.rsplit_once('.').map_or(file, |(stem, _)| stem);
        let stem = stem.strip_suffix(".csv").unwrap_or(stem);
        let Self { variable, columns, named, sample_time_s, notes } = self;
        let variable = Some(variable).filter(|variable| !variable.is_empty());
        RecordTable {
            name: variable.as_ref().map_or_else(|| stem.to_owned(), |variable| format!("{stem}, {variable}")),
            columns,
            named,
            sample_time_s,
            source: RecordSource { file: name.to_owned(), sha256: sha256.to_owned(), variable },
            notes,
        }
    }
}

fn of_bytes(bytes: &[u8], path: &Path, name: &str, meter: &MemoryBudget<'_>) -> Result<FoundRecords, FileError> {
    let sha256: String = Sha256::digest(bytes).iter().map(|byte| format!("{byte:02x}")).collect();
    match FileFormat::of(bytes, path) {
        FileFormat::Npz => of_archive(bytes, path, (name, &sha256), meter),
        _ => of_single(bytes, path, (name, &sha256), meter),
    }
}

/// The arrays of an archive, and every other file in it.
fn of_archive(
    bytes: &[u8],
    path: &Path,
    (name, sha256): (&str, &str),
    meter: &MemoryBudget<'_>,
) -> Result<FoundRecords, FileError> {
    let (mut arrays, mut found) = (Vec::new(), FoundRecords::default());
    visit_files(bytes, |file| {
        let inner = file.unpack(file.path, meter)?;
        if let Some(name) = file.path.strip_suffix(".npy") {
            arrays.extend(read_npy(&inner, name, meter)?);
            return Ok(());
        }
        let inner_path = Path::new(file.path);
        if FileFormat::of(&inner, inner_path) == FileFormat::Npz || !has_ending(inner_path) {
            found.passed_over.push(format!("{}: no file of records", file.path));
            return Ok(());
        }
        match of_single(&inner, inner_path, (file.path, sha256), meter) {
            Ok(of_file) => found.append(of_file, file.path),
            Err(FileError::Variables {
                fault: fault @ (VariableFault::Stopped | VariableFault::TooLarge { .. }),
                ..
            }) => {
                return Err(fault);
            }
            Err(error) => found.faults.push(error.to_string()),
        }
        if found.tables.len() > MOST_RECORDS {
            return Err(VariableFault::TooLarge { variable: file.path.to_owned(), most_mib: MOST_MEMORY >> 20 });
        }
        Ok(())
    })
    .map_err(|fault| FileError::Variables { path: path.to_owned(), fault })?;
    // A file in the archive is what a variable is in others.
    for table in &mut found.tables {
        let inner = std::mem::replace(&mut table.source.file, name.to_owned());
        let parts = [Some(inner), table.source.variable.take()];
        table.source.variable = Some(parts.into_iter().flatten().collect::<Vec<_>>().join(", "));
    }
    found.append(of_variables(&arrays, Vec::new(), (name, sha256)), name);
    Ok(found)
}

fn of_single(
    bytes: &[u8],
    path: &Path,
    place: (&str, &str),
    meter: &MemoryBudget<'_>,
) -> Result<FoundRecords, FileError> {
    let wrong = |fault| FileError::Variables { path: path.to_owned(), fault };
    let decoded = |bytes: &[u8]| {
        let mut found = FoundRecords::default();
        for columns in of_text(&decode(bytes, meter)?.text, meter)? {
            found.add(columns.of_file(place.0, place.1));
        }
        Ok(found)
    };
    match FileFormat::of(bytes, path) {
        FileFormat::Text => decoded(bytes).map_err(wrong),
        FileFormat::Json => {
            let source = Source::of(bytes, path)?;
            let first = source.text().iter().find(|byte| !byte.is_ascii_whitespace());
            if !matches!(first, Some(b'{' | b'[')) {
                return decoded(source.text()).map_err(wrong);
            }
            Ok(of_variables(&variables_of(source.text()).map_err(wrong)?, Vec::new(), place))
        }
        _ => match contents_of(bytes, path, meter)? {
            Contents::Variables { variables, notes } => Ok(of_variables(&variables, notes, place)),
            Contents::Table(table) => {
                let mut found = FoundRecords::default();
                found.add(of_table(*table).of_file(place.0, place.1));
                Ok(found)
            }
            Contents::Dataset(_) | Contents::Models(_) => {
                let passed_over = vec!["a dataset, not a record".to_owned()];
                Ok(FoundRecords { passed_over, ..FoundRecords::default() })
            }
        },
    }
}

fn of_variables(variables: &[Variable], notes: Vec<String>, (name, sha256): (&str, &str)) -> FoundRecords {
    let Search { records, faults, passed_over } = Search::of(variables);
    let mut found = FoundRecords { faults, passed_over, ..FoundRecords::default() };
    for mut columns in records {
        columns.notes.extend(notes.iter().cloned());
        found.add(columns.of_file(name, sha256));
    }
    found
}

/// The columns of a text; where these change on the way, of every part that is long enough to be a record.
fn of_text(text: &str, meter: &MemoryBudget<'_>) -> Result<Vec<Columns>, VariableFault> {
    let first = match of_whole_text(text, meter) {
        Err(fault @ (VariableFault::Line { .. } | VariableFault::Format { .. })) => fault,
        whole => return whole.map(|columns| vec![columns]),
    };
    let parts = sections(text);
    let count = parts.len();
    let mut found = Vec::new();
    for (index, (line, part)) in parts.into_iter().enumerate().filter(|_| count > 1) {
        match of_whole_text(part, meter) {
            Ok(columns) if columns.columns.first().is_some_and(|column| column.values.len() >= Separation::FEWEST) => {
                let note = format!("one of {count} tables in the file, from line {line}");
                let notes = [vec![note], columns.notes].concat();
                found.push(Columns { variable: format!("table {}", index + 1), notes, ..columns });
            }
            Err(fault @ (VariableFault::Stopped | VariableFault::TooLarge { .. })) => return Err(fault),
            _ => {}
        }
    }
    if found.is_empty() { Err(first) } else { Ok(found) }
}

/// The columns of one table: of one with words or times of the clock among its numbers, with numbers in their place.
fn of_whole_text(text: &str, meter: &MemoryBudget<'_>) -> Result<Columns, VariableFault> {
    let first = match read_table(text, meter) {
        Err(fault @ (VariableFault::Line { .. } | VariableFault::Format { .. })) => fault,
        table => return table.map(of_table),
    };
    let Some(NumberedText { text, notes }) = numbered_words(text, meter)? else { return Err(first) };
    // What is wrong in the text as it stands says more than what is wrong in this one.
    let mut columns = of_table(read_table(&text, meter).map_err(|_| first)?);
    columns.notes.extend(notes);
    Ok(columns)
}

/// The columns of a table of text.
fn of_table(table: TextTable) -> Columns {
    let TextTable { names, units, columns, notes, .. } = table;
    let named = names.is_some();
    let names = names.unwrap_or_default();
    let columns = columns.into_iter().enumerate().map(|(index, values)| {
        let name = names.get(index).filter(|name| !name.is_empty()).cloned();
        let name = name.unwrap_or_else(|| format!("column {}", index + 1));
        RecordColumn { unit: units.get(index).cloned().flatten(), ..RecordColumn::new(name, values) }
    });
    Columns { variable: String::new(), columns: columns.collect(), named, sample_time_s: None, notes }
}

fn has_ending(path: &Path) -> bool {
    let ending = path.extension().map(|ending| ending.to_string_lossy().to_lowercase()).unwrap_or_default();
    ENDINGS.contains(&ending.as_str())
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
    let found = records_of_bytes(ARCHIVE, NAME, MOST_MEMORY)?;
    let is_of = |table: &RecordTable| RecordGuess::of(&table.name, &patterns).condition == Some(condition);
    Ok(found.tables.into_iter().filter(is_of).collect())
}

// Where among variables records are.

/// Deepest nesting that is searched for records.
const DEEPEST: usize = 8;

/// What was found among variables.
#[derive(Default)]
pub(super) struct Search {
    pub(super) records: Vec<Columns>,
    /// What looks like a record but cannot be taken, with its place and why.
    pub(super) faults: Vec<String>,
    /// What is no record, in words.
    pub(super) passed_over: Vec<String>,
}

impl Search {
    /// Every record among the variables of a file: what they are together, then each by itself, inside out.
    pub(super) fn of(variables: &[Variable]) -> Self {
        let mut search = Self::default();
        let together = Record::of_variables(variables);
        search.records.extend(columns_of(&together, ""));
        for variable in variables {
            search.descend(&variable.name, &variable.value, DEEPEST);
        }
        if search.records.is_empty() && search.faults.is_empty() {
            let words = variables.iter().map(|variable| format!("{}: {}", variable.name, variable.value.words()));
            search.passed_over.extend(words.take(20));
        }
        search
    }

    fn descend(&mut self, name: &str, value: &Value, deeper: usize) {
        if deeper == 0 || self.records.len() >= MOST_RECORDS {
            self.faults
                .push(format!("{name}: too many values, or values nested too deeply, to look for records in them"));
            return;
        }
        match value {
            Value::Struct(records) => self.descend_records(name, records, None, deeper),
            Value::Object(object) => self.descend_records(name, &object.records, Some(&object.class), deeper),
            Value::Cell(cell) => {
                let holds_records =
                    |value: &Value| matches!(value, Value::Struct(_) | Value::Object(_) | Value::Cell(_));
                for (index, value) in cell.values.iter().enumerate().filter(|(_, value)| holds_records(value)) {
                    self.descend(&format!("{name}{{{}}}", index + 1), value, deeper - 1);
                }
            }
            Value::Opaque { class, why } => self.faults.push(format!("{name} ({class}): {why}")),
            Value::Array(_) | Value::Text(_) => {}
        }
    }

    fn descend_records(&mut self, name: &str, records: &StructArray, class: Option<&str>, deeper: usize) {
        let count = records.shape.iter().product::<usize>();
        for index in 0..count {
            let name = if count == 1 { name.to_owned() } else { format!("{name}({})", index + 1) };
            let record = Record::of_struct(records, index, class, 0);
            if is_iddata(&record) {
                match experiments(&record, &name) {
                    Ok(found) => self.records.extend(found),
                    Err(why) => self.faults.push(format!("{name}: {why}")),
                }
                continue;
            }
            let found = timetable_columns(&record, &name)
                .or_else(|| simulink_columns(&record, &name))
                .or_else(|| columns_of(&record, &name));
            if let Some(columns) = found {
                self.records.push(columns);
                continue;
            }
            for (field, value) in Record::of_struct(records, index, None, 0).fields() {
                self.descend(&format!("{name}.{field}"), value, deeper - 1);
            }
        }
    }
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
