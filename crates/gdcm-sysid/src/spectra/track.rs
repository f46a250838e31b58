//! Valid samples of each channel, and the straight lines between them (M14.1).

use std::collections::BTreeMap;

use gdcm_model::dataset::channel::ChannelSide;
use gdcm_model::simulation::{FlightRecord, Signal};
use gdcm_model::statistics::{median, quantile};

use super::channel_quality::{Range, is_coarse};
use super::clock::Clock;
use super::gaps::{Cause, Gap, Treatment};
use super::preparation_settings::{ChannelPreparation, Hold, Preparation};

/// Minimum duration of a frozen run \[s\].
const FROZEN_S: f64 = 1.0;
/// Minimum length of a frozen run, relative to the usual length of runs with equal samples.
const UNUSUAL: f64 = 5.0;
/// Quantile that gives the usual length of runs with equal samples.
const USUAL: f64 = 0.95;
/// Minimum number of runs with equal samples in an output that can be frozen: with fewer runs, it
/// does not move at other times.
const RUNS_OF_A_MOVING: usize = 10;
/// Minimum number of equal samples in a run at the minimum or maximum of an output.
const RUN_AT_A_LIMIT: usize = 5;
/// Tolerance of a time beyond the last sample, relative to the sample time.
const ROUNDING: f64 = 1e-6;

/// Consecutive indices `from..to` of a clock's stamps.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Places {
    from: usize,
    to: usize,
}

impl Places {
    /// Returns the interval between the samples before and after the indices, or up to an end of
    /// the record, relative to its first stamp.
    fn surrounding(self, clock: &Clock) -> Interval {
        Interval {
            start_s: clock.times[self.from.saturating_sub(1)],
            end_s: clock.times[self.to.min(clock.times.len() - 1)],
        }
    }
}

struct Interval {
    start_s: f64,
    end_s: f64,
}

/// A gap in a channel. Gaps are sorted by these fields, in this order.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct ChannelGap {
    places: Places,
    is_frozen: bool,
    treatment: Treatment,
}

/// Valid samples of all channels in a record.
pub(crate) struct Tracks {
    /// Tracks of the inputs, then of the outputs.
    pub tracks: Vec<Track>,
    /// Gaps of the record; channels with the same gap share it.
    pub gaps: Vec<Gap>,
}

impl Tracks {
    /// Finds the valid samples of each channel in `record`.
    pub fn new(record: &FlightRecord, clock: &Clock, preparation: &Preparation) -> Self {
        let columns: Vec<Column> = preparation
            .channels()
            .map(|(signal, _)| Column::new(record, clock, signal))
            .collect();
        let mut tracks = Vec::new();
        let mut signals_by_gap: BTreeMap<ChannelGap, Vec<Signal>> = BTreeMap::new();
        for ((signal, channel), column) in preparation.channels().zip(&columns) {
            let frozen = if signal.role == ChannelSide::Output && !preparation.keep_frozen {
                column.frozen_runs(clock, &columns)
            } else {
                Vec::new()
            };
            let is_valid = column.valid_places(&frozen);
            let track = Track::new(column, &is_valid, clock, channel);
            for invalid in invalid_runs(&is_valid, &frozen) {
                let gap = ChannelGap {
                    places: invalid.places,
                    is_frozen: invalid.is_frozen,
                    treatment: track.treatment(clock, invalid.places),
                };
                signals_by_gap.entry(gap).or_default().push(signal.clone());
            }
            tracks.push(track);
        }
        let mut gaps = Vec::new();
        for (gap, signals) in signals_by_gap {
            let interval = gap.places.surrounding(clock);
            gaps.push(Gap {
                start_s: clock.start_s + interval.start_s,
                end_s: clock.start_s + interval.end_s,
                cause: if gap.is_frozen {
                    Cause::Frozen(signals)
                } else {
                    Cause::SamplesMissing(signals)
                },
                treatment: gap.treatment,
            });
        }
        Self { tracks, gaps }
    }
}

/// Valid samples of a channel, at times relative to the first stamp of the record.
pub(crate) struct Track {
    times: Vec<f64>,
    values: Vec<f64>,
    /// Delay of the stamps \[s\].
    shift_s: f64,
    /// Maximum time between two samples \[s\] that is no gap, or a gap that is bridged.
    longest_step_s: f64,
    rounding_s: f64,
}

