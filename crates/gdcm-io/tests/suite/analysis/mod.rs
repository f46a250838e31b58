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
mod measured_flight;
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

/// Smallest magnitudes that matter, by kind of result: tolerances are relative to these for results
/// near zero.
mod scale {
    /// Gains, ratios and their logarithms have the order of magnitude 1.
    pub const GAIN: f64 = 1.0;
    /// One millisecond: a tenth of the smallest delay that matters to an engineer.
    pub const DELAY_S: f64 = 1e-3;
    /// A J of 1 is a fiftieth of the value at which responses are almost indistinguishable.
    pub const COST: f64 = 1.0;
    /// The objective of eq. (11) is a sum of squared delays \[s^2\].
    pub const DELAY_OBJECTIVE: f64 = 1e-4;
    /// Airspeeds \[kt\].
    pub const AIRSPEED_KT: f64 = 1.0;
}

/// Asserts agreement within 1e-6 of the reference value, or of `scale` if the reference is smaller.
/// The reference values themselves are accurate to about 1e-9: both programs take medians and
/// quantiles of the same 200 values.
#[track_caller]
fn assert_close(quantity: &str, found: f64, reference: f64, scale: f64) {
    let allowed = 1e-6 * reference.abs().max(scale);
    assert!(
        (found - reference).abs() <= allowed,
        "{quantity}: found {found}, reference {reference}"
    );
}

#[track_caller]
fn assert_all_close(quantity: &str, found: &[f64], reference: &Value, scale: f64) {
    let reference = numbers(reference);
    assert_eq!(found.len(), reference.len(), "{quantity}");
    for (index, (found, reference)) in found.iter().zip(reference).enumerate() {
        assert_close(
            &format!("{quantity}, entry {}", index + 1),
            *found,
            reference,
            scale,
        );
    }
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
