//! Column headings in a table, and the units that follow neither from headings nor from values.
//!
//! A *table* is a file with frequency responses in columns. Its headings say what each column
//! holds; the engineer may replace them.

use egui::{Grid, RichText, Role, Ui};
use gdcm_model::number_format::counted;

use crate::gui::commands::command::Command;
use crate::gui::state::assembling::AssemblyState;
use crate::gui::widgets::controls::named;
use crate::gui::widgets::palette::Palette;
use crate::gui::widgets::text_fields::entry_ui;

const HEADING_WIDTH: f32 = 180.0;
/// Maximum count of displayed columns; a note counts the others.
const MOST_COLUMNS: usize = 60;

/// Shows a field for each column heading; after a change all files are read again.
pub(super) fn column_headings_ui(
    ui: &mut Ui,
    assembly: &AssemblyState,
    file: &str,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    let Some(headings) = assembly.tables.get(file) else {
        return;
    };
    ui.label(RichText::new(format!("Columns of {file}")).strong());
    let hint = "Content and unit: omega [rad/s], f [Hz], mag P/LAT [dB], phase [deg], re, im, \
                coherence";
    ui.label(palette.small(hint));
    Grid::new(("columns", file))
        .num_columns(3)
        .spacing([6.0, 3.0])
        .show(ui, |ui| {
            for (column, heading) in headings.iter().enumerate().take(MOST_COLUMNS) {
                ui.label(format!("column {}", column + 1));
                let name = format!("Heading of column {} of {file}", column + 1);
                if let Some(typed) = entry_ui(ui, &name, heading, "not used", HEADING_WIDTH) {
                    commands.push(assembly.heading_change(file, column, &typed));
                }
                possible_units_ui(ui, assembly, file, column, commands);
                ui.end_row();
            }
        });
    if headings.len() > MOST_COLUMNS {
        let more = headings.len() - MOST_COLUMNS;
        ui.label(palette.small(format!(
            "and {}; give the other headings in the rules file",
            counted(more, "more column")
        )));
    }
}

/// Shows buttons with the possible units for a column whose unit is unknown; a click sets the unit
/// in all tables with the same headings and the same missing units.
fn possible_units_ui(
    ui: &mut Ui,
    assembly: &AssemblyState,
    file: &str,
    column: usize,
    commands: &mut Vec<Command>,
) {
    let Some(missing_units) = assembly.missing_units.get(file) else {
        return;
    };
    let Some(missing) = missing_units.iter().find(|unit| unit.column == column) else {
        return;
    };
    let alike_count = assembly.tables_alike(file).len();
    ui.horizontal(|ui| {
        for unit in &missing.units {
            let name = format!("Column {} of {file} is in {unit}", column + 1);
            let hint = if alike_count == 1 {
                format!("The values are in {unit}")
            } else {
                format!(
                    "The values are in {unit}, also in the {} with these headings",
                    counted(alike_count - 1, "other table")
                )
            };
            let button = named(ui.small_button(*unit), Role::Button, name);
            if button.on_hover_text(hint).clicked() {
                commands.push(assembly.unit_change(file, column, unit));
            }
        }
    });
}
