//! A flight record with its tolerances, or the responses to a test input, in the requirement
//! details (M17.2: docs/requirements.md). `requirement_test_input` has the fields for the test
//! input.
//!
//! A *quantity* is an output, or an angle integrated from a rate, with its tolerance; the *peak
//! error* is the greatest error relative to the tolerance.

use egui::{Align2, Grid, Label, Sense, Ui, Vec2, pos2, vec2};

use gdcm_method::requirements::RecordCheck;
use gdcm_model::number_format::decimals;
use gdcm_model::units::telling;
use gdcm_plot::figure::Figure;
use gdcm_plot::figure::figure::Plot;
use gdcm_plot::figure::request::OverTime;
use gdcm_plot::figure::requirements::{quantity_figure, test_answers_figure};
use gdcm_study::results::grid_requirement::{Requirement, RequirementLimit};
use gdcm_study::results::record_history::{QuantityHistory, RecordHistory};
use gdcm_words::missing_results::not_in_history_text;
use gdcm_words::requirement_grid::limit_description;

use super::requirement_cards::role_color;
use super::requirement_grid_layout::FULL_WIDTH;
use super::requirement_history_jobs::{compared_record, over_time, record_job};
use super::requirement_test_input::test_input_ui;
use crate::gui::commands::command::Command;
use crate::gui::commands::display::DisplayCommand;
use crate::gui::plot::{FigureScene, FigureWords, figure_ui};
use crate::gui::state::requirements_display::{RecordChoice, RequirementsDisplay};
use crate::gui::state::window_state::State;
use crate::gui::widgets::choices::choice_ui;
use crate::gui::widgets::elision::text_width;
use crate::gui::widgets::palette::{Palette, small};

/// Minimum plot size \[pt\].
const LEAST_PLOT: Vec2 = vec2(140.0, 90.0);
/// Height of the line with the time shares inside the tolerance \[pt\].
const SHARES: f32 = 16.0;
/// Distance between the shares \[pt\].
const SHARES_GAP: f32 = 7.0;
/// Relative height of the test-input panel.
const INPUT_WEIGHT: f64 = 0.4;

/// Draws the selector between the condition's records in use, the held-out ones first, and a test
/// input; draws nothing without records in use.
pub(super) fn record_choice_ui(ui: &mut Ui, state: &State, commands: &mut Vec<Command>) {
    let condition = state.condition().id();
    let mut choices: Vec<(Option<usize>, &str, &str)> = Vec::new();
    if let Some(records) = state.records.conditions.get(&condition) {
        for is_held_out in [true, false] {
            for (index, row) in records.used_rows() {
                if row.guess.held_out == is_held_out {
                    let hint = if is_held_out {
                        "Record held out of the identification: judged in the grid"
                    } else {
                        "Record used by the identification: not judged in the grid"
                    };
                    choices.push((Some(index), &row.table.name, hint));
                }
            }
        }
    }
    if choices.is_empty() {
        return;
    }
    choices.push((
        None,
        "test input",
        "A step or a doublet of the input in focus, from rest",
    ));
    let mut shown = None;
    if !state.display.judging.shows_test {
        shown = compared_record(state);
    }
    let mut chosen = shown;
    choice_ui(ui, "Record or test input", &mut chosen, &choices);
    if chosen != shown {
        commands.push(DisplayCommand::ShowTest(chosen.is_none()).into());
        if let Some(index) = chosen {
            let display = RequirementsDisplay {
                record: Some(RecordChoice { condition, index }),
                ..state.display.judging.requirements
            };
            commands.push(DisplayCommand::ShowRequirements(display).into());
        }
    }
}

/// Returns the card's subject: the quantity with its unit and the record, or the response and the
/// test input; empty without a result.
pub(super) fn time_subject(state: &State, selected: Option<Requirement>) -> String {
    match over_time(state) {
        Some(Ok(OverTime::Record(history, _))) => {
            let held_out = if history.held_out { ", held out" } else { "" };
            let record = &history.record;
            match shown_quantity(state, &history, selected) {
                Some(quantity) => format!(
                    "{} [{}], {record}{held_out}",
                    quantity.tolerance.quantity, quantity.unit
                ),
                None => format!("{record}{held_out}"),
            }
        }
        Some(Ok(OverTime::Test(_))) => {
            let pair = state.dataset().pair_name(state.display.selection.pair);
            format!("{pair}, test input from rest, no flight data")
        }
        _ => String::new(),
    }
}

/// Returns the quantity to draw, among those with a response of at least one model: first the
/// selected requirement's; else the first for the output in focus; else the record's first.
fn shown_quantity<'a>(
    state: &State,
    history: &'a RecordHistory,
    selected: Option<Requirement>,
) -> Option<&'a QuantityHistory> {
    let drawn: Vec<&QuantityHistory> = history
        .quantities
        .iter()
        .filter(|quantity| !quantity.models.is_empty())
        .collect();
    if let Some(Requirement::PeakError(row)) = selected
        && let Some(tolerance) = state.study.requirements.tolerances.rows().get(row)
        && let Some(found) = drawn.iter().find(|quantity| {
            quantity.tolerance.quantity == tolerance.quantity
                && quantity.tolerance.channel == tolerance.channel
        })
    {
        return Some(*found);
    }
    let focused = state.display.selection.pair.output;
    drawn
        .iter()
        .find(|quantity| quantity.output == focused)
        .or(drawn.first())
        .copied()
}

