//! Zoom gestures, by wheel and pinching, used by several plots.

use egui::{Context, Pos2, Response, Vec2};

/// Zoom factor for a wheel notch.
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
    /// Returns the zoom requested while the pointer is on this widget; `None` if the pointer is
    /// elsewhere, or without wheel and pinching.
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

    /// Returns the zoom factor for the horizontal axis.
    pub(super) fn across(self) -> f64 {
        f64::from(self.both.x * self.sideways)
    }

    /// Returns the zoom factor for the vertical axis.
    pub(super) fn upward(self) -> f64 {
        f64::from(self.both.y)
    }

    /// Returns a single zoom factor that combines all gestures: the geometric mean of both axes,
    /// times the sideways factor.
    pub(super) fn along_one_axis(self) -> f64 {
        let pinched = (self.both.x * self.both.y).sqrt();
        f64::from(pinched * self.sideways)
    }
}

/// Returns the zoom factor for a scroll distance; a touchpad scrolls by fractions of a notch.
fn factor_of(points: f32) -> f32 {
    NOTCH.powf(points / NOTCH_PT)
}
