//! The branch and bound search, with its open nodes and its budget, which counts work instead of
//! time so that results repeat.

use std::cell::Cell;
use std::cmp::Ordering;
use std::collections::BinaryHeap;

use super::node_exclusion::NodeExclusion;
use super::objective::{Curvature, Differentiable, Expansion, Newton, Objective};
use super::underestimator::{DifferenceBounds, Underestimator, tangent_bound};

/// Minima within this factor of the best are listed.
const NEAR: f64 = 1.01;

/// Relative gap at which branching stops, to end safely below [`PROOF`].
const AIM: f64 = 2e-10;

/// Result of a search.
#[derive(Clone, Debug)]
pub(crate) struct Minima {
    /// Distinct local minima within 1 % of the best, best first, each with its value.
    pub(crate) minima: Vec<(Vec<f64>, f64)>,
    /// Lower bound of the objective over the whole box.
    pub(crate) lower_bound: f64,
    /// `(best - lower_bound) / max(best, floor)`.
    pub(crate) gap: f64,
    /// Limit that ended the search, where the gap is not a proof.
    pub(crate) limit: Option<Limit>,
    pub(crate) nodes: usize,
    /// Whether any other local minimum within 1 % is excluded.
    pub(crate) all_minima: bool,
}

/// Finds the global minimum of `objective` over its box, with a rigorous lower bound ([`super`] has
/// the algorithm).
///
/// Newton's method begins at `start`; `floor` is the objective, set by rounding, below which the
/// gap is no longer relative.
///
/// # Errors
/// [`SearchStopped`] where the search was stopped from outside.
pub(crate) fn search(
    objective: &Objective,
    start: &[f64],
    budget: ProofBudget,
    floor: f64,
    effort: &Effort<'_>,
) -> Result<Minima, SearchStopped> {
    let mut search = Search::new(objective, budget, floor, effort);
    search.run(start)?;
    Ok(search.found())
}

struct Search<'a> {
    objective: &'a Objective,
    exclusion: NodeExclusion<'a>,
    budget: ProofBudget,
    floor: f64,
    effort: &'a Effort<'a>,
    newton: Newton<'a>,
    minima: Vec<(Vec<f64>, f64)>,
    best: f64,
    open: OpenNodes,
    /// Least bound of the closed nodes.
    closed: f64,
    nodes: usize,
    /// Work spent when the best was proven.
    proven_at: Option<u64>,
    /// Whether no closed node may hold an unknown local minimum.
    all_minima: bool,
    lower: Vec<f64>,
    upper: Vec<f64>,
    /// Curvature of an underestimator beyond its node: well above the objective's own, so that the
    /// part of the box next to a minimum is bounded by its own edge.
    beyond: f64,
}

impl<'a> Search<'a> {
    fn new(
        objective: &'a Objective,
        budget: ProofBudget,
        floor: f64,
        effort: &'a Effort<'a>,
    ) -> Self {
        let scales = objective.scales();
        Self {
            objective,
            exclusion: NodeExclusion::new(objective),
            budget,
            floor,
            effort,
            newton: Newton::new(scales, effort),
            minima: Vec::new(),
            best: f64::INFINITY,
            open: OpenNodes::new(scales, budget.bytes),
            closed: f64::INFINITY,
            nodes: 0,
            proven_at: None,
            all_minima: true,
            lower: objective.lower.clone(),
            upper: objective.upper.clone(),
            beyond: 0.0,
        }
    }

    /// Lines 1 to 3: best-first, until the best is proven and then until the other minima are
    /// listed.
    fn run(&mut self, start: &[f64]) -> Result<(), SearchStopped> {
        self.descend(start);
        let region = DifferenceBounds::of_box(&self.objective.lower, &self.objective.upper);
        self.open.push(Node {
            bound: 0.0,
            region,
            start: self.minima[0].0.clone(),
        });
        loop {
            self.effort.check()?;
            let bound = self.open.least_bound();
            if bound >= self.aim() {
                self.proven_at.get_or_insert(self.effort.spent());
            }
            if bound >= self.cutoff() || self.is_spent() {
                return Ok(());
            }
            let Some(node) = self.open.pop() else {
                return Ok(());
            };
            self.visit(node);
        }
    }

