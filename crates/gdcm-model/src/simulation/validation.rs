//! Validation in the time domain: simulation of a model and comparison with flight records.

use nalgebra::{DMatrix, DVector, RowDVector};

use super::first_order_hold::FirstOrderHold;
use super::flight_record::{Segment, centred};
use super::low_pass::LowPass;
use crate::dataset::StateSpace;
use crate::executor::{Executor, each};
use crate::response::mode::poles;

/// Maximum window length for an unstable model, in time constants of its fastest diverging mode
/// (M14, section 6).
const TIME_CONSTANTS: f64 = 3.0;
/// Minimum ratio of output samples to unknowns (initial state and offsets) in a window.
const SAMPLES_PER_UNKNOWN: usize = 3;
/// Excess of a segment over a whole number of windows that is attributed to rounding, in windows.
const WINDOW_SLACK: f64 = 1e-6;
/// Relative singular value below which a combination of unknowns is not estimated.
const RANK_TOLERANCE: f64 = 1e-9;

/// Settings for validation in the time domain.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ValidationSettings {
    /// Maximum window length \[s\].
    pub longest_window_s: f64,
    /// Cut-off frequency \[rad/s\] of the low-pass filter for inputs and outputs; `None` compares
    /// unfiltered signals.
    pub low_pass: Option<f64>,
}

impl ValidationSettings {
    /// Returns settings with 10 s windows and with signals low-pass filtered at twice `highest`
    /// \[rad/s\], the highest spectral line in use (M14, section 6).
    #[must_use]
    pub fn filtered(highest: f64) -> Self {
        Self {
            longest_window_s: 10.0,
            low_pass: Some(2.0 * highest),
        }
    }

    /// Returns settings with 10 s windows and unfiltered signals, for plots.
    #[must_use]
    pub fn unfiltered() -> Self {
        Self {
            longest_window_s: 10.0,
            low_pass: None,
        }
    }

    /// Returns the settings with a maximum window length that suits all models: the shortest of
    /// their window lengths. A model with too few samples in its own windows cannot be compared,
    /// and does not shorten the windows of the other models.
    #[must_use]
    pub fn common_to<'m>(
        self,
        models: impl IntoIterator<Item = &'m StateSpace>,
        segments: &[Segment],
    ) -> Self {
        let mut shortest_s = self.longest_window_s;
        for model in models {
            let Some(own_s) = window_s(model, self.longest_window_s) else {
                continue;
            };
            let is_compared = segments
                .iter()
                .any(|segment| window_count(model, segment, own_s).is_some());
            if is_compared {
                shortest_s = shortest_s.min(own_s);
            }
        }
        Self {
            longest_window_s: shortest_s,
            ..self
        }
    }
}

/// Measured and simulated outputs in a window of a record.
#[derive(Clone, Debug, PartialEq)]
pub struct ValidationWindow {
    /// Record index, counted from 0.
    pub record: usize,
    /// Time of the first sample \[s\], on the record's time axis.
    pub start_s: f64,
    /// Sample time \[s\].
    pub sample_time_s: f64,
    /// Measured outputs, filtered if requested: one row per sample, one column per output.
    pub measured: DMatrix<f64>,
    /// Simulated outputs: one row per sample, one column per output.
    pub simulated: DMatrix<f64>,
}

/// Agreement of a model with flight records in the time domain.
#[derive(Clone, Debug, PartialEq)]
pub struct Validation {
    /// The windows, by segment and time; at least one.
    pub windows: Vec<ValidationWindow>,
    /// Fit of each output, `100 (1 - rms(e) / std(y))`, at most 100; `None` if the output is
    /// constant.
    pub fit_percent: Vec<Option<f64>>,
    /// Theil's coefficient of each output, `rms(e) / (rms y + rms y^)` about the mean of y, 0 to 1;
    /// `None` if both are constant.
    pub theil: Vec<Option<f64>>,
}

/// Error for a model that cannot be compared with flight records in the time domain.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum ValidationError {
    #[error("no record is available for the comparison with the model")]
    NoSegments,
    /// The inputs or outputs differ from those of a segment; index of its record, counted from 0.
    #[error("the channels of record {} differ from those of the model", .0 + 1)]
    ChannelsDiffer(usize),
    /// A model that cannot be discretised, or whose poles cannot be computed.
    #[error("the model cannot be simulated: its poles or its discretisation could not be computed")]
    NotSimulated,
    #[error("the window length must be positive")]
    NoWindow,
    /// Too few samples for the estimate of an initial state; window length \[s\].
    #[error(
        "too short to compare in time: windows of {0:.2} s (limited by the record, or to \
        {TIME_CONSTANTS} time constants of the model's fastest diverging mode) contain too few \
        samples to estimate the initial state"
    )]
    TooShort(f64),
    #[error("the simulated outputs are not finite")]
    NotFinite,
}

