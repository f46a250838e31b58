//! The cost of a model over the lines of the records, transients eliminated (M14, section 4).
//!
//! ```text
//! J = sum_r sum_k | W_k (Y_r - G U_r - C (j omega - A)^-1 tau_r - c1_r/(j omega) - c0_r) |^2
//!
//! 1  once a record: orthonormal bases of the columns W (real parts) and W/omega (imaginary parts): c0 and c1 are gone
//! 2  T = W C (j omega - A)^-1, e0 = W (Y - G U), both less their projections on these bases
//! 3  tau = argmin |e0 - T tau|^2 from the Gram matrix of the scaled columns, its eigenvalues below 1e-12 dropped
//! 4  e = e0 - T tau,   J_r = |e|^2
//! ```
//!
//! Nothing is simulated, so that unstable models have a cost like any other. The trims, the drift, the step at the record's
//! end and its initial and final states are what tau, c1 and c0 stand for. `J` over its degrees of freedom is 1 where the
//! model is adequate, because W makes the noise white with real and imaginary parts of variance one.

use nalgebra::{Complex, DMatrix, DVector};

use gdcm_model::executor::{Executor, each};

use super::blocks::BlockModel;
use super::local_polynomial::NoiseCovariance;
use super::normal_system::NormalSystem;
use super::spectrum::Spectrum;

/// Share of the greatest eigenvalue of a transient's Gram matrix below which its columns depend on each other.
pub(super) const DEPENDENT: f64 = 1e-12;

/// The lines of one segment of a record, whitened.
#[derive(Clone, Debug)]
pub(super) struct SpectralLines {
    /// Which of the records it is of, counted from 0.
    pub(super) record: usize,
    /// \[rad/s\].
    pub(super) omega: Vec<f64>,
    /// `U`, inputs x lines.
    pub(super) inputs: DMatrix<Complex<f64>>,
    /// `W Y`, outputs x lines.
    pub(super) outputs: DMatrix<Complex<f64>>,
    /// `W`, lower triangular, one for each line.
    pub(super) weights: Vec<DMatrix<f64>>,
    /// Orthonormal basis of the real parts that `c0` can make, (outputs lines) x outputs.
    constant: DMatrix<f64>,
    /// Orthonormal basis of the imaginary parts that `c1 / (j omega)` can make, (outputs lines) x outputs.
    drift: DMatrix<f64>,
}

/// A segment's part of the cost.
#[derive(Clone, Debug)]
pub(super) struct SegmentCost {
    /// `J_r`.
    pub(super) cost: f64,
    /// `tau_r`.
    pub(super) transient: DVector<f64>,
    /// `e`, outputs x lines.
    pub(super) residual: DMatrix<Complex<f64>>,
}

impl SpectralLines {
    /// The lines of a spectrum in scaled units with the weights of `noise`; none where it has no weight.
    pub(super) fn new(spectrum: &Spectrum, noise: &NoiseCovariance) -> Option<Self> {
        let weights = spectrum
            .omega
            .iter()
            .map(|&omega| noise.weight(omega))
            .collect::<Option<Vec<_>>>()?;
        Some(Self::weighted(spectrum, weights))
    }

