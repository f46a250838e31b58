//! Invariance of the fit: order of channels and conditions, units, synthetic flight.

use std::sync::Arc;

use nalgebra::DMatrix;
use proptest::prelude::*;

use gdcm_model::dataset::{Pair, PairTable};
use gdcm_model::response::FrequencyResponse;

use super::{constant, disturbed, fit};
use crate::couplings::CouplingProblem;

/// The problem with reordered channels: `outputs[new]` and `inputs[new]` are the old indices.
fn permuted(problem: &CouplingProblem, outputs: &[usize], inputs: &[usize]) -> CouplingProblem {
    let mut permuted = problem.clone();
    permuted.on_axis = permuted_table(&problem.on_axis, outputs, inputs);
    for condition in &mut permuted.conditions {
        let physics = permuted_table(condition.physics.curves(), outputs, inputs);
        let flight = permuted_table(condition.flight.curves(), outputs, inputs);
        let deviation = condition.deviation.as_ref().unwrap();
        condition.deviation = Some(permuted_table(deviation, outputs, inputs));
        condition.physics = Arc::new(FrequencyResponse::new(physics));
        condition.flight = FrequencyResponse::new(flight);
    }
    permuted
}

fn permuted_table<T: Clone>(
    table: &PairTable<T>,
    outputs: &[usize],
    inputs: &[usize],
) -> PairTable<T> {
    table.map(|pair, _| table[Pair::new(outputs[pair.output], inputs[pair.input])].clone())
}

#[test]
fn permuting_the_channels_permutes_the_couplings() {
    let outputs = [2, 0, 1];
    let inputs = [1, 0];
    let found = fit(&disturbed());
    let moved = fit(&permuted(&disturbed(), &outputs, &inputs));
    // 70 kt: any airspeed of the schedule.
    let m = found.matrices.mixing(70.0);
    let k = found.matrices.feedback();
    let expected_m = DMatrix::from_fn(2, 2, |to, from| m[(inputs[to], inputs[from])]);
    let expected_k = DMatrix::from_fn(2, 3, |input, output| k[(inputs[input], outputs[output])]);
    // The sums of each of the five passes are rounded in another order.
    assert!((moved.matrices.mixing(70.0) - expected_m).amax() < 1e-12);
    assert!((moved.matrices.feedback() - expected_k).amax() < 1e-12);
}

/// The problem with outputs and inputs in other units; the factors are new units per old unit.
fn in_other_units(problem: &CouplingProblem, outputs: &[f64], inputs: &[f64]) -> CouplingProblem {
    let mut problem = problem.clone();
    for condition in &mut problem.conditions {
        condition.physics = Arc::new(scaled_response(&condition.physics, outputs, inputs));
        condition.flight = scaled_response(&condition.flight, outputs, inputs);
    }
    problem
}

fn scaled_response(
    response: &FrequencyResponse,
    outputs: &[f64],
    inputs: &[f64],
) -> FrequencyResponse {
    FrequencyResponse::new(response.curves().map(|pair, curve| {
        let scale = outputs[pair.output] / inputs[pair.input];
        curve.iter().map(|value| value * scale).collect()
    }))
}

/// Returns the feedback with these shares: each column divided by the peak magnitude in the
/// output's physics responses.
/// Such feedback uses comparable shares of an input, whatever the units of the outputs.
fn feedback_with_shares(problem: &CouplingProblem, shares: &DMatrix<f64>) -> DMatrix<f64> {
    let mut peaks = [0.0_f64; 3];
    for condition in &problem.conditions {
        for (pair, curve) in condition.physics.curves().iter() {
            for value in curve {
                peaks[pair.output] = peaks[pair.output].max(value.norm());
            }
        }
    }
    DMatrix::from_fn(2, 3, |input, output| {
        shares[(input, output)] / peaks[output]
    })
}

/// The disturbed aircraft with flight responses generated from its physics models and these
/// couplings.
fn flown_with(mixing: &DMatrix<f64>, feedback: &DMatrix<f64>) -> CouplingProblem {
    let mut problem = disturbed();
    let matrices = constant(mixing, feedback);
    for condition in &mut problem.conditions {
        condition.flight = matrices.response(&condition.physics, condition.airspeed_kt);
        condition.usable = PairTable::filled(3, 2, true);
    }
    problem.options.ridge = 1e-9;
    problem.options.passes = 12;
    problem
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(12))]

    #[test]
    fn other_units_only_scale_the_couplings(
        outputs in proptest::collection::vec(-2.0..2.0_f64, 3),
        inputs in proptest::collection::vec(-2.0..2.0_f64, 2),
    ) {
        let outputs: Vec<f64> = outputs.iter().map(|power| 10_f64.powf(*power)).collect();
        let inputs: Vec<f64> = inputs.iter().map(|power| 10_f64.powf(*power)).collect();
        let found = fit(&disturbed());
        let scaled = fit(&in_other_units(&disturbed(), &outputs, &inputs));
        for (to, from) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
            let [a, b] = [&found, &scaled].map(|fit| fit.matrices.mixing(70.0)[(to, from)]);
            // Tolerance: rounding errors of five solves whose scaled matrices have condition
            // numbers near 1e4.
            prop_assert!((a * inputs[to] / inputs[from] - b).abs() < 1e-9 * b.abs().max(1e-3));
        }
        for (input, output) in [(0, 0), (0, 1), (0, 2), (1, 0), (1, 1), (1, 2)] {
            let [a, b] = [&found, &scaled].map(|fit| fit.matrices.feedback()[(input, output)]);
            let expected = a * inputs[input] / outputs[output];
            prop_assert!((expected - b).abs() < 1e-8 * b.abs(), "{expected} {b}");
        }
    }

    #[test]
    fn couplings_in_synthetic_flight_are_recovered(
        mixed in proptest::collection::vec(-0.2..0.2_f64, 2),
        share in proptest::collection::vec(-0.15..0.15_f64, 6),
    ) {
        let mixing = DMatrix::from_row_slice(2, 2, &[1.0, mixed[0], mixed[1], 1.0]);
        let shares = DMatrix::from_row_slice(2, 3, &share);
        let feedback = feedback_with_shares(&disturbed(), &shares);
        let found = fit(&flown_with(&mixing, &feedback)).matrices;
        // Tolerance: the ridge, 1e-9, times the ratio of the information about the best and the
        // worst determined entry.
        prop_assert!((found.normalised_mixing(70.0) - &mixing).amax() < 1e-5, "{found:?}");
        let error = (found.feedback() - &feedback).amax();
        prop_assert!(error < 1e-5 * feedback.amax().max(1.0), "{found:?}");
    }
}

#[test]
fn the_order_of_the_conditions_does_not_matter() {
    let mut problem = disturbed();
    let found = fit(&problem);
    problem.conditions.reverse();
    let reversed = fit(&problem);
    // The sums are rounded in another order.
    assert!((found.matrices.mixing(70.0) - reversed.matrices.mixing(70.0)).amax() < 1e-12);
    assert!((found.matrices.feedback() - reversed.matrices.feedback()).amax() < 1e-12);
}
