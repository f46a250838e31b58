//! Solver for eq. (7) and (11), and for signed delays (M15.4): finds the gains or delays with the
//! minimum objective, and proves that they are optimal.

use gdcm_model::dataset::PairTable;
use gdcm_model::statistics::mean;

use super::branch_and_bound::effort::{Effort, SearchStopped};
use super::branch_and_bound::newton::Newton;
use super::branch_and_bound::objective::Objective;
use super::branch_and_bound::proof_budget::ProofBudget;
use super::branch_and_bound::search::{Minima, search};
use super::components::{ChannelCoordinates, Components, Placement};
use super::conflict::{Conflict, ConflictKind};
use super::conflict_search::entry_conflicts;
use super::constraints::{ConstrainedSum, Constraints};
use super::interior_point::interior_point;
use super::problem::{Problem, ProblemError};
use super::quantity::{Coordinate, GainObjective, Quantity};
use super::reachable_targets::{Reached, reach};
use super::remedy::Remedy;
use super::scaled_objective::{rounding_floor, scaled_objective};
use super::solution::{LocalMinimum, Outcome, Proof, Solution, Unmatched};

/// Residual in natural logarithms, or as a fraction of the problem's longest delay, up to which a
/// constrained entry meets its delta (M8).
const MATCHED: f64 = 1e-8;

/// Residual \[s\] up to which a constrained delay meets its delta, however short the delays of the
/// problem are: the difference between equal phases has rounding errors. At the highest band
/// frequency, 1e5 rad/s, it is 0.006 degrees.
const MATCHED_DELAY_S: f64 = 1e-9;

/// Finds the channel gains (eq. (7), M8), delays (eq. (11), M9) or signed delays (M15.4) with the
/// minimum objective, and proves that no others are better.
///
/// ```text
/// 1  targets: the sums nearest to the deltas that the box and the loops permit (stage 1)
/// 2  objective over the scales that the constrained sums leave free (M8, proof)
/// 3  global minimum by branch and bound, from a start near it (stage 2)
/// 4  limit alpha -> 0+ if a common scale is free
/// 5  for each infeasible delta of stage 1: its conflict, and the single changes that would resolve all conflicts
/// ```
///
/// Entries that are infeasible because of the bounds or of their own loops are constrained to the
/// nearest feasible products or sums (least squares in logarithms, or in seconds), and listed in
/// the solution.
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
/// [`ProblemError`] if the problem is not well posed ([`Problem::check`]), and
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
        &settled_loops(&constraints, &reached, &misses.agreeing),
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

/// Returns the start of Newton's method. For delays it is so close to the minimum that Newton's
/// method converges to it exactly, with the correct active bounds.
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

/// Takes the limit `alpha -> 0+`: the fit does not determine a common shift of the scales in a
/// floating piece, which is therefore set to the value that minimises the regularised deviations
/// from neutral.
fn take_alpha_limit(
    quantity: Quantity,
    components: &Components,
    objective: &Objective,
    scales: &mut [f64],
) {
    objective.shift_floating_pieces(scales, |piece, scales| {
        let channels = components.channels(scales);
        let nodes = components.nodes();
        let in_piece = ChannelCoordinates {
            inputs: select_piece(piece, nodes.inputs, &channels.inputs),
            outputs: select_piece(piece, nodes.outputs, &channels.outputs),
        };
        least_departure_shift(quantity, &in_piece)
    });
}

/// Selects the values of the nodes that belong to a group of components.
fn select_piece(piece: &[usize], nodes: &[Placement], values: &[f64]) -> Vec<f64> {
    let mut selected = Vec::new();
    for (node, &value) in nodes.iter().zip(values) {
        if piece.contains(&node.component) {
            selected.push(value);
        }
    }
    selected
}

