//! Fits mixing and feedback to all conditions at once, by successive linear least-squares problems,
//! the *passes* (M16.2): weights and closed loop of a pass follow from the couplings of the pass
//! before.

use gdcm_model::executor::{Executor, each};
use gdcm_model::progress::{Cancelled, Progress, Shares};

use super::condition_blocks::ConditionBlocks;
use super::coupling_matrices::CouplingMatrices;
use super::error::CouplingError;
use super::normal_equations::NormalEquations;
use super::problem::CouplingProblem;
use super::unknown::Unknown;
use super::unknown_layout::UnknownLayout;
use super::weighted_condition::WeightedCondition;

/// The fitted couplings, with the fit's course and quality.
#[derive(Clone, Debug, PartialEq)]
pub struct CouplingFit {
    pub matrices: CouplingMatrices,
    pub unknowns: Vec<Unknown>,
    /// The unknowns' values after each pass, ordered as `unknowns`.
    pub coefficients: Vec<Vec<f64>>,
    /// Optimality check for the last pass, a convex problem with a single optimum: the largest
    /// residual in the normal equations relative to their largest right-hand side.
    pub residual: f64,
    /// Outputs that cannot be fed back, because their response to some input is missing in every
    /// condition, in flight or in the physics model; empty for a mixing alone.
    pub not_fed_back: Vec<usize>,
    /// Unknowns that no response determines; they keep their uncoupled values.
    pub undetermined: Vec<Unknown>,
}

/// Memory limit for condition blocks computed in parallel \[bytes\].
const BLOCK_MEMORY: usize = 256 << 20;
/// Step name in progress reports.
const FITTING: &str = "mixing and feedback";

/// Fits the couplings, an input mixing `M` and a feedback `K` from outputs to inputs.
///
/// ```text
/// 1  outputs that can be fed back, unknowns in M and K, conditions arranged by frequency
/// 2  matrices <- M = I, K = 0
/// 3  for each pass (five by default):
/// 4     normal equations with the weights and the closed loop that follow from the matrices
/// 5     matrices <- their solution, regularised towards M = I, K = 0
/// 6  refuse a mixing that reverses an input
/// ```
///
/// The result is identical to the last bit in any order of execution. `progress` is notified after
/// every condition in every pass, and polled for cancellation every 64 frequencies.
///
/// # Errors
/// [`CouplingError`] if tables differ in shape, no response has a weight, the loop is singular in a
/// pass, the responses do not determine the unknowns, the mixing reverses an input's sign, or
/// `progress` is cancelled.
pub fn fit_couplings(
    problem: &CouplingProblem,
    executor: &dyn Executor,
    progress: &dyn Progress,
) -> Result<CouplingFit, CouplingError> {
    problem.check()?;
    let airspeeds = problem.airspeeds()?;
    // Step 1
    let fed_back = problem.fed_back();
    let unknowns = Unknown::list(problem, &airspeeds, &fed_back);
    let conditions = each(executor, &problem.conditions, |condition| {
        WeightedCondition::new(problem, condition, &fed_back)
    });
    if !conditions.iter().any(WeightedCondition::has_weight) {
        return Err(CouplingError::NothingToFit {
            conditions: conditions.len(),
        });
    }
    let passes = problem.options.passes.max(1);
    let fitting = Fitting {
        conditions: &conditions,
        fed_back: &fed_back,
        layout: UnknownLayout::new(&unknowns, problem.inputs(), &fed_back),
        shares: Shares::new(progress),
        // Each pass has one step for each condition, and one for the solution.
        progress_share: 1.0 / (passes * (conditions.len() + 1)) as f64,
    };
    // Step 2
    let mut matrices = CouplingMatrices::none(airspeeds, problem.inputs(), problem.outputs());
    let mut coefficients = Vec::new();
    let mut residual = 0.0;
    let mut undetermined = Vec::new();
    // Steps 3 to 5
    for _ in 0..passes {
        let pass = fitting
            .equations(&matrices, executor)?
            .solve(&unknowns, problem.options.ridge)?;
        matrices = matrices.with(&unknowns, pass.coefficients.as_slice());
        coefficients.push(pass.coefficients.as_slice().to_vec());
        residual = pass.residual;
        undetermined = pass.undetermined;
        fitting.advance()?;
    }
    fitting.shares.next(1.0, FITTING)?;
    // Step 6
    matrices.check()?;
    Ok(CouplingFit {
        matrices,
        coefficients,
        residual,
        not_fed_back: not_fed_back(problem, &fed_back),
        undetermined: undetermined
            .into_iter()
            .map(|index| unknowns[index])
            .collect(),
        unknowns,
    })
}

/// Returns the outputs that a feedback would use but cannot; empty for a mixing alone.
fn not_fed_back(problem: &CouplingProblem, fed_back: &[usize]) -> Vec<usize> {
    if !problem.kind.feeds_back() {
        return Vec::new();
    }
    (0..problem.outputs())
        .filter(|output| !fed_back.contains(output))
        .collect()
}

/// Data common to all passes in a fit.
struct Fitting<'a> {
    conditions: &'a [WeightedCondition<'a>],
    fed_back: &'a [usize],
    layout: UnknownLayout,
    shares: Shares<'a>,
    /// Progress share, 0 to 1, for one condition, or for the solution, in a pass.
    progress_share: f64,
}

impl Fitting<'_> {
    /// Returns the normal equations for the pass that starts from these couplings (step 4).
    ///
    /// As many conditions run in parallel as memory permits for their blocks; they are added in
    /// order.
    fn equations(
        &self,
        couplings: &CouplingMatrices,
        executor: &dyn Executor,
    ) -> Result<NormalEquations<'_>, CouplingError> {
        let inputs = couplings.feedback().nrows();
        let airspeeds = couplings.airspeeds();
        let block_bytes = ConditionBlocks::bytes(inputs, self.fed_back.len()).max(1);
        let parallel_conditions = (BLOCK_MEMORY / block_bytes).max(1);
        let mut equations = NormalEquations::zeros(&self.layout, inputs, self.fed_back.len());
        for conditions in self.conditions.chunks(parallel_conditions) {
            let blocks = each(executor, conditions, |condition| {
                let blocks = ConditionBlocks::new(
                    condition,
                    couplings,
                    self.fed_back,
                    self.shares.progress(),
                )?;
                self.advance()?;
                Ok::<_, CouplingError>(blocks)
            });
            for (blocks, condition) in blocks.into_iter().zip(conditions) {
                equations.add(&blocks?, airspeeds.scaled(condition.airspeed_kt));
            }
        }
        Ok(equations)
    }

    /// Reports one condition, or the solution, in a pass as done.
    fn advance(&self) -> Result<(), Cancelled> {
        self.shares.advance(self.progress_share, FITTING)
    }
}
