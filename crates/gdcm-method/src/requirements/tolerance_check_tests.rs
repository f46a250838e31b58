//! Tests of time histories within tolerances (M17.2).

use nalgebra::{DMatrix, dmatrix, dvector};
use proptest::prelude::*;

use gdcm_model::dataset::{Channel, StateSpace};
use gdcm_model::executor::Sequential;
use gdcm_model::simulation::{
    FirstOrderHold, Segment, ValidationSettings, ValidationWindow, validate,
};

use super::known_answers::{answers, number};
use super::tolerance_check::{
    ChannelTolerance, ToleranceCheck, ToleranceCheckError, ToleranceError,
};
use super::{RecordCheck, Tolerance, ToleranceTable};

const SAMPLE_TIME_S: f64 = 0.02;

fn tolerance(absolute: f64, relative: f64) -> ChannelTolerance {
    ChannelTolerance {
        output: 0,
        integrated: false,
        absolute,
        relative,
        unit: "deg/s".into(),
    }
}

fn check_samples(
    flown: &[f64],
    simulated: &[f64],
    tolerance: &ChannelTolerance,
) -> Result<ToleranceCheck, ToleranceCheckError> {
    let window = ValidationWindow {
        record: 0,
        start_s: 0.0,
        sample_time_s: SAMPLE_TIME_S,
        measured: DMatrix::from_column_slice(flown.len(), 1, flown),
        simulated: DMatrix::from_column_slice(simulated.len(), 1, simulated),
    };
    ToleranceCheck::new(&window, tolerance)
}

/// The record in the reference results (`tests/data/reference/requirements.json`, "tolerance").
struct SyntheticRecord {
    flown: Vec<f64>,
    simulated: Vec<f64>,
}

fn synthetic_record() -> SyntheticRecord {
    let time: Vec<f64> = (0..500).map(|n| SAMPLE_TIME_S * f64::from(n)).collect();
    SyntheticRecord {
        flown: time.iter().map(|t| 8.0 * (0.9 * t).sin() + 2.0).collect(),
        simulated: time
            .iter()
            .map(|t| 8.6 * (0.9 * t - 0.12).sin() + 2.3)
            .collect(),
    }
}

fn outputs() -> Vec<Channel> {
    [
        ("P", "deg/s"),
        ("Q", "rad/s"),
        ("R", "deg/s"),
        ("NZ", "m/s^2"),
    ]
    .map(|(name, unit)| Channel::new(name, unit))
    .to_vec()
}

#[test]
fn shares_and_excesses_match_the_reference_results() {
    let SyntheticRecord { flown, simulated } = synthetic_record();
    let answers = answers();
    for case in answers["tolerance"]["cases"].as_array().unwrap() {
        let check = check_samples(
            &flown,
            &simulated,
            &tolerance(number(case, "absolute"), 0.1),
        )
        .unwrap();
        assert!(
            (check.share_inside() - number(case, "share_inside")).abs() < 1e-12,
            "{case}"
        );
        assert!(
            (check.largest_excess - number(case, "largest_excess")).abs() < 1e-12,
            "{case}"
        );
        let n = (check.largest_excess_at_s / SAMPLE_TIME_S).round() as usize;
        let width = check.width[n];
        assert!(((simulated[n] - flown[n]).abs() - width - check.largest_excess).abs() < 1e-12);
    }
}

#[test]
fn intervals_outside_the_tolerance_contain_exactly_the_samples_outside() {
    // Nothing moves in flight, so that the tolerance is 1 throughout: samples 1 and 2, 4, and 7 are
    // outside, the last by 5 - 1. A value on the limit is inside.
    let flown = [0.0; 8];
    let simulated = [0.0, 2.0, 3.0, 0.0, -2.0, 1.0, 0.0, 5.0];
    let check = check_samples(&flown, &simulated, &tolerance(1.0, 0.1)).unwrap();
    assert_eq!(check.outside(), [[0.02, 0.04], [0.08, 0.08], [0.14, 0.14]]);
    assert_eq!(
        (
            check.inside,
            check.largest_excess,
            check.largest_excess_at_s
        ),
        (4, 4.0, 0.14)
    );
}

