//! Tests of the state elimination, on each instruction set of the machine.

use nalgebra::{Complex, DMatrix, dmatrix};
use pulp::{Arch, Scalar, Simd};

use super::elimination::{Elimination, GROUP, evaluate};
use super::frequency_response::FrequencyResponse;
use super::hessenberg_form::HessenbergForm;
use crate::dataset::{Pair, PairTable, StateSpace};

fn siso(a: DMatrix<f64>, b: DMatrix<f64>, c: DMatrix<f64>, d: f64) -> StateSpace {
    StateSpace::new(a, b, c, dmatrix![d]).unwrap()
}

fn oscillator() -> StateSpace {
    siso(
        dmatrix![0.0, 1.0; -4.0, 0.0],
        dmatrix![0.0; 1.0],
        dmatrix![1.0, 0.0],
        0.0,
    )
}

fn only(response: FrequencyResponse) -> Complex<f64> {
    response.curve(Pair::new(0, 0))[0]
}

#[test]
fn a_first_order_lag_has_its_known_response() {
    // 1 / (j omega + 2) at omega = 3: (2 - 3j) / 13.
    let value = only(evaluate(
        &siso(dmatrix![-2.0], dmatrix![1.0], dmatrix![1.0], 0.0),
        &[3.0],
    ));
    assert!((value - Complex::new(2.0 / 13.0, -3.0 / 13.0)).norm() < 1e-16);
}

#[test]
fn a_model_of_order_zero_is_its_feed_through() {
    let empty = siso(
        DMatrix::zeros(0, 0),
        DMatrix::zeros(0, 1),
        DMatrix::zeros(1, 0),
        2.5,
    );
    assert_eq!(only(evaluate(&empty, &[1.0])), Complex::new(2.5, 0.0));
}

#[test]
fn an_undamped_oscillator_at_its_own_frequency_is_not_finite() {
    assert!(!only(evaluate(&oscillator(), &[2.0])).is_finite());
}

