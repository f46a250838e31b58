//! Agreement between measured and simulated outputs: fit and Theil's coefficient.
//!
//! ```text
//! fit = 100 (1 - rms(y - y^) / std(y)),   Theil = rms(y - y^) / (rms(y) + rms(y^))
//! ```
//!
//! y is the measured output, y^ the simulated output; the rms values in Theil's coefficient are taken
//! about the mean of y.

use nalgebra::DMatrix;

/// Measured and simulated outputs in a record window.
#[derive(Clone, Debug, PartialEq)]
pub struct ValidationWindow {
    /// Record index, counted from 0.
    pub record: usize,
    /// First sample's time \[s\], on the record's time axis.
    pub start_s: f64,
    pub sample_time_s: f64,
    /// Measured outputs, filtered if requested: one row per sample, one column per output.
    pub measured: DMatrix<f64>,
    /// Simulated outputs: one row per sample, one column per output.
    pub simulated: DMatrix<f64>,
}

/// Agreement for each output over all windows.
pub(super) struct Agreement {
    pub(super) fit_percent: Vec<Option<f64>>,
    pub(super) theil: Vec<Option<f64>>,
}

/// Computes the fit \[%\] and Theil's coefficient for each output.
pub(super) fn agreement(windows: &[ValidationWindow]) -> Agreement {
    let measured = windows.iter().map(|window| &window.measured);
    let means = column_means(measured.clone());
    let errors: Vec<DMatrix<f64>> = windows
        .iter()
        .map(|window| &window.measured - &window.simulated)
        .collect();
    let error = column_sums(errors.iter(), |_, e| e * e);
    let power = column_sums(measured, |o, y| (y - means[o]).powi(2));
    let simulated = column_sums(windows.iter().map(|window| &window.simulated), |o, y| {
        (y - means[o]).powi(2)
    });
    // Sums replace rms and standard deviation: all run over the same samples, so that the sample
    // count cancels.
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

/// Returns each column's standard deviation over all `parts`; 1 for a constant column.
pub(super) fn column_deviations<'a>(
    parts: impl Iterator<Item = &'a DMatrix<f64>> + Clone,
) -> Vec<f64> {
    let means = column_means(parts.clone());
    let squares = column_sums(parts.clone(), |o, y| (y - means[o]).powi(2));
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

/// Averages each column over all `parts`.
fn column_means<'a>(parts: impl Iterator<Item = &'a DMatrix<f64>> + Clone) -> Vec<f64> {
    let samples: usize = parts.clone().map(DMatrix::nrows).sum();
    column_sums(parts, |_, y| y)
        .iter()
        .map(|sum| sum / samples.max(1) as f64)
        .collect()
}

/// Sums `term(column, value)` over all samples in all `parts`, for each column.
fn column_sums<'a>(
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

fn finite(value: f64) -> Option<f64> {
    if value.is_finite() { Some(value) } else { None }
}
