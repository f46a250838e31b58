//! Named parameters of the physics model (M18) on a dataset with known truth, compared with
//! independent numpy results.

use std::sync::Arc;

use gdcm_io::load_dataset;
use gdcm_method::fidelity::{CostAverage, Mismatch};
use gdcm_method::physics::problem::PhysicsOptions;
use gdcm_method::physics::{
    MatchedRuns, OfferedParameter, ParameterValue, PhysicsCondition, PhysicsDiagnosis,
    PhysicsProblem, Verdict, diagnose, fit_parameters,
};
use gdcm_model::dataset::{Condition, Dataset};
use gdcm_model::response::{GainDelay, PolarResponse};

use gdcm_study::results::assessment_table::{AssessedModel, AssessmentChoice};
use gdcm_study::{AssessedCorrection, AssessmentTable, PhaseCorrection};

use super::*;
use crate::EveryCore;

/// Results of the independent numpy code, and the true changes of the parameters.
static REFERENCE: LazyLock<Value> = LazyLock::new(|| {
    json(include_str!(
        "../../../../../tests/data/reference/physics.json"
    ))
});

static DATASET: LazyLock<Arc<Dataset>> = LazyLock::new(|| {
    let path = crate::program_folder().join("tests/data/reference/physics-dataset.json.gz");
    let loaded = load_dataset(&path).unwrap();
    assert!(loaded.cautions.is_empty(), "{:?}", loaded.cautions);
    loaded.dataset
});

/// The forty points on which the responses of the dataset were measured.
const POINTS: usize = 40;

fn grid() -> FrequencyGrid {
    FrequencyGrid::logarithmic(DATASET.band(), POINTS)
}

/// Returns the problem of the reference, with its representatives.
fn problem(parameters: &[OfferedParameter]) -> PhysicsProblem {
    let grid = grid();
    let mut conditions = Vec::new();
    for known in list(&REFERENCE["dataset"]["analysis"]["conditions"]) {
        let id = ConditionId(known["id"].as_i64().unwrap());
        let condition = DATASET.condition(id).unwrap();
        let model = |kind, key: &str| condition.model(kind, known[key].as_str().unwrap()).unwrap();
        let physics = model(BundleKind::Physics, "physics");
        let identified = model(BundleKind::Identified, "identified");
        let runs = MatchedRuns::new(condition, parameters, &|_| true);
        assert!(runs.refused.is_empty(), "{:?}", runs.refused);
        let mut others = Vec::new();
        for other in condition.bundle(BundleKind::Identified) {
            if other.name != identified.name {
                let response = FrequencyResponse::from_dynamics(&other.dynamics, &grid);
                others.push(Arc::new(response));
            }
        }
        conditions.push(PhysicsCondition {
            id,
            family: Arc::new(runs.family(physics, parameters, grid.omega()).unwrap()),
            flight: Arc::new(FrequencyResponse::from_dynamics(
                &identified.dynamics,
                &grid,
            )),
            others,
            usable: PairTable::filled(DATASET.outputs().len(), DATASET.inputs().len(), true),
            deviation: None,
            coherence: None,
        });
    }
    PhysicsProblem {
        omega: grid.omega().into(),
        on_axis: DATASET.on_axis().clone(),
        parameters: vec![ParameterValue::Fitted; parameters.len()],
        conditions,
        options: PhysicsOptions::default(),
    }
}

/// Diagnosis of all parameters.
static DIAGNOSIS: LazyLock<PhysicsDiagnosis> = LazyLock::new(|| {
    let parameters = OfferedParameter::list(&DATASET);
    diagnose(&problem(&parameters), &EveryCore, &Unobserved).unwrap()
});

/// Returns the tolerance that the reference states for a quantity.
fn tolerance(key: &str) -> f64 {
    number(&REFERENCE["tolerance"][key])
}

fn assert_close(found: &[f64], expected: &Value, tolerance: f64, quantity: &str) {
    let expected = numbers(expected);
    assert_eq!(found.len(), expected.len(), "{quantity}");
    for (index, (found, expected)) in found.iter().zip(&expected).enumerate() {
        assert!(
            (found - expected).abs() <= tolerance,
            "{quantity}, {index}: {found} instead of {expected}"
        );
    }
}

