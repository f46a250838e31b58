//! Solves normal equations with an arrow matrix (M16.2).
//!
//! The unknowns are the entries `M_ji` of the input mixing and `K_jo` of the output feedback. An
//! `M_ji` appears only in the equations for input i, a `K_jo` in the equations for every input. The
//! normal matrix therefore has a block row for each input, that is, for each column of M, and a
//! border for K:
//!
//! ```text
//! [ A_1            B_1 ]   [ M_1 ]   [ b_1 ]
//! [      ...       ... ] . [ ... ] = [ ... ]      M_i: unknowns in column i of M
//! [            A_m B_m ]   [ M_m ]   [ b_m ]      K:   unknowns in K
//! [ B_1^T ... B_m^T C  ]   [ K   ]   [ b_K ]
//!
//! 1  for every input i: A_i = L_i L_i^T (Cholesky),  W_i = L_i^-1 B_i,  y_i = L_i^-1 b_i
//! 2  (C - sum W_i^T W_i) K = b_K - sum W_i^T y_i, by Cholesky factors
//! 3  for every input i: M_i = L_i^-T (y_i - W_i K)
//! ```
//!
//! Block Cholesky factorisation: Golub & Van Loan, "Matrix Computations", 4th ed. 2013, 4.2.9.

use nalgebra::{Cholesky, DMatrix, DVector, Dyn};

/// Normal equations with an arrow matrix.
pub(super) struct ArrowSystem {
    /// A block row for each column of M.
    pub(super) columns: Vec<ArrowColumn>,
    /// Corner block `C`.
    pub(super) corner: DMatrix<f64>,
    /// Right-hand side `b_K`.
    pub(super) right: DVector<f64>,
}

/// Block row for the unknowns in one column of M.
pub(super) struct ArrowColumn {
    /// Diagonal block `A_i`.
    pub(super) block: DMatrix<f64>,
    /// Border block `B_i`.
    pub(super) border: DMatrix<f64>,
    /// Right-hand side `b_i`.
    pub(super) right: DVector<f64>,
}

/// The values that solve the normal equations.
pub(super) struct ArrowSolution {
    /// Unknowns in each column of M.
    pub(super) mixing: Vec<DVector<f64>>,
    /// Unknowns in K.
    pub(super) feedback: DVector<f64>,
}

/// A column of M after its elimination from the equations for K (step 1).
struct EliminatedColumn {
    /// Cholesky factor `L_i`.
    factors: Cholesky<f64, Dyn>,
    /// `W_i = L_i^-1 B_i`.
    border: DMatrix<f64>,
    /// `y_i = L_i^-1 b_i`.
    right: DVector<f64>,
}

impl ArrowSystem {
    /// Solves the equations (steps 1 to 3); `None` if a Cholesky factorisation fails.
    pub(super) fn solve(&self) -> Option<ArrowSolution> {
        let mut corner = self.corner.clone();
        let mut right = self.right.clone();
        let mut eliminated = Vec::with_capacity(self.columns.len());
        // Step 1, and the sums of step 2
        for column in &self.columns {
            let column = EliminatedColumn::new(column)?;
            if !corner.is_empty() {
                corner.gemm(-1.0, &column.border.transpose(), &column.border, 1.0);
                right.gemv_tr(-1.0, &column.border, &column.right, 1.0);
            }
            eliminated.push(column);
        }
        // Step 2
        let feedback = if corner.is_empty() {
            right
        } else {
            corner.cholesky()?.solve(&right)
        };
        // Step 3
        let mut mixing = Vec::with_capacity(eliminated.len());
        for column in &eliminated {
            mixing.push(column.substitute(&feedback)?);
        }
        Some(ArrowSolution { mixing, feedback })
    }

    /// Returns the maximum residual divided by the right-hand side's maximum entry.
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

    /// Solves for the unknowns in this column of M, given those in K (step 3).
    fn substitute(&self, feedback: &DVector<f64>) -> Option<DVector<f64>> {
        let right = &self.right - &self.border * feedback;
        self.factors.l_dirty().tr_solve_lower_triangular(&right)
    }
}
