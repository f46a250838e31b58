//! Eigenvalues of a real matrix, and the triangular form that its eigenvectors come from.
//!
//! ```text
//! 1  A = Q T Q', T with blocks of one and two rows on its diagonal: Francis' implicit double shifts
//! 2  for each block of two rows [p q; r s]: mean and half difference m = (p + s) / 2, h = (p - s) / 2
//!       lambda = m +- j sqrt(-(h^2 + q r)), conjugate to the last digit; or two real ones
//! 3     rotate its rows so that the block becomes triangular: first column (lambda - s, r) / norm
//! ```
//!
//! Golub & Van Loan, "Matrix Computations", 4th ed. 2013, 7.4 and 7.5.

use nalgebra::{Complex, DMatrix, DVector, Schur};

/// `A = Q T Q^H` with `Q` unitary and `T` upper triangular.
pub(super) struct SchurForm {
    /// Schur vectors.
    pub(super) q: DMatrix<Complex<f64>>,
    /// Triangular, with the eigenvalues on its diagonal.
    pub(super) t: DMatrix<Complex<f64>>,
}

impl SchurForm {
    /// The form of a square matrix; `None` where the iteration does not come to an end.
    pub(super) fn of(a: &DMatrix<f64>) -> Option<Self> {
        let (q, t) = quasi_triangular(a)?;
        let blocks: Vec<usize> = (1..a.nrows()).filter(|&row| t[(row, row - 1)] != 0.0).map(|row| row - 1).collect();
        let mut form = Self { q: q.map(Complex::from), t: t.map(Complex::from) };
        for first in blocks {
            form.split(first, t.fixed_view::<2, 2>(first, first).into_owned().transpose().data.0);
        }
        Some(form)
    }

    /// The eigenvalues, in the order of the diagonal; those of a pair are conjugate to the last digit.
    pub(super) fn eigenvalues(&self) -> Vec<Complex<f64>> {
        self.t.diagonal().iter().copied().collect()
    }

    /// Makes the block of the rows `first` and `first + 1` triangular.
    fn split(&mut self, first: usize, block: [[f64; 2]; 2]) {
        let (second, size) = (first + 1, self.t.nrows());
        let eigenvalues = eigenvalues_of_block(block);
        let (mu, below) = (eigenvalues[0] - block[1][1], block[1][0]);
        let norm = mu.norm().hypot(below);
        let (c, s) = (mu / norm, below / norm);
        for column in first..size {
            let (upper, lower) = (self.t[(first, column)], self.t[(second, column)]);
            self.t[(first, column)] = c.conj() * upper + lower * s;
            self.t[(second, column)] = c * lower - upper * s;
        }
        for row in 0..size {
            if row <= second {
                rotate_columns(&mut self.t, row, first, (c, s));
            }
            rotate_columns(&mut self.q, row, first, (c, s));
        }
        self.t[(second, first)] = Complex::new(0.0, 0.0);
        [self.t[(first, first)], self.t[(second, second)]] = eigenvalues;
    }
}

fn rotate_columns(matrix: &mut DMatrix<Complex<f64>>, row: usize, first: usize, (c, s): (Complex<f64>, f64)) {
    let (left, right) = (matrix[(row, first)], matrix[(row, first + 1)]);
    matrix[(row, first)] = left * c + right * s;
    matrix[(row, first + 1)] = right * c.conj() - left * s;
}

/// The eigenvalues of two rows `[p q; r s]`, the one with a positive imaginary part first.
fn eigenvalues_of_block([[p, q], [r, s]]: [[f64; 2]; 2]) -> [Complex<f64>; 2] {
    let (mean, half) = (0.5 * (p + s), 0.5 * (p - s));
    let squared = half * half + q * r;
    if squared < 0.0 {
        let imaginary = (-squared).sqrt();
        return [Complex::new(mean, imaginary), Complex::new(mean, -imaginary)];
    }
    // Nothing cancels in the greater distance from s, and the product of the two distances is -q r.
    let far = half + squared.sqrt().copysign(half);
    let near = if far == 0.0 { 0.0 } else { -q * r / far };
    [Complex::from(s + far), Complex::from(s + near)]
}

/// `A = Q T Q'`. Where the iteration stalls (a cyclic permutation is its own image under it), it is repeated on a
/// reflection of the matrix, which has the same eigenvalues.
fn quasi_triangular(a: &DMatrix<f64>) -> Option<(DMatrix<f64>, DMatrix<f64>)> {
    const TRIES: i32 = 3;
    /// Three or four are usual.
    const ITERATIONS_FOR_EACH: usize = 60;
    let size = a.nrows();
    let most = ITERATIONS_FOR_EACH * (size + 1);
    (0..TRIES).find_map(|attempt| {
        if attempt == 0 {
            return Schur::try_new(a.clone(), f64::EPSILON, most).map(Schur::unpack);
        }
        let axis = DVector::from_fn(size, |row, _| (1.0 + f64::from(attempt) * row as f64).sin()).normalize();
        let reflection = DMatrix::identity(size, size) - 2.0 * &axis * axis.transpose();
        let (q, t) = Schur::try_new(&reflection * a * &reflection, f64::EPSILON, most)?.unpack();
        Some((reflection * q, t))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::dmatrix;

    fn check(a: &DMatrix<f64>) {
        let form = SchurForm::of(a).unwrap();
        let again = &form.q * &form.t * form.q.adjoint();
        // A few hundred rotations of the whole matrix, each backward stable.
        assert!((again - a.map(Complex::from)).norm() < 1e-13 * a.norm());
        let below = (0..a.nrows()).flat_map(|row| (0..row).map(move |column| (row, column)));
        assert!(below.into_iter().all(|at| form.t[at].norm() <= 1e-15 * a.norm()));
    }

    #[test]
    fn the_form_gives_the_matrix_again() {
        check(&DMatrix::from_fn(9, 9, |row, column| ((1.0 + 7.3 * row as f64) * (1.0 + 2.9 * column as f64)).sin()));
        check(&dmatrix![0.0, 1.0; -4.0, -0.4]);
        check(&dmatrix![1.0, 1e-9; 1e-9, 1.0]);
    }

    #[test]
    fn a_cyclic_permutation_has_the_roots_of_unity() {
        let shift = DMatrix::from_fn(8, 8, |row, column| if row == (column + 1) % 8 { 1.0 } else { 0.0 });
        check(&shift);
        for eigenvalue in SchurForm::of(&shift).unwrap().eigenvalues() {
            // Orthogonal: each eigenvalue has condition number 1.
            assert!((eigenvalue.powi(8) - 1.0).norm() < 1e-12);
        }
    }

    #[test]
    fn two_rows_with_real_eigenvalues_are_told_apart_without_cancellation() {
        let [far, near] = eigenvalues_of_block([[1e8, 1.0], [1.0, 0.0]]);
        // lambda^2 - 1e8 lambda - 1 = 0: the lesser is -1e-8 (1 - 1e-16).
        assert!((far.re - 1e8).abs() < 1e-7 && (near.re + 1e-8).abs() < 1e-22, "{far} {near}");
    }
}
