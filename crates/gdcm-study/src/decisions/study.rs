//! Studies: a dataset with every decision that the engineer has made about it.
//!
//! Decisions are settings common to all conditions, choices among the models of each condition, and
//! signs, adopted models and requirements, which are common to all variants.

use std::collections::BTreeMap;
use std::sync::{Arc, LazyLock};

use gdcm_model::dataset::{BundleKind, ConditionId, Dataset, ModelId};

use super::adopted_models::AdoptedModels;
use super::choices::ConditionChoice;
use super::export_choices::ExportChoices;
use super::requirement_settings::RequirementSettings;
use super::settings::Settings;
use super::signs::Signs;

/// A dataset with all decisions about it; the unit of saving and of undo.
#[derive(Clone, Debug)]
pub struct Study {
    pub dataset: Arc<Dataset>,
    /// Settings common to all conditions, apart from the requirement settings.
    pub settings: Settings,
    pub choices: BTreeMap<ConditionId, ConditionChoice>,
    /// Alternative decisions about the dataset, stored under names, in order of creation. No
    /// analysis depends on them.
    pub variants: Vec<Arc<Variant>>,
    /// The channels with reversed sign; `dataset` already contains the reversal.
    pub signs: Signs,
    /// Requirement settings. No correction depends on them.
    pub requirements: Arc<RequirementSettings>,
    /// Choices in the last export. No result depends on them.
    pub exports: Arc<ExportChoices>,
    /// Models adopted instead of those in the file; `dataset` contains them.
    pub(crate) adopted: BTreeMap<ConditionId, Arc<AdoptedModels>>,
    /// The dataset as in its file; `None` if no models are adopted and no signs reversed.
    pub(crate) file_dataset: Option<Arc<Dataset>>,
}

impl PartialEq for Study {
    /// Compares the decisions first. The datasets' contents, which include adopted models, are only
    /// compared if they are not the same object.
    fn eq(&self, other: &Self) -> bool {
        let decisions = (
            &self.settings,
            &self.choices,
            &self.variants,
            &self.signs,
            &self.requirements,
            &self.exports,
        ) == (
            &other.settings,
            &other.choices,
            &other.variants,
            &other.signs,
            &other.requirements,
            &other.exports,
        );
        decisions && (Arc::ptr_eq(&self.dataset, &other.dataset) || self.dataset == other.dataset)
    }
}

impl Study {
    /// Returns the datasets that the study keeps in memory: the one in use, and the one as in its
    /// file.
    pub(crate) fn datasets(&self) -> impl Iterator<Item = &Arc<Dataset>> {
        std::iter::once(&self.dataset).chain(&self.file_dataset)
    }

    /// Creates a study of `dataset` without any decision: default settings, no rejections.
    pub fn new(dataset: Arc<Dataset>) -> Self {
        let settings = Settings::for_dataset(&dataset);
        let choices = dataset
            .ids()
            .map(|id| (id, ConditionChoice::default()))
            .collect();
        Self {
            dataset,
            settings,
            choices,
            variants: Vec::new(),
            signs: Signs::new(),
            requirements: Arc::default(),
            exports: Arc::default(),
            adopted: BTreeMap::new(),
            file_dataset: None,
        }
    }

    /// Returns the choices in a condition; default choices if the dataset does not have the
    /// condition.
    pub fn choice(&self, condition: ConditionId) -> &ConditionChoice {
        static NONE: LazyLock<ConditionChoice> = LazyLock::new(ConditionChoice::default);
        self.choices.get(&condition).unwrap_or(&NONE)
    }

    /// Returns whether a model is rejected.
    pub fn is_rejected(&self, id: &ModelId) -> bool {
        self.choice(id.condition)
            .bundle(id.bundle)
            .rejected
            .contains(&id.name)
    }

    /// Returns the reason for rejecting a model, where given.
    pub fn reason(&self, id: &ModelId) -> Option<&str> {
        self.choice(id.condition)
            .bundle(id.bundle)
            .reasons
            .get(&id.name)
            .map(String::as_str)
    }

    /// Names a condition's rejected models in file order, physics bundle first.
    pub fn rejected_names(&self, condition: ConditionId) -> Vec<&str> {
        let rejected_in_bundle = |kind| {
            let rejected = &self.choice(condition).bundle(kind).rejected;
            let models = self
                .dataset
                .condition(condition)
                .map_or(&[][..], |found| found.bundle(kind));
            models
                .iter()
                .map(|model| model.name.as_str())
                .filter(|name| rejected.contains(*name))
        };
        BundleKind::BOTH
            .into_iter()
            .flat_map(rejected_in_bundle)
            .collect()
    }
}

/// Decisions about a study at a certain time, stored under a name.
#[derive(Clone, Debug, PartialEq)]
pub struct Variant {
    /// The name, unique in its study.
    pub name: String,
    pub settings: Settings,
    pub choices: BTreeMap<ConditionId, ConditionChoice>,
}
