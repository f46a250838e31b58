//! The choice of how curves are drawn, and in which units: for menus, and for the palette.

use egui::Ui;

use super::command::Command;
use super::command_table::Entry;
use super::curve_display::{CurveCommand, CurveDisplay};
use super::looks::{CurveColors, Looks};
use super::plot::{MagnitudeUnit, PhaseErrorUnit, PhaseUnit};

/// One of several that exclude one another, and whether it is the present one.
type Choice = (Entry, bool);

/// Menu entries of choices, in groups parted by lines; the present choice of each is marked.
pub fn choices_menu_ui(ui: &mut Ui, groups: Vec<Vec<Choice>>, commands: &mut Vec<Command>) {
    for (number, group) in groups.into_iter().enumerate() {
        if number > 0 {
            ui.separator();
        }
        for (entry, is_chosen) in group {
            if ui.radio(is_chosen, entry.name.as_str()).on_hover_text(entry.meaning).clicked() {
                commands.push(entry.command);
                ui.close();
            }
        }
    }
}

/// The colours and the widths of curves.
pub fn looks_choices(looks: Looks) -> Vec<Vec<Choice>> {
    let colors = CurveColors::ALL.map(|curve_colors| {
        let meaning = match curve_colors {
            CurveColors::Standard => "Nominal red, perturbed blue, identified amber, corrected green",
            CurveColors::ForAllEyes => {
                "Colours that stay apart for people who do not see red, green or blue as others do"
            }
        };
        let command = Command::SetLooks(Looks { curve_colors, ..looks });
        (Entry::new(curve_colors.name(), meaning, command), looks.curve_colors == curve_colors)
    });
    let widths = Looks::LINE_WIDTHS.map(|line_width| {
        let meaning = "Widths of all curves, as a multiple of the usual ones";
        let command = Command::SetLooks(Looks { line_width, ..looks });
        (Entry::new(format!("Lines × {line_width}"), meaning, command), looks.line_width == line_width)
    });
    vec![colors.into(), widths.into()]
}

/// The units of the plots over frequency, and what they list.
pub fn curve_unit_choices(display: &CurveDisplay) -> Vec<Vec<Choice>> {
    let choice = |name: &str, meaning: &'static str, command: CurveCommand, is_chosen: bool| {
        (Entry::new(name, meaning, command.into()), is_chosen)
    };
    let magnitude =
        |unit, name, meaning| choice(name, meaning, CurveCommand::ReadMagnitudes(unit), display.magnitude == unit);
    let phase = |unit, name, meaning| choice(name, meaning, CurveCommand::DrawPhases(unit), display.phase == unit);
    let phase_error =
        |unit, name, meaning| choice(name, meaning, CurveCommand::DrawPhaseErrors(unit), display.phase_error == unit);
    let list = |wanted, name| {
        let meaning = "What every role has at the cursor, and its difference from the identified model";
        choice(name, meaning, CurveCommand::ListValues(wanted), display.lists_values == wanted)
    };
    vec![
        vec![
            magnitude(MagnitudeUnit::Decibel, "Magnitudes in decibels", "20 log10 of the ratio of output to input"),
            magnitude(
                MagnitudeUnit::Ratio,
                "Magnitudes as ratios",
                "Output by input, in the units of the channels, on a logarithmic axis",
            ),
        ],
        vec![
            phase(
                PhaseUnit::Unwrapped,
                "Phases unwrapped",
                "Continuous over frequency, on the branch nearest to the identified model",
            ),
            phase(PhaseUnit::Wrapped, "Phases wrapped", "Between −180° and 180°, with gaps where they jump"),
        ],
        vec![
            phase_error(PhaseErrorUnit::Degree, "Phase errors in degrees", "Δφ in the plot of errors"),
            phase_error(PhaseErrorUnit::Millisecond, "Phase errors as delays", "Δφ/ω [ms] in the plot of errors"),
        ],
        vec![list(true, "List values at the cursor"), list(false, "List no values")],
    ]
}
