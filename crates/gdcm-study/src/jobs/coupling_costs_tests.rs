//! Benefit and cost of couplings, in the example and in small studies.

use std::sync::{Arc, LazyLock};

use nalgebra::DMatrix;

use gdcm_method::couplings::{CouplingMatrices, Unknown};
use gdcm_method::schedule::Airspeeds;
use gdcm_model::dataset::condition::FlightState;
use gdcm_model::dataset::dataset::DatasetHeader;
use gdcm_model::dataset::model::Origin;
use gdcm_model::dataset::{
    Band, Channel, Condition, ConditionId, Dataset, Dynamics, Model, Pair, PairTable, StateSpace,
};
use gdcm_model::progress::Unobserved;

use super::analysis_jobs::CouplingsJob;
use super::couplings_tests::{
    COUPLED, EXAMPLE, REFERENCE, assert_close, engine, own_and_scheduled,
};
use super::job::Job;
use crate::decisions::edit::Edit;
use crate::decisions::setting_table;
use crate::decisions::settings::{CouplingCorrection, PhaseCorrection};
use crate::decisions::study::Study;
use crate::reference_tests::{list, number, numbers};
use crate::results::correction_costs::AxisCost;
use crate::results::couplings_assessment::{AssessedCouplings, CouplingsAssessment};
use crate::stages::engine::Engine;

/// Assessment of mixing and feedback, for the reference dataset.
static ASSESSED: LazyLock<Arc<CouplingsAssessment>> = LazyLock::new(|| {
    assess(CouplingCorrection::MixingAndFeedback)
        .unwrap()
        .unwrap()
});

/// Assesses couplings for the reference dataset; `None` without couplings.
fn assess(couplings: CouplingCorrection) -> Option<AssessedCouplings> {
    let job = CouplingsJob {
        study: EXAMPLE.analysis.study.clone(),
        couplings,
    };
    job.run(&mut engine(), &Unobserved).unwrap()
}

/// Returns `[on-axis, others]`.
fn on_axis_and_others(cost: AxisCost) -> Vec<f64> {
    vec![cost.on_axis.unwrap(), cost.others.unwrap()]
}

#[test]
fn costs_without_and_with_couplings_are_those_of_the_two_studies() {
    let costs = &ASSESSED.costs;
    let mean_cost = &REFERENCE["example"]["feedback"]["mean_J"];
    let tolerance = number(&REFERENCE["tolerance"]["mean_J"]);
    assert_close(
        "own",
        &on_axis_and_others(costs.own.with),
        &numbers(&mean_cost["own"]),
        tolerance,
    );
    assert_close(
        "scheduled",
        &on_axis_and_others(costs.scheduled.with),
        &numbers(&mean_cost["scheduled"]),
        tolerance,
    );
    let [own, scheduled] = own_and_scheduled(&EXAMPLE.analysis);
    // 1e-9: both sides add the same terms, in a different order.
    assert_close(
        "own, without",
        &on_axis_and_others(costs.own.without),
        &own,
        1e-9,
    );
    assert_close(
        "scheduled, without",
        &on_axis_and_others(costs.scheduled.without),
        &scheduled,
        1e-9,
    );
}

#[test]
fn a_condition_left_out_is_in_neither_the_fit_nor_the_schedule_that_judge_it() {
    let left_out = ASSESSED.costs.left_out.unwrap();
    let [unseen, seen] = [left_out, ASSESSED.costs.scheduled].map(|cost| cost.with.others.unwrap());
    assert!(
        unseen > seen,
        "off-axis J of left-out conditions should exceed that of fitted ones: {unseen} {seen}"
    );
    // Couplings are worth it from a tenth on (M16.4); for the example they save over 40 %.
    assert!(
        left_out.is_worth_it() && unseen < 0.6 * left_out.without.others.unwrap(),
        "{left_out:?}"
    );
    assert_eq!(ASSESSED.left_out_fits.len(), 11, "one for each condition");
    // The fit without a condition is that of a study in which the condition is held out.
    let id = ASSESSED.left_out_fits[3].condition;
    let mut study = COUPLED.1.study.clone();
    study
        .apply(&Edit::SetHeldOut {
            condition: id,
            held_out: true,
        })
        .unwrap();
    let analysis = engine().analyze(&study, &Unobserved).unwrap();
    assert_eq!(
        analysis.fitted_couplings().unwrap().fit,
        ASSESSED.left_out_fits[3].fit
    );
    assert!(
        ASSESSED.conditions[&id]
            .left_out
            .unwrap()
            .with
            .others
            .unwrap()
            > 0.0
    );
}

