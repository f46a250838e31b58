//! Analysis stages for a condition, each cached while its inputs stay the same.
//!
//! ```text
//! 1  responses of every model                                    (dynamics of the model, grid)
//! 2  distances within each bundle                                (compared responses, coherence)
//! 3  representatives, G and D                                    (rejections, pins, averages)
//! 4  with physics parameters: responses of the moved physics models, and stage 3 again
//! 5  with couplings: responses of the coupled physics models, and stage 3 again
//! 6  optimal delays and gains                                    (constraints, weights, bounds)
//! ```
//!
//! In brackets: the inputs on which a stage depends. *Moved* physics models are those to which
//! physics parameters are applied (M18.5), *coupled* ones those with couplings (M16). A *swap*
//! repeats stages 3 and 6 with another kept model instead of a representative (M13.1).

use std::sync::Arc;

use gdcm_method::correction::delta::{Delta, GainSource};
use gdcm_method::correction::{Problem, ProofBudget, Solution};
use gdcm_method::fidelity::CostAverage;
use gdcm_method::schedule::assessment::assess;
use gdcm_model::dataset::{BundleKind, Condition, PairTable};
use gdcm_model::progress::Cancelled;

use super::comparison_input::ComparisonInput;
use super::condition_responses::{ConditionModels, ConditionResponses, CoupledResponses};
use super::coupling_fit::CouplingSource;
use super::known_models::{GridKey, KnownModels, Purpose};
use super::memo::Memo;
use super::model_swaps::{SwapInput, SwapMemo, SwapOptimum};
use super::optima::{NoOptima, Optima, SolveInput, SolvedProblems};
use super::physics_fit::PhysicsSource;
use super::run::Run;
use crate::decisions::choices::ConditionChoice;
use crate::decisions::settings::Settings;
use crate::execution::Execution;
use crate::results::analysis::{ConditionAnalysis, ConditionFailure};
use crate::results::applied_physics::{AppliedPhysics, MovedCondition};
use crate::results::caution::Caution;
use crate::results::comparison::{BundleMetrics, Comparison};
use crate::results::fitted_couplings::{CoupledCondition, FittedCouplings};
use crate::results::model_swap::ConditionSwaps;

/// Proof budget for the gains after a swap: the interactive analysis's work limit, without a search
/// for other minima.
pub(crate) const SWAP_PROOF: ProofBudget = ProofBudget {
    work: 1_000_000,
    listing: 0,
    bytes: 64_000_000,
};

/// Inputs on which the distances depend, besides the models.
#[derive(Clone, Debug, PartialEq)]
struct MetricsKey {
    grid: GridKey,
    measuring: PairTable<bool>,
    coherence: Option<f64>,
}

impl MetricsKey {
    fn new(run: Run<'_>) -> Self {
        Self {
            grid: run.grid_key(),
            measuring: run.study.dataset.measuring_pairs(),
            coherence: run.study.settings.coherence_threshold,
        }
    }
}

/// Inputs on which the comparison of the representatives depends, besides the models.
#[derive(Clone, Debug, PartialEq)]
struct ComparisonKey {
    metrics: MetricsKey,
    choice: ConditionChoice,
    average: CostAverage,
    gain_source: GainSource,
    couplings: Option<Arc<FittedCouplings>>,
}

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
    responses: Memo<CoupledKey, CoupledResponses>,
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

/// Last comparison between a condition's representatives, and the optima based on it.
#[derive(Clone, Debug, Default)]
struct ComparedStages {
    comparison: Memo<ComparisonKey, Result<Arc<Comparison>, ConditionFailure>>,
    problems: SolvedProblems,
}