/// Validates `model`, in the units of the file, against `segments` in the time domain (M14, section
/// 6). The windows are short enough for an unstable model, and each has its own initial state and
/// output offsets.
///
/// ```text
/// window: 3 / max Re lambda, at most longest_window_s; each segment is divided into equal windows without a remainder
/// y^ = C Phi^n x0 + offset + response to (u - mean u), inputs linear between samples
/// x0, offset: least squares over all outputs, each divided by its standard deviation
/// fit = 100 (1 - rms(y - y^) / std(y)),   Theil = rms(y - y^) / (rms(y) + rms(y^))
/// ```
///
/// # Errors
/// [`ValidationError`] if there are no segments, the channels differ from the model's, the model
/// cannot be simulated, or the windows are too short.
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
    let window_s =
        window_s(model, settings.longest_window_s).ok_or(ValidationError::NotSimulated)?;
    let filtered = each(executor, segments, |segment| match settings.low_pass {
        Some(omega) => LowPass::applied(omega, segment),
        None => segment.clone(),
    });
    let std = deviations(filtered.iter().map(|segment| &segment.outputs));
    let windows = each(executor, &filtered, |segment| {
        windows(model, segment, window_s, &std)
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
    let Agreement { fit_percent, theil } = agreement(&windows);
    Ok(Validation {
        windows,
        fit_percent,
        theil,
    })
}

/// Returns the window length \[s\]: `longest_s`, or less for an unstable model. `None` if the poles
/// cannot be computed.
fn window_s(model: &StateSpace, longest_s: f64) -> Option<f64> {
    let fastest = poles(model)?.iter().map(|pole| pole.re).fold(0.0, f64::max);
    Some(if fastest > 0.0 {
        longest_s.min(TIME_CONSTANTS / fastest)
    } else {
        longest_s
    })
}

/// Returns the number of equal windows in a segment; `None` if they have too few samples for the
/// estimate of an initial state.
fn window_count(model: &StateSpace, segment: &Segment, window_s: f64) -> Option<usize> {
    let (samples, outputs) = segment.outputs.shape();
    let count = (samples as f64 * segment.sample_time_s / window_s - WINDOW_SLACK)
        .ceil()
        .clamp(1.0, samples.max(1) as f64) as usize;
    if (samples / count) * outputs >= SAMPLES_PER_UNKNOWN * (model.order() + outputs) {
        Some(count)
    } else {
        None
    }
}

/// Simulates the windows of a segment; empty if it is too short. `std` holds the standard deviation
/// of each output.
fn windows(
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

/// Returns the index of the first sample in window `k`; uses 128 bits because the product may
/// overflow 64 bits.
fn window_start(k: usize, count: usize, samples: usize) -> usize {
    (samples as u128 * k as u128 / count as u128) as usize
}

/// Simulates `inputs` with the initial state and offsets that minimise the squared difference
/// between the outputs and `measured`, each output divided by its standard deviation in `std`;
/// `None` if the outputs are not finite.
///
/// `free` holds [`FirstOrderHold::free_responses`] for at least as many samples.
fn best_simulation(
    discretised: &FirstOrderHold,
    free: &DMatrix<f64>,
    inputs: DMatrix<f64>,
    measured: &DMatrix<f64>,
    std: &[f64],
) -> Option<DMatrix<f64>> {
    let (samples, outputs) = measured.shape();
    let states = free.ncols();
    let forced = discretised.simulate(&DVector::zeros(states), &centred(inputs));

    // Rows: one per sample n and output o, divided by the output's standard deviation. Columns:
    // initial states, offsets, right-hand side.
    let mut rows = DMatrix::zeros(samples * outputs, states + outputs + 1);
    for n in 0..samples {
        for (o, std) in std.iter().enumerate() {
            let mut row = rows.row_mut(n * outputs + o);
            row.columns_mut(0, states)
                .copy_from(&(free.row(n * outputs + o) / *std));
            row[states + o] = 1.0 / std;
            row[states + outputs] = (measured[(n, o)] - forced[(n, o)]) / std;
        }
    }
    let unknowns = solve(rows)?;
    let free_part = free.rows(0, samples * outputs) * unknowns.rows(0, states);
    let simulated = DMatrix::from_fn(samples, outputs, |n, o| {
        forced[(n, o)] + free_part[n * outputs + o] + unknowns[states + o]
    });
    if simulated.iter().all(|y| y.is_finite()) {
        Some(simulated)
    } else {
        None
    }
}

/// Returns the least-squares solution `x` of `a x = b`, given as `[a | b]`; of several solutions,
/// the one of minimum norm after scaling the columns of `a` to unit length. `None` if it is not
/// finite.
fn solve(rows: DMatrix<f64>) -> Option<DVector<f64>> {
    let unknowns = rows.ncols() - 1;
    if !rows.norm().is_finite() {
        return None;
    }
    let r = rows.qr().unpack_r();
    let mut a = r.view((0, 0), (unknowns, unknowns)).into_owned();
    let lengths = RowDVector::from_fn(unknowns, |_, column| {
        let length = a.column(column).norm();
        if length > 0.0 { length } else { 1.0 }
    });
    for (mut column, length) in a.column_iter_mut().zip(lengths.iter()) {
        column /= *length;
    }
    let svd = a.try_svd(true, true, f64::EPSILON, 100 * (unknowns + 1))?;
    let tolerance = RANK_TOLERANCE * svd.singular_values.max();
    let solution = svd
        .solve(
            &r.view((0, unknowns), (unknowns, 1)).into_owned(),
            tolerance,
        )
        .ok()?;
    Some(solution.column(0).component_div(&lengths.transpose()))
}

/// Returns the standard deviation of each column over all `parts`; 1 for a constant column.
fn deviations<'a>(parts: impl Iterator<Item = &'a DMatrix<f64>> + Clone) -> Vec<f64> {
    let means = means(parts.clone());
    let squares = sums(parts.clone(), |o, y| (y - means[o]).powi(2));
    let samples: usize = parts.map(DMatrix::nrows).sum();
    let mut deviations = Vec::with_capacity(squares.len());
    for square in squares {
        let std = (square / samples.max(1) as f64).sqrt();
        deviations.push(if std > 0.0 && std.is_finite() {
            std
        } else {
            1.0
        });
    }
    deviations
}

/// Returns the mean of each column over all `parts`.
fn means<'a>(parts: impl Iterator<Item = &'a DMatrix<f64>> + Clone) -> Vec<f64> {
    let samples: usize = parts.clone().map(DMatrix::nrows).sum();
    sums(parts, |_, y| y)
        .iter()
        .map(|sum| sum / samples.max(1) as f64)
        .collect()
}

