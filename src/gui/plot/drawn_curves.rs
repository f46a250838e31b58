//! Frequency responses as drawn in the Bode plot: the visible points of a pane's curves, and their
//! lines.

use std::ops::RangeInclusive;
use std::sync::Arc;

use egui::{Color32, Pos2, Shape, Ui};
use egui_plot::{PlotBounds, PlotGeometry, PlotItem, PlotItemBase, PlotPoint, PlotTransform};
pub use gdcm_plot::figure::condition_source::CurveId;
pub use gdcm_plot::figure::responses::{BodeCurve, LogFrequencies, Pane};
use gdcm_plot::figure::thinning::{Pixel, thinned};

use super::curve_style::CurveStyle;
use crate::gui::widgets::palette::Palette;

/// Distance outside the view within which points are drawn, as a share of the view: lines have a
/// width.
const LINE_MARGIN: f64 = 0.02;
/// The same for dashes and dots: a small pan must not change where they begin.
const PATTERN_MARGIN: f64 = 1.0;

/// Visible points of a pane's curves, cached as long as they would not change: with a thousand
/// models, finding them takes longer than drawing them.
#[derive(Clone, Debug, Default)]
pub(super) struct DrawnCurves {
    /// Visible range, and its finest detail.
    drawn: Option<(PlotBounds, Pixel)>,
    /// Drawn curves, in the order of the curves.
    curves: Vec<DrawnCurve>,
    /// Number of curves made so far.
    made: u64,
}

/// Points of a curve, and the numbers they were made from.
#[derive(Clone, Debug)]
struct DrawnCurve {
    numbers: CurveNumbers,
    margin: f64,
    runs: Vec<Vec<PlotPoint>>,
    /// Serial number among all curves made.
    serial: u64,
}

impl DrawnCurves {
    /// Recomputes the points of what changed since the last frame.
    pub(super) fn update(
        &mut self,
        curves: &[BodeCurve],
        pane: Pane,
        (bounds, pixel): (PlotBounds, Pixel),
        palette: &Palette,
    ) {
        let is_same = |(drawn, curve): (&DrawnCurve, &BodeCurve)| {
            drawn.is_of(curve, pane, margin(curve, palette))
        };
        if self.drawn == Some((bounds, pixel))
            && self.curves.len() == curves.len()
            && self.curves.iter().zip(curves).all(is_same)
        {
            return;
        }
        let mut kept = std::mem::take(&mut self.curves)
            .into_iter()
            .map(Some)
            .collect::<Vec<_>>();
        if self.drawn != Some((bounds, pixel)) {
            kept.clear();
        }
        self.drawn = Some((bounds, pixel));
        let mut axis = LogFrequencies::default();
        let made = &mut self.made;
        let drawn = |(index, curve): (usize, &BodeCurve)| {
            let margin = margin(curve, palette);
            let is_same = |kept: &Option<DrawnCurve>| {
                kept.as_ref()
                    .is_some_and(|kept| kept.is_of(curve, pane, margin))
            };
            // Usually the curves are those of the last frame, in the same order.
            let here = kept.get(index).is_some_and(is_same).then_some(index);
            let place = here.or_else(|| kept.iter().position(is_same));
            place
                .and_then(|place| kept[place].take())
                .unwrap_or_else(|| {
                    let runs = runs_in_view(curve.points_on(&mut axis, pane), &bounds, margin);
                    let points = |run: &Vec<[f64; 2]>| {
                        thinned(run, pixel)
                            .into_iter()
                            .map(PlotPoint::from)
                            .collect()
                    };
                    *made += 1;
                    let numbers = CurveNumbers::of(curve, pane);
                    let runs = runs.iter().map(points).collect();
                    DrawnCurve {
                        numbers,
                        margin,
                        runs,
                        serial: *made,
                    }
                })
        };
        self.curves = curves.iter().enumerate().map(drawn).collect();
    }

    /// Returns the lines of the curve at an index.
    pub(super) fn runs(&self, index: usize) -> &[Vec<PlotPoint>] {
        self.curves.get(index).map_or(&[], |curve| &curve.runs)
    }

    /// Returns the serial number of the lines of the curve at an index, which changes whenever they
    /// are recomputed.
    pub(super) fn serial(&self, index: usize) -> u64 {
        self.curves.get(index).map_or(0, |curve| curve.serial)
    }
}

impl DrawnCurve {
    fn is_of(&self, curve: &BodeCurve, pane: Pane, margin: f64) -> bool {
        self.margin == margin && self.numbers.are_of(curve, pane)
    }
}

fn margin(curve: &BodeCurve, palette: &Palette) -> f64 {
    if palette.role_style(curve.role, curve.rejected).is_broken() {
        PATTERN_MARGIN
    } else {
        LINE_MARGIN
    }
}

