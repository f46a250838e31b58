//! From a study to what its file says.

use std::sync::Arc;

use crate::dataset_file::{ModelText, RecordText};
use crate::settings_entry::SettingsEntry;
use gdcm_core::dataset::{BundleKind, Condition, ConditionId, Model};
use gdcm_core::study::{AdoptedModels, BundleChoice, ConditionInventory, Inventory, Study};

use super::schema::{
    BundleText, ConditionInventoryText, ConditionText, DatasetReference, FORMAT, StudyText, TakenText, VariantText,
};

/// The text of a study of the referenced dataset.
pub(super) fn text_of(study: &Study, dataset: DatasetReference) -> StudyText {
    let variants = study.variants.iter().filter_map(|variant| {
        let of_variant = study.of_variant(&variant.name)?;
        let settings = SettingsEntry::of(&variant.settings, &study.dataset);
        Some(VariantText { name: variant.name.clone(), settings, conditions: condition_texts(&of_variant) })
    });
    StudyText {
        format: FORMAT.name.to_owned(),
        version: FORMAT.version,
        software: concat!("gdcm ", env!("CARGO_PKG_VERSION")).to_owned(),
        dataset,
        settings: SettingsEntry::of(&study.settings, &study.dataset),
        conditions: condition_texts(study),
        taken: study.taken_models().map(|(id, taken)| taken_text(id, taken)).collect(),
        variants: variants.collect(),
    }
}

fn taken_text(condition: ConditionId, taken: &AdoptedModels) -> TakenText {
    TakenText {
        condition: condition.0,
        identified_models: taken.models.iter().map(ModelText::of_model).collect(),
        records: taken.records.iter().map(RecordText::of).collect(),
    }
}

/// The choices in each condition.
fn condition_texts(study: &Study) -> Vec<ConditionText> {
    let text = |condition: &Arc<Condition>| {
        let choice = study.choice(condition.id());
        ConditionText {
            id: condition.id().0,
            physics: bundle_text(condition.bundle(BundleKind::Physics), &choice.physics),
            identified: bundle_text(condition.bundle(BundleKind::Identified), &choice.identified),
            scheduled: choice.scheduled,
            held_out: choice.held_out,
        }
    };
    study.dataset.conditions().iter().map(text).collect()
}

/// What a dataset holds, as a study's file says it.
pub(super) fn inventory_text(inventory: &Inventory) -> Vec<ConditionInventoryText> {
    let of = |(id, condition): (&ConditionId, &ConditionInventory)| ConditionInventoryText {
        id: id.0,
        airspeed_kt: condition.airspeed_kt,
        physics: condition.physics.clone(),
        identified: condition.identified.clone(),
    };
    inventory.conditions.iter().map(of).collect()
}

fn bundle_text(models: &[Model], choice: &BundleChoice) -> BundleText {
    let names = models.iter().map(|model| &model.name).filter(|name| choice.rejected.contains(*name));
    BundleText { rejected: names.cloned().collect(), reasons: choice.reasons.clone(), pinned: choice.pinned.clone() }
}
