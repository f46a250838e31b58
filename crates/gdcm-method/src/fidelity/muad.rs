//! Envelopes for maximum unnoticeable added dynamics (MUAD; MIL-STD-1797A, appendix A, 4.2.1.2).
//!
//! Pilots do not notice dynamics added to an aircraft's response while the added factor's magnitude
//! and phase stay inside
//!
//! ```text
//! upper magnitude  (3.16 s^2 + 31.61 s + 22.79) / (s^2 + 27.14 s + 1.84)
//! lower magnitude  (0.0955 s^2 + 9.92 s + 2.15) / (s^2 + 11.6 s + 4.96)
//! upper phase      (68.89 s^2 + 1100.12 s - 275.22) / (s^2 + 39.94 s + 9.99) e^(0.0059 s)
//! lower phase      (475.32 s^2 + 184100 s + 29456.1) / (s^2 + 11.66 s + 0.0389) e^(-0.0072 s)
//! ```
//!
//! Wood & Hodgkinson, "Definition of acceptable levels of mismatch for equivalent systems of
//! augmented CTOL aircraft", MDC A6792, 1980. Some codes omit the delays or round the coefficients
//! (0.095, 4.95, 29460, 0.039): the rounding changes less than 0.02 dB and 0.005 deg, the omission
//! changes the phase by up to 4 deg at 10 rad/s.

use nalgebra::Complex;

use gdcm_model::units::ratio_to_db;

/// A quotient of two quadratic polynomials in `s`, highest power first, times `e^(-s delay_s)`.
struct Factor {
    numerator: [f64; 3],
    denominator: [f64; 3],
    delay_s: f64,
}

const UPPER_MAGNITUDE: Factor = Factor {
    numerator: [3.16, 31.61, 22.79],
    denominator: [1.0, 27.14, 1.84],
    delay_s: 0.0,
};
const LOWER_MAGNITUDE: Factor = Factor {
    numerator: [0.0955, 9.92, 2.15],
    denominator: [1.0, 11.6, 4.96],
    delay_s: 0.0,
};
const UPPER_PHASE: Factor = Factor {
    numerator: [68.89, 1100.12, -275.22],
    denominator: [1.0, 39.94, 9.99],
    delay_s: -0.0059,
};
const LOWER_PHASE: Factor = Factor {
    numerator: [475.32, 184_100.0, 29_456.1],
    denominator: [1.0, 11.66, 0.0389],
    delay_s: 0.0072,
};

impl Factor {
    fn ratio(&self, omega: f64) -> Complex<f64> {
        polynomial(self.numerator, omega) / polynomial(self.denominator, omega)
    }

    fn magnitude_db(&self, omega: f64) -> f64 {
        ratio_to_db(self.ratio(omega).norm())
    }

    /// Returns the phase \[deg\]. The delay contributes a few degrees, the ratio less than half a
    /// turn: the principal value is the phase.
    fn phase_deg(&self, omega: f64) -> f64 {
        (self.ratio(omega).arg() - omega * self.delay_s).to_degrees()
    }
}

/// Evaluates a quadratic polynomial, highest power first, at `s = j omega`.
fn polynomial(coefficients: [f64; 3], omega: f64) -> Complex<f64> {
    let s = Complex::new(0.0, omega);
    let [second, first, constant] = coefficients;
    (s * second + first) * s + constant
}

/// The envelopes at one frequency.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Muad {
    /// Lower and upper limit for the added dynamics' magnitude \[dB\].
    pub magnitude_db: [f64; 2],
    /// Lower and upper limit for the added dynamics' phase \[deg\].
    pub phase_deg: [f64; 2],
}

impl Muad {
    /// Evaluates the envelopes at `omega` \[rad/s\], greater than zero. The underlying trials cover
    /// 0.1 to about 10 rad/s.
    pub fn at(omega: f64) -> Self {
        Self {
            magnitude_db: [
                LOWER_MAGNITUDE.magnitude_db(omega),
                UPPER_MAGNITUDE.magnitude_db(omega),
            ],
            phase_deg: [LOWER_PHASE.phase_deg(omega), UPPER_PHASE.phase_deg(omega)],
        }
    }

    /// Returns the distances from an error to the nearer magnitude limit \[dB\] and the nearer
    /// phase limit \[deg\], positive outside, negative inside.
    fn distances_outside(&self, error_db: f64, error_deg: f64) -> [f64; 2] {
        [
            distance_outside(self.magnitude_db, error_db),
            distance_outside(self.phase_deg, error_deg),
        ]
    }
}

/// Returns the distance from an error to the envelope's nearer limit, positive outside.
fn distance_outside(envelope: [f64; 2], error: f64) -> f64 {
    let [least, most] = envelope;
    (least - error).max(error - most)
}

