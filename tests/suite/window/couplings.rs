//! Couplings by hand: looked at before they are used, offered, used, seen and undone (M16).

use gdcm::view::arrangement::View;
use gdcm::view::command::Command as Action;
use gdcm::view::views::{couplings_job, offered_couplings};
use gdcm_core::study::{CouplingCorrection, PhaseCorrection, setting};
use gdcm_files::figure::Mark;

use super::lists::texts_in;
use super::views::{give, show};
use super::*;

fn assessed(window: &mut Window) {
    wait_until(window, "what couplings do", |window| {
        let state = state(window);
        state.couplings(&couplings_job(state)).is_some() && !state.results.background.is_busy()
    });
}

fn texts(window: &Window) -> String {
    texts_in(window, egui::Rect::EVERYTHING).into_iter().map(|(text, _)| text).collect::<Vec<_>>().join("\n")
}

#[test]
fn couplings_are_looked_at_used_drawn_and_undone() {
    let mut window = window();
    let before = state(&window).study.clone();
    show(&mut window, View::Couplings);
    assessed(&mut window);
    let said = texts(&window);
    assert!(said.contains("None are used. What mixing and feedback would do:"), "{said}");
    assert!(said.contains("condition left out") && said.contains("Loop at the sticks"), "{said}");
    assert_eq!(state(&window).study, before, "looking decides nothing");
    click(&mut window, "Use mixing and feedback");
    settle(&mut window);
    assert_eq!(state(&window).study.settings.couplings, CouplingCorrection::MixingAndFeedback);
    assert!(!texts(&window).contains("None are used"));
    // The map beside the conditions has what they did off the axis.
    window.get_by_label_contains("19 responses not held, condition 1: mean J of magnitude");
    // The poles that move are drawn among those of the models.
    show(&mut window, View::Poles);
    wait_until(&mut window, "the poles", |window| gdcm::view::views::poles(state(window)).is_some());
    let figure = gdcm::view::views::poles(state(&window)).unwrap();
    let is_after =
        |mark: &Mark| matches!(mark, Mark::Dots(dots) if dots.name == "with couplings" && !dots.dots.is_empty());
    assert!(figure.plots[0].panels[0].marks.iter().any(is_after));
    // In Bode the corrected curve is the whole; couplings alone are there on wish.
    show(&mut window, View::Bode);
    settle(&mut window);
    let has_alone = |window: &Window| {
        let display = &state(window).display;
        let is_there = display.drawn.iter().any(|curve| curve.role == CurveRole::Coupled);
        is_there && !display.curves.hidden_roles.contains(&CurveRole::Coupled)
    };
    assert!(!has_alone(&window));
    click(&mut window, "Show couplings alone");
    assert!(has_alone(&window));
    give(&mut window, Action::Undo);
    assert_eq!(state(&window).study.settings, before.settings);
}

#[test]
fn couplings_are_offered_once_leads_do_what_a_channel_can() {
    let mut window = window();
    assert!(offered_couplings(state(&window)).is_none(), "nothing is computed before leads are used");
    give(&mut window, setting::PHASE.to(PhaseCorrection::Lead));
    assessed(&mut window);
    let (couplings, [without, with]) = offered_couplings(state(&window)).expect("worth it on the example (M16.5)");
    assert!(couplings == CouplingCorrection::MixingAndFeedback && with < 0.6 * without, "{without} {with}");
    click(&mut window, "Use couplings");
    settle(&mut window);
    assert_eq!(state(&window).study.settings.couplings, CouplingCorrection::MixingAndFeedback);
    assert!(offered_couplings(state(&window)).is_none());
}
