//! Analyses a study stage by stage; each stage is cached while its inputs stay the same.
//!
//! Physics parameters change the matrices of the physics models, which are then called *moved*
//! (M18.5); couplings mix the inputs and feed outputs back (M16). Both precede the gains and
//! delays. A condition *held out* is analysed, but takes no part in the fits to all conditions.

use std::collections::BTreeMap;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use gdcm_method::correction::{Problem, ProofBudget, Solution};
use gdcm_method::schedule::{Schedule, ScheduleCaution};
use gdcm_model::dataset::{Band, ConditionId, Dataset};
use gdcm_model::executor::{Executor, Sequential};
use gdcm_model::progress::{Cancelled, Progress};
use gdcm_model::response::FrequencyGrid;

use super::condition_curves::ConditionCurves;
use super::condition_responses::ConditionModels;
use super::condition_stages::{ConditionStages, SWAP_PROOF, model_count};
use super::convention_check::convention_doubts;
use super::coupling_fit::{CouplingFitKey, CouplingOutcome, CouplingSource};
use super::known_models::{GridKey, KnownModels, Purpose};
use super::memo::Memo;
use super::physics_models::{PhysicsMemo, PhysicsOutcome};
use super::run::Run;
use super::signed_delay_cautions::signed_delays_apart;
use crate::decisions::physics_settings::PhysicsCorrection;
use crate::decisions::study::Study;
use crate::execution::Execution;
use crate::results::analysis::{Analysis, ConditionAnalysis, ConditionFailure, Outcomes};
use crate::results::applied_physics::AppliedPhysics;
use crate::results::assessment_table::{AssessmentChoice, assessed};
use crate::results::comparison::Mismatches;
use crate::results::convention_doubt::ConventionDoubt;
use crate::results::fitted_couplings::FittedCouplings;
use crate::results::record_simulations::time_histories_of;
use crate::results::required_modes::IdentifiedPoles;
use crate::results::requirements::{Requirements, requirements_of};
use crate::results::schedule_losses::schedule_cost_cautions;
use crate::results::scheduled_conditions::{schedule_settings, scheduled_points};
use crate::results::time_histories::{HistoryRecords, TimeHistories};
use crate::results::uncertainty::Uncertainty;

/// Computes analyses and caches each stage's last result, keyed by the numerical content of its
/// inputs: if a single model changes, no other model's response is recomputed.
///
/// ```text
/// responses                      (dynamics of the model, band, points)
/// distances                      (compared responses, coherence)
/// representatives, G, D          (rejections, pins, average)
/// physics parameters, where requested: all later stages use the moved physics models
/// couplings, where requested: all later stages use the coupled physics models
/// gains, delays                  (constraints, weights, alpha, bounds)
/// schedule
/// assessment
/// ```
///
/// Conditions and models do not depend on one another: the result is bit-for-bit the same with any
/// executor.
#[derive(Clone)]
pub struct Engine {
    executor: Arc<dyn Executor>,
    /// Proof budget for each condition's gains.
    proofs: ProofBudget,
    dataset: Option<Arc<Dataset>>,
    known: KnownModels,
    physics: PhysicsMemo,
    couplings: Memo<CouplingFitKey, CouplingOutcome>,
    conditions: BTreeMap<ConditionId, ConditionStages>,
    /// The condition drawn last.
    drawn: Option<ConditionId>,
    /// Curves for the condition drawn last.
    curves: Memo<GridKey, Arc<ConditionCurves>>,
}

/// Proof budget within the interactive analysis; longer proofs run as a separate job
/// ([`ProofJob`](crate::jobs::analysis_jobs::ProofJob)).
pub const LIVE_PROOF: ProofBudget = ProofBudget {
    work: 1_000_000,
    listing: 100_000,
    bytes: 64_000_000,
};

impl Default for Engine {
    fn default() -> Self {
        Self::with_executor(Box::new(Sequential))
    }
}

impl Engine {
    /// Creates an engine that runs on `executor`.
    pub fn with_executor(executor: Box<dyn Executor>) -> Self {
        Self {
            executor: executor.into(),
            proofs: ProofBudget::default(),
            dataset: None,
            known: KnownModels::default(),
            physics: PhysicsMemo::default(),
            couplings: Memo::default(),
            conditions: BTreeMap::new(),
            drawn: None,
            curves: Memo::default(),
        }
    }

