//! Fits a study's physics parameters (M18.2).
//!
//! ```text
//! 1  match each condition's runs with bases; refuse runs whose base is rejected or set aside
//!    (M18.1)
//! 2  select the conditions that are not held out and have comparable representatives (M5)
//! 3  build the family of the physics representative, and compute the responses of the identified
//!    representative and of the other kept identified models, on the grid of the fit
//! 4  diagnose: parameter values, intervals, scores and a verdict          (`gdcm_method::physics`)
//! ```
//!
//! A run is a model with moved parameters, its base the same model without; the family is the
//! physics representative as a function of the parameters. There is no diagnosis without runs,
//! without a parameter that is switched on, without a usable condition, or if the fit fails
//! ([`PhysicsFailure`]).

use std::sync::Arc;

use gdcm_method::fidelity::CoherenceWeights;
use gdcm_method::fidelity::representative::Representative;
use gdcm_method::physics::problem::PhysicsOptions;
use gdcm_method::physics::{
    MatchedRuns, OfferedParameter, ParameterValue, PhysicsCondition, PhysicsError, PhysicsProblem,
    diagnose,
};
use gdcm_model::dataset::{BundleKind, Condition, Model, PairTable};
use gdcm_model::executor::Executor;
use gdcm_model::progress::{Cancelled, Progress};
use gdcm_model::response::{FrequencyGrid, FrequencyResponse, PreparedModel};

use super::coupling_fit::{Averaging, deviation};
use super::known_models::GridKey;
use crate::decisions::physics_settings::PhysicsSettings;
use crate::decisions::study::Study;
use crate::results::analysis::ConditionFailure;
use crate::results::comparison::Comparison;
use crate::results::physics_findings::{
    LeftOutData, NotFitted, OmittedCondition, PhysicsFailure, PhysicsFindings, RefusedConditionRun,
};

/// The diagnosis, or why there is none.
pub(crate) type FindingsOutcome = Result<Arc<PhysicsFindings>, PhysicsFailure>;

/// A condition, and the comparison of its models before parameters or couplings change them.
#[derive(Clone)]
pub(crate) struct PhysicsSource {
    pub(crate) condition: Arc<Condition>,
    pub(crate) is_held_out: bool,
    pub(crate) comparison: Result<Arc<Comparison>, ConditionFailure>,
}

impl PhysicsSource {
    /// Returns whether a physics model is neither rejected nor set aside (M5b). Without a
    /// comparison, which sets models aside, only rejected models are excluded.
    pub(crate) fn uses(&self, study: &Study, model: &Model) -> bool {
        let kind = BundleKind::Physics;
        match &self.comparison {
            Ok(comparison) => match self.condition.position(kind, &model.name) {
                Some(index) => comparison.physics.scores[index].is_some(),
                None => false,
            },
            Err(_) => {
                let rejected = &study.choice(self.condition.id()).physics.rejected;
                !rejected.contains(&model.name)
            }
        }
    }

    fn key(&self, study: &Study) -> ConditionKey {
        let representatives = match &self.comparison {
            Ok(comparison) => Some(Representatives {
                physics: comparison.physics.model,
                identified: comparison.identified.model,
                others: other_models(&comparison.identified),
                usable: usable(comparison),
            }),
            Err(_) => None,
        };
        let models = self.condition.bundle(BundleKind::Physics);
        ConditionKey {
            condition: Arc::clone(&self.condition),
            is_held_out: self.is_held_out,
            used: models.iter().map(|model| self.uses(study, model)).collect(),
            representatives,
        }
    }
}

/// Inputs from a condition on which the diagnosis and the moved physics models (`physics_models`)
/// depend.
#[derive(Clone, Debug)]
struct ConditionKey {
    condition: Arc<Condition>,
    is_held_out: bool,
    /// The physics models that are neither rejected nor set aside.
    used: Vec<bool>,
    representatives: Option<Representatives>,
}

