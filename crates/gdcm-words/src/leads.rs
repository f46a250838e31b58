//! Sentences about lead filters: the lead that each response needs, the filters, and the checks to
//! make before they are used (M15).

use gdcm_method::correction::{Channel, LeadPrice};
use gdcm_method::uncertainty::Scalar;
use gdcm_model::dataset::Pair;
use gdcm_model::response::LeadFilter;
use gdcm_model::statistics::median;
use gdcm_model::units::{number, ratio_to_db, s_to_ms, signed, telling};
use gdcm_study::results::uncertainty::Uncertainty;
use gdcm_study::{ConditionAnalysis, PhaseCorrection, Study};

use crate::missed_targets::missed_target_texts;
use crate::remark::{Remark, RemarkKind, Repeated};

/// Maximum difference \[s\] between the two values of D, by eq. (9) and over the band, at which the
/// missing phase can be due to a delay.
const APART_S: f64 = 0.02;
/// Minimum absolute signed delay \[s\] that needs a correction.
const NOTHING_S: f64 = 2e-3;
/// Minimum gain increase \[dB\] that is reported.
const NOTHING_DB: f64 = 0.05;

/// Describes the lead of responses and channels: "P from LAT needs 65 ms of lead over the band: 24
/// on P, 41 on LAT"; "LAT: as if a servo of 17 rad/s were replaced by one of 36 rad/s; +12.4 dB
/// above the band". With `uncertainty`, the lead of a response has its error bar: "65 ± 4 ms"
/// (M13).
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
                number(price.above_rad_s())
            ));
        }
        words.push(text);
    }
    words.extend(lead_limit_words(result));
    words
}

/// Describes the lead or delay that a response needs, and the contributions of its two channels.
fn wanted_lead_words(
    study: &Study,
    result: &ConditionAnalysis,
    price: Option<&LeadPrice>,
    uncertainty: Option<&Uncertainty>,
    pair: Pair,
) -> Option<String> {
    let compensated = result.compensated.as_ref()?;
    let wanted_s = result.wanted_delay_s(pair)?;
    let [output, input] = Channel::of_pair(pair);
    let part = |channel: Channel| {
        let tau_s = compensated.leads.taus_s[channel];
        let is_opposite = tau_s != 0.0 && (tau_s > 0.0) != (wanted_s > 0.0);
        let sign = if is_opposite { "−" } else { "" };
        format!(
            "{sign}{} on {}",
            whole_ms(tau_s),
            channel.name_in(&study.dataset)
        )
    };
    let mut text = format!(
        "{} from {} needs {}{} ms of {} over the band: {}, {}",
        output.name_in(&study.dataset),
        input.name_in(&study.dataset),
        whole_ms(wanted_s),
        half_width_words(result, uncertainty, pair).unwrap_or_default(),
        if wanted_s < 0.0 { "lead" } else { "delay" },
        part(output),
        part(input)
    );
    if let Some(words) = price.and_then(|price| price.pair_words(pair)) {
        text.push_str(&format!("; {words}"));
    }
    Some(text)
}

/// Formats the absolute value of a delay in whole milliseconds.
fn whole_ms(tau_s: f64) -> String {
    telling(s_to_ms(tau_s.abs()), 0)
}

/// Formats the half-width of the band delay's error bar \[ms\]: " ± 4".
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

/// Describes the number of states that the leads add, and the frequency up to which the corrected
/// model is valid; `None` without leads.
pub fn lead_limit_words(result: &ConditionAnalysis) -> Option<String> {
    let leads = &result.compensated.as_ref()?.leads;
    let limit = number(LeadPrice::new(leads)?.limit_rad_s);
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
        "as if a servo of {} rad/s were replaced by one of {} rad/s; {} dB above the band",
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
        .into_iter()
        .filter(|remark| remark.kind != RemarkKind::Good)
        .map(|remark| remark.text)
        .collect()
}

/// Returns the remarks on leads, including the checks to make before they are used. For a study
/// without leads, they only report whether leads would help.
pub(crate) fn lead_remarks(study: &Study, result: &ConditionAnalysis) -> Vec<Remark> {
    let mut remarks: Vec<Remark> = common_lead(result).into_iter().collect();
    if study.settings.phase == PhaseCorrection::Lead {
        remarks.extend(achieved(study, result));
        remarks.extend(raised_gain(study, result));
    }
    remarks.extend(not_of_a_delay(study, result));
    remarks.extend(offered_leads(result));
    remarks
}

/// Reports the mean J over the constrained responses without and with leads; `None` unless leads
/// are recommended.
fn offered_leads(result: &ConditionAnalysis) -> Option<Remark> {
    let offer = result.offer?;
    let without = telling(offer.without, 0);
    let with = telling(offer.with, 0);
    let text = format!(
        "All held responses need lead: with a delay or lead in each channel, their mean J would \
        be about {with} instead of {without}."
    );
    let remark =
        Remark::caution("leads-offered", text).repeated(Repeated::LeadsOffered([without, with]));
    Some(Remark {
        phase: Some(PhaseCorrection::Lead),
        ..remark
    })
}

