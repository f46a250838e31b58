//! Lookup tables with scheduled gains and delays at given airspeeds, for linear interpolation:
//! as text, and for MATLAB.
//!
//! A row is a *breakpoint*: an airspeed and, if scheduled, a value of the second variable
//! (altitude or mass). A column holds a channel's gain, delay or lead (the numerator time
//! constant of its lead filter), or an entry of the mixing `M~` among the inputs (M16). A column's
//! *deviation*, which texts for users call its error, is the maximum difference between its linear
//! interpolation and the schedule.

mod csv;
mod matlab;

use gdcm_method::correction::Channel;
use gdcm_method::couplings::CouplingMatrices;
use gdcm_plot::figure::all_channels;
use gdcm_study::results::export_note::{ExportNote, FileSummary};

use super::exported_schedule::ExportedSchedule;
use super::file_head::variables_head;
use super::table_deviation::TableDeviation;
use super::{Export, ExportFormat, Exported, FormatGroup};
use crate::export_fault::ExportFault;
use crate::files::export_contents::ExportContents;
use crate::formats::mat;

pub(super) const CSV: ExportFormat = ExportFormat {
    name: "table-csv",
    extension: "csv",
    stem: "table",
    group: FormatGroup::Table,
    title: "Lookup table",
    words: "Lookup table over airspeed, CSV",
    options: OPTIONS,
    check_path: |_| Ok(()),
    correction_parts: |analysis, _| ExportContents::of_scheduled(analysis),
    export: |export| {
        let table = BreakpointTable::from_export(export)?;
        Ok(Exported::bytes(table.summary(), table.csv())
            .with_remarks(table.remarks())
            .with_notes(table.export_notes(export)))
    },
};

pub(super) const MAT: ExportFormat = ExportFormat {
    name: "table-mat",
    extension: "mat",
    stem: "table",
    group: FormatGroup::Table,
    title: "Lookup table",
    words: "Lookup table over airspeed, MATLAB data",
    options: OPTIONS,
    check_path: |_| Ok(()),
    correction_parts: |analysis, _| ExportContents::of_scheduled(analysis),
    export: |export| {
        let table = BreakpointTable::from_export(export)?;
        let variables = [table.variable()];
        Ok(Exported::bytes(table.summary(), mat::write(&variables)?)
            .with_remarks(table.remarks())
            .with_notes(table.export_notes(export))
            .with_head(variables_head(&variables)))
    },
};

const OPTIONS: &[&str] = &["--breakpoints"];

/// Table deviation, in percent or ms, below which no note is needed: with one decimal it would be
/// 0.0.
const NOTABLE_DEVIATION: f64 = 0.05;

/// Quantity in a column: a gain, an entry in the mixing matrix, or a time \[s\].
#[derive(Debug, PartialEq)]
struct Quantity {
    name: &'static str,
    /// The quantity's name within MATLAB field names.
    field: &'static str,
    is_time: bool,
}

const GAIN: Quantity = Quantity {
    name: "gain",
    field: "gains",
    is_time: false,
};
const DELAY: Quantity = Quantity {
    name: "delay",
    field: "delays_s",
    is_time: true,
};
const MIXING: Quantity = Quantity {
    name: "mixing",
    field: "mixing",
    is_time: false,
};
const LEAD: Quantity = Quantity {
    name: "lead numerator",
    field: "lead_numerators_s",
    is_time: true,
};

impl Quantity {
    /// Returns the deviation of `value` from `truth`: absolute \[ms\] for a time, relative \[%\]
    /// for any other quantity.
    fn deviation(&self, value: f64, truth: f64) -> f64 {
        let difference = value - truth;
        if difference == 0.0 {
            // If both values are zero, a percentage is undefined.
            0.0
        } else if self.is_time {
            1e3 * difference.abs()
        } else {
            100.0 * (difference / truth).abs()
        }
    }
}

/// A row's airspeed and second variable.
#[derive(Clone, Copy)]
struct Breakpoint {
    airspeed_kt: f64,
    /// `None` if the schedule has no second variable.
    second: Option<f64>,
}

