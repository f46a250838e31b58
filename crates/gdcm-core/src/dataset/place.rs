//! Where in a dataset something stands.

use std::fmt;

use super::identity::BundleKind;
use crate::message_text::quoted;

/// A condition of a dataset that is being read.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ConditionPlace {
    /// Its position, counted from 1.
    pub position: usize,
    /// Its id, where that can be read.
    pub id: Option<i64>,
}

/// A model of a dataset that is being read.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ModelPlace {
    /// Which bundle of the condition.
    pub bundle: BundleKind,
    /// Its position in the bundle, counted from 1.
    pub position: usize,
    /// Its name, where that can be read.
    pub name: Option<String>,
}

/// Where something stands: the condition, the model, and the entry (matrix, row, column), each where it applies.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Location {
    /// The condition.
    pub condition: Option<ConditionPlace>,
    /// The model.
    pub model: Option<ModelPlace>,
    /// The entry, in words; empty for the whole.
    pub entry: String,
}

impl Location {
    /// A place in words: "on-axis pair 3".
    pub fn entry(words: impl Into<String>) -> Self {
        Self { entry: words.into(), ..Self::default() }
    }

    /// A condition; `position` counts from 1.
    pub fn condition(position: usize, id: i64) -> Self {
        Self { condition: Some(ConditionPlace { position, id: Some(id) }), ..Self::default() }
    }

    /// A model of this condition; `position` counts from 1.
    pub fn model(&self, bundle: BundleKind, position: usize, name: &str) -> Self {
        let model = Some(ModelPlace { bundle, position, name: Some(name.to_owned()) });
        Self { condition: self.condition.clone(), model, entry: String::new() }
    }

    /// An entry of this condition or model.
    pub fn at(&self, words: impl Into<String>) -> Self {
        Self { entry: words.into(), ..self.clone() }
    }

    /// The place followed by a colon and a space; nothing for the file as a whole.
    pub fn before(&self) -> String {
        let words = self.to_string();
        if words.is_empty() { words } else { words + ": " }
    }
}

impl fmt::Display for Location {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let condition = self.condition.as_ref().map(|ConditionPlace { position, id }| match id {
            Some(id) => format!("condition {id} (number {position} in the file)"),
            None => format!("condition number {position} in the file"),
        });
        let model = self.model.as_ref().map(|ModelPlace { bundle, position, name }| match name {
            Some(name) => format!("{bundle} model {} (number {position})", quoted(name)),
            None => format!("{bundle} model number {position}"),
        });
        let entry = Some(self.entry.clone()).filter(|entry| !entry.is_empty());
        let words: Vec<String> = [condition, model, entry].into_iter().flatten().collect();
        formatter.write_str(&words.join(", "))
    }
}