    /// Copies the engine with its cached results; the copy then changes independently.
    pub fn fork(&self, executor: Box<dyn Executor>) -> Self {
        Self {
            executor: executor.into(),
            ..self.clone()
        }
    }

    pub(crate) fn executor(&self) -> &dyn Executor {
        self.executor.as_ref()
    }

    /// Sets the proof budget for each condition's gains.
    pub fn with_proofs_within(self, proofs: ProofBudget) -> Self {
        Self { proofs, ..self }
    }

    /// Shares model responses with other engines. Only each model's last response is cached, so
    /// that engines should have the same band and point count.
    pub fn sharing(self, known: &KnownModels) -> Self {
        Self {
            known: known.clone(),
            ..self
        }
    }

    /// Replaces cached gains for the same problem by gains that were proven under a larger budget.
    pub fn take_gains(&mut self, problem: &Arc<Problem>, solution: &Arc<Solution>) {
        for stages in self.conditions.values_mut() {
            stages.take_gains(problem, solution);
        }
    }

    /// Analyses `study`; stages whose inputs have not changed since the last call are not computed
    /// again.
    ///
    /// # Errors
    /// [`Cancelled`] soon after `progress` requests it.
    pub fn analyze(
        &mut self,
        study: &Study,
        progress: &dyn Progress,
    ) -> Result<Analysis, Cancelled> {
        self.analyze_first(study, None, progress)
    }

    /// Works as [`Engine::analyze`], but computes one condition's result first and passes it on
    /// before the other conditions are analysed.
    ///
    /// ```text
    /// 1  models of the dataset, with the responses that are already known
    /// 2  physics parameters, where requested, fitted to all conditions; moved physics models
    /// 3  couplings, where requested, fitted to all conditions
    /// 4  each condition: distances, representatives, G and D, gains and delays
    /// 5  apparent sign and unit differences
    /// 6  schedule, with cautions about signed delays
    /// 7  assessment of each condition under the schedule
    /// 8  cautions about conditions for which the schedule costs much more than their optimum
    /// ```
    ///
    /// # Errors
    /// [`Cancelled`] soon after `progress` requests it.
    pub fn analyze_first(
        &mut self,
        study: &Study,
        first: Option<WantedFirst>,
        progress: &dyn Progress,
    ) -> Result<Analysis, Cancelled> {
        // Step 1.
        self.switch_to(&study.dataset);
        let grid = FrequencyGrid::logarithmic(study.settings.band, study.settings.points);
        let execution = Execution::new(self.executor.as_ref(), progress, steps(study));
        let run = Run {
            study,
            grid: &grid,
            proofs: self.proofs,
            execution: &execution,
        };
        // Step 2.
        let physics = fit_physics(run, &mut self.physics, &mut self.conditions)?;
        let applied = physics.as_ref().and_then(|outcome| outcome.as_ref().ok());
        move_models(&mut self.conditions, applied, &self.known);
        // Step 3.
        let couplings = fit_couplings(run, &mut self.couplings, &mut self.conditions)?;
        let fitted = couplings.as_ref().and_then(|outcome| outcome.as_ref().ok());
        // Step 4.
        let mut conditions = analyze_conditions(run, &mut self.conditions, fitted, first)?;
        // Step 5.
        let doubts = add_doubts(study, &mut conditions);
        // Step 6.
        let settings = schedule_settings(study, &conditions);
        let schedule = Schedule::fit(&scheduled_points(study, &conditions), settings);
        let delay_cautions = signed_delays_apart(study, &conditions);
        let mut analysis = Analysis {
            study: study.clone(),
            omega: grid.omega().into(),
            conditions,
            physics,
            physics_assessment: None,
            couplings,
            coupling_assessment: None,
            doubts,
            schedule,
            assessment: BTreeMap::new(),
            uncertainty: None,
        };
        add_schedule_cautions(&mut analysis, delay_cautions);
        // Step 7.
        let choice = AssessmentChoice::of_paper(&study.settings);
        let ids: Vec<ConditionId> = study.dataset.ids().collect();
        let assessment = execution.each(ids.len(), 0, |index| {
            assessed(&analysis, ids[index], choice).map(|assessed| assessed.changes)
        })?;
        analysis.assessment = ids.into_iter().zip(assessment).collect();
        // Step 8.
        let cost_cautions = schedule_cost_cautions(&analysis);
        add_schedule_cautions(&mut analysis, cost_cautions);
        Ok(analysis)
    }

