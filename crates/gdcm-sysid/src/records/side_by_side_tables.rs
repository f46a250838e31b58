//! Recognises tables side by side in one table, each preceded by its own stamp column.
//!
//! Each becomes a *topic*: a group of columns that share stamps of their own.

use std::sync::Arc;

use gdcm_model::names::time_name::time_name_rank;

use super::record_table::{RecordColumn, RecordTable, TopicClock, same_samples};
use super::separation::Separation;
use super::time_base::TimeBase;

/// Minimum overlap between two topics, as a fraction of the shorter duration.
const LEAST_OVERLAP: f64 = 0.5;

impl RecordTable {
    /// Splits a table with several stamp columns, each followed by its samples, into topics;
    /// returns any other table unchanged.
    ///
    /// ```text
    /// 1  stamp columns: named like a time, with at least 20 increasing stamps, missing only at the
    ///    end
    /// 2  side by side: several, the first column among them, a sample column after each; clocks
    ///    that differ, and overlap with the first by over half the shorter one. A second clock with
    ///    another origin is an ordinary column
    /// 3  the columns after each stamp column become a topic, with stamps in the first stamp
    ///    column's unit; the stamp columns are removed
    /// ```
    #[must_use]
    pub fn side_by_side(mut self) -> RecordTable {
        // Step 1.
        let stamp_columns = self.stamp_columns();
        // Step 2.
        if !self.named || self.has_topics() || !self.has_samples_behind(&stamp_columns) {
            return self;
        }
        let TimeBase::Column { seconds, .. } = TimeBase::from_column(&self, 0) else {
            return self;
        };
        let clocks: Vec<Vec<f64>> = stamp_columns
            .iter()
            .map(|&column| TimeBase::Column { column, seconds }.times_s(&self))
            .collect();
        if !are_clocks_of_topics(&clocks) {
            return self;
        }
        // Step 3.
        for (index, clock) in clocks.iter().enumerate() {
            let first = stamp_columns[index] + 1;
            let end = match stamp_columns.get(index + 1) {
                Some(next) => *next,
                None => self.columns.len(),
            };
            join_to_topic(&mut self.columns[first..end], clock);
        }
        for column in stamp_columns.iter().rev() {
            self.columns.remove(*column);
        }
        self.notes.push(format!(
            "{} tables side by side, each beginning with its own time column",
            stamp_columns.len()
        ));
        self
    }

    /// Returns the columns that are named like a time (`time`, `time.1`) and have increasing
    /// values.
    fn stamp_columns(&self) -> Vec<usize> {
        let mut found = Vec::new();
        for (index, column) in self.columns.iter().enumerate() {
            let name = column
                .name
                .trim_end_matches(|letter: char| letter.is_ascii_digit() || letter == '.');
            if time_name_rank(name).is_some() && rises(&column.values) {
                found.push(index);
            }
        }
        found
    }

    /// Returns whether there are several stamp columns, the first column among them, each followed
    /// by a sample column.
    fn has_samples_behind(&self, stamp_columns: &[usize]) -> bool {
        let [0, .., last] = stamp_columns else {
            return false;
        };
        stamp_columns.windows(2).all(|pair| pair[1] > pair[0] + 1) && last + 1 < self.columns.len()
    }
}

/// Returns whether the clocks differ and all overlap with the first.
fn are_clocks_of_topics(clocks: &[Vec<f64>]) -> bool {
    let Some(first) = clocks.first().and_then(|clock| TimeSpan::new(clock)) else {
        return false;
    };
    for clock in clocks {
        match TimeSpan::new(clock) {
            Some(span) if span.overlaps(&first) => {}
            _ => return false,
        }
    }
    !clocks.iter().all(|clock| same_samples(clock, &clocks[0]))
}

/// A clock's first and last time \[s\].
struct TimeSpan {
    start_s: f64,
    end_s: f64,
}

impl TimeSpan {
    fn new(clock: &[f64]) -> Option<Self> {
        let mut known = clock.iter().copied().filter(|time| time.is_finite());
        let start_s = known.next()?;
        Some(Self {
            start_s,
            end_s: known.next_back().unwrap_or(start_s),
        })
    }

    fn overlaps(&self, other: &Self) -> bool {
        let common = self.end_s.min(other.end_s) - self.start_s.max(other.start_s);
        let shorter = (self.end_s - self.start_s).min(other.end_s - other.start_s);
        common > LEAST_OVERLAP * shorter
    }
}

/// Assigns the columns to one topic with this clock, and drops the rows that have no stamp.
fn join_to_topic(columns: &mut [RecordColumn], clock: &[f64]) {
    let rows: Vec<usize> = (0..clock.len())
        .filter(|row| clock[*row].is_finite())
        .collect();
    let topic = Arc::new(TopicClock {
        name: String::new(),
        time_s: rows.iter().map(|row| clock[*row]).collect(),
    });
    for column in columns {
        column.values = rows.iter().map(|row| column.values[*row]).collect();
        column.topic = Some(Arc::clone(&topic));
    }
}

/// Returns whether the stamps increase, are at least [`Separation::FEWEST`], and are all missing
/// after the first missing stamp.
fn rises(stamps: &[f64]) -> bool {
    let count = stamps
        .iter()
        .position(|stamp| !stamp.is_finite())
        .unwrap_or(stamps.len());
    let (known, rest) = stamps.split_at(count);
    known.len() >= Separation::FEWEST
        && known.windows(2).all(|pair| pair[1] > pair[0])
        && rest.iter().all(|stamp| stamp.is_nan())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns 60 stamps from `from` on; those after the first `rows` are missing.
    fn stamps(rows: usize, step: f64, from: f64) -> Vec<f64> {
        let mut stamps = vec![f64::NAN; 60];
        for (k, stamp) in stamps.iter_mut().take(rows).enumerate() {
            *stamp = from + step * k as f64;
        }
        stamps
    }

    /// Returns a table with M at 100 Hz and, beside it, q with the stamps `second`.
    fn table(second: Vec<f64>) -> RecordTable {
        let columns = vec![
            RecordColumn::new("time", stamps(60, 0.01, 0.0)),
            RecordColumn::new("M", stamps(60, 1.0, 0.0)),
            RecordColumn::new("time.1", second.clone()),
            RecordColumn::new("q", second),
        ];
        RecordTable::new("log", columns)
    }

    #[test]
    fn tables_side_by_side_are_topics() {
        let apart = table(stamps(30, 0.02, 0.0)).side_by_side();
        assert_eq!(apart.columns.len(), 2);
        assert_eq!(apart.columns[0].name, "M");
        assert_eq!(apart.columns[1].name, "q");
        assert_eq!(apart.columns[1].values.len(), 30);
        assert_eq!(apart.columns[1].topic.as_ref().unwrap().time_s[1], 0.02);
    }

    #[test]
    fn a_clock_with_another_origin_is_a_column() {
        let together = table(stamps(60, 0.01, 5e5)).side_by_side();
        assert_eq!(together.columns.len(), 4);
    }
}
