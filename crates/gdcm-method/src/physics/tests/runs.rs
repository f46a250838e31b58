//! Runs and their bases, units of a parameter, and the parameters offered (M18.1).

use std::collections::BTreeMap;

use nalgebra::DMatrix;

use gdcm_model::dataset::condition::FlightState;
use gdcm_model::dataset::dataset::DatasetHeader;
use gdcm_model::dataset::model::Origin;
use gdcm_model::dataset::physics_parameter::{MovedModel, MovedParameters, ParameterChange};
use gdcm_model::dataset::state_space::Timing;
use gdcm_model::dataset::{
    Band, Channel, Condition, ConditionId, Dataset, Dynamics, Model, PhysicsParameter, StateSpace,
};

use super::{diagnosis, diagonal, toy, toy_conditions, toy_omega};
use crate::physics::{ConditionIncrements, MatchedRuns, OfferedParameter, PhysicsProblem};

/// Returns the offset of the trim from the condition.
fn offsets(airspeed_kt: f64) -> Option<BTreeMap<String, f64>> {
    Some(BTreeMap::from([("airspeed_kt".to_owned(), airspeed_kt)]))
}

/// Creates a model from a reference system at a trim, with named states.
fn model(name: &str, airspeed_kt: f64, system: &StateSpace) -> Model {
    let perturbation = offsets(airspeed_kt);
    let origin = if name == "nominal" {
        Origin::Nominal { perturbation }
    } else {
        Origin::Perturbed { perturbation }
    };
    let mut model = Model::new(name, origin, Dynamics::StateSpace(system.clone()));
    model.states = ["u", "p", "q"].map(String::from).into();
    model
}

/// Creates a run of a parameter, moved by `delta` \[%\].
fn run(name: &str, parameter: &str, delta: f64, system: &StateSpace) -> MovedModel {
    MovedModel {
        model: model(name, 0.0, system),
        moved: MovedParameters::Run(ParameterChange {
            name: parameter.to_owned(),
            delta,
            unit: "%".to_owned(),
        }),
    }
}

/// Plausible standard deviations of the reference parameters \[%\].
const PLAUSIBLE: [f64; 2] = [5.0, 40.0];

/// Returns the reference parameters with these plausible standard deviations \[%\].
fn offered(plausible: [f64; 2]) -> Vec<OfferedParameter> {
    ["a", "b"]
        .iter()
        .zip(plausible)
        .map(|(name, plausible_sd)| OfferedParameter {
            name: (*name).to_owned(),
            unit: "%".to_owned(),
            plausible_sd,
            description: String::new(),
        })
        .collect()
}

/// Returns a reference condition's runs, with `scale` times their steps.
fn toy_runs(condition: usize, scale: f64) -> Vec<MovedModel> {
    let toy = &toy_conditions()[condition];
    let mut runs = Vec::new();
    for (parameter, name) in ["a", "b"].iter().enumerate() {
        for (index, (z, system)) in toy.runs[parameter].iter().enumerate() {
            let delta = z * PLAUSIBLE[parameter] * scale;
            runs.push(run(&format!("{name} {index}"), name, delta, system));
        }
    }
    runs
}

/// Creates a condition with these runs, whose nominal and whose slower physics model are both the
/// reference model.
fn condition(index: usize, runs: Vec<MovedModel>) -> Condition {
    let base = &toy_conditions()[index].base;
    let state = FlightState::at(ConditionId(index as i64 + 1), 60.0);
    let physics = vec![model("slower", -5.0, base), model("nominal", 0.0, base)];
    Condition::new(state, physics, Vec::new())
        .unwrap()
        .with_moved_models(runs)
        .unwrap()
}

/// Returns the codes of the refused runs.
fn refusals(runs: Vec<MovedModel>, is_used: &dyn Fn(&Model) -> bool) -> Vec<&'static str> {
    let condition = condition(1, runs);
    let matched = MatchedRuns::new(&condition, &offered(PLAUSIBLE), is_used);
    matched
        .refused
        .iter()
        .map(|refused| refused.reason.code())
        .collect()
}

