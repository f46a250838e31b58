//! Cost of each constrained entry and each active bound at the solution, from its multiplier.
//!
//! A *multiplier* is the derivative of the minimum objective with respect to a constrained entry's
//! prescribed value or to an active bound; `multipliers` has the conditions that determine it. A
//! *piece* is a group of channels that constrained entries connect: it moves as a whole.

use gdcm_model::dataset::Pair;

use super::channels::Channel;
use super::multipliers::{ConstrainedMinimum, Multipliers};
use super::problem::Problem;
use super::quantity::Quantity;
use super::solution::Solution;

/// A constraint that prevents a lower objective.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ActiveConstraint {
    /// An entry that is constrained to its target.
    Held(Pair),
    /// A channel on its lower bound, such as a delay at zero that would otherwise be negative.
    LowerBound(Channel),
    UpperBound(Channel),
}

/// The minimum objective's sensitivity to an active constraint, from its multiplier.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sensitivity {
    pub quantity: Quantity,
    pub constraint: ActiveConstraint,
    /// Change in the minimum objective if the constrained value or the bound is raised, per dB or
    /// ms (to first order).
    pub per_unit: f64,
    /// `per_unit` divided by the objective; 0 if the objective is 0.
    pub share_per_unit: f64,
}

impl Sensitivity {
    /// Returns the step \[dB or ms\] in which to describe the sensitivity: the largest of 1, 0.1,
    /// 0.01, … for which the linear extrapolation changes the objective by at most half; the
    /// objective cannot fall below zero.
    pub fn step(&self) -> f64 {
        /// Maximum change, relative to the objective.
        const MOST_SHARE: f64 = 0.5;
        /// Maximum count of divisions by ten: the minimum step is a nanosecond, or 1e-6 dB.
        const MOST_POWERS: i32 = 6;
        let share = self.share_per_unit.abs();
        for power in 0..MOST_POWERS {
            let step = 10_f64.powi(-power);
            if share * step <= MOST_SHARE {
                return step;
            }
        }
        10_f64.powi(-MOST_POWERS)
    }
}

/// Computes the sensitivity to every constrained entry and every bound with a nonzero multiplier,
/// largest magnitude first.
///
/// `solution` is [`super::solve`]'s result for `problem`.
pub fn sensitivities(problem: &Problem, solution: &Solution) -> Vec<Sensitivity> {
    let minimum = ConstrainedMinimum::new(problem, solution);
    let multipliers = Multipliers::new(&minimum);
    let mut sensitivities = Vec::new();
    for (pair, &slope) in minimum.constrained.iter().zip(&multipliers.entries) {
        let held = ActiveConstraint::Held(*pair);
        sensitivities.push(sensitivity(problem, solution, held, slope));
    }
    let channels = Channel::inputs_then_outputs(minimum.inputs, solution.outputs.len());
    for (channel, &slope) in channels.zip(&multipliers.channels) {
        // The objective decreases if an upper bound is raised (negative slope) or a lower bound is
        // lowered.
        let bound = if slope < 0.0 {
            ActiveConstraint::UpperBound(channel)
        } else if slope != 0.0 {
            ActiveConstraint::LowerBound(channel)
        } else {
            continue;
        };
        sensitivities.push(sensitivity(problem, solution, bound, slope));
    }
    sensitivities.sort_by(|a, b| b.per_unit.abs().total_cmp(&a.per_unit.abs()));
    sensitivities
}

/// Converts a multiplier to a sensitivity per dB or per ms.
fn sensitivity(
    problem: &Problem,
    solution: &Solution,
    constraint: ActiveConstraint,
    slope: f64,
) -> Sensitivity {
    let per_unit = problem.quantity.per_unit(slope);
    let share_per_unit = if solution.objective > 0.0 {
        per_unit / solution.objective
    } else {
        0.0
    };
    Sensitivity {
        quantity: problem.quantity,
        constraint,
        per_unit,
        share_per_unit,
    }
}

/// Computes a solution's Karush-Kuhn-Tucker residual: the objective's maximum slope along a
/// direction in which channels could still move within the bounds and with the entries constrained.
/// For a convex problem, a residual of zero proves the minimum.
///
/// The unit is the objective's unit per natural logarithm unit (gains), or s² / s (delays).
/// `solution` is [`super::solve`]'s result for `problem`.
pub fn kkt_residual(problem: &Problem, solution: &Solution) -> f64 {
    let minimum = ConstrainedMinimum::new(problem, solution);
    let mut residual = 0.0_f64;
    for piece in minimum.pieces() {
        let push = minimum.push(&piece);
        if push.stopping.is_empty() {
            residual = residual.max(push.slope.abs());
        }
    }
    residual
}
