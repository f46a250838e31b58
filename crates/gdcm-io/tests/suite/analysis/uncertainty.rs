//! Confidence intervals of the results: comparison with independent reference values, and general
//! properties (M13).

use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use gdcm_io::{DatasetOrigin, load_dataset_bytes};
use gdcm_method::correction::Channel;
use gdcm_method::schedule::airspeeds::airspeed_indicators;
use gdcm_method::schedule::{ScheduleKind, SecondVariable};
use gdcm_method::uncertainty::bar::BarRemark;
use gdcm_method::uncertainty::{
    Bar, Design, Difference, IdentificationSource, Scalar, ScheduleBand, SecondVariableDesign,
    VarianceComponent, VarianceDecomposition, holm,
};
use gdcm_model::dataset::{Dataset, ModelId};
use gdcm_model::progress::{Cancelled, Progress};
use gdcm_study::PhaseCorrection;
use gdcm_study::decisions::dataset_differences::Difference as DatasetDifference;
use gdcm_study::results::uncertainty::{
    AirspeedDifference, ConditionUncertainty, PairScatter, Uncertainty,
};
use gdcm_words::ExplainTarget;
use gdcm_words::derivation::{SPREAD_ALONE, derivation};

use super::*;

/// Cases computed by independent numpy code. Its values for pooling and quantiles are tested beside
/// those functions.
const REFERENCE: &str = include_str!("../../../../../tests/data/reference/uncertainty.json");

/// Accuracy of the reference values.
const TOLERANCE: f64 = 1e-6;
/// Tolerance for results of the gain solver: the optimum is flat, so the gains are less accurate.
const SOLVER_TOLERANCE: f64 = 1e-5;

fn case(name: &str) -> Value {
    json(REFERENCE)["cases"][name].clone()
}

#[track_caller]
fn assert_near(what: &str, found: f64, reference: &Value, tolerance: f64) {
    let reference = number(reference);
    assert!(
        (found - reference).abs() <= tolerance,
        "{what}: found {found}, reference {reference}"
    );
}

pub(super) fn study_of(dataset: &Value) -> Study {
    let text = serde_json::to_vec(dataset).unwrap();
    Study::new(
        load_dataset_bytes(
            &text,
            DatasetOrigin::EmbeddedExample(gdcm_io::Example::Simulated),
        )
        .unwrap()
        .dataset,
    )
}

pub(super) fn set(study: &mut Study, edit: Edit) {
    study.apply(&edit).unwrap();
}

pub(super) fn uncertainty_of(study: &Study) -> (Analysis, Uncertainty) {
    let mut engine = Engine::default();
    let analysis = analyze(&mut engine, study);
    let uncertainty = engine.uncertainty(&analysis, &Unobserved).unwrap();
    (analysis, uncertainty)
}

/// Asserts that a bar agrees with the reference: value, parts, half-width, and degrees of freedom
/// if it has any.
#[track_caller]
fn assert_bar(what: &str, bar: &Bar, reference: &Value, tolerance: f64) {
    let root = |part: Option<VarianceComponent>| part.map_or(0.0, |part| part.variance.sqrt());
    assert_near(&format!("{what}: q"), bar.value, &reference["q"], tolerance);
    assert_near(
        &format!("{what}: trim"),
        root(bar.trim),
        &reference["u_phys"],
        tolerance,
    );
    assert_near(
        &format!("{what}: identification"),
        root(bar.identification),
        &reference["u_id"],
        tolerance,
    );
    assert_near(
        &format!("{what}: half-width"),
        bar.half_width(0.9).unwrap_or(0.0),
        &reference["half_width"],
        tolerance,
    );
    if let Some(degrees) = reference["df_id"].as_f64() {
        assert_eq!(
            bar.identification.unwrap().degrees_of_freedom,
            degrees,
            "{what}"
        );
    }
    match reference["nu"].as_f64() {
        // A relative change of 1e-3 in the degrees of freedom changes the quantile by less than the
        // tolerance.
        Some(degrees) => assert!(
            (bar.degrees_of_freedom().unwrap() / degrees - 1.0).abs() < 1e-3,
            "{what}: {:?}",
            bar.degrees_of_freedom()
        ),
        None => assert_eq!(bar.degrees_of_freedom(), None, "{what}"),
    }
}

fn find_pair(study: &Study, names: &Value) -> Pair {
    let names = texts(names);
    study.dataset.find_pair(names[0], names[1]).unwrap()
}

