//! Proposed layouts, their problems and cautions.

use std::collections::BTreeMap;

use gdcm_model::dataset::channel::ChannelSide;
use gdcm_model::dataset::condition::ChannelRemedy;
use gdcm_model::names::ChannelRule;

use super::*;
use crate::records::laid_out_record::RecordGuess;
use crate::records::layout_proposal::LayoutProposal;
use crate::records::record_channels::SaidConversion;

fn rule(name: &str, unit: &str) -> ChannelRule {
    ChannelRule {
        unit: unit.to_owned(),
        ..ChannelRule::named(name)
    }
}

fn channels() -> RecordChannels {
    RecordChannels {
        inputs: vec![rule("LON", "%"), rule("LAT", "%")],
        outputs: vec![rule("P", "deg/s"), rule("NZ", "m/s²")],
        ..RecordChannels::default()
    }
}

fn column(name: &str, unit: &str, values: impl Fn(f64) -> f64) -> RecordColumn {
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

/// A record with the column names and order of another tool.
fn record() -> RecordTable {
    table(vec![
        column("nz", "g", |k| 0.1 * (0.3 * k).sin()),
        column("Time (s)", "s", |k| 0.02 * k),
        column("lateral", "%", |k| 50.0 + 5.0 * (0.2 * k).cos()),
        column("roll rate", "rad/s", |k| 0.2 * (0.2 * k).sin()),
        column("delta_b", "", |k| 40.0 + k),
        column("fuel", "kg", |_| 900.0),
    ])
}

fn proposed(table: &RecordTable) -> LayoutProposal {
    RecordLayout::proposed(table, &channels(), &TimeWish::default())
}

fn told(problems: &[LayoutProblem]) -> String {
    problems
        .iter()
        .map(ToString::to_string)
        .collect::<Vec<_>>()
        .join("; ")
}

#[test]
fn channels_are_found_by_the_names_of_the_field_and_converted_in_words() {
    let table = record();
    let channels = channels();
    let proposal = proposed(&table);
    assert_eq!(
        (proposal.problems.len(), proposal.cautions.len()),
        (0, 0),
        "{proposal:?}"
    );
    assert_eq!(
        proposal.notes,
        [
            "time from column \"Time (s)\", in s",
            "LON: column \"delta_b\", taken to be in %: the file does not say, and no other unit is possible",
            "LAT: column \"lateral\", in %",
            "P: column \"roll rate\", rad/s → deg/s (× 57.29577951308232)",
            "NZ: column \"nz\", g → m/s² (× 9.80665)",
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
        "a difference of two stamps"
    );
}

#[test]
fn missing_samples_stay_missing_and_infinite_ones_become_so() {
    let mut table = record();
    table.columns[3].values[7] = f64::INFINITY;
    table.columns[3].values[8] = f64::NAN;
    let proposal = proposed(&table);
    assert_eq!(
        proposal.cautions[0].to_string(),
        "P (column \"roll rate\"): 2 of 60 samples are missing"
    );
    let flight = proposal.layout.flight_record(&table, &channels()).unwrap();
    assert!(
        flight.outputs[(7, 0)].is_nan()
            && flight.outputs[(8, 0)].is_nan()
            && flight.outputs[(9, 0)].is_finite()
    );
}

#[test]
fn a_rate_of_thousands_of_degrees_is_refused_with_what_it_may_be() {
    let mut table = record();
    table.columns[3] = column("roll rate", "rad/s", |k| 20.0 * (0.2 * k).sin());
    let words = told(&proposed(&table).problems);
    assert!(
        words.contains(
            "P (column \"roll rate\") reaches 1146 deg/s, and no helicopter more than 400 deg/s"
        ),
        "{words}"
    );
    assert!(
        words.ends_with("the column or its unit is wrong; its samples look like deg/s"),
        "{words}"
    );
}

#[test]
fn a_unit_that_neither_the_file_nor_the_samples_say_is_asked_for_and_one_that_the_samples_say_is_taken()
 {
    let with = |unit: &str, peak: f64, of_channel: &str| {
        let mut channels = channels();
        channels.outputs[0].unit = of_channel.to_owned();
        let mut table = record();
        table.columns[3] = column("roll rate", unit, |k| peak * (k - 30.0) / 30.0);
        let proposal = RecordLayout::proposed(&table, &channels, &TimeWish::default());
        assert_eq!(
            proposal.layout.flight_record(&table, &channels).is_ok(),
            proposal.problems.is_empty()
        );
        let factor = proposal.layout.outputs[0].unwrap().factor;
        if proposal.problems.is_empty() {
            Ok((factor, proposal.notes[3].clone()))
        } else {
            Err(told(&proposal.problems))
        }
    };
    // 6.9 rad/s are 395 deg/s, within the range of helicopters; 7.1 rad/s are 407.
    assert_eq!(
        with("", 6.9, "deg/s").unwrap_err(),
        "the file does not say the unit of P (column \"roll rate\"), and its samples can be in deg/s or rad/s; say which: \
         --unit \"P=deg/s\", or page Columns"
    );
    let (factor, words) = with("", 7.1, "deg/s").unwrap();
    assert_eq!(
        (
            factor,
            words.ends_with(
                "taken to be in deg/s: the file does not say, and no other unit is possible"
            )
        ),
        (1.0, true)
    );
    // No helicopter turns at forty radians per second: the samples are degrees, fewer in the
    // channel's unit.
    assert_eq!(
        with("", 40.0, "rad/s").unwrap().0,
        std::f64::consts::PI / 180.0
    );
    assert_eq!(with("deg/s", 6.9, "deg/s").unwrap().0, 1.0);
    assert_eq!(
        with("", 0.0, "deg/s").unwrap().0,
        1.0,
        "nothing is nothing in any unit"
    );
    assert_eq!(
        with("", 6.9, "furlong").unwrap().0,
        1.0,
        "a unit that nobody knows is converted to no other"
    );
}

#[test]
fn a_unit_that_is_said_of_the_channel_is_that_of_files_that_say_none() {
    let mut table = record();
    table.columns[3].unit = None;
    let mut channels = channels();
    channels
        .said
        .insert("P".to_owned(), SaidConversion::Unit("rad/s".to_owned()));
    let said = RecordLayout::proposed(&table, &channels, &TimeWish::default());
    assert_eq!(
        (said.problems.len(), said.layout.outputs[0].unwrap().factor),
        (0, 180.0 / std::f64::consts::PI)
    );
    // Reading the record again with the dataset, in deg/s, gives the same samples.
    let entry = said
        .layout
        .condition_record(&table, &RecordGuess::default(), &channels);
    let again = RecordChannels {
        said: BTreeMap::new(),
        ..channels.clone()
    }
    .of_named_records();
    let again = LaidOutRecord::proposed(table.clone(), &again, &TimeWish::default())
        .0
        .as_said(&entry, &again);
    assert_eq!(
        again.flight.as_deref(),
        Some(&said.layout.flight_record(&table, &channels).unwrap())
    );
}

#[test]
fn a_time_that_falls_stands_still_or_goes_in_minutes_is_refused() {
    let with = |time: RecordColumn| {
        let mut table = record();
        table.columns[1] = time;
        told(&proposed(&table).problems)
    };
    let slip = with(column("t", "s", |k| if k == 30.0 { 0.1 } else { 0.02 * k }));
    assert!(
        slip.contains(
            "\"t\" does not increase at 1 of 60 samples, first at sample 31 (0.1 s follows 0.58 s)"
        ),
        "{slip}"
    );
    assert!(with(column("t", "min", |k| 0.1 * k)).contains("goes in steps of 6.000 s"));
    assert_eq!(
        with(column("t", "", |k| 20.0 * k)),
        "",
        "thousandths of a second, by their steps"
    );
    let none = with(column("count", "", |k| k));
    assert!(
        none.starts_with(
            "no column gives the time; say which does, or the sample rate (columns: nz, count"
        ),
        "{none}"
    );
    let rate = TimeWish {
        sample_time_s: Some(0.02),
        column: None,
    };
    let mut table = record();
    table.columns.remove(1);
    assert_eq!(
        RecordLayout::proposed(&table, &channels(), &rate).problems,
        []
    );
    let wrong = TimeWish {
        sample_time_s: None,
        column: Some("clock".into()),
    };
    let words = told(&RecordLayout::proposed(&table, &channels(), &wrong).problems);
    assert!(
        words.starts_with("there is no column \"clock\"; there are nz"),
        "{words}"
    );
}

#[test]
fn channels_that_are_missing_doubtful_or_without_a_factor_are_asked_for() {
    let mut table = record();
    table.columns[0].name = "vibration".into();
    table.columns[2].unit = Some("in".into());
    table.columns.push(column("pb", "deg/s", |k| k.sin()));
    let words = told(&proposed(&table).problems);
    assert!(
        words.contains("no column is the output NZ; say which is (columns: vibration"),
        "{words}"
    );
    assert!(
        words.contains("several columns can be the output P: \"roll rate\", \"pb\""),
        "{words}"
    );
    assert!(
        words.contains(
            "LAT has the unit \"in\" in the file (column \"lateral\") and \"%\" is wanted"
        ),
        "{words}"
    );
    // User settings are kept.
    let mut layout = proposed(&table).layout;
    layout.outputs = vec![
        Some(ColumnUse::as_it_is(6)),
        Some(ColumnUse::times(0, 9.80665)),
    ];
    layout.inputs[1] = Some(ColumnUse::times(2, -8.0));
    assert!(
        told(&layout.problems(&table, &channels()))
            .starts_with("LAT (column \"lateral\") reaches 440 %")
    );
    layout.inputs[1] = Some(ColumnUse::times(2, -2.0));
    assert_eq!(layout.problems(&table, &channels()), []);
    assert_eq!(
        layout.flight_record(&table, &channels()).unwrap().inputs[(0, 1)],
        -110.0
    );
    layout.inputs[1] = Some(ColumnUse::as_it_is(4));
    assert!(
        told(&layout.problems(&table, &channels()))
            .contains("LAT and LON are both taken from column \"delta_b\"")
    );
    layout.inputs[1] = Some(ColumnUse::times(99, f64::NAN));
    assert!(layout.flight_record(&table, &channels()).is_err());
}

#[test]
fn columns_without_names_are_never_taken_by_themselves() {
    let mut table = table(
        (0..5)
            .map(|of| column("", "", move |k| 0.02 * k * f64::from(of + 1)))
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
    let said = |name: &str, unit: &str, alias: &str| ChannelRule {
        unit_in_files: Some(unit.into()),
        aliases: vec![alias.into()],
        ..rule(name, unit)
    };
    let channels = RecordChannels {
        inputs: vec![said("LON", "%", "#3"), said("LAT", "%", "#2")],
        outputs: vec![said("P", "deg/s", "#5"), said("NZ", "m/s²", "-#4")],
        ..RecordChannels::default()
    };
    let proposal = RecordLayout::proposed(&table, &channels, &TimeWish::default());
    assert_eq!(proposal.problems, []);
    let uses = |uses: &[Option<ColumnUse>]| {
        uses.iter()
            .flatten()
            .map(|of| (of.column, of.factor))
            .collect::<Vec<_>>()
    };
    assert_eq!(uses(&proposal.layout.inputs), [(2, 1.0), (1, 1.0)]);
    assert_eq!(uses(&proposal.layout.outputs), [(4, 1.0), (3, -1.0)]);
}

#[test]
fn a_mark_in_the_name_of_a_column_is_the_sign_and_a_sign_that_is_not_said_is_asked_for() {
    let of = |name: &str, alias: Option<&str>| {
        let table = table(vec![
            column("t", "s", |k| 0.02 * k),
            column(name, "", |k| k.sin()),
        ]);
        let aliases = alias.into_iter().map(str::to_owned).collect();
        let outputs = vec![ChannelRule {
            aliases,
            ..rule("NZ", "m/s²")
        }];
        let channels = RecordChannels {
            outputs,
            ..RecordChannels::default()
        };
        let proposal = RecordLayout::proposed(&table, &channels, &TimeWish::default());
        let factor = proposal.layout.outputs[0].map(|used| used.factor);
        factor.ok_or_else(|| told(&proposal.problems))
    };
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
        assert_eq!(of(name, alias), Ok(factor), "{name} {alias:?}");
    }
    let asked = of("az", None).unwrap_err();
    assert!(
        asked.contains("NZ=az takes the column as it is, NZ=-az turns it"),
        "{asked}"
    );
}

#[test]
fn a_column_of_a_matrix_is_found_by_its_index_in_python_s_and_in_matlab_s_way() {
    let table = table(
        (1..4)
            .map(|of| column(&format!("xyz_{of}"), "", |k| k))
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

#[test]
fn coordinates_of_the_place_are_not_sticks_even_under_their_very_names() {
    let with = |moves: f64| {
        let mut table = table(vec![
            column("t", "s", |k| 0.02 * k),
            column("LAT", "", move |k| 45.0 + moves * k),
            column("LON", "", move |k| 9.0 + moves * k),
            column("P", "deg/s", |k| k.sin()),
            column("NZ", "m/s²", |k| k.cos()),
        ]);
        table.columns[4].unit = None;
        proposed(&table).layout.inputs.iter().flatten().count()
    };
    assert_eq!(with(1e-5), 0, "a track");
    assert_eq!(with(0.1), 2, "sticks");
}

#[test]
fn inputs_and_outputs_that_the_file_tells_apart_are_taken_in_order() {
    let side = |name: &str, side, scale: f64| RecordColumn {
        side: Some(side),
        ..column(name, "", move |k| scale * k.sin())
    };
    let mut table = table(vec![
        column("t", "", |k| 0.01 * k),
        side("inr_1", ChannelSide::Input, 10.0),
        side("inr_2", ChannelSide::Input, 20.0),
        side("outr_1", ChannelSide::Output, 30.0),
        side("outr_2", ChannelSide::Output, 40.0),
    ]);
    table.columns[4].unit = Some("m/s^2".to_owned());
    let proposal = proposed(&table);
    assert_eq!(proposal.problems, []);
    assert_eq!(proposal.layout.outputs[1], Some(ColumnUse::as_it_is(4)));
    assert!(
        proposal.notes.iter().any(
            |note| note == "the file has as many outputs under other names (2): taken in order"
        )
    );
}

#[test]
fn channels_without_a_unit_take_the_first_file_s_and_later_files_are_converted() {
    let mut channels = RecordChannels {
        outputs: vec![ChannelRule::named("P")],
        ..RecordChannels::default()
    };
    let first = record();
    let mut second = record();
    let layout = RecordLayout::proposed(&first, &channels, &TimeWish::default()).layout;
    channels.take_units(&layout, &first);
    assert_eq!(channels.outputs[0].unit, "rad/s");
    second.columns[3].unit = Some("deg/s".into());
    let proposal = RecordLayout::proposed(&second, &channels, &TimeWish::default());
    assert_eq!(
        proposal.layout.outputs[0].unwrap().factor,
        std::f64::consts::PI / 180.0
    );
}

#[test]
fn a_column_that_the_engineer_names_is_taken_however_its_marks_are_typed() {
    let table = table(vec![
        column("t", "s", |k| 0.1 * k),
        column("elev,yoke1", "", |k| k.sin()),
        column("lon", "deg", |k| 2.0 + 0.001 * k),
    ]);
    let with = |aliases: &[&str]| {
        let aliases = aliases.iter().map(|alias| (*alias).to_owned()).collect();
        let channels = RecordChannels {
            inputs: vec![ChannelRule {
                aliases,
                ..ChannelRule::named("LON")
            }],
            ..RecordChannels::default()
        };
        RecordLayout::proposed(&table, &channels, &TimeWish::default())
    };
    assert_eq!(
        with(&[]).layout.inputs,
        [Some(ColumnUse::as_it_is(1))],
        "the longitude is no stick"
    );
    assert_eq!(
        with(&["elev_yoke1"]).layout.inputs,
        [Some(ColumnUse::as_it_is(1))]
    );
}

#[test]
fn a_layout_goes_over_to_a_record_with_the_same_columns_in_another_order() {
    let first = record();
    let mut second = record();
    second.columns.rotate_left(2);
    let layout = proposed(&first).layout;
    let carried = layout.carried_to(&second, &first).unwrap();
    let flight = carried.flight_record(&second, &channels()).unwrap();
    assert_eq!(flight, layout.flight_record(&first, &channels()).unwrap());
    second.columns.retain(|column| column.name != "nz");
    assert_eq!(layout.carried_to(&second, &first), None);
}

#[test]
fn a_channel_that_stands_still_and_two_that_are_one_are_told() {
    let mut table = record();
    table.columns[4] = column("LON", "%", |_| 50.0);
    let words: Vec<String> = proposed(&table)
        .cautions
        .iter()
        .map(ToString::to_string)
        .collect();
    assert_eq!(
        words,
        ["LON (column \"LON\") does not change in this record"]
    );
    table.columns[4] = RecordColumn {
        name: "LON".into(),
        ..table.columns[2].clone()
    };
    let words: Vec<String> = proposed(&table)
        .cautions
        .iter()
        .map(ToString::to_string)
        .collect();
    assert_eq!(words, ["LON and LAT have the same samples"]);
}

#[test]
fn a_latitude_and_a_longitude_are_no_sticks() {
    let with = |lat: RecordColumn, lon: RecordColumn| {
        let roll = column("P", "deg/s", |k| 10.0 * (0.2 * k).sin());
        let nz = column("NZ", "g", |k| 1.0 + 0.1 * (0.3 * k).sin());
        proposed(&table(vec![
            column("t", "s", |k| 0.02 * k),
            lat,
            lon,
            roll,
            nz,
        ]))
    };
    for unit in ["", "deg"] {
        let found = with(
            column("lat", unit, |k| 47.6 + 1e-5 * k),
            column("lon", unit, |k| 8.5 - 2e-5 * k),
        );
        assert!(
            told(&found.problems).contains("no column is the input LON"),
            "{unit}: {found:?}"
        );
        assert_eq!(found.layout.inputs, [None, None], "{unit}");
    }
    // A constant stick beside a moving one is still a stick.
    let sticks = with(
        column("lat", "", |_| 50.0),
        column("lon", "", |k| 50.0 + 8.0 * (0.1 * k).sin()),
    );
    assert_eq!(
        sticks.layout.inputs,
        [Some(ColumnUse::as_it_is(2)), Some(ColumnUse::as_it_is(1))],
        "{sticks:?}"
    );
}

#[test]
fn columns_without_names_are_said_by_their_numbers() {
    let mut table = record();
    table.named = false;
    for (index, column) in table.columns.iter_mut().enumerate() {
        column.name = format!("column {}", index + 1);
    }
    let channel = |name: &str, alias: &str| ChannelRule {
        aliases: vec![alias.to_owned()],
        ..ChannelRule::named(name)
    };
    let with = |last: &str| {
        let channels = RecordChannels {
            inputs: vec![channel("LON", "#5")],
            outputs: vec![channel("P", "#4"), channel("NZ", last)],
            ..RecordChannels::default()
        };
        let time = TimeWish {
            column: Some("#2".to_owned()),
            sample_time_s: None,
        };
        RecordLayout::proposed(&table, &channels, &time)
    };
    let found = with("#1");
    assert_eq!(found.problems, [], "{found:?}");
    assert_eq!(found.layout.inputs, [Some(ColumnUse::as_it_is(4))]);
    assert_eq!(
        found.layout.outputs,
        [Some(ColumnUse::as_it_is(3)), Some(ColumnUse::as_it_is(0))]
    );
    assert!(told(&with("#7").problems).contains("no column is the output NZ"));
}

#[test]
fn a_unit_or_a_factor_that_is_said_stands_before_that_of_the_file() {
    let mut channels = channels();
    channels
        .said
        .insert("NZ".to_owned(), SaidConversion::Factor(-9.8));
    channels
        .said
        .insert("P".to_owned(), SaidConversion::Unit("deg/s".to_owned()));
    let found = RecordLayout::proposed(&record(), &channels, &TimeWish::default());
    assert_eq!(
        found
            .layout
            .outputs
            .iter()
            .map(|used| used.unwrap().factor)
            .collect::<Vec<_>>(),
        [1.0, -9.8]
    );
    assert!(
        found
            .notes
            .contains(&"NZ: column \"nz\", × -9.8 as asked".to_owned()),
        "{:?}",
        found.notes
    );
}

#[test]
fn the_same_record_under_two_names_counts_once() {
    let laid_out = |name: &str, first: f64| {
        let mut table = RecordTable {
            name: name.to_owned(),
            ..record()
        };
        table.columns[2].values[0] = first;
        LaidOutRecord::proposed(table, &channels(), &TimeWish::default()).0
    };
    let mut records = [
        laid_out("a", 55.0),
        laid_out("b", 55.0),
        laid_out("c", 54.0),
    ];
    leave_out_copies(&mut records);
    leave_out_copies(&mut records);
    assert_eq!(
        records.each_ref().map(|record| record.used),
        [true, false, true]
    );
    let words: Vec<String> = records[1]
        .cautions
        .iter()
        .map(ToString::to_string)
        .collect();
    assert_eq!(
        words,
        ["its samples are those of a: left out, for evidence counts once"]
    );
}

#[test]
fn a_mark_before_the_name_of_a_column_turns_its_sign() {
    let mut channels = channels();
    channels.outputs[1].aliases = vec!["-nz".to_owned()];
    let found = RecordLayout::proposed(&record(), &channels, &TimeWish::default());
    assert_eq!(
        found.layout.outputs[1],
        Some(ColumnUse::times(0, -9.806_65)),
        "{found:?}"
    );
    assert!(
        found
            .notes
            .contains(&"NZ: the sign of column \"nz\" is turned, as asked".to_owned()),
        "{:?}",
        found.notes
    );
}

#[test]
fn what_is_put_right_in_one_record_is_put_right_in_it_alone() {
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
    layout.put_right(&remedies, &channels);
    let [before, after] =
        [&as_logged, &layout].map(|layout| layout.flight_record(&table, &channels).unwrap());
    // LON is 40 + k at 0.02 k: 30 ms later it is 1.5 more, and there is no value beyond the end.
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
    // The remedy is stored with the record, is not passed to other records, and survives a change
    // of columns.
    let entry = layout.condition_record(&table, &RecordGuess::default(), &channels);
    assert_eq!(entry.remedies, remedies);
    let other = as_logged
        .carried_to(&table, &table)
        .unwrap()
        .with_remedies_of(&layout);
    assert_eq!(other, layout);
    // Applying it twice accumulates.
    layout.put_right(&remedies, &channels);
    let twice = layout.flight_record(&table, &channels).unwrap();
    assert!((twice.inputs[(10, 0)] - 53.0).abs() < 1e-12 && twice.outputs == before.outputs);
}

#[test]
fn a_line_is_drawn_over_no_gap_and_a_delay_is_short() {
    let mut table = record();
    for sample in 30..60 {
        table.columns[1].values[sample] += 1.0;
    }
    let channels = channels();
    let mut layout = proposed(&table).layout;
    let late = |delay_s: f64| {
        BTreeMap::from([(
            "LON".to_owned(),
            ChannelRemedy {
                delay_s,
                factor: 1.0,
            },
        )])
    };
    layout.put_right(&late(0.03), &channels);
    let flight = layout.flight_record(&table, &channels).unwrap();
    assert!(
        flight.inputs[(28, 0)].is_nan()
            && flight.inputs[(27, 0)].is_finite()
            && flight.inputs[(30, 0)].is_finite()
    );
    layout.put_right(&late(1e300), &channels);
    assert_eq!(
        layout.problems(&table, &channels).len(),
        1,
        "{:?}",
        layout.problems(&table, &channels)
    );
}
