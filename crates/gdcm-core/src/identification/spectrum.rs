//! The lines of a segment's Fourier transform.

use super::*;
use gdcm_numerics::{FourierPlanner, FourierTransform};
use std::f64::consts::{PI, TAU};

/// The lines of one segment (M14, 2): one column a line, one row a channel.
///
/// ```text
/// U(omega_k) = dt / sqrt(T) sum_n u[n] e^(-j omega_k n dt),   omega_k = 2 pi k / T,   T = N dt,   k >= 1
/// ```
///
/// No window, and no mean taken off but for arithmetic: lines from k = 1 do not hold it.
#[derive(Clone, Debug, PartialEq)]
pub struct Spectrum {
    /// Which of the records the segment is of, counted from 0.
    pub record: usize,
    /// `T` \[s\].
    pub duration_s: f64,
    /// `omega_k` \[rad/s\], ascending.
    pub omega: Vec<f64>,
    /// `U`, inputs x lines.
    pub inputs: DMatrix<Complex<f64>>,
    /// `Y`, outputs x lines.
    pub outputs: DMatrix<Complex<f64>>,
}

impl Spectrum {
    /// The lines with `lowest <= omega_k <= highest` \[rad/s\].
    #[must_use]
    pub fn between(&self, lowest: f64, highest: f64) -> Self {
        let from = self.omega.partition_point(|&w| w < lowest);
        let to = self.omega.partition_point(|&w| w <= highest).max(from);
        Self {
            record: self.record,
            duration_s: self.duration_s,
            omega: self.omega[from..to].to_vec(),
            inputs: self.inputs.columns(from, to - from).into_owned(),
            outputs: self.outputs.columns(from, to - from).into_owned(),
        }
    }
}

/// The lines of every segment up to `highest` \[rad/s\] and below half the sampling frequency, in the order of the segments.
#[must_use]
pub fn spectra(segments: &[Segment], highest: f64, executor: &dyn Executor) -> Vec<Spectrum> {
    let mut planner = FourierPlanner::default();
    let plans: Vec<_> = segments.iter().map(|segment| planner.plan(segment.inputs.nrows())).collect();
    each(executor, segments.iter().zip(plans), |(segment, plan)| spectrum(segment, highest, &plan))
}

/// The lines of one segment up to `highest`, by the transform `plan` of its length.
fn spectrum(segment: &Segment, highest: f64, plan: &FourierTransform) -> Spectrum {
    let duration_s = segment.sample_time_s * segment.inputs.nrows() as f64;
    let below_nyquist = segment.inputs.nrows().saturating_sub(1) / 2;
    let omega: Vec<f64> =
        (1..=below_nyquist).map(|k| TAU * k as f64 / duration_s).take_while(|&w| w <= highest).collect();
    let factor = segment.sample_time_s / duration_s.sqrt();
    let inputs = transform(&segment.inputs, omega.len(), factor, plan);
    let outputs = transform(&segment.outputs, omega.len(), factor, plan);
    Spectrum { record: segment.record, duration_s, omega, inputs, outputs }
}

/// Spectral lines 1 to `lines` of each column of `samples`, times `factor`: one row a channel.
fn transform(samples: &DMatrix<f64>, lines: usize, factor: f64, plan: &FourierTransform) -> DMatrix<Complex<f64>> {
    let mut transformed = DMatrix::zeros(samples.ncols(), lines);
    if lines == 0 {
        return transformed;
    }
    for (channel, column) in samples.column_iter().enumerate() {
        let mean = column.mean();
        let mut centred: Vec<f64> = column.iter().map(|sample| sample - mean).collect();
        let spectrum = plan.of(&mut centred).unwrap_or_default();
        let row = transformed.row_mut(channel);
        row.into_iter().zip(spectrum.iter().skip(1)).for_each(|(y, line)| *y = line * factor);
    }
    transformed
}

// The zero-phase low-pass before the Laguerre projections and the comparison in time.

/// Cut-off over the highest line used, where there is no vibration (M14, 1.5).
const USUAL: f64 = 5.0;
/// Cut-off over the highest line used, where an output vibrates (M14, 1.5).
const VIBRATING: f64 = 2.0;
/// An output vibrates when more than this share of its variance lies above `VIBRATING` times the highest line used.
const VIBRATION_SHARE: f64 = 0.3;
/// Half length of the filter in periods of the cut-off.
const PERIODS: f64 = 4.0;
/// Above this share of half the sampling frequency there is nothing to filter.
const NEAR_NYQUIST: f64 = 0.8;
/// The longest half length in samples; more is asked for only by an absurd cut-off.
const LONGEST: f64 = 1e5;

/// A symmetric finite impulse response: a sinc in a Hamming window, of unit sum.
///
/// ```text
/// h[n] ~ sin(wc n dt) / (pi n) (0.54 + 0.46 cos(pi n / M)),   n = -M ... M,   M = ceil(4 * 2 pi / (wc dt))
/// ```
///
/// It moves no phase, and as every channel of a record goes through the same one, the response between them stays what it
/// was. At both ends the signal goes on as its odd reflection, `2 x[0] - x[n]`.
#[derive(Clone, Debug, PartialEq)]
pub struct LowPass {
    /// `h[0] ... h[M]`.
    half: Vec<f64>,
}

