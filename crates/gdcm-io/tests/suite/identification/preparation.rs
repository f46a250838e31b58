//! Preparation of logged records: from raw samples to segments with equidistant samples.

use nalgebra::DMatrix;
use proptest::prelude::*;

use gdcm_model::dataset::channel::ChannelSide;
use gdcm_model::executor::Sequential;
use gdcm_model::simulation::{FlightRecord, Signal};
use gdcm_sysid::identification::{Hold, Preparation};
use gdcm_sysid::spectra::gap::{Cause, Gap, Treatment};
use gdcm_sysid::spectra::preparation::{Prepared, prepare};
use gdcm_sysid::spectra::preparation_settings::PreparationError;
use gdcm_sysid::spectra::record_cautions::RecordCaution;

use super::common::{known_answers, list, matrix, noise};
use crate::synthetic::tries;

/// Returns a record of `samples` rows at 50 Hz: two inputs and two outputs that vary slowly
/// (low-pass filtered random numbers), without equal consecutive samples.
fn wandering(samples: usize) -> FlightRecord {
    let mut columns = Vec::new();
    for seed in 31..35 {
        let mut value = 0.0;
        let mut column = Vec::new();
        for step in noise(seed, samples) {
            value = 0.99 * value + step;
            column.push(value);
        }
        columns.push(column);
    }
    FlightRecord {
        name: "sweep".into(),
        time_s: (0..samples).map(|n| 0.02 * n as f64).collect(),
        inputs: DMatrix::from_fn(samples, 2, |n, i| columns[i][n]),
        outputs: DMatrix::from_fn(samples, 2, |n, o| columns[2 + o][n]),
    }
}

fn settings() -> Preparation {
    Preparation::new(&["LON", "PED"], &["P", "Q"])
}

fn prepared(record: &FlightRecord, settings: &Preparation) -> Prepared {
    prepare(std::slice::from_ref(record), settings, &Sequential).unwrap()
}

/// Returns whether a gap has these ends \[s\], rounded to 0.01 s.
fn is_between(gap: &Gap, start_s: f64, end_s: f64) -> bool {
    (gap.start_s - start_s).abs() < 0.005 && (gap.end_s - end_s).abs() < 0.005
}

fn names(signals: &[Signal]) -> Vec<&str> {
    signals.iter().map(|signal| signal.name.as_str()).collect()
}

#[test]
fn gaps_and_segments_of_a_record_equal_the_reference() {
    let known = known_answers();
    let case = &known["prepare"];
    let rows: Vec<Vec<f64>> = case["y"].as_array().unwrap().iter().map(list).collect();
    let record = FlightRecord {
        name: "synthetic".into(),
        time_s: list(&case["t"]),
        inputs: matrix(&case["u"]),
        outputs: DMatrix::from_fn(rows.len(), 2, |n, o| rows[n][o]),
    };
    let mut settings = Preparation::new(&["u"], &["y1", "y2"]);
    let delays = list(&case["delay_y"]);
    settings.outputs[0].delay_s = delays[0];
    settings.outputs[1].delay_s = delays[1];
    settings.least_segment_s = case["min_len_s"].as_f64().unwrap();
    settings.longest_bridge = case["max_gap"].as_u64().unwrap() as usize;
    let prepared = prepared(&record, &settings);
    let expected = case["pieces"].as_array().unwrap();
    assert_eq!(prepared.segments.len(), expected.len());
    for (segment, expected) in prepared.segments.iter().zip(expected) {
        assert!((segment.sample_time_s - expected["dt"].as_f64().unwrap()).abs() < 1e-9);
        assert_eq!(
            segment.inputs.nrows() as u64,
            expected["samples"].as_u64().unwrap()
        );
        assert!((segment.inputs[0] - expected["first_u"].as_f64().unwrap()).abs() < 1e-9);
        assert!((&segment.outputs - matrix(&expected["y"])).amax() < 1e-9);
    }
    let [missing_samples, missing_rows] = prepared.records[0].gaps.as_slice() else {
        panic!("{:?}", prepared.records[0].gaps)
    };
    assert!(is_between(missing_samples, 2.45, 2.60), "{missing_samples}");
    assert!(
        matches!(&missing_samples.cause, Cause::SamplesMissing(signals) if names(signals) == ["y1"])
    );
    assert!(is_between(missing_rows, 7.45, 9.50), "{missing_rows}");
    assert_eq!(missing_rows.cause, Cause::RowsMissing);
    assert_eq!(
        [missing_samples.treatment, missing_rows.treatment],
        [Treatment::Bridged, Treatment::CutOut]
    );
}

