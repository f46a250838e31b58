//! Moves a study's physics models by its parameters' values (M18.5). Nothing else changes a physics
//! model for the stages that follow.
//!
//! ```text
//! 1  values: of the named parameters, fitted again with the others off; of all; or set by hand
//! 2  each condition: increments from its runs; conditions without a run keep their models
//! 3  each physics model with the states of the runs' base: A(z), B(z), C(z), D(z)
//! ```
//!
//! z is a parameter's change in *plausible* standard deviations, which say how far the parameter
//! may reasonably be from its value in the model; the increments are the changes of the matrices
//! with z. A run is a physics model linearised again with one parameter moved, its base the same
//! model without. A parameter is *named* if its interval excludes zero and it helps to predict
//! conditions left out (M18.4).

use std::collections::BTreeMap;
use std::sync::Arc;

use gdcm_method::physics::increments::NOTABLE_CURVATURE;
use gdcm_method::physics::{
    ConditionIncrements, MatchedRuns, OfferedParameter, ParameterValue, PhysicsDiagnosis,
    PhysicsError, PhysicsProblem, diagnose,
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
            let mover = ModelMover { study, sources };
            if key.correction == PhysicsCorrection::ByHand {
                return Ok(mover.move_by_hand());
            }
            let found = findings.get_or_fail(key.findings.clone(), |_| {
                find_parameters(study, sources, executor, progress)
            })?;
            let findings = match found {
                Ok(findings) => findings,
                Err(failure) => return Ok(Err(failure)),
            };
            let named_fit = match named_problem(study, &findings) {
                None => None,
                Some(problem) => match diagnose(&problem, executor, progress) {
                    Ok(fit) => Some(Arc::new(fit)),
                    Err(PhysicsError::Cancelled(cancelled)) => return Err(cancelled),
                    Err(error) => return Ok(Err(PhysicsFailure::Fit(error))),
                },
            };
            Ok(Ok(mover.move_by_fit(findings, named_fit)))
        })
    }
}

/// Returns the problem of the fit from which the values of the named parameters come: the other
/// parameters are held at 0, values set by hand stay. `None` if all parameters are applied, whose
/// values the diagnosis holds, and if no parameter is named or set by hand.
fn named_problem(study: &Study, findings: &PhysicsFindings) -> Option<PhysicsProblem> {
    if study.settings.physics != PhysicsCorrection::Named {
        return None;
    }
    let named = findings.diagnosis.named();
    let mut problem = findings.problem.clone();
    for (index, value) in problem.parameters.iter_mut().enumerate() {
        if *value == ParameterValue::Fitted && !named.contains(&index) {
            *value = ParameterValue::Held(0.0);
        }
    }
    let all_at_zero = problem
        .parameters
        .iter()
        .all(|value| *value == ParameterValue::Held(0.0));
    if all_at_zero { None } else { Some(problem) }
}

/// Moves a study's physics models.
struct ModelMover<'a> {
    study: &'a Study,
    sources: &'a [PhysicsSource],
}

impl ModelMover<'_> {
    /// Moves the models by the values set by hand (step 1; nothing is fitted).
    fn move_by_hand(&self) -> PhysicsOutcome {
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
        Ok(Arc::new(self.move_models(values)))
    }

    /// Moves the models by fitted values (step 1): by those in `named_fit` or, if all parameters
    /// are applied, by those in the diagnosis. No values if no parameter is named or set by hand.
    fn move_by_fit(
        &self,
        findings: Arc<PhysicsFindings>,
        named_fit: Option<Arc<PhysicsDiagnosis>>,
    ) -> Arc<AppliedPhysics> {
        let diagnosis = if self.study.settings.physics == PhysicsCorrection::Named {
            named_fit.as_deref()
        } else {
            Some(&findings.diagnosis)
        };
        let values = match diagnosis {
            Some(diagnosis) => fitted_values(&findings, diagnosis),
            None => Vec::new(),
        };
        let moved = self.move_models(values);
        Arc::new(AppliedPhysics {
            refit: named_fit,
            findings: Some(findings),
            ..moved
        })
    }

    /// Moves every condition's models by `values` that are not zero (steps 2 and 3).
    fn move_models(&self, mut values: Vec<AppliedValue>) -> AppliedPhysics {
        values.retain(|value| value.z != 0.0);
        let mut conditions = BTreeMap::new();
        let mut dataset = Arc::clone(&self.study.dataset);
        if !values.is_empty() {
            for source in self.sources {
                let outcome = match self.moved_condition(source, &values) {
                    Ok(moved) => {
                        if let Ok(with_moved) = dataset.with_condition(moved.condition) {
                            dataset = Arc::new(with_moved);
                        }
                        moved.outcome
                    }
                    Err(unmoved) => unmoved,
                };
                conditions.insert(source.condition.id(), outcome);
            }
        }
        AppliedPhysics {
            correction: self.study.settings.physics,
            findings: None,
            refit: None,
            values,
            unknown: self.unknown_parameters(),
            conditions,
            dataset,
        }
    }

    /// Returns the parameters with a value set by hand that the dataset lacks, by name.
    fn unknown_parameters(&self) -> Vec<String> {
        let offered = OfferedParameter::list(&self.study.dataset);
        let mut unknown = Vec::new();
        for name in self.study.settings.physics_parameters.by_hand.keys() {
            if offered.iter().all(|parameter| parameter.name != *name) {
                unknown.push(name.clone());
            }
        }
        unknown
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
            // Does not occur, because the models keep their names, roles and shapes. The dataset's
            // models would stay.
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

/// Returns the fitted values, in the order of the parameters that are on.
fn fitted_values(findings: &PhysicsFindings, diagnosis: &PhysicsDiagnosis) -> Vec<AppliedValue> {
    let mut values = Vec::new();
    for (index, parameter) in findings.parameters.iter().enumerate() {
        values.push(AppliedValue {
            parameter: parameter.clone(),
            z: diagnosis.fit.z[index],
            half_width_sd: diagnosis.parameters[index].half_width,
            is_by_hand: matches!(findings.problem.parameters[index], ParameterValue::Held(_)),
        });
    }
    values
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
