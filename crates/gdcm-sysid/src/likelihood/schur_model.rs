//! A state-space model whose `A` is in Schur form, for fast evaluation at many frequencies
//! (M14.19).

use nalgebra::{Complex, DMatrix, DVector};

use gdcm_model::dataset::StateSpace;
use gdcm_model::response::schur_form::SchurForm;

use crate::subspace::tried_orders::parameters_of_order;

/// Left and right eigenvector for an eigenvalue.
pub(crate) struct Eigenvectors {
    /// `w^H`.
    pub(crate) left: DVector<Complex<f64>>,
    /// `v`.
    pub(crate) right: DVector<Complex<f64>>,
}

/// A state-space model with the Schur form of its `A`.
///
/// ```text
/// A = Q T Q^H,   C (j omega - A)^-1 = (C Q) (j omega - T)^-1 Q^H
/// ```
///
/// T is triangular, so that an equation at a frequency is solved by substitution.
#[derive(Clone, Debug)]
pub(crate) struct SchurModel {
    a: DMatrix<f64>,
    b: DMatrix<f64>,
    c: DMatrix<f64>,
    d: DMatrix<f64>,
    /// `Q`, n x n, unitary.
    q: DMatrix<Complex<f64>>,
    /// `T`, n x n, upper triangular.
    t: DMatrix<Complex<f64>>,
    /// `C Q`, outputs x n.
    cq: DMatrix<Complex<f64>>,
}

impl SchurModel {
    /// Creates a model; `None` if an entry is not finite, or if the Schur iteration does not
    /// converge.
    pub(crate) fn new(
        a: DMatrix<f64>,
        b: DMatrix<f64>,
        c: DMatrix<f64>,
        d: DMatrix<f64>,
    ) -> Option<Self> {
        let matrices = [&a, &b, &c, &d];
        let mut entries = matrices.iter().flat_map(|matrix| matrix.iter());
        if !entries.all(|entry| entry.is_finite()) {
            return None;
        }
        let schur = SchurForm::new(&a)?;
        let cq = c.map(Complex::from) * &schur.q;
        Some(Self {
            a,
            b,
            c,
            d,
            q: schur.q,
            t: schur.t,
            cq,
        })
    }

    /// Copies a model's matrices; `None` under the conditions of [`SchurModel::new`].
    pub(crate) fn from_state_space(model: &StateSpace) -> Option<Self> {
        Self::new(
            model.a().clone(),
            model.b().clone(),
            model.c().clone(),
            model.d().clone(),
        )
    }

    /// Returns the four matrices; `None` for a model without states.
    pub(crate) fn state_space(&self) -> Option<StateSpace> {
        let matrices = [&self.a, &self.b, &self.c, &self.d];
        let [a, b, c, d] = matrices.map(DMatrix::clone);
        StateSpace::new(a, b, c, d).ok()
    }

    pub(crate) fn order(&self) -> usize {
        self.a.nrows()
    }

    /// Returns `k`, the parameter count less the n^2 coordinate changes.
    pub(crate) fn parameters(&self) -> usize {
        let (outputs, inputs) = self.d.shape();
        parameters_of_order(self.order(), inputs, outputs)
    }

    /// Returns `A`, n x n.
    pub(crate) fn a(&self) -> &DMatrix<f64> {
        &self.a
    }

    /// Returns the model with the same response in the coordinates `x = T z`; `inverse` is the
    /// inverse of `transformation`, T. `None` under the conditions of [`SchurModel::new`].
    pub(crate) fn in_coordinates(
        &self,
        transformation: &DMatrix<f64>,
        inverse: &DMatrix<f64>,
    ) -> Option<Self> {
        Self::new(
            inverse * &self.a * transformation,
            inverse * &self.b,
            &self.c * transformation,
            self.d.clone(),
        )
    }

    /// Returns the model after a step in `[[A, B], [C, D]]`, (n + outputs) x (n + inputs); `None`
    /// under the conditions of [`SchurModel::new`].
    pub(crate) fn stepped(&self, step: &DMatrix<f64>) -> Option<Self> {
        let (outputs, inputs) = self.d.shape();
        let order = self.order();
        Self::new(
            &self.a + step.view((0, 0), (order, order)),
            &self.b + step.view((0, order), (order, inputs)),
            &self.c + step.view((order, 0), (outputs, order)),
            &self.d + step.view((order, order), (outputs, inputs)),
        )
    }

