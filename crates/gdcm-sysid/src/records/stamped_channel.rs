//! A channel with its own stamps: its gaps, and its low-passed value at any time (M14.11).
//!
//! In a log, channels with the same stamps form a topic; each is resampled by itself.

use std::f64::consts::PI;
use std::ops::Range;

use gdcm_model::statistics::median;

use super::resampling_error::ResamplingError;

/// Longest step without a gap, in median steps: 3 missing samples are bridged (M14.1).
const LONGEST_STEP: f64 = 4.5;
/// A channel counts as held if more than this share of its samples repeat the preceding sample.
const HELD: f64 = 0.5;
/// Minimum number of samples in a channel.
const LEAST_SAMPLES: usize = 3;
/// The kernel's half-length, in half periods at its cut-off.
const HALF_TAPS: f64 = 12.0;
/// Argument \[rad\] below which sin(x)/x is 1 to rounding.
const SMALL_ANGLE: f64 = 1e-8;
/// Tolerance for times just outside a run's stamps, relative to the time.
const ROUNDING: f64 = 1e-9;

/// A channel's samples with their own stamps.
#[derive(Clone, Debug, PartialEq)]
pub struct StampedChannel {
    /// Name for display.
    pub name: String,
    /// Stamps \[s\], increasing and finite.
    time_s: Vec<f64>,
    /// Value at each stamp, finite.
    values: Vec<f64>,
    /// Index ranges without gaps; never empty.
    runs: Vec<Range<usize>>,
    /// Mean sample rate outside gaps \[Hz\]; 0 if every run has a single sample.
    pub rate_hz: f64,
}

impl StampedChannel {
    /// Creates a channel from the samples that have increasing stamps and finite values, in runs
    /// between gaps of more than 4.5 median steps.
    ///
    /// A held command acts until the next sample: its stamps are moved later by half this time
    /// (M14.1).
    ///
    /// # Errors
    /// [`ResamplingError::TooFew`] for fewer than three samples.
    pub fn new(
        name: &str,
        time_s: &[f64],
        values: &[f64],
        is_held: bool,
    ) -> Result<Self, ResamplingError> {
        let mut times: Vec<f64> = Vec::new();
        let mut kept: Vec<f64> = Vec::new();
        for (&time, &value) in time_s.iter().zip(values) {
            let increases = times.last().is_none_or(|last| time > *last);
            if time.is_finite() && value.is_finite() && increases {
                times.push(time);
                kept.push(value);
            }
        }
        if times.len() < LEAST_SAMPLES {
            return Err(ResamplingError::TooFew {
                topic: name.to_owned(),
                samples: times.len(),
            });
        }
        let mut steps: Vec<f64> = times.windows(2).map(|pair| pair[1] - pair[0]).collect();
        let longest_s = LONGEST_STEP * median(&mut steps);
        if is_held {
            delay_by_half_a_hold(&mut times, longest_s);
        }
        let runs = runs(&times, longest_s);
        Ok(Self {
            name: name.to_owned(),
            rate_hz: rate_hz(&times, &runs),
            time_s: times,
            values: kept,
            runs,
        })
    }

    /// Returns the first and the last stamp \[s\].
    pub fn span_s(&self) -> [f64; 2] {
        [
            self.time_s.first().copied().unwrap_or(0.0),
            self.time_s.last().copied().unwrap_or(0.0),
        ]
    }

    /// Returns the low-passed values at increasing times; NaN in gaps and beyond the ends. `cutoff`
    /// is in rad/s.
    pub fn at(&self, times_s: &[f64], cutoff: f64) -> Vec<f64> {
        let mut values = Vec::with_capacity(times_s.len());
        let mut next_run = 0;
        for &t in times_s {
            while self
                .runs
                .get(next_run)
                .is_some_and(|run| t - self.time_s[run.end - 1] > ROUNDING * t.abs())
            {
                next_run += 1;
            }
            let value = match self.runs.get(next_run) {
                Some(run) if t >= self.time_s[run.start] - ROUNDING * t.abs() => low_passed(
                    &self.time_s[run.clone()],
                    &self.values[run.clone()],
                    t,
                    cutoff,
                ),
                _ => f64::NAN,
            };
            values.push(value);
        }
        values
    }
}

