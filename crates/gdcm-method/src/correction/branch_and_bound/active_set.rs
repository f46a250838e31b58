//! Minimises a convex quadratic function over a box by a primal active-set method; the minimum is
//! the step taken in `newton`.
//!
//! ```text
//! min g' d + d' H d / 2   subject to   low <= d <= high
//! ```
//!
//! The unknowns are *scales*: the coordinates that the constraints leave free in the gains or
//! delays ([`super`]). `d` is a step in all scales, `g` and `H` are the objective's gradient and
//! Hessian before it. A bound is *active* if it fixes its scale; a scale without an active bound is
//! *free*. Source: Nocedal & Wright, "Numerical Optimization", 2nd ed. 2006, 16.5.

use super::effort::{Effort, MULTIPLY_ADDS, cholesky_work};
use super::expansion::{Expansion, ScaleBox};

/// Ridge added to the Hessian's diagonal, relative to its largest entry: it makes a Hessian
/// definite that is singular only because the objective does not depend on a common shift of some
/// scales. It is far below any curvature that matters.
const RIDGE: f64 = 1e-12;
/// Slopes below this, relative to the largest, are rounding errors.
const SLOPE_ROUNDING: f64 = 1e-14;
/// Pivots below this, relative to the ridge, show that the Hessian is not positive definite: the
/// ridge alone would make them larger.
const LEAST_PIVOT: f64 = 0.1;

/// Quadratic model `g' d + d' H d / 2` over the box `low <= d <= high`: [`QuadraticModel::set_box`]
/// sets the box, [`QuadraticModel::minimise`] finds `step`. The memory is reused.
#[derive(Clone, Debug)]
pub(super) struct QuadraticModel {
    scales: usize,
    /// Lower bound on each scale's step, at most 0.
    pub(super) low: Vec<f64>,
    /// Upper bound on each scale's step, at least 0.
    pub(super) high: Vec<f64>,
    /// The step `d`.
    pub(super) step: Vec<f64>,
    /// The model's slope `g + H d` after the step.
    slope: Vec<f64>,
    /// Scales without an active bound, in ascending order.
    free: Vec<usize>,
    /// For each scale, whether it has no active bound; [`Self::solve_free`] lists these scales in
    /// `free`.
    is_free: Vec<bool>,
    /// Lower Cholesky factor for the free scales' Hessian. Its rows and columns are places in
    /// `free`, not scales; each row has memory for all scales.
    factor: Vec<f64>,
    /// Move from `step` to the minimum over the free scales, without regard to the box; by scale,
    /// undefined for scales that are not free.
    newton_move: Vec<f64>,
}

impl QuadraticModel {
    /// Allocates the memory for `scales` scales.
    pub(super) fn new(scales: usize) -> Self {
        Self {
            scales,
            low: vec![0.0; scales],
            high: vec![0.0; scales],
            step: vec![0.0; scales],
            slope: vec![0.0; scales],
            free: Vec::with_capacity(scales),
            is_free: vec![false; scales],
            factor: vec![0.0; scales * scales],
            newton_move: vec![0.0; scales],
        }
    }

    /// Sets the box to the steps that lead from the point `scales` to points within `bounds`.
    pub(super) fn set_box(&mut self, bounds: ScaleBox<'_>, scales: &[f64]) {
        for (index, scale) in scales.iter().enumerate() {
            self.low[index] = bounds.lower[index] - scale;
            self.high[index] = bounds.upper[index] - scale;
        }
    }

    /// Minimises the model, with the gradient and Hessian in `at`, over `low <= d <= high` by a
    /// primal active-set method, which is exact and finite.
    ///
    /// ```text
    /// 1  free: every scale, unless its slope presses it against its bound
    /// 2  move to the minimum over the free scales, as far as the box allows
    /// 3  if a bound ends the move: make it active, repeat from 2
    /// 4  otherwise, of the active bounds from which the model decreases into the box, release the
    ///    steepest and repeat from 2; stop if there is none, or after 8 n + 8 passes
    /// ```
    ///
    /// Returns the decrease, or `None` if the effort is stopped or `H`, restricted to the free
    /// scales in some pass, is not positive definite. Scales with `low == high` do not move.
    pub(super) fn minimise(&mut self, at: &Expansion, effort: &Effort<'_>) -> Option<f64> {
        let gradient = &at.gradient;
        let hessian = &at.hessian;
        self.step.fill(0.0);
        self.slope.copy_from_slice(gradient);
        // Step 1
        for (scale, &slope) in gradient.iter().enumerate() {
            let is_pressed = (self.low[scale] >= 0.0 && slope >= 0.0)
                || (self.high[scale] <= 0.0 && slope <= 0.0);
            self.is_free[scale] = self.low[scale] < self.high[scale] && !is_pressed;
        }
        let ridge = RIDGE
            * (0..self.scales)
                .map(|scale| hessian[scale * self.scales + scale])
                .fold(0.0, f64::max);
        // Each pass activates a bound, or releases one after a decrease; 8 n passes are far more
        // than necessary.
        for _ in 0..8 * self.scales + 8 {
            effort.spend(self.work());
            if effort.is_stopped() {
                return None;
            }
            // Step 2
            self.solve_free(hessian, ridge)?;
            let allowed = self.allowed_move();
            for &scale in &self.free {
                self.step[scale] += allowed.fraction * self.newton_move[scale];
            }
            self.update_slope(gradient, hessian);
            // Steps 3 and 4
            if let Some(blocking) = allowed.blocking {
                self.step[blocking.scale] = blocking.end;
                self.is_free[blocking.scale] = false;
            } else if let Some(scale) = self.steepest_active_bound() {
                self.is_free[scale] = true;
            } else {
                break;
            }
        }
        let change: f64 = (0..self.scales)
            .map(|scale| 0.5 * (gradient[scale] + self.slope[scale]) * self.step[scale])
            .sum();
        Some(-change)
    }

