//! Jobs for drawing: a condition's responses, responses over the conditions, modes.
//!
//! A [`Job`] is a long computation in parallel to the interactive analysis. Jobs are equal if they
//! have the same output, so that a comparison leaves out what does not affect it; `Tools` are kept
//! from one job to the next.

use std::sync::Arc;

use gdcm_method::fidelity::{ModeTrack, mode_tracks};
use gdcm_model::dataset::{
    Band, BundleKind, Condition, ConditionId, Dataset, Model, ModelId, Pair,
};
use gdcm_model::progress::{Cancelled, Progress};
use gdcm_model::response::mode::{ModesError, modes_of};
use gdcm_model::response::{FrequencyGrid, FrequencyResponse, GainDelay, Mode, PreparedModel};

use super::job::Job;
use crate::execution::in_turn;
use crate::results::analysis::Analysis;
use crate::results::fitted_couplings::FittedCouplings;
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

/// Job that computes responses for selected models from any conditions, on a grid.
#[derive(Clone, Debug, PartialEq)]
pub struct AcrossJob {
    pub dataset: Shared<Dataset>,
    /// The dataset with the physics models moved by the physics parameters; the same as `dataset`
    /// if there are none.
    pub moved_dataset: Shared<Dataset>,
    /// The models; models that the dataset does not have are skipped.
    pub models: Vec<ModelId>,
    /// The couplings in the corrected physics models; `None` without couplings.
    pub couplings: Option<Arc<FittedCouplings>>,
    /// Band, and number of frequencies in it.
    pub grid: (Band, usize),
}

/// Model responses from several conditions.
#[derive(Clone, Debug, PartialEq)]
pub struct AcrossCurves {
    pub grid: FrequencyGrid,
    pub responses: Vec<AcrossModel>,
}

/// A model's response in one of several conditions.
#[derive(Clone, Debug, PartialEq)]
pub struct AcrossModel {
    pub model: ModelId,
    pub response: Arc<FrequencyResponse>,
    /// A physics model's response with physics parameters and couplings applied; `None` if neither
    /// is applied, and for an identified model.
    pub coupled: Option<Arc<FrequencyResponse>>,
}

impl AcrossCurves {
    /// Returns a model's response; `None` if it was not computed.
    pub fn model(&self, id: &ModelId) -> Option<&AcrossModel> {
        self.responses.iter().find(|found| found.model == *id)
    }
}

impl AcrossJob {
    /// Creates the job for every role's models in all conditions that have them.
    pub fn for_conditions(
        dataset: &Arc<Dataset>,
        analysis: Option<&Analysis>,
        grid: (Band, usize),
    ) -> Self {
        let mut models = Vec::new();
        for condition in dataset.conditions() {
            for role in AcrossRole::ALL {
                if let Some(model) = role.model(condition, analysis)
                    && !models.contains(&model)
                {
                    models.push(model);
                }
            }
        }
        let couplings = match analysis {
            Some(analysis) => analysis.fitted_couplings().cloned(),
            None => None,
        };
        let moved_dataset = match analysis {
            Some(analysis) => analysis.moved_dataset(),
            None => dataset,
        };
        Self {
            dataset: Arc::clone(dataset).into(),
            moved_dataset: Arc::clone(moved_dataset).into(),
            models,
            couplings,
            grid,
        }
    }

    /// Computes a model's response; `None` if the dataset does not have the model.
    fn response(&self, id: &ModelId, grid: &FrequencyGrid) -> Option<AcrossModel> {
        let condition = self.dataset.condition(id.condition)?;
        let model = condition.model(id.bundle, &id.name)?;
        let response = PreparedModel::new(&model.dynamics).response(grid);
        let response = Arc::new(response);
        Some(AcrossModel {
            coupled: self.response_before_gains(id, condition, &response, grid),
            model: id.clone(),
            response,
        })
    }

