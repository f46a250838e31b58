//! Removes a channel's logging delay on its record's clock.

use super::sample_step::median_step;

/// Longest interpolated interval, in median steps: three missing samples, as when records are
/// prepared (M14.1).
const LONGEST_LINE: f64 = 4.5;

/// Removes a logging delay \[s\] from a channel: the value at t becomes the linear interpolation at
/// t + delay between two adjacent samples; NaN beyond the ends, next to a missing sample or stamp,
/// and in a gap between stamps.
pub(super) fn advanced(time_s: &[f64], values: &[f64], delay_s: f64) -> Vec<f64> {
    let lines = SampleLines {
        time_s,
        values,
        longest_s: LONGEST_LINE * median_step(time_s).unwrap_or(0.0),
    };
    let mut advanced = Vec::with_capacity(time_s.len());
    // The first row later than the interpolated time, which increases from row to row.
    let mut next = 0;
    for time in time_s {
        let read_s = time + delay_s;
        if !read_s.is_finite() {
            advanced.push(f64::NAN);
            continue;
        }
        while next < time_s.len() && (time_s[next] <= read_s || time_s[next].is_nan()) {
            next += 1;
        }
        advanced.push(lines.value_before(next, read_s));
    }
    advanced
}

/// Straight lines between a channel's adjacent samples.
struct SampleLines<'r> {
    /// Stamps \[s\].
    time_s: &'r [f64],
    values: &'r [f64],
    /// Longest line \[s\]; a longer interval between stamps is a gap.
    longest_s: f64,
}

impl SampleLines<'_> {
    /// Returns the value at `read_s` on the line that ends at row `next`, or the preceding sample
    /// itself if its stamp is `read_s`; NaN if there is neither.
    fn value_before(&self, next: usize, read_s: f64) -> f64 {
        let Some(before) = next.checked_sub(1) else {
            return f64::NAN;
        };
        if self.time_s[before] == read_s {
            return self.value(before);
        }
        let Some(after) = self.time_s.get(next) else {
            return f64::NAN;
        };
        let step = after - self.time_s[before];
        let part = (read_s - self.time_s[before]) / step;
        if step <= self.longest_s {
            self.value(before) + part * (self.value(next) - self.value(before))
        } else {
            f64::NAN
        }
    }

    fn value(&self, row: usize) -> f64 {
        self.values.get(row).copied().unwrap_or(f64::NAN)
    }
}
