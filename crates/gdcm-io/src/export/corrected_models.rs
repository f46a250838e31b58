//! Corrected models as files: for MATLAB, for NumPy, and in the format `gdcm-models`.

use std::path::Path;

use nalgebra::DMatrix;

use gdcm_model::assembly::FoundModel;
use gdcm_model::assembly::found_model::Facts;
use gdcm_model::dataset::dataset_draft::ModelDraft;
use gdcm_model::dataset::model::Origin;
use gdcm_model::dataset::{Channel, Dataset};

use super::exported_model::{ExportedModel, contents_of_models, exported_models};
use super::matlab_values::{Fields, cell_of_texts, contained_parts, matrix, records};
use super::{ExportFormat, Exported};
use crate::export_fault::ExportFault;
use crate::files::export_contents::{ExportContents, PartSource};
use crate::files::model_collection::{
    ContainingModel, bare_draft, labels, write_containing_models,
};
use crate::formats::mat;
use crate::formats::npy::write_npz;
use crate::formats::variables::{TextArray, Value, Variable};

/// Export of corrected models; the file extension selects the format.
pub(super) const STATE_SPACE: ExportFormat = ExportFormat {
    name: "state-space",
    extension: "mat",
    words: "Corrected models in state-space form",
    options: &["--condition", "--model", "--correction", "--pade"],
    check_path: |path| ModelsFormat::from_path(path).map(drop),
    contents: |analysis, request| contents_of_models(analysis, request),
    export: |export| {
        let models = exported_models(export.analysis, export.request)?;
        let dataset = &export.analysis.study.dataset;
        let remarks = models.iter().map(ExportedModel::words).collect();
        let exported = match ModelsFormat::from_path(export.path)? {
            // Packed, because matrices with delays are mostly zeros.
            ModelsFormat::Mat => {
                Exported::bytes(mat::write_packed(&[models_variable(&models, dataset)])?)
            }
            ModelsFormat::Npz => Exported::bytes(write_npz(&model_arrays(&models, dataset))?),
            ModelsFormat::Json => {
                let models = containing_models(&models, dataset);
                Exported::new(move |file| write_containing_models(&models, file))
            }
        };
        Ok(exported.with(remarks))
    },
};

/// File format for corrected models.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum ModelsFormat {
    Mat,
    Json,
    Npz,
}

impl ModelsFormat {
    /// Chooses the format by the file extension; fails for an unknown extension.
    fn from_path(path: &Path) -> Result<Self, ExportFault> {
        let extension = path
            .extension()
            .and_then(|extension| extension.to_str())
            .unwrap_or_default();
        match extension.to_lowercase().as_str() {
            "mat" => Ok(Self::Mat),
            "json" => Ok(Self::Json),
            "npz" => Ok(Self::Npz),
            _ => Err(ExportFault::ModelsFormat),
        }
    }
}

/// Returns the models in the form of `gdcm-models`, each with a block `contains` that states the
/// parts of its correction. Names are of the form "condition 10, nominal"; the notes describe the
/// correction and its accuracy.
fn containing_models(models: &[ExportedModel], dataset: &Dataset) -> Vec<ContainingModel> {
    let mut containing = Vec::with_capacity(models.len());
    for model in models {
        containing.push(ContainingModel {
            model: found_model(model, dataset),
            contains: model.contents.json(dataset),
        });
    }
    containing
}

fn found_model(model: &ExportedModel, dataset: &Dataset) -> FoundModel {
    let name = format!("condition {}, {}", model.condition, model.name);
    FoundModel {
        draft: ModelDraft {
            matrices: matrices(model).map(|(_, matrix)| Some(matrix.clone())),
            timing: model.model.timing().clone(),
            states: model.states.clone(),
            ..bare_draft(name, Origin::Perturbed { perturbation: None })
        },
        inputs: labels(dataset.inputs()),
        outputs: labels(dataset.outputs()),
        facts: Facts {
            condition: Some(model.condition.0),
            airspeed_kt: Some(model.airspeed_kt),
            ..Facts::default()
        },
        notes: vec![model.words()],
    }
}

