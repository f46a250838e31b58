//! Jobs on an analysis: proofs, toggles, variants, error bars, assessments, couplings,
//! physics parameters.
//!
//! A [`Job`] is a long computation in parallel to the interactive analysis. Jobs are equal if they
//! have the same output, so that a comparison leaves out what does not affect it; `Tools` are kept
//! from one job to the next.

use std::sync::Arc;

use gdcm_method::correction::problem::ProblemError;
use gdcm_method::correction::toggles::{Toggle, toggles};
use gdcm_method::correction::{Problem, ProofBudget, Solution};
use gdcm_model::dataset::Pair;
use gdcm_model::progress::{Cancelled, Progress};

use super::job::Job;
use crate::decisions::physics_settings::PhysicsCorrection;
use crate::decisions::settings::CouplingCorrection;
use crate::decisions::study::Study;
use crate::execution::in_turn;
use crate::results::analysis::{Analysis, ConditionAnalysis};
use crate::results::assessment_table::{AssessmentChoice, AssessmentTable};
use crate::results::couplings_assessment::AssessedCouplings;
use crate::results::physics_assessment::AssessedPhysics;
use crate::results::uncertainty::Uncertainty;
use crate::shared::Shared;
use crate::stages::couplings_assessment::with_couplings;
use crate::stages::engine::Engine;
use crate::stages::optima::solve_within;
use crate::stages::physics_assessment::with_physics;

/// Maximum work for the proof behind a toggle's cost, in evaluations of a term in the objective:
/// about 0.1 s on a core. A limited proof is enough: the costs serve as a hint, not as a result.
const TOGGLE_PROOF_WORK: u64 = 4_000_000;

/// Job that completes the optimality proof for eq. (7) in a condition, if the interactive
/// analysis's budget was too small.
#[derive(Clone, Debug, PartialEq)]
pub struct ProofJob {
    pub problem: Arc<Problem>,
}

impl Job for ProofJob {
    type Tools = ();
    type Output = Result<Arc<Solution>, ProblemError>;

    fn run(&self, (): &mut (), progress: &dyn Progress) -> Result<Self::Output, Cancelled> {
        solve_within(&self.problem, ProofBudget::default(), progress)
    }
}

/// Job that computes the cost of each toggle in a condition: constraining a response, or releasing
/// a constrained response.
#[derive(Clone, Debug)]
pub struct TogglesJob {
    pub condition: ConditionAnalysis,
}

impl TogglesJob {
    /// Returns whether the costs apply to this result. They depend on its two problems and on the
    /// optimal objectives, to which each changed problem is compared.
    pub fn is_of(&self, condition: &ConditionAnalysis) -> bool {
        let own = &self.condition;
        let other = condition;
        own.gain_problem == other.gain_problem
            && own.delay_problem == other.delay_problem
            && own.gains.objective == other.gains.objective
            && own.delays.objective == other.delays.objective
    }
}

impl PartialEq for TogglesJob {
    fn eq(&self, other: &Self) -> bool {
        self.is_of(&other.condition)
    }
}

impl Job for TogglesJob {
    type Tools = ();
    /// `None` if a problem has no solution.
    type Output = Option<Toggles>;

    fn run(&self, (): &mut (), progress: &dyn Progress) -> Result<Self::Output, Cancelled> {
        let budget = ProofBudget {
            work: TOGGLE_PROOF_WORK,
            ..ProofBudget::default()
        };
        let ConditionAnalysis {
            gain_problem,
            gains,
            delay_problem,
            delays,
            ..
        } = &self.condition;
        let gains = toggles(gain_problem, gains, budget, &|| progress.cancelled());
        let delays = toggles(delay_problem, delays, budget, &|| progress.cancelled());
        if progress.cancelled() {
            return Err(Cancelled);
        }
        match (gains, delays) {
            (Ok(gains), Ok(delays)) => Ok(Some(Toggles { gains, delays })),
            _ => Ok(None),
        }
    }
}

/// Cost of each toggle in a condition.
#[derive(Clone, Debug, PartialEq)]
pub struct Toggles {
    pub gains: Vec<Toggle>,
    pub delays: Vec<Toggle>,
}

impl Toggles {
    /// Returns a response's toggles: in the gain problem, and in the delay problem.
    pub fn of_pair(&self, pair: Pair) -> (Option<&Toggle>, Option<&Toggle>) {
        let gain = self.gains.iter().find(|toggle| toggle.pair == pair);
        (gain, self.delays.iter().find(|toggle| toggle.pair == pair))
    }
}

