//! The trade-off of α on the example, against direct analyses.

use gdcm_method::schedule::assessment::corrected_cost_on;
use gdcm_model::dataset::ConditionId;
use gdcm_model::progress::Unobserved;

use super::couplings_tests::EXAMPLE;
use super::job::Job;
use super::trade_off_job::{TradeOffJob, TradeOffPoint};
use crate::decisions::setting_table;
use crate::decisions::settings::PhaseCorrection;
use crate::decisions::study::Study;
use crate::results::analysis::Analysis;
use crate::stages::engine::Engine;

const CONDITION: ConditionId = ConditionId(10);

fn analysis(engine: &mut Engine, phase: PhaseCorrection, alpha: f64) -> Analysis {
    let mut study = Study::new(EXAMPLE.dataset.clone());
    study.apply(&setting_table::PHASE.to(phase)).unwrap();
    study.apply(&setting_table::ALPHA_GAIN.to(alpha)).unwrap();
    engine.analyze(&study, &Unobserved).unwrap()
}

/// Returns the trade-off point of an analysis of the whole study.
fn analysed_point(analysis: &Analysis) -> TradeOffPoint {
    let result = analysis.condition(CONDITION).unwrap();
    let average = analysis.study.settings.cost_average;
    TradeOffPoint::new(result, &result.correction, &analysis.omega, average).unwrap()
}

fn assert_close(found: f64, expected: f64) {
    // The same problem is solved to the same tolerance; only the proof budgets differ.
    assert!(
        (found - expected).abs() <= 1e-6 * expected.abs().max(1.0),
        "{found} instead of {expected}"
    );
}

#[test]
fn the_trade_off_agrees_with_direct_analyses() {
    let mut engine = Engine::default();
    for phase in [PhaseCorrection::Delay, PhaseCorrection::Lead] {
        let present = analysis(&mut engine, phase, 1.0);
        let job = TradeOffJob::new(&present, CONDITION).unwrap();
        let trade_off = job.run(&mut (), &Unobserved).unwrap().unwrap();
        assert_eq!(trade_off.points.len(), 25, "three decades either side of 1");
        for alpha in [1e-2, 1.0, 10.0, 1e3] {
            let expected = analysed_point(&analysis(&mut engine, phase, alpha));
            let found = trade_off
                .points
                .iter()
                .find(|point| (point.alpha / alpha - 1.0).abs() < 1e-9)
                .unwrap();
            assert_close(found.output_deviation, expected.output_deviation);
            assert_close(found.mean_cost, expected.mean_cost);
        }
        for neighbours in trade_off.points.windows(2) {
            // Tolerance: the accuracy of the solver.
            assert!(
                neighbours[1].output_deviation <= neighbours[0].output_deviation + 1e-6,
                "a greater weight should bring the output gains closer to 1: {neighbours:?}"
            );
        }
    }
}

#[test]
fn a_change_of_alpha_alone_leaves_the_trade_off_valid() {
    let mut engine = Engine::default();
    let job = |analysis: &Analysis| TradeOffJob::new(analysis, CONDITION).unwrap();
    let before = job(&analysis(&mut engine, PhaseCorrection::Delay, 1.0));
    assert_eq!(
        job(&analysis(&mut engine, PhaseCorrection::Delay, 8.0)),
        before
    );
    assert_ne!(
        job(&analysis(&mut engine, PhaseCorrection::Lead, 1.0)),
        before
    );
}

#[test]
fn the_costs_of_a_response_agree_with_the_results_of_the_conditions() {
    let analysis = analysis(&mut Engine::default(), PhaseCorrection::Delay, 1.0);
    let pair = analysis.study.settings.constrained.marked().next().unwrap();
    let costs = analysis.response_costs(pair);
    assert_eq!(costs.len(), analysis.conditions.len());
    for cost in costs {
        let result = analysis.condition(cost.condition).unwrap();
        let change = result.cost[pair].unwrap();
        assert_eq!(cost.before, change.uncorrected);
        assert_eq!(cost.optimum, change.corrected);
        assert_eq!(
            cost.airspeed_kt,
            result.condition.flight_state().airspeed_kt
        );
        let schedule = analysis.schedule.as_ref().unwrap();
        let expected = corrected_cost_on(
            result.comparison.representative.mismatch[pair]
                .as_ref()
                .unwrap(),
            &schedule.at_state(result.condition.flight_state()),
            pair,
            &analysis.omega,
            analysis.study.settings.cost_average,
        );
        assert_eq!(cost.scheduled, expected);
        assert!(cost.scheduled.is_some());
    }
}