#[test]
fn the_parameters_of_the_dataset_are_offered() {
    let known = &REFERENCE["dataset"]["analysis"];
    let offered = OfferedParameter::list(&DATASET);
    let names: Vec<&str> = offered
        .iter()
        .map(|offered| offered.name.as_str())
        .collect();
    let units: Vec<&str> = offered
        .iter()
        .map(|offered| offered.unit.as_str())
        .collect();
    let plausible: Vec<f64> = offered.iter().map(|offered| offered.plausible_sd).collect();
    assert_eq!(names, texts(&known["names"]));
    assert_eq!(units, texts(&known["units"]));
    assert_eq!(plausible, numbers(&known["plausible_sd"]));
}

#[test]
fn every_pass_agrees_with_the_reference() {
    let known = &REFERENCE["dataset"]["analysis"];
    let passes = list(&known["passes"]);
    assert_eq!(DIAGNOSIS.fit.passes.len(), passes.len());
    for (pass, expected) in DIAGNOSIS.fit.passes.iter().zip(passes) {
        assert_close(&pass.z, &expected["z"], tolerance("z"), "z of a pass");
        assert!((pass.misfit_square - number(&expected["s2"])).abs() < 1e-8);
        let square = number(&expected["sum_of_weighted_squares"]);
        assert!((pass.weighted_square / square - 1.0).abs() < 1e-6);
    }
    assert_close(&DIAGNOSIS.fit.z, &known["z"], tolerance("z"), "z");
    let delays_s = &DIAGNOSIS.fit.delays_s;
    assert_close(
        &delays_s.outputs,
        &known["tau_out_s"],
        tolerance("tau_s"),
        "tau of outputs",
    );
    assert_close(
        &delays_s.inputs,
        &known["tau_in_s"],
        tolerance("tau_s"),
        "tau of inputs",
    );
    for (ln_gains, expected) in DIAGNOSIS
        .fit
        .ln_gains
        .iter()
        .zip(list(&known["own_ln_gain"]))
    {
        let ln_gains = [&ln_gains.outputs[..], &ln_gains.inputs[..]].concat();
        assert_close(&ln_gains, expected, 1e-6, "ln gains");
    }
    assert!((DIAGNOSIS.fit.misfit - number(&known["misfit"])).abs() < 1e-8);
    let spread = number(&known["spread_of_identified"]);
    assert!((DIAGNOSIS.spread.unwrap() - spread).abs() < 1e-7);
}

#[test]
fn intervals_and_their_parts_agree_with_the_reference() {
    let known = &REFERENCE["dataset"]["analysis"];
    let found = &DIAGNOSIS.parameters;
    let half_widths: Vec<f64> = found.iter().map(|p| p.half_width.unwrap()).collect();
    assert_close(
        &half_widths,
        &known["half_width_z"],
        tolerance("half_width"),
        "half-width",
    );
    for part in ["condition", "output", "input", "band", "prior"] {
        let mut variances = Vec::new();
        for parameter in found {
            let variance = parameter.variance.unwrap();
            variances.push(match part {
                "condition" => variance.condition.unwrap(),
                "output" => variance.output.unwrap(),
                "input" => variance.input.unwrap(),
                "band" => variance.band.unwrap(),
                _ => variance.prior,
            });
        }
        assert_close(&variances, &known["variance"][part], 1e-6, part);
    }
    let truth = numbers(&known["true_change"]);
    let plausible = numbers(&known["plausible_sd"]);
    for (index, parameter) in found.iter().enumerate() {
        let error = parameter.z - truth[index] / plausible[index];
        assert!(
            error.abs() < half_widths[index],
            "the interval of parameter {index} does not contain its true value"
        );
    }
    for (condition, expected) in DIAGNOSIS
        .conditions
        .iter()
        .zip(list(&known["z_without_condition"]))
    {
        assert_close(
            &condition.z_without,
            expected,
            tolerance("z"),
            "z without a condition",
        );
    }
}

