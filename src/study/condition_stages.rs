//! The stages of one condition, each kept while what it depends on stays the same.

use std::sync::Arc;

use crate::correction::{
    Bounds, ChannelCorrection, GainBounds, Problem, ProblemError, ProofBudget, Quantity, Solution, delay_upper_s,
    gain_bounds, solve,
};
use crate::dataset::{Band, BundleKind, Condition, Dynamics, PairTable};
use crate::fidelity::CostAverage;
use crate::response::FrequencyGrid;
use crate::schedule::{CostChange, assess};

use super::caution::Caution;
use super::comparison::{BundleFigures, Comparison};
use super::condition_analysis::{ConditionAnalysis, ConditionFailure};
use super::condition_responses::{ConditionResponses, PreparedCondition};
use super::document::{ConditionChoice, Study};
use super::effort::Effort;
use super::memo::Memo;
use super::settings::Settings;
use super::watch::Stopped;

/// What the responses and the distances depend on, besides the condition.
type GridKey = (Band, usize);
/// What the comparison of the representatives depends on, besides the condition.
type ComparisonKey = (GridKey, ConditionChoice, CostAverage);
/// What the bounds depend on: the comparison, the quantile, and the bounds set by hand.
type BoundsKey = (ComparisonKey, f64, Option<GainBounds>, Option<f64>);

/// The last result of each stage of a condition.
#[derive(Debug)]
pub(super) struct ConditionStages {
    prepared: PreparedCondition,
    responses: Memo<GridKey, Arc<ConditionResponses>>,
    figures: Memo<GridKey, Arc<BundleFigures>>,
    comparison: Memo<ComparisonKey, Arc<Comparison>>,
    bounds: Memo<BoundsKey, (GainBounds, f64)>,
    gains: Memo<Arc<Problem>, Solved>,
    delays: Memo<Arc<Problem>, Solved>,
    cost: Memo<(ComparisonKey, ChannelCorrection), Arc<PairTable<Option<CostChange>>>>,
}

impl ConditionStages {
    /// Nothing computed yet.
    pub(super) fn of(condition: &Condition) -> Self {
        Self {
            prepared: PreparedCondition::of(condition),
            responses: Memo::default(),
            figures: Memo::default(),
            comparison: Memo::default(),
            bounds: Memo::default(),
            gains: Memo::default(),
            delays: Memo::default(),
            cost: Memo::default(),
        }
    }

    /// Steps of the analysis of a condition: three for each model, and one.
    pub(super) fn steps(condition: &Condition) -> usize {
        3 * model_count(condition) + 1
    }

    /// The models, prepared for their responses.
    pub(super) fn prepared(&self) -> &PreparedCondition {
        &self.prepared
    }

    /// Whatever is not kept of the analysis of condition `index`.
    pub(super) fn analyze(
        &mut self,
        study: &Study,
        index: usize,
        grid: &FrequencyGrid,
        effort: &Effort<'_>,
    ) -> Result<Result<ConditionAnalysis, ConditionFailure>, Stopped> {
        let (settings, condition) = (&study.settings, &study.dataset.conditions()[index]);
        let grid_key = (settings.band, settings.points);
        if self.figures.holds(&grid_key) {
            effort.step(3 * model_count(condition));
        }
        let responses = self.responses.get_or_fail(grid_key, |_| {
            let responses = self.prepared.responses(condition, grid, effort);
            responses.map(Arc::new)
        })?;
        let figures = self.figures.get_or_fail(grid_key, |_| {
            let figures = BundleFigures::of(condition, &responses, &study.dataset.measuring_pairs(), effort);
            figures.map(Arc::new)
        })?;
        let outcome = self.compare_and_solve(study, index, grid, &responses, figures, effort)?;
        effort.step(1);
        Ok(outcome)
    }

