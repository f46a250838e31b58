//! Vectors and matrices of one length beside one another, as columns.

use std::collections::BTreeMap;

use crate::recognise::labels::{label_of, texts_of};
use crate::recognise::record::Record;
use crate::variables::{Array, Value};
use gdcm_core::records::{ColumnSide, RecordColumn};

use super::Columns;

/// Fewer samples than these beside a time are no record, and fewer than those without one.
const FEWEST_TIMED: usize = 20;
const FEWEST: usize = 50;
/// Names of matrices of inputs and of outputs, plain.
const INPUTS: [&str; 9] = ["u", "in", "inr", "input", "inputs", "udata", "inputdata", "controls", "uin"];
const OUTPUTS: [&str; 9] = ["y", "out", "outr", "output", "outputs", "ydata", "outputdata", "sensors", "yout"];
const INPUT_NAMES: [&str; 6] = ["inputname", "inputnames", "inname", "unames", "inputlabels", "controlnames"];
const OUTPUT_NAMES: [&str; 6] = ["outputname", "outputnames", "outname", "ynames", "outputlabels", "sensornames"];
const INPUT_UNITS: [&str; 4] = ["inputunit", "inputunits", "inunit", "uunits"];
const OUTPUT_UNITS: [&str; 4] = ["outputunit", "outputunits", "outunit", "yunits"];
/// Names of what names, and gives the units of, the columns of a matrix that stands alone.
const NAMES: [&str; 9] =
    ["names", "channels", "columns", "labels", "variables", "header", "columnnames", "channelnames", "colheaders"];
const UNITS: [&str; 3] = ["units", "columnunits", "channelunits"];
const TIMES: [&str; 6] = ["t", "time", "times", "tout", "timestamp", "timestamps"];

/// A name without case, marks and blanks.
fn plain(name: &str) -> String {
    name.chars().filter(|c| c.is_alphanumeric()).flat_map(char::to_lowercase).collect()
}

/// Samples under one name: how many, and in how many columns, the samples of a column behind one another.
pub(super) struct Samples {
    pub(super) rows: usize,
    pub(super) values: Vec<Vec<f64>>,
}

/// The real numbers of a value, a vector as one column; a row for each sample where there are `rows`, else the longer side.
pub(super) fn samples_of(value: &Value, rows: Option<usize>) -> Option<Samples> {
    let array = match value {
        Value::Array(array) => array,
        Value::Cell(cell) => return of_cells(&cell.values),
        Value::Text(_) | Value::Struct(_) | Value::Object(_) | Value::Opaque { .. } => return None,
    };
    let [first, second] = array.shape[..] else { return None };
    if array.im.as_ref().is_some_and(|im| im.iter().any(|part| *part != 0.0)) || array.is_empty() {
        return None;
    }
    let lies_down = match rows {
        Some(rows) => first != rows && second == rows,
        None => second > first,
    };
    let (rows, columns) = if lies_down { (second, first) } else { (first, second) };
    let column = |column: usize| -> Vec<f64> {
        if lies_down { strided(array, column, first) } else { array.re[column * rows..(column + 1) * rows].to_vec() }
    };
    Some(Samples { rows, values: (0..columns).map(column).collect() })
}

fn strided(array: &Array, from: usize, step: usize) -> Vec<f64> {
    array.re.iter().skip(from).step_by(step).copied().collect()
}

/// Single numbers in cells, as JSON with "null" among numbers is read.
fn of_cells(cells: &[Value]) -> Option<Samples> {
    let number = |value: &Value| match value {
        Value::Array(array) if array.len() <= 1 => Some(array.re.first().copied().unwrap_or(f64::NAN)),
        _ => None,
    };
    let values: Vec<f64> = cells.iter().map(number).collect::<Option<_>>()?;
    (!values.is_empty()).then(|| Samples { rows: values.len(), values: vec![values] })
}

/// The record that fields are, if they are one: arrays of one length, the time's or the most frequent one's.
pub(super) fn columns_of(record: &Record<'_>, variable: &str) -> Option<Columns> {
    let is_model = ["A", "B", "C"].iter().all(|letter| record.exact(letter).is_some());
    if is_model {
        return None;
    }
    let sample_time_s = sample_time(record);
    let (rows, is_timed) = length(record)?;
    if rows < if is_timed || sample_time_s.is_some() { FEWEST_TIMED } else { FEWEST } {
        return None;
    }
    let mut columns: Vec<RecordColumn> = Vec::new();
    let (mut matrices, mut vectors, mut labelled, mut left_out) = (0, 0, false, Vec::new());
    for (name, value) in record.fields() {
        let Some(samples) = samples_of(value, Some(rows)) else { continue };
        let name = name.trim_matches('_');
        if samples.rows != rows {
            if samples.rows > 1 {
                left_out.push(name);
            }
            continue;
        }
        let count = samples.values.len();
        if count == 1 {
            vectors += 1
        } else {
            matrices += 1
        }
        let labels = Labels::of(record, name, count);
        labelled |= labels.named;
        columns.extend(labels.columns(name, samples.values));
    }
    if columns.len() < 2 {
        return None;
    }
    let mut notes = Vec::new();
    if !left_out.is_empty() {
        notes.push(format!("of another length, left out: {}", left_out.join(", ")));
    }
    // One matrix without labels has a name, its columns have none.
    let named = labelled || vectors > 0 || matrices > 1;
    if !named {
        columns.iter_mut().enumerate().for_each(|(index, column)| column.name = format!("column {}", index + 1));
    }
    Some(Columns { variable: variable.to_owned(), columns, named, sample_time_s, notes })
}

