//! Corrected models as files: for MATLAB, for NumPy, and in the format `gdcm-models`.
//!
//! A corrected model has the matrices of `M_O H~ M_I` (M10, M16): a physics model with its
//! couplings, and the gains, delays and leads of its channels. `requested_models` computes the
//! models, `metrics` the values beside the matrices, and `export_notes` the notes on their
//! accuracy. *Remarks* are lines of text for the command line, *notes* facts for the list of files.

mod matlab;
mod metrics;
mod numpy;

use std::path::Path;

use gdcm_model::assembly::FoundModel;
use gdcm_model::assembly::found_model::Facts;
use gdcm_model::dataset::Dataset;
use gdcm_model::dataset::dataset_draft::ModelDraft;
use gdcm_model::dataset::model::Origin;
use gdcm_study::Analysis;
use gdcm_study::results::export_note::FileSummary;

use self::matlab::models_variable;
use self::metrics::matrices;
use self::numpy::model_arrays;
use super::export_notes::model_notes;
use super::exported_model::ExportedModel;
use super::file_head::variables_head;
use super::requested_models::{contents_of_models, exported_models};
use super::{Export, ExportFormat, ExportRequest, Exported, FormatGroup};
use crate::export_fault::ExportFault;
use crate::files::model_collection::{
    ModelWithContents, bare_draft, labels, write_models_with_contents,
};
use crate::formats::mat;
use crate::formats::npy::write_npz;

const OPTIONS: &[&str] = &["--condition", "--model", "--correction", "--pade"];

/// Export of corrected models; the file extension selects the format.
pub(super) const STATE_SPACE: ExportFormat = ExportFormat {
    name: "state-space",
    extension: "mat",
    stem: "models",
    group: FormatGroup::Models,
    title: "Corrected, state space",
    words: "Corrected models in state-space form, MATLAB data",
    options: OPTIONS,
    check_path: |path| ModelsFormat::from_path(path).map(drop),
    correction_parts: |analysis, request| contents_of_models(analysis, request),
    export: export_models,
};

pub(super) const NUMPY: ExportFormat = ExportFormat {
    name: "state-space-npz",
    extension: "npz",
    words: "Corrected models in state-space form, for NumPy",
    check_path: |path| check_models_format(path, ModelsFormat::Npz),
    ..STATE_SPACE
};

pub(super) const JSON: ExportFormat = ExportFormat {
    name: "state-space-json",
    extension: "json",
    words: "Corrected models in state-space form, JSON",
    check_path: |path| check_models_format(path, ModelsFormat::Json),
    ..STATE_SPACE
};

fn check_models_format(path: &Path, expected: ModelsFormat) -> Result<(), ExportFault> {
    if ModelsFormat::from_path(path)? == expected {
        Ok(())
    } else {
        Err(ExportFault::ModelsFormat {
            expected: expected.extension(),
        })
    }
}

/// Returns the requested corrected models as text in the format `gdcm-models`.
///
/// # Errors
/// The analysis lacks a requested model or correction, or a model cannot be written as matrices.
pub fn corrected_models_json(
    analysis: &Analysis,
    request: &ExportRequest,
) -> Result<Vec<u8>, ExportFault> {
    let models = exported_models(analysis, request)?;
    let models = models_with_contents(&models, &analysis.study.dataset);
    let mut bytes = Vec::new();
    write_models_with_contents(&models, &mut bytes).map_err(|error| ExportFault::Contents {
        reason: error.to_string(),
    })?;
    Ok(bytes)
}

fn export_models<'e>(export: &Export<'e>) -> Result<Exported<'e>, ExportFault> {
    let models = exported_models(export.analysis, export.request)?;
    let dataset = &export.analysis.study.dataset;
    let remarks = models.iter().map(ExportedModel::words).collect();
    let notes = model_notes(export, &models);
    let added_states = models
        .iter()
        .map(|model| model.delay_states + model.lead_states);
    let summary = FileSummary::Models {
        models: models.len(),
        added_states: added_states.max().unwrap_or_default(),
    };
    let exported = match ModelsFormat::from_path(export.path)? {
        ModelsFormat::Mat => {
            let variables = [models_variable(&models, dataset)];
            // Packed, because matrices with delays are mostly zeros.
            Exported::bytes(summary, mat::write_packed(&variables)?)
                .with_head(variables_head(&variables))
        }
        ModelsFormat::Npz => {
            let variables = model_arrays(&models, dataset);
            Exported::bytes(summary, write_npz(&variables)?).with_head(variables_head(&variables))
        }
        ModelsFormat::Json => {
            let models = models_with_contents(&models, dataset);
            Exported::new(summary, move |file| {
                write_models_with_contents(&models, file)
            })
        }
    };
    Ok(exported.with_remarks(remarks).with_notes(notes))
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum ModelsFormat {
    Mat,
    Json,
    Npz,
}

impl ModelsFormat {
    fn extension(self) -> &'static str {
        match self {
            Self::Mat => ".mat",
            Self::Json => ".json",
            Self::Npz => ".npz",
        }
    }

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
            _ => Err(ExportFault::ModelsFormat {
                expected: ".mat, .json or .npz",
            }),
        }
    }
}

