//! The flight record from the chosen columns: samples times their factor, delays removed.

use nalgebra::DMatrix;

use gdcm_model::simulation::FlightRecord;

use super::channel_delay::advanced;
use super::column_use::ColumnUse;
use super::layout_problem::LayoutProblem;
use super::record_channels::RecordChannels;
use super::record_layout::RecordLayout;
use super::record_table::RecordTable;
use super::resampling::Resampling;
use super::time_base::TimeBase;

impl RecordLayout {
    /// Returns the flight record from the chosen columns, each sample times its factor, delays
    /// removed. The record is resampled if the columns have several clocks or a rate is requested
    /// (M14.11); otherwise samples are interpolated only where a delay is removed.
    ///
    /// # Errors
    /// All problems with the columns.
    pub fn flight_record(
        &self,
        table: &RecordTable,
        channels: &RecordChannels,
    ) -> Result<FlightRecord, Vec<LayoutProblem>> {
        let problems = self.problems(table, channels);
        // A missing time base is among the problems.
        let Some(time) = self.time else {
            return Err(problems);
        };
        if !problems.is_empty() {
            return Err(problems);
        }
        match Resampling::new(self, table, channels) {
            Some(Ok(resampling)) => Ok(resampling.flight_record(table.name.clone())),
            // `Err` cannot occur here: it would be among the problems, and there are none.
            None | Some(Err(_)) => Ok(self.as_logged(table, time)),
        }
    }

    /// Returns the samples on their common clock, restricted to the selected part.
    fn as_logged(&self, table: &RecordTable, time: TimeBase) -> FlightRecord {
        // Topics that are not resampled have the same stamps.
        let time_s = if time == TimeBase::Topics {
            self.stamps_of_first_topic(table).unwrap_or_default()
        } else {
            time.times_s(table)
        };
        let mut rows = Vec::new();
        for (row, time) in time_s.iter().enumerate() {
            let is_selected = match table.part_s {
                Some([from, to]) => (from..=to).contains(time),
                None => true,
            };
            if is_selected {
                rows.push(row);
            }
        }
        let samples = RowSamples {
            table,
            time_s: &time_s,
            rows: &rows,
        };
        FlightRecord {
            name: table.name.clone(),
            inputs: samples.matrix(&self.inputs),
            outputs: samples.matrix(&self.outputs),
            time_s: rows.iter().map(|row| time_s[*row]).collect(),
        }
    }

    /// Returns the stamps from the first channel's topic \[s\].
    fn stamps_of_first_topic(&self, table: &RecordTable) -> Option<Vec<f64>> {
        let used = self.inputs.iter().chain(&self.outputs).flatten().next()?;
        let topic = table.columns.get(used.column)?.topic.as_ref()?;
        Some(topic.time_s.clone())
    }
}

/// Reads samples in chosen rows.
struct RowSamples<'r> {
    table: &'r RecordTable,
    /// A stamp for each table row \[s\].
    time_s: &'r [f64],
    rows: &'r [usize],
}

impl RowSamples<'_> {
    /// Returns the samples in channel units, delays removed, one column per channel; NaN where a
    /// sample is missing.
    fn matrix(&self, uses: &[Option<ColumnUse>]) -> DMatrix<f64> {
        let mut samples = DMatrix::from_element(self.rows.len(), uses.len(), f64::NAN);
        for (channel, used) in uses.iter().enumerate() {
            let Some(used) = used else {
                continue;
            };
            let Some(column) = self.table.columns.get(used.column) else {
                continue;
            };
            if used.remedy.delay_s == 0.0 {
                self.fill(&mut samples, channel, &column.values, used.gain());
            } else {
                let values = advanced(self.time_s, &column.values, used.remedy.delay_s);
                self.fill(&mut samples, channel, &values, used.gain());
            }
        }
        samples
    }

    /// Writes the finite values in the chosen rows, times `gain`, to a channel.
    fn fill(&self, samples: &mut DMatrix<f64>, channel: usize, values: &[f64], gain: f64) {
        for (sample, row) in self.rows.iter().enumerate() {
            let value = values.get(*row).copied().unwrap_or(f64::NAN);
            if value.is_finite() {
                samples[(sample, channel)] = value * gain;
            }
        }
    }
}
