//! Models identified from flight records, `gdcm-identified` 1: what `gdcm identify` writes.

use std::path::Path;

use nalgebra::Complex;
use serde::Serialize;

use gdcm_core::assembly::FoundModel;
use gdcm_core::dataset::PairTable;

use super::file_error::FileError;
use super::models_file::{IDENTIFIED, model_text};
use super::output_set::OutputSet;
use crate::dataset_file::ModelText;
use crate::json_text::Nested;

/// What identification found, in the records' own units.
#[derive(Clone, Debug, Default)]
pub struct IdentifiedModels {
    /// The models, the recommended one first.
    pub models: Vec<FoundModel>,
    /// The measured response, where there is one.
    pub measured: Option<MeasuredEstimate>,
    /// The poles of the recommended model.
    pub poles: Vec<PoleEstimate>,
    /// How well the recommended model holds.
    pub validation: IdentifiedValidation,
    /// The records, in order.
    pub records: Vec<RecordReport>,
    /// What is to be minded, in words.
    pub cautions: Vec<String>,
}

/// The non-parametric estimate of the response.
#[derive(Clone, Debug, PartialEq)]
pub struct MeasuredEstimate {
    /// Frequencies \[rad/s\].
    pub omega: Vec<f64>,
    /// Response, a value for each frequency.
    pub values: PairTable<Vec<Complex<f64>>>,
    /// Multiple coherence of each output, a value for each frequency.
    pub coherence: Vec<Vec<f64>>,
    /// Partial coherence of each response.
    pub partial_coherence: PairTable<Vec<f64>>,
    /// Standard deviation of the magnitude \[dB\].
    pub sd_db: PairTable<Vec<f64>>,
    /// Standard deviation of the phase \[deg\].
    pub sd_deg: PairTable<Vec<f64>>,
}

/// A pole and how surely it is known.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct PoleEstimate {
    /// Real part \[rad/s\].
    pub re: f64,
    /// Imaginary part \[rad/s\].
    pub im: f64,
    /// Standard deviation \[rad/s\].
    pub sd: f64,
    /// Whether the records determine it.
    pub determined: bool,
}

/// How well a model holds against the records that it was made of, and against those that were held out.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct IdentifiedValidation {
    /// Cost over its degrees of freedom of the records used.
    pub fit_per_dof: Option<f64>,
    /// The same of the records held out; none where there are none.
    pub held_out_per_dof: Option<f64>,
    /// Share of each output of the held-out records that the model reproduces in time \[%\], in the order of the outputs.
    pub fit_percent: Vec<f64>,
    /// Theil's coefficient of each output of the held-out records.
    pub theil: Vec<f64>,
}

/// What was done with a record.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct RecordReport {
    /// Its name.
    pub name: String,
    /// Its file.
    pub file: String,
    /// SHA-256 of the file.
    pub sha256: String,
    /// Which record of the file.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub variable: Option<String>,
    /// Whether it was held out.
    pub held_out: bool,
    /// First and last time \[s\] of each piece that was used.
    pub used_s: Vec<[f64; 2]>,
    /// Why it, or a part of it, was not used.
    pub why_not: Option<String>,
}

#[derive(Serialize)]
struct IdentifiedText<'m> {
    format: &'static str,
    version: u64,
    models: Vec<ModelText>,
    measured: Option<MeasuredText<'m>>,
    poles: &'m [PoleEstimate],
    validation: &'m IdentifiedValidation,
    records: &'m [RecordReport],
    cautions: &'m [String],
}

#[derive(Serialize)]
struct MeasuredText<'m> {
    omega_rad_s: &'m [f64],
    re: Nested<3>,
    im: Nested<3>,
    coherence: &'m [Vec<f64>],
    partial_coherence: Nested<3>,
    sd_db: Nested<3>,
    sd_deg: Nested<3>,
}

/// Adds what identification found as a file to `outputs`; figures that are not finite become `null`.
pub fn add_identified(found: &IdentifiedModels, path: &Path, outputs: &mut OutputSet) -> Result<(), FileError> {
    let models = found.models.iter().enumerate();
    let text = IdentifiedText {
        format: IDENTIFIED.name,
        version: IDENTIFIED.version,
        models: models.map(|(index, model)| ModelText { recommended: Some(index == 0), ..model_text(model) }).collect(),
        measured: found.measured.as_ref().map(measured_text),
        poles: &found.poles,
        validation: &found.validation,
        records: &found.records,
        cautions: &found.cautions,
    };
    outputs.add(path, |file| {
        serde_json::to_writer(&mut *file, &text)?;
        file.write_all(b"\n")
    })
}

