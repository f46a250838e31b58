//! Newton's method for a local minimum over the box of scales.

use super::effort::Effort;
use super::objective::{Curvature, Differentiable, Expansion, ScaleBox};

/// A projected Newton method.
///
/// ```text
/// 1  quadratic model at the current point; the step leads to its minimum over the box
/// 2  halve the step until the function decreases
/// 3  stop when the step is at rounding level, or when `enough` holds
/// ```
///
/// Each step minimises the model over the box exactly, so that the active bounds are correct as
/// soon as the model is. Clipping an unconstrained step instead would stall at corners.
pub(crate) struct Newton<'a> {
    effort: &'a Effort<'a>,
    /// Expansion of the function at the final point.
    pub(crate) reached: Expansion,
    trial: Expansion,
    model: QuadraticModel,
    next: Vec<f64>,
}

impl<'a> Newton<'a> {
    /// Allocates the memory for `scales` scales; `effort` counts the work.
    pub(crate) fn new(scales: usize, effort: &'a Effort<'a>) -> Self {
        Self {
            effort,
            reached: Expansion::zero(scales),
            trial: Expansion::zero(scales),
            model: QuadraticModel::new(scales),
            next: vec![0.0; scales],
        }
    }

    /// Moves `scales`, a point inside the box, downhill until `enough(scales, expansion)` holds,
    /// the descent reaches rounding level, or the effort is stopped. Stores the expansion at the
    /// final point in `reached`.
    pub(crate) fn minimise(
        &mut self,
        function: &impl Differentiable,
        bounds: ScaleBox<'_>,
        scales: &mut [f64],
        mut enough: impl FnMut(&[f64], &Expansion) -> bool,
    ) {
        // About ten steps are typical; a flat start or an inflection requires a few tens.
        const STEPS: usize = 100;
        self.effort.spend(function.work());
        function.expand(scales, Curvature::True, &mut self.reached);
        let mut near = 0;
        for _ in 0..STEPS {
            if self.effort.is_stopped() || enough(scales, &self.reached) {
                return;
            }
            for (index, scale) in scales.iter().enumerate() {
                self.model.low[index] = bounds.lower[index] - scale;
                self.model.high[index] = bounds.upper[index] - scale;
            }
            let Some(step) = self.minimise_model(function, scales) else {
                return;
            };
            // This close to the minimum, three further steps reach the rounding level of the
            // slopes, even across the end of an envelope.
            if step.has_true_curvature && step.decrease <= 1e-13 * self.reached.value.value.abs() {
                near += 1;
            }
            let moved = self.search_line(function, bounds, scales, step.decrease);
            if !moved || near == 3 {
                return;
            }
        }
    }

    /// Minimises the quadratic model, with the true curvature if the Hessian is positive definite,
    /// otherwise with the curvature's magnitude. `None` if neither has a minimum.
    fn minimise_model(
        &mut self,
        function: &impl Differentiable,
        scales: &[f64],
    ) -> Option<ModelStep> {
        if let Some(decrease) = self.model.minimise(&self.reached, self.effort) {
            return Some(ModelStep {
                decrease,
                has_true_curvature: true,
            });
        }
        self.effort.spend(function.work());
        function.expand(scales, Curvature::Magnitude, &mut self.reached);
        let decrease = self.model.minimise(&self.reached, self.effort)?;
        Some(ModelStep {
            decrease,
            has_true_curvature: false,
        })
    }

    /// Halves the step until the function decreases, and takes it; returns `false` if no step
    /// decreases the function, or if the step is at rounding level.
    fn search_line(
        &mut self,
        function: &impl Differentiable,
        bounds: ScaleBox<'_>,
        scales: &mut [f64],
        decrease: f64,
    ) -> bool {
        let longest = self
            .model
            .step
            .iter()
            .fold(0.0_f64, |most, step| most.max(step.abs()));
        if longest == 0.0 {
            return false;
        }
        let here = self.reached.value;
        let noise = 4.0 * f64::EPSILON * here.value.abs() + 0.25 * here.error;
        let mut fraction = 1.0;
        for _ in 0..40 {
            self.place(fraction, bounds, scales);
            self.effort.spend(function.work());
            function.expand(&self.next, Curvature::True, &mut self.trial);
            if self.trial.value.value <= here.value - 1e-4 * fraction * decrease + noise {
                scales.copy_from_slice(&self.next);
                std::mem::swap(&mut self.reached, &mut self.trial);
                // Stop after a step below the rounding level of the scales.
                return fraction * longest > 1e-15;
            }
            fraction *= 0.5;
        }
        false
    }

    /// Writes the point at a fraction of the step to `next`; a full step that ends on a bound is
    /// placed exactly on it.
    fn place(&mut self, fraction: f64, bounds: ScaleBox<'_>, scales: &[f64]) {
        for (index, scale) in scales.iter().enumerate() {
            let step = self.model.step[index];
            self.next[index] = if fraction == 1.0 && step == self.model.low[index] {
                bounds.lower[index]
            } else if fraction == 1.0 && step == self.model.high[index] {
                bounds.upper[index]
            } else {
                (scale + fraction * step).clamp(bounds.lower[index], bounds.upper[index])
            };
        }
    }
}

/// Step to the minimum of the quadratic model.
struct ModelStep {
    /// Predicted decrease of the model over the step.
    decrease: f64,
    /// Whether the model uses the function's curvature, not its magnitude.
    has_true_curvature: bool,
}

