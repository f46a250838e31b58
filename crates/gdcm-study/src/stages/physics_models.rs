//! Moves a study's physics models by its parameters' values (M18.5). Nothing else changes a physics
//! model for the stages that follow.
//!
//! ```text
//! 1  values: of the named parameters, fitted again with the others off; of all; or set by hand
//! 2  each condition: increments from its runs; conditions without a run keep their models
//! 3  each physics model with the states of the runs' base: A(z), B(z), C(z), D(z)
//! ```
//!
//! z is a parameter's change in plausible standard deviations, the increments are the changes of
//! the matrices with z. A run is a physics model linearised again with one parameter moved, its
//! base the same model without. A parameter is *named* if its interval excludes zero and it helps
//! to predict conditions left out (M18.4).

use std::collections::BTreeMap;
use std::sync::Arc;

use gdcm_method::physics::increments::NOTABLE_CURVATURE;
use gdcm_method::physics::{
    ConditionIncrements, MatchedRuns, OfferedParameter, ParameterValue, PhysicsError, diagnose,
};
use gdcm_model::dataset::{BundleKind, Condition, Dynamics, Model};
use gdcm_model::executor::Executor;
use gdcm_model::progress::{Cancelled, Progress};

use super::memo::Memo;
use super::physics_fit::{FindingsKey, FindingsOutcome, PhysicsSource, find_parameters};
use crate::decisions::physics_settings::PhysicsCorrection;
use crate::decisions::study::Study;
use crate::results::applied_physics::{AppliedPhysics, AppliedValue};
use crate::results::moved_models::{BendingParameter, MovedModels, UnmovedModel};
use crate::results::physics_findings::{PhysicsFailure, PhysicsFindings};

/// The requested values and models, or why there are none.
pub(crate) type PhysicsOutcome = Result<Arc<AppliedPhysics>, PhysicsFailure>;

/// Inputs on which the moved models depend.
#[derive(Clone, Debug, PartialEq)]
struct AppliedKey {
    findings: FindingsKey,
    correction: PhysicsCorrection,
}

/// Last diagnosis, and last moved models.
#[derive(Clone, Debug, Default)]
pub(crate) struct PhysicsMemo {
    findings: Memo<FindingsKey, FindingsOutcome>,
    applied: Memo<AppliedKey, PhysicsOutcome>,
}

impl PhysicsMemo {
    /// Returns the moved models for the study's setting, computed where they are not cached.
    ///
    /// # Errors
    /// [`Cancelled`] soon after `progress` requests it.
    pub(crate) fn apply(
        &mut self,
        study: &Study,
        sources: &[PhysicsSource],
        executor: &dyn Executor,
        progress: &dyn Progress,
    ) -> Result<PhysicsOutcome, Cancelled> {
        let key = AppliedKey {
            findings: FindingsKey::new(study, sources),
            correction: study.settings.physics,
        };
        let findings = &mut self.findings;
        self.applied.get_or_fail(key, |key| {
            let application = Application {
                study,
                sources,
                executor,
                progress,
            };
            if key.correction == PhysicsCorrection::ByHand {
                return Ok(application.by_hand());
            }
            let found = findings.get_or_fail(key.findings.clone(), |_| {
                find_parameters(study, sources, executor, progress)
            })?;
            match found {
                Ok(found) => application.fitted(found),
                Err(failure) => Ok(Err(failure)),
            }
        })
    }
}

/// Data from which the moved models are made.
struct Application<'a> {
    study: &'a Study,
    sources: &'a [PhysicsSource],
    executor: &'a dyn Executor,
    progress: &'a dyn Progress,
}