/// Returns the `omega` ranges \[rad/s\], start and end, in which a mismatch, model over reference,
/// is outside an envelope: ascending and disjoint.
///
/// The errors \[dB\] and \[deg\] are given at the ascending frequencies `omega`; the phase error is
/// the value nearest to zero, without whole turns. Between two frequencies the distance from the
/// envelope is interpolated linearly in `ln omega`.
pub fn ranges_outside(omega: &[f64], error_db: &[f64], error_deg: &[f64]) -> Vec<(f64, f64)> {
    let mut outside_db = Vec::with_capacity(omega.len());
    let mut outside_deg = Vec::with_capacity(omega.len());
    for ((&omega, &error_db), &error_deg) in omega.iter().zip(error_db).zip(error_deg) {
        let [magnitude, phase] = Muad::at(omega).distances_outside(error_db, error_deg);
        outside_db.push(magnitude);
        outside_deg.push(phase);
    }
    let mut ranges = ranges_above_zero(omega, &outside_db);
    ranges.extend(ranges_above_zero(omega, &outside_deg));
    merge_overlapping(ranges)
}

/// Sorts ranges, and merges those that overlap or meet.
fn merge_overlapping(mut ranges: Vec<(f64, f64)>) -> Vec<(f64, f64)> {
    ranges.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut merged: Vec<(f64, f64)> = Vec::new();
    for (start, end) in ranges {
        match merged.last_mut() {
            Some((_, last_end)) if start <= *last_end => *last_end = last_end.max(end),
            _ => merged.push((start, end)),
        }
    }
    merged
}

/// Returns the `omega` ranges in which values at these frequencies are positive, interpolated
/// linearly in `ln omega`.
fn ranges_above_zero(omega: &[f64], values: &[f64]) -> Vec<(f64, f64)> {
    let mut ranges = Vec::new();
    let mut range_start = None;
    for k in 0..values.len() {
        let is_above = values[k] > 0.0;
        match range_start {
            None if is_above && k == 0 => range_start = Some(omega[0]),
            None if is_above => range_start = Some(zero_crossing(omega, values, k)),
            Some(start) if !is_above => {
                ranges.push((start, zero_crossing(omega, values, k)));
                range_start = None;
            }
            _ => {}
        }
    }
    if let (Some(start), Some(&end)) = (range_start, omega.last()) {
        ranges.push((start, end));
    }
    ranges
}

/// Returns the frequency between points `k - 1` and `k` at which the values cross zero.
fn zero_crossing(omega: &[f64], values: &[f64], k: usize) -> f64 {
    let share = values[k - 1] / (values[k - 1] - values[k]);
    omega[k - 1] * (omega[k] / omega[k - 1]).powf(share)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_error_that_stays_inside_leaves_nowhere() {
        let omega: Vec<f64> = (1..=100).map(|k| 0.1 * f64::from(k)).collect();
        assert_eq!(ranges_outside(&omega, &[0.0; 100], &[0.0; 100]), []);
    }

    #[test]
    fn a_constant_error_leaves_where_the_envelope_is_narrower() {
        // 2 dB: the upper magnitude is 2.74 dB at 1 rad/s, 1.31 at 3 and 2.39 at 7.
        let omega: Vec<f64> = (0..=200)
            .map(|k| 10.0_f64.powf(-1.0 + 0.01 * f64::from(k)))
            .collect();
        let ranges = ranges_outside(&omega, &[2.0; 201], &[0.0; 201]);
        assert_eq!(ranges.len(), 1);
        for end in [ranges[0].0, ranges[0].1] {
            // Between two frequencies the envelope deviates from a straight line by about 1e-4 dB.
            assert!(
                (Muad::at(end).magnitude_db[1] - 2.0).abs() < 1e-3,
                "{ranges:?}"
            );
        }
        assert!((1.0..3.0).contains(&ranges[0].0) && (3.0..7.0).contains(&ranges[0].1));
    }

    #[test]
    fn ranges_of_magnitude_and_phase_are_merged_where_they_meet() {
        let omega = [1.0, 2.0, 3.0, 4.0, 5.0];
        let ranges = ranges_outside(
            &omega,
            &[9.0, 9.0, 0.0, 0.0, 0.0],
            &[0.0, 0.0, -90.0, -90.0, 0.0],
        );
        assert_eq!(ranges.len(), 1, "{ranges:?}");
        assert_eq!(ranges[0].0, 1.0);
        assert!((4.0..5.0).contains(&ranges[0].1));
        let to_the_end = ranges_outside(&omega, &[0.0; 5], &[0.0, 0.0, 0.0, 0.0, 60.0]);
        assert_eq!(to_the_end.len(), 1);
        assert_eq!(to_the_end[0].1, 5.0);
    }
}
