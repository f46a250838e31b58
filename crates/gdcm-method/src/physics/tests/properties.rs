//! Properties of the fit: units, order, and recovery of the truth from exact data.

use std::sync::Arc;

use nalgebra::{Complex, DMatrix};
use proptest::prelude::*;

use gdcm_model::dataset::{Pair, PairTable, StateSpace};
use gdcm_model::response::FrequencyResponse;

use super::{ToyCondition, diagnosis, toy, toy_conditions, toy_omega};
use crate::physics::problem::PhysicsOptions;
use crate::physics::{ParameterValue, PhysicsDiagnosis, PhysicsProblem};

/// Asserts that two results agree in misfit, share explained, and each parameter's value, variance,
/// ratio and step; the parameters in `found` are ordered as `parameters`.
fn assert_same(found: &PhysicsDiagnosis, expected: &PhysicsDiagnosis, parameters: &[usize]) {
    assert!((found.fit.misfit - expected.fit.misfit).abs() < 1e-10);
    let explained = found.explained().unwrap() - expected.explained().unwrap();
    assert!(explained.abs() < 1e-9);
    for (index, &parameter) in parameters.iter().enumerate() {
        let found = &found.parameters[index];
        let expected = &expected.parameters[parameter];
        assert!(
            (found.z - expected.z).abs() < 1e-9,
            "{} instead of {}",
            found.z,
            expected.z
        );
        let [found_variance, expected_variance] =
            [found, expected].map(|parameter| parameter.variance.unwrap().total());
        assert!((found_variance - expected_variance).abs() < 1e-9);
        let [found_alone, expected_alone] =
            [found, expected].map(|parameter| parameter.ratio_alone.unwrap());
        assert!((found_alone - expected_alone).abs() < 1e-9);
        assert_eq!(found.step, expected.step);
    }
}

/// Returns responses in other units; the factors are new units per old unit.
fn scaled(response: &FrequencyResponse, outputs: [f64; 2], inputs: [f64; 2]) -> FrequencyResponse {
    FrequencyResponse::new(response.curves().map(|pair, curve| {
        let factor = outputs[pair.output] / inputs[pair.input];
        curve.iter().map(|value| value * factor).collect::<Vec<_>>()
    }))
}

fn scaled_model(model: &StateSpace, outputs: [f64; 2], inputs: [f64; 2]) -> StateSpace {
    let mut b = model.b().clone();
    let mut c = model.c().clone();
    let mut d = model.d().clone();
    for (index, factor) in inputs.into_iter().enumerate() {
        b.column_mut(index).unscale_mut(factor);
        d.column_mut(index).unscale_mut(factor);
    }
    for (index, factor) in outputs.into_iter().enumerate() {
        c.row_mut(index).scale_mut(factor);
        d.row_mut(index).scale_mut(factor);
    }
    StateSpace::new(model.a().clone(), b, c, d).unwrap()
}

/// Returns the reference problem with disturbed flight, its models and responses in other channel
/// units.
fn in_other_units(outputs: [f64; 2], inputs: [f64; 2]) -> PhysicsProblem {
    let mut problem = toy("R_disturbed");
    for (condition, mut toy) in problem.conditions.iter_mut().zip(toy_conditions()) {
        toy.base = scaled_model(&toy.base, outputs, inputs);
        for (_, run) in toy.runs.iter_mut().flatten() {
            *run = scaled_model(run, outputs, inputs);
        }
        let flight = scaled(&condition.flight, outputs, inputs);
        *condition = toy.condition(condition.id.0, flight);
    }
    problem
}

/// Returns the reference problem with disturbed flight, its models in other state units.
fn in_other_states(factors: [f64; 3]) -> PhysicsProblem {
    let scales = DMatrix::from_diagonal(&nalgebra::DVector::from_row_slice(&factors));
    let inverse = scales.clone().try_inverse().unwrap();
    let moved = |model: &StateSpace| {
        StateSpace::new(
            &inverse * model.a() * &scales,
            &inverse * model.b(),
            model.c() * &scales,
            model.d().clone(),
        )
        .unwrap()
    };
    let mut problem = toy("R_disturbed");
    for (condition, mut toy) in problem.conditions.iter_mut().zip(toy_conditions()) {
        toy.base = moved(&toy.base);
        for (_, run) in toy.runs.iter_mut().flatten() {
            *run = moved(run);
        }
        *condition = toy.condition(condition.id.0, (*condition.flight).clone());
    }
    problem
}

#[test]
fn the_order_of_conditions_does_not_matter() {
    let expected = diagnosis(&toy("R_disturbed"));
    let mut problem = toy("R_disturbed");
    // Another order of the three conditions.
    problem.conditions.rotate_left(1);
    problem.conditions.swap(0, 1);
    assert_same(&diagnosis(&problem), &expected, &[0, 1]);
}

#[test]
fn the_order_of_parameters_does_not_matter() {
    let expected = diagnosis(&toy("R_disturbed"));
    let mut problem = toy("R_disturbed");
    for (condition, mut toy) in problem.conditions.iter_mut().zip(toy_conditions()) {
        toy.runs.reverse();
        *condition = toy.condition(condition.id.0, (*condition.flight).clone());
    }
    assert_same(&diagnosis(&problem), &expected, &[1, 0]);
}

