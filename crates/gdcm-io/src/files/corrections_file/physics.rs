//! The part of `corrections.json` about named physics parameters (M18.5).
//!
//! A physics parameter, such as a moment of inertia, moves the physics models; `z` is its
//! change in plausible standard deviations. The diagnosis fits `z` to all conditions, and
//! *names* a parameter as wrong if the evidence suffices; otherwise `why_not` gives the reason.
//! A *run* is a physics model with a single parameter moved, from which its effect is learned;
//! a *rerun* has several moved together, and checks the predicted effect. `not_used` lists the
//! runs and conditions that take no part in the fit; `left_out` is the benefit in each condition
//! with everything fitted to the others. `docs/reference/corrections.md` describes all keys.

use serde_json::{Map, Value, json};

use gdcm_method::correction::Channels;
use gdcm_model::dataset::Dataset;
use gdcm_study::Analysis;
use gdcm_study::results::applied_physics::AppliedPhysics;
use gdcm_study::results::moved_models::MovedModels;
use gdcm_study::results::physics_assessment::PhysicsAssessment;
use gdcm_study::results::physics_findings::{DiagnosedParameter, LeftOutData, PhysicsFindings};
use gdcm_study::results::rerun_check::RerunCheck;
use gdcm_words::physics::{
    diagnosis_cautions, left_out_lines, paste_block, rerun_text, verdict_text,
};

use super::couplings::{axis_cost, correction_cost};
use crate::json_empty_members::without_empty;

/// Returns the study's physics parameters: their diagnosis, applied changes and benefit; null if
/// none are requested, and only the reason and the data that are not used if they are unavailable.
pub(super) fn physics(analysis: &Analysis) -> Value {
    let applied = match &analysis.physics {
        None => return Value::Null,
        Some(Err(failure)) => {
            let mut physics = json!({"code": failure.code(), "why": failure.to_string()});
            if let Some(left_out) = failure.left_out() {
                add_not_used(&mut physics, left_out);
            }
            return physics;
        }
        Some(Ok(applied)) => applied,
    };
    let mut physics = match &applied.findings {
        Some(findings) => findings_json(findings, &analysis.study.dataset),
        None => json!({}),
    };
    let mut values = Vec::new();
    for value in &applied.values {
        values.push(json!({
            "name": value.parameter.name,
            "unit": value.parameter.unit,
            "change": value.change(),
            "z": value.z,
            "half_width": value.half_width(),
            "by_hand": value.is_by_hand,
        }));
    }
    physics["applied"] = Value::Array(values);
    physics["not_moved"] = not_moved(applied);
    physics["text_block"] = json!(paste_block(applied));
    if let Some(assessment) = &analysis.physics_assessment {
        add_assessment(&mut physics, assessment);
    }
    physics
}

/// Lists the conditions and models that keep their physics models although parameters are moved.
fn not_moved(applied: &AppliedPhysics) -> Value {
    let mut list = Vec::new();
    for (id, moved) in &applied.conditions {
        match moved {
            MovedModels::NotMoved(omission) => list.push(json!({
                "condition": id.0,
                "code": omission.code(),
                "why": omission.to_string(),
            })),
            MovedModels::Moved { kept, .. } => {
                for model in kept {
                    list.push(json!({
                        "condition": id.0,
                        "model": model.model,
                        "code": model.why.code(),
                        "why": model.why.to_string(),
                    }));
                }
            }
        }
    }
    Value::Array(list)
}

fn findings_json(findings: &PhysicsFindings, dataset: &Dataset) -> Value {
    let diagnosis = &findings.diagnosis;
    let name_of = |index: usize| findings.parameters[index].name.as_str();
    let mut parameters: Vec<Value> = findings.diagnosed().map(parameter_json).collect();
    for parameter in &findings.off {
        parameters.push(json!({
            "name": parameter.name,
            "unit": parameter.unit,
            "on": false,
            "plausible_sd": parameter.plausible_sd,
        }));
    }
    let mut pairs = Vec::new();
    for pair in &diagnosis.pairs {
        let [a, b] = pair.parameters;
        pairs.push(json!({"a": name_of(a), "b": name_of(b), "correlation": pair.correlation}));
    }
    let mut without_condition = Vec::new();
    for condition in &diagnosis.conditions {
        without_condition.push(json!({
            "id": condition.id.0,
            "misfit": condition.misfit,
            "z": condition.z_without,
        }));
    }
    let mut stepwise = Vec::new();
    for step in diagnosis.scores.iter().flat_map(|scores| &scores.stepwise) {
        stepwise.push(json!({"added": step.added.map(name_of), "ratio": step.score.ratio}));
    }
    let mut physics = json!({
        "verdict": diagnosis.verdict.map(|verdict| verdict.code()),
        "explained": diagnosis.explained(),
        "misfit": diagnosis.fit.misfit,
        "spread": diagnosis.spread,
        "passes": diagnosis.fit.passes.len(),
        "still_moving": diagnosis.fit.still_moving.map(name_of),
        "parameters": parameters,
        "stepwise": stepwise,
        "pairs": pairs,
        "tau_s": delays_json(&diagnosis.fit.delays_s, dataset),
        "without_condition": without_condition,
        "words": verdict_text(findings),
        "cautions": diagnosis_cautions(findings),
    });
    add_not_used(&mut physics, &findings.left_out);
    without_empty(physics, &["still_moving", "pairs", "cautions", "not_used"])
}

