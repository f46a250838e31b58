//! Columns from vectors and matrices of equal length.

use std::collections::BTreeMap;

use gdcm_model::dataset::channel::ChannelSide;
use gdcm_model::names::channel_alias::folded_name;
use gdcm_model::names::time_name::{SAMPLE_TIME_NAMES, time_name_rank};
use gdcm_sysid::records::RecordColumn;

use crate::formats::recorded_columns::Columns;
use crate::formats::variables::{Array, StructArray, Value};
use crate::import::recognise::record::{Record, label_of, texts_of};

/// Smallest number of samples of a record with a time, and (`FEWEST`) without a time.
const FEWEST_TIMED: usize = 20;
const FEWEST: usize = 50;
/// Plain names of input and output matrices.
const INPUTS: [&str; 9] = [
    "u",
    "in",
    "inr",
    "input",
    "inputs",
    "udata",
    "inputdata",
    "controls",
    "uin",
];
const OUTPUTS: [&str; 9] = [
    "y",
    "out",
    "outr",
    "output",
    "outputs",
    "ydata",
    "outputdata",
    "sensors",
    "yout",
];
const INPUT_NAMES: [&str; 6] = [
    "inputname",
    "inputnames",
    "inname",
    "unames",
    "inputlabels",
    "controlnames",
];
const OUTPUT_NAMES: [&str; 6] = [
    "outputname",
    "outputnames",
    "outname",
    "ynames",
    "outputlabels",
    "sensornames",
];
const INPUT_UNITS: [&str; 4] = ["inputunit", "inputunits", "inunit", "uunits"];
const OUTPUT_UNITS: [&str; 4] = ["outputunit", "outputunits", "outunit", "yunits"];
/// Names of fields with the column names, and (`UNITS`) the column units, of a single matrix.
const NAMES: [&str; 10] = [
    "names",
    "channels",
    "columns",
    "labels",
    "variables",
    "header",
    "columnnames",
    "channelnames",
    "colheaders",
    "varlab",
];
const UNITS: [&str; 3] = ["units", "columnunits", "channelunits"];

/// Samples of one field: the number of rows, and the values of each column.
pub(super) struct Samples {
    pub(super) rows: usize,
    pub(super) values: Vec<Vec<f64>>,
}

/// Returns the real numbers of a value, a vector as one column; a row for each sample if `rows` is
/// given, otherwise along the longer side.
pub(super) fn samples_of(value: &Value, rows: Option<usize>) -> Option<Samples> {
    let array = match value {
        Value::Array(array) => array,
        Value::Cell(cell) => return of_cells(&cell.values),
        Value::Text(_) | Value::Struct(_) | Value::Object(_) | Value::Opaque { .. } => return None,
    };
    let [first, second] = array.shape[..] else {
        return None;
    };
    if array
        .im
        .as_ref()
        .is_some_and(|im| im.iter().any(|part| *part != 0.0))
        || array.is_empty()
    {
        return None;
    }
    let lies_down = match rows {
        Some(rows) => first != rows && second == rows,
        None => second > first,
    };
    let (rows, columns) = if lies_down {
        (second, first)
    } else {
        (first, second)
    };
    let column = |column: usize| -> Vec<f64> {
        if lies_down {
            strided(array, column, first)
        } else {
            array.re[column * rows..(column + 1) * rows].to_vec()
        }
    };
    Some(Samples {
        rows,
        values: (0..columns).map(column).collect(),
    })
}

fn strided(array: &Array, from: usize, step: usize) -> Vec<f64> {
    array.re.iter().skip(from).step_by(step).copied().collect()
}

/// Reads single numbers in cells, the form of JSON lists with "null" among numbers.
fn of_cells(cells: &[Value]) -> Option<Samples> {
    let number = |value: &Value| match value {
        Value::Array(array) if array.len() <= 1 => {
            Some(array.re.first().copied().unwrap_or(f64::NAN))
        }
        _ => None,
    };
    let values: Vec<f64> = cells.iter().map(number).collect::<Option<_>>()?;
    (!values.is_empty()).then(|| Samples {
        rows: values.len(),
        values: vec![values],
    })
}

