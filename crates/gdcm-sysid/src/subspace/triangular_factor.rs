//! Computes the triangular factor of a tall matrix that arrives in row blocks.
//!
//! ```text
//! R <- qr([R; rows]), R upper triangular, for each column panel J with the width w:
//!    b_j column j of rows;   e_j, E: unit columns of j and of J;   V = [v_j] over J
//! 1  for each column j in J: beta = -sign(R_jj) hypot(R_jj, |b_j|), v_j = b_j / (R_jj - beta),
//!       tau_j = (beta - R_jj) / beta
//!       the reflector is I - tau_j [e_j; v_j] [e_j; v_j]', applied to the later columns in J
//! 2  T upper triangular: T_jj = tau_j, T_:j = -tau_j T (V' v_j)            (I - [E; V] T [E; V]')
//! 3  columns right of J: W = T' (R_J + V' rows), R_J -= W, rows -= V W     (two matrix products)
//! ```
//!
//! Householder QR, so that nothing is squared, in the compact form of R. Schreiber & C. Van Loan,
//! "A storage-efficient WY representation for products of Householder transformations", SIAM J.
//! Sci. Stat. Comput. 10, 1989. Each reflector's upper part is a single entry because R is already
//! triangular (J. Demmel, L. Grigori, M. Hoemmen & J. Langou, "Communication-optimal parallel and
//! sequential QR and LU factorizations", SIAM J. Sci. Comput. 34, 2012).

use nalgebra::{DMatrix, DMatrixView, DVector};

/// Number of columns in a panel.
const PANEL: usize = 16;
/// Maximum number of rows appended at once: a row block and the panel fit in a processor's
/// second-level cache.
const ROWS: usize = 256;

/// `R` of `A = Q R` for the appended rows of `A`: square and upper triangular, with arbitrary row
/// signs.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct TriangularFactor(DMatrix<f64>);

impl TriangularFactor {
    /// Creates the factor of a matrix with no rows yet.
    pub(crate) fn empty(columns: usize) -> Self {
        Self(DMatrix::zeros(columns, columns))
    }

    /// Returns the upper triangular matrix.
    pub(crate) fn matrix(&self) -> &DMatrix<f64> {
        &self.0
    }

    /// Appends rows to `A`, in blocks of [`ROWS`].
    pub(crate) fn append(&mut self, rows: &DMatrix<f64>) {
        for first in (0..rows.nrows()).step_by(ROWS) {
            let count = ROWS.min(rows.nrows() - first);
            self.append_block(rows.rows(first, count).into_owned());
        }
    }

    /// Appends at most [`ROWS`] rows, panel by panel (steps 1 to 3).
    fn append_block(&mut self, mut rows: DMatrix<f64>) {
        let columns = self.0.ncols();
        for first in (0..columns).step_by(PANEL) {
            let width = PANEL.min(columns - first);
            let t = self.reflect_panel(&mut rows, first, width);
            // Step 3.
            let rest = columns - first - width;
            if rest == 0 {
                return;
            }
            let (panel, mut right) =
                rows.columns_range_pair_mut(first..first + width, first + width..columns);
            let mut w = self
                .0
                .view((first, first + width), (width, rest))
                .into_owned();
            w.gemm(1.0, &panel.transpose(), &right, 1.0);
            let w = t.transpose() * w;
            let mut upper = self.0.view_mut((first, first + width), (width, rest));
            upper -= &w;
            right.gemm(-1.0, &panel, &w, 1.0);
        }
    }

    /// Reflects a panel's columns (steps 1 and 2). Stores the reflectors' vectors in the columns of
    /// `rows`, and returns `T`.
    fn reflect_panel(
        &mut self,
        rows: &mut DMatrix<f64>,
        first: usize,
        width: usize,
    ) -> DMatrix<f64> {
        let mut t = DMatrix::zeros(width, width);
        for j in 0..width {
            // Step 1.
            let column = first + j;
            let below = rows.column(column).norm();
            if below == 0.0 {
                // Already triangular: tau = 0, no reflection.
                continue;
            }
            let diagonal = self.0[(column, column)];
            let beta = -below.hypot(diagonal).copysign(diagonal);
            rows.column_mut(column).unscale_mut(diagonal - beta);
            let tau = (beta - diagonal) / beta;
            self.0[(column, column)] = beta;
            let (v, mut later) = rows.columns_range_pair_mut(column, column + 1..first + width);
            for (k, mut later_column) in later.column_iter_mut().enumerate() {
                let upper_entry = &mut self.0[(column, column + 1 + k)];
                let w = tau * (*upper_entry + v.dot(&later_column));
                *upper_entry -= w;
                later_column.axpy(-w, &v, 1.0);
            }
            // Step 2.
            let v_products =
                DVector::from_fn(j, |k, _| rows.column(first + k).dot(&rows.column(column)));
            let above = t.view((0, 0), (j, j)) * v_products * -tau;
            t.view_mut((0, j), (j, 1)).copy_from(&above);
            t[(j, j)] = tau;
        }
        t
    }
}