#[test]
fn a_record_without_gaps_is_unchanged() {
    let record = wandering(1000);
    let prepared = prepared(&record, &settings());
    assert_eq!(
        (
            prepared.segments.len(),
            prepared.cautions.len(),
            prepared.records[0].gaps.len()
        ),
        (1, 0, 0)
    );
    // Rounding: the time stamps 0.02 n and the grid times n 0.02 differ slightly, and values are
    // interpolated accordingly.
    assert!((&prepared.segments[0].inputs - &record.inputs).amax() < 1e-9);
    assert!((&prepared.segments[0].outputs - &record.outputs).amax() < 1e-9);
    assert!((prepared.records[0].used_s - 20.0).abs() < 1e-9);
}

#[test]
fn three_missing_samples_are_bridged_by_a_straight_line_and_four_split_the_record() {
    let mut record = wandering(1500);
    for n in 700..703 {
        record.outputs[(n, 1)] = f64::NAN;
    }
    let bridged = prepared(&record, &settings());
    assert_eq!(bridged.segments.len(), 1);
    let middle = 0.5 * (record.outputs[(699, 1)] + record.outputs[(703, 1)]);
    assert!((bridged.segments[0].outputs[(701, 1)] - middle).abs() < 1e-9);
    assert_eq!(bridged.records[0].gaps[0].treatment, Treatment::Bridged);

    record.outputs[(703, 1)] = f64::NAN;
    let split = prepared(&record, &settings());
    assert_eq!(split.segments.len(), 2);
    let gap = &split.records[0].gaps[0];
    assert!(is_between(gap, 13.98, 14.08), "{gap}");
    assert!(matches!(&gap.cause, Cause::SamplesMissing(signals) if names(signals) == ["Q"]));
    assert_eq!(gap.treatment, Treatment::CutOut);
    assert!((split.segments[1].start_s - 14.08).abs() < 0.021);
    // The samples of the second segment are those logged at its times.
    let first_row = (split.segments[1].start_s / 0.02).round() as usize;
    let logged = record.outputs.row(first_row + 10);
    assert!((split.segments[1].outputs.row(10) - logged).amax() < 1e-9);
}

#[test]
fn missing_time_stamps_and_missing_rows_are_gaps_of_different_cause() {
    let mut record = wandering(2000);
    record.time_s[600..650].fill(f64::NAN);
    for time_s in &mut record.time_s[1200..2000] {
        *time_s += 4.0;
    }
    let prepared = prepared(&record, &settings());
    let [missing_stamps, missing_rows] = prepared.records[0].gaps.as_slice() else {
        panic!("{:?}", prepared.records[0].gaps)
    };
    assert!(is_between(missing_stamps, 11.98, 13.00), "{missing_stamps}");
    assert!(is_between(missing_rows, 23.98, 28.00), "{missing_rows}");
    assert_eq!(
        [&missing_stamps.cause, &missing_rows.cause],
        [&Cause::StampsMissing, &Cause::RowsMissing]
    );
    assert_eq!(
        [missing_stamps.treatment, missing_rows.treatment],
        [Treatment::CutOut; 2]
    );
    assert_eq!(prepared.segments.len(), 3);
}

#[test]
fn segments_shorter_than_ten_seconds_are_dropped_with_a_caution() {
    // The gap leaves 7.8 s at the end of 30 s.
    let mut record = wandering(1500);
    record.outputs[(1100, 0)] = f64::NAN;
    for n in 1101..1110 {
        record.inputs[(n, 0)] = f64::NAN;
    }
    let prepared = prepared(&record, &settings());
    assert_eq!(prepared.segments.len(), 1);
    assert!(
        prepared.cautions.iter().any(|caution| matches!(
            caution,
            RecordCaution::SegmentDropped { record, start_s, length_s }
                if record == "sweep"
                    && (start_s - 22.2).abs() < 0.05
                    && (length_s - 7.8).abs() < 0.05
        )),
        "{:?}",
        prepared.cautions
    );
    assert!(matches!(
        prepared.records[0].gaps.last().unwrap().cause,
        Cause::SegmentTooShort(_)
    ));
}

