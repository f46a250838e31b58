//! The engineer's choices among a condition's models.
//!
//! A *bundle* contains a condition's physics models, or its identified models. A *rejected* model
//! neither represents its bundle nor counts in the scores of the models that are *kept*. The medoid
//! of the kept models, the one closest to the others, represents the bundle, unless a model is
//! *pinned* to represent it (M5).

use std::collections::{BTreeMap, BTreeSet};

use serde::{Deserialize, Serialize};

use gdcm_model::dataset::BundleKind;

/// The engineer's choices in a bundle.
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub struct BundleChoice {
    /// Rejected models, by name.
    pub rejected: BTreeSet<String>,
    /// Reasons for rejections, in the engineer's words, where given; studies saved by earlier
    /// versions have none.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub reasons: BTreeMap<String, String>,
    /// Name of the model that represents the bundle instead of the medoid; never a rejected model.
    pub pinned: Option<String>,
}

impl BundleChoice {
    /// Restores a model; the reason is removed with the rejection.
    pub(crate) fn restore(&mut self, name: &str) {
        self.rejected.remove(name);
        self.reasons.remove(name);
    }

    /// Drops the decisions about models for whose name `is_there` is false.
    pub(crate) fn retain(&mut self, is_there: impl Fn(&str) -> bool) {
        self.rejected.retain(|name| is_there(name));
        self.reasons.retain(|name, _| is_there(name));
        self.pinned = self.pinned.take().filter(|name| is_there(name));
    }
}

/// The engineer's choices in a condition.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct ConditionChoice {
    pub physics: BundleChoice,
    pub identified: BundleChoice,
    /// Whether the condition is chosen for the schedule, the fit of the corrections over airspeed.
    pub scheduled: bool,
    /// Whether the condition is held out: it is analysed and assessed, but not used to fit the
    /// schedule, couplings or physics parameters, which it can therefore validate.
    pub held_out: bool,
}

impl Default for ConditionChoice {
    fn default() -> Self {
        Self {
            physics: BundleChoice::default(),
            identified: BundleChoice::default(),
            scheduled: true,
            held_out: false,
        }
    }
}

impl ConditionChoice {
    /// Restores every rejected model in both bundles; pinned models remain pinned.
    pub(crate) fn restore_all(&mut self) {
        for choice in [&mut self.physics, &mut self.identified] {
            choice.rejected.clear();
            choice.reasons.clear();
        }
    }

    /// Returns the choices on which an analysis depends: all except the reasons for rejections.
    pub(crate) fn without_reasons(&self) -> Self {
        let mut choice = self.clone();
        choice.physics.reasons.clear();
        choice.identified.reasons.clear();
        choice
    }

    /// Returns the choices on which the model comparison depends: without reasons, and with the
    /// default membership in the schedule.
    pub(crate) fn of_models(&self) -> Self {
        Self {
            scheduled: true,
            held_out: false,
            ..self.without_reasons()
        }
    }

    /// Returns whether the condition is used to fit the schedule: chosen, and not held out.
    pub fn is_in_schedule(&self) -> bool {
        self.scheduled && !self.held_out
    }

    /// Returns the choices in a bundle.
    pub fn bundle(&self, kind: BundleKind) -> &BundleChoice {
        kind.pick(&self.physics, &self.identified)
    }

    /// Returns the choices in a bundle, for changes.
    pub fn bundle_mut(&mut self, kind: BundleKind) -> &mut BundleChoice {
        kind.pick(&mut self.physics, &mut self.identified)
    }
}
