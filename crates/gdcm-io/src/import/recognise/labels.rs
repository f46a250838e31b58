//! Channel and state names, and channel units, given beside a model.
//!
//! A [`Record`] is a group of fields that may form a model, such as a struct; it marks the fields
//! that are used.

use gdcm_model::assembly::ChannelLabel;
use gdcm_model::dataset::channel::ChannelSide;
use gdcm_model::names::signed_name::parse_direction;

use super::recognition_fault::RecognitionFault;
use super::record::Record;
use super::values::{first_text_of, texts_of};
use crate::formats::variables::{StructArray, Value};

const INPUT_NAMES: &[&str] = &[
    "InputName",
    "inputs",
    "inname",
    "input_names",
    "input_labels",
    "InputLabels",
    "u_names",
    "unames",
    "input",
];
const OUTPUT_NAMES: &[&str] = &[
    "OutputName",
    "outputs",
    "outname",
    "output_names",
    "output_labels",
    "OutputLabels",
    "y_names",
    "ynames",
    "output",
];
const INPUT_UNITS: &[&str] = &["InputUnit", "input_units", "InputUnits", "u_units"];
const OUTPUT_UNITS: &[&str] = &["OutputUnit", "output_units", "OutputUnits", "y_units"];
const STATE_NAMES: &[&str] = &[
    "StateName",
    "stname",
    "states",
    "state_names",
    "state_labels",
    "x_names",
    "xnames",
];
/// Fields in a channel object that may hold its name.
const LABEL_NAMES: &[&str] = &["name", "label", "id", "channel"];
const LABEL_UNITS: &[&str] = &["unit", "units"];

pub(super) fn inputs_of(
    record: &Record<'_>,
    count: usize,
) -> Result<Vec<ChannelLabel>, RecognitionFault> {
    labels(record, ChannelSide::Input, count)
}

pub(super) fn outputs_of(
    record: &Record<'_>,
    count: usize,
) -> Result<Vec<ChannelLabel>, RecognitionFault> {
    labels(record, ChannelSide::Output, count)
}

/// Returns the state names; empty unless all `order` states have names.
pub(super) fn states_of(record: &Record<'_>, order: usize) -> Vec<String> {
    let names = record
        .get(STATE_NAMES)
        .and_then(texts_of)
        .unwrap_or_default();
    if names.len() == order && names.iter().all(|name| !name.is_empty()) {
        names
    } else {
        Vec::new()
    }
}

/// Returns the labels for `count` inputs or outputs, from lists beside the model or, if they have
/// `count` entries, in an enclosing record.
///
/// # Errors
/// The reason if a list beside the model does not have `count` entries, or has no defined order:
/// labels are never assigned by guessing.
fn labels(
    record: &Record<'_>,
    side: ChannelSide,
    count: usize,
) -> Result<Vec<ChannelLabel>, RecognitionFault> {
    let names = list_of_labels(record, side.pick(INPUT_NAMES, OUTPUT_NAMES), side, count)?;
    let units = list_of_labels(record, side.pick(INPUT_UNITS, OUTPUT_UNITS), side, count)?;
    let names = names.unwrap_or_else(|| vec![String::new(); count]);
    let mut labels: Vec<ChannelLabel> = names.iter().map(|name| label_of(name)).collect();
    for (label, unit) in labels.iter_mut().zip(units.into_iter().flatten()) {
        if !unit.is_empty() {
            label.unit = Some(unit);
        }
    }
    Ok(labels)
}

