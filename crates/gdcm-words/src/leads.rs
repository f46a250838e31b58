//! Sentences about lead filters: the lead that each response needs, the filters, and the checks to
//! make before they are used (M15).
//!
//! A channel's signed delay is `tau`: a negative one is a lead, realised by a filter that acts as a
//! faster servo. A response gets the sum of the signed delays of its two channels. The *price* of
//! a filter is the gain that it adds above the band, where the corrected model is not valid.

use gdcm_method::correction::{Channel, LeadPrice};
use gdcm_method::uncertainty::Scalar;
use gdcm_model::dataset::Pair;
use gdcm_model::number_format::six_digits;
use gdcm_model::response::LeadFilter;
use gdcm_model::units::{s_to_ms, signed, telling};
use gdcm_study::results::lead_remarks::lead_remarks;
use gdcm_study::results::remark_kind::RemarkKind;
use gdcm_study::results::uncertainty::Uncertainty;
use gdcm_study::{ConditionAnalysis, Study};

use crate::lead_price::pair_price_text;
use crate::remark::remark_text;

/// Describes the lead or delay that each constrained response needs, and the lead filter of each
/// channel: "LAT → P needs 65 ms of lead over the band: 24 ms at P, 41 ms at LAT; +19.1 dB at 120
/// rad/s"; "LAT: as if a servo of 17 rad/s were replaced by one of 36 rad/s; +12.4 dB above the
/// band; +11.3 dB at 120 rad/s". The last sentence is [`lead_limit_words`]. With `uncertainty`, a
/// response's lead has its error bar: "65 ± 4 ms" (M13). Empty if leads are not requested.
pub fn lead_words(
    study: &Study,
    result: &ConditionAnalysis,
    uncertainty: Option<&Uncertainty>,
) -> Vec<String> {
    let Some(compensated) = &result.compensated else {
        return Vec::new();
    };
    let price = LeadPrice::new(&compensated.leads);
    let mut words = Vec::new();
    for pair in result.held().marked() {
        words.extend(wanted_lead_words(
            study,
            result,
            price.as_ref(),
            uncertainty,
            pair,
        ));
    }
    for (channel, filter) in compensated.leads.filters().iter() {
        let Some(filter) = filter else { continue };
        let name = channel.name_in(&study.dataset);
        let mut text = format!("{name}: {}", servo_words(*filter));
        if let Some(price) = &price {
            text.push_str(&format!(
                "; {} dB at {} rad/s",
                signed(price.gains_db[channel], 1),
                six_digits(price.above_rad_s())
            ));
        }
        words.push(text);
    }
    words.extend(lead_limit_words(result));
    words
}

/// Describes the lead or delay that a response needs, and the contributions of its two channels;
/// `None` if leads are not requested, or the response has no delta delay.
fn wanted_lead_words(
    study: &Study,
    result: &ConditionAnalysis,
    price: Option<&LeadPrice>,
    uncertainty: Option<&Uncertainty>,
    pair: Pair,
) -> Option<String> {
    let compensated = result.compensated.as_ref()?;
    let wanted_s = result.delta_delay_s(pair)?;
    let [output, input] = Channel::of_pair(pair);
    let contributions = [output, input].map(|channel| {
        let words = contribution_words(compensated.leads.taus_s[channel], wanted_s);
        format!("{words} at {}", channel.name_in(&study.dataset))
    });
    let mut text = format!(
        "{} needs {}{} ms of {} over the band: {}",
        study.dataset.pair_name(pair),
        whole_ms(wanted_s),
        half_width_words(result, uncertainty, pair).unwrap_or_default(),
        lead_or_delay(wanted_s),
        contributions.join(", ")
    );
    if let Some(words) = price.and_then(|price| pair_price_text(price, pair)) {
        text.push_str(&format!("; {words}"));
    }
    Some(text)
}

