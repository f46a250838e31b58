//! The objective as a function of the scales, after the constraints are eliminated:
//! `F(s) = constant + sum of terms f(s_to - s_from)` (formulas in [`super`]).

use super::rounded::Rounded;
use super::term::Term;
use crate::correction::connected_pieces::connected_pieces;

/// Value, gradient and Hessian (row by row) with respect to the scales, with bounds on the rounding
/// error of value and gradient.
#[derive(Clone, Debug, Default)]
pub(crate) struct Expansion {
    pub(crate) value: Rounded,
    pub(crate) gradient: Vec<f64>,
    pub(crate) gradient_error: Vec<f64>,
    pub(crate) hessian: Vec<f64>,
}

impl Expansion {
    /// Creates an expansion of zeros in `scales` scales.
    pub(crate) fn zero(scales: usize) -> Self {
        Self {
            value: Rounded::default(),
            gradient: vec![0.0; scales],
            gradient_error: vec![0.0; scales],
            hessian: vec![0.0; scales * scales],
        }
    }

    /// Resets the expansion to a constant value, without new memory.
    pub(crate) fn clear(&mut self, constant: Rounded) {
        self.value = constant;
        self.gradient.fill(0.0);
        self.gradient_error.fill(0.0);
        self.hessian.fill(0.0);
    }

    /// Adds the slope `f'(u)` and the curvature `f''(u)` of a term in `u = s_to - s_from` to
    /// gradient and Hessian; the value is added separately.
    pub(crate) fn add_derivatives(&mut self, term: &Term, slope: Rounded, curvature: f64) {
        self.add_to_gradient(term.to, slope);
        self.add_to_gradient(term.from, -slope);
        add_curvature(&mut self.hessian, self.gradient.len(), term, curvature);
    }

    fn add_to_gradient(&mut self, scale: usize, slope: Rounded) {
        let mut sum = Rounded {
            value: self.gradient[scale],
            error: self.gradient_error[scale],
        };
        sum.add(slope);
        self.gradient[scale] = sum.value;
        self.gradient_error[scale] = sum.error;
    }
}

/// Adds the curvature of a term in `s_to - s_from` to a Hessian, scales x scales, row by row.
pub(super) fn add_curvature(hessian: &mut [f64], scales: usize, term: &Term, curvature: f64) {
    let from = term.from;
    let to = term.to;
    hessian[to * scales + to] += curvature;
    hessian[from * scales + from] += curvature;
    hessian[to * scales + from] -= curvature;
    hessian[from * scales + to] -= curvature;
}

/// Treatment of negative curvature.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Curvature {
    True,
    /// Replaced by its magnitude, which keeps the Hessian positive semidefinite far from a minimum.
    Magnitude,
}

/// A function of the scales that can be minimised by Newton's method.
pub(crate) trait Differentiable {
    /// Writes value, gradient and Hessian at `scales` to `into`.
    fn expand(&self, scales: &[f64], curvature: Curvature, into: &mut Expansion);

    /// Returns the work of an expansion, in the unit of [`super::effort::Effort`].
    fn work(&self) -> u64;
}

/// The box `lower <= s <= upper` of the scales; the ground is the last entry.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ScaleBox<'a> {
    pub(crate) lower: &'a [f64],
    pub(crate) upper: &'a [f64],
}

/// The objective `constant + sum(terms)` over the box of scales.
///
/// Scale `n - 1` is the *ground*: it is 0, so that a term that contains the ground depends on a
/// single scale.
#[derive(Clone, Debug)]
pub(crate) struct Objective {
    /// Lower bound of each scale; the ground is the last entry.
    pub(crate) lower: Vec<f64>,
    /// Upper bound of each scale; the ground is the last entry.
    pub(crate) upper: Vec<f64>,
    /// At most one term for each pair of scales.
    pub(crate) terms: Vec<Term>,
    /// Part of the objective that does not depend on the scales.
    pub(crate) constant: Rounded,
}

impl Objective {
    /// Returns the number of scales, including the ground.
    pub(crate) fn scales(&self) -> usize {
        self.lower.len()
    }

    /// Returns the index of the ground, the scale that is always 0.
    pub(crate) fn ground(&self) -> usize {
        self.lower.len() - 1
    }

    /// Returns the whole box of scales.
    pub(crate) fn bounds(&self) -> ScaleBox<'_> {
        ScaleBox {
            lower: &self.lower,
            upper: &self.upper,
        }
    }

    /// Returns the point in the box that is nearest to 0.
    pub(crate) fn nearest_to_zero(&self) -> Vec<f64> {
        self.lower
            .iter()
            .zip(&self.upper)
            .map(|(low, high)| 0.0_f64.clamp(*low, *high))
            .collect()
    }

    /// Evaluates the objective at `scales`.
    pub(crate) fn value(&self, scales: &[f64]) -> f64 {
        let sum: f64 = self
            .terms
            .iter()
            .map(|term| term.function.evaluate(term.difference(scales)).value.value)
            .sum();
        self.constant.value + sum
    }

    /// Finds the *floating pieces*: groups of scales that terms connect with one another, but not
    /// with the ground. Their scales are determined only up to a common shift.
    pub(crate) fn floating_pieces(&self) -> Vec<Vec<usize>> {
        let ties = self.terms.iter().map(|term| [term.from, term.to]);
        let mut pieces = connected_pieces(self.scales(), ties);
        pieces.retain(|piece| !piece.contains(&self.ground()));
        pieces
    }

    /// Takes the limit `alpha -> 0+`: shifts all scales in each floating piece by a common amount,
    /// as far as the box allows.
    ///
    /// `shift(piece, scales)` returns the amount without regard to the box. The fit does not depend
    /// on the shift, so that it is determined by the deviations of the output gains (or delays)
    /// from neutral (M8, M9).
    pub(crate) fn shift_floating_pieces(
        &self,
        scales: &mut [f64],
        shift: impl Fn(&[usize], &[f64]) -> f64,
    ) {
        for piece in self.floating_pieces() {
            let mut least = f64::NEG_INFINITY;
            let mut most = f64::INFINITY;
            for &scale in &piece {
                least = least.max(self.lower[scale] - scales[scale]);
                most = most.min(self.upper[scale] - scales[scale]);
            }
            let shift = shift(&piece, scales).min(most).max(least);
            for &scale in &piece {
                scales[scale] = (scales[scale] + shift).clamp(self.lower[scale], self.upper[scale]);
            }
        }
    }
}

impl Differentiable for Objective {
    fn expand(&self, scales: &[f64], curvature: Curvature, into: &mut Expansion) {
        into.clear(self.constant);
        for term in &self.terms {
            let at = term.function.evaluate(term.difference(scales));
            into.value.add(at.value);
            let bend = match curvature {
                Curvature::True => at.curvature,
                Curvature::Magnitude => at.curvature.abs(),
            };
            into.add_derivatives(term, at.slope, bend);
        }
    }

    fn work(&self) -> u64 {
        self.terms.len() as u64
    }
}
