//! The time stamps of a record.

use std::collections::BTreeMap;

use gdcm_model::dataset::channel::ChannelSide;
use gdcm_model::response::curve_values::quantile;
use gdcm_model::response::median;
use gdcm_model::simulation::{FlightRecord, Signal};

use super::gaps::{Cause, Gap, Treatment};
use super::preparation::{ChannelPreparation, Hold, Preparation, PreparationError};
use super::record_cautions::is_coarse;

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
        let rows: Vec<usize> = (0..record.time_s.len())
            .filter(|&row| record.time_s[row].is_finite())
            .collect();
        let start_s = rows.first().map_or(0.0, |&row| record.time_s[row]);
        let times: Vec<f64> = rows
            .iter()
            .map(|&row| record.time_s[row] - start_s)
            .collect();
        for (pair, place) in rows.windows(2).zip(0..) {
            // Counted from the first stamp: huge stamps may differ, and yet not when they are counted so.
            let step = times[place + 1] - times[place];
            if !(step > 0.0 && step.is_finite()) {
                let previous_s = record.time_s[pair[0]];
                let time_s = record.time_s[pair[1]];
                let record = record.name.clone();
                return Err(PreparationError::TimeNotIncreasing {
                    record,
                    row: pair[1],
                    previous_s,
                    time_s,
                });
            }
        }
        let steps: Vec<f64> = times.windows(2).map(|pair| pair[1] - pair[0]).collect();
        // A record of one stamp has no steps.
        let of_steps = |mut values: Vec<f64>, q: f64| {
            if values.is_empty() {
                0.0
            } else {
                quantile(&mut values, q)
            }
        };
        let sample_time_s = of_steps(steps.clone(), 0.5);
        let off =
            |step: &f64| (step / sample_time_s - (step / sample_time_s).round().max(1.0)).abs();
        let jitter_percent = 100.0 * of_steps(steps.iter().map(off).collect(), COUNTED);
        let longest_step_s = (longest_bridge as f64 + 1.5) * sample_time_s;
        Ok(Self {
            start_s,
            sample_time_s,
            jitter_percent,
            rows,
            times,
            longest_step_s,
        })
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
            let cause = if stamp_missing {
                Cause::StampsMissing
            } else {
                Cause::RowsMissing
            };
            (stamp_missing || step > 1.5 * self.sample_time_s).then(|| Gap {
                start_s: self.start_s + self.times[k - 1],
                end_s: self.start_s + self.times[k],
                cause,
                treatment: Treatment::of(step <= self.longest_step_s),
            })
        })
    }
}

// The samples of one channel that count, and the straight lines between them.

/// An output that does not change for less than this is not frozen \[s\].
const FROZEN_S: f64 = 1.0;
/// An output is frozen when it does not change for this many times as long as it usually does.
const UNUSUAL: f64 = 5.0;
/// What is usual: this share of the runs of equal samples are shorter.
const USUAL: f64 = 0.95;
/// An output that has fewer runs of equal samples than this was not seen to move.
const RUNS_OF_A_MOVING: usize = 10;
/// Equal samples at the least or the greatest value that are a run at a limit.
const RUN_AT_A_LIMIT: usize = 5;
/// Stamps that lie this share of a sample time beyond the last sample are at it, but for rounding.
const ROUNDING: f64 = 1e-6;

/// The samples of one channel that count, on the record's clock counted from its first stamp.
pub(super) struct Track {
    times: Vec<f64>,
    values: Vec<f64>,
    /// How much later than its own time a sample is logged \[s\].
    shift_s: f64,
    /// Two samples further apart than this \[s\] have a gap between them that is not bridged.
    longest_step_s: f64,
    rounding_s: f64,
}

