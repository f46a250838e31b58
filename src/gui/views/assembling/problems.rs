//! Incomplete items, cautions, and unused files.
//!
//! A *part* is a model that was found in the files, with the settings that the rules give it; a
//! *reference* is a condition's identified model.

use egui::{Label, RichText, ScrollArea, Sense, Ui};

use super::column_headings::column_headings_ui;
use crate::gui::commands::assembling::AssemblingCommand;
use crate::gui::commands::command::Command;
use crate::gui::state::assembling::AssemblyState;
use crate::gui::widgets::palette::{Palette, SMALL_SIZE};

/// Maximum count of lines about incomplete items, whose others a note counts, and of lines about
/// unused content, whose others are dropped.
const MOST_LINES: usize = 200;
/// Maximum count of displayed tables without models. Others are shown once these have been read as
/// models.
const MOST_TABLES: usize = 5;

/// Shows, from top to bottom: how many items are incomplete; if none, the conditions without
/// identified models; then in a scroll area the cautions, a line for each incomplete item, tables
/// without models, and unused content. A click on a line displays its model.
pub(super) fn problems_ui(
    ui: &mut Ui,
    state: &AssemblyState,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    let assembly = state.assembly();
    let problems = assembly.problem_lines();
    if assembly.parts().is_empty() {
        ui.label(palette.dim("No models yet: add a folder or files above, or drop them here"));
    } else {
        heading_ui(ui, problems.len(), palette);
    }
    if problems.is_empty() {
        without_reference_ui(ui, state, palette);
    }
    ScrollArea::vertical()
        .id_salt("problems")
        .auto_shrink(false)
        .show(ui, |ui| {
            for caution in assembly.cautions() {
                let words = format!("caution: {}", assembly.caution_words(&caution));
                let part = caution.parts.first().copied();
                line_ui(ui, palette.small_warning(words), part, commands);
            }
            // Without models every dataset property is missing, so a list would be useless.
            let listed = if assembly.parts().is_empty() {
                &[]
            } else {
                &problems[..]
            };
            for problem in listed.iter().take(MOST_LINES) {
                let text = RichText::new(&problem.text)
                    .size(SMALL_SIZE)
                    .color(palette.text);
                line_ui(ui, text, problem.part, commands);
            }
            if listed.len() > MOST_LINES {
                ui.label(palette.small(format!("and {} more", listed.len() - MOST_LINES)));
            }
            unread_tables_ui(ui, state, palette, commands);
            for text in unused_content(state, palette).into_iter().take(MOST_LINES) {
                ui.add(Label::new(text).wrap());
            }
        });
}

fn heading_ui(ui: &mut Ui, count: usize, palette: &Palette) {
    let heading = match count {
        0 => "Nothing is missing: the dataset can be made".to_owned(),
        1 => "1 item to complete".to_owned(),
        count => format!("{count} items to complete"),
    };
    let color = if count == 0 {
        palette.text
    } else {
        palette.warning
    };
    ui.label(RichText::new(heading).strong().color(color));
}

/// Lists the conditions without identified models.
fn without_reference_ui(ui: &mut Ui, state: &AssemblyState, palette: &Palette) {
    let conditions = state.assembly().without_reference();
    if conditions.is_empty() {
        return;
    }
    let ids: Vec<String> = conditions.iter().map(i64::to_string).collect();
    let subject = match &ids[..] {
        [id] => format!("Condition {id} has"),
        ids => format!("Conditions {} have", ids.join(", ")),
    };
    let words = format!(
        "{subject} no identified models yet: identify models from flight records afterwards"
    );
    ui.add(Label::new(palette.small(words)).wrap());
}

/// Draws a line; if it concerns the model `part`, a click displays that model.
fn line_ui(ui: &mut Ui, text: RichText, part: Option<usize>, commands: &mut Vec<Command>) {
    let line = ui.add(Label::new(text).sense(Sense::click()).wrap());
    if line.clicked()
        && let Some(part) = part
    {
        commands.push(AssemblingCommand::Select(part).into());
    }
}

/// Shows the column headings for tables that could not be read as models.
fn unread_tables_ui(
    ui: &mut Ui,
    state: &AssemblyState,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    let parts = state.assembly().parts();
    let unread = state
        .tables
        .keys()
        .filter(|file| !parts.iter().any(|part| part.found.file() == file.as_str()));
    for file in unread.take(MOST_TABLES) {
        column_headings_ui(ui, state, file, palette, commands);
    }
}

/// Returns lines about unreadable files, files without models, and unused content.
fn unused_content(state: &AssemblyState, palette: &Palette) -> Vec<RichText> {
    let mut lines = Vec::new();
    for fault in &state.faults {
        lines.push(palette.small_warning(format!("not read: {fault}")));
    }
    for words in &state.ignored {
        lines.push(palette.small(format!("no model: {words}")));
    }
    for words in &state.unused {
        lines.push(palette.small(words));
    }
    lines
}
