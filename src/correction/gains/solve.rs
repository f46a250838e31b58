//! The solution of equation (7).

use std::convert::Infallible;

use super::conflict::{DECIBEL, GainConflict};
use super::landscape::{SQUARED_DECIBEL, landscape};
use super::problem::{GainError, GainObjective, GainProblem};
use super::remedy::GainRemedy;
use super::solution::{GainSolution, LocalMinimum, Outcome, ProofBudget, UnmatchedGain};
use crate::correction::components::Components;
use crate::correction::conflict::clashes;
use crate::correction::reach::{Held, Reached, reach};
use crate::correction::remedy::remedy;
use crate::correction::scales::{Descent, Effort, Found, Landscape, PROOF, search, settle};
use crate::dataset::{Pair, PairTable};

/// Residual in natural logarithms below which a held entry counts as matched (M8).
pub(crate) const MATCHED: f64 = 1e-8;

/// Finds the channel gains of least objective (equation (7), M8), with a proof that no others are better.
///
/// Entries that the bounds or their own loops do not allow are held at the nearest products that are possible (least squares in
/// logarithms), and reported.
///
/// ```
/// use gdcm::correction::{GainBounds, GainProblem, Outcome, ProofBudget, solve_gains};
/// use gdcm::dataset::{Pair, PairTable};
///
/// let delta_gains = [[1.2, 0.8], [0.9, 1.1]];
/// let wanted = PairTable::from_fn(2, 2, |pair| Some(delta_gains[pair.output][pair.input]));
/// let held = PairTable::from_fn(2, 2, |pair| pair == Pair::new(0, 0));
/// let problem = GainProblem::new(wanted, held, GainBounds { lower: 0.5, upper: 2.0 });
/// let solution = solve_gains(&problem, ProofBudget::default())?;
/// assert!((solution.outputs[0] * solution.inputs[0] - 1.2).abs() < 1e-12);
/// assert!(matches!(solution.outcome, Outcome::Proven { .. }));
/// # Ok::<(), gdcm::correction::GainError>(())
/// ```
///
/// # Errors
/// [`GainError`] where the problem is not well posed ([`GainProblem::check`]).
pub fn solve_gains(problem: &GainProblem, budget: ProofBudget) -> Result<GainSolution, GainError> {
    solve_gains_until(problem, budget, &|| false)
}

/// [`solve_gains`], giving up the proof (not the answer) as soon as `stop` says so.
///
/// # Errors
/// As [`solve_gains`].
pub fn solve_gains_until(
    problem: &GainProblem,
    budget: ProofBudget,
    stop: &dyn Fn() -> bool,
) -> Result<GainSolution, GainError> {
    problem.check()?;
    let held = held(problem);
    let reached = reach_gains(&held);
    let landscape = landscape(problem, &reached.components);
    let mut found =
        search(&landscape, Effort { boxes: budget.boxes, listing: budget.minima, floor: floor(problem), stop });
    for (scales, _) in &mut found.minima {
        settle_gains(problem, &reached.components, &landscape, scales);
    }
    Ok(assemble(problem, &held, &reached, &found))
}

/// The held entries in natural logarithms.
pub(crate) fn held(problem: &GainProblem) -> Held {
    Held {
        outputs: problem.wanted.outputs(),
        inputs: problem.wanted.inputs(),
        entries: problem.held_entries().map(|(pair, wanted)| (pair, wanted.ln())).collect(),
        range: (problem.bounds.lower.ln(), problem.bounds.upper.ln()),
    }
}

/// Stage 1 of M8.
pub(crate) fn reach_gains(held: &Held) -> Reached {
    let nearest = |landscape: &Landscape| {
        let mut point: Vec<f64> =
            landscape.lower.iter().zip(&landscape.upper).map(|(low, high)| 0.0_f64.clamp(*low, *high)).collect();
        Descent::new(landscape.nodes()).run(landscape, (&landscape.lower, &landscape.upper), &mut point, |_, _| false);
        Ok::<_, Infallible>(point)
    };
    match reach(held, nearest) {
        Ok(reached) => reached,
        Err(never) => match never {},
    }
}

/// The objective below which rounding decides, not the search: a billionth of the objective without any gain (the rounding of a
/// sum of squares grows with the root of what the squares are taken of), and for the output gains, known to their rounding, its
/// square.
fn floor(problem: &GainProblem) -> f64 {
    let square = |wanted: f64| match problem.objective {
        GainObjective::Ratio => wanted * wanted,
        GainObjective::Decibel => SQUARED_DECIBEL * (wanted.ln().powi(2) + 1.0),
    };
    let energy: f64 = problem.fit_entries().map(|(_, wanted)| square(wanted)).sum();
    (1e-9 * energy + 1e-20 * problem.alpha * problem.wanted.outputs() as f64).max(f64::MIN_POSITIVE)
}

