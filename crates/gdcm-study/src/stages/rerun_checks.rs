//! Compares reruns with the prediction from the runs (M18.6).
//!
//! ```text
//! 1  base: the physics model of the condition with the perturbation of the rerun
//! 2  prediction: the base moved by the increments at the values of the rerun
//! 3  J of prediction and base against the rerun, averaged on and off axis
//! ```
//!
//! A *run* is a physics model linearised again with one parameter moved; the *increments* are the
//! changes of its matrices with the parameter's value. A *rerun* has several parameters moved,
//! normally to the values found. J is the mismatch cost (M4).

use gdcm_method::correction::delta::mismatch_table;
use gdcm_method::physics::run_matching::base_of;
use gdcm_method::physics::{MatchedRuns, OfferedParameter};
use gdcm_model::dataset::physics_parameter::{MovedModel, MovedParameters, ParameterChange};
use gdcm_model::dataset::{Condition, Dynamics, Model};
use gdcm_model::response::{FrequencyGrid, GainDelay, PolarResponse, PreparedModel};

use crate::decisions::study::Study;
use crate::results::correction_costs::AxisCost;
use crate::results::rerun_check::{RerunCheck, RerunCost, RerunRefusal};

/// Compares every rerun in the dataset with the prediction for its values.
pub(super) fn check_reruns(study: &Study, grid: &FrequencyGrid) -> Vec<RerunCheck> {
    let parameters = study.settings.physics_parameters.parameters(&study.dataset);
    let mut checks = Vec::new();
    for condition in study.dataset.conditions() {
        for rerun in condition.moved_models() {
            let MovedParameters::Rerun(changes) = &rerun.moved else {
                continue;
            };
            let comparison = RerunComparison {
                study,
                condition,
                parameters: &parameters,
                grid,
            };
            checks.push(RerunCheck {
                condition: condition.id(),
                model: rerun.model.name.clone(),
                changes: changes.clone(),
                outcome: comparison.cost(rerun, changes),
            });
        }
    }
    checks
}

/// Data for comparing a condition's reruns.
struct RerunComparison<'a> {
    study: &'a Study,
    condition: &'a Condition,
    parameters: &'a [OfferedParameter],
    grid: &'a FrequencyGrid,
}

impl RerunComparison<'_> {
    /// Returns J of the prediction and of the base against a rerun (steps 1 to 3).
    ///
    /// # Errors
    /// The first reason that applies: no base; a change of an unknown parameter or in another unit;
    /// runs that do not suffice; increments that do not apply to the base; no comparable response.
    fn cost(
        &self,
        rerun: &MovedModel,
        changes: &[ParameterChange],
    ) -> Result<RerunCost, RerunRefusal> {
        // Step 1.
        let base = base_of(self.condition, &rerun.model).ok_or(RerunRefusal::NoBase)?;
        // Step 2.
        let mut moved = Vec::new();
        let mut z = Vec::new();
        for change in changes {
            let parameter = self.parameter(change)?;
            z.push(change.delta / parameter.plausible_sd);
            moved.push(parameter.clone());
        }
        let rejected = &self.study.choice(self.condition.id()).physics.rejected;
        let is_used = |model: &Model| !rejected.contains(&model.name);
        let matched = MatchedRuns::new(self.condition, &moved, &is_used);
        let increments = matched.increments(&moved).map_err(RerunRefusal::Runs)?;
        let prediction = increments
            .apply(base, &z)
            .map_err(RerunRefusal::Increments)?;
        // Step 3.
        let cost = RerunCost {
            prediction: self.mean_cost(&Dynamics::StateSpace(prediction), &rerun.model.dynamics),
            base: self.mean_cost(&base.dynamics, &rerun.model.dynamics),
        };
        if cost.prediction == AxisCost::default() {
            Err(RerunRefusal::NothingToCompare)
        } else {
            Ok(cost)
        }
    }

    /// Returns the parameter that a change moves; an error if it is unknown or its unit differs.
    fn parameter(&self, change: &ParameterChange) -> Result<&OfferedParameter, RerunRefusal> {
        let Some(parameter) = self
            .parameters
            .iter()
            .find(|parameter| parameter.name == change.name)
        else {
            return Err(RerunRefusal::UnknownParameter {
                name: change.name.clone(),
            });
        };
        if parameter.unit == change.unit {
            Ok(parameter)
        } else {
            Err(RerunRefusal::Unit {
                name: change.name.clone(),
                expected: parameter.unit.clone(),
                found: change.unit.clone(),
            })
        }
    }

    /// Returns a model's mean J against a reference, on and off axis; numerically zero responses do
    /// not count (M6a).
    fn mean_cost(&self, model: &Dynamics, reference: &Dynamics) -> AxisCost {
        let mut compared = [model, reference].map(|dynamics| {
            let mut polar = PolarResponse::new(&PreparedModel::new(dynamics).response(self.grid));
            let numerically_zero = polar.numerically_zero();
            polar.clear(&numerically_zero);
            polar
        });
        let [model, reference] = &mut compared;
        let mut on_axis = MeanCost::default();
        let mut others = MeanCost::default();
        for (pair, mismatch) in mismatch_table(model, reference, None).iter() {
            let Some(mismatch) = mismatch else {
                continue;
            };
            let average = self.study.settings.cost_average;
            let cost = mismatch.cost(self.grid.omega(), GainDelay::NONE, average);
            if self.study.dataset.on_axis()[pair] {
                on_axis.add(cost.total());
            } else {
                others.add(cost.total());
            }
        }
        AxisCost {
            on_axis: on_axis.mean(),
            others: others.mean(),
        }
    }
}

/// Accumulator for the mean J over responses.
#[derive(Default)]
struct MeanCost {
    count: usize,
    sum: f64,
}

impl MeanCost {
    fn add(&mut self, cost: f64) {
        self.count += 1;
        self.sum += cost;
    }

    fn mean(&self) -> Option<f64> {
        if self.count > 0 {
            Some(self.sum / self.count as f64)
        } else {
            None
        }
    }
}
