//! Models identified from flight records, `gdcm-identified` 1: what `gdcm identify` writes.

use std::iter::once;
use std::path::Path;

use serde::Serialize;

use gdcm_core::assembly::{ChannelLabel, ChannelRule, Facts, FoundModel};
use gdcm_core::dataset::{ConditionRecord, ModelDraft};
use gdcm_core::identification::{CautionNote, EstimatePoint, Identification, PoleEstimate, ResponseEstimate};
use gdcm_core::records::RecordChannels;
use gdcm_core::units::neper_to_db;

use super::file_error::FileError;
use super::models_file::{IDENTIFIED, model_text};
use super::output_set::OutputSet;
use crate::dataset_file::ModelText;
use crate::json_text::{Nested, write_compact};

/// What an identification found, with what its file says beside it.
pub struct IdentifiedModels<'f> {
    /// What was found, in the units of the channels.
    pub found: &'f Identification,
    /// The channels.
    pub channels: &'f RecordChannels,
    /// The records, in order.
    pub records: &'f [ConditionRecord],
    /// What is to be minded.
    pub cautions: &'f [CautionNote],
    /// What was assumed and what was done while the records were read.
    pub reading: &'f [String],
}

#[derive(Serialize)]
struct IdentifiedText<'m> {
    format: &'static str,
    version: u64,
    models: Vec<ModelText>,
    measured: MeasuredText,
    poles: Vec<PoleText>,
    validation: ValidationText<'m>,
    records: Vec<RecordText<'m>>,
    cautions: Vec<CautionText<'m>>,
    reading: &'m [String],
}

#[derive(Serialize)]
struct CautionText<'m> {
    code: &'static str,
    /// The one that it is about.
    record: Option<&'m str>,
    /// All that it is about.
    records: &'m [String],
    channel: Option<&'m str>,
    /// Output and input.
    pair: Option<&'m [String; 2]>,
    band_rad_s: Option<[f64; 2]>,
    text: &'m str,
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

#[derive(Serialize)]
struct PoleText {
    re: f64,
    im: f64,
    sd: f64,
    determined: bool,
}

#[derive(Serialize)]
struct ValidationText<'m> {
    /// Cost over its degrees of freedom of the records of the fit, and of those held out.
    fit_per_dof: f64,
    held_out_per_dof: Option<f64>,
    /// The same where the model may move within its own uncertainty.
    held_out_normalised: Option<f64>,
    /// Share of each output of the held-out records that the model reproduces in time \[%\], and Theil's coefficient of it.
    fit_percent: &'m [Option<f64>],
    theil: &'m [Option<f64>],
}

#[derive(Serialize)]
struct RecordText<'m> {
    name: &'m str,
    file: &'m str,
    sha256: Option<&'m str>,
    #[serde(skip_serializing_if = "Option::is_none")]
    variable: Option<&'m str>,
    held_out: bool,
    /// First and last time of the part of what the file holds that is the record.
    #[serde(skip_serializing_if = "Option::is_none")]
    part_s: Option<[f64; 2]>,
    /// First and last time of each part that was used.
    used_s: &'m [[f64; 2]],
    /// Why a part of it was not used.
    why_not: Option<String>,
}

