//! Model files, `gdcm-models` 1, written by `gdcm convert` and, for corrected models, by `gdcm
//! export`. Models in `gdcm-identified` files have the same form and are read here too.
//!
//! A [`FoundModel`] is a model outside a dataset, with channels in the file's order and units; its
//! [`Facts`] are the flight condition and the name that the file states.

use std::io::{self, Write};
use std::path::Path;

use serde::{Deserialize, Serialize};
use serde_json::Value;

use gdcm_model::assembly::found_model::Facts;
use gdcm_model::assembly::{ChannelLabel, FoundModel};
use gdcm_model::dataset::Channel;
use gdcm_model::dataset::dataset_draft::ModelDraft;
use gdcm_model::dataset::limits::{MOST_CHANNELS, MOST_MODELS_IN_ALL};
use gdcm_model::dataset::model::{Origin, Provenance};
use gdcm_model::dataset::state_space::Timing;
use gdcm_model::whole_number::whole;

use super::dataset_file::{LabelText, ModelText};
use crate::file_caution::FileCaution;
use crate::file_error::FileError;
use crate::json_reading::{Format, Limited, list};
use crate::json_writing::write_compact;
use crate::output_set::OutputSet;
use crate::reading_budget::ReadingBudget;
use crate::software::software;

pub(crate) const MODELS: Format = Format {
    name: "gdcm-models",
    version: 1,
};
pub(crate) const IDENTIFIED: Format = Format {
    name: "gdcm-identified",
    version: 1,
};

#[derive(Deserialize, Serialize)]
struct ModelsText {
    format: String,
    #[serde(deserialize_with = "whole")]
    version: u64,
    /// Program that wrote the file; empty in older files.
    #[serde(default)]
    software: String,
    #[serde(deserialize_with = "list::<MOST_MODELS_IN_ALL, _, _>")]
    models: Vec<ModelText>,
}

/// Adds a file with the models to `outputs`.
pub fn add_models(
    models: &[FoundModel],
    path: &Path,
    outputs: &mut OutputSet,
) -> Result<(), FileError> {
    outputs.add(path, |file| write_models(models, file))
}

fn write_models(models: &[FoundModel], file: &mut dyn Write) -> io::Result<()> {
    let text = ModelsText {
        format: MODELS.name.to_owned(),
        version: MODELS.version,
        software: software(),
        models: models.iter().map(model_text).collect(),
    };
    write_compact(&text, file)
}

/// A corrected model with a description of the applied correction parts.
pub(crate) struct ModelWithContents {
    pub(crate) model: FoundModel,
    /// JSON object written under the key `contains`.
    pub(crate) contains: Value,
}

#[derive(Serialize)]
struct ModelWithContentsText {
    #[serde(flatten)]
    model: ModelText,
    contains: Value,
}

#[derive(Serialize)]
struct ModelsWithContentsText {
    format: &'static str,
    version: u64,
    software: String,
    models: Vec<ModelWithContentsText>,
}

pub(crate) fn write_models_with_contents(
    models: &[ModelWithContents],
    file: &mut dyn Write,
) -> io::Result<()> {
    let mut texts = Vec::new();
    for containing in models {
        texts.push(ModelWithContentsText {
            model: model_text(&containing.model),
            contains: containing.contains.clone(),
        });
    }
    let text = ModelsWithContentsText {
        format: MODELS.name,
        version: MODELS.version,
        software: software(),
        models: texts,
    };
    write_compact(&text, file)
}

/// Converts a model outside a dataset to its form in the file.
pub(crate) fn model_text(model: &FoundModel) -> ModelText {
    let text = ModelText::from_draft(model.draft.clone());
    let role = match &model.draft.origin {
        // This value represents an unknown origin, which is not written.
        Origin::Perturbed { perturbation: None } => None,
        Origin::Identified { .. } => Some("identified".to_owned()),
        Origin::Nominal { .. } | Origin::Perturbed { .. } => text.role,
    };
    let name = if text.name.is_empty() {
        model.file().to_owned()
    } else {
        text.name
    };
    ModelText {
        name,
        role,
        condition: model.facts.condition,
        airspeed_kt: model.facts.airspeed_kt,
        altitude_ft: model.facts.altitude_ft,
        mass_kg: model.facts.mass_kg,
        inputs: names_text(&model.inputs),
        outputs: names_text(&model.outputs),
        input_units: units_text(&model.inputs),
        output_units: units_text(&model.outputs),
        source: text.source.or_else(|| Some(Default::default())),
        notes: Limited::some(model.notes.clone()),
        ..text
    }
}

/// Returns the channel names; an unknown name becomes an empty string.
fn names_text(labels: &[ChannelLabel]) -> Option<Limited<LabelText, MOST_CHANNELS>> {
    let mut names = Vec::with_capacity(labels.len());
    for label in labels {
        names.push(LabelText::Name(label.name.clone().unwrap_or_default()));
    }
    Some(Limited(names))
}

