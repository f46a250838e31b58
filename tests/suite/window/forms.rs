//! Forms, used from the keyboard; and the coherence settings, which only some datasets have.

use gdcm::gui::state::forms::FormKind;

use super::*;

fn press(window: &mut Window, modifiers: Modifiers, key: Key) {
    window.key_press_modifiers(modifiers, key);
    window.run_steps(2);
}

fn type_text(window: &mut Window, text: &str) {
    window.event(Event::Text(text.to_owned()));
    window.run_steps(2);
}

/// Opens a window whose home directory is `home`.
fn window_at(home: &Path) -> Window {
    window_with(
        example(),
        Setup {
            home: Some(home.to_owned()),
            ..Setup::default()
        },
    )
}

#[test]
fn a_path_is_typed_at_once_and_enter_opens_it_and_a_tilde_means_home() {
    let home = tempfile::tempdir().unwrap();
    std::fs::copy(files::small_dataset(), home.path().join("data.json")).unwrap();
    let mut window = window_at(home.path());
    press(&mut window, Modifiers::COMMAND | Modifiers::SHIFT, Key::O);
    type_text(&mut window, "~/data.json");
    press(&mut window, Modifiers::NONE, Key::Enter);
    settle(&mut window);
    // The small dataset has two conditions.
    assert_eq!(state(&window).dataset().conditions().len(), 2);
    assert_eq!(state(&window).forms.shown, None);
}

#[test]
fn enter_exports_once_the_dry_run_has_ended_and_replaces_nothing() {
    let home = tempfile::tempdir().unwrap();
    let mut window = window_at(home.path());
    let first = home.path().join("results/example_corrections.json");
    press(&mut window, Modifiers::COMMAND, Key::E);
    type_text(&mut window, "~/results");
    // The dry run, which finds the files to be written to the typed folder, may still be running.
    press(&mut window, Modifiers::NONE, Key::Enter);
    wait_until(&mut window, "the export", |window| {
        state(window).forms.shown.is_none()
    });
    let written = std::fs::read(&first).unwrap();

    slide(&mut window, "α gains", 12.5);
    settle(&mut window);
    // The form proposes the folder of the first export.
    press(&mut window, Modifiers::COMMAND, Key::E);
    press(&mut window, Modifiers::NONE, Key::Enter);
    wait_until(&mut window, "the export", |window| {
        state(window).forms.shown.is_none()
    });
    assert_eq!(std::fs::read(&first).unwrap(), written);
    let second = home.path().join("results/example_corrections_2.json");
    assert_eq!(crate::read_json(&second)["settings"]["alpha_gain"], 12.5);
}

#[test]
fn coherence_is_switched_where_something_is_measured_with_it() {
    let mut example = window();
    unfold_settings(&mut example, true);
    assert!(
        example.query_by_label("Coherence counts").is_none(),
        "the example has none"
    );
    open_by_path(&mut example, &files::small_dataset());
    settle(&mut example);
    unfold_settings(&mut example, true);
    // The default minimum coherence.
    assert_eq!(
        state(&example).study.settings.coherence_threshold,
        Some(0.6)
    );
    click(&mut example, "Coherence counts");
    assert_eq!(state(&example).study.settings.coherence_threshold, None);
    click(&mut example, "Coherence counts");
    example
        .get_by_label("Minimum coherence")
        .set_value_accesskit(0.75);
    settle(&mut example);
    assert_eq!(
        state(&example).study.settings.coherence_threshold,
        Some(0.75)
    );
}

#[test]
fn escape_closes_each_form_and_decides_nothing() {
    let mut window = window();
    // Unsaved decisions, because of which Ctrl+Q opens a form.
    click(&mut window, "Keep physics model V+10kt");
    let before = state(&window).study.clone();
    let ctrl = Modifiers::COMMAND;
    let shift = Modifiers::COMMAND | Modifiers::SHIFT;
    for (modifiers, key) in [
        (shift, Key::O),
        (ctrl, Key::E),
        (ctrl, Key::Q),
        (Modifiers::NONE, Key::F1),
    ] {
        press(&mut window, modifiers, key);
        assert!(state(&window).forms.shown.is_some(), "{key:?}");
        press(&mut window, Modifiers::NONE, Key::Escape);
        assert_eq!(state(&window).forms.shown, None, "{key:?}");
    }
    assert!(state(&window).study == before && state(&window).unsaved);
}

#[test]
fn the_licences_are_opened_and_scrolled_with_keys() {
    let mut window = few_window();
    press(&mut window, Modifiers::COMMAND, Key::K);
    type_text(&mut window, "Licences");
    press(&mut window, Modifiers::NONE, Key::Enter);
    wait_until(&mut window, "the licences", |window| {
        state(window).forms.shown == Some(FormKind::Licences)
    });
    window.run_steps(2);
    let mut lines = gdcm::licences::TEXT.lines();
    let first = lines.next().unwrap();
    let last = lines.rfind(|line| !line.is_empty()).unwrap();
    window.get_by_label(first);
    assert!(window.query_by_label(last).is_none());
    press(&mut window, Modifiers::NONE, Key::PageDown);
    wait_until(&mut window, "the next page", |window| {
        window.query_by_label(first).is_none()
    });
    press(&mut window, Modifiers::NONE, Key::End);
    wait_until(&mut window, "the last page", |window| {
        window.query_by_label(last).is_some()
    });
    press(&mut window, Modifiers::NONE, Key::Home);
    wait_until(&mut window, "the first page", |window| {
        window.query_by_label(first).is_some()
    });
    // The button Close has the focus.
    press(&mut window, Modifiers::NONE, Key::Enter);
    assert_eq!(state(&window).forms.shown, None);
}
