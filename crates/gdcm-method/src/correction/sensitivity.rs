//! Cost of each constrained entry and each active bound at the solution: its multiplier, and the
//! change from constraining or releasing it.

use nalgebra::{DMatrix, DVector};

use gdcm_model::dataset::Pair;
use gdcm_model::units::number;

use super::channels::{Channel, pair_name};
use super::problem::{Problem, ProblemError, Quantity};
use super::solve::{Outcome, Solution, solve};
use crate::correction::branch_and_bound::objective::pieces;
use crate::correction::branch_and_bound::search::ProofBudget;

/// A constraint that keeps the channels from a lower objective.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ActiveConstraint {
    /// An entry constrained to its target.
    Held(Pair),
    /// A channel on its lower bound; a delay that would have to be negative.
    LowerBound(Channel),
    UpperBound(Channel),
}

/// Multiplier of one active constraint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sensitivity {
    pub quantity: Quantity,
    pub restraint: ActiveConstraint,
    /// Change of the least objective for each dB or ms by which the constrained value or the bound
    /// is raised (to first order).
    pub per_unit: f64,
    /// `per_unit` as a share of the objective; 0 where the objective is 0.
    pub share_per_unit: f64,
}

impl Sensitivity {
    /// Step used in the description \[dB or ms\]: 1, or a tenth, a hundredth, … of it, so that the
    /// slope is extrapolated to less than half of the objective, which cannot fall by more than all
    /// of it.
    pub fn step(&self) -> f64 {
        const MOST_SHARE: f64 = 0.5;
        /// The least step is a nanosecond or a millionth of a decibel.
        const MOST_POWERS: i32 = 6;
        let share = self.share_per_unit.abs();
        let power = (0..MOST_POWERS).find(|&power| share * 10_f64.powi(-power) <= MOST_SHARE);
        10_f64.powi(-power.unwrap_or(MOST_POWERS))
    }

    /// Describes the sensitivity.
    pub fn words(&self, inputs: &[String], outputs: &[String]) -> String {
        let step = self.step();
        // An objective close to zero is used up before the least step ends.
        let percent = (100.0 * step * self.share_per_unit.abs()).min(100.0);
        let step = number(step);
        let gain = self.quantity.is_gain();
        let is_dear = self.per_unit > 0.0;
        let name = match self.restraint {
            ActiveConstraint::Held(pair) => pair_name(pair, inputs, outputs),
            ActiveConstraint::LowerBound(channel) | ActiveConstraint::UpperBound(channel) => {
                format!(
                    "{}_{}",
                    if gain { "k" } else { "τ" },
                    channel.name(inputs, outputs)
                )
            }
        };
        let change = if is_dear { "lowering" } else { "raising" };
        let way = match (self.quantity, self.restraint) {
            (Quantity::Gain(_), ActiveConstraint::Held(_)) => {
                format!("held: {change} its gain by {step} dB")
            }
            (Quantity::Gain(_), bound) => {
                let end = if matches!(bound, ActiveConstraint::LowerBound(_)) {
                    "lower"
                } else {
                    "upper"
                };
                format!("on its {end} bound: {change} the bound by {step} dB")
            }
            (_, ActiveConstraint::Held(_)) => {
                format!(
                    "held: {step} ms {} delay",
                    if is_dear { "less" } else { "more" }
                )
            }
            (Quantity::Delay, ActiveConstraint::LowerBound(_)) => format!("0: {step} ms of lead"),
            (_, ActiveConstraint::LowerBound(_)) => {
                format!("at its most lead: {step} ms more of it")
            }
            (_, ActiveConstraint::UpperBound(_)) => {
                format!("on its upper bound: raising the bound by {step} ms")
            }
        };
        format!("{name} is {way} would lower the objective by about {percent:.2} %.")
    }
}

