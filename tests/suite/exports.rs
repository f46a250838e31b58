//! Export of corrections to other tools, by the command line.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use serde_json::{Value, json};

use gdcm_io::export::{EXPORTERS, ExportFormat};
use gdcm_io::{FolderProgress, load_dataset, read_models};
use gdcm_model::assembly::{FoundModel, Headings};
use gdcm_model::dataset::{BundleKind, ConditionId, Pair, StateSpace};
use gdcm_model::response::{FrequencyGrid, FrequencyResponse, evaluate};
use gdcm_words::schedule::DELAYS_NOT_SCHEDULED;

use crate::commands::Desk;
use crate::{entries, members};

/// Returns numbers from JSON; NaN for entries that are not numbers.
fn numbers<'j>(json: impl IntoIterator<Item = &'j Value>) -> Vec<f64> {
    json.into_iter()
        .map(|number| number.as_f64().unwrap_or(f64::NAN))
        .collect()
}

struct Silent;

impl FolderProgress for Silent {
    fn reading(&self, _: usize, _: usize, _: &str) {}
}

/// Reads the models in an exported file.
pub(crate) fn models(path: &Path) -> Vec<FoundModel> {
    let found = read_models(&[path.to_owned()], &Headings::new(), &Silent).unwrap();
    assert!(found.faults.is_empty(), "{:?}", found.faults);
    found.models
}

/// Returns the formats that contain corrections: all but the table of physics parameters.
fn exports_of_corrections() -> Vec<ExportFormat> {
    let mut formats = EXPORTERS.to_vec();
    formats.retain(|format| format.name != "physics");
    formats
}

fn state_space(model: &FoundModel) -> StateSpace {
    let [a, b, c, d] = model.draft.matrices.clone().map(Option::unwrap);
    StateSpace::new(a, b, c, d)
        .unwrap()
        .timed(model.draft.timing.clone())
        .unwrap()
}

#[test]
fn every_format_is_written_once_and_over_nothing_unasked() {
    let desk = Desk::new();
    for ExportFormat {
        name: format,
        extension,
        ..
    } in EXPORTERS
    {
        let name = format!("{}.{extension}", format.replace('-', "_"));
        let name = name.as_str();
        let arguments = ["export", "small.json", "--as", format, "--out", name];
        let ended = desk.gdcm(&arguments);
        ended.assert_done();
        assert!(ended.out.starts_with(&format!("{name}: ")), "{}", ended.out);
        let written = fs::read(desk.path(name)).unwrap();
        desk.messages(&arguments)
            .assert_code("output-exists", &[name, "--force"]);
        desk.gdcm(&[&arguments[..], &["--force"]].concat())
            .assert_done();
        assert!(
            fs::read(desk.path(name)).unwrap() == written,
            "{format}: the same every time"
        );
        desk.gdcm(&[
            "export",
            "small.json",
            "--as",
            format,
            "--out",
            "no/such/folder/x.mat",
        ]);
        assert!(!desk.path("no").exists());
    }
}

#[test]
fn several_formats_are_written_into_a_folder_together_or_not_at_all() {
    let desk = Desk::new();
    let formats = "json,assessment,m,table-csv,state-space-npz,sha256";
    let line = [
        "export",
        "small.json",
        "--as",
        formats,
        "--folder",
        "out",
        "--prefix",
        "uh60_",
        "--pade",
        "3",
    ];
    desk.gdcm(&line).assert_done();
    let names = [
        "uh60_corrections.json",
        "uh60_assessment.csv",
        "uh60_correction.m",
        "uh60_table.csv",
        "uh60_models.npz",
        "uh60_checksums.sha256",
    ];
    for name in names {
        assert!(desk.path("out").join(name).exists(), "{name}");
    }
    assert!(
        desk.read("out/uh60_correction.m")
            .contains("= uh60_correction(airspeed_kt")
    );
    assert_eq!(desk.read("out/uh60_checksums.sha256").lines().count(), 5);
    desk.gdcm(&[
        "export",
        "small.json",
        "--as",
        "json",
        "--out",
        "alone.json",
    ])
    .assert_done();
    assert_eq!(
        desk.read("out/uh60_corrections.json"),
        desk.read("alone.json")
    );

    fs::remove_file(desk.path("out/uh60_models.npz")).unwrap();
    desk.messages(&line)
        .assert_code("output-exists", &["uh60_correction.m", "--force"]);
    assert!(!desk.path("out/uh60_models.npz").exists());
    desk.gdcm(&[&line[..], &["--number"]].concat())
        .assert_done();
    assert!(
        desk.read("out/uh60_correction_2.m")
            .contains("= uh60_correction_2(airspeed_kt")
    );
    desk.gdcm(&[&line[..], &["--force"]].concat()).assert_done();
    assert!(desk.path("out/uh60_models.npz").exists());

    let wrong: [(&[&str], &str, &[&str]); 4] = [
        (
            &["json,m", "--out", "a"],
            "several-formats",
            &["--out", "--folder"],
        ),
        (&["sha256", "--folder", "b"], "no-format", &["--as"]),
        (
            &["m", "--folder", "b", "--prefix", "2"],
            "function-name",
            &["2correction.m"],
        ),
        (
            &["m", "--folder", "b", "--pade", "2"],
            "misplaced-option",
            &["--pade"],
        ),
    ];
    for (options, code, parts) in wrong {
        let line = [&["export", "small.json", "--as"], options].concat();
        desk.messages(&line).assert_code(code, parts);
    }
    assert!(!desk.path("b").exists());
}

