//! Identifiers for conditions, bundles and models in a dataset.

use std::fmt;

use serde::{Deserialize, Serialize};

use crate::whole_number::whole;

/// A model bundle in a flight condition.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum BundleKind {
    /// The physics models: one nominal, the others at perturbed trims.
    Physics,
    /// The models identified from flight tests.
    Identified,
}

impl BundleKind {
    /// Both bundles, the physics models first.
    pub const BOTH: [BundleKind; 2] = [BundleKind::Physics, BundleKind::Identified];

    /// Returns `physics` or `identified`, whichever belongs to this bundle.
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

/// A flight condition's identifier in its dataset.
#[derive(
    Clone, Copy, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize,
)]
pub struct ConditionId(#[serde(deserialize_with = "whole")] pub i64);

impl fmt::Display for ConditionId {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "{}", self.0)
    }
}

/// A model's identifier in a dataset, unaffected when other models are added, removed, replaced or
/// reordered.
#[derive(Clone, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct ModelId {
    pub condition: ConditionId,
    pub bundle: BundleKind,
    pub name: String,
}

impl ModelId {
    /// Creates the identifier for the model called `name` in a condition's bundle.
    pub fn new(condition: ConditionId, bundle: BundleKind, name: impl Into<String>) -> Self {
        Self {
            condition,
            bundle,
            name: name.into(),
        }
    }
}

impl fmt::Display for ModelId {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            formatter,
            "condition {}, {} model \"{}\"",
            self.condition, self.bundle, self.name
        )
    }
}
