//! Time histories of the example against flight records.

use std::sync::Arc;

use nalgebra::{DMatrix, DVector};

use gdcm_method::requirements::tolerance_check::ToleranceError;
use gdcm_method::requirements::{Tolerance, ToleranceTable};
use gdcm_model::dataset::{BundleKind, ConditionId, Dynamics, Pair, StateSpace};
use gdcm_model::executor::Sequential;
use gdcm_model::progress::{Cancelled, Progress, Unobserved};
use gdcm_model::response::{FrequencyGrid, FrequencyResponse};
use gdcm_model::simulation::{FirstOrderHold, FlightRecord, validate};
use gdcm_sysid::identification::Preparation;
use gdcm_sysid::spectra::preparation::segments_of;
use gdcm_sysid::spectra::preparation_settings::PreparationError;

use super::couplings_tests::{COUPLED, EXAMPLE};
use super::job::Job;
use super::requirement_jobs::TimeHistoriesJob;
use crate::execution::Execution;
use crate::results::analysis::Analysis;
use crate::results::missing_finding::MissingReason;
use crate::results::record_comparison::{Trend, common_windows};
use crate::results::record_simulations::time_histories_of;
use crate::results::requirement_role::RequirementRole;
use crate::results::time_histories::{HistoryRecord, HistoryRecords, TimeHistories};

const CONDITION: ConditionId = ConditionId(3);
const SAMPLE_TIME_S: f64 = 0.02;

/// Builds a record of `samples` samples: a sweep of the first input, and the outputs that the model
/// in `role` simulates.
fn flown(analysis: &Analysis, role: RequirementRole, samples: usize) -> FlightRecord {
    let model = analysis
        .role_model(analysis.condition(CONDITION).unwrap(), role)
        .unwrap();
    let time_s: Vec<f64> = (0..samples).map(|n| SAMPLE_TIME_S * n as f64).collect();
    let sweep = |t: f64| 5.0 * (t * (0.5 + 0.05 * t)).sin();
    let inputs = DMatrix::from_fn(samples, model.inputs(), |n, input| {
        if input == 0 { sweep(time_s[n]) } else { 0.0 }
    });
    let hold = FirstOrderHold::new(&model, SAMPLE_TIME_S).unwrap();
    let outputs = hold.simulate(&DVector::zeros(model.order()), &inputs);
    FlightRecord {
        name: "sweep".into(),
        time_s,
        inputs,
        outputs,
    }
}

/// Returns a held-out record of [`CONDITION`].
fn records(analysis: &Analysis, flight: FlightRecord) -> Vec<HistoryRecords> {
    let (inputs, outputs) = analysis.study.dataset.input_and_output_names();
    let inputs: Vec<&str> = inputs.iter().map(String::as_str).collect();
    let outputs: Vec<&str> = outputs.iter().map(String::as_str).collect();
    let record = HistoryRecord {
        flight: Arc::new(flight).into(),
        held_out: true,
    };
    let preparation = Preparation {
        // An output that stays constant is not a gap.
        keep_frozen: true,
        ..Preparation::new(&inputs, &outputs)
    };
    vec![HistoryRecords {
        condition: CONDITION,
        records: vec![record],
        preparation,
    }]
}

fn histories(analysis: &Analysis, flight: FlightRecord, table: &ToleranceTable) -> TimeHistories {
    time_histories_of(
        analysis,
        &records(analysis, flight),
        table,
        &Execution::sequential(),
    )
    .unwrap()
}

#[test]
fn the_model_that_generated_the_record_is_inside_and_the_physics_model_is_not() {
    let analysis = &EXAMPLE.analysis;
    let flight = flown(analysis, RequirementRole::Identified, 1500);
    let found = histories(analysis, flight, &ToleranceTable::default());
    assert_eq!(
        found.records.len(),
        4,
        "a finding for each role: {:?}",
        found.missing
    );
    let of_role = |role| found.of_role(CONDITION, role).next().unwrap();
    let identified = of_role(RequirementRole::Identified);
    assert_eq!(
        (identified.samples, identified.moved_input.as_deref()),
        (1500, Some("LON"))
    );
    for finding in &identified.tolerances {
        assert!(
            finding.share_inside == 1.0 && finding.largest_excess < 0.0,
            "{finding:?}"
        );
        // Only off-axis responses have a trend.
        let trend = if finding.on_axis == Some(false) {
            Some(Trend::Correct)
        } else {
            None
        };
        assert!(
            finding.trend == trend && finding.correlation.unwrap() > 0.999_999,
            "{finding:?}"
        );
    }
    // The model reproduces its own record, except for the least-squares fit of the initial
    // state.
    assert!(
        identified.j_rms.unwrap() < 1e-6 && identified.theil["Q"] < 1e-7,
        "{identified:?}"
    );
    let [physics, corrected] = [RequirementRole::Physics, RequirementRole::Corrected].map(of_role);
    assert!(
        physics
            .tolerances
            .iter()
            .any(|finding| finding.share_inside < 1.0 && finding.largest_excess > 0.0)
    );
    assert!(
        corrected.j_rms.unwrap() < physics.j_rms.unwrap(),
        "the correction should lower the error of the model"
    );
    let pitch = identified
        .tolerances
        .iter()
        .find(|finding| finding.quantity == "pitch rate")
        .unwrap();
    assert_eq!((pitch.on_axis, pitch.trend), (Some(true), None));
}

