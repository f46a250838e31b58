//! Flight data for the coupling fit: the response without its channels' delays and leads, and its
//! standard deviation (M16.2). `R` is the identified response with `p` outputs and `m` inputs;
//! `L_o` and `L_i` are the delays or lead filters of its output and input channels, which mixing
//! and feedback are not to reproduce.

use std::f64::consts::LN_10;

use nalgebra::Complex;

use gdcm_model::dataset::PairTable;
use gdcm_model::dataset::model::ModelBands;
use gdcm_model::response::FrequencyResponse;
use gdcm_model::response::interpolation::interpolate_values;

use crate::correction::Channels;
use crate::correction::lead_design::LeadDesign;
use crate::uncertainty::coherence_error::Measurement;

/// Returns each channel's mean signed delay \[s\] over the conditions, which have the same
/// channels; `None` without conditions.
pub fn mean_delays_s(conditions: &[Channels<f64>]) -> Option<Channels<f64>> {
    let count = conditions.len() as f64;
    let first = conditions.first()?;
    Some(first.map(|channel, _| {
        let sum_s: f64 = conditions
            .iter()
            .filter_map(|delays_s| delays_s.get(channel))
            .sum();
        sum_s / count
    }))
}

/// Computes `R' = L_o^-1 R L_i^-1`, p x m on `omega` \[rad/s\]: the response that mixing and
/// feedback have to reproduce.
///
/// `L = e^(-j omega tau)` for a signed delay `tau` \[s\], or the lead filter that `design` provides
/// for a negative delay (M15). Without a design, the exponential is used for every delay.
#[must_use]
pub fn without_delays_and_leads(
    flight: &FrequencyResponse,
    omega: &[f64],
    delays_s: &Channels<f64>,
    design: Option<&LeadDesign>,
) -> FrequencyResponse {
    let channels = delays_s.map(|_, &tau_s| channel_response(tau_s, omega, design));
    FrequencyResponse::new(flight.curves().map(|pair, curve| {
        let output = &channels.outputs[pair.output];
        let input = &channels.inputs[pair.input];
        curve
            .iter()
            .zip(output.iter().zip(input))
            .map(|(value, (output, input))| value / (output * input))
            .collect()
    }))
}

/// Returns a channel's response `L` for a signed delay `tau_s` \[s\].
fn channel_response(tau_s: f64, omega: &[f64], design: Option<&LeadDesign>) -> Vec<Complex<f64>> {
    match design.and_then(|design| design.filter(tau_s)) {
        Some(filter) => omega.iter().map(|&omega| filter.at(omega)).collect(),
        None => omega
            .iter()
            .map(|omega| Complex::from_polar(1.0, -omega * tau_s))
            .collect(),
    }
}

/// Returns the standard deviation of `ln H` from a model's bands, p x m curves on `omega`
/// \[rad/s\]: `sd^2 = 1/2 ((sd_dB ln 10 / 20)^2 + (sd_deg pi / 180)^2)`, the mean of the variances
/// in the real and imaginary parts of `ln H`; linear in `ln omega`, constant beyond the bands' ends
/// (M16.2).
pub fn response_deviation(bands: &ModelBands, omega: &[f64]) -> PairTable<Vec<f64>> {
    bands.sd_db().map(|pair, sd_db| {
        let sd_db = interpolate_values(bands.omega(), sd_db, omega);
        let sd_deg = interpolate_values(bands.omega(), &bands.sd_deg()[pair], omega);
        sd_db
            .iter()
            .zip(&sd_deg)
            .map(|(db, deg)| {
                (0.5 * ((db * LN_10 / 20.0).powi(2) + deg.to_radians().powi(2))).sqrt()
            })
            .collect()
    })
}

/// Returns the standard deviation of `ln H` from the coherence `gamma^2`, p x m curves (M13.2): `C
/// sqrt(1 - gamma^2) / (|gamma| sqrt(2 n_d))`, with the constant `C` and the average count `n_d`
/// from `measurement`.
pub fn coherence_deviation(
    coherence: &PairTable<Vec<f64>>,
    measurement: &Measurement,
) -> PairTable<Vec<f64>> {
    coherence.map(|_, curve| {
        curve
            .iter()
            .map(|&coherence| measurement.deviation(coherence))
            .collect()
    })
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use gdcm_model::dataset::Pair;

    use super::*;
    use crate::correction::lead_design::LeadSettings;

    fn signed_delays() -> Channels<f64> {
        Channels {
            inputs: vec![0.04, -0.03],
            outputs: vec![-0.02],
        }
    }

    #[test]
    fn channel_delays_are_averaged_over_the_conditions() {
        let other = Channels {
            inputs: vec![0.0, -0.05],
            outputs: vec![0.02],
        };
        let mean = mean_delays_s(&[signed_delays(), other]).unwrap();
        assert_eq!((mean.inputs, mean.outputs), (vec![0.02, -0.04], vec![0.0]));
        assert_eq!(mean_delays_s(&[]), None);
    }

    #[test]
    fn delays_and_filters_of_the_channels_are_removed() {
        let omega = [0.5, 2.0, 12.0];
        let design = LeadDesign::new(LeadSettings::default(), Arc::from(omega));
        let [second, output] = [-0.03, -0.02].map(|tau_s| design.filter(tau_s).unwrap());
        let flight = PairTable::from_fn(1, 2, |pair| {
            omega
                .iter()
                .map(|&omega| {
                    let input = match pair.input {
                        0 => Complex::from_polar(1.0, -0.04 * omega),
                        _ => second.at(omega),
                    };
                    3.0 * input * output.at(omega)
                })
                .collect()
        });
        let remainder = without_delays_and_leads(
            &FrequencyResponse::new(flight),
            &omega,
            &signed_delays(),
            Some(&design),
        );
        for (_, curve) in remainder.curves().iter() {
            assert!(
                curve.iter().all(|value| (value - 3.0).norm() < 1e-14),
                "{curve:?}"
            );
        }
        let ones = FrequencyResponse::new(PairTable::filled(1, 2, vec![Complex::from(1.0); 3]));
        let turned = without_delays_and_leads(&ones, &omega, &signed_delays(), None);
        let expected = Complex::from_polar(1.0, -0.05 * omega[2]);
        assert!(
            (turned.curve(Pair::new(0, 1))[2] - expected).norm() < 1e-15,
            "pure delays without a design"
        );
    }

    #[test]
    fn a_deviation_averages_the_squares_from_magnitude_and_phase() {
        let sd_db = PairTable::filled(1, 1, vec![20.0 / LN_10 * 0.03; 2]);
        let sd_deg = PairTable::filled(1, 1, vec![0.04_f64.to_degrees(); 2]);
        let bands = ModelBands::new(vec![1.0, 10.0], sd_db, sd_deg).unwrap();
        let deviation = &response_deviation(&bands, &[0.5, 3.0])[Pair::new(0, 0)];
        assert!(
            deviation
                .iter()
                .all(|sd| (sd - (0.5 * (0.0009_f64 + 0.0016)).sqrt()).abs() < 1e-15)
        );
        let measurement = Measurement {
            averages: 8.0,
            window_s: None,
            factor: 1.0,
        };
        let deviation = coherence_deviation(&PairTable::filled(1, 1, vec![0.5, 1.0]), &measurement);
        assert_eq!(deviation[Pair::new(0, 0)], [0.25, 0.0]);
    }
}
