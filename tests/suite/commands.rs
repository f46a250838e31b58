//! Commands, run as separate processes.

use std::collections::BTreeSet;
use std::ffi::OsStr;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

use serde_json::{Value, json};

use gdcm_io::{Example, load_dataset, load_example, save_study};
use gdcm_model::dataset::BundleKind;
use gdcm_study::decisions::setting_table;
use gdcm_study::results::verdict::PhaseVerdict;
use gdcm_study::{Engine, Study, Unobserved};
use gdcm_words::verdict::{phase_verdict_text, study_verdict_text};

use crate::{FEW, entries, members, read_json};

pub(crate) const SMALL: &str = include_str!("../data/small-dataset.json");

/// Temporary directory with the small dataset, in which commands are run.
pub(crate) struct Desk {
    pub(crate) directory: tempfile::TempDir,
}

impl Desk {
    pub(crate) fn new() -> Self {
        let directory = tempfile::tempdir().unwrap();
        fs::write(directory.path().join("small.json"), SMALL).unwrap();
        Self { directory }
    }

    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.directory.path().join(name)
    }

    /// Returns a directory that also contains a few conditions of the example.
    pub(crate) fn with_few() -> Self {
        let desk = Self::new();
        fs::write(desk.path("few.json"), &*crate::FEW_TEXT).unwrap();
        desk
    }

    pub(crate) fn write(&self, name: &str, change: impl FnOnce(&mut Value)) {
        let mut value: Value = serde_json::from_str(SMALL).unwrap();
        change(&mut value);
        fs::write(self.path(name), serde_json::to_vec(&value).unwrap()).unwrap();
    }

    pub(crate) fn gdcm(&self, arguments: &[&str]) -> Ended {
        let output = self.command(arguments).output().unwrap();
        Ended::from_output(&output)
    }

    /// Runs a command line with additional arguments.
    pub(crate) fn run(&self, line: &[&str], more: &[&str]) -> Ended {
        self.gdcm(&[line, more].concat())
    }

    /// Returns the text of a file.
    #[track_caller]
    pub(crate) fn read(&self, name: &str) -> String {
        fs::read_to_string(self.path(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
    }

    /// Runs a command, and returns the messages in its JSON output.
    #[track_caller]
    pub(crate) fn messages(&self, arguments: &[&str]) -> Messages {
        Messages::from_json(&self.gdcm(&[arguments, &["--json"]].concat()))
    }

    pub(crate) fn command<S: AsRef<OsStr>>(&self, arguments: &[S]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_gdcm"));
        command.args(arguments).current_dir(self.directory.path());
        command
    }
}

/// The JSON object of a command.
#[derive(Debug)]
pub(crate) struct Messages {
    pub(crate) status: i32,
    /// What the command would print on standard output.
    pub(crate) text: String,
    pub(crate) errors: Vec<Message>,
    pub(crate) notes: Vec<Message>,
    pub(crate) cautions: Vec<Message>,
}

/// An error, a caution or a note.
#[derive(Debug)]
pub(crate) struct Message {
    pub(crate) code: String,
    /// Codes of the cautions that a table summarises.
    pub(crate) summarised_codes: Vec<String>,
    pub(crate) text: String,
    pub(crate) conditions: Vec<i64>,
}

impl Message {
    fn contains_all(&self, names: &[&str]) -> bool {
        names.iter().all(|name| self.text.contains(name))
    }
}

impl Messages {
    pub(crate) fn from_json(ended: &Ended) -> Self {
        let object: Value =
            serde_json::from_str(&ended.out).unwrap_or_else(|error| panic!("{error}: {ended:?}"));
        assert_eq!(ended.error, "", "nothing beside the object: {ended:?}");
        assert_eq!(object["status"], ended.status);
        let mut cautions = Vec::new();
        for caution in entries(&object["cautions"]) {
            let summarised = caution.get("summarised_codes").map_or(vec![], texts);
            let conditions = entries(&caution["conditions"]).iter();
            cautions.push(Message {
                code: caution["code"].as_str().expect("a code").to_owned(),
                summarised_codes: summarised,
                text: caution["text"].as_str().expect("a text").to_owned(),
                conditions: conditions.map(|id| id.as_i64().expect("an id")).collect(),
            });
        }
        Self {
            status: ended.status,
            text: object["text"].as_str().expect("a text").to_owned(),
            errors: coded(&object["errors"], &object["error_codes"]),
            notes: coded(&object["notes"], &object["note_codes"]),
            cautions,
        }
    }

    /// Asserts status 2, the code of the last error, and that its message contains these options, names and numbers.
    #[track_caller]
    pub(crate) fn assert_code(&self, code: &str, names: &[&str]) -> &Self {
        self.assert_status_and_code(2, code, names)
    }

    /// Asserts the status, the code of the last error, and that its message contains these options, names and numbers.
    #[track_caller]
    pub(crate) fn assert_status_and_code(&self, status: i32, code: &str, names: &[&str]) -> &Self {
        assert_eq!(self.status, status, "{self:?}");
        let error = self.errors.last().expect("an error");
        assert_eq!(error.code, code, "{self:?}");
        assert_eq!(error.text.lines().count(), 1, "{self:?}");
        for name in names {
            assert!(
                error.text.contains(name),
                "expected \"{name}\" in: {error:?}"
            );
        }
        self
    }

    /// Asserts that the command succeeded.
    #[track_caller]
    pub(crate) fn assert_success(&self) -> &Self {
        assert_eq!((self.status, self.errors.len()), (0, 0), "{self:?}");
        self
    }

    /// Asserts that an error, a caution or a note has this code and contains these names and
    /// numbers.
    #[track_caller]
    pub(crate) fn assert_reported(&self, code: &str, names: &[&str]) -> &Self {
        assert!(
            self.of_code(code)
                .any(|message| message.contains_all(names)),
            "expected {code} with {names:?}: {self:?}"
        );
        self
    }

    /// Asserts that no error, caution or note has this code.
    #[track_caller]
    pub(crate) fn assert_not_reported(&self, code: &str) -> &Self {
        assert!(self.of_code(code).next().is_none(), "{code}: {self:?}");
        self
    }

    /// Returns the errors, cautions and notes with this code.
    pub(crate) fn of_code<'a>(&'a self, code: &'a str) -> impl Iterator<Item = &'a Message> {
        let all = self.errors.iter().chain(&self.cautions).chain(&self.notes);
        all.filter(move |message| message.code == code)
    }
}

/// Joins texts and their codes.
fn coded(list: &Value, codes: &Value) -> Vec<Message> {
    let codes = texts(codes);
    let list = texts(list);
    assert_eq!(codes.len(), list.len(), "each has a code");
    codes
        .into_iter()
        .zip(list)
        .map(|(code, text)| Message {
            code,
            summarised_codes: Vec::new(),
            text,
            conditions: Vec::new(),
        })
        .collect()
}

/// Returns the strings in a JSON list.
fn texts(list: &Value) -> Vec<String> {
    entries(list)
        .iter()
        .map(|text| text.as_str().expect("a text").to_owned())
        .collect()
}

/// Exit status and output of a command.
#[derive(Debug)]
pub(crate) struct Ended {
    pub(crate) status: i32,
    pub(crate) out: String,
    pub(crate) error: String,
}

impl Ended {
    pub(crate) fn from_output(output: &Output) -> Self {
        Self {
            status: output.status.code().unwrap(),
            out: String::from_utf8(output.stdout.clone()).unwrap(),
            error: String::from_utf8(output.stderr.clone()).unwrap(),
        }
    }

    /// Asserts this exit status, an error message of one or two lines that contains these words,
    /// and no standard output.
    #[track_caller]
    pub(crate) fn assert_failed(&self, status: i32, words: &[&str]) {
        assert_eq!((self.status, self.out.as_str()), (status, ""), "{self:?}");
        assert!(
            (1..=2).contains(&self.error.lines().count()),
            "{}",
            self.error
        );
        for word in words {
            assert!(
                self.error.contains(word),
                "expected \"{word}\" in: {}",
                self.error
            );
        }
    }

    #[track_caller]
    pub(crate) fn assert_done(&self) {
        assert_eq!((self.status, self.error.as_str()), (0, ""), "{self:?}");
    }
}

fn rows(path: &Path) -> Vec<csv::StringRecord> {
    csv::Reader::from_path(path)
        .unwrap()
        .records()
        .map(Result::unwrap)
        .collect()
}

#[test]
fn the_embedded_example_is_analysed_without_a_file() {
    let desk = Desk::new();
    let ended = desk.gdcm(&["analyze", "--out", "results/of/today", "--reject-suggested"]);
    ended.assert_done();
    let corrections = crate::read_json(&desk.path("results/of/today/corrections.json"));
    assert_eq!(
        (
            entries(&corrections["conditions"]).len(),
            entries(&corrections["failed"]).len()
        ),
        (11, 0)
    );
    let tenth = condition_of(&corrections, "10");
    assert_eq!(
        tenth["rejected"],
        json!(["nominal", "ROLL+5deg", "V+5kt ROC+150fpm ROLL+5deg"])
    );
    assert_eq!(tenth["rejected"], tenth["suggested_outliers"]);
    assert_eq!(corrections["assessment"]["left_out"][0]["id"], 10);
    assert_eq!(
        rows(&desk.path("results/of/today/corrections.csv")).len(),
        11 * 10
    );
    assert_eq!(
        rows(&desk.path("results/of/today/assessment.csv")).len(),
        11 * 24
    );
    for words in ["Condition 10", "ROLL+5deg", "LON → Q", "Schedule"] {
        assert!(
            ended.out.contains(words),
            "expected \"{words}\" in:\n{}",
            ended.out
        );
    }
    let widest = ended
        .out
        .lines()
        .map(|line| line.chars().count())
        .max()
        .unwrap();
    assert!(widest <= 120, "{widest} columns");
}

/// The verdict is the window's: the same counts and the same words, one line per condition.
#[test]
fn a_brief_analysis_prints_one_line_per_condition_and_keeps_every_caution() {
    let desk = Desk::with_few();
    let brief = desk.messages(&["analyze", "few.json", "--out", "brief", "--brief"]);
    let full = desk.messages(&["analyze", "few.json", "--out", "full"]);
    brief.assert_success();
    full.assert_success();
    let study = Study::new(FEW.dataset.clone());
    let analysis = Engine::default().analyze(&study, &Unobserved).unwrap();
    assert!(brief.text.contains(&study_verdict_text(&analysis)));
    for condition in FEW.dataset.conditions() {
        let result = analysis.condition(condition.id()).unwrap();
        let phase = PhaseVerdict::new(&study, result);
        assert_eq!(phase.code(), "lag-remains");
        let state = condition.flight_state();
        let start = format!("  {}: {} kt", state.id, state.airspeed_kt);
        let lines: Vec<&str> = brief
            .text
            .lines()
            .filter(|line| line.starts_with(&start))
            .collect();
        let [line] = lines[..] else {
            panic!("{lines:?}")
        };
        assert!(line.contains("5 of 5") && line.contains("0 of 5"), "{line}");
        assert!(line.contains(&phase_verdict_text(phase, &study)), "{line}");
    }
    let lines = brief.text.lines().count();
    assert!(
        lines < 8 + 2 * FEW.dataset.conditions().len(),
        "{lines} lines"
    );
    let (first, _) = brief.text.rsplit_once("Written").unwrap();
    assert!(full.text.starts_with(first), "the full text begins with it");
    let codes = |messages: &Messages| -> Vec<String> {
        let cautions = messages.cautions.iter();
        cautions.map(|caution| caution.code.clone()).collect()
    };
    assert_eq!(codes(&brief), codes(&full));
    for code in ["needs-lead", "common-lead"] {
        assert!(brief.text.contains(code), "{code}");
    }
}

#[test]
fn the_program_agrees_with_independent_code_on_this_machine() {
    let desk = Desk::new();
    let ended = desk.gdcm(&["verify", "--json"]);
    ended.assert_done();
    let object: Value = serde_json::from_str(&ended.out).unwrap();
    let checks = object["checks"].as_array().unwrap();
    assert_eq!(checks.len(), gdcm_verify::CHECKS.len());
    for (found, check) in checks.iter().zip(gdcm_verify::CHECKS) {
        assert_eq!(
            (&found["code"], &found["passed"]),
            (&json!(check.code), &json!(true))
        );
        let worst = found["worst"].as_f64().unwrap();
        assert!(worst <= check.tolerance, "{}: {worst}", check.code);
        assert!(object["text"].as_str().unwrap().contains(check.code));
    }
}

/// Returns the result of a condition in a corrections file.
fn condition_of<'j>(corrections: &'j Value, id: &str) -> &'j Value {
    entries(&corrections["conditions"])
        .iter()
        .find(|condition| condition["id"].as_u64() == id.parse().ok())
        .unwrap()
}

