//! A model whose parameters are all entries of `A`, `B`, `C` and `D` (M14.19).

use nalgebra::{Complex, DMatrix, DVector};

use gdcm_model::dataset::StateSpace;
use gdcm_model::response::schur_form::SchurForm;

use super::blocks::BlockModel;
use super::linear_model::LinearModel;

/// A state-space model with the Schur form of its `A`.
///
/// ```text
/// A = Q T Q^H,   C (j omega - A)^-1 = (C Q) (j omega - T)^-1 Q^H
/// ```
#[derive(Clone, Debug)]
pub(crate) struct DenseModel {
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

impl DenseModel {
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

    /// Copies the matrices of a model.
    pub(crate) fn from_state_space(model: &StateSpace) -> Option<Self> {
        Self::new(
            model.a().clone(),
            model.b().clone(),
            model.c().clone(),
            model.d().clone(),
        )
    }

    /// Returns `A`, n x n.
    pub(crate) fn a(&self) -> &DMatrix<f64> {
        &self.a
    }

    /// Returns the model with the same response in the coordinates `x = T z`; `None` if `inverse`,
    /// the inverse of `transformation`, or the result is not finite.
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

    /// Returns the model after a step in `[[A, B], [C, D]]`, (n + outputs) x (n + inputs).
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

    /// Returns the four matrices; `None` for a model without states.
    pub(crate) fn state_space(&self) -> Option<StateSpace> {
        StateSpace::new(
            self.a.clone(),
            self.b.clone(),
            self.c.clone(),
            self.d.clone(),
        )
        .ok()
    }

    /// Returns the model in blocks; `None` if it has poles so close that their eigenvectors cannot
    /// be separated.
    pub(crate) fn blocks(&self) -> Option<BlockModel> {
        BlockModel::from_state_space(&self.state_space()?)
    }

    /// Computes `X = (j omega - A)^-1 (B U + tau)` at many frequencies \[rad/s\]; `inputs` is U,
    /// inputs x lines. n x lines.
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

    /// Returns the eigenvalues of `A`.
    pub(crate) fn poles(&self) -> Vec<Complex<f64>> {
        self.t.diagonal().iter().copied().collect()
    }
}

impl LinearModel for DenseModel {
    fn b(&self) -> &DMatrix<f64> {
        &self.b
    }

    fn c(&self) -> &DMatrix<f64> {
        &self.c
    }

    fn d(&self) -> &DMatrix<f64> {
        &self.d
    }

    fn output_resolvent(&self, omega: f64, cr: &mut [Complex<f64>]) {
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

    fn resolve(&self, omega: f64, x: &mut [Complex<f64>]) {
        let order = self.order();
        let mut z: Vec<Complex<f64>> = Vec::with_capacity(order);
        for schur_vector in self.q.column_iter() {
            z.push(
                schur_vector
                    .iter()
                    .zip(&*x)
                    .map(|(q, x)| q.conj() * x)
                    .sum(),
            );
        }
        self.solve_schur(omega, &mut z);
        x.fill(Complex::default());
        for (schur_vector, value) in self.q.column_iter().zip(&z) {
            for (to, entry) in x.iter_mut().zip(schur_vector.iter()) {
                *to += entry * value;
            }
        }
    }
}
