//! Terms in the objective: functions of a scale difference `u`, with bounds on their rounding
//! errors. The *scales* are the unknowns in the search ([`super`]): logarithms of gains, or delays.
//!
//! ```text
//! f(u) = W (u - c)^2                              gains compared in dB, and delays
//! f(u) = R1 (e^u - c1)^2 + R2 (e^-u - c2)^2       gains compared as ratios
//! ```
//!
//! `R1` and `c1` are the `forward` exponential's weight and centre, `R2` and `c2` those of the
//! `backward` exponential, which is a function of `-u`.

use super::concave_interval::concave_interval;
use super::derivatives::{Derivatives, Range};
use super::exponential::Exponential;
use super::rounded::Rounded;
use crate::correction::interval::Interval;

/// A term in the objective: a function of `u = s_to - s_from`.
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

/// The objective as a sum of terms, at most one for each pair of scales, and a constant.
#[derive(Clone, Debug)]
pub(crate) struct TermSum {
    pub(crate) terms: Vec<Term>,
    /// Entries that no scale changes, and the minima of the entries combined into the terms.
    pub(crate) constant: Rounded,
}

/// A term's function of `u`.
#[derive(Clone, Debug)]
pub(crate) enum Function {
    /// `weight (u - centre)^2`: gains compared in dB, and delays.
    Quadratic {
        weight: f64,
        centre: Rounded,
        /// Relative error in the weight.
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

    /// Returns value, slope and curvature at `u`.
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

    /// Returns the concave interval's end that is nearest to `u`; `None` if there is no concave
    /// interval, `u` is inside it, or the end is outside the open interval `within`. A split at
    /// this end separates a part in which the function is convex.
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

    /// Returns bounds on the slope over an interval. [`Range::size`] adds up the summands'
    /// magnitudes, to which the rounding errors are proportional.
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

    /// Returns bounds on the curvature over an interval, with `size` as in [`Self::slopes`]. For a
    /// single exponential, only the lower bound is sharp; for the sum of both, neither is sharp,
    /// because their minima are at different `u`.
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
                // The sum of the minima may be negative although the function is convex.
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