/// Asserts that a decomposition of the variance agrees with the reference.
#[track_caller]
fn assert_split(what: &str, split: &VarianceDecomposition, reference: &Value, tolerance: f64) {
    assert_eq!(split.freedom as f64, number(&reference["df"]), "{what}");
    let deviations = [
        ("scatter", split.scatter.sqrt()),
        ("physics", split.trim.sqrt()),
        ("identification", split.identification.sqrt()),
        ("rest", split.unexplained().sqrt()),
    ];
    for (name, found) in deviations {
        assert_near(
            &format!("{what} {name}"),
            found,
            &reference[name],
            tolerance,
        );
    }
    let relative = |name: &str, found: f64| {
        let expected = number(&reference[name]);
        // Ratios of small values, which magnify the tolerance of the solver; so do the probability,
        // the interval and the shares below.
        assert!(
            (found / expected - 1.0).abs() < 1e-3,
            "{what} {name}: found {found}, reference {expected}"
        );
    };
    relative("ratio", split.ratio().unwrap());
    relative("df_bundles", split.degrees_of_freedom.unwrap());
    assert_near(what, split.p().unwrap(), &reference["p"], 100.0 * tolerance);
    for (found, expected) in split
        .unexplained_interval(0.9)
        .unwrap()
        .iter()
        .zip(list(&reference["rest_interval"]))
    {
        assert_near(
            &format!("{what} interval"),
            *found,
            expected,
            20.0 * tolerance,
        );
    }
    for (found, expected) in split
        .shares()
        .unwrap()
        .iter()
        .zip(list(&reference["shares"]))
    {
        assert_near(
            &format!("{what} shares"),
            *found,
            expected,
            100.0 * tolerance,
        );
    }
}

/// Asserts that the difference of two conditions at equal airspeed agrees with the reference.
#[track_caller]
fn assert_difference(found: &AirspeedDifference, reference: &Value, tolerance: f64) {
    let what = format!("difference of {:?} {:?}", found.pair, found.conditions);
    let ids: Vec<f64> = found.conditions.iter().map(|id| id.0 as f64).collect();
    assert_eq!(ids, numbers(&reference["conditions"]), "{what}");
    assert_near(
        &what,
        found.difference.delta,
        &reference["delta"],
        tolerance,
    );
    assert_near(
        &what,
        found.difference.deviation,
        &reference["u"],
        tolerance,
    );
    // The ratio and the probability magnify errors of the deviation, the ratio's denominator.
    assert_near(
        &what,
        found.difference.ratio().unwrap(),
        &reference["ratio"],
        500.0 * tolerance,
    );
    assert_near(
        &what,
        found.p_holm.unwrap(),
        &reference["p_holm"],
        1000.0 * tolerance,
    );
}

/// Asserts that everything in the reference about the pairs of a case agrees.
fn assert_pairs(analysis: &Analysis, found: &Uncertainty, reference: &Value, tolerance: f64) {
    let study = &analysis.study;
    for reference in list(reference) {
        let pair = find_pair(study, &reference["pair"]);
        let differences: Vec<_> = found
            .differences
            .iter()
            .filter(|difference| difference.pair == pair)
            .collect();
        assert_eq!(differences.len(), list(&reference["differences"]).len());
        for (difference, reference) in differences.iter().zip(list(&reference["differences"])) {
            assert_difference(difference, reference, tolerance);
        }
        let PairScatter {
            same_airspeed,
            about_schedule,
            ..
        } = found
            .scatter
            .iter()
            .find(|scatter| scatter.pair == pair)
            .unwrap();
        assert_split(
            &format!("{pair:?} at equal airspeed"),
            same_airspeed.as_ref().unwrap(),
            &reference["same_airspeed"],
            tolerance,
        );
        assert_split(
            &format!("{pair:?} about the schedule"),
            about_schedule.as_ref().unwrap(),
            &reference["about_schedule"],
            tolerance,
        );
        let schedule = analysis.schedule.as_ref().unwrap();
        let bands = found.bands.as_ref().unwrap();
        for (place, airspeed_kt) in numbers(&reference["schedule"]["airspeed_kt"])
            .into_iter()
            .enumerate()
        {
            let widths = bands
                .at(schedule, Scalar::NetGain(pair), airspeed_kt)
                .unwrap();
            let fit = schedule.at(airspeed_kt).net_gain(pair).ln();
            let what = format!("{pair:?} at {airspeed_kt} kt");
            assert_near(
                &format!("{what}: fit"),
                fit,
                &reference["schedule"]["fit"][place],
                tolerance,
            );
            assert_near(
                &format!("{what}: confidence"),
                widths.confidence,
                &reference["schedule"]["confidence"][place],
                10.0 * tolerance,
            );
            assert_near(
                &format!("{what}: scatter"),
                widths.scatter,
                &reference["schedule"]["scatter"][place],
                10.0 * tolerance,
            );
        }
        for (variable, name) in [
            (SecondVariable::Altitude, "altitude"),
            (SecondVariable::Mass, "weight"),
        ] {
            let test = found
                .second_variables
                .iter()
                .find(|test| test.pair == pair && test.variable == variable)
                .unwrap();
            let effect = test.effect.unwrap();
            let reference = &reference[name];
            let what = format!("{pair:?}, effect of the {name}");
            assert_near(&what, effect.effect, &reference["effect"], 10.0 * tolerance);
            assert_near(
                &what,
                effect.detectable,
                &reference["visible"],
                10.0 * tolerance,
            );
            assert_near(
                &what,
                effect.left_out_without.unwrap(),
                &reference["loco_without"],
                10.0 * tolerance,
            );
            assert_near(
                &what,
                effect.left_out_with.unwrap(),
                &reference["loco_with"],
                10.0 * tolerance,
            );
            assert_near(
                &what,
                test.p_holm.unwrap(),
                &reference["p_holm"],
                1000.0 * tolerance,
            );
            assert_eq!(
                test.needed,
                reference["needed"].as_bool().unwrap(),
                "{what}"
            );
        }
    }
}

