//! Newton's method for a local minimum over the box `lower <= s <= upper`.
//!
//! With the gradient `g` and the Hessian `H` at the current point, the function's quadratic model
//! is `g' d + d' H d / 2`, where `d` is the step; `active_set` minimises it over the box. The
//! unknowns `s` are the *scales* ([`super`]). The function is the objective or, for a lower bound,
//! its convex underestimator.

use super::active_set::QuadraticModel;
use super::effort::Effort;
use super::expansion::{Curvature, Differentiable, Expansion, ScaleBox};

/// Maximum step count: about ten are typical; a flat start or an inflection requires a few tens.
const STEPS: usize = 100;
/// Predicted decrease, relative to the value, below which a point counts as near the minimum.
const NEAR_MINIMUM: f64 = 1e-13;
/// Steps near the minimum: enough for the slopes to reach rounding level, even where an envelope
/// changes from its line to the exponential.
const STEPS_NEAR_MINIMUM: usize = 3;
/// Minimum ratio between a step's actual and predicted decrease (Armijo).
const SUFFICIENT_DECREASE: f64 = 1e-4;
/// Maximum number of times that a step is halved.
const HALVINGS: usize = 40;
/// The scales' rounding level: a shorter step ends the descent.
const LEAST_STEP: f64 = 1e-15;

/// A projected Newton method.
///
/// ```text
/// 1  step to the minimum, over the box, of the quadratic model at the current point; if the
///    Hessian is not positive definite, of the model with the curvature's magnitude; end if that
///    has no minimum either
/// 2  halve the step until the function decreases; end if it does not
/// 3  repeat from 1, until `enough` holds, the step is at rounding level, three steps were made
///    near the minimum, or after 100 steps
/// ```
///
/// Each step minimises the model over the box exactly, so that the active bounds are correct as
/// soon as the model is. Clipping an unconstrained step instead would stall at corners.
pub(crate) struct Newton<'a> {
    effort: &'a Effort<'a>,
    /// The function's expansion at the final point.
    pub(crate) reached: Expansion,
    /// The function's expansion at `next`.
    trial: Expansion,
    model: QuadraticModel,
    /// The point to be tried next.
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
    /// the descent reaches rounding level, 100 steps are made, or the effort is stopped. Stores the
    /// expansion at the final point in `reached`.
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
            // Step 1
            self.model.set_box(bounds, scales);
            let Some(step) = self.minimise_model(function, scales) else {
                return;
            };
            if step.has_true_curvature
                && step.decrease <= NEAR_MINIMUM * self.reached.value.value.abs()
            {
                steps_near += 1;
            }
            // Steps 2 and 3
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
        // Increases up to this count as rounding.
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

    /// Writes the point that a fraction of the step reaches to `next`; a full step that ends on a
    /// bound is placed exactly on it.
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

/// Step to the quadratic model's minimum.
struct ModelStep {
    /// The model's decrease over the step.
    decrease: f64,
    /// Whether the model uses the function's curvature, not its magnitude.
    has_true_curvature: bool,
}
