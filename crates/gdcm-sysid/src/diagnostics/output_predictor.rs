//! Predicts outputs from past inputs and outputs; the errors are the gusts and the noise that act
//! on the outputs (M14.14).
//!
//! ```text
//! y_k = sum_{i = 1..p} (A_i y_{k-i} + B_i u_{k-i}) + B_0 u_k + e_k,   x = [u; y]
//!
//! 1  S(i, j) = sum_k x_{k-i} x_{k-j}',   k = p .. N - 1 in a record with N samples; summed over
//!    all records: from i = 0 by the recursion
//!    S(i+1, j+1) = S(i, j) + x_{p-1-i} x_{p-1-j}' - x_{N-1-i} x_{N-1-j}'
//! 2  A, B by least squares from S, with a ridge on columns of unit length
//! 3  e from the records
//! 4  V = (I - sum A_i e^(-j omega dt i))^-1 E at each spectral line, dt sample time:
//!    the effect on y of e, whose lines are E
//! ```
//!
//! Without the recursion, step 1 would take about p/2 times as long.

use nalgebra::{Complex, DMatrix, DVector};

use gdcm_model::simulation::Segment;

use crate::likelihood::gram_matrix::scale_columns;
use crate::spectra::spectrum::Spectrum;

/// Ridge for columns scaled to unit length; it keeps the normal equations solvable if channels
/// depend on each other.
const RIDGE: f64 = 1e-6;

/// Predicts the outputs linearly from the past samples and the present inputs.
pub(super) struct OutputPredictor {
    inputs: usize,
    /// `p`.
    past: usize,
    /// Columns are outputs; rows `[u_k | x_{k-1} | ... | x_{k-p}]`, `x = [u; y]`.
    coefficients: DMatrix<f64>,
}

impl OutputPredictor {
    /// Fits a predictor with `past` samples to all records that have more than twice as many (steps
    /// 1 and 2); `None` if they do not determine it. A record holds `x` in its columns.
    pub(super) fn fit(records: &[DMatrix<f64>], inputs: usize, past: usize) -> Option<Self> {
        let channels = records.first()?.nrows();
        let outputs = channels - inputs;
        let mut gram = DMatrix::zeros((past + 1) * channels, (past + 1) * channels);
        for record in records {
            if record.ncols() > 2 * past {
                add_lagged(&mut gram, record, past);
            }
        }
        // Regressors: the present inputs and all channels' past; targets: the present outputs.
        let regressors: Vec<usize> = (0..inputs).chain(channels..gram.ncols()).collect();
        let targets: Vec<usize> = (inputs..channels).collect();
        let mut normal = gram.select_rows(&regressors).select_columns(&regressors);
        let products = gram.select_rows(&regressors).select_columns(&targets);
        let scales = scale_columns(&mut normal);
        let size = scales.len();
        for k in 0..size {
            // A zero column has a zero coefficient.
            normal[(k, k)] += if scales[k] > 0.0 { RIDGE } else { 1.0 };
        }
        let scaled_products = DMatrix::from_fn(size, outputs, |row, column| {
            products[(row, column)] * scales[row]
        });
        let mut coefficients = normal.cholesky()?.solve(&scaled_products);
        for (mut row, scale) in coefficients.row_iter_mut().zip(scales.iter()) {
            row *= *scale;
        }
        if !coefficients.iter().all(|value| value.is_finite()) {
            return None;
        }
        Some(Self {
            inputs,
            past,
            coefficients,
        })
    }

    /// Returns the segment with the prediction errors as outputs (step 3): at every `step`-th
    /// sample, multiplied by `step`, with zeros between. A line, `dt/sqrt(T)` times a sum over all
    /// samples, is then that of the thinned errors. `samples` are the segment's `x`, thinned.
    pub(super) fn error_segment(
        &self,
        segment: &Segment,
        samples: &DMatrix<f64>,
        step: usize,
    ) -> Segment {
        let mut outputs = DMatrix::zeros(segment.outputs.nrows(), segment.outputs.ncols());
        for k in self.past..samples.ncols() {
            let error = self.error(samples, k);
            outputs
                .row_mut(k * step)
                .tr_copy_from(&(error * step as f64));
        }
        Segment {
            outputs,
            ..segment.clone()
        }
    }

