//! Models by their responses over frequencies.

use std::f64::consts::TAU;

use crate::variables::Array;
use gdcm_core::assembly::FoundModel;
use gdcm_core::dataset::{Estimate, ModelDraft, Origin, Provenance, ResponseArray, ResponseDraft, Timing};

use super::labels::{facts_of, inputs_of, outputs_of, texts_of};
use super::matrix::{array_of, list_of};
use super::record::Record;

const RESPONSES: &[&str] = &["ResponseData", "Response", "H", "G", "resp", "frf"];
const FREQUENCIES: &[&str] = &["Frequency", "omega", "omega_rad_s", "w", "freq", "frequencies"];
const HERTZ: &[&str] = &["f_hz", "freq_hz", "frequency_hz", "f"];
const UNITS: &[&str] = &["FrequencyUnit", "FreqUnits", "Units", "frequency_unit"];
const COHERENCES: &[&str] = &["coherence", "coh", "gamma2", "gamma_squared", "Cxy"];

/// Whether fields are those of a frequency response: complex numbers, or real and imaginary parts, beside frequencies.
pub(super) fn is_response(record: &Record<'_>) -> bool {
    let has_frequencies =
        record.get(FREQUENCIES).or_else(|| record.get(HERTZ)).and_then(array_of).is_some_and(|array| array.len() > 1);
    has_frequencies && (complex(record).is_some() || parts(record).is_some())
}

fn complex<'v>(record: &Record<'v>) -> Option<&'v Array> {
    record.get(RESPONSES).and_then(array_of).filter(|array| array.im.is_some())
}

fn parts<'v>(record: &Record<'v>) -> Option<(&'v Array, &'v Array)> {
    let part = |names: &[&str]| record.get(names).and_then(array_of);
    part(&["re", "real", "Hre"]).zip(part(&["im", "imag", "Him"]))
}

/// The measured response in `record`.
pub(super) fn response(record: &Record<'_>, variable: &str) -> Result<FoundModel, String> {
    let (omega, hertz) = omega_of(record)?;
    let count = omega.len();
    let (re, im, shape) = match (complex(record), parts(record)) {
        (Some(array), _) => (array.re.clone(), array.im.clone().unwrap_or_default(), &array.shape),
        (None, Some((re, im))) if re.shape == im.shape => (re.re.clone(), im.re.clone(), &re.shape),
        _ => return Err("real and imaginary parts are of different sizes".to_owned()),
    };
    let (outputs, inputs) = channels(shape, count)?;
    let table = |name: &str, values: &[f64]| -> Result<ResponseArray, String> {
        let values = in_order(values, (outputs, inputs, count));
        match values.iter().position(|value| !value.is_finite()) {
            Some(at) => Err(format!("{name}, frequency {}: expected a finite number", at % count + 1)),
            None => Ok(ResponseArray { shape: [outputs, inputs, count], values }),
        }
    };
    let coherence = record.get(COHERENCES).and_then(array_of).filter(|array| array.len() == re.len());
    let coherence = coherence.map(|array| table("coherence", &array.re)).transpose()?;
    let response = ResponseDraft {
        re: table("response", &re)?,
        im: table("response", &im)?,
        omega,
        coherence,
        valid_bands: None,
        estimate: Estimate::default(),
    };
    let variable = Some(variable.to_owned()).filter(|variable| !variable.is_empty());
    Ok(FoundModel {
        draft: ModelDraft {
            name: variable.clone().unwrap_or_default(),
            origin: Origin::Identified { method: None, order: None },
            matrices: [None, None, None, None],
            timing: Timing::default(),
            response: Some(response),
            source: Some(Provenance { variable, ..Provenance::default() }),
            states: Vec::new(),
            bands: None,
        },
        inputs: inputs_of(record, inputs),
        outputs: outputs_of(record, outputs),
        facts: facts_of(record),
        notes: hertz.then(|| "frequencies in Hz".to_owned()).into_iter().collect(),
    })
}

/// Frequencies \[rad/s\], and whether they stood in Hz.
fn omega_of(record: &Record<'_>) -> Result<(Vec<f64>, bool), String> {
    let unit = record
        .get(UNITS)
        .and_then(texts_of)
        .and_then(|texts| texts.into_iter().next())
        .unwrap_or_default()
        .to_lowercase();
    let (values, is_hertz) = match (record.get(FREQUENCIES), record.get(HERTZ)) {
        (Some(value), _) => (list_of("frequencies", value)?, unit == "hz" || unit == "hertz"),
        (None, Some(value)) => (list_of("frequencies", value)?, true),
        (None, None) => return Err("frequencies are missing".to_owned()),
    };
    let known = unit.is_empty() || is_hertz || unit.starts_with("rad");
    if !known {
        return Err(format!("frequencies are in \"{unit}\"; expected rad/s or Hz"));
    }
    let factor = if is_hertz { TAU } else { 1.0 };
    Ok((values.into_iter().map(|value| value * factor).collect(), is_hertz))
}

/// Outputs and inputs of an array whose last dimension runs over `count` frequencies; a single response may lie in a row or a column.
fn channels(shape: &[usize], count: usize) -> Result<(usize, usize), String> {
    match shape {
        [outputs, inputs, frequencies] if *frequencies == count => Ok((*outputs, *inputs)),
        [rows, columns] if rows * columns == count => Ok((1, 1)),
        _ => {
            let found = shape.iter().map(usize::to_string).collect::<Vec<_>>().join(" x ");
            Err(format!("the response: expected outputs x inputs x {count} frequencies, found {found}"))
        }
    }
}

/// From the first index running fastest to the last one running fastest.
fn in_order(values: &[f64], (outputs, inputs, count): (usize, usize, usize)) -> Vec<f64> {
    let mut ordered = Vec::with_capacity(values.len());
    for output in 0..outputs {
        for input in 0..inputs {
            ordered.extend((0..count).map(|k| values[output + outputs * (input + inputs * k)]));
        }
    }
    ordered
}