/// Returns the channel units; an unknown unit becomes an empty string.
fn units_text(labels: &[ChannelLabel]) -> Option<Limited<String, MOST_CHANNELS>> {
    let mut units = Vec::with_capacity(labels.len());
    for label in labels {
        units.push(label.unit.clone().unwrap_or_default());
    }
    Some(Limited(units))
}

/// Reads the models from a file in one of this program's model formats, with cautions about unknown
/// keys.
///
/// Returns `None` for any other file, if a model has no dimensions or labels that do not fit them,
/// and if an unknown key's name suggests a delay: such a file is read as general JSON instead,
/// which supports more delay notations and asks the engineer about the rest.
pub(crate) fn found_models(
    text: &[u8],
    path: &Path,
    budget: &ReadingBudget<'_>,
) -> Option<(Vec<FoundModel>, Vec<FileCaution>)> {
    let (texts, unknown) = match MODELS.decode::<ModelsText>(text, path, budget) {
        Ok((text, unknown)) => (text.models, unknown),
        Err(_) => {
            // Unknown keys need no caution: they are identification results.
            let (text, _) = IDENTIFIED.decode::<ModelsText>(text, path, budget).ok()?;
            (text.models, Vec::new())
        }
    };
    if unknown.iter().any(names_delay) {
        return None;
    }
    let mut models = Vec::with_capacity(texts.len());
    for (index, text) in texts.into_iter().enumerate() {
        models.push(found_model(text, index)?);
    }
    Some((models, unknown))
}

/// Returns whether a caution is about a key whose name suggests a delay.
fn names_delay(caution: &FileCaution) -> bool {
    let (FileCaution::UnknownKey { key, .. } | FileCaution::MisplacedKey { key, .. }) = caution
    else {
        return false;
    };
    let key = key.to_lowercase();
    let contains = ["delay", "dead", "latency"]
        .iter()
        .any(|word| key.contains(word));
    contains || ["tau", "td"].iter().any(|word| key.starts_with(word))
}

/// Returns labels with channel names and units.
pub(crate) fn labels(channels: &[Channel]) -> Vec<ChannelLabel> {
    let mut labels = Vec::with_capacity(channels.len());
    for channel in channels {
        labels.push(ChannelLabel {
            name: Some(channel.name.clone()),
            unit: Some(channel.unit.clone()),
        });
    }
    labels
}

/// Creates a draft with only a name and an origin.
pub(crate) fn bare_draft(name: String, origin: Origin) -> ModelDraft {
    ModelDraft {
        name,
        origin,
        matrices: [const { None }; 4],
        timing: Timing::default(),
        response: None,
        source: None,
        states: Vec::new(),
        bands: None,
        moved: None,
    }
}

/// Converts the model at `index` (from 0), which is part of its variable name. Its origin follows
/// from its role; else it is identified if it has a method or an order; else unknown
/// (`Perturbed`). Returns `None` if neither the matrices nor a response give its dimensions, if a
/// list of channel names or units does not fit them, or if the model is both a run and a rerun.
fn found_model(mut text: ModelText, index: usize) -> Option<FoundModel> {
    let origin = match text.origin() {
        Some(origin) => origin,
        None if text.method.is_some() || text.order.is_some() => text.identified_origin(),
        None => Origin::Perturbed { perturbation: None },
    };
    let (outputs, inputs) = match (&text.b, &text.c, &text.frequency_response) {
        (Some(b), Some(c), _) => (c.shape[0], b.shape[1]),
        (.., Some(response)) => (response.re.shape[0], response.re.shape[1]),
        _ => return None,
    };
    let input_names = Limited::entries(text.inputs.take());
    let input_units = Limited::entries(text.input_units.take());
    let output_names = Limited::entries(text.outputs.take());
    let output_units = Limited::entries(text.output_units.take());
    let inputs = labels_from_texts(inputs, input_names, input_units)?;
    let outputs = labels_from_texts(outputs, output_names, output_units)?;
    let facts = Facts {
        condition: text.condition,
        airspeed_kt: text.airspeed_kt,
        altitude_ft: text.altitude_ft,
        mass_kg: text.mass_kg,
        ..Facts::default()
    };
    let mut notes = Limited::entries(text.notes.take());
    let moved = match origin {
        Origin::Identified { .. } => None,
        Origin::Nominal { .. } | Origin::Perturbed { .. } => text.moved_parameters().ok()?,
    };
    let mut draft = ModelDraft {
        moved,
        ..text.into_draft(origin)
    };
    let source = draft.source.get_or_insert_with(Provenance::default);
    source.variable = Some(format!("models{{{}}}", index + 1));
    if notes.is_empty() {
        notes.extend(source.note.take());
    }
    Some(FoundModel {
        draft,
        inputs,
        outputs,
        facts,
        notes,
    })
}

