//! The choice of how curves are drawn.

use egui::Ui;

use super::command::Command;
use super::looks::{CurveColors, Looks};

/// Menu entries for the colours and the widths of curves; the present choice is marked.
pub fn looks_menu_ui(ui: &mut Ui, looks: Looks, commands: &mut Vec<Command>) {
    for curve_colors in CurveColors::ALL {
        let hint = match curve_colors {
            CurveColors::Standard => "Nominal red, perturbed blue, identified amber, corrected green",
            CurveColors::ForAllEyes => {
                "Colours that stay apart for people who do not see red, green or blue as others do"
            }
        };
        let chosen = looks.curve_colors == curve_colors;
        choice_ui(ui, curve_colors.name(), hint, chosen, Looks { curve_colors, ..looks }, commands);
    }
    ui.separator();
    for line_width in Looks::LINE_WIDTHS {
        let chosen = looks.line_width == line_width;
        let hint = "Widths of all curves, as a multiple of the usual ones";
        choice_ui(ui, &format!("Lines × {line_width}"), hint, chosen, Looks { line_width, ..looks }, commands);
    }
}

fn choice_ui(ui: &mut Ui, text: &str, hint: &str, chosen: bool, looks: Looks, commands: &mut Vec<Command>) {
    if ui.radio(chosen, text).on_hover_text(hint).clicked() {
        commands.push(Command::SetLooks(looks));
        ui.close();
    }
}
