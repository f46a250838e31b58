//! Properties of whole studies.

use std::collections::BTreeSet;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex};

use gdcm_model::dataset::{Condition, Dataset, Model, ModelId};
use gdcm_model::progress::{Cancelled, Progress};
use gdcm_study::ConditionAnalysis;
use gdcm_study::results::analysis::ConditionFailure;
use gdcm_study::stages::condition_curves::ConditionCurves;
use gdcm_study::stages::engine::WantedFirst;
use gdcm_study::stages::known_models::KnownModels;

use super::*;
use crate::EveryCore;

/// Returns a study of the example with few frequencies; the tested properties do not depend on
/// their number.
fn short_study() -> Study {
    let mut study = study_of_example();
    study.apply(&setting_table::POINTS.to(40)).unwrap();
    study
}

#[test]
fn held_responses_have_their_delta_gain_as_net_gain_in_every_condition() {
    let analysis = analyze(&mut Engine::default(), &short_study());
    let mut held = 0;
    for result in analysis
        .conditions
        .values()
        .map(|result| result.as_ref().unwrap())
    {
        assert!(result.gains.matched);
        for pair in result.held().marked() {
            let net = result.correction.net_gain(pair);
            let wanted = result.comparison.delta.gain[pair].unwrap();
            // A response is matched if the logarithm agrees within 1e-8.
            assert!(
                (net / wanted - 1.0).abs() < 1e-8,
                "{pair:?}: {net} for {wanted}"
            );
            held += 1;
        }
    }
    assert_eq!(held, 55, "five responses in each of eleven conditions");
}

#[test]
fn an_engine_that_has_seen_other_settings_gives_the_same_result_as_a_new_one() {
    let mut study = short_study();
    let mut used = Engine::default();
    analyze(&mut used, &study);
    for edit in [
        setting_table::ALPHA_GAIN.to(0.01),
        setting_table::POINTS.to(25),
        setting_table::QUANTILE.to(0.1),
        setting_table::ALPHA_GAIN.to(0.5),
    ] {
        study.apply(&edit).unwrap();
        analyze(&mut used, &study);
    }
    assert_eq!(
        analyze(&mut used, &study),
        analyze(&mut Engine::default(), &study)
    );
}

#[test]
fn holding_another_response_changes_neither_representatives_nor_bounds() {
    let mut study = short_study();
    let mut engine = Engine::default();
    let before = analyze(&mut engine, &study);
    let pair = study.dataset.find_pair("NX", "LON").unwrap();
    study.apply(&Edit::Hold(pair, true)).unwrap();
    let after = analyze(&mut engine, &study);
    let first = ConditionId(1);
    assert_ne!(
        before.condition(first).unwrap().correction,
        after.condition(first).unwrap().correction
    );
    for &id in before.conditions.keys() {
        let before = before.condition(id).unwrap();
        let after = after.condition(id).unwrap();
        assert_eq!(before.comparison, after.comparison);
        assert_eq!(
            (before.gain_bounds(), before.delay_upper_s()),
            (after.gain_bounds(), after.delay_upper_s())
        );
    }
}

#[test]
fn a_condition_left_out_of_the_schedule_is_not_counted_in_it_but_is_still_assessed() {
    let mut study = short_study();
    let mut engine = Engine::default();
    for condition in [ConditionId(1), ConditionId(2)] {
        study
            .apply(&Edit::SetScheduled {
                condition,
                scheduled: false,
            })
            .unwrap();
    }
    let analysis = analyze(&mut engine, &study);
    let schedule = analysis.schedule.as_ref().unwrap();
    assert_eq!(schedule.airspeeds.values_kt.len(), 9);
    assert!(analysis.assessment[&ConditionId(1)].is_ok());
}

#[test]
fn without_scheduled_conditions_the_corrections_have_no_schedule_and_say_why() {
    let mut study = short_study();
    let mut engine = Engine::default();
    for condition in (1..=11).map(ConditionId) {
        study
            .apply(&Edit::SetScheduled {
                condition,
                scheduled: false,
            })
            .unwrap();
    }
    let analysis = analyze(&mut engine, &study);
    let written = corrections(&analysis, "", &BTreeSet::from([ConditionId(1)]));
    assert!(written["schedule"].is_null());
    let Err(error) = &analysis.schedule else {
        panic!("there should be no schedule")
    };
    assert_eq!(error.code(), "no-condition-to-schedule");
    assert_eq!(
        written["assessment"]["left_out"][0]["why"],
        error.to_string()
    );
}

