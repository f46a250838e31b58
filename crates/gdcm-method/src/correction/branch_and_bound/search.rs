//! Branch-and-bound search for the global minimum and for the other minima within 1 % above it: the
//! loop of the algorithm in [`super`], which defines scales, terms and nodes.
//!
//! ```text
//! proof     until the lowest open bound reaches `aim`, just below the best minimum, now proven
//! listing   then until it reaches `cutoff`, 1 % above: the local minima up to there are listed
//! close     a node without a minimum to be found: only its bound remains, in `closed`
//! keep      a node whose bound reaches `aim` during the proof: it waits for the listing
//! branch    any other node: split it into parts, which are open nodes in turn
//! ```

use super::convex_bound::tangent_bound;
use super::difference_bounds::DifferenceBounds;
use super::effort::{Effort, MULTIPLY_ADDS, SearchStopped};
use super::expansion::{Curvature, Differentiable, Expansion, ScaleBox};
use super::newton::Newton;
use super::node_exclusion::NodeExclusion;
use super::objective::Objective;
use super::open_nodes::{Node, OpenNodes};
use super::proof_budget::{Limit, ProofBudget};
use super::underestimator::{ConcaveEnd, Underestimator};

/// Relative gap that is accepted as a proof.
pub(crate) const PROOF: f64 = 1e-9;
/// Relative gap at which branching stops, well below [`PROOF`].
const AIM: f64 = 2e-10;
/// Minima up to this factor above the best are listed.
const NEAR: f64 = 1.01;

/// How much of a node's bound may be lost by ending Newton's method early: relative to the desired
/// gap or, if the node will be branched anyway, to the distance between the bound and its goal. A
/// compromise: a smaller value needs more Newton steps, a larger one more nodes.
const ACCEPTED_LOSS: f64 = 0.05;
/// Maximum difference between the scales of two minima that count as duplicates.
const SAME_MINIMUM: f64 = 1e-6;
/// Minimum distance between the split point and either end, relative to a term's range, so that
/// each part has at most 85 % of the range.
const SPLIT_MARGIN: f64 = 0.15;
/// Minimum range width for splitting a term's range.
const LEAST_SPLIT_WIDTH: f64 = 1e-11;
/// Minimum distance between a term and its envelope, relative to the gap's denominator, for
/// branching at that term; smaller distances are negligible beside [`AIM`].
const LEAST_ENVELOPE_GAP: f64 = 1e-13;
/// Ratio between the underestimators' outer curvature and the objective's largest Hessian entry, by
/// magnitude, at the best minimum. It is well above 1 for the reason given at
/// [`Search::outer_curvature`].
const OUTER_CURVATURE_RATIO: f64 = 8.0;

#[derive(Clone, Debug)]
pub(crate) struct Minimum {
    pub(crate) scales: Vec<f64>,
    /// Objective at the minimum.
    pub(crate) value: f64,
}

#[derive(Clone, Debug)]
pub(crate) struct Minima {
    /// Distinct local minima within 1 % above the best, best first.
    pub(crate) minima: Vec<Minimum>,
    /// Lower bound on the objective over the whole box.
    pub(crate) lower_bound: f64,
    /// `(best - lower_bound) / max(best, floor)`.
    pub(crate) gap: f64,
    /// Limit that ended the search; `None` if the gap is a proof.
    pub(crate) limit: Option<Limit>,
    pub(crate) nodes: usize,
    /// Whether the list is complete: no other local minimum lies within 1 % above the best.
    pub(crate) all_minima: bool,
}

/// Finds the global minimum of `objective` over its box, with a rigorous lower bound, by the
/// algorithm in [`super`].
///
/// Newton's method begins at `start`. `floor` is the objective's rounding level: the gap is
/// relative to the larger of the best value and `floor`.
///
/// # Errors
/// [`SearchStopped`] if the search was stopped by its caller.
pub(crate) fn search(
    objective: &Objective,
    start: &[f64],
    budget: ProofBudget,
    floor: f64,
    effort: &Effort<'_>,
) -> Result<Minima, SearchStopped> {
    let mut search = Search::new(objective, budget, floor, effort);
    search.run(start)?;
    Ok(search.into_minima())
}

