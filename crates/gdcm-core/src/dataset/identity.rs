//! What conditions and models are called, whatever their order in a file.

use std::fmt;

use serde::{Deserialize, Serialize};

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
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub struct ConditionId(pub i64);

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
