//! Conversion between study files and decisions: a study becomes text, and text becomes decisions
//! that are checked against the dataset.
//!
//! *Decisions* are the settings, and for each condition the rejected models, the representatives,
//! and whether it is scheduled or held out. A *variant* is a named alternative to them; *adopted*
//! (in some names, *taken*) models are identified models that replace the dataset's in a condition.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use gdcm_model::dataset::location::Location;
use gdcm_model::dataset::{Condition, ConditionId, Dataset};
use gdcm_study::Study;
use gdcm_study::decisions::adopted_models::AdoptedModels;
use gdcm_study::decisions::choices::ConditionChoice;
use gdcm_study::decisions::export_choices::ExportChoices;
use gdcm_study::decisions::named_decisions::Decisions;
use gdcm_study::decisions::settings::{ResponseNames, Settings};

use super::json_form::{
    AdoptedText, ConditionText, DatasetReference, ExportText, FORMAT, StudyText, VariantText,
};
use crate::content_fault::{ContentError, ContentFault};
use crate::files::dataset_file::{ModelText, RecordText};
use crate::software::software;

impl StudyText {
    pub(super) fn new(study: &Study, dataset: DatasetReference) -> Self {
        let mut variants = Vec::new();
        for variant in &study.variants {
            if let Some(variant_study) = study.of_variant(&variant.name) {
                variants.push(VariantText {
                    name: variant.name.clone(),
                    settings: variant.settings.named(&study.dataset),
                    conditions: ConditionText::from_study(&variant_study),
                });
            }
        }
        let mut adopted = Vec::new();
        for (condition, in_condition) in study.adopted_models() {
            adopted.push(AdoptedText {
                condition: condition.0,
                identified_models: in_condition
                    .models
                    .iter()
                    .map(ModelText::of_model)
                    .collect(),
                records: in_condition
                    .records
                    .iter()
                    .map(RecordText::from_record)
                    .collect(),
            });
        }
        Self {
            format: FORMAT.name.to_owned(),
            version: FORMAT.version,
            software: software(),
            dataset,
            settings: study.settings.named(&study.dataset),
            conditions: ConditionText::from_study(study),
            adopted,
            signs: study.reversed_channels(),
            requirements: study.requirements.as_ref().clone(),
            export: ExportText::from_choices(&study.exports),
            variants,
        }
    }
}

impl ExportText {
    /// Returns the choices made for the last export; `None` for the defaults.
    fn from_choices(choices: &ExportChoices) -> Option<Self> {
        if *choices == ExportChoices::default() {
            return None;
        }
        let conditions = choices.conditions.iter().flatten();
        Some(Self {
            formats: choices.formats.iter().cloned().collect(),
            conditions: conditions.copied().collect(),
            per_condition: choices.per_condition,
            model: choices.model.clone(),
            breakpoints_kt: choices.breakpoints_kt.clone().unwrap_or_default(),
            pade_order: choices.pade_order as u64,
            folder: choices.folder.clone(),
            prefix: choices.prefix.clone(),
            replaces: choices.replaces,
        })
    }

    fn into_choices(self) -> ExportChoices {
        let conditions: BTreeSet<ConditionId> = self.conditions.into_iter().collect();
        ExportChoices {
            formats: self.formats.into_iter().collect(),
            conditions: if conditions.is_empty() {
                None
            } else {
                Some(conditions)
            },
            per_condition: self.per_condition,
            model: self.model,
            breakpoints_kt: if self.breakpoints_kt.is_empty() {
                None
            } else {
                Some(self.breakpoints_kt)
            },
            // The export reports an order that is out of range.
            pade_order: self.pade_order.try_into().unwrap_or(usize::MAX),
            folder: self.folder,
            prefix: self.prefix,
            replaces: self.replaces,
        }
    }
}

impl ConditionText {
    fn from_condition(condition: &Condition, study: &Study) -> Self {
        let ConditionChoice {
            physics,
            identified,
            scheduled,
            held_out,
        } = study.choice(condition.id()).clone();
        Self {
            id: condition.id().0,
            physics,
            identified,
            scheduled,
            held_out,
        }
    }

