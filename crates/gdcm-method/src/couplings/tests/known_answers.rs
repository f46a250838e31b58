//! Comparison with independent numpy results, the optimality of a pass, and error bars.

use nalgebra::{Complex, DMatrix};
use serde_json::Value;

use gdcm_model::dataset::{ConditionId, StateSpace};
use gdcm_model::executor::Sequential;
use gdcm_model::progress::Unobserved;

use super::{REFERENCE, constant, disturbed, fit, matrix, matrix_at, numbers, synthetic_aircraft};
use crate::correction::Pade;
use crate::couplings::jackknife::left_out_fits;
use crate::couplings::problem::{CouplingError, CouplingOptions};
use crate::couplings::{CouplingBars, CouplingMatrices, CouplingProblem, Unknown};

/// Reads the names of unknowns: `["M", to, from, power]` or `["K", input, output]`.
fn unknowns(value: &Value) -> Vec<Unknown> {
    value
        .as_array()
        .unwrap()
        .iter()
        .map(|name| match name[0].as_str().unwrap() {
            "M" => Unknown::Mixing {
                to: index(&name[1]),
                from: index(&name[2]),
                power: index(&name[3]),
            },
            _ => Unknown::Feedback {
                input: index(&name[1]),
                output: index(&name[2]),
            },
        })
        .collect()
}

fn index(value: &Value) -> usize {
    value.as_u64().unwrap() as usize
}

#[test]
fn the_couplings_of_the_synthetic_aircraft_are_recovered() {
    let toy = &REFERENCE["toy"];
    let tolerance = toy["recovered"]["tolerance"].as_f64().unwrap();
    let passes = toy["recovered"]["solves"].as_u64().unwrap() as usize;
    let problem = synthetic_aircraft(
        "R",
        CouplingOptions {
            ridge: 1e-9,
            passes,
            ..CouplingOptions::default()
        },
    );
    let found = fit(&problem);
    assert!((found.matrices.feedback() - matrix(&toy["true_K"])).amax() < tolerance);
    for (condition, expected) in problem
        .conditions
        .iter()
        .zip(toy["true_M"].as_array().unwrap())
    {
        let error = (found.matrices.mixing(condition.airspeed_kt) - matrix(expected)).amax();
        assert!(error < tolerance, "{} kt: {error:e}", condition.airspeed_kt);
    }
    assert!(found.residual < 1e-13, "{:e}", found.residual);
    assert!(found.not_fed_back.is_empty() && found.undetermined.is_empty());
}

#[test]
fn every_pass_for_the_disturbed_aircraft_equals_the_reference() {
    let known = &REFERENCE["toy"]["disturbed"];
    let found = fit(&disturbed());
    assert_eq!(found.unknowns, unknowns(&REFERENCE["toy"]["names"]));
    let passes = known["coefficients_of_each_solve"].as_array().unwrap();
    assert_eq!(found.coefficients.len(), passes.len());
    for (pass, (coefficients, expected)) in found.coefficients.iter().zip(passes).enumerate() {
        for (unknown, expected) in numbers(expected).into_iter().enumerate() {
            let error = (coefficients[unknown] - expected).abs();
            assert!(
                error < known["tolerance"].as_f64().unwrap(),
                "pass {pass}, unknown {unknown}: {error:e}"
            );
        }
    }
}

#[test]
fn a_coupled_state_space_with_feed_through_equals_the_reference() {
    let known = &REFERENCE["state_space"];
    let [a, b, c, d, m, k] = ["A", "B", "C", "D", "M", "K"].map(|name| matrix(&known[name]));
    let physics = StateSpace::new(a, b, c, d).unwrap();
    let coupled = constant(&m, &k)
        .model(&physics, 60.0, Pade::new(4).unwrap())
        .unwrap();
    let found = [coupled.a(), coupled.b(), coupled.c(), coupled.d()];
    for (found, expected) in found
        .into_iter()
        .zip(known["renovated"].as_array().unwrap())
    {
        assert!((found - matrix(expected)).amax() < known["tolerance"].as_f64().unwrap());
    }
}

/// Dense form of the least-squares problem in the last pass, `min sum q^2 |S R' - F M - F K R'|^2`
/// over the entries of `M` and `K`, with a complex row for each response and frequency. `H` and
/// `R'` are the physics and the flight response, `S = (I - H K_0)^-1` and `F = S H`, where `K_0` is
/// the feedback from the pass before.
struct DenseProblem {
    /// A column for each unknown: `F` times the unknown's factor, 1 or an entry of `R'`.
    columns: Vec<Vec<Complex<f64>>>,
    /// `S R'`.
    right_side: Vec<Complex<f64>>,
    /// `q^2`.
    squared_weights: Vec<f64>,
}