#[test]
fn a_frozen_output_is_a_gap_while_other_channels_vary() {
    let mut record = wandering(2000);
    let value = record.outputs[(800, 0)];
    for n in 801..900 {
        record.outputs[(n, 0)] = value;
    }
    let cut = prepared(&record, &settings());
    assert_eq!(cut.segments.len(), 2);
    let gap = &cut.records[0].gaps[0];
    assert!(is_between(gap, 16.00, 18.00), "{gap}");
    assert!(matches!(&gap.cause, Cause::Frozen(signals) if names(signals) == ["P"]));
    assert_eq!(gap.treatment, Treatment::CutOut);
    let kept = prepared(
        &record,
        &Preparation {
            keep_frozen: true,
            ..settings()
        },
    );
    assert_eq!(kept.segments.len(), 1);
}

#[test]
fn a_constant_input_and_a_coarsely_quantised_output_are_not_frozen() {
    let mut record = wandering(3000);
    for n in 0..2000 {
        record.inputs[(n, 1)] = 50.0;
    }
    // Rounding a signal of magnitude 7 to multiples of 3 repeats values for a second or longer.
    for sample in record.outputs.column_mut(1).iter_mut() {
        *sample = (*sample / 3.0).round() * 3.0;
    }
    let prepared = prepared(&record, &settings());
    assert_eq!(prepared.segments.len(), 1, "{:?}", prepared.records);
}

#[test]
fn a_record_at_rest_before_its_sweep_is_not_frozen() {
    let mut record = wandering(2000);
    for n in 0..300 {
        record.inputs.row_mut(n).fill(40.0);
        record.outputs.row_mut(n).fill(0.0);
    }
    assert_eq!(prepared(&record, &settings()).segments.len(), 1);
}

#[test]
fn channels_with_the_same_gap_are_named_together() {
    let mut record = wandering(1500);
    for n in 600..640 {
        record.outputs.row_mut(n).fill(f64::NAN);
        record.inputs[(n, 0)] = f64::INFINITY;
    }
    let prepared = prepared(&record, &settings());
    assert_eq!(prepared.records[0].gaps.len(), 1);
    assert!(matches!(
        &prepared.records[0].gaps[0].cause,
        Cause::SamplesMissing(signals) if names(signals) == ["LON", "P", "Q"]
    ));
}

#[test]
fn delays_and_holds_shift_each_channel_in_the_right_direction() {
    // Every channel is a ramp of slope 1/s, so its shift in time is its value minus the time. A
    // held command acts on average half a hold later; a delayed output and the samples of a slow
    // sensor were measured before their time stamps.
    let time_s: Vec<f64> = (0..1000).map(|n| 0.02 * n as f64).collect();
    let ramp = DMatrix::from_fn(1000, 2, |n, _| 0.02 * n as f64);
    let record = FlightRecord {
        name: "ramp".into(),
        time_s,
        inputs: ramp.clone(),
        outputs: ramp,
    };
    let mut settings = settings();
    settings.outputs[0].delay_s = 0.05;
    settings.inputs[0].hold = Hold::Command { hold_s: 0.1 };
    settings.outputs[1].hold = Hold::SlowSensor { hold_s: 0.2 };
    let segment = prepared(&record, &settings).segments.remove(0);
    let time_s = segment.start_s + 0.02 * 100.0;
    let shifts = [
        segment.inputs[(100, 0)],
        segment.inputs[(100, 1)],
        segment.outputs[(100, 0)],
        segment.outputs[(100, 1)],
    ];
    for (value, shift) in shifts.iter().zip([-0.05, 0.0, 0.05, 0.1]) {
        assert!(
            (value - time_s - shift).abs() < 1e-9,
            "value {value} at {time_s} s, expected shift {shift} s"
        );
    }
}

#[test]
fn fresh_samples_of_a_slow_sensor_are_interpolated_linearly() {
    let mut record = wandering(1000);
    for n in 0..1000 {
        // A sine of 0.3 rad/s, sampled at every fifth row.
        let slow = (0.3 * 0.02 * (n / 5 * 5) as f64).sin();
        record.outputs[(n, 0)] = slow;
        // A constant value for ten seconds counts as samples of the sensor, not as a gap.
        record.inputs[(n, 1)] = if n < 500 { 20.0 } else { slow };
    }
    let mut settings = settings();
    settings.outputs[0].hold = Hold::FreshSamples;
    settings.inputs[1].hold = Hold::FreshSamples;
    let prepared = prepared(&record, &settings);
    assert_eq!(prepared.segments.len(), 1);
    for n in 0..990 {
        // Linear interpolation over 0.1 s of a sine of 0.3 rad/s has an error of (0.03)^2 / 8,
        // about 1e-4.
        assert!(
            (prepared.segments[0].outputs[(n, 0)] - (0.3 * 0.02 * n as f64).sin()).abs() < 1.2e-4,
            "{n}"
        );
    }
}

