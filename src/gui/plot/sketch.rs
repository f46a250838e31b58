//! Small plot that shows curves without axes, in an overview cell.

use egui::{Painter, Rect};
use egui_plot::PlotTransform;

use gdcm_model::number_format::decimals;
use gdcm_plot::figure::Range;

use super::curve_layer::{CurveLooks, add_curve_lines, lies_at_the_bottom};
use super::drawn_curves::{BodeCurve, Pane, VisiblePart};
use super::drawn_pane::DrawnPane;
use super::viewed_range::{bounds_of, ranges_of};
use crate::gui::widgets::palette::Palette;

/// Maximum distance between a drawn line and its curve \[pt\].
const TOLERANCE: f64 = 0.25;
/// Margin above and below the curves, relative to their height.
const MARGIN: f64 = 0.06;
/// Minimum visible height \[dB\] or \[deg\].
const LEAST_HEIGHT: f64 = 1.0;

/// Curves in a small plot without axes.
pub(super) struct Sketch<'a> {
    pub(super) curves: &'a [BodeCurve],
    pub(super) pane: Pane,
    pub(super) rect: Rect,
    /// Visible range of `log10 omega`.
    pub(super) log_omega: Range,
    pub(super) palette: &'a Palette,
}

impl Sketch<'_> {
    /// Draws all values with a small margin above and below, the most important curves on top.
    pub(super) fn paint(&self, painter: &Painter, drawn: &mut DrawnPane) {
        drawn.transform = self.transform();
        let Some(transform) = drawn.transform else {
            return;
        };
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

    /// Returns the transform that shows all values; `None` without values.
    fn transform(&self) -> Option<PlotTransform> {
        let values = self.curves.iter().flat_map(|curve| curve.values(self.pane));
        let values = Range::spanning(values.copied())?.with_margin(MARGIN, LEAST_HEIGHT);
        let bounds = bounds_of([self.log_omega, values]);
        Some(PlotTransform::new(self.rect, bounds, false))
    }
}

/// Describes the range that the values had when last drawn; empty if there was nothing to draw.
pub(super) fn range_text(drawn: &DrawnPane, pane: Pane) -> String {
    let Some(transform) = drawn.transform else {
        return String::new();
    };
    let unit = match pane {
        Pane::Magnitude => " dB",
        Pane::Phase => "°",
    };
    let [_, values] = ranges_of(transform.bounds());
    let min = decimals(values.min, 0);
    let max = decimals(values.max, 0);
    format!("{min} … {max}{unit}")
}

#[cfg(test)]
mod tests {
    use egui::{Context, LayerId, pos2};

    use super::*;
    use crate::gui::plot::tests::sample_curve as curve;

    fn paint(drawn: &mut DrawnPane, curves: &[BodeCurve]) {
        let rect = Rect::from_min_max(pos2(0.0, 0.0), pos2(100.0, 60.0));
        let painter = Painter::new(Context::default(), LayerId::background(), rect);
        let sketch = Sketch {
            curves,
            pane: Pane::Magnitude,
            rect,
            log_omega: Range::new(0.0, 0.7),
            palette: &Palette::dark(),
        };
        sketch.paint(&painter, drawn);
    }

    #[test]
    fn a_curve_that_reaches_farther_widens_the_visible_range() {
        let mut drawn = DrawnPane::default();
        let mut curves = vec![curve(0, &[0.0, 9.0, 5.0]), curve(1, &[1.0, 2.0, 3.0])];
        paint(&mut drawn, &curves);
        let before = drawn.transform.map(|transform| *transform.bounds());
        curves[1] = curve(1, &[1.0, 20.0, 3.0]);
        paint(&mut drawn, &curves);
        let after = drawn.transform.map(|transform| *transform.bounds());
        assert_ne!(after, before);
        assert_eq!(range_text(&drawn, Pane::Magnitude), "\u{2212}1 … 21 dB");
    }

    #[test]
    fn curves_without_values_have_no_range() {
        let mut drawn = DrawnPane::default();
        paint(&mut drawn, &[curve(0, &[f64::NAN; 3])]);
        assert_eq!(range_text(&drawn, Pane::Magnitude), "");
    }
}
