//! Mixing and feedback against known answers from independent numpy code
//! (`tests/data/reference/mixing.json`), general properties, invariances of the fit, and the
//! behaviour with missing responses (M16).

use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, LazyLock, Mutex};

use nalgebra::{Complex, DMatrix, DVector, dmatrix};
use proptest::prelude::*;
use serde_json::Value;

use gdcm_model::dataset::state_space::Timing;
use gdcm_model::dataset::{Band, ConditionId, Dynamics, Pair, PairTable, StateSpace};
use gdcm_model::executor::Sequential;
use gdcm_model::progress::{Progress, Unobserved};
use gdcm_model::response::{FrequencyGrid, FrequencyResponse};

use super::*;
use crate::correction::Pade;
use crate::couplings::coupling_effects::relative_change_db;
use crate::couplings::fit::{CouplingFit, left_out_fits};
use crate::couplings::problem::{CouplingError, CouplingOptions};
use crate::fidelity::CoherenceWeights;
use crate::schedule::Airspeeds;

static REFERENCE: LazyLock<Value> = LazyLock::new(|| {
    serde_json::from_str(include_str!("../../../../tests/data/reference/mixing.json")).unwrap()
});

fn numbers(value: &Value) -> Vec<f64> {
    value
        .as_array()
        .unwrap()
        .iter()
        .map(|value| value.as_f64().unwrap())
        .collect()
}

fn matrix(value: &Value) -> DMatrix<f64> {
    let rows: Vec<Vec<f64>> = value.as_array().unwrap().iter().map(numbers).collect();
    DMatrix::from_fn(rows.len(), rows[0].len(), |row, column| rows[row][column])
}

/// `[part][frequency][output][input]`
fn response(value: &Value) -> FrequencyResponse {
    let part = |part: usize, k: usize, pair: Pair| {
        value[part][k][pair.output][pair.input].as_f64().unwrap()
    };
    let points = value[0].as_array().unwrap().len();
    let outputs = value[0][0].as_array().unwrap().len();
    let inputs = value[0][0][0].as_array().unwrap().len();
    let value = |pair, k| Complex::new(part(0, k, pair), part(1, k, pair));
    FrequencyResponse::new(PairTable::from_fn(outputs, inputs, |pair| {
        (0..points).map(|k| value(pair, k)).collect()
    }))
}

/// The synthetic aircraft with three outputs and two inputs; `flight` names its flight responses.
fn made_up(flight: &str, options: CouplingOptions) -> CouplingProblem {
    let toy = &REFERENCE["toy"];
    let omega: Arc<[f64]> = numbers(&toy["omega_rad_s"]).into();
    let table = |pair: Pair, k: usize| toy["sd"][k][pair.output][pair.input].as_f64().unwrap();
    let deviation = PairTable::from_fn(3, 2, |pair| {
        (0..omega.len())
            .map(|k| table(pair, k))
            .collect::<Vec<f64>>()
    });
    let condition = |(place, airspeed_kt): (usize, f64)| CouplingCondition {
        id: ConditionId(place as i64 + 1),
        airspeed_kt,
        physics: Arc::new(response(&toy["H"][place])),
        flight: response(&toy[flight][place]),
        usable: PairTable::filled(3, 2, true),
        deviation: Some(deviation.clone()),
        coherence: None,
    };
    CouplingProblem {
        kind: CouplingKind::MixingAndFeedback,
        on_axis: PairTable::from_fn(3, 2, |pair| {
            toy["on_axis"][pair.output][pair.input].as_bool().unwrap()
        }),
        conditions: numbers(&toy["airspeeds_kt"])
            .into_iter()
            .enumerate()
            .map(condition)
            .collect(),
        omega,
        options,
    }
}

fn disturbed() -> CouplingProblem {
    made_up("R_disturbed", CouplingOptions::default())
}

fn fit(problem: &CouplingProblem) -> CouplingFit {
    fit_couplings(problem, &Sequential, &Unobserved).unwrap()
}

