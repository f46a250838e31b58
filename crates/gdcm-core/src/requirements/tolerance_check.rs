//! A simulated time history within the tolerance about the flown one (M17.2).
//!
//! ```text
//! 1  attitudes: theta_n = theta_(n-1) + dt (q_(n-1) + q_n) / 2 from the start of the manoeuvre, flown and simulated alike
//! 2  corridor: w_n = max(absolute, relative |y_n - y_0|), the wider of the two
//! 3  excess: e_n = |y^_n - y_n| - w_n; a sample is inside where e_n <= 0
//! 4  share inside, largest e_n and its time; trend: sign of the correlation of y^ and y about their means
//! ```
//!
//! 14 CFR part 60, appendix C, table C2A. Integrals of body rates are attitudes for small angles only.

use super::ChannelTolerance;
use crate::identification::ValidationWindow;

/// One output over one manoeuvre, flown and simulated, in the unit of the tolerance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Manoeuvre<'a> {
    /// Time of the first sample \[s\].
    pub start_s: f64,
    /// Sample time \[s\].
    pub sample_time_s: f64,
    /// Flown samples, the first at the start of the manoeuvre.
    pub flown: &'a [f64],
    /// Simulated samples, one for each.
    pub simulated: &'a [f64],
}

/// Why a manoeuvre cannot be compared.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum ToleranceCheckError {
    /// There is nothing to compare.
    #[error("there are no samples to compare")]
    NoSamples,
    /// There are not as many simulated samples as flown ones.
    #[error("expected as many simulated samples as flown ones, {flown}, found {simulated}")]
    Lengths {
        /// Number of flown samples.
        flown: usize,
        /// Number of simulated samples.
        simulated: usize,
    },
    /// A sample is missing or not finite.
    #[error("the {of} sample at {time_s:.2} s is missing or not finite")]
    NotFinite {
        /// `flown` or `simulated`.
        of: &'static str,
        /// Its time \[s\].
        time_s: f64,
    },
    /// The windows have no such output.
    #[error("there is no output number {} in the record", output + 1)]
    NoOutput {
        /// Index of the output.
        output: usize,
    },
}

/// One output over one manoeuvre against its tolerance.
#[derive(Clone, Debug, PartialEq)]
pub struct ToleranceCheck {
    /// Time of the first sample \[s\].
    pub start_s: f64,
    /// Sample time \[s\].
    pub sample_time_s: f64,
    /// What was flown, as compared: integrated where the tolerance is of an attitude.
    pub flown: Vec<f64>,
    /// What the model answers, as compared.
    pub simulated: Vec<f64>,
    /// Half-width of the corridor about flight at each sample.
    pub width: Vec<f64>,
    /// Samples inside.
    pub inside: usize,
    /// The largest distance beyond the corridor; negative where all samples are inside.
    pub largest_excess: f64,
    /// When that is \[s\].
    pub largest_excess_at_s: f64,
    trend: Moments,
}

/// Sums about the means: what a correlation is made of.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Moments {
    flown: f64,
    simulated: f64,
    product: f64,
}

impl Moments {
    fn of(flown: &[f64], simulated: &[f64]) -> Self {
        let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
        let (flown_mean, simulated_mean) = (mean(flown), mean(simulated));
        let mut moments = Self::default();
        for (flown, simulated) in flown.iter().zip(simulated) {
            let (flown, simulated) = (flown - flown_mean, simulated - simulated_mean);
            moments.flown += flown * flown;
            moments.simulated += simulated * simulated;
            moments.product += flown * simulated;
        }
        moments
    }

    fn plus(self, other: Self) -> Self {
        Self {
            flown: self.flown + other.flown,
            simulated: self.simulated + other.simulated,
            product: self.product + other.product,
        }
    }

    fn correlation(self) -> Option<f64> {
        let scale = self.flown.sqrt() * self.simulated.sqrt();
        (scale > 0.0).then(|| self.product / scale)
    }
}

impl ToleranceCheck {
    /// One output over one manoeuvre against `tolerance`.
    ///
    /// # Errors
    /// [`ToleranceCheckError`] where there are no samples, not as many of both, or one is not finite.
    pub fn of(manoeuvre: &Manoeuvre<'_>, tolerance: &ChannelTolerance) -> Result<Self, ToleranceCheckError> {
        let Manoeuvre { start_s, sample_time_s, .. } = *manoeuvre;
        check(manoeuvre)?;
        let compared = |samples: &[f64]| {
            if tolerance.integrated { integral(samples, sample_time_s) } else { samples.to_vec() }
        };
        let (flown, simulated) = (compared(manoeuvre.flown), compared(manoeuvre.simulated));
        let start = flown[0];
        let wider = |flown: &f64| tolerance.absolute.max(tolerance.relative * (flown - start).abs());
        let width: Vec<f64> = flown.iter().map(wider).collect();
        let excess: Vec<f64> = excesses(&flown, &simulated, &width).collect();
        // The first of equal ones.
        let (largest, &largest_excess) =
            excess.iter().enumerate().rev().max_by(|a, b| a.1.total_cmp(b.1)).ok_or(ToleranceCheckError::NoSamples)?;
        Ok(Self {
            start_s,
            sample_time_s,
            inside: excess.iter().filter(|excess| **excess <= 0.0).count(),
            largest_excess,
            largest_excess_at_s: start_s + sample_time_s * largest as f64,
            trend: Moments::of(&flown, &simulated),
            flown,
            simulated,
            width,
        })
    }

