//! Benefit of the correction in each condition.

use egui::{Align, Layout, Rect, RichText, Sense, Ui, Vec2, vec2};

use gdcm_method::fidelity::CostAverage;
use gdcm_model::dataset::Pair;
use gdcm_plot::figure::assessment::{ChangeColumn, ChangeTable};
use gdcm_plot::figure::figure::Plot;
use gdcm_plot::figure::{Figure, MarkId};
use gdcm_study::results::assessment_table::AssessedModel;
use gdcm_study::{AssessedCorrection, AssessmentTable};
use gdcm_words::Table;
use gdcm_words::assessment::{held_out_verdict, not_assessed_text, summary_text};

use super::assessment_plots::{AssessmentPlots, PHASE_PERCENT};
use crate::gui::commands::command::Command;
use crate::gui::commands::display::DisplayCommand;
use crate::gui::commands::selection::SelectionCommand;
use crate::gui::plot::{FigureEvent, FigureScene, figure_ui};
use crate::gui::state::assessed_figures::{AssessedFigures, AssessedPairs, CostPart};
use crate::gui::state::view::View;
use crate::gui::state::window_state::State;
use crate::gui::widgets::choices::choice_ui;
use crate::gui::widgets::palette::{Palette, SMALL_SIZE};
use crate::gui::widgets::tables::{TableLook, table_ui};

/// Minimum plot size \[pt\].
const LEAST_PLOT: Vec2 = vec2(190.0, 150.0);

/// Draws the selectors in the header, from right to left.
pub fn assessment_header_ui(ui: &mut Ui, state: &State, commands: &mut Vec<Command>) {
    let shown = state.display.judging.assessed;
    let mut chosen = shown;
    let forms = [
        (false, "bars", "A bar for each condition"),
        (true, "table", "Responses down, conditions across"),
    ];
    choice_ui(ui, "Form of the assessment", &mut chosen.as_table, &forms);
    if chosen.as_table {
        let parts = [
            (CostPart::Total, "J after the correction minus J before"),
            (CostPart::Magnitude, "Magnitude part of ΔJ"),
            (CostPart::Phase, "Phase part of ΔJ"),
        ];
        let parts = parts.map(|(part, hint)| (part, part.symbol(), hint));
        choice_ui(ui, "Part of J", &mut chosen.part, &parts);
    }
    average_choice_ui(ui, &mut chosen);
    correction_choice_ui(ui, &mut chosen);
    model_choice_ui(ui, &mut chosen);
    pairs_choice_ui(ui, &mut chosen);
    if chosen != shown {
        commands.push(DisplayCommand::Assess(chosen).into());
    }
}

fn average_choice_ui(ui: &mut Ui, chosen: &mut AssessedFigures) {
    let averages = [
        (None, "as set", "Median or mean, as in the settings"),
        (
            Some(CostAverage::Median),
            "median",
            "J with medians over frequency (M4)",
        ),
        (
            Some(CostAverage::Mean),
            "mean",
            "J with means over frequency",
        ),
    ];
    let name = "Average of the assessment";
    choice_ui(ui, name, &mut chosen.average, &averages);
}

fn correction_choice_ui(ui: &mut Ui, chosen: &mut AssessedFigures) {
    let corrections = [
        (
            AssessedCorrection::Scheduled,
            "scheduled",
            "Schedule at the condition's airspeed",
        ),
        (
            AssessedCorrection::ScheduleOfOthers,
            "of the others",
            "Schedule fitted without this condition",
        ),
        (
            AssessedCorrection::ScheduledWithoutLeads,
            "scheduled, no leads",
            "Schedule without its lead filters (M15)",
        ),
        (
            AssessedCorrection::Own,
            "own optimum",
            "Correction optimised for the condition alone",
        ),
    ];
    let name = "Correction assessed";
    choice_ui(ui, name, &mut chosen.correction, &corrections);
}

fn model_choice_ui(ui: &mut Ui, chosen: &mut AssessedFigures) {
    let models = [
        (
            AssessedModel::Nominal,
            "nominal",
            "Physics model at the condition's own trim",
        ),
        (
            AssessedModel::Representative,
            "representative",
            "Physics model that represents the bundle",
        ),
    ];
    choice_ui(ui, "Model assessed", &mut chosen.model, &models);
}

fn pairs_choice_ui(ui: &mut Ui, chosen: &mut AssessedFigures) {
    let pairs = [
        (
            AssessedPairs::OnAxis,
            "on-axis",
            "The on-axis responses of the dataset",
        ),
        (AssessedPairs::OffAxis, "off-axis", "All other responses"),
        (
            AssessedPairs::Focused,
            "in focus",
            "Response selected in the matrix",
        ),
        (AssessedPairs::All, "all", "Every response"),
    ];
    choice_ui(ui, "Responses assessed", &mut chosen.pairs, &pairs);
}