fn measured_text(measured: &MeasuredEstimate) -> MeasuredText<'_> {
    let count = measured.omega.len();
    let table = |table: &PairTable<Vec<f64>>| Nested {
        shape: [table.outputs(), table.inputs(), count],
        values: table.iter().flat_map(|(_, values)| values.iter().copied()).collect(),
    };
    let part = |of: fn(&Complex<f64>) -> f64| table(&measured.values.map(|_, values| values.iter().map(of).collect()));
    MeasuredText {
        omega_rad_s: &measured.omega,
        re: part(|value| value.re),
        im: part(|value| value.im),
        coherence: &measured.coherence,
        partial_coherence: table(&measured.partial_coherence),
        sd_db: table(&measured.sd_db),
        sd_deg: table(&measured.sd_deg),
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::DMatrix;

    use super::*;
    use crate::{Existing, models_of_bytes};
    use gdcm_core::assembly::{ChannelLabel, Facts};
    use gdcm_core::dataset::{BandsDraft, ModelDraft, Origin, Pair, Provenance, ResponseArray, Timing};

    fn model(name: &str, gain: f64) -> FoundModel {
        let scalar = |value| Some(DMatrix::from_element(1, 1, value));
        let label = |name: &str, unit: &str| ChannelLabel { name: Some(name.into()), unit: Some(unit.into()) };
        let array = |value| ResponseArray { shape: [1, 1, 2], values: vec![value; 2] };
        FoundModel {
            draft: ModelDraft {
                name: name.into(),
                origin: Origin::Identified { method: Some("CT-PBSID".into()), order: Some(1) },
                matrices: [scalar(-1.0), scalar(gain), scalar(1.0), scalar(0.0)],
                timing: Timing::default(),
                response: None,
                source: Some(Provenance { records: vec!["LON 1".into()], ..Provenance::default() }),
                states: Vec::new(),
                bands: Some(BandsDraft { omega: vec![1.0, 2.0], sd_db: array(0.5), sd_deg: array(3.0) }),
            },
            inputs: vec![label("LON", "%")],
            outputs: vec![label("Q", "deg/s")],
            facts: Facts::default(),
            notes: Vec::new(),
        }
    }

    fn written(found: &IdentifiedModels) -> Vec<u8> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("identified.json");
        let mut outputs = OutputSet::new(Existing::Keep, Vec::new());
        add_identified(found, &path, &mut outputs).unwrap();
        outputs.persist().unwrap();
        std::fs::read(path).unwrap()
    }

    #[test]
    fn every_key_of_the_format_is_written_and_the_recommended_model_comes_first() {
        let mut values = PairTable::filled(1, 1, vec![Complex::new(1.0, -2.0); 2]);
        values[Pair::new(0, 0)][1].im = f64::NAN;
        let table = |value: f64| PairTable::filled(1, 1, vec![value; 2]);
        let measured = MeasuredEstimate {
            omega: vec![1.0, 2.0],
            values,
            coherence: vec![vec![0.9, 0.8]],
            partial_coherence: table(0.7),
            sd_db: table(0.1),
            sd_deg: table(1.0),
        };
        let found = IdentifiedModels {
            models: vec![model("CT-PBSID, refined", 2.0), model("CT-PBSID", 3.0)],
            measured: Some(measured),
            poles: vec![PoleEstimate { re: -1.0, im: 0.0, sd: 0.1, determined: true }],
            validation: IdentifiedValidation { fit_per_dof: Some(1.02), ..IdentifiedValidation::default() },
            records: vec![RecordReport { name: "LON 1".into(), used_s: vec![[0.0, 60.0]], ..RecordReport::default() }],
            cautions: vec!["PED was not swept: its column is not identified".into()],
        };
        let bytes = written(&found);
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
        assert_eq!(text["records"][0]["used_s"], serde_json::json!([[0.0, 60.0]]));
        assert_eq!(text["cautions"][0], "PED was not swept: its column is not identified");
    }

    #[test]
    fn the_models_are_found_again_in_the_file() {
        let found = IdentifiedModels { models: vec![model("a", 2.0), model("b", 3.0)], ..IdentifiedModels::default() };
        let again = models_of_bytes(&written(&found), "identified.json", 1 << 24).unwrap();
        let gains: Vec<f64> =
            again.models.iter().map(|model| model.draft.matrices[1].as_ref().unwrap()[(0, 0)]).collect();
        assert_eq!((gains, again.faults), (vec![2.0, 3.0], Vec::<String>::new()));
        assert_eq!(again.models[0].outputs[0], ChannelLabel { name: Some("Q".into()), unit: Some("deg/s".into()) });
    }
}