#[test]
fn what_exported_files_omit_is_noted_with_codes() {
    let desk = desk_with_lagging_flight();
    let ended = desk.gdcm(&[
        "export",
        "lagging.json",
        "--schedule-delays",
        "never",
        "--as",
        "json,h",
        "--condition",
        "7",
        "--folder",
        "out",
        "--json",
    ]);
    ended.assert_done();
    let messages: Value = serde_json::from_str(&ended.out).unwrap();
    let codes: Vec<&str> = entries(&messages["note_codes"])
        .iter()
        .filter_map(Value::as_str)
        .collect();
    for code in ["conditions-not-chosen", "delays-not-scheduled"] {
        assert!(codes.contains(&code), "{codes:?}");
    }
    let written = crate::read_json(&desk.path("out/corrections.json"));
    assert_eq!(entries(&written["conditions"]).len(), 1);
}

#[test]
fn every_export_stands_in_the_documentation() {
    let text = fs::read_to_string(concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/docs/reference/exports.md"
    ))
    .unwrap();
    for ExportFormat { name, .. } in EXPORTERS {
        assert!(text.contains(&format!("\n| `{name}` |")), "{name}");
    }
}

#[test]
fn json_and_csv_are_those_of_analyze() {
    let desk = Desk::new();
    desk.gdcm(&["analyze", "small.json", "--out", "out"])
        .assert_done();
    for (format, name) in [("json", "corrections.json"), ("csv", "corrections.csv")] {
        desk.gdcm(&["export", "small.json", "--as", format, "--out", name])
            .assert_done();
        assert_eq!(
            fs::read(desk.path(name)).unwrap(),
            fs::read(desk.path("out").join(name)).unwrap()
        );
    }
}

#[test]
fn what_cannot_be_exported_is_status_2_before_any_work() {
    let desk = Desk::new();
    let export = ["export", "small.json", "--as"];
    let files: [(&[&str], &str, &[&str]); 4] = [
        (
            &["state-space", "--out", "a.csv"],
            "models-format",
            &["a.csv: ", ".mat", ".json", ".npz"],
        ),
        (
            &["m", "--out", "my-study.m"],
            "function-name",
            &["my-study.m: ", "\"my-study\""],
        ),
        (
            &["json", "--out", "small.json", "--force"],
            "output-is-an-input",
            &["small.json: "],
        ),
        (
            &["state-space", "--out", "a.mat", "--model", "V+5kt"],
            "unknown-model",
            &["condition 10", "\"V+5kt\""],
        ),
    ];
    for (options, code, names) in files {
        desk.messages(&[&export, options].concat())
            .assert_code(code, names);
    }
    let options: [(&[&str], &str, &[&str]); 7] = [
        (
            &["xls", "--out", "a"],
            "wrong-command-line",
            &["--as", "table-csv"],
        ),
        (
            &["m", "--out", "a.m", "--pade", "2"],
            "misplaced-option",
            &["--pade: ", "--as state-space"],
        ),
        (
            &["h", "--out", "a.h", "--breakpoints", "1,2"],
            "misplaced-option",
            &["--breakpoints: ", "table-csv"],
        ),
        (
            &["table-csv", "--out", "a.csv", "--breakpoints", "60,40"],
            "wrong-command-line",
            &["--breakpoints", "60,40"],
        ),
        (
            &["state-space", "--out", "a.mat", "--pade", "9"],
            "wrong-command-line",
            &["--pade: ", "from 1 to 8"],
        ),
        (
            &["state-space", "--out", "a.mat", "--condition", "8"],
            "unknown-condition",
            &["--condition: ", "condition 8", "7, 10"],
        ),
        (
            &["state-space", "--out", "a.mat", "--correction", "none"],
            "wrong-command-line",
            &["--correction"],
        ),
    ];
    for (options, code, names) in options {
        let line = [&export, options].concat();
        desk.gdcm(&line).assert_failed(2, names);
        desk.messages(&line).assert_code(code, names);
    }
    assert_eq!(
        fs::read_dir(desk.directory.path()).unwrap().count(),
        1,
        "nothing was written"
    );
    desk.gdcm(&[
        "export",
        "small.json",
        "--as",
        "state-space",
        "--out",
        "a.mat",
        "--model",
        "V+5kt",
        "--condition",
        "7",
    ])
    .assert_done();
}

#[test]
fn the_options_of_a_study_come_first() {
    let desk = Desk::new();
    let more = [
        "--degree",
        "0",
        "--schedule-delays",
        "--as",
        "py",
        "--out",
        "a.py",
    ];
    let ended = desk.gdcm(&[&["export", "small.json"][..], &more].concat());
    ended.assert_done();
    let text = fs::read_to_string(desk.path("a.py")).unwrap();
    assert!(!text.contains(DELAYS_NOT_SCHEDULED) && !ended.out.contains(DELAYS_NOT_SCHEDULED));
    // In this dataset, constrained responses have net delays: they are scheduled by default, and
    // omitted on request.
    let unasked = desk.gdcm(&["export", "small.json", "--as", "py", "--out", "b.py"]);
    unasked.assert_done();
    let text = fs::read_to_string(desk.path("b.py")).unwrap();
    for said in [&unasked.out, &text] {
        assert!(
            said.contains("ontains: gains scheduled, delays scheduled, leads none, couplings none")
                && !said.contains(DELAYS_NOT_SCHEDULED),
            "{said}"
        );
    }
    let more = ["--schedule-delays", "never", "--as", "py", "--out", "c.py"];
    let never = desk.gdcm(&[&["export", "small.json"][..], &more].concat());
    never.assert_done();
    let text = fs::read_to_string(desk.path("c.py")).unwrap();
    assert!(
        text.contains(&format!("# Note: {DELAYS_NOT_SCHEDULED}")),
        "{text}"
    );
    for said in [&never.out, &text] {
        assert!(
            said.contains("ontains: gains scheduled, delays none, leads none, couplings none")
                && said
                    .lines()
                    .any(|line| line.contains("eft out: ") && line.contains(" LAT"))
                && said.contains(DELAYS_NOT_SCHEDULED),
            "{said}"
        );
    }
}

