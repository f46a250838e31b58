//! A mode's eigenvectors, with the state participation and the residues that follow from them.
//!
//! With `A = Q T Q^H`, A balanced, T upper triangular with the eigenvalues `lambda_k` on its
//! diagonal (`schur_form.rs`), for eigenvalue k:
//!
//! ```text
//! 1  x_k = 1, x_j = -(sum_(j < i <= k) t_ji x_i) / (t_jj - lambda_k), j = k - 1 ... 1;   v = Q x
//! 2  y_k = 1, y_j = -(sum_(k <= i < j) y_i t_ij) / (t_jj - lambda_k), j = k + 1 ... n;   w = y Q^H
//! 3  w v = 1: the pole moves by |w| |v| per unit change in A; beyond a limit it is near defective
//! 4  participation of state i: |w_i v_i| / sum_j |w_j v_j|, independent of the state units
//! 5  residue of output i over the inputs together: (C v)_i |w B|
//! ```
//!
//! Eigenvectors: Golub & Van Loan, "Matrix Computations", 4th ed. 2013, 7.6.4. Participation:
//! Perez-Arriaga, Verghese & Schweppe, "Selective modal analysis", IEEE Trans. Power Apparatus and
//! Systems 101(9), 1982.

use nalgebra::{Complex, DMatrix, DVector};

use super::schur_form::SchurForm;

/// Maximum pole displacement per unit change in the balanced A at which eigenvectors are
/// meaningful. In floating point, a double pole with a single eigenvector has about 1e8, a well
/// separated pole less than 1e3.
const NEAR_DEFECTIVE: f64 = 1e6;

/// Right and left eigenvectors for an eigenvalue: `A v = lambda v`, `w A = lambda w` and `w v = 1`.
pub(super) struct Eigenvectors {
    /// `v`.
    right: DVector<Complex<f64>>,
    /// `w`, as a column.
    left: DVector<Complex<f64>>,
}

impl Eigenvectors {
    /// Computes the eigenvectors for the eigenvalue at diagonal position `index` of `T` (steps 1 to
    /// 3).
    ///
    /// # Errors
    /// [`NearDefective`] if they are dominated by rounding errors.
    pub(super) fn new(form: &SchurForm, index: usize) -> Result<Self, NearDefective> {
        // Steps 1 and 2.
        let x = form.right(index);
        let y = form.left(index);
        // Step 3: `y x = 1`, because only entry k is nonzero in both.
        let movement = x.norm() * y.norm();
        // `!movement.le(...)` is also true for NaN, which results if the eigenvectors overflow.
        if !movement.le(&NEAR_DEFECTIVE) {
            return Err(NearDefective { movement });
        }
        Ok(Self {
            right: &form.q * x,
            left: form.q.conjugate() * y,
        })
    }

    /// Returns the state participation (state index, share) in descending order (step 4).
    pub(super) fn participation(&self) -> Vec<(usize, f64)> {
        let products: Vec<f64> = self
            .right
            .iter()
            .zip(&self.left)
            .map(|(v, w)| (v * w).norm())
            .collect();
        let sum: f64 = products.iter().sum();
        let mut shares: Vec<(usize, f64)> = products
            .into_iter()
            .map(|product| product / sum)
            .enumerate()
            .collect();
        shares.sort_by(|a, b| b.1.total_cmp(&a.1));
        shares
    }

    /// Returns each output's residue `(C v)_i |w B|` (step 5).
    pub(super) fn residues(&self, b: &DMatrix<f64>, c: &DMatrix<f64>) -> Vec<Complex<f64>> {
        let input_norm = (b.map(Complex::from).transpose() * &self.left).norm();
        (c.map(Complex::from) * &self.right)
            .iter()
            .map(|output| output * input_norm)
            .collect()
    }
}

/// Error for a pole whose eigenvectors, and thus the state participation, are dominated by rounding
/// errors: the pole coincides or shares an eigenvector with another pole, as for two identical
/// sensors.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error(
    "the pole cannot be distinguished from a neighbouring pole: a relative change of 1e-16 in A \
    moves it {movement:.0e} times as far, so that its state participation is meaningless"
)]
pub struct NearDefective {
    /// Pole displacement per unit change in A.
    pub movement: f64,
}
