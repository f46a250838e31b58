//! Computes a model's cost over the records' spectral lines, with the transients eliminated
//! (M14.4).
//!
//! ```text
//! J = sum_r sum_k | W_k (Y_r - G U_r - C (j omega - A)^-1 tau_r - c1_r/(j omega) - c0_r - gaps) |^2
//! gaps = sum_q c_q e_o b_q (missing output o) + sum_q c_q G_j b_q (missing input j)    (M14.21)
//!
//! segment r, line k at omega; U, Y spectra; G the model's response; e_o unit vector of output o
//! W whitens the noise (`noise_covariance`);   b_q spectrum of a hat in a gap (`gap_hat`)
//!
//! 1  T = W [C (j omega - A)^-1, I, I/(j omega), e_o b_q, G_j b_q]   (nuisance columns),
//!    e0 = W (Y - G U)
//! 2  c = argmin |e0 - T c|^2 for real c, from the Gram matrix of the scaled columns,
//!    eigenvalues below 1e-12 times the largest dropped
//! 3  e = e0 - T c,   J_r = |e|^2
//! ```
//!
//! Nothing is simulated, so unstable models have a cost like any other. tau, c0 and c1 absorb the
//! trim, the drift, the step at the segment's end, and its initial and final states. `J` per
//! degree of freedom is 1 for an adequate model, because W whitens the noise: its real and
//! imaginary parts have unit variance.

use nalgebra::{Complex, DMatrix, DVector};

use gdcm_model::dataset::channel::ChannelSide;
use gdcm_model::executor::{Executor, Sequential, each};

use super::frequency_table::{FrequencyTable, OutputResolvents};
use super::gram_matrix::pseudo_inverse_root;
use super::noise_covariance::NoiseCovariance;
use super::schur_model::SchurModel;
use crate::spectra::gap_hat::GapHat;
use crate::spectra::spectrum::Spectrum;

/// Eigenvalues of the nuisance columns' Gram matrix below this share of the largest are dropped.
pub(crate) const DEPENDENT: f64 = 1e-12;

/// A segment's whitened spectral lines.
#[derive(Clone, Debug)]
pub(crate) struct SpectralLines {
    /// Record index, from 0.
    pub(crate) record: usize,
    /// Frequencies \[rad/s\].
    pub(crate) omega: Vec<f64>,
    /// `U`, inputs x lines.
    pub(crate) inputs: DMatrix<Complex<f64>>,
    /// `W Y`, outputs x lines.
    pub(crate) outputs: DMatrix<Complex<f64>>,
    /// `W` at each line, outputs x outputs, lower triangular.
    pub(crate) weights: Vec<DMatrix<Complex<f64>>>,
    /// Factor on the weights relative to other records: 1 over the root of the factor on their
    /// noise power.
    pub(crate) scale: f64,
    /// The hats that describe the segment's missing samples.
    pub(crate) hats: Vec<GapHat>,
}

/// A segment's contribution to the cost.
#[derive(Clone, Debug)]
pub(crate) struct SegmentCost {
    /// `J_r`.
    pub(crate) cost: f64,
    /// `tau_r`.
    pub(crate) transient: DVector<f64>,
    /// `c_q` for each hat.
    pub(crate) hat_values: Vec<f64>,
    /// `e`, outputs x lines.
    pub(crate) residual: DMatrix<Complex<f64>>,
}

impl SpectralLines {
    /// Whitens a spectrum in scaled units with the noise covariance.
    ///
    /// Returns `None` if the covariance is not positive definite at a line.
    pub(crate) fn new(spectrum: &Spectrum, noise: &NoiseCovariance) -> Option<Self> {
        let weights = spectrum
            .omega
            .iter()
            .map(|&omega| noise.weight(omega))
            .collect::<Option<Vec<_>>>()?;
        Some(Self::weighted(spectrum, weights))
    }

    /// Whitens a spectrum with given lower triangular weights.
    pub(crate) fn weighted(spectrum: &Spectrum, weights: Vec<DMatrix<Complex<f64>>>) -> Self {
        let mut whitened = DMatrix::zeros(spectrum.outputs.nrows(), spectrum.outputs.ncols());
        for (k, weight) in weights.iter().enumerate() {
            whiten(weight, spectrum.outputs.column(k).as_slice(), |o, value| {
                whitened[(o, k)] = value
            });
        }
        Self {
            record: spectrum.record,
            omega: spectrum.omega.clone(),
            inputs: spectrum.inputs.clone(),
            outputs: whitened,
            weights,
            scale: 1.0,
            hats: spectrum.hats.clone(),
        }
    }

