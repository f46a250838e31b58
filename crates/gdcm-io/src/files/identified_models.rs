//! Files with models identified from flight records, `gdcm-identified` 1, written by `gdcm
//! identify`. `model_collection` reads their models.
//!
//! The recommended model is refined: found by a subspace method (CT-PBSID), then fitted to the
//! records' spectra. The other models in its bundle have neighbouring orders, or are fitted without
//! one record each. A cost per degree of freedom near 1 is adequate; held-out records are not
//! fitted, and validate the model (M14).

use std::io;
use std::path::Path;

use serde::Serialize;
use serde_json::{Value, json};

use gdcm_model::assembly::found_model::Facts;
use gdcm_model::assembly::{ChannelLabel, FoundModel};
use gdcm_model::dataset::Model;
use gdcm_model::dataset::condition::ConditionRecord;
use gdcm_model::dataset::dataset_draft::ModelDraft;
use gdcm_model::names::channel_rule::ChannelRule;
use gdcm_model::response::pole_estimate::PoleEstimate;
use gdcm_model::units::neper_to_db;
use gdcm_sysid::identification::{CautionNote, Identification, ResponseEstimate};
use gdcm_sysid::records::RecordChannels;
use gdcm_sysid::spectra::response_estimate::EstimatePoint;

use super::dataset_file::ModelText;
use super::model_collection::{IDENTIFIED, model_text};
use crate::file_error::FileError;
use crate::json_empty_members::without_empty;
use crate::json_reading::Nested;
use crate::json_writing::write_compact;
use crate::output_set::OutputSet;
use crate::software::software;

/// Identification results and the records on which they are based, as written to a file.
pub struct IdentifiedModels<'f> {
    /// Identified models, in the units of `channels`.
    pub identification: &'f Identification,
    pub channels: &'f RecordChannels,
    /// Records that were used, in the order of `record_uses` in the results.
    pub records: &'f [ConditionRecord],
    pub cautions: &'f [CautionNote],
    /// Notes on assumptions made while the records were read.
    pub reading: &'f [String],
}

#[derive(Serialize)]
struct IdentifiedText<'m> {
    format: &'static str,
    version: u64,
    software: String,
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
    /// Multiple coherence, outputs x frequencies.
    coherence: Nested<2>,
    partial_coherence: Nested<3>,
    sd_db: Nested<3>,
    sd_deg: Nested<3>,
}

/// Adds a file with identification results to `outputs`. The models are, in this order, the
/// recommended model, the CT-PBSID model without refinement, and the other models in the bundle.
/// Non-finite values are written as `null`.
pub fn add_identified(
    results: &IdentifiedModels<'_>,
    path: &Path,
    outputs: &mut OutputSet,
) -> Result<(), FileError> {
    let text = identified_text(results);
    outputs.add(path, |file| write_compact(&text, file))
}

/// Returns the contents of a file with identification results, as [`add_identified`] writes it.
///
/// # Errors
/// Errors from the JSON writer; no value is known to cause one.
pub fn identified_json(results: &IdentifiedModels<'_>) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    write_compact(&identified_text(results), &mut bytes)?;
    Ok(bytes)
}

fn identified_text<'m>(results: &IdentifiedModels<'m>) -> IdentifiedText<'m> {
    let identification = results.identification;
    let mut models = vec![ModelText {
        recommended: Some(true),
        ..identified_model_text(&identification.refined, results.channels)
    }];
    for model in std::iter::once(&identification.unrefined).chain(&identification.bundle) {
        models.push(ModelText {
            recommended: Some(false),
            ..identified_model_text(model, results.channels)
        });
    }
    let mut records = Vec::with_capacity(results.records.len());
    for (index, record) in results.records.iter().enumerate() {
        records.push(record_json(identification, index, record));
    }
    IdentifiedText {
        format: IDENTIFIED.name,
        version: IDENTIFIED.version,
        software: software(),
        models,
        measured: measured_text(&identification.measured),
        poles: identification.poles.iter().map(pole_json).collect(),
        validation: validation_json(identification),
        records,
        cautions: results.cautions.iter().map(caution_json).collect(),
        reading: results.reading,
    }
}

fn identified_model_text(model: &Model, channels: &RecordChannels) -> ModelText {
    model_text(&FoundModel {
        draft: ModelDraft::from_model(model),
        inputs: channels.inputs.iter().map(label).collect(),
        outputs: channels.outputs.iter().map(label).collect(),
        facts: Facts::default(),
        notes: Vec::new(),
    })
}

