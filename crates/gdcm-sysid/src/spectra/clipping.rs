//! Recognises channels that are often at their limit, such as a saturated sensor or actuator
//! (M14.18).
//!
//! ```text
//! run           consecutive samples with steps |dx| <= 1e-3 mean |dx|; or a single sample
//! flat          a run of two samples or more
//! at an end     a run whose mean lies in the outer 5 % of the range
//! 1  usual      90 % quantile of the lengths of flat runs elsewhere
//! 2  share      of the samples in runs at an end, of at least max(5, 3 usual) samples
//! 3  excessive  above 0.5 %; above 10 % only, if flat runs elsewhere hold over 20 % of all samples
//! ```

use gdcm_model::statistics::quantile;

use super::value_range::ValueRange;

/// Largest step inside a flat run, relative to the mean step (all limits: M14.18).
const FLAT_STEP: f64 = 1e-3;
/// Shortest run at a limit, in samples.
const SHORTEST_RUN: f64 = 5.0;
/// Shortest run at a limit, relative to the usual length of flat runs elsewhere.
const SHORTEST_RUN_OVER_USUAL: f64 = 3.0;
/// The usual length is this quantile over the flat runs elsewhere.
const USUAL_QUANTILE: f64 = 0.9;
/// Share of the range, at each end, that counts as a limit.
const OUTER_SHARE: f64 = 0.05;
/// Largest acceptable share of samples at a limit in a smooth channel.
const MOST_AT_LIMIT: f64 = 0.005;
/// Largest acceptable share of samples at a limit in a held channel ([`HELD_SHARE`]), such as a
/// coarsely quantised one.
const MOST_AT_LIMIT_HELD: f64 = 0.1;
/// A channel counts as held if flat runs away from the limits hold more than this share of its
/// samples.
const HELD_SHARE: f64 = 0.2;

/// How often a channel is at its limit, and how often it may be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Clipping {
    /// Share of the samples that are at a limit.
    pub(crate) share: f64,
    /// Largest share that is not excessive.
    pub(crate) most: f64,
}

impl Clipping {
    /// Measures the share of samples at a limit (steps 1 to 3).
    pub(crate) fn measure(samples: &[f64]) -> Self {
        let steps = samples.windows(2).map(|pair| (pair[1] - pair[0]).abs());
        let flat_step =
            FLAT_STEP * steps.sum::<f64>() / samples.len().saturating_sub(1).max(1) as f64;
        let range = ValueRange::new(samples);
        let outer = OUTER_SHARE * (range.greatest - range.least);
        let mut at_ends = Vec::new();
        let mut elsewhere = Vec::new();
        for run in samples.chunk_by(|a, b| (b - a).abs() <= flat_step) {
            let mean = run.iter().sum::<f64>() / run.len() as f64;
            if mean >= range.greatest - outer || mean <= range.least + outer {
                at_ends.push(run.len());
            } else {
                elsewhere.push(run.len());
            }
        }
        let flat_elsewhere: Vec<usize> =
            elsewhere.into_iter().filter(|length| *length > 1).collect();
        // Step 1, then steps 2 and 3.
        let shortest = SHORTEST_RUN.max(SHORTEST_RUN_OVER_USUAL * usual_length(&flat_elsewhere));
        let at_limit: usize = at_ends
            .into_iter()
            .filter(|length| *length as f64 >= shortest)
            .sum();
        let flat_share_elsewhere = share_of(flat_elsewhere.iter().sum(), samples);
        Self {
            share: share_of(at_limit, samples),
            most: if flat_share_elsewhere > HELD_SHARE {
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

/// Returns the usual length (step 1) in samples; 1 without runs.
fn usual_length(runs: &[usize]) -> f64 {
    if runs.is_empty() {
        return 1.0;
    }
    let mut lengths: Vec<f64> = runs.iter().map(|length| *length as f64).collect();
    quantile(&mut lengths, USUAL_QUANTILE)
}

fn share_of(count: usize, samples: &[f64]) -> f64 {
    count as f64 / samples.len().max(1) as f64
}
