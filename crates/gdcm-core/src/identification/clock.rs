//! The time stamps of a record.

use super::gap::{Cause, Gap, Treatment};
use super::{FlightRecord, PreparationError};

/// Stamps further off the multiples of the sample time than this share of it are uneven (M14, 1.1).
const UNEVEN_PERCENT: f64 = 20.0;
/// Of the deviations of the stamps this share counts: one late stamp is no jitter.
const COUNTED: f64 = 0.95;

/// The stamps of a record, and the grid that they stand for.
pub(super) struct Clock {
    /// First stamp \[s\].
    pub start_s: f64,
    /// Median difference of two stamps \[s\]; 0 where there are not two.
    pub sample_time_s: f64,
    /// 95th percentile of how far differences are off the multiples of the sample time \[%\].
    pub jitter_percent: f64,
    /// Rows with a stamp.
    pub rows: Vec<usize>,
    /// Their stamps \[s\], counted from the first.
    pub times: Vec<f64>,
    /// Two samples further apart than this \[s\] have a gap between them that is not bridged.
    pub longest_step_s: f64,
}

impl Clock {
    /// The clock of `record`; gaps of `longest_bridge` samples are bridged.
    pub fn of(record: &FlightRecord, longest_bridge: usize) -> Result<Self, PreparationError> {
        let rows: Vec<usize> = (0..record.time_s.len()).filter(|&row| record.time_s[row].is_finite()).collect();
        let start_s = rows.first().map_or(0.0, |&row| record.time_s[row]);
        let times: Vec<f64> = rows.iter().map(|&row| record.time_s[row] - start_s).collect();
        for (pair, place) in rows.windows(2).zip(0..) {
            // Counted from the first stamp: huge stamps may differ, and yet not when they are counted so.
            let step = times[place + 1] - times[place];
            if !(step > 0.0 && step.is_finite()) {
                let (previous_s, time_s) = (record.time_s[pair[0]], record.time_s[pair[1]]);
                let record = record.name.clone();
                return Err(PreparationError::TimeNotIncreasing { record, row: pair[1], previous_s, time_s });
            }
        }
        let steps: Vec<f64> = times.windows(2).map(|pair| pair[1] - pair[0]).collect();
        let sample_time_s = quantile(steps.clone(), 0.5);
        let off = |step: &f64| (step / sample_time_s - (step / sample_time_s).round().max(1.0)).abs();
        let jitter_percent = 100.0 * quantile(steps.iter().map(off).collect(), COUNTED);
        let longest_step_s = (longest_bridge as f64 + 1.5) * sample_time_s;
        Ok(Self { start_s, sample_time_s, jitter_percent, rows, times, longest_step_s })
    }

    /// Whether the stamps are more than 20 % off the multiples of the sample time.
    pub fn is_uneven(&self) -> bool {
        // Stamps rounded to a digit may lie just at the limit.
        self.jitter_percent > UNEVEN_PERCENT * (1.0 + 1e-6)
    }

    /// From the first stamp to the last \[s\].
    pub fn logged_s(&self) -> f64 {
        self.times.last().copied().unwrap_or(0.0)
    }

    /// The grid `k dt` between two gaps of the stamps: its first `k`, a whole number, and how many points it has.
    pub fn grid(&self) -> Vec<(f64, usize)> {
        let mut grid = Vec::new();
        let mut from = 0;
        for to in 0..self.times.len() {
            let next = self.times.get(to + 1);
            if next.is_none_or(|next| next - self.times[to] > self.longest_step_s) {
                if to > from {
                    // A millionth of a sample is rounding.
                    let last = (self.times[to] / self.sample_time_s + 1e-6).floor();
                    let first = (self.times[from] / self.sample_time_s).ceil();
                    grid.push((first, (last - first + 1.0).max(0.0) as usize));
                }
                from = to + 1;
            }
        }
        grid
    }

    /// Gaps between the stamps.
    pub fn gaps(&self) -> impl Iterator<Item = Gap> + '_ {
        (1..self.times.len()).filter_map(|k| {
            let step = self.times[k] - self.times[k - 1];
            let stamp_missing = self.rows[k] > self.rows[k - 1] + 1;
            let cause = if stamp_missing { Cause::StampsMissing } else { Cause::RowsMissing };
            (stamp_missing || step > 1.5 * self.sample_time_s).then(|| Gap {
                start_s: self.start_s + self.times[k - 1],
                end_s: self.start_s + self.times[k],
                cause,
                treatment: Treatment::of(step <= self.longest_step_s),
            })
        })
    }
}

/// The value below which `share` of the values lie; the middle two are averaged for a half, 0 of none.
pub(super) fn quantile(mut values: Vec<f64>, share: f64) -> f64 {
    values.sort_by(f64::total_cmp);
    let place = share * values.len().saturating_sub(1) as f64;
    let (low, high) = (values.get(place.floor() as usize), values.get(place.ceil() as usize));
    low.zip(high).map_or(0.0, |(low, high)| if low == high { *low } else { low + (high - low) * place.fract() })
}
