//! Normal equations for a pass: sum over the conditions, scaling, regularisation (M16.2).
//!
//! A *pass* is one of the successive least-squares problems in the fit. `G theta = b` are its
//! equations for the entries `theta` in the mixing M (m x m) and the feedback K. The unknowns in
//! column i of M occur only in the equations for input i, those in K in the equations for every
//! input, so that G is an arrow:
//!
//! ```text
//! [ A_1            B_1 ]   [ M_1 ]   [ b_1 ]        M_i: unknowns in column i of M
//! [      ...       ... ] . [ ... ] = [ ... ]
//! [            A_m B_m ]   [ M_m ]   [ b_m ]
//! [ B_1^T ... B_m^T C  ]   [ K   ]   [ b_K ]
//!
//! 1  G, b <- sum of the conditions' blocks, times v^power for each unknown in M         (add)
//! 2  divide rows and columns by the root of G's diagonal, because the entries of K
//!    differ in unit                                                                 (scaling)
//! 3  solve (G + rho diag G) theta = b + rho diag G theta_0,  theta_0: M = I, K = 0    (solve)
//! ```
//!
//! `v` is the scaled airspeed, on which the diagonal of M may depend as a polynomial; `rho` is the
//! relative regularisation. An unknown with a zero on the diagonal, which no response determines,
//! keeps its value in `theta_0`.

use nalgebra::{DMatrix, DVector};

use super::arrow_system::{ArrowColumn, ArrowSystem};
use super::condition_blocks::{ColumnBlocks, ConditionBlocks};
use super::error::CouplingError;
use super::pair_products::{PairProducts, pair_count, pair_index};
use super::unknown::Unknown;
use super::unknown_layout::{FeedbackUnknown, MixingUnknown, UnknownLayout};

/// The normal equations, `G theta = b`.
pub(super) struct NormalEquations<'a> {
    layout: &'a UnknownLayout,
    /// `A_i`, `B_i` and `b_i` for each input column i.
    columns: Vec<ArrowColumn>,
    /// `C`: an entry for every two unknowns in K.
    corner: PairProducts,
    /// `b_K`: rows by fed-back output, columns by input.
    corner_right: DMatrix<f64>,
}

/// Solution of a pass.
pub(super) struct PassOptimum {
    /// `theta`, by unknown.
    pub(super) coefficients: DVector<f64>,
    /// Largest residual in the scaled normal equations relative to their largest right-hand side.
    pub(super) residual: f64,
    /// Indices of the unknowns that no response determines; they keep their uncoupled values.
    pub(super) undetermined: Vec<usize>,
}

impl<'a> NormalEquations<'a> {
    /// Creates empty equations for `inputs` inputs and `fed_back` outputs with a column in `K`.
    pub(super) fn zeros(layout: &'a UnknownLayout, inputs: usize, fed_back: usize) -> Self {
        let columns = layout
            .mixing
            .iter()
            .map(|mixing| ArrowColumn {
                block: DMatrix::zeros(mixing.len(), mixing.len()),
                border: DMatrix::zeros(mixing.len(), layout.feedback.len()),
                right: DVector::zeros(mixing.len()),
            })
            .collect();
        Self {
            layout,
            columns,
            corner: PairProducts::zeros(pair_count(fed_back), inputs),
            corner_right: DMatrix::zeros(fed_back, inputs),
        }
    }

    /// Adds a condition with scaled airspeed `v` (step 1).
    pub(super) fn add(&mut self, blocks: &ConditionBlocks, v: f64) {
        for ((equations, blocks), mixing) in self
            .columns
            .iter_mut()
            .zip(&blocks.columns)
            .zip(&self.layout.mixing)
        {
            add_column(equations, blocks, mixing, &self.layout.feedback, v);
        }
        self.corner.add(&blocks.feedback);
        self.corner_right += &blocks.right;
    }

    /// Returns the entry in `C` for two unknowns in K.
    fn corner_entry(&self, row: &FeedbackUnknown, column: &FeedbackUnknown) -> f64 {
        // Stored for output pairs in ascending order; G is symmetric.
        let count = self.corner_right.nrows();
        if row.fed_back <= column.fed_back {
            let pair = pair_index(row.fed_back, column.fed_back, count);
            self.corner.entry(pair, row.input, column.input)
        } else {
            let pair = pair_index(column.fed_back, row.fed_back, count);
            self.corner.entry(pair, column.input, row.input)
        }
    }

    /// Returns the solution, regularised towards no couplings by `ridge` (steps 2 and 3).
    ///
    /// # Errors
    /// [`CouplingError::SingularNormalMatrix`] if the normal matrix has no Cholesky factors.
    pub(super) fn solve(
        &self,
        unknowns: &[Unknown],
        ridge: f64,
    ) -> Result<PassOptimum, CouplingError> {
        let singular = CouplingError::SingularNormalMatrix {
            unknowns: unknowns.len(),
        };
        let scaling = self.scaling(unknowns, ridge);
        let scaled = self.scaled_system(&scaling);
        let Some(solution) = scaled.solve() else {
            return Err(singular);
        };
        let residual = scaled.residual(&solution);
        let mut coefficients = DVector::zeros(unknowns.len());
        for (values, mixing) in solution.mixing.iter().zip(&self.layout.mixing) {
            for (value, unknown) in values.iter().zip(mixing) {
                coefficients[unknown.index] = value * scaling.scale[unknown.index];
            }
        }
        for (value, unknown) in solution.feedback.iter().zip(&self.layout.feedback) {
            coefficients[unknown.index] = value * scaling.scale[unknown.index];
        }
        if !residual.is_finite() || coefficients.iter().any(|value| !value.is_finite()) {
            return Err(singular);
        }
        Ok(PassOptimum {
            coefficients,
            residual,
            undetermined: scaling.undetermined(),
        })
    }

