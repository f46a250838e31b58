//! Models as they were found, `gdcm-models` 1, which `gdcm convert` writes, and as they were identified, `gdcm-identified` 1.

use std::io::{self, Write};
use std::path::Path;

use gdcm_core::assembly::{ChannelLabel, Facts, FoundModel};
use gdcm_core::dataset::limits::{MOST_CHANNELS, MOST_MODELS_IN_ALL};
use gdcm_core::dataset::{Origin, Provenance};
use gdcm_core::whole_number::whole;
use serde::{Deserialize, Serialize};

use crate::dataset_file::ModelText;
use crate::file_error::FileError;
use crate::json_text::{Format, Limited, list, write_compact};
use crate::output_set::OutputSet;
use crate::variables::ReadingBudget;

/// What a file of models calls itself.
pub(super) const MODELS: Format = Format { name: "gdcm-models", version: 1 };
/// What a file of identified models calls itself.
pub(super) const IDENTIFIED: Format = Format { name: "gdcm-identified", version: 1 };

#[derive(Deserialize, Serialize)]
struct ModelsText {
    format: String,
    #[serde(deserialize_with = "whole")]
    version: u64,
    #[serde(deserialize_with = "list::<MOST_MODELS_IN_ALL, _, _>")]
    models: Vec<ModelText>,
}

/// Adds the models as a file to `outputs`.
pub fn add_models(models: &[FoundModel], path: &Path, outputs: &mut OutputSet) -> Result<(), FileError> {
    outputs.add(path, |file| write_models(models, file))
}

/// Writes the text of that file.
pub(super) fn write_models(models: &[FoundModel], file: &mut dyn Write) -> io::Result<()> {
    let models = models.iter().map(model_text).collect();
    let text = ModelsText { format: MODELS.name.to_owned(), version: MODELS.version, models };
    write_compact(&text, file)
}

/// The text of a model outside a dataset.
pub(super) fn model_text(model: &FoundModel) -> ModelText {
    let part = |labels: &[ChannelLabel], of: fn(&ChannelLabel) -> &Option<String>| {
        Some(Limited(labels.iter().map(|label| of(label).clone().unwrap_or_default()).collect()))
    };
    let text = ModelText::of(model.draft.clone());
    let role = match &model.draft.origin {
        // What a model is that says nothing of itself.
        Origin::Perturbed { perturbation: None } => None,
        Origin::Identified { .. } => Some("identified".to_owned()),
        Origin::Nominal { .. } | Origin::Perturbed { .. } => text.role,
    };
    ModelText {
        name: if text.name.is_empty() { model.file().to_owned() } else { text.name },
        role,
        inputs: part(&model.inputs, |label| &label.name),
        outputs: part(&model.outputs, |label| &label.name),
        input_units: part(&model.inputs, |label| &label.unit),
        output_units: part(&model.outputs, |label| &label.unit),
        source: text.source.or_else(|| Some(Default::default())),
        notes: Limited::some(model.notes.clone()),
        ..text
    }
}

/// The models of a text of this program; nothing where it is no such text.
pub(super) fn found_models(text: &[u8], path: &Path, budget: &ReadingBudget<'_>) -> Option<Vec<FoundModel>> {
    let read = |format: Format| {
        let (text, _) = format.decode::<ModelsText>(text, path, budget).ok()?;
        format.check_read(&text.format, text.version, path).ok()?;
        Some(text.models)
    };
    let models = read(MODELS).or_else(|| read(IDENTIFIED))?;
    models.into_iter().enumerate().map(|(index, model)| found(model, index)).collect()
}

/// Names or units of channels.
type Names = Limited<String, MOST_CHANNELS>;

