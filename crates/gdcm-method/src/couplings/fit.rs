//! Fits mixing and feedback to all conditions at once (M16.2), leave-one-out fits, and the error
//! bars derived from them (M16.4).
//!
//! ```text
//! sd^2 = (n - 1) / n sum_c (theta_(-c) - mean theta_(-c))^2,   half-width = t(n - 1) sd
//! ```
//!
//! B. Efron, "The Jackknife, the Bootstrap and Other Resampling Plans", SIAM 1982, chapter 3.

use nalgebra::DMatrix;

use gdcm_model::dataset::ConditionId;
use gdcm_model::executor::{Executor, Sequential, each};
use gdcm_model::progress::{Cancelled, Portion, Progress, Shares};

use super::condition_blocks::ConditionBlocks;
use super::coupling_matrices::CouplingMatrices;
use super::error::CouplingError;
use super::normal_equations::NormalEquations;
use super::problem::CouplingProblem;
use super::unknown::Unknown;
use super::unknown_layout::UnknownLayout;
use super::weighted_condition::WeightedCondition;
use crate::uncertainty::student_quantile;

/// The fitted couplings, and the course and quality of the fit.
#[derive(Clone, Debug, PartialEq)]
pub struct CouplingFit {
    pub matrices: CouplingMatrices,
    pub unknowns: Vec<Unknown>,
    /// Values of the unknowns after each solve, in the order of `unknowns`.
    pub coefficients: Vec<Vec<f64>>,
    /// Optimality check for the last solve, a convex problem with a single optimum: the largest
    /// residual of the normal equations relative to their largest right-hand side.
    pub residual: f64,
    /// Outputs that cannot be fed back, because their response to some input is missing in every
    /// condition.
    pub not_fed_back: Vec<usize>,
    /// Unknowns that no response determines; they keep their uncoupled values.
    pub undetermined: Vec<Unknown>,
}

/// Memory limit for condition blocks computed in parallel \[bytes\].
const BLOCK_MEMORY: usize = 256 << 20;

/// Fits the couplings by five successive weighted linear least-squares problems (M16.2).
///
/// The result is identical to the last bit in any order of execution. `progress` is notified after
/// every condition in every pass, and polled every few frequencies for cancellation.
///
/// # Errors
/// [`CouplingError`] if tables differ in shape, no response has a weight, the loop is singular in a
/// pass, the responses do not determine the unknowns, or `progress` is cancelled.
pub fn fit_couplings(
    problem: &CouplingProblem,
    executor: &dyn Executor,
    progress: &dyn Progress,
) -> Result<CouplingFit, CouplingError> {
    problem.check()?;
    let airspeeds = problem.airspeeds()?;
    let fed_back = problem.fed_back();
    let unknowns = Unknown::list(problem, &airspeeds, &fed_back);
    let conditions = each(executor, &problem.conditions, |condition| {
        WeightedCondition::new(problem, condition, &fed_back)
    });
    if !conditions.iter().any(WeightedCondition::counts) {
        return Err(CouplingError::NothingToFit {
            conditions: conditions.len(),
        });
    }
    let solves = problem.options.solves.max(1);
    let fitting = Fitting {
        conditions: &conditions,
        fed_back: &fed_back,
        layout: UnknownLayout::new(&unknowns, problem.inputs(), &fed_back),
        shares: Shares::new(progress),
        // Each pass has one step for each condition, and one for the solution.
        share: 1.0 / (solves * (conditions.len() + 1)) as f64,
    };
    let mut matrices = CouplingMatrices::none(airspeeds, problem.inputs(), problem.outputs());
    let mut coefficients = Vec::new();
    let mut residual = 0.0;
    let mut undetermined = Vec::new();
    for _ in 0..solves {
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
    matrices.check()?;
    let not_fed_back = if problem.kind.feeds_back() {
        (0..problem.outputs())
            .filter(|output| !fed_back.contains(output))
            .collect()
    } else {
        Vec::new()
    };
    Ok(CouplingFit {
        matrices,
        coefficients,
        residual,
        not_fed_back,
        undetermined: undetermined
            .into_iter()
            .map(|index| unknowns[index])
            .collect(),
        unknowns,
    })
}

/// Step name in progress reports.
const FITTING: &str = "mixing and feedback";

/// Data common to all passes of a fit.
struct Fitting<'a> {
    conditions: &'a [WeightedCondition<'a>],
    fed_back: &'a [usize],
    layout: UnknownLayout,
    shares: Shares<'a>,
    /// Share of the fit's progress that a condition contributes in a pass.
    share: f64,
}

