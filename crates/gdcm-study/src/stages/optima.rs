//! A condition's optimal gains and delays (M8, M9, M15).
//!
//! ```text
//! 1  delays, or signed delays for leads, from D                     eq. (11), M15.4
//! 2  lead filters of the negative signed delays                     M15.3
//! 3  gains from the difference that remains after the leads         eq. (7), M15.5
//! ```
//!
//! Without leads, step 2 is skipped and the gains follow from the whole difference. The file also
//! estimates the benefit of leads that are not requested (`SolvedProblems::offer`). G is the gain
//! and D the delay that would match a response (M6). A negative delay, which only signed delays
//! allow, is a lead. In names, *held* responses are the constrained ones; *agreement* is the
//! tolerance within which constraints that form a loop count as consistent.

use std::sync::Arc;

use gdcm_method::correction::channel_bounds::{delay_upper_s, gain_bounds};
use gdcm_method::correction::channel_leads::ChannelLeads;
use gdcm_method::correction::delta::Delta;
use gdcm_method::correction::lead_design::LeadDesign;
use gdcm_method::correction::problem::{DELAY_AGREEMENT_S, ProblemError};
use gdcm_method::correction::solve::solve;
use gdcm_method::correction::{
    Bounds, ChannelCorrection, Problem, ProofBudget, Quantity, Solution,
};
use gdcm_method::schedule::CostChange;
use gdcm_model::dataset::PairTable;
use gdcm_model::progress::{Cancelled, Progress};

use super::memo::Memo;
use super::run::Run;
use crate::decisions::settings::{DelayFrom, PhaseCorrection, Settings};
use crate::results::analysis::ConditionFailure;
use crate::results::comparison::Mismatches;
use crate::results::lead_compensation::LeadCompensated;
use crate::results::lead_offer::LeadOffer;

/// A problem's solution, or why there is none.
pub(crate) type Solved = Result<Arc<Solution>, ProblemError>;

/// Solves a problem, and proves optimality within a budget.
///
/// # Errors
/// [`Cancelled`] where `progress` requests it.
pub(crate) fn solve_within(
    problem: &Problem,
    proofs: ProofBudget,
    progress: &dyn Progress,
) -> Result<Solved, Cancelled> {
    match solve(problem, proofs, &|| progress.cancelled()) {
        Err(ProblemError::Stopped) => Err(Cancelled),
        solved => Ok(solved.map(Arc::new)),
    }
}

/// A condition's two optima, with their problems.
pub(crate) struct Optima {
    pub(crate) gain_problem: Arc<Problem>,
    pub(crate) delay_problem: Arc<Problem>,
    pub(crate) gains: Arc<Solution>,
    pub(crate) delays: Arc<Solution>,
    pub(crate) compensated: Option<Arc<LeadCompensated>>,
}

impl Optima {
    /// Returns gains and delays as one correction.
    pub(crate) fn correction(&self) -> ChannelCorrection {
        match &self.compensated {
            Some(compensated) => {
                ChannelCorrection::of_leads(self.gains.channels(), compensated.leads.clone())
            }
            None => ChannelCorrection::of_delays(self.gains.channels(), self.delays.channels()),
        }
    }
}

/// Why there are no optima.
pub(crate) enum NoOptima {
    Cancelled,
    Failed(ConditionFailure),
}

impl From<Cancelled> for NoOptima {
    fn from(_: Cancelled) -> Self {
        Self::Cancelled
    }
}

impl From<ConditionFailure> for NoOptima {
    fn from(failure: ConditionFailure) -> Self {
        Self::Failed(failure)
    }
}

/// The last solution to each problem in a condition.
#[derive(Clone, Debug, Default)]
pub(crate) struct SolvedProblems {
    offer: Memo<Arc<Problem>, Solved>,
    gains: Memo<Arc<Problem>, Solved>,
    delays: Memo<Arc<Problem>, Solved>,
}

