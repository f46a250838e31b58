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
