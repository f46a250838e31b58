//! The gains and delays of a correction at some airspeeds, for lookup tables that are linear between them.

use super::export_fault::ExportFault;
use super::scheduled_correction::{NamedCurve, ScheduledCorrection};
use super::table_error::TableError;

/// All curves of a correction at some airspeeds.
pub(super) struct BreakpointTable<'c> {
    /// Airspeeds \[kt\], increasing.
    pub(super) airspeed_kt: Vec<f64>,
    /// One for each gain, each delay and each lead filter.
    pub(super) columns: Vec<BreakpointColumn<'c>>,
}

/// One curve at the airspeeds of a table.
pub(super) struct BreakpointColumn<'c> {
    /// The curve, and what it is of.
    pub(super) of: NamedCurve<'c>,
    /// Its values: gains, or times \[s\].
    pub(super) values: Vec<f64>,
    /// How far the table lies from it at most: \[%\] of a gain, \[ms\] of a time.
    pub(super) error: TableError,
}

impl<'c> BreakpointTable<'c> {
    /// The table of a correction at the airspeeds `breakpoints_kt`.
    ///
    /// # Errors
    /// [`ExportFault::Breakpoints`] where these do not increase.
    pub(super) fn of(correction: &'c ScheduledCorrection, breakpoints_kt: &[f64]) -> Result<Self, ExportFault> {
        correction.check()?;
        let increasing = breakpoints_kt.windows(2).all(|pair| pair[0] < pair[1]);
        if breakpoints_kt.is_empty() || !increasing || !breakpoints_kt.iter().all(|point| point.is_finite()) {
            return Err(ExportFault::Breakpoints);
        }
        let column = |of: NamedCurve<'c>| {
            let values = breakpoints_kt.iter().map(|&point| of.curve.at(correction.cut(point))).collect();
            BreakpointColumn { error: error(correction, breakpoints_kt, &of), of, values }
        };
        Ok(Self { airspeed_kt: breakpoints_kt.to_vec(), columns: correction.curves().map(column).collect() })
    }
}

impl BreakpointColumn<'_> {
    /// The greatest error in words: "1.200e0 % at 62.000 kt".
    pub(super) fn error_words(&self) -> String {
        let unit = if self.of.is_time() { "ms" } else { "%" };
        let TableError { error, airspeed_kt } = self.error;
        let place = if error > 0.0 { format!(" at {airspeed_kt:.3} kt") } else { String::new() };
        format!("{error:.3e} {unit}{place}")
    }
}

fn error(correction: &ScheduledCorrection, points: &[f64], of: &NamedCurve) -> TableError {
    let truth = |airspeed: f64| of.curve.at(correction.cut(airspeed));
    let range = correction.airspeed_range_kt;
    if of.is_time() {
        let milliseconds = |value: f64, truth: f64| 1e3 * (value - truth).abs();
        return TableError::greatest(points, range, truth, milliseconds);
    }
    // Both zero: no error; a table that misses a zero has no error in percent.
    let percent = |value: f64, truth: f64| if value == truth { 0.0 } else { 100.0 * ((value - truth) / truth).abs() };
    TableError::greatest(points, range, truth, percent)
}
