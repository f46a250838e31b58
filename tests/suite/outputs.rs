//! Written files: existing files are kept unless overwriting is requested, inputs are always kept,
//! and no file is written in part.

use std::ffi::OsStr;
use std::fs;
use std::path::Path;

use egui_kittest::kittest::Queryable;

use gdcm::gui::state::notices::NoticeKind;
use gdcm_io::{FileError, load_dataset, save_study};
use gdcm_study::Study;

use crate::commands::{Desk, Ended, SMALL};
use crate::window::{
    click, export_to, open_export, press_export, save_as, settle, state, wait_for_export_plan,
    window,
};

const RESULTS: [&str; 4] = [
    "assessment.csv",
    "corrections.csv",
    "corrections.json",
    "corrections.sha256",
];

fn names(directory: &Path) -> Vec<String> {
    let names = fs::read_dir(directory)
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap());
    let mut names: Vec<String> = names.collect();
    names.sort();
    names
}

/// Runs a shell line in which `gdcm` is the tested program.
#[cfg(unix)]
fn shell(desk: &Desk, line: &str) -> Ended {
    let mut command = std::process::Command::new("sh");
    let line = line.replace("gdcm ", "exec \"$0\" ");
    command
        .args(["-c", &line, env!("CARGO_BIN_EXE_gdcm")])
        .current_dir(desk.directory.path());
    Ended::from_output(&command.output().unwrap())
}

#[test]
fn results_that_are_there_are_named_and_only_overwritten_by_force() {
    let desk = Desk::new();
    let analyze = ["analyze", "small.json", "--out", "out"];
    desk.gdcm(&analyze).assert_done();
    fs::write(desk.path("out/corrections.csv"), "mine").unwrap();
    let all = RESULTS.map(|name| format!("out/{name}"));
    let mut names_of_all: Vec<&str> = all.iter().map(String::as_str).collect();
    names_of_all.push("--force");
    desk.messages(&analyze)
        .assert_code("output-exists", &names_of_all);
    fs::remove_file(desk.path("out/corrections.json")).unwrap();
    fs::remove_file(desk.path("out/assessment.csv")).unwrap();
    fs::remove_file(desk.path("out/corrections.sha256")).unwrap();
    let refused = desk.messages(&analyze);
    refused.assert_code("output-exists", &["out/corrections.csv", "--force"]);
    assert!(!refused.errors[0].text.contains("assessment.csv"));
    assert_eq!(names(&desk.path("out")), ["corrections.csv"]);
    assert_eq!(
        fs::read_to_string(desk.path("out/corrections.csv")).unwrap(),
        "mine"
    );
    desk.gdcm(&[&analyze[..], &["--force"]].concat())
        .assert_done();
    assert_eq!(names(&desk.path("out")), RESULTS);
    assert!(
        fs::read_to_string(desk.path("out/corrections.csv"))
            .unwrap()
            .starts_with("condition,")
    );
}

#[test]
fn the_example_is_overwritten_only_by_force() {
    let desk = Desk::new();
    fs::write(desk.path("example-dataset.json"), "mine").unwrap();
    desk.messages(&["example", "."])
        .assert_code("output-exists", &["./example-dataset.json", "--force"]);
    assert_eq!(
        fs::read_to_string(desk.path("example-dataset.json")).unwrap(),
        "mine"
    );
    desk.gdcm(&["example", ".", "--force"]).assert_done();
    assert!(load_dataset(&desk.path("example-dataset.json")).is_ok());
}

#[test]
fn an_input_is_not_overwritten_even_by_force() {
    let desk = Desk::new();
    let refused = "output-is-an-input";
    fs::write(desk.path("corrections.json"), SMALL).unwrap();
    desk.messages(&["analyze", "corrections.json", "--out", ".", "--force"])
        .assert_code(refused, &[]);

    let loaded = load_dataset(&desk.path("small.json")).unwrap();
    let study = desk.path("study/corrections.csv");
    fs::create_dir(desk.path("study")).unwrap();
    save_study(&Study::new(loaded.dataset.clone()), &loaded, &study).unwrap();
    let study = study.to_str().unwrap();
    desk.messages(&["analyze", study, "--out", "study", "--force"])
        .assert_code(refused, &[]);

    // The output is a link to the study's dataset.
    #[cfg(unix)]
    {
        fs::create_dir(desk.path("linked")).unwrap();
        std::os::unix::fs::symlink("../small.json", desk.path("linked/assessment.csv")).unwrap();
        desk.messages(&["analyze", study, "--out", "linked", "--force"])
            .assert_code(refused, &[]);
    }
    assert_eq!(fs::read_to_string(desk.path("small.json")).unwrap(), SMALL);
    assert_eq!(
        fs::read_to_string(desk.path("corrections.json")).unwrap(),
        SMALL
    );
}

