//! Finds the remarks on lead: the lead that the responses need, whether they get it, and the checks
//! to make before leads are used (M15).
//!
//! D is the delay that would match a response, from the phase by which the physics model leads the
//! identified one: by eq. (9) the median over frequency of phase / frequency; *over the band* the
//! slope of the line through the origin that fits the phase best (M15.2). A negative D needs lead.
//! A lead that all responses need points to the clock of the records, or to servo and sensor
//! models.
//!
//! The thresholds for the remarks are in M15.6.

use gdcm_model::statistics::median;
use gdcm_model::units::ratio_to_db;

use super::analysis::ConditionAnalysis;
use super::remark::{DelaysApart, MissedTargets, Remark};
use crate::decisions::settings::PhaseCorrection;
use crate::decisions::study::Study;

/// Maximum difference \[s\] between D by eq. (9) and D over the band at which the missing phase can
/// be due to a delay.
const APART_S: f64 = 0.02;
/// Minimum absolute signed delay \[s\] that is not negligible.
const LEAST_DELAY_S: f64 = 2e-3;
/// Minimum magnitude of a gain change due to leads \[dB\] that is reported: with second-order lead
/// filters it is about 0.01 dB, with first-order ones about 0.1 dB (M15.5).
const LEAST_GAIN_CHANGE_DB: f64 = 0.05;
/// Maximum range of the leads that count as common, relative to their median.
const COMMON_RANGE: f64 = 0.5;

/// Returns the remarks on lead. Whether the needed leads are achieved, and the gain that
/// they raise, are reported only for a study with leads.
pub fn lead_remarks(study: &Study, result: &ConditionAnalysis) -> Vec<Remark> {
    let mut remarks: Vec<Remark> = common_lead(result).into_iter().collect();
    if study.settings.phase == PhaseCorrection::Lead {
        remarks.extend(delays_achieved(study, result));
        remarks.extend(raised_gain(result));
    }
    remarks.extend(not_a_delay(study, result));
    remarks.extend(result.offer.map(Remark::LeadsOffered));
    remarks
}

/// Reports the median lead if it is at least [`LEAST_DELAY_S`], if all constrained responses (two
/// or more) need lead, and if their leads differ by at most half the median.
fn common_lead(result: &ConditionAnalysis) -> Option<Remark> {
    let mut band_delays_s: Vec<f64> = result
        .held()
        .marked()
        .filter_map(|pair| result.comparison.delta.band_delay_s[pair])
        .collect();
    let least = band_delays_s.iter().copied().fold(f64::INFINITY, f64::min);
    let most = band_delays_s
        .iter()
        .copied()
        .fold(f64::NEG_INFINITY, f64::max);
    let middle = median(&mut band_delays_s);
    let all_need_lead = most < 0.0;
    let is_common = band_delays_s.len() > 1
        && all_need_lead
        && most - least <= COMMON_RANGE * middle.abs()
        && -middle >= LEAST_DELAY_S;
    if !is_common {
        return None;
    }
    Some(Remark::CommonLead { lead_s: -middle })
}

/// Reports first that every channel's delay or lead is negligible; else that every constrained
/// response gets the delay or lead that it needs; else the responses that do not, with the reason.
fn delays_achieved(study: &Study, result: &ConditionAnalysis) -> Vec<Remark> {
    let delays = &result.delays;
    let is_negligible = delays
        .inputs
        .iter()
        .chain(&delays.outputs)
        .all(|tau_s| tau_s.abs() < LEAST_DELAY_S);
    if is_negligible {
        return vec![Remark::LeadsNegligible];
    }
    if delays.unmatched.is_empty() {
        return vec![Remark::LeadsMatched {
            held: result.held().marked().count(),
        }];
    }
    MissedTargets::find(delays, study.settings.band)
        .into_iter()
        .map(Remark::LeadsMissed)
        .collect()
}

/// Reports the constrained response whose G the lead filters change most; `None` below
/// [`LEAST_GAIN_CHANGE_DB`] and without leads. The channel gains compensate for this change.
fn raised_gain(result: &ConditionAnalysis) -> Option<Remark> {
    let compensated = result.compensated.as_ref()?;
    let changes = result.held().marked().filter_map(|pair| {
        let ratio = result.comparison.delta.gain[pair]? / compensated.gain[pair]?;
        Some((pair, ratio_to_db(ratio)))
    });
    let (pair, rise_db) = changes.max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()))?;
    if rise_db.abs() < LEAST_GAIN_CHANGE_DB || rise_db.is_nan() {
        return None;
    }
    Some(Remark::GainRaised { rise_db, pair })
}

/// Reports the constrained responses for which D by eq. (9) and D over the band differ by more than
/// [`APART_S`], which indicates a zero or a mode in the band. Responses with a suspected sign
/// difference are excluded, because their phase difference near half a turn has another cause.
fn not_a_delay(study: &Study, result: &ConditionAnalysis) -> Option<Remark> {
    let delta = &result.comparison.delta;
    let mut responses = Vec::new();
    for pair in result.held().marked() {
        let has_doubtful_sign = result
            .doubts
            .iter()
            .any(|doubt| doubt.channel_to_reverse().is_some() && doubt.pairs.contains(&pair));
        let (Some(median_s), Some(band_s)) = (delta.delay_s[pair], delta.band_delay_s[pair]) else {
            continue;
        };
        if !has_doubtful_sign && (median_s - band_s).abs() > APART_S {
            responses.push(DelaysApart {
                pair,
                median_s,
                band_s,
            });
        }
    }
    if responses.is_empty() {
        return None;
    }
    Some(Remark::NotADelay {
        responses,
        by_leads: study.settings.phase == PhaseCorrection::Lead,
    })
}