/// Formats a channel's signed delay as a contribution to the wanted one: "41 ms"; if one is a lead
/// and the other a delay, "5 ms of delay".
fn contribution_words(tau_s: f64, wanted_s: f64) -> String {
    let size = whole_ms(tau_s);
    if tau_s != 0.0 && (tau_s > 0.0) != (wanted_s > 0.0) {
        format!("{size} ms of {}", lead_or_delay(tau_s))
    } else {
        format!("{size} ms")
    }
}

/// Names a signed delay, which is a lead if negative.
fn lead_or_delay(tau_s: f64) -> &'static str {
    if tau_s < 0.0 { "lead" } else { "delay" }
}

/// Formats a delay's absolute value in whole milliseconds.
fn whole_ms(tau_s: f64) -> String {
    telling(s_to_ms(tau_s.abs()), 0)
}

/// Formats the half-width of the band delay's error bar \[ms\]: " ± 4"; `None` without an error
/// bar.
fn half_width_words(
    result: &ConditionAnalysis,
    uncertainty: Option<&Uncertainty>,
    pair: Pair,
) -> Option<String> {
    let uncertainty = uncertainty?;
    let condition = uncertainty.conditions.get(&result.condition.id())?;
    let bar = condition.bars[Scalar::BandDelay(pair)].as_ref()?;
    let half_width_s = bar.half_width(uncertainty.level)?;
    Some(format!(" ± {}", telling(s_to_ms(half_width_s), 0)))
}

/// Describes how many states the leads add, and up to which frequency the corrected model is valid;
/// `None` without leads.
pub fn lead_limit_words(result: &ConditionAnalysis) -> Option<String> {
    let leads = &result.compensated.as_ref()?.leads;
    let limit = six_digits(LeadPrice::new(leads)?.limit_rad_s);
    let states: usize = leads
        .filters()
        .iter()
        .filter_map(|(_, filter)| Some((*filter)?.order.number()))
        .sum();
    Some(format!(
        "The leads add {states} states. Do not use the corrected model above {limit} rad/s."
    ))
}

/// Describes a lead filter: "as if a servo of 17 rad/s were replaced by one of 36 rad/s; +12.4 dB
/// above the band".
pub fn servo_words(filter: LeadFilter) -> String {
    format!(
        "as if a servo of {} rad/s were replaced by one of {} rad/s; {} dB far above the band",
        telling(filter.zero_rad_s(), 0),
        telling(filter.lag_rad_s(), 0),
        signed(filter.gain_at_infinity_db(), 1)
    )
}

/// Returns the cautions about leads as sentences; empty if leads are not requested (M15.6).
pub fn lead_cautions(study: &Study, result: &ConditionAnalysis) -> Vec<String> {
    if result.compensated.is_none() {
        return Vec::new();
    }
    lead_remarks(study, result)
        .iter()
        .filter(|remark| remark.kind() != RemarkKind::Good)
        .map(|remark| remark_text(remark, &study.dataset))
        .collect()
}

#[cfg(test)]
mod tests {
    use gdcm_model::dataset::ConditionId;

    use super::*;
    use crate::example_tests::EXAMPLE;

    #[test]
    fn what_leads_do_and_cost_is_told_and_what_to_check_first() {
        let result = EXAMPLE.condition(ConditionId(1)).unwrap();
        let study = &EXAMPLE.study;
        let words = lead_words(study, result, None);
        // Reference values: LAT → P requires a lead of 65.4 ms, of which 24.1 ms at P and 41.2 ms at
        // LAT.
        assert!(
            words.iter().any(|of| of.starts_with(
                "LAT → P needs 65 ms of lead over the band: 24 ms at P, 41 ms at LAT; +"
            )),
            "{words:?}"
        );
        assert!(
            words.iter().any(|of| of.starts_with(
                "LAT: as if a servo of 18 rad/s were replaced by one of 36 rad/s; +11.6 dB"
            )),
            "{words:?}"
        );
        assert_eq!(
            words.last().unwrap(),
            "The leads add 20 states. Do not use the corrected model above 12 rad/s."
        );
    }
}
