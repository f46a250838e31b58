//! Assembles a dataset draft from the models with a condition and a role. The draft's models are
//! built in `assembled_models.rs`, its flight records in `assembled_records.rs`.
//!
//! A [`Part`] is a model found in a file, with its row (condition, role, trim) and its matched
//! channels; [`Rules`] are the engineer's entries.

use std::collections::BTreeSet;

use super::assembled_models::{identified_models, physics_model};
use super::assembled_records::flight_records;
use super::indexed_part::parts_by_condition;
use super::part::Part;
use super::rules::Rules;
use crate::dataset::condition::FlightState;
use crate::dataset::dataset_draft::{ConditionDraft, DatasetDraft};
use crate::dataset::{Channel, ConditionId};
use crate::names::{ChannelRule, RowRole};
use crate::number_format::number;

/// Builds a dataset draft. Models that are left out, or that have no condition or role, are
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
        parameters: rules.parameters.clone(),
        conditions,
    }
}

fn dataset_channels(rules: &[ChannelRule]) -> Vec<Channel> {
    rules
        .iter()
        .map(|rule| Channel::new(rule.name.clone(), rule.unit.clone()))
        .collect()
}

/// Builds a condition's draft from its models.
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

/// Returns a condition's flight state; each value is taken from the first model that gives it. The
/// airspeed is NaN if none does.
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

/// Returns a condition's name: "45 kt, high altitude, low weight", "60 kt, 2000 ft, 6600 kg".
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
