//! What each held gain and each active bound costs at the answer.

use super::conflict::DECIBEL;
use super::landscape::SQUARED_DECIBEL;
use super::problem::{GainObjective, GainProblem};
use super::solution::GainSolution;
use crate::correction::channel::{Channel, pair_name};
use crate::correction::multipliers::{Restrained, multipliers};
use crate::dataset::Pair;

/// Something that keeps the gains from a lower objective.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum GainRestraint {
    /// An entry held at its target.
    Held(Pair),
    /// A channel gain on its lower bound.
    LowerBound(Channel),
    /// A channel gain on its upper bound.
    UpperBound(Channel),
}

/// The multiplier of one restraint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GainSensitivity {
    /// The restraint.
    pub restraint: GainRestraint,
    /// Change of the least objective for each dB by which the held product, or the bound, is raised (to first order).
    pub per_db: f64,
    /// The same as a share of the objective; 0 where the objective is 0.
    pub share_per_db: f64,
}

impl GainSensitivity {
    /// The sensitivity in words.
    pub fn words(&self, inputs: &[String], outputs: &[String]) -> String {
        let change = if self.per_db > 0.0 { "lowering" } else { "raising" };
        let percent = 100.0 * self.share_per_db.abs();
        let effect = format!("by 1 dB would lower the objective by about {percent:.2} %");
        match self.restraint {
            GainRestraint::Held(pair) => {
                format!("{} is held: {change} its gain {effect}.", pair_name(pair, inputs, outputs))
            }
            GainRestraint::LowerBound(channel) => {
                format!("k_{} is on its lower bound: {change} the bound {effect}.", channel.name(inputs, outputs))
            }
            GainRestraint::UpperBound(channel) => {
                format!("k_{} is on its upper bound: {change} the bound {effect}.", channel.name(inputs, outputs))
            }
        }
    }
}

/// The sensitivity of every held entry and of every bound that acts, the most expensive first.
///
/// `solution` is the solution of `problem` ([`super::solve_gains`]).
pub fn gain_sensitivities(problem: &GainProblem, solution: &GainSolution) -> Vec<GainSensitivity> {
    let held: Vec<Pair> = problem.held_entries().map(|(pair, _)| pair).collect();
    let on = |gain: &f64| (*gain == problem.bounds.lower, *gain == problem.bounds.upper);
    let minimum = Restrained {
        inputs: solution.inputs.len(),
        slopes: slopes(problem, solution),
        at_bounds: solution.inputs.iter().chain(&solution.outputs).map(on).collect(),
        held: &held,
    };
    let found = multipliers(&minimum);
    let sensitivity = |restraint: GainRestraint, slope: f64| {
        let per_db = slope / DECIBEL;
        let share_per_db = if solution.objective > 0.0 { per_db / solution.objective } else { 0.0 };
        GainSensitivity { restraint, per_db, share_per_db }
    };
    let of_held = held.iter().zip(&found.held).map(|(pair, slope)| sensitivity(GainRestraint::Held(*pair), *slope));
    let of_bounds = found.bounds.iter().enumerate().filter(|(_, slope)| **slope != 0.0).map(|(index, slope)| {
        let inputs = minimum.inputs;
        let channel = if index < inputs { Channel::Input(index) } else { Channel::Output(index - inputs) };
        // The objective falls as the upper bound is raised, or the lower one lowered.
        let upper = *slope < 0.0;
        sensitivity(if upper { GainRestraint::UpperBound(channel) } else { GainRestraint::LowerBound(channel) }, *slope)
    });
    let mut all: Vec<GainSensitivity> = of_held.chain(of_bounds).collect();
    all.sort_by(|a, b| b.per_db.abs().total_cmp(&a.per_db.abs()));
    all
}

/// Slope of the objective in the logarithm of each channel gain, inputs first.
fn slopes(problem: &GainProblem, solution: &GainSolution) -> Vec<f64> {
    let inputs = solution.inputs.len();
    let slope = |wanted: f64, gain: f64| match problem.objective {
        GainObjective::Ratio => 2.0 * gain * (gain - wanted),
        GainObjective::Decibel => 2.0 * SQUARED_DECIBEL * (gain / wanted).ln(),
    };
    let mut slopes = vec![0.0; inputs + solution.outputs.len()];
    for (pair, wanted) in problem.fit_entries() {
        let of_entry = slope(wanted, solution.inputs[pair.input] * solution.outputs[pair.output]);
        slopes[pair.input] += of_entry;
        slopes[inputs + pair.output] += of_entry;
    }
    for (output, gain) in solution.outputs.iter().enumerate() {
        slopes[inputs + output] += problem.alpha * slope(1.0, *gain);
    }
    slopes
}