fn label(rule: &ChannelRule) -> ChannelLabel {
    ChannelLabel {
        name: Some(rule.name.clone()),
        unit: Some(rule.unit.clone()).filter(|unit| !unit.is_empty()),
    }
}

/// Returns the validation results: cost per degree of freedom for the fitted and the held-out
/// records, for the latter also normalised with the model's uncertainty; in the time domain, for
/// the held-out records, each output's fit \[%\] and Theil's coefficient.
fn validation_json(identification: &Identification) -> Value {
    let in_time = identification.validation.as_ref();
    let fit_percent = match in_time {
        Some(in_time) => json!(in_time.fit_percent),
        None => json!([]),
    };
    let theil = match in_time {
        Some(in_time) => json!(in_time.theil),
        None => json!([]),
    };
    json!({
        "fit_per_dof": identification.cost,
        "held_out_per_dof": identification.held_out_cost,
        "held_out_normalised": identification.held_out_normalised,
        "fit_percent": fit_percent,
        "theil": theil,
    })
}

fn measured_text(measured: &ResponseEstimate) -> MeasuredText {
    let points = &measured.points;
    let outputs = match points.first() {
        Some(point) => point.response.nrows(),
        None => 0,
    };
    let mut coherence = Vec::with_capacity(outputs * points.len());
    for output in 0..outputs {
        coherence.extend(points.iter().map(|point| point.coherence[output]));
    }
    MeasuredText {
        omega_rad_s: points.iter().map(|point| point.omega).collect(),
        re: response_array(points, |point, pair| point.response[pair].re),
        im: response_array(points, |point, pair| point.response[pair].im),
        coherence: Nested {
            shape: [outputs, points.len()],
            values: coherence,
        },
        partial_coherence: response_array(points, |point, pair| point.partial_coherence[pair]),
        sd_db: response_array(points, |point, pair| neper_to_db(point.sd(pair))),
        sd_deg: response_array(points, |point, pair| point.sd(pair).to_degrees()),
    }
}

/// Returns an array outputs x inputs x frequencies; `value` receives a frequency point and the
/// (output, input) index.
fn response_array(
    points: &[EstimatePoint],
    value: impl Fn(&EstimatePoint, (usize, usize)) -> f64,
) -> Nested<3> {
    let (outputs, inputs) = match points.first() {
        Some(point) => point.response.shape(),
        None => (0, 0),
    };
    let mut values = Vec::with_capacity(outputs * inputs * points.len());
    for output in 0..outputs {
        for input in 0..inputs {
            values.extend(points.iter().map(|point| value(point, (output, input))));
        }
    }
    Nested {
        shape: [outputs, inputs, points.len()],
        values,
    }
}

/// Converts a caution to JSON; `record` is null unless the caution concerns exactly one record.
fn caution_json(note: &CautionNote) -> Value {
    let single_record = match note.records.as_slice() {
        [record] => Some(record),
        _ => None,
    };
    json!({
        "code": note.code,
        "record": single_record,
        "records": note.records,
        "channel": note.channel,
        "pair": note.pair,
        "band_rad_s": note.band_rad_s,
        "text": note.text,
    })
}

/// Returns a pole, with its standard deviation in the complex plane.
fn pole_json(estimate: &PoleEstimate) -> Value {
    json!({
        "re": estimate.pole.re,
        "im": estimate.pole.im,
        "sd": estimate.sd_re.hypot(estimate.sd_im),
        "determined": estimate.determined,
    })
}

/// Describes the record at `index`: first and last time \[s\] of the part that forms it and of each
/// used segment, and in `why_not` its gaps, each with cause and treatment.
fn record_json(identification: &Identification, index: usize, record: &ConditionRecord) -> Value {
    let mut gaps = Vec::new();
    if let Some(used) = identification.record_uses.get(index) {
        for gap in &used.gaps {
            gaps.push(gap.to_string());
        }
    }
    let why_not = if gaps.is_empty() {
        None
    } else {
        Some(gaps.join("; "))
    };
    let text = json!({
        "name": record.name,
        "file": record.file,
        "sha256": record.sha256,
        "variable": record.variable,
        "held_out": record.held_out,
        "part_s": record.part_s,
        "used_s": record.used_s,
        "why_not": why_not,
    });
    without_empty(text, &["variable", "part_s"])
}

#[cfg(test)]
mod tests {
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
            order_fits: Vec::new(),
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
            information: None,
            advice: Vec::new(),
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
            identification: &found(),
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
    fn a_caution_names_its_record_or_both_channels_of_its_pair() {
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
