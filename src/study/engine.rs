//! The analysis of a study, stage by stage, each kept while what it depends on stays the same.

use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use crate::correction::{
    ChannelCorrection, DelayError, DelayProblem, DelaySolution, GainBounds, GainError, GainProblem, GainSolution,
    ProofBudget, delay_upper_s, gain_bounds, solve_delays, solve_gains,
};
use crate::dataset::{Band, BundleKind, Condition, Dataset, Dynamics, PairTable};
use crate::fidelity::CostAverage;
use crate::response::FrequencyGrid;
use crate::schedule::{CostChange, Schedule, ScheduledPoint, assess};

use super::analysis::{Analysis, Assessed};
use super::caution::Caution;
use super::comparison::{BundleFigures, Comparison, ConditionResponses};
use super::condition_analysis::{ConditionAnalysis, ConditionFailure};
use super::crew::{Alone, Crew, Job};
use super::document::{ConditionChoice, Study};
use super::memo::Memo;
use super::settings::Settings;
use super::watch::{Stopped, Watch};

/// Computes analyses and keeps each stage's last result:
/// responses (band, points) -> distances -> representatives, G, D (rejections, pins, average) -> bounds (quantile) ->
/// gains, delays (constraints, weights, alpha, bounds) -> schedule -> assessment.
///
/// Conditions do not depend on one another: the result is the same to the last bit whoever carries them out.
pub struct Engine {
    crew: Box<dyn Crew>,
    dataset: Option<Arc<Dataset>>,
    conditions: Vec<ConditionStages>,
}

impl Default for Engine {
    fn default() -> Self {
        Self::with_crew(Box::new(Alone))
    }
}

/// What the responses and the distances depend on, besides the condition.
type GridKey = (Band, usize);
/// What the comparison of the representatives depends on, besides the condition.
type ComparisonKey = (GridKey, ConditionChoice, CostAverage);
/// What the bounds depend on: the comparison, the quantile, and the bounds set by hand.
type BoundsKey = (ComparisonKey, f64, Option<GainBounds>, Option<f64>);

#[derive(Debug, Default)]
struct ConditionStages {
    responses: Memo<GridKey, Arc<ConditionResponses>>,
    figures: Memo<GridKey, Arc<BundleFigures>>,
    comparison: Memo<ComparisonKey, Arc<Comparison>>,
    bounds: Memo<BoundsKey, (GainBounds, f64)>,
    gains: Memo<Arc<GainProblem>, Result<Arc<GainSolution>, GainError>>,
    delays: Memo<Arc<DelayProblem>, Result<Arc<DelaySolution>, DelayError>>,
    cost: Memo<(ComparisonKey, ChannelCorrection), Arc<PairTable<Option<CostChange>>>>,
}

impl Engine {
    /// An engine whose conditions are carried out by `crew`.
    pub fn with_crew(crew: Box<dyn Crew>) -> Self {
        Self { crew, dataset: None, conditions: Vec::new() }
    }

    /// The analysis of `study`; stages that do not depend on what changed since the last call are not computed again.
    pub fn analyze(&mut self, study: &Study, watch: &dyn Watch) -> Result<Analysis, Stopped> {
        self.take(&study.dataset);
        let grid = FrequencyGrid::logarithmic(study.settings.band, study.settings.points);
        let conditions = self.analyze_conditions(study, &grid, watch)?;
        let schedule = Schedule::of(&scheduled_points(study, &conditions), study.settings.schedule);
        let assess = |index: usize| assessed(study, index, &conditions[index], &schedule, &grid);
        let assessment = self.each(conditions.len(), assess);
        Ok(Analysis { study: study.clone(), omega: grid.omega().into(), conditions, schedule, assessment })
    }

    fn analyze_conditions(
        &mut self,
        study: &Study,
        grid: &FrequencyGrid,
        watch: &dyn Watch,
    ) -> Result<Vec<Result<ConditionAnalysis, ConditionFailure>>, Stopped> {
        let (total, done) = (self.conditions.len(), AtomicUsize::new(0));
        let mut results: Vec<Option<_>> = Vec::new();
        results.resize_with(total, || None);
        let slots = self.conditions.iter_mut().zip(&mut results).enumerate();
        let done = &done;
        let jobs = slots.map(|(index, (stages, result))| -> Job<'_> {
            Box::new(move || {
                if !watch.stopped() {
                    *result = Some(stages.analyze(study, index, grid));
                    watch.progress(done.fetch_add(1, Ordering::Relaxed) + 1, total);
                }
            })
        });
        self.crew.carry_out(jobs.collect());
        results.into_iter().collect::<Option<Vec<_>>>().ok_or(Stopped)
    }

    /// `of(0), of(1), ...`, carried out by the crew.
    fn each<T: Send>(&self, count: usize, of: impl Fn(usize) -> T + Sync) -> Vec<T> {
        let mut results: Vec<Option<T>> = Vec::new();
        results.resize_with(count, || None);
        let of = &of;
        let jobs = results.iter_mut().enumerate();
        self.crew.carry_out(
            jobs.map(|(index, result)| -> Job<'_> { Box::new(move || *result = Some(of(index))) }).collect(),
        );
        results.into_iter().flatten().collect()
    }

    fn take(&mut self, dataset: &Arc<Dataset>) {
        if !self.dataset.as_ref().is_some_and(|kept| Arc::ptr_eq(kept, dataset)) {
            self.conditions = dataset.conditions().iter().map(|_| ConditionStages::default()).collect();
            self.dataset = Some(Arc::clone(dataset));
        }
    }
}