#[test]
fn the_peak_error_is_relative_to_the_tolerance_of_its_own_sample() {
    // Tolerances: 2, 2, and 10 % of the change of 100. The largest error in deg/s is 8, at the last
    // sample; relative to the tolerance it is 3 of 2, at the second.
    let flown = [0.0, 0.0, 100.0];
    let simulated = [0.0, 3.0, 108.0];
    let check = check_samples(&flown, &simulated, &tolerance(2.0, 0.1)).unwrap();
    assert!((check.peak_error - 1.5).abs() < 1e-12);
    assert!((check.peak_error_at_s - SAMPLE_TIME_S).abs() < 1e-12);
    assert!((check.largest_excess - 1.0).abs() < 1e-12);
    // The peak error is above 1 if and only if a sample is outside: the second sample is on
    // its limit, and the others are inside.
    let inside = check_samples(&flown, &[0.0, 2.0, 109.0], &tolerance(2.0, 0.1)).unwrap();
    assert_eq!((inside.inside, inside.peak_error), (3, 1.0));
}

#[test]
fn an_attitude_is_the_integral_of_its_rate_from_the_start() {
    let rate: Vec<f64> = (0..101)
        .map(|n| 3.0 * SAMPLE_TIME_S * f64::from(n))
        .collect();
    let motionless = vec![0.0; 101];
    let attitude = ChannelTolerance {
        integrated: true,
        ..tolerance(1.0, 0.0)
    };
    let check = check_samples(&rate, &motionless, &attitude).unwrap();
    // The rate 3 t integrates to 3 t^2 / 2, which is 6 after 2 s: the trapezoidal rule is exact on
    // straight lines. The tolerance is 1.
    assert!((check.flown[100] - 6.0).abs() < 1e-12 && check.flown[0] == 0.0);
    assert!((check.largest_excess - 5.0).abs() < 1e-12);
}

#[test]
fn the_correlation_has_the_sign_of_the_trend_and_a_constant_has_none() {
    let SyntheticRecord { flown, simulated } = synthetic_record();
    let reversed: Vec<f64> = simulated.iter().map(|y| -y).collect();
    let [same, opposite, constant] = [&simulated[..], &reversed, &[4.0; 500]].map(|simulated| {
        check_samples(&flown, simulated, &tolerance(1.0, 0.1))
            .unwrap()
            .correlation()
    });
    assert!(same.unwrap() > 0.9 && opposite.unwrap() < -0.9);
    assert_eq!(constant, None);
}

/// A window with four samples, 1 s apart, flown as 0, 1, 0, -1.
fn window(record: usize, start_s: f64, simulated: [f64; 4]) -> ValidationWindow {
    ValidationWindow {
        record,
        start_s,
        sample_time_s: 1.0,
        measured: DMatrix::from_column_slice(4, 1, &[0.0, 1.0, 0.0, -1.0]),
        simulated: DMatrix::from_column_slice(4, 1, &simulated),
    }
}

#[test]
fn a_record_of_several_windows_counts_every_sample_once() {
    let inside = [0.0, 1.0, 0.0, -1.0];
    let windows = [
        window(0, 0.0, inside),
        window(2, 0.0, inside),
        window(0, 4.0, [0.0, 5.0, 0.0, -1.0]),
    ];
    let records = RecordCheck::of_windows(&windows, &tolerance(0.5, 0.1)).unwrap();
    assert_eq!(
        records
            .iter()
            .map(|record| (record.record, record.windows.len()))
            .collect::<Vec<_>>(),
        [(0, 2), (2, 1)]
    );
    assert_eq!(
        (records[0].share_inside(), records[1].share_inside()),
        (7.0 / 8.0, 1.0)
    );
    let worst = records[0].worst().unwrap();
    // Sample 1 of the window from 4 s on has the error 4; its tolerance is 0.5.
    assert_eq!(
        (worst.largest_excess, worst.largest_excess_at_s),
        (3.5, 5.0)
    );
    assert!(records[1].correlation().unwrap() > 0.999 && records[0].correlation().unwrap() < 0.999);
    let missing_output = ChannelTolerance {
        output: 1,
        ..tolerance(0.5, 0.1)
    };
    assert_eq!(
        RecordCheck::of_windows(&windows, &missing_output).unwrap_err(),
        ToleranceCheckError::NoOutput { output: 1 }
    );
}

