//! Computes a channel's power over time and frequency, which shows a sweep in a long record.

use std::f64::consts::TAU;

use nalgebra::DMatrix;

use gdcm_model::executor::Sequential;
use gdcm_model::simulation::Segment;
use gdcm_model::statistics::median;

use crate::spectra::spectrum::{Spectrum, spectra};

/// A channel's power over time and frequency.
///
/// ```text
/// windows  Hann, 0.15 times the record, between 4 s and 20 s; one every eighth of their length,
///          or fewer so that there are at most 401
/// power    |U(omega_k)|^2, from the samples in the window less their mean (M14.2); missing samples
///          count as the mean
/// rows     frequencies evenly in ln(omega), from two periods in a window up to `highest`: the
///          maximum of the lines within half a row, or the next line above
/// level    10 log10(power / maximum power), at least FLOOR
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Spectrogram {
    /// Centres of the first and the last window \[s\].
    pub time_s: [f64; 2],
    /// Frequencies in the first and the last row \[rad/s\].
    pub omega: [f64; 2],
    /// Levels \[dB\], as `levels[window][row]`.
    pub levels: Vec<Vec<f64>>,
}

/// Window length as a fraction of the record length.
const WINDOW_SHARE: f64 = 0.15;
/// Shortest window \[s\].
const SHORTEST_WINDOW_S: f64 = 4.0;
/// Longest window \[s\].
const LONGEST_WINDOW_S: f64 = 20.0;
/// Minimum number of samples in a window.
const FEWEST_SAMPLES: usize = 8;
/// Number of steps from window to window in a window length.
const STEPS_A_WINDOW: usize = 8;
/// Maximum number of steps from the first window to the last: one less than windows.
const MOST_STEPS: usize = 400;
/// Highest frequency, as a fraction of half the sample rate.
const HIGHEST_OF_RATE: f64 = 0.9;

/// Frequency up to which lines are computed, relative to the last row: more than half a row above it.
const ABOVE_HIGHEST: f64 = 1.1;

impl Spectrogram {
    /// Number of frequency rows.
    pub const ROWS: usize = 64;
    /// Level \[dB\] to which lower levels are raised.
    pub const FLOOR: f64 = -40.0;

    /// Computes the spectrogram up to `highest` \[rad/s\]; `None` if the record is shorter than a
    /// window, a window has fewer than 8 samples, or the usable frequencies span at most an octave.
    #[must_use]
    pub fn new(time_s: &[f64], samples: &[f64], highest: f64) -> Option<Self> {
        let windows = Windows::new(time_s, samples.len())?;
        let rows = FrequencyRows::new(&windows, highest)?;
        let segments: Vec<Segment> = windows
            .starts
            .iter()
            .map(|&from| windowed(&samples[from..from + windows.length], windows.step_s))
            .collect();
        let mut powers = Vec::with_capacity(segments.len());
        for spectrum in spectra(&segments, ABOVE_HIGHEST * rows.highest, &Sequential) {
            powers.push(rows.powers(&spectrum));
        }
        let first = windows.starts[0];
        let last = windows.starts[windows.starts.len() - 1];
        Some(Self {
            time_s: [
                time_s[first] + 0.5 * windows.seconds,
                time_s[last] + 0.5 * windows.seconds,
            ],
            omega: [rows.lowest, rows.highest],
            levels: levels(&powers),
        })
    }
}

/// Windows along a record.
struct Windows {
    /// Sample time \[s\].
    step_s: f64,
    /// Window length \[s\].
    seconds: f64,
    /// Window length in samples.
    length: usize,
    /// Index of each window's first sample.
    starts: Vec<usize>,
}

impl Windows {
    /// Places windows along samples at these times; `None` if a window has too few samples or is
    /// longer than the record.
    fn new(time_s: &[f64], samples: usize) -> Option<Self> {
        let mut steps: Vec<f64> = time_s
            .windows(2)
            .map(|pair| pair[1] - pair[0])
            .filter(|step| *step > 0.0)
            .collect();
        if steps.is_empty() {
            return None;
        }
        let step_s = median(&mut steps);
        let seconds =
            (WINDOW_SHARE * step_s * samples as f64).clamp(SHORTEST_WINDOW_S, LONGEST_WINDOW_S);
        let length = (seconds / step_s) as usize;
        if length < FEWEST_SAMPLES || length > samples {
            return None;
        }
        let hop = (length / STEPS_A_WINDOW)
            .max((samples - length).div_ceil(MOST_STEPS))
            .max(1);
        Some(Self {
            step_s,
            seconds,
            length,
            starts: (0..=samples - length).step_by(hop).collect(),
        })
    }
}

/// Row frequencies, evenly spaced in ln(omega).
struct FrequencyRows {
    /// Frequency in the first row \[rad/s\].
    lowest: f64,
    /// Frequency in the last row \[rad/s\].
    highest: f64,
    /// Frequency ratio between neighbouring rows.
    ratio: f64,
}

impl FrequencyRows {
    /// Spaces rows from the frequency with two periods in a window to `highest` \[rad/s\], or to
    /// 0.9 times half the sample rate if that is lower; `None` if these span at most an octave.
    fn new(windows: &Windows, highest: f64) -> Option<Self> {
        let lowest = 2.0 * TAU / windows.seconds;
        let highest = highest.min(HIGHEST_OF_RATE * TAU / (2.0 * windows.step_s));
        if highest <= 2.0 * lowest {
            return None;
        }
        let ratio = (highest / lowest).powf(1.0 / (Spectrogram::ROWS - 1) as f64);
        Some(Self {
            lowest,
            highest,
            ratio,
        })
    }

