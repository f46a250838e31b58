//! The way down to a local minimum over the box of the scales.

use super::landscape::{Bend, Slope, Slopes};
use super::model::Model;

/// A projected Newton method: each step minimises the quadratic model over the box exactly, so that the set of active bounds is
/// right as soon as the model is. Clipping an unconstrained step instead stalls at corners.
#[derive(Clone, Debug)]
pub(crate) struct Descent {
    /// Value, gradient and curvature at the last point.
    pub(crate) slopes: Slopes,
    trial: Slopes,
    model: Model,
    low: Vec<f64>,
    high: Vec<f64>,
    next: Vec<f64>,
}

impl Descent {
    /// Room for `nodes` scales.
    pub(crate) fn new(nodes: usize) -> Self {
        Self {
            slopes: Slopes::zero(nodes),
            trial: Slopes::zero(nodes),
            model: Model::new(nodes),
            low: vec![0.0; nodes],
            high: vec![0.0; nodes],
            next: vec![0.0; nodes],
        }
    }

    /// Moves `scales` (inside the box) down until `enough(scales, slopes)` or until rounding stops it; `slopes` are those at
    /// the point reached.
    pub(crate) fn run(
        &mut self,
        function: &impl Slope,
        (lower, upper): (&[f64], &[f64]),
        scales: &mut [f64],
        mut enough: impl FnMut(&[f64], &Slopes) -> bool,
    ) {
        // Newton's method needs about ten steps; a flat start or a run along an inflection a few tens.
        const STEPS: usize = 100;
        function.slopes(scales, Bend::True, &mut self.slopes);
        let mut near = 0;
        for _ in 0..STEPS {
            if enough(scales, &self.slopes) {
                return;
            }
            for node in 0..scales.len() {
                self.low[node] = lower[node] - scales[node];
                self.high[node] = upper[node] - scales[node];
            }
            let Some((decrease, true_curvature)) = self.step_model(function, scales) else {
                return;
            };
            // Where Newton's method is this near, three steps end at the rounding of the slopes, also across the edge of an
            // envelope.
            near += usize::from(true_curvature && decrease <= 1e-13 * self.slopes.value.abs());
            if !self.walk(function, (lower, upper), scales, decrease) || near == 3 {
                return;
            }
        }
    }

    /// The decrease of the model's step: with the true curvature (`true`) where that is positive definite, else with its
    /// magnitude.
    fn step_model(&mut self, function: &impl Slope, scales: &[f64]) -> Option<(f64, bool)> {
        let Self { slopes, model, low, high, .. } = self;
        if let Some(decrease) = model.minimise(&slopes.gradient, &slopes.curvature, low, high) {
            return Some((decrease, true));
        }
        function.slopes(scales, Bend::Upward, slopes);
        Some((model.minimise(&slopes.gradient, &slopes.curvature, low, high)?, false))
    }

    /// Takes the longest of the step's halvings that goes down; `false` where none does, or where the step is nothing.
    fn walk(
        &mut self,
        function: &impl Slope,
        (lower, upper): (&[f64], &[f64]),
        scales: &mut [f64],
        decrease: f64,
    ) -> bool {
        let longest = self.model.step.iter().fold(0.0_f64, |most, step| most.max(step.abs()));
        if longest == 0.0 {
            return false;
        }
        let noise = 4.0 * f64::EPSILON * self.slopes.value.abs() + 0.25 * self.slopes.value_error;
        let mut fraction = 1.0;
        for _ in 0..40 {
            self.place(fraction, (lower, upper), scales);
            function.slopes(&self.next, Bend::True, &mut self.trial);
            if self.trial.value <= self.slopes.value - 1e-4 * fraction * decrease + noise {
                scales.copy_from_slice(&self.next);
                std::mem::swap(&mut self.slopes, &mut self.trial);
                // A step that no longer moves the scales by more than their rounding is the last.
                return fraction * longest > 1e-15;
            }
            fraction *= 0.5;
        }
        false
    }

    /// Writes the point a fraction of the step away, exactly on the bounds that the full step reaches.
    fn place(&mut self, fraction: f64, (lower, upper): (&[f64], &[f64]), scales: &[f64]) {
        for node in 0..scales.len() {
            let step = self.model.step[node];
            self.next[node] = if fraction == 1.0 && step == self.low[node] {
                lower[node]
            } else if fraction == 1.0 && step == self.high[node] {
                upper[node]
            } else {
                (scales[node] + fraction * step).clamp(lower[node], upper[node])
            };
        }
    }
}