/// Returns the models in the form of `gdcm-models`, each with a block `contains` that states its
/// correction parts. Names have the form "condition 10, nominal"; the notes describe the correction
/// and its accuracy.
fn models_with_contents(models: &[ExportedModel], dataset: &Dataset) -> Vec<ModelWithContents> {
    let mut with_contents = Vec::with_capacity(models.len());
    for model in models {
        with_contents.push(ModelWithContents {
            model: found_model(model, dataset),
            contains: model.contents.json(dataset),
        });
    }
    with_contents
}

/// Returns a corrected model in the form used for models found in files.
fn found_model(model: &ExportedModel, dataset: &Dataset) -> FoundModel {
    let name = format!("condition {}, {}", model.condition, model.name);
    FoundModel {
        draft: ModelDraft {
            // A, B, C and D.
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

#[cfg(test)]
mod tests {
    use gdcm_method::correction;
    use gdcm_model::dataset::{BundleKind, ConditionId, Dynamics};
    use gdcm_model::progress::Unobserved;
    use gdcm_model::response::{FrequencyGrid, FrequencyResponse};
    use gdcm_model::units::telling;
    use gdcm_study::decisions::physics_settings::ParameterDecision;
    use gdcm_study::decisions::setting_table;
    use gdcm_study::{
        AssessedCorrection, CouplingCorrection, Edit, Engine, PhaseCorrection, PhysicsCorrection,
        Study,
    };

    use super::metrics::array;
    use super::numpy::row_of_texts;
    use super::*;
    use crate::export::ExportRequest;
    use crate::export::exported_model::{ModelAccuracy, ModelCouplings};
    use crate::export::matlab_values::matrix;
    use crate::files::dataset_file::embedded_example;
    use crate::files::export_contents::{LeftOutPart, PartSource};
    use crate::formats::variables::{Value, Variable};
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
                assert_eq!(model.accuracy(), ModelAccuracy::WithoutDelays);
                continue;
            };
            assert_eq!((id, left_out.channel), (ConditionId(4), nx));
            let phase_deg = (12.0 * own_s).to_degrees();
            assert!(
                (model.phase_error_deg() - phase_deg).abs() < 1e-9 && phase_deg > 0.1,
                "{phase_deg}"
            );
            let error_deg = format!(" {} deg", telling(model.omitted_delay_deg, 3));
            assert!(model.words().contains(&error_deg), "{}", model.words());
        }
        let own = ExportRequest {
            correction: AssessedCorrection::Own,
            ..ExportRequest::default()
        };
        let own = exported_models(&analysis, &own).unwrap();
        assert!(
            own.iter()
                .all(|model| model.contents.left_out.is_empty() && model.omitted_delay_deg == 0.0)
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
    fn exported_matrices_are_those_at_the_values_of_the_physics_parameters() {
        let path = concat!(
            env!("CARGO_MANIFEST_DIR"),
            "/../../tests/data/reference/physics-dataset.json.gz"
        );
        let dataset = crate::load_dataset(std::path::Path::new(path))
            .unwrap()
            .dataset;
        let mut study = Study::new(dataset.clone());
        for edit in [
            setting_table::PHASE.to(PhaseCorrection::None),
            setting_table::POINTS.to(40_usize),
            setting_table::PHYSICS.to(PhysicsCorrection::ByHand),
            Edit::DecideParameter {
                name: "Ixx".to_owned(),
                decision: ParameterDecision::Value(Some(5.0)),
            },
        ] {
            study.apply(&edit).unwrap();
        }
        let analysis = Engine::default().analyze(&study, &Unobserved).unwrap();
        let own = ExportRequest {
            correction: AssessedCorrection::Own,
            ..ExportRequest::default()
        };
        for model in exported_models(&analysis, &own).unwrap() {
            let condition = dataset.condition(model.condition).unwrap();
            let run = condition
                .moved_models()
                .iter()
                .find(|moved| moved.run().is_some_and(|run| run.name == "Ixx"))
                .unwrap();
            // A run at the value applied has the exported A; gains change B and C alone.
            let expected = run.model.state_space().unwrap().a();
            let nominal = condition.bundle(BundleKind::Physics)[condition.nominal()]
                .state_space()
                .unwrap()
                .a();
            let error = (model.model.a() - expected).norm();
            assert!(error <= 1e-12 * expected.norm(), "{error}");
            assert!((nominal - expected).norm() > 1e-6 * expected.norm());
            assert_eq!(model.contents.physics, ["Ixx +5 %"]);
        }
    }

    #[test]
    fn a_corrected_model_with_couplings_has_the_response_of_the_analysis() {
        let mut study = Study::new(embedded_example().unwrap().dataset);
        study
            .apply(&setting_table::PHASE.to(PhaseCorrection::None))
            .unwrap();
        study
            .apply(&setting_table::COUPLINGS.to(CouplingCorrection::MixingAndFeedback))
            .unwrap();
        let analysis = Engine::default().analyze(&study, &Unobserved).unwrap();
        let own = ExportRequest {
            correction: AssessedCorrection::Own,
            ..ExportRequest::default()
        };
        let grid = FrequencyGrid::logarithmic(study.settings.band, 12);
        for model in exported_models(&analysis, &own).unwrap() {
            assert_eq!(model.couplings, ModelCouplings::MixingAndFeedback);
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
