//! Prepares the data to which models are fitted and by which they are assessed, in scaled units.
//!
//! A *segment* is a stretch of a record on a uniform grid, its *lines* are its spectrum at discrete
//! frequencies (`spectrum`), and in *scaled units* each channel is divided by its rms (`scales`). A
//! *reference* is a recorded signal that drove the loop from outside (M14.15); the *projections*
//! are those of CT-PBSID (`subspace`). *Figures* are real values in the lines: two for each output.

use std::f64::consts::{PI, TAU};

use nalgebra::DMatrix;

use gdcm_model::dataset::StateSpace;
use gdcm_model::dataset::channel::ChannelSide;
use gdcm_model::executor::Executor;
use gdcm_model::progress::Shares;
use gdcm_model::response::frequency_grid::log_spaced;
use gdcm_model::simulation::{FlightRecord, Segment, centred};

use super::candidates::SubspaceSettings;
use crate::diagnostics::cautions::IdentificationCaution;
use crate::diagnostics::departure::MeasuredData;
use crate::identification_error::IdentificationError;
use crate::likelihood::cost::Likelihood;
use crate::likelihood::noise_covariance::NoiseCovariance;
use crate::likelihood::schur_model::SchurModel;
use crate::likelihood::spectral_lines::SpectralLines;
use crate::options::Options;
use crate::spectra::cut_off::CutOff;
use crate::spectra::filled_segment::FilledSegment;
use crate::spectra::local_polynomial::local_polynomial;
use crate::spectra::local_polynomial_error::LocalPolynomialError;
use crate::spectra::preparation::{prepare, prepare_filled};
use crate::spectra::record_cautions::RecordCaution;
use crate::spectra::record_use::RecordUse;
use crate::spectra::reference_response::ReferenceResponse;
use crate::spectra::response_estimate::ResponseEstimate;
use crate::spectra::scales::{Scales, ScalingError};
use crate::spectra::spectrum::{LineRange, Spectrum};
use crate::subspace::tried_orders::{DataExtent, VALUES_PER_PARAMETER, parameters_of_order};

