//! A dataset whose file changes while it is open.

use std::path::PathBuf;

use gdcm_study::decisions::dataset_differences::Difference;

use super::*;

/// Copy of the small dataset whose file the tests change.
struct Copy {
    _folder: tempfile::TempDir,
    path: PathBuf,
    text: String,
}

impl Copy {
    fn new() -> Self {
        let text = std::fs::read_to_string(
            Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/small-dataset.json"),
        );
        let folder = tempfile::tempdir().unwrap();
        let text = text.unwrap();
        let path = folder.path().join("my-dataset.json");
        std::fs::write(&path, &text).unwrap();
        Self {
            _folder: folder,
            path,
            text,
        }
    }

    /// Changes the dataset's name in the file, but no values.
    fn rename(&self, name: &str) {
        self.change("\"name\": \"two", &format!("\"name\": \"{name} two"));
    }

    /// Replaces `before` in the file.
    fn change(&self, before: &str, after: &str) {
        assert!(self.text.contains(before), "{before}");
        std::fs::write(&self.path, self.text.replacen(before, after, 1)).unwrap();
    }

    fn window(&self) -> Window {
        let setup = Setup {
            look_every: Duration::from_millis(20),
            ..Setup::default()
        };
        window_with(load_any(&self.path, &Default::default()).unwrap(), setup)
    }
}

fn is_told(window: &Window) -> bool {
    bar_codes(window).contains(&"dataset-changed-on-disk")
        && window
            .query_all_by_label_contains("my-dataset.json")
            .next()
            .is_some()
}

#[test]
fn a_file_that_changes_is_told_and_reloaded_and_undo_goes_back_across_it() {
    let copy = Copy::new();
    let mut window = copy.window();
    let before = state(&window).dataset().name().to_owned();
    slide(&mut window, "α gains", 12.5);
    settle(&mut window);
    let received = state(&window).results.received;
    copy.rename("renewed");
    wait_until(&mut window, "the change is told", is_told);
    assert_eq!(
        state(&window).dataset().name(),
        before,
        "nothing is taken up unasked"
    );
    click(&mut window, "Reload");
    assert!(state(&window).dataset().name().starts_with("renewed"));
    assert_eq!(
        state(&window).study.settings.alpha_gain,
        12.5,
        "the decision still applies"
    );
    assert!(state(&window).results.received > received && state(&window).shown().is_some());
    assert!(!is_told(&window));
    let reload = Change::Reload {
        file: "my-dataset.json".to_owned(),
    };
    assert_eq!(last_change(&window), Some(&reload));
    window.key_press_modifiers(Modifiers::COMMAND, Key::Z);
    settle(&mut window);
    assert_eq!(state(&window).dataset().name(), before);
    assert!(
        state(&window).shown().is_some(),
        "its results are there again"
    );
    window.key_press_modifiers(Modifiers::COMMAND, Key::Z);
    settle(&mut window);
    assert_eq!(
        state(&window).study.settings.alpha_gain,
        1.0,
        "and the decisions before it"
    );
    for _ in 0..2 {
        window.key_press_modifiers(Modifiers::COMMAND | Modifiers::SHIFT, Key::Z);
        settle(&mut window);
    }
    assert!(state(&window).dataset().name().starts_with("renewed"));
}

#[test]
fn a_study_saved_after_a_reload_is_one_of_the_file_as_it_is_now() {
    let copy = Copy::new();
    let mut window = copy.window();
    copy.rename("renewed");
    wait_until(&mut window, "the change is told", is_told);
    click(&mut window, "Reload");
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("mine.gdcm-study.json");
    save_as(&mut window, &path);
    let OpenedStudy { study, loaded, .. } = open_study(&path).unwrap();
    assert!(study.dataset.name().starts_with("renewed") && loaded.path().is_some());
}

