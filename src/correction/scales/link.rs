//! What the objective makes of the difference of two scales.

use super::well::{Jet, Well};

/// The part of the objective that depends on `u = s_to - s_from` only.
#[derive(Clone, Debug)]
pub(crate) struct Link {
    /// Node whose scale is subtracted.
    pub(crate) from: usize,
    /// Node whose scale is added.
    pub(crate) to: usize,
    /// The function of `u`.
    pub(crate) shape: Shape,
}

/// A function of one difference of scales.
#[derive(Clone, Debug)]
pub(crate) enum Shape {
    /// `weight (u - centre)^2`: gains compared in dB, and delays. `size` is that of the figures whose difference `centre` is.
    Parabola { weight: f64, centre: f64, size: f64 },
    /// `forward` in `u` plus `backward` in `-u`: gains compared as ratios.
    Wells { forward: Well, backward: Well, concave: Option<(f64, f64)> },
}

impl Shape {
    /// The two wells, with the interval of `u` on which their sum is concave.
    pub(crate) fn wells(forward: Well, backward: Well) -> Self {
        Shape::Wells { forward, backward, concave: concave_interval(&forward, &backward) }
    }

    /// Value, slope and curvature at `u`.
    pub(crate) fn at(&self, u: f64) -> Jet {
        match self {
            Shape::Parabola { weight, centre, size } => {
                let away = u - centre;
                let value = weight * away * away;
                let reach = weight * (u.abs() + size);
                let rounding = 8.0 * f64::EPSILON;
                Jet {
                    value,
                    slope: 2.0 * weight * away,
                    curvature: 2.0 * weight,
                    value_error: rounding * (2.0 * away.abs() * reach + value),
                    slope_error: rounding * 2.0 * reach,
                }
            }
            Shape::Wells { forward, backward, .. } => {
                let z = u.exp();
                let ahead = forward.at(z);
                if backward.is_flat() {
                    return ahead;
                }
                let behind = backward.at(1.0 / z);
                Jet {
                    value: ahead.value + behind.value,
                    slope: ahead.slope - behind.slope,
                    curvature: ahead.curvature + behind.curvature,
                    value_error: ahead.value_error + behind.value_error,
                    slope_error: ahead.slope_error + behind.slope_error,
                }
            }
        }
    }

    /// Whether the function is convex over `[low, high]`.
    pub(crate) fn is_convex_over(&self, low: f64, high: f64) -> bool {
        match self {
            Shape::Parabola { .. } => true,
            Shape::Wells { concave, .. } => concave.is_none_or(|(from, to)| high <= from || low >= to),
        }
    }

    /// The end of the concave interval that parts `u` from it, if `u` is outside and the end is inside `(low, high)`.
    pub(crate) fn concave_edge(&self, u: f64, low: f64, high: f64) -> Option<f64> {
        let Shape::Wells { concave: Some((from, to)), .. } = self else {
            return None;
        };
        let edge = if u < *from {
            *from
        } else if u > *to {
            *to
        } else {
            return None;
        };
        (low < edge && edge < high).then_some(edge)
    }

    /// Bounds on the slope over `[low, high]`.
    pub(crate) fn slopes(&self, low: f64, high: f64) -> (f64, f64) {
        match self {
            Shape::Parabola { weight, centre, .. } => (2.0 * weight * (low - centre), 2.0 * weight * (high - centre)),
            Shape::Wells { forward, backward, .. } => {
                let (least, most) = (low.exp(), high.exp());
                let ahead = forward.slopes(least, most);
                let behind = backward.slopes(1.0 / most, 1.0 / least);
                (ahead.0 - behind.1, ahead.1 - behind.0)
            }
        }
    }

    /// A lower bound on the curvature over `[low, high]`.
    pub(crate) fn least_curvature(&self, low: f64, high: f64) -> f64 {
        match self {
            Shape::Parabola { weight, .. } => 2.0 * weight,
            Shape::Wells { forward, backward, .. } => {
                let (least, most) = (low.exp(), high.exp());
                let each = forward.least_curvature(least, most) + backward.least_curvature(1.0 / most, 1.0 / least);
                if self.is_convex_over(low, high) { each.max(0.0) } else { each }
            }
        }
    }
}

/// The one interval of `u` on which two wells together are concave, slightly widened, or `None`.
///
/// With `z = e^u` the curvature times `z^2 / 2` is the quartic `2 R1 z^4 - R1 c1 z^3 - R2 c2 z + 2 R2`: two changes of sign, so
/// no or two positive roots (Descartes), and its slope has one positive root.
fn concave_interval(forward: &Well, backward: &Well) -> Option<(f64, f64)> {
    // Wider than the error of the roots, so that nothing outside of it is concave.
    const SLACK: f64 = 1e-11;
    match (forward.is_flat(), backward.is_flat()) {
        (true, true) => return None,
        (false, true) => return Some((f64::NEG_INFINITY, forward.inflection() + SLACK)),
        (true, false) => return Some((-backward.inflection() - SLACK, f64::INFINITY)),
        (false, false) => {}
    }
    let quartic = |u: f64| {
        let z = u.exp();
        2.0 * forward.weight() * z.powi(2)
            - forward.weight() * forward.centre() * z
            - backward.weight() * backward.centre() / z
            + 2.0 * backward.weight() / (z * z)
    };
    // Outside [-ln(c2 / 2), ln(c1 / 2)] (in either order) both wells curve the same way; between them one is concave.
    let ends = (forward.inflection(), -backward.inflection());
    let deepest = quartic_bottom(forward, backward).ln();
    if quartic(deepest) > 0.0 {
        return None;
    }
    let reach = 1.0 + (ends.0 - ends.1).abs();
    let left = sign_change(&quartic, deepest - reach, deepest);
    let right = sign_change(&quartic, deepest + reach, deepest);
    Some((left - SLACK, right + SLACK))
}

/// The positive `z` where the quartic of [`concave_interval`] is least: the root of `8 R1 z^3 - 3 R1 c1 z^2 - R2 c2`, by
/// Newton's method from the right, where the cubic is convex and increasing.
fn quartic_bottom(forward: &Well, backward: &Well) -> f64 {
    let square = 3.0 * forward.centre() / 8.0;
    let constant = backward.weight() * backward.centre() / (8.0 * forward.weight());
    let mut z = square + constant.cbrt();
    for _ in 0..60 {
        let step = (z * z * (z - square) - constant) / (z * (3.0 * z - 2.0 * square));
        z -= step;
        if step.abs() <= 1e-15 * z {
            break;
        }
    }
    z
}

/// Where `f` turns from positive (far side) to not positive at `inside`: the positive end of the bracket. `outside` is moved
/// further away until `f` is positive there.
fn sign_change(f: &impl Fn(f64) -> f64, outside: f64, inside: f64) -> f64 {
    let (mut positive, mut other) = (outside, inside);
    for _ in 0..40 {
        if f(positive) > 0.0 {
            break;
        }
        positive += positive - inside;
    }
    while (positive - other).abs() > 1e-12 * (1.0 + positive.abs()) {
        let middle = 0.5 * (positive + other);
        if f(middle) > 0.0 {
            positive = middle;
        } else {
            other = middle;
        }
    }
    positive
}
