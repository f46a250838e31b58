//! What couplings do where a representative lacks a response, or flight did not measure it well (M16.2, M4a).

use std::sync::Arc;

use nalgebra::{Complex, DVector, dmatrix};

use super::known_answers_tests::{constant, disturbed, fit};
use super::*;
use crate::dataset::{Pair, PairTable};
use crate::fidelity::CoherenceWeights;
use crate::response::FrequencyResponse;

const NOT_KNOWN: Complex<f64> = Complex::new(f64::NAN, f64::NAN);

/// A response without the values at these pairs and frequencies.
fn without(response: &FrequencyResponse, lacks: impl Fn(Pair, usize) -> bool) -> FrequencyResponse {
    FrequencyResponse::new(response.curves().map(|pair, curve| {
        let value = |(k, value): (usize, &Complex<f64>)| if lacks(pair, k) { NOT_KNOWN } else { *value };
        curve.iter().enumerate().map(value).collect()
    }))
}

/// The disturbed aircraft with its first two outputs alone.
fn two_outputs() -> CouplingProblem {
    let mut smaller = disturbed();
    let first_two = |response: &FrequencyResponse| {
        FrequencyResponse::new(PairTable::from_fn(2, 2, |pair| response.curve(pair).to_vec()))
    };
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

#[test]
fn an_output_that_one_side_lacks_everywhere_is_not_fed_back_and_changes_nothing_else() {
    let (mut of_flight, mut of_physics, expected) = (disturbed(), disturbed(), fit(&two_outputs()));
    for condition in &mut of_flight.conditions {
        condition.flight = without(&condition.flight, |pair, _| pair.output == 2);
    }
    for condition in &mut of_physics.conditions {
        condition.physics = Arc::new(without(&condition.physics, |pair, _| pair.output == 2));
    }
    for lacking in [of_flight, of_physics] {
        let found = fit(&lacking);
        assert_eq!(found.not_fed_back, [2]);
        assert!((found.matrices.mixing(70.0) - expected.matrices.mixing(70.0)).amax() < 1e-13);
        assert!((found.matrices.feedback().columns(0, 2) - expected.matrices.feedback()).amax() < 1e-13);
        assert!(found.matrices.feedback().column(2).iter().all(|entry| *entry == 0.0));
    }
}

#[test]
fn an_input_column_is_skipped_where_flight_lacks_an_output_that_is_fed_back() {
    let (mut lacking, mut unusable) = (disturbed(), disturbed());
    // The first condition lacks one response; the same as if none of that input counted there.
    lacking.conditions[0].flight = without(&lacking.conditions[0].flight, |pair, _| pair == Pair::new(2, 1));
    for output in 0..3 {
        unusable.conditions[0].usable[Pair::new(output, 1)] = false;
    }
    let (found, expected) = (fit(&lacking), fit(&unusable));
    assert_eq!((found.coefficients, found.not_fed_back), (expected.coefficients, vec![]));
    // A mixing alone needs no other response of the column.
    (lacking.kind, unusable.kind) = (CouplingKind::Mixing, CouplingKind::Mixing);
    unusable.conditions[0].usable = PairTable::from_fn(3, 2, |pair| pair != Pair::new(2, 1));
    let (found, expected) = (fit(&lacking), fit(&unusable));
    assert_eq!((found.coefficients, found.not_fed_back), (expected.coefficients, vec![]));
}

#[test]
fn a_frequency_is_skipped_where_the_physics_model_lacks_an_output_that_is_fed_back() {
    let (mut lacking, mut shorter) = (disturbed(), disturbed());
    lacking.conditions[2].physics =
        Arc::new(without(&lacking.conditions[2].physics, |pair, k| pair.output == 1 && k == 4));
    shorter.conditions[2].flight = without(&shorter.conditions[2].flight, |_, k| k == 4);
    assert_eq!(fit(&lacking).coefficients, fit(&shorter).coefficients);
}

#[test]
fn an_input_that_flight_never_moved_stays_as_it_is() {
    let mut problem = disturbed();
    for condition in &mut problem.conditions {
        condition.flight = without(&condition.flight, |pair, _| pair.input == 1);
    }
    let found = fit(&problem);
    let of_input = |unknown: &&Unknown| matches!(unknown, Unknown::Mixing { from: 1, .. });
    let expected: Vec<Unknown> = found.unknowns.iter().filter(of_input).copied().collect();
    assert_eq!((&found.undetermined, found.not_fed_back.len()), (&expected, 0));
    assert_eq!(found.matrices.mixing(70.0).column(1), DVector::from_vec(vec![0.0, 1.0]));
}

#[test]
fn what_was_not_measured_coherently_does_not_count() {
    let (mut measured, mut unusable) = (disturbed(), disturbed());
    let omega = Arc::clone(&measured.omega);
    for (condition, other) in measured.conditions.iter_mut().zip(&mut unusable.conditions) {
        condition.coherence = Some(PairTable::from_fn(3, 2, |pair| {
            let coherence = if pair == Pair::new(2, 0) { 0.3 } else { 1.0 };
            CoherenceWeights::of(&omega, &vec![coherence; omega.len()], 0.6, None)
        }));
        other.usable[Pair::new(2, 0)] = false;
    }
    let (found, expected) = (fit(&measured), fit(&unusable));
    for (found, expected) in found.coefficients.iter().flatten().zip(expected.coefficients.iter().flatten()) {
        // One weight for all that counts changes nothing but roundings.
        assert!((found - expected).abs() < 1e-12);
    }
}

#[test]
fn a_response_that_a_physics_model_lacks_is_lacking_once_coupled_and_only_what_depends_on_it() {
    let problem = disturbed();
    let physics = &problem.conditions[0].physics;
    let lacking = without(physics, |pair, k| pair == Pair::new(2, 0) && k == 3);
    let mixing = dmatrix![1.0, 0.1; 0.2, 1.0];
    let free = constant(&mixing, &dmatrix![0.1, 0.2, 0.0; 0.0, 0.1, 0.0]);
    let (found, expected) = (free.response(&lacking, 60.0), free.response(physics, 60.0));
    for (pair, curve) in expected.curves().iter() {
        for (k, expected) in curve.iter().enumerate() {
            let value = found.curve(pair)[k];
            let is_lacking = pair.output == 2 && k == 3;
            assert!(if is_lacking { !value.is_finite() } else { value == *expected }, "{pair:?} {k}");
        }
    }
    let fed_back = constant(&mixing, &dmatrix![0.0, 0.0, 0.1; 0.0, 0.0, 0.0]).response(&lacking, 60.0);
    assert!(fed_back.curves().iter().all(|(_, curve)| !curve[3].is_finite() && curve[4].is_finite()));
}
