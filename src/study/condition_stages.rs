//! The stages of one condition, each kept while what it depends on stays the same.

use std::sync::Arc;

use crate::correction::{
    Bounds, ChannelCorrection, DELAY_AGREEMENT_S, GainBounds, Problem, ProblemError, ProofBudget, Quantity, Solution,
    delay_upper_s, gain_bounds, solve,
};
use crate::dataset::{BundleKind, Condition, Pair, PairTable};
use crate::fidelity::CostAverage;
use crate::response::FrequencyGrid;
use crate::schedule::{CostChange, assess};

use super::caution::Caution;
use super::comparison::{BundleFigures, Comparison};
use super::condition_analysis::{ConditionAnalysis, ConditionFailure};
use super::condition_responses::{ConditionModels, ConditionResponses, GridKey, Purpose};
use super::document::{ConditionChoice, Study};
use super::executor::Execution;
use super::memo::Memo;
use super::progress::Cancelled;
use super::settings::Settings;

/// What the distances depend on, besides the models: the grid, the responses that measure them, and the coherence that counts.
type FiguresKey = (GridKey, PairTable<bool>, Option<f64>);
/// What the comparison of the representatives depends on, besides the models.
type ComparisonKey = (FiguresKey, ConditionChoice, CostAverage);
/// What the bounds depend on: the comparison, the quantile, and the bounds set by hand.
type BoundsKey = (ComparisonKey, f64, Option<GainBounds>, Option<f64>);

/// The last result of each stage of a condition.
#[derive(Clone, Debug)]
pub(super) struct ConditionStages {
    models: ConditionModels,
    figures: Memo<FiguresKey, Arc<BundleFigures>>,
    comparison: Memo<ComparisonKey, Result<Arc<Comparison>, ConditionFailure>>,
    bounds: Memo<BoundsKey, (GainBounds, f64)>,
    gains: Memo<Arc<Problem>, Solved>,
    delays: Memo<Arc<Problem>, Solved>,
    cost: Memo<(ComparisonKey, ChannelCorrection), Arc<PairTable<Option<CostChange>>>>,
}

impl ConditionStages {
    /// Nothing computed yet but what the models bring.
    pub(super) fn of(models: ConditionModels) -> Self {
        Self {
            models,
            figures: Memo::default(),
            comparison: Memo::default(),
            bounds: Memo::default(),
            gains: Memo::default(),
            delays: Memo::default(),
            cost: Memo::default(),
        }
    }

    /// Goes on with `models`: what was computed stays where the bundles are the same.
    pub(super) fn take(&mut self, models: ConditionModels) {
        if self.models.are_the_same_as(&models) {
            self.models = models;
        } else {
            *self = Self::of(models);
        }
    }

    /// Steps of the analysis of a condition: three for each model, and one.
    pub(super) fn steps(condition: &Condition) -> usize {
        3 * model_count(condition) + 1
    }

    /// The models with their responses.
    pub(super) fn models(&self) -> &ConditionModels {
        &self.models
    }

    /// Takes gains of the same problem in place of those kept.
    pub(super) fn take_gains(&mut self, problem: &Arc<Problem>, solution: &Arc<Solution>) {
        if self.gains.holds(problem) {
            self.gains = Memo::of(Arc::clone(problem), Ok(Arc::clone(solution)));
        }
    }

    /// Whatever is not kept of the analysis of the condition.
    pub(super) fn analyze(
        &mut self,
        study: &Study,
        grid: &FrequencyGrid,
        proofs: ProofBudget,
        execution: &Execution<'_>,
    ) -> Result<Result<ConditionAnalysis, ConditionFailure>, Cancelled> {
        let condition = Arc::clone(self.models.condition());
        let grid_key = (study.settings.band, study.settings.points);
        let coherence = study.settings.coherence_threshold;
        let figures_key = (grid_key, study.dataset.measuring_pairs(), coherence);
        let responses = self.models.responses(Purpose::Comparison, grid_key, grid, execution)?;
        if self.figures.holds(&figures_key) {
            execution.step(2 * model_count(&condition));
        }
        let figures = self.figures.get_or_fail(figures_key, |(_, measuring, _)| {
            BundleFigures::of(&condition, &responses, measuring, (grid, coherence), execution).map(Arc::new)
        })?;
        let outcome = self.compare_and_solve(study, &condition, grid, &responses, figures, (proofs, execution))?;
        execution.step(1);
        Ok(outcome)
    }

