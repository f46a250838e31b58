//! The objective after the constraints are eliminated, as a function of the scales.

use super::{Rounded, Term};

/// Value, gradient and Hessian (row-major) of a function of the scales, with bounds on the rounding of the first two.
#[derive(Clone, Debug, Default)]
pub(crate) struct Expansion {
    pub(crate) value: Rounded,
    pub(crate) gradient: Vec<f64>,
    pub(crate) gradient_error: Vec<f64>,
    pub(crate) hessian: Vec<f64>,
}

impl Expansion {
    /// Zero, for so many scales.
    pub(crate) fn zero(scales: usize) -> Self {
        Self {
            value: Rounded::default(),
            gradient: vec![0.0; scales],
            gradient_error: vec![0.0; scales],
            hessian: vec![0.0; scales * scales],
        }
    }

    /// Forgets everything but a constant value, keeping the memory.
    pub(crate) fn clear(&mut self, constant: Rounded) {
        self.value = constant;
        self.gradient.fill(0.0);
        self.gradient_error.fill(0.0);
        self.hessian.fill(0.0);
    }

    /// Adds a function of `s_to - s_from` with this slope and curvature.
    pub(crate) fn add(&mut self, term: &Term, slope: Rounded, curvature: f64) {
        let (scales, from, to) = (self.gradient.len(), term.from, term.to);
        for (scale, slope) in [(to, slope), (from, Rounded { value: -slope.value, error: slope.error })] {
            let mut sum = Rounded { value: self.gradient[scale], error: self.gradient_error[scale] };
            sum.add(slope);
            (self.gradient[scale], self.gradient_error[scale]) = (sum.value, sum.error);
        }
        self.hessian[to * scales + to] += curvature;
        self.hessian[from * scales + from] += curvature;
        self.hessian[to * scales + from] -= curvature;
        self.hessian[from * scales + to] -= curvature;
    }
}

/// How the curvature of a concave term is entered.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Curvature {
    /// As it is.
    True,
    /// As its magnitude, which keeps the Hessian positive semidefinite far from a minimum.
    Magnitude,
}

/// A function of the scales that Newton's method can follow.
pub(crate) trait Differentiable {
    /// Value, gradient and Hessian at `scales`.
    fn expand(&self, scales: &[f64], curvature: Curvature, into: &mut Expansion);

    /// Work of one expansion ([`super::Effort`]).
    fn work(&self) -> u64;
}

/// `constant + sum of terms`, over the box of the scales.
///
/// Scale `n - 1` is the *ground*: it is 0, so a term with it is a function of one scale.
#[derive(Clone, Debug)]
pub(crate) struct Objective {
    /// Least value of each scale, the ground last.
    pub(crate) lower: Vec<f64>,
    /// Greatest value of each scale, the ground last.
    pub(crate) upper: Vec<f64>,
    /// Every term, at most one for each two scales.
    pub(crate) terms: Vec<Term>,
    /// What no scale changes.
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
        self.lower.iter().zip(&self.upper).map(|(low, high)| 0.0_f64.clamp(*low, *high)).collect()
    }

    /// Value at `scales`.
    pub(crate) fn value(&self, scales: &[f64]) -> f64 {
        let at = |term: &Term| term.function.at(scales[term.to] - scales[term.from]).value.value;
        self.constant.value + self.terms.iter().map(at).sum::<f64>()
    }

    /// The pieces that terms tie together but not to the ground: their scales are determined up to a common shift.
    pub(crate) fn floating_pieces(&self) -> Vec<Vec<usize>> {
        let ties = self.terms.iter().map(|term| (term.from, term.to));
        let pieces = pieces(self.scales(), ties).into_iter();
        pieces.filter(|piece| !piece.contains(&self.ground())).collect()
    }

    /// The limit `alpha -> 0+`: moves each floating piece of `scales` by one common amount, as far as the box allows.
    ///
    /// `shift(piece)` is the amount that the piece would take without the box. The fit does not depend on it, so the departure of
    /// the outputs' gains or delays decides (M8, M9).
    pub(crate) fn shift_floating_pieces(&self, scales: &mut [f64], mut shift: impl FnMut(&[usize], &[f64]) -> f64) {
        for piece in self.floating_pieces() {
            let least = piece.iter().map(|&scale| self.lower[scale] - scales[scale]).fold(f64::NEG_INFINITY, f64::max);
            let most = piece.iter().map(|&scale| self.upper[scale] - scales[scale]).fold(f64::INFINITY, f64::min);
            let shift = shift(&piece, scales).min(most).max(least);
            for &scale in &piece {
                scales[scale] = (scales[scale] + shift).clamp(self.lower[scale], self.upper[scale]);
            }
        }
    }
}

/// What `ties` connect of `count` nodes: the members of each connected piece, in rising order.
pub(crate) fn pieces(count: usize, ties: impl Iterator<Item = (usize, usize)>) -> Vec<Vec<usize>> {
    let mut piece_of: Vec<usize> = (0..count).collect();
    for (one, other) in ties {
        let (kept, merged) = (piece_of[one], piece_of[other]);
        piece_of.iter_mut().filter(|piece| **piece == merged).for_each(|piece| *piece = kept);
    }
    let members = |piece: usize| (0..count).filter(|&node| piece_of[node] == piece).collect::<Vec<_>>();
    (0..count).map(members).filter(|piece| !piece.is_empty()).collect()
}

impl Differentiable for Objective {
    fn expand(&self, scales: &[f64], curvature: Curvature, into: &mut Expansion) {
        into.clear(self.constant);
        for term in &self.terms {
            let at = term.function.at(scales[term.to] - scales[term.from]);
            into.value.add(at.value);
            into.add(term, at.slope, if curvature == Curvature::Magnitude { at.curvature.abs() } else { at.curvature });
        }
    }

    fn work(&self) -> u64 {
        self.terms.len() as u64
    }
}
