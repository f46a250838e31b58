//! Tests of the state elimination: known responses, and agreement between the instruction sets of
//! this machine.

use nalgebra::{Complex, DMatrix, dmatrix};
use pulp::{Arch, Scalar, Simd};

use super::elimination::{Elimination, GROUP, evaluate};
use super::frequency_response::FrequencyResponse;
use super::hessenberg_form::HessenbergForm;
use crate::dataset::{Pair, PairTable, StateSpace};

fn siso(a: DMatrix<f64>, b: DMatrix<f64>, c: DMatrix<f64>, d: f64) -> StateSpace {
    StateSpace::new(a, b, c, dmatrix![d]).unwrap()
}

/// `H(s) = 1 / (s^2 + 4)`: undamped, with the natural frequency 2 rad/s.
fn oscillator() -> StateSpace {
    siso(
        dmatrix![0.0, 1.0; -4.0, 0.0],
        dmatrix![0.0; 1.0],
        dmatrix![1.0, 0.0],
        0.0,
    )
}

/// The value at the only frequency of a response with one input and one output.
fn single_value(response: FrequencyResponse) -> Complex<f64> {
    response.curve(Pair::new(0, 0))[0]
}

#[test]
fn a_first_order_lag_has_its_known_response() {
    // 1 / (j omega + 2) at omega = 3: (2 - 3j) / 13.
    let value = single_value(evaluate(
        &siso(dmatrix![-2.0], dmatrix![1.0], dmatrix![1.0], 0.0),
        &[3.0],
    ));
    assert!((value - Complex::new(2.0 / 13.0, -3.0 / 13.0)).norm() < 1e-16);
}

#[test]
fn a_model_without_states_is_its_feed_through() {
    let empty = siso(
        DMatrix::zeros(0, 0),
        DMatrix::zeros(0, 1),
        DMatrix::zeros(1, 0),
        2.5,
    );
    assert_eq!(
        single_value(evaluate(&empty, &[1.0])),
        Complex::new(2.5, 0.0)
    );
}

#[test]
fn an_undamped_oscillator_at_its_natural_frequency_is_not_finite() {
    assert!(!single_value(evaluate(&oscillator(), &[2.0])).is_finite());
}

#[test]
fn a_pole_on_the_grid_does_not_affect_the_other_frequencies() {
    let omega: Vec<f64> = (0..19).map(|k| f64::from(k) * 0.25).collect();
    let response = evaluate(&oscillator(), &omega);
    for (omega, value) in omega.iter().zip(response.curve(Pair::new(0, 0))) {
        // 1 / (4 - omega^2): the difference amplifies the rounding errors of a few operations
        // up to 8 times.
        let expected = 1.0 / (4.0 - omega * omega);
        assert_eq!(value.is_finite(), *omega != 2.0, "{omega}");
        assert!(
            *omega == 2.0 || (value - expected).norm() < 1e-14 * expected.abs(),
            "{omega}"
        );
    }
}

#[test]
fn units_of_inputs_and_outputs_only_scale_the_response() {
    let a = dmatrix![-1.0, 2.0; -3.0, -0.5];
    let plain = single_value(evaluate(
        &siso(a.clone(), dmatrix![1.0; 0.5], dmatrix![1.0, -2.0], 0.0),
        &[1.3],
    ));
    for exponent in [-800, 800] {
        let unit = 2.0_f64.powi(exponent);
        let scaled = single_value(evaluate(
            &siso(
                a.clone(),
                dmatrix![unit; 0.5 * unit],
                dmatrix![1.0, -2.0],
                0.0,
            ),
            &[1.3],
        ));
        // The unit is a power of two, so that scaling causes no rounding.
        assert_eq!(scaled, plain * unit);
    }
}

