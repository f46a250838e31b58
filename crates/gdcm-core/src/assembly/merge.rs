//! The draft of a dataset, of models that are said to be what.

use std::collections::{BTreeMap, BTreeSet};

use crate::dataset::{
    Channel, ConditionDraft, ConditionId, ConditionRecord, DatasetDraft, FlightState, ModelDraft, Origin, Provenance,
    ResponseArray, ResponseDraft,
};
use crate::units::number;

use super::assembly::Part;
use super::conversion::converted;
use super::row::{Row, RowRole};
use super::rules::{ChannelRule, Rules};

/// The draft that the parts make; those that are left out, or of which condition or role are not said, are not in it.
pub(super) fn merged(rules: &Rules, parts: &[Part]) -> DatasetDraft {
    let mut conditions: BTreeMap<i64, Vec<&Part>> = BTreeMap::new();
    for part in parts.iter().filter(|part| !part.row.left_out) {
        if let Some(condition) = part.row.condition {
            conditions.entry(condition).or_default().push(part);
        }
    }
    let channel = |rule: &ChannelRule| Channel::new(rule.name.clone(), rule.unit.clone());
    DatasetDraft {
        name: rules.name.clone(),
        description: rules.description.clone(),
        inputs: rules.inputs.iter().map(channel).collect(),
        outputs: rules.outputs.iter().map(channel).collect(),
        on_axis: rules.on_axis.clone(),
        band: rules.band,
        conditions: conditions.iter().map(|(id, parts)| condition_of(*id, parts)).collect(),
    }
}

fn condition_of(id: i64, parts: &[&Part]) -> ConditionDraft {
    fn said<T: Clone>(parts: &[&Part], of: impl Fn(&Row) -> &Option<T>) -> Option<T> {
        parts.iter().find_map(|part| of(&part.row).clone())
    }
    let mut state = FlightState {
        id: ConditionId(id),
        name: String::new(),
        airspeed_kt: said(parts, |row| &row.airspeed_kt).unwrap_or(f64::NAN),
        altitude: said(parts, |row| &row.altitude),
        altitude_ft: said(parts, |row| &row.altitude_ft),
        weight: said(parts, |row| &row.weight),
        mass_kg: said(parts, |row| &row.mass_kg),
    };
    state.name = condition_name(&state);
    let of_role = |wanted: &[RowRole]| -> Vec<&Part> {
        let is_wanted = |part: &&&Part| part.row.role.is_some_and(|role| wanted.contains(&role));
        parts.iter().filter(is_wanted).copied().collect()
    };
    let mut physics = of_role(&[RowRole::Nominal, RowRole::Perturbed]);
    // The nominal model first, as a dataset is read.
    physics.sort_by_key(|part| part.row.role);
    let coordinates: BTreeSet<&String> = physics.iter().flat_map(|part| part.row.perturbation.keys()).collect();
    ConditionDraft {
        flight_state: state,
        physics: physics.iter().map(|part| physics_model(part, &coordinates)).collect(),
        identified: identified_models(&of_role(&[RowRole::Identified])),
        records: records_of(parts),
    }
}

/// The flight records that the files of the models name, once each, as the file says it that says which pieces are used; of different
/// ones of one name the later gets a number.
fn records_of(parts: &[&Part]) -> Vec<ConditionRecord> {
    let mut records: Vec<ConditionRecord> = Vec::new();
    let mut known: Vec<(&String, &String, &Option<String>)> = Vec::new();
    for record in parts.iter().flat_map(|part| &part.found.facts.records) {
        let key = (&record.name, &record.file, &record.variable);
        if let Some(place) = known.iter().position(|other| *other == key) {
            if records[place].used_s.is_empty() {
                records[place] = ConditionRecord { name: records[place].name.clone(), ..record.clone() };
            }
            continue;
        }
        known.push(key);
        let numbers = std::iter::successors(Some(2_usize), |number| Some(number + 1));
        let names = numbers.map(|number| format!("{} ({number})", record.name));
        let free = |name: &String| records.iter().all(|other| other.name != *name);
        let name = std::iter::once(record.name.clone()).chain(names).find(free);
        records.push(ConditionRecord { name: name.unwrap_or_default(), ..record.clone() });
    }
    records
}

