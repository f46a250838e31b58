//! Models as found, `gdcm-models` 1, which `gdcm convert` writes, and as identified,
//! `gdcm-identified` 1.

use std::io::{self, Write};
use std::iter::once;
use std::path::Path;

use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

use gdcm_model::assembly::found_model::Facts;
use gdcm_model::assembly::{ChannelLabel, FoundModel};
use gdcm_model::dataset::Channel;
use gdcm_model::dataset::condition::ConditionRecord;
use gdcm_model::dataset::limits::{MOST_CHANNELS, MOST_MODELS_IN_ALL};
use gdcm_model::dataset::model::{Origin, Provenance};
use gdcm_model::dataset::state_space::Timing;
use gdcm_model::dataset::unchecked_dataset::ModelDraft;
use gdcm_model::names::ChannelRule;
use gdcm_model::response::pole_estimate::PoleEstimate;
use gdcm_model::units::neper_to_db;
use gdcm_model::whole_number::whole;
use gdcm_sysid::identification::{CautionNote, Identification, ResponseEstimate};
use gdcm_sysid::records::RecordChannels;
use gdcm_sysid::spectra::response_estimate::EstimatePoint;

use super::corrections_file::without_empty;
use super::dataset_file::{LabelText, ModelText};
use crate::file_error::FileError;
use crate::json_text::{Format, Limited, Nested, list, write_compact};
use crate::output_set::OutputSet;
use crate::reading_budget::ReadingBudget;

/// Format and version of a file of models.
pub(crate) const MODELS: Format = Format {
    name: "gdcm-models",
    version: 1,
};
/// Format and version of a file of identified models.
pub(crate) const IDENTIFIED: Format = Format {
    name: "gdcm-identified",
    version: 1,
};

#[derive(Deserialize, Serialize)]
struct ModelsText {
    format: String,
    #[serde(deserialize_with = "whole")]
    version: u64,
    #[serde(deserialize_with = "list::<MOST_MODELS_IN_ALL, _, _>")]
    models: Vec<ModelText>,
}

/// Adds the models as a file to `outputs`.
pub fn add_models(
    models: &[FoundModel],
    path: &Path,
    outputs: &mut OutputSet,
) -> Result<(), FileError> {
    outputs.add(path, |file| write_models(models, file))
}

/// Writes the text of that file.
fn write_models(models: &[FoundModel], file: &mut dyn Write) -> io::Result<()> {
    let models = models.iter().map(model_text).collect();
    let text = ModelsText {
        format: MODELS.name.to_owned(),
        version: MODELS.version,
        models,
    };
    write_compact(&text, file)
}

/// A corrected model with the contents of the correction.
pub(crate) struct ContainingModel {
    pub(crate) model: FoundModel,
    /// The block `contains`.
    pub(crate) contains: Value,
}

#[derive(Serialize)]
struct ContainingModelText {
    #[serde(flatten)]
    model: ModelText,
    contains: Value,
}

#[derive(Serialize)]
struct ContainingModelsText {
    format: &'static str,
    version: u64,
    models: Vec<ContainingModelText>,
}

/// Writes the text of a file of corrected models.
pub(crate) fn write_containing_models(
    models: &[ContainingModel],
    file: &mut dyn Write,
) -> io::Result<()> {
    let mut texts = Vec::new();
    for of in models {
        texts.push(ContainingModelText {
            model: model_text(&of.model),
            contains: of.contains.clone(),
        });
    }
    write_compact(
        &ContainingModelsText {
            format: MODELS.name,
            version: MODELS.version,
            models: texts,
        },
        file,
    )
}

