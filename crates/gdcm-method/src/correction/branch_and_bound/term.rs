//! Terms of the objective: functions of a difference `u` of scales, with bounds on their rounding
//! errors.
//!
//! ```text
//! f(u) = W (u - c)^2                              gains compared in dB, and delays
//! f(u) = R1 (e^u - c1)^2 + R2 (e^-u - c2)^2       gains compared as ratios
//! ```
//!
//! `R1` and `c1` are the weight and the centre of the `forward` exponential, `R2` and `c2` those of
//! the `backward` exponential, which is a function of `-u`.

use super::derivatives::{Derivatives, Range};
use super::exponential::Exponential;
use super::rounded::Rounded;
use crate::correction::interval::Interval;

/// A term of the objective: a function of `u = s_to - s_from`.
#[derive(Clone, Debug)]
pub(crate) struct Term {
    /// Index of the subtracted scale.
    pub(crate) from: usize,
    /// Index of the added scale.
    pub(crate) to: usize,
    pub(crate) function: Function,
}

impl Term {
    /// Returns `u = s_to - s_from`.
    pub(super) fn difference(&self, scales: &[f64]) -> f64 {
        scales[self.to] - scales[self.from]
    }
}

/// A sum of terms and a constant.
#[derive(Clone, Debug)]
pub(crate) struct TermSum {
    pub(crate) terms: Vec<Term>,
    pub(crate) constant: Rounded,
}

/// A function of a difference of scales.
#[derive(Clone, Debug)]
pub(crate) enum Function {
    /// `weight (u - centre)^2`: gains compared in dB, and delays.
    Quadratic {
        weight: f64,
        centre: Rounded,
        /// Relative error of the weight.
        relative: f64,
    },
    /// `forward` in `u` plus `backward` in `-u`: gains compared as ratios.
    Exponential {
        forward: Exponential,
        backward: Exponential,
        /// The only interval on which the sum is concave; `None` if there is none.
        concave: Option<Interval>,
    },
}

impl Function {
    /// Creates the sum from two exponentials, and finds the interval on which it is concave.
    pub(crate) fn exponential(forward: Exponential, backward: Exponential) -> Self {
        Function::Exponential {
            forward,
            backward,
            concave: concave_interval(&forward, &backward),
        }
    }

    /// Evaluates the function at `u`.
    pub(crate) fn evaluate(&self, u: f64) -> Derivatives {
        match self {
            Function::Quadratic {
                weight,
                centre,
                relative,
            } => {
                let away = u - centre.value;
                let error = centre.error + f64::EPSILON * (u.abs() + away.abs());
                let slope = 2.0 * weight * away;
                Derivatives {
                    value: Rounded::square(*weight, away, error, *relative),
                    slope: Rounded {
                        value: slope,
                        error: 2.0 * weight * error + (relative + f64::EPSILON) * slope.abs(),
                    },
                    curvature: 2.0 * weight,
                }
            }
            Function::Exponential {
                forward, backward, ..
            } => {
                let z = u.exp();
                let ahead = forward.evaluate(u, z);
                if backward.is_zero() {
                    ahead
                } else {
                    ahead.plus_mirrored(backward.evaluate(-u, 1.0 / z))
                }
            }
        }
    }

    /// Returns whether the function is convex over the interval.
    pub(crate) fn is_convex_over(&self, over: Interval) -> bool {
        match self {
            Function::Exponential {
                concave: Some(concave),
                ..
            } => over.high <= concave.low || over.low >= concave.high,
            _ => true,
        }
    }

    /// Returns the end of the concave interval that is nearest to `u`; `None` if `u` is inside the
    /// concave interval, or if the end is outside the open interval `within`.
    pub(crate) fn concave_end(&self, u: f64, within: Interval) -> Option<f64> {
        let Function::Exponential {
            concave: Some(concave),
            ..
        } = self
        else {
            return None;
        };
        let end = if u < concave.low {
            concave.low
        } else if u > concave.high {
            concave.high
        } else {
            return None;
        };
        if within.low < end && end < within.high {
            Some(end)
        } else {
            None
        }
    }

