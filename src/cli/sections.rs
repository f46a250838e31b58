//! The sections of the summary.

use gdcm_core::correction::{ChannelCorrection, Outcome};
use gdcm_core::dataset::{BundleKind, Condition, Pair};
use gdcm_core::message_text::sanitized;
use gdcm_core::schedule::{Schedule, ScheduledQuantity};
use gdcm_core::study::{Analysis, ConditionAnalysis, RemarkKind, Study, lead_words, remarks};
use gdcm_core::uncertainty::Scalar;
use gdcm_core::units::{number, s_to_ms};

use super::summary::LABEL;
use super::text_table::{Side, TextTable, labelled, listed};

/// A line of a section.
fn detail(label: &str, words: &str) -> String {
    labelled(2, label, LABEL - 2, words)
}

/// A list in a section; says so where it is empty.
fn detail_list(label: &str, entries: Vec<String>) -> String {
    let entries = if entries.is_empty() { vec!["none".to_owned()] } else { entries };
    listed(2, label, LABEL - 2, &entries)
}

/// One condition: representatives, rejections, the on-axis and held responses, and what could not be matched.
pub(super) fn condition_section(analysis: &Analysis, condition: &Condition) -> String {
    let state = condition.flight_state();
    let title = format!("{} ({} kt)", sanitized(&state.name), number(state.airspeed_kt));
    let mut text = labelled(0, &format!("Condition {}", state.id), LABEL, &title);
    match analysis.conditions.get(&condition.id()) {
        None => {}
        Some(Ok(result)) => {
            text.push_str(&model_lines(analysis, result));
            text.push_str(&response_table(analysis, result).lines(2));
            text.push_str(&channel_lines(analysis, result));
            text.push_str(&trouble_lines(analysis, result));
        }
        Some(Err(failure)) => text.push_str(&detail("no result", &sanitized(&failure.to_string()))),
    }
    text
}

fn model_lines(analysis: &Analysis, result: &ConditionAnalysis) -> String {
    let id = result.condition.id();
    let rejected: Vec<String> = analysis.study.rejected_names(id).into_iter().map(sanitized).collect();
    let is_rejected = |name: &String| analysis.study.choice(id).physics.rejected.contains(name);
    let suggested = result.suggested().into_iter().filter(|name| !is_rejected(name));
    let suggested: Vec<String> = suggested.map(|name| sanitized(&name)).collect();
    let mut text = detail("physics", &sanitized(result.representative_name(BundleKind::Physics)));
    text.push_str(&detail("identified", &sanitized(result.representative_name(BundleKind::Identified))));
    text.push_str(&detail_list("rejected", rejected));
    if !suggested.is_empty() {
        text.push_str(&detail_list("outliers?", suggested));
    }
    text
}

/// The responses that tables show: those that measure a model (the on-axis ones), and those to be held.
fn shown_pairs(study: &Study) -> impl Iterator<Item = Pair> {
    let measuring = study.dataset.measuring_pairs();
    let shown = measuring.map(|pair, measures| *measures || study.settings.constrained[pair]);
    shown.marked().collect::<Vec<_>>().into_iter()
}

fn response_table(analysis: &Analysis, result: &ConditionAnalysis) -> TextTable<11> {
    use Side::{Left, Right};
    let mut table = TextTable::new([
        ("response", Left),
        ("held", Left),
        ("G", Right),
        ("± %", Right),
        ("net gain", Right),
        ("± %", Right),
        ("D [ms]", Right),
        ("± ms", Right),
        ("net delay [ms]", Right),
        ("J before", Right),
        ("J after", Right),
    ]);
    let dataset = &analysis.study.dataset;
    let half = |scalar: Scalar, factor: f64| {
        let uncertainty = analysis.uncertainty.as_ref()?;
        Some(factor * uncertainty.bar(result.condition.id(), scalar)?.half_width(uncertainty.level)?)
    };
    for pair in shown_pairs(&analysis.study) {
        let cost = result.cost[pair];
        table.row([
            sanitized(&dataset.pair_name(pair)),
            if result.held()[pair] { "yes" } else { "no" }.to_owned(),
            figure(result.wanted_gain(pair), 3),
            figure(half(Scalar::Gain(pair), 100.0), 1),
            figure(Some(result.correction.net_gain(pair).value()), 3),
            figure(half(Scalar::NetGain(pair), 100.0), 1),
            figure(result.wanted_delay_s(pair).map(s_to_ms), 1),
            figure(half(result.wanted_delay(pair), 1e3), 1),
            figure(Some(s_to_ms(result.correction.net_delay(pair).value_s())), 1),
            figure(cost.map(|cost| cost.uncorrected.total()), 1),
            figure(cost.map(|cost| cost.corrected.total()), 1),
        ]);
    }
    table
}

pub(super) fn figure(value: Option<f64>, digits: usize) -> String {
    // Adding zero turns a rounded minus zero into zero.
    let rounded = |value: f64| (value * 10_f64.powi(digits as i32)).round() / 10_f64.powi(digits as i32) + 0.0;
    value.map_or("-".to_owned(), |value| match value.abs() {
        ..1e7 => format!("{:.digits$}", rounded(value)),
        _ => format!("{value:.digits$e}"),
    })
}

