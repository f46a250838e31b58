//! Operations on the values of a curve over frequency: phase unwrapping, and the whole turns that
//! bring one curve closest to another (M2, M3); response and coherence between measured
//! frequencies; order statistics.

use std::f64::consts::{PI, TAU};

use nalgebra::Complex;

use crate::dataset::PairTable;
use crate::dataset::measured_response::MeasuredResponse;
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

/// Adds multiples of 2 pi to each angle \[rad\] except the first, so that no step exceeds pi.
///
/// Sums whole turns instead of steps: each angle is rounded once, however many precede it.
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

/// Computes the phase difference of M3: `angles` (principal values of arg H_a conj H_b) unwrapped,
/// then shifted by the multiple of 2 pi that puts their median in (-pi, pi]. `scratch` is
/// overwritten.
pub fn centred_unwrap(angles: &mut [f64], scratch: &mut Vec<f64>) {
    unwrap(angles);
    if angles.iter().all(|angle| *angle > -PI && *angle <= PI) {
        // Their median lies there too; its computation costs more than everything else.
        return;
    }
    scratch.clear();
    scratch.extend_from_slice(angles);
    let middle = median(scratch);
    let shift = wrap(middle) - middle;
    // Most differences need no shift; adding a rounded zero would only cost accuracy.
    if shift.abs() > PI {
        angles.iter_mut().for_each(|angle| *angle += shift);
    }
}

/// Returns the multiple of 2 pi \[rad\] to add to `phase` so that the median of its difference from
/// `reference` is closest to zero (M2).
///
/// Ignores frequencies at which either curve is not finite; zero where none remain.
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

/// Interpolates the measured response at each `omega` \[rad/s\]: linear on log omega in dB and in
/// unwrapped phase.
///
/// NaN outside the measured frequencies: no extrapolation. Zero next to a measured zero, which has
/// no dB value.
pub fn interpolate(response: &MeasuredResponse, omega: &[f64]) -> PairTable<Vec<Complex<f64>>> {
    let places: Vec<Option<Place>> = omega
        .iter()
        .map(|&omega| Place::of(response.omega(), omega))
        .collect();
    response.values().map(|_, values| {
        let magnitude_db: Vec<f64> = values
            .iter()
            .map(|value| ratio_to_db(value.norm()))
            .collect();
        let mut phase: Vec<f64> = values.iter().map(|value| value.arg()).collect();
        unwrap(&mut phase);
        places
            .iter()
            .map(|place| match place {
                Some(place) => Complex::from_polar(
                    db_to_ratio(place.between_magnitudes_db(&magnitude_db)),
                    place.between(&phase),
                ),
                None => Complex::new(f64::NAN, f64::NAN),
            })
            .collect()
    })
}

/// Interpolates the coherence of each measured response at each `omega` \[rad/s\], linear on log
/// omega (M4a); `None` where there is no coherence.
///
/// NaN outside the measured frequencies.
pub fn coherence_at(response: &MeasuredResponse, omega: &[f64]) -> Option<PairTable<Vec<f64>>> {
    let places: Vec<Option<Place>> = omega
        .iter()
        .map(|&omega| Place::of(response.omega(), omega))
        .collect();
    let at = |place: &Option<Place>, values: &[f64]| {
        place
            .as_ref()
            .map_or(f64::NAN, |place| place.between(values))
    };
    Some(
        response
            .coherence()?
            .map(|_, values| places.iter().map(|place| at(place, values)).collect()),
    )
}

/// Interpolates the values of a curve, given at rising frequencies `known`, at each `omega`
/// \[rad/s\]: linear on log omega, constant beyond the ends. At least one value is required.
pub fn interpolate_values(known: &[f64], values: &[f64], omega: &[f64]) -> Vec<f64> {
    let (Some(&low), Some(&high)) = (known.first(), known.last()) else {
        return vec![f64::NAN; omega.len()];
    };
    let at = |omega: &f64| {
        Place::of(known, omega.clamp(low, high)).map_or(f64::NAN, |place| place.between(values))
    };
    omega.iter().map(at).collect()
}

/// Interpolates `values`, one per rising frequency in `known` \[rad/s\], at another `omega`: linear
/// on log omega; `None` outside the range.
pub fn between(known: &[f64], values: &[f64], omega: f64) -> Option<f64> {
    Place::of(known, omega).map(|place| place.between(values))
}

/// Position of a frequency between two measured ones: at `after`, or `fraction` of the way from its
/// predecessor.
struct Place {
    after: usize,
    fraction: f64,
}

impl Place {
    fn of(measured: &[f64], omega: f64) -> Option<Self> {
        let after = measured.partition_point(|&measured| measured < omega);
        if after == measured.len() {
            None
        } else if measured[after] == omega {
            Some(Self {
                after,
                fraction: 1.0,
            })
        } else if after == 0 {
            None
        } else {
            let low = measured[after - 1];
            let high = measured[after];
            Some(Self {
                after,
                fraction: (omega / low).ln() / (high / low).ln(),
            })
        }
    }

    fn between(&self, values: &[f64]) -> f64 {
        if self.fraction == 1.0 {
            return values[self.after];
        }
        let low = values[self.after - 1];
        let high = values[self.after];
        low + self.fraction * (high - low)
    }

    /// As [`Place::between`] for magnitudes \[dB\], which may be minus infinity for a zero value.
    fn between_magnitudes_db(&self, values: &[f64]) -> f64 {
        let value = self.between(values);
        // The difference of two infinities, or an infinity weighted against a number.
        let is_beside_zero =
            self.fraction < 1.0 && values[self.after - 1..=self.after].contains(&f64::NEG_INFINITY);
        if is_beside_zero {
            f64::NEG_INFINITY
        } else {
            value
        }
    }
}