#[test]
fn what_is_written_says_the_same_in_all_three_files() {
    let desk = Desk::new();
    desk.gdcm(&["analyze", "small.json", "--out", "."])
        .assert_done();
    let corrections = crate::read_json(&desk.path("corrections.json"));
    for row in rows(&desk.path("corrections.csv")) {
        let condition = condition_of(&corrections, &row[0]);
        for (metric, cell) in [("gains", &row[4]), ("delays_s", &row[5])] {
            let figure = &condition[metric][format!("{}s", &row[2])][&row[3]];
            assert_eq!(*figure, cell.parse::<f64>().unwrap(), "to the last digit");
        }
    }
    let header = csv::Reader::from_path(desk.path("assessment.csv"))
        .unwrap()
        .headers()
        .unwrap()
        .clone();
    let column = |name: &str| header.iter().position(|heading| heading == name).unwrap();
    for row in rows(&desk.path("assessment.csv")) {
        let condition = condition_of(&corrections, &row[0]);
        let nets = entries(&condition["net_gains"]);
        let net = nets
            .iter()
            .find(|net| net["output"] == row[2] && net["input"] == row[3])
            .unwrap();
        assert_eq!(net["gain"], row[column("net_gain")].parse::<f64>().unwrap());
        let held = entries(&condition["held"]).contains(&json!([&row[2], &row[3]]));
        assert_eq!(&row[column("held")], if held { "true" } else { "false" });
    }
}

