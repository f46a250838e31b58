//! What is still to be said, and what could not be taken.

use egui::{Label, RichText, ScrollArea, Sense, Ui};

use crate::view::command::Command;
use crate::view::palette::{Palette, SMALL_SIZE};

use super::columns::columns_ui;
use super::workbench::{AssemblingCommand, Workbench};

/// More lines than this are counted.
const MOST_LINES: usize = 200;
/// Tables of which no model came whose columns can be said here; the others follow as these are read.
const MOST_TABLES: usize = 5;

/// A line for each problem; a click shows its model.
pub(super) fn problems_ui(ui: &mut Ui, bench: &Workbench, palette: &Palette, commands: &mut Vec<Command>) {
    let assembly = bench.assembly();
    let line = |text: String, color| RichText::new(text).size(SMALL_SIZE).color(color);
    let problems = assembly.told();
    let heading = match problems.len() {
        0 => "Nothing is missing: the dataset can be made".to_owned(),
        1 => "1 thing is still to be said".to_owned(),
        count => format!("{count} things are still to be said"),
    };
    ui.label(RichText::new(heading).strong().color(if problems.is_empty() { palette.good } else { palette.warning }));
    ScrollArea::vertical().id_salt("problems").auto_shrink(false).show(ui, |ui| {
        for (part, words) in problems.iter().take(MOST_LINES) {
            let text = line(words.clone(), palette.text);
            let response = ui.add(Label::new(text).sense(Sense::click()).wrap());
            if let Some(part) = part.filter(|_| response.clicked()) {
                commands.push(AssemblingCommand::Select(part).into());
            }
        }
        if problems.len() > MOST_LINES {
            ui.label(line(format!("and {} more", problems.len() - MOST_LINES), palette.dim_text));
        }
        let not_taken = bench.faults.iter().map(|fault| (format!("not taken: {fault}"), palette.warning));
        let no_models = bench.passed_over.iter().map(|words| (format!("no model: {words}"), palette.dim_text));
        for (text, color) in not_taken.chain(no_models).take(MOST_LINES) {
            ui.add(Label::new(line(text, color)).wrap());
        }
        let parts = assembly.parts();
        let unread = bench.tables.keys().filter(|file| !parts.iter().any(|part| part.found.file() == file.as_str()));
        for file in unread.take(MOST_TABLES) {
            columns_ui(ui, bench, file, palette, commands);
        }
    });
}
