//! The analysis of a study, stage by stage, each kept while what it depends on stays the same.

use std::collections::BTreeMap;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use gdcm_method::correction::leads::ChannelLeads;
use gdcm_method::correction::{Channel, Problem, ProofBudget, Solution};
use gdcm_method::schedule::{
    DelayScheduling, NOTABLE_DELAY_S, Schedule, ScheduleCaution, ScheduleSettings, ScheduledPoint,
};
use gdcm_model::dataset::{Band, Condition, ConditionId, Dataset};
use gdcm_model::executor::{Executor, Sequential};
use gdcm_model::progress::{Cancelled, Progress};
use gdcm_model::response::FrequencyGrid;

use super::analysis::{Analysis, ConditionAnalysis, ConditionFailure};
use super::assessment_table::{AssessmentChoice, assessed};
use super::condition_responses::{ConditionCurves, ConditionModels, KnownModels, Purpose};
use super::condition_stages::{ConditionStages, Run, SUBSTITUTION_PROOF, model_count};
use super::convention_doubt::{ConventionDoubt, convention_doubts};
use super::execution::{Execution, Memo};
use super::fitted_couplings::{CouplingFitKey, CouplingOutcome, CouplingSource, FittedCouplings};
use super::uncertainty::Uncertainty;
use super::{Study, schedule_losses};

/// Computes analyses and keeps each stage's last result by what it is computed from, never by where that came from: of a dataset
/// with one other model, one response is computed.
/// Responses (numbers of the model, band, points) -> distances -> representatives, G, D (rejections, pins, average) -> bounds (quantile) ->
/// gains, delays (constraints, weights, alpha, bounds) -> schedule -> assessment.
/// Where couplings are asked for, they are fitted to the representatives and what follows these is of physics models with couplings.
///
/// Neither conditions nor models depend on one another: the result is the same to the last bit whoever carries them out.
#[derive(Clone)]
pub struct Engine {
    executor: Arc<dyn Executor>,
    /// How far the proof of each condition's gains may go.
    proofs: ProofBudget,
    dataset: Option<Arc<Dataset>>,
    known: KnownModels,
    couplings: Memo<CouplingFitKey, CouplingOutcome>,
    conditions: BTreeMap<ConditionId, ConditionStages>,
    /// The condition drawn last.
    drawn: Option<ConditionId>,
    /// Its curves.
    curves: Memo<(Band, usize), Arc<ConditionCurves>>,
}

/// The budget of a proof that an answer may wait for; what needs more of it is proven beside the answer ([`super::job::ProofJob`]).
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

/// What came of each condition.
pub(super) type Outcomes = BTreeMap<ConditionId, Result<ConditionAnalysis, ConditionFailure>>;

impl Engine {
    /// An engine whose work is carried out by `executor`.
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

    /// Another engine that knows what this one has computed, and goes its own way from there.
    pub fn fork(&self, executor: Box<dyn Executor>) -> Self {
        Self {
            executor: executor.into(),
            ..self.clone()
        }
    }

    /// Who carries out its work.
    pub(super) fn executor(&self) -> &dyn Executor {
        self.executor.as_ref()
    }

    /// The same engine with another budget for the proof of each condition's gains.
    pub fn with_proofs_within(self, proofs: ProofBudget) -> Self {
        Self { proofs, ..self }
    }

    /// The same engine with the responses of models that other engines know; for engines that work on the same band and points in
    /// turn, since of each model the last response is kept.
    pub fn sharing(self, known: &KnownModels) -> Self {
        Self {
            known: known.clone(),
            ..self
        }
    }

    /// Takes gains that were proven elsewhere, with a larger budget, in place of its own for the same problem.
    pub fn take_gains(&mut self, problem: &Arc<Problem>, solution: &Arc<Solution>) {
        self.conditions
            .values_mut()
            .for_each(|stages| stages.take_gains(problem, solution));
    }

    /// The analysis of `study`; stages that do not depend on what changed since the last call are not computed again.
    pub fn analyze(
        &mut self,
        study: &Study,
        progress: &dyn Progress,
    ) -> Result<Analysis, Cancelled> {
        self.analyze_first(study, None, progress)
    }

