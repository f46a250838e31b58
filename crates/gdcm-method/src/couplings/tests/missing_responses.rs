//! Fits to data with missing responses, and coupled responses computed from such data.

use std::sync::Arc;

use nalgebra::{Complex, DVector, dmatrix};

use gdcm_model::dataset::{Pair, PairTable};
use gdcm_model::executor::Sequential;
use gdcm_model::progress::Unobserved;
use gdcm_model::response::FrequencyResponse;

use super::{constant, disturbed, fit};
use crate::couplings::problem::CouplingError;
use crate::couplings::{CouplingKind, CouplingProblem, Unknown, fit_couplings};
use crate::fidelity::CoherenceWeights;

fn fit_error(problem: &CouplingProblem) -> CouplingError {
    fit_couplings(problem, &Sequential, &Unobserved).unwrap_err()
}

#[test]
fn a_fit_without_any_response_and_tables_of_another_shape_are_refused() {
    let mut problem = disturbed();
    for condition in &mut problem.conditions {
        condition.usable = PairTable::filled(3, 2, false);
    }
    assert_eq!(
        fit_error(&problem),
        CouplingError::NothingToFit { conditions: 4 }
    );
    problem.conditions.clear();
    assert_eq!(
        fit_error(&problem),
        CouplingError::NothingToFit { conditions: 0 }
    );
    let mut problem = disturbed();
    problem.omega = problem.omega[1..].into();
    assert!(matches!(
        fit_error(&problem),
        CouplingError::Shape {
            expected: [.., 11],
            found: [.., 12],
            ..
        }
    ));
}

/// A missing value of a response.
const MISSING: Complex<f64> = Complex::new(f64::NAN, f64::NAN);

/// A response without the values at these pairs and frequencies.
fn without(response: &FrequencyResponse, lacks: impl Fn(Pair, usize) -> bool) -> FrequencyResponse {
    FrequencyResponse::new(response.curves().map(|pair, curve| {
        let mut curve = curve.clone();
        for (k, value) in curve.iter_mut().enumerate() {
            if lacks(pair, k) {
                *value = MISSING;
            }
        }
        curve
    }))
}

/// The disturbed aircraft with only its first two outputs.
fn two_outputs() -> CouplingProblem {
    let mut smaller = disturbed();
    smaller.on_axis = PairTable::from_fn(2, 2, |pair| smaller.on_axis[pair]);
    for condition in &mut smaller.conditions {
        condition.physics = Arc::new(first_two(&condition.physics));
        condition.flight = first_two(&condition.flight);
        condition.usable = PairTable::filled(2, 2, true);
        let deviation = condition.deviation.take().unwrap();
        condition.deviation = Some(PairTable::from_fn(2, 2, |pair| deviation[pair].clone()));
    }
    smaller
}

fn first_two(response: &FrequencyResponse) -> FrequencyResponse {
    FrequencyResponse::new(PairTable::from_fn(2, 2, |pair| {
        response.curve(pair).to_vec()
    }))
}

#[test]
fn an_output_missing_in_flight_or_physics_is_not_fed_back() {
    let mut without_flight = disturbed();
    let mut without_physics = disturbed();
    let expected = fit(&two_outputs());
    for condition in &mut without_flight.conditions {
        condition.flight = without(&condition.flight, |pair, _| pair.output == 2);
    }
    for condition in &mut without_physics.conditions {
        condition.physics = Arc::new(without(&condition.physics, |pair, _| pair.output == 2));
    }
    for lacking in [without_flight, without_physics] {
        let found = fit(&lacking);
        assert_eq!(found.not_fed_back, [2]);
        assert!((found.matrices.mixing(70.0) - expected.matrices.mixing(70.0)).amax() < 1e-13);
        assert!(
            (found.matrices.feedback().columns(0, 2) - expected.matrices.feedback()).amax() < 1e-13
        );
        assert!(
            found
                .matrices
                .feedback()
                .column(2)
                .iter()
                .all(|entry| *entry == 0.0)
        );
    }
}

