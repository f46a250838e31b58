//! Frequency responses of a condition's models.
//!
//! ```text
//! KnownModels           responses of the models in use, by model content
//!   ConditionModels     the models of a condition, each with its cached responses
//!     ConditionResponses  their responses on one grid, in file order
//!       CoupledResponses  the responses of the physics models with couplings, computed on first use
//! ```
//!
//! `H` is a model's response, `H~ = (I - H K)^-1 H M~` the same with couplings: the mixing `M~` of
//! the inputs and the feedback `K` from outputs to inputs (M16.3).

use std::sync::{Arc, OnceLock};

use gdcm_model::dataset::model::ContentHash;
use gdcm_model::dataset::{BundleKind, Condition, Model};
use gdcm_model::progress::Cancelled;
use gdcm_model::response::{FrequencyGrid, FrequencyResponse};

use super::known_models::{GridKey, KnownModels, ModelResponses, Purpose};
use super::memo::Memo;
use crate::execution::Execution;
use crate::results::fitted_couplings::FittedCouplings;

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
    /// Each model's coupled response, filled on first use; shared by clones.
    cached: Arc<[OnceLock<Arc<FrequencyResponse>>]>,
}

impl CoupledResponses {
    /// Creates an empty cache for a bundle with this number of models.
    pub(crate) fn new(couplings: &Arc<FittedCouplings>, airspeed_kt: f64, models: usize) -> Self {
        let cached = (0..models).map(|_| OnceLock::new()).collect();
        Self {
            couplings: Arc::clone(couplings),
            airspeed_kt,
            cached,
        }
    }

    /// Returns a model's `H~`; `physics` is its uncoupled response.
    fn response(&self, model: usize, physics: &FrequencyResponse) -> Arc<FrequencyResponse> {
        let coupled = self.cached[model].get_or_init(|| {
            let matrices = self.couplings.matrices();
            Arc::new(matrices.response(physics, self.airspeed_kt))
        });
        Arc::clone(coupled)
    }
}

impl ConditionResponses {
    /// Returns a model's response for comparison and correction (M16.3): `H` for an identified
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

    /// Computes every model's responses in the band, without a cache.
    ///
    /// # Errors
    /// [`Cancelled`] where `execution` is cancelled.
    pub fn compute(
        condition: &Arc<Condition>,
        key: GridKey,
        execution: &Execution<'_>,
    ) -> Result<Self, Cancelled> {
        let models = ConditionModels::new(condition, &KnownModels::default());
        let grid = FrequencyGrid::logarithmic(key.0, key.1);
        models.responses(Purpose::Comparison, key, &grid, execution)
    }

    /// Returns the responses of a bundle's models, in file order.
    pub fn bundle(&self, kind: BundleKind) -> &[Arc<FrequencyResponse>] {
        kind.pick(&self.physics, &self.identified)
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
    /// Collects a condition's models; models in `known` keep their cached responses.
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
        self.hashed_models(kind)[model].content
    }

    /// Returns whether the bundles contain the same models with the same names, origins and
    /// dynamics in the same order.
    pub(crate) fn are_the_same_as(&self, other: &Self) -> bool {
        let have_equal_dynamics = BundleKind::BOTH.into_iter().all(|kind| {
            let own = self.hashed_models(kind).iter();
            own.map(|model| model.content)
                .eq(other.hashed_models(kind).iter().map(|model| model.content))
        });
        have_equal_dynamics
            && models_of(&self.condition)
                .zip(models_of(&other.condition))
                .all(|(a, b)| a.name == b.name && a.origin == b.origin)
    }

    /// Returns both bundles' responses: a bundle's from the cache if it holds them all, otherwise
    /// computed model by model; reports one progress step per model.
    ///
    /// # Errors
    /// [`Cancelled`] where `execution` is cancelled.
    pub(crate) fn responses(
        &self,
        purpose: Purpose,
        key: GridKey,
        grid: &FrequencyGrid,
        execution: &Execution<'_>,
    ) -> Result<ConditionResponses, Cancelled> {
        let identified =
            self.bundle_responses(BundleKind::Identified, purpose, key, grid, execution)?;
        let physics = self.bundle_responses(BundleKind::Physics, purpose, key, grid, execution)?;
        Ok(ConditionResponses {
            physics,
            identified,
            coupled: None,
        })
    }

    /// Returns a bundle's responses: from the cache if it holds them all, otherwise computed model
    /// by model; reports one progress step per model.
    fn bundle_responses(
        &self,
        kind: BundleKind,
        purpose: Purpose,
        key: GridKey,
        grid: &FrequencyGrid,
        execution: &Execution<'_>,
    ) -> Result<Vec<Arc<FrequencyResponse>>, Cancelled> {
        let hashed = self.hashed_models(kind);
        let cached: Option<Vec<Arc<FrequencyResponse>>> = hashed
            .iter()
            .map(|model| model.responses.last(purpose).kept(&key).cloned())
            .collect();
        if let Some(cached) = cached {
            execution.step(cached.len());
            return Ok(cached);
        }
        let models = self.condition.bundle(kind);
        execution.each(models.len(), 1, |index| {
            let responses = &hashed[index].responses;
            responses.response(&models[index], purpose, key, grid)
        })
    }

    /// Returns a bundle's models with their hashes.
    fn hashed_models(&self, kind: BundleKind) -> &[HashedModel] {
        let (physics, identified) = self
            .models
            .split_at(self.condition.bundle(BundleKind::Physics).len());
        match kind {
            BundleKind::Physics => physics,
            BundleKind::Identified => identified,
        }
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
