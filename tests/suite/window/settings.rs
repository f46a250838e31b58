//! Settings beside live results.

use gdcm::gui::commands::layout::LayoutCommand;
use gdcm::gui::commands::study::StudyCommand;
use gdcm::gui::state::across_display::AcrossPage;
use gdcm::gui::state::view::View;
use gdcm_plot::figure::marks::Mark;
use gdcm_study::decisions::setting_table;
use gdcm_study::{Edit, PhaseCorrection};

use super::layout::{SMALL, window_of};
use super::lists::texts_in;
use super::views::{give, show};
use super::*;

/// Controls whose places must not change when the settings are opened.
const FIXED: [&str; 4] = [
    "Response LON → Q",
    "Response COL → NZ",
    "Export corrections…",
    "Settings",
];

fn places(window: &Window) -> Vec<egui::Rect> {
    FIXED
        .into_iter()
        .map(|label| window.get_by_role_and_label(Role::Button, label).rect())
        .collect()
}

fn open(window: &mut Window) {
    window.key_press_modifiers(Modifiers::COMMAND, Key::Comma);
    window.run_steps(3);
    assert!(state(window).settings_session.is_some());
}

fn close(window: &mut Window) {
    give(window, LayoutCommand::ShowSettings(false));
    assert!(state(window).settings_session.is_none());
}

fn set(window: &mut Window, edit: Edit) {
    give(window, StudyCommand::Edit(edit));
}

fn undo_steps(window: &mut Window) -> usize {
    let mut steps = 0;
    while state(window).history.undo_step().is_some() {
        give(window, StudyCommand::Undo);
        steps += 1;
    }
    steps
}

#[test]
fn open_settings_leave_matrix_and_export_in_their_places() {
    let mut window = window();
    let before = places(&window);
    let plot = *state(&window)
        .display
        .frequency
        .bode
        .transform(Pane::Magnitude)
        .unwrap()
        .frame();
    open(&mut window);
    assert_eq!(places(&window), before);
    let frame = *state(&window)
        .display
        .frequency
        .bode
        .transform(Pane::Magnitude)
        .unwrap()
        .frame();
    assert_eq!(frame, plot);
    assert!(
        window
            .query_by_label("Keep physics model nominal")
            .is_none(),
        "the settings replace the models"
    );
    for label in ["α gains", "α delays", "Band from", "Band to"] {
        let field = window.get_by_role_and_label(Role::SpinButton, label).rect();
        assert!(field.right() < frame.left(), "{label} at {field}");
    }
    close(&mut window);
    window.get_by_label("Keep physics model nominal");
}

#[test]
fn on_a_small_screen_the_settings_stand_between_the_rail_and_the_views() {
    let mut window = window_of(SMALL, 1.0);
    let before = places(&window);
    open(&mut window);
    assert_eq!(places(&window), before);
    let frame = *state(&window)
        .display
        .frequency
        .bode
        .transform(Pane::Magnitude)
        .unwrap()
        .frame();
    for label in ["α gains slider", "α delays slider"] {
        let slider = window.get_by_role_and_label(Role::Slider, label).rect();
        assert!(slider.right() < frame.left(), "{label} at {slider}");
    }
    let phase = window.get_by_label("Phase correction: delay").rect();
    assert!(phase.bottom() < SMALL.y);
}

#[test]
fn closing_the_settings_makes_one_undo_step_and_revert_none() {
    let mut window = window();
    let before = state(&window).study.clone();
    open(&mut window);
    set(&mut window, setting_table::ALPHA_GAIN.to(8.0));
    set(&mut window, setting_table::ALPHA_DELAY.to(3.0));
    assert_eq!(state(&window).changed_settings().len(), 2);
    close(&mut window);
    assert!(matches!(
        last_change(&window),
        Some(Change::Settings(edits)) if edits.len() == 2
    ));
    assert_eq!(undo_steps(&mut window), 1);
    assert_eq!(state(&window).study, before);
    open(&mut window);
    set(&mut window, setting_table::ALPHA_GAIN.to(8.0));
    set(&mut window, setting_table::PHASE.to(PhaseCorrection::None));
    click(&mut window, "Revert the settings");
    settle(&mut window);
    assert_eq!(state(&window).study, before);
    assert!(state(&window).changed_settings().is_empty());
    close(&mut window);
    assert_eq!(undo_steps(&mut window), 0);
}

