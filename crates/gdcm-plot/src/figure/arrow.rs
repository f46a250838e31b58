//! Arrows between two points, as lines in panel units.

use super::axis::Range;

/// Length of an arrow head, relative to the spans of all arrows in the plot.
const HEAD_LENGTH: f64 = 0.035;
/// Half-width of an arrow head, relative to the spans.
const HEAD_HALF_WIDTH: f64 = 0.012;
/// Minimum axis span, relative to the largest coordinate on it.
const LEAST_SPAN: f64 = 1e-3;

/// Returns the points' extents along x and y, relative to which arrow heads are sized; positive
/// even for a single point.
pub(super) fn spans(points: &[[f64; 2]]) -> [f64; 2] {
    [0, 1].map(|axis| {
        let range = Range::spanning(points.iter().map(|point| point[axis]));
        let range = range.unwrap_or(Range::new(0.0, 0.0));
        range
            .width()
            .max(LEAST_SPAN * range.max.abs())
            .max(f64::MIN_POSITIVE)
    })
}

/// Returns a line between two points, with an arrow head in the middle, where no dot hides it:
/// `from`, tip, wing, tip, other wing, tip, `to`. A line shorter than an arrow head has no head.
pub(super) fn arrow(from: [f64; 2], to: [f64; 2], spans: [f64; 2]) -> Vec<[f64; 2]> {
    let along = [0, 1].map(|axis| (to[axis] - from[axis]) / spans[axis]);
    let length = along[0].hypot(along[1]);
    if length < HEAD_LENGTH {
        return vec![from, to];
    }
    let line = ScaledLine {
        from,
        direction: along.map(|part| part / length),
        spans,
    };
    let tip_at = 0.5 * (length + HEAD_LENGTH);
    let tip = line.point(tip_at, 0.0);
    let left = line.point(tip_at - HEAD_LENGTH, HEAD_HALF_WIDTH);
    let right = line.point(tip_at - HEAD_LENGTH, -HEAD_HALF_WIDTH);
    vec![from, tip, left, tip, right, tip, to]
}

/// A line in coordinates relative to the spans.
struct ScaledLine {
    from: [f64; 2],
    /// Unit vector.
    direction: [f64; 2],
    spans: [f64; 2],
}

impl ScaledLine {
    /// Returns the point at a distance `ahead` along the line and a distance `beside` to its left.
    fn point(&self, ahead: f64, beside: f64) -> [f64; 2] {
        let [x, y] = self.direction;
        let offset = [ahead * x - beside * y, ahead * y + beside * x];
        [0, 1].map(|axis| self.from[axis] + self.spans[axis] * offset[axis])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_arrow_ends_at_its_target_and_its_head_points_there() {
        // The spans run from the origin to [2, 100]: head sizes are fractions of them.
        let points = arrow([1.0, 10.0], [3.0, 10.0], [2.0, 100.0]);
        assert_eq!(
            (points[0], points[6], points.len()),
            ([1.0, 10.0], [3.0, 10.0], 7)
        );
        let tip = points[1];
        let wings = [points[2], points[4]];
        for wing in wings {
            assert!(
                wing[0] < tip[0] && ((tip[0] - wing[0]) / 2.0 - HEAD_LENGTH).abs() < 1e-12,
                "{wing:?}"
            );
            assert!(
                ((wing[1] - tip[1]).abs() / 100.0 - HEAD_HALF_WIDTH).abs() < 1e-12,
                "{wing:?}"
            );
        }
        assert_eq!(
            arrow([1.0, 10.0], [1.001, 10.0], [2.0, 100.0]).len(),
            2,
            "too short for a head"
        );
        assert_eq!(spans(&[[1.0, 5.0], [3.0, 5.0]]), [2.0, 5e-3]);
    }
}
