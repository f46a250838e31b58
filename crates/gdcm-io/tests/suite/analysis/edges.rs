//! Incomplete and extreme data: which responses are compared, which are not, and that the reasons
//! are stated.

use std::collections::BTreeSet;
use std::path::PathBuf;
use std::sync::Arc;

use serde_json::json;

use gdcm_io::{DatasetOrigin, load_dataset_bytes};
use gdcm_method::correction::{Channel, ChannelCorrection};
use gdcm_method::schedule::{DelayScheduling, ScheduleCaution, ScheduleKind};
use gdcm_model::dataset::{BundleKind, Dataset, ModelId};
use gdcm_study::results::analysis::ConditionFailure;
use gdcm_study::results::caution::{BundleModel, Caution, GainOutOfRange, NotFinite, Undefined};
use gdcm_study::stages::model_cautions::cautions_of_models;
use gdcm_study::{ConditionAnalysis, Execution};
use gdcm_words::caution::caution_text;
use gdcm_words::derivation::{ExplainTarget, derivation};

use super::*;
use crate::synthetic::two_lags;

/// Id of the only condition, or of the first in [`NEAR_AIRSPEEDS`].
const CONDITION: ConditionId = ConditionId(1);

/// Six physics models, four identified models, and a response measured up to 11.9 rad/s only; the
/// band ends at 12 rad/s.
const SHORT_MEASUREMENT: &str =
    include_str!("../../../../../tests/data/edges/short-measurement.json");
/// Six outputs and four inputs, with gains that channel gains cannot explain.
const SIX_BY_FOUR: &str = include_str!("../../../../../tests/data/edges/six-by-four.json");
/// Three conditions at 60, 60.000001 and 120 kt.
const NEAR_AIRSPEEDS: &str = include_str!("../../../../../tests/data/edges/near-airspeeds.json");

fn dataset(value: &Value) -> Arc<Dataset> {
    load_dataset_bytes(
        value.to_string().as_bytes(),
        DatasetOrigin::File(PathBuf::from("edge.json")),
    )
    .unwrap()
    .dataset
}

/// Returns the analysis of a file after some edits.
fn analysis_of(value: &Value, edits: &[Edit]) -> Analysis {
    let mut study = Study::new(dataset(value));
    for edit in edits {
        study.apply(edit).unwrap();
    }
    analyze(&mut Engine::default(), &study)
}

fn caution_texts(analysis: &Analysis, result: &ConditionAnalysis) -> Vec<String> {
    let name = |pair| analysis.study.dataset.pair_name(pair);
    result
        .cautions
        .iter()
        .map(|caution| caution_text(caution, name))
        .collect()
}

/// Returns the file with the measurement that ends at 11.9 rad/s moved to index `place` among the
/// identified models; `None` removes it.
fn with_short_measurement(place: Option<usize>) -> Value {
    let mut value = json(SHORT_MEASUREMENT);
    let models = value["conditions"][0]["identified_models"]
        .as_array_mut()
        .unwrap();
    let short = models.pop().unwrap();
    assert!(short["frequency_response"].is_object());
    if let Some(place) = place {
        models.insert(place, short);
    }
    value
}

#[test]
fn a_measurement_that_ends_just_below_the_band_edge_does_not_affect_other_models() {
    let without = analysis_of(&with_short_measurement(None), &[]);
    let expected = without.condition(CONDITION).unwrap();
    for place in [0, 2, 4] {
        let analysis = analysis_of(&with_short_measurement(Some(place)), &[]);
        let found = analysis.condition(CONDITION).unwrap();
        assert_eq!(
            found.comparison.delta, expected.comparison.delta,
            "place {place}"
        );
        assert_eq!(found.correction, expected.correction);
        let kind = BundleKind::Identified;
        assert_eq!(
            found.representative_name(kind),
            expected.representative_name(kind)
        );
        assert_eq!(found.score(kind, "i4"), None);
        assert_eq!(
            found.comparison.identified.scores.iter().flatten().count(),
            4
        );
    }
}

