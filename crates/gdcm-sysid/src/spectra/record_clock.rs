//! A record's time stamps, their jitter and their uniform grid (M14.1).
//!
//! Rows without a finite stamp are left out. The rest of the preparation counts samples by their
//! index in [`Clock::times`], which differs from their row in the record.

use gdcm_model::simulation::{FlightRecord, Signal};
use gdcm_model::statistics::quantile;

use super::preparation_settings::PreparationError;

/// Stamps are even if they deviate from multiples of the sample time by at most this much \[%\]
/// (M14.1).
const UNEVEN_PERCENT: f64 = 20.0;
/// Quantile of the deviations that is the jitter: a single late stamp is none.
const JITTER_QUANTILE: f64 = 0.95;
/// Tolerance for rounded stamps: relative to the jitter limit, and in samples at a grid point.
const ROUNDING: f64 = 1e-6;

/// A record's stamps, with their median step and their jitter.
pub(crate) struct Clock {
    /// First stamp \[s\].
    pub start_s: f64,
    /// Median step between stamps \[s\]; 0 for fewer than two stamps.
    pub sample_time_s: f64,
    /// The steps' deviation from multiples of the sample time, 95th percentile \[%\].
    pub jitter_percent: f64,
    /// Indices of the rows with a finite stamp.
    pub rows: Vec<usize>,
    /// Stamps in these rows \[s\], relative to the first stamp.
    pub times: Vec<f64>,
    /// Stamps further apart than this \[s\] have a gap between them that is not bridged: one step
    /// more than the bridged samples, and half a step of tolerance.
    pub longest_step_s: f64,
}

/// Grid points `k dt` between two gaps.
pub(crate) struct GridStretch {
    /// First `k`, an integer value.
    pub first: f64,
    pub points: usize,
}

impl Clock {
    /// Reads the clock from `record`; gaps up to `longest_bridge` samples are bridged.
    ///
    /// # Errors
    /// Stamps that do not increase.
    pub fn new(record: &FlightRecord, longest_bridge: usize) -> Result<Self, PreparationError> {
        let rows: Vec<usize> = (0..record.time_s.len())
            .filter(|&row| record.time_s[row].is_finite())
            .collect();
        let start_s = rows.first().map_or(0.0, |&row| record.time_s[row]);
        let times: Vec<f64> = rows
            .iter()
            .map(|&row| record.time_s[row] - start_s)
            .collect();
        check_increasing(record, &rows, &times)?;
        let steps: Vec<f64> = times.windows(2).map(|pair| pair[1] - pair[0]).collect();
        let sample_time_s = quantile_or_zero(steps.clone(), 0.5);
        // In sample times. A step over missing rows is a multiple of the sample time.
        let deviations = steps
            .iter()
            .map(|step| step / sample_time_s)
            .map(|steps| (steps - steps.round().max(1.0)).abs())
            .collect();
        Ok(Self {
            start_s,
            sample_time_s,
            jitter_percent: 100.0 * quantile_or_zero(deviations, JITTER_QUANTILE),
            rows,
            times,
            longest_step_s: (longest_bridge as f64 + 1.5) * sample_time_s,
        })
    }

    /// Returns whether the jitter exceeds 20 % of the sample time.
    pub fn is_uneven(&self) -> bool {
        // Rounded stamps may be just at the limit.
        self.jitter_percent > UNEVEN_PERCENT * (1.0 + ROUNDING)
    }

    /// Returns the time from the first stamp to the last \[s\].
    pub fn logged_s(&self) -> f64 {
        self.times.last().copied().unwrap_or(0.0)
    }

    /// Returns the grid `k dt` in stretches between gaps; single stamps between gaps are omitted.
    pub fn grid(&self) -> Vec<GridStretch> {
        let mut grid = Vec::new();
        let mut from = 0;
        for to in 0..self.times.len() {
            let next = self.times.get(to + 1);
            let ends = next.is_none_or(|next| next - self.times[to] > self.longest_step_s);
            if !ends {
                continue;
            }
            if to > from {
                let last = (self.times[to] / self.sample_time_s + ROUNDING).floor();
                let first = (self.times[from] / self.sample_time_s - ROUNDING).ceil();
                grid.push(GridStretch {
                    first,
                    points: (last - first + 1.0).max(0.0) as usize,
                });
            }
            from = to + 1;
        }
        grid
    }
}

/// Consecutive indices `from..to` of a clock's stamps.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct StampRange {
    pub from: usize,
    pub to: usize,
}

/// A channel's values at a clock's stamps.
pub(crate) struct StampedValues {
    pub signal: Signal,
    pub values: Vec<f64>,
}

impl StampedValues {
    /// Takes a signal's values in the rows that have a stamp.
    pub fn new(record: &FlightRecord, clock: &Clock, signal: Signal) -> Self {
        let samples = record.channel(&signal);
        Self {
            values: clock.rows.iter().map(|&row| samples[row]).collect(),
            signal,
        }
    }
}

/// Returns an error for stamps that do not increase.
fn check_increasing(
    record: &FlightRecord,
    rows: &[usize],
    times: &[f64],
) -> Result<(), PreparationError> {
    for k in 1..times.len() {
        // Compare the times relative to the first stamp: two large stamps that differ may be equal
        // after the subtraction.
        let step = times[k] - times[k - 1];
        if !(step > 0.0 && step.is_finite()) {
            return Err(PreparationError::TimeNotIncreasing {
                record: record.name.clone(),
                row: rows[k],
                previous_s: record.time_s[rows[k - 1]],
                time_s: record.time_s[rows[k]],
            });
        }
    }
    Ok(())
}

/// Returns a quantile; 0 if there are no values, as for a single stamp.
fn quantile_or_zero(mut values: Vec<f64>, share: f64) -> f64 {
    if values.is_empty() {
        0.0
    } else {
        quantile(&mut values, share)
    }
}
