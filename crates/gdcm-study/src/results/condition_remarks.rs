//! Finds the remarks on a condition's result.
//!
//! G and D are the gain and the delay that would match a response (M6), the *targets* of the
//! correction; J is the cost of the mismatch (M4), and a response is *farther* from flight if the
//! correction increases its J. A remark is a typed fact that is displayed with the result: a
//! success, a caution or a failure. Constrained responses that share channels can form a *loop*, in
//! which each net gain or delay follows from the others; their targets must then agree.

use gdcm_method::schedule::Schedule;

use super::analysis::ConditionAnalysis;
use super::caution::Caution;
use super::lead_remarks::lead_remarks;
use super::remark::{FartherResponse, MissedTargets, NeededLead, Remark};
use crate::decisions::settings::PhaseCorrection;
use crate::decisions::study::Study;

/// Maximum increase in a constrained response's J that is not reported as worse; with leads every
/// increase is reported (M15.6).
const NEGLIGIBLE_INCREASE: f64 = 0.5;

/// Collects the remarks on a result in this order: suspected sign and unit differences, and
/// reversed channels; gains and delays matched, or not and why; leads; agreeing loops; coherence;
/// responses farther from flight; absence from the schedule; the cautions about the condition and
/// the schedule.
pub fn condition_remarks(
    study: &Study,
    result: &ConditionAnalysis,
    schedule: Option<&Schedule>,
) -> Vec<Remark> {
    let mut remarks = sign_remarks(study, result);
    remarks.extend(gain_remarks(study, result));
    if study.settings.phase == PhaseCorrection::Delay {
        remarks.extend(delay_remarks(study, result));
    }
    remarks.extend(lead_remarks(study, result));
    remarks.extend(agreement_remarks(result));
    remarks.extend(coherence_remark(result));
    remarks.extend(held_farther_remark(study, result));
    remarks.extend(free_farther_remark(study, result));
    if !study.choice(result.condition.id()).scheduled {
        remarks.push(Remark::LeftOutOfSchedule);
    }
    remarks.extend(result.cautions.iter().cloned().map(Remark::Caution));
    if let Some(schedule) = schedule {
        remarks.extend(schedule_remarks(result, schedule));
    }
    remarks
}

/// Returns the schedule cautions that concern the condition.
fn schedule_remarks(result: &ConditionAnalysis, schedule: &Schedule) -> Vec<Remark> {
    let mut remarks = Vec::new();
    for caution in &schedule.cautions {
        if caution.concerns(result.condition.id()) {
            remarks.push(Remark::Schedule(caution.clone()));
        }
    }
    remarks
}

/// Returns remarks on suspected sign and unit differences, and then on the reversed channels. The
/// suspicions come first because the differences can be mistaken for other effects.
fn sign_remarks(study: &Study, result: &ConditionAnalysis) -> Vec<Remark> {
    let mut remarks: Vec<Remark> = result
        .doubts
        .iter()
        .cloned()
        .map(Remark::ConventionDoubt)
        .collect();
    for (&channel, &role) in &study.signs {
        remarks.push(Remark::ChannelReversed { channel, role });
    }
    remarks
}

/// Reports that all constrained gains are matched; otherwise the missed responses, the conflicts
/// that cause this, and changes that would remove them.
fn gain_remarks(study: &Study, result: &ConditionAnalysis) -> Vec<Remark> {
    if result.gains.matched {
        let tolerance_db = if result.gains.agreeing.is_empty() {
            None
        } else {
            Some(study.settings.agreement_db)
        };
        return vec![Remark::GainsMatched {
            held: result.held().marked().count(),
            tolerance_db,
        }];
    }
    let mut remarks: Vec<Remark> = MissedTargets::find(&result.gains, study.settings.band)
        .into_iter()
        .map(Remark::GainsMissed)
        .collect();
    if let Some(remedy) = &result.gains.remedy
        && !remedy.is_empty()
    {
        remarks.push(Remark::GainsRemedy(remedy.clone()));
    }
    remarks
}

