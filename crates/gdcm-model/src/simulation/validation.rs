//! Validation in the time domain: simulates a model and compares it with flight records.

use super::first_order_hold::FirstOrderHold;
use super::flight_record::Segment;
use super::low_pass::LowPass;
use super::output_agreement::{Agreement, ValidationWindow, agreement, column_deviations};
use super::validation_settings::{
    TIME_CONSTANTS, ValidationSettings, window_count, window_length_s, window_start,
};
use super::window_simulation::best_simulation;
use crate::dataset::StateSpace;
use crate::executor::{Executor, each};

/// Validates `model`, in the file's units, against `segments` in the time domain (M14.6). The
/// windows are short enough for an unstable model, and each has its own initial state and output
/// offsets.
///
/// ```text
/// 1  window: longest_window_s, or 3 / max Re lambda over the poles lambda if this is positive
///    and shorter; each segment is divided into equal windows without a remainder; a segment
///    that is too short has none
/// 2  low-pass filter of all signals, if the settings have one
/// 3  y^ = C Phi^n x0 + offset + response to (u - mean u), inputs linear between samples,
///    Phi = e^(A T); n counts the samples in the window, T is the sample time
///    x0, offset: least squares over all outputs, each divided by its standard deviation
/// 4  fit and Theil's coefficient of each output, over all windows
/// ```
///
/// # Errors
/// [`ValidationError`] if there are no segments, the channels differ from the model's, the window
/// length is not positive, the model cannot be simulated, its outputs are not finite, or all
/// windows are too short.
pub fn validate(
    model: &StateSpace,
    segments: &[Segment],
    settings: &ValidationSettings,
    executor: &dyn Executor,
) -> Result<Validation, ValidationError> {
    if segments.is_empty() {
        return Err(ValidationError::NoSegments);
    }
    for segment in segments {
        if (segment.outputs.ncols(), segment.inputs.ncols()) != model.d().shape() {
            return Err(ValidationError::ChannelsDiffer(segment.record));
        }
    }
    if settings.longest_window_s.is_nan() || settings.longest_window_s <= 0.0 {
        return Err(ValidationError::NoWindow);
    }
    // Step 1.
    let window_s =
        window_length_s(model, settings.longest_window_s).ok_or(ValidationError::NotSimulated)?;
    // Step 2.
    let filtered = each(executor, segments, |segment| match settings.low_pass {
        Some(omega) => LowPass::applied(omega, segment),
        None => segment.clone(),
    });
    // Step 3.
    let std = column_deviations(filtered.iter().map(|segment| &segment.outputs));
    let windows = each(executor, &filtered, |segment| {
        simulated_windows(model, segment, window_s, &std)
    });
    let windows: Vec<ValidationWindow> = windows
        .into_iter()
        .collect::<Result<Vec<_>, _>>()?
        .into_iter()
        .flatten()
        .collect();
    if windows.is_empty() {
        return Err(ValidationError::TooShort(window_s));
    }
    // Step 4.
    let Agreement { fit_percent, theil } = agreement(&windows);
    Ok(Validation {
        windows,
        fit_percent,
        theil,
    })
}

/// Simulates the windows in a segment; empty if it is too short. `std` contains each output's
/// standard deviation.
fn simulated_windows(
    model: &StateSpace,
    segment: &Segment,
    window_s: f64,
    std: &[f64],
) -> Result<Vec<ValidationWindow>, ValidationError> {
    let discretised =
        FirstOrderHold::new(model, segment.sample_time_s).ok_or(ValidationError::NotSimulated)?;
    let Some(count) = window_count(model, segment, window_s) else {
        return Ok(Vec::new());
    };
    let samples = segment.outputs.nrows();
    let longest = samples.div_ceil(count);
    let free = discretised.free_responses(longest);
    let mut windows = Vec::with_capacity(count);
    for k in 0..count {
        let from = window_start(k, count, samples);
        let length = window_start(k + 1, count, samples) - from;
        let measured = segment.outputs.rows(from, length).into_owned();
        let inputs = segment.inputs.rows(from, length).into_owned();
        let simulated = best_simulation(&discretised, &free, inputs, &measured, std)
            .ok_or(ValidationError::NotFinite)?;
        windows.push(ValidationWindow {
            record: segment.record,
            start_s: segment.start_s + segment.sample_time_s * from as f64,
            sample_time_s: segment.sample_time_s,
            measured,
            simulated,
        });
    }
    Ok(windows)
}

/// A model's agreement with flight records in the time domain.
#[derive(Clone, Debug, PartialEq)]
pub struct Validation {
    /// The windows, by segment and time; at least one.
    pub windows: Vec<ValidationWindow>,
    /// Each output's fit, `100 (1 - rms(y - y^) / std(y))` with measured output y and simulated
    /// output y^, at most 100; `None` if the measured output is constant.
    pub fit_percent: Vec<Option<f64>>,
    /// Each output's Theil coefficient, `rms(y - y^) / (rms(y) + rms(y^))` with the rms values of y
    /// and y^ about the mean of y, 0 to 1; `None` if both are constant and equal.
    pub theil: Vec<Option<f64>>,
}

/// Error for a model that cannot be compared with flight records in the time domain.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum ValidationError {
    #[error("no record is available for the comparison with the model")]
    NoSegments,
    /// The model's channel counts differ from a segment's; holds the index of the segment's record,
    /// counted from 0.
    #[error("the channels of record {} differ from those of the model", .0 + 1)]
    ChannelsDiffer(usize),
    /// A model that cannot be discretised, or whose poles cannot be computed.
    #[error("the model cannot be simulated: its poles or its discretisation could not be computed")]
    NotSimulated,
    #[error("the window length must be greater than 0 s")]
    NoWindow,
    /// Too few samples to estimate an initial state; holds the window length \[s\].
    #[error(
        "windows of {0:.2} s (limited by the record, or by {TIME_CONSTANTS} time constants of the \
        model's fastest diverging mode) contain too few samples to estimate the initial state"
    )]
    TooShort(f64),
    #[error("the simulated outputs are not finite")]
    NotFinite,
}

impl ValidationError {
    /// Returns the stable code by which scripts and tests distinguish the errors.
    pub fn code(&self) -> &'static str {
        match self {
            Self::NoSegments => "no-segments",
            Self::ChannelsDiffer(..) => "channels-differ",
            Self::NotSimulated => "not-simulated",
            Self::NoWindow => "no-window",
            Self::TooShort(..) => "too-short",
            Self::NotFinite => "not-finite",
        }
    }
}