    /// Computes `X = (j omega - A)^-1 (B U + tau)` at many frequencies \[rad/s\], n x lines;
    /// `inputs` is U, inputs x lines, and `transient` is tau, initial less final state (`cost`).
    pub(crate) fn states(
        &self,
        omega: &[f64],
        inputs: &DMatrix<Complex<f64>>,
        transient: &DVector<f64>,
    ) -> DMatrix<Complex<f64>> {
        let order = self.order();
        let driven = self.q.ad_mul(&self.b.map(Complex::from));
        let initial = self.q.ad_mul(&transient.map(Complex::from));
        // w = (j omega - T)^-1 Q^H (B U + tau), from the last row up; X = Q w.
        let mut solutions = DMatrix::zeros(order, omega.len());
        for (k, omega) in omega.iter().enumerate() {
            let mut solution = initial.clone();
            for (column, input) in driven.column_iter().zip(inputs.column(k).iter()) {
                for (to, entry) in solution.iter_mut().zip(column.iter()) {
                    *to += entry * input;
                }
            }
            self.solve_schur(*omega, solution.as_mut_slice());
            solutions.set_column(k, &solution);
        }
        let [q_re, q_im] = [self.q.map(|q| q.re), self.q.map(|q| q.im)];
        let [w_re, w_im] = [solutions.map(|w| w.re), solutions.map(|w| w.im)];
        let re = &q_re * &w_re - &q_im * &w_im;
        let im = q_re * w_im + q_im * w_re;
        re.zip_map(&im, Complex::new)
    }

    /// Solves `(j omega - T) w = z` in place, from the last row up.
    fn solve_schur(&self, omega: f64, z: &mut [Complex<f64>]) {
        for column in (0..z.len()).rev() {
            let above = self.t.column(column);
            z[column] /= Complex::new(0.0, omega) - above[column];
            let solved = z[column];
            for (entry, to) in above.iter().zip(&mut z[..column]) {
                *to += entry * solved;
            }
        }
    }

    /// Returns `w^H` and `v` for the eigenvalue with this index, with `w^H A = lambda w^H`, `A v =
    /// lambda v` and `w^H v = 1`. The entries are not finite for a double eigenvalue.
    ///
    /// Eigenvectors of T by substitution, each 1 in this row: the right one has zeros below it, the
    /// left one before it, so that their product is 1. Q converts them to eigenvectors of `A`.
    pub(crate) fn eigenvectors(&self, number: usize) -> Eigenvectors {
        let order = self.order();
        let pole = self.t[(number, number)];
        let mut left = DVector::<Complex<f64>>::zeros(order);
        let mut right = left.clone();
        left[number] = Complex::from(1.0);
        right[number] = Complex::from(1.0);
        for row in (0..number).rev() {
            let products = (row + 1..=number).map(|k| self.t[(row, k)] * right[k]);
            right[row] = products.sum::<Complex<f64>>() / (pole - self.t[(row, row)]);
        }
        for column in number + 1..order {
            let products = (number..column).map(|k| left[k] * self.t[(k, column)]);
            left[column] = products.sum::<Complex<f64>>() / (pole - self.t[(column, column)]);
        }
        Eigenvectors {
            left: self.q.map(|q| q.conj()) * left,
            right: &self.q * right,
        }
    }

    /// Returns the eigenvalues of `A`, in the order in which [`Self::eigenvectors`] counts them.
    pub(crate) fn poles(&self) -> Vec<Complex<f64>> {
        self.t.diagonal().iter().copied().collect()
    }

    /// Returns `B`, n x inputs.
    pub(crate) fn b(&self) -> &DMatrix<f64> {
        &self.b
    }

    /// Returns `C`, outputs x n.
    pub(crate) fn c(&self) -> &DMatrix<f64> {
        &self.c
    }

    /// Returns `D`, outputs x inputs.
    pub(crate) fn d(&self) -> &DMatrix<f64> {
        &self.d
    }

    /// Computes `C (j omega - A)^-1`, outputs x n, into `cr`, column after column.
    pub(crate) fn output_resolvent(&self, omega: f64, cr: &mut [Complex<f64>]) {
        let outputs = self.c.nrows();
        let order = self.order();
        // Y (j omega - T) = C Q, column by column; outputs x n.
        let mut y = self.cq.as_slice().to_vec();
        for column in 0..order {
            let (before, from) = y.split_at_mut(column * outputs);
            let current = &mut from[..outputs];
            let above = self.t.column(column);
            for (left, entry) in before.chunks_exact(outputs).zip(above.iter()) {
                for (to, value) in current.iter_mut().zip(left) {
                    *to += value * entry;
                }
            }
            let inverse = 1.0 / (Complex::new(0.0, omega) - above[column]);
            for value in current {
                *value *= inverse;
            }
        }
        cr.fill(Complex::default());
        for (k, left) in y.chunks_exact(outputs).enumerate() {
            let schur_vector = self.q.column(k);
            for (column, entry) in cr.chunks_exact_mut(outputs).zip(schur_vector.iter()) {
                let factor = entry.conj();
                for (to, value) in column.iter_mut().zip(left) {
                    *to += value * factor;
                }
            }
        }
    }

    /// Computes `C (j omega - A)^-1 B + D` at a frequency \[rad/s\], outputs x inputs.
    pub(crate) fn response(&self, omega: f64) -> DMatrix<Complex<f64>> {
        let mut cr = DMatrix::zeros(self.c.nrows(), self.order());
        self.output_resolvent(omega, cr.as_mut_slice());
        cr * self.b.map(Complex::from) + self.d.map(Complex::from)
    }
}
