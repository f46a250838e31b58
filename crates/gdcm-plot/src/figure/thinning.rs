//! Thins lines: omits points that would not be visible.

use std::borrow::Cow;

/// Smallest visible distances, in plot units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pixel {
    /// Width of a pixel column, in x units.
    pub width: f64,
    /// Maximum distance between a thinned line and the curve, in y units.
    pub tolerance: f64,
}

impl Pixel {
    /// Splits points, ascending in x, into pixel columns.
    fn columns(self, points: &[[f64; 2]]) -> impl Iterator<Item = &[[f64; 2]]> {
        let mut rest = points;
        std::iter::from_fn(move || {
            let first = rest.first()?;
            let end = ((first[0] / self.width).floor() + 1.0) * self.width;
            let inside = rest.iter().position(|point| point[0] >= end);
            // `max(1)`: due to rounding, the end may coincide with the first point.
            let count = inside.unwrap_or(rest.len()).max(1);
            let (column, others) = rest.split_at(count);
            rest = others;
            Some(column)
        })
    }
}

/// Returns the points in `run` that must be drawn: the extremes in each pixel column, reduced to
/// the points that keep the connecting lines within tolerance of every omitted extreme. Both ends
/// remain; a `run` that does not ascend in x is returned unchanged.
pub fn thinned(run: &[[f64; 2]], pixel: Pixel) -> Vec<[f64; 2]> {
    if !run.is_sorted_by(|point, next| point[0] < next[0]) {
        return run.to_vec();
    }
    along_wedges(&column_extremes(run, pixel), pixel.tolerance)
}

/// Returns the first, the minimum, the maximum and the last point in each pixel column, in their
/// original order.
fn column_extremes(run: &[[f64; 2]], pixel: Pixel) -> Cow<'_, [[f64; 2]]> {
    // This is the usual case: no column contains three points, so that none can be omitted.
    if run
        .windows(3)
        .all(|points| points[2][0] - points[0][0] >= pixel.width)
    {
        return Cow::Borrowed(run);
    }
    let mut kept = Vec::with_capacity(run.len());
    for points in pixel.columns(run) {
        if points.len() <= 2 {
            kept.extend_from_slice(points);
        } else {
            kept.extend(extremes_of_column(points).map(|index| points[index]));
        }
    }
    Cow::Owned(kept)
}

/// Returns the indices of the first, the minimum, the maximum and the last point in a column,
/// ascending and without duplicates.
fn extremes_of_column(points: &[[f64; 2]]) -> impl Iterator<Item = usize> {
    let mut least = 0;
    let mut greatest = 0;
    for (index, point) in points.iter().enumerate() {
        if point[1].total_cmp(&points[least][1]).is_lt() {
            least = index;
        }
        // `is_ge`: among equal values, the last counts as the maximum, the first as the minimum.
        if point[1].total_cmp(&points[greatest][1]).is_ge() {
            greatest = index;
        }
    }
    let mut indices = vec![0, least, greatest, points.len() - 1];
    indices.sort_unstable();
    indices.dedup();
    indices.into_iter()
}

/// The slopes with which a line from the last kept point passes all later points within tolerance.
struct Wedge {
    apex: [f64; 2],
    least_slope: f64,
    greatest_slope: f64,
}

impl Wedge {
    /// Creates a wedge at a kept point; it initially contains every slope.
    fn new(apex: [f64; 2]) -> Self {
        Self {
            apex,
            least_slope: f64::NEG_INFINITY,
            greatest_slope: f64::INFINITY,
        }
    }

    /// Returns whether the line from the apex to this point passes all intermediate points within
    /// tolerance.
    fn contains(&self, [x, y]: [f64; 2]) -> bool {
        (self.least_slope..=self.greatest_slope).contains(&self.slope_to(x, y))
    }

    /// Excludes the slopes that miss a point by more than the tolerance.
    fn narrow(&mut self, [x, y]: [f64; 2], tolerance: f64) {
        self.least_slope = self.least_slope.max(self.slope_to(x, y - tolerance));
        self.greatest_slope = self.greatest_slope.min(self.slope_to(x, y + tolerance));
    }

    fn slope_to(&self, x: f64, y: f64) -> f64 {
        (y - self.apex[1]) / (x - self.apex[0])
    }
}

