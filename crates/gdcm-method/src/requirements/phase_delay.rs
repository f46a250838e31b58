//! Phase delay `tau_p` from the phase `Phi` of the attitude response between `omega_180`, where it
//! is -180 deg, and `2 omega_180` (M17.1). The *chord* is the straight line between the phase's two
//! ends.
//!
//! ```text
//! Phi departs from its chord by at most 10 deg:  tau_p = -(Phi(2 omega_180) + pi) / (2 omega_180)
//! otherwise:  tau_p = -1/2 slope of the least-squares line through Phi over omega
//! ```
//!
//! Both are a phase loss from `omega_180` to `2 omega_180`, that of the chord or of the line,
//! divided by `2 omega_180`.

use std::f64::consts::PI;

use gdcm_model::response::frequency_grid::log_spaced;
use gdcm_model::statistics::mean;

use super::attitude_response::AttitudeResponse;

/// Points used to judge the phase between `omega_180` and `2 omega_180`.
const LINE_POINTS: usize = 400;
/// Departure from its chord \[deg\] up to which the phase counts as straight. The standard uses the
/// line where the phase is nonlinear, and gives no number for that; this one is the program's own.
const STRAIGHT_DEG: f64 = 10.0;

/// The phase from `omega_180` to `2 omega_180`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PhaseLine {
    /// The phase's maximum departure from its chord \[deg\].
    pub departure_deg: f64,
    /// Phase delay from the two ends \[s\]: `-(Phi(2 omega_180) + pi) / (2 omega_180)`.
    pub two_points_s: f64,
    /// Phase delay from the least-squares line \[s\]: minus half its slope.
    pub least_squares_s: f64,
}

impl PhaseLine {
    /// Reads the phase from `omega_180` \[rad/s\] to twice that frequency; `None` if a response is
    /// missing in between, or ends below twice that frequency.
    pub(super) fn read(attitude: &AttitudeResponse<'_>, omega_180: f64) -> Option<Self> {
        let from = omega_180;
        let to = 2.0 * omega_180;
        let omega = log_spaced(from, to, LINE_POINTS);
        let phase = attitude.phases_from(-PI, &omega)?;
        Some(Self {
            departure_deg: chord_departure(&omega, &phase).to_degrees(),
            two_points_s: -(phase[LINE_POINTS - 1] + PI) / to,
            least_squares_s: -0.5 * slope(&omega, &phase),
        })
    }

    /// Returns whether the two points suffice: the departure is at most 10 deg.
    pub fn is_straight(&self) -> bool {
        self.departure_deg <= STRAIGHT_DEG
    }

    /// Returns the phase delay \[s\]: from the two points if the phase is straight, otherwise from
    /// the least-squares line.
    pub fn phase_delay_s(&self) -> f64 {
        if self.is_straight() {
            self.two_points_s
        } else {
            self.least_squares_s
        }
    }
}

/// Returns the maximum distance \[rad\] between a phase and its chord.
fn chord_departure(omega: &[f64], phase: &[f64]) -> f64 {
    let last = omega.len() - 1;
    let slope = (phase[last] - phase[0]) / (omega[last] - omega[0]);
    let mut largest = 0.0;
    for (omega_k, phase_k) in omega.iter().zip(phase) {
        let departure = (phase_k - phase[0] - slope * (omega_k - omega[0])).abs();
        largest = f64::max(largest, departure);
    }
    largest
}

/// Returns the slope \[s\] of the least-squares line through `phase` over `omega`.
fn slope(omega: &[f64], phase: &[f64]) -> f64 {
    let mean_omega = mean(omega);
    let mean_phase = mean(phase);
    let product: f64 = omega
        .iter()
        .zip(phase)
        .map(|(omega, phase)| (omega - mean_omega) * (phase - mean_phase))
        .sum();
    let square: f64 = omega.iter().map(|omega| (omega - mean_omega).powi(2)).sum();
    product / square
}
