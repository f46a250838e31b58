//! Simulated time histories within tolerances around flight (M17.2).
//!
//! ```text
//! 1  attitudes: theta_n = theta_(n-1) + dt (q_(n-1) + q_n) / 2 from the start of the manoeuvre,
//!    flown and simulated alike
//! 2  corridor: half-width w_n = max(absolute, relative |y_n - y_0|), the wider tolerance
//! 3  excess: e_n = |y^_n - y_n| - w_n; a sample is inside where e_n <= 0
//! 4  share inside, maximum e_n and its time; peak error: maximum |y^_n - y_n| / w_n and its time;
//!    trend: sign of the correlation between y^ and y about their means
//! ```
//!
//! `y` are the flown and `y^` the simulated samples with index n, `dt` apart; `theta` is an
//! attitude and `q` its rate.
//!
//! 14 CFR part 60, appendix C, table C2A. The check is not a qualification: the table's tests are
//! steps and doublets at given conditions. Integrated body rates are attitudes for small angles
//! only.

use nalgebra::DMatrix;

use gdcm_model::simulation::ValidationWindow;
use gdcm_model::statistics::mean;

pub use super::tolerance_table::{ChannelTolerance, Tolerance, ToleranceError, ToleranceTable};

/// Reasons why a manoeuvre cannot be compared.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum ToleranceCheckError {
    #[error("there are no samples to compare")]
    NoSamples,
    #[error("expected as many simulated samples as flown samples ({flown}), found {simulated}")]
    Lengths { flown: usize, simulated: usize },
    /// A sample is missing or not finite.
    #[error("the {origin} sample at {time_s:.2} s is missing or not finite")]
    NotFinite {
        /// `flown` or `simulated`.
        origin: &'static str,
        time_s: f64,
    },
    #[error("the record has no output number {}", output + 1)]
    NoOutput { output: usize },
}

impl ToleranceCheckError {
    /// Returns the stable code by which scripts and tests distinguish the errors.
    pub fn code(&self) -> &'static str {
        match self {
            Self::NoSamples => "no-samples",
            Self::Lengths { .. } => "lengths-differ",
            Self::NotFinite { .. } => "not-finite",
            Self::NoOutput { .. } => "no-output",
        }
    }
}

/// An output over a manoeuvre, compared with its tolerance.
#[derive(Clone, Debug, PartialEq)]
pub struct ToleranceCheck {
    /// Time at the first sample \[s\].
    pub start_s: f64,
    pub sample_time_s: f64,
    /// Flown samples as compared: integrated if the tolerance applies to an attitude.
    pub flown: Vec<f64>,
    /// Simulated samples as compared.
    pub simulated: Vec<f64>,
    /// Half-width of the corridor around the flown samples, per sample.
    pub width: Vec<f64>,
    /// Count of samples inside the corridor.
    pub inside: usize,
    /// Maximum distance beyond the corridor; zero or negative if all samples are inside.
    pub largest_excess: f64,
    /// Time at which `largest_excess` occurs \[s\].
    pub largest_excess_at_s: f64,
    /// Maximum ratio between the error and the corridor's half-width at the same sample; above 1 if
    /// a sample is outside.
    pub peak_error: f64,
    /// Time at which `peak_error` occurs \[s\].
    pub peak_error_at_s: f64,
    trend: TrendSums,
}

impl ToleranceCheck {
    /// Checks a window from a record, treated as a separate manoeuvre, against `tolerance`.
    ///
    /// # Errors
    /// [`ToleranceCheckError`] if there is no such output, there are no samples, the sample counts
    /// differ, or a sample is not finite.
    pub fn new(
        window: &ValidationWindow,
        tolerance: &ChannelTolerance,
    ) -> Result<Self, ToleranceCheckError> {
        check_shape(window, tolerance.output)?;
        // Step 1
        let flown = compared_samples("flown", &window.measured, window, tolerance)?;
        let simulated = compared_samples("simulated", &window.simulated, window, tolerance)?;
        // Step 2
        let width = corridor_width(&flown, tolerance);
        // Step 3
        let excess: Vec<f64> = excesses(&flown, &simulated, &width).collect();
        // Step 4
        let largest = first_maximum(&excess);
        let relative_errors = relative_errors(&flown, &simulated, &width);
        let peak = first_maximum(&relative_errors);
        Ok(Self {
            start_s: window.start_s,
            sample_time_s: window.sample_time_s,
            inside: excess.iter().filter(|excess| **excess <= 0.0).count(),
            largest_excess: excess[largest],
            largest_excess_at_s: window.start_s + window.sample_time_s * largest as f64,
            peak_error: relative_errors[peak],
            peak_error_at_s: window.start_s + window.sample_time_s * peak as f64,
            trend: TrendSums::new(&flown, &simulated),
            flown,
            simulated,
            width,
        })
    }

