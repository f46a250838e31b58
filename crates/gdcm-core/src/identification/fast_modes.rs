//! A model without its modes far above the band, their static part kept.
//!
//! ```text
//! 1  A = Q T Q^H, T upper triangular; neighbours on its diagonal are exchanged until the slow ones stand first
//! 2  Q1 an orthonormal real basis of what the first columns of Q span, Q2 of its complement
//! 3  [Q1 Q2]' A [Q1 Q2] = [A1 A12; 0 A2];  A1 X - X A2 = -A12 (Sylvester)
//! 4  slow: A1, B1 = Q1'B - X Q2'B, C1 = C Q1;   fast: A2, B2 = Q2'B, C2 = C (Q1 X + Q2)
//! 5  D + C2 (-A2)^-1 B2
//! ```
//!
//! Golub & Van Loan, "Matrix Computations", 4th ed. 2013, 7.6.

use super::StateSpaceMatrices;
use super::eigenvectors::ComplexSchur;
use nalgebra::{Complex, DMatrix};

impl StateSpaceMatrices {
    /// The model without the modes with `|lambda| > limit` \[rad/s\], equal to it at omega = 0; none where an iteration does not
    /// end or fast and slow modes cannot be told apart.
    pub(super) fn without_fast_modes(&self, limit: f64) -> Option<Self> {
        let mut schur = ComplexSchur::of(&self.a)?;
        let slow = schur.order_by(|eigenvalue| eigenvalue.norm() <= limit);
        let order = self.order();
        if slow == order {
            return Some(self.clone());
        }
        let basis = real_basis(&schur.q, slow);
        let (q1, q2) = (basis.columns(0, slow), basis.columns(slow, order - slow));
        let (a1, a2) = (q1.transpose() * &self.a * q1, q2.transpose() * &self.a * q2);
        let x = sylvester(&a1, &a2, &(q1.transpose() * &self.a * q2))?;
        let b2 = q2.transpose() * &self.b;
        let c2 = &self.c * (q1 * &x + q2);
        let model = Self {
            a: a1,
            b: q1.transpose() * &self.b - &x * &b2,
            c: &self.c * q1,
            d: &self.d - c2 * a2.lu().solve(&b2)?,
        };
        model.is_finite().then_some(model)
    }
}

/// An orthonormal basis whose first `count` columns span the same as the first `count` columns of `q`, which are conjugates of
/// each other or real.
fn real_basis(q: &DMatrix<Complex<f64>>, count: usize) -> DMatrix<f64> {
    let order = q.nrows();
    // The projector on the span is real, with the eigenvalues one and zero.
    let leading = q.columns(0, count);
    let projector = DMatrix::from_fn(order, order, |row, column| {
        leading.row(row).iter().zip(leading.row(column).iter()).map(|(x, y)| (x * y.conj()).re).sum()
    });
    let eigen = nalgebra::SymmetricEigen::<f64, nalgebra::Dyn>::new(projector);
    let mut by_size: Vec<usize> = (0..order).collect();
    by_size.sort_by(|&i, &j| eigen.eigenvalues[j].total_cmp(&eigen.eigenvalues[i]));
    eigen.eigenvectors.select_columns(&by_size)
}

/// `X` of `A1 X - X A2 = -A12`.
fn sylvester(a1: &DMatrix<f64>, a2: &DMatrix<f64>, a12: &DMatrix<f64>) -> Option<DMatrix<f64>> {
    let (rows, columns) = a12.shape();
    let identity = |size| DMatrix::<f64>::identity(size, size);
    let system = identity(columns).kronecker(a1) - a2.transpose().kronecker(&identity(rows));
    let stacked = nalgebra::DVector::from_column_slice((-a12).as_slice());
    Some(DMatrix::from_column_slice(rows, columns, system.lu().solve(&stacked)?.as_slice()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::identification::known_answers::{answers, matrix, number, numbers, response};

    #[test]
    fn what_is_left_is_that_of_independent_code() {
        let known = &answers()["drop_fast"];
        let of = |name: &str| matrix(&known[name]);
        let model = StateSpaceMatrices { a: of("A"), b: of("B"), c: of("C"), d: of("D") };
        let slow = model.without_fast_modes(number(&known["wmax"])).unwrap();
        assert_eq!(slow.order() as f64, number(&known["order"]));
        for (omega, expected) in numbers(&known["w"]).into_iter().zip(response(&known["H"])) {
            // Independent numpy code; the tolerance stands in its file.
            assert!((slow.response(omega).unwrap() - expected).camax() < 1e-9);
        }
    }

    #[test]
    fn a_model_without_fast_modes_stays_as_it_is() {
        let known = &answers()["drop_fast"];
        let of = |name: &str| matrix(&known[name]);
        let model = StateSpaceMatrices { a: of("A"), b: of("B"), c: of("C"), d: of("D") };
        assert_eq!(model.without_fast_modes(1000.0).unwrap(), model);
    }
}
