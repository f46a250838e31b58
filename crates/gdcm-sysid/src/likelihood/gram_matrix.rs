//! Inverses of Gram matrices whose columns may depend on each other.

use nalgebra::{DMatrix, DVector};

/// Scales the columns behind a Gram matrix to unit length.
///
/// Returns the factors; the factor of a zero column is 0.
pub(crate) fn scale_columns(gram: &mut DMatrix<f64>) -> DVector<f64> {
    let scales = gram.diagonal().map(inverse_root);
    let size = scales.len();
    for (at, entry) in gram.iter_mut().enumerate() {
        *entry *= scales[at % size] * scales[at / size];
    }
    scales
}

/// Returns `1 / sqrt(square)`, or 0 for a zero column.
fn inverse_root(square: f64) -> f64 {
    if square > 0.0 {
        1.0 / square.sqrt()
    } else {
        0.0
    }
}

/// Computes `F` with `F F' = G^+` for a Gram matrix `G` by its eigenvectors in scaled columns.
///
/// Eigenvalues up to `dependent` times the largest are omitted. Returns `None` if the matrix is not
/// finite or the eigenvalue iteration does not converge.
pub(crate) fn pseudo_inverse_root(mut gram: DMatrix<f64>, dependent: f64) -> Option<DMatrix<f64>> {
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
