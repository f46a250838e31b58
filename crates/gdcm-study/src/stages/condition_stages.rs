//! The analysis stages of one condition, each cached while its inputs stay the same.

use std::sync::Arc;

use gdcm_method::correction::delta::{Delta, GainSource, delay_upper_s, gain_bounds};
use gdcm_method::correction::leads::{ChannelLeads, LeadDesign};
use gdcm_method::correction::problem::{DELAY_AGREEMENT_S, ProblemError};
use gdcm_method::correction::solve::solve;
use gdcm_method::correction::{
    Bounds, ChannelCorrection, Problem, ProofBudget, Quantity, Solution,
};
use gdcm_method::fidelity::CostAverage;
use gdcm_method::schedule::assessment::{CostChange, assess};
use gdcm_model::dataset::{BundleKind, Condition, Pair, PairTable};
use gdcm_model::progress::{Cancelled, Progress};
use gdcm_model::response::FrequencyGrid;

use super::comparison::{BundleMetrics, Comparison, Mismatches};
use super::condition_responses::{
    ConditionModels, ConditionResponses, CoupledResponses, GridKey, Purpose,
};
use super::execution::{Execution, Memo};
use super::fitted_couplings::{CoupledCondition, CouplingSource, FittedCouplings};
use super::lead_compensation::{LeadCompensated, LeadOffer};
use super::substitutions::{
    ConditionSubstitutions, SubstitutedOptimum, Substituting, SubstitutionMemo,
};
use crate::decisions::settings::{DelayFrom, PhaseCorrection, Settings};
use crate::decisions::study::{ConditionChoice, Study};
use crate::results::analysis::{ConditionAnalysis, ConditionFailure};
use crate::results::caution::Caution;

/// Dependencies of the distances, besides the models: the grid, the measuring responses, and the
/// coherence threshold.
type FiguresKey = (GridKey, PairTable<bool>, Option<f64>);
/// Dependencies of the comparison of the representatives, besides the models.
type ComparisonKey = (
    FiguresKey,
    ConditionChoice,
    CostAverage,
    GainSource,
    Option<Arc<FittedCouplings>>,
);
/// The last result of each stage of a condition.
#[derive(Clone, Debug)]
pub(crate) struct ConditionStages {
    models: ConditionModels,
    figures: Memo<FiguresKey, Arc<BundleMetrics>>,
    /// Stages with the physics models without couplings.
    plain: SolvedStages,
    responses: Memo<(GridKey, Arc<FittedCouplings>), CoupledResponses>,
    /// Stages with the physics models with couplings.
    coupled: SolvedStages,
    substitutions: SubstitutionMemo,
}

/// The last comparison of the representatives of a condition, and the optima based on it.
#[derive(Clone, Debug, Default)]
struct SolvedStages {
    comparison: Memo<ComparisonKey, Result<Arc<Comparison>, ConditionFailure>>,
    offer: Memo<Arc<Problem>, Solved>,
    gains: Memo<Arc<Problem>, Solved>,
    delays: Memo<Arc<Problem>, Solved>,
}

/// Context of an analysis.
#[derive(Clone, Copy)]
pub(crate) struct Run<'a> {
    pub(crate) study: &'a Study,
    /// The frequencies of comparison.
    pub(crate) grid: &'a FrequencyGrid,
    /// Budget of the proof of each condition's gains.
    pub(crate) proofs: ProofBudget,
    pub(crate) execution: &'a Execution<'a>,
}

/// Inputs of a condition's comparison and solution.
struct Measured<'a> {
    run: Run<'a>,
    condition: Arc<Condition>,
    /// The responses that measure distances and bounds.
    measuring: PairTable<bool>,
    responses: ConditionResponses,
    figures: Arc<BundleMetrics>,
}