/// Returns the study of the reference case in which the models of a bundle differ by known gains, and
/// the case.
fn study_of_known_spread() -> (Study, Value) {
    let case = case("A_pure_gain_bundles");
    let mut study = study_of(&case["dataset"]);
    let kind = ScheduleKind::Polynomial { degree: 1 };
    set(&mut study, setting_table::SCHEDULE.to(kind));
    (study, case)
}

#[test]
fn bundles_of_known_spread_have_the_bars_of_the_reference() {
    let (study, case) = study_of_known_spread();
    let (analysis, found) = uncertainty_of(&study);
    let lists = [
        ("bars_lnG", Scalar::Gain(Pair::new(0, 0))),
        ("bars_lnG", Scalar::Gain(Pair::new(1, 0))),
        ("bars_ln_k_in", Scalar::ChannelGain(Channel::Input(1))),
        ("bars_ln_k_out", Scalar::ChannelGain(Channel::Output(0))),
        ("bars_net", Scalar::NetGain(Pair::new(1, 1))),
    ];
    for (name, scalar) in lists {
        for reference in list(&case[name]) {
            let id = ConditionId(number(&reference["condition"]) as i64);
            assert_bar(
                &format!("{name} of {id}"),
                found.bar(id, scalar).unwrap(),
                reference,
                TOLERANCE,
            );
        }
    }
    assert_pairs(&analysis, &found, &case["pairs"], TOLERANCE);
    let output = found
        .bar(ConditionId(1), Scalar::ChannelGain(Channel::Output(0)))
        .unwrap();
    assert_eq!(output.remarks(), [BarRemark::NoSpread]);
}

#[test]
fn the_error_from_coherence_replaces_a_smaller_spread() {
    let case = case("B_delay_and_coherence");
    let variants = [
        ("averages_4", 4.0, None),
        ("averages_4_window_20s", 4.0, Some(20.0)),
        ("averages_1000", 1000.0, None),
    ];
    for (name, averages, window_s) in variants {
        let mut dataset = case["dataset"].clone();
        for model in dataset["conditions"][0]["identified_models"]
            .as_array_mut()
            .unwrap()
        {
            model["frequency_response"]["averages"] = averages.into();
            if let Some(window_s) = window_s {
                model["frequency_response"]["window_s"] = f64::into(window_s);
            }
        }
        let mut study = study_of(&dataset);
        set(&mut study, setting_table::POINTS.to(40));
        let (_, found) = uncertainty_of(&study);
        let bar = |scalar| *found.bar(ConditionId(1), scalar).unwrap();
        let gain = bar(Scalar::Gain(Pair::new(0, 0)));
        let delay = bar(Scalar::Delay(Pair::new(0, 0)));
        assert_bar(
            &format!("{name}: ln G"),
            &gain,
            &case["result"][name]["lnG"],
            TOLERANCE,
        );
        assert_bar(
            &format!("{name}: D"),
            &delay,
            &case["result"][name]["D"],
            TOLERANCE,
        );
        let by_coherence = averages < 10.0;
        assert_eq!(
            gain.source == IdentificationSource::Coherence,
            by_coherence,
            "{name}"
        );
    }
}

