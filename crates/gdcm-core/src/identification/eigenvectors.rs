//! The complex Schur form of a real matrix, its reordering, and its eigenvectors.

use nalgebra::{Complex, DMatrix, DVector, Schur};

/// `A = Q T Q^H` with `Q` unitary and `T` upper triangular.
pub(super) struct ComplexSchur {
    /// Schur vectors.
    pub(super) q: DMatrix<Complex<f64>>,
    /// Triangular, with the eigenvalues on its diagonal.
    pub(super) t: DMatrix<Complex<f64>>,
}

impl ComplexSchur {
    /// The form of a square matrix; none where the iteration does not end.
    pub(super) fn of(a: &DMatrix<f64>) -> Option<Self> {
        let (q, t) = Schur::try_new(a.map(Complex::from), f64::EPSILON, 100 * (a.nrows() + 1))?.unpack();
        Some(Self { q, t })
    }

    /// Exchanges neighbours until the eigenvalues that are `first` stand first; gives how many there are.
    pub(super) fn order_by(&mut self, first: impl Fn(Complex<f64>) -> bool) -> usize {
        let mut placed = 0;
        for at in 0..self.t.nrows() {
            if first(self.t[(at, at)]) {
                for upper in (placed..at).rev() {
                    self.exchange(upper);
                }
                placed += 1;
            }
        }
        placed
    }

    /// Exchanges the eigenvalues at `upper` and `upper + 1` by one rotation of these two rows and columns.
    fn exchange(&mut self, upper: usize) {
        let lower = upper + 1;
        let (first, second) = (self.t[(upper, upper)], self.t[(lower, lower)]);
        // The eigenvector of `second` in these two rows.
        let (x, y) = (self.t[(upper, lower)], second - first);
        let norm = x.norm().hypot(y.norm());
        if norm == 0.0 {
            return;
        }
        let (c, s) = (x / norm, y / norm);
        for matrix in [&mut self.t, &mut self.q] {
            for row in 0..matrix.nrows() {
                let (left, right) = (matrix[(row, upper)], matrix[(row, lower)]);
                matrix[(row, upper)] = left * c + right * s;
                matrix[(row, lower)] = right * c.conj() - left * s.conj();
            }
        }
        for column in 0..self.t.ncols() {
            let (above, below) = (self.t[(upper, column)], self.t[(lower, column)]);
            self.t[(upper, column)] = above * c.conj() + below * s.conj();
            self.t[(lower, column)] = below * c - above * s;
        }
        self.t[(lower, upper)] = Complex::new(0.0, 0.0);
        (self.t[(upper, upper)], self.t[(lower, lower)]) = (second, first);
    }

    /// The eigenvector of length one of the eigenvalue at `at` of the diagonal, by back substitution.
    pub(super) fn eigenvector(&self, at: usize) -> DVector<Complex<f64>> {
        let smallest = f64::EPSILON * self.t.camax();
        let mut x = DVector::zeros(at + 1);
        x[at] = Complex::new(1.0, 0.0);
        for row in (0..at).rev() {
            let sum: Complex<f64> = (row + 1..=at).map(|k| self.t[(row, k)] * x[k]).sum();
            let gap = self.t[(row, row)] - self.t[(at, at)];
            x[row] = -sum / if gap.norm() < smallest { Complex::new(smallest, 0.0) } else { gap };
        }
        let vector = self.q.columns(0, at + 1) * x;
        let norm = vector.norm();
        vector.unscale(norm)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sample(size: usize) -> DMatrix<f64> {
        DMatrix::from_fn(size, size, |row, column| ((1.0 + 7.3 * row as f64) * (1.0 + 2.9 * column as f64)).sin())
    }

    #[test]
    fn the_form_still_gives_the_matrix_after_its_reordering() {
        let a = sample(9);
        let mut form = ComplexSchur::of(&a).unwrap();
        let before: Vec<_> = form.t.diagonal().iter().copied().collect();
        let count = form.order_by(|eigenvalue| eigenvalue.re > 0.0);
        assert_eq!(count, before.iter().filter(|eigenvalue| eigenvalue.re > 0.0).count());
        assert!((0..9).all(|at| (form.t[(at, at)].re > 0.0) == (at < count)));
        // A few dozen rotations, each backward stable.
        assert!((&form.q * &form.t * form.q.adjoint() - a.map(Complex::from)).norm() < 1e-13 * a.norm());
    }

    #[test]
    fn an_eigenvector_is_stretched_by_its_eigenvalue() {
        let a = sample(9).map(Complex::from);
        let form = ComplexSchur::of(&sample(9)).unwrap();
        for at in 0..9 {
            let vector = form.eigenvector(at);
            assert!((&a * &vector - &vector * form.t[(at, at)]).norm() < 1e-12);
        }
    }
}
