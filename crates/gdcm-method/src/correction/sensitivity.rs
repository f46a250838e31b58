//! Cost of each constrained entry and each active bound at the solution, from its multiplier.
//!
//! With the objective `F` as a function of the channels `x` (logarithms of the gains, or delays),
//! the solution satisfies the Karush-Kuhn-Tucker conditions
//!
//! ```text
//! dF/dx_c = mu_c + sum of lambda_e over the constrained entries e of channel c
//! ```
//!
//! The multiplier `lambda_e` is the derivative of the minimum with respect to the entry's
//! constrained sum of two channels, `mu_c` that with respect to the active bound of channel `c`: at
//! most 0 for an upper bound, at least 0 for a lower bound, and 0 without an active bound.

use nalgebra::{DMatrix, DVector};

use gdcm_model::dataset::Pair;

use super::channels::Channel;
use super::connected_pieces::connected_pieces;
use super::problem::{Entry, Problem};
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

/// Sensitivity of the minimum objective to an active constraint, from its multiplier.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sensitivity {
    pub quantity: Quantity,
    pub constraint: ActiveConstraint,
    /// Change of the minimum objective per dB or ms by which the constrained value or the bound is
    /// raised (to first order).
    pub per_unit: f64,
    /// `per_unit` divided by the objective; 0 if the objective is 0.
    pub share_per_unit: f64,
}

