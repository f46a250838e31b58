//! Whether the measured response is what the aircraft does, or what the feedback of gusts and noise into the inputs does (M14.14).
//!
//! ```text
//! y_k = sum_{i = 1..p} (A_i y_{k-i} + B_i u_{k-i}) + B_0 u_k + e_k     least squares over all records, every dec-th sample, no filter
//!
//! 1  S(0, j) = sum_k z_k z_{k-j}', z = [u; y]; S(i+1, j+1) = S(i, j) + z_{p-1-i} z_{p-1-j}' - z_{N-1-i} z_{N-1-j}'
//! 2  A, B from S with a ridge on columns of length one; e from the records
//! 3  V = (I - sum A_i z^-i)^-1 E on the lines, z = e^(j omega dt dec): what noise and gusts do to y
//! 4  G_b = local polynomial of V on U at 16 points of the band, beside G of the model
//! 5  b = median |G_b / G|,  z = median |G_b|^2 / var  over the points with |G| > 3 % of the output's largest and sd G_b < 0.4 |G|
//! ```
//!
//! With feedback the inputs hold what gusts did to the outputs, and the cost stays at 1 however wrong the model is.

use nalgebra::{Complex, DMatrix, DVector};

use gdcm_model::executor::{Executor, each};
use gdcm_model::response::frequency_response::log_spaced;
use gdcm_model::response::median;
use gdcm_model::simulation::Segment;

use super::blocks::BlockModel;
use super::likelihood::scale_columns;
use super::local_polynomial::{EstimatePoint, ResponseEstimate, local_polynomial};
use super::prepared_data::PreparedData;
use super::spectrum::Spectrum;

/// Samples of the predictor over the time in which the upper end of the band turns by one radian.
const STEP: f64 = 0.25;
/// Past samples of the predictor at most and at least, and samples for each of its unknowns.
const PAST: (usize, usize) = (40, 6);
const SAMPLES_AN_UNKNOWN: usize = 8;
/// Ridge over columns of length one.
const RIDGE: f64 = 1e-6;
/// Points of the band at which the responses are compared.
const POINTS: usize = 16;
/// Share of the largest response of an output below which a point does not count, and the spread of `G_b` over `|G|` above which it does not.
const LARGE: f64 = 0.03;
const SURE: f64 = 0.4;
/// Share of the points that count at least; where they are fewer, all do.
const LEAST_SHARE: f64 = 0.05;
/// `b` and `z` from which some of the response is fed back, and from which too much of it is.
const SOME: (f64, f64) = (0.08, 1.6);
const TOO_MUCH: (f64, f64) = (0.18, 3.0);
/// Share fed back from which the bands are widened (M14.17).
const WIDENED: f64 = 0.04;

/// How much of the measured response is noise and gusts that were fed back.
#[derive(Clone, Debug, PartialEq)]
pub struct Feedback {
    /// `b`: median share of the response.
    pub share: f64,
    /// `z`: median square over the variance; 0.7 where nothing is fed back.
    pub significance: f64,
    /// \[rad/s\], ascending.
    omega: Vec<f64>,
    /// `|G_b / G|` at each of them, outputs x inputs.
    ratios: Vec<DMatrix<f64>>,
}

/// What the feedback makes of a model.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum FeedbackLevel {
    /// Nothing is seen.
    None,
    /// The models are off by some tenths of a dB.
    Some,
    /// The models are not to be used.
    TooMuch,
}

impl Feedback {
    /// What it makes of a model.
    #[must_use]
    pub fn level(&self) -> FeedbackLevel {
        let beyond = |(share, significance): (f64, f64)| {
            self.share >= share && self.significance >= significance
        };
        match () {
            () if beyond(TOO_MUCH) => FeedbackLevel::TooMuch,
            () if beyond(SOME) => FeedbackLevel::Some,
            () => FeedbackLevel::None,
        }
    }