/// Computes the sensitivity of every constrained entry and of every active bound, the most
/// expensive first.
///
/// `solution` is the solution of `problem` ([`super::solve`]).
pub fn sensitivities(problem: &Problem, solution: &Solution) -> Vec<Sensitivity> {
    let minimum = Restrained::of(problem, solution);
    let (of_entries, of_channels) = multipliers(&minimum);
    let sensitivity = |restraint: ActiveConstraint, slope: f64| {
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
    };
    let of_held = minimum
        .held
        .iter()
        .zip(&of_entries)
        .map(|(pair, slope)| sensitivity(ActiveConstraint::Held(*pair), *slope));
    let channels = Channel::all(minimum.inputs, solution.outputs.len()).zip(of_channels);
    let of_bounds = channels
        .filter(|(_, slope)| *slope != 0.0)
        .map(|(channel, slope)| {
            // The objective falls as the upper bound is raised, or the lower bound lowered.
            let bound = if slope < 0.0 {
                ActiveConstraint::UpperBound
            } else {
                ActiveConstraint::LowerBound
            };
            sensitivity(bound(channel), slope)
        });
    let mut all: Vec<Sensitivity> = of_held.chain(of_bounds).collect();
    all.sort_by(|a, b| b.per_unit.abs().total_cmp(&a.per_unit.abs()));
    all
}

/// Slope of the objective in the logarithm of each channel gain, or in each delay; inputs first.
fn slopes(problem: &Problem, solution: &Solution) -> Vec<f64> {
    let quantity = problem.quantity;
    let inputs = solution.inputs.len();
    let mut slopes = vec![0.0; inputs + solution.outputs.len()];
    for (pair, delta) in problem.fit_entries() {
        let slope = quantity.slope(
            delta,
            solution.outputs[pair.output],
            solution.inputs[pair.input],
        );
        slopes[pair.input] += slope;
        slopes[inputs + pair.output] += slope;
    }
    let neutral = quantity.neutral();
    let first = if quantity.regularises_inputs() {
        0
    } else {
        inputs
    };
    let values = solution.inputs.iter().chain(&solution.outputs);
    for (slope, value) in slopes.iter_mut().zip(values).skip(first) {
        *slope += problem.alpha * quantity.slope(neutral, *value, neutral);
    }
    slopes
}

/// Karush-Kuhn-Tucker residual of a solution: the greatest slope of the objective along which
/// channels could still move together, inside the bounds and with the entries constrained. For a
/// convex problem zero is a proof.
///
/// In the objective's unit per unit of the channels: for delays s² / s. `solution` is the solution
/// of `problem` ([`super::solve`]).
pub fn kkt_residual(problem: &Problem, solution: &Solution) -> f64 {
    let minimum = Restrained::of(problem, solution);
    let pushes = minimum
        .pieces()
        .into_iter()
        .map(|piece| minimum.push(&piece));
    pushes
        .filter(|(_, stopping)| stopping.is_empty())
        .fold(0.0, |most, (push, _)| most.max(push.abs()))
}

/// A minimum as a function of its channels: inputs first, then outputs.
struct Restrained {
    inputs: usize,
    /// Slope of the objective in each channel's value.
    slopes: Vec<f64>,
    /// Whether each channel is on its lower and on its upper bound.
    at_bounds: Vec<(bool, bool)>,
    /// The constrained entries: sums of an input's and an output's value.
    held: Vec<Pair>,
}

impl Restrained {
    fn of(problem: &Problem, solution: &Solution) -> Self {
        let on = |value: &f64| {
            (
                *value == problem.bounds.lower,
                *value == problem.bounds.upper,
            )
        };
        let at_bounds = solution
            .inputs
            .iter()
            .chain(&solution.outputs)
            .map(on)
            .collect();
        let held = problem.held_entries().map(|(pair, _)| pair).collect();
        Self {
            inputs: solution.inputs.len(),
            slopes: slopes(problem, solution),
            at_bounds,
            held,
        }
    }

    /// Groups of channels tied together by constrained entries.
    fn pieces(&self) -> Vec<Vec<usize>> {
        pieces(
            self.slopes.len(),
            self.held
                .iter()
                .map(|pair| (pair.input, self.inputs + pair.output)),
        )
    }

    /// 1 for an input, -1 for an output: an output falls where the inputs tied to it rise.
    fn sign(&self, channel: usize) -> f64 {
        if channel < self.inputs { 1.0 } else { -1.0 }
    }

