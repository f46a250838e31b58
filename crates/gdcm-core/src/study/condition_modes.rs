//! The modes of every model of a condition.

use std::sync::Arc;

use crate::dataset::{BundleKind, Condition};
use crate::fidelity::{ModeTrack, mode_tracks};
use crate::response::{Mode, ModesError, modes_of};

use super::progress::{Cancelled, Progress};

/// The modes of one model; none of a measured response.
pub type ModelModes = Result<Vec<Mode>, ModesError>;

/// The modes of every model of a condition, in file order.
#[derive(Clone, Debug, PartialEq)]
pub struct ConditionModes {
    /// The condition: it names the models.
    pub condition: Arc<Condition>,
    /// Modes of the physics models.
    pub physics: Vec<ModelModes>,
    /// Modes of the identified models.
    pub identified: Vec<ModelModes>,
}

impl ConditionModes {
    /// The modes of every model, model by model; each is a step.
    ///
    /// # Errors
    /// [`Cancelled`] between two models, where `progress` says so.
    pub fn of(condition: &Arc<Condition>, progress: &dyn Progress) -> Result<Self, Cancelled> {
        let total = BundleKind::BOTH.into_iter().map(|kind| condition.bundle(kind).len()).sum();
        let mut done = 0;
        let mut of_bundle = |kind| {
            let mut found = Vec::with_capacity(condition.bundle(kind).len());
            for model in condition.bundle(kind) {
                if progress.cancelled() {
                    return Err(Cancelled);
                }
                found.push(modes_of(&model.dynamics));
                done += 1;
                progress.advanced(done, total);
            }
            Ok(found)
        };
        let (physics, identified) = (of_bundle(BundleKind::Physics)?, of_bundle(BundleKind::Identified)?);
        Ok(Self { condition: Arc::clone(condition), physics, identified })
    }

    /// The modes of one bundle.
    pub fn bundle(&self, kind: BundleKind) -> &[ModelModes] {
        match kind {
            BundleKind::Physics => &self.physics,
            BundleKind::Identified => &self.identified,
        }
    }

    /// Each mode of the model of index `reference` followed through its bundle. A model without modes leaves gaps.
    pub fn tracks(&self, kind: BundleKind, reference: usize) -> Vec<ModeTrack> {
        let modes = self.bundle(kind).iter().map(|modes| modes.as_deref().unwrap_or_default());
        mode_tracks(&modes.collect::<Vec<&[Mode]>>(), reference)
    }
}
