//! The results as comma-separated values (RFC 4180), one row for each condition and channel, or condition and response.

use std::collections::BTreeSet;
use std::io::{self, Write};

use gdcm_core::correction::{self, ChannelCorrection};
use gdcm_core::dataset::{Channel, Condition, ConditionId, Pair};
use gdcm_core::response::LeadFilter;
use gdcm_core::study::{Analysis, Assessed};
use gdcm_core::uncertainty::{Bar, Part, Scalar};

use super::super::csv_table::write_records;

const CHANNEL_HEADER: [&str; 20] = [
    "condition",
    "airspeed_kt",
    "kind",
    "channel",
    "gain",
    "delay_s",
    "scheduled_gain",
    "scheduled_delay_s",
    "tau_s",
    "lead_s",
    "zero_rad_s",
    "lag_rad_s",
    "gain_at_infinity_db",
    "scheduled_tau_s",
    "gain_low",
    "gain_high",
    "delay_low_s",
    "delay_high_s",
    "u_gain_physics",
    "u_gain_identification",
];

/// `corrections.csv`: the channel gains (ratios) and delays \[s\] of the chosen conditions, and the scheduled ones at the same
/// airspeed; where leads were asked for, the signed delays and the filters of the negative ones. A figure that does not exist is an
/// empty cell.
pub(crate) fn channel_table(
    analysis: &Analysis,
    chosen: &BTreeSet<ConditionId>,
    file: &mut dyn Write,
) -> io::Result<()> {
    let conditions = analysis.study.dataset.conditions();
    let chosen = conditions.iter().filter(|condition| chosen.contains(&condition.id()));
    let rows = chosen.flat_map(|condition| channel_rows(analysis, condition));
    write_records(file, std::iter::once(CHANNEL_HEADER.map(str::to_owned)).chain(rows))
}

fn channel_rows(analysis: &Analysis, condition: &Condition) -> Vec<[String; 20]> {
    let airspeed_kt = condition.flight_state().airspeed_kt;
    let own = analysis.condition(condition.id()).map(|result| &result.correction);
    let scheduled = analysis.schedule.as_ref().ok().map(|schedule| schedule.at_state(condition.flight_state()));
    let scheduled = scheduled.as_ref();
    let row = |kind: &str, name: &Channel, channel: correction::Channel| {
        let figures = |of: &ChannelCorrection| match channel {
            correction::Channel::Input(at) => [of.input_gains[at], of.input_delays_s[at]],
            correction::Channel::Output(at) => [of.output_gains[at], of.output_delays_s[at]],
        };
        let tau_s = |of: Option<&ChannelCorrection>| of?.leads.as_ref().map(|leads| leads.tau_s(channel));
        let filter = own.and_then(|own| own.lead(channel));
        let [of_own, of_schedule] = [own, scheduled].map(|of| of.map(figures));
        let figure = |of: Option<[f64; 2]>, at: usize| cell(of.map(|of| of[at]));
        let bars = Bars { analysis, condition: condition.id() };
        let [gain_low, gain_high] = bars.ends(Scalar::ChannelGain(channel));
        let [delay_low_s, delay_high_s] = bars.ends(Scalar::ChannelDelay(channel));
        let [u_physics, u_identification, _] = bars.parts(Scalar::ChannelGain(channel));
        [
            condition.id().to_string(),
            airspeed_kt.to_string(),
            kind.to_owned(),
            name.name.clone(),
            figure(of_own, 0),
            figure(of_own, 1),
            figure(of_schedule, 0),
            figure(of_schedule, 1),
            cell(tau_s(own)),
            cell(filter.map(LeadFilter::lead_s)),
            cell(filter.map(LeadFilter::zero_rad_s)),
            cell(filter.map(LeadFilter::lag_rad_s)),
            cell(filter.map(LeadFilter::gain_at_infinity_db)),
            cell(tau_s(scheduled)),
            gain_low,
            gain_high,
            delay_low_s,
            delay_high_s,
            u_physics,
            u_identification,
        ]
    };
    let dataset = &analysis.study.dataset;
    let inputs =
        dataset.inputs().iter().enumerate().map(|(at, name)| row("input", name, correction::Channel::Input(at)));
    let outputs =
        dataset.outputs().iter().enumerate().map(|(at, name)| row("output", name, correction::Channel::Output(at)));
    inputs.chain(outputs).collect()
}