impl ConditionStages {
    /// Creates the stages with nothing computed yet besides the models' own cached responses.
    pub(crate) fn of(models: ConditionModels) -> Self {
        Self {
            models,
            figures: Memo::default(),
            plain: SolvedStages::default(),
            responses: Memo::default(),
            coupled: SolvedStages::default(),
            substitutions: SubstitutionMemo::default(),
        }
    }

    /// Continues with `models`; results are kept where the bundles are the same.
    pub(crate) fn take(&mut self, models: ConditionModels) {
        if self.models.are_the_same_as(&models) {
            self.models = models;
        } else {
            *self = Self::of(models);
        }
    }

    /// Returns the number of steps of a condition's analysis: three for each model, plus one.
    pub(crate) fn steps(condition: &Condition) -> usize {
        3 * model_count(condition) + 1
    }

    /// Returns the models with their responses.
    pub(crate) fn models(&self) -> &ConditionModels {
        &self.models
    }

    /// Replaces the cached gains of the same problem.
    pub(crate) fn take_gains(&mut self, problem: &Arc<Problem>, solution: &Arc<Solution>) {
        for stages in [&mut self.plain, &mut self.coupled] {
            if stages.gains.holds(problem) {
                stages.gains = Memo::of(Arc::clone(problem), Ok(Arc::clone(solution)));
            }
        }
    }

    /// Computes responses and distances of the models without couplings.
    fn measured<'a>(&mut self, run: Run<'a>) -> Result<Measured<'a>, Cancelled> {
        let Run {
            study,
            grid,
            execution,
            ..
        } = run;
        let condition = Arc::clone(self.models.condition());
        let grid_key = (study.settings.band, study.settings.points);
        let measuring = study.dataset.measuring_pairs();
        let coherence = study.settings.coherence_threshold;
        let figures_key = (grid_key, measuring.clone(), coherence);
        let responses = self
            .models
            .responses(Purpose::Comparison, grid_key, grid, execution)?;
        if self.figures.holds(&figures_key) {
            execution.step(2 * model_count(&condition));
        }
        let figures = self.figures.get_or_fail(figures_key, |(_, measuring, _)| {
            BundleMetrics::of(
                &condition,
                &responses,
                measuring,
                (grid, coherence),
                execution,
            )
            .map(Arc::new)
        })?;
        Ok(Measured {
            run,
            condition,
            measuring,
            responses,
            figures,
        })
    }

    /// Returns the condition's contribution to the fit of the couplings; `None` where its
    /// representatives cannot be compared, or have no delays.
    pub(crate) fn coupling_source(
        &mut self,
        run: Run<'_>,
    ) -> Result<Option<CouplingSource>, Cancelled> {
        let measured = self.measured(run)?;
        let source = match self.plain.compare(&measured, None) {
            Err(_) => None,
            Ok(comparison) => {
                let input = measured.solve_input(&comparison);
                let delays = self.plain.delays(&input, input.lead_design().as_deref())?.1;
                let model =
                    |kind: BundleKind| kind.pick(&comparison.physics, &comparison.identified).model;
                let chosen = BundleKind::BOTH.map(|kind| (kind, model(kind)));
                let [physics, flight] =
                    chosen.map(|(kind, model)| Arc::clone(&measured.responses.bundle(kind)[model]));
                delays.ok().map(|delays| CouplingSource {
                    condition: Arc::clone(&measured.condition),
                    delays_s: delays.channels(),
                    contents: chosen.map(|(kind, model)| self.models.content(kind, model)),
                    physics,
                    flight,
                    comparison: Arc::clone(&comparison),
                })
            }
        };
        run.execution.step(1);
        Ok(source)
    }

    /// Completes the analysis of the condition, with the couplings on the physics models where
    /// there are any.
    pub(crate) fn analyze(
        &mut self,
        run: Run<'_>,
        couplings: Option<&Arc<FittedCouplings>>,
    ) -> Result<Result<ConditionAnalysis, ConditionFailure>, Cancelled> {
        let measured = self.measured(run)?;
        let outcome = match couplings {
            None => self.plain.compare_and_solve(&measured, None)?,
            Some(fitted) => self.plain.compare(&measured, None).map_or_else(
                |failure| Ok(Err(failure)),
                |before| {
                    let responses =
                        self.coupled_responses(run.study, couplings, measured.responses);
                    let measured = Measured {
                        responses,
                        ..measured
                    };
                    let outcome = self.coupled.compare_and_solve(&measured, couplings)?;
                    let coupled = CoupledCondition {
                        before,
                        fitted: Arc::clone(fitted),
                    };
                    Ok(outcome.map(|result| ConditionAnalysis {
                        coupled: Some(coupled),
                        ..result
                    }))
                },
            )?,
        };
        run.execution.step(1);
        Ok(outcome)
    }

    /// Computes how the figures of the condition change when other models replace the
    /// representatives of `analysis` (M13.1); cached results are reused. The couplings stay those
    /// of the representatives.
    pub(crate) fn substitutions(
        &mut self,
        run: Run<'_>,
        (analysis, couplings): (&ConditionAnalysis, Option<&Arc<FittedCouplings>>),
    ) -> Result<ConditionSubstitutions, Cancelled> {
        let Run {
            study,
            grid,
            execution,
            ..
        } = run;
        let grid_key = (study.settings.band, study.settings.points);
        let responses = self
            .models
            .responses(Purpose::Comparison, grid_key, grid, execution)?;
        let responses = self.coupled_responses(study, couplings, responses);
        let substituting = Substituting {
            run,
            analysis,
            responses: &responses,
            couplings,
        };
        let measuring = study.dataset.measuring_pairs();
        self.substitutions
            .complete(&substituting, |mismatch, delta| {
                let solved = SolvedStages::default().solve(&SolveInput::new(
                    run,
                    &measuring,
                    (mismatch, &delta),
                ))?;
                Ok(solved.ok().map(|solved| {
                    let gain = solved.gain_problem.delta.clone();
                    SubstitutedOptimum {
                        correction: solved.correction(),
                        delta: Delta { gain, ..delta },
                    }
                }))
            })
    }

    /// Computes the responses with couplings, where there are any: the only place that applies
    /// couplings to a physics model for comparison.
    fn coupled_responses(
        &mut self,
        study: &Study,
        couplings: Option<&Arc<FittedCouplings>>,
        responses: ConditionResponses,
    ) -> ConditionResponses {
        let Some(couplings) = couplings else {
            return responses;
        };
        let key = (
            (study.settings.band, study.settings.points),
            Arc::clone(couplings),
        );
        let airspeed_kt = self.models.condition().flight_state().airspeed_kt;
        let coupled = self.responses.get(key, |(_, of)| {
            CoupledResponses::new(of, airspeed_kt, responses.physics.len())
        });
        responses.with(coupled)
    }
}