/// Input delays \[s\] by condition. The flown model is the nominal physics model behind these
/// delays.
const FLOWN_DELAYS_S: [[f64; 2]; 2] = [[0.03, 0.05], [0.04, 0.03]];

fn desk_with_lagging_flight() -> Desk {
    let desk = Desk::new();
    desk.write("lagging.json", |file| {
        for (condition, delays_s) in FLOWN_DELAYS_S.into_iter().enumerate() {
            let condition = &mut file["conditions"][condition];
            let nominal = condition["physics_models"][0].clone();
            let mut flown = json!({"name": "flown", "input_delays_s": delays_s});
            for matrix in ["A", "B", "C", "D"] {
                flown[matrix] = nominal[matrix].clone();
            }
            condition["identified_models"] = json!([flown]);
        }
    });
    desk
}

#[test]
fn delays_of_held_responses_are_exported_unless_that_is_not_wanted() {
    let desk = desk_with_lagging_flight();
    let export = |more: &[&str]| {
        let line = [
            &[
                "export",
                "lagging.json",
                "--as",
                "state-space",
                "--out",
                "m.json",
                "--force",
                "--pade",
                "8",
            ],
            more,
        ];
        let ended = desk.gdcm(&line.concat());
        ended.assert_done();
        let text = crate::read_json(&desk.path("m.json"));
        let contains = entries(&text["models"])
            .iter()
            .map(|model| model["contains"].clone())
            .collect::<Vec<_>>();
        (ended.out, contains, models(&desk.path("m.json")))
    };
    let dataset = load_dataset(&desk.path("lagging.json")).unwrap().dataset;
    let omega = [0.5, 3.0, 12.0];
    for more in [
        &[][..],
        &["--schedule-delays"],
        &["--schedule-delays", "automatic"],
        &["--schedule-delays=always"],
    ] {
        let (out, contains, found) = export(more);
        assert!(!out.contains("left out: "), "{out}");
        for (place, condition) in dataset.conditions().iter().enumerate() {
            assert_eq!(contains[place]["gains"], "scheduled");
            assert_eq!(contains[place]["delays"], "scheduled");
            assert_eq!(contains[place]["leads"], "none");
            assert_eq!(contains[place]["couplings"], "none");
            assert_eq!(contains[place]["left_out"], json!([]));
            let flown = &condition.bundle(gdcm_model::dataset::BundleKind::Identified)[0];
            // The delays must be included; `evaluate` omits them.
            let flown = FrequencyResponse::from_dynamics(
                &flown.dynamics,
                &FrequencyGrid::at(omega.to_vec()),
            );
            let found = evaluate(&state_space(&found[place]), &omega);
            for pair in [Pair::new(0, 1), Pair::new(1, 0)] {
                for (found, flown) in found.curve(pair).iter().zip(flown.curve(pair)) {
                    // Through two airspeeds, the scheduled straight line is exact.
                    assert!(
                        (found - flown).norm() <= 1e-6 * flown.norm(),
                        "{pair:?} of condition {}",
                        condition.id()
                    );
                }
            }
        }
    }
    let (out, contains, _) = export(&["--schedule-delays", "never"]);
    // 50 ms at 12 rad/s are 34.4 degrees.
    assert!(
        out.contains(" 34.377 deg") && out.contains(" 12 rad/s"),
        "{out}"
    );
    for contains in &contains {
        assert_eq!(
            (&contains["gains"], &contains["delays"]),
            (&json!("scheduled"), &json!("none"))
        );
        assert!(!entries(&contains["left_out"]).is_empty(), "{contains}");
    }
    let (out, contains, _) = export(&["--schedule-delays", "never", "--correction", "own"]);
    assert!(!out.contains("left out: "), "{out}");
    for contains in &contains {
        assert_eq!(
            (&contains["gains"], &contains["delays"]),
            (&json!("own"), &json!("own"))
        );
        assert_eq!(contains["left_out"], json!([]));
    }
}

#[test]
fn every_export_states_what_it_contains() {
    let desk = desk_with_lagging_flight();
    for ExportFormat {
        name: format,
        extension,
        ..
    } in exports_of_corrections()
    {
        let name = format!("{}.{extension}", format.replace('-', "_"));
        let ended = desk.gdcm(&[
            "export",
            "lagging.json",
            "--schedule-delays",
            "never",
            "--as",
            format,
            "--out",
            &name,
        ]);
        ended.assert_done();
        let delays = if ["mat", "csv", "json", "assessment"].contains(&format) {
            "delays own"
        } else {
            "delays none"
        };
        let line = ended
            .out
            .lines()
            .find(|line| line.starts_with("contains: gains "))
            .unwrap();
        assert!(line.contains(delays), "{format}: {line}");
        assert!(
            ended.out.contains("\nleft out: "),
            "{format}: {}",
            ended.out
        );
    }
    let heading = "Contains: gains scheduled, delays none, leads none, couplings none.";
    for name in ["m.m", "py.py", "h.h", "table_csv.csv"] {
        assert!(
            desk.read(name).contains(heading) && desk.read(name).contains("Left out: "),
            "{name}"
        );
    }
    assert!(
        desk.read("h.h")
            .contains("#define GDCM_CONTAINS_DELAYS \"none\"\n")
    );
    let table = desk.read("csv.csv");
    let heading = table.lines().next().unwrap();
    assert!(heading.ends_with(",contains"), "{heading}");
    assert!(
        table.contains(
            "gains own and scheduled, delays own, leads none, couplings none; left out: "
        ),
        "{table}"
    );
    let corrections = crate::read_json(&desk.path("json.json"));
    let contains = &corrections["contains"];
    assert_eq!(
        (&contains["gains"], &contains["delays"]),
        (&json!("own and scheduled"), &json!("own"))
    );
    assert_eq!(entries(&contains["left_out"]).len(), 2, "{contains}");
    let print = "import py; print(py.CONTAINS['gains'], py.CONTAINS['delays'], len(py.CONTAINS['left_out']))";
    if let Ok(output) = Command::new("python3")
        .args(["-c", print])
        .current_dir(&desk.directory)
        .output()
    {
        assert_eq!(
            String::from_utf8(output.stdout).unwrap(),
            "scheduled none 2\n"
        );
    }
}