#[test]
fn units_of_the_states_do_not_change_the_response() {
    let a = dmatrix![-1.0, 2.0; -3.0, -0.5];
    let b = dmatrix![1.0; 0.5];
    let c = dmatrix![1.0, -2.0];
    let scale = DMatrix::from_diagonal(&nalgebra::dvector![1e-9, 1e9]);
    let inverse = DMatrix::from_diagonal(&nalgebra::dvector![1e9, 1e-9]);
    let plain = single_value(evaluate(
        &siso(a.clone(), b.clone(), c.clone(), 0.1),
        &[1.3],
    ));
    let scaled = single_value(evaluate(
        &siso(&scale * a * &inverse, scale * b, c * inverse, 0.1),
        &[1.3],
    ));
    // Tolerance: the scaling rounds each entry once.
    assert!((plain - scaled).norm() < 1e-14 * plain.norm());
}

type Values = PairTable<Vec<Complex<f64>>>;

/// Evaluates `H(j omega)` with the instruction set `simd`.
fn evaluate_with<S: Simd>(simd: S, model: &StateSpace, omega: &[f64]) -> Values {
    let form = &HessenbergForm::new(Arch::new(), model.a().clone(), model);
    let s: Vec<_> = omega
        .iter()
        .map(|omega| Complex::new(0.0, *omega))
        .collect();
    simd.vectorize(Elimination { form, s: &s }).curves().clone()
}

/// Evaluates `H(j omega)` with every vector instruction set of this machine, all of which have
/// fused multiply-adds: the results must agree bit for bit.
fn evaluate_with_vectors(model: &StateSpace, omega: &[f64]) -> Vec<Values> {
    let mut values = Vec::new();
    #[cfg(target_arch = "x86_64")]
    {
        values.extend(pulp::x86::V3::try_new().map(|simd| evaluate_with(simd, model, omega)));
        values.extend(pulp::x86::V4::try_new().map(|simd| evaluate_with(simd, model, omega)));
    }
    #[cfg(target_arch = "aarch64")]
    values.extend(pulp::aarch64::Neon::try_new().map(|simd| evaluate_with(simd, model, omega)));
    values
}

/// Returns a matrix with irregular, reproducible entries between -1 and 1.
fn irregular_matrix(rows: usize, columns: usize, seed: f64) -> DMatrix<f64> {
    DMatrix::from_fn(rows, columns, |row, column| {
        (seed + 7.3 * row as f64 + 2.9 * (column * column) as f64).sin()
    })
}

/// Returns a full model without structure, whose poles are shifted by -2 rad/s.
fn model(order: usize, outputs: usize, inputs: usize) -> StateSpace {
    let a = irregular_matrix(order, order, 0.3) - DMatrix::identity(order, order) * 2.0;
    let b = irregular_matrix(order, inputs, 1.1);
    let c = irregular_matrix(outputs, order, 2.3);
    let d = irregular_matrix(outputs, inputs, 3.7);
    StateSpace::new(a, b, c, d).unwrap()
}

/// Returns frequencies from 1e-3 rad/s, far below the poles, to 1e3 rad/s, far above: the pivots
/// are the real rows at the lower end (step 5 of the algorithm), and the active rows at the upper
/// end (step 4); in between, the lanes of a vector differ.
fn wide_grid(count: usize) -> Vec<f64> {
    (0..count)
        .map(|k| 1e-3 * 1e6_f64.powf(k as f64 / count as f64))
        .collect()
}

/// Computes `C (j omega I - A)^-1 B + D` with a dense LU decomposition.
fn dense_response(model: &StateSpace, omega: f64) -> DMatrix<Complex<f64>> {
    let [a, b, c, d] =
        [model.a(), model.b(), model.c(), model.d()].map(|matrix| matrix.map(Complex::from));
    let system = DMatrix::identity(a.nrows(), a.nrows()) * Complex::new(0.0, omega) - a;
    c * system.lu().solve(&b).unwrap() + d
}

fn flattened(values: &Values) -> Vec<Complex<f64>> {
    values
        .iter()
        .flat_map(|(_, values)| values.clone())
        .collect()
}

