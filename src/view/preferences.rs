//! How the engineer likes the window: kept from one day to the next, and no part of a study.

use serde::{Deserialize, Serialize};

use super::arrangement::Arrangement;
use super::display::Display;
use super::looks::Looks;
use super::plot::{FrequencyUnit, PhaseErrorUnit};

/// How the engineer likes the window. What a later version adds has its usual value where a text of an earlier one is read.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Preferences {
    /// How the plots share the middle of the window.
    pub arrangement: Option<Arrangement>,
    /// Unit of frequencies.
    pub frequency_unit: FrequencyUnit,
    /// How differences of phases are drawn.
    pub phase_error: PhaseErrorUnit,
    /// How curves are drawn.
    pub looks: Looks,
}

impl Preferences {
    /// Those that the window has now.
    pub fn of(display: &Display) -> Self {
        Self {
            arrangement: Some(display.arrangement.clone()),
            frequency_unit: display.unit,
            phase_error: display.phase_error,
            looks: display.looks,
        }
    }

    /// Gives a window these preferences.
    pub fn apply(&self, display: &mut Display) {
        display.arrangement = self.arrangement.clone().and_then(Arrangement::if_whole).unwrap_or_default();
        display.unit = self.frequency_unit;
        display.phase_error = self.phase_error;
        display.looks = self.looks.within_limits();
    }
}
