//! Finds rate limits: a channel often moves at one constant rate and never faster (M14.24).
//!
//! ```text
//! 1  s_k   slopes between consecutive samples;   moving: |s| > 2 % of the steepest
//! 2  R0    98 % quantile of the moving |s|; no limit with fewer than 50
//! 3  tau   0.5 %, or the logging step over R0 dt if that is more; dt sample time
//! 4  R     mean of the moving |s| within tau of R0
//!    at R     within tau of R, in runs of at least 3 slopes of one sign
//!    limited  a  at least 3 runs
//!             b  at least 5 % and less than 90 % of the moving slopes at R
//!             c  at most 1 % above (1 + tau) R
//!             d  at least 70 % of the slopes within 5 tau of R are within tau
//! 5  not limited: step 4 with 2 tau, then 4 tau; no limit where that exceeds 10 %
//! ```
//!
//! Condition d distinguishes a limit from the steepest part of a smooth signal: in a sine, slopes
//! within tau of the steepest are 1 / sqrt 5 times (45 %) as frequent as those within 5 tau. From
//! 90 % at R on (b), the channel consists of ramps, as a designed test input may, and a limiter
//! cannot be recognised. The numbers are a compromise between limits missed and limits reported in
//! free motion; both rates are measured in M14.24 of `docs/identification.md`.

use gdcm_model::statistics::quantile;

use super::finite_samples::Sample;
use super::fresh_samples::FreshSamples;

/// Minimum slope at which a channel moves, relative to the steepest (step 1), or to R (step 4).
const MOVING_SHARE: f64 = 0.02;
/// Quantile of the moving slopes for R0: a few steeper slopes do not hide a limit.
const STEEP_QUANTILE: f64 = 0.98;
/// Smallest tau: relative tolerance for a slope at the limit.
const LEAST_TOLERANCE: f64 = 0.005;
/// Multiples of tau to try (step 5): the wider ones find a limit in a noisy log.
const TOLERANCE_MULTIPLES: [f64; 3] = [1.0, 2.0, 4.0];
/// Largest tolerance to try.
const MOST_TOLERANCE: f64 = 0.1;
/// Minimum number of consecutive slopes in a run at the limit.
const LEAST_RUN: usize = 3;
/// Minimum number of runs at the limit (condition a).
const LEAST_RUNS: usize = 3;
/// Minimum number of moving slopes in a record that is examined: fewer have no 98 % quantile.
const LEAST_MOVING: usize = 50;
/// Minimum share of the moving slopes that must be at the limit (condition b).
const LEAST_SHARE: f64 = 0.05;
/// From this share at the limit on, the channel consists of ramps (condition b).
const RAMPS_SHARE: f64 = 0.9;
/// Largest share of the moving slopes that may be above the limit (condition c).
const MOST_ABOVE: f64 = 0.01;
/// Ratio of the wider tolerance to the tolerance (condition d).
const WIDER: f64 = 5.0;
/// Minimum share of the slopes within the wider tolerance that must be within the tolerance
/// (condition d).
const SHARP_SHARE: f64 = 0.7;
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
            .filter(|slope| *slope > MOVING_SHARE * steepest)
            .collect();
        // Step 2.
        if moving.len() < LEAST_MOVING {
            return None;
        }
        let steep = quantile(&mut moving, STEEP_QUANTILE);
        // Step 3.
        let rounding = fresh.log_step() / (steep * fresh.sample_time_s);
        let least_tolerance = LEAST_TOLERANCE.max(rounding);
        // Steps 4 and 5.
        for multiple in TOLERANCE_MULTIPLES {
            let tolerance = multiple * least_tolerance;
            if tolerance > MOST_TOLERANCE {
                break;
            }
            let rate = mean_within(&moving, steep, tolerance);
            let counts = SlopeCounts::new(&slopes, rate, tolerance);
            if counts.show_limit() {
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

/// Averages the slopes that equal `steep` within the relative tolerance (`R` in step 4); `steep` if
/// there are none.
fn mean_within(moving: &[f64], steep: f64, tolerance: f64) -> f64 {
    let mut sum = 0.0;
    let mut count = 0;
    for slope in moving {
        if is_within(*slope, steep, tolerance) {
            sum += slope;
            count += 1;
        }
    }
    if count > 0 {
        sum / f64::from(count)
    } else {
        steep
    }
}

/// Slopes counted relative to a rate R that may be the limit.
#[derive(Default)]
struct SlopeCounts {
    moving: usize,
    /// Slopes within the tolerance of R, in runs or not.
    within_tolerance: usize,
    within_wider_tolerance: usize,
    /// Slopes above R by more than the tolerance.
    above: usize,
    /// Runs of at least three slopes of one sign within the tolerance.
    runs: usize,
    /// Slopes in these runs.
    in_runs: usize,
}

impl SlopeCounts {
    fn new(slopes: &[f64], rate: f64, tolerance: f64) -> Self {
        let mut counts = Self::default();
        for run in slopes.chunk_by(|a, b| {
            a.signum() == b.signum()
                && is_within(*a, rate, tolerance)
                && is_within(*b, rate, tolerance)
        }) {
            for slope in run {
                let size = slope.abs();
                if size > MOVING_SHARE * rate {
                    counts.moving += 1;
                }
                if is_within(*slope, rate, tolerance) {
                    counts.within_tolerance += 1;
                }
                if is_within(*slope, rate, WIDER * tolerance) {
                    counts.within_wider_tolerance += 1;
                }
                if size > (1.0 + tolerance) * rate {
                    counts.above += 1;
                }
            }
            if run.len() >= LEAST_RUN {
                counts.in_runs += run.len();
                counts.runs += 1;
            }
        }
        counts
    }

    /// Returns the share of moving slopes at R, in runs.
    fn share(&self) -> f64 {
        self.in_runs as f64 / self.moving.max(1) as f64
    }

    /// Returns whether R is the limit (conditions a to d).
    fn show_limit(&self) -> bool {
        let is_reached_again = self.runs >= LEAST_RUNS;
        let is_reached_often = self.share() >= LEAST_SHARE && self.share() < RAMPS_SHARE;
        let is_never_exceeded = self.above as f64 <= MOST_ABOVE * self.moving as f64;
        let is_sharp =
            self.within_tolerance as f64 >= SHARP_SHARE * self.within_wider_tolerance as f64;
        is_reached_again && is_reached_often && is_never_exceeded && is_sharp
    }
}

/// Returns whether a slope's modulus equals a rate within a relative tolerance.
fn is_within(slope: f64, rate: f64, tolerance: f64) -> bool {
    (slope.abs() - rate).abs() <= tolerance * rate
}
