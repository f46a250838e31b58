//! Proposed layouts and their problems.

use std::collections::BTreeMap;

use gdcm_model::dataset::channel::ChannelSide;
use gdcm_model::names::ChannelRule;

use super::column_use::ColumnUse;
use super::laid_out_record::LaidOutRecord;
use super::layout_note::{ColumnConversion, LayoutNote, TimeUnitReason};
use super::layout_problem::{LayoutCaution, LayoutProblem};
use super::layout_proposal::{LayoutProposal, TimeSettings};
use super::record_channels::{DeclaredConversion, RecordChannels};
use super::record_guess::RecordGuess;
use super::record_layout::RecordLayout;
use super::record_table::{RecordColumn, RecordSource, RecordTable};

fn rule(name: &str, unit: &str) -> ChannelRule {
    ChannelRule {
        unit: unit.to_owned(),
        ..ChannelRule::named(name)
    }
}

/// The channels of the dataset: two inputs and two outputs.
pub(super) fn channels() -> RecordChannels {
    RecordChannels {
        inputs: vec![rule("LON", "%"), rule("LAT", "%")],
        outputs: vec![rule("P", "deg/s"), rule("NZ", "m/s²")],
        ..RecordChannels::default()
    }
}

/// A column of 60 samples; `values` has the number of the sample as its argument.
pub(super) fn column(name: &str, unit: &str, values: impl Fn(f64) -> f64) -> RecordColumn {
    let values = (0..60).map(|sample| values(f64::from(sample))).collect();
    RecordColumn {
        unit: Some(unit.to_owned()).filter(|unit| !unit.is_empty()),
        ..RecordColumn::new(name, values)
    }
}

fn table(columns: Vec<RecordColumn>) -> RecordTable {
    RecordTable {
        source: RecordSource {
            file: "lon_1.csv".into(),
            sha256: "ab".into(),
            variable: None,
        },
        ..RecordTable::new("LON 1", columns)
    }
}

/// A record at 50 Hz whose column names and order are those of another program.
pub(super) fn record() -> RecordTable {
    table(vec![
        column("nz", "g", |k| 0.1 * (0.3 * k).sin()),
        column("Time (s)", "s", |k| 0.02 * k),
        column("lateral", "%", |k| 50.0 + 5.0 * (0.2 * k).cos()),
        column("roll rate", "rad/s", |k| 0.2 * (0.2 * k).sin()),
        column("delta_b", "", |k| 40.0 + k),
        column("fuel", "kg", |_| 900.0),
    ])
}

pub(super) fn proposed(table: &RecordTable) -> LayoutProposal {
    RecordLayout::proposed(table, &channels(), &TimeSettings::default())
}

/// The layout proposed for the channels, which must have no problem.
fn accepted(table: &RecordTable, channels: &RecordChannels) -> RecordLayout {
    let proposal = RecordLayout::proposed(table, channels, &TimeSettings::default());
    assert_eq!(proposal.problems, []);
    proposal.layout
}

fn column_note(channel: &str, column: &str, conversion: ColumnConversion) -> LayoutNote {
    LayoutNote::Column {
        channel: channel.to_owned(),
        column: format!("\"{column}\""),
        conversion,
    }
}

fn converted(from: &str, to: &str, factor: f64) -> ColumnConversion {
    ColumnConversion::Converted {
        from: from.to_owned(),
        to: to.to_owned(),
        factor,
    }
}