#[test]
fn shares_and_costs_of_a_condition_weight_its_records_by_their_samples() {
    // Records of 600 and 1200 samples have the weights 1/3 and 2/3.
    let analysis = &EXAMPLE.analysis;
    let flights = [600, 1200].map(|samples| flown(analysis, RequirementRole::Identified, samples));
    let mut both_records = records(analysis, flights[0].clone());
    both_records[0].records.push(HistoryRecord {
        flight: Arc::new(flights[1].clone()).into(),
        held_out: false,
    });
    let table = ToleranceTable::default();
    let found =
        time_histories_of(analysis, &both_records, &table, &Execution::sequential()).unwrap();
    let role = RequirementRole::Physics;
    let [short, long] =
        [0, 1].map(|n| &found.of_role(CONDITION, role).nth(n).unwrap().tolerances[2]);
    let share = found
        .share_inside(CONDITION, role, &short.quantity)
        .unwrap();
    assert!((share - (short.share_inside + 2.0 * long.share_inside) / 3.0).abs() < 1e-12);
    assert_eq!(found.conditions(), [(CONDITION, 2)]);
    let [short_j, long_j] = [0, 1].map(|n| {
        let finding = found.of_role(CONDITION, role).nth(n).unwrap();
        finding.j_rms.unwrap()
    });
    let rms = ((short_j.powi(2) + 2.0 * long_j.powi(2)) / 3.0).sqrt();
    assert!((found.j_rms(CONDITION, role).unwrap() - rms).abs() < 1e-12);
}

fn reasons(found: &TimeHistories) -> Vec<MissingReason> {
    found
        .missing
        .iter()
        .map(|missing| missing.why.clone())
        .collect()
}

#[test]
fn every_missing_comparison_has_a_reason() {
    let analysis = &EXAMPLE.analysis;
    let table = ToleranceTable::default();
    let none = time_histories_of(analysis, &[], &table, &Execution::sequential()).unwrap();
    assert_eq!(
        (reasons(&none), none.records.len()),
        (vec![MissingReason::NoRecord], 0)
    );

    // 1 s is shorter than the minimum of 2 s.
    let short = flown(analysis, RequirementRole::Identified, 50);
    let found = histories(analysis, short, &table);
    assert!(found.records.is_empty());
    assert!(reasons(&found).iter().any(|why| matches!(
        why,
        MissingReason::RecordNotPrepared { record, why }
            if record == "sweep"
                && matches!(why, PreparationError::NothingLeft { least_s: 2.0, .. })
    )));
    let conditions_without_record = found
        .missing
        .iter()
        .filter(|missing| missing.why == MissingReason::NoRecordOfCondition)
        .count();
    assert_eq!(conditions_without_record, analysis.conditions.len() - 1);

    let thrust = Tolerance {
        channel: "T".into(),
        quantity: "thrust".into(),
        ..table.rows()[0].clone()
    };
    let with_thrust = ToleranceTable::new("mine", vec![thrust, table.rows()[2].clone()]).unwrap();
    let found = histories(
        analysis,
        flown(analysis, RequirementRole::Identified, 600),
        &with_thrust,
    );
    assert!(reasons(&found).iter().any(|why| matches!(
        why,
        MissingReason::ToleranceNotApplied(ToleranceError::NoChannel { quantity, channel })
            if quantity == "thrust" && channel == "T"
    )));
    assert!(
        found
            .records
            .iter()
            .all(|finding| finding.tolerances.len() == 1),
        "the other row should be compared"
    );
}

#[test]
fn a_record_that_is_not_finite_is_refused_with_its_name() {
    let analysis = &EXAMPLE.analysis;
    let mut flight = flown(analysis, RequirementRole::Identified, 600);
    flight.outputs.column_mut(1).fill(f64::NAN);
    let found = histories(analysis, flight, &ToleranceTable::default());
    assert!(found.records.is_empty());
    assert!(found.missing.iter().any(|missing| {
        missing.condition == Some(CONDITION)
            && matches!(
                &missing.why,
                MissingReason::RecordNotPrepared { record, .. }
                | MissingReason::NotCompared { record, .. }
                    if record == "sweep"
            )
    }));
}

