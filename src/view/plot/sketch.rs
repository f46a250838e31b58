//! A sparkline as it was drawn last.

use egui::{Painter, Pos2, Rect, Shape};
use egui_plot::{PlotBounds, PlotPoint, PlotTransform};
use gdcm_files::figure::{Range, decimals};

use super::curve::{BodeCurve, CurveNumbers, LogFrequencies, Pane, runs_in_view};
use super::curve_style::Role;
use super::drawn_curves::{Pixel, thinned};
use crate::view::palette::Palette;

/// A sparkline as shapes, kept as long as they would come out the same: making them costs far more than showing them again.
#[derive(Clone, Debug, Default)]
pub(super) struct Sketch {
    /// Where it was drawn, and the part of the curves that was in view, where there was anything to draw.
    drawn: Option<(Place, Option<PlotBounds>)>,
    /// In the order of the curves.
    traces: Vec<Trace>,
    /// Indices of the traces, what matters most last, on top.
    order: Vec<usize>,
    range_text: String,
}

impl Sketch {
    /// Draws `curves` into `rect`, anew only what changed since the last frame.
    pub(super) fn paint(
        &mut self,
        painter: &Painter,
        curves: &[BodeCurve],
        (pane, rect): (Pane, Rect),
        log_omega: Range,
        palette: &Palette,
    ) {
        let place = Place { rect, log_omega, palette: *palette, pixels_per_point: painter.pixels_per_point() };
        if !self.shows(curves, pane, &place) {
            self.draw(curves, pane, place);
        }
        for index in &self.order {
            painter.extend(self.traces[*index].shapes.iter().cloned());
        }
    }

    /// The part of the vertical axis that was in view, in words; empty where there was nothing to draw.
    pub(super) fn range_text(&self) -> &str {
        &self.range_text
    }

    /// Where the curves were drawn last: x counts decades of frequency; nothing where there was nothing to draw.
    pub(super) fn transform(&self) -> Option<PlotTransform> {
        let (place, bounds) = self.drawn?;
        Some(PlotTransform::new(place.rect, bounds?, false))
    }

    fn shows(&self, curves: &[BodeCurve], pane: Pane, place: &Place) -> bool {
        let same = |(trace, curve): (&Trace, &BodeCurve)| trace.is_of(curve, pane);
        self.drawn.is_some_and(|(drawn, _)| drawn == *place)
            && self.traces.len() == curves.len()
            && self.traces.iter().zip(curves).all(same)
    }

    fn draw(&mut self, curves: &[BodeCurve], pane: Pane, place: Place) {
        let sparkline = Sparkline::new(curves, pane, place.log_omega, place.rect);
        let drawn = Some((place, sparkline.as_ref().map(Sparkline::bounds)));
        let mut kept = std::mem::take(&mut self.traces);
        if self.drawn != drawn {
            kept.clear();
        }
        let mut axis = LogFrequencies::default();
        let trace = |curve: &BodeCurve| match kept.iter().position(|trace| trace.is_of(curve, pane)) {
            Some(index) => kept.swap_remove(index),
            None => {
                let shapes = sparkline
                    .as_ref()
                    .map(|sparkline| sparkline.shapes(curve, &mut axis, &place.palette, place.pixels_per_point));
                Trace::of(curve, pane, shapes.unwrap_or_default())
            }
        };
        self.traces = curves.iter().map(trace).collect();
        self.order = (0..curves.len()).collect();
        let rank = |index: &usize| (curves[*index].highlighted, curves[*index].role.layer(curves[*index].rejected));
        self.order.sort_by_key(rank);
        self.range_text = sparkline.as_ref().map(Sparkline::range_text).unwrap_or_default();
        self.drawn = drawn;
    }
}

/// Where and how a sketch was drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Place {
    rect: Rect,
    log_omega: Range,
    palette: Palette,
    pixels_per_point: f32,
}

/// A curve as it was drawn, and from what.
#[derive(Clone, Debug)]
struct Trace {
    numbers: CurveNumbers,
    role: Role,
    rejected: bool,
    highlighted: bool,
    shapes: Vec<Shape>,
}

impl Trace {
    fn of(curve: &BodeCurve, pane: Pane, shapes: Vec<Shape>) -> Self {
        Self {
            numbers: CurveNumbers::of(curve, pane),
            role: curve.role,
            rejected: curve.rejected,
            highlighted: curve.highlighted,
            shapes,
        }
    }

    /// Whether `curve` would come out the same, in the same place.
    fn is_of(&self, curve: &BodeCurve, pane: Pane) -> bool {
        self.numbers.are_of(curve, pane)
            && (self.role, self.rejected, self.highlighted) == (curve.role, curve.rejected, curve.highlighted)
    }
}

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
        let mut look = palette.role_style(curve.role, curve.rejected).in_miniature();
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

    /// Where the shapes of a trace are in memory: elsewhere once it is drawn anew.
    fn places(sketch: &Sketch) -> Vec<*const Shape> {
        sketch.traces.iter().map(|trace| trace.shapes.as_ptr()).collect()
    }

    #[test]
    fn only_what_changed_is_drawn_anew() {
        let (mut sketch, mut curves) =
            (Sketch::default(), vec![curve(0, &[0.0, 9.0, 5.0]), curve(1, &[1.0, 2.0, 3.0])]);
        paint(&mut sketch, &curves);
        let first = places(&sketch);
        paint(&mut sketch, &curves);
        assert_eq!(places(&sketch), first);
        // Inside the values in view.
        curves[1] = curve(1, &[3.0, 2.0, 1.0]);
        paint(&mut sketch, &curves);
        assert_eq!(places(&sketch)[0], first[0]);
        assert!(sketch.traces[1].is_of(&curves[1], Pane::Magnitude));
    }

    #[test]
    fn a_curve_that_reaches_farther_moves_the_others() {
        let (mut sketch, mut curves) =
            (Sketch::default(), vec![curve(0, &[0.0, 9.0, 5.0]), curve(1, &[1.0, 2.0, 3.0])]);
        paint(&mut sketch, &curves);
        let before = sketch.traces[0].shapes.clone();
        curves[1] = curve(1, &[1.0, 20.0, 3.0]);
        paint(&mut sketch, &curves);
        assert_ne!(sketch.traces[0].shapes, before);
        assert_eq!(sketch.range_text(), "\u{2212}1 … 21 dB");
    }

    #[test]
    fn what_is_pointed_at_is_on_top() {
        let (mut sketch, mut curves) = (Sketch::default(), vec![curve(0, &[0.0; 3]), curve(1, &[1.0; 3])]);
        curves[0].highlighted = true;
        paint(&mut sketch, &curves);
        assert_eq!(sketch.order, [1, 0]);
    }
}
