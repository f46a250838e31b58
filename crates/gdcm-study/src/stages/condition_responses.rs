//! A condition's frequency responses, each cached by its inputs.

use std::collections::HashMap;
use std::sync::{Arc, Mutex, MutexGuard, OnceLock, PoisonError, Weak};

use gdcm_model::dataset::model::ContentHash;
use gdcm_model::dataset::{Band, BundleKind, Condition, Model};
use gdcm_model::progress::Cancelled;
use gdcm_model::response::{FrequencyGrid, FrequencyResponse, PreparedModel};

use crate::execution::{Execution, Memo};
use crate::results::fitted_couplings::FittedCouplings;

/// Band and number of frequencies, on which a response depends besides the dynamics of its model.
pub type GridKey = (Band, usize);

/// Purpose of a response. The last response for each purpose is cached.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Purpose {
    /// Comparing models, in the comparison band.
    Comparison,
    /// Drawing, in a wider band.
    Drawing,
}

/// A condition's responses on a grid.
#[derive(Clone, Debug, PartialEq)]
pub struct ConditionResponses {
    /// The physics models' responses, in file order.
    pub physics: Vec<Arc<FrequencyResponse>>,
    /// The identified models' responses, in file order.
    pub identified: Vec<Arc<FrequencyResponse>>,
    /// The physics models' responses with couplings, where there are any.
    coupled: Option<CoupledResponses>,
}

/// A condition's physics responses with mixing and feedback (M16.3), each computed on first use.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct CoupledResponses {
    couplings: Arc<FittedCouplings>,
    airspeed_kt: f64,
    made: Arc<[OnceLock<Arc<FrequencyResponse>>]>,
}

impl CoupledResponses {
    /// Creates an empty cache for a bundle with this number of models.
    pub(crate) fn new(couplings: &Arc<FittedCouplings>, airspeed_kt: f64, models: usize) -> Self {
        let made = (0..models).map(|_| OnceLock::new()).collect();
        Self {
            couplings: Arc::clone(couplings),
            airspeed_kt,
            made,
        }
    }

    /// Returns `H~` of a model with the uncoupled response `physics`.
    fn response(&self, model: usize, physics: &FrequencyResponse) -> Arc<FrequencyResponse> {
        let coupled = self.made[model].get_or_init(|| {
            let matrices = self.couplings.matrices();
            Arc::new(matrices.response(physics, self.airspeed_kt))
        });
        Arc::clone(coupled)
    }
}

impl ConditionResponses {
    /// Returns the response of a model for comparison and correction (M16.3): `H` for an identified
    /// model, `H~` for a physics model (`H` without couplings).
    pub(crate) fn compared(&self, kind: BundleKind, model: usize) -> Arc<FrequencyResponse> {
        let response = &self.bundle(kind)[model];
        match &self.coupled {
            Some(coupled) if kind == BundleKind::Physics => coupled.response(model, response),
            _ => Arc::clone(response),
        }
    }

    /// Adds couplings to the responses.
    pub(crate) fn with(self, coupled: CoupledResponses) -> Self {
        Self {
            coupled: Some(coupled),
            ..self
        }
    }

    /// Computes the responses of every model in the band.
    pub fn of(
        condition: &Arc<Condition>,
        key: GridKey,
        execution: &Execution<'_>,
    ) -> Result<Self, Cancelled> {
        let models = ConditionModels::new(condition, &KnownModels::default());
        let grid = FrequencyGrid::logarithmic(key.0, key.1);
        models.responses(Purpose::Comparison, key, &grid, execution)
    }

    /// Returns the responses of the models of a bundle, in file order.
    pub fn bundle(&self, kind: BundleKind) -> &[Arc<FrequencyResponse>] {
        kind.pick(&self.physics, &self.identified)
    }
}

/// Last responses of a model, and the model prepared for their computation.
#[derive(Debug, Default)]
struct ModelResponses {
    prepared: OnceLock<PreparedModel>,
    /// The last response for each [`Purpose`].
    last: [Mutex<Memo<GridKey, Arc<FrequencyResponse>>>; 2],
}

impl ModelResponses {
    /// Locks the cache; a panic under the lock cannot leave it incomplete.
    fn last(&self, purpose: Purpose) -> MutexGuard<'_, Memo<GridKey, Arc<FrequencyResponse>>> {
        self.last[purpose as usize]
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
    }

    fn response(
        &self,
        model: &Model,
        purpose: Purpose,
        key: GridKey,
        grid: &FrequencyGrid,
    ) -> Arc<FrequencyResponse> {
        let prepared = self
            .prepared
            .get_or_init(|| PreparedModel::new(&model.dynamics));
        self.last(purpose)
            .get(key, |_| Arc::new(prepared.response(grid)))
    }
}

