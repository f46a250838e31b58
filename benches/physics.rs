//! `cargo bench --bench physics`: diagnosis of 14 named parameters in 11 conditions, at 40
//! frequencies of models with 39 states, 4 inputs and 6 outputs (M18), and the responses and
//! derivatives of a pass compared with a plain dense LU decomposition at each frequency.
//!
//! Target on two cores: 2 s for the whole diagnosis.

use std::hint::black_box;
use std::sync::Arc;

use nalgebra::{Complex, DMatrix};

use gdcm::executor::Pool;
use gdcm_method::physics::increments::RunStep;
use gdcm_method::physics::problem::PhysicsOptions;
use gdcm_method::physics::{
    ConditionIncrements, ModelFamily, ParameterValue, PhysicsCondition, PhysicsProblem, diagnose,
    fit_parameters,
};
use gdcm_model::dataset::model::Origin;
use gdcm_model::dataset::{Band, ConditionId, Dynamics, Model, PairTable, StateSpace};
use gdcm_model::executor::{Executor, Sequential};
use gdcm_model::progress::Unobserved;
use gdcm_model::response::{FrequencyGrid, FrequencyResponse, PreparedModel};

#[path = "stopwatch/mod.rs"]
mod stopwatch;

use stopwatch::shortest;

const STATES: usize = 39;
const INPUTS: usize = 4;
const OUTPUTS: usize = 6;
const PARAMETERS: usize = 14;
const CONDITIONS: u64 = 11;
const POINTS: usize = 40;
/// Runs of which the shortest counts.
const REPETITIONS: usize = 3;

/// Numbers between -0.5 and 0.5 that depend only on the seed (xorshift).
struct Noise(u64);

impl Noise {
    fn new(seed: u64) -> Self {
        Self(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1)
    }

    fn next(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
    }

    fn matrix(&mut self, rows: usize, columns: usize, size: f64) -> DMatrix<f64> {
        DMatrix::from_fn(rows, columns, |_, _| size * self.next())
    }
}

/// A condition's nominal model, and a run of each parameter at one plausible standard deviation.
struct Aircraft {
    base: StateSpace,
    runs: Vec<StateSpace>,
}

impl Aircraft {
    fn new(number: u64) -> Self {
        let mut noise = Noise::new(number + 1);
        let mut a = noise.matrix(STATES, STATES, 0.6);
        for state in 0..STATES {
            a[(state, state)] -= 0.5 + 0.4 * state as f64;
        }
        let b = noise.matrix(STATES, INPUTS, 1.0);
        let c = noise.matrix(OUTPUTS, STATES, 1.0);
        let d = noise.matrix(OUTPUTS, INPUTS, 0.1);
        // The same parameters act nearly alike in neighbouring conditions.
        let mut changes = Noise::new(1000 + number / 3);
        let mut runs = Vec::new();
        for _ in 0..PARAMETERS {
            let a = &a + changes.matrix(STATES, STATES, 0.05);
            let b = &b + changes.matrix(STATES, INPUTS, 0.05);
            runs.push(StateSpace::new(a, b, c.clone(), d.clone()).expect("finite"));
        }
        Self {
            base: StateSpace::new(a, b, c, d).expect("finite"),
            runs,
        }
    }

    fn model(&self) -> Model {
        let origin = Origin::Nominal { perturbation: None };
        Model::new("nominal", origin, Dynamics::StateSpace(self.base.clone()))
    }

    fn increments(&self) -> ConditionIncrements {
        let mut steps = Vec::new();
        for run in &self.runs {
            steps.push(vec![RunStep {
                z: 1.0,
                base: &self.base,
                run,
            }]);
        }
        ConditionIncrements::new(&self.model(), &steps).expect("one run for each parameter")
    }

