//! A sum of squares that knows how well it is known.

/// A sum of squares with a bound on its rounding.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Sum {
    pub(crate) value: f64,
    pub(crate) error: f64,
}

impl Sum {
    /// Adds `share difference^2`, where `difference` is that of two figures of the size `size` or less, each known to
    /// `roundings` roundings.
    pub(crate) fn add(&mut self, share: f64, difference: f64, size: f64, roundings: f64) {
        let error = roundings * f64::EPSILON * size;
        let square = difference * difference;
        self.value += share * square;
        // A sum of up to a hundred terms rounds each of them up to a hundred times.
        self.error += share * (error * (2.0 * difference.abs() + error) + 128.0 * f64::EPSILON * square);
    }

    /// Adds another sum.
    pub(crate) fn join(&mut self, other: Self) {
        self.value += other.value;
        self.error += other.error;
    }
}
