//! Maximum deviation of a table, interpolated linearly, from the curve that it samples.

/// Number of grid intervals in the search for the maximum deviation, which may lie between any two
/// points of a table; the grid is finer than the usual table.
const GRID: usize = 2000;
/// Number of golden-section steps; each multiplies the interval by 0.618, all together by 3e-13.
const STEPS: usize = 60;

/// A table's maximum deviation from its curve, with its position.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct TableDeviation {
    /// Deviation at `airspeed_kt`, in the unit returned by the `measure` passed to
    /// [`Self::greatest`].
    pub(super) value: f64,
    /// Airspeed \[kt\] at which the maximum occurs.
    pub(super) airspeed_kt: f64,
}

impl TableDeviation {
    /// Finds a table's maximum deviation from `curve` within `range_kt`; the table samples the
    /// curve at the airspeeds `points_kt`. `measure` compares an interpolated value with the exact
    /// value.
    ///
    /// A grid search is refined by a golden-section search in the two intervals beside the greatest
    /// grid value. The grid is necessary because the deviation, which is zero at every point of the
    /// table, may have a maximum between any two of them.
    pub(super) fn greatest(
        points_kt: &[f64],
        range_kt: [f64; 2],
        curve: impl Fn(f64) -> f64,
        measure: impl Fn(f64, f64) -> f64,
    ) -> Self {
        let values: Vec<f64> = points_kt.iter().map(|&kt| curve(kt)).collect();
        let deviation_at = |kt: f64| Self {
            value: measure(interpolated(points_kt, &values, kt), curve(kt)),
            airspeed_kt: kt,
        };
        // Grid search.
        let [least_kt, most_kt] = range_kt;
        let step_kt = (most_kt - least_kt) / GRID as f64;
        let mut greatest = deviation_at(least_kt);
        for index in 1..=GRID {
            greatest = greatest.or_greater(deviation_at(least_kt + index as f64 * step_kt));
        }
        // Golden-section search.
        let mut low_kt = (greatest.airspeed_kt - step_kt).max(least_kt);
        let mut high_kt = (greatest.airspeed_kt + step_kt).min(most_kt);
        let golden_ratio = (5_f64.sqrt() - 1.0) / 2.0;
        for _ in 0..STEPS {
            let left = deviation_at(high_kt - golden_ratio * (high_kt - low_kt));
            let right = deviation_at(low_kt + golden_ratio * (high_kt - low_kt));
            if left.value > right.value {
                greatest = greatest.or_greater(left);
                high_kt = right.airspeed_kt;
            } else {
                greatest = greatest.or_greater(right);
                low_kt = left.airspeed_kt;
            }
        }
        greatest
    }

    /// Returns the larger deviation; `self` if they are equal.
    pub(super) fn or_greater(self, other: Self) -> Self {
        if other.value > self.value {
            other
        } else {
            self
        }
    }
}

/// Interpolates a table linearly at an airspeed; the end values apply outside its range.
fn interpolated(points_kt: &[f64], values: &[f64], airspeed_kt: f64) -> f64 {
    let above = points_kt.partition_point(|&point_kt| point_kt <= airspeed_kt);
    match (above.checked_sub(1), points_kt.get(above)) {
        (None, _) => values[0],
        (Some(below), None) => values[below],
        (Some(below), Some(&above_kt)) => {
            let part = (airspeed_kt - points_kt[below]) / (above_kt - points_kt[below]);
            values[below] + part * (values[above] - values[below])
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_deviation_of_a_parabola_is_greatest_in_the_middle() {
        // Between 0 and h, the chord of x^2 is at most h^2/4 above the curve.
        let found = TableDeviation::greatest(
            &[0.0, 10.0, 16.0],
            [0.0, 16.0],
            |x| x * x,
            |a, b| (a - b).abs(),
        );
        assert!(
            (found.value - 25.0).abs() < 1e-12 && (found.airspeed_kt - 5.0).abs() < 1e-5,
            "{found:?}"
        );
    }

    #[test]
    fn beyond_the_table_its_end_values_count() {
        let found = TableDeviation::greatest(&[2.0, 4.0], [0.0, 4.0], |x| x, |a, b| (a - b).abs());
        assert_eq!(
            found,
            TableDeviation {
                value: 2.0,
                airspeed_kt: 0.0
            }
        );
    }
}
