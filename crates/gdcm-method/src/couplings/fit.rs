//! The fit of mixing and feedback to all conditions at once (M16.2); without each condition in turn, and the error bars that this
//! gives (M16.4).
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

use super::coupling_matrices::CouplingMatrices;
use super::normal_equations::{ConditionBlocks, NormalEquations, UnknownLayout};
use super::problem::{CouplingError, CouplingProblem, Unknown};
use super::weighted_condition::WeightedCondition;
use crate::uncertainty::student_quantile;

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

/// Memory that the blocks of several conditions may take at once \[bytes\].
const BLOCK_MEMORY: usize = 256 << 20;

/// Fits the couplings of a problem: five weighted linear least-squares problems, one after the other (M16.2).
///
/// The same to the last bit whoever carries out its pieces. `progress` is told of every condition of every pass, and asked every few
/// frequencies whether to go on.
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
    let conditions = each(executor, &problem.conditions, |of| {
        WeightedCondition::new(problem, of, &fed_back)
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
        // The solution of a pass counts as one condition more.
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
        (residual, undetermined) = (pass.residual, pass.undetermined);
        fitting.advance()?;
    }
    fitting.shares.next(1.0, FITTING)?;
    matrices.check()?;
    let is_left_out = |output: &usize| problem.kind.feeds_back() && !fed_back.contains(output);
    Ok(CouplingFit {
        matrices,
        coefficients,
        residual,
        not_fed_back: (0..problem.outputs()).filter(is_left_out).collect(),
        undetermined: undetermined
            .into_iter()
            .map(|place| unknowns[place])
            .collect(),
        unknowns,
    })
}

/// The step that a fit reports.
const FITTING: &str = "mixing and feedback";

/// What the passes of a fit have in common.
struct Fitting<'a> {
    conditions: &'a [WeightedCondition<'a>],
    fed_back: &'a [usize],
    layout: UnknownLayout,
    shares: Shares<'a>,
    /// What a condition of a pass is of the whole.
    share: f64,
}

impl Fitting<'_> {
    /// The normal equations of the pass after these couplings.
    ///
    /// So many conditions are carried out side by side as there is memory for their blocks; they are added in their order.
    fn equations(
        &self,
        last: &CouplingMatrices,
        executor: &dyn Executor,
    ) -> Result<NormalEquations<'_>, CouplingError> {
        let inputs = last.feedback().nrows();
        let airspeeds = last.airspeeds();
        let together =
            (BLOCK_MEMORY / ConditionBlocks::bytes(inputs, self.fed_back.len()).max(1)).max(1);
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

/// Conditions below which there are no error bars.
pub const LEAST_CONDITIONS: usize = 3;

/// The fit without one condition.
#[derive(Clone, Debug, PartialEq)]
pub struct LeftOutFit {
    /// The condition that is left out.
    pub condition: ConditionId,
    /// The fit to all others.
    pub fit: CouplingFit,
}

/// The couplings without each condition in turn, in the order of the conditions; each is a piece of work of its own.
///
/// # Errors
/// [`CouplingError::TooFewConditions`] of fewer than three, and as [`fit_couplings`].
pub fn left_out_fits(
    problem: &CouplingProblem,
    executor: &dyn Executor,
    progress: &dyn Progress,
) -> Result<Vec<LeftOutFit>, CouplingError> {
    let count = problem.conditions.len();
    check_count(count)?;
    let shares = Shares::new(progress);
    let fits = each(executor, 0..count, |place| {
        let condition = problem.conditions[place].id;
        let portion = Portion::new(
            &shares,
            1.0 / count as f64,
            "mixing and feedback without each condition",
        );
        let fit = fit_couplings(&problem.without(place), &Sequential, &portion)?;
        portion.finish()?;
        Ok(LeftOutFit { condition, fit })
    });
    fits.into_iter().collect()
}

fn check_count(found: usize) -> Result<(), CouplingError> {
    let needed = LEAST_CONDITIONS;
    if found < needed {
        Err(CouplingError::TooFewConditions { needed, found })
    } else {
        Ok(())
    }
}

/// Half-widths of the error bars of mixing and feedback.
#[derive(Clone, Debug, PartialEq)]
pub struct CouplingBars {
    /// Of `M~` at one airspeed, m x m; 0 on its diagonal, which is 1.
    pub mixing: DMatrix<f64>,
    /// Of `K`, m x p.
    pub feedback: DMatrix<f64>,
    /// Student's quantile: a half-width over its standard deviation.
    pub quantile: f64,
}

impl CouplingBars {
    /// The bars of a level, Student's quantile of `n - 1` times the jackknife's standard deviation; those of the mixing at `airspeed_kt`.
    ///
    /// # Errors
    /// [`CouplingError::TooFewConditions`] of fewer than three.
    pub fn of(fits: &[LeftOutFit], airspeed_kt: f64, level: f64) -> Result<Self, CouplingError> {
        check_count(fits.len())?;
        let quantile = student_quantile(level, fits.len() as f64 - 1.0);
        let matrices = || fits.iter().map(|of| &of.fit.matrices);
        let mixing: Vec<_> = matrices()
            .map(|of| of.normalised_mixing(airspeed_kt))
            .collect();
        let feedback: Vec<_> = matrices().map(|of| of.feedback().clone()).collect();
        Ok(Self {
            mixing: jackknife(&mixing) * quantile,
            feedback: jackknife(&feedback) * quantile,
            quantile,
        })
    }
}

/// Standard deviation of each entry by the jackknife, of the matrices without each condition; at least one.
fn jackknife(without: &[DMatrix<f64>]) -> DMatrix<f64> {
    let count = without.len() as f64;
    let (rows, columns) = without[0].shape();
    DMatrix::from_fn(rows, columns, |row, column| {
        let mean = without.iter().map(|of| of[(row, column)]).sum::<f64>() / count;
        let square: f64 = without
            .iter()
            .map(|of| (of[(row, column)] - mean).powi(2))
            .sum();
        ((count - 1.0) / count * square).sqrt()
    })
}
