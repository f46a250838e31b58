//! Fewer points for the same line.

use super::drawing::{Drawing, Shape};

impl Drawing {
    /// The same drawing with fewer points: none of those left out is farther than `tolerance_pt` from its line.
    pub fn simplified(self, tolerance_pt: f64) -> Self {
        Self { shapes: coarser(self.shapes, tolerance_pt), ..self }
    }
}

fn coarser(shapes: Vec<Shape>, tolerance: f64) -> Vec<Shape> {
    let one = |shape: Shape| match shape {
        Shape::Path { points, closed: false, fill, stroke } => {
            Shape::Path { points: simplified(&points, tolerance), closed: false, fill, stroke }
        }
        Shape::Clipped { area, shapes } => Shape::Clipped { area, shapes: coarser(shapes, tolerance) },
        other => other,
    };
    shapes.into_iter().map(one).collect()
}

/// `points` without those that lie within `tolerance` of the line that the others make; the ends stay.
///
/// ```text
/// keep the first and the last point
/// while a stretch between two kept points has one farther than tolerance from their chord:
///     keep the farthest, and look at both halves
/// ```
/// Douglas and Peucker, "Algorithms for the reduction of the number of points required to represent a digitized line", 1973.
pub(super) fn simplified(points: &[[f64; 2]], tolerance: f64) -> Vec<[f64; 2]> {
    if points.len() < 3 {
        return points.to_vec();
    }
    let mut is_kept = vec![false; points.len()];
    let mut stretches = vec![(0, points.len() - 1)];
    while let Some((from, to)) = stretches.pop() {
        is_kept[from] = true;
        is_kept[to] = true;
        let distances = (from + 1..to).map(|at| (at, distance(points[at], points[from], points[to])));
        if let Some((farthest, distance)) = distances.max_by(|(_, a), (_, b)| a.total_cmp(b))
            && distance > tolerance
        {
            stretches.extend([(from, farthest), (farthest, to)]);
        }
    }
    points.iter().zip(is_kept).filter(|(_, kept)| *kept).map(|(point, _)| *point).collect()
}

/// Distance of a point from the piece of line between two others.
fn distance([x, y]: [f64; 2], [ax, ay]: [f64; 2], [bx, by]: [f64; 2]) -> f64 {
    let (dx, dy) = (bx - ax, by - ay);
    let squared = dx * dx + dy * dy;
    let along = if squared > 0.0 { (((x - ax) * dx + (y - ay) * dy) / squared).clamp(0.0, 1.0) } else { 0.0 };
    (x - ax - along * dx).hypot(y - ay - along * dy)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn points_on_a_straight_line_are_left_out() {
        let points: Vec<[f64; 2]> = (0..=100).map(|k| [f64::from(k), 0.5 * f64::from(k)]).collect();
        assert_eq!(simplified(&points, 1e-9), [[0.0, 0.0], [100.0, 50.0]]);
    }

    proptest! {
        #[test]
        fn no_point_is_farther_from_the_line_than_the_tolerance(
            values in prop::collection::vec(-10.0..10.0f64, 2..80), tolerance in 0.01..5.0f64,
        ) {
            let points: Vec<[f64; 2]> = values.iter().enumerate().map(|(k, y)| [k as f64, *y]).collect();
            let line = simplified(&points, tolerance);
            prop_assert_eq!((line.first(), line.last()), (points.first(), points.last()));
            for point in points {
                let nearest = line.windows(2).map(|ends| distance(point, ends[0], ends[1])).fold(f64::INFINITY, f64::min);
                prop_assert!(nearest <= tolerance);
            }
        }
    }
}