impl Run<'_> {
    /// Solves a problem, with the proof as far as the budget allows.
    fn solved(&self, problem: &Problem) -> Result<Solved, Cancelled> {
        solved(problem, self.proofs, self.execution.progress())
    }
}

impl Measured<'_> {
    fn solve_input<'b>(&'b self, comparison: &'b Comparison) -> SolveInput<'b> {
        let compared = (&comparison.representative.mismatch, &comparison.delta);
        SolveInput::new(self.run, &self.measuring, compared)
    }
}

impl SolvedStages {
    /// Compares the representatives, which are selected among the models without couplings.
    fn compare(
        &mut self,
        measured: &Measured<'_>,
        couplings: Option<&Arc<FittedCouplings>>,
    ) -> Result<Arc<Comparison>, ConditionFailure> {
        let Measured {
            run: Run { study, grid, .. },
            condition,
            measuring,
            responses,
            figures,
        } = measured;
        let settings = &study.settings;
        let choice = study.choice(condition.id());
        let figures_key = (
            (settings.band, settings.points),
            measuring.clone(),
            settings.coherence_threshold,
        );
        let key = (
            figures_key,
            choice.of_models(),
            settings.cost_average,
            settings.gain_source,
            couplings.cloned(),
        );
        let comparison = self.comparison.get(key, |_| {
            let averaging = (settings.cost_average, settings.coherence_threshold);
            let comparison = Comparison::of(condition, responses, figures, grid, choice, averaging);
            let comparison = comparison.map(|comparison| match settings.gain_source {
                GainSource::Representatives => comparison,
                GainSource::MeanOfPairs => {
                    comparison.with_mean_gains(condition, responses, grid, averaging.1)
                }
            });
            comparison.map(Arc::new)
        });
        let pair_name = |pair| study.dataset.pair_name(pair);
        comparison.and_then(|comparison| {
            check_comparable(condition, &comparison, pair_name)?;
            Ok(comparison)
        })
    }

