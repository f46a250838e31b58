//! A model's response sampled once on the search frequencies and interpolated between them, so that
//! bandwidths under many corrections need no further model evaluation (M17.1). The *search
//! frequencies* are those on which the crossings of phase and magnitude are searched, in and around
//! the band, in equal ratios.
//!
//! The reported bandwidths use the exact response. The interpolated one serves the models that only
//! contribute to an interval, within about 1e-7 (docs/requirements.md), and the points inside the
//! line for the phase delay.

use nalgebra::Complex;

use gdcm_model::dataset::{Band, Dynamics, Pair};
use gdcm_model::response::{FrequencyResponse, GainDelay, PreparedModel};

use super::attitude_response::search_frequencies;

/// Distance from the first or last sample, in steps, that counts as a rounding error.
const ROUNDING: f64 = 1e-9;

/// A model with its response on the search frequencies, which are continued in equal ratios up to
/// twice the highest search frequency: a phase delay needs `2 omega_180`.
pub struct SampledResponse {
    prepared: PreparedModel,
    /// The samples' frequencies \[rad/s\]: the search frequencies, then their continuation.
    omega: Vec<f64>,
    /// All responses at `omega`, without correction.
    values: FrequencyResponse,
    /// Count of search frequencies, the first in `omega`.
    searched: usize,
}

impl SampledResponse {
    /// Samples a model for a search in and around `band`.
    pub fn new(dynamics: &Dynamics, band: Band) -> Self {
        let prepared = PreparedModel::new(dynamics);
        let mut omega = search_frequencies(band);
        let searched = omega.len();
        let highest = omega[omega.len() - 1];
        let ratio = omega[1] / omega[0];
        let beyond = std::iter::successors(Some(highest * ratio), |omega| Some(omega * ratio));
        // `1 +`: a sample beyond twice the highest search frequency, so that the interpolation
        // there has samples on both sides.
        omega.extend(beyond.take(1 + (2f64.ln() / ratio.ln()).ceil() as usize));
        let values = prepared.at(&omega);
        Self {
            prepared,
            omega,
            values,
            searched,
        }
    }

    /// Returns the response under `correction`, exact at any frequency (M2, M10).
    pub fn exact(
        &self,
        pair: Pair,
        correction: GainDelay,
    ) -> impl Fn(&[f64]) -> Vec<Complex<f64>> + '_ {
        move |omega| {
            // The values at the search frequencies themselves are known.
            if *omega == self.omega[..self.searched] {
                let values = &self.values.curve(pair)[..self.searched];
                return corrected(values, omega, correction);
            }
            corrected(self.prepared.at(omega).curve(pair), omega, correction)
        }
    }

    /// Returns the response under `correction`, interpolated between the samples by a cubic over ln
    /// omega; NaN outside the samples.
    pub fn interpolated(
        &self,
        pair: Pair,
        correction: GainDelay,
    ) -> impl Fn(&[f64]) -> Vec<Complex<f64>> + '_ {
        let cubic = CubicInterpolation {
            curve: self.values.curve(pair),
            start: self.omega[0].ln(),
            step: (self.omega[1] / self.omega[0]).ln(),
        };
        move |omega| {
            omega
                .iter()
                .map(|&omega| match cubic.at(omega) {
                    Some(value) => value * correction.at(omega),
                    None => Complex::new(f64::NAN, f64::NAN),
                })
                .collect()
        }
    }
}

/// Returns the values at these frequencies under `correction`.
fn corrected(values: &[Complex<f64>], omega: &[f64], correction: GainDelay) -> Vec<Complex<f64>> {
    values
        .iter()
        .zip(omega)
        .map(|(value, omega)| value * correction.at(*omega))
        .collect()
}

/// A response sampled at equal steps in ln omega.
struct CubicInterpolation<'a> {
    curve: &'a [Complex<f64>],
    /// ln omega at the first sample.
    start: f64,
    /// Step in ln omega.
    step: f64,
}

impl CubicInterpolation<'_> {
    /// Interpolates through the four nearest samples; `None` outside the samples.
    fn at(&self, omega: f64) -> Option<Complex<f64>> {
        // Position in steps from the first sample.
        let place = (omega.ln() - self.start) / self.step;
        let last = (self.curve.len() - 1) as f64;
        if !(-ROUNDING..=last + ROUNDING).contains(&place) {
            return None;
        }
        // First sample: one before the interval, except at the ends.
        let from = (place.floor() - 1.0).clamp(0.0, last - 3.0);
        Some(cubic(&self.curve[from as usize..][..4], place - from))
    }
}

/// Evaluates the cubic through four values at 0, 1, 2, 3 (Lagrange).
fn cubic(values: &[Complex<f64>], at: f64) -> Complex<f64> {
    let [a, b, c, d] = [at, at - 1.0, at - 2.0, at - 3.0];
    values[0] * (-b * c * d / 6.0) + values[1] * (a * c * d / 2.0) - values[2] * (a * b * d / 2.0)
        + values[3] * (a * b * c / 6.0)
}
