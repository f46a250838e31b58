//! What the engineer decided about a dataset.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use crate::dataset::{BundleKind, ConditionId, Dataset, ModelId};

use super::settings::Settings;
use super::taken_models::Taken;
use super::variant::Variant;

/// The engineer's choices in one bundle.
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash)]
pub struct BundleChoice {
    /// Names of the rejected models.
    pub rejected: BTreeSet<String>,
    /// Why, in the engineer's words, for those of them where that was said.
    pub reasons: BTreeMap<String, String>,
    /// Name of the model that represents the bundle in place of the medoid; never a rejected one.
    pub pinned: Option<String>,
}

impl BundleChoice {
    const fn none() -> Self {
        Self { rejected: BTreeSet::new(), reasons: BTreeMap::new(), pinned: None }
    }

    /// Puts a model back; the reason goes with the rejection.
    pub(super) fn restore(&mut self, name: &str) {
        self.rejected.remove(name);
        self.reasons.remove(name);
    }

    fn restore_all(&mut self) {
        self.rejected.clear();
        self.reasons.clear();
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
    /// Whether the condition is held out: analysed and assessed, but kept from the schedule, which it is to judge.
    pub held_out: bool,
}

impl Default for ConditionChoice {
    fn default() -> Self {
        Self::none()
    }
}

impl ConditionChoice {
    /// Every model kept, none pinned, the condition scheduled.
    const fn none() -> Self {
        Self { physics: BundleChoice::none(), identified: BundleChoice::none(), scheduled: true, held_out: false }
    }

    /// Puts every model of both bundles back.
    pub(super) fn restore_all(&mut self) {
        self.physics.restore_all();
        self.identified.restore_all();
    }

    /// What of the choices an analysis depends on: not the words that they were explained with.
    pub(super) fn without_reasons(&self) -> Self {
        let mut choice = self.clone();
        choice.physics.reasons.clear();
        choice.identified.reasons.clear();
        choice
    }

    /// What of the choices the comparison of the models depends on.
    pub(super) fn of_models(&self) -> Self {
        Self { scheduled: true, held_out: false, ..self.without_reasons() }
    }

    /// Whether the schedule is made of the condition: chosen for it, and not held out.
    pub fn is_in_schedule(&self) -> bool {
        self.scheduled && !self.held_out
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
    /// Other decisions about the dataset, kept under their names, in the order in which they were kept. No analysis depends on
    /// them.
    pub variants: Vec<Arc<Variant>>,
    /// Models taken in place of those of the dataset's file; `dataset` has them.
    pub(super) taken: Option<Taken>,
}

impl PartialEq for Study {
    /// Decisions first: the numbers of two datasets are compared only where these are not one and the same.
    fn eq(&self, other: &Self) -> bool {
        let decisions =
            (&self.settings, &self.choices, &self.variants) == (&other.settings, &other.choices, &other.variants);
        decisions && (Arc::ptr_eq(&self.dataset, &other.dataset) || self.dataset == other.dataset)
    }
}

impl Study {
    /// The study of a dataset before any decision.
    pub fn new(dataset: Arc<Dataset>) -> Self {
        let settings = Settings::of(&dataset);
        let ids = dataset.conditions().iter().map(|condition| condition.id());
        let choices = ids.map(|id| (id, ConditionChoice::default())).collect();
        Self { dataset, settings, choices, variants: Vec::new(), taken: None }
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

    /// Why a model is rejected, where the engineer has said so.
    pub fn reason(&self, id: &ModelId) -> Option<&str> {
        self.choice(id.condition).bundle(id.bundle).reasons.get(&id.name).map(String::as_str)
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