impl SolvedProblems {
    /// Replaces the cached gains if they solve this problem.
    pub(crate) fn take_gains(&mut self, problem: &Arc<Problem>, solution: &Arc<Solution>) {
        if self.gains.holds(problem) {
            self.gains = Memo::with(Arc::clone(problem), Ok(Arc::clone(solution)));
        }
    }

    /// Computes the delays, and then the gains from the difference that remains after the leads
    /// (steps 1 to 3).
    ///
    /// # Errors
    /// [`NoOptima`] where a problem has no solution, or the run is cancelled.
    pub(crate) fn solve(&mut self, input: &SolveInput<'_>) -> Result<Optima, NoOptima> {
        let design = input.lead_design();
        // Step 1.
        let delay_problem = Arc::new(input.delay_problem(design.as_deref()));
        let delays = self.delays(input, &delay_problem)?;
        // Step 2.
        let compensated = match design {
            None => None,
            Some(design) => {
                let delays = delays.as_ref().map_err(delay_failure)?;
                let leads = ChannelLeads::new(design, delays.channels());
                Some(LeadCompensated::new(input.mismatch, leads))
            }
        };
        // Step 3.
        let gain_problem = Arc::new(input.gain_problem(compensated.as_deref()));
        let gains = self
            .gains
            .get_or_fail(Arc::clone(&gain_problem), |problem| {
                input.solve_problem(problem)
            })?;
        Ok(Optima {
            gains: gains.map_err(ConditionFailure::Gains)?,
            delays: delays.as_ref().map_err(delay_failure)?.clone(),
            gain_problem,
            delay_problem,
            compensated,
        })
    }

    /// Computes the delays or signed delays.
    pub(crate) fn delays(
        &mut self,
        input: &SolveInput<'_>,
        problem: &Arc<Problem>,
    ) -> Result<Solved, Cancelled> {
        self.delays
            .get_or_fail(Arc::clone(problem), |problem| input.solve_problem(problem))
    }

    /// Estimates the benefit of leads, where they are not requested and all constrained responses
    /// need them; `None` otherwise, if the signed delays have no solution, or if J would not fall
    /// by more than a tenth. `present` is J under the present correction.
    ///
    /// # Errors
    /// [`Cancelled`] where the run is cancelled.
    pub(crate) fn offer(
        &mut self,
        input: &SolveInput<'_>,
        held: &PairTable<bool>,
        present: &PairTable<Option<CostChange>>,
    ) -> Result<Option<LeadOffer>, Cancelled> {
        let settings = input.settings();
        if settings.phase == PhaseCorrection::Lead || !input.all_need_lead(held) {
            return Ok(None);
        }
        let omega = input.run.grid.omega();
        let design = Arc::new(LeadDesign::new(settings.lead, omega.into()));
        let problem = Problem {
            constrained: held.clone(),
            bounds: Bounds {
                lower: design.lower_s(),
                upper: input.delay_upper_s,
            },
            // `alpha` only affects how a delay is divided among the channels, not whether
            // constraints are met: it is 1 here, whatever the study's weight.
            alpha: 1.0,
            ..input.delay_problem(Some(&design))
        };
        let progress = input.run.execution.progress();
        let solution = self.offer.get_or_fail(Arc::new(problem), |problem| {
            solve_within(problem, ProofBudget::default(), progress)
        })?;
        // Without a solution, leads are not recommended.
        let Ok(solution) = solution else {
            return Ok(None);
        };
        let leads = ChannelLeads::new(design, solution.channels());
        let held_mismatch = input.mismatch.map(
            |pair, mismatch| {
                if held[pair] { mismatch.clone() } else { None }
            },
        );
        Ok(LeadOffer::new(
            leads,
            &held_mismatch,
            present,
            omega,
            settings.cost_average,
        ))
    }
}

fn delay_failure(error: &ProblemError) -> ConditionFailure {
    ConditionFailure::Delays(error.clone())
}