const RESPONSE_HEADER: [&str; 34] = [
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
    "D_band_s",
    "held_out",
    "G_low",
    "G_high",
    "D_low_s",
    "D_high_s",
    "net_gain_low",
    "net_gain_high",
    "u_net_gain_physics",
    "u_net_gain_identification",
    "degrees_of_freedom",
    "left_in_band",
    "D_band_low_s",
    "D_band_high_s",
];

/// `assessment.csv`: G, D \[s\], net gains and J of the nominal model before and under the scheduled correction, of every response of the
/// chosen conditions. A figure that does not exist is an empty cell; `left_out` says why a condition is not
/// assessed, `D_band_s` is the band delay (M15.2).
pub(super) fn response_table(
    analysis: &Analysis,
    chosen: &BTreeSet<ConditionId>,
    file: &mut dyn Write,
) -> io::Result<()> {
    let conditions = analysis.study.dataset.conditions();
    let chosen = conditions.iter().filter(|condition| chosen.contains(&condition.id()));
    let rows = chosen.flat_map(|condition| {
        let scheduled = analysis.schedule.as_ref().ok().map(|schedule| schedule.at_state(condition.flight_state()));
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
) -> [String; 34] {
    let dataset = &analysis.study.dataset;
    let result = analysis.condition(condition.id());
    let delta = result.map(|result| &result.comparison.delta);
    let own = result.map(|result| &result.correction);
    let (change, left_out) = match analysis.assessment.get(&condition.id()) {
        Some(Assessed::Nominal(changes)) => (changes[pair], ""),
        Some(Assessed::LeftOut { why }) => (None, why.as_str()),
        None => (None, ""),
    };
    let bars = Bars { analysis, condition: condition.id() };
    let [gain_low, gain_high] = bars.ends(Scalar::Gain(pair));
    let [delay_low_s, delay_high_s] = bars.ends(Scalar::Delay(pair));
    let [band_low_s, band_high_s] = bars.ends(Scalar::BandDelay(pair));
    let [net_low, net_high] = bars.ends(Scalar::NetGain(pair));
    let [u_physics, u_identification, degrees] = bars.parts(Scalar::NetGain(pair));
    [
        condition.id().to_string(),
        condition.flight_state().airspeed_kt.to_string(),
        dataset.outputs()[pair.output].name.clone(),
        dataset.inputs()[pair.input].name.clone(),
        dataset.on_axis()[pair].to_string(),
        result.is_some_and(|result| result.held()[pair]).to_string(),
        cell(result.and_then(|result| result.wanted_gain(pair))),
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
        cell(delta.and_then(|delta| delta.band_delay_s[pair])),
        analysis.study.choice(condition.id()).held_out.to_string(),
        gain_low,
        gain_high,
        delay_low_s,
        delay_high_s,
        net_low,
        net_high,
        u_physics,
        u_identification,
        degrees,
        cell(bars.left_in_band(pair)),
        band_low_s,
        band_high_s,
    ]
}

/// The bars of one condition as cells.
struct Bars<'a> {
    analysis: &'a Analysis,
    condition: ConditionId,
}

impl Bars<'_> {
    fn bar(&self, scalar: Scalar) -> Option<&Bar> {
        self.analysis.uncertainty.as_ref()?.bar(self.condition, scalar)
    }

    /// Both ends of the whole bar, of a gain as ratios.
    fn ends(&self, scalar: Scalar) -> [String; 2] {
        let level = self.analysis.study.settings.uncertainty.level;
        let ends = self.bar(scalar).and_then(|bar| bar.interval(level));
        let told = |end: f64| if scalar.is_delay() { end } else { end.exp() };
        [0, 1].map(|end| cell(ends.map(|ends| told(ends[end]))))
    }

    /// Deviations of trim and identification, and degrees of freedom.
    fn parts(&self, scalar: Scalar) -> [String; 3] {
        let bar = self.bar(scalar);
        let deviation = |part: Option<Part>| part.map(|part| part.variance.sqrt());
        [
            cell(bar.and_then(|bar| deviation(bar.trim))),
            cell(bar.and_then(|bar| deviation(bar.identification))),
            cell(bar.and_then(Bar::degrees)),
        ]
    }

    fn left_in_band(&self, pair: Pair) -> Option<f64> {
        self.analysis.uncertainty.as_ref()?.conditions.get(&self.condition)?.left_in_band[pair]
    }
}

/// A figure to the last digit; an empty cell where there is none, or none that is finite.
fn cell(figure: Option<f64>) -> String {
    // Debug writes an exponent where Display would write hundreds of zeros.
    figure.filter(|figure| figure.is_finite()).map(|figure| format!("{figure:?}")).unwrap_or_default()
}
