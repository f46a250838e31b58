//! Models as they were found, `gdcm-models` 1: what `gdcm convert` writes.

use std::io::{self, Write};
use std::path::Path;

use serde::Serialize;

use gdcm_core::assembly::{ChannelLabel, FoundModel};
use gdcm_core::dataset::{Origin, ResponseArray};

use super::file_error::FileError;
use super::output_set::OutputSet;
use crate::json_text::Nested;

const FORMAT: &str = "gdcm-models";
const VERSION: u64 = 1;

#[derive(Serialize)]
struct ModelsText<'m> {
    format: &'static str,
    version: u64,
    models: Vec<ModelText<'m>>,
}

#[derive(Serialize)]
pub(super) struct ModelText<'m> {
    name: &'m str,
    #[serde(skip_serializing_if = "Option::is_none")]
    method: Option<&'m str>,
    #[serde(skip_serializing_if = "Option::is_none")]
    order: Option<usize>,
    /// Names; empty where the file has none.
    inputs: Vec<&'m str>,
    outputs: Vec<&'m str>,
    input_units: Vec<&'m str>,
    output_units: Vec<&'m str>,
    #[serde(skip_serializing_if = "<[_]>::is_empty")]
    states: &'m [String],
    #[serde(flatten)]
    matrices: Option<MatricesText>,
    #[serde(skip_serializing_if = "Option::is_none")]
    sample_time_s: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    input_delays_s: Option<&'m [f64]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    output_delays_s: Option<&'m [f64]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    frequency_response: Option<ResponseText<'m>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    bands: Option<BandsText<'m>>,
    source: SourceText<'m>,
    #[serde(skip_serializing_if = "<[_]>::is_empty")]
    notes: &'m [String],
}

#[derive(Serialize)]
#[serde(rename_all = "UPPERCASE")]
struct MatricesText {
    a: Nested<2>,
    b: Nested<2>,
    c: Nested<2>,
    d: Nested<2>,
}

#[derive(Serialize)]
struct ResponseText<'m> {
    omega_rad_s: &'m [f64],
    re: Nested<3>,
    im: Nested<3>,
    #[serde(skip_serializing_if = "Option::is_none")]
    coherence: Option<Nested<3>>,
}

#[derive(Serialize)]
struct SourceText<'m> {
    #[serde(skip_serializing_if = "Option::is_none")]
    file: Option<&'m str>,
    #[serde(skip_serializing_if = "Option::is_none")]
    sha256: Option<&'m str>,
    #[serde(skip_serializing_if = "Option::is_none")]
    variable: Option<&'m str>,
    #[serde(skip_serializing_if = "Option::is_none")]
    made: Option<&'m str>,
    #[serde(skip_serializing_if = "<[_]>::is_empty")]
    records: &'m [String],
}

#[derive(Serialize)]
struct BandsText<'m> {
    omega_rad_s: &'m [f64],
    sd_db: Nested<3>,
    sd_deg: Nested<3>,
}

/// Adds the models as a file to `outputs`.
pub fn add_models(models: &[FoundModel], path: &Path, outputs: &mut OutputSet) -> Result<(), FileError> {
    outputs.add(path, |file| write_models(models, file))
}

/// Writes the text of that file.
pub(super) fn write_models(models: &[FoundModel], file: &mut dyn Write) -> io::Result<()> {
    let text = ModelsText { format: FORMAT, version: VERSION, models: models.iter().map(model_text).collect() };
    serde_json::to_writer(&mut *file, &text)?;
    file.write_all(b"\n")
}

/// The text of a model, entry by entry.
pub(super) fn model_text(model: &FoundModel) -> ModelText<'_> {
    fn part<'m>(labels: &'m [ChannelLabel], of: impl Fn(&'m ChannelLabel) -> &'m Option<String>) -> Vec<&'m str> {
        labels.iter().map(|label| of(label).as_deref().unwrap_or_default()).collect()
    }
    let draft = &model.draft;
    let (method, order) = match &draft.origin {
        Origin::Identified { method, order } => (method.as_deref(), *order),
        Origin::Nominal { .. } | Origin::Perturbed { .. } => (None, None),
    };
    let matrices = match &draft.matrices {
        [Some(a), Some(b), Some(c), Some(d)] => {
            let [a, b, c, d] = [a, b, c, d].map(Nested::of_matrix);
            Some(MatricesText { a, b, c, d })
        }
        _ => None,
    };
    let array = |array: &ResponseArray| Nested { shape: array.shape, values: array.values.clone() };
    ModelText {
        name: if draft.name.is_empty() { model.file() } else { &draft.name },
        method,
        order,
        inputs: part(&model.inputs, |label| &label.name),
        outputs: part(&model.outputs, |label| &label.name),
        input_units: part(&model.inputs, |label| &label.unit),
        output_units: part(&model.outputs, |label| &label.unit),
        states: &draft.states,
        matrices,
        sample_time_s: draft.timing.sample_time_s,
        input_delays_s: draft.timing.input_delays_s.as_deref(),
        output_delays_s: draft.timing.output_delays_s.as_deref(),
        frequency_response: draft.response.as_ref().map(|response| ResponseText {
            omega_rad_s: &response.omega,
            re: array(&response.re),
            im: array(&response.im),
            coherence: response.coherence.as_ref().map(array),
        }),
        bands: draft.bands.as_ref().map(|bands| BandsText {
            omega_rad_s: &bands.omega,
            sd_db: array(&bands.sd_db),
            sd_deg: array(&bands.sd_deg),
        }),
        source: SourceText {
            file: draft.source.as_ref().and_then(|source| source.file.as_deref()),
            sha256: draft.source.as_ref().and_then(|source| source.sha256.as_deref()),
            variable: draft.source.as_ref().and_then(|source| source.variable.as_deref()),
            made: draft.source.as_ref().and_then(|source| source.made.as_deref()),
            records: draft.source.as_ref().map(|source| source.records.as_slice()).unwrap_or_default(),
        },
        notes: &model.notes,
    }
}
