//! Which held entries and bounds are in each other's way.

use std::collections::VecDeque;

use super::branch_and_bound::{Effort, SearchStopped};
use super::channel::Channel;
use super::reach::{Held, Reached, STRAIN};
use crate::dataset::Pair;

/// An irreducible set of held entries, with at most two bounds, that cannot hold together, in sums of coordinates.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Inconsistency {
    /// The entries of the set, along the path or round the loop.
    pub(crate) entries: Vec<Pair>,
    /// What makes them impossible.
    pub(crate) kind: ClashKind,
}

/// How the entries of a [`Inconsistency`] exclude one another.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum ClashKind {
    /// The entries fix the sum of two channels, and it is above what the upper bound allows.
    SumAbove { channels: (Channel, Channel), sum: f64 },
    /// The entries fix the sum of two channels, and it is below what the lower bound allows.
    SumBelow { channels: (Channel, Channel), sum: f64 },
    /// The entries fix how far `greater` is above `lesser`, and the box is narrower.
    Apart { greater: Channel, lesser: Channel, difference: f64 },
    /// The entries form a loop, and going round it does not lead back.
    Loop { mismatch: f64 },
}

/// One held entry that stage 1 had to pull: it asks that `s_to - s_from` be at least `weight`, and gets less.
#[derive(Clone, Copy)]
struct Pull {
    from: usize,
    to: usize,
    weight: f64,
    pair: Pair,
}

impl Pull {
    /// The same entry asked the other way round: it is an equation.
    fn reversed(&self) -> Self {
        Self { from: self.to, to: self.from, weight: -self.weight, pair: self.pair }
    }
}

/// The smallest clash behind each entry that stage 1 missed by more than `tolerance`, with repeats.
///
/// Stage 1 is a least squares problem, so the misses are a flow: what pulls at a channel is passed on by another missed entry or
/// is stopped by an active bound. Every path of the flow from bound to bound, and every loop of it, is a set that
/// cannot hold, and every missed entry is on one (Farkas). Where a part of that set cannot hold by itself, that part is the
/// clash, and the entry's own miss is the compromise with it.
pub(crate) fn clashes(
    held: &Held,
    reached: &Reached,
    tolerance: f64,
    effort: &Effort<'_>,
) -> Result<Vec<(Pair, Inconsistency)>, SearchStopped> {
    let Some(point) = &reached.point else { return Ok(Vec::new()) };
    let flow = Flow::new(held, reached, point);
    let missed = |pull: &&Pull| {
        let lacking = pull.weight - (point[pull.to] - point[pull.from]);
        lacking > tolerance
    };
    let mut clashes = Vec::new();
    for pull in flow.pulls.iter().filter(missed) {
        // Three searches over every pull of every channel.
        effort.spend((flow.pulls.len() * flow.at_lower.len()) as u64 / 8);
        effort.check()?;
        clashes.extend(flow.smallest_through(pull).map(|clash| (pull.pair, clash)));
    }
    Ok(clashes)
}

struct Flow {
    inputs: usize,
    range: (f64, f64),
    pulls: Vec<Pull>,
    at_lower: Vec<bool>,
    at_upper: Vec<bool>,
}

impl Flow {
    fn new(held: &Held, reached: &Reached, point: &[f64]) -> Self {
        let nodes = held.inputs + held.outputs;
        let mut flow =
            Self { inputs: held.inputs, range: held.range, pulls: Vec::new(), at_lower: vec![], at_upper: vec![] };
        let mut net = vec![0.0; nodes];
        for ((pair, delta), (_, target)) in held.entries.iter().zip(&reached.targets) {
            let (input, output) = (pair.input, held.inputs + pair.output);
            let missing = delta - target;
            // Below this a miss is the rounding of stage 1.
            if missing.abs() <= 1e-11 * (1.0 + delta.abs()) {
                continue;
            }
            let (from, to, weight) = if missing > 0.0 { (output, input, *delta) } else { (input, output, -delta) };
            net[from] -= missing.abs();
            net[to] += missing.abs();
            flow.pulls.push(Pull { from, to, weight, pair: *pair });
        }
        flow.at_lower = (0..nodes).map(|node| point[node] <= flow.ends(node).0 && net[node] < 0.0).collect();
        flow.at_upper = (0..nodes).map(|node| point[node] >= flow.ends(node).1 && net[node] > 0.0).collect();
        flow
    }

    /// The shorter of the shortest loop and the shortest path from bound to bound through `pull`; a bound counts like an entry.
    fn smallest_through(&self, pull: &Pull) -> Option<Inconsistency> {
        let around = self.shortest(pull.to, |node| node == pull.from, false);
        let onward = self.shortest(pull.to, |node| self.at_upper[node], false);
        let back = self.shortest(pull.from, |node| self.at_lower[node], true);
        let path = back.zip(onward).map(|(back, onward)| {
            let before = back.into_iter().rev();
            before.chain([*pull]).chain(onward).collect::<Vec<Pull>>()
        });
        match (around, path) {
            (Some(around), Some(path)) if around.len() < path.len() + 2 => Some(self.round(pull, around)),
            (_, Some(path)) => Some(self.stretched(&path)),
            (Some(around), None) => Some(self.round(pull, around)),
            (None, None) => None,
        }
    }

