//! Mixing and feedback against known answers by independent numpy code (`tests/data/reference/mixing.json`).

use std::sync::{Arc, LazyLock};

use nalgebra::{Complex, DMatrix};
use serde_json::Value;

use super::*;
use crate::correction::Pade;
use crate::dataset::{ConditionId, Pair, PairTable, StateSpace};
use crate::executor::Sequential;
use crate::progress::Unobserved;
use crate::response::FrequencyResponse;
use crate::schedule::Airspeeds;

static REFERENCE: LazyLock<Value> =
    LazyLock::new(|| serde_json::from_str(include_str!("../../../../tests/data/reference/mixing.json")).unwrap());

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().unwrap().iter().map(|value| value.as_f64().unwrap()).collect()
}

fn matrix(value: &Value) -> DMatrix<f64> {
    let rows: Vec<Vec<f64>> = value.as_array().unwrap().iter().map(numbers).collect();
    DMatrix::from_fn(rows.len(), rows[0].len(), |row, column| rows[row][column])
}

/// `[part][frequency][output][input]`
fn response(value: &Value) -> FrequencyResponse {
    let part = |part: usize, k: usize, pair: Pair| value[part][k][pair.output][pair.input].as_f64().unwrap();
    let points = value[0].as_array().unwrap().len();
    let (outputs, inputs) = (value[0][0].as_array().unwrap().len(), value[0][0][0].as_array().unwrap().len());
    let value = |pair, k| Complex::new(part(0, k, pair), part(1, k, pair));
    FrequencyResponse::new(PairTable::from_fn(outputs, inputs, |pair| (0..points).map(|k| value(pair, k)).collect()))
}

/// The made-up aircraft of three outputs and two inputs, `flight` its flight responses.
fn made_up(flight: &str, options: CouplingOptions) -> CouplingProblem {
    let toy = &REFERENCE["toy"];
    let omega: Arc<[f64]> = numbers(&toy["omega_rad_s"]).into();
    let table = |pair: Pair, k: usize| toy["sd"][k][pair.output][pair.input].as_f64().unwrap();
    let deviation = PairTable::from_fn(3, 2, |pair| (0..omega.len()).map(|k| table(pair, k)).collect::<Vec<f64>>());
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
        on_axis: PairTable::from_fn(3, 2, |pair| toy["on_axis"][pair.output][pair.input].as_bool().unwrap()),
        conditions: numbers(&toy["airspeeds_kt"]).into_iter().enumerate().map(condition).collect(),
        omega,
        options,
    }
}

pub(super) fn disturbed() -> CouplingProblem {
    made_up("R_disturbed", CouplingOptions::default())
}

pub(super) fn fit(problem: &CouplingProblem) -> CouplingFit {
    fit_couplings(problem, &Sequential, &Unobserved).unwrap()
}

fn named(value: &Value) -> Vec<Unknown> {
    let of = |name: &Value| {
        let at = |place: usize| name[place].as_u64().unwrap() as usize;
        match name[0].as_str().unwrap() {
            "M" => Unknown::Mixing { to: at(1), from: at(2), power: at(3) },
            _ => Unknown::Feedback { input: at(1), output: at(2) },
        }
    };
    value.as_array().unwrap().iter().map(of).collect()
}

#[test]
fn the_made_up_aircraft_is_recovered() {
    let toy = &REFERENCE["toy"];
    let tolerance = toy["recovered"]["tolerance"].as_f64().unwrap();
    let solves = toy["recovered"]["solves"].as_u64().unwrap() as usize;
    let problem = made_up("R", CouplingOptions { ridge: 1e-9, solves, ..CouplingOptions::default() });
    let found = fit(&problem);
    assert!((found.matrices.feedback() - matrix(&toy["true_K"])).amax() < tolerance);
    for (condition, expected) in problem.conditions.iter().zip(toy["true_M"].as_array().unwrap()) {
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
            assert!(miss < known["tolerance"].as_f64().unwrap(), "solve {solve}, {place}: {miss:e}");
        }
    }
}

/// Couplings that are the same at every airspeed.
pub(super) fn constant(mixing: &DMatrix<f64>, feedback: &DMatrix<f64>) -> CouplingMatrices {
    let (inputs, outputs) = feedback.shape();
    let entries = (0..inputs).flat_map(|to| (0..inputs).map(move |from| (to, from)));
    let of_mixing = entries.map(|(to, from)| (Unknown::Mixing { to, from, power: 0 }, mixing[(to, from)]));
    let entries = (0..inputs).flat_map(|input| (0..outputs).map(move |output| (input, output)));
    let of_feedback = entries.map(|(input, output)| (Unknown::Feedback { input, output }, feedback[(input, output)]));
    let (unknowns, values): (Vec<Unknown>, Vec<f64>) = of_mixing.chain(of_feedback).unzip();
    CouplingMatrices::none(Airspeeds::new(vec![60.0], 2.0).unwrap(), inputs, outputs).with(&unknowns, &values)
}

#[test]
fn a_state_space_with_feed_through_is_coupled_exactly() {
    let known = &REFERENCE["state_space"];
    let of = |name: &str| matrix(&known[name]);
    let physics = StateSpace::new(of("A"), of("B"), of("C"), of("D")).unwrap();
    let coupled = constant(&of("M"), &of("K")).model(&physics, 60.0, Pade::new(4).unwrap()).unwrap();
    let found = [coupled.a(), coupled.b(), coupled.c(), coupled.d()];
    for (found, expected) in found.into_iter().zip(known["renovated"].as_array().unwrap()) {
        assert!((found - matrix(expected)).amax() < known["tolerance"].as_f64().unwrap());
    }
}
