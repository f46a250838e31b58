//! Leads: comparison with the independent analysis of the example, and recovery of known signed
//! delays (M15).

use std::sync::Arc;

use gdcm_method::correction::Channel as CorrectedChannel;
use gdcm_method::correction::lead_design::{LeadDesign, LeadSettings};
use gdcm_method::schedule::ScheduleCaution;
use gdcm_method::uncertainty::Scalar;
use gdcm_model::dataset::condition::FlightState;
use gdcm_model::dataset::dataset::DatasetHeader;
use gdcm_model::dataset::measured_response::MeasuredResponse;
use gdcm_model::dataset::model::Origin;
use gdcm_model::dataset::{Band, Channel, Condition, Dataset, Model, ModelId};
use gdcm_model::response::LeadOrder;
use gdcm_study::decisions::settings::DelayFrom;
use gdcm_study::results::assessment_table::{AssessedModel, AssessmentChoice};
use gdcm_study::results::condition_remarks::condition_remarks;
use gdcm_study::results::remark::Remark;
use gdcm_study::{AssessedCorrection, AssessmentTable, PhaseCorrection};
use gdcm_words::leads::lead_words;

use super::*;

const REFERENCE: &str = include_str!("../../../../../tests/data/reference/lead.json");

/// Analysis of the example with leads, without rejected models.
static EXAMPLE_WITH_LEADS: LazyLock<Analysis> =
    LazyLock::new(|| analyze(&mut Engine::default(), &with_leads()));

fn with_leads() -> Study {
    let mut study = study_of_example();
    study
        .apply(&setting_table::PHASE.to(PhaseCorrection::Lead))
        .unwrap();
    study
}

/// Asserts agreement within 1e-6 of the reference value, or of `scale` if the reference is smaller.
#[track_caller]
fn assert_close(what: &str, found: f64, reference: f64, scale: f64) {
    let allowed = 1e-6 * reference.abs().max(scale);
    assert!(
        (found - reference).abs() <= allowed,
        "{what}: found {found}, reference {reference}"
    );
}

#[track_caller]
fn assert_all_close(what: &str, found: &[f64], reference: &Value, scale: f64) {
    for (found, reference) in found.iter().zip(numbers(reference)) {
        assert_close(what, *found, reference, scale);
    }
}

#[test]
fn signed_delays_filters_and_gains_of_the_example_agree() {
    let reference = json(REFERENCE);
    for expected in list(&reference["example"]["conditions"]) {
        let id = ConditionId(expected["id"].as_i64().unwrap());
        let at = format!("condition {id}");
        let found = EXAMPLE_WITH_LEADS.condition(id).unwrap();
        for (pair, delay_s) in found.comparison.delta.band_delay_s.iter() {
            assert_close(
                &at,
                delay_s.unwrap(),
                number(&expected["D_s"][pair.output][pair.input]),
                1e-3,
            );
            assert_close(
                &at,
                found.delta_gain(pair).unwrap(),
                number(&expected["G"][pair.output][pair.input]),
                1.0,
            );
        }
        assert_close(
            &at,
            found.delay_problem.bounds.lower,
            number(&expected["lower_s"]),
            1e-3,
        );
        assert_close(
            &at,
            found.delay_upper_s(),
            number(&expected["upper_s"]),
            1e-3,
        );
        assert_close(
            &at,
            found.delays.objective,
            number(&expected["objective"]),
            1e-4,
        );
        assert_eq!(
            found.delays.matched,
            expected["matched"].as_bool().unwrap(),
            "{at}"
        );
        let leads = found.correction.leads.as_ref().unwrap();
        assert_all_close(&at, &leads.taus_s.outputs, &expected["tau_out_s"], 1e-3);
        assert_all_close(&at, &leads.taus_s.inputs, &expected["tau_in_s"], 1e-3);
        let lead_s = leads
            .filters()
            .map(|_, filter| filter.map_or(0.0, |filter| filter.lead_s()));
        assert_all_close(&at, &lead_s.inputs, &expected["lead_in_s"], 1e-3);
        assert_all_close(&at, &lead_s.outputs, &expected["lead_out_s"], 1e-3);
        assert_all_close(
            &at,
            &[found.gain_bounds().lower, found.gain_bounds().upper],
            &expected["gain_bounds"],
            1.0,
        );
        assert_all_close(&at, &found.correction.output_gains, &expected["k_out"], 1.0);
        assert_all_close(&at, &found.correction.input_gains, &expected["k_in"], 1.0);
        assert_close(
            &at,
            found.gains.objective,
            number(&expected["gain_objective"]),
            1.0,
        );
    }
}

