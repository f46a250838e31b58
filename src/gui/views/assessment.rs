//! Benefit from the correction in each condition: a summary, and the change in J as bars or as a
//! table.
//!
//! J is the cost of the difference between a model's response and the identified one (M4:
//! docs/method.md); its change is J after the correction minus J before, so a negative change is a
//! benefit. Figure numbers are those of the paper cited there.

use egui::{Align, Label, Layout, Rect, RichText, Sense, Ui, Vec2, vec2};

use gdcm_plot::figure::Figure;
use gdcm_plot::figure::figure::Plot;
use gdcm_plot::figure::marks::MarkId;
use gdcm_study::AssessmentTable;

use super::assessment_content::{assessed_pairs, assessment_sentences, assessment_text_table};
use super::assessment_plots::{AssessmentPlots, PHASE_PERCENT};
use super::axis_updates::axis_update;
use crate::gui::commands::command::Command;
use crate::gui::commands::selection::SelectionCommand;
use crate::gui::plot::{FigureEvent, FigureScene, figure_ui};
use crate::gui::state::view::View;
use crate::gui::state::window_state::State;
use crate::gui::widgets::palette::{Palette, SMALL_SIZE};
use crate::gui::widgets::tables::{TableLook, table_ui};

/// Minimum plot size \[pt\].
const LEAST_PLOT: Vec2 = vec2(130.0, 90.0);
/// Smallest rise in J that the table, with one decimal, does not round to zero.
const LEAST_SHOWN_RISE: f64 = 0.05;

/// Draws a summary, and below it the change in J in every condition for the chosen responses
/// (Figures 8 to 19).
pub fn assessment_view_ui(
    ui: &mut Ui,
    state: &mut State,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    let Some(table) = state.assessment().cloned() else {
        ui.label(RichText::new(state.results.absence()).color(palette.dim_text));
        return;
    };
    summary_ui(ui, state, &table, palette);
    if state.display.judging.assessed.as_table {
        change_table_ui(ui, state, &table, palette, commands);
    } else {
        key_ui(ui, palette);
        bars_ui(ui, state, &table, palette, commands);
    }
}

/// Draws the summary in a line, cut to its width; the tooltip shows the full text.
fn summary_ui(ui: &mut Ui, state: &State, table: &AssessmentTable, palette: &Palette) {
    let sentences = assessment_sentences(state, table).join(" · ");
    let text = RichText::new(&sentences)
        .size(SMALL_SIZE)
        .color(palette.text);
    ui.add(Label::new(text).truncate())
        .on_hover_text(&sentences);
}

/// Draws a bar plot for each response, with a column for each condition. A click selects the
/// condition and the response.
fn bars_ui(
    ui: &mut Ui,
    state: &mut State,
    table: &AssessmentTable,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    // The scene borrows the state: take the view out while the figure is drawn.
    let mut view = state
        .display
        .figures
        .remove(&View::Assessment)
        .unwrap_or_default();
    let plots = AssessmentPlots {
        state,
        table,
        pairs: assessed_pairs(state),
    };
    let columns: Vec<MarkId> = state
        .dataset()
        .conditions()
        .iter()
        .map(|condition| MarkId::Condition(condition.id()))
        .collect();
    let range = plots.common_range();
    let panels = plots
        .pairs
        .iter()
        .map(|&pair| Plot::new(state.dataset().pair_name(pair)).panel(plots.panel(pair, range)));
    let mut figure = Figure::default().plots(panels).shared_y().with_ranges();
    view.fit_if_subject_changed(&format!("{:?}", state.display.judging.assessed));
    view.keep_axis_ranges(&mut figure, axis_update(ui, state));
    let message = "No response of this kind: choose another kind above";
    let scene = FigureScene {
        selected: Some(MarkId::Condition(state.condition().id())),
        columns: &columns,
        ..FigureScene::new("assessment", &figure, LEAST_PLOT, message, &plots)
    };
    for event in figure_ui(ui, &scene, &mut view, palette) {
        commands.extend(bar_commands(&plots, event));
    }
    state.display.figures.insert(View::Assessment, view);
}

/// Returns the commands for an event in the bar plots.
fn bar_commands(plots: &AssessmentPlots<'_>, event: FigureEvent) -> Vec<Command> {
    match event {
        FigureEvent::Clicked(plot, MarkId::Condition(condition), _) => {
            let mut commands = vec![SelectionCommand::SelectCondition(condition).into()];
            if let Some(pair) = plots.pairs.get(plot) {
                commands.push(SelectionCommand::FocusPair(*pair).into());
            }
            commands
        }
        FigureEvent::ExplanationRequested(target) => {
            vec![SelectionCommand::Explain(Some(target)).into()]
        }
        FigureEvent::StatusText(words) => vec![SelectionCommand::ShowStatus(words).into()],
        FigureEvent::Clicked(..) | FigureEvent::Pointed(_) => Vec::new(),
    }
}

/// Draws the colour key, from right to left.
fn key_ui(ui: &mut Ui, palette: &Palette) {
    let faint = palette
        .dim_text
        .gamma_multiply(0.01 * f32::from(PHASE_PERCENT));
    let parts = [
        ("worse", palette.warning, 10.0),
        ("better", palette.good, 10.0),
        ("ΔJ", palette.text, 2.0),
        ("ΔJ phase", faint, 10.0),
        ("ΔJ magnitude", palette.dim_text, 10.0),
    ];
    ui.allocate_ui_with_layout(
        vec2(ui.available_width(), 16.0),
        Layout::right_to_left(Align::Center),
        |ui| {
            for (name, color, height) in parts {
                ui.label(RichText::new(name).size(SMALL_SIZE).color(palette.dim_text));
                let (rect, _) = ui.allocate_exact_size(vec2(12.0, 10.0), Sense::hover());
                ui.painter().rect_filled(
                    Rect::from_center_size(rect.center(), vec2(12.0, height)),
                    1.0,
                    color,
                );
            }
        },
    );
}

/// Draws the table; where the displayed part of J rises, a cell has the warning colour. A click
/// selects the response and the condition.
fn change_table_ui(
    ui: &mut Ui,
    state: &mut State,
    table: &AssessmentTable,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    let text = assessment_text_table(state, table);
    let pairs = assessed_pairs(state);
    let conditions = state.dataset().conditions();
    let chosen_part = state.display.judging.assessed.part.extractor();
    let color = |row: usize, column: usize| {
        // The first column holds response names.
        let condition = conditions.get(column.checked_sub(1)?)?;
        let change = table.change(condition.id(), *pairs.get(row)?)?;
        if chosen_part(change) >= LEAST_SHOWN_RISE {
            Some(palette.warning)
        } else {
            None
        }
    };
    let look = TableLook {
        color: &color,
        selected: &|row| pairs.get(row) == Some(&state.display.selection.pair),
    };
    let mut sorting = state.display.judging.assessment_sorting;
    let clicked = table_ui(ui, &text, &mut sorting, &look, palette, commands);
    if let Some(click) = clicked {
        if let Some(pair) = pairs.get(click.row) {
            commands.push(SelectionCommand::FocusPair(*pair).into());
        }
        if let Some(column) = click.column.checked_sub(1)
            && let Some(condition) = conditions.get(column)
        {
            commands.push(SelectionCommand::SelectCondition(condition.id()).into());
        }
    }
    state.display.judging.assessment_sorting = sorting;
}