#[test]
fn a_schedule_that_loses_what_a_condition_gains_is_cautioned_of() {
    let desk = desk_with_lagging_flight();
    let notes = |scheduling: &str| {
        let ended = desk.gdcm(&[
            "analyze",
            "lagging.json",
            "--schedule-delays",
            scheduling,
            "--out",
            "out",
            "--force",
        ]);
        ended.assert_done();
        let corrections = crate::read_json(&desk.path("out/corrections.json"));
        let notes = corrections["schedule"]["caution_notes"]
            .as_array()
            .cloned()
            .unwrap_or_default();
        (
            ended.out,
            notes
                .into_iter()
                .filter(|note| note["code"] == "scheduled-cost-doubled")
                .collect::<Vec<_>>(),
        )
    };
    assert_eq!(notes("automatic").1, Vec::<Value>::new());
    let (out, notes) = notes("never");
    assert_eq!(
        notes
            .iter()
            .map(|note| note["condition"].clone())
            .collect::<Vec<_>>(),
        [7, 10]
    );
    for note in &notes {
        let [scheduled, own] = ["value", "own"].map(|key| note[key].as_f64().unwrap());
        assert!(scheduled > 1.0 && scheduled > 2.0 * own, "{note}");
    }
    assert!(out.contains("left out"), "{out}");
    let line = [
        "analyze",
        "lagging.json",
        "--schedule-delays=never",
        "--out",
        "out",
        "--force",
        "--json",
    ];
    let said: Value = serde_json::from_str(&desk.gdcm(&line).out).unwrap();
    let doubled = entries(&said["cautions"])
        .iter()
        .filter(|caution| caution["code"] == "scheduled-cost-doubled");
    assert_eq!(
        doubled
            .map(|caution| caution["conditions"].clone())
            .collect::<Vec<_>>(),
        [json!([7]), json!([10])]
    );
}

#[test]
fn the_example_has_gains_alone_and_the_delay_that_it_leaves_out_is_named() {
    let desk = Desk::new();
    let ended = desk.gdcm(&["export", "--as", "py", "--out", "a.py"]);
    ended.assert_done();
    let left_out: Vec<&str> = ended
        .out
        .lines()
        .filter(|line| line.starts_with("left out: "))
        .collect();
    assert_eq!(left_out.len(), 1, "{left_out:?}");
    assert!(left_out[0].contains("output NX: ") && left_out[0].contains("condition 4 "));
}

#[test]
fn a_table_says_how_far_it_is_off() {
    let desk = Desk::new();
    let table = [
        "export",
        "--as",
        "table-csv",
        "--out",
        "t.csv",
        "--breakpoints",
        "40,90,150",
    ];
    let ended = desk.gdcm(&table);
    ended.assert_done();
    assert!(ended.out.contains("input LON: "), "{}", ended.out);
    let text = fs::read_to_string(desk.path("t.csv")).unwrap();
    let rows: Vec<&str> = text.lines().filter(|line| !line.starts_with('#')).collect();
    assert_eq!(rows.len(), 4);
    assert!(
        rows[1].starts_with("4.0") && rows[3].starts_with("1.5"),
        "{text}"
    );
    desk.gdcm(&["export", "--as", "table-csv", "--out", "own.csv"])
        .assert_done();
    let own = fs::read_to_string(desk.path("own.csv")).unwrap();
    assert_eq!(
        own.lines().filter(|line| !line.starts_with('#')).count(),
        1 + 5,
        "45, 60, 90, 120 and 140 kt"
    );
}

