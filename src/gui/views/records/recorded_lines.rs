//! A channel's samples as lines, within the time spans drawn at full opacity and outside them.
//! These *bright* spans are the displayed part, the parts in use or the whole record
//! ([`RecordSpan::bright_s`]).

use std::sync::Arc;

use egui::Ui;

use gdcm_model::simulation::FlightRecord;

use super::frame_cache::cached;
use super::record_span::RecordSpan;

/// A channel's samples as lines, interrupted where samples are missing.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct RecordedLines {
    /// Within the time spans drawn at full opacity.
    pub(super) inside: Vec<Arc<[[f64; 2]]>>,
    pub(super) outside: Vec<Arc<[[f64; 2]]>>,
}

impl RecordedLines {
    /// Returns time \[s\] and value of every finite sample, inside and outside. A sample at which
    /// two lines join occurs twice.
    pub(super) fn points(&self) -> impl Iterator<Item = [f64; 2]> {
        let lines = self.inside.iter().chain(&self.outside);
        lines.flat_map(|line| line.iter().copied())
    }
}

/// Returns a channel's samples; `index` counts inputs, then outputs.
pub(super) fn recorded_lines(ui: &Ui, record: &RecordSpan, index: usize) -> Arc<RecordedLines> {
    let bright_s = record.bright_s();
    let key: Vec<[u64; 2]> = bright_s.iter().map(|ends| ends.map(f64::to_bits)).collect();
    let source = Arc::clone(&record.flight) as _;
    cached(ui, &format!("channel {index}"), &[source], key, || {
        split_lines(&samples(&record.flight, index), &bright_s)
    })
}

/// Returns time \[s\] and value of each sample.
fn samples(flight: &FlightRecord, index: usize) -> Vec<[f64; 2]> {
    let inputs = flight.inputs.ncols();
    let mut points = Vec::with_capacity(flight.time_s.len());
    for (sample, &time_s) in flight.time_s.iter().enumerate() {
        let value = if index < inputs {
            flight.inputs[(sample, index)]
        } else {
            flight.outputs[(sample, index - inputs)]
        };
        points.push([time_s, value]);
    }
    points
}

/// Splits samples into lines at missing samples and at the ends of `parts_s`. A line outside these
/// parts begins and ends with a neighbouring part's sample, so that it joins the line inside.
fn split_lines(points: &[[f64; 2]], parts_s: &[[f64; 2]]) -> RecordedLines {
    let is_inside = |time_s: f64| {
        parts_s
            .iter()
            .any(|[from, to]| (*from..=*to).contains(&time_s))
    };
    let mut lines = RecordedLines::default();
    let finite = |point: &[f64; 2]| point[0].is_finite() && point[1].is_finite();
    for run in points.split(|point| !finite(point)) {
        let mut from = 0;
        while from < run.len() {
            let inside = is_inside(run[from][0]);
            let mut to = from + 1;
            while to < run.len() && is_inside(run[to][0]) == inside {
                to += 1;
            }
            if inside {
                lines.inside.push(Arc::from(&run[from..to]));
            } else {
                let before = from.saturating_sub(1);
                let after = (to + 1).min(run.len());
                lines.outside.push(Arc::from(&run[before..after]));
            }
            from = to;
        }
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn samples_outside_the_part_are_lines_of_their_own_that_join_it() {
        let points: Vec<[f64; 2]> = (0..8).map(|k| [f64::from(k), 1.0]).collect();
        let lines = split_lines(&points, &[[2.0, 4.0]]);
        let times = |lines: &[Arc<[[f64; 2]]>]| -> Vec<[f64; 2]> {
            lines
                .iter()
                .map(|line| [line[0][0], line[line.len() - 1][0]])
                .collect()
        };
        assert_eq!(times(&lines.inside), [[2.0, 4.0]]);
        assert_eq!(times(&lines.outside), [[0.0, 2.0], [4.0, 7.0]]);
    }

    #[test]
    fn a_missing_sample_interrupts_the_line() {
        let points = [[0.0, 1.0], [1.0, f64::NAN], [2.0, 1.0], [3.0, 1.0]];
        let lines = split_lines(&points, &[[0.0, 3.0]]);
        let lengths: Vec<usize> = lines.inside.iter().map(|line| line.len()).collect();
        assert_eq!(lengths, [1, 2]);
        assert!(lines.outside.is_empty());
    }
}
