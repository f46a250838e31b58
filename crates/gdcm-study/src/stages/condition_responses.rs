//! Frequency responses of every model of a condition, each cached by its inputs.

use std::collections::HashMap;
use std::sync::{Arc, Mutex, MutexGuard, OnceLock, PoisonError, Weak};

use gdcm_method::correction::lead_price::ABOVE_BAND;
use gdcm_model::dataset::model::ContentHash;
use gdcm_model::dataset::{Band, BundleKind, Condition, Model};
use gdcm_model::progress::Cancelled;
use gdcm_model::response::{FrequencyGrid, FrequencyResponse, PreparedModel};

use super::execution::{Execution, Memo};
use super::fitted_couplings::FittedCouplings;
use crate::decisions::settings::{PhaseCorrection, Settings};
use crate::results::analysis::ConditionAnalysis;

/// Dependencies of a response besides the numbers of its model: the band and the number of
/// frequencies in it.
pub(crate) type GridKey = (Band, usize);

/// Purpose of a response. The last response for each purpose is cached.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Purpose {
    /// Comparison of models, in the band of comparison.
    Comparison,
    /// Drawing, in a wider band.
    Drawing,
}

/// Responses of every model of a condition on one grid.
#[derive(Clone, Debug, PartialEq)]
pub struct ConditionResponses {
    /// Responses of the physics models, in file order.
    pub physics: Vec<Arc<FrequencyResponse>>,
    /// Responses of the identified models, in file order.
    pub identified: Vec<Arc<FrequencyResponse>>,
    /// Responses of the physics models with couplings, where there are any.
    coupled: Option<CoupledResponses>,
}

/// Responses of the physics models of a condition with mixing and feedback (M16.3), each computed
/// on first use.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct CoupledResponses {
    couplings: Arc<FittedCouplings>,
    airspeed_kt: f64,
    made: Arc<[OnceLock<Arc<FrequencyResponse>>]>,
}

impl CoupledResponses {
    /// Creates an empty cache for this many models.
    pub(crate) fn new(couplings: &Arc<FittedCouplings>, airspeed_kt: f64, models: usize) -> Self {
        let made = (0..models).map(|_| OnceLock::new()).collect();
        Self {
            couplings: Arc::clone(couplings),
            airspeed_kt,
            made,
        }
    }
}

impl ConditionResponses {
    /// Returns the response of a model for comparison and correction: `H` of an identified model,
    /// `H~` of a physics model, equal to `H` without couplings (M16.3).
    pub(crate) fn compared(&self, kind: BundleKind, model: usize) -> Arc<FrequencyResponse> {
        let response = &self.bundle(kind)[model];
        match &self.coupled {
            Some(coupled) if kind == BundleKind::Physics => {
                let couple = || {
                    Arc::new(
                        coupled
                            .couplings
                            .matrices()
                            .response(response, coupled.airspeed_kt),
                    )
                };
                Arc::clone(coupled.made[model].get_or_init(couple))
            }
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

    /// Computes the responses of every model of `condition` on `points` frequencies of `band`.
    pub fn of(
        condition: &Arc<Condition>,
        (band, points): (Band, usize),
        execution: &Execution<'_>,
    ) -> Result<Self, Cancelled> {
        let models = ConditionModels::of(condition, &KnownModels::default());
        let grid = FrequencyGrid::logarithmic(band, points);
        models.responses(Purpose::Comparison, (band, points), &grid, execution)
    }

    /// Returns the responses of one bundle.
    pub fn bundle(&self, kind: BundleKind) -> &[Arc<FrequencyResponse>] {
        kind.pick(&self.physics, &self.identified)
    }
}

/// The last responses of one model, and the model prepared for them.
#[derive(Debug, Default)]
struct ModelResponses {
    prepared: OnceLock<PreparedModel>,
    /// The last response for each [`Purpose`].
    last: [Mutex<Memo<GridKey, Arc<FrequencyResponse>>>; 2],
}

impl ModelResponses {
    /// Locks the last response; a panic elsewhere cannot leave it incomplete.
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
            .get_or_init(|| PreparedModel::of(&model.dynamics));
        self.last(purpose)
            .get(key, |_| Arc::new(prepared.response(grid)))
    }
}

/// The models used by some condition of some engine, keyed by their numbers: a model that stays, or
/// returns under another name or in another place, keeps its responses. Engines of one study that
/// share them ([`super::engine::Engine::sharing`]) compute and store each only once.
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

    /// Removes the models that no condition uses any more.
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

/// The models of a condition with their responses.
#[derive(Clone, Debug)]
pub(crate) struct ConditionModels {
    condition: Arc<Condition>,
    /// Hash and responses of each model of both bundles, the physics models first.
    models: Vec<(ContentHash, Arc<ModelResponses>)>,
}

impl ConditionModels {
    /// Collects the models of `condition`; known models bring their responses.
    pub(crate) fn of(condition: &Arc<Condition>, known: &KnownModels) -> Self {
        let contents = models_of(condition).map(|model| ContentHash::new(&model.dynamics));
        let models = contents
            .map(|content| (content, known.responses_of(content)))
            .collect();
        Self {
            condition: Arc::clone(condition),
            models,
        }
    }

    /// Returns the condition.
    pub(crate) fn condition(&self) -> &Arc<Condition> {
        &self.condition
    }

    /// Returns the hash of the numbers of a model.
    pub(crate) fn content(&self, kind: BundleKind, model: usize) -> ContentHash {
        let before = if kind == BundleKind::Physics {
            0
        } else {
            self.condition.bundle(BundleKind::Physics).len()
        };
        self.models[before + model].0
    }