/// Draws the change of J in every condition for the chosen responses (Figures 8 to 19), below a
/// summary.
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
    let sentences = assessment_sentences(state, &table).join(" · ");
    let text = RichText::new(&sentences)
        .size(SMALL_SIZE)
        .color(palette.text);
    ui.add(egui::Label::new(text).truncate())
        .on_hover_text(&sentences);
    if state.display.judging.assessed.as_table {
        change_table_ui(ui, state, palette, commands);
        return;
    }
    key_ui(ui, palette);
    let mut view = state
        .display
        .figures
        .remove(&View::Assessment)
        .unwrap_or_default();
    let plots = AssessmentPlots {
        state,
        table: &table,
        pairs: assessed_pairs(state),
    };
    let columns: Vec<MarkId> = state
        .dataset()
        .conditions()
        .iter()
        .map(|condition| MarkId::Condition(condition.id()))
        .collect();
    let panels = plots
        .pairs
        .iter()
        .map(|&pair| Plot::new(state.dataset().pair_name(pair)).panel(plots.panel(pair)));
    let figure = Figure::default().plots(panels);
    let message = "No response of this kind: choose another kind above";
    let scene = FigureScene {
        selected: Some(MarkId::Condition(state.condition().id())),
        columns: &columns,
        ..FigureScene::new("assessment", &figure, LEAST_PLOT, message, &plots)
    };
    for event in figure_ui(ui, &scene, &mut view, palette) {
        match event {
            FigureEvent::Clicked(plot, MarkId::Condition(condition), _) => {
                commands.push(SelectionCommand::SelectCondition(condition).into());
                if let Some(pair) = plots.pairs.get(plot) {
                    commands.push(SelectionCommand::FocusPair(*pair).into());
                }
            }
            FigureEvent::Asked(figure) => {
                commands.push(SelectionCommand::Explain(Some(figure)).into())
            }
            FigureEvent::Told(words) => commands.push(SelectionCommand::Tell(words).into()),
            FigureEvent::Clicked(..) | FigureEvent::Pointed(_) => {}
        }
    }
    state.display.figures.insert(View::Assessment, view);
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

/// Draws the table, with a warning if J rises. A click selects the response and the condition.
fn change_table_ui(ui: &mut Ui, state: &mut State, palette: &Palette, commands: &mut Vec<Command>) {
    let Some(table) = state.assessment() else {
        return;
    };
    let text = assessment_text_table(state, table);
    let pairs = assessed_pairs(state);
    let color = |row: usize, column: usize| {
        if column > 0 && text.rows[row][column].starts_with('+') {
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
        // The first column holds response names.
        if let Some(column) = click.column.checked_sub(1)
            && let Some(condition) = state.dataset().conditions().get(column)
        {
            commands.push(SelectionCommand::SelectCondition(condition.id()).into());
        }
    }
    state.display.judging.assessment_sorting = sorting;
}

/// Returns the assessed responses in matrix order.
pub fn assessed_pairs(state: &State) -> Vec<Pair> {
    let measuring = state.dataset().measuring_pairs();
    let mut pairs = Vec::new();
    for pair in measuring.pairs() {
        let is_assessed = match state.display.judging.assessed.pairs {
            AssessedPairs::OnAxis => measuring[pair],
            AssessedPairs::OffAxis => !measuring[pair],
            AssessedPairs::Focused => pair == state.display.selection.pair,
            AssessedPairs::All => true,
        };
        if is_assessed {
            pairs.push(pair);
        }
    }
    pairs
}

/// Builds the table: a row for each response, a column for each condition, and in each cell the
/// signed change of J.
pub fn assessment_text_table(state: &State, table: &AssessmentTable) -> Table {
    let part = state.display.judging.assessed.part;
    let columns: Vec<ChangeColumn> = state
        .dataset()
        .ids()
        .map(|condition| ChangeColumn {
            condition,
            heading: condition.to_string(),
        })
        .collect();
    let contents = ChangeTable {
        dataset: state.dataset(),
        assessment: table,
        pairs: &assessed_pairs(state),
        columns: &columns,
        part: part.of(),
    };
    contents.table(format!(
        "{} of each response in each condition",
        part.symbol()
    ))
}

/// Summarises the assessment in sentences: improved responses, the verdict on the conditions held
/// out of the schedule, and omissions.
pub fn assessment_sentences(state: &State, table: &AssessmentTable) -> Vec<String> {
    let pairs = assessed_pairs(state);
    let marked = state
        .dataset()
        .on_axis()
        .map(|pair, _| pairs.contains(&pair));
    let mut sentences = vec![summary_text(&table.summary(&marked), state.dataset())];
    if let Some(analysis) = state.analysis() {
        sentences.extend(held_out_verdict(analysis, table.choice));
    }
    for left_out in &table.left_out {
        sentences.push(format!(
            "condition {} is left out: {}",
            left_out.condition,
            not_assessed_text(&left_out.why, state.dataset())
        ));
    }
    sentences
}