#[test]
fn the_variance_of_a_table_of_numbers_is_decomposed_as_in_the_reference() {
    let case = case("C_table");
    let airspeeds = numbers(&case["airspeed_kt"]);
    let mean = airspeeds.iter().sum::<f64>() / airspeeds.len() as f64;
    let row = |airspeed: f64| {
        // Half the range of airspeeds, 45 to 140 kt.
        let v = (airspeed - mean) / 47.5;
        vec![1.0, v, v * v]
    };
    let rows: Vec<Vec<f64>> = airspeeds.iter().map(|&airspeed| row(airspeed)).collect();
    let design = Design::new(&rows).unwrap();
    let by_airspeed = Design::new(&airspeed_indicators(airspeeds, 1.0)).unwrap();
    for table in list(&case["tables"]) {
        let figures = numbers(&table["y"]);
        let component = |name: &str, place: usize, degrees| {
            Some(VarianceComponent {
                variance: number(&case[name][place]).powi(2),
                degrees_of_freedom: degrees,
            })
        };
        let bar = |place: usize| Bar {
            value: figures[place],
            // Degrees of freedom given by the reference.
            trim: component("s_phys", place, 18.0),
            identification: component("s_id", place, 6.0),
            source: IdentificationSource::Spread,
            left_out: 0,
            range: [f64::NEG_INFINITY, f64::INFINITY],
        };
        let bars: Vec<Bar> = (0..figures.len()).map(bar).collect();
        let references = list(&table["differences"]);
        let differences = references.iter().map(|reference| {
            let places: Vec<usize> = numbers(&reference["conditions"])
                .iter()
                .map(|id| *id as usize - 1)
                .collect();
            Difference::between(&bars[places[0]], &bars[places[1]])
        });
        let probabilities: Vec<f64> = differences
            .map(|difference| difference.p().unwrap())
            .collect();
        for (found, reference) in holm(&probabilities).iter().zip(references) {
            assert_near("Holm", *found, &reference["p_holm"], TOLERANCE);
        }
        let about_schedule = VarianceDecomposition::new(&design, &bars).unwrap();
        assert_split(
            "about the schedule",
            &about_schedule,
            &table["about_schedule"],
            TOLERANCE,
        );
        assert_split(
            "at equal airspeed",
            &VarianceDecomposition::new(&by_airspeed, &bars).unwrap(),
            &table["same_airspeed"],
            TOLERANCE,
        );
        let band = ScheduleBand::new(&Arc::new(design.clone()), &about_schedule, 0.9);
        for (place, airspeed) in numbers(&table["bands"]["airspeed_kt"])
            .into_iter()
            .enumerate()
        {
            assert_near(
                "confidence",
                band.at(&row(airspeed)).confidence,
                &table["bands"]["confidence"][place],
                TOLERANCE,
            );
            assert_near(
                "scatter",
                band.at(&row(airspeed)).scatter,
                &table["bands"]["scatter"][place],
                TOLERANCE,
            );
        }
        for (found, reference) in design
            .left_out_errors(&figures)
            .iter()
            .zip(list(&table["loco_errors"]))
        {
            assert_near("left out", found.unwrap(), reference, TOLERANCE);
        }
        for (name, values) in [("altitude", "altitude_ft"), ("weight", "mass_kg")] {
            let effect = SecondVariableDesign::new(&rows, &numbers(&case[values]))
                .unwrap()
                .effect(&figures, 0.9);
            assert_near(name, effect.effect, &table[name]["effect"], TOLERANCE);
            assert_near(name, effect.detectable, &table[name]["half"], TOLERANCE);
            assert_near(name, effect.p, &table[name]["p"], TOLERANCE);
            assert_near(
                name,
                effect.left_out_with.unwrap(),
                &table[name]["loco_with"],
                TOLERANCE,
            );
        }
    }
}

