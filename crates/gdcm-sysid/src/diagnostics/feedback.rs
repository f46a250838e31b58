//! Gusts and noise that the feedback brings into the measured response (M14.14).
//!
//! ```text
//! y_k = sum_{i = 1..p} (A_i y_{k-i} + B_i u_{k-i}) + B_0 u_k + e_k
//!     least squares over all records, every dec-th sample, no filter
//!
//! 1  S(0, j) = sum_k z_k z_{k-j}', z = [u; y]
//!    S(i+1, j+1) = S(i, j) + z_{p-1-i} z_{p-1-j}' - z_{N-1-i} z_{N-1-j}'
//! 2  A, B from S with a ridge on unit columns; e from the records
//! 3  V = (I - sum A_i z^-i)^-1 E on the lines, z = e^(j omega dt dec): the effect of noise
//!    and gusts on y
//! 4  G_b = local polynomial of V on U at 16 points in the band, and G of the model there
//! 5  b = median |G_b / G|,  z = median |G_b|^2 / var
//!    over the points with |G| > 3 % of the maximum of the output and sd G_b < 0.4 |G|
//! ```
//!
//! With feedback, gusts act on the inputs through the outputs, and the cost stays at 1 however
//! wrong the model is.

use nalgebra::{Complex, DMatrix, DVector};

use gdcm_model::executor::{Executor, each};
use gdcm_model::response::frequency_grid::log_spaced;
use gdcm_model::simulation::Segment;
use gdcm_model::statistics::median;

use crate::likelihood::gram_matrix::scale_columns;
use crate::likelihood::schur_model::SchurModel;
use crate::spectra::local_polynomial::local_polynomial;
use crate::spectra::response_estimate::ResponseEstimate;
use crate::spectra::spectrum::{LineRange, Spectrum};

/// Product of the predictor's sample time and the upper band end \[rad\].
const STEP: f64 = 0.25;
/// Minimum number of past samples in the predictor.
const LEAST_PAST: usize = 6;
/// Maximum number of past samples in the predictor.
const MOST_PAST: usize = 40;
/// Minimum number of samples for each unknown in the predictor.
const SAMPLES_AN_UNKNOWN: usize = 8;
/// Ridge, relative to columns of unit length.
const RIDGE: f64 = 1e-6;
/// Frequencies at which the responses are compared.
const POINTS: usize = 16;
/// Minimum `|G|` of a counted point, relative to the largest response of its output.
const LARGE: f64 = 0.03;
/// `sd G_b / |G|` from which a point is not counted.
const SURE: f64 = 0.4;
/// Minimum share of counted points; below it all points are counted.
const LEAST_SHARE: f64 = 0.05;
/// Fed-back share from which the bands are widened (M14.17).
const WIDENED: f64 = 0.04;
/// Segments are used if their sample time differs from the first segment's by less than this
/// share.
const ALIKE: f64 = 0.01;

/// Minimum `b` and `z` of a feedback level.
struct Threshold {
    share: f64,
    significance: f64,
}

const SOME: Threshold = Threshold {
    share: 0.08,
    significance: 1.6,
};
const TOO_MUCH: Threshold = Threshold {
    share: 0.18,
    significance: 3.0,
};

/// Noise and gusts fed back into the measured response.
#[derive(Clone, Debug, PartialEq)]
pub struct Feedback {
    /// `b`, the median of `|G_b / G|`.
    pub share: f64,
    /// `z`, the median of `|G_b|^2` over its variance; 0.7 without feedback.
    pub significance: f64,
    /// Frequencies \[rad/s\], ascending.
    omega: Vec<f64>,
    /// `|G_b / G|` at each frequency, outputs x inputs.
    ratios: Vec<DMatrix<f64>>,
}

/// Effect of the feedback on a model.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum FeedbackLevel {
    /// No visible effect.
    None,
    /// The models are wrong by some tenths of a dB.
    Some,
    /// The models must not be used.
    TooMuch,
}

/// The records that are examined for feedback.
pub(crate) struct FeedbackRecords<'a> {
    /// Scaled segments, not filtered.
    pub(crate) segments: &'a [Segment],
    pub(crate) lines: LineRange,
    /// Lower and upper band end \[rad/s\].
    pub(crate) band: [f64; 2],
}

