//! Finds the conflict behind each constrained entry that stage 1 could not meet. A constrained
//! entry prescribes the net gain or delay of a response. If the bounds or other constrained entries
//! make this infeasible, stage 1 ([`super::reachable_targets`]) takes the nearest feasible values
//! (least squares); the entries whose value it changes are *missed*.
//!
//! Nodes, their values, and entries as prescribed differences between these values are defined in
//! [`super::constraints`]. A missed entry is a *pull* from one node to another; the pulls are the
//! directed edges in a graph, the *flow* ([`super::pull_flow`]).

use gdcm_model::dataset::Pair;

use super::branch_and_bound::effort::{Effort, SearchStopped};
use super::channels::Channel;
use super::components::ACCEPTED_INFEASIBILITY;
use super::conflict::{Conflict, ConflictKind};
use super::constraints::Constraints;
use super::problem::Problem;
use super::pull_flow::{Flow, Pull};
use super::reachable_targets::Reached;
use super::three_digits::three_digits;

/// An entry that stage 1 could not meet, with the smallest conflict that explains it.
#[derive(Clone, Debug)]
pub(crate) struct EntryConflict {
    pub(crate) missed: Pair,
    pub(crate) conflict: Conflict,
}

/// Finds the smallest conflict behind each entry that stage 1 missed by more than `tolerance` (in
/// coordinates); the same conflict can appear several times.
///
/// Stage 1 is a least-squares problem, so that its residuals balance: where a missed entry pulls at
/// a channel, another missed entry or an active bound balances the pull. Every path in the flow
/// from bound to bound, and every loop, is an infeasible set, and every missed entry lies on such a
/// path or loop (Farkas). If a part of the path or loop is infeasible by itself, that part is the
/// conflict, and the entry's residual is a compromise with it.
///
/// ```text
/// for each missed entry
///     1  loop <- the entry, and the shortest way along the flow from its end back to its start
///     2  path <- the shortest way from a lower bound to its start, the entry, and the shortest way
///                from its end to an upper bound
///     3  the shorter of both, where each bound counts as one entry; the loop if they are equal;
///        no conflict without either
///     4  its shortest part that the bounds at both ends do not permit; without such a part, the
///        whole loop or path
/// ```
pub(crate) fn entry_conflicts(
    problem: &Problem,
    constraints: &Constraints,
    reached: &Reached,
    tolerance: f64,
    effort: &Effort<'_>,
) -> Result<Vec<EntryConflict>, SearchStopped> {
    let Some(point) = &reached.point else {
        return Ok(Vec::new());
    };
    let search = ConflictSearch {
        problem,
        constraints,
        flow: Flow::new(constraints, reached, point),
    };
    let pulls = &search.flow.pulls;
    let mut found = Vec::new();
    for pull in pulls {
        let missing = pull.weight - (point[pull.to] - point[pull.from]);
        if missing > tolerance {
            // Three breadth-first searches; each examines every pull at every channel, which counts
            // as 1/24 of a term evaluation.
            effort.spend((pulls.len() * constraints.nodes()) as u64 / 8);
            effort.check()?;
            if let Some(conflict) = search.smallest_through(pull) {
                found.push(EntryConflict {
                    missed: pull.pair,
                    conflict,
                });
            }
        }
    }
    Ok(found)
}

/// Number of bounds in a path's conflict, one at each end.
const BOUNDS_OF_A_PATH: usize = 2;

/// Whether a sequence of pulls is open or closes a loop.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Shape {
    Path,
    Loop,
}

/// The flow that the missed entries form, with the problem whose conflicts it explains.
struct ConflictSearch<'a> {
    problem: &'a Problem,
    constraints: &'a Constraints,
    flow: Flow,
}

