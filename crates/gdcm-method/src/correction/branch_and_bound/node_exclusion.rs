//! Tests that exclude a node (a part of the box, here the *region*) from the search. `F` is the
//! objective: a sum of terms, each a function of the difference between two *scales* `s_i`, the
//! unknowns; the last scale, the *ground*, is always 0.
//!
//! ```text
//! monotonicity  some slope dF/ds_i has a constant sign over the region, and s_i can move downhill
//!               without meeting a bound: the region contains no minimum
//! convexity     the Hessian of F, with each term's curvature replaced by its minimum over the
//!               region, is positive definite: the region contains at most one minimum
//! ```
//!
//! Hansen & Walster, *Global Optimization Using Interval Analysis*, 2004. Both tests are
//! sufficient, not necessary: if one fails, it proves nothing. The scales in a *floating piece*,
//! which no term connects with the ground, can be shifted together without changing the objective:
//! one scale, the *reference*, does not move in the tests.

use nalgebra::DMatrix;

use super::derivatives::Range;
use super::difference_bounds::DifferenceBounds;
use super::effort::cholesky_work;
use super::expansion::add_curvature;
use super::objective::Objective;
use super::term::Term;
use crate::correction::interval::Interval;

/// Largest distance from a box end that counts as a rounding error.
const ROUNDING: f64 = 1e-12;

/// The objective with the structure needed by the exclusion tests.
pub(super) struct NodeExclusion<'a> {
    pub(super) objective: &'a Objective,
    /// Floating pieces: scales that terms connect with one another, but not with the ground.
    pub(super) floating: Vec<Vec<usize>>,
    /// Reference for each scale: the ground, or the first scale in its floating piece.
    reference: Vec<usize>,
    /// For each scale, the scales from which its distance matters: the ground, or the other scales
    /// in its floating piece. A movement meets a bound where such a distance is as large as the
    /// whole box allows.
    measured_from: Vec<Vec<usize>>,
}

impl<'a> NodeExclusion<'a> {
    pub(super) fn new(objective: &'a Objective) -> Self {
        let ground = objective.ground();
        let mut reference = vec![ground; objective.scales()];
        let mut measured_from = vec![vec![ground]; objective.scales()];
        let floating = objective.floating_pieces();
        for piece in &floating {
            for &scale in piece {
                reference[scale] = piece[0];
                measured_from[scale] = piece
                    .iter()
                    .copied()
                    .filter(|&other| other != scale)
                    .collect();
            }
        }
        Self {
            objective,
            floating,
            reference,
            measured_from,
        }
    }

    /// Returns the work per test, in term evaluations: the range of every slope or curvature, which
    /// counts as four evaluations per term, and a Cholesky factorisation.
    pub(super) fn work(&self) -> u64 {
        4 * self.objective.terms.len() as u64 + cholesky_work(self.objective.scales() as u64)
    }

    /// Monotonicity test: returns whether the region contains no local minimum, because the slope
    /// in some scale has a constant sign over the region and no bound stops this scale.
    pub(super) fn has_no_minimum(&self, region: &DifferenceBounds) -> bool {
        let slopes = self.slope_ranges(region);
        for (scale, slope) in slopes.iter().enumerate().take(self.objective.ground()) {
            let sign = sign(slope);
            let can_move = self.objective.lower[scale] < self.objective.upper[scale];
            if can_move && sign != 0 && !self.is_stopped(region, scale, sign) {
                return true;
            }
        }
        false
    }

    /// Returns whether the region contains no local minimum other than `minimum`. Over the hull
    /// around both, a scale whose slope has a constant sign is on the same bound at every local
    /// minimum, because otherwise it could move downhill. The convexity test then needs only the
    /// other scales.
    pub(super) fn has_only(&self, region: &DifferenceBounds, minimum: &[f64]) -> bool {
        let hull = region.hull(minimum);
        let slopes = self.slope_ranges(&hull);
        let ground = self.objective.ground();
        // The scales in a floating piece are always tested: no bound of their own stops them,
        // because the piece can be shifted.
        let free: Vec<usize> = (0..ground)
            .filter(|&scale| self.reference[scale] != ground || sign(&slopes[scale]) == 0)
            .collect();
        self.is_convex_in(&hull, free)
    }

    /// Convexity test: returns whether the objective is certainly convex over the region.
    pub(super) fn is_convex(&self, region: &DifferenceBounds) -> bool {
        self.is_convex_in(region, (0..self.objective.ground()).collect())
    }

