//! Measures gusts and noise that feedback brings into the measured response (M14.14).
//!
//! ```text
//! y_k = sum_{i = 1..p} (A_i y_{k-i} + B_i u_{k-i}) + B_0 u_k + e_k
//!     least squares over all records, every dec-th sample, no filter; N samples of a record
//!     dec = round(0.25 / (omega2 dt)), at least 1;   omega2 upper band end, dt sample time
//!
//! 1  S(i, j) = sum_k x_{k-i} x_{k-j}', x = [u; y], k = p .. N - 1: from i = 0 by the recursion
//!    S(i+1, j+1) = S(i, j) + x_{p-1-i} x_{p-1-j}' - x_{N-1-i} x_{N-1-j}'
//! 2  A, B from S with a ridge on unit columns; e from the records
//! 3  V = (I - sum A_i e^(-j omega dt dec i))^-1 E on the lines: the effect of noise and gusts on y
//!    (E, U: spectral lines of e and u)
//! 4  G_b = local polynomial of V on U at 16 points in the band, and G of the model there
//! 5  b = median |G_b / G|,  z = median |G_b|^2 / var
//!    over the points with |G| > 3 % of the maximum of the output and sd G_b < 0.4 |G|,
//!    or over all points if these are fewer than 5 %
//! 6  p = 40; if b and z reach a level, again with p = 200, and the lower level counts
//!    (short records permit fewer; not again unless the second p is 1.5 times the first)
//! level 1  b >= 0.08 and z >= 1.6
//! level 2  b >= 0.18 and z >= 3; or z >= 1.6 and no input with a median partial coherence >= 0.6
//! ```
//!
//! With feedback, gusts act on the inputs through the outputs, and a model's cost per degree of
//! freedom stays near 1 however wrong the model is.
//!
//! Step 6: where a sensor closes the loop and its noise dominates the residual, the best predictor
//! is a simulation from the inputs, with a memory as long as the slowest mode. A shorter predictor
//! leaves part of the response in its errors, which then seems to be fed back.

use nalgebra::{Complex, DMatrix, DVector};

use gdcm_model::executor::{Executor, each};
use gdcm_model::response::frequency_grid::log_spaced;
use gdcm_model::simulation::Segment;
use gdcm_model::statistics::median;

use crate::likelihood::gram_matrix::scale_columns;
use crate::likelihood::schur_model::SchurModel;
use crate::spectra::local_polynomial::local_polynomial;
use crate::spectra::response_estimate::{ResponseEstimate, TRUSTED_COHERENCE};
use crate::spectra::spectrum::{LineRange, Spectrum};

/// The predictor's sample time times the upper end of the band \[rad\].
const STEP: f64 = 0.25;
/// Minimum number of past samples in the predictor.
const LEAST_PAST: usize = 6;
/// Maximum number of past samples in the first predictor.
const MOST_PAST: usize = 40;
/// Maximum number of past samples in the predictor that confirms a level.
const LONG_PAST: usize = 200;
/// Maximum number of unknowns per output in the predictor that confirms a level.
const LONG_UNKNOWNS: usize = 1000;
/// The confirming predictor has at least this many times the first predictor's past samples.
const LONGER: f64 = 1.5;
/// Minimum number of samples per unknown in the predictor.
const SAMPLES_AN_UNKNOWN: usize = 8;
/// Ridge for columns scaled to unit length.
const RIDGE: f64 = 1e-6;
/// Number of frequencies at which the responses are compared.
const POINTS: usize = 16;
/// Smallest `|G|` at which a point is counted, relative to its output's largest response.
const LARGE: f64 = 0.03;
/// `sd G_b / |G|` from which a point is not counted.
const SURE: f64 = 0.4;
/// Minimum share of counted points; with a lower share, all points are counted.
const LEAST_SHARE: f64 = 0.05;
/// Fed-back share from which the bands are widened (M14.17).
const WIDENED: f64 = 0.04;
/// Segments are used if their sample time differs from the first segment's by less than this
/// share.
const ALIKE: f64 = 0.01;

/// Smallest `b` and `z` for a feedback level.
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
/// `z` from which a model must not be used if no input was swept (M14.14).
const SIGNIFICANT_WITHOUT_SWEEP: f64 = SOME.significance;

