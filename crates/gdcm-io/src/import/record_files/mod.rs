//! Reads flight records from files: text tables, MATLAB, NumPy, JSON, logs, and archives of these.
//!
//! ```text
//! bytes -> format, from the first bytes                                        (formats)
//!       -> a table with columns, or variables, or files (text, mat, mat73, npy, zip, JSON)
//!       -> columns with equal lengths: iddata, timetables, structs, vectors,   (read_columns,
//!          matrices; or the columns of a text                                   text_columns)
//!       -> records: a table is split by a column that numbers them,            (add_table)
//!          or where time restarts
//! ```
//!
//! A *topic* is a table whose samples have their own times, such as a message in a log; topics are
//! joined to a record by these times.

mod array_columns;
mod column_labels;
mod dataset_entry;
mod embedded_example;
mod iddata;
mod samples;
mod simulink;
mod text_columns;
mod timetable;

#[cfg(test)]
mod record_file_tests;

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use gdcm_sysid::records::separation::Separation;
use gdcm_sysid::records::{RecordSource, RecordTable};

use self::array_columns::array_columns;
use self::iddata::{experiments, is_iddata};
use self::simulink::simulink_columns;
use self::text_columns::text_columns;
use self::timetable::timetable_columns;
use super::recognise::record::Record;
use super::recognise::{Found, search};
use crate::file_error::FileError;
use crate::formats::recorded_columns::{Columns, MOST_RECORDS};
use crate::formats::variables::Variable;
use crate::formats::{
    Contents, FolderProgress, ImportedFile, import, import_bytes, import_file, with_file_name,
};
use crate::import::recognise::recognition_fault::{RecognitionFault, fault_messages};
use crate::reading_budget::{ReadingBudget, VariableFault};

pub use self::dataset_entry::relative_entry;
pub use self::embedded_example::example_records;

/// Results of reading record files.
#[derive(Clone, Debug, Default)]
pub struct FoundRecords {
    /// Records in the order of the files.
    pub tables: Vec<RecordTable>,
    /// Parts that could not be read, each with its place and the reason.
    pub faults: Vec<String>,
    /// Descriptions of contents that are not records.
    pub ignored: Vec<String>,
    pub files: usize,
    /// Files requested by name that could not be read completely, or contain no record.
    pub unread: Vec<PathBuf>,
}

/// Reads the records in files, folders and subfolders. A file that cannot be read is recorded in
/// `faults`, and the others are read.
///
/// # Errors
/// [`FileError`] if a folder cannot be read, or if the only file cannot be read.
pub fn read_records(
    paths: &[PathBuf],
    progress: &dyn FolderProgress,
) -> Result<FoundRecords, FileError> {
    let mut found = FoundRecords::default();
    let mut complete = Vec::new();
    let (files, faults) = import(paths, progress, |file, budget| {
        let path = file.path.to_owned();
        let records_before = found.tables.len();
        let faults_before = found.faults.len();
        found.add_file(file, budget)?;
        if found.tables.len() > records_before && found.faults.len() == faults_before {
            complete.push(path);
        }
        Ok(())
    })?;
    found.files = files;
    found.faults.extend(faults);
    for path in paths {
        if !path.is_dir() && !complete.contains(path) {
            found.unread.push(path.clone());
        }
    }
    Ok(found)
}

/// Reads the records in a file whose bytes are in memory.
pub fn records_of_bytes(
    bytes: &[u8],
    name: &str,
    budget: &ReadingBudget<'_>,
) -> Result<FoundRecords, FileError> {
    let mut found = FoundRecords {
        files: 1,
        ..FoundRecords::default()
    };
    found.add_file(import_bytes(bytes, Path::new(name), name, budget)?, budget)?;
    Ok(found)
}

/// Reads again the records to which a dataset refers by a file or folder and these variables;
/// `None` refers to the record without a variable name, such as the only one in a text. The file is
/// read once.
///
/// # Errors
/// [`FileError`] if the file cannot be read; in the returned list, [`FileError::NoRecord`] for each
/// record that is not in the file.
pub fn load_records(
    path: &Path,
    variables: &[Option<&str>],
    budget: &ReadingBudget<'_>,
) -> Result<Vec<Result<RecordTable, FileError>>, FileError> {
    let mut found = FoundRecords::default();
    if path.is_dir() {
        let progress = Stopped(budget.stop());
        import(&[path.to_owned()], &progress, |file, budget| {
            found.add_file(file, budget)
        })?;
    } else {
        let name = match path.file_name() {
            Some(name) => name.to_string_lossy().into_owned(),
            None => String::new(),
        };
        found.add_file(import_file(path, &name, budget)?, budget)?;
    }
    let mut records = Vec::with_capacity(variables.len());
    for variable in variables {
        records.push(match found.record(*variable) {
            Some(record) => Ok(record),
            None => Err(FileError::NoRecord {
                path: path.to_owned(),
                record: variable.map(str::to_owned),
                record_count: found.tables.len(),
            }),
        });
    }
    Ok(records)
}

/// Progress receiver that only passes on a cancellation.
struct Stopped<'s>(&'s Arc<AtomicBool>);

impl FolderProgress for Stopped<'_> {
    fn reading(&self, _: usize, _: usize, _: &str) {}

    fn stop(&self) -> Arc<AtomicBool> {
        Arc::clone(self.0)
    }
}