/// A condition's models with the results of stages 1 and 2, from which the comparison (stage 3) and
/// the optima (stage 6) are computed.
struct Measured<'a> {
    run: Run<'a>,
    condition: Arc<Condition>,
    /// The responses from which distances and bounds are computed: the on-axis responses, or all
    /// responses if none is on-axis.
    measuring: PairTable<bool>,
    responses: ConditionResponses,
    metrics: Arc<BundleMetrics>,
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
            responses: Memo::default(),
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
        self.responses = Memo::default();
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
    fn measure<'a>(&mut self, run: Run<'a>) -> Result<Measured<'a>, Cancelled> {
        let execution = run.execution;
        let condition = Arc::clone(self.models.condition());
        let key = MetricsKey::new(run);
        let measuring = key.measuring.clone();
        let responses =
            self.models
                .responses(Purpose::Comparison, run.grid_key(), run.grid, execution)?;
        if self.metrics.holds(&key) {
            // Cached distances report no steps; their steps are reported here.
            execution.step(2 * model_count(&condition));
        }
        let metrics = self.metrics.get_or_fail(key, |key| {
            let grid = run.comparison_grid();
            BundleMetrics::compute(&condition, &responses, &key.measuring, grid, execution)
                .map(Arc::new)
        })?;
        Ok(Measured {
            run,
            condition,
            measuring,
            responses,
            metrics,
        })
    }

    /// Replaces the physics models by the moved ones, where the condition has any (stage 4);
    /// distances and suggested outliers still refer to the models in the dataset.
    fn with_moved_models<'a>(&self, measured: Measured<'a>) -> Result<Measured<'a>, Cancelled> {
        let Some(moved) = &self.moved else {
            return Ok(measured);
        };
        let run = measured.run;
        // `measure` reports the steps for the models.
        let silent = Execution::new(
            run.execution.executor(),
            run.execution.progress(),
            usize::MAX,
        );
        let responses =
            moved
                .models
                .responses(Purpose::Comparison, run.grid_key(), run.grid, &silent)?;
        Ok(Measured {
            condition: Arc::clone(moved.models.condition()),
            responses,
            ..measured
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
        let measured = self.measure(run)?;
        let comparison = self.plain.compare(&measured, None);
        run.execution.step(1);
        Ok(PhysicsSource {
            is_held_out: run.study.choice(measured.condition.id()).held_out,
            condition: measured.condition,
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
        let measured = self.measure(run)?;
        let measured = self.with_moved_models(measured)?;
        let source = match self.stages_without_couplings().compare(&measured, None) {
            Err(_) => None,
            Ok(comparison) => self.source_with_delays(&measured, comparison)?,
        };
        run.execution.step(1);
        Ok(source)
    }

    /// Computes the optimal delays without couplings, and collects the coupling fit's input; `None`
    /// without optimal delays.
    fn source_with_delays(
        &mut self,
        measured: &Measured<'_>,
        comparison: Arc<Comparison>,
    ) -> Result<Option<CouplingSource>, Cancelled> {
        let input = measured.solve_input(&comparison);
        let problem = Arc::new(input.delay_problem(input.lead_design().as_deref()));
        let stages = self.stages_without_couplings();
        let Ok(delays) = stages.problems.delays(&input, &problem)? else {
            return Ok(None);
        };
        let physics = comparison.physics.model;
        let identified = comparison.identified.model;
        let models = self.compared_models();
        Ok(Some(CouplingSource {
            condition: Arc::clone(&measured.condition),
            delays_s: delays.channels(),
            contents: [
                models.content(BundleKind::Physics, physics),
                models.content(BundleKind::Identified, identified),
            ],
            physics: Arc::clone(&measured.responses.physics[physics]),
            flight: Arc::clone(&measured.responses.identified[identified]),
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

    /// Computes the condition's result: stages 1 and 2 with the models as in the dataset; stages 3
    /// and 6 with the moved models, if any, and with the couplings, if any. The comparisons before
    /// each of these changes (models as in the dataset, models without couplings) are part of the
    /// result.
    fn solve(
        &mut self,
        run: Run<'_>,
        couplings: Option<&Arc<FittedCouplings>>,
    ) -> Result<ConditionAnalysis, NoOptima> {
        let measured = self.measure(run)?;
        let moved = self.moved_condition(&measured)?;
        let mut measured = self.with_moved_models(measured)?;
        let stages = self.stages_without_couplings();
        let mut result = match couplings {
            None => stages.compare_and_solve(&measured, None)?,
            Some(fitted) => {
                let before = stages.compare(&measured, None)?;
                measured.responses = self.coupled_responses(run, couplings, measured.responses);
                let result = self.coupled.compare_and_solve(&measured, couplings)?;
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
        measured: &Measured<'_>,
    ) -> Result<Option<MovedCondition>, ConditionFailure> {
        match (&self.moved, &self.physics) {
            (Some(_), Some(applied)) => Ok(Some(MovedCondition {
                file: Arc::clone(&measured.condition),
                before: self.plain.compare(measured, None)?,
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
        let responses = self.coupled_responses(run, couplings, responses);
        let input = SwapInput {
            run,
            analysis,
            responses: &responses,
            couplings,
        };
        let measuring = run.study.dataset.measuring_pairs();
        self.swaps.complete(&input, |mismatch, delta| {
            let input = SolveInput::new(run, &measuring, mismatch, &delta);
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
        })
    }

    /// Adds the couplings, if any, to the responses (stage 5); coupled responses are computed on
    /// first use. Nothing else applies couplings to a physics model for comparison.
    fn coupled_responses(
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
        let coupled = self.responses.get(key, |key| {
            CoupledResponses::new(&key.couplings, airspeed_kt, responses.physics.len())
        });
        responses.with(coupled)
    }
}

impl Measured<'_> {
    fn solve_input<'b>(&'b self, comparison: &'b Comparison) -> SolveInput<'b> {
        SolveInput::new(
            self.run,
            &self.measuring,
            &comparison.representative.mismatch,
            &comparison.delta,
        )
    }
}

impl ComparedStages {
    /// Compares the representatives (stage 3). They are selected among the models without
    /// couplings, because a correction must not hide a step of the physics model (M16.3).
    fn compare(
        &mut self,
        measured: &Measured<'_>,
        couplings: Option<&Arc<FittedCouplings>>,
    ) -> Result<Arc<Comparison>, ConditionFailure> {
        let settings = &measured.run.study.settings;
        let choice = measured.run.study.choice(measured.condition.id());
        let key = ComparisonKey {
            metrics: MetricsKey::new(measured.run),
            choice: choice.of_models(),
            average: settings.cost_average,
            gain_source: settings.gain_source,
            couplings: couplings.cloned(),
        };
        let comparison = self.comparison.get(key, |_| {
            let input = ComparisonInput {
                condition: &measured.condition,
                responses: &measured.responses,
                metrics: &measured.metrics,
                grid: measured.run.comparison_grid(),
                choice,
                average: settings.cost_average,
            };
            let comparison = Comparison::compute(&input)?;
            Ok(Arc::new(match settings.gain_source {
                GainSource::Representatives => comparison,
                GainSource::MeanOfPairs => comparison.with_mean_gains(&input),
            }))
        })?;
        check_comparable(&measured.condition, &comparison)?;
        Ok(comparison)
    }

    /// Compares the representatives, and computes the optimal delays and gains (stages 3 and 6).
    fn compare_and_solve(
        &mut self,
        measured: &Measured<'_>,
        couplings: Option<&Arc<FittedCouplings>>,
    ) -> Result<ConditionAnalysis, NoOptima> {
        let comparison = self.compare(measured, couplings)?;
        let settings = &measured.run.study.settings;
        let input = measured.solve_input(&comparison);
        let optima = self.problems.solve(&input)?;
        let correction = optima.correction();
        let models = &comparison.representative;
        let cost = Arc::new(assess(
            &models.mismatch,
            &models.cost,
            &correction,
            measured.run.grid.omega(),
            settings.cost_average,
        ));
        let held = &optima.gain_problem.constrained;
        let offer = self.problems.offer(&input, held, &cost)?;
        let cautions = result_cautions(settings, &comparison, &measured.metrics);
        let Optima {
            gain_problem,
            delay_problem,
            gains,
            delays,
            compensated,
        } = optima;
        Ok(ConditionAnalysis {
            condition: Arc::clone(&measured.condition),
            bundle_metrics: Arc::clone(&measured.metrics),
            moved: None,
            coupled: None,
            comparison,
            gain_problem,
            delay_problem,
            gains,
            delays,
            compensated,
            offer,
            correction,
            cost,
            doubts: Vec::new(),
            cautions,
        })
    }
}

/// Checks that the representatives can be compared in one response or more.
fn check_comparable(
    condition: &Condition,
    comparison: &Comparison,
) -> Result<(), ConditionFailure> {
    if comparison.delta.gain.iter().any(|(_, gain)| gain.is_some()) {
        return Ok(());
    }
    let physics = &condition.bundle(BundleKind::Physics)[comparison.physics.model];
    let identified = &condition.bundle(BundleKind::Identified)[comparison.identified.model];
    Err(ConditionFailure::NothingToCompare {
        physics: physics.name.clone(),
        identified: identified.name.clone(),
        cautions: comparison.cautions.clone(),
    })
}

/// Collects the cautions about a result: undefined constrained responses, unavailable outlier
/// suggestions, cautions about the models, unusual gains.
fn result_cautions(
    settings: &Settings,
    comparison: &Comparison,
    metrics: &BundleMetrics,
) -> Vec<Caution> {
    let mut cautions = Vec::new();
    for pair in settings.constrained.marked() {
        if let Some(why) = comparison.undefined[pair] {
            cautions.push(Caution::HeldButUndefined { pair, why });
        }
    }
    if let Err(error) = &metrics.discontinuity {
        cautions.push(Caution::NoSuggestions(error.clone()));
    }
    cautions.extend(comparison.cautions.iter().cloned());
    for pair in settings.fitted().marked() {
        if let Some(gain) = comparison.delta.gain[pair] {
            cautions.extend(Caution::unusual_gain(pair, gain));
        }
    }
    cautions
}

/// Returns the number of models in both bundles.
pub(crate) fn model_count(condition: &Condition) -> usize {
    condition.bundle(BundleKind::Physics).len() + condition.bundle(BundleKind::Identified).len()
}
