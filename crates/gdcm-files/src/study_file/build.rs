//! From what a study file says to the decisions it holds, each error with its place.

use std::collections::BTreeMap;
use std::sync::Arc;

use crate::dataset_file::ModelText;
use crate::file_error::ContentError;
use crate::file_error::ContentFault;
use crate::settings_entry::SettingsEntry;
use gdcm_core::dataset::{ConditionId, Dataset, Location};
use gdcm_core::study::{
    AdoptedModels, BundleChoice, ConditionChoice, ConditionInventory, Decisions, Inventory, Settings,
};

use super::schema::{BundleText, ConditionInventoryText, ConditionText, TakenText, VariantText};

/// The decisions of a study file. `start` is what the settings are before any decision; each has to be within its range.
pub(super) fn decisions_of(
    start: &Settings,
    text: SettingsEntry,
    conditions: Vec<ConditionText>,
    variants: Vec<VariantText>,
) -> Result<Decisions, ContentError> {
    let mut decisions = present_decisions(start.clone(), text, conditions)?;
    for VariantText { name, settings, conditions } in variants {
        let of_variant = present_decisions(start.clone(), settings, conditions).map_err(|mut flaw| {
            flaw.place.entry = format!("variant \"{name}\", {}", flaw.place.entry);
            flaw
        })?;
        decisions.variants.push((name, of_variant));
    }
    Ok(decisions)
}

fn present_decisions(
    start: Settings,
    text: SettingsEntry,
    conditions: Vec<ConditionText>,
) -> Result<Decisions, ContentError> {
    let mut settings = start;
    text.take_into(&mut settings)?;
    let mut choices = BTreeMap::new();
    for (index, condition) in conditions.into_iter().enumerate() {
        let id = condition.id;
        let choice = ConditionChoice {
            physics: bundle_choice(condition.physics),
            identified: bundle_choice(condition.identified),
            scheduled: condition.scheduled,
            held_out: condition.held_out,
        };
        if choices.insert(ConditionId(id), choice).is_some() {
            return Err(ContentError::new(Location::condition(index + 1, id), ContentFault::DuplicateCondition { id }));
        }
    }
    Ok(Decisions {
        settings,
        constrained: text.constrained,
        ignored: text.ignored,
        choices,
        taken: Vec::new(),
        variants: Vec::new(),
    })
}

/// The models that a study has taken, for its dataset.
pub(super) fn taken_of(
    text: Vec<TakenText>,
    dataset: &Dataset,
) -> Result<Vec<(ConditionId, Arc<AdoptedModels>)>, ContentError> {
    let of = |(index, text): (usize, TakenText)| {
        let mut place = Location::condition(index + 1, text.condition);
        place.entry = "taken".to_owned();
        let drafts = text.identified_models.into_iter().map(ModelText::into_identified);
        let models = drafts.map(|draft| Ok(dataset.identified_model(draft)?.0)).collect::<Result<_, ContentError>>()?;
        let records = text.records.into_iter().enumerate();
        let records = records.map(|(index, record)| record.into_record(&place, index + 1)).collect::<Result<_, _>>()?;
        Ok((ConditionId(text.condition), Arc::new(AdoptedModels { models, records })))
    };
    text.into_iter().enumerate().map(of).collect()
}

fn bundle_choice(text: BundleText) -> BundleChoice {
    BundleChoice { rejected: text.rejected.into_iter().collect(), reasons: text.reasons, pinned: text.pinned }
}

/// What the study's dataset held when the study was saved.
pub(super) fn inventory_of(conditions: Vec<ConditionInventoryText>) -> Inventory {
    let of = |text: ConditionInventoryText| {
        let ConditionInventoryText { id, airspeed_kt, physics, identified } = text;
        (ConditionId(id), ConditionInventory { airspeed_kt, physics, identified })
    };
    Inventory { conditions: conditions.into_iter().map(of).collect() }
}
