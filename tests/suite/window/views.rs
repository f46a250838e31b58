//! Contents of the views, tested through their controls.

use gdcm::gui::commands::command::Command as Action;
use gdcm::gui::commands::display::DisplayCommand;
use gdcm::gui::commands::layout::LayoutCommand;
use gdcm::gui::commands::selection::SelectionCommand;
use gdcm::gui::commands::study::StudyCommand;
use gdcm::gui::state::assessment_display::AssessedPairs;
use gdcm::gui::state::pair_set::PairSet;
use gdcm::gui::state::preferences::Preferences;
use gdcm::gui::state::view::{View, ViewGroup};
use gdcm::gui::state::view_arrangement::Arrangement;
use gdcm::gui::views::assessment_content::{assessment_sentences, assessment_text_table};
use gdcm::gui::views::net_gain_pairs::net_gain_pairs;
use gdcm::gui::views::poles::poles;
use gdcm_method::correction::Channel;
use gdcm_plot::figure::figure::DotShape;
use gdcm_plot::figure::{Mark, Panel};
use gdcm_study::results::assessment_table::AssessedModel;
use gdcm_study::{AcrossRole, Analysis, AssessedCorrection, Edit};
use gdcm_words::ExplainTarget;
use gdcm_words::derivation::derivation;
use gdcm_words::uncertainty::difference_verdict;

use super::plots::across_curves;
use super::*;

pub(super) fn give(window: &mut Window, command: impl Into<Action>) {
    window.state_mut().dispatch(command);
    settle(window);
}

pub(super) fn show(window: &mut Window, view: View) {
    give(window, LayoutCommand::ShowView(view));
    assert!(
        state(window).display.layout.arrangement.is_shown(view),
        "{view:?}"
    );
}

#[test]
fn every_view_has_a_tab_and_a_click_brings_it_to_the_front() {
    let mut window = window();
    for group in ViewGroup::ALL {
        click(&mut window, &format!("Views: {}", group.name()));
        for view in group.views() {
            // Titles of views have the same words.
            window.get_by_role_and_label(Role::Tab, view.name()).click();
            settle(&mut window);
            assert_eq!(state(&window).display.layout.arrangement.view(), view);
        }
    }
}

#[test]
fn controls_of_plots_side_by_side_have_names_of_their_own() {
    let mut window = window();
    for beside in [View::Error, View::Across] {
        give(&mut window, LayoutCommand::ShowBeside(Some(beside)));
        wait_until(&mut window, "the responses", |window| {
            beside == View::Error || state(window).across().is_some()
        });
        for name in [
            "Frequency axis",
            "Value axis",
            "Lower end of the band",
            "Upper end of the band",
        ] {
            let labels: Vec<String> = window
                .query_all_by_label_contains(name)
                .filter_map(|node| node.accesskit_node().label())
                .collect();
            let unique: std::collections::BTreeSet<&String> = labels.iter().collect();
            assert_eq!(unique.len(), labels.len(), "{labels:?}");
            assert!(labels.len() >= 2, "{name}: {labels:?}");
        }
    }
}

#[test]
fn an_arrangement_is_remembered_and_one_command_resets_it() {
    let mut window = window();
    give(&mut window, LayoutCommand::ShowBeside(Some(View::Poles)));
    let kept = Preferences::from_display(&state(&window).display);
    let mut other = window_with(
        example(),
        Setup {
            preferences: kept,
            ..Setup::default()
        },
    );
    assert_eq!(
        state(&other).display.layout.arrangement,
        state(&window).display.layout.arrangement
    );
    give(&mut other, LayoutCommand::ResetLayout);
    assert_eq!(
        state(&other).display.layout.arrangement,
        Arrangement::default()
    );
}

