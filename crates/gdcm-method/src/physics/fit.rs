//! Fits the parameters to all conditions at once (steps 2 to 8 of `physics`, M18.2).

use nalgebra::DVector;

use gdcm_model::executor::{Executor, each};
use gdcm_model::progress::{Progress, Shares};
use gdcm_model::statistics::mean;

use super::condition_equations::{
    ConditionEquations, EquationScale, Part, ReducedEquations, UnknownCounts,
};
use super::pair_blocks::{ConditionBlocks, PassPoint, WeightedCondition};
use super::point::FitPoint;
use super::problem::{PhysicsError, PhysicsProblem};
use super::shared_system::SharedSystem;
use crate::correction::Channels;

/// Greatest magnitude of a parameter's value, in plausible standard deviations.
pub const GREATEST_VALUE: f64 = 3.0;
/// Greatest change of a value in one pass.
const GREATEST_STEP: f64 = 1.0;
/// Change of every value below which the passes end.
const SETTLED: f64 = 1e-3;
/// Fewest passes.
const FEWEST_PASSES: usize = 3;
/// Least misfit `s`, ln units.
const LEAST_MISFIT: f64 = 0.01;
/// Step name in progress reports.
const FITTING: &str = "physics parameters";

/// A pass of the fit.
#[derive(Clone, Debug, PartialEq)]
pub struct FitPass {
    /// Values of all parameters after the pass, in plausible standard deviations.
    pub z: Vec<f64>,
    /// `s^2` before the pass.
    pub misfit_square: f64,
    /// `sum q^2 |ln(R / H^)|^2` before the pass.
    pub weighted_square: f64,
}

/// The fitted values, and the course of the fit.
#[derive(Clone, Debug, PartialEq)]
pub struct PhysicsFit {
    /// Values of all parameters, held ones included, in plausible standard deviations.
    pub z: Vec<f64>,
    /// Indices of the fitted parameters, ascending.
    pub fitted: Vec<usize>,
    /// `tau`: delays of the channels, of either sign \[s\].
    pub delays_s: Channels<f64>,
    /// `a`, `b`: ln gains of the channels, for each condition.
    pub ln_gains: Vec<Channels<f64>>,
    pub passes: Vec<FitPass>,
    /// Index of the parameter that still moved most in the last pass; `None` if all had settled.
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
/// The result is the same in any order of execution. `progress` is notified after every condition in
/// every pass.
///
/// # Errors
/// [`PhysicsError`] if a table has another shape, no response has a weight, the responses do not
/// determine the unknowns, or `progress` is cancelled.
pub fn fit_parameters(
    problem: &PhysicsProblem,
    executor: &dyn Executor,
    progress: &dyn Progress,
) -> Result<PhysicsFit, PhysicsError> {
    Ok(solve(problem, executor, progress)?.fit)
}

/// Fits the parameters, and returns the normal equations at the solution with them.
pub(super) fn solve(
    problem: &PhysicsProblem,
    executor: &dyn Executor,
    progress: &dyn Progress,
) -> Result<SolvedFit, PhysicsError> {
    problem.check()?;
    let fitting = Fitting::new(problem, executor, progress);
    let count = problem.conditions.len();
    let mut point = FitPoint::new(
        problem.initial_values(),
        problem.inputs(),
        problem.outputs(),
        count,
    );
    let mut passes: Vec<FitPass> = Vec::new();
    let mut still_moving = None;
    for pass in 1..=problem.options.passes.max(1) {
        let equations = fitting.equations(&point)?;
        let step = point.step_to(&equations.solution(&point, &fitting.fitted)?);
        passes.push(FitPass {
            z: point.z.clone(),
            misfit_square: equations.misfit_square,
            weighted_square: equations.weighted_square,
        });
        still_moving = step;
        if still_moving.is_none() && pass >= FEWEST_PASSES {
            break;
        }
    }
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
    /// Moves to the solution of a pass, its values cut to the greatest permitted; shortens the whole
    /// step if a value would move by more than one plausible standard deviation. Returns the
    /// parameter that moves most, `None` if all move by 1e-3 or less.
    fn step_to(&mut self, solution: &FitPoint) -> Option<usize> {
        let mut largest = 0.0;
        let mut moving = None;
        for (parameter, (z, other)) in self.z.iter().zip(&solution.z).enumerate() {
            let step = (other - z).abs();
            if step > largest {
                largest = step;
                moving = Some(parameter);
            }
        }
        let share = if largest > GREATEST_STEP {
            GREATEST_STEP / largest
        } else {
            1.0
        };
        self.move_towards(solution, share);
        if largest * share > SETTLED {
            moving
        } else {
            None
        }
    }
}

/// Data common to all passes of a fit.
struct Fitting<'a> {
    problem: &'a PhysicsProblem,
    conditions: Vec<WeightedCondition<'a>>,
    fitted: Vec<usize>,
    executor: &'a dyn Executor,
    shares: Shares<'a>,
    /// Share of the progress that a condition has in a pass.
    share: f64,
}

impl<'a> Fitting<'a> {
    fn new(
        problem: &'a PhysicsProblem,
        executor: &'a dyn Executor,
        progress: &'a dyn Progress,
    ) -> Self {
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
            share: 1.0 / evaluations as f64,
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
            self.shares.advance(self.share, FITTING)?;
            Ok::<_, PhysicsError>(blocks)
        });
        let blocks = blocks.into_iter().collect::<Result<Vec<_>, _>>()?;
        PassEquations::new(self.problem, self.fitted.len(), blocks)
    }
}