#[test]
fn a_study_is_not_saved_over_its_dataset() {
    let desk = Desk::new();
    let loaded = load_dataset(&desk.path("small.json")).unwrap();
    let error = save_study(
        &Study::new(loaded.dataset.clone()),
        &loaded,
        &desk.path("small.json"),
    )
    .unwrap_err();
    assert!(matches!(error, FileError::Input { .. }), "{error}");
    assert_eq!(fs::read_to_string(desk.path("small.json")).unwrap(), SMALL);
}

#[cfg(target_os = "linux")]
#[test]
fn a_file_larger_than_the_system_allows_is_status_1_and_leaves_what_was_there() {
    let desk = Desk::new();
    let limited = "ulimit -f 1; gdcm analyze small.json --out out --force";
    let words = ["out/corrections.json: ", "(ulimit -f)"];
    shell(&desk, limited).assert_failed(1, &words);
    assert_eq!(names(&desk.path("out")), [""; 0]);
    for name in RESULTS {
        fs::write(desk.path("out").join(name), "before").unwrap();
    }
    shell(&desk, limited).assert_failed(1, &words);
    assert_eq!(names(&desk.path("out")), RESULTS);
    for name in RESULTS {
        assert_eq!(
            fs::read_to_string(desk.path("out").join(name)).unwrap(),
            "before",
            "{name}"
        );
    }
    let ended = shell(&desk, "ulimit -f 0; gdcm check small.json > printed");
    ended.assert_failed(1, &["standard output", "ulimit -f"]);
}

/// Runs a command that must end by itself: a command that waits for a pipe is killed after a
/// minute, and the test fails.
#[cfg(unix)]
fn ends(desk: &Desk, arguments: &[&str]) -> Ended {
    use std::process::Stdio;
    use std::time::{Duration, Instant};
    let mut child = desk
        .command(arguments)
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let started = Instant::now();
    while child.try_wait().unwrap().is_none() {
        if started.elapsed() > Duration::from_secs(60) {
            child.kill().unwrap();
            panic!("it hangs: {arguments:?}");
        }
        std::thread::sleep(Duration::from_millis(5));
    }
    Ended::from_output(&child.wait_with_output().unwrap())
}

/// Runs a command that is refused, and asserts its status 2 and the code of its only error.
#[cfg(unix)]
#[track_caller]
fn assert_refused(desk: &Desk, arguments: &[&str], code: &str) {
    let ended = ends(desk, &[arguments, &["--json"]].concat());
    let said: serde_json::Value = serde_json::from_str(&ended.out).unwrap();
    let expected = serde_json::json!([code]);
    assert_eq!(
        (ended.status, &said["error_codes"]),
        (2, &expected),
        "{arguments:?}: {said}"
    );
}

