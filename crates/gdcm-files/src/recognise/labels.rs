//! Names, units and facts beside the numbers of a model.

use crate::variables::Value;
use gdcm_core::assembly::{ChannelLabel, Facts};
use gdcm_core::dataset::{GREATEST_CHANNEL_DELAY_S, Timing};
use gdcm_core::units::number;

use super::matrix::{array_of, list_of, scalar_of};
use super::record::Record;

const INPUT_NAMES: &[&str] =
    &["InputName", "inputs", "inname", "input_names", "input_labels", "InputLabels", "u_names", "unames", "input"];
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
const STATE_NAMES: &[&str] = &["StateName", "stname", "states", "state_names", "state_labels", "x_names", "xnames"];
const SAMPLE_TIME: &[&str] = &["Ts", "dt", "tsam", "sample_time_s", "sample_time", "Tsample"];

/// Texts in a value: an array of texts, a cell array of them.
pub(crate) fn texts_of(value: &Value) -> Option<Vec<String>> {
    let trimmed = |text: &String| text.trim().to_owned();
    match value {
        Value::Text(text) => Some(text.texts.iter().map(trimmed).collect()),
        Value::Cell(cell) => {
            cell.values.iter().map(|value| Some(texts_of(value)?.into_iter().next().unwrap_or_default())).collect()
        }
        Value::Array(array) if array.is_empty() => Some(Vec::new()),
        Value::Array(_) | Value::Struct(_) | Value::Object(_) | Value::Opaque { .. } => None,
    }
}

/// The inputs of a model of `count`.
pub(super) fn inputs_of(record: &Record<'_>, count: usize) -> Vec<ChannelLabel> {
    labels(record, INPUT_NAMES, INPUT_UNITS, count)
}

/// The outputs of a model of `count`.
pub(super) fn outputs_of(record: &Record<'_>, count: usize) -> Vec<ChannelLabel> {
    labels(record, OUTPUT_NAMES, OUTPUT_UNITS, count)
}

/// Names of the states, where there are as many as states.
pub(super) fn states_of(record: &Record<'_>, order: usize) -> Vec<String> {
    let names = record.get(STATE_NAMES).and_then(texts_of).unwrap_or_default();
    if names.len() == order && names.iter().all(|name| !name.is_empty()) { names } else { Vec::new() }
}

/// Labels of `count` channels; a list of another length is none.
fn labels(record: &Record<'_>, names: &[&str], units: &[&str], count: usize) -> Vec<ChannelLabel> {
    let list = |keys: &[&str]| record.get(keys).and_then(texts_of).filter(|list| list.len() == count);
    let (names, units) = (list(names), list(units));
    let label = |index: usize| {
        let label = names.as_ref().map(|names| label_of(&names[index])).unwrap_or_default();
        let unit = units.as_ref().map(|units| units[index].clone()).filter(|unit| !unit.is_empty());
        ChannelLabel { unit: unit.or(label.unit), ..label }
    };
    (0..count).map(label).collect()
}

/// A label as engineers write it: "P", "P [deg/s]", "P (deg/s)".
pub(crate) fn label_of(text: &str) -> ChannelLabel {
    let text = text.trim();
    for (open, close) in [('[', ']'), ('(', ')')] {
        if let Some((name, unit)) = text.strip_suffix(close).and_then(|text| text.split_once(open))
            && !name.trim().is_empty()
            && !unit.trim().is_empty()
        {
            return ChannelLabel { name: Some(name.trim().to_owned()), unit: Some(unit.trim().to_owned()) };
        }
    }
    ChannelLabel { name: Some(text.to_owned()).filter(|name| !name.is_empty()), unit: None }
}

