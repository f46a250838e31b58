//! The models of a dataset of this program, to be put together with others.

use std::path::Path;

use gdcm_core::assembly::{ChannelLabel, Facts, FoundModel};
use gdcm_core::dataset::{
    BandsDraft, BundleKind, Channel, Condition, ConditionRecord, Dataset, Dynamics, Model, ModelBands, ModelDraft,
    PairTable, Provenance, ResponseArray, ResponseDraft, Timing,
};

/// Every model, with what the dataset says about it and its condition; `name` is the name of the dataset's file, relative to what was
/// asked for.
pub(super) fn models_of(dataset: &Dataset, name: &str) -> Vec<FoundModel> {
    let mut models = Vec::new();
    for condition in dataset.conditions() {
        let facts = facts(condition, name);
        for kind in BundleKind::BOTH {
            let found = |model: &Model| found(dataset, facts.clone(), (condition, kind), model);
            models.extend(condition.bundle(kind).iter().map(found));
        }
    }
    models
}

/// What is said of the condition; its records' files are relative to the dataset's folder, and become relative to what was asked for.
fn facts(condition: &Condition, name: &str) -> Facts {
    let state = condition.flight_state();
    let beside = |record: &ConditionRecord| {
        let file = match name.rsplit_once('/') {
            Some((folder, _)) if !Path::new(&record.file).is_absolute() => format!("{folder}/{}", record.file),
            _ => record.file.clone(),
        };
        ConditionRecord { file, ..record.clone() }
    };
    Facts {
        condition: Some(state.id.0),
        airspeed_kt: Some(state.airspeed_kt),
        altitude_ft: state.altitude_ft,
        mass_kg: state.mass_kg,
        records: condition.records().iter().map(beside).collect(),
    }
}

fn found(dataset: &Dataset, facts: Facts, (condition, kind): (&Condition, BundleKind), model: &Model) -> FoundModel {
    let state = condition.flight_state();
    let label = |channel: &Channel| ChannelLabel { name: Some(channel.name.clone()), unit: Some(channel.unit.clone()) };
    let (matrices, timing, response) = match &model.dynamics {
        Dynamics::StateSpace(system) => {
            let matrices = [system.a(), system.b(), system.c(), system.d()].map(|matrix| Some(matrix.clone()));
            (matrices, system.timing().clone(), None)
        }
        Dynamics::Measured(response) => {
            let array = |table: PairTable<Vec<f64>>| {
                let shape = [table.outputs(), table.inputs(), response.omega().len()];
                ResponseArray { shape, values: table.pairs().flat_map(|pair| table[pair].clone()).collect() }
            };
            let draft = ResponseDraft {
                omega: response.omega().to_vec(),
                re: array(response.values().map(|_, values| values.iter().map(|value| value.re).collect())),
                im: array(response.values().map(|_, values| values.iter().map(|value| value.im).collect())),
                coherence: response.coherence().cloned().map(array),
                valid_bands: None,
                estimate: response.estimate(),
            };
            ([None, None, None, None], Timing::default(), Some(draft))
        }
    };
    FoundModel {
        draft: ModelDraft {
            name: model.name.clone(),
            origin: model.origin.clone(),
            matrices,
            timing,
            response,
            source: Some(Provenance {
                variable: Some(format!("{}/{kind}/{}", state.id, model.name)),
                records: model.source.as_ref().map(|source| source.records.clone()).unwrap_or_default(),
                ..Provenance::default()
            }),
            states: model.states.to_vec(),
            bands: model.bands.as_deref().map(bands_draft),
        },
        inputs: dataset.inputs().iter().map(label).collect(),
        outputs: dataset.outputs().iter().map(label).collect(),
        facts,
        notes: Vec::new(),
    }
}

fn bands_draft(bands: &ModelBands) -> BandsDraft {
    let array = |table: &PairTable<Vec<f64>>| ResponseArray {
        shape: [table.outputs(), table.inputs(), bands.omega().len()],
        values: table.iter().flat_map(|(_, values)| values.iter().copied()).collect(),
    };
    BandsDraft { omega: bands.omega().to_vec(), sd_db: array(bands.sd_db()), sd_deg: array(bands.sd_deg()) }
}