#[test]
fn costs_of_the_example_with_leads_agree_for_each_condition_and_under_the_schedule() {
    let reference = json(REFERENCE);
    let choice = AssessmentChoice {
        model: AssessedModel::Representative,
        correction: AssessedCorrection::Scheduled,
        average: EXAMPLE_WITH_LEADS.study.settings.cost_average,
    };
    let scheduled = AssessmentTable::assess(&EXAMPLE_WITH_LEADS, choice);
    let conditions = list(&reference["example"]["conditions"]).iter();
    for (expected, under) in conditions.zip(list(&reference["example"]["scheduled"])) {
        let id = ConditionId(expected["id"].as_i64().unwrap());
        let own = &EXAMPLE_WITH_LEADS.condition(id).unwrap().cost;
        for (pair, change) in own.iter() {
            let at = format!("condition {id}, {pair:?}");
            let change = change.unwrap();
            let of =
                |name: &str, stage: usize| number(&expected[name][stage][pair.output][pair.input]);
            assert_close(&at, change.uncorrected.magnitude, of("J_mag", 0), 1.0);
            assert_close(&at, change.uncorrected.phase, of("J_phase", 0), 1.0);
            assert_close(&at, change.corrected.magnitude, of("J_mag", 1), 1.0);
            assert_close(&at, change.corrected.phase, of("J_phase", 1), 1.0);
            let change = scheduled.change(id, pair).unwrap();
            let of = |name: &str| number(&under[name][pair.output][pair.input]);
            assert_close(&at, change.corrected.magnitude, of("J_mag"), 1.0);
            assert_close(&at, change.corrected.phase, of("J_phase"), 1.0);
        }
    }
}

#[test]
fn the_schedule_of_the_example_holds_the_mean_signed_delay_of_each_channel() {
    let reference = json(REFERENCE);
    let schedule = EXAMPLE_WITH_LEADS.schedule.as_ref().unwrap();
    let at = schedule.at(77.0);
    let leads = at.leads.as_ref().unwrap();
    assert_all_close(
        "inputs",
        &leads.taus_s.inputs,
        &reference["example"]["schedule"]["tau_in_s"],
        1e-3,
    );
    assert_all_close(
        "outputs",
        &leads.taus_s.outputs,
        &reference["example"]["schedule"]["tau_out_s"],
        1e-3,
    );
    assert!(
        at.input_delays_s.iter().all(|delay_s| *delay_s == 0.0),
        "all inputs want lead"
    );
    // M15.6: in condition 4, NX requires a delay of 69 ms.
    let nx = output_named("NX");
    let apart = schedule.cautions.iter().find_map(|caution| match caution {
        ScheduleCaution::SignedDelayApart {
            channel,
            condition: ConditionId(4),
            tau_s,
            elsewhere_s,
        } if *channel == nx => Some([*tau_s, *elsewhere_s]),
        _ => None,
    });
    let apart_ms = apart.expect("NX in condition 4").map(|s| (1e3 * s).round());
    assert_eq!(apart_ms, [69.0, -17.0]);
}

fn output_named(name: &str) -> CorrectedChannel {
    let outputs = EXAMPLE_WITH_LEADS.study.dataset.outputs();
    let index = outputs.iter().position(|output| output.name == name);
    CorrectedChannel::Output(index.unwrap())
}

