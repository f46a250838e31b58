//! Branch and bound over the box of the scales.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use super::descent::Descent;
use super::landscape::{Landscape, Slope, Slopes};
use super::region::Region;
use super::relaxation::Relaxation;

/// Minima within this factor of the best are kept.
const NEAR: f64 = 1.01;

/// How far the search goes.
#[derive(Clone, Copy)]
pub(crate) struct Effort<'a> {
    /// Regions to visit at most.
    pub(crate) boxes: usize,
    /// Objective below which the gap is no longer relative: what rounding allows.
    pub(crate) floor: f64,
    /// Asked before each region.
    pub(crate) stop: &'a dyn Fn() -> bool,
}

/// What the search found.
#[derive(Clone, Debug)]
pub(crate) struct Found {
    /// Distinct local minima within 1 % of the best, best first, each with its value.
    pub(crate) minima: Vec<(Vec<f64>, f64)>,
    /// No point of the box is below this.
    pub(crate) lower_bound: f64,
    /// `(best - lower_bound) / max(best, floor)`.
    pub(crate) gap: f64,
    /// Regions visited.
    pub(crate) boxes: usize,
    /// Whether there can be no other local minimum within 1 %.
    pub(crate) all_minima: bool,
}

/// A relative gap that counts as proof.
pub(crate) const PROOF: f64 = 1e-9;

/// The search stops splitting at this gap, to end safely below [`PROOF`].
const AIM: f64 = 2e-10;

struct Open {
    bound: f64,
    region: Region,
    start: Vec<f64>,
}

impl PartialEq for Open {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}
impl Eq for Open {}
impl PartialOrd for Open {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}
impl Ord for Open {
    /// The least bound is the greatest, so that a heap gives it first.
    fn cmp(&self, other: &Self) -> Ordering {
        other.bound.total_cmp(&self.bound)
    }
}

/// Finds the global minimum of `landscape` over its box, with a rigorous lower bound.
///
/// Each region is bounded by the tangent plane of a convex relaxation, less the rounding of every figure in it; a region where
/// the objective is convex and holds a local minimum is closed by that minimum. Regions are split at a difference of scales.
pub(crate) fn search(landscape: &Landscape, effort: Effort<'_>) -> Found {
    let mut search = Search::new(landscape, effort);
    search.run();
    search.found()
}

struct Search<'a> {
    landscape: &'a Landscape,
    effort: Effort<'a>,
    descent: Descent,
    minima: Vec<(Vec<f64>, f64)>,
    best: f64,
    /// Least bound of the regions that are closed.
    closed: f64,
    open: BinaryHeap<Open>,
    boxes: usize,
    lower: Vec<f64>,
    upper: Vec<f64>,
    bend: Vec<f64>,
    anchored: Vec<bool>,
    /// Curvature of a relaxation beyond its region: well above the landscape's own, so that the part of the box next to a
    /// minimum is bounded by its own edge.
    fence: f64,
}

impl<'a> Search<'a> {
    fn new(landscape: &'a Landscape, effort: Effort<'a>) -> Self {
        let nodes = landscape.nodes();
        Self {
            landscape,
            effort,
            descent: Descent::new(nodes),
            minima: Vec::new(),
            best: f64::INFINITY,
            closed: f64::INFINITY,
            open: BinaryHeap::new(),
            boxes: 0,
            lower: landscape.lower.clone(),
            upper: landscape.upper.clone(),
            bend: vec![0.0; nodes],
            anchored: anchored(landscape),
            fence: 0.0,
        }
    }

    fn run(&mut self) {
        let region = Region::of_box(&self.landscape.lower, &self.landscape.upper);
        self.descend(&self.nearest_to_zero());
        let start = self.minima[0].0.clone();
        self.open.push(Open {
            bound: 0.0,
            region,
            start,
        });
        let mut listing = 0;
        while let Some(top) = self.open.peek() {
            // Proven: what is left only serves to list the other minima, with a tenth of the budget.
            if top.bound >= self.aim() {
                listing += 1;
            }
            let spent = self.boxes >= self.effort.boxes || listing > self.effort.boxes / 10;
            if top.bound >= self.cutoff() || spent || (self.effort.stop)() {
                break;
            }
            if let Some(open) = self.open.pop() {
                self.visit(open);
            }
        }
    }

    fn nearest_to_zero(&self) -> Vec<f64> {
        self.landscape
            .lower
            .iter()
            .zip(&self.landscape.upper)
            .map(|(low, high)| 0.0_f64.clamp(*low, *high))
            .collect()
    }

