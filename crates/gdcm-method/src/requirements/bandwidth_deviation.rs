//! Standard deviations of bandwidth and phase delay (M17.1), to first order from the identified
//! response's standard deviations (M14).
//!
//! ```text
//! phase crossing:  sd = sd_phase(omega) / |phase'(omega)|
//! gain crossing:   sd^2 = (sd_dB(omega_gain)^2 + sd_dB(omega_180)^2
//!                          + (m'(omega_180) sd(omega_180))^2) / m'(omega_gain)^2
//! phase delay:     sd = sqrt(sd_phase(omega_180)^2 + sd_phase(2 omega_180)^2) / (2 omega_180)
//! ```
//!
//! `m` is the magnitude \[dB\]; primes mark derivatives with respect to omega; `sd_dB` and
//! `sd_phase` are standard deviations of the response's magnitude and phase, `sd(omega_180)` that
//! of the phase crossing. `omega_180` is the frequency at which the phase `Phi` is -180 deg,
//! `omega_gain` the one at which the magnitude is 6 dB above that at `omega_180` (`bandwidth`).
//!
//! The phase delay follows its formula `-(Phi(2 omega_180) + pi) / (2 omega_180)`, with `omega_180`
//! shifted by the phase error at `omega_180`: exact to first order if the phase is linear between
//! `omega_180` and `2 omega_180`.
//!
//! Magnitude and phase errors, and errors at distant frequencies, are assumed independent. Errors
//! at neighbouring frequencies are not: the deviation for a phase delay read from the least-squares
//! line is also computed from the two ends, because independent errors along the line would make it
//! arbitrarily small with more points.

use gdcm_model::dataset::Pair;
use gdcm_model::dataset::model::ModelBands;
use gdcm_model::response::interpolation::between;

use super::attitude_response::AttitudeResponse;

/// Half the distance between the two points in a difference quotient, relative to the frequency. A
/// compromise: a larger step adds curvature to the quotient, a smaller one rounding errors.
const HALF_STEP: f64 = 1e-4;

/// An identified response's standard deviations over frequency, linear in log omega and undefined
/// outside their frequencies (M14).
#[derive(Clone, Copy, Debug)]
pub struct PairUncertainty<'a> {
    pub bands: &'a ModelBands,
    pub pair: Pair,
}

impl PairUncertainty<'_> {
    /// Returns the magnitude's standard deviation \[dB\] at `omega` \[rad/s\].
    fn sd_db(&self, omega: f64) -> Option<f64> {
        between(
            self.bands.omega(),
            self.bands.sd_db().get(self.pair)?,
            omega,
        )
    }

    /// Returns the phase's standard deviation \[rad\] at `omega` \[rad/s\].
    fn sd_phase(&self, omega: f64) -> Option<f64> {
        between(
            self.bands.omega(),
            self.bands.sd_deg().get(self.pair)?,
            omega,
        )
        .map(f64::to_radians)
    }

    /// Returns the standard deviation \[rad/s\] for the frequency at which the phase crosses a
    /// level.
    pub(super) fn phase_crossing_sd(
        &self,
        attitude: &AttitudeResponse<'_>,
        omega: f64,
    ) -> Option<f64> {
        let slope = phase_slope(attitude, omega)?;
        Some(self.sd_phase(omega)? / slope.abs())
    }

    /// Returns the standard deviation \[rad/s\] for the frequency `omega_gain` at which the
    /// magnitude exceeds its value at `omega_180` by 6 dB.
    pub(super) fn gain_crossing_sd(
        &self,
        attitude: &AttitudeResponse<'_>,
        omega_gain: f64,
        omega_180: f64,
    ) -> Option<f64> {
        let from_omega_180 =
            magnitude_slope(attitude, omega_180)? * self.phase_crossing_sd(attitude, omega_180)?;
        // Of the distance between the magnitude at omega_gain and its required value \[dB\].
        let level_sd_db = self
            .sd_db(omega_gain)?
            .hypot(self.sd_db(omega_180)?)
            .hypot(from_omega_180);
        Some(level_sd_db / magnitude_slope(attitude, omega_gain)?.abs())
    }

    /// Returns the phase delay's standard deviation \[s\].
    pub(super) fn phase_delay_sd(&self, omega_180: f64) -> Option<f64> {
        let twice = 2.0 * omega_180;
        Some(self.sd_phase(omega_180)?.hypot(self.sd_phase(twice)?) / twice)
    }
}

/// Returns `d phase / d omega` \[s\].
fn phase_slope(attitude: &AttitudeResponse<'_>, omega: f64) -> Option<f64> {
    difference_quotient(omega, |omega| attitude.phase_at(omega))
}

/// Returns `d magnitude / d omega` \[dB s\].
fn magnitude_slope(attitude: &AttitudeResponse<'_>, omega: f64) -> Option<f64> {
    difference_quotient(omega, |omega| attitude.magnitude_db_at(omega))
}

/// Returns the central difference quotient; `None` if a value is missing or the slope is zero.
fn difference_quotient(omega: f64, value: impl Fn(f64) -> Option<f64>) -> Option<f64> {
    let low = omega * (1.0 - HALF_STEP);
    let high = omega * (1.0 + HALF_STEP);
    let slope = (value(high)? - value(low)?) / (high - low);
    if slope == 0.0 {
        return None;
    }
    Some(slope)
}
