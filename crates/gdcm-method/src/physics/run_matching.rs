//! Matches a condition's runs with their bases (step 1 in `physics`, M18.1). A *run* is a physics
//! model linearised with one parameter moved.
//!
//! A run's base is the condition's physics model with equal perturbation values; if there are
//! several, the nominal model, or else the first. Run and base must have the same states in the
//! same order, the same channels, sample time and delays.
//!
//! ```text
//! 1  each run of an offered parameter: find its base, check that both fit together  (checked_run)
//! 2  compare it with the parameter's earlier runs: other step, other matrices, at most two
//! 3  keep the run, or refuse it with the first fault found
//! 4  increments, or the family of the representative, from the runs that are kept
//! ```

use std::collections::BTreeMap;

use gdcm_model::dataset::physics_parameter::ParameterChange;
use gdcm_model::dataset::{BundleKind, Condition, Model, StateSpace};

use super::family::ModelFamily;
use super::increments::{ConditionIncrements, IncrementError, RunStep, model_shape};
use super::offered_parameter::OfferedParameter;
use super::run_refusal::{RefusedRun, RunRefusal};

/// Maximum number of runs for a parameter in a condition: two determine a linear and a quadratic
/// change, and the formulas use no more.
const MOST_RUNS: usize = 2;

/// A run with its base.
#[derive(Clone, Copy, Debug)]
pub struct MatchedRun<'a> {
    /// The model with the parameter moved.
    pub model: &'a Model,
    /// The physics model at the same trim.
    pub base: &'a Model,
    pub change: &'a ParameterChange,
    run_matrices: &'a StateSpace,
    base_matrices: &'a StateSpace,
}

/// A condition's usable and unusable runs.
#[derive(Clone, Debug, Default)]
pub struct MatchedRuns<'a> {
    /// In file order, at most two per parameter.
    pub runs: Vec<MatchedRun<'a>>,
    pub refused: Vec<RefusedRun>,
}

/// Why a condition takes no part in the fit.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ConditionOmission {
    /// The condition has no usable run.
    #[error("no physics model linearised with a parameter changed can be used")]
    NoRuns,
    /// A parameter that is switched on has no usable run.
    #[error("no physics model linearised with \"{parameter}\" changed can be used")]
    MissingRun { parameter: String },
    /// The runs do not give increments.
    #[error(transparent)]
    Increments(#[from] IncrementError),
}

impl ConditionOmission {
    /// Returns the stable code used in files.
    pub fn code(&self) -> &'static str {
        match self {
            Self::NoRuns => "condition-without-runs",
            Self::MissingRun { .. } => "condition-lacks-run",
            Self::Increments(error) => error.code(),
        }
    }
}

impl<'a> MatchedRuns<'a> {
    /// Matches a condition's runs with their bases. `is_used` returns whether a physics model is
    /// neither rejected nor set aside (M5b); runs for parameters that are not in `parameters` are
    /// skipped.
    pub fn new(
        condition: &'a Condition,
        parameters: &[OfferedParameter],
        is_used: &dyn Fn(&Model) -> bool,
    ) -> Self {
        let mut matched = Self::default();
        for moved in condition.moved_models() {
            // A rerun at proposed values is only compared with the prediction for these values.
            let Some(change) = moved.run() else {
                continue;
            };
            let Some(parameter) = parameters
                .iter()
                .find(|parameter| parameter.name == change.name)
            else {
                continue;
            };
            // Steps 1 and 2
            let run = checked_run(condition, &moved.model, change, parameter, is_used)
                .and_then(|run| matched.check_earlier_runs(run));
            // Step 3
            match run {
                Ok(run) => matched.runs.push(run),
                Err(reason) => matched.refused.push(RefusedRun {
                    model: moved.model.name.clone(),
                    parameter: change.name.clone(),
                    reason,
                }),
            }
        }
        matched
    }

