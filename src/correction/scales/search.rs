//! Branch and bound over the box of the scales.

use std::collections::BinaryHeap;

use super::bound::tangent_bound;
use super::descent::Descent;
use super::found::{Effort, Found};
use super::landscape::{Bend, Landscape, Slope, Slopes};
use super::open::Open;
use super::region::Region;
use super::relaxation::Relaxation;
use super::terrain::Terrain;

/// Minima within this factor of the best are kept.
const NEAR: f64 = 1.01;

/// The search stops splitting at this gap, to end safely below [`super::PROOF`].
const AIM: f64 = 2e-10;

/// Finds the global minimum of `landscape` over its box, with a rigorous lower bound.
///
/// Each region is bounded by the tangent plane of a convex relaxation, less the rounding of every figure in it; a region where
/// the objective is convex and holds a local minimum is closed by that minimum. Regions are split at a difference of scales.
/// Once the best is proven, what is left is searched for other local minima within 1 %.
pub(crate) fn search(landscape: &Landscape, effort: Effort<'_>) -> Found {
    let mut search = Search::new(landscape, effort);
    search.run();
    search.found()
}

struct Search<'a> {
    landscape: &'a Landscape,
    terrain: Terrain<'a>,
    effort: Effort<'a>,
    descent: Descent,
    minima: Vec<(Vec<f64>, f64)>,
    best: f64,
    /// Least bound of the regions that are closed.
    closed: f64,
    open: BinaryHeap<Open>,
    boxes: usize,
    /// Whether no region was closed that may hold an unknown local minimum.
    all_minima: bool,
    lower: Vec<f64>,
    upper: Vec<f64>,
    /// Curvature of a relaxation beyond its region: well above the landscape's own, so that the part of the box next to a
    /// minimum is bounded by its own edge.
    fence: f64,
}

impl<'a> Search<'a> {
    fn new(landscape: &'a Landscape, effort: Effort<'a>) -> Self {
        let nodes = landscape.nodes();
        Self {
            landscape,
            terrain: Terrain::new(landscape),
            effort,
            descent: Descent::new(nodes),
            minima: Vec::new(),
            best: f64::INFINITY,
            closed: f64::INFINITY,
            open: BinaryHeap::new(),
            boxes: 0,
            all_minima: true,
            lower: landscape.lower.clone(),
            upper: landscape.upper.clone(),
            fence: 0.0,
        }
    }

    fn run(&mut self) {
        let bounds = self.landscape.lower.iter().zip(&self.landscape.upper);
        let nearest_to_zero: Vec<f64> = bounds.map(|(low, high)| 0.0_f64.clamp(*low, *high)).collect();
        self.descend(&nearest_to_zero);
        let region = Region::of_box(&self.landscape.lower, &self.landscape.upper);
        self.open.push(Open { bound: 0.0, region, start: self.minima[0].0.clone() });
        let mut listing = 0;
        while let Some(top) = self.open.peek() {
            // Proven: what is left only serves to list the other minima.
            listing += usize::from(top.bound >= self.aim());
            let spent = self.boxes >= self.effort.boxes || listing > self.effort.listing;
            if top.bound >= self.cutoff() || spent || (self.effort.stop)() {
                break;
            }
            if let Some(open) = self.open.pop() {
                self.visit(open);
            }
        }
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
        NEAR * self.best + AIM * self.denominator()
    }

    fn visit(&mut self, open: Open) {
        self.boxes += 1;
        let Open { bound, region, mut start } = open;
        if bound >= self.aim() && self.is_searched(&region) {
            return self.close(bound);
        }
        let relaxation = Relaxation::new(self.landscape, &region, self.fence);
        let goal = if bound >= self.aim() { self.cutoff() } else { self.aim() };
        let bound = bound.max(self.bound_region(&relaxation, &region, &mut start, goal));
        if bound >= self.cutoff() {
            return self.close(bound);
        }
        let known = self.minima.len();
        let value = self.landscape.value(&start);
        // A minimum that is worth listing is below the cutoff, and so is a start near it.
        if value < self.best || (value < NEAR * self.cutoff() && self.minimum_in(&region).is_none()) {
            self.descend(&start);
        }
        if bound >= self.aim() {
            if relaxation.is_exact() || (self.minima.len() > known && self.is_searched(&region)) {
                return self.close(bound);
            }
        } else if let Some(convex) =
            self.bound_convex(&region, relaxation.is_exact()).filter(|convex| *convex >= self.aim())
        {
            return self.close(bound.max(convex));
        }
        self.split(&relaxation, &region, bound, &start);
    }

    fn close(&mut self, bound: f64) {
        self.closed = self.closed.min(bound);
    }

    /// The best lower bound that a descent on the relaxation gives; `start` ends at its minimum.
    fn bound_region(&mut self, relaxation: &Relaxation<'_>, region: &Region, start: &mut [f64], goal: f64) -> f64 {
        region.write_box(&mut self.lower, &mut self.upper);
        for (node, scale) in start.iter_mut().enumerate() {
            *scale = scale.clamp(self.lower[node], self.upper[node]);
        }
        let (cutoff, tolerance) = (self.cutoff(), 0.05 * AIM * self.denominator());
        let (lower, upper) = (&self.lower, &self.upper);
        let exact = relaxation.is_exact();
        let mut best = f64::NEG_INFINITY;
        self.descent.run(relaxation, (lower, upper), start, |scales, slopes| {
            best = best.max(tangent_bound(scales, slopes, (lower, upper)));
            let loss = slopes.value - best;
            // A region that will be split anyway needs no sharper bound than its distance from the goal.
            let split_anyway = !exact && loss <= 0.05 * (goal - slopes.value);
            best >= cutoff || split_anyway || loss <= tolerance.max(2.0 * slopes.value_error)
        });
        best
    }

