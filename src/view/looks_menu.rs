//! The choice of how curves are drawn, and in which units.

use egui::Ui;

use super::command::Command;
use super::curve_display::{CurveCommand, CurveDisplay};
use super::looks::{CurveColors, Looks};
use super::plot::{MagnitudeUnit, PhaseErrorUnit, PhaseUnit};

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

/// Menu entries for the units of the plots over frequency and for what they list.
pub fn curve_units_menu_ui(ui: &mut Ui, display: &CurveDisplay, commands: &mut Vec<Command>) {
    let mut choice = |ui: &mut Ui, text: &str, hint: &str, chosen: bool, command: CurveCommand| {
        if ui.radio(chosen, text).on_hover_text(hint).clicked() {
            commands.push(command.into());
            ui.close();
        }
    };
    for (unit, text, hint) in [
        (MagnitudeUnit::Decibel, "Magnitudes in decibels", "20 log10 of the ratio of output to input"),
        (
            MagnitudeUnit::Ratio,
            "Magnitudes as ratios",
            "Output by input, in the units of the channels, on a logarithmic axis",
        ),
    ] {
        choice(ui, text, hint, display.magnitude == unit, CurveCommand::ReadMagnitudes(unit));
    }
    ui.separator();
    for (unit, text, hint) in [
        (
            PhaseUnit::Unwrapped,
            "Phases unwrapped",
            "Continuous over frequency, on the branch nearest to the identified model",
        ),
        (PhaseUnit::Wrapped, "Phases wrapped", "Between −180° and 180°, with gaps where they jump"),
    ] {
        choice(ui, text, hint, display.phase == unit, CurveCommand::DrawPhases(unit));
    }
    ui.separator();
    for (unit, text, hint) in [
        (PhaseErrorUnit::Degree, "Phase errors in degrees", "Δφ in the plot of errors"),
        (PhaseErrorUnit::Millisecond, "Phase errors as delays", "Δφ/ω [ms] in the plot of errors"),
    ] {
        choice(ui, text, hint, display.phase_error == unit, CurveCommand::DrawPhaseErrors(unit));
    }
    ui.separator();
    for (wanted, text) in [(true, "List values at the cursor"), (false, "List no values")] {
        let hint = "What every role has at the cursor, and its difference from the identified model";
        choice(ui, text, hint, display.lists_values == wanted, CurveCommand::ListValues(wanted));
    }
}