/// Returns the shift of a group's scales that minimises the regularised deviations from neutral; it
/// raises the coordinates of the inputs and lowers those of the outputs by the same amount. The
/// outputs are regularised (the inputs, if the group has no output); for signed delays, both.
fn least_departure_shift(quantity: Quantity, channels: &ChannelCoordinates) -> f64 {
    let ChannelCoordinates { inputs, outputs } = channels;
    if quantity.regularises_inputs() {
        let apart = outputs.iter().sum::<f64>() - inputs.iter().sum::<f64>();
        return apart / (inputs.len() + outputs.len()).max(1) as f64;
    }
    if outputs.is_empty() {
        return if inputs.is_empty() {
            0.0
        } else {
            -mean(inputs)
        };
    }
    if quantity != Quantity::Gain(GainObjective::Ratio) {
        return mean(outputs);
    }
    // sum (k e^-shift - 1)^2 is minimal at e^shift = sum k^2 / sum k.
    let mut sum = 0.0;
    let mut square = 0.0;
    for logarithm in outputs {
        sum += logarithm.exp();
        square += (2.0 * logarithm).exp();
    }
    (square / sum).ln()
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
    // Tolerance: a few roundings at the magnitude of the range.
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

/// Converts the result of the search to gains or delays.
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

/// The constrained entries whose delta is infeasible.
struct Misses {
    /// Entries in loops whose deviation is within the tolerance of the problem.
    agreeing: Vec<Unmatched>,
    unmatched: Vec<Unmatched>,
}

/// Finds the constrained entries whose delta was infeasible in stage 1, each with its conflict.
fn misses(
    problem: &Problem,
    constraints: &Constraints,
    reached: &Reached,
    effort: &Effort<'_>,
) -> Result<Misses, SearchStopped> {
    let tolerance = matching_tolerance(problem.coordinate());
    let conflicts = entry_conflicts(problem, constraints, reached, tolerance, effort)?;
    let mut misses = Misses {
        agreeing: Vec::new(),
        unmatched: Vec::new(),
    };
    for (asked, target) in constraints.entries.iter().zip(&reached.targets) {
        if (target.sum - asked.sum).abs() > tolerance {
            let known = conflicts.iter().find(|found| found.missed == asked.pair);
            let why = match known {
                Some(found) => found.conflict.clone(),
                None => unclear_conflict(problem, constraints),
            };
            let miss = unmatched(problem, asked, target, why);
            if miss.why.agrees_within(problem.agreement) && miss.excess.abs() <= problem.agreement {
                misses.agreeing.push(miss);
            } else {
                misses.unmatched.push(miss);
            }
        }
    }
    Ok(misses)
}

/// Returns the residual, in the coordinate of the problem, up to which a constrained entry meets
/// its delta.
fn matching_tolerance(coordinate: Coordinate) -> f64 {
    match coordinate {
        Coordinate::Logarithm => MATCHED,
        Coordinate::Time { unit_s } => MATCHED.max(MATCHED_DELAY_S / unit_s),
    }
}

/// Returns the conflict that contains all constrained entries; used if no smaller conflict is
/// found.
fn unclear_conflict(problem: &Problem, constraints: &Constraints) -> Conflict {
    Conflict {
        quantity: problem.quantity,
        entries: constraints.entries.iter().map(|entry| entry.pair).collect(),
        bounds: problem.bounds,
        kind: ConflictKind::Unclear,
    }
}

/// Converts an infeasible entry from coordinates to gains or delays.
fn unmatched(
    problem: &Problem,
    asked: &ConstrainedSum,
    reached: &ConstrainedSum,
    why: Conflict,
) -> Unmatched {
    let quantity = problem.quantity;
    let coordinate = problem.coordinate();
    let delta = coordinate.value(asked.sum);
    let target = coordinate.value(reached.sum);
    let excess = if quantity.is_gain() {
        quantity.difference(reached.sum - asked.sum, coordinate)
    } else {
        target - delta
    };
    Unmatched {
        quantity,
        pair: asked.pair,
        delta,
        target,
        excess,
        why,
    }
}

/// Returns the constraints, in which the entries of accepted loops are replaced by their targets.
fn settled_loops(
    constraints: &Constraints,
    reached: &Reached,
    agreeing: &[Unmatched],
) -> Constraints {
    let mut entries = constraints.entries.clone();
    for (entry, target) in entries.iter_mut().zip(&reached.targets) {
        if agreeing.iter().any(|miss| miss.pair == entry.pair) {
            *entry = *target;
        }
    }
    constraints.with_entries(entries)
}

/// Collects the distinct conflicts of the infeasible entries: loops first, then by number of
/// entries.
fn distinct_conflicts(misses: &[Unmatched]) -> Vec<Conflict> {
    let mut conflicts: Vec<Conflict> = Vec::new();
    for miss in misses {
        let is_known = conflicts
            .iter()
            .any(|known| known.has_entries_of(&miss.why));
        if !is_known {
            conflicts.push(miss.why.clone());
        }
    }
    conflicts.sort_by_key(|conflict| (!conflict.is_loop(), conflict.entries.len()));
    conflicts
}
