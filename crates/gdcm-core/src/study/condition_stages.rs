//! The stages of one condition, each kept while what it depends on stays the same.

use std::sync::Arc;

use crate::correction::{
    Bounds, ChannelCorrection, ChannelLeads, DELAY_AGREEMENT_S, GainBounds, GainSource, LeadDesign, Problem,
    ProblemError, ProofBudget, Quantity, Solution, delay_upper_s, gain_bounds, solve,
};
use crate::dataset::{BundleKind, Condition, ConditionId, Pair, PairTable};
use crate::fidelity::CostAverage;
use crate::response::FrequencyGrid;
use crate::schedule::{CostChange, assess};

use super::{
    BundleMetrics, Cancelled, Caution, Comparison, ConditionAnalysis, ConditionChoice, ConditionFailure,
    ConditionModels, ConditionResponses, ConditionSubstitutions, DelayFrom, Execution, GridKey, LeadCompensated,
    LeadOffer, Memo, OfferKey, PhaseCorrection, Purpose, Settings, Study, SubstitutedOptimum, Substituting,
    SubstitutionMemo,
};

/// What the distances depend on, besides the models: the grid, the responses that measure them, and the coherence that counts.
type FiguresKey = (GridKey, PairTable<bool>, Option<f64>);
/// What the comparison of the representatives depends on, besides the models.
type ComparisonKey = (FiguresKey, ConditionChoice, CostAverage, GainSource);
/// What the upper bound of the delays depends on: the comparison, the quantile, and the bound set by hand.
type DelayBoundKey = (ComparisonKey, f64, Option<f64>);
/// What the bounds of the gains depend on: the comparison, the leads, the quantile, and the bounds set by hand.
type GainBoundsKey = (ComparisonKey, Option<ChannelLeads>, f64, Option<GainBounds>);

/// The last result of each stage of a condition.
#[derive(Clone, Debug)]
pub(super) struct ConditionStages {
    models: ConditionModels,
    figures: Memo<FiguresKey, Arc<BundleMetrics>>,
    comparison: Memo<ComparisonKey, Result<Arc<Comparison>, ConditionFailure>>,
    delay_upper_s: Memo<DelayBoundKey, f64>,
    compensated: Memo<(ComparisonKey, ChannelLeads), Arc<LeadCompensated>>,
    gain_bounds: Memo<GainBoundsKey, GainBounds>,
    offer: Memo<(ComparisonKey, OfferKey), PhaseLeft>,
    gains: Memo<Arc<Problem>, Solved>,
    delays: Memo<Arc<Problem>, Solved>,
    cost: Memo<(ComparisonKey, ChannelCorrection), Arc<PairTable<Option<CostChange>>>>,
    substitutions: SubstitutionMemo,
}