#[test]
fn what_is_open_may_be_kept_and_the_next_change_is_told_again() {
    let copy = Copy::new();
    let mut window = copy.window();
    let before = state(&window).dataset().name().to_owned();
    copy.rename("renewed");
    wait_until(&mut window, "the change is told", is_told);
    click(&mut window, "Keep the open dataset");
    assert!(!is_told(&window) && state(&window).dataset().name() == before);
    copy.rename("once more");
    wait_until(&mut window, "the next change is told", is_told);
    std::fs::write(&copy.path, &copy.text).unwrap();
    wait_until(&mut window, "as it was opened: nothing to tell", |window| {
        !is_told(window)
    });
}

#[test]
fn a_changed_file_that_is_wrong_leaves_what_is_open() {
    let copy = Copy::new();
    let mut window = copy.window();
    let before = state(&window).study.clone();
    std::fs::write(&copy.path, "{\"format\": \"gdcm-dataset\", ").unwrap();
    wait_until(&mut window, "the change is told", is_told);
    click(&mut window, "Reload");
    assert_notice(
        &window,
        NoticeKind::Trouble,
        "json-cut-off",
        &["my-dataset.json"],
    );
    assert_eq!(state(&window).study, before);
    assert!(is_told(&window), "it can be tried again");
}

#[test]
fn what_is_different_after_a_reload_is_listed() {
    let copy = Copy::new();
    let mut window = copy.window();
    click(&mut window, "Keep physics model V+5kt");
    copy.change("\"V+5kt\"", "\"V+6kt\"");
    wait_until(&mut window, "the change is told", is_told);
    click(&mut window, "Reload");
    let Some(MessageBar::Differences { name, differences }) = state(&window).notices.bars().next()
    else {
        panic!("{:?}", bar_codes(&window))
    };
    assert_eq!(name, "my-dataset.json");
    let codes: Vec<&str> = differences.iter().map(Difference::code).collect();
    assert_eq!(codes, ["model-removed", "model-added", "edit-refused"]);
    click(&mut window, "Details of the message");
    assert!(
        window.query_all_by_label_contains("V+5kt").count() >= 1,
        "the model that is gone is named"
    );
    window.get_by_label("Keep physics model V+6kt");
    assert!(state(&window).unsaved);
    click(&mut window, "Close list");
    assert!(bar_codes(&window).is_empty());
    window.key_press_modifiers(Modifiers::COMMAND, Key::Z);
    settle(&mut window);
    window.get_by_label("Keep physics model V+5kt");
}

#[test]
fn a_message_bar_moves_neither_plots_nor_buttons_and_lies_in_the_top_bar() {
    let copy = Copy::new();
    let mut window = copy.window();
    let before = fixed_places(&window);
    copy.change("\"V+5kt\"", "\"V+6kt\"");
    wait_until(&mut window, "the change is told", is_told);
    assert_eq!(fixed_places(&window), before, "the file has changed");
    let reload = window.get_by_label("Reload").rect();
    assert!(reload.bottom() <= 36.0, "{reload}");
    let entries = gdcm::gui::commands::command_table::every_command(state(&window));
    assert!(
        entries
            .iter()
            .any(|entry| entry.name == "Reload my-dataset.json"),
        "the palette has the answers too"
    );
    click(&mut window, "Reload");
    assert_eq!(bar_codes(&window), ["dataset-reloaded"]);
    assert_eq!(fixed_places(&window), before, "differences are counted");
    click(&mut window, "Details of the message");
    assert_eq!(fixed_places(&window), before, "differences are listed");
    click(&mut window, "Close list");
    assert_eq!(fixed_places(&window), before);
}

#[test]
fn a_message_bar_below_a_newer_toast_is_listed_with_its_buttons() {
    let copy = Copy::new();
    let mut window = copy.window();
    copy.rename("renewed");
    wait_until(&mut window, "the change is told", is_told);
    let refusal = gdcm::message::Message::new("refused", "refused");
    window
        .state_mut()
        .dispatch(gdcm::gui::commands::form::FormCommand::Refuse(refusal));
    window.run_steps(2);
    assert!(window.query_by_label("Reload").is_none());
    click(&mut window, "1 more message");
    click(&mut window, "Keep the open dataset");
    assert!(bar_codes(&window).is_empty());
    window.get_by_label("Dismiss");
}
