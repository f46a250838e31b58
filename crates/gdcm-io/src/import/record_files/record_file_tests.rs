//! Tests of records read from whole files: tables, variables, archives and logs.

use gdcm_model::dataset::channel::ChannelSide;
use gdcm_model::names::channel_rule::ChannelRule;
use gdcm_sysid::records::layout_note::LayoutNote;
use gdcm_sysid::records::{
    ColumnUse, LaidOutRecord, RecordChannels, RecordLayout, TimeSettings, with_topics_joined,
};

use super::*;
use crate::formats::reading_note::{NamedColumn, ReadingNote};
use crate::formats::variables::{Array, CellArray, Object, StructArray, TextArray, Value};
use crate::import::recognise::recognition_fault::FoundFault;
use crate::reading_budget::MOST_MEMORY;

const FOLDER: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../tests/data/records/");

fn read(name: &str) -> FoundRecords {
    records_of_bytes(
        &std::fs::read(format!("{FOLDER}{name}")).unwrap(),
        name,
        &ReadingBudget::new(1 << 24),
    )
    .unwrap()
}

fn channels() -> RecordChannels {
    let rule = |name: &str, unit: &str, in_files: &str| ChannelRule {
        unit: unit.to_owned(),
        unit_in_files: Some(in_files.to_owned()),
        ..ChannelRule::named(name)
    };
    RecordChannels {
        inputs: vec![rule("LON", "%", "%"), rule("LAT", "%", "%")],
        outputs: vec![rule("P", "rad/s", "rad/s"), rule("NZ", "g", "g")],
        ..RecordChannels::default()
    }
}

/// Returns the flight record for the proposed assignment of columns to channels. Unnamed columns
/// are assigned explicitly; "az" is positive up.
fn flight(table: &RecordTable) -> gdcm_model::simulation::FlightRecord {
    let mut channels = channels();
    let rules = channels.inputs.iter_mut().chain(&mut channels.outputs);
    for (index, rule) in rules.enumerate().filter(|_| !table.named) {
        rule.aliases.push(format!("#{}", index + 2));
    }
    if table.find("az").is_some() {
        channels.outputs[1].aliases.push("az".to_owned());
    }
    let proposal = RecordLayout::proposed(table, &channels, &TimeSettings::default());
    assert_eq!(proposal.problems, [], "{}", table.name);
    proposal.layout.flight_record(table, &channels).unwrap()
}

/// Asserts that a record has the data written by `make_files.py`, within `digits` decimals.
fn assert_record(table: &RecordTable, digits: i32) {
    let record = flight(table);
    let samples = record.time_s.len();
    let near = |value: f64, expected: f64| {
        // Half a unit of the last decimal, and the rounding error of a division.
        assert!(
            (value - expected).abs() < 0.5 * 10_f64.powi(-digits) + 1e-12,
            "{}: {value} {expected}",
            table.name
        );
    };
    for k in 0..samples {
        let at = k as f64;
        near(record.time_s[k], 0.02 * at);
        near(record.inputs[(k, 0)], 50.0 + 10.0 * (0.3 * at).sin());
        near(record.inputs[(k, 1)], 45.0 + 8.0 * (0.2 * at).cos());
        if !(record.outputs[(k, 0)].is_nan() && k == 7) {
            near(record.outputs[(k, 0)], 0.3 * (0.25 * at).sin());
        }
        near(record.outputs[(k, 1)], 1.0 + 0.2 * (0.35 * at).cos());
    }
}

#[test]
fn one_record_in_every_format_is_the_same_record() {
    for name in [
        "units.csv",
        "comma.csv",
        "plain.txt",
        "strokes.txt",
        "sides.mat",
        "struct.mat",
        "old.mat",
        "matlab73.mat",
        "matrix.npy",
        "arrays.npz",
        "columns.json",
    ] {
        let found = read(name);
        assert_eq!(
            (found.tables.len(), &found.faults),
            (1, &Vec::new()),
            "{name}: {:?}",
            found.ignored
        );
        assert_eq!(found.tables[0].rows(), 60, "{name}");
        assert_eq!(
            (
                found.tables[0].source.file.as_str(),
                found.tables[0].source.sha256.len()
            ),
            (name, 64)
        );
        assert_record(&found.tables[0], 3);
    }
}

