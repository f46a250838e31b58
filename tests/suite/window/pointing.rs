//! Texts for the element under the pointer: in the status bar for plots, in small tooltips for
//! lists.

use std::collections::BTreeSet;

use egui::Order;

use gdcm::gui::plot::overview_scene::OverviewView;

use super::views::{give, show};
use super::*;

/// Rests the pointer at a position for longer than any tooltip delay.
pub(super) fn rest_at(window: &mut Window, at: Pos2) {
    // The pointer starts elsewhere, so that no earlier tooltip is open.
    window.hover_at(pos2(3.0, 3.0));
    window.run_steps(3);
    window.hover_at(at);
    window.run_steps(10);
}

/// Returns the rectangles of the open tooltips.
pub(super) fn tooltips(window: &Window) -> Vec<egui::Rect> {
    let layers = window
        .ctx
        .memory(|memory| memory.areas().visible_layer_ids());
    let open = layers
        .into_iter()
        .filter(|layer| layer.order == Order::Tooltip);
    open.filter_map(|layer| window.ctx.memory(|memory| memory.area_rect(layer.id)))
        .collect()
}

/// Asserts that pointing at a plot mark opens no tooltip, and that the status bar describes the
/// mark.
fn assert_told(window: &mut Window, what: &str, at: Pos2) {
    rest_at(window, at);
    let told = state(window).display.selection.pointed_words.clone();
    let told = told.unwrap_or_else(|| panic!("{what}: nothing is said at {at}"));
    assert_eq!(tooltips(window), [], "{what}: {told}");
    let is_in_status_line = window
        .query_all_by_label(&told)
        .any(|line| line.rect().top() > 970.0);
    assert!(is_in_status_line, "{what}: {told}");
}

#[test]
fn pointing_at_a_curve_or_a_dot_opens_nothing_and_is_told_in_the_status_line() {
    fn dot(window: &Window, view: View) -> egui::Pos2 {
        let id = MarkId::Condition(ConditionId(3));
        state(window).display.figures[&view]
            .screen_position(0, &id)
            .expect("its dot is drawn")
    }

    let mut window = window();
    choose_condition_10(&mut window);
    let nominal = super::plots::place_on_nominal(&window);
    assert_told(&mut window, "Bode", nominal);
    let told = state(&window)
        .display
        .selection
        .pointed_words
        .clone()
        .unwrap();
    assert!(
        told.contains("nominal · ") && told.contains("reject"),
        "{told}"
    );

    let net_gain = dot(&window, View::NetGain);
    assert_told(&mut window, "Net gain", net_gain);
    assert!(
        state(&window)
            .display
            .selection
            .pointed_words
            .as_ref()
            .unwrap()
            .starts_with("condition 3, 45 kt · ")
    );

    show(&mut window, View::Overview);
    let pair = pair(&window, "Q", "LON");
    let cell =
        OverviewView::screen_position(&state(&window).display.frequency.overview, pair).unwrap();
    assert_told(&mut window, "Overview", cell);

    show(&mut window, View::Poles);
    wait_until(&mut window, "the modes", |window| {
        state(window).modes().is_some()
    });
    window.run_steps(2);
    let figure = gdcm::gui::views::poles::poles(state(&window)).expect("the modes are known");
    let fastest = figure.plots[0].panels[0]
        .dots()
        .map(|dot| [dot.x, dot.y])
        .min_by(|a, b| a[0].total_cmp(&b[0]));
    let pole = state(&window).display.figures[&View::Poles]
        .position(0, fastest.unwrap())
        .unwrap();
    assert_told(&mut window, "Poles", pole);
}

#[test]
fn marked_frequencies_are_named_over_the_plot_and_not_over_its_curves() {
    let mut window = window();
    choose_condition_10(&mut window);
    let marks = vec![("ω180", 4.0)];
    give(
        &mut window,
        gdcm::gui::plot::curve_command::CurveCommand::MarkCrossings(marks),
    );
    let chip = window.get_by_label_contains("ω180 4.0").rect();
    let frame = *state(&window)
        .display
        .frequency
        .bode
        .transform(Pane::Magnitude)
        .unwrap()
        .frame();
    assert!(chip.bottom() < frame.top(), "{chip} over {frame}");
    window.get_by_label_contains("ω180 4.0").click();
    settle(&mut window);
    assert!(
        state(&window).display.curves.crossings.is_empty(),
        "a click takes the marks away"
    );
}

/// Returns the number of text lines in the tooltip that opens at a position.
fn lines_of_tooltip(window: &mut Window, at: Pos2) -> usize {
    fn labels(window: &Window) -> BTreeSet<String> {
        let nodes = window.query_all_by_role(Role::Label);
        nodes
            .map(|node| format!("{:?} {}", node.accesskit_node().label(), node.rect()))
            .collect()
    }

    window.hover_at(pos2(3.0, 3.0));
    window.run_steps(3);
    let before = labels(window);
    rest_at(window, at);
    let open = tooltips(window);
    let [place] = open[..] else {
        panic!("one tooltip: {open:?}")
    };
    // Texts below the tooltip existed before it was opened.
    let is_new =
        |label: &Option<String>, rect: egui::Rect| !before.contains(&format!("{label:?} {rect}"));
    let nodes = window.query_all_by_role(Role::Label);
    let texts = nodes.map(|node| (node.accesskit_node().label(), node.rect()));
    let inside = texts
        .filter(|(label, rect)| place.expand(1.0).contains_rect(*rect) && is_new(label, *rect));
    let lines: BTreeSet<i64> = inside
        .map(|(_, rect)| rect.center().y.round() as i64)
        .collect();
    lines.len()
}

