//! A condition's results, as printed: representatives, rejected models, responses and channels.
//!
//! G and D are the gain and the delay that a response needs (M6), J its mismatch cost (M4); a held
//! response is constrained to its G and D. With leads, the *price* is the gain that a lead filter
//! adds above the band.

use gdcm_method::correction::channel_leads::ChannelLeads;
use gdcm_method::correction::{ChannelCorrection, LeadPrice, Outcome};
use gdcm_method::uncertainty::Scalar;
use gdcm_model::dataset::{BundleKind, Condition, Dataset};
use gdcm_model::message_text::sanitized;
use gdcm_model::number_format::NO_VALUE;
use gdcm_model::units::{number, s_to_ms, signed};
use gdcm_study::results::condition_remarks::condition_remarks;
use gdcm_study::results::remark_kind::RemarkKind;
use gdcm_study::{Analysis, ConditionAnalysis};
use gdcm_words::Table;
use gdcm_words::caution::failure_text;
use gdcm_words::remark::remark_text;
use gdcm_words::solution_details::proof_text;

use super::printed_lines::{detail, detail_list, fixed_digits, indented, line};
use super::schedule_summary::shown_pairs;

/// Returns the section on a condition: representatives, rejected models, on-axis and constrained
/// responses, channels, and unmatched responses; without a result, the reason.
pub(super) fn condition_section(analysis: &Analysis, condition: &Condition) -> String {
    let state = condition.flight_state();
    let title = format!(
        "{} ({} kt)",
        sanitized(&state.name),
        number(state.airspeed_kt)
    );
    let mut text = line(&format!("Condition {}", state.id), &title);
    match analysis.conditions.get(&condition.id()) {
        None => {}
        Some(Ok(result)) => {
            text += &model_lines(analysis, result);
            text += &indented(&response_table(analysis, result), 2);
            text += &channel_lines(analysis, result);
            text += &trouble_lines(analysis, result);
        }
        Some(Err(failure)) => {
            text += &detail(
                "no result",
                &sanitized(&failure_text(failure, &analysis.study.dataset)),
            )
        }
    }
    text
}

/// Returns the representatives, the rejected models, and the suggested outliers, which are physics
/// models, unless they are already rejected.
fn model_lines(analysis: &Analysis, result: &ConditionAnalysis) -> String {
    let id = result.condition.id();
    let mut text = String::new();
    for (label, bundle) in [
        ("physics", BundleKind::Physics),
        ("identified", BundleKind::Identified),
    ] {
        text += &detail(label, &sanitized(result.representative_name(bundle)));
    }
    let rejected = analysis.study.rejected_names(id);
    let rejected: Vec<String> = rejected.into_iter().map(sanitized).collect();
    text += &detail_list("rejected", &rejected);
    let choice = analysis.study.choice(id);
    let mut suggested = Vec::new();
    for name in result.suggested() {
        if !choice.physics.rejected.contains(&name) {
            suggested.push(sanitized(&name));
        }
    }
    if !suggested.is_empty() {
        text += &detail_list("outliers?", &suggested);
    }
    text
}

/// Returns a table with the correction and the cost J for each on-axis or constrained response.
fn response_table(analysis: &Analysis, result: &ConditionAnalysis) -> Table {
    let columns = [
        "response",
        "held",
        "G",
        "± %",
        "net gain",
        "± %",
        "D [ms]",
        "± ms",
        "net delay [ms]",
        "J before",
        "J after",
    ];
    let leads = result.compensated.as_ref();
    let price = leads.and_then(|compensated| LeadPrice::new(&compensated.leads));
    let mut table = Table::new("", with_price_heading(&columns, price.as_ref()));
    let dataset = &analysis.study.dataset;
    for pair in shown_pairs(&analysis.study) {
        let is_held = result.held()[pair];
        let cost = result.cost[pair];
        let mut cells = vec![
            sanitized(&dataset.pair_name(pair)),
            if is_held { "yes" } else { "no" }.to_owned(),
            fixed_digits(result.delta_gain(pair), 3),
            fixed_digits(half_width_percent(analysis, result, Scalar::Gain(pair)), 1),
            fixed_digits(Some(result.correction.net_gain(pair)), 3),
            fixed_digits(
                half_width_percent(analysis, result, Scalar::NetGain(pair)),
                1,
            ),
            fixed_digits(result.delta_delay_s(pair).map(s_to_ms), 1),
            fixed_digits(
                half_width_ms(analysis, result, result.delta_delay_scalar(pair)),
                1,
            ),
            fixed_digits(Some(s_to_ms(result.correction.net_delay_s(pair))), 1),
            fixed_digits(cost.map(|cost| cost.uncorrected.total()), 1),
            fixed_digits(cost.map(|cost| cost.corrected.total()), 1),
        ];
        if let Some(price) = &price {
            cells.push(signed(price.of_pair_db(pair), 1));
        }
        table.row(cells);
    }
    table
}

