//! Missing samples as unknowns in the likelihood (M14.21).
//!
//! A *hat* is a triangle in a gap, whose height is estimated together with each model (`cost`).
//!
//! ```text
//! true signal = signal filled by a straight line + sum_q c_q hat_q,   c_q the heights
//! dt sample time, T length of the segment, whi highest line used, gap = missing samples times dt
//! hat_q: linear B-splines, zero at both ends of the gap, at most pi/(2 whi) apart: a quarter of
//!     the shortest period
//!     count = ceil(2 whi (gap + dt) / pi), at most one a sample
//! b_q(omega) = dt / sqrt(T) sum_n hat_q(n) e^(-j omega n dt)
//! ```

use std::f64::consts::PI;
use std::ops::Range;

use nalgebra::Complex;

use gdcm_model::dataset::channel::ChannelSide;

/// Spectral lines of a hat function in a channel's gap.
#[derive(Clone, Debug, PartialEq)]
pub struct GapHat {
    /// Whether an input or an output misses the samples.
    pub side: ChannelSide,
    /// Channel index on its side, from 0.
    pub channel: usize,
    /// `b_q` at each line in the spectrum.
    pub lines: Vec<Complex<f64>>,
}

impl GapHat {
    /// Returns the hat at the lines with these indices.
    pub(crate) fn between(&self, lines: Range<usize>) -> Self {
        Self {
            side: self.side,
            channel: self.channel,
            lines: self.lines[lines].to_vec(),
        }
    }
}

/// A channel's missing samples within a segment.
#[derive(Clone, Debug, PartialEq)]
pub struct ChannelGap {
    /// Whether an input or an output misses the samples.
    pub side: ChannelSide,
    /// Channel index on its side, from 0.
    pub channel: usize,
    /// Indices of the missing samples; the segment's first and last sample are not among them.
    pub samples: Range<usize>,
}

/// A segment's sampling, and the highest line used.
#[derive(Clone, Copy, Debug)]
pub(crate) struct HatGrid {
    /// `dt` \[s\].
    pub(crate) sample_time_s: f64,
    /// `T` \[s\].
    pub(crate) duration_s: f64,
    /// `whi` \[rad/s\].
    pub(crate) highest: f64,
}

/// Returns how many hats describe `missing` samples for lines up to `highest` \[rad/s\].
pub(crate) fn hat_count(missing: usize, sample_time_s: f64, highest: f64) -> usize {
    // From the last sample before the gap to the first after it.
    let interval_s = (missing + 1) as f64 * sample_time_s;
    let wanted = (2.0 * highest * interval_s / PI).ceil() as usize;
    wanted.clamp(1, missing.max(1))
}

impl ChannelGap {
    /// Returns how many hats describe the missing samples.
    pub(crate) fn hat_count(&self, grid: HatGrid) -> usize {
        hat_count(self.samples.len(), grid.sample_time_s, grid.highest)
    }

    /// Computes all hats' lines at `omega` \[rad/s\].
    pub(crate) fn hats(&self, grid: HatGrid, omega: &[f64]) -> Vec<GapHat> {
        let count = self.hat_count(grid);
        // The knots divide the interval from the last sample before the gap to the first after it.
        let interval = (self.samples.len() + 1) as f64;
        let spacing = interval / (count + 1) as f64;
        let factor = grid.sample_time_s / grid.duration_s.sqrt();
        let mut hats = Vec::with_capacity(count);
        for hat in 1..=count {
            let centre = hat as f64 * spacing;
            let mut lines = vec![Complex::default(); omega.len()];
            for sample in self.samples.clone() {
                let position = (sample + 1 - self.samples.start) as f64;
                let height = 1.0 - (position - centre).abs() / spacing;
                if height <= 0.0 {
                    continue;
                }
                let time_s = sample as f64 * grid.sample_time_s;
                for (line, omega) in lines.iter_mut().zip(omega) {
                    *line += Complex::from_polar(factor * height, -omega * time_s);
                }
            }
            hats.push(GapHat {
                side: self.side,
                channel: self.channel,
                lines,
            });
        }
        hats
    }
}
