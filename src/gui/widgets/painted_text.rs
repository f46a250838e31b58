//! Text and arrows painted into a row. The text gets no accessible name: the row that contains it
//! has one.

use egui::{Align2, Color32, FontId, Pos2, Rect, Stroke, Ui, pos2, vec2};

use super::elision::elided;
use super::palette::Palette;

/// Position for [`painted_text`] at which text ends at its row's right edge: negative, so that it
/// counts from that edge, and too small to be seen.
pub const AT_RIGHT_END: f32 = -0.01;

/// Paints text at `x` points from the row's left edge (from its right edge if negative), vertically
/// centred; returns its rectangle.
pub fn painted_text(ui: &Ui, row: Rect, x: f32, text: &str, font: FontId, color: Color32) -> Rect {
    let (left, align) = if x < 0.0 {
        (row.right() + x, Align2::RIGHT_CENTER)
    } else {
        (row.left() + x, Align2::LEFT_CENTER)
    };
    ui.painter()
        .text(pos2(left, row.center().y), align, text, font, color)
}

/// Like [`painted_text`], in the proportional font.
pub fn row_text(ui: &Ui, row: Rect, x: f32, text: &str, size: f32, color: Color32) -> Rect {
    painted_text(ui, row, x, text, FontId::proportional(size), color)
}

/// Horizontal room for text, measured from the row's left edge \[pt\].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Room {
    pub left: f32,
    pub right: f32,
}

/// Paints text into its room, with the middle elided if it is too long; paints nothing if not even
/// a letter fits.
pub fn row_text_within(ui: &Ui, row: Rect, room: Room, text: &str, size: f32, color: Color32) {
    let shown = elided(ui, text, room.right - room.left, size);
    if !shown.is_empty() {
        row_text(ui, row, room.left, &shown, size, color);
    }
}

/// Paints a small arrow: to the right if its section is folded, down if it is open.
pub fn chevron(ui: &Ui, center: Pos2, is_open: bool, palette: &Palette) {
    if is_open {
        return chevron_down(ui, center, palette.dim_text);
    }
    let corners = [vec2(-2.0, -4.0), vec2(2.0, 0.0), vec2(-2.0, 4.0)];
    let points = corners.map(|corner| center + corner).to_vec();
    ui.painter()
        .line(points, Stroke::new(1.3, palette.dim_text));
}

/// Paints a small arrow downwards.
pub fn chevron_down(ui: &Ui, center: Pos2, color: Color32) {
    let corners = [vec2(4.0, -2.0), vec2(0.0, 2.0), vec2(-4.0, -2.0)];
    let points = corners.map(|corner| center + corner).to_vec();
    ui.painter().line(points, Stroke::new(1.3, color));
}
