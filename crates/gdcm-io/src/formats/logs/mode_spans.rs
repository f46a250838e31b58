//! Time spans of the flight modes in a log.

use crate::formats::reading_note::ReadingNote;
use gdcm_sysid::records::ModeSpan;

/// Maximum number of spans for one logged state; later spans are ignored.
const MOST_SPANS: usize = 1000;

/// Returns the time spans during which `values` is constant, at most `MOST_SPANS`. Each lasts until
/// the sample with the next value, or to the last sample. `name` returns a value's name, or `None`
/// if it needs no span.
///
/// Beyond `MOST_SPANS`, another value ends the last span and begins none.
pub(super) fn mode_spans(
    time_s: &[f64],
    values: impl IntoIterator<Item = f64>,
    name: impl Fn(f64) -> Option<String>,
) -> Vec<ModeSpan> {
    let mut spans: Vec<ModeSpan> = Vec::new();
    // Value in the preceding sample, and whether the last span is this value's.
    let mut last: Option<f64> = None;
    let mut is_open = false;
    for (&time, value) in time_s.iter().zip(values) {
        // The preceding value lasts until this sample, even if the value changes here.
        if let Some(open) = spans.last_mut()
            && is_open
        {
            open.ends_s[1] = time;
        }
        if last != Some(value) {
            is_open = false;
            if spans.len() < MOST_SPANS
                && let Some(name) = name(value)
            {
                is_open = true;
                spans.push(ModeSpan {
                    name,
                    ends_s: [time, time],
                });
            }
        }
        last = Some(value);
    }
    spans
}

/// Returns the note that lists the flight modes; `None` if there are none.
pub(super) fn modes_note(spans: &[ModeSpan]) -> Option<ReadingNote> {
    if spans.is_empty() {
        return None;
    }
    Some(ReadingNote::FlightModes(spans.to_vec()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_state_lasts_until_the_next_state_is_logged() {
        let name = |value: f64| (value == 2.0).then(|| "armed".to_owned());
        let spans = mode_spans(&[0.0, 1.0, 2.0, 5.0, 6.0], [1.0, 2.0, 2.0, 1.0, 2.0], name);
        let ends: Vec<[f64; 2]> = spans.iter().map(|span| span.ends_s).collect();
        assert_eq!(ends, [[1.0, 5.0], [6.0, 6.0]]);
        assert_eq!(
            modes_note(&spans),
            Some(ReadingNote::FlightModes(spans.clone()))
        );
        assert_eq!(modes_note(&[]), None);
    }

    #[test]
    fn a_state_beyond_the_most_spans_does_not_extend_the_last_span() {
        let times: Vec<f64> = (0..MOST_SPANS + 500).map(|k| k as f64).collect();
        let values = times.iter().map(|time| time % 2.0);
        let spans = mode_spans(&times, values, |value| Some(format!("mode {value}")));
        assert_eq!(spans.len(), MOST_SPANS);
        let end = MOST_SPANS as f64;
        assert_eq!(spans[MOST_SPANS - 1].ends_s, [end - 1.0, end]);
    }
}
