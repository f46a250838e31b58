//! Discrete-time models and models with delayed channels, from the file to the result (M2a).

use std::path::PathBuf;
use std::sync::Arc;

use serde_json::json;

use gdcm_io::{DatasetOrigin, load_dataset_bytes};
use gdcm_model::dataset::state_space::Timing;
use gdcm_model::dataset::{Dataset, ModelId};
use gdcm_model::executor::Sequential;
use gdcm_study::results::caution::{Caution, NotFinite};
use gdcm_study::stages::model_cautions::cautions_of_models;
use gdcm_study::{ConditionAnalysis, Execution};

use super::*;

const SMALL: &str = include_str!("../../../../../tests/data/small-dataset.json");
const FIRST: ConditionId = ConditionId(7);

/// Returns the small dataset with other identified models in its first condition: the nominal model
/// with `keys` added, followed by the models in `more`.
fn small_dataset_with(keys: &Value, more: &[Value]) -> Arc<Dataset> {
    let mut file = json(SMALL);
    let mut flight = file["conditions"][0]["physics_models"][0].clone();
    let model = flight.as_object_mut().unwrap();
    for key in ["role", "perturbation"] {
        model.remove(key);
    }
    model.extend(keys.as_object().unwrap().clone());
    model.insert("name".to_owned(), json!("flight"));
    file["conditions"][0]["identified_models"] =
        json!([[flight.clone()].as_slice(), more].concat());
    load_dataset_bytes(
        file.to_string().as_bytes(),
        DatasetOrigin::File(PathBuf::from("small.json")),
    )
    .unwrap()
    .dataset
}

fn analysis_of(dataset: &Arc<Dataset>) -> Analysis {
    let mut study = Study::new(Arc::clone(dataset));
    study
        .apply(&Edit::Pin(ModelId::new(
            FIRST,
            BundleKind::Physics,
            "nominal",
        )))
        .unwrap();
    analyze(&mut Engine::default(), &study)
}

fn first_condition(analysis: &Analysis) -> &ConditionAnalysis {
    analysis.condition(FIRST).unwrap()
}

#[test]
fn the_delta_delay_is_the_sum_of_the_channel_delays() {
    let dataset = small_dataset_with(
        &json!({"input_delays_s": [0.03, 0.0], "output_delays_s": [0.01, 0.02]}),
        &[],
    );
    let analysis = analysis_of(&dataset);
    let delta = &first_condition(&analysis).comparison.delta;
    for (pair, gain) in delta.gain.iter().filter(|(_, gain)| gain.is_some()) {
        let expected = [0.03, 0.0][pair.input] + [0.01, 0.02][pair.output];
        // Rounding: a phase of a few radians is unwrapped and divided by at least 0.5 rad/s.
        assert!((gain.unwrap() - 1.0).abs() < 1e-12, "{pair:?}");
        assert!(
            (delta.delay_s[pair].unwrap() - expected).abs() < 1e-12,
            "{pair:?}"
        );
    }
}

#[test]
fn a_model_sampled_too_slowly_for_the_band_is_set_aside_with_the_reason() {
    let mut slow = json(SMALL)["conditions"][0]["identified_models"][0].clone();
    slow["name"] = json!("slow");
    slow["sample_time_s"] = json!(0.5);
    let dataset = small_dataset_with(&json!({}), &[slow]);
    let analysis = analysis_of(&dataset);
    let result = first_condition(&analysis);
    assert_eq!(result.representative_name(BundleKind::Identified), "flight");
    // The band ends above the Nyquist frequency.
    let sampled = NotFinite::Sampled {
        sample_time_s: 0.5,
        nyquist_rad_s: std::f64::consts::PI / 0.5,
    };
    let is_expected = |caution: &Caution| match caution {
        Caution::SetAside { model, why, .. } => model.name == "slow" && *why == Some(sampled),
        _ => false,
    };
    assert!(
        result.cautions.iter().any(is_expected),
        "{:?}",
        result.cautions
    );
    let study = Study::new(Arc::clone(&dataset));
    let execution = Execution::new(&Sequential, &Unobserved, 0);
    let cautions = cautions_of_models(&study, &execution).unwrap();
    assert!(
        cautions
            .iter()
            .any(|(id, caution)| *id == FIRST && is_expected(caution)),
        "{cautions:?}"
    );
}

#[test]
fn models_that_differ_only_in_their_timing_have_different_fingerprints() {
    let models = [
        json!({}),
        json!({"sample_time_s": 0.01}),
        json!({"output_delays_s": [0.0, 0.01]}),
    ];
    let fingerprint = |keys: &Value| {
        let dataset = small_dataset_with(keys, &[]);
        dataset
            .condition(FIRST)
            .unwrap()
            .bundle(BundleKind::Identified)[0]
            .fingerprint()
    };
    let [plain, sampled, delayed] = models.each_ref().map(fingerprint);
    assert!(plain != sampled && plain != delayed && sampled != delayed);
    assert_eq!(
        plain,
        fingerprint(&json!({"input_delays_s": [0.0, 0.0]})),
        "delays of zero should count as no delays"
    );
}

#[test]
fn a_discrete_model_has_the_response_of_its_transfer_function_on_the_unit_circle() {
    let keys = json!({"sample_time_s": 0.1, "input_delays_s": [0.05, 0.0]});
    let dataset = small_dataset_with(&keys, &[]);
    let dynamics = &dataset
        .condition(FIRST)
        .unwrap()
        .bundle(BundleKind::Identified)[0]
        .dynamics;
    let Dynamics::StateSpace(model) = dynamics else {
        panic!("the model should have matrices")
    };
    assert_eq!(
        model.timing(),
        &Timing {
            sample_time_s: Some(0.1),
            input_delays_s: Some(vec![0.05, 0.0]),
            output_delays_s: None
        }
    );
    let grid = FrequencyGrid::logarithmic(dataset.band(), 30);
    let response = FrequencyResponse::from_dynamics(dynamics, &grid);
    let complex = |matrix: &DMatrix<f64>| matrix.map(Complex::from);
    for (k, omega) in grid.omega().iter().enumerate() {
        let order = model.order();
        let z = Complex::from_polar(1.0, 0.1 * omega);
        let resolvent = DMatrix::from_diagonal_element(order, order, z) - complex(model.a());
        let solved = resolvent.lu().solve(&complex(model.b())).unwrap();
        let expected = complex(model.c()) * solved + complex(model.d());
        for pair in response.curves().pairs() {
            let delay = Complex::from_polar(1.0, -omega * [0.05, 0.0][pair.input]);
            let expected = expected[(pair.output, pair.input)] * delay;
            // Rounding of the solution of two equations.
            assert!(
                (response.curve(pair)[k] - expected).norm() <= 1e-12 * expected.norm(),
                "{pair:?} {omega}"
            );
        }
    }
}