#[test]
fn a_click_on_a_pole_rejects_its_model_and_the_modes_are_listed() {
    let mut window = window();
    show(&mut window, View::Poles);
    wait_until(&mut window, "the modes", |window| {
        state(window).modes().is_some()
    });
    let figure = poles(state(&window)).expect("the modes are known");
    let marks: Vec<[f64; 2]> = figure.plots[0].panels[0]
        .dots()
        .map(|dot| [dot.x, dot.y])
        .collect();
    let condition = state(&window).condition();
    let order: usize = BundleKind::BOTH
        .into_iter()
        .flat_map(|kind| condition.bundle(kind))
        .filter_map(|model| model.order())
        .sum();
    assert_eq!(marks.len(), order, "a mark for each state of each model");
    let table = &state(&window).display.poles.modes.table;
    // The table has a row for each real pole and for each pair of complex poles of the reference
    // model.
    let reference = condition.model(
        BundleKind::Physics,
        state(&window)
            .shown()
            .unwrap()
            .representative_name(BundleKind::Physics),
    );
    assert!(!table.rows.is_empty() && table.rows.len() <= reference.unwrap().order().unwrap());
    let names: Vec<&str> = table.rows.iter().map(|row| row[0].as_str()).collect();
    for name in ["phugoid", "Dutch roll", "spiral"] {
        assert_eq!(
            names.iter().filter(|of| **of == name).count(),
            1,
            "{name} in {names:?}"
        );
    }

    // The fastest pole of a perturbed model is far from other marks.
    let fastest = marks.iter().min_by(|a, b| a[0].total_cmp(&b[0])).unwrap();
    let at = state(&window).display.figures[&View::Poles]
        .position(0, *fastest)
        .unwrap();
    window.hover_at(at);
    window.run_steps(2);
    let meant = state(&window)
        .display
        .selection
        .hovered
        .clone()
        .expect("the pole is pointed at");
    window.drag_at(at);
    window.drop_at(at);
    settle(&mut window);
    assert!(state(&window).study.is_rejected(&meant), "{meant:?}");
    give(&mut window, StudyCommand::Undo);
    assert!(!state(&window).study.is_rejected(&meant));
}

#[test]
fn zeros_of_the_response_in_focus_are_shown_on_wish() {
    fn zeros(window: &Window) -> usize {
        let figure = poles(state(window)).expect("the modes are known");
        let of = |mark: &Mark| {
            if let Mark::Dots(dots) = mark {
                usize::from(dots.shape == DotShape::Circle) * dots.dots.len()
            } else {
                0
            }
        };
        figure.plots[0].panels[0]
            .marks
            .iter()
            .map(of)
            .sum::<usize>()
    }

    let mut window = window();
    show(&mut window, View::Poles);
    wait_until(&mut window, "the modes", |window| {
        state(window).modes().is_some()
    });
    assert_eq!(zeros(&window), 0);
    let name = format!(
        "zeros of {}",
        state(&window)
            .dataset()
            .pair_name(state(&window).display.selection.pair)
    );
    click(&mut window, &name);
    assert!(zeros(&window) > 0);
}

#[test]
fn one_response_of_every_condition_is_laid_over_the_others_whichever_model_it_is_of() {
    let mut window = window();
    show(&mut window, View::Across);
    wait_until(&mut window, "the responses", |window| {
        state(window).across().is_some()
    });
    for role in AcrossRole::ALL {
        give(&mut window, DisplayCommand::ShowAcrossAlone(role));
        let curves = across_curves(&window);
        assert_eq!(curves.responses.len(), 11, "{}", role.name());
    }
}

#[test]
fn freeing_a_response_does_not_take_its_net_gains_away() {
    let mut window = window();
    let before = net_gain_pairs(state(&window));
    click(&mut window, "Hold LON → Q");
    assert_eq!(net_gain_pairs(state(&window)), before);
    let lon_q = pair(&window, "Q", "LON");
    assert!(before.contains(&lon_q) && !state(&window).study.settings.constrained[lon_q]);
    give(&mut window, DisplayCommand::ShowNetGains(PairSet::All));
    assert_eq!(net_gain_pairs(state(&window)).len(), 24);
    give(&mut window, DisplayCommand::PickPair(lon_q));
    assert_eq!(net_gain_pairs(state(&window)), [lon_q]);
}