/// Moves each stamp later by half its hold, which lasts until the next stamp, at most `longest_s`;
/// the last hold is assumed to last as long as the one before.
fn delay_by_half_a_hold(times: &mut [f64], longest_s: f64) {
    let mut hold_s = 0.0;
    // From front to back, because each stamp needs the next one unchanged.
    for k in 0..times.len() - 1 {
        hold_s = (times[k + 1] - times[k]).min(longest_s);
        times[k] += 0.5 * hold_s;
    }
    if let Some(last) = times.last_mut() {
        *last += 0.5 * hold_s;
    }
}

/// Returns the index ranges between gaps longer than `longest_s`.
fn runs(times: &[f64], longest_s: f64) -> Vec<Range<usize>> {
    let mut runs = Vec::new();
    let mut start = 0;
    for k in 1..times.len() {
        if times[k] - times[k - 1] > longest_s {
            runs.push(start..k);
            start = k;
        }
    }
    runs.push(start..times.len());
    runs
}

/// Computes the mean sample rate \[Hz\], without gaps; 0 if every run has a single sample.
fn rate_hz(times: &[f64], runs: &[Range<usize>]) -> f64 {
    let mut steps = 0;
    let mut length_s = 0.0;
    for run in runs {
        steps += run.len() - 1;
        length_s = length_s + times[run.end - 1] - times[run.start];
    }
    if length_s > 0.0 {
        steps as f64 / length_s
    } else {
        0.0
    }
}

/// Returns whether a command is held: more than half its samples repeat the preceding sample.
pub fn is_held(values: &[f64]) -> bool {
    let same = values.windows(2).filter(|pair| pair[0] == pair[1]).count();
    same as f64 > HELD * values.len() as f64
}

/// Filters and interpolates at time `t` \[s\] in a single step (M14.11).
///
/// ```text
/// x(t) = Σ w_k v_k / Σ w_k
/// w_k  = Δ_k sinc(wc (t − t_k)/π) · ½ (1 + cos(π (t − t_k)/h)),    |t − t_k| < h = 12 π/wc
/// Δ_k  = half the distance between the neighbours of t_k; at an end, the distance to its neighbour
/// ```
///
/// `v_k` are the values at the stamps `t_k`. Constants do not change, nor does a sample without a
/// neighbour in the kernel. NaN if the weights have no positive sum. Stamps increase; `cutoff` is
/// wc \[rad/s\].
fn low_passed(time_s: &[f64], values: &[f64], t: f64, cutoff: f64) -> f64 {
    let half = HALF_TAPS * PI / cutoff;
    let from = time_s.partition_point(|time| *time <= t - half);
    let to = time_s.partition_point(|time| *time < t + half);
    let mut sum = 0.0;
    let mut weights = 0.0;
    for k in from..to {
        let x = cutoff * (t - time_s[k]);
        let y = PI * (t - time_s[k]) / half;
        let sinc = if x.abs() < SMALL_ANGLE {
            1.0
        } else {
            x.sin() / x
        };
        let weight = sample_width(time_s, k) * sinc * 0.5 * (1.0 + y.cos());
        sum += weight * values[k];
        weights += weight;
    }
    if weights > 0.0 {
        sum / weights
    } else {
        f64::NAN
    }
}

