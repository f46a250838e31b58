//! Derivation of a value ("How was this computed?"): its equation, the equation with numbers, and
//! what it is based on. Here are its sheet, and the labels and menus that open it. For G and D, the
//! sheet also shows how constraining or releasing the response would change the objective.
//!
//! G and D are the gain and the delay that would match a response (M6: docs/method.md). The
//! objective is that of the fit of the channels' gains or delays.

use egui::{CursorIcon, Label, Response, RichText, Sense, Ui, WidgetText};

use gdcm_model::dataset::Pair;
use gdcm_words::Table;
use gdcm_words::derivation::{Derivation, ExplainTarget, derivation};
use gdcm_words::sensitivity::toggle_text;

use crate::gui::commands::command::Command;
use crate::gui::commands::output::OutputCommand;
use crate::gui::commands::selection::SelectionCommand;
use crate::gui::plot::derivation_menu::QUESTION;
use crate::gui::state::window_state::State;
use crate::gui::widgets::controls::{Asks, entries_ui};
use crate::gui::widgets::palette::{Palette, SMALL_SIZE, TITLE_SIZE, medium};
use crate::gui::widgets::tables::{TableLook, table_block_ui};

/// Draws the derivation of a value in a sheet, updated with the results while it is open.
pub fn derivation_sheet_ui(
    ui: &mut Ui,
    state: &State,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    let Some(asked) = &state.display.selection.explained else {
        return;
    };
    let found = state
        .analysis_with_error_bars()
        .and_then(|analysis| derivation(&analysis, asked));
    match &found {
        Some(found) => {
            derivation_ui(ui, found, palette, commands);
            toggle_costs_ui(ui, state, asked, palette);
        }
        None => {
            if state.analysis().is_some() {
                ui.label("The displayed results do not contain this value");
            } else {
                ui.label("This value is not available");
                ui.label(state.results.absence());
            }
        }
    }
}

fn derivation_ui(ui: &mut Ui, found: &Derivation, palette: &Palette, commands: &mut Vec<Command>) {
    ui.label(RichText::new(&found.title).font(medium(TITLE_SIZE)));
    ui.add_space(4.0);
    ui.label(&found.equation);
    ui.add_space(4.0);
    for step in &found.with_numbers {
        ui.label(step);
    }
    ui.add_space(4.0);
    table_block_ui(
        ui,
        &terms_table(found),
        &TableLook::PLAIN,
        palette,
        commands,
    );
    ui.add_space(4.0);
    ui.label(palette.small("Based on"));
    for part in &found.rests_on {
        ui.label(RichText::new(part).size(SMALL_SIZE));
    }
    ui.horizontal(|ui| {
        if ui.button("Copy the derivation").clicked() {
            commands.push(OutputCommand::CopyText(derivation_text(found)).into());
        }
        ui.label(palette.small(found.section));
    });
}

/// Tabulates the equation's symbols with their meanings.
fn terms_table(found: &Derivation) -> Table {
    let mut table = Table::new("Terms of the equation", ["symbol", "meaning"]);
    for (symbol, meaning) in found.terms() {
        table.row([symbol, meaning]);
    }
    table
}

/// Draws how constraining or releasing the response would change the objective; nothing for values
/// other than G and D, or in another than the displayed condition.
fn toggle_costs_ui(ui: &mut Ui, state: &State, asked: &ExplainTarget, palette: &Palette) {
    let (ExplainTarget::DeltaGain(condition, pair) | ExplainTarget::DeltaDelay(condition, pair)) =
        asked
    else {
        return;
    };
    let texts = if *condition == state.condition().id() {
        toggle_cost_texts(state, *pair)
    } else {
        Vec::new()
    };
    if !texts.is_empty() {
        ui.add_space(4.0);
        ui.label(palette.small("Cost of holding or releasing this response"));
    }
    for text in texts {
        ui.label(RichText::new(text).size(SMALL_SIZE));
    }
}

/// Returns the derivation as text lines, with tabs between symbols and meanings.
pub fn derivation_text(found: &Derivation) -> String {
    let mut lines = vec![found.title.clone(), found.equation.clone()];
    lines.extend(found.with_numbers.iter().cloned());
    for (symbol, meaning) in found.terms() {
        lines.push(format!("{symbol}\t{meaning}"));
    }
    lines.extend(found.rests_on.iter().cloned());
    lines.push(found.section.to_owned());
    lines.join("\n")
}

/// Draws a value whose click opens its derivation.
pub fn value_label_ui(
    ui: &mut Ui,
    text: impl Into<WidgetText>,
    asked: ExplainTarget,
    commands: &mut Vec<Command>,
) -> Response {
    let response = ui.add(Label::new(text).sense(Sense::click()).selectable(false));
    response.asks(SelectionCommand::Explain(Some(asked)), commands);
    response.on_hover_cursor(CursorIcon::Help)
}

/// Draws the submenu that opens derivations.
pub fn question_menu_ui(
    ui: &mut Ui,
    values: Vec<(String, ExplainTarget)>,
    commands: &mut Vec<Command>,
) {
    ui.menu_button(QUESTION, |ui| {
        let entries = values.into_iter().map(|(name, asked)| {
            let explain = SelectionCommand::Explain(Some(asked));
            (name, Command::Selection(explain))
        });
        entries_ui(ui, entries, commands);
    });
}

/// Describes how constraining or releasing a response would change the objective; empty until
/// computed for the displayed result.
pub fn toggle_cost_texts(state: &State, pair: Pair) -> Vec<String> {
    let Some(toggles) = state.toggles() else {
        return Vec::new();
    };
    let (inputs, outputs) = state.dataset().input_and_output_names();
    let (gain, delay) = toggles.of_pair(pair);
    let mut texts = Vec::new();
    if let Some(toggle) = gain {
        texts.push(format!("Gains: {}", toggle_text(toggle, &inputs, &outputs)));
    }
    if let Some(toggle) = delay {
        texts.push(format!(
            "Delays: {}",
            toggle_text(toggle, &inputs, &outputs)
        ));
    }
    texts
}
