//! Tests that exclude a node: monotonicity (the node has no minimum) and convexity (no minimum
//! other than a known one).

use nalgebra::DMatrix;

use super::objective::{Expansion, Objective};
use super::term::{Range, Term};
use super::underestimator::{DifferenceBounds, quadratic_bound};

/// The objective with the structure needed by the exclusion tests.
pub(super) struct NodeExclusion<'a> {
    objective: &'a Objective,
    /// Reference scale of each scale: the ground, or the first of a piece that is not tied to it.
    base: Vec<usize>,
    /// Scales whose bounds can stop each scale: the ground, or any other of a piece that is not
    /// tied to it.
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

    /// Monotonicity test: whether the slope in some scale keeps its sign over the whole region
    /// although nothing stops the scale, so that the region holds no local minimum.
    pub(super) fn has_no_minimum(&self, region: &DifferenceBounds) -> bool {
        let slopes = self.slope_ranges(region);
        let can_move = |scale: &usize| self.objective.lower[*scale] < self.objective.upper[*scale];
        let unstopped = |scale: usize| {
            sign(&slopes[scale]) != 0 && !self.is_stopped(region, scale, sign(&slopes[scale]))
        };
        (0..self.objective.ground()).filter(can_move).any(unstopped)
    }

    /// Whether the region holds no local minimum other than `minimum`: over the hull of both, the
    /// scales whose slope keeps its sign are on their bound at any local minimum, and the objective
    /// is convex in the others.
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

    /// Range of the slope in each scale over the region; `size` sums the sizes of the terms'
    /// slopes.
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
                // Rounding of both sums, each below the sum of the sizes.
                let rounding = f64::EPSILON * range.size;
                range.least -= rounding;
                range.most += rounding;
            }
        }
        ranges
    }

    /// Returns a lower bound over a region on which the objective is convex, from its gradient and
    /// Hessian next to `minimum`.
    pub(super) fn bound_at(&self, minimum: &[f64], at: &Expansion) -> Option<f64> {
        // Far above the error of the scales, far below a change that matters to the curvature.
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

    /// Guaranteed magnitude of the slope that pushes the scale against its active bound; otherwise
    /// 0.
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

    /// Reference scale of each floating piece: a fixed scale or, where bounds push, the scale
    /// pushed hardest. The slopes of the others lean on that scale, so its push has to outweigh
    /// them.
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

    /// Returns the Hessian built from every term's least curvature over its range and, as the
    /// gradient's error, the sum of sizes behind its diagonal.
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

    /// Whether the objective is convex in the `free` scales over the region: the Hessian built from
    /// every term's least curvature is positive definite, and the true Hessian differs from it by a
    /// positive semidefinite matrix.
    fn is_convex_in(&self, region: &DifferenceBounds, free: impl Fn(usize) -> bool) -> bool {
        let least = self.least_hessian(|term| region.range(term.from, term.to));
        let measured = |scale: &usize| self.base[*scale] != *scale && free(*scale);
        let free: Vec<usize> = (0..self.objective.ground()).filter(measured).collect();
        free.is_empty() || reduced(&least, &free).cholesky().is_some()
    }
}

/// Sign that a slope keeps over its range: -1, 1, or 0 where the sign is undecided.
fn sign(slope: &Range) -> i8 {
    i8::from(slope.least > 0.0) - i8::from(slope.most < 0.0)
}

/// Returns the Hessian of the `free` scales, less a margin for the rounding of its sums (up to n
/// terms) and of its factorisation (n (n + 1) roundings of the diagonal: Higham, theorem 10.3).
fn reduced(hessian: &Expansion, free: &[usize]) -> DMatrix<f64> {
    let scales = hessian.gradient.len();
    let roundings = ((scales + 1) * (scales + 2)) as f64;
    DMatrix::from_fn(free.len(), free.len(), |row, column| {
        let entry = hessian.hessian[free[row] * scales + free[column]];
        let margin = roundings * f64::EPSILON * hessian.gradient_error[free[row]];
        if row == column { entry - margin } else { entry }
    })
}
