//! The lines of a segment's Fourier transform.

use std::f64::consts::TAU;

use nalgebra::{Complex, DMatrix};

use gdcm_model::executor::{Executor, each};
use gdcm_model::simulation::{LowPass, Segment};
use gdcm_numerics::{FourierPlanner, FourierTransform};

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
    let plans: Vec<_> = segments
        .iter()
        .map(|segment| planner.plan(segment.inputs.nrows()))
        .collect();
    each(executor, segments.iter().zip(plans), |(segment, plan)| {
        spectrum(segment, highest, &plan)
    })
}

/// The lines of one segment up to `highest`, by the transform `plan` of its length.
fn spectrum(segment: &Segment, highest: f64, plan: &FourierTransform) -> Spectrum {
    let duration_s = segment.sample_time_s * segment.inputs.nrows() as f64;
    let below_nyquist = segment.inputs.nrows().saturating_sub(1) / 2;
    let omega: Vec<f64> = (1..=below_nyquist)
        .map(|k| TAU * k as f64 / duration_s)
        .take_while(|&w| w <= highest)
        .collect();
    let factor = segment.sample_time_s / duration_s.sqrt();
    let inputs = transform(&segment.inputs, omega.len(), factor, plan);
    let outputs = transform(&segment.outputs, omega.len(), factor, plan);
    Spectrum {
        record: segment.record,
        duration_s,
        omega,
        inputs,
        outputs,
    }
}

/// Spectral lines 1 to `lines` of each column of `samples`, times `factor`: one row a channel.
fn transform(
    samples: &DMatrix<f64>,
    lines: usize,
    factor: f64,
    plan: &FourierTransform,
) -> DMatrix<Complex<f64>> {
    let mut transformed = DMatrix::zeros(samples.ncols(), lines);
    if lines == 0 {
        return transformed;
    }
    for (channel, column) in samples.column_iter().enumerate() {
        let mean = column.mean();
        let mut centred: Vec<f64> = column.iter().map(|sample| sample - mean).collect();
        let spectrum = plan.of(&mut centred).unwrap_or_default();
        let row = transformed.row_mut(channel);
        row.into_iter()
            .zip(spectrum.iter().skip(1))
            .for_each(|(y, line)| *y = line * factor);
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
        let outputs = segments
            .first()
            .map_or(0, |segment| segment.outputs.ncols());
        let mut all = vec![0.0; outputs];
        let mut above = vec![0.0; outputs];
        for spectrum in spectra(segments, f64::INFINITY, executor) {
            for (k, omega) in spectrum.omega.iter().enumerate() {
                for (output, line) in spectrum.outputs.column(k).iter().enumerate().take(outputs) {
                    all[output] += line.norm_sqr();
                    above[output] += if *omega > VIBRATING * highest {
                        line.norm_sqr()
                    } else {
                        0.0
                    };
                }
            }
        }
        let shares = above.iter().zip(&all).map(|(above, all)| above / all);
        let vibrating: Vec<_> = shares
            .enumerate()
            .filter(|(_, share)| *share > VIBRATION_SHARE)
            .collect();
        Self {
            omega: highest
                * if vibrating.is_empty() {
                    USUAL
                } else {
                    VIBRATING
                },
            vibrating,
        }
    }

    /// `segments`, every channel through the low-pass of this cut-off; as they are where there is nothing to take off.
    #[must_use]
    pub fn apply(&self, segments: &[Segment], executor: &dyn Executor) -> Vec<Segment> {
        each(executor, segments, |segment| {
            LowPass::applied(self.omega, segment)
        })
    }
}
