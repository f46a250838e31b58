//! What stands where there is nothing to draw.

use egui::{Align2, Rect, Sense, Ui, WidgetInfo};

use crate::view::palette::{BODY_SIZE, Palette};

/// Shows `message` in the middle of `rect`, which it takes from `ui`.
pub(super) fn message_ui(ui: &mut Ui, rect: Rect, message: &str, palette: &Palette) {
    let response = ui.allocate_rect(rect, Sense::hover());
    response.widget_info(|| WidgetInfo::labeled(egui::Role::Label, true, message));
    let font = egui::FontId::proportional(BODY_SIZE);
    let galley = ui.painter().layout(message.to_owned(), font, palette.dim_text, (rect.width() - 32.0).max(40.0));
    let place = Align2::CENTER_CENTER.align_size_within_rect(galley.size(), rect);
    ui.painter().galley(place.min, galley, palette.dim_text);
}
