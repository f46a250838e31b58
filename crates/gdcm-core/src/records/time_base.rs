//! What says when the samples of a record were taken.

use super::*;
use crate::assembly::{Dimension, PhysicalUnit, time_name_rank};

/// What says when the samples of a record were taken.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum TimeBase {
    /// A column of stamps.
    Column {
        /// Its index.
        column: usize,
        /// Seconds in one of its units.
        seconds: f64,
    },
    /// One sample each so many seconds.
    SampleTime(f64),
    /// The stamps that each topic has of its own.
    Topics,
}

/// Steps longer than this \[s\] are no samples of a manoeuvre.
pub(super) const LONGEST_STEP_S: f64 = 1.5;
/// Steps shorter than this \[s\] are no samples of a flight recorder.
const SHORTEST_STEP_S: f64 = 5e-5;
const SECONDS_A_DAY: f64 = 86_400.0;

impl TimeBase {
    /// Times of the samples \[s\]; not a number where a stamp is missing.
    pub fn times_s(self, table: &RecordTable) -> Vec<f64> {
        match self {
            TimeBase::SampleTime(step_s) => (0..table.rows()).map(|sample| sample as f64 * step_s).collect(),
            TimeBase::Topics => Vec::new(),
            TimeBase::Column { column, seconds } => {
                let stamps = table.columns.get(column).map_or(&[][..], |column| &column.values);
                stamps.iter().map(|stamp| if stamp.is_finite() { stamp * seconds } else { f64::NAN }).collect()
            }
        }
    }

    /// The median step \[s\]; none where there are no two stamps.
    pub fn step_s(self, table: &RecordTable) -> Option<f64> {
        match self {
            TimeBase::SampleTime(step_s) => Some(step_s),
            TimeBase::Topics => None,
            TimeBase::Column { column, seconds } => Some(median_step(&table.columns.get(column)?.values)? * seconds),
        }
    }

    /// The unit of a column of stamps and what says so: its unit, the end of its name, or else the length of its steps.
    pub(super) fn of_column(table: &RecordTable, column: usize) -> (Self, String) {
        let stamps = &table.columns[column];
        let (unit, why) = unit_of(stamps);
        (
            TimeBase::Column { column, seconds: unit.1 },
            format!("time from column {}, in {}{why}", table.quoted(column), unit.0),
        )
    }

    /// The column that is the time by its name, or by being the first and rising in a table without names.
    pub(super) fn find(table: &RecordTable) -> Option<usize> {
        let rank = |index: usize| {
            let column = &table.columns[index];
            let by_name = if table.named { time_name_rank(&column.name) } else { (index == 0).then_some(2) }?;
            // A column that stands still or falls most of the time is a time by its name only.
            Some((u8::from(!mostly_rises(&column.values)), by_name, index))
        };
        let best = (0..table.columns.len()).filter_map(rank).min()?;
        (table.named || best.0 == 0).then_some(best.2)
    }
}

/// Seconds in a unit of time, and its usual spelling.
fn seconds_in(unit: &str) -> Option<(&'static str, f64)> {
    let unit = PhysicalUnit::of(unit).filter(|unit| unit.dimension == Dimension::Time)?;
    Some((unit.name, unit.size))
}

fn unit_of(stamps: &RecordColumn) -> ((&'static str, f64), String) {
    if let Some(unit) = stamps.unit.as_deref().and_then(seconds_in) {
        return (unit, String::new());
    }
    let last_word = stamps.name.rsplit(|c: char| !c.is_alphanumeric()).next().filter(|word| *word != stamps.name);
    if let Some(unit) = last_word.and_then(seconds_in) {
        return (unit, String::new());
    }
    let step = median_step(&stamps.values).unwrap_or(f64::NAN);
    let told = |unit: &'static str| {
        format!(
            " (its steps are {}: {unit} would be too {})",
            told_step(step),
            if step > 1.0 { "long" } else { "short" }
        )
    };
    // Thousandths that are too short once more are millionths.
    let units = [("ms", 1e-3), ("µs", 1e-6), ("ns", 1e-9)];
    if step > LONGEST_STEP_S {
        let fits = |unit: &&(&str, f64)| (2e-4..=LONGEST_STEP_S).contains(&(step * unit.1));
        return units.iter().find(fits).map_or((("s", 1.0), String::new()), |unit| (*unit, told("s")));
    }
    if step > 0.0 && step < SHORTEST_STEP_S && (2e-4..=LONGEST_STEP_S).contains(&(step * SECONDS_A_DAY)) {
        return (("days", SECONDS_A_DAY), told("s"));
    }
    (("s", 1.0), " (the file does not say the unit)".to_owned())
}

