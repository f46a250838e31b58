//! A frequency response as the Bode plot draws it: the points of a pane's curves that have to be drawn, and their lines.

use std::borrow::Cow;
use std::ops::RangeInclusive;
use std::sync::Arc;

use egui::{Color32, Pos2, Shape, Ui};
use egui_plot::{PlotBounds, PlotGeometry, PlotItem, PlotItemBase, PlotPoint, PlotTransform};
pub use gdcm_files::figure::{BodeCurve, CurveId, LogFrequencies, Pane};

use super::curve_style::CurveStyle;
use crate::view::palette::Palette;

/// How far outside the view a point may be to be drawn, as a part of the view: a line has a width.
const LINE_MARGIN: f64 = 0.02;
/// The same for dashes and dots: panning a little is not to change where they begin.
const PATTERN_MARGIN: f64 = 1.0;

/// The points of a pane's curves that have to be drawn, kept as long as they would come out the same: with a thousand
/// models, finding them costs more than drawing them.
#[derive(Clone, Debug, Default)]
pub(super) struct DrawnCurves {
    /// The part in view, and its least detail.
    drawn: Option<(PlotBounds, Pixel)>,
    /// In the order of the curves.
    curves: Vec<DrawnCurve>,
    /// How many curves were made so far.
    made: u64,
}

/// The points of one curve, and from what they were made.
#[derive(Clone, Debug)]
struct DrawnCurve {
    numbers: CurveNumbers,
    margin: f64,
    runs: Vec<Vec<PlotPoint>>,
    /// Which of all that were made it is.
    serial: u64,
}

impl DrawnCurves {
    /// Makes the points anew of what changed since the last frame.
    pub(super) fn update(
        &mut self,
        curves: &[BodeCurve],
        pane: Pane,
        (bounds, pixel): (PlotBounds, Pixel),
        palette: &Palette,
    ) {
        let is_same = |(drawn, curve): (&DrawnCurve, &BodeCurve)| drawn.is_of(curve, pane, margin(curve, palette));
        if self.drawn == Some((bounds, pixel))
            && self.curves.len() == curves.len()
            && self.curves.iter().zip(curves).all(is_same)
        {
            return;
        }
        let mut kept = std::mem::take(&mut self.curves).into_iter().map(Some).collect::<Vec<_>>();
        if self.drawn != Some((bounds, pixel)) {
            kept.clear();
        }
        self.drawn = Some((bounds, pixel));
        let mut axis = LogFrequencies::default();
        let made = &mut self.made;
        let drawn = |(index, curve): (usize, &BodeCurve)| {
            let margin = margin(curve, palette);
            let is_same = |kept: &Option<DrawnCurve>| kept.as_ref().is_some_and(|kept| kept.is_of(curve, pane, margin));
            // Mostly the curves are those of the last frame, in the same order.
            let here = kept.get(index).is_some_and(is_same).then_some(index);
            let place = here.or_else(|| kept.iter().position(is_same));
            place.and_then(|place| kept[place].take()).unwrap_or_else(|| {
                let runs = runs_in_view(curve.points_on(&mut axis, pane), &bounds, margin);
                let points = |run: &Vec<[f64; 2]>| thinned(run, pixel).into_iter().map(PlotPoint::from).collect();
                *made += 1;
                let (numbers, runs) = (CurveNumbers::of(curve, pane), runs.iter().map(points).collect());
                DrawnCurve { numbers, margin, runs, serial: *made }
            })
        };
        self.curves = curves.iter().enumerate().map(drawn).collect();
    }

    /// The lines of the curve at an index.
    pub(super) fn runs(&self, index: usize) -> &[Vec<PlotPoint>] {
        self.curves.get(index).map_or(&[], |curve| &curve.runs)
    }

    /// The number of the lines of the curve at an index: another one as soon as they are made anew.
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
    if palette.role_style(curve.role, curve.rejected).is_broken() { PATTERN_MARGIN } else { LINE_MARGIN }
}

