//! Remarks on the result of a condition, identical in the window and in a terminal.

use gdcm_method::correction::sensitivity::{kkt_residual, sensitivities};
use gdcm_method::schedule::Schedule;
use gdcm_model::dataset::Pair;
use gdcm_model::units::{number, s_to_ms, telling, told_apart};
use gdcm_study::decisions::signs::SignRole;
use gdcm_study::results::caution::Caution;
use gdcm_study::{ConditionAnalysis, PhaseCorrection, Study};

use crate::caution::caution_text;
use crate::convention_doubt::doubt_text;
use crate::leads::lead_remarks;
use crate::missed_targets::missed_target_texts;
use crate::remark::{Remark, Repeated};

/// Maximum increase in J of a constrained response that is not reported as worse; with leads every
/// increase is reported (M15.6).
const NEGLIGIBLE_INCREASE: f64 = 0.5;

/// Collects the remarks on a result: which constrained gains and delays were matched; which were
/// not, and why; and the cautions about the condition and the schedule.
pub fn remarks(
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
    remarks.extend(agreement_remarks(study, result));
    remarks.extend(coherence_remark(result));
    remarks.extend(worse_remark(study, result));
    remarks.extend(others_worse_remark(study, result));
    if !study.choice(result.condition.id()).scheduled {
        remarks.push(Remark::caution(
            "left-out-of-schedule",
            "This condition is left out of the schedule: its gains do not enter the fit.",
        ));
    }
    for caution in &result.cautions {
        let text = caution_text(caution, |pair| study.dataset.pair_name(pair));
        remarks.push(Remark {
            ignore: caution.offers_to_ignore(),
            ..Remark::caution(caution.code(), text)
        });
    }
    if let Some(schedule) = schedule {
        remarks.extend(schedule_remarks(study, result, schedule));
    }
    remarks
}

/// Returns the cautions of the schedule that concern the condition, as remarks.
fn schedule_remarks(study: &Study, result: &ConditionAnalysis, schedule: &Schedule) -> Vec<Remark> {
    let (inputs, outputs) = study.dataset.names_of_channels();
    let mut remarks = Vec::new();
    for caution in &schedule.cautions {
        if caution.concerns(result.condition.id()) {
            let text = format!("Schedule: {}.", caution.words(&inputs, &outputs));
            remarks.push(Remark::caution("schedule-caution", text));
        }
    }
    remarks
}

/// Returns remarks on suspected sign and unit differences, and then on the reversed channels. The
/// suspicions come first because the differences can be mistaken for other effects.
fn sign_remarks(study: &Study, result: &ConditionAnalysis) -> Vec<Remark> {
    let mut remarks = Vec::new();
    for doubt in &result.doubts {
        let turn = doubt
            .turns()
            .map(|channel| (channel, Some(SignRole::Identified)));
        remarks.push(Remark {
            turn,
            ..Remark::caution("convention-doubt", doubt_text(doubt, &study.dataset))
        });
    }
    for (channel, role) in &study.signs {
        let name = channel.name_in(&study.dataset);
        let models = role.models();
        let text = format!("The sign of {name} is reversed in {models}, relative to the file.");
        remarks.push(Remark {
            turn: Some((*channel, None)),
            ..Remark::good("channel-turned", text)
        });
    }
    remarks
}

fn gain_remarks(study: &Study, result: &ConditionAnalysis) -> Vec<Remark> {
    if result.gains.matched {
        return vec![matched_gains_remark(study, result)];
    }
    let mut texts = missed_target_texts(study, &result.gains);
    if let Some(remedy) = &result.gains.remedy {
        let (inputs, outputs) = study.dataset.names_of_channels();
        let text = remedy.words(&inputs, &outputs);
        if !text.is_empty() {
            texts.push(text);
        }
    }
    texts
        .into_iter()
        .map(|text| Remark::trouble("gains-missed", text))
        .collect()
}

fn matched_gains_remark(study: &Study, result: &ConditionAnalysis) -> Remark {
    let text = match result.held().marked().count() {
        0 => "No gain is held.".to_owned(),
        1 => "The held gain is matched exactly.".to_owned(),
        count if !result.gains.agreeing.is_empty() => {
            format!(
                "All {count} held gains are matched within {} dB.",
                number(study.settings.agreement_db)
            )
        }
        count => format!("All {count} held gains are matched exactly."),
    };
    Remark::good("gains-matched", text)
}

/// Returns a remark on the loops that agree within the tolerance.
fn agreement_remarks(study: &Study, result: &ConditionAnalysis) -> Vec<Remark> {
    let (inputs, outputs) = study.dataset.names_of_channels();
    let loops = result.gains.agreeing.iter().chain(&result.delays.agreeing);
    loops
        .map(|disagreement| {
            Remark::good(
                "loop-agrees",
                disagreement.agreement_words(&inputs, &outputs),
            )
        })
        .collect()
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
    let weighted = result
        .comparison
        .representative
        .mismatch
        .iter()
        .filter(|(_, entry)| {
            entry
                .as_ref()
                .is_some_and(|entry| entry.coherence_weights.is_some())
        })
        .count();
    if weighted == 0 {
        return None;
    }
    Some(Remark::good(
        "coherence-used",
        format!("J, G and D of {weighted} responses are weighted by coherence."),
    ))
}

