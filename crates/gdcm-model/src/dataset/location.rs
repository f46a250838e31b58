//! Locations in a dataset, for messages about its faults.

use std::fmt;

use super::model_id::BundleKind;
use crate::message_text::quoted;

/// A condition's place in a dataset file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ConditionPlace {
    /// Position, counted from 1.
    pub position: usize,
    /// Condition identifier; `None` if it cannot be read.
    pub id: Option<i64>,
}

/// A model's place in a dataset file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ModelPlace {
    pub bundle: BundleKind,
    /// Position in the bundle, counted from 1.
    pub position: usize,
    /// Model name; `None` if it cannot be read.
    pub name: Option<String>,
}

/// A location in a dataset: condition, model, and entry (matrix, row, column), each if applicable.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Location {
    pub condition: Option<ConditionPlace>,
    pub model: Option<ModelPlace>,
    /// Entry, such as a matrix; empty if the location is the whole dataset, condition or model.
    pub entry: String,
}

impl Location {
    /// Creates the location of a dataset entry: "on-axis pair 3".
    pub fn entry(words: impl Into<String>) -> Self {
        Self {
            entry: words.into(),
            ..Self::default()
        }
    }

    /// Creates a condition's location; `position` counts from 1.
    pub fn condition(position: usize, id: i64) -> Self {
        Self {
            condition: Some(ConditionPlace {
                position,
                id: Some(id),
            }),
            ..Self::default()
        }
    }

    /// Returns a model's location in this condition; `position` counts from 1.
    pub fn model(&self, bundle: BundleKind, position: usize, name: &str) -> Self {
        let model = Some(ModelPlace {
            bundle,
            position,
            name: Some(name.to_owned()),
        });
        Self {
            condition: self.condition.clone(),
            model,
            entry: String::new(),
        }
    }

    /// Returns an entry's location in this condition or model: "matrix D".
    pub fn at(&self, words: impl Into<String>) -> Self {
        Self {
            entry: words.into(),
            ..self.clone()
        }
    }

    /// Returns the location followed by a colon and a space, to begin a message; empty for the
    /// whole file.
    pub fn before(&self) -> String {
        let place = self.to_string();
        if place.is_empty() {
            place
        } else {
            place + ": "
        }
    }
}

impl fmt::Display for Location {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut parts: Vec<String> = Vec::new();
        if let Some(condition) = &self.condition {
            parts.push(condition.to_string());
        }
        if let Some(model) = &self.model {
            parts.push(model.to_string());
        }
        if !self.entry.is_empty() {
            parts.push(self.entry.clone());
        }
        formatter.write_str(&parts.join(", "))
    }
}

impl fmt::Display for ConditionPlace {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let position = self.position;
        match self.id {
            Some(id) => write!(formatter, "condition {id} (number {position} in the file)"),
            None => write!(formatter, "condition at position {position} in the file"),
        }
    }
}

impl fmt::Display for ModelPlace {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let bundle = self.bundle;
        let position = self.position;
        match &self.name {
            Some(name) => write!(
                formatter,
                "{bundle} model {} (number {position})",
                quoted(name)
            ),
            None => write!(formatter, "{bundle} model number {position}"),
        }
    }
}
