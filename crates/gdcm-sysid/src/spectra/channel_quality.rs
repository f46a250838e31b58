//! Channels at their limit, in coarse steps or with stairs (M14.1, M14.18).
//!
//! ```text
//! flat: consecutive |dx| <= 1e-3 mean |dx|
//! run: a stretch of flat samples, or a single sample
//! at its limit: share of the samples in runs of at least max(5, 3 q) samples whose mean lies in
//!     the outer 5 % of the range, with the 90 % quantile q of the flat runs elsewhere; a caution
//!     above 0.5 %, or above 10 % where flat runs elsewhere hold 20 % of all samples
//! coarse: the smallest step between two values is over half the standard deviation
//! ```

use gdcm_model::simulation::{FlightRecord, Signal};
use gdcm_model::statistics::{median, quantile};

/// Maximum step between two samples of a flat run, relative to the mean step.
const FLAT: f64 = 1e-3;
/// Minimum length of a run at a limit, in samples.
const SHORTEST: f64 = 5.0;
/// Minimum length of a run at a limit, relative to the usual length of flat runs elsewhere.
const OVER_USUAL: f64 = 3.0;
/// Quantile that gives the usual length of the flat runs elsewhere.
const USUAL: f64 = 0.9;
/// Share of the range, at each end, that belongs to a limit.
const OUTER: f64 = 0.05;
/// Maximum acceptable share of samples at a limit in a smooth channel.
const MOST_AT_LIMIT: f64 = 0.005;
/// Maximum acceptable share of samples at a limit in a coarse channel or one with stairs.
const MOST_AT_LIMIT_HELD: f64 = 0.1;
/// A channel counts as held if flat runs away from the limits hold more than this share of its
/// samples.
const HELD_SHARE: f64 = 0.2;
/// A channel is coarse if its smallest step between values exceeds this share of the standard
/// deviation.
pub(crate) const COARSE: f64 = 0.5;
/// A moving channel has stairs if more than this share of its consecutive samples are equal
/// (M14.1).
const STAIR_SHARE: f64 = 0.5;
/// Maximum duration of a stair \[s\]; a channel with equal samples for longer is at rest.
const REST_S: f64 = 1.0;
/// Minimum number of moving samples for recognising stairs.
const LEAST_MOVING: usize = 50;

/// Value of a channel with its stamp.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sample {
    pub(crate) time_s: f64,
    pub(crate) value: f64,
}

/// Returns the samples of a channel that have a finite stamp and a finite value.
pub(crate) fn finite_samples(record: &FlightRecord, signal: &Signal) -> Vec<Sample> {
    let values = record.channel(signal);
    let mut samples = Vec::new();
    for (&time_s, &value) in record.time_s.iter().zip(values.iter()) {
        if time_s.is_finite() && value.is_finite() {
            samples.push(Sample { time_s, value });
        }
    }
    samples
}

/// Returns a channel's finite values.
pub(crate) fn finite_values(record: &FlightRecord, signal: &Signal) -> Vec<f64> {
    record
        .channel(signal)
        .iter()
        .copied()
        .filter(|x| x.is_finite())
        .collect()
}

/// Share of a channel's samples at its limit, with the acceptable maximum.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Clipping {
    pub(crate) share: f64,
    /// Maximum acceptable share.
    pub(crate) most: f64,
}