impl LowPass {
    /// The filter with cut-off `omega` \[rad/s\] for a sample time \[s\]; none where `omega dt > 0.8 pi`, for then there is
    /// nothing to take off, where either is not greater than 0, and where `M` would be over 100 000.
    #[must_use]
    pub fn new(omega: f64, sample_time_s: f64) -> Option<Self> {
        let step = omega * sample_time_s;
        if !(step > 0.0 && step <= NEAR_NYQUIST * PI) {
            return None;
        }
        let length = (PERIODS * TAU / step).ceil();
        if length > LONGEST {
            return None;
        }
        let tap = |n: usize| {
            let n = n as f64;
            let sinc = if n == 0.0 { step / PI } else { (step * n).sin() / (PI * n) };
            sinc * (0.54 + 0.46 * (PI * n / length).cos())
        };
        let mut half: Vec<f64> = (0..=length as usize).map(tap).collect();
        let sum = half[0] + 2.0 * half.iter().skip(1).sum::<f64>();
        half.iter_mut().for_each(|h| *h /= sum);
        Some(Self { half })
    }

    /// `samples`, filtered.
    #[must_use]
    pub fn filter(&self, samples: &[f64]) -> Vec<f64> {
        let reach = self.half.len() - 1;
        let extended = oddly_reflected(samples, reach);
        let filtered = |n: usize| {
            let centre = n + reach;
            let sides = |(k, h): (usize, &f64)| h * (extended[centre - k] + extended[centre + k]);
            self.half[0] * extended[centre] + self.half.iter().enumerate().skip(1).map(sides).sum::<f64>()
        };
        (0..samples.len()).map(filtered).collect()
    }

    /// Every channel of a segment through the filter with cut-off `omega` \[rad/s\]; as it is where there is nothing to take off.
    #[must_use]
    pub fn applied(omega: f64, segment: &Segment) -> Segment {
        let Some(low_pass) = Self::new(omega, segment.sample_time_s) else { return segment.clone() };
        let side = |samples: &DMatrix<f64>| {
            let filtered: Vec<f64> =
                samples.as_slice().chunks(samples.nrows().max(1)).flat_map(|x| low_pass.filter(x)).collect();
            DMatrix::from_vec(samples.nrows(), samples.ncols(), filtered)
        };
        Segment { inputs: side(&segment.inputs), outputs: side(&segment.outputs), ..segment.clone() }
    }
}

/// `samples` with `reach` more at each end, reflected oddly as often as it takes; a single sample goes on as it is.
fn oddly_reflected(samples: &[f64], reach: usize) -> Vec<f64> {
    let Some((&first, &last)) = samples.first().zip(samples.last()) else {
        return Vec::new();
    };
    let length = samples.len();
    let mut extended = vec![first; length + 2 * reach];
    extended[reach..reach + length].copy_from_slice(samples);
    if length > 1 {
        let (start, end) = (reach, reach + length - 1);
        for k in 1..=reach {
            // Both ends grow together, so that what is reflected is there by then, however short the signal.
            extended[start - k] = 2.0 * first - extended[start + k];
            extended[end + k] = 2.0 * last - extended[end - k];
        }
    }
    extended
}

/// Where the low-pass cuts off, and which outputs made it cut low.
#[derive(Clone, Debug, PartialEq)]
pub struct CutOff {
    /// Cut-off \[rad/s\].
    pub omega: f64,
    /// Outputs that vibrate: which, counted from 0, and the share of their variance above twice the highest line used.
    pub vibrating: Vec<(usize, f64)>,
}

impl CutOff {
    /// The cut-off for `segments` when lines up to `highest` \[rad/s\] are used: 5 `highest`, or 2 `highest` when more than 30 %
    /// of the variance of an output lies above that (M14, 1.5).
    #[must_use]
    pub fn choose(segments: &[Segment], highest: f64, executor: &dyn Executor) -> Self {
        let outputs = segments.first().map_or(0, |segment| segment.outputs.ncols());
        let (mut all, mut above) = (vec![0.0; outputs], vec![0.0; outputs]);
        for spectrum in spectra(segments, f64::INFINITY, executor) {
            for (k, omega) in spectrum.omega.iter().enumerate() {
                for (output, line) in spectrum.outputs.column(k).iter().enumerate().take(outputs) {
                    all[output] += line.norm_sqr();
                    above[output] += if *omega > VIBRATING * highest { line.norm_sqr() } else { 0.0 };
                }
            }
        }
        let shares = above.iter().zip(&all).map(|(above, all)| above / all);
        let vibrating: Vec<_> = shares.enumerate().filter(|(_, share)| *share > VIBRATION_SHARE).collect();
        Self { omega: highest * if vibrating.is_empty() { USUAL } else { VIBRATING }, vibrating }
    }

    /// `segments`, every channel through the low-pass of this cut-off; as they are where there is nothing to take off.
    #[must_use]
    pub fn apply(&self, segments: &[Segment], executor: &dyn Executor) -> Vec<Segment> {
        each(executor, segments, |segment| LowPass::applied(self.omega, segment))
    }
}