    /// Follows the landscape down from `start` over the whole box, and keeps the minimum if it is new.
    fn descend(&mut self, start: &[f64]) {
        let mut scales = start.to_vec();
        let (lower, upper) = (&self.landscape.lower, &self.landscape.upper);
        self.descent.run(self.landscape, (lower, upper), &mut scales, |_, _| false);
        let value = self.descent.slopes.value;
        if value < self.best {
            let curvature = self.descent.slopes.curvature.iter().fold(0.0_f64, |most, entry| most.max(entry.abs()));
            self.fence = 8.0 * curvature;
        }
        let same = |(known, _): &(Vec<f64>, f64)| {
            self.landscape.links.iter().all(|link| {
                let change = (scales[link.to] - scales[link.from]) - (known[link.to] - known[link.from]);
                change.abs() <= 1e-6
            })
        };
        match self.minima.iter().position(same) {
            Some(position) if value < self.minima[position].1 => self.minima[position] = (scales, value),
            Some(_) => {}
            None => self.minima.push((scales, value)),
        }
        self.best = self.best.min(value);
    }

    fn minimum_in(&self, region: &Region) -> Option<usize> {
        self.minima.iter().position(|(scales, _)| region.holds(scales))
    }

    /// The bound of a region that, with the best minimum, lies where the landscape is convex (`exact`: every link of it is, over
    /// the region): from the slopes and the curvature at that minimum.
    fn bound_convex(&mut self, region: &Region, exact: bool) -> Option<f64> {
        let (scales, _) = self.minima.iter().min_by(|a, b| a.1.total_cmp(&b.1))?;
        let hull = region.hull(scales);
        let inside = region.holds(scales);
        let convex = (exact && inside) || self.terrain.is_convex_over(&hull);
        if !convex {
            return None;
        }
        let mut slopes = Slopes::zero(scales.len());
        self.landscape.slopes(scales, Bend::True, &mut slopes);
        hull.write_box(&mut self.lower, &mut self.upper);
        let tangent = tangent_bound(scales, &slopes, (&self.lower, &self.upper));
        Some(self.terrain.bound_at(scales, &slopes).map_or(tangent, |curved| curved.max(tangent)))
    }

    /// Whether the region holds no local minimum, or none but a known one.
    fn is_searched(&self, region: &Region) -> bool {
        self.terrain.has_no_minimum(region)
            || self.minima.iter().any(|(scales, _)| self.terrain.has_only(region, scales))
    }

    /// Splits the region: where its bound loses most or, where nothing is lost or the best is already proven, so that what is
    /// convex comes apart from what is not, and then so that the slopes vary less.
    fn split(&mut self, relaxation: &Relaxation<'_>, region: &Region, bound: f64, start: &[f64]) {
        let listing = bound >= self.aim();
        let least_gap = 1e-13 * self.denominator();
        let gap = relaxation.widest_gap(start).filter(|(_, gap)| !listing && *gap > least_gap).map(|(link, _)| link);
        let edges = if gap.is_none() { relaxation.edges(start) } else { Vec::new() };
        if !edges.is_empty() {
            let count = if listing { edges.len() } else { 1 };
            return self.peel(&edges[..count], region, bound, start);
        }
        let widest = gap.or_else(|| relaxation.widest_slope()).map(|link| (link, region.range(link.from, link.to)));
        let Some((link, (low, high))) = widest.filter(|(_, (low, high))| high - low > 1e-11) else {
            // The bound is as sharp as rounding allows.
            self.all_minima &= !listing;
            return self.close(bound);
        };
        let margin = 0.15 * (high - low);
        let at = (start[link.to] - start[link.from]).clamp(low + margin, high - margin);
        self.split_at((link.from, link.to), at, region, bound, start);
    }

    /// Takes off what lies beyond each edge, seen from `start`, and keeps the rest as one region.
    fn peel(&mut self, edges: &[(usize, usize, f64)], region: &Region, bound: f64, start: &[f64]) {
        let mut rest = Some(region.clone());
        for &(from, to, at) in edges {
            let Some(region) = rest else { return };
            let (below, above) = (region.below(from, to, at), region.above(from, to, at));
            let (inner, outer) = if start[to] - start[from] < at { (below, above) } else { (above, below) };
            self.push(outer, bound, start);
            rest = inner;
        }
        self.push(rest, bound, start);
    }

    fn split_at(&mut self, (from, to): (usize, usize), at: f64, region: &Region, bound: f64, start: &[f64]) {
        self.push(region.below(from, to, at), bound, start);
        self.push(region.above(from, to, at), bound, start);
    }

    fn push(&mut self, region: Option<Region>, bound: f64, start: &[f64]) {
        if let Some(region) = region {
            self.open.push(Open { bound, region, start: start.to_vec() });
        }
    }

    fn found(mut self) -> Found {
        let left = self.open.peek().map_or(f64::INFINITY, |open| open.bound);
        let cutoff = self.cutoff();
        // A sum of squares is never negative, and no bound can be above a value that was reached.
        let lower_bound = self.closed.min(left).max(0.0).min(self.best);
        let gap = (self.best - lower_bound) / self.denominator();
        self.minima.sort_by(|a, b| a.1.total_cmp(&b.1));
        // The best itself always stays.
        let kept = self.minima.iter().take_while(|(_, value)| *value <= cutoff).count().max(1);
        self.minima.truncate(kept);
        Found {
            minima: self.minima,
            lower_bound,
            gap,
            boxes: self.boxes,
            all_minima: self.all_minima && left >= cutoff,
        }
    }
}