/// The corrected models of the example, each with its own correction, are equal in three formats.
#[test]
fn corrected_models_are_the_program_s_in_every_format() {
    let desk = Desk::new();
    let models_of = |name: &str| {
        let options = [
            "--correction",
            "own",
            "--model",
            "representative",
            "--pade",
            "8",
        ];
        let ended = desk.gdcm(
            &[
                &["export", "--as", "state-space", "--out", name][..],
                &options,
            ]
            .concat(),
        );
        ended.assert_done();
        assert!(ended.out.contains("order 8, "), "{}", ended.out);
        ended
            .out
            .lines()
            .skip(1)
            .map(str::to_owned)
            .collect::<Vec<_>>()
    };
    let lines = models_of("m.json");
    assert_eq!(models_of("m.mat"), lines);
    assert_eq!(models_of("m.npz"), lines);
    let found = models(&desk.path("m.json"));
    assert_eq!(found.len(), 11);
    let names: Vec<_> = found[0]
        .outputs
        .iter()
        .map(|label| label.name.clone().unwrap())
        .collect();
    assert_eq!(names, ["P", "Q", "R", "NX", "NY", "NZ"]);
    let of_matlab = models(&desk.path("m.mat"));
    for (json, mat) in found.iter().zip(&of_matlab) {
        assert_eq!(json.draft.matrices, mat.draft.matrices);
        assert_eq!(
            (&json.inputs, &json.outputs, &json.draft.states),
            (&mat.inputs, &mat.outputs, &mat.draft.states)
        );
    }
    // Compare with the physics models and the corrections written by `analyze`.
    desk.gdcm(&["analyze", "--out", "."]).assert_done();
    let corrections = crate::read_json(&desk.path("corrections.json"));
    let omega = [0.5, 3.0, 12.0];
    let mut delayed = 0;
    for (model, result) in found.iter().zip(entries(&corrections["conditions"])) {
        let condition = crate::EXAMPLE
            .dataset
            .conditions()
            .iter()
            .find(|of| result["id"] == of.id().0)
            .unwrap();
        let representative = result["physics_representative"].as_str().unwrap();
        let physics = condition
            .model(gdcm_model::dataset::BundleKind::Physics, representative)
            .unwrap();
        let gdcm_model::dataset::Dynamics::StateSpace(plain) = &physics.dynamics else {
            panic!("no matrices")
        };
        let corrected = evaluate(&state_space(model), &omega);
        let plain = evaluate(plain, &omega);
        for (output, output_gain) in member_numbers(&result["gains"]["outputs"])
            .into_iter()
            .enumerate()
        {
            for (input, input_gain) in member_numbers(&result["gains"]["inputs"])
                .into_iter()
                .enumerate()
            {
                let delay = member_numbers(&result["delays_s"]["outputs"])[output]
                    + member_numbers(&result["delays_s"]["inputs"])[input];
                delayed += usize::from(delay > 0.0);
                let corrected = corrected.curve(Pair { output, input });
                let plain = plain.curve(Pair { output, input });
                for (at, omega) in omega.into_iter().enumerate() {
                    let factor = nalgebra::Complex::new(0.0, -omega * delay).exp()
                        * output_gain
                        * input_gain;
                    let expected = plain[at] * factor;
                    // The error of the Padé approximation of order 8 is below rounding for these
                    // delays.
                    assert!(
                        (corrected[at] - expected).norm() <= 1e-9 * expected.norm(),
                        "condition {}",
                        result["id"]
                    );
                }
            }
        }
    }
    assert!(delayed > 0, "some responses are delayed");
}

/// Returns the value of a second-order lead filter at s: ratio of Butterworth polynomials at its
/// zero and at its lag (M15).
fn lead_filter(lead: &Value, s: nalgebra::Complex<f64>) -> nalgebra::Complex<f64> {
    butterworth(&lead["zero_rad_s"], s) / butterworth(&lead["lag_rad_s"], s)
}

/// Computes `1 + sqrt(2) x + x^2` with `x = s / omega`.
fn butterworth(omega: &Value, s: nalgebra::Complex<f64>) -> nalgebra::Complex<f64> {
    let x = s / omega.as_f64().unwrap();
    x * x + x * 2.0_f64.sqrt() + 1.0
}

/// A corrected model with leads equals the model between its channel filters; programs contain the
/// filters themselves.
#[test]
fn leads_are_exact_in_corrected_models_and_in_programs() {
    let desk = Desk::with_few();
    let export = |format: &str, name: &str| {
        let options = ["--phase", "lead", "--as", format, "--out", name];
        let ended = desk.gdcm(&[&["export", "few.json"][..], &options].concat());
        ended.assert_done();
        ended.out
    };
    export("state-space", "m.json");
    for model in entries(&crate::read_json(&desk.path("m.json"))["models"]) {
        assert_eq!(model["contains"]["leads"], "scheduled");
    }
    let found = models(&desk.path("m.json"));
    assert_eq!(found[0].draft.states[..2], ["LON lead 1", "LON lead 2"]);
    desk.gdcm(&["analyze", "few.json", "--phase", "lead", "--out", "."])
        .assert_done();
    let corrections = crate::read_json(&desk.path("corrections.json"));
    let at = entries(&corrections["schedule"]["table"])
        .iter()
        .find(|row| row["airspeed_kt"] == 45.0)
        .unwrap();
    let physics = &crate::FEW.dataset.conditions()[0];
    let nominal = &physics.bundle(gdcm_model::dataset::BundleKind::Physics)[physics.nominal()];
    let gdcm_model::dataset::Dynamics::StateSpace(plain) = &nominal.dynamics else {
        panic!("no matrices")
    };
    let omega = [0.5, 3.0, 12.0, 120.0];
    let corrected = evaluate(&state_space(&found[0]), &omega);
    let plain = evaluate(plain, &omega);
    let [input_leads, output_leads] = ["inputs", "outputs"].map(|side| members(&at["lead"][side]));
    for (output, output_gain) in numbers(members(&at["outputs"])).into_iter().enumerate() {
        for (input, input_gain) in numbers(members(&at["inputs"])).into_iter().enumerate() {
            let pair = Pair { output, input };
            for (place, omega) in omega.into_iter().enumerate() {
                let s = nalgebra::Complex::new(0.0, omega);
                let filters =
                    lead_filter(output_leads[output], s) * lead_filter(input_leads[input], s);
                let expected = plain.curve(pair)[place] * filters * output_gain * input_gain;
                // Responses have a rounding error relative to the largest response, about 1; far
                // above the band most responses are about 1e-6.
                let allowed = 1e-9 * expected.norm() + 1e-11;
                assert!(
                    (corrected.curve(pair)[place] - expected).norm() <= allowed,
                    "{pair:?} at {omega} rad/s"
                );
            }
        }
    }
    for (format, name, parts) in [
        (
            "m",
            "c.m",
            [
                "[Mi, Mo, tau_i, tau_o, lead_i, lead_o]",
                "tf([a^2 sqrt(2)*a 1], [b^2 sqrt(2)*b 1])",
            ],
        ),
        (
            "py",
            "c.py",
            [
                "def gdcm_leads(airspeed_kt):",
                "def gdcm_lead_state_space(zero_s):",
            ],
        ),
        (
            "h",
            "c.h",
            [
                "#define GDCM_LEAD_ORDER 2",
                "static inline double gdcm_lead_step(",
            ],
        ),
        (
            "table-csv",
            "t.csv",
            ["lead numerator of input LAT", "# Lead: each input"],
        ),
    ] {
        export(format, name);
        let text = fs::read_to_string(desk.path(name)).unwrap();
        assert!(
            parts.iter().all(|part| text.contains(part)),
            "{name}: {text}"
        );
    }
    let zero_s: f64 = 1.0 / at["lead"]["inputs"]["LAT"]["zero_rad_s"].as_f64().unwrap();
    let program = "import c\nzi, zo = c.gdcm_leads(45.0)\nA, B, C, D = c.gdcm_lead_state_space(zi[1])\n\
                   print(repr(zi[1]), repr(D[0][0]), len(zo), len(A))";
    if let Ok(output) = Command::new("python3")
        .args(["-c", program])
        .current_dir(&desk.directory)
        .output()
    {
        let text = String::from_utf8(output.stdout).unwrap();
        let numbers: Vec<f64> = text
            .split_whitespace()
            .map(|word| word.parse().unwrap())
            .collect();
        let r = (36.0 * zero_s).powi(2);
        assert!(
            (numbers[0] - zero_s).abs() < 1e-15 && (numbers[1] / r - 1.0).abs() < 1e-12,
            "{text}"
        );
        assert_eq!(numbers[2..], [6.0, 2.0]);
    }
}