fn told_step(step: f64) -> String {
    crate::units::telling(step, 3)
}

/// Median of the steps between stamps that follow one another.
pub fn median_step(stamps: &[f64]) -> Option<f64> {
    let steps = stamps.windows(2).map(|pair| pair[1] - pair[0]);
    let mut steps: Vec<f64> = steps.filter(|step| step.is_finite()).collect();
    let middle = steps.len() / 2;
    (!steps.is_empty()).then(|| *steps.select_nth_unstable_by(middle, f64::total_cmp).1)
}

fn mostly_rises(stamps: &[f64]) -> bool {
    let steps = stamps.windows(2).map(|pair| pair[1] - pair[0]).filter(|step| step.is_finite());
    let (rising, all) = steps.fold((0, 0), |(rising, all), step| (rising + usize::from(step > 0.0), all + 1));
    all > 0 && 2 * rising > all
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table(name: &str, unit: Option<&str>, stamps: Vec<f64>) -> RecordTable {
        let column = RecordColumn { unit: unit.map(str::to_owned), ..RecordColumn::new(name, stamps) };
        RecordTable {
            name: "r".into(),
            columns: vec![RecordColumn::new("time constant", vec![1.0; column.values.len()]), column],
            named: true,
            sample_time_s: None,
            ..RecordTable::new("r", Vec::new())
        }
    }

    fn stamps(step: f64) -> Vec<f64> {
        (0..50).map(|sample| 3.0 + step * f64::from(sample)).collect()
    }

    #[test]
    fn the_time_is_found_by_its_name_and_by_rising() {
        for name in ["t", "Time", "time_s", "TIME [s]", "Elapsed", "real,_time", "t_ms", "timestamp"] {
            assert_eq!(TimeBase::find(&table(name, None, stamps(0.02))), Some(1), "{name}");
        }
        assert_eq!(TimeBase::find(&table("theta", None, stamps(0.02))), Some(0), "by its name only");
        let mut unnamed = table("column 2", None, stamps(0.02));
        unnamed.named = false;
        assert_eq!(TimeBase::find(&unnamed), None, "its first column does not rise");
        unnamed.columns.swap(0, 1);
        assert_eq!(TimeBase::find(&unnamed), Some(0));
    }

    #[test]
    fn the_unit_of_time_is_said_by_the_file_or_by_the_length_of_the_steps() {
        let seconds = |name, unit, step| match TimeBase::of_column(&table(name, unit, stamps(step)), 1) {
            (TimeBase::Column { seconds, .. }, words) => (seconds, words),
            _ => panic!("it is a column"),
        };
        assert_eq!(seconds("t", Some("ms"), 20.0), (1e-3, "time from column \"t\", in ms".to_owned()));
        assert_eq!(seconds("time_ms", None, 20.0).0, 1e-3);
        assert_eq!(seconds("time_s", None, 20.0).0, 1.0, "as the file says: it is for the checks to doubt it");
        assert_eq!(
            seconds("t", None, 0.02),
            (1.0, "time from column \"t\", in s (the file does not say the unit)".into())
        );
        let (by_steps, words) = seconds("t", None, 20.0);
        assert_eq!(
            (by_steps, words.as_str()),
            (1e-3, "time from column \"t\", in ms (its steps are 20.000: s would be too long)")
        );
        assert_eq!(seconds("t", None, 20_000.0).0, 1e-6);
        assert_eq!(seconds("t", None, 0.02 / 86_400.0).0, 86_400.0, "days, as Excel and MATLAB count them");
    }

    #[test]
    fn a_missing_stamp_is_no_number_and_does_not_move_the_median() {
        let mut gaps = stamps(20.0);
        gaps[7] = f64::INFINITY;
        let table = table("t", Some("ms"), gaps);
        let base = TimeBase::of_column(&table, 1).0;
        assert!(base.times_s(&table)[7].is_nan());
        assert!((base.step_s(&table).unwrap() - 0.02).abs() < 1e-15, "one rounding of the factor");
        assert_eq!(TimeBase::SampleTime(0.5).times_s(&table)[3], 1.5);
    }
}
