//! Measured frequency data between its frequencies.

use nalgebra::Complex;

use crate::dataset::{MeasuredResponse, PairTable};
use crate::units::{db_to_ratio, ratio_to_db};

use super::phase::unwrap;

/// The measured response at each `omega` \[rad/s\]: linear on log omega in dB and in unwrapped phase.
///
/// Not a number outside the measured frequencies: nothing is extrapolated.
pub fn interpolate(response: &MeasuredResponse, omega: &[f64]) -> PairTable<Vec<Complex<f64>>> {
    let places: Vec<Option<Place>> = omega.iter().map(|&omega| Place::of(response.omega(), omega)).collect();
    response.values().map(|_, values| {
        let magnitude_db: Vec<f64> = values.iter().map(|value| ratio_to_db(value.norm())).collect();
        let mut phase: Vec<f64> = values.iter().map(|value| value.arg()).collect();
        unwrap(&mut phase);
        places
            .iter()
            .map(|place| match place {
                Some(place) => Complex::from_polar(db_to_ratio(place.between(&magnitude_db)), place.between(&phase)),
                None => Complex::new(f64::NAN, f64::NAN),
            })
            .collect()
    })
}

/// The coherence of each measured response at each `omega` \[rad/s\], linear on log omega (M4a); none where it is not given.
///
/// Not a number outside the measured frequencies.
pub fn coherence_at(response: &MeasuredResponse, omega: &[f64]) -> Option<PairTable<Vec<f64>>> {
    let places: Vec<Option<Place>> = omega.iter().map(|&omega| Place::of(response.omega(), omega)).collect();
    let at = |place: &Option<Place>, values: &[f64]| place.as_ref().map_or(f64::NAN, |place| place.between(values));
    Some(response.coherence()?.map(|_, values| places.iter().map(|place| at(place, values)).collect()))
}

/// Where a frequency lies between two measured ones: on `after`, or `fraction` of the way from the one before it.
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
            Some(Self { after, fraction: 1.0 })
        } else if after == 0 {
            None
        } else {
            let (low, high) = (measured[after - 1], measured[after]);
            Some(Self { after, fraction: (omega / low).ln() / (high / low).ln() })
        }
    }

    fn between(&self, values: &[f64]) -> f64 {
        if self.fraction == 1.0 {
            return values[self.after];
        }
        let (low, high) = (values[self.after - 1], values[self.after]);
        low + self.fraction * (high - low)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn measured() -> MeasuredResponse {
        let table = |values: &[f64]| PairTable::filled(1, 1, values.to_vec());
        MeasuredResponse::new(vec![1.0, 100.0], &table(&[1.0, 0.0]), &table(&[0.0, -0.01]), None).unwrap()
    }

    fn at(omega: f64) -> Complex<f64> {
        interpolate(&measured(), &[omega]).iter().next().unwrap().1[0]
    }

    #[test]
    fn between_two_points_decibels_and_phase_are_linear_in_log_frequency() {
        // From 0 dB, 0 deg at 1 rad/s to -40 dB, -90 deg at 100 rad/s: -20 dB, -45 deg at 10 rad/s.
        let value = at(10.0);
        assert!((value.norm() - 0.1).abs() < 1e-15 && (value.arg() + std::f64::consts::FRAC_PI_4).abs() < 1e-14);
    }

    #[test]
    fn the_measured_points_themselves_are_returned() {
        assert!((at(1.0) - Complex::new(1.0, 0.0)).norm() < 1e-15);
        assert!((at(100.0) - Complex::new(0.0, -0.01)).norm() < 1e-16);
    }

    #[test]
    fn coherence_is_linear_in_log_frequency() {
        let table = |values: &[f64]| PairTable::filled(1, 1, values.to_vec());
        let with =
            MeasuredResponse::new(vec![1.0, 100.0], &table(&[1.0; 2]), &table(&[0.0; 2]), Some(table(&[0.4, 1.0])));
        let found = coherence_at(&with.unwrap(), &[0.5, 1.0, 10.0, 100.0]).unwrap();
        let found = found.iter().next().unwrap().1;
        assert!(found[0].is_nan() && found[1] == 0.4 && (found[2] - 0.7).abs() < 1e-15 && found[3] == 1.0);
        assert_eq!(coherence_at(&measured(), &[10.0]), None);
    }

    #[test]
    fn nothing_is_extrapolated() {
        assert!(at(0.99).re.is_nan() && at(100.1).re.is_nan());
    }
}