    fn round(&self, pull: &Pull, around: Vec<Pull>) -> Inconsistency {
        let pulls: Vec<Pull> = std::iter::once(*pull).chain(around).collect();
        if let Some(clash) = self.smallest_part(&pulls, pulls.len()) {
            return clash;
        }
        let mismatch = pulls.iter().map(|pull| pull.weight).sum();
        Inconsistency { entries: pulls.iter().map(|pull| pull.pair).collect(), kind: ClashKind::Loop { mismatch } }
    }

    /// The clash of a path from a node at its least value to one at its greatest, or of the shortest part of it that the bounds
    /// do not allow either.
    fn stretched(&self, path: &[Pull]) -> Inconsistency {
        self.smallest_part(path, 0).unwrap_or_else(|| self.clash(path))
    }

    /// The shortest run of the pulls, less than all of them, that the bounds of its two ends do not allow. Runs may begin at the
    /// first `round` pulls and go on past the last into the first ones again.
    fn smallest_part(&self, pulls: &[Pull], round: usize) -> Option<Inconsistency> {
        let count = pulls.len();
        (1..count).find_map(|length| {
            let begins = if round > 0 { round } else { count - length + 1 };
            (0..begins).find_map(|begin| {
                let run: Vec<Pull> = (begin..begin + length).map(|index| pulls[index % count]).collect();
                let back: Vec<Pull> = run.iter().rev().map(Pull::reversed).collect();
                [run, back].iter().find(|run| self.is_impossible(run)).map(|run| self.clash(run))
            })
        })
    }

    /// Whether the run needs more than there is between the least value of its first node and the greatest of its last.
    fn is_impossible(&self, run: &[Pull]) -> bool {
        let (Some(first), Some(last)) = (run.first(), run.last()) else {
            return false;
        };
        let needed: f64 = run.iter().map(|pull| pull.weight).sum();
        needed - (self.ends(last.to).1 - self.ends(first.from).0) > STRAIN
    }

    /// Least and greatest value of a node: an output's is minus its channel's.
    fn ends(&self, node: usize) -> (f64, f64) {
        let (low, high) = self.range;
        if node < self.inputs { (low, high) } else { (-high, -low) }
    }

    /// The clash of a path from a node at its least value to one at its greatest.
    fn clash(&self, path: &[Pull]) -> Inconsistency {
        let needed: f64 = path.iter().map(|pull| pull.weight).sum();
        let mut entries: Vec<Pair> = path.iter().map(|pull| pull.pair).collect();
        let (start, end) = (path.first().map_or(0, |pull| pull.from), path.last().map_or(0, |pull| pull.to));
        let kind = match (self.channel(start), self.channel(end)) {
            (first @ Channel::Output(_), last @ Channel::Input(_)) => {
                ClashKind::SumAbove { channels: (last, first), sum: needed }
            }
            (first @ Channel::Input(_), last @ Channel::Output(_)) => {
                ClashKind::SumBelow { channels: (first, last), sum: -needed }
            }
            (lesser @ Channel::Input(_), greater @ Channel::Input(_)) | (greater, lesser) => {
                ClashKind::Apart { greater, lesser, difference: needed }
            }
        };
        entries.sort();
        Inconsistency { entries, kind }
    }

    fn channel(&self, node: usize) -> Channel {
        if node < self.inputs { Channel::Input(node) } else { Channel::Output(node - self.inputs) }
    }

    /// Fewest pulls from `start` along (or against) their direction to a node that `ends`, in the order walked.
    fn shortest(&self, start: usize, ends: impl Fn(usize) -> bool, against: bool) -> Option<Vec<Pull>> {
        let mut came_by: Vec<Option<Pull>> = vec![None; self.at_lower.len()];
        let mut queue = VecDeque::from([start]);
        while let Some(node) = queue.pop_front() {
            if ends(node) {
                let mut walked = Vec::new();
                let mut at = node;
                while at != start {
                    let pull = came_by[at]?;
                    at = if against { pull.to } else { pull.from };
                    walked.push(pull);
                }
                walked.reverse();
                return Some(walked);
            }
            for pull in &self.pulls {
                let (leaves, enters) = if against { (pull.to, pull.from) } else { (pull.from, pull.to) };
                if leaves == node && enters != start && came_by[enters].is_none() {
                    came_by[enters] = Some(*pull);
                    queue.push_back(enters);
                }
            }
        }
        None
    }
}