    /// Returns bounds on the slope over an interval.
    pub(crate) fn slopes(&self, over: Interval) -> Range {
        match self {
            Function::Quadratic { .. } => {
                let down = self.evaluate(over.low).slope;
                let up = self.evaluate(over.high).slope;
                let size = down.value.abs().max(up.value.abs());
                Range {
                    least: down.value - down.error,
                    most: up.value + up.error,
                    size,
                }
            }
            Function::Exponential {
                forward, backward, ..
            } => {
                let ahead = forward.slopes(over);
                let behind = backward.slopes(over.mirrored());
                let size = ahead.size + behind.size;
                Range {
                    least: ahead.least - behind.most,
                    most: ahead.most - behind.least,
                    size,
                }
            }
        }
    }

    /// Returns bounds on the curvature over an interval; only the lower bound is sharp.
    pub(crate) fn curvatures(&self, over: Interval) -> Range {
        match self {
            Function::Quadratic {
                weight, relative, ..
            } => {
                let size = 2.0 * weight;
                Range {
                    least: size * (1.0 - relative),
                    most: size * (1.0 + relative),
                    size,
                }
            }
            Function::Exponential {
                forward, backward, ..
            } => {
                let ahead = forward.curvatures(over);
                let behind = backward.curvatures(over.mirrored());
                let mut least = ahead.least + behind.least;
                if self.is_convex_over(over) {
                    least = least.max(0.0);
                }
                Range {
                    least,
                    most: ahead.most + behind.most,
                    size: ahead.size + behind.size,
                }
            }
        }
    }
}

/// Finds the only interval on which the sum of two exponentials is concave, widened slightly;
/// `None` if the sum is convex everywhere.
///
/// With `z = e^u` the curvature times `z^2 / 2` is the quartic
/// `2 R1 z^4 - R1 c1 z^3 - R2 c2 z + 2 R2`. Its coefficients change sign twice, so that it has
/// either no or two positive roots (Descartes); its derivative has a single positive root.
fn concave_interval(forward: &Exponential, backward: &Exponential) -> Option<Interval> {
    // Far above the rounding error of a logarithm of magnitude up to 83 (twice 180 dB, in both
    // directions).
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
    let deepest = quartic_least(forward, backward).ln();
    if is_surely_convex(forward, backward, deepest) {
        return None;
    }
    // First guess of the brackets: `reach` exceeds the distance between the inflections
    // `ln(c1 / 2)` and `-ln(c2 / 2)`; `convex_end` moves further away if necessary.
    let reach = 1.0 + (forward.inflection() + backward.inflection()).abs();
    let left = convex_end(forward, backward, deepest - reach, deepest);
    let right = convex_end(forward, backward, deepest + reach, deepest);
    Some(Interval {
        low: left - SLACK,
        high: right + SLACK,
    })
}

/// Returns whether the quartic of [`concave_interval`], divided by `z^2`, is positive at `u` by
/// more than its rounding error.
fn is_surely_convex(forward: &Exponential, backward: &Exponential, u: f64) -> bool {
    let z = u.exp();
    let parts = [
        2.0 * forward.weight * z.powi(2),
        -forward.weight * forward.centre * z,
        -backward.weight * backward.centre / z,
        2.0 * backward.weight / (z * z),
    ];
    let relative = 4.0 * forward.relative_error(u).max(backward.relative_error(u));
    let least: f64 = parts.iter().map(|part| part - relative * part.abs()).sum();
    least > 0.0
}

/// Returns the positive `z` at which the quartic of [`concave_interval`] is minimal: the root of
/// `8 R1 z^3 - 3 R1 c1 z^2 - R2 c2`, found by Newton's method from the right, where the cubic is
/// convex and increasing.
fn quartic_least(forward: &Exponential, backward: &Exponential) -> f64 {
    let square = 3.0 * forward.centre / 8.0;
    let constant = backward.weight * backward.centre / (8.0 * forward.weight);
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

/// Finds the end of the concave interval between `outside` and `inside` by bisection, and returns
/// the convex side of the final bracket. Requires that the sum is not certainly convex at `inside`;
/// `outside` is moved further away until the sum is certainly convex there.
fn convex_end(forward: &Exponential, backward: &Exponential, outside: f64, inside: f64) -> f64 {
    let mut convex = outside;
    let mut other = inside;
    for _ in 0..40 {
        if is_surely_convex(forward, backward, convex) {
            break;
        }
        convex += convex - inside;
    }
    while (convex - other).abs() > 1e-12 * (1.0 + convex.abs()) {
        let middle = 0.5 * (convex + other);
        if is_surely_convex(forward, backward, middle) {
            convex = middle;
        } else {
            other = middle;
        }
    }
    convex
}