fn named(value: &Value) -> Vec<Unknown> {
    let of = |name: &Value| {
        let at = |place: usize| name[place].as_u64().unwrap() as usize;
        match name[0].as_str().unwrap() {
            "M" => Unknown::Mixing {
                to: at(1),
                from: at(2),
                power: at(3),
            },
            _ => Unknown::Feedback {
                input: at(1),
                output: at(2),
            },
        }
    };
    value.as_array().unwrap().iter().map(of).collect()
}

#[test]
fn the_made_up_aircraft_is_recovered() {
    let toy = &REFERENCE["toy"];
    let tolerance = toy["recovered"]["tolerance"].as_f64().unwrap();
    let solves = toy["recovered"]["solves"].as_u64().unwrap() as usize;
    let problem = made_up(
        "R",
        CouplingOptions {
            ridge: 1e-9,
            solves,
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
        let miss = (found.matrices.mixing(condition.airspeed_kt) - matrix(expected)).amax();
        assert!(miss < tolerance, "{} kt: {miss:e}", condition.airspeed_kt);
    }
    assert!(found.residual < 1e-13, "{:e}", found.residual);
    assert!(found.not_fed_back.is_empty() && found.undetermined.is_empty());
}

#[test]
fn every_solve_of_the_disturbed_aircraft_agrees() {
    let known = &REFERENCE["toy"]["disturbed"];
    let found = fit(&disturbed());
    assert_eq!(found.unknowns, named(&REFERENCE["toy"]["names"]));
    let solves = known["coefficients_of_each_solve"].as_array().unwrap();
    assert_eq!(found.coefficients.len(), solves.len());
    for (solve, (coefficients, expected)) in found.coefficients.iter().zip(solves).enumerate() {
        for (place, expected) in numbers(expected).into_iter().enumerate() {
            let miss = (coefficients[place] - expected).abs();
            assert!(
                miss < known["tolerance"].as_f64().unwrap(),
                "solve {solve}, {place}: {miss:e}"
            );
        }
    }
}

/// Couplings that are the same at every airspeed.
fn constant(mixing: &DMatrix<f64>, feedback: &DMatrix<f64>) -> CouplingMatrices {
    let (inputs, outputs) = feedback.shape();
    let entries = (0..inputs).flat_map(|to| (0..inputs).map(move |from| (to, from)));
    let of_mixing =
        entries.map(|(to, from)| (Unknown::Mixing { to, from, power: 0 }, mixing[(to, from)]));
    let entries = (0..inputs).flat_map(|input| (0..outputs).map(move |output| (input, output)));
    let of_feedback = entries.map(|(input, output)| {
        (
            Unknown::Feedback { input, output },
            feedback[(input, output)],
        )
    });
    let (unknowns, values): (Vec<Unknown>, Vec<f64>) = of_mixing.chain(of_feedback).unzip();
    CouplingMatrices::none(Airspeeds::new(vec![60.0], 2.0).unwrap(), inputs, outputs)
        .with(&unknowns, &values)
}

#[test]
fn a_state_space_with_feed_through_is_coupled_exactly() {
    let known = &REFERENCE["state_space"];
    let of = |name: &str| matrix(&known[name]);
    let physics = StateSpace::new(of("A"), of("B"), of("C"), of("D")).unwrap();
    let coupled = constant(&of("M"), &of("K"))
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

/// A helicopter of four states, two inputs and three outputs with feed-through.
fn small_aircraft() -> StateSpace {
    let a = dmatrix![-0.9, 0.3, 0.0, 0.1; -0.4, -1.6, 0.2, 0.0; 0.1, 0.0, -0.2, 1.0; 0.3, -0.1, -1.5, -0.4];
    let b = dmatrix![1.0, 0.1; -0.2, 0.8; 0.0, 0.3; 0.6, -0.2];
    let c = dmatrix![1.0, 0.0, 0.2, 0.0; 0.0, 1.0, 0.0, -0.3; 0.1, 0.4, 1.0, 0.2];
    StateSpace::new(a, b, c, dmatrix![0.0, 0.1; 0.05, 0.0; -0.2, 0.4]).unwrap()
}

fn small_couplings() -> CouplingMatrices {
    constant(
        &dmatrix![1.1, 0.2; -0.1, 0.9],
        &dmatrix![0.1, -0.3, 0.2; 0.05, 0.2, -0.1],
    )
}

fn grid() -> FrequencyGrid {
    FrequencyGrid::logarithmic(Band::new(0.2, 8.0).unwrap(), 40)
}

fn response_of(model: &StateSpace) -> FrequencyResponse {
    FrequencyResponse::of(&Dynamics::StateSpace(model.clone()), &grid())
}

fn pade() -> Pade {
    Pade::new(4).unwrap()
}

/// The largest difference of two responses.
fn apart(one: &FrequencyResponse, other: &FrequencyResponse) -> f64 {
    let values = |of: &FrequencyResponse| {
        of.curves()
            .iter()
            .flat_map(|(_, curve)| curve.clone())
            .collect::<Vec<_>>()
    };
    values(one)
        .iter()
        .zip(values(other))
        .map(|(a, b)| (a - b).norm())
        .fold(0.0, f64::max)
}

#[test]
fn without_couplings_nothing_changes() {
    let physics = small_aircraft();
    let none = constant(&DMatrix::identity(2, 2), &DMatrix::zeros(2, 3));
    assert_eq!(none.model(&physics, 60.0, pade()).unwrap(), physics);
    assert_eq!(
        none.response(&response_of(&physics), 60.0),
        response_of(&physics)
    );
    let shifts = none.pole_shifts(&physics, 60.0, pade()).unwrap();
    assert!(
        shifts
            .iter()
            .all(|shift| shift.distance_rad_s() == Some(0.0) && !shift.is_newly_unstable())
    );
    let margin = LoopMargin::of(
        &none.least_singular_values(&response_of(&physics)),
        grid().omega(),
    )
    .unwrap();
    assert!((margin.least - 1.0).abs() < 1e-15 && !margin.is_close_to_ringing());
}

#[test]
fn the_matrices_have_the_response_of_the_loop() {
    let timing = |sample_time_s| Timing {
        sample_time_s,
        ..Timing::default()
    };
    // The same matrices as a sampled model: stable, since scaling by 0.5 puts the poles inside the
    // unit circle.
    let slow = small_aircraft();
    let sampled = StateSpace::new(
        slow.a() * 0.5,
        slow.b().clone(),
        slow.c().clone(),
        slow.d().clone(),
    )
    .unwrap();
    for physics in [slow, sampled.timed(timing(Some(0.2))).unwrap()] {
        let coupled = small_couplings().model(&physics, 60.0, pade()).unwrap();
        assert_eq!(coupled.timing(), physics.timing());
        let miss = apart(
            &response_of(&coupled),
            &small_couplings().response(&response_of(&physics), 60.0),
        );
        // Two orders of a dozen operations with numbers near one.
        assert!(miss < 1e-12, "{miss:e}");
    }
}

#[test]
fn the_response_of_the_loop_is_that_of_its_formula() {
    let h = response_of(&small_aircraft());
    let couplings = small_couplings();
    let coupled = couplings.response(&h, 60.0);
    let mixing = couplings.normalised_mixing(60.0).map(Complex::from);
    for k in 0..grid().len() {
        let at = |of: &FrequencyResponse| {
            DMatrix::from_fn(3, 2, |output, input| of.curve(Pair::new(output, input))[k])
        };
        let difference = DMatrix::identity(3, 3) - at(&h) * couplings.feedback().map(Complex::from);
        let expected = difference.try_inverse().unwrap() * at(&h) * &mixing;
        assert!(
            (at(&coupled) - expected)
                .iter()
                .all(|miss| miss.norm() < 1e-13)
        );
    }
}

#[test]
fn delays_of_channels_stand_inside_the_loop() {
    let delayed = |input_s: f64, output_s: f64| {
        let input_delays_s = Some(vec![input_s, 0.0]);
        let output_delays_s = Some(vec![0.0, output_s, 0.0]);
        small_aircraft()
            .timed(Timing {
                sample_time_s: None,
                input_delays_s,
                output_delays_s,
            })
            .unwrap()
    };
    let physics = delayed(0.02, 0.03);
    let coupled = small_couplings()
        .model(&physics, 60.0, Pade::new(6).unwrap())
        .unwrap();
    assert!(coupled.timing().is_plain() && coupled.order() > physics.order());
    let miss = apart(
        &response_of(&coupled),
        &small_couplings().response(&response_of(&physics), 60.0),
    );
    // Sixth-order approximants of 0.03 s delays, up to 8 rad/s.
    assert!(miss < 1e-10, "{miss:e}");
}

#[test]
fn a_loop_through_the_feed_through_that_cannot_be_closed_is_refused() {
    let feedback = dmatrix![0.0, 0.0, 0.0; 0.0, 0.0, 2.5 - 1e-9];
    let error = constant(&DMatrix::identity(2, 2), &feedback)
        .model(&small_aircraft(), 60.0, pade())
        .unwrap_err();
    assert!(
        matches!(error, CoupledModelError::AlgebraicLoop { condition_number } if condition_number > 1e6),
        "{error}"
    );
    let other = constant(&DMatrix::identity(2, 2), &DMatrix::zeros(2, 2)).model(
        &small_aircraft(),
        60.0,
        pade(),
    );
    assert!(matches!(
        other,
        Err(CoupledModelError::Channels {
            found: [3, 2],
            expected: [2, 2]
        })
    ));
}

#[test]
fn a_pole_that_the_loop_makes_unstable_is_told() {
    let lag = StateSpace::new(dmatrix![-1.0], dmatrix![1.0], dmatrix![1.0], dmatrix![0.0]).unwrap();
    let shifts = constant(&dmatrix![1.0], &dmatrix![1.5])
        .pole_shifts(&lag, 60.0, pade())
        .unwrap();
    assert!(shifts[0].is_newly_unstable() && (shifts[0].after.re - 0.5).abs() < 1e-15);
    assert_eq!(shifts[0].distance_rad_s(), Some(1.5));
    let response = FrequencyResponse::of(&Dynamics::StateSpace(lag), &grid());
    let couplings = constant(&dmatrix![1.0], &dmatrix![0.9]);
    let margin =
        LoopMargin::of(&couplings.least_singular_values(&response), grid().omega()).unwrap();
    // |1 - 0.9 / (1 + j 0.2)| at the lowest frequency.
    let expected = (Complex::from(1.0) - Complex::from(0.9) / Complex::new(1.0, 0.2)).norm();
    assert!(
        (margin.least - expected).abs() < 1e-14
            && margin.omega_rad_s == 0.2
            && margin.is_close_to_ringing()
    );
    let change = relative_change_db(&response, &couplings.response(&response, 60.0), 39);
    assert!(
        change[Pair::new(0, 0)].unwrap() < -17.0,
        "the loop does little at 8 rad/s: {change:?}"
    );
}

/// Columns and weights of the last pass, one complex row per response and frequency, without using
/// structure.
struct DenseProblem {
    columns: Vec<Vec<Complex<f64>>>,
    target: Vec<Complex<f64>>,
    squared: Vec<f64>,
}

impl DenseProblem {
    fn of(problem: &CouplingProblem, unknowns: &[Unknown], last: &CouplingMatrices) -> Self {
        let mut dense = Self {
            columns: vec![Vec::new(); unknowns.len()],
            target: Vec::new(),
            squared: Vec::new(),
        };
        for condition in &problem.conditions {
            let v: f64 = last.airspeeds().scaled(condition.airspeed_kt);
            for k in 0..problem.omega.len() {
                let at = |of: &FrequencyResponse| {
                    DMatrix::from_fn(3, 2, |o, i| of.curve(Pair::new(o, i))[k])
                };
                let h = at(&condition.physics);
                let r = at(&condition.flight);
                let s = (DMatrix::identity(3, 3) - &h * last.feedback().map(Complex::from))
                    .try_inverse()
                    .unwrap();
                let f = &s * &h;
                let target = &s * &r;
                let coupled = &f * last.mixing(condition.airspeed_kt).map(Complex::from);
                for pair in problem.on_axis.pairs() {
                    let place = (pair.output, pair.input);
                    let deviation = condition.deviation.as_ref().unwrap()[pair][k];
                    let axis = if problem.on_axis[pair] { 2.0 } else { 1.0 };
                    let weight = axis / (1.0 + (deviation / 0.06_f64).powi(2)).sqrt();
                    let ratio = coupled[place] / r[place];
                    let db = 20.0 * ratio.norm().log10();
                    let deg = ratio.arg().to_degrees();
                    let e = (20.0 * db * db + 20.0 * 0.0175 * deg * deg).sqrt();
                    let floor = r[place].norm().max(0.5 * coupled[place].norm());
                    let q = weight / floor / (1.0 + (e * weight / 10.0).powi(2)).powf(0.25);
                    dense.squared.push(q * q);
                    dense.target.push(target[place]);
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
}

#[test]
fn the_gradient_of_the_weighted_problem_vanishes() {
    let problem = disturbed();
    let found = fit(&problem);
    let [.., before, optimum] = &found.coefficients[..] else {
        panic!("five solves were asked for")
    };
    let last = found.matrices.with(&found.unknowns, before);
    let dense = DenseProblem::of(&problem, &found.unknowns, &last);
    let rows = 0..dense.target.len();
    let left: Vec<Complex<f64>> = rows
        .clone()
        .map(|row| {
            let fitted: Complex<f64> = dense
                .columns
                .iter()
                .zip(optimum)
                .map(|(column, theta)| column[row] * theta)
                .sum();
            dense.target[row] - fitted
        })
        .collect();
    let product = |column: &[Complex<f64>], of: &[Complex<f64>]| -> f64 {
        rows.clone()
            .map(|row| dense.squared[row] * (column[row].conj() * of[row]).re)
            .sum()
    };
    for (place, column) in dense.columns.iter().enumerate() {
        let drawn =
            1e-3 * product(column, column) * (optimum[place] - found.unknowns[place].uncoupled());
        let gradient = drawn - product(column, &left);
        let size = product(column, &dense.target)
            .abs()
            .max(product(column, column));
        assert!(
            gradient.abs() < 1e-12 * size,
            "{:?}: {gradient:e} of {size:e}",
            found.unknowns[place]
        );
    }
    assert!(found.residual < 1e-14);
}

/// The problem with reordered channels: `outputs[new]` and `inputs[new]` are the old indices.
fn permuted(problem: &CouplingProblem, outputs: &[usize], inputs: &[usize]) -> CouplingProblem {
    let old = |pair: Pair| Pair::new(outputs[pair.output], inputs[pair.input]);
    fn moved<T: Clone>(table: &PairTable<T>, old: &impl Fn(Pair) -> Pair) -> PairTable<T> {
        table.map(|pair, _| table[old(pair)].clone())
    }
    let mut moved_problem = problem.clone();
    moved_problem.on_axis = moved(&problem.on_axis, &old);
    for condition in &mut moved_problem.conditions {
        condition.physics = Arc::new(FrequencyResponse::new(moved(
            condition.physics.curves(),
            &old,
        )));
        condition.flight = FrequencyResponse::new(moved(condition.flight.curves(), &old));
        condition.deviation = condition
            .deviation
            .as_ref()
            .map(|deviation| moved(deviation, &old));
    }
    moved_problem
}

#[test]
fn permuting_the_channels_permutes_the_answer() {
    let outputs = [2, 0, 1];
    let inputs = [1, 0];
    let found = fit(&disturbed());
    let moved = fit(&permuted(&disturbed(), &outputs, &inputs));
    let m = found.matrices.mixing(70.0);
    let k = found.matrices.feedback();
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
    assert_eq!(
        places,
        disturbed()
            .conditions
            .iter()
            .map(|condition| condition.id)
            .collect::<Vec<_>>()
    );
    assert_eq!(fits[1].fit, fit(&disturbed().without(1)));
    let bars = CouplingBars::of(&fits, 80.0, 0.9).unwrap();
    let entries: Vec<f64> = fits
        .iter()
        .map(|of| of.fit.matrices.feedback()[(1, 2)])
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
    // Two airspeeds allow a straight line.
    assert_eq!(fit(&two).unknowns.len(), 12);
}

#[test]
fn a_fit_without_any_response_and_tables_of_another_shape_are_refused() {
    let fit = |problem: &CouplingProblem| fit_couplings(problem, &Sequential, &Unobserved);
    let mut problem = disturbed();
    problem
        .conditions
        .iter_mut()
        .for_each(|condition| condition.usable = PairTable::filled(3, 2, false));
    assert_eq!(
        fit(&problem).unwrap_err(),
        CouplingError::NothingToFit { conditions: 4 }
    );
    problem.conditions.clear();
    assert_eq!(
        fit(&problem).unwrap_err(),
        CouplingError::NothingToFit { conditions: 0 }
    );
    let mut problem = disturbed();
    problem.omega = problem.omega[1..].into();
    assert!(matches!(
        fit(&problem).unwrap_err(),
        CouplingError::Shape {
            expected: [.., 11],
            found: [.., 12],
            ..
        }
    ));
}

/// Cancels immediately.
struct Impatient;

impl Progress for Impatient {
    fn cancelled(&self) -> bool {
        true
    }

    fn advanced(&self, _done: usize, _total: usize) {}
}

#[test]
fn work_that_is_no_longer_wanted_ends() {
    let stopped = Err(CouplingError::Cancelled(gdcm_model::progress::Cancelled));
    assert_eq!(
        fit_couplings(&disturbed(), &Sequential, &Impatient),
        stopped
    );
    assert!(left_out_fits(&disturbed(), &Sequential, &Impatient).is_err());
}

/// Records progress reports, and cancels after a given number of polls.
struct Listener {
    questions_left: AtomicUsize,
    heard: Mutex<Vec<usize>>,
}

impl Listener {
    fn patient_for(questions: usize) -> Self {
        Self {
            questions_left: AtomicUsize::new(questions),
            heard: Mutex::default(),
        }
    }
}

impl Progress for Listener {
    fn cancelled(&self) -> bool {
        let next = |left: usize| left.checked_sub(1);
        self.questions_left
            .fetch_update(Ordering::Relaxed, Ordering::Relaxed, next)
            .is_err()
    }

    fn advanced(&self, done: usize, total: usize) {
        assert_eq!(total, 1000);
        self.heard.lock().unwrap().push(done);
    }
}

#[test]
fn a_fit_reports_every_condition_of_every_pass_and_never_goes_back() {
    let listener = Listener::patient_for(usize::MAX);
    fit_couplings(&disturbed(), &Sequential, &listener).unwrap();
    let heard = listener.heard.into_inner().unwrap();
    // Four conditions and the solution, five times, and the end.
    assert_eq!(
        (heard.len(), heard[0], heard[4], *heard.last().unwrap()),
        (26, 40, 200, 1000),
        "{heard:?}"
    );
    assert!(heard.is_sorted());
}

#[test]
fn a_fit_of_one_large_condition_can_be_stopped_within_a_pass() {
    let problem = many_channels(2, 1, 200);
    let listener = Listener::patient_for(3);
    let stopped = fit_couplings(&problem, &Sequential, &listener);
    assert_eq!(
        stopped,
        Err(CouplingError::Cancelled(gdcm_model::progress::Cancelled))
    );
    assert!(
        listener.heard.into_inner().unwrap().is_empty(),
        "before the first condition of the first pass was done"
    );
}

#[test]
fn the_fits_without_each_condition_are_reported_step_by_step() {
    let listener = Listener::patient_for(usize::MAX);
    left_out_fits(&disturbed(), &Sequential, &listener).unwrap();
    let heard = listener.heard.into_inner().unwrap();
    assert!(
        heard.len() >= 4 * 20 && heard.is_sorted() && *heard.last().unwrap() >= 999,
        "{heard:?}"
    );
}

/// The problem with outputs and inputs in other units; the factors are new units per old unit.
fn in_other_units(problem: &CouplingProblem, outputs: &[f64], inputs: &[f64]) -> CouplingProblem {
    let scaled = |of: &FrequencyResponse| {
        let scale = |pair: Pair| outputs[pair.output] / inputs[pair.input];
        FrequencyResponse::new(
            of.curves()
                .map(|pair, curve| curve.iter().map(|value| value * scale(pair)).collect()),
        )
    };
    let mut problem = problem.clone();
    for condition in &mut problem.conditions {
        condition.physics = Arc::new(scaled(&condition.physics));
        condition.flight = scaled(&condition.flight);
    }
    problem
}

/// The disturbed aircraft with flight responses generated from its physics models and couplings
/// with a unit diagonal of M.
fn flown_with(mixing: &DMatrix<f64>, share: &DMatrix<f64>) -> (CouplingProblem, DMatrix<f64>) {
    let mut problem = disturbed();
    let largest = |output: usize| {
        let values = problem
            .conditions
            .iter()
            .flat_map(|of| (0..2).map(move |input| of.physics.curve(Pair::new(output, input))));
        values
            .flatten()
            .map(|value| value.norm())
            .fold(0.0, f64::max)
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
        let found = fit(&disturbed());
        let scaled = fit(&in_other_units(&disturbed(), &outputs, &inputs));
        for (to, from) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
            let [a, b] = [&found, &scaled].map(|of| of.matrices.mixing(70.0)[(to, from)]);
            // Rounding errors of five solves with scaled condition numbers near 1e4.
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
        // The ridge of 1e-9, times the information ratio between the best and the least known
        // entry.
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

const NOT_KNOWN: Complex<f64> = Complex::new(f64::NAN, f64::NAN);

/// A response without the values at these pairs and frequencies.
fn without(response: &FrequencyResponse, lacks: impl Fn(Pair, usize) -> bool) -> FrequencyResponse {
    FrequencyResponse::new(response.curves().map(|pair, curve| {
        let value =
            |(k, value): (usize, &Complex<f64>)| if lacks(pair, k) { NOT_KNOWN } else { *value };
        curve.iter().enumerate().map(value).collect()
    }))
}

/// The disturbed aircraft with only its first two outputs.
fn two_outputs() -> CouplingProblem {
    let mut smaller = disturbed();
    let first_two = |response: &FrequencyResponse| {
        FrequencyResponse::new(PairTable::from_fn(2, 2, |pair| {
            response.curve(pair).to_vec()
        }))
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
    let mut of_flight = disturbed();
    let mut of_physics = disturbed();
    let expected = fit(&two_outputs());
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
fn an_input_column_is_skipped_where_flight_lacks_an_output_that_is_fed_back() {
    let mut lacking = disturbed();
    let mut unusable = disturbed();
    // The first condition lacks one response; the result equals that without this input in this
    // condition.
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
    // A mixing alone needs no other response of the column.
    (lacking.kind, unusable.kind) = (CouplingKind::Mixing, CouplingKind::Mixing);
    unusable.conditions[0].usable = PairTable::from_fn(3, 2, |pair| pair != Pair::new(2, 1));
    let found = fit(&lacking);
    let expected = fit(&unusable);
    assert_eq!(
        (found.coefficients, found.not_fed_back),
        (expected.coefficients, vec![])
    );
}

#[test]
fn a_frequency_is_skipped_where_the_physics_model_lacks_an_output_that_is_fed_back() {
    let mut lacking = disturbed();
    let mut shorter = disturbed();
    lacking.conditions[2].physics = Arc::new(without(&lacking.conditions[2].physics, |pair, k| {
        pair.output == 1 && k == 4
    }));
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
fn what_was_not_measured_coherently_does_not_count() {
    let mut measured = disturbed();
    let mut unusable = disturbed();
    let omega = Arc::clone(&measured.omega);
    for (condition, other) in measured.conditions.iter_mut().zip(&mut unusable.conditions) {
        condition.coherence = Some(PairTable::from_fn(3, 2, |pair| {
            let coherence = if pair == Pair::new(2, 0) { 0.3 } else { 1.0 };
            CoherenceWeights::of(&omega, &vec![coherence; omega.len()], 0.6, None)
        }));
        other.usable[Pair::new(2, 0)] = false;
    }
    let found = fit(&measured);
    let expected = fit(&unusable);
    for (found, expected) in found
        .coefficients
        .iter()
        .flatten()
        .zip(expected.coefficients.iter().flatten())
    {
        // A common weight changes only rounding errors.
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
    let fed_back =
        constant(&mixing, &dmatrix![0.0, 0.0, 0.1; 0.0, 0.0, 0.0]).response(&lacking, 60.0);
    assert!(
        fed_back
            .curves()
            .iter()
            .all(|(_, curve)| !curve[3].is_finite() && curve[4].is_finite())
    );
}

/// A synthetic problem with as many inputs as outputs; each response is a different lag, flown with
/// small couplings.
fn many_channels(channels: usize, conditions: usize, points: usize) -> CouplingProblem {
    let mut state = 88_172_645_463_325_252_u64;
    let mut random = move || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
    };
    let omega = FrequencyGrid::logarithmic(Band::new(0.3, 12.0).unwrap(), points)
        .omega()
        .to_vec();
    let couplings = {
        let mut small = |row: usize, column: usize| {
            let unit = if row == column { 1.0 } else { 0.0 };
            unit + 0.1 * random()
        };
        let mixing = DMatrix::from_fn(channels, channels, &mut small);
        constant(
            &mixing,
            &DMatrix::from_fn(channels, channels, |_, _| 0.02 * small(0, 1)),
        )
    };
    let conditions = (0..conditions).map(|place| {
        let physics = FrequencyResponse::new(PairTable::from_fn(channels, channels, |pair| {
            let gain = if pair.output == pair.input {
                3.0
            } else {
                0.6 * random()
            };
            let lag = 1.5 + random();
            omega
                .iter()
                .map(|&omega| Complex::from(gain) / Complex::new(lag, omega))
                .collect()
        }));
        let airspeed_kt = 20.0 * place as f64;
        CouplingCondition {
            id: ConditionId(place as i64 + 1),
            airspeed_kt,
            flight: couplings.response(&physics, airspeed_kt),
            physics: Arc::new(physics),
            usable: PairTable::filled(channels, channels, true),
            deviation: None,
            coherence: None,
        }
    });
    CouplingProblem {
        kind: CouplingKind::MixingAndFeedback,
        conditions: conditions.collect(),
        on_axis: PairTable::from_fn(channels, channels, |pair| pair.output == pair.input),
        omega: omega.clone().into(),
        options: CouplingOptions::default(),
    }
}

#[test]
#[ignore = "figures of the release build: docs/performance.md"]
fn fits_of_many_channels_and_conditions_solve_their_equations() {
    for (channels, conditions) in [(5, 11), (20, 4), (32, 4), (4, 2000)] {
        let problem = many_channels(channels, conditions, 200);
        let started = std::time::Instant::now();
        let found = fit(&problem);
        let took_s = started.elapsed().as_secs_f64();
        let residual = found.residual;
        println!(
            "{channels} x {channels}, {conditions} conditions, one core: {took_s:.2} s; residual {residual:.1e}"
        );
        // Some hundred roundings of the largest right side; the time is printed, not judged.
        assert!(residual < 1e-12, "{residual:e}");
    }
}
