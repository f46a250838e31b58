//! Values with a bound on their rounding error.

use std::ops::Neg;

/// A value with a bound on its rounding error: the exact value differs by at most `error`.
///
/// Sums carry a running error bound (Higham, *Accuracy and Stability of Numerical Algorithms*,
/// 2002, section 3.3): each addition rounds its result by at most half an epsilon. A whole epsilon
/// is added, which also covers rounding in the bound itself.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Rounded {
    pub(crate) value: f64,
    pub(crate) error: f64,
}

impl Neg for Rounded {
    type Output = Self;

    fn neg(self) -> Self {
        Self {
            value: -self.value,
            ..self
        }
    }
}

impl Rounded {
    /// Adds another value and its error.
    pub(crate) fn add(&mut self, other: Self) {
        self.value += other.value;
        self.error += other.error + f64::EPSILON * self.value.abs();
    }

    /// Computes `weight difference^2`, given the absolute error `error` of the difference and the
    /// relative error `relative` of the weight.
    pub(crate) fn square(weight: f64, difference: f64, error: f64, relative: f64) -> Self {
        let value = weight * difference * difference;
        let from_difference = weight * error * (2.0 * difference.abs() + error);
        Self {
            value,
            error: from_difference + (relative + 2.0 * f64::EPSILON) * value,
        }
    }
}