    fn compare_and_solve(
        &mut self,
        measured: &Measured<'_>,
        couplings: Option<&Arc<FittedCouplings>>,
    ) -> Result<Result<ConditionAnalysis, ConditionFailure>, Cancelled> {
        let comparison = match self.compare(measured, couplings) {
            Ok(comparison) => comparison,
            Err(failure) => return Ok(Err(failure)),
        };
        let settings = &measured.run.study.settings;
        let omega = measured.run.grid.omega();
        let models = &comparison.representative;
        let average = settings.cost_average;
        let input = measured.solve_input(&comparison);
        let solved = match self.solve(&input)? {
            Ok(solved) => solved,
            Err(failure) => return Ok(Err(failure)),
        };
        let correction = solved.correction();
        let cost = Arc::new(assess(
            &models.mismatch,
            &models.cost,
            &correction,
            omega,
            average,
        ));
        let offer = self.offer(&input, &solved.gain_problem.constrained, &cost)?;
        let cautions = cautions_of(settings, &comparison, &measured.figures);
        let Optima {
            gain_problem,
            delay_problem,
            gains,
            delays,
            compensated,
        } = solved;
        Ok(Ok(ConditionAnalysis {
            condition: Arc::clone(&measured.condition),
            figures: Arc::clone(&measured.figures),
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
        }))
    }

    /// Estimates the benefit of leads, where they are not requested and all constrained responses
    /// want them.
    fn offer(
        &mut self,
        input: &SolveInput<'_>,
        held: &PairTable<bool>,
        now: &PairTable<Option<CostChange>>,
    ) -> Result<Option<LeadOffer>, Cancelled> {
        let settings = input.settings();
        let omega = input.run.grid.omega();
        let mut held_s = held
            .marked()
            .map(|pair| input.delta.band_delay_s[pair].unwrap_or_default())
            .peekable();
        let is_wanted = held_s.peek().is_some() && held_s.all(|delay_s| delay_s < 0.0);
        if settings.phase == PhaseCorrection::Lead || !is_wanted {
            return Ok(None);
        }
        let design = Arc::new(LeadDesign::new(settings.lead, omega.into()));
        let bounds = Bounds {
            lower: design.lower_s(),
            upper: input.delay_upper_s,
        };
        // The weight decides on shares, not on the constraints: it is 1 for any weight of the
        // delays.
        let asked = input.delay_problem(Some(&design));
        let problem = Problem {
            constrained: held.clone(),
            bounds,
            alpha: 1.0,
            ..asked
        };
        let solve = |problem: &Arc<Problem>| {
            solved(
                problem,
                ProofBudget::default(),
                input.run.execution.progress(),
            )
        };
        // An offer that cannot be computed is no offer.
        let Ok(solution) = self.offer.get_or_fail(Arc::new(problem), solve)? else {
            return Ok(None);
        };
        let leads = ChannelLeads::new(design, solution.channels());
        let mismatch = input
            .mismatch
            .map(|pair, mismatch| mismatch.clone().filter(|_| held[pair]));
        Ok(LeadOffer::of(
            leads,
            &mismatch,
            now,
            (omega, settings.cost_average),
        ))
    }

