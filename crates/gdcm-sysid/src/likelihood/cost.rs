//! Computes a model's cost over the records' spectral lines, with the transients eliminated
//! (M14.4).
//!
//! ```text
//! J = sum_r sum_k |W_k (Y_r - G U_r - C (j omega - A)^-1 tau_r - c1_r/(j omega) - c0_r - gaps)|^2
//! gaps = sum_q c_q e_o b_q (missing output o) + sum_q c_q G_i b_q (missing input i)    (M14.21)
//!
//! segment r, line k at omega; j imaginary unit; G the model's response, G_i its column for input i
//! U, Y spectra of inputs and outputs (`spectrum`);   W whitens the noise (`noise_covariance`)
//! e_o unit vector of output o;   b_q spectrum of a hat in a gap (`gap_hat`)
//! tau, c0, c1 effects of the segment's ends: difference of the states, step of the outputs between
//!    them, and drift; unknown, as are the heights c_q of the hats
//!
//! 1  e0 = W (Y - G U);   nuisance columns, the effects of the unknowns:
//!    T = W [C (j omega - A)^-1, I, I/(j omega), e_o b_q, G_i b_q]
//! 2  c = argmin |e0 - T c|^2 for real c, from the Gram matrix of the columns, scaled to unit
//!    length (`pseudo_inverse_root`); eigenvalues below 1e-12 times the largest dropped
//! 3  e = e0 - T c,   J_r = |e|^2
//! ```
//!
//! The spectra are sums without a window, so that the ends of a segment contribute to every line:
//! tau = (initial less final state) / sqrt(duration), c1 = -(slope) sqrt(duration), and c0 because
//! the sum counts y(0) in full. The trim contributes nothing: the lines of a constant are zero.
//!
//! Nothing is simulated, so unstable models have a cost like any other. `J` per degree of freedom
//! is 1 for an adequate model, because W whitens the noise: its real and imaginary parts have unit
//! variance.

use nalgebra::{Complex, DMatrix, DVector};

use gdcm_model::dataset::channel::ChannelSide;
use gdcm_model::executor::{Executor, Sequential, each};

use super::frequency_table::{FrequencyTable, OutputResolvents};
use super::nuisance_columns::NuisanceColumns;
use super::schur_model::SchurModel;
use super::spectral_lines::{SpectralLines, whiten};

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
    /// Computes the segment's contribution to the cost; `None` if it is not finite, or the
    /// eigenvalue iteration of its nuisance columns does not converge.
    pub(crate) fn cost(
        &self,
        model: &SchurModel,
        resolvents: &OutputResolvents,
    ) -> Option<SegmentCost> {
        let resolvents = resolvents.at_lines(&self.omega);
        let e0 = self.whitened_error(model, &resolvents);
        let columns = NuisanceColumns::new(self, model, resolvents);
        let elimination = columns.eliminate(&e0)?;
        Some(SegmentCost {
            cost: elimination.square,
            transient: elimination.transient,
            hat_values: elimination.hat_values,
            residual: elimination.residual,
        })
    }

    /// Computes `e0 = W (Y - G U)` (step 1), outputs x lines; `resolvents` is
    /// `C (j omega - A)^-1` at each line.
    fn whitened_error(
        &self,
        model: &SchurModel,
        resolvents: &[&[Complex<f64>]],
    ) -> DMatrix<Complex<f64>> {
        let outputs = self.outputs.nrows();
        let mut error = DMatrix::zeros(outputs, self.omega.len());
        let mut state = vec![Complex::default(); model.order()];
        let mut output = vec![Complex::default(); outputs];
        for (k, resolvent) in resolvents.iter().enumerate() {
            let input = self.inputs.column(k);
            multiply(model.b(), input.as_slice(), &mut state);
            multiply(model.d(), input.as_slice(), &mut output);
            for (column, x) in resolvent.chunks_exact(outputs).zip(&state) {
                for (c, y) in column.iter().zip(&mut output) {
                    *y += c * x;
                }
            }
            whiten(&self.weights[k], &output, |o, value| {
                error[(o, k)] = self.outputs[(o, k)] - value;
            });
        }
        error
    }

    /// Removes drift, the transient in `model` and the missing samples from a whitened column,
    /// outputs x lines: the effect of a parameter on `e0`, a column of the Jacobian.
    ///
    /// As c is fitted anew for each value of the parameter (variable projection), the effect on `e`
    /// is the column less its own fit by `T`.
    ///
    /// Returns `None` if the result is not finite, or the eigenvalue iteration does not converge.
    pub(crate) fn without_transient(
        &self,
        model: &SchurModel,
        resolvents: &OutputResolvents,
        column: &DMatrix<Complex<f64>>,
    ) -> Option<DMatrix<Complex<f64>>> {
        let columns = NuisanceColumns::new(self, model, resolvents.at_lines(&self.omega));
        Some(columns.eliminate(column)?.residual)
    }

    /// Returns the share of each line, 0 to 1, that the nuisance columns take, averaged over the
    /// outputs (M14.20): the diagonal of the projector on these columns.
    pub(crate) fn transient_shares(
        &self,
        model: &SchurModel,
        resolvents: &OutputResolvents,
    ) -> Option<Vec<f64>> {
        NuisanceColumns::new(self, model, resolvents.at_lines(&self.omega)).shares()
    }
}

/// The cost `J = -2 ln L + constant` over given segments, such as those of the fitted or of the
/// held-out records. L is the likelihood of their lines under Gaussian noise; the constant depends
/// on the weights alone.
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
fn multiply(a: &DMatrix<f64>, x: &[Complex<f64>], y: &mut [Complex<f64>]) {
    y.fill(Complex::default());
    for (column, value) in a.column_iter().zip(x) {
        for (entry, sum) in column.iter().zip(y.iter_mut()) {
            *sum += value * *entry;
        }
    }
}
