//! Tests of the tables of time histories for the example.

use std::sync::Arc;

use nalgebra::{DMatrix, DVector};

use gdcm_method::requirements::ToleranceTable;
use gdcm_model::dataset::ConditionId;
use gdcm_model::simulation::{FirstOrderHold, FlightRecord};
use gdcm_study::results::record_comparison::Trend;
use gdcm_study::results::record_simulations::time_histories_of;
use gdcm_study::results::requirement_role::RequirementRole;
use gdcm_study::results::time_histories::{
    HistoryRecord, HistoryRecords, TimeHistories, ToleranceFinding,
};
use gdcm_study::{Analysis, Execution};
use gdcm_sysid::identification::Preparation;

use crate::example_tests::EXAMPLE;
use crate::table::Table;
use crate::time_histories::{history_cost_table, record_table, share_table};

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

/// Returns the numbers of the rows of the tolerance table that record `n` leaves in its table:
/// those that any model violates.
fn violated_rows(found: &TimeHistories, n: usize) -> Vec<usize> {
    let findings = RequirementRole::ALL.map(|role| found.of_role(CONDITION, role).nth(n).unwrap());
    (0..findings[0].tolerances.len())
        .filter(|row| {
            findings
                .iter()
                .any(|finding| is_violated(&finding.tolerances[*row]))
        })
        .collect()
}

fn is_violated(finding: &ToleranceFinding) -> bool {
    finding.largest_excess > 0.0 || finding.trend == Some(Trend::Opposite)
}

/// Counts the rows of a record.
fn count_rows(table: &Table, record: &str) -> usize {
    table.rows.iter().filter(|row| row[0] == record).count()
}

#[test]
fn tables_show_the_shares_costs_and_excesses_of_the_records() {
    let analysis = &*EXAMPLE;
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
    let long = &found.of_role(CONDITION, role).nth(1).unwrap().tolerances[2];
    let share = found.share_inside(CONDITION, role, &long.quantity).unwrap();
    let rms = found.j_rms(CONDITION, role).unwrap();
    let shown = share_table(&found);
    assert_eq!(
        shown.rows[2][..3],
        ["3", "2", "pitch rate"].map(str::to_owned)
    );
    // The share is rounded down: below 1, it is never displayed as 100.
    assert_eq!(
        shown.rows[2][3].parse::<f64>().unwrap(),
        (1e3 * share).floor() / 10.0
    );
    assert_eq!(shown.rows[2][6], "100.0");
    assert_eq!(history_cost_table(&found).rows[0][3], format!("{rms:.2}"));
    // The table of records contains only the rows that a model violates; its title counts the rest.
    let by_record = record_table(&found, CONDITION);
    let short_violations = violated_rows(&found, 0).len();
    let long_violations = violated_rows(&found, 1).len();
    assert_eq!(count_rows(&by_record, "sweep (held out)"), short_violations);
    assert_eq!(count_rows(&by_record, "sweep"), long_violations);
    let rows = 2 * found.records[0].tolerances.len();
    let omitted = rows - short_violations - long_violations;
    assert!(
        by_record.title.contains(&format!("{omitted} of {rows}")),
        "{}",
        by_record.title
    );
    let row = by_record
        .rows
        .iter()
        .find(|row| row[0] == "sweep" && row[1] == long.quantity)
        .unwrap();
    assert!(
        long.largest_excess > 0.0
            && row[2].contains(&format!("at {:.1} s", long.largest_excess_at_s)),
        "{row:?}"
    );
    assert_eq!(
        row[5], "100.0",
        "the model that generated the record is always inside"
    );
}
