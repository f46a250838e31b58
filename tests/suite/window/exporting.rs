//! The export dialog: what it announces, writes and remembers.

use std::fs;
use std::path::Path;

use gdcm::gui::state::notices::NoticeAction;
use gdcm_method::schedule::DelayScheduling;
use gdcm_study::Edit;
use gdcm_study::results::export_note::FileSummary;

use super::*;
use crate::commands::Desk;

fn press(window: &mut Window, modifiers: Modifiers, key: Key) {
    window.key_press_modifiers(modifiers, key);
    window.run_steps(2);
}

/// Returns the codes of what the files omit or approximate.
fn note_codes(window: &Window) -> Vec<&'static str> {
    let plan = state(window).current_export_plan().expect("a dry run");
    plan.notes
        .iter()
        .map(|planned| planned.note.code())
        .collect()
}

/// Returns the names of the files in a folder, sorted.
fn names(folder: &Path) -> Vec<String> {
    let mut names = Vec::new();
    for entry in fs::read_dir(folder).unwrap() {
        names.push(entry.unwrap().file_name().into_string().unwrap());
    }
    names.sort();
    names
}

#[test]
fn the_dialog_lists_files_and_what_they_omit_and_its_remedies_act() {
    let folder = tempfile::tempdir().unwrap();
    let mut window = window();
    open_export(
        &mut window,
        folder.path(),
        "uh60_",
        &["json", "m", "table-csv"],
    );
    let codes = note_codes(&window);
    assert!(codes.contains(&"delays-not-scheduled"), "{codes:?}");
    assert!(codes.contains(&"gain-table-error"), "{codes:?}");
    for name in [
        "uh60_corrections.json",
        "uh60_correction.m",
        "uh60_table.csv",
    ] {
        window.get_by_label(&format!("File {name}"));
    }
    assert_eq!(names(folder.path()), [""; 0], "nothing is written yet");

    click(&mut window, "Turn on");
    wait_for_export_plan(&mut window);
    assert_eq!(
        state(&window).study.settings.schedule_delays,
        DelayScheduling::Always
    );
    let codes = note_codes(&window);
    assert!(!codes.contains(&"delays-not-scheduled"), "{codes:?}");

    press_export(&mut window);
    assert_eq!(state(&window).forms.shown, None);
    assert_eq!(
        names(folder.path()),
        [
            "uh60_correction.m",
            "uh60_corrections.json",
            "uh60_table.csv"
        ]
    );
    assert_notice(&window, NoticeKind::Done, "exported", &["3 files"]);
    let notice = state(&window).notices.newest().unwrap();
    let expected = NoticeAction::ShowFolder(folder.path().to_owned());
    assert_eq!(notice.action, Some(expected));
}

#[test]
fn an_error_stays_in_the_dialog_and_an_impossible_file_prevents_the_export() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("not-a-folder");
    fs::write(&file, "").unwrap();
    let mut window = window();
    open_export(&mut window, &file, "", &["csv"]);
    press_export(&mut window);
    let form = &state(&window).forms;
    assert_eq!(form.shown, Some(gdcm::gui::state::forms::FormKind::Export));
    assert_eq!(
        form.export.error.as_ref().unwrap().code,
        "output-directory-is-a-file"
    );
    window.get_by_label("Close error");

    open_export(&mut window, folder.path(), "2-", &["m"]);
    let plan = state(&window).current_export_plan().unwrap();
    let (_, fault) = plan.first_fault().expect("no function has this name");
    assert_eq!(fault.code(), "function-name");
    let button = window.get_by_label("Export 1 file");
    assert!(button.accesskit_node().is_disabled());
}

#[test]
fn the_choices_are_stored_in_the_study_and_are_no_step_of_the_history() {
    let folder = tempfile::tempdir().unwrap();
    let mut window = window();
    click(&mut window, "Keep physics model V+10kt");
    let shown = state(&window).condition().id();
    assert_eq!(state(&window).study.rejected_names(shown).len(), 1);
    open_export(&mut window, folder.path(), "mine_", &["csv", "py"]);
    click(&mut window, "Export condition 3");
    click(&mut window, "Correction per condition");
    wait_for_export_plan(&mut window);
    press_export(&mut window);
    let study = folder.path().join("mine.gdcm-study.json");
    save_as(&mut window, &study);
    let exports = open_study(&study).unwrap().study.exports;
    assert_eq!(exports, state(&window).study.exports);
    assert_eq!(exports.formats.len(), 2);
    assert_eq!(exports.prefix.as_deref(), Some("mine_"));
    assert!(exports.per_condition);
    let conditions = exports.conditions.as_ref().unwrap();
    assert!(conditions.len() == 10 && !conditions.contains(&ConditionId(3)));

    press(&mut window, Modifiers::COMMAND, Key::Z);
    settle(&mut window);
    assert_eq!(state(&window).study.rejected_names(shown).len(), 0);
    assert_eq!(state(&window).study.exports, exports);
}

#[test]
fn a_study_without_choices_of_an_export_still_loads() {
    let folder = tempfile::tempdir().unwrap();
    let mut window = window();
    let path = folder.path().join("older.gdcm-study.json");
    save_as(&mut window, &path);
    assert!(!fs::read_to_string(&path).unwrap().contains("\"export\""));
    let study = open_study(&path).unwrap().study;
    assert_eq!(*study.exports, Default::default());
}

