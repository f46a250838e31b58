//! Channels at their limit, logged in coarse steps or as stairs (M14.1, M14.18).
//!
//! ```text
//! flat: consecutive |dx| <= 1e-3 mean |dx|
//! run: a stretch of flat samples, or a single sample
//! at its limit: sample share in runs from max(5, 3 q) up whose mean lies in the outer 5 % of
//!     the range, q the 90 % quantile for the flat runs elsewhere; a caution above 0.5 %, or 10 %
//!     where flat runs elsewhere hold 20 % of all samples
//! coarse: the least step between two values is over half the standard deviation
//! ```

use gdcm_model::simulation::{FlightRecord, Signal};
use gdcm_model::statistics::{median, quantile};

/// Step over the mean step up to which two samples are flat.
const FLAT: f64 = 1e-3;
/// Shortest run at a limit, in samples.
const SHORTEST: f64 = 5.0;
/// Shortest run at a limit over the usual run elsewhere.
const OVER_USUAL: f64 = 3.0;
/// Usual quantile for the runs elsewhere.
const USUAL: f64 = 0.9;
/// Share of the range at each end in which a limit lies.
const OUTER: f64 = 0.05;
/// Greatest acceptable sample share at a limit for a smooth channel.
const MOST_AT_LIMIT: f64 = 0.005;
/// The same for a coarse channel or stairs.
const MOST_AT_LIMIT_HELD: f64 = 0.1;
/// Sample share in flat runs away from the limits above which a channel counts as held.
const HELD_SHARE: f64 = 0.2;
/// Least step between values over the standard deviation above which a channel is coarse.
pub(crate) const COARSE: f64 = 0.5;
/// Share of equal consecutive samples, above which a moving channel is a stair (M14.1).
const STAIR_SHARE: f64 = 0.5;
/// Equal samples for longer than this are a channel at rest, and no stair \[s\].
const REST_S: f64 = 1.0;
/// Fewest moving samples from which stairs are recognised.
const LEAST_MOVING: usize = 50;

/// A channel's value with its stamp.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sample {
    pub(crate) time_s: f64,
    pub(crate) value: f64,
}

/// Returns a channel's samples with finite stamp and value.
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

/// How often a channel is at its limit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Clipping {
    /// Share of the samples.
    pub(crate) share: f64,
    /// Greatest acceptable share.
    pub(crate) most: f64,
}

impl Clipping {
    /// Measures how often a channel is at its limit.
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

/// The usual flat run; 1 without any.
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

/// Least and greatest value.
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

/// Whether a channel has so few distinct values that standing still is nothing unusual.
pub(crate) fn is_coarse(values: &[f64]) -> bool {
    coarseness(values).is_some_and(|steps| steps > COARSE)
}

/// Returns the least step between two values over the standard deviation; `None` if nothing moves.
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

/// Stairs in a channel.
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