#[test]
fn a_click_on_a_dot_with_ctrl_takes_its_condition_out_of_the_schedule() {
    let mut window = window();
    let fifth = ConditionId(5);
    let at = state(&window).display.figures[&View::NetGain]
        .screen_position(0, &MarkId::Condition(fifth))
        .unwrap();
    window.hover_at(at);
    window.run_steps(1);
    let press = |pressed| Event::PointerButton {
        pos: at,
        button: PointerButton::Primary,
        pressed,
        modifiers: Modifiers::COMMAND,
    };
    window.event_modifiers(press(true), Modifiers::COMMAND);
    window.event_modifiers(press(false), Modifiers::COMMAND);
    settle(&mut window);
    assert!(!state(&window).study.choice(fifth).scheduled);
    assert_eq!(state(&window).analysis().unwrap().scheduled().len(), 10);
}

#[test]
fn a_degree_is_chosen_on_evidence() {
    let mut window = window();
    show(&mut window, View::NetGain);
    let before = state(&window).study.clone();
    click(&mut window, "evidence");
    let evidence = state(&window).analysis().unwrap().compare_forms().unwrap();
    let cached = &state(&window).display.gains.evidence;
    let (conditions, shown) = cached.found.as_ref().expect("the evidence is there");
    assert_eq!(conditions.len(), 11);
    assert_eq!(shown, &evidence);
    click(
        &mut window,
        "Sort Errors of each form of the schedule by left out [%]",
    );
    assert_eq!(state(&window).study, before, "sorting decides nothing");
    assert!(!state(&window).unsaved);
}

#[test]
fn the_evidence_answers_which_differences_are_in_earnest() {
    let mut window = window_with(Opened::Dataset(crate::REFERENCE_DATASET.clone()), warm());
    show(&mut window, View::Evidence);
    wait_for_bars(&mut window);
    // Independent numpy code gives a ratio of 5.39. It also rejects the suggested models of
    // condition 10, which does not affect conditions 3 and 5.
    let uncertainty = state(&window).uncertainty().unwrap();
    let conditions = [ConditionId(3), ConditionId(5)];
    let heave = pair(&window, "NZ", "COL");
    let difference = uncertainty
        .differences
        .iter()
        .find(|difference| difference.conditions == conditions && difference.pair == heave)
        .unwrap();
    assert!(difference.is_significant(uncertainty.level));
    assert!((difference.difference.ratio().unwrap() - 5.39).abs() < 0.05);
    let verdict = difference_verdict(difference, uncertainty.level);
    assert!(
        window.query_all_by_label_contains(verdict).next().is_some(),
        "{verdict}"
    );
    let line = window.get_by_label("5.4 × expected").rect();
    for words in ["COL → NZ", "conditions 3 and 5 (45 kt)", "13 %"] {
        let is_beside = |place: egui::Rect| (place.center().y - line.center().y).abs() < 2.0;
        assert!(
            window
                .query_all_by_label(words)
                .any(|node| is_beside(node.rect())),
            "{words} at {line}"
        );
    }
    let split = window
        .query_by_label_contains("LON → Q at equal airspeed: ")
        .is_some();
    assert!(
        split,
        "what the scatter is made of has a line for each response"
    );
    let uncertainty = state(&window).uncertainty().unwrap();
    assert_eq!(
        uncertainty.differences.len(),
        35,
        "five responses, seven pairs of conditions"
    );
}

#[test]
fn error_bars_come_beside_the_answer_and_can_be_switched_off() {
    fn panels(window: &Window) -> Vec<Panel> {
        let plots = gdcm::gui::views::net_gain::net_gain_plots(state(window))
            .figure
            .plots;
        plots.into_iter().flat_map(|plot| plot.panels).collect()
    }

    fn has_bars(panel: &Panel) -> bool {
        let of = |mark: &Mark| matches!(mark, Mark::Intervals(bars) if bars.ends.len() == panel.dots().count());
        panel.marks.iter().any(of)
    }

    fn has_bands(panel: &Panel) -> bool {
        panel
            .marks
            .iter()
            .any(|mark| matches!(mark, Mark::Envelope(_)))
    }

    fn significant(mark: &Mark) -> bool {
        matches!(mark, Mark::Brackets(of) if of.brackets.iter().any(|bracket| !bracket.label.is_empty()))
    }

    let mut window = window();
    show(&mut window, View::NetGain);
    wait_for_bars(&mut window);
    let shown = panels(&window);
    assert!(
        shown
            .iter()
            .all(|panel| has_bars(panel) && has_bands(panel))
    );
    assert!(
        shown
            .iter()
            .any(|panel| panel.marks.iter().any(significant))
    );
    click(&mut window, "error bars");
    let bare = panels(&window);
    assert!(
        bare.iter()
            .all(|panel| !has_bars(panel) && !has_bands(panel))
    );
}

