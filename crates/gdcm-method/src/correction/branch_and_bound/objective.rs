//! The objective as a function of the scales, after the constraints are eliminated.

use super::rounded::Rounded;
use super::term::Term;

/// Value, gradient and Hessian (row-major) in the scales, with bounds on the rounding in value and
/// gradient.
#[derive(Clone, Debug, Default)]
pub(crate) struct Expansion {
    pub(crate) value: Rounded,
    pub(crate) gradient: Vec<f64>,
    pub(crate) gradient_error: Vec<f64>,
    pub(crate) hessian: Vec<f64>,
}

impl Expansion {
    /// Creates a zero expansion in `scales` scales.
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

    /// Adds a term's slope and curvature; its value is added separately.
    pub(crate) fn add(&mut self, term: &Term, slope: Rounded, curvature: f64) {
        let scales = self.gradient.len();
        let from = term.from;
        let to = term.to;
        self.add_to_gradient(to, slope);
        self.add_to_gradient(from, -slope);
        self.hessian[to * scales + to] += curvature;
        self.hessian[from * scales + from] += curvature;
        self.hessian[to * scales + from] -= curvature;
        self.hessian[from * scales + to] -= curvature;
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

/// Treatment of concave curvature.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Curvature {
    True,
    /// The magnitude, which keeps the Hessian positive semidefinite far from a minimum.
    Magnitude,
}

/// A function of the scales that Newton's method can minimise.
pub(crate) trait Differentiable {
    /// Writes value, gradient and Hessian at `scales`.
    fn expand(&self, scales: &[f64], curvature: Curvature, into: &mut Expansion);

    /// Work of an expansion ([`super::effort::Effort`]).
    fn work(&self) -> u64;
}

/// The scale box `lower <= s <= upper`, the ground last.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ScaleBox<'a> {
    pub(crate) lower: &'a [f64],
    pub(crate) upper: &'a [f64],
}

/// `constant + sum(terms)`, over the scale box.
///
/// Scale `n - 1` is the *ground*: it is 0, so a term that contains the ground depends on a single
/// scale.
#[derive(Clone, Debug)]
pub(crate) struct Objective {
    /// Minimum of each scale, the ground last.
    pub(crate) lower: Vec<f64>,
    /// Maximum of each scale, the ground last.
    pub(crate) upper: Vec<f64>,
    /// At most one term for each pair of scales.
    pub(crate) terms: Vec<Term>,
    /// Part that does not depend on the scales.
    pub(crate) constant: Rounded,
}

impl Objective {
    /// Returns the number of scales, including the ground.
    pub(crate) fn scales(&self) -> usize {
        self.lower.len()
    }

    /// Index of the scale that is always 0.
    pub(crate) fn ground(&self) -> usize {
        self.lower.len() - 1
    }

    /// Returns the whole box.
    pub(crate) fn bounds(&self) -> ScaleBox<'_> {
        ScaleBox {
            lower: &self.lower,
            upper: &self.upper,
        }
    }

    /// Returns the point in the box nearest to 0.
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
            .map(|term| term.function.at(term.difference(scales)).value.value)
            .sum();
        self.constant.value + sum
    }

    /// Finds the scale pieces that terms tie together but not to the ground: their scales are
    /// determined up to a common shift.
    pub(crate) fn floating_pieces(&self) -> Vec<Vec<usize>> {
        let ties = self.terms.iter().map(|term| [term.from, term.to]);
        let mut pieces = connected_pieces(self.scales(), ties);
        pieces.retain(|piece| !piece.contains(&self.ground()));
        pieces
    }

    /// Takes the limit `alpha -> 0+`: moves each floating piece in `scales` by a common amount, as
    /// far as the box allows.
    ///
    /// `shift(piece, scales)` returns the shift without the box. The fit does not depend on the
    /// shift, so the departures of the outputs determine it (M8, M9).
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
            let at = term.function.at(term.difference(scales));
            into.value.add(at.value);
            let bend = match curvature {
                Curvature::True => at.curvature,
                Curvature::Magnitude => at.curvature.abs(),
            };
            into.add(term, at.slope, bend);
        }
    }

    fn work(&self) -> u64 {
        self.terms.len() as u64
    }
}

/// Finds the connected pieces in a graph on `count` nodes with these edges: each lists its members
/// in rising order.
pub(crate) fn connected_pieces(
    count: usize,
    edges: impl Iterator<Item = [usize; 2]>,
) -> Vec<Vec<usize>> {
    let mut piece_of: Vec<usize> = (0..count).collect();
    for [a, b] in edges {
        let kept = piece_of[a];
        let merged = piece_of[b];
        for piece in &mut piece_of {
            if *piece == merged {
                *piece = kept;
            }
        }
    }
    let mut pieces = vec![Vec::new(); count];
    for (node, &piece) in piece_of.iter().enumerate() {
        pieces[piece].push(node);
    }
    pieces.retain(|piece| !piece.is_empty());
    pieces
}