impl ConflictSearch<'_> {
    /// Steps 1 to 4: returns the smallest conflict through `pull`; `None` if no loop and no path
    /// leads through it.
    fn smallest_through(&self, pull: &Pull) -> Option<Conflict> {
        // Step 1
        let around = self.flow.loop_through(pull);
        // Step 2
        let path = self.flow.path_through(pull);
        // Step 3
        let takes_loop = match (&around, &path) {
            (Some(around), Some(path)) => around.len() <= path.len() + BOUNDS_OF_A_PATH,
            _ => path.is_none(),
        };
        // Step 4
        if takes_loop {
            let around = around?;
            let part = self.smallest_part(&around, Shape::Loop);
            Some(part.unwrap_or_else(|| self.loop_conflict(&around)))
        } else {
            let path = path?;
            let part = self.smallest_part(&path, Shape::Path);
            Some(part.unwrap_or_else(|| self.path_conflict(&path)))
        }
    }

    /// Returns the conflict between the pulls in a loop.
    fn loop_conflict(&self, pulls: &[Pull]) -> Conflict {
        let sum: f64 = pulls.iter().map(|pull| pull.weight).sum();
        let mismatch = self
            .problem
            .quantity
            .difference(sum, self.problem.coordinate());
        let entries = pulls.iter().map(|pull| pull.pair).collect();
        self.conflict(entries, ConflictKind::Loop { mismatch })
    }

    /// Step 4: returns the conflict in the shortest proper part of the sequence that the bounds at
    /// the part's two ends do not permit; `None` if there is none. In a loop, a part may continue
    /// from the last pull to the first.
    fn smallest_part(&self, pulls: &[Pull], shape: Shape) -> Option<Conflict> {
        let count = pulls.len();
        for length in 1..count {
            let starts = match shape {
                Shape::Path => count - length + 1,
                Shape::Loop => count,
            };
            for start in 0..starts {
                let run: Vec<Pull> = (start..start + length)
                    .map(|index| pulls[index % count])
                    .collect();
                if self.is_impossible(&run) {
                    return Some(self.path_conflict(&run));
                }
                let back: Vec<Pull> = run.iter().rev().map(Pull::reversed).collect();
                if self.is_impossible(&back) {
                    return Some(self.path_conflict(&back));
                }
            }
        }
        None
    }

    /// Returns whether the pulls in the sequence add up to more than its last node's maximum less
    /// its first node's minimum.
    fn is_impossible(&self, run: &[Pull]) -> bool {
        let (Some(first), Some(last)) = (run.first(), run.last()) else {
            return false;
        };
        let needed: f64 = run.iter().map(|pull| pull.weight).sum();
        let most = self.constraints.node_range(last.to).high;
        let least = self.constraints.node_range(first.from).low;
        needed - (most - least) > ACCEPTED_INFEASIBILITY
    }

    /// Returns the conflict on a path from a node at its minimum to a node at its maximum.
    fn path_conflict(&self, path: &[Pull]) -> Conflict {
        let needed: f64 = path.iter().map(|pull| pull.weight).sum();
        let start = path.first().map_or(0, |pull| pull.from);
        let end = path.last().map_or(0, |pull| pull.to);
        let coordinate = self.problem.coordinate();
        let start = self.constraints.channel(start);
        let end = self.constraints.channel(end);
        // An output node's value is minus the output's coordinate: at the node's minimum, the
        // output is at its upper bound. From an output to an input, `needed` is therefore the sum
        // of both coordinates, from an input to an output minus this sum; a bound of half the sum
        // on both channels suffices.
        let kind = match (start, end) {
            (Channel::Output(_), Channel::Input(_)) => ConflictKind::AboveUpper {
                channels: [end, start],
                asked: coordinate.value(needed),
                upper: three_digits(coordinate.value(0.5 * needed), f64::ceil),
            },
            (Channel::Input(_), Channel::Output(_)) => ConflictKind::BelowLower {
                channels: [start, end],
                asked: coordinate.value(-needed),
                lower: self.sufficient_lower(coordinate.value(-0.5 * needed)),
            },
            (Channel::Input(_), Channel::Input(_)) => {
                self.too_far_apart(end, start, coordinate.value(needed))
            }
            (Channel::Output(_), Channel::Output(_)) => {
                self.too_far_apart(start, end, coordinate.value(needed))
            }
        };
        let mut entries: Vec<Pair> = path.iter().map(|pull| pull.pair).collect();
        entries.sort();
        self.conflict(entries, kind)
    }

    /// Returns the conflict between two inputs, or two outputs, whose prescribed ratio or
    /// difference is `asked`.
    fn too_far_apart(&self, greater: Channel, lesser: Channel, asked: f64) -> ConflictKind {
        let quantity = self.problem.quantity;
        let bounds = self.problem.bounds;
        ConflictKind::TooFarApart {
            greater,
            lesser,
            asked,
            upper: three_digits(quantity.net(bounds.lower, asked), f64::ceil),
            lower: self.sufficient_lower(quantity.other_channel(bounds.upper, asked)),
        }
    }

    /// Rounds a lower bound down to three digits; `None` if the lower bound is fixed.
    fn sufficient_lower(&self, lower: f64) -> Option<f64> {
        if self.problem.quantity.has_lower_bound() {
            Some(three_digits(lower, f64::floor))
        } else {
            None
        }
    }

    fn conflict(&self, entries: Vec<Pair>, kind: ConflictKind) -> Conflict {
        Conflict {
            quantity: self.problem.quantity,
            entries,
            bounds: self.problem.bounds,
            kind,
        }
    }
}