/// Compares the filter of the C header, executed step by step, with the analytical gain: 1 at rest,
/// and the response to a sine within the band.
#[test]
fn the_filter_of_the_c_header_leads_a_sine() {
    let desk = Desk::new();
    desk.gdcm(&["export", "--phase", "lead", "--as", "h", "--out", "c.h"])
        .assert_done();
    let program = "#include \"c.h\"\n#include <stdio.h>\nint main(void) { double zi[4], zo[6], c = 0, s = 0; long k;\n\
        struct gdcm_lead f = {0.0, 0.0}; const double h = 0.001, w = 6.283185307179586;\n\
        if (gdcm_leads(120.0, zi, zo) != 0) return 1;\n\
        for (k = 0; k < 4000; k++) { double y = gdcm_lead_step(&f, zi[1], h, sin(w * k * h));\n\
        if (k >= 2000) { s += y * sin(w * k * h) * 0.001; c += y * cos(w * k * h) * 0.001; } }\n\
        printf(\"%.12g %.12g %.12g\", zi[1], s, c); return 0; }\n";
    fs::write(desk.path("main.c"), program).unwrap();
    let flags = [
        "-std=c99",
        "-Wall",
        "-Wextra",
        "-Wshadow",
        "-Werror",
        "-pedantic",
        "-o",
        "main",
        "main.c",
        "-lm",
    ];
    let Ok(built) = Command::new("cc")
        .args(flags)
        .current_dir(&desk.directory)
        .output()
    else {
        eprintln!("SKIPPED: cc is not installed");
        return;
    };
    assert!(
        built.status.success(),
        "{}",
        String::from_utf8_lossy(&built.stderr)
    );
    let output = Command::new(desk.path("main")).output().unwrap();
    let text = String::from_utf8(output.stdout).unwrap();
    let [zero_s, s, c] = [0, 1, 2].map(|at| {
        text.split_whitespace()
            .nth(at)
            .unwrap()
            .parse::<f64>()
            .unwrap()
    });
    let filter = gdcm_model::response::LeadFilter::new(
        gdcm_model::response::LeadOrder::Second,
        2.0_f64.sqrt() * (zero_s - 1.0 / 36.0),
        1.0 / 36.0,
    );
    let expected = filter.at(std::f64::consts::TAU);
    // Tustin's rule shifts the frequency of 6.2832 rad/s by the factor 1 + (w h)^2 / 12, that is by
    // 3e-6.
    assert!(
        (s - expected.re).abs() < 1e-4 && (c - expected.im).abs() < 1e-4,
        "{text} {expected}"
    );
}

#[test]
fn delays_of_discrete_time_are_exact_or_refused() {
    let desk = Desk::new();
    desk.write("sampled.json", |file| {
        for condition in [0, 1] {
            let nominal = &mut file["conditions"][condition]["physics_models"][0];
            nominal["A"] = json!([[0.99, 0.01], [-0.02, 0.98]]);
            nominal["sample_time_s"] = json!(0.01);
            nominal["input_delays_s"] = json!([0.03, 0]);
        }
    });
    let export = |name: &str| {
        desk.gdcm(&[
            "export",
            "sampled.json",
            "--as",
            "state-space",
            "--out",
            name,
        ])
    };
    let ended = export("m.json");
    ended.assert_done();
    // Conditions 7 and 10. The correction has no delays, and those of the models are exact.
    let described: Vec<&str> = ended
        .out
        .lines()
        .filter(|line| line.contains(" nominal, scheduled "))
        .collect();
    assert_eq!(described.len(), 2, "{}", ended.out);
    assert!(
        described.iter().all(|line| !line.contains(" deg ")) && ended.out.contains("delays none,"),
        "{}",
        ended.out
    );
    let found = models(&desk.path("m.json"));
    assert_eq!(found[0].draft.timing.sample_time_s, Some(0.01));
    assert_eq!(
        found[0].draft.states,
        ["LON delay 1", "LON delay 2", "LON delay 3", "w", "q"]
    );
    desk.write("part.json", |file| {
        let nominal = &mut file["conditions"][0]["physics_models"][0];
        nominal["A"] = json!([[0.99, 0.01], [-0.02, 0.98]]);
        nominal["sample_time_s"] = json!(0.01);
        nominal["input_delays_s"] = json!([0.034, 0]);
    });
    let names = [
        "m.npz: ",
        "condition 7",
        "\"nominal\"",
        "LON",
        "0.034 s",
        "3.4 samples",
    ];
    desk.messages(&[
        "export",
        "part.json",
        "--as",
        "state-space",
        "--out",
        "m.npz",
    ])
    .assert_code("corrected-model", &names);
    assert!(!desk.path("m.npz").exists());
}

