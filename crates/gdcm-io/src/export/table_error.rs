//! Largest error of linear interpolation in a table.

/// Grid intervals in the search for the largest error.
const GRID: usize = 2000;
/// Golden-section steps: each multiplies the interval by 0.618.
const STEPS: usize = 60;

/// Largest error of linear interpolation in a table.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct TableError {
    /// Absolute error, in the unit of `measure`.
    pub(super) error: f64,
    /// Airspeed \[kt\] with this error.
    pub(super) airspeed_kt: f64,
}

impl TableError {
    /// Finds the largest error of a table of `curve` at `points` within `range_kt`; `measure`
    /// returns a value's error against the true value.
    ///
    /// A grid finds the neighbourhood, a golden-section search the location.
    pub(super) fn greatest(
        points: &[f64],
        range_kt: [f64; 2],
        curve: impl Fn(f64) -> f64,
        measure: impl Fn(f64, f64) -> f64,
    ) -> Self {
        let values: Vec<f64> = points.iter().map(|&point| curve(point)).collect();
        let error_at = |kt: f64| Self {
            error: measure(interpolated(points, &values, kt), curve(kt)),
            airspeed_kt: kt,
        };
        let [least, most] = range_kt;
        let step = (most - least) / GRID as f64;
        let mut greatest = error_at(least);
        for index in 1..=GRID {
            greatest = greatest.or_greater(error_at(least + index as f64 * step));
        }
        let mut low = (greatest.airspeed_kt - step).max(least);
        let mut high = (greatest.airspeed_kt + step).min(most);
        let ratio = (5_f64.sqrt() - 1.0) / 2.0;
        for _ in 0..STEPS {
            let left = error_at(high - ratio * (high - low));
            let right = error_at(low + ratio * (high - low));
            if left.error > right.error {
                greatest = greatest.or_greater(left);
                high = right.airspeed_kt;
            } else {
                greatest = greatest.or_greater(right);
                low = left.airspeed_kt;
            }
        }
        greatest
    }

    /// Returns the greater error, `self` if they are equal.
    pub(super) fn or_greater(self, other: Self) -> Self {
        if other.error > self.error {
            other
        } else {
            self
        }
    }
}

/// Interpolates a table at an airspeed: linear between its points, the end values outside.
fn interpolated(points: &[f64], values: &[f64], airspeed_kt: f64) -> f64 {
    let above = points.partition_point(|&point| point <= airspeed_kt);
    match (above.checked_sub(1), points.get(above)) {
        (None, _) => values[0],
        (Some(below), None) => values[below],
        (Some(below), Some(&end)) => {
            let part = (airspeed_kt - points[below]) / (end - points[below]);
            values[below] + part * (values[above] - values[below])
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_error_of_a_parabola_is_greatest_in_the_middle() {
        // x^2 between 0 and h is at most h^2/4 below its chord.
        let found = TableError::greatest(
            &[0.0, 10.0, 16.0],
            [0.0, 16.0],
            |x| x * x,
            |a, b| (a - b).abs(),
        );
        assert!(
            (found.error - 25.0).abs() < 1e-12 && (found.airspeed_kt - 5.0).abs() < 1e-5,
            "{found:?}"
        );
    }

    #[test]
    fn beyond_the_table_its_end_values_count() {
        let found = TableError::greatest(&[2.0, 4.0], [0.0, 4.0], |x| x, |a, b| (a - b).abs());
        assert_eq!(
            found,
            TableError {
                error: 2.0,
                airspeed_kt: 0.0
            }
        );
    }
}
