//! Constraints in a fit, their deviations, and the sums over the deviations. A *constraint* is a
//! row `x_i w = y_i` or a weight `w_k = 0`; its *deviation* is the left-hand side minus the
//! right-hand side. The fit minimises the sum of the rows' absolute deviations.

use nalgebra::{DMatrix, DVector};

/// Deviations and weights below this count as zero; the right-hand sides are scaled to at most 1.
pub(super) const ZERO: f64 = 1e-11;

/// The constraints in a fit: `x_i w = y_i` (the rows), then `w_k = 0` (the weights), counted in
/// this order.
pub(super) struct Fit<'a> {
    /// The rows `x_i`, row-major.
    x: Vec<f64>,
    /// Weight count.
    pub(super) unknowns: usize,
    pub(super) y: &'a [f64],
}

impl<'a> Fit<'a> {
    /// Creates the constraints for fitting `y` by `x`.
    pub(super) fn new(x: &[Vec<f64>], y: &'a [f64]) -> Self {
        Self {
            x: x.concat(),
            unknowns: x.first().map_or(0, Vec::len),
            y,
        }
    }

    /// Returns the constraint count, rows plus weights.
    pub(super) fn count(&self) -> usize {
        self.y.len() + self.unknowns
    }

    fn row(&self, row: usize) -> &[f64] {
        &self.x[row * self.unknowns..(row + 1) * self.unknowns]
    }

    /// Returns a constraint's left-hand side at `w`, or its change along a direction `w`.
    pub(super) fn left_hand_side(&self, constraint: usize, w: &[f64]) -> f64 {
        if self.is_weight(constraint) {
            return w[constraint - self.y.len()];
        }
        self.row(constraint).iter().zip(w).map(|(x, w)| x * w).sum()
    }

    /// Returns a constraint's right-hand side; 0 for a weight.
    pub(super) fn right_hand_side(&self, constraint: usize) -> f64 {
        self.y.get(constraint).copied().unwrap_or(0.0)
    }

    /// Returns a constraint's deviation at `w`.
    pub(super) fn deviation(&self, constraint: usize, w: &[f64]) -> f64 {
        self.left_hand_side(constraint, w) - self.right_hand_side(constraint)
    }

    /// Returns whether a constraint is `w_k = 0`.
    pub(super) fn is_weight(&self, constraint: usize) -> bool {
        constraint >= self.y.len()
    }

    /// Returns these constraints' coefficients, one matrix row each: from `x` for a row, from the
    /// identity for a weight.
    pub(super) fn matrix(&self, constraints: &[usize]) -> DMatrix<f64> {
        DMatrix::from_fn(
            constraints.len(),
            self.unknowns,
            |row, column| match constraints[row].checked_sub(self.y.len()) {
                None => self.row(constraints[row])[column],
                Some(weight) => f64::from(weight == column),
            },
        )
    }

    /// Computes `sum_i |x_i w - y_i|`.
    pub(super) fn sum_of_deviations(&self, w: &[f64]) -> f64 {
        (0..self.y.len())
            .map(|row| self.deviation(row, w).abs())
            .sum()
    }

    /// Returns the least-squares weights with negative values set to zero, from which the search
    /// starts because they are close to the optimal vertex; zero weights where the normal equations
    /// are singular.
    pub(super) fn least_squares(&self) -> Vec<f64> {
        let x = DMatrix::from_row_slice(self.y.len(), self.unknowns, &self.x);
        let Some(normal) = x.tr_mul(&x).cholesky() else {
            return vec![0.0; self.unknowns];
        };
        let weights = normal.solve(&x.tr_mul(&DVector::from_column_slice(self.y)));
        weights.iter().map(|weight| weight.max(0.0)).collect()
    }

    /// Computes `sum_i (sqrt(x_i w) - sqrt(y_i))^2`.
    pub(super) fn sum_of_squared_root_deviations(&self, w: &[f64]) -> f64 {
        (0..self.y.len())
            .map(|row| (self.left_hand_side(row, w).max(0.0).sqrt() - self.y[row].sqrt()).powi(2))
            .sum()
    }
}
