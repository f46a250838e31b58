//! The difference between two representatives that remains after the lead filters (M15.5).

use std::sync::Arc;

use gdcm_method::correction::delta::delta_gains;
use gdcm_method::correction::leads::ChannelLeads;
use gdcm_method::correction::{Channel, ChannelCorrection, LeadPrice};
use gdcm_method::fidelity::{Cost, CostAverage, Mismatch};
use gdcm_method::schedule::assessment::{CostChange, corrected_cost};
use gdcm_method::uncertainty::Scalar;
use gdcm_model::dataset::{Pair, PairTable};
use gdcm_model::response::LeadFilter;
use gdcm_model::units::{number, ratio_to_db, s_to_ms, signed, telling};

use super::uncertainty::Uncertainty;
use crate::decisions::settings::PhaseCorrection;
use crate::decisions::study::Study;
use crate::results::analysis::ConditionAnalysis;
use crate::results::remark::{Remark, RemarkKind, Repeated, miss_words};

/// The physics representative with the leads of its channels against the identified one: the basis
/// of the gains.
#[derive(Clone, Debug, PartialEq)]
pub struct LeadCompensated {
    /// The signed delays with their filters.
    pub leads: ChannelLeads,
    /// Difference of every response that both models have, without the pure delays among the leads.
    pub mismatch: PairTable<Option<Mismatch>>,
    /// G of the compensated representative, `[output, input]`.
    pub gain: PairTable<Option<f64>>,
}

impl LeadCompensated {
    pub(crate) fn of(mismatch: &PairTable<Option<Mismatch>>, leads: &ChannelLeads) -> Arc<Self> {
        let mismatch = mismatch.map(|pair, mismatch| match leads.curve(pair) {
            None => mismatch.clone(),
            Some(lead) => mismatch
                .as_ref()
                .map(|mismatch| mismatch.multiplied(&lead.magnitude_db, &lead.phase)),
        });
        // A pure delay does not change magnitudes.
        let gain = delta_gains(&mismatch);
        Arc::new(Self {
            leads: leads.clone(),
            mismatch,
            gain,
        })
    }
}

/// Mean J of the constrained responses, all of which want lead: with the present correction, and
/// with leads too.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LeadOffer {
    /// Under the present correction.
    pub without: f64,
    /// With a lead filter in each channel that wants one, and the same gains, which such filters
    /// change little.
    pub with: f64,
}

impl LeadOffer {
    /// Returns the offer of these leads, where they would reduce J of the constrained responses by
    /// at least a tenth.
    pub(crate) fn of(
        leads: ChannelLeads,
        mismatch: &PairTable<Option<Mismatch>>,
        now: &PairTable<Option<CostChange>>,
        (omega, average): (&[f64], CostAverage),
    ) -> Option<Self> {
        const WORTH: f64 = 0.9;
        let phase_alone = ChannelCorrection::of_leads(leads.taus_s.map(|_, _| 1.0), leads);
        let left = corrected_cost(mismatch, &phase_alone, omega, average);
        let of_both = |(pair, left): (Pair, &Option<Cost>)| {
            let left = (*left)?.phase;
            let now = now[pair]?.corrected;
            Some([now.total(), now.magnitude + left])
        };
        let both: Vec<[f64; 2]> = left.iter().filter_map(of_both).collect();
        let mean = |at: usize| both.iter().map(|of| of[at]).sum::<f64>() / both.len() as f64;
        let offer = Self {
            without: mean(0),
            with: mean(1),
        };
        (!both.is_empty() && offer.with < WORTH * offer.without).then_some(offer)
    }
}

/// Difference \[s\] between the two figures of D beyond which they do not describe a delay.
const APART_S: f64 = 0.02;
/// Signed delays below this \[s\] need no correction.
const NOTHING_S: f64 = 2e-3;