    fn is_spent(&self) -> bool {
        let spent = self.effort.spent();
        let listed = self
            .proven_at
            .is_some_and(|proven_at| spent - proven_at >= self.budget.listing);
        listed || spent >= self.budget.work || self.open.is_full()
    }

    fn denominator(&self) -> f64 {
        self.best.max(self.floor)
    }

    /// Bound that proves the best.
    fn aim(&self) -> f64 {
        self.best - AIM * self.denominator()
    }

    /// Bound above which no minimum is worth listing.
    fn cutoff(&self) -> f64 {
        NEAR * self.best + AIM * self.denominator()
    }

    /// Lines 4 to 9.
    fn visit(&mut self, node: Node) {
        self.nodes += 1;
        let Node {
            bound,
            region,
            mut start,
        } = node;
        let listing = self.proven_at.is_some();
        if listing && self.is_searched(&region) {
            return self.close(bound);
        }
        self.effort
            .spend(Underestimator::WORK_PER_TERM * self.objective.work());
        let underestimator = Underestimator::new(self.objective, &region, self.beyond);
        let goal = if listing { self.cutoff() } else { self.aim() };
        let bound = bound.max(self.lower_bound(&underestimator, &region, &mut start, goal));
        if bound >= self.cutoff() {
            return self.close(bound);
        }
        let known = self.minima.len();
        let value = self.objective.value(&start);
        // A minimum worth listing is below the cutoff, and so is a start near it.
        if value < self.best || (value < NEAR * self.cutoff() && self.minimum_in(&region).is_none())
        {
            self.descend(&start);
        }
        if bound >= self.aim() {
            if underestimator.is_exact()
                || (listing && self.minima.len() > known && self.is_searched(&region))
            {
                return self.close(bound);
            }
            if !listing {
                return self.open.push(Node {
                    bound,
                    region,
                    start,
                });
            }
        } else if let Some(convex) = self
            .convex_bound(&region, underestimator.is_exact())
            .filter(|convex| *convex >= self.aim())
        {
            return self.close(bound.max(convex));
        }
        self.branch(&underestimator, &region, bound, &start);
    }

    fn close(&mut self, bound: f64) {
        self.closed = self.closed.min(bound);
    }

    /// Returns the best lower bound from Newton's method on the underestimator; `start` ends at its
    /// minimum.
    fn lower_bound(
        &mut self,
        underestimator: &Underestimator<'_>,
        region: &DifferenceBounds,
        start: &mut [f64],
        goal: f64,
    ) -> f64 {
        region.write_box(&mut self.lower, &mut self.upper);
        for (index, scale) in start.iter_mut().enumerate() {
            *scale = scale.clamp(self.lower[index], self.upper[index]);
        }
        let cutoff = self.cutoff();
        let tolerance = 0.05 * AIM * self.denominator();
        let effort = self.effort;
        let most = self.budget.work;
        let bounds = (self.lower.as_slice(), self.upper.as_slice());
        let exact = underestimator.is_exact();
        let mut best = f64::NEG_INFINITY;
        self.newton
            .minimise(underestimator, bounds, start, |scales, at| {
                best = best.max(tangent_bound(scales, at, bounds));
                let loss = at.value.value - best;
                // A node that will be branched anyway needs no bound sharper than its distance from
                // the goal.
                let branched_anyway = !exact && loss <= 0.05 * (goal - at.value.value);
                let sharp = loss <= tolerance.max(2.0 * at.value.error);
                best >= cutoff || branched_anyway || sharp || effort.spent() >= most
            });
        best
    }