/// Values of a channel's quantity at the breakpoints; for a mixing entry, `channel` is the
/// receiving input.
struct Column {
    quantity: &'static Quantity,
    channel: Channel,
    name: String,
    /// One value per table row.
    values: Vec<f64>,
    /// Maximum deviation from the schedule: \[ms\] for a time, \[%\] for any other quantity.
    deviation: TableDeviation,
}

/// A schedule sampled at given airspeeds.
struct BreakpointTable<'e> {
    scheduled: ExportedSchedule<'e>,
    /// Airspeeds \[kt\], increasing.
    airspeeds_kt: Vec<f64>,
    /// All airspeeds, repeated for each value of the second variable.
    rows: Vec<Breakpoint>,
    /// Gain, delay and, if scheduled, lead filter for each input, then for each output; then the
    /// mixing, if there is any.
    columns: Vec<Column>,
}

impl<'e> BreakpointTable<'e> {
    fn from_export(export: &Export<'e>) -> Result<Self, ExportFault> {
        Self::new(
            export.scheduled()?,
            export.request.breakpoints_kt.as_deref(),
        )
    }

    /// Builds the table.
    ///
    /// 1. Its airspeeds \[kt\] (breakpoints) are the requested ones; by default the scheduled
    ///    conditions' distinct airspeeds.
    /// 2. It has a row for each of them, repeated for each value of the second variable.
    /// 3. It has the columns gain, delay and, if scheduled, lead filter for each channel, then the
    ///    mixing, each with its maximum deviation from the schedule.
    ///
    /// # Errors
    /// [`ExportFault::Breakpoints`] if the airspeeds are not finite and increasing, or if there are
    /// none; [`ExportFault::Curve`] if the schedule contains a value that is not finite.
    fn new(
        scheduled: ExportedSchedule<'e>,
        breakpoints_kt: Option<&[f64]>,
    ) -> Result<Self, ExportFault> {
        scheduled.check()?;
        // Step 1.
        let airspeeds_kt = match breakpoints_kt {
            Some(airspeeds_kt) => airspeeds_kt.to_vec(),
            None => distinct_airspeeds_kt(&scheduled),
        };
        let is_increasing = airspeeds_kt.windows(2).all(|pair| pair[0] < pair[1]);
        let is_finite = airspeeds_kt.iter().all(|airspeed| airspeed.is_finite());
        if airspeeds_kt.is_empty() || !is_increasing || !is_finite {
            return Err(ExportFault::Breakpoints);
        }
        // Step 2.
        let second_values = second_values(&scheduled);
        let mut rows = Vec::new();
        for &second in &second_values {
            for &airspeed_kt in &airspeeds_kt {
                rows.push(Breakpoint {
                    airspeed_kt,
                    second,
                });
            }
        }
        let mut table = Self {
            scheduled,
            airspeeds_kt,
            rows,
            columns: Vec::new(),
        };
        // Step 3.
        for channel in all_channels(table.scheduled.dataset) {
            table.add_channel(channel, &second_values);
        }
        if let Some(couplings) = table.scheduled.couplings {
            table.add_mixing(couplings);
        }
        Ok(table)
    }

    /// Adds a channel's gain, delay and, if scheduled, lead filter.
    fn add_channel(&mut self, channel: Channel, second_values: &[Option<f64>]) {
        let schedule = self.scheduled.schedule;
        let gain = self.column(channel, &GAIN, second_values, |row| {
            schedule.evaluate(row.airspeed_kt, row.second).gain(channel)
        });
        self.columns.push(gain);
        let delay = self.column(channel, &DELAY, second_values, |row| {
            schedule
                .evaluate(row.airspeed_kt, row.second)
                .pure_delay_s(channel)
        });
        self.columns.push(delay);
        if let Some(zero_s) = self.scheduled.zero_s(channel) {
            let lead = self.column(channel, &LEAD, second_values, |row| {
                zero_s.regression.at(&schedule.airspeeds, row.airspeed_kt)
            });
            self.columns.push(lead);
        }
    }