#[test]
fn names_units_and_sides_are_those_of_the_file() {
    let of = |name: &str| {
        let found = read(name);
        let columns = found.tables[0].columns.iter();
        columns
            .map(|column| {
                (
                    column.name.clone(),
                    column.unit.clone().unwrap_or_default(),
                    column.side,
                )
            })
            .collect::<Vec<_>>()
    };
    let input = Some(ChannelSide::Input);
    let output = Some(ChannelSide::Output);
    let column = |name: &str, unit: &str, side| (name.to_owned(), unit.to_owned(), side);
    assert_eq!(
        of("units.csv")[..2],
        [column("time", "s", None), column("LON", "%", None)]
    );
    assert_eq!(of("comma.csv")[3], column("roll rate", "rad/s", None));
    assert_eq!(of("strokes.txt")[1], column("elev,yoke1", "", None));
    assert_eq!(
        of("sides.mat")[..2],
        [column("t", "", None), column("inr_1", "", input)]
    );
    let labelled = [
        column("LON", "", input),
        column("LAT", "", input),
        column("P", "rad/s", output),
        column("NZ", "g", output),
    ];
    assert_eq!(of("struct.mat"), labelled);
    assert_eq!(read("struct.mat").tables[0].sample_time_s, Some(0.02));
    assert_eq!(read("struct.mat").tables[0].name, "struct, rec");
    assert!(!read("matrix.npy").tables[0].named);
}

#[test]
fn several_records_in_a_file_are_distinguished() {
    let runs = read("runs.csv");
    let names: Vec<&str> = runs
        .tables
        .iter()
        .map(|table| table.name.as_str())
        .collect();
    assert_eq!(names, ["runs, run 4", "runs, run 5"]);
    let restart = read("restart.csv");
    assert_eq!(restart.tables.len(), 2);
    let experiments = read("experiments.mat");
    let names: Vec<&str> = experiments
        .tables
        .iter()
        .map(|table| table.name.as_str())
        .collect();
    assert_eq!(names, ["experiments, data, up", "experiments, data, down"]);
    assert_eq!(experiments.tables[1].rows(), 40);
    let all = runs
        .tables
        .iter()
        .chain(&restart.tables)
        .chain(&experiments.tables);
    all.for_each(|table| assert_record(table, 3));
}

#[test]
fn files_in_an_archive_are_records_of_it() {
    let found = read("two.zip");
    let sources: Vec<(&str, Option<&str>)> = found
        .tables
        .iter()
        .map(|table| (table.source.file.as_str(), table.source.variable.as_deref()))
        .collect();
    assert_eq!(
        sources,
        [
            ("two.zip", Some("records/units.csv")),
            ("two.zip", Some("records/sides.mat"))
        ]
    );
    assert!(
        matches!(&found.ignored[..], [file] if file.starts_with("readme.md: ")),
        "{:?}",
        found.ignored
    );
    found
        .tables
        .iter()
        .for_each(|table| assert_record(table, 3));
}

#[test]
fn records_are_found_again_by_their_names_in_the_dataset() {
    let load = |name: &str, variables: &[Option<&str>]| {
        load_records(
            Path::new(&format!("{FOLDER}{name}")),
            variables,
            &ReadingBudget::default(),
        )
        .unwrap()
    };
    let of_runs = load("runs.csv", &[Some("run 5"), Some("run 6")]);
    assert_eq!(of_runs[0].as_ref().unwrap(), &read("runs.csv").tables[1]);
    assert_eq!(
        load("units.csv", &[None])[0].as_ref().unwrap(),
        &read("units.csv").tables[0]
    );
    let error = of_runs[1].as_ref().unwrap_err();
    assert!(
        matches!(
            error,
            FileError::NoRecord { record: Some(record), record_count: 2, .. } if record == "run 6"
        ),
        "{error:?}"
    );
}

