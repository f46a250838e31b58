//! The flight response without the delays and leads of its channels, and how well it is known (M16.1, M16.2).

use std::f64::consts::LN_10;

use nalgebra::Complex;

use crate::correction::{Channel, Channels, LeadDesign};
use crate::dataset::{ModelBands, PairTable};
use crate::response::{FrequencyResponse, interpolate_values};
use crate::uncertainty::Measurement;

/// The mean signed delay of each channel \[s\] over the conditions; none of no condition.
pub fn mean_delays_s(conditions: &[Channels<f64>]) -> Option<Channels<f64>> {
    let count = conditions.len() as f64;
    let sum_s = |channel: Channel| conditions.iter().filter_map(|delays_s| delays_s.get(channel)).sum::<f64>();
    Some(conditions.first()?.map(|channel, _| sum_s(channel) / count))
}

/// `R' = L_o^-1 R L_i^-1`, p x m on `omega` \[rad/s\]: what mixing and feedback are to give.
///
/// `L = e^(-j omega tau)` of a signed delay `tau` \[s\], or of a negative one the lead filter that `design` has for it (M15); without a
/// design the first of any.
#[must_use]
pub fn without_channels(
    flight: &FrequencyResponse,
    omega: &[f64],
    delays_s: &Channels<f64>,
    design: Option<&LeadDesign>,
) -> FrequencyResponse {
    let of_channel = |tau_s: f64| -> Vec<Complex<f64>> {
        match design.and_then(|design| design.filter(tau_s)) {
            Some(filter) => omega.iter().map(|&omega| filter.at(omega)).collect(),
            None => omega.iter().map(|omega| Complex::from_polar(1.0, -omega * tau_s)).collect(),
        }
    };
    let channels = delays_s.map(|_, &tau_s| of_channel(tau_s));
    FrequencyResponse::new(flight.curves().map(|pair, curve| {
        let (output, input) = (&channels.outputs[pair.output], &channels.inputs[pair.input]);
        curve.iter().zip(output.iter().zip(input)).map(|(value, (output, input))| value / (output * input)).collect()
    }))
}

/// Standard deviation of `ln H` that a model's bands tell, p x m curves on `omega` \[rad/s\]:
/// `sd^2 = 1/2 ((sd_dB ln 10 / 20)^2 + (sd_deg pi / 180)^2)`, linear in `ln omega`, beyond the bands that of their end (M16.2).
pub fn response_deviation(bands: &ModelBands, omega: &[f64]) -> PairTable<Vec<f64>> {
    let on_grid = |values: &[f64]| interpolate_values(bands.omega(), values, omega);
    bands.sd_db().map(|pair, sd_db| {
        let (sd_db, sd_deg) = (on_grid(sd_db), on_grid(&bands.sd_deg()[pair]));
        let both = |(db, deg): (&f64, &f64)| (0.5 * ((db * LN_10 / 20.0).powi(2) + deg.to_radians().powi(2))).sqrt();
        sd_db.iter().zip(&sd_deg).map(both).collect()
    })
}

/// Standard deviation of `ln H` that coherence `gamma^2` tells, p x m curves (M13.2):
/// `C sqrt(1 - gamma^2) / (|gamma| sqrt(2 n_d))`.
pub fn coherence_deviation(coherence: &PairTable<Vec<f64>>, measurement: &Measurement) -> PairTable<Vec<f64>> {
    coherence.map(|_, curve| curve.iter().map(|&coherence| measurement.deviation(coherence)).collect())
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::correction::LeadSettings;
    use crate::dataset::Pair;

    fn signed_delays() -> Channels<f64> {
        Channels { inputs: vec![0.04, -0.03], outputs: vec![-0.02] }
    }

    #[test]
    fn the_mean_delay_of_each_channel_is_over_the_conditions() {
        let other = Channels { inputs: vec![0.0, -0.05], outputs: vec![0.02] };
        let mean = mean_delays_s(&[signed_delays(), other]).unwrap();
        assert_eq!((mean.inputs, mean.outputs), (vec![0.02, -0.04], vec![0.0]));
        assert_eq!(mean_delays_s(&[]), None);
    }

    #[test]
    fn what_is_left_has_no_delay_and_no_filter_of_its_channels() {
        let omega = [0.5, 2.0, 12.0];
        let design = LeadDesign::new(LeadSettings::default(), Arc::from(omega));
        let [second, output] = [-0.03, -0.02].map(|tau_s| design.filter(tau_s).unwrap());
        let delayed = |omega: f64| Complex::from_polar(1.0, -0.04 * omega);
        let flight = PairTable::from_fn(1, 2, |pair| {
            let input = |omega| if pair.input == 0 { delayed(omega) } else { second.at(omega) };
            omega.iter().map(|&omega| 3.0 * input(omega) * output.at(omega)).collect()
        });
        let left = without_channels(&FrequencyResponse::new(flight), &omega, &signed_delays(), Some(&design));
        for (_, curve) in left.curves().iter() {
            assert!(curve.iter().all(|value| (value - 3.0).norm() < 1e-14), "{curve:?}");
        }
        let ones = FrequencyResponse::new(PairTable::filled(1, 2, vec![Complex::from(1.0); 3]));
        let turned = without_channels(&ones, &omega, &signed_delays(), None);
        let expected = Complex::from_polar(1.0, -0.05 * omega[2]);
        assert!((turned.curve(Pair::new(0, 1))[2] - expected).norm() < 1e-15, "pure delays where there is no design");
    }

    #[test]
    fn a_deviation_is_the_mean_square_of_its_magnitude_and_its_phase() {
        let table = |value: f64| PairTable::filled(1, 1, vec![value; 2]);
        let bands = ModelBands::new(vec![1.0, 10.0], table(20.0 / LN_10 * 0.03), table(0.04_f64.to_degrees())).unwrap();
        let deviation = &response_deviation(&bands, &[0.5, 3.0])[Pair::new(0, 0)];
        assert!(deviation.iter().all(|sd| (sd - (0.5 * (0.0009_f64 + 0.0016)).sqrt()).abs() < 1e-15));
        let measurement = Measurement { averages: 8.0, window_s: None, factor: 1.0 };
        let deviation = coherence_deviation(&PairTable::filled(1, 1, vec![0.5, 1.0]), &measurement);
        assert_eq!(deviation[Pair::new(0, 0)], [0.25, 0.0]);
    }
}
