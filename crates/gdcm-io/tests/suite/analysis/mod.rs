//! The whole method compared with reference values (source: `tests/data/README.md`), and properties
//! of whole studies.

use std::sync::LazyLock;

use nalgebra::{Complex, DMatrix};
use serde_json::Value;

use gdcm_io::files::corrections_file::corrections;
use gdcm_model::dataset::{BundleKind, ConditionId, Dynamics, Pair, PairTable, StateSpace};
use gdcm_model::progress::Unobserved;
use gdcm_model::response::{FrequencyGrid, FrequencyResponse};
use gdcm_study::decisions::setting_table;
use gdcm_study::{Analysis, Edit, Engine, Study};

mod across;
mod adopted_models;
mod assessment;
mod bar_coverage;
mod coherence;
mod derivations;
mod edges;
mod example;
mod known_answer;
mod lead;
mod mean_gain;
mod modes;
mod physics;
mod physics_stage;
mod real_aircraft;
mod remarks;
mod response_paths;
mod responses;
mod signs;
mod studies;
mod timing;
mod uncertainty;
mod variants;

fn json(text: &str) -> Value {
    serde_json::from_str(text).unwrap()
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap()
}

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().unwrap().iter().map(number).collect()
}

fn list(value: &Value) -> &[Value] {
    value.as_array().unwrap()
}

fn texts(value: &Value) -> Vec<&str> {
    list(value)
        .iter()
        .map(|text| text.as_str().unwrap())
        .collect()
}

fn analyze(engine: &mut Engine, study: &Study) -> Analysis {
    engine.analyze(study, &Unobserved).unwrap()
}

/// Returns a study of the example dataset from which the reference values were computed.
fn study_of_example() -> Study {
    Study::new(crate::REFERENCE_DATASET.dataset.clone())
}

/// Second analysis of the example, after its suggested outliers were rejected.
static EXAMPLE_WITH_SUGGESTIONS_REJECTED: LazyLock<Analysis> = LazyLock::new(|| {
    let mut study = study_of_example();
    let mut engine = Engine::default();
    let first = analyze(&mut engine, &study);
    for (&condition, result) in &first.conditions {
        let models = result.as_ref().unwrap().suggested();
        study
            .apply(&Edit::reject_physics(condition, &models))
            .unwrap();
    }
    analyze(&mut engine, &study)
});