/// Returns the maximum difference, relative to the largest expected value.
fn difference(found: &Values, expected: &Values) -> f64 {
    let found = flattened(found);
    let expected = flattened(expected);
    let largest = expected
        .iter()
        .map(|value| value.norm())
        .fold(0.0, f64::max);
    let differences = found
        .iter()
        .zip(&expected)
        .map(|(found, expected)| (found - expected).norm());
    // `f64::max` would drop a NaN.
    differences.fold(
        0.0,
        |worst: f64, next| if next <= worst { worst } else { next },
    ) / largest
}

#[test]
fn vectors_agree_with_scalars_for_every_number_of_frequencies() {
    // 0 to 17 frequencies: no group of eight, full groups, and every length of the last group.
    for count in 0..=17 {
        let model = model(9, 3, 3);
        let omega = wide_grid(count);
        let scalar = evaluate_with(Scalar::new(), &model, &omega);
        for vectors in evaluate_with_vectors(&model, &omega) {
            // The bound on each of them is 3e-11 (`pivot_threshold.rs`); the tolerance is stricter,
            // because errors in practice are below 1e-12.
            assert!(
                count == 0 || difference(&vectors, &scalar) < 8e-12,
                "{count} frequencies"
            );
        }
    }
}

#[test]
fn all_vector_instruction_sets_give_the_same_bits() {
    // More inputs than outputs and the reverse, and up to 30 states.
    for (order, outputs, inputs) in [
        (0, 2, 1),
        (1, 1, 1),
        (2, 6, 4),
        (12, 6, 4),
        (30, 6, 4),
        (17, 3, 5),
        (8, 7, 6),
        (7, 9, 9),
    ] {
        let model = model(order, outputs, inputs);
        let omega = wide_grid(61);
        let results = evaluate_with_vectors(&model, &omega);
        assert!(
            results.windows(2).all(|pair| pair[0] == pair[1]),
            "order {order}"
        );
    }
}

#[test]
fn a_value_depends_only_on_the_frequencies_in_its_group() {
    let model = model(14, 6, 4);
    let omega = wide_grid(45);
    let together = evaluate_with_vectors(&model, &omega);
    for (k, omega) in omega.chunks(GROUP).enumerate() {
        let alone = evaluate_with_vectors(&model, omega);
        for (alone, together) in alone.iter().zip(&together) {
            for (pair, values) in alone.iter() {
                assert!(
                    together[pair][k * GROUP..].starts_with(values),
                    "group {k}, {pair:?}"
                );
            }
        }
    }
}

#[test]
fn a_group_with_very_low_and_very_high_frequencies_is_accurate() {
    // Both ends in one group: the real row must be the pivot at 1e-4 rad/s, the complex row at
    // 1e4 rad/s.
    let model = model(14, 6, 4);
    let omega: Vec<f64> = (0..29)
        .map(|k| if k % 2 == 0 { 1e-4 } else { 1e4 } * (1.0 + f64::from(k)))
        .collect();
    let mut results = evaluate_with_vectors(&model, &omega);
    results.push(evaluate_with(Scalar::new(), &model, &omega));
    for values in results {
        for (k, omega) in omega.iter().enumerate() {
            let expected = dense_response(&model, *omega);
            let largest = expected
                .iter()
                .map(|value| value.norm())
                .fold(0.0, f64::max);
            for (pair, values) in values.iter() {
                let error = (values[k] - expected[(pair.output, pair.input)]).norm();
                // Tolerance: the bound of threshold pivoting, 3e-11, times the condition number
                // of a random matrix of order 14.
                assert!(error < 1e-9 * largest, "{omega}, {pair:?}: {error}");
            }
        }
    }
}

