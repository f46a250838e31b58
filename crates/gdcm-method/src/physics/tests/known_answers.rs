//! Comparison with independent numpy results.

use nalgebra::DMatrix;
use serde_json::Value;

use gdcm_model::dataset::state_space::Timing;
use gdcm_model::dataset::{Dynamics, Pair, StateSpace};
use gdcm_model::response::PreparedModel;

use super::{REFERENCE, diagnosis, numbers, toy, toy_conditions, toy_omega};
use crate::physics::PhysicsDiagnosis;
use crate::physics::increments::NOTABLE_CURVATURE;
use crate::uncertainty::student_quantile;

fn assert_close(found: &[f64], expected: &Value, tolerance: f64, what: &str) {
    let expected = numbers(expected);
    assert_eq!(found.len(), expected.len(), "{what}");
    for (index, (found, expected)) in found.iter().zip(&expected).enumerate() {
        assert!(
            (found - expected).abs() <= tolerance,
            "{what}[{index}]: {found} instead of {expected}"
        );
    }
}

/// Asserts that a diagnosis equals a reference result.
fn assert_known(found: &PhysicsDiagnosis, known: &Value) {
    let tolerance = REFERENCE["toy"]["tolerance"]["z"].as_f64().unwrap();
    let passes = known["passes"].as_array().unwrap();
    assert_eq!(found.fit.passes.len(), passes.len());
    for (pass, expected) in found.fit.passes.iter().zip(passes) {
        assert_close(&pass.z, &expected["z"], tolerance, "z of a pass");
        let expected = expected["s2"].as_f64().unwrap();
        assert!((pass.misfit_square - expected).abs() < tolerance);
    }
    assert_close(&found.fit.z, &known["z"], tolerance, "z");
    let delays_s = [
        &found.fit.delays_s.outputs[..],
        &found.fit.delays_s.inputs[..],
    ]
    .concat();
    assert_close(&delays_s, &known["tau"], tolerance, "tau");
    for (index, ln_gains) in found.fit.ln_gains.iter().enumerate() {
        let ln_gains = [&ln_gains.outputs[..], &ln_gains.inputs[..]].concat();
        assert_close(
            &ln_gains,
            &known["own_ln_gain"][index],
            tolerance,
            "ln gains",
        );
    }
    let misfit_square = known["s2"].as_f64().unwrap();
    assert!((found.fit.misfit.powi(2) - misfit_square).abs() < tolerance);
    let variances: Vec<_> = found
        .parameters
        .iter()
        .map(|parameter| parameter.variance.unwrap())
        .collect();
    for (kind, values) in [
        (
            "condition",
            variances
                .iter()
                .map(|v| v.condition.unwrap())
                .collect::<Vec<f64>>(),
        ),
        (
            "output",
            variances.iter().map(|v| v.output.unwrap()).collect(),
        ),
        (
            "input",
            variances.iter().map(|v| v.input.unwrap()).collect(),
        ),
        ("band", variances.iter().map(|v| v.band.unwrap()).collect()),
        ("prior", variances.iter().map(|v| v.prior).collect()),
    ] {
        assert_close(&values, &known["variance"][kind], tolerance, kind);
    }
    // A diagnosis of three conditions has no half-widths, but the reference contains them.
    let quantile = student_quantile(0.9, 2.0);
    let half_widths: Vec<f64> = variances
        .iter()
        .map(|variance| quantile * variance.total().sqrt())
        .collect();
    assert_close(&half_widths, &known["half_width_z"], 1e-6, "half-width");
    for (row, expected) in known["information"].as_array().unwrap().iter().enumerate() {
        let found = found.identifiability.information.row(row);
        let found: Vec<f64> = found.iter().copied().collect();
        let scale = numbers(expected)[row];
        assert_close(&found, expected, 1e-7 * scale, "information");
    }
    let stepwise = &found.scores.as_ref().unwrap().stepwise;
    for (step, expected) in stepwise.iter().zip(known["stepwise"].as_array().unwrap()) {
        let names = [None, Some("a"), Some("b")];
        let added = names[step.added.map_or(0, |parameter| parameter + 1)];
        assert_eq!(added, expected["added"].as_str());
        let scores = &step.score.per_condition;
        assert_close(scores, &expected["per_condition"], tolerance, "score");
    }
}

