//! Studies: settings, rejections and pins by the engineer, and their analysis in cached stages.

use crate::decisions::changed_models::{AdoptedModels, Signs};
use crate::decisions::edit::{Edit, EditRefusal, check_length};
use crate::decisions::settings::Settings;
use crate::results::requirements::RequirementSettings;

// Common imports of this module.
use std::collections::{BTreeMap, BTreeSet};
use std::sync::{Arc, LazyLock};

use serde::{Deserialize, Serialize};

use gdcm_model::dataset::{BundleKind, ConditionId, Dataset, ModelId};

/// The engineer's choices in one bundle.
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub struct BundleChoice {
    /// Names of the rejected models.
    pub rejected: BTreeSet<String>,
    /// Reasons of rejections, in the engineer's words, where given; studies of older programs have
    /// none.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub reasons: BTreeMap<String, String>,
    /// Name of the model that represents the bundle instead of the medoid; never a rejected model.
    pub pinned: Option<String>,
}

impl BundleChoice {
    /// Restores a model; the reason is removed with the rejection.
    pub(crate) fn restore(&mut self, name: &str) {
        self.rejected.remove(name);
        self.reasons.remove(name);
    }
}

/// The engineer's choices in one condition.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct ConditionChoice {
    pub physics: BundleChoice,
    pub identified: BundleChoice,
    pub scheduled: bool,
    /// Whether the condition is held out: analysed and assessed, but kept out of the schedule, to
    /// validate it.
    pub held_out: bool,
}

impl Default for ConditionChoice {
    fn default() -> Self {
        Self {
            physics: BundleChoice::default(),
            identified: BundleChoice::default(),
            scheduled: true,
            held_out: false,
        }
    }
}

impl ConditionChoice {
    /// Restores every model of both bundles.
    pub(crate) fn restore_all(&mut self) {
        for choice in [&mut self.physics, &mut self.identified] {
            choice.rejected.clear();
            choice.reasons.clear();
        }
    }

    /// Returns the choices that an analysis depends on: without the reasons of rejections.
    pub(crate) fn without_reasons(&self) -> Self {
        let mut choice = self.clone();
        choice.physics.reasons.clear();
        choice.identified.reasons.clear();
        choice
    }

    /// Returns the choices that the comparison of the models depends on.
    pub(crate) fn of_models(&self) -> Self {
        Self {
            scheduled: true,
            held_out: false,
            ..self.without_reasons()
        }
    }

    /// Returns whether the condition is used in the schedule: chosen for it, and not held out.
    pub fn is_in_schedule(&self) -> bool {
        self.scheduled && !self.held_out
    }

    /// Returns the choices in one bundle.
    pub fn bundle(&self, kind: BundleKind) -> &BundleChoice {
        kind.pick(&self.physics, &self.identified)
    }

    /// Returns the choices in one bundle, mutable.
    pub fn bundle_mut(&mut self, kind: BundleKind) -> &mut BundleChoice {
        kind.pick(&mut self.physics, &mut self.identified)
    }
}

/// A study: a dataset, and every decision about it. The unit of saving and of undo.
#[derive(Clone, Debug)]
pub struct Study {
    pub dataset: Arc<Dataset>,
    /// Every setting that changes a result.
    pub settings: Settings,
    pub choices: BTreeMap<ConditionId, ConditionChoice>,
    /// Alternative decisions about the dataset, stored under their names, in the order of storage.
    /// No analysis depends on them.
    pub variants: Vec<Arc<Variant>>,
    /// The channels with reversed sign; `dataset` already contains the reversal.
    pub signs: Signs,
    /// Settings of the requirements. No correction depends on them.
    pub requirements: Arc<RequirementSettings>,
    /// Models adopted instead of those of the dataset's file; `dataset` contains them.
    pub(crate) taken: BTreeMap<ConditionId, Arc<AdoptedModels>>,
    /// The dataset as in its file, where models are adopted or reversed.
    pub(crate) file: Option<Arc<Dataset>>,
}

