//! Magnitudes and phases for comparing responses; responses that have none, or are numerically
//! zero.

use nalgebra::Complex;

use super::frequency_response::FrequencyResponse;
use crate::dataset::{Pair, PairTable};
use crate::units::ratio_to_db;

/// A response given by `N` magnitudes \[dB\] and `N` principal phases \[rad\], all finite.
#[derive(Clone, Debug, PartialEq)]
pub struct PolarCurve {
    /// `20 log10 |H|` at each frequency.
    pub magnitude_db: Vec<f64>,
    /// `arg H` at each frequency, in (-pi, pi].
    pub phase: Vec<f64>,
}

impl PolarCurve {
    /// Converts a response; `None` if it is zero or not finite at any frequency.
    pub fn from_values(values: &[Complex<f64>]) -> Option<Self> {
        let magnitude_db: Vec<f64> = values.iter().map(magnitude_db).collect();
        if magnitude_db.iter().any(|magnitude| !magnitude.is_finite()) {
            return None;
        }
        Some(Self {
            magnitude_db,
            phase: values.iter().map(|value| value.arg()).collect(),
        })
    }
}

/// Returns `20 log10 |H|`, computed as `10 log10 |H|^2` to avoid a square root, unless the square
/// overflows or underflows.
fn magnitude_db(value: &Complex<f64>) -> f64 {
    let square = value.norm_sqr();
    if square.is_normal() {
        10.0 * square.log10()
    } else {
        ratio_to_db(value.norm())
    }
}

/// Magnitude and phase for all responses of a model.
///
/// An entry is `None` for a response that is zero or not finite at some frequency (no connection
/// from input to output, pole on the imaginary axis, measured data with too short a range): it has
/// no G, D or J (M6).
#[derive(Clone, Debug, PartialEq)]
pub struct PolarResponse {
    curves: PairTable<Option<PolarCurve>>,
}

impl PolarResponse {
    /// Computes magnitude and phase for every response.
    pub fn new(response: &FrequencyResponse) -> Self {
        Self {
            curves: response
                .curves
                .map(|_, curve| PolarCurve::from_values(curve)),
        }
    }

    /// Computes magnitude and phase for the marked responses only, because a logarithm and an arc
    /// tangent take longer than the response itself; the other entries are `None`.
    pub fn from_marked(response: &FrequencyResponse, marked: &PairTable<bool>) -> Self {
        Self {
            curves: response.curves.map(|pair, curve| {
                if marked[pair] {
                    PolarCurve::from_values(curve)
                } else {
                    None
                }
            }),
        }
    }

    /// Returns the responses that are numerically zero (M6a): their peak over the band lies more
    /// than 120 dB (factor 1e-6) below the largest peak for the same output, and also below the
    /// largest peak for the same input; `false` for a response without a curve. Numerical
    /// differentiation produces such values instead of exact zeros.
    pub fn numerically_zero(&self) -> PairTable<bool> {
        /// Level \[dB\] below which a response is numerically zero, relative to the largest peaks.
        const LEAST_DB: f64 = -120.0;
        let peaks = self.curves.map(|_, curve| match curve {
            Some(curve) => largest(curve.magnitude_db.iter()),
            None => f64::NEG_INFINITY,
        });
        let outputs = peaks.outputs();
        let inputs = peaks.inputs();
        self.curves.map(|pair, curve| {
            let Pair { output, input } = pair;
            if curve.is_none() {
                return false;
            }
            let output_peak = largest((0..inputs).map(|input| &peaks[Pair { output, input }]));
            let input_peak = largest((0..outputs).map(|output| &peaks[Pair { output, input }]));
            peaks[pair] < output_peak + LEAST_DB && peaks[pair] < input_peak + LEAST_DB
        })
    }

    /// Removes the marked responses' curves.
    pub fn clear(&mut self, marked: &PairTable<bool>) {
        for pair in marked.marked() {
            self.curves[pair] = None;
        }
    }

    /// Returns the curves, `[output, input]`; `None` for a response that is undefined, not marked
    /// or cleared.
    pub fn curves(&self) -> &PairTable<Option<PolarCurve>> {
        &self.curves
    }
}

/// Returns the maximum; minus infinity for no values.
fn largest<'v>(values: impl Iterator<Item = &'v f64>) -> f64 {
    values.copied().fold(f64::NEG_INFINITY, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_response_is_zero_only_relative_to_both_channels() {
        // 2 x 2 responses: only the last is small relative to both its row and its column; the
        // third is small because its output has small units.
        let values = [[1.0, 1.0], [1e-7, 0.99e-13]];
        let curves = PairTable::from_fn(2, 2, |pair| {
            vec![Complex::from(values[pair.output][pair.input]); 3]
        });
        let mut polar = PolarResponse::new(&FrequencyResponse::new(curves));
        let nothing = polar.numerically_zero();
        assert_eq!(nothing.marked().collect::<Vec<_>>(), [Pair::new(1, 1)]);
        polar.clear(&nothing);
        assert!(
            polar.curves()[Pair::new(1, 1)].is_none() && polar.curves()[Pair::new(1, 0)].is_some()
        );
    }

    #[test]
    fn the_only_response_of_an_output_is_not_zero() {
        let curves = PairTable::from_fn(2, 1, |pair| {
            vec![Complex::from([1.0, 1e-20][pair.output]); 3]
        });
        let polar = PolarResponse::new(&FrequencyResponse::new(curves));
        assert_eq!(polar.numerically_zero().marked().count(), 0);
    }

    #[test]
    fn magnitudes_beyond_the_range_of_their_squares_are_exact() {
        for (magnitude, db) in [
            (1e-200, -4000.0),
            (1e-20, -400.0),
            (1.0, 0.0),
            (1e200, 4000.0),
        ] {
            // Tolerance: one rounding of the logarithm and one of its multiple.
            assert!((magnitude_db(&Complex::new(0.0, magnitude)) - db).abs() < 1e-12);
        }
        assert_eq!(magnitude_db(&Complex::new(0.0, 0.0)), f64::NEG_INFINITY);
        assert!(magnitude_db(&Complex::new(f64::NAN, 0.0)).is_nan());
    }
}