/// Returns the reference problem with disturbed flight and a parameter unit of 1 / `scale`: its
/// steps and plausible standard deviations are `scale` times as large.
fn problem_in_parameter_unit(scale: f64) -> PhysicsProblem {
    let plausible = PLAUSIBLE.map(|sd| sd * scale);
    let mut problem = toy("R_disturbed");
    for (index, toy) in problem.conditions.iter_mut().enumerate() {
        let condition = condition(index, toy_runs(index, scale));
        let runs = MatchedRuns::new(&condition, &offered(plausible), &|_| true);
        assert!(runs.refused.is_empty());
        let nominal = condition.bundle(gdcm_model::dataset::BundleKind::Physics)[1].clone();
        let family = runs.family(&nominal, &offered(plausible), &toy_omega());
        toy.family = std::sync::Arc::new(family.unwrap());
    }
    problem
}

#[test]
fn the_unit_of_a_parameter_does_not_change_the_result() {
    let expected = diagnosis(&toy("R_disturbed"));
    for scale in [1.0, 0.01, 1000.0] {
        let found = diagnosis(&problem_in_parameter_unit(scale));
        for (found, expected) in found.parameters.iter().zip(&expected.parameters) {
            assert!((found.z - expected.z).abs() < 1e-9);
            let [found, expected] =
                [found, expected].map(|parameter| parameter.variance.unwrap().total());
            assert!((found - expected).abs() < 1e-9);
        }
    }
}

#[test]
fn matching_runs_are_used_with_the_nominal_model_as_base() {
    let condition = condition(1, toy_runs(1, 1.0));
    let matched = MatchedRuns::new(&condition, &offered(PLAUSIBLE), &|_| true);
    assert!(matched.refused.is_empty());
    assert_eq!(matched.runs.len(), 3);
    for run in &matched.runs {
        assert_eq!(run.base.name, "nominal");
    }
}

#[test]
fn a_run_that_does_not_fit_its_base_is_refused() {
    let system = toy_conditions()[1].runs[0][0].1.clone();
    let refused_after = |change: &dyn Fn(&mut MovedModel)| {
        let mut changed = run("run", "a", 5.0, &system);
        change(&mut changed);
        refusals(vec![changed], &|_| true)
    };
    assert_eq!(refused_after(&|_| {}), [""; 0], "unchanged, the run fits");
    assert_eq!(
        refused_after(&|run| run.model.origin = Origin::Perturbed {
            perturbation: offsets(7.0)
        }),
        ["run-without-base"]
    );
    assert_eq!(
        refused_after(&|run| run.model.states = ["p", "u", "q"].map(String::from).into()),
        ["run-states-differ"]
    );
    let timing = Timing {
        sample_time_s: Some(0.01),
        ..Timing::default()
    };
    assert_eq!(
        refused_after(&|run| {
            let timed = system.clone().timed(timing.clone()).unwrap();
            run.model.dynamics = Dynamics::StateSpace(timed);
        }),
        ["run-timing-differs"]
    );
    let smaller = StateSpace::new(
        DMatrix::zeros(2, 2),
        DMatrix::zeros(2, 2),
        DMatrix::zeros(2, 2),
        DMatrix::zeros(2, 2),
    )
    .unwrap();
    assert_eq!(
        refused_after(&|run| run.model.dynamics = Dynamics::StateSpace(smaller.clone())),
        ["run-shape-differs"]
    );
    assert_eq!(
        refused_after(&|run| {
            let base = toy_conditions()[1].base.clone();
            run.model.dynamics = Dynamics::StateSpace(base);
        }),
        ["run-changes-nothing"]
    );
    assert_eq!(
        refused_after(&|run| {
            run.moved = MovedParameters::Run(ParameterChange {
                name: "a".to_owned(),
                delta: 5.0,
                unit: "deg".to_owned(),
            });
        }),
        ["run-unit-differs"]
    );
    let is_used = |model: &Model| model.name != "nominal";
    assert_eq!(
        refusals(vec![run("run", "a", 5.0, &system)], &is_used),
        ["run-base-not-used"]
    );
}

