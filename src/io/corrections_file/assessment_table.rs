//! `assessment.csv`: one row for each condition and response.

use std::path::Path;

use crate::correction::ChannelCorrection;
use crate::dataset::{Condition, Pair};
use crate::io::csv_file::{cell, write_csv};
use crate::io::file_error::FileError;
use crate::study::{Analysis, Assessed};

const HEADER: [&str; 20] = [
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

/// Writes G, D \[s\], net gains and J of the nominal model before and under the scheduled correction, of every response of the
/// chosen conditions (by index). A figure that does not exist is an empty cell; `left_out` says why a condition is not assessed.
pub fn write_assessment_csv(analysis: &Analysis, chosen: &[usize], path: &Path) -> Result<(), FileError> {
    let conditions = analysis.study.dataset.conditions();
    let known = chosen.iter().filter_map(|&index| Some((index, conditions.get(index)?)));
    let rows = known.flat_map(|(index, condition)| {
        let scheduled =
            analysis.schedule.as_ref().ok().map(|schedule| schedule.at(condition.flight_state().airspeed_kt));
        let pairs = analysis.study.dataset.on_axis().pairs();
        pairs.map(move |pair| row(analysis, index, condition, scheduled.as_ref(), pair))
    });
    write_csv(path, &HEADER, rows)
}

fn row(
    analysis: &Analysis,
    index: usize,
    condition: &Condition,
    scheduled: Option<&ChannelCorrection>,
    pair: Pair,
) -> [String; 20] {
    let dataset = &analysis.study.dataset;
    let result = analysis.condition(index);
    let delta = result.map(|result| &result.comparison.delta);
    let own = result.map(|result| &result.correction);
    let (change, left_out) = match &analysis.assessment[index] {
        Assessed::Nominal(changes) => (changes[pair], ""),
        Assessed::LeftOut { why } => (None, why.as_str()),
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
