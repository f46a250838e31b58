//! What the engineer decided about a dataset.

use std::collections::BTreeSet;
use std::sync::Arc;

use crate::dataset::{BundleKind, Dataset, ModelId};

use super::settings::Settings;

/// The engineer's choices in one bundle.
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash)]
pub struct BundleChoice {
    /// Indices of the rejected models.
    pub rejected: BTreeSet<usize>,
    /// The model that represents the bundle in place of the medoid; never a rejected one.
    pub pinned: Option<usize>,
}

/// The engineer's choices in one condition.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct ConditionChoice {
    /// Choices among the physics models.
    pub physics: BundleChoice,
    /// Choices among the identified models.
    pub identified: BundleChoice,
    /// Whether the condition enters the schedule.
    pub scheduled: bool,
}

impl Default for ConditionChoice {
    fn default() -> Self {
        Self { physics: BundleChoice::default(), identified: BundleChoice::default(), scheduled: true }
    }
}

impl ConditionChoice {
    /// The choices in one bundle.
    pub fn bundle(&self, kind: BundleKind) -> &BundleChoice {
        match kind {
            BundleKind::Physics => &self.physics,
            BundleKind::Identified => &self.identified,
        }
    }

    /// The choices in one bundle, to change.
    pub fn bundle_mut(&mut self, kind: BundleKind) -> &mut BundleChoice {
        match kind {
            BundleKind::Physics => &mut self.physics,
            BundleKind::Identified => &mut self.identified,
        }
    }
}

/// A study: a dataset, and every decision about it. What is saved, and what undo goes back over.
#[derive(Clone, Debug)]
pub struct Study {
    /// The models.
    pub dataset: Arc<Dataset>,
    /// Every setting that changes a result.
    pub settings: Settings,
    /// Choices in each condition, in the dataset's order.
    pub choices: Vec<ConditionChoice>,
}

impl PartialEq for Study {
    /// Decisions first: the numbers of two datasets are compared only where these are not one and the same.
    fn eq(&self, other: &Self) -> bool {
        let decisions = self.settings == other.settings && self.choices == other.choices;
        decisions && (Arc::ptr_eq(&self.dataset, &other.dataset) || self.dataset == other.dataset)
    }
}

impl Study {
    /// The study of a dataset before any decision.
    pub fn new(dataset: Arc<Dataset>) -> Self {
        let settings = Settings::of(&dataset);
        let choices = vec![ConditionChoice::default(); dataset.conditions().len()];
        Self { dataset, settings, choices }
    }

    /// Whether a model is rejected.
    pub fn is_rejected(&self, id: ModelId) -> bool {
        self.choices[id.condition].bundle(id.bundle).rejected.contains(&id.model)
    }

    /// Names of the rejected models of one condition, the physics bundle first.
    pub fn rejected_names(&self, condition: usize) -> Vec<&str> {
        [BundleKind::Physics, BundleKind::Identified]
            .into_iter()
            .flat_map(|kind| {
                let models = self.dataset.conditions()[condition].bundle(kind);
                self.choices[condition].bundle(kind).rejected.iter().map(|&index| models[index].name.as_str())
            })
            .collect()
    }
}