#[test]
fn repeated_and_superfluous_runs_are_refused() {
    let toy = toy_conditions();
    let [plus, minus] = [0, 1].map(|index| &toy[1].runs[0][index].1);
    let of_parameter_b = &toy[1].runs[1][0].1;
    let first = run("first", "a", 5.0, plus);
    let refused = |later: &[MovedModel]| {
        let runs = [std::slice::from_ref(&first), later].concat();
        refusals(runs, &|_| true)
    };
    assert_eq!(
        refused(&[run("again", "a", 5.0, minus)]),
        ["run-step-repeated"]
    );
    assert_eq!(
        refused(&[run("same", "a", -5.0, plus)]),
        ["run-repeats-another"]
    );
    assert_eq!(
        refused(&[
            run("second", "a", -5.0, minus),
            run("third", "a", 2.0, of_parameter_b)
        ]),
        ["run-too-many"]
    );
}

#[test]
fn a_condition_without_the_runs_of_a_parameter_is_left_out() {
    let omission_code = |runs: Vec<MovedModel>| {
        let condition = condition(1, runs);
        let matched = MatchedRuns::new(&condition, &offered(PLAUSIBLE), &|_| true);
        matched.increments(&offered(PLAUSIBLE)).unwrap_err().code()
    };
    assert_eq!(omission_code(Vec::new()), "condition-without-runs");
    let mut runs = toy_runs(1, 1.0);
    runs.truncate(2);
    assert_eq!(omission_code(runs), "condition-lacks-run");
}

#[test]
fn a_representative_with_other_states_is_changed_by_its_responses() {
    let condition = condition(1, toy_runs(1, 1.0));
    let matched = MatchedRuns::new(&condition, &offered(PLAUSIBLE), &|_| true);
    let mut representative = model("nominal", 0.0, &toy_conditions()[1].base);
    representative.states = ["x1", "x2", "x3"].map(String::from).into();
    let family = matched.family(&representative, &offered(PLAUSIBLE), &toy_omega());
    assert_eq!(family.unwrap().points(), Some(toy_omega().len()));
    let increments = matched.increments(&offered(PLAUSIBLE)).unwrap();
    assert_eq!(
        increments
            .apply(&representative, &[0.1, 0.1])
            .unwrap_err()
            .code(),
        "increment-states-differ"
    );
}

#[test]
fn an_undeclared_plausible_deviation_defaults_to_the_largest_step() {
    let header = |parameters| DatasetHeader {
        name: String::new(),
        description: String::new(),
        inputs: vec![Channel::new("x", "%"), Channel::new("y", "%")],
        outputs: vec![Channel::new("p", "deg/s"), Channel::new("q", "deg/s")],
        on_axis: diagonal(),
        band: Band::new(0.5, 12.0).unwrap(),
        parameters,
    };
    let conditions = vec![condition(1, toy_runs(1, 1.0))];
    let declared = |name: &str, plausible_sd| PhysicsParameter {
        name: name.to_owned(),
        unit: "%".to_owned(),
        plausible_sd,
        description: String::new(),
    };
    let parameters = vec![declared("b", Some(7.0)), declared("idle", Some(1.0))];
    let dataset = Dataset::new(header(parameters), conditions).unwrap();
    let offered = OfferedParameter::list(&dataset);
    let summary: Vec<(&str, f64)> = offered
        .iter()
        .map(|parameter| (parameter.name.as_str(), parameter.plausible_sd))
        .collect();
    // b is declared, a has runs of up to 5 %, idle has no run.
    assert_eq!(summary, [("b", 7.0), ("a", 5.0)]);
}

#[test]
fn steps_of_runs_must_be_finite_and_not_zero() {
    let toy = &toy_conditions()[1];
    for z in [0.0, f64::NAN, f64::INFINITY] {
        let mut toy = toy.clone();
        toy.runs[1][0].0 = z;
        let error = ConditionIncrements::new(&toy.base(), &toy.steps()).unwrap_err();
        assert_eq!(error.code(), "increment-runs");
    }
}