#[test]
fn gains_alone_are_those_of_delays_and_every_delay_is_none() {
    let mut study = study_of_example();
    let mut engine = Engine::default();
    let delay = analyze(&mut engine, &study);
    study
        .apply(&setting_table::PHASE.to(PhaseCorrection::None))
        .unwrap();
    let none = analyze(&mut engine, &study);
    study
        .apply(&setting_table::PHASE.to(PhaseCorrection::Lead))
        .unwrap();
    analyze(&mut engine, &study);
    study
        .apply(&setting_table::PHASE.to(PhaseCorrection::Delay))
        .unwrap();
    let again = analyze(&mut engine, &study);
    for (id, found) in &delay.conditions {
        let found = found.as_ref().unwrap();
        assert_eq!(
            found.correction,
            again.condition(*id).unwrap().correction,
            "to the last digit"
        );
        assert_eq!(
            found.cost,
            again.condition(*id).unwrap().cost,
            "to the last digit"
        );
        let none = &none.condition(*id).unwrap().correction;
        assert_eq!(
            (&none.input_gains, &none.output_gains),
            (
                &found.correction.input_gains,
                &found.correction.output_gains
            )
        );
        assert!(
            none.input_delays_s
                .iter()
                .chain(&none.output_delays_s)
                .all(|delay_s| *delay_s == 0.0)
        );
    }
}

#[test]
fn delays_of_the_band_are_fitted_to_the_line_through_the_phase() {
    let mut study = study_of_example();
    study
        .apply(&setting_table::DELAY_FROM.to(DelayFrom::Band))
        .unwrap();
    let analysis = analyze(&mut Engine::default(), &study);
    for (id, found) in &analysis.conditions {
        let found = found.as_ref().unwrap();
        assert_eq!(
            found.delay_problem.delta, found.comparison.delta.band_delay_s,
            "condition {id}"
        );
        assert!(found.correction.leads.is_none());
    }
}

#[test]
fn leads_that_match_are_remarked_with_the_lead_that_all_need() {
    let result = EXAMPLE_WITH_LEADS.condition(ConditionId(1)).unwrap();
    let study = &EXAMPLE_WITH_LEADS.study;
    let said = condition_remarks(study, result, None);
    assert!(
        said.iter()
            .any(|remark| matches!(remark, Remark::CommonLead { lead_s } if *lead_s > 0.0)),
        "{said:?}"
    );
    assert!(said.contains(&Remark::LeadsMatched { held: 5 }), "{said:?}");
}

#[test]
fn where_all_held_responses_want_lead_the_result_offers_it_with_what_it_buys() {
    let study = study_of_example();
    let analysis = analyze(&mut Engine::default(), &study);
    let result = analysis.condition(ConditionId(1)).unwrap();
    let offer = result.offer.unwrap();
    let held = || result.held().marked();
    let mean = |found: &gdcm_study::ConditionAnalysis| {
        held()
            .map(|pair| found.cost[pair].unwrap().corrected.total())
            .sum::<f64>()
            / held().count() as f64
    };
    assert!((offer.without - mean(result)).abs() < 1e-9, "J as it is");
    let taken = mean(EXAMPLE_WITH_LEADS.condition(ConditionId(1)).unwrap());
    // 10 %: introducing leads changes the gains slightly.
    assert!(
        (offer.with - taken).abs() < 0.1 * offer.without,
        "{offer:?}, {taken}"
    );
    let offered = condition_remarks(&study, result, None)
        .into_iter()
        .find(|remark| remark.suggested_phase().is_some())
        .unwrap();
    assert_eq!(offered, Remark::LeadsOffered(offer));
    assert_eq!(offered.suggested_phase(), Some(PhaseCorrection::Lead));
    assert!(
        EXAMPLE_WITH_LEADS
            .condition(ConditionId(1))
            .unwrap()
            .offer
            .is_none(),
        "taken already"
    );
}

