//! The gains and delays of a schedule at given airspeeds, for lookup tables with linear
//! interpolation: as text, and for MATLAB.

use std::fmt::Write;
use std::iter::once;

use gdcm_method::correction::Channel;
use gdcm_plot::figure::all_channels;

use super::matlab_struct::{Fields, cell_of_texts, column, matrix, row};
use super::programs::comment;
use super::scheduled::{Scheduled, number};
use super::{ExportFormat, Exported};
use crate::export_fault::ExportFault;
use crate::files::export_contents::ExportContents;
use crate::formats::mat;
use crate::formats::variables::{Value, Variable};

/// The lookup table as text.
pub(super) const CSV: ExportFormat = ExportFormat {
    name: "table-csv",
    extension: "csv",
    words: "Lookup table over airspeed, CSV",
    options: OPTIONS,
    check_path: |_| Ok(()),
    contents: |analysis, _| ExportContents::of_scheduled(analysis),
    export: |of| {
        let table = BreakpointTable::of(of.scheduled()?, of.request.breakpoints_kt.as_deref())?;
        Ok(Exported::bytes(table.csv()).with(table.remarks()))
    },
};

/// The lookup table for MATLAB.
pub(super) const MAT: ExportFormat = ExportFormat {
    name: "table-mat",
    extension: "mat",
    words: "Lookup table over airspeed, MATLAB data",
    options: OPTIONS,
    check_path: |_| Ok(()),
    contents: |analysis, _| ExportContents::of_scheduled(analysis),
    export: |of| {
        let table = BreakpointTable::of(of.scheduled()?, of.request.breakpoints_kt.as_deref())?;
        Ok(Exported::bytes(mat::write(&[table.variable()])?).with(table.remarks()))
    },
};

const OPTIONS: &[&str] = &["--breakpoints"];

/// Quantity of a column: a gain, or a time \[s\].
#[derive(Debug, PartialEq)]
struct Kind {
    name: &'static str,
    /// Part of the field names.
    field: &'static str,
    is_time: bool,
}

const GAIN: Kind = Kind {
    name: "gain",
    field: "gains",
    is_time: false,
};
const DELAY: Kind = Kind {
    name: "delay",
    field: "delays_s",
    is_time: true,
};
const MIXING: Kind = Kind {
    name: "mixing",
    field: "mixing",
    is_time: false,
};
const LEAD: Kind = Kind {
    name: "lead numerator",
    field: "lead_numerators_s",
    is_time: true,
};

impl Kind {
    /// Returns the error of a value against the true value: \[%\] for a gain, \[ms\] for a time.
    fn error(&self, value: f64, truth: f64) -> f64 {
        match value - truth {
            // Both zero: no error; the percentage error of a table that misses a zero is undefined.
            0.0 => 0.0,
            difference if self.is_time => 1e3 * difference.abs(),
            difference => 100.0 * (difference / truth).abs(),
        }
    }
}

/// A schedule at given airspeeds.
struct BreakpointTable<'e> {
    of: Scheduled<'e>,
    /// Airspeeds \[kt\], increasing.
    airspeeds_kt: Vec<f64>,
    /// Airspeed and second variable of each row: all airspeeds for each value of the second
    /// variable.
    rows: Vec<(f64, Option<f64>)>,
    /// One for each gain, each delay and each lead filter: of every input, then of every output.
    columns: Vec<Column>,
}

/// Values of a channel at the airspeeds of a table.
struct Column {
    kind: &'static Kind,
    channel: Channel,
    name: String,
    values: Vec<f64>,
    /// Largest deviation of the table from the schedule: \[%\] for a gain, \[ms\] for a time.
    error: TableError,
}