impl Track {
    /// The tracks of all channels of `record`, inputs first, and the gaps in them; channels with the same gap share it.
    pub fn all(
        record: &FlightRecord,
        clock: &Clock,
        preparation: &Preparation,
    ) -> (Vec<Self>, Vec<Gap>) {
        let mut found: BTreeMap<(usize, usize, bool, Treatment), Vec<Signal>> = BTreeMap::new();
        let columns: Vec<Column> = preparation
            .channels()
            .map(|(signal, _)| Column::of(record, clock, signal))
            .collect();
        let mut tracks = Vec::new();
        for ((signal, channel), column) in preparation.channels().zip(&columns) {
            let moves = |from, to| {
                columns
                    .iter()
                    .any(|other| other.signal != signal && other.moves_between(from, to))
            };
            let frozen = match signal.role {
                ChannelSide::Output if !preparation.keep_frozen => column.frozen(clock, &moves),
                ChannelSide::Output | ChannelSide::Input => Vec::new(),
            };
            let counts = column.counting(&frozen);
            let track = Self::of(column, &counts, clock, channel);
            for (from, to, is_frozen) in column.gaps(&counts, &frozen) {
                let treatment = track.treatment(clock, from, to);
                found
                    .entry((from, to, is_frozen, treatment))
                    .or_default()
                    .push(signal.clone());
            }
            tracks.push(track);
        }
        let named = |((from, to, is_frozen, treatment), signals)| {
            let (start, end) = around(clock, from, to);
            let cause = if is_frozen {
                Cause::Frozen(signals)
            } else {
                Cause::SamplesMissing(signals)
            };
            Gap {
                start_s: clock.start_s + start,
                end_s: clock.start_s + end,
                cause,
                treatment,
            }
        };
        (tracks, found.into_iter().map(named).collect())
    }

    /// The samples of `column` at the places that count.
    fn of(column: &Column, counts: &[bool], clock: &Clock, channel: &ChannelPreparation) -> Self {
        let mut places: Vec<usize> = (0..counts.len()).filter(|&k| counts[k]).collect();
        let mut longest_step_s = clock.longest_step_s;
        if channel.hold == Hold::FreshSamples {
            let held_s = fresh(column, clock, &mut places);
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

    /// What becomes of a gap at the places `from..to` of the clock.
    fn treatment(&self, clock: &Clock, from: usize, to: usize) -> Treatment {
        let (start, end) = around(clock, from, to);
        Treatment::of(from > 0 && to < clock.times.len() && end - start <= self.longest_step_s)
    }

    /// Reads the track at times that increase.
    pub fn reader(&self) -> Reader<'_> {
        Reader {
            track: self,
            next: 0,
        }
    }
}

/// Times of the samples before and after the places `from..to`, or of the first and the last of them at an end.
fn around(clock: &Clock, from: usize, to: usize) -> (f64, f64) {
    (
        clock.times[from.saturating_sub(1)],
        clock.times[to.min(clock.times.len() - 1)],
    )
}

/// Reads a track at times that increase.
pub(super) struct Reader<'a> {
    track: &'a Track,
    /// The first sample after the time read last.
    next: usize,
}

impl Reader<'_> {
    /// The channel at `t` \[s\]; none in a gap and beyond the ends.
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
            return (t - time <= self.track.rounding_s).then_some(value);
        };
        if t == time {
            return Some(value);
        }
        let share = (t - time) / (after - time);
        (after - time <= self.track.longest_step_s)
            .then(|| value + share * (values[self.next] - value))
    }
}

/// Leaves in `places` those with a fresh sample of a slow sensor, and returns its sample time \[s\].
///
/// A sample is fresh when it differs from the one before it, and when the sensor's sample time (the median between two that
/// differ) has passed since the last fresh one: equal readings are readings.
fn fresh(column: &Column, clock: &Clock, places: &mut Vec<usize>) -> f64 {
    let differs = |pair: &[usize]| column.values[pair[0]] != column.values[pair[1]];
    let changes: Vec<f64> = places
        .windows(2)
        .filter(|pair| differs(pair))
        .map(|pair| clock.times[pair[1]])
        .collect();
    let mut holds: Vec<f64> = changes.windows(2).map(|pair| pair[1] - pair[0]).collect();
    // The median of no holds is not a number, and the greater of the two the other one.
    let held_s = median(&mut holds).max(clock.sample_time_s);
    let mut previous: Option<usize> = None;
    let mut last_s = f64::NEG_INFINITY;
    places.retain(|&k| {
        let time = clock.times[k];
        let changed = previous.is_none_or(|place| column.values[place] != column.values[k]);
        previous = Some(k);
        let is_fresh = changed || time - last_s >= held_s - 0.5 * clock.sample_time_s;
        if is_fresh {
            last_s = time;
        }
        is_fresh
    });
    held_s
}

