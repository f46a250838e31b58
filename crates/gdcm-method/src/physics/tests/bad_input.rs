//! Data that determine few parameters or none, and unusable settings: limited values or errors with
//! codes.

use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use nalgebra::{Complex, DMatrix};

use gdcm_model::dataset::{PairTable, StateSpace};
use gdcm_model::executor::Sequential;
use gdcm_model::progress::{Progress, Unobserved};
use gdcm_model::response::FrequencyResponse;

use super::{ToyCondition, diagnosis, toy, toy_conditions, toy_omega};
use crate::physics::problem::PhysicsOptions;
use crate::physics::{ParameterValue, PhysicsError, PhysicsProblem, diagnose, fit_parameters};

/// The parameter values with which the reference flight responses `R` were computed.
const TRUE_Z: [f64; 2] = [0.8, -0.6];

/// Returns the code of the error of a diagnosis.
fn error_code(problem: &PhysicsProblem) -> &'static str {
    diagnose(problem, &Sequential, &Unobserved)
        .unwrap_err()
        .code()
}

#[test]
fn a_single_condition_has_values_and_no_intervals() {
    let mut problem = toy("R");
    problem.conditions.truncate(1);
    let found = diagnosis(&problem);
    assert!(found.scores.is_none() && found.verdict.is_none());
    for parameter in &found.parameters {
        assert_eq!(parameter.half_width, None);
        assert_eq!(parameter.variance.unwrap().condition, None);
        let why = parameter.why_not_named.unwrap();
        assert_eq!(why.code(), "few-conditions");
    }
    assert!(found.named().is_empty());
}

#[test]
fn nothing_to_fit_is_an_error() {
    let mut problem = toy("R");
    problem.conditions.clear();
    assert_eq!(error_code(&problem), "physics-without-responses");
    let mut problem = toy("R");
    for condition in &mut problem.conditions {
        condition.usable = PairTable::filled(2, 2, false);
    }
    assert_eq!(error_code(&problem), "physics-without-responses");
    let mut problem = toy("R");
    problem.parameters.clear();
    assert_eq!(error_code(&problem), "physics-without-parameters");
}

#[test]
fn tables_of_other_shapes_are_an_error() {
    let mut problem = toy("R");
    problem.conditions[1].usable = PairTable::filled(3, 2, true);
    assert_eq!(error_code(&problem), "physics-table-shape");
    let mut problem = toy("R");
    problem.omega = Arc::from([1.0, 2.0]);
    assert_eq!(error_code(&problem), "physics-table-shape");
    let mut problem = toy("R");
    problem.parameters.push(ParameterValue::Fitted);
    assert_eq!(error_code(&problem), "physics-parameter-count");
}

#[test]
fn settings_out_of_range_are_an_error() {
    for value in [f64::NAN, -1.0, f64::INFINITY] {
        let mut problem = toy("R");
        problem.options.delay_sd_s = value;
        assert_eq!(error_code(&problem), "physics-option");
    }
    let mut problem = toy("R");
    problem.parameters[1] = ParameterValue::Held(f64::NAN);
    assert_eq!(error_code(&problem), "physics-held-value");
}

#[test]
fn missing_values_have_no_weight() {
    let mut problem = toy("R");
    let flight = problem.conditions[0].flight.curves().map(|pair, curve| {
        let mut curve = curve.clone();
        if pair.output == 1 {
            curve[3] = Complex::new(f64::NAN, f64::NAN);
        }
        curve[5] = Complex::new(0.0, 0.0);
        curve
    });
    problem.conditions[0].flight = Arc::new(FrequencyResponse::new(flight));
    let found = diagnosis(&problem);
    // 2e-3: the pull of the prior towards zero, and the change of 1e-3 at which the passes stop.
    assert!((found.fit.z[0] - TRUE_Z[0]).abs() < 2e-3);
    assert!((found.fit.z[1] - TRUE_Z[1]).abs() < 2e-3);
}

/// Returns the reference problem after `change` has altered each condition's models; all its
/// parameters are fitted.
fn with_runs(change: impl Fn(&mut ToyCondition)) -> PhysicsProblem {
    let mut problem = toy("R");
    for (condition, mut toy) in problem.conditions.iter_mut().zip(toy_conditions()) {
        change(&mut toy);
        *condition = toy.condition(condition.id.0, (*condition.flight).clone());
    }
    let parameters = problem.conditions[0].family.parameters();
    problem.parameters = vec![ParameterValue::Fitted; parameters];
    problem
}

