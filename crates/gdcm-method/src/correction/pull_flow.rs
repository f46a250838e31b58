//! Constrained entries that stage 1 could not meet, as pulls between the nodes in a directed graph,
//! and the shortest walks in this graph.
//!
//! A constrained entry prescribes the difference between two nodes' values `v`, one for its input
//! channel and one for its output channel ([`super::constraints`]). Stage 1 (`reachable_targets`)
//! has found the node values within the bounds that meet all entries best. A *pull* requires that
//! `v_to - v_from >= weight`, but stage 1 has reached less.

use std::collections::VecDeque;

use gdcm_model::dataset::Pair;

use super::constraints::{Constraints, PairNodes};
use super::reachable_targets::Reached;

/// Residual of a constrained entry, relative to `1 + |sum|` with its prescribed sum, up to which it
/// is a rounding error in stage 1.
const RESIDUAL_ROUNDING: f64 = 1e-11;

/// A constrained entry that stage 1 missed: it requires `v_to - v_from >= weight`, but the actual
/// difference is smaller.
#[derive(Clone, Copy)]
pub(super) struct Pull {
    /// Node whose value is too high.
    pub(super) from: usize,
    /// Node whose value is too low.
    pub(super) to: usize,
    /// Prescribed difference `v_to - v_from`.
    pub(super) weight: f64,
    pub(super) pair: Pair,
}

impl Pull {
    /// Returns the node from which a walk in this direction takes the pull.
    fn start(&self, direction: Direction) -> usize {
        match direction {
            Direction::Along => self.from,
            Direction::Against => self.to,
        }
    }

    /// Returns the node to which the pull leads a walk in this direction.
    fn end(&self, direction: Direction) -> usize {
        match direction {
            Direction::Along => self.to,
            Direction::Against => self.from,
        }
    }

    /// Returns the entry in the opposite direction, which is equivalent because the constraint is
    /// an equality.
    pub(super) fn reversed(&self) -> Self {
        Self {
            from: self.to,
            to: self.from,
            weight: -self.weight,
            pair: self.pair,
        }
    }
}

/// The missed entries, as a directed graph with one edge per pull.
pub(super) struct Flow {
    pub(super) pulls: Vec<Pull>,
    /// For each node, whether its lower bound balances the pulls.
    at_lower: Vec<bool>,
    /// For each node, whether its upper bound balances the pulls.
    at_upper: Vec<bool>,
}

impl Flow {
    /// Collects the entries missed at `point`, the result of stage 1.
    pub(super) fn new(constraints: &Constraints, reached: &Reached, point: &[f64]) -> Self {
        let mut pulls = Vec::new();
        // Sum of the pulls on each node: negative downwards, positive upwards.
        let mut net_pulls = vec![0.0; constraints.nodes()];
        for (prescribed, target) in constraints.entries.iter().zip(&reached.targets) {
            let missing = prescribed.sum - target.sum;
            if missing.abs() <= RESIDUAL_ROUNDING * (1.0 + prescribed.sum.abs()) {
                continue;
            }
            let PairNodes { input, output } = constraints.nodes_of(prescribed.pair);
            let upwards = Pull {
                from: output,
                to: input,
                weight: prescribed.sum,
                pair: prescribed.pair,
            };
            let pull = if missing > 0.0 {
                upwards
            } else {
                upwards.reversed()
            };
            net_pulls[pull.from] -= missing.abs();
            net_pulls[pull.to] += missing.abs();
            pulls.push(pull);
        }
        let mut at_lower = Vec::new();
        let mut at_upper = Vec::new();
        for (node, &net_pull) in net_pulls.iter().enumerate() {
            let range = constraints.node_range(node);
            at_lower.push(point[node] <= range.low && net_pull < 0.0);
            at_upper.push(point[node] >= range.high && net_pull > 0.0);
        }
        Self {
            pulls,
            at_lower,
            at_upper,
        }
    }

    /// Returns the shortest loop through `pull`: the pull, and the shortest way along the flow from
    /// its end back to its start; `None` if there is none.
    pub(super) fn loop_through(&self, pull: &Pull) -> Option<Vec<Pull>> {
        let way_back = self.shortest_walk(pull.to, Direction::Along, |node| node == pull.from)?;
        let mut around = vec![*pull];
        around.extend(way_back);
        Some(around)
    }

    /// Returns the shortest path from a node at its lower bound through `pull` to a node at its
    /// upper bound; `None` if there is none.
    pub(super) fn path_through(&self, pull: &Pull) -> Option<Vec<Pull>> {
        let onward = self.shortest_walk(pull.to, Direction::Along, |node| self.at_upper[node])?;
        let mut path =
            self.shortest_walk(pull.from, Direction::Against, |node| self.at_lower[node])?;
        path.reverse();
        path.push(*pull);
        path.extend(onward);
        Some(path)
    }

    /// Finds the shortest walk from `start` to a node for which `is_end` holds, by breadth-first
    /// search. Returns its pulls in order; `None` if there is no such walk.
    fn shortest_walk(
        &self,
        start: usize,
        direction: Direction,
        is_end: impl Fn(usize) -> bool,
    ) -> Option<Vec<Pull>> {
        let mut came_by: Vec<Option<Pull>> = vec![None; self.at_lower.len()];
        let mut queue = VecDeque::from([start]);
        while let Some(node) = queue.pop_front() {
            if is_end(node) {
                return walk_back(&came_by, start, node, direction);
            }
            for pull in &self.pulls {
                let next = pull.end(direction);
                if pull.start(direction) == node && next != start && came_by[next].is_none() {
                    came_by[next] = Some(*pull);
                    queue.push_back(next);
                }
            }
        }
        None
    }
}

/// Direction in which a walk takes the pulls.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Direction {
    Along,
    Against,
}

/// Collects the pulls from `start` to `end`; `came_by` holds the pull by which each node was
/// reached.
fn walk_back(
    came_by: &[Option<Pull>],
    start: usize,
    end: usize,
    direction: Direction,
) -> Option<Vec<Pull>> {
    let mut walked = Vec::new();
    let mut node = end;
    while node != start {
        let pull = came_by[node]?;
        node = pull.start(direction);
        walked.push(pull);
    }
    walked.reverse();
    Some(walked)
}
