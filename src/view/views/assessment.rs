//! What the correction is worth, condition by condition.

use egui::{RichText, Ui};

use crate::view::assessment_scene::{
    AssessedFigures, AssessedPairs, CostPart, assessed_pairs, assessment_panels, assessment_sentences,
    assessment_text_table,
};
use crate::view::command::Command;
use crate::view::palette::{Palette, SMALL_SIZE};
use crate::view::plot::{AssessmentEvent, AssessmentScene, assessment_ui};
use crate::view::settings_panel::choice_ui;
use crate::view::state::State;
use crate::view::table_view::{TableLook, table_ui};
use gdcm_core::dataset::Pair;
use gdcm_core::fidelity::CostAverage;
use gdcm_core::study::{AssessedCorrection, AssessedModel, AssessmentTable};

/// What is assessed, and how it is shown. Laid out from right to left.
pub fn assessment_header_ui(ui: &mut Ui, state: &State, commands: &mut Vec<Command>) {
    let shown = state.display.assessed;
    let mut chosen = shown;
    choice_ui(
        ui,
        "Form of the assessment",
        &mut chosen.as_table,
        &[(false, "bars", "A bar for each condition"), (true, "table", "Responses down, conditions across")],
    );
    if chosen.as_table {
        let parts = [CostPart::Total, CostPart::Magnitude, CostPart::Phase];
        choice_ui(
            ui,
            "Part of J",
            &mut chosen.part,
            &parts.map(|part| (part, part.symbol(), "Change of J, or of a part")),
        );
    }
    choices_ui(ui, &mut chosen);
    if chosen != shown {
        commands.push(Command::Assess(chosen));
    }
}

fn choices_ui(ui: &mut Ui, chosen: &mut AssessedFigures) {
    let averages = [
        (None, "as set", "Median or mean as the settings say"),
        (Some(CostAverage::Median), "median", "J of medians over frequency (M4)"),
        (Some(CostAverage::Mean), "mean", "J of means over frequency"),
    ];
    choice_ui(ui, "Average of the assessment", &mut chosen.average, &averages);
    let corrections = [
        (AssessedCorrection::Scheduled, "scheduled", "The schedule at the condition's airspeed"),
        (
            AssessedCorrection::ScheduleOfOthers,
            "of the others",
            "The schedule of the other conditions, which has not seen this one",
        ),
        (
            AssessedCorrection::ScheduledWithoutLeads,
            "scheduled, no leads",
            "The schedule with its lead filters left out (M15)",
        ),
        (AssessedCorrection::Own, "own optimum", "The condition's own correction"),
    ];
    choice_ui(ui, "Correction assessed", &mut chosen.correction, &corrections);
    let models = [
        (AssessedModel::Nominal, "nominal", "The physics model at the condition's own trim"),
        (AssessedModel::Representative, "representative", "The physics model that represents its bundle"),
    ];
    choice_ui(ui, "Model assessed", &mut chosen.model, &models);
    let pairs = [
        (AssessedPairs::OnAxis, "on-axis", "The on-axis responses of the dataset"),
        (AssessedPairs::OffAxis, "off-axis", "All other responses"),
        (AssessedPairs::Focused, "in focus", "The response chosen in the matrix"),
        (AssessedPairs::All, "all", "Every response"),
    ];
    choice_ui(ui, "Responses assessed", &mut chosen.pairs, &pairs);
}

/// The change of J of the responses chosen in every condition (Figures 8 to 19), summed up in a sentence.
pub fn assessment_view_ui(ui: &mut Ui, state: &mut State, palette: &Palette, commands: &mut Vec<Command>) {
    let Some(table) = state.assessment().cloned() else {
        let scene = AssessmentScene { panels: &[], message: Some(state.results.absence()) };
        assessment_ui(ui, &scene, &mut state.display.assessment, palette);
        return;
    };
    let sentences = assessment_sentences(state, &table).join(" · ");
    let text = RichText::new(&sentences).size(SMALL_SIZE).color(palette.text);
    ui.add(egui::Label::new(text).truncate()).on_hover_text(&sentences);
    if state.display.assessed.as_table {
        return text_table_ui(ui, state, &table, palette, commands);
    }
    let (pairs, panels) = assessment_panels(state, &table);
    let scene = AssessmentScene { panels: &panels, message: Some("No response of this kind: choose others above") };
    let events = assessment_ui(ui, &scene, &mut state.display.assessment, palette);
    for event in events {
        match event {
            AssessmentEvent::BarClicked { panel, condition } => {
                commands.push(Command::SelectCondition(condition));
                commands.extend(pairs.get(panel).map(|&pair| Command::FocusPair(pair)));
            }
            AssessmentEvent::Asked(figure) => commands.push(Command::Explain(Some(figure))),
        }
    }
}

/// The table: green where J falls, amber where it rises. A click shows its response and its condition.
fn text_table_ui(
    ui: &mut Ui,
    state: &mut State,
    table: &AssessmentTable,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    let text = assessment_text_table(state, table);
    let pairs: Vec<Pair> = assessed_pairs(state);
    let color = |row: usize, column: usize| match text.rows[row][column].chars().next() {
        Some('+') if column > 0 => Some(palette.warning),
        Some('\u{2212}') => Some(palette.good),
        _ => None,
    };
    let look = TableLook { color: &color, selected: &|row| pairs.get(row) == Some(&state.display.pair) };
    let mut sorting = state.display.assessment_sorting;
    let clicked = table_ui(ui, &text, &mut sorting, &look, palette, commands);
    if let Some(click) = clicked {
        commands.extend(pairs.get(click.row).map(|&pair| Command::FocusPair(pair)));
        let condition = click.column.checked_sub(1).and_then(|column| state.dataset().conditions().get(column));
        commands.extend(condition.map(|condition| Command::SelectCondition(condition.id())));
    }
    state.display.assessment_sorting = sorting;
}
