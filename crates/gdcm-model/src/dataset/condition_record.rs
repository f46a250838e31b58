//! A condition's flight record, as listed in a dataset: its file, its manoeuvre and its use.

use std::collections::BTreeMap;

use super::channel_remedy::ChannelRemedy;

/// Reference to a flight record: the file with its samples, and how they are used.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ConditionRecord {
    /// Name, unique in the condition.
    pub name: String,
    /// Path relative to the dataset's file.
    pub file: String,
    /// Record or variable name in the file; `None` if the file contains a single record.
    pub variable: Option<String>,
    /// SHA-256 of the file, in hexadecimal.
    pub sha256: Option<String>,
    pub kind: RecordKind,
    /// Whether the record is reserved for validation and not used for identification.
    pub held_out: bool,
    /// Whether the record is used at all, for identification or validation.
    pub used: bool,
    /// Sample time \[s\]; `None` until the record has been read.
    pub sample_time_s: Option<f64>,
    /// Intervals in use: first and last time \[s\] on the record's time axis; empty if the whole
    /// record is used.
    pub used_s: Vec<[f64; 2]>,
    /// Interval in the file that forms this record: first and last time \[s\] on the file's time
    /// axis; `None` for the whole file.
    pub part_s: Option<[f64; 2]>,
    /// Channel corrections specific to this record, by channel name.
    pub remedies: BTreeMap<String, ChannelRemedy>,
}

impl ConditionRecord {
    /// Creates an entry for a whole record in use, with an unknown manoeuvre.
    pub fn new(name: impl Into<String>, file: impl Into<String>) -> Self {
        Self {
            name: name.into(),
            file: file.into(),
            used: true,
            ..Self::default()
        }
    }

    /// Checks the sample time and the time intervals.
    ///
    /// # Errors
    /// The first value out of range.
    pub(super) fn check_times(&self) -> Result<(), TimeFault> {
        if let Some(value) = self.sample_time_s
            && (!value.is_finite() || value <= 0.0)
        {
            return Err(TimeFault {
                field: "sample_time_s",
                expected: "a positive number of seconds",
                value,
            });
        }
        for piece in &self.used_s {
            check_piece("used_s", *piece)?;
        }
        if let Some(part) = self.part_s {
            check_piece("part_s", part)?;
        }
        Ok(())
    }

    /// Returns whether both entries refer to the same record in the same file. The hashes are
    /// compared if both are known. Only the file names in the paths are compared, because the
    /// folders may be relative to different places.
    fn is_of_same_source(&self, other: &ConditionRecord) -> bool {
        let contents_differ = match (&self.sha256, &other.sha256) {
            (Some(a), Some(b)) => a != b,
            _ => false,
        };
        self.file_name() == other.file_name() && self.variable == other.variable && !contents_differ
    }

    /// Returns the file name without folders.
    fn file_name(&self) -> &str {
        self.file.rsplit('/').next().unwrap_or_default()
    }

    /// Returns whether both entries refer to the same samples, under any name.
    pub(super) fn is_same_as(&self, other: &ConditionRecord) -> bool {
        self.part_s == other.part_s && self.is_of_same_source(other)
    }

    /// Returns whether this entry is a part of the full record `whole`.
    pub(super) fn is_part_of(&self, whole: &ConditionRecord) -> bool {
        self.part_s.is_some() && whole.part_s.is_none() && self.is_of_same_source(whole)
    }
}

/// A sample time or interval end out of range.
pub(super) struct TimeFault {
    /// Key in the dataset file.
    pub(super) field: &'static str,
    pub(super) expected: &'static str,
    pub(super) value: f64,
}

fn check_piece(field: &'static str, [first, last]: [f64; 2]) -> Result<(), TimeFault> {
    if !first.is_finite() {
        return Err(TimeFault {
            field,
            expected: "finite times",
            value: first,
        });
    }
    if !last.is_finite() || last < first {
        return Err(TimeFault {
            field,
            expected: "a finite last time, not before the first",
            value: last,
        });
    }
    Ok(())
}

/// The manoeuvre flown in a record.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum RecordKind {
    Sweep,
    /// Sum of sines.
    Multisine,
    /// 3-2-1-1 (steps of three, two, one and one time units), or doublets.
    ThreeTwoOneOne,
    #[default]
    Other,
}

impl RecordKind {
    pub const ALL: [Self; 4] = [
        Self::Sweep,
        Self::Multisine,
        Self::ThreeTwoOneOne,
        Self::Other,
    ];

    /// Returns the manoeuvre's keyword in files and tables.
    pub fn word(self) -> &'static str {
        match self {
            Self::Sweep => "sweep",
            Self::Multisine => "multisine",
            Self::ThreeTwoOneOne => "3-2-1-1",
            Self::Other => "other",
        }
    }

    /// Parses a keyword; `None` for an unknown word.
    pub fn from_word(word: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|kind| kind.word() == word)
    }
}