#[test]
fn the_example_has_the_bars_of_the_reference() {
    let case = case("F_example_dataset");
    let analysis = &*EXAMPLE_WITH_SUGGESTIONS_REJECTED;
    let found = Engine::default()
        .uncertainty(analysis, &Unobserved)
        .unwrap();
    let id_of = |reference: &Value| ConditionId(number(&reference["condition"]) as i64);
    for (name, scalar_of, tolerance) in [
        (
            "net_gain_bars",
            Scalar::NetGain as fn(Pair) -> Scalar,
            SOLVER_TOLERANCE,
        ),
        ("delay_bars", Scalar::Delay, TOLERANCE),
    ] {
        for pair in list(&case[name]) {
            let scalar = scalar_of(find_pair(&analysis.study, &pair["pair"]));
            for reference in list(&pair["bars"]) {
                let bar = found.bar(id_of(reference), scalar).unwrap();
                assert_bar(
                    &format!("{scalar:?} of {}", id_of(reference)),
                    bar,
                    reference,
                    tolerance,
                );
            }
        }
    }
    let channels = &case["channel_bars_condition_6"];
    for (name, channel) in [
        ("k_in", Channel::Input as fn(usize) -> Channel),
        ("k_out", Channel::Output),
    ] {
        for (index, reference) in list(&channels[name]).iter().enumerate() {
            let bar = found
                .bar(ConditionId(6), Scalar::ChannelGain(channel(index)))
                .unwrap();
            assert_bar(&format!("{name} {index}"), bar, reference, SOLVER_TOLERANCE);
        }
    }
    let measuring: Vec<Pair> = list(&case["pairs"])
        .iter()
        .map(|reference| find_pair(&analysis.study, &reference["pair"]))
        .collect();
    for reference in list(&case["left_in_band"]) {
        let left = &found.conditions[&id_of(reference)].left_in_band;
        for (pair, reference) in measuring.iter().zip(list(&reference["on_axis"])) {
            assert_near(
                "left over in the band",
                left[*pair].unwrap(),
                reference,
                TOLERANCE,
            );
        }
    }
    assert_pairs(analysis, &found, &case["pairs"], SOLVER_TOLERANCE);
}

/// Returns the bars of all results of all conditions, ordered by condition, then as the results are
/// listed.
fn all_bars(found: &Uncertainty) -> Vec<(ConditionId, Scalar, Option<Bar>)> {
    let mut bars = Vec::new();
    for (id, condition) in &found.conditions {
        for (scalar, bar) in condition.bars.iter() {
            bars.push((*id, scalar, *bar));
        }
    }
    bars
}

/// Returns the half-width of the 90 % interval; 0 without a bar or without a variance.
fn half_width_or_zero(bar: Option<Bar>) -> f64 {
    bar.and_then(|bar| bar.half_width(0.9)).unwrap_or(0.0)
}

#[test]
fn the_order_of_models_and_conditions_does_not_change_the_bars() {
    let (_, case) = study_of_known_spread();
    let mut reversed = case["dataset"].clone();
    let conditions = reversed["conditions"].as_array_mut().unwrap();
    conditions.reverse();
    for condition in conditions {
        for bundle in ["physics_models", "identified_models"] {
            condition[bundle].as_array_mut().unwrap().reverse();
        }
    }
    let (_, found) = uncertainty_of(&study_of(&case["dataset"]));
    let (_, of_reversed) = uncertainty_of(&study_of(&reversed));
    let pairs = all_bars(&found).into_iter().zip(all_bars(&of_reversed));
    for ((id, scalar, bar), (_, _, reversed_bar)) in pairs {
        let width = half_width_or_zero(bar);
        let reversed_width = half_width_or_zero(reversed_bar);
        // Sums in another order, and rounding in the solver.
        assert!(
            (width - reversed_width).abs() < 1e-8,
            "{id} {scalar:?}: half-widths {width} and {reversed_width}"
        );
    }
}

#[test]
fn a_bundle_with_one_model_lacks_the_trim_part_or_borrows_the_identification_part() {
    let (mut study, _) = study_of_known_spread();
    for (condition, bundle) in [(1, BundleKind::Physics), (2, BundleKind::Identified)] {
        let condition = ConditionId(condition);
        let models: Vec<String> = study.dataset.condition(condition).unwrap().bundle(bundle)[1..]
            .iter()
            .map(|model| model.name.clone())
            .collect();
        let models = models
            .iter()
            .map(|name| ModelId::new(condition, bundle, name))
            .collect();
        study.apply(&Edit::RejectEach(models)).unwrap();
    }
    let (_, found) = uncertainty_of(&study);
    let bar = |id| {
        *found
            .bar(ConditionId(id), Scalar::NetGain(Pair::new(0, 0)))
            .unwrap()
    };
    assert_eq!(
        (bar(1).trim, bar(1).remarks()),
        (None, vec![BarRemark::NoTrim])
    );
    assert!(
        bar(1).half_width(0.9).unwrap() > 0.0,
        "the identification part should remain"
    );
    let borrowed = bar(2).identification.unwrap();
    // Degrees of freedom borrowed: two from the first condition, none from the third, which has a
    // single model, and one from the fourth.
    assert_eq!(
        (borrowed.degrees_of_freedom, bar(2).remarks().len()),
        (3.0, 0),
        "borrowed from the other conditions"
    );
}