#[test]
fn words_and_clock_times_among_the_numbers_of_a_log_are_read() {
    let row = |k: usize, run: &str| {
        let at = k as f64;
        let cs = 2 * k;
        let stick = (
            50.0 + 10.0 * (0.3 * at).sin(),
            45.0 + 8.0 * (0.2 * at).cos(),
        );
        let aircraft = (0.3 * (0.25 * at).sin(), 1.0 + 0.2 * (0.35 * at).cos());
        let clock = format!("2026-03-01 12:30:{:02}.{:02}", cs / 100, cs % 100);
        format!(
            "{clock},{run},{:.4},{:.4},{:.4},{:.4}\n",
            stick.0, stick.1, aircraft.0, aircraft.1
        )
    };
    let head = "time,manoeuvre,LON,LAT,P,NZ\n".to_owned();
    let log = (0..60)
        .map(|k| row(k, "LON sweep"))
        .chain((0..60).map(|k| row(k, "LAT sweep")))
        .fold(head, |log, row| log + &row);
    let found = records_of_bytes(log.as_bytes(), "log.csv", &ReadingBudget::new(1 << 24)).unwrap();
    let names: Vec<&str> = found
        .tables
        .iter()
        .map(|table| table.name.as_str())
        .collect();
    assert_eq!(names, ["log, manoeuvre 1", "log, manoeuvre 2"]);
    let numbered = ReadingNote::NumberedWords {
        column: NamedColumn::Name("manoeuvre".to_owned()),
        words: vec!["LON sweep".to_owned(), "LAT sweep".to_owned()],
    }
    .to_string();
    assert!(found.tables[1].notes.contains(&numbered), "{found:?}");
    found
        .tables
        .iter()
        .for_each(|table| assert_record(table, 3));
}

#[test]
fn a_log_that_is_begun_anew_with_other_columns_is_two_tables() {
    let log = |columns: &str, rows: usize| {
        let cells = columns.split('|').count();
        let row = |k: usize| {
            (0..cells)
                .map(|cell| format!(" {} |", (k * (cell + 1)) as f64 * 0.02))
                .collect::<String>()
                + "\n"
        };
        format!("{columns} |\n") + &(0..rows).map(row).collect::<String>()
    };
    let text = log("time,s | P,rad/s", 3) + "\n" + &log("time,s | P,rad/s | Q,rad/s", 50);
    let found = records_of_bytes(text.as_bytes(), "log.txt", &ReadingBudget::new(1 << 24)).unwrap();
    assert_eq!(
        (
            found.tables.len(),
            found.tables[0].rows(),
            found.tables[0].columns.len()
        ),
        (1, 50, 3)
    );
    let one_of_tables = ReadingNote::OneOfTables { count: 2, line: 6 };
    assert_eq!(found.tables[0].notes[0], one_of_tables.to_string());
    assert_eq!(found.tables[0].source.variable.as_deref(), Some("table 2"));
}

fn numbers(rows: usize, columns: usize, value: impl Fn(usize) -> f64) -> Value {
    Value::Array(Array::matrix(
        rows,
        columns,
        (0..rows * columns).map(value).collect(),
    ))
}

fn texts(texts: &[&str]) -> Value {
    let text = |text: &&str| {
        Value::Text(TextArray {
            shape: vec![1, 1],
            texts: vec![(*text).to_owned()],
        })
    };
    Value::Cell(CellArray {
        shape: vec![1, texts.len()],
        values: texts.iter().map(text).collect(),
    })
}

fn record(fields: Vec<(&str, Value)>) -> StructArray {
    let fields = fields
        .into_iter()
        .map(|(name, value)| (name.to_owned(), vec![value]))
        .collect();
    StructArray {
        shape: vec![1, 1],
        fields,
    }
}