#[test]
fn the_order_of_two_runs_does_not_matter() {
    let expected = diagnosis(&toy("R_disturbed"));
    let mut problem = toy("R_disturbed");
    for (condition, mut toy) in problem.conditions.iter_mut().zip(toy_conditions()) {
        toy.runs[0].reverse();
        *condition = toy.condition(condition.id.0, (*condition.flight).clone());
    }
    assert_same(&diagnosis(&problem), &expected, &[0, 1]);
}

/// Returns the exact response of a reference condition with its parameters at `z`, and with ln
/// gains and delays in its channels (outputs first).
fn exact_flight(
    condition: &ToyCondition,
    z: &[f64],
    ln_gains: [f64; 4],
    delays_s: [f64; 4],
) -> FrequencyResponse {
    let omega = toy_omega();
    let truth = condition.truth(z, &omega);
    FrequencyResponse::new(truth.curves().map(|pair, curve| {
        let Pair { output, input } = pair;
        let gain = (ln_gains[output] + ln_gains[2 + input]).exp();
        let delay_s = delays_s[output] + delays_s[2 + input];
        curve
            .iter()
            .zip(omega.iter())
            .map(|(value, omega)| value * Complex::from_polar(gain, -omega * delay_s))
            .collect::<Vec<_>>()
    }))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn units_of_channels_do_not_change_the_result(
        outputs in prop::array::uniform2(1e-3..1e3_f64),
        inputs in prop::array::uniform2(1e-3..1e3_f64),
    ) {
        let expected = diagnosis(&toy("R_disturbed"));
        assert_same(&diagnosis(&in_other_units(outputs, inputs)), &expected, &[0, 1]);
    }

    #[test]
    fn units_of_states_do_not_change_the_result(factors in prop::array::uniform3(1e-4..1e4_f64)) {
        let expected = diagnosis(&toy("R_disturbed"));
        assert_same(&diagnosis(&in_other_states(factors)), &expected, &[0, 1]);
    }

    #[test]
    fn exact_data_return_the_truth(
        z in prop::array::uniform2(-1.5..1.5_f64),
        delays_s in prop::array::uniform4(-0.02..0.02_f64),
        ln_gains in prop::array::uniform3(prop::array::uniform4(-0.08..0.08_f64)),
    ) {
        let mut conditions = Vec::new();
        for (index, (toy, ln_gains)) in toy_conditions().iter().zip(ln_gains).enumerate() {
            let flight = exact_flight(toy, &z, ln_gains, delays_s);
            conditions.push(toy.condition(index as i64 + 1, flight));
        }
        let problem = PhysicsProblem {
            omega: toy_omega(),
            on_axis: PairTable::from_fn(2, 2, |pair| pair.output == pair.input),
            parameters: vec![ParameterValue::Fitted; 2],
            conditions,
            options: PhysicsOptions::default(),
        };
        let found = diagnosis(&problem);
        for (found, truth) in found.fit.z.iter().zip(z) {
            prop_assert!((found - truth).abs() < 2e-3, "{found} instead of {truth}");
        }
    }
}

#[test]
fn a_held_parameter_keeps_its_value_and_the_other_is_fitted() {
    // The true values are 0.8 and -0.6.
    let mut problem = toy("R");
    problem.parameters[0] = ParameterValue::Held(0.8);
    let found = diagnosis(&problem);
    assert_eq!(found.fit.z[0], 0.8);
    assert_eq!(found.fit.fitted, [1]);
    assert!((found.fit.z[1] + 0.6).abs() < 2e-3);
    let held = &found.parameters[0];
    assert_eq!(held.why_not_named.unwrap().code(), "held");
    assert_eq!((held.half_width, held.variance), (None, None));
    assert_eq!(found.conditions[0].z_without[0], 0.8);
}

#[test]
fn a_family_of_responses_recovers_small_changes() {
    // Such a family changes its responses in proportion to the parameters, so that it is accurate
    // for small values only.
    let omega = toy_omega();
    let mut problem = toy("R");
    for (condition, toy) in problem.conditions.iter_mut().zip(toy_conditions()) {
        let flight = toy.truth(&[0.05, -0.04], &omega);
        *condition = toy.condition(condition.id.0, flight);
        let family =
            crate::physics::ModelFamily::from_responses(&toy.base(), &toy.steps(), &omega).unwrap();
        condition.family = Arc::new(family);
    }
    let found = diagnosis(&problem);
    assert!((found.fit.z[0] - 0.05).abs() < 5e-3, "{}", found.fit.z[0]);
    assert!((found.fit.z[1] + 0.04).abs() < 5e-3, "{}", found.fit.z[1]);
}

/// Tests the normal equations summed over the conditions: `sum_c S'_kk (z_c - z) = z`, where the
/// right side is the pull of the prior. The passes stop when no value moves by more than 1e-3.
#[test]
fn values_of_the_conditions_average_to_the_common_value_up_to_the_prior() {
    let found = diagnosis(&toy("R_disturbed"));
    for parameter in 0..2 {
        let z = found.fit.z[parameter];
        let mut information = 0.0;
        let mut pull = 0.0;
        for condition in &found.conditions {
            let here = condition.z_here[parameter].unwrap();
            information += here.sd.powi(-2);
            pull += here.sd.powi(-2) * (here.z - z);
        }
        let tolerance = 1e-3 * (1.0 + information);
        assert!((pull - z).abs() < tolerance, "{pull} instead of {z}");
        let from_zero = pull.abs() / (1.0 + information);
        assert!(from_zero < z.abs(), "the prior is weaker than the data");
    }
}
