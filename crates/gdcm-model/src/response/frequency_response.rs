//! Frequency responses as complex values, and the grid of their frequencies.

use nalgebra::Complex;

use crate::dataset::{Band, Pair, PairTable};

/// Values `H(j omega)` of every response of a model on a grid of `N` frequencies: a p x m table of
/// curves.
///
/// A value is not finite if the response is undefined: at a pole on the imaginary axis, or outside
/// the frequencies of measured data.
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

    /// Returns the `N` complex values of a response.
    pub fn curve(&self, pair: Pair) -> &[Complex<f64>] {
        &self.curves[pair]
    }

    /// Returns the complex values of every response, `[output, input]`.
    pub fn curves(&self) -> &PairTable<Vec<Complex<f64>>> {
        &self.curves
    }

    /// Returns the responses with at least one finite value whose finite values are all zero. They
    /// are treated as zero, even if other values are undefined.
    pub fn zero_where_finite(&self) -> Vec<Pair> {
        let mut found = Vec::new();
        for (pair, curve) in self.curves.iter() {
            let mut finite = curve.iter().filter(|value| value.is_finite()).peekable();
            if finite.peek().is_some() && finite.all(|value| value.norm() == 0.0) {
                found.push(pair);
            }
        }
        found
    }

    /// Returns the responses that are not finite at one or more frequencies.
    pub fn not_finite(&self) -> Vec<Pair> {
        let mut found = Vec::new();
        for (pair, curve) in self.curves.iter() {
            if curve.iter().any(|value| !value.is_finite()) {
                found.push(pair);
            }
        }
        found
    }
}

/// `N` frequencies \[rad/s\], rising, logarithmically spaced over a band, both ends included (M2).
#[derive(Clone, Debug, PartialEq)]
pub struct FrequencyGrid {
    omega: Vec<f64>,
}

impl FrequencyGrid {
    /// Creates a grid of [`log_spaced`] frequencies over a band, `N = max(points, 2)`.
    pub fn logarithmic(band: Band, points: usize) -> Self {
        Self {
            omega: log_spaced(band.min(), band.max(), points),
        }
    }

    /// Creates a grid from rising frequencies \[rad/s\], at least two.
    pub fn at(omega: Vec<f64>) -> Self {
        Self { omega }
    }

    /// Returns the frequencies \[rad/s\].
    pub fn omega(&self) -> &[f64] {
        &self.omega
    }

    /// Returns the frequency count, `N`.
    pub fn len(&self) -> usize {
        self.omega.len()
    }

    /// Always false: a grid has at least two frequencies.
    pub fn is_empty(&self) -> bool {
        self.omega.is_empty()
    }
}

/// Returns `omega_k = exp(ln low + (k / (N - 1)) (ln high - ln low))` \[rad/s\], k = 0 ... N - 1,
/// for `N = max(count, 2)`; the ends are exact.
#[must_use]
pub fn log_spaced(lowest: f64, highest: f64, count: usize) -> Vec<f64> {
    let low = lowest.ln();
    let high = highest.ln();
    let last = count.max(2) - 1;
    let mut omega: Vec<f64> = (0..=last)
        .map(|k| (low + (high - low) * k as f64 / last as f64).exp())
        .collect();
    omega[0] = lowest;
    omega[last] = highest;
    omega
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_ends_are_included_and_the_ratio_is_constant() {
        let grid = FrequencyGrid::logarithmic(Band::new(0.5, 12.0).unwrap(), 200);
        assert_eq!(
            (grid.omega()[0], grid.omega()[199], grid.len()),
            (0.5, 12.0, 200)
        );
        let ratio = (12.0_f64 / 0.5).powf(1.0 / 199.0);
        for pair in grid.omega().windows(2) {
            // Tolerance: exp and ln each round by about 1 ulp, for arguments up to 2.5.
            assert!((pair[1] / pair[0] / ratio - 1.0).abs() < 1e-14);
        }
    }
}