#[test]
fn every_option_reaches_the_analysis() {
    let desk = Desk::new();
    let options = [
        "--alpha",
        "0.25",
        "--alpha-delay",
        "2",
        "--band",
        "1",
        "8",
        "--points",
        "31",
        "--degree",
        "1",
    ];
    let more = [
        "--on",
        "P/LAT, Q/LAT",
        "--reject",
        "7:V+5kt",
        "--reject",
        "10:static gain",
    ];
    let arguments: Vec<&str> = ["analyze", "small.json", "--out", "out"]
        .into_iter()
        .chain(options)
        .chain(more)
        .collect();
    desk.gdcm(&arguments).assert_done();
    let written = crate::read_json(&desk.path("out/corrections.json"));
    let settings = &written["settings"];
    for (key, value) in [
        ("alpha_gain", json!(0.25)),
        ("alpha_delay", json!(2.0)),
        ("points", json!(31)),
        ("band_rad_s", json!([1.0, 8.0])),
        ("constrained", json!([["P", "LAT"], ["Q", "LAT"]])),
    ] {
        assert_eq!(settings[key], value, "{key}");
    }
    assert_eq!(written["schedule"]["degree"], 1);
    let rejected = [0, 1].map(|at| &written["conditions"][at]["rejected"]);
    assert_eq!(rejected, [&json!(["V+5kt"]), &json!(["static gain"])]);
}

#[test]
fn delays_are_scheduled_and_a_tolerance_is_set_by_options() {
    let desk = Desk::new();
    desk.gdcm(&[
        "analyze",
        "small.json",
        "--out",
        "out",
        "--schedule-delays",
        "--agreement",
        "0.2",
    ])
    .assert_done();
    let written = crate::read_json(&desk.path("out/corrections.json"));
    assert_eq!(written["settings"]["schedule_delays"], "always");
    assert_eq!(written["settings"]["schedule"]["delays"], true);
    assert!(written["schedule"]["delays_s"].is_object());
    assert_eq!(written["settings"]["agreement_db"], 0.2);
    desk.messages(&[
        "analyze",
        "small.json",
        "--out",
        "out",
        "--force",
        "--agreement",
        "4",
    ])
    .assert_code("wrong-option", &["--agreement: ", " dB ", "0", "3", "4"]);
}

#[test]
fn the_phase_is_corrected_as_an_option_says() {
    let desk = Desk::new();
    let reference = crate::REFERENCE_DATASET.path().unwrap().to_str().unwrap();
    let analyze = ["analyze", reference, "--out", "out", "--force"];
    let corrections = desk.path("out/corrections.json");
    let options = ["--phase", "lead", "--gain-from", "mean"];
    let told = desk.messages(&[&analyze[..], &options].concat());
    told.assert_success();
    // Remarks common to all conditions are printed once.
    let recurring: Vec<&Message> = told.of_code("recurring-cautions").collect();
    assert_eq!(recurring.len(), 1, "{recurring:?}");
    assert!(
        recurring[0]
            .summarised_codes
            .contains(&"common-lead".to_owned()),
        "{recurring:?}"
    );
    let limits: Vec<&Message> = told.of_code("lead-limit").collect();
    let conditions: Vec<i64> = (1..=11).filter(|id| *id != 4).collect();
    assert!(
        limits
            .iter()
            .any(|limit| limit.conditions == conditions && limit.text.contains(" 20 ")),
        "{limits:?}"
    );
    for words in [
        "order 2, n 3 (--lead-n), R_max 10",
        "at 120 rad/s",
        "PED → NY",
    ] {
        assert!(told.text.contains(words), "{words}: {}", told.text);
    }
    let led = crate::read_json(&corrections);
    assert_eq!(
        (&led["settings"]["phase"], &led["settings"]["delay_from"]),
        (&json!("lead"), &json!("median"))
    );
    let condition = &led["conditions"][0];
    let lat = &condition["lead"]["inputs"]["LAT"];
    // Reference values from independent numpy code.
    for (key, value, allowed) in [
        ("tau_s", -0.041_244_995_923_2, 1e-9),
        ("lead_s", 0.037_522_384_891_1, 1e-9),
        ("lag_rad_s", 36.0, 1e-9),
        ("gain_at_infinity_db", 11.647, 1e-3),
    ] {
        assert!(
            (lat[key].as_f64().unwrap() - value).abs() < allowed,
            "{key}: {lat}"
        );
    }
    assert_eq!(
        condition["delays_s"]["inputs"]["LAT"], 0.0,
        "the positive part"
    );
    assert!(
        condition["delay_solution"]["kkt_residual_s"]
            .as_f64()
            .unwrap()
            < 1e-14
    );
    let tau_s = led["schedule"]["tau_s"]["inputs"]["LAT"][0]
        .as_f64()
        .unwrap();
    assert!((tau_s + 0.037_896_231_201_2).abs() < 1e-9);
    let text = fs::read_to_string(desk.path("out/corrections.csv")).unwrap();
    assert!(
        text.lines()
            .next()
            .unwrap()
            .contains(",tau_s,lead_s,zero_rad_s,lag_rad_s,gain_at_infinity_db,scheduled_tau_s,")
    );
    let ended = desk.run(&analyze, &["--phase", "none"]);
    ended.assert_done();
    assert!(!ended.out.contains("G from"), "{}", ended.out);
    for of in entries(&crate::read_json(&corrections)["conditions"]) {
        assert!(
            of.get("lead").is_none()
                && members(&of["delays_s"]["outputs"])
                    .iter()
                    .all(|delay_s| **delay_s == 0.0)
        );
    }
    desk.run(&analyze, &["--delay-from", "band"]).assert_done();
    let settings = &crate::read_json(&corrections)["settings"];
    assert_eq!(
        (&settings["phase"], &settings["delay_from"]),
        (&json!("delay"), &json!("band"))
    );
    desk.messages(&[&analyze[..], &["--phase", "later"]].concat())
        .assert_code(
            "wrong-option",
            &["--phase: ", "none", "delay", "lead", "later"],
        );
}