    /// Number of samples compared; at least one.
    pub fn samples(&self) -> usize {
        self.flown.len()
    }

    /// Share of the samples that are inside, from 0 to 1.
    pub fn share_inside(&self) -> f64 {
        self.inside as f64 / self.samples() as f64
    }

    /// Correlation of simulated and flown about their means; none where one of them does not move. Off the axis its sign is the
    /// trend that is asked for: correct where it is positive.
    pub fn correlation(&self) -> Option<f64> {
        self.trend.correlation()
    }

    /// The parts of time \[s\] in which samples are outside: from the first to the last of each.
    pub fn outside(&self) -> Vec<[f64; 2]> {
        let mut parts: Vec<[f64; 2]> = Vec::new();
        let mut was_outside = false;
        for (n, excess) in excesses(&self.flown, &self.simulated, &self.width).enumerate() {
            let (time_s, is_outside) = (self.start_s + self.sample_time_s * n as f64, excess > 0.0);
            match parts.last_mut().filter(|_| was_outside && is_outside) {
                Some(part) => part[1] = time_s,
                None if is_outside => parts.push([time_s; 2]),
                None => {}
            }
            was_outside = is_outside;
        }
        parts
    }
}

fn excesses<'a>(flown: &'a [f64], simulated: &'a [f64], width: &'a [f64]) -> impl Iterator<Item = f64> + 'a {
    flown.iter().zip(simulated).zip(width).map(|((flown, simulated), width)| (simulated - flown).abs() - width)
}

fn check(manoeuvre: &Manoeuvre<'_>) -> Result<(), ToleranceCheckError> {
    let Manoeuvre { flown, simulated, .. } = manoeuvre;
    if flown.is_empty() {
        return Err(ToleranceCheckError::NoSamples);
    }
    if flown.len() != simulated.len() {
        return Err(ToleranceCheckError::Lengths { flown: flown.len(), simulated: simulated.len() });
    }
    for (of, samples) in [("flown", flown), ("simulated", simulated)] {
        if let Some(n) = samples.iter().position(|sample| !sample.is_finite()) {
            let time_s = manoeuvre.start_s + manoeuvre.sample_time_s * n as f64;
            return Err(ToleranceCheckError::NotFinite { of, time_s });
        }
    }
    Ok(())
}

/// The integral over time from the first sample, by the trapezoidal rule; there is at least one sample.
fn integral(samples: &[f64], sample_time_s: f64) -> Vec<f64> {
    let mut sum = 0.0;
    let step = |pair: &[f64]| {
        sum += 0.5 * sample_time_s * (pair[0] + pair[1]);
        sum
    };
    let later: Vec<f64> = samples.windows(2).map(step).collect();
    std::iter::once(0.0).chain(later).collect()
}

/// One output over all windows of a record, each of which begins with an estimated state of its own (M14, 6).
#[derive(Clone, Debug, PartialEq)]
pub struct RecordCheck {
    /// Which record, counted from 0.
    pub record: usize,
    /// The windows, in time; at least one.
    pub windows: Vec<ToleranceCheck>,
}

impl RecordCheck {
    /// The records of `windows`, each against `tolerance`; every window is a manoeuvre of its own.
    ///
    /// # Errors
    /// [`ToleranceCheckError`] of the first window that cannot be compared.
    pub fn of_windows(
        windows: &[ValidationWindow],
        tolerance: &ChannelTolerance,
    ) -> Result<Vec<Self>, ToleranceCheckError> {
        let mut records: Vec<Self> = Vec::new();
        for window in windows {
            let check = of_window(window, tolerance)?;
            match records.iter_mut().find(|of| of.record == window.record) {
                Some(of) => of.windows.push(check),
                None => records.push(Self { record: window.record, windows: vec![check] }),
            }
        }
        Ok(records)
    }

    /// Share of the samples that are inside, from 0 to 1.
    pub fn share_inside(&self) -> f64 {
        let inside: usize = self.windows.iter().map(|window| window.inside).sum();
        inside as f64 / self.windows.iter().map(ToleranceCheck::samples).sum::<usize>() as f64
    }

    /// The window in which the excess is largest.
    pub fn worst(&self) -> Option<&ToleranceCheck> {
        self.windows.iter().max_by(|a, b| a.largest_excess.total_cmp(&b.largest_excess))
    }

    /// Correlation of simulated and flown, each about its mean in its window; none where one of them does not move.
    pub fn correlation(&self) -> Option<f64> {
        self.windows.iter().map(|window| window.trend).fold(Moments::default(), Moments::plus).correlation()
    }
}

fn of_window(window: &ValidationWindow, tolerance: &ChannelTolerance) -> Result<ToleranceCheck, ToleranceCheckError> {
    let output = tolerance.output;
    if output >= window.measured.ncols().min(window.simulated.ncols()) {
        return Err(ToleranceCheckError::NoOutput { output });
    }
    let column = |samples: &nalgebra::DMatrix<f64>| samples.column(output).iter().copied().collect::<Vec<f64>>();
    let (flown, simulated) = (column(&window.measured), column(&window.simulated));
    let (start_s, sample_time_s) = (window.start_s, window.sample_time_s);
    ToleranceCheck::of(&Manoeuvre { start_s, sample_time_s, flown: &flown, simulated: &simulated }, tolerance)
}
