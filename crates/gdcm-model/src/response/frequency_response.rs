//! Frequency responses: frequency grid, complex values, magnitude and phase, and curves for plots.

use std::sync::Arc;

use nalgebra::Complex;

use super::curve_values::{nearest_turn_offset, unwrap, wrap};
use super::lead_filter::GainDelay;
use crate::dataset::{Band, Pair, PairTable};
use crate::units::ratio_to_db;

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

/// Magnitude and unwrapped phase of a response, for plots (M2).
#[derive(Clone, Debug, PartialEq)]
pub struct ResponseShape {
    /// Magnitude \[dB\] at each frequency; NaN where the value is zero or not finite.
    pub magnitude_db: Arc<[f64]>,
    /// Phase \[deg\] at each frequency; NaN where the value is zero or not finite.
    pub phase_deg: Arc<[f64]>,
}

impl ResponseShape {
    /// Computes magnitude and phase; NaN where a value is zero or not finite. The phase is
    /// principal at the first other value, then unwrapped (M2).
    pub fn new(values: &[Complex<f64>]) -> Self {
        let finite: Vec<usize> = (0..values.len())
            .filter(|&k| values[k].is_finite() && values[k].norm() > 0.0)
            .collect();
        let mut phase: Vec<f64> = finite.iter().map(|&k| values[k].arg()).collect();
        unwrap(&mut phase);
        let mut magnitude_db = vec![f64::NAN; values.len()];
        let mut phase_deg = vec![f64::NAN; values.len()];
        for (&k, phase) in finite.iter().zip(phase) {
            magnitude_db[k] = ratio_to_db(values[k].norm());
            phase_deg[k] = phase.to_degrees();
        }
        Self {
            magnitude_db: magnitude_db.into(),
            phase_deg: phase_deg.into(),
        }
    }

    /// Returns the shape with its phase shifted by whole turns, as close as possible to `reference`
    /// over the first `points` frequencies (M2).
    pub fn phase_aligned(self, reference: &Self, points: usize) -> Self {
        let own = radians(self.phase_deg.iter().take(points));
        let other = radians(reference.phase_deg.iter().take(points));
        let offset = nearest_turn_offset(&own, &other).to_degrees();
        if offset == 0.0 {
            return self;
        }
        Self {
            phase_deg: self.phase_deg.iter().map(|phase| phase + offset).collect(),
            ..self
        }
    }

    /// Returns the shape over the first `points` frequencies; NaN at the other frequencies.
    pub fn first(self, points: usize) -> Self {
        if points >= self.phase_deg.len() {
            return self;
        }
        Self {
            magnitude_db: first_values(&self.magnitude_db, points),
            phase_deg: first_values(&self.phase_deg, points),
        }
    }

    /// Returns the shape after a correction of gain and delay (M10).
    pub fn corrected(&self, omega: &[f64], correction: GainDelay) -> Self {
        let phase = radians(self.phase_deg.iter());
        Self {
            magnitude_db: correction
                .magnitudes_db(&self.magnitude_db, omega)
                .collect(),
            phase_deg: correction
                .phases(&phase, omega)
                .map(f64::to_degrees)
                .collect(),
        }
    }
}

fn radians<'v>(degrees: impl Iterator<Item = &'v f64>) -> Vec<f64> {
    degrees.map(|degrees| degrees.to_radians()).collect()
}

/// Returns the values with all but the first `points` replaced by NaN.
fn first_values(values: &[f64], points: usize) -> Arc<[f64]> {
    let mut first = values.to_vec();
    first[points..].fill(f64::NAN);
    first.into()
}

/// Wraps a continuous phase \[deg\] to -180 to 180 degrees. A plot shows a gap at each jump, not a
/// line from edge to edge, because one value there is NaN.
pub fn wrapped_deg(phase_deg: &[f64]) -> Vec<f64> {
    let wrapped: Vec<f64> = phase_deg
        .iter()
        .map(|phase| wrap(phase.to_radians()).to_degrees())
        .collect();
    let mut with_gaps = wrapped.clone();
    for k in 1..wrapped.len() {
        if (wrapped[k] - wrapped[k - 1]).abs() > 180.0 {
            with_gaps[k] = f64::NAN;
        }
    }
    with_gaps
}

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

/// Magnitude and phase of every response of a model.
///
/// An entry is `None` for a response that is zero or not finite at some frequency (structural zero,
/// pole on the imaginary axis, measured data with too short a range): it has no G, D or J (M6).
#[derive(Clone, Debug, PartialEq)]
pub struct PolarResponse {
    curves: PairTable<Option<PolarCurve>>,
}

impl PolarResponse {
    /// Computes magnitude and phase of every response.
    pub fn new(response: &FrequencyResponse) -> Self {
        Self {
            curves: response
                .curves
                .map(|_, curve| PolarCurve::from_values(curve)),
        }
    }

    /// Computes magnitude and phase of the marked responses only: a logarithm and an arc tangent
    /// take longer than the response itself.
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
    /// largest peak for the same input. Numerical differentiation produces such values instead of
    /// exact zeros.
    pub fn numerically_zero(&self) -> PairTable<bool> {
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

    /// Removes the curves of the marked responses.
    pub fn clear(&mut self, marked: &PairTable<bool>) {
        for pair in marked.marked() {
            self.curves[pair] = None;
        }
    }

    /// Returns the curves, `[output, input]`; `None` for an undefined response.
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

    #[test]
    fn the_phase_is_continuous_across_a_gap() {
        let turned = |degrees: f64| Complex::from_polar(10.0, degrees.to_radians());
        let shape = ResponseShape::new(&[turned(-170.0), Complex::new(0.0, 0.0), turned(170.0)]);
        assert!(shape.magnitude_db[1].is_nan() && shape.phase_deg[1].is_nan());
        // Tolerance: a few roundings of angles of about 3 rad.
        assert!(
            (shape.magnitude_db[2] - 20.0).abs() < 1e-12
                && (shape.phase_deg[2] + 190.0).abs() < 1e-12
        );
    }

    #[test]
    fn a_shape_is_shifted_by_whole_turns_only() {
        let shape = |phase: f64| ResponseShape {
            magnitude_db: [0.0, 0.0].into(),
            phase_deg: [phase, phase].into(),
        };
        let laid = shape(350.0).phase_aligned(&shape(-20.0), usize::MAX);
        assert!((laid.phase_deg[0] + 10.0).abs() < 1e-12);
    }

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
