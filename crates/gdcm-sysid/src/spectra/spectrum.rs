//! A segment's spectral lines: its Fourier transform without a window (M14.2).

use std::f64::consts::TAU;

use nalgebra::{Complex, DMatrix};

use gdcm_model::executor::{Executor, each};
use gdcm_model::simulation::Segment;
use gdcm_numerics::{FourierPlanner, FourierTransform};

use super::gap_hat::GapHat;

/// Lowest frequency used, in units of a segment's first line: halfway to the second. The first line
/// contains the drift, so that the lines are used from the second on.
pub(crate) const FIRST_LINE: f64 = 1.5;

/// A segment's spectral lines (M14.2): columns are lines, rows are channels.
///
/// ```text
/// U(omega_k) = dt / sqrt(T) sum_n u[n] e^(-j omega_k n dt)
/// omega_k = 2 pi k / T,   T = N dt,   k >= 1
/// ```
///
/// There is no window: the transient terms of the fits take its place (M14.2, M14.4). The mean is
/// removed only for accuracy: the lines from k = 1 on do not contain it.
#[derive(Clone, Debug, PartialEq)]
pub struct Spectrum {
    /// Record index, from 0.
    pub record: usize,
    /// `T` \[s\].
    pub duration_s: f64,
    /// `omega_k` \[rad/s\], ascending.
    pub omega: Vec<f64>,
    /// `U`, inputs x lines.
    pub inputs: DMatrix<Complex<f64>>,
    /// `Y`, outputs x lines.
    pub outputs: DMatrix<Complex<f64>>,
    /// Lines of the *hats*, triangles in the gaps whose heights are estimated with each model
    /// (`gap_hat`); empty for a segment without gaps.
    pub hats: Vec<GapHat>,
}

impl Spectrum {
    /// Returns the lines with `lowest <= omega_k <= highest` \[rad/s\].
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
            hats: self.hats.iter().map(|hat| hat.between(from..to)).collect(),
        }
    }
}

/// Frequency range in which lines are used.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LineRange {
    /// Lowest frequency \[rad/s\].
    pub(crate) lowest: f64,
    /// Highest frequency \[rad/s\].
    pub(crate) highest: f64,
}

impl LineRange {
    /// Transforms the segments and keeps the lines in the range, from each segment's second line
    /// on.
    ///
    /// Segments without a line in the range are omitted.
    pub(crate) fn spectra(self, segments: &[Segment], executor: &dyn Executor) -> Vec<Spectrum> {
        let mut used = Vec::new();
        for spectrum in spectra(segments, self.highest, executor) {
            let lines = self.used_lines(&spectrum);
            if !lines.omega.is_empty() {
                used.push(lines);
            }
        }
        used
    }

    /// Returns the lines in the range, from the second on.
    pub(crate) fn used_lines(self, spectrum: &Spectrum) -> Spectrum {
        let second = FIRST_LINE * TAU / spectrum.duration_s;
        spectrum.between(self.lowest.max(second), self.highest)
    }
}

/// Computes every segment's lines up to `highest` \[rad/s\] and below half the sampling frequency,
/// in segment order and without hats.
#[must_use]
pub fn spectra(segments: &[Segment], highest: f64, executor: &dyn Executor) -> Vec<Spectrum> {
    let segments: Vec<&Segment> = segments.iter().collect();
    spectra_of(&segments, highest, executor)
}

/// Computes the lines as [`spectra`] does, for segments that are not in one list.
pub(crate) fn spectra_of(
    segments: &[&Segment],
    highest: f64,
    executor: &dyn Executor,
) -> Vec<Spectrum> {
    let mut planner = FourierPlanner::default();
    let plans: Vec<_> = segments
        .iter()
        .map(|segment| planner.plan(segment.inputs.nrows()))
        .collect();
    each(executor, segments.iter().zip(plans), |(segment, plan)| {
        spectrum(segment, highest, &plan)
    })
}

/// Computes a segment's lines up to `highest`; `plan` is a transform with its length.
fn spectrum(segment: &Segment, highest: f64, plan: &FourierTransform) -> Spectrum {
    let duration_s = segment.duration_s();
    let below_nyquist = segment.inputs.nrows().saturating_sub(1) / 2;
    let omega: Vec<f64> = (1..=below_nyquist)
        .map(|k| TAU * k as f64 / duration_s)
        .take_while(|&w| w <= highest)
        .collect();
    let factor = segment.sample_time_s / duration_s.sqrt();
    Spectrum {
        record: segment.record,
        duration_s,
        inputs: transform(&segment.inputs, omega.len(), factor, plan),
        outputs: transform(&segment.outputs, omega.len(), factor, plan),
        hats: Vec::new(),
        omega,
    }
}

/// Computes lines 1 to `lines` for each column in `samples`, times `factor`; rows are channels.
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
        let spectrum = plan.transform(&mut centred).unwrap_or_default();
        let mut row = transformed.row_mut(channel);
        for (y, line) in row.iter_mut().zip(spectrum.iter().skip(1)) {
            *y = line * factor;
        }
    }
    transformed
}