    /// Solves for the delays, or signed delays, and returns them with their problem.
    fn delays(
        &mut self,
        input: &SolveInput<'_>,
        design: Option<&LeadDesign>,
    ) -> Result<(Arc<Problem>, Solved), Cancelled> {
        let problem = Arc::new(input.delay_problem(design));
        let delays = self
            .delays
            .get_or_fail(Arc::clone(&problem), |problem| input.run.solved(problem))?;
        Ok((problem, delays))
    }

    /// Solves for the delays, then for the gains on the difference left after the leads (M15.5).
    fn solve(
        &mut self,
        input: &SolveInput<'_>,
    ) -> Result<Result<Optima, ConditionFailure>, Cancelled> {
        let design = input.lead_design();
        let (delay_problem, delays) = self.delays(input, design.as_deref())?;
        let leads = match (&delays, design) {
            (Err(error), Some(_)) => return Ok(Err(ConditionFailure::Delays(error.clone()))),
            (Ok(delays), Some(design)) => Some(ChannelLeads::new(design, delays.channels())),
            (_, None) => None,
        };
        let compensated = leads.map(|leads| LeadCompensated::of(input.mismatch, &leads));
        let gain_problem = Arc::new(input.gain_problem(compensated.as_deref()));
        let gains = self
            .gains
            .get_or_fail(Arc::clone(&gain_problem), |problem| {
                input.run.solved(problem)
            })?;
        Ok(match (gains, delays) {
            (Ok(gains), Ok(delays)) => Ok(Optima {
                gain_problem,
                delay_problem,
                gains,
                delays,
                compensated,
            }),
            (Err(error), _) => Err(ConditionFailure::Gains(error)),
            (_, Err(error)) => Err(ConditionFailure::Delays(error)),
        })
    }
}

/// Proof budget for the gains of a substitution: as for a live answer, without a search for other
/// minima.
pub(crate) const SUBSTITUTION_PROOF: ProofBudget = ProofBudget {
    work: 1_000_000,
    listing: 0,
    bytes: 64_000_000,
};

/// Inputs of a condition's optimisation problems.
struct SolveInput<'a> {
    run: Run<'a>,
    measuring: &'a PairTable<bool>,
    mismatch: &'a Mismatches,
    delta: &'a Delta,
    delay_upper_s: f64,
}

impl<'a> SolveInput<'a> {
    fn new(
        run: Run<'a>,
        measuring: &'a PairTable<bool>,
        (mismatch, delta): (&'a Mismatches, &'a Delta),
    ) -> Self {
        let settings = &run.study.settings;
        let by_quantile =
            || delay_upper_s(mismatch, measuring, run.grid.omega(), settings.quantile);
        let delay_upper_s = settings.delay_upper_s.unwrap_or_else(by_quantile);
        Self {
            run,
            measuring,
            mismatch,
            delta,
            delay_upper_s,
        }
    }

