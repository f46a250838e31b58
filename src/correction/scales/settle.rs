//! The scales that the objective leaves undetermined.

use super::landscape::Landscape;

/// Moves each piece of `scales` that is not tied to the ground by one common amount, as far as the box allows.
///
/// `wanted(nodes)` is the amount that the piece would take without the box. This is the limit `alpha -> 0+`: the fit does not
/// depend on the amount, so the departure of the outputs' gains or delays decides (M8, M9).
pub(crate) fn settle(landscape: &Landscape, scales: &mut [f64], mut wanted: impl FnMut(&[usize], &[f64]) -> f64) {
    for (nodes, grounded) in landscape.pieces() {
        if grounded {
            continue;
        }
        let least = nodes.iter().map(|&node| landscape.lower[node] - scales[node]).fold(f64::NEG_INFINITY, f64::max);
        let most = nodes.iter().map(|&node| landscape.upper[node] - scales[node]).fold(f64::INFINITY, f64::min);
        let shift = wanted(&nodes, scales).min(most).max(least);
        for &node in &nodes {
            scales[node] = (scales[node] + shift).clamp(landscape.lower[node], landscape.upper[node]);
        }
    }
}