/// Returns the record in the fields, if there is one: arrays of one length, which is that of the
/// time or the most frequent length.
pub(super) fn columns_of(record: &Record<'_>, variable: &str) -> Option<Columns> {
    let is_model = ["A", "B", "C"]
        .iter()
        .all(|letter| record.exact(letter).is_some());
    if is_model {
        return None;
    }
    let sample_time_s = sample_time(record);
    let (rows, is_timed) = length(record)?;
    if rows
        < if is_timed || sample_time_s.is_some() {
            FEWEST_TIMED
        } else {
            FEWEST
        }
    {
        return None;
    }
    let mut columns: Vec<RecordColumn> = Vec::new();
    let mut matrices = 0;
    let mut vectors = 0;
    let mut labelled = false;
    let mut left_out = Vec::new();
    for (name, value) in record.fields() {
        let Some(samples) = samples_of(value, Some(rows)) else {
            continue;
        };
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
        notes.push(format!(
            "of another length, left out: {}",
            left_out.join(", ")
        ));
    }
    // A single matrix without labels is named, but its columns are not.
    let named = labelled || vectors > 0 || matrices > 1;
    if !named {
        columns
            .iter_mut()
            .enumerate()
            .for_each(|(index, column)| column.name = format!("column {}", index + 1));
    }
    Some(Columns {
        named,
        sample_time_s,
        notes,
        ..Columns::new(variable.to_owned(), columns)
    })
}

/// Returns the number of samples, and whether it is the length of a time vector.
fn length(record: &Record<'_>) -> Option<(usize, bool)> {
    let vector =
        |value: &Value| samples_of(value, None).filter(|samples| samples.values.len() == 1);
    let time = record
        .fields()
        .filter(|(name, _)| time_name_rank(name).is_some_and(|rank| rank < 2));
    let timed = time
        .filter_map(|(_, value)| vector(value))
        .map(|samples| samples.rows)
        .max();
    if let Some(rows) = timed.filter(|rows| *rows >= FEWEST_TIMED) {
        return Some((rows, true));
    }
    let mut columns_by_length: BTreeMap<usize, usize> = BTreeMap::new();
    for samples in record
        .fields()
        .filter_map(|(_, value)| samples_of(value, None))
    {
        if samples.values.len() < samples.rows {
            *columns_by_length.entry(samples.rows).or_default() += samples.values.len();
        }
    }
    // The longer of two lengths with as many columns.
    let best = columns_by_length
        .into_iter()
        .max_by_key(|(rows, columns)| (*columns, *rows));
    best.map(|(rows, _)| (rows, false))
}

fn sample_time(record: &Record<'_>) -> Option<f64> {
    let scalar = |names: &[&str]| match record.get(names) {
        Some(Value::Array(array)) => array
            .re
            .first()
            .copied()
            .filter(|value| array.len() == 1 && *value > 0.0),
        _ => None,
    };
    let step = scalar(&SAMPLE_TIME_NAMES);
    let rate = || {
        scalar(&[
            "fs",
            "sample_rate",
            "sampling_rate",
            "sample_rate_hz",
            "fsamp",
        ])
    };
    step.or_else(|| rate().map(|rate| 1.0 / rate))
        .filter(|step| step.is_finite())
}

/// Returns columns of one name, numbered if there are several.
fn side_by_side(name: &str, values: Vec<Vec<f64>>) -> impl Iterator<Item = RecordColumn> + use<> {
    let name = name.to_owned();
    let is_one = values.len() == 1;
    values.into_iter().enumerate().map(move |(index, values)| {
        let name = if is_one {
            name.clone()
        } else {
            format!("{name}_{}", index + 1)
        };
        RecordColumn::new(name, values)
    })
}

/// Names, units and side of the columns of one field.
struct Labels {
    names: Option<Vec<String>>,
    units: Option<Vec<String>>,
    side: Option<ChannelSide>,
    named: bool,
}

