//! Selection box drawn by dragging over a plot.

use egui::{PointerButton, Rect, Response, Stroke, StrokeKind, Ui};

use crate::gui::widgets::palette::Palette;

/// Minimum side of a box; a smaller box is accidental \[pt\].
const LEAST_SIDE: f32 = 5.0;

/// Draws the selection box while it is dragged over `frame` with `button`; returns its part within
/// `frame` when the button is released, `None` if it is too small.
pub(super) fn drawn_box_ui(
    ui: &Ui,
    plot: &Response,
    frame: Rect,
    button: PointerButton,
    palette: &Palette,
) -> Option<Rect> {
    let is_done = plot.drag_stopped_by(button);
    if !(is_done || plot.dragged_by(button)) {
        return None;
    }
    let pointer = ui.input(|input| input.pointer.latest_pos());
    let pressed_at = ui.input(|input| input.pointer.press_origin());
    // When the button is released, the input no longer contains the drag origin, so the previous
    // frame's origin is used.
    let memory = plot.id.with("box origin");
    let origin = pressed_at.or_else(|| ui.data(|data| data.get_temp(memory)))?;
    ui.data_mut(|data| data.insert_temp(memory, origin));
    let area = Rect::from_two_pos(origin, pointer?).intersect(frame);
    if is_done {
        let is_meant = area.width() >= LEAST_SIDE && area.height() >= LEAST_SIDE;
        return if is_meant { Some(area) } else { None };
    }
    let fill = palette.accent.gamma_multiply(0.12);
    let stroke = Stroke::new(1.0, palette.accent);
    ui.painter()
        .with_clip_rect(frame)
        .rect(area, 0.0, fill, stroke, StrokeKind::Inside);
    None
}