#[test]
fn identifiability_agrees_with_the_reference() {
    let known = &REFERENCE["dataset"]["analysis"];
    let found = &DIAGNOSIS.identifiability;
    assert_eq!(found.singular_values.len(), 7);
    for (row, expected) in list(&known["information"]).iter().enumerate() {
        let information: Vec<f64> = found.information.row(row).iter().copied().collect();
        assert_close(&information, expected, 1e-3, "information");
        let correlation: Vec<f64> = found.correlation.row(row).iter().copied().collect();
        assert_close(
            &correlation,
            &known["correlation"][row],
            1e-6,
            "correlation",
        );
    }
    assert_close(
        &found.singular_values,
        &known["singular_values"],
        1e-2,
        "singular values",
    );
    assert_eq!(found.weak_direction, None);
    let deviations: Vec<f64> = found
        .learned
        .iter()
        .map(|learned| (1.0 - learned).sqrt())
        .collect();
    assert_close(&deviations, &known["posterior_sd"], 1e-6, "posterior sd");
    let shares: Vec<f64> = found
        .channels_can_take
        .iter()
        .map(|share| share.unwrap())
        .collect();
    assert_close(
        &shares,
        &known["share_channels_can_take"],
        1e-6,
        "share that channels can take",
    );
    assert!(DIAGNOSIS.pairs.is_empty());
}

#[test]
fn scores_names_and_verdict_agree_with_the_reference() {
    let known = &REFERENCE["dataset"]["analysis"];
    let scores = DIAGNOSIS.scores.as_ref().unwrap();
    assert_close(
        &scores.alone,
        &known["score"]["alone"],
        tolerance("ratio"),
        "alone",
    );
    let names = texts(&known["names"]);
    let steps = list(&known["score"]["stepwise"]);
    assert_eq!(scores.stepwise.len(), steps.len());
    for (step, expected) in scores.stepwise.iter().zip(steps) {
        let added = step.added.map(|parameter| names[parameter]);
        assert_eq!(added, expected["added"].as_str());
        assert!((step.score.ratio - number(&expected["ratio"])).abs() < tolerance("ratio"));
    }
    let explained = number(&known["explained"]);
    assert!((DIAGNOSIS.explained().unwrap() - explained).abs() < tolerance("ratio"));
    let named: Vec<&str> = DIAGNOSIS
        .named()
        .iter()
        .map(|&index| names[index])
        .collect();
    assert_eq!(named, texts(&known["named"]));
    assert_eq!(DIAGNOSIS.verdict, Some(Verdict::Accounts));
    let inflow = &DIAGNOSIS.parameters[2];
    assert_eq!(inflow.why_not_named.unwrap().code(), "little-gain");
    assert_eq!(
        DIAGNOSIS.parameters[0].why_not_named.unwrap().code(),
        "interval-contains-zero"
    );
}

#[test]
fn a_fit_of_the_named_parameters_alone_agrees_with_the_reference() {
    let known = &REFERENCE["dataset"]["analysis"]["named_only"];
    let parameters = OfferedParameter::list(&DATASET);
    let problem = problem(&parameters).with_fitted(&DIAGNOSIS.named());
    let found = fit_parameters(&problem, &EveryCore, &Unobserved).unwrap();
    assert_eq!(found.passes.len() as u64, known["passes"].as_u64().unwrap());
    assert_close(&found.z, &known["z"], tolerance("z"), "z");
    assert_close(
        &found.delays_s.outputs,
        &known["tau_out_s"],
        tolerance("tau_s"),
        "tau of outputs",
    );
    assert_close(
        &found.delays_s.inputs,
        &known["tau_in_s"],
        tolerance("tau_s"),
        "tau of inputs",
    );
}

