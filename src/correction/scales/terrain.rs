//! What is known of the landscape's shape over a region: where it is convex, and where nothing can be a minimum.

use nalgebra::DMatrix;

use super::bound::curved_bound;
use super::landscape::{Landscape, Slopes};
use super::link::Link;
use super::region::Region;

/// The landscape with what decides about its local minima.
pub(super) struct Terrain<'a> {
    landscape: &'a Landscape,
    /// The node against which each node's scale is measured: the ground, or the first of a piece that is not tied to it.
    base: Vec<usize>,
    /// The nodes whose bounds can stop each node: the ground, or any other of a piece that is not tied to it.
    stops: Vec<Vec<usize>>,
    /// The nodes of each piece that is not tied to the ground.
    free_pieces: Vec<Vec<usize>>,
}

/// Least and greatest slope of each scale over a region, and the size of what they are summed from.
struct SlopeRanges {
    least: Vec<f64>,
    most: Vec<f64>,
    size: Vec<f64>,
}

impl SlopeRanges {
    /// The sign that the slope keeps, well above rounding: -1, 0 (none) or 1.
    fn sign(&self, node: usize) -> i8 {
        let rounding = 1e-12 * self.size[node];
        i8::from(self.least[node] > rounding) - i8::from(self.most[node] < -rounding)
    }
}

impl<'a> Terrain<'a> {
    pub(super) fn new(landscape: &'a Landscape) -> Self {
        let ground = landscape.ground();
        let mut base = vec![ground; landscape.nodes()];
        let mut stops = vec![vec![ground]; landscape.nodes()];
        let pieces = landscape.pieces().into_iter();
        let free_pieces: Vec<Vec<usize>> = pieces.filter(|(_, grounded)| !grounded).map(|(nodes, _)| nodes).collect();
        for nodes in &free_pieces {
            for &node in nodes {
                base[node] = nodes[0];
                stops[node] = nodes.iter().copied().filter(|&other| other != node).collect();
            }
        }
        Self { landscape, base, stops, free_pieces }
    }

    /// Whether some scale's slope keeps its sign over the whole region although nothing stops the scale: no local minimum is
    /// there.
    pub(super) fn has_no_minimum(&self, region: &Region) -> bool {
        let slopes = self.slope_ranges(region);
        let can_move = |node: &usize| self.landscape.lower[*node] < self.landscape.upper[*node];
        (0..self.landscape.ground())
            .filter(can_move)
            .any(|node| slopes.sign(node) != 0 && !self.is_stopped(region, node, slopes.sign(node)))
    }

    /// Whether no local minimum in the region differs from the one at `minimum`: over the hull of both, the scales whose slope
    /// keeps its sign are on their bound at any local minimum, and the landscape is convex in the others.
    pub(super) fn has_only(&self, region: &Region, minimum: &[f64]) -> bool {
        let hull = region.hull(minimum);
        let slopes = self.slope_ranges(&hull);
        let ground = self.landscape.ground();
        let on_bound = |node: usize| self.stops[node] == [ground] && slopes.sign(node) != 0;
        self.is_convex(&hull, |node| !on_bound(node))
    }

    /// Whether the landscape is convex over the region.
    pub(super) fn is_convex_over(&self, region: &Region) -> bool {
        self.is_convex(region, |_| true)
    }

    fn is_stopped(&self, region: &Region, node: usize, sign: i8) -> bool {
        self.stops[node].iter().any(|&other| {
            let (from, to) = if sign > 0 { (node, other) } else { (other, node) };
            region.range(from, to).1 >= self.landscape.upper[to] - self.landscape.lower[from] - 1e-12
        })
    }

    fn slope_ranges(&self, region: &Region) -> SlopeRanges {
        let nodes = self.landscape.nodes();
        let mut ranges = SlopeRanges { least: vec![0.0; nodes], most: vec![0.0; nodes], size: vec![0.0; nodes] };
        for link in &self.landscape.links {
            let (low, high) = region.range(link.from, link.to);
            let (down, up) = link.shape.slopes(low, high.max(low));
            for (node, least, most) in [(link.to, down, up), (link.from, -up, -down)] {
                ranges.least[node] += least;
                ranges.most[node] += most;
                ranges.size[node] += least.abs().max(most.abs());
            }
        }
        ranges
    }

