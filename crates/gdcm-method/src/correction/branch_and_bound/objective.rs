//! The objective as a function of the scales, after elimination of the constraints, and Newton's
//! method for a local minimum over their box.

use super::search::Effort;
use super::term::{Rounded, Term};

/// Value, gradient and Hessian (row-major) of a function of the scales, with bounds on the rounding
/// of value and gradient.
#[derive(Clone, Debug, Default)]
pub(crate) struct Expansion {
    pub(crate) value: Rounded,
    pub(crate) gradient: Vec<f64>,
    pub(crate) gradient_error: Vec<f64>,
    pub(crate) hessian: Vec<f64>,
}

impl Expansion {
    /// Zero expansion in `scales` scales.
    pub(crate) fn zero(scales: usize) -> Self {
        Self {
            value: Rounded::default(),
            gradient: vec![0.0; scales],
            gradient_error: vec![0.0; scales],
            hessian: vec![0.0; scales * scales],
        }
    }

    /// Resets the expansion to a constant value and keeps the allocated memory.
    pub(crate) fn clear(&mut self, constant: Rounded) {
        self.value = constant;
        self.gradient.fill(0.0);
        self.gradient_error.fill(0.0);
        self.hessian.fill(0.0);
    }

    /// Adds a function of `s_to - s_from` with this slope and curvature.
    pub(crate) fn add(&mut self, term: &Term, slope: Rounded, curvature: f64) {
        let scales = self.gradient.len();
        let from = term.from;
        let to = term.to;
        for (scale, slope) in [(to, slope), (from, -slope)] {
            let mut sum = Rounded {
                value: self.gradient[scale],
                error: self.gradient_error[scale],
            };
            sum.add(slope);
            (self.gradient[scale], self.gradient_error[scale]) = (sum.value, sum.error);
        }
        self.hessian[to * scales + to] += curvature;
        self.hessian[from * scales + from] += curvature;
        self.hessian[to * scales + from] -= curvature;
        self.hessian[from * scales + to] -= curvature;
    }
}

/// Treatment of the curvature of a concave term.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Curvature {
    True,
    /// The magnitude, which keeps the Hessian positive semidefinite far from a minimum.
    Magnitude,
}

/// A function of the scales that Newton's method can minimise.
pub(crate) trait Differentiable {
    /// Value, gradient and Hessian at `scales`.
    fn expand(&self, scales: &[f64], curvature: Curvature, into: &mut Expansion);

    /// Work of one expansion ([`super::search::Effort`]).
    fn work(&self) -> u64;
}

/// `constant + sum of terms`, over the box of the scales.
///
/// Scale `n - 1` is the *ground*: it is 0, so a term with it is a function of one scale only.
#[derive(Clone, Debug)]
pub(crate) struct Objective {
    /// Least value of each scale, the ground last.
    pub(crate) lower: Vec<f64>,
    /// Greatest value of each scale, the ground last.
    pub(crate) upper: Vec<f64>,
    /// At most one term for each pair of scales.
    pub(crate) terms: Vec<Term>,
    /// Part of the objective that does not depend on the scales.
    pub(crate) constant: Rounded,
}

impl Objective {
    /// Number of scales, with the ground.
    pub(crate) fn scales(&self) -> usize {
        self.lower.len()
    }

    /// Index of the scale that is always 0.
    pub(crate) fn ground(&self) -> usize {
        self.lower.len() - 1
    }

    /// The point of the box nearest to 0.
    pub(crate) fn nearest_to_zero(&self) -> Vec<f64> {
        self.lower
            .iter()
            .zip(&self.upper)
            .map(|(low, high)| 0.0_f64.clamp(*low, *high))
            .collect()
    }

    /// Value at `scales`.
    pub(crate) fn value(&self, scales: &[f64]) -> f64 {
        let at = |term: &Term| {
            term.function
                .at(scales[term.to] - scales[term.from])
                .value
                .value
        };
        self.constant.value + self.terms.iter().map(at).sum::<f64>()
    }

    /// Pieces that terms tie together but not to the ground: their scales are determined up to a
    /// common shift.
    pub(crate) fn floating_pieces(&self) -> Vec<Vec<usize>> {
        let ties = self.terms.iter().map(|term| (term.from, term.to));
        let pieces = pieces(self.scales(), ties).into_iter();
        pieces
            .filter(|piece| !piece.contains(&self.ground()))
            .collect()
    }