    /// Adds the normalised mixing matrix's entries as columns, in row-major order.
    fn add_mixing(&mut self, couplings: &CouplingMatrices) {
        let (inputs, _) = self.scheduled.dataset.input_and_output_names();
        for (to, receiver) in inputs.iter().enumerate() {
            for (from, sender) in inputs.iter().enumerate() {
                let mut column = self.column(Channel::Input(to), &MIXING, &[None], |row| {
                    couplings.normalised_mixing(row.airspeed_kt)[(to, from)]
                });
                column.name = format!("{receiver} from {sender}");
                self.columns.push(column);
            }
        }
    }

    /// Returns a channel's column; `value_at` gives the value at a breakpoint. The maximum
    /// deviation is searched over airspeed at each of `second_values`.
    fn column(
        &self,
        channel: Channel,
        quantity: &'static Quantity,
        second_values: &[Option<f64>],
        value_at: impl Fn(Breakpoint) -> f64,
    ) -> Column {
        let (inputs, outputs) = self.scheduled.dataset.input_and_output_names();
        let airspeeds = &self.scheduled.schedule.airspeeds;
        let range_kt = [airspeeds.min_kt, airspeeds.max_kt];
        let mut greatest: Option<TableDeviation> = None;
        for &second in second_values {
            let found = TableDeviation::greatest(
                &self.airspeeds_kt,
                range_kt,
                |airspeed_kt| {
                    value_at(Breakpoint {
                        airspeed_kt,
                        second,
                    })
                },
                |value, truth| quantity.deviation(value, truth),
            );
            greatest = Some(match greatest {
                Some(greatest) => greatest.or_greater(found),
                None => found,
            });
        }
        Column {
            quantity,
            channel,
            name: channel.name(&inputs, &outputs),
            values: self.rows.iter().map(|&row| value_at(row)).collect(),
            deviation: greatest.unwrap_or(TableDeviation {
                value: 0.0,
                airspeed_kt: range_kt[0],
            }),
        }
    }

    fn summary(&self) -> FileSummary {
        FileSummary::Table {
            airspeeds: self.airspeeds_kt.len(),
        }
    }

    /// Returns the notes on the schedule, followed by the greatest deviation of a gain and that of
    /// a time, if they are notable ([`NOTABLE_DEVIATION`]). Deviations of the mixing appear only in
    /// [`Self::remarks`].
    fn export_notes(&self, export: &Export<'_>) -> Vec<ExportNote> {
        let mut notes = export.schedule_notes();
        if let Some(column) = self.worst_column(|quantity| quantity == &GAIN) {
            notes.push(ExportNote::GainTableError {
                channel: column.channel,
                error_percent: column.deviation.value,
                airspeed_kt: column.deviation.airspeed_kt,
                remedy_kt: self.missing_airspeed_kt(column.deviation.airspeed_kt),
            });
        }
        if let Some(column) = self.worst_column(|quantity| quantity.is_time) {
            notes.push(ExportNote::TimeTableError {
                channel: column.channel,
                error_ms: column.deviation.value,
                airspeed_kt: column.deviation.airspeed_kt,
                remedy_kt: self.missing_airspeed_kt(column.deviation.airspeed_kt),
            });
        }
        notes
    }

    /// Returns the column with the greatest deviation among those whose quantity is `included`, if
    /// that deviation is notable.
    fn worst_column(&self, included: impl Fn(&Quantity) -> bool) -> Option<&Column> {
        let mut worst: Option<&Column> = None;
        for column in &self.columns {
            let is_worse = worst.is_none_or(|found| column.deviation.value > found.deviation.value);
            if included(column.quantity) && is_worse {
                worst = Some(column);
            }
        }
        worst.filter(|column| column.deviation.value >= NOTABLE_DEVIATION)
    }

