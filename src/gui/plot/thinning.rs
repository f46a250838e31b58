//! Thinning: only visible points are drawn, and no details finer than a pixel.
//!
//! A *run* is a piece of a curve without gaps and in view. [`thinned`] omits the details of a run
//! that are finer than a pixel; the functions here cut the runs out of the curves, and compute the
//! size of a pixel in axis coordinates. [`thinned_between`] serves the charts, whose lines have no
//! gaps.

use egui_plot::{PlotBounds, PlotTransform};

use gdcm_plot::figure::thinning::{Pixel, thinned};

/// Returns the pixel size for this `transform`; lines may deviate from their curves by
/// `tolerance_pt` points.
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

/// Returns the points between `ends` and the next point on either side, without details finer than
/// a pixel. All `points` must be finite and ascend in x.
pub(super) fn thinned_between(points: &[[f64; 2]], ends: [f64; 2], pixel: Pixel) -> Vec<[f64; 2]> {
    let from = points
        .partition_point(|point| point[0] < ends[0])
        .saturating_sub(1);
    let after = points.partition_point(|point| point[0] <= ends[1]);
    let to = (after + 1).min(points.len());
    thinned(points.get(from..to).unwrap_or_default(), pixel)
}

/// Splits points into sequences that are finite throughout and come within `margin` of `view`;
/// `margin` is a share of its size. A segment is kept if its bounding rectangle comes so close; a
/// finite point between two gaps makes no segment and is dropped.
///
/// A non-finite point makes debug builds of egui_plot panic, and a curve far outside the view costs
/// time in proportion to its points and, if dashed, to its length on the screen.
pub(super) fn runs_in_view(
    points: impl Iterator<Item = [f64; 2]>,
    view: &PlotBounds,
    margin: f64,
) -> Vec<Vec<[f64; 2]>> {
    let near = enlarged(view, margin);
    let mut runs: Vec<Vec<[f64; 2]>> = Vec::new();
    let mut run: Vec<[f64; 2]> = Vec::new();
    let mut previous: Option<[f64; 2]> = None;
    for point in points {
        let point = if is_finite(&point) { Some(point) } else { None };
        match (previous, point) {
            (Some(from), Some(to)) if touches(from, to, &near) => {
                if run.is_empty() {
                    run.push(from);
                }
                run.push(to);
            }
            _ => {
                if !run.is_empty() {
                    runs.push(std::mem::take(&mut run));
                }
            }
        }
        previous = point;
    }
    if !run.is_empty() {
        runs.push(run);
    }
    runs
}

pub(super) fn is_finite(point: &[f64; 2]) -> bool {
    point[0].is_finite() && point[1].is_finite()
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

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

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
    fn points_far_outside_the_view_are_not_drawn() {
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

    #[test]
    fn a_thinned_line_keeps_visible_peaks_and_distinguishable_samples() {
        let mut points: Vec<[f64; 2]> = (0..10_000)
            .map(|k| [f64::from(k), f64::from(k % 2)])
            .collect();
        points[4321][1] = 7.0;
        points[8765][1] = -3.0;
        let shown = |ends, width| {
            thinned_between(
                &points,
                ends,
                Pixel {
                    width,
                    tolerance: 1e-3,
                },
            )
        };
        let all = shown([f64::NEG_INFINITY, f64::INFINITY], 20.0);
        assert!(all.len() <= 4 * 10_000 / 20, "{}", all.len());
        assert!(all.contains(&[4321.0, 7.0]) && all.contains(&[8765.0, -3.0]));
        assert_eq!((all.first(), all.last()), (points.first(), points.last()));
        assert!(all.is_sorted_by(|a, b| a[0] < b[0]));
        assert_eq!(
            shown([4310.5, 4330.5], 0.1),
            &points[4310..=4331],
            "with the lines that leave the view"
        );
        assert!(
            shown([20_000.0, 20_001.0], 0.1).len() < 2,
            "nothing to draw"
        );
    }
}
