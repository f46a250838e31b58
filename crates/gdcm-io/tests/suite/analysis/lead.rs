//! Leads: comparison with the independent analysis of the example, and recovery of known signed
//! delays (M15).

use std::sync::Arc;

use gdcm_method::correction::Channel;
use gdcm_method::correction::lead_design::{LeadDesign, LeadSettings};
use gdcm_method::schedule::ScheduleCaution;
use gdcm_method::uncertainty::Scalar;
use gdcm_model::dataset::{Band, Dataset, ModelId};
use gdcm_model::response::LeadOrder;
use gdcm_study::decisions::settings::DelayFrom;
use gdcm_study::results::assessment_table::{AssessedModel, AssessmentChoice};
use gdcm_study::results::condition_remarks::condition_remarks;
use gdcm_study::results::remark::Remark;
use gdcm_study::{AssessedCorrection, AssessmentTable, ConditionAnalysis, PhaseCorrection};
use gdcm_words::leads::lead_words;

use super::measured_flight::{dataset_with_flight, flight_state, measured_response};
use super::*;

/// Results of an independent implementation: `example`, `recovers` with its `plant`.
const REFERENCE: &str = include_str!("../../../../../tests/data/reference/lead.json");

/// Analysis of the example with leads; no model is rejected.
static EXAMPLE_WITH_LEADS: LazyLock<Analysis> =
    LazyLock::new(|| analyze(&mut Engine::default(), &with_leads()));

fn with_leads() -> Study {
    let mut study = study_of_example();
    study
        .apply(&setting_table::PHASE.to(PhaseCorrection::Lead))
        .unwrap();
    study
}

#[test]
fn signed_delays_filters_and_gains_of_the_example_match_the_reference() {
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
                scale::DELAY_S,
            );
            assert_close(
                &at,
                found.delta_gain(pair).unwrap(),
                number(&expected["G"][pair.output][pair.input]),
                scale::GAIN,
            );
        }
        assert_close(
            &at,
            found.delay_problem.bounds.lower,
            number(&expected["lower_s"]),
            scale::DELAY_S,
        );
        assert_close(
            &at,
            found.delay_upper_s(),
            number(&expected["upper_s"]),
            scale::DELAY_S,
        );
        assert_close(
            &at,
            found.delays.objective,
            number(&expected["objective"]),
            scale::DELAY_OBJECTIVE,
        );
        assert_eq!(
            found.delays.matched,
            expected["matched"].as_bool().unwrap(),
            "{at}"
        );
        let leads = found.correction.leads.as_ref().unwrap();
        assert_all_close(
            &at,
            &leads.taus_s.outputs,
            &expected["tau_out_s"],
            scale::DELAY_S,
        );
        assert_all_close(
            &at,
            &leads.taus_s.inputs,
            &expected["tau_in_s"],
            scale::DELAY_S,
        );
        let lead_s = leads
            .filters()
            .map(|_, filter| filter.map_or(0.0, |filter| filter.lead_s()));
        assert_all_close(&at, &lead_s.inputs, &expected["lead_in_s"], scale::DELAY_S);
        assert_all_close(
            &at,
            &lead_s.outputs,
            &expected["lead_out_s"],
            scale::DELAY_S,
        );
        assert_all_close(
            &at,
            &[found.gain_bounds().lower, found.gain_bounds().upper],
            &expected["gain_bounds"],
            scale::GAIN,
        );
        assert_all_close(
            &at,
            &found.correction.output_gains,
            &expected["k_out"],
            scale::GAIN,
        );
        assert_all_close(
            &at,
            &found.correction.input_gains,
            &expected["k_in"],
            scale::GAIN,
        );
        assert_close(
            &at,
            found.gains.objective,
            number(&expected["gain_objective"]),
            scale::GAIN,
        );
    }
}

