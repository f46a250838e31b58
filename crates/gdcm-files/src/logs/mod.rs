//! Logs as they come off aircraft: topics with clocks of their own.
//!
//! ```text
//! bytes -> messages -> topics: stamps, and a column for each field      (ulog, dataflash, blackbox)
//!       -> units and channels by the documentation of the system        (channel_meanings)
//! ```

mod blackbox;
mod blackbox_frame;
mod channel_meanings;
mod dataflash;
mod dataflash_text;
mod little_endian;
mod ulog;
mod ulog_format;

use std::sync::Arc;

use gdcm_core::records::{ModeSpan, RecordColumn, TopicClock};

pub(crate) use self::blackbox::Blackbox;
pub(crate) use self::dataflash::DataFlash;
pub(crate) use self::dataflash_text::DataFlashText;
pub(crate) use self::ulog::ULog;
use crate::variables::{ReadingBudget, VariableFault};

/// Fewer samples than these are no signal.
const FEWEST: usize = 3;
/// Most spans of modes that are kept of one log.
const MOST_MODES: usize = 1000;

/// A topic while it is read.
struct TopicSamples {
    name: String,
    fields: Vec<TopicField>,
    time_s: Vec<f64>,
}

/// A field of a topic, with its samples.
struct TopicField {
    name: String,
    unit: Option<String>,
    values: Vec<f64>,
}

impl TopicSamples {
    /// A topic of these fields, none of which has a sample yet.
    fn new(name: String, fields: impl IntoIterator<Item = (String, Option<String>)>) -> Self {
        let fields = fields.into_iter().map(|(name, unit)| TopicField { name, unit, values: Vec::new() });
        Self { name, fields: fields.collect(), time_s: Vec::new() }
    }

    /// Takes a sample: a value for each field, in order.
    fn push(
        &mut self,
        time_s: f64,
        values: impl IntoIterator<Item = f64>,
        budget: &ReadingBudget<'_>,
    ) -> Result<(), VariableFault> {
        budget.take(self.fields.len() as u64 + 1, 8, &self.name)?;
        self.time_s.push(time_s);
        self.fields.iter_mut().zip(values).for_each(|(field, value)| field.values.push(value));
        Ok(())
    }

    /// Its columns; none where it has hardly any samples.
    fn columns(self) -> Vec<RecordColumn> {
        if self.time_s.len() < FEWEST {
            return Vec::new();
        }
        let clock = Arc::new(TopicClock { name: self.name, time_s: self.time_s });
        let column = |field: TopicField| RecordColumn {
            unit: field.unit,
            topic: Some(Arc::clone(&clock)),
            ..RecordColumn::new(format!("{}.{}", clock.name, field.name), field.values)
        };
        self.fields.into_iter().map(column).collect()
    }
}

/// From when to when a state was which: one span for each run of equal values that has a name.
fn mode_spans(
    time_s: &[f64],
    values: impl IntoIterator<Item = f64>,
    name: impl Fn(f64) -> Option<String>,
) -> Vec<ModeSpan> {
    let mut spans: Vec<ModeSpan> = Vec::new();
    let mut last: Option<f64> = None;
    for (&time, value) in time_s.iter().zip(values) {
        let goes_on = last == Some(value);
        let begins = last.is_none() || !goes_on;
        if begins {
            // A state lasts until the next one is told.
            if let Some(open) = spans.last_mut().filter(|_| last.and_then(&name).is_some()) {
                open.ends_s[1] = time;
            }
            if let Some(name) = name(value).filter(|_| spans.len() < MOST_MODES) {
                spans.push(ModeSpan { name, ends_s: [time, time] });
            }
        } else if let Some(open) = spans.last_mut().filter(|_| name(value).is_some()) {
            open.ends_s[1] = time;
        }
        last = Some(value);
    }
    spans
}

/// Spans in words: "armed 3.2 to 88.1 s".
fn modes_note(spans: &[ModeSpan]) -> Option<String> {
    const SHOWN: usize = 8;
    let words = |span: &ModeSpan| format!("{} {:.1} to {:.1} s", span.name, span.ends_s[0], span.ends_s[1]);
    let shown: Vec<String> = spans.iter().take(SHOWN).map(words).collect();
    let more = spans.len().saturating_sub(SHOWN);
    let more = if more == 0 { String::new() } else { format!(" and {more} more") };
    (!shown.is_empty()).then(|| format!("{}{more}", shown.join(", ")))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_state_lasts_until_the_next_one_is_told() {
        let name = |value: f64| (value == 2.0).then(|| "armed".to_owned());
        let spans = mode_spans(&[0.0, 1.0, 2.0, 5.0, 6.0], [1.0, 2.0, 2.0, 1.0, 2.0], name);
        let ends: Vec<[f64; 2]> = spans.iter().map(|span| span.ends_s).collect();
        assert_eq!(ends, [[1.0, 5.0], [6.0, 6.0]]);
        assert_eq!(modes_note(&spans[..1]).unwrap(), "armed 1.0 to 5.0 s");
    }
}
