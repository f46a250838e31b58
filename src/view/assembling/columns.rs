//! What the columns of a table hold: its headings, to be corrected before its responses are taken.

use egui::{Grid, RichText, Ui};

use crate::view::command::Command;
use crate::view::palette::{Palette, SMALL_SIZE};

use super::entry::entry_ui;
use super::workbench::{AssemblingCommand, Workbench};

const HEADING_WIDTH: f32 = 180.0;
/// More columns than this are counted.
const MOST_COLUMNS: usize = 60;

/// A field for the heading of each column of a file; the file is read again by what is said.
pub(super) fn columns_ui(ui: &mut Ui, bench: &Workbench, file: &str, palette: &Palette, commands: &mut Vec<Command>) {
    let Some(headings) = bench.tables.get(file) else { return };
    let small = |text: String| RichText::new(text).size(SMALL_SIZE).color(palette.dim_text);
    ui.label(RichText::new(format!("Columns of {file}")).strong());
    ui.label(small(
        "What each holds, and its unit: omega [rad/s], f [Hz], mag P/LAT [dB], phase [deg], re, im, coherence".into(),
    ));
    Grid::new(("columns", file)).num_columns(2).spacing([6.0, 3.0]).show(ui, |ui| {
        for (column, heading) in headings.iter().enumerate().take(MOST_COLUMNS) {
            ui.label(format!("column {}", column + 1));
            let name = format!("Heading of column {} of {file}", column + 1);
            if let Some(said) = entry_ui(ui, &name, heading, "not used", HEADING_WIDTH) {
                let rules = bench.with_heading(file, column, &said);
                commands.push(AssemblingCommand::Change(Box::new(rules)).into());
            }
            ui.end_row();
        }
    });
    if headings.len() > MOST_COLUMNS {
        ui.label(small(format!("and {} more, to be said in the rules file", headings.len() - MOST_COLUMNS)));
    }
}