/// Describes the responses and the channels with lead: "P from LAT wants 65 ms of lead over the
/// band: 24 on P, 41 on LAT"; "LAT: as if a servo of 17 rad/s were replaced by one of 36 rad/s;
/// +12.4 dB above the band". The lead that a response wants has its error bar where `sure` contains
/// it: "65 ± 4 ms" (M13).
pub fn lead_words(
    study: &Study,
    result: &ConditionAnalysis,
    sure: Option<&Uncertainty>,
) -> Vec<String> {
    let Some(compensated) = &result.compensated else {
        return Vec::new();
    };
    let name = |channel: Channel| channel.name_in(&study.dataset);
    let price = LeadPrice::of(&compensated.leads);
    let half_ms = |pair: Pair| {
        let bar =
            sure?.conditions.get(&result.condition.id())?.bars[Scalar::BandDelay(pair)].as_ref()?;
        Some(format!(
            " ± {}",
            telling(s_to_ms(bar.half_width(sure?.level)?), 0)
        ))
    };
    let wants = |pair: Pair| {
        let [output, input] = Channel::of(pair);
        let wanted_s = result.wanted_delay_s(pair)?;
        let ms = |tau_s: f64| telling(s_to_ms(tau_s.abs()), 0);
        let part = |channel: Channel| {
            let tau_s = compensated.leads.taus_s[channel];
            let sign = if (tau_s > 0.0) == (wanted_s > 0.0) || tau_s == 0.0 {
                ""
            } else {
                "−"
            };
            format!("{sign}{} on {}", ms(tau_s), name(channel))
        };
        let price = price
            .as_ref()
            .and_then(|price| price.pair_words(pair))
            .map(|words| format!("; {words}"));
        let price = price.unwrap_or_default();
        Some(format!(
            "{} from {} wants {}{} ms of {} over the band: {}, {}{price}",
            name(output),
            name(input),
            ms(wanted_s),
            half_ms(pair).unwrap_or_default(),
            if wanted_s < 0.0 { "lead" } else { "delay" },
            part(output),
            part(input)
        ))
    };
    let filters = || {
        compensated
            .leads
            .filters()
            .iter()
            .filter_map(|(channel, filter)| Some((channel, (*filter)?)))
    };
    let replaced = filters().map(|(channel, filter)| {
        let at_above = price.as_ref().map(|price| {
            format!(
                "; {} dB at {} rad/s",
                signed(price.gains_db[channel], 1),
                number(price.above_rad_s())
            )
        });
        format!(
            "{}: {}{}",
            name(channel),
            servo_words(filter),
            at_above.unwrap_or_default()
        )
    });
    result
        .held()
        .marked()
        .filter_map(wants)
        .chain(replaced)
        .chain(lead_limit_words(result))
        .collect()
}

