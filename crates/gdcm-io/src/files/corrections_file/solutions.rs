//! The part of `corrections.json` about the gain fit and the delay fit: objective, optimality
//! proof, and the unmatched responses with an explanation.
//!
//! A constrained response is *unmatched* if its G or D (`delta`; in the file, `wanted`) is
//! infeasible; it is then constrained to a feasible product of gains or sum of delays, its
//! `target`. A *conflict* is a minimal infeasible set of constrained responses and bounds; a *loop*
//! of responses *agrees* if it deviates from consistency by no more than the tolerance. A *remedy*
//! is a single change that makes all constraints feasible, and a *sensitivity* is the change in the
//! objective if a constrained value or a bound is raised.

use serde_json::{Value, json};

use gdcm_method::correction::conflict::{Conflict, ConflictKind};
use gdcm_method::correction::sensitivity::{
    ActiveConstraint, Sensitivity, kkt_residual, sensitivities,
};
use gdcm_method::correction::{Outcome, Problem, Quantity, Solution};
use gdcm_study::ConditionAnalysis;
use gdcm_words::conflict_text::{agreement_text, conflict_text, miss_text};

use super::labelled_analysis::LabelledAnalysis;
use crate::json_empty_members::without_empty;

pub(super) fn gain_solution(labelled: &LabelledAnalysis<'_>, result: &ConditionAnalysis) -> Value {
    let gains = &result.gains;
    let mut unmatched = Vec::new();
    for response in &gains.unmatched {
        let members = json!({
            "target": response.target,
            "wanted": response.delta,
            // 20 log10 (target / delta), negative if the correction is too weak.
            "short_db": response.excess,
            "why": conflict_text(&response.why, &labelled.inputs, &labelled.outputs),
        });
        unmatched.push(labelled.response_entries(response.pair, members));
    }
    json!({
        "objective": gains.objective,
        "lower_bound": gains.proof.lower_bound,
        "proven": matches!(gains.proof.outcome, Outcome::Proven { .. }),
        "gap": gains.proof.outcome.gap(),
        "local_minima": gains.proof.local_minima.len(),
        "matched": gains.matched,
        "unmatched": unmatched,
        "explanation": explanation(labelled, &result.gain_problem, gains),
    })
}

pub(super) fn delay_solution(labelled: &LabelledAnalysis<'_>, result: &ConditionAnalysis) -> Value {
    let delays = &result.delays;
    let band_top_rad_s = labelled.analysis.study.settings.band.max();
    let mut unmatched = Vec::new();
    for response in &delays.unmatched {
        let mut why = miss_text(
            response,
            band_top_rad_s,
            &labelled.inputs,
            &labelled.outputs,
        );
        // If a single response would need a lead (`is_lone_lead`), `why` already states this.
        if !response.why.is_lone_lead() {
            why = format!(
                "{why} {}",
                conflict_text(&response.why, &labelled.inputs, &labelled.outputs)
            );
        }
        let members = json!({
            "target_s": response.target,
            "wanted_s": response.delta,
            "phase_left_deg": response.phase_left_deg(band_top_rad_s),
            "why": why,
        });
        unmatched.push(labelled.response_entries(response.pair, members));
    }
    // The slope of the objective along the directions that the constraints permit: zero proves the
    // minimum, because the problem is convex.
    let kkt_residual_s = if delays.quantity == Quantity::SignedDelay {
        json!(kkt_residual(&result.delay_problem, delays))
    } else {
        Value::Null
    };
    let solution = json!({
        "objective": delays.objective,
        "kkt_residual_s": kkt_residual_s,
        "matched": delays.matched,
        "unmatched": unmatched,
        "explanation": explanation(labelled, &result.delay_problem, delays),
    });
    without_empty(solution, &["kkt_residual_s"])
}

