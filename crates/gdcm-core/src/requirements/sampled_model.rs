//! A model's response on the frequencies that are searched for crossings, kept for all that is read from it (M17.1).

use nalgebra::Complex;

use super::search_frequencies;
use crate::dataset::{Band, Dynamics, Pair};
use crate::response::{FrequencyResponse, GainDelay, PreparedModel};

/// A model with its response on the search frequencies and on to twice the highest, at equal ratios: a phase delay needs
/// `2 omega_180`.
pub struct SampledModel {
    prepared: PreparedModel,
    omega: Vec<f64>,
    values: FrequencyResponse,
    /// Number of the search frequencies.
    searched: usize,
}

impl SampledModel {
    /// Samples a model that is searched in and about `band`.
    pub fn of(dynamics: &Dynamics, band: Band) -> Self {
        let prepared = PreparedModel::of(dynamics);
        let mut omega = search_frequencies(band);
        let (searched, highest) = (omega.len(), omega[omega.len() - 1]);
        let ratio = omega[1] / omega[0];
        let beyond = std::iter::successors(Some(highest * ratio), |omega| Some(omega * ratio));
        // One more than needed, for the interpolation to have a neighbour.
        omega.extend(beyond.take(1 + (2f64.ln() / ratio.ln()).ceil() as usize));
        let values = prepared.at(&omega);
        Self { prepared, omega, values, searched }
    }

    /// Its response under `correction`, exact at any frequency (M2, M10).
    pub fn exact(&self, pair: Pair, correction: GainDelay) -> impl Fn(&[f64]) -> Vec<Complex<f64>> + '_ {
        move |omega| {
            let corrected = |values: &[Complex<f64>]| {
                values.iter().zip(omega).map(|(value, omega)| value * correction.at(*omega)).collect()
            };
            if *omega == self.omega[..self.searched] {
                return corrected(&self.values.curve(pair)[..self.searched]);
            }
            corrected(self.prepared.at(omega).curve(pair))
        }
    }

    /// The same, between the samples by the cubic through four of them over ln omega; not a number outside.
    pub fn interpolated(&self, pair: Pair, correction: GainDelay) -> impl Fn(&[f64]) -> Vec<Complex<f64>> + '_ {
        let (curve, start) = (self.values.curve(pair), self.omega[0].ln());
        let step = (self.omega[1] / self.omega[0]).ln();
        let between = move |omega: f64| {
            let place = (omega.ln() - start) / step;
            let last = (curve.len() - 1) as f64;
            if !(-1e-9..=last + 1e-9).contains(&place) {
                return Complex::new(f64::NAN, f64::NAN);
            }
            let from = (place.floor() - 1.0).clamp(0.0, last - 3.0);
            cubic(&curve[from as usize..][..4], place - from) * correction.at(omega)
        };
        move |omega| omega.iter().map(|omega| between(*omega)).collect()
    }
}

/// The cubic through four values at 0, 1, 2, 3 (Lagrange).
fn cubic(values: &[Complex<f64>], at: f64) -> Complex<f64> {
    let [a, b, c, d] = [at, at - 1.0, at - 2.0, at - 3.0];
    values[0] * (-b * c * d / 6.0) + values[1] * (a * c * d / 2.0) - values[2] * (a * b * d / 2.0)
        + values[3] * (a * b * c / 6.0)
}
