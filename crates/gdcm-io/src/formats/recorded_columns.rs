//! Flight record columns as a format reads them, without the name and the hash of their file.

use gdcm_sysid::records::{ModeSpan, RecordColumn, RecordSource, RecordTable};

/// Maximum number of records in a file.
pub(crate) const MOST_RECORDS: usize = 1000;

/// Columns of one record, without the name and the hash of their file.
pub(crate) struct Columns {
    /// Place in the file ("rec(2)"); empty for the whole file.
    pub(crate) variable: String,
    pub(crate) columns: Vec<RecordColumn>,
    /// Whether the columns have names in the file.
    pub(crate) named: bool,
    /// Sample time \[s\], if the file gives it.
    pub(crate) sample_time_s: Option<f64>,
    /// Remarks on the reading.
    pub(crate) notes: Vec<String>,
    /// Logging system modes over time.
    pub(crate) modes: Vec<ModeSpan>,
}

impl Columns {
    /// Creates named columns without further information.
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

    /// Returns the record with these columns; `name` and `sha256` identify the file.
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
            notes: self.notes,
            modes: self.modes,
            ..RecordTable::new(record_name, self.columns)
        }
    }
}