#[test]
fn channels_are_found_by_synonyms_and_converted_with_notes() {
    let table = record();
    let channels = channels();
    let proposal = proposed(&table);
    assert_eq!(
        (proposal.problems.len(), proposal.cautions.len()),
        (0, 0),
        "{proposal:?}"
    );
    let percent = "%".to_owned();
    assert_eq!(
        proposal.notes,
        [
            LayoutNote::TimeColumn {
                column: "\"Time (s)\"".to_owned(),
                unit: "s",
                reason: TimeUnitReason::Given,
            },
            column_note(
                "LON",
                "delta_b",
                ColumnConversion::OnlyPlausibleUnit {
                    unit: percent.clone(),
                    factor: 1.0
                }
            ),
            column_note("LAT", "lateral", ColumnConversion::SameUnit(percent)),
            column_note(
                "P",
                "roll rate",
                converted("rad/s", "deg/s", 57.29577951308232)
            ),
            column_note("NZ", "nz", converted("g", "m/s²", 9.80665)),
        ]
    );
    let flight = proposal.layout.flight_record(&table, &channels).unwrap();
    assert_eq!(
        (
            flight.time_s[3],
            flight.inputs[(3, 0)],
            flight.inputs.shape()
        ),
        (0.06, 43.0, (60, 2))
    );
    assert_eq!(
        flight.outputs[(2, 1)],
        9.806_65 * table.columns[0].values[2]
    );
    let entry = proposal
        .layout
        .condition_record(&table, &RecordGuess::default(), &channels);
    assert_eq!(
        (entry.file.as_str(), entry.sha256.as_deref()),
        ("lon_1.csv", Some("ab"))
    );
    assert!(
        (entry.sample_time_s.unwrap() - 0.02).abs() < 1e-14,
        "the sample time is a difference of two time stamps"
    );
}

#[test]
fn an_implausible_rate_is_refused_with_the_likely_unit() {
    // 20 rad/s are 1146 deg/s; at most 400 deg/s are plausible.
    let mut table = record();
    table.columns[3] = column("roll rate", "rad/s", |k| 20.0 * (0.2 * k).sin());
    let problems = proposed(&table).problems;
    let [
        LayoutProblem::Magnitude {
            channel,
            value,
            most,
            likely_unit,
            ..
        },
    ] = problems.as_slice()
    else {
        panic!("{problems:?}");
    };
    assert_eq!(channel, "P");
    assert!((value - 1146.0).abs() < 0.5, "{value}");
    assert!((most - 400.0).abs() < 1e-9, "{most}");
    assert_eq!(*likely_unit, Some("deg/s"));
}

/// The proposal for a roll rate up to `peak` with the unit `unit_in_file` in the file.
fn with_roll_rate(unit_in_file: &str, peak: f64, unit: &str) -> LayoutProposal {
    let mut channels = channels();
    channels.outputs[0].unit = unit.to_owned();
    let mut table = record();
    table.columns[3] = column("roll rate", unit_in_file, |k| peak * (k - 30.0) / 30.0);
    let proposal = RecordLayout::proposed(&table, &channels, &TimeSettings::default());
    assert_eq!(
        proposal.layout.flight_record(&table, &channels).is_ok(),
        proposal.problems.is_empty()
    );
    proposal
}

fn caution_codes(layout: &RecordLayout, table: &RecordTable) -> Vec<&'static str> {
    let cautions = layout.cautions(table, &channels());
    cautions.iter().map(LayoutCaution::code).collect()
}

#[test]
fn an_assumed_unit_is_a_caution_until_it_is_confirmed_or_chosen() {
    let channels = channels();
    let mut table = record();
    table.columns[3] = column("roll rate", "", |k| 2.0 * (k - 30.0) / 30.0);
    let open = RecordLayout::proposed(&table, &channels, &TimeSettings::default()).layout;
    assert_eq!(open.problems(&table, &channels).len(), 1);
    let assumed = open.assuming_units_of_channels();
    assert_eq!(assumed.problems(&table, &channels), []);
    assert_eq!(caution_codes(&assumed, &table), ["unit-assumed"]);
    assert_eq!(
        caution_codes(&assumed.in_units_of_channels(), &table),
        [""; 0]
    );
    let mut chosen = assumed.clone();
    chosen.outputs[0] = chosen.outputs[0].map(|used| used.in_unit("rad/s", "deg/s"));
    assert_eq!(caution_codes(&chosen, &table), [""; 0]);
    assert_eq!(
        assumed.assuming_units_of_channels(),
        assumed,
        "a second assumption changes nothing"
    );
}