    /// Minimises the objective from `start` over the whole box, and keeps the minimum if it is new.
    fn descend(&mut self, start: &[f64]) {
        let mut scales = start.to_vec();
        let bounds = (
            self.objective.lower.as_slice(),
            self.objective.upper.as_slice(),
        );
        self.newton
            .minimise(self.objective, bounds, &mut scales, |_, _| false);
        let value = self.newton.reached.value.value;
        if value < self.best {
            let curvature = self
                .newton
                .reached
                .hessian
                .iter()
                .fold(0.0_f64, |most, entry| most.max(entry.abs()));
            self.beyond = 8.0 * curvature;
        }
        self.effort
            .spend((self.minima.len() * self.objective.terms.len()) as u64);
        let same = |(known, _): &(Vec<f64>, f64)| self.is_same(known, &scales);
        match self.minima.iter().position(same) {
            Some(position) if value < self.minima[position].1 => {
                self.minima[position] = (scales, value)
            }
            Some(_) => {}
            None => self.minima.push((scales, value)),
        }
        self.best = self.best.min(value);
    }

    /// Whether two minima are duplicates: no difference between them as measured by the curvature
    /// of the terms.
    fn is_same(&self, known: &[f64], found: &[f64]) -> bool {
        let changes = self.objective.terms.iter().map(|term| {
            let here = known[term.to] - known[term.from];
            let there = found[term.to] - found[term.from];
            (term, here, (there - here).abs())
        });
        let mut longest = 0.0_f64;
        let mut rise = 0.0;
        for (term, here, change) in changes {
            longest = longest.max(change);
            rise += 0.5 * term.function.at(here).curvature.abs() * change * change;
        }
        longest <= 1e-6 || rise <= AIM * self.denominator()
    }

    fn minimum_in(&self, region: &DifferenceBounds) -> Option<usize> {
        let scales = self.objective.scales();
        self.effort
            .spend((self.minima.len() * scales * scales) as u64 / 16);
        self.minima
            .iter()
            .position(|(scales, _)| region.holds(scales))
    }

    /// Bound of a node over whose hull with the best minimum the objective is convex (`exact`:
    /// every term is convex over the node), from the gradient and the Hessian at that minimum.
    fn convex_bound(&mut self, region: &DifferenceBounds, exact: bool) -> Option<f64> {
        let (scales, _) = self.minima.iter().min_by(|a, b| a.1.total_cmp(&b.1))?;
        let hull = region.hull(scales);
        self.effort.spend(2 * self.exclusion.work());
        if !(exact && region.holds(scales) || self.exclusion.is_convex(&hull)) {
            return None;
        }
        let mut at = Expansion::zero(scales.len());
        self.objective.expand(scales, Curvature::True, &mut at);
        hull.write_box(&mut self.lower, &mut self.upper);
        let tangent = tangent_bound(scales, &at, (&self.lower, &self.upper));
        Some(
            self.exclusion
                .bound_at(scales, &at)
                .map_or(tangent, |quadratic| quadratic.max(tangent)),
        )
    }

    /// Whether the node holds no local minimum other than a known one.
    fn is_searched(&self, region: &DifferenceBounds) -> bool {
        self.effort.spend(self.exclusion.work());
        let holds_only = |(scales, _): &(Vec<f64>, f64)| {
            self.effort.spend(2 * self.exclusion.work());
            self.exclusion.has_only(region, scales)
        };
        self.exclusion.has_no_minimum(region) || self.minima.iter().any(holds_only)
    }

    /// Branches where the node's bound loses most. Where nothing is lost or the best is already
    /// proven, separates convex from concave parts first, and then reduces the variation of the
    /// slopes.
    fn branch(
        &mut self,
        underestimator: &Underestimator<'_>,
        region: &DifferenceBounds,
        bound: f64,
        start: &[f64],
    ) {
        self.effort
            .spend(4 * self.objective.work() + (start.len() * start.len()) as u64 / 4);
        let listing = self.proven_at.is_some();
        let least_gap = 1e-13 * self.denominator();
        let gap = underestimator
            .widest_gap(start)
            .filter(|(_, gap)| !listing && *gap > least_gap)
            .map(|(term, _)| term);
        let ends = if gap.is_none() {
            underestimator.concave_ends(start)
        } else {
            Vec::new()
        };
        if !ends.is_empty() {
            let count = if listing { ends.len() } else { 1 };
            return self.split_concave(&ends[..count], region, bound, start);
        }
        let widest = gap
            .or_else(|| underestimator.widest_slope())
            .map(|term| (term, region.range(term.from, term.to)));
        let Some((term, (low, high))) = widest.filter(|(_, (low, high))| high - low > 1e-11) else {
            // The bound is as sharp as rounding allows.
            self.all_minima &= !listing;
            return self.close(bound);
        };
        let margin = 0.15 * (high - low);
        let at = (start[term.to] - start[term.from]).clamp(low + margin, high - margin);
        self.push(region.below(term.from, term.to, at), bound, start);
        self.push(region.above(term.from, term.to, at), bound, start);
    }

