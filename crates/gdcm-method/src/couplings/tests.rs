//! Tests of mixing and feedback (M16) on synthetic aircraft.

mod coupled_model;
mod invariance;
mod known_answers;
mod missing_responses;
mod progress;

use std::sync::{Arc, LazyLock};

use nalgebra::{Complex, DMatrix};
use serde_json::Value;

use gdcm_model::dataset::{Band, ConditionId, Pair, PairTable};
use gdcm_model::executor::Sequential;
use gdcm_model::progress::Unobserved;
use gdcm_model::response::{FrequencyGrid, FrequencyResponse};

use super::fit::CouplingFit;
use super::problem::CouplingOptions;
use super::{
    CouplingCondition, CouplingKind, CouplingMatrices, CouplingProblem, Unknown, fit_couplings,
};
use crate::schedule::Airspeeds;

/// Reference results, computed by independent numpy code.
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

/// Reads a response stored as `[part][frequency][output][input]`, real part first.
fn response(value: &Value) -> FrequencyResponse {
    let points = value[0].as_array().unwrap().len();
    let outputs = value[0][0].as_array().unwrap().len();
    let inputs = value[0][0][0].as_array().unwrap().len();
    FrequencyResponse::new(PairTable::from_fn(outputs, inputs, |pair| {
        (0..points)
            .map(|k| {
                let [re, im] = [0, 1].map(|part| &value[part][k][pair.output][pair.input]);
                Complex::new(re.as_f64().unwrap(), im.as_f64().unwrap())
            })
            .collect()
    }))
}

/// The synthetic aircraft with three outputs and two inputs; `flight` is the key of its flight
/// responses.
fn synthetic_aircraft(flight: &str, options: CouplingOptions) -> CouplingProblem {
    let toy = &REFERENCE["toy"];
    let omega: Arc<[f64]> = numbers(&toy["omega_rad_s"]).into();
    let deviation: PairTable<Vec<f64>> = PairTable::from_fn(3, 2, |pair| {
        (0..omega.len())
            .map(|k| toy["sd"][k][pair.output][pair.input].as_f64().unwrap())
            .collect()
    });
    let mut conditions = Vec::new();
    for (index, airspeed_kt) in numbers(&toy["airspeeds_kt"]).into_iter().enumerate() {
        conditions.push(CouplingCondition {
            id: ConditionId(index as i64 + 1),
            airspeed_kt,
            physics: Arc::new(response(&toy["H"][index])),
            flight: response(&toy[flight][index]),
            usable: PairTable::filled(3, 2, true),
            deviation: Some(deviation.clone()),
            coherence: None,
        });
    }
    CouplingProblem {
        kind: CouplingKind::MixingAndFeedback,
        on_axis: PairTable::from_fn(3, 2, |pair| {
            toy["on_axis"][pair.output][pair.input].as_bool().unwrap()
        }),
        conditions,
        omega,
        options,
    }
}

fn disturbed() -> CouplingProblem {
    synthetic_aircraft("R_disturbed", CouplingOptions::default())
}

fn fit(problem: &CouplingProblem) -> CouplingFit {
    fit_couplings(problem, &Sequential, &Unobserved).unwrap()
}

/// Couplings that do not depend on airspeed: mixing M (m x m) and feedback K (m x p).
fn constant(mixing: &DMatrix<f64>, feedback: &DMatrix<f64>) -> CouplingMatrices {
    let (inputs, outputs) = feedback.shape();
    let mut unknowns = Vec::new();
    let mut values = Vec::new();
    for input in 0..inputs {
        for from in 0..inputs {
            unknowns.push(Unknown::Mixing {
                to: input,
                from,
                power: 0,
            });
            values.push(mixing[(input, from)]);
        }
        for output in 0..outputs {
            unknowns.push(Unknown::Feedback { input, output });
            values.push(feedback[(input, output)]);
        }
    }
    CouplingMatrices::none(Airspeeds::new(vec![60.0], 2.0).unwrap(), inputs, outputs)
        .with(&unknowns, &values)
}

/// A response at frequency `k`, p x m.
fn matrix_at(response: &FrequencyResponse, k: usize) -> DMatrix<Complex<f64>> {
    DMatrix::from_fn(response.outputs(), response.inputs(), |output, input| {
        response.curve(Pair::new(output, input))[k]
    })
}

/// Pseudorandom numbers from -0.5 to 0.5 (xorshift).
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
    }
}

/// A synthetic problem with as many inputs as outputs; each response is a different lag, flown with
/// small couplings.
fn many_channels(channels: usize, conditions: usize, points: usize) -> CouplingProblem {
    let mut random = Random(88_172_645_463_325_252);
    let omega = FrequencyGrid::logarithmic(Band::new(0.3, 12.0).unwrap(), points)
        .omega()
        .to_vec();
    let mixing = DMatrix::from_fn(channels, channels, |to, from| {
        let unit = if to == from { 1.0 } else { 0.0 };
        unit + 0.1 * random.next()
    });
    let feedback = DMatrix::from_fn(channels, channels, |_, _| 0.02 * (0.1 * random.next()));
    let couplings = constant(&mixing, &feedback);
    let mut all_conditions = Vec::new();
    for index in 0..conditions {
        let physics = FrequencyResponse::new(PairTable::from_fn(channels, channels, |pair| {
            let gain = if pair.output == pair.input {
                3.0
            } else {
                0.6 * random.next()
            };
            let lag = 1.5 + random.next();
            omega
                .iter()
                .map(|&omega| Complex::from(gain) / Complex::new(lag, omega))
                .collect()
        }));
        let airspeed_kt = 20.0 * index as f64;
        all_conditions.push(CouplingCondition {
            id: ConditionId(index as i64 + 1),
            airspeed_kt,
            flight: couplings.response(&physics, airspeed_kt),
            physics: Arc::new(physics),
            usable: PairTable::filled(channels, channels, true),
            deviation: None,
            coherence: None,
        });
    }
    CouplingProblem {
        kind: CouplingKind::MixingAndFeedback,
        conditions: all_conditions,
        on_axis: PairTable::from_fn(channels, channels, |pair| pair.output == pair.input),
        omega: omega.clone().into(),
        options: CouplingOptions::default(),
    }
}

#[test]
#[ignore = "measures the times of docs/performance.md, in a release build"]
fn fits_of_many_channels_and_conditions_solve_their_equations() {
    for (channels, conditions) in [(5, 11), (20, 4), (32, 4), (4, 2000)] {
        let problem = many_channels(channels, conditions, 200);
        let started = std::time::Instant::now();
        let found = fit(&problem);
        let took_s = started.elapsed().as_secs_f64();
        let residual = found.residual;
        println!(
            "{channels} x {channels}, {conditions} conditions, one core: {took_s:.2} s; \
             residual {residual:.1e}"
        );
        // A few hundred rounding errors of the largest right-hand side. The time is printed, not
        // compared.
        assert!(residual < 1e-12, "{residual:e}");
    }
}