    /// `|G_b / G|` of a response at `omega`, root mean square over three points; 0 where so little is fed back that the bands are right as they
    /// are.
    pub(super) fn ratio(&self, omega: f64, pair: (usize, usize)) -> f64 {
        if self.share < WIDENED {
            return 0.0;
        }
        let smoothed = |k: usize| {
            let near = self.ratios[k.saturating_sub(1)..(k + 2).min(self.ratios.len())]
                .iter()
                .map(|of| of[pair].powi(2));
            let count = near.len();
            (near.sum::<f64>() / count as f64).sqrt()
        };
        let after = self
            .omega
            .partition_point(|at| *at <= omega)
            .clamp(1, self.omega.len() - 1);
        let place =
            (omega / self.omega[after - 1]).ln() / (self.omega[after] / self.omega[after - 1]).ln();
        let share = place.clamp(0.0, 1.0);
        (1.0 - share) * smoothed(after - 1) + share * smoothed(after)
    }

    /// What is fed back in the records of the fit beside a model of them; none where they are too short for a predictor.
    pub(super) fn of(
        data: &PreparedData,
        model: &BlockModel,
        band: [f64; 2],
        executor: &dyn Executor,
    ) -> Option<Self> {
        /// Share by which sample times may differ in one predictor.
        const ALIKE: f64 = 0.01;
        let first = data.unfiltered.first()?;
        let is_alike = |of: &&Segment| (of.sample_time_s / first.sample_time_s - 1.0).abs() < ALIKE;
        let segments: Vec<Segment> = data.unfiltered.iter().filter(is_alike).cloned().collect();
        let step = ((STEP / (band[1] * first.sample_time_s)).round() as usize).max(1);
        let thinned = each(executor, &segments, |segment| thinned(segment, step));
        let predictor = Predictor::of(&thinned, (first.inputs.ncols(), first.outputs.ncols()))?;
        let noise = each(
            executor,
            segments.iter().zip(&thinned),
            |(segment, samples)| {
                let mut outputs = DMatrix::zeros(segment.outputs.nrows(), segment.outputs.ncols());
                for (k, error) in predictor.errors(samples) {
                    outputs
                        .row_mut(k * step)
                        .tr_copy_from(&(error * step as f64));
                }
                Segment {
                    outputs,
                    ..segment.clone()
                }
            },
        );
        let mut fed = data.lines.of(&noise, executor);
        for spectrum in &mut fed {
            predictor.add_memory(spectrum, step as f64 * first.sample_time_s)?;
        }
        let omegas = log_spaced(band[0], band[1], POINTS);
        Some(Self::beside(
            model,
            &local_polynomial(&fed, &omegas, executor).ok()?,
        ))
    }

    fn beside(model: &BlockModel, fed: &ResponseEstimate) -> Self {
        let responses: Vec<DMatrix<f64>> = fed
            .points
            .iter()
            .map(|point| model.response(point.omega).map(|g| g.norm()))
            .collect();
        let (outputs, inputs) = model.d.shape();
        let mut sure = Vec::new();
        let mut every = Vec::new();
        for output in 0..outputs {
            let largest = responses
                .iter()
                .map(|g| g.row(output).max())
                .fold(0.0, f64::max);
            for (g, point) in responses.iter().zip(&fed.points) {
                for input in 0..inputs {
                    let own = g[(output, input)];
                    let of_noise = point.response[(output, input)].norm();
                    let variance = point.variance[(output, input)];
                    let both = (
                        of_noise / own,
                        of_noise * of_noise / variance.max(f64::MIN_POSITIVE),
                    );
                    every.push(both);
                    if own > LARGE * largest && variance.sqrt() < SURE * own {
                        sure.push(both);
                    }
                }
            }
        }
        let counted = if sure.len() as f64 >= LEAST_SHARE * every.len() as f64 {
            sure
        } else {
            every
        };
        let of = |part: fn(&(f64, f64)) -> f64| {
            median(&mut counted.iter().map(part).collect::<Vec<f64>>())
        };
        let ratio = |(g, point): (&DMatrix<f64>, &EstimatePoint)| {
            g.zip_map(&point.response, |g, fed| fed.norm() / g)
        };
        Self {
            share: of(|both| both.0),
            significance: of(|both| both.1),
            omega: fed.points.iter().map(|point| point.omega).collect(),
            ratios: responses.iter().zip(&fed.points).map(ratio).collect(),
        }
    }
}

