//! Corrected models as `gdcm-models`, the form in which the program reads and writes models of any file.

use super::exported_model::ExportedModel;
use gdcm_core::assembly::{ChannelLabel, Facts, FoundModel};
use gdcm_core::dataset::{Channel, Dataset, ModelDraft, Origin};

/// The models under the names "condition 10, nominal"; their notes say what was done to them and how exact it is.
pub(super) fn found_models(models: &[ExportedModel], dataset: &Dataset) -> Vec<FoundModel> {
    let labels = |channels: &[Channel]| -> Vec<ChannelLabel> {
        let label =
            |channel: &Channel| ChannelLabel { name: Some(channel.name.clone()), unit: Some(channel.unit.clone()) };
        channels.iter().map(label).collect()
    };
    let found = |model: &ExportedModel| FoundModel {
        draft: ModelDraft {
            name: format!("condition {}, {}", model.condition, model.name),
            origin: Origin::Perturbed { perturbation: None },
            matrices: [model.model.a(), model.model.b(), model.model.c(), model.model.d()].map(|of| Some(of.clone())),
            timing: model.model.timing().clone(),
            response: None,
            source: None,
            states: model.states.clone(),
            bands: None,
        },
        inputs: labels(dataset.inputs()),
        outputs: labels(dataset.outputs()),
        facts: Facts { condition: Some(model.condition.0), airspeed_kt: Some(model.airspeed_kt), ..Facts::default() },
        notes: vec![model.words()],
    };
    models.iter().map(found).collect()
}