/// Returns labels for `count` channels from their names and units; either list may be empty. A unit
/// in `units` replaces a unit beside the name. Returns `None` if a list that is not empty has
/// another length than `count`.
fn labels_from_texts(
    count: usize,
    names: Vec<LabelText>,
    units: Vec<String>,
) -> Option<Vec<ChannelLabel>> {
    for length in [names.len(), units.len()] {
        if length != 0 && length != count {
            return None;
        }
    }
    let mut labels = vec![ChannelLabel::default(); count];
    for (label, text) in labels.iter_mut().zip(names) {
        let (name, unit) = text.into_parts();
        label.name = Some(name).filter(|name| !name.is_empty());
        label.unit = unit.filter(|unit| !unit.is_empty());
    }
    for (label, unit) in labels.iter_mut().zip(units) {
        if !unit.is_empty() {
            label.unit = Some(unit);
        }
    }
    Some(labels)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::import::model_files::{FoundModels, models_of_bytes};
    use crate::output_set::Existing;

    const DATASET: &str = r#"{"format": "gdcm-dataset", "version": 1, "name": "one",
        "inputs": [{"name": "LAT", "unit": "%"}], "outputs": [{"name": "P", "unit": "rad/s"}],
        "frequency_band": {"min": 0.3, "max": 20.0, "unit": "rad/s"},
        "conditions": [{"id": 3, "name": "hover", "airspeed_kt": 0.0,
            "physics_models": [
                {"name": "nominal", "role": "nominal", "A": [[-1.0]], "B": [[1.0]], "C": [[1.0]], "D": [[0.0]]},
                {"name": "roll+5", "role": "perturbed", "perturbation": {"roll_deg": 5.0}, "states": ["p"],
                 "A": [[-2.0]], "B": [[1.0]], "C": [[1.0]], "D": [[0.0]], "input_delays_s": [0.02]},
                {"name": "inertia run", "parameter": {"name": "Ixx", "delta": 5, "unit": "%"},
                 "A": [[-3.0]], "B": [[1.0]], "C": [[1.0]], "D": [[0.0]]}],
            "identified_models": [{"name": "measured", "method": "CIFER", "source": {"note": "flight 12"},
                "frequency_response": {"omega_rad_s": [0.5, 1.0, 2.0], "re": [[[1.0, 0.9, 0.5]]], "im": [[[0.0, -0.1, -0.4]]],
                    "coherence": [[[0.9, 0.8, 0.7]]], "valid_band_rad_s": [[[0.5, 1.5]]], "averages": 12.0,
                    "window_s": 20.0}}]}]}"#;

    fn written(models: &[FoundModel]) -> Vec<u8> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("models.json");
        let mut outputs = OutputSet::new(Existing::Keep, Vec::new());
        add_models(models, &path, &mut outputs).unwrap();
        outputs.persist().unwrap();
        std::fs::read(path).unwrap()
    }

    #[test]
    fn converted_models_keep_all_information_from_their_dataset() {
        let read = |bytes: &[u8], name: &str| -> FoundModels {
            models_of_bytes(bytes, name, &ReadingBudget::new(1 << 24)).unwrap()
        };
        let before = read(DATASET.as_bytes(), "one.json");
        let text = written(&before.models);
        let json: serde_json::Value = serde_json::from_slice(&text).unwrap();
        let measured = &json["models"][3];
        assert_eq!(
            measured["frequency_response"]["valid_band_rad_s"],
            serde_json::json!([[[0.5, 1.5]]])
        );
        assert_eq!(measured["frequency_response"]["averages"], 12.0);
        assert_eq!(measured["frequency_response"]["window_s"], 20.0);
        assert_eq!(measured["source"]["note"], "flight 12");
        assert_eq!(
            json["models"][1]["perturbation"],
            serde_json::json!({"roll_deg": 5.0})
        );
        let again = read(&text, "models.json");
        assert_eq!(again.faults, Vec::<String>::new());
        for (before, again) in before.models.iter().zip(&again.models) {
            let without_source = |model: &FoundModel| ModelText {
                source: None,
                ..model_text(model)
            };
            let text = |model| serde_json::to_string(&without_source(model)).unwrap();
            assert_eq!(text(before), text(again));
            assert_eq!(before.draft.origin, again.draft.origin);
            assert_eq!(before.draft.moved, again.draft.moved);
        }
        assert_eq!(
            again.models[3]
                .draft
                .source
                .as_ref()
                .unwrap()
                .variable
                .as_deref(),
            Some("models{4}")
        );
    }

    #[test]
    fn a_file_of_models_made_by_hand_is_read_as_far_as_it_goes() {
        let text = br#"{"format": "gdcm-models", "version": 1, "models": [{"A": [[-1]], "B": [[1]], "C": [[1]], "D": [[0]]}]}"#;
        let found = models_of_bytes(text, "models.json", &ReadingBudget::new(1 << 20)).unwrap();
        assert_eq!(
            found.models[0].draft.matrices[0].as_ref().unwrap()[(0, 0)],
            -1.0
        );
    }
}