    /// A lower bound over a region on which the landscape is convex, from the slopes and the curvature next to `minimum`.
    pub(super) fn bound_at(&self, minimum: &[f64], slopes: &Slopes) -> Option<f64> {
        // Far more than the scales are wrong by, far less than what changes the curvature.
        const WITHIN: f64 = 0.01;
        let least = self.least_hessian(|link| {
            let u = minimum[link.to] - minimum[link.from];
            (u - 2.0 * WITHIN, u + 2.0 * WITHIN)
        });
        let push: Vec<f64> = (0..minimum.len()).map(|node| self.push(minimum, slopes, node)).collect();
        let anchors = self.anchors(slopes, &push)?;
        let (lower, upper) = (&self.landscape.lower, &self.landscape.upper);
        let free: Vec<usize> = (0..self.landscape.ground())
            .filter(|node| lower[*node] < upper[*node] && !anchors.contains(node))
            .collect();
        let inverse = reduced(&least, &free).cholesky()?.inverse();
        let mut reach = vec![0.0; minimum.len()];
        for (position, &node) in free.iter().enumerate() {
            reach[node] = inverse[(position, position)].sqrt();
        }
        curved_bound(slopes, &reach, WITHIN, |node| push[node] > 0.0)
    }

    /// How hard the slope surely pushes the scale against the bound it is on; 0 where it does not.
    fn push(&self, minimum: &[f64], slopes: &Slopes, node: usize) -> f64 {
        let slope = slopes.gradient[node];
        let stopped = if slope > 0.0 {
            minimum[node] <= self.landscape.lower[node]
        } else {
            minimum[node] >= self.landscape.upper[node]
        };
        if stopped { (slope.abs() - slopes.gradient_error[node]).max(0.0) } else { 0.0 }
    }

    /// The scale against which each piece that is not tied to the ground is measured: one that cannot move or, where bounds push,
    /// the one pushed hardest. The others' slopes lean on that one, so it has to outweigh them.
    fn anchors(&self, slopes: &Slopes, push: &[f64]) -> Option<Vec<usize>> {
        let mut anchors = Vec::new();
        for nodes in &self.free_pieces {
            let is_fixed = |node: &usize| self.landscape.lower[*node] >= self.landscape.upper[*node];
            if let Some(fixed) = nodes.iter().copied().find(is_fixed) {
                anchors.push(fixed);
                continue;
            }
            let hardest = nodes.iter().copied().max_by(|a, b| push[*a].total_cmp(&push[*b]))?;
            let loose = nodes.iter().filter(|&&node| push[node] == 0.0);
            let lean: f64 = loose.map(|&node| slopes.gradient[node].abs() + slopes.gradient_error[node]).sum();
            if push[hardest] > 0.0 && push[hardest] < lean {
                return None;
            }
            anchors.push(hardest);
        }
        Some(anchors)
    }

    /// The nodes that are measured against a base, and `pick`.
    fn free_nodes(&self, pick: impl Fn(usize) -> bool) -> Vec<usize> {
        (0..self.landscape.ground()).filter(|&node| self.base[node] != node && pick(node)).collect()
    }

    /// The Hessian with every link's least curvature over its range, and (as the gradient's error) what its diagonal is summed
    /// from.
    fn least_hessian(&self, range: impl Fn(&Link) -> (f64, f64)) -> Slopes {
        let mut least = Slopes::zero(self.landscape.nodes());
        for link in &self.landscape.links {
            let (low, high) = range(link);
            let curvature = link.shape.least_curvature(low, high.max(low));
            least.add(link, 0.0, curvature.abs(), curvature);
        }
        least
    }

    /// Whether the landscape is convex in the `free` scales over the region: the Hessian with every link's least curvature is
    /// positive definite, and the true one differs from it by a positive semidefinite matrix.
    fn is_convex(&self, region: &Region, free: impl Fn(usize) -> bool) -> bool {
        let least = self.least_hessian(|link| region.range(link.from, link.to));
        let free = self.free_nodes(free);
        free.is_empty() || reduced(&least, &free).cholesky().is_some()
    }
}

/// The Hessian of the `free` scales, less a margin a hundred times the rounding of the sums and of a factorisation.
fn reduced(hessian: &Slopes, free: &[usize]) -> DMatrix<f64> {
    let nodes = hessian.gradient.len();
    DMatrix::from_fn(free.len(), free.len(), |row, column| {
        let entry = hessian.curvature[free[row] * nodes + free[column]];
        if row == column { entry - 1e-13 * nodes as f64 * hessian.gradient_error[free[row]] } else { entry }
    })
}