impl<'e> BreakpointTable<'e> {
    /// Builds the table at the requested airspeeds, by default at the distinct airspeeds of the
    /// scheduled conditions \[kt\].
    ///
    /// # Errors
    /// [`ExportFault::Breakpoints`] if these do not increase.
    fn of(of: Scheduled<'e>, breakpoints_kt: Option<&[f64]>) -> Result<Self, ExportFault> {
        of.check()?;
        let distinct = || {
            let mut airspeeds_kt = of.schedule.airspeeds.values_kt.clone();
            airspeeds_kt.sort_by(f64::total_cmp);
            airspeeds_kt.dedup();
            airspeeds_kt
        };
        let airspeeds_kt = breakpoints_kt.map_or_else(distinct, <[f64]>::to_vec);
        let increasing = airspeeds_kt.windows(2).all(|pair| pair[0] < pair[1]);
        if airspeeds_kt.is_empty()
            || !increasing
            || !airspeeds_kt.iter().all(|point| point.is_finite())
        {
            return Err(ExportFault::Breakpoints);
        }
        // Ends and middle: between them the effect is nearly linear.
        let second = of.schedule.second.as_ref().map_or_else(
            || vec![None],
            |term| {
                [term.range[0], term.middle(), term.range[1]]
                    .map(Some)
                    .to_vec()
            },
        );
        let at = |second: Option<f64>| {
            airspeeds_kt
                .iter()
                .map(move |&airspeed_kt| (airspeed_kt, second))
        };
        let rows = second.iter().flat_map(|&second| at(second)).collect();
        let mut table = Self {
            of: of.clone(),
            airspeeds_kt,
            rows,
            columns: Vec::new(),
        };
        for channel in all_channels(of.dataset) {
            let evaluate = |kt, second| of.schedule.evaluate(kt, second);
            let gain = |kt, second| evaluate(kt, second).gain(channel);
            let delay_s = |kt, second| evaluate(kt, second).pure_delay_s(channel);
            table
                .columns
                .push(table.column(channel, &GAIN, &second, gain));
            table
                .columns
                .push(table.column(channel, &DELAY, &second, delay_s));
            if let Some(zero_s) = of.zero_s(channel) {
                let zero_s = |kt, _| zero_s.figures.at(&of.schedule.airspeeds, kt);
                table
                    .columns
                    .push(table.column(channel, &LEAD, &second, zero_s));
            }
        }
        table.add_mixing();
        Ok(table)
    }

    /// Adds the weights of each input in each input, if there are couplings: for the first input
    /// first.
    fn add_mixing(&mut self) {
        let (Some(couplings), count) = (self.of.couplings, self.of.dataset.inputs().len()) else {
            return;
        };
        let (inputs, _) = self.of.dataset.names_of_channels();
        for (to, from) in (0..count).flat_map(|to| (0..count).map(move |from| (to, from))) {
            let of = self.column(Channel::Input(to), &MIXING, &[None], |kt, _| {
                couplings.normalised_mixing(kt)[(to, from)]
            });
            let values = self
                .rows
                .iter()
                .map(|(kt, _)| couplings.normalised_mixing(*kt)[(to, from)])
                .collect();
            self.columns.push(Column {
                name: format!("{} from {}", inputs[to], inputs[from]),
                values,
                ..of
            });
        }
    }

    /// Returns the column of values at an airspeed \[kt\] and each of these values of the second
    /// variable.
    fn column(
        &self,
        channel: Channel,
        kind: &'static Kind,
        second: &[Option<f64>],
        value: impl Fn(f64, Option<f64>) -> f64,
    ) -> Column {
        let (inputs, outputs) = self.of.dataset.names_of_channels();
        let airspeeds = &self.of.schedule.airspeeds;
        let range_kt = [airspeeds.min_kt, airspeeds.max_kt];
        let errors = second.iter().map(|&second| {
            let truth = |airspeed_kt: f64| value(airspeed_kt, second);
            TableError::greatest(&self.airspeeds_kt, range_kt, truth, |value, truth| {
                kind.error(value, truth)
            })
        });
        let worst = |worst: TableError, found: TableError| {
            if found.error > worst.error {
                found
            } else {
                worst
            }
        };
        let none = TableError {
            error: 0.0,
            airspeed_kt: range_kt[0],
        };
        Column {
            kind,
            channel,
            name: channel.name(&inputs, &outputs),
            values: self
                .rows
                .iter()
                .map(|&(airspeed_kt, second)| value(airspeed_kt, second))
                .collect(),
            error: errors.reduce(worst).unwrap_or(none),
        }
    }