#[test]
fn the_corrected_model_includes_the_couplings_and_the_physics_model_does_not() {
    let analysis = &COUPLED.1;
    let result = analysis.condition(CONDITION).unwrap();
    let physics = &result.condition.bundle(BundleKind::Physics)[result.comparison.physics.model];
    let grid = FrequencyGrid::logarithmic(analysis.study.settings.band, 20);
    let model = analysis
        .role_model(result, RequirementRole::Corrected)
        .unwrap();
    let corrected = FrequencyResponse::from_dynamics(&Dynamics::StateSpace(model), &grid);
    let plain = FrequencyResponse::from_dynamics(&physics.dynamics, &grid);
    let coupled = result.coupled_response(&plain);
    let pair = Pair::new(1, 0);
    let correction = result.correction.on(pair).unwrap();
    for (k, omega) in grid.omega().iter().enumerate() {
        let expected = coupled.curve(pair)[k] * correction.at(*omega);
        // 1e-4 allows for the phase error of Padé approximants in the band, for delays of tens of
        // ms.
        assert!(
            (corrected.curve(pair)[k] - expected).norm() < 1e-4 * expected.norm(),
            "{omega}"
        );
    }
    let uncorrected = analysis
        .role_model(result, RequirementRole::Physics)
        .unwrap();
    let uncorrected = FrequencyResponse::from_dynamics(&Dynamics::StateSpace(uncorrected), &grid);
    assert!(
        (uncorrected.curve(pair)[0] - plain.curve(pair)[0]).norm()
            < 1e-12 * plain.curve(pair)[0].norm()
    );
}

#[test]
fn a_job_can_be_cancelled_and_equals_only_a_job_with_the_same_inputs() {
    struct Stopped;
    impl Progress for Stopped {
        fn cancelled(&self) -> bool {
            true
        }
        fn advanced(&self, _: usize, _: usize) {}
    }
    let analysis = Arc::new(EXAMPLE.analysis.clone());
    let records = records(
        &analysis,
        flown(&analysis, RequirementRole::Identified, 600),
    );
    let job = TimeHistoriesJob {
        analysis: analysis.into(),
        records,
        tolerances: ToleranceTable::default(),
    };
    let mut executor: Box<dyn gdcm_model::executor::Executor> = Box::new(Sequential);
    assert_eq!(job.run(&mut executor, &Stopped).unwrap_err(), Cancelled);
    assert_eq!(
        job.run(&mut executor, &Unobserved).unwrap().records.len(),
        4
    );
    assert_eq!(job, job.clone());
    let tolerances = ToleranceTable::new("mine", job.tolerances.rows()[..1].to_vec()).unwrap();
    assert_ne!(
        TimeHistoriesJob {
            tolerances,
            ..job.clone()
        },
        job
    );
    assert_ne!(
        TimeHistoriesJob {
            records: Vec::new(),
            ..job.clone()
        },
        job
    );
}

#[test]
fn models_of_a_condition_are_compared_in_the_same_windows() {
    let analysis = &EXAMPLE.analysis;
    let flight = flown(analysis, RequirementRole::Identified, 1500);
    let segments = segments_of(&flight, &records(analysis, flight.clone())[0].preparation).unwrap();
    let result = analysis.condition(CONDITION).unwrap();
    let slow = analysis
        .role_model(result, RequirementRole::Physics)
        .unwrap();
    // The fastest pole is shifted to 1 rad/s: a mode that grows by a factor of e in 1 s is compared
    // over 3 s.
    let fast = StateSpace::new(
        slow.a()
            + DMatrix::from_diagonal_element(
                slow.order(),
                slow.order(),
                1.0 - largest_real_part(&slow),
            ),
        slow.b().clone(),
        slow.c().clone(),
        slow.d().clone(),
    )
    .unwrap();
    let alone = common_windows([&slow], &segments);
    let both = common_windows([&slow, &fast], &segments);
    assert!(
        alone.longest_window_s > 3.5 && (both.longest_window_s - 3.0).abs() < 1e-6,
        "{alone:?} {both:?}"
    );
    let windows = |model: &StateSpace| -> Vec<(f64, usize)> {
        let found = validate(model, &segments, &both, &Sequential).unwrap();
        found
            .windows
            .iter()
            .map(|window| (window.start_s, window.measured.nrows()))
            .collect()
    };
    assert_eq!(windows(&slow), windows(&fast));
    // A model that diverges too fast to be compared (a factor of e in 10 ms) does not shorten the
    // windows of the other models.
    let hopeless = StateSpace::new(
        slow.a() + DMatrix::from_diagonal_element(slow.order(), slow.order(), 100.0),
        slow.b().clone(),
        slow.c().clone(),
        slow.d().clone(),
    )
    .unwrap();
    assert_eq!(common_windows([&slow, &hopeless], &segments), alone);
}

/// Returns the maximum real part of the poles \[rad/s\].
fn largest_real_part(model: &StateSpace) -> f64 {
    model
        .a()
        .complex_eigenvalues()
        .iter()
        .map(|pole| pole.re)
        .fold(f64::NEG_INFINITY, f64::max)
}