/// Converts a model outside a dataset to text.
pub(crate) fn model_text(model: &FoundModel) -> ModelText {
    let text = ModelText::of(model.draft.clone());
    let role = match &model.draft.origin {
        // The origin of a model without information on it.
        Origin::Perturbed { perturbation: None } => None,
        Origin::Identified { .. } => Some("identified".to_owned()),
        Origin::Nominal { .. } | Origin::Perturbed { .. } => text.role,
    };
    ModelText {
        name: if text.name.is_empty() {
            model.file().to_owned()
        } else {
            text.name
        },
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

fn names_text(labels: &[ChannelLabel]) -> Option<Limited<LabelText, MOST_CHANNELS>> {
    let names = labels
        .iter()
        .map(|label| LabelText::Name(label.name.clone().unwrap_or_default()));
    Some(Limited(names.collect()))
}

fn units_text(labels: &[ChannelLabel]) -> Option<Limited<String, MOST_CHANNELS>> {
    Some(Limited(
        labels
            .iter()
            .map(|label| label.unit.clone().unwrap_or_default())
            .collect(),
    ))
}

/// Reads the models of a text of this program, with its unknown keys; `None` for any other text, or
/// if an unknown key looks like a delay: it is then read like any other text, with the knowledge of
/// all notations for delays, and a question about the rest.
pub(crate) fn found_models(
    text: &[u8],
    path: &Path,
    budget: &ReadingBudget<'_>,
) -> Option<(Vec<FoundModel>, Vec<String>)> {
    let read = |format: Format| format.decode::<ModelsText>(text, path, budget).ok();
    let (models, unknown) = match read(MODELS) {
        Some((text, unknown)) => (text.models, unknown),
        None => (read(IDENTIFIED)?.0.models, Vec::new()),
    };
    if unknown.iter().any(|words| names_delay(words)) {
        return None;
    }
    let models = models
        .into_iter()
        .enumerate()
        .map(|(index, model)| found(model, index));
    Some((models.collect::<Option<_>>()?, unknown))
}

/// Returns whether the words about an unknown key name one that looks like a delay.
fn names_delay(words: &str) -> bool {
    let words = words.to_lowercase();
    ["delay", "\"tau", "\"td", "dead", "latency"]
        .iter()
        .any(|word| words.contains(word))
}

/// Returns the labels of a dataset's channels.
pub(crate) fn labels(channels: &[Channel]) -> Vec<ChannelLabel> {
    let label = |channel: &Channel| ChannelLabel {
        name: Some(channel.name.clone()),
        unit: Some(channel.unit.clone()),
    };
    channels.iter().map(label).collect()
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
    }
}

/// Converts the model of a text, with its index as the default name in a list of models; `None` if
/// it has no size.
fn found(mut text: ModelText, index: usize) -> Option<FoundModel> {
    let origin = text.origin().or_else(|| {
        (text.method.is_some() || text.order.is_some()).then(|| text.identified_origin())
    });
    let (outputs, inputs) = match (&text.b, &text.c, &text.frequency_response) {
        (Some(b), Some(c), _) => (c.shape[0], b.shape[1]),
        (.., Some(response)) => (response.re.shape[0], response.re.shape[1]),
        _ => return None,
    };
    let input_units = Limited::entries(text.input_units.take());
    let output_units = Limited::entries(text.output_units.take());
    let inputs = labels_of(inputs, Limited::entries(text.inputs.take()), input_units)?;
    let outputs = labels_of(outputs, Limited::entries(text.outputs.take()), output_units)?;
    let facts = Facts {
        condition: text.condition,
        airspeed_kt: text.airspeed_kt,
        altitude_ft: text.altitude_ft,
        mass_kg: text.mass_kg,
        ..Facts::default()
    };
    let notes = Limited::entries(text.notes.take());
    let mut draft = text.into_draft(origin.unwrap_or(Origin::Perturbed { perturbation: None }));
    let source = draft.source.get_or_insert_with(Provenance::default);
    source.variable = Some(format!("models{{{}}}", index + 1));
    let notes = if notes.is_empty() {
        source.note.take().into_iter().collect()
    } else {
        notes
    };
    Some(FoundModel {
        draft,
        inputs,
        outputs,
        facts,
        notes,
    })
}

/// Returns the labels of channels from their names and units, empty without names; `None` if their
/// number is wrong.
fn labels_of(count: usize, names: Vec<LabelText>, units: Vec<String>) -> Option<Vec<ChannelLabel>> {
    if [names.len(), units.len()]
        .into_iter()
        .any(|length| length != 0 && length != count)
    {
        return None;
    }
    let label = |at: usize| {
        let (name, unit) = names
            .get(at)
            .map(|label| label.clone().into_parts())
            .unwrap_or_default();
        let unit = units
            .get(at)
            .cloned()
            .filter(|unit| !unit.is_empty())
            .or(unit);
        ChannelLabel {
            name: Some(name).filter(|name| !name.is_empty()),
            unit: unit.filter(|unit| !unit.is_empty()),
        }
    };
    Some((0..count).map(label).collect())
}

// Models identified from flight records, `gdcm-identified` 1, as written by `gdcm identify`.

/// Results of an identification, with the additional information in its file.
pub struct IdentifiedModels<'f> {
    /// In the units of the channels.
    pub found: &'f Identification,
    pub channels: &'f RecordChannels,
    /// In order.
    pub records: &'f [ConditionRecord],
    pub cautions: &'f [CautionNote],
    /// Assumptions and actions while the records were read.
    pub reading: &'f [String],
}

