//! Topics with their own clocks, resampled to a common uniform clock (M14.11).

use std::f64::consts::{PI, TAU};
use std::ops::Range;

use gdcm_model::statistics::median;

/// Maximum step without a gap, in median steps: 3 missing samples are bridged (M14.1).
const LONGEST_STEP: f64 = 4.5;
/// Share of repeated samples above which a channel counts as held.
const HELD: f64 = 0.5;
/// Minimum number of samples in a topic.
const LEAST_SAMPLES: usize = 3;
/// Half-length of the kernel, in half periods of its cut-off.
const HALF_TAPS: f64 = 12.0;
/// Tolerance for times just outside the stamps of a run, relative to the time.
const ROUNDING: f64 = 1e-9;
/// Ratio of the highest spectral line used to the upper band end (M14.2).
const HIGHEST_LINE: f64 = 4.0 / 3.0;
/// Minimum number of samples of a topic per period of the highest line.
const NEEDED: f64 = 2.5;
/// Minimum number of samples of the common clock per period of the highest line.
const LEAST_ON_CLOCK: f64 = 4.0;
/// Maximum number of samples of the common clock per period of the highest line.
const MOST_ON_CLOCK: f64 = 20.0;
/// Ratio of the cut-off to the highest line.
const CUT_OFF: f64 = 5.0;
/// Maximum cut-off as a fraction of half the slowest sample rate.
const CUT_OFF_OF_RATE: f64 = 0.8;
/// Maximum number of samples, about a day at 100 Hz; a larger number indicates a wrong stamp.
const MOST_SAMPLES: f64 = 1e7;

/// Samples of a channel with separate stamps.
#[derive(Clone, Debug, PartialEq)]
pub struct Topic {
    /// Name for display.
    pub name: String,
    /// Stamps \[s\], increasing and finite.
    time_s: Vec<f64>,
    /// Value at each stamp, finite.
    values: Vec<f64>,
    /// Index ranges of samples without gaps; never empty.
    runs: Vec<Range<usize>>,
    /// Sample rate without gaps \[Hz\].
    pub rate_hz: f64,
}

