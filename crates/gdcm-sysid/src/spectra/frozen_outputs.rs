//! Finds frozen outputs, which repeat a value although the aircraft moves (M14.1).
//!
//! ```text
//! run     consecutive finite samples of an output that are exactly equal
//! frozen  a run that lasts more than 1 s, more than five times as long as 95 % of the runs (which
//!         spares slow sensors) and more than a gap that is bridged, while another channel changes
//!         in at least half the steps
//! never   an output with fewer than 10 runs, which does not move at other times; a coarse output,
//!         which often repeats its value; a run at the minimum or maximum of the output, if several
//!         runs of at least 5 samples have this value: the output is at its limit there
//! ```
//!
//! Only outputs can be frozen: a constant input is held.

use gdcm_model::statistics::quantile;

use super::coarse_steps::is_coarse;
use super::finite_samples::Sample;
use super::record_clock::{Clock, StampRange, StampedValues};
use super::spikes::Spikes;
use super::value_range::ValueRange;

/// Shortest frozen run \[s\].
const FROZEN_S: f64 = 1.0;
/// Shortest frozen run, relative to the usual length of a run with equal samples.
const TIMES_USUAL: f64 = 5.0;
/// The usual length is this quantile over all runs with equal samples.
const USUAL_QUANTILE: f64 = 0.95;
/// An output can be frozen only if it has at least this many runs with equal samples: with fewer,
/// it never moves.
const MOVING_RUNS: usize = 10;
/// Minimum number of equal samples in a run at an output's minimum or maximum; two such runs mean
/// that the output is at its limit there.
const LIMIT_RUN: usize = 5;

/// Finds the runs in which an output is frozen: it repeats the value before them. `channels` are
/// all channels in the record, the output among them.
pub(crate) fn frozen_runs(
    output: &StampedValues,
    channels: &[StampedValues],
    clock: &Clock,
) -> Vec<StampRange> {
    let values = &output.values;
    let places: Vec<usize> = (0..values.len())
        .filter(|&k| values[k].is_finite())
        .collect();
    let runs: Vec<&[usize]> = places.chunk_by(|&a, &b| values[a] == values[b]).collect();
    let samples: Vec<f64> = places.iter().map(|place| values[*place]).collect();
    if runs.len() < MOVING_RUNS || is_coarse(&samples) {
        return Vec::new();
    }
    let range = range_without_spikes(output, &places, clock);
    let longest_s = longest_usual_s(&runs, clock);
    let mut frozen = Vec::new();
    for run in &runs {
        let first = run[0];
        let last = run[run.len() - 1];
        let lasts = clock.times[last] - clock.times[first] > longest_s;
        if lasts
            && !is_limit(values, first, &range, &runs)
            && others_move(output, channels, first, last)
        {
            // The run's first sample is valid: the output froze after it.
            frozen.push(StampRange {
                from: first + 1,
                to: last + 1,
            });
        }
    }
    frozen
}

/// Returns an output's value range without spikes: a spike beyond a limit must not make the samples
/// at the limit look frozen.
fn range_without_spikes(output: &StampedValues, places: &[usize], clock: &Clock) -> ValueRange {
    let mut samples = Vec::with_capacity(places.len());
    for &place in places {
        samples.push(Sample {
            time_s: clock.times[place],
            value: output.values[place],
        });
    }
    if let Some(spikes) = Spikes::find(samples.clone()) {
        samples.retain(|sample| !spikes.contain(sample.time_s));
    }
    let values: Vec<f64> = samples.iter().map(|sample| sample.value).collect();
    ValueRange::new(&values)
}

/// Returns the longest duration \[s\] for which a run is not frozen.
fn longest_usual_s(runs: &[&[usize]], clock: &Clock) -> f64 {
    let mut lengths: Vec<f64> = runs.iter().map(|run| run.len() as f64).collect();
    let usual = quantile(&mut lengths, USUAL_QUANTILE);
    FROZEN_S
        .max(TIMES_USUAL * usual * clock.sample_time_s)
        .max(clock.longest_step_s)
}

/// Returns whether the value at index `at` is an end of the range, and several long runs have this
/// value.
fn is_limit(values: &[f64], at: usize, range: &ValueRange, runs: &[&[usize]]) -> bool {
    let value = values[at];
    if value != range.least && value != range.greatest {
        return false;
    }
    let stays = runs
        .iter()
        .filter(|run| run.len() >= LIMIT_RUN && values[run[0]] == value)
        .count();
    stays > 1
}

/// Returns whether another channel moves between two indices.
fn others_move(
    output: &StampedValues,
    channels: &[StampedValues],
    first: usize,
    last: usize,
) -> bool {
    channels
        .iter()
        .any(|other| other.signal != output.signal && moves(&other.values[first..=last]))
}

/// Returns whether a channel changes in at least half the steps between its finite values.
fn moves(values: &[f64]) -> bool {
    let samples: Vec<f64> = values
        .iter()
        .copied()
        .filter(|value| value.is_finite())
        .collect();
    let changes = samples.windows(2).filter(|pair| pair[0] != pair[1]).count();
    samples.len() > 1 && 2 * changes >= samples.len() - 1
}
