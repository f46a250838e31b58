//! The part of `corrections.json` about named physics parameters, and `physics.csv` (M18.5).
//!
//! A physics parameter, such as a moment of inertia, moves the physics models; `z` is its
//! change in plausible standard deviations. The diagnosis fits `z` to all conditions, and
//! *names* a parameter as wrong if the evidence suffices; otherwise `why_not` gives the reason.
//! A *run* is a physics model with a single parameter moved, from which its effect is learned;
//! a *rerun* has several moved together, and checks the predicted effect.

use std::collections::BTreeSet;
use std::io::{self, Write};

use serde_json::{Map, Value, json};

use gdcm_method::correction::Channels;
use gdcm_method::physics::OfferedParameter;
use gdcm_model::dataset::Dataset;
use gdcm_model::number_format::full_precision;
use gdcm_study::Analysis;
use gdcm_study::results::applied_physics::{AppliedPhysics, AppliedValue};
use gdcm_study::results::moved_models::MovedModels;
use gdcm_study::results::physics_assessment::PhysicsAssessment;
use gdcm_study::results::physics_findings::{DiagnosedParameter, LeftOutData, PhysicsFindings};
use gdcm_study::results::rerun_check::RerunCheck;
use gdcm_words::physics::{
    diagnosis_cautions, left_out_lines, paste_block, rerun_text, verdict_text,
};

use super::couplings::{axis_cost, correction_cost};
use crate::csv_text::write_records;
use crate::json_empty_members::without_empty;

/// Columns in `physics.csv`.
const COLUMNS: [&str; 21] = [
    "parameter",
    "unit",
    "on",
    "change",
    "lower",
    "upper",
    "z",
    "plausible_sd",
    "named",
    "why_not",
    "ratio_alone",
    "step",
    "gain",
    "learned",
    "channels_can_take",
    "variance_condition",
    "variance_output",
    "variance_input",
    "variance_band",
    "variance_prior",
    "applied",
];

/// Place of "on" in `COLUMNS`.
const ON: usize = 2;
/// Place of "z" in `COLUMNS`.
const Z: usize = 6;
/// Place of `plausible_sd` in `COLUMNS`.
const PLAUSIBLE_SD: usize = 7;
/// Place of "applied" in `COLUMNS`, the last column.
const APPLIED: usize = 20;

