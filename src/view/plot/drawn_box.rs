//! Boxes drawn over a plot: with the secondary button to zoom into, with Shift and the primary one to select what they touch.
//!
//! egui_plot has this too, but begins the box where the pointer is by the time it is known to drag, not where it was pressed.

use egui::{PointerButton, Rect, Response, Stroke, StrokeKind, Ui};

use crate::view::palette::Palette;

/// A box less wide or high than this is a slip of the hand \[pt\].
const LEAST_SIDE: f32 = 5.0;

/// Draws the box while it is being drawn over `frame` with `button`, and gives it when it is done.
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
    let (origin, now) = ui.input(|input| (input.pointer.press_origin(), input.pointer.latest_pos()));
    // By the time the button is let go, there is no origin any more: the last frame's is kept.
    let memory = plot.id.with("box origin");
    let origin = origin.or_else(|| ui.data(|data| data.get_temp(memory)))?;
    ui.data_mut(|data| data.insert_temp(memory, origin));
    let area = Rect::from_two_pos(origin, now?).intersect(frame);
    let is_wanted = area.width() >= LEAST_SIDE && area.height() >= LEAST_SIDE;
    if is_done {
        return is_wanted.then_some(area);
    }
    let (fill, stroke) = (palette.accent.gamma_multiply(0.12), Stroke::new(1.0, palette.accent));
    ui.painter().with_clip_rect(frame).rect(area, 0.0, fill, stroke, StrokeKind::Inside);
    None
}
