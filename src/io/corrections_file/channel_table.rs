//! `corrections.csv`: one row for each condition and channel.

use std::collections::BTreeSet;
use std::path::Path;

use crate::correction::ChannelCorrection;
use crate::dataset::{Channel, Condition, ConditionId};
use crate::io::csv_file::{cell, write_csv};
use crate::io::file_error::FileError;
use crate::study::Analysis;

const HEADER: [&str; 8] =
    ["condition", "airspeed_kt", "kind", "channel", "gain", "delay_s", "scheduled_gain", "scheduled_delay_s"];

/// Writes the channel gains (ratios) and delays \[s\] of the chosen conditions, and the scheduled ones at the same
/// airspeed. A figure that does not exist is an empty cell.
pub fn write_corrections_csv(
    analysis: &Analysis,
    chosen: &BTreeSet<ConditionId>,
    path: &Path,
) -> Result<(), FileError> {
    let conditions = analysis.study.dataset.conditions().iter();
    let chosen = conditions.filter(|condition| chosen.contains(&condition.id()));
    let rows = chosen.flat_map(|condition| condition_rows(analysis, condition));
    write_csv(path, &HEADER, rows)
}

fn condition_rows(analysis: &Analysis, condition: &Condition) -> Vec<[String; 8]> {
    let airspeed_kt = condition.flight_state().airspeed_kt;
    let own = analysis.condition(condition.id()).map(|result| &result.correction);
    let scheduled = analysis.schedule.as_ref().ok().map(|schedule| schedule.at(airspeed_kt));
    let scheduled = scheduled.as_ref();
    let row = |kind: &str, channel: &Channel, figures: [Option<f64>; 4]| {
        let [gain, delay_s, scheduled_gain, scheduled_delay_s] = figures.map(cell);
        [
            condition.id().to_string(),
            airspeed_kt.to_string(),
            kind.to_owned(),
            channel.name.clone(),
            gain,
            delay_s,
            scheduled_gain,
            scheduled_delay_s,
        ]
    };
    let inputs = analysis.study.dataset.inputs().iter().enumerate().map(|(at, channel)| {
        let figures = |of: &ChannelCorrection| (of.input_gains[at], of.input_delays_s[at]);
        let ((gain, delay), (scheduled_gain, scheduled_delay)) =
            (own.map(figures).unzip(), scheduled.map(figures).unzip());
        row("input", channel, [gain, delay, scheduled_gain, scheduled_delay])
    });
    let outputs = analysis.study.dataset.outputs().iter().enumerate().map(|(at, channel)| {
        let figures = |of: &ChannelCorrection| (of.output_gains[at], of.output_delays_s[at]);
        let ((gain, delay), (scheduled_gain, scheduled_delay)) =
            (own.map(figures).unzip(), scheduled.map(figures).unzip());
        row("output", channel, [gain, delay, scheduled_gain, scheduled_delay])
    });
    inputs.chain(outputs).collect()
}