fn object(class: &str, fields: Vec<(&str, Value)>) -> Value {
    Value::Object(Object {
        class: class.to_owned(),
        records: record(fields),
    })
}

fn searched(name: &str, value: Value) -> Found<Columns> {
    search_records(
        &[Variable {
            name: name.to_owned(),
            value,
        }],
        &ReadingBudget::new(1 << 20),
    )
    .unwrap()
}

/// Returns a timetable with two variables and these row times, as MATLAB saves it.
fn timetable(row_times: Value) -> Value {
    let data = CellArray {
        shape: vec![1, 2],
        values: vec![
            numbers(60, 1, |k| k as f64),
            numbers(60, 2, |k| -(k as f64)),
        ],
    };
    let any = record(vec![
        ("data", Value::Cell(data)),
        ("varNames", texts(&["LON", "rates"])),
        ("varUnits", texts(&["%", "deg/s"])),
        ("numRows", numbers(1, 1, |_| 60.0)),
        ("rowTimes", row_times),
    ]);
    object("timetable", vec![("any", Value::Struct(any))])
}

#[test]
fn timetables_have_their_row_times() {
    let duration = |rows: usize, ms: fn(usize) -> f64| {
        object("duration", vec![("millis", numbers(rows, 1, ms))])
    };
    let columns = |row_times: Value| {
        searched("tt", timetable(row_times))
            .items
            .into_iter()
            .next()
            .unwrap()
    };
    let of = columns(duration(60, |k| 20.0 * k as f64));
    let names: Vec<&str> = of
        .columns
        .iter()
        .map(|column| column.name.as_str())
        .collect();
    assert_eq!(names, ["Time", "LON", "rates_1", "rates_2"]);
    assert_eq!(
        (
            of.columns[0].values[3],
            of.columns[3].values[0],
            of.columns[2].unit.as_deref()
        ),
        (0.06, -60.0, Some("deg/s"))
    );
    let clock = object(
        "datetime",
        vec![("data", numbers(60, 1, |k| 1.7e12 + 20.0 * k as f64))],
    );
    assert_eq!(columns(clock).columns[0].values[3], 0.06);
    let regular = |by_rate: f64| {
        Value::Struct(record(vec![
            ("origin", duration(1, |_| 0.0)),
            ("specifiedAsRate", numbers(1, 1, move |_| by_rate)),
            ("stepSize", duration(1, |_| 10.0)),
            ("sampleRate", numbers(1, 1, |_| 50.0)),
        ]))
    };
    assert_eq!(
        (
            columns(regular(1.0)).sample_time_s,
            columns(regular(0.0)).sample_time_s
        ),
        (Some(0.02), Some(0.01))
    );
}

#[test]
fn identification_data_of_matlab_and_of_octave_are_read() {
    let matlab = object(
        "iddata",
        vec![
            ("OutputData_", numbers(60, 2, |k| k as f64)),
            ("InputData_", numbers(60, 1, |k| k as f64)),
            ("Ts_", numbers(1, 1, |_| 0.01)),
            ("OutputName_", texts(&["P", "Q"])),
            ("OutputUnit_", texts(&["rad/s", ""])),
        ],
    );
    let of = searched("z", matlab).items.into_iter().next().unwrap();
    let columns: Vec<(&str, Option<&str>)> = of
        .columns
        .iter()
        .map(|column| (column.name.as_str(), column.unit.as_deref()))
        .collect();
    assert_eq!(columns, [("u1", None), ("P", Some("rad/s")), ("Q", None)]);
    assert_eq!(
        (of.sample_time_s, of.columns[1].side),
        (Some(0.01), Some(ChannelSide::Output))
    );
    let octave = object(
        "iddata",
        vec![
            ("y", numbers(60, 1, |k| k as f64)),
            ("u", numbers(60, 1, |k| k as f64)),
            ("tsam", numbers(1, 1, |_| 0.05)),
        ],
    );
    assert_eq!(searched("z", octave).items[0].sample_time_s, Some(0.05));
    let without_outputs = object(
        "iddata",
        vec![("y", texts(&["lost"])), ("u", numbers(60, 1, |k| k as f64))],
    );
    assert_eq!(
        searched("z", without_outputs).faults,
        [FoundFault::new("z", RecognitionFault::NoOutputData)]
    );
    let over_frequency = object(
        "iddata",
        vec![
            ("y", numbers(60, 1, |_| 1.0)),
            ("Domain", texts(&["Frequency"])),
        ],
    );
    assert_eq!(
        searched("z", over_frequency).faults,
        [FoundFault::new("z", RecognitionFault::FrequencyDomain)]
    );
}