    /// The lines of a spectrum with given weights, lower triangular.
    pub(super) fn weighted(spectrum: &Spectrum, weights: Vec<DMatrix<f64>>) -> Self {
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

    /// The same lines with the noise `factor` times as strong.
    pub(super) fn with_noise(&self, factor: f64) -> Self {
        let share = 1.0 / factor.sqrt();
        let weights = self.weights.iter().map(|weight| weight * share).collect();
        Self {
            outputs: self.outputs.scale(share),
            weights,
            ..self.clone()
        }
    }

    /// Degrees of freedom for a model of an order: real numbers measured less the transient's.
    pub(super) fn freedom(&self, order: usize) -> usize {
        let outputs = self.outputs.nrows();
        (2 * outputs * self.omega.len()).saturating_sub(order + 2 * outputs)
    }

    /// This segment's part of the cost; none where it is not finite.
    pub(super) fn cost(&self, model: &BlockModel) -> Option<SegmentCost> {
        let outputs = self.outputs.nrows();
        let mut state = vec![Complex::default(); model.order()];
        let mut output = vec![Complex::default(); outputs];
        self.eliminated(model, |k, cr, e0| {
            let input = self.inputs.column(k);
            multiply(&model.b, input.as_slice(), &mut state);
            multiply(&model.d, input.as_slice(), &mut output);
            for (column, x) in cr.chunks_exact(outputs).zip(&state) {
                column
                    .iter()
                    .zip(&mut output)
                    .for_each(|(c, y)| *y += c * x);
            }
            whiten(&self.weights[k], &output, |o, value| {
                e0[o] = self.outputs[(o, k)] - value
            });
        })
    }

    /// A whitened column, outputs x lines, without what the transient of `model` and drifts make of it; none where that is not finite.
    pub(super) fn without_transient(
        &self,
        model: &BlockModel,
        column: &DMatrix<Complex<f64>>,
    ) -> Option<DMatrix<Complex<f64>>> {
        let left = self.eliminated(model, |k, _, e0| {
            e0.copy_from_slice(column.column(k).as_slice())
        })?;
        Some(left.residual)
    }

    /// What is left of `e0` when drifts and the transient of `model` are eliminated. `fill` is given the number of a line and
    /// `C (j omega - A)^-1` there, and puts `e0` of that line into the last.
    fn eliminated(
        &self,
        model: &BlockModel,
        mut fill: impl FnMut(usize, &[Complex<f64>], &mut [Complex<f64>]),
    ) -> Option<SegmentCost> {
        let (outputs, lines) = self.outputs.shape();
        let order = model.order();
        // Real and imaginary parts of [T e0], one row for each output of each line.
        let mut real = DMatrix::zeros(outputs * lines, order + 1);
        let mut imaginary = DMatrix::zeros(outputs * lines, order + 1);
        let mut cr = vec![Complex::default(); outputs * order];
        let mut e0 = vec![Complex::default(); outputs];
        for (k, (&omega, weight)) in self.omega.iter().zip(&self.weights).enumerate() {
            model.output_resolvent(omega, &mut cr);
            fill(k, &cr, &mut e0);
            let mut put = |o: usize, column: usize, value: Complex<f64>| {
                real[(k * outputs + o, column)] = value.re;
                imaginary[(k * outputs + o, column)] = value.im;
            };
            for (state, values) in cr.chunks_exact(outputs).enumerate() {
                whiten(weight, values, |o, value| put(o, state, value));
            }
            e0.iter()
                .enumerate()
                .for_each(|(o, value)| put(o, order, *value));
        }
        project_out(&self.constant, &mut real);
        project_out(&self.drift, &mut imaginary);
        let mut gram = real.transpose() * &real;
        gram.gemm(1.0, &imaginary.transpose(), &imaginary, 1.0);
        let root = pseudo_inverse_root(gram.view((0, 0), (order, order)).into_owned(), DEPENDENT)?;
        let transient = &root * (root.transpose() * gram.view((0, order), (order, 1)));
        let transient = DVector::from_column_slice(transient.as_slice());
        let left = |part: &DMatrix<f64>| part.column(order) - part.columns(0, order) * &transient;
        let real = left(&real);
        let imaginary = left(&imaginary);
        let cost = real.norm_squared() + imaginary.norm_squared();
        let residual = real
            .iter()
            .zip(imaginary.iter())
            .map(|(re, im)| Complex::new(*re, *im));
        let residual = DMatrix::from_iterator(outputs, lines, residual);
        cost.is_finite().then_some(SegmentCost {
            cost,
            transient,
            residual,
        })
    }
}

/// The segments of all records that a model is fitted to.
#[derive(Clone)]
pub(super) struct Likelihood<'a> {
    /// In the order of the segments.
    pub(super) segments: Vec<SpectralLines>,
    /// Who works out the parts of the segments.
    pub(super) executor: &'a dyn Executor,
}

