//! Spectral lines of the fitted segments, and the response measured from them: directly, or through
//! references (M14.2, M14.15).
//!
//! A *segment* is a stretch of a record on a uniform grid, its *lines* are its spectrum at discrete
//! frequencies. A *reference* is a recorded signal that drove the loop from outside. With
//! references, the lines to fit are the parts of inputs and outputs that the references explain;
//! the lines *as logged* are those of the segments themselves.

use nalgebra::DMatrix;

use gdcm_model::executor::Executor;
use gdcm_model::response::frequency_grid::log_spaced;
use gdcm_model::simulation::Segment;

use super::split_segments::scale_all;
use crate::identification_error::IdentificationError;
use crate::likelihood::cost::Likelihood;
use crate::likelihood::noise_covariance::NoiseCovariance;
use crate::likelihood::spectral_lines::SpectralLines;
use crate::spectra::filled_segment::FilledSegment;
use crate::spectra::local_polynomial::local_polynomial;
use crate::spectra::local_polynomial_error::LocalPolynomialError;
use crate::spectra::reference_response::ReferenceResponse;
use crate::spectra::response_estimate::ResponseEstimate;
use crate::spectra::scales::{Scales, ScalingError};
use crate::spectra::spectrum::{LineRange, Spectrum};

/// Number of frequencies at which the response is measured.
const MEASURED_POINTS: usize = 40;
/// Ratio of the highest line used for the measured response to the highest line that is fitted: the
/// window around a point reaches beyond its frequency.
const BEYOND: f64 = 1.3;

/// The measured response and the lines to fit.
pub(super) struct Measurement<'a> {
    pub(super) measured: ResponseEstimate,
    /// The lines to fit.
    pub(super) spectra: Vec<Spectrum>,
    /// The cost over the lines as logged, if a reference is used.
    pub(super) direct: Option<Likelihood<'a>>,
}

/// Spectral lines from all fitted segments.
pub(super) struct SegmentLines {
    /// Frequency range of the lines to fit.
    fitted_range: LineRange,
    /// Frequency range of the lines for the measured response, which reaches higher.
    pub(super) measured_range: LineRange,
    /// Lines from the segments without gaps, in the measured range.
    gap_free: Vec<Spectrum>,
    /// Lines from the filled segments, in the fitted range.
    pub(super) to_fit: Vec<Spectrum>,
}

impl SegmentLines {
    pub(super) fn new(
        segments: &[Segment],
        filled: &[FilledSegment],
        fitted_range: LineRange,
        executor: &dyn Executor,
    ) -> Self {
        let measured_range = LineRange {
            highest: BEYOND * fitted_range.highest,
            ..fitted_range
        };
        Self {
            fitted_range,
            measured_range,
            gap_free: measured_range.spectra(segments, executor),
            to_fit: fitted_range.filled_spectra(filled, executor),
        }
    }

    /// Returns the lines from the segments without gaps, in the fitted range only.
    pub(super) fn gap_free_in_fitted_range(&self) -> Vec<Spectrum> {
        let LineRange { lowest, highest } = self.fitted_range;
        let mut spectra = Vec::with_capacity(self.gap_free.len());
        for spectrum in &self.gap_free {
            spectra.push(spectrum.between(lowest, highest));
        }
        spectra
    }

    /// Measures the response from inputs to outputs.
    pub(super) fn measure<'a>(
        self,
        executor: &dyn Executor,
    ) -> Result<Measurement<'a>, LocalPolynomialError> {
        Ok(Measurement {
            measured: self.measure_response(executor)?,
            spectra: self.to_fit,
            direct: None,
        })
    }

    /// Measures the response through the references in the `driven` segments; see [`ReferenceResponse`].
    pub(super) fn measure_through_reference<'a>(
        self,
        driven: &[Segment],
        outputs: usize,
        executor: &'a dyn Executor,
    ) -> Result<Measurement<'a>, IdentificationError> {
        let driven_lines = self.measured_range.spectra(driven, executor);
        let through_reference =
            ReferenceResponse::new(&driven_lines, self.fitted_range, outputs, executor)?;
        let logged = self.measure_response(executor)?;
        Ok(Measurement {
            measured: through_reference.measured,
            spectra: through_reference.spectra,
            direct: Some(weigh(&self.to_fit, &logged, executor)?),
        })
    }

    /// Measures the response from the first line up to the highest line used.
    fn measure_response(
        &self,
        executor: &dyn Executor,
    ) -> Result<ResponseEstimate, LocalPolynomialError> {
        let highest = self.fitted_range.highest;
        let first = self
            .gap_free
            .iter()
            .filter_map(|spectrum| spectrum.omega.first().copied())
            .fold(highest, f64::min);
        let omegas = log_spaced(first, highest, MEASURED_POINTS);
        local_polynomial(&self.gap_free, &omegas, executor)
    }
}

/// Returns scaled segments with the references as inputs, and outputs and inputs as outputs: all
/// that the references drive.
pub(super) fn driven_segments(
    segments: &[Segment],
    references: Vec<DMatrix<f64>>,
) -> Result<Vec<Segment>, ScalingError> {
    let mut driven = Vec::with_capacity(segments.len());
    for (segment, reference) in segments.iter().zip(references) {
        let responses: Vec<_> = segment
            .outputs
            .column_iter()
            .chain(segment.inputs.column_iter())
            .collect();
        driven.push(Segment {
            inputs: reference,
            outputs: DMatrix::from_columns(&responses),
            ..segment.clone()
        });
    }
    let scales = Scales::from_segments(&driven)?;
    Ok(scale_all(&scales, &driven))
}

/// Weights lines by the measured noise; an error if it is singular at a line.
pub(super) fn weigh<'a>(
    spectra: &[Spectrum],
    measured: &ResponseEstimate,
    executor: &'a dyn Executor,
) -> Result<Likelihood<'a>, IdentificationError> {
    let noise =
        NoiseCovariance::from_measured(measured).ok_or(IdentificationError::OutputsDepend)?;
    let mut segments = Vec::with_capacity(spectra.len());
    for spectrum in spectra {
        let lines =
            SpectralLines::new(spectrum, &noise).ok_or(IdentificationError::OutputsDepend)?;
        segments.push(lines);
    }
    Ok(Likelihood::new(segments, executor))
}
