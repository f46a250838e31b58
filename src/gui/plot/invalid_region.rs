//! Frequencies above the band at which the corrected model is invalid: hatching, a strip with a
//! text, and the magnitude added by the leads.
//!
//! Only a correction with leads, filters that advance the phase (M15: docs/lead.md), has such
//! frequencies; it is valid up to the band's upper end.

use egui::{Align2, FontId, Rect, Shape, Stroke, Ui, pos2, vec2};
use egui_plot::{PlotPoint, PlotTransform, PlotUi};

use super::bode_scene::InvalidRegion;
use super::layers::DrawnItem;
use crate::gui::widgets::elision::elided;
use crate::gui::widgets::palette::{Palette, SMALL_SIZE};

/// Distance between hatching lines \[pt\].
const HATCH_STEP: f32 = 7.0;
/// Minimum width with room for the text \[pt\].
const LEAST_STRIP: f32 = 40.0;
/// Distance from the frame's upper edge to the strip's lower edge \[pt\].
const STRIP_END: f32 = 17.0;
/// Total padding at both ends of the text \[pt\].
const TEXT_PADDING: f32 = 8.0;
/// Distance from the bracket to the curve ends at its right \[pt\].
const BRACKET_GAP: f32 = 9.0;
/// Half the length of the lines at the bracket's ends \[pt\].
const HALF_BRACKET: f32 = 3.0;
/// Distance from the curve ends, to the left, at which the curves must be visible \[pt\]. The ends
/// may lie on the frame's edge.
const VISIBLE_BESIDE: f32 = 6.0;

/// Hatches the frequencies above `omega` \[rad/s\].
pub(super) fn add_hatching(plot: &mut PlotUi<'_>, omega: f64, palette: &Palette) {
    let from = omega.log10();
    let stroke = Stroke::new(1.0, palette.warning.gamma_multiply(0.14));
    plot.add(DrawnItem::new(move |transform, shapes| {
        let left = transform.position_from_point(&PlotPoint::new(from, 0.0)).x;
        let frame = *transform.frame();
        let region = frame.with_min_x(left.max(frame.left()));
        hatch(region, stroke, shapes);
    }));
}

/// Adds lines that descend to the left at 45 degrees, clipped to the region.
///
/// On a line, `x + y = along`, with x and y measured from the region's upper left corner; the line
/// enters at the top or right edge, at `x = top`, and leaves at the bottom or left edge, at `x =
/// foot`.
fn hatch(region: Rect, stroke: Stroke, shapes: &mut Vec<Shape>) {
    let width = region.right() - region.left();
    let height = region.height();
    if width <= 0.0 {
        return;
    }
    for line in 1..=((width + height) / HATCH_STEP) as usize {
        let along = line as f32 * HATCH_STEP;
        let top = along.min(width);
        let foot = (along - height).max(0.0);
        let point = |x: f32| pos2(region.left() + x, region.top() + along - x);
        shapes.push(Shape::line_segment([point(top), point(foot)], stroke));
    }
}

/// Strip along the upper edge at the frequencies where the model is invalid.
pub(super) struct InvalidStrip<'a> {
    /// Upper end of the band \[rad/s\].
    pub(super) band_end: f64,
    pub(super) invalid: &'a InvalidRegion,
    pub(super) transform: &'a PlotTransform,
}

impl InvalidStrip<'_> {
    /// Paints the strip with its text, and a bracket for the magnitude added by the leads; nothing
    /// if the strip is too narrow.
    pub(super) fn paint(&self, ui: &Ui, palette: &Palette) {
        let Self {
            band_end,
            invalid,
            transform,
        } = *self;
        let frame = *transform.frame();
        let left = transform
            .position_from_point(&PlotPoint::new(band_end.log10(), 0.0))
            .x
            .max(frame.left());
        let strip = Rect::from_min_max(
            pos2(left, frame.top() + 1.0),
            pos2(frame.right() - 1.0, frame.top() + STRIP_END),
        );
        if strip.width() < LEAST_STRIP {
            return;
        }
        ui.painter().rect_filled(strip, 0.0, palette.warning_ground);
        let words = elided(ui, &invalid.words, strip.width() - TEXT_PADDING, SMALL_SIZE);
        let font = FontId::proportional(SMALL_SIZE);
        ui.painter().text(
            strip.center(),
            Align2::CENTER_CENTER,
            words,
            font,
            palette.warning,
        );
        paint_increase(ui, invalid, transform, palette);
    }
}

/// Draws a bracket between the magnitudes with and without leads where the curves end, if both are
/// visible.
fn paint_increase(ui: &Ui, invalid: &InvalidRegion, transform: &PlotTransform, palette: &Palette) {
    let Some(ends_db) = invalid.ends_db else {
        return;
    };
    let [upper, lower] =
        ends_db.map(|db| transform.position_from_point(&PlotPoint::new(invalid.up_to.log10(), db)));
    let beside = vec2(VISIBLE_BESIDE, 0.0);
    let frame = *transform.frame();
    if !frame.contains(upper - beside) || !frame.contains(lower - beside) {
        return;
    }
    let x = upper.x - BRACKET_GAP;
    let stroke = Stroke::new(1.5, palette.warning);
    ui.painter().vline(x, upper.y..=lower.y, stroke);
    for y in [upper.y, lower.y] {
        ui.painter()
            .hline(x - HALF_BRACKET..=x + HALF_BRACKET, y, stroke);
    }
}
