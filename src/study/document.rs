//! What the engineer decided about a dataset.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use crate::dataset::{BundleKind, ConditionId, Dataset, ModelId};

use super::settings::Settings;

/// The engineer's choices in one bundle.
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash)]
pub struct BundleChoice {
    /// Names of the rejected models.
    pub rejected: BTreeSet<String>,
    /// Name of the model that represents the bundle in place of the medoid; never a rejected one.
    pub pinned: Option<String>,
}

impl BundleChoice {
    const fn none() -> Self {
        Self { rejected: BTreeSet::new(), pinned: None }
    }
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
        Self::none()
    }
}

impl ConditionChoice {
    /// Every model kept, none pinned, the condition scheduled.
    const fn none() -> Self {
        Self { physics: BundleChoice::none(), identified: BundleChoice::none(), scheduled: true }
    }

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
    /// Choices in each condition of the dataset.
    pub choices: BTreeMap<ConditionId, ConditionChoice>,
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
        let ids = dataset.conditions().iter().map(|condition| condition.id());
        let choices = ids.map(|id| (id, ConditionChoice::default())).collect();
        Self { dataset, settings, choices }
    }

    /// The choices in one condition; those of a condition that the dataset does not have are none.
    pub fn choice(&self, condition: ConditionId) -> &ConditionChoice {
        static NONE: ConditionChoice = ConditionChoice::none();
        self.choices.get(&condition).unwrap_or(&NONE)
    }

    /// Whether a model is rejected.
    pub fn is_rejected(&self, id: &ModelId) -> bool {
        self.choice(id.condition).bundle(id.bundle).rejected.contains(&id.name)
    }

    /// Names of the rejected models of one condition in file order, the physics bundle first.
    pub fn rejected_names(&self, condition: ConditionId) -> Vec<&str> {
        let of = |kind| {
            let rejected = &self.choice(condition).bundle(kind).rejected;
            let models = self.dataset.condition(condition).map_or(&[][..], |found| found.bundle(kind));
            models.iter().map(|model| model.name.as_str()).filter(|name| rejected.contains(*name))
        };
        BundleKind::BOTH.into_iter().flat_map(of).collect()
    }
}
