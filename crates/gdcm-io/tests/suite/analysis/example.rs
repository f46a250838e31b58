//! Results for the example dataset, compared with an independent implementation of the method.

use std::collections::BTreeSet;

use gdcm_study::ConditionAnalysis;

use super::*;

/// Results of the independent implementation, with its suggested outliers rejected.
const REFERENCE: &str = include_str!("../../../../../tests/data/reference/example-analysis.json");

#[track_caller]
fn assert_table_close<T>(
    quantity: &str,
    found: &PairTable<Option<T>>,
    figure: impl Fn(&T) -> f64,
    reference: &Value,
    scale: f64,
) {
    for (pair, found) in found.iter() {
        let reference = number(&reference[pair.output][pair.input]);
        assert_close(
            &format!("{quantity} of {pair:?}"),
            figure(found.as_ref().unwrap()),
            reference,
            scale,
        );
    }
}

/// Calls `check(name, result, reference)` for each of the eleven conditions.
fn each_condition(mut check: impl FnMut(&str, &ConditionAnalysis, &Value)) {
    let analysis = &*EXAMPLE_WITH_SUGGESTIONS_REJECTED;
    let reference = json(REFERENCE);
    let conditions = analysis.study.dataset.conditions();
    assert_eq!(
        (conditions.len(), list(&reference["conditions"]).len()),
        (11, 11)
    );
    for (condition, expected) in conditions.iter().zip(list(&reference["conditions"])) {
        let id = condition.id();
        assert_eq!(id.0, expected["id"].as_i64().unwrap());
        check(
            &format!("condition {id}"),
            analysis.condition(id).unwrap(),
            expected,
        );
    }
}

#[test]
fn representatives_and_suggested_outliers_of_the_example_agree_exactly() {
    each_condition(|at, found, expected| {
        assert_eq!(
            found.representative_name(BundleKind::Physics),
            expected["physics"],
            "{at}"
        );
        assert_eq!(
            found.representative_name(BundleKind::Identified),
            expected["identified"],
            "{at}"
        );
        assert_eq!(found.suggested(), texts(&expected["outliers"]), "{at}");
    });
}

#[test]
fn scores_and_discontinuity_ratios_of_the_example_agree() {
    each_condition(|at, found, expected| {
        // Rejected models have no score, neither in the program nor in the reference.
        let scores: Vec<f64> = found
            .comparison
            .physics
            .scores
            .iter()
            .copied()
            .flatten()
            .collect();
        assert_all_close(
            &format!("{at}, scores"),
            &scores,
            &expected["scores"],
            scale::COST,
        );
        let ratios = &found.bundle_metrics.discontinuity.as_ref().unwrap().ratios;
        let ratios: Vec<f64> = ratios.iter().map(|ratio| ratio.unwrap()).collect();
        assert_all_close(
            &format!("{at}, ratios"),
            &ratios,
            &expected["discontinuity"],
            scale::GAIN,
        );
    });
}

#[test]
fn delta_gains_delta_delays_and_bounds_of_the_example_agree() {
    each_condition(|at, found, expected| {
        let delta = &found.comparison.delta;
        assert_table_close(
            &format!("{at}, G"),
            &delta.gain,
            |gain| *gain,
            &expected["G"],
            scale::GAIN,
        );
        assert_table_close(
            &format!("{at}, D"),
            &delta.delay_s,
            |delay| *delay,
            &expected["D"],
            scale::DELAY_S,
        );
        let lower = found.gain_bounds().lower;
        let upper = found.gain_bounds().upper;
        assert_close(
            &format!("{at}, lower bound"),
            lower,
            number(&expected["lb"]),
            scale::GAIN,
        );
        assert_close(
            &format!("{at}, upper bound"),
            upper,
            number(&expected["ub"]),
            scale::GAIN,
        );
        let delay = found.delay_upper_s();
        let expected = number(&expected["tau_ub"]);
        assert_close(
            &format!("{at}, delay bound"),
            delay,
            expected,
            scale::DELAY_S,
        );
    });
}

#[test]
fn channel_gains_of_the_example_agree() {
    each_condition(|at, found, expected| {
        let correction = &found.correction;
        let gains = &found.gains;
        assert_all_close(
            &format!("{at}, k_in"),
            &correction.input_gains,
            &expected["k_in"],
            scale::GAIN,
        );
        assert_all_close(
            &format!("{at}, k_out"),
            &correction.output_gains,
            &expected["k_out"],
            scale::GAIN,
        );
        assert_close(
            &format!("{at}, objective"),
            gains.objective,
            number(&expected["gain_objective"]),
            scale::GAIN,
        );
        assert_eq!(
            gains.matched,
            expected["gain_matched"].as_bool().unwrap(),
            "{at}"
        );
    });
}

#[test]
fn channel_delays_of_the_example_agree() {
    each_condition(|at, found, expected| {
        let correction = &found.correction;
        let delays = &found.delays;
        assert_all_close(
            &format!("{at}, tau_in"),
            &correction.input_delays_s,
            &expected["tau_in"],
            scale::DELAY_S,
        );
        assert_all_close(
            &format!("{at}, tau_out"),
            &correction.output_delays_s,
            &expected["tau_out"],
            scale::DELAY_S,
        );
        let objective = number(&expected["delay_objective"]);
        assert_close(
            &format!("{at}, objective"),
            delays.objective,
            objective,
            scale::DELAY_OBJECTIVE,
        );
        assert_eq!(
            delays.matched,
            expected["delay_matched"].as_bool().unwrap(),
            "{at}"
        );
    });
}