/// A search in progress; the line numbers in its comments refer to the algorithm in [`super`].
struct Search<'a> {
    objective: &'a Objective,
    exclusion: NodeExclusion<'a>,
    budget: ProofBudget,
    floor: f64,
    effort: &'a Effort<'a>,
    newton: Newton<'a>,
    /// Distinct local minima, in the order in which they were found.
    minima: Vec<Minimum>,
    /// Objective at the best minimum.
    best: f64,
    open: OpenNodes,
    /// Minimum bound over the closed nodes.
    closed: f64,
    nodes: usize,
    /// Work spent until the best minimum was proven; `None` before the proof.
    proven_at: Option<u64>,
    /// `false` once a node that could contain a further local minimum has been closed.
    all_minima: bool,
    /// Scratch memory: lower bound on each scale in a part of the box.
    lower: Vec<f64>,
    /// Scratch memory: upper bound on each scale in a part of the box.
    upper: Vec<f64>,
    /// Underestimators' curvature outside their terms' ranges in the node. It is well above the
    /// objective's curvature at the best minimum, so that next to a minimum a node's bound is
    /// attained at the node's edge.
    outer_curvature: f64,
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
            outer_curvature: 0.0,
        }
    }

    /// Lines 1 to 3: searches best-first, until the best minimum is proven and then until the other
    /// minima are listed.
    fn run(&mut self, start: &[f64]) -> Result<(), SearchStopped> {
        self.descend(start);
        let region = DifferenceBounds::from_box(&self.objective.lower, &self.objective.upper);
        self.open.push(Node {
            bound: 0.0,
            region,
            start: self.minima[0].scales.clone(),
        });
        loop {
            self.effort.check()?;
            let bound = self.open.least_bound();
            if bound >= self.aim() && self.proven_at.is_none() {
                self.proven_at = Some(self.effort.spent());
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

    /// Returns whether the budget for the proof, for the listing or for memory is exhausted.
    fn is_spent(&self) -> bool {
        let spent = self.effort.spent();
        let is_listing_spent = match self.proven_at {
            Some(proven_at) => spent - proven_at >= self.budget.listing,
            None => false,
        };
        is_listing_spent || spent >= self.budget.work || self.open.is_full()
    }

    /// Returns the relative gap's denominator.
    fn denominator(&self) -> f64 {
        self.best.max(self.floor)
    }

    /// Returns the lower bound at which the best minimum is proven.
    fn aim(&self) -> f64 {
        self.best - AIM * self.denominator()
    }

    /// Returns the bound above which no minimum is listed.
    fn cutoff(&self) -> f64 {
        NEAR * self.best + AIM * self.denominator()
    }

    /// Lines 4 to 9: bounds a node, and closes, keeps or branches it.
    fn visit(&mut self, node: Node) {
        self.nodes += 1;
        let Node {
            bound,
            region,
            mut start,
        } = node;
        // Line 4.
        let listing = self.proven_at.is_some();
        if listing && self.is_searched(&region) {
            return self.close(bound);
        }
        // Line 5: afterwards, `start` is the tangent point.
        self.effort
            .spend(Underestimator::WORK_PER_TERM * self.objective.work());
        let underestimator = Underestimator::new(self.objective, &region, self.outer_curvature);
        let goal = if listing { self.cutoff() } else { self.aim() };
        let bound = bound.max(self.lower_bound(&underestimator, &region, &mut start, goal));
        if bound >= self.cutoff() {
            return self.close(bound);
        }
        // Line 6
        let known_minima = self.minima.len();
        if self.may_lead_to_a_minimum(&start, &region) {
            self.descend(&start);
        }
        if bound >= self.aim() {
            // Line 7: line 4 can apply now only if line 6 has found another minimum.
            if underestimator.is_exact()
                || (listing && self.minima.len() > known_minima && self.is_searched(&region))
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
        } else if let Some(convex) = self.convex_bound(&region, underestimator.is_exact())
            && convex >= self.aim()
        {
            // Line 8.
            return self.close(bound.max(convex));
        }
        self.branch(&underestimator, &region, bound, &start);
    }

    /// Closes a node that has this lower bound.
    fn close(&mut self, bound: f64) {
        self.closed = self.closed.min(bound);
    }

    /// Line 5: returns the largest lower bound found by Newton's method on the underestimator.
    /// Moves `start` to the last point, near the underestimator's minimum.
    ///
    /// `goal` is the bound above which the node need not be branched. Newton's method ends early if
    /// the bound
    ///
    /// - reaches the cutoff, so that the node is closed,
    /// - is so far below `goal` that the node will be branched anyway, or
    /// - is as sharp as desired, or as rounding permits;
    ///
    /// and if the work budget is exhausted.
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
        let tolerance = ACCEPTED_LOSS * AIM * self.denominator();
        let effort = self.effort;
        let work_budget = self.budget.work;
        let bounds = ScaleBox {
            lower: &self.lower,
            upper: &self.upper,
        };
        let exact = underestimator.is_exact();
        let mut highest = f64::NEG_INFINITY;
        self.newton
            .minimise(underestimator, bounds, start, |scales, at| {
                highest = highest.max(tangent_bound(scales, at, bounds));
                let loss = at.value.value - highest;
                let branched_anyway = !exact && loss <= ACCEPTED_LOSS * (goal - at.value.value);
                let sharp = loss <= tolerance.max(2.0 * at.value.error);
                highest >= cutoff || branched_anyway || sharp || effort.spent() >= work_budget
            });
        highest
    }

    /// Line 6: returns whether a descent from `start` may lead to a better minimum, or to a new one
    /// below the cutoff. The start may be slightly higher than the minimum: up to 1 % above the
    /// cutoff.
    fn may_lead_to_a_minimum(&self, start: &[f64], region: &DifferenceBounds) -> bool {
        let value = self.objective.value(start);
        value < self.best || (value < NEAR * self.cutoff() && !self.has_minimum_in(region))
    }

    /// Line 6: minimises the objective from `start` over the whole box, and stores the minimum if
    /// it is new or lower than its duplicate. Updates `best`, and `outer_curvature` if the minimum
    /// is the new best.
    fn descend(&mut self, start: &[f64]) {
        let mut scales = start.to_vec();
        self.newton.minimise(
            self.objective,
            self.objective.bounds(),
            &mut scales,
            |_, _| false,
        );
        let value = self.newton.reached.value.value;
        if value < self.best {
            let curvature = self
                .newton
                .reached
                .hessian
                .iter()
                .fold(0.0_f64, |most, entry| most.max(entry.abs()));
            self.outer_curvature = OUTER_CURVATURE_RATIO * curvature;
        }
        self.effort
            .spend((self.minima.len() * self.objective.terms.len()) as u64);
        let found = Minimum { scales, value };
        let known = self
            .minima
            .iter()
            .position(|known| self.are_duplicates(&known.scales, &found.scales));
        match known {
            Some(known) if value < self.minima[known].value => self.minima[known] = found,
            Some(_) => {}
            None => self.minima.push(found),
        }
        self.best = self.best.min(value);
    }

    /// Returns whether two minima are duplicates: equal up to 1e-6, or so close that the terms'
    /// curvature at `known` raises the objective between them by at most the desired gap.
    fn are_duplicates(&self, known: &[f64], found: &[f64]) -> bool {
        let mut longest = 0.0_f64;
        let mut rise = 0.0;
        for term in &self.objective.terms {
            let here = term.difference(known);
            let there = term.difference(found);
            let change = (there - here).abs();
            longest = longest.max(change);
            rise += 0.5 * term.function.evaluate(here).curvature.abs() * change * change;
        }
        longest <= SAME_MINIMUM || rise <= AIM * self.denominator()
    }

    /// Returns whether any known minimum is inside the region.
    fn has_minimum_in(&self, region: &DifferenceBounds) -> bool {
        let scales = self.objective.scales();
        self.effort
            .spend((self.minima.len() * scales * scales) as u64 / MULTIPLY_ADDS);
        self.minima
            .iter()
            .any(|minimum| region.contains(&minimum.scales))
    }

    /// Line 8: bounds a node with the gradient and the Hessian at the best minimum; `None` if the
    /// objective is not convex over the hull around node and minimum. `exact` states that every
    /// term is convex over the node.
    fn convex_bound(&mut self, region: &DifferenceBounds, exact: bool) -> Option<f64> {
        let best = self
            .minima
            .iter()
            .min_by(|a, b| a.value.total_cmp(&b.value))?;
        let scales = &best.scales;
        let hull = region.hull(scales);
        self.effort.spend(2 * self.exclusion.work());
        if !(exact && region.contains(scales) || self.exclusion.is_convex(&hull)) {
            return None;
        }
        let mut at = Expansion::zero(scales.len());
        self.objective.expand(scales, Curvature::True, &mut at);
        hull.write_box(&mut self.lower, &mut self.upper);
        let bounds = ScaleBox {
            lower: &self.lower,
            upper: &self.upper,
        };
        let tangent = tangent_bound(scales, &at, bounds);
        match self.exclusion.bound_at(scales, &at) {
            Some(quadratic) => Some(quadratic.max(tangent)),
            None => Some(tangent),
        }
    }

    /// Line 4: returns whether the node contains no local minimum other than those already found.
    fn is_searched(&self, region: &DifferenceBounds) -> bool {
        self.effort.spend(self.exclusion.work());
        if self.exclusion.has_no_minimum(region) {
            return true;
        }
        for minimum in &self.minima {
            self.effort.spend(2 * self.exclusion.work());
            if self.exclusion.has_only(region, &minimum.scales) {
                return true;
            }
        }
        false
    }

    /// Line 9: branches the node, by the first of these that applies:
    ///
    /// - before the proof, at the term whose envelope loses most of the node's bound;
    /// - at a concave interval's end (in the listing, at all ends), to separate convex from concave
    ///   parts;
    /// - at the term whose slope varies most.
    ///
    /// Closes the node if there is no such term, or the term's range is too narrow to be split.
    fn branch(
        &mut self,
        underestimator: &Underestimator<'_>,
        region: &DifferenceBounds,
        bound: f64,
        start: &[f64],
    ) {
        self.effort
            .spend(4 * self.objective.work() + split_work(start.len()));
        let listing = self.proven_at.is_some();
        let mut term = None;
        if !listing {
            term = underestimator.widest_gap(start, LEAST_ENVELOPE_GAP * self.denominator());
        }
        if term.is_none() {
            let ends = underestimator.concave_ends(start);
            if !ends.is_empty() {
                let count = if listing { ends.len() } else { 1 };
                return self.split_concave(&ends[..count], region, bound, start);
            }
            term = underestimator.widest_slope();
        }
        if let Some(term) = term {
            let range = region.range(term.from, term.to);
            if range.width() > LEAST_SPLIT_WIDTH {
                let margin = SPLIT_MARGIN * range.width();
                let split = term
                    .difference(start)
                    .clamp(range.low + margin, range.high - margin);
                self.push(region.below(term.from, term.to, split), bound, start);
                self.push(region.above(term.from, term.to, split), bound, start);
                return;
            }
        }
        // Not branched: the bound is as sharp as rounding permits. The node, even if closed before
        // the proof, could contain a further minimum within 1 % above the best.
        self.all_minima = false;
        self.close(bound);
    }

    /// Splits the region at each concave interval's end. The part on the far side from `start`
    /// becomes a node; the rest remains a single node.
    fn split_concave(
        &mut self,
        ends: &[ConcaveEnd],
        region: &DifferenceBounds,
        bound: f64,
        start: &[f64],
    ) {
        let mut near_start = Some(region.clone());
        for end in ends {
            let Some(rest) = near_start else { return };
            self.effort.spend(split_work(start.len()));
            let below = rest.below(end.from, end.to, end.at);
            let above = rest.above(end.from, end.to, end.at);
            let far_side;
            if start[end.to] - start[end.from] < end.at {
                near_start = below;
                far_side = above;
            } else {
                near_start = above;
                far_side = below;
            }
            self.push(far_side, bound, start);
        }
        self.push(near_start, bound, start);
    }

    /// Adds a part of the box to the open nodes, unless it is empty.
    fn push(&mut self, region: Option<DifferenceBounds>, bound: f64, start: &[f64]) {
        if let Some(region) = region {
            self.open.push(Node {
                bound,
                region,
                start: start.to_vec(),
            });
        }
    }

    /// Line 10: returns the lower bound, and the minima within 1 % above the best.
    ///
    /// If the gap is no proof, the limit is the memory if a node was rejected, else the work if an
    /// open node has the lowest bound, else the rounding.
    fn into_minima(mut self) -> Minima {
        let left = self.open.least_bound();
        let cutoff = self.cutoff();
        // Limit the bound: a sum of squares is never negative, and no bound exceeds a value that
        // was reached.
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
        self.minima.sort_by(|a, b| a.value.total_cmp(&b.value));
        let within = self
            .minima
            .partition_point(|minimum| minimum.value <= cutoff);
        // `max(1)`: keep at least the best minimum.
        self.minima.truncate(within.max(1));
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

/// Returns the work for splitting a node, in term evaluations: both parts copy and tighten the
/// bounds on all differences between two scales, which counts as four multiply-adds for each.
fn split_work(scales: usize) -> u64 {
    (scales * scales) as u64 / (MULTIPLY_ADDS / 4)
}