/// The points of `run`, ascending in x, that have to be drawn: whatever reaches farthest in its column of pixels, unless the curve
/// only passes through, and as many others as keep the lines between them within the tolerance. Both ends stay.
pub(super) fn thinned(run: &[[f64; 2]], pixel: Pixel) -> Vec<[f64; 2]> {
    along_wedges(&column_extremes(run, pixel), pixel.tolerance)
}

/// The first, the least, the greatest and the last point in each column of pixels, in their order.
fn column_extremes(run: &[[f64; 2]], pixel: Pixel) -> Cow<'_, [[f64; 2]]> {
    // Most often no column holds three points, and there is nothing to leave out.
    if run.windows(3).all(|points| points[2][0] - points[0][0] >= pixel.width) {
        return Cow::Borrowed(run);
    }
    let mut kept = Vec::with_capacity(run.len());
    for points in pixel.columns(run) {
        if points.len() <= 2 {
            kept.extend_from_slice(points);
            continue;
        }
        let by_value = |a: &usize, b: &usize| points[*a][1].total_cmp(&points[*b][1]);
        let indices = || 0..points.len();
        let extremes = [indices().min_by(by_value), indices().max_by(by_value)];
        let mut indices = [0, extremes[0].unwrap_or(0), extremes[1].unwrap_or(0), points.len() - 1];
        indices.sort_unstable();
        let distinct = indices.chunk_by(|a, b| a == b).map(|same| points[same[0]]);
        kept.extend(distinct);
    }
    Cow::Owned(kept)
}

/// The points where `run` turns up, down or level, and those of the others that are needed for straight lines between them to
/// stay within `tolerance` of every value left out.
///
/// From each point kept, the slopes that pass all values since then within the tolerance form a wedge that narrows; the
/// last point inside it is kept next. Linear in the number of points.
fn along_wedges(run: &[[f64; 2]], tolerance: f64) -> Vec<[f64; 2]> {
    let Some((first, rest)) = run.split_first() else {
        return Vec::new();
    };
    let mut kept = vec![*first];
    let (mut anchor, mut previous) = (*first, *first);
    // Whether the last step went up, down or level.
    let mut way = None;
    let mut slopes = (f64::NEG_INFINITY, f64::INFINITY);
    for point in rest {
        let next_way = point[1].partial_cmp(&previous[1]);
        let turns = way.is_some_and(|way| way != next_way);
        let slope = (point[1] - anchor[1]) / (point[0] - anchor[0]);
        if turns || !(slopes.0..=slopes.1).contains(&slope) {
            kept.push(previous);
            anchor = previous;
            slopes = (f64::NEG_INFINITY, f64::INFINITY);
        }
        way = Some(next_way);
        let slope_to = |y: f64| (y - anchor[1]) / (point[0] - anchor[0]);
        slopes = (slopes.0.max(slope_to(point[1] - tolerance)), slopes.1.min(slope_to(point[1] + tolerance)));
        previous = *point;
    }
    if !rest.is_empty() {
        kept.push(previous);
    }
    kept
}

/// The least that a screen can show, in the units of a plot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Pixel {
    /// Width of a column of pixels, in units of x.
    pub(super) width: f64,
    /// How far from a curve a line may be drawn, in units of y.
    pub(super) tolerance: f64,
}

impl Pixel {
    /// The pixel of a plot drawn as `transform` says, where lines may be `tolerance_pt` points away from their curves.
    pub(super) fn of(transform: &PlotTransform, pixels_per_point: f32, tolerance_pt: f64) -> Self {
        let [x_per_point, y_per_point] = transform.dvalue_dpos().map(f64::abs);
        Self { width: x_per_point / f64::from(pixels_per_point), tolerance: tolerance_pt * y_per_point }
    }

