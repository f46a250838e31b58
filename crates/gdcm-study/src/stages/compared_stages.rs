//! A condition's comparison and optima, from its models' responses and distances; cached while
//! their inputs stay the same.
//!
//! ```text
//! 1  comparison of the representatives: G and D                 (rejections, pins, averages)
//! 2  optimal delays and gains                                   (constraints, weights, bounds)
//! 3  J before and after the correction, benefit of leads, cautions
//! ```
//!
//! In brackets: the settings on which a step depends. `ConditionStages` runs these steps for the
//! physics models as in the dataset, with the physics parameters moved, and with couplings. A
//! *representative* is the model that stands for its bundle (M5); G is the gain and D the delay
//! that would match a response (M6); J is the mismatch cost (M4).

use std::sync::Arc;

use gdcm_method::correction::delta::GainSource;
use gdcm_method::fidelity::CostAverage;
use gdcm_method::schedule::assessment::assess;
use gdcm_model::dataset::{BundleKind, Condition, PairTable};

use super::comparison_input::ComparisonInput;
use super::condition_responses::ConditionResponses;
use super::known_models::GridKey;
use super::memo::Memo;
use super::optima::{NoOptima, Optima, SolveInput, SolvedProblems};
use super::run::Run;
use crate::decisions::choices::ConditionChoice;
use crate::decisions::settings::Settings;
use crate::results::analysis::{ConditionAnalysis, ConditionFailure};
use crate::results::caution::Caution;
use crate::results::comparison::{BundleMetrics, Comparison};
use crate::results::fitted_couplings::FittedCouplings;

/// Inputs on which the distances depend, besides the models.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct MetricsKey {
    grid: GridKey,
    /// The on-axis responses, or all responses if none is on-axis.
    pub(super) on_axis: PairTable<bool>,
    coherence: Option<f64>,
}

impl MetricsKey {
    pub(super) fn new(run: Run<'_>) -> Self {
        Self {
            grid: run.grid_key(),
            on_axis: run.study.dataset.measuring_pairs(),
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

/// Last comparison between a condition's representatives, and the optima based on it.
#[derive(Clone, Debug, Default)]
pub(super) struct ComparedStages {
    comparison: Memo<ComparisonKey, Result<Arc<Comparison>, ConditionFailure>>,
    pub(super) problems: SolvedProblems,
}

/// A condition's models with their responses and distances, from which the comparison and the
/// optima are computed.
pub(super) struct ComparisonData<'a> {
    pub(super) run: Run<'a>,
    pub(super) condition: Arc<Condition>,
    /// The responses from which distances and bounds are computed: the on-axis responses, or all
    /// responses if none is on-axis.
    pub(super) on_axis: PairTable<bool>,
    pub(super) responses: ConditionResponses,
    pub(super) metrics: Arc<BundleMetrics>,
}

impl ComparisonData<'_> {
    /// Returns the inputs to the optimisation problems for a comparison of these models.
    pub(super) fn solve_input<'b>(&'b self, comparison: &'b Comparison) -> SolveInput<'b> {
        SolveInput::new(
            self.run,
            &self.on_axis,
            &comparison.representative.mismatch,
            &comparison.delta,
        )
    }
}

impl ComparedStages {
    /// Compares the representatives (step 1). They are selected by the distances between the models
    /// without couplings, because a correction must not hide a step of the physics model (M16.3).
    ///
    /// # Errors
    /// [`ConditionFailure`] if they cannot be compared in any response.
    pub(super) fn compare(
        &mut self,
        data: &ComparisonData<'_>,
        couplings: Option<&Arc<FittedCouplings>>,
    ) -> Result<Arc<Comparison>, ConditionFailure> {
        let settings = &data.run.study.settings;
        let choice = data.run.study.choice(data.condition.id());
        let key = ComparisonKey {
            metrics: MetricsKey::new(data.run),
            choice: choice.of_models(),
            average: settings.cost_average,
            gain_source: settings.gain_source,
            couplings: couplings.cloned(),
        };
        let comparison = self.comparison.get(key, |_| {
            let input = ComparisonInput {
                condition: &data.condition,
                responses: &data.responses,
                metrics: &data.metrics,
                grid: data.run.comparison_grid(),
                choice,
                average: settings.cost_average,
            };
            let comparison = Comparison::compute(&input)?;
            Ok(Arc::new(match settings.gain_source {
                GainSource::Representatives => comparison,
                GainSource::MeanOfPairs => comparison.with_mean_gains(&input),
            }))
        })?;
        check_comparable(&data.condition, &comparison)?;
        Ok(comparison)
    }

    /// Compares the representatives, computes the optimal delays and gains, and collects the
    /// condition's result (steps 1 to 3).
    ///
    /// # Errors
    /// [`NoOptima`] if the representatives cannot be compared, a problem has no solution, or the
    /// run is cancelled.
    pub(super) fn compare_and_solve(
        &mut self,
        data: &ComparisonData<'_>,
        couplings: Option<&Arc<FittedCouplings>>,
    ) -> Result<ConditionAnalysis, NoOptima> {
        // Step 1.
        let comparison = self.compare(data, couplings)?;
        // Step 2.
        let settings = &data.run.study.settings;
        let input = data.solve_input(&comparison);
        let optima = self.problems.solve(&input)?;
        let correction = optima.correction();
        // Step 3.
        let models = &comparison.representative;
        let cost = Arc::new(assess(
            &models.mismatch,
            &models.cost,
            &correction,
            data.run.grid.omega(),
            settings.cost_average,
        ));
        let held = &optima.gain_problem.constrained;
        let offer = self.problems.offer(&input, held, &cost)?;
        let cautions = result_cautions(settings, &comparison, &data.metrics);
        let Optima {
            gain_problem,
            delay_problem,
            gains,
            delays,
            compensated,
        } = optima;
        Ok(ConditionAnalysis {
            condition: Arc::clone(&data.condition),
            bundle_metrics: Arc::clone(&data.metrics),
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
