//! The solution of equation (11).

use super::conflict::DelayConflict;
use super::problem::{DelayError, DelayProblem};
use super::program::solve_program;
use super::remedy::DelayRemedy;
use super::solution::{DelaySolution, UnmatchedDelay};
use crate::correction::components::{Components, Placement};
use crate::correction::conflict::clashes;
use crate::correction::reach::{Held, Reached, reach};
use crate::correction::remedy::remedy;
use crate::correction::scales::{Entry, Landscape, parabolas, settle};
use crate::dataset::{Pair, PairTable};

/// Residual, as a fraction of the greatest delay in the problem, below which a held entry counts as matched.
const MATCHED: f64 = 1e-8;

/// Finds the channel delays of least objective (equation (11), M9), in seconds.
///
/// Entries that non-negative, bounded delays cannot give are held at the nearest sums that are possible, and reported.
///
/// # Errors
/// [`DelayError`] where the problem is not well posed ([`DelayProblem::check`]) or the quadratic program is not solved.
pub fn solve_delays(problem: &DelayProblem) -> Result<DelaySolution, DelayError> {
    problem.check()?;
    // The problem is homogeneous: in units of its greatest time every figure is of order 1.
    let unit_s = unit(problem);
    // No path of held entries asks a channel for more than one unit each: a bound above that never acts.
    let most = (problem.wanted_s.outputs() + problem.wanted_s.inputs()) as f64;
    let held = Held {
        outputs: problem.wanted_s.outputs(),
        inputs: problem.wanted_s.inputs(),
        entries: problem.held_entries().map(|(pair, wanted)| (pair, wanted / unit_s)).collect(),
        range: (0.0, (problem.upper_s / unit_s).min(most)),
    };
    let reached = reach(&held, solve_program)?;
    let landscape = landscape(problem, &reached.components, unit_s);
    let mut scales = solve_program(&landscape)?;
    settle_delays(&reached.components, &landscape, &mut scales);
    let (inputs_s, outputs_s) = delays_at(problem, &reached.components, &scales, unit_s);
    let (unmatched, conflicts) = misses(problem, &held, &reached, unit_s);
    let mut targets_s = PairTable::filled(held.outputs, held.inputs, None);
    for (pair, target) in &reached.targets {
        targets_s[*pair] = Some(target * unit_s);
    }
    Ok(DelaySolution {
        objective: problem.objective_at(&inputs_s, &outputs_s),
        inputs_s,
        outputs_s,
        targets_s,
        matched: unmatched.is_empty(),
        remedy: remedy_of(problem, &held, &conflicts, unit_s),
        unmatched,
        conflicts,
    })
}

/// The greatest time of the problem, or one second where every time is 0.
fn unit(problem: &DelayProblem) -> f64 {
    let wanted =
        problem.wanted_s.iter().filter_map(|(_, delay)| *delay).fold(0.0_f64, |most, delay| most.max(delay.abs()));
    // A bound far above what any channel could be asked for says nothing about the size of the answer.
    let unit = if wanted > 0.0 { wanted } else { problem.upper_s };
    if unit > 0.0 { unit } else { 1.0 }
}

fn landscape(problem: &DelayProblem, components: &Components, unit_s: f64) -> Landscape {
    let ground = components.count();
    let fit = problem.fit_entries().map(|(pair, wanted)| {
        let (output, input) = (components.outputs[pair.output], components.inputs[pair.input]);
        let (wanted, offset) = (wanted / unit_s, output.offset + input.offset);
        Entry { output: output.component, input: input.component, share: 1.0, wanted, offset }
    });
    let departure = components.outputs.iter().filter(|_| problem.alpha > 0.0).map(|output| Entry {
        output: output.component,
        input: ground,
        share: problem.alpha,
        wanted: 0.0,
        offset: output.offset,
    });
    let (links, constant) = parabolas(&fit.chain(departure).collect::<Vec<_>>(), ground + 1);
    let (mut lower, mut upper) = (components.lower.clone(), components.upper.clone());
    lower.push(0.0);
    upper.push(0.0);
    Landscape { lower, upper, links, constant }
}

