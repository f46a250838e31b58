//! Named physics parameters (M18: `docs/physics.md`).
//!
//! A *run* is the physics model linearised anew with one parameter moved; z is a parameter's change
//! over its plausible standard deviation. The *increments* are the changes of the matrices from the
//! base model to the runs, the *family* all models between and beyond them as functions of z. The
//! fit of all z to flight is repeated in *passes*.
//!
//! In the reference, `toy` is a synthetic aircraft with the flight responses `R`, `s2` the squared
//! misfit before a pass and `tau` the channels' delays, outputs before inputs.

use std::sync::Arc;

use gdcm_method::physics::increments::RunStep;
use gdcm_method::physics::problem::PhysicsOptions;
use gdcm_method::physics::{
    ConditionIncrements, ModelFamily, ParameterValue, PhysicsCondition, PhysicsProblem, diagnose,
};
use gdcm_model::dataset::model::Origin;
use gdcm_model::dataset::{ConditionId, Dynamics, Model, Pair, PairTable, StateSpace};
use gdcm_model::executor::Sequential;
use gdcm_model::progress::Unobserved;
use gdcm_model::response::FrequencyResponse;

use crate::check::{CheckFault, Found};
use crate::reference::{PHYSICS, Reference};
use crate::reference_study::ReferenceStudy;

/// The synthetic aircraft's parameters: the first has two runs, the second has one.
const PARAMETERS: [&str; 2] = ["a", "b"];

/// A physics model with one parameter moved by `z` plausible standard deviations.
struct Run {
    z: f64,
    model: StateSpace,
}

impl Run {
    fn step_from<'a>(&'a self, base: &'a StateSpace) -> RunStep<'a> {
        RunStep {
            z: self.z,
            base,
            run: &self.model,
        }
    }
}

/// Reads a parameter's runs in a condition.
fn runs_of_parameter(parameter: &str, condition: &Reference) -> Result<Vec<Run>, CheckFault> {
    let mut runs = Vec::new();
    for run in condition.list("runs")? {
        if run.text("parameter")? == parameter {
            runs.push(Run {
                z: run.number("z")?,
                model: state_space(&run.member("matrices")?)?,
            });
        }
    }
    Ok(runs)
}

/// Reads a model stored as `[A, B, C, D]`.
fn state_space(value: &Reference) -> Result<StateSpace, CheckFault> {
    let matrices = value.elements()?;
    let [a, b, c, d] = matrices.as_slice() else {
        return Err(CheckFault::no_result("a model has four matrices"));
    };
    StateSpace::new(
        a.as_matrix()?,
        b.as_matrix()?,
        c.as_matrix()?,
        d.as_matrix()?,
    )
    .map_err(CheckFault::no_result)
}

/// Builds a condition from its base model and runs in `value`, and the flight responses.
fn condition(
    id: i64,
    value: &Reference,
    flight: FrequencyResponse,
) -> Result<PhysicsCondition, CheckFault> {
    let base = state_space(&value.member("base")?)?;
    let mut runs_by_parameter: Vec<Vec<Run>> = Vec::new();
    for parameter in PARAMETERS {
        runs_by_parameter.push(runs_of_parameter(parameter, value)?);
    }
    let mut steps_by_parameter: Vec<Vec<RunStep<'_>>> = Vec::new();
    for runs in &runs_by_parameter {
        steps_by_parameter.push(runs.iter().map(|run| run.step_from(&base)).collect());
    }
    let origin = Origin::Nominal { perturbation: None };
    let model = Model::new("nominal", origin, Dynamics::StateSpace(base.clone()));
    let increments =
        ConditionIncrements::new(&model, &steps_by_parameter).map_err(CheckFault::no_result)?;
    let Some(family) = ModelFamily::from_matrices(&model, &increments) else {
        return Err(CheckFault::no_result("the runs do not fit the model"));
    };
    Ok(PhysicsCondition {
        id: ConditionId(id),
        usable: PairTable::filled(family.outputs(), family.inputs(), true),
        family: Arc::new(family),
        flight: Arc::new(flight),
        others: Vec::new(),
        deviation: None,
        coherence: None,
    })
}

/// Compares the synthetic aircraft's parameters and misfit after each pass, and its delays, with
/// the reference: once for exact, once for disturbed flight responses.
pub(super) fn synthetic_aircraft(_: &mut ReferenceStudy) -> Result<Found, CheckFault> {
    let aircraft = PHYSICS.read()?.member("toy")?;
    let models = aircraft.list("models")?;
    let mut found = Found::default();
    for (flight, case) in [("R", "exact"), ("R_disturbed", "disturbed")] {
        let mut conditions = Vec::new();
        for (index, value) in aircraft.list(flight)?.iter().enumerate() {
            let id = index as i64 + 1;
            conditions.push(condition(id, &models[index], value.as_response()?)?);
        }
        let problem = PhysicsProblem {
            omega: aircraft.numbers("omega_rad_s")?.into(),
            on_axis: PairTable::from_fn(2, 2, |pair: Pair| pair.output == pair.input),
            parameters: vec![ParameterValue::Fitted; PARAMETERS.len()],
            conditions,
            options: PhysicsOptions::default(),
        };
        let own = diagnose(&problem, &Sequential, &Unobserved).map_err(CheckFault::no_result)?;
        let expected = aircraft.member(case)?;
        let passes = expected.list("passes")?;
        found.agree(own.fit.passes.len() == passes.len());
        for (own, expected) in own.fit.passes.iter().zip(passes) {
            found.instance();
            found.all_scaled(&own.z, &expected.numbers("z")?, 1.0);
            found.deviation(own.misfit_square - expected.number("s2")?);
        }
        let delays_s = &own.fit.delays_s;
        let delays_s = [&delays_s.outputs[..], &delays_s.inputs[..]].concat();
        found.all_scaled(&delays_s, &expected.numbers("tau")?, 1.0);
    }
    Ok(found)
}