/// Sample time and delays; those of MATLAB's discrete-time models are counted in samples.
pub(super) fn timing_of(record: &Record<'_>, (inputs, outputs): (usize, usize)) -> Result<Timing, String> {
    let sample_time_s = sample_time_of(record)?;
    refuse_other_delays(record)?;
    let delay_record = match record.get(&["Delay"]) {
        Some(Value::Struct(records)) => Some(Record::of_struct(records, 0, None, 0)),
        _ => None,
    };
    let of_delay = |names: &[&str]| delay_record.as_ref().and_then(|delays| delays.get(names));
    let in_samples = sample_time_s.filter(|_| record.get(&["input_delays_s", "output_delays_s"]).is_none());
    let delays = |name: &str, value: Option<&Value>, count: usize| -> Result<Option<Vec<f64>>, String> {
        let Some(value) = value else { return Ok(None) };
        let mut delays = list_of(name, value)?;
        if delays.len() == 1 {
            delays = vec![delays[0]; count];
        }
        if delays.is_empty() || delays.iter().all(|delay| *delay == 0.0) {
            return Ok(None);
        }
        delays.iter_mut().for_each(|delay| *delay *= in_samples.unwrap_or(1.0));
        match delays.iter().find(|delay| !(0.0..=GREATEST_CHANNEL_DELAY_S).contains(*delay)) {
            Some(delay) => {
                Err(format!("{name}: expected delays from 0 to {GREATEST_CHANNEL_DELAY_S} s, found {}", number(*delay)))
            }
            None if delays.len() != count => Err(format!("{name}: expected {count} delays, found {}", delays.len())),
            None => Ok(Some(delays)),
        }
    };
    let input = record.get(&["InputDelay", "input_delays_s"]).or_else(|| of_delay(&["Input"]));
    let output = record.get(&["OutputDelay", "output_delays_s"]).or_else(|| of_delay(&["Output"]));
    Ok(Timing {
        sample_time_s,
        input_delays_s: delays("input delays", input, inputs)?,
        output_delays_s: delays("output delays", output, outputs)?,
    })
}

fn sample_time_of(record: &Record<'_>) -> Result<Option<f64>, String> {
    let Some(value) = record.get(SAMPLE_TIME) else { return Ok(None) };
    match scalar_of(value) {
        Some(0.0) => Ok(None),
        Some(sample_time) if sample_time > 0.0 => Ok(Some(sample_time)),
        Some(sample_time) => Err(format!(
            "the sample time is {}: a discrete-time model whose sample time is not said cannot be compared; set Ts",
            number(sample_time)
        )),
        None if array_of(value).is_some_and(|array| array.is_empty()) => Ok(None),
        None => Err(format!("the sample time: expected a number, found {}", value.words())),
    }
}

/// Delays between single channels, and inside the model, are not what a gain and a delay of each channel can have.
fn refuse_other_delays(record: &Record<'_>) -> Result<(), String> {
    let delay = match record.get(&["Delay"]) {
        Some(Value::Struct(records)) => Record::of_struct(records, 0, None, 0),
        _ => Record::default(),
    };
    let found = [
        ("internal", record.get(&["InternalDelay"]).or_else(|| delay.get(&["Internal"]))),
        ("input-output", record.get(&["IODelay"]).or_else(|| delay.get(&["IO"]))),
    ];
    for (kind, value) in found {
        if value.and_then(array_of).is_some_and(|array| array.re.iter().any(|delay| *delay != 0.0)) {
            return Err(format!("{kind} delays cannot be taken; absorb them first: sys = pade(sys, 3)"));
        }
    }
    Ok(())
}

/// What stands beside a model about its flight condition.
pub(super) fn facts_of(record: &Record<'_>) -> Facts {
    let figure = |names: &[&str]| record.get(names).and_then(scalar_of);
    let condition = figure(&["condition", "condition_id", "fc"]).filter(|id| id.fract() == 0.0 && id.abs() < 1e9);
    Facts {
        condition: condition.map(|id| id as i64),
        airspeed_kt: figure(&["airspeed_kt", "V_kt", "airspeed_knots", "speed_kt", "KTAS"]),
        altitude_ft: figure(&["altitude_ft", "alt_ft", "h_ft"]),
        mass_kg: figure(&["mass_kg", "m_kg"]),
        records: Vec::new(),
    }
}
