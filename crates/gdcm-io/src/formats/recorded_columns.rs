//! Columns of a flight record as read from a file, without the file's name and hash.

use crate::formats::reading_note::{ReadingNote, note_texts};
use gdcm_sysid::records::{ModeSpan, RecordColumn, RecordSource, RecordTable};

/// Maximum number of records in a file.
pub(crate) const MOST_RECORDS: usize = 1000;

/// A flight record's columns, without the file's name and hash.
pub(crate) struct Columns {
    /// Variable in the file that holds the record, such as "rec(2)"; empty for the whole file.
    pub(crate) variable: String,
    pub(crate) columns: Vec<RecordColumn>,
    /// Whether the file gives column names.
    pub(crate) named: bool,
    /// Sample time \[s\]; `None` if the file does not give it.
    pub(crate) sample_time_s: Option<f64>,
    /// Notes for the user on how the file was read.
    pub(crate) notes: Vec<ReadingNote>,
    /// Flight modes over time, as logged.
    pub(crate) modes: Vec<ModeSpan>,
}

impl Columns {
    /// Creates named columns without sample time, notes and modes.
    pub(crate) fn new(variable: String, columns: Vec<RecordColumn>) -> Self {
        Self {
            variable,
            columns,
            named: true,
            sample_time_s: None,
            notes: Vec::new(),
            modes: Vec::new(),
        }
    }

    /// Returns a record with these columns. `name` and `sha256` identify the file; the record is
    /// named after the file, without its extension and a `.csv` before it, and after the variable.
    pub(crate) fn in_file(self, name: &str, sha256: &str) -> RecordTable {
        let file = name.rsplit('/').next().unwrap_or(name);
        let stem = file.rsplit_once('.').map_or(file, |(stem, _)| stem);
        let stem = stem.strip_suffix(".csv").unwrap_or(stem);
        let record_name = if self.variable.is_empty() {
            stem.to_owned()
        } else {
            format!("{stem}, {}", self.variable)
        };
        let variable = if self.variable.is_empty() {
            None
        } else {
            Some(self.variable)
        };
        RecordTable {
            named: self.named,
            sample_time_s: self.sample_time_s,
            source: RecordSource {
                file: name.to_owned(),
                sha256: sha256.to_owned(),
                variable,
            },
            notes: note_texts(&self.notes),
            modes: self.modes,
            ..RecordTable::new(record_name, self.columns)
        }
    }
}
