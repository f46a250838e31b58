//! How the engineer likes the window: kept from one day to the next, and no part of a study.

use std::collections::BTreeSet;

use serde::{Deserialize, Serialize};

use super::arrangement::Arrangement;
use super::display::Display;
use super::plot::{FrequencyUnit, MagnitudeUnit, PhaseErrorUnit, PhaseUnit, Role};
use super::plot_style::PlotStyle;

/// How the engineer likes the window. What a later version adds has its usual value where a text of an earlier one is read.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Preferences {
    /// How the plots share the middle of the window.
    pub arrangement: Option<Arrangement>,
    /// Unit of frequencies.
    pub frequency_unit: FrequencyUnit,
    /// How magnitudes are read.
    pub magnitude: MagnitudeUnit,
    /// How phases are drawn.
    pub phase: PhaseUnit,
    /// How differences of phases are drawn.
    pub phase_error: PhaseErrorUnit,
    /// Roles whose curves are not drawn.
    pub hidden_roles: BTreeSet<Role>,
    /// Whether the plot of errors shows what a pilot does not notice.
    pub shows_muad: bool,
    /// Whether the values at the cursor are not listed.
    pub lists_no_values: bool,
    /// How curves are drawn.
    pub looks: PlotStyle,
}

impl Preferences {
    /// Those that the window has now.
    pub fn of(display: &Display) -> Self {
        Self {
            arrangement: Some(display.arrangement.clone()),
            frequency_unit: display.unit,
            magnitude: display.curves.magnitude,
            phase: display.curves.phase,
            phase_error: display.curves.phase_error,
            hidden_roles: display.curves.hidden_roles.clone(),
            shows_muad: display.curves.shows_muad,
            lists_no_values: !display.curves.lists_values,
            looks: display.looks,
        }
    }

    /// Gives a window these preferences.
    pub fn apply(&self, display: &mut Display) {
        display.arrangement = self.arrangement.clone().and_then(Arrangement::if_whole).unwrap_or_default();
        display.unit = self.frequency_unit;
        display.curves.magnitude = self.magnitude;
        display.curves.phase = self.phase;
        display.curves.phase_error = self.phase_error;
        display.curves.hidden_roles.clone_from(&self.hidden_roles);
        display.curves.shows_muad = self.shows_muad;
        display.curves.lists_values = !self.lists_no_values;
        display.looks = self.looks.within_limits();
    }
}