#[test]
fn an_input_column_is_skipped_where_flight_lacks_a_fed_back_output() {
    let mut lacking = disturbed();
    let mut unusable = disturbed();
    // The first condition lacks a response: the result equals the result of a fit without this
    // input in this condition.
    lacking.conditions[0].flight = without(&lacking.conditions[0].flight, |pair, _| {
        pair == Pair::new(2, 1)
    });
    for output in 0..3 {
        unusable.conditions[0].usable[Pair::new(output, 1)] = false;
    }
    let found = fit(&lacking);
    let expected = fit(&unusable);
    assert_eq!(
        (found.coefficients, found.not_fed_back),
        (expected.coefficients, vec![])
    );
    // A mixing alone does not need the other responses of the column.
    lacking.kind = CouplingKind::Mixing;
    unusable.kind = CouplingKind::Mixing;
    unusable.conditions[0].usable = PairTable::from_fn(3, 2, |pair| pair != Pair::new(2, 1));
    let found = fit(&lacking);
    let expected = fit(&unusable);
    assert_eq!(
        (found.coefficients, found.not_fed_back),
        (expected.coefficients, vec![])
    );
}

#[test]
fn a_frequency_is_skipped_where_the_physics_model_lacks_a_fed_back_output() {
    let mut lacking = disturbed();
    let mut shorter = disturbed();
    lacking.conditions[2].physics = Arc::new(without(&lacking.conditions[2].physics, |pair, k| {
        pair.output == 1 && k == 4
    }));
    shorter.conditions[2].flight = without(&shorter.conditions[2].flight, |_, k| k == 4);
    assert_eq!(fit(&lacking).coefficients, fit(&shorter).coefficients);
}

#[test]
fn an_input_without_flight_data_stays_uncoupled() {
    let mut problem = disturbed();
    for condition in &mut problem.conditions {
        condition.flight = without(&condition.flight, |pair, _| pair.input == 1);
    }
    let found = fit(&problem);
    let expected: Vec<Unknown> = found
        .unknowns
        .iter()
        .filter(|unknown| matches!(unknown, Unknown::Mixing { from: 1, .. }))
        .copied()
        .collect();
    assert_eq!(
        (&found.undetermined, found.not_fed_back.len()),
        (&expected, 0)
    );
    assert_eq!(
        found.matrices.mixing(70.0).column(1),
        DVector::from_vec(vec![0.0, 1.0])
    );
}

#[test]
fn a_response_with_low_coherence_has_no_weight() {
    // The coherence of 0.3 is below the threshold of 0.6.
    let mut measured = disturbed();
    let mut unusable = disturbed();
    let omega = Arc::clone(&measured.omega);
    for (condition, without) in measured.conditions.iter_mut().zip(&mut unusable.conditions) {
        condition.coherence = Some(PairTable::from_fn(3, 2, |pair| {
            let coherence = if pair == Pair::new(2, 0) { 0.3 } else { 1.0 };
            CoherenceWeights::select(&omega, &vec![coherence; omega.len()], 0.6, None)
        }));
        without.usable[Pair::new(2, 0)] = false;
    }
    let found = fit(&measured);
    let expected = fit(&unusable);
    for (found, expected) in found
        .coefficients
        .iter()
        .flatten()
        .zip(expected.coefficients.iter().flatten())
    {
        // A weight common to all responses changes only rounding errors.
        assert!((found - expected).abs() < 1e-12);
    }
}

#[test]
fn a_missing_physics_response_affects_only_coupled_responses_that_need_it() {
    let problem = disturbed();
    let physics = &problem.conditions[0].physics;
    let lacking = without(physics, |pair, k| pair == Pair::new(2, 0) && k == 3);
    let mixing = dmatrix![1.0, 0.1; 0.2, 1.0];
    // The output that lacks a value is not fed back.
    let free = constant(&mixing, &dmatrix![0.1, 0.2, 0.0; 0.0, 0.1, 0.0]);
    let found = free.response(&lacking, 60.0);
    let expected = free.response(physics, 60.0);
    for (pair, curve) in expected.curves().iter() {
        for (k, expected) in curve.iter().enumerate() {
            let value = found.curve(pair)[k];
            let is_lacking = pair.output == 2 && k == 3;
            assert!(
                if is_lacking {
                    !value.is_finite()
                } else {
                    value == *expected
                },
                "{pair:?} {k}"
            );
        }
    }
    // Fed back, it is needed for every response at its frequency.
    let fed_back =
        constant(&mixing, &dmatrix![0.0, 0.0, 0.1; 0.0, 0.0, 0.0]).response(&lacking, 60.0);
    assert!(
        fed_back
            .curves()
            .iter()
            .all(|(_, curve)| !curve[3].is_finite() && curve[4].is_finite())
    );
}