/// The number of samples, and whether it is that of a time.
fn length(record: &Record<'_>) -> Option<(usize, bool)> {
    let vector = |value: &Value| samples_of(value, None).filter(|samples| samples.values.len() == 1);
    let time = record.fields().filter(|(name, _)| TIMES.contains(&plain(name).as_str()));
    let timed = time.filter_map(|(_, value)| vector(value)).map(|samples| samples.rows).max();
    if let Some(rows) = timed.filter(|rows| *rows >= FEWEST_TIMED) {
        return Some((rows, true));
    }
    let mut columns_by_length: BTreeMap<usize, usize> = BTreeMap::new();
    for samples in record.fields().filter_map(|(_, value)| samples_of(value, None)) {
        if samples.values.len() < samples.rows {
            *columns_by_length.entry(samples.rows).or_default() += samples.values.len();
        }
    }
    // Of two lengths with as many columns, the longer.
    let best = columns_by_length.into_iter().max_by_key(|(rows, columns)| (*columns, *rows));
    best.map(|(rows, _)| (rows, false))
}

fn sample_time(record: &Record<'_>) -> Option<f64> {
    let scalar = |names: &[&str]| match record.get(names) {
        Some(Value::Array(array)) => array.re.first().copied().filter(|value| array.len() == 1 && *value > 0.0),
        _ => None,
    };
    let step = scalar(&["Ts", "dt", "sample_time_s", "sample_time", "sampling_time", "tsam"]);
    let rate = || scalar(&["fs", "sample_rate", "sampling_rate", "sample_rate_hz", "fsamp"]);
    step.or_else(|| rate().map(|rate| 1.0 / rate)).filter(|step| step.is_finite())
}

/// Names, units and the side of the columns of one field.
struct Labels {
    names: Option<Vec<String>>,
    units: Option<Vec<String>>,
    side: Option<ColumnSide>,
    named: bool,
}

impl Labels {
    fn of(record: &Record<'_>, field: &str, count: usize) -> Self {
        let list = |keys: &[&str]| {
            let found = record.fields().find(|(name, _)| keys.contains(&plain(name).as_str()));
            found.and_then(|(_, value)| texts_of(value)).filter(|texts| texts.len() == count)
        };
        let name = plain(field);
        // One column called u is as likely a speed.
        let is_side = |names: &[&str]| names.contains(&name.as_str()) && (count > 1 || name.len() > 1);
        let own = [format!("{name}names"), format!("{name}labels"), format!("{name}channels")];
        let own: Vec<&str> = own.iter().map(String::as_str).collect();
        let own_units = [format!("{name}units")];
        let own_units: Vec<&str> = own_units.iter().map(String::as_str).collect();
        let (side, names, units) = if is_side(&INPUTS) {
            (Some(ColumnSide::Input), list(&INPUT_NAMES), list(&INPUT_UNITS))
        } else if is_side(&OUTPUTS) {
            (Some(ColumnSide::Output), list(&OUTPUT_NAMES), list(&OUTPUT_UNITS))
        } else if count > 1 {
            (None, list(&NAMES), list(&UNITS))
        } else {
            (None, None, None)
        };
        let names = list(&own).or(names).filter(|names| names.iter().all(|name| !name.is_empty()));
        Self { named: names.is_some(), names, units: list(&own_units).or(units), side }
    }

    fn columns(self, field: &str, values: Vec<Vec<f64>>) -> impl Iterator<Item = RecordColumn> {
        let Self { names, units, side, .. } = self;
        let is_one = values.len() == 1;
        let field = field.to_owned();
        values.into_iter().enumerate().map(move |(index, values)| {
            let label = names.as_ref().map(|names| label_of(&names[index])).unwrap_or_default();
            let numbered = || if is_one { field.clone() } else { format!("{field}_{}", index + 1) };
            let unit = units.as_ref().map(|units| units[index].clone()).filter(|unit| !unit.is_empty());
            let unit = unit.or(label.unit);
            RecordColumn { unit, side, ..RecordColumn::new(label.name.unwrap_or_else(numbered), values) }
        })
    }
}

/// What Simulink logs as a structure with time: `time`, and `signals` with `values` and `label` each.
pub(super) fn simulink_columns(record: &Record<'_>, variable: &str) -> Option<Columns> {
    let time = samples_of(record.get(&["time"])?, None)?;
    let Some(Value::Struct(signals)) = record.get(&["signals"]) else { return None };
    let mut columns = vec![RecordColumn::new("time", time.values.into_iter().next()?)];
    for index in 0..signals.shape.iter().product::<usize>() {
        let signal = Record::of_struct(signals, index, None, 0);
        let Some(samples) = signal.get(&["values"]).and_then(|values| samples_of(values, Some(time.rows))) else {
            continue;
        };
        if samples.rows != time.rows {
            continue;
        }
        let label = signal.get(&["label"]).and_then(texts_of).and_then(|texts| texts.into_iter().next());
        let label = label.filter(|label| !label.is_empty()).unwrap_or_else(|| format!("signal {}", index + 1));
        let label = label_of(&label);
        let (name, is_one) = (label.name.unwrap_or_default(), samples.values.len() == 1);
        columns.extend(samples.values.into_iter().enumerate().map(|(index, values)| {
            let name = if is_one { name.clone() } else { format!("{name}_{}", index + 1) };
            RecordColumn { unit: label.unit.clone(), ..RecordColumn::new(name, values) }
        }));
    }
    let found = columns.len() > 1 && time.rows >= FEWEST_TIMED;
    found.then(|| Columns {
        variable: variable.to_owned(),
        columns,
        named: true,
        sample_time_s: None,
        notes: Vec::new(),
    })
}