/// Adds what identification found as a file to `outputs`: the recommended model first, then CT-PBSID without refinement, then the
/// rest of the bundle; values that are not finite become `null`.
pub fn add_identified(of: &IdentifiedModels, path: &Path, outputs: &mut OutputSet) -> Result<(), FileError> {
    let found = of.found;
    let label = |rule: &ChannelRule| ChannelLabel {
        name: Some(rule.name.clone()),
        unit: Some(rule.unit.clone()).filter(|unit| !unit.is_empty()),
    };
    let models = once(&found.refined).chain(once(&found.unrefined)).chain(&found.bundle).map(|model| FoundModel {
        draft: ModelDraft::of(model),
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
            .map(|(index, model)| ModelText { recommended: Some(index == 0), ..model_text(model) })
            .collect(),
        measured: measured_text(&found.measured),
        poles: found.poles.iter().map(pole_text).collect(),
        validation: ValidationText {
            fit_per_dof: found.cost,
            held_out_per_dof: found.held_out_cost,
            held_out_normalised: found.held_out_normalised,
            fit_percent: in_time.map_or(&[], |of| &of.fit_percent),
            theil: in_time.map_or(&[], |of| &of.theil),
        },
        records: of.records.iter().enumerate().map(|(index, record)| record_text(found, index, record)).collect(),
        cautions: of.cautions.iter().map(caution_text).collect(),
        reading: of.reading,
    };
    outputs.add(path, |file| write_compact(&text, file))
}

fn measured_text(measured: &ResponseEstimate) -> MeasuredText {
    let points = &measured.points;
    let (outputs, inputs) = points.first().map_or((0, 0), |point| point.response.shape());
    let table = |value: &dyn Fn(&EstimatePoint, (usize, usize)) -> f64| {
        let pairs = (0..outputs).flat_map(|output| (0..inputs).map(move |input| (output, input)));
        let values = pairs.flat_map(|pair| points.iter().map(move |point| value(point, pair))).collect();
        Nested { shape: [outputs, inputs, points.len()], values }
    };
    let coherence = (0..outputs).flat_map(|output| points.iter().map(move |point| point.coherence[output])).collect();
    MeasuredText {
        omega_rad_s: points.iter().map(|point| point.omega).collect(),
        re: table(&|point, pair| point.response[pair].re),
        im: table(&|point, pair| point.response[pair].im),
        coherence: Nested { shape: [outputs, points.len()], values: coherence },
        partial_coherence: table(&|point, pair| point.partial_coherence[pair]),
        sd_db: table(&|point, pair| neper_to_db(point.sd(pair))),
        sd_deg: table(&|point, pair| point.sd(pair).to_degrees()),
    }
}

fn caution_text(of: &CautionNote) -> CautionText<'_> {
    CautionText {
        code: of.code,
        record: if let [one] = of.records.as_slice() { Some(one) } else { None },
        records: &of.records,
        channel: of.channel.as_deref(),
        pair: of.pair.as_ref(),
        band_rad_s: of.band_rad_s,
        text: &of.text,
    }
}

fn pole_text(of: &PoleEstimate) -> PoleText {
    PoleText { re: of.pole.re, im: of.pole.im, sd: of.sd_re.hypot(of.sd_im), determined: of.determined }
}

