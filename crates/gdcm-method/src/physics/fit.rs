//! Fits the parameters to all conditions at once (M18.2), by a sequence of *passes*: each
//! linearises the logarithms of the responses at the present *point*, the values of all unknowns,
//! and solves the normal equations.
//!
//! The unknowns are the parameter values `z`, in plausible standard deviations, the channel delays
//! `tau`, and each condition's channel ln gains `a`, `b`. `R` is the identified response, `H^` the
//! physics response at the point with the channels' gains and delays, `q` a response's weight, and
//! `s` the misfit; `q` and `s` are renewed in each pass. The objective is
//!
//! ```text
//! nu/(N s^2) sum q^2 |ln(R / H^)|^2
//!     + sum z^2 + sum (tau / delay_sd)^2 + sum (a / gain_sd)^2 + sum (b / gain_sd)^2,
//! s^2 = max(sum q^2 |ln(R / H^)|^2 / (2 sum q^2), 0.01^2)
//! ```
//!
//! `N` is the number of frequencies in the grid. `PhysicsOptions` contains `nu`, how many
//! independent frequencies a response counts as, and the prior standard deviations `delay_sd` and
//! `gain_sd`.

use gdcm_model::executor::{Executor, each};
use gdcm_model::progress::{Progress, Shares};

use super::pass_equations::PassEquations;
use super::point::FitPoint;
use super::problem::{PhysicsError, PhysicsProblem};
use super::weighted_condition::{PassPoint, WeightedCondition};
use crate::correction::Channels;

/// Greatest change in a parameter value per pass, in plausible standard deviations: a pass's
/// linearisation is not trusted further.
const GREATEST_STEP: f64 = 1.0;
/// The passes end when no parameter value changes by more than this, in plausible standard
/// deviations.
const SETTLED: f64 = 1e-3;
/// Minimum number of passes, unless [`PhysicsProblem::options`] permits fewer: the weights of the
/// first two still belong to points on the way to the solution.
const FEWEST_PASSES: usize = 3;
/// Step name in progress reports.
const FITTING: &str = "physics parameters";

/// A pass in the fit: the values that it reached, and the misfit from which it started.
#[derive(Clone, Debug, PartialEq)]
pub struct FitPass {
    /// All parameter values after the pass, in plausible standard deviations.
    pub z: Vec<f64>,
    /// `s^2` before the pass.
    pub misfit_square: f64,
    /// `sum q^2 |ln(R / H^)|^2` before the pass.
    pub weighted_square: f64,
}

/// The fitted values, and how the fit proceeded.
#[derive(Clone, Debug, PartialEq)]
pub struct PhysicsFit {
    /// All parameter values, including those set by hand, in plausible standard deviations.
    pub z: Vec<f64>,
    /// Fitted parameters' indices, ascending.
    pub fitted: Vec<usize>,
    /// `tau`: channel delays, positive or negative \[s\].
    pub delays_s: Channels<f64>,
    /// `a`, `b`: channel ln gains, for each condition.
    pub ln_gains: Vec<Channels<f64>>,
    pub passes: Vec<FitPass>,
    /// Index of the parameter that moved most in the last pass; `None` if none moved by more than
    /// 1e-3.
    pub still_moving: Option<usize>,
    /// Misfit `s` at the solution, ln units, at least 0.01.
    pub misfit: f64,
}

/// A fit with the normal equations at its solution, from which intervals and scores follow.
#[derive(Debug)]
pub(super) struct SolvedFit {
    pub(super) fit: PhysicsFit,
    pub(super) equations: PassEquations,
}

/// Fits the parameters (M18.2).
///
/// The result is the same in any order of execution. `progress` is notified after every condition
/// in every pass.
///
/// # Errors
/// [`PhysicsError`] if a table, a value or a setting in `problem` is invalid, no response has a
/// weight, the responses do not determine the unknowns, or `progress` is cancelled.
pub fn fit_parameters(
    problem: &PhysicsProblem,
    executor: &dyn Executor,
    progress: &dyn Progress,
) -> Result<PhysicsFit, PhysicsError> {
    Ok(solve(problem, executor, progress)?.fit)
}

