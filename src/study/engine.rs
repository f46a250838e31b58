//! The analysis of a study, stage by stage, each kept while what it depends on stays the same.

use std::sync::Arc;

use crate::correction::{GainProblem, GainSolution, ProofBudget};
use crate::dataset::{Band, Dataset};
use crate::response::FrequencyGrid;
use crate::schedule::{Schedule, ScheduleError, ScheduledPoint, assess};

use super::analysis::{Analysis, Assessed};
use super::condition_analysis::{ConditionAnalysis, ConditionFailure};
use super::condition_stages::{ConditionStages, model_count};
use super::curves::ConditionCurves;
use super::document::Study;
use super::executor::{Execution, Executor, Sequential};
use super::memo::Memo;
use super::progress::{Cancelled, Progress};

/// Computes analyses and keeps each stage's last result:
/// responses (band, points) -> distances -> representatives, G, D (rejections, pins, average) -> bounds (quantile) ->
/// gains, delays (constraints, weights, alpha, bounds) -> schedule -> assessment.
///
/// Neither conditions nor models depend on one another: the result is the same to the last bit whoever carries them out.
pub struct Engine {
    executor: Box<dyn Executor>,
    /// How far the proof of each condition's gains may go.
    proofs: ProofBudget,
    dataset: Option<Arc<Dataset>>,
    conditions: Vec<ConditionStages>,
    /// Curves of the condition drawn last.
    curves: Memo<(usize, Band, usize), Arc<ConditionCurves>>,
}

/// The budget of a proof that an answer may wait for; what needs more of it is proven beside the answer ([`super::ProofJob`]).
pub const LIVE_PROOF: ProofBudget = ProofBudget { boxes: 1_000, minima: 300 };

impl Default for Engine {
    fn default() -> Self {
        Self::with_executor(Box::new(Sequential))
    }
}

/// What came of each condition.
type Outcomes = Vec<Result<ConditionAnalysis, ConditionFailure>>;

impl Engine {
    /// An engine whose work is carried out by `executor`.
    pub fn with_executor(executor: Box<dyn Executor>) -> Self {
        Self {
            executor,
            proofs: ProofBudget::default(),
            dataset: None,
            conditions: Vec::new(),
            curves: Memo::default(),
        }
    }

    /// The same engine with another budget for the proof of each condition's gains.
    pub fn with_proofs_within(self, proofs: ProofBudget) -> Self {
        Self { proofs, ..self }
    }

    /// Takes gains that were proven elsewhere, with a larger budget, in place of its own for the same problem.
    pub fn take_gains(&mut self, problem: &Arc<GainProblem>, solution: &Arc<GainSolution>) {
        self.conditions.iter_mut().for_each(|stages| stages.take_gains(problem, solution));
    }

    /// The analysis of `study`; stages that do not depend on what changed since the last call are not computed again.
    pub fn analyze(&mut self, study: &Study, progress: &dyn Progress) -> Result<Analysis, Cancelled> {
        self.take(&study.dataset);
        let grid = FrequencyGrid::logarithmic(study.settings.band, study.settings.points);
        let total = study.dataset.conditions().iter().map(|of| ConditionStages::steps(of)).sum();
        let execution = Execution::new(self.executor.as_ref(), progress, total);
        let conditions = analyze_conditions(&mut self.conditions, study, &grid, self.proofs, &execution)?;
        let schedule = Schedule::of(&scheduled_points(study, &conditions), study.settings.schedule);
        let assessed = |index: usize| assessed(study, index, &conditions[index], &schedule, &grid);
        let assessment = execution.each(conditions.len(), 0, assessed)?;
        Ok(Analysis { study: study.clone(), omega: grid.omega().into(), conditions, schedule, assessment })
    }

    /// The curves of every model of one condition on `points` frequencies of `band`.
    pub fn curves(
        &mut self,
        dataset: &Arc<Dataset>,
        condition: usize,
        (band, points): (Band, usize),
        progress: &dyn Progress,
    ) -> Result<Arc<ConditionCurves>, Cancelled> {
        self.take(dataset);
        let (executor, prepared) = (self.executor.as_ref(), self.conditions[condition].prepared());
        let of = &dataset.conditions()[condition];
        self.curves.get_or_fail((condition, band, points), |_| {
            let grid = FrequencyGrid::logarithmic(band, points);
            let execution = Execution::new(executor, progress, model_count(of));
            let responses = prepared.responses(of, &grid, &execution)?;
            Ok(Arc::new(ConditionCurves::new(grid, responses)))
        })
    }

    fn take(&mut self, dataset: &Arc<Dataset>) {
        if !self.dataset.as_ref().is_some_and(|kept| Arc::ptr_eq(kept, dataset)) {
            self.conditions = dataset.conditions().iter().map(|of| ConditionStages::of(of)).collect();
            self.curves = Memo::default();
            self.dataset = Some(Arc::clone(dataset));
        }
    }
}

/// All conditions: first the one that is wanted first, by everybody together, then the others side by side.
fn analyze_conditions(
    stages: &mut [ConditionStages],
    study: &Study,
    grid: &FrequencyGrid,
    proofs: ProofBudget,
    execution: &Execution<'_>,
) -> Result<Outcomes, Cancelled> {
    let first = execution.progress().wanted_first().filter(|&first| first < stages.len());
    let mut first_outcome = None;
    if let Some(first) = first {
        let outcome = stages[first].analyze(study, first, grid, proofs, execution)?;
        execution.progress().first_result(&outcome);
        first_outcome = Some(outcome);
    }
    let others: Vec<(usize, &mut ConditionStages)> =
        stages.iter_mut().enumerate().filter(|(index, _)| Some(*index) != first).collect();
    let mut outcomes =
        execution.each_mut(others, |(index, stages)| stages.analyze(study, index, grid, proofs, execution))?;
    if let (Some(first), Some(outcome)) = (first, first_outcome) {
        outcomes.insert(first, outcome);
    }
    Ok(outcomes)
}

fn scheduled_points<'a>(
    study: &Study,
    conditions: &'a [Result<ConditionAnalysis, ConditionFailure>],
) -> Vec<ScheduledPoint<'a>> {
    let chosen = conditions.iter().enumerate().filter(|(index, _)| study.choices[*index].scheduled);
    chosen
        .filter_map(|(index, analysis)| {
            let airspeed_kt = study.dataset.conditions()[index].flight_state().airspeed_kt;
            Some(ScheduledPoint { airspeed_kt, correction: &analysis.as_ref().ok()?.correction })
        })
        .collect()
}

fn assessed(
    study: &Study,
    index: usize,
    analysis: &Result<ConditionAnalysis, ConditionFailure>,
    schedule: &Result<Schedule, ScheduleError>,
    grid: &FrequencyGrid,
) -> Assessed {
    let condition = &study.dataset.conditions()[index];
    let left_out = |why: String| Assessed::LeftOut { why };
    match (analysis, schedule) {
        _ if study.choices[index].physics.rejected.contains(&condition.nominal()) => {
            left_out("the nominal model is rejected".to_owned())
        }
        (Err(failure), _) => left_out(failure.to_string()),
        (_, Err(error)) => left_out(error.to_string()),
        (Ok(analysis), Ok(schedule)) => {
            let models = &analysis.comparison.nominal;
            let correction = schedule.at(condition.flight_state().airspeed_kt);
            let average = study.settings.cost_average;
            Assessed::Nominal(assess(&models.mismatch, &models.cost, &correction, grid.omega(), average))
        }
    }
}
