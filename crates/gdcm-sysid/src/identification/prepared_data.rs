//! Prepares the data to which models are fitted and by which they are assessed, in scaled units.
//!
//! A *segment* is a stretch of a record on a uniform grid, its *lines* are its spectrum at discrete
//! frequencies (`spectrum`), and in *scaled units* each channel is divided by its rms (`scales`). A
//! *reference* is a recorded signal that drove the loop from outside (M14.15); the *projections*
//! are those of CT-PBSID (`subspace`).

use gdcm_model::dataset::StateSpace;
use gdcm_model::dataset::channel::ChannelSide;
use gdcm_model::executor::Executor;
use gdcm_model::progress::Shares;
use gdcm_model::simulation::{FlightRecord, Segment};

use super::candidates::SubspaceSettings;
use super::data_checks::{
    band_caution, check_held_out, check_inputs, check_length, check_sampling, excitation_cautions,
    model_cautions, vibration_cautions,
};
use super::measured_lines::{Measurement, SegmentLines, driven_segments, weigh};
use super::split_segments::{SplitFilled, SplitSegments, scale_all, scale_filled};
use crate::diagnostics::cautions::IdentificationCaution;
use crate::diagnostics::departure::MeasuredData;
use crate::identification_error::IdentificationError;
use crate::likelihood::cost::Likelihood;
use crate::likelihood::schur_model::SchurModel;
use crate::options::Options;
use crate::spectra::cut_off::CutOff;
use crate::spectra::preparation::{prepare, prepare_filled};
use crate::spectra::record_use::RecordUse;
use crate::spectra::response_estimate::ResponseEstimate;
use crate::spectra::scales::Scales;
use crate::spectra::spectrum::{LineRange, Spectrum};
use crate::subspace::tried_orders::DataExtent;

/// The prepared records, their spectral lines and the weighted cost.
#[derive(Clone)]
pub(crate) struct PreparedData<'a> {
    /// The parts used from every record.
    pub(crate) record_uses: Vec<RecordUse>,
    /// Factors from scaled units to record units.
    pub(crate) scales: Scales,
    /// Segments to fit, without gaps, low-passed and thinned for the projections.
    pub(crate) segments: Vec<Segment>,
    /// Segments to fit, without gaps and without the low-pass.
    pub(crate) unfiltered: Vec<Segment>,
    /// Frequency range of the lines for the measured response.
    pub(crate) measured_range: LineRange,
    /// Held-out segments without gaps, in record units.
    pub(crate) held_out_segments: Vec<Segment>,
    /// Spectral lines to fit, from records that are cut only at gaps too long to be estimated; with
    /// a reference, the lines measured through it.
    pub(crate) spectra: Vec<Spectrum>,
    /// Lines from the segments without gaps, in the fitted range.
    gap_free_spectra: Vec<Spectrum>,
    pub(crate) measured: ResponseEstimate,
    /// The cost over the fitted records.
    pub(crate) likelihood: Likelihood<'a>,
    /// The cost over the lines as logged, if the fit uses lines measured through a reference
    /// (M14.15).
    pub(crate) direct: Option<Likelihood<'a>>,
    /// The cost over the held-out records.
    pub(crate) held_out: Likelihood<'a>,
    /// Whether the engineer chose the orders.
    pub(crate) are_orders_given: bool,
    /// Highest line used \[rad/s\].
    pub(crate) highest: f64,
    /// Doubts about the records.
    pub(crate) cautions: Vec<IdentificationCaution>,
}