#[test]
fn coherence_is_switched_by_an_option() {
    let desk = Desk::new();
    for (choice, threshold) in [("off", None), ("on", Some(0.6)), ("0.85", Some(0.85))] {
        desk.gdcm(&[
            "analyze",
            "small.json",
            "--out",
            "out",
            "--force",
            "--coherence",
            choice,
        ])
        .assert_done();
        let written = crate::read_json(&desk.path("out/corrections.json"));
        assert_eq!(
            written["settings"]
                .get("coherence_threshold")
                .and_then(|of| of.as_f64()),
            threshold,
            "{choice}"
        );
    }
    for (choice, names) in [
        ("1.5", &["--coherence: ", "0", "1", "1.5"][..]),
        ("some", &["--coherence: ", "off", "on", "some"]),
    ] {
        let refused = desk.messages(&[
            "analyze",
            "small.json",
            "--out",
            "out",
            "--force",
            "--coherence",
            choice,
        ]);
        refused.assert_code("wrong-option", names);
    }
}

#[test]
fn sample_times_and_delays_are_told() {
    let desk = Desk::new();
    desk.write("timed.json", |file| {
        let models = &mut file["conditions"][0]["physics_models"];
        models[0]["sample_time_s"] = json!(0.01);
        models[1]["input_delays_s"] = json!([0.02, 0]);
    });
    let ended = desk.gdcm(&["check", "timed.json"]);
    ended.assert_done();
    for [model, timing] in [["nominal: ", " 0.01 s"], ["V+5kt: ", " 0.02, 0 s"]] {
        let mut lines = ended.out.lines();
        assert!(
            lines.any(|line| line.contains(model) && line.ends_with(timing)),
            "{}",
            ended.out
        );
    }
    assert!(!desk.gdcm(&["check", "small.json"]).out.contains("Timing"));
}

#[test]
fn no_pair_held_is_a_choice_of_its_own() {
    let desk = Desk::new();
    desk.gdcm(&["analyze", "small.json", "--out", "out", "--on", "none"])
        .assert_done();
    assert_eq!(
        crate::read_json(&desk.path("out/corrections.json"))["settings"]["constrained"],
        json!([])
    );
}

#[test]
fn what_cannot_be_held_together_is_told_with_the_reason() {
    let desk = Desk::new();
    let ended = desk.gdcm(&[
        "analyze",
        "small.json",
        "--out",
        "out",
        "--on",
        "P/LON,P/LAT,Q/LON,Q/LAT",
    ]);
    ended.assert_done();
    let written = crate::read_json(&desk.path("out/corrections.json"));
    let gains = &written["conditions"][0]["gain_solution"];
    assert_eq!(gains["matched"], false);
    for entry in entries(&gains["unmatched"]) {
        let conflicts = entries(&gains["explanation"]["conflicts"]);
        let named = json!([entry["output"], entry["input"]]);
        assert!(
            conflicts.iter().any(|conflict| {
                conflict["kind"] == "loop" && entries(&conflict["entries"]).contains(&named)
            }),
            "{gains}"
        );
        let mut nets = entries(&written["conditions"][0]["net_gains"]).iter();
        let net = nets
            .find(|net| net["output"] == entry["output"] && net["input"] == entry["input"])
            .unwrap();
        let [gain, target, wanted, short_db] = [
            &net["gain"],
            &entry["target"],
            &entry["wanted"],
            &entry["short_db"],
        ]
        .map(|of| of.as_f64().unwrap());
        // The products match their targets within 1e-8 in the logarithm.
        assert!((gain / target).ln().abs() < 1e-8, "{entry}");
        assert!(
            (short_db - 20.0 * (target / wanted).log10()).abs() < 1e-9,
            "{entry}"
        );
    }
}

#[test]
fn a_study_stands_in_place_of_a_dataset_and_options_over_what_it_says() {
    let desk = Desk::new();
    let loaded = load_dataset(&desk.path("small.json")).unwrap();
    let mut study = Study::new(loaded.dataset.clone());
    for edit in [
        setting_table::ALPHA_GAIN.to(0.1 + 0.2),
        setting_table::POINTS.to(33),
    ] {
        study.apply(&edit).unwrap();
    }
    save_study(&study, &loaded, &desk.path("a.gdcm-study.json")).unwrap();
    desk.gdcm(&[
        "analyze",
        "a.gdcm-study.json",
        "--out",
        "out",
        "--points",
        "44",
    ])
    .assert_done();
    let written = crate::read_json(&desk.path("out/corrections.json"));
    assert_eq!(
        (
            &written["settings"]["alpha_gain"],
            &written["settings"]["points"]
        ),
        (&json!(0.1 + 0.2), &json!(44))
    );
    assert_eq!(written["dataset"]["sha256"], loaded.sha256);
    let checked = desk.gdcm(&["check", "a.gdcm-study.json"]);
    checked.assert_done();
    assert!(checked.out.contains("a.gdcm-study.json") && checked.out.contains("two conditions"));
}

#[test]
fn check_says_what_a_file_holds() {
    let desk = Desk::new();
    desk.write("odd.json", |file| file["author"] = json!("someone"));
    let checked = desk.messages(&["check", "odd.json"]);
    checked
        .assert_success()
        .assert_reported("unknown-key", &["\"author\""]);
    for words in [
        "odd.json",
        "LON [%], LAT [%]",
        "LAT → P, LON → Q",
        "0.5 to 12 rad/s",
        "hover",
        "cruise",
    ] {
        assert!(
            checked.text.contains(words),
            "expected \"{words}\" in:\n{}",
            checked.text
        );
    }
}