impl PartialEq for Study {
    /// Compares decisions first: the numbers of two datasets are compared only where they are not
    /// the same object.
    fn eq(&self, other: &Self) -> bool {
        let decisions = (
            &self.settings,
            &self.choices,
            &self.variants,
            &self.signs,
            &self.requirements,
        ) == (
            &other.settings,
            &other.choices,
            &other.variants,
            &other.signs,
            &other.requirements,
        );
        decisions && (Arc::ptr_eq(&self.dataset, &other.dataset) || self.dataset == other.dataset)
    }
}

impl Study {
    /// Creates the study of a dataset, before any decision.
    pub fn new(dataset: Arc<Dataset>) -> Self {
        let settings = Settings::of(&dataset);
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
            taken: BTreeMap::new(),
            file: None,
        }
    }

    /// Returns the choices in one condition; empty choices for a condition that the dataset does
    /// not have.
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

    /// Returns the reason of a model's rejection, where given.
    pub fn reason(&self, id: &ModelId) -> Option<&str> {
        self.choice(id.condition)
            .bundle(id.bundle)
            .reasons
            .get(&id.name)
            .map(String::as_str)
    }

    /// Returns the names of the rejected models of one condition in file order, the physics bundle
    /// first.
    pub fn rejected_names(&self, condition: ConditionId) -> Vec<&str> {
        let of = |kind| {
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
        BundleKind::BOTH.into_iter().flat_map(of).collect()
    }
}

/// Greatest length of a variant's name, in characters.
pub const LONGEST_VARIANT_NAME: usize = 60;

/// All decisions of a study at one time, stored under a name.
#[derive(Clone, Debug, PartialEq)]
pub struct Variant {
    /// The name, unique in its study.
    pub name: String,
    pub settings: Settings,
    pub choices: BTreeMap<ConditionId, ConditionChoice>,
}

impl Study {
    /// Returns the variant with this name.
    pub fn variant(&self, name: &str) -> Option<&Variant> {
        self.variants
            .iter()
            .find(|variant| variant.name == name)
            .map(Arc::as_ref)
    }

    /// Returns the study with the decisions of one of its variants instead of the present ones, and
    /// without variants: the study analysed for comparisons.
    pub fn of_variant(&self, name: &str) -> Option<Study> {
        let Variant {
            settings, choices, ..
        } = self.variant(name)?;
        let settings = settings.clone();
        let choices = choices.clone();
        Some(Study {
            settings,
            choices,
            variants: Vec::new(),
            ..self.clone()
        })
    }

    pub(crate) fn keep_variant(&mut self, name: &str) -> Result<(), EditRefusal> {
        let name = self.new_variant_name(name)?;
        let settings = self.settings.clone();
        let choices = self.choices.clone();
        self.variants.push(Arc::new(Variant {
            name,
            settings,
            choices,
        }));
        Ok(())
    }

    pub(crate) fn take_variant(&mut self, name: &str) -> Result<(), EditRefusal> {
        let index = self.variant_index(name)?;
        let Variant {
            settings, choices, ..
        } = self.variants[index].as_ref();
        (self.settings, self.choices) = (settings.clone(), choices.clone());
        Ok(())
    }

    pub(crate) fn remove_variant(&mut self, name: &str) -> Result<(), EditRefusal> {
        let index = self.variant_index(name)?;
        self.variants.remove(index);
        Ok(())
    }

    pub(crate) fn rename_variant(&mut self, from: &str, to: &str) -> Result<(), EditRefusal> {
        let index = self.variant_index(from)?;
        if from == to.trim() {
            return Ok(());
        }
        let name = self.new_variant_name(to)?;
        self.variants[index] = Arc::new(Variant {
            name,
            ..self.variants[index].as_ref().clone()
        });
        Ok(())
    }

    fn variant_index(&self, name: &str) -> Result<usize, EditRefusal> {
        let index = self
            .variants
            .iter()
            .position(|variant| variant.name == name);
        index.ok_or_else(|| EditRefusal::NoVariant {
            name: name.to_owned(),
        })
    }

    fn new_variant_name(&self, name: &str) -> Result<String, EditRefusal> {
        let name = name.trim();
        check_length("name of a variant", name, LONGEST_VARIANT_NAME)?;
        match (name.is_empty(), self.variant(name)) {
            (true, _) => Err(EditRefusal::VariantWithoutName),
            (_, Some(_)) => Err(EditRefusal::VariantExists {
                name: name.to_owned(),
            }),
            (_, None) => Ok(name.to_owned()),
        }
    }
}