/// Returns a dataset with the plant of the reference, `H_oi = g (s + q) / (s^2 + p s + p^2)`, as
/// the physics model. The identified model has known gains and signed delays in addition.
fn known(entry: &Value, plant: &Value) -> Dataset {
    let number_at = |name: &str, pair: Pair| number(&plant[name][pair.output][pair.input]);
    let pairs: Vec<Pair> = PairTable::filled(3, 2, ()).pairs().collect();
    let mut a = DMatrix::zeros(12, 12);
    let mut b = DMatrix::zeros(12, 2);
    let mut c = DMatrix::zeros(3, 12);
    for (place, &pair) in pairs.iter().enumerate() {
        let [g, p, q] = ["g", "p", "q"].map(|name| number_at(name, pair));
        let at = 2 * place;
        (a[(at, at + 1)], a[(at + 1, at)], a[(at + 1, at + 1)]) = (1.0, -p * p, -p);
        b[(at + 1, pair.input)] = 1.0;
        (c[(pair.output, at)], c[(pair.output, at + 1)]) = (g * q, g);
    }
    let dynamics = Dynamics::StateSpace(StateSpace::new(a, b, c, DMatrix::zeros(3, 2)).unwrap());
    let grid = FrequencyGrid::logarithmic(Band::new(0.5, 12.0).unwrap(), 200);
    let design = LeadDesign::new(lead_settings(entry), grid.omega().into());
    let channel = |side: &str, at: usize, omega: f64| {
        let k = numbers(&entry[format!("k_{side}")])[at];
        let tau_s = numbers(&entry[format!("tau_{side}_s")])[at];
        let factor = design
            .filter(tau_s)
            .map_or(Complex::from_polar(1.0, -omega * tau_s), |filter| {
                filter.at(omega)
            });
        factor * k
    };
    let flight = FrequencyResponse::from_dynamics(&dynamics, &grid)
        .curves()
        .map(|pair, values| {
            let factor =
                |omega: f64| channel("out", pair.output, omega) * channel("in", pair.input, omega);
            values
                .iter()
                .zip(grid.omega())
                .map(|(value, &omega)| value * factor(omega))
                .collect::<Vec<_>>()
        });
    let part = |of: fn(&Complex<f64>) -> f64| {
        flight.map(|_, values| values.iter().map(of).collect::<Vec<f64>>())
    };
    let measured = MeasuredResponse::new(
        grid.omega().to_vec(),
        &part(|value| value.re),
        &part(|value| value.im),
        None,
    )
    .unwrap();
    let physics = Model::new("nominal", Origin::Nominal { perturbation: None }, dynamics);
    let identified = Model::new(
        "flight",
        Origin::Identified {
            method: None,
            order: None,
        },
        Dynamics::Measured(measured),
    );
    let flight_state = FlightState {
        id: ConditionId(1),
        name: "known".to_owned(),
        airspeed_kt: 60.0,
        altitude: None,
        altitude_ft: None,
        weight: None,
        mass_kg: None,
    };
    let on: Vec<Vec<f64>> = list(&entry["on"]).iter().map(numbers).collect();
    let channels = |letter: &str, count| {
        (0..count)
            .map(|index| Channel::new(format!("{letter}{index}"), ""))
            .collect()
    };
    let header = DatasetHeader {
        name: "known".to_owned(),
        description: String::new(),
        inputs: channels("u", 2),
        outputs: channels("y", 3),
        on_axis: PairTable::from_fn(3, 2, |pair| {
            on.contains(&vec![pair.output as f64, pair.input as f64])
        }),
        band: Band::new(0.5, 12.0).unwrap(),
        parameters: Vec::new(),
    };
    Dataset::new(
        header,
        vec![Condition::new(flight_state, vec![physics], vec![identified]).unwrap()],
    )
    .unwrap()
}

fn lead_settings(entry: &Value) -> LeadSettings {
    let order = if entry["order"] == 1 {
        LeadOrder::First
    } else {
        LeadOrder::Second
    };
    LeadSettings {
        order,
        pole: number(&entry["pole"]),
        ..LeadSettings::default()
    }
}