#[test]
fn exact_data_agree_with_the_reference_after_each_pass() {
    let found = diagnosis(&toy("R"));
    assert_known(&found, &REFERENCE["toy"]["exact"]);
    let truth = numbers(&REFERENCE["toy"]["z_true"]);
    let tolerance = REFERENCE["toy"]["tolerance"]["recovered"].as_f64().unwrap();
    for (found, truth) in found.fit.z.iter().zip(truth) {
        assert!((found - truth).abs() < tolerance);
    }
    assert_eq!(found.fit.still_moving, None);
}

#[test]
fn disturbed_data_agree_with_the_reference_after_each_pass() {
    assert_known(
        &diagnosis(&toy("R_disturbed")),
        &REFERENCE["toy"]["disturbed"],
    );
}

#[test]
fn the_model_at_chosen_values_has_the_response_of_the_family() {
    let condition = &toy_conditions()[1];
    let z = [0.7, -1.3];
    let model = condition.increments().apply(&condition.base(), &z).unwrap();
    let omega = toy_omega();
    let expected = PreparedModel::new(&Dynamics::StateSpace(model)).at(&omega);
    let family = condition
        .condition(1, expected.clone())
        .family
        .evaluate(&z, &omega);
    for (pair, curve) in expected.curves().iter() {
        let Pair { output, input } = pair;
        let start = (2 * output + input) * omega.len();
        for (k, expected) in curve.iter().enumerate() {
            let error = (family.response[start + k] - expected).norm();
            assert!(
                error < 1e-13 * (1.0 + expected.norm()),
                "{pair:?}, {k}: {error:e}"
            );
        }
    }
}

#[test]
fn a_family_of_sampled_models_with_delays_has_the_response_of_its_models() {
    let timing = Timing {
        sample_time_s: Some(0.02),
        input_delays_s: Some(vec![0.03, 0.0]),
        output_delays_s: Some(vec![0.0, 0.01]),
    };
    let mut condition = toy_conditions()[1].clone();
    condition.base = discretised(&condition.base, &timing);
    for (_, run) in condition.runs.iter_mut().flatten() {
        *run = discretised(run, &timing);
    }
    let z = [0.7, -1.3];
    let omega = toy_omega();
    let expected = condition.truth(&z, &omega);
    let family = condition.condition(1, expected.clone()).family;
    let found = family.evaluate(&z, &omega);
    for (pair, curve) in expected.curves().iter() {
        let start = (2 * pair.output + pair.input) * omega.len();
        for (k, expected) in curve.iter().enumerate() {
            let error = (found.response[start + k] - expected).norm();
            assert!(error < 1e-12 * (1.0 + expected.norm()), "{pair:?}, {k}");
        }
    }
    let model = condition.increments().apply(&condition.base(), &z).unwrap();
    assert_eq!(model.timing(), condition.base.timing());
}

/// Returns a model discretised by Euler's rule, with these delays.
fn discretised(model: &StateSpace, timing: &Timing) -> StateSpace {
    let sample_time_s = timing.sample_time_s.unwrap();
    StateSpace::new(
        DMatrix::identity(3, 3) + model.a() * sample_time_s,
        model.b() * sample_time_s,
        model.c().clone(),
        model.d().clone(),
    )
    .unwrap()
    .timed(timing.clone())
    .unwrap()
}

#[test]
fn only_a_parameter_with_two_runs_has_a_curvature_and_it_is_proportional_to_the_value() {
    let increments = toy_conditions()[1].increments();
    // Parameter b has a single run.
    let [a, b] = increments.curvatures(&[2.0, 2.0])[..] else {
        panic!("two parameters")
    };
    assert!(a > 0.0 && a < NOTABLE_CURVATURE, "{a}");
    assert_eq!(b, 0.0);
    let [half, _] = increments.curvatures(&[-1.0, 2.0])[..] else {
        panic!("two parameters")
    };
    assert!((2.0 * half - a).abs() < 1e-15);
}

#[test]
fn derivatives_agree_with_central_differences() {
    const STEP: f64 = 1e-5;
    let condition = &toy_conditions()[2];
    let omega = toy_omega();
    let family = condition.condition(1, condition.truth(&[0.0, 0.0], &omega));
    let z = [0.4, -0.9];
    let found = family.family.evaluate(&z, &omega);
    for parameter in 0..2 {
        let [above, below] = [STEP, -STEP].map(|step| {
            let mut moved = z;
            moved[parameter] += step;
            family.family.evaluate(&moved, &omega).response
        });
        for (place, derivative) in found.derivatives[parameter].iter().enumerate() {
            let difference = (above[place] - below[place]) / (2.0 * STEP);
            // The error of a central difference is of the order of the square of the step.
            assert!((difference - derivative).norm() < 1e-8);
        }
    }
}