#[test]
fn a_sample_hold_in_an_input_raises_a_caution_with_its_share_and_duration() {
    // Each value is repeated for five samples, so that four of five are held.
    let mut record = wandering(2000);
    let stair: Vec<f64> = (0..2000).map(|n| record.inputs[(n / 5 * 5, 0)]).collect();
    record.inputs.column_mut(0).copy_from_slice(&stair);
    let mut settings = settings();
    let cautions = prepared(&record, &settings).cautions;
    assert!(
        matches!(
            cautions.as_slice(),
            [RecordCaution::SampleHold { signal, percent, hold_s }]
                if signal.name == "LON"
                    && signal.role == ChannelSide::Input
                    && (percent - 80.0).abs() < 0.5
                    && (hold_s - 0.1).abs() < 1e-9
        ),
        "{cautions:?}"
    );
    settings.inputs[0].hold = Hold::Acts;
    assert_eq!(prepared(&record, &settings).cautions, []);
}

#[test]
fn an_input_at_rest_between_its_sweeps_is_not_taken_for_a_sample_hold() {
    let mut record = wandering(3000);
    for n in 0..2500 {
        record.inputs[(n, 0)] = 50.0;
    }
    assert_eq!(prepared(&record, &settings()).cautions, []);
}

#[test]
fn uneven_stamps_are_refused_unless_resampling_is_allowed() {
    // A jitter of up to 8 ms, at a sample time of 20 ms.
    let mut record = wandering(1000);
    for (n, jitter) in noise(5, 1000).into_iter().enumerate() {
        record.time_s[n] += 0.008 * jitter;
        record.outputs[(n, 0)] = record.time_s[n].sin();
    }
    let refused = prepare(std::slice::from_ref(&record), &settings(), &Sequential).unwrap_err();
    assert!(matches!(refused, PreparationError::UnevenSampling { percent, .. } if percent > 20.0));
    let allowed = Preparation {
        resample: true,
        ..settings()
    };
    let prepared = prepared(&record, &allowed);
    assert!(
        prepared
            .cautions
            .iter()
            .any(|caution| matches!(caution, RecordCaution::Resampled { .. })),
        "{:?}",
        prepared.cautions
    );
    let segment = &prepared.segments[0];
    for n in 0..segment.outputs.nrows() {
        // Linear interpolation over at most 0.036 s of a sine of 1 rad/s has an error of 0.036^2 /
        // 8 = 1.6e-4.
        let time_s = segment.start_s + n as f64 * segment.sample_time_s;
        assert!((segment.outputs[(n, 0)] - time_s.sin()).abs() < 1.7e-4);
    }
}

#[test]
fn a_single_late_time_stamp_is_tolerated() {
    let mut record = wandering(1000);
    record.time_s[400] += 0.009;
    assert_eq!(prepared(&record, &settings()).segments.len(), 1);
}

#[test]
fn time_that_does_not_increase_is_refused_with_its_row() {
    let mut record = wandering(1000);
    record.time_s[617] = record.time_s[616];
    let error = prepare(std::slice::from_ref(&record), &settings(), &Sequential).unwrap_err();
    assert!(
        matches!(
            error,
            PreparationError::TimeNotIncreasing { row: 617, previous_s, time_s, .. }
                if previous_s == 12.32 && time_s == 12.32
        ),
        "{error:?}"
    );
}

#[test]
fn constant_channels_are_refused_by_name() {
    let mut record = wandering(1000);
    record.inputs.column_mut(1).fill(50.0);
    record.outputs.column_mut(0).fill(0.1);
    let error = prepare(&[record], &settings(), &Sequential).unwrap_err();
    assert!(
        matches!(&error, PreparationError::Constant(signals) if names(signals) == ["PED", "P"]),
        "{error:?}"
    );
}

