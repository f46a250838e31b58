//! Entries of the command table for curves: units, read-outs, styles, visibility.

use egui::Key;

use super::command::Command;
use super::entry::{Entry, Menu};
use crate::gui::commands::display::DisplayCommand;
use crate::gui::commands::selection::SelectionCommand;
use crate::gui::plot::curve_command::CurveCommand;
use crate::gui::plot::quantity::{MagnitudeUnit, PhaseErrorUnit, PhaseUnit};
use crate::gui::state::curve_display::CurveDisplay;
use crate::gui::state::window_state::State;
use crate::gui::widgets::palette::{CurveColors, PlotStyle};

/// Returns the entries for units, read-outs, styles, and hidden curves.
pub fn curve_entries(state: &State) -> Vec<Entry> {
    let mut entries = unit_entries(state);
    entries.extend(look_entries(state.display.curves.looks));
    entries.extend(visibility_entries(state));
    entries
}

/// Returns an entry for each unit with two choices, which switches to the other.
fn unit_entries(state: &State) -> Vec<Entry> {
    let curves = &state.display.curves;
    let entry = |name: &str, meaning, command: CurveCommand| {
        Entry::new(name, meaning, command).within(Menu::Curves, 0)
    };
    vec![
        match curves.magnitude {
            MagnitudeUnit::Decibel => entry(
                "Magnitudes as ratios",
                "Output by input, in the units of the channels, on a logarithmic axis",
                CurveCommand::ReadMagnitudes(MagnitudeUnit::Ratio),
            ),
            MagnitudeUnit::Ratio => entry(
                "Magnitudes in decibels",
                "20 log10 of the ratio of output to input",
                CurveCommand::ReadMagnitudes(MagnitudeUnit::Decibel),
            ),
        },
        match curves.phase {
            PhaseUnit::Unwrapped => entry(
                "Phases wrapped",
                "Between −180° and 180°, with gaps where they jump",
                CurveCommand::DrawPhases(PhaseUnit::Wrapped),
            ),
            PhaseUnit::Wrapped => entry(
                "Phases unwrapped",
                "Continuous over frequency, on the branch nearest to the identified model",
                CurveCommand::DrawPhases(PhaseUnit::Unwrapped),
            ),
        },
        match curves.phase_error {
            PhaseErrorUnit::Degree => entry(
                "Phase errors as delays",
                "Δφ/ω [ms] in the plot of errors",
                CurveCommand::DrawPhaseErrors(PhaseErrorUnit::Millisecond),
            ),
            PhaseErrorUnit::Millisecond => entry(
                "Phase errors in degrees",
                "Δφ in the plot of errors",
                CurveCommand::DrawPhaseErrors(PhaseErrorUnit::Degree),
            ),
        },
        entry(
            if curves.lists_values {
                "List no values at the cursor"
            } else {
                "List values at the cursor"
            },
            "What every role has there, and its difference from the identified model",
            CurveCommand::ListValues(!curves.lists_values),
        ),
        entry(
            if curves.shows_bands {
                "Hide the bands of identified models"
            } else {
                "Show the bands of identified models"
            },
            "How far each identified response may lie from its curve, at 95 %",
            CurveCommand::ShowBands(!curves.shows_bands),
        ),
        entry(
            if curves.shows_muad {
                "Hide what a pilot does not notice"
            } else {
                "Show what a pilot does not notice"
            },
            "Envelopes of maximum unnoticeable added dynamics about the identified response in Bode, and in the plot of errors, with where \
             the mismatch leaves them",
            CurveCommand::ShowMuad(!curves.shows_muad),
        ),
    ]
}

fn look_entries(looks: PlotStyle) -> Vec<Entry> {
    let mut entries = Vec::new();
    for curve_colors in CurveColors::ALL
        .into_iter()
        .filter(|colors| *colors != looks.curve_colors)
    {
        let command = Command::Display(DisplayCommand::SetLooks(PlotStyle {
            curve_colors,
            ..looks
        }));
        let meaning = "For all eyes: colours that stay apart for people who do not see red, green or blue as others do";
        entries.push(Entry::new(curve_colors.name(), meaning, command).within(Menu::Curves, 1));
    }
    for line_width in PlotStyle::LINE_WIDTHS {
        let command = Command::Display(DisplayCommand::SetLooks(PlotStyle {
            line_width,
            ..looks
        }));
        let entry = Entry::new(
            format!("Lines × {line_width}"),
            "Widths of all curves, by the usual ones",
            command,
        );
        entries.push(
            entry
                .within(Menu::Curves, 2)
                .enabled(looks.line_width != line_width),
        );
    }
    entries
}

fn visibility_entries(state: &State) -> Vec<Entry> {
    let display = &state.display;
    let is_isolated = display.selection.isolated.is_some() || !display.curves.selected.is_empty();
    let is_hidden = !(display.curves.hidden_models.is_empty()
        && display
            .curves
            .hidden_roles
            .is_subset(&CurveDisplay::hidden_at_first()));
    let isolation = Entry::new(
        "End isolation and selection",
        "Show every model, select none",
        SelectionCommand::EndIsolation,
    );
    vec![
        // Fields and menus lose the key of an entry whether or not the entry is enabled, so it has
        // the key only if there is something to end.
        if is_isolated {
            isolation.free_key(Key::Escape)
        } else {
            isolation.enabled(false)
        }
        .within(Menu::Curves, 3),
        Entry::new(
            "Show hidden curves",
            "Draw every model, and the roles that are drawn at first",
            CurveCommand::ShowHidden,
        )
        .within(Menu::Curves, 3)
        .enabled(is_hidden),
        Entry::new(
            "Mark the frequency under the pointer",
            "In every plot over frequency; two marks show what changes between them",
            CurveCommand::PinCursor(display.curves.cursor.unwrap_or_default()),
        )
        .free_key(Key::M)
        .within(Menu::Curves, 3)
        .enabled(display.curves.cursor.is_some()),
        Entry::new(
            "Remove marks of frequencies",
            "In every plot over frequency",
            CurveCommand::UnpinCursors,
        )
        .within(Menu::Curves, 3)
        .enabled(!(display.curves.pinned.is_empty() && display.curves.crossings.is_empty())),
    ]
}
