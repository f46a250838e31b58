//! Frequency responses in tables of columns.
//!
//! A table of columns, such as frequency, magnitude and phase, is recognised by its headings
//! (`FrequencyColumns`). A heading without a unit is reported as missing, because the engineer can
//! state it.

use gdcm_model::assembly::found_model::Facts;
use gdcm_model::assembly::{ChannelLabel, FoundModel};
use gdcm_model::dataset::dataset_draft::{ModelDraft, ResponseArray, ResponseDraft};
use gdcm_model::dataset::measured_response::Estimate;
use gdcm_model::dataset::model::{Origin, Provenance};
use gdcm_model::number_format::counted;

use super::recognise::Found;
use crate::files::model_collection::bare_draft;
use crate::formats::reading_note::{ReadingNote, note_texts};
use crate::formats::text::{
    FrequencyColumns, RecognisedResponse, ResponsePoints, TextTable, UnitNotGiven, Unrecognised,
};
use crate::reading_budget::VariableFault;

/// Frequency responses found in a table.
pub(super) struct TableModels {
    pub(super) found: Found<FoundModel>,
    /// Units that the user must state before the table can be read as frequency responses.
    pub(super) missing_units: Vec<UnitNotGiven>,
}

/// Returns each response in a table as a model with one input and one output. A table without
/// responses is reported as ignored, with the units that would make it readable.
pub(super) fn models_of_table(table: &TextTable, file: &str) -> Result<TableModels, VariableFault> {
    let columns = match FrequencyColumns::recognise(table) {
        Ok(columns) => columns,
        Err(Unrecognised { fault, unsaid }) => {
            let words = format!(
                "{file}: {} of numbers; {fault}",
                counted(table.columns.len(), "column")
            );
            let found = Found {
                ignored: vec![words],
                ..Found::default()
            };
            return Ok(TableModels {
                found,
                missing_units: unsaid,
            });
        }
    };
    let values = columns.values(table)?;
    let has_several = columns.responses.len() > 1;
    let mut found = Found {
        unused: columns.unused.clone(),
        ..Found::default()
    };
    for (response, points) in columns.responses.iter().zip(values) {
        let mut model = response_model(response, points, has_several);
        model.notes.extend(note_texts(&columns.notes));
        model.notes.extend(note_texts(&table.notes));
        if response.coherence.is_some() {
            model.notes.push(ReadingNote::CoherenceSquared.to_string());
        }
        found.items.push(model);
    }
    Ok(TableModels {
        found,
        missing_units: Vec::new(),
    })
}

/// Returns a response as a model, without notes. If the table `has_several` responses, the variable
/// is named after the response's channels.
fn response_model(
    response: &RecognisedResponse,
    points: ResponsePoints,
    has_several: bool,
) -> FoundModel {
    let count = points.omega.len();
    let coherence = points.coherence.map(|mut values| {
        // Missing coherence counts as zero.
        for value in &mut values {
            if value.is_nan() {
                *value = 0.0;
            }
        }
        single_response(values, count)
    });
    let variable = match (has_several, &response.output, &response.input) {
        (true, Some(output), Some(input)) => Some(format!("{output}/{input}")),
        (true, Some(channel), None) | (true, None, Some(channel)) => Some(channel.clone()),
        _ => None,
    };
    let draft = ResponseDraft {
        omega: points.omega,
        re: single_response(points.re, count),
        im: single_response(points.im, count),
        coherence,
        valid_bands: None,
        estimate: Estimate::default(),
    };
    let origin = Origin::Identified {
        method: None,
        order: None,
    };
    FoundModel {
        draft: ModelDraft {
            response: Some(draft),
            source: Some(Provenance {
                variable: variable.clone(),
                ..Provenance::default()
            }),
            ..bare_draft(variable.unwrap_or_default(), origin)
        },
        inputs: vec![unitless_label(response.input.clone())],
        outputs: vec![unitless_label(response.output.clone())],
        facts: Facts::default(),
        notes: Vec::new(),
    }
}

/// Returns the values of a single response as an array, outputs x inputs x frequencies.
fn single_response(values: Vec<f64>, count: usize) -> ResponseArray {
    ResponseArray {
        shape: [1, 1, count],
        values,
    }
}

fn unitless_label(name: Option<String>) -> ChannelLabel {
    ChannelLabel { name, unit: None }
}