    /// Computes the unknowns' scales from the diagonal (step 2).
    fn scaling<'u>(&self, unknowns: &'u [Unknown], ridge: f64) -> Scaling<'u> {
        let mut scaling = Scaling::new(unknowns, ridge);
        for (equations, mixing) in self.columns.iter().zip(&self.layout.mixing) {
            for (row, unknown) in mixing.iter().enumerate() {
                scaling.set(unknown.index, equations.block[(row, row)]);
            }
        }
        for unknown in &self.layout.feedback {
            scaling.set(unknown.index, self.corner_entry(unknown, unknown));
        }
        scaling
    }

    /// Returns the equations scaled to a unit diagonal and regularised towards no couplings; each
    /// solution value is to be multiplied by the unknown's scale.
    fn scaled_system(&self, scaling: &Scaling<'_>) -> ArrowSystem {
        let feedback = &self.layout.feedback;
        let columns = self
            .columns
            .iter()
            .zip(&self.layout.mixing)
            .map(|(equations, mixing)| scaled_column(equations, mixing, feedback, scaling))
            .collect();
        let mut corner = DMatrix::from_fn(feedback.len(), feedback.len(), |row, column| {
            let entry = self.corner_entry(&feedback[row], &feedback[column]);
            scaling.scale[feedback[row].index] * entry * scaling.scale[feedback[column].index]
        });
        for (row, unknown) in feedback.iter().enumerate() {
            corner[(row, row)] += scaling.ridge_term(unknown.index);
        }
        let right = DVector::from_fn(feedback.len(), |row, _| {
            let unknown = &feedback[row];
            let right = self.corner_right[(unknown.fed_back, unknown.input)];
            scaling.scaled_right(unknown.index, right)
        });
        ArrowSystem {
            columns,
            corner,
            right,
        }
    }
}

/// Adds a condition's blocks to the equations for an input column, with `v^power` for the unknowns
/// in M.
fn add_column(
    equations: &mut ArrowColumn,
    blocks: &ColumnBlocks,
    mixing: &[MixingUnknown],
    feedback: &[FeedbackUnknown],
    v: f64,
) {
    for (row, unknown) in mixing.iter().enumerate() {
        let factor = v.powi(unknown.power);
        equations.right[row] += factor * blocks.right[unknown.to];
        for (column, other) in mixing.iter().enumerate() {
            equations.block[(row, column)] +=
                factor * v.powi(other.power) * blocks.mixing_entry(unknown.to, other.to);
        }
        for (column, other) in feedback.iter().enumerate() {
            equations.border[(row, column)] +=
                factor * blocks.mixing_feedback_entry(unknown.to, other.input, other.fed_back);
        }
    }
}

/// Scales and regularises the equations for an input column.
fn scaled_column(
    equations: &ArrowColumn,
    mixing: &[MixingUnknown],
    feedback: &[FeedbackUnknown],
    scaling: &Scaling<'_>,
) -> ArrowColumn {
    let scale: Vec<f64> = mixing
        .iter()
        .map(|unknown| scaling.scale[unknown.index])
        .collect();
    let mut block = DMatrix::from_fn(mixing.len(), mixing.len(), |row, column| {
        scale[row] * equations.block[(row, column)] * scale[column]
    });
    for (row, unknown) in mixing.iter().enumerate() {
        block[(row, row)] += scaling.ridge_term(unknown.index);
    }
    let border = DMatrix::from_fn(mixing.len(), feedback.len(), |row, column| {
        scale[row] * equations.border[(row, column)] * scaling.scale[feedback[column].index]
    });
    let right = DVector::from_fn(mixing.len(), |row, _| {
        scaling.scaled_right(mixing[row].index, equations.right[row])
    });
    ArrowColumn {
        block,
        border,
        right,
    }
}

/// Factors that scale `G` to a unit diagonal, and the regularisation towards no couplings. On a
/// unit diagonal, the term `rho diag G` of step 3 is simply `rho`.
struct Scaling<'a> {
    unknowns: &'a [Unknown],
    /// `rho`.
    ridge: f64,
    /// `1 / sqrt(G_kk)` for each unknown k; 1 for an undetermined unknown.
    scale: Vec<f64>,
    /// For each unknown, whether its diagonal entry is positive.
    is_determined: Vec<bool>,
}

impl<'a> Scaling<'a> {
    fn new(unknowns: &'a [Unknown], ridge: f64) -> Self {
        let count = unknowns.len();
        Self {
            unknowns,
            ridge,
            scale: vec![1.0; count],
            is_determined: vec![false; count],
        }
    }

    /// Sets an unknown's scale from its diagonal entry in `G`.
    fn set(&mut self, index: usize, diagonal: f64) {
        if diagonal > 0.0 {
            self.scale[index] = diagonal.sqrt().recip();
            self.is_determined[index] = true;
        }
    }

    /// Returns the regularisation term that is added to an unknown's scaled diagonal entry; 1 for
    /// an undetermined unknown, whose diagonal entry is zero, so that its equation is `theta =
    /// theta_0`.
    fn ridge_term(&self, index: usize) -> f64 {
        if self.is_determined[index] {
            self.ridge
        } else {
            1.0
        }
    }

    /// Scales and regularises an unknown's entry `right` in `b`.
    fn scaled_right(&self, index: usize, right: f64) -> f64 {
        let scale = self.scale[index];
        scale * right + self.ridge_term(index) * self.unknowns[index].uncoupled() / scale
    }

    /// Returns the indices of the unknowns that no response determines.
    fn undetermined(&self) -> Vec<usize> {
        (0..self.unknowns.len())
            .filter(|&index| !self.is_determined[index])
            .collect()
    }
}
