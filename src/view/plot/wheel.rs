//! What the wheel and two fingers ask of a plot.

use egui::{Context, Pos2, Response, Vec2};

/// Scrolled points that make a factor of e: about four clicks of a wheel.
const POINTS_PER_E: f32 = 200.0;

/// How much closer to look, in x and y.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Turn {
    /// By the wheel, or by two fingers.
    pub(super) both: Vec2,
    /// By the sideways wheel, which Shift makes of any: only x means it.
    pub(super) sideways: f32,
}

impl Turn {
    /// The same where there is one axis only: whichever way the wheel turns.
    pub(super) fn along_one_axis(self) -> f32 {
        let pinched = (self.both.x * self.both.y).sqrt();
        pinched * self.sideways
    }
}

/// What the wheel and two fingers ask of the widget under the pointer, and where; nothing where they rest.
pub(super) fn turned(ctx: &Context, response: &Response) -> Option<(Turn, Pos2)> {
    let pointer = response.hover_pos()?;
    let (scrolled, pinched) = ctx.input(|input| (input.smooth_scroll_delta(), input.zoom_delta_2d()));
    if scrolled == Vec2::ZERO && pinched == Vec2::splat(1.0) {
        return None;
    }
    let both = (scrolled.y / POINTS_PER_E).exp() * pinched;
    Some((Turn { both, sideways: (scrolled.x / POINTS_PER_E).exp() }, pointer))
}
