//! Figures that know how well they are known.

/// A figure with a bound on its rounding: the exact one is no further away than `error`.
///
/// Sums carry a running error bound (Higham, Accuracy and Stability of Numerical Algorithms, section 3.3): each addition rounds
/// its result by at most half an epsilon of it. A whole epsilon is counted, which covers the rounding of the bound itself.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Rounded {
    pub(crate) value: f64,
    pub(crate) error: f64,
}

impl Rounded {
    /// Adds another figure.
    pub(crate) fn add(&mut self, other: Self) {
        self.value += other.value;
        self.error += other.error + f64::EPSILON * self.value.abs();
    }

    /// `weight difference^2`, where the difference is known to `error` and the weight to `relative`.
    pub(crate) fn square(weight: f64, difference: f64, error: f64, relative: f64) -> Self {
        let value = weight * difference * difference;
        let of_difference = weight * error * (2.0 * difference.abs() + error);
        Self { value, error: of_difference + (relative + 2.0 * f64::EPSILON) * value }
    }
}