#[test]
fn a_model_set_aside_is_reported_with_the_responses_it_lacks_and_its_pin_is_ignored() {
    let short = ModelId::new(CONDITION, BundleKind::Identified, "i4");
    let value = with_short_measurement(Some(4));
    let unpinned = analysis_of(&value, &[]);
    let pinned = analysis_of(&value, &[Edit::Pin(short)]);
    let found = pinned.condition(CONDITION).unwrap();
    assert_eq!(
        found.comparison.delta,
        unpinned.condition(CONDITION).unwrap().comparison.delta
    );
    let caution = caution_texts(&pinned, found).concat();
    let [
        Caution::SetAside {
            model,
            lacks,
            why: Some(NotFinite::Measured { max, .. }),
            pinned: true,
            ..
        },
    ] = found.cautions.as_slice()
    else {
        panic!("{:?}", found.cautions)
    };
    assert_eq!(
        (model.bundle, model.name.as_str()),
        (BundleKind::Identified, "i4")
    );
    assert_eq!(*lacks, [Pair::new(0, 0), Pair::new(1, 1)]);
    assert!((max - 11.9).abs() < 0.05, "{max}");
    let set_aside = |analysis| {
        corrections(analysis, "", &BTreeSet::from([CONDITION]))["conditions"][0]["set_aside"]
            .clone()
    };
    assert_eq!(
        set_aside(&pinned),
        serde_json::json!([{"model": "i4", "why": caution}])
    );
    assert_eq!(
        set_aside(&analysis_of(&with_short_measurement(None), &[])),
        serde_json::json!([])
    );
}

#[test]
fn a_condition_fails_if_every_kept_model_of_a_bundle_is_set_aside() {
    let reject = |name| Edit::Reject(ModelId::new(CONDITION, BundleKind::Identified, name));
    let analysis = analysis_of(
        &with_short_measurement(Some(4)),
        &["i0", "i1", "i2", "i3"].map(reject),
    );
    assert_eq!(
        analysis.conditions[&CONDITION],
        Err(ConditionFailure::AllSetAside {
            bundle: BundleKind::Identified
        })
    );
}

#[test]
fn a_physics_model_that_lacks_an_on_axis_response_is_set_aside() {
    let mut value = with_short_measurement(None);
    let model = &mut value["conditions"][0]["physics_models"][3];
    // Every response of output 0 becomes zero.
    for key in ["C", "D"] {
        for entry in model[key][0].as_array_mut().unwrap() {
            *entry = json!(0.0);
        }
    }
    let name = model["name"].as_str().unwrap().to_owned();
    let analysis = analysis_of(&value, &[]);
    let found = analysis.condition(CONDITION).unwrap();
    assert!(
        found
            .cautions
            .iter()
            .any(|caution| caution.is_set_aside(BundleKind::Physics, &name))
    );
    let ratios = &found.bundle_metrics.discontinuity.as_ref().unwrap().ratios;
    assert!(ratios[3].is_none() && ratios[0].is_some());
    let models = found.condition.bundle(BundleKind::Physics);
    let first = ModelId::new(CONDITION, BundleKind::Physics, &models[0].name);
    let explained = derivation(&analysis, &ExplainTarget::DiscontinuityRatio(first)).unwrap();
    let compared = models.len() - 1;
    assert_eq!(
        explained.rests_on[0],
        format!("all {compared} physics models that are not set aside, including rejected models")
    );
    value["conditions"][0]["physics_models"]
        .as_array_mut()
        .unwrap()
        .remove(3);
    let mut without = found
        .bundle_metrics
        .discontinuity
        .as_ref()
        .unwrap()
        .ratios
        .clone();
    without.remove(3);
    assert_eq!(
        analysis_of(&value, &[])
            .condition(CONDITION)
            .unwrap()
            .bundle_metrics
            .discontinuity
            .as_ref()
            .unwrap()
            .ratios,
        without
    );
}