/// Quadratic model of the function over the box; `minimise` fills `step`.
#[derive(Clone, Debug)]
struct QuadraticModel {
    scales: usize,
    /// Lower bound on the step of each scale, at most 0.
    low: Vec<f64>,
    /// Upper bound on the step of each scale, at least 0.
    high: Vec<f64>,
    step: Vec<f64>,
    /// Slope of the model after the step.
    slope: Vec<f64>,
    /// Scales without an active bound, in ascending order.
    free: Vec<usize>,
    is_free: Vec<bool>,
    /// Cholesky factor of the Hessian of the free scales, row by row.
    factor: Vec<f64>,
    /// Step to the unbounded minimum, for each free scale.
    move_to: Vec<f64>,
}

impl QuadraticModel {
    /// Allocates the memory for `scales` scales.
    fn new(scales: usize) -> Self {
        Self {
            scales,
            low: vec![0.0; scales],
            high: vec![0.0; scales],
            step: vec![0.0; scales],
            slope: vec![0.0; scales],
            free: Vec::with_capacity(scales),
            is_free: vec![false; scales],
            factor: vec![0.0; scales * scales],
            move_to: vec![0.0; scales],
        }
    }

    /// Minimises `g d + d H d / 2`, with the gradient and Hessian at a point, over
    /// `low <= d <= high` by a primal active-set method, which is exact and finite.
    ///
    /// ```text
    /// 1  free: every scale, unless its slope pushes it against its bound
    /// 2  move to the minimum over the free scales, as far as the box allows
    /// 3  if a bound ends the move, make it active and repeat from 2
    /// 4  release the active bound with the largest inward slope and repeat from 2; stop if there is none
    /// ```
    ///
    /// Returns the decrease, or `None` if the effort is stopped or `H` is not positive definite on
    /// a face that the method visits. Scales with `low == high` do not move.
    fn minimise(&mut self, at: &Expansion, effort: &Effort<'_>) -> Option<f64> {
        let gradient = &at.gradient;
        let hessian = &at.hessian;
        self.step.fill(0.0);
        self.slope.copy_from_slice(gradient);
        for (scale, &slope) in gradient.iter().enumerate() {
            let is_pressed = (self.low[scale] >= 0.0 && slope >= 0.0)
                || (self.high[scale] <= 0.0 && slope <= 0.0);
            self.is_free[scale] = self.low[scale] < self.high[scale] && !is_pressed;
        }
        let ridge = 1e-12
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
            self.solve_free(hessian, ridge)?;
            let allowed = self.longest_step();
            for &scale in &self.free {
                self.step[scale] += allowed.fraction * self.move_to[scale];
            }
            self.update_slope(gradient, hessian);
            if let Some(blocking) = allowed.blocking {
                self.step[blocking.scale] = blocking.end;
                self.is_free[blocking.scale] = false;
            } else if let Some(scale) = self.worst_active_bound() {
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

    /// Returns the work of a pass: a Cholesky factorisation of the free part, and products with the
    /// whole Hessian.
    fn work(&self) -> u64 {
        let free = self.is_free.iter().filter(|is_free| **is_free).count() as u64;
        1 + free * free * free / 96 + (self.scales * self.scales) as u64 / 16
    }

    /// Computes `move_to = -H_ff^-1 slope_f` over the free scales by a Cholesky factorisation.
    /// `None` if `H_ff` is not positive definite.
    fn solve_free(&mut self, hessian: &[f64], ridge: f64) -> Option<()> {
        self.free.clear();
        self.free
            .extend((0..self.scales).filter(|&scale| self.is_free[scale]));
        let size = self.free.len();
        for row in 0..size {
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
                } else if entry > 0.1 * ridge {
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
        for row in 0..size {
            let mut entry = -self.slope[self.free[row]];
            for inner in 0..row {
                entry -= self.factor[row * self.scales + inner] * self.move_to[self.free[inner]];
            }
            self.move_to[self.free[row]] = entry / self.factor[row * self.scales + row];
        }
        for row in (0..size).rev() {
            let mut entry = self.move_to[self.free[row]];
            for inner in row + 1..size {
                entry -= self.factor[inner * self.scales + row] * self.move_to[self.free[inner]];
            }
            self.move_to[self.free[row]] = entry / self.factor[row * self.scales + row];
        }
        Some(())
    }

    /// Returns the fraction of `move_to` that stays inside the box, and the bound that limits it.
    fn longest_step(&self) -> AllowedMove {
        let mut fraction = 1.0;
        let mut blocking = None;
        for &scale in &self.free {
            let target = self.step[scale] + self.move_to[scale];
            let end = if target < self.low[scale] {
                self.low[scale]
            } else if target > self.high[scale] {
                self.high[scale]
            } else {
                continue;
            };
            let allowed = ((end - self.step[scale]) / self.move_to[scale]).max(0.0);
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
    fn worst_active_bound(&self) -> Option<usize> {
        let scale = self
            .slope
            .iter()
            .fold(0.0_f64, |most, slope| most.max(slope.abs()));
        let mut worst = None;
        let mut greatest = 1e-14 * scale;
        for scale in 0..self.scales {
            if self.is_free[scale] || self.low[scale] >= self.high[scale] {
                continue;
            }
            let inward = if self.step[scale] <= self.low[scale] {
                -self.slope[scale]
            } else {
                self.slope[scale]
            };
            if inward > greatest {
                greatest = inward;
                worst = Some(scale);
            }
        }
        worst
    }
}

/// The part of a move that lies inside the box.
struct AllowedMove {
    /// Share of the move; 1 for the whole move.
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
