//! Topics with clocks of their own, brought to one uniform clock (M14.11).

use std::f64::consts::{PI, TAU};
use std::ops::Range;

use gdcm_model::response::median;

/// Samples of one channel with stamps of their own.
#[derive(Clone, Debug, PartialEq)]
pub struct Topic {
    /// Its name, for people.
    pub name: String,
    /// Stamps \[s\], increasing and finite.
    time_s: Vec<f64>,
    /// A value for each stamp, finite.
    values: Vec<f64>,
    /// The samples between two gaps; at least one run.
    runs: Vec<Range<usize>>,
    /// Samples in a second, gaps left out.
    pub rate_hz: f64,
}

/// A stamp that is further on than this many of the median step begins behind a gap: 3 missing samples are bridged (M14.1).
const LONGEST_STEP: f64 = 4.5;
/// A channel is held if more than this share of its samples are as the one before.
const HELD: f64 = 0.5;

impl Topic {
    /// The samples that count: stamps that run backwards or stand twice are dropped, and so are missing values. A held command acts
    /// until the next one comes: its stamps are moved half of that time later (M14.1).
    ///
    /// # Errors
    /// [`TopicError::TooFew`] where fewer than three samples are left.
    pub fn new(name: &str, time_s: &[f64], values: &[f64], held: bool) -> Result<Self, TopicError> {
        let (mut times, mut kept): (Vec<f64>, Vec<f64>) = (Vec::new(), Vec::new());
        for (&time, &value) in time_s.iter().zip(values) {
            if time.is_finite() && value.is_finite() && times.last().is_none_or(|last| time > *last)
            {
                times.push(time);
                kept.push(value);
            }
        }
        if times.len() < 3 {
            return Err(TopicError::TooFew {
                topic: name.to_owned(),
                samples: times.len(),
            });
        }
        let mut steps: Vec<f64> = times.windows(2).map(|pair| pair[1] - pair[0]).collect();
        let longest_s = LONGEST_STEP * median(&mut steps);
        if held {
            // In place, from the front: each stamp needs the next one as it was.
            for k in 0..times.len() - 1 {
                times[k] += 0.5 * (times[k + 1] - times[k]).min(longest_s);
            }
            if let [.., before, last] = &mut times[..] {
                *last += (*last - *before).min(longest_s);
            }
        }
        let ends = (1..times.len()).filter(|&k| times[k] - times[k - 1] > longest_s);
        let mut runs: Vec<Range<usize>> = Vec::new();
        for end in ends.chain([times.len()]) {
            runs.push(runs.last().map_or(0, |run| run.end)..end);
        }
        let (steps, length_s) = runs.iter().fold((0, 0.0), |(steps, length_s), run| {
            (
                steps + run.len() - 1,
                length_s + times[run.end - 1] - times[run.start],
            )
        });
        let rate_hz = if length_s > 0.0 {
            steps as f64 / length_s
        } else {
            0.0
        };
        Ok(Self {
            name: name.to_owned(),
            time_s: times,
            values: kept,
            runs,
            rate_hz,
        })
    }

    /// First and last stamp \[s\].
    pub fn span_s(&self) -> [f64; 2] {
        [
            self.time_s.first().copied().unwrap_or(0.0),
            self.time_s.last().copied().unwrap_or(0.0),
        ]
    }

    /// Its values at times that increase, below a cut-off \[rad/s\]; not a number in its gaps and beyond its ends.
    pub fn at(&self, times_s: &[f64], cutoff: f64) -> Vec<f64> {
        let mut runs = self.runs.iter();
        let mut run = runs.next();
        let value = |&t: &f64| {
            while let Some(beyond) = run.filter(|run| self.time_s[run.end - 1] < t) {
                // A hair beyond the last stamp is rounding.
                if t - self.time_s[beyond.end - 1] <= 1e-9 * t.abs() {
                    break;
                }
                run = runs.next();
            }
            let inside = run.filter(|run| t >= self.time_s[run.start] - 1e-9 * t.abs());
            inside.map_or(f64::NAN, |run| {
                low_passed(
                    &self.time_s[run.clone()],
                    &self.values[run.clone()],
                    t,
                    cutoff,
                )
            })
        };
        times_s.iter().map(value).collect()
    }
}

/// Whether samples are those of a held command: more than half of them are as the one before.
pub fn is_held(values: &[f64]) -> bool {
    let same = values.windows(2).filter(|pair| pair[0] == pair[1]).count();
    same as f64 > HELD * values.len() as f64
}

/// Half the taps of the kernel, in half periods of its cut-off.
const HALF_TAPS: f64 = 12.0;

