//! Complex Schur form of a real matrix: the eigenvalues, and a triangular matrix for computing the
//! eigenvectors.
//!
//! ```text
//! 1  A = Q T Q', T with 1 x 1 and 2 x 2 blocks on its diagonal: Francis' implicit double shifts
//! 2  for each 2 x 2 block [e f; g k]: mean and half difference m = (e + k) / 2, h = (e - k) / 2
//!       lambda = m +- j sqrt(-(h^2 + f g)), exact conjugates; or two real eigenvalues
//! 3     rotate its rows and columns so that the block becomes triangular: the first column of the
//!       rotation, (cosine, sine) = (lambda - k, g) / norm, is the block's eigenvector for lambda
//! ```
//!
//! On request, neighbouring eigenvalues are exchanged by rotating their rows and columns, so that
//! chosen eigenvalues come first ([`SchurForm::order_by`]).
//!
//! Golub & Van Loan, "Matrix Computations", 4th ed. 2013, 7.4 to 7.6.

use nalgebra::{Complex, DMatrix, DVector, Schur};

/// `A = Q T Q^H` with `Q` unitary and `T` upper triangular.
pub struct SchurForm {
    /// Schur vectors, one per column.
    pub q: DMatrix<Complex<f64>>,
    /// Upper triangular matrix with the eigenvalues on its diagonal.
    pub t: DMatrix<Complex<f64>>,
    /// Minimum magnitude for a difference between eigenvalues used as a divisor: their rounding
    /// error. It replaces the zero difference of equal eigenvalues.
    least_difference: f64,
}

impl SchurForm {
    /// Computes a square matrix's Schur form; `None` if the iteration does not converge.
    pub fn new(a: &DMatrix<f64>) -> Option<Self> {
        // Step 1.
        let (q, t) = quasi_triangular(a)?;
        // First row in each 2 x 2 block.
        let blocks: Vec<usize> = (1..a.nrows())
            .filter(|&row| t[(row, row - 1)] != 0.0)
            .map(|row| row - 1)
            .collect();
        let mut form = Self {
            q: q.map(Complex::from),
            t: t.map(Complex::from),
            least_difference: 0.0,
        };
        // Steps 2 and 3.
        for first in blocks {
            let second = first + 1;
            let block = Block {
                e: t[(first, first)],
                f: t[(first, second)],
                g: t[(second, first)],
                k: t[(second, second)],
            };
            form.split(first, block);
        }
        form.least_difference = (f64::EPSILON * form.t.camax()).max(f64::MIN_POSITIVE);
        Some(form)
    }

    /// Returns the eigenvalues in diagonal order; conjugate pairs are exact.
    pub(super) fn eigenvalues(&self) -> Vec<Complex<f64>> {
        self.t.diagonal().iter().copied().collect()
    }

    /// Returns the unit-length eigenvector for the eigenvalue at diagonal position `at`.
    pub fn eigenvector(&self, at: usize) -> DVector<Complex<f64>> {
        (&self.q * self.right(at)).normalize()
    }

    /// Returns the right eigenvector x of T from `(T - t_kk) x = 0` with `x_k = 1`.
    pub(super) fn right(&self, k: usize) -> DVector<Complex<f64>> {
        let mut x = self.unit(k);
        for row in (0..k).rev() {
            let sum: Complex<f64> = (row + 1..=k)
                .map(|column| self.t[(row, column)] * x[column])
                .sum();
            x[row] = -sum / self.difference(row, k);
        }
        x
    }

    /// Returns the left eigenvector y of T from `y (T - t_kk) = 0` with `y_k = 1`.
    pub(super) fn left(&self, k: usize) -> DVector<Complex<f64>> {
        let mut y = self.unit(k);
        for column in k + 1..self.t.nrows() {
            let sum: Complex<f64> = (k..column).map(|row| y[row] * self.t[(row, column)]).sum();
            y[column] = -sum / self.difference(column, k);
        }
        y
    }

    /// Returns the unit vector with entry `k` equal to 1.
    fn unit(&self, k: usize) -> DVector<Complex<f64>> {
        DVector::from_fn(self.t.nrows(), |row, _| {
            Complex::from(if row == k { 1.0 } else { 0.0 })
        })
    }