/// Returns a matrix of `two_lags` from its diagonal and the entries above and below it.
fn with_couplings([first, second]: [f64; 2], [upper, lower]: [f64; 2]) -> [[f64; 2]; 2] {
    [[first, upper], [lower, second]]
}

#[test]
fn residues_of_numerical_linearisation_count_as_zero_and_are_reported() {
    let zeros = analysis_of(
        &two_lags([[1.0, 0.0], [0.0, 1.0]], [[1.2, 0.0], [0.0, 0.9]]),
        &[],
    );
    // Off-axis gains that are residues in the physics model, in the identified model, and in both.
    for (physics, identified) in [
        ([1e-17, 1e-9], [1e-3, 0.5]),
        ([0.1, 0.1], [1e-17, 3e-8]),
        ([1e-17, 1e-16], [0.0, 1e-13]),
    ] {
        let value = two_lags(
            with_couplings([1.0, 1.0], physics),
            with_couplings([1.2, 0.9], identified),
        );
        let analysis = analysis_of(&value, &[]);
        let found = analysis.condition(CONDITION).unwrap();
        assert_eq!(
            found.comparison.delta,
            zeros.condition(CONDITION).unwrap().comparison.delta
        );
        assert_eq!(
            found.correction,
            zeros.condition(CONDITION).unwrap().correction
        );
        let named = caution_texts(&analysis, found).concat();
        assert!(
            found.cautions.iter().any(|caution| matches!(
                caution,
                Caution::NumericallyZero { responses, .. }
                    if *responses == [Pair::new(0, 1), Pair::new(1, 0)]
            )),
            "{:?}",
            found.cautions
        );
        let written = corrections(&analysis, "", &BTreeSet::from([CONDITION]));
        assert_eq!(texts(&written["conditions"][0]["cautions"]).concat(), named);
    }
}

#[test]
fn a_numerically_zero_response_is_not_held_and_the_reason_is_reported() {
    let value = two_lags([[1.0, 1e-17], [0.0, 1.0]], [[1.2, 0.1], [0.0, 0.9]]);
    let pair = Pair::new(0, 1);
    let analysis = analysis_of(&value, &[Edit::Hold(pair, true)]);
    let found = analysis.condition(CONDITION).unwrap();
    assert!(!found.held()[pair]);
    let why = Undefined::NumericallyZero(BundleKind::Physics);
    assert!(
        found
            .cautions
            .contains(&Caution::HeldButUndefined { pair, why })
    );
    assert_eq!(found.comparison.undefined[pair], Some(why));
    assert_eq!(
        found.comparison.undefined[Pair::new(1, 0)],
        Some(Undefined::Zero(BundleKind::Physics))
    );
}

#[test]
fn an_unusual_gain_is_fitted_with_a_caution_until_its_response_is_ignored() {
    // The off-axis gain of the identified model is 20 times that of the physics model.
    let value = two_lags([[1.0, 0.01], [0.0, 1.0]], [[1.2, 0.2], [0.0, 0.9]]);
    let pair = Pair::new(0, 1);
    let analysis = analysis_of(&value, &[]);
    let found = analysis.condition(CONDITION).unwrap();
    assert!((found.comparison.delta.gain[pair].unwrap() - 20.0).abs() < 1e-9);
    let offered: Vec<Pair> = found
        .cautions
        .iter()
        .filter_map(Caution::offers_to_ignore)
        .collect();
    assert_eq!(offered, [pair]);
    let is_reported = found.cautions.iter().any(|caution| {
        matches!(caution, Caution::UnusualGain { gain, .. } if (gain - 20.0).abs() < 1e-9)
    });
    assert!(is_reported, "{:?}", found.cautions);
    let ignored = analysis_of(&value, &[Edit::Fit(pair, false)]);
    assert_eq!(
        ignored
            .condition(CONDITION)
            .unwrap()
            .cautions
            .iter()
            .filter_map(Caution::offers_to_ignore)
            .count(),
        0
    );
}

