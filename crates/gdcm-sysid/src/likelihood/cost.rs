//! Cost of a model over the spectral lines of the records, with the transients eliminated (M14.4).
//!
//! ```text
//! J = sum_r sum_k | W_k (Y_r - G U_r - C (j omega - A)^-1 tau_r - c1_r/(j omega) - c0_r) |^2
//!
//! 1  for each record: orthonormal bases of the columns W (real parts) and W/omega
//!    (imaginary parts), which eliminate c0 and c1
//! 2  T = W C (j omega - A)^-1, e0 = W (Y - G U), both less their projections on these bases
//! 3  tau = argmin |e0 - T tau|^2 from the scaled columns' Gram matrix,
//!    eigenvalues below 1e-12 times the largest dropped
//! 4  e = e0 - T tau,   J_r = |e|^2
//! ```
//!
//! Nothing is simulated, so unstable models have a cost like any other. tau, c1 and c0 absorb the
//! trim, the drift, the step at the record's end, and its initial and final states. `J` per
//! degree of freedom is 1 for an adequate model, because W whitens the noise: its real and
//! imaginary parts have unit variance.

use nalgebra::{Complex, DMatrix, DVector};

use gdcm_model::executor::{Executor, each};

use super::blocks::BlockModel;
use super::gram_matrix::pseudo_inverse_root;
use super::noise_covariance::NoiseCovariance;
use crate::spectra::spectrum::Spectrum;

/// Eigenvalues of a transient's Gram matrix below this share of the largest are dropped.
pub(crate) const DEPENDENT: f64 = 1e-12;

/// Whitened spectral lines of a segment.
#[derive(Clone, Debug)]
pub(crate) struct SpectralLines {
    /// Index of the record, counted from 0.
    pub(crate) record: usize,
    /// Frequencies \[rad/s\].
    pub(crate) omega: Vec<f64>,
    /// `U`, inputs x lines.
    pub(crate) inputs: DMatrix<Complex<f64>>,
    /// `W Y`, outputs x lines.
    pub(crate) outputs: DMatrix<Complex<f64>>,
    /// `W` at each line, lower triangular.
    pub(crate) weights: Vec<DMatrix<f64>>,
    /// Orthonormal basis of `W c0` in real parts, (outputs lines) x outputs.
    constant: DMatrix<f64>,
    /// Orthonormal basis of `W c1 / (j omega)` in imaginary parts, (outputs lines) x outputs.
    drift: DMatrix<f64>,
}

/// Contribution of a segment to the cost.
#[derive(Clone, Debug)]
pub(crate) struct SegmentCost {
    /// `J_r`.
    pub(crate) cost: f64,
    /// `tau_r`.
    pub(crate) transient: DVector<f64>,
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
    pub(crate) fn weighted(spectrum: &Spectrum, weights: Vec<DMatrix<f64>>) -> Self {
        let (outputs, lines) = spectrum.outputs.shape();
        let mut whitened = DMatrix::zeros(outputs, lines);
        let mut constant = DMatrix::zeros(outputs * lines, outputs);
        let mut drift = DMatrix::zeros(outputs * lines, outputs);
        for (k, weight) in weights.iter().enumerate() {
            whiten(weight, spectrum.outputs.column(k).as_slice(), |o, value| {
                whitened[(o, k)] = value
            });
            constant.rows_mut(k * outputs, outputs).copy_from(weight);
            drift
                .rows_mut(k * outputs, outputs)
                .copy_from(&(weight / spectrum.omega[k]));
        }
        Self {
            record: spectrum.record,
            omega: spectrum.omega.clone(),
            inputs: spectrum.inputs.clone(),
            outputs: whitened,
            weights,
            constant: constant.qr().q(),
            drift: drift.qr().q(),
        }
    }

    /// Returns the same lines with the noise power multiplied by `factor`.
    pub(crate) fn with_noise(&self, factor: f64) -> Self {
        let share = 1.0 / factor.sqrt();
        let weights = self.weights.iter().map(|weight| weight * share).collect();
        Self {
            outputs: self.outputs.scale(share),
            weights,
            ..self.clone()
        }
    }

    /// Returns the degrees of freedom at this model order: the number of real values in the lines
    /// less the unknowns of the transient.
    pub(crate) fn freedom(&self, order: usize) -> usize {
        let outputs = self.outputs.nrows();
        (2 * outputs * self.omega.len()).saturating_sub(order + 2 * outputs)
    }

    /// Computes the contribution of the segment to the cost; `None` if it is not finite.
    pub(crate) fn cost(&self, model: &BlockModel) -> Option<SegmentCost> {
        let outputs = self.outputs.nrows();
        let mut state = vec![Complex::default(); model.order()];
        let mut output = vec![Complex::default(); outputs];
        self.eliminate(model, |k, cr, e0| {
            let input = self.inputs.column(k);
            multiply(&model.b, input.as_slice(), &mut state);
            multiply(&model.d, input.as_slice(), &mut output);
            for (column, x) in cr.chunks_exact(outputs).zip(&state) {
                for (c, y) in column.iter().zip(&mut output) {
                    *y += c * x;
                }
            }
            whiten(&self.weights[k], &output, |o, value| {
                e0[o] = self.outputs[(o, k)] - value
            });
        })
    }

    /// Removes trim, drift and the transient of `model` from a whitened column, outputs x lines.
    ///
    /// Returns `None` if the result is not finite.
    pub(crate) fn without_transient(
        &self,
        model: &BlockModel,
        column: &DMatrix<Complex<f64>>,
    ) -> Option<DMatrix<Complex<f64>>> {
        let left = self.eliminate(model, |k, _, e0| {
            e0.copy_from_slice(column.column(k).as_slice())
        })?;
        Some(left.residual)
    }