#[cfg(unix)]
#[test]
fn a_named_pipe_as_output_is_refused_at_once_by_every_command() {
    let desk = Desk::new();
    for folder in ["results", "models", "identified", "asked", "learn"] {
        fs::create_dir(desk.path(folder)).unwrap();
    }
    let pipes = [
        "pipe.html",
        "pipe.svg",
        "pipe.json",
        "pipe.py",
        "pipe.mat",
        "results/corrections.json",
        "identified/identified.json",
        "asked/requirements.json",
        "learn/example-dataset.json",
    ];
    for pipe in pipes {
        assert!(
            std::process::Command::new("mkfifo")
                .arg(desk.path(pipe))
                .status()
                .unwrap()
                .success()
        );
    }
    let identify = [
        "identify",
        "none.csv",
        "--inputs",
        "LON",
        "--outputs",
        "Q",
        "--band",
        "1",
        "9",
    ];
    let commands: [&[&str]; 12] = [
        &["report", "small.json", "--out", "pipe.html"],
        &[
            "figure",
            "small.json",
            "--view",
            "net-gain",
            "--out",
            "pipe.svg",
        ],
        &["export", "small.json", "--as", "py", "--out", "pipe.py"],
        &[
            "export",
            "small.json",
            "--as",
            "state-space",
            "--out",
            "pipe.mat",
        ],
        &["convert", "small.json", "--out", "pipe.json"],
        &["analyze", "small.json", "--out", "results"],
        &["assemble", "models", "--out", "pipe.json"],
        &["requirements", "small.json", "--out", "asked"],
        &[
            "requirements",
            "small.json",
            "--write-tolerances",
            "pipe.json",
        ],
        &[
            "requirements",
            "small.json",
            "--levels",
            "ads-33e-prf-yaw-tracking",
            "--write-levels",
            "pipe.json",
        ],
        &["example", "learn"],
        &[&identify[..], &["--out", "identified"]].concat(),
    ];
    for command in commands {
        assert_refused(&desk, command, "output-not-a-file");
        assert_refused(
            &desk,
            &[command, &["--force"]].concat(),
            "output-not-a-file",
        );
    }
}

#[cfg(unix)]
#[test]
fn a_named_pipe_as_input_is_refused_at_once_by_every_command() {
    let desk = Desk::new();
    let pipe = "pipe.json";
    assert!(
        std::process::Command::new("mkfifo")
            .arg(desk.path(pipe))
            .status()
            .unwrap()
            .success()
    );
    // An existing output is compared with every input.
    fs::write(desk.path("there.json"), "{}").unwrap();
    let identify = [
        "identify",
        "--inputs",
        "LON",
        "--outputs",
        "Q",
        "--band",
        "1",
        "9",
        "--out",
        "identified",
    ];
    let commands: [&[&str]; 9] = [
        &["check", pipe],
        &["analyze", pipe, "--out", "results"],
        &[
            "analyze",
            "small.json",
            "--levels",
            pipe,
            "--out",
            "results",
        ],
        &[
            "analyze",
            "small.json",
            "--tolerances",
            pipe,
            "--out",
            "results",
        ],
        &["report", pipe, "--out", "report.html"],
        &["convert", pipe, "--out", "there.json", "--force"],
        &[
            "assemble",
            ".",
            "--rules",
            pipe,
            "--out",
            "there.json",
            "--force",
        ],
        &[&identify[..], &[pipe]].concat(),
        &[
            &identify[..],
            &["small.json", "--into", pipe, "--every-condition"],
        ]
        .concat(),
    ];
    for command in commands {
        let ended = ends(&desk, command);
        assert!(
            ended.status > 0 && ended.error.contains("named pipe"),
            "{command:?}: {ended:?}"
        );
    }
}

#[cfg(unix)]
#[test]
fn a_closed_standard_output_costs_the_summary_and_nothing_else() {
    let desk = Desk::new();
    shell(&desk, "gdcm analyze small.json --out out >&-").assert_done();
    assert_eq!(names(&desk.path("out")), RESULTS);
    assert_eq!(
        crate::entries(&crate::read_json(&desk.path("out/corrections.json"))["conditions"]).len(),
        2
    );
    assert_eq!(fs::read_to_string(desk.path("small.json")).unwrap(), SMALL);
}

#[test]
fn what_a_killed_run_left_is_removed_by_the_next() {
    let desk = Desk::new();
    fs::create_dir(desk.path("out")).unwrap();
    fs::write(desk.path("out/.gdcm-Ab3xYz.tmp"), "half of a file").unwrap();
    desk.gdcm(&["analyze", "small.json", "--out", "out"])
        .assert_done();
    assert_eq!(names(&desk.path("out")), RESULTS);
}