/// A first-order lag of 0.5 s: `dx/dt = -2 x + gain u`.
fn lag(gain: f64) -> StateSpace {
    StateSpace::new(dmatrix![-2.0], dmatrix![gain], dmatrix![1.0], dmatrix![0.0]).unwrap()
}

/// Simulates a lag with this gain, and checks it against a flown window.
fn check_lag(gain: f64, flown: &Segment) -> RecordCheck {
    let validation = validate(
        &lag(gain),
        std::slice::from_ref(flown),
        &ValidationSettings::unfiltered(),
        &Sequential,
    )
    .unwrap();
    RecordCheck::of_windows(&validation.windows, &tolerance(1.0, 0.1))
        .unwrap()
        .remove(0)
}

#[test]
fn the_model_that_flew_is_inside_and_one_with_half_its_gain_is_not() {
    let stick = DMatrix::from_fn(1000, 1, |n, _| {
        10.0 * (0.8 * SAMPLE_TIME_S * n as f64).sin()
    });
    let hold = FirstOrderHold::new(&lag(2.0), SAMPLE_TIME_S).unwrap();
    let flown = hold.simulate(&dvector![1.0], &stick);
    let segment = Segment {
        record: 0,
        start_s: 0.0,
        sample_time_s: SAMPLE_TIME_S,
        inputs: stick,
        outputs: flown,
    };
    let right = check_lag(2.0, &segment);
    let wrong = check_lag(1.0, &segment);
    assert_eq!((right.windows.len(), right.share_inside()), (2, 1.0));
    assert!(right.correlation().unwrap() > 0.999_999);
    assert!(wrong.share_inside() < 0.5 && wrong.worst().unwrap().largest_excess > 1.0);
    assert!(
        wrong.correlation().unwrap() > 0.9,
        "half the gain still has the right trend"
    );
}

fn refusal(flown: &[f64], simulated: &[f64]) -> ToleranceCheckError {
    check_samples(flown, simulated, &tolerance(1.0, 0.1)).unwrap_err()
}

#[test]
fn samples_that_cannot_be_compared_are_refused_with_the_reason() {
    assert_eq!(refusal(&[], &[]), ToleranceCheckError::NoSamples);
    assert_eq!(
        refusal(&[1.0, 2.0], &[1.0]),
        ToleranceCheckError::Lengths {
            flown: 2,
            simulated: 1
        }
    );
    assert_eq!(
        refusal(&[1.0, f64::NAN], &[1.0, 2.0]),
        ToleranceCheckError::NotFinite {
            origin: "flown",
            time_s: SAMPLE_TIME_S
        }
    );
}

/// A row of the default table in the units of [`outputs`].
fn default_row(quantity: &str) -> ChannelTolerance {
    ToleranceTable::default()
        .rows()
        .iter()
        .find(|row| row.quantity == quantity)
        .unwrap()
        .in_output_units(&outputs())
        .unwrap()
}

#[test]
fn default_tolerances_are_converted_to_the_units_of_the_dataset() {
    // The table has 3 deg/s, 1.5 deg and 0.1 g; the dataset has pitch in rad, acceleration in
    // m/s^2.
    let roll = default_row("roll rate");
    assert_eq!((roll.absolute, roll.relative), (3.0, 0.1));
    let bank = default_row("bank angle");
    assert_eq!((bank.integrated, bank.unit.as_str()), (true, "deg"));
    let pitch = default_row("pitch attitude");
    assert!(
        (pitch.absolute - 1.5_f64.to_radians()).abs() < 1e-15
            && pitch.unit == "rad"
            && pitch.output == 1
    );
    let normal = default_row("normal acceleration");
    assert!((normal.absolute - 0.980_665).abs() < 1e-12 && normal.relative == 0.0);
}

