//! The analysis of a study, stage by stage; each stage is cached while its inputs stay the same.

use std::collections::BTreeMap;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use gdcm_method::correction::leads::ChannelLeads;
use gdcm_method::correction::{Channel, Problem, ProofBudget, Solution};
use gdcm_method::schedule::settings::NOTABLE_DELAY_S;
use gdcm_method::schedule::{
    DelayScheduling, Schedule, ScheduleCaution, ScheduleSettings, ScheduledPoint,
};
use gdcm_model::dataset::{Band, Condition, ConditionId, Dataset};
use gdcm_model::executor::{Executor, Sequential};
use gdcm_model::progress::{Cancelled, Progress};
use gdcm_model::response::FrequencyGrid;

use super::condition_responses::{ConditionCurves, ConditionModels, KnownModels, Purpose};
use super::condition_stages::{ConditionStages, Run, SUBSTITUTION_PROOF, model_count};
use super::execution::{Execution, Memo};
use super::fitted_couplings::{CouplingFitKey, CouplingOutcome, CouplingSource, FittedCouplings};
use super::uncertainty::Uncertainty;
use crate::decisions::study::Study;
use crate::results::analysis::{Analysis, ConditionAnalysis, ConditionFailure};
use crate::results::assessment_table::{AssessmentChoice, assessed};
use crate::results::convention_doubt::{ConventionDoubt, convention_doubts};
use crate::results::schedule_losses;

/// Computes analyses and caches each stage's last result by the numbers in its inputs, whatever
/// their source: for a dataset in which one model has changed, one response is computed.
/// Responses (numbers of the model, band, points) -> distances -> representatives, G, D
/// (rejections, pins, average) -> bounds (quantile) -> gains, delays (constraints, weights, alpha,
/// bounds) -> schedule -> assessment. Where couplings are requested, they are fitted to the
/// representatives, and all later stages use physics models with couplings.
///
/// Conditions and models are independent of one another: the result is the same to the last bit
/// with any executor.
#[derive(Clone)]
pub struct Engine {
    executor: Arc<dyn Executor>,
    /// Budget of the proof of each condition's gains.
    proofs: ProofBudget,
    dataset: Option<Arc<Dataset>>,
    known: KnownModels,
    couplings: Memo<CouplingFitKey, CouplingOutcome>,
    conditions: BTreeMap<ConditionId, ConditionStages>,
    /// The condition drawn last.
    drawn: Option<ConditionId>,
    /// Curves of the condition drawn last.
    curves: Memo<(Band, usize), Arc<ConditionCurves>>,
}

/// Budget of a proof within a live answer; longer proofs run beside it ([`crate::jobs::job::ProofJob`]).
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

/// Outcome of each condition.
pub(crate) type Outcomes = BTreeMap<ConditionId, Result<ConditionAnalysis, ConditionFailure>>;

