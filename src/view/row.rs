//! A selectable row that fills the width: one line of a list.

use egui::{Align2, Color32, FontId, Rect, Response, Role, Sense, Ui, WidgetInfo, pos2, vec2};

use super::palette::Palette;

/// Height of a row \[pt\].
pub const ROW_HEIGHT: f32 = 20.0;

/// Allocates a row that can be clicked, paints its background, and names it for screen readers and tests.
pub fn row_ui(ui: &mut Ui, palette: &Palette, selected: bool, pointed: bool, name: &str) -> (Rect, Response) {
    let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), ROW_HEIGHT), Sense::click());
    response.widget_info(|| WidgetInfo::selected(Role::Button, ui.is_enabled(), selected, name));
    let fill = if selected {
        palette.selected
    } else if response.hovered() || pointed || response.has_focus() {
        palette.raised
    } else {
        Color32::TRANSPARENT
    };
    ui.painter().rect_filled(rect, 3.0, fill);
    (rect, response)
}

/// Paints text at `x` points from the row's left edge (from its right edge where negative), centred in height.
pub fn row_text(ui: &Ui, row: Rect, x: f32, text: &str, size: f32, color: Color32) -> Rect {
    let (left, align) =
        if x < 0.0 { (row.right() + x, Align2::RIGHT_CENTER) } else { (row.left() + x, Align2::LEFT_CENTER) };
    ui.painter().text(pos2(left, row.center().y), align, text, FontId::proportional(size), color)
}
