//! Reduces a channel to the samples at which it was updated: stairs keep their first sample only.
//! Used by the searches for spikes and rate limits, which compare neighbouring samples.
//!
//! *Stairs* are runs of equal samples in a channel that moves: it is held, or logged more often
//! than it changes (`stairs`).

use gdcm_model::statistics::median;

use super::finite_samples::Sample;
use super::stairs::Stairs;

/// Longest stair \[s\]; a channel that is constant for longer is at rest.
const LONGEST_STAIR_S: f64 = 0.1;
/// Differences between two values below this share of the range are rounding errors, and no logging
/// step.
const ROUNDING: f64 = 1e-9;
/// Share of a stair after which an equal sample counts as the next stair; below 1, so that a
/// slightly short stair counts too.
const NEXT_STAIR: f64 = 0.9;

/// A channel's samples, at its own sample time.
pub(super) struct FreshSamples {
    pub(super) samples: Vec<Sample>,
    /// Median sample time \[s\]; 0 for fewer than two samples.
    pub(super) sample_time_s: f64,
}

impl FreshSamples {
    /// Reduces stairs of at most 0.1 s to their first samples; without such stairs, all samples
    /// remain.
    pub(super) fn new(samples: Vec<Sample>) -> Self {
        let stairs = Stairs::find(std::iter::once(samples.clone()));
        let samples = match stairs {
            Some(stairs) if stairs.hold_s <= LONGEST_STAIR_S => {
                first_of_each_stair(&samples, stairs.hold_s)
            }
            _ => samples,
        };
        let mut steps_s: Vec<f64> = samples
            .windows(2)
            .map(|pair| pair[1].time_s - pair[0].time_s)
            .collect();
        let sample_time_s = if steps_s.is_empty() {
            0.0
        } else {
            median(&mut steps_s)
        };
        Self {
            samples,
            sample_time_s,
        }
    }

    /// Returns the logging step, the smallest difference between two values; infinite for a
    /// constant.
    pub(super) fn log_step(&self) -> f64 {
        let mut values: Vec<f64> = self.samples.iter().map(|sample| sample.value).collect();
        values.sort_by(f64::total_cmp);
        let (Some(least), Some(greatest)) = (values.first(), values.last()) else {
            return f64::INFINITY;
        };
        let rounding = ROUNDING * (greatest - least);
        values
            .windows(2)
            .map(|pair| pair[1] - pair[0])
            .filter(|difference| *difference > rounding)
            .fold(f64::INFINITY, f64::min)
    }
}

/// Keeps the first sample in each stair; a constant stretch consists of stairs that last `hold_s`
/// \[s\].
fn first_of_each_stair(samples: &[Sample], hold_s: f64) -> Vec<Sample> {
    let mut kept = Vec::new();
    for run in samples.chunk_by(|a, b| a.value == b.value) {
        let mut next_s = f64::NEG_INFINITY;
        for sample in run {
            if sample.time_s >= next_s {
                kept.push(*sample);
                next_s = sample.time_s + NEXT_STAIR * hold_s;
            }
        }
    }
    kept
}