#[test]
fn the_only_plausible_unit_is_used_and_an_ambiguous_unit_is_a_problem() {
    // 6.9 may be deg/s or rad/s: 6.9 rad/s are 395 deg/s, which is plausible for a helicopter.
    // 7.1 rad/s are 407 deg/s, which is not: 7.1 must be deg/s.
    assert_eq!(
        with_roll_rate("", 6.9, "deg/s").problems,
        [LayoutProblem::UnitNotGiven {
            channel: "P".into(),
            column: "\"roll rate\"".into(),
            unit: "deg/s".into(),
            units: vec!["deg/s".to_owned(), "rad/s".to_owned()],
        }]
    );
    let unambiguous = with_roll_rate("", 7.1, "deg/s");
    assert!(
        matches!(
            &unambiguous.notes[3],
            LayoutNote::Column {
                conversion: ColumnConversion::OnlyPlausibleUnit { unit, factor: 1.0 },
                ..
            } if unit == "deg/s"
        ),
        "{:?}",
        unambiguous.notes
    );
    let degree = std::f64::consts::PI / 180.0;
    for (unit_in_file, peak, unit, factor) in [
        ("", 7.1, "deg/s", 1.0),
        // No helicopter turns at 40 rad/s: the samples are in degrees per second.
        ("", 40.0, "rad/s", degree),
        ("deg/s", 6.9, "deg/s", 1.0),
        // Samples of zero do not determine a unit.
        ("", 0.0, "deg/s", 1.0),
        // An unknown unit is not converted.
        ("", 6.9, "furlong", 1.0),
    ] {
        let proposal = with_roll_rate(unit_in_file, peak, unit);
        assert_eq!(proposal.problems, [], "{unit_in_file} {peak} {unit}");
        assert_eq!(proposal.layout.outputs[0].unwrap().factor, factor);
    }
}

#[test]
fn a_unit_declared_by_the_user_applies_to_files_without_units() {
    let mut table = record();
    table.columns[3].unit = None;
    let mut channels = channels();
    channels
        .declared
        .insert("P".to_owned(), DeclaredConversion::Unit("rad/s".to_owned()));
    let declared = RecordLayout::proposed(&table, &channels, &TimeSettings::default());
    assert_eq!(
        (
            declared.problems.len(),
            declared.layout.outputs[0].unwrap().factor
        ),
        (0, 180.0 / std::f64::consts::PI)
    );
    // Reading the record again with the dataset, in deg/s, gives the same samples.
    let entry = declared
        .layout
        .condition_record(&table, &RecordGuess::default(), &channels);
    let dataset_channels = RecordChannels {
        declared: BTreeMap::new(),
        ..channels.clone()
    }
    .of_named_records();
    let reread =
        LaidOutRecord::proposed(table.clone(), &dataset_channels, &TimeSettings::default())
            .0
            .with_entry(&entry, &dataset_channels);
    assert_eq!(
        reread.flight.as_deref(),
        Some(&declared.layout.flight_record(&table, &channels).unwrap())
    );
}

/// Problems of the record with this column as its time.
fn problems_with_time(time: RecordColumn) -> Vec<LayoutProblem> {
    let mut table = record();
    table.columns[1] = time;
    proposed(&table).problems
}

#[test]
fn a_time_that_decreases_is_refused() {
    let slip = column("t", "s", |k| if k == 30.0 { 0.1 } else { 0.02 * k });
    assert_eq!(
        problems_with_time(slip),
        [LayoutProblem::TimeOrder {
            column: "\"t\"".into(),
            count: 1,
            samples: 60,
            sample: 31,
            before: 0.58,
            after: 0.1,
        }]
    );
}

#[test]
fn a_time_with_steps_of_six_seconds_is_refused() {
    let problems = problems_with_time(column("t", "min", |k| 0.1 * k));
    let [LayoutProblem::TimeStep { column, step_s }] = problems.as_slice() else {
        panic!("{problems:?}");
    };
    assert_eq!(column, "\"t\"");
    assert!((step_s - 6.0).abs() < 1e-9, "{step_s}");
}

#[test]
fn a_time_without_a_unit_in_steps_of_twenty_is_in_milliseconds() {
    assert_eq!(problems_with_time(column("t", "", |k| 20.0 * k)), []);
}