    /// Returns a physics model's response after the physics parameters and the couplings, to which
    /// gains and delays apply (M18.5); `None` for an identified model, or if neither changes the
    /// response.
    fn response_before_gains(
        &self,
        id: &ModelId,
        condition: &Condition,
        response: &Arc<FrequencyResponse>,
        grid: &FrequencyGrid,
    ) -> Option<Arc<FrequencyResponse>> {
        if id.bundle != BundleKind::Physics {
            return None;
        }
        let mut changed = None;
        if self.moved_dataset != self.dataset {
            let moved = self.moved_dataset.condition(id.condition)?;
            let model = moved.model(id.bundle, &id.name)?;
            let prepared = PreparedModel::new(&model.dynamics);
            changed = Some(Arc::new(prepared.response(grid)));
        }
        if let Some(fitted) = &self.couplings {
            let airspeed_kt = condition.flight_state().airspeed_kt;
            let plain = changed.as_ref().unwrap_or(response);
            changed = Some(Arc::new(fitted.matrices().response(plain, airspeed_kt)));
        }
        changed
    }
}

impl Job for AcrossJob {
    type Tools = ();
    type Output = Arc<AcrossCurves>;

    fn run(&self, (): &mut (), progress: &dyn Progress) -> Result<Self::Output, Cancelled> {
        let (band, points) = self.grid;
        let grid = FrequencyGrid::logarithmic(band, points);
        let responses = in_turn(&self.models, progress, |id| self.response(id, &grid))?;
        let responses = responses.into_iter().flatten().collect();
        Ok(Arc::new(AcrossCurves { grid, responses }))
    }
}

/// A model's role when one model is drawn for each condition in an overlay.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum AcrossRole {
    /// The identified model that represents its bundle.
    Identified,
    /// The physics representative under the schedule, at the condition's airspeed.
    Scheduled,
    /// The physics representative under the condition's own correction.
    Corrected,
    /// The physics model that represents its bundle.
    Representative,
    /// The physics model at the condition's own trim.
    Nominal,
}

impl AcrossRole {
    /// Every role, in list order.
    pub const ALL: [Self; 5] = [
        Self::Identified,
        Self::Scheduled,
        Self::Corrected,
        Self::Representative,
        Self::Nominal,
    ];

    /// Roles drawn initially: their difference shows how good the schedule is.
    pub const SHOWN_AT_FIRST: [Self; 2] = [Self::Identified, Self::Scheduled];

    /// Returns the role's name in lists and captions, such as "corrected".
    pub fn name(self) -> &'static str {
        match self {
            Self::Identified => "identified",
            Self::Scheduled => "scheduled",
            Self::Corrected => "corrected",
            Self::Representative => "representative",
            Self::Nominal => "nominal",
        }
    }

    /// Returns whether a correction, and before it the couplings, are applied to the model.
    pub fn is_corrected(self) -> bool {
        matches!(self, Self::Scheduled | Self::Corrected)
    }

    /// Returns the model with this role in a condition; `None` where the role needs a result that
    /// does not exist.
    pub fn model(self, condition: &Condition, analysis: Option<&Analysis>) -> Option<ModelId> {
        let id = condition.id();
        let kind = match self {
            Self::Identified => BundleKind::Identified,
            Self::Representative | Self::Corrected | Self::Scheduled => BundleKind::Physics,
            Self::Nominal => {
                let nominal = &condition.bundle(BundleKind::Physics)[condition.nominal()];
                return Some(ModelId::new(id, BundleKind::Physics, &nominal.name));
            }
        };
        let result = analysis?.condition(id)?;
        Some(ModelId::new(id, kind, result.representative_name(kind)))
    }

    /// Returns the correction applied to the model's response before drawing; `None` where its net
    /// gain is not positive, or there is no result or no schedule.
    pub fn correction(
        self,
        condition: &Condition,
        pair: Pair,
        analysis: Option<&Analysis>,
    ) -> Option<GainDelay> {
        match self {
            Self::Corrected => analysis?.condition(condition.id())?.correction.on(pair),
            Self::Scheduled => {
                let schedule = analysis?.schedule.as_ref().ok()?;
                schedule.at_state(condition.flight_state()).on(pair)
            }
            _ => Some(GainDelay::NONE),
        }
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