/// Adds the runs and conditions that take no part in the fit.
fn add_not_used(physics: &mut Value, left_out: &LeftOutData) {
    // In the order of `left_out_lines`: the conditions, then the runs.
    let mut not_used = Vec::new();
    for omitted in &left_out.conditions {
        not_used.push(json!({"condition": omitted.condition.0, "code": omitted.why.code()}));
    }
    for refused in &left_out.runs {
        not_used.push(json!({
            "condition": refused.condition.0,
            "run": refused.run.model,
            "parameter": refused.run.parameter,
            "code": refused.run.reason.code(),
        }));
    }
    for (entry, line) in not_used.iter_mut().zip(left_out_lines(left_out)) {
        entry["why"] = json!(line);
    }
    physics["not_used"] = Value::Array(not_used);
}

fn parameter_json(found: DiagnosedParameter<'_>) -> Value {
    let diagnosis = found.diagnosis;
    let parameter = json!({
        "name": found.parameter.name,
        "unit": found.parameter.unit,
        "description": found.parameter.description,
        "on": true,
        "change": found.change(),
        "interval": found.interval(),
        "z": diagnosis.z,
        "plausible_sd": found.parameter.plausible_sd,
        "named": diagnosis.is_named(),
        "why_not": diagnosis.why_not_named.map(|why| why.code()),
        "ratio_alone": diagnosis.ratio_alone,
        "step": diagnosis.step,
        "gain": diagnosis.gain,
        "learned": diagnosis.learned,
        "channels_can_take": diagnosis.channels_can_take,
        "variance": diagnosis.variance.map(|variance| json!({
            "condition": variance.condition,
            "output": variance.output,
            "input": variance.input,
            "band": variance.band,
            "prior": variance.prior,
        })),
    });
    without_empty(parameter, &["description"])
}

/// Returns the channel delays by name, inputs first.
fn delays_json(delays_s: &Channels<f64>, dataset: &Dataset) -> Value {
    let (inputs, outputs) = dataset.input_and_output_names();
    let mut members = Map::new();
    let values = delays_s.inputs.iter().chain(&delays_s.outputs);
    for (name, delay_s) in inputs.iter().chain(&outputs).zip(values) {
        members.insert(name.clone(), json!(delay_s));
    }
    Value::Object(members)
}

fn add_assessment(physics: &mut Value, assessment: &PhysicsAssessment) {
    let costs = &assessment.costs;
    physics["uncorrected"] = axis_cost(costs.uncorrected);
    physics["moved"] = axis_cost(assessment.moved_uncorrected);
    physics["own"] = correction_cost(costs.own);
    physics["scheduled"] = correction_cost(costs.scheduled);
    if let Some(left_out) = costs.left_out {
        physics["left_out"] = correction_cost(left_out);
    }
    if !assessment.reruns.is_empty() {
        physics["reruns"] = assessment.reruns.iter().map(rerun_json).collect();
    }
}

/// Returns a rerun with J of two models against it: of the prediction, and of its base, which has
/// all parameters at their nominal values; or only the reason why it is not compared.
fn rerun_json(check: &RerunCheck) -> Value {
    let mut rerun = json!({
        "condition": check.condition.0,
        "model": check.model,
        "changes": check.changes,
        "words": rerun_text(check),
    });
    match &check.outcome {
        Ok(cost) => {
            rerun["code"] = json!(cost.verdict().code());
            rerun["prediction"] = axis_cost(cost.prediction);
            rerun["base"] = axis_cost(cost.base);
        }
        Err(refusal) => rerun["code"] = json!(refusal.code()),
    }
    rerun
}