/// Inputs to a condition's optimisation problems.
pub(crate) struct SolveInput<'a> {
    run: Run<'a>,
    /// Responses from which the bounds are computed: the on-axis responses, or all responses if
    /// none is on-axis.
    measuring: &'a PairTable<bool>,
    mismatch: &'a Mismatches,
    delta: &'a Delta,
    /// Upper delay bound \[s\].
    delay_upper_s: f64,
}

impl<'a> SolveInput<'a> {
    pub(crate) fn new(
        run: Run<'a>,
        measuring: &'a PairTable<bool>,
        mismatch: &'a Mismatches,
        delta: &'a Delta,
    ) -> Self {
        let settings = &run.study.settings;
        let delay_upper_s = match settings.delay_upper_s {
            Some(upper_s) => upper_s,
            None => delay_upper_s(mismatch, measuring, run.grid.omega(), settings.quantile),
        };
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

    /// Solves a problem, and proves optimality within the run's budget.
    fn solve_problem(&self, problem: &Problem) -> Result<Solved, Cancelled> {
        solve_within(problem, self.run.proofs, self.run.execution.progress())
    }

    /// Returns whether there are constrained responses, and all need lead.
    fn all_need_lead(&self, held: &PairTable<bool>) -> bool {
        held.marked().next().is_some()
            && held.marked().all(|pair| {
                let delay_s = self.delta.band_delay_s[pair].unwrap_or_default();
                delay_s < 0.0
            })
    }

    /// Returns the lead filters' common design; `None` where leads are not requested.
    pub(crate) fn lead_design(&self) -> Option<Arc<LeadDesign>> {
        if self.settings().phase != PhaseCorrection::Lead {
            return None;
        }
        let omega = self.run.grid.omega().into();
        Some(Arc::new(LeadDesign::new(self.settings().lead, omega)))
    }

    /// Builds the gain problem, from the difference that remains after the leads, if any.
    fn gain_problem(&self, compensated: Option<&LeadCompensated>) -> Problem {
        let settings = self.settings();
        let (mismatch, gain) = match compensated {
            Some(compensated) => (&compensated.mismatch, &compensated.gain),
            None => (self.mismatch, &self.delta.gain),
        };
        Problem {
            quantity: Quantity::Gain(settings.gain_objective),
            delta: gain.clone(),
            constrained: settings
                .constrained
                .map(|pair, held| *held && self.delta.gain[pair].is_some()),
            fitted: settings.fitted(),
            bounds: match settings.gain_bounds {
                Some(bounds) => bounds,
                None => gain_bounds(mismatch, self.measuring, settings.quantile),
            },
            alpha: settings.alpha_gain,
            agreement: settings.agreement_db,
        }
    }

    /// Builds the delay problem for the D chosen in the settings; with a lead design, the signed
    /// delay problem for D over the band. Without phase correction nothing is constrained, and the
    /// upper bound is zero.
    pub(crate) fn delay_problem(&self, design: Option<&LeadDesign>) -> Problem {
        let settings = self.settings();
        let is_corrected = settings.phase != PhaseCorrection::None;
        let from_band = design.is_some() || settings.delay_from == DelayFrom::Band;
        let delta = if from_band {
            &self.delta.band_delay_s
        } else {
            &self.delta.delay_s
        };
        let (quantity, lower) = match design {
            Some(design) => (Quantity::SignedDelay, design.lower_s()),
            None => (Quantity::Delay, 0.0),
        };
        Problem {
            quantity,
            delta: delta.clone(),
            constrained: settings
                .constrained
                .map(|pair, held| *held && is_corrected && self.delta.gain[pair].is_some()),
            fitted: settings.fitted(),
            bounds: Bounds {
                lower,
                upper: if is_corrected {
                    self.delay_upper_s
                } else {
                    0.0
                },
            },
            alpha: settings.alpha_delay,
            agreement: DELAY_AGREEMENT_S,
        }
    }
}