    /// Step 2: checks a run against earlier runs for the same parameter.
    fn check_earlier_runs(&self, run: MatchedRun<'a>) -> Result<MatchedRun<'a>, RunRefusal> {
        let mut count = 0;
        for earlier in &self.runs {
            if earlier.change.name != run.change.name {
                continue;
            }
            count += 1;
            let other = earlier.model.name.clone();
            if earlier.change.delta == run.change.delta {
                let delta = run.change.delta;
                return Err(RunRefusal::StepRepeated { other, delta });
            }
            if earlier.run_matrices == run.run_matrices {
                return Err(RunRefusal::MatricesRepeated { other });
            }
        }
        if count >= MOST_RUNS {
            return Err(RunRefusal::TooMany);
        }
        Ok(run)
    }

    /// Step 4: computes the condition's increments, ordered as `parameters`.
    ///
    /// # Errors
    /// [`ConditionOmission`] if the condition or a parameter has no run, or if the runs give no
    /// increments.
    pub fn increments(
        &self,
        parameters: &[OfferedParameter],
    ) -> Result<ConditionIncrements, ConditionOmission> {
        let Some(first) = self.runs.first() else {
            return Err(ConditionOmission::NoRuns);
        };
        Ok(ConditionIncrements::new(
            first.base,
            &self.steps(parameters)?,
        )?)
    }

    /// Step 4: computes the family for the condition's representative: by matrices if it has the
    /// same states as the base, otherwise by responses on the grid `omega` \[rad/s\].
    ///
    /// # Errors
    /// As for [`Self::increments`].
    pub fn family(
        &self,
        representative: &Model,
        parameters: &[OfferedParameter],
        omega: &[f64],
    ) -> Result<ModelFamily, ConditionOmission> {
        let increments = self.increments(parameters)?;
        if let Some(family) = ModelFamily::from_matrices(representative, &increments) {
            return Ok(family);
        }
        let steps = self.steps(parameters)?;
        ModelFamily::from_responses(representative, &steps, omega).ok_or(ConditionOmission::NoRuns)
    }

    /// Returns each parameter's runs, with steps in plausible standard deviations.
    fn steps(
        &self,
        parameters: &[OfferedParameter],
    ) -> Result<Vec<Vec<RunStep<'a>>>, ConditionOmission> {
        let mut steps = Vec::with_capacity(parameters.len());
        for parameter in parameters {
            let mut runs = Vec::new();
            for run in &self.runs {
                if run.change.name == parameter.name {
                    runs.push(RunStep {
                        z: run.change.delta / parameter.plausible_sd,
                        base: run.base_matrices,
                        run: run.run_matrices,
                    });
                }
            }
            if runs.is_empty() {
                return Err(ConditionOmission::MissingRun {
                    parameter: parameter.name.clone(),
                });
            }
            steps.push(runs);
        }
        Ok(steps)
    }
}

/// Step 1: finds a run's base, and checks that both fit together. The first fault counts: step,
/// unit, base, use of the base, matrices, shape and states, timing, and matrices that do not
/// change.
fn checked_run<'a>(
    condition: &'a Condition,
    model: &'a Model,
    change: &'a ParameterChange,
    parameter: &OfferedParameter,
    is_used: &dyn Fn(&Model) -> bool,
) -> Result<MatchedRun<'a>, RunRefusal> {
    if !change.delta.is_finite() || change.delta == 0.0 {
        let delta = change.delta;
        return Err(RunRefusal::Step { delta });
    }
    if change.unit != parameter.unit {
        return Err(RunRefusal::Unit {
            expected: parameter.unit.clone(),
            found: change.unit.clone(),
        });
    }
    let Some(base) = base_of(condition, model) else {
        return Err(RunRefusal::NoBase);
    };
    if !is_used(base) {
        return Err(RunRefusal::BaseNotUsed {
            base: base.name.clone(),
        });
    }
    let (Some(run_matrices), Some(base_matrices)) = (model.state_space(), base.state_space())
    else {
        return Err(RunRefusal::NoMatrices);
    };
    check_states(model, run_matrices, base, base_matrices)?;
    if run_matrices.timing() != base_matrices.timing() {
        return Err(RunRefusal::Timing {
            base: base.name.clone(),
        });
    }
    if run_matrices == base_matrices {
        return Err(RunRefusal::NoChange {
            base: base.name.clone(),
        });
    }
    Ok(MatchedRun {
        model,
        base,
        change,
        run_matrices,
        base_matrices,
    })
}

/// Checks that a run has its base's channels and states, in the same order. Names are compared if
/// both models give them.
fn check_states(
    run: &Model,
    run_matrices: &StateSpace,
    base: &Model,
    base_matrices: &StateSpace,
) -> Result<(), RunRefusal> {
    let expected = model_shape(base_matrices);
    let found = model_shape(run_matrices);
    if expected != found {
        return Err(RunRefusal::Shape {
            base: base.name.clone(),
            expected,
            found,
        });
    }
    for (index, (expected, found)) in base.states.iter().zip(run.states.iter()).enumerate() {
        if expected != found {
            return Err(RunRefusal::States {
                base: base.name.clone(),
                position: index + 1,
                expected: expected.clone(),
                found: found.clone(),
            });
        }
    }
    Ok(())
}

/// Returns the physics model with the same perturbation as a run or a rerun: the nominal model if
/// it qualifies, otherwise the first.
pub fn base_of<'a>(condition: &'a Condition, run: &Model) -> Option<&'a Model> {
    let bundle = condition.bundle(BundleKind::Physics);
    let nominal = &bundle[condition.nominal()];
    std::iter::once(nominal)
        .chain(bundle)
        .find(|model| is_same_trim(model, run))
}

/// Returns whether two models have equal perturbation values; a coordinate that one model does not
/// give is zero. A perturbed `base` without coordinates is at an unknown trim, and never matches.
fn is_same_trim(base: &Model, run: &Model) -> bool {
    let nothing = BTreeMap::new();
    let base_offsets = match base.perturbation() {
        Some(offsets) => offsets,
        None if base.is_nominal() => &nothing,
        None => return false,
    };
    let run_offsets = run.perturbation().unwrap_or(&nothing);
    base_offsets
        .keys()
        .chain(run_offsets.keys())
        .all(|name| offset_of(base_offsets, name) == offset_of(run_offsets, name))
}

/// Returns a trim offset; 0 for a coordinate that is not given.
fn offset_of(offsets: &BTreeMap<String, f64>, coordinate: &str) -> f64 {
    offsets.get(coordinate).copied().unwrap_or(0.0)
}