#[test]
fn a_simulink_structure_with_time_is_a_record() {
    let signal = |label: &str, columns: usize| {
        let label = Value::Text(TextArray {
            shape: vec![1, 1],
            texts: vec![label.to_owned()],
        });
        vec![numbers(60, columns, |k| k as f64), label]
    };
    let first = signal("LON [%]", 1);
    let second = signal("rates", 2);
    let fields = ["values", "label"].into_iter().enumerate();
    let fields = fields
        .map(|(at, name)| (name.to_owned(), vec![first[at].clone(), second[at].clone()]))
        .collect();
    let signals = Value::Struct(StructArray {
        shape: vec![1, 2],
        fields,
    });
    let logged = Value::Struct(record(vec![
        ("time", numbers(60, 1, |k| 0.02 * k as f64)),
        ("signals", signals),
    ]));
    let of = searched("out", logged).items.into_iter().next().unwrap();
    let names: Vec<&str> = of
        .columns
        .iter()
        .map(|column| column.name.as_str())
        .collect();
    assert_eq!(
        (names, of.columns[1].unit.as_deref()),
        (vec!["time", "LON", "rates_1", "rates_2"], Some("%"))
    );
}

#[test]
fn a_model_and_a_few_numbers_are_no_record() {
    let scalar = |value: f64| numbers(1, 1, move |_| value);
    let model = vec![
        ("A", numbers(60, 60, |_| 0.0)),
        ("B", numbers(60, 4, |_| 0.0)),
        ("C", numbers(6, 60, |_| 0.0)),
        ("D", scalar(0.0)),
    ];
    assert!(
        searched("sys", Value::Struct(record(model)))
            .items
            .is_empty()
    );
    let short = vec![
        ("t", numbers(10, 1, |k| k as f64)),
        ("P", numbers(10, 1, |k| k as f64)),
    ];
    let found = searched("x", Value::Struct(record(short)));
    assert_eq!(
        (found.items.len(), found.ignored),
        (0, vec!["x: a 1 x 1 struct array".to_owned()])
    );
}

#[test]
fn damaged_files_are_faults_and_never_a_panic() {
    for name in [
        "units.csv",
        "sides.mat",
        "experiments.mat",
        "matlab73.mat",
        "arrays.npz",
        "two.zip",
        "columns.json",
    ] {
        let whole = std::fs::read(format!("{FOLDER}{name}")).unwrap();
        let step = 1 + whole.len() / 150;
        for at in (0..whole.len()).step_by(step) {
            let mut bytes = whole.clone();
            bytes[at] ^= 0x15;
            let _ = records_of_bytes(&bytes, name, &ReadingBudget::new(1 << 22));
            let _ = records_of_bytes(&whole[..at], name, &ReadingBudget::new(1 << 22));
        }
    }
}

// Tests of aircraft logs, and of topics in separate files.

fn sides(inputs: &[&str], outputs: &[&str]) -> RecordChannels {
    let rules = |names: &[&str]| names.iter().map(|name| ChannelRule::named(*name)).collect();
    RecordChannels {
        inputs: rules(inputs),
        outputs: rules(outputs),
        ..RecordChannels::default()
    }
}