    /// Returns the decisions about all conditions.
    fn from_study(study: &Study) -> Vec<Self> {
        let conditions = study.dataset.conditions().iter();
        conditions
            .map(|condition| Self::from_condition(condition, study))
            .collect()
    }
}

/// Converts a study file's content to decisions, checked against the dataset.
pub(super) fn decisions_of(text: StudyText, dataset: &Dataset) -> Result<Decisions, ContentError> {
    let mut decisions = settings_and_choices(text.settings, text.conditions, dataset)?;
    decisions.adopted = adopted_models(text.adopted, dataset)?;
    for variant in text.variants {
        let VariantText {
            name,
            settings,
            conditions,
        } = variant;
        match settings_and_choices(settings, conditions, dataset) {
            Ok(variant) => decisions.variants.push((name, variant)),
            Err(mut error) => {
                error.place.entry = format!("variant \"{name}\", {}", error.place.entry);
                return Err(error);
            }
        }
    }
    if let Some(export) = text.export {
        decisions.exports = Arc::new(export.into_choices());
    }
    decisions.signs = text.signs;
    decisions.requirements = Arc::new(text.requirements);
    Ok(decisions)
}

/// Returns the decisions in the settings and the choices for each condition, for a study or for one
/// of its variants; adopted models, signs, requirements and exports have default values.
///
/// # Errors
/// [`ContentError`] for a setting outside its range, or a condition that appears twice.
fn settings_and_choices(
    mut settings: Settings<ResponseNames>,
    conditions: Vec<ConditionText>,
    dataset: &Dataset,
) -> Result<Decisions, ContentError> {
    settings.complete_delay_scheduling();
    // The check needs sets of responses, but only checks numbers: any set will do. The names of
    // responses are resolved when the decisions are applied to the dataset.
    let start = Settings::for_dataset(dataset);
    settings
        .with_responses(|_, _| start.ignored.clone())
        .check()
        .map_err(|(setting, refusal)| {
            ContentError::new(
                Location::entry(format!("settings, {}", setting.key.replace('.', ", "))),
                refusal,
            )
        })?;
    settings.physics_parameters.check().map_err(|refusal| {
        ContentError::new(
            Location::entry("settings, physics_parameters".to_owned()),
            refusal,
        )
    })?;
    let mut choices = BTreeMap::new();
    for (index, condition) in conditions.into_iter().enumerate() {
        let ConditionText {
            id,
            physics,
            identified,
            scheduled,
            held_out,
        } = condition;
        let choice = ConditionChoice {
            physics,
            identified,
            scheduled,
            held_out,
        };
        if choices.insert(ConditionId(id), choice).is_some() {
            return Err(ContentError::new(
                Location::condition(index + 1, id),
                ContentFault::DuplicateCondition { id },
            ));
        }
    }
    Ok(Decisions {
        settings,
        choices,
        adopted: Vec::new(),
        signs: Vec::new(),
        requirements: Arc::default(),
        exports: Arc::default(),
        variants: Vec::new(),
    })
}

/// Returns the models adopted by a study, checked against its dataset.
fn adopted_models(
    texts: Vec<AdoptedText>,
    dataset: &Dataset,
) -> Result<Vec<(ConditionId, Arc<AdoptedModels>)>, ContentError> {
    let mut adopted = Vec::with_capacity(texts.len());
    for (index, text) in texts.into_iter().enumerate() {
        let mut place = Location::condition(index + 1, text.condition);
        place.entry = "taken".to_owned();
        let mut models = Vec::with_capacity(text.identified_models.len());
        for model in text.identified_models {
            let (model, _) = dataset.identified_model(model.into_identified())?;
            models.push(model);
        }
        let mut records = Vec::with_capacity(text.records.len());
        for (index, record) in text.records.into_iter().enumerate() {
            records.push(record.into_record(&place, index + 1)?);
        }
        adopted.push((
            ConditionId(text.condition),
            Arc::new(AdoptedModels { models, records }),
        ));
    }
    Ok(adopted)
}