/// Returns the variable `models`: a struct for each model with the property names of MATLAB's `ss`,
/// so that `ss(m.A, m.B, m.C, m.D, m.Ts)` is the model.
fn models_variable(models: &[ExportedModel], dataset: &Dataset) -> Variable {
    Variable {
        name: "models".to_owned(),
        value: records(
            models
                .iter()
                .map(|model| model_fields(model, dataset))
                .collect(),
        ),
    }
}

fn model_fields(model: &ExportedModel, dataset: &Dataset) -> Fields {
    let mut fields = Fields::default();
    for (name, values) in matrices(model) {
        fields.add(name, array(values));
    }
    fields.add("InputName", names_of(dataset.inputs()));
    fields.add("OutputName", names_of(dataset.outputs()));
    fields.add("InputUnit", units_of(dataset.inputs()));
    fields.add("OutputUnit", units_of(dataset.outputs()));
    fields.add("StateName", cell_of_texts(model.states.iter().cloned()));
    for (name, metric) in METRICS {
        fields.add(name, Value::number(metric(model)));
    }
    fields.add("model", Value::text(&model.name));
    fields.add("correction", Value::text(model.correction));
    fields.add("contains", contained_parts(&model.contents, dataset));
    fields
}

fn names_of(channels: &[Channel]) -> Value {
    cell_of_texts(channels.iter().map(|channel| channel.name.clone()))
}

fn units_of(channels: &[Channel]) -> Value {
    cell_of_texts(channels.iter().map(|channel| channel.unit.clone()))
}

