//! Data of MATLAB's and Octave's identification tools.
//!
//! An `iddata` object has, under these names or with an underscore behind them, `OutputData` and `InputData` (a matrix, or a cell for
//! each experiment), `Ts` or `SamplingInstants`, and names and units; Octave's control package calls them `y`, `u`, `tsam`, `outname`,
//! `inname`. A struct with the same fields is taken too.

use crate::recognise::labels::texts_of;
use crate::recognise::record::Record;
use crate::variables::Value;
use gdcm_core::records::{ColumnSide, RecordColumn};

use super::Columns;
use super::record_columns::samples_of;

/// What one side is called in both.
struct Side {
    side: ColumnSide,
    data: [&'static str; 2],
    names: [&'static str; 2],
    units: [&'static str; 2],
    /// What its columns are called where they have no names.
    letter: char,
}

const INPUTS: Side = Side {
    side: ColumnSide::Input,
    data: ["InputData", "u"],
    names: ["InputName", "inname"],
    units: ["InputUnit", "inunit"],
    letter: 'u',
};
const OUTPUTS: Side = Side {
    side: ColumnSide::Output,
    data: ["OutputData", "y"],
    names: ["OutputName", "outname"],
    units: ["OutputUnit", "outunit"],
    letter: 'y',
};

/// Whether fields are those of identification data.
pub(super) fn is_iddata(record: &Record<'_>) -> bool {
    let both = record.get(&["OutputData"]).is_some() && record.get(&["InputData"]).is_some();
    record.class == Some("iddata") || both
}

/// A record for each experiment.
pub(super) fn experiments(record: &Record<'_>, variable: &str) -> Result<Vec<Columns>, String> {
    let domain = texts(record, &["Domain"]).and_then(|texts| texts.into_iter().next());
    if domain.is_some_and(|domain| domain.to_lowercase().starts_with('f')) {
        return Err("data over frequency are no record; save those over time".to_owned());
    }
    let outputs = record.get(&OUTPUTS.data).ok_or("its output data cannot be read; save t, u and y as matrices")?;
    let names = texts(record, &["ExperimentName", "expname"]).unwrap_or_default();
    let count = parts(outputs).len();
    let named = |index: usize| match names.get(index).filter(|name| !name.is_empty()) {
        _ if count == 1 => variable.to_owned(),
        Some(name) => format!("{variable}, {name}"),
        None => format!("{variable}, experiment {}", index + 1),
    };
    (0..count).map(|index| experiment(record, parts(outputs)[index], index, named(index))).collect()
}

fn experiment(record: &Record<'_>, output: &Value, index: usize, variable: String) -> Result<Columns, String> {
    let rows = samples_of(output, None).map(|samples| samples.rows);
    let mut columns = Vec::new();
    let instants = part_of(record, &["SamplingInstants"], index).and_then(|value| samples_of(value, rows));
    if let Some(stamps) = instants.filter(|stamps| Some(stamps.rows) == rows && stamps.values.len() == 1) {
        let unit = texts(record, &["TimeUnit"]).and_then(|unit| unit.into_iter().next());
        columns.extend(
            stamps
                .values
                .into_iter()
                .map(|values| RecordColumn { unit: unit.clone(), ..RecordColumn::new("time", values) }),
        );
    }
    for side in [&INPUTS, &OUTPUTS] {
        columns.extend(side_columns(record, side, index, rows));
    }
    if columns.iter().any(|column| Some(column.values.len()) != rows) {
        return Err("its inputs and outputs have different numbers of samples".to_owned());
    }
    let step = part_of(record, &["Ts", "tsam"], index).and_then(|value| samples_of(value, None));
    let sample_time_s = step.and_then(|samples| samples.values.first()?.first().copied()).filter(|step| *step > 0.0);
    Ok(Columns { variable, columns, named: true, sample_time_s, notes: Vec::new() })
}

fn side_columns(record: &Record<'_>, side: &Side, index: usize, rows: Option<usize>) -> Vec<RecordColumn> {
    let samples = part_of(record, &side.data, index).and_then(|value| samples_of(value, rows));
    let (names, units) = (texts(record, &side.names), texts(record, &side.units));
    let of = |list: &Option<Vec<String>>, at: usize| list.as_ref()?.get(at).filter(|text| !text.is_empty()).cloned();
    let columns = samples.into_iter().flat_map(|samples| samples.values).enumerate();
    let column = |(at, values)| {
        let name = of(&names, at).unwrap_or_else(|| format!("{}{}", side.letter, at + 1));
        RecordColumn { unit: of(&units, at), side: Some(side.side), ..RecordColumn::new(name, values) }
    };
    columns.map(column).collect()
}

fn texts(record: &Record<'_>, names: &[&str]) -> Option<Vec<String>> {
    record.get(names).and_then(texts_of)
}

/// The values of the experiments: those of a cell, or the only one.
fn parts(value: &Value) -> Vec<&Value> {
    match value {
        Value::Cell(cell) => cell.values.iter().collect(),
        other => vec![other],
    }
}

fn part_of<'v>(record: &Record<'v>, names: &[&str], index: usize) -> Option<&'v Value> {
    let value = record.get(names)?;
    match value {
        Value::Cell(cell) => cell.values.get(index),
        other => Some(other),
    }
}
