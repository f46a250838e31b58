//! Flight records read with a layout: cautions, remedies (delay and factor of a channel), copies,
//! and transfer of a layout to other records.

use std::collections::BTreeMap;

use gdcm_model::dataset::condition::ChannelRemedy;

use super::laid_out_record::LaidOutRecord;
use super::layout_problem::{LayoutCaution, LayoutProblem};
use super::layout_proposal::TimeSettings;
use super::layout_tests::{channels, column, proposed, record};
use super::record_copies::leave_out_copies;
use super::record_guess::RecordGuess;
use super::record_table::RecordColumn;

#[test]
fn missing_samples_stay_missing_and_infinite_samples_count_as_missing() {
    let mut table = record();
    table.columns[3].values[7] = f64::INFINITY;
    table.columns[3].values[8] = f64::NAN;
    let proposal = proposed(&table);
    assert_eq!(
        proposal.cautions,
        [LayoutCaution::Missing {
            channel: "P".into(),
            column: "\"roll rate\"".into(),
            count: 2,
            samples: 60,
        }]
    );
    let flight = proposal.layout.flight_record(&table, &channels()).unwrap();
    assert!(
        flight.outputs[(7, 0)].is_nan()
            && flight.outputs[(8, 0)].is_nan()
            && flight.outputs[(9, 0)].is_finite()
    );
}

#[test]
fn a_layout_applies_to_a_record_with_the_same_columns_in_another_order() {
    let first = record();
    let mut second = record();
    second.columns.rotate_left(2);
    let layout = proposed(&first).layout;
    let carried = layout.carried_to(&second, &first).unwrap();
    let flight = carried.flight_record(&second, &channels()).unwrap();
    assert_eq!(flight, layout.flight_record(&first, &channels()).unwrap());
    second.columns.retain(|column| column.name != "nz");
    assert_eq!(
        layout.carried_to(&second, &first),
        None,
        "a column is missing"
    );
}

#[test]
fn constant_and_equal_channels_raise_cautions() {
    let mut table = record();
    table.columns[4] = column("LON", "%", |_| 50.0);
    assert_eq!(
        proposed(&table).cautions,
        [LayoutCaution::Constant {
            channel: "LON".into(),
            column: "\"LON\"".into(),
        }]
    );
    table.columns[4] = RecordColumn {
        name: "LON".into(),
        ..table.columns[2].clone()
    };
    assert_eq!(
        proposed(&table).cautions,
        [LayoutCaution::Same {
            first: "LON".into(),
            second: "LAT".into(),
        }]
    );
}

/// The record under another name, with a different first sample of LAT.
fn named_record(name: &str, first: f64) -> LaidOutRecord {
    let mut table = record();
    table.name = name.to_owned();
    table.columns[2].values[0] = first;
    LaidOutRecord::proposed(table, &channels(), &TimeSettings::default()).0
}

#[test]
fn only_the_first_of_two_equal_records_is_used() {
    let mut records = [
        named_record("a", 55.0),
        named_record("b", 55.0),
        named_record("c", 54.0),
    ];
    // A second call changes nothing.
    leave_out_copies(&mut records);
    leave_out_copies(&mut records);
    assert_eq!(
        records.each_ref().map(|record| record.used),
        [true, false, true]
    );
    let copy = LayoutCaution::Copy {
        first: "a".to_owned(),
    };
    assert_eq!(records[1].cautions, [copy]);
}

#[test]
fn remedies_apply_to_their_record_only_and_add_up() {
    let table = record();
    let channels = channels();
    let as_logged = proposed(&table).layout;
    let mut layout = as_logged.clone();
    let remedies = BTreeMap::from([
        (
            "LON".to_owned(),
            ChannelRemedy {
                delay_s: 0.03,
                factor: 1.0,
            },
        ),
        (
            "P".to_owned(),
            ChannelRemedy {
                delay_s: 0.0,
                factor: -1.0,
            },
        ),
    ]);
    layout.add_remedies(&remedies, &channels);
    let [before, after] =
        [&as_logged, &layout].map(|layout| layout.flight_record(&table, &channels).unwrap());
    // LON is 40 + k at 0.02 k s: 30 ms later it is larger by 1.5; beyond the end it has no value.
    assert!(
        (after.inputs[(10, 0)] - 51.5).abs() < 1e-12,
        "{}",
        after.inputs[(10, 0)]
    );
    assert!(after.inputs[(58, 0)].is_nan() && after.inputs[(57, 0)].is_finite());
    assert_eq!(after.outputs.column(0), -before.outputs.column(0));
    assert_eq!(
        (after.inputs.column(1), after.outputs.column(1)),
        (before.inputs.column(1), before.outputs.column(1))
    );
    // The remedy is stored with the record, is not passed to other records, and is kept when the
    // columns change.
    let entry = layout.condition_record(&table, &RecordGuess::default(), &channels);
    assert_eq!(entry.remedies, remedies);
    let carried = as_logged
        .carried_to(&table, &table)
        .unwrap()
        .with_remedies_of(&layout);
    assert_eq!(carried, layout);
    // Applied twice, the delays add to 60 ms, and the two changes of sign cancel.
    layout.add_remedies(&remedies, &channels);
    let twice = layout.flight_record(&table, &channels).unwrap();
    assert!((twice.inputs[(10, 0)] - 53.0).abs() < 1e-12 && twice.outputs == before.outputs);
}

fn delay_of_lon(delay_s: f64) -> BTreeMap<String, ChannelRemedy> {
    let remedy = ChannelRemedy {
        delay_s,
        factor: 1.0,
    };
    BTreeMap::from([("LON".to_owned(), remedy)])
}

#[test]
fn a_delay_does_not_interpolate_across_a_gap_and_a_too_long_delay_is_refused() {
    let mut table = record();
    // The time jumps by 1 s between samples 29 and 30.
    for sample in 30..60 {
        table.columns[1].values[sample] += 1.0;
    }
    let channels = channels();
    let mut layout = proposed(&table).layout;
    layout.add_remedies(&delay_of_lon(0.03), &channels);
    let flight = layout.flight_record(&table, &channels).unwrap();
    assert!(
        flight.inputs[(28, 0)].is_nan()
            && flight.inputs[(27, 0)].is_finite()
            && flight.inputs[(30, 0)].is_finite()
    );
    layout.add_remedies(&delay_of_lon(1e300), &channels);
    assert_eq!(
        layout.problems(&table, &channels),
        [LayoutProblem::Delay {
            channel: "LON".into(),
            delay_s: 1e300,
        }]
    );
}
