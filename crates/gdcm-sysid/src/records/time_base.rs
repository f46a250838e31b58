//! Where a record's sample times come from: a stamp column, a sample time, or topics (groups of
//! columns that share stamps of their own).

use gdcm_model::names::time_name::time_name_rank;

use super::layout_note::LayoutNote;
use super::record_table::RecordTable;
use super::sample_step::median_step;
use super::stamp_unit::StampUnit;

/// Where the sample times come from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum TimeBase {
    /// A stamp column.
    Column {
        column: usize,
        /// Seconds per column unit.
        seconds: f64,
    },
    /// Equidistant samples with this sample time \[s\].
    SampleTime(f64),
    /// Each topic's own stamps.
    Topics,
}

/// How likely a column is the time column; the smallest rank is the most likely. The fields are
/// compared in their order.
#[derive(PartialEq, Eq, PartialOrd, Ord)]
struct TimeRank {
    /// Whether the column mostly repeats or decreases; only its name can then suggest a time.
    mostly_falls: bool,
    by_name: u8,
    column: usize,
}

impl TimeRank {
    /// Ranks a column; `None` if it is not named like a time. Without names only the first
    /// column can be the time.
    fn new(table: &RecordTable, column: usize) -> Option<Self> {
        let candidate = &table.columns[column];
        let by_name = if table.named {
            time_name_rank(&candidate.name)?
        } else if column == 0 {
            // Any rank: this column is the only candidate.
            2
        } else {
            return None;
        };
        Some(Self {
            mostly_falls: !mostly_rises(&candidate.values),
            by_name,
            column,
        })
    }
}

impl TimeBase {
    /// Returns the sample times \[s\]; NaN where a stamp is missing, empty for topics.
    pub fn times_s(self, table: &RecordTable) -> Vec<f64> {
        match self {
            TimeBase::SampleTime(step_s) => (0..table.rows())
                .map(|sample| sample as f64 * step_s)
                .collect(),
            TimeBase::Topics => Vec::new(),
            TimeBase::Column { column, seconds } => match table.columns.get(column) {
                Some(stamps) => stamps
                    .values
                    .iter()
                    .map(|stamp| finite_product(*stamp, seconds))
                    .collect(),
                None => Vec::new(),
            },
        }
    }

    /// Returns the median step \[s\]; `None` for topics, and without two adjacent stamps.
    pub fn step_s(self, table: &RecordTable) -> Option<f64> {
        match self {
            TimeBase::SampleTime(step_s) => Some(step_s),
            TimeBase::Topics => None,
            TimeBase::Column { column, seconds } => {
                Some(median_step(&table.columns.get(column)?.values)? * seconds)
            }
        }
    }

    /// Returns the time base from a stamp column, in the unit that [`StampUnit`] determines.
    pub(super) fn from_column(table: &RecordTable, column: usize) -> Self {
        TimeBase::Column {
            column,
            seconds: StampUnit::new(&table.columns[column]).seconds,
        }
    }

    /// Describes a stamp column, with the reason for its unit.
    pub(super) fn column_note(table: &RecordTable, column: usize) -> LayoutNote {
        let unit = StampUnit::new(&table.columns[column]);
        LayoutNote::TimeColumn {
            column: table.quoted(column),
            unit: unit.name,
            reason: unit.reason,
        }
    }

    /// Finds the time column by its name, among several by preference one that mostly increases; in
    /// a table without column names, the first column if it mostly increases.
    pub(super) fn find(table: &RecordTable) -> Option<usize> {
        let best = (0..table.columns.len())
            .filter_map(|column| TimeRank::new(table, column))
            .min()?;
        if table.named || !best.mostly_falls {
            Some(best.column)
        } else {
            None
        }
    }
}

/// Returns a stamp in seconds; NaN if it is not finite.
fn finite_product(stamp: f64, seconds: f64) -> f64 {
    if stamp.is_finite() {
        stamp * seconds
    } else {
        f64::NAN
    }
}

