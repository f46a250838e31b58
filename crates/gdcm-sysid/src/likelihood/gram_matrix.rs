//! Inverts Gram matrices, `G = M'M` for a matrix M whose columns may depend on each other, and
//! solves with positive definite ones.

use nalgebra::{DMatrix, DVector};

/// Scales the columns behind a Gram matrix to unit length.
///
/// Returns the factors; 0 for a zero column.
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

/// Computes `F` with `F F' = G^+` for a Gram matrix `G`, from its eigenvectors in scaled columns.
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

/// Number of rows and columns that are factored at a time.
const PANEL: usize = 48;

/// Solves `A x = b` for a symmetric positive definite `A`, using its lower triangle; `None` if it
/// is not positive definite.
///
/// ```text
/// for each panel k of 48 columns:
/// 1  A_kk = L_kk L_kk'
/// 2  L_ik = A_ik L_kk'^-1 for the rows i below
/// 3  A_ij -= L_ik L_jk' for the panels j to the right, i from j down
/// ```
///
/// Step 3 takes nearly all the time, and runs as matrix products.
pub(crate) fn solve_positive_definite(
    mut matrix: DMatrix<f64>,
    right: &DVector<f64>,
) -> Option<DVector<f64>> {
    let size = matrix.nrows();
    for first in (0..size).step_by(PANEL) {
        let width = PANEL.min(size - first);
        let next = first + width;
        // Step 1.
        let diagonal = matrix.view((first, first), (width, width)).into_owned();
        let lower = diagonal.cholesky()?.unpack();
        let below = size - next;
        // Step 2: L_ik' = L_kk^-1 A_ik'
        let turned = matrix.view((next, first), (below, width)).transpose();
        let factor = lower.solve_lower_triangular(&turned)?.transpose();
        matrix
            .view_mut((first, first), (width, width))
            .copy_from(&lower);
        // Step 3.
        for column in (next..size).step_by(PANEL) {
            let columns = PANEL.min(size - column);
            let rows = factor.rows(column - next, size - column);
            let turned = factor.rows(column - next, columns).transpose();
            matrix
                .view_mut((column, column), (size - column, columns))
                .gemm(-1.0, &rows, &turned, 1.0);
        }
        matrix
            .view_mut((next, first), (below, width))
            .copy_from(&factor);
    }
    let solved = matrix.solve_lower_triangular(right)?;
    matrix.tr_solve_lower_triangular(&solved)
}