    /// Returns whether a bound stops the scale from moving downhill, given its slope's sign.
    fn is_stopped(&self, region: &DifferenceBounds, scale: usize, sign: i8) -> bool {
        self.measured_from[scale].iter().any(|&other| {
            if sign > 0 {
                self.reaches_box(region, scale, other)
            } else {
                self.reaches_box(region, other, scale)
            }
        })
    }

    /// Returns whether `s_to - s_from` has the same maximum over the region as over the whole box.
    fn reaches_box(&self, region: &DifferenceBounds, from: usize, to: usize) -> bool {
        region.range(from, to).high
            >= self.objective.upper[to] - self.objective.lower[from] - ROUNDING
    }

    /// Bounds the slope `dF/ds_i` in each scale over the region; `size` adds up the terms' slope
    /// sizes. A term's slope counts positive at its `to`, negative at its `from`.
    fn slope_ranges(&self, region: &DifferenceBounds) -> Vec<Range> {
        let mut ranges = vec![Range::default(); self.objective.scales()];
        for term in &self.objective.terms {
            let slope = term
                .function
                .slopes(region.range(term.from, term.to).not_empty());
            add_range(&mut ranges[term.to], slope);
            let mirrored = Range {
                least: -slope.most,
                most: -slope.least,
                size: slope.size,
            };
            add_range(&mut ranges[term.from], mirrored);
        }
        ranges
    }

    /// Builds the Hessian from every term's minimum curvature over its range.
    pub(super) fn least_hessian(&self, range: impl Fn(&Term) -> Interval) -> LeastHessian {
        let scales = self.objective.scales();
        let mut least = LeastHessian {
            entries: vec![0.0; scales * scales],
            sizes: vec![0.0; scales],
        };
        for term in &self.objective.terms {
            let curvature = term.function.curvatures(range(term).not_empty());
            add_curvature(&mut least.entries, scales, term, curvature.least);
            least.sizes[term.from] += curvature.size;
            least.sizes[term.to] += curvature.size;
        }
        least
    }

    /// Returns whether the objective is certainly convex in the `free` scales over the region: the
    /// Hessian built from every term's minimum curvature is positive definite, and the true Hessian
    /// exceeds it by a positive semidefinite matrix. References do not count as free.
    fn is_convex_in(&self, region: &DifferenceBounds, mut free: Vec<usize>) -> bool {
        let least = self.least_hessian(|term| region.range(term.from, term.to));
        // The reference in a floating piece does not move.
        free.retain(|&scale| self.reference[scale] != scale);
        free.is_empty() || least.reduced(&free).cholesky().is_some()
    }
}

/// The Hessian built from every term's minimum curvature over a range.
pub(super) struct LeastHessian {
    /// Scales x scales, row by row.
    entries: Vec<f64>,
    /// For each diagonal entry, the summed sizes of its curvatures, to which its rounding error is
    /// proportional.
    sizes: Vec<f64>,
}

impl LeastHessian {
    /// Returns the Hessian in the `free` scales. For n scales, its diagonal is reduced by a margin
    /// for the rounding in its sums (up to n terms) and in its factorisation (n (n + 1) roundings:
    /// Higham, *Accuracy and Stability of Numerical Algorithms*, 2002, theorem 10.3).
    pub(super) fn reduced(&self, free: &[usize]) -> DMatrix<f64> {
        let scales = self.sizes.len();
        let roundings = ((scales + 1) * (scales + 2)) as f64;
        DMatrix::from_fn(free.len(), free.len(), |row, column| {
            let entry = self.entries[free[row] * scales + free[column]];
            let margin = roundings * f64::EPSILON * self.sizes[free[row]];
            if row == column { entry - margin } else { entry }
        })
    }
}

/// Adds a term's slope range, and widens the sum by the rounding error at both ends.
fn add_range(sum: &mut Range, slope: Range) {
    sum.least += slope.least;
    sum.most += slope.most;
    sum.size += slope.size;
    let rounding = f64::EPSILON * sum.size;
    sum.least -= rounding;
    sum.most += rounding;
}

/// Returns a slope's sign if it is constant over its range, -1 or 1; 0 if the sign may change.
fn sign(slope: &Range) -> i8 {
    i8::from(slope.least > 0.0) - i8::from(slope.most < 0.0)
}