    /// Returns the same lines with the noise power multiplied by `factor`.
    pub(crate) fn with_noise(&self, factor: f64) -> Self {
        let share = 1.0 / factor.sqrt();
        let weights = self.weights.iter().map(|weight| weight.scale(share));
        Self {
            outputs: self.outputs.scale(share),
            weights: weights.collect(),
            scale: self.scale * share,
            ..self.clone()
        }
    }

    /// Returns the degrees of freedom at this model order: the real values in the lines less the
    /// unknowns tau, c0 and c1. The hats are not subtracted.
    pub(crate) fn freedom(&self, order: usize) -> usize {
        let outputs = self.outputs.nrows();
        (2 * outputs * self.omega.len()).saturating_sub(order + 2 * outputs)
    }

    /// Computes the segment's contribution to the cost; `None` if it is not finite, or the
    /// eigenvalue iteration of its nuisance columns does not converge.
    pub(crate) fn cost(
        &self,
        model: &SchurModel,
        resolvents: &OutputResolvents,
    ) -> Option<SegmentCost> {
        let outputs = self.outputs.nrows();
        let mut state = vec![Complex::default(); model.order()];
        let mut output = vec![Complex::default(); outputs];
        let columns = NuisanceColumns::new(self, model, resolvents);
        columns.eliminate(|k, cr, e0| {
            let input = self.inputs.column(k);
            multiply(model.b(), input.as_slice(), &mut state);
            multiply(model.d(), input.as_slice(), &mut output);
            for (column, x) in cr.chunks_exact(outputs).zip(&state) {
                for (c, y) in column.iter().zip(&mut output) {
                    *y += c * x;
                }
            }
            whiten(&self.weights[k], &output, |o, value| {
                e0[o] = self.outputs[(o, k)] - value;
            });
        })
    }

    /// Removes trim, drift, the transient in `model` and the missing samples from a whitened
    /// column, outputs x lines.
    ///
    /// Returns `None` if the result is not finite, or the eigenvalue iteration does not converge.
    pub(crate) fn without_transient(
        &self,
        model: &SchurModel,
        resolvents: &OutputResolvents,
        column: &DMatrix<Complex<f64>>,
    ) -> Option<DMatrix<Complex<f64>>> {
        let columns = NuisanceColumns::new(self, model, resolvents);
        let left = columns.eliminate(|k, _, e0| e0.copy_from_slice(column.column(k).as_slice()))?;
        Some(left.residual)
    }

    /// Returns `U` with the inputs' missing samples completed, inputs x lines.
    pub(crate) fn completed_inputs(&self, hat_values: &[f64]) -> DMatrix<Complex<f64>> {
        let mut inputs = self.inputs.clone();
        for (hat, value) in self.hats.iter().zip(hat_values) {
            if hat.side == ChannelSide::Input {
                let mut row = inputs.row_mut(hat.channel);
                for (input, line) in row.iter_mut().zip(&hat.lines) {
                    *input += line * *value;
                }
            }
        }
        inputs
    }

    /// Returns the share of each line, 0 to 1, that the nuisance columns take, averaged over the
    /// outputs (M14.20): the diagonal of the projector on these columns.
    pub(crate) fn transient_shares(
        &self,
        model: &SchurModel,
        resolvents: &OutputResolvents,
    ) -> Option<Vec<f64>> {
        let columns = NuisanceColumns::new(self, model, resolvents);
        columns.shares()
    }
}

/// A segment's nuisance columns `T` in real form: two rows for each output at each line, the real
/// and the imaginary part.
///
/// The columns are tau, c0, c1, the hats, and last the vector to be fitted.
struct NuisanceColumns<'s> {
    lines: &'s SpectralLines,
    /// `C (j omega - A)^-1` at each line.
    resolvents: Vec<&'s [Complex<f64>]>,
    order: usize,
    /// Number of nuisance columns; `matrix` has one column more.
    count: usize,
    matrix: DMatrix<f64>,
}

impl<'s> NuisanceColumns<'s> {
    fn new(lines: &'s SpectralLines, model: &SchurModel, resolvents: &'s OutputResolvents) -> Self {
        let outputs = lines.outputs.nrows();
        let order = model.order();
        let count = order + 2 * outputs + lines.hats.len();
        let mut columns = Self {
            lines,
            resolvents: resolvents.at_lines(&lines.omega),
            order,
            count,
            matrix: DMatrix::zeros(2 * outputs * lines.omega.len(), count + 1),
        };
        columns.fill_transient();
        for number in 0..lines.hats.len() {
            columns.fill_hat(number, model);
        }
        columns
    }

