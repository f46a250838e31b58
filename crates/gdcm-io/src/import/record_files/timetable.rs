//! MATLAB's timetables and tables.
//!
//! A timetable is saved as a struct `any` with `data` (a cell for each variable), `varNames`,
//! `varUnits` and `rowTimes`: a `duration` (`millis`), a `datetime` (`data`, ms since 1970), or
//! `origin` with `stepSize` or `sampleRate`. A table has `data`, `varnames` and
//! `props.VariableUnits`. Source: files from MATLAB R2017a to R2024a as described by the mat-io
//! project.

use gdcm_sysid::records::RecordColumn;

use super::samples::{first_column_of, first_number_of, named_columns, samples_of};
use crate::formats::reading_note::ReadingNote;
use crate::formats::recorded_columns::Columns;
use crate::formats::variables::Value;
use crate::import::recognise::record::Record;
use crate::import::recognise::values::texts_of;

const MILLISECOND: f64 = 1e-3;

/// Reads the columns from a timetable or a table; `None` for objects of other classes.
pub(super) fn timetable_columns(record: &Record<'_>, variable: &str) -> Option<Columns> {
    match record.class? {
        "timetable" => read_timetable(record, variable),
        "table" => read_table(record, variable),
        _ => None,
    }
}

/// Reads a timetable. Row times whose count differs from the samples are left out: the record then
/// has neither time nor sample time.
fn read_timetable(record: &Record<'_>, variable: &str) -> Option<Columns> {
    let inner = inner_record(record.get(&["any"])?)?;
    let names = texts_of(inner.get(&["varNames"])?)?;
    let units = inner.get(&["varUnits"]).and_then(texts_of);
    let Value::Cell(data) = inner.get(&["data"])? else {
        return None;
    };
    let mut columns = numeric_columns(&data.values, &names, &units.unwrap_or_default());
    let rows = columns.first()?.values.len();
    let mut sample_time_s = None;
    let mut notes = Vec::new();
    match row_times(inner.get(&["rowTimes"])?)? {
        RowTimes::Step(step_s) => sample_time_s = Some(step_s),
        RowTimes::Stamps { time_s, is_clock } => {
            if is_clock {
                notes.push(ReadingNote::ClockTimes);
            }
            if time_s.len() == rows {
                let time = RecordColumn {
                    unit: Some("s".to_owned()),
                    ..RecordColumn::new("Time", time_s)
                };
                columns.insert(0, time);
            }
        }
    }
    Some(Columns {
        sample_time_s,
        notes,
        ..Columns::new(variable.to_owned(), columns)
    })
}

fn read_table(record: &Record<'_>, variable: &str) -> Option<Columns> {
    let names = texts_of(record.get(&["varnames"])?)?;
    let units = record
        .get(&["props"])
        .and_then(inner_record)
        .and_then(|props| texts_of(props.get(&["VariableUnits"])?));
    let Value::Cell(data) = record.get(&["data"])? else {
        return None;
    };
    let columns = numeric_columns(&data.values, &names, &units.unwrap_or_default());
    if columns.is_empty() {
        return None;
    }
    Some(Columns::new(variable.to_owned(), columns))
}

/// Returns the fields of a struct or an object (the first element's, if it is an array).
fn inner_record(value: &Value) -> Option<Record<'_>> {
    let records = match value {
        Value::Struct(records) => records,
        Value::Object(object) => &object.records,
        Value::Array(_) | Value::Text(_) | Value::Cell(_) | Value::Opaque { .. } => return None,
    };
    Some(Record::from_struct(records, 0))
}

/// Returns the numeric columns that are as long as the first; omits other variables.
fn numeric_columns(data: &[Value], names: &[String], units: &[String]) -> Vec<RecordColumn> {
    let mut columns: Vec<RecordColumn> = Vec::new();
    for (index, (value, name)) in data.iter().zip(names).enumerate() {
        let rows = columns.first().map(|column| column.values.len());
        let Some(samples) = samples_of(value, rows) else {
            continue;
        };
        if rows.is_some_and(|rows| rows != samples.rows) {
            continue;
        }
        let unit = match units.get(index) {
            Some(unit) if !unit.is_empty() => Some(unit.clone()),
            _ => None,
        };
        for mut column in named_columns(name, samples.columns) {
            column.unit.clone_from(&unit);
            columns.push(column);
        }
    }
    columns
}

/// How a timetable gives its sample times.
enum RowTimes {
    Stamps {
        /// Row times \[s\].
        time_s: Vec<f64>,
        /// Whether the file contains clock times; `time_s` is then relative to the first.
        is_clock: bool,
    },
    /// Constant sample time \[s\].
    Step(f64),
}

/// Reads the row times: a `duration`; else a `datetime`; else a constant step. `None` for any other
/// value.
fn row_times(value: &Value) -> Option<RowTimes> {
    if let Some(millis) = millis_of(value) {
        return Some(RowTimes::Stamps {
            time_s: millis.iter().map(|ms| ms * MILLISECOND).collect(),
            is_clock: false,
        });
    }
    let record = inner_record(value)?;
    if let Some(data) = record.get(&["data"])
        && let Some(samples) = samples_of(data, None)
    {
        let clock = samples.columns.into_iter().next()?;
        let start = clock.iter().copied().find(|ms| ms.is_finite())?;
        // Subtracted before scaling: milliseconds since 1970 leave few digits of a double for
        // fractions.
        return Some(RowTimes::Stamps {
            time_s: clock.iter().map(|ms| (ms - start) * MILLISECOND).collect(),
            is_clock: true,
        });
    }
    regular_step(&record).map(RowTimes::Step)
}

/// Returns the constant sample time \[s\]: from the step, unless the object is specified by its
/// rate; else from the sample rate \[Hz\].
fn regular_step(record: &Record<'_>) -> Option<f64> {
    let is_rate_given = match record.get(&["specifiedAsRate"]).and_then(first_number_of) {
        Some(is_rate) => is_rate != 0.0,
        None => false,
    };
    if !is_rate_given
        && let Some(millis) = record.get(&["stepSize"]).and_then(millis_of)
        && let Some(step) = millis.first()
    {
        return Some(step * MILLISECOND);
    }
    let rate = first_number_of(record.get(&["sampleRate"])?)?;
    if rate > 0.0 { Some(1.0 / rate) } else { None }
}

/// Returns a `duration`'s values \[ms\].
fn millis_of(value: &Value) -> Option<Vec<f64>> {
    first_column_of(inner_record(value)?.get(&["millis"])?)
}
