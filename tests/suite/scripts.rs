//! Output formats, messages and exit statuses, on which scripts rely.

use std::fs;

use serde_json::{Value, json};

use crate::commands::Desk;
use crate::records::LATE_UNITS;
use crate::window::records::late_dataset;

/// Returns a directory with a dataset whose condition 10 has no result.
fn desk_with_half() -> Desk {
    let desk = Desk::new();
    desk.write("half.json", |file| {
        let model = &mut file["conditions"][1]["physics_models"][0];
        model["B"] = json!([[0, 0], [0, 0]]);
        model["D"] = json!([[0, 0], [0, 0]]);
    });
    desk
}

/// Writes a record of 1.5 s, too short for any identification.
fn write_record(desk: &Desk) {
    fn row(k: u32) -> String {
        let at = f64::from(k);
        let stick = (0.3 * at).sin();
        let rate = (0.2 * at).cos();
        format!(
            "{:.2},{stick:.3},{:.3},{rate:.3},{:.3}\n",
            0.02 * at,
            0.5 * rate,
            0.4 * stick
        )
    }

    fs::write(
        desk.path("a.csv"),
        "t,LON,LAT,P,Q\n".to_owned() + &(0..80).map(row).collect::<String>(),
    )
    .unwrap();
}

#[test]
fn notes_cautions_and_errors_are_told_apart_by_how_their_lines_begin() {
    let desk = desk_with_half();
    let ended = desk.gdcm(&["analyze", "half.json", "--out", "out"]);
    assert!(
        ended.status == 0 && ended.error.starts_with("caution: condition 10: "),
        "{ended:?}"
    );
    let ended = desk.gdcm(&["check", "missing.json"]);
    assert!(
        ended.status == 2 && ended.error.starts_with("error: missing.json: "),
        "{ended:?}"
    );
    write_record(&desk);
    let identify = [
        "identify",
        "a.csv",
        "--inputs",
        "LON,LAT",
        "--outputs",
        "P,Q",
        "--band",
        "0.5",
        "12",
        "--out",
        "out",
    ];
    let ended = desk.gdcm(&identify);
    assert!(
        ended
            .error
            .lines()
            .any(|line| line.starts_with("note: a: time ")),
        "{ended:?}"
    );
    let quiet = desk.gdcm(&[&identify[..], &["--quiet"]].concat());
    assert!(
        !quiet.error.contains("note: ") && quiet.error.contains("error: "),
        "{quiet:?}"
    );
    assert_eq!(quiet.status, ended.status);
}

#[test]
fn records_that_identify_no_input_are_status_1() {
    let desk = Desk::new();
    // A sweep of the stick, and an output that does not depend on it.
    let mut noise = 12_345_u64;
    let mut row = |k: u32| {
        let t = 0.02 * f64::from(k);
        let sweep = 10.0 * (std::f64::consts::TAU * (0.08 + 0.015 * t) * t).sin();
        noise = (1_103_515_245 * noise + 12_345) % (1 << 31);
        format!(
            "{t:.2},{sweep:.4},{:.4}\n",
            noise as f64 / f64::from(1 << 30) - 1.0
        )
    };
    fs::write(
        desk.path("a.csv"),
        "t,LON,Q\n".to_owned() + &(0..3000).map(&mut row).collect::<String>(),
    )
    .unwrap();
    desk.messages(&[
        "identify",
        "a.csv",
        "--inputs",
        "LON",
        "--outputs",
        "Q",
        "--band",
        "0.5",
        "12",
        "--out",
        "out",
    ])
    .assert_status_and_code(1, "nothing-identified", &["LON"]);
    assert!(
        desk.path("out/identified.json").exists(),
        "what was computed can be looked at"
    );

    // A copy of the record under a second name is counted once, and is reported with a code.
    fs::copy(desk.path("a.csv"), desk.path("b.csv")).unwrap();
    let more = [
        "--inputs",
        "LON",
        "--outputs",
        "Q",
        "--band",
        "0.5",
        "12",
        "--out",
        "twice",
    ];
    desk.gdcm(&[&["identify", "a.csv", "b.csv"], &more[..]].concat());
    let found: Value =
        serde_json::from_slice(&fs::read(desk.path("twice/identified.json")).unwrap()).unwrap();
    let copies: Vec<&Value> = found["cautions"]
        .as_array()
        .unwrap()
        .iter()
        .filter(|of| of["code"] == "duplicate")
        .collect();
    assert_eq!(
        (copies.len(), &copies[0]["record"]),
        (1, &json!("b")),
        "{found}"
    );
}

