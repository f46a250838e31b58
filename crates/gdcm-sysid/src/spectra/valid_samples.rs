//! Each channel's valid samples, with straight lines that bridge short gaps (M14.1).
//!
//! A sample is valid if it is finite and not frozen and, for a slow sensor, fresh. Gaps of at most
//! [`Preparation::longest_bridge`] samples (3 by default) are bridged, and the bridge then counts
//! as measured. Longer gaps are left to `filled_segment`, where the missing samples remain unknown.
//!
//! A channel may be *shifted*: its stamps are later than its values by a stated delay, or by half a
//! hold. It is then read between its stamps.

use gdcm_model::dataset::channel::ChannelSide;
use gdcm_model::simulation::{FlightRecord, Signal};
use gdcm_model::statistics::median;

use super::frozen_outputs::frozen_runs;
use super::preparation_settings::{ChannelPreparation, Hold, Preparation};
use super::record_clock::{Clock, StampRange, StampedValues};

/// Tolerance for a time beyond the last sample, relative to the sample time.
const ROUNDING: f64 = 1e-6;

/// Finds each channel's valid samples in `record`: inputs, then outputs.
pub(crate) fn valid_samples(
    record: &FlightRecord,
    clock: &Clock,
    preparation: &Preparation,
) -> Vec<ValidSamples> {
    let channels: Vec<StampedValues> = preparation
        .channels()
        .map(|(signal, _)| StampedValues::new(record, clock, signal))
        .collect();
    let mut found = Vec::with_capacity(channels.len());
    for ((signal, settings), channel) in preparation.channels().zip(&channels) {
        let frozen = if signal.role == ChannelSide::Output && !preparation.keep_frozen {
            frozen_runs(channel, &channels, clock)
        } else {
            Vec::new()
        };
        found.push(ValidSamples::new(channel, &frozen, clock, settings));
    }
    found
}

/// A channel's valid samples, at times relative to the record's first stamp.
pub(crate) struct ValidSamples {
    pub signal: Signal,
    /// Runs of samples that are frozen or not finite.
    pub invalid: Vec<InvalidRun>,
    /// Samples further apart than this \[s\] have a gap between them that is not bridged.
    pub longest_step_s: f64,
    /// The valid samples' stamps \[s\].
    times: Vec<f64>,
    values: Vec<f64>,
    /// How much later the stamps are than the values \[s\]; the value at `t` is read at
    /// `t + shift_s`.
    shift_s: f64,
    /// Tolerance for a time beyond the last sample \[s\].
    rounding_s: f64,
    /// Tolerance for a time beyond the samples at a gap's ends \[s\]: rounded grid times may lie
    /// just beyond a stamp. It is 0 for a shifted channel, which has values only between valid
    /// stamps.
    gap_rounding_s: f64,
}

impl ValidSamples {
    /// Takes the samples that are finite and not frozen; with [`Hold::FreshSamples`], only the
    /// fresh ones.
    fn new(
        channel: &StampedValues,
        frozen: &[StampRange],
        clock: &Clock,
        settings: &ChannelPreparation,
    ) -> Self {
        let is_valid = validity(&channel.values, frozen);
        let mut kept: Vec<usize> = (0..is_valid.len()).filter(|&k| is_valid[k]).collect();
        let mut longest_step_s = clock.longest_step_s;
        if settings.hold == Hold::FreshSamples {
            let held_s = keep_fresh_samples(channel, clock, &mut kept);
            longest_step_s *= (held_s / clock.sample_time_s).max(1.0);
        }
        let shift_s = settings.shift_s();
        let rounding_s = ROUNDING * clock.sample_time_s;
        Self {
            signal: channel.signal.clone(),
            invalid: invalid_runs(&is_valid, frozen),
            longest_step_s,
            times: kept.iter().map(|&k| clock.times[k]).collect(),
            values: kept.iter().map(|&k| channel.values[k]).collect(),
            shift_s,
            rounding_s,
            gap_rounding_s: if shift_s == 0.0 { rounding_s } else { 0.0 },
        }
    }

    /// Returns a reader, which must be called with ascending times.
    pub fn reader(&self) -> SampleReader<'_> {
        SampleReader {
            samples: self,
            next: 0,
        }
    }
}

/// Reads a channel's samples at ascending times.
pub(crate) struct SampleReader<'a> {
    samples: &'a ValidSamples,
    /// Index of the first sample after the last time read.
    next: usize,
}