#[derive(Serialize)]
struct IdentifiedText<'m> {
    format: &'static str,
    version: u64,
    models: Vec<ModelText>,
    measured: MeasuredText,
    poles: Vec<Value>,
    validation: Value,
    records: Vec<Value>,
    cautions: Vec<Value>,
    reading: &'m [String],
}

#[derive(Serialize)]
struct MeasuredText {
    omega_rad_s: Vec<f64>,
    re: Nested<3>,
    im: Nested<3>,
    /// Multiple coherence of each output.
    coherence: Nested<2>,
    partial_coherence: Nested<3>,
    sd_db: Nested<3>,
    sd_deg: Nested<3>,
}

/// Adds the results of an identification as a file to `outputs`: the recommended model first, then
/// CT-PBSID without refinement, then the rest of the bundle; values that are not finite become
/// `null`.
pub fn add_identified(
    of: &IdentifiedModels,
    path: &Path,
    outputs: &mut OutputSet,
) -> Result<(), FileError> {
    let found = of.found;
    let label = |rule: &ChannelRule| ChannelLabel {
        name: Some(rule.name.clone()),
        unit: Some(rule.unit.clone()).filter(|unit| !unit.is_empty()),
    };
    let models = once(&found.refined)
        .chain(once(&found.unrefined))
        .chain(&found.bundle)
        .map(|model| FoundModel {
            draft: ModelDraft::from_model(model),
            inputs: of.channels.inputs.iter().map(label).collect(),
            outputs: of.channels.outputs.iter().map(label).collect(),
            facts: Facts::default(),
            notes: Vec::new(),
        });
    let models: Vec<FoundModel> = models.collect();
    let in_time = found.validation.as_ref();
    let text = IdentifiedText {
        format: IDENTIFIED.name,
        version: IDENTIFIED.version,
        models: models
            .iter()
            .enumerate()
            .map(|(index, model)| ModelText {
                recommended: Some(index == 0),
                ..model_text(model)
            })
            .collect(),
        measured: measured_text(&found.measured),
        poles: found.poles.iter().map(pole_text).collect(),
        // Costs over degrees of freedom of the fitted and of the held-out records, the latter also
        // with the model free within its own uncertainty; share of each output of the held-out
        // records that the model reproduces in time [%], and Theil's coefficient.
        validation: json!({
            "fit_per_dof": found.cost,
            "held_out_per_dof": found.held_out_cost,
            "held_out_normalised": found.held_out_normalised,
            "fit_percent": in_time.map_or(&[][..], |of| &of.fit_percent),
            "theil": in_time.map_or(&[][..], |of| &of.theil),
        }),
        records: of
            .records
            .iter()
            .enumerate()
            .map(|(index, record)| record_text(found, index, record))
            .collect(),
        cautions: of.cautions.iter().map(caution_text).collect(),
        reading: of.reading,
    };
    outputs.add(path, |file| write_compact(&text, file))
}

fn measured_text(measured: &ResponseEstimate) -> MeasuredText {
    let points = &measured.points;
    let (outputs, inputs) = points
        .first()
        .map_or((0, 0), |point| point.response.shape());
    let table = |value: &dyn Fn(&EstimatePoint, (usize, usize)) -> f64| {
        let pairs = (0..outputs).flat_map(|output| (0..inputs).map(move |input| (output, input)));
        let values = pairs
            .flat_map(|pair| points.iter().map(move |point| value(point, pair)))
            .collect();
        Nested {
            shape: [outputs, inputs, points.len()],
            values,
        }
    };
    let coherence = (0..outputs)
        .flat_map(|output| points.iter().map(move |point| point.coherence[output]))
        .collect();
    MeasuredText {
        omega_rad_s: points.iter().map(|point| point.omega).collect(),
        re: table(&|point, pair| point.response[pair].re),
        im: table(&|point, pair| point.response[pair].im),
        coherence: Nested {
            shape: [outputs, points.len()],
            values: coherence,
        },
        partial_coherence: table(&|point, pair| point.partial_coherence[pair]),
        sd_db: table(&|point, pair| neper_to_db(point.sd(pair))),
        sd_deg: table(&|point, pair| point.sd(pair).to_degrees()),
    }
}

