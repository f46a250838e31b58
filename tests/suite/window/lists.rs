//! Legibility of texts in the lists.

use gdcm::gui::commands::layout::LayoutCommand;
use gdcm::gui::commands::selection::SelectionCommand;
use gdcm::gui::state::sheet::Sheet;
use gdcm_study::Edit;

use super::views::give;
use super::*;

/// Opens a window of minimum width.
fn narrow_window(height: f32) -> Window {
    let mut window = Harness::builder()
        .with_size(vec2(900.0, height))
        .build_eframe(cold_example);
    settle(&mut window);
    window
}

/// Returns the texts painted in the last frame inside `area`, with their rectangles; texts covered
/// by a sheet are omitted.
pub(super) fn texts_in(window: &Window, area: egui::Rect) -> Vec<(String, egui::Rect)> {
    let shapes = &window.output().shapes;
    let covers = |clipped: &egui::epaint::ClippedShape| match &clipped.shape {
        egui::Shape::Rect(rect) => rect.fill.is_opaque() && rect.rect.contains_rect(area),
        _ => false,
    };
    let front = shapes.iter().rposition(covers).unwrap_or(0);
    shapes[front..]
        .iter()
        .filter_map(|clipped| match &clipped.shape {
            egui::Shape::Text(text) => {
                let place = text.visual_bounding_rect();
                let visible = clipped.clip_rect.intersects(place) && area.contains(place.center());
                (visible && !text.galley.text().is_empty())
                    .then(|| (text.galley.text().to_owned(), place))
            }
            _ => None,
        })
        .collect()
}

/// Asserts that no two texts in `area` overlap.
fn assert_apart(window: &Window, area: egui::Rect, what: &str) {
    let texts = texts_in(window, area);
    for (index, (text, place)) in texts.iter().enumerate() {
        for (other, at) in &texts[index + 1..] {
            let over = place.intersect(*at);
            assert!(
                over.width() < 1.0 || over.height() < 3.0,
                "{what}: \"{text}\" and \"{other}\" at {over}"
            );
        }
    }
}

#[test]
fn at_the_least_size_no_text_of_a_list_lies_over_another() {
    let mut window = narrow_window(560.0);
    // With this bound, gains remain unmatched and every condition is marked.
    unfold_settings(&mut window, true);
    window
        .get_by_label("Upper gain bound")
        .set_value_accesskit(1.0);
    settle(&mut window);
    let rows: Vec<egui::Rect> = window
        .query_all_by_label_contains("Condition ")
        .map(|row| row.rect())
        .collect();
    assert_eq!(rows.len(), 11);
    for row in rows {
        assert_apart(&window, row, "a condition");
    }
    give(&mut window, LayoutCommand::ShowSheet(Some(Sheet::Models)));
    let models: Vec<egui::Rect> = window
        .query_all_by_label_contains("Keep physics model")
        .map(|row| row.rect())
        .collect();
    for model in models {
        let row = egui::Rect::from_min_max(model.min, pos2(model.min.x + 180.0, model.max.y));
        assert_apart(&window, row, "a model");
    }
    give(&mut window, LayoutCommand::ShowSheet(None));
    let tab = window.get_by_label("Bode").rect();
    assert_apart(
        &window,
        egui::Rect::from_x_y_ranges(0.0..=900.0, tab.y_range()),
        "the bar of the views",
    );
}

#[test]
fn the_list_of_conditions_has_headings() {
    let window = window();
    let heading = window
        .get_by_label_contains("Condition 1: ")
        .rect()
        .translate(vec2(0.0, -16.0));
    let texts: Vec<String> = texts_in(&window, heading.expand2(vec2(0.0, 4.0)))
        .into_iter()
        .map(|(text, _)| text)
        .collect();
    for word in ["no.", "kt", "P", "NZ"] {
        assert!(texts.iter().any(|text| text == word), "{texts:?}");
    }
}

fn marks_of_10(window: &Window) -> Vec<String> {
    let row = window.get_by_label_contains("Condition 10: ").rect();
    texts_in(window, row)
        .into_iter()
        .map(|(text, _)| text)
        .filter(|text| text.starts_with(['⚠', 'k', 'τ']))
        .collect()
}

#[test]
fn a_mark_goes_once_what_it_asks_for_is_done() {
    let mut window = window();
    assert_eq!(
        marks_of_10(&window),
        ["⚠"],
        "delays that need lead ask for nothing"
    );
    choose_condition_10(&mut window);
    click(&mut window, "Reject 3 suggested");
    assert!(
        marks_of_10(&window).is_empty(),
        "{:?}",
        marks_of_10(&window)
    );
}

#[test]
fn a_condition_left_out_of_the_schedule_says_so_and_its_menu_takes_it_in_again() {
    let mut window = window();
    window
        .get_by_label_contains("Condition 3: ")
        .click_secondary();
    window.run_steps(2);
    click(&mut window, "Leave out of the schedule: condition 3");
    assert!(!state(&window).study.choice(ConditionId(3)).scheduled);
    window
        .get_by_label_contains(", left out of the schedule")
        .click_secondary();
    window.run_steps(2);
    click(&mut window, "Include in the schedule: condition 3");
    assert!(state(&window).study.choice(ConditionId(3)).scheduled);
    assert!(
        window
            .query_by_label_contains(", left out of the schedule")
            .is_none()
    );
    let edit = Edit::SetScheduled {
        condition: ConditionId(3),
        scheduled: true,
    };
    assert_eq!(last_change(&window), Some(&Change::Decision(edit)));
}

#[test]
fn the_title_of_the_window_names_the_study_and_the_dataset_and_marks_what_is_not_saved() {
    let mut window = window();
    let dataset = state(&window).dataset().name().to_owned();
    assert_eq!(
        state(&window).window_title(),
        [state(&window).study_name.as_str(), &dataset, "gdcm"].join(" – ")
    );
    window.get_by_label("Keep physics model V+10kt").click();
    let mut titles = Vec::new();
    for _ in 0..10 {
        window.step();
        let commands = window
            .output()
            .viewport_output
            .values()
            .flat_map(|viewport| viewport.commands.iter());
        titles.extend(commands.filter_map(|command| match command {
            egui::ViewportCommand::Title(title) => Some(title.clone()),
            _ => None,
        }));
    }
    assert_eq!(
        titles,
        [format!(
            "{} • – {dataset} – gdcm",
            state(&window).study_name
        )],
        "told once"
    );
}

#[test]
#[ignore = "takes a minute: the labels of 264 responses"]
fn no_two_labels_of_the_plots_lie_over_one_another_on_any_response_of_any_condition() {
    let mut window = window();
    wait_for_bars(&mut window);
    let conditions: Vec<ConditionId> = state(&window)
        .dataset()
        .conditions()
        .iter()
        .map(|of| of.id())
        .collect();
    let pairs: Vec<Pair> = state(&window).study.settings.constrained.pairs().collect();
    assert_eq!((conditions.len(), pairs.len()), (11, 24));
    // The region between the panels (272 and 352 points wide) and below the view bar.
    let size = window.ctx.content_rect();
    let centre = egui::Rect::from_min_max(
        pos2(272.0, 80.0),
        pos2(size.right() - 352.0, size.bottom() - 26.0),
    );
    for condition in conditions {
        give(&mut window, SelectionCommand::SelectCondition(condition));
        for pair in &pairs {
            give(&mut window, SelectionCommand::FocusPair(*pair));
            window.run_steps(2);
            assert_apart(
                &window,
                centre,
                &format!(
                    "condition {condition}, {}",
                    state(&window).dataset().pair_name(*pair)
                ),
            );
        }
    }
}