impl Likelihood<'_> {
    /// `N`: degrees of freedom for a model of an order.
    pub(super) fn freedom(&self, order: usize) -> usize {
        self.segments
            .iter()
            .map(|segment| segment.freedom(order))
            .sum()
    }

    /// Each segment's part of the cost; none where one is not finite.
    pub(super) fn parts(&self, model: &BlockModel) -> Option<Vec<SegmentCost>> {
        each(self.executor, &self.segments, |segment| segment.cost(model))
            .into_iter()
            .collect()
    }

    /// `J`, summed in the order of the segments.
    pub(super) fn cost(&self, model: &BlockModel) -> Option<f64> {
        Some(self.parts(model)?.iter().map(|part| part.cost).sum())
    }

    /// Numbers of the records that have segments, ascending.
    pub(super) fn records(&self) -> Vec<usize> {
        let mut records: Vec<usize> = self.segments.iter().map(|segment| segment.record).collect();
        records.sort_unstable();
        records.dedup();
        records
    }

    /// The sum of the systems of the segments of one record, where `systems` are those of all segments.
    pub(super) fn system_of(&self, record: usize, systems: &[NormalSystem]) -> NormalSystem {
        let parameters = systems.first().map_or(0, |system| system.gradient.len());
        let of_segments = self
            .segments
            .iter()
            .zip(systems)
            .filter(|(segment, _)| segment.record == record);
        NormalSystem::sum(parameters, of_segments.map(|(_, system)| system))
    }

    /// The segments of all records but one.
    pub(super) fn without(&self, record: usize) -> Self {
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

/// `y = A x`.
fn multiply(a: &DMatrix<f64>, x: &[Complex<f64>], y: &mut [Complex<f64>]) {
    y.fill(Complex::default());
    for (column, x) in a.column_iter().zip(x) {
        column
            .iter()
            .zip(y.iter_mut())
            .for_each(|(a, y)| *y += x * *a);
    }
}

/// `W x` for a lower triangular `W`, entry by entry to `take`.
pub(super) fn whiten(
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

/// Takes off every column its projection on an orthonormal basis.
fn project_out(basis: &DMatrix<f64>, columns: &mut DMatrix<f64>) {
    let products = basis.transpose() * &*columns;
    columns.gemm(-1.0, basis, &products, 1.0);
}

/// Scales the columns that a Gram matrix is of to length one, and gives the factors; 0 is that of a column of zeros.
pub(super) fn scale_columns(gram: &mut DMatrix<f64>) -> DVector<f64> {
    let scales = gram.diagonal().map(|square| {
        if square > 0.0 {
            1.0 / square.sqrt()
        } else {
            0.0
        }
    });
    let size = scales.len();
    gram.iter_mut()
        .enumerate()
        .for_each(|(at, entry)| *entry *= scales[at % size] * scales[at / size]);
    scales
}

/// `F` with `F F' = G^+` for a Gram matrix `G`, by the eigenvectors of its scaled columns: those whose eigenvalue is at most
/// `dependent` times the greatest are left out. None where an iteration does not end.
pub(super) fn pseudo_inverse_root(mut gram: DMatrix<f64>, dependent: f64) -> Option<DMatrix<f64>> {
    let scales = scale_columns(&mut gram);
    if !gram.iter().all(|entry| entry.is_finite()) {
        return None;
    }
    let eigen = gram.try_symmetric_eigen(f64::EPSILON, 10_000)?;
    let least = dependent * eigen.eigenvalues.max();
    let kept: Vec<usize> = (0..scales.len())
        .filter(|&k| eigen.eigenvalues[k] > least)
        .collect();
    let mut root = eigen.eigenvectors.select_columns(&kept);
    for (mut column, &k) in root.column_iter_mut().zip(&kept) {
        column.component_mul_assign(&scales);
        column.unscale_mut(eigen.eigenvalues[k].sqrt());
    }
    Some(root)
}
