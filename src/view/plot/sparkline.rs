//! Curves without axes, in the little room of a table's cell.

use crate::view::plot::RoleLook;
use egui::{Pos2, Rect, Shape};
use egui_plot::{PlotBounds, PlotPoint, PlotTransform};

use super::curve::{BodeCurve, LogFrequencies, Pane, runs_in_view};
use super::number::decimals;
use super::pixel::Pixel;
use super::range::Range;
use super::thinning::thinned;
use crate::view::palette::Palette;

/// How far from the curve a drawn line may be \[pt\].
const TOLERANCE: f64 = 0.25;

/// One pane of some curves in a small rectangle.
pub(super) struct Sparkline {
    pane: Pane,
    transform: PlotTransform,
}

impl Sparkline {
    /// All values of `curves` in `rect`, with a little space above and below; nothing where there is no value.
    pub(super) fn new(curves: &[BodeCurve], pane: Pane, log_omega: Range, rect: Rect) -> Option<Self> {
        let values = Range::of(curves.iter().flat_map(|curve| curve.values(pane).iter().copied()))?;
        let values = values.with_margin(0.06, 1.0);
        let bounds = PlotBounds::from_min_max([log_omega.min, values.min], [log_omega.max, values.max]);
        Some(Self { pane, transform: PlotTransform::new(rect, bounds, false) })
    }

    /// The part of the vertical axis in view, in words.
    pub(super) fn range_text(&self) -> String {
        let (min, max) = (self.transform.bounds().min()[1], self.transform.bounds().max()[1]);
        let unit = match self.pane {
            Pane::Magnitude => " dB",
            Pane::Phase => "°",
        };
        format!("{} … {}{unit}", decimals(min, 0), decimals(max, 0))
    }

    /// The part in view: `log10 omega` and values.
    pub(super) fn bounds(&self) -> PlotBounds {
        *self.transform.bounds()
    }

    /// One of the curves as shapes.
    pub(super) fn shapes(
        &self,
        curve: &BodeCurve,
        axis: &mut LogFrequencies,
        palette: &Palette,
        pixels_per_point: f32,
    ) -> Vec<Shape> {
        let mut look = curve.role.look(curve.rejected, palette).in_miniature();
        if curve.highlighted {
            look = look.emphasized();
        }
        let pixel = Pixel::of(&self.transform, pixels_per_point, TOLERANCE);
        let mut shapes = Vec::new();
        for path in self.paths(curve, axis, pixel) {
            look.add_shapes(path, &mut shapes);
        }
        shapes
    }

    /// A curve on the screen, thinned to what can be told apart.
    fn paths(&self, curve: &BodeCurve, axis: &mut LogFrequencies, pixel: Pixel) -> Vec<Vec<Pos2>> {
        let position = |[x, y]: [f64; 2]| self.transform.position_from_point(&PlotPoint::new(x, y));
        // All of it is in view.
        let runs = runs_in_view(curve.points_on(axis, self.pane), self.transform.bounds(), 0.0);
        runs.iter().map(|run| thinned(run, pixel).into_iter().map(position).collect()).collect()
    }
}
