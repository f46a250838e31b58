//! Jobs for drawing a condition: its models' responses and modes.
//!
//! A [`Job`] is a long computation in parallel to the interactive analysis. Jobs are equal if they
//! have the same output, so that a comparison leaves out what does not affect it; `Tools` are kept
//! from one job to the next.

use std::sync::Arc;

use gdcm_method::fidelity::{ModeTrack, mode_tracks};
use gdcm_model::dataset::{Band, BundleKind, Condition, ConditionId, Dataset, Model};
use gdcm_model::progress::{Cancelled, Progress};
use gdcm_model::response::Mode;
use gdcm_model::response::mode::{ModesError, modes_of};

use super::job::Job;
use crate::execution::in_turn;
use crate::shared::Shared;
use crate::stages::condition_curves::ConditionCurves;
use crate::stages::engine::Engine;

/// Job that computes the frequency responses of a condition's models, for drawing.
#[derive(Clone, Debug, PartialEq)]
pub struct CurvesJob {
    pub dataset: Shared<Dataset>,
    pub condition: ConditionId,
    /// Band, and number of frequencies in it.
    pub grid: (Band, usize),
}

impl Job for CurvesJob {
    /// The engine that caches the prepared models.
    type Tools = Engine;
    /// `None` where the dataset does not have the condition.
    type Output = Option<Arc<ConditionCurves>>;

    fn run(&self, engine: &mut Engine, progress: &dyn Progress) -> Result<Self::Output, Cancelled> {
        engine.curves(&self.dataset, self.condition, self.grid, progress)
    }
}

/// Job that computes the modes of a condition's models.
#[derive(Clone, Debug, PartialEq)]
pub struct ModesJob {
    pub condition: Shared<Condition>,
}

impl Job for ModesJob {
    type Tools = ();
    type Output = Arc<ConditionModes>;

    fn run(&self, (): &mut (), progress: &dyn Progress) -> Result<Self::Output, Cancelled> {
        ConditionModes::compute(&self.condition, progress).map(Arc::new)
    }
}

/// A model's modes, none for a measured response; an error if they cannot be computed.
pub type ModelModes = Result<Vec<Mode>, ModesError>;

/// A condition's modes, model by model in file order.
#[derive(Clone, Debug, PartialEq)]
pub struct ConditionModes {
    /// Condition, whose models have the order of `physics` and `identified`.
    pub condition: Arc<Condition>,
    pub physics: Vec<ModelModes>,
    pub identified: Vec<ModelModes>,
}

impl ConditionModes {
    /// Computes the modes model by model; each model is a progress step.
    ///
    /// # Errors
    /// [`Cancelled`] between two models, where `progress` requests it.
    pub fn compute(condition: &Arc<Condition>, progress: &dyn Progress) -> Result<Self, Cancelled> {
        let models: Vec<&Model> = BundleKind::BOTH
            .into_iter()
            .flat_map(|kind| condition.bundle(kind))
            .collect();
        let mut physics = in_turn(&models, progress, |model| modes_of(&model.dynamics))?;
        let identified = physics.split_off(condition.bundle(BundleKind::Physics).len());
        Ok(Self {
            condition: Arc::clone(condition),
            physics,
            identified,
        })
    }

    /// Returns the modes of a bundle's models, in file order.
    pub fn bundle(&self, kind: BundleKind) -> &[ModelModes] {
        kind.pick(&self.physics, &self.identified)
    }

    /// Follows each mode through a bundle's models, starting from the model with index `reference`.
    /// Models without modes leave gaps.
    pub fn tracks(&self, kind: BundleKind, reference: usize) -> Vec<ModeTrack> {
        let modes = self
            .bundle(kind)
            .iter()
            .map(|modes| modes.as_deref().unwrap_or_default());
        mode_tracks(&modes.collect::<Vec<&[Mode]>>(), reference)
    }
}