#[test]
fn a_wrong_file_is_status_2_with_path_and_place() {
    let desk = Desk::new();
    desk.write("bad.json", |file| {
        file["conditions"][0]["physics_models"][1]["A"][1][0] = json!("x")
    });
    let words = [
        "bad.json: ",
        "condition 7",
        "\"V+5kt\"",
        "matrix A, ",
        "row 2",
        "column 1",
    ];
    desk.gdcm(&["check", "bad.json"]).assert_failed(2, &words);
    desk.messages(&["check", "bad.json"])
        .assert_code("wrong-type", &words);
    desk.messages(&["analyze", "bad.json", "--out", "out"])
        .assert_code("wrong-type", &words);
    assert!(
        !desk.path("out").exists(),
        "nothing is made before the file is known to be good"
    );
    desk.messages(&["check", "missing.json"])
        .assert_code("missing-file", &["missing.json: "]);
    desk.messages(&["check", "."])
        .assert_code("input-is-a-directory", &[]);
}

#[test]
fn a_wrong_command_line_is_status_2_with_the_option() {
    let desk = Desk::new();
    let cases: [(&[&str], &str, &[&str]); 16] = [
        (
            &["--alpha", "-1"],
            "wrong-option",
            &["--alpha: ", "from 0", "found -1"],
        ),
        (
            &["--alpha", "NaN"],
            "wrong-option",
            &["--alpha: ", "found NaN"],
        ),
        (&["--alpha", "much"], "wrong-option", &["--alpha: ", "much"]),
        (
            &["--alpha-delay", "1e9"],
            "wrong-option",
            &["--alpha-delay: ", "found 1000000000"],
        ),
        (
            &["--band", "8", "1"],
            "wrong-option",
            &["--band: ", "0.0001 <= min < max <= 100000", "min 8, max 1"],
        ),
        (&["--band", "8"], "wrong-command-line", &["--band"]),
        (
            &["--points", "1"],
            "wrong-option",
            &["--points: ", "from 2 to 5000"],
        ),
        (
            &["--degree", "4"],
            "wrong-option",
            &["--degree: ", "0, 1, 2, 3 or table", "found 4"],
        ),
        (&["--on", "P"], "wrong-command-line", &["OUTPUT/INPUT"]),
        (
            &["--on", "P/PED"],
            "unknown-response",
            &["--on: ", "P/PED", "LON, LAT"],
        ),
        (&["--reject", "nominal"], "wrong-command-line", &["ID:NAME"]),
        (
            &["--reject", "8:nominal"],
            "unknown-condition",
            &["--reject: ", "condition 8"],
        ),
        (
            &["--reject", "7:other"],
            "unknown-model",
            &["--reject: ", "condition 7", "\"other\""],
        ),
        (
            &["--reject", "10:nominal"],
            "wrong-option",
            &["--reject: ", "condition 10", "\"nominal\""],
        ),
        (&["--colour"], "wrong-command-line", &["--colour"]),
        (
            &["--sign", "P=-1", "--sign", "P=1"],
            "given-twice",
            &["--sign: ", "P "],
        ),
    ];
    for (options, code, names) in cases {
        let line = [&["analyze", "small.json", "--out", "out"], options].concat();
        desk.gdcm(&line).assert_failed(2, names);
        desk.messages(&line).assert_code(code, names);
    }
    desk.gdcm(&["analyze", "small.json"])
        .assert_failed(2, &["--out"]);
    assert!(!desk.path("out").exists());
}

#[test]
fn an_output_directory_that_cannot_be_made_is_status_2_before_any_work() {
    let desk = Desk::new();
    desk.messages(&["analyze", "small.json", "--out", "small.json"])
        .assert_code("output-directory-is-a-file", &["small.json: "]);
}

#[test]
fn a_directory_where_a_result_has_to_stand_is_status_2_before_any_work() {
    let desk = Desk::new();
    fs::create_dir_all(desk.path("out/corrections.csv")).unwrap();
    desk.gdcm(&["analyze", "small.json", "--out", "out"])
        .assert_failed(2, &["corrections.csv", "directory"]);
    assert_eq!(fs::read_dir(desk.path("out")).unwrap().count(), 1);
}

#[test]
fn an_analysis_without_any_result_is_status_1() {
    let desk = Desk::new();
    desk.write("silent.json", |file| {
        for condition in file["conditions"].as_array_mut().unwrap() {
            for model in condition["physics_models"].as_array_mut().unwrap() {
                model["B"] = json!([[0, 0], [0, 0]]);
                model["D"] = json!([[0, 0], [0, 0]]);
            }
        }
    });
    desk.messages(&["analyze", "silent.json", "--out", "out"])
        .assert_status_and_code(
            1,
            "no-result",
            &["conditions 7, 10: ", "\"nominal\"", "\"sweeps\""],
        );
}

#[test]
fn a_condition_without_result_is_told_and_the_others_are_written() {
    let desk = Desk::new();
    desk.write("half.json", |file| {
        let model = &mut file["conditions"][1]["physics_models"][0];
        model["B"] = json!([[0, 0], [0, 0]]);
        model["D"] = json!([[0, 0], [0, 0]]);
    });
    let told = desk.messages(&["analyze", "half.json", "--out", "out"]);
    told.assert_success();
    let failed: Vec<&Message> = told.of_code("nothing-to-compare").collect();
    assert!(
        failed.len() == 1 && failed[0].conditions == [10] && failed[0].text.contains("\"nominal\""),
        "{told:?}"
    );
    let written = crate::read_json(&desk.path("out/corrections.json"));
    assert_eq!(
        (
            entries(&written["conditions"]).len(),
            &written["failed"][0]["id"]
        ),
        (1, &json!(10))
    );
    let text = fs::read_to_string(desk.path("out/corrections.json")).unwrap();
    assert!(!text.contains("NaN"));
    let undefined = rows(&desk.path("out/corrections.csv"))
        .into_iter()
        .filter(|row| &row[0] == "10");
    assert!(
        undefined.into_iter().all(|row| row[4].is_empty()),
        "an undefined figure is an empty cell"
    );
}

