//! Derivations of results: the numbers in their text equal the computed values.

use gdcm_method::correction::{Channel, Outcome};
use gdcm_method::fidelity::CostAverage;
use gdcm_model::dataset::ModelId;
use gdcm_model::dataset::channel::ChannelSide;
use gdcm_model::statistics::median;
use gdcm_study::results::assessment_table::{AssessedModel, AssessmentChoice};
use gdcm_study::results::median_lags::MedianLag;
use gdcm_study::{AssessedCorrection, AssessmentTable};
use gdcm_words::ExplainTarget;
use gdcm_words::derivation::{Derivation, derivation};
use gdcm_words::solution_details::proof_text;

use super::*;

const CONDITION: ConditionId = ConditionId(3);

fn analysis() -> &'static Analysis {
    &EXAMPLE_WITH_SUGGESTIONS_REJECTED
}

fn pair() -> Pair {
    analysis().study.dataset.find_pair("Q", "LON").unwrap()
}

/// Returns the derivation of a result, and asserts that none of its parts is empty.
#[track_caller]
fn derived(target: ExplainTarget) -> Derivation {
    let found = derivation(analysis(), &target).unwrap_or_else(|| panic!("{target:?}"));
    assert!(
        !found.title.is_empty() && !found.equation.is_empty() && !found.rests_on.is_empty(),
        "{found:?}"
    );
    assert!(found.section.starts_with('M'), "{found:?}");
    found
}

/// Returns the last number in a step, without the unit and the words after it.
fn last_number(step: &str) -> f64 {
    let text = step.rsplit(" = ").next().unwrap().replace('−', "-");
    text.split_whitespace()
        .next()
        .unwrap()
        .parse()
        .unwrap_or_else(|_| panic!("{step}"))
}

/// Asserts that the derivation of a result has `value`, and that its last step ends with that value
/// to five digits.
#[track_caller]
fn assert_derived(target: ExplainTarget, value: f64) -> Derivation {
    let found = derived(target);
    assert_eq!(found.value, value, "{found:?}");
    let last = last_number(found.with_numbers.last().unwrap());
    assert!(
        (last - value).abs() <= 5.1e-5 * value.abs(),
        "the last step ends with {last} instead of {value}: {found:?}"
    );
    found
}

#[test]
fn g_and_d_are_derived_from_their_models_and_medians() {
    let result = analysis().condition(CONDITION).unwrap();
    let gain = assert_derived(
        ExplainTarget::DeltaGain(CONDITION, pair()),
        result.comparison.delta.gain[pair()].unwrap(),
    );
    // The median is over 200 frequencies.
    assert!(gain.with_numbers[0].contains(" 200 "), "{gain:?}");
    assert_eq!(gain.section, "M6, eq. (5)");
    assert!(gain.title.contains("LON → Q"), "{gain:?}");
    assert!(
        gain.title.ends_with(" 3"),
        "the title does not name the condition: {gain:?}"
    );
    let representative = result.representative_name(BundleKind::Physics);
    assert!(gain.rests_on[0].contains(representative), "{gain:?}");
    // The band of the example.
    assert!(gain.rests_on[2].contains(" 0.5 "), "{gain:?}");
    assert!(gain.rests_on[2].contains(" 12 rad/s"), "{gain:?}");
    let delay_ms = 1e3 * result.comparison.delta.delay_s[pair()].unwrap();
    assert_derived(ExplainTarget::DeltaDelay(CONDITION, pair()), delay_ms);
}

#[test]
fn gains_delays_and_their_bounds_are_derived() {
    let result = analysis().condition(CONDITION).unwrap();
    let net = result.correction.net_gain(pair());
    let found = assert_derived(ExplainTarget::NetGain(CONDITION, pair()), net);
    assert!(
        found.with_numbers[0].starts_with("k_Q k_LON = "),
        "{found:?}"
    );
    assert_eq!(
        derived(ExplainTarget::NetDelay(CONDITION, pair())).value,
        1e3 * result.correction.net_delay_s(pair())
    );
    let channels = (0..4)
        .map(Channel::Input)
        .chain((0..6).map(Channel::Output));
    let gains = [&result.gains.inputs[..], &result.gains.outputs[..]].concat();
    let delays_s = [&result.delays.inputs[..], &result.delays.outputs[..]].concat();
    for (channel, (gain, delay_s)) in channels.zip(gains.into_iter().zip(delays_s)) {
        let found = derived(ExplainTarget::Gain(CONDITION, channel));
        assert_eq!(found.value, gain);
        let outcome = result.gains.proof.outcome;
        assert!(
            matches!(outcome, Outcome::Proven { .. })
                && found.rests_on.contains(&proof_text(outcome)),
            "{found:?}"
        );
        assert_eq!(
            derived(ExplainTarget::Delay(CONDITION, channel)).value,
            1e3 * delay_s
        );
    }
    assert_eq!(
        derivation(
            analysis(),
            &ExplainTarget::Gain(CONDITION, Channel::Input(4))
        ),
        None
    );
    let bounds = assert_derived(
        ExplainTarget::GainBounds(CONDITION),
        result.gain_bounds().upper,
    );
    // The lower bound is the 5 % quantile of 1000 values: 5 on-axis responses at 200 frequencies.
    let lower_step = &bounds.with_numbers[0];
    let lower = last_number(lower_step);
    assert!(
        (lower - result.gain_bounds().lower).abs() < 1e-4,
        "{lower_step}"
    );
    assert!(lower_step.contains(" 5 %"), "{lower_step}");
    assert!(lower_step.contains(" 1000"), "{lower_step}");
    assert_eq!(
        derived(ExplainTarget::DelayBound(CONDITION)).value,
        1e3 * result.delay_upper_s()
    );
}