#[test]
fn without_a_second_identified_model_anywhere_the_bar_contains_only_the_trim() {
    let (_, case) = study_of_known_spread();
    let mut dataset = case["dataset"].clone();
    for condition in dataset["conditions"].as_array_mut().unwrap() {
        condition["identified_models"]
            .as_array_mut()
            .unwrap()
            .truncate(1);
    }
    let (_, found) = uncertainty_of(&study_of(&dataset));
    let bar = found
        .bar(ConditionId(1), Scalar::Gain(Pair::new(0, 0)))
        .unwrap();
    assert_eq!(
        (bar.identification, bar.remarks()),
        (None, vec![BarRemark::NoIdentification])
    );
    assert_eq!(bar.degrees_of_freedom(), Some(4.0));
}

#[test]
fn duplicated_models_do_not_narrow_a_bar() {
    let (mut study, case) = study_of_known_spread();
    let mut dataset = case["dataset"].clone();
    for bundle in ["physics_models", "identified_models"] {
        let models = dataset["conditions"][0][bundle].as_array_mut().unwrap();
        for place in 0..models.len() {
            let mut copy = models[place].clone();
            copy["name"] = format!("{} again", copy["name"].as_str().unwrap()).into();
            if bundle == "physics_models" {
                copy["role"] = "perturbed".into();
            }
            models.push(copy);
        }
    }
    let mut doubled = study_of(&dataset);
    for study in [&mut study, &mut doubled] {
        for (bundle, name) in [
            (BundleKind::Physics, "nominal"),
            (BundleKind::Identified, "i0"),
        ] {
            study
                .apply(&Edit::Pin(ModelId::new(ConditionId(1), bundle, name)))
                .unwrap();
        }
    }
    let (_, found) = uncertainty_of(&study);
    let (_, of_doubled) = uncertainty_of(&doubled);
    let pairs = all_bars(&found).into_iter().zip(all_bars(&of_doubled));
    for ((id, scalar, bar), (_, _, doubled_bar)) in pairs {
        let width = half_width_or_zero(bar);
        let doubled_width = half_width_or_zero(doubled_bar);
        // 1e-8 for rounding in the solver.
        assert!(
            doubled_width >= width - 1e-8,
            "{id} {scalar:?}: half-widths {width} and, with duplicates, {doubled_width}"
        );
    }
}

/// Returns a normal deviate from a random state (xorshift, Box-Muller transform).
pub(super) fn normal(state: &mut u64) -> f64 {
    let mut uniform = || {
        *state ^= *state << 13;
        *state ^= *state >> 7;
        *state ^= *state << 17;
        ((*state >> 11) as f64 + 0.5) / (1_u64 << 53) as f64
    };
    (-2.0 * uniform().ln()).sqrt() * (std::f64::consts::TAU * uniform()).cos()
}

#[test]
fn bars_of_90_percent_cover_the_truth_in_about_90_percent_of_simulated_conditions() {
    const DRAWS: usize = 200;
    const TRUTH: f64 = 0.2;
    // Standard deviations of ln G between models of the physics and of the identified bundle.
    let trim = 0.03;
    let identification = 0.02;
    let mut state = 88_172_645_463_325_252;
    let model = |name: String, log_gain: f64| {
        let a = [[-1.0]];
        let b = [[1.0]];
        let d = [[0.0]];
        serde_json::json!({"name": name, "A": a, "B": b, "C": [[log_gain.exp()]], "D": d})
    };
    let conditions: Vec<Value> = (0..DRAWS)
        .map(|draw| {
            let mut physics = vec![model("nominal".to_owned(), 0.0)];
            physics
                .extend((0..8).map(|place| model(format!("p{place}"), trim * normal(&mut state))));
            for (place, model) in physics.iter_mut().enumerate() {
                model["role"] = if place == 0 { "nominal" } else { "perturbed" }.into();
            }
            // The trim of the flight is unknown: its deviation from the nominal trim has the
            // standard deviation of the bundle.
            let flown = TRUTH + trim * normal(&mut state);
            let identified: Vec<Value> = (0..3)
                .map(|place| {
                    model(
                        format!("i{place}"),
                        flown + identification * normal(&mut state),
                    )
                })
                .collect();
            serde_json::json!({
                "id": draw,
                "name": format!("draw {draw}"),
                "airspeed_kt": 40 + draw,
                "physics_models": physics,
                "identified_models": identified,
            })
        })
        .collect();
    let dataset = serde_json::json!({
        "format": "gdcm-dataset",
        "version": 1,
        "name": "population",
        "inputs": [{"name": "U", "unit": "%"}],
        "outputs": [{"name": "Y", "unit": "deg/s"}],
        "on_axis": [["Y", "U"]],
        "frequency_band": {"min": 0.5, "max": 12.0, "unit": "rad/s"},
        "conditions": conditions,
    });
    let mut study = study_of(&dataset);
    set(&mut study, setting_table::POINTS.to(5));
    let (_, found) = uncertainty_of(&study);
    let covers = |condition: &ConditionUncertainty| {
        let [low, high] = condition.bars[Scalar::NetGain(Pair::new(0, 0))]
            .unwrap()
            .interval(0.9)
            .unwrap();
        low <= TRUTH && TRUTH <= high
    };
    let covering = found
        .conditions
        .values()
        .filter(|condition| covers(condition));
    let coverage = covering.count() as f64 / DRAWS as f64;
    // At a coverage of 0.9, the standard deviation of the share of 200 draws is 0.021.
    assert!(
        (0.86..=0.99).contains(&coverage),
        "90 % bars cover the truth in a share of {coverage}"
    );
}