    fn compare_and_solve(
        &mut self,
        study: &Study,
        condition: &Arc<Condition>,
        grid: &FrequencyGrid,
        responses: &ConditionResponses,
        figures: Arc<BundleFigures>,
        (proofs, execution): (ProofBudget, &Execution<'_>),
    ) -> Result<Result<ConditionAnalysis, ConditionFailure>, Cancelled> {
        let settings = &study.settings;
        let measuring = study.dataset.measuring_pairs();
        let choice = study.choice(condition.id());
        let figures_key = ((settings.band, settings.points), measuring.clone(), settings.coherence_threshold);
        let key: ComparisonKey = (figures_key, choice.without_reasons(), settings.cost_average);
        let comparison = self.comparison.get(key.clone(), |_| {
            let averaging = (settings.cost_average, settings.coherence_threshold);
            let comparison = Comparison::of(condition, responses, &figures, grid, choice, averaging);
            comparison.map(Arc::new)
        });
        let compared = comparison.and_then(|comparison| {
            check_comparable(condition, &comparison, |pair| study.dataset.pair_name(pair))?;
            Ok(comparison)
        });
        let comparison = match compared {
            Ok(comparison) => comparison,
            Err(failure) => return Ok(Err(failure)),
        };
        let bounds_key = (key.clone(), settings.quantile, settings.gain_bounds, settings.delay_upper_s);
        let bounds = self.bounds.get(bounds_key, |_| bounds_of(&comparison, settings, &measuring, grid));
        let solved = match self.solve(&comparison, settings, bounds, proofs, execution)? {
            Ok(solved) => solved,
            Err(failure) => return Ok(Err(failure)),
        };
        let correction = solved.correction();
        let cost = self.cost.get((key, correction.clone()), |(_, correction)| {
            let models = &comparison.representative;
            Arc::new(assess(&models.mismatch, &models.cost, correction, grid.omega(), settings.cost_average))
        });
        let cautions = cautions_of(settings, &comparison, &figures);
        let Optima { gain_problem, delay_problem, gains, delays } = solved;
        Ok(Ok(ConditionAnalysis {
            condition: Arc::clone(condition),
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
        proofs: ProofBudget,
        execution: &Execution<'_>,
    ) -> Result<Result<Optima, ConditionFailure>, Cancelled> {
        let delta = &comparison.delta;
        let held = settings.constrained.map(|pair, constrained| *constrained && delta.gain[pair].is_some());
        let gain_problem = Arc::new(Problem {
            quantity: Quantity::Gain(settings.gain_objective),
            delta: delta.gain.clone(),
            constrained: held,
            fitted: settings.fitted.clone(),
            bounds,
            alpha: settings.alpha_gain,
            agreement: settings.agreement_db,
        });
        let delay_problem = Arc::new(Problem {
            quantity: Quantity::Delay,
            delta: delta.delay_s.clone(),
            bounds: Bounds { lower: 0.0, upper: upper_s },
            alpha: settings.alpha_delay,
            agreement: DELAY_AGREEMENT_S,
            ..Problem::clone(&gain_problem)
        });
        let stop = || execution.progress().cancelled();
        let solve = |problem: &Arc<Problem>| match solve(problem, proofs, &stop) {
            Err(ProblemError::Stopped) => Err(Cancelled),
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

fn check_comparable(
    condition: &Condition,
    comparison: &Comparison,
    pair_name: impl Fn(Pair) -> String,
) -> Result<(), ConditionFailure> {
    if comparison.delta.gain.iter().any(|(_, gain)| gain.is_some()) {
        return Ok(());
    }
    let name = |kind, model: usize| condition.bundle(kind)[model].name.clone();
    let because = comparison.cautions.iter().map(|caution| format!("; {}", caution.words(&pair_name))).collect();
    Err(ConditionFailure::NothingToCompare {
        physics: name(BundleKind::Physics, comparison.physics.model),
        identified: name(BundleKind::Identified, comparison.identified.model),
        because,
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

fn cautions_of(settings: &Settings, comparison: &Comparison, figures: &BundleFigures) -> Vec<Caution> {
    let held = settings.constrained.marked();
    let undefined = held.filter_map(|pair| Some(Caution::HeldButUndefined { pair, why: comparison.undefined[pair]? }));
    let mut cautions: Vec<Caution> = undefined.collect();
    cautions.extend(figures.discontinuity.as_ref().err().cloned().map(Caution::NoSuggestions));
    cautions.extend(comparison.cautions.iter().cloned());
    let fitted = settings.fitted.marked();
    cautions.extend(fitted.filter_map(|pair| Caution::of_gain(pair, comparison.delta.gain[pair]?)));
    cautions
}

/// Number of models of both bundles.
pub(super) fn model_count(condition: &Condition) -> usize {
    condition.bundle(BundleKind::Physics).len() + condition.bundle(BundleKind::Identified).len()
}