impl Engine {
    /// Creates an engine that runs on `executor`.
    pub fn with_executor(executor: Box<dyn Executor>) -> Self {
        Self {
            executor: executor.into(),
            proofs: ProofBudget::default(),
            dataset: None,
            known: KnownModels::default(),
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

    /// Returns the executor.
    pub(crate) fn executor(&self) -> &dyn Executor {
        self.executor.as_ref()
    }

    /// Sets the budget of the proof of each condition's gains.
    pub fn with_proofs_within(self, proofs: ProofBudget) -> Self {
        Self { proofs, ..self }
    }

    /// Shares the responses of models with other engines; for engines that work on the same band
    /// and points in turn, since only the last response of each model is cached.
    pub fn sharing(self, known: &KnownModels) -> Self {
        Self {
            known: known.clone(),
            ..self
        }
    }

    /// Replaces cached gains of the same problem with gains proven elsewhere under a larger budget.
    pub fn take_gains(&mut self, problem: &Arc<Problem>, solution: &Arc<Solution>) {
        self.conditions
            .values_mut()
            .for_each(|stages| stages.take_gains(problem, solution));
    }

    /// Analyses `study`; stages whose inputs have not changed since the last call are not computed
    /// again.
    pub fn analyze(
        &mut self,
        study: &Study,
        progress: &dyn Progress,
    ) -> Result<Analysis, Cancelled> {
        self.analyze_first(study, None, progress)
    }

    /// Works as [`Engine::analyze`], and reports the result of one condition before the others are
    /// started.
    pub fn analyze_first(
        &mut self,
        study: &Study,
        first: Option<WantedFirst>,
        progress: &dyn Progress,
    ) -> Result<Analysis, Cancelled> {
        self.take(&study.dataset);
        let grid = FrequencyGrid::logarithmic(study.settings.band, study.settings.points);
        let execution = Execution::new(self.executor.as_ref(), progress, steps(study));
        let run = Run {
            study,
            grid: &grid,
            proofs: self.proofs,
            execution: &execution,
        };
        let couplings = fit_of(run, &mut self.couplings, &mut self.conditions)?;
        let fitted = couplings.as_ref().and_then(|outcome| outcome.as_ref().ok());
        let mut conditions = analyze_conditions(run, &mut self.conditions, fitted, first)?;
        let doubts = doubts_of(study, &mut conditions);
        let settings = schedule_settings(study, &conditions);
        let mut schedule = Schedule::of(&scheduled_points(study, &conditions), settings);
        if let Ok(schedule) = &mut schedule {
            schedule
                .cautions
                .extend(signed_delays_apart(study, &conditions));
        }
        let study = study.clone();
        let omega = grid.omega().into();
        let assessment = BTreeMap::new();
        let mut analysis = Analysis {
            study,
            omega,
            conditions,
            couplings,
            coupling_assessment: None,
            doubts,
            schedule,
            assessment,
            uncertainty: None,
        };
        let choice = AssessmentChoice::of_paper(&analysis.study.settings);
        let ids: Vec<ConditionId> = analysis.study.dataset.ids().collect();
        let assess = |place: usize| Ok(assessed(&analysis, ids[place], choice)?.changes);
        let assessment = execution.each(ids.len(), 0, assess)?;
        analysis.assessment = ids.into_iter().zip(assessment).collect();
        let costs = schedule_losses::schedule_cost_cautions(&analysis);
        if let Ok(schedule) = &mut analysis.schedule {
            schedule.cautions.extend(costs);
        }
        Ok(analysis)
    }

    /// Computes the uncertainty of each figure of `analysis` (M13). Substitutions whose inputs have
    /// not changed since the last call are not computed again.
    pub fn uncertainty(
        &mut self,
        analysis: &Analysis,
        progress: &dyn Progress,
    ) -> Result<Uncertainty, Cancelled> {
        let study = &analysis.study;
        self.take(&study.dataset);
        let grid = FrequencyGrid::logarithmic(study.settings.band, study.settings.points);
        // One response and one substitution for each model.
        let total = study
            .dataset
            .conditions()
            .iter()
            .map(|of| 2 * model_count(of))
            .sum();
        let execution = Execution::new(self.executor.as_ref(), progress, total);
        let analysed = self
            .conditions
            .iter_mut()
            .filter_map(|(id, stages)| Some((*id, stages, analysis.condition(*id)?)));
        let run = Run {
            study,
            grid: &grid,
            proofs: SUBSTITUTION_PROOF,
            execution: &execution,
        };
        let substitutions = execution.each_mut(analysed.collect(), |(id, stages, condition)| {
            Ok((
                id,
                stages.substitutions(run, (condition, analysis.fitted_couplings()))?,
            ))
        })?;
        Ok(Uncertainty::of(analysis, &substitutions))
    }

    /// Returns the curves of every model of one condition on `points` frequencies of `band`; `None`
    /// where the condition does not exist.
    pub fn curves(
        &mut self,
        dataset: &Arc<Dataset>,
        condition: ConditionId,
        (band, points): (Band, usize),
        progress: &dyn Progress,
    ) -> Result<Option<Arc<ConditionCurves>>, Cancelled> {
        self.take(dataset);
        if self.drawn != Some(condition) {
            let before = self.drawn.replace(condition);
            before
                .and_then(|id| self.conditions.get(&id))
                .iter()
                .for_each(|stages| stages.models().forget_drawn());
            self.curves = Memo::default();
        }
        let Some(stages) = self.conditions.get(&condition) else {
            return Ok(None);
        };
        let executor = self.executor.as_ref();
        let models = stages.models();
        let curves = self.curves.get_or_fail((band, points), |&key| {
            let grid = FrequencyGrid::logarithmic(band, points);
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

    /// Switches to this dataset, and keeps all results for the content it shares with the last one.
    fn take(&mut self, dataset: &Arc<Dataset>) {
        if self
            .dataset
            .as_ref()
            .is_some_and(|kept| Arc::ptr_eq(kept, dataset))
        {
            return;
        }
        let models = dataset
            .conditions()
            .iter()
            .map(|condition| ConditionModels::of(condition, &self.known));
        // Collect all before dropping any of the last dataset's: a model may have moved.
        let models: Vec<ConditionModels> = models.collect();
        let mut before = std::mem::take(&mut self.conditions);
        for models in models {
            let id = models.condition().id();
            let stages = match before.remove(&id) {
                Some(mut stages) => {
                    stages.take(models);
                    stages
                }
                None => ConditionStages::of(models),
            };
            self.conditions.insert(id, stages);
        }
        drop(before);
        self.known.forget_unused();
        self.curves = Memo::default();
        self.dataset = Some(Arc::clone(dataset));
    }
}

/// The condition whose result is needed before the others.
#[derive(Clone, Copy)]
pub struct WantedFirst<'a> {
    pub condition: ConditionId,
    /// Receives its result, which is also part of the whole analysis.
    pub tell: &'a (dyn Fn(&Result<ConditionAnalysis, ConditionFailure>) + Sync),
}

/// Returns the number of steps of an analysis: those of the conditions, plus, for the conditions
/// that couplings are fitted to, once more for the inputs of the fit and once more for the fit.
fn steps(study: &Study) -> usize {
    let of = |condition: &Arc<Condition>| {
        let is_fitted_to =
            study.settings.couplings.kind().is_some() && !study.choice(condition.id()).held_out;
        ConditionStages::steps(condition) * if is_fitted_to { 3 } else { 1 }
    };
    study.dataset.conditions().iter().map(of).sum()
}

/// Fits the couplings of a study to the conditions that are analysed and not held out; `None` where
/// couplings are not requested (M16.1).
fn fit_of(
    run: Run<'_>,
    kept: &mut Memo<CouplingFitKey, CouplingOutcome>,
    stages: &mut BTreeMap<ConditionId, ConditionStages>,
) -> Result<Option<CouplingOutcome>, Cancelled> {
    let Run {
        study,
        grid,
        execution,
        ..
    } = run;
    let Some(kind) = study.settings.couplings.kind() else {
        return Ok(None);
    };
    let chosen: Vec<_> = stages
        .iter_mut()
        .filter(|(id, _)| !study.choice(**id).held_out)
        .collect();
    let steps = chosen
        .iter()
        .map(|(_, stages)| ConditionStages::steps(stages.models().condition()))
        .sum();
    let sources = execution.each_mut(chosen, |(_, stages)| stages.coupling_source(run))?;
    let sources: Vec<CouplingSource> = sources.into_iter().flatten().collect();
    let key = CouplingFitKey::of(study, kind, &sources);
    let solves = Solves {
        execution,
        steps,
        told: AtomicUsize::new(0),
    };
    let fit = kept.get_or_fail(key, |key| {
        key.fit(study, grid, &sources, (execution.parts().0, &solves))
    })?;
    // No solve was reported where the fit is cached.
    solves.advanced(1, 1);
    Ok(Some(fit))
}

/// Reports the progress of a fit as steps of the analysis.
struct Solves<'a> {
    execution: &'a Execution<'a>,
    /// Number of steps of the fit.
    steps: usize,
    told: AtomicUsize,
}

impl Progress for Solves<'_> {
    fn cancelled(&self) -> bool {
        self.execution.progress().cancelled()
    }

    fn advanced(&self, done: usize, total: usize) {
        let told = self.steps * done / total.max(1);
        // Several threads may report at the same time; progress never goes backwards.
        let before = self.told.fetch_max(told, Ordering::Relaxed);
        self.execution.step(told.saturating_sub(before));
    }
}

/// Analyses all conditions: first the one needed first, on all threads, then the others in
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
    let others = run.execution.each_mut(others, |(id, stages)| {
        Ok((*id, stages.analyze(run, couplings)?))
    })?;
    outcomes.extend(others);
    Ok(outcomes)
}

/// Collects suspected sign and unit differences, and adds each to the conditions that show it.
fn doubts_of(study: &Study, outcomes: &mut Outcomes) -> Vec<ConventionDoubt> {
    let solved = outcomes
        .iter()
        .filter_map(|(id, outcome)| Some((*id, outcome.as_ref().ok()?)));
    // Signs and units are judged on the models without couplings.
    let mismatches =
        solved.map(|(id, result)| (id, &result.before_couplings().representative.mismatch));
    let doubts = convention_doubts(
        &mismatches.collect::<Vec<_>>(),
        &study.dataset.measuring_pairs(),
    );
    for (id, result) in outcomes
        .iter_mut()
        .filter_map(|(id, outcome)| Some((id, outcome.as_mut().ok()?)))
    {
        result.doubts = doubts
            .iter()
            .filter(|doubt| doubt.conditions.contains(id))
            .cloned()
            .collect();
    }
    doubts
}

/// Returns the scheduled conditions with a result, in the dataset's order.
pub(crate) fn scheduled_points<'a>(
    study: &Study,
    outcomes: &'a Outcomes,
) -> Vec<ScheduledPoint<'a>> {
    let point = |analysis: &'a ConditionAnalysis| {
        let state = analysis.condition.flight_state();
        ScheduledPoint {
            airspeed_kt: state.airspeed_kt,
            correction: &analysis.correction,
            delay_upper_s: analysis.delay_upper_s(),
            second: study
                .settings
                .schedule
                .second
                .and_then(|variable| variable.value(state)),
        }
    };
    in_schedule(study, outcomes).map(point).collect()
}