impl PartialEq for ConditionKey {
    fn eq(&self, other: &Self) -> bool {
        let is_same_condition =
            Arc::ptr_eq(&self.condition, &other.condition) || self.condition == other.condition;
        is_same_condition
            && self.is_held_out == other.is_held_out
            && self.used == other.used
            && self.representatives == other.representatives
    }
}

/// A condition's compared models, by index.
#[derive(Clone, Debug, PartialEq)]
struct Representatives {
    physics: usize,
    identified: usize,
    /// The other kept identified models.
    others: Vec<usize>,
    usable: PairTable<bool>,
}

/// All inputs on which the diagnosis depends; the diagnosis is kept until they change.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct FindingsKey {
    settings: PhysicsSettings,
    parameters: Vec<OfferedParameter>,
    grid: GridKey,
    on_axis: PairTable<bool>,
    coherence: Option<f64>,
    averaging: Averaging,
    level: f64,
    conditions: Vec<ConditionKey>,
}

impl FindingsKey {
    pub(crate) fn new(study: &Study, sources: &[PhysicsSource]) -> Self {
        let settings = &study.settings;
        let physics = &settings.physics_parameters;
        Self {
            settings: physics.clone(),
            parameters: physics.parameters(&study.dataset),
            grid: (settings.band, physics.points),
            on_axis: study.dataset.on_axis().clone(),
            coherence: settings.coherence_threshold,
            averaging: Averaging::new(settings),
            level: settings.uncertainty.level,
            conditions: sources.iter().map(|source| source.key(study)).collect(),
        }
    }
}

/// Diagnoses the parameters that are switched on (steps 1 to 4), or returns why that is impossible.
///
/// # Errors
/// [`Cancelled`] soon after `progress` requests it.
pub(crate) fn find_parameters(
    study: &Study,
    sources: &[PhysicsSource],
    executor: &dyn Executor,
    progress: &dyn Progress,
) -> Result<FindingsOutcome, Cancelled> {
    let settings = &study.settings.physics_parameters;
    let offered = settings.parameters(&study.dataset);
    if offered.is_empty() {
        return Ok(Err(PhysicsFailure::NoRuns));
    }
    let parameters = settings.parameters_on(&study.dataset);
    if parameters.is_empty() {
        return Ok(Err(PhysicsFailure::AllOff));
    }
    let grid = FrequencyGrid::logarithmic(study.settings.band, settings.points);
    let mut fitting = Fitting {
        study,
        parameters: &parameters,
        omega: grid.omega().into(),
        left_out: LeftOutData::default(),
    };
    let mut conditions = Vec::new();
    for source in sources {
        conditions.extend(fitting.condition(source));
        if progress.cancelled() {
            return Err(Cancelled);
        }
    }
    let left_out = std::mem::take(&mut fitting.left_out);
    if conditions.is_empty() {
        return Ok(Err(PhysicsFailure::NoConditions(Box::new(left_out))));
    }
    // Step 4.
    let problem = fitting.problem(conditions);
    let diagnosis = match diagnose(&problem, executor, progress) {
        Ok(diagnosis) => diagnosis,
        Err(PhysicsError::Cancelled(cancelled)) => return Err(cancelled),
        Err(error) => return Ok(Err(PhysicsFailure::Fit(error))),
    };
    let mut off = offered;
    off.retain(|parameter| settings.off.contains(&parameter.name));
    Ok(Ok(Arc::new(PhysicsFindings {
        off,
        problem,
        diagnosis,
        left_out,
        parameters,
    })))
}

/// Collects the fit data from each condition.
struct Fitting<'a> {
    study: &'a Study,
    /// The parameters that are switched on.
    parameters: &'a [OfferedParameter],
    omega: Arc<[f64]>,
    left_out: LeftOutData,
}