#[test]
fn a_condition_that_is_held_out_leaves_the_schedule_and_judges_it() {
    let mut window = window();
    let held_out = ConditionId(3);
    let edit = Edit::SetHeldOut {
        condition: held_out,
        held_out: true,
    };
    window.state_mut().dispatch(edit);
    settle(&mut window);
    let analysis = state(&window).analysis().unwrap();
    assert_eq!(
        (analysis.scheduled().len(), analysis.conditions.len()),
        (10, 11)
    );
    show(&mut window, View::Assessment);
    let choice = state(&window).assessment_choice();
    let words =
        gdcm_words::assessment::held_out_verdict(state(&window).analysis().unwrap(), choice)
            .unwrap();
    assert!(words.contains("(3)"), "{words}");
}

#[test]
fn an_assessment_can_be_had_for_every_model_correction_and_response() {
    fn wait(window: &mut Window) {
        wait_until(window, "the assessment", |window| {
            state(window).assessment().is_some()
        });
    }

    let mut window = window();
    show(&mut window, View::Assessment);
    wait(&mut window);
    let table = state(&window).assessment().unwrap();
    let summary = &assessment_sentences(state(&window), table)[0];
    assert!(summary.contains(|letter: char| letter.is_ascii_digit()));
    let mut figures = state(&window).display.judging.assessed;
    figures.model = AssessedModel::Representative;
    figures.correction = AssessedCorrection::Own;
    figures.pairs = AssessedPairs::All;
    figures.as_table = true;
    give(&mut window, DisplayCommand::Assess(figures));
    wait(&mut window);
    let shown = state(&window);
    let table = shown.assessment().unwrap();
    let text = assessment_text_table(shown, table);
    assert_eq!((text.rows.len(), text.columns.len()), (24, 12));
    // J of the condition's own correction, as shown in the matrix.
    let condition = shown.condition().id();
    let lon_q = pair(&window, "Q", "LON");
    let own = shown.shown().unwrap().cost[lon_q].unwrap();
    let change = table.change(condition, lon_q).unwrap();
    assert!(
        (change.total() - own.total()).abs() < 1e-9,
        "the same figure, computed twice"
    );
}

#[test]
fn variants_are_kept_compared_taken_and_removed_and_undo_brings_each_back() {
    let mut window = window();
    show(&mut window, View::Compare);
    let before = state(&window).study.clone();
    window.get_by_label("Name of the variant").focus();
    window.run_steps(2);
    window
        .get_by_label("Name of the variant")
        .type_text("as it was");
    window.run_steps(2);
    click(&mut window, "Keep as variant");
    assert_eq!(state(&window).study.variants.len(), 1);
    let kept = state(&window).study.clone();
    click(&mut window, "Hold LON → Q");
    wait_until(&mut window, "the variant's analysis", |window| {
        state(window).results.variants.len() == 1
    });
    let (_, analysis) = &state(&window).results.variants[0];
    assert_eq!(analysis.study.settings, before.settings);
    click(&mut window, "Use variant as it was");
    assert_eq!(state(&window).study.settings, before.settings);
    give(&mut window, StudyCommand::Undo);
    assert_ne!(state(&window).study.settings, before.settings);
    give(&mut window, StudyCommand::Undo);
    assert_eq!(state(&window).study, kept);
    click(&mut window, "Remove variant as it was");
    assert!(state(&window).study.variants.is_empty());
    give(&mut window, StudyCommand::Undo);
    assert_eq!(state(&window).study, kept);
    give(&mut window, StudyCommand::Undo);
    assert_eq!(state(&window).study, before);
}