#[test]
fn a_record_without_time_uses_the_sample_time_given_by_the_user() {
    let without_time = problems_with_time(column("count", "", |k| k));
    let [LayoutProblem::NoTime(columns)] = without_time.as_slice() else {
        panic!("{without_time:?}");
    };
    assert_eq!(columns[..2], ["nz", "count"]);
    let mut table = record();
    table.columns.remove(1);
    let given_sample_time = TimeSettings {
        sample_time_s: Some(0.02),
        column: None,
    };
    let proposal = RecordLayout::proposed(&table, &channels(), &given_sample_time);
    assert_eq!(proposal.problems, []);
    let missing_column = TimeSettings {
        sample_time_s: None,
        column: Some("clock".into()),
    };
    let proposal = RecordLayout::proposed(&table, &channels(), &missing_column);
    let Some(LayoutProblem::NoSuchColumn { name, found }) = proposal.problems.first() else {
        panic!("{:?}", proposal.problems);
    };
    assert_eq!(name, "clock");
    assert_eq!(found[0], "nz");
}

#[test]
fn missing_ambiguous_and_inconvertible_channels_are_problems() {
    let mut table = record();
    table.columns[0].name = "vibration".into();
    table.columns[2].unit = Some("in".into());
    table.columns.push(column("pb", "deg/s", |k| k.sin()));
    let problems = proposed(&table).problems;
    let expected = [
        LayoutProblem::Conversion {
            channel: "LAT".into(),
            column: "\"lateral\"".into(),
            from: "in".into(),
            to: "%".into(),
        },
        LayoutProblem::SeveralColumns {
            side: ChannelSide::Output,
            channel: "P".into(),
            found: vec!["\"roll rate\"".to_owned(), "\"pb\"".to_owned()],
        },
        LayoutProblem::NoColumn {
            side: ChannelSide::Output,
            channel: "NZ".into(),
            found: table.column_names(),
        },
    ];
    assert_eq!(problems, expected);
    // The user chooses columns and factors.
    let mut layout = proposed(&table).layout;
    layout.outputs = vec![
        Some(ColumnUse::as_it_is(6)),
        Some(ColumnUse::times(0, 9.80665)),
    ];
    layout.inputs[1] = Some(ColumnUse::times(2, -8.0));
    let problems = layout.problems(&table, &channels());
    let [LayoutProblem::Magnitude { channel, value, .. }] = problems.as_slice() else {
        panic!("{problems:?}");
    };
    assert_eq!(channel, "LAT");
    assert!((value - 440.0).abs() < 1e-9, "{value}");
    layout.inputs[1] = Some(ColumnUse::times(2, -2.0));
    assert_eq!(layout.problems(&table, &channels()), []);
    let flight = layout.flight_record(&table, &channels()).unwrap();
    assert_eq!(flight.inputs[(0, 1)], -110.0);
    layout.inputs[1] = Some(ColumnUse::as_it_is(4));
    assert_eq!(
        layout.problems(&table, &channels()),
        [LayoutProblem::OneColumn {
            first: "LAT".into(),
            second: "LON".into(),
            column: "\"delta_b\"".into(),
        }]
    );
    layout.inputs[1] = Some(ColumnUse::times(99, f64::NAN));
    assert!(layout.flight_record(&table, &channels()).is_err());
}

fn numbered_rule(name: &str, unit: &str, number: &str) -> ChannelRule {
    ChannelRule {
        unit_in_files: Some(unit.into()),
        aliases: vec![number.into()],
        ..rule(name, unit)
    }
}