#[test]
fn the_result_and_the_dock_keep_the_values_at_the_opening() {
    let mut window = window();
    let before = state(&window).shown().unwrap().gains.outputs.clone();
    open(&mut window);
    set(&mut window, setting_table::ALPHA_GAIN.to(1000.0));
    let state_now = state(&window);
    let previous = state_now.previous_result().unwrap();
    assert_eq!(previous.gains.outputs, before);
    let text = gdcm_model::number_format::decimals(before[1], 3);
    let name = window.get_by_label_contains("Gain of Q: ");
    let label = name.accesskit_node().label().unwrap_or_default();
    assert!(label.ends_with(&format!("previously {text}")), "{label}");
    let plots = gdcm::gui::views::net_gain::net_gain_plots(state_now);
    let marks = plots.figure.plots[0].panels[0].marks.iter();
    let previous_dots = marks
        .filter_map(|mark| match mark {
            Mark::Dots(dots) if dots.name == "previous" => Some(dots.dots.len()),
            _ => None,
        })
        .next();
    assert_eq!(
        previous_dots,
        Some(state_now.analysis().unwrap().conditions.len())
    );
}

#[test]
fn error_bars_wait_until_the_slider_rests() {
    let mut window = window();
    wait_for_bars(&mut window);
    open(&mut window);
    window
        .state_mut()
        .dispatch(StudyCommand::Edit(setting_table::ALPHA_GAIN.to(8.0)));
    window.state_mut().dispatch(StudyCommand::DragEdit);
    settle(&mut window);
    assert!(state(&window).is_setting_dragged());
    assert!(state(&window).uncertainty().is_none());
    assert!(
        state(&window).older_uncertainty().is_some(),
        "the bars of the earlier settings stay, dimmed"
    );
    assert!(state(&window).results.background.error_bars.is_none());
    window.state_mut().dispatch(StudyCommand::EndEdit);
    wait_for_bars(&mut window);
    assert!(state(&window).older_uncertainty().is_none());
}

#[test]
fn the_trade_off_of_alpha_is_computed_once_and_serves_every_alpha() {
    let mut window = window();
    assert!(
        state(&window).results.trade_off.is_none(),
        "only beside its slider"
    );
    open(&mut window);
    wait_until(&mut window, "the trade-off", |window| {
        state(window).trade_off().is_some()
    });
    assert_eq!(state(&window).trade_off().unwrap().points.len(), 25);
    let first = state(&window).results.trade_off.as_ref().unwrap().1.clone();
    set(&mut window, setting_table::ALPHA_GAIN.to(8.0));
    let second = state(&window).results.trade_off.as_ref().unwrap().1.clone();
    assert!(Arc::ptr_eq(&first.unwrap(), &second.unwrap()));
}

#[test]
fn the_box_that_holds_a_response_covers_no_error_bar() {
    let mut window = window();
    wait_for_bars(&mut window);
    let cell = window.get_by_label("Response LON → Q").rect();
    let bars = |window: &Window| {
        let texts = texts_in(window, cell);
        texts
            .iter()
            .filter(|(text, _)| text.starts_with('±'))
            .count()
    };
    window.hover_at(pos2(10.0, 10.0));
    window.run_steps(3);
    assert_eq!(bars(&window), 2, "of G and of D");
    window.hover_at(cell.center());
    window.run_steps(3);
    let hold = window.get_by_label("Hold LON → Q").rect();
    for (text, place) in texts_in(&window, cell) {
        assert!(!hold.intersects(place), "{text} at {place} under {hold}");
    }
}

#[test]
fn on_a_small_screen_the_errors_of_airspeeds_are_a_page() {
    let mut window = window_of(SMALL, 1.0);
    show(&mut window, View::Across);
    wait_until(&mut window, "the responses", |window| {
        state(window).across().is_some()
    });
    window.run_steps(2);
    click(&mut window, "Page schedule error");
    assert_eq!(
        state(&window).display.frequency.across_display.page,
        AcrossPage::Error
    );
    window.run_steps(2);
    window.get_by_label_contains("Magnitude error in every condition of ");
    assert!(
        window
            .query_by_label_contains("Magnitude in every condition of ")
            .is_none()
    );
}
