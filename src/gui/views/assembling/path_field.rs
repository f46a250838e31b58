//! Text field for a file or folder path.

use egui::Ui;

use crate::gui::widgets::text_fields::{is_entered, text_field_ui};

/// Draws the field; returns whether Enter ended the editing.
pub(super) fn path_ui(ui: &mut Ui, name: &str, path: &mut String, hint: &str) -> bool {
    let width = (0.22 * ui.available_width()).clamp(120.0, 360.0);
    let response = text_field_ui(ui, name, path, hint, width);
    is_entered(ui, &response)
}