    /// Returns whether the bundles contain the same models, by name, origin and numbers, in the
    /// same order.
    pub(crate) fn are_the_same_as(&self, other: &Self) -> bool {
        let contents = |models: &Self| {
            models
                .models
                .iter()
                .map(|(content, _)| *content)
                .collect::<Vec<_>>()
        };
        let named = |condition| models_of(condition).map(|model| (&model.name, &model.origin));
        let physics = |models: &Self| models.condition.bundle(BundleKind::Physics).len();
        physics(self) == physics(other)
            && contents(self) == contents(other)
            && named(&self.condition).eq(named(&other.condition))
    }

    /// Computes the responses of every model, model by model; each is a step.
    pub(crate) fn responses(
        &self,
        purpose: Purpose,
        key: GridKey,
        grid: &FrequencyGrid,
        execution: &Execution<'_>,
    ) -> Result<ConditionResponses, Cancelled> {
        let physics = self.condition.bundle(BundleKind::Physics);
        let bundle = |models: &[Model], responses: &[(ContentHash, Arc<ModelResponses>)]| {
            let kept: Option<Vec<_>> = responses
                .iter()
                .map(|(_, responses)| responses.last(purpose).kept(&key).cloned())
                .collect();
            match kept {
                Some(kept) => {
                    execution.step(kept.len());
                    Ok(kept)
                }
                None => execution.each(models.len(), 1, |index| {
                    responses[index]
                        .1
                        .response(&models[index], purpose, key, grid)
                }),
            }
        };
        let (of_physics, of_identified) = self.models.split_at(physics.len());
        let identified = bundle(self.condition.bundle(BundleKind::Identified), of_identified)?;
        Ok(ConditionResponses {
            physics: bundle(physics, of_physics)?,
            identified,
            coupled: None,
        })
    }

    /// Drops the responses computed for drawing.
    pub(crate) fn forget_drawn(&self) {
        for (_, responses) in &self.models {
            *responses.last(Purpose::Drawing) = Memo::default();
        }
    }
}

fn models_of(condition: &Condition) -> impl Iterator<Item = &Model> {
    BundleKind::BOTH
        .into_iter()
        .flat_map(|kind| condition.bundle(kind))
}

/// Responses of every model of a condition on a grid for drawing.
#[derive(Debug)]
pub struct ConditionCurves {
    /// The condition; its models define the order of the responses.
    pub condition: Arc<Condition>,
    pub grid: FrequencyGrid,
    pub physics: Vec<Arc<FrequencyResponse>>,
    pub identified: Vec<Arc<FrequencyResponse>>,
    /// Coupled responses drawn last, with their inputs.
    coupled: Mutex<Vec<CoupledCurve>>,
}

/// The response of one physics model with couplings.
#[derive(Debug)]
struct CoupledCurve {
    fitted: Arc<FittedCouplings>,
    model: usize,
    response: Arc<FrequencyResponse>,
}

impl ConditionCurves {
    pub(crate) fn new(
        condition: Arc<Condition>,
        grid: FrequencyGrid,
        responses: ConditionResponses,
    ) -> Self {
        let ConditionResponses {
            physics,
            identified,
            ..
        } = responses;
        Self {
            condition,
            grid,
            physics,
            identified,
            coupled: Mutex::default(),
        }
    }

    /// Returns `H~` of a physics model under the couplings of a result; `H` without couplings.
    pub fn with_couplings(
        &self,
        result: &ConditionAnalysis,
        model: usize,
    ) -> Arc<FrequencyResponse> {
        /// A result and a variant, each with its representative now and before.
        const KEPT: usize = 4;
        let Some(coupled) = &result.coupled else {
            return Arc::clone(&self.physics[model]);
        };
        let mut kept = self.coupled.lock().unwrap_or_else(PoisonError::into_inner);
        let is_of =
            |of: &&CoupledCurve| Arc::ptr_eq(&of.fitted, &coupled.fitted) && of.model == model;
        if let Some(of) = kept.iter().find(is_of) {
            return Arc::clone(&of.response);
        }
        let response = Arc::new(result.coupled_response(&self.physics[model]).into_owned());
        kept.truncate(KEPT - 1);
        let fitted = Arc::clone(&coupled.fitted);
        kept.insert(
            0,
            CoupledCurve {
                fitted,
                model,
                response: Arc::clone(&response),
            },
        );
        response
    }

    /// Returns the responses of one bundle.
    pub fn bundle(&self, kind: BundleKind) -> &[Arc<FrequencyResponse>] {
        kind.pick(&self.physics, &self.identified)
    }
}

/// Number of frequencies of drawn curves.
pub const CURVE_POINTS: usize = 500;

/// Returns the band drawn around a band of comparison: wider by a factor of 1.7 on either side.
pub fn display_band(band: Band) -> Band {
    const MARGIN: f64 = 1.7;
    Band::beyond(band.min() / MARGIN, band.max() * MARGIN).unwrap_or(band)
}

/// Returns the band of a condition's curves: [`display_band`], and up to ten times the band where
/// leads are requested, to show their effect above it (M15.6).
pub fn curves_band(settings: &Settings) -> Band {
    let usual = display_band(settings.band);
    let has_leads = settings.phase == PhaseCorrection::Lead;
    let top = settings.band.max() * if has_leads { ABOVE_BAND } else { 1.0 };
    Band::beyond(usual.min(), usual.max().max(top)).unwrap_or(usual)
}
