//! Finds rate limits: a channel often moves at one constant rate and never faster (M14.24).
//!
//! ```text
//! 1  s_k   slopes between consecutive samples;   moving: |s| > 2 % of the steepest
//! 2  R0    98 % quantile of the moving |s|; no limit with fewer than 50
//! 3  tau   0.5 %, or the step of the log divided by R0 dt if that is more
//! 4  R     mean of the moving |s| within tau of R0
//!    at R     within tau of R, in runs of at least 3 slopes of one sign
//!    limited  at least 3 runs; at least 5 % and less than 90 % of the moving slopes at R;
//!             at most 1 % above (1 + tau) R; at least 70 % of the slopes within 5 tau of R are
//!             within tau
//! 5  not limited: step 4 with 2 tau, then 4 tau; no limit where that exceeds 10 %
//! ```
//!
//! The last condition distinguishes a limit from the steepest part of a smooth signal: in a sine,
//! slopes within tau of the steepest are 1 / sqrt 5 times as frequent as those within 5 tau. From
//! 90 % at R on, the channel consists of ramps, as a designed test input may, and a limiter cannot
//! be recognised.

use gdcm_model::statistics::quantile;

use super::finite_samples::Sample;
use super::fresh_samples::FreshSamples;

/// Minimum slope at which a channel moves, relative to the steepest, or to the limit once it is
/// known.
const MOVING: f64 = 0.02;
/// The limit, if there is one, is this quantile of the moving slopes.
const STEEPEST: f64 = 0.98;
/// Relative tolerance for a slope at the limit.
const TOLERANCE: f64 = 0.005;
/// Multiples of the tolerance to try: the wider ones find a limit in a noisy log.
const MULTIPLES: [f64; 3] = [1.0, 2.0, 4.0];
/// Largest relative tolerance.
const COARSEST: f64 = 0.1;
/// Minimum number of consecutive slopes in a run at the limit.
const LEAST_RUN: usize = 3;
/// Minimum number of runs at the limit.
const LEAST_RUNS: usize = 3;
/// Minimum number of moving slopes in a record that is examined.
const LEAST_MOVING: usize = 50;
/// Minimum share of the moving slopes that must be at the limit.
const LEAST_SHARE: f64 = 0.05;
/// From this share at the limit on, the channel consists of ramps.
const RAMPS: f64 = 0.9;
/// Largest share of the moving slopes that may be above the limit.
const MOST_ABOVE: f64 = 0.01;
/// Ratio of the wider tolerance in the last condition (step 4) to the tolerance.
const WIDER: f64 = 5.0;
/// Minimum share of the slopes within the wider tolerance that must be within the tolerance.
const SHARP: f64 = 0.7;
/// Samples are consecutive up to this time difference, in sample times.
const CONSECUTIVE: f64 = 1.5;

/// A channel's rate limit in a record.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct RateLimit {
    /// In the channel's unit per second.
    pub(crate) rate: f64,
    /// Share of moving slopes at the limit.
    pub(crate) share: f64,
}

impl RateLimit {
    /// Finds the rate limit in a record's samples (steps 1 to 5); `None` if there is none.
    pub(crate) fn find(samples: Vec<Sample>) -> Option<Self> {
        // Step 1.
        let fresh = FreshSamples::new(samples);
        let slopes = slopes(&fresh);
        let steepest = slopes.iter().fold(0.0, |most: f64, s| most.max(s.abs()));
        let mut moving: Vec<f64> = slopes
            .iter()
            .map(|slope| slope.abs())
            .filter(|slope| *slope > MOVING * steepest)
            .collect();
        // Step 2.
        if moving.len() < LEAST_MOVING {
            return None;
        }
        let near = quantile(&mut moving, STEEPEST);
        // Step 3.
        let finest = TOLERANCE.max(fresh.log_step() / (near * fresh.sample_time_s));
        // Steps 4 and 5.
        for multiple in MULTIPLES {
            let tolerance = multiple * finest;
            if tolerance > COARSEST {
                break;
            }
            let rate = mean_near(&moving, near, tolerance);
            let counts = Counts::new(&slopes, rate, tolerance);
            if counts.is_limit() {
                return Some(Self {
                    rate,
                    share: counts.share(),
                });
            }
        }
        None
    }
}

/// Returns the slopes between consecutive samples; 0 across a gap.
fn slopes(fresh: &FreshSamples) -> Vec<f64> {
    let mut slopes = Vec::with_capacity(fresh.samples.len());
    for pair in fresh.samples.windows(2) {
        let elapsed_s = pair[1].time_s - pair[0].time_s;
        if elapsed_s > 0.0 && elapsed_s <= CONSECUTIVE * fresh.sample_time_s {
            slopes.push((pair[1].value - pair[0].value) / elapsed_s);
        } else {
            slopes.push(0.0);
        }
    }
    slopes
}

/// Averages the slopes that equal `near` within the tolerance; `near` if there are none.
fn mean_near(moving: &[f64], near: f64, tolerance: f64) -> f64 {
    let mut sum = 0.0;
    let mut count = 0;
    for slope in moving {
        if (slope - near).abs() <= tolerance * near {
            sum += slope;
            count += 1;
        }
    }
    if count > 0 {
        sum / f64::from(count)
    } else {
        near
    }
}

/// Counts slopes at, near and above a rate.
#[derive(Default)]
struct Counts {
    moving: usize,
    /// Slopes at the rate, in runs.
    at_rate: usize,
    /// Slopes at the rate, in runs or not.
    within_tolerance: usize,
    within_wider: usize,
    above: usize,
    runs: usize,
}

impl Counts {
    fn new(slopes: &[f64], rate: f64, tolerance: f64) -> Self {
        let mut counts = Self::default();
        for run in slopes.chunk_by(|a, b| {
            a.signum() == b.signum()
                && is_within(*a, rate, tolerance)
                && is_within(*b, rate, tolerance)
        }) {
            for slope in run {
                let size = slope.abs();
                if size > MOVING * rate {
                    counts.moving += 1;
                }
                if is_within(*slope, rate, tolerance) {
                    counts.within_tolerance += 1;
                }
                if is_within(*slope, rate, WIDER * tolerance) {
                    counts.within_wider += 1;
                }
                if size > (1.0 + tolerance) * rate {
                    counts.above += 1;
                }
            }
            if run.len() >= LEAST_RUN {
                counts.at_rate += run.len();
                counts.runs += 1;
            }
        }
        counts
    }

    /// Returns the share of moving slopes at the rate.
    fn share(&self) -> f64 {
        self.at_rate as f64 / self.moving.max(1) as f64
    }

    fn is_limit(&self) -> bool {
        let is_often = self.share() >= LEAST_SHARE && self.share() < RAMPS;
        let is_sharp = self.within_tolerance as f64 >= SHARP * self.within_wider as f64;
        let is_steepest = self.above as f64 <= MOST_ABOVE * self.moving as f64;
        self.runs >= LEAST_RUNS && is_often && is_sharp && is_steepest
    }
}

/// Returns whether a slope's modulus equals a rate within a relative tolerance.
fn is_within(slope: f64, rate: f64, tolerance: f64) -> bool {
    (slope.abs() - rate).abs() <= tolerance * rate
}