    /// Returns the airspeed \[kt\] of an additional row that would reduce the deviation at
    /// `airspeed_kt`: the nearest multiple of 5 kt, else whole number, else tenth of a knot between
    /// the same rows and in the schedule's range; `None` if there is none.
    fn missing_airspeed_kt(&self, airspeed_kt: f64) -> Option<f64> {
        let range = &self.scheduled.schedule.airspeeds;
        let lower_rows = self
            .airspeeds_kt
            .partition_point(|&row_kt| row_kt < airspeed_kt);
        let (lower, upper) = self.airspeeds_kt.split_at(lower_rows);
        for steps_per_knot in [0.2, 1.0, 10.0] {
            let rounded_kt = (airspeed_kt * steps_per_knot).round() / steps_per_knot;
            let is_between_rows = lower.last().is_none_or(|&row_kt| rounded_kt > row_kt)
                && upper.first().is_none_or(|&row_kt| rounded_kt < row_kt);
            if is_between_rows && (range.min_kt..=range.max_kt).contains(&rounded_kt) {
                return Some(rounded_kt);
            }
        }
        None
    }

    /// Returns the remarks on the schedule, followed by the table's deviations from it.
    fn remarks(&self) -> Vec<String> {
        let mut remarks = self.scheduled.remarks();
        for column in &self.columns {
            if column.deviation.value > 0.0 {
                remarks.push(format!(
                    "table of the {}: maximum error {}",
                    column.words(),
                    column.deviation_words()
                ));
            }
        }
        remarks
    }
}

/// Returns the scheduled conditions' distinct airspeeds \[kt\], increasing.
fn distinct_airspeeds_kt(scheduled: &ExportedSchedule<'_>) -> Vec<f64> {
    let mut airspeeds_kt = scheduled.schedule.airspeeds.values_kt.clone();
    airspeeds_kt.sort_by(f64::total_cmp);
    airspeeds_kt.dedup();
    airspeeds_kt
}

/// Returns the ends and the middle of the second variable's range, which suffice because its effect
/// is nearly linear; a single `None` without a second variable.
fn second_values(scheduled: &ExportedSchedule<'_>) -> Vec<Option<f64>> {
    match &scheduled.schedule.second {
        Some(term) => vec![
            Some(term.range[0]),
            Some(term.middle()),
            Some(term.range[1]),
        ],
        None => vec![None],
    }
}

impl Column {
    fn side(&self) -> &'static str {
        match self.channel {
            Channel::Input(_) => "input",
            Channel::Output(_) => "output",
        }
    }

    /// Describes the column: "gain of input LON".
    fn words(&self) -> String {
        format!("{} of {} {}", self.quantity.name, self.side(), self.name)
    }

    /// Describes the maximum deviation: "1.200e0 % at 62.000 kt".
    fn deviation_words(&self) -> String {
        let unit = if self.quantity.is_time { "ms" } else { "%" };
        let TableDeviation { value, airspeed_kt } = self.deviation;
        if value > 0.0 {
            format!("{value:.3e} {unit} at {airspeed_kt:.3} kt")
        } else {
            format!("{value:.3e} {unit}")
        }
    }
}

#[cfg(test)]
mod tests {
    use gdcm_method::correction::ChannelCorrection;
    use gdcm_method::schedule::{DelayScheduling, SecondVariable};
    use gdcm_model::progress::Unobserved;
    use gdcm_study::{Analysis, Engine, Study};

    use super::*;
    use crate::export::ExportSource;
    use crate::files::dataset_file::embedded_example;
    use crate::formats::text::read_table;
    use crate::formats::variables::Value;
    use crate::reading_budget::ReadingBudget;

    const POINTS: [f64; 4] = [20.0, 45.0, 100.0, 150.0];

    fn analysis(second: Option<SecondVariable>) -> Analysis {
        let mut study = Study::new(embedded_example().unwrap().dataset);
        study.settings.set_delay_scheduling(DelayScheduling::Always);
        study.settings.schedule.second = second;
        Engine::default().analyze(&study, &Unobserved).unwrap()
    }

    fn table<'a>(analysis: &'a Analysis, source: &'a ExportSource) -> BreakpointTable<'a> {
        let schedule = analysis.schedule.as_ref().unwrap();
        let dataset = &analysis.study.dataset;
        let contents = ExportContents::of_scheduled(analysis);
        let scheduled = ExportedSchedule {
            schedule,
            dataset,
            source,
            couplings: None,
            contents,
        };
        BreakpointTable::new(scheduled, Some(&POINTS)).unwrap()
    }

