//! The results as comma-separated values (RFC 4180), one row for each condition and channel, or condition and response.

use std::collections::BTreeSet;
use std::io::{self, Write};

use crate::correction::ChannelCorrection;
use crate::dataset::{Channel, Condition, ConditionId, Pair};
use crate::study::{Analysis, Assessed};

use super::super::csv_table::write_records;

const CHANNEL_HEADER: [&str; 8] =
    ["condition", "airspeed_kt", "kind", "channel", "gain", "delay_s", "scheduled_gain", "scheduled_delay_s"];

/// `corrections.csv`: the channel gains (ratios) and delays \[s\] of the chosen conditions, and the scheduled ones at the same
/// airspeed. A figure that does not exist is an empty cell.
pub(in crate::io) fn channel_table(
    analysis: &Analysis,
    chosen: &BTreeSet<ConditionId>,
    file: &mut dyn Write,
) -> io::Result<()> {
    let conditions = analysis.study.dataset.conditions();
    let chosen = conditions.iter().filter(|condition| chosen.contains(&condition.id()));
    let rows = chosen.flat_map(|condition| channel_rows(analysis, condition));
    write_records(file, std::iter::once(CHANNEL_HEADER.map(str::to_owned)).chain(rows))
}

fn channel_rows(analysis: &Analysis, condition: &Condition) -> Vec<[String; 8]> {
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

const RESPONSE_HEADER: [&str; 20] = [
    "condition",
    "airspeed_kt",
    "output",
    "input",
    "on_axis",
    "held",
    "G",
    "D_s",
    "net_gain",
    "net_delay_s",
    "scheduled_net_gain",
    "scheduled_net_delay_s",
    "J_mag_uncorrected",
    "J_phase_uncorrected",
    "J_mag_scheduled",
    "J_phase_scheduled",
    "dJ_mag",
    "dJ_phase",
    "dJ",
    "left_out",
];

/// `assessment.csv`: G, D \[s\], net gains and J of the nominal model before and under the scheduled correction, of every response of the
/// chosen conditions. A figure that does not exist is an empty cell; `left_out` says why a condition is not assessed.
pub(super) fn response_table(
    analysis: &Analysis,
    chosen: &BTreeSet<ConditionId>,
    file: &mut dyn Write,
) -> io::Result<()> {
    let conditions = analysis.study.dataset.conditions();
    let chosen = conditions.iter().filter(|condition| chosen.contains(&condition.id()));
    let rows = chosen.flat_map(|condition| {
        let scheduled =
            analysis.schedule.as_ref().ok().map(|schedule| schedule.at(condition.flight_state().airspeed_kt));
        let pairs = analysis.study.dataset.on_axis().pairs();
        pairs.map(move |pair| response_row(analysis, condition, scheduled.as_ref(), pair))
    });
    write_records(file, std::iter::once(RESPONSE_HEADER.map(str::to_owned)).chain(rows))
}

fn response_row(
    analysis: &Analysis,
    condition: &Condition,
    scheduled: Option<&ChannelCorrection>,
    pair: Pair,
) -> [String; 20] {
    let dataset = &analysis.study.dataset;
    let result = analysis.condition(condition.id());
    let delta = result.map(|result| &result.comparison.delta);
    let own = result.map(|result| &result.correction);
    let (change, left_out) = match analysis.assessment.get(&condition.id()) {
        Some(Assessed::Nominal(changes)) => (changes[pair], ""),
        Some(Assessed::LeftOut { why }) => (None, why.as_str()),
        None => (None, ""),
    };
    [
        condition.id().to_string(),
        condition.flight_state().airspeed_kt.to_string(),
        dataset.outputs()[pair.output].name.clone(),
        dataset.inputs()[pair.input].name.clone(),
        dataset.on_axis()[pair].to_string(),
        result.is_some_and(|result| result.held()[pair]).to_string(),
        cell(delta.and_then(|delta| delta.gain[pair])),
        cell(delta.and_then(|delta| delta.delay_s[pair])),
        cell(own.map(|correction| correction.net_gain(pair).value())),
        cell(own.map(|correction| correction.net_delay(pair).value_s())),
        cell(scheduled.map(|correction| correction.net_gain(pair).value())),
        cell(scheduled.map(|correction| correction.net_delay(pair).value_s())),
        cell(change.map(|change| change.uncorrected.magnitude)),
        cell(change.map(|change| change.uncorrected.phase)),
        cell(change.map(|change| change.corrected.magnitude)),
        cell(change.map(|change| change.corrected.phase)),
        cell(change.map(|change| change.magnitude())),
        cell(change.map(|change| change.phase())),
        cell(change.map(|change| change.total())),
        left_out.to_owned(),
    ]
}

/// A figure to the last digit; an empty cell where there is none, or none that is finite.
fn cell(figure: Option<f64>) -> String {
    // Debug writes an exponent where Display would write hundreds of zeros.
    figure.filter(|figure| figure.is_finite()).map(|figure| format!("{figure:?}")).unwrap_or_default()
}