    fn denominator(&self) -> f64 {
        self.best.max(self.effort.floor)
    }

    /// A bound this high proves the best.
    fn aim(&self) -> f64 {
        self.best - AIM * self.denominator()
    }

    /// A bound this high leaves no minimum worth listing.
    fn cutoff(&self) -> f64 {
        if self.best.is_finite() {
            (NEAR * self.best).max(self.best + AIM * self.denominator())
        } else {
            f64::INFINITY
        }
    }

    fn visit(&mut self, open: Open) {
        self.boxes += 1;
        let Open {
            bound,
            region,
            mut start,
        } = open;
        let relaxation = Relaxation::new(self.landscape, &region, self.fence);
        let bound = bound.max(self.bound_region(&relaxation, &region, &mut start));
        if bound >= self.cutoff() {
            self.close(bound);
            return;
        }
        let known = self.minimum_in(&region).is_some();
        if !known || self.landscape.value(&start) < self.best {
            self.descend(&start);
        }
        if bound >= self.cutoff() || (bound >= self.aim() && relaxation.is_exact()) {
            self.close(bound);
            return;
        }
        if let Some(convex) = self.close_convex(&region) {
            self.close(bound.max(convex));
            return;
        }
        self.split(&relaxation, region, bound, &start);
    }

    fn close(&mut self, bound: f64) {
        self.closed = self.closed.min(bound);
    }

    /// The best lower bound that a descent on the relaxation gives; `start` ends at its minimum.
    fn bound_region(&mut self, relaxation: &Relaxation<'_>, region: &Region, start: &mut [f64]) -> f64 {
        region.write_box(&mut self.lower, &mut self.upper);
        for (node, scale) in start.iter_mut().enumerate() {
            *scale = scale.clamp(self.lower[node], self.upper[node]);
        }
        relaxation.ground_curvature(&mut self.bend);
        let (cutoff, aim, tolerance) = (self.cutoff(), self.aim(), 0.05 * AIM * self.denominator());
        let (lower, upper, bend) = (&self.lower, &self.upper, &self.bend);
        let exact = relaxation.is_exact();
        let mut best = f64::NEG_INFINITY;
        self.descent.run(relaxation, (lower, upper), start, |scales, slopes| {
            let bound = tangent_bound(scales, slopes, (lower, upper), bend);
            best = best.max(bound);
            let loss = slopes.value - best;
            // A region that will be split anyway needs no sharper bound than its distance from the goal.
            let split_anyway = !exact && loss <= 0.02 * (aim - slopes.value);
            best >= cutoff || split_anyway || loss <= tolerance.max(2.0 * slopes.value_error)
        });
        best
    }

    /// Follows the landscape down from `start` over the whole box, and keeps the minimum if it is new and good.
    fn descend(&mut self, start: &[f64]) {
        let mut scales = start.to_vec();
        let (lower, upper) = (&self.landscape.lower, &self.landscape.upper);
        self.descent
            .run(self.landscape, (lower, upper), &mut scales, |_, _| false);
        let value = self.descent.slopes.value;
        if value < self.best {
            let curvature = self
                .descent
                .slopes
                .curvature
                .iter()
                .fold(0.0_f64, |most, entry| most.max(entry.abs()));
            self.fence = 8.0 * curvature;
        }
        let same = |(known, _): &(Vec<f64>, f64)| {
            self.landscape.links.iter().all(|link| {
                let change = (scales[link.to] - scales[link.from]) - (known[link.to] - known[link.from]);
                change.abs() <= 1e-6
            })
        };
        if let Some(position) = self.minima.iter().position(same) {
            if value < self.minima[position].1 {
                self.minima[position] = (scales, value);
            }
        } else {
            self.minima.push((scales, value));
        }
        self.best = self.best.min(value);
    }

    fn minimum_in(&self, region: &Region) -> Option<&(Vec<f64>, f64)> {
        self.minima.iter().find(|(scales, _)| region.holds(scales))
    }

    /// The bound of a region on which the landscape is convex and that holds a local minimum: the tangent plane there.
    fn close_convex(&mut self, region: &Region) -> Option<f64> {
        let scales = self.minimum_in(region)?.0.clone();
        if !is_convex(self.landscape, region, &self.anchored) {
            return None;
        }
        let mut slopes = Slopes::zero(scales.len());
        self.landscape
            .slopes(&scales, super::landscape::Bend::True, &mut slopes);
        self.bend.fill(0.0);
        region.write_box(&mut self.lower, &mut self.upper);
        Some(tangent_bound(&scales, &slopes, (&self.lower, &self.upper), &self.bend))
    }

