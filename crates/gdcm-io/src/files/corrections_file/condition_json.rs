//! The part of `corrections.json` about a condition.
//!
//! A condition has a bundle of physics models and a bundle of identified models; their
//! *representatives* are compared (M5), which differ by the gain G and the delay D (M6). Models are
//! *rejected* by the engineer, or *set aside* by the analysis. A *held* response is constrained to
//! its G and D; a *held-out* condition is not used to fit the schedule.
//! `docs/reference/corrections.md` describes the keys.

use serde_json::{Map, Value, json};

use gdcm_method::fidelity::Cost;
use gdcm_model::dataset::model::Provenance;
use gdcm_model::dataset::{BundleKind, Condition, ConditionId, Model, PairTable};
use gdcm_study::ConditionAnalysis;
use gdcm_study::decisions::choices::ConditionChoice;
use gdcm_study::results::caution::Caution;
use gdcm_words::caution::caution_text;
use gdcm_words::convention_doubt::doubt_text;
use gdcm_words::leads::lead_cautions;

use super::couplings::condition_couplings;
use super::labelled_analysis::LabelledAnalysis;
use super::pair_rows::rows;
use super::solutions::{delay_solution, gain_solution};
use super::uncertainty::{bars, net_gain_bar};
use crate::json_empty_members::without_empty;

pub(super) fn condition_json(
    labelled: &LabelledAnalysis<'_>,
    condition: &Condition,
    result: &ConditionAnalysis,
) -> Value {
    let study = &labelled.analysis.study;
    let id = condition.id();
    let choice = study.choice(id);
    let correction = &result.correction;
    let corrected_costs = result
        .cost
        .map(|_, change| change.map(|change| change.corrected));
    let members = json!({
        "id": id.0,
        "name": condition.flight_state().name,
        "airspeed_kt": condition.flight_state().airspeed_kt,
        "physics_representative": result.representative_name(BundleKind::Physics),
        "identified_representative": result.representative_name(BundleKind::Identified),
        "rejected": study.rejected_names(id),
        "reasons": rejection_reasons(choice),
        "suggested_outliers": result.suggested(),
        "discontinuity": discontinuity(condition, result),
        "set_aside": set_aside(labelled, result),
        "sources": sources(condition),
        "scheduled": choice.scheduled,
        "held_out": choice.held_out,
        "held": labelled.pairs(result.held().marked()),
        // With leads, G of the response that remains after them.
        "G": rows(&result.gain_problem.delta, |gain| *gain),
        "D_s": rows(&result.comparison.delta.delay_s, |delay| *delay),
        "D_band_s": rows(&result.comparison.delta.band_delay_s, |delay| *delay),
        "gain_bounds": [result.gain_bounds().lower, result.gain_bounds().upper],
        "delay_upper_s": result.delay_upper_s(),
        "gains": labelled.gains(correction),
        "delays_s": labelled.delays_s(correction),
        "lead": labelled.leads(correction),
        "gain_solution": gain_solution(labelled, result),
        "delay_solution": delay_solution(labelled, result),
        "net_gains": net_gains(labelled, id, result),
        "bars": bars(labelled, id),
        "couplings": condition_couplings(labelled.analysis, result),
        "J": {
            "uncorrected": costs(&result.comparison.representative.cost),
            "corrected": costs(&corrected_costs),
        },
        "cautions": cautions(labelled, result),
    });
    without_empty(
        members,
        &[
            "reasons",
            "sources",
            "held_out",
            "lead",
            "bars",
            "couplings",
        ],
    )
}

/// Returns the rejected models for which the engineer noted a reason, with this reason.
fn rejection_reasons(choice: &ConditionChoice) -> Value {
    let mut reasons = Vec::new();
    for kind in BundleKind::BOTH {
        for (model, why) in &choice.bundle(kind).reasons {
            reasons.push(json!({"bundle": kind.to_string(), "model": model, "why": why}));
        }
    }
    Value::Array(reasons)
}

/// Returns the models that the analysis excluded automatically, with reasons.
fn set_aside(labelled: &LabelledAnalysis<'_>, result: &ConditionAnalysis) -> Value {
    let mut models = Vec::new();
    for caution in &result.cautions {
        if let Caution::SetAside { model, .. } = caution {
            models.push(json!({"model": model.name, "why": caution_words(labelled, caution)}));
        }
    }
    Value::Array(models)
}

fn caution_words(labelled: &LabelledAnalysis<'_>, caution: &Caution) -> String {
    caution_text(caution, |pair| {
        labelled.analysis.study.dataset.pair_name(pair)
    })
}

/// Returns channels with an apparent difference in sign or unit between the bundles, followed by
/// the cautions about the results and about leads.
fn cautions(labelled: &LabelledAnalysis<'_>, result: &ConditionAnalysis) -> Value {
    let study = &labelled.analysis.study;
    let mut cautions = Vec::new();
    for doubt in &result.doubts {
        cautions.push(doubt_text(doubt, &study.dataset));
    }
    for caution in &result.cautions {
        cautions.push(caution_words(labelled, caution));
    }
    cautions.extend(lead_cautions(study, result));
    json!(cautions)
}

/// Returns each response's net gain, with its interval if available.
fn net_gains(
    labelled: &LabelledAnalysis<'_>,
    id: ConditionId,
    result: &ConditionAnalysis,
) -> Value {
    let mut net_gains = Vec::new();
    for pair in result.held().pairs() {
        let mut members = Map::new();
        members.insert("gain".to_owned(), json!(result.correction.net_gain(pair)));
        if let Some(Value::Object(bar)) = net_gain_bar(labelled.analysis, id, pair) {
            members.extend(bar);
        }
        net_gains.push(labelled.response_entries(pair, Value::Object(members)));
    }
    Value::Array(net_gains)
}

/// Returns for each response the magnitude and phase parts of J.
fn costs(table: &PairTable<Option<Cost>>) -> Value {
    json!({
        "mag": rows(table, |cost| cost.magnitude),
        "phase": rows(table, |cost| cost.phase),
    })
}

/// Returns the model sources stated in the dataset.
fn sources(condition: &Condition) -> Value {
    let mut sources = Vec::new();
    for kind in BundleKind::BOTH {
        for model in condition.bundle(kind) {
            if let Some(provenance) = &model.source {
                sources.push(source(kind, model, provenance));
            }
        }
    }
    Value::Array(sources)
}

fn source(kind: BundleKind, model: &Model, provenance: &Provenance) -> Value {
    let source = json!({
        "bundle": kind.to_string(),
        "model": model.name,
        "file": provenance.file,
        "sha256": provenance.sha256,
        "variable": provenance.variable,
        "made": provenance.made,
        "note": provenance.note,
        "records": provenance.records,
        "unused": provenance.unused,
    });
    without_empty(source, &["records", "unused"])
}

/// Returns the discontinuity ratios by model name, in file order; empty if they could not be
/// computed.
fn discontinuity(condition: &Condition, result: &ConditionAnalysis) -> Value {
    let mut ratios = Map::new();
    if let Ok(found) = &result.bundle_metrics.discontinuity {
        let models = condition.bundle(BundleKind::Physics).iter();
        for (model, ratio) in models.zip(&found.ratios) {
            ratios.insert(model.name.clone(), json!(ratio));
        }
    }
    Value::Object(ratios)
}
