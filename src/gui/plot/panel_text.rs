//! Texts in and around panels: the caption font, the position at the right, and the message in an
//! empty plot.

use egui::{Align2, FontId, Rect, Sense, Ui, WidgetInfo};

use crate::gui::widgets::palette::{BODY_SIZE, Palette, SMALL_SIZE};

/// Returns the font for titles, axis labels, legends and dot labels.
pub(super) fn caption_font() -> FontId {
    FontId::proportional(SMALL_SIZE)
}

/// Horizontal position for a text that ends at the right end of its row; `row_text` and
/// `painted_text` count negative positions from the right.
pub(super) const AT_RIGHT: f32 = -0.01;

/// Shows `message` in the middle of `rect`, which is allocated from `ui`.
pub(super) fn message_ui(ui: &mut Ui, rect: Rect, message: &str, palette: &Palette) {
    let response = ui.allocate_rect(rect, Sense::hover());
    response.widget_info(|| WidgetInfo::labeled(egui::Role::Label, true, message));
    let galley = ui.painter().layout(
        message.to_owned(),
        FontId::proportional(BODY_SIZE),
        palette.dim_text,
        (rect.width() - 32.0).max(40.0),
    );
    let place = Align2::CENTER_CENTER.align_size_within_rect(galley.size(), rect);
    ui.painter().galley(place.min, galley, palette.dim_text);
}
