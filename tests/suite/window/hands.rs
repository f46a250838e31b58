//! Derivations, models in the overview, and exported tables, requested in plots and tables.

use gdcm::gui::commands::command::Command as Action;
use gdcm::gui::commands::command_table::every_command;
use gdcm::gui::commands::form::FormCommand;
use gdcm::gui::commands::output::OutputCommand;
use gdcm::gui::commands::selection::SelectionCommand;
use gdcm::gui::commands::study::StudyCommand;
use gdcm::gui::state::view::View;
use gdcm_words::derivation::{ExplainTarget, derivation};

use super::views::{give, show};
use super::walk::stays_within;
use super::*;

fn secondary_click(window: &mut Window, at: egui::Pos2) {
    window.hover_at(at);
    window.run_steps(2);
    for pressed in [true, false] {
        let button = PointerButton::Secondary;
        window.event(Event::PointerButton {
            pos: at,
            button,
            pressed,
            modifiers: Modifiers::NONE,
        });
    }
    window.run_steps(3);
}

/// Requests the derivation of a value through the open menu, and asserts that it ends with this
/// value.
fn ask(window: &mut Window, entry: &str, expected: f64) {
    window.get_by_label(entry).click();
    window.run_steps(3);
    let asked = state(window)
        .display
        .selection
        .explained
        .clone()
        .expect("a figure is explained");
    let found = derivation(state(window).analysis().unwrap(), &asked).expect("it has a derivation");
    assert!(
        (found.value - expected).abs() <= 1e-12 * expected.abs(),
        "{}: {} {expected}",
        found.title,
        found.value
    );
    window.get_by_label_contains("Based on");
    window.key_press(Key::Escape);
    window.run_steps(3);
    assert_eq!(
        state(window).display.selection.explained,
        None,
        "Escape closes the sheet"
    );
}

#[test]
fn a_dot_of_net_gain_says_how_it_was_computed() {
    let mut window = window();
    let fifth = ConditionId(5);
    let at = state(&window).display.figures[&View::NetGain]
        .screen_position(0, &MarkId::Condition(fifth))
        .unwrap();
    secondary_click(&mut window, at);
    let pair = gdcm::gui::views::net_gain_pairs::net_gain_pairs(state(&window))[0];
    let result = state(&window).analysis().unwrap().condition(fifth).unwrap();
    let expected = result.correction.net_gain(pair);
    ask(&mut window, "Net gain, condition 5", expected);
}

#[test]
fn a_dot_of_a_channel_says_how_gain_and_schedule_were_computed() {
    let mut window = window();
    show(&mut window, View::Channels);
    let seventh = ConditionId(7);
    let at = state(&window)
        .display
        .gains
        .channels
        .outputs
        .screen_position(2, &MarkId::Condition(seventh))
        .unwrap();
    let analysis = state(&window).analysis().unwrap();
    let gain = analysis.condition(seventh).unwrap().correction.output_gains[2];
    let airspeed_kt = analysis
        .study
        .dataset
        .condition(seventh)
        .unwrap()
        .flight_state()
        .airspeed_kt;
    let scheduled = analysis
        .schedule
        .as_ref()
        .unwrap()
        .at(airspeed_kt)
        .output_gains[2];
    secondary_click(&mut window, at);
    ask(&mut window, "Gain", gain);
    secondary_click(&mut window, at);
    ask(&mut window, "Scheduled gain", scheduled);
}

#[test]
fn a_bar_of_the_assessment_says_how_it_was_computed() {
    let mut window = window();
    show(&mut window, View::Assessment);
    wait_until(&mut window, "the assessment", |window| {
        state(window).assessment().is_some()
    });
    window.run_steps(2);
    let second = ConditionId(2);
    let foot = state(&window).display.figures[&View::Assessment]
        .position(0, [1.0, 0.0])
        .unwrap();
    secondary_click(&mut window, foot + egui::vec2(0.0, -3.0));
    let pair = state(&window)
        .dataset()
        .measuring_pairs()
        .marked()
        .next()
        .unwrap();
    let expected = state(&window)
        .assessment()
        .unwrap()
        .change(second, pair)
        .unwrap()
        .total();
    window.get_by_label("Change of J").click();
    window.run_steps(3);
    let asked = state(&window).display.selection.explained.clone();
    assert!(
        matches!(&asked, Some(ExplainTarget::CostChange(id, at, _)) if (*id, *at) == (second, pair)),
        "{asked:?}"
    );
    let found = derivation(state(&window).analysis().unwrap(), &asked.unwrap()).unwrap();
    assert!(
        (found.value - expected).abs() < 1e-9,
        "{} {expected}",
        found.value
    );
}

