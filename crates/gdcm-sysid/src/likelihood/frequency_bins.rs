//! Bins over frequency for the normal equations (`normal_equations`): within a bin, the response of
//! the model's outputs to its states and the noise are taken as constant.

use nalgebra::{Complex, DMatrix};

use gdcm_model::executor::each;

use super::binned_products::VectorProducts;
use super::cost::Likelihood;
use super::schur_model::SchurModel;
use super::spectral_lines::whiten;

/// The bins, and the bin of every line.
pub(super) struct FrequencyBins {
    bins: Vec<Bin>,
    /// Bin index for each line in each segment.
    pub(super) of_lines: Vec<Vec<usize>>,
}

/// Lines with neighbouring frequencies, from all segments.
struct Bin {
    /// Geometric mean frequency \[rad/s\].
    omega: f64,
    /// The line whose weight is taken for the whole bin: the first at or above the mean.
    middle: LineIndex,
    /// Sum of the lines' squared weight scales (`SpectralLines::scale`).
    squared_scales: f64,
}

/// A line's place among all lines.
#[derive(Clone, Copy)]
struct LineIndex {
    segment: usize,
    line: usize,
}

/// A line to be assigned to a bin.
struct PlacedLine {
    log_omega: f64,
    index: LineIndex,
}

impl FrequencyBins {
    /// Fills bins from the lowest frequency on, each `width` wide in ln omega; each bin begins at
    /// the first line above the previous bin.
    pub(super) fn new(likelihood: &Likelihood, width: f64) -> Self {
        let lines = sorted_lines(likelihood);
        let mut of_lines: Vec<Vec<usize>> = likelihood
            .segments
            .iter()
            .map(|segment| vec![0; segment.omega.len()])
            .collect();
        let mut bins = Vec::new();
        let mut first = 0;
        while first < lines.len() {
            let upper_end = lines[first].log_omega + width;
            let count = lines[first..].partition_point(|line| line.log_omega < upper_end);
            let members = &lines[first..first + count];
            for member in members {
                of_lines[member.index.segment][member.index.line] = bins.len();
            }
            bins.push(Bin::new(members, likelihood));
            first += count;
        }
        Self { bins, of_lines }
    }

    pub(super) fn count(&self) -> usize {
        self.bins.len()
    }

    /// Returns the sum of the lines' squared weight scales in each bin.
    pub(super) fn squared_scales(&self) -> Vec<f64> {
        self.bins.iter().map(|bin| bin.squared_scales).collect()
    }

    /// Computes `V^H V` for every bin, with weights of scale 1.
    pub(super) fn vector_products(
        &self,
        likelihood: &Likelihood,
        model: &SchurModel,
    ) -> VectorProducts {
        let products = each(likelihood.executor, &self.bins, |bin| {
            let lines = &likelihood.segments[bin.middle.segment];
            let weight = lines.weights[bin.middle.line].unscale(lines.scale);
            let mut cr = vec![Complex::default(); model.c().nrows() * model.order()];
            model.output_resolvent(bin.omega, &mut cr);
            let vectors = vectors(&cr, &weight);
            vectors.adjoint() * &vectors
        });
        VectorProducts::new(products)
    }
}

impl Bin {
    /// Creates the bin for neighbouring lines, ascending by frequency.
    fn new(members: &[PlacedLine], likelihood: &Likelihood) -> Self {
        let mean = members.iter().map(|line| line.log_omega).sum::<f64>() / members.len() as f64;
        let middle = members
            .partition_point(|line| line.log_omega < mean)
            .min(members.len() - 1);
        let mut squared_scales = 0.0;
        for member in members {
            squared_scales += likelihood.segments[member.index.segment].scale.powi(2);
        }
        Self {
            omega: mean.exp(),
            middle: members[middle].index,
            squared_scales,
        }
    }
}

/// Returns all lines in all segments, ascending by frequency.
fn sorted_lines(likelihood: &Likelihood) -> Vec<PlacedLine> {
    let mut lines = Vec::new();
    for (segment, own) in likelihood.segments.iter().enumerate() {
        for (line, omega) in own.omega.iter().enumerate() {
            lines.push(PlacedLine {
                log_omega: omega.ln(),
                index: LineIndex { segment, line },
            });
        }
    }
    lines.sort_by(|a, b| a.log_omega.total_cmp(&b.log_omega));
    lines
}

/// Returns `V = [W C R, W]`, outputs x (n + outputs), from `C R`, column after column.
fn vectors(cr: &[Complex<f64>], weight: &DMatrix<Complex<f64>>) -> DMatrix<Complex<f64>> {
    let outputs = weight.nrows();
    let order = cr.len() / outputs;
    let mut vectors = DMatrix::zeros(outputs, order + outputs);
    for (state, column) in cr.chunks_exact(outputs).enumerate() {
        let mut to = vectors.column_mut(state);
        whiten(weight, column, |o, value| to[o] = value);
    }
    vectors.columns_mut(order, outputs).copy_from(weight);
    vectors
}
