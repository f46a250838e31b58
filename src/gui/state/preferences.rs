//! Preferences that persist between sessions.

use std::collections::BTreeSet;

use serde::{Deserialize, Serialize};

use gdcm_plot::figure::axis::FrequencyUnit;

use super::curve_display::CurveDisplay;
use super::display::Display;
use super::opens_with::OpensWith;
use super::view_arrangement::Arrangement;
use crate::gui::plot::Role;
use crate::gui::plot::quantity::{MagnitudeUnit, PhaseErrorUnit, PhaseUnit};
use crate::gui::widgets::palette::PlotStyle;

/// The window's preferences. Fields that are missing from a file written by an earlier version get
/// their default values.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Preferences {
    pub arrangement: Option<Arrangement>,
    /// Content shown at the next start.
    pub opens_with: OpensWith,
    /// Whether the left panel is shown in full; `None` follows the window width.
    pub left_open: Option<bool>,
    pub frequency_unit: FrequencyUnit,
    pub magnitude: MagnitudeUnit,
    pub phase: PhaseUnit,
    pub phase_error: PhaseErrorUnit,
    /// Roles whose visibility differs from the default. Only differences are stored, because later
    /// versions may change the default.
    pub hidden_roles: BTreeSet<Role>,
    /// Whether the Bode and error plots show the envelopes for maximum unnoticeable added dynamics.
    pub shows_muad: bool,
    pub shows_bands: bool,
    /// Whether the list of values at the cursor is hidden.
    pub lists_no_values: bool,
    pub looks: PlotStyle,
}

impl Preferences {
    /// Returns the window's current preferences.
    pub fn from_display(display: &Display) -> Self {
        Self {
            arrangement: Some(display.layout.arrangement.clone()),
            opens_with: display.layout.opens_with,
            left_open: display.layout.left_open,
            frequency_unit: display.curves.unit,
            magnitude: display.curves.magnitude,
            phase: display.curves.phase,
            phase_error: display.curves.phase_error,
            hidden_roles: &display.curves.hidden_roles ^ &CurveDisplay::hidden_at_first(),
            shows_muad: display.curves.shows_muad,
            shows_bands: display.curves.shows_bands,
            lists_no_values: !display.curves.lists_values,
            looks: display.curves.looks,
        }
    }

    /// Applies these preferences to a window; an invalid arrangement or line width is replaced by a
    /// valid one.
    pub fn apply(&self, display: &mut Display) {
        display.layout.arrangement = self
            .arrangement
            .clone()
            .and_then(Arrangement::adapted)
            .unwrap_or_default();
        display.layout.opens_with = self.opens_with;
        display.layout.left_open = self.left_open;
        display.curves.unit = self.frequency_unit;
        display.curves.magnitude = self.magnitude;
        display.curves.phase = self.phase;
        display.curves.phase_error = self.phase_error;
        display.curves.hidden_roles = &self.hidden_roles ^ &CurveDisplay::hidden_at_first();
        display.curves.shows_muad = self.shows_muad;
        display.curves.shows_bands = self.shows_bands;
        display.curves.lists_values = !self.lists_no_values;
        display.curves.looks = self.looks.within_limits();
    }
}
