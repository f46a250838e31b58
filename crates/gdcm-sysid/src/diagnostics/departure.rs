//! How far a model is from its measured points (M14.17).
//!
//! A *measured point* is the response at a frequency, estimated without a model from the spectral
//! lines in a window around it (`local_polynomial`).
//!
//! ```text
//! G, var G a point's response and its variance, G_model the model's response there, omega its
//!    frequency
//! at the points inside the fitted band whose window has a half-width of at most 0.6 omega
//! T = mean |G_model - G|^2 / var G over five points, 1 on average if the model is exact
//! D = mean |G_model / G - 1| over the same points
//! the model departs from five points if T > 12 and D > 0.12 (1 dB or 7 degrees)
//! band of departure: from the first point of the first such five to the last point of the last,
//!    including points in between with which the model agrees
//! ```

use nalgebra::{Complex, DMatrix};

use gdcm_model::executor::Executor;

use crate::likelihood::schur_model::SchurModel;
use crate::options::Options;
use crate::spectra::local_polynomial::local_polynomial;
use crate::spectra::response_estimate::ResponseEstimate;
use crate::spectra::spectrum::Spectrum;

/// Largest half-width of a window, over its centre frequency, at which its point represents a
/// single frequency.
pub const NARROW_WINDOW: f64 = 0.6;
/// Number of neighbouring points over which `T` and `D` are means.
const POINTS: usize = 5;
/// `T` above which the model departs from the points. An exact model has 1 on average.
const SIGNIFICANT: f64 = 12.0;
/// `D` above which the model departs from the points: 1 dB or 7 degrees. Very exact points would
/// otherwise reveal departures that do not matter.
const RELEVANT: f64 = 0.12;

/// The measured data with which a model is compared.
#[derive(Clone, Copy)]
pub(crate) struct MeasuredData<'a> {
    /// Spectral lines from the fitted records' segments without gaps.
    pub(crate) spectra: &'a [Spectrum],
    pub(crate) measured: &'a ResponseEstimate,
    pub(crate) executor: &'a dyn Executor,
}

/// The distance between a response and its measured points.
pub(crate) struct Departure {
    /// Largest `T`.
    pub(crate) greatest: f64,
    /// The band that encloses all departures; `None` if the model departs from no points.
    pub(crate) band: Option<DepartureBand>,
}

/// The band that encloses all points from which a model departs, and the points between them.
#[derive(Clone, Copy)]
pub(crate) struct DepartureBand {
    /// Lower and upper frequency \[rad/s\].
    pub(crate) ends: [f64; 2],
    /// Largest `T` in the band.
    pub(crate) strength: f64,
}

/// How far the model is from a measured point.
struct PointDistance {
    omega: f64,
    /// `|G_model - G|^2 / var G`.
    significance: f64,
    /// `|G_model / G - 1|`.
    relative: f64,
}

impl Departure {
    /// Compares a model with the measured response of a pair (output, input), at the points of
    /// `estimate` inside `band` \[rad/s\]; `predicted` holds the model's response matrix at every
    /// point of `estimate`.
    pub(crate) fn measure(
        predicted: &[DMatrix<Complex<f64>>],
        estimate: &ResponseEstimate,
        band: [f64; 2],
        pair: (usize, usize),
    ) -> Self {
        let mut distances = Vec::new();
        for (point, response) in estimate.points.iter().zip(predicted) {
            let is_inside = (band[0]..=band[1]).contains(&point.omega);
            if !is_inside || point.half_width > NARROW_WINDOW * point.omega {
                continue;
            }
            let predicted = response[pair];
            let measured = point.response[pair];
            let variance = point.variance[pair].max(f64::MIN_POSITIVE);
            distances.push(PointDistance {
                omega: point.omega,
                significance: (predicted - measured).norm_sqr() / variance,
                relative: (predicted / measured - 1.0).norm(),
            });
        }
        let mut departure = Self {
            greatest: 0.0,
            band: None,
        };
        for near in distances.windows(POINTS) {
            departure.add(near);
        }
        departure
    }

    /// Updates the maximum and the band with `T` and `D`, the means over neighbouring points.
    fn add(&mut self, near: &[PointDistance]) {
        let significance = near
            .iter()
            .map(|distance| distance.significance)
            .sum::<f64>()
            / POINTS as f64;
        let relative = near.iter().map(|distance| distance.relative).sum::<f64>() / POINTS as f64;
        self.greatest = self.greatest.max(significance);
        if significance > SIGNIFICANT && relative > RELEVANT {
            let before = self.band.unwrap_or(DepartureBand {
                ends: [near[0].omega; 2],
                strength: 0.0,
            });
            self.band = Some(DepartureBand {
                ends: [before.ends[0], near[POINTS - 1].omega],
                strength: significance.max(before.strength),
            });
        }
    }
}

/// Predicts the measured points from a model.
///
/// - Without reference signals, the points are local polynomials between inputs and outputs. The
///   model's outputs are put through the same polynomials, which flatten a peak within a window
///   equally in both.
/// - With reference signals, the points are no such polynomials, but ratios between two responses
///   to the references (`reference_response`). The model's response at the points is then taken, as
///   it also is if the polynomials fail.
pub(crate) fn predict_points(
    model: &SchurModel,
    data: &MeasuredData<'_>,
    options: &Options,
) -> Vec<DMatrix<Complex<f64>>> {
    let omegas: Vec<f64> = data
        .measured
        .points
        .iter()
        .map(|point| point.omega)
        .collect();
    if options.references == 0 {
        let predicted: Vec<Spectrum> = data
            .spectra
            .iter()
            .map(|lines| predict_lines(model, lines))
            .collect();
        if let Ok(seen) = local_polynomial(&predicted, &omegas, data.executor) {
            return seen
                .points
                .into_iter()
                .map(|point| point.response)
                .collect();
        }
    }
    omegas
        .into_iter()
        .map(|omega| model.response(omega))
        .collect()
}

/// Returns the lines with the model's outputs, `Y = G_model U`.
fn predict_lines(model: &SchurModel, lines: &Spectrum) -> Spectrum {
    let mut outputs = lines.outputs.clone();
    for (k, omega) in lines.omega.iter().enumerate() {
        let predicted = model.response(*omega) * lines.inputs.column(k);
        outputs.set_column(k, &predicted);
    }
    Spectrum {
        outputs,
        ..lines.clone()
    }
}
