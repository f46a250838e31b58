//! Measures gusts and noise that feedback brings into the measured response (M14.14).
//!
//! With feedback, gusts move the outputs, these move the inputs, and a model's cost per degree of
//! freedom stays near 1 however wrong the model is. A predictor of the outputs leaves gusts and
//! noise in its errors; the part of the outputs that the errors cause is compared with the inputs.
//!
//! ```text
//! 1  predictor of the outputs from p past samples, fitted to every dec-th sample of all records
//!    (`output_predictor`);   dec = round(0.25 / (omega2 dt)), at least 1
//!    omega2 upper end of the band, dt sample time
//! 2  V: effect of the errors on the outputs, at the spectral lines
//! 3  G_b: response from the inputs to V, by local polynomials at 16 frequencies in the band;
//!    G: the model's response there
//! 4  b = median |G_b / G|,  z = median |G_b|^2 / var G_b
//!    over the points with |G| > 3 % of the maximum of the output and sd G_b < 0.4 |G|,
//!    or over all points if these are fewer than 5 %
//! 5  p = 40; if b and z reach a level, again with p = 200, and the lower level counts
//!    (short records permit fewer; not again unless the second p is 1.5 times the first)
//! level 1  b >= 0.08 and z >= 1.6
//! level 2  b >= 0.18 and z >= 3; or z >= 1.6 and no input with a median partial coherence >= 0.6
//! ```
//!
//! Step 5: where a sensor closes the loop and its noise dominates the residual, the best predictor
//! has a memory as long as the slowest mode. A shorter one leaves part of the response in its
//! errors, which then seems to be fed back.

use nalgebra::DMatrix;

use gdcm_model::executor::{Executor, each};
use gdcm_model::response::frequency_grid::log_spaced;
use gdcm_model::simulation::Segment;
use gdcm_model::statistics::median;

use super::output_predictor::OutputPredictor;
use crate::likelihood::schur_model::SchurModel;
use crate::spectra::local_polynomial::local_polynomial;
use crate::spectra::response_estimate::{ResponseEstimate, TRUSTED_COHERENCE};
use crate::spectra::spectrum::LineRange;

/// The predictor's sample time times the upper end of the band \[rad\].
const PREDICTOR_STEP_RAD: f64 = 0.25;
/// Minimum number of past samples in the predictor.
const LEAST_PAST: usize = 6;
/// Maximum number of past samples in the first predictor.
const MOST_PAST: usize = 40;
/// Maximum number of past samples in the predictor that confirms a level.
const LONG_PAST: usize = 200;
/// Maximum number of unknowns per output in the predictor that confirms a level.
const LONG_UNKNOWNS: usize = 1000;
/// Minimum ratio between the past samples of the confirming and of the first predictor: with hardly
/// more samples it would confirm nothing.
const LEAST_LENGTHENING: f64 = 1.5;
/// Minimum number of samples per unknown in the predictor.
const SAMPLES_AN_UNKNOWN: usize = 8;
/// Number of frequencies at which the responses are compared.
const POINTS: usize = 16;
/// Minimum `|G|` at which a point is counted, relative to its output's largest response: where the
/// response vanishes, the ratio `G_b / G` says nothing.
const LEAST_MODULUS: f64 = 0.03;
/// `sd G_b / |G|` from which a point is not counted, because it is too uncertain.
const LARGEST_SD: f64 = 0.4;
/// Minimum share of counted points; with a lower share, all points are counted.
const LEAST_COUNTED: f64 = 0.05;
/// Fed-back share from which the bands are widened (M14.17).
const LEAST_WIDENING: f64 = 0.04;
/// Segments are used if their sample time differs from the first segment's by less than this
/// share: a predictor has a single sample time.
const SAMPLE_TIME_TOLERANCE: f64 = 0.01;

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
        if self.share < LEAST_WIDENING {
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

    /// Measures the feedback relative to a model (steps 1 to 5); `None` without segments, if the
    /// records do not determine a predictor, or if the local polynomials fail.
    pub(crate) fn measure(
        records: &FeedbackRecords<'_>,
        model: &SchurModel,
        executor: &dyn Executor,
    ) -> Option<Self> {
        // Steps 1 to 4 with the first predictor.
        let thinned = ThinnedRecords::new(records, executor)?;
        let past = thinned.past(MOST_PAST);
        let feedback = thinned.measure(past, model, executor)?;
        if feedback.level() == FeedbackLevel::None {
            return Some(feedback);
        }
        // Step 5: the longer predictor confirms a level, or lowers it.
        let longer = thinned.past(LONG_PAST.min(LONG_UNKNOWNS / thinned.channels()));
        if (longer as f64) < LEAST_LENGTHENING * past as f64 {
            return Some(feedback);
        }
        match thinned.measure(longer, model, executor) {
            Some(confirmed) if confirmed.level() < feedback.level() => Some(confirmed),
            _ => Some(feedback),
        }
    }

    /// Compares `G_b` with the model's response (step 4).
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
            .filter(|segment| {
                (segment.sample_time_s / first.sample_time_s - 1.0).abs() < SAMPLE_TIME_TOLERANCE
            })
            .collect();
        let step = ((PREDICTOR_STEP_RAD / (records.band[1] * first.sample_time_s)).round()
            as usize)
            .max(1);
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

    /// Measures the feedback with a predictor from `past` samples (steps 1 to 4).
    fn measure(
        &self,
        past: usize,
        model: &SchurModel,
        executor: &dyn Executor,
    ) -> Option<Feedback> {
        // Step 1.
        let predictor = OutputPredictor::fit(&self.samples, self.inputs, past)?;
        let errors = each(
            executor,
            self.segments.iter().zip(&self.samples),
            |(segment, samples)| predictor.error_segment(segment, samples, self.step),
        );
        // Step 2: the lines of the errors, then their effect V.
        let mut effects = self.records.lines.spectra(&errors, executor);
        for spectrum in &mut effects {
            predictor.add_memory(spectrum, self.step as f64 * self.sample_time_s)?;
        }
        // Steps 3 and 4.
        let omegas = log_spaced(self.records.band[0], self.records.band[1], POINTS);
        let fed_back = local_polynomial(&effects, &omegas, executor).ok()?;
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
/// all points if these are too few (step 4).
fn counted_points(moduli: &[DMatrix<f64>], fed_back: &ResponseEstimate) -> Vec<ComparedPoint> {
    let (outputs, inputs) = moduli.first().map_or((0, 0), DMatrix::shape);
    let mut reliable = Vec::new();
    let mut every = Vec::new();
    for output in 0..outputs {
        let largest = moduli
            .iter()
            .map(|g| g.row(output).max())
            .fold(0.0, f64::max);
        for (g, point) in moduli.iter().zip(&fed_back.points) {
            for input in 0..inputs {
                let modulus = g[(output, input)];
                let fed_back = point.response[(output, input)].norm();
                let variance = point.variance[(output, input)];
                let compared = ComparedPoint {
                    share: fed_back / modulus,
                    significance: fed_back * fed_back / variance.max(f64::MIN_POSITIVE),
                };
                every.push(compared);
                if modulus > LEAST_MODULUS * largest && variance.sqrt() < LARGEST_SD * modulus {
                    reliable.push(compared);
                }
            }
        }
    }
    if reliable.len() as f64 >= LEAST_COUNTED * every.len() as f64 {
        reliable
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