    /// Splits points, ascending in x, into those of each column of pixels.
    pub(super) fn columns(self, points: &[[f64; 2]]) -> impl Iterator<Item = &[[f64; 2]]> {
        let mut rest = points;
        std::iter::from_fn(move || {
            let first = rest.first()?;
            let end = ((first[0] / self.width).floor() + 1.0) * self.width;
            // By rounding, the end may come out at the first point itself.
            let count = rest.iter().take_while(|point| point[0] < end).count().max(1);
            let (column, others) = rest.split_at(count);
            rest = others;
            Some(column)
        })
    }
}

/// Splits points into runs that are finite throughout and come within `margin` of `view`, a part of its size.
///
/// A point that is not finite makes debug builds of egui_plot panic, and a curve that runs far outside the view costs time in
/// proportion to its points, and where it is dashed, to its length on the screen.
pub fn runs_in_view(points: impl Iterator<Item = [f64; 2]>, view: &PlotBounds, margin: f64) -> Vec<Vec<[f64; 2]>> {
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
    let (min, max) = (view.min(), view.max());
    let (width, height) = (margin * view.width(), margin * view.height());
    PlotBounds::from_min_max([min[0] - width, min[1] - height], [max[0] + width, max[1] + height])
}

/// Whether the rectangle spanned by two points meets `bounds`.
fn touches(a: [f64; 2], b: [f64; 2], bounds: &PlotBounds) -> bool {
    (0..2).all(|axis| a[axis].max(b[axis]) >= bounds.min()[axis] && a[axis].min(b[axis]) <= bounds.max()[axis])
}

/// The numbers that a pane showed of a curve.
#[derive(Clone, Debug)]
pub(super) struct CurveNumbers {
    omega: Arc<[f64]>,
    values: Arc<[f64]>,
}

impl CurveNumbers {
    /// Those of a curve.
    pub(super) fn of(curve: &BodeCurve, pane: Pane) -> Self {
        Self { omega: Arc::clone(&curve.omega), values: Arc::clone(curve.shared_values(pane)) }
    }

    /// Whether `curve` still has them: mostly they are in the same place in memory.
    pub(super) fn are_of(&self, curve: &BodeCurve, pane: Pane) -> bool {
        let same = |one: &Arc<[f64]>, other: &Arc<[f64]>| {
            // Gaps are not numbers: they are the same by their bits.
            let bits = |values: &Arc<[f64]>| {
                values.iter().map(|value| value.to_bits()).eq(other.iter().map(|value| value.to_bits()))
            };
            Arc::ptr_eq(one, other) || bits(one)
        };
        same(&self.values, curve.shared_values(pane)) && same(&self.omega, &curve.omega)
    }
}

/// What a curve of one or more runs of points is drawn of, in screen coordinates.
pub(super) fn curve_lines(
    runs: &[Vec<PlotPoint>],
    look: CurveStyle,
    transform: &PlotTransform,
    shapes: &mut Vec<Shape>,
) {
    for run in runs {
        let path: Vec<Pos2> = run.iter().map(|point| transform.position_from_point(point)).collect();
        look.add_shapes(path, shapes);
    }
}

/// Adds the shapes of something to those of a plot.
type Drawing<'a> = Box<dyn Fn(&PlotTransform, &mut Vec<Shape>) + 'a>;

/// Shapes among the items of a plot, which nobody points at: that is not egui_plot's business.
pub(super) struct DrawnItem<'a> {
    base: PlotItemBase,
    draw: Drawing<'a>,
}