#[test]
fn poles_on_the_grid_leave_other_frequencies_finite() {
    for order in 1..=9 {
        let b = irregular_matrix(order, 2, 1.1);
        let c = irregular_matrix(3, order, 2.3);
        // First all poles at zero; then pairs of poles at 2 rad/s and, for an odd order, a single
        // pole at zero.
        let oscillators = DMatrix::from_fn(order, order, |row, column| match (row % 2, column) {
            (0, column) if column == row + 1 => 2.0,
            (1, column) if column + 1 == row => -2.0,
            _ => 0.0,
        });
        for (a, omega) in [(DMatrix::zeros(order, order), 0.0), (oscillators, 2.0)] {
            let model = StateSpace::new(a, b.clone(), c.clone(), DMatrix::zeros(3, 2)).unwrap();
            for frequencies in [vec![omega], vec![1.0, omega, 3.0]] {
                let mut results = evaluate_with_vectors(&model, &frequencies);
                results.push(evaluate_with(Scalar::new(), &model, &frequencies));
                // A pole alone must not panic; beside it, 1 and 3 rad/s must be finite.
                if frequencies.len() == 1 {
                    continue;
                }
                for values in &results {
                    for (pair, curve) in values.iter() {
                        assert!(
                            curve[0].is_finite() && curve[2].is_finite(),
                            "{order} states, {pair:?}: {curve:?}"
                        );
                    }
                }
            }
        }
    }
}

#[test]
fn a_chain_coupled_by_1e_minus_55_neither_overflows_nor_loses_its_coupling() {
    // The inverse coupling is 1e55 per step: without the factor `h` of an interchange, the
    // square of a pivot would overflow in the fifth step.
    let weak = 1e-55;
    let a = DMatrix::from_fn(8, 8, |row, column| match row.abs_diff(column) {
        0 => -1.0,
        1 => weak,
        _ => 0.0,
    });
    let model = StateSpace::new(
        a,
        DMatrix::identity(8, 8),
        DMatrix::identity(8, 8),
        DMatrix::zeros(8, 8),
    )
    .unwrap();
    let mut results = evaluate_with_vectors(&model, &[0.5, 1.0, 2.0]);
    results.push(evaluate_with(Scalar::new(), &model, &[0.5, 1.0, 2.0]));
    // At 1 rad/s, with the lag 1 / (1 + j): a diagonal entry is the lag, and an entry beside the
    // diagonal is the lag twice with the coupling between. The others are below 1e-100.
    for values in results {
        for (pair, values) in values.iter() {
            let lag = Complex::new(0.5, -0.5);
            let expected = match pair.output.abs_diff(pair.input) {
                0 => lag,
                1 => lag * lag * weak,
                _ => continue,
            };
            // Tolerance: about a dozen roundings.
            assert!(
                (values[1] - expected).norm() < 1e-14 * expected.norm(),
                "{pair:?}: {}",
                values[1]
            );
        }
    }
}

/// Returns the states `first` and `first + 1` of a model as a model without feed-through.
fn two_states(whole: &StateSpace, first: usize) -> StateSpace {
    siso(
        whole.a().view((first, first), (2, 2)).into_owned(),
        whole.b().rows(first, 2).into_owned(),
        whole.c().columns(first, 2).into_owned(),
        0.0,
    )
}

#[test]
fn a_model_of_two_decoupled_parts_is_the_sum_of_both() {
    let a = dmatrix![
        -1.0, 2.0, 0.0, 0.0;
        -3.0, -0.5, 0.0, 0.0;
        0.0, 0.0, -0.2, 4.0;
        0.0, 0.0, -5.0, -0.3
    ];
    let b = dmatrix![1.0; 0.5; -1.0; 2.0];
    let c = dmatrix![1.0, -2.0, 0.5, 3.0];
    let whole = siso(a, b, c, 0.0);
    let omega = wide_grid(11);
    let first = evaluate_with(Scalar::new(), &two_states(&whole, 0), &omega);
    let second = evaluate_with(Scalar::new(), &two_states(&whole, 2), &omega);
    let sum = first.map(|pair, values| {
        values
            .iter()
            .zip(&second[pair])
            .map(|(a, b)| a + b)
            .collect()
    });
    for values in evaluate_with_vectors(&whole, &omega) {
        assert!(difference(&values, &sum) < 1e-14);
    }
}
