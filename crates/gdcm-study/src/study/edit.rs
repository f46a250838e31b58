//! Every decision the engineer can take about a study, and the only code that carries one out.

use std::sync::Arc;

use gdcm_method::correction::Channel;
use gdcm_model::dataset::dataset::BandError;
use gdcm_model::dataset::{BundleKind, Condition, ConditionId, ModelId, Pair, PairTable};
use gdcm_model::units::number;

use super::changed_models::{AdoptedModels, SignRole};
use super::requirements::RequirementSettings;
use super::setting_row::{Setting, Value};
use super::{ConditionChoice, Study};

/// One decision about a study.
#[derive(Clone, Debug, PartialEq)]
pub enum Edit {
    /// Take a model out of its bundle.
    Reject(ModelId),
    /// Take a model out of its bundle, and say why.
    RejectBecause {
        /// The model.
        model: ModelId,
        /// The reason in the engineer's words.
        reason: String,
    },
    /// Say why a rejected model is rejected; an empty reason takes back what was said.
    SetReason(ModelId, String),
    /// Put a rejected model back.
    Restore(ModelId),
    /// Put every rejected model of a condition back, in both bundles.
    RestoreAll {
        /// The condition.
        condition: ConditionId,
    },
    /// Take models out of their bundles: all of them, or none.
    RejectEach(Vec<ModelId>),
    /// Put rejected models back.
    RestoreEach(Vec<ModelId>),
    /// Let a model represent its bundle, whatever the medoid is.
    Pin(ModelId),
    /// Let the medoid represent a bundle again.
    Unpin {
        /// The condition.
        condition: ConditionId,
        /// Which bundle.
        bundle: BundleKind,
    },
    /// Take a condition into the schedule, or leave it out.
    SetScheduled {
        /// The condition.
        condition: ConditionId,
        /// Whether it enters the schedule.
        scheduled: bool,
    },
    /// Hold a condition out, to judge the schedule by it, or let it be one of the others again.
    SetHeldOut {
        /// The condition.
        condition: ConditionId,
        /// Whether it is held out.
        held_out: bool,
    },
    /// Hold exactly the dataset's on-axis responses.
    ConstrainOnAxis,
    /// Hold a response exactly, or free it.
    Hold(Pair, bool),
    /// Fit a response, or ignore it in the objective.
    Fit(Pair, bool),
    /// Give a setting of the whole study a value ([`Setting::to`]).
    Set(&'static Setting, Value),
    /// Turns the models of a channel, or puts them back as the file has them: a decision about the data, of all variants.
    SetSign {
        /// The channel.
        channel: Channel,
        /// Whose models; none puts all back.
        of: Option<SignRole>,
    },
    /// Put models identified from flight records into conditions, in place of the identified models there.
    TakeModels(Vec<(ConditionId, Arc<AdoptedModels>)>),
    /// Put the identified models of the dataset's file back into a condition.
    ReturnModels {
        /// The condition.
        condition: ConditionId,
    },
    /// Ask requirements with other settings: what of them is other, and all of them. A decision of the study, of all variants.
    SetRequirements(&'static str, Arc<RequirementSettings>),
    /// Keep the present decisions under a name.
    KeepVariant {
        /// The name.
        name: String,
    },
    /// Put the decisions that were kept under a name in place of the present ones.
    TakeVariant {
        /// The name.
        name: String,
    },
    /// Forget the decisions kept under a name.
    RemoveVariant {
        /// The name.
        name: String,
    },
    /// Give kept decisions another name.
    RenameVariant {
        /// The name now.
        from: String,
        /// The new name.
        to: String,
    },
}

/// Characters that the reason of a rejection may have.
pub const LONGEST_REASON: usize = 1000;

/// Why a decision was not carried out; the study is unchanged.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum EditRefusal {
    /// The last model of a bundle cannot be rejected.
    #[error(
        "condition {condition}: \"{model}\" is the last model kept in its bundle; at least one must stay"
    )]
    LastModel {
        /// The condition's id.
        condition: ConditionId,
        /// The model's name.
        model: String,
    },
    /// A rejected model cannot represent its bundle.
    #[error(
        "condition {condition}: \"{model}\" is rejected; restore it before using it as representative"
    )]
    PinRejected {
        /// The condition's id.
        condition: ConditionId,
        /// The model's name.
        model: String,
    },
    /// Only a rejected model has a reason to be.
    #[error("condition {condition}: \"{model}\" is not rejected; a reason goes with a rejection")]
    ReasonOfKept {
        /// The condition's id.
        condition: ConditionId,
        /// The model's name.
        model: String,
    },
    /// A text is longer than it may be.
    #[error("{what}: expected at most {most} characters, found {found}")]
    TooLong {
        /// What the text is.
        what: &'static str,
        /// Characters it may have.
        most: usize,
        /// Characters it has.
        found: usize,
    },
    /// Models that cannot be those of a condition.
    #[error("condition {condition}: {why}")]
    Models {
        /// The condition's id.
        condition: ConditionId,
        /// Why not.
        why: String,
    },
    /// A variant needs a name.
    #[error("a variant needs a name")]
    VariantWithoutName,
    /// Another variant has this name.
    #[error("there is a variant \"{name}\" already")]
    VariantExists {
        /// The name.
        name: String,
    },
    /// No variant has this name.
    #[error("there is no variant \"{name}\"")]
    NoVariant {
        /// The name.
        name: String,
    },
    /// A setting lies outside its range.
    #[error("{setting}: expected {expected}, found {}", number(*found))]
    OutOfRange {
        /// The setting's name.
        setting: &'static str,
        /// Its range.
        expected: String,
        /// The value given.
        found: f64,
    },
    /// The two ends of the band are wrong.
    #[error(transparent)]
    Band(#[from] BandError),
    /// A setting cannot have a value of this kind.
    #[error("{setting}: this is not one of its values")]
    NotAValue {
        /// The setting's name.
        setting: &'static str,
    },
    /// The dataset has no such condition.
    #[error("the dataset has no condition {condition}")]
    NoCondition {
        /// The condition.
        condition: ConditionId,
    },
    /// The dataset has no such model.
    #[error("condition {} has no {} model \"{}\"", model.condition, model.bundle, model.name)]
    NoModel {
        /// The model.
        model: ModelId,
    },
    /// The channel does not exist.
    #[error("the dataset has no {}", channel.name(&[], &[]))]
    NoChannel {
        /// The channel.
        channel: Channel,
    },
    /// The dataset has no such response.
    #[error("the dataset has no response of output number {} to input number {}", pair.output + 1, pair.input + 1)]
    NoResponse {
        /// The response.
        pair: Pair,
    },
}