impl<'a> DrawnItem<'a> {
    /// What `draw` adds to the shapes of the plot.
    pub(super) fn new(draw: impl Fn(&PlotTransform, &mut Vec<Shape>) + 'a) -> Self {
        Self { base: PlotItemBase::new(String::new()), draw: Box::new(draw) }
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
    use crate::view::plot::tests::sample_curve as curve;

    const PIXEL: Pixel = Pixel { width: 0.01, tolerance: 0.01 };

    fn view(height: f64) -> (PlotBounds, Pixel) {
        (PlotBounds::from_min_max([0.0, 0.0], [1.0, height]), PIXEL)
    }

    fn update(drawn: &mut DrawnCurves, curves: &[BodeCurve], height: f64) {
        drawn.update(curves, Pane::Magnitude, view(height), &Palette::dark());
    }

    /// Where the points are in memory: elsewhere once they are made anew.
    fn places(drawn: &DrawnCurves) -> Vec<*const PlotPoint> {
        drawn.curves.iter().map(|curve| curve.runs[0].as_ptr()).collect()
    }

    #[test]
    fn points_are_kept_until_their_curve_or_the_view_changes() {
        let (mut drawn, mut curves) = (DrawnCurves::default(), vec![curve(0, &[1.0, 9.0, 5.0]), curve(1, &[1.0; 3])]);
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
        assert_eq!([drawn.serial(0), drawn.serial(1)], [3, 1], "what is made anew has a number of its own");
        // Of the curve that goes up to 9 and back to 5, the steps up to 6 and farther are out of sight.
        update(&mut drawn, &curves[1..], 0.5);
        assert!(drawn.runs(0).is_empty());
    }

    #[test]
    fn what_is_not_there_has_no_points() {
        assert!(DrawnCurves::default().runs(3).is_empty());
    }

    /// The value at `x` of the lines between `kept`.
    fn drawn_at(kept: &[[f64; 2]], x: f64) -> f64 {
        let after = kept.partition_point(|point| point[0] < x).clamp(1, kept.len() - 1);
        let ([x0, y0], [x1, y1]) = (kept[after - 1], kept[after]);
        y0 + (y1 - y0) * (x - x0) / (x1 - x0)
    }

    /// Largest distance in y of `points` from the lines between `kept`.
    fn error(points: &[[f64; 2]], kept: &[[f64; 2]]) -> f64 {
        points.iter().map(|point| (point[1] - drawn_at(kept, point[0])).abs()).fold(0.0, f64::max)
    }

    /// The least and the greatest value of some points.
    fn extremes(points: &[[f64; 2]]) -> (f64, f64) {
        let start = (f64::INFINITY, f64::NEG_INFINITY);
        points.iter().fold(start, |(least, greatest), point| (least.min(point[1]), greatest.max(point[1])))
    }

    /// Pixels a hundred times narrower than the distance of points at 0, 1, 2 …
    fn fine(tolerance: f64) -> Pixel {
        Pixel { width: 0.01, tolerance }
    }

    /// Runs of points from far closer to farther apart than a pixel, of steps up, down and level.
    fn run() -> impl Strategy<Value = Vec<[f64; 2]>> {
        let step = (0.01..1.0f64, prop_oneof![Just(0.0), -0.05..0.05f64, -5.0..5.0f64]);
        (0.02..3.0f64, prop::collection::vec(step, 2..300)).prop_map(|(spacing, steps)| {
            let mut at = [-7.3, 1.0];
            let walk = |(dx, dy): (f64, f64)| {
                at = [at[0] + spacing * dx, at[1] + dy];
                at
            };
            steps.into_iter().map(walk).collect()
        })
    }

    const COLUMN: Pixel = Pixel { width: 1.0, tolerance: 0.1 };

    proptest! {
        #[test]
        fn every_column_keeps_its_first_its_last_and_its_extremes(run in run()) {
            let kept = column_extremes(&run, COLUMN);
            prop_assert_eq!(COLUMN.columns(&run).count(), COLUMN.columns(&kept).count());
            for (all, kept) in COLUMN.columns(&run).zip(COLUMN.columns(&kept)) {
                prop_assert_eq!(extremes(all), extremes(kept));
                prop_assert_eq!((all.first(), all.last()), (kept.first(), kept.last()));
            }
        }

        #[test]
        fn what_is_drawn_in_a_column_reaches_as_far_as_its_points(run in run()) {
            let kept = thinned(&run, COLUMN);
            for column in COLUMN.columns(&run) {
                let (first, last) = (column[0], column[column.len() - 1]);
                let inside = |point: &&[f64; 2]| (first[0]..=last[0]).contains(&point[0]);
                let mut drawn: Vec<[f64; 2]> = kept.iter().filter(inside).copied().collect();
                let vertices = extremes(&drawn);
                drawn.extend([first, last].map(|end| [end[0], drawn_at(&kept, end[0])]));
                let (wanted, drawn) = (extremes(column), extremes(&drawn));
                let slack = COLUMN.tolerance + 1e-9;
                prop_assert!((wanted.0 - drawn.0).abs() < slack && (wanted.1 - drawn.1).abs() < slack);
                // Where the curve turns inside the column, to the last digit.
                let ends = extremes(&[first, last]);
                prop_assert!(wanted.0 == ends.0 || wanted.0 == vertices.0, "{wanted:?} {vertices:?}");
                prop_assert!(wanted.1 == ends.1 || wanted.1 == vertices.1, "{wanted:?} {vertices:?}");
            }
        }

        #[test]
        fn what_is_drawn_comes_in_the_order_of_the_points_from_end_to_end(run in run()) {
            let kept = thinned(&run, COLUMN);
            prop_assert!(kept.windows(2).all(|pair| pair[0][0] < pair[1][0]));
            prop_assert!(kept.iter().all(|point| run.contains(point)));
            prop_assert_eq!((run.first(), run.last()), (kept.first(), kept.last()));
        }
    }

    #[test]
    fn a_straight_line_needs_its_ends_only() {
        let line: Vec<[f64; 2]> = (0..500).map(|k| [f64::from(k), 2.0 * f64::from(k)]).collect();
        assert_eq!(thinned(&line, fine(1e-9)), [line[0], line[499]]);
    }

    #[test]
    fn a_curve_keeps_within_the_tolerance_with_a_tenth_of_its_points() {
        let curve: Vec<[f64; 2]> =
            (0..2000).map(|k| 0.01 * f64::from(k)).map(|x| [x, 40.0 * (x.sin() + 0.2 * (5.0 * x).cos())]).collect();
        let kept = thinned(&curve, Pixel { width: 1e-3, tolerance: 0.2 });
        assert!(error(&curve, &kept) <= 0.2 + 1e-12, "{}", error(&curve, &kept));
        assert!(kept.len() < 200, "{}", kept.len());
    }

    #[test]
    fn a_peak_of_one_point_stays() {
        let curve = [[0.0, 0.0], [1.0, 0.0], [2.0, 9.0], [3.0, 0.0], [4.0, 0.0]];
        assert_eq!(thinned(&curve, fine(0.1)), curve);
        let hidden = [[0.0, 0.0], [0.1, 0.0], [0.2, 9.0], [0.3, 0.0], [0.4, 0.0], [0.5, 0.0]];
        assert!(thinned(&hidden, Pixel { width: 1.0, tolerance: 0.1 }).contains(&[0.2, 9.0]), "in a single column");
    }

    #[test]
    fn of_a_thousand_points_in_a_column_four_are_drawn() {
        let noise: Vec<[f64; 2]> =
            (0..1000).map(|k| [1e-4 * f64::from(k), f64::from((k * 7919 + 500) % 1000)]).collect();
        assert_eq!(thinned(&noise, COLUMN).len(), 4);
    }

    #[test]
    fn short_runs_stay_as_they_are() {
        assert!(thinned(&[], fine(1.0)).is_empty());
        assert_eq!(thinned(&[[1.0, 2.0]], fine(1.0)), [[1.0, 2.0]]);
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
        assert_eq!(runs, [vec![[0.1, 0.5], [0.2, 0.5]], vec![[0.3, 0.5], [0.4, 0.5]]]);
    }

    #[test]
    fn what_is_far_outside_the_view_is_not_drawn() {
        let points = (-100..100).map(|k| [f64::from(k), 0.5]);
        for (margin, count) in [(0.0, 4), (1.0, 6)] {
            let runs = runs_in_view(points.clone(), &unit_view(), margin);
            assert_eq!(runs.len(), 1);
            assert_eq!(runs[0].len(), count, "those within, and one on either side to lead there");
        }
    }
}
