//! What each held delay and each active bound costs at the answer.

use super::problem::DelayProblem;
use super::solution::DelaySolution;
use crate::correction::channel::{Channel, pair_name};
use crate::correction::multipliers::{Restrained, multipliers};
use crate::dataset::Pair;

/// Something that keeps the delays from a lower objective.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum DelayRestraint {
    /// An entry held at its target.
    Held(Pair),
    /// A channel delay that would have to be negative.
    Zero(Channel),
    /// A channel delay on its upper bound.
    UpperBound(Channel),
}

/// The multiplier of one restraint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DelaySensitivity {
    /// The restraint.
    pub restraint: DelayRestraint,
    /// Change of the least objective (s²) for each ms by which the held sum, or the bound, is raised (to first order).
    pub per_ms: f64,
    /// The same as a share of the objective; 0 where the objective is 0.
    pub share_per_ms: f64,
}

impl DelaySensitivity {
    /// The sensitivity in words.
    pub fn words(&self, inputs: &[String], outputs: &[String]) -> String {
        let percent = 100.0 * self.share_per_ms.abs();
        let effect = format!("would lower the objective by about {percent:.2} %");
        match self.restraint {
            DelayRestraint::Held(pair) => {
                let change = if self.per_ms > 0.0 { "less" } else { "more" };
                format!("{} is held: 1 ms {change} delay {effect}.", pair_name(pair, inputs, outputs))
            }
            DelayRestraint::Zero(channel) => {
                format!("tau_{} is 0: 1 ms of lead {effect}.", channel.name(inputs, outputs))
            }
            DelayRestraint::UpperBound(channel) => {
                format!(
                    "tau_{} is on its upper bound: raising the bound by 1 ms {effect}.",
                    channel.name(inputs, outputs)
                )
            }
        }
    }
}

/// The sensitivity of every held entry and of every bound that acts, the most expensive first.
///
/// `solution` is the solution of `problem` ([`super::solve_delays`]).
pub fn delay_sensitivities(problem: &DelayProblem, solution: &DelaySolution) -> Vec<DelaySensitivity> {
    let held: Vec<Pair> = problem.held_entries().map(|(pair, _)| pair).collect();
    let inputs = solution.inputs_s.len();
    let mut slopes = vec![0.0; inputs + solution.outputs_s.len()];
    for (pair, wanted) in problem.fit_entries() {
        let slope = 2.0 * (solution.inputs_s[pair.input] + solution.outputs_s[pair.output] - wanted);
        slopes[pair.input] += slope;
        slopes[inputs + pair.output] += slope;
    }
    for (output, delay) in solution.outputs_s.iter().enumerate() {
        slopes[inputs + output] += 2.0 * problem.alpha * delay;
    }
    let on = |delay: &f64| (*delay == 0.0, *delay == problem.upper_s);
    let at_bounds = solution.inputs_s.iter().chain(&solution.outputs_s).map(on).collect();
    let found = multipliers(&Restrained { inputs, slopes, at_bounds, held: &held });
    let sensitivity = |restraint: DelayRestraint, slope: f64| {
        let per_ms = 1e-3 * slope;
        let share_per_ms = if solution.objective > 0.0 { per_ms / solution.objective } else { 0.0 };
        DelaySensitivity { restraint, per_ms, share_per_ms }
    };
    let of_held = held.iter().zip(&found.held).map(|(pair, slope)| sensitivity(DelayRestraint::Held(*pair), *slope));
    let of_bounds = found.bounds.iter().enumerate().filter(|(_, slope)| **slope != 0.0).map(|(index, slope)| {
        let channel = if index < inputs { Channel::Input(index) } else { Channel::Output(index - inputs) };
        sensitivity(
            if *slope < 0.0 { DelayRestraint::UpperBound(channel) } else { DelayRestraint::Zero(channel) },
            *slope,
        )
    });
    let mut all: Vec<DelaySensitivity> = of_held.chain(of_bounds).collect();
    all.sort_by(|a, b| b.per_ms.abs().total_cmp(&a.per_ms.abs()));
    all
}