impl Labels {
    fn of(record: &Record<'_>, field: &str, count: usize) -> Self {
        let list = |keys: &[&str]| {
            let found = record
                .fields()
                .find(|(name, _)| keys.contains(&folded_name(name).as_str()));
            found
                .and_then(|(_, value)| texts_of(value))
                .filter(|texts| texts.len() == count)
        };
        let name = folded_name(field);
        // A single column called u may be a speed.
        let is_side =
            |names: &[&str]| names.contains(&name.as_str()) && (count > 1 || name.len() > 1);
        let own = [
            format!("{name}names"),
            format!("{name}labels"),
            format!("{name}channels"),
        ];
        let own: Vec<&str> = own.iter().map(String::as_str).collect();
        let own_units = [format!("{name}units")];
        let own_units: Vec<&str> = own_units.iter().map(String::as_str).collect();
        let (side, names, units) = if is_side(&INPUTS) {
            (
                Some(ChannelSide::Input),
                list(&INPUT_NAMES),
                list(&INPUT_UNITS),
            )
        } else if is_side(&OUTPUTS) {
            (
                Some(ChannelSide::Output),
                list(&OUTPUT_NAMES),
                list(&OUTPUT_UNITS),
            )
        } else if count > 1 {
            (None, list(&NAMES), list(&UNITS))
        } else {
            (None, None, None)
        };
        let names = list(&own)
            .or(names)
            .filter(|names| names.iter().all(|name| !name.is_empty()));
        Self {
            named: names.is_some(),
            names,
            units: list(&own_units).or(units),
            side,
        }
    }

    fn columns(self, field: &str, values: Vec<Vec<f64>>) -> impl Iterator<Item = RecordColumn> {
        let Self {
            names, units, side, ..
        } = self;
        side_by_side(field, values)
            .enumerate()
            .map(move |(index, column)| {
                let label = names
                    .as_ref()
                    .map(|names| label_of(&names[index]))
                    .unwrap_or_default();
                let unit = units
                    .as_ref()
                    .map(|units| units[index].clone())
                    .filter(|unit| !unit.is_empty());
                RecordColumn {
                    name: label.name.unwrap_or(column.name),
                    unit: unit.or(label.unit),
                    side,
                    ..column
                }
            })
    }
}

/// Reads Simulink's structure with time: `time`, and `signals` with `values` and `label` each.
pub(super) fn simulink_columns(record: &Record<'_>, variable: &str) -> Option<Columns> {
    let time = samples_of(record.get(&["time"])?, None)?;
    let Some(Value::Struct(signals)) = record.get(&["signals"]) else {
        return None;
    };
    let mut columns = vec![RecordColumn::new("time", time.values.into_iter().next()?)];
    for index in 0..signals.shape.iter().product::<usize>() {
        let signal = Record::of_struct(signals, index, None, 0);
        let Some(samples) = signal
            .get(&["values"])
            .and_then(|values| samples_of(values, Some(time.rows)))
        else {
            continue;
        };
        if samples.rows != time.rows {
            continue;
        }
        let label = signal
            .get(&["label"])
            .and_then(texts_of)
            .and_then(|texts| texts.into_iter().next());
        let label = label
            .filter(|label| !label.is_empty())
            .unwrap_or_else(|| format!("signal {}", index + 1));
        let label = label_of(&label);
        let of_signal = side_by_side(&label.name.unwrap_or_default(), samples.values);
        columns.extend(of_signal.map(|column| RecordColumn {
            unit: label.unit.clone(),
            ..column
        }));
    }
    let found = columns.len() > 1 && time.rows >= FEWEST_TIMED;
    found.then(|| Columns::new(variable.to_owned(), columns))
}

// Data of MATLAB's and Octave's identification tools.
//
// An `iddata` object has, under these names or with a trailing underscore, `OutputData` and
// `InputData` (a matrix, or a cell for each experiment), `Ts` or `SamplingInstants`, and names and
// units; Octave's control package calls them `y`, `u`, `tsam`, `outname`, `inname`. A struct with
// the same fields is also accepted.

