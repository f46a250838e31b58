//! Checks on the data for an identification: what makes it impossible, and what raises a caution
//! (M14.10, M14.12, M14.13).
//!
//! A *segment* is a stretch of a record on a uniform grid, its *lines* are its spectrum at discrete
//! frequencies. A *reference* is a recorded signal that drove the loop from outside; references are
//! the last inputs in the records, but no inputs of the model.

use std::f64::consts::{PI, TAU};

use nalgebra::DMatrix;

use gdcm_model::dataset::channel::ChannelSide;
use gdcm_model::simulation::{FlightRecord, Segment, centred};

use crate::diagnostics::cautions::IdentificationCaution;
use crate::identification_error::IdentificationError;
use crate::options::Options;
use crate::spectra::cut_off::CutOff;
use crate::spectra::filled_segment::FilledSegment;
use crate::spectra::record_cautions::RecordCaution;
use crate::spectra::response_estimate::ResponseEstimate;
use crate::spectra::spectrum::Spectrum;
use crate::subspace::tried_orders::{VALUES_PER_PARAMETER, parameters_of_order};

/// Inputs depend on each other if their correlation matrix has a higher condition number than this.
const DEPENDENT_CONDITION: f64 = 1e9;
/// An input is involved in a dependence if its entry in the eigenvector exceeds this share of the
/// largest.
const INVOLVED: f64 = 0.1;
/// Upper end of the band, relative to the highest spectral line used (M14.9).
const BAND_END: f64 = 0.75;
/// Minimum length of the longest segment, in periods at the lower end of the band (M14.12).
const LEAST_PERIODS: f64 = 1.5;
/// Recommended length of the longest segment, in periods at the lower end of the band (M14.12).
const BETTER_PERIODS: f64 = 5.0;
/// Recommended periods for each input if there is only one segment.
const PERIODS_AN_INPUT: f64 = 3.0;

/// Returns an error for held-out records that do not exist.
pub(super) fn check_held_out(
    records: &[FlightRecord],
    options: &Options,
) -> Result<(), IdentificationError> {
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

/// Returns an error for a band whose highest line is above half the sampling frequency.
pub(super) fn check_sampling(
    segments: &[Segment],
    options: &Options,
) -> Result<(), IdentificationError> {
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
pub(super) fn check_length(
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
    check_value_count(filled.len(), lines)?;
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

/// Returns an error for lines with too few real values for a first-order model (M14.13). Each line
/// has two for each output; as many are lost in each segment to its unknown step and drift
/// (`cost`).
fn check_value_count(segments: usize, lines: &[Spectrum]) -> Result<(), IdentificationError> {
    let inputs = lines.first().map_or(0, |lines| lines.inputs.nrows());
    let outputs = lines.first().map_or(0, |lines| lines.outputs.nrows());
    let count: usize = lines.iter().map(|lines| lines.omega.len()).sum();
    let values = (2 * outputs * count).saturating_sub(2 * outputs * segments);
    let unknowns = parameters_of_order(1, inputs, outputs);
    let needed = VALUES_PER_PARAMETER * unknowns;
    if values < needed {
        return Err(IdentificationError::TooFewFigures {
            figures: values,
            needed,
            unknowns,
        });
    }
    Ok(())
}

/// Returns an error if inputs depend on each other, judged by the condition number of their
/// correlation matrix.
pub(super) fn check_inputs(
    segments: &[Segment],
    options: &Options,
) -> Result<(), IdentificationError> {
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
    if eigen.eigenvalues[least] * DEPENDENT_CONDITION > eigen.eigenvalues.max() {
        return Ok(());
    }
    let dependence = eigen.eigenvectors.column(least);
    let involved = (0..inputs)
        .filter(|&input| dependence[input].abs() > INVOLVED * dependence.amax())
        .map(|input| options.signal(ChannelSide::Input, input))
        .collect();
    Err(IdentificationError::InputsDepend(involved))
}

/// Keeps only the cautions about channels of the model: a reference may well move together with an
/// input, or copy it.
pub(super) fn model_cautions(
    cautions: Vec<RecordCaution>,
    options: &Options,
) -> Vec<IdentificationCaution> {
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
pub(super) fn band_caution(
    measured: &ResponseEstimate,
    options: &Options,
) -> Option<IdentificationCaution> {
    let shown = measured.shown_band(options.band)?;
    Some(IdentificationCaution::BandNotShown {
        band: options.band,
        shown,
    })
}

/// Returns a caution for each output whose vibration lowered the cut-off.
pub(super) fn vibration_cautions(
    cut_off: &CutOff,
    options: &Options,
) -> Vec<IdentificationCaution> {
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
pub(super) fn excitation_cautions(
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