#[test]
fn corrections_of_chosen_conditions_contain_the_schedule_of_all() {
    let analysis = analyze(&mut Engine::default(), &short_study());
    let written = corrections(
        &analysis,
        "hash",
        &BTreeSet::from([10, 3, 400].map(ConditionId)),
    );
    let ids: Vec<f64> = list(&written["conditions"])
        .iter()
        .map(|condition| number(&condition["id"]))
        .collect();
    assert_eq!(
        ids,
        [3.0, 10.0],
        "expected the order of the dataset, without the unknown id 400"
    );
    assert_eq!(
        written["schedule"]["airspeed_range_kt"],
        serde_json::json!([45.0, 140.0])
    );
}

/// Collects the results reported during an analysis, which it cancels after `steps` steps.
struct Observer {
    first: ConditionId,
    steps: usize,
    reported: Mutex<Vec<Result<ConditionAnalysis, ConditionFailure>>>,
    steps_done: AtomicUsize,
}

impl Observer {
    fn new(first: ConditionId, steps: usize) -> Self {
        Self {
            first,
            steps,
            reported: Mutex::default(),
            steps_done: AtomicUsize::new(0),
        }
    }
}

impl Progress for Observer {
    fn cancelled(&self) -> bool {
        self.steps_done.load(Ordering::Relaxed) >= self.steps
    }

    fn advanced(&self, done: usize, total: usize) {
        assert!(done <= total);
        self.steps_done.store(done, Ordering::Relaxed);
    }
}

impl Observer {
    /// Analyses the study, the condition `first` before all others.
    fn analyze(&self, engine: &mut Engine, study: &Study) -> Result<Analysis, Cancelled> {
        let report = |result: &Result<ConditionAnalysis, ConditionFailure>| {
            // At this point only the condition requested first has been analysed, in at most 100 of
            // the steps.
            assert!(self.steps_done.load(Ordering::Relaxed) <= 100);
            self.reported.lock().unwrap().push(result.clone());
        };
        engine.analyze_first(
            study,
            Some(WantedFirst {
                condition: self.first,
                tell: &report,
            }),
            self,
        )
    }
}

#[test]
fn results_have_the_same_bits_for_every_number_of_threads() {
    let study = short_study();
    let alone = analyze(&mut Engine::default(), &study);
    for threads in [1, 2, 3, 7] {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap();
        let together =
            pool.install(|| analyze(&mut Engine::with_executor(Box::new(EveryCore)), &study));
        // The debug output contains the shortest digits that identify the bits, and distinguishes
        // -0 from 0.
        assert!(
            format!("{together:?}") == format!("{alone:?}"),
            "{threads} threads"
        );
    }
}

#[test]
fn the_condition_wanted_first_is_reported_once_with_its_final_result() {
    let study = short_study();
    let observer = Observer::new(ConditionId(10), usize::MAX);
    let analysis = observer
        .analyze(&mut Engine::with_executor(Box::new(EveryCore)), &study)
        .unwrap();
    assert_eq!(
        observer.reported.into_inner().unwrap(),
        [analysis.conditions[&ConditionId(10)].clone()]
    );
    let alone = analyze(&mut Engine::default(), &study);
    assert_eq!(
        analysis.conditions, alone.conditions,
        "the condition analysed first should not change the results"
    );
}

#[test]
fn an_engine_whose_analyses_were_cancelled_gives_the_same_result_as_a_new_one() {
    let study = short_study();
    let mut engine = Engine::default();
    for steps in [1, 100, 400] {
        assert_eq!(
            Observer::new(ConditionId(1), steps).analyze(&mut engine, &study),
            Err(Cancelled)
        );
    }
    assert_eq!(
        analyze(&mut engine, &study),
        analyze(&mut Engine::default(), &study)
    );
}

/// Returns the example with its conditions, and the models of each, in reverse order.
fn reversed(dataset: &Dataset) -> Dataset {
    let conditions = dataset.conditions().iter().rev().map(|condition| {
        let bundle = |kind| condition.bundle(kind).iter().rev().cloned().collect();
        let physics = bundle(BundleKind::Physics);
        let identified = bundle(BundleKind::Identified);
        Condition::new(condition.flight_state().clone(), physics, identified).unwrap()
    });
    Dataset::new(dataset.header(), conditions.collect()).unwrap()
}