    /// Returns a window's power in each row.
    fn powers(&self, spectrum: &Spectrum) -> Vec<f64> {
        let mut powers = Vec::with_capacity(Spectrogram::ROWS);
        for row in 0..Spectrogram::ROWS {
            let omega = self.lowest * self.ratio.powi(row as i32);
            powers.push(self.power_at(spectrum, omega));
        }
        powers
    }

    /// Returns the largest power among the lines within half a row of `omega`; if there are none,
    /// the power at the next line above.
    fn power_at(&self, spectrum: &Spectrum, omega: f64) -> f64 {
        let lines = &spectrum.omega;
        let half_row = self.ratio.sqrt();
        let first_inside = lines.partition_point(|line| *line < omega / half_row);
        let end_inside = lines.partition_point(|line| *line <= omega * half_row);
        let inside = if first_inside < end_inside {
            first_inside..end_inside
        } else {
            // No line is within half a row: the next above, or the last if none is above.
            let next = lines
                .partition_point(|line| *line < omega)
                .min(lines.len().saturating_sub(1));
            next..(next + 1).min(lines.len())
        };
        inside
            .map(|line| spectrum.inputs[(0, line)].norm_sqr())
            .fold(0.0, f64::max)
    }
}

/// Converts powers to levels \[dB\] relative to the maximum power.
fn levels(powers: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let greatest = powers
        .iter()
        .flatten()
        .copied()
        .fold(f64::MIN_POSITIVE, f64::max);
    powers
        .iter()
        .map(|window| window.iter().map(|power| level(*power, greatest)).collect())
        .collect()
}

/// Converts a power to a level \[dB\] relative to `greatest`.
fn level(power: f64, greatest: f64) -> f64 {
    let ratio = (power / greatest).max(f64::MIN_POSITIVE);
    (10.0 * ratio.log10()).max(Spectrogram::FLOOR)
}

/// Returns the samples in a Hann window, with their mean removed; zero where missing.
fn windowed(samples: &[f64], sample_time_s: f64) -> Segment {
    let finite: Vec<f64> = samples
        .iter()
        .copied()
        .filter(|sample| sample.is_finite())
        .collect();
    let mean = finite.iter().sum::<f64>() / finite.len().max(1) as f64;
    let inputs = DMatrix::from_fn(samples.len(), 1, |at, _| {
        let weight = 0.5 - 0.5 * (TAU * at as f64 / samples.len() as f64).cos();
        if samples[at].is_finite() {
            weight * (samples[at] - mean)
        } else {
            0.0
        }
    });
    Segment {
        record: 0,
        start_s: 0.0,
        sample_time_s,
        inputs,
        outputs: DMatrix::zeros(samples.len(), 0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sweep_is_a_ridge_at_its_own_frequency() {
        // A sweep from 2 to 12 rad/s within 100 s.
        let time_s: Vec<f64> = (0..5000).map(|k| 0.02 * f64::from(k)).collect();
        let samples: Vec<f64> = time_s
            .iter()
            .map(|t| 50.0 + 5.0 * (2.0 * t + 0.05 * t * t).sin())
            .collect();
        let found = Spectrogram::new(&time_s, &samples, 20.0).unwrap();
        let count = found.levels.len();
        let ratio = (found.omega[1] / found.omega[0]).powf(1.0 / (Spectrogram::ROWS - 1) as f64);
        for (place, levels) in found.levels.iter().enumerate() {
            let time = found.time_s[0]
                + (found.time_s[1] - found.time_s[0]) * place as f64 / (count - 1) as f64;
            let ridge = (0..Spectrogram::ROWS)
                .max_by(|a, b| levels[*a].total_cmp(&levels[*b]))
                .unwrap();
            let omega = found.omega[0] * ratio.powi(ridge as i32);
            // Tolerance: the resolution of a window of 15 s, whose lines are 0.42 rad/s apart, plus
            // half the change of the sweep within it.
            assert!(
                (omega - (2.0 + 0.1 * time)).abs() < 0.42 + 0.75,
                "{time} s: {omega}"
            );
        }
        assert!(
            found
                .levels
                .iter()
                .flatten()
                .all(|level| (Spectrogram::FLOOR..=0.0).contains(level))
        );
    }

    fn times(count: u32, step: f64) -> Vec<f64> {
        (0..count).map(|k| step * f64::from(k)).collect()
    }

    #[test]
    fn short_coarse_and_empty_records_have_no_spectrogram() {
        let short = times(100, 0.02);
        assert_eq!(Spectrogram::new(&short, &[1.0; 100], 12.0), None, "2 s");
        let coarse = times(100, 5.0);
        assert_eq!(
            Spectrogram::new(&coarse, &[1.0; 100], 12.0),
            None,
            "too few samples a window"
        );
        assert_eq!(Spectrogram::new(&[], &[], 12.0), None);
    }

    #[test]
    fn a_record_with_gaps_only_is_at_the_floor() {
        let gaps = Spectrogram::new(&times(2000, 0.02), &[f64::NAN; 2000], 12.0).unwrap();
        for level in gaps.levels.iter().flatten() {
            assert_eq!(*level, Spectrogram::FLOOR);
        }
    }
}