#[test]
fn a_log_of_px4_is_opened_with_channels_proposed_in_the_units_of_its_documentation() {
    let bytes = include_bytes!("../../../../../tests/data/logs/quadrotor.ulg");
    let found = records_of_bytes(bytes, "quadrotor.ulg", &ReadingBudget::new(MOST_MEMORY)).unwrap();
    assert_eq!(found.tables.len(), 1);
    let channels = sides(&["LAT", "LON", "PED"], &["P", "Q", "R", "NX"]);
    let table = found.tables.into_iter().next().unwrap();
    let notes = RecordLayout::proposed(&table, &channels, &TimeSettings::default()).notes;
    let (record, _) = LaidOutRecord::proposed(table, &channels, &TimeSettings::default());
    assert!(record.problems.is_empty(), "{:?}", record.problems);
    let unit = |used: &Option<ColumnUse>| {
        record.table.columns[used.unwrap().column]
            .unit
            .clone()
            .unwrap()
    };
    assert_eq!(
        record.layout.outputs.iter().map(unit).collect::<Vec<_>>(),
        ["rad/s", "rad/s", "rad/s", "m/s^2"]
    );
    // The acceleration is logged at 20 Hz, the other signals at 50 Hz.
    let Some(LayoutNote::Resampled { logged, .. }) = notes.last() else {
        panic!("{notes:?}")
    };
    for (channel, rate_hz) in [("LAT", 50.0), ("NX", 20.0)] {
        let found = logged.iter().find(|rate| rate.channel == channel);
        assert!((found.unwrap().rate_hz - rate_hz).abs() < 0.05, "{notes:?}");
    }
    let flight = record.flight.unwrap();
    assert!(
        flight.time_s.len() > 250 && flight.time_s[0] > 120.0,
        "16 s, two minutes after the start"
    );
    assert!(
        record.table.modes.iter().any(|mode| mode.name == "armed"),
        "{:?}",
        record.table.modes
    );
}

#[test]
fn each_flight_in_a_blackbox_is_a_record() {
    let bytes = include_bytes!("../../../../../tests/data/logs/two-flights.bbl");
    let found =
        records_of_bytes(bytes, "two-flights.bbl", &ReadingBudget::new(MOST_MEMORY)).unwrap();
    let names: Vec<&str> = found
        .tables
        .iter()
        .map(|table| table.name.as_str())
        .collect();
    assert_eq!(
        names,
        ["two-flights, flight 2"],
        "{:?}",
        found.tables[0].notes
    );
    let channels = sides(&["LAT", "LON", "PED", "COL"], &["P", "Q", "R"]);
    let (record, _) = LaidOutRecord::proposed(
        found.tables.into_iter().next().unwrap(),
        &channels,
        &TimeSettings::default(),
    );
    assert!(record.problems.is_empty(), "{:?}", record.problems);
    let flight = record.flight.unwrap();
    let steps: Vec<f64> = flight
        .time_s
        .windows(2)
        .map(|pair| pair[1] - pair[0])
        .collect();
    // The log holds every sixteenth controller cycle; a cycle takes two gyro samples of 125 µs.
    assert!(
        steps
            .iter()
            .filter(|step| (**step - 0.004).abs() < 1e-5)
            .count()
            * 10
            > 9 * steps.len()
    );
    let motor = &record.table.columns[record.table.find("motor[0]").unwrap()];
    let (least, most) = motor.range().unwrap();
    assert!(
        (158.0..2048.0).contains(&least) && most < 2048.0,
        "as the heading says: {least} to {most}"
    );
}