impl Application<'_> {
    /// Moves the models by the values set by hand (step 1; nothing is fitted).
    fn by_hand(&self) -> PhysicsOutcome {
        let settings = &self.study.settings.physics_parameters;
        let parameters = settings.parameters(&self.study.dataset);
        if parameters.is_empty() {
            return Err(PhysicsFailure::NoRuns);
        }
        let mut values = Vec::new();
        for parameter in parameters {
            if let Some(change) = settings.by_hand.get(&parameter.name)
                && !settings.off.contains(&parameter.name)
            {
                values.push(AppliedValue {
                    z: change / parameter.plausible_sd,
                    half_width_sd: None,
                    is_by_hand: true,
                    parameter,
                });
            }
        }
        Ok(Arc::new(self.applied(values)))
    }

    /// Moves the models by fitted values (step 1):
    ///
    /// - all parameters: the values of the diagnosis;
    /// - named parameters: the values of another fit in which the others are held at 0 and values
    ///   set by hand stay; no values if no parameter is named or set by hand.
    fn fitted(&self, findings: Arc<PhysicsFindings>) -> Result<PhysicsOutcome, Cancelled> {
        let mut refit = None;
        if self.study.settings.physics == PhysicsCorrection::Named {
            let named = findings.diagnosis.named();
            let mut problem = findings.problem.clone();
            for (index, value) in problem.parameters.iter_mut().enumerate() {
                if *value == ParameterValue::Fitted && !named.contains(&index) {
                    *value = ParameterValue::Held(0.0);
                }
            }
            if !problem
                .parameters
                .iter()
                .all(|value| *value == ParameterValue::Held(0.0))
            {
                match diagnose(&problem, self.executor, self.progress) {
                    Ok(diagnosis) => refit = Some(Arc::new(diagnosis)),
                    Err(PhysicsError::Cancelled(cancelled)) => return Err(cancelled),
                    Err(error) => return Ok(Err(PhysicsFailure::Fit(error))),
                }
            }
        }
        let diagnosis = match (&refit, self.study.settings.physics) {
            (Some(refit), _) => Some(refit.as_ref()),
            (None, PhysicsCorrection::Named) => None,
            (None, _) => Some(&findings.diagnosis),
        };
        let mut values = Vec::new();
        if let Some(diagnosis) = diagnosis {
            for (index, parameter) in findings.parameters.iter().enumerate() {
                values.push(AppliedValue {
                    parameter: parameter.clone(),
                    z: diagnosis.fit.z[index],
                    half_width_sd: diagnosis.parameters[index].half_width,
                    is_by_hand: matches!(
                        findings.problem.parameters[index],
                        ParameterValue::Held(_)
                    ),
                });
            }
        }
        Ok(Ok(Arc::new(AppliedPhysics {
            refit,
            findings: Some(findings),
            ..self.applied(values)
        })))
    }

    /// Moves every condition's models by `values` that are not zero (steps 2 and 3).
    fn applied(&self, mut values: Vec<AppliedValue>) -> AppliedPhysics {
        values.retain(|value| value.z != 0.0);
        let mut conditions = BTreeMap::new();
        let mut dataset = Arc::clone(&self.study.dataset);
        if !values.is_empty() {
            for source in self.sources {
                let (moved, outcome) = match self.moved_condition(source, &values) {
                    Ok(moved) => (Some(moved.condition), moved.outcome),
                    Err(omission) => (None, omission),
                };
                if let Some(moved) = moved
                    && let Ok(with_moved) = dataset.with_condition(moved)
                {
                    dataset = Arc::new(with_moved);
                }
                conditions.insert(source.condition.id(), outcome);
            }
        }
        let known = OfferedParameter::list(&self.study.dataset);
        let settings = &self.study.settings.physics_parameters;
        let unknown = settings
            .by_hand
            .keys()
            .filter(|name| known.iter().all(|parameter| parameter.name != **name))
            .cloned()
            .collect();
        AppliedPhysics {
            correction: self.study.settings.physics,
            findings: None,
            refit: None,
            values,
            unknown,
            conditions,
            dataset,
        }
    }

    /// Moves a condition's physics models (steps 2 and 3); parameters whose effect is notably
    /// curved are listed.
    ///
    /// # Errors
    /// Why the condition keeps its models.
    fn moved_condition(
        &self,
        source: &PhysicsSource,
        values: &[AppliedValue],
    ) -> Result<MovedOutcome, MovedModels> {
        let parameters: Vec<OfferedParameter> =
            values.iter().map(|value| value.parameter.clone()).collect();
        let z: Vec<f64> = values.iter().map(|value| value.z).collect();
        let is_used = |model: &Model| source.uses(self.study, model);
        let matched = MatchedRuns::new(&source.condition, &parameters, &is_used);
        let increments = matched
            .increments(&parameters)
            .map_err(MovedModels::NotMoved)?;
        let mut bends = Vec::new();
        for (parameter, curvature) in parameters.iter().zip(increments.curvatures(&z)) {
            if curvature > NOTABLE_CURVATURE {
                bends.push(BendingParameter {
                    name: parameter.name.clone(),
                    curvature,
                });
            }
        }
        let MovedBundle { models, kept } = moved_bundle(&source.condition, &increments, &z);
        let condition = source.condition.with_physics(models).map_err(|_| {
            // The models keep names, roles and shapes; this cannot happen.
            MovedModels::Moved {
                kept: Vec::new(),
                bends: Vec::new(),
            }
        })?;
        Ok(MovedOutcome {
            condition,
            outcome: MovedModels::Moved { kept, bends },
        })
    }
}

/// A condition with moved models, and the models that keep their response.
struct MovedOutcome {
    condition: Condition,
    outcome: MovedModels,
}

/// A condition's physics models after the move, and those that keep their response.
struct MovedBundle {
    models: Vec<Model>,
    kept: Vec<UnmovedModel>,
}

/// Moves the physics models by z; a model that does not have the states of the runs' base is kept.
fn moved_bundle(condition: &Condition, increments: &ConditionIncrements, z: &[f64]) -> MovedBundle {
    let mut models = Vec::new();
    let mut kept = Vec::new();
    for model in condition.bundle(BundleKind::Physics) {
        let mut moved = model.clone();
        match increments.apply(model, z) {
            Ok(matrices) => moved.dynamics = Dynamics::StateSpace(matrices),
            Err(why) => kept.push(UnmovedModel {
                model: model.name.clone(),
                why,
            }),
        }
        models.push(moved);
    }
    MovedBundle { models, kept }
}