impl<'a> PreparedData<'a> {
    /// Prepares the records and measures response and noise (M14.1, M14.2).
    ///
    /// ```text
    /// 1  segments on a uniform grid, with held-out records and references separated
    /// 2  scales; an error for inputs that depend on each other
    /// 3  spectral lines, the measured response and the noise covariance
    /// 4  line weights, for the fit and for the held-out records
    /// 5  low-pass for the projections
    /// ```
    ///
    /// The measured response and the projections come from segments without gaps; the lines to fit
    /// come from whole records with filled gaps, where missing samples are unknowns (M14.21). With
    /// a reference, all lines come from segments without gaps.
    pub(crate) fn new(
        records: &[FlightRecord],
        options: &Options,
        executor: &'a dyn Executor,
        progress: &Shares,
    ) -> Result<Self, IdentificationError> {
        // Step 1.
        check_held_out(records, options)?;
        let fitted_range = LineRange {
            lowest: options.lowest(),
            highest: options.highest(),
        };
        let prepared = if options.references == 0 {
            prepare_filled(records, &options.preparation, fitted_range, executor)?
        } else {
            prepare(records, &options.preparation, executor)?
        };
        check_sampling(&prepared.segments, options)?;
        let filled = SplitFilled::new(prepared.filled, options);
        let SplitSegments {
            to_fit,
            references,
            held_out: held_out_segments,
        } = SplitSegments::new(prepared.segments, options);
        if to_fit.is_empty() {
            return Err(IdentificationError::NothingToFit);
        }
        // Step 2.
        let scales = Scales::from_segments(&to_fit)?;
        let segments = scale_all(&scales, &to_fit);
        check_inputs(&segments, options)?;

        // Step 3.
        progress.next(0.02, "measured response")?;
        let filled_to_fit = scale_filled(&scales, &filled.to_fit);
        let lines = SegmentLines::new(&segments, &filled_to_fit, fitted_range, executor);
        let too_short = check_length(&filled_to_fit, &lines.to_fit, options)?;
        let measured_range = lines.measured_range;
        let gap_free_spectra = lines.gap_free_in_fitted_range();
        let Measurement {
            measured,
            spectra,
            direct,
        } = if options.references == 0 {
            lines.measure(executor)?
        } else {
            let driven = driven_segments(&segments, references)?;
            let outputs = options.preparation.outputs.len();
            lines.measure_through_reference(&driven, outputs, executor)?
        };
        // Step 4.
        let likelihood = weigh(&spectra, &measured, executor)?;
        let held_out_lines =
            fitted_range.filled_spectra(&scale_filled(&scales, &filled.held_out), executor);
        let held_out = weigh(&held_out_lines, &measured, executor)?;

        // Step 5.
        progress.next(0.07, "low-pass")?;
        let cut_off = CutOff::choose(&segments, fitted_range.highest, executor);
        let mut cautions = model_cautions(prepared.cautions, options);
        cautions.extend(too_short);
        cautions.extend(vibration_cautions(&cut_off, options));
        cautions.extend(excitation_cautions(&measured, options));
        cautions.extend(band_caution(&measured, options));
        Ok(Self {
            record_uses: prepared.records,
            scales,
            segments: cut_off.apply(&segments, executor),
            unfiltered: segments,
            measured_range,
            held_out_segments,
            spectra,
            gap_free_spectra,
            measured,
            likelihood,
            direct,
            held_out,
            are_orders_given: options.orders.is_some(),
            highest: fitted_range.highest,
            cautions,
        })
    }

    /// Returns the options as CT-PBSID settings. Orders and past windows that are not set follow
    /// from the amount of data (M14.13).
    pub(crate) fn subspace_settings(&self, options: &Options) -> SubspaceSettings {
        let outputs = self.scales.outputs.len();
        let highest = options.band[1];
        let extent = DataExtent {
            inputs: self.scales.inputs.len(),
            outputs,
            // The real values in the lines, less those for the segments' steps and drifts (`cost`).
            real_values: 2 * outputs * self.line_count().saturating_sub(self.spectra.len()),
            radians: self.duration_s() * highest,
        };
        let pasts = match &options.pasts {
            Some(pasts) => pasts.clone(),
            None => extent.pasts(),
        };
        let longest_past = pasts.iter().copied().max().unwrap_or_default();
        let mut orders = match &options.orders {
            Some(orders) => orders.clone(),
            None => extent.orders(longest_past),
        };
        orders.sort_unstable();
        orders.dedup();
        SubspaceSettings {
            highest,
            poles: options.poles.iter().map(|pole| pole * highest).collect(),
            pasts,
            orders,
            longest_future: extent.longest_future(),
        }
    }

    /// Returns the same data with the records to fit cut at their gaps; `None` if no input misses
    /// samples, or the pieces have no weights.
    pub(crate) fn cut_at_missing_inputs(&self) -> Option<Self> {
        let mut hats = self.spectra.iter().flat_map(|spectrum| &spectrum.hats);
        if !hats.any(|hat| hat.side == ChannelSide::Input) {
            return None;
        }
        let spectra = self.gap_free_spectra.clone();
        let likelihood = weigh(&spectra, &self.measured, self.likelihood.executor).ok()?;
        Some(Self {
            spectra,
            likelihood,
            ..self.clone()
        })
    }

    /// Converts a model to record units: each response is multiplied by its output's scale over its
    /// input's scale. `None` if the model is not finite.
    pub(crate) fn in_units(&self, model: &SchurModel) -> Option<StateSpace> {
        let mut b = model.b().clone();
        let mut c = model.c().clone();
        let mut d = model.d().clone();
        for (input, scale) in self.scales.inputs.iter().enumerate() {
            b.column_mut(input).unscale_mut(*scale);
            d.column_mut(input).unscale_mut(*scale);
        }
        for (output, scale) in self.scales.outputs.iter().enumerate() {
            c.row_mut(output).scale_mut(*scale);
            d.row_mut(output).scale_mut(*scale);
        }
        StateSpace::new(model.a().clone(), b, c, d).ok()
    }

    pub(crate) fn measured_data(&self) -> MeasuredData<'_> {
        MeasuredData {
            spectra: &self.gap_free_spectra,
            measured: &self.measured,
            executor: self.likelihood.executor,
        }
    }

    pub(crate) fn no_model(&self) -> IdentificationError {
        IdentificationError::NoModel {
            lines: self.line_count(),
            seconds: self.duration_s(),
        }
    }

    /// Counts the lines to fit.
    fn line_count(&self) -> usize {
        self.spectra
            .iter()
            .map(|spectrum| spectrum.omega.len())
            .sum()
    }

    /// Returns the total length of the fitted segments without gaps \[s\].
    fn duration_s(&self) -> f64 {
        self.gap_free_spectra
            .iter()
            .map(|spectrum| spectrum.duration_s)
            .sum()
    }
}