#[test]
fn an_extreme_gain_ratio_leaves_out_its_own_response_only() {
    let value = two_lags([[1.0, 1e-3], [1e-3, 1e-60]], [[1.2, 1e-3], [1e-3, 0.9]]);
    let analysis = analysis_of(&value, &[]);
    let found = analysis.condition(CONDITION).unwrap();
    let gain = &found.comparison.delta.gain;
    assert_eq!(
        (gain[Pair::new(1, 1)], gain[Pair::new(0, 0)].is_some()),
        (None, true)
    );
    assert_eq!(
        found.comparison.undefined[Pair::new(1, 1)],
        Some(Undefined::NumericallyZero(BundleKind::Physics))
    );
    // A gain of 1e60 is beyond the limit of 1000 dB, which is 1e50.
    let alone = analysis_of(
        &two_lags([[1e-30, 0.0], [0.0, 1.0]], [[1e30, 0.0], [0.0, 0.9]]),
        &[],
    );
    let found = &alone.condition(CONDITION).unwrap().comparison;
    assert_eq!(
        found.undefined[Pair::new(0, 0)],
        Some(Undefined::GainOutOfRange(60))
    );
    assert!(found.delta.gain[Pair::new(1, 1)].is_some());
}

/// Returns the cautions about the models of a file that the `check` command reports.
fn cautions_of(value: &Value) -> Vec<Caution> {
    let cautions =
        cautions_of_models(&Study::new(dataset(value)), &Execution::sequential()).unwrap();
    cautions.into_iter().map(|(_, caution)| caution).collect()
}

#[test]
fn a_gain_out_of_range_is_reported_with_its_power_of_ten() {
    for (power, physics, identified) in [
        (74, 1.0, 1e74),
        (-74, 1e74, 1.0),
        (74, 1e-74, 1.0),
        (-74, 1.0, 1e-74),
    ] {
        let value = two_lags(
            [[physics, 0.0], [0.0, 1.0]],
            [[identified, 0.0], [0.0, 0.9]],
        );
        let pair = Pair::new(0, 0);
        let analysis = analysis_of(&value, &[]);
        let found = analysis.condition(CONDITION).unwrap();
        let why = found.comparison.undefined[pair].unwrap();
        assert_eq!(
            (why, why.code()),
            (Undefined::GainOutOfRange(power), "gain-out-of-range")
        );
        let expected = Caution::GainsOutOfRange {
            physics: "model".to_owned(),
            identified: "model".to_owned(),
            responses: vec![GainOutOfRange {
                pair,
                power_of_ten: power,
            }],
        };
        assert!(found.cautions.contains(&expected), "{:?}", found.cautions);
        assert_eq!(cautions_of(&value), [expected]);
    }
    // If no gain of the analysis is within range, the condition fails and the message states all
    // gains.
    let alone = analysis_of(
        &two_lags([[1e74, 0.0], [0.0, 1e74]], [[1.0, 0.0], [0.0, 1.0]]),
        &[],
    );
    let out_of_range = |index| GainOutOfRange {
        pair: Pair::new(index, index),
        power_of_ten: -74,
    };
    let failure = alone.conditions[&CONDITION].as_ref().unwrap_err();
    let ConditionFailure::NothingToCompare { cautions, .. } = failure else {
        panic!("{failure:?}")
    };
    assert!(
        cautions.iter().any(|caution| matches!(
            caution,
            Caution::GainsOutOfRange { responses, .. }
                if *responses == [out_of_range(0), out_of_range(1)]
        )),
        "{cautions:?}"
    );
    // A gain of 1e48, 960 dB, is within range.
    assert!(
        cautions_of(&two_lags(
            [[1e-24, 0.0], [0.0, 1.0]],
            [[1e24, 0.0], [0.0, 0.9]]
        ))
        .is_empty()
    );
}

