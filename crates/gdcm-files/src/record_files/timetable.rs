//! MATLAB's timetables and tables.
//!
//! A timetable is saved as a struct `any` with `data` (a cell for each variable), `varNames`, `varUnits` and `rowTimes`: a `duration`
//! (`millis`), a `datetime` (`data`, ms since 1970), or `origin` with `stepSize` or `sampleRate`. A table has `data`, `varnames` and
//! `props.VariableUnits`. Source: files of MATLAB R2017a to R2024a as the mat-io project describes them.

use crate::recognise::labels::texts_of;
use crate::recognise::record::Record;
use crate::variables::{StructArray, Value};
use gdcm_core::records::RecordColumn;

use super::Columns;
use super::record_columns::samples_of;

const MILLISECOND: f64 = 1e-3;

/// The columns of a timetable or a table, if the object is one.
pub(super) fn timetable_columns(record: &Record<'_>, variable: &str) -> Option<Columns> {
    match record.class? {
        "timetable" => {
            let inner = inner(record.get(&["any"])?)?;
            let (names, units) = (texts_of(inner.get(&["varNames"])?)?, inner.get(&["varUnits"]).and_then(texts_of));
            let Value::Cell(data) = inner.get(&["data"])? else { return None };
            let mut columns = columns(&data.values, &names, units.as_deref());
            let rows = columns.first()?.values.len();
            let (mut sample_time_s, mut notes) = (None, Vec::new());
            match row_times(inner.get(&["rowTimes"])?)? {
                RowTimes::Step(step_s) => sample_time_s = Some(step_s),
                RowTimes::Stamps(values, note) => {
                    notes.extend(note);
                    if values.len() == rows {
                        let time = RecordColumn { unit: Some("s".to_owned()), ..RecordColumn::new("Time", values) };
                        columns.insert(0, time);
                    }
                }
            }
            Some(Columns { variable: variable.to_owned(), columns, named: true, sample_time_s, notes })
        }
        "table" => {
            let names = texts_of(record.get(&["varnames"])?)?;
            let units =
                record.get(&["props"]).and_then(inner).and_then(|props| texts_of(props.get(&["VariableUnits"])?));
            let Value::Cell(data) = record.get(&["data"])? else { return None };
            let columns = columns(&data.values, &names, units.as_deref());
            let found = !columns.is_empty();
            let variable = variable.to_owned();
            found.then_some(Columns { variable, columns, named: true, sample_time_s: None, notes: Vec::new() })
        }
        _ => None,
    }
}

fn inner(value: &Value) -> Option<Record<'_>> {
    let records: &StructArray = match value {
        Value::Struct(records) => records,
        Value::Object(object) => &object.records,
        Value::Array(_) | Value::Text(_) | Value::Cell(_) | Value::Opaque { .. } => return None,
    };
    Some(Record::of_struct(records, 0, None, 0))
}

/// Columns of numbers of the length of the first; variables of other kinds are left out.
fn columns(data: &[Value], names: &[String], units: Option<&[String]>) -> Vec<RecordColumn> {
    let mut columns: Vec<RecordColumn> = Vec::new();
    for (index, (value, name)) in data.iter().zip(names).enumerate() {
        let rows = columns.first().map(|column| column.values.len());
        let Some(samples) = samples_of(value, rows).filter(|samples| rows.is_none_or(|rows| rows == samples.rows))
        else {
            continue;
        };
        let unit = units.and_then(|units| units.get(index)).filter(|unit| !unit.is_empty());
        let is_one = samples.values.len() == 1;
        columns.extend(samples.values.into_iter().enumerate().map(|(part, values)| {
            let name = if is_one { name.clone() } else { format!("{name}_{}", part + 1) };
            RecordColumn { unit: unit.cloned(), ..RecordColumn::new(name, values) }
        }));
    }
    columns
}

/// When the rows of a timetable were taken.
enum RowTimes {
    /// At these times \[s\], of the clock or not.
    Stamps(Vec<f64>, Option<String>),
    /// One each so many seconds.
    Step(f64),
}

fn row_times(value: &Value) -> Option<RowTimes> {
    if let Some(millis) = millis_of(value) {
        return Some(RowTimes::Stamps(millis.iter().map(|ms| ms * MILLISECOND).collect(), None));
    }
    let record = inner(value)?;
    if let Some(clock) = record.get(&["data"]).and_then(|data| samples_of(data, None)) {
        let clock = clock.values.into_iter().next()?;
        let start = clock.iter().copied().find(|ms| ms.is_finite())?;
        // Taken off before the factor: a clock of milliseconds since 1970 has few digits left.
        let seconds = clock.iter().map(|ms| (ms - start) * MILLISECOND).collect();
        return Some(RowTimes::Stamps(seconds, Some("times are of the clock, counted from the first".to_owned())));
    }
    let number = |value: &Value| samples_of(value, None)?.values.first()?.first().copied();
    let by_rate = record.get(&["specifiedAsRate"]).and_then(number).is_some_and(|by_rate| by_rate != 0.0);
    let rate = || record.get(&["sampleRate"]).and_then(number).filter(|rate| *rate > 0.0).map(|rate| 1.0 / rate);
    let step = || record.get(&["stepSize"]).and_then(millis_of).and_then(|step| Some(step.first()? * MILLISECOND));
    let step_s = if by_rate { rate() } else { step().or_else(rate) };
    step_s.map(RowTimes::Step)
}

/// The milliseconds of a `duration`.
fn millis_of(value: &Value) -> Option<Vec<f64>> {
    samples_of(inner(value)?.get(&["millis"])?, None)?.values.into_iter().next()
}
