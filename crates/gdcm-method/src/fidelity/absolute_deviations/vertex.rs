//! Vertices in a fit `min sum_i |x_i w - y_i|` over `w >= 0`: points in which as many independent
//! constraints, rows `x_i w = y_i` or weights `w_k = 0`, meet as there are unknowns.

use nalgebra::DVector;

use super::fit_constraints::{Fit, ZERO};

/// Singular value above which constraints count as independent; their coefficients are around 1.
const INDEPENDENT: f64 = 1e-6;

/// A vertex: its weights, and the constraints that define it.
#[derive(Clone, Debug)]
pub(super) struct Vertex {
    /// The weights, non-negative up to rounding.
    pub(super) weights: Vec<f64>,
    /// Constraint indices: rows first, then weights.
    pub(super) basis: Vec<usize>,
}

impl Vertex {
    /// Returns the vertex defined by the constraints that `weights` satisfies best; `None` if these
    /// constraints define no vertex, or a vertex with a negative weight.
    pub(super) fn nearest(fit: &Fit<'_>, weights: &[f64]) -> Option<Self> {
        let deviations: Vec<f64> = (0..fit.count())
            .map(|constraint| fit.deviation(constraint, weights).abs())
            .collect();
        let mut order: Vec<usize> = (0..fit.count()).collect();
        order.sort_unstable_by(|&a, &b| deviations[a].total_cmp(&deviations[b]).then(a.cmp(&b)));
        let mut basis = Vec::new();
        for constraint in order {
            basis.push(constraint);
            if fit.matrix(&basis).rank(INDEPENDENT) < basis.len() {
                basis.pop();
            }
            if basis.len() == fit.unknowns {
                break;
            }
        }
        Self::from_basis(fit, basis)
    }

    /// Returns the vertex with all weights zero.
    pub(super) fn origin(fit: &Fit<'_>) -> Self {
        let basis = (fit.y.len()..fit.count()).collect();
        Self {
            weights: vec![0.0; fit.unknowns],
            basis,
        }
    }

    /// Returns the point in which the constraints in a basis intersect; `None` if there is no such
    /// point, or if a weight is negative there.
    pub(super) fn from_basis(fit: &Fit<'_>, basis: Vec<usize>) -> Option<Self> {
        let matrix = fit.matrix(&basis);
        if !matrix.is_square() {
            return None;
        }
        let right = DVector::from_iterator(
            basis.len(),
            basis
                .iter()
                .map(|&constraint| fit.right_hand_side(constraint)),
        );
        let weights: Vec<f64> = matrix.lu().solve(&right)?.iter().copied().collect();
        if weights.iter().all(|&weight| weight > -ZERO) {
            Some(Self { weights, basis })
        } else {
            None
        }
    }

    /// Returns whether two vertices coincide, up to rounding.
    pub(super) fn coincides_with(&self, other: &Self) -> bool {
        self.weights
            .iter()
            .zip(&other.weights)
            .all(|(a, b)| (a - b).abs() <= ZERO)
    }

    /// Returns whether more constraints meet in this vertex than it needs; its edges may then miss
    /// a descent direction.
    pub(super) fn is_degenerate(&self, fit: &Fit<'_>) -> bool {
        let meeting = (0..fit.count())
            .filter(|&constraint| fit.deviation(constraint, &self.weights).abs() <= ZERO)
            .count();
        meeting > fit.unknowns
    }
}