impl Feedback {
    /// Returns the effect of the feedback on a model.
    #[must_use]
    pub fn level(&self) -> FeedbackLevel {
        if self.reaches(&TOO_MUCH) {
            FeedbackLevel::TooMuch
        } else if self.reaches(&SOME) {
            FeedbackLevel::Some
        } else {
            FeedbackLevel::None
        }
    }

    fn reaches(&self, threshold: &Threshold) -> bool {
        self.share >= threshold.share && self.significance >= threshold.significance
    }

    /// Returns `|G_b / G|` of a response at `omega` \[rad/s\], as the root mean square over three
    /// points; 0 if the bands need no widening.
    pub(crate) fn ratio(&self, omega: f64, pair: (usize, usize)) -> f64 {
        if self.share < WIDENED {
            return 0.0;
        }
        let after = self
            .omega
            .partition_point(|at| *at <= omega)
            .clamp(1, self.omega.len() - 1);
        let place =
            (omega / self.omega[after - 1]).ln() / (self.omega[after] / self.omega[after - 1]).ln();
        let share = place.clamp(0.0, 1.0);
        (1.0 - share) * self.smoothed_ratio(after - 1, pair)
            + share * self.smoothed_ratio(after, pair)
    }

    /// Returns the root mean square `|G_b / G|` over a point and its neighbours.
    fn smoothed_ratio(&self, k: usize, pair: (usize, usize)) -> f64 {
        let near = &self.ratios[k.saturating_sub(1)..(k + 2).min(self.ratios.len())];
        let squares: f64 = near.iter().map(|ratios| ratios[pair].powi(2)).sum();
        (squares / near.len() as f64).sqrt()
    }

    /// Measures the feedback relative to a model; `None` if the records are too short for a
    /// predictor.
    pub(crate) fn measure(
        records: &FeedbackRecords<'_>,
        model: &SchurModel,
        executor: &dyn Executor,
    ) -> Option<Self> {
        let first = records.segments.first()?;
        let segments: Vec<&Segment> = records
            .segments
            .iter()
            .filter(|segment| (segment.sample_time_s / first.sample_time_s - 1.0).abs() < ALIKE)
            .collect();
        let step = ((STEP / (records.band[1] * first.sample_time_s)).round() as usize).max(1);
        let thinned = each(executor, &segments, |segment| thin(segment, step));
        let predictor = Predictor::fit(&thinned, first.inputs.ncols(), first.outputs.ncols())?;
        let errors = each(
            executor,
            segments.iter().zip(&thinned),
            |(segment, samples)| predictor.error_segment(segment, samples, step),
        );
        let mut disturbances = records.lines.spectra(&errors, executor);
        for spectrum in &mut disturbances {
            predictor.add_memory(spectrum, step as f64 * first.sample_time_s)?;
        }
        let omegas = log_spaced(records.band[0], records.band[1], POINTS);
        let fed_back = local_polynomial(&disturbances, &omegas, executor).ok()?;
        Some(Self::compare(model, &fed_back))
    }

    /// Compares `G_b` with the response of the model (step 5).
    fn compare(model: &SchurModel, fed_back: &ResponseEstimate) -> Self {
        let moduli: Vec<DMatrix<f64>> = fed_back
            .points
            .iter()
            .map(|point| model.response(point.omega).map(|g| g.norm()))
            .collect();
        let counted = counted_points(&moduli, fed_back);
        let mut shares: Vec<f64> = counted.iter().map(|point| point.share).collect();
        let mut significances: Vec<f64> = counted.iter().map(|point| point.significance).collect();
        let mut ratios = Vec::with_capacity(moduli.len());
        for (g, point) in moduli.iter().zip(&fed_back.points) {
            ratios.push(g.zip_map(&point.response, |g, fed_back| fed_back.norm() / g));
        }
        Self {
            share: median(&mut shares),
            significance: median(&mut significances),
            omega: fed_back.points.iter().map(|point| point.omega).collect(),
            ratios,
        }
    }
}

/// `G_b` of a response at a frequency, compared with `G`.
#[derive(Clone, Copy)]
struct ComparedPoint {
    /// `|G_b / G|`.
    share: f64,
    /// `|G_b|^2 / var`.
    significance: f64,
}

