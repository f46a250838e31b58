//! What conditions and models are called, whatever their order in a file, and where in a dataset something stands.

use std::fmt;

use serde::{Deserialize, Serialize};

use crate::message_text::quoted;
use crate::whole_number::whole;

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

/// Which of a condition's two bundles.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum BundleKind {
    /// The physics models: one nominal, the others at perturbed trims.
    Physics,
    /// The models identified from flight.
    Identified,
}

impl BundleKind {
    /// Both bundles, the physics models first.
    pub const BOTH: [BundleKind; 2] = [BundleKind::Physics, BundleKind::Identified];

    /// Which of two things is of this bundle.
    pub fn pick<T>(self, physics: T, identified: T) -> T {
        match self {
            BundleKind::Physics => physics,
            BundleKind::Identified => identified,
        }
    }
}

impl fmt::Display for BundleKind {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(match self {
            BundleKind::Physics => "physics",
            BundleKind::Identified => "identified",
        })
    }
}

/// A flight condition: the id that its dataset gives it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub struct ConditionId(#[serde(deserialize_with = "whole")] pub i64);

impl fmt::Display for ConditionId {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "{}", self.0)
    }
}

/// A model of a dataset: it stays the same model when others are added, removed, replaced or put in another order.
#[derive(Clone, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct ModelId {
    /// Its condition.
    pub condition: ConditionId,
    /// Its bundle in that condition.
    pub bundle: BundleKind,
    /// Its name in that bundle.
    pub name: String,
}

impl ModelId {
    /// The model of this name in a bundle of a condition.
    pub fn new(condition: ConditionId, bundle: BundleKind, name: impl Into<String>) -> Self {
        Self { condition, bundle, name: name.into() }
    }
}

impl fmt::Display for ModelId {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "condition {}, {} model \"{}\"", self.condition, self.bundle, self.name)
    }
}
