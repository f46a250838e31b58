//! Interpolates curves between frequencies, linear on log omega.
//!
//! | function | beyond the ends |
//! |---|---|
//! | [`interpolate`], measured responses | NaN |
//! | [`coherence_at`] | NaN |
//! | [`interpolate_values`] | the end value |
//! | [`between`] | `None` |

use nalgebra::Complex;

use super::phase_unwrapping::unwrap;
use crate::dataset::PairTable;
use crate::dataset::measured_response::MeasuredResponse;
use crate::units::{db_to_ratio, ratio_to_db};

/// Interpolates the measured response at each `omega` \[rad/s\]: linear on log omega, in dB and in
/// unwrapped phase.
///
/// Returns NaN outside the measured frequencies, since nothing is extrapolated. Returns zero next
/// to a measured zero, whose magnitude in dB is minus infinity.
pub fn interpolate(response: &MeasuredResponse, omega: &[f64]) -> PairTable<Vec<Complex<f64>>> {
    let places = places(response.omega(), omega);
    response
        .values()
        .map(|_, values| interpolate_curve(values, &places))
}

/// Interpolates a curve at each place; NaN for a frequency outside the curve.
fn interpolate_curve(values: &[Complex<f64>], places: &[Option<Place>]) -> Vec<Complex<f64>> {
    let magnitude_db: Vec<f64> = values
        .iter()
        .map(|value| ratio_to_db(value.norm()))
        .collect();
    let mut phase: Vec<f64> = values.iter().map(|value| value.arg()).collect();
    unwrap(&mut phase);
    let mut interpolated = Vec::with_capacity(places.len());
    for place in places {
        interpolated.push(match place {
            Some(place) => Complex::from_polar(
                db_to_ratio(place.magnitude_db(&magnitude_db)),
                place.value(&phase),
            ),
            None => Complex::new(f64::NAN, f64::NAN),
        });
    }
    interpolated
}

/// Interpolates each response's coherence at each `omega` \[rad/s\], linear on log omega (M4a); NaN
/// outside the measured frequencies. Returns `None` if the file gives no coherence.
pub fn coherence_at(response: &MeasuredResponse, omega: &[f64]) -> Option<PairTable<Vec<f64>>> {
    let coherence = response.coherence()?;
    let places = places(response.omega(), omega);
    Some(coherence.map(|_, values| {
        places
            .iter()
            .map(|place| value_or_nan(place.as_ref(), values))
            .collect()
    }))
}

/// Interpolates `values`, given at rising frequencies `known`, at each `omega` \[rad/s\]: linear on
/// log omega, constant beyond the ends; NaN if there are no values.
pub fn interpolate_values(known: &[f64], values: &[f64], omega: &[f64]) -> Vec<f64> {
    let (Some(&lowest), Some(&highest)) = (known.first(), known.last()) else {
        return vec![f64::NAN; omega.len()];
    };
    omega
        .iter()
        .map(|omega| {
            let place = Place::find(known, omega.clamp(lowest, highest));
            value_or_nan(place.as_ref(), values)
        })
        .collect()
}

/// Interpolates `values`, given at rising frequencies `known` \[rad/s\], at `omega`: linear on log
/// omega; `None` outside their range.
pub fn between(known: &[f64], values: &[f64], omega: f64) -> Option<f64> {
    Place::find(known, omega).map(|place| place.value(values))
}

/// Position of a frequency in a list: between the entries `after - 1` and `after`.
struct Place {
    after: usize,
    /// Share of the distance from `after - 1` to `after` on log omega, above 0 and up to 1; 1 if
    /// the frequency equals entry `after`.
    fraction: f64,
}

impl Place {
    /// Finds `omega` in a rising frequency list; `None` outside its range.
    fn find(known: &[f64], omega: f64) -> Option<Self> {
        let after = known.partition_point(|&known| known < omega);
        if after == known.len() {
            return None;
        }
        if known[after] == omega {
            return Some(Self {
                after,
                fraction: 1.0,
            });
        }
        if after == 0 {
            return None;
        }
        let low = known[after - 1];
        let high = known[after];
        Some(Self {
            after,
            fraction: (omega / low).ln() / (high / low).ln(),
        })
    }

    fn value(&self, values: &[f64]) -> f64 {
        if self.fraction == 1.0 {
            return values[self.after];
        }
        let low = values[self.after - 1];
        let high = values[self.after];
        low + self.fraction * (high - low)
    }

