//! A linear-phase low-pass filter for flight records.

use std::f64::consts::{PI, TAU};

use nalgebra::DMatrix;

use super::flight_record::Segment;

/// Half the filter length, in periods of the cut-off frequency: a longer filter has a narrower
/// transition, and extends the signal farther at its ends.
const PERIODS: f64 = 4.0;
/// Share of the Nyquist frequency above which a cut-off frequency removes practically nothing.
const NEAR_NYQUIST: f64 = 0.8;
/// Maximum half length \[samples\]; only an unreasonably low cut-off frequency exceeds it.
const LONGEST: f64 = 1e5;

/// A symmetric finite impulse response: a Hamming-windowed sinc with unit sum.
///
/// ```text
/// h[n] = sin(wc n dt) / (pi n) (0.54 + 0.46 cos(pi n / M)) / sum,   n = -M ... M
/// M = ceil(4 * 2 pi / (wc dt))
/// ```
///
/// Here n counts samples, wc is the cut-off frequency \[rad/s\], dt the sample time \[s\], and
/// `sum` makes all h add up to 1. The phase is zero. All channels in a record pass through the same
/// filter, so that the responses between channels are unchanged. At both ends the signal is
/// extended by odd reflection, `2 x[0] - x[n]`.
#[derive(Clone, Debug, PartialEq)]
pub struct LowPass {
    /// Coefficients `h[0] ... h[M]`; the others follow by symmetry.
    half: Vec<f64>,
}

impl LowPass {
    /// Creates the filter with the cut-off frequency `omega` \[rad/s\] for a sample time \[s\].
    ///
    /// Returns `None` if `omega sample_time_s > 0.8 pi` (nothing to remove), if either argument is
    /// not positive, or if `M` would exceed 100 000.
    #[must_use]
    pub fn new(omega: f64, sample_time_s: f64) -> Option<Self> {
        // wc dt, in radians.
        let angle = omega * sample_time_s;
        if !(angle > 0.0 && angle <= NEAR_NYQUIST * PI) {
            return None;
        }
        let half_length = (PERIODS * TAU / angle).ceil();
        if half_length > LONGEST {
            return None;
        }
        let mut half: Vec<f64> = (0..=half_length as usize)
            .map(|n| windowed_sinc(n as f64, angle, half_length))
            .collect();
        let sum = half[0] + 2.0 * half.iter().skip(1).sum::<f64>();
        for h in &mut half {
            *h /= sum;
        }
        Some(Self { half })
    }

    /// Returns the filtered `samples`, as many as given.
    #[must_use]
    pub fn filter(&self, samples: &[f64]) -> Vec<f64> {
        self.filter_every(samples, 1)
    }

    /// Returns every `step`-th filtered sample, beginning with the first.
    fn filter_every(&self, samples: &[f64], step: usize) -> Vec<f64> {
        let reach = self.half.len() - 1;
        let extended = oddly_reflected(samples, reach);
        let mut filtered = Vec::with_capacity(samples.len().div_ceil(step));
        for centre in (reach..reach + samples.len()).step_by(step) {
            filtered.push(self.filtered_sample(&extended, centre));
        }
        filtered
    }

    /// Returns the filtered value at index `centre` in the extended signal.
    fn filtered_sample(&self, extended: &[f64], centre: usize) -> f64 {
        let sides: f64 = self
            .half
            .iter()
            .enumerate()
            .skip(1)
            .map(|(k, h)| h * (extended[centre - k] + extended[centre + k]))
            .sum();
        self.half[0] * extended[centre] + sides
    }

    /// Filters every channel in a segment with the cut-off frequency `omega` \[rad/s\]. Returns the
    /// segment unchanged if [`LowPass::new`] returns `None`.
    #[must_use]
    pub fn applied(omega: f64, segment: &Segment) -> Segment {
        Self::thinned(omega, 1, segment)
    }

    /// Filters as [`LowPass::applied`] does, but computes only every `step`-th sample, beginning
    /// with the first.
    ///
    /// The caller chooses a step that leaves half the sampling frequency well above `omega`. A
    /// segment that is not filtered is not thinned either.
    #[must_use]
    pub fn thinned(omega: f64, step: usize, segment: &Segment) -> Segment {
        let Some(low_pass) = Self::new(omega, segment.sample_time_s) else {
            return segment.clone();
        };
        let step = step.max(1);
        Segment {
            record: segment.record,
            start_s: segment.start_s,
            sample_time_s: segment.sample_time_s * step as f64,
            inputs: low_pass.filter_columns(&segment.inputs, step),
            outputs: low_pass.filter_columns(&segment.outputs, step),
        }
    }

    fn filter_columns(&self, samples: &DMatrix<f64>, step: usize) -> DMatrix<f64> {
        let rows = samples.nrows().div_ceil(step);
        let mut filtered = Vec::with_capacity(rows * samples.ncols());
        for column in samples.as_slice().chunks(samples.nrows().max(1)) {
            filtered.extend(self.filter_every(column, step));
        }
        DMatrix::from_vec(rows, samples.ncols(), filtered)
    }
}

/// Returns `sin(wc n dt) / (pi n)` times the Hamming window with half length `half_length`, with
/// `angle = wc dt`.
fn windowed_sinc(n: f64, angle: f64, half_length: f64) -> f64 {
    let sinc = if n == 0.0 {
        angle / PI
    } else {
        (angle * n).sin() / (PI * n)
    };
    sinc * (0.54 + 0.46 * (PI * n / half_length).cos())
}

/// Extends `samples` by `reach` values at each end, by repeated odd reflection; a single sample is
/// repeated.
fn oddly_reflected(samples: &[f64], reach: usize) -> Vec<f64> {
    let (Some(&first), Some(&last)) = (samples.first(), samples.last()) else {
        return Vec::new();
    };
    let length = samples.len();
    let mut extended = vec![first; length + 2 * reach];
    extended[reach..reach + length].copy_from_slice(samples);
    if length > 1 {
        let start = reach;
        let end = reach + length - 1;
        for k in 1..=reach {
            // Extend both ends together, so that the reflected samples exist already, however short
            // the signal is.
            extended[start - k] = 2.0 * first - extended[start + k];
            extended[end + k] = 2.0 * last - extended[end - k];
        }
    }
    extended
}
