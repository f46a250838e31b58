//! Small plot of curves without axes of its own: a cell of the overview.

use egui::{Painter, Rect};
use egui_plot::PlotTransform;

use gdcm_plot::figure::Range;

use super::curve_layer::{CurveLooks, add_curve_lines, lies_at_the_bottom};
use super::drawn_curves::{BodeCurve, Pane, VisiblePart};
use super::drawn_pane::DrawnPane;
use super::viewed_range::bounds_of;
use crate::gui::widgets::palette::Palette;

/// Maximum distance between a drawn line and its curve \[pt\].
const TOLERANCE: f64 = 0.25;

/// Curves in a small plot without axes.
pub(super) struct Sketch<'a> {
    pub(super) curves: &'a [BodeCurve],
    pub(super) pane: Pane,
    pub(super) rect: Rect,
    /// Visible range of `log10 omega`.
    pub(super) log_omega: Range,
    /// Visible values \[dB\] or \[deg\].
    pub(super) values: Range,
    pub(super) palette: &'a Palette,
}

impl Sketch<'_> {
    /// Draws the curves in the visible ranges, the most important on top.
    pub(super) fn paint(&self, painter: &Painter, drawn: &mut DrawnPane) {
        let bounds = bounds_of([self.log_omega, self.values]);
        let transform = PlotTransform::new(self.rect, bounds, false);
        drawn.transform = Some(transform);
        let visible = VisiblePart::new(&transform, painter.pixels_per_point(), TOLERANCE);
        drawn
            .curves
            .update(self.curves, self.pane, visible, self.palette);
        let looks = CurveLooks {
            is_miniature: true,
            ..CurveLooks::default()
        };
        let image =
            drawn.image_in_miniature(painter.ctx(), self.curves, &transform, looks, self.palette);
        let mut curves: Vec<(usize, &BodeCurve)> = self.curves.iter().enumerate().collect();
        let mut shapes = Vec::new();
        if let Some(image) = image {
            shapes.push(image.shape(1.0));
            curves.retain(|(_, curve)| !lies_at_the_bottom(curve) || looks.is_emphasized(curve));
        }
        looks.sort(&mut curves);
        for (index, curve) in curves {
            let style = looks.style(curve, self.palette);
            add_curve_lines(drawn.curves.runs(index), style, &transform, &mut shapes);
        }
        painter.extend(shapes);
    }
}
