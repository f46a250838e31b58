//! The lines of a piece's Fourier transform.

use super::Piece;
use crate::executor::{Executor, each};
use nalgebra::{Complex, DMatrix};
use realfft::{RealFftPlanner, RealToComplex};
use std::f64::consts::TAU;
use std::sync::Arc;

/// The lines of one piece (M14, 2): one column a line, one row a channel.
///
/// ```text
/// U(omega_k) = dt / sqrt(T) sum_n u[n] e^(-j omega_k n dt),   omega_k = 2 pi k / T,   T = N dt,   k >= 1
/// ```
///
/// No window, and no mean taken off but for arithmetic: lines from k = 1 do not hold it.
#[derive(Clone, Debug, PartialEq)]
pub struct Spectrum {
    /// Which of the records the piece is of, counted from 0.
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

/// The lines of every piece up to `highest` \[rad/s\] and below half the sampling frequency, in the order of the pieces.
#[must_use]
pub fn spectra(pieces: &[Piece], highest: f64, executor: &dyn Executor) -> Vec<Spectrum> {
    let mut planner = RealFftPlanner::new();
    let plans: Vec<_> = pieces.iter().map(|piece| planner.plan_fft_forward(piece.inputs.nrows())).collect();
    each(executor, pieces.iter().zip(plans), |(piece, plan)| spectrum(piece, highest, &plan))
}

/// The lines of one piece up to `highest`, by the transform `plan` of its length.
fn spectrum(piece: &Piece, highest: f64, plan: &Arc<dyn RealToComplex<f64>>) -> Spectrum {
    let duration_s = piece.sample_time_s * piece.inputs.nrows() as f64;
    let below_nyquist = piece.inputs.nrows().saturating_sub(1) / 2;
    let omega: Vec<f64> =
        (1..=below_nyquist).map(|k| TAU * k as f64 / duration_s).take_while(|&w| w <= highest).collect();
    let factor = piece.sample_time_s / duration_s.sqrt();
    let inputs = transform(&piece.inputs, omega.len(), factor, plan.as_ref());
    let outputs = transform(&piece.outputs, omega.len(), factor, plan.as_ref());
    Spectrum { record: piece.record, duration_s, omega, inputs, outputs }
}

/// Lines 1 to `lines` of each column of `samples`, times `factor`: one row a channel.
fn transform(
    samples: &DMatrix<f64>,
    lines: usize,
    factor: f64,
    plan: &dyn RealToComplex<f64>,
) -> DMatrix<Complex<f64>> {
    let mut transformed = DMatrix::zeros(samples.ncols(), lines);
    if lines == 0 {
        return transformed;
    }
    let (mut input, mut output, mut scratch) = (plan.make_input_vec(), plan.make_output_vec(), plan.make_scratch_vec());
    for (channel, column) in samples.column_iter().enumerate() {
        let mean = column.mean();
        input.iter_mut().zip(&column).for_each(|(x, sample)| *x = sample - mean);
        if plan.process_with_scratch(&mut input, &mut output, &mut scratch).is_ok() {
            let row = transformed.row_mut(channel);
            row.into_iter().zip(output.iter().skip(1)).for_each(|(y, line)| *y = line * factor);
        }
    }
    transformed
}
