//! Analysis stages for a condition, each cached while its inputs stay the same.
//!
//! ```text
//! 1  responses of every model                                    (dynamics of the model, grid)
//! 2  distances within each bundle                                (compared responses, coherence)
//! 3  representatives, G and D                                    (`compared_stages`)
//! 4  with physics parameters: responses of the moved physics models, and stage 3 again
//! 5  with couplings: responses of the coupled physics models, and stage 3 again
//! 6  optimal delays and gains                                    (`compared_stages`)
//! ```
//!
//! In brackets: the inputs on which a stage depends, or its file. *Moved* physics models are those
//! to which physics parameters are applied (M18.5), *coupled* ones those with couplings (M16). A
//! *swap* repeats stages 3 and 6 with another kept model instead of a representative (M13.1).

use std::sync::Arc;

use gdcm_method::correction::delta::Delta;
use gdcm_method::correction::{Problem, ProofBudget, Solution};
use gdcm_model::dataset::{BundleKind, Condition, PairTable};
use gdcm_model::progress::Cancelled;

use super::compared_stages::{ComparedStages, ComparisonData, MetricsKey};
use super::condition_responses::{ConditionModels, ConditionResponses, CoupledResponses};
use super::coupling_fit::CouplingSource;
use super::known_models::{GridKey, KnownModels, Purpose};
use super::memo::Memo;
use super::model_swaps::{SwapInput, SwapMemo, SwapOptimum};
use super::optima::{NoOptima, SolveInput, SolvedProblems};
use super::physics_fit::PhysicsSource;
use super::run::Run;
use crate::execution::Execution;
use crate::results::analysis::{ConditionAnalysis, ConditionFailure};
use crate::results::applied_physics::{AppliedPhysics, MovedCondition};
use crate::results::caution::Caution;
use crate::results::comparison::{BundleMetrics, Comparison, Mismatches};
use crate::results::fitted_couplings::{CoupledCondition, FittedCouplings};
use crate::results::model_swap::ConditionSwaps;

/// Proof budget for the gains after a swap: the interactive analysis's work limit, without a search
/// for other minima.
pub(crate) const SWAP_PROOF: ProofBudget = ProofBudget {
    work: 1_000_000,
    listing: 0,
    bytes: 64_000_000,
};

/// Inputs on which coupled responses depend, besides the models.
#[derive(Clone, Debug, PartialEq)]
struct CoupledKey {
    grid: GridKey,
    couplings: Arc<FittedCouplings>,
}

/// A condition's last result at each stage.
#[derive(Clone, Debug)]
pub(crate) struct ConditionStages {
    models: ConditionModels,
    metrics: Memo<MetricsKey, Arc<BundleMetrics>>,
    /// Stages for the physics models without couplings, as in the dataset.
    plain: ComparedStages,
    /// The values that move the physics models, if any (M18.5).
    physics: Option<Arc<AppliedPhysics>>,
    /// Stages for the moved physics models without couplings, where the condition has any.
    moved: Option<MovedStages>,
    /// Responses of the physics models with couplings.
    coupled_responses: Memo<CoupledKey, CoupledResponses>,
    /// Stages for the physics models with couplings.
    coupled: ComparedStages,
    swaps: SwapMemo,
}

/// A condition's moved physics models, with the last result at each stage.
#[derive(Clone, Debug)]
struct MovedStages {
    models: ConditionModels,
    compared: ComparedStages,
}

impl ConditionStages {
    /// Creates stages without results; responses cached with the models are kept.
    pub(crate) fn new(models: ConditionModels) -> Self {
        Self {
            models,
            metrics: Memo::default(),
            plain: ComparedStages::default(),
            physics: None,
            moved: None,
            coupled_responses: Memo::default(),
            coupled: ComparedStages::default(),
            swaps: SwapMemo::default(),
        }
    }

    /// Replaces the models; results are kept where the bundles are the same.
    pub(crate) fn take(&mut self, models: ConditionModels) {
        if self.models.are_the_same_as(&models) {
            self.models = models;
        } else {
            *self = Self::new(models);
        }
    }

