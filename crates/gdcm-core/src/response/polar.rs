//! A frequency response as magnitude and phase, the form in which models are compared.

use nalgebra::Complex;

use crate::dataset::{Pair, PairTable};
use crate::units::ratio_to_db;

use super::frequency_response::FrequencyResponse;

/// One response as `N` magnitudes \[dB\] and `N` principal phases \[rad\]; all finite.
#[derive(Clone, Debug, PartialEq)]
pub struct PolarCurve {
    /// `20 log10 |H|`.
    pub magnitude_db: Vec<f64>,
    /// `arg H` in (-pi, pi].
    pub phase: Vec<f64>,
}

impl PolarCurve {
    /// Magnitude and phase of one response, where it is finite and not zero at every frequency.
    pub fn of(values: &[Complex<f64>]) -> Option<Self> {
        let magnitude_db: Vec<f64> = values.iter().map(magnitude_db).collect();
        if magnitude_db.iter().any(|magnitude| !magnitude.is_finite()) {
            return None;
        }
        Some(Self { magnitude_db, phase: values.iter().map(|value| value.arg()).collect() })
    }

    fn peak_db(&self) -> f64 {
        self.magnitude_db.iter().copied().fold(f64::NEG_INFINITY, f64::max)
    }
}

/// `20 log10 |H| = 10 log10 |H|^2`; the square spares a root where it neither overflows nor underflows.
fn magnitude_db(value: &Complex<f64>) -> f64 {
    let square = value.norm_sqr();
    if square.is_normal() { 10.0 * square.log10() } else { ratio_to_db(value.norm()) }
}

/// Every response of a model as magnitude and phase.
///
/// An entry is `None` where the response is zero or not finite at some frequency (a structurally zero response, a pole on the
/// imaginary axis, measured data that does not reach): there it has no G, no D and no J (M6).
#[derive(Clone, Debug, PartialEq)]
pub struct PolarResponse {
    curves: PairTable<Option<PolarCurve>>,
}

impl PolarResponse {
    /// Magnitude and phase of every response.
    pub fn of(response: &FrequencyResponse) -> Self {
        let curve = |pair| PolarCurve::of(&response.curve(pair));
        Self { curves: PairTable::from_fn(response.outputs(), response.inputs(), curve) }
    }

    /// Magnitude and phase of the marked responses; the others are left undefined, for a logarithm and an arc tangent cost more
    /// than the response itself.
    pub fn of_marked(response: &FrequencyResponse, marked: &PairTable<bool>) -> Self {
        let curve = |pair| if marked[pair] { PolarCurve::of(&response.curve(pair)) } else { None };
        Self { curves: PairTable::from_fn(response.outputs(), response.inputs(), curve) }
    }

    /// The responses that are numerically nothing: their peak over the band, \[dB\], lies 120 dB (1e-6) below the greatest of
    /// their output and below the greatest of their input (M6a). Differencing leaves such numbers where zero is meant.
    pub fn numerically_nothing(&self) -> PairTable<bool> {
        const LEAST_DB: f64 = -120.0;
        let peaks = self.curves.map(|_, curve| curve.as_ref().map_or(f64::NEG_INFINITY, PolarCurve::peak_db));
        let greatest = |of: &dyn Fn(Pair) -> bool| {
            peaks.iter().filter(|(pair, _)| of(*pair)).map(|(_, peak)| *peak).fold(f64::NEG_INFINITY, f64::max)
        };
        self.curves.map(|pair, curve| {
            let of_output = || greatest(&|other| other.output == pair.output);
            let of_input = || greatest(&|other| other.input == pair.input);
            curve.is_some() && peaks[pair] < of_output() + LEAST_DB && peaks[pair] < of_input() + LEAST_DB
        })
    }

    /// Makes the marked responses undefined.
    pub fn clear(&mut self, marked: &PairTable<bool>) {
        marked.marked().for_each(|pair| self.curves[pair] = None);
    }

    /// The curves, `[output, input]`.
    pub fn curves(&self) -> &PairTable<Option<PolarCurve>> {
        &self.curves
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_response_is_nothing_only_beside_both_its_output_and_its_input() {
        // Of 2 x 2: only the last is small beside both; the third belongs to an output in small units.
        let values = [[1.0, 1.0], [1e-7, 0.99e-13]];
        let curves = PairTable::from_fn(2, 2, |pair| vec![Complex::from(values[pair.output][pair.input]); 3]);
        let mut polar = PolarResponse::of(&FrequencyResponse::from_curves(3, &curves));
        let nothing = polar.numerically_nothing();
        assert_eq!(nothing.marked().collect::<Vec<_>>(), [Pair::new(1, 1)]);
        polar.clear(&nothing);
        assert!(polar.curves()[Pair::new(1, 1)].is_none() && polar.curves()[Pair::new(1, 0)].is_some());
    }

    #[test]
    fn the_only_response_of_an_output_is_never_nothing() {
        let curves = PairTable::from_fn(2, 1, |pair| vec![Complex::from([1.0, 1e-20][pair.output]); 3]);
        let polar = PolarResponse::of(&FrequencyResponse::from_curves(3, &curves));
        assert_eq!(polar.numerically_nothing().marked().count(), 0);
    }

    #[test]
    fn magnitudes_beyond_the_range_of_their_squares_are_right() {
        for (magnitude, db) in [(1e-200, -4000.0), (1e-20, -400.0), (1.0, 0.0), (1e200, 4000.0)] {
            // One rounding of the logarithm and one of its multiple.
            assert!((magnitude_db(&Complex::new(0.0, magnitude)) - db).abs() < 1e-12);
        }
        assert_eq!(magnitude_db(&Complex::new(0.0, 0.0)), f64::NEG_INFINITY);
        assert!(magnitude_db(&Complex::new(f64::NAN, 0.0)).is_nan());
    }
}