impl Topic {
    /// Creates a topic from the samples that have increasing stamps and finite values.
    ///
    /// A held command acts until the next sample: its stamps are moved later by half this time
    /// (M14.1).
    ///
    /// # Errors
    /// [`TopicError::TooFew`] for fewer than three samples.
    pub fn new(
        name: &str,
        time_s: &[f64],
        values: &[f64],
        is_held: bool,
    ) -> Result<Self, TopicError> {
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
            return Err(TopicError::TooFew {
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

/// Moves each stamp later by half the time to the next, at most by half `longest_s`.
fn delay_by_half_a_hold(times: &mut [f64], longest_s: f64) {
    // From front to back, because each stamp needs the next one unchanged.
    for k in 0..times.len() - 1 {
        times[k] += 0.5 * (times[k + 1] - times[k]).min(longest_s);
    }
    // The last hold is assumed to last as long as the one before.
    if let [.., before, last] = times {
        *last += (*last - *before).min(longest_s);
    }
}

/// Returns the index ranges of the samples between gaps longer than `longest_s`.
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

/// Whether a command is held: more than half of its samples repeat the preceding sample.
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
/// Constants do not change, nor does a sample without a neighbour in the kernel. Stamps increase;
/// `cutoff` is wc \[rad/s\].
fn low_passed(time_s: &[f64], values: &[f64], t: f64, cutoff: f64) -> f64 {
    let half = HALF_TAPS * PI / cutoff;
    let from = time_s.partition_point(|time| *time <= t - half);
    let to = time_s.partition_point(|time| *time < t + half);
    let mut sum = 0.0;
    let mut weights = 0.0;
    for k in from..to {
        let x = cutoff * (t - time_s[k]);
        let y = PI * (t - time_s[k]) / half;
        let sinc = if x.abs() < 1e-8 { 1.0 } else { x.sin() / x };
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

/// The uniform clock to which topics are resampled.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CommonClock {
    /// Time of the first sample \[s\].
    pub start_s: f64,
    /// Sample rate \[Hz\].
    pub rate_hz: f64,
    /// Number of samples.
    pub samples: usize,
    /// Low-pass cut-off of every channel \[rad/s\].
    pub cutoff: f64,
}

impl CommonClock {
    /// Chooses the common clock (M14.11).
    ///
    /// `band_end` is the upper band end \[rad/s\], by default the end for which the slowest rate
    /// gives 20 samples in a period of the highest line; `rate_hz` is a requested rate \[Hz\].
    ///
    /// ```text
    /// whi = 4/3 ω2
    /// fs  = min(slowest rate, 20 whi/2π), at least 4 whi/2π
    /// wc  = min(5 whi, 0.8 π · slowest rate)
    /// from the latest first stamp to the earliest last stamp
    /// ```
    ///
    /// # Errors
    /// [`TopicError::TooSlow`] for a topic or a requested rate with fewer than 2.5 whi/2π samples
    /// in a second; [`TopicError::NoCommonTime`] for topics that share no time;
    /// [`TopicError::TooMany`] for more than ten million samples; [`TopicError::TooFew`] without
    /// topics.
    pub fn choose(
        topics: &[Topic],
        band_end: Option<f64>,
        rate_hz: Option<f64>,
    ) -> Result<Self, TopicError> {
        let slowest = topics
            .iter()
            .map(|topic| topic.rate_hz)
            .fold(f64::INFINITY, f64::min);
        let band_end = band_end.unwrap_or(TAU * slowest / (HIGHEST_LINE * MOST_ON_CLOCK));
        let highest_hz = HIGHEST_LINE * band_end / TAU;
        check_rates(topics, band_end)?;
        let rate = match rate_hz {
            Some(rate) => rate,
            None => slowest
                .min(MOST_ON_CLOCK * highest_hz)
                .max(LEAST_ON_CLOCK * highest_hz),
        };
        check_rate("the resampled record", rate, band_end)?;
        let [start_s, end_s] = common_span_s(topics)?;
        let samples = ((end_s - start_s) * rate + 1e-6).floor() + 1.0;
        if samples > MOST_SAMPLES {
            return Err(TopicError::TooMany(samples));
        }
        let cutoff = (CUT_OFF * TAU * highest_hz).min(CUT_OFF_OF_RATE * PI * slowest.min(rate));
        Ok(Self {
            start_s,
            rate_hz: rate,
            samples: samples as usize,
            cutoff,
        })
    }

    /// Returns the sample times of the clock \[s\].
    pub fn times_s(&self) -> Vec<f64> {
        (0..self.samples)
            .map(|k| self.start_s + k as f64 / self.rate_hz)
            .collect()
    }

    /// Returns the clock with the samples from `from_s` to `to_s` \[s\] only.
    #[must_use]
    pub fn within(self, [from_s, to_s]: [f64; 2]) -> Self {
        let first = ((from_s - self.start_s) * self.rate_hz - 1e-6)
            .ceil()
            .clamp(0.0, self.samples as f64);
        let last = ((to_s - self.start_s) * self.rate_hz + 1e-6)
            .floor()
            .clamp(-1.0, self.samples as f64 - 1.0);
        let samples = (last - first + 1.0).max(0.0) as usize;
        Self {
            start_s: self.start_s + first / self.rate_hz,
            samples,
            ..self
        }
    }
}

/// Returns an error if a topic is too slow for the band; it names the slowest.
fn check_rates(topics: &[Topic], band_end: f64) -> Result<(), TopicError> {
    let slowest = topics.iter().min_by(|a, b| a.rate_hz.total_cmp(&b.rate_hz));
    match slowest {
        Some(topic) => check_rate(&topic.name, topic.rate_hz, band_end),
        None => Ok(()),
    }
}

/// Returns an error for a rate that is too low for the band.
fn check_rate(topic: &str, rate_hz: f64, band_end: f64) -> Result<(), TopicError> {
    let highest_hz = HIGHEST_LINE * band_end / TAU;
    let needed_hz = NEEDED * highest_hz;
    if rate_hz < needed_hz {
        return Err(TopicError::TooSlow {
            topic: topic.to_owned(),
            rate_hz,
            needed_hz,
            band_end,
            possible: band_end * rate_hz / needed_hz,
        });
    }
    Ok(())
}

/// Returns first and last time of the interval that all topics share \[s\].
fn common_span_s(topics: &[Topic]) -> Result<[f64; 2], TopicError> {
    let latest = topics
        .iter()
        .max_by(|a, b| a.span_s()[0].total_cmp(&b.span_s()[0]));
    let earliest = topics
        .iter()
        .min_by(|a, b| a.span_s()[1].total_cmp(&b.span_s()[1]));
    let (Some(latest), Some(earliest)) = (latest, earliest) else {
        return Err(TopicError::TooFew {
            topic: "a record without channels".to_owned(),
            samples: 0,
        });
    };
    let start_s = latest.span_s()[0];
    let end_s = earliest.span_s()[1];
    if end_s <= start_s {
        return Err(TopicError::NoCommonTime {
            first: earliest.name.clone(),
            first_end_s: end_s,
            second: latest.name.clone(),
            second_start_s: start_s,
        });
    }
    Ok([start_s, end_s])
}

/// Why topics cannot be resampled to a common clock.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum TopicError {
    #[error("{topic} has {samples} samples with a stamp; at least 3 are needed")]
    TooFew { topic: String, samples: usize },
    /// A topic has fewer than 2.5 samples per period of the highest line.
    #[error(
        "{topic} is sampled at {rate_hz:.1} Hz, and a band to {band_end:.3} rad/s needs {needed_hz:.1} Hz: log it faster, or end \
         the band at {possible:.2} rad/s"
    )]
    TooSlow {
        topic: String,
        rate_hz: f64,
        /// Minimum sample rate for the band \[Hz\].
        needed_hz: f64,
        /// Requested upper band end \[rad/s\].
        band_end: f64,
        /// Maximum upper band end at the sample rate \[rad/s\].
        possible: f64,
    },
    #[error(
        "{first} ends at {first_end_s:.1} s, before {second} begins at {second_start_s:.1} s: they come from different flights, or their \
         clocks differ"
    )]
    NoCommonTime {
        /// Name of the topic that ends first.
        first: String,
        first_end_s: f64,
        /// Name of the topic that begins last.
        second: String,
        second_start_s: f64,
    },
    #[error(
        "the joined record would have {0:.0} samples: a stamp is wrong, or the requested rate is too high"
    )]
    TooMany(f64),
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
        let topic = Topic::new("v", &stamps, &values, false).unwrap();
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
        let topic = Topic::new("v", &stamps, &vec![3.5; stamps.len()], false).unwrap();
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
        let topic = Topic::new(
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
        let error = Topic::new("v", &[0.0, 1.0], &[1.0, 2.0], false).unwrap_err();
        assert!(matches!(error, TopicError::TooFew { samples: 2, .. }));
    }

    #[test]
    fn a_held_command_acts_half_a_hold_later() {
        let stamps: Vec<f64> = (0..500).map(|k| 0.02 * f64::from(k)).collect();
        // `t + 0.01`: each value is the mean of the signal until the next stamp, 0.02 s later.
        let values: Vec<f64> = stamps.iter().map(|t| signal(t + 0.01)).collect();
        let topic = Topic::new("u", &stamps, &values, true).unwrap();
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

    /// Returns a constant topic between two times \[s\].
    fn topic(name: &str, rate: f64, from: f64, to: f64) -> Topic {
        let stamps: Vec<f64> = (0..((to - from) * rate) as usize)
            .map(|k| from + k as f64 / rate)
            .collect();
        Topic::new(name, &stamps, &vec![1.0; stamps.len()], false).unwrap()
    }

    #[test]
    fn the_clock_follows_the_slowest_topic_as_far_as_the_band_needs_it() {
        let fast = [
            topic("M", 250.0, 0.0, 20.0),
            topic("q", 100.0, 1.0, 22.0),
            topic("v", 50.0, 0.5, 21.0),
        ];
        let clock = CommonClock::choose(&fast, Some(12.0), None).unwrap();
        assert!(
            (clock.rate_hz - 50.0).abs() < 1e-6 && (clock.cutoff - 80.0).abs() < 1e-9,
            "{clock:?}"
        );
        assert!(clock.start_s == 1.0 && clock.times_s().last().unwrap() <= &20.0);
        let part = clock.within([5.0, 10.0]);
        assert_eq!((part.samples, part.start_s), (251, 5.0));
        // 20 · 4/3 · 3 rad/s are 12.7 Hz.
        assert!(
            (CommonClock::choose(&fast, Some(3.0), None).unwrap().rate_hz - 12.73).abs() < 0.01
        );
        let slow = [topic("M", 250.0, 0.0, 20.0), topic("gps", 5.0, 0.0, 20.0)];
        let Err(TopicError::TooSlow {
            topic: slowest,
            needed_hz,
            possible,
            ..
        }) = CommonClock::choose(&slow, Some(12.0), None)
        else {
            panic!("the slow topic is refused");
        };
        // 2.5 · 4/3 · 12 rad/s are 6.366 Hz; 5 Hz are enough for 9.425 rad/s.
        assert_eq!(slowest, "gps");
        assert!((needed_hz - 6.366).abs() < 1e-3 && (possible - 9.425).abs() < 1e-3);
        assert!(
            CommonClock::choose(&fast, Some(12.0), Some(3.0)).is_err()
                && CommonClock::choose(&fast, Some(12.0), Some(80.0)).is_ok()
        );
        let apart = [topic("M", 50.0, 0.0, 5.0), topic("q", 50.0, 9.0, 22.0)];
        assert!(matches!(
            CommonClock::choose(&apart, Some(12.0), None),
            Err(TopicError::NoCommonTime { .. })
        ));
    }
}