/// Draws the detail that is chosen in the selector:
///
/// - a record: the input that was moved, the quantity with its tolerance corridor, and every
///   model's error; without a quantity to draw, the reasons;
/// - the test input, also without records: its fields, then the input and the output in focus;
/// - without a result, the reason.
pub(super) fn time_detail_ui(
    ui: &mut Ui,
    state: &mut State,
    selected: Option<Requirement>,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    if record_job(state).is_none() {
        test_input_ui(ui, state, palette, commands);
    }
    let figure = match over_time(state) {
        Some(Ok(OverTime::Record(history, input))) => {
            let Some(quantity) = shown_quantity(state, &history, selected) else {
                for why in &history.missing {
                    ui.label(palette.small_warning(not_in_history_text(why)));
                }
                return;
            };
            // In a narrow window, the numbers beside the card include the shares.
            if ui.ctx().content_rect().width() >= FULL_WIDTH {
                shares_ui(ui, quantity, palette);
            }
            quantity_figure(&history, quantity, state.dataset(), input)
        }
        Some(Ok(OverTime::Test(answers))) => {
            let figure = test_answers_figure(&answers, state.dataset());
            output_figure(figure, state.display.selection.pair.output)
        }
        Some(Err(why)) => {
            ui.label(palette.small_warning(why));
            return;
        }
        None => {
            ui.label(palette.dim(state.results.absence()));
            return;
        }
    };
    // The scene borrows the state: take the view out while the figure is drawn.
    let mut view = std::mem::take(&mut state.display.judging.history_figure);
    view.fit_if_subject_changed(&figure.title);
    let words = HistoryWords(&figure);
    let scene = FigureScene {
        zooms: true,
        is_stacked: true,
        ..FigureScene::new(
            "requirements in time",
            &figure,
            LEAST_PLOT,
            "No response over time",
            &words,
        )
    };
    figure_ui(ui, &scene, &mut view, palette);
    state.display.judging.history_figure = view;
}

/// Keeps only the plots for the test input and one output, the input on top.
fn output_figure(figure: Figure, output: usize) -> Figure {
    let mut plot = Plot::new("");
    for (index, found) in figure.plots.iter().enumerate() {
        // The first plot shows the input.
        if index == 0 {
            for panel in &found.panels {
                plot = plot.panel(panel.clone().weight(INPUT_WEIGHT));
            }
        } else if index == 1 + output {
            for panel in &found.panels {
                plot = plot.panel(panel.clone());
            }
        }
    }
    Figure {
        plots: vec![plot],
        ..figure
    }
}

/// Draws each model's time share inside the tolerance, in the model's colour; models that do not
/// fit into the line are omitted.
fn shares_ui(ui: &mut Ui, quantity: &QuantityHistory, palette: &Palette) {
    let size = vec2(ui.available_width(), SHARES);
    let (row, _) = ui.allocate_exact_size(size, Sense::hover());
    let mut texts = vec![("inside, %".to_owned(), palette.dim_text)];
    for (role, check) in &quantity.models {
        let text = format!("{} {}", role.name(), rounded_down_percent(check));
        texts.push((text, role_color(palette, *role)));
    }
    let mut left = row.left();
    for (text, color) in texts {
        let width = text_width(ui, &text, small());
        if left + width > row.right() {
            break;
        }
        let at = pos2(left, row.center().y);
        ui.painter()
            .text(at, Align2::LEFT_CENTER, text, small(), color);
        left += width + SHARES_GAP;
    }
}

/// Formats the time share inside the tolerance in percent, rounded down so that 100 means always
/// inside.
fn rounded_down_percent(check: &RecordCheck) -> String {
    decimals((100.0 * check.share_inside()).floor(), 0)
}

/// Draws for every model the time share inside the tolerance, the peak error and its time; below
/// them the tolerance. Draws nothing unless a record is shown.
pub(super) fn time_numbers_ui(
    ui: &mut Ui,
    state: &State,
    selected: Option<Requirement>,
    palette: &Palette,
) {
    let Some(Ok(OverTime::Record(history, _))) = over_time(state) else {
        return;
    };
    let Some(quantity) = shown_quantity(state, &history, selected) else {
        return;
    };
    Grid::new("peak errors of the models")
        .num_columns(4)
        .show(ui, |ui| {
            for heading in ["", "inside, %", "peak error, %", "at, s"] {
                ui.label(palette.small(heading));
            }
            ui.end_row();
            for (role, check) in &quantity.models {
                ui.colored_label(role_color(palette, *role), role.name());
                ui.label(rounded_down_percent(check));
                if let Some(peak) = check.peak() {
                    ui.label(decimals(100.0 * peak.peak_error, 0));
                    ui.label(telling(peak.peak_error_at_s, 1));
                }
                ui.end_row();
            }
        });
    // The description of a tolerance does not depend on the row in `PeakError`.
    let limit = RequirementLimit::Tolerance(quantity.tolerance.clone());
    let text = format!(
        "Tolerance: {}. Windows of at most 10 s, each from an estimated initial state.",
        limit_description(Requirement::PeakError(0), &limit)
    );
    ui.add(Label::new(palette.small(text)).wrap());
}

/// Accessible names for the plots over time.
struct HistoryWords<'a>(&'a Figure);

impl FigureWords for HistoryWords<'_> {
    fn plot_name(&self, _: usize) -> String {
        format!("{} over time", self.0.title)
    }
}
