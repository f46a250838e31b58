//! Convex envelope for an exponential `g(v) = R (e^v - c)^2` over an interval `low <= v <= high`: a
//! line on the left, where `g` is concave, the exponential itself on the right (McCormick 1976).
//!
//! ```text
//! tangent  through (low, g(low)), touching g at a point beyond the inflection
//! chord    from (low, g(low)) to (high, g(high)), if no such point lies within the interval
//! ```
//!
//! `R` and `c` are the exponential's weight and centre ([`Exponential`]); its inflection is at
//! `v = ln(c / 2)`.

use super::derivatives::Derivatives;
use super::exponential::Exponential;
use super::rounded::Rounded;
use crate::correction::interval::Interval;

/// Maximum iterations for the tangent; the work per term in `underestimator` allows for them.
const TANGENT_STEPS: usize = 14;
/// Distance between the tangent and the function at the left end, relative to the function's value,
/// at which the tangent is close enough.
const SUFFICIENT_CLOSENESS: f64 = 1e-9;

/// Line that replaces the exponential below `until` in its convex envelope.
#[derive(Clone, Copy, Debug)]
pub(super) struct Line {
    /// Argument up to which the line applies.
    until: f64,
    /// Argument for which `value` is given.
    at: f64,
    value: Rounded,
    slope: f64,
}

impl Line {
    /// Finds the line in an exponential's envelope over an interval: the tangent through the left
    /// end, or the chord if there is no such tangent; `None` if the exponential is convex.
    pub(super) fn of_envelope(function: &Exponential, over: Interval) -> Option<Self> {
        if function.is_zero() || over.low >= function.inflection() {
            return None;
        }
        let start = function.evaluate(over.low, over.low.exp());
        let end = function.evaluate(over.high, over.high.exp());
        // The tangent touches beyond the right end if even the tangent there overshoots the left
        // end: the overshoot decreases to the right.
        if over.high <= function.inflection() || overshoot(over.low, &start, over.high, &end) >= 0.0
        {
            return Some(Self::chord(over, start.value, end.value));
        }
        Some(Self::tangent(function, over, &start, end))
    }

    /// Finds the tangent through the left end by Newton's method within a bracket. `start` and
    /// `end` are the function at both interval ends. The tangent at the bracket's right end is
    /// returned: it passes below the left end, and thus below the function, so that an approximate
    /// tangent is sufficient.
    fn tangent(
        function: &Exponential,
        over: Interval,
        start: &Derivatives,
        end: Derivatives,
    ) -> Self {
        let low = over.low;
        // Bracket: the tangent at `left` overshoots the left end, the tangent at `right` does not.
        let mut left = function.inflection().max(low);
        let mut right = over.high;
        let mut tangent = end;
        for _ in 0..TANGENT_STEPS {
            let excess = overshoot(low, start, right, &tangent);
            let newton = right - excess / (tangent.curvature * (low - right));
            let next = if left < newton && newton < right {
                newton
            } else {
                0.5 * (left + right)
            };
            let at = function.evaluate(next, next.exp());
            if overshoot(low, start, next, &at) > 0.0 {
                left = next;
            } else {
                right = next;
                tangent = at;
            }
            if -overshoot(low, start, right, &tangent) <= SUFFICIENT_CLOSENESS * start.value.value {
                break;
            }
        }
        // Rounding in the values at both ends, and in the slope over the interval.
        let error =
            start.value.error + tangent.value.error + 2.0 * tangent.slope.error * (right - low);
        let value = Rounded {
            value: tangent.value.value,
            error: error + 4.0 * f64::EPSILON * start.value.value,
        };
        Self {
            until: right,
            at: right,
            value,
            slope: tangent.slope.value,
        }
    }

    /// Returns the line through the values at both ends; its error includes their rounding.
    fn chord(over: Interval, start: Rounded, end: Rounded) -> Self {
        let slope = if over.high > over.low {
            (end.value - start.value) / over.width()
        } else {
            0.0
        };
        let error =
            start.error + end.error + 4.0 * f64::EPSILON * (start.value.abs() + end.value.abs());
        // In exact arithmetic both are equal; the lower keeps the line below the function at both
        // ends.
        let value = start.value.min(end.value - slope * over.width());
        Self {
            until: f64::INFINITY,
            at: over.low,
            value: Rounded { value, error },
            slope,
        }
    }

    /// Evaluates the line at the argument `v`.
    fn evaluate(&self, v: f64) -> Derivatives {
        let rise = self.slope * (v - self.at);
        let mut value = self.value;
        value.add(Rounded {
            value: rise,
            error: f64::EPSILON * (2.0 * rise.abs() + (self.slope * v).abs()),
        });
        Derivatives {
            value,
            slope: Rounded {
                value: self.slope,
                error: 0.0,
            },
            curvature: 0.0,
        }
    }
}

/// Returns the amount by which the tangent at `v`, extended to `low`, exceeds the value `start` at
/// `low`; it decreases as `v` increases beyond the inflection. `at` is the function at `v`.
fn overshoot(low: f64, start: &Derivatives, v: f64, at: &Derivatives) -> f64 {
    at.value.value + at.slope.value * (low - v) - start.value.value
}

/// Evaluates the envelope at `v`: on the line, if there is one and `v` is below its end, otherwise
/// on the exponential.
pub(super) fn enveloped(function: &Exponential, line: Option<&Line>, v: f64) -> Derivatives {
    match line {
        Some(line) if v < line.until => line.evaluate(v),
        _ if function.is_zero() => Derivatives::default(),
        _ => function.evaluate(v, v.exp()),
    }
}