/// Returns the dataset with known spread, in which the first condition has a single identified
/// model with an error band of standard deviation `sd_db` \[dB\]. A single model has no spread; the
/// band is used instead.
fn dataset_with_band(sd_db: f64) -> Value {
    let (_, case) = study_of_known_spread();
    let mut dataset = case["dataset"].clone();
    dataset["conditions"][0]["identified_models"]
        .as_array_mut()
        .unwrap()
        .truncate(1);
    let model = &mut dataset["conditions"][0]["identified_models"][0];
    let outputs = list(&model["D"]).len();
    let inputs = list(&model["D"][0]).len();
    let table = |deviation: f64| vec![vec![vec![deviation; 2]; inputs]; outputs];
    model["bands"] = serde_json::json!({
        "omega_rad_s": [1.0, 5.0],
        "sd_db": table(sd_db),
        "sd_deg": table(6.0 * sd_db),
    });
    dataset
}

#[test]
fn an_engine_recomputes_the_bars_of_a_dataset_with_changed_error_bands() {
    let mut engine = Engine::default();
    let study = |sd_db: f64| {
        let mut study = study_of(&dataset_with_band(sd_db));
        for (bundle, name) in [
            (BundleKind::Physics, "nominal"),
            (BundleKind::Identified, "i0"),
        ] {
            study
                .apply(&Edit::Pin(ModelId::new(ConditionId(1), bundle, name)))
                .unwrap();
        }
        study
    };
    let mut bars = |study: &Study| {
        let analysis = analyze(&mut engine, study);
        engine.uncertainty(&analysis, &Unobserved).unwrap()
    };
    let scalar = Scalar::Gain(Pair::new(0, 0));
    let half_width = |uncertainty: &Uncertainty| {
        uncertainty
            .bar(ConditionId(1), scalar)
            .unwrap()
            .inner_half_width(0.9)
            .unwrap()
    };
    let wide = study(3.0);
    let narrow = study(1.5);
    let bars_of_wide = bars(&wide);
    let bars_of_narrow = bars(&narrow);
    assert_eq!(
        bars_of_narrow,
        uncertainty_of(&narrow).1,
        "expected the result of a new engine"
    );
    // The standard deviations of the band count as exact, so halving them halves the bar.
    assert!(
        (half_width(&bars_of_wide) / half_width(&bars_of_narrow) - 2.0).abs() < 1e-9,
        "half-widths {} and {}",
        half_width(&bars_of_wide),
        half_width(&bars_of_narrow)
    );
    assert_eq!(
        bars_of_wide,
        bars(&wide),
        "returning to the first dataset should restore its bars"
    );
}

