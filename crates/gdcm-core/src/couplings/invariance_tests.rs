//! What a fit of couplings does not depend on: units, and the order of the conditions; and that known couplings come back.

use std::sync::Arc;

use nalgebra::DMatrix;
use proptest::prelude::*;

use super::known_answers_tests::{constant, disturbed, fit};
use super::*;
use crate::dataset::{Pair, PairTable};
use crate::response::FrequencyResponse;

/// The problem with outputs and inputs in other units: so many of the new ones to one of the old.
fn in_other_units(problem: &CouplingProblem, outputs: &[f64], inputs: &[f64]) -> CouplingProblem {
    let scaled = |of: &FrequencyResponse| {
        let scale = |pair: Pair| outputs[pair.output] / inputs[pair.input];
        FrequencyResponse::new(of.curves().map(|pair, curve| curve.iter().map(|value| value * scale(pair)).collect()))
    };
    let mut problem = problem.clone();
    for condition in &mut problem.conditions {
        condition.physics = Arc::new(scaled(&condition.physics));
        condition.flight = scaled(&condition.flight);
    }
    problem
}

/// The disturbed aircraft, its flight replaced by that of its physics models with couplings of ones on the diagonal of M.
fn flown_with(mixing: &DMatrix<f64>, share: &DMatrix<f64>) -> (CouplingProblem, DMatrix<f64>) {
    let mut problem = disturbed();
    let largest = |output: usize| {
        let values = problem
            .conditions
            .iter()
            .flat_map(|of| (0..2).map(move |input| of.physics.curve(Pair::new(output, input))));
        values.flatten().map(|value| value.norm()).fold(0.0, f64::max)
    };
    let peaks: Vec<f64> = (0..3).map(largest).collect();
    let feedback = DMatrix::from_fn(2, 3, |input, output| share[(input, output)] / peaks[output]);
    let matrices = constant(mixing, &feedback);
    for condition in &mut problem.conditions {
        condition.flight = matrices.response(&condition.physics, condition.airspeed_kt);
        condition.usable = PairTable::filled(3, 2, true);
    }
    problem.options.ridge = 1e-9;
    problem.options.solves = 12;
    (problem, feedback)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(12))]

    #[test]
    fn other_units_scale_the_couplings_and_nothing_else(
        outputs in proptest::collection::vec(-2.0..2.0_f64, 3),
        inputs in proptest::collection::vec(-2.0..2.0_f64, 2),
    ) {
        let [outputs, inputs] = [outputs, inputs].map(|of| of.into_iter().map(|power| 10_f64.powf(power)).collect::<Vec<_>>());
        let (found, scaled) = (fit(&disturbed()), fit(&in_other_units(&disturbed(), &outputs, &inputs)));
        for (to, from) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
            let [a, b] = [&found, &scaled].map(|of| of.matrices.mixing(70.0)[(to, from)]);
            // Roundings of five solves, whose normal matrices have condition numbers of some 1e4 once scaled.
            prop_assert!((a * inputs[to] / inputs[from] - b).abs() < 1e-9 * b.abs().max(1e-3));
        }
        for (input, output) in (0..2).flat_map(|input| (0..3).map(move |output| (input, output))) {
            let [a, b] = [&found, &scaled].map(|of| of.matrices.feedback()[(input, output)]);
            let expected = a * inputs[input] / outputs[output];
            prop_assert!((expected - b).abs() < 1e-8 * b.abs(), "{expected} {b}");
        }
    }

    #[test]
    fn couplings_that_flight_was_made_with_come_back(
        mixed in proptest::collection::vec(-0.2..0.2_f64, 2),
        share in proptest::collection::vec(-0.15..0.15_f64, 6),
    ) {
        let mixing = DMatrix::from_row_slice(2, 2, &[1.0, mixed[0], mixed[1], 1.0]);
        let (problem, feedback) = flown_with(&mixing, &DMatrix::from_row_slice(2, 3, &share));
        let found = fit(&problem).matrices;
        // The ridge of 1e-9, times how much worse the least known entry is known than the best.
        prop_assert!((found.normalised_mixing(70.0) - &mixing).amax() < 1e-5, "{found:?}");
        prop_assert!((found.feedback() - &feedback).amax() < 1e-5 * feedback.amax().max(1.0), "{found:?}");
    }
}

#[test]
fn the_order_of_the_conditions_does_not_matter() {
    let mut problem = disturbed();
    let found = fit(&problem);
    problem.conditions.reverse();
    let reversed = fit(&problem);
    // The same sums in another order.
    assert!((found.matrices.mixing(70.0) - reversed.matrices.mixing(70.0)).amax() < 1e-12);
    assert!((found.matrices.feedback() - reversed.matrices.feedback()).amax() < 1e-12);
}
