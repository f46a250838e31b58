//! Normal equations for a pass: sum over the conditions, scaling, regularisation (M16.2).
//!
//! ```text
//! 1  G, b <- the conditions' blocks summed, with powers of the scaled airspeed v for the unknowns M_ji
//! 2  divide rows and columns by the root of the diagonal, because the entries of K differ in unit
//! 3  (G + rho diag G) theta = b + rho diag G theta_0,   theta_0: M = I, K = 0;  solved as an arrow
//!    an unknown with a zero on the diagonal, which no response determines, keeps its value in theta_0
//! ```
//!
//! A *pass* is one of the successive least-squares problems in the fit. `G theta = b` are the
//! equations for the entries `theta` in the mixing M and the feedback K (`condition_blocks`), `rho`
//! is the relative regularisation. `arrow_system` defines how G's blocks are arranged,
//! `unknown_layout` how the unknowns are ordered.

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
    /// Equations for the unknowns in M, for each input column.
    columns: Vec<ArrowColumn>,
    /// Normal matrix entries for two unknowns in K.
    feedback: PairProducts,
    /// Right-hand side for the unknowns in K: rows by fed-back output, columns by input.
    right: DMatrix<f64>,
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
            feedback: PairProducts::zeros(pair_count(fed_back), inputs),
            right: DMatrix::zeros(fed_back, inputs),
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
        self.feedback.add(&blocks.feedback);
        self.right += &blocks.right;
    }

    /// Returns the normal matrix entry for two unknowns in K.
    fn feedback_entry(&self, row: &FeedbackUnknown, column: &FeedbackUnknown) -> f64 {
        // Stored for output pairs in ascending order; G is symmetric.
        let count = self.right.nrows();
        if row.fed_back <= column.fed_back {
            let pair = pair_index(row.fed_back, column.fed_back, count);
            self.feedback.entry(pair, row.input, column.input)
        } else {
            let pair = pair_index(column.fed_back, row.fed_back, count);
            self.feedback.entry(pair, column.input, row.input)
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
        let scaled = self.scaled(&scaling);
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
            scaling.set(unknown.index, self.feedback_entry(unknown, unknown));
        }
        scaling
    }

    /// Returns the equations scaled to a unit diagonal and regularised towards no couplings.
    fn scaled(&self, scaling: &Scaling<'_>) -> ArrowSystem {
        let feedback = &self.layout.feedback;
        let columns = self
            .columns
            .iter()
            .zip(&self.layout.mixing)
            .map(|(equations, mixing)| scaled_column(equations, mixing, feedback, scaling))
            .collect();
        let mut corner = DMatrix::from_fn(feedback.len(), feedback.len(), |row, column| {
            let entry = self.feedback_entry(&feedback[row], &feedback[column]);
            scaling.scale[feedback[row].index] * entry * scaling.scale[feedback[column].index]
        });
        for (row, unknown) in feedback.iter().enumerate() {
            corner[(row, row)] += scaling.regularisation(unknown.index);
        }
        let right = DVector::from_fn(feedback.len(), |row, _| {
            let unknown = &feedback[row];
            scaling.right(unknown.index, self.right[(unknown.fed_back, unknown.input)])
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
        block[(row, row)] += scaling.regularisation(unknown.index);
    }
    let border = DMatrix::from_fn(mixing.len(), feedback.len(), |row, column| {
        scale[row] * equations.border[(row, column)] * scaling.scale[feedback[column].index]
    });
    let right = DVector::from_fn(mixing.len(), |row, _| {
        scaling.right(mixing[row].index, equations.right[row])
    });
    ArrowColumn {
        block,
        border,
        right,
    }
}

/// Factors that scale the normal matrix to a unit diagonal, and the regularisation towards no
/// couplings.
struct Scaling<'a> {
    unknowns: &'a [Unknown],
    ridge: f64,
    /// Scale for each unknown; 1 for an undetermined unknown.
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

    /// Returns the regularisation term on the diagonal; 1 for an undetermined unknown, whose
    /// diagonal is zero.
    fn regularisation(&self, index: usize) -> f64 {
        if self.is_determined[index] {
            self.ridge
        } else {
            1.0
        }
    }

    /// Scales and regularises an entry in the right-hand side `b`.
    fn right(&self, index: usize, right: f64) -> f64 {
        let scale = self.scale[index];
        scale * right + self.regularisation(index) * self.unknowns[index].uncoupled() / scale
    }

    /// Returns the indices of the unknowns that no response determines.
    fn undetermined(&self) -> Vec<usize> {
        (0..self.unknowns.len())
            .filter(|&index| !self.is_determined[index])
            .collect()
    }
}
