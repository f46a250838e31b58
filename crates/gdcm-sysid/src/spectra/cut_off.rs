//! Chooses the cut-off frequency for the zero-phase low-pass before the Laguerre projections, and
//! the sampling after it (M14.1).
//!
//! ```text
//! wc cut-off, whi highest line used, dt sample time
//! wc = 5 whi, or 2 whi if an output vibrates: over 30 % of its variance lies above 2 whi
//! D = floor(2 pi / (20 whi dt)), at least 1:  the projections use every D-th filtered sample
//! ```
//!
//! The projections are those of CT-PBSID (`subspace`). If samples are thinned, half the remaining
//! sampling frequency is at least 10 whi, so that only frequencies above 18 whi could alias to the
//! lines used, and the low-pass lets less than 1/500 of them pass. Spectra are computed from all
//! samples.

use std::f64::consts::TAU;

use gdcm_model::executor::{Executor, each};
use gdcm_model::simulation::{LowPass, Segment};

use super::spectrum::spectra;

/// Ratio of the cut-off to the highest line used, without vibration (M14.1).
const USUAL: f64 = 5.0;
/// Ratio of the cut-off to the highest line used, if an output vibrates (M14.1).
const VIBRATING: f64 = 2.0;
/// Sampling frequency that the projections need, relative to the highest line used (M14.1).
const SAMPLING: f64 = 20.0;
/// Relative tolerance in the thinning factor, so that a rounded sample time does not lower it by 1.
const ROUNDING: f64 = 1e-9;
/// An output vibrates if more than this share of its variance lies above `VIBRATING` times the
/// highest line used.
const VIBRATION_SHARE: f64 = 0.3;

/// The cut-off frequency, and the outputs that lowered it.
#[derive(Clone, Debug, PartialEq)]
pub struct CutOff {
    /// Cut-off frequency \[rad/s\].
    pub omega: f64,
    /// Highest line used \[rad/s\].
    pub highest: f64,
    /// Vibrating outputs, by index from 0, each with the share of its variance above twice the
    /// highest line used.
    pub vibrating: Vec<(usize, f64)>,
}

impl CutOff {
    /// Chooses the cut-off for `segments` and lines up to `highest` \[rad/s\]: 5 `highest`, or 2
    /// `highest` if more than 30 % of an output's variance lies above 2 `highest` (M14.1).
    #[must_use]
    pub fn choose(segments: &[Segment], highest: f64, executor: &dyn Executor) -> Self {
        let outputs = segments
            .first()
            .map_or(0, |segment| segment.outputs.ncols());
        let mut total = vec![0.0; outputs];
        let mut above = vec![0.0; outputs];
        for spectrum in spectra(segments, f64::INFINITY, executor) {
            for (k, omega) in spectrum.omega.iter().enumerate() {
                let is_above = *omega > VIBRATING * highest;
                for (output, line) in spectrum.outputs.column(k).iter().enumerate().take(outputs) {
                    total[output] += line.norm_sqr();
                    if is_above {
                        above[output] += line.norm_sqr();
                    }
                }
            }
        }
        let mut vibrating = Vec::new();
        for (output, (above, total)) in above.iter().zip(&total).enumerate() {
            let share = above / total;
            if share > VIBRATION_SHARE {
                vibrating.push((output, share));
            }
        }
        let factor = if vibrating.is_empty() {
            USUAL
        } else {
            VIBRATING
        };
        Self {
            omega: highest * factor,
            highest,
            vibrating,
        }
    }

    /// Filters every channel, and thins records that are logged much faster than the highest line
    /// used needs. Segments are unchanged if the cut-off is above 0.8 times half the sampling
    /// frequency.
    #[must_use]
    pub fn apply(&self, segments: &[Segment], executor: &dyn Executor) -> Vec<Segment> {
        each(executor, segments, |segment| {
            LowPass::thinned(self.omega, self.step(segment.sample_time_s), segment)
        })
    }

    /// Returns `D`: every D-th sample is kept.
    fn step(&self, sample_time_s: f64) -> usize {
        let steps = TAU / (SAMPLING * self.highest * sample_time_s);
        if steps.is_finite() {
            ((steps * (1.0 + ROUNDING)) as usize).max(1)
        } else {
            1
        }
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use nalgebra::DMatrix;

    use gdcm_model::executor::Sequential;

    use super::*;

    /// Highest line used \[rad/s\].
    const HIGHEST: f64 = 16.0;

    /// Returns a segment with a wave of this frequency in an input and an output.
    fn wave(omega: f64, sample_time_s: f64, samples: usize) -> Segment {
        let channel = DMatrix::from_fn(samples, 1, |n, _| {
            (omega * n as f64 * sample_time_s + 0.3).sin()
        });
        Segment {
            record: 0,
            start_s: 2.0,
            sample_time_s,
            inputs: channel.clone(),
            outputs: channel,
        }
    }

    fn usual() -> CutOff {
        CutOff {
            omega: USUAL * HIGHEST,
            highest: HIGHEST,
            vibrating: Vec::new(),
        }
    }

    fn applied(segment: &Segment) -> Segment {
        usual()
            .apply(std::slice::from_ref(segment), &Sequential)
            .remove(0)
    }

    #[test]
    fn records_are_thinned_to_no_less_than_twenty_times_the_highest_line() {
        // 20 whi / (2 pi) = 50.9 Hz.
        for (rate_hz, step) in [(50.0, 1), (100.0, 1), (102.0, 2), (250.0, 4), (1000.0, 19)] {
            assert_eq!(usual().step(1.0 / rate_hz), step, "{rate_hz} Hz");
        }
        let thinned = applied(&wave(3.0, 0.004, 15_001));
        assert_eq!(thinned.inputs.nrows(), 3751);
        assert_eq!(thinned.start_s, 2.0);
        assert!((thinned.sample_time_s - 0.016).abs() < 1e-15);
    }

    #[test]
    fn the_samples_kept_are_the_filtered_ones_at_their_times() {
        let segment = wave(HIGHEST, 0.004, 5000);
        let thinned = applied(&segment);
        let filtered = LowPass::applied(usual().omega, &segment);
        // The filter has no phase: away from the ends the wave keeps its times, and its size
        // changes by less than 2e-3.
        for n in 0..thinned.inputs.nrows() {
            assert_eq!(thinned.outputs[n], filtered.outputs[4 * n]);
        }
        let gain = thinned.inputs[600] / (HIGHEST * 600.0 * 0.016 + 0.3).sin();
        assert!((gain - 1.0).abs() < 2e-3, "{gain}");
        for n in 100..1100 {
            let time_s = n as f64 * thinned.sample_time_s;
            let expected = gain * (HIGHEST * time_s + 0.3).sin();
            assert!((thinned.inputs[n] - expected).abs() < 1e-9);
        }
    }

    #[test]
    fn what_would_appear_at_the_lines_used_is_removed() {
        // At 62.5 Hz these frequencies appear at 0 to 21 rad/s, the lines of the measured response.
        let rate = TAU / 0.016;
        for alias in [-20.8, -10.0, 0.5, 10.0, 20.8, 16.0 + rate] {
            let thinned = applied(&wave(rate + alias, 0.004, 20_000));
            let middle = thinned.inputs.rows(500, 4000);
            assert!(middle.amax() < 1.0 / 500.0, "{alias}: {}", middle.amax());
        }
        const { assert!(PI / 0.016 > 10.0 * HIGHEST) };
    }
}