/// Returns the mean J of the nominal physics models with the parameters at `z` over the conditions:
/// of the on-axis responses, and of the other responses.
fn mean_costs(z: &[f64]) -> [f64; 2] {
    let parameters = OfferedParameter::list(&DATASET);
    let grid = grid();
    let problem = problem(&parameters);
    let mut sums = [0.0; 2];
    let mut counts = [0.0; 2];
    for condition in &problem.conditions {
        let data = DATASET.condition(condition.id).unwrap();
        let nominal = &data.bundle(BundleKind::Physics)[data.nominal()];
        let runs = MatchedRuns::new(data, &parameters, &|_| true);
        let model = runs
            .increments(&parameters)
            .unwrap()
            .apply(nominal, z)
            .unwrap();
        let physics = FrequencyResponse::from_dynamics(&Dynamics::StateSpace(model), &grid);
        let physics = PolarResponse::new(&physics);
        let flight = PolarResponse::new(&condition.flight);
        for (pair, on_axis) in DATASET.on_axis().iter() {
            let [physics, flight] =
                [&physics, &flight].map(|polar| polar.curves()[pair].as_ref().unwrap());
            let cost = Mismatch::new(physics, flight).cost(
                grid.omega(),
                GainDelay::new(1.0, 0.0),
                CostAverage::Median,
            );
            let place = usize::from(!*on_axis);
            sums[place] += cost.total();
            counts[place] += 1.0;
        }
    }
    [sums[0] / counts[0], sums[1] / counts[1]]
}

#[test]
fn costs_of_the_moved_physics_models_agree_with_the_reference() {
    let known = &REFERENCE["dataset"]["analysis"]["J"];
    assert_close(
        &mean_costs(&[0.0; 7]),
        &known["uncorrected"],
        tolerance("mean_J"),
        "uncorrected",
    );
    assert_close(
        &mean_costs(&DIAGNOSIS.fit.z),
        &known["with"]["physics"],
        tolerance("mean_J"),
        "with the values found",
    );
}

/// Returns the dataset with every physics model of its bundles at the values `z`.
fn dataset_moved_to(z: &[f64]) -> Dataset {
    let parameters = OfferedParameter::list(&DATASET);
    let mut conditions = Vec::new();
    for condition in DATASET.conditions() {
        let runs = MatchedRuns::new(condition, &parameters, &|_| true);
        let increments = runs.increments(&parameters).unwrap();
        let mut physics = condition.bundle(BundleKind::Physics).to_vec();
        for model in &mut physics {
            model.dynamics = Dynamics::StateSpace(increments.apply(model, z).unwrap());
        }
        let state = condition.flight_state().clone();
        let identified = condition.bundle(BundleKind::Identified).to_vec();
        conditions.push(Condition::new(state, physics, identified).unwrap());
    }
    Dataset::new(DATASET.header(), conditions).unwrap()
}

/// Returns the mean J of the corrected representatives over the conditions: under each condition's
/// own correction, and under the schedule; of the on-axis responses, and of the other responses.
fn corrected_costs(z: &[f64]) -> [[f64; 2]; 2] {
    let mut study = Study::new(Arc::new(dataset_moved_to(z)));
    for edit in [
        setting_table::PHASE.to(PhaseCorrection::Lead),
        setting_table::POINTS.to(POINTS),
    ] {
        study.apply(&edit).unwrap();
    }
    let analysis = analyze(&mut Engine::default(), &study);
    let choice = AssessmentChoice {
        model: AssessedModel::Representative,
        correction: AssessedCorrection::Scheduled,
        average: CostAverage::Median,
    };
    let scheduled = AssessmentTable::assess(&analysis, choice);
    let mut sums = [[0.0; 2]; 2];
    let mut counts = [0.0; 2];
    for id in DATASET.ids() {
        for (pair, change) in analysis.condition(id).unwrap().cost.iter() {
            let place = usize::from(!DATASET.on_axis()[pair]);
            sums[0][place] += change.unwrap().corrected.total();
            sums[1][place] += scheduled.change(id, pair).unwrap().corrected.total();
            counts[place] += 1.0;
        }
    }
    sums.map(|sums| [sums[0] / counts[0], sums[1] / counts[1]])
}

#[test]
fn costs_of_corrections_after_the_parameters_agree_with_the_reference() {
    let known = &REFERENCE["dataset"]["analysis"];
    let named = numbers(&known["named_only"]["z"]);
    for (z, expected) in [
        (vec![0.0; 7], &known["J"]["without"]),
        (DIAGNOSIS.fit.z.clone(), &known["J"]["with"]),
        (named, &known["J"]["with_named_only"]),
    ] {
        let [own, scheduled] = corrected_costs(&z);
        assert_close(&own, &expected["own"], tolerance("mean_J"), "own");
        assert_close(
            &scheduled,
            &expected["scheduled"],
            tolerance("mean_J"),
            "scheduled",
        );
    }
}
