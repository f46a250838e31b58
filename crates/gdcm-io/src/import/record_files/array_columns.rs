//! Flight records from vectors and matrices of equal length.
//!
//! A [`Record`] is a group of fields, such as a struct, that may hold a flight record; it marks the
//! fields that are used.

use std::collections::BTreeMap;

use gdcm_model::names::time_name::{SAMPLE_TIME_NAMES, time_name_rank};
use gdcm_sysid::records::RecordColumn;

use super::column_labels::ColumnLabels;
use super::samples::samples_of;
use crate::formats::reading_note::ReadingNote;
use crate::formats::recorded_columns::Columns;
use crate::formats::variables::Value;
use crate::import::recognise::record::Record;

/// Minimum number of samples in a record with time stamps or a sample time.
pub(super) const FEWEST_TIMED: usize = 20;
/// Minimum number of samples in a record with neither time stamps nor a sample time: a shorter
/// matrix may be any table of numbers.
const FEWEST: usize = 50;
/// Rank ([`time_name_rank`]) of names that only contain the word "time"; names with lower ranks
/// denote the time itself.
const UNSURE_TIME_RANK: u8 = 2;
const SAMPLE_RATE_NAMES: [&str; 5] = [
    "fs",
    "sample_rate",
    "sampling_rate",
    "sample_rate_hz",
    "fsamp",
];

/// Length of a record, and how it was determined.
struct RecordLength {
    /// Sample count.
    rows: usize,
    /// Whether a time vector determines the length.
    is_timed: bool,
}

/// Returns the record formed by the arrays of equal length.
///
/// 1. Fields `A`, `B` and `C`: a model, `None`.
/// 2. The length is that of the time vector, otherwise the length with the most columns. With
///    fewer samples than `FEWEST_TIMED`, or `FEWEST` if times are unknown: `None`.
/// 3. The arrays with this length become columns; the others are listed in a note. Fewer than two
///    columns: `None`.
/// 4. Columns of a single matrix without labels are numbered.
pub(super) fn array_columns(record: &Record<'_>, variable: &str) -> Option<Columns> {
    // Step 1.
    let is_model = ["A", "B", "C"]
        .iter()
        .all(|letter| record.exact(letter).is_some());
    if is_model {
        return None;
    }
    // Step 2.
    let sample_time_s = sample_time(record);
    let RecordLength { rows, is_timed } = record_length(record)?;
    let fewest = if is_timed || sample_time_s.is_some() {
        FEWEST_TIMED
    } else {
        FEWEST
    };
    if rows < fewest {
        return None;
    }
    // Step 3.
    let mut arrays = LongArrays::find(record, rows);
    if arrays.columns.len() < 2 {
        return None;
    }
    // Step 4.
    if !arrays.have_names {
        for (index, column) in arrays.columns.iter_mut().enumerate() {
            column.name = format!("column {}", index + 1);
        }
    }
    let mut notes = Vec::new();
    if !arrays.left_out.is_empty() {
        notes.push(ReadingNote::OtherLengths {
            names: arrays.left_out,
        });
    }
    Some(Columns {
        named: arrays.have_names,
        sample_time_s,
        notes,
        ..Columns::new(variable.to_owned(), arrays.columns)
    })
}

/// Vectors and matrices with the record's length.
struct LongArrays {
    columns: Vec<RecordColumn>,
    /// Whether the columns have names: not if they come from a single matrix without labels.
    have_names: bool,
    /// Names of the arrays with another length; single numbers are not listed.
    left_out: Vec<String>,
}

impl LongArrays {
    fn find(record: &Record<'_>, rows: usize) -> Self {
        let mut columns: Vec<RecordColumn> = Vec::new();
        let mut matrices = 0;
        let mut vectors = 0;
        let mut has_labels = false;
        let mut left_out = Vec::new();
        for field in record.fields() {
            let Some(samples) = samples_of(field.value, Some(rows)) else {
                continue;
            };
            let name = field.name.trim_matches('_');
            if samples.rows != rows {
                if samples.rows > 1 {
                    left_out.push(name.to_owned());
                }
                continue;
            }
            let count = samples.columns.len();
            if count == 1 {
                vectors += 1;
            } else {
                matrices += 1;
            }
            let labels = ColumnLabels::find(record, name, count);
            has_labels |= labels.has_names();
            columns.extend(labels.label(name, samples.columns));
        }
        Self {
            columns,
            have_names: has_labels || vectors > 0 || matrices > 1,
            left_out,
        }
    }
}

/// Returns the longest time vector's length if it has at least `FEWEST_TIMED` samples; otherwise
/// the length with the most columns, in a tie the greater length. `None` without any samples.
fn record_length(record: &Record<'_>) -> Option<RecordLength> {
    let mut timed = None;
    for field in record.fields() {
        if time_name_rank(field.name).is_some_and(|rank| rank < UNSURE_TIME_RANK)
            && let Some(samples) = samples_of(field.value, None)
            && samples.columns.len() == 1
        {
            timed = timed.max(Some(samples.rows));
        }
    }
    if let Some(rows) = timed
        && rows >= FEWEST_TIMED
    {
        return Some(RecordLength {
            rows,
            is_timed: true,
        });
    }
    let mut columns_by_length: BTreeMap<usize, usize> = BTreeMap::new();
    for field in record.fields() {
        // Not single numbers, nor square matrices, in which time may run along either dimension.
        if let Some(samples) = samples_of(field.value, None)
            && samples.columns.len() < samples.rows
        {
            *columns_by_length.entry(samples.rows).or_default() += samples.columns.len();
        }
    }
    let (rows, _) = columns_by_length
        .into_iter()
        .max_by_key(|(rows, columns)| (*columns, *rows))?;
    Some(RecordLength {
        rows,
        is_timed: false,
    })
}

/// Returns the sample time \[s\], given directly or as a sample rate \[Hz\]; `None` if neither is
/// given.
fn sample_time(record: &Record<'_>) -> Option<f64> {
    let step = match positive_number(record, &SAMPLE_TIME_NAMES) {
        Some(step) => step,
        None => 1.0 / positive_number(record, &SAMPLE_RATE_NAMES)?,
    };
    if step.is_finite() { Some(step) } else { None }
}

/// Returns the positive number in the first field found under these names; `None` if there is none.
fn positive_number(record: &Record<'_>, names: &[&str]) -> Option<f64> {
    let Value::Array(array) = record.get(names)? else {
        return None;
    };
    match array.re.as_slice() {
        [value] if *value > 0.0 => Some(*value),
        _ => None,
    }
}