impl Edit {
    /// Rejects physics models of a condition, by their names.
    pub fn reject_physics(condition: ConditionId, models: &[String]) -> Self {
        Self::RejectEach(
            models
                .iter()
                .map(|name| ModelId::new(condition, BundleKind::Physics, name))
                .collect(),
        )
    }

    /// The decision in a few words, for the undo list: "reject nominal (condition 10)".
    pub fn label(&self, study: &Study) -> String {
        let name_of = |id: &ModelId| format!("{} (condition {})", id.name, id.condition);
        match self {
            Edit::Reject(id) => format!("reject {}", name_of(id)),
            Edit::RejectBecause { model, .. } => format!("reject {}", name_of(model)),
            Edit::SetReason(id, _) => format!("reason of {}", name_of(id)),
            Edit::Restore(id) => format!("restore {}", name_of(id)),
            Edit::RestoreAll { condition } => format!("restore all (condition {condition})"),
            Edit::RejectEach(models) => format!("reject {} models", models.len()),
            Edit::RestoreEach(models) => format!("restore {} models", models.len()),
            Edit::Pin(id) => format!("use {} as representative", name_of(id)),
            Edit::Unpin { condition, .. } => {
                format!("use the medoid as representative (condition {condition})")
            }
            Edit::SetScheduled {
                condition,
                scheduled: true,
            } => format!("schedule condition {condition}"),
            Edit::SetScheduled { condition, .. } => format!("leave condition {condition} out"),
            Edit::SetHeldOut {
                condition,
                held_out: true,
            } => format!("hold condition {condition} out"),
            Edit::SetHeldOut { condition, .. } => {
                format!("no longer hold condition {condition} out")
            }
            Edit::ConstrainOnAxis => "hold the on-axis responses".to_owned(),
            Edit::Hold(pair, held) => {
                format!(
                    "{} {}",
                    if *held { "hold" } else { "release" },
                    study.dataset.pair_name(*pair)
                )
            }
            Edit::Fit(pair, fitted) => {
                format!(
                    "{} {}",
                    if *fitted { "fit" } else { "ignore" },
                    study.dataset.pair_name(*pair)
                )
            }
            Edit::Set(setting, _) => setting.name.to_owned(),
            Edit::SetSign { channel, of } => {
                let name = channel.name_in(&study.dataset);
                of.map_or_else(
                    || format!("turn {name} back"),
                    |of| format!("turn {name} ({})", of.word()),
                )
            }
            Edit::TakeModels(taken) => match taken.as_slice() {
                [(condition, _)] => format!("use identified models (condition {condition})"),
                _ => format!("use identified models ({} conditions)", taken.len()),
            },
            Edit::ReturnModels { condition } => {
                format!("put the file's identified models back (condition {condition})")
            }
            Edit::SetRequirements(what, _) => format!("requirements: {what}"),
            Edit::KeepVariant { name } => format!("keep variant {name}"),
            Edit::TakeVariant { name } => format!("take variant {name}"),
            Edit::RemoveVariant { name } => format!("remove variant {name}"),
            Edit::RenameVariant { from, to } => format!("rename variant {from} to {to}"),
        }
    }

    /// Whether two decisions in a row are one to the engineer: two positions of the same slider.
    pub fn continues(&self, earlier: &Edit) -> bool {
        match (self, earlier) {
            (Edit::Set(later, _), Edit::Set(earlier, _)) => later == earlier,
            (Edit::SetRequirements(later, _), Edit::SetRequirements(earlier, _)) => {
                later == earlier
            }
            _ => false,
        }
    }
}