/// Name of a model metric in files, with the function that computes it.
type Metric = (&'static str, fn(&ExportedModel) -> f64);

const METRICS: [Metric; 8] = [
    ("Ts", sample_time_s),
    ("condition", |model| model.condition.0 as f64),
    ("airspeed_kt", |model| model.airspeed_kt),
    ("pade_order", |model| model.pade_order as f64),
    ("phase_error_deg", ExportedModel::phase_error_deg),
    ("band_top_rad_s", |model| model.band_top_rad_s),
    (
        "not_valid_above_rad_s",
        ExportedModel::not_valid_above_rad_s,
    ),
    ("gain_above_band_db", ExportedModel::gain_above_band_db),
];

/// Name of a part of a correction, with the function that returns its source.
type ContainedPart = (&'static str, fn(&ExportContents) -> PartSource);

const CONTAINED: [ContainedPart; 4] = [
    ("gains", |contents| contents.gains),
    ("delays", |contents| contents.delays),
    ("leads", |contents| contents.leads),
    ("couplings", |contents| contents.couplings),
];

/// Returns the models as arrays, because NumPy files hold nothing else: `A_0`, `B_0`, `C_0`, `D_0`
/// and `StateName_0` for model 0, and so on; each of the other arrays has an entry for each model
/// or channel.
fn model_arrays(models: &[ExportedModel], dataset: &Dataset) -> Vec<Variable> {
    let mut arrays = NamedArrays::default();
    for (place, model) in models.iter().enumerate() {
        for (name, values) in matrices(model) {
            arrays.add(format!("{name}_{place}"), array(values));
        }
        arrays.add(format!("StateName_{place}"), row_of_texts(&model.states));
    }
    for (side, channels) in [("Input", dataset.inputs()), ("Output", dataset.outputs())] {
        let names = row_of_texts(channels.iter().map(|channel| &channel.name));
        let units = row_of_texts(channels.iter().map(|channel| &channel.unit));
        arrays.add(format!("{side}Name"), names);
        arrays.add(format!("{side}Unit"), units);
    }
    for (name, metric) in METRICS {
        let values = models.iter().map(metric).collect();
        arrays.add(name.to_owned(), matrix(1, models.len(), values));
    }
    let names = row_of_texts(models.iter().map(|model| &model.name));
    arrays.add("model".to_owned(), names);
    let corrections = row_of_texts(models.iter().map(|model| model.correction));
    arrays.add("correction".to_owned(), corrections);
    for (name, source) in CONTAINED {
        let sources = row_of_texts(models.iter().map(|model| source(&model.contents).word()));
        arrays.add(format!("contains_{name}"), sources);
    }
    let left_out = row_of_texts(
        models
            .iter()
            .map(|model| model.contents.left_out_words(dataset).join("; ")),
    );
    arrays.add("contains_left_out".to_owned(), left_out);
    arrays.variables
}

/// Named arrays, in file order.
#[derive(Default)]
struct NamedArrays {
    variables: Vec<Variable>,
}

impl NamedArrays {
    fn add(&mut self, name: String, value: Value) {
        self.variables.push(Variable { name, value });
    }
}

/// Returns MATLAB's `Ts` \[s\]: 0 in continuous time.
fn sample_time_s(model: &ExportedModel) -> f64 {
    model.model.timing().sample_time_s.unwrap_or(0.0)
}

fn matrices(model: &ExportedModel) -> [(&'static str, &DMatrix<f64>); 4] {
    let model = &model.model;
    [
        ("A", model.a()),
        ("B", model.b()),
        ("C", model.c()),
        ("D", model.d()),
    ]
}

fn array(values: &DMatrix<f64>) -> Value {
    // Both libraries store matrices by columns.
    matrix(values.nrows(), values.ncols(), values.as_slice().to_vec())
}

fn row_of_texts<T: ToString>(texts: impl IntoIterator<Item = T>) -> Value {
    let texts: Vec<String> = texts.into_iter().map(|text| text.to_string()).collect();
    Value::Text(TextArray {
        shape: vec![1, texts.len()],
        texts,
    })
}

#[cfg(test)]
mod tests {
    use gdcm_method::correction;
    use gdcm_model::dataset::{BundleKind, ConditionId, Dynamics};
    use gdcm_model::progress::Unobserved;
    use gdcm_model::response::{FrequencyGrid, FrequencyResponse};
    use gdcm_study::decisions::setting;
    use gdcm_study::{AssessedCorrection, CouplingCorrection, Engine, PhaseCorrection, Study};

    use super::*;
    use crate::export::ExportRequest;
    use crate::files::dataset_file::embedded_example;
    use crate::files::export_contents::LeftOutPart;
    use crate::formats::zip_files::read_npz;
    use crate::reading_budget::ReadingBudget;

    #[test]
    fn a_delay_that_the_schedule_leaves_out_is_named_and_counts_as_an_error_of_phase() {
        let study = Study::new(embedded_example().unwrap().dataset);
        let analysis = Engine::default().analyze(&study, &Unobserved).unwrap();
        let models = exported_models(&analysis, &ExportRequest::default()).unwrap();
        let nx = correction::Channel::Output(3);
        for model in &models {
            let id = model.condition;
            let own_s = analysis.condition(id).unwrap().correction.pure_delay_s(nx);
            let [LeftOutPart::Delay(left_out)] = &model.contents.left_out[..] else {
                assert!(
                    model.contents.left_out.is_empty() && own_s < 5e-5,
                    "condition {id}: {own_s} s"
                );
                assert_eq!(model.phase_error_deg(), 0.0);
                assert!(
                    model.words().contains("gains exact, without delays"),
                    "{}",
                    model.words()
                );
                continue;
            };
            assert_eq!((id, left_out.channel), (ConditionId(4), nx));
            let phase_deg = (12.0 * own_s).to_degrees();
            assert!(
                (model.phase_error_deg() - phase_deg).abs() < 1e-9 && phase_deg > 0.1,
                "{phase_deg}"
            );
            assert!(
                model
                    .words()
                    .contains("are left out, which causes a phase error of up to"),
                "{}",
                model.words()
            );
        }
        let own = ExportRequest {
            correction: AssessedCorrection::Own,
            ..ExportRequest::default()
        };
        let own = exported_models(&analysis, &own).unwrap();
        assert!(
            own.iter()
                .all(|model| model.contents.left_out.is_empty() && model.left_out_deg == 0.0)
        );
        assert!(
            own.iter()
                .all(|model| model.contents.delays == PartSource::Own)
        );
    }

    #[test]
    fn numpy_and_matlab_get_the_same_matrices_and_names() {
        let study = Study::new(embedded_example().unwrap().dataset);
        let analysis = Engine::default().analyze(&study, &Unobserved).unwrap();
        let models = exported_models(&analysis, &ExportRequest::default()).unwrap();
        let meter = ReadingBudget::new(1 << 28);
        let arrays = read_npz(
            &write_npz(&model_arrays(&models, &study.dataset)).unwrap(),
            &meter,
        )
        .unwrap();
        let bytes = mat::write_packed(&[models_variable(&models, &study.dataset)]).unwrap();
        let [
            Variable {
                value: Value::Struct(records),
                ..
            },
        ] = &mat::read(&bytes, &meter).unwrap()[..]
        else {
            panic!("one struct array")
        };
        for (place, model) in models.iter().enumerate() {
            for name in ["A", "B", "C", "D"] {
                let found = arrays
                    .iter()
                    .find(|array| array.name == format!("{name}_{place}"))
                    .unwrap();
                assert_eq!(
                    found.value,
                    records.field(name).unwrap()[place],
                    "{name} of model {place}"
                );
            }
            assert_eq!(records.field("A").unwrap()[place], array(model.model.a()));
            let names = arrays
                .iter()
                .find(|array| array.name == format!("StateName_{place}"))
                .unwrap();
            assert_eq!(names.value, row_of_texts(model.states.iter()));
        }
        let airspeeds = arrays
            .iter()
            .find(|array| array.name == "airspeed_kt")
            .unwrap();
        let values = models.iter().map(|model| model.airspeed_kt).collect();
        assert_eq!(airspeeds.value, matrix(1, models.len(), values));
    }

    #[test]
    fn a_corrected_model_with_couplings_has_the_response_of_the_analysis() {
        let mut study = Study::new(embedded_example().unwrap().dataset);
        study
            .apply(&setting::PHASE.to(PhaseCorrection::None))
            .unwrap();
        study
            .apply(&setting::COUPLINGS.to(CouplingCorrection::MixingAndFeedback))
            .unwrap();
        let analysis = Engine::default().analyze(&study, &Unobserved).unwrap();
        let own = ExportRequest {
            correction: AssessedCorrection::Own,
            ..ExportRequest::default()
        };
        let grid = FrequencyGrid::logarithmic(study.settings.band, 12);
        for model in exported_models(&analysis, &own).unwrap() {
            assert!(
                model.words().contains("with mixing and feedback, exact"),
                "{}",
                model.words()
            );
            let result = analysis.condition(model.condition).unwrap();
            let bundle = result.condition.bundle(BundleKind::Physics);
            let physics = FrequencyResponse::from_dynamics(
                &bundle[result.condition.nominal()].dynamics,
                &grid,
            );
            let coupled = result.coupled_response(&physics);
            let found =
                FrequencyResponse::from_dynamics(&Dynamics::StateSpace(model.model.clone()), &grid);
            for (pair, curve) in coupled.curves().iter() {
                let gain = result.correction.net_gain(pair);
                let largest = curve.iter().map(|value| value.norm()).fold(0.0, f64::max) * gain;
                for (found, expected) in found.curve(pair).iter().zip(curve) {
                    // The exported model closes the loop in the states, the reference at each
                    // frequency.
                    assert!(
                        (found - expected * gain).norm() <= 1e-9 * largest,
                        "{pair:?} of {}",
                        model.condition
                    );
                }
            }
        }
    }
}
