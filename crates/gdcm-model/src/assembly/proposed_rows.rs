//! Proposes each model's place in the dataset (condition, role, name and trim), from the file, its
//! name and the rules.
//!
//! A *bundle* contains a condition's physics models, or its identified models. A *run* is a physics
//! model with a single named parameter moved (M18.1, docs/physics.md): it belongs to a condition,
//! but to no bundle.

use std::collections::BTreeSet;

use super::condition_numbers::number_conditions;
use super::found_model::{FoundModel, path_without_extension};
use super::name_contradictions::{name_contradictions, trim_offsets};
use super::row::Row;
use super::rules::Rules;
use crate::dataset::model::Origin;
use crate::dataset::physics_parameter::MovedParameters;
use crate::names::RowRole;
use crate::names::name_pattern::{read_name, unread_offsets};

/// Proposes a row for each model. A row contains the model's place in the dataset.
///
/// 1. Read the facts in the file and in its name.
/// 2. Number the conditions if no file or name gives a condition.
/// 3. Propose the nominal model of each condition.
/// 4. Apply the rules for single models. A rule changes only its own model: step 3 does not take
///    account of the roles that rules give.
pub(super) fn proposed_rows(models: &[FoundModel], rules: &Rules) -> Vec<Row> {
    // Step 1.
    let mut rows: Vec<Row> = models
        .iter()
        .map(|model| proposed_row(model, models, rules))
        .collect();
    // Step 2.
    if rows.iter().all(|row| row.condition.is_none()) {
        number_conditions(models, &mut rows);
    }
    // Step 3.
    propose_nominal(&mut rows);
    // Step 4.
    for (model, row) in models.iter().zip(&mut rows) {
        if let Some(rule) = rules.rows.get(&model.key()) {
            rule.apply(row);
        }
    }
    rows
}

/// Proposes a row from a file's contents and from its name, folders and variable.
///
/// 1. Condition, airspeed, altitude, mass, trim offsets and moved parameter: from the contents, or
///    else from the name. Altitude and weight class: from the name. Method: from the name, or else
///    from the contents.
/// 2. Role: as the file states it, or else the name, or else as the model implies; a run with the
///    nominal role becomes perturbed.
/// 3. Model name: from the file, folder or variable name, or else `default_name`.
fn proposed_row(model: &FoundModel, models: &[FoundModel], rules: &Rules) -> Row {
    // Step 1, with the role that the file or its name states, and the model name in its name.
    let facts = &model.facts;
    let offsets = trim_offsets(&model.draft.origin);
    let path = path_without_extension(model.file());
    let name = if model.variable().is_empty() {
        path.clone()
    } else {
        format!("{path}#{}", model.variable())
    };
    let from_name = read_name(&name, &rules.patterns);
    let contradictions = name_contradictions(model, models, &from_name);
    let mut row = Row {
        left_out: false,
        condition: facts.condition.or(from_name.condition),
        role: file_role(model).or(from_name.role),
        name: from_name.name,
        airspeed_kt: facts.airspeed_kt.or(from_name.airspeed_kt),
        altitude: from_name.altitude,
        altitude_ft: facts.altitude_ft.or(from_name.altitude_ft),
        weight: from_name.weight,
        mass_kg: facts.mass_kg.or(from_name.mass_kg),
        method: from_name.method,
        perturbation: offsets.clone(),
        parameter: match &model.draft.moved {
            Some(MovedParameters::Run(change)) => Some(change.clone()),
            // `parameter` is the single parameter moved in a run.
            Some(MovedParameters::Rerun(_)) => None,
            None => from_name.parameter,
        },
        unread: Vec::new(),
        contradictions,
    };
    for (coordinate, offset) in from_name.perturbation {
        row.perturbation.entry(coordinate).or_insert(offset);
    }
    // `unread_offsets`: only look for misspelled offsets in names that contain a trim offset; in
    // others, a hyphen and a number ("rev-3") mean something else.
    if offsets.is_empty() && !row.perturbation.is_empty() {
        let last_part = name.rsplit('/').next().unwrap_or(&name);
        row.unread = unread_offsets(last_part, &rules.patterns);
    }
    if let Origin::Identified { method, .. } = &model.draft.origin
        && row.method.is_none()
    {
        row.method.clone_from(method);
    }
    // Step 2.
    if row.role.is_none() {
        row.role = implied_role(model, &row);
    }
    // A run does not belong to the bundle, even at the nominal trim.
    if row.parameter.is_some() && row.role == Some(RowRole::Nominal) {
        row.role = Some(RowRole::Perturbed);
    }
    // Step 3.
    if row.name.is_empty() {
        row.name = default_name(model, models, rules, &path);
    }
    row
}

/// Returns a physics model's role as stated in its file; `None` if the file does not state it. The
/// origin "perturbed" is also the default, and counts only in this program's own files.
fn file_role(model: &FoundModel) -> Option<RowRole> {
    match &model.draft.origin {
        Origin::Nominal { .. } => Some(RowRole::Nominal),
        Origin::Perturbed { .. } if model.facts.is_of_dataset => Some(RowRole::Perturbed),
        Origin::Identified { .. } | Origin::Perturbed { .. } => None,
    }
}

/// Returns the role implied by the model: measured data is identified, a trim offset or a moved
/// parameter makes a perturbed model; otherwise `None`.
fn implied_role(model: &FoundModel, row: &Row) -> Option<RowRole> {
    let is_identified = matches!(model.draft.origin, Origin::Identified { .. });
    if is_identified || model.response().is_some() {
        return Some(RowRole::Identified);
    }
    let is_moved = row.parameter.is_some() || model.draft.moved.is_some();
    if is_moved || row.perturbation.values().any(|offset| *offset != 0.0) {
        return Some(RowRole::Perturbed);
    }
    None
}

/// Returns a model's default name: "measured" for a measured response that lacks some of the
/// dataset's responses, so that those of a condition join to one model; otherwise the name in the
/// file, the variable if the file has several models, or the file name.
fn default_name(model: &FoundModel, models: &[FoundModel], rules: &Rules, path: &str) -> String {
    let is_part =
        model.inputs.len() * model.outputs.len() < rules.inputs.len() * rules.outputs.len();
    if model.response().is_some() && is_part {
        return "measured".to_owned();
    }
    if let Some(name) = &model.facts.name {
        return name.clone();
    }
    let in_file = models
        .iter()
        .filter(|other| other.file() == model.file())
        .count();
    if in_file > 1 && !model.variable().is_empty() {
        return model.variable().to_owned();
    }
    let stem = path.rsplit('/').next().unwrap_or(path);
    if stem.is_empty() {
        model.draft.name.clone()
    } else {
        stem.to_owned()
    }
}

/// Proposes the nominal role in each condition without a nominal model, if exactly one model there
/// has no role yet.
fn propose_nominal(rows: &mut [Row]) {
    let conditions: BTreeSet<i64> = rows.iter().filter_map(|row| row.condition).collect();
    for condition in conditions {
        let mut has_nominal = false;
        let mut without_role = Vec::new();
        for (index, row) in rows.iter().enumerate() {
            if row.condition == Some(condition) {
                match row.role {
                    Some(RowRole::Nominal) => has_nominal = true,
                    Some(RowRole::Perturbed | RowRole::Identified) => {}
                    None => without_role.push(index),
                }
            }
        }
        if let [only] = without_role.as_slice()
            && !has_nominal
        {
            rows[*only].role = Some(RowRole::Nominal);
        }
    }
}