/// Noise and gusts fed back into the measured response.
#[derive(Clone, Debug, PartialEq)]
pub struct Feedback {
    /// `b`, the median `|G_b / G|`.
    pub share: f64,
    /// `z`, the median `|G_b|^2` over its variance; 0.7 without feedback.
    pub significance: f64,
    /// Median partial coherence of the most coherent input (M14.2); below 0.6, no input was swept.
    pub coherence: f64,
    /// Frequencies \[rad/s\], ascending.
    omega: Vec<f64>,
    /// `|G_b / G|` at each frequency, outputs x inputs.
    ratios: Vec<DMatrix<f64>>,
}

/// How much feedback harms a model.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum FeedbackLevel {
    /// No visible effect.
    None,
    /// The model is wrong by tenths of a dB to 2 dB (M14.14).
    Some,
    /// The model must not be used.
    TooMuch,
}

/// The records that are examined for feedback.
pub(crate) struct FeedbackRecords<'a> {
    /// Scaled segments, not filtered.
    pub(crate) segments: &'a [Segment],
    pub(crate) lines: LineRange,
    /// Lower and upper end of the band \[rad/s\].
    pub(crate) band: [f64; 2],
    /// Median partial coherence of the most coherent input.
    pub(crate) coherence: f64,
}

impl Feedback {
    /// Compares `b`, `z` and the coherence with the limits in M14.14.
    #[must_use]
    pub fn level(&self) -> FeedbackLevel {
        let is_without_sweep =
            !is_swept(self.coherence) && self.significance >= SIGNIFICANT_WITHOUT_SWEEP;
        if self.reaches(&TOO_MUCH) || is_without_sweep {
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

    /// Interpolates a response's `|G_b / G|` at `omega` \[rad/s\] between root mean squares over
    /// neighbouring points; 0 if `b` is below 0.04, for which the bands are not widened.
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

    /// Measures the feedback relative to a model (steps 1 to 6); `None` without segments, if the
    /// records do not determine a predictor, or if the local polynomials fail.
    pub(crate) fn measure(
        records: &FeedbackRecords<'_>,
        model: &SchurModel,
        executor: &dyn Executor,
    ) -> Option<Self> {
        // Steps 1 to 5 with the first predictor.
        let thinned = ThinnedRecords::new(records, executor)?;
        let past = thinned.past(MOST_PAST);
        let feedback = thinned.measure(past, model, executor)?;
        if feedback.level() == FeedbackLevel::None {
            return Some(feedback);
        }
        // Step 6: the longer predictor confirms a level, or lowers it.
        let longer = thinned.past(LONG_PAST.min(LONG_UNKNOWNS / thinned.channels()));
        if (longer as f64) < LONGER * past as f64 {
            return Some(feedback);
        }
        match thinned.measure(longer, model, executor) {
            Some(confirmed) if confirmed.level() < feedback.level() => Some(confirmed),
            _ => Some(feedback),
        }
    }

    /// Compares `G_b` with the model's response (step 5).
    fn compare(model: &SchurModel, fed_back: &ResponseEstimate, coherence: f64) -> Self {
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
            coherence,
            omega: fed_back.points.iter().map(|point| point.omega).collect(),
            ratios,
        }
    }
}

/// Returns whether an input with this median partial coherence was swept.
pub(crate) fn is_swept(coherence: f64) -> bool {
    coherence >= TRUSTED_COHERENCE
}

/// Records with a common sample time, thinned for a predictor.
struct ThinnedRecords<'a> {
    records: &'a FeedbackRecords<'a>,
    /// Segments with the sample time `sample_time_s`.
    segments: Vec<&'a Segment>,
    /// Every `step`-th sample in each segment, as [`thin`] returns them.
    samples: Vec<DMatrix<f64>>,
    step: usize,
    /// The segments' sample time \[s\].
    sample_time_s: f64,
    inputs: usize,
    outputs: usize,
}

impl<'a> ThinnedRecords<'a> {
    /// Thins the segments with the sample time of the first; `None` without segments.
    fn new(records: &'a FeedbackRecords<'a>, executor: &dyn Executor) -> Option<Self> {
        let first = records.segments.first()?;
        let segments: Vec<&Segment> = records
            .segments
            .iter()
            .filter(|segment| (segment.sample_time_s / first.sample_time_s - 1.0).abs() < ALIKE)
            .collect();
        let step = ((STEP / (records.band[1] * first.sample_time_s)).round() as usize).max(1);
        Some(Self {
            samples: each(executor, &segments, |segment| thin(segment, step)),
            records,
            segments,
            step,
            sample_time_s: first.sample_time_s,
            inputs: first.inputs.ncols(),
            outputs: first.outputs.ncols(),
        })
    }