/// Describes the number of states that the leads add, and the upper frequency limit of the
/// corrected model's validity.
pub fn lead_limit_words(result: &ConditionAnalysis) -> Option<String> {
    let leads = &result.compensated.as_ref()?.leads;
    let top = number(LeadPrice::of(leads)?.limit_rad_s);
    let states: usize = leads
        .filters()
        .iter()
        .filter_map(|(_, filter)| Some((*filter)?.order.number()))
        .sum();
    Some(format!(
        "The leads add {states} states. Do not use the corrected model above {top} rad/s."
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

/// Returns the cautions about leads in words, where they are requested (M15.6).
pub fn lead_cautions(study: &Study, result: &ConditionAnalysis) -> Vec<String> {
    let remarks = if result.compensated.is_some() {
        lead_remarks(study, result)
    } else {
        Vec::new()
    };
    remarks
        .into_iter()
        .filter(|remark| remark.kind != RemarkKind::Good)
        .map(|remark| remark.text)
        .collect()
}

/// Returns the remarks on leads and on the checks before their use; for a study without leads,
/// whether they would help.
pub(crate) fn lead_remarks(study: &Study, result: &ConditionAnalysis) -> Vec<Remark> {
    let caution = |text: String| Remark::new(RemarkKind::Caution, text);
    let mut remarks: Vec<Remark> = common_lead(result).into_iter().collect();
    if study.settings.phase == PhaseCorrection::Lead {
        remarks.extend(achieved(study, result));
        remarks.extend(raised_gain(study, result));
    }
    remarks.extend(not_of_a_delay(study, result).map(caution));
    remarks.extend(result.offer.map(|offer| {
        let without = telling(offer.without, 0);
        let with = telling(offer.with, 0);
        let text = format!(
            "All held responses want lead: with a delay or lead in each channel their J would be about {with} in the mean, in place \
             of {without}."
        );
        let remark = Remark::new(RemarkKind::Caution, text).repeated(Repeated::LeadsOffered([without, with]));
        Remark { phase: Some(PhaseCorrection::Lead), ..remark }
    }));
    remarks
}

/// Reports that all constrained responses want about the same lead, and what to check first.
fn common_lead(result: &ConditionAnalysis) -> Option<Remark> {
    let held = result.held().marked();
    let mut wanted_s: Vec<f64> = held
        .filter_map(|pair| result.comparison.delta.band_delay_s[pair])
        .collect();
    let (least, most) = wanted_s
        .iter()
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), at| {
            (a.min(*at), b.max(*at))
        });
    let middle = gdcm_model::statistics::median(&mut wanted_s);
    let is_common = wanted_s.len() > 1
        && most < 0.0
        && most - least <= 0.5 * middle.abs()
        && -middle >= NOTHING_S;
    is_common.then(|| {
        let lead_ms = telling(-s_to_ms(middle), 0);
        let text = format!(
            "All held responses want about {lead_ms} ms of lead: check first the time alignment of the records, the simulation's \
             integration and sampling delay, then servo and sensor models; a common lag is better taken out where it arises than \
             corrected."
        );
        Remark::new(RemarkKind::Caution, text).repeated(Repeated::CommonLead(lead_ms))
    })
}

/// Reports whether every constrained response gets the lead it wants; otherwise which does not, and
/// why.
fn achieved(study: &Study, result: &ConditionAnalysis) -> Vec<Remark> {
    let held = result.held().marked().count();
    let delays = &result.delays;
    if delays
        .inputs
        .iter()
        .chain(&delays.outputs)
        .all(|tau_s| tau_s.abs() < NOTHING_S)
    {
        let text = "Nothing to do for the phase: every delay or lead is less than 2 ms.".to_owned();
        return vec![Remark::new(RemarkKind::Good, text)];
    }
    if delays.unmatched.is_empty() {
        let text = match held {
            0 => "No delay or lead is held.".to_owned(),
            1 => "The held response gets the delay or lead that it wants.".to_owned(),
            count => format!("All {count} held responses get the delay or lead that they want."),
        };
        return vec![Remark::new(RemarkKind::Good, text)];
    }
    miss_words(study, delays)
        .map(|text| Remark::new(RemarkKind::Caution, text))
        .collect()
}

/// Reports the gain increase within the band by first-order filters, which the gains compensate.
fn raised_gain(study: &Study, result: &ConditionAnalysis) -> Option<Remark> {
    let compensated = result.compensated.as_ref()?;
    let rises = result.held().marked().filter_map(|pair| {
        let rise = result.comparison.delta.gain[pair]? / compensated.gain[pair]?;
        Some((pair, ratio_to_db(rise)))
    });
    let (pair, rise_db) = rises.max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()))?;
    (rise_db.abs() >= 0.05).then(|| {
        let most_db = telling(rise_db.abs(), 1);
        let name = study.dataset.pair_name(pair);
        let text = format!(
            "The lead filters raise the gain within the band, which the gains take back: by up to {most_db} dB ({name})."
        );
        Remark::new(RemarkKind::Caution, text).repeated(Repeated::RaisedGain(most_db, pair))
    })
}

/// Reports the constrained responses whose two figures of D are far apart, except those with a
/// suspected sign: half a turn is no zero and no mode.
fn not_of_a_delay(study: &Study, result: &ConditionAnalysis) -> Option<String> {
    let delta = &result.comparison.delta;
    let is_doubted = |pair: &Pair| {
        result
            .doubts
            .iter()
            .any(|of| of.turns().is_some() && of.pairs.contains(pair))
    };
    let apart = result
        .held()
        .marked()
        .filter(|pair| !is_doubted(pair))
        .filter_map(|pair| {
            let median_s = delta.delay_s[pair]?;
            let band_s = delta.band_delay_s[pair]?;
            let ms = |delay_s: f64| signed(s_to_ms(delay_s), 0);
            let name = study.dataset.pair_name(pair);
            ((median_s - band_s).abs() > APART_S).then(|| {
                format!(
                    "{name} {} ms by eq. (9), {} ms over the band",
                    ms(median_s),
                    ms(band_s)
                )
            })
        });
    let apart: Vec<String> = apart.collect();
    (!apart.is_empty()).then(|| {
        let lead = if study.settings.phase == PhaseCorrection::Lead { ": no lead filter mends it" } else { "" };
        format!(
            "The missing phase is not that of a delay, but of a zero or a mode in the band{lead}: {}.",
            apart.join("; ")
        )
    })
}
