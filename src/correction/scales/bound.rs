//! Rigorous lower bounds of a convex function over a box.

use super::landscape::Slopes;

/// A lower bound over a box of a function that is convex there, from its tangent plane at `scales` (inside the box), less the
/// rounding of the value and of every slope.
pub(super) fn tangent_bound(scales: &[f64], slopes: &Slopes, (lower, upper): (&[f64], &[f64])) -> f64 {
    let mut bound = slopes.value - slopes.value_error;
    for node in 0..scales.len() {
        let (slope, error) = (slopes.gradient[node], slopes.gradient_error[node]);
        let down = (slope + error).max(0.0) * (scales[node] - lower[node]).max(0.0);
        let up = (error - slope).max(0.0) * (upper[node] - scales[node]).max(0.0);
        bound -= down.max(up);
    }
    // The sum of at most a hundred figures of the bound's size, and the arithmetic above.
    bound - 128.0 * f64::EPSILON * bound.abs()
}

/// The same from the tangent plane and the curvature next to `scales`, where the slopes are next to nothing.
///
/// `reach` is `sqrt(diagonal of H^-1)` for a Hessian `H` that the function's own does not fall below while no scale is further
/// than `within` from `scales`; 0 for a scale that cannot move. With the slopes `g` known to `e`, and
/// `r = sum (|g| + e) reach`, the parabola `g d + d' H d / 2` is nowhere below `-r^2 / 2` and turns before any scale has moved by
/// `r reach`; beyond, a convex function goes on rising. A scale that its slope has `pushed` against its bound can only raise
/// the function.
pub(super) fn curved_bound(slopes: &Slopes, reach: &[f64], within: f64, pushed: impl Fn(usize) -> bool) -> Option<f64> {
    let mut sum = 0.0;
    for (node, reach) in reach.iter().enumerate() {
        let (slope, error) = (slopes.gradient[node], slopes.gradient_error[node]);
        if !pushed(node) {
            sum += (slope.abs() + error) * reach;
        }
    }
    let farthest = sum * reach.iter().fold(0.0_f64, |most, reach| most.max(*reach));
    let bound = slopes.value - slopes.value_error - 0.5 * sum * sum * (1.0 + 1e-6);
    (farthest <= within).then_some(bound - 128.0 * f64::EPSILON * bound.abs())
}
