//! Lower bounds on a convex function of the scales, from its expansion at a single point.
//!
//! ```text
//! tangent bound    the tangent plane at the point, minimised over a box
//! quadratic bound  the tangent plane and a Hessian, minimised over all distances from a point near the minimum
//! ```

use super::expansion::{Expansion, ScaleBox};

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
/// tangent plane and Hessian. `None` if the slopes are too large.
///
/// Let `F` be the function, `s` the point, `H` a matrix that the Hessian exceeds by a positive
/// semidefinite matrix while no scale is further than `within` from `s`, and `reach` the square
/// roots of the diagonal of `H^-1` (0 for a fixed scale). For a displacement `d` and `t = sqrt(d' H
/// d)`, each scale moves by `|d_i| <= reach_i t`. With the gradient `g` and its error `e`,
/// therefore
///
/// ```text
/// F(s + d) - F(s)  >=  g' d + d' H d / 2  >=  t^2 / 2 - r t  >=  -r^2 / 2,      r = sum (|g_i| + e_i) reach_i
/// ```
///
/// At `t = r`, where no scale has moved by more than `r reach_i`, `F` no longer falls along `d`; a
/// convex function does not fall further out either, so that the bound holds everywhere if `r
/// reach_i <= within`. A scale that its slope has `pressed` against its bound can only raise `F`,
/// and does not count in `r`.
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
        // `1.0 + 1e-6`: margin for rounding in the sum and in the inverse.
        let bound = at.value.value - at.value.error - 0.5 * r * r * (1.0 + 1e-6);
        Some(bound - 4.0 * f64::EPSILON * bound.abs())
    } else {
        None
    }
}