    fn split(&mut self, relaxation: &Relaxation<'_>, region: Region, bound: f64, start: &[f64]) {
        let Some((index, gap)) = relaxation.widest_gap(start) else {
            self.close(bound);
            return;
        };
        let link = &self.landscape.links[index];
        let (low, high) = region.range(link.from, link.to);
        if gap <= 1e-13 * self.denominator() || high - low <= 1e-9 {
            // Nothing is left to gain: the bound is as sharp as rounding allows.
            self.close(bound);
            return;
        }
        let margin = 0.15 * (high - low);
        let at = (start[link.to] - start[link.from]).clamp(low + margin, high - margin);
        let (below, above) = (
            region.below(link.from, link.to, at),
            region.above(link.from, link.to, at),
        );
        for part in [below, above].into_iter().flatten() {
            self.open.push(Open {
                bound,
                region: part,
                start: start.to_vec(),
            });
        }
    }

    fn found(mut self) -> Found {
        let left = self.open.peek().map_or(f64::INFINITY, |open| open.bound);
        let all_minima = left >= self.cutoff();
        // A sum of squares is never negative, and no bound can be above a value that was reached.
        let lower_bound = self.closed.min(left).max(0.0).min(self.best);
        let gap = (self.best - lower_bound) / self.denominator();
        let near = NEAR * self.best + AIM * self.denominator();
        self.minima.sort_by(|a, b| a.1.total_cmp(&b.1));
        // The best itself always stays.
        let kept = self
            .minima
            .iter()
            .take_while(|(_, value)| *value <= near)
            .count()
            .max(1);
        self.minima.truncate(kept);
        Found {
            minima: self.minima,
            lower_bound,
            gap,
            boxes: self.boxes,
            all_minima,
        }
    }
}

/// A lower bound over a box of a function that is convex there, from its tangent plane at `scales` (inside the box), plus the
/// curvature `bend` that each scale has of its own, less the rounding of the value and of every slope.
fn tangent_bound(scales: &[f64], slopes: &Slopes, (lower, upper): (&[f64], &[f64]), bend: &[f64]) -> f64 {
    let mut bound = slopes.value - slopes.value_error;
    for node in 0..scales.len() {
        let (slope, error) = (slopes.gradient[node], slopes.gradient_error[node]);
        let down = least_parabola(-(slope + error), bend[node], scales[node] - lower[node]);
        let up = least_parabola(slope - error, bend[node], upper[node] - scales[node]);
        bound += down.min(up);
    }
    bound - 32.0 * f64::EPSILON * bound.abs()
}

/// Least value of `slope t + bend t^2 / 2` over `0 <= t <= reach`.
fn least_parabola(slope: f64, bend: f64, reach: f64) -> f64 {
    if slope >= 0.0 || reach <= 0.0 {
        return 0.0;
    }
    let t = if bend * reach > -slope { -slope / bend } else { reach };
    slope * t + 0.5 * bend * t * t
}

/// One node of each piece that is not tied to the ground: the landscape depends on differences only there.
fn anchored(landscape: &Landscape) -> Vec<bool> {
    let mut anchored = vec![false; landscape.nodes()];
    anchored[landscape.ground()] = true;
    for (nodes, grounded) in landscape.pieces() {
        if !grounded {
            anchored[nodes[0]] = true;
        }
    }
    anchored
}

/// Whether the landscape is convex over the region: the Hessian with every link's least curvature is positive definite on the
/// scales that are not anchored, and the true one differs from it by a positive semidefinite matrix.
fn is_convex(landscape: &Landscape, region: &Region, anchored: &[bool]) -> bool {
    let mut least = Slopes::zero(landscape.nodes());
    for link in &landscape.links {
        let (low, high) = region.range(link.from, link.to);
        let curvature = link.shape.least_curvature(low, high.max(low));
        least.add(link, 0.0, curvature.abs(), curvature);
    }
    let free: Vec<usize> = (0..landscape.nodes()).filter(|&node| !anchored[node]).collect();
    let nodes = landscape.nodes();
    let matrix = nalgebra::DMatrix::from_fn(free.len(), free.len(), |row, column| {
        let entry = least.curvature[free[row] * nodes + free[column]];
        // A margin a hundred times the rounding of the sums and of the factorisation.
        if row == column {
            entry - 1e-13 * nodes as f64 * least.gradient_error[free[row]]
        } else {
            entry
        }
    });
    free.is_empty() || matrix.cholesky().is_some()
}