/// Responses of the models in use, keyed by the content of the model: a model keeps its responses
/// when it is renamed or moved to another condition. Engines that share them
/// ([`Engine::sharing`](super::engine::Engine::sharing)) compute and store each response only once.
#[derive(Clone, Debug, Default)]
pub struct KnownModels {
    by_content: Arc<Mutex<HashMap<ContentHash, Weak<ModelResponses>>>>,
}

impl KnownModels {
    fn by_content(&self) -> MutexGuard<'_, HashMap<ContentHash, Weak<ModelResponses>>> {
        self.by_content
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
    }

    /// Removes the models that no condition uses any longer.
    pub(crate) fn forget_unused(&self) {
        self.by_content()
            .retain(|_, responses| responses.strong_count() > 0);
    }

    fn responses_of(&self, content: ContentHash) -> Arc<ModelResponses> {
        let mut by_content = self.by_content();
        let known = by_content.entry(content).or_default();
        known.upgrade().unwrap_or_else(|| {
            let made = Arc::new(ModelResponses::default());
            *known = Arc::downgrade(&made);
            made
        })
    }
}

/// A condition's models with their responses.
#[derive(Clone, Debug)]
pub(crate) struct ConditionModels {
    condition: Arc<Condition>,
    /// Both bundles' models, the physics models first.
    models: Vec<HashedModel>,
}

/// A model's hash, and its responses.
#[derive(Clone, Debug)]
struct HashedModel {
    content: ContentHash,
    responses: Arc<ModelResponses>,
}

impl ConditionModels {
    /// Collects the models of a condition; models in `known` keep their cached responses.
    pub(crate) fn new(condition: &Arc<Condition>, known: &KnownModels) -> Self {
        let models = models_of(condition)
            .map(|model| {
                let content = ContentHash::new(&model.dynamics);
                HashedModel {
                    content,
                    responses: known.responses_of(content),
                }
            })
            .collect();
        Self {
            condition: Arc::clone(condition),
            models,
        }
    }

    pub(crate) fn condition(&self) -> &Arc<Condition> {
        &self.condition
    }

    /// Returns the hash of a model's dynamics.
    pub(crate) fn content(&self, kind: BundleKind, model: usize) -> ContentHash {
        let before = if kind == BundleKind::Physics {
            0
        } else {
            self.condition.bundle(BundleKind::Physics).len()
        };
        self.models[before + model].content
    }

    /// Returns whether the bundles contain the same models with the same names, origins and
    /// dynamics in the same order.
    pub(crate) fn are_the_same_as(&self, other: &Self) -> bool {
        let [own, others] = [self, other].map(|models| {
            let contents: Vec<ContentHash> =
                models.models.iter().map(|model| model.content).collect();
            let physics = models.condition.bundle(BundleKind::Physics).len();
            (physics, contents)
        });
        own == others
            && models_of(&self.condition)
                .zip(models_of(&other.condition))
                .all(|(a, b)| a.name == b.name && a.origin == b.origin)
    }

    /// Computes the responses of every model in turn; reports one progress step per model.
    pub(crate) fn responses(
        &self,
        purpose: Purpose,
        key: GridKey,
        grid: &FrequencyGrid,
        execution: &Execution<'_>,
    ) -> Result<ConditionResponses, Cancelled> {
        let (physics, identified) = self
            .models
            .split_at(self.condition.bundle(BundleKind::Physics).len());
        let bundle = |kind, hashed: &[HashedModel]| {
            let models = self.condition.bundle(kind);
            let kept: Option<Vec<Arc<FrequencyResponse>>> = hashed
                .iter()
                .map(|model| model.responses.last(purpose).kept(&key).cloned())
                .collect();
            if let Some(kept) = kept {
                execution.step(kept.len());
                return Ok(kept);
            }
            execution.each(models.len(), 1, |index| {
                let responses = &hashed[index].responses;
                responses.response(&models[index], purpose, key, grid)
            })
        };
        let identified = bundle(BundleKind::Identified, identified)?;
        Ok(ConditionResponses {
            physics: bundle(BundleKind::Physics, physics)?,
            identified,
            coupled: None,
        })
    }

    /// Drops the responses that were computed for drawing.
    pub(crate) fn forget_drawn(&self) {
        for model in &self.models {
            *model.responses.last(Purpose::Drawing) = Memo::default();
        }
    }
}

fn models_of(condition: &Condition) -> impl Iterator<Item = &Model> {
    BundleKind::BOTH
        .into_iter()
        .flat_map(|kind| condition.bundle(kind))
}