    /// Writes a column's value for an output at a line.
    fn put(&mut self, k: usize, column: usize, output: usize, value: Complex<f64>) {
        let row = 2 * (k * self.lines.outputs.nrows() + output);
        self.matrix[(row, column)] = value.re;
        self.matrix[(row + 1, column)] = value.im;
    }

    /// Fills the columns for tau, c0 and c1 (step 1).
    fn fill_transient(&mut self) {
        let outputs = self.lines.outputs.nrows();
        for (k, &omega) in self.lines.omega.iter().enumerate() {
            let weight = &self.lines.weights[k];
            let cr = self.resolvents[k];
            for (state, values) in cr.chunks_exact(outputs).enumerate() {
                whiten(weight, values, |o, value| self.put(k, state, o, value));
            }
            let integrator = Complex::new(0.0, -1.0 / omega);
            for column in 0..outputs {
                for o in column..outputs {
                    let value = weight[(o, column)];
                    self.put(k, self.order + column, o, value);
                    self.put(k, self.order + outputs + column, o, value * integrator);
                }
            }
        }
    }

    /// Fills a hat's column (step 1): `W e_o b_q` for an output, `W G_j b_q` for an input.
    fn fill_hat(&mut self, number: usize, model: &SchurModel) {
        let outputs = self.lines.outputs.nrows();
        let column = self.order + 2 * outputs + number;
        let hat = &self.lines.hats[number];
        for (k, line) in hat.lines.iter().enumerate() {
            let mut effect = vec![Complex::default(); outputs];
            match hat.side {
                ChannelSide::Output => effect[hat.channel] = *line,
                ChannelSide::Input => {
                    let b = model.b().column(hat.channel);
                    let d = model.d().column(hat.channel);
                    for (o, value) in effect.iter_mut().enumerate() {
                        let states = self.resolvents[k].chunks_exact(outputs).zip(b.iter());
                        let g: Complex<f64> = states.map(|(cr, b)| cr[o] * *b).sum();
                        *value = (g + d[o]) * line;
                    }
                }
            }
            whiten(&self.lines.weights[k], &effect, |o, value| {
                self.put(k, column, o, value)
            });
        }
    }

    /// Fits the columns to a vector by least squares (steps 2 and 3); `None` under the conditions
    /// of [`SpectralLines::cost`].
    ///
    /// `fill(k, cr, e0)` receives a line's index and its `C (j omega - A)^-1`, and writes the
    /// line's `e0`.
    fn eliminate(
        mut self,
        mut fill: impl FnMut(usize, &[Complex<f64>], &mut [Complex<f64>]),
    ) -> Option<SegmentCost> {
        let (outputs, lines) = self.lines.outputs.shape();
        let mut e0 = vec![Complex::default(); outputs];
        for k in 0..lines {
            fill(k, self.resolvents[k], &mut e0);
            for (o, value) in e0.iter().enumerate() {
                self.put(k, self.count, o, *value);
            }
        }
        let gram = self.matrix.transpose() * &self.matrix;
        let count = self.count;
        let root = pseudo_inverse_root(gram.view((0, 0), (count, count)).into_owned(), DEPENDENT)?;
        let fitted = &root * (root.transpose() * gram.view((0, count), (count, 1)));
        let left = self.matrix.column(count) - self.matrix.columns(0, count) * &fitted;
        let cost = left.norm_squared();
        if !cost.is_finite() {
            return None;
        }
        let residual = left
            .as_slice()
            .chunks_exact(2)
            .map(|parts| Complex::new(parts[0], parts[1]));
        Some(SegmentCost {
            cost,
            transient: fitted.rows(0, self.order).column(0).into_owned(),
            hat_values: fitted
                .rows(self.order + 2 * outputs, self.lines.hats.len())
                .iter()
                .copied()
                .collect(),
            residual: DMatrix::from_iterator(outputs, lines, residual),
        })
    }

