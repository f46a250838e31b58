//! Responses of every model of a condition, each kept by what it is computed from.

use std::collections::HashMap;
use std::sync::{Arc, Mutex, MutexGuard, OnceLock, PoisonError, Weak};

use gdcm_method::correction::leads::ABOVE_BAND;
use gdcm_model::dataset::model::ContentHash;
use gdcm_model::dataset::{Band, BundleKind, Condition, Model};
use gdcm_model::progress::Cancelled;
use gdcm_model::response::{FrequencyGrid, FrequencyResponse, PreparedModel};

use super::analysis::ConditionAnalysis;
use super::execution::{Execution, Memo};
use super::fitted_couplings::FittedCouplings;
use super::settings::{PhaseCorrection, Settings};

/// What a response depends on besides the numbers of its model: the band and the number of frequencies in it.
pub(super) type GridKey = (Band, usize);

/// What a response is computed for. The last one for each is kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Purpose {
    /// Comparing models, in the band of comparison.
    Comparison,
    /// Drawing them, in a wider band.
    Drawing,
}

/// Responses of every model of a condition on one grid.
#[derive(Clone, Debug, PartialEq)]
pub struct ConditionResponses {
    /// Responses of the physics models, in file order.
    pub physics: Vec<Arc<FrequencyResponse>>,
    /// Responses of the identified models, in file order.
    pub identified: Vec<Arc<FrequencyResponse>>,
    /// Those of the physics models with couplings, where there are any.
    coupled: Option<CoupledResponses>,
}

/// Responses of the physics models of a condition with mixing and feedback (M16.3), each made when it is first asked for.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct CoupledResponses {
    couplings: Arc<FittedCouplings>,
    airspeed_kt: f64,
    made: Arc<[OnceLock<Arc<FrequencyResponse>>]>,
}

impl CoupledResponses {
    /// None made yet, of so many models.
    pub(super) fn new(couplings: &Arc<FittedCouplings>, airspeed_kt: f64, models: usize) -> Self {
        let made = (0..models).map(|_| OnceLock::new()).collect();
        Self {
            couplings: Arc::clone(couplings),
            airspeed_kt,
            made,
        }
    }
}

impl ConditionResponses {
    /// The response of a model as it is compared and corrected: `H` of an identified model, `H~` of a physics model, which is `H`
    /// where there are no couplings (M16.3).
    pub(super) fn compared(&self, kind: BundleKind, model: usize) -> Arc<FrequencyResponse> {
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

    /// The same with couplings.
    pub(super) fn with(self, coupled: CoupledResponses) -> Self {
        Self {
            coupled: Some(coupled),
            ..self
        }
    }

    /// The responses of every model of `condition` on `points` frequencies of `band`.
    pub fn of(
        condition: &Arc<Condition>,
        (band, points): (Band, usize),
        execution: &Execution<'_>,
    ) -> Result<Self, Cancelled> {
        let models = ConditionModels::of(condition, &KnownModels::default());
        let grid = FrequencyGrid::logarithmic(band, points);
        models.responses(Purpose::Comparison, (band, points), &grid, execution)
    }

    /// The responses of one bundle.
    pub fn bundle(&self, kind: BundleKind) -> &[Arc<FrequencyResponse>] {
        kind.pick(&self.physics, &self.identified)
    }
}

/// The last responses of one model, and what they start from.
#[derive(Debug, Default)]
struct ModelResponses {
    prepared: OnceLock<PreparedModel>,
    /// The last one for each [`Purpose`].
    last: [Mutex<Memo<GridKey, Arc<FrequencyResponse>>>; 2],
}

impl ModelResponses {
    /// A value is kept whole or not at all, whoever panicked.
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

/// The models that some condition of some engine holds, by their numbers: a model that stays, or comes back under another name or in
/// another place, keeps its responses. Engines of one study that share them ([`super::engine::Engine::sharing`]) compute and hold each once.
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

    /// Forgets the models that no condition holds any more.
    pub(super) fn forget_unused(&self) {
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
pub(super) struct ConditionModels {
    condition: Arc<Condition>,
    /// Hash and responses of each model of both bundles, the physics models first.
    models: Vec<(ContentHash, Arc<ModelResponses>)>,
}

impl ConditionModels {
    /// The models of `condition`; those that are known already bring their responses.
    pub(super) fn of(condition: &Arc<Condition>, known: &KnownModels) -> Self {
        let contents = models_of(condition).map(|model| ContentHash::of(&model.dynamics));
        let models = contents
            .map(|content| (content, known.responses_of(content)))
            .collect();
        Self {
            condition: Arc::clone(condition),
            models,
        }
    }

    /// The condition.
    pub(super) fn condition(&self) -> &Arc<Condition> {
        &self.condition
    }

    /// Hash of the numbers of a model.
    pub(super) fn content(&self, kind: BundleKind, model: usize) -> ContentHash {
        let before = if kind == BundleKind::Physics {
            0
        } else {
            self.condition.bundle(BundleKind::Physics).len()
        };
        self.models[before + model].0
    }

    /// Whether the bundles hold the same models, by name, origin and numbers, in the same order.
    pub(super) fn are_the_same_as(&self, other: &Self) -> bool {
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

    /// Responses of every model, model by model; each is a step.
    pub(super) fn responses(
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

    /// Lets go of what was computed for drawing.
    pub(super) fn forget_drawn(&self) {
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
    /// The condition: it names the models in whose order the responses are.
    pub condition: Arc<Condition>,
    /// The frequencies.
    pub grid: FrequencyGrid,
    /// Responses of the physics models.
    pub physics: Vec<Arc<FrequencyResponse>>,
    /// Responses of the identified models.
    pub identified: Vec<Arc<FrequencyResponse>>,
    /// Responses with couplings that were drawn last, with what they are of.
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
    pub(super) fn new(
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

    /// `H~` of a physics model under the couplings of a result; `H` without couplings.
    pub fn with_couplings(
        &self,
        result: &ConditionAnalysis,
        model: usize,
    ) -> Arc<FrequencyResponse> {
        /// Those of a result and of a variant, each of a representative now and before.
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

    /// The responses of one bundle.
    pub fn bundle(&self, kind: BundleKind) -> &[Arc<FrequencyResponse>] {
        kind.pick(&self.physics, &self.identified)
    }
}

/// Frequencies of drawn curves.
pub const CURVE_POINTS: usize = 500;

/// The band drawn around a band of comparison: a little more than half a decade's third on either side.
pub fn display_band(band: Band) -> Band {
    const MARGIN: f64 = 1.7;
    Band::beyond(band.min() / MARGIN, band.max() * MARGIN).unwrap_or(band)
}

/// The frequencies of the curves of a condition: [`display_band`], and up to ten times the band where leads are to show what they cost
/// above it (M15.6).
pub fn curves_band(settings: &Settings) -> Band {
    let usual = display_band(settings.band);
    let has_leads = settings.phase == PhaseCorrection::Lead;
    let top = settings.band.max() * if has_leads { ABOVE_BAND } else { 1.0 };
    Band::beyond(usual.min(), usual.max().max(top)).unwrap_or(usual)
}
