//! How sure bandwidth and phase delay are (M17.1): to first order, of the standard deviations that a response carries (M14), or of the
//! other models of the bundles (M13).
//!
//! ```text
//! phase crossing:  sd = sd_phase / |d phase / d omega|
//! gain crossing:   sd^2 = (sd_dB(omega_gain)^2 + sd_dB(omega_180)^2 + (m'(omega_180) sd(omega_180))^2) / m'(omega_gain)^2,  m in dB
//! phase delay:     sd = sqrt(sd_phase(omega_180)^2 + sd_phase(2 omega_180)^2) / (2 omega_180)
//! ```
//!
//! Errors at frequencies apart are taken as independent of one another. Those of neighbours are not: a phase delay that is read from the
//! line of least squares has the deviation of the two ends too, for independent errors all along the line would make it as small as there are
//! points.

use super::AttitudeResponse;
use crate::dataset::{ModelBands, Pair};
use crate::response::between;
use crate::uncertainty::{Bar, IdentificationSource, VarianceComponent};

/// Half the step of a difference quotient, relative to the frequency.
const HALF_STEP: f64 = 1e-4;

/// The standard deviations of a response over frequency.
pub trait ResponseDeviation {
    /// Of the magnitude \[dB\] at `omega` \[rad/s\]; none where it is not known.
    fn magnitude_db(&self, omega: f64) -> Option<f64>;

    /// Of the phase \[rad\] at `omega` \[rad/s\]; none where it is not known.
    fn phase(&self, omega: f64) -> Option<f64>;

    /// Of a frequency \[rad/s\] at which the phase crosses a level.
    fn of_phase_crossing(&self, attitude: &AttitudeResponse<'_>, omega: f64) -> Option<f64> {
        let slope = difference_quotient(omega, |omega| attitude.phase_at(omega))?;
        Some(self.phase(omega)? / slope.abs())
    }

    /// Of the frequency \[rad/s\] at which the magnitude is 6 dB above that at `omega_180`.
    fn of_gain_crossing(&self, attitude: &AttitudeResponse<'_>, omega: f64, omega_180: f64) -> Option<f64> {
        let slope = |omega: f64| difference_quotient(omega, |omega| attitude.magnitude_db_at(omega));
        let moved = slope(omega_180)? * self.of_phase_crossing(attitude, omega_180)?;
        let level = self.magnitude_db(omega)?.hypot(self.magnitude_db(omega_180)?).hypot(moved);
        Some(level / slope(omega)?.abs())
    }

    /// Of the phase delay \[s\].
    fn of_phase_delay(&self, omega_180: f64) -> Option<f64> {
        let twice = 2.0 * omega_180;
        Some(self.phase(omega_180)?.hypot(self.phase(twice)?) / twice)
    }
}

/// The band of one response of an identified model, linear in log omega and none outside its frequencies (M14).
#[derive(Clone, Copy, Debug)]
pub struct PairBand<'a> {
    /// The bands of the model.
    pub bands: &'a ModelBands,
    /// The response.
    pub pair: Pair,
}

impl ResponseDeviation for PairBand<'_> {
    fn magnitude_db(&self, omega: f64) -> Option<f64> {
        between(self.bands.omega(), self.bands.sd_db().get(self.pair)?, omega)
    }

    fn phase(&self, omega: f64) -> Option<f64> {
        between(self.bands.omega(), self.bands.sd_deg().get(self.pair)?, omega).map(f64::to_radians)
    }
}

fn difference_quotient(omega: f64, value: impl Fn(f64) -> Option<f64>) -> Option<f64> {
    let (low, high) = (omega * (1.0 - HALF_STEP), omega * (1.0 + HALF_STEP));
    let slope = (value(high)? - value(low)?) / (high - low);
    (slope != 0.0).then_some(slope)
}

/// The bar of a number of the representatives, of what it is with each other physics model and with each other identified model in
/// place of theirs (M13.1, M13.3); none where a swapped pair lacks the number. The number is not negative.
pub fn substitution_bar(value: f64, physics: &[Option<f64>], identified: &[Option<f64>]) -> Bar {
    let part = |others: &[Option<f64>]| {
        let changes: Vec<f64> = others.iter().flatten().map(|other| other - value).collect();
        VarianceComponent::of_changes(&changes)
    };
    Bar {
        value,
        trim: part(physics),
        identification: part(identified),
        source: IdentificationSource::Spread,
        left_out: physics.iter().chain(identified).filter(|other| other.is_none()).count(),
        range: [0.0, f64::INFINITY],
    }
}