/// Returns the points in `run` that are needed to keep the straight lines between them within
/// `tolerance` of every omitted point.
///
/// ```text
/// keep the first point: it is the apex from which a wedge opens
/// for each further point:
///     if it lies outside the wedge: keep the point before it, the next apex
///     narrow the wedge to slopes that pass the point within tolerance
/// keep the last point
/// ```
/// Takes linear time in the number of points. Williams, "An efficient algorithm for the piecewise
/// linear approximation of planar curves", Computer Graphics and Image Processing 8, 1978.
fn along_wedges(run: &[[f64; 2]], tolerance: f64) -> Vec<[f64; 2]> {
    let Some((first, rest)) = run.split_first() else {
        return Vec::new();
    };
    let mut kept = vec![*first];
    let mut wedge = Wedge::new(*first);
    let mut previous = *first;
    for point in rest {
        if !wedge.contains(*point) {
            kept.push(previous);
            wedge = Wedge::new(previous);
        }
        wedge.narrow(*point, tolerance);
        previous = *point;
    }
    if !rest.is_empty() {
        kept.push(previous);
    }
    kept
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// Returns the ordinate at `x` of the polyline through `kept`.
    fn drawn_at(kept: &[[f64; 2]], x: f64) -> f64 {
        let after = kept
            .partition_point(|point| point[0] < x)
            .clamp(1, kept.len() - 1);
        let [x0, y0] = kept[after - 1];
        let [x1, y1] = kept[after];
        y0 + (y1 - y0) * (x - x0) / (x1 - x0)
    }

    /// Returns the maximum vertical distance of `points` from the polyline through `kept`.
    fn error(points: &[[f64; 2]], kept: &[[f64; 2]]) -> f64 {
        points
            .iter()
            .map(|point| (point[1] - drawn_at(kept, point[0])).abs())
            .fold(0.0, f64::max)
    }

    /// Returns the minimum and the maximum ordinate of points.
    fn extremes(points: &[[f64; 2]]) -> (f64, f64) {
        let start = (f64::INFINITY, f64::NEG_INFINITY);
        points.iter().fold(start, |(least, greatest), point| {
            (least.min(point[1]), greatest.max(point[1]))
        })
    }

    /// Returns a pixel that is a hundred times narrower than the spacing of points at 0, 1, 2, …
    fn fine(tolerance: f64) -> Pixel {
        Pixel {
            width: 0.01,
            tolerance,
        }
    }

    /// Generates points with spacings from far below to far above the width of a pixel, and with
    /// upward, downward and level steps.
    fn run() -> impl Strategy<Value = Vec<[f64; 2]>> {
        let step = (
            0.01..1.0f64,
            prop_oneof![Just(0.0), -0.05..0.05f64, -5.0..5.0f64],
        );
        (0.02..3.0f64, prop::collection::vec(step, 2..300)).prop_map(|(spacing, steps)| {
            let mut at = [-7.3, 1.0];
            let walk = |(dx, dy): (f64, f64)| {
                at = [at[0] + spacing * dx, at[1] + dy];
                at
            };
            steps.into_iter().map(walk).collect()
        })
    }

    const COLUMN: Pixel = Pixel {
        width: 1.0,
        tolerance: 0.1,
    };

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
                let first = column[0];
                let last = column[column.len() - 1];
                let inside = |point: &&[f64; 2]| (first[0]..=last[0]).contains(&point[0]);
                let mut drawn: Vec<[f64; 2]> = kept.iter().filter(inside).copied().collect();
                drawn.extend([first, last].map(|end| [end[0], drawn_at(&kept, end[0])]));
                let wanted = extremes(column);
                let drawn = extremes(&drawn);
                let slack = COLUMN.tolerance + 1e-9;
                prop_assert!((wanted.0 - drawn.0).abs() < slack && (wanted.1 - drawn.1).abs() < slack);
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
        let line: Vec<[f64; 2]> = (0..500)
            .map(|k| [f64::from(k), 2.0 * f64::from(k)])
            .collect();
        assert_eq!(thinned(&line, fine(1e-9)), [line[0], line[499]]);
    }

    #[test]
    fn a_curve_keeps_within_the_tolerance_with_a_tenth_of_its_points() {
        let curve: Vec<[f64; 2]> = (0..2000)
            .map(|k| 0.01 * f64::from(k))
            .map(|x| [x, 40.0 * (x.sin() + 0.2 * (5.0 * x).cos())])
            .collect();
        let kept = thinned(
            &curve,
            Pixel {
                width: 1e-3,
                tolerance: 0.2,
            },
        );
        assert!(
            error(&curve, &kept) <= 0.2 + 1e-12,
            "{}",
            error(&curve, &kept)
        );
        assert!(kept.len() < 200, "{}", kept.len());
    }

    #[test]
    fn a_peak_of_one_point_stays() {
        let curve = [[0.0, 0.0], [1.0, 0.0], [2.0, 9.0], [3.0, 0.0], [4.0, 0.0]];
        assert_eq!(thinned(&curve, fine(0.1)), curve);
        let hidden = [
            [0.0, 0.0],
            [0.1, 0.0],
            [0.2, 9.0],
            [0.3, 0.0],
            [0.4, 0.0],
            [0.5, 0.0],
        ];
        assert!(
            thinned(
                &hidden,
                Pixel {
                    width: 1.0,
                    tolerance: 0.1
                }
            )
            .contains(&[0.2, 9.0]),
            "in a single column"
        );
    }

    #[test]
    fn of_a_thousand_points_in_a_column_four_are_drawn() {
        let noise: Vec<[f64; 2]> = (0..1000)
            .map(|k| [1e-4 * f64::from(k), f64::from((k * 7919 + 500) % 1000)])
            .collect();
        assert_eq!(thinned(&noise, COLUMN).len(), 4);
    }

    #[test]
    fn short_runs_stay_as_they_are() {
        assert!(thinned(&[], fine(1.0)).is_empty());
        assert_eq!(thinned(&[[1.0, 2.0]], fine(1.0)), [[1.0, 2.0]]);
    }

    #[test]
    fn a_line_that_goes_back_stays_as_it_is() {
        let back = [[0.0, 0.0], [1.0, 1.0], [2.0, 2.0], [1.0, 3.0], [1.0, 4.0]];
        assert_eq!(thinned(&back, COLUMN), back);
    }
}