/// Returns `Δ_k` \[s\], the duration that sample `k` represents; 1 for a single sample.
fn sample_width(time_s: &[f64], k: usize) -> f64 {
    let last = time_s.len() - 1;
    if last == 0 {
        1.0
    } else if k == 0 {
        time_s[1] - time_s[0]
    } else if k == last {
        time_s[last] - time_s[last - 1]
    } else {
        0.5 * (time_s[k + 1] - time_s[k - 1])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::identification::known_answers_tests::{number, numbers};

    /// Returns the stamps `step k` with jitter from the linear congruential generator that the
    /// reference data used.
    fn shaken(count: usize, step: f64, shake: f64) -> Vec<f64> {
        let mut state = 5_u32;
        let mut stamps = Vec::with_capacity(count);
        for k in 0..count {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            let uniform = f64::from(state) / 2_f64.powi(32);
            stamps.push(step * k as f64 + shake * (uniform - 0.5));
        }
        stamps
    }

    fn signal(t: f64) -> f64 {
        (7.0 * t).sin() + 0.5 * (2.3 * t).cos()
    }

    #[test]
    fn the_known_answer_is_met_to_rounding() {
        let answer: serde_json::Value = serde_json::from_str(include_str!(
            "../../../../tests/data/resampling-known-answer.json"
        ))
        .unwrap();
        let stamps = shaken(1500, 0.004, 0.0008);
        let values: Vec<f64> = stamps.iter().map(|t| signal(*t)).collect();
        let topic = StampedChannel::new("v", &stamps, &values, false).unwrap();
        assert!((topic.rate_hz - 250.0).abs() < 0.1);
        let asked: Vec<f64> = (0..100).map(|k| 2.0 + 0.02 * f64::from(k)).collect();
        let found = topic.at(&asked, number(&answer["wc"]));
        let expected = numbers(&answer["expected"]);
        let worst = found
            .iter()
            .zip(&expected)
            .map(|(a, b)| (a - b).abs())
            .fold(0.0, f64::max);
        assert!(worst < number(&answer["tolerance"]), "{worst}");
    }

    #[test]
    fn a_constant_stays_and_a_gap_stays_a_gap() {
        let stamps: Vec<f64> = shaken(400, 0.01, 0.002)
            .into_iter()
            .filter(|t| !(1.0..2.0).contains(t))
            .collect();
        let topic = StampedChannel::new("v", &stamps, &vec![3.5; stamps.len()], false).unwrap();
        let found = topic.at(&[-1.0, 0.5, 0.97, 1.5, 2.05, 3.9, 9.0], 40.0);
        let is_missing: Vec<bool> = found.iter().map(|x| x.is_nan()).collect();
        assert_eq!(is_missing, [true, false, false, true, false, false, true]);
        assert!(
            found
                .iter()
                .filter(|x| x.is_finite())
                .all(|x| (x - 3.5).abs() < 1e-12),
            "rounding alone"
        );
    }

    #[test]
    fn stamps_that_stand_or_run_backwards_are_dropped() {
        let stamps = [0.0, 0.1, 0.1, 0.2, 0.15, 0.3, f64::NAN, 0.4];
        let topic = StampedChannel::new(
            "v",
            &stamps,
            &[0.0, 1.0, 9.0, 2.0, 9.0, 3.0, 9.0, 4.0],
            false,
        )
        .unwrap();
        assert_eq!(
            (topic.time_s, topic.values),
            (vec![0.0, 0.1, 0.2, 0.3, 0.4], vec![0.0, 1.0, 2.0, 3.0, 4.0])
        );
        let error = StampedChannel::new("v", &[0.0, 1.0], &[1.0, 2.0], false).unwrap_err();
        assert!(matches!(error, ResamplingError::TooFew { samples: 2, .. }));
    }

    #[test]
    fn a_held_command_acts_half_a_hold_later() {
        let stamps: Vec<f64> = (0..500).map(|k| 0.02 * f64::from(k)).collect();
        // `t + 0.01`: each value is the mean of the signal until the next stamp, 0.02 s later.
        let values: Vec<f64> = stamps.iter().map(|t| signal(t + 0.01)).collect();
        let topic = StampedChannel::new("u", &stamps, &values, true).unwrap();
        let asked: Vec<f64> = (0..100).map(|k| 3.0 + 0.031 * f64::from(k)).collect();
        let found = topic.at(&asked, 80.0);
        assert!(
            asked
                .iter()
                .zip(found)
                .all(|(t, x)| (x - signal(*t)).abs() < 2e-3)
        );
        assert!(is_held(&[1.0, 1.0, 1.0, 2.0, 2.0, 2.0]) && !is_held(&[1.0, 2.0, 2.0, 3.0]));
    }
}
