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

/// Reads the records in a test file.
fn read(name: &str) -> FoundRecords {
    records_of_bytes(
        &std::fs::read(format!("{FOLDER}{name}")).unwrap(),
        name,
        &ReadingBudget::new(1 << 24),
    )
    .unwrap()
}

/// Returns the channels of the records that `tests/data/make_files.py` writes.
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
    if !table.named {
        // The first column is the time.
        for (index, rule) in rules.enumerate() {
            rule.aliases.push(format!("#{}", index + 2));
        }
    }
    if table.find("az").is_some() {
        channels.outputs[1].aliases.push("az".to_owned());
    }
    let proposal = RecordLayout::proposed(table, &channels, &TimeSettings::default());
    assert_eq!(proposal.problems, [], "{}", table.name);
    proposal.layout.flight_record(table, &channels).unwrap()
}

/// Asserts that a record has the data written by `tests/data/make_files.py`, within `digits`
/// decimals. A sample of P may be missing.
fn assert_record(table: &RecordTable, digits: i32) {
    let record = flight(table);
    let samples = record.time_s.len();
    let near = |value: f64, expected: f64| {
        // Half a unit of the last decimal, and the rounding error of a division.
        assert!(
            (value - expected).abs() < 0.5 * 10_f64.powi(-digits) + 1e-12,
            "{}: {value} instead of {expected}",
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
fn every_format_yields_the_same_record() {
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
        assert!(found.faults.is_empty(), "{name}: {:?}", found.faults);
        assert_eq!(found.tables.len(), 1, "{name}: {:?}", found.ignored);
        let table = &found.tables[0];
        assert_eq!(table.rows(), 60, "{name}");
        assert_eq!(table.source.file, name);
        assert_eq!(table.source.sha256.len(), 64, "{name}");
        assert_record(table, 3);
    }
}

/// Returns name, unit and side of each column of the first record in a test file.
fn column_labels(name: &str) -> Vec<(String, String, Option<ChannelSide>)> {
    let mut labels = Vec::new();
    for column in &read(name).tables[0].columns {
        let unit = column.unit.clone().unwrap_or_default();
        labels.push((column.name.clone(), unit, column.side));
    }
    labels
}

#[test]
fn column_names_units_and_sides_are_read_from_the_file() {
    let input = Some(ChannelSide::Input);
    let output = Some(ChannelSide::Output);
    let column = |name: &str, unit: &str, side| (name.to_owned(), unit.to_owned(), side);
    assert_eq!(
        column_labels("units.csv")[..2],
        [column("time", "s", None), column("LON", "%", None)]
    );
    assert_eq!(
        column_labels("comma.csv")[3],
        column("roll rate", "rad/s", None)
    );
    assert_eq!(
        column_labels("strokes.txt")[1],
        column("elev,yoke1", "", None)
    );
    assert_eq!(
        column_labels("sides.mat")[..2],
        [column("t", "", None), column("inr_1", "", input)]
    );
    let labelled = [
        column("LON", "", input),
        column("LAT", "", input),
        column("P", "rad/s", output),
        column("NZ", "g", output),
    ];
    assert_eq!(column_labels("struct.mat"), labelled);
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
    for found in [runs, restart, experiments] {
        for table in &found.tables {
            assert_record(table, 3);
        }
    }
}

#[test]
fn each_readable_file_in_an_archive_is_a_record() {
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
    for table in &found.tables {
        assert_record(table, 3);
    }
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

/// Returns a line of a log with the data of [`assert_record`]: sample `k`, every 20 ms.
fn log_row(k: usize, manoeuvre: &str) -> String {
    let at = k as f64;
    let hundredths = 2 * k;
    let clock = format!(
        "2026-03-01 12:30:{:02}.{:02}",
        hundredths / 100,
        hundredths % 100
    );
    let lon = 50.0 + 10.0 * (0.3 * at).sin();
    let lat = 45.0 + 8.0 * (0.2 * at).cos();
    let p = 0.3 * (0.25 * at).sin();
    let nz = 1.0 + 0.2 * (0.35 * at).cos();
    format!("{clock},{manoeuvre},{lon:.4},{lat:.4},{p:.4},{nz:.4}\n")
}

#[test]
fn words_and_clock_times_in_a_log_are_replaced_by_numbers() {
    let mut log = "time,manoeuvre,LON,LAT,P,NZ\n".to_owned();
    for manoeuvre in ["LON sweep", "LAT sweep"] {
        for k in 0..60 {
            log.push_str(&log_row(k, manoeuvre));
        }
    }
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
    for table in &found.tables {
        assert_record(table, 3);
    }
}

/// Returns a table with its heading and rising numbers, separated by strokes.
fn log_table(heading: &str, rows: usize) -> String {
    let columns = heading.split('|').count();
    let mut text = format!("{heading} |\n");
    for row in 0..rows {
        for column in 0..columns {
            text.push_str(&format!(" {} |", (row * (column + 1)) as f64 * 0.02));
        }
        text.push('\n');
    }
    text
}

#[test]
fn each_long_enough_table_of_a_restarted_log_is_a_record() {
    let text =
        log_table("time,s | P,rad/s", 3) + "\n" + &log_table("time,s | P,rad/s | Q,rad/s", 50);
    let found = records_of_bytes(text.as_bytes(), "log.txt", &ReadingBudget::new(1 << 24)).unwrap();
    // Three rows are too few for a record.
    let [table] = found.tables.as_slice() else {
        panic!("one record: {found:?}")
    };
    assert_eq!((table.rows(), table.columns.len()), (50, 3));
    let one_of_tables = ReadingNote::OneOfTables { count: 2, line: 6 };
    assert_eq!(table.notes[0], one_of_tables.to_string());
    assert_eq!(table.source.variable.as_deref(), Some("table 2"));
}

/// Returns a matrix; `value` maps the index, which counts column by column, to an entry.
fn numbers(rows: usize, columns: usize, value: impl Fn(usize) -> f64) -> Value {
    Value::Array(Array::matrix(
        rows,
        columns,
        (0..rows * columns).map(value).collect(),
    ))
}

/// Returns a cell array of texts.
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

/// Returns a struct with a single element.
fn struct_of(fields: Vec<(&str, Value)>) -> StructArray {
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
        records: struct_of(fields),
    })
}

/// Searches a variable for records.
fn search(name: &str, value: Value) -> Found<Columns> {
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
    let any = struct_of(vec![
        ("data", Value::Cell(data)),
        ("varNames", texts(&["LON", "rates"])),
        ("varUnits", texts(&["%", "deg/s"])),
        ("numRows", numbers(1, 1, |_| 60.0)),
        ("rowTimes", row_times),
    ]);
    object("timetable", vec![("any", Value::Struct(any))])
}

#[test]
fn a_timetable_has_the_times_or_the_sample_time_of_its_rows() {
    let duration = |rows: usize, ms: fn(usize) -> f64| {
        object("duration", vec![("millis", numbers(rows, 1, ms))])
    };
    let columns = |row_times: Value| search("tt", timetable(row_times)).items.remove(0);
    let with_durations = columns(duration(60, |k| 20.0 * k as f64));
    let names: Vec<&str> = with_durations
        .columns
        .iter()
        .map(|column| column.name.as_str())
        .collect();
    assert_eq!(names, ["Time", "LON", "rates_1", "rates_2"]);
    assert_eq!(
        (
            with_durations.columns[0].values[3],
            with_durations.columns[3].values[0],
            with_durations.columns[2].unit.as_deref()
        ),
        (0.06, -60.0, Some("deg/s"))
    );
    let clock = object(
        "datetime",
        vec![("data", numbers(60, 1, |k| 1.7e12 + 20.0 * k as f64))],
    );
    assert_eq!(columns(clock).columns[0].values[3], 0.06);
    // Regular times are given by a rate of 50 Hz or, otherwise, by a step of 10 ms.
    let regular = |by_rate: f64| {
        Value::Struct(struct_of(vec![
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
fn iddata_objects_of_matlab_and_octave_are_read() {
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
    let iddata = search("z", matlab).items.remove(0);
    let columns: Vec<(&str, Option<&str>)> = iddata
        .columns
        .iter()
        .map(|column| (column.name.as_str(), column.unit.as_deref()))
        .collect();
    assert_eq!(columns, [("u1", None), ("P", Some("rad/s")), ("Q", None)]);
    assert_eq!(
        (iddata.sample_time_s, iddata.columns[1].side),
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
    assert_eq!(search("z", octave).items[0].sample_time_s, Some(0.05));
    let without_outputs = object(
        "iddata",
        vec![("y", texts(&["lost"])), ("u", numbers(60, 1, |k| k as f64))],
    );
    assert_eq!(
        search("z", without_outputs).faults,
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
        search("z", over_frequency).faults,
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
    let fields = ["values", "label"]
        .into_iter()
        .enumerate()
        .map(|(at, name)| (name.to_owned(), vec![first[at].clone(), second[at].clone()]))
        .collect();
    let signals = Value::Struct(StructArray {
        shape: vec![1, 2],
        fields,
    });
    let logged = Value::Struct(struct_of(vec![
        ("time", numbers(60, 1, |k| 0.02 * k as f64)),
        ("signals", signals),
    ]));
    let simulink = search("out", logged).items.remove(0);
    let names: Vec<&str> = simulink
        .columns
        .iter()
        .map(|column| column.name.as_str())
        .collect();
    assert_eq!(
        (names, simulink.columns[1].unit.as_deref()),
        (vec!["time", "LON", "rates_1", "rates_2"], Some("%"))
    );
}

#[test]
fn matrices_of_a_model_and_short_columns_are_not_records() {
    let scalar = |value: f64| numbers(1, 1, move |_| value);
    let model = vec![
        ("A", numbers(60, 60, |_| 0.0)),
        ("B", numbers(60, 4, |_| 0.0)),
        ("C", numbers(6, 60, |_| 0.0)),
        ("D", scalar(0.0)),
    ];
    assert!(
        search("sys", Value::Struct(struct_of(model)))
            .items
            .is_empty()
    );
    let short = vec![
        ("t", numbers(10, 1, |k| k as f64)),
        ("P", numbers(10, 1, |k| k as f64)),
    ];
    let found = search("x", Value::Struct(struct_of(short)));
    assert_eq!(
        (found.items.len(), found.ignored),
        (0, vec!["x: a 1 x 1 struct array".to_owned()])
    );
}

#[test]
fn damaged_files_never_cause_a_panic() {
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

/// Returns channels without units, for aircraft logs and topics in separate files.
fn channels_named(inputs: &[&str], outputs: &[&str]) -> RecordChannels {
    let rules = |names: &[&str]| names.iter().map(|name| ChannelRule::named(*name)).collect();
    RecordChannels {
        inputs: rules(inputs),
        outputs: rules(outputs),
        ..RecordChannels::default()
    }
}

#[test]
fn channels_of_a_px4_log_are_proposed_with_their_documented_units() {
    let bytes = include_bytes!("../../../../../tests/data/logs/quadrotor.ulg");
    let found = records_of_bytes(bytes, "quadrotor.ulg", &ReadingBudget::new(MOST_MEMORY)).unwrap();
    assert_eq!(found.tables.len(), 1);
    let channels = channels_named(&["LAT", "LON", "PED"], &["P", "Q", "R", "NX"]);
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
        "the log covers 16 s and begins two minutes after the start of the autopilot"
    );
    assert!(
        record.table.modes.iter().any(|mode| mode.name == "armed"),
        "{:?}",
        record.table.modes
    );
}

#[test]
fn each_flight_with_frames_in_a_blackbox_log_is_a_record() {
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
    let channels = channels_named(&["LAT", "LON", "PED", "COL"], &["P", "Q", "R"]);
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
    let regular = steps
        .iter()
        .filter(|step| (**step - 0.004).abs() < 1e-5)
        .count();
    assert!(
        regular * 10 > 9 * steps.len(),
        "{regular} of {} steps take 4 ms, which is not 90 %",
        steps.len()
    );
    let motor = &record.table.columns[record.table.find("motor[0]").unwrap()];
    let (least, most) = motor.range().unwrap();
    assert!(
        (158.0..2048.0).contains(&least) && most < 2048.0,
        "the heading states 158 to 2048: {least} to {most}"
    );
}

/// Returns 20 s of a topic with a single field, in CSV.
fn topic_table(rate_hz: u32, field: &str) -> String {
    let mut text = format!("time,{field}\n");
    for k in 0..20 * rate_hz {
        let time_s = f64::from(k) / f64::from(rate_hz);
        text.push_str(&format!("{time_s},{}\n", f64::from(k % 17)));
    }
    text
}

#[test]
fn topic_tables_in_a_folder_are_joined_into_one_record() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("notes.log"), "it went well").unwrap();
    std::fs::write(folder.path().join("M.csv"), topic_table(100, "value")).unwrap();
    std::fs::write(folder.path().join("imu.csv"), topic_table(50, "q")).unwrap();
    let found = read_records(&[folder.path().to_owned()], &Stopped(&Arc::default())).unwrap();
    let tables = with_topics_joined(
        found.tables,
        &channels_named(&["M"], &["q"]),
        &TimeSettings::default(),
    );
    assert_eq!(
        (tables.len(), found.faults),
        (1, Vec::new()),
        "a text without a table is ignored, not a fault"
    );
    let (record, _) = LaidOutRecord::proposed(
        tables[0].clone(),
        &channels_named(&["M"], &["q"]),
        &TimeSettings::default(),
    );
    assert!(record.problems.is_empty(), "{:?}", record.problems);
    // 20 s at the lower rate of 50 Hz are 1000 samples.
    let samples = record.flight.unwrap().time_s.len();
    assert!(samples > 900, "{samples} samples");
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
fn a_first_line_of_column_numbers_is_not_a_sample() {
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
    let column = |value: fn(f64) -> f64| (0..rows).map(move |row| value(f64::from(row)));
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