/// Fits the parameters, and keeps the normal equations at the solution.
///
/// ```text
/// 1  point <- parameters at zero or at the values set by hand; no delays, no ln gains
/// 2  normal equations at the point, and their solution
/// 3  point <- towards the solution, as far as no z moves by more than 1
/// 4  repeat from 2: at least three passes, until no z moves by more than 1e-3, or the passes are
///    used up
/// 5  normal equations at the last point
/// ```
pub(super) fn solve(
    problem: &PhysicsProblem,
    executor: &dyn Executor,
    progress: &dyn Progress,
) -> Result<SolvedFit, PhysicsError> {
    problem.check()?;
    let fitting = Fitting::new(problem, executor, progress);
    let count = problem.conditions.len();
    // Step 1
    let mut point = FitPoint::new(
        problem.initial_values(),
        problem.inputs(),
        problem.outputs(),
        count,
    );
    let mut passes: Vec<FitPass> = Vec::new();
    let mut still_moving = None;
    for pass in 1..=problem.options.passes.max(1) {
        // Steps 2 and 3
        let equations = fitting.equations(&point)?;
        still_moving = point.step_to(&equations.solution(&point, &fitting.fitted)?);
        passes.push(FitPass {
            z: point.z.clone(),
            misfit_square: equations.misfit_square,
            weighted_square: equations.weighted_square,
        });
        // Step 4
        if still_moving.is_none() && pass >= FEWEST_PASSES {
            break;
        }
    }
    // Step 5
    let equations = fitting.equations(&point)?;
    fitting.shares.next(1.0, FITTING)?;
    Ok(SolvedFit {
        fit: PhysicsFit {
            z: point.z,
            fitted: fitting.fitted,
            delays_s: point.delays_s,
            ln_gains: point.ln_gains,
            passes,
            still_moving,
            misfit: equations.misfit_square.sqrt(),
        },
        equations,
    })
}

impl FitPoint {
    /// Moves to a pass's solution, whose values are already limited to the permitted range;
    /// shortens the whole step if a parameter would move by more than one plausible standard
    /// deviation. Returns the parameter that moves most, or `None` if all move by 1e-3 or less.
    fn step_to(&mut self, solution: &FitPoint) -> Option<usize> {
        let mut largest_step = 0.0;
        let mut most_moved = None;
        for (parameter, (z, solution_z)) in self.z.iter().zip(&solution.z).enumerate() {
            let step = (solution_z - z).abs();
            if step > largest_step {
                largest_step = step;
                most_moved = Some(parameter);
            }
        }
        let share = if largest_step > GREATEST_STEP {
            GREATEST_STEP / largest_step
        } else {
            1.0
        };
        self.move_towards(solution, share);
        if largest_step * share > SETTLED {
            most_moved
        } else {
            None
        }
    }
}

/// Data common to all passes in a fit.
struct Fitting<'a> {
    problem: &'a PhysicsProblem,
    conditions: Vec<WeightedCondition<'a>>,
    fitted: Vec<usize>,
    executor: &'a dyn Executor,
    shares: Shares<'a>,
    /// Progress share for one condition in one pass.
    progress_share: f64,
}

impl<'a> Fitting<'a> {
    fn new(
        problem: &'a PhysicsProblem,
        executor: &'a dyn Executor,
        progress: &'a dyn Progress,
    ) -> Self {
        // Every pass, and step 5, evaluate each condition once.
        let evaluations = (problem.options.passes.max(1) + 1) * problem.conditions.len().max(1);
        Self {
            conditions: problem
                .conditions
                .iter()
                .map(|condition| WeightedCondition::new(problem, condition))
                .collect(),
            fitted: problem.fitted_parameters(),
            problem,
            executor,
            shares: Shares::new(progress),
            progress_share: 1.0 / evaluations as f64,
        }
    }

    /// Forms the normal equations at a point.
    fn equations(&self, point: &FitPoint) -> Result<PassEquations, PhysicsError> {
        let indices = 0..self.conditions.len();
        let blocks = each(self.executor, indices, |index| {
            let blocks = self.conditions[index].blocks(&PassPoint {
                z: &point.z,
                fitted: &self.fitted,
                channels: point.channels(index),
            });
            self.shares.advance(self.progress_share, FITTING)?;
            Ok::<_, PhysicsError>(blocks)
        });
        let blocks = blocks.into_iter().collect::<Result<Vec<_>, _>>()?;
        PassEquations::new(self.problem, self.fitted.len(), blocks)
    }
}
