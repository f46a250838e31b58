//! The gains and delays of a correction at some airspeeds, for lookup tables that are linear between them: in text, and for MATLAB.

use std::fmt::Write;

use super::curve::{LookupTable, comment, number};
use super::matlab_struct::{Fields, cell_of_texts, column, matrix, row, scalar, text};
use super::scheduled_correction::{NamedCurve, ScheduledCorrection, SecondArgument};
use super::{About, Export, ExportFault, Exported, Exporter};
use crate::mat;
use crate::variables::Variable;

/// The lookup table in text.
pub(super) struct TableCsv;
/// The lookup table for MATLAB.
pub(super) struct TableMat;

impl Exporter for TableCsv {
    fn about(&self) -> About {
        About { name: "table-csv", extension: "csv", words: "Lookup table over airspeed, CSV", options: OPTIONS }
    }

    fn export<'e>(&self, of: &Export<'e>) -> Result<Exported<'e>, ExportFault> {
        let (correction, points) = (of.scheduled()?, breakpoints(of)?);
        let remarks = remarks(&correction, &points)?;
        Ok(Exported::bytes(table_csv(&correction, &points)?).with(remarks))
    }
}

impl Exporter for TableMat {
    fn about(&self) -> About {
        About {
            name: "table-mat",
            extension: "mat",
            words: "Lookup table over airspeed, MATLAB data",
            options: OPTIONS,
        }
    }

    fn export<'e>(&self, of: &Export<'e>) -> Result<Exported<'e>, ExportFault> {
        let (correction, points) = (of.scheduled()?, breakpoints(of)?);
        let remarks = remarks(&correction, &points)?;
        Ok(Exported::bytes(mat::write(&[table_variable(&correction, &points)?])?).with(remarks))
    }
}

const OPTIONS: &[&str] = &["--breakpoints"];

/// The airspeeds asked for, or else the distinct ones of the scheduled conditions \[kt\], rising.
fn breakpoints(of: &Export) -> Result<Vec<f64>, ExportFault> {
    if let Some(points) = &of.request.breakpoints_kt {
        return Ok(points.clone());
    }
    let mut airspeeds = of.schedule()?.airspeeds.values_kt.clone();
    airspeeds.sort_by(f64::total_cmp);
    airspeeds.dedup();
    Ok(airspeeds)
}

/// What is to be known of the correction, and how far the table lies from the curves that it does not hold exactly.
fn remarks(correction: &ScheduledCorrection, points: &[f64]) -> Result<Vec<String>, ExportFault> {
    let table = BreakpointTable::of(correction, points)?;
    let columns = table.columns.iter().filter(|column| column.error.error > 0.0);
    let off =
        columns.map(|column| format!("table of the {}: off by up to {}", column.of.words(), column.error_words()));
    Ok(correction.notes.iter().cloned().chain(off).collect())
}

/// All curves of a correction at some airspeeds.
struct BreakpointTable<'c> {
    /// Airspeeds \[kt\], increasing.
    airspeed_kt: Vec<f64>,
    /// Values of the second variable, increasing; none where there is none. Each stands for all airspeeds, one after the other.
    second: Vec<f64>,
    /// One for each gain, each delay and each lead filter.
    columns: Vec<BreakpointColumn<'c>>,
}

/// One curve at the airspeeds of a table.
struct BreakpointColumn<'c> {
    /// The curve, and what it is of.
    of: NamedCurve<'c>,
    /// Its values: gains, or times \[s\].
    values: Vec<f64>,
    /// How far the table lies from it at most: \[%\] of a gain, \[ms\] of a time.
    error: TableError,
}

