//! A model's sample time and channel delays, which its matrices do not contain (M2a).

use crate::number_format::{counted, number};

/// Maximum delay in an input or output channel \[s\].
pub const GREATEST_CHANNEL_DELAY_S: f64 = 60.0;

/// A model's sample time and channel delays, which its matrices do not contain (M2a).
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Timing {
    /// Sample time T in discrete time \[s\]; `None` in continuous time.
    pub sample_time_s: Option<f64>,
    /// Each input's delay \[s\]; `None` without delays.
    pub input_delays_s: Option<Vec<f64>>,
    /// Each output's delay \[s\]; `None` without delays.
    pub output_delays_s: Option<Vec<f64>>,
}

/// Error for an invalid sample time or delay.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum TimingError {
    #[error("sample_time_s: expected a positive number of seconds (omit it for continuous time), \
        found {}", number(*.0))]
    SampleTime(f64),
    #[error("{list}: expected {}, one for each channel, found {found}", counted(*expected, "delay"))]
    Count {
        /// `input_delays_s` or `output_delays_s`.
        list: &'static str,
        expected: usize,
        found: usize,
    },
    #[error("{list}, entry {entry}: expected a delay from 0 to {GREATEST_CHANNEL_DELAY_S} s, found {}", number(*value))]
    Delay {
        /// `input_delays_s` or `output_delays_s`.
        list: &'static str,
        /// Entry, counted from 1.
        entry: usize,
        value: f64,
    },
}

impl TimingError {
    /// Returns the stable code by which scripts and tests distinguish the errors.
    pub fn code(&self) -> &'static str {
        match self {
            Self::SampleTime(..) => "sample-time",
            Self::Count { .. } => "delay-count",
            Self::Delay { .. } => "delay-value",
        }
    }
}

impl Timing {
    /// Returns whether the timing is plain: continuous time without delays.
    pub fn is_plain(&self) -> bool {
        *self == Self::default()
    }

    /// Returns the Nyquist frequency `pi / T` \[rad/s\], at and above which a discrete-time model
    /// has no response; `None` in continuous time.
    pub fn nyquist_rad_s(&self) -> Option<f64> {
        let sample_time_s = self.sample_time_s?;
        Some(std::f64::consts::PI / sample_time_s)
    }

    /// Returns a response's delay, output delay plus input delay \[s\].
    pub fn delay_s(&self, output: usize, input: usize) -> f64 {
        channel_delay(self.output_delays_s.as_deref(), output)
            + channel_delay(self.input_delays_s.as_deref(), input)
    }

    /// Describes the timing: "discrete time, T = 0.01 s, input delays 0.02, 0 s"; empty if it is
    /// plain.
    pub fn words(&self) -> String {
        let mut parts = Vec::new();
        if let Some(sample_time_s) = self.sample_time_s {
            parts.push(format!("discrete time, T = {} s", number(sample_time_s)));
        }
        if let Some(delays_s) = &self.input_delays_s {
            parts.push(format!("input delays {} s", list(delays_s)));
        }
        if let Some(delays_s) = &self.output_delays_s {
            parts.push(format!("output delays {} s", list(delays_s)));
        }
        parts.join(", ")
    }

    /// Checks the timing for a model with `outputs` and `inputs`. Removes delays that are all zero,
    /// so that the model compares equal to one without delays.
    ///
    /// # Errors
    /// [`TimingError`] for a value out of range, or a wrong number of delays.
    pub(super) fn checked(self, outputs: usize, inputs: usize) -> Result<Self, TimingError> {
        if let Some(value) = self.sample_time_s
            && (!value.is_finite() || value <= 0.0)
        {
            return Err(TimingError::SampleTime(value));
        }
        Ok(Self {
            sample_time_s: self.sample_time_s,
            input_delays_s: checked_delays("input_delays_s", self.input_delays_s, inputs)?,
            output_delays_s: checked_delays("output_delays_s", self.output_delays_s, outputs)?,
        })
    }
}

/// Returns a channel delay \[s\]; zero without delays.
fn channel_delay(delays_s: Option<&[f64]>, channel: usize) -> f64 {
    let delay_s = delays_s.and_then(|delays_s| delays_s.get(channel));
    delay_s.copied().unwrap_or_default()
}

/// Lists numbers: "0.02, 0".
fn list(values: &[f64]) -> String {
    let numbers: Vec<String> = values.iter().map(|value| number(*value)).collect();
    numbers.join(", ")
}

/// Checks input or output delays; `None` if all are zero.
fn checked_delays(
    list: &'static str,
    delays: Option<Vec<f64>>,
    expected: usize,
) -> Result<Option<Vec<f64>>, TimingError> {
    let Some(delays) = delays else {
        return Ok(None);
    };
    if delays.len() != expected {
        return Err(TimingError::Count {
            list,
            expected,
            found: delays.len(),
        });
    }
    if let Some(index) = delays
        .iter()
        .position(|delay| !(0.0..=GREATEST_CHANNEL_DELAY_S).contains(delay))
    {
        return Err(TimingError::Delay {
            list,
            entry: index + 1,
            value: delays[index],
        });
    }
    if delays.iter().all(|delay| *delay == 0.0) {
        return Ok(None);
    }
    Ok(Some(delays))
}

#[cfg(test)]
mod timing_tests {
    use super::*;

    fn timing(sample_time_s: Option<f64>, input_delays_s: &[f64]) -> Timing {
        Timing {
            sample_time_s,
            input_delays_s: Some(input_delays_s.to_vec()),
            output_delays_s: None,
        }
    }

    #[test]
    fn zero_delays_are_removed() {
        assert!(timing(None, &[0.0, 0.0]).checked(1, 2).unwrap().is_plain());
        let delayed = timing(None, &[0.0, 0.02]).checked(1, 2).unwrap();
        assert_eq!((delayed.delay_s(0, 0), delayed.delay_s(0, 1)), (0.0, 0.02));
    }

    #[test]
    fn invalid_sample_times_and_delays_are_named() {
        let error = |timing: Timing| timing.checked(1, 2).unwrap_err();
        assert_eq!(error(timing(Some(0.0), &[])), TimingError::SampleTime(0.0));
        assert_eq!(
            error(timing(Some(f64::INFINITY), &[0.0; 2])),
            TimingError::SampleTime(f64::INFINITY)
        );
        let list = "input_delays_s";
        assert_eq!(
            error(timing(None, &[0.0])),
            TimingError::Count {
                list,
                expected: 2,
                found: 1
            }
        );
        assert_eq!(
            error(timing(None, &[0.0, -0.1])),
            TimingError::Delay {
                list,
                entry: 2,
                value: -0.1
            }
        );
        assert!(matches!(
            error(timing(None, &[f64::NAN, 61.0])),
            TimingError::Delay { entry: 1, .. }
        ));
    }

    #[test]
    fn a_timing_is_described() {
        let words = timing(Some(0.01), &[0.02, 0.0]).words();
        let mut numbers: Vec<f64> = Vec::new();
        for word in words.split([' ', ',']) {
            numbers.extend(word.parse::<f64>());
        }
        assert_eq!(numbers, [0.01, 0.02, 0.0], "{words}");
        assert_eq!(Timing::default().words(), "");
    }
}
