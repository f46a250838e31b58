//! Named parameters as a stage of the analysis (M18.5): everything after the fit sees the moved
//! physics models.

use std::collections::BTreeSet;
use std::sync::Arc;

use gdcm_io::load_dataset;
use gdcm_method::correction::Channel;
use gdcm_model::dataset::physics_parameter::{MovedModel, MovedParameters, ParameterChange};
use gdcm_model::dataset::{Condition, Model};
use gdcm_model::dataset::{ConditionId, Dataset};
use gdcm_study::decisions::physics_settings::ParameterDecision;
use gdcm_study::jobs::analysis_jobs::PhysicsJob;
use gdcm_study::jobs::job::Job;
use gdcm_study::results::applied_physics::AppliedPhysics;
use gdcm_study::results::correction_costs::AxisCost;
use gdcm_study::results::moved_models::MovedModels;
use gdcm_study::results::physics_assessment::PhysicsAssessment;
use gdcm_study::results::rerun_check::RerunVerdict;
use gdcm_study::results::suggested_runs::{RunPattern, suggested_runs};
use gdcm_study::{PhaseCorrection, PhysicsCorrection};
use gdcm_words::suggested_runs::{run_template, suggestion_text};

use super::*;

/// Results of independent numpy code for [`DATASET`].
static REFERENCE: LazyLock<Value> = LazyLock::new(|| {
    json(include_str!(
        "../../../../../tests/data/reference/physics.json"
    ))
});

static DATASET: LazyLock<Arc<Dataset>> = LazyLock::new(|| {
    let path = crate::program_folder().join("tests/data/reference/physics-dataset.json.gz");
    load_dataset(&path).unwrap().dataset
});

/// Returns a study with the settings of the reference.
fn reference_study(physics: PhysicsCorrection) -> Study {
    study_of(&DATASET, physics)
}

fn study_of(dataset: &Arc<Dataset>, physics: PhysicsCorrection) -> Study {
    let mut study = Study::new(Arc::clone(dataset));
    for edit in [
        setting_table::PHASE.to(PhaseCorrection::Lead),
        setting_table::POINTS.to(40_usize),
        setting_table::PHYSICS.to(physics),
    ] {
        study.apply(&edit).unwrap();
    }
    study
}

fn decide(study: &mut Study, name: &str, decision: ParameterDecision) {
    study
        .apply(&Edit::DecideParameter {
            name: name.to_owned(),
            decision,
        })
        .unwrap();
}

/// Analysis after a fit of all parameters.
static WITH_ALL_PARAMETERS: LazyLock<Analysis> = LazyLock::new(|| {
    let study = reference_study(PhysicsCorrection::All);
    analyze(&mut Engine::default(), &study)
});

/// Analysis with the physics models of the file.
static WITHOUT_PARAMETERS: LazyLock<Analysis> = LazyLock::new(|| {
    let study = reference_study(PhysicsCorrection::Off);
    analyze(&mut Engine::default(), &study)
});