/// Number of frequencies at which the response is measured.
const MEASURED_POINTS: usize = 40;
/// Ratio of the highest line used for the measured response to the highest line that is fitted: the
/// window around a point reaches beyond its frequency.
const BEYOND: f64 = 1.3;
/// Inputs depend on each other if their correlation matrix has a higher condition number than this.
const COPY: f64 = 1e9;
/// An input is involved in a dependence if its entry in the eigenvector exceeds this share of the
/// largest.
const INVOLVED: f64 = 0.1;
/// Upper end of the band, relative to the highest spectral line used.
const BAND_END: f64 = 0.75;
/// Minimum length of the longest segment, in periods at the lower end of the band (M14.12).
const LEAST_PERIODS: f64 = 1.5;
/// Recommended length of the longest segment, in periods at the lower end of the band (M14.12).
const BETTER_PERIODS: f64 = 5.0;
/// Recommended periods for each input if there is only one segment.
const PERIODS_AN_INPUT: f64 = 3.0;

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
    pub(crate) lines: LineRange,
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
        let used = LineRange {
            lowest: options.lowest(),
            highest: options.highest(),
        };
        let prepared = if options.references == 0 {
            prepare_filled(records, &options.preparation, used, executor)?
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
        let lines = Lines::new(&segments, &filled_to_fit, used, executor);
        let too_short = check_length(&filled_to_fit, &lines.to_fit, options)?;
        let reach = lines.reach;
        let gap_free_spectra = lines.narrow();
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
            used.filled_spectra(&scale_filled(&scales, &filled.held_out), executor);
        let held_out = weigh(&held_out_lines, &measured, executor)?;

        // Step 5.
        progress.next(0.07, "low-pass")?;
        let cut_off = CutOff::choose(&segments, used.highest, executor);
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
            lines: reach,
            held_out_segments,
            spectra,
            gap_free_spectra,
            measured,
            likelihood,
            direct,
            held_out,
            are_orders_given: options.orders.is_some(),
            highest: used.highest,
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

/// Returns an error for held-out records that do not exist.
fn check_held_out(records: &[FlightRecord], options: &Options) -> Result<(), IdentificationError> {
    for &record in &options.held_out {
        if record >= records.len() {
            return Err(IdentificationError::HeldOutMissing {
                record,
                records: records.len(),
            });
        }
    }
    Ok(())
}

/// Segments to fit and held-out segments, without the references among their inputs.
struct SplitSegments {
    to_fit: Vec<Segment>,
    /// References for each fitted segment, samples x references.
    references: Vec<DMatrix<f64>>,
    held_out: Vec<Segment>,
}

impl SplitSegments {
    fn new(segments: Vec<Segment>, options: &Options) -> Self {
        let mut split = Self {
            to_fit: Vec::new(),
            references: Vec::new(),
            held_out: Vec::new(),
        };
        for mut segment in segments {
            let references = take_references(&mut segment, options.references);
            if options.held_out.contains(&segment.record) {
                split.held_out.push(segment);
            } else {
                split.references.push(references);
                split.to_fit.push(segment);
            }
        }
        split
    }
}

/// Filled segments, to fit or held out, without the references among their inputs.
struct SplitFilled {
    to_fit: Vec<FilledSegment>,
    held_out: Vec<FilledSegment>,
}

impl SplitFilled {
    fn new(filled: Vec<FilledSegment>, options: &Options) -> Self {
        let mut split = Self {
            to_fit: Vec::new(),
            held_out: Vec::new(),
        };
        for mut part in filled {
            // With references, segments have no gaps, so that no gap lies in a removed reference.
            take_references(&mut part.segment, options.references);
            if options.held_out.contains(&part.segment.record) {
                split.held_out.push(part);
            } else {
                split.to_fit.push(part);
            }
        }
        split
    }
}

/// Removes the last `references` inputs from a segment and returns them.
fn take_references(segment: &mut Segment, references: usize) -> DMatrix<f64> {
    let inputs = segment.inputs.ncols().saturating_sub(references);
    let taken = segment
        .inputs
        .columns(inputs, segment.inputs.ncols() - inputs)
        .into_owned();
    segment.inputs = segment.inputs.columns(0, inputs).into_owned();
    taken
}

fn scale_all(scales: &Scales, segments: &[Segment]) -> Vec<Segment> {
    segments
        .iter()
        .map(|segment| scales.scaled(segment))
        .collect()
}

fn scale_filled(scales: &Scales, filled: &[FilledSegment]) -> Vec<FilledSegment> {
    let mut scaled = Vec::with_capacity(filled.len());
    for part in filled {
        scaled.push(FilledSegment {
            segment: scales.scaled(&part.segment),
            gaps: part.gaps.clone(),
        });
    }
    scaled
}

/// Returns scaled segments with the references as inputs, and outputs and inputs as outputs.
fn driven_segments(
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

/// The measured response and the lines to fit.
struct Measurement<'a> {
    measured: ResponseEstimate,
    spectra: Vec<Spectrum>,
    /// The cost over the lines as logged, if a reference is used.
    direct: Option<Likelihood<'a>>,
}

/// Spectral lines from all fitted segments.
struct Lines {
    /// Frequency range of the lines to fit.
    used: LineRange,
    /// Frequency range of the lines for the measured response.
    reach: LineRange,
    /// Lines from the segments without gaps, for the measured response.
    wide: Vec<Spectrum>,
    to_fit: Vec<Spectrum>,
}

impl Lines {
    fn new(
        segments: &[Segment],
        filled: &[FilledSegment],
        used: LineRange,
        executor: &dyn Executor,
    ) -> Self {
        let reach = LineRange {
            highest: BEYOND * used.highest,
            ..used
        };
        Self {
            used,
            reach,
            wide: reach.spectra(segments, executor),
            to_fit: used.filled_spectra(filled, executor),
        }
    }

    /// Returns the lines from the segments without gaps, in the fitted range only.
    fn narrow(&self) -> Vec<Spectrum> {
        let mut narrow = Vec::with_capacity(self.wide.len());
        for spectrum in &self.wide {
            narrow.push(spectrum.between(self.used.lowest, self.used.highest));
        }
        narrow
    }

    /// Measures the response from inputs to outputs.
    fn measure<'a>(self, executor: &dyn Executor) -> Result<Measurement<'a>, LocalPolynomialError> {
        Ok(Measurement {
            measured: self.measure_response(executor)?,
            spectra: self.to_fit,
            direct: None,
        })
    }

    /// Measures the response through the references in the `driven` segments; see
    /// [`ReferenceResponse`].
    fn measure_through_reference<'a>(
        self,
        driven: &[Segment],
        outputs: usize,
        executor: &'a dyn Executor,
    ) -> Result<Measurement<'a>, IdentificationError> {
        let driven_lines = self.reach.spectra(driven, executor);
        let response = ReferenceResponse::new(&driven_lines, self.used, outputs, executor)?;
        let logged = self.measure_response(executor)?;
        Ok(Measurement {
            measured: response.measured,
            spectra: response.spectra,
            direct: Some(weigh(&self.to_fit, &logged, executor)?),
        })
    }

    /// Measures the response from the first line up to the highest line used.
    fn measure_response(
        &self,
        executor: &dyn Executor,
    ) -> Result<ResponseEstimate, LocalPolynomialError> {
        let highest = self.used.highest;
        let first = self
            .wide
            .iter()
            .filter_map(|spectrum| spectrum.omega.first().copied())
            .fold(highest, f64::min);
        let omegas = log_spaced(first, highest, MEASURED_POINTS);
        local_polynomial(&self.wide, &omegas, executor)
    }
}