/// Computes `X = argmin |A X - Y|^2 + ridge |N X|^2` from the triangular factor of `[A Y]`.
///
/// `A` has `regressors` columns, and the diagonal `N` holds their lengths: the ridge applies to
/// columns scaled to unit length. Returns `None` if the columns depend on each other.
pub(crate) fn ridge_solution(
    factor: DMatrixView<'_, f64>,
    regressors: usize,
    ridge: f64,
) -> Option<DMatrix<f64>> {
    let lengths: Vec<f64> = factor
        .column_iter()
        .take(regressors)
        .map(|column| column.norm())
        .collect();
    if lengths.contains(&0.0) {
        return None;
    }
    let mut stacked = TriangularFactor(factor.into_owned());
    for (mut column, length) in stacked.0.column_iter_mut().zip(&lengths) {
        column.unscale_mut(*length);
    }
    if ridge > 0.0 {
        let mut rows = DMatrix::zeros(regressors, factor.ncols());
        rows.fill_diagonal(ridge.sqrt());
        stacked.append(&rows);
    }
    let right_sides = factor.ncols() - regressors;
    let mut solution = stacked
        .0
        .view((0, regressors), (regressors, right_sides))
        .into_owned();
    let is_solved = stacked
        .0
        .view((0, 0), (regressors, regressors))
        .solve_upper_triangular_mut(&mut solution);
    if !is_solved {
        return None;
    }
    for (mut row, length) in solution.row_iter_mut().zip(&lengths) {
        row.unscale_mut(*length);
    }
    if solution.iter().all(|entry| entry.is_finite()) {
        Some(solution)
    } else {
        None
    }
}

/// Computes `X = argmin |A X - Y|^2` by a triangular factor with scaled columns; `None` if columns
/// in `A` depend on each other.
pub(crate) fn least_squares(a: &DMatrix<f64>, y: &DMatrix<f64>) -> Option<DMatrix<f64>> {
    let mut both = DMatrix::zeros(a.nrows(), a.ncols() + y.ncols());
    both.columns_mut(0, a.ncols()).copy_from(a);
    both.columns_mut(a.ncols(), y.ncols()).copy_from(y);
    let mut factor = TriangularFactor::empty(both.ncols());
    factor.append(&both);
    ridge_solution(factor.0.as_view(), a.ncols(), 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sample(rows: usize, columns: usize) -> DMatrix<f64> {
        DMatrix::from_fn(rows, columns, |row, column| {
            ((1.0 + 7.3 * row as f64) * (1.0 + 2.9 * column as f64)).sin()
        })
    }

    #[test]
    fn the_factor_is_that_of_all_rows_at_once() {
        let rows = sample(700, 37);
        let mut factor = TriangularFactor::empty(37);
        factor.append(&rows.rows(0, 300).into_owned());
        factor.append(&rows.rows(300, 400).into_owned());
        let at_once = rows.qr().r();
        for (row, expected) in at_once.row_iter().enumerate() {
            let found = factor.matrix().row(row);
            let sign = if found[row] * expected[row] < 0.0 {
                -1.0
            } else {
                1.0
            };
            // Orthogonal transformations: the error is a few rounding errors of the norm of the
            // matrix, which is 100.
            assert!((found * sign - expected).norm() < 1e-11, "row {row}");
        }
    }

    #[test]
    fn a_column_of_zeros_does_no_harm() {
        let mut rows = sample(50, 5);
        rows.column_mut(2).fill(0.0);
        let mut factor = TriangularFactor::empty(5);
        factor.append(&rows);
        assert!(factor.matrix().iter().all(|entry| entry.is_finite()));
        let gram = factor.matrix().transpose() * factor.matrix();
        assert!((gram - rows.transpose() * &rows).norm() < 1e-12 * rows.norm_squared());
    }
}