fn applied(analysis: &Analysis) -> &AppliedPhysics {
    analysis.applied_physics().unwrap()
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

/// Returns the mean J over the on-axis responses, and over the others.
fn on_axis_and_others(cost: AxisCost) -> [f64; 2] {
    [cost.on_axis.unwrap(), cost.others.unwrap()]
}

/// Diagnoses the parameters of the dataset and assesses their benefit.
fn assess(physics: PhysicsCorrection) -> Arc<PhysicsAssessment> {
    let job = PhysicsJob {
        study: reference_study(PhysicsCorrection::Off),
        physics,
    };
    let mut engine = Engine::with_executor(Box::new(crate::EveryCore));
    job.run(&mut engine, &Unobserved).unwrap().unwrap().unwrap()
}

#[test]
fn the_stage_finds_the_values_of_the_reference() {
    let known = &REFERENCE["dataset"]["analysis"];
    let z: Vec<f64> = applied(&WITH_ALL_PARAMETERS)
        .values
        .iter()
        .map(|value| value.z)
        .collect();
    assert_close(&z, &known["z"], 1e-6, "z");
    let changes: Vec<f64> = applied(&WITH_ALL_PARAMETERS)
        .values
        .iter()
        .map(|value| value.change())
        .collect();
    assert_close(&changes, &known["change"], 1e-4, "change");
    let findings = applied(&WITH_ALL_PARAMETERS).findings.as_ref().unwrap();
    let named: Vec<&str> = findings
        .named()
        .iter()
        .map(|named| named.parameter.name.as_str())
        .collect();
    assert_eq!(named, texts(&known["named"]));
    assert!(findings.left_out.runs.is_empty() && findings.left_out.conditions.is_empty());
}

#[test]
fn the_named_parameters_are_fitted_again_with_the_rest_off() {
    let known = &REFERENCE["dataset"]["analysis"]["named_only"];
    let study = reference_study(PhysicsCorrection::Named);
    let analysis = analyze(&mut Engine::default(), &study);
    let refit = applied(&analysis).refit.as_ref().unwrap();
    assert_close(&refit.fit.z, &known["z"], 1e-6, "z");
    let names: Vec<&str> = applied(&analysis)
        .values
        .iter()
        .map(|value| value.parameter.name.as_str())
        .collect();
    assert_eq!(names, ["tail_lift", "swashplate_phase"]);
}

#[test]
fn channels_after_the_parameters_agree_with_the_reference() {
    for known in list(&REFERENCE["dataset"]["analysis"]["channels_after"]) {
        let id = ConditionId(known["id"].as_i64().unwrap());
        let correction = &WITH_ALL_PARAMETERS.condition(id).unwrap().correction;
        let delays_s = correction.signed_delays_s();
        assert_close(
            &delays_s.outputs,
            &known["tau_out_s"],
            1e-6,
            "tau of outputs",
        );
        assert_close(&delays_s.inputs, &known["tau_in_s"], 1e-6, "tau of inputs");
        let gains = |channels: &[Channel]| -> Vec<f64> {
            channels
                .iter()
                .map(|channel| correction.gain(*channel))
                .collect()
        };
        let outputs: Vec<Channel> = (0..6).map(Channel::Output).collect();
        let inputs: Vec<Channel> = (0..4).map(Channel::Input).collect();
        assert_close(&gains(&outputs), &known["k_out"], 1e-5, "output gains");
        assert_close(&gains(&inputs), &known["k_in"], 1e-5, "input gains");
    }
}

#[test]
fn costs_agree_with_the_reference_also_for_left_out_conditions() {
    let known = &REFERENCE["dataset"]["analysis"]["J"];
    let found = assess(PhysicsCorrection::All);
    let costs = &found.costs;
    for (cost, key) in [(costs.own, "own"), (costs.scheduled, "scheduled")] {
        assert_close(
            &on_axis_and_others(cost.without),
            &known["without"][key],
            1e-3,
            key,
        );
        assert_close(
            &on_axis_and_others(cost.with),
            &known["with"][key],
            1e-3,
            key,
        );
    }
    let left_out = costs.left_out.unwrap();
    assert_close(
        &on_axis_and_others(left_out.without),
        &known["without"]["left_out"],
        1e-3,
        "left out",
    );
    assert_close(
        &on_axis_and_others(left_out.with),
        &known["with"]["left_out"],
        1e-3,
        "left out",
    );
    assert_close(
        &on_axis_and_others(costs.uncorrected),
        &known["uncorrected"],
        1e-3,
        "uncorrected",
    );
    assert_close(
        &on_axis_and_others(found.moved_uncorrected),
        &known["with"]["physics"],
        1e-3,
        "moved",
    );
    // The mean of the table is over the conditions.
    let each: Vec<f64> = found
        .conditions
        .values()
        .map(|condition| condition.left_out.unwrap().with.on_axis.unwrap())
        .collect();
    let mean = each.iter().sum::<f64>() / each.len() as f64;
    assert!((mean - left_out.with.on_axis.unwrap()).abs() < 1e-9);
}

#[test]
fn the_job_for_the_named_parameters_agrees_with_the_reference() {
    let known = &REFERENCE["dataset"]["analysis"]["J"]["with_named_only"];
    let costs = assess(PhysicsCorrection::Named).costs;
    assert_close(
        &on_axis_and_others(costs.own.with),
        &known["own"],
        1e-3,
        "own",
    );
    assert_close(
        &on_axis_and_others(costs.scheduled.with),
        &known["scheduled"],
        1e-3,
        "scheduled",
    );
}

#[test]
fn moved_models_reach_corrections_schedule_and_assessment() {
    let ids: BTreeSet<ConditionId> = WITHOUT_PARAMETERS.study.dataset.ids().collect();
    let before = corrections(&WITHOUT_PARAMETERS, "", &ids);
    let after = corrections(&WITH_ALL_PARAMETERS, "", &ids);
    for key in ["conditions", "schedule", "assessment"] {
        assert_ne!(before[key], after[key], "{key}");
    }
    assert_eq!(before.get("physics"), None);
    for id in DATASET.ids() {
        let [before, after] = [&*WITHOUT_PARAMETERS, &*WITH_ALL_PARAMETERS]
            .map(|analysis| analysis.condition(id).unwrap());
        // Representatives and outliers are decided on the models of the dataset.
        for kind in BundleKind::BOTH {
            assert_eq!(before.representative(kind), after.representative(kind));
        }
        assert_eq!(before.bundle_metrics, after.bundle_metrics);
        assert_eq!(&*before.comparison, after.file_comparison());
        assert_ne!(before.comparison.delta, after.comparison.delta);
        assert_ne!(before.correction, after.correction);
        assert_ne!(before.cost, after.cost);
        assert_eq!(after.file_condition(), DATASET.condition(id).unwrap());
    }
}

#[test]
fn the_moved_nominal_model_has_the_response_of_its_increments() {
    let id = DATASET.ids().next().unwrap();
    let result = WITH_ALL_PARAMETERS.condition(id).unwrap();
    let grid = FrequencyGrid::logarithmic(DATASET.band(), 40);
    let nominal = &result.condition.bundle(BundleKind::Physics)[result.condition.nominal()];
    let response = FrequencyResponse::from_dynamics(&nominal.dynamics, &grid);
    let findings = applied(&WITH_ALL_PARAMETERS).findings.as_ref().unwrap();
    let condition = &findings.problem.conditions[0];
    assert_eq!(condition.id, id);
    let family = condition
        .family
        .evaluate(&findings.diagnosis.fit.z, grid.omega());
    for (pair, curve) in response.curves().iter() {
        let start = (pair.output * 4 + pair.input) * grid.len();
        let largest = curve.iter().map(|value| value.norm()).fold(0.0, f64::max);
        for (k, value) in curve.iter().enumerate() {
            let error = (family.response[start + k] - value).norm();
            assert!(error <= 1e-7 * largest, "{pair:?} {k}: {error}");
        }
    }
}

#[test]
fn error_bars_depend_on_the_moved_models() {
    let engine = || Engine::with_executor(Box::new(crate::EveryCore));
    let all = engine()
        .uncertainty(&WITH_ALL_PARAMETERS, &Unobserved)
        .unwrap();
    let off = engine()
        .uncertainty(&WITHOUT_PARAMETERS, &Unobserved)
        .unwrap();
    assert_ne!(all.conditions, off.conditions);
}

#[test]
fn values_by_hand_move_the_models_without_a_fit() {
    let mut study = reference_study(PhysicsCorrection::ByHand);
    let id = DATASET.ids().next().unwrap();
    let analysis = analyze(&mut Engine::default(), &study);
    assert!(applied(&analysis).values.is_empty() && applied(&analysis).findings.is_none());
    assert!(analysis.condition(id).unwrap().moved.is_none());
    decide(&mut study, "Ixx", ParameterDecision::Value(Some(5.0)));
    let analysis = analyze(&mut Engine::default(), &study);
    let [value] = &applied(&analysis).values[..] else {
        panic!("a single value")
    };
    assert!(value.is_by_hand && (value.z - 1.0).abs() < 1e-15);
    // At the parameter change of a run, the moved nominal model has the matrices of that run.
    let condition = DATASET.condition(id).unwrap();
    let run = condition
        .moved_models()
        .iter()
        .find(|moved| moved.run().is_some_and(|run| run.name == "Ixx"))
        .unwrap();
    let moved = &analysis.condition(id).unwrap().condition;
    let nominal = moved.bundle(BundleKind::Physics)[moved.nominal()].state_space();
    let expected = run.model.state_space().unwrap();
    let difference = nominal.unwrap().a() - expected.a();
    assert!(difference.norm() <= 1e-12 * expected.a().norm());
}

#[test]
fn a_value_by_hand_is_held_while_the_others_are_fitted() {
    let mut study = reference_study(PhysicsCorrection::All);
    decide(
        &mut study,
        "swashplate_phase",
        ParameterDecision::Value(Some(0.4)),
    );
    decide(&mut study, "lift_slope", ParameterDecision::On(false));
    let analysis = analyze(&mut Engine::default(), &study);
    let found = applied(&analysis);
    let held = found
        .values
        .iter()
        .find(|value| value.parameter.name == "swashplate_phase")
        .unwrap();
    assert!(held.is_by_hand && (held.change() - 0.4).abs() < 1e-12);
    assert_eq!(held.half_width(), None);
    let findings = found.findings.as_ref().unwrap();
    assert_eq!(findings.parameters.len(), 6);
    assert_eq!(findings.off[0].name, "lift_slope");
    decide(
        &mut study,
        "Ixx",
        ParameterDecision::PlausibleSd(Some(50.0)),
    );
    let wider = analyze(&mut Engine::default(), &study);
    assert_eq!(applied(&wider).values[0].parameter.plausible_sd, 50.0);
}

/// Returns the dataset with the moved models of each condition changed.
fn with_moved(change: impl Fn(&Condition) -> Vec<MovedModel>) -> Arc<Dataset> {
    let mut conditions = Vec::new();
    for condition in DATASET.conditions() {
        let moved = change(condition);
        let condition = Condition::clone(condition);
        conditions.push(condition.with_moved_models(moved).unwrap());
    }
    Arc::new(Dataset::new(DATASET.header(), conditions).unwrap())
}

#[test]
fn a_condition_without_runs_keeps_its_models_with_a_caution() {
    let without = ConditionId(1);
    let dataset = with_moved(|condition| {
        if condition.id() == without {
            Vec::new()
        } else {
            condition.moved_models().to_vec()
        }
    });
    let study = study_of(&dataset, PhysicsCorrection::All);
    let analysis = analyze(&mut Engine::default(), &study);
    let found = applied(&analysis);
    let omitted = &found.findings.as_ref().unwrap().left_out.conditions;
    assert_eq!(omitted.len(), 1);
    assert_eq!(
        (omitted[0].condition, omitted[0].why.code()),
        (without, "condition-without-runs")
    );
    assert!(matches!(
        found.conditions[&without],
        MovedModels::NotMoved(_)
    ));
    let result = analysis.condition(without).unwrap();
    assert!(result.moved.is_none());
    assert_eq!(&result.condition, dataset.condition(without).unwrap());
    let codes: Vec<&str> = result
        .cautions
        .iter()
        .map(|caution| caution.code())
        .collect();
    assert!(codes.contains(&"parameters-not-applied"), "{codes:?}");
    let other = analysis.condition(ConditionId(3)).unwrap();
    assert!(other.moved.is_some());
}

#[test]
fn runs_that_do_not_fit_are_refused_with_reasons() {
    let dataset = with_moved(|condition| {
        let mut moved = condition.moved_models().to_vec();
        // The first run again under another name, and a run that equals the nominal model.
        let mut copy = moved[0].clone();
        copy.model.name = "copy".to_owned();
        moved.push(copy);
        let nominal = &condition.bundle(BundleKind::Physics)[condition.nominal()];
        let model = Model {
            name: "same as nominal".to_owned(),
            ..nominal.clone()
        };
        moved.push(MovedModel {
            model,
            moved: MovedParameters::Run(ParameterChange {
                name: "nothing".to_owned(),
                delta: 1.0,
                unit: "%".to_owned(),
            }),
        });
        moved
    });
    let mut study = study_of(&dataset, PhysicsCorrection::All);
    let analysis = analyze(&mut Engine::default(), &study);
    // A parameter without any usable run keeps every condition out of the fit.
    let failure = analysis.physics.as_ref().unwrap().as_ref().unwrap_err();
    assert_eq!(failure.code(), "physics-without-conditions");
    let left_out = failure.left_out().unwrap();
    assert_eq!(left_out.conditions.len(), 8);
    assert_eq!(left_out.conditions[0].why.code(), "condition-lacks-run");
    decide(&mut study, "nothing", ParameterDecision::On(false));
    let analysis = analyze(&mut Engine::default(), &study);
    let runs = &applied(&analysis).findings.as_ref().unwrap().left_out.runs;
    assert_eq!(runs.len(), 8);
    assert_eq!(runs[0].run.reason.code(), "run-step-repeated");
    let z: Vec<f64> = applied(&analysis)
        .values
        .iter()
        .map(|value| value.z)
        .collect();
    assert_close(&z, &REFERENCE["dataset"]["analysis"]["z"], 1e-6, "z");
}

#[test]
fn requests_without_data_fail_with_a_code_and_keep_the_models() {
    let dataset = with_moved(|_| Vec::new());
    for physics in [PhysicsCorrection::Named, PhysicsCorrection::ByHand] {
        let study = study_of(&dataset, physics);
        let analysis = analyze(&mut Engine::default(), &study);
        assert_eq!(
            analysis.requested_physics().unwrap_err().code(),
            "physics-without-runs"
        );
        let id = dataset.ids().next().unwrap();
        assert_eq!(
            analysis.condition(id).unwrap().correction,
            WITHOUT_PARAMETERS.condition(id).unwrap().correction
        );
    }
    let mut study = reference_study(PhysicsCorrection::All);
    for name in texts(&REFERENCE["dataset"]["analysis"]["names"]) {
        decide(&mut study, name, ParameterDecision::On(false));
    }
    let analysis = analyze(&mut Engine::default(), &study);
    assert_eq!(
        analysis.requested_physics().unwrap_err().code(),
        "physics-all-off"
    );
}

#[test]
fn decisions_about_unknown_parameters_and_bad_values_are_refused() {
    let mut study = reference_study(PhysicsCorrection::All);
    let before = study.clone();
    for (name, decision, code) in [
        ("Iyy", ParameterDecision::On(false), "unknown-parameter"),
        (
            "Ixx",
            ParameterDecision::Value(Some(f64::NAN)),
            "out-of-range",
        ),
        (
            "Ixx",
            ParameterDecision::PlausibleSd(Some(0.0)),
            "out-of-range",
        ),
        (
            "Ixx",
            ParameterDecision::PlausibleSd(Some(f64::INFINITY)),
            "out-of-range",
        ),
    ] {
        let refusal = study
            .apply(&Edit::DecideParameter {
                name: name.to_owned(),
                decision,
            })
            .unwrap_err();
        assert_eq!(refusal.code(), code);
    }
    assert_eq!(study, before);
}

#[test]
fn a_fit_to_three_conditions_names_no_parameter() {
    let mut study = reference_study(PhysicsCorrection::All);
    for condition in DATASET.ids().skip(3) {
        study
            .apply(&Edit::SetHeldOut {
                condition,
                held_out: true,
            })
            .unwrap();
    }
    let analysis = analyze(&mut Engine::default(), &study);
    let findings = applied(&analysis).findings.as_ref().unwrap();
    assert_eq!(findings.diagnosis.verdict, None);
    assert!(findings.named().is_empty());
    assert!(
        findings
            .diagnosed()
            .all(|parameter| parameter.half_width().is_none())
    );
    // Conditions held out are not fitted, but their models are moved.
    let last = DATASET.ids().last().unwrap();
    assert!(analysis.condition(last).unwrap().moved.is_some());
}

#[test]
fn a_rerun_at_the_values_confirms_the_prediction() {
    let changes = vec![
        ParameterChange {
            name: "tail_lift".to_owned(),
            delta: 10.0,
            unit: "%".to_owned(),
        },
        ParameterChange {
            name: "tail_rotor".to_owned(),
            delta: -10.0,
            unit: "%".to_owned(),
        },
    ];
    let mut study = reference_study(PhysicsCorrection::ByHand);
    for change in &changes {
        decide(
            &mut study,
            &change.name,
            ParameterDecision::Value(Some(change.delta)),
        );
    }
    let moved = analyze(&mut Engine::default(), &study);
    let rerun = |condition: &Condition, unit: &str| {
        let result = moved.condition(condition.id()).unwrap();
        let nominal = &result.condition.bundle(BundleKind::Physics)[condition.nominal()];
        let mut changes = changes.clone();
        changes[0].unit = unit.to_owned();
        MovedModel {
            model: Model {
                name: format!("rerun in {unit}"),
                ..nominal.clone()
            },
            moved: MovedParameters::Rerun(changes),
        }
    };
    let dataset = with_moved(|condition| {
        let mut models = condition.moved_models().to_vec();
        models.push(rerun(condition, "%"));
        models.push(rerun(condition, "deg"));
        models
    });
    let job = PhysicsJob {
        study: study_of(&dataset, PhysicsCorrection::Off),
        physics: PhysicsCorrection::ByHand,
    };
    let found = job
        .run(&mut Engine::default(), &Unobserved)
        .unwrap()
        .unwrap()
        .unwrap();
    assert_eq!(found.reruns.len(), 16);
    for check in &found.reruns {
        match &check.outcome {
            Ok(cost) => {
                assert_eq!(cost.verdict(), RerunVerdict::Good);
                assert!(cost.prediction.on_axis.unwrap() < 1e-9);
                assert!(cost.base.on_axis.unwrap() > 1e-3);
            }
            Err(refusal) => assert_eq!(
                (refusal.code(), check.model.as_str()),
                ("rerun-unit-differs", "rerun in deg")
            ),
        }
    }
}

#[test]
fn a_cancelled_job_returns_an_error() {
    struct Stopped;
    impl gdcm_study::Progress for Stopped {
        fn cancelled(&self) -> bool {
            true
        }
        fn advanced(&self, _done: usize, _total: usize) {}
    }
    let job = PhysicsJob {
        study: reference_study(PhysicsCorrection::Off),
        physics: PhysicsCorrection::Named,
    };
    assert!(job.run(&mut Engine::default(), &Stopped).is_err());
}

#[test]
fn couplings_are_fitted_to_the_moved_models() {
    let with = |physics| {
        let mut study = reference_study(physics);
        let couplings = setting_table::COUPLINGS.to(gdcm_study::CouplingCorrection::Mixing);
        study.apply(&couplings).unwrap();
        let analysis = analyze(&mut Engine::default(), &study);
        analysis.fitted_couplings().unwrap().clone()
    };
    assert_ne!(with(PhysicsCorrection::Off), with(PhysicsCorrection::All));
}

#[test]
fn patterns_of_couplings_and_leads_suggest_runs() {
    let path = crate::program_folder().join("tests/data/reference/example-dataset.json.gz");
    let dataset = load_dataset(&path).unwrap().dataset;
    let mut study = Study::new(Arc::clone(&dataset));
    study
        .apply(&setting_table::PHASE.to(PhaseCorrection::Lead))
        .unwrap();
    let mut engine = Engine::with_executor(Box::new(crate::EveryCore));
    let analysis = analyze(&mut engine, &study);
    let couplings = engine
        .assess_couplings(
            &study,
            gdcm_study::CouplingCorrection::MixingAndFeedback,
            &Unobserved,
        )
        .unwrap()
        .unwrap()
        .unwrap();
    let found = suggested_runs(&analysis, Some(&couplings));
    let codes: Vec<&str> = found
        .iter()
        .map(|suggestion| suggestion.pattern.code())
        .collect();
    assert_eq!(codes[0], "crossed-cyclic", "{codes:?}");
    assert_eq!(found[0].parameters[0].name, "swashplate_phase");
    let RunPattern::CrossedCyclic { shares, .. } = found[0].pattern else {
        panic!("the first pattern")
    };
    assert!(shares[0] * shares[1] < 0.0);
    assert!(codes.contains(&"pitch-gain-over-airspeed"), "{codes:?}");
    // Without an assessment of couplings, no pattern of couplings is found.
    for suggestion in suggested_runs(&analysis, None) {
        assert!(!suggestion.pattern.code().starts_with("crossed"));
    }
    let template: Value = json(&run_template(&found));
    let models = list(&template["conditions"][0]["physics_models"]);
    let parameters = list(&template["parameters"]);
    assert_eq!(models.len(), parameters.len());
    for (model, parameter) in models.iter().zip(parameters) {
        assert_eq!(model["parameter"]["name"], parameter["name"]);
        assert_eq!(model["parameter"]["delta"], parameter["plausible_sd"]);
    }
    for suggestion in &found {
        let words = suggestion_text(suggestion, &dataset);
        assert!(!words.contains("cause"), "{words}");
    }
}
