//! Lower bounds on a convex function of the scales, from its expansion at a single point.
//!
//! ```text
//! tangent bound    the tangent plane at the point, minimised over a box
//! quadratic bound  the tangent plane and a Hessian, minimised over all displacements from a point
//!                  near the minimum
//! ```

use super::expansion::{Expansion, ScaleBox};

/// Margin, relative to `r^2`, for the rounding in the sum `r` and in the inverse of the Hessian.
const ROUNDING_MARGIN: f64 = 1e-6;

/// Bounds a convex function over a box from below, by its tangent plane at `scales` (inside the
/// box), less the rounding errors in the value, in every slope and in their sum.
pub(super) fn tangent_bound(scales: &[f64], at: &Expansion, bounds: ScaleBox<'_>) -> f64 {
    let mut bound = at.value.value - at.value.error;
    for (index, scale) in scales.iter().enumerate() {
        let slope = at.gradient[index];
        let error = at.gradient_error[index];
        let down = (slope + error).max(0.0) * (scale - bounds.lower[index]).max(0.0);
        let up = (error - slope).max(0.0) * (bounds.upper[index] - scale).max(0.0);
        bound -= down.max(up);
    }
    // Each of the n + 1 subtractions rounds a value between the function value and the bound; each
    // product rounds four times, relative to the products' sum.
    bound - (scales.len() as f64 + 5.0) * f64::EPSILON * at.value.value.abs().max(bound.abs())
}

/// Bounds a convex function from below near a point at which its slopes are almost zero, by its
/// tangent plane and a Hessian.
///
/// ```text
/// F, s     the function and the point, where `at` is the expansion
/// g, e     gradient at s, and the bound on its rounding error
/// within   distance from s, in each scale, up to which the Hessian of F is at least H (their
///          difference is positive semidefinite)
/// reach    square roots of the diagonal of H^-1; 0 for a fixed scale
/// pressed  whether a scale's slope presses it against its bound
/// d, t     a displacement, and its length t = sqrt(d' H d); hence |d_i| <= reach_i t
///
/// F(s + d) - F(s)  >=  g' d + d' H d / 2  >=  t^2 / 2 - r t  >=  -r^2 / 2
/// r = sum of (|g_i| + e_i) reach_i over the scales that are not pressed: pressed ones only raise F
/// ```
///
/// At `t = r`, the slope of `F` along `d` is at least `t - r = 0`, and a convex function that no
/// longer falls does not fall further out either. The bound thus holds for every `d` if no scale
/// has moved by more than `within` at `t = r`, that is, `r reach_i <= within`; otherwise returns
/// `None`.
pub(super) fn quadratic_bound(
    at: &Expansion,
    reach: &[f64],
    within: f64,
    pressed: impl Fn(usize) -> bool,
) -> Option<f64> {
    let mut r = 0.0;
    for (scale, reach) in reach.iter().enumerate() {
        if !pressed(scale) {
            r += (at.gradient[scale].abs() + at.gradient_error[scale]) * reach;
        }
    }
    let farthest = r * reach.iter().fold(0.0_f64, |most, reach| most.max(*reach));
    if farthest <= within {
        let bound = at.value.value - at.value.error - 0.5 * r * r * (1.0 + ROUNDING_MARGIN);
        Some(bound - 4.0 * f64::EPSILON * bound.abs())
    } else {
        None
    }
}
