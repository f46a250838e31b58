//! Assessment of the schedule, evidence for the kinds of schedule, and optional scheduling of
//! delays.

use std::sync::Arc;

use gdcm_method::fidelity::CostAverage;
use gdcm_method::schedule::form_comparison::SCHEDULE_KINDS;
use gdcm_method::schedule::{DelayScheduling, ScheduleKind};
use gdcm_study::jobs::analysis_jobs::AssessmentJob;
use gdcm_study::jobs::job::Job;
use gdcm_study::results::assessment_table::{
    AssessedCorrection, AssessedModel, AssessmentChoice, AssessmentTable,
};

use super::*;

/// The assessment of the paper: the nominal model under the schedule, with medians over frequency.
const PAPER_CHOICE: AssessmentChoice = AssessmentChoice {
    model: AssessedModel::Nominal,
    correction: AssessedCorrection::Scheduled,
    average: CostAverage::Median,
};

#[test]
fn the_assessment_of_the_paper_equals_that_of_the_analysis() {
    let analysis = &*EXAMPLE_WITH_SUGGESTIONS_REJECTED;
    let table = AssessmentTable::assess(analysis, PAPER_CHOICE);
    assert_eq!(table.left_out.len(), 1);
    assert_eq!(
        (table.left_out[0].condition, table.left_out[0].why.code()),
        (ConditionId(10), "nominal-rejected")
    );
    assert_eq!(table.conditions.len(), 10);
    for assessed in &table.conditions {
        let Ok(changes) = &analysis.assessment[&assessed.condition] else {
            panic!("condition {} is assessed", assessed.condition)
        };
        assert_eq!((&assessed.changes, assessed.missing.len()), (changes, 0));
    }
    let job = AssessmentJob {
        analysis: Arc::new(analysis.clone()).into(),
        choice: PAPER_CHOICE,
    };
    assert_eq!(*job.run(&mut (), &Unobserved).unwrap(), table);
}

#[test]
fn the_assessed_own_correction_of_a_representative_has_the_costs_of_its_result() {
    let analysis = &*EXAMPLE_WITH_SUGGESTIONS_REJECTED;
    let own = AssessmentChoice {
        model: AssessedModel::Representative,
        correction: AssessedCorrection::Own,
        ..PAPER_CHOICE
    };
    let table = AssessmentTable::assess(analysis, own);
    assert_eq!(
        (table.conditions.len(), table.left_out.len()),
        (11, 0),
        "condition 10 is assessed although its nominal model is rejected"
    );
    for assessed in &table.conditions {
        let result = analysis.condition(assessed.condition).unwrap();
        assert_eq!(assessed.changes, *result.cost);
        assert_eq!(
            assessed.model,
            result.representative_name(BundleKind::Physics)
        );
    }
}

#[test]
fn the_mean_magnitude_cost_is_twenty_times_the_mean_square_in_db() {
    let analysis = &*EXAMPLE_WITH_SUGGESTIONS_REJECTED;
    let mean = AssessmentTable::assess(
        analysis,
        AssessmentChoice {
            average: CostAverage::Mean,
            ..PAPER_CHOICE
        },
    );
    let condition = ConditionId(1);
    let pair = analysis.study.dataset.find_pair("Q", "LON").unwrap();
    let found = mean.change(condition, pair).unwrap().uncorrected;
    let mismatch = analysis
        .condition(condition)
        .unwrap()
        .comparison
        .nominal
        .mismatch[pair]
        .clone()
        .unwrap();
    let squares: f64 = mismatch
        .magnitude_db
        .iter()
        .map(|error| error * error)
        .sum();
    // The magnitude part of J by its formula (M4).
    assert!((found.magnitude - 20.0 * squares / mismatch.magnitude_db.len() as f64).abs() < 1e-9);
}

#[test]
fn a_summary_counts_improved_responses_and_names_the_worst() {
    let analysis = &*EXAMPLE_WITH_SUGGESTIONS_REJECTED;
    let dataset = &analysis.study.dataset;
    let table = AssessmentTable::assess(analysis, PAPER_CHOICE);
    let summary = table.summary(dataset.on_axis());
    assert_eq!(
        summary.compared, 50,
        "five responses in each of ten conditions"
    );
    let (condition, pair, change) = summary.worst.unwrap();
    assert_eq!(table.change(condition, pair).unwrap().total(), change);
    let changes = || {
        table.conditions.iter().flat_map(|assessed| {
            dataset
                .on_axis()
                .marked()
                .map(|pair| assessed.changes[pair].unwrap().total())
        })
    };
    assert!(changes().all(|other| other <= change));
    assert_eq!(
        changes().filter(|change| *change < 0.0).count(),
        summary.better
    );
    let nothing = table.summary(&dataset.on_axis().map(|_, _| false));
    assert_eq!((nothing.compared, nothing.worst), (0, None));
}