#[test]
fn a_file_may_be_named_like_a_command() {
    let desk = Desk::new();
    fs::rename(desk.path("small.json"), desk.path("check")).unwrap();
    desk.gdcm(&["check", "check"]).assert_done();
    desk.gdcm(&["analyze", "./check", "--out", "out"])
        .assert_done();
}

#[test]
fn the_example_is_written_and_can_be_read() {
    let desk = Desk::new();
    let ended = desk.gdcm(&["example", "learn/the format"]);
    ended.assert_done();
    let path = desk.path("learn/the format/example-dataset.json");
    assert_eq!(load_dataset(&path).unwrap().dataset.conditions().len(), 11);
    assert!(ended.out.contains("learn/the format/example-dataset.json"));
}

#[test]
fn the_real_aircraft_is_written_with_its_records_and_licences() {
    let desk = Desk::new();
    let ended = desk.gdcm(&["example", "real", "--real"]);
    ended.assert_done();
    let assets = Path::new(env!("CARGO_MANIFEST_DIR")).join("assets/real-aircraft");
    for file in [
        "pelican/physics.json",
        "pelican/records.zip",
        "pelican/LICENSE",
        "antx/physics.json",
        "antx/prbs.mat",
        "antx/sweep.mat",
        "antx/LICENSE",
    ] {
        assert!(ended.out.contains(&format!("real/{file}\n")), "{ended:?}");
        assert!(
            fs::read(desk.path("real").join(file)).unwrap() == fs::read(assets.join(file)).unwrap(),
            "{file}"
        );
    }
    let written = load_dataset(&desk.path("real/pelican/real-aircraft.json")).unwrap();
    let embedded = load_example(Example::RealAircraft).unwrap();
    assert_eq!(
        (written.dataset, written.cautions),
        (embedded.dataset, vec![])
    );
    for physics in ["pelican", "antx"] {
        let path = format!("real/{physics}/physics.json");
        let physics = load_dataset(&desk.path(&path)).unwrap();
        assert!(physics.cautions.is_empty(), "{:?}", physics.cautions);
        for condition in physics.dataset.conditions() {
            assert!(condition.bundle(BundleKind::Identified).is_empty());
        }
    }
    // A file that is there already is kept, and then no file is written.
    fs::remove_file(desk.path("real/antx/sweep.mat")).unwrap();
    desk.gdcm(&["example", "real", "--real"])
        .assert_failed(2, &["real/pelican/LICENSE", "--force overwrites"]);
    assert!(!desk.path("real/antx/sweep.mat").exists());
    desk.gdcm(&["example", "real", "--real", "--force"])
        .assert_done();
    assert!(desk.path("real/antx/sweep.mat").exists());
}

