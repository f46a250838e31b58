//! Phase unwrapping, and the whole turns between two phase curves (M2, M3).

use std::f64::consts::{PI, TAU};

use crate::statistics::median;

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

/// Computes the phase difference as in M3: `angles` (principal values of arg H_a conj H_b) are
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

/// Returns the multiple of 2 pi \[rad\] to be added to `phase` so that its median difference from
/// `reference` is closest to zero (M2).
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

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

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
}
