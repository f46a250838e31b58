//! `corrections.json`, which contains all analysis results. The files beside this one write its
//! parts; `docs/reference/corrections.md` describes the keys.

use std::collections::BTreeSet;

use serde_json::{Value, json};

use gdcm_method::correction::ChannelCorrection;
use gdcm_method::schedule::CostChange;
use gdcm_model::dataset::{BundleKind, Channel, Condition, ConditionId, PairTable};
use gdcm_study::Analysis;
use gdcm_words::assessment::not_assessed_text;
use gdcm_words::caution::failure_text;

use super::condition_json::condition_json;
use super::couplings::couplings;
use super::labelled_analysis::LabelledAnalysis;
use super::pair_rows::rows;
use super::physics::physics;
use super::schedule::schedule_json;
use super::uncertainty::uncertainty;
use super::{NAME, VERSION};
use crate::files::export_contents::ExportContents;
use crate::json_empty_members::without_empty;
use crate::software::software;

/// Returns the content of `corrections.json`: all results for the chosen conditions, with the whole
/// study's schedule. The file format documentation describes each key.
///
/// `sha256` is the dataset file's hash.
pub fn corrections(analysis: &Analysis, sha256: &str, chosen: &BTreeSet<ConditionId>) -> Value {
    let dataset = &analysis.study.dataset;
    let labelled = LabelledAnalysis::new(analysis);
    let mut conditions = Vec::new();
    let mut failed = Vec::new();
    let mut assessed = Vec::new();
    let mut not_assessed = Vec::new();
    for condition in dataset.conditions() {
        let id = condition.id();
        if !chosen.contains(&id) {
            continue;
        }
        match analysis.conditions.get(&id) {
            Some(Ok(result)) => conditions.push(condition_json(&labelled, condition, result)),
            Some(Err(failure)) => {
                let why = failure_text(failure, dataset);
                failed.push(json!({"id": id.0, "code": failure.code(), "why": why}));
            }
            None => {}
        }
        match analysis.assessment.get(&id) {
            Some(Ok(changes)) => assessed.push(assessment_json(condition, changes)),
            Some(Err(why)) => {
                let why = not_assessed_text(why, dataset);
                not_assessed.push(json!({"id": id.0, "why": why}));
            }
            None => {}
        }
    }
    let schedule = analysis.schedule.as_ref().ok();
    let mut settings = analysis.study.settings.named(dataset);
    // Earlier program versions learn from this setting whether the schedule has delays.
    settings.schedule.delays = schedule.is_some_and(|schedule| schedule.delays.is_some());
    let corrections = json!({
        "format": NAME,
        "version": VERSION,
        "software": software(),
        "dataset": {"name": dataset.name(), "sha256": sha256},
        "inputs": channels(dataset.inputs()),
        "outputs": channels(dataset.outputs()),
        "settings": settings,
        "signs": analysis.study.reversed_channels(),
        "contains": ExportContents::of_results(analysis).json(dataset),
        "physics": physics(analysis),
        "couplings": couplings(analysis),
        "conditions": conditions,
        "failed": failed,
        "schedule": schedule.map(|schedule| schedule_json(&labelled, schedule)),
        "assessment": {"conditions": assessed, "left_out": not_assessed},
        "uncertainty": uncertainty(&labelled),
    });
    without_empty(
        corrections,
        &["signs", "physics", "couplings", "uncertainty"],
    )
}

/// Converts a channel correction, for example the schedule's at an airspeed, to JSON: `gains`,
/// `delays_s`, and with leads `lead`, as for a condition in `corrections.json`.
pub fn channel_correction(analysis: &Analysis, correction: &ChannelCorrection) -> Value {
    let labelled = LabelledAnalysis::new(analysis);
    json!({
        "gains": labelled.gains(correction),
        "delays_s": labelled.delays_s(correction),
        "lead": labelled.leads(correction),
    })
}

/// Returns the change in J of a condition's nominal model due to the schedule.
fn assessment_json(condition: &Condition, changes: &PairTable<Option<CostChange>>) -> Value {
    json!({
        "id": condition.id().0,
        "model": condition.bundle(BundleKind::Physics)[condition.nominal()].name,
        "dJ": rows(changes, |change| change.total()),
        "dJ_mag": rows(changes, |change| change.magnitude()),
        "dJ_phase": rows(changes, |change| change.phase()),
    })
}

/// Returns channel names and units, in the order used in all lists and tables.
fn channels(channels: &[Channel]) -> Value {
    let mut list = Vec::with_capacity(channels.len());
    for channel in channels {
        list.push(json!({"name": channel.name, "unit": channel.unit}));
    }
    Value::Array(list)
}