/// The normal equations of all conditions at a point.
#[derive(Debug)]
pub(super) struct PassEquations {
    pub(super) blocks: Vec<ConditionBlocks>,
    pub(super) counts: UnknownCounts,
    pub(super) scale: EquationScale,
    /// Prior standard deviation of a delay \[s\].
    delay_sd_s: f64,
    pub(super) conditions: Vec<ConditionEquations>,
    pub(super) reduced: Vec<ReducedEquations>,
    pub(super) system: SharedSystem,
    /// `s^2`.
    pub(super) misfit_square: f64,
    /// `sum q^2 |ln(R / H^)|^2`.
    pub(super) weighted_square: f64,
}

impl PassEquations {
    fn new(
        problem: &PhysicsProblem,
        parameters: usize,
        blocks: Vec<ConditionBlocks>,
    ) -> Result<Self, PhysicsError> {
        let mut weighted_square = 0.0;
        let mut weight = 0.0;
        for condition in &blocks {
            let sums = condition.sums();
            weighted_square += sums.squared_error;
            weight += sums.weight;
        }
        if weight.is_nan() || weight <= 0.0 {
            return Err(PhysicsError::NothingToFit {
                conditions: blocks.len(),
            });
        }
        let misfit_square = (weighted_square / (2.0 * weight)).max(LEAST_MISFIT.powi(2));
        let counts = UnknownCounts {
            parameters,
            outputs: problem.outputs(),
            inputs: problem.inputs(),
        };
        let options = &problem.options;
        let scale = EquationScale {
            weight: options.independent_frequencies / (problem.omega.len() as f64 * misfit_square),
            gain_sd: options.gain_sd,
        };
        let mut system = SharedSystem::new(counts, options.delay_sd_s);
        let mut conditions = Vec::with_capacity(blocks.len());
        let mut reduced = Vec::with_capacity(blocks.len());
        for condition in &blocks {
            let equations = ConditionEquations::new(condition, counts, None);
            let condition = equations.reduced(scale).ok_or(singular(counts))?;
            system.add(&condition);
            conditions.push(equations);
            reduced.push(condition);
        }
        Ok(Self {
            blocks,
            counts,
            scale,
            delay_sd_s: options.delay_sd_s,
            conditions,
            reduced,
            system,
            misfit_square,
            weighted_square,
        })
    }

    /// Returns the solution, with the values of the parameters cut to the greatest permitted;
    /// parameters that are not fitted stay.
    fn solution(&self, point: &FitPoint, fitted: &[usize]) -> Result<FitPoint, PhysicsError> {
        let x = self.system.solve().ok_or(singular(self.counts))?;
        let mut solution = point.clone();
        for (value, &parameter) in x.iter().zip(fitted) {
            solution.z[parameter] = value.clamp(-GREATEST_VALUE, GREATEST_VALUE);
        }
        solution.delays_s = self.channels(&x, self.counts.parameters);
        for (index, ln_gains) in solution.ln_gains.iter_mut().enumerate() {
            let gains = self.conditions[index].ln_gains(&self.reduced[index], self.scale, &x);
            *ln_gains = self.channels(&gains, 0);
        }
        Ok(solution)
    }

    /// Returns the values of the channels in a vector of unknowns, outputs first, from index
    /// `first`.
    fn channels(&self, values: &DVector<f64>, first: usize) -> Channels<f64> {
        let values = values.as_slice();
        let outputs = first + self.counts.outputs;
        Channels {
            outputs: values[first..outputs].to_vec(),
            inputs: values[outputs..outputs + self.counts.inputs].to_vec(),
        }
    }

    /// Returns the number of conditions with any weight.
    pub(super) fn counting_conditions(&self) -> usize {
        let mut count = 0;
        for blocks in &self.blocks {
            if blocks.sums().weight > 0.0 {
                count += 1;
            }
        }
        count
    }

    /// Returns whether a part of the data has any weight.
    pub(super) fn has_data(&self, part: Part) -> bool {
        for blocks in &self.blocks {
            for (pair, thirds) in blocks.responses.iter() {
                for (third, block) in thirds.iter().enumerate() {
                    if part.contains(pair, third) && block.weight > 0.0 {
                        return true;
                    }
                }
            }
        }
        false
    }

    /// Returns the spread: the root of the mean over the conditions' other identified models;
    /// `None` without any.
    pub(super) fn spread(&self) -> Option<f64> {
        let squares: Vec<f64> = self
            .blocks
            .iter()
            .flat_map(|blocks| blocks.other_squares.iter().copied())
            .collect();
        if squares.is_empty() {
            return None;
        }
        Some(mean(&squares).sqrt())
    }

    /// Returns the shared equations without a part of the data in all conditions; `None` if they
    /// cannot be reduced.
    pub(super) fn system_without(&self, part: Part) -> Option<SharedSystem> {
        let mut system = SharedSystem::new(self.counts, self.delay_sd_s);
        for blocks in &self.blocks {
            let equations = ConditionEquations::new(blocks, self.counts, Some(part));
            system.add(&equations.reduced(self.scale)?);
        }
        Some(system)
    }
}

/// Returns the error of a normal matrix without Cholesky factors.
pub(super) fn singular(counts: UnknownCounts) -> PhysicsError {
    PhysicsError::SingularNormalMatrix {
        parameters: counts.parameters,
    }
}
