//! A study's models that differ from those in its dataset's file: adopted models, and channels with
//! reversed sign. The study's dataset contains these changes, so that no other code needs to apply
//! them.

use std::collections::BTreeMap;
use std::sync::Arc;

use gdcm_method::correction::Channel;
use gdcm_model::dataset::channel::ChannelSide;
use gdcm_model::dataset::{BundleKind, ConditionId, Dataset};

use super::adopted_models::AdoptedModels;
use super::edit_refusal::EditRefusal;
use super::signs::{ReversedChannel, SignRole, Signs, with_reversed_signs};
use super::study::Study;

impl Study {
    /// Returns the dataset as in its file, without adopted models and with the original signs.
    pub fn file_dataset(&self) -> &Arc<Dataset> {
        self.file_dataset.as_ref().unwrap_or(&self.dataset)
    }

    /// Returns the adopted models, condition by condition.
    pub fn adopted_models(&self) -> impl Iterator<Item = (ConditionId, &Arc<AdoptedModels>)> {
        self.adopted.iter().map(|(id, models)| (*id, models))
    }

    /// Adopts models into all of these conditions, or into none if one is refused. Decisions about
    /// removed models are dropped.
    pub(crate) fn adopt_models(
        &mut self,
        adopted: &[(ConditionId, Arc<AdoptedModels>)],
    ) -> Result<(), EditRefusal> {
        let mut all_adopted = self.adopted.clone();
        all_adopted.extend(adopted.iter().cloned());
        self.rebuild(all_adopted, self.signs.clone())
    }

    /// Restores a condition's identified models from the file, and drops decisions about models
    /// that the file does not have.
    pub(crate) fn restore_file_models(
        &mut self,
        condition: ConditionId,
    ) -> Result<(), EditRefusal> {
        let mut adopted = self.adopted.clone();
        adopted.remove(&condition);
        self.rebuild(adopted, self.signs.clone())
    }

    /// Reverses a channel's sign in the models with `role`; `None` restores it in all.
    pub(crate) fn set_sign(
        &mut self,
        channel: Channel,
        role: Option<SignRole>,
    ) -> Result<(), EditRefusal> {
        if !Channel::of_dataset(&self.dataset).any(|known| known == channel) {
            return Err(EditRefusal::NoChannel { channel });
        }
        let mut signs = self.signs.clone();
        signs.remove(&channel);
        signs.extend(role.map(|role| (channel, role)));
        self.rebuild(self.adopted.clone(), signs)
    }

    /// Applies these adopted models and then the reversed signs to the dataset from the file, so
    /// that the signs of adopted models are reversed too.
    fn rebuild(
        &mut self,
        adopted: BTreeMap<ConditionId, Arc<AdoptedModels>>,
        signs: Signs,
    ) -> Result<(), EditRefusal> {
        let file = Arc::clone(self.file_dataset());
        let mut dataset = Arc::clone(&file);
        for (id, models) in &adopted {
            dataset = Arc::new(models.put_into(&dataset, *id)?);
        }
        self.dataset = with_reversed_signs(&dataset, &signs)?;
        let is_changed = !adopted.is_empty() || !signs.is_empty();
        self.file_dataset = if is_changed { Some(file) } else { None };
        self.adopted = adopted;
        self.signs = signs;
        self.forget_absent_models();
        Ok(())
    }

    /// Drops decisions about identified models that the dataset no longer has, also in the
    /// variants.
    fn forget_absent_models(&mut self) {
        let dataset = Arc::clone(&self.dataset);
        let is_present = |id: ConditionId, name: &str| {
            dataset
                .condition(id)
                .is_some_and(|condition| condition.position(BundleKind::Identified, name).is_some())
        };
        for variant in &mut self.variants {
            for (id, choice) in &mut Arc::make_mut(variant).choices {
                choice.identified.retain(|name| is_present(*id, name));
            }
        }
        for (id, choice) in &mut self.choices {
            choice.identified.retain(|name| is_present(*id, name));
        }
    }

    /// Returns the channels with reversed sign, by name.
    pub fn reversed_channels(&self) -> Vec<ReversedChannel> {
        self.signs
            .iter()
            .map(|(channel, role)| ReversedChannel {
                channel: channel.name_in(&self.dataset),
                side: match channel {
                    Channel::Input(_) => ChannelSide::Input,
                    Channel::Output(_) => ChannelSide::Output,
                },
                role: *role,
            })
            .collect()
    }
}
