//! Frequency responses out of tables of columns.

use crate::recognise::Recognised;
use crate::text::{FrequencyColumns, RecognisedResponse, ResponsePoints, TextTable, says_quantity};
use crate::variables::VariableFault;
use gdcm_core::assembly::{ChannelLabel, Facts, FoundModel};
use gdcm_core::dataset::{Estimate, ModelDraft, Origin, Provenance, ResponseArray, ResponseDraft, Timing};

/// The responses of a table, each a model of one input and one output; a table that holds none is passed over in words.
pub(super) fn models_of(table: &TextTable, file: &str) -> Result<Recognised, VariableFault> {
    let columns = match FrequencyColumns::recognise(table) {
        Ok(columns) => columns,
        Err(fault) => {
            let words = format!("{file}: {} columns of numbers; {fault}", table.columns.len());
            return Ok(Recognised { passed_over: vec![words], ..Recognised::default() });
        }
    };
    let values = columns.values(table)?;
    let several = columns.responses.len() > 1;
    let named = file_label(file);
    let models = columns.responses.iter().zip(values).map(|(response, points)| {
        let mut notes: Vec<String> = columns.notes.iter().chain(&table.notes).cloned().collect();
        if response.coherence.is_some() {
            notes.push("coherence taken as gamma squared".to_owned());
        }
        model(response, points, (several, &named), notes)
    });
    Ok(Recognised { models: models.collect(), ..Recognised::default() })
}

/// Output and input that the name of a file says, as its last two words: "flight_P_LAT", "frf LAT to P".
fn file_label(file: &str) -> Option<(String, String)> {
    let name = file.rsplit('/').next().unwrap_or(file);
    let stem = name.rsplit_once('.').map_or(name, |(stem, _)| stem);
    let words: Vec<&str> = stem.split(['_', '-', ' ']).filter(|word| !word.is_empty()).collect();
    // "frf-omega-re-im" says what the columns are, not whose response it is.
    if words.iter().rev().take(2).any(|word| says_quantity(word)) {
        return None;
    }
    match words.as_slice() {
        [.., input, to, output] if to.eq_ignore_ascii_case("to") => Some(((*output).to_owned(), (*input).to_owned())),
        [.., output, input] => Some(((*output).to_owned(), (*input).to_owned())),
        _ => None,
    }
}

fn model(
    response: &RecognisedResponse,
    points: ResponsePoints,
    (several, file): (bool, &Option<(String, String)>),
    notes: Vec<String>,
) -> FoundModel {
    let count = points.omega.len();
    let array = |values: Vec<f64>| ResponseArray { shape: [1, 1, count], values };
    let of_file = file.as_ref().filter(|_| !several);
    let output = response.output.clone().or_else(|| of_file.map(|(output, _)| output.clone()));
    let input = response.input.clone().or_else(|| of_file.map(|(_, input)| input.clone()));
    let variable = match (several, &output, &input) {
        (true, Some(output), Some(input)) => Some(format!("{output}/{input}")),
        _ => None,
    };
    let label = |name: Option<String>| ChannelLabel { name, unit: None };
    let draft = ResponseDraft {
        omega: points.omega,
        re: array(points.re),
        im: array(points.im),
        // Missing coherence trusts nothing.
        coherence: points
            .coherence
            .map(|values| array(values.iter().map(|of| if of.is_nan() { 0.0 } else { *of }).collect())),
        valid_bands: None,
        estimate: Estimate::default(),
    };
    FoundModel {
        draft: ModelDraft {
            name: variable.clone().unwrap_or_default(),
            origin: Origin::Identified { method: None, order: None },
            matrices: [None, None, None, None],
            timing: Timing::default(),
            response: Some(draft),
            source: Some(Provenance { variable, ..Provenance::default() }),
            states: Vec::new(),
            bands: None,
        },
        inputs: vec![label(input)],
        outputs: vec![label(output)],
        facts: Facts::default(),
        notes,
    }
}