#[test]
fn a_run_equal_to_the_nominal_model_gives_no_information() {
    let found = diagnosis(&with_runs(|toy| toy.runs[1][0].1 = toy.base.clone()));
    let parameter = &found.parameters[1];
    assert_eq!(parameter.z, 0.0);
    assert_eq!(parameter.learned, Some(0.0));
    assert_eq!(parameter.channels_can_take, None);
    let weak = found.weak_direction().unwrap();
    assert_eq!(weak.singular_value, 0.0);
    assert_eq!(weak.direction, [0.0, 1.0]);
}

#[test]
fn parameters_with_identical_runs_are_a_correlated_pair() {
    let found = diagnosis(&with_runs(|toy| {
        let copy = toy.runs[1].clone();
        toy.runs.push(copy);
    }));
    let [pair] = found.pairs[..] else {
        panic!("one pair: {:?}", found.pairs)
    };
    assert_eq!(pair.parameters, [1, 2]);
    assert!(pair.correlation < -0.99);
    let [first, second] = [1, 2].map(|index| found.fit.z[index]);
    assert!(
        (first - second).abs() < 1e-9,
        "the prior divides the change equally"
    );
    assert_eq!(found.parameters[1].strongest_pair.unwrap(), pair);
}

#[test]
fn forty_parameters_are_fitted() {
    let problem = with_runs(|toy| {
        let base = toy.base.clone();
        for index in 0..38 {
            let mut a = base.a().clone();
            a[(index % 3, (index / 3) % 3)] += 0.05 * (1.0 + index as f64);
            let moved = StateSpace::new(a, base.b().clone(), base.c().clone(), base.d().clone());
            toy.runs.push(vec![(1.0, moved.unwrap())]);
        }
    });
    assert_eq!(problem.parameters.len(), 40);
    let found = diagnosis(&problem);
    // A score before the first parameter, and one after each.
    assert_eq!(found.scores.unwrap().stepwise.len(), 41);
    assert!(found.fit.z.iter().all(|z| z.abs() <= 3.0));
}

#[test]
fn runs_with_enormous_changes_give_values_within_the_bound_or_an_error() {
    let problem = with_runs(|toy| {
        let huge = DMatrix::from_element(3, 3, 1e200);
        let base = &toy.base;
        let moved = StateSpace::new(huge, base.b().clone(), base.c().clone(), base.d().clone());
        toy.runs[1] = vec![(1e-150, moved.unwrap())];
    });
    match diagnose(&problem, &Sequential, &Unobserved) {
        Ok(found) => assert!(found.fit.z.iter().all(|z| z.abs() <= 3.0)),
        Err(error) => assert!(!error.code().is_empty()),
    }
}

#[test]
fn a_parameter_far_from_the_physics_model_stops_at_the_bound_of_three() {
    // The true value is 6 plausible standard deviations.
    let mut problem = toy("R");
    let omega = toy_omega();
    for (condition, mut toy) in problem.conditions.iter_mut().zip(toy_conditions()) {
        toy.runs.truncate(1);
        toy.runs[0].truncate(1);
        let flight = toy.truth(&[6.0], &omega);
        *condition = toy.condition(condition.id.0, flight);
    }
    problem.parameters.truncate(1);
    let found = diagnosis(&problem);
    assert_eq!(found.fit.z, [3.0]);
}

#[test]
fn channels_stay_uncorrected_if_gains_and_delays_are_fixed() {
    let problem = PhysicsProblem {
        options: PhysicsOptions {
            gain_sd: 0.0,
            delay_sd_s: 0.0,
            ..PhysicsOptions::default()
        },
        ..toy("R")
    };
    let found = diagnosis(&problem);
    assert_eq!(found.fit.delays_s.outputs, [0.0, 0.0]);
    assert_eq!(found.fit.ln_gains[0].inputs, [0.0, 0.0]);
    for share in &found.identifiability.channels_can_take {
        assert!(share.unwrap().abs() < 1e-12);
    }
}

/// Cancels after a number of polls, and asserts that the reported steps do not exceed the total.
struct Impatient(AtomicUsize);

impl Progress for Impatient {
    fn cancelled(&self) -> bool {
        self.0
            .fetch_update(Ordering::Relaxed, Ordering::Relaxed, |left| {
                left.checked_sub(1)
            })
            .is_err()
    }

    fn advanced(&self, done: usize, total: usize) {
        assert!(done <= total);
    }
}

#[test]
fn a_fit_stops_when_it_is_cancelled() {
    for polls in [0, 1, 5, 10] {
        let progress = Impatient(AtomicUsize::new(polls));
        let error = fit_parameters(&toy("R"), &Sequential, &progress).unwrap_err();
        assert!(matches!(error, PhysicsError::Cancelled(_)));
        assert_eq!(error.code(), "stopped");
    }
    let progress = Impatient(AtomicUsize::new(1000));
    assert!(diagnose(&toy("R"), &Sequential, &progress).is_ok());
}
