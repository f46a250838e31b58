//! Simulink's structure with time: `time`, and `signals` with `values` and `label` each.

use gdcm_sysid::records::RecordColumn;

use super::array_columns::FEWEST_TIMED;
use super::samples::{named_columns, samples_of};
use crate::formats::recorded_columns::Columns;
use crate::formats::variables::Value;
use crate::import::recognise::labels::label_of;
use crate::import::recognise::record::Record;
use crate::import::recognise::values::first_text_of;

/// Reads the columns from a structure with time; `None` for any other record, and if it has no
/// signals or too few samples.
pub(super) fn simulink_columns(record: &Record<'_>, variable: &str) -> Option<Columns> {
    let time = samples_of(record.get(&["time"])?, None)?;
    let Some(Value::Struct(signals)) = record.get(&["signals"]) else {
        return None;
    };
    let rows = time.rows;
    let mut columns = vec![RecordColumn::new("time", time.columns.into_iter().next()?)];
    for index in 0..signals.shape.iter().product::<usize>() {
        let signal = Record::from_struct(signals, index);
        columns.extend(signal_columns(&signal, index, rows).unwrap_or_default());
    }
    if columns.len() < 2 || rows < FEWEST_TIMED {
        return None;
    }
    Some(Columns::new(variable.to_owned(), columns))
}

/// Returns a signal's columns; `None` if its sample count differs from the number of times.
fn signal_columns(signal: &Record<'_>, index: usize, rows: usize) -> Option<Vec<RecordColumn>> {
    let samples = samples_of(signal.get(&["values"])?, Some(rows))?;
    if samples.rows != rows {
        return None;
    }
    let label = match signal.get(&["label"]).and_then(first_text_of) {
        Some(label) if !label.is_empty() => label,
        _ => format!("signal {}", index + 1),
    };
    let label = label_of(&label);
    let mut columns = named_columns(&label.name.unwrap_or_default(), samples.columns);
    for column in &mut columns {
        column.unit.clone_from(&label.unit);
    }
    Some(columns)
}