#[test]
fn schedule_forms_are_compared_over_the_scheduled_conditions() {
    let analysis = &*EXAMPLE_WITH_SUGGESTIONS_REJECTED;
    let evidence = analysis.compare_forms().unwrap();
    let scheduled = analysis.scheduled();
    assert_eq!(
        (
            scheduled.len(),
            evidence.airspeeds_kt.len(),
            evidence.fits.len()
        ),
        (11, 11, SCHEDULE_KINDS.len())
    );
    let schedule = analysis.schedule.as_ref().unwrap();
    let fitted_form = evidence.form(schedule.settings.kind).unwrap();
    for (place, id) in scheduled.iter().enumerate() {
        let own = &analysis.condition(*id).unwrap().correction;
        let at = schedule.at(evidence.airspeeds_kt[place]);
        for pair in analysis.study.dataset.on_axis().marked() {
            let residual = fitted_form.pairs[pair].residuals[place].unwrap();
            let ratio = own.net_gain(pair) / at.net_gain(pair);
            // Rounding only: both sides take the same gains.
            assert!((residual.ln - ratio.ln()).abs() < 1e-14);
            assert!((residual.percent - 100.0 * (ratio - 1.0)).abs() < 1e-11);
        }
    }
    let on_axis: Vec<Pair> = analysis.study.dataset.on_axis().marked().collect();
    let errors: Vec<f64> = evidence
        .fits
        .iter()
        .map(|fit| fit.left_out_rms_ln(on_axis.clone()).unwrap())
        .collect();
    // The gain deficits of the example change by tens of percent over airspeed, so the constant
    // schedule predicts left-out conditions worst.
    assert!(
        errors[1..].iter().all(|error| *error < errors[0]),
        "{errors:?}"
    );
}

#[test]
fn scheduled_delays_stay_within_the_bounds_of_their_conditions() {
    let mut study = study_of_example();
    let mut engine = Engine::default();
    study.apply(&setting_table::POINTS.to(40)).unwrap();
    let off = analyze(&mut engine, &study);
    let kind = ScheduleKind::Polynomial { degree: 3 };
    study.apply(&setting_table::SCHEDULE.to(kind)).unwrap();
    let always = DelayScheduling::Always;
    study
        .apply(&setting_table::SCHEDULE_DELAYS.to(always))
        .unwrap();
    let on = analyze(&mut engine, &study);
    let schedule = on.schedule.as_ref().unwrap();
    let mut delayed = 0;
    for id in on.scheduled() {
        let result = on.condition(id).unwrap();
        let airspeed_kt = result.condition.flight_state().airspeed_kt;
        let at = schedule.at(airspeed_kt);
        // If two conditions have the same airspeed, the bound is their mean.
        let upper_s = schedule
            .delays
            .as_ref()
            .unwrap()
            .upper_s
            .at(&schedule.airspeeds, airspeed_kt);
        let clusters = &schedule.airspeeds.clusters;
        let is_alone = clusters
            .iter()
            .any(|cluster| cluster.len() == 1 && on.scheduled()[cluster[0]] == id);
        if is_alone {
            assert_eq!(upper_s, result.delay_upper_s(), "condition {id}");
        }
        for delay_s in at.input_delays_s.iter().chain(&at.output_delays_s) {
            assert!(
                (0.0..=upper_s).contains(delay_s),
                "{delay_s} in condition {id}"
            );
            delayed += usize::from(*delay_s > 0.0);
        }
        assert_eq!(
            off.schedule.as_ref().unwrap().at(60.0).output_delays_s,
            [0.0; 6]
        );
    }
    assert!(delayed > 0, "no channel has a scheduled delay");
    assert_ne!(
        on.assessment, off.assessment,
        "the scheduled correction is assessed with its delays"
    );
    let all = on.conditions.keys().copied().collect();
    let [written, without] =
        [&on, &off].map(|analysis| corrections(analysis, "", &all)["schedule"].clone());
    assert_eq!(
        list(&written["delays_s"]["upper_s"]).len(),
        list(&written["table"]).len()
    );
    for row in list(&written["table"]) {
        let at = schedule.at(number(&row["airspeed_kt"]));
        let delays_s = |side: &str| {
            row["delays_s"][side]
                .as_object()
                .unwrap()
                .values()
                .map(number)
                .collect::<Vec<_>>()
        };
        assert_eq!(
            (delays_s("inputs"), delays_s("outputs")),
            (at.input_delays_s, at.output_delays_s)
        );
    }
    assert!(
        without["delays_s"].is_null()
            && list(&without["table"])
                .iter()
                .all(|row| row.get("delays_s").is_none())
    );
}