impl<'c> BreakpointTable<'c> {
    /// The table of a correction at the airspeeds `breakpoints_kt`.
    ///
    /// # Errors
    /// [`ExportFault::Breakpoints`] where these do not increase.
    fn of(correction: &'c ScheduledCorrection, breakpoints_kt: &[f64]) -> Result<Self, ExportFault> {
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
    fn rows(&self) -> Vec<(f64, Option<f64>)> {
        if self.second.is_empty() {
            return self.airspeed_kt.iter().map(|&airspeed| (airspeed, None)).collect();
        }
        let of = |&second: &f64| self.airspeed_kt.iter().map(move |&airspeed| (airspeed, Some(second)));
        self.second.iter().flat_map(of).collect()
    }
}

impl BreakpointColumn<'_> {
    /// The greatest error in words: "1.200e0 % at 62.000 kt".
    fn error_words(&self) -> String {
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

/// Intervals of the grid on which the greatest error is looked for.
const GRID: usize = 2000;
/// Steps of the golden section: each makes the interval 0.618 times as long.
const STEPS: usize = 60;

/// The greatest error of linear interpolation in a table.
#[derive(Clone, Copy, Debug, PartialEq)]
struct TableError {
    /// The error, without a sign, in the unit in which it was measured.
    error: f64,
    /// The airspeed at which it is found \[kt\].
    airspeed_kt: f64,
}

impl TableError {
    /// Finds the greatest error of a table of `curve` at `points` within `range`; `measure` is the error of a value against the
    /// true one. A grid finds the neighbourhood, the golden section the place.
    fn greatest(
        points: &[f64],
        range: (f64, f64),
        curve: impl Fn(f64) -> f64,
        measure: impl Fn(f64, f64) -> f64,
    ) -> Self {
        let values = points.iter().map(|&point| curve(point)).collect();
        let table = LookupTable { airspeed_kt: points.to_vec(), values };
        let error = |x: f64| measure(table.at(x), curve(x));
        let step = (range.1 - range.0) / GRID as f64;
        let mut best = Self { error: error(range.0), airspeed_kt: range.0 };
        for index in 1..=GRID {
            best.improve(error, range.0 + index as f64 * step);
        }
        let (mut low, mut high) = ((best.airspeed_kt - step).max(range.0), (best.airspeed_kt + step).min(range.1));
        let ratio = (5_f64.sqrt() - 1.0) / 2.0;
        for _ in 0..STEPS {
            let (left, right) = (high - ratio * (high - low), low + ratio * (high - low));
            let left_is_greater = error(left) > error(right);
            best.improve(error, if left_is_greater { left } else { right });
            if left_is_greater { high = right } else { low = left }
        }
        best
    }

    fn improve(&mut self, error: impl Fn(f64) -> f64, airspeed_kt: f64) {
        let found = error(airspeed_kt);
        if found > self.error {
            *self = Self { error: found, airspeed_kt };
        }
    }
}

/// Writes a table (CSV) of all gains and delays at the airspeeds `breakpoints_kt`, for lookup tables that are linear between them.
/// Lines that begin with # say what it is and how far each column lies from its curve at most.
pub(super) fn table_csv(correction: &ScheduledCorrection, breakpoints_kt: &[f64]) -> Result<String, ExportFault> {
    let table = BreakpointTable::of(correction, breakpoints_kt)?;
    let mut text = correction.comment_lines("#");
    text.push_str(
        "# Greatest error of linear interpolation in this table, end values outside it, against the curves:\n",
    );
    for column in &table.columns {
        let _ = writeln!(text, "# {}: {}", comment(&column.of.words()), column.error_words());
    }
    text.push_str("airspeed [kt]");
    if let Some(second) = &correction.second {
        let _ = write!(text, ",{}", second.words);
    }
    for BreakpointColumn { of, .. } in &table.columns {
        let unit = if of.is_time() { " [s]" } else { " [-]" };
        let NamedCurve { side, kind, name, .. } = of;
        let _ = write!(text, ",\"{kind} of {side} {}{unit}\"", comment(name).replace('"', "\"\""));
    }
    text.push('\n');
    for (row, (airspeed, second)) in table.rows().into_iter().enumerate() {
        text.push_str(&number(airspeed));
        if let Some(second) = second {
            let _ = write!(text, ",{}", number(second));
        }
        for column in &table.columns {
            let _ = write!(text, ",{}", number(column.values[row]));
        }
        text.push('\n');
    }
    Ok(text)
}

/// The variable `gdcm_table`: the airspeeds `breakpoints_kt`, and for each input and output a column of gains and one of delays \[s\],
/// where there are leads one of their numerators \[s\] too, to be interpolated linearly between them; with the greatest error of that.
fn table_variable(correction: &ScheduledCorrection, breakpoints_kt: &[f64]) -> Result<Variable, ExportFault> {
    let table = BreakpointTable::of(correction, breakpoints_kt)?;
    let rows = table.rows().len();
    let of = |side: &str, kind: &str| -> Vec<&BreakpointColumn<'_>> {
        table.columns.iter().filter(|column| column.of.side == side && column.of.kind == kind).collect()
    };
    let mut fields = Fields::default();
    fields.add("about", cell_of_texts(correction.heading()));
    fields.add("airspeed_kt", column(table.rows().into_iter().map(|(airspeed, _)| airspeed)));
    if let Some(second) = &correction.second {
        fields.add(second.name, column(table.rows().into_iter().filter_map(|(_, second)| second)));
    }
    for (side, channels) in [("input", &correction.inputs), ("output", &correction.outputs)] {
        fields.add(&format!("{side}s"), cell_of_texts(channels.iter().map(|channel| channel.name.clone())));
        let kinds = [("gain", "gain", "percent"), ("delay", "delay", "ms"), ("lead numerator", "lead_numerator", "ms")];
        for (kind, field, unit) in kinds.into_iter().take(if correction.lead.is_some() { 3 } else { 2 }) {
            let columns = of(side, kind);
            let values = columns.iter().flat_map(|column| column.values.iter().copied()).collect();
            let suffix = if kind == "gain" { "" } else { "_s" };
            fields.add(&format!("{side}_{field}s{suffix}"), matrix(rows, columns.len(), values));
            let errors = columns.iter().map(|column| column.error.error);
            fields.add(&format!("{side}_{field}_error_{unit}"), row(errors));
        }
    }
    if let Some(lead) = correction.lead {
        fields.add("lead_order", scalar(lead.order as f64));
        fields.add("lead_lag_s", scalar(lead.lag_s));
    }
    fields.add("interpolation", text("linear between the airspeeds, the end values outside"));
    Ok(Variable { name: "gdcm_table".to_owned(), value: fields.record() })
}

#[cfg(test)]
mod tests {
    use super::super::curve::Curve;
    use super::super::scheduled_correction::tests::example;
    use super::*;
    use crate::text::read_table;
    use crate::variables::{ReadingBudget, Value};