    fn channels(&self) -> usize {
        self.inputs + self.outputs
    }

    /// Returns how many past samples a predictor from these records can have: with 8 samples for
    /// each of its unknowns, at most `most`, and at least 6.
    fn past(&self, most: usize) -> usize {
        let samples: usize = self.samples.iter().map(DMatrix::ncols).sum();
        (samples / (SAMPLES_AN_UNKNOWN * self.channels()))
            .min(most)
            .max(LEAST_PAST)
    }

    /// Measures the feedback with a predictor from `past` samples (steps 1 to 5).
    fn measure(
        &self,
        past: usize,
        model: &SchurModel,
        executor: &dyn Executor,
    ) -> Option<Feedback> {
        // Steps 1 and 2.
        let predictor = Predictor::fit(&self.samples, self.inputs, past)?;
        let errors = each(
            executor,
            self.segments.iter().zip(&self.samples),
            |(segment, samples)| predictor.error_segment(segment, samples, self.step),
        );
        // Step 3: E, then V.
        let mut disturbances = self.records.lines.spectra(&errors, executor);
        for spectrum in &mut disturbances {
            predictor.add_memory(spectrum, self.step as f64 * self.sample_time_s)?;
        }
        // Steps 4 and 5.
        let omegas = log_spaced(self.records.band[0], self.records.band[1], POINTS);
        let fed_back = local_polynomial(&disturbances, &omegas, executor).ok()?;
        Some(Feedback::compare(model, &fed_back, self.records.coherence))
    }
}

/// A response's `G_b` at a frequency, compared with its `G`.
#[derive(Clone, Copy)]
struct ComparedPoint {
    /// `|G_b / G|`.
    share: f64,
    /// `|G_b|^2 / var`.
    significance: f64,
}

/// Returns the points with large modulus and small relative standard deviation, over all responses;
/// all points if these are too few (step 5).
fn counted_points(moduli: &[DMatrix<f64>], fed_back: &ResponseEstimate) -> Vec<ComparedPoint> {
    let (outputs, inputs) = moduli.first().map_or((0, 0), DMatrix::shape);
    let mut large_and_sure = Vec::new();
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
                    large_and_sure.push(compared);
                }
            }
        }
    }
    if large_and_sure.len() as f64 >= LEAST_SHARE * every.len() as f64 {
        large_and_sure
    } else {
        every
    }
}

/// Returns every `step`-th sample less the means; columns are instants, rows are the inputs, then
/// the outputs.
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

/// Predicts the outputs linearly from past samples and the present inputs.
struct Predictor {
    inputs: usize,
    past: usize,
    /// Columns are outputs; rows `[u_k | x_{k-1} | ... | x_{k-p}]`, `x = [u; y]`.
    coefficients: DMatrix<f64>,
}

impl Predictor {
    /// Fits a predictor from `past` samples to all records with more than twice as many (steps 1
    /// and 2); `None` if they do not determine it.
    fn fit(records: &[DMatrix<f64>], inputs: usize, past: usize) -> Option<Self> {
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
    /// multiplied by `step`, with zeros between. A line, `dt/sqrt(T)` times a sum over all samples,
    /// is then that of the thinned errors.
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

    /// Converts the prediction errors' spectral lines to the effect of noise and gusts on the
    /// outputs (step 3); `None` where the predictor is singular.
    fn add_memory(&self, spectrum: &mut Spectrum, step_s: f64) -> Option<()> {
        let outputs = self.coefficients.ncols();
        let channels = self.inputs + outputs;
        for (k, omega) in spectrum.omega.iter().enumerate() {
            let mut memory = DMatrix::<Complex<f64>>::identity(outputs, outputs);
            for lag in 1..=self.past {
                let turn = Complex::cis(-omega * step_s * lag as f64);
                // First row of the past outputs: A_lag is transposed from here on.
                let a_lag = self.inputs + (lag - 1) * channels + self.inputs;
                for to in 0..outputs {
                    for from in 0..outputs {
                        memory[(to, from)] -= turn * self.coefficients[(a_lag + from, to)];
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

/// Adds a record's `S(i, j) = sum_k x_{k-i} x_{k-j}'`, k from `past` on, to the blocks (i, j) (step
/// 1): along each block diagonal, j - i = lag, by the recursion.
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