    /// Splits off the parts beyond each end of a concave interval, as seen from `start`, and keeps
    /// the rest as one node.
    fn split_concave(
        &mut self,
        ends: &[(usize, usize, f64)],
        region: &DifferenceBounds,
        bound: f64,
        start: &[f64],
    ) {
        let mut rest = Some(region.clone());
        for &(from, to, at) in ends {
            let Some(region) = rest else { return };
            self.effort.spend((start.len() * start.len()) as u64 / 4);
            let below = region.below(from, to, at);
            let above = region.above(from, to, at);
            let (inner, outer) = if start[to] - start[from] < at {
                (below, above)
            } else {
                (above, below)
            };
            self.push(outer, bound, start);
            rest = inner;
        }
        self.push(rest, bound, start);
    }

    fn push(&mut self, region: Option<DifferenceBounds>, bound: f64, start: &[f64]) {
        if let Some(region) = region {
            self.open.push(Node {
                bound,
                region,
                start: start.to_vec(),
            });
        }
    }

    /// Line 10.
    fn found(mut self) -> Minima {
        let left = self.open.least_bound();
        let cutoff = self.cutoff();
        // A sum of squares is never negative, and no bound exceeds a value that was reached.
        let lower_bound = self.closed.min(left).max(0.0).min(self.best);
        let gap = (self.best - lower_bound) / self.denominator();
        let limit = if gap <= PROOF {
            None
        } else if self.open.is_full() {
            Some(Limit::Memory)
        } else if left < self.closed {
            Some(Limit::Work)
        } else {
            Some(Limit::Rounding)
        };
        self.minima.sort_by(|a, b| a.1.total_cmp(&b.1));
        // The best itself always stays in the list.
        let kept = self
            .minima
            .iter()
            .take_while(|(_, value)| *value <= cutoff)
            .count()
            .max(1);
        self.minima.truncate(kept);
        Minima {
            minima: self.minima,
            lower_bound,
            gap,
            limit,
            nodes: self.nodes,
            all_minima: self.all_minima && left >= cutoff,
        }
    }
}

/// Relative gap that counts as a proof.
pub(crate) const PROOF: f64 = 1e-9;

/// Budget of the search for a proof, counted instead of timed so that results repeat.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ProofBudget {
    /// Total work, in evaluations of one term of the objective (20 to 30 ns on one core). A step in
    /// progress is completed.
    pub work: u64,
    /// Work after the proof, to find every other local minimum within 1 %.
    pub listing: u64,
    /// Memory of the open nodes, in bytes.
    pub bytes: usize,
}

impl Default for ProofBudget {
    /// About two seconds on one core and 64 MB, far more than a condition with constrained on-axis
    /// responses needs; at most some milliseconds for the other minima.
    fn default() -> Self {
        Self {
            work: 80_000_000,
            listing: 200_000,
            bytes: 64_000_000,
        }
    }
}

/// Limit that ended a search before the proof.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Limit {
    /// [`ProofBudget::work`].
    Work,
    /// [`ProofBudget::bytes`].
    Memory,
    /// Double precision: no sharper bound is possible.
    Rounding,
}

/// The search was stopped from outside.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct SearchStopped;

/// Counts the work of one search, and polls at intervals whether to stop.
pub(crate) struct Effort<'a> {
    stop: &'a dyn Fn() -> bool,
    work: Cell<u64>,
    asked_at: Cell<u64>,
    stopped: Cell<bool>,
}

