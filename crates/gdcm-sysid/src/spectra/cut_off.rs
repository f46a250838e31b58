//! Cut-off of the zero-phase low-pass before the Laguerre projections (M14.1).

use gdcm_model::executor::{Executor, each};
use gdcm_model::simulation::{LowPass, Segment};

use super::spectrum::spectra;

/// Ratio of the cut-off to the highest line used, without vibration (M14.1).
const USUAL: f64 = 5.0;
/// Ratio of the cut-off to the highest line used, if an output vibrates (M14.1).
const VIBRATING: f64 = 2.0;
/// An output vibrates if more than this share of its variance lies above `VIBRATING` times the
/// highest line used.
const VIBRATION_SHARE: f64 = 0.3;

/// The cut-off frequency, and the outputs that lowered it.
#[derive(Clone, Debug, PartialEq)]
pub struct CutOff {
    /// Cut-off frequency \[rad/s\].
    pub omega: f64,
    /// Vibrating outputs, counted from 0, each with the share of its variance above twice the
    /// highest line used.
    pub vibrating: Vec<(usize, f64)>,
}

impl CutOff {
    /// Chooses the cut-off for `segments` and lines up to `highest` \[rad/s\]: 5 `highest`, or 2
    /// `highest` if more than 30 % of the variance of an output lies above 2 `highest` (M14.1).
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
            vibrating,
        }
    }

    /// Filters every channel, unless the cut-off is above half the sampling frequency.
    #[must_use]
    pub fn apply(&self, segments: &[Segment], executor: &dyn Executor) -> Vec<Segment> {
        each(executor, segments, |segment| {
            LowPass::applied(self.omega, segment)
        })
    }
}
