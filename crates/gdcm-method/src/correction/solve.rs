//! Solver for eq. (7) and (11), and for signed delays (M15.4): finds the gains or delays with the
//! minimum objective, and proves that they are optimal.
//!
//! An entry is a response; its *delta* is the gain or delay that it needs. In coordinates
//! (logarithms of gains, or delays), each constrained entry prescribes the sum over its two
//! channels. The box is given by the bounds; the *scales* are the coordinates that remain free.

use gdcm_model::dataset::PairTable;

use super::alpha_limit::take_alpha_limit;
use super::branch_and_bound::effort::Effort;
use super::branch_and_bound::newton::Newton;
use super::branch_and_bound::objective::Objective;
use super::branch_and_bound::proof_budget::ProofBudget;
use super::branch_and_bound::search::{Minima, search};
use super::components::Components;
use super::constraints::Constraints;
use super::infeasible_entries::{distinct_conflicts, misses, with_agreeing_targets};
use super::interior_point::interior_point;
use super::problem::{Problem, ProblemError};
use super::quantity::Quantity;
use super::reachable_targets::reach;
use super::remedy::Remedy;
use super::scaled_objective::{rounding_floor, scaled_objective};
use super::solution::{LocalMinimum, Outcome, Proof, Solution};

/// Finds the channel gains (eq. (7), M8), delays (eq. (11), M9) or signed delays (M15.4) with the
/// minimum objective, and proves that no others are better.
///
/// ```text
/// 1  targets: the sums nearest to the deltas that the box and the loops permit (stage 1)
/// 2  objective over the scales that the constrained sums leave free (M8, proof)
/// 3  global minimum by branch and bound (stage 2)
/// 4  limit alpha -> 0+ for floating pieces (`alpha_limit`)
/// 5  for each infeasible delta of stage 1: its conflict; and the single changes that would resolve
///    all conflicts
/// ```
///
/// Entries that the bounds or their own loops make infeasible are constrained to the nearest
/// feasible products or sums (least squares in logarithms, or in seconds), and listed in the
/// solution.
///
/// ```
/// use gdcm_method::correction::solve::solve;
/// use gdcm_method::correction::{Bounds, Outcome, Problem, ProofBudget};
/// use gdcm_model::dataset::{Pair, PairTable};
///
/// let delta_gains = [[1.2, 0.8], [0.9, 1.1]];
/// let delta = PairTable::from_fn(2, 2, |pair| Some(delta_gains[pair.output][pair.input]));
/// let constrained = PairTable::from_fn(2, 2, |pair| pair == Pair::new(0, 0));
/// let problem = Problem::gains(delta, constrained, Bounds { lower: 0.5, upper: 2.0 });
/// let solution = solve(&problem, ProofBudget::default(), &|| false)?;
/// assert!((solution.outputs[0] * solution.inputs[0] - 1.2).abs() < 1e-12);
/// assert!(matches!(solution.proof.outcome, Outcome::Proven { .. }));
/// # Ok::<(), gdcm_method::correction::problem::ProblemError>(())
/// ```
///
/// # Errors
/// [`ProblemError`] if the problem is not well posed ([`Problem::check`]),
/// [`ProblemError::Program`] if the interior-point method fails for delays, and
/// [`ProblemError::Stopped`] as soon as `stop`, which is polled about every half millisecond,
/// returns true.
pub fn solve(
    problem: &Problem,
    budget: ProofBudget,
    stop: &dyn Fn() -> bool,
) -> Result<Solution, ProblemError> {
    problem.check()?;
    let effort = Effort::new(stop);
    // Step 1.
    let constraints = Constraints::new(problem);
    let reached = reach(&constraints, |nearest_sums| {
        minimise(nearest_sums, problem.quantity, &effort)
    })?;
    // Steps 2 and 3.
    let objective = scaled_objective(problem, &reached.components);
    let start = newton_start(&objective, problem.quantity)?;
    let floor = rounding_floor(problem);
    let mut found = search(&objective, &start, budget, floor, &effort)?;
    // Step 4.
    for minimum in &mut found.minima {
        take_alpha_limit(
            problem.quantity,
            &reached.components,
            &objective,
            &mut minimum.scales,
        );
    }
    let proof = proof(problem, &reached.components, found);
    // Step 5.
    let misses = misses(problem, &constraints, &reached, &effort)?;
    let conflicts = distinct_conflicts(&misses.unmatched);
    let remedy = Remedy::new(
        problem,
        &with_agreeing_targets(&constraints, &reached, &misses.agreeing),
        &conflicts,
        &effort,
    )?;
    let coordinate = problem.coordinate();
    let mut targets = PairTable::filled(constraints.outputs, constraints.inputs, None);
    for target in &reached.targets {
        targets[target.pair] = Some(coordinate.value(target.sum));
    }
    let best = proof.local_minima[0].clone();
    Ok(Solution {
        quantity: problem.quantity,
        inputs: best.inputs,
        outputs: best.outputs,
        objective: best.objective,
        proof,
        targets,
        matched: misses.unmatched.is_empty(),
        agreeing: distinct_conflicts(&misses.agreeing),
        remedy,
        unmatched: misses.unmatched,
        conflicts,
    })
}