impl Study {
    /// Carries out one decision, or refuses it and leaves the study as it was.
    pub fn apply(&mut self, edit: &Edit) -> Result<(), EditRefusal> {
        match edit {
            Edit::Reject(id) => return self.reject(id),
            Edit::RejectEach(models) => {
                return self.attempt(|of| models.iter().try_for_each(|model| of.reject(model)));
            }
            Edit::RestoreEach(models) => {
                return self.attempt(|of| models.iter().try_for_each(|model| of.restore(model)));
            }
            Edit::Pin(id) => return self.pin(id),
            Edit::Restore(id) => return self.restore(id),
            Edit::RestoreAll { condition } => self.condition(*condition)?.1.restore_all(),
            Edit::RejectBecause { model, reason } => {
                return self
                    .attempt(|of| of.reject(model).and_then(|()| of.set_reason(model, reason)));
            }
            Edit::SetReason(id, reason) => return self.set_reason(id, reason),
            Edit::Unpin { condition, bundle } => {
                self.condition(*condition)?.1.bundle_mut(*bundle).pinned = None
            }
            Edit::SetScheduled {
                condition,
                scheduled,
            } => self.condition(*condition)?.1.scheduled = *scheduled,
            Edit::SetHeldOut {
                condition,
                held_out,
            } => self.condition(*condition)?.1.held_out = *held_out,
            Edit::ConstrainOnAxis => self.settings.constrained = self.dataset.on_axis().clone(),
            Edit::Hold(pair, held) => mark(&mut self.settings.constrained, *pair, *held)?,
            Edit::Fit(pair, fitted) => mark(&mut self.settings.ignored, *pair, !*fitted)?,
            Edit::Set(setting, value) => return setting.set(&mut self.settings, *value),
            Edit::SetSign { channel, of } => return self.set_sign(*channel, *of),
            Edit::TakeModels(taken) => return self.take_models(taken),
            Edit::ReturnModels { condition } => return self.return_models(*condition),
            Edit::SetRequirements(_, settings) => self.requirements = Arc::clone(settings),
            Edit::KeepVariant { name } => return self.keep_variant(name),
            Edit::TakeVariant { name } => return self.take_variant(name),
            Edit::RemoveVariant { name } => return self.remove_variant(name),
            Edit::RenameVariant { from, to } => return self.rename_variant(from, to),
        }
        Ok(())
    }

    /// A condition with the choices in it, to change.
    fn condition(
        &mut self,
        id: ConditionId,
    ) -> Result<(&Condition, &mut ConditionChoice), EditRefusal> {
        let found = self
            .dataset
            .condition(id)
            .map(Arc::as_ref)
            .zip(self.choices.get_mut(&id));
        found.ok_or(EditRefusal::NoCondition { condition: id })
    }

    /// As [`Study::condition`], of a model that is there.
    fn model(&mut self, id: &ModelId) -> Result<(&Condition, &mut ConditionChoice), EditRefusal> {
        let (condition, choice) = self.condition(id.condition)?;
        if condition.position(id.bundle, &id.name).is_none() {
            return Err(EditRefusal::NoModel { model: id.clone() });
        }
        Ok((condition, choice))
    }

    fn reject(&mut self, id: &ModelId) -> Result<(), EditRefusal> {
        let (condition, choice) = self.model(id)?;
        let models = condition.bundle(id.bundle).len();
        let choice = choice.bundle_mut(id.bundle);
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

    fn restore(&mut self, id: &ModelId) -> Result<(), EditRefusal> {
        self.model(id)?.1.bundle_mut(id.bundle).restore(&id.name);
        Ok(())
    }

    /// Several decisions as one: all of them, or none.
    fn attempt(
        &mut self,
        decide: impl FnOnce(&mut Self) -> Result<(), EditRefusal>,
    ) -> Result<(), EditRefusal> {
        let mut trial = self.clone();
        decide(&mut trial)?;
        *self = trial;
        Ok(())
    }

    fn set_reason(&mut self, id: &ModelId, reason: &str) -> Result<(), EditRefusal> {
        let reason = reason.trim();
        let (_, choice) = self.model(id)?;
        let choice = choice.bundle_mut(id.bundle);
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
        let (_, choice) = self.model(id)?;
        let choice = choice.bundle_mut(id.bundle);
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

fn mark(table: &mut PairTable<bool>, pair: Pair, value: bool) -> Result<(), EditRefusal> {
    if pair.output >= table.outputs() || pair.input >= table.inputs() {
        return Err(EditRefusal::NoResponse { pair });
    }
    table[pair] = value;
    Ok(())
}

pub(super) fn check_length(what: &'static str, text: &str, most: usize) -> Result<(), EditRefusal> {
    let found = text.chars().count();
    if found > most {
        Err(EditRefusal::TooLong { what, most, found })
    } else {
        Ok(())
    }
}
