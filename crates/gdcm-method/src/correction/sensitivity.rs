//! Cost of each constrained entry and each active bound at the solution: its multiplier, and the
//! change of the objective if an entry is constrained or released.

use nalgebra::{DMatrix, DVector};

use gdcm_model::dataset::Pair;
use gdcm_model::units::number;

use super::branch_and_bound::search::ProofBudget;
use super::channels::{Channel, pair_name};
use super::connected_pieces::connected_pieces;
use super::problem::{Entry, Problem, ProblemError};
use super::quantity::Quantity;
use super::solution::{Outcome, Solution};
use super::solve::solve;

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
    pub restraint: ActiveConstraint,
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

    /// Describes the sensitivity: the constraint, and the change that would lower the objective by
    /// how much.
    pub fn words(&self, inputs: &[String], outputs: &[String]) -> String {
        let name = match self.restraint {
            ActiveConstraint::Held(pair) => pair_name(pair, inputs, outputs),
            ActiveConstraint::LowerBound(channel) | ActiveConstraint::UpperBound(channel) => {
                let symbol = if self.quantity.is_gain() { "k" } else { "τ" };
                format!("{symbol}_{}", channel.name(inputs, outputs))
            }
        };
        let step = self.step();
        // `min(100.0)`: an objective close to zero would become negative even for the minimum step.
        let percent = (100.0 * step * self.share_per_unit.abs()).min(100.0);
        let change = if self.quantity.is_gain() {
            self.gain_change_words(&number(step))
        } else {
            self.delay_change_words(&number(step))
        };
        format!("{name} is {change} would lower the objective by about {percent:.2} %.")
    }

    /// Describes the constraint on a gain, and the change by `step` dB that lowers the objective.
    fn gain_change_words(&self, step: &str) -> String {
        let change = if self.per_unit > 0.0 {
            "lowering"
        } else {
            "raising"
        };
        match self.restraint {
            ActiveConstraint::Held(_) => format!("held: {change} its gain by {step} dB"),
            ActiveConstraint::LowerBound(_) => {
                format!("on its lower bound: {change} the bound by {step} dB")
            }
            ActiveConstraint::UpperBound(_) => {
                format!("on its upper bound: {change} the bound by {step} dB")
            }
        }
    }

    /// Describes the constraint on a delay, and the change by `step` ms that lowers the objective.
    fn delay_change_words(&self, step: &str) -> String {
        match self.restraint {
            ActiveConstraint::Held(_) if self.per_unit > 0.0 => {
                format!("held: {step} ms less delay")
            }
            ActiveConstraint::Held(_) => format!("held: {step} ms more delay"),
            ActiveConstraint::LowerBound(_) if self.quantity == Quantity::Delay => {
                format!("0: {step} ms of lead")
            }
            ActiveConstraint::LowerBound(_) => format!("at its maximum lead: {step} ms more"),
            ActiveConstraint::UpperBound(_) => {
                format!("on its upper bound: raising the bound by {step} ms")
            }
        }
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
    for (pair, &slope) in minimum.held.iter().zip(&multipliers.entries) {
        let held = ActiveConstraint::Held(*pair);
        sensitivities.push(sensitivity(problem, solution, held, slope));
    }
    let channels = Channel::all(minimum.inputs, solution.outputs.len());
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
    restraint: ActiveConstraint,
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
        restraint,
        per_unit,
        share_per_unit,
    }
}