impl<'a> Effort<'a> {
    /// Work between two polls: half a millisecond.
    const ASKING: u64 = 20_000;

    /// Starts with no work spent.
    pub(crate) fn new(stop: &'a dyn Fn() -> bool) -> Self {
        Self {
            stop,
            work: Cell::new(0),
            asked_at: Cell::new(0),
            stopped: Cell::new(stop()),
        }
    }

    /// Counts `work`.
    pub(crate) fn spend(&self, work: u64) {
        let spent = self.work.get() + work;
        self.work.set(spent);
        if spent - self.asked_at.get() >= Self::ASKING {
            self.asked_at.set(spent);
            self.stopped.set(self.stopped.get() || (self.stop)());
        }
    }

    /// Total work so far.
    pub(crate) fn spent(&self) -> u64 {
        self.work.get()
    }

    /// Whether a stop was requested.
    pub(crate) fn is_stopped(&self) -> bool {
        self.stopped.get()
    }

    /// Returns an error where a stop was requested.
    pub(crate) fn check(&self) -> Result<(), SearchStopped> {
        if self.is_stopped() {
            Err(SearchStopped)
        } else {
            Ok(())
        }
    }
}

/// A part of the box that is still to be searched.
pub(super) struct Node {
    /// Lower bound of the objective over the part.
    pub(super) bound: f64,
    pub(super) region: DifferenceBounds,
    /// Start of the search for the underestimator's minimum.
    pub(super) start: Vec<f64>,
}

impl PartialEq for Node {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Node {}

impl PartialOrd for Node {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Node {
    /// Reversed order, so that the heap returns the least bound first.
    fn cmp(&self, other: &Self) -> Ordering {
        other.bound.total_cmp(&self.bound)
    }
}

/// The open nodes, least bound first, in limited memory.
pub(super) struct OpenNodes {
    heap: BinaryHeap<Node>,
    most: usize,
    /// Least bound of the nodes refused for lack of memory.
    refused: f64,
}

impl OpenNodes {
    /// Empty heap of nodes with `scales` scales each, in at most `bytes` bytes; there is always
    /// room for one node.
    pub(super) fn new(scales: usize, bytes: usize) -> Self {
        // Twice the overhead of an allocation, and the growth of the heap, which doubles its
        // memory.
        let of_node = DifferenceBounds::bytes(scales)
            + scales * size_of::<f64>()
            + 32
            + 3 * size_of::<Node>();
        Self {
            heap: BinaryHeap::new(),
            most: (bytes / of_node).max(1),
            refused: f64::INFINITY,
        }
    }

    /// Adds a node, or only its bound where memory is exhausted.
    pub(super) fn push(&mut self, node: Node) {
        if self.heap.len() < self.most {
            self.heap.push(node);
        } else {
            self.refused = self.refused.min(node.bound);
        }
    }

    /// Whether a node was refused for lack of memory.
    pub(super) fn is_full(&self) -> bool {
        self.refused < f64::INFINITY
    }

    /// Removes the node of least bound.
    pub(super) fn pop(&mut self) -> Option<Node> {
        self.heap.pop()
    }

    /// Least bound of all nodes, refused ones included; infinite where there are none.
    pub(super) fn least_bound(&self) -> f64 {
        self.heap
            .peek()
            .map_or(f64::INFINITY, |node| node.bound)
            .min(self.refused)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nodes_beyond_the_memory_leave_their_bound_only() {
        let node = |bound: f64| Node {
            bound,
            region: DifferenceBounds::of_box(&[0.0; 20], &[0.0; 20]),
            start: vec![0.0; 20],
        };
        let mut open = OpenNodes::new(20, 40_000);
        let kept = (0..100).take_while(|&index| {
            open.push(node(100.0 - f64::from(index)));
            !open.is_full()
        });
        // 400 differences of 8 bytes, and the rest of a node.
        let kept = kept.count();
        assert!((9..=12).contains(&kept), "{kept}");
        assert_eq!(open.least_bound(), 100.0 - kept as f64);
        assert_eq!(open.pop().map(|node| node.bound), Some(101.0 - kept as f64));
    }
}