/// Runs a command that prints its messages as a JSON object, and returns the object.
#[track_caller]
fn message_object(desk: &Desk, arguments: &[&str]) -> Value {
    let ended = desk.gdcm(arguments);
    assert_eq!(ended.error, "", "{ended:?}");
    let object: Value = serde_json::from_str(&ended.out).unwrap();
    assert_eq!(
        (&object["format"], &object["status"]),
        (&json!("gdcm-messages"), &json!(ended.status))
    );
    object
}

#[test]
fn everything_is_one_json_object_where_that_is_asked_for() {
    let desk = desk_with_half();
    let analysed = message_object(&desk, &["analyze", "half.json", "--out", "out", "--json"]);
    assert_eq!(analysed["cautions"][0]["conditions"], json!([10]));
    assert!(
        analysed["text"].as_str().unwrap().contains("Condition 7"),
        "{analysed}"
    );
    assert_eq!(analysed["error_codes"], json!([]));
    let missing = message_object(&desk, &["check", "missing.json", "--json"]);
    assert_eq!(missing["error_codes"], json!(["missing-file"]));
    assert!(
        missing["errors"][0]
            .as_str()
            .unwrap()
            .starts_with("missing.json: "),
        "{missing}"
    );
    let wrong = message_object(&desk, &["check", "--json", "--colour", "small.json"]);
    assert!(
        wrong["errors"][0].as_str().unwrap().contains("--colour") && wrong["status"] == json!(2),
        "{wrong}"
    );
}

#[test]
fn the_switches_of_every_command_may_stand_before_it() {
    let desk = desk_with_half();
    let behind = desk.gdcm(&["analyze", "half.json", "--out", "out", "--json"]);
    let before = desk.gdcm(&["--json", "analyze", "half.json", "--out", "out", "--force"]);
    assert_eq!(
        (before.status, &before.out, before.error.as_str()),
        (behind.status, &behind.out, ""),
        "{before:?}"
    );
    let object: Value = serde_json::from_str(&before.out).unwrap();
    assert_eq!((before.status, &object["status"]), (0, &json!(0)));
    let both = desk.gdcm(&["--quiet", "--json", "check", "missing.json", "--json"]);
    let object: Value = serde_json::from_str(&both.out).unwrap();
    assert_eq!((both.status, &object["status"]), (2, &json!(2)), "{both:?}");
    // A file for the window and a command exclude each other, with or without switches.
    for line in [
        &["half.json", "analyze", "--out", "other"][..],
        &["half.json", "--json", "analyze", "--out", "other"],
        &["--json", "half.json", "analyze", "--out", "other"],
    ] {
        let ended = desk.gdcm(line);
        assert_eq!(ended.status, 2, "{line:?}: {ended:?}");
        assert!(!desk.path("other").exists(), "{line:?}: {ended:?}");
    }
}

#[test]
fn a_command_that_is_written_wrongly_is_told_which_one_is_meant() {
    let desk = Desk::new();
    for (line, meant) in [
        (&["analize", "small.json", "--out", "out"][..], "analyze"),
        (&["analize"], "analyze"),
        (
            &["exprot", "small.json", "--as", "py", "--out", "c.py"],
            "export",
        ),
        (&["chekc", "small.json"], "check"),
    ] {
        let ended = desk.gdcm(&[line, &["--json"]].concat());
        let object: Value = serde_json::from_str(&ended.out).unwrap();
        assert_eq!(
            (ended.status, &object["error_codes"]),
            (2, &json!(["unknown-command"])),
            "{object}"
        );
        let words = object["errors"][0].as_str().unwrap();
        assert!(
            words.starts_with(line[0]) && words.contains(&format!("gdcm {meant}?")),
            "{words}"
        );
    }
    // Words that do not resemble a command are reported as excess arguments.
    desk.gdcm(&["something", "else"])
        .assert_failed(2, &["else"]);
}

#[test]
fn analyse_is_understood() {
    let desk = Desk::new();
    desk.gdcm(&["analyse", "small.json", "--out", "out"])
        .assert_done();
    assert!(desk.path("out/corrections.json").exists());
}