#[test]
fn columns_without_names_are_not_guessed_but_found_by_their_numbers() {
    let mut table = table(
        (0..5)
            .map(|index| column("", "", move |k| 0.02 * k * f64::from(index + 1)))
            .collect(),
    );
    table.named = false;
    for (index, column) in table.columns.iter_mut().enumerate() {
        column.name = format!("column {}", index + 1);
    }
    let proposal = proposed(&table);
    assert_eq!(
        proposal.problems,
        [LayoutProblem::Unnamed {
            channel: "LON".into(),
            found: 5
        }]
    );
    assert_eq!(proposal.layout.inputs, [None, None]);
    let channels = RecordChannels {
        inputs: vec![
            numbered_rule("LON", "%", "#3"),
            numbered_rule("LAT", "%", "#2"),
        ],
        outputs: vec![
            numbered_rule("P", "deg/s", "#5"),
            numbered_rule("NZ", "m/s²", "-#4"),
        ],
        ..RecordChannels::default()
    };
    let layout = accepted(&table, &channels);
    assert_eq!(
        layout.inputs,
        [Some(ColumnUse::as_it_is(2)), Some(ColumnUse::as_it_is(1))]
    );
    assert_eq!(
        layout.outputs,
        [
            Some(ColumnUse::as_it_is(4)),
            Some(ColumnUse::times(3, -1.0))
        ]
    );
}

/// A record with a time column and this column.
fn acceleration_table(name: &str) -> RecordTable {
    table(vec![
        column("t", "s", |k| 0.02 * k),
        column(name, "", |k| k.sin()),
    ])
}

/// The output NZ, with an optional alias.
fn acceleration_channels(alias: Option<&str>) -> RecordChannels {
    RecordChannels {
        outputs: vec![ChannelRule {
            aliases: alias.into_iter().map(str::to_owned).collect(),
            ..rule("NZ", "m/s²")
        }],
        ..RecordChannels::default()
    }
}

/// The proposal of NZ from this column, with an optional alias.
fn with_acceleration(name: &str, alias: Option<&str>) -> LayoutProposal {
    let channels = acceleration_channels(alias);
    RecordLayout::proposed(
        &acceleration_table(name),
        &channels,
        &TimeSettings::default(),
    )
}

#[test]
fn the_sign_comes_from_the_column_name_or_from_the_user() {
    for (name, alias, factor) in [
        ("NZ", None, 1.0),
        ("-nz", None, -1.0),
        ("az (down)", None, -1.0),
        ("az[+down]", None, -1.0),
        ("az (up)", None, 1.0),
        ("az", Some("az"), 1.0),
        ("az", Some("-az"), -1.0),
        ("az (down)", Some("az"), -1.0),
        ("az (down)", Some("az (down)"), -1.0),
        ("-normal", Some("normal"), -1.0),
    ] {
        let proposal = with_acceleration(name, alias);
        let used = proposal.layout.outputs[0].unwrap();
        assert_eq!(used.factor, factor, "{name} {alias:?}");
    }
    assert_eq!(
        with_acceleration("az", None).problems,
        [LayoutProblem::Sign {
            channel: "NZ".into(),
            column: "az".into(),
            plain: "az".into(),
        }]
    );
}

#[test]
fn a_column_of_a_matrix_is_found_by_its_index_in_python_and_in_matlab() {
    let table = table(
        (1..4)
            .map(|number| column(&format!("xyz_{number}"), "", |k| k))
            .collect(),
    );
    let found = [
        "xyz[0]", "XYZ(1)", "xyz[2]", "#2", "xyz[3]", "xyz(0)", "xyz[-1]",
    ]
    .map(|name| table.find(name));
    assert_eq!(
        found,
        [Some(0), Some(0), Some(2), Some(1), None, None, None]
    );
}

/// Number of inputs proposed from columns LAT and LON with this slope.
fn inputs_with_slope(slope: f64) -> usize {
    let mut table = table(vec![
        column("t", "s", |k| 0.02 * k),
        column("LAT", "", move |k| 45.0 + slope * k),
        column("LON", "", move |k| 9.0 + slope * k),
        column("P", "deg/s", |k| k.sin()),
        column("NZ", "m/s²", |k| k.cos()),
    ]);
    table.columns[4].unit = None;
    proposed(&table).layout.inputs.iter().flatten().count()
}

#[test]
fn slow_geographic_coordinates_are_not_taken_for_sticks() {
    assert_eq!(inputs_with_slope(1e-5), 0, "a latitude and a longitude");
    assert_eq!(inputs_with_slope(0.1), 2, "sticks");
}