    /// Interpolates magnitudes \[dB\]; minus infinity next to a value that is minus infinity, for
    /// which [`Place::value`] may be NaN.
    fn magnitude_db(&self, values: &[f64]) -> f64 {
        let is_beside_zero =
            self.fraction < 1.0 && values[self.after - 1..=self.after].contains(&f64::NEG_INFINITY);
        if is_beside_zero {
            f64::NEG_INFINITY
        } else {
            self.value(values)
        }
    }
}

fn places(known: &[f64], omega: &[f64]) -> Vec<Option<Place>> {
    omega
        .iter()
        .map(|omega| Place::find(known, *omega))
        .collect()
}

fn value_or_nan(place: Option<&Place>, values: &[f64]) -> f64 {
    match place {
        Some(place) => place.value(values),
        None => f64::NAN,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_linear_over_log_frequency_and_constant_beyond_the_ends() {
        let found = interpolate_values(&[1.0, 4.0], &[10.0, 20.0], &[0.5, 1.0, 2.0, 4.0, 9.0]);
        let miss = found
            .iter()
            .zip([10.0, 10.0, 15.0, 20.0, 20.0])
            .map(|(found, expected)| (found - expected).abs());
        assert!(miss.fold(0.0, f64::max) < 1e-14, "{found:?}");
        assert!(interpolate_values(&[], &[], &[1.0])[0].is_nan());
    }

    fn measured() -> MeasuredResponse {
        let table = |values: &[f64]| PairTable::filled(1, 1, values.to_vec());
        MeasuredResponse::new(
            vec![1.0, 100.0],
            &table(&[1.0, 0.0]),
            &table(&[0.0, -0.01]),
            None,
        )
        .unwrap()
    }

    fn at(omega: f64) -> Complex<f64> {
        interpolate(&measured(), &[omega]).iter().next().unwrap().1[0]
    }

    #[test]
    fn decibels_and_phase_are_linear_in_log_frequency() {
        // From 0 dB, 0 deg at 1 rad/s to -40 dB, -90 deg at 100 rad/s: -20 dB, -45 deg at 10 rad/s.
        let value = at(10.0);
        assert!(
            (value.norm() - 0.1).abs() < 1e-15
                && (value.arg() + std::f64::consts::FRAC_PI_4).abs() < 1e-14
        );
    }

    #[test]
    fn the_measured_points_themselves_are_returned() {
        assert!((at(1.0) - Complex::new(1.0, 0.0)).norm() < 1e-15);
        assert!((at(100.0) - Complex::new(0.0, -0.01)).norm() < 1e-16);
    }

    #[test]
    fn coherence_is_linear_in_log_frequency() {
        let table = |values: &[f64]| PairTable::filled(1, 1, values.to_vec());
        let with = MeasuredResponse::new(
            vec![1.0, 100.0],
            &table(&[1.0; 2]),
            &table(&[0.0; 2]),
            Some(table(&[0.4, 1.0])),
        );
        let found = coherence_at(&with.unwrap(), &[0.5, 1.0, 10.0, 100.0]).unwrap();
        let found = found.iter().next().unwrap().1;
        assert!(
            found[0].is_nan()
                && found[1] == 0.4
                && (found[2] - 0.7).abs() < 1e-15
                && found[3] == 1.0
        );
        assert_eq!(coherence_at(&measured(), &[10.0]), None);
    }

    #[test]
    fn values_beside_a_measured_zero_are_zero() {
        let table = |values: [f64; 4]| PairTable::filled(1, 1, values.to_vec());
        let re = table([2.0, 0.0, 0.0, 2.0]);
        let im = table([0.0; 4]);
        let response = MeasuredResponse::new(vec![1.0, 2.0, 3.0, 4.0], &re, &im, None).unwrap();
        let found = interpolate(&response, &[1.0, 1.5, 2.0, 2.5, 3.5, 4.0]);
        let magnitudes: Vec<f64> = found[crate::dataset::Pair::new(0, 0)]
            .iter()
            .map(|value| value.norm())
            .collect();
        assert_eq!(magnitudes[1..5], [0.0; 4]);
        assert!((magnitudes[0] - 2.0).abs() < 1e-15 && (magnitudes[5] - 2.0).abs() < 1e-15);
    }

    #[test]
    fn values_outside_the_measured_frequencies_are_nan() {
        assert!(at(0.99).re.is_nan() && at(100.1).re.is_nan());
    }
}