#[test]
fn known_signed_delays_and_gains_are_found_again() {
    let reference = json(REFERENCE);
    for entry in list(&reference["recovers"]) {
        let name = entry["name"].as_str().unwrap();
        let mut study = Study::new(Arc::new(known(entry, &reference["plant"])));
        let lead = lead_settings(entry);
        for edit in [
            setting_table::PHASE.to(PhaseCorrection::Lead),
            setting_table::LEAD_ORDER.to(lead.order),
            setting_table::LEAD_POLE.to(lead.pole),
            setting_table::ALPHA_DELAY.to(number(&entry["alpha"])),
            setting_table::DELAY_UPPER.to(Some(0.1)),
        ] {
            study.apply(&edit).unwrap();
        }
        let analysis = analyze(&mut Engine::default(), &study);
        let result = analysis.condition(ConditionId(1)).unwrap();
        let leads = result.correction.leads.as_ref().unwrap();
        let taus = |side: &str| numbers(&entry[format!("tau_{side}_s")]);
        for (pair, wanted_s) in result.comparison.delta.band_delay_s.iter() {
            let sum_s = taus("out")[pair.output] + taus("in")[pair.input];
            assert!(
                (wanted_s.unwrap() - sum_s).abs() < 1e-6,
                "{name}: D of {pair:?}"
            );
            let found_s = result.correction.net_delay_s(pair);
            assert!(
                (found_s - sum_s).abs() < 1e-6,
                "{name}: {pair:?} {found_s} {sum_s}"
            );
        }
        // A constant may be moved from all outputs to all inputs without any change of the net
        // delays; the minimum sum of squares determines it.
        let constant_s = leads.taus_s.inputs[0] - taus("in")[0];
        for (at, tau_s) in taus("out").iter().enumerate() {
            assert!(
                (leads.taus_s.outputs[at] + constant_s - tau_s).abs() < 1e-6,
                "{name}"
            );
        }
        for (at, gain) in list(&entry["on"])
            .iter()
            .map(numbers)
            .zip(numbers(&entry["net_gain_on"]))
        {
            let pair = Pair::new(at[0] as usize, at[1] as usize);
            assert!(
                (result.correction.net_gain(pair) / gain - 1.0).abs() < 1e-3,
                "{name}: {pair:?}"
            );
        }
        assert_eq!(
            leads.filters()[CorrectedChannel::Input(0)].is_some(),
            leads.taus_s.inputs[0] < 0.0
        );
    }
}

#[test]
fn what_a_response_wants_has_the_bar_of_whole_analyses_with_each_model_pinned() {
    let mut engine = Engine::default();
    let analysis = analyze(&mut engine, &with_leads());
    let sure = engine.uncertainty(&analysis, &Unobserved).unwrap();
    let id = ConditionId(1);
    let study = &analysis.study;
    let result = analysis.condition(id).unwrap();
    let words = lead_words(study, result, Some(&sure));
    let with_bar = |of: &String| {
        of.starts_with("LAT → P ")
            && [" 65 ± ", " 24 ms ", " 41 ms "]
                .iter()
                .all(|part| of.contains(part))
    };
    assert!(words.iter().any(with_bar), "{words:?}");
    // The tau of a channel with another physics model as the representative equals its tau in a
    // whole analysis in which that model is pinned.
    let channel = CorrectedChannel::Input(study.dataset.find_pair("P", "LAT").unwrap().input);
    let representative = result.representative_name(BundleKind::Physics);
    let condition = study.dataset.condition(id).unwrap();
    let others: Vec<&str> = condition
        .bundle(BundleKind::Physics)
        .iter()
        .map(|model| model.name.as_str())
        .filter(|name| *name != representative)
        .collect();
    // A dataset with this condition alone: no other condition influences it.
    let alone = Dataset::new(study.dataset.header(), vec![condition.as_ref().clone()]).unwrap();
    let mut alone = Study::new(Arc::new(alone));
    alone.settings = study.settings.clone();
    let mut engine = Engine::default();
    let mut tau_s = |study: &Study| {
        let analysis = analyze(&mut engine, study);
        analysis
            .condition(id)
            .unwrap()
            .correction
            .leads
            .as_ref()
            .unwrap()
            .taus_s[channel]
    };
    let own_s = tau_s(&alone);
    let squares = others.iter().map(|name| {
        let mut pinned = alone.clone();
        let identified = result.representative_name(BundleKind::Identified);
        pinned
            .apply(&Edit::Pin(ModelId::new(id, BundleKind::Physics, *name)))
            .unwrap();
        pinned
            .apply(&Edit::Pin(ModelId::new(
                id,
                BundleKind::Identified,
                identified,
            )))
            .unwrap();
        (tau_s(&pinned) - own_s).powi(2)
    });
    let variance = squares.sum::<f64>() / others.len() as f64;
    let bar = sure.conditions[&id].bars[Scalar::ChannelDelay(channel)]
        .as_ref()
        .unwrap();
    let trim = bar.trim.as_ref().unwrap().variance;
    assert!(
        bar.value < 0.0 && (bar.value - own_s).abs() < 1e-12,
        "a lead: {}",
        bar.value
    );
    // Both values are from the same analyses; they differ by the rounding of the convex solver.
    assert!(
        (trim - variance).abs() <= 1e-6 * variance,
        "{trim} {variance}"
    );
}