    /// Returns the compared sample count, at least one.
    pub fn samples(&self) -> usize {
        self.flown.len()
    }

    /// Returns the share of samples inside the corridor, from 0 to 1.
    pub fn share_inside(&self) -> f64 {
        self.inside as f64 / self.samples() as f64
    }

    /// Returns the correlation between simulated and flown samples about their means; `None` if
    /// either is constant. For off-axis outputs a positive sign is the correct trend.
    pub fn correlation(&self) -> Option<f64> {
        self.trend.correlation()
    }

    /// Returns the time intervals \[s\] outside the corridor, each from its first to its last
    /// sample.
    pub fn outside(&self) -> Vec<[f64; 2]> {
        let mut intervals: Vec<[f64; 2]> = Vec::new();
        let mut was_outside = false;
        for (n, excess) in excesses(&self.flown, &self.simulated, &self.width).enumerate() {
            let time_s = self.start_s + self.sample_time_s * n as f64;
            let is_outside = excess > 0.0;
            if is_outside {
                match intervals.last_mut() {
                    Some(interval) if was_outside => interval[1] = time_s,
                    _ => intervals.push([time_s; 2]),
                }
            }
            was_outside = is_outside;
        }
        intervals
    }
}

/// Checks that both signals have this output and equally many samples.
fn check_shape(window: &ValidationWindow, output: usize) -> Result<(), ToleranceCheckError> {
    let ValidationWindow {
        measured,
        simulated,
        ..
    } = window;
    if output >= measured.ncols().min(simulated.ncols()) {
        return Err(ToleranceCheckError::NoOutput { output });
    }
    if measured.is_empty() {
        return Err(ToleranceCheckError::NoSamples);
    }
    if measured.nrows() != simulated.nrows() {
        return Err(ToleranceCheckError::Lengths {
            flown: measured.nrows(),
            simulated: simulated.nrows(),
        });
    }
    Ok(())
}

/// Returns the samples that `tolerance` applies to, integrated for an attitude (step 1); `samples`
/// holds the window's outputs from `origin`.
fn compared_samples(
    origin: &'static str,
    samples: &DMatrix<f64>,
    window: &ValidationWindow,
    tolerance: &ChannelTolerance,
) -> Result<Vec<f64>, ToleranceCheckError> {
    let samples: Vec<f64> = samples.column(tolerance.output).iter().copied().collect();
    if let Some(n) = samples.iter().position(|sample| !sample.is_finite()) {
        return Err(ToleranceCheckError::NotFinite {
            origin,
            time_s: window.start_s + window.sample_time_s * n as f64,
        });
    }
    if tolerance.integrated {
        return Ok(integral(&samples, window.sample_time_s));
    }
    Ok(samples)
}

/// Returns the corridor's half-width at each sample (step 2).
fn corridor_width(flown: &[f64], tolerance: &ChannelTolerance) -> Vec<f64> {
    let start = flown[0];
    flown
        .iter()
        .map(|flown| {
            let relative = tolerance.relative * (flown - start).abs();
            tolerance.absolute.max(relative)
        })
        .collect()
}

/// Returns `|simulated - flown| - width` at each sample (step 3).
fn excesses<'a>(
    flown: &'a [f64],
    simulated: &'a [f64],
    width: &'a [f64],
) -> impl Iterator<Item = f64> + 'a {
    flown
        .iter()
        .zip(simulated)
        .zip(width)
        .map(|((flown, simulated), width)| (simulated - flown).abs() - width)
}

/// Returns `|simulated - flown| / width` at each sample (step 4); widths are above zero.
fn relative_errors(flown: &[f64], simulated: &[f64], width: &[f64]) -> Vec<f64> {
    flown
        .iter()
        .zip(simulated)
        .zip(width)
        .map(|((flown, simulated), width)| (simulated - flown).abs() / width)
        .collect()
}