/// Returns the points with large modulus and small relative standard deviation, over all responses;
/// all points if these are too few.
fn counted_points(moduli: &[DMatrix<f64>], fed_back: &ResponseEstimate) -> Vec<ComparedPoint> {
    let (outputs, inputs) = moduli.first().map_or((0, 0), DMatrix::shape);
    let mut sure = Vec::new();
    let mut every = Vec::new();
    for output in 0..outputs {
        let largest = moduli
            .iter()
            .map(|g| g.row(output).max())
            .fold(0.0, f64::max);
        for (g, point) in moduli.iter().zip(&fed_back.points) {
            for input in 0..inputs {
                let own = g[(output, input)];
                let disturbed = point.response[(output, input)].norm();
                let variance = point.variance[(output, input)];
                let compared = ComparedPoint {
                    share: disturbed / own,
                    significance: disturbed * disturbed / variance.max(f64::MIN_POSITIVE),
                };
                every.push(compared);
                if own > LARGE * largest && variance.sqrt() < SURE * own {
                    sure.push(compared);
                }
            }
        }
    }
    if sure.len() as f64 >= LEAST_SHARE * every.len() as f64 {
        sure
    } else {
        every
    }
}

/// Returns every `step`-th sample after subtraction of the means; columns are instants, rows are
/// the inputs, then the outputs.
fn thin(segment: &Segment, step: usize) -> DMatrix<f64> {
    let inputs = segment.inputs.ncols();
    let outputs = segment.outputs.ncols();
    let count = segment.inputs.nrows().div_ceil(step);
    let mut samples = DMatrix::zeros(inputs + outputs, count);
    let columns = segment
        .inputs
        .column_iter()
        .chain(segment.outputs.column_iter());
    for (channel, column) in columns.enumerate() {
        let mean = column.mean();
        for k in 0..count {
            samples[(channel, k)] = column[k * step] - mean;
        }
    }
    samples
}

/// Linear prediction of the outputs from past samples and the present inputs.
struct Predictor {
    inputs: usize,
    past: usize,
    /// Columns are outputs; rows `[u_k | z_{k-1} | ... | z_{k-p}]`, `z = [u; y]`.
    coefficients: DMatrix<f64>,
}

impl Predictor {
    /// Fits the predictor to all records (steps 1 and 2); `None` if they do not determine it.
    fn fit(records: &[DMatrix<f64>], inputs: usize, outputs: usize) -> Option<Self> {
        let channels = inputs + outputs;
        let samples: usize = records.iter().map(DMatrix::ncols).sum();
        let past = (samples / (SAMPLES_AN_UNKNOWN * channels)).clamp(LEAST_PAST, MOST_PAST);
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
        let right = gram.select_rows(&regressors).select_columns(&targets);
        let scales = scale_columns(&mut normal);
        let size = scales.len();
        for k in 0..size {
            normal[(k, k)] += if scales[k] > 0.0 { RIDGE } else { 1.0 };
        }
        let scaled = DMatrix::from_fn(size, outputs, |row, column| {
            right[(row, column)] * scales[row]
        });
        let mut coefficients = normal.cholesky()?.solve(&scaled);
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

    /// Returns the segment with the prediction errors as outputs: at every `step`-th sample,
    /// multiplied by `step`, with zeros between.
    fn error_segment(&self, segment: &Segment, samples: &DMatrix<f64>, step: usize) -> Segment {
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

    /// Computes the prediction error `e_k` of a record at instant `k`.
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

    /// Converts the spectral lines of the prediction errors to the effect of noise and gusts on the
    /// outputs (step 3); `None` where the predictor is singular.
    fn add_memory(&self, spectrum: &mut Spectrum, step_s: f64) -> Option<()> {
        let outputs = self.coefficients.ncols();
        let channels = self.inputs + outputs;
        for (k, omega) in spectrum.omega.iter().enumerate() {
            let mut memory = DMatrix::<Complex<f64>>::identity(outputs, outputs);
            for lag in 1..=self.past {
                let turn = Complex::cis(-omega * step_s * lag as f64);
                let first = self.inputs + (lag - 1) * channels + self.inputs;
                for to in 0..outputs {
                    for from in 0..outputs {
                        memory[(to, from)] -= turn * self.coefficients[(first + from, to)];
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

/// Adds a record's `sum_k z_{k-i} z_{k-j}'`, k from `past` on, to the blocks (i, j) (step 1).
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
