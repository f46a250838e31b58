//! Options for displaying plots over frequency: units, hidden curves, cursors. No result depends on
//! them.
//!
//! A role ([`Role`]) is the meaning of curves, such as nominal, identified or corrected model;
//! curves are shown, hidden and raised by role.

use std::collections::{BTreeMap, BTreeSet};

use gdcm_model::dataset::{ConditionId, ModelId, Pair};
use gdcm_plot::figure::axis::FrequencyUnit;

use crate::gui::plot::curve_command::CurveCommand;
use crate::gui::plot::quantity::{MagnitudeUnit, PhaseErrorUnit, PhaseUnit};
use crate::gui::plot::{CurveId, Role};
use crate::gui::widgets::palette::PlotStyle;

#[derive(Clone, Debug, PartialEq)]
pub struct CurveDisplay {
    /// Unit on the frequency axes.
    pub unit: FrequencyUnit,
    /// Curve colours and widths.
    pub looks: PlotStyle,
    pub magnitude: MagnitudeUnit,
    pub phase: PhaseUnit,
    pub phase_error: PhaseErrorUnit,
    pub hidden_roles: BTreeSet<Role>,
    pub hidden_models: BTreeSet<ModelId>,
    /// Whole turns by which the engineer shifted a curve's phases upwards.
    pub turns: BTreeMap<(ConditionId, Pair, CurveId), i32>,
    /// Frequency under the pointer, in any plot \[rad/s\].
    pub cursor: Option<f64>,
    /// Marked frequencies \[rad/s\]: none, one or two.
    pub pinned: Vec<f64>,
    /// Named frequencies \[rad/s\] that define the displayed response's bandwidth.
    pub crossings: Vec<(&'static str, f64)>,
    /// Whether the values at the cursor are listed.
    pub lists_values: bool,
    /// Whether the Bode and error plots show the envelopes for maximum unnoticeable added dynamics.
    pub shows_muad: bool,
    /// Models selected by drawing a box.
    pub selected: BTreeSet<ModelId>,
    /// Whether confidence bands about identified responses are drawn.
    pub shows_bands: bool,
    /// Role drawn above all other roles.
    pub raised: Option<Role>,
}

impl Default for CurveDisplay {
    fn default() -> Self {
        Self {
            unit: FrequencyUnit::default(),
            looks: PlotStyle::default(),
            magnitude: MagnitudeUnit::default(),
            phase: PhaseUnit::default(),
            phase_error: PhaseErrorUnit::default(),
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
    /// Maximum number of marked frequencies; the difference between two is shown.
    const MOST_PINNED: usize = 2;
    /// Maximum number of turns by which a phase can be shifted, in either direction.
    const MOST_TURNS: i32 = 99;

    /// Returns the roles hidden by default: couplings alone are an intermediate step, not a result.
    pub fn hidden_at_first() -> BTreeSet<Role> {
        BTreeSet::from([Role::Coupled])
    }

    /// Changes the display as a command requests.
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
            // Asked again, shows the other roles again.
            CurveCommand::ShowRoleAlone(role) => {
                let mut others = BTreeSet::from(Role::ALL);
                others.remove(&role);
                self.hidden_roles = if self.hidden_roles == others {
                    Self::hidden_at_first()
                } else {
                    others
                };
            }
            CurveCommand::RaiseRole(role) => {
                self.raised = if self.raised == Some(role) {
                    None
                } else {
                    Some(role)
                };
            }
            CurveCommand::ShowBands(is_shown) => self.shows_bands = is_shown,
            CurveCommand::HideModel(model) => {
                self.hidden_models.insert(model);
            }
            CurveCommand::ShowHidden => {
                self.hidden_models.clear();
                self.hidden_roles = Self::hidden_at_first();
            }
            CurveCommand::Turn {
                condition,
                pair,
                curve,
                turns: change,
            } => {
                let turns = self.turns.entry((condition, pair, curve)).or_default();
                *turns = (*turns + change).clamp(-Self::MOST_TURNS, Self::MOST_TURNS);
            }
            CurveCommand::PointAt(omega) => self.cursor = Some(omega),
            CurveCommand::PinCursor(omega) => {
                self.pinned.push(omega);
                // A third mark replaces the oldest.
                if self.pinned.len() > Self::MOST_PINNED {
                    self.pinned.remove(0);
                }
            }
            CurveCommand::RemoveFrequencyMarks => {
                self.pinned.clear();
                self.crossings.clear();
            }
            CurveCommand::MarkCrossings(crossings) => self.crossings = crossings,
            CurveCommand::ListValues(is_shown) => self.lists_values = is_shown,
            CurveCommand::ShowMuad(is_shown) => self.shows_muad = is_shown,
            CurveCommand::Select(models) => self.selected = models,
        }
    }

    /// Drops all display options that concern single models; called when the dataset is replaced.
    pub fn forget_models(&mut self) {
        self.hidden_models.clear();
        self.turns.clear();
        self.selected.clear();
    }
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
        display.carry_out(CurveCommand::RemoveFrequencyMarks);
        assert!(display.pinned.is_empty());
    }

    #[test]
    fn a_role_is_shown_alone_and_in_front_and_a_second_command_restores_the_others() {
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
    fn a_role_is_a_switch_and_a_single_command_shows_everything_hidden() {
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