    /// Computes a record's prediction error `e_k` at instant `k`.
    fn error(&self, record: &DMatrix<f64>, k: usize) -> DVector<f64> {
        let channels = record.nrows();
        let mut error = record
            .column(k)
            .rows(self.inputs, channels - self.inputs)
            .into_owned();
        error.gemv_tr(
            -1.0,
            &self.coefficients.rows(0, self.inputs),
            &record.column(k).rows(0, self.inputs),
            1.0,
        );
        for lag in 1..=self.past {
            let rows = self
                .coefficients
                .rows(self.inputs + (lag - 1) * channels, channels);
            error.gemv_tr(-1.0, &rows, &record.column(k - lag), 1.0);
        }
        error
    }

    /// Converts the spectral lines `E` of the prediction errors to their effect `V` on the outputs
    /// (step 4); `step_s` is the thinned sample time \[s\]. `None` where the predictor is singular.
    pub(super) fn add_memory(&self, spectrum: &mut Spectrum, step_s: f64) -> Option<()> {
        let outputs = self.coefficients.ncols();
        let channels = self.inputs + outputs;
        for (k, omega) in spectrum.omega.iter().enumerate() {
            let mut memory = DMatrix::<Complex<f64>>::identity(outputs, outputs);
            for lag in 1..=self.past {
                let delay = Complex::cis(-omega * step_s * lag as f64);
                // The coefficients hold A_lag transposed, from this row on.
                let first_row = self.inputs + (lag - 1) * channels + self.inputs;
                for to in 0..outputs {
                    for from in 0..outputs {
                        memory[(to, from)] -= delay * self.coefficients[(first_row + from, to)];
                    }
                }
            }
            let line = memory
                .lu()
                .solve(&spectrum.outputs.column(k).into_owned())?;
            spectrum.outputs.set_column(k, &line);
        }
        Some(())
    }
}

/// Adds a record's `S(i, j)` to the blocks (i, j) of `gram` (step 1): for each `lag = j - i`, the
/// block with i = 0 from the samples, then the other blocks of this diagonal by the recursion.
fn add_lagged(gram: &mut DMatrix<f64>, record: &DMatrix<f64>, past: usize) {
    let (channels, samples) = record.shape();
    for lag in 0..=past {
        let mut block = record.columns(past, samples - past)
            * record.columns(past - lag, samples - past).transpose();
        for i in 0..=past - lag {
            let j = i + lag;
            let mut upper = gram.view_mut((i * channels, j * channels), (channels, channels));
            upper += &block;
            if lag > 0 {
                let mut lower = gram.view_mut((j * channels, i * channels), (channels, channels));
                lower += block.transpose();
            }
            if j < past {
                block.gemm(
                    1.0,
                    &record.column(past - 1 - i),
                    &record.column(past - 1 - j).transpose(),
                    1.0,
                );
                block.gemm(
                    -1.0,
                    &record.column(samples - 1 - i),
                    &record.column(samples - 1 - j).transpose(),
                    1.0,
                );
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lagged_products_are_those_of_the_rows() {
        let record = DMatrix::from_fn(2, 15, |row, column| {
            ((1.0 + row as f64) * 1.7 * column as f64).sin()
        });
        let past = 3;
        let mut gram = DMatrix::zeros(8, 8);
        add_lagged(&mut gram, &record, past);
        let row = |k: usize| DVector::from_fn(8, |at, _| record[(at % 2, k - at / 2)]);
        let expected = (past..15).fold(DMatrix::zeros(8, 8), |sum, k| {
            sum + row(k) * row(k).transpose()
        });
        assert!((gram - expected).amax() < 1e-12);
    }
}