/// Reports that all constrained responses need about the same lead, and which causes to check
/// first.
fn common_lead(result: &ConditionAnalysis) -> Option<Remark> {
    let mut wanted_s: Vec<f64> = result
        .held()
        .marked()
        .filter_map(|pair| result.comparison.delta.band_delay_s[pair])
        .collect();
    let least = wanted_s.iter().copied().fold(f64::INFINITY, f64::min);
    let most = wanted_s.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let middle = median(&mut wanted_s);
    let is_common = wanted_s.len() > 1
        && most < 0.0
        && most - least <= 0.5 * middle.abs()
        && -middle >= NOTHING_S;
    if !is_common {
        return None;
    }
    let lead_ms = telling(-s_to_ms(middle), 0);
    let text = format!(
        "All held responses need about {lead_ms} ms of lead. First check the time alignment of \
        the records, and the integration and sampling delay of the simulation, then the servo \
        and sensor models: a common lag is better removed at its source than corrected."
    );
    Some(Remark::caution("common-lead", text).repeated(Repeated::CommonLead(lead_ms)))
}

/// Reports whether every constrained response gets the lead that it needs; otherwise names the
/// responses that do not, with the reason.
fn achieved(study: &Study, result: &ConditionAnalysis) -> Vec<Remark> {
    let delays = &result.delays;
    let is_negligible = delays
        .inputs
        .iter()
        .chain(&delays.outputs)
        .all(|tau_s| tau_s.abs() < NOTHING_S);
    if is_negligible {
        return vec![Remark::good(
            "leads-negligible",
            "No phase correction is needed: every delay or lead is below 2 ms.",
        )];
    }
    if delays.unmatched.is_empty() {
        let text = match result.held().marked().count() {
            0 => "No delay or lead is held.".to_owned(),
            1 => "The held response gets the delay or lead that it needs.".to_owned(),
            count => format!("All {count} held responses get the delay or lead that they need."),
        };
        return vec![Remark::good("leads-matched", text)];
    }
    missed_target_texts(study, delays)
        .into_iter()
        .map(|text| Remark::caution("leads-missed", text))
        .collect()
}

/// Reports the gain increase within the band due to the lead filters, for which the channel gains
/// compensate.
fn raised_gain(study: &Study, result: &ConditionAnalysis) -> Option<Remark> {
    let compensated = result.compensated.as_ref()?;
    let rises = result.held().marked().filter_map(|pair| {
        let rise = result.comparison.delta.gain[pair]? / compensated.gain[pair]?;
        Some((pair, ratio_to_db(rise)))
    });
    let (pair, rise_db) = rises.max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()))?;
    if rise_db.abs() < NOTHING_DB || rise_db.is_nan() {
        return None;
    }
    let most_db = telling(rise_db.abs(), 1);
    let name = study.dataset.pair_name(pair);
    let text = format!(
        "The lead filters raise the gain within the band by up to {most_db} dB ({name}); the \
        channel gains compensate for this."
    );
    Some(Remark::caution("gain-raised", text).repeated(Repeated::RaisedGain(most_db, pair)))
}

/// Reports the constrained responses whose two values of D are far apart, which indicates a zero or
/// a mode in the band. Responses with a suspected sign difference are excepted, because their half
/// turn of phase has another cause.
fn not_of_a_delay(study: &Study, result: &ConditionAnalysis) -> Option<Remark> {
    let delta = &result.comparison.delta;
    let mut apart = Vec::new();
    for pair in result.held().marked() {
        let has_doubtful_sign = result
            .doubts
            .iter()
            .any(|doubt| doubt.turns().is_some() && doubt.pairs.contains(&pair));
        let (Some(median_s), Some(band_s)) = (delta.delay_s[pair], delta.band_delay_s[pair]) else {
            continue;
        };
        if !has_doubtful_sign && (median_s - band_s).abs() > APART_S {
            apart.push(format!(
                "{} {} ms by eq. (9), {} ms over the band",
                study.dataset.pair_name(pair),
                signed(s_to_ms(median_s), 0),
                signed(s_to_ms(band_s), 0)
            ));
        }
    }
    if apart.is_empty() {
        return None;
    }
    let remedy = if study.settings.phase == PhaseCorrection::Lead {
        ", which a lead filter cannot correct"
    } else {
        ""
    };
    let text = format!(
        "The missing phase is not due to a delay, but to a zero or a mode in the band{remedy}: {}.",
        apart.join("; ")
    );
    Some(Remark::caution("not-a-delay", text))
}