    fn settings(&self) -> &'a Settings {
        &self.run.study.settings
    }

    /// Returns the common design of the lead filters, where leads are requested.
    fn lead_design(&self) -> Option<Arc<LeadDesign>> {
        let is_asked = self.settings().phase == PhaseCorrection::Lead;
        is_asked.then(|| {
            Arc::new(LeadDesign::new(
                self.settings().lead,
                self.run.grid.omega().into(),
            ))
        })
    }

    fn gain_problem(&self, compensated: Option<&LeadCompensated>) -> Problem {
        let settings = self.settings();
        let delta = self.delta;
        let mismatch = compensated.map_or(self.mismatch, |compensated| &compensated.mismatch);
        let by_quantile = || gain_bounds(mismatch, self.measuring, settings.quantile);
        Problem {
            quantity: Quantity::Gain(settings.gain_objective),
            delta: compensated
                .map_or(&delta.gain, |compensated| &compensated.gain)
                .clone(),
            constrained: settings
                .constrained
                .map(|pair, held| *held && delta.gain[pair].is_some()),
            fitted: settings.fitted(),
            bounds: settings.gain_bounds.unwrap_or_else(by_quantile),
            alpha: settings.alpha_gain,
            agreement: settings.agreement_db,
        }
    }

    /// Builds the problem of delays for the chosen D, or of signed delays for the band delay; an
    /// empty problem where the phase is not corrected.
    fn delay_problem(&self, design: Option<&LeadDesign>) -> Problem {
        let settings = self.settings();
        let delta = self.delta;
        let upper_s = if settings.phase == PhaseCorrection::None {
            0.0
        } else {
            self.delay_upper_s
        };
        let held = |pair: Pair, held: &bool| {
            *held && delta.gain[pair].is_some() && settings.phase != PhaseCorrection::None
        };
        let from_band = design.is_some() || settings.delay_from == DelayFrom::Band;
        Problem {
            quantity: if design.is_some() {
                Quantity::SignedDelay
            } else {
                Quantity::Delay
            },
            delta: if from_band {
                delta.band_delay_s.clone()
            } else {
                delta.delay_s.clone()
            },
            constrained: settings.constrained.map(held),
            fitted: settings.fitted(),
            bounds: Bounds {
                lower: design.map_or(0.0, LeadDesign::lower_s),
                upper: upper_s,
            },
            alpha: settings.alpha_delay,
            agreement: DELAY_AGREEMENT_S,
        }
    }
}

/// Outcome of one problem.
pub(crate) type Solved = Result<Arc<Solution>, ProblemError>;

/// Solves a problem, with the proof within a budget.
pub(crate) fn solved(
    problem: &Problem,
    proofs: ProofBudget,
    progress: &dyn Progress,
) -> Result<Solved, Cancelled> {
    match solve(problem, proofs, &|| progress.cancelled()) {
        Err(ProblemError::Stopped) => Err(Cancelled),
        solved => Ok(solved.map(Arc::new)),
    }
}

/// The two optima of a condition with their problems.
struct Optima {
    gain_problem: Arc<Problem>,
    delay_problem: Arc<Problem>,
    gains: Arc<Solution>,
    delays: Arc<Solution>,
    compensated: Option<Arc<LeadCompensated>>,
}

impl Optima {
    fn correction(&self) -> ChannelCorrection {
        match &self.compensated {
            Some(compensated) => {
                ChannelCorrection::of_leads(self.gains.channels(), compensated.leads.clone())
            }
            None => ChannelCorrection::of_delays(self.gains.channels(), self.delays.channels()),
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
    let because = comparison
        .cautions
        .iter()
        .map(|caution| format!("; {}", caution.words(&pair_name)))
        .collect();
    Err(ConditionFailure::NothingToCompare {
        physics: name(BundleKind::Physics, comparison.physics.model),
        identified: name(BundleKind::Identified, comparison.identified.model),
        because,
    })
}

fn cautions_of(
    settings: &Settings,
    comparison: &Comparison,
    figures: &BundleMetrics,
) -> Vec<Caution> {
    let held = settings.constrained.marked();
    let undefined = held.filter_map(|pair| {
        Some(Caution::HeldButUndefined {
            pair,
            why: comparison.undefined[pair]?,
        })
    });
    let mut cautions: Vec<Caution> = undefined.collect();
    cautions.extend(
        figures
            .discontinuity
            .as_ref()
            .err()
            .cloned()
            .map(Caution::NoSuggestions),
    );
    cautions.extend(comparison.cautions.iter().cloned());
    let fitted = settings.fitted();
    cautions.extend(
        fitted
            .marked()
            .filter_map(|pair| Caution::of_gain(pair, comparison.delta.gain[pair]?)),
    );
    cautions
}

/// Returns the number of models of both bundles.
pub(crate) fn model_count(condition: &Condition) -> usize {
    condition.bundle(BundleKind::Physics).len() + condition.bundle(BundleKind::Identified).len()
}