#[test]
fn a_curve_of_the_overview_is_pointed_at_isolated_and_rejected() {
    let mut window = window();
    show(&mut window, View::Overview);
    window.run_steps(2);
    let pair = pair(&window, "Q", "LON");
    let at = {
        let state = state(&window);
        let name = state
            .shown()
            .unwrap()
            .representative_name(BundleKind::Physics)
            .to_owned();
        let model = state
            .condition()
            .position(BundleKind::Physics, &name)
            .unwrap();
        let curves = state.responses().unwrap();
        let middle = curves.grid.omega().len() / 2;
        let db = 20.0 * curves.physics[model].curve(pair)[middle].norm().log10();
        state
            .display
            .frequency
            .overview
            .position_in(pair, curves.grid.omega()[middle].log10(), db)
            .unwrap()
    };
    window.hover_at(at);
    window.run_steps(2);
    let meant = state(&window)
        .display
        .selection
        .hovered
        .clone()
        .expect("a curve is under the pointer");
    secondary_click(&mut window, at);
    click(&mut window, "Isolate model");
    let isolated = state(&window)
        .display
        .selection
        .isolated
        .clone()
        .expect("one model is alone");
    give(&mut window, SelectionCommand::EndIsolation);
    secondary_click(&mut window, at);
    click(&mut window, "Reject model");
    assert!(
        state(&window).study.is_rejected(&isolated),
        "{isolated:?}, {meant:?}"
    );
    give(&mut window, StudyCommand::Undo);
    assert!(!state(&window).study.is_rejected(&isolated));
}

#[test]
fn every_table_of_a_view_is_saved_as_csv() {
    let mut window = window();
    let folder = tempfile::tempdir().unwrap();
    show(&mut window, View::NetGain);
    click(&mut window, "evidence");
    window
        .get_by_label("Sort Errors of each form of the schedule by left out [%]")
        .click_secondary();
    window.run_steps(2);
    window.get_by_label("Save the table as CSV…").click();
    window.run_steps(3);
    let path = folder.path().join("evidence.csv");
    let table = state(&window)
        .forms
        .table
        .clone()
        .expect("the form holds the table");
    window
        .state_mut()
        .dispatch(OutputCommand::SaveTable(table.clone(), path.clone()));
    settle(&mut window);
    let text = std::fs::read_to_string(path).unwrap();
    let rows = text.lines().filter(|line| !line.starts_with('#')).count();
    assert_eq!(rows, table.rows.len() + 1, "{text}");
    assert!(text.contains("left out"), "{text}");
}

#[test]
fn undo_after_each_command_restores_the_study_exactly() {
    let mut window = window();
    let mut decisions = 0;
    for entry in every_command(state(&window)) {
        if !entry.enabled
            || !stays_within(&entry.command)
            || matches!(
                entry.command,
                Action::Study(StudyCommand::Undo) | Action::Study(StudyCommand::Redo)
            )
        {
            continue;
        }
        let before = state(&window).study.clone();
        window.state_mut().dispatch(entry.command.clone());
        window.state_mut().dispatch(FormCommand::ShowForm(None));
        if state(&window).study == before {
            continue;
        }
        decisions += 1;
        let after = state(&window).study.clone();
        window.state_mut().dispatch(StudyCommand::Undo);
        assert_eq!(state(&window).study, before, "undo of {}", entry.name);
        window.state_mut().dispatch(StudyCommand::Redo);
        assert_eq!(state(&window).study, after, "redo of {}", entry.name);
        window.state_mut().dispatch(StudyCommand::Undo);
    }
    assert!(decisions > 60, "{decisions} commands decide something");
}