#[test]
fn the_equivalent_command_line_writes_the_same_files() {
    let desk = Desk::new();
    let by_window = desk.path("window");
    let by_command = desk.path("command");
    let mut window = window_with(
        load_any(&desk.path("small.json"), &Default::default()).unwrap(),
        Setup::default(),
    );
    slide(&mut window, "α gains", 3.5);
    settle(&mut window);
    wait_for_bars(&mut window);
    let formats = ["json", "csv", "m", "table-csv", "state-space-npz"];
    open_export(&mut window, &by_command, "a_", &formats);
    refill(&mut window, "Breakpoints", "50 65 80");
    wait_for_export_plan(&mut window);
    let line = window.state().export_command().unwrap();
    let line = line.strip_prefix("gdcm ").unwrap();
    let words: Vec<&str> = line.split(' ').collect();
    assert!(
        words.contains(&"--alpha") && words.contains(&"--breakpoints"),
        "{line}"
    );
    refill(&mut window, "Export folder", by_window.to_str().unwrap());
    wait_for_export_plan(&mut window);
    let announced = note_codes(&window);
    press_export(&mut window);

    let ended = desk.messages(&words);
    assert_eq!(ended.status, 0, "{ended:?}");
    let noted: Vec<&str> = ended.notes.iter().map(|note| note.code.as_str()).collect();
    assert_eq!(noted, announced, "the notes of the dialog");
    assert_eq!(names(&by_window), names(&by_command));
    for name in names(&by_window) {
        let same =
            fs::read(by_window.join(&name)).unwrap() == fs::read(by_command.join(&name)).unwrap();
        assert!(same, "{name}");
    }
    // Run again, the command keeps its files, as the dialog does.
    assert_eq!(desk.messages(&words).status, 0);
    assert!(by_command.join("a_correction_2.m").exists());
}

#[test]
fn decisions_that_options_cannot_express_must_be_saved_first() {
    let folder = tempfile::tempdir().unwrap();
    let mut window = window();
    click(&mut window, "Keep physics model V+10kt");
    open_export(&mut window, folder.path(), "", &["csv"]);
    let line = window.state().export_command().unwrap();
    let id = state(&window).condition().id();
    assert!(line.contains(&format!(" --reject {id}:V+10kt ")), "{line}");
    press(&mut window, Modifiers::NONE, Key::Escape);

    let scheduled = Edit::SetScheduled {
        condition: ConditionId(3),
        scheduled: false,
    };
    window.state_mut().dispatch(scheduled);
    settle(&mut window);
    open_export(&mut window, folder.path(), "", &["csv"]);
    let refused = window
        .state()
        .export_command()
        .map_err(|message| message.code);
    assert_eq!(refused, Err("study-not-saved"));
    click(&mut window, "Copy command line");
    window.get_by_label("Save study");
}

#[test]
fn the_report_of_an_export_is_written_last() {
    let folder = tempfile::tempdir().unwrap();
    let mut window = few_window();
    open_export(&mut window, folder.path(), "", &["csv"]);
    click(&mut window, "Export Report .html");
    wait_for_export_plan(&mut window);
    wait_until(&mut window, "the report in the dry run", |window| {
        state(window).forms.export.report.is_some()
    });
    let (_, report) = state(&window).forms.export.report.clone().unwrap();
    let FileSummary::Report {
        conditions,
        figures,
        tables,
    } = report.summary
    else {
        panic!("{:?}", report.summary)
    };
    let drawn = report.html.matches("<figure>").count();
    let expected = state(&window).dataset().conditions().len();
    assert_eq!([conditions, figures], [expected, drawn]);
    assert!(tables > 5 && !report.headings.is_empty());
    let plan = state(&window).current_export_plan().unwrap();
    let of_report: Vec<&str> = plan
        .notes
        .iter()
        .filter(|planned| planned.files.contains(&plan.files.len()))
        .map(|planned| planned.note.code())
        .collect();
    assert!(of_report.contains(&"no-flight-records"), "{of_report:?}");
    window.run_steps(2);
    click(&mut window, "File report.html");
    assert_eq!(state(&window).forms.export.selected, 1);
    assert!(names(folder.path()).is_empty(), "nothing is written yet");
    press_export(&mut window);
    wait_until(&mut window, "the report", |window| {
        let newest = state(window).notices.newest();
        newest.is_some_and(|notice| notice.code == "report-written")
    });
    assert_eq!(names(folder.path()), ["corrections.csv", "report.html"]);
    let written = std::fs::read_to_string(folder.path().join("report.html")).unwrap();
    assert_eq!(written, report.html, "what the dialog described is written");
    assert_eq!(state(&window).results.background.report, None);
}

#[test]
fn a_report_with_records_that_lack_samples_ends() {
    let folder = tempfile::tempdir().unwrap();
    let path = super::records::late_dataset(folder.path());
    let flight = folder.path().join("flight_0.csv");
    let mut lines: Vec<String> = Vec::new();
    for (index, line) in fs::read_to_string(&flight).unwrap().lines().enumerate() {
        let mut cells: Vec<&str> = line.split(',').collect();
        if (200..240).contains(&index)
            && let Some(last) = cells.last_mut()
        {
            *last = "NaN";
        }
        lines.push(cells.join(","));
    }
    fs::write(&flight, lines.join("\n")).unwrap();
    let mut window = window();
    open_by_path(&mut window, &path);
    super::views::show(&mut window, View::Records);
    wait_until(&mut window, "the records", |window| {
        !state(window).records.history_records().is_empty()
    });
    settle(&mut window);
    let report = folder.path().join("report.html");
    window
        .state_mut()
        .dispatch(gdcm::gui::commands::output::OutputCommand::WriteReport(
            report.clone(),
        ));
    wait_until(&mut window, "the report", |window| {
        let newest = state(window).notices.newest();
        newest.is_some_and(|notice| notice.code == "report-written")
    });
    assert!(report.exists());
    assert_eq!(state(&window).results.background.report, None);
}