    fn condition(&self, number: u64, omega: &[f64]) -> PhysicsCondition {
        let model = self.model();
        let increments = self.increments();
        let truth: Vec<f64> = (0..PARAMETERS)
            .map(|parameter| 1.2 * (1.7 * parameter as f64).sin())
            .collect();
        let moved = increments.apply(&model, &truth).expect("its own states");
        let flight = PreparedModel::new(&Dynamics::StateSpace(moved)).at(omega);
        let mut noise = Noise::new(2000 + number);
        let flight = Arc::new(FrequencyResponse::new(flight.curves().map(|_, curve| {
            curve
                .iter()
                .map(|value| value * (1.0 + 0.05 * noise.next()))
                .collect()
        })));
        PhysicsCondition {
            id: ConditionId(number as i64),
            family: Arc::new(ModelFamily::from_matrices(&model, &increments).expect("its states")),
            others: vec![Arc::clone(&flight)],
            flight,
            usable: PairTable::filled(OUTPUTS, INPUTS, true),
            deviation: None,
            coherence: None,
        }
    }

    /// Computes the response and all derivatives at the nominal values by a dense LU decomposition
    /// at each frequency, and returns a sum over them.
    fn plain_evaluation(&self, omega: &[f64]) -> Complex<f64> {
        let complex = |matrix: &DMatrix<f64>| matrix.map(|value| Complex::new(value, 0.0));
        let a = complex(self.base.a());
        let b = complex(self.base.b());
        let c = complex(self.base.c());
        let mut changes = Vec::new();
        for run in &self.runs {
            changes.push([
                complex(&(run.a() - self.base.a())),
                complex(&(run.b() - self.base.b())),
            ]);
        }
        let mut sum = Complex::new(0.0, 0.0);
        for omega in omega {
            let mut system = -&a;
            for state in 0..STATES {
                system[(state, state)] += Complex::new(0.0, *omega);
            }
            let transposed = system.transpose();
            let input_states = system.lu().solve(&b).expect("no pole on the axis");
            let output_states = transposed
                .lu()
                .solve(&c.transpose())
                .expect("no pole on the axis")
                .transpose();
            sum += (&c * &input_states).sum();
            for [change_a, change_b] in &changes {
                sum += (&output_states * (change_a * &input_states + change_b)).sum();
            }
        }
        sum
    }
}

fn main() {
    let band = Band::new(0.5, 12.0).expect("a band");
    let grid = FrequencyGrid::logarithmic(band, POINTS);
    let omega = grid.omega();
    let aircraft: Vec<Aircraft> = (0..CONDITIONS).map(Aircraft::new).collect();
    let mut conditions = Vec::new();
    for (number, aircraft) in aircraft.iter().enumerate() {
        conditions.push(aircraft.condition(number as u64, omega));
    }
    let problem = PhysicsProblem {
        omega: omega.into(),
        on_axis: PairTable::from_fn(OUTPUTS, INPUTS, |pair| pair.output == pair.input),
        parameters: vec![ParameterValue::Fitted; PARAMETERS],
        conditions,
        options: PhysicsOptions::default(),
    };
    let nominal = [0.0; PARAMETERS];
    let evaluation = shortest(REPETITIONS, || {
        for condition in &problem.conditions {
            black_box(condition.family.evaluate(&nominal, omega));
        }
    });
    let plain = shortest(REPETITIONS, || {
        for aircraft in &aircraft {
            black_box(aircraft.plain_evaluation(omega));
        }
    });
    println!(
        "responses and derivatives of a pass, one core: {:.1} ms; plain LU {:.1} ms, {:.1} times as \
        long",
        1e3 * evaluation.as_secs_f64(),
        1e3 * plain.as_secs_f64(),
        plain.as_secs_f64() / evaluation.as_secs_f64()
    );
    let executors: [(&str, &dyn Executor); 2] = [("one core", &Sequential), ("all cores", &Pool)];
    for (name, executor) in executors {
        let fit = fit_parameters(&problem, executor, &Unobserved).expect("nobody stops it");
        let fitted = shortest(REPETITIONS, || {
            fit_parameters(&problem, executor, &Unobserved)
        });
        let diagnosed = shortest(REPETITIONS, || diagnose(&problem, executor, &Unobserved));
        println!(
            "{name}: fit of {} passes {:.0} ms, diagnosis {:.0} ms",
            fit.passes.len(),
            1e3 * fitted.as_secs_f64(),
            1e3 * diagnosed.as_secs_f64()
        );
    }
}