#[test]
fn a_word_in_place_of_a_range_leaves_the_file_behind_it_alone() {
    let desk = Desk::new();
    desk.gdcm(&[
        "analyze",
        "--out",
        "out",
        "--gain-bounds",
        "auto",
        "small.json",
    ])
    .assert_done();
    let corrections: Value =
        serde_json::from_slice(&fs::read(desk.path("out/corrections.json")).unwrap()).unwrap();
    assert_eq!(
        corrections["conditions"].as_array().unwrap().len(),
        2,
        "the small dataset, not the example"
    );
}

#[test]
fn a_second_variable_that_the_dataset_does_not_say_is_refused_before_the_work() {
    let desk = Desk::new();
    desk.write("bare.json", |file| {
        file["conditions"][1]
            .as_object_mut()
            .unwrap()
            .remove("mass_kg");
    });
    let ended = desk.gdcm(&[
        "analyze",
        "bare.json",
        "--out",
        "out",
        "--second-variable",
        "mass",
    ]);
    ended.assert_failed(2, &["--second-variable: ", "mass [kg]", "condition"]);
    assert!(!desk.path("out").exists());
}

#[test]
fn a_second_delay_of_one_channel_is_refused() {
    let desk = Desk::new();
    write_record(&desk);
    let line = [
        "identify",
        "a.csv",
        "--inputs",
        "LON,LAT",
        "--outputs",
        "P,Q",
        "--band",
        "0.5",
        "12",
        "--delay",
        "P=0.1",
        "--delay",
        "P=0.2",
        "--out",
        "out",
        "--quiet",
    ];
    desk.messages(&line)
        .assert_code("given-twice", &["--delay: P "]);
}

#[test]
fn a_report_is_html_and_nothing_else() {
    let desk = Desk::new();
    desk.gdcm(&["report", "small.json", "--out", "x.pdf"])
        .assert_failed(2, &["--out: ", ".html", "x.pdf"]);
}

#[test]
fn a_file_of_models_points_to_what_makes_a_dataset_of_it() {
    let desk = Desk::new();
    fs::write(desk.path("x.mat"), b"MATLAB 5.0 MAT-file").unwrap();
    let words = ["x.mat: ", "gdcm assemble x.mat ", "Import models"];
    desk.messages(&["check", "x.mat"])
        .assert_code("model-file", &words);
    desk.gdcm(&["check", "x.mat"]).assert_failed(2, &words);
    desk.gdcm(&["analyze", "x.mat", "--out", "out"])
        .assert_failed(2, &words);
}

#[test]
fn names_of_seventy_thousand_letters_are_shortened_and_control_codes_are_spelt_out() {
    let desk = Desk::new();
    desk.write("long.json", |file| {
        file["conditions"][0]["name"] = json!("x".repeat(70_000));
        file["name"] = json!("\u{1b}]0;title\u{7}");
    });
    for arguments in [
        ["check", "long.json"].as_slice(),
        &["analyze", "long.json", "--out", "out"],
        &[
            "figure",
            "long.json",
            "--view",
            "net-gain",
            "--out",
            "f.svg",
        ],
    ] {
        let ended = desk.gdcm(arguments);
        assert_eq!(ended.status, 0, "{arguments:?}");
        assert!(
            !(ended.out.clone() + &ended.error).contains(['\u{1b}', '\u{7}']),
            "{arguments:?}"
        );
        assert!(
            ended.out.len() < 20_000,
            "{arguments:?}: {} letters",
            ended.out.len()
        );
    }
}

#[cfg(unix)]
#[test]
fn no_thread_to_be_had_is_an_error_in_words() {
    let desk = Desk::new();
    // A stack size that no machine can map.
    let mut command = desk.command(&["check", "small.json"]);
    let ended = crate::commands::Ended::from_output(
        &command
            .env("RUST_MIN_STACK", "140737488355328")
            .output()
            .unwrap(),
    );
    ended.assert_failed(1, &["error: ", "thread"]);
}

#[test]
fn a_record_named_on_the_command_line_that_cannot_be_read_is_status_1_and_the_others_are_used() {
    let desk = Desk::new();
    late_dataset(&desk.path("."));
    fs::write(desk.path("broken.npz"), b"PK\x03\x04 no archive").unwrap();
    let files = [
        "flight_0.csv",
        "flight_1.csv",
        "flight_2.csv",
        "flight_3.csv",
        "broken.npz",
    ];
    let into = ["--into", "late.json", "--condition", "7", "--out", "out"];
    desk.messages(&[&["identify"], &files[..], &into[..], &LATE_UNITS].concat())
        .assert_status_and_code(1, "not-read", &["broken.npz: "])
        .assert_reported("not-read", &["broken.npz"]);
    assert!(desk.path("out/identified.json").exists());
    let nothing = desk.gdcm(&["convert", "broken.npz", "--out", "models.json"]);
    assert!(
        nothing.status != 0 && !nothing.error.contains("FILE"),
        "{nothing:?}"
    );
}