/// Low-pass and interpolation in one, at time `t` \[s\] (M14.11):
///
/// ```text
/// x(t) = Σ w_k v_k / Σ w_k,    w_k = Δ_k sinc(wc (t − t_k)/π) · ½ (1 + cos(π (t − t_k)/h)),    |t − t_k| < h = 12 π/wc
/// Δ_k  = half the distance of the two neighbours of t_k; at an end, the distance of its one neighbour
/// ```
///
/// Constants stay as they are, and so does a sample where no other is near. Stamps increase; `cutoff` is wc \[rad/s\].
fn low_passed(time_s: &[f64], values: &[f64], t: f64, cutoff: f64) -> f64 {
    let half = HALF_TAPS * PI / cutoff;
    let from = time_s.partition_point(|time| *time <= t - half);
    let to = time_s.partition_point(|time| *time < t + half);
    let last = time_s.len() - 1;
    let mut sum = 0.0;
    let mut weights = 0.0;
    for k in from..to {
        let width = match k {
            _ if last == 0 => 1.0,
            0 => time_s[1] - time_s[0],
            k if k == last => time_s[last] - time_s[last - 1],
            k => 0.5 * (time_s[k + 1] - time_s[k - 1]),
        };
        let x = cutoff * (t - time_s[k]);
        let y = PI * (t - time_s[k]) / half;
        let sinc = if x.abs() < 1e-8 { 1.0 } else { x.sin() / x };
        let weight = width * sinc * 0.5 * (1.0 + y.cos());
        sum += weight * values[k];
        weights += weight;
    }
    if weights > 0.0 {
        sum / weights
    } else {
        f64::NAN
    }
}

/// The uniform clock that topics are brought to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CommonClock {
    /// First sample \[s\].
    pub start_s: f64,
    /// Samples in a second.
    pub rate_hz: f64,
    /// Number of samples.
    pub samples: usize,
    /// Cut-off of the low-pass that every channel goes through \[rad/s\].
    pub cutoff: f64,
}

/// The highest line used is at this many times the end of the band (M14.2).
const HIGHEST_LINE: f64 = 4.0 / 3.0;

impl CommonClock {
    /// The clock of topics, for a band that ends at `band_end` \[rad/s\] (none: as far as they reach), at the rate asked for \[Hz\] or else by the rule (M14.11).
    ///
    /// ```text
    /// whi = 4/3 ω2
    /// fs  = min(slowest rate, 20 whi/2π), at least 4 whi/2π
    /// wc  = min(5 whi, 0.8 π · slowest rate)
    /// from the latest first stamp to the earliest last one
    /// ```
    ///
    /// # Errors
    /// [`TopicError::TooSlow`] where a topic, or the rate asked for, has fewer than 2.5 whi/2π samples in a second;
    /// [`TopicError::NoCommonTime`] where the topics share no time; [`TopicError::TooMany`] where a million million samples came of it.
    pub fn of(
        topics: &[Topic],
        band_end: Option<f64>,
        rate_hz: Option<f64>,
    ) -> Result<Self, TopicError> {
        let slowest = topics
            .iter()
            .map(|topic| topic.rate_hz)
            .fold(f64::INFINITY, f64::min);
        let band_end = band_end.unwrap_or(TAU * slowest / (HIGHEST_LINE * 20.0));
        let highest_hz = HIGHEST_LINE * band_end / TAU;
        let needed_hz = 2.5 * highest_hz;
        let slow = |topic: &str, rate_hz: f64| TopicError::TooSlow {
            topic: topic.to_owned(),
            rate_hz,
            needed_hz,
            band_end,
            possible: band_end * rate_hz / needed_hz,
        };
        if let Some(topic) = topics
            .iter()
            .filter(|topic| topic.rate_hz < needed_hz)
            .min_by(|a, b| a.rate_hz.total_cmp(&b.rate_hz))
        {
            return Err(slow(&topic.name, topic.rate_hz));
        }
        let rate = rate_hz.unwrap_or_else(|| slowest.min(20.0 * highest_hz).max(4.0 * highest_hz));
        if rate < needed_hz {
            return Err(slow("the resampled record", rate));
        }
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
            let first = earliest.name.clone();
            let second = latest.name.clone();
            return Err(TopicError::NoCommonTime {
                first,
                first_end_s: end_s,
                second,
                second_start_s: start_s,
            });
        }
        let samples = ((end_s - start_s) * rate + 1e-6).floor() + 1.0;
        if samples > MOST_SAMPLES {
            return Err(TopicError::TooMany(samples));
        }
        let cutoff = (5.0 * TAU * highest_hz).min(0.8 * PI * slowest.min(rate));
        Ok(Self {
            start_s,
            rate_hz: rate,
            samples: samples as usize,
            cutoff,
        })
    }

    /// Times of its samples \[s\].
    pub fn times_s(&self) -> Vec<f64> {
        (0..self.samples)
            .map(|k| self.start_s + k as f64 / self.rate_hz)
            .collect()
    }

    /// Its samples within a part of the time \[s\] alone.
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

