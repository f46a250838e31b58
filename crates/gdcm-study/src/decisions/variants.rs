//! Variants: alternative decisions about a study's dataset, stored under names.

use std::sync::Arc;

use super::edit_refusal::{EditRefusal, check_length};
use super::study::{Study, Variant};

/// Maximum length of a variant name, in characters.
pub const LONGEST_VARIANT_NAME: usize = 60;

impl Study {
    /// Returns the variant with this name; `None` if there is none.
    pub fn variant(&self, name: &str) -> Option<&Variant> {
        self.variants
            .iter()
            .find(|variant| variant.name == name)
            .map(Arc::as_ref)
    }

    /// Returns the study with a variant's settings and choices instead of the present ones, and
    /// without variants, to be analysed for comparisons; `None` if there is no such variant.
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

    /// Stores the present decisions under a new name.
    pub(crate) fn store_variant(&mut self, name: &str) -> Result<(), EditRefusal> {
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

    /// Replaces the present decisions with a variant's decisions.
    pub(crate) fn apply_variant(&mut self, name: &str) -> Result<(), EditRefusal> {
        let index = self.variant_index(name)?;
        let Variant {
            settings, choices, ..
        } = self.variants[index].as_ref();
        let settings = settings.clone();
        let choices = choices.clone();
        self.settings = settings;
        self.choices = choices;
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
        if name.is_empty() {
            return Err(EditRefusal::VariantWithoutName);
        }
        let name = name.to_owned();
        if self.variant(&name).is_some() {
            return Err(EditRefusal::VariantExists { name });
        }
        Ok(name)
    }
}
