//! The objective as a function of the scales, after the constraints are eliminated:
//! `F(s) = constant + sum of terms f(s_to - s_from)` (formulas in [`super`]). A *scale* `s_i` is
//! the coordinate that the constraints leave free in a component of connected channels: it
//! determines the gain or delay of each of them.

use super::expansion::{Curvature, Differentiable, Expansion, ScaleBox};
use super::rounded::Rounded;
use super::term::Term;
use crate::correction::connected_pieces::connected_pieces;

/// The objective `constant + sum(terms)` over a box.
///
/// Scale `n - 1` is the *ground*: it is 0, so that a term that contains the ground depends on a
/// single scale.
#[derive(Clone, Debug)]
pub(crate) struct Objective {
    /// Lower bound on each scale; the ground is the last entry.
    pub(crate) lower: Vec<f64>,
    /// Upper bound on each scale; the ground is the last entry.
    pub(crate) upper: Vec<f64>,
    /// At most one term for each pair of scales.
    pub(crate) terms: Vec<Term>,
    /// Part that does not depend on the scales.
    pub(crate) constant: Rounded,
}

impl Objective {
    /// Returns the scale count, including the ground.
    pub(crate) fn scales(&self) -> usize {
        self.lower.len()
    }

    /// Returns the ground's index; the ground is the scale that is always 0.
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

    /// Returns the point in the box that is nearest to 0.
    pub(crate) fn nearest_to_zero(&self) -> Vec<f64> {
        self.lower
            .iter()
            .zip(&self.upper)
            .map(|(low, high)| 0.0_f64.clamp(*low, *high))
            .collect()
    }

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
    /// on the shift, so that the regularised deviations from neutral determine it (M8, M9).
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