/// Field names of one side in both tools.
struct Side {
    side: ChannelSide,
    data: [&'static str; 2],
    names: [&'static str; 2],
    units: [&'static str; 2],
    /// Letter for the names of unnamed columns.
    letter: char,
}

const IDDATA_INPUTS: Side = Side {
    side: ChannelSide::Input,
    data: ["InputData", "u"],
    names: ["InputName", "inname"],
    units: ["InputUnit", "inunit"],
    letter: 'u',
};
const IDDATA_OUTPUTS: Side = Side {
    side: ChannelSide::Output,
    data: ["OutputData", "y"],
    names: ["OutputName", "outname"],
    units: ["OutputUnit", "outunit"],
    letter: 'y',
};

/// Whether fields are identification data.
pub(super) fn is_iddata(record: &Record<'_>) -> bool {
    let both = record.get(&["OutputData"]).is_some() && record.get(&["InputData"]).is_some();
    record.class == Some("iddata") || both
}

/// Returns a record for each experiment.
pub(super) fn experiments(record: &Record<'_>, variable: &str) -> Result<Vec<Columns>, String> {
    let domain = texts(record, &["Domain"]).and_then(|texts| texts.into_iter().next());
    if domain.is_some_and(|domain| domain.to_lowercase().starts_with('f')) {
        return Err("data over frequency are no record; save those over time".to_owned());
    }
    let outputs = record
        .get(&IDDATA_OUTPUTS.data)
        .ok_or("its output data cannot be read; save t, u and y as matrices")?;
    let names = texts(record, &["ExperimentName", "expname"]).unwrap_or_default();
    let count = parts(outputs).len();
    let named = |index: usize| match names.get(index).filter(|name| !name.is_empty()) {
        _ if count == 1 => variable.to_owned(),
        Some(name) => format!("{variable}, {name}"),
        None => format!("{variable}, experiment {}", index + 1),
    };
    (0..count)
        .map(|index| experiment(record, parts(outputs)[index], index, named(index)))
        .collect()
}

fn experiment(
    record: &Record<'_>,
    output: &Value,
    index: usize,
    variable: String,
) -> Result<Columns, String> {
    let rows = samples_of(output, None).map(|samples| samples.rows);
    let mut columns = Vec::new();
    let instants =
        part_of(record, &["SamplingInstants"], index).and_then(|value| samples_of(value, rows));
    if let Some(stamps) =
        instants.filter(|stamps| Some(stamps.rows) == rows && stamps.values.len() == 1)
    {
        let unit = texts(record, &["TimeUnit"]).and_then(|unit| unit.into_iter().next());
        columns.extend(
            side_by_side("time", stamps.values).map(|column| RecordColumn {
                unit: unit.clone(),
                ..column
            }),
        );
    }
    for side in [&IDDATA_INPUTS, &IDDATA_OUTPUTS] {
        columns.extend(side_columns(record, side, index, rows));
    }
    if columns
        .iter()
        .any(|column| Some(column.values.len()) != rows)
    {
        return Err("its inputs and outputs have different numbers of samples".to_owned());
    }
    let step = part_of(record, &["Ts", "tsam"], index).and_then(|value| samples_of(value, None));
    let sample_time_s = step
        .and_then(|samples| samples.values.first()?.first().copied())
        .filter(|step| *step > 0.0);
    Ok(Columns {
        sample_time_s,
        ..Columns::new(variable, columns)
    })
}

fn side_columns(
    record: &Record<'_>,
    side: &Side,
    index: usize,
    rows: Option<usize>,
) -> Vec<RecordColumn> {
    let samples = part_of(record, &side.data, index).and_then(|value| samples_of(value, rows));
    let names = texts(record, &side.names);
    let units = texts(record, &side.units);
    let of = |list: &Option<Vec<String>>, at: usize| {
        list.as_ref()?
            .get(at)
            .filter(|text| !text.is_empty())
            .cloned()
    };
    let columns = samples
        .into_iter()
        .flat_map(|samples| samples.values)
        .enumerate();
    let column = |(at, values)| {
        let name = of(&names, at).unwrap_or_else(|| format!("{}{}", side.letter, at + 1));
        RecordColumn {
            unit: of(&units, at),
            side: Some(side.side),
            ..RecordColumn::new(name, values)
        }
    };
    columns.map(column).collect()
}

fn texts(record: &Record<'_>, names: &[&str]) -> Option<Vec<String>> {
    record.get(names).and_then(texts_of)
}

/// Returns the values of the experiments: those of a cell, or a single value.
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

// MATLAB's timetables and tables.
//
// A timetable is saved as a struct `any` with `data` (a cell for each variable), `varNames`,
// `varUnits` and `rowTimes`: a `duration` (`millis`), a `datetime` (`data`, ms since 1970), or
// `origin` with `stepSize` or `sampleRate`. A table has `data`, `varnames` and
// `props.VariableUnits`. Source: files of MATLAB R2017a to R2024a as the mat-io project describes
// them.

const MILLISECOND: f64 = 1e-3;

/// Reads the columns of a timetable or a table, if the object is one.
pub(super) fn timetable_columns(record: &Record<'_>, variable: &str) -> Option<Columns> {
    match record.class? {
        "timetable" => {
            let inner = inner(record.get(&["any"])?)?;
            let names = texts_of(inner.get(&["varNames"])?)?;
            let units = inner.get(&["varUnits"]).and_then(texts_of);
            let Value::Cell(data) = inner.get(&["data"])? else {
                return None;
            };
            let mut columns = columns(&data.values, &names, units.as_deref());
            let rows = columns.first()?.values.len();
            let mut sample_time_s = None;
            let mut notes = Vec::new();
            match row_times(inner.get(&["rowTimes"])?)? {
                RowTimes::Step(step_s) => sample_time_s = Some(step_s),
                RowTimes::Stamps(values, note) => {
                    notes.extend(note);
                    if values.len() == rows {
                        let time = RecordColumn {
                            unit: Some("s".to_owned()),
                            ..RecordColumn::new("Time", values)
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
        "table" => {
            let names = texts_of(record.get(&["varnames"])?)?;
            let units = record
                .get(&["props"])
                .and_then(inner)
                .and_then(|props| texts_of(props.get(&["VariableUnits"])?));
            let Value::Cell(data) = record.get(&["data"])? else {
                return None;
            };
            let columns = columns(&data.values, &names, units.as_deref());
            let found = !columns.is_empty();
            let variable = variable.to_owned();
            found.then(|| Columns::new(variable, columns))
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

/// Returns the numeric columns with the length of the first; omits variables of other kinds.
fn columns(data: &[Value], names: &[String], units: Option<&[String]>) -> Vec<RecordColumn> {
    let mut columns: Vec<RecordColumn> = Vec::new();
    for (index, (value, name)) in data.iter().zip(names).enumerate() {
        let rows = columns.first().map(|column| column.values.len());
        let Some(samples) =
            samples_of(value, rows).filter(|samples| rows.is_none_or(|rows| rows == samples.rows))
        else {
            continue;
        };
        let unit = units
            .and_then(|units| units.get(index))
            .filter(|unit| !unit.is_empty());
        let parts = side_by_side(name, samples.values);
        columns.extend(parts.map(|column| RecordColumn {
            unit: unit.cloned(),
            ..column
        }));
    }
    columns
}

/// Sample times of the rows of a timetable.
enum RowTimes {
    /// Time stamps \[s\], with the note for clock times.
    Stamps(Vec<f64>, Option<String>),
    /// Constant sample time \[s\].
    Step(f64),
}

fn row_times(value: &Value) -> Option<RowTimes> {
    if let Some(millis) = millis_of(value) {
        return Some(RowTimes::Stamps(
            millis.iter().map(|ms| ms * MILLISECOND).collect(),
            None,
        ));
    }
    let record = inner(value)?;
    if let Some(clock) = record
        .get(&["data"])
        .and_then(|data| samples_of(data, None))
    {
        let clock = clock.values.into_iter().next()?;
        let start = clock.iter().copied().find(|ms| ms.is_finite())?;
        // Subtracted before scaling: milliseconds since 1970 leave few digits.
        let seconds = clock.iter().map(|ms| (ms - start) * MILLISECOND).collect();
        return Some(RowTimes::Stamps(
            seconds,
            Some("times are of the clock, counted from the first".to_owned()),
        ));
    }
    let number = |value: &Value| samples_of(value, None)?.values.first()?.first().copied();
    let by_rate = record
        .get(&["specifiedAsRate"])
        .and_then(number)
        .is_some_and(|by_rate| by_rate != 0.0);
    let rate = || {
        record
            .get(&["sampleRate"])
            .and_then(number)
            .filter(|rate| *rate > 0.0)
            .map(|rate| 1.0 / rate)
    };
    let step = || {
        record
            .get(&["stepSize"])
            .and_then(millis_of)
            .and_then(|step| Some(step.first()? * MILLISECOND))
    };
    let step_s = if by_rate {
        rate()
    } else {
        step().or_else(rate)
    };
    step_s.map(RowTimes::Step)
}

/// Returns the milliseconds of a `duration`.
fn millis_of(value: &Value) -> Option<Vec<f64>> {
    samples_of(inner(value)?.get(&["millis"])?, None)?
        .values
        .into_iter()
        .next()
}