    /// Computes the uncertainty of the results in `analysis` from swaps, in each of which another
    /// model replaces a representative (M13). Swaps whose inputs have not changed since the last
    /// call are not computed again.
    ///
    /// # Errors
    /// [`Cancelled`] soon after `progress` requests it.
    pub fn uncertainty(
        &mut self,
        analysis: &Analysis,
        progress: &dyn Progress,
    ) -> Result<Uncertainty, Cancelled> {
        let study = &analysis.study;
        self.switch_to(&study.dataset);
        let grid = FrequencyGrid::logarithmic(study.settings.band, study.settings.points);
        // One step for each model's response, and at most one for its swap.
        let total = study
            .dataset
            .conditions()
            .iter()
            .map(|condition| 2 * model_count(condition))
            .sum();
        let execution = Execution::new(self.executor.as_ref(), progress, total);
        move_models(
            &mut self.conditions,
            analysis.applied_physics(),
            &self.known,
        );
        let mut analysed = Vec::new();
        for (id, stages) in &mut self.conditions {
            if let Some(result) = analysis.condition(*id) {
                analysed.push((*id, stages, result));
            }
        }
        let run = Run {
            study,
            grid: &grid,
            proofs: SWAP_PROOF,
            execution: &execution,
        };
        let couplings = analysis.fitted_couplings();
        let swaps = execution.each_owned(analysed, |(id, stages, result)| {
            Ok((id, stages.swaps(run, result, couplings)?))
        })?;
        Ok(Uncertainty::new(analysis, &swaps))
    }

    /// Computes the requirements on every condition's models; see [`requirements_of`].
    ///
    /// # Errors
    /// [`Cancelled`] soon after `progress` requests it.
    pub fn requirements(
        &self,
        analysis: &Analysis,
        identified_poles: &IdentifiedPoles,
        progress: &dyn Progress,
    ) -> Result<Requirements, Cancelled> {
        let steps = analysis.conditions.len();
        let execution = Execution::new(self.executor(), progress, steps);
        requirements_of(analysis, identified_poles, &execution)
    }

    /// Simulates an analysis's models with `records`, and compares the results with the study's
    /// tolerances; see [`time_histories_of`].
    ///
    /// # Errors
    /// [`Cancelled`] soon after `progress` requests it.
    pub fn time_histories(
        &self,
        analysis: &Analysis,
        records: &[HistoryRecords],
        progress: &dyn Progress,
    ) -> Result<TimeHistories, Cancelled> {
        let steps = HistoryRecords::steps(records);
        let execution = Execution::new(self.executor(), progress, steps);
        let tolerances = &analysis.study.requirements.tolerances;
        time_histories_of(analysis, records, tolerances, &execution)
    }

    /// Returns the curves for a condition's models on `grid`, a band and a number of frequencies in
    /// it; `None` where the condition does not exist. Only the last condition's curves are cached.
    ///
    /// # Errors
    /// [`Cancelled`] soon after `progress` requests it.
    pub fn curves(
        &mut self,
        dataset: &Arc<Dataset>,
        condition: ConditionId,
        grid: (Band, usize),
        progress: &dyn Progress,
    ) -> Result<Option<Arc<ConditionCurves>>, Cancelled> {
        self.switch_to(dataset);
        if self.drawn != Some(condition) {
            if let Some(before) = self.drawn.replace(condition)
                && let Some(stages) = self.conditions.get(&before)
            {
                stages.models().forget_drawn();
            }
            self.curves = Memo::default();
        }
        let Some(stages) = self.conditions.get(&condition) else {
            return Ok(None);
        };
        let executor = self.executor.as_ref();
        let models = stages.models();
        let curves = self.curves.get_or_fail(grid, |&key| {
            let grid = FrequencyGrid::logarithmic(key.0, key.1);
            let execution = Execution::new(executor, progress, model_count(models.condition()));
            let responses = models.responses(Purpose::Drawing, key, &grid, &execution)?;
            Ok(Arc::new(ConditionCurves::new(
                Arc::clone(models.condition()),
                grid,
                responses,
            )))
        })?;
        Ok(Some(curves))
    }

