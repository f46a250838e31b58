//! Display options of the plots over frequency: units, hidden curves, cursors. None of them changes
//! a result.

use std::collections::{BTreeMap, BTreeSet};

use egui::Key;

use gdcm_model::dataset::{ConditionId, ModelId, Pair};

use super::window_state::State;
use crate::gui::commands::command::Command;
use crate::gui::commands::command_table::{Entry, Menu};
use crate::gui::plot::curve_command::CurveCommand;
use crate::gui::plot::quantity::{MagnitudeUnit, PhaseErrorUnit, PhaseUnit};
use crate::gui::plot::{CurveId, Role};
use crate::gui::widgets::palette::{CurveColors, PlotStyle};

/// Display options of the plots over frequency.
#[derive(Clone, Debug, PartialEq)]
pub struct CurveDisplay {
    pub magnitude: MagnitudeUnit,
    pub phase: PhaseUnit,
    pub phase_error: PhaseErrorUnit,
    pub hidden_roles: BTreeSet<Role>,
    pub hidden_models: BTreeSet<ModelId>,
    /// Whole turns by which phases were shifted up by hand.
    pub turns: BTreeMap<(ConditionId, Pair, CurveId), i32>,
    /// Frequency under the pointer, in any plot \[rad/s\].
    pub cursor: Option<f64>,
    /// Marked frequencies \[rad/s\]: none, one or two.
    pub pinned: Vec<f64>,
    /// Frequencies, with their names, that define the bandwidth of the displayed response
    /// \[rad/s\].
    pub crossings: Vec<(&'static str, f64)>,
    /// Whether the values at the cursor are listed.
    pub lists_values: bool,
    /// Whether Bode and the plot of errors show the envelopes of maximum unnoticeable added
    /// dynamics.
    pub shows_muad: bool,
    /// Models selected by drawing a box.
    pub selected: BTreeSet<ModelId>,
    pub shows_bands: bool,
    /// Role drawn above all others.
    pub raised: Option<Role>,
}

impl Default for CurveDisplay {
    fn default() -> Self {
        Self {
            magnitude: MagnitudeUnit::default(),
            phase: PhaseUnit::default(),
            phase_error: PhaseErrorUnit::default(),
            // Curves with couplings alone are optional.
            hidden_roles: Self::hidden_at_first(),
            hidden_models: BTreeSet::new(),
            turns: BTreeMap::new(),
            cursor: None,
            pinned: Vec::new(),
            crossings: Vec::new(),
            lists_values: true,
            shows_muad: false,
            selected: BTreeSet::new(),
            shows_bands: false,
            raised: None,
        }
    }
}

impl CurveDisplay {
    /// Most marked frequencies: of two, the difference is reported.
    const MOST_PINNED: usize = 2;

    /// Returns the roles hidden by default: couplings alone are an intermediate step, not a result.
    pub fn hidden_at_first() -> BTreeSet<Role> {
        BTreeSet::from([Role::Coupled])
    }

    /// Carries out a command.
    pub fn carry_out(&mut self, command: CurveCommand) {
        match command {
            CurveCommand::ReadMagnitudes(unit) => self.magnitude = unit,
            CurveCommand::DrawPhases(unit) => self.phase = unit,
            CurveCommand::DrawPhaseErrors(unit) => self.phase_error = unit,
            CurveCommand::ToggleRole(role) => {
                if !self.hidden_roles.remove(&role) {
                    self.hidden_roles.insert(role);
                }
            }
            CurveCommand::ShowRoleAlone(role) => {
                let others: BTreeSet<Role> = Role::ALL
                    .into_iter()
                    .filter(|other| *other != role)
                    .collect();
                self.hidden_roles = if self.hidden_roles == others {
                    Self::hidden_at_first()
                } else {
                    others
                };
            }
            CurveCommand::RaiseRole(role) => {
                self.raised = (self.raised != Some(role)).then_some(role)
            }
            CurveCommand::ShowBands(wanted) => self.shows_bands = wanted,
            CurveCommand::HideModel(model) => {
                self.hidden_models.insert(model);
            }
            CurveCommand::ShowHidden => {
                self.hidden_models.clear();
                self.hidden_roles = Self::hidden_at_first();
            }
            CurveCommand::Turn(condition, pair, curve, by) => {
                let turns = self.turns.entry((condition, pair, curve)).or_default();
                *turns = (*turns + by).clamp(-99, 99);
            }
            CurveCommand::PointAt(omega) => self.cursor = Some(omega),
            CurveCommand::PinCursor(omega) => {
                self.pinned.push(omega);
                if self.pinned.len() > Self::MOST_PINNED {
                    self.pinned.remove(0);
                }
            }
            CurveCommand::UnpinCursors => {
                self.pinned.clear();
                self.crossings.clear();
            }
            CurveCommand::MarkCrossings(crossings) => self.crossings = crossings,
            CurveCommand::ListValues(wanted) => self.lists_values = wanted,
            CurveCommand::ShowMuad(wanted) => self.shows_muad = wanted,
            CurveCommand::Select(models) => self.selected = models,
        }
    }