    /// Returns remarks on the schedule, and the deviations of the table from it.
    fn remarks(&self) -> Vec<String> {
        let off = self
            .columns
            .iter()
            .filter(|column| column.error.error > 0.0);
        let off = off.map(|column| {
            format!(
                "table of the {}: off by up to {}",
                column.words(),
                column.error_words()
            )
        });
        self.of.notes().into_iter().chain(off).collect()
    }

    /// Writes the table as CSV, preceded by lines with # that describe it and the largest deviation
    /// of each column from its curve.
    fn csv(&self) -> String {
        let mut text: String = self
            .of
            .heading(&self.of.notes())
            .iter()
            .map(|line| format!("# {line}\n"))
            .collect();
        text.push_str(
            "# Greatest error of linear interpolation in this table, end values outside it, against the curves:\n",
        );
        for column in &self.columns {
            let _ = writeln!(
                text,
                "# {}: {}",
                comment(&column.words()),
                column.error_words()
            );
        }
        for line in self.feedback_lines() {
            let _ = writeln!(text, "# {line}");
        }
        text.push_str("airspeed [kt]");
        if let Some(term) = &self.of.schedule.second {
            let _ = write!(text, ",{} [{}]", term.variable.name(), term.variable.unit());
        }
        for column in &self.columns {
            let unit = if column.kind.is_time { "s" } else { "-" };
            let _ = write!(
                text,
                ",\"{} [{unit}]\"",
                comment(&column.words()).replace('"', "\"\"")
            );
        }
        text.push('\n');
        for (row, (airspeed_kt, second)) in self.rows.iter().enumerate() {
            let values = self.columns.iter().map(|column| column.values[row]);
            let cells = once(*airspeed_kt).chain(*second).chain(values).map(number);
            text.push_str(&cells.collect::<Vec<_>>().join(","));
            text.push('\n');
        }
        text
    }

    /// Returns the feedback, a line for each receiving input; empty without couplings.
    fn feedback_lines(&self) -> Vec<String> {
        let Some(couplings) = self.of.couplings else {
            return Vec::new();
        };
        let (inputs, outputs) = self.of.dataset.names_of_channels();
        let line = |to: usize| {
            let of = |from: usize| {
                format!(
                    "{} {}",
                    comment(&outputs[from]),
                    number(couplings.feedback()[(to, from)])
                )
            };
            let entries: Vec<String> = (0..outputs.len()).map(of).collect();
            format!(
                "feedback to input {}: {}",
                comment(&inputs[to]),
                entries.join(", ")
            )
        };
        (0..inputs.len()).map(line).collect()
    }

