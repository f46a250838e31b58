//! Lower bound on the objective over a region that contains a minimum or lies beside it, from the
//! gradient and the Hessian at the minimum (line 8 in [`super`]'s algorithm).
//!
//! The objective is a sum of *terms*, each a function of the difference between two *scales*, the
//! unknowns. The last scale, the *ground*, is always 0. A *floating piece* is a group of scales
//! that no term connects with the ground. Shifting it as a whole changes nothing, so that its
//! Hessian is singular: displacements in the piece are measured from one of its scales, the
//! *anchor*. A bound is *active* if the minimum lies on it; the slope that presses a scale against
//! its active bound is the scale's *pressure*: a displacement off the bound raises the objective.

use super::convex_bound::quadratic_bound;
use super::expansion::Expansion;
use super::node_exclusion::NodeExclusion;
use crate::correction::interval::Interval;

/// Largest displacement of a scale from the minimum for which the curvature is bounded: much larger
/// than the error in the scales, much smaller than a distance over which the curvature changes.
const WITHIN: f64 = 0.01;

impl NodeExclusion<'_> {
    /// Bounds the objective from below over a region on which it is convex, from its gradient and
    /// Hessian at `minimum`, a point of that region.
    ///
    /// ```text
    /// 1  least Hessian: each term's minimum curvature within 0.01 of the minimum
    /// 2  pressure of each scale against its active bound
    /// 3  an anchor for each floating piece; no bound if its pressure is too small
    /// 4  reach of each scale that can move and is no anchor: square root of its diagonal entry in
    ///    the least Hessian's inverse; no bound if the least Hessian is not positive definite
    /// 5  quadratic bound from gradient and reaches (`convex_bound`); no bound if the gradient is
    ///    too large
    /// ```
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
        // Step 4
        let free: Vec<usize> = (0..self.objective.ground())
            .filter(|&scale| !self.is_fixed(scale) && !anchors.contains(&scale))
            .collect();
        let inverse = least.reduced(&free).cholesky()?.inverse();
        let mut reach = vec![0.0; minimum.len()];
        for (position, &scale) in free.iter().enumerate() {
            reach[scale] = inverse[(position, position)].sqrt();
        }
        // Step 5
        quadratic_bound(at, &reach, WITHIN, |scale| pressures[scale] > 0.0)
    }

    /// Returns whether both bounds on a scale are the same value.
    fn is_fixed(&self, scale: usize) -> bool {
        self.objective.lower[scale] >= self.objective.upper[scale]
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
    /// largest pressure (any scale if none has pressure).
    ///
    /// The anchor itself may move off its bound, and the scales without pressure with it. The
    /// anchor's pressure then raises the objective, whereas their slopes may lower it: returns
    /// `None` if the pressure is smaller than these slopes together. Without any pressure, a shift
    /// of the whole piece changes nothing.
    fn anchors(&self, at: &Expansion, pressures: &[f64]) -> Option<Vec<usize>> {
        let mut anchors = Vec::new();
        for piece in &self.floating {
            if let Some(&fixed) = piece.iter().find(|&&scale| self.is_fixed(scale)) {
                anchors.push(fixed);
                continue;
            }
            let anchor = piece
                .iter()
                .copied()
                .max_by(|a, b| pressures[*a].total_cmp(&pressures[*b]))?;
            let unpressed_slopes: f64 = piece
                .iter()
                .filter(|&&scale| pressures[scale] == 0.0)
                .map(|&scale| at.gradient[scale].abs() + at.gradient_error[scale])
                .sum();
            if pressures[anchor] > 0.0 && pressures[anchor] < unpressed_slopes {
                return None;
            }
            anchors.push(anchor);
        }
        Some(anchors)
    }
}