#[test]
fn every_condition_has_poles_a_margin_and_changes_above_the_band() {
    let band = EXAMPLE.dataset.band();
    // The margin is evaluated from a tenth of the lower band end on.
    assert!((ASSESSED.omega[0] / band.min() - 0.1).abs() < 1e-9);
    for condition in ASSESSED.conditions.values() {
        let poles = condition.poles.as_ref().unwrap();
        assert!(
            poles
                .iter()
                .any(|shift| shift.distance_rad_s().unwrap() > 1e-3),
            "feedback moves poles"
        );
        let margin = condition.margin.unwrap();
        // 1 is no loop; below 0.5 the loop is close to ringing (M16.4). The limit leaves room below
        // the minimum for another dataset of the same helicopter, which is 0.87.
        assert!(
            margin.least > 0.8 && margin.omega_rad_s >= band.min(),
            "{margin:?}"
        );
        let (_, change_db) = condition
            .most_changed_above_band(EXAMPLE.dataset.on_axis())
            .unwrap();
        // The largest rise of an on-axis response at ten times the band is below a factor of 2.
        assert!(change_db < 6.0 && change_db > -60.0, "{change_db}");
    }
    assert!(
        ASSESSED
            .unstable
            .iter()
            .all(|unstable| !unstable.is_in_band && unstable.pole.re > 0.0)
    );
}

#[test]
fn mixing_alone_moves_no_pole_and_no_couplings_are_not_assessed() {
    assert!(assess(CouplingCorrection::None).is_none());
    let mixing = assess(CouplingCorrection::Mixing).unwrap().unwrap();
    for condition in mixing.conditions.values() {
        assert!(
            condition
                .poles
                .as_ref()
                .unwrap()
                .iter()
                .all(|shift| shift.distance_rad_s() == Some(0.0))
        );
        assert_eq!(condition.margin.unwrap().least, 1.0, "1 is no loop");
    }
    let mean_cost = &REFERENCE["example"]["mixing"]["mean_J"];
    assert_close(
        "own",
        &on_axis_and_others(mixing.costs.own.with),
        &numbers(&mean_cost["own"]),
        1e-3,
    );
    assert_eq!(list(&mean_cost["own"]).len(), 2, "on-axis and others");
}

/// Builds a stable aircraft with this many outputs and inputs, and one state for each response: a
/// lag with a gain of 4 on axis and 0.5 off axis. Responses for which `exists` is false are zero.
fn aircraft(outputs: usize, inputs: usize, exists: impl Fn(Pair) -> bool) -> StateSpace {
    let states = outputs * inputs;
    let pair_of = |state: usize| Pair::new(state / inputs, state % inputs);
    let a = DMatrix::from_fn(states, states, |row, column| {
        if row == column {
            -0.8 - 0.3 * row as f64
        } else {
            0.0
        }
    });
    let b = DMatrix::from_fn(states, inputs, |state, input| {
        if pair_of(state).input == input {
            1.0
        } else {
            0.0
        }
    });
    let c = DMatrix::from_fn(outputs, states, |output, state| {
        let pair = pair_of(state);
        if pair.output != output || !exists(pair) {
            0.0
        } else if pair.output == pair.input {
            4.0
        } else {
            0.5
        }
    });
    StateSpace::new(a, b, c, DMatrix::zeros(outputs, inputs)).unwrap()
}

/// Mixing of the first input into the last, added to the flight models of [`small_study`].
const MIXING: f64 = 0.08;
/// Feedback of the last output to the first input, added to the flight models of [`small_study`].
const FEEDBACK: f64 = -0.05;

/// Builds the couplings with [`MIXING`] and [`FEEDBACK`].
fn flown_couplings(outputs: usize, inputs: usize) -> CouplingMatrices {
    let mut unknowns = Vec::new();
    let mut values = Vec::new();
    for input in 0..inputs {
        unknowns.push(Unknown::Mixing {
            to: input,
            from: input,
            power: 0,
        });
        values.push(1.0);
    }
    unknowns.push(Unknown::Mixing {
        to: inputs - 1,
        from: 0,
        power: 0,
    });
    values.push(MIXING);
    unknowns.push(Unknown::Feedback {
        input: 0,
        output: outputs - 1,
    });
    values.push(FEEDBACK);
    let airspeeds = Airspeeds::new(vec![40.0], 2.0).unwrap();
    CouplingMatrices::none(airspeeds, inputs, outputs).with(&unknowns, &values)
}

/// Builds a condition whose flight model is the physics model with couplings.
fn coupled_condition(id: i64, physics: &StateSpace, couplings: &CouplingMatrices) -> Condition {
    let flight = couplings.model(physics, 40.0, Default::default()).unwrap();
    let nominal = Model::new(
        "nominal",
        Origin::Nominal { perturbation: None },
        Dynamics::StateSpace(physics.clone()),
    );
    let flight = Model::new(
        "flight",
        Origin::Identified {
            method: None,
            order: None,
        },
        Dynamics::StateSpace(flight),
    );
    let state = FlightState::at(ConditionId(id), 40.0 + 20.0 * id as f64);
    Condition::new(state, vec![nominal], vec![flight]).unwrap()
}

/// Returns channels named by a letter and a number from 1 on.
fn numbered_channels(letter: &str, count: usize, unit: &str) -> Vec<Channel> {
    (1..=count)
        .map(|number| Channel::new(format!("{letter}{number}"), unit))
        .collect()
}