impl Fitting<'_> {
    /// Returns the normal equations of the pass that starts from these couplings.
    ///
    /// As many conditions run in parallel as memory permits for their blocks; they are added in
    /// order.
    fn equations(
        &self,
        last: &CouplingMatrices,
        executor: &dyn Executor,
    ) -> Result<NormalEquations<'_>, CouplingError> {
        let inputs = last.feedback().nrows();
        let airspeeds = last.airspeeds();
        let block_bytes = ConditionBlocks::bytes(inputs, self.fed_back.len()).max(1);
        let together = (BLOCK_MEMORY / block_bytes).max(1);
        let mut equations = NormalEquations::zeros(&self.layout, inputs, self.fed_back.len());
        for conditions in self.conditions.chunks(together) {
            let blocks = each(executor, conditions, |condition| {
                let blocks =
                    ConditionBlocks::new(condition, last, self.fed_back, self.shares.progress())?;
                self.advance()?;
                Ok::<_, CouplingError>(blocks)
            });
            for (blocks, condition) in blocks.into_iter().zip(conditions) {
                equations.add(&blocks?, airspeeds.scaled(condition.airspeed_kt));
            }
        }
        Ok(equations)
    }

    fn advance(&self) -> Result<(), Cancelled> {
        self.shares.advance(self.share, FITTING)
    }
}

/// Minimum number of conditions for error bars.
pub const LEAST_CONDITIONS: usize = 3;

/// A fit to all conditions but one.
#[derive(Clone, Debug, PartialEq)]
pub struct LeftOutFit {
    /// The omitted condition.
    pub condition: ConditionId,
    pub fit: CouplingFit,
}

/// Fits the couplings once for each condition, without it, in the order of the conditions. The fits
/// run as independent tasks.
///
/// # Errors
/// [`CouplingError::TooFewConditions`] for fewer than three conditions, and all errors from
/// [`fit_couplings`].
pub fn left_out_fits(
    problem: &CouplingProblem,
    executor: &dyn Executor,
    progress: &dyn Progress,
) -> Result<Vec<LeftOutFit>, CouplingError> {
    let count = problem.conditions.len();
    check_count(count)?;
    let shares = Shares::new(progress);
    let fits = each(executor, 0..count, |index| {
        let condition = problem.conditions[index].id;
        let portion = Portion::new(
            &shares,
            1.0 / count as f64,
            "leave-one-out fits of mixing and feedback",
        );
        let fit = fit_couplings(&problem.without(index), &Sequential, &portion)?;
        portion.finish()?;
        Ok(LeftOutFit { condition, fit })
    });
    fits.into_iter().collect()
}

fn check_count(found: usize) -> Result<(), CouplingError> {
    if found < LEAST_CONDITIONS {
        return Err(CouplingError::TooFewConditions {
            needed: LEAST_CONDITIONS,
            found,
        });
    }
    Ok(())
}

/// Half-widths of the error bars for mixing and feedback.
#[derive(Clone, Debug, PartialEq)]
pub struct CouplingBars {
    /// Half-widths of `M~` at an airspeed, m x m; 0 on its diagonal, which is 1.
    pub mixing: DMatrix<f64>,
    /// Half-widths of `K`, m x p.
    pub feedback: DMatrix<f64>,
    /// Student's quantile: half-width divided by standard deviation.
    pub quantile: f64,
}

impl CouplingBars {
    /// Computes the error bars at a confidence level: Student's quantile with `n - 1` degrees of
    /// freedom times the jackknife standard deviation. The mixing is evaluated at `airspeed_kt`.
    ///
    /// # Errors
    /// [`CouplingError::TooFewConditions`] for fewer than three fits.
    pub fn of(fits: &[LeftOutFit], airspeed_kt: f64, level: f64) -> Result<Self, CouplingError> {
        check_count(fits.len())?;
        let quantile = student_quantile(level, fits.len() as f64 - 1.0);
        let mut mixing = Vec::with_capacity(fits.len());
        let mut feedback = Vec::with_capacity(fits.len());
        for LeftOutFit { fit, .. } in fits {
            mixing.push(fit.matrices.normalised_mixing(airspeed_kt));
            feedback.push(fit.matrices.feedback().clone());
        }
        Ok(Self {
            mixing: jackknife(&mixing) * quantile,
            feedback: jackknife(&feedback) * quantile,
            quantile,
        })
    }
}

/// Computes the jackknife standard deviation of each matrix entry from the leave-one-out matrices;
/// needs at least one matrix.
fn jackknife(without: &[DMatrix<f64>]) -> DMatrix<f64> {
    let count = without.len() as f64;
    let (rows, columns) = without[0].shape();
    DMatrix::from_fn(rows, columns, |row, column| {
        let entries = without.iter().map(|matrix| matrix[(row, column)]);
        let mean = entries.clone().sum::<f64>() / count;
        let square: f64 = entries.map(|entry| (entry - mean).powi(2)).sum();
        ((count - 1.0) / count * square).sqrt()
    })
}