    /// Averages the diagonal of `T (T'T)^+ T'` over each line's rows.
    fn shares(self) -> Option<Vec<f64>> {
        let columns = self.matrix.columns(0, self.count);
        let gram = columns.transpose() * columns;
        let projected = columns * pseudo_inverse_root(gram, DEPENDENT)?;
        let rows = 2 * self.lines.outputs.nrows();
        let mut shares = Vec::with_capacity(self.lines.omega.len());
        for k in 0..self.lines.omega.len() {
            shares.push(projected.rows(k * rows, rows).norm_squared() / rows as f64);
        }
        Some(shares)
    }
}

/// The cost over given segments, such as those of the fitted or of the held-out records.
#[derive(Clone)]
pub(crate) struct Likelihood<'a> {
    /// Segments, by record and time.
    pub(crate) segments: Vec<SpectralLines>,
    /// The frequencies in all segments; after `without`, also those in the removed segments.
    pub(crate) table: FrequencyTable,
    pub(crate) executor: &'a dyn Executor,
}

impl<'a> Likelihood<'a> {
    /// Creates the likelihood over segments, which are sorted by record and time.
    pub(crate) fn new(segments: Vec<SpectralLines>, executor: &'a dyn Executor) -> Self {
        let table = FrequencyTable::new(segments.iter().map(|segment| segment.omega.as_slice()));
        Self {
            segments,
            table,
            executor,
        }
    }

    /// Returns the likelihood over the segments with these indices.
    pub(crate) fn of_segments(&self, numbers: &[usize]) -> Self {
        let segments = numbers
            .iter()
            .filter_map(|number| self.segments.get(*number).cloned());
        Self::new(segments.collect(), self.executor)
    }

    /// Returns the likelihood over a single segment.
    pub(crate) fn of_segment(segment: SpectralLines) -> Likelihood<'static> {
        Likelihood::new(vec![segment], &Sequential)
    }

    /// Computes a model's `C (j omega - A)^-1` at all lines.
    pub(crate) fn resolvents(&self, model: &SchurModel) -> OutputResolvents<'_> {
        self.table.output_resolvents(model, self.executor)
    }

    /// Returns `N`, the degrees of freedom at this model order.
    pub(crate) fn freedom(&self, order: usize) -> usize {
        self.segments
            .iter()
            .map(|segment| segment.freedom(order))
            .sum()
    }

    /// Returns whether an input misses samples.
    pub(crate) fn misses_inputs(&self) -> bool {
        let mut hats = self.segments.iter().flat_map(|segment| &segment.hats);
        hats.any(|hat| hat.side == ChannelSide::Input)
    }

    /// Computes each segment's contribution to the cost; `None` if one cannot be computed.
    pub(crate) fn parts(&self, model: &SchurModel) -> Option<Vec<SegmentCost>> {
        let resolvents = self.resolvents(model);
        each(self.executor, &self.segments, |segment| {
            segment.cost(model, &resolvents)
        })
        .into_iter()
        .collect()
    }

    /// Computes `J`, summed in segment order.
    pub(crate) fn cost(&self, model: &SchurModel) -> Option<f64> {
        Some(self.parts(model)?.iter().map(|part| part.cost).sum())
    }

    /// Returns the indices of the records that have segments, ascending.
    pub(crate) fn records(&self) -> Vec<usize> {
        let mut records: Vec<usize> = self.segments.iter().map(|segment| segment.record).collect();
        records.sort_unstable();
        records.dedup();
        records
    }

    /// Returns the likelihood without a record's segments.
    pub(crate) fn without(&self, record: usize) -> Self {
        let segments = self
            .segments
            .iter()
            .filter(|segment| segment.record != record)
            .cloned()
            .collect();
        Self {
            segments,
            table: self.table.clone(),
            executor: self.executor,
        }
    }
}

/// Computes `y = A x`.
pub(crate) fn multiply(a: &DMatrix<f64>, x: &[Complex<f64>], y: &mut [Complex<f64>]) {
    y.fill(Complex::default());
    for (column, x) in a.column_iter().zip(x) {
        for (a, y) in column.iter().zip(y.iter_mut()) {
            *y += x * *a;
        }
    }
}

/// Computes `W x` for a lower triangular `W` and passes its entries to `take` in turn.
pub(crate) fn whiten(
    weight: &DMatrix<Complex<f64>>,
    x: &[Complex<f64>],
    mut take: impl FnMut(usize, Complex<f64>),
) {
    for o in 0..x.len() {
        let mut sum = Complex::default();
        for (k, x) in x.iter().enumerate().take(o + 1) {
            sum += x * weight[(o, k)];
        }
        take(o, sum);
    }
}