/// Builds a study of [`aircraft`] models: the flight models add a little mixing and feedback, and
/// the channels are corrected by gains only.
fn small_study(
    outputs: usize,
    inputs: usize,
    conditions: i64,
    exists: impl Fn(Pair) -> bool,
) -> Study {
    let physics = aircraft(outputs, inputs, exists);
    let couplings = flown_couplings(outputs, inputs);
    let header = DatasetHeader {
        name: "small".into(),
        description: String::new(),
        inputs: numbered_channels("U", inputs, "%"),
        outputs: numbered_channels("Y", outputs, "deg/s"),
        on_axis: PairTable::from_fn(outputs, inputs, |pair| pair.output == pair.input),
        band: Band::new(0.5, 10.0).unwrap(),
        parameters: Vec::new(),
    };
    let mut study = Study::new(Arc::new(
        Dataset::new(
            header,
            (1..=conditions)
                .map(|id| coupled_condition(id, &physics, &couplings))
                .collect(),
        )
        .unwrap(),
    ));
    study
        .apply(&setting_table::PHASE.to(PhaseCorrection::None))
        .unwrap();
    study
        .apply(&setting_table::COUPLINGS.to(CouplingCorrection::MixingAndFeedback))
        .unwrap();
    study
}

#[test]
fn very_small_studies_have_finite_couplings_that_lower_the_costs() {
    for (outputs, inputs, conditions) in [(2, 2, 1), (1, 1, 2), (1, 3, 3), (3, 2, 4)] {
        let study = small_study(outputs, inputs, conditions, |_| true);
        let analysis = Engine::default().analyze(&study, &Unobserved).unwrap();
        let case = format!("{outputs} outputs, {inputs} inputs, {conditions} conditions");
        let fitted = analysis
            .fitted_couplings()
            .unwrap_or_else(|| panic!("{case}: {:?}", analysis.couplings));
        assert!(
            fitted
                .fit
                .coefficients
                .iter()
                .flatten()
                .all(|value| value.is_finite()),
            "{case}"
        );
        let assessed = Engine::default()
            .assess_couplings(&study, study.settings.couplings, &Unobserved)
            .unwrap();
        let assessed = assessed.unwrap().unwrap();
        assert_eq!(assessed.costs.left_out.is_some(), conditions >= 3, "{case}");
        assert_eq!(
            assessed.left_out_fits.is_empty(),
            conditions < 3,
            "{case}: error bars need three conditions"
        );
        // The flight models differ from the physics models by couplings alone, so that hardly any
        // mismatch is left.
        let own = assessed.costs.own.with;
        assert!(
            own.on_axis.unwrap() < 1.0 && own.others.is_none_or(|others| others < 1.0),
            "{case}: {own:?}"
        );
    }
}

#[test]
fn couplings_are_recovered_when_a_response_is_zero_in_every_model() {
    let study = small_study(2, 2, 3, |pair| pair != Pair::new(0, 1));
    let analysis = Engine::default().analyze(&study, &Unobserved).unwrap();
    let matrices = analysis.fitted_couplings().unwrap().matrices();
    // 1e-3: the ridge term of the fit shifts the entries by about a thousandth.
    assert!(
        (matrices.normalised_mixing(60.0)[(1, 0)] - MIXING).abs() < 1e-3,
        "{matrices:?}"
    );
    assert!(
        (matrices.feedback()[(0, 1)] - FEEDBACK).abs() < 1e-3,
        "{matrices:?}"
    );
}

#[test]
fn an_entry_may_be_zero_if_and_only_if_it_is_within_its_error_bar() {
    let mixing = ASSESSED.mixing(ASSESSED.mean_airspeed_kt());
    for entry in mixing.iter() {
        let Some(half_width) = entry.half_width else {
            continue;
        };
        // The diagonal is 1 by definition and never zero.
        assert!(entry.may_be_zero == (entry.value.abs() <= half_width) || entry.value == 1.0);
        assert!(
            entry.deviation.unwrap() <= half_width,
            "Student's two-sided 90 % quantile is above 1, so that a bar exceeds its deviation"
        );
    }
    assert!(
        mixing
            .diagonal()
            .iter()
            .all(|entry| entry.value == 1.0 && !entry.may_be_zero)
    );
    assert!(ASSESSED.feedback().iter().any(|entry| entry.may_be_zero));
}

#[test]
fn conditions_with_a_lead_offer_are_counted_while_leads_are_off() {
    assert_eq!(ASSESSED.unused_lead_offers, 0, "leads are on");
    let mut study = EXAMPLE.analysis.study.clone();
    study
        .apply(&setting_table::PHASE.to(PhaseCorrection::Delay))
        .unwrap();
    let assessed = engine()
        .assess_couplings(&study, CouplingCorrection::MixingAndFeedback, &Unobserved)
        .unwrap()
        .unwrap()
        .unwrap();
    assert!(assessed.unused_lead_offers > 0);
}