#[test]
fn a_reader_that_closes_the_pipe_is_no_failure() {
    let desk = Desk::new();
    let mut child = desk
        .command(&["check", "small.json"])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    drop(child.stdout.take());
    let output = child.wait_with_output().unwrap();
    assert_eq!(
        (output.status.code(), output.stderr.len()),
        (Some(0), 0),
        "{output:?}"
    );
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_behind_standard_output_is_status_1() {
    let desk = Desk::new();
    let full = fs::OpenOptions::new()
        .write(true)
        .open("/dev/full")
        .unwrap();
    let output = desk
        .command(&["check", "small.json"])
        .stdout(full)
        .output()
        .unwrap();
    Ended::from_output(&output).assert_failed(1, &["error: "]);
}

#[test]
fn help_and_version_are_status_0_on_standard_output() {
    let desk = Desk::new();
    for arguments in [
        ["--help"].as_slice(),
        &["analyze", "--help"],
        &["--version"],
    ] {
        let ended = desk.gdcm(arguments);
        ended.assert_done();
        assert!(ended.out.contains("gdcm"), "{}", ended.out);
    }
}

#[test]
fn version_and_files_state_the_same_program_with_its_commit() {
    let desk = Desk::new();
    let version = desk.gdcm(&["--version"]).out;
    let expected = format!(
        "gdcm {} ({})",
        env!("CARGO_PKG_VERSION"),
        gdcm::version::BUILT_FROM
    );
    assert_eq!(version.trim(), expected);
    assert!(gdcm::version::BUILT_FROM.starts_with("commit "));
    desk.write("data.json", |_| {});
    desk.gdcm(&["analyze", "data.json", "--out", "results"])
        .assert_done();
    let corrections = read_json(&desk.path("results/corrections.json"));
    assert_eq!(corrections["software"], expected);
    desk.gdcm(&[
        "export",
        "data.json",
        "--as",
        "table-csv",
        "--out",
        "table.csv",
    ])
    .assert_done();
    assert!(desk.read("table.csv").contains(&expected));
    desk.gdcm(&["report", "data.json", "--out", "report.html"])
        .assert_done();
    assert!(desk.read("report.html").contains(&expected));
}

#[test]
fn names_from_a_file_cannot_write_to_the_terminal_what_they_like() {
    let desk = Desk::new();
    desk.write("escape.json", |file| {
        file["conditions"][0]["name"] = json!("\u{1b}[2Jgone\nCondition 99")
    });
    let ended = desk.gdcm(&["check", "escape.json"]);
    ended.assert_done();
    assert!(
        !ended.out.contains('\u{1b}') && !ended.out.contains("\nCondition 99"),
        "{}",
        ended.out
    );
}

#[cfg(unix)]
#[test]
fn a_path_that_is_not_unicode_is_read_all_the_same() {
    use std::os::unix::ffi::OsStrExt;
    let desk = Desk::new();
    let name = OsStr::from_bytes(b"sm\xffall.json");
    fs::rename(desk.path("small.json"), desk.directory.path().join(name)).unwrap();
    let output = desk.command(&[OsStr::new("check"), name]).output().unwrap();
    assert_eq!(output.status.code(), Some(0));
}

#[test]
fn a_study_whose_dataset_has_changed_or_moved_is_used_and_told_about_unless_it_has_to_be_the_same()
{
    let desk = Desk::new();
    let study = desk.path("a.gdcm-study.json");
    let dataset = desk.path("small.json");
    let loaded = load_dataset(&dataset).unwrap();
    save_study(&Study::new(loaded.dataset.clone()), &loaded, &study).unwrap();
    desk.write("small.json", |file| {
        file["conditions"][0]["airspeed_kt"] = json!(61)
    });
    desk.messages(&["check", "a.gdcm-study.json"])
        .assert_success()
        .assert_reported("airspeed-changed", &["condition 7", "61 kt"]);
    let strict = desk.gdcm(&["check", "a.gdcm-study.json", "--strict"]);
    assert!(
        strict.status == 2 && strict.error.contains("--strict"),
        "{strict:?}"
    );
    desk.messages(&["check", "a.gdcm-study.json", "--strict"])
        .assert_code("different-dataset", &["a.gdcm-study.json", "--strict"])
        .assert_reported("airspeed-changed", &["condition 7", "61 kt"]);
    fs::rename(&dataset, desk.path("moved.json")).unwrap();
    desk.messages(&["check", "a.gdcm-study.json"])
        .assert_code("dataset-of-study", &["small.json: ", "--dataset"]);
    assert_eq!(
        desk.gdcm(&["check", "a.gdcm-study.json", "--dataset", "moved.json"])
            .status,
        0
    );
}

#[test]
fn a_figure_of_every_view_is_written() {
    let desk = Desk::new();
    for (view, rest) in [
        ("bode", ["--condition", "7"].as_slice()),
        ("error", &["--condition", "7", "--hertz"]),
        ("overview", &["--condition", "10", "--width", "single"]),
        ("net-gain", &["--pair", "all"]),
        (
            "channels",
            &["--channel", "inputs", "--over-conditions", "--delays"],
        ),
        ("evidence", &[]),
        ("assessment", &[]),
        (
            "poles",
            &["--condition", "7", "--hide", "identified,rejected"],
        ),
    ] {
        let out = format!("{view}.svg");
        let ended = desk.gdcm(
            &[
                &["figure", "small.json", "--view", view, "--out", &out][..],
                rest,
            ]
            .concat(),
        );
        ended.assert_done();
        assert!(ended.out.starts_with(&format!("{out}: ")), "{}", ended.out);
        assert!(
            fs::read_to_string(desk.path(&out))
                .unwrap()
                .starts_with("<svg"),
            "{out}"
        );
    }
}

#[test]
fn a_figure_is_written_as_its_name_says() {
    let desk = Desk::new();
    for (out, start) in [
        ("a.pdf", "%PDF"),
        ("a.PNG", "\u{fffd}PNG"),
        (
            "a.csv",
            "figure,panel,curve,label,x_quantity,x,y_quantity,y\n",
        ),
    ] {
        desk.gdcm(&["figure", "small.json", "--view", "net-gain", "--out", out])
            .assert_done();
        let bytes = fs::read(desk.path(out)).unwrap();
        assert!(
            String::from_utf8_lossy(&bytes).contains(start) && bytes.len() > 100,
            "{out}"
        );
    }
}

#[test]
fn the_numbers_of_a_figure_of_several_panels_are_one_table() {
    let desk = Desk::new();
    let figure = [
        "figure",
        "small.json",
        "--view",
        "bode",
        "--condition",
        "7",
        "--pair",
        "all",
        "--out",
        "a.csv",
    ];
    desk.gdcm(&figure).assert_done();
    let mut table = csv::Reader::from_path(desk.path("a.csv")).unwrap();
    let columns: Vec<String> = table.headers().unwrap().iter().map(str::to_owned).collect();
    assert_eq!(columns[..3], ["figure", "panel", "curve"]);
    // The CSV reader is strict: it refuses rows of unequal length.
    let rows: Vec<csv::StringRecord> = table.records().collect::<Result<_, _>>().unwrap();
    let panels: BTreeSet<&str> = rows.iter().map(|row| &row[1]).collect();
    let mut expected = BTreeSet::new();
    for pair in ["LON → P", "LAT → P", "LON → Q", "LAT → Q"] {
        for quantity in ["Magnitude [dB]", "Phase [deg]", "Coherence"] {
            expected.insert(format!("{pair}, {quantity}"));
        }
    }
    assert_eq!(
        panels,
        expected.iter().map(String::as_str).collect(),
        "magnitude, phase and coherence of four responses"
    );
    assert!(
        rows.iter().all(|row| row[5].parse::<f64>().is_ok()),
        "a frequency in every row"
    );
    assert!(rows.iter().all(|row| &row[7] != "-0.0"));
}

#[test]
fn settings_are_printed_with_six_digits() {
    let desk = Desk::new();
    let settings = [
        "--alpha",
        "0.5302786771123",
        "--band",
        "0.50000000001",
        "12",
    ];
    let ended = desk.gdcm(&[&["analyze", "small.json", "--out", "out"][..], &settings].concat());
    ended.assert_done();
    let line = ended
        .out
        .lines()
        .find(|line| line.starts_with("Band"))
        .unwrap();
    assert!(
        [" 0.5 ", " 12 rad/s", " 0.530279 "]
            .iter()
            .all(|number| line.contains(number)),
        "{line}"
    );
    let written = crate::read_json(&desk.path("out/corrections.json"));
    assert_eq!(
        written["settings"]["alpha_gain"], 0.530_278_677_112_3,
        "to the last digit in files"
    );
    desk.gdcm(&[&["report", "small.json", "--out", "r.html"][..], &settings].concat())
        .assert_done();
    let report = fs::read_to_string(desk.path("r.html")).unwrap();
    assert!(
        report.contains('α') && !report.contains("\u{391} of"),
        "a symbol has no capital"
    );
    assert!(report.contains("0.530279") && !report.contains("0.53027867"));
}

#[test]
fn a_figure_that_cannot_be_made_is_status_2_and_says_what_there_is() {
    let desk = Desk::new();
    let figure = ["figure", "small.json"];
    let cases: [(&[&str], &str, &[&str]); 6] = [
        (
            &[
                "--view",
                "poles",
                "--condition",
                "7",
                "--zeros",
                "P/LAT,Q/LON",
                "--out",
                "a.svg",
            ],
            "wrong-option",
            &["--zeros", "2"],
        ),
        (
            &["--view", "bode", "--out", "a.svg"],
            "missing-condition",
            &["--condition", "bode", "7, 10"],
        ),
        (
            &["--view", "bode", "--condition", "99", "--out", "a.svg"],
            "unknown-condition",
            &["--condition", "99", "7, 10"],
        ),
        (
            &["--view", "sky", "--out", "a.svg"],
            "wrong-command-line",
            &["--view"],
        ),
        (
            &["--view", "net-gain", "--pair", "X/Y", "--out", "a.svg"],
            "unknown-response",
            &["--pair", "X/Y"],
        ),
        (
            &["--view", "channels", "--channel", "X", "--out", "a.svg"],
            "unknown-channel",
            &["--channel", "channel X"],
        ),
    ];
    for (options, code, names) in cases {
        let line = [&figure, options].concat();
        desk.gdcm(&line).assert_failed(2, names);
        desk.messages(&line).assert_code(code, names);
    }
    desk.messages(&[&figure[..], &["--view", "net-gain", "--out", "a.jpg"]].concat())
        .assert_code(
            "figure-format",
            &["a.jpg: ", ".svg", ".png", ".pdf", ".csv"],
        );
    desk.run(&figure, &["--view", "net-gain", "--out", "small.json"])
        .assert_failed(2, &["small.json: "]);
    assert!(!desk.path("a.svg").exists());
    fs::write(desk.path("a.svg"), "mine").unwrap();
    let existing = ["--view", "net-gain", "--out", "a.svg"];
    desk.messages(&[&figure[..], &existing].concat())
        .assert_code("output-exists", &["a.svg", "--force"]);
    assert_eq!(fs::read_to_string(desk.path("a.svg")).unwrap(), "mine");
    desk.run(&figure, &[&existing[..], &["--force"]].concat())
        .assert_done();
    assert!(
        fs::read_to_string(desk.path("a.svg"))
            .unwrap()
            .starts_with("<svg")
    );
}

#[test]
fn check_finds_a_wrong_structure_without_reading_a_large_file_to_its_end() {
    let desk = Desk::new();
    let wrong = SMALL.replacen("\"inputs\": [", "\"inputs\": 5, \"more\": [", 1);
    fs::write(desk.path("large.json"), wrong).unwrap();
    let file = fs::File::options()
        .write(true)
        .open(desk.path("large.json"))
        .unwrap();
    // The file is longer than the limit; only commands that read it to its end report this.
    file.set_len(gdcm_model::dataset::limits::LARGEST_TEXT + 1)
        .unwrap();
    desk.messages(&["check", "large.json"])
        .assert_code("wrong-type", &["large.json: inputs: ", "5"]);
    desk.messages(&["analyze", "large.json", "--out", "out"])
        .assert_code("file-too-large", &["128 MiB"]);
}

#[test]
fn check_says_what_gain_cannot_be_computed_with() {
    let desk = Desk::new();
    let value = crate::synthetic::two_lags([[1e-74, 0.0], [0.0, 1.0]], [[1.0, 0.0], [0.0, 0.9]]);
    fs::write(desk.path("large.json"), value.to_string()).unwrap();
    desk.messages(&["check", "large.json"])
        .assert_success()
        .assert_reported("gain-out-of-range", &["1e74", "I0 → O0"]);
    desk.messages(&["analyze", "large.json", "--out", "out"])
        .assert_reported("gain-out-of-range", &["1e74"])
        .assert_not_reported("response-not-finite");
}

#[test]
fn check_tells_every_fault_of_a_dataset_at_once_each_with_its_place() {
    let desk = Desk::new();
    desk.write("faulty.json", |dataset| {
        dataset["frequency_band"]["min"] = json!(-1.0);
        dataset["conditions"][0]["physics_models"][0]["A"] = json!([[1.0, 2.0]]);
        dataset["conditions"][0]["identified_models"][0]["D"] =
            json!([[1.0], [2.0], [3.0], [4.0], [5.0]]);
    });
    let ended = desk.gdcm(&["check", "faulty.json"]);
    assert_eq!(ended.status, 2);
    let lines: Vec<&str> = ended.error.lines().collect();
    assert_eq!(lines.len(), 4, "{}", ended.error);
    for (line, name) in lines[1..].iter().zip(["\"nominal\"", "\"sweeps\"", "3"]) {
        assert!(line.contains(name), "{name}: {line}");
    }
    let told = desk.messages(&["check", "faulty.json"]);
    let codes: Vec<&str> = told.errors.iter().map(|error| &*error.code).collect();
    assert_eq!(
        codes,
        [
            "wrong-band",
            "matrix-shape",
            "table-shape",
            "faulty-dataset"
        ]
    );
}

#[test]
fn conditions_can_be_held_out_and_each_be_left_out_in_turn() {
    let desk = Desk::new();
    let ran = desk.gdcm(&[
        "analyze",
        "--hold-out",
        "3,8",
        "--leave-one-out",
        "--out",
        "out",
    ]);
    ran.assert_done();
    assert!(
        ran.out.contains("(3, 8)") && ran.out.contains("fitted to the others"),
        "{}",
        ran.out
    );
    let corrections = crate::read_json(&desk.path("out/corrections.json"));
    let held_out = entries(&corrections["conditions"])
        .iter()
        .filter(|of| of.get("held_out").is_some());
    assert_eq!(held_out.map(|of| &of["id"]).collect::<Vec<_>>(), [3, 8]);
    let uncertainty = &corrections["uncertainty"];
    assert_eq!(uncertainty["level"], 0.9);
    let counts = ["differences", "scatter"].map(|of| entries(&uncertainty[of]).len());
    assert_eq!(counts, [35, 5]);
    let net = &corrections["conditions"][0]["net_gains"][0];
    let [low, gain, high] = [&net["interval"][0], &net["gain"], &net["interval"][1]]
        .map(|figure| figure.as_f64().unwrap());
    assert!(low < gain && gain < high, "{net}");
    desk.gdcm(&["analyze", "--hold-out", "99", "--out", "other"])
        .assert_failed(2, &["--hold-out", "no condition 99"]);
}

/// Runs a command on a file of edge cases.
fn edge_messages(file: &str, command: &str) -> Messages {
    let path = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("tests/data/edges")
        .join(file);
    let options = if command == "analyze" {
        &["--out", "."][..]
    } else {
        &[]
    };
    Desk::new().messages(&[&[command, path.to_str().unwrap()], options].concat())
}

#[test]
fn a_model_that_cannot_be_computed_is_named_with_its_place_by_check_and_by_analyze() {
    for (file, names) in [
        (
            "large-entry.json",
            &["\"i\"", "I → O", "matrix A", "1e200", "row 1", "column 2"][..],
        ),
        (
            "overflowing-response.json",
            &["matrix B", "-1.7976931348623157e308", "row 1", "column 1"],
        ),
    ] {
        edge_messages(file, "check")
            .assert_success()
            .assert_reported("response-not-finite", names);
        edge_messages(file, "analyze").assert_status_and_code(1, "no-result", names);
    }
}

#[test]
fn seven_point_zero_is_a_whole_number() {
    edge_messages("float-id.json", "check").assert_success();
}