#[test]
fn an_export_keeps_existing_files_unless_they_may_be_overwritten() {
    let mut window = window();
    let folder = tempfile::tempdir().unwrap();
    export_to(&mut window, folder.path());
    let csv = folder.path().join("corrections.csv");
    fs::write(&csv, "mine").unwrap();
    // The files are announced before they are written.
    open_export(
        &mut window,
        folder.path(),
        "",
        &["json", "csv", "assessment"],
    );
    let plan = state(&window).current_export_plan().unwrap();
    assert_eq!((plan.existing_files.len(), plan.suffix.as_str()), (3, "_2"));
    press_export(&mut window);
    assert_eq!(fs::read_to_string(&csv).unwrap(), "mine");
    let numbered = fs::read_to_string(folder.path().join("corrections_2.csv")).unwrap();
    assert!(numbered.starts_with("condition,"));

    open_export(
        &mut window,
        folder.path(),
        "",
        &["json", "csv", "assessment"],
    );
    click(&mut window, "Overwrite existing files");
    wait_for_export_plan(&mut window);
    press_export(&mut window);
    assert!(state(&window).forms.shown.is_none());
    assert!(fs::read_to_string(&csv).unwrap().starts_with("condition,"));
    assert!(!folder.path().join("corrections_3.csv").exists());
}

#[test]
fn a_study_saved_to_a_typed_path_asks_before_it_overwrites_a_file_that_is_not_its_own() {
    let mut window = window();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("other.json");
    fs::write(&path, "mine").unwrap();
    save_as(&mut window, &path);
    settle(&mut window);
    assert_eq!(fs::read_to_string(&path).unwrap(), "mine");
    assert!(window.query_by_label("This file exists already").is_some());
    click(&mut window, "Overwrite");
    assert!(fs::read_to_string(&path).unwrap().contains("gdcm-study"));
    // The file now belongs to the study and is overwritten without a question.
    save_as(&mut window, &path);
    settle(&mut window);
    assert!(state(&window).forms.existing.is_empty());
    assert_eq!(
        state(&window).notices.newest().map(|notice| notice.kind),
        Some(NoticeKind::Done)
    );
}

#[cfg(unix)]
#[test]
fn a_directory_that_may_not_be_written_to_is_status_1_without_the_name_of_a_temporary_file() {
    // Nobody can create a file in `/proc/self`, not even the superuser.
    let desk = Desk::new();
    let ended = Ended::from_output(
        &desk
            .command(&[OsStr::new("example"), OsStr::new("/proc/self")])
            .output()
            .unwrap(),
    );
    assert_eq!(ended.status, 1, "{ended:?}");
    assert!(
        ended
            .error
            .starts_with("error: /proc/self/example-dataset.json: "),
        "{}",
        ended.error
    );
    assert!(
        !ended.error.contains(".tmp") && !ended.error.contains("os error"),
        "{}",
        ended.error
    );
}

#[test]
fn names_that_are_formulas_or_commands_of_a_terminal_do_no_harm_in_what_is_written() {
    fn is_formula(cell: &str) -> bool {
        cell.trim_start_matches('"').starts_with(['=', '@'])
            || (cell.starts_with(['+', '-']) && cell.parse::<f64>().is_err())
    }

    for file in ["injected-names.json", "escape-in-title.json"] {
        let desk = Desk::new();
        let data = Path::new(env!("CARGO_MANIFEST_DIR"))
            .join("tests/data/edges")
            .join(file);
        let data = data.to_str().unwrap();
        desk.gdcm(&["analyze", data, "--out", "."]).assert_done();
        for (view, name) in [
            ("poles", "poles.csv"),
            ("poles", "poles.svg"),
            ("overview", "overview.csv"),
        ] {
            desk.gdcm(&[
                "figure",
                data,
                "--view",
                view,
                "--condition",
                "1",
                "--out",
                name,
            ])
            .assert_done();
        }
        for format in ["m", "py", "h", "table-csv"] {
            desk.gdcm(&[
                "export",
                data,
                "--as",
                format,
                "--out",
                &format!("export.{}", format.replace("table-", "")),
            ]);
        }
        desk.gdcm(&["report", data, "--out", "report.html"])
            .assert_done();
        let written = names(desk.directory.path());
        assert!(written.len() >= 10, "{written:?}");
        // JSON files are excluded: as data, they contain the names unchanged.
        for name in written.iter().filter(|name| !name.ends_with(".json")) {
            let text = fs::read_to_string(desk.path(name)).unwrap();
            let control = text
                .chars()
                .find(|letter| letter.is_control() && *letter != '\n');
            assert_eq!(control, None, "{file}: {name}");
            for line in text.lines().filter(|_| name.ends_with(".csv")) {
                assert!(!line.split(',').any(is_formula), "{file}: {name}: {line}");
            }
        }
    }
}
