//! Chooses the common uniform clock for channels with separate stamps: rate, cut-off, first and
//! last time (M14.11).

use std::f64::consts::{PI, TAU};

use super::resampling_error::{RESAMPLED_RECORD, ResamplingError};
use super::stamped_channel::StampedChannel;

/// Ratio of the highest spectral line used to the upper end of the band (M14.9).
const HIGHEST_LINE: f64 = 4.0 / 3.0;
/// Minimum number of samples per period of the highest line, in a channel and at a requested rate:
/// with fewer, the band is not visible.
const LEAST_SAMPLES_A_PERIOD: f64 = 2.5;
/// Minimum number of samples per period of the highest line, on a clock without a requested rate.
const LEAST_ON_CLOCK: f64 = 4.0;
/// Maximum number of samples per period of the highest line, on a clock without a requested rate.
const MOST_ON_CLOCK: f64 = 20.0;
/// Ratio of the cut-off to the highest line, as when records are prepared (M14.1).
const CUT_OFF_OF_LINE: f64 = 5.0;
/// Highest cut-off, as a fraction of half the lowest sample rate among the channels and the clock.
const CUT_OFF_OF_RATE: f64 = 0.8;
/// Tolerance for a sample just outside an end of the clock, in samples.
const ROUNDING: f64 = 1e-6;
/// Maximum number of samples, about a day at 100 Hz; more indicate a wrong stamp or too high a
/// requested rate.
const MOST_SAMPLES: f64 = 1e7;

/// The uniform clock to which channels are resampled.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CommonClock {
    /// Time at the first sample \[s\].
    pub start_s: f64,
    /// Sample rate \[Hz\].
    pub rate_hz: f64,
    pub samples: usize,
    /// Low-pass cut-off for every channel \[rad/s\].
    pub cutoff: f64,
}

impl CommonClock {
    /// Chooses the common clock (M14.11).
    ///
    /// `band_end` is the upper end of the band \[rad/s\], by default the end for which the slowest
    /// rate gives 20 samples in a period of the highest line; `rate_hz` is a requested rate \[Hz\].
    ///
    /// ```text
    /// ω2  the upper band end, whi the highest spectral line used
    /// whi = 4/3 ω2
    /// rate     fs = the requested rate, or else min(slowest rate, 20 whi/2π), at least 4 whi/2π
    /// span     from the latest first stamp to the earliest last stamp
    /// cut-off  wc = min(5 whi, 0.8 π · min(slowest rate, fs))
    /// ```
    ///
    /// # Errors
    /// [`ResamplingError::TooSlow`] for a channel or a requested rate with fewer than 2.5 whi/2π
    /// samples in a second; [`ResamplingError::NoCommonTime`] for channels that share no time;
    /// [`ResamplingError::TooMany`] for more than ten million samples; [`ResamplingError::TooFew`]
    /// without channels.
    pub fn choose(
        channels: &[StampedChannel],
        band_end: Option<f64>,
        rate_hz: Option<f64>,
    ) -> Result<Self, ResamplingError> {
        let slowest = channels
            .iter()
            .map(|channel| channel.rate_hz)
            .fold(f64::INFINITY, f64::min);
        let band_end = band_end.unwrap_or(TAU * slowest / (HIGHEST_LINE * MOST_ON_CLOCK));
        let highest_hz = HIGHEST_LINE * band_end / TAU;
        check_rates(channels, band_end)?;
        let rate = match rate_hz {
            Some(rate) => rate,
            None => slowest
                .min(MOST_ON_CLOCK * highest_hz)
                .max(LEAST_ON_CLOCK * highest_hz),
        };
        check_rate(RESAMPLED_RECORD, rate, band_end)?;
        let [start_s, end_s] = common_span_s(channels)?;
        let samples = ((end_s - start_s) * rate + ROUNDING).floor() + 1.0;
        if samples > MOST_SAMPLES {
            return Err(ResamplingError::TooMany(samples));
        }
        let cutoff =
            (CUT_OFF_OF_LINE * TAU * highest_hz).min(CUT_OFF_OF_RATE * PI * slowest.min(rate));
        Ok(Self {
            start_s,
            rate_hz: rate,
            samples: samples as usize,
            cutoff,
        })
    }