/// Returns the schedule settings for these conditions, with the choice about delays resolved for
/// them (M11).
pub(crate) fn schedule_settings(study: &Study, outcomes: &Outcomes) -> ScheduleSettings {
    let delays = match study.settings.schedule_delays {
        DelayScheduling::Always => true,
        DelayScheduling::Never => false,
        DelayScheduling::Automatic => in_schedule(study, outcomes).any(has_notable_delay),
    };
    ScheduleSettings {
        delays,
        ..study.settings.schedule
    }
}

/// Returns whether a constrained response has a net delay above half a millisecond.
fn has_notable_delay(result: &ConditionAnalysis) -> bool {
    result
        .held()
        .marked()
        .any(|pair| result.correction.net_delay_s(pair) > NOTABLE_DELAY_S)
}

/// Returns the results of the scheduled conditions, in file order.
fn in_schedule<'a>(
    study: &Study,
    outcomes: &'a Outcomes,
) -> impl Iterator<Item = &'a ConditionAnalysis> {
    let chosen = study
        .dataset
        .ids()
        .filter(|id| study.choice(*id).is_in_schedule());
    chosen.filter_map(|id| outcomes.get(&id)?.as_ref().ok())
}

/// Returns cautions about the channels for which no schedule can reproduce the signed delays of all
/// conditions (M15.6).
fn signed_delays_apart(study: &Study, outcomes: &Outcomes) -> Vec<ScheduleCaution> {
    /// Greatest distance \[s\] from the mean of a signed delay that can be scheduled.
    const APART_S: f64 = 0.02;
    /// Signed delays below this \[s\] have no meaningful sign.
    const NOTHING_S: f64 = 2e-3;
    let leads = in_schedule(study, outcomes)
        .filter_map(|result| Some((result.condition.id(), &result.compensated.as_ref()?.leads)));
    let leads: Vec<(ConditionId, &ChannelLeads)> = leads.collect();
    let caution = |channel: Channel| {
        let taus_s: Vec<(ConditionId, f64)> = leads
            .iter()
            .map(|(id, leads)| (*id, leads.taus_s[channel]))
            .collect();
        let sum_s: f64 = taus_s.iter().map(|(_, tau_s)| tau_s).sum();
        let mean_s = sum_s / taus_s.len() as f64;
        let apart = |tau_s: f64| (tau_s - mean_s).abs();
        let &(condition, tau_s) = taus_s
            .iter()
            .max_by(|a, b| apart(a.1).total_cmp(&apart(b.1)))?;
        let signs =
            [-1.0, 1.0].map(|sign| taus_s.iter().any(|(_, tau_s)| sign * tau_s > NOTHING_S));
        let elsewhere_s = (sum_s - tau_s) / (taus_s.len() as f64 - 1.0);
        (taus_s.len() > 1 && (apart(tau_s) > APART_S || signs == [true; 2])).then_some(
            ScheduleCaution::SignedDelayApart {
                channel,
                condition,
                tau_s,
                elsewhere_s,
            },
        )
    };
    Channel::all_of(&study.dataset)
        .filter_map(caution)
        .collect()
}
