//! Long work that is done beside the live answer.

use std::sync::Arc;

use crate::correction::{Problem, ProblemError, ProofBudget, Solution, solve};
use crate::dataset::{Band, Condition, ConditionId, Dataset};

use super::condition_analysis::ConditionAnalysis;
use super::condition_modes::ConditionModes;
use super::curves::ConditionCurves;
use super::engine::Engine;
use super::progress::{Cancelled, Progress};
use super::toggles::Toggles;

/// One piece of long work with progress and cancellation, done beside the live answer.
///
/// Two jobs are equal where they have the same output: a job under way is given up only when no equal one is asked for any more.
pub trait Job: Clone + PartialEq + Send + 'static {
    /// What it works with, kept from one job to the next.
    type Tools;
    /// What it makes.
    type Output: Send;

    /// Does the work.
    ///
    /// # Errors
    /// [`Cancelled`] soon after `progress` says so.
    fn run(&self, tools: &mut Self::Tools, progress: &dyn Progress) -> Result<Self::Output, Cancelled>;
}

/// The whole proof of equation (7) for one condition, where the live answer's budget did not reach.
#[derive(Clone, Debug, PartialEq)]
pub struct ProofJob {
    /// What the gains are asked to do.
    pub problem: Arc<Problem>,
}

impl Job for ProofJob {
    type Tools = ();
    type Output = Result<Arc<Solution>, ProblemError>;

    fn run(&self, (): &mut (), progress: &dyn Progress) -> Result<Self::Output, Cancelled> {
        match solve(&self.problem, ProofBudget::default(), &|| progress.cancelled()) {
            Err(ProblemError::Stopped) => Err(Cancelled),
            solved => Ok(solved.map(Arc::new)),
        }
    }
}

/// What holding or freeing each response of one condition would cost.
#[derive(Clone, Debug)]
pub struct TogglesJob {
    /// The condition's result.
    pub condition: ConditionAnalysis,
}

impl TogglesJob {
    /// Whether the costs are those of this result: they depend on its two problems, and on the objectives that they are
    /// compared with.
    pub fn is_of(&self, condition: &ConditionAnalysis) -> bool {
        let (a, b) = (&self.condition, condition);
        let same_problems = a.gain_problem == b.gain_problem && a.delay_problem == b.delay_problem;
        same_problems && a.gains.objective == b.gains.objective && a.delays.objective == b.delays.objective
    }
}

impl PartialEq for TogglesJob {
    fn eq(&self, other: &Self) -> bool {
        self.is_of(&other.condition)
    }
}

impl Job for TogglesJob {
    type Tools = ();
    /// None where a problem has no answer.
    type Output = Option<Toggles>;

    fn run(&self, (): &mut (), progress: &dyn Progress) -> Result<Self::Output, Cancelled> {
        let toggles = Toggles::of(&self.condition, &|| progress.cancelled());
        if progress.cancelled() { Err(Cancelled) } else { Ok(toggles) }
    }
}

/// The responses of every model of one condition, for drawing.
#[derive(Clone, Debug)]
pub struct CurvesJob {
    /// The models.
    pub dataset: Arc<Dataset>,
    /// The condition.
    pub condition: ConditionId,
    /// Band, and the number of frequencies in it.
    pub grid: (Band, usize),
}

impl PartialEq for CurvesJob {
    fn eq(&self, other: &Self) -> bool {
        let same_dataset = Arc::ptr_eq(&self.dataset, &other.dataset);
        same_dataset && self.condition == other.condition && self.grid == other.grid
    }
}

impl Job for CurvesJob {
    /// The engine that keeps the models prepared.
    type Tools = Engine;
    /// None of a condition that the dataset does not have.
    type Output = Option<Arc<ConditionCurves>>;

    fn run(&self, engine: &mut Engine, progress: &dyn Progress) -> Result<Self::Output, Cancelled> {
        engine.curves(&self.dataset, self.condition, self.grid, progress)
    }
}

/// The modes of every model of one condition.
#[derive(Clone, Debug)]
pub struct ModesJob {
    /// The condition.
    pub condition: Arc<Condition>,
}

impl PartialEq for ModesJob {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.condition, &other.condition)
    }
}

impl Job for ModesJob {
    type Tools = ();
    type Output = Arc<ConditionModes>;

    fn run(&self, (): &mut (), progress: &dyn Progress) -> Result<Self::Output, Cancelled> {
        ConditionModes::of(&self.condition, progress).map(Arc::new)
    }
}
