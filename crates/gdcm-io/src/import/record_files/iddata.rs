//! Data objects from the identification tools in MATLAB and GNU Octave.
//!
//! An `iddata` object holds `OutputData` and `InputData` (a matrix, or a cell for each experiment),
//! `Ts` or `SamplingInstants`, and names and units; [`Record::get`] also finds the names with an
//! underscore at their end (`Ts_`), as saved MATLAB objects have them. Octave's control package
//! uses the names `y`, `u`, `tsam`, `outname` and `inname`. A struct with `OutputData` and
//! `InputData` is read like an object; one with `y` and `u` is not, because other files use these
//! letters for plain arrays (`array_columns.rs`).

use gdcm_model::dataset::channel::ChannelSide;
use gdcm_sysid::records::RecordColumn;

use super::samples::{first_number_of, named_columns, samples_of};
use crate::formats::recorded_columns::Columns;
use crate::formats::variables::Value;
use crate::import::recognise::recognition_fault::RecognitionFault;
use crate::import::recognise::record::Record;
use crate::import::recognise::values::{first_text_of, texts_of};

/// Field names for the inputs, or for the outputs, in MATLAB and in GNU Octave.
struct SideFields {
    side: ChannelSide,
    data: [&'static str; 2],
    names: [&'static str; 2],
    units: [&'static str; 2],
    /// Letter with which names for unnamed columns begin.
    letter: char,
}

const INPUT_FIELDS: SideFields = SideFields {
    side: ChannelSide::Input,
    data: ["InputData", "u"],
    names: ["InputName", "inname"],
    units: ["InputUnit", "inunit"],
    letter: 'u',
};
const OUTPUT_FIELDS: SideFields = SideFields {
    side: ChannelSide::Output,
    data: ["OutputData", "y"],
    names: ["OutputName", "outname"],
    units: ["OutputUnit", "outunit"],
    letter: 'y',
};

/// Returns whether the fields are identification data: an object from either program, or a struct
/// with MATLAB's names for outputs and inputs.
pub(super) fn is_iddata(record: &Record<'_>) -> bool {
    let has_both = record.get(&["OutputData"]).is_some() && record.get(&["InputData"]).is_some();
    record.class == Some("iddata") || has_both
}

/// Returns a record for each experiment, named after the variable and, if there are several, after
/// the experiment.
///
/// # Errors
/// The reason if the data are in the frequency domain, there are no outputs, or the inputs and
/// outputs in an experiment have different sample counts. The first faulty experiment ends the
/// reading.
pub(super) fn experiments(
    record: &Record<'_>,
    variable: &str,
) -> Result<Vec<Columns>, RecognitionFault> {
    if let Some(domain) = record.get(&["Domain"]).and_then(first_text_of)
        && domain.to_lowercase().starts_with('f')
    {
        return Err(RecognitionFault::FrequencyDomain);
    }
    let outputs = record
        .get(&OUTPUT_FIELDS.data)
        .ok_or(RecognitionFault::NoOutputData)?;
    let names = record
        .get(&["ExperimentName", "expname"])
        .and_then(texts_of)
        .unwrap_or_default();
    let outputs = experiment_values(outputs);
    let count = outputs.len();
    let mut records = Vec::with_capacity(count);
    for (index, output) in outputs.into_iter().enumerate() {
        let name = match names.get(index) {
            _ if count == 1 => variable.to_owned(),
            Some(name) if !name.is_empty() => format!("{variable}, {name}"),
            _ => format!("{variable}, experiment {}", index + 1),
        };
        records.push(experiment(record, output, index, name)?);
    }
    Ok(records)
}

/// Reads the experiment at `index`; `output` holds its outputs.
///
/// 1. The outputs' sample count decides which dimension of the other matrices is time. Outputs that
///    cannot be read: error.
/// 2. The sampling instants are the first column. Instants that do not fit the outputs are ignored.
/// 3. Input and output columns follow. Inputs that cannot be read are left out.
/// 4. Columns with another sample count: error.
/// 5. A positive `Ts` is the sample time.
fn experiment(
    record: &Record<'_>,
    output: &Value,
    index: usize,
    variable: String,
) -> Result<Columns, RecognitionFault> {
    // Step 1.
    let Some(samples) = samples_of(output, None) else {
        return Err(RecognitionFault::NoOutputData);
    };
    let sample_count = samples.rows;
    // Step 2.
    let mut columns = Vec::new();
    if let Some(instants) = value_for_experiment(record, &["SamplingInstants"], index)
        && let Some(stamps) = samples_of(instants, Some(sample_count))
        && stamps.rows == sample_count
        && stamps.columns.len() == 1
    {
        let unit = record.get(&["TimeUnit"]).and_then(first_text_of);
        for mut column in named_columns("time", stamps.columns) {
            column.unit.clone_from(&unit);
            columns.push(column);
        }
    }
    // Step 3.
    columns.extend(side_columns(record, &INPUT_FIELDS, index, sample_count));
    columns.extend(side_columns(record, &OUTPUT_FIELDS, index, sample_count));
    // Step 4.
    if columns
        .iter()
        .any(|column| column.values.len() != sample_count)
    {
        return Err(RecognitionFault::SampleCounts);
    }
    // Step 5.
    let step = value_for_experiment(record, &["Ts", "tsam"], index).and_then(first_number_of);
    Ok(Columns {
        sample_time_s: step.filter(|step| *step > 0.0),
        ..Columns::new(variable, columns)
    })
}

/// Returns the input or output columns in the experiment at `index`; none if they cannot be read.
/// Time runs along the dimension with length `sample_count`, otherwise along the longer one.
fn side_columns(
    record: &Record<'_>,
    fields: &SideFields,
    index: usize,
    sample_count: usize,
) -> Vec<RecordColumn> {
    let names = record
        .get(&fields.names)
        .and_then(texts_of)
        .unwrap_or_default();
    let units = record
        .get(&fields.units)
        .and_then(texts_of)
        .unwrap_or_default();
    let Some(samples) = value_for_experiment(record, &fields.data, index)
        .and_then(|value| samples_of(value, Some(sample_count)))
    else {
        return Vec::new();
    };
    let mut columns = Vec::with_capacity(samples.columns.len());
    for (at, values) in samples.columns.into_iter().enumerate() {
        let name = match nonempty_text(&names, at) {
            Some(name) => name,
            None => format!("{}{}", fields.letter, at + 1),
        };
        columns.push(RecordColumn {
            unit: nonempty_text(&units, at),
            side: Some(fields.side),
            ..RecordColumn::new(name, values)
        });
    }
    columns
}

fn nonempty_text(texts: &[String], at: usize) -> Option<String> {
    match texts.get(at) {
        Some(text) if !text.is_empty() => Some(text.clone()),
        _ => None,
    }
}

/// Returns each experiment's value: the cells in a cell array, or the value itself.
fn experiment_values(value: &Value) -> Vec<&Value> {
    match value {
        Value::Cell(cell) => cell.values.iter().collect(),
        other => vec![other],
    }
}

/// Returns the value for the experiment at `index`; a single value applies to all experiments.
fn value_for_experiment<'v>(
    record: &Record<'v>,
    names: &[&str],
    index: usize,
) -> Option<&'v Value> {
    match record.get(names)? {
        Value::Cell(cell) => cell.values.get(index),
        other => Some(other),
    }
}