fn crc_32(bytes: &[u8]) -> u32 {
    let mut sum = flate2::Crc::new();
    sum.update(bytes);
    sum.sum()
}

/// Returns a ZIP archive of uncompressed files (APPNOTE 4.3).
fn stored_zip(files: &[(&str, &[u8])]) -> Vec<u8> {
    let mut archive = Vec::new();
    let mut directory = Vec::new();
    for (name, bytes) in files {
        let length = bytes.len() as u32;
        let numbers = [crc_32(bytes), length, length]
            .map(u32::to_le_bytes)
            .concat();
        let fields = [
            &[20, 0, 0, 0, 0, 0, 0, 0, 0, 0][..],
            &numbers,
            &[name.len() as u8, 0, 0, 0],
        ]
        .concat();
        let begin = (archive.len() as u32).to_le_bytes();
        directory.extend(
            [
                b"PK\x01\x02\x14\x00",
                fields.as_slice(),
                &[0; 10],
                &begin,
                name.as_bytes(),
            ]
            .concat(),
        );
        archive.extend([b"PK\x03\x04", fields.as_slice(), name.as_bytes(), bytes].concat());
    }
    let count = files.len() as u8;
    let begin = (archive.len() as u32).to_le_bytes();
    let length = (directory.len() as u32).to_le_bytes();
    archive.extend(directory);
    archive.extend(
        [
            b"PK\x05\x06",
            &[0; 4][..],
            &[count, 0, count, 0],
            &length,
            &begin,
            &[0, 0],
        ]
        .concat(),
    );
    archive
}

#[test]
fn a_file_that_is_broken_is_told_from_a_good_one_of_its_name_and_in_its_archive() {
    let desk = Desk::new();
    write_record(&desk);
    for folder in ["one", "two"] {
        fs::create_dir(desk.path(folder)).unwrap();
    }
    fs::copy(desk.path("a.csv"), desk.path("two/cond7_a.csv")).unwrap();
    fs::write(desk.path("one/cond7_a.csv"), "no table at all").unwrap();
    let commands = [
        ["report", "small.json", "--out", "r.html", "--force"],
        ["requirements", "small.json", "--out", "q", "--force"],
    ];
    for command in commands {
        let line = with_records(command, ["one/cond7_a.csv", "two/cond7_a.csv"]);
        desk.messages(&line)
            .assert_status_and_code(1, "not-read", &["one/cond7_a.csv: "]);
    }
    // A valid archive, and an archive whose second file is broken.
    let archive = |name: &str, broken: &str| {
        let text = fs::read(desk.path("two/cond7_a.csv")).unwrap();
        let files = [
            ("cond7_a.csv", text.as_slice()),
            ("cond7_b.csv", broken.as_bytes()),
        ];
        fs::write(desk.path(name), stored_zip(&files)).unwrap();
    };
    archive(
        "good.zip",
        "t,LON,LAT,P,Q\n0,1,2,3,4\n1,2,3,4,6\n2,3,4,5,5\n3,4,2,2,1\n4,3,2,1,5\n5,1,1,3,2\n",
    );
    archive("bad.zip", "no table at all");
    let good = desk.gdcm(&with_records(commands[0], ["good.zip", "two/cond7_a.csv"]));
    assert_eq!(good.status, 0, "{good:?}");
    for command in commands {
        let line = with_records(command, ["bad.zip", "two/cond7_a.csv"]);
        desk.messages(&line)
            .assert_status_and_code(1, "not-read", &["bad.zip: "]);
    }
}

