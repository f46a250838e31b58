//! Differences between two states of a dataset, and the inventory that detects them.
//!
//! A study is saved with the *inventory* of its dataset: airspeeds, and a fingerprint of each
//! model, by which a changed model is recognised without storing it. A decision is *carried* over
//! if it was made about an earlier state of the dataset, or about another dataset.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use serde::{Deserialize, Serialize};

use gdcm_model::dataset::{BundleKind, Condition, ConditionId, Dataset, ModelId};

use super::edit::Edit;
use super::edit_refusal::EditRefusal;
use super::requirement_settings::OutputRequirement;
use super::settings::ResponseMark;

/// A difference between a dataset and the dataset with which a study was made, or a decision that
/// does not apply to the dataset.
#[derive(Clone, Debug, PartialEq)]
pub enum Difference {
    /// The file has changed since the study was saved, and the study has no inventory of its former
    /// content.
    AnotherFile {
        /// SHA-256 of the file when the study was saved.
        expected: String,
        /// SHA-256 of the file now.
        found: String,
    },
    ConditionAdded(ConditionId),
    ConditionRemoved(ConditionId),
    AirspeedChanged {
        condition: ConditionId,
        /// Former airspeed \[kt\].
        before_kt: f64,
        /// Present airspeed \[kt\].
        now_kt: f64,
    },
    ModelAdded(ModelId),
    ModelRemoved(ModelId),
    /// A model's dynamics, bands, role or trim have changed.
    ModelChanged(ModelId),
    NotApplied {
        decision: CarriedDecision,
        /// Variant that contains the decision; `None` for the present decisions.
        variant: Option<String>,
        why: NotApplied,
    },
}

impl Difference {
    /// Returns the stable code, for programs and tests.
    pub fn code(&self) -> &'static str {
        match self {
            Self::AnotherFile { .. } => "another-file",
            Self::ConditionAdded(_) => "condition-added",
            Self::ConditionRemoved(_) => "condition-removed",
            Self::AirspeedChanged { .. } => "airspeed-changed",
            Self::ModelAdded(_) => "model-added",
            Self::ModelRemoved(_) => "model-removed",
            Self::ModelChanged(_) => "model-changed",
            Self::NotApplied { why, .. } => why.code(),
        }
    }
}

/// A decision that was carried over from another dataset.
#[derive(Clone, Debug, PartialEq)]
pub enum CarriedDecision {
    /// An edit, with the dataset that names its channels.
    Edit { edit: Edit, dataset: Arc<Dataset> },
    /// A marked response that the dataset lacks.
    Response {
        mark: ResponseMark,
        output: String,
        input: String,
    },
    /// A reversed channel that the dataset lacks.
    Sign { channel: String },
    /// A requirement setting for an output that the dataset lacks.
    Requirement(OutputRequirement),
}

/// Why a decision does not apply to a dataset.
#[derive(Clone, Debug, PartialEq)]
pub enum NotApplied {
    Refused(EditRefusal),
    /// The dataset lacks the channel to which a requirement setting belongs; the study keeps the
    /// setting.
    KeptForAnotherDataset,
    NoResponse,
    NoChannel,
}

impl NotApplied {
    /// Returns the stable code, for programs and tests.
    pub fn code(&self) -> &'static str {
        match self {
            Self::Refused(_) => "edit-refused",
            Self::KeptForAnotherDataset => "kept-for-another-dataset",
            Self::NoResponse => "no-response",
            Self::NoChannel => "no-channel",
        }
    }
}

/// Inventory of a dataset, small enough to be stored in a study file. It is compared with the
/// present dataset to report changes.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Inventory(pub Vec<ConditionInventory>);

impl Inventory {
    /// Takes a dataset's inventory, with a fingerprint for every model.
    pub fn from_dataset(dataset: &Dataset) -> Self {
        let conditions = dataset.conditions().iter();
        Self(
            conditions
                .map(|condition| ConditionInventory::new(condition))
                .collect(),
        )
    }

    fn by_id(&self) -> BTreeMap<ConditionId, &ConditionInventory> {
        self.0
            .iter()
            .map(|condition| (condition.id, condition))
            .collect()
    }

    /// Lists the differences between the dataset in this inventory and `dataset`.
    pub fn differences(&self, dataset: &Dataset) -> Vec<Difference> {
        let inventory_now = Inventory::from_dataset(dataset);
        let before = self.by_id();
        let now = inventory_now.by_id();
        let ids: BTreeSet<ConditionId> = before.keys().chain(now.keys()).copied().collect();
        let mut differences = Vec::new();
        for id in ids {
            match (before.get(&id), now.get(&id)) {
                (Some(before), Some(now)) => differences.extend(before.differences(now)),
                (Some(_), None) => differences.push(Difference::ConditionRemoved(id)),
                (None, _) => differences.push(Difference::ConditionAdded(id)),
            }
        }
        differences
    }
}

/// A condition's airspeed and its models: for each name, a fingerprint of dynamics, bands, role and
/// trim.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ConditionInventory {
    pub id: ConditionId,
    /// True airspeed \[kt\].
    pub airspeed_kt: f64,
    pub physics: BTreeMap<String, String>,
    pub identified: BTreeMap<String, String>,
}

impl ConditionInventory {
    fn new(condition: &Condition) -> Self {
        let fingerprints = |kind| {
            let models = condition.bundle(kind).iter();
            models
                .map(|model| (model.name.clone(), model.fingerprint()))
                .collect()
        };
        Self {
            id: condition.id(),
            airspeed_kt: condition.flight_state().airspeed_kt,
            physics: fingerprints(BundleKind::Physics),
            identified: fingerprints(BundleKind::Identified),
        }
    }

    /// Returns a bundle's models: their fingerprints by name.
    pub fn bundle(&self, kind: BundleKind) -> &BTreeMap<String, String> {
        kind.pick(&self.physics, &self.identified)
    }

    /// Lists the differences in airspeed and models.
    fn differences(&self, now: &Self) -> Vec<Difference> {
        let mut differences = Vec::new();
        if self.airspeed_kt != now.airspeed_kt {
            differences.push(Difference::AirspeedChanged {
                condition: self.id,
                before_kt: self.airspeed_kt,
                now_kt: now.airspeed_kt,
            });
        }
        for kind in BundleKind::BOTH {
            let before = self.bundle(kind);
            let now = now.bundle(kind);
            let names: BTreeSet<&String> = before.keys().chain(now.keys()).collect();
            for name in names {
                let id = ModelId::new(self.id, kind, name);
                match (before.get(name), now.get(name)) {
                    (Some(before), Some(now)) if before == now => {}
                    (Some(_), Some(_)) => differences.push(Difference::ModelChanged(id)),
                    (Some(_), None) => differences.push(Difference::ModelRemoved(id)),
                    (None, _) => differences.push(Difference::ModelAdded(id)),
                }
            }
        }
        differences
    }
}