fn marked_column(name: &str, side: ChannelSide, scale: f64) -> RecordColumn {
    RecordColumn {
        side: Some(side),
        ..column(name, "", move |k| scale * k.sin())
    }
}

#[test]
fn inputs_and_outputs_marked_in_the_file_are_used_in_their_order() {
    let mut table = table(vec![
        column("t", "", |k| 0.01 * k),
        marked_column("inr_1", ChannelSide::Input, 10.0),
        marked_column("inr_2", ChannelSide::Input, 20.0),
        marked_column("outr_1", ChannelSide::Output, 30.0),
        marked_column("outr_2", ChannelSide::Output, 40.0),
    ]);
    table.columns[4].unit = Some("m/s^2".to_owned());
    let layout = accepted(&table, &channels());
    assert_eq!(
        layout.inputs,
        [Some(ColumnUse::as_it_is(1)), Some(ColumnUse::as_it_is(2))]
    );
    assert_eq!(layout.outputs[1], Some(ColumnUse::as_it_is(4)));
}

#[test]
fn channels_without_a_unit_adopt_that_of_the_first_file_and_later_files_are_converted() {
    let mut channels = RecordChannels {
        outputs: vec![ChannelRule::named("P")],
        ..RecordChannels::default()
    };
    let first = record();
    let mut second = record();
    let layout = RecordLayout::proposed(&first, &channels, &TimeSettings::default()).layout;
    channels.take_units(&layout, &first);
    assert_eq!(channels.outputs[0].unit, "rad/s");
    second.columns[3].unit = Some("deg/s".into());
    let proposal = RecordLayout::proposed(&second, &channels, &TimeSettings::default());
    assert_eq!(
        proposal.layout.outputs[0].unwrap().factor,
        std::f64::consts::PI / 180.0
    );
}

#[test]
fn an_alias_finds_its_column_in_any_spelling() {
    let table = table(vec![
        column("t", "s", |k| 0.1 * k),
        column("elev,yoke1", "", |k| k.sin()),
        column("lon", "deg", |k| 2.0 + 0.001 * k),
    ]);
    let mut channels = RecordChannels {
        inputs: vec![ChannelRule::named("LON")],
        ..RecordChannels::default()
    };
    let yoke = [Some(ColumnUse::as_it_is(1))];
    assert_eq!(
        accepted(&table, &channels).inputs,
        yoke,
        "LON must not be the longitude"
    );
    channels.inputs[0].aliases = vec!["elev_yoke1".to_owned()];
    assert_eq!(accepted(&table, &channels).inputs, yoke);
}

/// The proposal for a record with these columns lat and lon.
fn with_position(lat: RecordColumn, lon: RecordColumn) -> LayoutProposal {
    proposed(&table(vec![
        column("t", "s", |k| 0.02 * k),
        lat,
        lon,
        column("P", "deg/s", |k| 10.0 * (0.2 * k).sin()),
        column("NZ", "g", |k| 1.0 + 0.1 * (0.3 * k).sin()),
    ]))
}

#[test]
fn columns_named_lat_and_lon_are_sticks_only_if_they_move_like_sticks() {
    for unit in ["", "deg"] {
        let found = with_position(
            column("lat", unit, |k| 47.6 + 1e-5 * k),
            column("lon", unit, |k| 8.5 - 2e-5 * k),
        );
        let missing = found.problems.iter().filter(|p| p.is_missing()).count();
        assert_eq!(missing, 2, "{unit}: {found:?}");
        assert_eq!(found.layout.inputs, [None, None], "{unit}");
    }
    // A constant stick beside a moving stick is still a stick.
    let sticks = with_position(
        column("lat", "", |_| 50.0),
        column("lon", "", |k| 50.0 + 8.0 * (0.1 * k).sin()),
    );
    assert_eq!(
        sticks.layout.inputs,
        [Some(ColumnUse::as_it_is(2)), Some(ColumnUse::as_it_is(1))],
        "{sticks:?}"
    );
}

