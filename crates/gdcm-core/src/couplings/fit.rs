//! The fit of mixing and feedback to all conditions at once (M16.2).

use nalgebra::DMatrix;

use super::{
    ConditionBlocks, CouplingError, CouplingMatrices, CouplingProblem, LastPass, NormalEquations, Unknown,
    WeightedCondition,
};
use crate::executor::{Executor, each};
use crate::progress::{Cancelled, Progress};
use crate::schedule::Airspeeds;

/// The couplings of a problem, and how they were found.
#[derive(Clone, Debug, PartialEq)]
pub struct CouplingFit {
    /// Mixing and feedback.
    pub matrices: CouplingMatrices,
    /// What was fitted.
    pub unknowns: Vec<Unknown>,
    /// Every unknown after each solve.
    pub coefficients: Vec<Vec<f64>>,
    /// The proof of the last solve, a convex problem of one optimum: the largest residual of its normal equations over their largest
    /// right side.
    pub residual: f64,
    /// The outputs that cannot be fed back, for some input has no response of them in any condition.
    pub not_fed_back: Vec<usize>,
    /// The unknowns of which no response says anything: they are as without couplings.
    pub undetermined: Vec<Unknown>,
}

/// Fits the couplings of a problem: five weighted linear least-squares problems, one after the other (M16.2).
///
/// The same to the last bit whoever carries out its pieces.
///
/// # Errors
/// [`CouplingError`] where tables do not fit together, no response counts, the loop of a pass is singular, the unknowns cannot be told
/// apart, or `progress` is cancelled.
pub fn fit_couplings(
    problem: &CouplingProblem,
    executor: &dyn Executor,
    progress: &dyn Progress,
) -> Result<CouplingFit, CouplingError> {
    problem.check()?;
    let airspeeds = problem.airspeeds()?;
    let fed_back = problem.fed_back();
    let unknowns = Unknown::all(problem, &airspeeds, &fed_back);
    let conditions = each(executor, &problem.conditions, |of| WeightedCondition::new(problem, of, &fed_back));
    if !conditions.iter().any(WeightedCondition::counts) {
        return Err(CouplingError::NothingToFit { conditions: conditions.len() });
    }
    let passes = Passes { problem, airspeeds, fed_back, unknowns, conditions };
    passes.run(executor, progress)
}

/// The passes of one fit.
struct Passes<'a> {
    problem: &'a CouplingProblem,
    airspeeds: Airspeeds,
    fed_back: Vec<usize>,
    unknowns: Vec<Unknown>,
    conditions: Vec<WeightedCondition<'a>>,
}

impl Passes<'_> {
    fn run(self, executor: &dyn Executor, progress: &dyn Progress) -> Result<CouplingFit, CouplingError> {
        let (problem, solves) = (self.problem, self.problem.options.solves.max(1));
        let mut matrices = CouplingMatrices::none(self.airspeeds.clone(), problem.inputs(), problem.outputs());
        let (mut coefficients, mut optimum) = (Vec::with_capacity(solves), None);
        for solve in 0..solves {
            let pass = self.equations(&matrices, executor, progress)?.solve(&self.unknowns, problem.options.ridge)?;
            matrices = matrices.with(&self.unknowns, pass.coefficients.as_slice());
            coefficients.push(pass.coefficients.as_slice().to_vec());
            optimum = Some(pass);
            progress.advanced(solve + 1, solves);
        }
        matrices.check()?;
        let Some(last) = optimum else { return Err(CouplingError::NothingToFit { conditions: 0 }) };
        let fed_back = problem.kind.feeds_back();
        let left_out = (0..problem.outputs()).filter(|output| fed_back && !self.fed_back.contains(output));
        Ok(CouplingFit {
            matrices,
            coefficients,
            residual: last.residual,
            not_fed_back: left_out.collect(),
            undetermined: last.undetermined.iter().map(|&place| self.unknowns[place]).collect(),
            unknowns: self.unknowns,
        })
    }

    /// The normal equations of the pass after these couplings.
    fn equations(
        &self,
        last: &CouplingMatrices,
        executor: &dyn Executor,
        progress: &dyn Progress,
    ) -> Result<NormalEquations, CouplingError> {
        let feedback: &DMatrix<f64> = last.feedback();
        let places: Vec<usize> = (0..self.conditions.len()).collect();
        let blocks = each(executor, places, |place| {
            if progress.cancelled() {
                return Err(CouplingError::Cancelled(Cancelled));
            }
            let mixing = last.mixing(self.problem.conditions[place].airspeed_kt);
            let last = LastPass { mixing, feedback, fed_back: &self.fed_back };
            ConditionBlocks::of(&self.conditions[place], &last)
        });
        let mut equations = NormalEquations::zeros(self.unknowns.len());
        for (blocks, condition) in blocks.into_iter().zip(&self.problem.conditions) {
            let v = self.airspeeds.scaled(condition.airspeed_kt);
            equations.add(&self.unknowns, &blocks?, &self.fed_back, v);
        }
        Ok(equations)
    }
}