    /// Returns the clock's sample times \[s\].
    pub fn times_s(&self) -> Vec<f64> {
        (0..self.samples)
            .map(|k| self.start_s + k as f64 / self.rate_hz)
            .collect()
    }

    /// Returns the clock with the samples from `from_s` to `to_s` \[s\] only.
    #[must_use]
    pub fn within(self, [from_s, to_s]: [f64; 2]) -> Self {
        let first = ((from_s - self.start_s) * self.rate_hz - ROUNDING)
            .ceil()
            .clamp(0.0, self.samples as f64);
        let last = ((to_s - self.start_s) * self.rate_hz + ROUNDING)
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

/// Returns an error if the slowest channel is too slow for the band.
fn check_rates(channels: &[StampedChannel], band_end: f64) -> Result<(), ResamplingError> {
    let slowest = channels
        .iter()
        .min_by(|a, b| a.rate_hz.total_cmp(&b.rate_hz));
    match slowest {
        Some(channel) => check_rate(&channel.name, channel.rate_hz, band_end),
        None => Ok(()),
    }
}

/// Returns an error for a rate that is too low for the band.
fn check_rate(name: &str, rate_hz: f64, band_end: f64) -> Result<(), ResamplingError> {
    let highest_hz = HIGHEST_LINE * band_end / TAU;
    let needed_hz = LEAST_SAMPLES_A_PERIOD * highest_hz;
    if rate_hz < needed_hz {
        return Err(ResamplingError::TooSlow {
            topic: name.to_owned(),
            rate_hz,
            needed_hz,
            band_end,
            possible: band_end * rate_hz / needed_hz,
        });
    }
    Ok(())
}

/// Returns the first and last time that all channels share \[s\].
fn common_span_s(channels: &[StampedChannel]) -> Result<[f64; 2], ResamplingError> {
    let latest = channels
        .iter()
        .max_by(|a, b| a.span_s()[0].total_cmp(&b.span_s()[0]));
    let earliest = channels
        .iter()
        .min_by(|a, b| a.span_s()[1].total_cmp(&b.span_s()[1]));
    let (Some(latest), Some(earliest)) = (latest, earliest) else {
        return Err(ResamplingError::TooFew {
            topic: "a record without channels".to_owned(),
            samples: 0,
        });
    };
    let start_s = latest.span_s()[0];
    let end_s = earliest.span_s()[1];
    if end_s <= start_s {
        return Err(ResamplingError::NoCommonTime {
            first: earliest.name.clone(),
            first_end_s: end_s,
            second: latest.name.clone(),
            second_start_s: start_s,
        });
    }
    Ok([start_s, end_s])
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns a constant topic between two times \[s\].
    fn topic(name: &str, rate: f64, from: f64, to: f64) -> StampedChannel {
        let stamps: Vec<f64> = (0..((to - from) * rate) as usize)
            .map(|k| from + k as f64 / rate)
            .collect();
        StampedChannel::new(name, &stamps, &vec![1.0; stamps.len()], false).unwrap()
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
        // At most 20 times the highest line, 4/3 of the upper end of the band of 3 rad/s: 12.73 Hz.
        assert!(
            (CommonClock::choose(&fast, Some(3.0), None).unwrap().rate_hz - 12.73).abs() < 0.01
        );
        let slow = [topic("M", 250.0, 0.0, 20.0), topic("gps", 5.0, 0.0, 20.0)];
        let Err(ResamplingError::TooSlow {
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
            Err(ResamplingError::NoCommonTime { .. })
        ));
    }
}
