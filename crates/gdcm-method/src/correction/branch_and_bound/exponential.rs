//! Exponential terms: all entries whose products depend on the same scale difference, combined into
//! a single square.
//!
//! ```text
//! sum w (G - A e^v)^2 = R (e^v - c)^2 + least,     R = sum w A^2,   c = sum w G A / R
//! ```
//!
//! An *entry* is a response of an output to an input, or an output's deviation from neutral: its
//! delta gain `G` is the gain that it needs (neutral: 1), its gain product `A e^v` the gain that
//! the channels give it, `w` its weight. `v` is the scale of the input's component less that of the
//! output's (scales: [`super`]); `A` is the product at `v = 0`.

use super::derivatives::{Derivatives, Range};
use super::rounded::Rounded;
use crate::correction::interval::Interval;

/// The function `R (e^v - c)^2`: the sum over the entries, less its minimum.
///
/// Concave where `e^v < c / 2`, convex elsewhere.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Exponential {
    /// `R`.
    pub(super) weight: f64,
    /// `c`.
    pub(super) centre: f64,
    /// Bound on the relative rounding error in `weight` and `centre`.
    rounding: f64,
}

/// An entry `weight (gain - product e^v)^2`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ProductEntry {
    /// `w`.
    weight: f64,
    /// `G`.
    gain: f64,
    /// `A`.
    product: f64,
    /// Relative rounding error in `product`.
    error: f64,
}

impl ProductEntry {
    /// Creates the entry `weight (gain - e^logarithm e^v)^2`.
    pub(crate) fn new(weight: f64, gain: f64, logarithm: Rounded) -> Self {
        // The logarithm's absolute error is the product's relative error; the exponential adds an
        // epsilon.
        Self {
            weight,
            gain,
            product: logarithm.value.exp(),
            error: logarithm.error + f64::EPSILON,
        }
    }

    /// Returns the weighted square at `v = 0`.
    pub(crate) fn square(&self) -> Rounded {
        let difference = self.gain - self.product;
        let error = self.error * self.product + f64::EPSILON * difference.abs();
        Rounded::square(self.weight, difference, error, 0.0)
    }
}

/// A sum of [`ProductEntry`] values, written as an exponential term plus a constant.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct CombinedEntries {
    pub(crate) exponential: Exponential,
    /// The sum's minimum over `v`.
    pub(crate) least: Rounded,
}

impl CombinedEntries {
    /// Combines the entries that share `v`.
    ///
    /// The minimum is summed from the residuals at `e^v = c`: `sum w G^2 - R c^2` would cancel.
    pub(crate) fn new(entries: &[ProductEntry]) -> Self {
        let weight = entries
            .iter()
            .map(|entry| entry.weight * entry.product * entry.product)
            .sum::<f64>();
        if weight <= 0.0 {
            return Self::default();
        }
        let moment = entries
            .iter()
            .map(|entry| entry.weight * entry.gain * entry.product)
            .sum::<f64>();
        let centre = moment / weight;
        let mut least = Rounded::default();
        let mut worst = 0.0_f64;
        for entry in entries {
            let at_minimum = ProductEntry {
                product: entry.product * centre,
                error: entry.error + f64::EPSILON,
                ..*entry
            };
            least.add(at_minimum.square());
            worst = worst.max(entry.error);
        }
        // A sum of n positive terms has at most the relative error n epsilon / 2. The centre is a
        // quotient of two such sums, in which the product appears three times.
        let rounding = 3.0 * worst + (entries.len() as f64 + 4.0) * f64::EPSILON;
        let exponential = Exponential {
            weight,
            centre,
            rounding,
        };
        Self { exponential, least }
    }
}

impl Exponential {
    /// Returns whether the function is zero everywhere.
    pub(crate) fn is_zero(&self) -> bool {
        self.weight == 0.0
    }

    /// Returns the logarithm `v` below which the function is concave.
    pub(crate) fn inflection(&self) -> f64 {
        (0.5 * self.centre).ln()
    }

    /// Returns a bound on the relative rounding error in `weight`, `centre` and `z = e^v`:
    /// `rounding` plus the errors in the difference `v`, in the exponential and in its reciprocal.
    pub(super) fn relative_error(&self, v: f64) -> f64 {
        self.rounding + (v.abs() + 4.0) * f64::EPSILON
    }

    /// Evaluates the function at `v`, given `z = e^v`.
    pub(crate) fn evaluate(&self, v: f64, z: f64) -> Derivatives {
        let away = z - self.centre;
        let relative = self.relative_error(v);
        let error = relative * (z + self.centre);
        let slope = 2.0 * self.weight * z * away;
        Derivatives {
            value: Rounded::square(self.weight, away, error, relative),
            slope: Rounded {
                value: slope,
                error: 2.0 * self.weight * z * error + 2.0 * relative * slope.abs(),
            },
            curvature: 2.0 * self.weight * z * (z + away),
        }
    }

    /// Bounds the curvature over an interval in `v`: it is a parabola in `e^v`, minimal at `centre
    /// / 4`. Only the lower bound is sharp.
    pub(crate) fn curvatures(&self, v: Interval) -> Range {
        let least = v.low.exp();
        let most = v.high.exp();
        let lowest_at = (0.25 * self.centre).clamp(least, most);
        let lowest = 2.0 * self.weight * lowest_at * (2.0 * lowest_at - self.centre);
        let size = 2.0 * self.weight * most * (2.0 * most + self.centre);
        let margin = 4.0 * self.relative_error(v.low.abs().max(v.high.abs())) * size;
        Range {
            least: lowest - margin,
            most: size + margin,
            size,
        }
    }

    /// Bounds the slope over an interval in `v`: it is a parabola in `e^v`, minimal at `centre /
    /// 2`.
    pub(crate) fn slopes(&self, v: Interval) -> Range {
        let least = v.low.exp();
        let most = v.high.exp();
        let size = 2.0 * self.weight * most * (most + self.centre);
        let margin = 4.0 * self.relative_error(v.low.abs().max(v.high.abs())) * size;
        let lowest = self.slope_at((0.5 * self.centre).clamp(least, most));
        let highest = self.slope_at(least).max(self.slope_at(most));
        Range {
            least: lowest - margin,
            most: highest + margin,
            size,
        }
    }

    /// Returns the slope with respect to `v` at `z = e^v`.
    fn slope_at(&self, z: f64) -> f64 {
        2.0 * self.weight * z * (z - self.centre)
    }
}
