//! Table, as printed, of the records from which models are identified.

use gdcm_model::message_text::sanitized;
use gdcm_model::units::telling;
use gdcm_sysid::records::LaidOutRecord;
use gdcm_sysid::records::sample_step::median_step;
use gdcm_words::Table;

use super::printed_lines::indented;

/// Returns a table with a line for each record, indented by `indent` spaces.
pub(super) fn record_table(records: &[LaidOutRecord], indent: usize) -> String {
    let mut table = Table::new("", ["record", "kind", "samples", "step", "length", ""]);
    for record in records {
        let clock = RecordClock::new(record);
        let held_out = if record.guess.held_out {
            "held out"
        } else {
            ""
        };
        table.row([
            sanitized(&record.table.name),
            record.guess.kind.word().to_owned(),
            clock.samples.to_string(),
            format!("{} s", telling(clock.step_s, 3)),
            format!("{:.1} s", clock.step_s * clock.samples as f64),
            held_out.to_owned(),
        ]);
    }
    indented(&table, indent)
}

/// A record's time axis as used, after resampling topics and cutting parts.
struct RecordClock {
    samples: usize,
    /// Median step \[s\]; NaN if unknown.
    step_s: f64,
}

impl RecordClock {
    fn new(record: &LaidOutRecord) -> Self {
        let (samples, step_s) = match &record.flight {
            Some(flight) => (flight.time_s.len(), median_step(&flight.time_s)),
            None => {
                let table = &record.table;
                let time = record.layout.time;
                (table.rows(), time.and_then(|time| time.step_s(table)))
            }
        };
        Self {
            samples,
            step_s: step_s.unwrap_or(f64::NAN),
        }
    }
}
