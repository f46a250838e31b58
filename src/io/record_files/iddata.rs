//! Data of MATLAB's and Octave's identification tools.
//!
//! An `iddata` object has, under these names or with an underscore behind them, `OutputData` and `InputData` (a matrix, or a cell for
//! each experiment), `Ts` or `SamplingInstants`, and names and units; Octave's control package calls them `y`, `u`, `tsam`, `outname`,
//! `inname`. A struct with the same fields is taken too.

use crate::io::recognise::labels::texts_of;
use crate::io::recognise::record::Record;
use crate::io::variables::Value;
use crate::records::{ColumnSide, RecordColumn};

use super::Columns;
use super::record_columns::samples_of;

const OUTPUTS: &[&str] = &["OutputData", "y"];
const INPUTS: &[&str] = &["InputData", "u"];

/// Whether fields are those of identification data.
pub(super) fn is_iddata(record: &Record<'_>) -> bool {
    let both = record.get(&["OutputData"]).is_some() && record.get(&["InputData"]).is_some();
    record.class == Some("iddata") || both
}

/// A record for each experiment.
pub(super) fn experiments(record: &Record<'_>, variable: &str) -> Result<Vec<Columns>, String> {
    let domain = record.get(&["Domain"]).and_then(texts_of).and_then(|texts| texts.into_iter().next());
    if domain.is_some_and(|domain| domain.to_lowercase().starts_with('f')) {
        return Err("data over frequency are no record; save those over time".to_owned());
    }
    let outputs = record.get(OUTPUTS).ok_or("its output data cannot be read; save t, u and y as matrices")?;
    let inputs = record.get(INPUTS);
    let names = texts(record, &["ExperimentName", "expname"]).unwrap_or_default();
    let count = parts(outputs).len();
    let experiment = |index: usize| -> Result<Columns, String> {
        let output = parts(outputs)[index];
        let rows = samples_of(output, None).map(|samples| samples.rows);
        let sides = [
            (
                ColumnSide::Input,
                inputs.and_then(|inputs| parts(inputs).get(index).copied()),
                ["InputName", "inname"],
                ["InputUnit", "inunit"],
                "u",
            ),
            (ColumnSide::Output, Some(output), ["OutputName", "outname"], ["OutputUnit", "outunit"], "y"),
        ];
        let mut columns = Vec::new();
        for (side, value, names, units, letter) in sides {
            let Some(samples) = value.and_then(|value| samples_of(value, rows)) else { continue };
            let (names, units) = (texts(record, &names), texts(record, &units));
            let of =
                |list: &Option<Vec<String>>, at: usize| list.as_ref()?.get(at).filter(|text| !text.is_empty()).cloned();
            columns.extend(samples.values.into_iter().enumerate().map(|(at, values)| {
                let name = of(&names, at).unwrap_or_else(|| format!("{letter}{}", at + 1));
                RecordColumn { unit: of(&units, at), side: Some(side), ..RecordColumn::new(name, values) }
            }));
        }
        if columns.iter().any(|column| Some(column.values.len()) != rows) {
            return Err("its inputs and outputs have different numbers of samples".to_owned());
        }
        let instants = part_of(record, &["SamplingInstants"], index).and_then(|value| samples_of(value, rows));
        if let Some(stamps) = instants.filter(|stamps| Some(stamps.rows) == rows && stamps.values.len() == 1) {
            let values = stamps.values.into_iter().next().unwrap_or_default();
            let unit = texts(record, &["TimeUnit"]).and_then(|unit| unit.into_iter().next());
            columns.insert(0, RecordColumn { unit, ..RecordColumn::new("time", values) });
        }
        let step = part_of(record, &["Ts", "tsam"], index).and_then(|value| samples_of(value, None));
        let step = step.and_then(|samples| samples.values.first()?.first().copied()).filter(|step| *step > 0.0);
        let name = names.get(index).filter(|name| count > 1 && !name.is_empty());
        let variable = match (name, count) {
            (Some(name), _) => format!("{variable}, {name}"),
            (None, 1) => variable.to_owned(),
            (None, _) => format!("{variable}, experiment {}", index + 1),
        };
        Ok(Columns { variable, columns, named: true, sample_time_s: step, notes: Vec::new() })
    };
    (0..count).map(experiment).collect()
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