/// The proposal for a record without column names, with NZ from the column with this number.
fn with_numbers(last: &str) -> LayoutProposal {
    let mut table = record();
    table.named = false;
    for (index, column) in table.columns.iter_mut().enumerate() {
        column.name = format!("column {}", index + 1);
    }
    let mut channels = RecordChannels {
        inputs: vec![ChannelRule::named("LON")],
        outputs: vec![ChannelRule::named("P"), ChannelRule::named("NZ")],
        ..RecordChannels::default()
    };
    channels.inputs[0].aliases = vec!["#5".to_owned()];
    channels.outputs[0].aliases = vec!["#4".to_owned()];
    channels.outputs[1].aliases = vec![last.to_owned()];
    let time = TimeSettings {
        column: Some("#2".to_owned()),
        sample_time_s: None,
    };
    RecordLayout::proposed(&table, &channels, &time)
}

#[test]
fn time_and_channels_without_names_are_found_by_their_numbers() {
    let found = with_numbers("#1");
    assert_eq!(found.problems, [], "{found:?}");
    assert_eq!(found.layout.inputs, [Some(ColumnUse::as_it_is(4))]);
    assert_eq!(
        found.layout.outputs,
        [Some(ColumnUse::as_it_is(3)), Some(ColumnUse::as_it_is(0))]
    );
    let missing = with_numbers("#7");
    let [LayoutProblem::NoColumn { side, channel, .. }] = missing.problems.as_slice() else {
        panic!("{missing:?}");
    };
    assert_eq!(*side, ChannelSide::Output);
    assert_eq!(channel, "NZ");
}

#[test]
fn a_unit_or_factor_declared_by_the_user_overrides_the_file() {
    let mut channels = channels();
    channels
        .declared
        .insert("NZ".to_owned(), DeclaredConversion::Factor(-9.8));
    channels
        .declared
        .insert("P".to_owned(), DeclaredConversion::Unit("deg/s".to_owned()));
    let found = RecordLayout::proposed(&record(), &channels, &TimeSettings::default());
    assert_eq!(
        found
            .layout
            .outputs
            .iter()
            .map(|used| used.unwrap().factor)
            .collect::<Vec<_>>(),
        [1.0, -9.8]
    );
    let note = LayoutNote::Column {
        channel: "NZ".to_owned(),
        column: "\"nz\"".to_owned(),
        conversion: ColumnConversion::RequestedFactor(-9.8),
    };
    assert!(found.notes.contains(&note), "{:?}", found.notes);
}

/// A factor includes the sign: a mark in the column's name does not reverse it again, even if the
/// user selects the column by that name. A minus that the user adds to the name does.
#[test]
fn a_factor_declared_by_the_user_includes_the_sign_of_the_column() {
    for (name, alias, factor) in [
        ("az (down)", None, -9.81),
        ("az (down)", Some("az (down)"), -9.81),
        ("-normal", Some("-normal"), -9.81),
        ("az", Some("-az"), 9.81),
    ] {
        let mut channels = acceleration_channels(alias);
        channels
            .declared
            .insert("NZ".to_owned(), DeclaredConversion::Factor(-9.81));
        let table = acceleration_table(name);
        let found = RecordLayout::proposed(&table, &channels, &TimeSettings::default());
        assert_eq!(
            found.layout.outputs[0].unwrap().factor,
            factor,
            "{name} {alias:?}"
        );
    }
}

#[test]
fn a_minus_before_an_alias_reverses_the_sign() {
    let mut channels = channels();
    channels.outputs[1].aliases = vec!["-nz".to_owned()];
    let found = RecordLayout::proposed(&record(), &channels, &TimeSettings::default());
    assert_eq!(
        found.layout.outputs[1],
        Some(ColumnUse::times(0, -9.806_65)),
        "{found:?}"
    );
    let note = LayoutNote::SignReversed {
        channel: "NZ".to_owned(),
        column: "\"nz\"".to_owned(),
        is_requested: true,
    };
    assert!(found.notes.contains(&note), "{:?}", found.notes);
}