/// Returns the pixel of a plot with this `transform`, where lines may be `tolerance_pt` points away
/// from their curves.
pub(super) fn pixel_of(
    transform: &PlotTransform,
    pixels_per_point: f32,
    tolerance_pt: f64,
) -> Pixel {
    let [x_per_point, y_per_point] = transform.dvalue_dpos().map(f64::abs);
    Pixel {
        width: x_per_point / f64::from(pixels_per_point),
        tolerance: tolerance_pt * y_per_point,
    }
}

/// Splits points into runs that are finite throughout and come within `margin` of `view`, a share
/// of its size.
///
/// A non-finite point makes debug builds of egui_plot panic, and a curve far outside the view costs
/// time in proportion to its points and, if dashed, to its length on the screen.
pub fn runs_in_view(
    points: impl Iterator<Item = [f64; 2]>,
    view: &PlotBounds,
    margin: f64,
) -> Vec<Vec<[f64; 2]>> {
    let near = enlarged(view, margin);
    let mut runs: Vec<Vec<[f64; 2]>> = Vec::new();
    let mut run: Vec<[f64; 2]> = Vec::new();
    let mut previous: Option<[f64; 2]> = None;
    for point in points {
        let point = point.iter().all(|c| c.is_finite()).then_some(point);
        match (previous, point) {
            (Some(from), Some(to)) if touches(from, to, &near) => {
                if run.is_empty() {
                    run.push(from);
                }
                run.push(to);
            }
            _ => runs.extend(take_filled(&mut run)),
        }
        previous = point;
    }
    runs.extend(take_filled(&mut run));
    runs
}

fn take_filled(run: &mut Vec<[f64; 2]>) -> Option<Vec<[f64; 2]>> {
    (!run.is_empty()).then(|| std::mem::take(run))
}

fn enlarged(view: &PlotBounds, margin: f64) -> PlotBounds {
    let min = view.min();
    let max = view.max();
    let width = margin * view.width();
    let height = margin * view.height();
    PlotBounds::from_min_max(
        [min[0] - width, min[1] - height],
        [max[0] + width, max[1] + height],
    )
}

/// Returns whether the rectangle spanned by two points meets `bounds`.
fn touches(a: [f64; 2], b: [f64; 2], bounds: &PlotBounds) -> bool {
    (0..2).all(|axis| {
        a[axis].max(b[axis]) >= bounds.min()[axis] && a[axis].min(b[axis]) <= bounds.max()[axis]
    })
}

/// Numbers of a curve shown by a pane.
#[derive(Clone, Debug)]
pub(super) struct CurveNumbers {
    omega: Arc<[f64]>,
    values: Arc<[f64]>,
}

impl CurveNumbers {
    /// Returns the numbers of a curve.
    pub(super) fn of(curve: &BodeCurve, pane: Pane) -> Self {
        Self {
            omega: Arc::clone(&curve.omega),
            values: Arc::clone(curve.shared_values(pane)),
        }
    }

    /// Returns whether `curve` still has these numbers: usually they are in the same place in
    /// memory.
    pub(super) fn are_of(&self, curve: &BodeCurve, pane: Pane) -> bool {
        let same = |one: &Arc<[f64]>, other: &Arc<[f64]>| {
            // Gaps are NaN, so they are compared by their bits.
            let bits = |values: &Arc<[f64]>| {
                values
                    .iter()
                    .map(|value| value.to_bits())
                    .eq(other.iter().map(|value| value.to_bits()))
            };
            Arc::ptr_eq(one, other) || bits(one)
        };
        same(&self.values, curve.shared_values(pane)) && same(&self.omega, &curve.omega)
    }
}

/// Returns the drawing of a curve with its runs of points, in screen coordinates.
pub(super) fn curve_lines(
    runs: &[Vec<PlotPoint>],
    look: CurveStyle,
    transform: &PlotTransform,
    shapes: &mut Vec<Shape>,
) {
    for run in runs {
        let path: Vec<Pos2> = run
            .iter()
            .map(|point| transform.position_from_point(point))
            .collect();
        look.add_shapes(path, shapes);
    }
}

/// Adds shapes to those of a plot.
type Drawing<'a> = Box<dyn Fn(&PlotTransform, &mut Vec<Shape>) + 'a>;

/// Plot item of shapes, which egui_plot does not pick.
pub(super) struct DrawnItem<'a> {
    base: PlotItemBase,
    draw: Drawing<'a>,
}

impl<'a> DrawnItem<'a> {
    /// Creates an item from the function that adds its shapes to the plot.
    pub(super) fn new(draw: impl Fn(&PlotTransform, &mut Vec<Shape>) + 'a) -> Self {
        Self {
            base: PlotItemBase::new(String::new()),
            draw: Box::new(draw),
        }
    }
}

