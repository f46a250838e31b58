//! What holds of any mixing and feedback.

use std::sync::Arc;

use nalgebra::{Complex, DMatrix, dmatrix};

use super::known_answers_tests::{constant, disturbed, fit};
use super::*;
use crate::correction::Pade;
use crate::dataset::{Band, Dynamics, Pair, PairTable, StateSpace, Timing};
use crate::executor::Sequential;
use crate::progress::{Progress, Unobserved};
use crate::response::{FrequencyGrid, FrequencyResponse};

/// A helicopter of four states, two inputs and three outputs with feed-through.
fn small_aircraft() -> StateSpace {
    let a = dmatrix![-0.9, 0.3, 0.0, 0.1; -0.4, -1.6, 0.2, 0.0; 0.1, 0.0, -0.2, 1.0; 0.3, -0.1, -1.5, -0.4];
    let b = dmatrix![1.0, 0.1; -0.2, 0.8; 0.0, 0.3; 0.6, -0.2];
    let c = dmatrix![1.0, 0.0, 0.2, 0.0; 0.0, 1.0, 0.0, -0.3; 0.1, 0.4, 1.0, 0.2];
    StateSpace::new(a, b, c, dmatrix![0.0, 0.1; 0.05, 0.0; -0.2, 0.4]).unwrap()
}

fn small_couplings() -> CouplingMatrices {
    constant(&dmatrix![1.1, 0.2; -0.1, 0.9], &dmatrix![0.1, -0.3, 0.2; 0.05, 0.2, -0.1])
}

fn grid() -> FrequencyGrid {
    FrequencyGrid::logarithmic(Band::new(0.2, 8.0).unwrap(), 40)
}

fn response(model: &StateSpace) -> FrequencyResponse {
    FrequencyResponse::of(&Dynamics::StateSpace(model.clone()), &grid())
}

fn pade() -> Pade {
    Pade::new(4).unwrap()
}

/// The largest difference of two responses.
fn apart(one: &FrequencyResponse, other: &FrequencyResponse) -> f64 {
    let values = |of: &FrequencyResponse| of.curves().iter().flat_map(|(_, curve)| curve.clone()).collect::<Vec<_>>();
    values(one).iter().zip(values(other)).map(|(a, b)| (a - b).norm()).fold(0.0, f64::max)
}

#[test]
fn without_couplings_nothing_changes() {
    let (physics, none) = (small_aircraft(), constant(&DMatrix::identity(2, 2), &DMatrix::zeros(2, 3)));
    assert_eq!(none.model(&physics, 60.0, pade()).unwrap(), physics);
    assert_eq!(none.response(&response(&physics), 60.0), response(&physics));
    let shifts = none.pole_shifts(&physics, 60.0, pade()).unwrap();
    assert!(shifts.iter().all(|shift| shift.distance_rad_s() == Some(0.0) && !shift.is_newly_unstable()));
    let margin = LoopMargin::of(&none.least_singular_values(&response(&physics)), grid().omega()).unwrap();
    assert!((margin.least - 1.0).abs() < 1e-15 && !margin.is_close_to_ringing());
}

#[test]
fn the_matrices_have_the_response_of_the_loop() {
    let timing = |sample_time_s| Timing { sample_time_s, ..Timing::default() };
    // The same numbers as those of a sampled model: stable, for its poles are within the unit circle after a scaling by 0.5.
    let slow = small_aircraft();
    let sampled = StateSpace::new(slow.a() * 0.5, slow.b().clone(), slow.c().clone(), slow.d().clone()).unwrap();
    for physics in [slow, sampled.timed(timing(Some(0.2))).unwrap()] {
        let coupled = small_couplings().model(&physics, 60.0, pade()).unwrap();
        assert_eq!(coupled.timing(), physics.timing());
        let miss = apart(&response(&coupled), &small_couplings().response(&response(&physics), 60.0));
        // Two ways of some dozen operations with numbers of about one.
        assert!(miss < 1e-12, "{miss:e}");
    }
}