    /// As [`Engine::analyze`], with the result of one condition told before the others are begun.
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

    /// How sure each figure of `analysis` is (M13). Substitutions of models that do not depend on what changed since the last call are not
    /// computed again.
    pub fn uncertainty(
        &mut self,
        analysis: &Analysis,
        progress: &dyn Progress,
    ) -> Result<Uncertainty, Cancelled> {
        let study = &analysis.study;
        self.take(&study.dataset);
        let grid = FrequencyGrid::logarithmic(study.settings.band, study.settings.points);
        // A response and a substitution for each model.
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

    /// The curves of every model of one condition on `points` frequencies of `band`; none of a condition that is not there.
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

    /// Goes on with this dataset: whatever it shares with the last one stays computed.
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
        // All are made before any of the last dataset's is dropped: a model may have moved.
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

/// The condition whose result is wanted before the others'.
#[derive(Clone, Copy)]
pub struct WantedFirst<'a> {
    /// The condition.
    pub condition: ConditionId,
    /// Is told its result, which the whole analysis will contain.
    pub tell: &'a (dyn Fn(&Result<ConditionAnalysis, ConditionFailure>) + Sync),
}

/// Steps of an analysis: those of the conditions; of those that couplings are fitted to once more for what goes into the fit, and
/// once more for the fit.
fn steps(study: &Study) -> usize {
    let of = |condition: &Arc<Condition>| {
        let is_fitted_to =
            study.settings.couplings.kind().is_some() && !study.choice(condition.id()).held_out;
        ConditionStages::steps(condition) * if is_fitted_to { 3 } else { 1 }
    };
    study.dataset.conditions().iter().map(of).sum()
}

/// The couplings of a study, fitted to the conditions that are analysed and not held out; none where they are not asked for (M16.1).
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
    // None of them was told where the fit is known.
    solves.advanced(1, 1);
    Ok(Some(fit))
}

/// Reports the progress of a fit as steps of the analysis.
struct Solves<'a> {
    execution: &'a Execution<'a>,
    /// How many steps the fit is.
    steps: usize,
    told: AtomicUsize,
}

impl Progress for Solves<'_> {
    fn cancelled(&self) -> bool {
        self.execution.progress().cancelled()
    }

    fn advanced(&self, done: usize, total: usize) {
        let told = self.steps * done / total.max(1);
        // Several threads may report at once: never backwards.
        let before = self.told.fetch_max(told, Ordering::Relaxed);
        self.execution.step(told.saturating_sub(before));
    }
}

/// All conditions: first the one that is wanted first, by everybody together, then the others side by side.
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

/// Signs and units that are to be asked after, told to each condition that shows them too.
fn doubts_of(study: &Study, outcomes: &mut Outcomes) -> Vec<ConventionDoubt> {
    let solved = outcomes
        .iter()
        .filter_map(|(id, outcome)| Some((*id, outcome.as_ref().ok()?)));
    // Signs and units are those of the models as they are.
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

/// The scheduled conditions that have a result, in the dataset's order.
pub(super) fn scheduled_points<'a>(
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

/// The settings of the schedule of these conditions, with what the choice of delays comes to in them (M11).
pub(super) fn schedule_settings(study: &Study, outcomes: &Outcomes) -> ScheduleSettings {
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

/// Whether a constrained response has a net delay above half a millisecond.
fn has_notable_delay(result: &ConditionAnalysis) -> bool {
    result
        .held()
        .marked()
        .any(|pair| result.correction.net_delay_s(pair) > NOTABLE_DELAY_S)
}

/// The results of the conditions that are in the schedule, in file order.
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

/// The channels of which no schedule can hold the signed delays of all conditions (M15.6).
fn signed_delays_apart(study: &Study, outcomes: &Outcomes) -> Vec<ScheduleCaution> {
    /// Farther than this \[s\] from the mean a signed delay is not scheduled.
    const APART_S: f64 = 0.02;
    /// Below this \[s\] a sign says nothing.
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
