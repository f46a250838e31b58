//! The part of `corrections.json` about the schedule.
//!
//! The coefficients of a channel are those of a polynomial in the scaled airspeed, or the
//! values in a table over airspeed (M11). The *second variable* is altitude or mass, which adds
//! a slope per channel (M13.7); a *signed delay* is a delay or, if negative, a lead (M15).

use serde_json::{Value, json};

use gdcm_method::schedule::{Schedule, ScheduleCaution, ScheduleKind, ScheduledQuantity};
use gdcm_words::schedule::schedule_caution_text;

use super::labelled_analysis::LabelledAnalysis;
use crate::json_empty_members::without_empty;

/// Returns the object with the scheduled gains and delays (with leads, signed delays) over
/// airspeed.
pub(super) fn schedule_json(labelled: &LabelledAnalysis<'_>, schedule: &Schedule) -> Value {
    let airspeeds = &schedule.airspeeds;
    let gains = labelled.coefficients(&schedule.gains);
    let second_variable = schedule.second.as_ref().map(|term| {
        let slopes = labelled.by_channel(|channel| term.slopes[channel]);
        json!({
            "variable": term.variable.name(),
            "unit": term.variable.unit(),
            "middle": term.middle(),
            "half_range": term.half_range(),
            "inputs": slopes["inputs"],
            "outputs": slopes["outputs"],
        })
    });
    let delays_s = schedule.delays.as_ref().map(|delays| {
        let mut coefficients = labelled.coefficients(&delays.taus_s);
        // The upper bound at each airspeed of the table; it too is interpolated over airspeed.
        coefficients["upper_s"] = delays.upper_s.parameters().into();
        coefficients
    });
    let tau_s = schedule.leads.as_ref().map(|leads| {
        let mut coefficients = labelled.coefficients(&leads.taus_s);
        coefficients["bounds_s"] = json!(leads.bounds_s);
        coefficients
    });
    // `cautions` are the texts alone, `caution_notes` the same with codes and values.
    let mut cautions = Vec::new();
    let mut caution_notes = Vec::new();
    for caution in &schedule.cautions {
        cautions.push(schedule_caution_text(
            caution,
            &labelled.inputs,
            &labelled.outputs,
        ));
        caution_notes.push(schedule_caution(labelled, caution));
    }
    let members = json!({
        "kind": match schedule.settings.kind {
            ScheduleKind::Polynomial { .. } => "polynomial",
            ScheduleKind::Table => "table",
        },
        "of": match schedule.settings.quantity {
            ScheduledQuantity::LnGain => "ln k",
            ScheduledQuantity::Gain => "k",
        },
        "degree": schedule.degree(),
        "airspeed_tolerance_kt": schedule.settings.airspeed_tolerance_kt,
        "airspeed_mean_kt": airspeeds.mean_kt,
        "airspeed_half_range_kt": airspeeds.half_range_kt,
        "airspeed_range_kt": [airspeeds.min_kt, airspeeds.max_kt],
        "inputs": gains["inputs"],
        "outputs": gains["outputs"],
        "second_variable": second_variable,
        "delays_s": delays_s,
        "tau_s": tau_s,
        "table": schedule_table(labelled, schedule),
        "cautions": cautions,
        "caution_notes": caution_notes,
    });
    // Without scheduled delays, `delays_s` is null here, and absent from the table's rows.
    without_empty(members, &["second_variable", "tau_s", "caution_notes"])
}

/// Returns the correction at each distinct scheduled airspeed.
fn schedule_table(labelled: &LabelledAnalysis<'_>, schedule: &Schedule) -> Value {
    let mut rows = Vec::new();
    for airspeed_kt in schedule.airspeeds.clusters_kt() {
        let correction = schedule.at(airspeed_kt);
        let gains = labelled.gains(&correction);
        let delays_s = schedule
            .delays
            .as_ref()
            .map(|_| labelled.delays_s(&correction));
        let row = json!({
            "airspeed_kt": airspeed_kt,
            "inputs": gains["inputs"],
            "outputs": gains["outputs"],
            "delays_s": delays_s,
            "lead": labelled.leads(&correction),
        });
        rows.push(without_empty(row, &["delays_s", "lead"]));
    }
    Value::Array(rows)
}

/// Returns a caution about the schedule: its code and text; if it concerns a single condition, also
/// the condition and the values.
fn schedule_caution(labelled: &LabelledAnalysis<'_>, caution: &ScheduleCaution) -> Value {
    let text = schedule_caution_text(caution, &labelled.inputs, &labelled.outputs);
    match caution {
        ScheduleCaution::CostsMore(cost) => json!({
            "code": caution.code(),
            "condition": cost.condition.0,
            "model": cost.model,
            "value": cost.scheduled,
            "own": cost.own,
            "unit": "J",
            "text": text,
        }),
        ScheduleCaution::SignedDelayApart {
            channel,
            condition,
            tau_s,
            elsewhere_s,
        } => json!({
            "code": caution.code(),
            "condition": condition.0,
            "channel": channel.name(&labelled.inputs, &labelled.outputs),
            "value": tau_s,
            "elsewhere": elsewhere_s,
            "unit": "s",
            "text": text,
        }),
        ScheduleCaution::DegreeLowered { .. }
        | ScheduleCaution::Overshoot { .. }
        | ScheduleCaution::NotPositive => {
            json!({"code": caution.code(), "text": text})
        }
    }
}