impl Clipping {
    /// Measures the share of the samples at a limit.
    pub(crate) fn measure(samples: &[f64]) -> Self {
        let steps = samples.windows(2).map(|pair| (pair[1] - pair[0]).abs());
        let flat = FLAT * steps.sum::<f64>() / samples.len().saturating_sub(1).max(1) as f64;
        let range = Range::of_values(samples);
        let outer = OUTER * (range.greatest - range.least);
        let mut at_ends = Vec::new();
        let mut elsewhere = Vec::new();
        for run in samples.chunk_by(|a, b| (b - a).abs() <= flat) {
            let mean = run.iter().sum::<f64>() / run.len() as f64;
            if mean >= range.greatest - outer || mean <= range.least + outer {
                at_ends.push(run.len());
            } else {
                elsewhere.push(run.len());
            }
        }
        let flat_elsewhere: Vec<usize> =
            elsewhere.into_iter().filter(|length| *length > 1).collect();
        let shortest = SHORTEST.max(OVER_USUAL * usual_length(&flat_elsewhere));
        let at_limit: usize = at_ends
            .into_iter()
            .filter(|length| *length as f64 >= shortest)
            .sum();
        let held = share_of(flat_elsewhere.iter().sum(), samples);
        Self {
            share: share_of(at_limit, samples),
            most: if held > HELD_SHARE {
                MOST_AT_LIMIT_HELD
            } else {
                MOST_AT_LIMIT
            },
        }
    }

    pub(crate) fn is_excessive(&self) -> bool {
        self.share > self.most
    }
}

/// Returns the usual length of flat runs; 1 if there are none.
fn usual_length(runs: &[usize]) -> f64 {
    if runs.is_empty() {
        return 1.0;
    }
    let mut lengths: Vec<f64> = runs.iter().map(|length| *length as f64).collect();
    quantile(&mut lengths, USUAL)
}

fn share_of(count: usize, samples: &[f64]) -> f64 {
    count as f64 / samples.len().max(1) as f64
}

/// Minimum and maximum of a channel.
pub(crate) struct Range {
    pub(crate) least: f64,
    pub(crate) greatest: f64,
}

impl Range {
    pub(crate) fn of_values(values: &[f64]) -> Self {
        let mut range = Self {
            least: f64::INFINITY,
            greatest: f64::NEG_INFINITY,
        };
        for value in values {
            range.least = range.least.min(*value);
            range.greatest = range.greatest.max(*value);
        }
        range
    }
}

/// Whether a channel has so few distinct values that equal consecutive samples are normal.
pub(crate) fn is_coarse(values: &[f64]) -> bool {
    coarseness(values).is_some_and(|steps| steps > COARSE)
}

/// Returns the smallest step between two values divided by the standard deviation; `None` if the
/// channel is constant.
pub(crate) fn coarseness(values: &[f64]) -> Option<f64> {
    let count = values.len().max(1) as f64;
    let mean = values.iter().sum::<f64>() / count;
    let variance = values.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / count;
    let deviation = variance.sqrt();
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let least = sorted
        .windows(2)
        .map(|pair| pair[1] - pair[0])
        .filter(|step| *step > FLAT * deviation)
        .fold(f64::INFINITY, f64::min);
    if deviation > 0.0 && least.is_finite() {
        Some(least / deviation)
    } else {
        None
    }
}

/// Stairs in a channel: equal consecutive samples although the channel moves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Stairs {
    /// Share of equal consecutive samples while the channel moves.
    pub(crate) share: f64,
    /// Median time between changes \[s\].
    pub(crate) hold_s: f64,
}

impl Stairs {
    /// Finds stairs in a channel's samples, record by record; `None` if at most half the
    /// consecutive samples are equal.
    pub(crate) fn find(records: impl Iterator<Item = Vec<Sample>>) -> Option<Self> {
        let mut samples = 0;
        let mut steps_s = Vec::new();
        for record in records {
            let runs: Vec<&[Sample]> = record.chunk_by(|a, b| a.value == b.value).collect();
            for pair in runs.windows(2) {
                let held_s = pair[1][0].time_s - pair[0][0].time_s;
                if held_s <= REST_S {
                    samples += pair[0].len();
                    steps_s.push(held_s);
                }
            }
        }
        let share = 1.0 - steps_s.len() as f64 / samples.max(1) as f64;
        if samples < LEAST_MOVING || share <= STAIR_SHARE {
            return None;
        }
        Some(Self {
            share,
            hold_s: median(&mut steps_s),
        })
    }
}