/// Every `step`-th sample of a segment less the means, one column an instant: inputs, then outputs.
fn thinned(segment: &Segment, step: usize) -> DMatrix<f64> {
    let inputs = segment.inputs.ncols();
    let outputs = segment.outputs.ncols();
    let count = segment.inputs.nrows().div_ceil(step);
    let mut samples = DMatrix::zeros(inputs + outputs, count);
    for (channel, column) in segment
        .inputs
        .column_iter()
        .chain(segment.outputs.column_iter())
        .enumerate()
    {
        let mean = column.mean();
        (0..count).for_each(|k| samples[(channel, k)] = column[k * step] - mean);
    }
    samples
}

/// The predictor of the outputs from the past.
struct Predictor {
    inputs: usize,
    past: usize,
    /// One column an output; rows `[u_k | z_{k-1} | ... | z_{k-p}]`, `z = [u; y]`.
    coefficients: DMatrix<f64>,
}

impl Predictor {
    fn of(records: &[DMatrix<f64>], (inputs, outputs): (usize, usize)) -> Option<Self> {
        let channels = inputs + outputs;
        let samples: usize = records.iter().map(DMatrix::ncols).sum();
        let past = (samples / (SAMPLES_AN_UNKNOWN * channels)).clamp(PAST.1, PAST.0);
        let mut gram = DMatrix::zeros((past + 1) * channels, (past + 1) * channels);
        records
            .iter()
            .filter(|record| record.ncols() > 2 * past)
            .for_each(|record| add_lagged(&mut gram, record, past));
        // Regressors: all of the past, and the inputs of now; what is predicted: the outputs of now.
        let regressors: Vec<usize> = (0..inputs).chain(channels..gram.ncols()).collect();
        let outputs_now: Vec<usize> = (inputs..channels).collect();
        let mut normal = gram.select_rows(&regressors).select_columns(&regressors);
        let right = gram.select_rows(&regressors).select_columns(&outputs_now);
        let scales = scale_columns(&mut normal);
        let size = scales.len();
        (0..size).for_each(|k| normal[(k, k)] += if scales[k] > 0.0 { RIDGE } else { 1.0 });
        let scaled = DMatrix::from_fn(size, outputs, |row, column| {
            right[(row, column)] * scales[row]
        });
        let mut coefficients = normal.cholesky()?.solve(&scaled);
        coefficients
            .row_iter_mut()
            .zip(scales.iter())
            .for_each(|(mut row, scale)| row *= *scale);
        let finite = coefficients.iter().all(|value| value.is_finite());
        finite.then_some(Self {
            inputs,
            past,
            coefficients,
        })
    }

    /// What it does not predict of a record, by instant.
    fn errors<'r>(
        &'r self,
        record: &'r DMatrix<f64>,
    ) -> impl Iterator<Item = (usize, DVector<f64>)> + 'r {
        let channels = record.nrows();
        (self.past..record.ncols()).map(move |k| {
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
            (k, error)
        })
    }

    /// Turns the lines of the errors into those of what noise and gusts do to the outputs; none where that is not finite.
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

/// Adds `sum_k z_{k-i} z_{k-j}'` of a record, k from `past` on, to the blocks (i, j).
fn add_lagged(gram: &mut DMatrix<f64>, record: &DMatrix<f64>, past: usize) {
    let (channels, samples) = record.shape();
    for lag in 0..=past {
        let mut block = record.columns(past, samples - past)
            * record.columns(past - lag, samples - past).transpose();
        for i in 0..=past - lag {
            let j = i + lag;
            let mut to = gram.view_mut((i * channels, j * channels), (channels, channels));
            to += &block;
            if lag > 0 {
                let mut mirrored =
                    gram.view_mut((j * channels, i * channels), (channels, channels));
                mirrored += block.transpose();
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
