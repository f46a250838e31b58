//! Fewer points for the same curve: what the eye cannot tell apart need not be drawn.

/// The points of `run`, ascending in x, that are needed for straight lines between them to stay within `tolerance` of
/// every value left out. Both ends stay.
///
/// From each point kept, the slopes that pass all values since then within the tolerance form a wedge that narrows; the
/// last point inside it is kept next. Linear in the number of points.
pub(super) fn thinned(run: &[[f64; 2]], tolerance: f64) -> Vec<[f64; 2]> {
    let Some((first, rest)) = run.split_first() else {
        return Vec::new();
    };
    let mut kept = vec![*first];
    let (mut anchor, mut previous) = (*first, *first);
    let mut slopes = (f64::NEG_INFINITY, f64::INFINITY);
    for point in rest {
        let slope_to = |y: f64| (y - anchor[1]) / (point[0] - anchor[0]);
        if !(slopes.0..=slopes.1).contains(&slope_to(point[1])) {
            kept.push(previous);
            anchor = previous;
            slopes = (f64::NEG_INFINITY, f64::INFINITY);
        }
        let slope_to = |y: f64| (y - anchor[1]) / (point[0] - anchor[0]);
        slopes = (slopes.0.max(slope_to(point[1] - tolerance)), slopes.1.min(slope_to(point[1] + tolerance)));
        previous = *point;
    }
    if !rest.is_empty() {
        kept.push(previous);
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Largest distance in y of `points` from the lines between `kept`.
    fn error(points: &[[f64; 2]], kept: &[[f64; 2]]) -> f64 {
        let at = |x: f64| {
            let after = kept.partition_point(|point| point[0] < x).clamp(1, kept.len() - 1);
            let ([x0, y0], [x1, y1]) = (kept[after - 1], kept[after]);
            y0 + (y1 - y0) * (x - x0) / (x1 - x0)
        };
        points.iter().map(|point| (point[1] - at(point[0])).abs()).fold(0.0, f64::max)
    }

    #[test]
    fn a_straight_line_needs_its_ends_only() {
        let line: Vec<[f64; 2]> = (0..500).map(|k| [f64::from(k), 2.0 * f64::from(k)]).collect();
        assert_eq!(thinned(&line, 1e-9), [line[0], line[499]]);
    }

    #[test]
    fn a_curve_keeps_within_the_tolerance_with_a_tenth_of_its_points() {
        let curve: Vec<[f64; 2]> =
            (0..2000).map(|k| 0.01 * f64::from(k)).map(|x| [x, 40.0 * (x.sin() + 0.2 * (5.0 * x).cos())]).collect();
        let kept = thinned(&curve, 0.2);
        assert!(error(&curve, &kept) <= 0.2 + 1e-12, "{}", error(&curve, &kept));
        assert!(kept.len() < 200, "{}", kept.len());
    }

    #[test]
    fn a_peak_of_one_point_stays() {
        let curve = [[0.0, 0.0], [1.0, 0.0], [2.0, 9.0], [3.0, 0.0], [4.0, 0.0]];
        assert_eq!(thinned(&curve, 0.1), curve);
    }

    #[test]
    fn short_runs_stay_as_they_are() {
        assert!(thinned(&[], 1.0).is_empty());
        assert_eq!(thinned(&[[1.0, 2.0]], 1.0), [[1.0, 2.0]]);
    }
}
