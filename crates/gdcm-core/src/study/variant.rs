//! Decisions kept under a name, to come back to and to compare with.

use std::collections::BTreeMap;
use std::sync::Arc;

use crate::dataset::ConditionId;

use super::document::{ConditionChoice, Study};
use super::edit::{EditRefusal, check_length};
use super::settings::Settings;

/// Characters that the name of a variant may have.
pub const LONGEST_VARIANT_NAME: usize = 60;

/// All decisions of a study at one time, under a name.
#[derive(Clone, Debug, PartialEq)]
pub struct Variant {
    /// The name, unique in its study.
    pub name: String,
    /// Every setting.
    pub settings: Settings,
    /// Choices in each condition.
    pub choices: BTreeMap<ConditionId, ConditionChoice>,
}

impl Study {
    /// The variant of this name.
    pub fn variant(&self, name: &str) -> Option<&Variant> {
        self.variants.iter().find(|variant| variant.name == name).map(Arc::as_ref)
    }

    /// The study with the decisions of one of its variants in place of the present ones, and no variants of its own: what is
    /// analysed to compare them.
    pub fn of_variant(&self, name: &str) -> Option<Study> {
        let Variant { settings, choices, .. } = self.variant(name)?;
        let dataset = Arc::clone(&self.dataset);
        Some(Study {
            dataset,
            settings: settings.clone(),
            choices: choices.clone(),
            variants: Vec::new(),
            taken: self.taken.clone(),
        })
    }

    pub(super) fn keep_variant(&mut self, name: &str) -> Result<(), EditRefusal> {
        let name = self.new_variant_name(name)?;
        let (settings, choices) = (self.settings.clone(), self.choices.clone());
        self.variants.push(Arc::new(Variant { name, settings, choices }));
        Ok(())
    }

    pub(super) fn take_variant(&mut self, name: &str) -> Result<(), EditRefusal> {
        let index = self.variant_index(name)?;
        let Variant { settings, choices, .. } = self.variants[index].as_ref();
        (self.settings, self.choices) = (settings.clone(), choices.clone());
        Ok(())
    }

    pub(super) fn remove_variant(&mut self, name: &str) -> Result<(), EditRefusal> {
        let index = self.variant_index(name)?;
        self.variants.remove(index);
        Ok(())
    }

    pub(super) fn rename_variant(&mut self, from: &str, to: &str) -> Result<(), EditRefusal> {
        let index = self.variant_index(from)?;
        if from == to.trim() {
            return Ok(());
        }
        let name = self.new_variant_name(to)?;
        self.variants[index] = Arc::new(Variant { name, ..self.variants[index].as_ref().clone() });
        Ok(())
    }

    fn variant_index(&self, name: &str) -> Result<usize, EditRefusal> {
        let index = self.variants.iter().position(|variant| variant.name == name);
        index.ok_or_else(|| EditRefusal::NoVariant { name: name.to_owned() })
    }

    fn new_variant_name(&self, name: &str) -> Result<String, EditRefusal> {
        let name = name.trim();
        check_length("name of a variant", name, LONGEST_VARIANT_NAME)?;
        match (name.is_empty(), self.variant(name)) {
            (true, _) => Err(EditRefusal::VariantWithoutName),
            (_, Some(_)) => Err(EditRefusal::VariantExists { name: name.to_owned() }),
            (_, None) => Ok(name.to_owned()),
        }
    }
}
