//! Bandwidth and phase delay (M17: `docs/requirements.md`).
//!
//! Both are read from an attitude response: `omega_180` and `omega_phase` where its phase falls
//! through -180 and -135 deg, `omega_gain` where its magnitude is 6 dB above that at `omega_180`.

use nalgebra::Complex;

use gdcm_method::requirements::AttitudeOutput;
use gdcm_method::requirements::attitude_response::{AttitudeResponse, search_frequencies};
use gdcm_method::requirements::bandwidth::{AboveBand, Bandwidth, BandwidthSettings, CommandType};
use gdcm_model::dataset::Band;

use crate::check::{CheckFault, Found};
use crate::reference::REQUIREMENTS;
use crate::reference_study::ReferenceStudy;

/// `gain omega^2 exp(-delay s) / (s (s^2 + 2 damping omega s + omega^2))`.
struct SecondOrderAttitude {
    gain: f64,
    omega: f64,
    damping: f64,
    delay_s: f64,
}

impl SecondOrderAttitude {
    fn at(&self, s: Complex<f64>) -> Complex<f64> {
        let square = self.omega * self.omega;
        let denominator = s * (s * s + 2.0 * self.damping * self.omega * s + square);
        self.gain * square * (-self.delay_s * s).exp() / denominator
    }
}

/// Evaluates the closed form of the attitude response at `s` for a case, counted as in the
/// reference.
fn attitude(case: usize, s: Complex<f64>) -> Complex<f64> {
    match case {
        0 => SecondOrderAttitude {
            gain: 1.2,
            omega: 2.5,
            damping: 0.5,
            delay_s: 0.09,
        }
        .at(s),
        1 => SecondOrderAttitude {
            gain: 0.8,
            omega: 3.0,
            damping: 0.12,
            delay_s: 0.05,
        }
        .at(s),
        2 => 5.0 * (-0.06 * s).exp() / (s * (s + 3.0)) * 400.0 / (s * s + 28.0 * s + 400.0),
        _ => SecondOrderAttitude {
            gain: 1.0,
            omega: 4.0,
            damping: 0.7,
            delay_s: 0.02,
        }
        .at(s),
    }
}

/// Compares bandwidths, phase delays and the frequencies that they are read from with the
/// reference.
pub(super) fn bandwidths(_: &mut ReferenceStudy) -> Result<Found, CheckFault> {
    let band = Band::new(0.5, 12.0).map_err(CheckFault::no_result)?;
    let settings = BandwidthSettings {
        command: CommandType::Rate,
        band,
        above_band: AboveBand::Marked,
    };
    let mut found = Found::default();
    for (index, case) in REQUIREMENTS.read()?.list("bandwidth")?.iter().enumerate() {
        let rate = |omega: &[f64]| {
            let mut values = Vec::with_capacity(omega.len());
            for omega in omega {
                let s = Complex::new(0.0, *omega);
                values.push(s * attitude(index, s));
            }
            values
        };
        let frequencies = search_frequencies(band);
        let response = AttitudeResponse::new(&rate, AttitudeOutput::Rate, &frequencies, band)
            .map_err(CheckFault::no_result)?;
        let own = Bandwidth::read(&response, &settings, None);
        found.instance();
        for (metric, name) in [
            (&own.omega_180, "omega_180"),
            (&own.omega_phase, "omega_phase"),
            (&own.omega_gain, "omega_gain"),
            (&own.omega_bw, "bandwidth_rate"),
        ] {
            match metric {
                Ok(metric) => found.relative(metric.value, case.number(name)?),
                Err(_) => found.agree(false),
            }
        }
        match &own.phase_line {
            Some(line) => {
                found.relative(line.two_points_s, case.number("phase_delay_two_points_s")?);
                found.relative(line.least_squares_s, case.number("phase_delay_line_s")?);
                found.relative(line.departure_deg, case.number("departure_deg")?);
            }
            None => found.agree(false),
        }
    }
    Ok(found)
}