/// Explains why gains or delays are not matched: the conflicts, loops that agree within the
/// tolerance, the changes that would resolve the conflicts, and each constraint's cost.
fn explanation(labelled: &LabelledAnalysis<'_>, problem: &Problem, solution: &Solution) -> Value {
    let mut conflicts = Vec::new();
    for conflict in &solution.conflicts {
        let words = conflict_text(conflict, &labelled.inputs, &labelled.outputs);
        conflicts.push(conflict_json(labelled, conflict, words));
    }
    let mut agreeing = Vec::new();
    for conflict in &solution.agreeing {
        let words = agreement_text(conflict, &labelled.inputs, &labelled.outputs);
        agreeing.push(conflict_json(labelled, conflict, words));
    }
    let remedy = solution.remedy.as_ref().map(|remedy| {
        let free = labelled.pairs(remedy.free.iter().copied());
        json!({"upper": remedy.upper, "lower": remedy.lower, "free": free})
    });
    let mut constraints = Vec::new();
    for sensitivity in sensitivities(problem, solution) {
        constraints.push(sensitivity_json(labelled, &sensitivity));
    }
    let explanation = json!({
        "conflicts": conflicts,
        "agreeing": agreeing,
        "remedy": remedy,
        "sensitivities": constraints,
    });
    without_empty(explanation, &["agreeing"])
}

/// A conflict's kind, with the conflicting values: factors for gains, seconds for delays.
#[derive(Default)]
struct ConflictValues {
    kind: &'static str,
    /// Product or sum that the responses require, their ratio or difference, or a loop's mismatch
    /// (for gains in dB).
    required: Option<f64>,
    /// Upper bound that would suffice.
    upper: Option<f64>,
    /// Lower bound that would suffice.
    lower: Option<f64>,
}

impl ConflictValues {
    fn new(kind: ConflictKind) -> Self {
        match kind {
            ConflictKind::AboveUpper { asked, upper, .. } => Self {
                kind: "upper_bound",
                required: Some(asked),
                upper: Some(upper),
                ..Self::default()
            },
            // The lower bound of delays is fixed, so that the responses need a lead of `-asked`.
            ConflictKind::BelowLower {
                asked, lower: None, ..
            } => Self {
                kind: "lead",
                required: Some(-asked),
                ..Self::default()
            },
            ConflictKind::BelowLower { asked, lower, .. } => Self {
                kind: "lower_bound",
                required: Some(asked),
                lower,
                ..Self::default()
            },
            ConflictKind::TooFarApart {
                asked,
                upper,
                lower,
                ..
            } => Self {
                kind: "both_bounds",
                required: Some(asked),
                upper: Some(upper),
                lower,
            },
            ConflictKind::Loop { mismatch } => Self {
                kind: "loop",
                required: Some(mismatch),
                ..Self::default()
            },
            ConflictKind::Unclear => Self {
                kind: "unclear",
                ..Self::default()
            },
        }
    }
}

fn conflict_json(labelled: &LabelledAnalysis<'_>, conflict: &Conflict, words: String) -> Value {
    let ConflictValues {
        kind,
        required,
        upper,
        lower,
    } = ConflictValues::new(conflict.kind);
    let mut channels = Vec::new();
    for channel in conflict.channels() {
        channels.push(channel.name(&labelled.inputs, &labelled.outputs));
    }
    json!({
        "kind": kind,
        "entries": labelled.pairs(conflict.entries.iter().copied()),
        "channels": channels,
        "figure": required,
        "upper": upper,
        "lower": lower,
        "words": words,
    })
}

/// Returns the constraint, which is a held response or a channel's bound, with the change in the
/// objective per dB (gains) or ms (delays).
fn sensitivity_json(labelled: &LabelledAnalysis<'_>, sensitivity: &Sensitivity) -> Value {
    let restraint = match sensitivity.constraint {
        ActiveConstraint::Held(_) => "held",
        ActiveConstraint::LowerBound(_) => "lower_bound",
        ActiveConstraint::UpperBound(_) => "upper_bound",
    };
    let held_pair = match sensitivity.constraint {
        ActiveConstraint::Held(pair) => Some(labelled.pair(pair)),
        ActiveConstraint::LowerBound(_) | ActiveConstraint::UpperBound(_) => None,
    };
    let bounded_channel = match sensitivity.constraint {
        ActiveConstraint::Held(_) => None,
        ActiveConstraint::LowerBound(channel) | ActiveConstraint::UpperBound(channel) => {
            Some(channel.name(&labelled.inputs, &labelled.outputs))
        }
    };
    json!({
        "restraint": restraint,
        "entry": held_pair,
        "channel": bounded_channel,
        "per_unit": sensitivity.per_unit,
        "share_per_unit": sensitivity.share_per_unit,
    })
}