impl FoundRecords {
    /// Returns the record of a variable. If `variable` names topics of several files, the record is
    /// joined from them.
    fn record(&self, variable: Option<&str>) -> Option<RecordTable> {
        for table in &self.tables {
            if table.source.variable.as_deref() == variable {
                return Some(table.clone());
            }
        }
        RecordTable::of_topics_called(&self.tables, variable?)
    }

    /// Adds the records in the contents of a file. Those in an archive are found file by file, and
    /// among its arrays; datasets and models are ignored.
    fn add_file(
        &mut self,
        file: ImportedFile<'_>,
        budget: &ReadingBudget<'_>,
    ) -> Result<(), FileError> {
        let ImportedFile {
            path,
            name,
            sha256,
            contents,
        } = file;
        let error = |fault| FileError::variables(path, fault);
        match contents {
            Contents::Variables {
                variables, notes, ..
            } => {
                let mut found = search_records(&variables, budget).map_err(error)?;
                for columns in &mut found.items {
                    columns.notes.extend(notes.iter().cloned());
                }
                self.add_found(found, name, &sha256);
            }
            Contents::Text(text) => {
                for columns in text_columns(&text, budget).map_err(error)? {
                    self.add_table(columns.in_file(name, &sha256));
                }
            }
            Contents::Logs(logs) => {
                for log in logs {
                    self.add_table(log.in_file(name, &sha256));
                }
            }
            Contents::Dataset(..) | Contents::Models(..) => {
                self.ignored
                    .push(format!("{name}: a dataset or models, not a record"));
            }
            Contents::Archive {
                variables,
                files,
                ignored,
            } => {
                self.ignored.extend(ignored);
                for (inner, contents) in files {
                    self.add_archived_file(name, &sha256, &inner, contents, budget)?;
                    if self.tables.len() > MOST_RECORDS {
                        return Err(error(VariableFault::TooManyRecords {
                            found: self.tables.len(),
                            most: MOST_RECORDS,
                        }));
                    }
                }
                if !variables.is_empty() {
                    let found = search_records(&variables, budget).map_err(error)?;
                    self.add_found(found, name, &sha256);
                }
            }
        }
        Ok(())
    }

    /// Adds the records in the file `inner` of an archive; this path becomes part of the variable.
    /// A file that cannot be read is recorded in `faults`.
    ///
    /// # Errors
    /// Only a cancellation.
    fn add_archived_file(
        &mut self,
        archive: &str,
        sha256: &str,
        inner: &str,
        contents: Result<Contents, FileError>,
        budget: &ReadingBudget<'_>,
    ) -> Result<(), FileError> {
        let mut found = FoundRecords::default();
        let added = match contents {
            Ok(contents) => {
                let file = ImportedFile {
                    path: Path::new(inner),
                    name: inner,
                    sha256: sha256.to_owned(),
                    contents,
                };
                found.add_file(file, budget)
            }
            Err(error) => Err(error),
        };
        match added {
            Err(stopped) if stopped.is_stopped() => return Err(stopped),
            Err(error) => self.faults.push(error.to_string()),
            Ok(()) => {}
        }
        self.faults.append(&mut found.faults);
        self.ignored.append(&mut found.ignored);
        for mut table in found.tables {
            let variable = match table.source.variable {
                Some(variable) => format!("{inner}, {variable}"),
                None => inner.to_owned(),
            };
            table.source = RecordSource {
                file: archive.to_owned(),
                variable: Some(variable),
                ..table.source
            };
            self.tables.push(table);
        }
        Ok(())
    }

    /// Adds the records found among the variables of a file.
    fn add_found(&mut self, found: Found<Columns>, name: &str, sha256: &str) {
        for columns in found.items {
            self.add_table(columns.in_file(name, sha256));
        }
        self.faults
            .extend(with_file_name(name, fault_messages(found.faults)));
        self.ignored.extend(with_file_name(name, found.ignored));
    }

    /// Splits a table into records and adds them; tables side by side in it, each with its own time
    /// column, first become topics.
    fn add_table(&mut self, table: RecordTable) {
        let table = table.side_by_side();
        let separation = Separation::proposed(&table);
        self.tables.extend(table.separated(separation));
    }
}

/// Finds all flight records among the variables of a file.
pub(crate) fn search_records(
    variables: &[Variable],
    budget: &ReadingBudget<'_>,
) -> Result<Found<Columns>, VariableFault> {
    search(variables, budget, &read_columns)
}

/// Reads the flight records that the fields of a record form: identification data, else a timetable
/// or table, else Simulink's structure with time, else arrays of equal length; `None` if they form
/// none.
fn read_columns(
    record: &Record<'_>,
    variable: &str,
) -> Option<Vec<Result<Columns, RecognitionFault>>> {
    if is_iddata(record) {
        return Some(match experiments(record, variable) {
            Ok(found) => found.into_iter().map(Ok).collect(),
            Err(reason) => vec![Err(reason)],
        });
    }
    let columns = timetable_columns(record, variable)
        .or_else(|| simulink_columns(record, variable))
        .or_else(|| array_columns(record, variable))?;
    Some(vec![Ok(columns)])
}
