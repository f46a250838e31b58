//! Text field for a limit, in the displayed unit.

use egui::Ui;

use gdcm_model::units::number;

use crate::gui::commands::command::Command;
use crate::gui::widgets::number_entry::number_entry_ui;

/// Field width \[pt\].
const FIELD_WIDTH: f32 = 56.0;

pub(super) struct LimitField {
    /// Accessible name.
    name: String,
    /// Factor from the stored to the displayed value.
    to_shown: f64,
    /// Factor from the typed to the stored value, the inverse of `to_shown`.
    to_stored: f64,
}

impl LimitField {
    /// Creates a field that displays the stored value without conversion.
    pub(super) fn new(name: impl Into<String>) -> Self {
        Self {
            name: name.into(),
            to_shown: 1.0,
            to_stored: 1.0,
        }
    }

    pub(super) fn in_percent(name: impl Into<String>) -> Self {
        Self {
            to_shown: 100.0,
            to_stored: 0.01,
            ..Self::new(name)
        }
    }

    /// Creates a field in milliseconds for a value stored in seconds.
    pub(super) fn in_ms(name: impl Into<String>) -> Self {
        Self {
            to_shown: 1e3,
            to_stored: 1e-3,
            ..Self::new(name)
        }
    }

    /// Draws the field, and changes `value` if a number was entered.
    pub(super) fn ui(&self, ui: &mut Ui, value: &mut f64, commands: &mut Vec<Command>) {
        let text = self.text(*value);
        let entry = number_entry_ui(ui, &self.name, &text, "", FIELD_WIDTH, commands);
        // An emptied field leaves the value unchanged.
        if let Some(Some(typed)) = entry {
            *value = self.to_stored * typed;
        }
    }

    /// Like [`ui`](Self::ui), but an empty field gives `None`.
    pub(super) fn optional_ui(
        &self,
        ui: &mut Ui,
        value: &mut Option<f64>,
        commands: &mut Vec<Command>,
    ) {
        let text = match value {
            Some(value) => self.text(*value),
            None => String::new(),
        };
        let entry = number_entry_ui(ui, &self.name, &text, "none", FIELD_WIDTH, commands);
        if let Some(typed) = entry {
            *value = typed.map(|typed| self.to_stored * typed);
        }
    }

    /// Formats a stored value in the displayed unit, rounded to nine decimals: without the rounding
    /// error that the conversion adds, as in 0.07 · 100 = 7.000000000000001.
    fn text(&self, value: f64) -> String {
        number((1e9 * (self.to_shown * value)).round() / 1e9)
    }
}
