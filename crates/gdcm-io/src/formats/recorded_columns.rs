//! Columns of a flight record as a format reads them, before their file is known.

use gdcm_sysid::records::{ModeSpan, RecordColumn, RecordSource, RecordTable};

/// Largest number of records in one file.
pub(crate) const MOST_RECORDS: usize = 1000;

/// Columns that belong together, before their file is known.
pub(crate) struct Columns {
    /// Their place in the file ("rec(2)"); empty if they are the whole file.
    pub(crate) variable: String,
    pub(crate) columns: Vec<RecordColumn>,
    /// Whether the columns have names in the file.
    pub(crate) named: bool,
    /// Sample time \[s\], if the file gives it.
    pub(crate) sample_time_s: Option<f64>,
    /// Remarks on the reading.
    pub(crate) notes: Vec<String>,
    /// Modes of the logging system over time.
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

    /// Returns the record of these columns in a file.
    pub(crate) fn in_file(self, name: &str, sha256: &str) -> RecordTable {
        let file = name.rsplit('/').next().unwrap_or(name);
        let stem = file.rsplit_once('.').map_or(file, |(stem, _)| stem);
        let stem = stem.strip_suffix(".csv").unwrap_or(stem);
        let Self {
            variable,
            columns,
            named,
            sample_time_s,
            notes,
            modes,
        } = self;
        let variable = Some(variable).filter(|variable| !variable.is_empty());
        let name_of_record = variable
            .as_ref()
            .map_or_else(|| stem.to_owned(), |variable| format!("{stem}, {variable}"));
        RecordTable {
            named,
            sample_time_s,
            source: RecordSource {
                file: name.to_owned(),
                sha256: sha256.to_owned(),
                variable,
            },
            notes,
            modes,
            ..RecordTable::new(name_of_record, columns)
        }
    }
}