    /// Returns the variable `gdcm_table`: the airspeeds, and for each input and output a column of
    /// gains and one of delays \[s\], with leads also one of their numerators \[s\], for linear
    /// interpolation; with its largest error.
    fn variable(&self) -> Variable {
        let schedule = self.of.schedule;
        let (inputs, outputs) = self.of.dataset.names_of_channels();
        let mut fields = Fields::default();
        fields.add("about", cell_of_texts(self.of.heading(&self.of.notes())));
        fields.add(
            "airspeed_kt",
            column(self.rows.iter().map(|(airspeed_kt, _)| *airspeed_kt)),
        );
        if let Some(term) = &schedule.second {
            let name = format!("{}_{}", term.variable.name(), term.variable.unit());
            fields.add(
                &name,
                column(self.rows.iter().filter_map(|(_, second)| *second)),
            );
        }
        for (side, names) in [("input", inputs), ("output", outputs)] {
            fields.add(&format!("{side}s"), cell_of_texts(names));
            for kind in [&GAIN, &DELAY, &LEAD]
                .into_iter()
                .take(if schedule.leads.is_some() { 3 } else { 2 })
            {
                let is_of = |column: &&Column| column.side() == side && column.kind == kind;
                let columns: Vec<&Column> = self.columns.iter().filter(is_of).collect();
                let values = columns
                    .iter()
                    .flat_map(|column| column.values.iter().copied())
                    .collect();
                fields.add(
                    &format!("{side}_{}", kind.field),
                    matrix(self.rows.len(), columns.len(), values),
                );
                let unit = if kind.is_time { "ms" } else { "percent" };
                let name = format!("{side}_{}_error_{unit}", kind.name.replace(' ', "_"));
                fields.add(&name, row(columns.iter().map(|column| column.error.error)));
            }
        }
        if let Some(couplings) = self.of.couplings {
            let columns: Vec<&Column> = self
                .columns
                .iter()
                .filter(|column| column.kind == &MIXING)
                .collect();
            let values = columns
                .iter()
                .flat_map(|column| column.values.iter().copied())
                .collect();
            fields.add("mixing", matrix(self.rows.len(), columns.len(), values));
            fields.add(
                "mixing_of",
                cell_of_texts(columns.iter().map(|column| column.name.clone())),
            );
            let feedback = couplings.feedback();
            fields.add(
                "feedback",
                matrix(
                    feedback.nrows(),
                    feedback.ncols(),
                    feedback.as_slice().to_vec(),
                ),
            );
        }
        if let Some(leads) = &schedule.leads {
            fields.add(
                "lead_order",
                Value::number(leads.design.settings().order.number() as f64),
            );
            fields.add("lead_lag_s", Value::number(leads.design.lag_s()));
        }
        if let Some(price) = schedule.lead_price() {
            fields.add("not_valid_above_rad_s", Value::number(price.limit_rad_s));
            fields.add(
                "input_gain_above_band_db",
                row(price.gains_db.inputs.iter().copied()),
            );
            fields.add(
                "output_gain_above_band_db",
                row(price.gains_db.outputs.iter().copied()),
            );
        }
        let mut contains = Fields::default();
        for (name, source) in self.of.contents.parts() {
            contains.add(name, Value::text(source.word()));
        }
        contains.add(
            "left_out",
            cell_of_texts(self.of.contents.left_out_words(self.of.dataset)),
        );
        fields.add("contains", contains.record());
        fields.add(
            "interpolation",
            Value::text("linear between the airspeeds, the end values outside"),
        );
        Variable {
            name: "gdcm_table".to_owned(),
            value: fields.record(),
        }
    }
}

impl Column {
    fn side(&self) -> &'static str {
        if matches!(self.channel, Channel::Input(_)) {
            "input"
        } else {
            "output"
        }
    }

    /// Describes the column: "gain of input LON".
    fn words(&self) -> String {
        format!("{} of {} {}", self.kind.name, self.side(), self.name)
    }

    /// Describes the largest error: "1.200e0 % at 62.000 kt".
    fn error_words(&self) -> String {
        let unit = if self.kind.is_time { "ms" } else { "%" };
        let TableError { error, airspeed_kt } = self.error;
        let place = if error > 0.0 {
            format!(" at {airspeed_kt:.3} kt")
        } else {
            String::new()
        };
        format!("{error:.3e} {unit}{place}")
    }
}

/// Intervals of the grid in the search for the largest error.
const GRID: usize = 2000;
/// Steps of the golden-section search: each multiplies the interval by 0.618.
const STEPS: usize = 60;

/// The largest error of linear interpolation in a table.
#[derive(Clone, Copy, Debug, PartialEq)]
struct TableError {
    /// The absolute error, in the unit of measurement.
    error: f64,
    /// The airspeed of the largest error \[kt\].
    airspeed_kt: f64,
}