/// Job that analyses a variant ([`Study::of_variant`]), in parallel to the interactive analysis.
#[derive(Clone, Debug)]
pub struct VariantJob {
    pub study: Study,
}

impl PartialEq for VariantJob {
    /// Compares the dataset, the settings and the choices, but not the reasons for rejections.
    fn eq(&self, other: &Self) -> bool {
        let a = &self.study;
        let b = &other.study;
        Arc::ptr_eq(&a.dataset, &b.dataset)
            && a.settings == b.settings
            && a.dataset
                .ids()
                .all(|id| a.choice(id).without_reasons() == b.choice(id).without_reasons())
    }
}

impl Job for VariantJob {
    /// An engine that caches the responses and distances: they depend only on the band, the number
    /// of frequencies and the coherence threshold, so that most variants share them.
    type Tools = Engine;
    type Output = Arc<Analysis>;

    fn run(&self, engine: &mut Engine, progress: &dyn Progress) -> Result<Self::Output, Cancelled> {
        engine.analyze(&self.study, progress).map(Arc::new)
    }
}

/// Job that computes an analysis's error bars, and the conclusions drawn from them.
#[derive(Clone, Debug, PartialEq)]
pub struct UncertaintyJob {
    pub analysis: Shared<Analysis>,
}

impl Job for UncertaintyJob {
    /// An engine that keeps responses and model swaps, from which the error bars follow, from one
    /// analysis to the next.
    type Tools = Engine;
    type Output = Arc<Uncertainty>;

    fn run(&self, engine: &mut Engine, progress: &dyn Progress) -> Result<Self::Output, Cancelled> {
        engine.uncertainty(&self.analysis, progress).map(Arc::new)
    }
}

/// Job that assesses all conditions; with hundreds of conditions, this takes longer than one drawn
/// frame.
#[derive(Clone, Debug, PartialEq)]
pub struct AssessmentJob {
    pub analysis: Shared<Analysis>,
    pub choice: AssessmentChoice,
}

impl Job for AssessmentJob {
    type Tools = ();
    type Output = Arc<AssessmentTable>;

    fn run(&self, (): &mut (), progress: &dyn Progress) -> Result<Self::Output, Cancelled> {
        let mut table = AssessmentTable::new(self.choice);
        let conditions = self.analysis.study.dataset.conditions();
        in_turn(conditions, progress, |condition| {
            table.add(&self.analysis, condition.id())
        })?;
        Ok(Arc::new(table))
    }
}

/// Job that assesses couplings for a study, in parallel to the interactive analysis.
#[derive(Clone, Debug)]
pub struct CouplingsJob {
    /// The study; its own coupling setting is ignored.
    pub study: Study,
    pub couplings: CouplingCorrection,
}

impl CouplingsJob {
    fn variant(&self) -> VariantJob {
        VariantJob {
            study: with_couplings(&self.study, self.couplings),
        }
    }
}

impl PartialEq for CouplingsJob {
    fn eq(&self, other: &Self) -> bool {
        self.variant() == other.variant()
    }
}

impl Job for CouplingsJob {
    /// An engine that caches the results common to all fits.
    type Tools = Engine;
    type Output = Option<AssessedCouplings>;

    fn run(&self, engine: &mut Engine, progress: &dyn Progress) -> Result<Self::Output, Cancelled> {
        engine.assess_couplings(&self.study, self.couplings, progress)
    }
}

/// Job that diagnoses and assesses a study's physics parameters, in parallel to the interactive
/// analysis.
#[derive(Clone, Debug)]
pub struct PhysicsJob {
    /// The study; its own choice of applied parameters is ignored.
    pub study: Study,
    /// The parameters whose effect is assessed.
    pub physics: PhysicsCorrection,
}

impl PhysicsJob {
    fn variant(&self) -> VariantJob {
        VariantJob {
            study: with_physics(&self.study, self.physics),
        }
    }
}

impl PartialEq for PhysicsJob {
    fn eq(&self, other: &Self) -> bool {
        self.variant() == other.variant()
    }
}

impl Job for PhysicsJob {
    /// An engine that caches the results common to all fits.
    type Tools = Engine;
    /// `None` where no parameters are requested.
    type Output = Option<AssessedPhysics>;

    fn run(&self, engine: &mut Engine, progress: &dyn Progress) -> Result<Self::Output, Cancelled> {
        engine.assess_physics(&self.study, self.physics, progress)
    }
}