    /// Switches to this dataset; results are kept for content that both datasets contain.
    fn switch_to(&mut self, dataset: &Arc<Dataset>) {
        if self
            .dataset
            .as_ref()
            .is_some_and(|kept| Arc::ptr_eq(kept, dataset))
        {
            return;
        }
        // Collect all models before dropping any from the last dataset: a model may have moved to
        // another condition.
        let models: Vec<ConditionModels> = dataset
            .conditions()
            .iter()
            .map(|condition| ConditionModels::new(condition, &self.known))
            .collect();
        let mut before = std::mem::take(&mut self.conditions);
        for models in models {
            let id = models.condition().id();
            let stages = match before.remove(&id) {
                Some(mut stages) => {
                    stages.take(models);
                    stages
                }
                None => ConditionStages::new(models),
            };
            self.conditions.insert(id, stages);
        }
        drop(before);
        self.known.forget_unused();
        self.curves = Memo::default();
        self.dataset = Some(Arc::clone(dataset));
    }
}

/// Condition whose result is needed before the others: the one in view.
#[derive(Clone, Copy)]
pub struct WantedFirst<'a> {
    pub condition: ConditionId,
    /// Receives the condition's result, which is also part of the whole analysis.
    pub tell: &'a (dyn Fn(&Result<ConditionAnalysis, ConditionFailure>) + Sync),
}

/// Returns an analysis's step count. Conditions to which couplings are fitted count three times:
/// for the fit's inputs, for the fit, and for the analysis. Where physics parameters are requested,
/// each condition counts twice more: for the inputs of that fit, and for the fit.
fn steps(study: &Study) -> usize {
    let has_couplings = study.settings.couplings.kind().is_some();
    let mut steps = 0;
    for condition in study.dataset.conditions() {
        let is_fitted_to = has_couplings && !study.choice(condition.id()).held_out;
        let mut repetitions = if is_fitted_to { 3 } else { 1 };
        if study.settings.physics != PhysicsCorrection::Off {
            repetitions += 2;
        }
        steps += repetitions * ConditionStages::steps(condition);
    }
    steps
}

/// Adds cautions to the schedule, if there is one.
fn add_schedule_cautions(analysis: &mut Analysis, cautions: Vec<ScheduleCaution>) {
    if let Ok(schedule) = &mut analysis.schedule {
        schedule.cautions.extend(cautions);
    }
}

/// Fits physics parameters, and moves the physics models by them; `None` where none are requested
/// (M18.5).
fn fit_physics(
    run: Run<'_>,
    cache: &mut PhysicsMemo,
    stages: &mut BTreeMap<ConditionId, ConditionStages>,
) -> Result<Option<PhysicsOutcome>, Cancelled> {
    if run.study.settings.physics == PhysicsCorrection::Off {
        return Ok(None);
    }
    let execution = run.execution;
    let mut steps = 0;
    for id in run.study.dataset.ids() {
        if let Some(stages) = stages.get(&id) {
            steps += ConditionStages::steps(stages.models().condition());
        }
    }
    let all_stages: Vec<&mut ConditionStages> = stages.values_mut().collect();
    let sources = execution.each_owned(all_stages, |stages| stages.physics_source(run))?;
    let progress = FitProgress {
        execution,
        steps,
        reported: AtomicUsize::new(0),
    };
    let applied = cache.apply(run.study, &sources, execution.executor(), &progress)?;
    // A cached fit reports no progress: its steps are reported here.
    progress.advanced(1, 1);
    Ok(Some(applied))
}

