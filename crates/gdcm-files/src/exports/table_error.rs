//! How far a table lies from the curve that it was taken from.

use super::lookup_table::LookupTable;

/// Intervals of the grid on which the greatest error is looked for.
const GRID: usize = 2000;
/// Steps of the golden section: each makes the interval 0.618 times as long.
const STEPS: usize = 60;

/// The greatest error of linear interpolation in a table.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TableError {
    /// The error, without a sign, in the unit in which it was measured.
    pub error: f64,
    /// The airspeed at which it is found \[kt\].
    pub airspeed_kt: f64,
}

impl TableError {
    /// Finds the greatest error of a table of `curve` at `points` within `range`; `measure` is the error of a value against the
    /// true one. A grid finds the neighbourhood, the golden section the place.
    pub(super) fn greatest(
        points: &[f64],
        range: (f64, f64),
        curve: impl Fn(f64) -> f64,
        measure: impl Fn(f64, f64) -> f64,
    ) -> Self {
        let values = points.iter().map(|&point| curve(point)).collect();
        let table = LookupTable { airspeed_kt: points.to_vec(), values };
        let error = |x: f64| measure(table.at(x), curve(x));
        let step = (range.1 - range.0) / GRID as f64;
        let mut best = Self { error: error(range.0), airspeed_kt: range.0 };
        for index in 1..=GRID {
            best.improve(error, range.0 + index as f64 * step);
        }
        let (mut low, mut high) = ((best.airspeed_kt - step).max(range.0), (best.airspeed_kt + step).min(range.1));
        let ratio = (5_f64.sqrt() - 1.0) / 2.0;
        for _ in 0..STEPS {
            let (left, right) = (high - ratio * (high - low), low + ratio * (high - low));
            let left_is_greater = error(left) > error(right);
            best.improve(error, if left_is_greater { left } else { right });
            if left_is_greater { high = right } else { low = left }
        }
        best
    }

    fn improve(&mut self, error: impl Fn(f64) -> f64, airspeed_kt: f64) {
        let found = error(airspeed_kt);
        if found > self.error {
            *self = Self { error: found, airspeed_kt };
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_error_of_a_parabola_is_greatest_in_the_middle() {
        // x^2 between 0 and h is at most h^2/4 below its chord.
        let found = TableError::greatest(&[0.0, 10.0, 16.0], (0.0, 16.0), |x| x * x, |a, b| (a - b).abs());
        assert!((found.error - 25.0).abs() < 1e-12 && (found.airspeed_kt - 5.0).abs() < 1e-5, "{found:?}");
    }

    #[test]
    fn beyond_the_table_its_end_values_count() {
        let found = TableError::greatest(&[2.0, 4.0], (0.0, 4.0), |x| x, |a, b| (a - b).abs());
        assert_eq!(found, TableError { error: 2.0, airspeed_kt: 0.0 });
    }
}