impl ConditionStages {
    /// Nothing computed yet but what the models bring.
    pub(super) fn of(models: ConditionModels) -> Self {
        Self {
            models,
            figures: Memo::default(),
            comparison: Memo::default(),
            delay_upper_s: Memo::default(),
            compensated: Memo::default(),
            gain_bounds: Memo::default(),
            offer: Memo::default(),
            gains: Memo::default(),
            delays: Memo::default(),
            cost: Memo::default(),
            substitutions: SubstitutionMemo::default(),
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
            BundleMetrics::of(&condition, &responses, measuring, (grid, coherence), execution).map(Arc::new)
        })?;
        let outcome = self.compare_and_solve(study, &condition, grid, &responses, figures, (proofs, execution))?;
        execution.step(1);
        Ok(outcome)
    }

    /// How the figures of the condition change when other models stand in for the representatives of `analysis` (M13.1); what is
    /// kept of that is not computed again.
    pub(super) fn substitutions(
        &mut self,
        study: &Study,
        analysis: &ConditionAnalysis,
        grid: &FrequencyGrid,
        execution: &Execution<'_>,
    ) -> Result<ConditionSubstitutions, Cancelled> {
        let grid_key = (study.settings.band, study.settings.points);
        let responses = self.models.responses(Purpose::Comparison, grid_key, grid, execution)?;
        let substituting = Substituting { study, analysis, grid, responses: &responses };
        let models = &self.models;
        self.substitutions.complete(&substituting, execution, |comparison, execution| {
            Self::of(models.clone()).optimum(comparison, &substituting, execution)
        })
    }

    /// The correction of a comparison of models that stand in for the representatives; none where there is none.
    fn optimum(
        &mut self,
        comparison: &Comparison,
        substituting: &Substituting<'_>,
        execution: &Execution<'_>,
    ) -> Result<Option<SubstitutedOptimum>, Cancelled> {
        let (settings, measuring) = (&substituting.study.settings, substituting.study.dataset.measuring_pairs());
        let key = comparison_key(substituting.study, substituting.analysis.condition.id());
        let omega = substituting.grid.omega();
        let input = SolveInput { settings, measuring: &measuring, omega, comparison, key: &key };
        let solved = self.solve(&input, SUBSTITUTION_PROOF, execution)?;
        Ok(solved.ok().map(|solved| SubstitutedOptimum {
            correction: solved.correction(),
            gain: solved.gain_problem.delta.clone(),
            delay_s: comparison.delta.delay_s.clone(),
            band_delay_s: comparison.delta.band_delay_s.clone(),
        }))
    }

    fn compare_and_solve(
        &mut self,
        study: &Study,
        condition: &Arc<Condition>,
        grid: &FrequencyGrid,
        responses: &ConditionResponses,
        figures: Arc<BundleMetrics>,
        (proofs, execution): (ProofBudget, &Execution<'_>),
    ) -> Result<Result<ConditionAnalysis, ConditionFailure>, Cancelled> {
        let settings = &study.settings;
        let measuring = study.dataset.measuring_pairs();
        let choice = study.choice(condition.id());
        let key = comparison_key(study, condition.id());
        let comparison = self.comparison.get(key.clone(), |_| {
            let averaging = (settings.cost_average, settings.coherence_threshold);
            let comparison = Comparison::of(condition, responses, &figures, grid, choice, averaging);
            let comparison = comparison.map(|comparison| match settings.gain_source {
                GainSource::Representatives => comparison,
                GainSource::MeanOfPairs => comparison.with_mean_gains(condition, responses, grid, averaging.1),
            });
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
        let cost_key = key.clone();
        let input =
            SolveInput { settings, measuring: &measuring, omega: grid.omega(), comparison: &comparison, key: &key };
        let solved = match self.solve(&input, proofs, execution)? {
            Ok(solved) => solved,
            Err(failure) => return Ok(Err(failure)),
        };
        let correction = solved.correction();
        let cost = self.cost.get((cost_key, correction.clone()), |(_, correction)| {
            let (models, omega, average) = (&comparison.representative, grid.omega(), settings.cost_average);
            Arc::new(match &solved.compensated {
                None => assess(&models.mismatch, &models.cost, correction, omega, average),
                Some(compensated) => {
                    let corrected = compensated.cost(|pair| correction.without_leads_on(pair), omega, average);
                    corrected
                        .map(|pair, cost| Some(CostChange { uncorrected: models.cost[pair]?, corrected: (*cost)? }))
                }
            })
        });
        let offer = match self.phase_left(&input, &solved, execution)? {
            Ok(Some(left)) => LeadOffer::of(&left, &cost),
            // An offer that cannot be made is none.
            Ok(None) | Err(_) => None,
        };
        let cautions = cautions_of(settings, &comparison, &figures);
        let Optima { gain_problem, delay_problem, gains, delays, compensated } = solved;
        Ok(Ok(ConditionAnalysis {
            condition: Arc::clone(condition),
            figures,
            comparison,
            gain_problem,
            delay_problem,
            gains,
            delays,
            compensated,
            offer,
            correction,
            cost,
            cautions,
        }))
    }

    /// The phase that leads would leave, where they are not asked for.
    fn phase_left(
        &mut self,
        input: &SolveInput<'_>,
        solved: &Optima,
        execution: &Execution<'_>,
    ) -> Result<PhaseLeft, Cancelled> {
        let settings = input.settings;
        if settings.phase == PhaseCorrection::Lead {
            return Ok(Ok(None));
        }
        let bound_key = (input.key.clone(), settings.quantile, settings.delay_upper_s);
        let upper_s = self.delay_upper_s.get(bound_key, |_| input.delay_upper_s());
        let key = (input.key.clone(), OfferKey::of(settings, &solved.gain_problem.constrained, upper_s));
        let stop = || execution.progress().cancelled();
        self.offer.get_or_fail(key, |(_, key)| {
            match key.phase_left(input.comparison, (input.omega, settings.cost_average), &stop) {
                Err(ProblemError::Stopped) => Err(Cancelled),
                left => Ok(left),
            }
        })
    }

    /// The delays, then the gains on what leads leave (M15.5).
    fn solve(
        &mut self,
        input: &SolveInput<'_>,
        proofs: ProofBudget,
        execution: &Execution<'_>,
    ) -> Result<Result<Optima, ConditionFailure>, Cancelled> {
        let settings = input.settings;
        let stop = || execution.progress().cancelled();
        let solve = |problem: &Arc<Problem>| match solve(problem, proofs, &stop) {
            Err(ProblemError::Stopped) => Err(Cancelled),
            solved => Ok(solved.map(Arc::new)),
        };
        let bound_key = (input.key.clone(), settings.quantile, settings.delay_upper_s);
        let upper_s = self.delay_upper_s.get(bound_key, |_| input.delay_upper_s());
        let design = (settings.phase == PhaseCorrection::Lead)
            .then(|| Arc::new(LeadDesign::new(settings.lead, input.omega.into())));
        let delay_problem = Arc::new(input.delay_problem(upper_s, design.as_deref()));
        let delays = self.delays.get_or_fail(Arc::clone(&delay_problem), solve)?;
        let leads = match (&delays, design) {
            (Err(error), Some(_)) => return Ok(Err(ConditionFailure::Delays(error.clone()))),
            (Ok(delays), Some(design)) => {
                Some(ChannelLeads::new(design, delays.inputs.clone(), delays.outputs.clone()))
            }
            (_, None) => None,
        };
        let compensated = leads.clone().map(|leads| {
            let mismatch = &input.comparison.representative.mismatch;
            self.compensated.get((input.key.clone(), leads), |(_, leads)| LeadCompensated::of(mismatch, leads))
        });
        let bounds_key = (input.key.clone(), leads, settings.quantile, settings.gain_bounds);
        let bounds = self.gain_bounds.get(bounds_key, |_| input.gain_bounds(compensated.as_deref()));
        let gain_problem = Arc::new(input.gain_problem(bounds, compensated.as_deref()));
        let gains = self.gains.get_or_fail(Arc::clone(&gain_problem), solve)?;
        Ok(match (gains, delays) {
            (Ok(gains), Ok(delays)) => Ok(Optima { gain_problem, delay_problem, gains, delays, compensated }),
            (Err(error), _) => Err(ConditionFailure::Gains(error)),
            (_, Err(error)) => Err(ConditionFailure::Delays(error)),
        })
    }
}

/// What the comparison of the representatives of a condition depends on.
fn comparison_key(study: &Study, condition: ConditionId) -> ComparisonKey {
    let settings = &study.settings;
    let figures_key = ((settings.band, settings.points), study.dataset.measuring_pairs(), settings.coherence_threshold);
    (figures_key, study.choice(condition).of_models(), settings.cost_average, settings.gain_source)
}

/// The budget of the proof of a substitution's gains: as far as that of a live answer, without a look for other minima.
const SUBSTITUTION_PROOF: ProofBudget = ProofBudget { work: 1_000_000, listing: 0, bytes: 64_000_000 };

/// What the optima of a condition are asked for.
struct SolveInput<'a> {
    settings: &'a Settings,
    measuring: &'a PairTable<bool>,
    omega: &'a [f64],
    comparison: &'a Comparison,
    key: &'a ComparisonKey,
}

impl SolveInput<'_> {
    fn delay_upper_s(&self) -> f64 {
        let (settings, mismatch) = (self.settings, &self.comparison.representative.mismatch);
        let by_quantile = || delay_upper_s(mismatch, self.measuring, self.omega, settings.quantile);
        settings.delay_upper_s.unwrap_or_else(by_quantile)
    }

    fn gain_bounds(&self, compensated: Option<&LeadCompensated>) -> GainBounds {
        let mismatch =
            compensated.map_or(&self.comparison.representative.mismatch, |compensated| &compensated.mismatch);
        self.settings.gain_bounds.unwrap_or_else(|| gain_bounds(mismatch, self.measuring, self.settings.quantile))
    }

    fn gain_problem(&self, bounds: GainBounds, compensated: Option<&LeadCompensated>) -> Problem {
        let (settings, delta) = (self.settings, &self.comparison.delta);
        Problem {
            quantity: Quantity::Gain(settings.gain_objective),
            delta: compensated.map_or(&delta.gain, |compensated| &compensated.gain).clone(),
            constrained: settings.constrained.map(|pair, held| *held && delta.gain[pair].is_some()),
            fitted: settings.fitted(),
            bounds,
            alpha: settings.alpha_gain,
            agreement: settings.agreement_db,
        }
    }

    /// Delays of the D that is chosen, signed ones of the band delay; none at all where the phase is left as it is.
    fn delay_problem(&self, upper_s: f64, design: Option<&LeadDesign>) -> Problem {
        let (settings, delta) = (self.settings, &self.comparison.delta);
        let upper_s = if settings.phase == PhaseCorrection::None { 0.0 } else { upper_s };
        let held =
            |pair: Pair, held: &bool| *held && delta.gain[pair].is_some() && settings.phase != PhaseCorrection::None;
        let from_band = design.is_some() || settings.delay_from == DelayFrom::Band;
        Problem {
            quantity: if design.is_some() { Quantity::SignedDelay } else { Quantity::Delay },
            delta: if from_band { delta.band_delay_s.clone() } else { delta.delay_s.clone() },
            constrained: settings.constrained.map(held),
            fitted: settings.fitted(),
            bounds: Bounds { lower: design.map_or(0.0, LeadDesign::lower_s), upper: upper_s },
            alpha: settings.alpha_delay,
            agreement: DELAY_AGREEMENT_S,
        }
    }
}

