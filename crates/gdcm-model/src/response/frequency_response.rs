//! Frequency responses as complex values.

use nalgebra::Complex;

use crate::dataset::{Pair, PairTable};

/// A model's values `H(j omega)` on a grid of `N` frequencies: a p x m table of curves.
///
/// A value is not finite if the response is undefined: at a pole on the imaginary axis, at and
/// above `pi / T` in discrete time, outside the measured frequencies, or for a model with a
/// [`LargeEntry`](super::large_entry::LargeEntry).
#[derive(Clone, Debug, PartialEq)]
pub struct FrequencyResponse {
    pub(super) curves: PairTable<Vec<Complex<f64>>>,
}

impl FrequencyResponse {
    /// Creates a frequency response from curves with `N` values each.
    pub fn new(curves: PairTable<Vec<Complex<f64>>>) -> Self {
        Self { curves }
    }

    /// Returns the output count, `p`.
    pub fn outputs(&self) -> usize {
        self.curves.outputs()
    }

    /// Returns the input count, `m`.
    pub fn inputs(&self) -> usize {
        self.curves.inputs()
    }

    /// Returns a response's `N` complex values.
    pub fn curve(&self, pair: Pair) -> &[Complex<f64>] {
        &self.curves[pair]
    }

    /// Returns every response's complex values, `[output, input]`.
    pub fn curves(&self) -> &PairTable<Vec<Complex<f64>>> {
        &self.curves
    }

    /// Returns the responses with at least one finite value whose finite values are all zero. They
    /// are treated as zero, even if other values are undefined.
    pub fn zero_where_finite(&self) -> Vec<Pair> {
        let mut zero = Vec::new();
        for (pair, curve) in self.curves.iter() {
            let mut finite = curve.iter().filter(|value| value.is_finite()).peekable();
            if finite.peek().is_some() && finite.all(|value| value.norm() == 0.0) {
                zero.push(pair);
            }
        }
        zero
    }

    /// Returns the responses that are not finite at one or more frequencies.
    pub fn not_finite(&self) -> Vec<Pair> {
        let mut not_finite = Vec::new();
        for (pair, curve) in self.curves.iter() {
            if curve.iter().any(|value| !value.is_finite()) {
                not_finite.push(pair);
            }
        }
        not_finite
    }
}