    /// Sets the values that move the physics models for the stages after the distances; results are
    /// kept while the moved models stay the same (M18.5).
    pub(crate) fn apply_physics(
        &mut self,
        applied: Option<&Arc<AppliedPhysics>>,
        known: &KnownModels,
    ) {
        self.physics = applied.cloned();
        let moved = applied.and_then(|applied| applied.moved(self.models.condition().id()));
        let present = self.moved.as_ref().map(|moved| moved.models.condition());
        let is_same = match (moved, present) {
            (Some(moved), Some(present)) => Arc::ptr_eq(moved, present),
            (None, None) => true,
            _ => false,
        };
        if is_same {
            return;
        }
        self.moved = moved.map(|condition| MovedStages {
            models: ConditionModels::new(condition, known),
            compared: ComparedStages::default(),
        });
        self.coupled_responses = Memo::default();
        self.coupled = ComparedStages::default();
        self.swaps = SwapMemo::default();
    }

    /// Returns the models that the stages after the distances compare.
    fn compared_models(&self) -> &ConditionModels {
        match &self.moved {
            Some(moved) => &moved.models,
            None => &self.models,
        }
    }

    /// Returns the step count for analysing a condition: for each model, one step for its response
    /// and two for its distances; and one for the later stages.
    pub(crate) fn steps(condition: &Condition) -> usize {
        3 * model_count(condition) + 1
    }

    pub(crate) fn models(&self) -> &ConditionModels {
        &self.models
    }

    /// Replaces the cached gains if they solve this problem.
    pub(crate) fn take_gains(&mut self, problem: &Arc<Problem>, solution: &Arc<Solution>) {
        self.plain.problems.take_gains(problem, solution);
        if let Some(moved) = &mut self.moved {
            moved.compared.problems.take_gains(problem, solution);
        }
        self.coupled.problems.take_gains(problem, solution);
    }

