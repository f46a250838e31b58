//! Tests of the fit of named parameters (M18) on synthetic aircraft.

mod bad_input;
mod known_answers;
mod properties;
mod runs;

use std::sync::{Arc, LazyLock};

use nalgebra::{Complex, DMatrix};
use serde_json::Value;

use gdcm_model::dataset::model::Origin;
use gdcm_model::dataset::{ConditionId, Dynamics, Model, PairTable, StateSpace};
use gdcm_model::executor::Sequential;
use gdcm_model::progress::Unobserved;
use gdcm_model::response::{FrequencyResponse, PreparedModel};

use super::increments::RunStep;
use super::problem::PhysicsOptions;
use super::{
    ConditionIncrements, ModelFamily, ParameterValue, PhysicsCondition, PhysicsDiagnosis,
    PhysicsProblem, diagnose,
};

/// Reference results, computed by independent numpy code.
static REFERENCE: LazyLock<Value> = LazyLock::new(|| {
    serde_json::from_str(include_str!(
        "../../../../tests/data/reference/physics.json"
    ))
    .unwrap()
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

/// Reads a model stored as `[A, B, C, D]`.
fn state_space(value: &Value) -> StateSpace {
    let [a, b, c, d] = [0, 1, 2, 3].map(|index| matrix(&value[index]));
    StateSpace::new(a, b, c, d).unwrap()
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

/// A condition of a synthetic aircraft: its physics model, and its runs at steps in plausible
/// standard deviations, by parameter.
#[derive(Clone)]
struct ToyCondition {
    base: StateSpace,
    runs: Vec<Vec<(f64, StateSpace)>>,
}

impl ToyCondition {
    fn base(&self) -> Model {
        let origin = Origin::Nominal { perturbation: None };
        Model::new("nominal", origin, Dynamics::StateSpace(self.base.clone()))
    }

    fn steps(&self) -> Vec<Vec<RunStep<'_>>> {
        self.runs
            .iter()
            .map(|runs| {
                runs.iter()
                    .map(|(z, run)| RunStep {
                        z: *z,
                        base: &self.base,
                        run,
                    })
                    .collect()
            })
            .collect()
    }

    fn increments(&self) -> ConditionIncrements {
        ConditionIncrements::new(&self.base(), &self.steps()).unwrap()
    }

    fn condition(&self, id: i64, flight: FrequencyResponse) -> PhysicsCondition {
        let family = ModelFamily::from_matrices(&self.base(), &self.increments()).unwrap();
        PhysicsCondition {
            id: ConditionId(id),
            usable: PairTable::filled(family.outputs(), family.inputs(), true),
            family: Arc::new(family),
            flight: Arc::new(flight),
            others: Vec::new(),
            deviation: None,
            coherence: None,
        }
    }

    /// Returns the response of the aircraft with its parameters at `z`.
    fn truth(&self, z: &[f64], omega: &[f64]) -> FrequencyResponse {
        let model = self.increments().apply(&self.base(), z).unwrap();
        PreparedModel::new(&Dynamics::StateSpace(model)).at(omega)
    }
}

/// The synthetic aircraft of the reference: parameter a with two runs, b with one.
fn toy_conditions() -> Vec<ToyCondition> {
    let models = REFERENCE["toy"]["models"].as_array().unwrap();
    models
        .iter()
        .map(|model| ToyCondition {
            base: state_space(&model["base"]),
            runs: vec![read_runs(model, "a"), read_runs(model, "b")],
        })
        .collect()
}

/// Reads the runs of a parameter: their steps and models.
fn read_runs(model: &Value, parameter: &str) -> Vec<(f64, StateSpace)> {
    let runs = model["runs"].as_array().unwrap().iter();
    runs.filter(|run| run["parameter"] == parameter)
        .map(|run| (run["z"].as_f64().unwrap(), state_space(&run["matrices"])))
        .collect()
}

fn toy_omega() -> Arc<[f64]> {
    numbers(&REFERENCE["toy"]["omega_rad_s"]).into()
}

fn diagonal() -> PairTable<bool> {
    PairTable::from_fn(2, 2, |pair| pair.output == pair.input)
}

/// The problem of the reference; `flight` is the key of its flight responses.
fn toy(flight: &str) -> PhysicsProblem {
    let flight = REFERENCE["toy"][flight].as_array().unwrap();
    let conditions = toy_conditions();
    let conditions = conditions.iter().zip(flight).enumerate();
    PhysicsProblem {
        omega: toy_omega(),
        on_axis: diagonal(),
        parameters: vec![ParameterValue::Fitted; 2],
        conditions: conditions
            .map(|(index, (condition, flight))| {
                condition.condition(index as i64 + 1, response(flight))
            })
            .collect(),
        options: PhysicsOptions::default(),
    }
}

fn diagnosis(problem: &PhysicsProblem) -> PhysicsDiagnosis {
    diagnose(problem, &Sequential, &Unobserved).unwrap()
}