/// Greatest number of steps; a snapshot takes a few kilobytes, because the models are shared.
const MOST_STEPS: usize = 500;

#[derive(Clone, Debug)]
struct Step<B> {
    label: String,
    study: Study,
    beside: B,
}

/// Undo history: whole studies, each with the label of the decision between it and the next.
///
/// `B` is state outside the study that a step changes: its value on the other side of the step,
/// which undo and redo exchange for the present value. Decisions about the study alone use
/// `B::default()`, which changes nothing.
#[derive(Clone, Debug)]
pub struct History<B = ()> {
    past: Vec<Step<B>>,
    future: Vec<Step<B>>,
    /// Redo steps removed by the last decision.
    lost: Vec<Step<B>>,
    /// The last decision, while the next may still continue it (a slider being dragged).
    open: Option<Edit>,
}

impl<B> Default for History<B> {
    fn default() -> Self {
        Self {
            past: Vec::new(),
            future: Vec::new(),
            lost: Vec::new(),
            open: None,
        }
    }
}

impl<B: Default> History<B> {
    /// Stores `before`, the study that `edit` is about to change (or has just changed).
    ///
    /// A decision that continues the last one (see [`Edit::continues`]) adds no step until
    /// [`History::seal`].
    pub fn record(&mut self, before: Study, edit: &Edit) {
        let lost = std::mem::take(&mut self.future);
        if self.open.as_ref().is_some_and(|open| edit.continues(open)) {
            return;
        }
        self.lost = lost;
        self.push(Step {
            label: edit.label(&before),
            study: before,
            beside: B::default(),
        });
        self.open = Some(edit.clone());
    }

    /// Stores a decision that leaves the study unchanged: `before` is the previous value of the
    /// state outside the study.
    pub fn record_beside(&mut self, study: Study, label: String, before: B) {
        self.lost = std::mem::take(&mut self.future);
        self.push(Step {
            label,
            study,
            beside: before,
        });
        self.open = None;
    }

    /// Stores `before`, the study with the dataset before a reload.
    pub fn record_reload(&mut self, before: Study, label: String) {
        self.future.clear();
        self.push(Step {
            label,
            study: before,
            beside: B::default(),
        });
        self.open = None;
    }

    fn push(&mut self, step: Step<B>) {
        if self.past.len() == MOST_STEPS {
            self.past.remove(0);
        }
        self.past.push(step);
    }

    /// Closes the present decision, for example when a slider is released.
    pub fn seal(&mut self) {
        self.open = None;
    }

    /// Returns the study before the last decision, given the present study; `exchange` restores the
    /// state outside the study, and returns its present value.
    pub fn undo(&mut self, now: &Study, exchange: impl FnOnce(B) -> B) -> Option<Study> {
        let step = self.past.pop()?;
        self.open = None;
        self.future.push(Step {
            label: step.label,
            study: now.clone(),
            beside: exchange(step.beside),
        });
        Some(step.study)
    }

    /// Returns the study before the last decision if that was `edit`, and removes the decision: it
    /// cannot be redone, and the redo steps that it removed are available again.
    pub fn forget(&mut self, edit: &Edit) -> Option<Study> {
        if self.open.as_ref() != Some(edit) {
            return None;
        }
        let step = self.past.pop()?;
        self.open = None;
        self.future = std::mem::take(&mut self.lost);
        Some(step.study)
    }

    /// Returns the study after the last undone decision, given the present study; `exchange` as in
    /// [`History::undo`].
    pub fn redo(&mut self, now: &Study, exchange: impl FnOnce(B) -> B) -> Option<Study> {
        let step = self.future.pop()?;
        self.open = None;
        self.past.push(Step {
            label: step.label,
            study: now.clone(),
            beside: exchange(step.beside),
        });
        Some(step.study)
    }

    /// Returns the label of the decision that [`History::undo`] would undo.
    pub fn undo_label(&self) -> Option<&str> {
        self.past.last().map(|step| step.label.as_str())
    }

    /// Returns the label of the decision that [`History::redo`] would redo.
    pub fn redo_label(&self) -> Option<&str> {
        self.future.last().map(|step| step.label.as_str())
    }
}