    fn compare_and_solve(
        &mut self,
        study: &Study,
        index: usize,
        grid: &FrequencyGrid,
        responses: &ConditionResponses,
        figures: Arc<BundleFigures>,
        effort: &Effort<'_>,
    ) -> Result<Result<ConditionAnalysis, ConditionFailure>, Stopped> {
        let (settings, condition) = (&study.settings, &study.dataset.conditions()[index]);
        let measuring = study.dataset.measuring_pairs();
        let grid_key = (settings.band, settings.points);
        let choice = &study.choices[index];
        let key: ComparisonKey = (grid_key, choice.clone(), settings.cost_average);
        let comparison = self.comparison.get(key.clone(), |_| {
            Arc::new(Comparison::of(condition, responses, &figures, grid, choice, settings.cost_average))
        });
        if let Err(failure) = check_comparable(condition, &comparison) {
            return Ok(Err(failure));
        }
        let bounds_key = (key.clone(), settings.quantile, settings.gain_bounds, settings.delay_upper_s);
        let bounds = self.bounds.get(bounds_key, |_| bounds_of(&comparison, settings, &measuring, grid));
        let solved = match self.solve(&comparison, settings, bounds, effort)? {
            Ok(solved) => solved,
            Err(failure) => return Ok(Err(failure)),
        };
        let correction = solved.correction();
        let cost = self.cost.get((key, correction.clone()), |(_, correction)| {
            let models = &comparison.representative;
            Arc::new(assess(&models.mismatch, &models.cost, correction, grid.omega(), settings.cost_average))
        });
        let cautions = cautions_of(condition, choice, settings, &comparison, &figures);
        let Optima { gain_problem, delay_problem, gains, delays } = solved;
        Ok(Ok(ConditionAnalysis {
            figures,
            comparison,
            gain_problem,
            delay_problem,
            gains,
            delays,
            correction,
            cost,
            cautions,
        }))
    }

    fn solve(
        &mut self,
        comparison: &Comparison,
        settings: &Settings,
        (bounds, upper_s): (GainBounds, f64),
        effort: &Effort<'_>,
    ) -> Result<Result<Optima, ConditionFailure>, Stopped> {
        let delta = &comparison.delta;
        let held = settings.constrained.map(|pair, constrained| *constrained && delta.gain[pair].is_some());
        let gain_problem = Arc::new(Problem {
            quantity: Quantity::Gain(settings.gain_objective),
            delta: delta.gain.clone(),
            constrained: held,
            fitted: settings.fitted.clone(),
            bounds,
            alpha: settings.alpha_gain,
        });
        let delay_problem = Arc::new(Problem {
            quantity: Quantity::Delay,
            delta: delta.delay_s.clone(),
            bounds: Bounds { lower: 0.0, upper: upper_s },
            alpha: settings.alpha_delay,
            ..Problem::clone(&gain_problem)
        });
        let stop = || effort.watch().stopped();
        let solve = |problem: &Arc<Problem>| match solve(problem, ProofBudget::default(), &stop) {
            Err(ProblemError::Stopped) => Err(Stopped),
            solved => Ok(solved.map(Arc::new)),
        };
        let gains = self.gains.get_or_fail(Arc::clone(&gain_problem), solve)?;
        let delays = self.delays.get_or_fail(Arc::clone(&delay_problem), solve)?;
        Ok(match (gains, delays) {
            (Ok(gains), Ok(delays)) => Ok(Optima { gain_problem, delay_problem, gains, delays }),
            (Err(error), _) => Err(ConditionFailure::Gains(error)),
            (_, Err(error)) => Err(ConditionFailure::Delays(error)),
        })
    }
}

/// What came of one problem.
type Solved = Result<Arc<Solution>, ProblemError>;

/// The two optima of a condition with what they are the optima of.
struct Optima {
    gain_problem: Arc<Problem>,
    delay_problem: Arc<Problem>,
    gains: Arc<Solution>,
    delays: Arc<Solution>,
}

impl Optima {
    fn correction(&self) -> ChannelCorrection {
        ChannelCorrection {
            input_gains: self.gains.inputs.clone(),
            output_gains: self.gains.outputs.clone(),
            input_delays_s: self.delays.inputs.clone(),
            output_delays_s: self.delays.outputs.clone(),
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

/// Number of models of both bundles.
pub(super) fn model_count(condition: &Condition) -> usize {
    condition.bundle(BundleKind::Physics).len() + condition.bundle(BundleKind::Identified).len()
}
