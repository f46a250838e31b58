//! Properties of whole studies.

use super::*;

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
            let (net, wanted) = (result.correction.net_gain(pair), result.comparison.delta.gain[pair].unwrap());
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