#[test]
fn costs_and_their_changes_are_derived() {
    let result = analysis().condition(CONDITION).unwrap();
    let cost = result.cost[pair()].unwrap();
    let before = assert_derived(
        ExplainTarget::CostBefore(CONDITION, pair()),
        cost.uncorrected.total(),
    );
    assert_eq!(
        before.with_numbers.len(),
        3,
        "magnitude, phase and their sum"
    );
    assert_derived(
        ExplainTarget::CostAfter(CONDITION, pair()),
        cost.corrected.total(),
    );
    for correction in [AssessedCorrection::Scheduled, AssessedCorrection::Own] {
        for model in [AssessedModel::Nominal, AssessedModel::Representative] {
            let choice = AssessmentChoice {
                model,
                correction,
                average: CostAverage::Mean,
            };
            let change = AssessmentTable::assess(analysis(), choice)
                .change(CONDITION, pair())
                .unwrap();
            assert_eq!(
                derived(ExplainTarget::CostChange(CONDITION, pair(), choice)).value,
                change.total()
            );
        }
    }
    let choice = AssessmentChoice {
        model: AssessedModel::Nominal,
        correction: AssessedCorrection::Own,
        average: CostAverage::Mean,
    };
    let left_out = ExplainTarget::CostChange(ConditionId(10), pair(), choice);
    assert_eq!(
        derivation(analysis(), &left_out),
        None,
        "the nominal model is rejected"
    );
}

#[test]
fn scores_and_discontinuity_ratios_are_derived() {
    let id = ConditionId(10);
    let result = analysis().condition(id).unwrap();
    for model in result.condition.bundle(BundleKind::Physics) {
        let model_id = ModelId::new(id, BundleKind::Physics, &model.name);
        assert_derived(
            ExplainTarget::DiscontinuityRatio(model_id.clone()),
            result.discontinuity_ratio(&model.name).unwrap(),
        );
        let mut ratios = result.pair_ratios(&model.name).unwrap();
        assert_eq!(
            Some(median(&mut ratios)),
            result.discontinuity_ratio(&model.name)
        );
        let distances = result.score_distances(BundleKind::Physics, &model.name);
        match result.score(BundleKind::Physics, &model.name) {
            Some(score) => {
                assert_derived(ExplainTarget::Score(model_id), score);
                let distances = distances.unwrap();
                let mean = distances.iter().sum::<f64>() / distances.len() as f64;
                assert_eq!(mean, score);
            }
            None => assert_eq!(distances, None),
        }
    }
    let rejected = ModelId::new(id, BundleKind::Physics, "nominal");
    assert_eq!(
        derivation(analysis(), &ExplainTarget::Score(rejected)),
        None
    );
}

#[test]
fn a_discontinuity_ratio_is_the_median_of_distances_over_their_fitted_distances() {
    let result = analysis().condition(ConditionId(10)).unwrap();
    let fit = result.bundle_metrics.discontinuity.as_ref().unwrap();
    let models = result.condition.bundle(BundleKind::Physics);
    for (place, model) in models.iter().enumerate() {
        let mut ratios = Vec::new();
        for (other_place, other) in models.iter().enumerate() {
            let (Some(here), Some(there)) = (model.perturbation(), other.perturbation()) else {
                continue;
            };
            let fitted = fit.fitted_distance(here, there);
            if other_place != place && fitted > 0.0 {
                let distance = result.bundle_metrics.physics.between(place, other_place);
                ratios.push(distance.unwrap() / fitted);
            }
        }
        let median = median(&mut ratios);
        // Rounding: the test takes squares and square roots in another order.
        assert!((median / fit.ratios[place].unwrap() - 1.0).abs() < 1e-12);
    }
}

#[test]
fn a_channels_median_lag_has_the_opposite_sign_of_its_delays() {
    let result = analysis().condition(CONDITION).unwrap();
    let lags = result.median_lags(ChannelSide::Input);
    assert!(!lags.is_empty());
    for MedianLag { channel, lag_s } in lags {
        let delays = result.delay_problem.delta.iter();
        let mut delays_s: Vec<f64> = delays
            .filter(|(pair, _)| channel == Channel::Input(pair.input))
            .filter_map(|(_, delay_s)| *delay_s)
            .collect();
        assert_eq!(lag_s, -median(&mut delays_s));
    }
}

#[test]
fn objectives_and_scheduled_gains_are_derived() {
    let result = analysis().condition(CONDITION).unwrap();
    assert_derived(
        ExplainTarget::GainObjective(CONDITION),
        result.gains.objective,
    );
    assert_derived(
        ExplainTarget::DelayObjective(CONDITION),
        1e6 * result.delays.objective,
    );
    let schedule = analysis().schedule.as_ref().unwrap();
    for airspeed_kt in [45.0, 77.5, 200.0] {
        let found = assert_derived(
            ExplainTarget::ScheduledGain(Channel::Output(1), airspeed_kt),
            schedule.at(airspeed_kt).output_gains[1],
        );
        assert_eq!((found.with_numbers.len(), found.section), (3, "M11"));
    }
    assert_eq!(
        derivation(
            analysis(),
            &ExplainTarget::ScheduledGain(Channel::Output(6), 60.0)
        ),
        None
    );
    assert_eq!(
        derivation(
            analysis(),
            &ExplainTarget::DeltaGain(CONDITION, Pair::new(6, 0))
        ),
        None
    );
    assert_eq!(
        derivation(analysis(), &ExplainTarget::GainBounds(ConditionId(99))),
        None
    );
}