    /// Drops everything that refers to models of another dataset.
    pub fn forget_models(&mut self) {
        self.hidden_models.clear();
        self.turns.clear();
        self.selected.clear();
    }
}

/// Returns the entries for units, read-outs, styles, and hidden curves.
pub(crate) fn curve_entries(state: &State) -> Vec<Entry> {
    let mut entries = unit_entries(state);
    entries.extend(look_entries(state.display.looks));
    entries.extend(visibility_entries(state));
    entries
}

/// Returns an entry for each unit with two choices, which switches to the other.
fn unit_entries(state: &State) -> Vec<Entry> {
    let curves = &state.display.curves;
    let entry = |name: &str, meaning, command: CurveCommand| {
        Entry::new(name, meaning, command.into()).within(Menu::Curves, 0)
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
        let command = Command::SetLooks(PlotStyle {
            curve_colors,
            ..looks
        });
        let meaning = "For all eyes: colours that stay apart for people who do not see red, green or blue as others do";
        entries.push(Entry::new(curve_colors.name(), meaning, command).within(Menu::Curves, 1));
    }
    for line_width in PlotStyle::LINE_WIDTHS {
        let command = Command::SetLooks(PlotStyle {
            line_width,
            ..looks
        });
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
    let is_isolated = display.isolated.is_some() || !display.curves.selected.is_empty();
    let is_hidden = !(display.curves.hidden_models.is_empty()
        && display
            .curves
            .hidden_roles
            .is_subset(&CurveDisplay::hidden_at_first()));
    let isolation = Entry::new(
        "End isolation and selection",
        "Show every model, select none",
        Command::EndIsolation,
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
            CurveCommand::ShowHidden.into(),
        )
        .within(Menu::Curves, 3)
        .enabled(is_hidden),
        Entry::new(
            "Mark the frequency under the pointer",
            "In every plot over frequency; two marks show what changes between them",
            CurveCommand::PinCursor(display.curves.cursor.unwrap_or_default()).into(),
        )
        .free_key(Key::M)
        .within(Menu::Curves, 3)
        .enabled(display.curves.cursor.is_some()),
        Entry::new(
            "Remove marks of frequencies",
            "In every plot over frequency",
            CurveCommand::UnpinCursors.into(),
        )
        .within(Menu::Curves, 3)
        .enabled(!(display.curves.pinned.is_empty() && display.curves.crossings.is_empty())),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_third_marked_frequency_takes_the_place_of_the_first() {
        let mut display = CurveDisplay::default();
        for omega in [1.0, 2.0, 3.0] {
            display.carry_out(CurveCommand::PinCursor(omega));
        }
        assert_eq!(display.pinned, [2.0, 3.0]);
        display.carry_out(CurveCommand::UnpinCursors);
        assert!(display.pinned.is_empty());
    }

    #[test]
    fn a_role_can_be_shown_alone_and_in_front_and_again_as_usual() {
        let mut display = CurveDisplay::default();
        for command in [
            CurveCommand::ShowRoleAlone(Role::Corrected),
            CurveCommand::RaiseRole(Role::Nominal),
        ] {
            display.carry_out(command);
        }
        assert_eq!(
            (display.hidden_roles.len(), display.raised),
            (Role::ALL.len() - 1, Some(Role::Nominal))
        );
        assert!(!display.hidden_roles.contains(&Role::Corrected));
        for command in [
            CurveCommand::ShowRoleAlone(Role::Corrected),
            CurveCommand::RaiseRole(Role::Nominal),
        ] {
            display.carry_out(command);
        }
        assert_eq!(display, CurveDisplay::default());
    }

    #[test]
    fn a_role_is_a_switch_and_everything_hidden_comes_back_at_once() {
        let mut display = CurveDisplay::default();
        display.carry_out(CurveCommand::ToggleRole(Role::Perturbed));
        assert!(display.hidden_roles.contains(&Role::Perturbed));
        display.carry_out(CurveCommand::ToggleRole(Role::Perturbed));
        assert_eq!(display, CurveDisplay::default());
        display.carry_out(CurveCommand::ToggleRole(Role::Rejected));
        display.carry_out(CurveCommand::ShowHidden);
        assert_eq!(display, CurveDisplay::default());
    }
}
