//! Text field for a file or folder path.

use egui::{Response, Ui};

use crate::gui::widgets::text_fields::text_field_ui;

/// Draws the field; `hint` is shown while it is empty.
pub(super) fn path_field_ui(ui: &mut Ui, name: &str, path: &mut String, hint: &str) -> Response {
    let width = (0.22 * ui.available_width()).clamp(120.0, 360.0);
    text_field_ui(ui, name, path, hint, width)
}