impl SampleReader<'_> {
    /// Returns the channel's value at `t` \[s\] after the record's first stamp, with the shift
    /// removed:
    ///
    /// - before the first sample, `None`
    /// - after the last, its value within the rounding, else `None`
    /// - on a sample, its value
    /// - in a gap that is not bridged, a value at its ends within the rounding, else `None`
    /// - else on the straight line between two samples
    pub fn at(&mut self, t: f64) -> Option<f64> {
        let ValidSamples { times, values, .. } = self.samples;
        // From here on, `t` is on the scale of the stamps.
        let t = t + self.samples.shift_s;
        while times.get(self.next).is_some_and(|&time| time <= t) {
            self.next += 1;
        }
        let before = self.next.checked_sub(1)?;
        let time = times[before];
        let value = values[before];
        let Some(&after) = times.get(self.next) else {
            let is_last = t - time <= self.samples.rounding_s;
            return if is_last { Some(value) } else { None };
        };
        if t == time {
            return Some(value);
        }
        if after - time > self.samples.longest_step_s {
            return if t - time <= self.samples.gap_rounding_s {
                Some(value)
            } else if after - t <= self.samples.gap_rounding_s {
                Some(values[self.next])
            } else {
                None
            };
        }
        let share = (t - time) / (after - time);
        Some(value + share * (values[self.next] - value))
    }
}

/// Reads all channels at `t` \[s\] into `row`.
pub(crate) fn read_row(readers: &mut [SampleReader<'_>], t: f64, row: &mut [Option<f64>]) {
    for (reader, value) in readers.iter_mut().zip(row) {
        *value = reader.at(t);
    }
}

/// Returns, for each stamp, whether the value is finite and outside the frozen runs.
fn validity(values: &[f64], frozen: &[StampRange]) -> Vec<bool> {
    let mut is_valid: Vec<bool> = values.iter().map(|value| value.is_finite()).collect();
    for run in frozen {
        is_valid[run.from..run.to].fill(false);
    }
    is_valid
}

/// Consecutive invalid samples.
pub(crate) struct InvalidRun {
    pub stamps: StampRange,
    /// Whether some samples are frozen.
    pub is_frozen: bool,
}

/// Finds runs in which samples are invalid.
fn invalid_runs(is_valid: &[bool], frozen: &[StampRange]) -> Vec<InvalidRun> {
    let mut runs = Vec::new();
    let mut from = 0;
    for run in is_valid.chunk_by(|a, b| a == b) {
        let to = from + run.len();
        if !run[0] {
            // The last frozen run that begins before the end of this run; they overlap if it also
            // ends after its beginning.
            let before = frozen[..frozen.partition_point(|run| run.from < to)].last();
            runs.push(InvalidRun {
                stamps: StampRange { from, to },
                is_frozen: before.is_some_and(|run| from < run.to),
            });
        }
        from = to;
    }
    runs
}

/// Removes from `kept`, the indices of a slow sensor's valid samples, those that are not fresh;
/// returns the sensor's sample time \[s\].
///
/// A sample is fresh if it differs from the preceding sample, or if the sensor's sample time (the
/// median time between changes) has passed since the last fresh sample: a sensor may read the same
/// value twice.
fn keep_fresh_samples(channel: &StampedValues, clock: &Clock, kept: &mut Vec<usize>) -> f64 {
    let mut changes = Vec::new();
    for pair in kept.windows(2) {
        if channel.values[pair[0]] != channel.values[pair[1]] {
            changes.push(clock.times[pair[1]]);
        }
    }
    let mut holds: Vec<f64> = changes.windows(2).map(|pair| pair[1] - pair[0]).collect();
    // Without holds the median is NaN, which `max` ignores.
    let held_s = median(&mut holds).max(clock.sample_time_s);
    let mut previous: Option<usize> = None;
    let mut last_fresh_s = f64::NEG_INFINITY;
    kept.retain(|&k| {
        let time = clock.times[k];
        let has_changed = previous.is_none_or(|before| channel.values[before] != channel.values[k]);
        previous = Some(k);
        let is_fresh = has_changed || time - last_fresh_s >= held_s - 0.5 * clock.sample_time_s;
        if is_fresh {
            last_fresh_s = time;
        }
        is_fresh
    });
    held_s
}