    /// The limit `alpha -> 0+`: moves each floating piece of `scales` by one common amount, as far
    /// as the box allows.
    ///
    /// `shift(piece)` returns the shift without the box. The fit does not depend on it, so it is
    /// set by the departure of the outputs' gains or delays (M8, M9).
    pub(crate) fn shift_floating_pieces(
        &self,
        scales: &mut [f64],
        mut shift: impl FnMut(&[usize], &[f64]) -> f64,
    ) {
        for piece in self.floating_pieces() {
            let least = piece
                .iter()
                .map(|&scale| self.lower[scale] - scales[scale])
                .fold(f64::NEG_INFINITY, f64::max);
            let most = piece
                .iter()
                .map(|&scale| self.upper[scale] - scales[scale])
                .fold(f64::INFINITY, f64::min);
            let shift = shift(&piece, scales).min(most).max(least);
            for &scale in &piece {
                scales[scale] = (scales[scale] + shift).clamp(self.lower[scale], self.upper[scale]);
            }
        }
    }
}

/// Connected pieces of the graph of `count` nodes with edges `ties`: the members of each, in rising
/// order.
pub(crate) fn pieces(count: usize, ties: impl Iterator<Item = (usize, usize)>) -> Vec<Vec<usize>> {
    let mut piece_of: Vec<usize> = (0..count).collect();
    for (one, other) in ties {
        let kept = piece_of[one];
        let merged = piece_of[other];
        piece_of
            .iter_mut()
            .filter(|piece| **piece == merged)
            .for_each(|piece| *piece = kept);
    }
    let members = |piece: usize| {
        (0..count)
            .filter(|&node| piece_of[node] == piece)
            .collect::<Vec<_>>()
    };
    (0..count)
        .map(members)
        .filter(|piece| !piece.is_empty())
        .collect()
}

impl Differentiable for Objective {
    fn expand(&self, scales: &[f64], curvature: Curvature, into: &mut Expansion) {
        into.clear(self.constant);
        for term in &self.terms {
            let at = term.function.at(scales[term.to] - scales[term.from]);
            into.value.add(at.value);
            into.add(
                term,
                at.slope,
                if curvature == Curvature::Magnitude {
                    at.curvature.abs()
                } else {
                    at.curvature
                },
            );
        }
    }

    fn work(&self) -> u64 {
        self.terms.len() as u64
    }
}

/// A projected Newton method: each step minimises the quadratic model over the box exactly, so that
/// the set of active bounds is right as soon as the model is. Clipping an unconstrained step
/// instead stalls at corners.
pub(crate) struct Newton<'a> {
    effort: &'a Effort<'a>,
    /// The function at the last point.
    pub(crate) reached: Expansion,
    trial: Expansion,
    model: QuadraticModel,
    next: Vec<f64>,
}

impl<'a> Newton<'a> {
    /// Allocates for `scales` scales; the work is counted in `effort`.
    pub(crate) fn new(scales: usize, effort: &'a Effort<'a>) -> Self {
        Self {
            effort,
            reached: Expansion::zero(scales),
            trial: Expansion::zero(scales),
            model: QuadraticModel::new(scales),
            next: vec![0.0; scales],
        }
    }

    /// Moves `scales` (inside the box) downhill until `enough(scales, expansion)` holds, rounding
    /// ends the descent or the effort is stopped; `reached` is then the function there.
    pub(crate) fn minimise(
        &mut self,
        function: &impl Differentiable,
        (lower, upper): (&[f64], &[f64]),
        scales: &mut [f64],
        mut enough: impl FnMut(&[f64], &Expansion) -> bool,
    ) {
        // Newton's method needs about ten steps; a flat start or a run along an inflection a few
        // tens.
        const STEPS: usize = 100;
        self.effort.spend(function.work());
        function.expand(scales, Curvature::True, &mut self.reached);
        let mut near = 0;
        for _ in 0..STEPS {
            if self.effort.is_stopped() || enough(scales, &self.reached) {
                return;
            }
            for scale in 0..scales.len() {
                self.model.low[scale] = lower[scale] - scales[scale];
                self.model.high[scale] = upper[scale] - scales[scale];
            }
            let Some((decrease, true_curvature)) = self.minimise_model(function, scales) else {
                return;
            };
            // This near to the minimum, three steps end at the rounding of the slopes, also across
            // the end of an envelope.
            near +=
                usize::from(true_curvature && decrease <= 1e-13 * self.reached.value.value.abs());
            if !self.search_line(function, (lower, upper), scales, decrease) || near == 3 {
                return;
            }
        }
    }

    /// Decrease of the model's step: with the true curvature (`true`) where the Hessian is positive
    /// definite, else with its magnitude.
    fn minimise_model(
        &mut self,
        function: &impl Differentiable,
        scales: &[f64],
    ) -> Option<(f64, bool)> {
        if let Some(decrease) = self.model.minimise(&self.reached, self.effort) {
            return Some((decrease, true));
        }
        self.effort.spend(function.work());
        function.expand(scales, Curvature::Magnitude, &mut self.reached);
        Some((self.model.minimise(&self.reached, self.effort)?, false))
    }

