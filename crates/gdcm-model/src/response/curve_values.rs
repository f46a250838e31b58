//! Values of a curve over frequency: phase unwrapping, whole turns between two curves (M2, M3), and
//! interpolation between frequencies.

use std::f64::consts::{PI, TAU};

use nalgebra::Complex;

use crate::dataset::PairTable;
use crate::dataset::measured_response::MeasuredResponse;
use crate::statistics::median;
use crate::units::{db_to_ratio, ratio_to_db};

/// Returns the angle \[rad\] in (-pi, pi] that differs from `angle` by a multiple of 2 pi.
pub fn wrap(angle: f64) -> f64 {
    if angle > -PI && angle <= PI {
        return angle;
    }
    let wrapped = angle - TAU * (angle / TAU).round();
    if wrapped <= -PI {
        wrapped + TAU
    } else if wrapped > PI {
        wrapped - TAU
    } else {
        wrapped
    }
}

/// Unwraps angles \[rad\]: adds multiples of 2 pi to all but the first, so that no step exceeds pi.
///
/// Sums whole turns instead of steps, so that each angle is rounded only once, however many precede
/// it.
pub fn unwrap(angles: &mut [f64]) {
    let Some(&first) = angles.first() else {
        return;
    };
    let mut before = first;
    let mut turns = 0.0;
    for angle in angles {
        let step = *angle - before;
        before = *angle;
        if !(step > -PI && step <= PI) {
            turns += ((wrap(step) - step) / TAU).round();
        }
        if turns != 0.0 {
            *angle += turns * TAU;
        }
    }
}

/// Computes the phase difference of M3: `angles` (principal values of arg H_a conj H_b) are
/// unwrapped, then shifted by the multiple of 2 pi that moves their median into (-pi, pi].
/// `scratch` is overwritten.
pub fn centred_unwrap(angles: &mut [f64], scratch: &mut Vec<f64>) {
    unwrap(angles);
    if angles.iter().all(|angle| *angle > -PI && *angle <= PI) {
        // No shift is needed: the median also lies in (-pi, pi]. Its computation would take longer
        // than all other steps.
        return;
    }
    scratch.clear();
    scratch.extend_from_slice(angles);
    let middle = median(scratch);
    let shift = wrap(middle) - middle;
    // `shift.abs() > PI`: skip a shift that is zero apart from rounding.
    if shift.abs() > PI {
        for angle in angles {
            *angle += shift;
        }
    }
}

/// Returns the multiple of 2 pi \[rad\] to be added to `phase` so that the median of its difference
/// from `reference` is closest to zero (M2).
///
/// Frequencies at which either curve is not finite are ignored; returns zero if none remain.
pub fn nearest_turn_offset(phase: &[f64], reference: &[f64]) -> f64 {
    let differences = phase
        .iter()
        .zip(reference)
        .map(|(phase, reference)| reference - phase);
    let mut differences: Vec<f64> = differences
        .filter(|difference| difference.is_finite())
        .collect();
    if differences.is_empty() {
        0.0
    } else {
        TAU * (median(&mut differences) / TAU).round()
    }
}

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

/// Interpolates the coherence of each response at each `omega` \[rad/s\], linear on log omega
/// (M4a); NaN outside the measured frequencies. Returns `None` if the file gives no coherence.
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
    /// Share of the way from `after - 1` to `after` on log omega, above 0 and up to 1; 1 if the
    /// frequency equals entry `after`.
    fraction: f64,
}

impl Place {
    /// Finds `omega` in a list of rising frequencies; `None` outside their range.
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

    /// Interpolates magnitudes \[dB\]; minus infinity next to a value of minus infinity, for which
    /// [`Place::value`] may be NaN.
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
    use proptest::prelude::*;

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

    #[test]
    fn half_a_turn_is_kept_positive() {
        assert_eq!(wrap(PI), PI);
        assert_eq!(wrap(-PI), PI);
    }

    #[test]
    fn a_delay_unwraps_into_a_straight_line() {
        let mut angles: Vec<f64> = (0..100).map(|k| wrap(-0.3 * f64::from(k))).collect();
        unwrap(&mut angles);
        for (k, angle) in angles.iter().enumerate() {
            // Tolerance: a hundred additions of rounded steps of at most pi.
            assert!((angle + 0.3 * k as f64).abs() < 1e-12);
        }
    }

    #[test]
    fn the_median_of_a_centred_difference_lies_within_half_a_turn() {
        let mut angles = vec![3.0, -3.0, -2.9, -2.8, -2.7];
        centred_unwrap(&mut angles, &mut Vec::new());
        assert!((angles[2] - (-2.9)).abs() < 1e-15 && (angles[0] - (3.0 - TAU)).abs() < 1e-15);
    }

    #[test]
    fn a_curve_is_shifted_to_its_reference_by_whole_turns() {
        assert_eq!(nearest_turn_offset(&[350.0_f64.to_radians()], &[0.0]), -TAU);
        assert_eq!(nearest_turn_offset(&[f64::NAN], &[0.0]), 0.0);
    }

    proptest! {
        #[test]
        fn wrapping_keeps_the_angle_and_lands_in_the_half_open_turn(angle in -1e3_f64..1e3) {
            let wrapped = wrap(angle);
            prop_assert!(wrapped > -PI && wrapped <= PI);
            // Tolerance: the multiple of 2 pi is exact up to the rounding of angles up to 1e3.
            prop_assert!(((angle - wrapped) / TAU - ((angle - wrapped) / TAU).round()).abs() < 1e-12);
        }

        #[test]
        fn unwrapping_leaves_no_step_over_half_a_turn(angles in prop::collection::vec(-PI..PI, 2..40)) {
            let mut unwrapped = angles.clone();
            unwrap(&mut unwrapped);
            for pair in unwrapped.windows(2) {
                prop_assert!((pair[1] - pair[0]).abs() <= PI + 1e-12);
            }
        }
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