    /// Returns the work per pass, in term evaluations: a Cholesky factorisation for the free
    /// scales, and the Hessian's product with the step.
    fn work(&self) -> u64 {
        let free = self.is_free.iter().filter(|is_free| **is_free).count() as u64;
        1 + cholesky_work(free) + (self.scales * self.scales) as u64 / MULTIPLY_ADDS
    }

    /// Lists the free scales in `free`, and computes `newton_move = -H_ff^-1 slope_f` over them,
    /// where `H_ff` is their Hessian. `None` if `H_ff` is not positive definite.
    fn solve_free(&mut self, hessian: &[f64], ridge: f64) -> Option<()> {
        self.free.clear();
        self.free
            .extend((0..self.scales).filter(|&scale| self.is_free[scale]));
        self.factorise_free(hessian, ridge)?;
        self.substitute();
        Some(())
    }

    /// Factorises `H_ff + ridge I` (Cholesky) into `factor`; `None` if it is not positive definite.
    /// `row`, `column` and `inner` are places in `free`.
    fn factorise_free(&mut self, hessian: &[f64], ridge: f64) -> Option<()> {
        for row in 0..self.free.len() {
            for column in 0..=row {
                let mut entry = hessian[self.free[row] * self.scales + self.free[column]];
                if row == column {
                    entry += ridge;
                }
                for inner in 0..column {
                    entry -= self.factor[row * self.scales + inner]
                        * self.factor[column * self.scales + inner];
                }
                self.factor[row * self.scales + column] = if row > column {
                    entry / self.factor[column * self.scales + column]
                } else if entry > LEAST_PIVOT * ridge {
                    entry.sqrt()
                } else if hessian[self.free[row] * self.scales + self.free[row]] == 0.0
                    && ridge == 0.0
                {
                    // Without any curvature, the objective does not depend on the scales: any pivot
                    // is correct.
                    1.0
                } else {
                    return None;
                };
            }
        }
        Some(())
    }

    /// Solves `factor factor' newton_move = -slope` for the free scales, forwards, then backwards.
    fn substitute(&mut self) {
        let size = self.free.len();
        for row in 0..size {
            let mut entry = -self.slope[self.free[row]];
            for inner in 0..row {
                entry -=
                    self.factor[row * self.scales + inner] * self.newton_move[self.free[inner]];
            }
            self.newton_move[self.free[row]] = entry / self.factor[row * self.scales + row];
        }
        for row in (0..size).rev() {
            let mut entry = self.newton_move[self.free[row]];
            for inner in row + 1..size {
                entry -=
                    self.factor[inner * self.scales + row] * self.newton_move[self.free[inner]];
            }
            self.newton_move[self.free[row]] = entry / self.factor[row * self.scales + row];
        }
    }

    /// Returns the fraction of `newton_move` that stays inside the box, and the bound that limits
    /// it.
    fn allowed_move(&self) -> AllowedMove {
        let mut fraction = 1.0;
        let mut blocking = None;
        for &scale in &self.free {
            let target = self.step[scale] + self.newton_move[scale];
            let end = if target < self.low[scale] {
                self.low[scale]
            } else if target > self.high[scale] {
                self.high[scale]
            } else {
                continue;
            };
            let allowed = ((end - self.step[scale]) / self.newton_move[scale]).max(0.0);
            // `is_none`: if rounding raises `allowed` to 1 although the target is outside the box,
            // the bound still ends the move.
            if allowed < fraction || blocking.is_none() {
                fraction = allowed.min(fraction);
                blocking = Some(Blocking { scale, end });
            }
        }
        AllowedMove { fraction, blocking }
    }

    /// Computes `slope = g + H step`.
    fn update_slope(&mut self, gradient: &[f64], hessian: &[f64]) {
        for scale in 0..self.scales {
            let row = &hessian[scale * self.scales..(scale + 1) * self.scales];
            self.slope[scale] =
                gradient[scale] + row.iter().zip(&self.step).map(|(h, d)| h * d).sum::<f64>();
        }
    }

    /// Returns the scale on an active bound from which the model decreases most steeply into the
    /// box; `None` if there is none, so that the minimum is reached.
    fn steepest_active_bound(&self) -> Option<usize> {
        let largest_slope = self
            .slope
            .iter()
            .fold(0.0_f64, |most, slope| most.max(slope.abs()));
        let mut steepest = None;
        // Descents below this are rounding errors.
        let mut greatest = SLOPE_ROUNDING * largest_slope;
        for scale in 0..self.scales {
            if self.is_free[scale] || self.low[scale] >= self.high[scale] {
                continue;
            }
            // Decrease per unit of an inward step: upwards from a lower bound, downwards from an
            // upper bound.
            let descent = if self.step[scale] <= self.low[scale] {
                -self.slope[scale]
            } else {
                self.slope[scale]
            };
            if descent > greatest {
                greatest = descent;
                steepest = Some(scale);
            }
        }
        steepest
    }
}

/// How far a move stays inside the box.
struct AllowedMove {
    /// Fraction of the move inside the box; 1 for the whole move.
    fraction: f64,
    /// The first bound that the move reaches; `None` if the whole move is inside the box.
    blocking: Option<Blocking>,
}

/// A bound that ends a move.
struct Blocking {
    scale: usize,
    /// Step at which the scale reaches its bound.
    end: f64,
}