    fn source() -> ExportSource {
        ExportSource {
            name: "example".to_owned(),
            sha256: "ba78".to_owned(),
        }
    }

    #[test]
    fn the_table_holds_the_schedule_at_its_airspeeds() {
        let analysis = analysis(None);
        let source = source();
        let table = table(&analysis, &source);
        let schedule = analysis.schedule.as_ref().unwrap();
        let read = read_table(&table.csv(), &ReadingBudget::new(1 << 20)).unwrap();
        assert_eq!(
            (&read.columns[0][..], read.columns.len()),
            (&POINTS[..], 21)
        );
        assert_eq!(read.units[2].as_deref(), Some("s"));
        let of = |value: &dyn Fn(&ChannelCorrection) -> f64| {
            POINTS.map(|kt| value(&schedule.at(kt))).to_vec()
        };
        assert_eq!(read.columns[3], of(&|correction| correction.input_gains[1]));
        assert_eq!(
            read.columns[10],
            of(&|correction| correction.output_delays_s[0])
        );
        let Value::Struct(of_matlab) = table.variable().value else {
            panic!("no struct")
        };
        let Some([Value::Array(gains)]) = of_matlab.field("input_gains") else {
            panic!("no gains")
        };
        assert_eq!(
            (&gains.shape[..], &gains.re[4..8]),
            (&[4, 4][..], &read.columns[3][..])
        );
        let Some([Value::Array(errors)]) = of_matlab.field("output_delay_error_ms") else {
            panic!("no errors")
        };
        assert_eq!(errors.shape, [1, 6]);
    }

    #[test]
    fn the_greatest_deviation_is_above_the_table_and_airspeeds_must_increase() {
        let analysis = analysis(None);
        let source = source();
        let table = table(&analysis, &source);
        let worst = table.columns[0].deviation;
        assert!(
            worst.value > 0.0 && !POINTS.contains(&worst.airspeed_kt),
            "{worst:?}"
        );
        let line = format!(
            "\n# gain of input LON: {:.3e} % at {:.3} kt\n",
            worst.value, worst.airspeed_kt
        );
        assert!(table.csv().contains(&line), "{}", table.csv());
        for points in [&[][..], &[1.0, 1.0], &[1.0, f64::NAN]] {
            assert!(
                matches!(
                    BreakpointTable::new(table.scheduled.clone(), Some(points)),
                    Err(ExportFault::Breakpoints)
                ),
                "{points:?}"
            );
        }
    }

    #[test]
    fn a_proposed_row_lies_between_the_rows_around_the_deviation() {
        let analysis = analysis(None);
        let source = source();
        let mut table = table(&analysis, &source);
        for (rows_kt, proposed_kt) in [
            ([45.0, 61.0, 70.0, 120.0], Some(65.0)),
            ([45.0, 61.0, 64.0, 120.0], Some(63.0)),
            ([45.0, 62.5, 62.8, 120.0], Some(62.6)),
            ([45.0, 62.61, 62.65, 120.0], None),
        ] {
            table.airspeeds_kt = rows_kt.to_vec();
            assert_eq!(table.missing_airspeed_kt(62.63), proposed_kt, "{rows_kt:?}");
        }
        // The schedule ends at 140 kt, beyond the last row.
        assert_eq!(table.missing_airspeed_kt(139.0), Some(140.0));
        assert_eq!(table.missing_airspeed_kt(139.99), Some(140.0));
    }

    #[test]
    fn every_airspeed_has_three_values_of_a_second_variable() {
        let analysis = analysis(Some(SecondVariable::Altitude));
        let source = source();
        let table = table(&analysis, &source);
        let schedule = analysis.schedule.as_ref().unwrap();
        assert_eq!(table.rows.len(), 3 * POINTS.len());
        let Breakpoint {
            airspeed_kt,
            second,
        } = table.rows[9];
        assert_eq!(
            table.columns[0].values[9],
            schedule.evaluate(airspeed_kt, second).input_gains[0]
        );
        assert!(
            table
                .csv()
                .contains("\nairspeed [kt],altitude [ft],\"gain of input LON [-]\""),
            "{}",
            table.csv()
        );
    }
}
