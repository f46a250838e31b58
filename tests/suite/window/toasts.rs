//! Toasts in the top bar, and the messages of the session.

use gdcm::gui::commands::form::FormCommand;
use gdcm::gui::commands::output::OutputCommand;
use gdcm::gui::state::forms::FormKind;
use gdcm::gui::state::panel_tables::TableKind;
use gdcm::message::Message;
use gdcm_study::Edit;

use super::*;

fn refuse(window: &mut Window, code: &'static str) {
    let message = Message::new(code, format!("{code} is refused"));
    window.state_mut().dispatch(FormCommand::Refuse(message));
    window.run_steps(2);
}

/// Returns the codes of the toasts, newest first.
fn toasts(window: &Window) -> Vec<&'static str> {
    let toasts = state(window).notices.toasts();
    toasts.map(|toast| toast.notice.code).collect()
}

#[test]
fn a_failure_stays_until_it_is_closed_and_the_others_are_listed() {
    let mut window = window();
    for code in ["first", "second", "third"] {
        refuse(&mut window, code);
    }
    assert_eq!(toasts(&window), ["third", "second", "first"]);
    window.get_by_label("third is refused");
    assert!(window.query_by_label("first is refused").is_none());
    click(&mut window, "2 more messages");
    window.get_by_label("first is refused");
    click(&mut window, "Close message: first is refused");
    assert_eq!(toasts(&window), ["third", "second"]);
    click(&mut window, "Dismiss");
    assert_eq!(toasts(&window), ["second"]);
    window.get_by_label("second is refused");
}

#[test]
fn a_success_disappears_by_itself_and_stays_among_the_messages() {
    let mut window = window();
    window
        .state_mut()
        .dispatch(OutputCommand::CopyTable(TableKind::ALL[0]));
    window.run_steps(1);
    assert_eq!(toasts(&window), ["table-copied"]);
    wait_until(&mut window, "the end of the toast", |window| {
        toasts(window).is_empty()
    });
    let text = state(&window).notices.newest().unwrap().text.clone();
    window
        .state_mut()
        .dispatch(FormCommand::ShowForm(Some(FormKind::Messages)));
    window.run_steps(3);
    window.get_by_label(&text);
    window.get_by_label("Copy all messages");
}

#[test]
fn the_name_of_the_dataset_returns_after_a_toast() {
    let mut window = window();
    let is_named = |window: &Window| {
        let name = state(window).dataset().name().to_owned();
        window
            .query_by_label_contains(&format!("{name}, "))
            .is_some()
    };
    assert!(is_named(&window));
    refuse(&mut window, "refused");
    assert!(!is_named(&window));
    click(&mut window, "Dismiss");
    assert!(is_named(&window));
}

#[test]
fn a_visible_change_produces_no_message() {
    let mut window = window();
    let before = state(&window).notices.kept().len();
    click(&mut window, "Keep physics model V+10kt");
    let edit = Edit::Hold(pair(&window, "P", "LON"), true);
    window.state_mut().dispatch(edit);
    settle(&mut window);
    assert_eq!(state(&window).notices.kept().len(), before);
}

#[test]
fn a_study_is_reported_by_the_name_of_its_file() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("flight 7.gdcm-study.json");
    let mut window = window();
    save_as(&mut window, &path);
    open_by_path(&mut window, &path);
    wait_until(&mut window, "the study", |window| {
        state(window).study_name == "flight 7.gdcm-study.json"
    });
    settle(&mut window);
    assert_notice(
        &window,
        NoticeKind::Done,
        "opened",
        &["flight 7.gdcm-study.json"],
    );
}
