//! Curves over time as lines, interrupted where there are no values.

use std::sync::Arc;

/// Points on a curve, time \[s\] and value, as a line for each uninterrupted part.
pub(super) type TimeLines = Vec<Arc<[[f64; 2]]>>;

/// Returns a curve's value at a time \[s\], interpolated linearly; `None` outside its lines.
pub(super) fn value_at(lines: &[Arc<[[f64; 2]]>], time_s: f64) -> Option<f64> {
    for line in lines {
        let after = line.partition_point(|point| point[0] < time_s);
        let Some(next) = line.get(after) else {
            continue;
        };
        if next[0] == time_s {
            return Some(next[1]);
        }
        let Some(before) = after.checked_sub(1).and_then(|before| line.get(before)) else {
            continue;
        };
        let share = (time_s - before[0]) / (next[0] - before[0]);
        return Some(before[1] + share * (next[1] - before[1]));
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_value_is_interpolated_within_a_line_and_absent_between_lines() {
        let lines: TimeLines = vec![
            Arc::from([[0.0, 1.0], [1.0, 3.0]]),
            Arc::from([[4.0, 5.0], [5.0, 7.0]]),
        ];
        let values = [-0.1, 0.0, 0.25, 1.0, 2.0, 4.5, 5.1].map(|time_s| value_at(&lines, time_s));
        assert_eq!(
            values,
            [None, Some(1.0), Some(1.5), Some(3.0), None, Some(6.0), None]
        );
    }
}
