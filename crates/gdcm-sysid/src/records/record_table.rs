//! A record as stored in its file: columns with samples.
//!
//! A *topic* is a group of columns in a log that share stamps of their own, such as those of one
//! sensor.

use std::sync::Arc;

use gdcm_model::dataset::channel::ChannelSide;
use gdcm_model::units::number;

/// A column: its name, unit and samples.
#[derive(Clone, Debug, PartialEq)]
pub struct RecordColumn {
    /// Name in the file; "column 3" if the file does not name its third column.
    pub name: String,
    /// Unit in the file.
    pub unit: Option<String>,
    /// Input or output, if the file states it.
    pub side: Option<ChannelSide>,
    /// Samples, in the file's unit; NaN where missing.
    pub values: Vec<f64>,
    /// Topic with a separate clock; `None` for columns on the table's clock.
    pub topic: Option<Arc<TopicClock>>,
    /// The channel, such as "P" or "LON", according to the logging system's documentation.
    pub meaning: Option<&'static str>,
}

/// Sample times shared by a topic's columns.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TopicClock {
    pub name: String,
    /// A stamp for each sample \[s\].
    pub time_s: Vec<f64>,
}

impl RecordColumn {
    /// Creates a column from a name and samples only.
    pub fn new(name: impl Into<String>, values: Vec<f64>) -> Self {
        Self {
            name: name.into(),
            unit: None,
            side: None,
            values,
            topic: None,
            meaning: None,
        }
    }

    /// Returns the column name within its topic: `xyz[0]` for `vehicle_angular_velocity.xyz[0]`.
    pub fn field(&self) -> &str {
        let topic = self.topic.as_ref().map_or("", |topic| topic.name.as_str());
        self.name
            .strip_prefix(topic)
            .and_then(|rest| rest.strip_prefix('.'))
            .unwrap_or(&self.name)
    }

    /// Returns the unit in the file unless it is blank.
    pub fn unit_in_file(&self) -> Option<&str> {
        self.unit.as_deref().filter(|unit| !unit.trim().is_empty())
    }

    /// Returns the smallest and the largest finite sample; `None` without finite samples.
    pub fn range(&self) -> Option<(f64, f64)> {
        let mut least = f64::INFINITY;
        let mut most = f64::NEG_INFINITY;
        for value in &self.values {
            if value.is_finite() {
                least = least.min(*value);
                most = most.max(*value);
            }
        }
        if least <= most {
            Some((least, most))
        } else {
            None
        }
    }

    /// Returns whether the finite samples differ.
    pub(super) fn varies(&self) -> bool {
        self.range().is_some_and(|(least, most)| least < most)
    }

    /// Returns the largest absolute finite sample.
    pub(super) fn peak(&self) -> Option<f64> {
        let (least, most) = self.range()?;
        Some(least.abs().max(most.abs()))
    }
}

/// A record's file, and its place in that file.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct RecordSource {
    pub file: String,
    /// The file's SHA-256, in hexadecimal.
    pub sha256: String,
    /// The record or variable within the file; `None` if the file has only one.
    pub variable: Option<String>,
}

/// A record as stored in its file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RecordTable {
    /// Name for display.
    pub name: String,
    /// Columns, equally long except for topics with separate clocks.
    pub columns: Vec<RecordColumn>,
    /// Whether the file names the columns.
    pub named: bool,
    /// Sample time \[s\], if the file gives it outside its columns.
    pub sample_time_s: Option<f64>,
    pub source: RecordSource,
    /// Notes from reading the file.
    pub notes: Vec<String>,
    /// Mode intervals from the logging system.
    pub modes: Vec<ModeSpan>,
    /// First and last time used \[s\]; `None` for the whole record.
    pub part_s: Option<[f64; 2]>,
}

/// Interval in which the logging system was armed, or in a flight mode.
#[derive(Clone, Debug, PartialEq)]
pub struct ModeSpan {
    /// "armed", or the mode's name.
    pub name: String,
    /// First and last time \[s\], on the record's clock.
    pub ends_s: [f64; 2],
}

