//! Recognises stairs: a channel repeats its samples although it moves, because it is held or logged
//! more often than it changes (M14.1).
//!
//! ```text
//! run    consecutive samples that are exactly equal
//! moves  runs of which the next begins within 1 s; longer runs are rest
//! share  of equal consecutive samples: 1 - runs / samples, counted in the runs that move
//! stairs if there are at least 50 such samples and the share is over one half
//! ```

use gdcm_model::statistics::median;

use super::finite_samples::Sample;

/// A moving channel has stairs if consecutive samples are equal more often than this share (M14.1).
const STAIR_SHARE: f64 = 0.5;
/// Longest stair \[s\]; a channel with equal samples for longer is at rest.
const REST_S: f64 = 1.0;
/// Minimum number of moving samples for recognising stairs.
const LEAST_MOVING: usize = 50;

/// Stairs in a channel: equal consecutive samples although the channel moves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Stairs {
    /// Share of equal consecutive samples while the channel moves.
    pub(crate) share: f64,
    /// Median time between changes \[s\].
    pub(crate) hold_s: f64,
}

impl Stairs {
    /// Finds stairs in a channel over all its records; `None` if the channel has fewer than 50
    /// moving samples, or if at most half of them repeat the previous sample.
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