#[test]
fn a_bar_that_ignores_the_error_band_of_a_model_says_so_in_its_derivation() {
    let mut study = study_of(&dataset_with_band(1.0));
    let held = Pair::new(0, 0);
    let free = Pair::new(0, 1);
    set(&mut study, Edit::Hold(free, false));
    let (mut analysis, uncertainty) = uncertainty_of(&study);
    analysis.uncertainty = Some(Arc::new(uncertainty));
    let is_from_spread_alone = |target: ExplainTarget| {
        let found = derivation(&analysis, &target).unwrap();
        found.rests_on.iter().any(|line| line == SPREAD_ALONE)
    };
    let with_band = ConditionId(1);
    let delta_gain = ExplainTarget::DeltaGain(with_band, free);
    assert!(!is_from_spread_alone(delta_gain));
    let held_net_gain = ExplainTarget::NetGain(with_band, held);
    assert!(!is_from_spread_alone(held_net_gain));
    let free_net_gain = ExplainTarget::NetGain(with_band, free);
    assert!(is_from_spread_alone(free_net_gain));
    let channel_gain = ExplainTarget::Gain(with_band, Channel::Input(0));
    assert!(is_from_spread_alone(channel_gain));
    let without_band = ConditionId(2);
    assert!(
        !is_from_spread_alone(ExplainTarget::NetGain(without_band, free)),
        "no model of that condition has an error band"
    );
}

#[test]
fn with_leads_every_bar_of_a_delay_is_centred_on_the_exported_value() {
    let example = &crate::REFERENCE_DATASET.dataset;
    let first_two = example.conditions()[..2]
        .iter()
        .map(|condition| condition.as_ref().clone())
        .collect();
    let mut study = Study::new(Arc::new(Dataset::new(example.header(), first_two).unwrap()));
    set(&mut study, setting_table::PHASE.to(PhaseCorrection::Lead));
    let (mut analysis, uncertainty) = uncertainty_of(&study);
    analysis.uncertainty = Some(Arc::new(uncertainty));
    let written = corrections(
        &analysis,
        "",
        &analysis.conditions.keys().copied().collect(),
    );
    for condition in list(&written["conditions"]) {
        for key in ["D_s", "D_band_s"] {
            let entries = |table: &Value| -> Vec<Value> {
                list(table).iter().flat_map(list).cloned().collect()
            };
            for (value, bar) in entries(&condition[key])
                .iter()
                .zip(entries(&condition["bars"][key]))
            {
                let middle = 0.5 * numbers(&bar["interval"]).iter().sum::<f64>();
                assert!(
                    (middle - number(value)).abs() < 1e-12,
                    "{key}: the bar is centred on {middle}, the value is {value}"
                );
            }
        }
    }
}

#[test]
fn a_model_with_a_changed_error_band_counts_as_changed() {
    let [wide, narrow, again] = [3.0, 1.5, 3.0].map(|sd_db| study_of(&dataset_with_band(sd_db)));
    let changed = |dataset: &Study| {
        let (_, differences) = wide.reconciled(Arc::clone(&dataset.dataset));
        differences
    };
    assert_eq!(changed(&again), []);
    let is_changed = changed(&narrow).iter().any(|difference| match difference {
        DatasetDifference::ModelChanged(model) => model.name == "i0",
        _ => false,
    });
    assert!(is_changed, "{:?}", changed(&narrow));
}

/// Cancels after `steps` progress steps, and keeps the reported progress.
#[derive(Default)]
struct CancelsAt {
    steps: usize,
    done: AtomicUsize,
    total: AtomicUsize,
}

impl Progress for CancelsAt {
    fn cancelled(&self) -> bool {
        self.done.load(Ordering::Relaxed) >= self.steps
    }

    fn advanced(&self, done: usize, total: usize) {
        self.done.fetch_max(done, Ordering::Relaxed);
        self.total.store(total, Ordering::Relaxed);
    }
}

#[test]
fn model_swaps_are_steps_of_progress_and_the_uncertainty_can_be_cancelled_between_them() {
    let study = study_of_example();
    let mut engine = Engine::default();
    let analysis = analyze(&mut engine, &study);
    // Cancel at step 100 of 484, two for each of the 242 models, whose responses were computed by
    // the analysis.
    let progress = CancelsAt {
        steps: 100,
        ..CancelsAt::default()
    };
    assert_eq!(
        engine.uncertainty(&analysis, &progress).err(),
        Some(Cancelled)
    );
    let done = progress.done.into_inner();
    let total = progress.total.into_inner();
    assert_eq!(total, 2 * 242);
    // Progress is reported in steps of a hundredth of the total, and the 22 responses of a
    // condition are computed together.
    assert!((100..=100 + 22 + 5).contains(&done), "{done} steps done");
    let whole = engine.uncertainty(&analysis, &Unobserved).unwrap();
    assert_eq!(
        whole,
        uncertainty_of(&study).1,
        "a cancelled uncertainty should be computed completely the next time"
    );
}
