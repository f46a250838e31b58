//! Couplings in the window: shown before they are used, proposed, used and undone (M16).

use gdcm::gui::commands::display::DisplayCommand;
use gdcm::gui::commands::layout::LayoutCommand;
use gdcm::gui::commands::study::StudyCommand;
use gdcm::gui::panels::cost_map::cost_of;
use gdcm::gui::panels::verdict::Verdict;
use gdcm::gui::state::mapped_cost::MappedCost;
use gdcm::gui::state::sheet::Sheet;
use gdcm::gui::state::view::View;
use gdcm::gui::views::figures::figure_of;
use gdcm::gui::views::offered_couplings;
use gdcm::gui::views::shown_remarks::used_coupling_remarks;
use gdcm_model::dataset::ConditionId;
use gdcm_plot::figure::Mark;
use gdcm_study::decisions::setting_table;
use gdcm_study::{CouplingCorrection, Edit, PhaseCorrection};
use gdcm_words::coupling_remark::coupling_remark_text;

use super::lists::texts_in;
use super::views::{give, show};
use super::*;

fn assessed(window: &mut Window) {
    wait_until(window, "what couplings do", |window| {
        let state = state(window);
        state.couplings().is_some() && !state.results.background.is_busy()
    });
}

/// Returns whether the assessed couplings are those in use.
fn is_in_use(window: &Window) -> bool {
    gdcm::gui::views::used_couplings(state(window)).is_some()
}

fn texts(window: &Window) -> String {
    texts_in(window, egui::Rect::EVERYTHING)
        .into_iter()
        .map(|(text, _)| text)
        .collect::<Vec<_>>()
        .join("\n")
}

/// Returns whether the window contains this sentence; in a scrolled list it may be out of sight.
fn is_listed(window: &Window, words: &str) -> bool {
    window.query_all_by_label(words).next().is_some()
}

#[test]
fn couplings_are_looked_at_used_drawn_and_undone() {
    fn is_after(mark: &Mark) -> bool {
        matches!(mark, Mark::Dots(dots) if dots.name == "with couplings" && !dots.dots.is_empty())
    }

    fn has_alone(window: &Window) -> bool {
        let display = &state(window).display;
        let is_there = display
            .frequency
            .drawn
            .iter()
            .any(|curve| curve.role == CurveRole::Coupled);
        is_there && !display.curves.hidden_roles.contains(&CurveRole::Coupled)
    }

    let mut window = few_window();
    let before = state(&window).study.clone();
    show(&mut window, View::Couplings);
    assessed(&mut window);
    let assessment = state(&window).couplings().unwrap().as_ref().unwrap();
    assert_eq!(assessment.couplings, CouplingCorrection::MixingAndFeedback);
    assert!(!is_in_use(&window));
    let figure = figure_of(state(&window), View::Couplings).unwrap();
    assert!(texts(&window).contains(&figure.plots[0].title));
    assert_eq!(state(&window).study, before, "looking decides nothing");
    give(&mut window, DisplayCommand::MapCost(MappedCost::Before));
    let as_it_is =
        |window: &Window| cost_of(state(window), ConditionId(3), pair(window, "P", "LON"));
    let uncoupled = as_it_is(&window);
    click(&mut window, "Use mixing and feedback");
    settle(&mut window);
    assert!(
        uncoupled.is_some() && as_it_is(&window) == uncoupled,
        "J before any correction is without couplings too"
    );
    assert_eq!(
        state(&window).study.settings.couplings,
        CouplingCorrection::MixingAndFeedback
    );
    assert!(is_in_use(&window));
    // The map beside the conditions shows their off-axis cost.
    window.get_by_label_contains("19 responses not held, condition 3");
    // The shifted poles are drawn among the poles of the models.
    show(&mut window, View::Poles);
    wait_until(&mut window, "the poles", |window| {
        gdcm::gui::views::poles::poles(state(window)).is_some()
    });
    let figure = gdcm::gui::views::poles::poles(state(&window)).unwrap();
    assert!(figure.plots[0].panels[0].marks.iter().any(is_after));
    // In the Bode view, the corrected curve contains the complete correction; a curve with the
    // couplings alone is optional.
    show(&mut window, View::Bode);
    settle(&mut window);
    assert!(!has_alone(&window));
    click(&mut window, "Show couplings alone");
    assert!(has_alone(&window));
    give(&mut window, StudyCommand::Undo);
    assert_eq!(state(&window).study.settings, before.settings);
}

#[test]
fn couplings_are_offered_once_leads_do_what_a_channel_can() {
    let mut window = window();
    assert!(
        offered_couplings(state(&window)).is_none(),
        "nothing is computed before leads are used"
    );
    give(&mut window, setting_table::PHASE.to(PhaseCorrection::Lead));
    assessed(&mut window);
    let (offered, cost) =
        offered_couplings(state(&window)).expect("worth it on the example (M16.5)");
    let [with, without] = [cost.with, cost.without].map(|of| of.others.unwrap());
    assert!(
        offered.couplings == CouplingCorrection::MixingAndFeedback && with < 0.6 * without,
        "{without} {with}"
    );
    click(&mut window, "Use couplings");
    settle(&mut window);
    assert_eq!(
        state(&window).study.settings.couplings,
        CouplingCorrection::MixingAndFeedback
    );
    assert!(offered_couplings(state(&window)).is_none());
    // The cost of the couplings is listed among the reasons, in every view.
    assessed(&mut window);
    give(&mut window, LayoutCommand::ShowSheet(Some(Sheet::Reasons)));
    let codes = remark_codes(&window);
    assert!(
        codes.contains(&"change-above-band") && codes.contains(&"newly-unstable"),
        "{codes:?}"
    );
    for remark in used_coupling_remarks(state(&window)) {
        let words = coupling_remark_text(&remark, state(&window).dataset());
        assert!(is_listed(&window, &words), "{words}");
    }
}

#[test]
fn couplings_that_cannot_be_found_are_told_beside_the_verdict() {
    let mut window = few_window();
    let ids: Vec<ConditionId> = state(&window)
        .dataset()
        .conditions()
        .iter()
        .map(|of| of.id())
        .collect();
    ids.iter().for_each(|&condition| {
        give(
            &mut window,
            Edit::SetHeldOut {
                condition,
                held_out: true,
            },
        )
    });
    give(
        &mut window,
        setting_table::COUPLINGS.to(CouplingCorrection::Mixing),
    );
    settle(&mut window);
    let caution = Verdict::new(state(&window)).caution.unwrap();
    assert_eq!(caution.code, "no-couplings");
    assert!(texts(&window).contains(&caution.text), "{}", caution.text);
    give(&mut window, LayoutCommand::ShowSheet(Some(Sheet::Reasons)));
    let remarks = used_coupling_remarks(state(&window));
    assert_eq!(remarks.len(), 1);
    assert_eq!(remarks[0].code(), "no-couplings");
    let words = coupling_remark_text(&remarks[0], state(&window).dataset());
    assert!(is_listed(&window, &words), "{words}");
}