/// Returns two lags whose identified model is a response measured from 0.3 to 20 rad/s, for
/// analysis in `band` \[rad/s\]; the responses in `zeros` (\[output, input\]) have only zeros as
/// values.
fn two_lags_measured(zeros: &[[usize; 2]], band: [f64; 2]) -> Value {
    let mut value = two_lags([[1.0, 0.1], [0.1, 1.0]], [[1.2, 0.1], [0.1, 0.9]]);
    let omega: Vec<f64> = (0..50)
        .map(|k| 0.3 * (20.0_f64 / 0.3).powf(f64::from(k) / 49.0))
        .collect();
    let part = |part: fn(f64, f64) -> f64| -> Value {
        let curve = |output: usize, input: usize| -> Vec<f64> {
            let is_zero = zeros.contains(&[output, input]);
            let lag = [1.0, 3.0][input];
            omega
                .iter()
                .map(|&omega| if is_zero { 0.0 } else { part(lag, omega) })
                .collect()
        };
        json!([[curve(0, 0), curve(0, 1)], [curve(1, 0), curve(1, 1)]])
    };
    // Real and imaginary part of 1 / (lag + j omega).
    let re = part(|lag, omega| lag / (lag * lag + omega * omega));
    let im = part(|lag, omega| -omega / (lag * lag + omega * omega));
    value["conditions"][0]["identified_models"][0] = json!({"name": "measured", "frequency_response": {"omega_rad_s": omega, "re": re, "im": im}});
    value["frequency_band"] = json!({"min": band[0], "max": band[1], "unit": "rad/s"});
    value
}

#[test]
fn a_response_measured_as_zero_is_reported_as_missing_not_as_measured_too_short() {
    let model = BundleModel {
        bundle: BundleKind::Identified,
        name: "measured".to_owned(),
    };
    let responses = vec![Pair::new(0, 1), Pair::new(1, 1)];
    // A band within the measured frequencies, and a band beyond them.
    for (band, not_finite) in [
        ([0.5, 12.0], vec![]),
        ([0.5, 30.0], vec![Pair::new(0, 0), Pair::new(1, 0)]),
    ] {
        let value = two_lags_measured(&[[0, 1], [1, 1]], band);
        let mut cautions = cautions_of(&value);
        let missing = Caution::MissingResponses {
            model: model.clone(),
            responses: responses.clone(),
        };
        assert_eq!(
            (cautions.remove(0), missing.code()),
            (missing.clone(), "response-missing")
        );
        let beyond: Vec<Pair> = cautions
            .iter()
            .flat_map(|caution| match caution {
                Caution::NotFinite { responses, .. } => responses.clone(),
                other => panic!("{other:?}"),
            })
            .collect();
        assert_eq!(beyond, not_finite, "{band:?}");
    }
    let value = two_lags_measured(&[[0, 1], [1, 1]], [0.5, 12.0]);
    let analysis = analysis_of(&value, &[]);
    let found = analysis.condition(CONDITION).unwrap();
    // A response that is measured as zero throughout counts as not measured.
    for &pair in &responses {
        assert_eq!(
            found.comparison.undefined[pair],
            Some(Undefined::NotMeasured)
        );
    }
    assert!(found.comparison.delta.gain[Pair::new(0, 0)].is_some());
    let missing = Caution::MissingResponses { model, responses };
    assert!(found.cautions.contains(&missing), "{:?}", found.cautions);
    assert!(
        !found
            .cautions
            .iter()
            .any(|caution| matches!(caution, Caution::NotFinite { .. })),
        "{:?}",
        found.cautions
    );
}