    /// Slope of the objective along the common movement of a piece of tied channels, and the
    /// channels whose bounds stop it.
    fn push(&self, piece: &[usize]) -> (f64, Vec<usize>) {
        let push: f64 = piece
            .iter()
            .map(|&channel| self.sign(channel) * self.slopes[channel])
            .sum();
        // The piece would move against the slope: an input on its upper bound stops a rise, and so
        // does an output on its lower bound.
        let stops = |channel: &&usize| {
            let rises = self.sign(**channel) * push < 0.0;
            if rises {
                self.at_bounds[**channel].1
            } else {
                self.at_bounds[**channel].0
            }
        };
        (push, piece.iter().filter(stops).copied().collect())
    }
}

/// Solves `slopes + sum of multipliers = 0`: the slope that pushes a piece of tied channels against
/// a bound is divided equally among the channels on that bound; the constrained entries carry the
/// rest, in a loop with the least squares.
///
/// The multipliers are the derivatives of the least objective with respect to the target of each
/// constrained entry and to the active bound of each channel (0 where none is active).
fn multipliers(minimum: &Restrained) -> (Vec<f64>, Vec<f64>) {
    let channels = minimum.slopes.len();
    let mut bounds = vec![0.0; channels];
    for piece in minimum.pieces() {
        let (push, stopping) = minimum.push(&piece);
        for &channel in &stopping {
            bounds[channel] = minimum.sign(channel) * push / stopping.len() as f64;
        }
    }
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
    let held = if minimum.held.is_empty() {
        Vec::new()
    } else {
        // The squared singular values are the Laplacian's of a bipartite graph of n channels: 0, or
        // at least 4 / n^2 (Mohar, "Eigenvalues, diameter and mean distance in graphs", 1991). The
        // tolerance is half of that root.
        let solved = ties.svd(true, true).solve(&left, 1.0 / channels as f64);
        solved
            .map(|held| held.iter().copied().collect())
            .unwrap_or_default()
    };
    (held, bounds)
}

/// The solution with one free entry constrained, or one constrained entry released.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Toggle {
    pub pair: Pair,
    /// Whether it is constrained now.
    pub held_now: bool,
    /// Least objective without the toggle.
    pub before: f64,
    /// Least objective with the toggle.
    pub after: f64,
    /// Number of constrained entries that are infeasible with the toggle.
    pub unmatched_after: usize,
    /// Whether the entry itself is feasible, if the toggle constrains it.
    pub matched_after: bool,
    /// Whether the objective after the toggle is proven.
    pub outcome: Outcome,
}

impl Toggle {
    /// Change of the objective as a share of the present objective; infinite where that is 0 and
    /// something changes.
    pub fn share(&self) -> f64 {
        let change = self.after - self.before;
        if change == 0.0 {
            0.0
        } else {
            change / self.before
        }
    }

    /// Describes the cost: a constrained entry has a cost, a free entry would have it.
    pub fn words(&self, inputs: &[String], outputs: &[String]) -> String {
        let pair = pair_name(self.pair, inputs, outputs);
        // Without the added zero, no change would read -0.0.
        let percent = 100.0 * self.share() + 0.0;
        match (self.held_now, self.matched_after) {
            (true, _) if self.after <= self.before => {
                format!(
                    "holding {pair} costs {:.1} % of the objective",
                    0.0 - percent
                )
            }
            (true, _) => {
                format!(
                    "freeing {pair} would raise the objective by {percent:.1} %: others are then held better"
                )
            }
            (false, true) => {
                format!("holding {pair} would change the objective by {percent:+.1} %")
            }
            (false, false) => {
                format!(
                    "{pair} cannot be held besides what is held; trying changes the objective by {percent:+.1} %"
                )
            }
        }
    }
}

/// Solves `problem` with every entry that has a delta toggled in turn, row by row, until `stop`
/// returns true.
///
/// The result is the table for the matrix of entries, to be computed in the background of the live
/// solution `solution`. A list shorter than the entries means that it was stopped.
///
/// # Errors
/// See [`solve`].
pub fn toggles(
    problem: &Problem,
    solution: &Solution,
    budget: ProofBudget,
    stop: &dyn Fn() -> bool,
) -> Result<Vec<Toggle>, ProblemError> {
    let mut toggles = Vec::new();
    let mut toggled = problem.clone();
    for (pair, _) in problem.delta.iter().filter(|(_, delta)| delta.is_some()) {
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
