//! Every kind of decision about a study, and the only code that applies it.
//!
//! A *held* response is constrained: its gain and delay must be matched exactly. A *bundle*
//! contains a condition's physics models, or its identified models; those that are not rejected are
//! *kept*, and their medoid, the model closest to the others, represents the bundle (M5).

use std::sync::Arc;

use gdcm_method::correction::Channel;
use gdcm_model::dataset::{BundleKind, ConditionId, ModelId, Pair, PairTable};

use super::adopted_models::AdoptedModels;
use super::choices::{BundleChoice, ConditionChoice};
use super::edit_refusal::{EditRefusal, check_length};
use super::physics_settings::ParameterDecision;
use super::requirement_settings::{RequirementPart, RequirementSettings};
use super::setting::Setting;
use super::setting_value::Value;
use super::signs::SignRole;
use super::study::Study;

/// One decision about a study.
#[derive(Clone, Debug, PartialEq)]
pub enum Edit {
    Reject(ModelId),
    RejectBecause {
        model: ModelId,
        reason: String,
    },
    /// Sets a rejection's reason; an empty reason removes it.
    SetReason(ModelId, String),
    Restore(ModelId),
    /// Restores a condition's rejected models, in both bundles.
    RestoreAll {
        condition: ConditionId,
    },
    /// Rejects all these models, or none.
    RejectEach(Vec<ModelId>),
    RestoreEach(Vec<ModelId>),
    /// Makes a model represent its bundle instead of the medoid.
    Pin(ModelId),
    /// Makes the medoid represent the bundle again.
    Unpin {
        condition: ConditionId,
        bundle: BundleKind,
    },
    SetScheduled {
        condition: ConditionId,
        scheduled: bool,
    },
    /// Excludes a condition from the fits of schedule, couplings and physics parameters, so that it
    /// can validate them; or includes it again.
    SetHeldOut {
        condition: ConditionId,
        held_out: bool,
    },
    /// Constrains the dataset's on-axis responses, and releases all others.
    ConstrainOnAxis,
    /// Constrains a response (`true`) or releases it.
    Hold(Pair, bool),
    /// Fits a response (`true`), or ignores it in the objective.
    Fit(Pair, bool),
    /// Changes a setting; built by [`Setting::to`].
    Set(&'static Setting, Value),
    /// Reverses a channel's sign in the models, or restores it. As a decision about the data, it is
    /// common to all variants.
    SetSign {
        channel: Channel,
        /// The models in which the sign is reversed; `None` restores the sign in all.
        role: Option<SignRole>,
    },
    /// Adopts models identified from flight records instead of the conditions' identified bundles.
    AdoptModels(Vec<(ConditionId, Arc<AdoptedModels>)>),
    /// Restores a condition's identified models from the file.
    RestoreFileModels {
        condition: ConditionId,
    },
    /// Changes the requirement settings, which are common to all variants: the changed part, and
    /// the complete settings.
    SetRequirements(RequirementPart, Arc<RequirementSettings>),
    /// A decision about a physics parameter, by name (M18).
    DecideParameter {
        name: String,
        decision: ParameterDecision,
    },
    /// Stores the present decisions under a name.
    StoreVariant {
        name: String,
    },
    /// Replaces the present decisions with those stored under a name.
    ApplyVariant {
        name: String,
    },
    RemoveVariant {
        name: String,
    },
    RenameVariant {
        from: String,
        to: String,
    },
}

/// Maximum length of the reason for a rejection, in characters.
pub const LONGEST_REASON: usize = 1000;

impl Setting {
    /// Returns the decision that changes this setting to `value`.
    pub fn to(&'static self, value: impl Into<Value>) -> Edit {
        Edit::Set(self, value.into())
    }
}

impl Edit {
    /// Returns the decision that rejects a condition's physics models, by name.
    pub fn reject_physics(condition: ConditionId, models: &[String]) -> Self {
        let named = |name: &String| ModelId::new(condition, BundleKind::Physics, name);
        Self::RejectEach(models.iter().map(named).collect())
    }

