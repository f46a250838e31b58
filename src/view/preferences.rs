//! How the engineer likes the window: kept from one day to the next, and no part of a study.

use serde::{Deserialize, Serialize};

use super::arrangement::Arrangement;
use super::display::Display;
use super::plot::FrequencyUnit;

/// How the engineer likes the window. What a later version adds has its usual value where a text of an earlier one is read.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Preferences {
    /// How the plots share the middle of the window, see [`Arrangement::to_text`].
    pub arrangement: Option<String>,
    /// Unit of frequencies.
    pub frequency_unit: FrequencyUnit,
}

impl Preferences {
    /// Those that the window has now.
    pub fn of(display: &Display) -> Self {
        Self { arrangement: display.arrangement.to_text(), frequency_unit: display.unit }
    }

    /// Gives a window these preferences.
    pub fn apply(&self, display: &mut Display) {
        display.arrangement = self.arrangement.as_deref().and_then(Arrangement::from_text).unwrap_or_default();
        display.unit = self.frequency_unit;
    }
}