impl Track {
    fn new(
        column: &Column,
        is_valid: &[bool],
        clock: &Clock,
        channel: &ChannelPreparation,
    ) -> Self {
        let mut places: Vec<usize> = (0..is_valid.len()).filter(|&k| is_valid[k]).collect();
        let mut longest_step_s = clock.longest_step_s;
        if channel.hold == Hold::FreshSamples {
            let held_s = keep_fresh_samples(column, clock, &mut places);
            longest_step_s *= (held_s / clock.sample_time_s).max(1.0);
        }
        Self {
            times: places.iter().map(|&k| clock.times[k]).collect(),
            values: places.iter().map(|&k| column.values[k]).collect(),
            shift_s: channel.shift_s(),
            longest_step_s,
            rounding_s: ROUNDING * clock.sample_time_s,
        }
    }

    /// Returns the treatment of a gap; a gap at an end of the record is cut out.
    fn treatment(&self, clock: &Clock, places: Places) -> Treatment {
        let interval = places.surrounding(clock);
        let is_inside = places.from > 0 && places.to < clock.times.len();
        Treatment::for_gap(is_inside && interval.end_s - interval.start_s <= self.longest_step_s)
    }

    /// Returns a reader, which must be called with ascending times.
    pub fn reader(&self) -> Reader<'_> {
        Reader {
            track: self,
            next: 0,
        }
    }
}

/// Reads a track at ascending times.
pub(crate) struct Reader<'a> {
    track: &'a Track,
    /// Index of the first sample after the last time read.
    next: usize,
}

impl Reader<'_> {
    /// Returns the value of the channel at `t` \[s\]; `None` in a gap and beyond the ends.
    pub fn at(&mut self, t: f64) -> Option<f64> {
        let Track { times, values, .. } = self.track;
        let t = t + self.track.shift_s;
        while times.get(self.next).is_some_and(|&time| time <= t) {
            self.next += 1;
        }
        let before = self.next.checked_sub(1)?;
        let time = times[before];
        let value = values[before];
        let Some(&after) = times.get(self.next) else {
            let is_last = t - time <= self.track.rounding_s;
            return if is_last { Some(value) } else { None };
        };
        if t == time {
            return Some(value);
        }
        if after - time > self.track.longest_step_s {
            return None;
        }
        let share = (t - time) / (after - time);
        Some(value + share * (values[self.next] - value))
    }
}