/// Returns the index of the largest value (the first, if several are equal); 0 for an empty slice.
fn first_maximum(values: &[f64]) -> usize {
    let mut largest = 0;
    for (n, value) in values.iter().enumerate() {
        if value.total_cmp(&values[largest]).is_gt() {
            largest = n;
        }
    }
    largest
}

/// Integrates over time from the first sample by the trapezoidal rule; needs at least one sample.
fn integral(samples: &[f64], sample_time_s: f64) -> Vec<f64> {
    let mut integrals = vec![0.0];
    let mut sum = 0.0;
    for pair in samples.windows(2) {
        sum += 0.5 * sample_time_s * (pair[0] + pair[1]);
        integrals.push(sum);
    }
    integrals
}

/// Sums over the samples, after subtracting the means, from which the correlation is computed (step
/// 4).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct TrendSums {
    flown_squared: f64,
    simulated_squared: f64,
    /// Flown times simulated.
    product: f64,
}

impl TrendSums {
    fn new(flown: &[f64], simulated: &[f64]) -> Self {
        let flown_mean = mean(flown);
        let simulated_mean = mean(simulated);
        let mut sums = Self::default();
        for (flown, simulated) in flown.iter().zip(simulated) {
            let flown = flown - flown_mean;
            let simulated = simulated - simulated_mean;
            sums.add(Self {
                flown_squared: flown * flown,
                simulated_squared: simulated * simulated,
                product: flown * simulated,
            });
        }
        sums
    }

    fn add(&mut self, other: Self) {
        self.flown_squared += other.flown_squared;
        self.simulated_squared += other.simulated_squared;
        self.product += other.product;
    }

    /// Returns the correlation coefficient; `None` if either signal is constant.
    fn correlation(self) -> Option<f64> {
        let scale = self.flown_squared.sqrt() * self.simulated_squared.sqrt();
        if scale > 0.0 {
            Some(self.product / scale)
        } else {
            None
        }
    }
}

/// An output over all windows in a record, each with its own estimated initial state (M14.6).
#[derive(Clone, Debug, PartialEq)]
pub struct RecordCheck {
    /// Record index, counted from 0.
    pub record: usize,
    /// The windows in time order; at least one.
    pub windows: Vec<ToleranceCheck>,
}

impl RecordCheck {
    /// Checks the records in `windows` against `tolerance`; every window is treated as a separate
    /// manoeuvre.
    ///
    /// # Errors
    /// [`ToleranceCheckError`] for the first window that cannot be compared.
    pub fn of_windows(
        windows: &[ValidationWindow],
        tolerance: &ChannelTolerance,
    ) -> Result<Vec<Self>, ToleranceCheckError> {
        let mut records: Vec<Self> = Vec::new();
        for window in windows {
            let check = ToleranceCheck::new(window, tolerance)?;
            let known = records
                .iter_mut()
                .find(|record| record.record == window.record);
            match known {
                Some(record) => record.windows.push(check),
                None => records.push(Self {
                    record: window.record,
                    windows: vec![check],
                }),
            }
        }
        Ok(records)
    }

    /// Returns the share of samples inside the corridor, from 0 to 1.
    pub fn share_inside(&self) -> f64 {
        let inside: usize = self.windows.iter().map(|window| window.inside).sum();
        let samples: usize = self.windows.iter().map(ToleranceCheck::samples).sum();
        inside as f64 / samples as f64
    }

    /// Returns the window with the largest excess.
    pub fn worst(&self) -> Option<&ToleranceCheck> {
        self.windows
            .iter()
            .max_by(|a, b| a.largest_excess.total_cmp(&b.largest_excess))
    }

    /// Returns the window with the largest error relative to its tolerance.
    pub fn peak(&self) -> Option<&ToleranceCheck> {
        self.windows
            .iter()
            .max_by(|a, b| a.peak_error.total_cmp(&b.peak_error))
    }

    /// Returns the correlation between simulated and flown samples, each about its mean in its
    /// window; `None` if either is constant in every window.
    pub fn correlation(&self) -> Option<f64> {
        let mut trend = TrendSums::default();
        for window in &self.windows {
            trend.add(window.trend);
        }
        trend.correlation()
    }
}