/// Weights lines by the measured noise; an error if it is singular at a line.
fn weigh<'a>(
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

/// Returns an error for a band whose highest line is above half the sampling frequency.
fn check_sampling(segments: &[Segment], options: &Options) -> Result<(), IdentificationError> {
    let sample_time_s = segments
        .iter()
        .map(|segment| segment.sample_time_s)
        .fold(0.0, f64::max);
    let nyquist = PI / sample_time_s;
    if options.highest() <= nyquist {
        return Ok(());
    }
    Err(IdentificationError::SampledTooSlowly {
        highest: options.band[1],
        sample_time_s,
        limit: BAND_END * nyquist,
    })
}

/// Returns a caution if the longest segment is shorter than recommended (M14.12).
///
/// Returns an error if this segment is too short for the lower end of the band, or if the lines
/// hold too few values for a first-order model.
fn check_length(
    filled: &[FilledSegment],
    lines: &[Spectrum],
    options: &Options,
) -> Result<Option<IdentificationCaution>, IdentificationError> {
    let lowest = options.band[0];
    let period_s = TAU / lowest;
    let longest_s = filled
        .iter()
        .map(|part| part.segment.duration_s())
        .fold(0.0, f64::max);
    let periods_of_inputs = if filled.len() == 1 {
        options.inputs() as f64 * PERIODS_AN_INPUT
    } else {
        0.0
    };
    let better_s = BETTER_PERIODS.max(periods_of_inputs) * period_s;
    let needed_s = LEAST_PERIODS * TAU / lowest;
    if longest_s < needed_s {
        return Err(IdentificationError::TooShort {
            longest_s,
            lowest,
            needed_s,
            better_s,
            enough: LEAST_PERIODS * TAU / longest_s,
        });
    }
    check_figures(filled.len(), lines)?;
    let periods = longest_s * lowest / TAU;
    if periods >= BETTER_PERIODS {
        return Ok(None);
    }
    Ok(Some(IdentificationCaution::Short {
        longest_s,
        lowest,
        periods,
        better_s,
    }))
}