impl Sensitivity {
    /// Returns the step for the description \[dB or ms\]: the largest of 1, 0.1, 0.01, … for which
    /// the linear extrapolation changes the objective by at most half; the objective cannot fall
    /// below zero.
    pub fn step(&self) -> f64 {
        const MOST_SHARE: f64 = 0.5;
        /// Maximum number of powers of ten: the minimum step is a nanosecond, or 1e-6 dB.
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

/// Computes the sensitivity to every constrained entry and every active bound, in descending order
/// of magnitude.
///
/// `solution` is the solution of `problem` by [`super::solve`].
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

/// Computes `dF/dx_c`, the slope of the objective in the logarithm of each gain, or in each delay;
/// inputs first.
fn channel_slopes(problem: &Problem, solution: &Solution) -> Vec<f64> {
    let quantity = problem.quantity;
    let inputs = solution.inputs.len();
    let mut slopes = vec![0.0; inputs + solution.outputs.len()];
    for Entry { pair, delta } in problem.fit_entries() {
        let slope = quantity.squared_residual_slope(
            delta,
            solution.outputs[pair.output],
            solution.inputs[pair.input],
        );
        slopes[pair.input] += slope;
        slopes[inputs + pair.output] += slope;
    }
    let neutral = quantity.neutral();
    let first_regularised = if quantity.regularises_inputs() {
        0
    } else {
        inputs
    };
    let values = solution.inputs.iter().chain(&solution.outputs);
    for (slope, value) in slopes.iter_mut().zip(values).skip(first_regularised) {
        *slope += problem.alpha * quantity.squared_residual_slope(neutral, *value, neutral);
    }
    slopes
}

/// Computes the Karush-Kuhn-Tucker residual of a solution: the maximum slope of the objective along
/// a direction in which channels could still move within the bounds and with the entries
/// constrained. For a convex problem, a residual of zero proves the minimum.
///
/// The unit is that of the objective per channel unit; for delays, s² / s. `solution` is the
/// solution of `problem` by [`super::solve`].
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

/// Whether the value of a channel equals its lower and its upper bound.
#[derive(Clone, Copy)]
struct AtBounds {
    lower: bool,
    upper: bool,
}

/// Slope of the objective along the common movement of a group of connected channels.
struct Push {
    slope: f64,
    /// Channels whose active bounds stop the movement.
    stopping: Vec<usize>,
}

/// The minimum, with the channels as variables: inputs first, then outputs.
struct ConstrainedMinimum {
    inputs: usize,
    /// Slope of the objective in the value of each channel.
    slopes: Vec<f64>,
    /// By channel.
    at_bounds: Vec<AtBounds>,
    /// Constrained entries; each fixes the sum of an input and an output.
    constrained: Vec<Pair>,
}

impl ConstrainedMinimum {
    fn new(problem: &Problem, solution: &Solution) -> Self {
        let at_bounds = solution
            .inputs
            .iter()
            .chain(&solution.outputs)
            .map(|&value| AtBounds {
                lower: value == problem.bounds.lower,
                upper: value == problem.bounds.upper,
            })
            .collect();
        let constrained = problem
            .constrained_entries()
            .map(|entry| entry.pair)
            .collect();
        Self {
            inputs: solution.inputs.len(),
            slopes: channel_slopes(problem, solution),
            at_bounds,
            constrained,
        }
    }

    /// Groups the channels that are connected by constrained entries.
    fn pieces(&self) -> Vec<Vec<usize>> {
        let ties = self
            .constrained
            .iter()
            .map(|pair| [pair.input, self.inputs + pair.output]);
        connected_pieces(self.slopes.len(), ties)
    }

    /// Returns 1 for an input and -1 for an output: in a common movement, an output decreases when
    /// the inputs connected with it increase, because the sums are constrained.
    fn sign(&self, channel: usize) -> f64 {
        if channel < self.inputs { 1.0 } else { -1.0 }
    }

    /// Computes the slope of the objective along the common movement of a group of connected
    /// channels.
    fn push(&self, piece: &[usize]) -> Push {
        let slope: f64 = piece
            .iter()
            .map(|&channel| self.sign(channel) * self.slopes[channel])
            .sum();
        let mut stopping = Vec::new();
        for &channel in piece {
            // The group would move downhill: an input on its upper bound prevents a rise, and so
            // does an output on its lower bound.
            let rises = self.sign(channel) * slope < 0.0;
            let at = self.at_bounds[channel];
            if (rises && at.upper) || (!rises && at.lower) {
                stopping.push(channel);
            }
        }
        Push { slope, stopping }
    }
}

/// Derivatives of the minimum objective.
struct Multipliers {
    /// `lambda_e`, in the order of [`ConstrainedMinimum::constrained`].
    entries: Vec<f64>,
    /// `mu_c` by channel, inputs first.
    channels: Vec<f64>,
}

impl Multipliers {
    /// Solves the conditions `dF/dx_c = mu_c + sum lambda_e` for the multipliers.
    ///
    /// The slope that pushes a group of connected channels against a bound is divided equally among
    /// the channels on that bound. The multipliers of the constrained entries balance the
    /// remainder; in a loop, where they are not unique, their sum of squares is minimal.
    fn new(minimum: &ConstrainedMinimum) -> Self {
        let mut channels = vec![0.0; minimum.slopes.len()];
        for piece in minimum.pieces() {
            let push = minimum.push(&piece);
            for &channel in &push.stopping {
                channels[channel] = minimum.sign(channel) * push.slope / push.stopping.len() as f64;
            }
        }
        Self {
            entries: entry_multipliers(minimum, &channels),
            channels,
        }
    }
}

/// Solves for the multipliers `lambda_e` of the constrained entries, given the multipliers `mu_c`
/// of the bounds.
fn entry_multipliers(minimum: &ConstrainedMinimum, bounds: &[f64]) -> Vec<f64> {
    if minimum.constrained.is_empty() {
        return Vec::new();
    }
    let channels = bounds.len();
    let balanced = DVector::from_fn(channels, |channel, _| {
        minimum.slopes[channel] - bounds[channel]
    });
    // Incidence matrix: 1 where an entry contains a channel.
    let ties = DMatrix::from_fn(channels, minimum.constrained.len(), |channel, entry| {
        let pair = minimum.constrained[entry];
        if channel == pair.input || channel == minimum.inputs + pair.output {
            1.0
        } else {
            0.0
        }
    });
    // Tolerance of the singular values: their squares are the Laplacian eigenvalues of a bipartite
    // graph with n channels: 0, or at least 4 / n^2 (Mohar, "Eigenvalues, diameter and mean
    // distance in graphs", 1991). Half of `2 / n`, the lower bound on nonzero singular values,
    // separates them.
    match ties.svd(true, true).solve(&balanced, 1.0 / channels as f64) {
        Ok(multipliers) => multipliers.iter().copied().collect(),
        Err(_) => Vec::new(),
    }
}
