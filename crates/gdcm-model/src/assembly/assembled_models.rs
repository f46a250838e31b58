//! Models in the dataset draft, converted to the dataset's channels and units, with notes on the
//! conversions.
//!
//! A [`Part`] is a model found in a file (`found`), with its place in the dataset (`row`:
//! condition, role, name, trim offsets, from the file, its name and the engineer's [`Rules`]) and
//! with its `inputs` and `outputs` matched to the dataset's. The role decides what is built from
//! it:
//!
//! ```text
//! nominal, perturbed  physics model, linearised at the condition's trim or at another trim
//! identified          identified model; measured responses with the same name are joined
//!
//! perturbation        offsets of the trim from the condition's, by coordinate
//! moved               named physics parameters changed (M18.1, docs/physics.md): a run changes a
//!                     single one, to learn its effect; a rerun changes several, to check them
//! ```

use std::collections::{BTreeMap, BTreeSet};

use super::channel_conversion::{ChannelUses, convert_model};
use super::measured_parts::{join_part, note_unmeasured};
use super::part::Part;
use super::rules::Rules;
use crate::dataset::dataset_draft::ModelDraft;
use crate::dataset::model::{Origin, Provenance};
use crate::dataset::physics_parameter::MovedParameters;
use crate::names::RowRole;
use crate::number_format::number;

/// Builds a physics model, also one with moved parameters. `coordinates` are those in which the
/// trim of any of the condition's physics models is perturbed; where this model states no offset,
/// it is 0.
pub(super) fn physics_model(part: &Part, coordinates: &BTreeSet<&String>) -> ModelDraft {
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
    let model = converted_model(part);
    let moved = match &part.row.parameter {
        Some(change) => Some(MovedParameters::Run(change.clone())),
        None => model.moved.clone(),
    };
    // A model with moved parameters belongs to no bundle: even at the condition's trim, and
    // declared nominal, it does not become the nominal model.
    let origin = match part.row.role {
        Some(RowRole::Nominal) if moved.is_none() => Origin::Nominal { perturbation },
        _ => Origin::Perturbed { perturbation },
    };
    ModelDraft {
        origin,
        moved,
        ..model
    }
}

/// Builds the identified models; measured responses with the same name form a single model.
pub(super) fn identified_models(parts: &[&Part], rules: &Rules) -> Vec<ModelDraft> {
    let mut models: Vec<ModelDraft> = Vec::new();
    for part in parts {
        let model = ModelDraft {
            origin: identified_origin(part),
            moved: None,
            ..converted_model(part)
        };
        // A measured response joins the earlier one with the same name; matrices never join.
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

/// Returns an identified model's origin. Only a measured response keeps a stated order: with
/// matrices, the order is the state count.
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
    // A declared sample time of 0 means continuous time: it is noted, but the model has none.
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
    // Inputs or outputs without names, which were matched in the file's order.
    let by_position = part.sides_by_position();
    if !by_position.is_empty() {
        let source = model.source.get_or_insert_with(Provenance::default);
        source.by_position = by_position;
    }
    model
}

/// Returns the existing note from the model's provenance, then the notes on its channels, the
/// sample time declared in the rules, and the conversions of units and signs.
fn conversion_notes(part: &Part) -> Vec<String> {
    let mut notes = Vec::new();
    if let Some(source) = &part.found.draft.source {
        notes.extend(source.note.clone());
    }
    for note in part.inputs.notes.iter().chain(&part.outputs.notes) {
        notes.push(note.to_string());
    }
    if let Some(sample_time_s) = part.sample_time_s {
        notes.push(if sample_time_s > 0.0 {
            format!("sample time {} s, as declared", number(sample_time_s))
        } else {
            "continuous time, as declared".to_owned()
        });
    }
    for used in part.inputs.uses.iter().chain(&part.outputs.uses).flatten() {
        notes.extend(used.words.clone());
    }
    notes
}