/// Returns an error for lines with too few real values for a first-order model (M14.13).
fn check_figures(segments: usize, lines: &[Spectrum]) -> Result<(), IdentificationError> {
    let inputs = lines.first().map_or(0, |lines| lines.inputs.nrows());
    let outputs = lines.first().map_or(0, |lines| lines.outputs.nrows());
    let count: usize = lines.iter().map(|lines| lines.omega.len()).sum();
    let figures = (2 * outputs * count).saturating_sub(2 * outputs * segments);
    let unknowns = parameters_of_order(1, inputs, outputs);
    let needed = VALUES_PER_PARAMETER * unknowns;
    if figures < needed {
        return Err(IdentificationError::TooFewFigures {
            figures,
            needed,
            unknowns,
        });
    }
    Ok(())
}

/// Returns an error if inputs depend on each other, judged by the condition number of their
/// correlation matrix.
fn check_inputs(segments: &[Segment], options: &Options) -> Result<(), IdentificationError> {
    let inputs = options.inputs();
    let mut gram = DMatrix::<f64>::zeros(inputs, inputs);
    for segment in segments {
        let centred = centred(segment.inputs.clone());
        gram += centred.tr_mul(&centred);
    }
    let scales = gram.diagonal().map(f64::sqrt);
    let correlation = gram.component_div(&(&scales * scales.transpose()));
    let eigen = correlation.symmetric_eigen();
    let least = eigen.eigenvalues.imin();
    if eigen.eigenvalues[least] * COPY > eigen.eigenvalues.max() {
        return Ok(());
    }
    let dependence = eigen.eigenvectors.column(least);
    let involved = (0..inputs)
        .filter(|&input| dependence[input].abs() > INVOLVED * dependence.amax())
        .map(|input| options.signal(ChannelSide::Input, input))
        .collect();
    Err(IdentificationError::InputsDepend(involved))
}

/// Keeps only the cautions about model channels: a reference may move together with an input.
fn model_cautions(cautions: Vec<RecordCaution>, options: &Options) -> Vec<IdentificationCaution> {
    let mut kept = Vec::new();
    for caution in cautions {
        let is_about_model = match &caution {
            RecordCaution::MovedTogether { signals, .. } => {
                signals.iter().all(|signal| signal.index < options.inputs())
            }
            RecordCaution::Copy { of, .. } => {
                of.role == ChannelSide::Output || of.index < options.inputs()
            }
            _ => true,
        };
        if is_about_model {
            kept.push(IdentificationCaution::Records(caution));
        }
    }
    kept
}

/// Returns a caution if the records show no response at an end of the band.
fn band_caution(measured: &ResponseEstimate, options: &Options) -> Option<IdentificationCaution> {
    let shown = measured.shown_band(options.band)?;
    Some(IdentificationCaution::BandNotShown {
        band: options.band,
        shown,
    })
}

fn vibration_cautions(cut_off: &CutOff, options: &Options) -> Vec<IdentificationCaution> {
    let mut cautions = Vec::new();
    for &(output, share) in &cut_off.vibrating {
        cautions.push(IdentificationCaution::Vibration {
            signal: options.signal(ChannelSide::Output, output),
            percent: 100.0 * share,
            cut_off: cut_off.omega,
        });
    }
    cautions
}

/// Returns cautions about inputs that were not moved, or moved only together with others.
fn excitation_cautions(
    measured: &ResponseEstimate,
    options: &Options,
) -> Vec<IdentificationCaution> {
    let excitation = measured.excitation();
    let mut cautions = Vec::new();
    for input in excitation.not_identified() {
        cautions.push(IdentificationCaution::NotSwept {
            signal: options.signal(ChannelSide::Input, input),
            partial_coherence: excitation.partial_coherence[input],
        });
    }
    if excitation.moved_together() {
        cautions.push(IdentificationCaution::MovedTogether {
            condition: excitation.condition,
        });
    }
    cautions
}