    /// Returns the difference between two eigenvalues, or their rounding error if it is larger.
    fn difference(&self, at: usize, from: usize) -> Complex<f64> {
        let difference = self.t[(at, at)] - self.t[(from, from)];
        if difference.norm() < self.least_difference {
            Complex::from(self.least_difference)
        } else {
            difference
        }
    }

    /// Exchanges neighbouring eigenvalues until those for which `first` holds come first; returns
    /// their number.
    pub fn order_by(&mut self, first: impl Fn(Complex<f64>) -> bool) -> usize {
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

    /// Exchanges the eigenvalues at diagonal positions `upper` and `upper + 1` by rotating these
    /// two rows and columns.
    fn exchange(&mut self, upper: usize) {
        let lower = upper + 1;
        let first = self.t[(upper, upper)];
        let second = self.t[(lower, lower)];
        // `(x, y)`: eigenvector for `second` in the 2 x 2 block.
        let x = self.t[(upper, lower)];
        let y = second - first;
        let norm = x.norm().hypot(y.norm());
        if norm == 0.0 {
            return;
        }
        let cosine = x / norm;
        let sine = y / norm;
        for matrix in [&mut self.t, &mut self.q] {
            for row in 0..matrix.nrows() {
                let left = matrix[(row, upper)];
                let right = matrix[(row, lower)];
                matrix[(row, upper)] = left * cosine + right * sine;
                matrix[(row, lower)] = right * cosine.conj() - left * sine.conj();
            }
        }
        for column in 0..self.t.ncols() {
            let above = self.t[(upper, column)];
            let below = self.t[(lower, column)];
            self.t[(upper, column)] = above * cosine.conj() + below * sine.conj();
            self.t[(lower, column)] = below * cosine - above * sine;
        }
        self.t[(lower, upper)] = Complex::new(0.0, 0.0);
        self.t[(upper, upper)] = second;
        self.t[(lower, lower)] = first;
    }

    /// Makes the 2 x 2 block in rows `first` and `first + 1` triangular by a rotation (steps 2 and
    /// 3).
    fn split(&mut self, first: usize, block: Block) {
        let second = first + 1;
        let size = self.t.nrows();
        let eigenvalues = block.eigenvalues();
        let distance = eigenvalues[0] - block.k;
        let norm = distance.norm().hypot(block.g);
        let cosine = distance / norm;
        let sine = block.g / norm;
        for column in first..size {
            let upper = self.t[(first, column)];
            let lower = self.t[(second, column)];
            self.t[(first, column)] = cosine.conj() * upper + lower * sine;
            self.t[(second, column)] = cosine * lower - upper * sine;
        }
        for row in 0..size {
            if row <= second {
                rotate_columns(&mut self.t, row, first, cosine, sine);
            }
            rotate_columns(&mut self.q, row, first, cosine, sine);
        }
        self.t[(second, first)] = Complex::new(0.0, 0.0);
        [self.t[(first, first)], self.t[(second, second)]] = eigenvalues;
    }
}

/// Rotates a row's entries in columns `first` and `first + 1`.
fn rotate_columns(
    matrix: &mut DMatrix<Complex<f64>>,
    row: usize,
    first: usize,
    cosine: Complex<f64>,
    sine: f64,
) {
    let left = matrix[(row, first)];
    let right = matrix[(row, first + 1)];
    matrix[(row, first)] = left * cosine + right * sine;
    matrix[(row, first + 1)] = right * cosine.conj() - left * sine;
}

/// A 2 x 2 diagonal block `[e f; g k]`.
#[derive(Clone, Copy)]
struct Block {
    e: f64,
    f: f64,
    g: f64,
    k: f64,
}

impl Block {
    /// Returns the eigenvalues; in a conjugate pair, the one with positive imaginary part comes
    /// first.
    fn eigenvalues(self) -> [Complex<f64>; 2] {
        let Self { e, f, g, k } = self;
        let mean = 0.5 * (e + k);
        let half_difference = 0.5 * (e - k);
        let discriminant = half_difference * half_difference + f * g;
        if discriminant < 0.0 {
            let imaginary = (-discriminant).sqrt();
            return [
                Complex::new(mean, imaginary),
                Complex::new(mean, -imaginary),
            ];
        }
        // `far`, the larger distance from k, is computed without cancellation; `near` follows from
        // the product of both distances, -f g.
        let far = half_difference + discriminant.sqrt().copysign(half_difference);
        let near = if far == 0.0 { 0.0 } else { -f * g / far };
        [Complex::from(k + far), Complex::from(k + near)]
    }
}

/// Computes the real Schur form `A = Q T Q'` (step 1); returns Q and T. The iteration can stall,
/// since a cyclic permutation is one of its fixed points; it is then repeated for the matrix
/// reflected along two different axes in turn, which has the same eigenvalues but not the structure
/// that stalls. `None` if no attempt converges.
fn quasi_triangular(a: &DMatrix<f64>) -> Option<(DMatrix<f64>, DMatrix<f64>)> {
    const TRIES: i32 = 3;
    /// Maximum iteration count per eigenvalue; three or four are typical.
    const ITERATIONS_PER_EIGENVALUE: usize = 60;
    let size = a.nrows();
    let most = ITERATIONS_PER_EIGENVALUE * (size + 1);
    if let Some(schur) = Schur::try_new(a.clone(), f64::EPSILON, most) {
        return Some(schur.unpack());
    }
    for attempt in 1..TRIES {
        // Any axis serves whose entries have no pattern.
        let axis = DVector::from_fn(size, |row, _| (1.0 + f64::from(attempt) * row as f64).sin())
            .normalize();
        let reflection = DMatrix::identity(size, size) - 2.0 * &axis * axis.transpose();
        if let Some(schur) = Schur::try_new(&reflection * a * &reflection, f64::EPSILON, most) {
            let (q, t) = schur.unpack();
            return Some((reflection * q, t));
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use nalgebra::dmatrix;

    use super::*;

    fn check(a: &DMatrix<f64>) {
        let form = SchurForm::new(a).unwrap();
        let again = &form.q * &form.t * form.q.adjoint();
        // Tolerance: a few hundred rotations of the whole matrix, each backward stable.
        assert!((again - a.map(Complex::from)).norm() < 1e-13 * a.norm());
        let below = (0..a.nrows()).flat_map(|row| (0..row).map(move |column| (row, column)));
        assert!(
            below
                .into_iter()
                .all(|at| form.t[at].norm() <= 1e-15 * a.norm())
        );
    }

    #[test]
    fn eigenvectors_satisfy_their_equation() {
        let a = DMatrix::from_fn(9, 9, |row, column| {
            ((1.0 + 7.3 * row as f64) * (1.0 + 2.9 * column as f64)).sin()
        });
        let form = SchurForm::new(&a).unwrap();
        for at in 0..9 {
            let vector = form.eigenvector(at);
            assert!((a.map(Complex::from) * &vector - &vector * form.t[(at, at)]).norm() < 1e-12);
        }
    }

    #[test]
    fn the_form_gives_the_matrix_again() {
        check(&DMatrix::from_fn(9, 9, |row, column| {
            ((1.0 + 7.3 * row as f64) * (1.0 + 2.9 * column as f64)).sin()
        }));
        check(&dmatrix![0.0, 1.0; -4.0, -0.4]);
        check(&dmatrix![1.0, 1e-9; 1e-9, 1.0]);
    }

    #[test]
    fn a_cyclic_permutation_has_the_roots_of_unity() {
        let shift = DMatrix::from_fn(
            8,
            8,
            |row, column| if row == (column + 1) % 8 { 1.0 } else { 0.0 },
        );
        check(&shift);
        for eigenvalue in SchurForm::new(&shift).unwrap().eigenvalues() {
            // Tolerance: the matrix is orthogonal, so that each eigenvalue has condition number 1.
            assert!((eigenvalue.powi(8) - 1.0).norm() < 1e-12);
        }
    }

    #[test]
    fn real_eigenvalues_of_a_block_have_no_cancellation() {
        let [far, near] = Block {
            e: 1e8,
            f: 1.0,
            g: 1.0,
            k: 0.0,
        }
        .eigenvalues();
        // lambda^2 - 1e8 lambda - 1 = 0: the smaller root is -1e-8 (1 - 1e-16).
        assert!(
            (far.re - 1e8).abs() < 1e-7 && (near.re + 1e-8).abs() < 1e-22,
            "{far} {near}"
        );
    }
}