impl PlotItem for DrawnItem<'_> {
    fn shapes(&self, _: &Ui, transform: &PlotTransform, shapes: &mut Vec<Shape>) {
        (self.draw)(transform, shapes);
    }

    fn initialize(&mut self, _: RangeInclusive<f64>) {}

    fn color(&self) -> Color32 {
        Color32::TRANSPARENT
    }

    fn allow_hover(&self) -> bool {
        false
    }

    fn geometry(&self) -> PlotGeometry<'_> {
        PlotGeometry::None
    }

    fn bounds(&self) -> PlotBounds {
        PlotBounds::NOTHING
    }

    fn base(&self) -> &PlotItemBase {
        &self.base
    }

    fn base_mut(&mut self) -> &mut PlotItemBase {
        &mut self.base
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::gui::plot::tests::sample_curve as curve;

    const PIXEL: Pixel = Pixel {
        width: 0.01,
        tolerance: 0.01,
    };

    fn view(height: f64) -> (PlotBounds, Pixel) {
        (PlotBounds::from_min_max([0.0, 0.0], [1.0, height]), PIXEL)
    }

    fn update(drawn: &mut DrawnCurves, curves: &[BodeCurve], height: f64) {
        drawn.update(curves, Pane::Magnitude, view(height), &Palette::dark());
    }

    /// Addresses of the points in memory, which change once they are recomputed.
    fn places(drawn: &DrawnCurves) -> Vec<*const PlotPoint> {
        drawn
            .curves
            .iter()
            .map(|curve| curve.runs[0].as_ptr())
            .collect()
    }

    #[test]
    fn points_are_kept_until_their_curve_or_the_view_changes() {
        let mut drawn = DrawnCurves::default();
        let mut curves = vec![curve(0, &[1.0, 9.0, 5.0]), curve(1, &[1.0; 3])];
        update(&mut drawn, &curves, 10.0);
        let first = places(&drawn);
        curves[0].highlighted = true;
        update(&mut drawn, &curves, 10.0);
        assert_eq!(places(&drawn), first, "a look is no matter of points");
        curves.swap(0, 1);
        update(&mut drawn, &curves, 10.0);
        assert_eq!(places(&drawn), [first[1], first[0]], "nor is the order");
        curves[0] = curve(1, &[2.0; 3]);
        update(&mut drawn, &curves, 10.0);
        assert_eq!(places(&drawn)[1], first[0]);
        assert_eq!(drawn.runs(0)[0][0].y, 2.0);
        assert_eq!(
            [drawn.serial(0), drawn.serial(1)],
            [3, 1],
            "what is made anew has a number of its own"
        );
        // Of the curve that rises to 9 and returns to 5, the segments up to 6 and further are
        // invisible.
        update(&mut drawn, &curves[1..], 0.5);
        assert!(drawn.runs(0).is_empty());
    }

    #[test]
    fn what_is_not_there_has_no_points() {
        assert!(DrawnCurves::default().runs(3).is_empty());
    }

    const UNIT: [[f64; 2]; 2] = [[0.0, 0.0], [1.0, 1.0]];

    fn unit_view() -> PlotBounds {
        PlotBounds::from_min_max(UNIT[0], UNIT[1])
    }

    proptest! {
        #[test]
        fn no_line_leads_across_a_gap(
            values in prop::collection::vec(prop_oneof![4 => 0.0..1.0f64, 1 => Just(f64::NAN), 1 => Just(f64::INFINITY)], 0..60)
        ) {
            let points: Vec<[f64; 2]> = values.iter().enumerate().map(|(k, value)| [k as f64 / 60.0, *value]).collect();
            let stretches = points.split(|point| !point[1].is_finite());
            // A single point between two gaps makes no line.
            let expected: Vec<Vec<[f64; 2]>> = stretches.filter(|run| run.len() > 1).map(<[_]>::to_vec).collect();
            prop_assert_eq!(runs_in_view(points.into_iter(), &unit_view(), 0.0), expected);
        }
    }

    #[test]
    fn a_gap_splits_a_curve_into_two() {
        let points = [0.1, 0.2, f64::NAN, 0.3, 0.4, f64::INFINITY].map(|x| [x, 0.5]);
        let runs = runs_in_view(points.into_iter(), &unit_view(), 0.0);
        assert_eq!(
            runs,
            [vec![[0.1, 0.5], [0.2, 0.5]], vec![[0.3, 0.5], [0.4, 0.5]]]
        );
    }

    #[test]
    fn what_is_far_outside_the_view_is_not_drawn() {
        let points = (-100..100).map(|k| [f64::from(k), 0.5]);
        for (margin, count) in [(0.0, 4), (1.0, 6)] {
            let runs = runs_in_view(points.clone(), &unit_view(), margin);
            assert_eq!(runs.len(), 1);
            assert_eq!(
                runs[0].len(),
                count,
                "those within, and one on either side to lead there"
            );
        }
    }
}