    /// Returns whether two consecutive decisions form one undo step, such as two positions of the
    /// same slider.
    pub fn continues(&self, earlier: &Edit) -> bool {
        match (self, earlier) {
            (Edit::Set(later, _), Edit::Set(earlier, _)) => later == earlier,
            (Edit::SetRequirements(later, _), Edit::SetRequirements(earlier, _)) => {
                later == earlier
            }
            (
                Edit::DecideParameter { name, decision },
                Edit::DecideParameter {
                    name: earlier_name,
                    decision: earlier,
                },
            ) => name == earlier_name && decision.is_same_kind(earlier),
            _ => false,
        }
    }
}

impl Study {
    /// Applies one decision, or refuses it and leaves the study unchanged.
    ///
    /// # Errors
    /// Why the decision is refused.
    pub fn apply(&mut self, edit: &Edit) -> Result<(), EditRefusal> {
        match edit {
            Edit::Reject(id) => self.reject(id)?,
            Edit::RejectBecause { model, reason } => self.reject_because(model, reason)?,
            Edit::SetReason(id, reason) => self.set_reason(id, reason)?,
            Edit::Restore(id) => self.restore(id)?,
            Edit::RestoreAll { condition } => self.choice_mut(*condition)?.restore_all(),
            Edit::RejectEach(models) => self.reject_each(models)?,
            Edit::RestoreEach(models) => self.restore_each(models)?,
            Edit::Pin(id) => self.pin(id)?,
            Edit::Unpin { condition, bundle } => {
                self.choice_mut(*condition)?.bundle_mut(*bundle).pinned = None;
            }
            Edit::SetScheduled {
                condition,
                scheduled,
            } => self.choice_mut(*condition)?.scheduled = *scheduled,
            Edit::SetHeldOut {
                condition,
                held_out,
            } => self.choice_mut(*condition)?.held_out = *held_out,
            Edit::ConstrainOnAxis => self.settings.constrained = self.dataset.on_axis().clone(),
            Edit::Hold(pair, held) => mark(&mut self.settings.constrained, *pair, *held)?,
            Edit::Fit(pair, fitted) => mark(&mut self.settings.ignored, *pair, !*fitted)?,
            Edit::Set(setting, value) => setting.set(&mut self.settings, *value)?,
            Edit::SetSign { channel, role } => self.set_sign(*channel, *role)?,
            Edit::AdoptModels(adopted) => self.adopt_models(adopted)?,
            Edit::RestoreFileModels { condition } => self.restore_file_models(*condition)?,
            Edit::SetRequirements(_, settings) => self.requirements = Arc::clone(settings),
            Edit::DecideParameter { name, decision } => {
                let dataset = Arc::clone(&self.dataset);
                self.settings
                    .physics_parameters
                    .decide(&dataset, name, *decision)?;
            }
            Edit::StoreVariant { name } => self.store_variant(name)?,
            Edit::ApplyVariant { name } => self.apply_variant(name)?,
            Edit::RemoveVariant { name } => self.remove_variant(name)?,
            Edit::RenameVariant { from, to } => self.rename_variant(from, to)?,
        }
        Ok(())
    }

    /// Returns the choices in a condition, for changes.
    fn choice_mut(&mut self, id: ConditionId) -> Result<&mut ConditionChoice, EditRefusal> {
        self.choices
            .get_mut(&id)
            .ok_or(EditRefusal::NoCondition { condition: id })
    }

    /// Returns the choices in a model's bundle, for changes; refuses a model that does not exist.
    fn bundle_choice_mut(&mut self, id: &ModelId) -> Result<&mut BundleChoice, EditRefusal> {
        let Some(condition) = self.dataset.condition(id.condition) else {
            return Err(EditRefusal::NoCondition {
                condition: id.condition,
            });
        };
        if condition.position(id.bundle, &id.name).is_none() {
            return Err(EditRefusal::NoModel { model: id.clone() });
        }
        Ok(self.choice_mut(id.condition)?.bundle_mut(id.bundle))
    }

    /// Rejects a model, and unpins it if it was pinned; refuses to reject a bundle's last kept
    /// model.
    fn reject(&mut self, id: &ModelId) -> Result<(), EditRefusal> {
        let condition = self.dataset.condition(id.condition);
        let models = condition.map_or(0, |condition| condition.bundle(id.bundle).len());
        let choice = self.bundle_choice_mut(id)?;
        if !choice.rejected.contains(&id.name) && choice.rejected.len() + 1 == models {
            return Err(EditRefusal::LastModel {
                condition: id.condition,
                model: id.name.clone(),
            });
        }
        choice.rejected.insert(id.name.clone());
        if choice.pinned.as_ref() == Some(&id.name) {
            choice.pinned = None;
        }
        Ok(())
    }

    fn reject_because(&mut self, id: &ModelId, reason: &str) -> Result<(), EditRefusal> {
        let mut trial = self.clone();
        trial.reject(id)?;
        trial.set_reason(id, reason)?;
        *self = trial;
        Ok(())
    }

    fn reject_each(&mut self, models: &[ModelId]) -> Result<(), EditRefusal> {
        let mut trial = self.clone();
        for id in models {
            trial.reject(id)?;
        }
        *self = trial;
        Ok(())
    }

    fn restore(&mut self, id: &ModelId) -> Result<(), EditRefusal> {
        self.bundle_choice_mut(id)?.restore(&id.name);
        Ok(())
    }

    fn restore_each(&mut self, models: &[ModelId]) -> Result<(), EditRefusal> {
        let mut trial = self.clone();
        for id in models {
            trial.restore(id)?;
        }
        *self = trial;
        Ok(())
    }

    fn set_reason(&mut self, id: &ModelId, reason: &str) -> Result<(), EditRefusal> {
        let reason = reason.trim();
        let choice = self.bundle_choice_mut(id)?;
        if !choice.rejected.contains(&id.name) {
            return Err(EditRefusal::ReasonOfKept {
                condition: id.condition,
                model: id.name.clone(),
            });
        }
        check_length("reason", reason, LONGEST_REASON)?;
        if reason.is_empty() {
            choice.reasons.remove(&id.name);
        } else {
            choice.reasons.insert(id.name.clone(), reason.to_owned());
        }
        Ok(())
    }

    fn pin(&mut self, id: &ModelId) -> Result<(), EditRefusal> {
        let choice = self.bundle_choice_mut(id)?;
        if choice.rejected.contains(&id.name) {
            return Err(EditRefusal::PinRejected {
                condition: id.condition,
                model: id.name.clone(),
            });
        }
        choice.pinned = Some(id.name.clone());
        Ok(())
    }
}

/// Marks or unmarks a response; refuses a response that does not exist.
fn mark(table: &mut PairTable<bool>, pair: Pair, value: bool) -> Result<(), EditRefusal> {
    if pair.output >= table.outputs() || pair.input >= table.inputs() {
        return Err(EditRefusal::NoResponse { pair });
    }
    table[pair] = value;
    Ok(())
}
