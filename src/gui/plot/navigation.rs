//! Gestures used by several plots: zooming by wheel and pinching, selection boxes, digits.

use egui::{
    Context, Key, Modifiers, PointerButton, Pos2, Rect, Response, Stroke, StrokeKind, Ui, Vec2,
};

use crate::gui::widgets::palette::Palette;

/// Removes a pressed digit from 1 to 9 from the input and returns it.
pub(super) fn pressed_digit(ui: &Ui) -> Option<usize> {
    const DIGITS: [Key; 9] = [
        Key::Num1,
        Key::Num2,
        Key::Num3,
        Key::Num4,
        Key::Num5,
        Key::Num6,
        Key::Num7,
        Key::Num8,
        Key::Num9,
    ];
    for (index, key) in DIGITS.into_iter().enumerate() {
        if ui.input_mut(|input| input.consume_key(Modifiers::NONE, key)) {
            return Some(index + 1);
        }
    }
    None
}

/// Zoom factor of a wheel notch.
const NOTCH: f32 = 1.1;
/// Scroll distance of a wheel notch \[pt\].
const NOTCH_PT: f32 = 40.0;

/// Zoom requested by wheel or pinching.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct ZoomGesture {
    /// Screen position that zooming leaves unchanged.
    pub(super) pointer: Pos2,
    /// Zoom factors in x and y by the wheel or by pinching.
    both: Vec2,
    /// Zoom factor in x by the sideways wheel, or by the wheel with Shift.
    sideways: f32,
}

impl ZoomGesture {
    /// Returns the zoom requested on the widget under the pointer; `None` without input.
    pub(super) fn find(ctx: &Context, response: &Response) -> Option<Self> {
        let pointer = response.hover_pos()?;
        let scrolled = ctx.input(|input| input.smooth_scroll_delta());
        let pinched = ctx.input(|input| input.zoom_delta_2d());
        if scrolled == Vec2::ZERO && pinched == Vec2::splat(1.0) {
            return None;
        }
        Some(Self {
            pointer,
            both: factor_of(scrolled.y) * pinched,
            sideways: factor_of(scrolled.x),
        })
    }

    /// Returns the zoom factor of the horizontal axis.
    pub(super) fn across(self) -> f64 {
        f64::from(self.both.x * self.sideways)
    }

    /// Returns the zoom factor of the vertical axis.
    pub(super) fn upward(self) -> f64 {
        f64::from(self.both.y)
    }

    /// Returns a single zoom factor that combines all gestures.
    pub(super) fn along_one_axis(self) -> f64 {
        let pinched = (self.both.x * self.both.y).sqrt();
        f64::from(pinched * self.sideways)
    }
}

/// Returns the zoom factor for a scroll distance; a touchpad scrolls by fractions of a notch.
fn factor_of(points: f32) -> f32 {
    NOTCH.powf(points / NOTCH_PT)
}

/// Minimum side of a box; a smaller box is accidental \[pt\].
const LEAST_SIDE: f32 = 5.0;

/// Draws the selection box while it is dragged over `frame` with `button`; returns the finished
/// box.
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
    // When the button is released, the input no longer contains the drag origin, so the origin of
    // the previous frame is used.
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