impl TableError {
    /// Finds the largest error of a table of `curve` at `points` within `range`; `measure` returns
    /// the error of a value against the true value. A grid finds the neighbourhood, a
    /// golden-section search the location.
    fn greatest(
        points: &[f64],
        range_kt: [f64; 2],
        curve: impl Fn(f64) -> f64,
        measure: impl Fn(f64, f64) -> f64,
    ) -> Self {
        let values: Vec<f64> = points.iter().map(|&point| curve(point)).collect();
        let error = |x: f64| measure(interpolated(points, &values, x), curve(x));
        let [least, most] = range_kt;
        let step = (most - least) / GRID as f64;
        let mut best = Self {
            error: error(least),
            airspeed_kt: least,
        };
        for index in 1..=GRID {
            best.improve(error, least + index as f64 * step);
        }
        let mut low = (best.airspeed_kt - step).max(least);
        let mut high = (best.airspeed_kt + step).min(most);
        let ratio = (5_f64.sqrt() - 1.0) / 2.0;
        for _ in 0..STEPS {
            let left = high - ratio * (high - low);
            let right = low + ratio * (high - low);
            let left_is_greater = error(left) > error(right);
            best.improve(error, if left_is_greater { left } else { right });
            if left_is_greater {
                high = right
            } else {
                low = left
            }
        }
        best
    }

    fn improve(&mut self, error: impl Fn(f64) -> f64, airspeed_kt: f64) {
        let found = error(airspeed_kt);
        if found > self.error {
            *self = Self {
                error: found,
                airspeed_kt,
            };
        }
    }
}

/// Interpolates a table at an airspeed: linear between its points, the end values outside.
fn interpolated(points: &[f64], values: &[f64], airspeed_kt: f64) -> f64 {
    let above = points.partition_point(|&point| point <= airspeed_kt);
    match (above.checked_sub(1), points.get(above)) {
        (None, _) => values[0],
        (Some(below), None) => values[below],
        (Some(below), Some(&end)) => {
            let part = (airspeed_kt - points[below]) / (end - points[below]);
            values[below] + part * (values[above] - values[below])
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

    #[test]
    fn the_error_of_a_parabola_is_greatest_in_the_middle() {
        // x^2 between 0 and h is at most h^2/4 below its chord.
        let found = TableError::greatest(
            &[0.0, 10.0, 16.0],
            [0.0, 16.0],
            |x| x * x,
            |a, b| (a - b).abs(),
        );
        assert!(
            (found.error - 25.0).abs() < 1e-12 && (found.airspeed_kt - 5.0).abs() < 1e-5,
            "{found:?}"
        );
    }

    #[test]
    fn beyond_the_table_its_end_values_count() {
        let found = TableError::greatest(&[2.0, 4.0], [0.0, 4.0], |x| x, |a, b| (a - b).abs());
        assert_eq!(
            found,
            TableError {
                error: 2.0,
                airspeed_kt: 0.0
            }
        );
    }

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
        let of = Scheduled {
            schedule,
            dataset,
            source,
            couplings: None,
            contents,
        };
        BreakpointTable::of(of, Some(&POINTS)).unwrap()
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
    fn the_greatest_error_stands_above_the_table_and_airspeeds_have_to_increase() {
        let analysis = analysis(None);
        let source = source();
        let table = table(&analysis, &source);
        let worst = table.columns[0].error;
        assert!(
            worst.error > 0.0 && !POINTS.contains(&worst.airspeed_kt),
            "{worst:?}"
        );
        let line = format!(
            "\n# gain of input LON: {:.3e} % at {:.3} kt\n",
            worst.error, worst.airspeed_kt
        );
        assert!(table.csv().contains(&line), "{}", table.csv());
        for points in [&[][..], &[1.0, 1.0], &[1.0, f64::NAN]] {
            assert!(
                matches!(
                    BreakpointTable::of(table.of.clone(), Some(points)),
                    Err(ExportFault::Breakpoints)
                ),
                "{points:?}"
            );
        }
    }

    #[test]
    fn every_airspeed_stands_at_three_values_of_a_second_variable() {
        let analysis = analysis(Some(SecondVariable::Altitude));
        let source = source();
        let table = table(&analysis, &source);
        let schedule = analysis.schedule.as_ref().unwrap();
        assert_eq!(table.rows.len(), 3 * POINTS.len());
        let (airspeed_kt, altitude) = table.rows[9];
        assert_eq!(
            table.columns[0].values[9],
            schedule.evaluate(airspeed_kt, altitude).input_gains[0]
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
