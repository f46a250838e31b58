//! Tests of the tables of time histories for the example.

use std::sync::Arc;

use nalgebra::{DMatrix, DVector};

use gdcm_method::requirements::ToleranceTable;
use gdcm_model::dataset::ConditionId;
use gdcm_model::simulation::{FirstOrderHold, FlightRecord};
use gdcm_study::results::record_comparison::Trend;
use gdcm_study::results::record_simulations::time_histories_of;
use gdcm_study::results::requirement_role::RequirementRole;
use gdcm_study::results::time_histories::{HistoryRecord, HistoryRecords, ToleranceFinding};
use gdcm_study::{Analysis, Execution};
use gdcm_sysid::identification::Preparation;

use crate::example_tests::EXAMPLE;
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
    let held = FirstOrderHold::new(&model, SAMPLE_TIME_S).unwrap();
    let outputs = held.simulate(&DVector::zeros(model.order()), &inputs);
    FlightRecord {
        name: "sweep".into(),
        time_s,
        inputs,
        outputs,
    }
}

fn records(analysis: &Analysis, flight: FlightRecord) -> Vec<HistoryRecords> {
    let (inputs, outputs) = analysis.study.dataset.input_and_output_names();
    let [inputs, outputs]: [Vec<&str>; 2] =
        [&inputs, &outputs].map(|of| of.iter().map(String::as_str).collect());
    let record = HistoryRecord {
        flight: Arc::new(flight).into(),
        held_out: true,
    };
    let preparation = Preparation {
        keep_frozen: true,
        ..Preparation::new(&inputs, &outputs)
    };
    vec![HistoryRecords {
        condition: CONDITION,
        records: vec![record],
        preparation,
    }]
}

#[test]
fn tables_show_the_shares_costs_and_excesses_of_the_records() {
    let analysis = &*EXAMPLE;
    let flights = [600, 1200].map(|samples| flown(analysis, RequirementRole::Identified, samples));
    let mut given = records(analysis, flights[0].clone());
    given[0].records.push(HistoryRecord {
        flight: Arc::new(flights[1].clone()).into(),
        held_out: false,
    });
    let table = ToleranceTable::default();
    let found = time_histories_of(analysis, &given, &table, &Execution::sequential()).unwrap();
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
    let of_records = record_table(&found, CONDITION);
    let is_left =
        |of: &ToleranceFinding| of.largest_excess > 0.0 || of.trend == Some(Trend::Opposite);
    let first =
        |n: usize| RequirementRole::ALL.map(|role| found.of_role(CONDITION, role).nth(n).unwrap());
    let rows = found.records[0].tolerances.len();
    let left = |n: usize| {
        (0..rows)
            .filter(|row| first(n).iter().any(|of| is_left(&of.tolerances[*row])))
            .count()
    };
    let named = |name: &str| of_records.rows.iter().filter(|row| row[0] == name).count();
    assert_eq!(
        [named("sweep (held out)"), named("sweep")],
        [left(0), left(1)]
    );
    assert!(of_records.title.contains(&format!(
        "{} of {}",
        2 * rows - left(0) - left(1),
        2 * rows
    )));
    let row = of_records
        .rows
        .iter()
        .find(|row| row[0] == "sweep" && row[1] == long.quantity)
        .unwrap();
    assert!(
        long.largest_excess > 0.0
            && row[2].contains(&format!("at {:.1} s", long.largest_excess_at_s)),
        "{row:?}"
    );
    assert_eq!(row[5], "100.0", "the model that flew is always inside");
}