/// Sums `term(column, value)` over all samples of all `parts`, for each column.
fn sums<'a>(
    parts: impl Iterator<Item = &'a DMatrix<f64>>,
    term: impl Fn(usize, f64) -> f64,
) -> Vec<f64> {
    let mut sums: Vec<f64> = Vec::new();
    for part in parts {
        sums.resize(part.ncols(), 0.0);
        for (o, column) in part.column_iter().enumerate() {
            sums[o] += column.iter().map(|y| term(o, *y)).sum::<f64>();
        }
    }
    sums
}

/// Agreement of each output over all windows.
struct Agreement {
    fit_percent: Vec<Option<f64>>,
    theil: Vec<Option<f64>>,
}

/// Computes the fit \[%\] and Theil's coefficient of each output.
fn agreement(windows: &[ValidationWindow]) -> Agreement {
    let measured = windows.iter().map(|window| &window.measured);
    let means = means(measured.clone());
    let errors: Vec<DMatrix<f64>> = windows
        .iter()
        .map(|window| &window.measured - &window.simulated)
        .collect();
    let error = sums(errors.iter(), |_, e| e * e);
    let power = sums(measured, |o, y| (y - means[o]).powi(2));
    let simulated = sums(windows.iter().map(|window| &window.simulated), |o, y| {
        (y - means[o]).powi(2)
    });
    // Sums replace rms and standard deviation: all run over the same samples, so that the number of
    // samples cancels.
    let mut agreement = Agreement {
        fit_percent: Vec::new(),
        theil: Vec::new(),
    };
    for o in 0..means.len() {
        let fit = 100.0 * (1.0 - (error[o] / power[o]).sqrt());
        let theil = error[o].sqrt() / (power[o].sqrt() + simulated[o].sqrt());
        agreement.fit_percent.push(finite(fit));
        agreement.theil.push(finite(theil));
    }
    agreement
}

fn finite(value: f64) -> Option<f64> {
    if value.is_finite() { Some(value) } else { None }
}