    /// Computes responses and distances for the models as in the dataset (stages 1 and 2).
    fn comparison_data<'a>(&mut self, run: Run<'a>) -> Result<ComparisonData<'a>, Cancelled> {
        let execution = run.execution;
        let condition = Arc::clone(self.models.condition());
        let key = MetricsKey::new(run);
        let on_axis = key.on_axis.clone();
        let responses =
            self.models
                .responses(Purpose::Comparison, run.grid_key(), run.grid, execution)?;
        if self.metrics.holds(&key) {
            // Cached distances report no steps; their steps are reported here.
            execution.step(2 * model_count(&condition));
        }
        let metrics = self.metrics.get_or_fail(key, |key| {
            let grid = run.comparison_grid();
            BundleMetrics::compute(&condition, &responses, &key.on_axis, grid, execution)
                .map(Arc::new)
        })?;
        Ok(ComparisonData {
            run,
            condition,
            on_axis,
            responses,
            metrics,
        })
    }

    /// Replaces the physics models by the moved ones, where the condition has any (stage 4);
    /// distances and suggested outliers still refer to the models in the dataset.
    fn with_moved_models<'a>(
        &self,
        data: ComparisonData<'a>,
    ) -> Result<ComparisonData<'a>, Cancelled> {
        let Some(moved) = &self.moved else {
            return Ok(data);
        };
        let run = data.run;
        // `comparison_data` reports the steps for the models.
        let silent = Execution::new(
            run.execution.executor(),
            run.execution.progress(),
            usize::MAX,
        );
        let responses =
            moved
                .models
                .responses(Purpose::Comparison, run.grid_key(), run.grid, &silent)?;
        Ok(ComparisonData {
            condition: Arc::clone(moved.models.condition()),
            responses,
            ..data
        })
    }

    /// Returns the stages without couplings: for the moved models, if the condition has any.
    fn stages_without_couplings(&mut self) -> &mut ComparedStages {
        match &mut self.moved {
            Some(moved) => &mut moved.compared,
            None => &mut self.plain,
        }
    }

    /// Returns the condition's input to the physics parameter fit.
    ///
    /// # Errors
    /// [`Cancelled`] where the run is cancelled.
    pub(crate) fn physics_source(&mut self, run: Run<'_>) -> Result<PhysicsSource, Cancelled> {
        let data = self.comparison_data(run)?;
        let comparison = self.plain.compare(&data, None);
        run.execution.step(1);
        Ok(PhysicsSource {
            is_held_out: run.study.choice(data.condition.id()).held_out,
            condition: data.condition,
            comparison,
        })
    }

    /// Returns the condition's input to the coupling fit; `None` where its representatives cannot
    /// be compared, or it has no optimal delays.
    ///
    /// # Errors
    /// [`Cancelled`] where the run is cancelled.
    pub(crate) fn coupling_source(
        &mut self,
        run: Run<'_>,
    ) -> Result<Option<CouplingSource>, Cancelled> {
        let data = self.comparison_data(run)?;
        let data = self.with_moved_models(data)?;
        let source = match self.stages_without_couplings().compare(&data, None) {
            Err(_) => None,
            Ok(comparison) => self.source_with_delays(&data, comparison)?,
        };
        run.execution.step(1);
        Ok(source)
    }

    /// Computes the optimal delays without couplings, and collects the coupling fit's input; `None`
    /// without optimal delays.
    fn source_with_delays(
        &mut self,
        data: &ComparisonData<'_>,
        comparison: Arc<Comparison>,
    ) -> Result<Option<CouplingSource>, Cancelled> {
        let input = data.solve_input(&comparison);
        let problem = Arc::new(input.delay_problem(input.lead_design().as_deref()));
        let stages = self.stages_without_couplings();
        let Ok(delays) = stages.problems.delays(&input, &problem)? else {
            return Ok(None);
        };
        let physics = comparison.physics.model;
        let identified = comparison.identified.model;
        let models = self.compared_models();
        Ok(Some(CouplingSource {
            condition: Arc::clone(&data.condition),
            delays_s: delays.channels(),
            contents: [
                models.content(BundleKind::Physics, physics),
                models.content(BundleKind::Identified, identified),
            ],
            physics: Arc::clone(&data.responses.physics[physics]),
            flight: Arc::clone(&data.responses.identified[identified]),
            comparison,
        }))
    }

    /// Completes the condition's analysis, with the couplings applied to the physics models, if
    /// any.
    ///
    /// # Errors
    /// [`Cancelled`] where the run is cancelled. A condition without a result is not an error.
    pub(crate) fn analyze(
        &mut self,
        run: Run<'_>,
        couplings: Option<&Arc<FittedCouplings>>,
    ) -> Result<Result<ConditionAnalysis, ConditionFailure>, Cancelled> {
        let outcome = match self.solve(run, couplings) {
            Ok(result) => Ok(result),
            Err(NoOptima::Failed(failure)) => Err(failure),
            Err(NoOptima::Cancelled) => return Err(Cancelled),
        };
        run.execution.step(1);
        Ok(outcome)
    }

    /// Computes the condition's result:
    ///
    /// ```text
    /// a  stages 1 and 2 with the models as in the dataset
    /// b  if the condition has moved models: stage 3 with the models as in the dataset, for
    ///    comparison; then the moved models instead (stage 4)
    /// c  without couplings: stages 3 and 6
    ///    with couplings: stage 3 without them, for comparison; then the coupled responses instead
    ///    (stage 5), and stages 3 and 6
    /// ```
    fn solve(
        &mut self,
        run: Run<'_>,
        couplings: Option<&Arc<FittedCouplings>>,
    ) -> Result<ConditionAnalysis, NoOptima> {
        // Step a.
        let data = self.comparison_data(run)?;
        // Step b.
        let moved = self.moved_condition(&data)?;
        let mut data = self.with_moved_models(data)?;
        // Step c.
        let stages = self.stages_without_couplings();
        let mut result = match couplings {
            None => stages.compare_and_solve(&data, None)?,
            Some(fitted) => {
                let before = stages.compare(&data, None)?;
                data.responses = self.with_couplings(run, couplings, data.responses);
                let result = self.coupled.compare_and_solve(&data, couplings)?;
                ConditionAnalysis {
                    coupled: Some(CoupledCondition {
                        before,
                        fitted: Arc::clone(fitted),
                    }),
                    ..result
                }
            }
        };
        result.moved = moved;
        result.cautions.extend(self.physics_cautions());
        Ok(result)
    }

    /// Compares the models as in the dataset, where the physics models are moved; `None` where they
    /// are not.
    fn moved_condition(
        &mut self,
        data: &ComparisonData<'_>,
    ) -> Result<Option<MovedCondition>, ConditionFailure> {
        match (&self.moved, &self.physics) {
            (Some(_), Some(applied)) => Ok(Some(MovedCondition {
                file: Arc::clone(&data.condition),
                before: self.plain.compare(data, None)?,
                applied: Arc::clone(applied),
            })),
            _ => Ok(None),
        }
    }

    /// Returns the cautions about the condition's moved models.
    fn physics_cautions(&self) -> Vec<Caution> {
        let id = self.models.condition().id();
        let moved = match &self.physics {
            Some(applied) => applied.conditions.get(&id),
            None => None,
        };
        match moved {
            Some(moved) => Caution::of_moved_models(moved),
            None => Vec::new(),
        }
    }

    /// Computes the condition's gains and delays after other models replace the representatives in
    /// `analysis` (M13.1); cached results are reused. The couplings are not fitted again.
    ///
    /// # Errors
    /// [`Cancelled`] where the run is cancelled.
    pub(crate) fn swaps(
        &mut self,
        run: Run<'_>,
        analysis: &ConditionAnalysis,
        couplings: Option<&Arc<FittedCouplings>>,
    ) -> Result<ConditionSwaps, Cancelled> {
        let responses = self.compared_models().responses(
            Purpose::Comparison,
            run.grid_key(),
            run.grid,
            run.execution,
        )?;
        let responses = self.with_couplings(run, couplings, responses);
        let input = SwapInput {
            run,
            analysis,
            responses: &responses,
            couplings,
        };
        let on_axis = run.study.dataset.measuring_pairs();
        self.swaps.complete(&input, |mismatches, delta| {
            swap_optimum(run, &on_axis, mismatches, delta)
        })
    }

    /// Adds the couplings, if any, to the responses (stage 5); coupled responses are computed on
    /// first use. Nothing else applies couplings to a physics model for comparison.
    fn with_couplings(
        &mut self,
        run: Run<'_>,
        couplings: Option<&Arc<FittedCouplings>>,
        responses: ConditionResponses,
    ) -> ConditionResponses {
        let Some(couplings) = couplings else {
            return responses;
        };
        let key = CoupledKey {
            grid: run.grid_key(),
            couplings: Arc::clone(couplings),
        };
        let airspeed_kt = self.models.condition().flight_state().airspeed_kt;
        let coupled = self.coupled_responses.get(key, |key| {
            CoupledResponses::new(&key.couplings, airspeed_kt, responses.physics.len())
        });
        responses.with(coupled)
    }
}

/// Computes the optimal correction after a swap (stage 6), from the mismatches between the two
/// models and their G and D; `None` if a problem has no solution. Nothing is cached: `SwapMemo`
/// does that.
fn swap_optimum(
    run: Run<'_>,
    on_axis: &PairTable<bool>,
    mismatches: &Mismatches,
    delta: Delta,
) -> Result<Option<SwapOptimum>, Cancelled> {
    let input = SolveInput::new(run, on_axis, mismatches, &delta);
    match SolvedProblems::default().solve(&input) {
        Ok(optima) => Ok(Some(SwapOptimum {
            correction: optima.correction(),
            delta: Delta {
                gain: optima.gain_problem.delta.clone(),
                ..delta
            },
        })),
        Err(NoOptima::Failed(_)) => Ok(None),
        Err(NoOptima::Cancelled) => Err(Cancelled),
    }
}

/// Returns the number of models in both bundles.
pub(crate) fn model_count(condition: &Condition) -> usize {
    condition.bundle(BundleKind::Physics).len() + condition.bundle(BundleKind::Identified).len()
}
