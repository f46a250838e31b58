//! Draft of the dataset: models with a condition and a role, converted to the dataset's channels
//! and units.

use std::collections::{BTreeMap, BTreeSet};

use super::channel_conversion::{ChannelUses, convert_model};
use super::measured_parts::{join_part, note_unmeasured};
use super::part::Part;
use super::problem_search::parts_by_condition;
use super::rules::Rules;
use crate::dataset::condition::{ConditionRecord, FlightState};
use crate::dataset::dataset_draft::{ConditionDraft, DatasetDraft, ModelDraft};
use crate::dataset::model::{Origin, Provenance};
use crate::dataset::{Channel, ConditionId};
use crate::names::{ChannelRule, RowRole};
use crate::number_format::number;

/// Builds the draft of a dataset. Models that are left out, or that have no condition or role, are
/// skipped.
pub(super) fn dataset_draft(rules: &Rules, parts: &[Part]) -> DatasetDraft {
    let mut conditions = Vec::new();
    for (id, indexed) in parts_by_condition(parts) {
        let parts: Vec<&Part> = indexed.iter().map(|indexed| indexed.part).collect();
        conditions.push(condition_draft(id, &parts, rules));
    }
    DatasetDraft {
        name: rules.name.clone(),
        description: rules.description.clone(),
        inputs: dataset_channels(&rules.inputs),
        outputs: dataset_channels(&rules.outputs),
        on_axis: rules.on_axis.clone(),
        band: rules.band,
        conditions,
    }
}

fn dataset_channels(rules: &[ChannelRule]) -> Vec<Channel> {
    rules
        .iter()
        .map(|rule| Channel::new(rule.name.clone(), rule.unit.clone()))
        .collect()
}

fn condition_draft(id: i64, parts: &[&Part], rules: &Rules) -> ConditionDraft {
    let mut physics = Vec::new();
    let mut identified = Vec::new();
    for part in parts {
        match part.row.role {
            Some(RowRole::Nominal | RowRole::Perturbed) => physics.push(*part),
            Some(RowRole::Identified) => identified.push(*part),
            None => {}
        }
    }
    // The nominal model comes first, as in a dataset file.
    physics.sort_by_key(|part| part.row.role);
    let coordinates: BTreeSet<&String> = physics
        .iter()
        .flat_map(|part| part.row.perturbation.keys())
        .collect();
    ConditionDraft {
        flight_state: flight_state(id, parts),
        physics: physics
            .iter()
            .map(|part| physics_model(part, &coordinates))
            .collect(),
        identified: identified_models(&identified, rules),
        records: flight_records(parts),
    }
}

/// Returns the flight state of a condition; each value is taken from the first model that gives it.
fn flight_state(id: i64, parts: &[&Part]) -> FlightState {
    let mut rows = parts.iter().map(|part| &part.row);
    let airspeed_kt = rows.clone().find_map(|row| row.airspeed_kt);
    let mut state = FlightState {
        id: ConditionId(id),
        name: String::new(),
        airspeed_kt: airspeed_kt.unwrap_or(f64::NAN),
        altitude: rows.clone().find_map(|row| row.altitude.clone()),
        altitude_ft: rows.clone().find_map(|row| row.altitude_ft),
        weight: rows.clone().find_map(|row| row.weight.clone()),
        mass_kg: rows.find_map(|row| row.mass_kg),
    };
    state.name = condition_name(&state);
    state
}

/// Returns the name of a condition: "45 kt, high altitude, low weight", "60 kt, 2000 ft, 6600 kg".
fn condition_name(state: &FlightState) -> String {
    let mut name = format!("{} kt", number(state.airspeed_kt));
    if let Some(altitude) = &state.altitude {
        name.push_str(&format!(", {altitude} altitude"));
    } else if let Some(altitude_ft) = state.altitude_ft {
        name.push_str(&format!(", {} ft", number(altitude_ft)));
    }
    if let Some(weight) = &state.weight {
        name.push_str(&format!(", {weight} weight"));
    } else if let Some(mass_kg) = state.mass_kg {
        name.push_str(&format!(", {} kg", number(mass_kg)));
    }
    name
}