/// Computes the slope of the objective in the logarithm of each gain, or in each delay; inputs
/// first.
fn slopes(problem: &Problem, solution: &Solution) -> Vec<f64> {
    let quantity = problem.quantity;
    let inputs = solution.inputs.len();
    let mut slopes = vec![0.0; inputs + solution.outputs.len()];
    for Entry { pair, delta } in problem.fit_entries() {
        let slope = quantity.slope(
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
        *slope += problem.alpha * quantity.slope(neutral, *value, neutral);
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
    at_bounds: Vec<AtBounds>,
    /// Constrained entries; each fixes the sum of an input and an output.
    held: Vec<Pair>,
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
        let held = problem
            .constrained_entries()
            .map(|entry| entry.pair)
            .collect();
        Self {
            inputs: solution.inputs.len(),
            slopes: slopes(problem, solution),
            at_bounds,
            held,
        }
    }

    /// Groups the channels that are connected by constrained entries.
    fn pieces(&self) -> Vec<Vec<usize>> {
        let ties = self
            .held
            .iter()
            .map(|pair| [pair.input, self.inputs + pair.output]);
        connected_pieces(self.slopes.len(), ties)
    }

    /// Returns 1 for an input and -1 for an output: an output decreases when the inputs connected
    /// with it increase.
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

/// Derivatives of the minimum objective with respect to the target of each constrained entry, and
/// to the active bound of each channel (0 if none is active).
struct Multipliers {
    entries: Vec<f64>,
    /// By channel, inputs first.
    channels: Vec<f64>,
}

impl Multipliers {
    /// Solves `slopes + sum(multipliers) = 0`.
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

/// Solves for the multipliers of the constrained entries, given the multipliers of the bounds.
fn entry_multipliers(minimum: &ConstrainedMinimum, bounds: &[f64]) -> Vec<f64> {
    if minimum.held.is_empty() {
        return Vec::new();
    }
    let channels = bounds.len();
    let left = DVector::from_fn(channels, |channel, _| {
        minimum.slopes[channel] - bounds[channel]
    });
    let ties = DMatrix::from_fn(channels, minimum.held.len(), |channel, entry| {
        let pair = minimum.held[entry];
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
    match ties.svd(true, true).solve(&left, 1.0 / channels as f64) {
        Ok(multipliers) => multipliers.iter().copied().collect(),
        Err(_) => Vec::new(),
    }
}

/// Effect on the solution if one entry is toggled: a free entry constrained, or a constrained entry
/// released.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Toggle {
    pub pair: Pair,
    /// Whether the entry is constrained before the toggle.
    pub held_now: bool,
    /// Minimum objective before the toggle.
    pub before: f64,
    /// Minimum objective after the toggle.
    pub after: f64,
    /// Number of infeasible constrained entries after the toggle.
    pub unmatched_after: usize,
    /// Whether the toggled entry itself is feasible, if it is now constrained.
    pub matched_after: bool,
    /// Whether the objective after the toggle is proven.
    pub outcome: Outcome,
}

impl Toggle {
    /// Returns the change of the objective as a share of its value before the toggle; infinite if
    /// that value is 0 and the objective changes.
    pub fn share(&self) -> f64 {
        let change = self.after - self.before;
        if change == 0.0 {
            0.0
        } else {
            change / self.before
        }
    }

    /// Describes the cost of constraining the entry: the present cost if it is constrained,
    /// otherwise the cost that would result.
    pub fn words(&self, inputs: &[String], outputs: &[String]) -> String {
        let pair = pair_name(self.pair, inputs, outputs);
        // `+ 0.0`: no change would otherwise be formatted as -0.0.
        let percent = 100.0 * self.share() + 0.0;
        if self.held_now {
            if self.after <= self.before {
                let saved = 0.0 - percent;
                format!("holding {pair} costs {saved:.1} % of the objective")
            } else {
                format!(
                    "releasing {pair} would raise the objective by {percent:.1} %, because other \
                    responses could then be held more closely"
                )
            }
        } else if self.matched_after {
            format!("holding {pair} would change the objective by {percent:+.1} %")
        } else {
            format!(
                "{pair} cannot be held in addition to the held responses; the attempt would \
                change the objective by {percent:+.1} %"
            )
        }
    }
}

/// Solves `problem` with each entry that has a delta toggled in turn, row by row, until `stop`
/// returns true.
///
/// This is meant to run in the background while `solution` is displayed. If it is stopped, the list
/// is shorter than the number of entries.
///
/// # Errors
/// [`ProblemError`], as in [`solve`].
pub fn toggles(
    problem: &Problem,
    solution: &Solution,
    budget: ProofBudget,
    stop: &dyn Fn() -> bool,
) -> Result<Vec<Toggle>, ProblemError> {
    let mut toggles = Vec::new();
    let mut toggled = problem.clone();
    for (pair, delta) in problem.delta.iter() {
        if delta.is_none() {
            continue;
        }
        let held_now = problem.constrained[pair];
        toggled.constrained[pair] = !held_now;
        let after = match solve(&toggled, budget, stop) {
            Err(ProblemError::Stopped) => break,
            after => after?,
        };
        toggled.constrained[pair] = held_now;
        toggles.push(Toggle {
            pair,
            held_now,
            before: solution.objective,
            after: after.objective,
            unmatched_after: after.unmatched.len(),
            matched_after: after.unmatched.iter().all(|miss| miss.pair != pair),
            outcome: after.proof.outcome,
        });
    }
    Ok(toggles)
}
