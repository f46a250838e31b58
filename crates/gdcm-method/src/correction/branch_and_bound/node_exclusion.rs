//! What excludes a node: the monotonicity test (no minimum is there) and the convexity test (no other than a known one).

use nalgebra::DMatrix;

use super::objective::{Expansion, Objective};
use super::term::{Range, Term};
use super::underestimator::{DifferenceBounds, quadratic_bound};

/// The objective with what decides about its local minima.
pub(super) struct NodeExclusion<'a> {
    objective: &'a Objective,
    /// The scale against which each one is measured: the ground, or the first of a piece that is not tied to it.
    base: Vec<usize>,
    /// The scales whose bounds can stop each one: the ground, or any other of a piece that is not tied to it.
    stops: Vec<Vec<usize>>,
    floating: Vec<Vec<usize>>,
}

impl<'a> NodeExclusion<'a> {
    pub(super) fn new(objective: &'a Objective) -> Self {
        let ground = objective.ground();
        let mut base = vec![ground; objective.scales()];
        let mut stops = vec![vec![ground]; objective.scales()];
        let floating = objective.floating_pieces();
        for piece in &floating {
            for &scale in piece {
                base[scale] = piece[0];
                stops[scale] = piece
                    .iter()
                    .copied()
                    .filter(|&other| other != scale)
                    .collect();
            }
        }
        Self {
            objective,
            base,
            stops,
            floating,
        }
    }

    /// Work of one test: the range of every slope, or the Hessian and its Cholesky factorisation.
    pub(super) fn work(&self) -> u64 {
        let scales = self.objective.scales() as u64;
        4 * self.objective.terms.len() as u64 + scales * scales * scales / 96
    }

    /// Monotonicity test: whether some scale's slope keeps its sign over the whole region although nothing stops the scale, so
    /// that no local minimum is there.
    pub(super) fn has_no_minimum(&self, region: &DifferenceBounds) -> bool {
        let slopes = self.slope_ranges(region);
        let can_move = |scale: &usize| self.objective.lower[*scale] < self.objective.upper[*scale];
        let unstopped = |scale: usize| {
            sign(&slopes[scale]) != 0 && !self.is_stopped(region, scale, sign(&slopes[scale]))
        };
        (0..self.objective.ground()).filter(can_move).any(unstopped)
    }

    /// Whether no local minimum in the region differs from the one at `minimum`: over the hull of both, the scales whose slope
    /// keeps its sign are on their bound at any local minimum, and the objective is convex in the others.
    pub(super) fn has_only(&self, region: &DifferenceBounds, minimum: &[f64]) -> bool {
        let hull = region.hull(minimum);
        let slopes = self.slope_ranges(&hull);
        let ground = self.objective.ground();
        let on_bound = |scale: usize| self.stops[scale] == [ground] && sign(&slopes[scale]) != 0;
        self.is_convex_in(&hull, |scale| !on_bound(scale))
    }

    /// Convexity test: whether the objective is convex over the region.
    pub(super) fn is_convex(&self, region: &DifferenceBounds) -> bool {
        self.is_convex_in(region, |_| true)
    }

    fn is_stopped(&self, region: &DifferenceBounds, scale: usize, sign: i8) -> bool {
        self.stops[scale].iter().any(|&other| {
            let (from, to) = if sign > 0 {
                (scale, other)
            } else {
                (other, scale)
            };
            region.range(from, to).1
                >= self.objective.upper[to] - self.objective.lower[from] - 1e-12
        })
    }

    /// The slope in each scale over the region; `size` is that of what it is summed from.
    fn slope_ranges(&self, region: &DifferenceBounds) -> Vec<Range> {
        let mut ranges = vec![Range::default(); self.objective.scales()];
        for term in &self.objective.terms {
            let (low, high) = region.range(term.from, term.to);
            let Range { least, most, size } = term.function.slopes((low, high.max(low)));
            for (scale, least, most) in [(term.to, least, most), (term.from, -most, -least)] {
                let range = &mut ranges[scale];
                range.least += least;
                range.most += most;
                range.size += size;
                // The rounding of both sums, each below the sum of the sizes.
                let rounding = f64::EPSILON * range.size;
                range.least -= rounding;
                range.most += rounding;
            }
        }
        ranges
    }