pub(crate) fn octave(desk: &Desk, program: &str) -> Option<Vec<f64>> {
    let Ok(output) = Command::new("octave-cli")
        .args(["--eval", program])
        .current_dir(&desk.directory)
        .output()
    else {
        eprintln!("SKIPPED: octave-cli is not installed, files for MATLAB are not read by it");
        return None;
    };
    assert!(
        output.status.success(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    let text = String::from_utf8(output.stdout).unwrap();
    Some(
        text.split_whitespace()
            .map(|word| word.parse().unwrap())
            .collect(),
    )
}

#[test]
fn octave_reads_the_corrections_as_analyze_writes_them() {
    let desk = Desk::with_few();
    desk.gdcm(&["analyze", "few.json", "--out", ".", "--schedule-delays"])
        .assert_done();
    let corrections = crate::read_json(&desk.path("corrections.json"));
    desk.gdcm(&[
        "export",
        "few.json",
        "--as",
        "mat",
        "--out",
        "c.mat",
        "--schedule-delays",
    ])
    .assert_done();
    let program = "load c.mat; for c = corrections.conditions, \
                   printf('%.17g ', c.id, c.G', c.D_s', c.gains.inputs, c.delays_s.outputs, c.J.corrected.mag', c.net_gains'); end; \
                   s = corrections.schedule; printf('%.17g ', s.inputs', s.delays_s.upper_s, s.table.outputs'); \
                   assert(strcmp(corrections.inputs{2}, 'LAT') && islogical(corrections.settings.constrained)); \
                   assert(c.net_gain_table.gain(2, 1) == c.net_gains(2, 1) && rows(c.bars.G.interval) == 6);";
    let Some(found) = octave(&desk, program) else {
        return;
    };
    let mut expected = Vec::new();
    for of in entries(&corrections["conditions"]) {
        expected.push(of["id"].as_f64().unwrap());
        expected.extend([table_numbers(&of["G"]), table_numbers(&of["D_s"])].concat());
        expected.extend(
            [
                member_numbers(&of["gains"]["inputs"]),
                member_numbers(&of["delays_s"]["outputs"]),
            ]
            .concat(),
        );
        expected.extend(table_numbers(&of["J"]["corrected"]["mag"]));
        expected.extend(numbers(
            entries(&of["net_gains"]).iter().map(|net| &net["gain"]),
        ));
    }
    let schedule = &corrections["schedule"];
    expected.extend(numbers(
        members(&schedule["inputs"]).into_iter().flat_map(entries),
    ));
    expected.extend(numbers(entries(&schedule["delays_s"]["upper_s"])));
    expected.extend(
        entries(&schedule["table"])
            .iter()
            .flat_map(|row| member_numbers(&row["outputs"])),
    );
    assert_eq!(found.len(), expected.len());
    assert!(
        found
            .iter()
            .zip(&expected)
            .all(|(a, b)| a == b || (a.is_nan() && b.is_nan())),
        "to the last digit"
    );
}

/// Returns the blocks of a page in a language, in their order.
fn blocks(page: &str, language: &str) -> Vec<String> {
    let start = format!("```{language}\n");
    page.split(&start)
        .skip(1)
        .filter_map(|rest| rest.split("```").next())
        .map(str::to_owned)
        .collect()
}

#[test]
fn the_blocks_of_the_page_for_matlab_run_in_octave_and_give_the_numbers_of_the_files() {
    let desk = Desk::with_few();
    let mut dataset = crate::read_json(&desk.path("few.json"));
    // The aircraft answers later, so that the page's code for delays has something to do.
    for condition in dataset["conditions"].as_array_mut().unwrap() {
        for model in condition["identified_models"].as_array_mut().unwrap() {
            model["input_delays_s"] = json!([0.25, 0.25, 0.25, 0.25]);
        }
    }
    let text = serde_json::to_vec(&dataset).unwrap();
    fs::write(desk.path("my-dataset.json"), text).unwrap();
    let page = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/how-to/matlab.md");
    let page = fs::read_to_string(page).unwrap();
    let mut commands = 0;
    for line in blocks(&page, "sh").concat().lines() {
        let mut words: Vec<&str> = line.split_whitespace().collect();
        assert_eq!(words.remove(0), "gdcm", "{line}");
        words.extend(["--phase", "delay"]);
        let ended = desk.gdcm(&words);
        assert_eq!(ended.status, 0, "{ended:?}");
        commands += 1;
    }
    assert_eq!(commands, 4);
    let mut program = String::from("page_of_the_program = 1;\n");
    program += &blocks(&page, "matlab").join("\n");
    program += "file = fopen('numbers.txt', 'w');\n\
        fprintf(file, '%.17g ', gain_in, gain_out, delay_in, delay_out, gain, Mi(1, 1), gain_in(1));\n\
        fprintf(file, '%.17g ', same.gains.inputs);\n\
        last = corrected(2, 1, end);\n\
        fprintf(file, '%.17g ', real(last), imag(last));\n\
        first = corrected(:, :, 1);\n\
        fprintf(file, '%.17g ', max(max(abs(response - first) ./ abs(first))));\n\
        fclose(file);\n";
    fs::write(desk.path("page.m"), &program).unwrap();
    let Some(_) = octave(&desk, "evalc('page');") else {
        return;
    };
    let found: Vec<f64> = desk
        .read("numbers.txt")
        .split_whitespace()
        .map(|word| word.parse().unwrap())
        .collect();

    let corrections = crate::read_json(&desk.path("results/corrections.json"));
    let condition = entries(&corrections["conditions"])
        .iter()
        .find(|condition| condition["id"] == 10)
        .unwrap();
    let gains = &condition["gains"];
    let delays = &condition["delays_s"];
    let [gain_in, gain_out] = ["inputs", "outputs"].map(|side| member_numbers(&gains[side]));
    let [delay_in, delay_out] = ["inputs", "outputs"].map(|side| member_numbers(&delays[side]));
    let own = [&gain_in[..], &gain_out, &delay_in, &delay_out].concat();
    assert!(own.len() == 20 && delay_in.iter().chain(&delay_out).any(|delay| *delay > 0.0));
    assert_eq!(found[..20], own);
    // The schedule by its coefficients is that of the function.
    assert!((found[20] / found[21] - 1.0).abs() < 1e-12, "{found:?}");
    assert_eq!(found[23..27], gain_in);
    // The corrected response LON -> Q at the upper end of the band.
    let dataset = load_dataset(&desk.path("my-dataset.json")).unwrap().dataset;
    let name = condition["physics_representative"].as_str().unwrap();
    let model = dataset
        .condition(ConditionId(10))
        .unwrap()
        .model(BundleKind::Physics, name)
        .unwrap();
    let pair = Pair::new(1, 0);
    let omega = 12.0;
    let response = evaluate(model.state_space().unwrap(), &[omega]).curve(pair)[0];
    let factor = gain_out[1] * gain_in[0];
    let delay_s = delay_out[1] + delay_in[0];
    let expected = response * nalgebra::Complex::new(0.0, -omega * delay_s).exp() * factor;
    let last = nalgebra::Complex::new(found[27], found[28]);
    assert!(
        (last - expected).norm() < 1e-9 * expected.norm(),
        "{last} {expected}"
    );
    // A Pade approximant of order 2 is nearly exact at 0.5 rad/s.
    assert!(found[29] < 1e-6, "{}", found[29]);
}

#[test]
fn octave_computes_the_response_of_a_corrected_model() {
    let desk = Desk::with_few();
    let path: PathBuf = desk.path("m.json");
    for name in ["m.mat", "m.json"] {
        desk.gdcm(&[
            "export",
            "few.json",
            "--as",
            "state-space",
            "--correction",
            "own",
            "--out",
            name,
        ])
        .assert_done();
    }
    let program = "load m.mat; for m = models, H = m.C * ((3i * eye(size(m.A)) - m.A) \\ m.B) + m.D; \
                   printf('%.17g ', m.condition, m.Ts, abs(H)'); \
                   assert(numel(m.StateName) == rows(m.A) && strcmp(m.OutputUnit{1}, 'deg/s')); end";
    let Some(found) = octave(&desk, program) else {
        return;
    };
    let mut expected = Vec::new();
    for (place, model) in models(&path).iter().enumerate() {
        expected.extend([crate::FEW.dataset.conditions()[place].id().0 as f64, 0.0]);
        let response = evaluate(&state_space(model), &[3.0]);
        let pairs = (0..6).flat_map(|output| (0..4).map(move |input| Pair { output, input }));
        expected.extend(pairs.map(|pair| response.curve(pair)[0].norm()));
    }
    assert_eq!(found.len(), expected.len());
    assert!(
        found
            .iter()
            .zip(&expected)
            .all(|(a, b)| (a - b).abs() <= 1e-9 * b.abs())
    );
}

#[test]
fn every_export_of_leads_says_what_they_cost_and_so_does_the_command() {
    let desk = Desk::with_few();
    // In the example, condition 10 has the strongest lead, on LON: as if a servo of 36 rad/s
    // replaced a servo of 18 rad/s.
    let has_limit = |line: &str| line.contains(" 12 rad/s") && line.contains(" 120 rad/s");
    for ExportFormat {
        name: format,
        extension,
        ..
    } in exports_of_corrections()
    {
        let name = if format == "state-space" {
            "state_space.json"
        } else {
            &format!("{}.{extension}", format.replace('-', "_"))
        };
        let ended = desk.gdcm(&[
            "export", "few.json", "--phase", "lead", "--as", format, "--out", name,
        ]);
        assert_eq!((ended.status, ended.error.as_str()), (0, ""), "{format}");
        assert!(
            ended.out.lines().any(|line| {
                has_limit(line) && line.contains(" +") && line.contains(" dB on LON")
            }),
            "{format}: {}",
            ended.out
        );
        let bytes = fs::read(desk.path(name)).unwrap();
        let text = String::from_utf8_lossy(&bytes);
        let is_said = text.lines().any(has_limit) || text.contains("not_valid_above_rad_s");
        assert!(is_said || extension == "mat", "{format}");
        // Exports spell unusual characters by their code, such as `<U+2212>`; the program's own
        // texts must not need this.
        assert!(!text.contains("<U+2212>"), "{format}");
    }
    let without = desk.gdcm(&["export", "few.json", "--as", "py", "--out", "delays.py"]);
    assert_eq!((without.status, without.error.as_str()), (0, ""));
    assert!(
        without.out.contains(", leads none,") && without.out.matches("lead").count() == 1,
        "{}",
        without.out
    );
}

/// Returns the numbers of a JSON table, row by row.
fn table_numbers(table: &Value) -> Vec<f64> {
    numbers(entries(table).iter().flat_map(entries))
}

/// Returns the numbers of a JSON object, in the order of its members.
fn member_numbers(object: &Value) -> Vec<f64> {
    numbers(members(object))
}
