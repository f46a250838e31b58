//! One pane of some curves in a small rectangle.

use egui::{Painter, Rect};
use egui_plot::{PlotBounds, PlotTransform};
use gdcm_files::figure::{Range, decimals};

use super::curve::{BodeCurve, Pane, curve_lines};
use super::drawn_curves::{DrawnCurves, Pixel};
use crate::view::palette::Palette;

/// How far from the curve a drawn line may be \[pt\].
const TOLERANCE: f64 = 0.25;

/// A sparkline as it was drawn last.
#[derive(Clone, Debug, Default)]
pub(super) struct Sketch {
    drawn: DrawnCurves,
    transform: Option<PlotTransform>,
}

impl Sketch {
    /// Draws all values of `curves` into `rect`, with a little space above and below, what matters most on top.
    pub(super) fn paint(
        &mut self,
        painter: &Painter,
        curves: &[BodeCurve],
        (pane, rect): (Pane, Rect),
        log_omega: Range,
        palette: &Palette,
    ) {
        let values = Range::of(curves.iter().flat_map(|curve| curve.values(pane).iter().copied()));
        self.transform = values.map(|values| values.with_margin(0.06, 1.0)).map(|values| {
            let bounds = PlotBounds::from_min_max([log_omega.min, values.min], [log_omega.max, values.max]);
            PlotTransform::new(rect, bounds, false)
        });
        let Some(transform) = &self.transform else { return };
        let pixel = Pixel::of(transform, painter.pixels_per_point(), TOLERANCE);
        self.drawn.update(curves, pane, (*transform.bounds(), pixel), palette);
        let mut order: Vec<(usize, &BodeCurve)> = curves.iter().enumerate().collect();
        order.sort_by_key(|(_, curve)| (curve.highlighted, curve.role.layer(curve.rejected)));
        let mut shapes = Vec::new();
        for (index, curve) in order {
            let look = palette.role_style(curve.role, curve.rejected).in_miniature();
            let look = if curve.highlighted { look.emphasized() } else { look };
            curve_lines(self.drawn.runs(index), look, transform, &mut shapes);
        }
        painter.extend(shapes);
    }

    /// The part of the vertical axis that was in view, in words; empty where there was nothing to draw.
    pub(super) fn range_text(&self, pane: Pane) -> String {
        let unit = if pane == Pane::Magnitude { " dB" } else { "°" };
        self.transform.map_or_else(String::new, |transform| {
            let [min, max] = [transform.bounds().min(), transform.bounds().max()].map(|end| decimals(end[1], 0));
            format!("{min} … {max}{unit}")
        })
    }

    /// Where the curves were drawn last: x counts decades of frequency; nothing where there was nothing to draw.
    pub(super) fn transform(&self) -> Option<PlotTransform> {
        self.transform
    }
}

#[cfg(test)]
mod tests {
    use egui::{Context, LayerId, pos2};

    use super::*;
    use crate::view::plot::curve::sample_curve as curve;

    fn paint(sketch: &mut Sketch, curves: &[BodeCurve]) {
        let rect = Rect::from_min_max(pos2(0.0, 0.0), pos2(100.0, 60.0));
        let painter = Painter::new(Context::default(), LayerId::background(), rect);
        let log_omega = Range::new(0.0, 0.7);
        sketch.paint(&painter, curves, (Pane::Magnitude, rect), log_omega, &Palette::dark());
    }

    #[test]
    fn a_curve_that_reaches_farther_widens_what_is_in_view() {
        let (mut sketch, mut curves) =
            (Sketch::default(), vec![curve(0, &[0.0, 9.0, 5.0]), curve(1, &[1.0, 2.0, 3.0])]);
        paint(&mut sketch, &curves);
        let before = sketch.transform();
        curves[1] = curve(1, &[1.0, 20.0, 3.0]);
        paint(&mut sketch, &curves);
        assert_ne!(sketch.transform().map(|of| *of.bounds()), before.map(|of| *of.bounds()));
        assert_eq!(sketch.range_text(Pane::Magnitude), "\u{2212}1 … 21 dB");
    }

    #[test]
    fn what_has_no_values_is_told_by_no_range() {
        let mut sketch = Sketch::default();
        paint(&mut sketch, &[curve(0, &[f64::NAN; 3])]);
        assert_eq!(sketch.range_text(Pane::Magnitude), "");
    }
}