#[test]
fn topic_tables_in_an_archive_are_a_single_record() {
    let folder = tempfile::tempdir().unwrap();
    let rows = |rate: u32, name: &str| {
        let row = |k: u32| format!("{},{}\n", f64::from(k) / f64::from(rate), f64::from(k % 17));
        format!(
            "time,{name}\n{}",
            (0..20 * rate).map(row).collect::<String>()
        )
    };
    std::fs::write(folder.path().join("notes.log"), "it went well").unwrap();
    std::fs::write(folder.path().join("M.csv"), rows(100, "value")).unwrap();
    std::fs::write(folder.path().join("imu.csv"), rows(50, "q")).unwrap();
    let found = read_records(&[folder.path().to_owned()], &Stopped(&Arc::default())).unwrap();
    let tables = with_topics_joined(
        found.tables,
        &sides(&["M"], &["q"]),
        &TimeSettings::default(),
    );
    assert_eq!(
        (tables.len(), found.faults),
        (1, Vec::new()),
        "other programs' logs are passed over"
    );
    let (record, _) = LaidOutRecord::proposed(
        tables[0].clone(),
        &sides(&["M"], &["q"]),
        &TimeSettings::default(),
    );
    let first = record.flight.unwrap();
    assert!(record.problems.is_empty() && first.time_s.len() > 900);
    // A dataset refers to the records by their folder and the name of the joined topics.
    let again = load_records(
        folder.path(),
        &[Some(RecordTable::TOPICS)],
        &ReadingBudget::default(),
    )
    .unwrap()
    .remove(0)
    .unwrap();
    assert_eq!(again.columns, tables[0].columns);
}

#[test]
fn a_first_line_that_numbers_the_columns_is_no_sample() {
    let rows: String = (0..60)
        .map(|k| format!("{},{},{}\n", 0.02 * f64::from(k), k, 2 * k))
        .collect();
    let found = records_of_bytes(
        format!("1,2,3\n{rows}").as_bytes(),
        "n.csv",
        &ReadingBudget::new(1 << 20),
    )
    .unwrap();
    assert_eq!(
        (found.tables[0].rows(), found.tables[0].columns[2].values[1]),
        (60, 2.0)
    );
    let skipped = ReadingNote::ColumnNumbers.to_string();
    assert!(found.tables[0].notes.contains(&skipped));
}

#[test]
fn fdata_of_sidpac_is_read_with_the_names_of_its_columns() {
    // SIDPAC stores flight data in the columns of `fdata`, and their names with units in the rows
    // of `varlab`.
    let rows = 80;
    let column = |of: fn(f64) -> f64| (0..rows).map(move |row| of(f64::from(row)));
    let values: Vec<f64> = column(|k| 0.02 * k)
        .chain(column(|k| 2.0 + (0.1 * k).sin()))
        .chain(column(|k| 3.0 - (0.1 * k).cos()))
        .chain(column(|k| 5.0 * (0.2 * k).sin()))
        .collect();
    let labels = ["time (sec)", "lon (deg)    ", "q (deg/s)", "az (g's)"];
    let texts = labels.map(|label| format!("{label:<13}")).into();
    let variables = [
        Variable {
            name: "fdata".into(),
            value: Value::Array(Array::matrix(rows as usize, 4, values.clone())),
        },
        Variable {
            name: "varlab".into(),
            value: Value::Text(TextArray {
                shape: vec![4, 1],
                texts,
            }),
        },
    ];
    let bytes = crate::formats::mat::write(&variables).unwrap();
    let found = records_of_bytes(&bytes, "flight.mat", &ReadingBudget::default()).unwrap();
    let [table] = found.tables.as_slice() else {
        panic!("one record: {found:?}")
    };
    let columns: Vec<(&str, Option<&str>)> = table
        .columns
        .iter()
        .map(|column| (column.name.as_str(), column.unit.as_deref()))
        .collect();
    assert_eq!(
        columns,
        [
            ("time", Some("sec")),
            ("lon", Some("deg")),
            ("q", Some("deg/s")),
            ("az", Some("g's"))
        ]
    );
    assert!(table.named && found.faults.is_empty(), "{found:?}");
    assert_eq!(
        table.columns[3].values,
        values[3 * rows as usize..],
        "column by column, not sample by sample"
    );
}