/// Returns a remark on the constrained responses that the correction moves away from flight.
fn worse_remark(study: &Study, result: &ConditionAnalysis) -> Option<Remark> {
    let negligible = match study.settings.phase {
        PhaseCorrection::Lead => 0.0,
        PhaseCorrection::None | PhaseCorrection::Delay => NEGLIGIBLE_INCREASE,
    };
    let mut pairs = Vec::new();
    let mut texts = Vec::new();
    for pair in result.held().marked() {
        let Some(change) = result.cost[pair] else {
            continue;
        };
        if change.total() > negligible {
            let (before, after) =
                told_apart(change.uncorrected.total(), change.corrected.total(), 0);
            pairs.push(pair);
            texts.push(format!(
                "{} (J {before} → {after})",
                study.dataset.pair_name(pair)
            ));
        }
    }
    if pairs.is_empty() {
        return None;
    }
    let text = format!(
        "Held, but farther from flight than without a correction: {}.",
        texts.join(", ")
    );
    Some(Remark::caution("held-farther", text).repeated(Repeated::Farther(pairs)))
}

/// Returns a remark on the number of unconstrained responses that the leads move away from flight
/// (M15.6).
fn others_worse_remark(study: &Study, result: &ConditionAnalysis) -> Option<Remark> {
    if study.settings.phase != PhaseCorrection::Lead {
        return None;
    }
    let mut compared = 0;
    let mut worse = 0;
    for (pair, change) in result.cost.iter() {
        let Some(change) = change else { continue };
        if result.held()[pair] {
            continue;
        }
        compared += 1;
        if change.total() > 0.0 {
            worse += 1;
        }
    }
    if worse == 0 {
        return None;
    }
    Some(Remark::caution(
        "free-farther",
        format!(
            "{worse} of the {compared} responses that are not held are farther from flight than \
            without a correction."
        ),
    ))
}

fn delay_remarks(study: &Study, result: &ConditionAnalysis) -> Vec<Remark> {
    let held = result.held().marked().count();
    if result.delays.unmatched.is_empty() {
        if held == 0 {
            return Vec::new();
        }
        let accuracy = if result.delays.agreeing.is_empty() {
            "exactly"
        } else {
            "to the displayed precision"
        };
        let text = format!("All {held} held delays are matched {accuracy}.");
        return vec![Remark::good("delays-matched", text)];
    }
    let mut remarks: Vec<Remark> = needed_lead_remark(study, result, held)
        .into_iter()
        .collect();
    let (inputs, outputs) = study.dataset.names_of_channels();
    let band_top = study.settings.band.max();
    for miss in &result.delays.unmatched {
        if miss.delta >= 0.0 {
            let text = miss.words(band_top, &inputs, &outputs);
            remarks.push(Remark::caution("delay-missed", text));
        }
    }
    remarks
}

/// Returns a remark on the constrained responses with a negative D, which no delay can match.
fn needed_lead_remark(study: &Study, result: &ConditionAnalysis, held: usize) -> Option<Remark> {
    let needed: Vec<(Pair, String)> = result
        .delays
        .unmatched
        .iter()
        .filter(|miss| miss.delta < 0.0)
        .map(|miss| (miss.pair, telling(-s_to_ms(miss.delta), 0)))
        .collect();
    let subject = match (needed.len(), held) {
        (0, _) => return None,
        (1, 1) => "The held response needs".to_owned(),
        (1, _) => format!("1 of {held} held responses needs"),
        (count, _) if count == held => format!("All {held} held responses need"),
        (count, _) => format!("{count} of {held} held responses need"),
    };
    let leads: Vec<String> = needed
        .iter()
        .map(|(pair, lead_ms)| format!("{} {lead_ms} ms", study.dataset.pair_name(*pair)))
        .collect();
    let text = format!(
        "{subject} lead, because the physics model lags: {}. A delay cannot provide it.",
        leads.join(", ")
    );
    Some(Remark::caution("needs-lead", text).repeated(Repeated::NeedsLead(needed)))
}

/// Lists the details of the solution: other minima, the phase error at the upper end of the band
/// due to each missed delay, and the sensitivity to constraints and active bounds.
pub fn details(study: &Study, result: &ConditionAnalysis) -> Vec<String> {
    /// Maximum relative sensitivity of the objective that is not listed.
    const NOTABLE: f64 = 1e-3;
    let (inputs, outputs) = study.dataset.names_of_channels();
    let mut details = vec![result.gains.proof.outcome.words()];
    for minimum in result.gains.proof.local_minima.iter().skip(1) {
        let worse = 100.0 * (minimum.objective / result.gains.objective - 1.0);
        let of_inputs = named_gains(&inputs, &minimum.inputs);
        let of_outputs = named_gains(&outputs, &minimum.outputs);
        details.push(format!(
            "Another set of gains is only {worse:.2} % worse: {of_inputs}; {of_outputs}."
        ));
    }
    if study.settings.phase == PhaseCorrection::Lead {
        let residual_s = kkt_residual(&result.delay_problem, &result.delays);
        details.push(format!(
            "The optimisation of delays and leads is convex: the KKT residual of {residual_s:.0e} \
            s proves that the solution is optimal."
        ));
    }
    let band_top = study.settings.band.max();
    for miss in &result.delays.unmatched {
        details.push(miss.words(band_top, &inputs, &outputs));
    }
    for (problem, solution) in [
        (&result.gain_problem, &result.gains),
        (&result.delay_problem, &result.delays),
    ] {
        for sensitivity in sensitivities(problem, solution) {
            if sensitivity.share_per_unit.abs() > NOTABLE {
                details.push(sensitivity.words(&inputs, &outputs));
            }
        }
    }
    details
}

/// Lists gains with their channels: "LON 1.012, LAT 0.987".
fn named_gains(names: &[String], gains: &[f64]) -> String {
    let named: Vec<String> = names
        .iter()
        .zip(gains)
        .map(|(name, gain)| format!("{name} {gain:.3}"))
        .collect();
    named.join(", ")
}