#[test]
fn a_model_set_aside_for_a_zero_response_is_not_reported_as_measured_too_short() {
    let mut value = two_lags_measured(&[[1, 1]], [0.5, 12.0]);
    let whole =
        two_lags_measured(&[], [0.5, 12.0])["conditions"][0]["identified_models"][0].clone();
    value["conditions"][0]["identified_models"]
        .as_array_mut()
        .unwrap()
        .push(whole);
    value["conditions"][0]["identified_models"][1]["name"] = json!("whole");
    let model = BundleModel {
        bundle: BundleKind::Identified,
        name: "measured".to_owned(),
    };
    let lacks = vec![Pair::new(1, 1)];
    let expected = Caution::SetAside {
        model,
        zero: lacks.clone(),
        lacks,
        why: None,
        pinned: false,
    };
    assert_eq!(cautions_of(&value), [expected]);
}

/// Returns the gains of the inputs, then those of the outputs.
fn channel_gains(correction: &ChannelCorrection) -> Vec<f64> {
    [&correction.input_gains[..], &correction.output_gains[..]].concat()
}

#[test]
fn airspeeds_within_the_tolerance_are_one_point_of_the_schedule() {
    let analysis = analysis_of(&json(NEAR_AIRSPEEDS), &[]);
    let schedule = analysis.schedule.as_ref().unwrap();
    assert_eq!(schedule.airspeeds.clusters, [vec![0, 1], vec![2]]);
    // The default degree is 2; two points determine a line.
    let lowered = ScheduleCaution::DegreeLowered {
        asked: 2,
        clusters: 2,
    };
    // Conditions 0 and 1 form one point of the schedule, but only the second has delays. The point
    // has their mean, which increases the cost of the first.
    let [first, ScheduleCaution::CostsMore(cost)] = &schedule.cautions[..] else {
        panic!("{:?}", schedule.cautions)
    };
    assert_eq!(*first, lowered);
    assert_eq!(
        (cost.condition, cost.model.as_str()),
        (ConditionId(1), "nominal")
    );
    assert!(cost.scheduled > 2.0 * cost.own, "{cost:?}");
    let mut net_delays_s = Vec::new();
    for result in analysis.conditions.values() {
        let correction = &result.as_ref().unwrap().correction;
        net_delays_s.push([0, 1].map(|place| correction.net_delay_s(Pair::new(place, place))));
    }
    let at = schedule.at(60.0);
    for place in [0, 1] {
        let [first_s, second_s, third_s] = [0, 1, 2].map(|id| net_delays_s[id][place]);
        assert!(first_s.max(third_s) < 1e-9, "{first_s}, {third_s}");
        assert!(second_s > 0.05, "{second_s}");
        let scheduled_s = at.net_delay_s(Pair::new(place, place));
        assert!(
            (scheduled_s - 0.5 * second_s).abs() < 1e-6,
            "scheduled {scheduled_s}, which is not half of {second_s}"
        );
    }
    let never = setting_table::SCHEDULE_DELAYS.to(DelayScheduling::Never);
    let without = analysis_of(&json(NEAR_AIRSPEEDS), &[never])
        .schedule
        .unwrap();
    assert!(!without.has_delays() && without.cautions[0] == lowered);
    // From 60 to 120 kt, scheduled gains stay within 1 % of the range of the conditions' own gains.
    let own: Vec<Vec<f64>> = analysis
        .conditions
        .values()
        .map(|result| channel_gains(&result.as_ref().unwrap().correction))
        .collect();
    for step in 0..=60 {
        let scheduled = channel_gains(&schedule.at(60.0 + f64::from(step)));
        for (channel, gain) in scheduled.into_iter().enumerate() {
            let all = own.iter().map(|gains| gains[channel]);
            let least = all.clone().fold(f64::INFINITY, f64::min);
            let most = all.fold(0.0, f64::max);
            assert!(
                (0.99 * least..=1.01 * most).contains(&gain),
                "channel {channel}: {gain} is not between {least} and {most}"
            );
        }
    }
    let written = &corrections(
        &analysis,
        "",
        &analysis.conditions.keys().copied().collect(),
    )["schedule"];
    assert_eq!(
        (&written["degree"], list(&written["table"]).len()),
        (&1.into(), 2)
    );
    assert_eq!(written["airspeed_tolerance_kt"], 2.0);
    let cautions = &analysis.schedule.as_ref().unwrap().cautions;
    assert!(
        matches!(
            cautions[0],
            ScheduleCaution::DegreeLowered {
                asked: 2,
                clusters: 2
            }
        ),
        "{cautions:?}"
    );
}