/// Returns the distinct flight records listed in the models' files.
///
/// If several files list the same record, the first entry that gives the used pieces is kept. A
/// different record whose name is already taken is numbered: "name (2)".
fn flight_records(parts: &[&Part]) -> Vec<ConditionRecord> {
    let mut records: Vec<ConditionRecord> = Vec::new();
    let mut known: Vec<&ConditionRecord> = Vec::new();
    for record in parts.iter().flat_map(|part| &part.found.facts.records) {
        let place = known.iter().position(|other| is_same_record(other, record));
        if let Some(place) = place {
            if records[place].used_s.is_empty() {
                records[place] = ConditionRecord {
                    name: records[place].name.clone(),
                    ..record.clone()
                };
            }
            continue;
        }
        known.push(record);
        records.push(ConditionRecord {
            name: unused_name(&record.name, &records),
            ..record.clone()
        });
    }
    records
}

fn is_same_record(a: &ConditionRecord, b: &ConditionRecord) -> bool {
    a.name == b.name && a.file == b.file && a.variable == b.variable
}

/// Returns the name, or "name (2)", "name (3)" ... if a record already has it.
fn unused_name(name: &str, records: &[ConditionRecord]) -> String {
    let mut unused = name.to_owned();
    let mut number = 1;
    while records.iter().any(|record| record.name == unused) {
        number += 1;
        unused = format!("{name} ({number})");
    }
    unused
}

/// Builds a physics model. Coordinates that are perturbed only in other models of the bundle get a
/// zero offset.
fn physics_model(part: &Part, coordinates: &BTreeSet<&String>) -> ModelDraft {
    let mut offsets = BTreeMap::new();
    for coordinate in coordinates {
        let offset = part.row.perturbation.get(*coordinate).copied();
        offsets.insert((*coordinate).clone(), offset.unwrap_or(0.0));
    }
    let perturbation = if offsets.is_empty() {
        None
    } else {
        Some(offsets)
    };
    let origin = match part.row.role {
        Some(RowRole::Nominal) => Origin::Nominal { perturbation },
        _ => Origin::Perturbed { perturbation },
    };
    ModelDraft {
        origin,
        ..converted_model(part)
    }
}

/// Builds the identified models; measured responses with the same name form a single model.
fn identified_models(parts: &[&Part], rules: &Rules) -> Vec<ModelDraft> {
    let mut models: Vec<ModelDraft> = Vec::new();
    for part in parts {
        let model = ModelDraft {
            origin: identified_origin(part),
            ..converted_model(part)
        };
        let same = models
            .iter_mut()
            .find(|other| other.name == model.name && other.response.is_some());
        match (same, &model.response) {
            (Some(earlier), Some(response)) => join_part(earlier, response, part),
            _ => models.push(model),
        }
    }
    for model in &mut models {
        note_unmeasured(model, rules);
    }
    models
}

/// Returns the origin of an identified model. Only a measured response keeps a stated order: the
/// order of a model with matrices is its state count.
fn identified_origin(part: &Part) -> Origin {
    let order = match &part.found.draft.origin {
        Origin::Identified { order, .. } if part.found.response().is_some() => *order,
        _ => None,
    };
    Origin::Identified {
        method: part.row.method.clone(),
        order,
    }
}

/// Converts a model to the dataset's channels and units, and notes the conversions in its
/// provenance.
fn converted_model(part: &Part) -> ModelDraft {
    let uses = ChannelUses {
        inputs: &part.inputs.uses,
        outputs: &part.outputs.uses,
    };
    let mut model = convert_model(&part.found.draft, uses);
    model.name.clone_from(&part.row.name);
    if let Some(sample_time_s) = part.sample_time_s
        && sample_time_s > 0.0
    {
        model.timing.sample_time_s = Some(sample_time_s);
    }
    let notes = conversion_notes(part);
    if !notes.is_empty() {
        let source = model.source.get_or_insert_with(Provenance::default);
        source.note = Some(notes.join("; "));
    }
    let by_position = part.sides_by_position();
    if !by_position.is_empty() {
        let source = model.source.get_or_insert_with(Provenance::default);
        source.by_position = by_position;
    }
    model
}

/// Returns the existing note of the model's provenance, then the notes on its channels, sample time
/// and unit conversions.
fn conversion_notes(part: &Part) -> Vec<String> {
    let mut notes = Vec::new();
    if let Some(source) = &part.found.draft.source {
        notes.extend(source.note.clone());
    }
    notes.extend_from_slice(&part.inputs.notes);
    notes.extend_from_slice(&part.outputs.notes);
    if let Some(sample_time_s) = part.sample_time_s {
        notes.push(format!(
            "sample time {} s, as declared",
            number(sample_time_s)
        ));
    }
    for used in part.inputs.uses.iter().chain(&part.outputs.uses).flatten() {
        notes.extend(used.words.clone());
    }
    notes
}
