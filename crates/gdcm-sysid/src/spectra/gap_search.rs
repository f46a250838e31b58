//! Finds a record's gaps: missing rows, stamps and samples, frozen outputs (M14.1).
//!
//! A gap lies between two stamps or, in a channel, between two valid samples. Gaps up to the length
//! that the settings allow are bridged by straight lines (`valid_samples`), others are cut out or,
//! if their samples can be estimated, filled (`preparation`). `preparation` then adds the parts
//! between gaps that are too short to be used.

use std::collections::BTreeMap;

use gdcm_model::simulation::Signal;

use super::gap::{Cause, Gap, Treatment};
use super::record_clock::{Clock, StampRange};
use super::valid_samples::ValidSamples;

/// Largest step between two stamps without a missing row, in sample times.
const LONGEST_STEP: f64 = 1.5;

/// Finds the gaps in the channels, then the gaps between the stamps.
pub(crate) fn record_gaps(clock: &Clock, channels: &[ValidSamples]) -> Vec<Gap> {
    let mut gaps = channel_gaps(clock, channels);
    gaps.extend(stamp_gaps(clock));
    gaps
}

/// A gap that channels share. Gaps are sorted by these fields, in this order.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct SharedGap {
    stamps: StampRange,
    is_frozen: bool,
    treatment: Treatment,
}

/// Returns the gaps in the channels; channels with the same gap share it.
fn channel_gaps(clock: &Clock, channels: &[ValidSamples]) -> Vec<Gap> {
    let mut signals_by_gap: BTreeMap<SharedGap, Vec<Signal>> = BTreeMap::new();
    for channel in channels {
        for run in &channel.invalid {
            let gap = SharedGap {
                stamps: run.stamps,
                is_frozen: run.is_frozen,
                treatment: treatment(channel, clock, run.stamps),
            };
            let signals = signals_by_gap.entry(gap).or_default();
            signals.push(channel.signal.clone());
        }
    }
    let mut gaps = Vec::new();
    for (gap, signals) in signals_by_gap {
        let interval = Interval::surrounding(gap.stamps, clock);
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
    gaps
}

/// Returns how a gap in a channel is treated; at an end of the record it is cut out.
fn treatment(channel: &ValidSamples, clock: &Clock, stamps: StampRange) -> Treatment {
    let interval = Interval::surrounding(stamps, clock);
    let is_inside = stamps.from > 0 && stamps.to < clock.times.len();
    Treatment::for_gap(is_inside && interval.end_s - interval.start_s <= channel.longest_step_s)
}

/// Start and end \[s\], relative to the record's first stamp.
struct Interval {
    start_s: f64,
    end_s: f64,
}

impl Interval {
    /// Returns the interval between the samples before and after `stamps`, or up to an end of the
    /// record.
    fn surrounding(stamps: StampRange, clock: &Clock) -> Self {
        Self {
            start_s: clock.times[stamps.from.saturating_sub(1)],
            end_s: clock.times[stamps.to.min(clock.times.len() - 1)],
        }
    }
}

/// Returns the gaps between the stamps: rows without a stamp, or a step above 1.5 sample times.
fn stamp_gaps(clock: &Clock) -> Vec<Gap> {
    let mut gaps = Vec::new();
    for k in 1..clock.times.len() {
        let step = clock.times[k] - clock.times[k - 1];
        let stamp_missing = clock.rows[k] > clock.rows[k - 1] + 1;
        if !stamp_missing && step <= LONGEST_STEP * clock.sample_time_s {
            continue;
        }
        gaps.push(Gap {
            start_s: clock.start_s + clock.times[k - 1],
            end_s: clock.start_s + clock.times[k],
            cause: if stamp_missing {
                Cause::StampsMissing
            } else {
                Cause::RowsMissing
            },
            treatment: Treatment::for_gap(step <= clock.longest_step_s),
        });
    }
    gaps
}
