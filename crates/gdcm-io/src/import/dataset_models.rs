//! Models of a dataset file that is read as one of several model files.
//!
//! A *bundle* is a condition's physics or identified models. Physics models with *moved*
//! parameters, from which the effects of the parameters are determined (M18), are beside the
//! bundles. A [`FoundModel`] is a model outside a dataset, with the [`Facts`] that its file states.

use std::path::Path;

use gdcm_model::assembly::FoundModel;
use gdcm_model::assembly::found_model::Facts;
use gdcm_model::dataset::condition::ConditionRecord;
use gdcm_model::dataset::dataset_draft::ModelDraft;
use gdcm_model::dataset::model::Provenance;
use gdcm_model::dataset::{BundleKind, Condition, Dataset};

use crate::files::model_collection::labels;

/// Returns every model in a dataset with its provenance and flight condition, including those with
/// moved parameters. `name` is the dataset file's path, relative to the folder that is read.
pub(super) fn models_of_dataset(dataset: &Dataset, name: &str) -> Vec<FoundModel> {
    let mut models = Vec::new();
    for condition in dataset.conditions() {
        let facts = facts_of(condition, name);
        let id = condition.flight_state().id;
        for kind in BundleKind::BOTH {
            let mut drafts: Vec<ModelDraft> = condition
                .bundle(kind)
                .iter()
                .map(ModelDraft::from_model)
                .collect();
            if kind == BundleKind::Physics {
                drafts.extend(condition.moved_models().iter().map(ModelDraft::from_moved));
            }
            for draft in drafts {
                let original = draft.source.clone().unwrap_or_default();
                let notes = original.note.clone().into_iter().collect();
                // The reader of model files adds the dataset file, its hash and the notes.
                let source = Provenance {
                    variable: Some(format!("{id}/{kind}/{}", draft.name)),
                    note: None,
                    file: None,
                    sha256: None,
                    ..original
                };
                models.push(FoundModel {
                    draft: ModelDraft {
                        source: Some(source),
                        ..draft
                    },
                    inputs: labels(dataset.inputs()),
                    outputs: labels(dataset.outputs()),
                    facts: facts.clone(),
                    notes,
                });
            }
        }
    }
    models
}

/// Returns the flight condition with its records. The record paths, which are relative to the
/// dataset's folder, become relative to the folder that is read.
fn facts_of(condition: &Condition, name: &str) -> Facts {
    let state = condition.flight_state();
    let mut records = Vec::new();
    for record in condition.records() {
        let file = match name.rsplit_once('/') {
            Some((folder, _)) if !Path::new(&record.file).is_absolute() => {
                format!("{folder}/{}", record.file)
            }
            _ => record.file.clone(),
        };
        records.push(ConditionRecord {
            file,
            ..record.clone()
        });
    }
    Facts {
        condition: Some(state.id.0),
        airspeed_kt: Some(state.airspeed_kt),
        altitude_ft: state.altitude_ft,
        mass_kg: state.mass_kg,
        name: None,
        is_of_dataset: true,
        records,
    }
}
