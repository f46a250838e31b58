//! Interval on which a sum of two exponentials is concave.
//!
//! ```text
//! f(u)   = R1 (e^u - c1)^2 + R2 (e^-u - c2)^2
//! f''(u) = 2 q(z) / z^2,   q(z) = 2 R1 z^4 - R1 c1 z^3 - R2 c2 z + 2 R2,   z = e^u
//! ```
//!
//! `u` or `-u` is the logarithm of a gain product up to a constant. `R1`, `c1` are the `forward`
//! exponential's weight and centre, `R2`, `c2` the `backward` exponential's. Alone, each is concave
//! below its *inflection*, `ln(c / 2)` in its own argument `u` or `-u`.

use super::exponential::Exponential;
use crate::correction::interval::Interval;

/// Maximum iterations for the minimum of the quartic `q`; a few are typical.
const NEWTON_STEPS: usize = 60;
/// Relative step at which the search for this minimum ends: rounding level.
const NEWTON_ROUNDING: f64 = 1e-15;
/// Maximum number of times that a bracket's outer end is moved to twice its distance from the
/// bracket's first inner end.
const DOUBLINGS: usize = 40;
/// Relative bracket width at which the bisection ends. The bracket's outer end is returned, so that
/// the remaining width only makes the concave interval slightly too wide.
const BRACKET_WIDTH: f64 = 1e-12;

/// Finds the only interval on which the exponentials' sum is concave, widened slightly; `None` if
/// the sum is convex everywhere.
///
/// ```text
/// both exponentials zero   none
/// only forward             -infinity to its inflection ln(c1 / 2)
/// only backward            its inflection -ln(c2 / 2) to infinity
/// both                     1  u at which the quartic q is minimal
///                          2  none, if q is positive there by more than its rounding error
///                          3  each end by bisection, between that u and a point outside, where
///                             the sum is surely convex
/// ```
///
/// The coefficients of `q` change sign twice, so that `q` has either no or two positive roots
/// (Descartes); its derivative has a single positive root.
pub(super) fn concave_interval(forward: &Exponential, backward: &Exponential) -> Option<Interval> {
    // Far above the rounding error in a logarithm up to 83, twice the widest range of a gain (-180
    // to 180 dB).
    const SLACK: f64 = 1e-11;
    match (forward.is_zero(), backward.is_zero()) {
        (true, true) => return None,
        (false, true) => {
            return Some(Interval {
                low: f64::NEG_INFINITY,
                high: forward.inflection() + SLACK,
            });
        }
        (true, false) => {
            return Some(Interval {
                low: -backward.inflection() - SLACK,
                high: f64::INFINITY,
            });
        }
        (false, false) => {}
    }
    // Step 1
    let deepest = quartic_minimum(forward, backward).ln();
    // Step 2
    if is_surely_convex(forward, backward, deepest) {
        return None;
    }
    // Step 3. First guess for the brackets: `reach` exceeds the distance between the inflections
    // `ln(c1 / 2)` and `-ln(c2 / 2)`; `convex_end` moves further away if necessary.
    let reach = 1.0 + (forward.inflection() + backward.inflection()).abs();
    let left = convex_end(forward, backward, deepest - reach, deepest);
    let right = convex_end(forward, backward, deepest + reach, deepest);
    Some(Interval {
        low: left - SLACK,
        high: right + SLACK,
    })
}

/// Returns whether `q(z) / z^2` is positive at `u` by more than its rounding error.
fn is_surely_convex(forward: &Exponential, backward: &Exponential, u: f64) -> bool {
    let z = u.exp();
    let parts = [
        2.0 * forward.weight * z.powi(2),
        -forward.weight * forward.centre * z,
        -backward.weight * backward.centre / z,
        2.0 * backward.weight / (z * z),
    ];
    // Each part is a product of up to three rounded factors, with its own rounding.
    let relative = 4.0 * forward.relative_error(u).max(backward.relative_error(u));
    let least: f64 = parts.iter().map(|part| part - relative * part.abs()).sum();
    least > 0.0
}

/// Returns the positive `z` at which `q` is minimal: the root of its derivative
/// `8 R1 z^3 - 3 R1 c1 z^2 - R2 c2`, found by Newton's method from the right, where this cubic is
/// convex and increasing.
fn quartic_minimum(forward: &Exponential, backward: &Exponential) -> f64 {
    let square = 3.0 * forward.centre / 8.0;
    let constant = backward.weight * backward.centre / (8.0 * forward.weight);
    let mut z = square + constant.cbrt();
    for _ in 0..NEWTON_STEPS {
        let step = (z * z * (z - square) - constant) / (z * (3.0 * z - 2.0 * square));
        z -= step;
        if step.abs() <= NEWTON_ROUNDING * z {
            break;
        }
    }
    z
}

/// Finds the concave interval's end between `outside` and `inside` by bisection, and returns the
/// final bracket's outer end, where the sum is surely convex. Requires that it is not surely convex
/// at `inside`; `outside` is moved further away until it is surely convex there.
fn convex_end(forward: &Exponential, backward: &Exponential, outside: f64, inside: f64) -> f64 {
    let mut outer = outside;
    let mut inner = inside;
    for _ in 0..DOUBLINGS {
        if is_surely_convex(forward, backward, outer) {
            break;
        }
        outer += outer - inside;
    }
    while (outer - inner).abs() > BRACKET_WIDTH * (1.0 + outer.abs()) {
        let middle = 0.5 * (outer + inner);
        if is_surely_convex(forward, backward, middle) {
            outer = middle;
        } else {
            inner = middle;
        }
    }
    outer
}