/// Sets the values that move the physics models in every condition.
fn move_models(
    conditions: &mut BTreeMap<ConditionId, ConditionStages>,
    applied: Option<&Arc<AppliedPhysics>>,
    known: &KnownModels,
) {
    for stages in conditions.values_mut() {
        stages.apply_physics(applied, known);
    }
}

/// Fits couplings to the conditions that are analysed and not held out; `None` where couplings are
/// not requested (M16.1).
fn fit_couplings(
    run: Run<'_>,
    cache: &mut Memo<CouplingFitKey, CouplingOutcome>,
    stages: &mut BTreeMap<ConditionId, ConditionStages>,
) -> Result<Option<CouplingOutcome>, Cancelled> {
    let study = run.study;
    let execution = run.execution;
    let Some(kind) = study.settings.couplings.kind() else {
        return Ok(None);
    };
    let mut fitted_stages = Vec::new();
    let mut steps = 0;
    for (id, stages) in stages {
        if !study.choice(*id).held_out {
            steps += ConditionStages::steps(stages.models().condition());
            fitted_stages.push(stages);
        }
    }
    let sources = execution.each_owned(fitted_stages, |stages| stages.coupling_source(run))?;
    let sources: Vec<CouplingSource> = sources.into_iter().flatten().collect();
    let key = CouplingFitKey::new(study, kind, &sources);
    let progress = FitProgress {
        execution,
        steps,
        reported: AtomicUsize::new(0),
    };
    let fit = cache.get_or_fail(key, |key| {
        key.fit(study, run.grid, &sources, execution.executor(), &progress)
    })?;
    // A cached fit reports no progress: its steps are reported here.
    progress.advanced(1, 1);
    Ok(Some(fit))
}

/// Reports a fit's progress as analysis steps.
struct FitProgress<'a> {
    execution: &'a Execution<'a>,
    /// The fit's step count.
    steps: usize,
    /// Steps reported so far.
    reported: AtomicUsize,
}

impl Progress for FitProgress<'_> {
    fn cancelled(&self) -> bool {
        self.execution.progress().cancelled()
    }

    fn advanced(&self, done: usize, total: usize) {
        let reached = self.steps * done / total.max(1);
        // Several threads may report at the same time; `fetch_max` keeps the progress from
        // decreasing.
        let before = self.reported.fetch_max(reached, Ordering::Relaxed);
        self.execution.step(reached.saturating_sub(before));
    }
}

/// Analyses all conditions: first the one that is needed first, on all threads; then the others in
/// parallel.
fn analyze_conditions(
    run: Run<'_>,
    stages: &mut BTreeMap<ConditionId, ConditionStages>,
    couplings: Option<&Arc<FittedCouplings>>,
    first: Option<WantedFirst>,
) -> Result<Outcomes, Cancelled> {
    let mut outcomes = Outcomes::new();
    if let Some(first) = first
        && let Some(stages) = stages.get_mut(&first.condition)
    {
        let outcome = stages.analyze(run, couplings)?;
        (first.tell)(&outcome);
        outcomes.insert(first.condition, outcome);
    }
    let others: Vec<_> = stages
        .iter_mut()
        .filter(|(id, _)| !outcomes.contains_key(id))
        .collect();
    let others = run.execution.each_owned(others, |(id, stages)| {
        Ok((*id, stages.analyze(run, couplings)?))
    })?;
    outcomes.extend(others);
    Ok(outcomes)
}

/// Collects suspected sign and unit differences, and adds each to the conditions that show it.
fn add_doubts(study: &Study, outcomes: &mut Outcomes) -> Vec<ConventionDoubt> {
    // Signs and units are judged on the models as in the dataset.
    let mut mismatches: Vec<(ConditionId, &Mismatches)> = Vec::new();
    for (id, outcome) in outcomes.iter() {
        if let Ok(result) = outcome {
            mismatches.push((*id, &result.file_comparison().representative.mismatch));
        }
    }
    let doubts = convention_doubts(&mismatches, &study.dataset.measuring_pairs());
    for (id, outcome) in outcomes {
        if let Ok(result) = outcome {
            result.doubts = doubts
                .iter()
                .filter(|doubt| doubt.conditions.contains(id))
                .cloned()
                .collect();
        }
    }
    doubts
}
