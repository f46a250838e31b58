//! Which conditions and models a dataset holds, and what each is told apart by.

use std::collections::BTreeMap;

use crate::dataset::{BundleKind, Condition, ConditionId, Dataset};

/// The models of one condition: name, and fingerprint of the numbers, the bands and the trim.
#[derive(Clone, Debug, PartialEq)]
pub struct ConditionInventory {
    /// True airspeed \[kt\].
    pub airspeed_kt: f64,
    /// The physics models.
    pub physics: BTreeMap<String, String>,
    /// The identified models.
    pub identified: BTreeMap<String, String>,
}

impl ConditionInventory {
    fn of(condition: &Condition) -> Self {
        let models = |kind| {
            let models = condition.bundle(kind).iter();
            models.map(|model| (model.name.clone(), model.fingerprint())).collect()
        };
        Self {
            airspeed_kt: condition.flight_state().airspeed_kt,
            physics: models(BundleKind::Physics),
            identified: models(BundleKind::Identified),
        }
    }

    /// The models of one bundle.
    pub fn bundle(&self, kind: BundleKind) -> &BTreeMap<String, String> {
        match kind {
            BundleKind::Physics => &self.physics,
            BundleKind::Identified => &self.identified,
        }
    }
}

/// What a dataset holds, small enough to stand in the file of a study: of it, a study tells what has changed since.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Inventory {
    /// Each condition.
    pub conditions: BTreeMap<ConditionId, ConditionInventory>,
}

impl Inventory {
    /// The inventory of a dataset.
    pub fn of(dataset: &Dataset) -> Self {
        let conditions = dataset.conditions().iter();
        Self { conditions: conditions.map(|condition| (condition.id(), ConditionInventory::of(condition))).collect() }
    }
}