/// Returns a remark for each constraint loop, in gain or in delay, that agrees within the
/// tolerance.
fn agreement_remarks(result: &ConditionAnalysis) -> Vec<Remark> {
    let loops = result.gains.agreeing.iter().chain(&result.delays.agreeing);
    loops.cloned().map(Remark::LoopAgrees).collect()
}

/// Returns a remark if coherence weights are used and exclude no frequency. A caution reports
/// excluded frequencies instead (M4a).
fn coherence_remark(result: &ConditionAnalysis) -> Option<Remark> {
    let has_exclusions = result
        .cautions
        .iter()
        .any(|caution| matches!(caution, Caution::NotCoherent { .. }));
    if has_exclusions {
        return None;
    }
    let responses = result
        .comparison
        .representative
        .mismatch
        .iter()
        .filter(|(_, mismatch)| {
            mismatch
                .as_ref()
                .is_some_and(|mismatch| mismatch.coherence_weights.is_some())
        })
        .count();
    if responses == 0 {
        return None;
    }
    Some(Remark::CoherenceUsed { responses })
}

/// Returns a remark on the constrained responses that the correction moves away from flight.
fn held_farther_remark(study: &Study, result: &ConditionAnalysis) -> Option<Remark> {
    let negligible = match study.settings.phase {
        PhaseCorrection::Lead => 0.0,
        PhaseCorrection::None | PhaseCorrection::Delay => NEGLIGIBLE_INCREASE,
    };
    let mut farther = Vec::new();
    for pair in result.held().marked() {
        let Some(cost) = result.cost[pair] else {
            continue;
        };
        if cost.total() > negligible {
            farther.push(FartherResponse { pair, cost });
        }
    }
    if farther.is_empty() {
        return None;
    }
    Some(Remark::HeldFarther(farther))
}

/// Returns a remark on the unconstrained responses that a correction with leads moves away from
/// flight (M15.6); `None` without leads.
fn free_farther_remark(study: &Study, result: &ConditionAnalysis) -> Option<Remark> {
    if study.settings.phase != PhaseCorrection::Lead {
        return None;
    }
    let mut compared = 0;
    let mut farther = 0;
    for (pair, change) in result.cost.iter() {
        let Some(change) = change else { continue };
        if result.held()[pair] {
            continue;
        }
        compared += 1;
        if change.total() > 0.0 {
            farther += 1;
        }
    }
    if farther == 0 {
        return None;
    }
    Some(Remark::FreeFarther { farther, compared })
}

/// Reports that all constrained delays are matched (nothing without constrained responses);
/// otherwise the responses that need lead, and then each other missed response.
fn delay_remarks(study: &Study, result: &ConditionAnalysis) -> Vec<Remark> {
    let held = result.held().marked().count();
    if result.delays.unmatched.is_empty() {
        if held == 0 {
            return Vec::new();
        }
        return vec![Remark::DelaysMatched {
            held,
            is_exact: result.delays.agreeing.is_empty(),
        }];
    }
    let mut remarks: Vec<Remark> = needed_lead_remark(result, held).into_iter().collect();
    for miss in &result.delays.unmatched {
        if miss.delta >= 0.0 {
            remarks.push(Remark::DelayMissed {
                miss: miss.clone(),
                band_top_rad_s: study.settings.band.max(),
            });
        }
    }
    remarks
}

/// Returns a remark on the constrained responses with a negative D, which no delay can match.
fn needed_lead_remark(result: &ConditionAnalysis, held: usize) -> Option<Remark> {
    let needed: Vec<NeededLead> = result
        .delays
        .unmatched
        .iter()
        .filter(|miss| miss.delta < 0.0)
        .map(|miss| NeededLead {
            pair: miss.pair,
            lead_s: -miss.delta,
        })
        .collect();
    if needed.is_empty() {
        return None;
    }
    Some(Remark::NeedsLead { needed, held })
}