/// Returns whether more than half the finite steps are positive.
fn mostly_rises(stamps: &[f64]) -> bool {
    let mut rising = 0;
    let mut total = 0;
    for pair in stamps.windows(2) {
        let step = pair[1] - pair[0];
        if step.is_finite() {
            total += 1;
            rising += usize::from(step > 0.0);
        }
    }
    2 * rising > total
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::records::layout_note::TimeUnitReason;
    use crate::records::record_table::RecordColumn;

    fn table_with(name: &str, unit: Option<&str>, stamps: Vec<f64>) -> RecordTable {
        let constant = RecordColumn::new("time constant", vec![1.0; stamps.len()]);
        let column = RecordColumn {
            unit: unit.map(str::to_owned),
            ..RecordColumn::new(name, stamps)
        };
        RecordTable::new("r", vec![constant, column])
    }

    fn stamps(step: f64) -> Vec<f64> {
        (0..50)
            .map(|sample| 3.0 + step * f64::from(sample))
            .collect()
    }

    #[test]
    fn the_time_is_found_by_its_name_and_by_rising() {
        for name in [
            "t",
            "Time",
            "time_s",
            "TIME [s]",
            "Elapsed",
            "real,_time",
            "t_ms",
            "timestamp",
        ] {
            assert_eq!(
                TimeBase::find(&table_with(name, None, stamps(0.02))),
                Some(1),
                "{name}"
            );
        }
        assert_eq!(
            TimeBase::find(&table_with("theta", None, stamps(0.02))),
            Some(0),
            "by its name only"
        );
        let mut unnamed = table_with("column 2", None, stamps(0.02));
        unnamed.named = false;
        assert_eq!(
            TimeBase::find(&unnamed),
            None,
            "its first column does not rise"
        );
        unnamed.columns.swap(0, 1);
        assert_eq!(TimeBase::find(&unnamed), Some(0));
    }

    #[test]
    fn the_unit_of_time_is_given_by_the_file_the_name_or_the_steps() {
        for (name, unit, step, expected) in [
            ("t", Some("ms"), 20.0, 1e-3),
            ("time_ms", None, 20.0, 1e-3),
            // The unit in the name applies although the steps are implausible; later checks reject
            // them.
            ("time_s", None, 20.0, 1.0),
            ("t", None, 0.02, 1.0),
            ("t", None, 20.0, 1e-3),
            ("t", None, 20_000.0, 1e-6),
            // Days, as in Excel and MATLAB.
            ("t", None, 0.02 / 86_400.0, 86_400.0),
        ] {
            let base = TimeBase::from_column(&table_with(name, unit, stamps(step)), 1);
            let expected = TimeBase::Column {
                column: 1,
                seconds: expected,
            };
            assert_eq!(base, expected, "{name} {unit:?} {step}");
        }
    }

    #[test]
    fn the_note_has_the_unit_and_its_reason() {
        for (stated, step, unit, reason) in [
            (Some("ms"), 20.0, "ms", TimeUnitReason::Given),
            (None, 0.02, "s", TimeUnitReason::NotStated),
            (None, 20.0, "ms", TimeUnitReason::Steps { step: 20.0 }),
        ] {
            let table = table_with("t", stated, stamps(step));
            let expected = LayoutNote::TimeColumn {
                column: "\"t\"".to_owned(),
                unit,
                reason,
            };
            assert_eq!(TimeBase::column_note(&table, 1), expected);
        }
    }

    #[test]
    fn a_missing_stamp_is_no_number_and_does_not_move_the_median() {
        let mut gaps = stamps(20.0);
        gaps[7] = f64::INFINITY;
        let table = table_with("t", Some("ms"), gaps);
        let base = TimeBase::from_column(&table, 1);
        assert!(base.times_s(&table)[7].is_nan());
        assert!(
            (base.step_s(&table).unwrap() - 0.02).abs() < 1e-15,
            "one rounding of the factor"
        );
        assert_eq!(TimeBase::SampleTime(0.5).times_s(&table)[3], 1.5);
    }
}