impl Fitting<'_> {
    /// Returns a condition's data (steps 1 to 3); notes why the condition, or one of its runs, is
    /// left out.
    fn condition(&mut self, source: &PhysicsSource) -> Option<PhysicsCondition> {
        let id = source.condition.id();
        // Step 1.
        let is_used = |model: &Model| source.uses(self.study, model);
        let matched = MatchedRuns::new(&source.condition, self.parameters, &is_used);
        for run in &matched.refused {
            self.left_out.runs.push(RefusedConditionRun {
                condition: id,
                run: run.clone(),
            });
        }
        // Steps 2 and 3.
        match self.fitted_condition(source, &matched) {
            Ok(condition) => Some(condition),
            Err(why) => {
                self.left_out
                    .conditions
                    .push(OmittedCondition { condition: id, why });
                None
            }
        }
    }

    /// Returns a condition's data, or why the condition is left out: held out, not compared, or
    /// without usable runs (steps 2 and 3).
    fn fitted_condition(
        &self,
        source: &PhysicsSource,
        matched: &MatchedRuns<'_>,
    ) -> Result<PhysicsCondition, NotFitted> {
        // Step 2.
        if source.is_held_out {
            return Err(NotFitted::HeldOut);
        }
        let comparison = match &source.comparison {
            Ok(comparison) => comparison,
            Err(failure) => {
                return Err(NotFitted::NotCompared {
                    code: failure.code(),
                });
            }
        };
        // Step 3.
        let condition = &source.condition;
        let physics = &condition.bundle(BundleKind::Physics)[comparison.physics.model];
        let identified = &condition.bundle(BundleKind::Identified)[comparison.identified.model];
        let family = matched
            .family(physics, self.parameters, &self.omega)
            .map_err(NotFitted::Runs)?;
        let others = other_models(&comparison.identified)
            .into_iter()
            .map(|index| self.response(&condition.bundle(BundleKind::Identified)[index]))
            .collect();
        Ok(PhysicsCondition {
            id: condition.id(),
            family: Arc::new(family),
            flight: self.response(identified),
            others,
            usable: usable(comparison),
            deviation: deviation(self.study, identified, &self.omega),
            coherence: CoherenceWeights::of_model(
                &identified.dynamics,
                &self.omega,
                self.study.settings.coherence_threshold,
            ),
        })
    }

    fn response(&self, model: &Model) -> Arc<FrequencyResponse> {
        Arc::new(PreparedModel::new(&model.dynamics).at(&self.omega))
    }

    /// Builds the fit problem; a parameter set by hand is held at its value in plausible standard
    /// deviations, the others are fitted.
    fn problem(&self, conditions: Vec<PhysicsCondition>) -> PhysicsProblem {
        let settings = &self.study.settings.physics_parameters;
        let mut parameters = Vec::with_capacity(self.parameters.len());
        for parameter in self.parameters {
            parameters.push(match settings.by_hand.get(&parameter.name) {
                Some(change) => ParameterValue::Held(change / parameter.plausible_sd),
                None => ParameterValue::Fitted,
            });
        }
        PhysicsProblem {
            omega: Arc::clone(&self.omega),
            on_axis: self.study.dataset.on_axis().clone(),
            parameters,
            conditions,
            options: PhysicsOptions {
                gain_sd: settings.gain_sd,
                delay_sd_s: settings.delay_sd_s,
                level: self.study.settings.uncertainty.level,
                ..PhysicsOptions::default()
            },
        }
    }
}

/// Returns a bundle's kept models besides its representative.
fn other_models(representative: &Representative) -> Vec<usize> {
    let mut others = Vec::new();
    for (index, score) in representative.scores.iter().enumerate() {
        if score.is_some() && index != representative.model {
            others.push(index);
        }
    }
    others
}

/// Returns the responses with a mismatch between the representatives: both have the response, some
/// frequency counts, and the gain is in the computable range (M6, M6a).
fn usable(comparison: &Comparison) -> PairTable<bool> {
    comparison
        .representative
        .mismatch
        .map(|_, mismatch| mismatch.is_some())
}