#[test]
fn copied_channels_correlated_inputs_and_wrong_units_raise_cautions() {
    let mut record = wandering(1000);
    let stick = record.inputs.column(0).into_owned();
    // P is a linear function of LON, and PED moves almost like LON.
    record
        .outputs
        .column_mut(0)
        .copy_from(&(&stick * -2.0).add_scalar(5.0));
    let pedal = record.inputs.column(1) * 0.05 + &stick;
    record.inputs.column_mut(1).copy_from(&pedal);
    // A wrong unit scales every sample; a single large one would be a spike.
    let rate = record.outputs.column(1) * (400.0 / record.outputs.column(1).amax());
    record.outputs.column_mut(1).copy_from(&rate);
    let mut settings = settings();
    settings.outputs[1].limit = Some(300.0);
    let cautions = prepared(&record, &settings).cautions;
    assert!(
        cautions.iter().any(|caution| matches!(
            caution,
            RecordCaution::UnlikelyUnit { signal, greatest, limit: 300.0 }
                if signal.name == "Q" && (greatest - 400.0).abs() < 1e-6
        )),
        "{cautions:?}"
    );
    assert!(
        cautions.iter().any(|caution| matches!(
            caution,
            RecordCaution::MovedTogether { signals, .. } if names(signals) == ["LON", "PED"]
        )),
        "{cautions:?}"
    );
    assert!(
        cautions.iter().any(|caution| matches!(
            caution,
            RecordCaution::Copy { copy, of }
                if copy.name == "P" && of.name == "LON" && of.role == ChannelSide::Input
        )),
        "{cautions:?}"
    );
}

#[test]
fn too_short_records_are_refused_with_their_length() {
    let error = prepare(&[wandering(300)], &settings(), &Sequential).unwrap_err();
    assert!(
        matches!(
            error,
            PreparationError::NothingLeft { longest_s, least_s: 10.0 }
                if (longest_s - 6.0).abs() < 0.05
        ),
        "{error:?}"
    );
}

#[test]
fn a_record_without_any_sample_is_left_out() {
    let mut empty = wandering(1000);
    empty.name = "empty".into();
    empty.outputs.fill(f64::NAN);
    let prepared = prepare(&[empty, wandering(1000)], &settings(), &Sequential).unwrap();
    assert_eq!(prepared.segments.len(), 1);
    assert_eq!(prepared.segments[0].record, 1);
    assert!(
        prepared
            .cautions
            .contains(&RecordCaution::RecordUnused("empty".to_owned())),
        "{:?}",
        prepared.cautions
    );
    assert_eq!(prepared.records[0].used_s, 0.0);
}

