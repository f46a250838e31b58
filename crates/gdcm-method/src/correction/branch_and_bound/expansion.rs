//! Second-order expansion in the scales: value, gradient and Hessian, as Newton's method and the
//! lower bounds need them. The *scales* are the unknowns in the search ([`super`]); each *term* in
//! the function depends on the difference between two of them.

use super::rounded::Rounded;
use super::term::Term;

/// Value, gradient and Hessian (row by row) with respect to the scales, with bounds on the rounding
/// errors in value and gradient.
#[derive(Clone, Debug, Default)]
pub(crate) struct Expansion {
    pub(crate) value: Rounded,
    pub(crate) gradient: Vec<f64>,
    pub(crate) gradient_error: Vec<f64>,
    pub(crate) hessian: Vec<f64>,
}

impl Expansion {
    /// Creates an expansion for `scales` scales with all values zero.
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

    /// Adds a term's slope `f'(u)` and curvature `f''(u)`, with `u = s_to - s_from`, to gradient
    /// and Hessian; the value is added separately.
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

/// Adds a term's curvature in `s_to - s_from` to a Hessian, scales x scales, row by row.
pub(super) fn add_curvature(hessian: &mut [f64], scales: usize, term: &Term, curvature: f64) {
    let from = term.from;
    let to = term.to;
    hessian[to * scales + to] += curvature;
    hessian[from * scales + from] += curvature;
    hessian[to * scales + from] -= curvature;
    hessian[from * scales + to] -= curvature;
}

/// How negative curvature is treated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Curvature {
    True,
    /// Replaced by its magnitude, which keeps the Hessian positive semidefinite far from a minimum.
    Magnitude,
}

/// A function of the scales that Newton's method can minimise.
pub(crate) trait Differentiable {
    /// Writes value, gradient and Hessian at `scales` to `into`.
    fn expand(&self, scales: &[f64], curvature: Curvature, into: &mut Expansion);

    /// Returns the work per expansion, in term evaluations ([`super::effort::Effort`]).
    fn work(&self) -> u64;
}

/// The box `lower <= s <= upper` for the scales; the ground is the last entry.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ScaleBox<'a> {
    pub(crate) lower: &'a [f64],
    pub(crate) upper: &'a [f64],
}