    /// Eliminates trim, drift and the transient of `model` from `e0` (steps 2 to 4).
    ///
    /// `fill(k, cr, e0)` receives the index of a line and `C (j omega - A)^-1` at this line, and
    /// writes `e0` at the line.
    fn eliminate(
        &self,
        model: &BlockModel,
        mut fill: impl FnMut(usize, &[Complex<f64>], &mut [Complex<f64>]),
    ) -> Option<SegmentCost> {
        let (outputs, lines) = self.outputs.shape();
        let order = model.order();
        // Real and imaginary parts of [T e0]; rows are the outputs at each line.
        let mut real = DMatrix::zeros(outputs * lines, order + 1);
        let mut imaginary = DMatrix::zeros(outputs * lines, order + 1);
        let mut cr = vec![Complex::default(); outputs * order];
        let mut e0 = vec![Complex::default(); outputs];
        for (k, (&omega, weight)) in self.omega.iter().zip(&self.weights).enumerate() {
            model.output_resolvent(omega, &mut cr);
            fill(k, &cr, &mut e0);
            for (state, values) in cr.chunks_exact(outputs).enumerate() {
                whiten(weight, values, |o, value| {
                    real[(k * outputs + o, state)] = value.re;
                    imaginary[(k * outputs + o, state)] = value.im;
                });
            }
            for (o, value) in e0.iter().enumerate() {
                real[(k * outputs + o, order)] = value.re;
                imaginary[(k * outputs + o, order)] = value.im;
            }
        }
        project_out(&self.constant, &mut real);
        project_out(&self.drift, &mut imaginary);
        let transient = fit_transient(&real, &imaginary)?;
        let real = residual_of(&real, &transient);
        let imaginary = residual_of(&imaginary, &transient);
        let cost = real.norm_squared() + imaginary.norm_squared();
        if !cost.is_finite() {
            return None;
        }
        let residual = real
            .iter()
            .zip(imaginary.iter())
            .map(|(re, im)| Complex::new(*re, *im));
        Some(SegmentCost {
            cost,
            transient,
            residual: DMatrix::from_iterator(outputs, lines, residual),
        })
    }
}

/// Computes `tau = argmin |e0 - T tau|^2` from `[T e0]` in real and imaginary parts.
fn fit_transient(real: &DMatrix<f64>, imaginary: &DMatrix<f64>) -> Option<DVector<f64>> {
    let order = real.ncols() - 1;
    let mut gram = real.transpose() * real;
    gram.gemm(1.0, &imaginary.transpose(), imaginary, 1.0);
    let root = pseudo_inverse_root(gram.view((0, 0), (order, order)).into_owned(), DEPENDENT)?;
    let transient = &root * (root.transpose() * gram.view((0, order), (order, 1)));
    Some(DVector::from_column_slice(transient.as_slice()))
}

/// Returns `e0 - T tau` for the real or imaginary part of `[T e0]`.
fn residual_of(part: &DMatrix<f64>, transient: &DVector<f64>) -> DVector<f64> {
    let order = transient.len();
    part.column(order) - part.columns(0, order) * transient
}

/// The segments to which a model is fitted.
#[derive(Clone)]
pub(crate) struct Likelihood<'a> {
    /// Segments, by record and time.
    pub(crate) segments: Vec<SpectralLines>,
    pub(crate) executor: &'a dyn Executor,
}

impl Likelihood<'_> {
    /// Returns `N`, the degrees of freedom at this model order.
    pub(crate) fn freedom(&self, order: usize) -> usize {
        self.segments
            .iter()
            .map(|segment| segment.freedom(order))
            .sum()
    }

    /// Computes the contribution of each segment to the cost; `None` if a contribution is not
    /// finite.
    pub(crate) fn parts(&self, model: &BlockModel) -> Option<Vec<SegmentCost>> {
        each(self.executor, &self.segments, |segment| segment.cost(model))
            .into_iter()
            .collect()
    }

    /// Computes `J`, summed in segment order.
    pub(crate) fn cost(&self, model: &BlockModel) -> Option<f64> {
        Some(self.parts(model)?.iter().map(|part| part.cost).sum())
    }

    /// Returns the indices of the records that have segments, ascending.
    pub(crate) fn records(&self) -> Vec<usize> {
        let mut records: Vec<usize> = self.segments.iter().map(|segment| segment.record).collect();
        records.sort_unstable();
        records.dedup();
        records
    }

    /// Returns the likelihood without the segments of a record.
    pub(crate) fn without(&self, record: usize) -> Self {
        let segments = self
            .segments
            .iter()
            .filter(|segment| segment.record != record)
            .cloned()
            .collect();
        Self {
            segments,
            executor: self.executor,
        }
    }
}

/// Computes `y = A x`.
fn multiply(a: &DMatrix<f64>, x: &[Complex<f64>], y: &mut [Complex<f64>]) {
    y.fill(Complex::default());
    for (column, x) in a.column_iter().zip(x) {
        for (a, y) in column.iter().zip(y.iter_mut()) {
            *y += x * *a;
        }
    }
}

/// Computes `W x` for a lower triangular `W` and passes its entries to `take` in turn.
pub(crate) fn whiten(
    weight: &DMatrix<f64>,
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

/// Subtracts the projection on an orthonormal basis from every column.
fn project_out(basis: &DMatrix<f64>, columns: &mut DMatrix<f64>) {
    let products = basis.transpose() * &*columns;
    columns.gemm(-1.0, basis, &products, 1.0);
}
