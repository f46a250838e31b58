//! Solves normal equations whose matrix is an arrow (M16.2).
//!
//! An `M_ji` has a column only in the equations for input i, a `K_jo` in those for every input. The
//! normal matrix therefore has a block for each input and a border for K, whose part is summed over
//! inputs before anything is substituted:
//!
//! ```text
//! [ A_1            B_1 ]   [ M_1 ]   [ b_1 ]        1  A_i = L_i L_i^T,  W_i = L_i^-1 B_i,  y_i = L_i^-1 b_i  for every input i
//! [      ...       ... ] . [ ... ] = [ ... ]        2  (C - sum W_i^T W_i) K = b_K - sum W_i^T y_i,  by Cholesky's factors
//! [            A_m B_m ]   [ M_m ]   [ b_m ]        3  M_i = L_i^-T (y_i - W_i K)
//! [ B_1^T ... B_m^T C  ]   [ K   ]   [ b_K ]
//! ```
//!
//! Block Cholesky factorisation: Golub & Van Loan, "Matrix Computations", 4th ed. 2013, 4.2.9.

use nalgebra::{Cholesky, DMatrix, DVector, Dyn};

/// The normal equations as an arrow.
pub(super) struct ArrowSystem {
    /// Equations by input column.
    pub(super) columns: Vec<ArrowColumn>,
    /// `C`.
    pub(super) corner: DMatrix<f64>,
    /// `b_K`.
    pub(super) right: DVector<f64>,
}

/// The rows for the unknowns in M in an input column.
pub(super) struct ArrowColumn {
    /// `A_i`.
    pub(super) block: DMatrix<f64>,
    /// `B_i`.
    pub(super) border: DMatrix<f64>,
    /// `b_i`.
    pub(super) right: DVector<f64>,
}

/// The unknowns.
pub(super) struct ArrowSolution {
    /// The unknowns in M by input column.
    pub(super) mixing: Vec<DVector<f64>>,
    /// The unknowns in K.
    pub(super) feedback: DVector<f64>,
}

/// An input column eliminated from the equations for K (step 1).
struct EliminatedColumn {
    /// `L_i`.
    factors: Cholesky<f64, Dyn>,
    /// `W_i`.
    border: DMatrix<f64>,
    /// `y_i`.
    right: DVector<f64>,
}

impl ArrowSystem {
    /// Solves the equations (steps 1 to 3); `None` without Cholesky factors.
    pub(super) fn solve(&self) -> Option<ArrowSolution> {
        let mut corner = self.corner.clone();
        let mut right = self.right.clone();
        let mut eliminated = Vec::with_capacity(self.columns.len());
        for column in &self.columns {
            let column = EliminatedColumn::new(column)?;
            if !corner.is_empty() {
                corner.gemm(-1.0, &column.border.transpose(), &column.border, 1.0);
                right.gemv_tr(-1.0, &column.border, &column.right, 1.0);
            }
            eliminated.push(column);
        }
        let feedback = if corner.is_empty() {
            right
        } else {
            corner.cholesky()?.solve(&right)
        };
        let mut mixing = Vec::with_capacity(eliminated.len());
        for column in &eliminated {
            mixing.push(column.substitute(&feedback)?);
        }
        Some(ArrowSolution { mixing, feedback })
    }

    /// Returns the maximum residual relative to the maximum right side.
    pub(super) fn residual(&self, solution: &ArrowSolution) -> f64 {
        let mut largest_residual = 0.0_f64;
        let mut largest_right = self.right.amax();
        let mut feedback_residual = &self.corner * &solution.feedback - &self.right;
        for (column, mixing) in self.columns.iter().zip(&solution.mixing) {
            let residual =
                &column.block * mixing + &column.border * &solution.feedback - &column.right;
            feedback_residual += column.border.tr_mul(mixing);
            largest_residual = largest_residual.max(residual.amax());
            largest_right = largest_right.max(column.right.amax());
        }
        largest_residual.max(feedback_residual.amax()) / largest_right
    }
}

impl EliminatedColumn {
    fn new(column: &ArrowColumn) -> Option<Self> {
        let factors = column.block.clone().cholesky()?;
        let lower = factors.l_dirty();
        let border = lower.solve_lower_triangular(&column.border)?;
        let right = lower.solve_lower_triangular(&column.right)?;
        Some(Self {
            factors,
            border,
            right,
        })
    }

    /// Solves for the unknowns in M, given those in K (step 3).
    fn substitute(&self, feedback: &DVector<f64>) -> Option<DVector<f64>> {
        let right = &self.right - &self.border * feedback;
        self.factors.l_dirty().tr_solve_lower_triangular(&right)
    }
}