impl DenseProblem {
    fn new(problem: &CouplingProblem, unknowns: &[Unknown], last: &CouplingMatrices) -> Self {
        let mut dense = Self {
            columns: vec![Vec::new(); unknowns.len()],
            right_side: Vec::new(),
            squared_weights: Vec::new(),
        };
        for condition in &problem.conditions {
            let v: f64 = last.airspeeds().scaled(condition.airspeed_kt);
            for k in 0..problem.omega.len() {
                let h = matrix_at(&condition.physics, k);
                let r = matrix_at(&condition.flight, k);
                let s = (DMatrix::identity(3, 3) - &h * last.feedback().map(Complex::from))
                    .try_inverse()
                    .unwrap();
                let f = &s * &h;
                let s_r = &s * &r;
                let coupled = &f * last.mixing(condition.airspeed_kt).map(Complex::from);
                for pair in problem.on_axis.pairs() {
                    let entry = (pair.output, pair.input);
                    let deviation = condition.deviation.as_ref().unwrap()[pair][k];
                    let w_p = if problem.on_axis[pair] { 2.0 } else { 1.0 };
                    let fixed_weight = w_p / (1.0 + (deviation / 0.06_f64).powi(2)).sqrt();
                    let q = weight(fixed_weight, coupled[entry], r[entry]);
                    dense.squared_weights.push(q * q);
                    dense.right_side.push(s_r[entry]);
                    for (column, unknown) in dense.columns.iter_mut().zip(unknowns) {
                        column.push(match *unknown {
                            Unknown::Mixing { from, .. } if from != pair.input => {
                                Complex::new(0.0, 0.0)
                            }
                            Unknown::Mixing { to, power, .. } => {
                                f[(pair.output, to)] * v.powi(power as i32)
                            }
                            Unknown::Feedback { input, output } => {
                                f[(pair.output, input)] * r[(output, pair.input)]
                            }
                        });
                    }
                }
            }
        }
        dense
    }

    /// `sum q^2 Re conj(a) b`.
    fn weighted_product(&self, a: &[Complex<f64>], b: &[Complex<f64>]) -> f64 {
        (0..self.right_side.len())
            .map(|row| self.squared_weights[row] * (a[row].conj() * b[row]).re)
            .sum()
    }
}

/// Weight `q = s / max(|R'|, |H_c| / 2) / (1 + (e s / 10)^2)^(1/4)` for the flight response `R'`
/// and the coupled physics response `H_c` of the pass before (M16.2). `e^2` is the summand of J: 20
/// times the squared error in dB, and 20 times 0.0175 times the squared error in degrees (M4).
fn weight(s: f64, coupled: Complex<f64>, flight: Complex<f64>) -> f64 {
    let ratio = coupled / flight;
    let db = 20.0 * ratio.norm().log10();
    let deg = ratio.arg().to_degrees();
    let e = (20.0 * db * db + 20.0 * 0.0175 * deg * deg).sqrt();
    let floor = flight.norm().max(0.5 * coupled.norm());
    s / floor / (1.0 + (e * s / 10.0).powi(2)).powf(0.25)
}

#[test]
fn the_gradient_of_the_weighted_problem_vanishes() {
    let problem = disturbed();
    let found = fit(&problem);
    let [.., before, optimum] = &found.coefficients[..] else {
        panic!("expected five passes")
    };
    let last = found.matrices.with(&found.unknowns, before);
    let dense = DenseProblem::new(&problem, &found.unknowns, &last);
    let residuals: Vec<Complex<f64>> = (0..dense.right_side.len())
        .map(|row| {
            let fitted: Complex<f64> = dense
                .columns
                .iter()
                .zip(optimum)
                .map(|(column, theta)| column[row] * theta)
                .sum();
            dense.right_side[row] - fitted
        })
        .collect();
    for ((column, theta), unknown) in dense.columns.iter().zip(optimum).zip(&found.unknowns) {
        let diagonal = dense.weighted_product(column, column);
        let regularisation = 1e-3 * diagonal * (theta - unknown.uncoupled());
        let gradient = regularisation - dense.weighted_product(column, &residuals);
        let size = dense
            .weighted_product(column, &dense.right_side)
            .abs()
            .max(diagonal);
        assert!(
            gradient.abs() < 1e-12 * size,
            "{unknown:?}: {gradient:e}, scale {size:e}"
        );
    }
    assert!(found.residual < 1e-14);
}

#[test]
fn error_bars_need_three_conditions_and_equal_the_jackknife() {
    let fits = left_out_fits(&disturbed(), &Sequential, &Unobserved).unwrap();
    let left_out: Vec<_> = fits.iter().map(|fit| fit.condition).collect();
    assert_eq!(left_out, [1, 2, 3, 4].map(ConditionId));
    assert_eq!(fits[1].fit, fit(&disturbed().without(1)));
    let bars = CouplingBars::from_fits(&fits, 80.0, 0.9).unwrap();
    // Jackknife variance of n = 4 fits: (n - 1) / n times the sum of the squared deviations.
    let entries: Vec<f64> = fits
        .iter()
        .map(|left_out| left_out.fit.matrices.feedback()[(1, 2)])
        .collect();
    let mean = entries.iter().sum::<f64>() / 4.0;
    let square: f64 = entries.iter().map(|entry| (entry - mean).powi(2)).sum();
    // Student's quantile with 3 degrees of freedom at 0.95, from tables.
    assert!((bars.feedback[(1, 2)] / (2.353_363 * (0.75 * square).sqrt()) - 1.0).abs() < 1e-6);
    assert_eq!((bars.mixing[(0, 0)], bars.mixing[(1, 1)]), (0.0, 0.0));
    let mut two = disturbed();
    two.conditions.truncate(2);
    let error = left_out_fits(&two, &Sequential, &Unobserved).unwrap_err();
    assert_eq!(
        error,
        CouplingError::TooFewConditions {
            needed: 3,
            found: 2
        }
    );
    // Two airspeeds suffice for a straight line over airspeed.
    assert_eq!(fit(&two).unknowns.len(), 12);
}