    /// Takes the longest halving of the step that decreases the function; `false` where none does,
    /// or where the step is zero.
    fn search_line(
        &mut self,
        function: &impl Differentiable,
        (lower, upper): (&[f64], &[f64]),
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
            self.place(fraction, (lower, upper), scales);
            self.effort.spend(function.work());
            function.expand(&self.next, Curvature::True, &mut self.trial);
            if self.trial.value.value <= here.value - 1e-4 * fraction * decrease + noise {
                scales.copy_from_slice(&self.next);
                std::mem::swap(&mut self.reached, &mut self.trial);
                // A step that no longer moves the scales by more than their rounding is the last.
                return fraction * longest > 1e-15;
            }
            fraction *= 0.5;
        }
        false
    }

    /// Writes the point at a fraction of the step, exactly on the bounds that the full step
    /// reaches.
    fn place(&mut self, fraction: f64, (lower, upper): (&[f64], &[f64]), scales: &[f64]) {
        for scale in 0..scales.len() {
            let step = self.model.step[scale];
            self.next[scale] = if fraction == 1.0 && step == self.model.low[scale] {
                lower[scale]
            } else if fraction == 1.0 && step == self.model.high[scale] {
                upper[scale]
            } else {
                (scales[scale] + fraction * step).clamp(lower[scale], upper[scale])
            };
        }
    }
}

/// The quadratic model of a step: `minimise` fills `step`.
#[derive(Clone, Debug)]
struct QuadraticModel {
    scales: usize,
    /// Least step of each scale, at most 0.
    low: Vec<f64>,
    /// Greatest step of each scale, at least 0.
    high: Vec<f64>,
    step: Vec<f64>,
    slope: Vec<f64>,
    free: Vec<usize>,
    is_free: Vec<bool>,
    factor: Vec<f64>,
    move_to: Vec<f64>,
}

impl QuadraticModel {
    /// Allocates for `scales` scales.
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

    /// Minimises `g d + d H d / 2`, with gradient and Hessian at a point, over `low <= d <= high`
    /// by a primal active-set method: exact, finite.
    ///
    /// Returns the decrease, or `None` where the effort is stopped or `H` is not positive definite
    /// on a face that the method visits. Nodes with `low == high` stay.
    fn minimise(&mut self, at: &Expansion, effort: &Effort<'_>) -> Option<f64> {
        let gradient = &at.gradient;
        let hessian = &at.hessian;
        self.step.fill(0.0);
        self.slope.copy_from_slice(gradient);
        for (scale, &slope) in gradient.iter().enumerate() {
            let stopped = (self.low[scale] >= 0.0 && slope >= 0.0)
                || (self.high[scale] <= 0.0 && slope <= 0.0);
            self.is_free[scale] = self.low[scale] < self.high[scale] && !stopped;
        }
        let ridge = 1e-12
            * (0..self.scales)
                .map(|scale| hessian[scale * self.scales + scale])
                .fold(0.0, f64::max);
        // Each pass adds a stop or releases one after a decrease; 8 n passes are far more than
        // needed.
        for _ in 0..8 * self.scales + 8 {
            effort.spend(self.work());
            if effort.is_stopped() {
                return None;
            }
            self.solve_free(hessian, ridge)?;
            let (fraction, blocking) = self.longest_step();
            for &scale in &self.free {
                self.step[scale] += fraction * self.move_to[scale];
            }
            self.update_slope(gradient, hessian);
            if let Some((scale, end)) = blocking {
                self.step[scale] = end;
                self.is_free[scale] = false;
            } else if let Some(scale) = self.worst_stop() {
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

    /// Work of one pass: a Cholesky factorisation of the free part, and the products with the
    /// whole.
    fn work(&self) -> u64 {
        let free = self.is_free.iter().filter(|is_free| **is_free).count() as u64;
        1 + free * free * free / 96 + (self.scales * self.scales) as u64 / 16
    }

    /// `move_to = -H_ff^-1 slope_f` over the free scales, by Cholesky.
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
                    // No curvature anywhere: the objective does not depend on the scales.
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

    /// Fraction of the move that the box allows, with the scale that stops it and its bound.
    fn longest_step(&self) -> (f64, Option<(usize, f64)>) {
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
                blocking = Some((scale, end));
            }
        }
        (fraction, blocking)
    }

    fn update_slope(&mut self, gradient: &[f64], hessian: &[f64]) {
        for scale in 0..self.scales {
            let row = &hessian[scale * self.scales..(scale + 1) * self.scales];
            self.slope[scale] =
                gradient[scale] + row.iter().zip(&self.step).map(|(h, d)| h * d).sum::<f64>();
        }
    }

    /// The stopped scale whose release helps most, or `None` at the minimum.
    fn worst_stop(&self) -> Option<usize> {
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
