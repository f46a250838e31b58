//! Doubts about the recommended model, record by record and response by response (M14.10, M14.17).

use nalgebra::{Complex, DMatrix};

use gdcm_model::dataset::channel::ChannelSide;
use gdcm_model::executor::Executor;
use gdcm_model::simulation::FlightRecord;

use super::cautions::IdentificationCaution;
use super::record_fits::{RecordFit, RecordFits};
use crate::likelihood::descent::Fit;
use crate::likelihood::schur_model::SchurModel;
use crate::options::Options;
use crate::spectra::local_polynomial::local_polynomial;
use crate::spectra::response_estimate::ResponseEstimate;
use crate::spectra::spectrum::Spectrum;

/// Cost per degree of freedom above which a model is not adequate.
const ADEQUATE: f64 = 1.5;
/// A record is unlike the others if its cost per degree of freedom is more than this many times the
/// cost per degree of freedom over all records.
const UNLIKE: f64 = 1.5;
/// Limits on the held-out cost per degree of freedom, with the model free to move within its
/// uncertainty: up to the first, records are predicted well; above the second, they are not
/// (M14.17).
pub const HELD_OUT: [f64; 2] = [1.3, 2.0];
/// Largest half-width of a window, over its centre frequency, at which its point represents a
/// single frequency.
pub const NARROW_WINDOW: f64 = 0.6;
/// Number of neighbouring points over which `T` and `D` are means.
const POINTS: usize = 5;
/// `T` in [`Departure`] above which the model departs from the points (M14.17).
const SIGNIFICANT: f64 = 12.0;
/// `D` in [`Departure`] above which the model departs from the points: 1 dB or 7 degrees (M14.17).
const RELEVANT: f64 = 0.12;

/// The recommended model, and the data for examining it.
pub(crate) struct Diagnostics<'a> {
    pub(crate) records: &'a [FlightRecord],
    pub(crate) options: &'a Options,
    pub(crate) data: MeasuredData<'a>,
    pub(crate) fit: &'a Fit,
}

/// The measured data by which a fitted model is examined.
#[derive(Clone, Copy)]
pub(crate) struct MeasuredData<'a> {
    /// Spectral lines from the fitted records' segments without gaps.
    pub(crate) spectra: &'a [Spectrum],
    pub(crate) measured: &'a ResponseEstimate,
    pub(crate) executor: &'a dyn Executor,
}

impl Diagnostics<'_> {
    /// Returns a record's name; empty if it does not exist.
    pub(crate) fn record_name(&self, record: usize) -> String {
        self.records
            .get(record)
            .map_or_else(String::new, |record| record.name.clone())
    }

    /// Returns cautions about costs per degree of freedom beyond their limits: over all fitted
    /// records (1.5), in each of them (1.5, and 1.5 times that over all) and over the held-out
    /// records (2).
    pub(crate) fn adequacy(&self, fits: &RecordFits) -> Vec<IdentificationCaution> {
        let (held_out, fitted): (Vec<&RecordFit>, Vec<&RecordFit>) =
            fits.records.iter().partition(|fit| fit.held_out);
        let mut cautions = Vec::new();
        let worst = fitted.iter().max_by(|a, b| a.cost.total_cmp(&b.cost));
        if let Some(worst) = worst
            && fits.cost > ADEQUATE
        {
            cautions.push(IdentificationCaution::Inadequate {
                cost: fits.cost,
                record: self.record_name(worst.record),
                signal: self
                    .options
                    .signal(ChannelSide::Output, place_of_greatest(&fits.outputs)),
            });
        }
        for fit in fitted {
            if fit.cost > ADEQUATE.max(UNLIKE * fits.cost) {
                cautions.push(IdentificationCaution::UnlikeRecord {
                    record: fit.record,
                    name: self.record_name(fit.record),
                    cost: fit.cost,
                });
            }
        }
        if let Some(cost) = fits.held_out
            && cost.normalised > HELD_OUT[1]
        {
            cautions.push(IdentificationCaution::HeldOut {
                records: held_out
                    .iter()
                    .map(|fit| self.record_name(fit.record))
                    .collect(),
                raw: cost.raw,
                normalised: cost.normalised,
            });
        }
        cautions
    }

    /// Returns the caution about responses that are not identified; `pairs` are outputs and inputs.
    pub(crate) fn unidentified_pairs(
        &self,
        pairs: &[(usize, usize)],
    ) -> Option<IdentificationCaution> {
        if pairs.is_empty() {
            return None;
        }
        let mut signals = Vec::with_capacity(pairs.len());
        for &(output, input) in pairs {
            signals.push([
                self.options.signal(ChannelSide::Output, output),
                self.options.signal(ChannelSide::Input, input),
            ]);
        }
        Some(IdentificationCaution::PairsNotIdentified(signals))
    }

    /// Returns a caution for each response that departs from its measured points.
    pub(crate) fn departures(&self) -> Vec<IdentificationCaution> {
        let (outputs, inputs) = self.fit.model.d().shape();
        let predicted = predict_points(&self.fit.model, &self.data, self.options);
        let mut cautions = Vec::new();
        for input in 0..inputs {
            for output in 0..outputs {
                let departure = Departure::measure(
                    &predicted,
                    self.data.measured,
                    self.options.band,
                    (output, input),
                );
                if let Some(band) = departure.band {
                    cautions.push(IdentificationCaution::LeavesPoints {
                        output: self.options.signal(ChannelSide::Output, output),
                        input: self.options.signal(ChannelSide::Input, input),
                        band: band.ends,
                        strength: band.strength,
                    });
                }
            }
        }
        cautions
    }
}

/// Returns the last index of the maximum; 0 if `values` is empty.
fn place_of_greatest(values: &[f64]) -> usize {
    let greatest = values.iter().enumerate().max_by(|a, b| a.1.total_cmp(b.1));
    greatest.map_or(0, |(place, _)| place)
}

/// Predicts the measured points from a model: without a reference, by the same local polynomials as
/// the records, which flatten a peak within a window equally in both; otherwise, and if they fail,
/// by the model's response at the points.
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

/// How far a model is from its measured points (M14.17).
///
/// ```text
/// at the points inside the band whose window is no wider than 0.6 omega
/// T = mean |G_model - G|^2 / var G over five points
/// D = mean |G_model / G - 1| over the same points
/// the model leaves the points where T > 12 and D > 0.12 (1 dB or 7 degrees)
/// band: from the first point of the first such five to the last point of the last
/// ```
pub(crate) struct Departure {
    /// Largest `T`.
    pub(crate) greatest: f64,
    /// The band in which the model departs from the points; `None` if it does not.
    pub(crate) band: Option<DepartureBand>,
}

/// A band in which a model departs from its measured points.
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
    /// Measures a response's distance from its points; `predicted` holds the model's responses at
    /// these points.
    pub(crate) fn measure(
        predicted: &[DMatrix<Complex<f64>>],
        measured: &ResponseEstimate,
        band: [f64; 2],
        pair: (usize, usize),
    ) -> Self {
        let mut distances = Vec::new();
        for (point, predicted) in measured.points.iter().zip(predicted) {
            let is_inside = (band[0]..=band[1]).contains(&point.omega);
            if !is_inside || point.half_width > NARROW_WINDOW * point.omega {
                continue;
            }
            let own = predicted[pair];
            let found = point.response[pair];
            let variance = point.variance[pair].max(f64::MIN_POSITIVE);
            distances.push(PointDistance {
                omega: point.omega,
                significance: (own - found).norm_sqr() / variance,
                relative: (own / found - 1.0).norm(),
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