#[test]
fn costs_of_the_example_with_leads_match_the_reference() {
    let reference = json(REFERENCE);
    let choice = AssessmentChoice {
        model: AssessedModel::Representative,
        correction: AssessedCorrection::Scheduled,
        average: EXAMPLE_WITH_LEADS.study.settings.cost_average,
    };
    let scheduled = AssessmentTable::assess(&EXAMPLE_WITH_LEADS, choice);
    let conditions = list(&reference["example"]["conditions"]).iter();
    for (expected, under_schedule) in conditions.zip(list(&reference["example"]["scheduled"])) {
        let id = ConditionId(expected["id"].as_i64().unwrap());
        let own = &EXAMPLE_WITH_LEADS.condition(id).unwrap().cost;
        for (pair, change) in own.iter() {
            let at = format!("condition {id}, {pair:?}");
            let change = change.unwrap();
            let entry = |table: &Value| number(&table[pair.output][pair.input]);
            // Stage 0 is before the correction, stage 1 after it.
            let magnitude = &expected["J_mag"];
            let phase = &expected["J_phase"];
            assert_close(
                &at,
                change.uncorrected.magnitude,
                entry(&magnitude[0]),
                scale::COST,
            );
            assert_close(&at, change.uncorrected.phase, entry(&phase[0]), scale::COST);
            assert_close(
                &at,
                change.corrected.magnitude,
                entry(&magnitude[1]),
                scale::COST,
            );
            assert_close(&at, change.corrected.phase, entry(&phase[1]), scale::COST);
            let change = scheduled.change(id, pair).unwrap();
            let magnitude = &under_schedule["J_mag"];
            let phase = &under_schedule["J_phase"];
            assert_close(
                &at,
                change.corrected.magnitude,
                entry(magnitude),
                scale::COST,
            );
            assert_close(&at, change.corrected.phase, entry(phase), scale::COST);
        }
    }
}