#[test]
fn the_order_of_conditions_and_models_changes_no_decision_and_no_result() {
    let mut study = short_study();
    let mut engine = Engine::default();
    let tenth = |kind, name: &str| ModelId::new(ConditionId(10), kind, name);
    for edit in [
        Edit::Reject(tenth(BundleKind::Physics, "nominal")),
        Edit::Pin(tenth(BundleKind::Physics, "V+5kt")),
        Edit::SetScheduled {
            condition: ConditionId(2),
            scheduled: false,
        },
    ] {
        study.apply(&edit).unwrap();
    }
    let (carried, differences) = study.reconciled(Arc::new(reversed(&study.dataset)));
    assert_eq!(differences, []);
    assert_eq!(
        (&carried.choices, &carried.settings),
        (&study.choices, &study.settings)
    );
    let before = analyze(&mut engine, &study);
    let after = analyze(&mut engine, &carried);
    for (id, result) in &before.conditions {
        let before = result.as_ref().unwrap();
        let after = after.condition(*id).unwrap();
        for kind in BundleKind::BOTH {
            assert_eq!(
                before.representative_name(kind),
                after.representative_name(kind),
                "condition {id}"
            );
        }
        assert_eq!(before.correction, after.correction, "condition {id}");
    }
}

#[test]
fn engines_that_share_known_models_compute_each_response_once() {
    let study = short_study();
    let known = KnownModels::default();
    let curves = |mut engine: Engine| {
        let grid = (study.settings.band, 50);
        let curves = engine
            .curves(&study.dataset, ConditionId(3), grid, &Unobserved)
            .unwrap()
            .unwrap();
        (engine, curves)
    };
    let (first, before) = curves(Engine::default().sharing(&known));
    let (second, after) = curves(Engine::default().sharing(&known));
    let (_, apart) = curves(Engine::default());
    let share_responses = |a: &ConditionCurves, b: &ConditionCurves| {
        a.physics
            .iter()
            .chain(&a.identified)
            .zip(b.physics.iter().chain(&b.identified))
            .all(|(a, b)| Arc::ptr_eq(a, b))
    };
    assert!(share_responses(&before, &after));
    assert!(!share_responses(&before, &apart));
    assert_eq!(
        (&before.physics, &before.identified),
        (&apart.physics, &apart.identified)
    );
    drop((first, second));
    let (_, recomputed) = curves(Engine::default().sharing(&known));
    assert!(
        !share_responses(&before, &recomputed),
        "responses that no engine uses should not be kept"
    );
}

#[test]
fn after_one_model_is_replaced_only_its_response_is_computed_again() {
    let study = short_study();
    let mut engine = Engine::default();
    let band = study.settings.band;
    let id = ConditionId(3);
    let mut curves = |study: &Study| {
        engine
            .curves(&study.dataset, id, (band, 50), &Unobserved)
            .unwrap()
            .unwrap()
    };
    let before = curves(&study);
    let conditions = study.dataset.conditions().iter().map(|condition| {
        let bundle = |kind| condition.bundle(kind).to_vec();
        let mut physics: Vec<Model> = bundle(BundleKind::Physics);
        if condition.id() == id
            && let Dynamics::StateSpace(model) = &physics[4].dynamics
        {
            let a = model.a().clone();
            let b = 1.5 * model.b();
            let c = model.c().clone();
            let d = model.d().clone();
            physics[4].dynamics = Dynamics::StateSpace(StateSpace::new(a, b, c, d).unwrap());
        }
        Condition::new(
            condition.flight_state().clone(),
            physics,
            bundle(BundleKind::Identified),
        )
        .unwrap()
    });
    let replaced = Dataset::new(study.dataset.header(), conditions.collect()).unwrap();
    let (carried, differences) = study.reconciled(Arc::new(replaced));
    assert_eq!(differences.len(), 1);
    let after = curves(&carried);
    let kept: Vec<bool> = before
        .physics
        .iter()
        .zip(&after.physics)
        .map(|(a, b)| Arc::ptr_eq(a, b))
        .collect();
    let expected: Vec<bool> = (0..kept.len()).map(|index| index != 4).collect();
    assert_eq!(
        kept, expected,
        "only the response of the replaced model should be computed again"
    );
    assert!(
        before
            .identified
            .iter()
            .zip(&after.identified)
            .all(|(a, b)| Arc::ptr_eq(a, b))
    );
}