/// Returns the study's physics parameters: their diagnosis, applied changes and benefit; null if
/// none are requested, and only the reason and the unused data if they are unavailable.
pub(super) fn physics(analysis: &Analysis) -> Value {
    let applied = match &analysis.physics {
        None => return Value::Null,
        Some(Err(failure)) => {
            let mut physics = json!({"code": failure.code(), "why": failure.to_string()});
            if let Some(left_out) = failure.left_out() {
                add_left_out(&mut physics, left_out);
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
    let name = |index: usize| findings.parameters[index].name.as_str();
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
        pairs.push(json!({"a": name(a), "b": name(b), "correlation": pair.correlation}));
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
        stepwise.push(json!({"added": step.added.map(name), "ratio": step.score.ratio}));
    }
    let mut physics = json!({
        "verdict": diagnosis.verdict.map(|verdict| verdict.code()),
        "explained": diagnosis.explained(),
        "misfit": diagnosis.fit.misfit,
        "spread": diagnosis.spread,
        "passes": diagnosis.fit.passes.len(),
        "still_moving": diagnosis.fit.still_moving.map(name),
        "parameters": parameters,
        "stepwise": stepwise,
        "pairs": pairs,
        "tau_s": delays_json(&diagnosis.fit.delays_s, dataset),
        "without_condition": without_condition,
        "words": verdict_text(findings),
        "cautions": diagnosis_cautions(findings),
    });
    add_left_out(&mut physics, &findings.left_out);
    without_empty(physics, &["still_moving", "pairs", "cautions", "not_used"])
}

/// Adds the runs and conditions that take no part in the fit.
fn add_left_out(physics: &mut Value, left_out: &LeftOutData) {
    let words = left_out_lines(left_out);
    let mut codes = Vec::new();
    for omitted in &left_out.conditions {
        codes.push(json!({"condition": omitted.condition.0, "code": omitted.why.code()}));
    }
    for refused in &left_out.runs {
        codes.push(json!({
            "condition": refused.condition.0,
            "run": refused.run.model,
            "parameter": refused.run.parameter,
            "code": refused.run.reason.code(),
        }));
    }
    for (entry, words) in codes.iter_mut().zip(words) {
        entry["why"] = json!(words);
    }
    physics["not_used"] = Value::Array(codes);
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

/// Writes `physics.csv`: a row for each parameter, with its diagnosis and the applied change; a
/// parameter that is off has neither, and one set by hand without a fit has no diagnosis. Writes
/// only the headings if no parameters are applied.
pub(crate) fn write_physics_csv(
    applied: Option<&AppliedPhysics>,
    file: &mut dyn Write,
) -> io::Result<()> {
    let mut records = vec![COLUMNS.map(str::to_owned).to_vec()];
    if let Some(applied) = applied {
        records.extend(parameter_records(applied));
    }
    write_records(file, records.into_iter())
}

/// Returns the rows of `physics.csv`: the diagnosed parameters, those that are switched off, and
/// those that are only set by hand.
fn parameter_records(applied: &AppliedPhysics) -> Vec<Vec<String>> {
    let mut records = Vec::new();
    let mut listed: BTreeSet<&str> = BTreeSet::new();
    if let Some(findings) = &applied.findings {
        for found in findings.diagnosed() {
            let name = found.parameter.name.as_str();
            listed.insert(name);
            let value = applied
                .values
                .iter()
                .find(|value| value.parameter.name == name);
            let mut cells = diagnosed_cells(found);
            cells.push(full_precision(value.map(AppliedValue::change)));
            records.push(cells);
        }
        for parameter in &findings.off {
            listed.insert(&parameter.name);
            let mut cells = empty_cells(parameter);
            cells[ON] = "no".to_owned();
            records.push(cells);
        }
    }
    for value in &applied.values {
        if listed.contains(value.parameter.name.as_str()) {
            continue;
        }
        let mut cells = empty_cells(&value.parameter);
        cells[ON] = "yes".to_owned();
        cells[Z] = full_precision(Some(value.z));
        cells[APPLIED] = full_precision(Some(value.change()));
        records.push(cells);
    }
    records
}

/// Returns the cells for a parameter without a diagnosis.
fn empty_cells(parameter: &OfferedParameter) -> Vec<String> {
    let mut cells = vec![String::new(); COLUMNS.len()];
    cells[0] = parameter.name.clone();
    cells[1] = parameter.unit.clone();
    cells[PLAUSIBLE_SD] = full_precision(Some(parameter.plausible_sd));
    cells
}

/// Returns all cells for a diagnosed parameter except the last, the applied change.
fn diagnosed_cells(found: DiagnosedParameter<'_>) -> Vec<String> {
    let diagnosis = found.diagnosis;
    let [lower, upper] = match found.interval() {
        Some([lower, upper]) => [Some(lower), Some(upper)],
        None => [None, None],
    };
    let variance = diagnosis.variance;
    vec![
        found.parameter.name.clone(),
        found.parameter.unit.clone(),
        "yes".to_owned(),
        full_precision(Some(found.change())),
        full_precision(lower),
        full_precision(upper),
        full_precision(Some(diagnosis.z)),
        full_precision(Some(found.parameter.plausible_sd)),
        yes_no(diagnosis.is_named()),
        match diagnosis.why_not_named {
            Some(why) => why.code().to_owned(),
            None => String::new(),
        },
        full_precision(diagnosis.ratio_alone),
        match diagnosis.step {
            Some(step) => step.to_string(),
            None => String::new(),
        },
        full_precision(diagnosis.gain),
        full_precision(diagnosis.learned),
        full_precision(diagnosis.channels_can_take),
        full_precision(variance.and_then(|variance| variance.condition)),
        full_precision(variance.and_then(|variance| variance.output)),
        full_precision(variance.and_then(|variance| variance.input)),
        full_precision(variance.and_then(|variance| variance.band)),
        full_precision(variance.map(|variance| variance.prior)),
    ]
}

fn yes_no(is_true: bool) -> String {
    let word = if is_true { "yes" } else { "no" };
    word.to_owned()
}
