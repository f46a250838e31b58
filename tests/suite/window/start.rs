//! First steps: the bar above the example, the start page, and the first view.

use gdcm::gui::commands::layout::LayoutCommand;
use gdcm::gui::state::opens_with::OpensWith;
use gdcm::gui::state::preferences::Preferences;
use gdcm::message::Message;

use gdcm_io::Example;

use super::*;

const WAYS: [&str; 3] = ["Open dataset…", "Import models…", "Import records…"];

/// Opens the example without waiting for results, because no curves are drawn on the start page.
fn begun_with(setup: Setup) -> Window {
    let build = |creation: &mut eframe::CreationContext<'static>| {
        GdcmApp::with_setup(&creation.egui_ctx, example(), setup).expect("a thread can be started")
    };
    let mut window = Harness::builder()
        .with_size(vec2(1280.0, 720.0))
        .build_eframe(build);
    window.run_steps(3);
    window
}

fn preferring(opens_with: OpensWith) -> Setup {
    Setup {
        preferences: Preferences {
            opens_with,
            ..Preferences::default()
        },
        ..warm()
    }
}

fn press(window: &mut Window, label: &str) {
    window.get_by_label(label).click();
    window.run_steps(4);
}

#[test]
fn the_start_page_comes_with_close_and_from_the_menu_and_leads_back() {
    let mut window = window();
    window.key_press_modifiers(Modifiers::COMMAND, Key::W);
    window.run_steps(4);
    assert!(state(&window).on_start_page && state(&window).example == Some(Example::Simulated));
    for way in WAYS {
        window.get_by_label(way);
    }
    assert!(
        window.query_by_label("Export corrections…").is_none(),
        "no panels"
    );
    press(&mut window, "Explore the example");
    assert!(!state(&window).on_start_page);
    settle(&mut window);
    click(&mut window, "File");
    press(&mut window, "Start page");
    assert!(state(&window).on_start_page);
    press(&mut window, "Import models…");
    assert!(state(&window).assembling.is_some());
}

#[test]
fn the_start_page_opens_the_real_aircraft_with_its_records() {
    let mut window = begun_with(preferring(OpensWith::StartPage));
    press(&mut window, "Real aircraft");
    settle(&mut window);
    assert!(!state(&window).on_start_page);
    assert_eq!(state(&window).example, Some(Example::RealAircraft));
    let analysis = state(&window).analysis().expect("there are results");
    assert_eq!(analysis.study.dataset.conditions().len(), 2);
    window
        .state_mut()
        .dispatch(LayoutCommand::ShowView(View::Records));
    wait_until(&mut window, "its records", |window| {
        state(window)
            .records
            .conditions
            .contains_key(&ConditionId(1))
    });
    let records = &state(&window).records.conditions[&ConditionId(1)];
    let held_out: Vec<bool> = records.rows.iter().map(|row| row.guess.held_out).collect();
    assert_eq!(held_out, [false, true]);
    // The start page offers the simulated example.
    click(&mut window, "File");
    press(&mut window, "Start page");
    press(&mut window, "Simulated example");
    settle(&mut window);
    assert_eq!(state(&window).example, Some(Example::Simulated));
}

#[test]
fn the_menu_and_the_card_of_an_open_file_offer_both_examples() {
    let mut window = window();
    click(&mut window, "File");
    press(&mut window, "Open the real-aircraft example");
    settle(&mut window);
    assert_eq!(state(&window).example, Some(Example::RealAircraft));
    open_by_path(&mut window, &files::small_dataset());
    assert_eq!(state(&window).example, None);
    click(&mut window, "File");
    press(&mut window, "Start page");
    for name in ["Simulated example", "Real aircraft"] {
        window.get_by_label(name);
    }
}

#[test]
fn closing_asks_before_decisions_are_lost() {
    let mut window = window();
    click(&mut window, "Keep physics model V+10kt");
    window.key_press_modifiers(Modifiers::COMMAND, Key::W);
    window.run_steps(4);
    assert!(!state(&window).on_start_page && state(&window).unsaved);
    press(&mut window, "Don't save");
    assert!(state(&window).on_start_page && !state(&window).unsaved);
}

#[test]
fn what_opens_first_is_a_preference() {
    assert!(!state(&begun_with(preferring(OpensWith::Example))).on_start_page);
    let mut window = begun_with(preferring(OpensWith::StartPage));
    assert!(state(&window).on_start_page);
    window.get_by_label("Explore the example");
    window
        .state_mut()
        .dispatch(LayoutCommand::BeginWith(OpensWith::LastStudy));
    assert_eq!(
        Preferences::from_display(&state(&window).display).opens_with,
        OpensWith::LastStudy,
        "and is kept"
    );
}

#[test]
fn what_went_wrong_before_the_window_opened_is_told_in_it() {
    let trouble = Message::new("json-cut-off", "broken.json (line 1)");
    let window = begun_with(Setup {
        trouble: Some(trouble.clone()),
        ..preferring(OpensWith::StartPage)
    });
    assert_notice(&window, NoticeKind::Trouble, trouble.code, &[]);
    window.get_by_label(&trouble.text);
    assert!(!state(&window).on_start_page, "the example is open");
}