/// Returns the half-width of a gain's error bar \[%\]; `None` without error bars.
fn half_width_percent(
    analysis: &Analysis,
    result: &ConditionAnalysis,
    gain: Scalar,
) -> Option<f64> {
    bar_half_width(analysis, result, gain).map(|half_width| 100.0 * half_width)
}

/// Returns the half-width of a delay's error bar \[ms\]; `None` without error bars.
fn half_width_ms(analysis: &Analysis, result: &ConditionAnalysis, delay: Scalar) -> Option<f64> {
    bar_half_width(analysis, result, delay).map(|half_width_s| 1e3 * half_width_s)
}

/// Returns the half-width of an error bar, relative for gains and in s for delays; `None` without
/// error bars.
fn bar_half_width(analysis: &Analysis, result: &ConditionAnalysis, scalar: Scalar) -> Option<f64> {
    let uncertainty = analysis.uncertainty.as_ref()?;
    let bar = uncertainty.bar(result.condition.id(), scalar)?;
    bar.half_width(uncertainty.level)
}

/// Returns column headings, with an additional heading if there are leads: their price, which is
/// the gain that they add above the band.
fn with_price_heading(columns: &[&str], price: Option<&LeadPrice>) -> Vec<String> {
    let mut headings: Vec<String> = columns.iter().map(|&column| column.to_owned()).collect();
    if let Some(price) = price {
        headings.push(format!(
            "added gain at {} rad/s [dB]",
            number(price.above_rad_s())
        ));
    }
    headings
}

/// Returns all channels' gains, and their delays or leads: with leads as a table, otherwise as
/// lists without the delays that round to zero.
fn channel_lines(analysis: &Analysis, result: &ConditionAnalysis) -> String {
    let dataset = &analysis.study.dataset;
    let correction = &result.correction;
    if let Some(compensated) = &result.compensated {
        return indented(&lead_table(dataset, correction, &compensated.leads), 2);
    }
    let channels = dataset.inputs().iter().chain(dataset.outputs());
    let names: Vec<String> = channels.map(|channel| sanitized(&channel.name)).collect();
    let channel_gains = correction
        .input_gains
        .iter()
        .chain(&correction.output_gains);
    let mut gains = Vec::new();
    for (name, gain) in names.iter().zip(channel_gains) {
        gains.push(format!("{name} {}", fixed_digits(Some(*gain), 3)));
    }
    let mut delays = Vec::new();
    for (name, (_, delay_s)) in names.iter().zip(correction.signed_delays_s().iter()) {
        let delay_ms = fixed_digits(Some(s_to_ms(*delay_s)), 1);
        if delay_ms != "0.0" {
            delays.push(format!("{name} {delay_ms} ms"));
        }
    }
    detail_list("gains", &gains) + &detail_list("delays", &delays)
}

/// Returns a table with each channel's gain and delay or lead. A lead filter acts as if a servo
/// were replaced by one with a higher bandwidth; the table lists both bandwidths (M15).
fn lead_table(dataset: &Dataset, correction: &ChannelCorrection, leads: &ChannelLeads) -> Table {
    let columns = [
        "channel",
        "k",
        "delay/lead [ms]",
        "servo [rad/s]",
        "replaced by [rad/s]",
    ];
    let price = LeadPrice::new(leads);
    let mut table = Table::new("", with_price_heading(&columns, price.as_ref()));
    let (inputs, outputs) = dataset.input_and_output_names();
    for (channel, delay_s) in correction.signed_delays_s().iter() {
        let filter = leads.filters()[channel];
        let mut cells = vec![
            sanitized(&channel.name(&inputs, &outputs)),
            fixed_digits(Some(correction.gain(channel)), 3),
            fixed_digits(Some(s_to_ms(*delay_s)), 1),
            fixed_digits(filter.map(|filter| filter.zero_rad_s()), 0),
            fixed_digits(filter.map(|filter| filter.lag_rad_s()), 0),
        ];
        if let Some(price) = &price {
            cells.push(match filter {
                Some(_) => signed(price.gains_db[channel], 1),
                None => NO_VALUE.to_owned(),
            });
        }
        table.row(cells);
    }
    table
}

/// Lists the responses with unmatched gains, with reasons and remedies, and gains without an
/// optimality proof.
fn trouble_lines(analysis: &Analysis, result: &ConditionAnalysis) -> String {
    let mut text = String::new();
    // `condition_remarks` gives the unmatched responses first, then the reasons and remedies.
    let mut label = "not matched";
    // Cautions are collected in their own section.
    for remark in condition_remarks(&analysis.study, result, None) {
        if remark.kind() == RemarkKind::Trouble {
            let sentence = remark_text(&remark, &analysis.study.dataset);
            text += &detail(label, &sanitized(&sentence));
            label = "why";
        }
    }
    let outcome = &result.gains.proof.outcome;
    if matches!(outcome, Outcome::NotProven { .. }) {
        text += &detail("not proven", &sanitized(&proof_text(*outcome)));
    }
    text
}