/// Returns a starting point for Newton's method: for gains, the point in the box nearest to 0; for
/// delays, a point so close to the minimum that Newton's method converges to the minimum exactly,
/// with the correct active bounds.
fn newton_start(objective: &Objective, quantity: Quantity) -> Result<Vec<f64>, ProblemError> {
    if quantity.is_gain() {
        Ok(objective.nearest_to_zero())
    } else {
        interior_point(objective)
    }
}

/// Minimises a least-squares objective over its box, by Newton's method.
fn minimise(
    objective: &Objective,
    quantity: Quantity,
    effort: &Effort<'_>,
) -> Result<Vec<f64>, ProblemError> {
    let mut scales = newton_start(objective, quantity)?;
    Newton::new(objective.scales(), effort).minimise(
        objective,
        objective.bounds(),
        &mut scales,
        |_, _| false,
    );
    effort.check()?;
    Ok(scales)
}

/// Converts the scales at a minimum to gains or delays, and evaluates the objective.
fn local_minimum(problem: &Problem, components: &Components, scales: &[f64]) -> LocalMinimum {
    let channels = components.channels(scales);
    let inputs = channel_values(problem, &channels.inputs);
    let outputs = channel_values(problem, &channels.outputs);
    let objective = problem.objective_at(&inputs, &outputs);
    LocalMinimum {
        inputs,
        outputs,
        objective,
    }
}

/// Converts coordinates to gains or delays; a value on a bound is set to exactly that bound.
fn channel_values(problem: &Problem, coordinates: &[f64]) -> Vec<f64> {
    let bounds = problem.bounds;
    let coordinate = problem.coordinate();
    let low = coordinate.transform(bounds.lower);
    let high = coordinate.transform(bounds.upper);
    // Tolerance: a few roundings at the range's magnitude.
    let rounding = 16.0 * f64::EPSILON * (1.0 + low.abs().max(high.abs()));
    let mut values = Vec::with_capacity(coordinates.len());
    for &at in coordinates {
        values.push(if (at - low).abs() <= rounding {
            bounds.lower
        } else if (at - high).abs() <= rounding {
            bounds.upper
        } else {
            coordinate.value(at).clamp(bounds.lower, bounds.upper)
        });
    }
    values
}

/// Converts the search's result to gains or delays.
fn proof(problem: &Problem, components: &Components, found: Minima) -> Proof {
    let local_minima: Vec<LocalMinimum> = found
        .minima
        .iter()
        .map(|minimum| local_minimum(problem, components, &minimum.scales))
        .collect();
    let outcome = match found.limit {
        None => Outcome::Proven { gap: found.gap },
        Some(limit) => Outcome::NotProven {
            gap: found.gap,
            limit,
        },
    };
    let lower_bound = problem
        .coordinate()
        .objective(found.lower_bound)
        .min(local_minima[0].objective);
    Proof {
        lower_bound,
        outcome,
        nodes: found.nodes,
        local_minima,
        all_minima: found.all_minima,
    }
}