#[test]
fn the_response_of_the_loop_is_that_of_its_formula() {
    let (h, couplings) = (response(&small_aircraft()), small_couplings());
    let coupled = couplings.response(&h, 60.0);
    let mixing = couplings.normalised_mixing(60.0).map(Complex::from);
    for k in 0..grid().len() {
        let at = |of: &FrequencyResponse| DMatrix::from_fn(3, 2, |output, input| of.curve(Pair::new(output, input))[k]);
        let difference = DMatrix::identity(3, 3) - at(&h) * couplings.feedback().map(Complex::from);
        let expected = difference.try_inverse().unwrap() * at(&h) * &mixing;
        assert!((at(&coupled) - expected).iter().all(|miss| miss.norm() < 1e-13));
    }
}

#[test]
fn delays_of_channels_stand_inside_the_loop() {
    let delayed = |input_s: f64, output_s: f64| {
        let (input_delays_s, output_delays_s) = (Some(vec![input_s, 0.0]), Some(vec![0.0, output_s, 0.0]));
        small_aircraft().timed(Timing { sample_time_s: None, input_delays_s, output_delays_s }).unwrap()
    };
    let physics = delayed(0.02, 0.03);
    let coupled = small_couplings().model(&physics, 60.0, Pade::new(6).unwrap()).unwrap();
    assert!(coupled.timing().is_plain() && coupled.order() > physics.order());
    let miss = apart(&response(&coupled), &small_couplings().response(&response(&physics), 60.0));
    // Approximants of sixth order of delays of 0.03 s up to 8 rad/s.
    assert!(miss < 1e-10, "{miss:e}");
}

#[test]
fn a_loop_through_the_feed_through_that_cannot_be_closed_is_refused() {
    let feedback = dmatrix![0.0, 0.0, 0.0; 0.0, 0.0, 2.5 - 1e-9];
    let error = constant(&DMatrix::identity(2, 2), &feedback).model(&small_aircraft(), 60.0, pade()).unwrap_err();
    assert!(
        matches!(error, CoupledModelError::AlgebraicLoop { condition_number } if condition_number > 1e6),
        "{error}"
    );
    let other = constant(&DMatrix::identity(2, 2), &DMatrix::zeros(2, 2)).model(&small_aircraft(), 60.0, pade());
    assert!(matches!(other, Err(CoupledModelError::Channels { outputs: 3, expected_outputs: 2, .. })));
}

#[test]
fn a_pole_that_the_loop_makes_unstable_is_told() {
    let lag = StateSpace::new(dmatrix![-1.0], dmatrix![1.0], dmatrix![1.0], dmatrix![0.0]).unwrap();
    let shifts = constant(&dmatrix![1.0], &dmatrix![1.5]).pole_shifts(&lag, 60.0, pade()).unwrap();
    assert!(shifts[0].is_newly_unstable() && (shifts[0].after.re - 0.5).abs() < 1e-15);
    assert_eq!(shifts[0].distance_rad_s(), Some(1.5));
    let response = FrequencyResponse::of(&Dynamics::StateSpace(lag), &grid());
    let couplings = constant(&dmatrix![1.0], &dmatrix![0.9]);
    let margin = LoopMargin::of(&couplings.least_singular_values(&response), grid().omega()).unwrap();
    // |1 - 0.9 / (1 + j 0.2)| at the lowest frequency.
    let expected = (Complex::from(1.0) - Complex::from(0.9) / Complex::new(1.0, 0.2)).norm();
    assert!((margin.least - expected).abs() < 1e-14 && margin.omega_rad_s == 0.2 && margin.is_close_to_ringing());
    let change = relative_change_db(&response, &couplings.response(&response, 60.0), 39);
    assert!(change[Pair::new(0, 0)].unwrap() < -17.0, "the loop does little at 8 rad/s: {change:?}");
}

/// Columns and weights of the last pass, one complex row for each response and frequency, with nothing left out by structure.
struct DenseProblem {
    columns: Vec<Vec<Complex<f64>>>,
    target: Vec<Complex<f64>>,
    squared: Vec<f64>,
}

