//! Command-table entries for curves: units, read-outs, styles, visibility.

use egui::Key;

use super::display::DisplayCommand;
use super::entry::{Entry, Menu, group};
use super::selection::SelectionCommand;
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

/// Returns an entry for each display option with two values; the entry switches to the other value.
fn unit_entries(state: &State) -> Vec<Entry> {
    let curves = &state.display.curves;
    let entries = [
        magnitude_entry(curves.magnitude),
        phase_entry(curves.phase),
        phase_error_entry(curves.phase_error),
        Entry::new(
            if curves.lists_values {
                "Hide the values at the cursor"
            } else {
                "List values at the cursor"
            },
            "Value of every role, and its difference from the identified model",
            CurveCommand::ListValues(!curves.lists_values),
        ),
        Entry::new(
            if curves.shows_bands {
                "Hide the bands of identified models"
            } else {
                "Show the bands of identified models"
            },
            "95 % confidence band of each identified response",
            CurveCommand::ShowBands(!curves.shows_bands),
        ),
        Entry::new(
            if curves.shows_muad {
                "Hide MUAD envelopes"
            } else {
                "Show MUAD envelopes"
            },
            "Envelopes of maximum unnoticeable added dynamics (MUAD) around the identified \
            response, in Bode and in the error plot, and the frequencies at which the mismatch \
            leaves them",
            CurveCommand::ShowMuad(!curves.shows_muad),
        ),
    ];
    group(Menu::Curves, 0, entries).collect()
}

fn magnitude_entry(unit: MagnitudeUnit) -> Entry {
    match unit {
        MagnitudeUnit::Decibel => Entry::new(
            "Magnitudes as ratios",
            "Output divided by input, in the units of the channels, on a logarithmic axis",
            CurveCommand::ReadMagnitudes(MagnitudeUnit::Ratio),
        ),
        MagnitudeUnit::Ratio => Entry::new(
            "Magnitudes in decibels",
            "20 log10 of the ratio of output to input",
            CurveCommand::ReadMagnitudes(MagnitudeUnit::Decibel),
        ),
    }
}

fn phase_entry(unit: PhaseUnit) -> Entry {
    match unit {
        PhaseUnit::Unwrapped => Entry::new(
            "Phases wrapped",
            "Between −180° and 180°, with gaps where they jump",
            CurveCommand::DrawPhases(PhaseUnit::Wrapped),
        ),
        PhaseUnit::Wrapped => Entry::new(
            "Phases unwrapped",
            "Continuous over frequency, on the branch nearest to the identified model",
            CurveCommand::DrawPhases(PhaseUnit::Unwrapped),
        ),
    }
}

fn phase_error_entry(unit: PhaseErrorUnit) -> Entry {
    match unit {
        PhaseErrorUnit::Degree => Entry::new(
            "Phase errors as delays",
            "Δφ/ω [ms] in the error plot",
            CurveCommand::DrawPhaseErrors(PhaseErrorUnit::Millisecond),
        ),
        PhaseErrorUnit::Millisecond => Entry::new(
            "Phase errors in degrees",
            "Δφ [deg] in the error plot",
            CurveCommand::DrawPhaseErrors(PhaseErrorUnit::Degree),
        ),
    }
}

/// Returns the entries for the curve colours that are not in use, and for every line width.
fn look_entries(looks: PlotStyle) -> Vec<Entry> {
    let mut entries = Vec::new();
    for curve_colors in CurveColors::ALL {
        if curve_colors == looks.curve_colors {
            continue;
        }
        let command = DisplayCommand::SetLooks(PlotStyle {
            curve_colors,
            ..looks
        });
        let meaning = "Standard colours, or colours that are distinct with any colour vision";
        entries.push(Entry::new(curve_colors.name(), meaning, command).within(Menu::Curves, 1));
    }
    for line_width in PlotStyle::LINE_WIDTHS {
        let command = DisplayCommand::SetLooks(PlotStyle {
            line_width,
            ..looks
        });
        let entry = Entry::new(
            format!("Lines × {line_width}"),
            "Widths of all curves, relative to the default",
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

/// Returns the entries that end the isolation, show hidden curves, and set or remove frequency
/// marks.
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
        "Show every model and clear the selection",
        SelectionCommand::EndIsolation,
    );
    vec![
        // Escape is listed with this entry only while models are isolated or selected; otherwise
        // the key only closes forms, menus and sheets.
        if is_isolated {
            isolation.free_key(Key::Escape)
        } else {
            isolation.enabled(false)
        }
        .within(Menu::Curves, 3),
        Entry::new(
            "Show hidden curves",
            "Draw every model, and the roles drawn by default",
            CurveCommand::ShowHidden,
        )
        .within(Menu::Curves, 3)
        .enabled(is_hidden),
        Entry::new(
            "Mark the frequency under the pointer",
            "In every plot over frequency; two marks show the difference between them",
            CurveCommand::PinCursor(display.curves.cursor.unwrap_or_default()),
        )
        .free_key(Key::M)
        .within(Menu::Curves, 3)
        .enabled(display.curves.cursor.is_some()),
        Entry::new(
            "Remove frequency marks",
            "In every plot over frequency",
            CurveCommand::RemoveFrequencyMarks,
        )
        .within(Menu::Curves, 3)
        .enabled(!(display.curves.pinned.is_empty() && display.curves.crossings.is_empty())),
    ]
}