/// Returns a caution: its record if it concerns a single one, and all its records; output and input
/// of its pair.
fn caution_text(of: &CautionNote) -> Value {
    json!({
        "code": of.code,
        "record": if let [one] = of.records.as_slice() { Some(one) } else { None },
        "records": of.records,
        "channel": of.channel,
        "pair": of.pair,
        "band_rad_s": of.band_rad_s,
        "text": of.text,
    })
}

fn pole_text(of: &PoleEstimate) -> Value {
    json!({"re": of.pole.re, "im": of.pole.im, "sd": of.sd_re.hypot(of.sd_im), "determined": of.determined})
}

/// Returns a record: first and last time of its part of the file, and of each used segment; the
/// reasons why others were not used.
fn record_text(found: &Identification, index: usize, record: &ConditionRecord) -> Value {
    let gaps = found
        .record_uses
        .get(index)
        .into_iter()
        .flat_map(|used| &used.gaps);
    let gaps: Vec<String> = gaps.map(ToString::to_string).collect();
    let record = json!({
        "name": record.name,
        "file": record.file,
        "sha256": record.sha256,
        "variable": record.variable,
        "held_out": record.held_out,
        "part_s": record.part_s,
        "used_s": record.used_s,
        "why_not": Some(gaps.join("; ")).filter(|words| !words.is_empty()),
    });
    without_empty(record, &["variable", "part_s"])
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
        }
        assert_eq!(
            again.models[2]
                .draft
                .source
                .as_ref()
                .unwrap()
                .variable
                .as_deref(),
            Some("models{3}")
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

#[cfg(test)]
mod identified_tests {
    use std::sync::Arc;

    use nalgebra::{Complex, DMatrix, DVector};

    use gdcm_model::dataset::model::{ModelBands, Origin, Provenance};
    use gdcm_model::dataset::{Dynamics, Model, PairTable, StateSpace};

    use super::*;
    use crate::import::model_files::models_of_bytes;
    use crate::output_set::Existing;

    fn model(name: &str, gain: f64) -> Model {
        let scalar = |value| DMatrix::from_element(1, 1, value);
        let dynamics =
            StateSpace::new(scalar(-1.0), scalar(gain), scalar(1.0), scalar(0.0)).unwrap();
        let origin = Origin::Identified {
            method: Some("CT-PBSID".into()),
            order: Some(1),
        };
        let table = |value: f64| PairTable::filled(1, 1, vec![value; 2]);
        Model {
            source: Some(Provenance {
                records: vec!["LON 1".into()],
                ..Provenance::default()
            }),
            bands: Some(Arc::new(
                ModelBands::new(vec![1.0, 2.0], table(0.5), table(3.0)).unwrap(),
            )),
            ..Model::new(name, origin, Dynamics::StateSpace(dynamics))
        }
    }

    fn point(omega: f64, imaginary: f64, coherence: f64) -> EstimatePoint {
        let scalar = |value| DMatrix::from_element(1, 1, value);
        EstimatePoint {
            omega,
            response: DMatrix::from_element(1, 1, Complex::new(1.0, imaginary)),
            variance: scalar(0.01),
            noise: scalar(0.1),
            power: DVector::from_element(1, 1.0),
            coherence: DVector::from_element(1, coherence),
            partial_coherence: scalar(0.7),
            condition: 1.0,
            half_width: 0.5,
            freedom: 20,
        }
    }

    fn found() -> Identification {
        let pole = PoleEstimate {
            pole: Complex::from(-1.0),
            sd_re: 0.1,
            sd_im: 0.0,
            determined: true,
        };
        Identification {
            refined: model("CT-PBSID, refined", 2.0),
            unrefined: model("CT-PBSID", 3.0),
            bundle: Vec::new(),
            measured: ResponseEstimate {
                points: vec![point(1.0, -2.0, 0.9), point(2.0, f64::NAN, 0.8)],
            },
            poles: vec![pole],
            stabilisation: Vec::new(),
            laguerre_pole: 1.0,
            past: 8,
            criteria: Vec::new(),
            cost: 1.02,
            held_out_cost: None,
            held_out_normalised: None,
            feedback: None,
            contrasts: Vec::new(),
            record_fits: Vec::new(),
            output_costs: Vec::new(),
            validation: None,
            record_uses: Vec::new(),
            not_identified: Vec::new(),
            cautions: Vec::new(),
        }
    }

    fn written(cautions: &[CautionNote]) -> Vec<u8> {
        let rule = |name: &str, unit: &str| ChannelRule {
            unit: unit.into(),
            ..ChannelRule::named(name)
        };
        let inputs = vec![rule("LON", "%")];
        let outputs = vec![rule("Q", "deg/s")];
        let channels = RecordChannels {
            inputs,
            outputs,
            ..RecordChannels::default()
        };
        let record = ConditionRecord {
            used_s: vec![[0.0, 60.0]],
            ..ConditionRecord::new("LON 1", "lon_1.csv")
        };
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("identified.json");
        let mut outputs = OutputSet::new(Existing::Keep, Vec::new());
        let models = IdentifiedModels {
            found: &found(),
            channels: &channels,
            records: &[record],
            cautions,
            reading: &[],
        };
        add_identified(&models, &path, &mut outputs).unwrap();
        outputs.persist().unwrap();
        std::fs::read(path).unwrap()
    }

    #[test]
    fn every_key_of_the_format_is_written_and_the_recommended_model_comes_first() {
        let text = "PED was not swept: its column is not identified".to_owned();
        let bytes = written(&[CautionNote {
            code: "not-swept",
            channel: Some("PED".into()),
            text,
            ..CautionNote::default()
        }]);
        let text: serde_json::Value = serde_json::from_slice(&bytes).unwrap();
        assert_eq!(
            (&text["format"], &text["version"]),
            (&"gdcm-identified".into(), &1.into())
        );
        assert_eq!(
            (
                &text["models"][0]["recommended"],
                &text["models"][1]["recommended"]
            ),
            (&true.into(), &false.into())
        );
        assert_eq!(
            text["models"][0]["bands"]["sd_deg"],
            serde_json::json!([[[3.0, 3.0]]])
        );
        assert_eq!(
            text["models"][0]["source"]["records"],
            serde_json::json!(["LON 1"])
        );
        assert_eq!(text["models"][0]["order"], 1);
        assert_eq!(text["measured"]["im"], serde_json::json!([[[-2.0, null]]]));
        assert_eq!(
            text["measured"]["coherence"],
            serde_json::json!([[0.9, 0.8]])
        );
        assert_eq!(
            (
                &text["poles"][0]["sd"],
                &text["validation"]["held_out_per_dof"]
            ),
            (&0.1.into(), &serde_json::Value::Null)
        );
        assert_eq!(text["validation"]["fit_percent"], serde_json::json!([]));
        assert_eq!(
            text["records"][0]["used_s"],
            serde_json::json!([[0.0, 60.0]])
        );
        let caution = serde_json::json!({
            "code": "not-swept", "record": null, "records": [], "channel": "PED", "pair": null, "band_rad_s": null,
            "text": "PED was not swept: its column is not identified"
        });
        assert_eq!(text["cautions"], serde_json::json!([caution]));
    }

    #[test]
    fn a_caution_of_one_record_names_it_and_one_of_a_pair_names_both() {
        let of = |names: &[&str]| {
            let records = names.iter().map(|name| (*name).to_owned()).collect();
            let bytes = written(&[CautionNote {
                code: "record",
                records,
                ..CautionNote::default()
            }]);
            let text: serde_json::Value = serde_json::from_slice(&bytes).unwrap();
            (
                text["cautions"][0]["record"].clone(),
                text["cautions"][0]["records"].clone(),
            )
        };
        assert_eq!(
            of(&["lat_1"]),
            ("lat_1".into(), serde_json::json!(["lat_1"]))
        );
        assert_eq!(
            of(&["lat_1", "lat_2"]),
            (
                serde_json::Value::Null,
                serde_json::json!(["lat_1", "lat_2"])
            )
        );
    }

    #[test]
    fn the_models_are_found_again_in_the_file() {
        let again = models_of_bytes(
            &written(&[]),
            "identified.json",
            &crate::reading_budget::ReadingBudget::new(1 << 24),
        )
        .unwrap();
        let gains: Vec<f64> = again
            .models
            .iter()
            .map(|model| model.draft.matrices[1].as_ref().unwrap()[(0, 0)])
            .collect();
        assert_eq!(
            (gains, again.faults),
            (vec![2.0, 3.0], Vec::<String>::new())
        );
        assert_eq!(
            again.models[0].outputs[0],
            ChannelLabel {
                name: Some("Q".into()),
                unit: Some("deg/s".into())
            }
        );
    }
}