impl DenseProblem {
    fn of(problem: &CouplingProblem, unknowns: &[Unknown], last: &CouplingMatrices) -> Self {
        let mut dense = Self { columns: vec![Vec::new(); unknowns.len()], target: Vec::new(), squared: Vec::new() };
        for condition in &problem.conditions {
            let v: f64 = last.airspeeds().scaled(condition.airspeed_kt);
            for k in 0..problem.omega.len() {
                let at = |of: &FrequencyResponse| DMatrix::from_fn(3, 2, |o, i| of.curve(Pair::new(o, i))[k]);
                let (h, r) = (at(&condition.physics), at(&condition.flight));
                let s = (DMatrix::identity(3, 3) - &h * last.feedback().map(Complex::from)).try_inverse().unwrap();
                let (f, target) = (&s * &h, &s * &r);
                let coupled = &f * last.mixing(condition.airspeed_kt).map(Complex::from);
                for pair in problem.on_axis.pairs() {
                    let place = (pair.output, pair.input);
                    let deviation = condition.deviation.as_ref().unwrap()[pair][k];
                    let axis = if problem.on_axis[pair] { 2.0 } else { 1.0 };
                    let weight = axis / (1.0 + (deviation / 0.06_f64).powi(2)).sqrt();
                    let ratio = coupled[place] / r[place];
                    let (db, deg) = (20.0 * ratio.norm().log10(), ratio.arg().to_degrees());
                    let e = (20.0 * db * db + 20.0 * 0.0175 * deg * deg).sqrt();
                    let floor = r[place].norm().max(0.5 * coupled[place].norm());
                    let q = weight / floor / (1.0 + (e * weight / 10.0).powi(2)).powf(0.25);
                    dense.squared.push(q * q);
                    dense.target.push(target[place]);
                    for (column, unknown) in dense.columns.iter_mut().zip(unknowns) {
                        column.push(match *unknown {
                            Unknown::Mixing { from, .. } if from != pair.input => Complex::new(0.0, 0.0),
                            Unknown::Mixing { to, power, .. } => f[(pair.output, to)] * v.powi(power as i32),
                            Unknown::Feedback { input, output } => f[(pair.output, input)] * r[(output, pair.input)],
                        });
                    }
                }
            }
        }
        dense
    }
}

#[test]
fn the_gradient_of_the_weighted_problem_vanishes() {
    let problem = disturbed();
    let found = fit(&problem);
    let [.., before, optimum] = &found.coefficients[..] else { panic!("five solves were asked for") };
    let last = found.matrices.with(&found.unknowns, before);
    let dense = DenseProblem::of(&problem, &found.unknowns, &last);
    let rows = 0..dense.target.len();
    let left: Vec<Complex<f64>> = rows
        .clone()
        .map(|row| {
            let fitted: Complex<f64> =
                dense.columns.iter().zip(optimum).map(|(column, theta)| column[row] * theta).sum();
            dense.target[row] - fitted
        })
        .collect();
    let product = |column: &[Complex<f64>], of: &[Complex<f64>]| -> f64 {
        rows.clone().map(|row| dense.squared[row] * (column[row].conj() * of[row]).re).sum()
    };
    for (place, column) in dense.columns.iter().enumerate() {
        let drawn = 1e-3 * product(column, column) * (optimum[place] - found.unknowns[place].uncoupled());
        let gradient = drawn - product(column, &left);
        let size = product(column, &dense.target).abs().max(product(column, column));
        assert!(gradient.abs() < 1e-12 * size, "{:?}: {gradient:e} of {size:e}", found.unknowns[place]);
    }
    assert!(found.residual < 1e-14);
}

/// The problem with its channels in another order: `outputs[new]` and `inputs[new]` are the old places.
fn permuted(problem: &CouplingProblem, outputs: &[usize], inputs: &[usize]) -> CouplingProblem {
    let old = |pair: Pair| Pair::new(outputs[pair.output], inputs[pair.input]);
    fn moved<T: Clone>(table: &PairTable<T>, old: &impl Fn(Pair) -> Pair) -> PairTable<T> {
        table.map(|pair, _| table[old(pair)].clone())
    }
    let mut moved_problem = problem.clone();
    moved_problem.on_axis = moved(&problem.on_axis, &old);
    for condition in &mut moved_problem.conditions {
        condition.physics = Arc::new(FrequencyResponse::new(moved(condition.physics.curves(), &old)));
        condition.flight = FrequencyResponse::new(moved(condition.flight.curves(), &old));
        condition.deviation = condition.deviation.as_ref().map(|deviation| moved(deviation, &old));
    }
    moved_problem
}