#[test]
fn unusable_records_and_settings_are_refused() {
    let good = wandering(1000);
    let prepare_one = |record: FlightRecord| prepare(&[record], &settings(), &Sequential);
    assert_eq!(
        prepare(&[], &settings(), &Sequential),
        Err(PreparationError::NoRecords)
    );
    assert!(matches!(
        prepare(
            std::slice::from_ref(&good),
            &Preparation::new(&[], &["P"]),
            &Sequential
        ),
        Err(PreparationError::NoChannels(_))
    ));
    for rows in 0..3 {
        let first_rows = FlightRecord {
            time_s: good.time_s[..rows].to_vec(),
            inputs: good.inputs.rows(0, rows).into(),
            outputs: good.outputs.rows(0, rows).into(),
            ..good.clone()
        };
        assert!(
            matches!(
                prepare_one(first_rows),
                Err(PreparationError::NothingLeft { .. })
            ),
            "{rows}"
        );
    }
    let three_inputs = FlightRecord {
        inputs: DMatrix::zeros(1000, 3),
        ..good.clone()
    };
    assert!(matches!(
        prepare_one(three_inputs),
        Err(PreparationError::ChannelsDiffer {
            found: 3,
            named: 2,
            ..
        })
    ));
    let few_stamps = FlightRecord {
        time_s: vec![0.0; 7],
        ..good.clone()
    };
    assert!(matches!(
        prepare_one(few_stamps),
        Err(PreparationError::LengthsDiffer { stamps: 7, .. })
    ));
    for value in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let without_time = FlightRecord {
            time_s: vec![value; 1000],
            ..good.clone()
        };
        assert!(matches!(
            prepare_one(without_time),
            Err(PreparationError::NothingLeft { .. })
        ));
        let without_outputs = FlightRecord {
            outputs: DMatrix::from_element(1000, 2, value),
            ..good.clone()
        };
        assert!(matches!(
            prepare_one(without_outputs),
            Err(PreparationError::NothingLeft { .. })
        ));
    }
    // One absurd time stamp is cut off, because the grid covers only times with samples.
    let mut far = good.clone();
    far.time_s[999] = 1e300;
    assert_eq!(prepare_one(far).unwrap().segments.len(), 1);
    let mut infinite = good.clone();
    infinite.time_s[0] = -1.7e308;
    infinite.time_s[999] = 1.7e308;
    assert!(prepare_one(infinite).is_err(), "the duration overflows");
    for seconds in [f64::NAN, f64::INFINITY, 1e9] {
        let mut shifted = settings();
        shifted.inputs[0].delay_s = seconds;
        assert!(matches!(
            prepare(std::slice::from_ref(&good), &shifted, &Sequential),
            Err(PreparationError::Shift { .. })
        ));
        let negative_length = Preparation {
            least_segment_s: -seconds,
            ..settings()
        };
        assert!(matches!(
            prepare(std::slice::from_ref(&good), &negative_length, &Sequential),
            Err(PreparationError::LeastSegment(_))
        ));
    }
    let bridge = Preparation {
        longest_bridge: usize::MAX,
        ..settings()
    };
    assert!(matches!(
        prepare(std::slice::from_ref(&good), &bridge, &Sequential),
        Err(PreparationError::Bridge(_))
    ));
    let mut huge = good;
    huge.outputs[(3, 0)] = 1e300;
    assert!(
        prepare(&[huge], &settings(), &Sequential).is_ok_and(|prepared| prepared
            .segments
            .iter()
            .all(|p| p.outputs.iter().all(|y| y.is_finite())))
    );
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(tries(16, 48)))]

    #[test]
    fn segments_are_finite_equal_the_samples_and_are_not_longer_than_the_record(
        holes in prop::collection::vec((0_usize..3000, 1_usize..40, 0_usize..5), 0..12),
        delay_s in -0.2..0.2,
    ) {
        let mut record = wandering(3000);
        for &(from, length, channel) in &holes {
            for n in from..(from + length).min(3000) {
                match channel {
                    0 | 1 => record.inputs[(n, channel)] = f64::NAN,
                    2 | 3 => record.outputs[(n, channel - 2)] = f64::INFINITY,
                    _ => record.time_s[n] = f64::NAN,
                }
            }
        }
        let mut settings = settings();
        settings.least_segment_s = 1.0;
        settings.outputs[0].delay_s = delay_s;
        let prepared = prepared(&record, &settings);
        let finite_inputs = record.inputs.iter().filter(|x| x.is_finite());
        let greatest = finite_inputs.fold(0.0_f64, |a, b| a.max(b.abs()));
        // 3000 samples of 0.02 s.
        prop_assert!(prepared.records[0].used_s <= 60.0 + 1e-9);
        for segment in &prepared.segments {
            prop_assert!(segment.outputs.iter().all(|y| y.is_finite()));
            prop_assert!(segment.inputs.amax() <= greatest);
            prop_assert_eq!(segment.inputs.nrows(), segment.outputs.nrows());
            // The first input is not delayed, so that its samples are those logged.
            for n in 0..segment.inputs.nrows() {
                let row = (segment.start_s / 0.02).round() as usize + n;
                let logged = record.inputs[(row, 0)];
                if logged.is_finite() && record.time_s[row].is_finite() {
                    prop_assert!((segment.inputs[(n, 0)] - logged).abs() < 1e-9);
                }
            }
        }
        // Gaps of up to three samples are bridged, so that longer ones separate the segments.
        for pair in prepared.segments.windows(2) {
            let separation_s = pair[1].start_s - pair[0].start_s;
            prop_assert!(separation_s > 0.02 * (pair[0].inputs.nrows() as f64 + 2.5));
        }
    }

    #[test]
    fn each_record_is_prepared_independently(order in Just(vec![0_usize, 1, 2]).prop_shuffle()) {
        let mut records = Vec::new();
        for k in 0..3 {
            let mut record = wandering(1000 + 200 * k);
            record.outputs.scale_mut(1.0 + k as f64);
            records.push(record);
        }
        let in_order = prepare(&records, &settings(), &Sequential).unwrap();
        let shuffled: Vec<_> = order.iter().map(|&k| records[k].clone()).collect();
        let prepared = prepare(&shuffled, &settings(), &Sequential).unwrap();
        for (segment, &k) in prepared.segments.iter().zip(&order) {
            prop_assert_eq!(&segment.outputs, &in_order.segments[k].outputs);
        }
    }
}