/// Reads all channels at `t` \[s\] into `row`; returns whether every channel has a value.
pub(crate) fn read_row(readers: &mut [Reader<'_>], t: f64, row: &mut [f64]) -> bool {
    let mut is_complete = true;
    for (reader, value) in readers.iter_mut().zip(row) {
        match reader.at(t) {
            Some(read) => *value = read,
            None => {
                *value = 0.0;
                is_complete = false;
            }
        }
    }
    is_complete
}

/// Keeps in `places` the fresh samples of a slow sensor, and returns its sample time \[s\].
///
/// A sample is fresh if it differs from the preceding sample, or if the sample time of the sensor
/// (the median time between changes) has passed since the last fresh sample: a sensor may read the
/// same value twice.
fn keep_fresh_samples(column: &Column, clock: &Clock, places: &mut Vec<usize>) -> f64 {
    let mut changes = Vec::new();
    for pair in places.windows(2) {
        if column.values[pair[0]] != column.values[pair[1]] {
            changes.push(clock.times[pair[1]]);
        }
    }
    let mut holds: Vec<f64> = changes.windows(2).map(|pair| pair[1] - pair[0]).collect();
    // Without holds the median is NaN, which `max` ignores.
    let held_s = median(&mut holds).max(clock.sample_time_s);
    let mut previous: Option<usize> = None;
    let mut last_fresh_s = f64::NEG_INFINITY;
    places.retain(|&k| {
        let time = clock.times[k];
        let has_changed = previous.is_none_or(|place| column.values[place] != column.values[k]);
        previous = Some(k);
        let is_fresh = has_changed || time - last_fresh_s >= held_s - 0.5 * clock.sample_time_s;
        if is_fresh {
            last_fresh_s = time;
        }
        is_fresh
    });
    held_s
}

/// Values of a channel at the stamps of the clock.
struct Column {
    signal: Signal,
    values: Vec<f64>,
}

impl Column {
    fn new(record: &FlightRecord, clock: &Clock, signal: Signal) -> Self {
        let samples = record.channel(&signal);
        Self {
            values: clock.rows.iter().map(|&row| samples[row]).collect(),
            signal,
        }
    }

    /// Returns, for each index, whether the value is finite and outside the frozen runs.
    fn valid_places(&self, frozen: &[Places]) -> Vec<bool> {
        let mut is_valid: Vec<bool> = self.values.iter().map(|value| value.is_finite()).collect();
        for run in frozen {
            is_valid[run.from..run.to].fill(false);
        }
        is_valid
    }

    /// Whether the channel changes in at least half the steps between two indices, both included.
    fn moves_between(&self, first: usize, last: usize) -> bool {
        let samples: Vec<f64> = self.values[first..=last]
            .iter()
            .copied()
            .filter(|value| value.is_finite())
            .collect();
        let changes = samples.windows(2).filter(|pair| pair[0] != pair[1]).count();
        samples.len() > 1 && 2 * changes >= samples.len() - 1
    }

    /// Whether another channel moves between two indices.
    fn others_move(&self, columns: &[Column], first: usize, last: usize) -> bool {
        columns
            .iter()
            .any(|other| other.signal != self.signal && other.moves_between(first, last))
    }

    /// Finds the runs in which the channel is frozen: it repeats the value before them.
    ///
    /// A run of exactly equal samples is frozen if it lasts more than 1 s, and more than five times
    /// as long as 95 % of the runs (which spares slow sensors), in a channel that moves at other
    /// times, and while another channel changes in at least half the steps. Only outputs can be
    /// frozen: a constant input is held. A coarse output often repeats its value, and an output
    /// that returns to its minimum or maximum is at its limit.
    fn frozen_runs(&self, clock: &Clock, columns: &[Column]) -> Vec<Places> {
        let places: Vec<usize> = (0..self.values.len())
            .filter(|&k| self.values[k].is_finite())
            .collect();
        let equal: Vec<&[usize]> = places
            .chunk_by(|&a, &b| self.values[a] == self.values[b])
            .collect();
        let samples: Vec<f64> = places.iter().map(|place| self.values[*place]).collect();
        if equal.len() < RUNS_OF_A_MOVING || is_coarse(&samples) {
            return Vec::new();
        }
        let range = Range::of_values(&samples);
        let mut lengths: Vec<f64> = equal.iter().map(|run| run.len() as f64).collect();
        let usual = quantile(&mut lengths, USUAL);
        let longest_s = FROZEN_S
            .max(UNUSUAL * usual * clock.sample_time_s)
            .max(clock.longest_step_s);
        let mut frozen = Vec::new();
        for run in &equal {
            let first = run[0];
            let last = run[run.len() - 1];
            let lasts = clock.times[last] - clock.times[first] > longest_s;
            if lasts
                && !self.is_limit(self.values[first], &range, &equal)
                && self.others_move(columns, first, last)
            {
                frozen.push(Places {
                    from: first + 1,
                    to: last + 1,
                });
            }
        }
        frozen
    }

    /// Whether a value is an end of the range, and several runs of equal samples have this value.
    fn is_limit(&self, value: f64, range: &Range, equal: &[&[usize]]) -> bool {
        if value != range.least && value != range.greatest {
            return false;
        }
        let stays = equal
            .iter()
            .filter(|run| run.len() >= RUN_AT_A_LIMIT && self.values[run[0]] == value)
            .count();
        stays > 1
    }
}

/// A run of invalid samples.
struct InvalidRun {
    places: Places,
    /// Whether some of the samples are frozen.
    is_frozen: bool,
}

/// Finds the runs of invalid samples.
fn invalid_runs(is_valid: &[bool], frozen: &[Places]) -> Vec<InvalidRun> {
    let mut runs = Vec::new();
    let mut from = 0;
    for run in is_valid.chunk_by(|a, b| a == b) {
        let to = from + run.len();
        if !run[0] {
            let before = frozen[..frozen.partition_point(|run| run.from < to)].last();
            runs.push(InvalidRun {
                places: Places { from, to },
                is_frozen: before.is_some_and(|run| from < run.to),
            });
        }
        from = to;
    }
    runs
}
