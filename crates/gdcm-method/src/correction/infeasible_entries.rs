//! Constrained entries whose delta is infeasible, each with the conflict behind it: step 5 in
//! `solve`.
//!
//! A constrained entry prescribes a sum of two channel coordinates (logarithms of gains, or
//! delays): its delta, the gain or delay that the response needs. Stage 1 (`reachable_targets`) has
//! replaced an infeasible sum by a target, the nearest feasible sum. A *conflict* is a smallest set
//! of constrained entries and bounds that cannot all be met; in a *loop*, entries contradict each
//! other whatever the bounds.

use super::branch_and_bound::effort::{Effort, SearchStopped};
use super::conflict::{Conflict, ConflictKind};
use super::conflict_search::entry_conflicts;
use super::constraints::{ConstrainedSum, Constraints};
use super::problem::Problem;
use super::quantity::Coordinate;
use super::reachable_targets::Reached;
use super::solution::Unmatched;

/// Residual up to which a constrained entry meets its delta, in natural logarithms or relative to
/// the problem's longest delay.
const MATCHED: f64 = 1e-8;

/// Residual \[s\] up to which a constrained delay meets its delta, however short the problem's
/// delays: the difference between equal phases has rounding errors. At the highest band frequency,
/// 1e5 rad/s, it is 0.006 degrees.
const MATCHED_DELAY_S: f64 = 1e-9;

/// The constrained entries whose delta is infeasible.
pub(super) struct Misses {
    /// Entries in loops that deviate by at most the problem's tolerance ([`Problem::agreement`]).
    pub(super) agreeing: Vec<Unmatched>,
    /// All other entries whose delta is infeasible.
    pub(super) unmatched: Vec<Unmatched>,
}

/// Finds the constrained entries whose delta was infeasible in stage 1, each with its conflict.
///
/// ```text
/// for each constrained entry whose target differs from its delta by more than the matching
/// tolerance
///     1  conflict: the one found for the entry; otherwise unclear, with all constrained entries
///     2  agreeing, if the conflict is a loop, and loop and entry deviate by at most the problem's
///        tolerance; otherwise unmatched
/// ```
pub(super) fn misses(
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
    for (prescribed, target) in constraints.entries.iter().zip(&reached.targets) {
        if (target.sum - prescribed.sum).abs() > tolerance {
            // Step 1
            let known = conflicts
                .iter()
                .find(|found| found.missed == prescribed.pair);
            let why = match known {
                Some(found) => found.conflict.clone(),
                None => unclear_conflict(problem, constraints),
            };
            // Step 2
            let miss = unmatched(problem, prescribed, target, why);
            if miss.why.agrees_within(problem.agreement) && miss.excess.abs() <= problem.agreement {
                misses.agreeing.push(miss);
            } else {
                misses.unmatched.push(miss);
            }
        }
    }
    Ok(misses)
}

/// Returns the residual, in the problem's coordinate, up to which a constrained entry meets its
/// delta.
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
    prescribed: &ConstrainedSum,
    reached: &ConstrainedSum,
    why: Conflict,
) -> Unmatched {
    let quantity = problem.quantity;
    let coordinate = problem.coordinate();
    let delta = coordinate.value(prescribed.sum);
    let target = coordinate.value(reached.sum);
    let excess = if quantity.is_gain() {
        quantity.difference(reached.sum - prescribed.sum, coordinate)
    } else {
        target - delta
    };
    Unmatched {
        quantity,
        pair: prescribed.pair,
        delta,
        target,
        excess,
        why,
    }
}

/// Returns the constraints with each entry in `agreeing` (a loop that is consistent within the
/// tolerance) replaced by its target.
pub(super) fn with_agreeing_targets(
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

/// Collects the infeasible entries' distinct conflicts: loops first, then by entry count.
pub(super) fn distinct_conflicts(misses: &[Unmatched]) -> Vec<Conflict> {
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