/// "45 kt, high altitude, low weight".
fn condition_name(state: &FlightState) -> String {
    let class = |class: &Option<String>, of: &str| class.as_ref().map(|class| format!("{class} {of}"));
    let figure = |value: Option<f64>, unit: &str| value.map(|value| format!("{} {unit}", number(value)));
    let altitude = class(&state.altitude, "altitude").or_else(|| figure(state.altitude_ft, "ft"));
    let weight = class(&state.weight, "weight").or_else(|| figure(state.mass_kg, "kg"));
    let parts = [figure(Some(state.airspeed_kt), "kt"), altitude, weight];
    parts.into_iter().flatten().collect::<Vec<_>>().join(", ")
}

/// Coordinates that others of the bundle name are at rest in this model.
fn physics_model(part: &Part, coordinates: &BTreeSet<&String>) -> ModelDraft {
    let offset = |coordinate: &&String| {
        let offset = part.row.perturbation.get(*coordinate).copied().unwrap_or(0.0);
        ((*coordinate).clone(), offset)
    };
    let perturbation =
        Some(coordinates.iter().map(offset).collect()).filter(|offsets: &BTreeMap<_, _>| !offsets.is_empty());
    let origin = match part.row.role {
        Some(RowRole::Nominal) => Origin::Nominal { perturbation },
        _ => Origin::Perturbed { perturbation },
    };
    ModelDraft { origin, ..model_of(part) }
}

/// Measured responses of one name are one model.
fn identified_models(parts: &[&Part]) -> Vec<ModelDraft> {
    let mut models: Vec<ModelDraft> = Vec::new();
    for part in parts {
        let model = ModelDraft { origin: identified_origin(part), ..model_of(part) };
        let same = models.iter_mut().find(|other| other.name == model.name && other.response.is_some());
        match (same, &model.response) {
            (Some(earlier), Some(response)) => join(earlier, response, part),
            _ => models.push(model),
        }
    }
    models
}

fn identified_origin(part: &Part) -> Origin {
    let order = match &part.found.draft.origin {
        Origin::Identified { order, .. } => *order,
        Origin::Nominal { .. } | Origin::Perturbed { .. } => None,
    };
    Origin::Identified { method: part.row.method.clone(), order: order.filter(|_| part.found.response().is_some()) }
}

/// Puts the responses that `response` has, and the earlier model has not, into it.
fn join(earlier: &mut ModelDraft, response: &ResponseDraft, part: &Part) {
    let Some(into) = &mut earlier.response else { return };
    let count = into.omega.len();
    for place in 0..into.re.shape[0] * into.re.shape[1] {
        let range = place * count..(place + 1) * count;
        let is_given = |of: &ResponseDraft| range.clone().any(|at| of.re.values[at] != 0.0 || of.im.values[at] != 0.0);
        if !is_given(response) || is_given(into) {
            continue;
        }
        into.re.values[range.clone()].copy_from_slice(&response.re.values[range.clone()]);
        into.im.values[range.clone()].copy_from_slice(&response.im.values[range.clone()]);
        join_coherence(into, response, range);
    }
    if let Some(source) = &mut earlier.source {
        let note = source.note.take().map(|note| format!("{note}; ")).unwrap_or_default();
        source.note = Some(format!("{note}with {}", part.found.key()));
    }
}

/// A part without coherence is trusted as it is where others have one.
fn join_coherence(into: &mut ResponseDraft, response: &ResponseDraft, range: std::ops::Range<usize>) {
    let shape = into.re.shape;
    if into.coherence.is_none() && response.coherence.is_none() {
        return;
    }
    let full = || ResponseArray { shape, values: vec![1.0; shape.iter().product()] };
    let coherence = into.coherence.get_or_insert_with(full);
    match &response.coherence {
        Some(of) => coherence.values[range.clone()].copy_from_slice(&of.values[range]),
        None => coherence.values[range].fill(1.0),
    }
}

/// The model in the dataset's channels and units, and what was done to it.
fn model_of(part: &Part) -> ModelDraft {
    let mut model = converted(&part.found.draft, &part.inputs.uses, &part.outputs.uses);
    model.name.clone_from(&part.row.name);
    let uses = part.inputs.uses.iter().chain(&part.outputs.uses).flatten();
    let conversions = uses.filter_map(|used| used.words.clone());
    let notes = part.inputs.notes.iter().chain(&part.outputs.notes).cloned();
    let said = model.source.as_ref().and_then(|source| source.note.clone());
    let words: Vec<String> = said.into_iter().chain(notes).chain(conversions).collect();
    if !words.is_empty() {
        let source = model.source.get_or_insert_with(Provenance::default);
        source.note = Some(words.join("; "));
    }
    model
}