/// J_phase of each response that leads would leave, where all held responses want lead.
type PhaseLeft = Result<Option<Arc<PairTable<Option<f64>>>>, ProblemError>;

/// What came of one problem.
type Solved = Result<Arc<Solution>, ProblemError>;

/// The two optima of a condition with what they are the optima of.
struct Optima {
    gain_problem: Arc<Problem>,
    delay_problem: Arc<Problem>,
    gains: Arc<Solution>,
    delays: Arc<Solution>,
    compensated: Option<Arc<LeadCompensated>>,
}

impl Optima {
    fn correction(&self) -> ChannelCorrection {
        let leads = self.compensated.as_ref().map(|compensated| compensated.leads.clone());
        let of_delays = || [self.delays.inputs.clone(), self.delays.outputs.clone()];
        let [input_delays_s, output_delays_s] = leads.as_ref().map_or_else(of_delays, ChannelLeads::delays_s);
        ChannelCorrection {
            input_gains: self.gains.inputs.clone(),
            output_gains: self.gains.outputs.clone(),
            input_delays_s,
            output_delays_s,
            leads,
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

fn cautions_of(settings: &Settings, comparison: &Comparison, figures: &BundleMetrics) -> Vec<Caution> {
    let held = settings.constrained.marked();
    let undefined = held.filter_map(|pair| Some(Caution::HeldButUndefined { pair, why: comparison.undefined[pair]? }));
    let mut cautions: Vec<Caution> = undefined.collect();
    cautions.extend(figures.discontinuity.as_ref().err().cloned().map(Caution::NoSuggestions));
    cautions.extend(comparison.cautions.iter().cloned());
    let fitted = settings.fitted();
    cautions.extend(fitted.marked().filter_map(|pair| Caution::of_gain(pair, comparison.delta.gain[pair]?)));
    cautions
}

/// Number of models of both bundles.
pub(super) fn model_count(condition: &Condition) -> usize {
    condition.bundle(BundleKind::Physics).len() + condition.bundle(BundleKind::Identified).len()
}