/// The limit `alpha -> 0+`: a free common shift goes where the output delays are least (inputs, where there is no output).
fn settle_delays(components: &Components, landscape: &Landscape, scales: &mut [f64]) {
    settle(landscape, scales, |nodes, scales| {
        let (inputs, outputs) = components.channels(scales);
        let mean = |channels: &[Placement], values: &[f64]| {
            let inside = channels.iter().zip(values).filter(|(channel, _)| nodes.contains(&channel.component));
            let (sum, count) = inside.fold((0.0, 0.0), |(sum, count), (_, value)| (sum + value, count + 1.0));
            if count > 0.0 { Some(sum / count) } else { None }
        };
        match (mean(&components.outputs, &outputs), mean(&components.inputs, &inputs)) {
            (Some(outputs), _) => outputs,
            (None, Some(inputs)) => -inputs,
            (None, None) => 0.0,
        }
    });
}

/// Delays of the inputs and of the outputs in seconds, exactly on the bounds they reach.
fn delays_at(problem: &DelayProblem, components: &Components, scales: &[f64], unit_s: f64) -> (Vec<f64>, Vec<f64>) {
    let upper = problem.upper_s / unit_s;
    let delay = |value: &f64| {
        // A few roundings of figures of order 1 (or of the bound, where that is greater).
        let rounding = 16.0 * f64::EPSILON * (1.0 + upper);
        if *value <= rounding {
            0.0
        } else if (value - upper).abs() <= rounding {
            problem.upper_s
        } else {
            (value * unit_s).min(problem.upper_s)
        }
    };
    let (inputs, outputs) = components.channels(scales);
    (inputs.iter().map(delay).collect(), outputs.iter().map(delay).collect())
}

/// The held entries that stage 1 could not match, and the distinct conflicts behind them.
fn misses(
    problem: &DelayProblem,
    held: &Held,
    reached: &Reached,
    unit_s: f64,
) -> (Vec<UnmatchedDelay>, Vec<DelayConflict>) {
    let clashes = clashes(held, reached, MATCHED);
    let why = |pair: Pair| match clashes.iter().find(|(missed, _)| *missed == pair) {
        Some((_, clash)) => DelayConflict::new(clash.clone(), unit_s, problem.upper_s),
        None => DelayConflict::Unclear { entries: held.entries.iter().map(|(pair, _)| *pair).collect() },
    };
    let mut unmatched = Vec::new();
    for ((pair, wanted), (_, target)) in held.entries.iter().zip(&reached.targets) {
        if (target - wanted).abs() > MATCHED {
            let (wanted_s, target_s) = (wanted * unit_s, target * unit_s);
            unmatched.push(UnmatchedDelay { pair: *pair, wanted_s, target_s, why: why(*pair) });
        }
    }
    let mut conflicts: Vec<DelayConflict> = Vec::new();
    for miss in &unmatched {
        let same = |known: &DelayConflict| {
            known.entries().len() == miss.why.entries().len()
                && known.entries().iter().all(|pair| miss.why.entries().contains(pair))
        };
        if !conflicts.iter().any(same) {
            conflicts.push(miss.why.clone());
        }
    }
    conflicts.sort_by_key(|conflict| (!matches!(conflict, DelayConflict::Loop { .. }), conflict.entries().len()));
    (unmatched, conflicts)
}

/// What would let everything be held, where something cannot.
fn remedy_of(problem: &DelayProblem, held: &Held, conflicts: &[DelayConflict], unit_s: f64) -> Option<DelayRemedy> {
    let mut suspects: Vec<Pair> = conflicts.iter().flat_map(|conflict| conflict.entries().iter().copied()).collect();
    suspects.sort();
    suspects.dedup();
    (!suspects.is_empty()).then(|| DelayRemedy::new(remedy(held, &suspects), unit_s, problem.upper_s))
}