#[test]
fn costs_of_the_example_agree_before_and_after_the_correction() {
    each_condition(|at, found, expected| {
        let [magnitude, phase] = [&expected["J_mag"], &expected["J_phase"]];
        let cost = &*found.cost;
        assert_table_close(
            at,
            cost,
            |cost| cost.uncorrected.magnitude,
            &magnitude[0],
            scale::COST,
        );
        assert_table_close(
            at,
            cost,
            |cost| cost.corrected.magnitude,
            &magnitude[1],
            scale::COST,
        );
        assert_table_close(
            at,
            cost,
            |cost| cost.uncorrected.phase,
            &phase[0],
            scale::COST,
        );
        assert_table_close(
            at,
            cost,
            |cost| cost.corrected.phase,
            &phase[1],
            scale::COST,
        );
    });
}

#[test]
fn the_schedule_of_the_example_agrees() {
    let expected = &json(REFERENCE)["schedule"];
    let schedule =
        &corrections(&EXAMPLE_WITH_SUGGESTIONS_REJECTED, "", &BTreeSet::new())["schedule"];
    assert_eq!(
        (&schedule["degree"], &schedule["of"]),
        (&2.into(), &"ln k".into())
    );
    let mean = &expected["airspeed_mean_kt"];
    let half_range = &expected["airspeed_half_range_kt"];
    assert_close(
        "mean",
        number(&schedule["airspeed_mean_kt"]),
        number(mean),
        scale::AIRSPEED_KT,
    );
    assert_close(
        "half range",
        number(&schedule["airspeed_half_range_kt"]),
        number(half_range),
        scale::AIRSPEED_KT,
    );
    for (found, expected) in [
        (&schedule["inputs"], &expected["in"]),
        (&schedule["outputs"], &expected["out"]),
    ] {
        let found = found.as_object().unwrap();
        assert_eq!(found.len(), list(expected).len());
        for ((name, coefficients), expected) in found.iter().zip(list(expected)) {
            assert_all_close(
                &format!("schedule of {name}"),
                &numbers(coefficients),
                expected,
                scale::GAIN,
            );
        }
    }
}

#[test]
fn the_assessment_of_the_example_agrees_and_leaves_condition_10_out() {
    let analysis = &*EXAMPLE_WITH_SUGGESTIONS_REJECTED;
    let reference = json(REFERENCE);
    let schedule = analysis.schedule.as_ref().unwrap();
    let expected = list(&reference["assessment"]);
    assert_eq!((analysis.assessment.len(), expected.len()), (11, 11));
    let mut left_out = Vec::new();
    for (condition, expected) in analysis.study.dataset.conditions().iter().zip(expected) {
        let found = &analysis.assessment[&condition.id()];
        assert_eq!(found.is_err(), expected["left_out"].as_bool().unwrap());
        let Ok(changes) = found else {
            left_out.push(condition.id());
            continue;
        };
        let scheduled = schedule.at(condition.flight_state().airspeed_kt);
        assert_all_close(
            "scheduled k_in",
            &scheduled.input_gains,
            &expected["k_in"],
            scale::GAIN,
        );
        assert_all_close(
            "scheduled k_out",
            &scheduled.output_gains,
            &expected["k_out"],
            scale::GAIN,
        );
        assert_table_close(
            "dJ_mag",
            changes,
            |change| change.magnitude(),
            &expected["dJ_mag"],
            scale::COST,
        );
        assert_table_close(
            "dJ_phase",
            changes,
            |change| change.phase(),
            &expected["dJ_phase"],
            scale::COST,
        );
    }
    assert_eq!(left_out, [ConditionId(10)]);
}

/// Returns the keys of an object in alphabetical order.
fn keys(value: &Value) -> Vec<&str> {
    let mut keys: Vec<&str> = value
        .as_object()
        .unwrap()
        .keys()
        .map(String::as_str)
        .collect();
    keys.sort_unstable();
    keys
}

#[test]
fn the_corrections_file_of_the_example_keeps_its_fields() {
    let analysis = &*EXAMPLE_WITH_SUGGESTIONS_REJECTED;
    let value = corrections(analysis, "", &analysis.conditions.keys().copied().collect());
    let mut settings = keys(&value["settings"]);
    // Fields that were added after the first version of the format.
    let later = [
        "agreement_db",
        "delay_from",
        "error_bars",
        "gain_from",
        "phase",
        "schedule_delays",
    ];
    settings.retain(|key| !later.contains(key));
    assert_eq!(
        settings,
        [
            "alpha_delay",
            "alpha_gain",
            "band_rad_s",
            "constrained",
            "cost_average",
            "delay_upper_s",
            "gain_bounds",
            "gain_objective",
            "ignored",
            "points",
            "quantile",
            "schedule",
        ]
    );
    // Largest mismatch \[dB\] around a loop of constrained gains that counts as consistent.
    assert_eq!(number(&value["settings"]["agreement_db"]), 0.05);
    assert_eq!(
        keys(&value["conditions"][0]),
        [
            "D_band_s",
            "D_s",
            "G",
            "J",
            "airspeed_kt",
            "cautions",
            "delay_solution",
            "delay_upper_s",
            "delays_s",
            "discontinuity",
            "gain_bounds",
            "gain_solution",
            "gains",
            "held",
            "id",
            "identified_representative",
            "name",
            "net_gains",
            "physics_representative",
            "rejected",
            "scheduled",
            "set_aside",
            "suggested_outliers",
        ],
        "rejected models have no reasons, so that the field for reasons is absent"
    );
    assert_eq!(
        keys(&value["schedule"]["table"][0]),
        ["airspeed_kt", "inputs", "outputs"]
    );
    assert!(value["schedule"]["delays_s"].is_null());
    assert_eq!(
        keys(&value["conditions"][0]["gain_solution"]["explanation"]),
        ["conflicts", "remedy", "sensitivities"]
    );
}
