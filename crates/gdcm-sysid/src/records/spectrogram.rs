//! Power of a channel over time and frequency, which shows a sweep in a long record.

use std::f64::consts::TAU;

use nalgebra::DMatrix;

use gdcm_model::executor::Sequential;
use gdcm_model::simulation::Segment;
use gdcm_model::statistics::median;

use crate::identification::spectra;

/// Power of a channel over time and frequency.
///
/// ```text
/// windows  Hann, of 0.15 of the record within 4 s and 20 s, an eighth of their length apart (farther where there were too many)
/// power    |U(omega_k)|^2 of the samples in the window less their mean (M14, 2); what is missing counts as the mean
/// rows     frequencies evenly in ln(omega), from two periods a window to the highest: the greatest line within half a row
/// level    10 log10 of the power over the greatest, not less than FLOOR
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Spectrogram {
    /// Centres of the first and of the last window \[s\].
    pub time_s: [f64; 2],
    /// Frequencies of the first and of the last row \[rad/s\].
    pub omega: [f64; 2],
    /// Level of each row in each window \[dB\].
    pub levels: Vec<Vec<f64>>,
}

impl Spectrogram {
    /// Number of rows in every window.
    pub const ROWS: usize = 64;
    /// The lowest reported level \[dB\].
    pub const FLOOR: f64 = -40.0;

    /// Computes the spectrogram of samples at these times up to `highest` \[rad/s\]; `None` if the
    /// record is shorter than a window, or no frequency is resolved by a window.
    #[must_use]
    pub fn of(time_s: &[f64], samples: &[f64], highest: f64) -> Option<Self> {
        /// Largest number of windows.
        const MOST: usize = 400;
        let mut steps: Vec<f64> = time_s
            .windows(2)
            .map(|pair| pair[1] - pair[0])
            .filter(|step| *step > 0.0)
            .collect();
        let step_s = median(&mut steps);
        let seconds = (0.15 * step_s * samples.len() as f64).clamp(4.0, 20.0);
        let length = (seconds / step_s) as usize;
        if steps.is_empty() || length < 8 || length > samples.len() {
            return None;
        }
        let hop = (length / 8)
            .max((samples.len() - length).div_ceil(MOST))
            .max(1);
        let starts: Vec<usize> = (0..=samples.len() - length).step_by(hop).collect();
        let segments: Vec<Segment> = starts
            .iter()
            .map(|&from| window(&samples[from..from + length], step_s))
            .collect();
        let lowest = 2.0 * TAU / seconds;
        let highest = highest.min(0.9 * TAU / (2.0 * step_s));
        if highest <= 2.0 * lowest {
            return None;
        }
        let lines = spectra(&segments, 1.1 * highest, &Sequential);
        let ratio = (highest / lowest).powf(1.0 / (Self::ROWS - 1) as f64);
        let row = |row: usize| lowest * ratio.powi(row as i32);
        let power = |of: &crate::identification::spectrum::Spectrum, omega: f64| {
            let nearest = of
                .omega
                .partition_point(|line| *line < omega)
                .min(of.omega.len().saturating_sub(1));
            let until = of
                .omega
                .partition_point(|line| *line <= omega * ratio.sqrt());
            let from = of
                .omega
                .partition_point(|line| *line < omega / ratio.sqrt())
                .min(nearest);
            let lines = from..until.max(from + 1).min(of.omega.len());
            lines
                .map(|line| of.inputs[(0, line)].norm_sqr())
                .fold(0.0, f64::max)
        };
        let powers: Vec<Vec<f64>> = lines
            .iter()
            .map(|of| (0..Self::ROWS).map(|at| power(of, row(at))).collect())
            .collect();
        let greatest = powers
            .iter()
            .flatten()
            .copied()
            .fold(f64::MIN_POSITIVE, f64::max);
        let level = |power: f64| {
            (10.0 * (power / greatest).max(f64::MIN_POSITIVE).log10()).max(Self::FLOOR)
        };
        let middle = |from: usize| time_s[from] + 0.5 * seconds;
        Some(Self {
            time_s: [middle(starts[0]), middle(starts[starts.len() - 1])],
            omega: [lowest, highest],
            levels: powers
                .into_iter()
                .map(|of| of.into_iter().map(level).collect())
                .collect(),
        })
    }
}

/// Returns the samples in a Hann window, with their mean removed.
fn window(samples: &[f64], sample_time_s: f64) -> Segment {
    let finite = || samples.iter().copied().filter(|sample| sample.is_finite());
    let mean = finite().sum::<f64>() / finite().count().max(1) as f64;
    let weight = |at: usize| 0.5 - 0.5 * (TAU * at as f64 / samples.len() as f64).cos();
    let value = |at: usize| {
        if samples[at].is_finite() {
            weight(at) * (samples[at] - mean)
        } else {
            0.0
        }
    };
    let inputs = DMatrix::from_fn(samples.len(), 1, |at, _| value(at));
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
        let found = Spectrogram::of(&time_s, &samples, 20.0).unwrap();
        let count = found.levels.len();
        let ratio = (found.omega[1] / found.omega[0]).powf(1.0 / (Spectrogram::ROWS - 1) as f64);
        for (place, levels) in found.levels.iter().enumerate() {
            let time = found.time_s[0]
                + (found.time_s[1] - found.time_s[0]) * place as f64 / (count - 1) as f64;
            let ridge = (0..Spectrogram::ROWS)
                .max_by(|a, b| levels[*a].total_cmp(&levels[*b]))
                .unwrap();
            let omega = found.omega[0] * ratio.powi(ridge as i32);
            // Within the resolution of a window of 15 s, whose lines are 0.42 rad/s apart, and half
            // of the change of the sweep within it.
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

    #[test]
    fn a_short_record_a_coarse_one_and_nothing_but_gaps_have_words_elsewhere_and_no_numbers_here() {
        let times = |count: u32, step: f64| {
            (0..count)
                .map(|k| step * f64::from(k))
                .collect::<Vec<f64>>()
        };
        assert_eq!(
            Spectrogram::of(&times(100, 0.02), &[1.0; 100], 12.0),
            None,
            "2 s"
        );
        assert_eq!(
            Spectrogram::of(&times(100, 5.0), &[1.0; 100], 12.0),
            None,
            "too few samples a window"
        );
        assert_eq!(Spectrogram::of(&[], &[], 12.0), None);
        let gaps = Spectrogram::of(&times(2000, 0.02), &[f64::NAN; 2000], 12.0).unwrap();
        assert!(
            gaps.levels
                .iter()
                .flatten()
                .all(|level| *level == Spectrogram::FLOOR)
        );
    }
}