#[test]
fn an_overshooting_polynomial_reports_where_and_a_table_does_not_overshoot() {
    // Without a tolerance, the parabola passes through two points that are 1e-6 kt apart and differ
    // in gain.
    let no_tolerance = setting_table::AIRSPEED_TOLERANCE.to(0.0);
    let analysis = analysis_of(&json(NEAR_AIRSPEEDS), std::slice::from_ref(&no_tolerance));
    let schedule = analysis.schedule.as_ref().unwrap();
    assert!(schedule.interpolation_fails());
    let ScheduleCaution::Overshoot { between_kt, .. } = schedule.cautions[0] else {
        panic!("{:?}", schedule.cautions)
    };
    assert_eq!(between_kt.map(|kt| (10.0 * kt).round()), [600.0, 1200.0]);
    let table = setting_table::SCHEDULE.to(ScheduleKind::Table);
    assert!(
        !analysis_of(&json(NEAR_AIRSPEEDS), &[no_tolerance, table])
            .schedule
            .unwrap()
            .interpolation_fails()
    );
}

#[test]
fn a_pole_at_a_grid_frequency_is_reported_as_the_cause_of_failure() {
    let mut value = two_lags([[1.0, 0.2], [0.3, 1.0]], [[1.2, 0.2], [0.3, 0.9]]);
    // An undamped pole pair at the lowest frequency of the band.
    value["conditions"][0]["physics_models"][0]["A"] = json!([[0.0, 0.5], [-0.5, 0.0]]);
    let analysis = analysis_of(&value, &[]);
    let failure = analysis.conditions[&CONDITION].as_ref().unwrap_err();
    let ConditionFailure::NothingToCompare { cautions, .. } = failure else {
        panic!("{failure:?}")
    };
    assert!(
        cautions.iter().any(|caution| matches!(
            caution,
            Caution::NotFinite {
                why: NotFinite::Pole,
                ..
            }
        )),
        "{cautions:?}"
    );
}

#[test]
fn a_tiny_alpha_gives_the_net_gains_of_zero_alpha_and_only_close_gains_suggest_a_unit() {
    let value = json(SIX_BY_FOUR);
    let net_gains = |alpha: f64| {
        let analysis = analysis_of(&value, &[setting_table::ALPHA_GAIN.to(alpha)]);
        let result = analysis.condition(CONDITION).unwrap();
        let net = result.cost.map(|pair, _| result.correction.net_gain(pair));
        // The gains of O5, 15.1 and 5.6, are near enough to each other for a unit factor; the gains
        // of the other channels differ by a factor of ten.
        let doubted: Vec<Channel> = analysis.doubts.iter().map(|doubt| doubt.channel).collect();
        assert_eq!(doubted, [Channel::Output(5)], "{:?}", analysis.doubts);
        net.iter().map(|(_, gain)| *gain).collect::<Vec<f64>>()
    };
    // The effect of the term with weight alpha is of the order of alpha; the tolerance of the
    // solver is 1e-8.
    for (with_tiny, with_zero) in net_gains(1e-12).into_iter().zip(net_gains(0.0)) {
        assert!(
            (with_tiny / with_zero).ln().abs() < 1e-6,
            "{with_tiny} with alpha = 1e-12, {with_zero} with alpha = 0"
        );
    }
}