/// Ten million samples are a day at 100 Hz; beyond it a stamp is wrong.
const MOST_SAMPLES: f64 = 1e7;

/// Why topics cannot be brought to one clock.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum TopicError {
    /// A topic has hardly any samples.
    #[error("{topic} has {samples} samples with a stamp: at least 3 are needed")]
    TooFew {
        /// Its name.
        topic: String,
        /// How many.
        samples: usize,
    },
    /// A topic cannot show the band.
    #[error(
        "{topic} has {rate_hz:.1} samples in a second, and a band to {band_end:.3} rad/s takes {needed_hz:.1}: log it faster, or end \
         the band at {possible:.2} rad/s"
    )]
    TooSlow {
        /// Its name.
        topic: String,
        /// Its samples in a second.
        rate_hz: f64,
        /// As many as the band takes.
        needed_hz: f64,
        /// End of the band \[rad/s\].
        band_end: f64,
        /// End of the band that it can show \[rad/s\].
        possible: f64,
    },
    /// Topics are of different times.
    #[error(
        "{first} ends at {first_end_s:.1} s, before {second} begins at {second_start_s:.1} s: they are not of one flight, or their \
         clocks differ"
    )]
    NoCommonTime {
        /// The one that ends first.
        first: String,
        /// When \[s\].
        first_end_s: f64,
        /// The one that begins last.
        second: String,
        /// When \[s\].
        second_start_s: f64,
    },
    /// A stamp is so far off that nothing could hold the record.
    #[error(
        "the topics would make a record of {0:.0} samples: a stamp is wrong, or the rate asked for is too high"
    )]
    TooMany(f64),
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::identification::known_answers_tests::{number, numbers};

    /// Stamps `step k` shaken by a linear congruence, as those of the known answer are.
    fn shaken(count: usize, step: f64, shake: f64) -> Vec<f64> {
        let mut state = 5_u32;
        let mut draw = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            f64::from(state) / 2_f64.powi(32)
        };
        (0..count)
            .map(|k| step * k as f64 + shake * (draw() - 0.5))
            .collect()
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
        assert_eq!(
            error.to_string(),
            "v has 2 samples with a stamp: at least 3 are needed"
        );
    }

    #[test]
    fn a_held_command_acts_half_a_hold_later() {
        let stamps: Vec<f64> = (0..500).map(|k| 0.02 * f64::from(k)).collect();
        // At each stamp the mean of what acts until the next one.
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

    #[test]
    fn the_clock_is_that_of_the_slowest_topic_as_far_as_the_band_needs_it() {
        let topic = |name: &str, rate: f64, from: f64, to: f64| {
            let stamps: Vec<f64> = (0..((to - from) * rate) as usize)
                .map(|k| from + k as f64 / rate)
                .collect();
            Topic::new(name, &stamps, &vec![1.0; stamps.len()], false).unwrap()
        };
        let fast = [
            topic("M", 250.0, 0.0, 20.0),
            topic("q", 100.0, 1.0, 22.0),
            topic("v", 50.0, 0.5, 21.0),
        ];
        let clock = CommonClock::of(&fast, Some(12.0), None).unwrap();
        assert!(
            (clock.rate_hz - 50.0).abs() < 1e-6 && (clock.cutoff - 80.0).abs() < 1e-9,
            "{clock:?}"
        );
        assert!(clock.start_s == 1.0 && clock.times_s().last().unwrap() <= &20.0);
        let part = clock.within([5.0, 10.0]);
        assert_eq!((part.samples, part.start_s), (251, 5.0));
        // 20 · 4/3 · 3 rad/s are 12.7 Hz.
        assert!((CommonClock::of(&fast, Some(3.0), None).unwrap().rate_hz - 12.73).abs() < 0.01);
        let slow = [topic("M", 250.0, 0.0, 20.0), topic("gps", 5.0, 0.0, 20.0)];
        let words = CommonClock::of(&slow, Some(12.0), None)
            .unwrap_err()
            .to_string();
        let expected = "gps has 5.0 samples in a second, and a band to 12.000 rad/s takes 6.4: log it faster, or end the band at 9.42 rad/s";
        assert_eq!(words, expected);
        assert!(
            CommonClock::of(&fast, Some(12.0), Some(3.0)).is_err()
                && CommonClock::of(&fast, Some(12.0), Some(80.0)).is_ok()
        );
        let apart = [topic("M", 50.0, 0.0, 5.0), topic("q", 50.0, 9.0, 22.0)];
        assert!(matches!(
            CommonClock::of(&apart, Some(12.0), None),
            Err(TopicError::NoCommonTime { .. })
        ));
    }
}