#[test]
fn a_tooltip_has_a_name_and_four_rows_at_most() {
    fn place(window: &Window, label: &str) -> egui::Rect {
        window.get_by_label(label).rect()
    }

    let mut window = window();
    choose_condition_10(&mut window);
    // A model whose tooltip has every entry: trim, ratio, distance, and reason for its rejection.
    let reject = gdcm_study::Edit::RejectBecause {
        model: ModelId::new(ConditionId(10), BundleKind::Physics, "V+10kt"),
        reason: "a step near this trim".to_owned(),
    };
    give(&mut window, reject);
    let model = place(&window, "physics model V+10kt");
    let lines = lines_of_tooltip(&mut window, pos2(model.left() + 60.0, model.center().y));
    assert!((3..=5).contains(&lines), "{lines} lines about a model");
    // The card below the matrix has the rows of the response in focus.
    let focused = place(&window, "Response LON → Q");
    rest_at(&mut window, focused.left_bottom() + vec2(8.0, -6.0));
    assert_eq!(tooltips(&window), [], "no second card of the same response");
    let cell = place(&window, "Response LAT → P");
    let lines = lines_of_tooltip(&mut window, cell.left_bottom() + vec2(8.0, -6.0));
    // The column headings add a line.
    assert!((5..=6).contains(&lines), "{lines} lines about a response");
    let condition = place(&window, CONDITION_10);
    let lines = lines_of_tooltip(&mut window, condition.left_center() + vec2(6.0, 0.0));
    assert!((2..=5).contains(&lines), "{lines} lines about a condition");
}

#[test]
fn what_a_tooltip_does_not_say_is_behind_the_question() {
    use gdcm_words::ExplainTarget;
    use gdcm_words::derivation::derivation;
    let window = window();
    let id = ModelId::new(ConditionId(10), BundleKind::Physics, "V+10kt");
    let found = derivation(
        state(&window).analysis().unwrap(),
        &ExplainTarget::Score(id),
    )
    .unwrap();
    assert!(
        found
            .rests_on
            .iter()
            .any(|words| words.ends_with(" states")),
        "{:?}",
        found.rests_on
    );
    let text = gdcm::gui::panels::derivation_sheet::derivation_text(&found);
    for (symbol, meaning) in found.terms() {
        assert!(
            text.contains(&format!("{symbol}\t{meaning}")),
            "{symbol} in {text}"
        );
    }
}

#[test]
fn the_cell_under_the_pointer_keeps_how_sure_its_gain_is() {
    fn bars(window: &Window) -> usize {
        let cell = window.get_by_label("Response LON → Q").rect();
        let texts = window
            .output()
            .shapes
            .iter()
            .filter_map(|clipped| match &clipped.shape {
                egui::Shape::Text(text) if cell.contains(text.pos) => {
                    Some(text.galley.text().to_owned())
                }
                _ => None,
            });
        texts.filter(|text| text.starts_with('±')).count()
    }

    let mut window = window();
    wait_for_bars(&mut window);
    window.run_steps(3);
    let before = bars(&window);
    assert_eq!(before, 2, "of the gain and of the delay");
    let cell = window.get_by_label("Response LON → Q").rect();
    window.hover_at(cell.left_bottom() + vec2(8.0, -6.0));
    window.run_steps(2);
    assert_eq!(bars(&window), before);
}

/// Asserts that the tooltip of a row covers none of the rows.
pub(super) fn assert_beside_rows(window: &mut Window, pointed: &str, rows: &[String]) {
    let place = window.get_by_label(pointed).rect();
    rest_at(window, place.center());
    let open = tooltips(window);
    assert_eq!(open.len(), 1, "tooltip of {pointed}");
    for row in rows {
        let place = window.get_by_label(row).rect();
        assert!(
            !open[0].intersects(place.shrink(1.0)),
            "{row}: {open:?} {place}"
        );
    }
}

#[test]
fn the_tooltip_of_a_condition_or_a_model_covers_no_other_row() {
    let mut window = window();
    let mut conditions = Vec::new();
    for condition in state(&window).dataset().conditions() {
        let name = &condition.flight_state().name;
        conditions.push(format!("Condition {}: {name}", condition.id()));
    }
    assert_beside_rows(&mut window, &conditions[2].clone(), &conditions);
    let models = ["nominal", "V+5kt", "V+10kt"].map(|name| format!("physics model {name}"));
    assert_beside_rows(&mut window, &models[0].clone(), &models);
}