impl ConditionStages {
    fn analyze(
        &mut self,
        study: &Study,
        index: usize,
        grid: &FrequencyGrid,
    ) -> Result<ConditionAnalysis, ConditionFailure> {
        let (settings, condition) = (&study.settings, &study.dataset.conditions()[index]);
        let measuring = study.dataset.measuring_pairs();
        let grid_key = (settings.band, settings.points);
        let responses = self.responses.get(grid_key, |_| Arc::new(ConditionResponses::of(condition, grid)));
        let figures =
            self.figures.get(grid_key, |_| Arc::new(BundleFigures::of(condition, &responses, grid, &measuring)));
        let choice = &study.choices[index];
        let key: ComparisonKey = (grid_key, choice.clone(), settings.cost_average);
        let comparison = self.comparison.get(key.clone(), |_| {
            Arc::new(Comparison::of(condition, &responses, &figures, grid, choice, settings.cost_average))
        });
        check_comparable(condition, &comparison)?;
        let bounds_key = (key.clone(), settings.quantile, settings.gain_bounds, settings.delay_upper_s);
        let bounds = self.bounds.get(bounds_key, |_| bounds_of(&comparison, settings, &measuring, grid));
        let solved = self.solve(&comparison, settings, bounds)?;
        let correction = solved.correction();
        let cost = self.cost.get((key, correction.clone()), |(_, correction)| {
            let models = &comparison.representative;
            Arc::new(assess(&models.mismatch, &models.cost, correction, grid.omega(), settings.cost_average))
        });
        let cautions = cautions_of(condition, choice, settings, &comparison, &figures);
        let Solved { gain_problem, delay_problem, gains, delays } = solved;
        Ok(ConditionAnalysis {
            figures,
            comparison,
            gain_problem,
            delay_problem,
            gains,
            delays,
            correction,
            cost,
            cautions,
        })
    }

    fn solve(
        &mut self,
        comparison: &Comparison,
        settings: &Settings,
        (bounds, upper_s): (GainBounds, f64),
    ) -> Result<Solved, ConditionFailure> {
        let delta = &comparison.delta;
        let held = settings.constrained.map(|pair, constrained| *constrained && delta.gain[pair].is_some());
        let gain_problem = Arc::new(GainProblem {
            wanted: delta.gain.clone(),
            constrained: held.clone(),
            fitted: settings.fitted.clone(),
            bounds,
            alpha: settings.alpha_gain,
            objective: settings.gain_objective,
        });
        let delay_problem = Arc::new(DelayProblem {
            wanted_s: delta.delay_s.clone(),
            constrained: held,
            fitted: settings.fitted.clone(),
            upper_s,
            alpha: settings.alpha_delay,
        });
        let solve = |problem: &Arc<GainProblem>| solve_gains(problem, ProofBudget::default()).map(Arc::new);
        let gains = self.gains.get(Arc::clone(&gain_problem), solve)?;
        let delays = self.delays.get(Arc::clone(&delay_problem), |problem| solve_delays(problem).map(Arc::new))?;
        Ok(Solved { gain_problem, delay_problem, gains, delays })
    }
}

/// The two optima of a condition with what they are the optima of.
struct Solved {
    gain_problem: Arc<GainProblem>,
    delay_problem: Arc<DelayProblem>,
    gains: Arc<GainSolution>,
    delays: Arc<DelaySolution>,
}

impl Solved {
    fn correction(&self) -> ChannelCorrection {
        ChannelCorrection {
            input_gains: self.gains.inputs.clone(),
            output_gains: self.gains.outputs.clone(),
            input_delays_s: self.delays.inputs_s.clone(),
            output_delays_s: self.delays.outputs_s.clone(),
        }
    }
}

fn check_comparable(condition: &Condition, comparison: &Comparison) -> Result<(), ConditionFailure> {
    if comparison.delta.gain.iter().any(|(_, gain)| gain.is_some()) {
        return Ok(());
    }
    let name = |kind, model: usize| condition.bundle(kind)[model].name.clone();
    Err(ConditionFailure::NothingToCompare {
        physics: name(BundleKind::Physics, comparison.physics.model),
        identified: name(BundleKind::Identified, comparison.identified.model),
    })
}

fn bounds_of(
    comparison: &Comparison,
    settings: &Settings,
    measuring: &PairTable<bool>,
    grid: &FrequencyGrid,
) -> (GainBounds, f64) {
    let mismatch = &comparison.representative.mismatch;
    let gains = settings.gain_bounds.unwrap_or_else(|| gain_bounds(mismatch, measuring, settings.quantile));
    let delay =
        settings.delay_upper_s.unwrap_or_else(|| delay_upper_s(mismatch, measuring, grid.omega(), settings.quantile));
    (gains, delay)
}

fn cautions_of(
    condition: &Condition,
    choice: &ConditionChoice,
    settings: &Settings,
    comparison: &Comparison,
    figures: &BundleFigures,
) -> Vec<Caution> {
    let undefined = settings.constrained.marked().filter(|&pair| comparison.delta.gain[pair].is_none());
    let mut cautions: Vec<Caution> = undefined.map(|pair| Caution::HeldButUndefined { pair }).collect();
    cautions.extend(figures.discontinuity.as_ref().err().cloned().map(Caution::NoSuggestions));
    for (index, model) in condition.bundle(BundleKind::Identified).iter().enumerate() {
        let Dynamics::Measured(response) = &model.dynamics else {
            continue;
        };
        let (min, max) = (response.omega()[0], response.omega()[response.omega().len() - 1]);
        let covered = min <= settings.band.min() && settings.band.max() <= max;
        if !covered && !choice.identified.rejected.contains(&index) {
            cautions.push(Caution::BandNotCovered { model: model.name.clone(), min, max });
        }
    }
    cautions
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
    schedule: &Result<Schedule, crate::schedule::ScheduleError>,
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