#[test]
fn the_schedule_has_the_mean_signed_delay_of_each_channel() {
    let reference = json(REFERENCE);
    let schedule = EXAMPLE_WITH_LEADS.schedule.as_ref().unwrap();
    let at = schedule.at(77.0);
    let leads = at.leads.as_ref().unwrap();
    assert_all_close(
        "inputs",
        &leads.taus_s.inputs,
        &reference["example"]["schedule"]["tau_in_s"],
        scale::DELAY_S,
    );
    assert_all_close(
        "outputs",
        &leads.taus_s.outputs,
        &reference["example"]["schedule"]["tau_out_s"],
        scale::DELAY_S,
    );
    assert!(
        at.input_delays_s.iter().all(|delay_s| *delay_s == 0.0),
        "all inputs need lead, so none has a delay"
    );
    // M15.6: in condition 4, NX needs a delay of 69 ms; elsewhere it needs a lead of 17 ms.
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

fn output_named(name: &str) -> Channel {
    let outputs = EXAMPLE_WITH_LEADS.study.dataset.outputs();
    let index = outputs.iter().position(|output| output.name == name);
    Channel::Output(index.unwrap())
}

#[test]
fn without_phase_correction_the_gains_are_those_with_delays_and_all_delays_are_zero() {
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
fn delays_from_the_band_are_fitted_to_the_slope_of_the_phase() {
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
fn matched_leads_are_reported_with_the_lead_common_to_all_responses() {
    let result = EXAMPLE_WITH_LEADS.condition(ConditionId(1)).unwrap();
    let study = &EXAMPLE_WITH_LEADS.study;
    let remarks = condition_remarks(study, result, None);
    assert!(
        remarks
            .iter()
            .any(|remark| matches!(remark, Remark::CommonLead { lead_s } if *lead_s > 0.0)),
        "{remarks:?}"
    );
    assert!(
        remarks.contains(&Remark::LeadsMatched { held: 5 }),
        "{remarks:?}"
    );
}

#[test]
fn leads_are_offered_with_their_benefit_if_all_held_responses_need_lead() {
    let study = study_of_example();
    let analysis = analyze(&mut Engine::default(), &study);
    let result = analysis.condition(ConditionId(1)).unwrap();
    let offer = result.offer.unwrap();
    let held: Vec<Pair> = result.held().marked().collect();
    let mean_cost = |found: &ConditionAnalysis| {
        let costs = held
            .iter()
            .map(|pair| found.cost[*pair].unwrap().corrected.total());
        costs.sum::<f64>() / held.len() as f64
    };
    assert!(
        (offer.without - mean_cost(result)).abs() < 1e-9,
        "mean J without leads"
    );
    let with_leads = mean_cost(EXAMPLE_WITH_LEADS.condition(ConditionId(1)).unwrap());
    // 10 %: introducing leads changes the gains slightly.
    assert!(
        (offer.with - with_leads).abs() < 0.1 * offer.without,
        "{offer:?}, mean J with leads {with_leads}"
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
        "leads are not offered where they are in use"
    );
}

/// Returns a dataset with the plant of the reference, `H_oi = g (s + q) / (s^2 + p s + p^2)`, as
/// the physics model. The identified model has the known gains and signed delays of `entry` in
/// addition; a negative delay is a lead filter.
fn dataset_of_known_delays(entry: &Value, plant: &Value) -> Dataset {
    let number_at = |name: &str, pair: Pair| number(&plant[name][pair.output][pair.input]);
    let pairs: Vec<Pair> = PairTable::filled(3, 2, ()).pairs().collect();
    let mut a = DMatrix::zeros(12, 12);
    let mut b = DMatrix::zeros(12, 2);
    let mut c = DMatrix::zeros(3, 12);
    for (place, &pair) in pairs.iter().enumerate() {
        let [g, p, q] = ["g", "p", "q"].map(|name| number_at(name, pair));
        let at = 2 * place;
        a[(at, at + 1)] = 1.0;
        a[(at + 1, at)] = -p * p;
        a[(at + 1, at + 1)] = -p;
        b[(at + 1, pair.input)] = 1.0;
        c[(pair.output, at)] = g * q;
        c[(pair.output, at + 1)] = g;
    }
    let dynamics = Dynamics::StateSpace(StateSpace::new(a, b, c, DMatrix::zeros(3, 2)).unwrap());
    let grid = FrequencyGrid::logarithmic(Band::new(0.5, 12.0).unwrap(), 200);
    let design = LeadDesign::new(lead_settings(entry), grid.omega().into());
    let channel_factor = |side: &str, index: usize, omega: f64| {
        let k = numbers(&entry[format!("k_{side}")])[index];
        let tau_s = numbers(&entry[format!("tau_{side}_s")])[index];
        // A lead has a filter; a delay turns the phase.
        let factor = match design.filter(tau_s) {
            Some(filter) => filter.at(omega),
            None => Complex::from_polar(1.0, -omega * tau_s),
        };
        factor * k
    };
    let flight = FrequencyResponse::from_dynamics(&dynamics, &grid)
        .curves()
        .map(|pair, values| {
            let mut flight = Vec::with_capacity(values.len());
            for (value, &omega) in values.iter().zip(grid.omega()) {
                let output_factor = channel_factor("out", pair.output, omega);
                let input_factor = channel_factor("in", pair.input, omega);
                flight.push(value * (output_factor * input_factor));
            }
            flight
        });
    let measured = measured_response(&grid, &flight, None);
    let on_axis: Vec<Vec<f64>> = list(&entry["on"]).iter().map(numbers).collect();
    let on_axis = PairTable::from_fn(3, 2, |pair| {
        on_axis.contains(&vec![pair.output as f64, pair.input as f64])
    });
    dataset_with_flight(flight_state("known", 60.0), dynamics, measured, on_axis)
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
fn known_signed_delays_and_gains_are_recovered() {
    let reference = json(REFERENCE);
    for entry in list(&reference["recovers"]) {
        let name = entry["name"].as_str().unwrap();
        let mut study = Study::new(Arc::new(dataset_of_known_delays(
            entry,
            &reference["plant"],
        )));
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
        for (pair, delta_delay_s) in result.comparison.delta.band_delay_s.iter() {
            let sum_s = taus("out")[pair.output] + taus("in")[pair.input];
            assert!(
                (delta_delay_s.unwrap() - sum_s).abs() < 1e-6,
                "{name}: D of {pair:?}"
            );
            let found_s = result.correction.net_delay_s(pair);
            assert!(
                (found_s - sum_s).abs() < 1e-6,
                "{name}: net delay of {pair:?} is {found_s} s instead of {sum_s} s"
            );
        }
        // A constant may be moved from all outputs to all inputs without any change of the net
        // delays; the minimum sum of squares determines it.
        let constant_s = leads.taus_s.inputs[0] - taus("in")[0];
        for (at, tau_s) in taus("out").iter().enumerate() {
            assert!(
                (leads.taus_s.outputs[at] + constant_s - tau_s).abs() < 1e-6,
                "{name}: tau of output {at}"
            );
        }
        let on_axis = list(&entry["on"]).iter().map(numbers);
        for (indices, gain) in on_axis.zip(numbers(&entry["net_gain_on"])) {
            let pair = Pair::new(indices[0] as usize, indices[1] as usize);
            assert!(
                (result.correction.net_gain(pair) / gain - 1.0).abs() < 1e-3,
                "{name}: net gain of {pair:?}"
            );
        }
        assert_eq!(
            leads.filters()[Channel::Input(0)].is_some(),
            leads.taus_s.inputs[0] < 0.0
        );
    }
}

#[test]
fn the_bar_of_a_lead_is_the_scatter_of_analyses_with_each_physics_model_pinned() {
    let mut engine = Engine::default();
    let analysis = analyze(&mut engine, &with_leads());
    let uncertainty = engine.uncertainty(&analysis, &Unobserved).unwrap();
    let id = ConditionId(1);
    let study = &analysis.study;
    let result = analysis.condition(id).unwrap();
    let words = lead_words(study, result, Some(&uncertainty));
    let sentence = words.iter().find(|line| line.starts_with("LAT → P "));
    let sentence = sentence.unwrap_or_else(|| panic!("no line about LAT → P: {words:?}"));
    // 65 ms over the band, of which 24 ms at P and 41 ms at LAT.
    for part in [" 65 ± ", " 24 ms ", " 41 ms "] {
        assert!(sentence.contains(part), "{part:?} is not in {sentence:?}");
    }
    // The tau of a channel with another physics model as the representative equals its tau in a
    // whole analysis in which that model is pinned.
    let channel = Channel::Input(study.dataset.find_pair("P", "LAT").unwrap().input);
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
    let identified = result.representative_name(BundleKind::Identified);
    let mut squares = 0.0;
    for name in &others {
        let mut pinned = alone.clone();
        for model in [
            ModelId::new(id, BundleKind::Physics, *name),
            ModelId::new(id, BundleKind::Identified, identified),
        ] {
            pinned.apply(&Edit::Pin(model)).unwrap();
        }
        squares += (tau_s(&pinned) - own_s).powi(2);
    }
    let variance = squares / others.len() as f64;
    let bar = uncertainty.conditions[&id].bars[Scalar::ChannelDelay(channel)]
        .as_ref()
        .unwrap();
    let trim = bar.trim.as_ref().unwrap().variance;
    assert!(
        bar.value < 0.0 && (bar.value - own_s).abs() < 1e-12,
        "the bar is of {} s, the lead is {own_s} s",
        bar.value
    );
    // Both values are from the same analyses; they differ by the rounding of the convex solver.
    assert!(
        (trim - variance).abs() <= 1e-6 * variance,
        "variance {trim} in the bar, {variance} over the analyses"
    );
}
