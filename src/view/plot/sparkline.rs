//! Curves without axes, in the little room of a table's cell.

use egui::{Pos2, Rect, Shape};
use egui_plot::{LineStyle, PlotBounds, PlotPoint, PlotTransform};

use super::curve::{BodeCurve, LogFrequencies, Pane, runs_in_view};
use super::number::decimals;
use super::pixel::Pixel;
use super::range::Range;
use super::thinning::thinned;
use crate::view::palette::Palette;

/// How far from the curve a drawn line may be \[pt\].
const TOLERANCE: f64 = 0.25;
/// Width of lines here as a part of that in a full plot.
const WIDTH_PART: f32 = 0.72;

/// The curves of one pane in a small rectangle.
pub(super) struct Sparkline<'a> {
    curves: &'a [BodeCurve],
    pane: Pane,
    transform: PlotTransform,
}

impl<'a> Sparkline<'a> {
    /// All values of `curves` in `rect`, with a little space above and below; nothing where there is no value.
    pub(super) fn new(curves: &'a [BodeCurve], pane: Pane, log_omega: Range, rect: Rect) -> Option<Self> {
        let values = Range::of(curves.iter().flat_map(|curve| curve.values(pane).iter().copied()))?;
        let values = values.with_margin(0.06, 1.0);
        let bounds = PlotBounds::from_min_max([log_omega.min, values.min], [log_omega.max, values.max]);
        Some(Self { curves, pane, transform: PlotTransform::new(rect, bounds, false) })
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

    /// The curves as shapes; what matters most comes last, on top.
    pub(super) fn shapes(&self, palette: &Palette, pixels_per_point: f32) -> Vec<Shape> {
        let mut curves: Vec<&BodeCurve> = self.curves.iter().collect();
        curves.sort_by_key(|curve| (curve.highlighted, curve.role.layer(curve.rejected)));
        let pixel = Pixel::of(&self.transform, pixels_per_point, TOLERANCE);
        let mut axis = LogFrequencies::default();
        let shapes = |curve: &BodeCurve| {
            let mut look = curve.role.look(curve.rejected, palette);
            look.width *= WIDTH_PART;
            look.style = match look.style {
                LineStyle::Solid => LineStyle::Solid,
                LineStyle::Dashed { .. } => LineStyle::Dashed { length: 4.0 },
                LineStyle::Dotted { .. } => LineStyle::Dotted { spacing: 3.5 },
            };
            if curve.highlighted {
                look = look.emphasized();
            }
            self.paths(curve, &mut axis, pixel).iter().flat_map(|path| look.shapes(path)).collect::<Vec<Shape>>()
        };
        curves.into_iter().flat_map(shapes).collect()
    }

    /// A curve on the screen, thinned to what can be told apart.
    fn paths(&self, curve: &BodeCurve, axis: &mut LogFrequencies, pixel: Pixel) -> Vec<Vec<Pos2>> {
        let position = |[x, y]: [f64; 2]| self.transform.position_from_point(&PlotPoint::new(x, y));
        // All of it is in view.
        let runs = runs_in_view(curve.points_on(axis, self.pane), self.transform.bounds(), 0.0);
        runs.iter().map(|run| thinned(run, pixel).into_iter().map(position).collect()).collect()
    }
}