    /// A lower bound over a region on which the objective is convex, from its gradient and Hessian next to `minimum`.
    pub(super) fn bound_at(&self, minimum: &[f64], at: &Expansion) -> Option<f64> {
        // Far more than the scales are wrong by, far less than what changes the curvature.
        const WITHIN: f64 = 0.01;
        let least = self.least_hessian(|term| {
            let u = minimum[term.to] - minimum[term.from];
            (u - 2.0 * WITHIN, u + 2.0 * WITHIN)
        });
        let push: Vec<f64> = (0..minimum.len())
            .map(|scale| self.push(minimum, at, scale))
            .collect();
        let anchors = self.anchors(at, &push)?;
        let lower = &self.objective.lower;
        let upper = &self.objective.upper;
        let free: Vec<usize> = (0..self.objective.ground())
            .filter(|scale| lower[*scale] < upper[*scale] && !anchors.contains(scale))
            .collect();
        let inverse = reduced(&least, &free).cholesky()?.inverse();
        let mut reach = vec![0.0; minimum.len()];
        for (position, &scale) in free.iter().enumerate() {
            reach[scale] = inverse[(position, position)].sqrt();
        }
        quadratic_bound(at, &reach, WITHIN, |scale| push[scale] > 0.0)
    }

    /// How hard the slope surely pushes the scale against the bound it is on; 0 where it does not.
    fn push(&self, minimum: &[f64], at: &Expansion, scale: usize) -> f64 {
        let slope = at.gradient[scale];
        let stopped = if slope > 0.0 {
            minimum[scale] <= self.objective.lower[scale]
        } else {
            minimum[scale] >= self.objective.upper[scale]
        };
        if stopped {
            (slope.abs() - at.gradient_error[scale]).max(0.0)
        } else {
            0.0
        }
    }

    /// The scale against which each floating piece is measured: one that cannot move or, where bounds push, the one pushed
    /// hardest. The others' slopes lean on that one, so it has to outweigh them.
    fn anchors(&self, at: &Expansion, push: &[f64]) -> Option<Vec<usize>> {
        let mut anchors = Vec::new();
        for piece in &self.floating {
            let is_fixed =
                |scale: &usize| self.objective.lower[*scale] >= self.objective.upper[*scale];
            if let Some(fixed) = piece.iter().copied().find(is_fixed) {
                anchors.push(fixed);
                continue;
            }
            let hardest = piece
                .iter()
                .copied()
                .max_by(|a, b| push[*a].total_cmp(&push[*b]))?;
            let loose = piece.iter().filter(|&&scale| push[scale] == 0.0);
            let lean: f64 = loose
                .map(|&scale| at.gradient[scale].abs() + at.gradient_error[scale])
                .sum();
            if push[hardest] > 0.0 && push[hardest] < lean {
                return None;
            }
            anchors.push(hardest);
        }
        Some(anchors)
    }

    /// The Hessian with every term's least curvature over its range, and (as the gradient's error) what its diagonal is summed
    /// from.
    fn least_hessian(&self, range: impl Fn(&Term) -> (f64, f64)) -> Expansion {
        let mut least = Expansion::zero(self.objective.scales());
        for term in &self.objective.terms {
            let (low, high) = range(term);
            let curvature = term.function.curvatures((low, high.max(low)));
            least.add(term, Default::default(), curvature.least);
            least.gradient_error[term.from] += curvature.size;
            least.gradient_error[term.to] += curvature.size;
        }
        least
    }

    /// Whether the objective is convex in the `free` scales over the region: the Hessian with every term's least curvature is
    /// positive definite, and the true one differs from it by a positive semidefinite matrix.
    fn is_convex_in(&self, region: &DifferenceBounds, free: impl Fn(usize) -> bool) -> bool {
        let least = self.least_hessian(|term| region.range(term.from, term.to));
        let measured = |scale: &usize| self.base[*scale] != *scale && free(*scale);
        let free: Vec<usize> = (0..self.objective.ground()).filter(measured).collect();
        free.is_empty() || reduced(&least, &free).cholesky().is_some()
    }
}

/// The sign that a slope keeps: -1, 0 (none) or 1.
fn sign(slope: &Range) -> i8 {
    i8::from(slope.least > 0.0) - i8::from(slope.most < 0.0)
}

/// The Hessian of the `free` scales, less what its sums (of up to n terms) and its factorisation (n (n + 1) roundings of the
/// diagonal: Higham, theorem 10.3) can be wrong by.
fn reduced(hessian: &Expansion, free: &[usize]) -> DMatrix<f64> {
    let scales = hessian.gradient.len();
    let roundings = ((scales + 1) * (scales + 2)) as f64;
    DMatrix::from_fn(free.len(), free.len(), |row, column| {
        let entry = hessian.hessian[free[row] * scales + free[column]];
        let margin = roundings * f64::EPSILON * hessian.gradient_error[free[row]];
        if row == column { entry - margin } else { entry }
    })
}