#[test]
fn a_tolerance_that_fits_no_channel_is_refused() {
    let bank = ToleranceTable::default().rows()[1].clone();
    let no_channel = bank.in_output_units(&outputs()[1..]).unwrap_err();
    assert_eq!(
        no_channel,
        ToleranceError::NoChannel {
            quantity: "bank angle".into(),
            channel: "P".into()
        }
    );
    let acceleration = [Channel::new("P", "deg/s^2")];
    assert_eq!(
        bank.in_output_units(&acceleration).unwrap_err(),
        ToleranceError::NotARate {
            quantity: "bank angle".into(),
            channel: "P".into(),
            unit: "deg/s^2".into()
        }
    );
    let in_g = Tolerance {
        unit: "g".into(),
        integrated: false,
        ..bank
    };
    assert_eq!(
        in_g.in_output_units(&outputs()).unwrap_err(),
        ToleranceError::Unit {
            quantity: "bank angle".into(),
            unit: "g".into(),
            channel: "P".into(),
            compared_unit: "deg/s".into()
        }
    );
}

#[test]
fn a_tolerance_table_survives_json_and_a_wrong_row_is_refused_with_its_number() {
    let table = ToleranceTable::default();
    let text = serde_json::to_string(&table).unwrap();
    assert_eq!(
        serde_json::from_str::<ToleranceTable>(&text).unwrap(),
        table
    );
    let normal_acceleration = concat!(
        r#"{"quantity":"normal acceleration","channel":"NZ","integrated":false,"#,
        r#""absolute":0.1,"unit":"g","entry":"2.b.3.d, 2.c.3.b"}"#
    );
    assert!(text.contains(normal_acceleration), "{text}");
    let not_positive = |row, quantity: &str, name, found| ToleranceError::NotPositive {
        row,
        quantity: quantity.to_owned(),
        name,
        found,
    };
    for (from, to, error) in [
        (
            "\"absolute\":2.0",
            "\"absolute\":0.0",
            not_positive(3, "pitch rate", "absolute", 0.0),
        ),
        (
            "\"relative\":0.1",
            "\"relative\":-0.1",
            not_positive(1, "roll rate", "relative", -0.1),
        ),
        (
            "\"channel\":\"NZ\"",
            "\"channel\":\" \"",
            ToleranceError::NoChannelName {
                row: 7,
                quantity: "normal acceleration".to_owned(),
            },
        ),
    ] {
        let wrong = text.replacen(from, to, 1);
        assert!(serde_json::from_str::<ToleranceTable>(&wrong).is_err());
        let file: serde_json::Value = serde_json::from_str(&wrong).unwrap();
        let rows = serde_json::from_value(file["tolerances"].clone()).unwrap();
        assert_eq!(ToleranceTable::new(String::new(), rows).unwrap_err(), error);
    }
}

proptest! {
    #[test]
    fn a_model_compared_with_itself_is_inside_everywhere(
        flown in prop::collection::vec(-50.0_f64..50.0, 1..200),
        absolute in 1e-6_f64..5.0,
        integrated in any::<bool>(),
    ) {
        let tolerance = ChannelTolerance { integrated, ..tolerance(absolute, 0.1) };
        let check = check_samples(&flown, &flown, &tolerance).unwrap();
        prop_assert_eq!(check.share_inside(), 1.0);
        prop_assert!(check.largest_excess <= -absolute && check.outside().is_empty());
    }

    #[test]
    fn a_wider_tolerance_leaves_no_fewer_samples_inside(
        pairs in prop::collection::vec((-50.0_f64..50.0, -50.0_f64..50.0), 1..200),
        absolute in 0.1_f64..20.0,
        more_absolute in 0.0_f64..20.0,
        relative in 0.0_f64..0.5,
        more_relative in 0.0_f64..0.5,
    ) {
        let (flown, simulated): (Vec<f64>, Vec<f64>) = pairs.into_iter().unzip();
        let narrow = check_samples(&flown, &simulated, &tolerance(absolute, relative)).unwrap();
        let wider = tolerance(absolute + more_absolute, relative + more_relative);
        let wide = check_samples(&flown, &simulated, &wider).unwrap();
        prop_assert!(wide.inside >= narrow.inside && wide.largest_excess <= narrow.largest_excess);
    }
}