impl RecordTable {
    /// Creates a table of named columns, with all other fields empty.
    pub fn new(name: impl Into<String>, columns: Vec<RecordColumn>) -> Self {
        Self {
            name: name.into(),
            columns,
            named: true,
            ..Self::default()
        }
    }

    /// Returns the longest column's sample count.
    pub fn rows(&self) -> usize {
        self.columns
            .iter()
            .map(|column| column.values.len())
            .max()
            .unwrap_or(0)
    }

    /// Returns whether columns have separate clocks.
    pub(super) fn has_topics(&self) -> bool {
        self.columns.iter().any(|column| column.topic.is_some())
    }

    /// Finds a column by its exact name, its name ignoring case, its number (`#30`, counted from
    /// 1), or its index in a matrix (`xyz[0]` for `xyz_1`).
    pub fn find(&self, name: &str) -> Option<usize> {
        if let Some(exact) = self.columns.iter().position(|column| column.name == name) {
            return Some(exact);
        }
        let name = name.trim();
        self.position_ignoring_case(name)
            .or_else(|| self.position_by_number(name))
            .or_else(|| self.position_in_matrix(name))
    }

    fn position_ignoring_case(&self, name: &str) -> Option<usize> {
        self.columns
            .iter()
            .position(|column| column.name.eq_ignore_ascii_case(name))
    }

    /// Returns a column's index from its number: 29 for `#30`.
    fn position_by_number(&self, name: &str) -> Option<usize> {
        let number: usize = name.strip_prefix('#')?.parse().ok()?;
        let column = number.checked_sub(1)?;
        if column < self.columns.len() {
            Some(column)
        } else {
            None
        }
    }

    /// Returns the index of a matrix column, which readers name `xyz_1`. `name` counts from 0 as in
    /// Python (`xyz[0]`) or from 1 as in MATLAB (`xyz(1)`).
    fn position_in_matrix(&self, name: &str) -> Option<usize> {
        let (matrix, index, first) = if let Some(rest) = name.strip_suffix(']') {
            let (matrix, index) = rest.rsplit_once('[')?;
            (matrix, index, 0)
        } else {
            let (matrix, index) = name.strip_suffix(')')?.rsplit_once('(')?;
            (matrix, index, 1)
        };
        let index: usize = index.trim().parse().ok()?;
        let number = index.checked_sub(first)? + 1;
        self.position_ignoring_case(&format!("{matrix}_{number}"))
    }

    /// Returns a copy that marks the time between two stamps \[s\] on its clock as the used part
    /// (`part_s`), and that is named after the part. It keeps all samples; layout and resampling
    /// select those in the part.
    #[must_use]
    pub fn part_of_time(&self, part_s: [f64; 2]) -> RecordTable {
        let mut part = self.clone();
        part.name = format!(
            "{}, {} to {} s",
            self.name,
            number(part_s[0]),
            number(part_s[1])
        );
        part.part_s = Some(part_s);
        part
    }

    /// Returns a column's name in quotation marks; its number if the column does not exist.
    pub(super) fn quoted(&self, column: usize) -> String {
        match self.columns.get(column) {
            Some(column) => format!("\"{}\"", column.name),
            None => format!("column {}", column + 1),
        }
    }

    pub(super) fn column_names(&self) -> Vec<String> {
        self.columns
            .iter()
            .map(|column| column.name.clone())
            .collect()
    }
}

/// Joins names with commas; after the first 20, the others are only counted.
pub fn shortened_list<S: AsRef<str>>(names: &[S]) -> String {
    /// Maximum number of names in a message.
    const SHOWN: usize = 20;
    let names: Vec<&str> = names.iter().map(AsRef::as_ref).collect();
    if names.len() <= SHOWN {
        names.join(", ")
    } else {
        let more = names.len() - SHOWN;
        format!("{} and {more} more", names[..SHOWN].join(", "))
    }
}

/// Returns whether samples are equal, with missing samples in the same places.
pub(super) fn same_samples(first: &[f64], second: &[f64]) -> bool {
    first.len() == second.len()
        && first
            .iter()
            .zip(second)
            .all(|(a, b)| a == b || (a.is_nan() && b.is_nan()))
}