/// The limit `alpha -> 0+`: a free common scale goes where the output gains are nearest to 1 (inputs, where there is no output).
fn settle_gains(problem: &GainProblem, components: &Components, landscape: &Landscape, scales: &mut [f64]) {
    settle(landscape, scales, |nodes, scales| {
        let (inputs, outputs) = components.channels(scales);
        let of_piece = |channels: &[crate::correction::components::Placement], values: &[f64]| -> Vec<f64> {
            let pairs = channels.iter().zip(values);
            pairs.filter(|(channel, _)| nodes.contains(&channel.component)).map(|(_, value)| *value).collect()
        };
        let (inputs, outputs) = (of_piece(&components.inputs, &inputs), of_piece(&components.outputs, &outputs));
        let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
        match (problem.objective, outputs.is_empty(), inputs.is_empty()) {
            (_, true, true) => 0.0,
            (_, true, false) => -mean(&inputs),
            (GainObjective::Decibel, false, _) => mean(&outputs),
            (GainObjective::Ratio, false, _) => {
                let (sum, square) =
                    outputs.iter().fold((0.0, 0.0), |(sum, square), x| (sum + x.exp(), square + (2.0 * x).exp()));
                (square / sum).ln()
            }
        }
    });
}

/// Gains of the inputs and of the outputs at these scales, exactly on the bounds they reach.
pub(crate) fn gains_at(problem: &GainProblem, components: &Components, scales: &[f64]) -> (Vec<f64>, Vec<f64>) {
    let (lower, upper) = (problem.bounds.lower, problem.bounds.upper);
    let gain = |logarithm: &f64| {
        // A few roundings of logarithms of this size.
        let near = |bound: f64| (logarithm - bound.ln()).abs() <= 16.0 * f64::EPSILON * (1.0 + bound.ln().abs());
        if near(lower) {
            lower
        } else if near(upper) {
            upper
        } else {
            logarithm.exp().clamp(lower, upper)
        }
    };
    let (inputs, outputs) = components.channels(scales);
    (inputs.iter().map(gain).collect(), outputs.iter().map(gain).collect())
}

fn assemble(problem: &GainProblem, held: &Held, reached: &Reached, found: &Found) -> GainSolution {
    let minimum = |(scales, _): &(Vec<f64>, f64)| {
        let (inputs, outputs) = gains_at(problem, &reached.components, scales);
        let objective = problem.objective_at(&inputs, &outputs);
        LocalMinimum { inputs, outputs, objective }
    };
    let local_minima: Vec<LocalMinimum> = found.minima.iter().map(minimum).collect();
    let best = local_minima[0].clone();
    let (unmatched, conflicts) = misses(problem, held, reached);
    let outcome =
        if found.gap <= PROOF { Outcome::Proven { gap: found.gap } } else { Outcome::NotProven { gap: found.gap } };
    let mut targets = PairTable::filled(held.outputs, held.inputs, None);
    for (pair, target) in &reached.targets {
        targets[*pair] = Some(target.exp());
    }
    GainSolution {
        inputs: best.inputs,
        outputs: best.outputs,
        minimised: problem.objective,
        objective: best.objective,
        lower_bound: found.lower_bound.min(best.objective),
        outcome,
        boxes: found.boxes,
        targets,
        matched: unmatched.is_empty(),
        remedy: remedy_of(problem, held, &conflicts),
        unmatched,
        conflicts,
        local_minima,
        all_minima: found.all_minima,
    }
}

/// The held entries that stage 1 could not match, and the distinct conflicts behind them.
fn misses(problem: &GainProblem, held: &Held, reached: &Reached) -> (Vec<UnmatchedGain>, Vec<GainConflict>) {
    let clashes = clashes(held, reached, MATCHED);
    let why = |pair: Pair| match clashes.iter().find(|(missed, _)| *missed == pair) {
        Some((_, clash)) => GainConflict::new(clash.clone(), problem.bounds),
        None => GainConflict::Unclear { entries: held.entries.iter().map(|(pair, _)| *pair).collect() },
    };
    let mut unmatched = Vec::new();
    for ((pair, wanted), (_, target)) in held.entries.iter().zip(&reached.targets) {
        if (target - wanted).abs() > MATCHED {
            let shortfall_db = (target - wanted) * DECIBEL;
            unmatched.push(UnmatchedGain {
                pair: *pair,
                wanted: wanted.exp(),
                target: target.exp(),
                shortfall_db,
                why: why(*pair),
            });
        }
    }
    let mut conflicts: Vec<GainConflict> = Vec::new();
    for miss in &unmatched {
        let same = |known: &&GainConflict| {
            known.entries().len() == miss.why.entries().len()
                && known.entries().iter().all(|pair| miss.why.entries().contains(pair))
        };
        if !conflicts.iter().any(|known| same(&known)) {
            conflicts.push(miss.why.clone());
        }
    }
    conflicts.sort_by_key(|conflict| (!matches!(conflict, GainConflict::Loop { .. }), conflict.entries().len()));
    (unmatched, conflicts)
}

/// What would let everything be held, where something cannot.
fn remedy_of(problem: &GainProblem, held: &Held, conflicts: &[GainConflict]) -> Option<GainRemedy> {
    let mut suspects: Vec<Pair> = conflicts.iter().flat_map(|conflict| conflict.entries().iter().copied()).collect();
    suspects.sort();
    suspects.dedup();
    (!suspects.is_empty()).then(|| GainRemedy::new(remedy(held, &suspects), problem.bounds))
}
