//! Lagrange multipliers for the constrained entries and the active bounds at the minimum.
//!
//! A *constrained entry* is a response for which the sum of its input's and its output's `x` is
//! prescribed. With the objective `F` as a function of the channels `x` (gain logarithms, or
//! delays), the solution satisfies the Karush-Kuhn-Tucker conditions
//!
//! ```text
//! dF/dx_c = mu_c + sum of lambda_e over the constrained entries e of channel c
//! ```
//!
//! The multiplier `lambda_e` is the minimum's derivative with respect to the entry's constrained
//! sum, `mu_c` its derivative with respect to the active bound of channel `c`: at most 0 for an
//! upper bound, at least 0 for a lower bound, and 0 without an active bound.
//!
//! A *piece* is a group of channels that constrained entries connect. Because the sums are fixed,
//! its channels can only move together: if an input's `x` rises, each output's falls by as much,
//! and each other input's rises.

use nalgebra::{DMatrix, DVector};

use gdcm_model::dataset::Pair;

use super::connected_pieces::connected_pieces;
use super::problem::{Entry, Problem};
use super::solution::Solution;

#[derive(Clone, Copy)]
struct AtBounds {
    lower: bool,
    upper: bool,
}

/// How the objective pushes a piece.
pub(super) struct Push {
    /// The objective's slope along the piece's movement, with rising inputs.
    pub(super) slope: f64,
    /// Channels whose active bounds stop the piece from moving downhill.
    pub(super) stopping: Vec<usize>,
}

/// The minimum, with the channels as variables: inputs first, then outputs.
pub(super) struct ConstrainedMinimum {
    pub(super) inputs: usize,
    /// `dF/dx_c` by channel, inputs first.
    slopes: Vec<f64>,
    /// One entry per channel, inputs first.
    at_bounds: Vec<AtBounds>,
    /// Constrained entries; each fixes an input plus an output.
    pub(super) constrained: Vec<Pair>,
}

impl ConstrainedMinimum {
    pub(super) fn new(problem: &Problem, solution: &Solution) -> Self {
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

    /// Finds the pieces.
    pub(super) fn pieces(&self) -> Vec<Vec<usize>> {
        let ties = self
            .constrained
            .iter()
            .map(|pair| [pair.input, self.inputs + pair.output]);
        connected_pieces(self.slopes.len(), ties)
    }

    /// Returns by how much a channel's `x` changes if its piece moves by 1: 1 for an input, -1 for
    /// an output.
    fn sign(&self, channel: usize) -> f64 {
        if channel < self.inputs { 1.0 } else { -1.0 }
    }

    /// Computes the objective's slope along a piece's movement, and the bounds that stop the piece.
    pub(super) fn push(&self, piece: &[usize]) -> Push {
        let slope: f64 = piece
            .iter()
            .map(|&channel| self.sign(channel) * self.slopes[channel])
            .sum();
        let mut stopping = Vec::new();
        for &channel in piece {
            // Downhill, the channel rises or falls; the bound at that end stops the piece.
            let rises = self.sign(channel) * slope < 0.0;
            let at = self.at_bounds[channel];
            if (rises && at.upper) || (!rises && at.lower) {
                stopping.push(channel);
            }
        }
        Push { slope, stopping }
    }
}

/// Derivatives of the minimum objective with respect to the constrained sums and the active bounds.
pub(super) struct Multipliers {
    /// `lambda_e`, in the order of [`ConstrainedMinimum::constrained`].
    pub(super) entries: Vec<f64>,
    /// `mu_c` by channel, inputs first.
    pub(super) channels: Vec<f64>,
}

impl Multipliers {
    /// Solves the conditions `dF/dx_c = mu_c + sum lambda_e` for the multipliers.
    ///
    /// ```text
    /// 1  pieces
    /// 2  for each piece: slope of F along its movement;  mu_c <- the slope, divided equally among
    ///    the channels whose bounds stop the piece;  0 for all others
    /// 3  lambda <- least squares of  dF/dx - mu = (incidence matrix) lambda
    /// ```
    ///
    /// Step 2 is a choice: if several bounds stop a piece, only the sum of their multipliers is
    /// determined. Step 3 is a choice, too, where entries form a loop: there, the multipliers with
    /// the smallest sum of squares are taken.
    pub(super) fn new(minimum: &ConstrainedMinimum) -> Self {
        let mut channels = vec![0.0; minimum.slopes.len()];
        // Steps 1 and 2
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

/// Step 3: solves for the entries' multipliers `lambda_e`, given the bounds' multipliers `mu_c`.
fn entry_multipliers(minimum: &ConstrainedMinimum, bounds: &[f64]) -> Vec<f64> {
    if minimum.constrained.is_empty() {
        return Vec::new();
    }
    let channels = bounds.len();
    let remaining_slopes = DVector::from_fn(channels, |channel, _| {
        minimum.slopes[channel] - bounds[channel]
    });
    // Channels x entries: 1 where an entry contains a channel.
    let incidence = DMatrix::from_fn(channels, minimum.constrained.len(), |channel, entry| {
        let pair = minimum.constrained[entry];
        if channel == pair.input || channel == minimum.inputs + pair.output {
            1.0
        } else {
            0.0
        }
    });
    // Tolerance for the singular values: their squares are a bipartite graph's Laplacian
    // eigenvalues; with n channels these are 0, or at least 4 / n^2 (Mohar, "Eigenvalues, diameter
    // and mean distance in graphs", 1991). Half of `2 / n`, the lower bound on nonzero singular
    // values, separates them.
    match incidence
        .svd(true, true)
        .solve(&remaining_slopes, 1.0 / channels as f64)
    {
        Ok(multipliers) => multipliers.iter().copied().collect(),
        Err(_) => Vec::new(),
    }
}

/// Computes `dF/dx_c`, the objective's slope in each gain logarithm, or in each delay; inputs
/// first.
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
