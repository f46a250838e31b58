//! Properties of whole studies.

use super::*;
use gdcm::app::Pool;
use gdcm::study::{ConditionAnalysis, ConditionFailure, Stopped, Watch};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

/// A study of the example on few frequencies: what these tests ask does not depend on how many.
fn short_study() -> Study {
    let mut study = study_of_example();
    study.apply(&Edit::Set(Setting::Points(40))).unwrap();
    study
}

#[test]
fn held_responses_have_their_delta_gain_as_net_gain_in_every_condition() {
    let analysis = analyze(&mut Engine::default(), &short_study());
    let mut held = 0;
    for result in analysis.conditions.iter().map(|result| result.as_ref().unwrap()) {
        assert!(result.gains.matched);
        for pair in result.held().marked() {
            let (net, wanted) = (result.correction.net_gain(pair).value(), result.comparison.delta.gain[pair].unwrap());
            // Matched means within 1e-8 of the logarithm.
            assert!((net / wanted - 1.0).abs() < 1e-8, "{pair:?}: {net} for {wanted}");
            held += 1;
        }
    }
    assert_eq!(held, 55, "five responses in each of eleven conditions");
}

#[test]
fn an_engine_that_has_seen_other_settings_gives_the_same_result_as_a_new_one() {
    let (mut study, mut used) = (short_study(), Engine::default());
    analyze(&mut used, &study);
    for setting in [Setting::AlphaGain(0.01), Setting::Points(25), Setting::Quantile(0.1), Setting::AlphaGain(0.5)] {
        study.apply(&Edit::Set(setting)).unwrap();
        analyze(&mut used, &study);
    }
    assert_eq!(analyze(&mut used, &study), analyze(&mut Engine::default(), &study));
}

#[test]
fn holding_another_response_changes_neither_representatives_nor_bounds() {
    let (mut study, mut engine) = (short_study(), Engine::default());
    let before = analyze(&mut engine, &study);
    let pair = study.dataset.find_pair("NX", "LON").unwrap();
    study.apply(&Edit::Set(Setting::Constrained(pair, true))).unwrap();
    let after = analyze(&mut engine, &study);
    assert_ne!(before.condition(0).unwrap().correction, after.condition(0).unwrap().correction);
    for index in 0..before.conditions.len() {
        let (before, after) = (before.condition(index).unwrap(), after.condition(index).unwrap());
        assert_eq!(before.comparison, after.comparison);
        assert_eq!((before.gain_bounds(), before.delay_upper_s()), (after.gain_bounds(), after.delay_upper_s()));
    }
}

#[test]
fn a_condition_left_out_of_the_schedule_is_not_counted_in_it_but_is_still_assessed() {
    let (mut study, mut engine) = (short_study(), Engine::default());
    for condition in [0, 1] {
        study.apply(&Edit::SetScheduled { condition, scheduled: false }).unwrap();
    }
    let analysis = analyze(&mut engine, &study);
    let schedule = analysis.schedule.as_ref().unwrap();
    assert_eq!(schedule.airspeeds.values_kt.len(), 9);
    assert!(matches!(analysis.assessment[0], Assessed::Nominal(_)));
}

#[test]
fn every_condition_out_of_the_schedule_leaves_corrections_without_one() {
    let (mut study, mut engine) = (short_study(), Engine::default());
    for condition in 0..11 {
        study.apply(&Edit::SetScheduled { condition, scheduled: false }).unwrap();
    }
    let analysis = analyze(&mut engine, &study);
    let written = Corrections::of(&analysis, "", &[0]);
    assert!(written.schedule.is_none());
    assert_eq!(written.assessment.left_out[0].why, "no schedule: no condition that could be solved is chosen for it");
}

#[test]
fn corrections_of_chosen_conditions_hold_those_and_the_schedule_of_all() {
    let analysis = analyze(&mut Engine::default(), &short_study());
    let written = Corrections::of(&analysis, "hash", &[9, 2, 400]);
    let ids: Vec<i64> = written.conditions.iter().map(|condition| condition.id).collect();
    assert_eq!(ids, [10, 3], "in the order chosen, and an index that is not there passed over");
    assert_eq!(written.schedule.unwrap().airspeed_range_kt, [45.0, 140.0]);
}

/// Keeps the first result, and ends the analysis after so many steps.
struct Onlooker {
    first: usize,
    steps: usize,
    seen: Mutex<Vec<Result<ConditionAnalysis, ConditionFailure>>>,
    heard: AtomicUsize,
}

impl Onlooker {
    fn new(first: usize, steps: usize) -> Self {
        Self { first, steps, seen: Mutex::default(), heard: AtomicUsize::new(0) }
    }
}

impl Watch for Onlooker {
    fn stopped(&self) -> bool {
        self.heard.load(Ordering::Relaxed) >= self.steps
    }

    fn progress(&self, done: usize, total: usize) {
        assert!(done <= total);
        self.heard.store(done, Ordering::Relaxed);
    }

    fn wanted_first(&self) -> Option<usize> {
        Some(self.first)
    }

    fn first_result(&self, result: &Result<ConditionAnalysis, ConditionFailure>) {
        // Nothing but the condition wanted first is done by then.
        assert!(self.heard.load(Ordering::Relaxed) <= 100);
        self.seen.lock().unwrap().push(result.clone());
    }
}

#[test]
fn results_have_the_same_bits_whatever_the_number_of_threads() {
    let study = short_study();
    let alone = analyze(&mut Engine::default(), &study);
    for threads in [1, 2, 3, 7] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let together = pool.install(|| analyze(&mut Engine::with_crew(Box::new(Pool)), &study));
        // Debug prints the shortest text that reads back as the same bits, and tells -0 from 0.
        assert!(format!("{together:?}") == format!("{alone:?}"), "{threads} threads");
    }
}

#[test]
fn the_condition_wanted_first_is_told_first_and_as_the_whole_analysis_has_it() {
    let (study, onlooker) = (short_study(), Onlooker::new(9, usize::MAX));
    let analysis = Engine::with_crew(Box::new(Pool)).analyze(&study, &onlooker).unwrap();
    assert_eq!(onlooker.seen.into_inner().unwrap(), [analysis.conditions[9].clone()]);
    let alone = analyze(&mut Engine::default(), &study);
    assert_eq!(analysis.conditions, alone.conditions, "the order of work is not the order of results");
}

#[test]
fn an_analysis_that_is_stopped_halfway_goes_on_from_there_with_the_same_result() {
    let (study, mut engine) = (short_study(), Engine::default());
    for steps in [1, 100, 400] {
        assert_eq!(engine.analyze(&study, &Onlooker::new(0, steps)), Err(Stopped));
    }
    assert_eq!(analyze(&mut engine, &study), analyze(&mut Engine::default(), &study));
}
