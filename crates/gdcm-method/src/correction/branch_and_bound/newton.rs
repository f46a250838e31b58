//! Newton's method for a local minimum over the box `lower <= s <= upper` of the scales.
//!
//! With the gradient `g` and the Hessian `H` at the current point, the quadratic model of the
//! function is `g' d + d' H d / 2`, where `d` is the step.

use super::effort::Effort;
use super::objective::{Curvature, Differentiable, Expansion, ScaleBox};

/// Maximum number of steps: about ten are typical; a flat start or an inflection requires a few
/// tens.
const STEPS: usize = 100;
/// Predicted decrease, relative to the value, that is near the minimum.
const NEAR_MINIMUM: f64 = 1e-13;
/// Number of steps near the minimum, which reach the rounding level of the slopes, even across the
/// end of an envelope.
const STEPS_NEAR_MINIMUM: usize = 3;
/// Share of the predicted decrease that a step must attain (Armijo).
const SUFFICIENT_DECREASE: f64 = 1e-4;
/// Maximum number of trials with a halved step.
const HALVINGS: usize = 40;
/// Rounding level of the scales: a shorter step ends the descent.
const LEAST_STEP: f64 = 1e-15;

/// A projected Newton method.
///
/// ```text
/// 1  quadratic model at the current point; the step leads to its minimum over the box
/// 2  halve the step until the function decreases
/// 3  repeat from 1, until the step is at rounding level or `enough` holds
/// ```
///
/// Each step minimises the model over the box exactly, so that the active bounds are correct as
/// soon as the model is. Clipping an unconstrained step instead would stall at corners.
pub(crate) struct Newton<'a> {
    effort: &'a Effort<'a>,
    /// Expansion of the function at the final point.
    pub(crate) reached: Expansion,
    /// Expansion of the function at the point that is tried next.
    trial: Expansion,
    model: QuadraticModel,
    /// The point that is tried next.
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
        self.effort.spend(function.work());
        function.expand(scales, Curvature::True, &mut self.reached);
        let mut steps_near = 0;
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
            if step.has_true_curvature
                && step.decrease <= NEAR_MINIMUM * self.reached.value.value.abs()
            {
                steps_near += 1;
            }
            let moved = self.search_line(function, bounds, scales, step.decrease);
            if !moved || steps_near == STEPS_NEAR_MINIMUM {
                return;
            }
        }
    }

    /// Step 1: minimises the quadratic model, with the true curvature if the Hessian is positive
    /// definite, otherwise with the curvature's magnitude. `None` if neither has a minimum.
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

    /// Step 2: halves the step until the function decreases, and takes it; returns `false` if no
    /// step decreases the function, or if the step is at rounding level.
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
        for _ in 0..HALVINGS {
            self.place(fraction, bounds, scales);
            self.effort.spend(function.work());
            function.expand(&self.next, Curvature::True, &mut self.trial);
            if self.trial.value.value
                <= here.value - SUFFICIENT_DECREASE * fraction * decrease + noise
            {
                scales.copy_from_slice(&self.next);
                std::mem::swap(&mut self.reached, &mut self.trial);
                return fraction * longest > LEAST_STEP;
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

/// Quadratic model `g' d + d' H d / 2` of the function over the box `low <= d <= high`. The caller
/// sets `low` and `high`; [`QuadraticModel::minimise`] finds `step`.
#[derive(Clone, Debug)]
struct QuadraticModel {
    /// Number of scales.
    scales: usize,
    /// Lower bound on the step of each scale, at most 0.
    low: Vec<f64>,
    /// Upper bound on the step of each scale, at least 0.
    high: Vec<f64>,
    /// The step `d`.
    step: Vec<f64>,
    /// Slope `g + H d` of the model after the step.
    slope: Vec<f64>,
    /// Scales without an active bound, in ascending order.
    free: Vec<usize>,
    is_free: Vec<bool>,
    /// Lower Cholesky factor of the Hessian of the free scales. Its rows and columns are places in
    /// `free`, not scales; each row has memory for all scales.
    factor: Vec<f64>,
    /// Further step to the unbounded minimum over the free scales, by scale.
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

    /// Minimises the model, with the gradient and Hessian of `at`, over `low <= d <= high` by a
    /// primal active-set method, which is exact and finite.
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
        // Added to the diagonal, far below the curvature of any scale that matters.
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

    /// Computes `move_to = -H_ff^-1 slope_f` over the free scales, where `H_ff` is the Hessian of
    /// these scales. `None` if it is not positive definite.
    fn solve_free(&mut self, hessian: &[f64], ridge: f64) -> Option<()> {
        self.free.clear();
        self.free
            .extend((0..self.scales).filter(|&scale| self.is_free[scale]));
        self.factorise_free(hessian, ridge)?;
        self.substitute();
        Some(())
    }

    /// Writes the Cholesky factor of `H_ff + ridge I` to `factor`; `None` if it is not positive
    /// definite. `row`, `column` and `inner` are places in `free`.
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
        Some(())
    }

    /// Solves `factor factor' move_to = -slope` for the free scales, forwards, then backwards.
    fn substitute(&mut self) {
        let size = self.free.len();
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
        let largest_slope = self
            .slope
            .iter()
            .fold(0.0_f64, |most, slope| most.max(slope.abs()));
        let mut worst = None;
        // Smaller slopes are rounding errors.
        let mut greatest = 1e-14 * largest_slope;
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