/// One channel at the stamps of the clock.
struct Column {
    signal: Signal,
    values: Vec<f64>,
}

impl Column {
    fn of(record: &FlightRecord, clock: &Clock, signal: Signal) -> Self {
        let samples = record.channel(&signal);
        Self {
            values: clock.rows.iter().map(|&row| samples[row]).collect(),
            signal,
        }
    }

    /// Which places count: a finite value outside the frozen runs.
    fn counting(&self, frozen: &[(usize, usize)]) -> Vec<bool> {
        let mut counts: Vec<bool> = self.values.iter().map(|value| value.is_finite()).collect();
        for &(from, to) in frozen {
            counts[from..to].fill(false);
        }
        counts
    }

    /// Whether it changes at half the steps between the places `from` and `to`, or more.
    fn moves_between(&self, from: usize, to: usize) -> bool {
        let samples: Vec<f64> = self.values[from..=to]
            .iter()
            .copied()
            .filter(|value| value.is_finite())
            .collect();
        let changes = samples.windows(2).filter(|pair| pair[0] != pair[1]).count();
        samples.len() > 1 && 2 * changes >= samples.len() - 1
    }

    /// Runs of places `from..to` where the channel is frozen: it repeats the value before them.
    ///
    /// Frozen are more than 1 s of exactly equal samples, and more than five times the run of equal samples that 95 % of its
    /// runs do not reach (so that a slow sensor is not frozen), in a channel that moves at other times and while
    /// another channel changes at every second sample or more often. Only outputs freeze: an input that does not change is
    /// held. A coarse output stands still by itself, and one that comes back to its least or greatest value is at its limit.
    fn frozen(
        &self,
        clock: &Clock,
        others_move: &dyn Fn(usize, usize) -> bool,
    ) -> Vec<(usize, usize)> {
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
        let (least, greatest) = samples
            .iter()
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(least, most), x| {
                (least.min(*x), most.max(*x))
            });
        let stands_at = |value: f64| {
            equal
                .iter()
                .filter(|run| run.len() >= RUN_AT_A_LIMIT && self.values[run[0]] == value)
                .count()
        };
        let is_limit = |value: f64| (value == least || value == greatest) && stands_at(value) > 1;
        let usual = quantile(
            &mut equal
                .iter()
                .map(|run| run.len() as f64)
                .collect::<Vec<f64>>(),
            USUAL,
        );
        let longest_s = FROZEN_S
            .max(UNUSUAL * usual * clock.sample_time_s)
            .max(clock.longest_step_s);
        let frozen = |run: &&[usize]| {
            let first = run[0];
            let last = run[run.len() - 1];
            let stands =
                clock.times[last] - clock.times[first] > longest_s && !is_limit(self.values[first]);
            (stands && others_move(first, last)).then_some((first + 1, last + 1))
        };
        equal.iter().filter_map(frozen).collect()
    }

    /// Runs of places `from..to` that do not count, and whether the channel is frozen there.
    fn gaps(&self, counts: &[bool], frozen: &[(usize, usize)]) -> Vec<(usize, usize, bool)> {
        let mut gaps = Vec::new();
        let mut from = 0;
        for run in counts.chunk_by(|a, b| a == b) {
            let to = from + run.len();
            if !run[0] {
                let before = frozen
                    .partition_point(|&(first, _)| first < to)
                    .checked_sub(1);
                gaps.push((from, to, before.is_some_and(|k| from < frozen[k].1)));
            }
            from = to;
        }
        gaps
    }
}