    #[test]
    fn the_error_of_a_parabola_is_greatest_in_the_middle() {
        // x^2 between 0 and h is at most h^2/4 below its chord.
        let found = TableError::greatest(&[0.0, 10.0, 16.0], (0.0, 16.0), |x| x * x, |a, b| (a - b).abs());
        assert!((found.error - 25.0).abs() < 1e-12 && (found.airspeed_kt - 5.0).abs() < 1e-5, "{found:?}");
    }

    #[test]
    fn beyond_the_table_its_end_values_count() {
        let found = TableError::greatest(&[2.0, 4.0], (0.0, 4.0), |x| x, |a, b| (a - b).abs());
        assert_eq!(found, TableError { error: 2.0, airspeed_kt: 0.0 });
    }

    const POINTS: [f64; 5] = [0.0, 20.0, 40.0, 60.0, 80.0];

    #[test]
    fn the_table_holds_the_curves_at_its_airspeeds() {
        let correction = example();
        let text = table_csv(&correction, &POINTS).unwrap();
        let table = read_table(&text, &ReadingBudget::new(1 << 20)).unwrap();
        assert_eq!(table.columns[0], POINTS);
        assert_eq!(table.columns.len(), 7);
        assert_eq!(table.units[2].as_deref(), Some("s"));
        for (named, column) in correction.curves().zip(&table.columns[1..]) {
            let expected: Vec<f64> = POINTS.iter().map(|&point| named.curve.at(correction.clamp(point))).collect();
            assert_eq!(column, &expected);
        }
    }

    #[test]
    fn the_greatest_error_stands_above_the_table() {
        let mut correction = example();
        correction.inputs.truncate(1);
        correction.outputs.clear();
        correction.inputs[0].name = "LAT".to_owned();
        let coefficients = vec![0.0, 0.0, 0.16];
        correction.inputs[0].delay_s = Curve::Polynomial { of_logarithm: false, coefficients };
        let text = table_csv(&correction, &[0.0, 80.0]).unwrap();
        assert!(text.contains("# delay of input LAT: 1.600e2 ms at 40.000 kt"), "{text}");
        assert_eq!(table_csv(&correction, &[]), Err(ExportFault::Breakpoints));
    }

    #[test]
    fn each_channel_has_a_column_of_gains_and_one_of_delays() {
        let correction = example();
        let points = [0.0, 30.0, 80.0];
        let Value::Struct(table) = table_variable(&correction, &points).unwrap().value else { panic!("no struct") };
        for (field, curve) in
            [("input_gains", &correction.inputs[1].gain), ("input_delays_s", &correction.inputs[1].delay_s)]
        {
            let Some([Value::Array(array)]) = table.field(field) else { panic!("no {field}") };
            assert_eq!(array.shape, [3, 2]);
            assert_eq!(array.re[3..], points.map(|point| curve.at(correction.clamp(point))), "{field}, second column");
        }
        let Some([Value::Array(errors)]) = table.field("output_delay_error_ms") else { panic!("no errors") };
        assert_eq!(errors.shape, [1, 1]);
    }
}