/// The model of a text, under the name that a list of models has for it; nothing where it has no size.
fn found(mut text: ModelText, index: usize) -> Option<FoundModel> {
    let origin =
        text.origin().or_else(|| (text.method.is_some() || text.order.is_some()).then(|| text.identified_origin()));
    let labels = |count: usize, names: Option<Names>, units: Option<Names>| -> Vec<ChannelLabel> {
        let part = |list: &Option<Names>, at: usize| {
            let list = list.as_ref().filter(|list| list.0.len() == count)?;
            Some(list.0[at].clone()).filter(|text| !text.is_empty())
        };
        (0..count).map(|at| ChannelLabel { name: part(&names, at), unit: part(&units, at) }).collect()
    };
    let (outputs, inputs) = match (&text.b, &text.c, &text.frequency_response) {
        (Some(b), Some(c), _) => (c.shape[0], b.shape[1]),
        (.., Some(response)) => (response.re.shape[0], response.re.shape[1]),
        _ => return None,
    };
    let inputs = labels(inputs, text.inputs.take(), text.input_units.take());
    let outputs = labels(outputs, text.outputs.take(), text.output_units.take());
    let notes = Limited::entries(text.notes.take());
    let mut draft = text.into_draft(origin.unwrap_or(Origin::Perturbed { perturbation: None }));
    let source = draft.source.get_or_insert_with(Provenance::default);
    source.variable = Some(format!("models{{{}}}", index + 1));
    let notes = if notes.is_empty() { source.note.take().into_iter().collect() } else { notes };
    Some(FoundModel { draft, inputs, outputs, facts: Facts::default(), notes })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::output_set::Existing;
    use crate::{FoundModels, models_of_bytes};

    const DATASET: &str = r#"{"format": "gdcm-dataset", "version": 1, "name": "one",
        "inputs": [{"name": "LAT", "unit": "%"}], "outputs": [{"name": "P", "unit": "rad/s"}],
        "frequency_band": {"min": 0.3, "max": 20.0, "unit": "rad/s"},
        "conditions": [{"id": 3, "name": "hover", "airspeed_kt": 0.0,
            "physics_models": [
                {"name": "nominal", "role": "nominal", "A": [[-1.0]], "B": [[1.0]], "C": [[1.0]], "D": [[0.0]]},
                {"name": "roll+5", "role": "perturbed", "perturbation": {"roll_deg": 5.0}, "states": ["p"],
                 "A": [[-2.0]], "B": [[1.0]], "C": [[1.0]], "D": [[0.0]], "input_delays_s": [0.02]}],
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
    fn converted_models_keep_all_that_a_dataset_says_of_them() {
        let read = |bytes: &[u8], name: &str| -> FoundModels {
            models_of_bytes(bytes, name, &ReadingBudget::new(1 << 24)).unwrap()
        };
        let before = read(DATASET.as_bytes(), "one.json");
        let text = written(&before.models);
        let json: serde_json::Value = serde_json::from_slice(&text).unwrap();
        let measured = &json["models"][2];
        assert_eq!(measured["frequency_response"]["valid_band_rad_s"], serde_json::json!([[[0.5, 1.5]]]));
        assert_eq!(measured["frequency_response"]["averages"], 12.0);
        assert_eq!(measured["frequency_response"]["window_s"], 20.0);
        assert_eq!(measured["source"]["note"], "flight 12");
        assert_eq!(json["models"][1]["perturbation"], serde_json::json!({"roll_deg": 5.0}));
        let again = read(&text, "models.json");
        assert_eq!(again.faults, Vec::<String>::new());
        for (before, again) in before.models.iter().zip(&again.models) {
            let without_source = |model: &FoundModel| ModelText { source: None, ..model_text(model) };
            let text = |model| serde_json::to_string(&without_source(model)).unwrap();
            assert_eq!(text(before), text(again));
            assert_eq!(before.draft.origin, again.draft.origin);
        }
        assert_eq!(again.models[2].draft.source.as_ref().unwrap().variable.as_deref(), Some("models{3}"));
    }

    #[test]
    fn a_file_of_models_made_by_hand_is_read_as_far_as_it_goes() {
        let text = br#"{"format": "gdcm-models", "version": 1, "models": [{"A": [[-1]], "B": [[1]], "C": [[1]], "D": [[0]]}]}"#;
        let found = models_of_bytes(text, "models.json", &ReadingBudget::new(1 << 20)).unwrap();
        assert_eq!(found.models[0].draft.matrices[0].as_ref().unwrap()[(0, 0)], -1.0);
    }
}