/// Returns the names or units in the first field with one of these keys, from the record or
/// otherwise from its enclosing records; missing entries are empty strings. Fields with numbers,
/// with empty strings only, and in an enclosing record those with another count are passed over.
/// Returns `None` if there is no other field.
///
/// # Errors
/// As [`labels`].
fn list_of_labels(
    record: &Record<'_>,
    keys: &[&str],
    side: ChannelSide,
    count: usize,
) -> Result<Option<Vec<String>>, RecognitionFault> {
    for (level, record) in record.with_outer().enumerate() {
        let Some(field) = record.find(keys) else {
            continue;
        };
        let name = field.name;
        let Some(mut texts) = label_texts(name, field.value)? else {
            continue;
        };
        // A single string may list all channels: "LON, LAT, PED".
        if count > 1 && texts.len() == 1 && texts[0].split(',').count() == count {
            texts = texts[0]
                .split(',')
                .map(|text| text.trim().to_owned())
                .collect();
        }
        if texts.iter().all(String::is_empty) {
            record.mark_used(name);
        } else if texts.len() == count {
            record.mark_used(name);
            return Ok(Some(texts));
        } else if level == 0 {
            return Err(RecognitionFault::LabelCount {
                name: name.to_owned(),
                side,
                found: texts.len(),
                expected: count,
            });
        }
    }
    Ok(None)
}

/// Returns the labels in a list of strings, or of channel objects with a name and a unit as in a
/// dataset file; `None` for numbers, and for objects of a MATLAB class.
///
/// # Errors
/// The reason if the list mixes objects and other values, or an object has no name: a struct whose
/// field names are the channels has no order.
fn label_texts(field: &str, value: &Value) -> Result<Option<Vec<String>>, RecognitionFault> {
    if let Some(texts) = texts_of(value) {
        return Ok(Some(texts));
    }
    let labels = match value {
        Value::Struct(records) => {
            let count = records.shape.iter().product::<usize>();
            (0..count)
                .map(|index| channel_object_text(records, index))
                .collect::<Option<Vec<String>>>()
        }
        Value::Cell(cell)
            if cell
                .values
                .iter()
                .all(|value| matches!(value, Value::Array(_))) =>
        {
            return Ok(None);
        }
        Value::Cell(cell) => {
            let mut records = Vec::with_capacity(cell.values.len());
            for value in &cell.values {
                let Value::Struct(record) = value else {
                    return Err(RecognitionFault::Labels {
                        name: field.to_owned(),
                        found: value.words(),
                    });
                };
                records.push(record);
            }
            records
                .into_iter()
                .map(|record| channel_object_text(record, 0))
                .collect::<Option<Vec<String>>>()
        }
        Value::Array(_) | Value::Text(_) | Value::Object(_) | Value::Opaque { .. } => {
            return Ok(None);
        }
    };
    match labels {
        Some(labels) => Ok(Some(labels)),
        None => Err(RecognitionFault::LabelOrder {
            name: field.to_owned(),
        }),
    }
}

/// Returns a channel object's name, followed by its unit in brackets unless the name contains one:
/// "P [deg/s]"; `None` without a name.
fn channel_object_text(records: &StructArray, index: usize) -> Option<String> {
    let record = Record::from_struct(records, index);
    let name = record.get(LABEL_NAMES).and_then(first_text_of)?;
    let unit = record
        .get(LABEL_UNITS)
        .and_then(first_text_of)
        .unwrap_or_default();
    if unit.is_empty() || label_of(&name).unit.is_some() {
        Some(name)
    } else {
        Some(format!("{name} [{unit}]"))
    }
}

/// Parses a label such as "P", "P [deg/s]" or "P (deg/s)". Brackets with a direction, such as
/// "(positive up)", belong to the name.
pub(in crate::import) fn label_of(text: &str) -> ChannelLabel {
    let text = text.trim();
    for (open, close) in [('[', ']'), ('(', ')')] {
        if let Some((name, unit)) = text
            .strip_suffix(close)
            .and_then(|text| text.split_once(open))
            && !name.trim().is_empty()
            && !unit.trim().is_empty()
            && parse_direction(unit).is_none()
        {
            return ChannelLabel {
                name: Some(name.trim().to_owned()),
                unit: Some(unit.trim().to_owned()),
            };
        }
    }
    ChannelLabel {
        name: Some(text.to_owned()).filter(|name| !name.is_empty()),
        unit: None,
    }
}
