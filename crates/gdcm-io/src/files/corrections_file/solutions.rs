//! The part of `corrections.json` about the gain fit and the delay fit: objective, optimality
//! proof, and the unmatched responses with an explanation.
//!
//! A constrained response is *unmatched* if its G or D (`wanted`) is infeasible; it is then
//! constrained to a feasible `target`. A *conflict* is a minimal infeasible set of constrained
//! responses and bounds; a *loop* of responses *agrees* if it deviates from consistency by no
//! more than the tolerance. A *remedy* is a single change that makes all constraints feasible,
//! and a *sensitivity* is the change in the objective if a constrained value or a bound is
//! raised.

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

pub(super) fn gain_solution(names: &LabelledAnalysis<'_>, result: &ConditionAnalysis) -> Value {
    let gains = &result.gains;
    let mut unmatched = Vec::new();
    for entry in &gains.unmatched {
        let figures = json!({
            "target": entry.target,
            "wanted": entry.delta,
            "short_db": entry.excess,
            "why": conflict_text(&entry.why, &names.inputs, &names.outputs),
        });
        unmatched.push(names.response_entries(entry.pair, figures));
    }
    json!({
        "objective": gains.objective,
        "lower_bound": gains.proof.lower_bound,
        "proven": matches!(gains.proof.outcome, Outcome::Proven { .. }),
        "gap": gains.proof.outcome.gap(),
        "local_minima": gains.proof.local_minima.len(),
        "matched": gains.matched,
        "unmatched": unmatched,
        "explanation": explanation(names, &result.gain_problem, gains),
    })
}

pub(super) fn delay_solution(names: &LabelledAnalysis<'_>, result: &ConditionAnalysis) -> Value {
    let delays = &result.delays;
    let band_top_rad_s = names.analysis.study.settings.band.max();
    let mut unmatched = Vec::new();
    for entry in &delays.unmatched {
        let mut why = miss_text(entry, band_top_rad_s, &names.inputs, &names.outputs);
        // If a single response would need a lead (`is_lone_lead`), `why` already states this.
        if !entry.why.is_lone_lead() {
            why = format!(
                "{why} {}",
                conflict_text(&entry.why, &names.inputs, &names.outputs)
            );
        }
        let figures = json!({
            "target_s": entry.target,
            "wanted_s": entry.delta,
            "phase_left_deg": entry.phase_left_deg(band_top_rad_s),
            "why": why,
        });
        unmatched.push(names.response_entries(entry.pair, figures));
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
        "explanation": explanation(names, &result.delay_problem, delays),
    });
    without_empty(solution, &["kkt_residual_s"])
}

/// Explains why gains or delays are not matched: the conflicts, loops that agree within the
/// tolerance, the changes that would resolve the conflicts, and each constraint's cost.
fn explanation(names: &LabelledAnalysis<'_>, problem: &Problem, solution: &Solution) -> Value {
    let mut conflicts = Vec::new();
    for conflict in &solution.conflicts {
        let words = conflict_text(conflict, &names.inputs, &names.outputs);
        conflicts.push(conflict_json(names, conflict, words));
    }
    let mut agreeing = Vec::new();
    for conflict in &solution.agreeing {
        let words = agreement_text(conflict, &names.inputs, &names.outputs);
        agreeing.push(conflict_json(names, conflict, words));
    }
    let remedy = solution.remedy.as_ref().map(|remedy| {
        let free = names.pairs(remedy.free.iter().copied());
        json!({"upper": remedy.upper, "lower": remedy.lower, "free": free})
    });
    let mut constraints = Vec::new();
    for sensitivity in sensitivities(problem, solution) {
        constraints.push(sensitivity_json(names, &sensitivity));
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
struct ConflictFigures {
    kind: &'static str,
    figure: Option<f64>,
    upper: Option<f64>,
    lower: Option<f64>,
}

impl ConflictFigures {
    fn new(kind: ConflictKind) -> Self {
        match kind {
            ConflictKind::AboveUpper { asked, upper, .. } => Self {
                kind: "upper_bound",
                figure: Some(asked),
                upper: Some(upper),
                ..Self::default()
            },
            // The lower bound of delays is fixed, so that the entries need a lead of `-asked`.
            ConflictKind::BelowLower {
                asked, lower: None, ..
            } => Self {
                kind: "lead",
                figure: Some(-asked),
                ..Self::default()
            },
            ConflictKind::BelowLower { asked, lower, .. } => Self {
                kind: "lower_bound",
                figure: Some(asked),
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
                figure: Some(asked),
                upper: Some(upper),
                lower,
            },
            ConflictKind::Loop { mismatch } => Self {
                kind: "loop",
                figure: Some(mismatch),
                ..Self::default()
            },
            ConflictKind::Unclear => Self {
                kind: "unclear",
                ..Self::default()
            },
        }
    }
}

fn conflict_json(names: &LabelledAnalysis<'_>, conflict: &Conflict, words: String) -> Value {
    let ConflictFigures {
        kind,
        figure,
        upper,
        lower,
    } = ConflictFigures::new(conflict.kind);
    let mut channels = Vec::new();
    for channel in conflict.channels() {
        channels.push(channel.name(&names.inputs, &names.outputs));
    }
    json!({
        "kind": kind,
        "entries": names.pairs(conflict.entries.iter().copied()),
        "channels": channels,
        "figure": figure,
        "upper": upper,
        "lower": lower,
        "words": words,
    })
}

fn sensitivity_json(names: &LabelledAnalysis<'_>, sensitivity: &Sensitivity) -> Value {
    let (restraint, entry, channel) = match sensitivity.constraint {
        ActiveConstraint::Held(pair) => ("held", Some(names.pair(pair)), None),
        ActiveConstraint::LowerBound(channel) => ("lower_bound", None, Some(channel)),
        ActiveConstraint::UpperBound(channel) => ("upper_bound", None, Some(channel)),
    };
    json!({
        "restraint": restraint,
        "entry": entry,
        "channel": channel.map(|channel| channel.name(&names.inputs, &names.outputs)),
        "per_unit": sensitivity.per_unit,
        "share_per_unit": sensitivity.share_per_unit,
    })
}