#[test]
fn a_pole_on_the_grid_leaves_the_other_frequencies_alone() {
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
    let plain = only(evaluate(
        &siso(a.clone(), dmatrix![1.0; 0.5], dmatrix![1.0, -2.0], 0.0),
        &[1.3],
    ));
    for exponent in [-800, 800] {
        let unit = 2.0_f64.powi(exponent);
        let scaled = only(evaluate(
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
fn units_of_the_states_do_not_matter() {
    let a = dmatrix![-1.0, 2.0; -3.0, -0.5];
    let b = dmatrix![1.0; 0.5];
    let c = dmatrix![1.0, -2.0];
    let scale = DMatrix::from_diagonal(&nalgebra::dvector![1e-9, 1e9]);
    let inverse = DMatrix::from_diagonal(&nalgebra::dvector![1e9, 1e-9]);
    let plain = only(evaluate(
        &siso(a.clone(), b.clone(), c.clone(), 0.1),
        &[1.3],
    ));
    let scaled = only(evaluate(
        &siso(&scale * a * &inverse, scale * b, c * inverse, 0.1),
        &[1.3],
    ));
    // Tolerance: the scaling rounds each entry once.
    assert!((plain - scaled).norm() < 1e-14 * plain.norm());
}

type Values = PairTable<Vec<Complex<f64>>>;

fn on<S: Simd>(simd: S, model: &StateSpace, omega: &[f64]) -> Values {
    let form = &HessenbergForm::new(Arch::new(), model.a().clone(), model);
    let s: Vec<_> = omega
        .iter()
        .map(|omega| Complex::new(0.0, *omega))
        .collect();
    simd.vectorize(Elimination { form, s: &s }).curves().clone()
}

/// Returns the values for every instruction set of this machine with fused multiply-adds; they
/// must agree bit for bit.
fn on_vectors(model: &StateSpace, omega: &[f64]) -> Vec<Values> {
    let mut values = Vec::new();
    #[cfg(target_arch = "x86_64")]
    {
        values.extend(pulp::x86::V3::try_new().map(|simd| on(simd, model, omega)));
        values.extend(pulp::x86::V4::try_new().map(|simd| on(simd, model, omega)));
    }
    #[cfg(target_arch = "aarch64")]
    values.extend(pulp::aarch64::Neon::try_new().map(|simd| on(simd, model, omega)));
    values
}

/// Returns a matrix with reproducible irregular entries from a sine.
fn matrix(rows: usize, columns: usize, seed: f64) -> DMatrix<f64> {
    DMatrix::from_fn(rows, columns, |row, column| {
        (seed + 7.3 * row as f64 + 2.9 * (column * column) as f64).sin()
    })
}

fn model(order: usize, outputs: usize, inputs: usize) -> StateSpace {
    let a = matrix(order, order, 0.3) - DMatrix::identity(order, order) * 2.0;
    let b = matrix(order, inputs, 1.1);
    let c = matrix(outputs, order, 2.3);
    let d = matrix(outputs, inputs, 3.7);
    StateSpace::new(a, b, c, d).unwrap()
}

/// Returns frequencies from far below the poles, where the real rows are the pivots, to far
/// above, where the active rows are; in between, the lanes of a vector differ.
fn wide(count: usize) -> Vec<f64> {
    (0..count)
        .map(|k| 1e-3 * 1e6_f64.powf(k as f64 / count as f64))
        .collect()
}

/// Computes the response with a dense matrix decomposition.
fn dense(model: &StateSpace, omega: f64) -> DMatrix<Complex<f64>> {
    let [a, b, c, d] =
        [model.a(), model.b(), model.c(), model.d()].map(|matrix| matrix.map(Complex::from));
    let states = DMatrix::identity(a.nrows(), a.nrows()) * Complex::new(0.0, omega) - a;
    c * states.lu().solve(&b).unwrap() + d
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
fn vectors_of_every_length_agree_with_scalars_at_every_remainder_length() {
    for count in 0..=17 {
        let model = model(9, 3, 3);
        let omega = wide(count);
        let scalar = on(Scalar::new(), &model, &omega);
        for vectors in on_vectors(&model, &omega) {
            // Tolerance: two backward stable solutions of order 9, each with rounding errors of
            // at most 9 tau times 1e-16.
            assert!(
                count == 0 || difference(&vectors, &scalar) < 8e-12,
                "{count} frequencies"
            );
        }
    }
}

#[test]
fn vectors_of_every_length_give_the_same_bits() {
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
        let omega = wide(61);
        let results = on_vectors(&model, &omega);
        assert!(
            results.windows(2).all(|pair| pair[0] == pair[1]),
            "order {order}"
        );
    }
}

#[test]
fn values_depend_on_the_frequencies_of_their_group_only() {
    let model = model(14, 6, 4);
    let omega = wide(45);
    let together = on_vectors(&model, &omega);
    for (k, omega) in omega.chunks(GROUP).enumerate() {
        let alone = on_vectors(&model, omega);
        for (alone, together) in alone.iter().zip(&together) {
            let same =
                |(pair, values): (_, &Vec<_>)| together[pair][k * GROUP..].starts_with(values);
            assert!(alone.iter().all(same), "group {k}");
        }
    }
}

#[test]
fn frequencies_of_a_group_may_need_different_pivots() {
    // Both ends in one group: the real row must be the pivot at 1e-4 rad/s, the complex row at
    // 1e4 rad/s.
    let model = model(14, 6, 4);
    let omega: Vec<f64> = (0..29)
        .map(|k| if k % 2 == 0 { 1e-4 } else { 1e4 } * (1.0 + f64::from(k)))
        .collect();
    let mut results = on_vectors(&model, &omega);
    results.push(on(Scalar::new(), &model, &omega));
    for values in results {
        for (k, omega) in omega.iter().enumerate() {
            let expected = dense(&model, *omega);
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
        let b = matrix(order, 2, 1.1);
        let c = matrix(3, order, 2.3);
        // All poles at zero; then pairs of poles at 2 rad/s and, for an odd order, a single
        // pole at zero.
        let turning = DMatrix::from_fn(order, order, |row, column| match (row % 2, column) {
            (0, column) if column == row + 1 => 2.0,
            (1, column) if column + 1 == row => -2.0,
            _ => 0.0,
        });
        for (a, omega) in [(DMatrix::zeros(order, order), 0.0), (turning, 2.0)] {
            let model = StateSpace::new(a, b.clone(), c.clone(), DMatrix::zeros(3, 2)).unwrap();
            for frequencies in [vec![omega], vec![1.0, omega, 3.0]] {
                let mut results = on_vectors(&model, &frequencies);
                results.push(on(Scalar::new(), &model, &frequencies));
                let finite = |k: usize| {
                    results
                        .iter()
                        .all(|values| values.iter().all(|(_, curve)| curve[k].is_finite()))
                };
                assert!(
                    frequencies.len() == 1 || (finite(0) && finite(2)),
                    "{order} states"
                );
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
    let mut results = on_vectors(&model, &[0.5, 1.0, 2.0]);
    results.push(on(Scalar::new(), &model, &[0.5, 1.0, 2.0]));
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

#[test]
fn a_model_of_two_separate_parts_is_the_sum_of_both() {
    let a = dmatrix![-1.0, 2.0, 0.0, 0.0; -3.0, -0.5, 0.0, 0.0; 0.0, 0.0, -0.2, 4.0; 0.0, 0.0, -5.0, -0.3];
    let b = dmatrix![1.0; 0.5; -1.0; 2.0];
    let c = dmatrix![1.0, -2.0, 0.5, 3.0];
    let part = |at: usize| {
        let a = a.view((at, at), (2, 2));
        let b = b.rows(at, 2);
        let c = c.columns(at, 2);
        StateSpace::new(
            a.into_owned(),
            b.into_owned(),
            c.into_owned(),
            dmatrix![0.0],
        )
        .unwrap()
    };
    let whole = StateSpace::new(a.clone(), b.clone(), c.clone(), dmatrix![0.0]).unwrap();
    let omega = wide(11);
    let first = on(Scalar::new(), &part(0), &omega);
    let second = on(Scalar::new(), &part(2), &omega);
    let sum = first.map(|pair, values| {
        values
            .iter()
            .zip(&second[pair])
            .map(|(a, b)| a + b)
            .collect()
    });
    for values in on_vectors(&whole, &omega) {
        assert!(difference(&values, &sum) < 1e-14);
    }
}