fn record_text<'m>(found: &Identification, index: usize, record: &'m ConditionRecord) -> RecordText<'m> {
    let gaps = found.record_uses.get(index).into_iter().flat_map(|used| &used.gaps);
    let gaps: Vec<String> = gaps.map(ToString::to_string).collect();
    RecordText {
        name: &record.name,
        file: &record.file,
        sha256: record.sha256.as_deref(),
        variable: record.variable.as_deref(),
        held_out: record.held_out,
        part_s: record.part_s,
        used_s: &record.used_s,
        why_not: Some(gaps.join("; ")).filter(|words| !words.is_empty()),
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use nalgebra::{Complex, DMatrix, DVector};

    use super::*;
    use crate::{Existing, models_of_bytes};
    use gdcm_core::dataset::{Dynamics, Model, ModelBands, Origin, PairTable, Provenance, StateSpace};

    fn model(name: &str, gain: f64) -> Model {
        let scalar = |value| DMatrix::from_element(1, 1, value);
        let dynamics = StateSpace::new(scalar(-1.0), scalar(gain), scalar(1.0), scalar(0.0)).unwrap();
        let origin = Origin::Identified { method: Some("CT-PBSID".into()), order: Some(1) };
        let table = |value: f64| PairTable::filled(1, 1, vec![value; 2]);
        Model {
            source: Some(Provenance { records: vec!["LON 1".into()], ..Provenance::default() }),
            bands: Some(Arc::new(ModelBands::new(vec![1.0, 2.0], table(0.5), table(3.0)).unwrap())),
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
        let pole = PoleEstimate { pole: Complex::from(-1.0), sd_re: 0.1, sd_im: 0.0, determined: true };
        Identification {
            refined: model("CT-PBSID, refined", 2.0),
            unrefined: model("CT-PBSID", 3.0),
            bundle: Vec::new(),
            measured: ResponseEstimate { points: vec![point(1.0, -2.0, 0.9), point(2.0, f64::NAN, 0.8)] },
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
        let rule = |name: &str, unit: &str| ChannelRule { unit: unit.into(), ..ChannelRule::named(name) };
        let (inputs, outputs) = (vec![rule("LON", "%")], vec![rule("Q", "deg/s")]);
        let channels = RecordChannels { inputs, outputs, ..RecordChannels::default() };
        let record = ConditionRecord { used_s: vec![[0.0, 60.0]], ..ConditionRecord::new("LON 1", "lon_1.csv") };
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("identified.json");
        let mut outputs = OutputSet::new(Existing::Keep, Vec::new());
        let models =
            IdentifiedModels { found: &found(), channels: &channels, records: &[record], cautions, reading: &[] };
        add_identified(&models, &path, &mut outputs).unwrap();
        outputs.persist().unwrap();
        std::fs::read(path).unwrap()
    }

    #[test]
    fn every_key_of_the_format_is_written_and_the_recommended_model_comes_first() {
        let text = "PED was not swept: its column is not identified".to_owned();
        let bytes =
            written(&[CautionNote { code: "not-swept", channel: Some("PED".into()), text, ..CautionNote::default() }]);
        let text: serde_json::Value = serde_json::from_slice(&bytes).unwrap();
        assert_eq!((&text["format"], &text["version"]), (&"gdcm-identified".into(), &1.into()));
        assert_eq!(
            (&text["models"][0]["recommended"], &text["models"][1]["recommended"]),
            (&true.into(), &false.into())
        );
        assert_eq!(text["models"][0]["bands"]["sd_deg"], serde_json::json!([[[3.0, 3.0]]]));
        assert_eq!(text["models"][0]["source"]["records"], serde_json::json!(["LON 1"]));
        assert_eq!(text["models"][0]["order"], 1);
        assert_eq!(text["measured"]["im"], serde_json::json!([[[-2.0, null]]]));
        assert_eq!(text["measured"]["coherence"], serde_json::json!([[0.9, 0.8]]));
        assert_eq!(
            (&text["poles"][0]["sd"], &text["validation"]["held_out_per_dof"]),
            (&0.1.into(), &serde_json::Value::Null)
        );
        assert_eq!(text["validation"]["fit_percent"], serde_json::json!([]));
        assert_eq!(text["records"][0]["used_s"], serde_json::json!([[0.0, 60.0]]));
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
            let bytes = written(&[CautionNote { code: "record", records, ..CautionNote::default() }]);
            let text: serde_json::Value = serde_json::from_slice(&bytes).unwrap();
            (text["cautions"][0]["record"].clone(), text["cautions"][0]["records"].clone())
        };
        assert_eq!(of(&["lat_1"]), ("lat_1".into(), serde_json::json!(["lat_1"])));
        assert_eq!(of(&["lat_1", "lat_2"]), (serde_json::Value::Null, serde_json::json!(["lat_1", "lat_2"])));
    }

    #[test]
    fn the_models_are_found_again_in_the_file() {
        let again =
            models_of_bytes(&written(&[]), "identified.json", &crate::variables::ReadingBudget::new(1 << 24)).unwrap();
        let gains: Vec<f64> =
            again.models.iter().map(|model| model.draft.matrices[1].as_ref().unwrap()[(0, 0)]).collect();
        assert_eq!((gains, again.faults), (vec![2.0, 3.0], Vec::<String>::new()));
        assert_eq!(again.models[0].outputs[0], ChannelLabel { name: Some("Q".into()), unit: Some("deg/s".into()) });
    }
}