#[test]
fn a_variant_is_laid_over_bode_and_net_gain_until_that_is_taken_back() {
    fn curve_value(window: &Window, role: CurveRole) -> Option<f64> {
        let drawn = &state(window).display.frequency.drawn;
        drawn
            .iter()
            .find(|curve| curve.role == role)
            .map(|curve| curve.magnitude_db[0])
    }

    fn has_key(window: &Window) -> bool {
        let figure = gdcm::gui::views::net_gain::net_gain_plots(state(window)).figure;
        figure.plots[0].panels[0]
            .marks
            .iter()
            .any(|mark| matches!(mark, Mark::Dots(dots) if dots.name == "variant as it was"))
    }

    let mut window = window();
    give(
        &mut window,
        Edit::StoreVariant {
            name: "as it was".to_owned(),
        },
    );
    click(&mut window, "Hold LON → Q");
    show(&mut window, View::Compare);
    click(&mut window, "Overlay variant as it was");
    show(&mut window, View::Bode);
    let lon_q = pair(&window, "Q", "LON");
    give(&mut window, SelectionCommand::FocusPair(lon_q));
    wait_until(&mut window, "the variant's curve", |window| {
        curve_value(window, CurveRole::Variant).is_some()
    });
    let condition = state(&window).condition().id();
    let held = |analysis: &Analysis| {
        analysis
            .condition(condition)
            .unwrap()
            .correction
            .net_gain(lon_q)
    };
    let (_, variant) = &state(&window).results.variants[0];
    let ratio_db = 20.0 * (held(variant) / held(state(&window).analysis().unwrap())).log10();
    let drawn_db = curve_value(&window, CurveRole::Variant).unwrap()
        - curve_value(&window, CurveRole::Corrected).unwrap();
    assert!(
        ratio_db.abs() > 1e-3 && (drawn_db - ratio_db).abs() < 1e-9,
        "{drawn_db} dB drawn, {ratio_db} dB"
    );
    assert!(has_key(&window));
    show(&mut window, View::Compare);
    click(&mut window, "Overlay variant as it was");
    assert!(!has_key(&window) && state(&window).display.judging.overlaid.is_none());
}

#[test]
fn a_condition_pointed_at_in_the_list_is_lit_among_the_dots() {
    let mut window = window();
    let row = window.get_by_label_contains("Condition 3: ").rect();
    window.hover_at(row.left_center() + vec2(30.0, 0.0));
    window.run_steps(3);
    assert_eq!(
        state(&window).display.selection.hovered_condition,
        Some(ConditionId(3))
    );
    window.hover_at(pos2(800.0, 5.0));
    window.run_steps(3);
    assert_eq!(state(&window).display.selection.hovered_condition, None);
}

#[test]
fn a_double_click_on_its_edge_puts_a_panel_back() {
    fn edge(window: &Window) -> f32 {
        window.get_by_label("Export corrections…").rect().left()
    }

    let mut window = window();
    // In the test harness, frames are 0.25 s apart, so that a double click needs a longer delay.
    window
        .ctx
        .options_mut(|options| options.input_options.max_double_click_delay = 5.0);
    let before = edge(&window);
    let y = 500.0;
    // The edge of the result panel is a few points left of its content.
    let at = pos2((1600.0_f32 - 352.0).round(), y);
    window.drag_at(at);
    window.run_steps(2);
    window.hover_at(at - vec2(60.0, 0.0));
    window.run_steps(2);
    window.drop_at(at - vec2(60.0, 0.0));
    settle(&mut window);
    assert!(
        (before - edge(&window) - 60.0).abs() < 4.0,
        "{before} {}",
        edge(&window)
    );
    for _ in 0..2 {
        window.drag_at(at - vec2(60.0, 0.0));
        window.drop_at(at - vec2(60.0, 0.0));
    }
    settle(&mut window);
    assert!(
        (before - edge(&window)).abs() < 1.0,
        "{before} {}",
        edge(&window)
    );
}

#[test]
fn a_figure_says_how_it_was_computed_and_follows_the_results() {
    let mut window = window();
    let condition = state(&window).condition().id();
    let asked = ExplainTarget::Gain(condition, Channel::Input(0));
    give(&mut window, SelectionCommand::Explain(Some(asked.clone())));
    let title = derivation(state(&window).analysis().unwrap(), &asked)
        .unwrap()
        .title;
    assert!(window.query_by_label(&title).is_some(), "{title}");
    click(&mut window, "Copy the derivation");
    give(&mut window, Edit::ConstrainOnAxis);
    give(&mut window, SelectionCommand::Explain(None));
    assert!(window.query_by_label("Copy the derivation").is_none());
}
