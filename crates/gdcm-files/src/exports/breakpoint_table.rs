//! The gains and delays of a correction at some airspeeds, for lookup tables that are linear between them.

use super::export_fault::ExportFault;
use super::scheduled_correction::{NamedCurve, ScheduledCorrection, SecondArgument};
use super::table_error::TableError;

/// All curves of a correction at some airspeeds.
pub(super) struct BreakpointTable<'c> {
    /// Airspeeds \[kt\], increasing.
    pub(super) airspeed_kt: Vec<f64>,
    /// Values of the second variable, increasing; none where there is none. Each stands for all airspeeds, one after the other.
    pub(super) second: Vec<f64>,
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
        // Ends and middle: between them the effect is nearly a straight line.
        let second =
            correction.second.as_ref().map_or_else(Vec::new, |SecondArgument { range: (least, most), .. }| {
                vec![*least, 0.5 * (least + most), *most]
            });
        let places: Vec<Option<f64>> =
            if second.is_empty() { vec![None] } else { second.iter().copied().map(Some).collect() };
        let column = |of: NamedCurve<'c>| {
            let rows = places.iter().flat_map(|second| breakpoints_kt.iter().map(move |&point| (point, *second)));
            let values = rows.map(|(point, second)| of.curve.at(correction.at(point, second))).collect();
            let errors = places.iter().map(|second| error(correction, (breakpoints_kt, *second), &of));
            let worst = errors.reduce(|worst, found| if found.error > worst.error { found } else { worst });
            let error = worst.unwrap_or(TableError { error: 0.0, airspeed_kt: breakpoints_kt[0] });
            BreakpointColumn { error, of, values }
        };
        let columns = correction.curves().map(column).collect();
        Ok(Self { airspeed_kt: breakpoints_kt.to_vec(), columns, second })
    }

    /// Airspeed \[kt\] and second variable of each row.
    pub(super) fn rows(&self) -> Vec<(f64, Option<f64>)> {
        if self.second.is_empty() {
            return self.airspeed_kt.iter().map(|&airspeed| (airspeed, None)).collect();
        }
        let of = |&second: &f64| self.airspeed_kt.iter().map(move |&airspeed| (airspeed, Some(second)));
        self.second.iter().flat_map(of).collect()
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

fn error(correction: &ScheduledCorrection, (points, second): (&[f64], Option<f64>), of: &NamedCurve) -> TableError {
    let truth = |airspeed: f64| of.curve.at(correction.at(airspeed, second));
    let range = correction.airspeed_range_kt;
    if of.is_time() {
        let milliseconds = |value: f64, truth: f64| 1e3 * (value - truth).abs();
        return TableError::greatest(points, range, truth, milliseconds);
    }
    // Both zero: no error; a table that misses a zero has no error in percent.
    let percent = |value: f64, truth: f64| if value == truth { 0.0 } else { 100.0 * ((value - truth) / truth).abs() };
    TableError::greatest(points, range, truth, percent)
}