/// Returns the median: the middle value, or the mean of the middle two for an even count (M6).
///
/// NaN for no values. The values must be finite; their order changes.
pub fn median(values: &mut [f64]) -> f64 {
    let count = values.len();
    if count == 0 {
        return f64::NAN;
    }
    let (below, upper, _) = values.select_nth_unstable_by(count / 2, f64::total_cmp);
    if count % 2 == 1 {
        return *upper;
    }
    let lower = below.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    0.5 * (lower + *upper)
}

/// Returns the weighted median: the smallest value at which the cumulative weight reaches half the
/// total, or the mean of this value and the next where it is exactly half; equals [`median`] for
/// equal weights (M4a).
///
/// NaN for no values. The values must be finite and the weights positive, one per value.
pub fn weighted_median(values: &[f64], weights: &[f64]) -> f64 {
    /// Relative rounding error allowed in sums of thousands of weights.
    const ROUNDING: f64 = 1e-12;
    let mut sorted: Vec<(f64, f64)> = values
        .iter()
        .copied()
        .zip(weights.iter().copied())
        .collect();
    sorted.sort_by(|a, b| a.0.total_cmp(&b.0));
    let whole: f64 = sorted.iter().map(|(_, weight)| weight).sum();
    let mut cumulated = 0.0;
    for (index, &(value, weight)) in sorted.iter().enumerate() {
        cumulated += weight;
        let beyond_half = cumulated - 0.5 * whole;
        if beyond_half.abs() <= ROUNDING * whole {
            return sorted
                .get(index + 1)
                .map_or(value, |(next, _)| 0.5 * (value + next));
        }
        if beyond_half > 0.0 {
            return value;
        }
    }
    f64::NAN
}

/// Returns the arithmetic mean; NaN for no values.
pub fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// Returns the quantile `q` from 0 to 1, linear between order statistics (numpy's default, Hyndman
/// and Fan's type 7) (M7).
///
/// `h = q (n - 1)`, `x = x_[h] + (h - [h]) (x_[h]+1 - x_[h])`. NaN for no values. The values must
/// be finite; their order changes.
pub fn quantile(values: &mut [f64], q: f64) -> f64 {
    if values.is_empty() {
        return f64::NAN;
    }
    let position = q.clamp(0.0, 1.0) * (values.len() - 1) as f64;
    let below = position.floor() as usize;
    let (_, lower, above) = values.select_nth_unstable_by(below, f64::total_cmp);
    let lower = *lower;
    let upper = above.iter().copied().fold(f64::INFINITY, f64::min);
    let fraction = position - below as f64;
    if fraction == 0.0 {
        lower
    } else {
        lower + fraction * (upper - lower)
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn values_between_two_frequencies_are_on_a_line_over_their_logarithm_and_stay_beyond_the_ends()
    {
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
            // A hundred additions of rounded steps of at most pi.
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
    fn a_curve_is_laid_on_its_reference_by_whole_turns() {
        assert_eq!(nearest_turn_offset(&[350.0_f64.to_radians()], &[0.0]), -TAU);
        assert_eq!(nearest_turn_offset(&[f64::NAN], &[0.0]), 0.0);
    }

    proptest! {
        #[test]
        fn wrapping_keeps_the_angle_and_lands_in_the_half_open_turn(angle in -1e3_f64..1e3) {
            let wrapped = wrap(angle);
            prop_assert!(wrapped > -PI && wrapped <= PI);
            // The multiple of 2 pi is exact up to the rounding of angles up to 1e3.
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
    fn between_two_points_decibels_and_phase_are_linear_in_log_frequency() {
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
    fn a_measured_zero_is_zero_beside_it_too() {
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
    fn nothing_is_extrapolated() {
        assert!(at(0.99).re.is_nan() && at(100.1).re.is_nan());
    }

    #[test]
    fn the_median_of_an_even_count_is_the_mean_of_the_middle_two() {
        assert_eq!(median(&mut [4.0, 1.0, 3.0, 2.0]), 2.5);
        assert_eq!(median(&mut [4.0, 1.0, 3.0]), 3.0);
        assert!(median(&mut []).is_nan());
    }

    #[test]
    fn the_weighted_median_is_where_half_of_the_weight_lies() {
        assert_eq!(weighted_median(&[3.0, 1.0, 2.0], &[1.0, 1.0, 3.0]), 2.0);
        assert_eq!(weighted_median(&[3.0, 1.0, 2.0], &[2.0, 1.0, 1.0]), 2.5);
        assert_eq!(weighted_median(&[5.0], &[0.3]), 5.0);
        assert!(weighted_median(&[], &[]).is_nan());
    }

    proptest! {
        #[test]
        fn equal_weights_give_the_median_to_the_last_digit(
            values in prop::collection::vec(-1e3_f64..1e3, 1..300), weight in 0.05_f64..1.0,
        ) {
            let weights = vec![weight; values.len()];
            prop_assert_eq!(weighted_median(&values, &weights), median(&mut values.clone()));
        }
    }

    #[test]
    fn quantiles_interpolate_as_numpy_does() {
        // numpy.quantile([15, 20, 35, 40, 50], 0.4) == 29.0; q = 0.05 gives 16.0.
        let values = [35.0, 20.0, 15.0, 50.0, 40.0];
        assert!((quantile(&mut values.clone(), 0.4) - 29.0).abs() < 1e-12);
        assert!((quantile(&mut values.clone(), 0.05) - 16.0).abs() < 1e-12);
        assert_eq!(quantile(&mut values.clone(), 0.0), 15.0);
        assert_eq!(quantile(&mut values.clone(), 1.0), 50.0);
    }
}