#[test]
fn permuting_the_channels_permutes_the_answer() {
    let (outputs, inputs) = ([2, 0, 1], [1, 0]);
    let (found, moved) = (fit(&disturbed()), fit(&permuted(&disturbed(), &outputs, &inputs)));
    let (m, k) = (found.matrices.mixing(70.0), found.matrices.feedback());
    let expected_m = DMatrix::from_fn(2, 2, |to, from| m[(inputs[to], inputs[from])]);
    let expected_k = DMatrix::from_fn(2, 3, |input, output| k[(inputs[input], outputs[output])]);
    // Sums in another order, five times.
    assert!((moved.matrices.mixing(70.0) - expected_m).amax() < 1e-12);
    assert!((moved.matrices.feedback() - expected_k).amax() < 1e-12);
}

#[test]
fn bars_need_three_conditions_and_are_those_of_the_jackknife() {
    let fits = left_out_fits(&disturbed(), &Sequential, &Unobserved).unwrap();
    let places: Vec<_> = fits.iter().map(|of| of.condition).collect();
    assert_eq!(places, disturbed().conditions.iter().map(|condition| condition.id).collect::<Vec<_>>());
    assert_eq!(fits[1].fit, fit(&disturbed().without(1)));
    let bars = CouplingBars::of(&fits, 80.0, 0.9).unwrap();
    let entries: Vec<f64> = fits.iter().map(|of| of.fit.matrices.feedback()[(1, 2)]).collect();
    let mean = entries.iter().sum::<f64>() / 4.0;
    let square: f64 = entries.iter().map(|entry| (entry - mean).powi(2)).sum();
    // Student's quantile of 3 degrees of freedom at 0.95, from tables.
    assert!((bars.feedback[(1, 2)] / (2.353_363 * (0.75 * square).sqrt()) - 1.0).abs() < 1e-6);
    assert_eq!((bars.mixing[(0, 0)], bars.mixing[(1, 1)]), (0.0, 0.0));
    let mut two = disturbed();
    two.conditions.truncate(2);
    let error = left_out_fits(&two, &Sequential, &Unobserved).unwrap_err();
    assert_eq!(error, CouplingError::TooFewConditions { needed: 3, found: 2 });
    // Two airspeeds bear a straight line.
    assert_eq!(fit(&two).unknowns.len(), 12);
}

#[test]
fn a_fit_without_any_response_and_tables_of_another_shape_are_refused() {
    let fit = |problem: &CouplingProblem| fit_couplings(problem, &Sequential, &Unobserved);
    let mut problem = disturbed();
    problem.conditions.iter_mut().for_each(|condition| condition.usable = PairTable::filled(3, 2, false));
    assert_eq!(fit(&problem).unwrap_err(), CouplingError::NothingToFit { conditions: 4 });
    problem.conditions.clear();
    assert_eq!(fit(&problem).unwrap_err(), CouplingError::NothingToFit { conditions: 0 });
    let mut problem = disturbed();
    problem.omega = problem.omega[1..].into();
    assert!(matches!(fit(&problem).unwrap_err(), CouplingError::Shape { expected_points: 11, points: 12, .. }));
}

/// Wants the work to end.
struct Impatient;

impl Progress for Impatient {
    fn cancelled(&self) -> bool {
        true
    }

    fn advanced(&self, _done: usize, _total: usize) {}
}

#[test]
fn work_that_is_no_longer_wanted_ends() {
    let stopped = Err(CouplingError::Cancelled(crate::progress::Cancelled));
    assert_eq!(fit_couplings(&disturbed(), &Sequential, &Impatient), stopped);
    assert!(left_out_fits(&disturbed(), &Sequential, &Impatient).is_err());
}
