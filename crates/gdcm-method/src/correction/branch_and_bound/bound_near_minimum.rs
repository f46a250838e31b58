//! Lower bound on the objective over a region that contains a minimum or lies beside it, from the
//! gradient and the Hessian at the minimum (line 8 in [`super`]'s algorithm).
//!
//! The objective is a sum of *terms*, each a function of the difference between two *scales*, the
//! unknowns. The last scale, the *ground*, is always 0. A *floating piece* is a group of scales
//! that no term connects with the ground: shifting it as a whole changes nothing, so that its
//! Hessian is singular unless one scale is fixed. A bound is *active* if the minimum lies on it.

use super::convex_bound::quadratic_bound;
use super::expansion::Expansion;
use super::node_exclusion::NodeExclusion;
use crate::correction::interval::Interval;

/// Distance from the minimum in each scale: much larger than the error in the scales, much smaller
/// than a distance over which the curvature changes.
const WITHIN: f64 = 0.01;

impl NodeExclusion<'_> {
    /// Bounds the objective from below over a region on which it is convex, from its gradient and
    /// Hessian at `minimum`, a point of that region.
    ///
    /// ```text
    /// 1  least Hessian: each term's minimum curvature within 0.01 of the minimum
    /// 2  pressure of each scale against its active bound
    /// 3  anchors: in each floating piece, a scale that does not move
    /// 4  reach of each free scale: root of the diagonal of the least Hessian's inverse
    /// 5  quadratic bound (`convex_bound`)
    /// ```
    ///
    /// `None` if a piece has pressure, but less than its slopes without pressure add up to (3), the
    /// least Hessian is not positive definite (4), or the gradient is too large (5).
    pub(super) fn bound_at(&self, minimum: &[f64], at: &Expansion) -> Option<f64> {
        // Step 1: the difference between two scales changes by up to twice the distance.
        let least = self.least_hessian(|term| {
            let u = term.difference(minimum);
            Interval {
                low: u - 2.0 * WITHIN,
                high: u + 2.0 * WITHIN,
            }
        });
        // Step 2
        let pressures: Vec<f64> = (0..minimum.len())
            .map(|scale| self.pressure(minimum, at, scale))
            .collect();
        // Step 3
        let anchors = self.anchors(at, &pressures)?;
        let lower = &self.objective.lower;
        let upper = &self.objective.upper;
        // Step 4
        let free: Vec<usize> = (0..self.objective.ground())
            .filter(|scale| lower[*scale] < upper[*scale] && !anchors.contains(scale))
            .collect();
        let inverse = least.reduced(&free).cholesky()?.inverse();
        let mut reach = vec![0.0; minimum.len()];
        for (position, &scale) in free.iter().enumerate() {
            reach[scale] = inverse[(position, position)].sqrt();
        }
        // Step 5
        quadratic_bound(at, &reach, WITHIN, |scale| pressures[scale] > 0.0)
    }

    /// Returns the magnitude of the slope that presses the scale against its active bound, less its
    /// rounding error; 0 without an active bound, or if the slope's sign is uncertain.
    fn pressure(&self, minimum: &[f64], at: &Expansion, scale: usize) -> f64 {
        let slope = at.gradient[scale];
        let is_stopped = if slope > 0.0 {
            minimum[scale] <= self.objective.lower[scale]
        } else {
            minimum[scale] >= self.objective.upper[scale]
        };
        if is_stopped {
            (slope.abs() - at.gradient_error[scale]).max(0.0)
        } else {
            0.0
        }
    }

    /// Chooses an anchor for each floating piece: a fixed scale, otherwise the scale with the
    /// largest pressure (any scale if none has pressure). Returns `None` if this pressure is
    /// positive, but less than the summed slope magnitudes of the piece's scales without pressure.
    fn anchors(&self, at: &Expansion, pressures: &[f64]) -> Option<Vec<usize>> {
        let mut anchors = Vec::new();
        for piece in &self.floating {
            let fixed = piece
                .iter()
                .find(|&&scale| self.objective.lower[scale] >= self.objective.upper[scale]);
            if let Some(&fixed) = fixed {
                anchors.push(fixed);
                continue;
            }
            let hardest = piece
                .iter()
                .copied()
                .max_by(|a, b| pressures[*a].total_cmp(&pressures[*b]))?;
            let free_slopes: f64 = piece
                .iter()
                .filter(|&&scale| pressures[scale] == 0.0)
                .map(|&scale| at.gradient[scale].abs() + at.gradient_error[scale])
                .sum();
            if pressures[hardest] > 0.0 && pressures[hardest] < free_slopes {
                return None;
            }
            anchors.push(hardest);
        }
        Some(anchors)
    }
}