/// Returns a command line with two record files and the units of their channels.
fn with_records<'a>(command: [&'a str; 5], records: [&'a str; 2]) -> Vec<&'a str> {
    let records = ["--records", records[0], "--records", records[1]];
    let units = [
        "--unit", "LON=%", "--unit", "LAT=%", "--unit", "P=deg/s", "--unit", "Q=deg/s",
    ];
    [&command[..], &records, &units].concat()
}

/// Inverts the signs in a row of numbers.
fn invert(row: &mut Value) {
    for value in row.as_array_mut().unwrap() {
        *value = json!(-value.as_f64().unwrap());
    }
}

/// Returns the conditions in the corrections file of a folder.
fn corrected_conditions(desk: &Desk, folder: &str) -> Value {
    let path = desk.path(&format!("{folder}/corrections.json"));
    crate::read_json(&path)["conditions"].clone()
}

#[test]
fn a_turned_channel_is_said_first_by_analyze_and_check_and_turned_by_the_option() {
    let desk = Desk::new();
    // Q has the opposite sign in the identified models: in the matrices and in the measured
    // response.
    desk.write("turned.json", |file| {
        for condition in file["conditions"].as_array_mut().unwrap() {
            for model in condition["identified_models"].as_array_mut().unwrap() {
                if model["C"].is_array() {
                    for matrix in ["C", "D"] {
                        invert(&mut model[matrix][1]);
                    }
                    continue;
                }
                for part in ["re", "im"] {
                    let response = &mut model["frequency_response"][part][1];
                    for values in response.as_array_mut().unwrap() {
                        invert(values);
                    }
                }
            }
        }
    });
    let names = ["LON → Q", "(--sign Q=-1)"];
    let said = desk.messages(&["analyze", "turned.json", "--out", "turned"]);
    said.assert_reported("convention-doubt", &names);
    assert!(
        said.text.find("(--sign Q=-1)") < said.text.find("Condition 7"),
        "before anything is blamed for it"
    );
    desk.messages(&["check", "turned.json"])
        .assert_reported("convention-doubt", &names);
    desk.messages(&["check", "turned.json", "--sign", "Q=-1"])
        .assert_not_reported("convention-doubt");
    desk.gdcm(&["analyze", "turned.json", "--sign", "Q=-1", "--out", "back"])
        .assert_done();
    desk.gdcm(&["analyze", "small.json", "--out", "right"])
        .assert_done();
    assert_eq!(
        corrected_conditions(&desk, "back"),
        corrected_conditions(&desk, "right"),
        "to the last digit"
    );
    assert_ne!(
        corrected_conditions(&desk, "turned"),
        corrected_conditions(&desk, "right")
    );
}

#[test]
fn a_sign_that_is_said_of_files_is_in_the_dataset_that_is_made_of_them() {
    let desk = Desk::new();
    crate::assembling::foreign_tree(&desk.path("models"));
    let assemble = |out: &str, more: &[&str]| {
        let ended = desk.gdcm(&[&["assemble", "models", "--out", out], more].concat());
        // The inch is undefined until the rules give a factor, so the first run fails.
        assert_eq!(ended.status, 2, "{ended:?}");
        let rules = out.replace(".json", ".gdcm-rules.json");
        let mut said = crate::read_json(&desk.path(&rules));
        said["inputs"][0] = json!({"name": "LON", "unit": "%"});
        said["on_axis"] = json!([
            ["P", "LAT"],
            ["Q", "LON"],
            ["R", "PED"],
            ["NY", "PED"],
            ["NZ", "COL"]
        ]);
        said["conversions"] = json!([{"channel": "LON", "from": "in", "factor": crate::assembling::PERCENT_IN_AN_INCH}]);
        fs::write(desk.path(&rules), said.to_string()).unwrap();
        let ended = desk.gdcm(
            &[
                &["assemble", "models", "--rules", &rules, "--out", out],
                more,
            ]
            .concat(),
        );
        assert_eq!(ended.status, 0, "{ended:?}");
        desk.messages(&["check", out])
    };
    assemble("plain.json", &[]).assert_reported("convention-doubt", &["COL → NZ"]);
    assemble("turned.json", &["--sign", "NZ=-1"]).assert_not_reported("convention-doubt");
}

#[test]
fn what_many_conditions_have_is_one_table_and_one_sentence() {
    let desk = Desk::new();
    let told = desk.messages(&["analyze", "--out", "out"]);
    told.assert_success();
    let recurring: Vec<_> = told.of_code("recurring-cautions").collect();
    assert_eq!(recurring.len(), 1, "{recurring:?}");
    assert_eq!(
        recurring[0].summarised_codes,
        ["common-lead", "held-farther", "leads-offered", "needs-lead"]
    );
    let words = told.text.split_whitespace().collect::<Vec<_>>().join(" ");
    assert_eq!(words.matches(&recurring[0].text).count(), 1, "{words}");
    let corrections = crate::read_json(&desk.path("out/corrections.json"));
    assert_eq!(
        names_and_units(&corrections["inputs"]),
        [("LON", "%"), ("LAT", "%"), ("PED", "%"), ("COL", "%")]
    );
    let rates = [
        ("P", "deg/s"),
        ("Q", "deg/s"),
        ("R", "deg/s"),
        ("NX", "m/s2"),
        ("NY", "m/s2"),
        ("NZ", "m/s2"),
    ];
    assert_eq!(names_and_units(&corrections["outputs"]), rates);
}

/// Returns the names and units of the channels in a corrections file.
fn names_and_units(channels: &Value) -> Vec<(&str, &str)> {
    let mut found = Vec::new();
    for channel in channels.as_array().unwrap() {
        let name = channel["name"].as_str().unwrap();
        found.push((name, channel["unit"].as_str().unwrap()));
    }
    found
}

#[test]
fn long_names_of_short_words_are_shortened_and_remedies_name_the_file() {
    let desk = Desk::new();
    desk.write("long.json", |file| {
        file["conditions"][0]["name"] = json!("hover at low altitude ".repeat(4000))
    });
    for arguments in [
        ["check", "long.json"].as_slice(),
        &["analyze", "long.json", "--out", "out"],
    ] {
        let ended = desk.gdcm(arguments);
        assert_eq!(ended.status, 0, "{arguments:?}");
        assert!(
            ended.out.len() < 20_000,
            "{arguments:?}: {} letters",
            ended.out.len()
        );
    }
    fs::write(desk.path("flight 7.parquet"), b"PAR1\x15\x04").unwrap();
    desk.messages(&["convert", "flight 7.parquet", "--out", "models.json"])
        .assert_code(
            "unsupported-content",
            &["\"flight 7.parquet\"", "\"flight 7.csv\""],
        );
}

/// Words from which random command lines are made: commands, options, values that suit some of
/// them, and values that suit none.
const WORDS: [&str; 72] = [
    "analyze",
    "check",
    "convert",
    "export",
    "figure",
    "identify",
    "assemble",
    "report",
    "example",
    "small.json",
    "half.json",
    "a.csv",
    "missing.json",
    "no\u{1b}[2J.json",
    ".",
    "--out",
    "out",
    "out.json",
    "out.svg",
    "out.m",
    "--as",
    "m",
    "mat",
    "state-space",
    "--view",
    "bode",
    "net-gain",
    "--condition",
    "1",
    "10",
    "11",
    "--alpha",
    "1e-12",
    "-1",
    "nan",
    "1e999",
    "--band",
    "0.5",
    "12",
    "--points",
    "2",
    "100000000000",
    "--degree",
    "table",
    "--inputs",
    "LON,LAT",
    "LON=#2",
    "NZ=-az",
    "--outputs",
    "P,Q",
    "--hold-out",
    "--part",
    "0:1",
    "5:1",
    "--order",
    "--unit",
    "P=rad/s",
    "--factor",
    "P=0",
    "--sign",
    "NZ=-1",
    "--reject",
    "10:V+10kt",
    "--into",
    "--force",
    "--json",
    "--quiet",
    "--second-variable",
    "altitude",
    "--leave-one-out",
    "--headings",
    "\u{2212}",
];

#[test]
fn command_lines_put_together_at_random_end_with_a_status_and_words() {
    let desk = desk_with_half();
    write_record(&desk);
    let mut state = 1_u64;
    let mut below = |bound: usize| {
        // Knuth's linear congruential generator (MMIX); only the upper bits are used.
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as usize % bound
    };
    for _ in 0..if std::env::var_os("GDCM_THOROUGH").is_some() {
        2000
    } else {
        100
    } {
        let mut line = vec![WORDS[below(9)]];
        line.extend((0..1 + below(7)).map(|_| WORDS[9 + below(WORDS.len() - 9)]));
        let ended = desk.gdcm(&line);
        assert!((0..=2).contains(&ended.status), "{line:?}: {ended:?}");
        let is_told = ended.status == 0
            || ended.error.contains("error: ")
            || ended.out.contains("\"errors\"");
        assert!(
            is_told && !ended.error.contains("panicked"),
            "{line:?}: {ended:?}"
        );
        let printed = [&ended.out, &ended.error]
            .into_iter()
            .flat_map(|text| text.chars());
        assert!(
            printed
                .into_iter()
                .all(|letter| letter == '\n' || !letter.is_control()),
            "{line:?}: {ended:?}"
        );
        fs::write(
            desk.path("small.json"),
            include_str!("../data/small-dataset.json"),
        )
        .unwrap();
    }
}