fn channel_lines(analysis: &Analysis, result: &ConditionAnalysis) -> String {
    let (dataset, correction) = (&analysis.study.dataset, &result.correction);
    let channels = || dataset.inputs().iter().chain(dataset.outputs()).map(|channel| sanitized(&channel.name));
    let gains = correction.input_gains.iter().chain(&correction.output_gains);
    let gains: Vec<String> =
        channels().zip(gains).map(|(name, gain)| format!("{name} {}", figure(Some(*gain), 3))).collect();
    let [inputs_s, outputs_s] = correction.signed_delays_s();
    let delays = inputs_s.iter().chain(outputs_s);
    let delays = channels().zip(delays).filter_map(|(name, delay)| {
        let words = figure(Some(s_to_ms(*delay)), 1);
        (words != "0.0").then(|| format!("{name} {words} ms"))
    });

    let label = if correction.leads.is_some() { "delay/lead" } else { "delays" };
    let mut text = detail_list("gains", gains) + &detail_list(label, delays.collect());
    for words in lead_words(&analysis.study, result, analysis.uncertainty.as_deref()) {
        text.push_str(&detail("lead", &sanitized(&words)));
    }
    text
}

/// What could not be matched and why, entry by entry, what is not proven, and the other cautions.
fn trouble_lines(analysis: &Analysis, result: &ConditionAnalysis) -> String {
    let line = |label: &str, words: &str| detail(label, &sanitized(words));
    let said = remarks(&analysis.study, result, None);
    let (mut text, mut trouble) = (String::new(), "not matched");
    for remark in &said {
        match remark.kind {
            RemarkKind::Good => {}
            // What is missed comes first, then the reasons and the ways out.
            RemarkKind::Trouble => text.push_str(&line(std::mem::replace(&mut trouble, "why"), &remark.text)),
            RemarkKind::Caution => text.push_str(&line("caution", &remark.text)),
        }
    }
    if matches!(result.gains.proof.outcome, Outcome::NotProven { .. }) {
        text.push_str(&line("not proven", &result.gains.proof.outcome.words()));
    }
    text
}

/// The scheduled net gains of the on-axis and held responses over airspeed.
pub(super) fn schedule_section(analysis: &Analysis) -> String {
    let schedule = match &analysis.schedule {
        Ok(schedule) => schedule,
        Err(error) => return labelled(0, "Schedule", LABEL, &error.to_string()),
    };
    let of = match schedule.settings.quantity {
        ScheduledQuantity::LnGain => "ln k",
        ScheduledQuantity::Gain => "k",
    };
    let kind = match schedule.degree() {
        Some(degree) => format!("polynomial of degree {degree} in airspeed, fitted to {of}"),
        None => format!("lookup table in airspeed, of {of}"),
    };
    let range = format!("{} to {} kt", number(schedule.airspeeds.min_kt), number(schedule.airspeeds.max_kt));
    let second = schedule.second.as_ref().map_or_else(String::new, |term| {
        format!(
            "; with {}, here in the middle of its range, {} {}",
            term.variable,
            number(term.middle()),
            term.variable.unit()
        )
    });
    let mut text = labelled(0, "Schedule", LABEL, &format!("{kind}, {range}{second}; net gains:"));
    let (inputs, outputs) = analysis.study.dataset.names_of_channels();
    for caution in &schedule.cautions {
        text.push_str(&detail("caution", &sanitized(&caution.words(&inputs, &outputs))));
    }
    text.push_str(&schedule_table(analysis, schedule, |correction, pair| {
        figure(Some(correction.net_gain(pair).value()), 3)
    }));
    if schedule.has_delays() {
        text.push_str(&labelled(0, "", LABEL, "net delays in ms:"));
        text.push_str(&schedule_table(analysis, schedule, |correction, pair| {
            figure(Some(s_to_ms(correction.net_delay(pair).value_s())), 1)
        }));
    }
    text
}

fn schedule_table(
    analysis: &Analysis,
    schedule: &Schedule,
    entry: impl Fn(&ChannelCorrection, Pair) -> String,
) -> String {
    /// Airspeeds shown: the ends, the middle, and the quarters.
    const SHOWN: [f64; 5] = [0.0, 0.25, 0.5, 0.75, 1.0];
    let dataset = &analysis.study.dataset;
    let (min, max) = (schedule.airspeeds.min_kt, schedule.airspeeds.max_kt);
    let at = SHOWN.map(|fraction| min + fraction * (max - min));
    let heading = at.map(|airspeed| format!("{} kt", figure(Some(airspeed), 0)));
    let [a, b, c, d, e] = heading.each_ref().map(|words| (words.as_str(), Side::Right));
    let mut table = TextTable::new([("response", Side::Left), a, b, c, d, e]);
    let corrections = at.map(|airspeed| schedule.at(airspeed));
    for pair in shown_pairs(&analysis.study) {
        let [a, b, c, d, e] = corrections.each_ref().map(|correction| entry(correction, pair));
        table.row([sanitized(&dataset.pair_name(pair)), a, b, c, d, e]);
    }
    table.lines(2)
}
