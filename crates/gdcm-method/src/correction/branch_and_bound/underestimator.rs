//! Convex underestimator for the objective over a node, a part of the box that contains the unknown
//! *scales* `s` ([`super`]).
//!
//! ```text
//! F(s) = constant + sum over terms f(u)  >=  constant + sum over terms e(u),   u = s_to - s_from
//! e(u)   f itself if f is convex over the node's range of u; otherwise the sum of the envelopes of
//!        its two exponentials, forward in u and backward in -u
//! ```
//!
//! The *envelope* is the greatest convex function that does not exceed an exponential over the
//! range (`envelope`).

use super::derivatives::Derivatives;
use super::difference_bounds::DifferenceBounds;
use super::envelope::{Line, enveloped};
use super::expansion::{Curvature, Differentiable, Expansion};
use super::objective::Objective;
use super::rounded::Rounded;
use super::term::{Function, Term};
use crate::correction::interval::Interval;

/// Lines in the convex envelopes of a term's two exponentials (see [`Line`]); `None` for an
/// exponential that is convex over the node.
#[derive(Clone, Copy, Debug)]
struct EnvelopeLines {
    forward: Option<Line>,
    backward: Option<Line>,
}

/// Underestimator for a term over the range of its difference.
///
/// Newton's method respects only the node's box, and may leave this range. Outside it, the
/// underestimator continues along its tangent and bends upwards
/// ([`Underestimator::outer_curvature`]). Any convex continuation is valid, and this one keeps the
/// minimum close.
#[derive(Clone, Copy, Debug)]
struct TermUnderestimator {
    /// `None` if the term is convex over the node, and thus its own underestimator.
    lines: Option<EnvelopeLines>,
    range: Interval,
}

impl TermUnderestimator {
    fn new(term: &Term, region: &DifferenceBounds) -> Self {
        let range = region.range(term.from, term.to).not_empty();
        let lines = match &term.function {
            Function::Exponential {
                forward, backward, ..
            } if !term.function.is_convex_over(range) => Some(EnvelopeLines {
                forward: Line::of_envelope(forward, range),
                backward: Line::of_envelope(backward, range.mirrored()),
            }),
            _ => None,
        };
        Self { lines, range }
    }

    fn is_exact(&self) -> bool {
        self.lines.is_none()
    }

    /// Returns the term's difference at `scales`, clamped to its range.
    fn difference(&self, term: &Term, scales: &[f64]) -> f64 {
        self.range.nearest(term.difference(scales))
    }

    /// Evaluates the underestimator for `function` at `u`, which must be within the range.
    fn inside(&self, function: &Function, u: f64) -> Derivatives {
        match (function, &self.lines) {
            (
                Function::Exponential {
                    forward, backward, ..
                },
                Some(lines),
            ) => enveloped(forward, lines.forward.as_ref(), u).plus_mirrored(enveloped(
                backward,
                lines.backward.as_ref(),
                -u,
            )),
            _ => function.evaluate(u),
        }
    }
}

/// End of a term's concave interval.
#[derive(Clone, Copy, Debug)]
pub(super) struct ConcaveEnd {
    pub(super) from: usize,
    pub(super) to: usize,
    /// Difference `s_to - s_from` at the end.
    pub(super) at: f64,
    /// Distance between the end and the current difference.
    distance: f64,
}

/// A term and the value by which terms are ranked.
struct RankedTerm<'a> {
    term: &'a Term,
    rank: f64,
}

/// Returns the term with the highest rank; the last one if several rank equally.
fn highest<'a>(terms: impl Iterator<Item = RankedTerm<'a>>) -> Option<RankedTerm<'a>> {
    terms.max_by(|a, b| a.rank.total_cmp(&b.rank))
}

/// Convex function that does not exceed the objective anywhere in the node.
pub(crate) struct Underestimator<'a> {
    objective: &'a Objective,
    per_term: Vec<TermUnderestimator>,
    /// Every term underestimator's curvature outside its range.
    outer_curvature: f64,
}

impl<'a> Underestimator<'a> {
    /// Work per term for building the underestimator, in term evaluations. An estimate: a term that
    /// is convex over the node costs almost none, any other up to fourteen Newton steps for each of
    /// its two exponentials.
    pub(crate) const WORK_PER_TERM: u64 = 12;

    /// Creates the underestimator for `objective` over `region`, with `outer_curvature` outside the
    /// terms' ranges.
    pub(crate) fn new(
        objective: &'a Objective,
        region: &DifferenceBounds,
        outer_curvature: f64,
    ) -> Self {
        let per_term = objective
            .terms
            .iter()
            .map(|term| TermUnderestimator::new(term, region))
            .collect();
        Self {
            objective,
            per_term,
            outer_curvature,
        }
    }

    /// Returns whether the underestimator equals the objective, because every term is convex over
    /// the node.
    pub(crate) fn is_exact(&self) -> bool {
        self.per_term.iter().all(TermUnderestimator::is_exact)
    }

    /// Iterates over the terms that are not convex over the node.
    fn nonconvex(&self) -> impl Iterator<Item = (&'a Term, &TermUnderestimator)> {
        self.objective
            .terms
            .iter()
            .zip(&self.per_term)
            .filter(|(_, underestimator)| !underestimator.is_exact())
    }

    /// Finds the term that is furthest above its envelope at `scales` (clamped to the node's
    /// ranges); `None` if the distance, less its rounding error, does not exceed `least_gap`.
    pub(crate) fn widest_gap(&self, scales: &[f64], least_gap: f64) -> Option<&'a Term> {
        let gaps = self.nonconvex().map(|(term, underestimator)| {
            let u = underestimator.difference(term, scales);
            let above = term.function.evaluate(u).value;
            let below = underestimator.inside(&term.function, u).value;
            RankedTerm {
                term,
                rank: above.value - below.value - above.error - below.error,
            }
        });
        let widest = highest(gaps)?;
        if widest.rank > least_gap {
            Some(widest.term)
        } else {
            None
        }
    }

    /// Finds the terms that are not convex over the node but convex at `scales`, each with the
    /// nearer end of its concave interval if that is inside the node's range; the furthest end
    /// first. A split at an end separates a part in which the term is convex.
    pub(super) fn concave_ends(&self, scales: &[f64]) -> Vec<ConcaveEnd> {
        let mut ends = Vec::new();
        for (term, underestimator) in self.nonconvex() {
            let u = underestimator.difference(term, scales);
            if let Some(end) = term.function.concave_end(u, underestimator.range) {
                ends.push(ConcaveEnd {
                    from: term.from,
                    to: term.to,
                    at: end,
                    distance: (end - u).abs(),
                });
            }
        }
        ends.sort_by(|a, b| b.distance.total_cmp(&a.distance));
        ends
    }

    /// Returns the term whose slope varies most over the node, weighted by its range: this term is
    /// the most likely obstacle to the monotonicity and convexity tests.
    pub(crate) fn widest_slope(&self) -> Option<&'a Term> {
        let terms = self.objective.terms.iter().zip(&self.per_term);
        let variations = terms.map(|(term, underestimator)| {
            let slopes = term.function.slopes(underestimator.range);
            RankedTerm {
                term,
                rank: (slopes.most - slopes.least) * underestimator.range.width(),
            }
        });
        highest(variations).map(|widest| widest.term)
    }

    /// Evaluates a term's underestimator. Outside its range, at the distance `x` from the nearer
    /// end, the value is `e + e' x + outer_curvature x^2 / 2`, with the value `e` and the slope
    /// `e'` at that end.
    fn evaluate(
        &self,
        term: &Term,
        underestimator: &TermUnderestimator,
        scales: &[f64],
    ) -> Derivatives {
        let u = term.difference(scales);
        let end = underestimator.range.nearest(u);
        let mut at = underestimator.inside(&term.function, end);
        let outside = u - end;
        if outside != 0.0 {
            let bend = self.outer_curvature * outside;
            let rise = (at.slope.value + 0.5 * bend) * outside;
            let rise_error = at.slope.error * outside.abs()
                + 4.0 * f64::EPSILON * (rise.abs() + (at.slope.value * u).abs());
            at.value.add(Rounded {
                value: rise,
                error: rise_error,
            });
            at.slope.add(Rounded {
                value: bend,
                error: 2.0 * f64::EPSILON * (bend.abs() + self.outer_curvature * u.abs()),
            });
            at.curvature = self.outer_curvature;
        }
        at
    }
}

impl Differentiable for Underestimator<'_> {
    fn expand(&self, scales: &[f64], _curvature: Curvature, into: &mut Expansion) {
        into.clear(self.objective.constant);
        for (term, underestimator) in self.objective.terms.iter().zip(&self.per_term) {
            let at = self.evaluate(term, underestimator, scales);
            into.value.add(at.value);
            // `max(0.0)`: the curvature is negative only because the interval's ends are rounded.
            into.add_derivatives(term, at.slope, at.curvature.max(0.0));
        }
    }

    fn work(&self) -> u64 {
        2 * self.objective.terms.len() as u64
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::correction::branch_and_bound::exponential::{
        CombinedEntries, Exponential, ProductEntry,
    };

    fn exponential(weight: f64, centre: f64) -> Exponential {
        let entry = ProductEntry::new(weight, centre, Rounded::default());
        CombinedEntries::new(&[entry]).exponential
    }

    /// Generates sums of two exponentials with weights from 0.01 to 10 and centres from 0.05 to 20.
    fn functions() -> impl Strategy<Value = Function> {
        let forward = (0.01..10.0_f64, 0.05..20.0_f64);
        let backward = (0.01..10.0_f64, 0.05..20.0_f64);
        (forward, backward).prop_map(|(forward, backward)| {
            Function::exponential(
                exponential(forward.0, forward.1),
                exponential(backward.0, backward.1),
            )
        })
    }

    /// Generates as [`functions`], or only the forward exponential.
    fn functions_of_one_or_two() -> impl Strategy<Value = Function> {
        let forward = (0.01..10.0_f64, 0.05..20.0_f64);
        let alone = forward.prop_map(|(weight, centre)| {
            Function::exponential(exponential(weight, centre), Exponential::default())
        });
        prop_oneof![alone, functions()]
    }

    fn objective(function: Function, range: Interval) -> Objective {
        let terms = vec![Term {
            from: 0,
            to: 1,
            function,
        }];
        Objective {
            lower: vec![range.low, 0.0],
            upper: vec![range.high, 0.0],
            terms,
            constant: Rounded::default(),
        }
    }

    proptest! {
        #[test]
        fn the_underestimator_is_convex_and_nowhere_above_the_objective(
            function in functions_of_one_or_two(),
            low in -3.0..1.0_f64,
            width in 0.01..4.0_f64,
        ) {
            let objective = objective(function, Interval { low, high: low + width });
            let region = DifferenceBounds::from_box(&objective.lower, &objective.upper);
            let underestimator = Underestimator::new(&objective, &region, 1.0);
            let mut at = Expansion::zero(2);
            let mut steepness = f64::INFINITY;
            for step in 0..=200 {
                let scales = [low + width * f64::from(step) / 200.0, 0.0];
                underestimator.expand(&scales, Curvature::True, &mut at);
                let value = objective.value(&scales);
                prop_assert!(at.value.value - at.value.error <= value, "{} is above {}", at.value.value, value);
                // The difference is counted from node 0 to node 1, so that the slope in node 1
                // decreases as scale 0 increases.
                let rounding = 1e-9 * (1.0 + steepness.abs().min(1e9));
                prop_assert!(at.gradient[1] <= steepness + rounding, "{} after {}", at.gradient[1], steepness);
                steepness = at.gradient[1];
            }
        }

        #[test]
        fn two_exponentials_are_convex_wherever_they_say_so(
            function in functions(),
            at in -3.0..3.0_f64,
        ) {
            let convex = function.is_convex_over(Interval { low: at, high: at });
            let curvature = function.evaluate(at).curvature;
            // The interval is widened by 1e-11, so that the curvature at its ends is 1e-11 times
            // its slope there.
            prop_assert!(convex == (curvature > 0.0) || curvature.abs() <= 1e-6, "{} {}", convex, curvature);
        }

        #[test]
        fn bounds_on_slope_and_curvature_hold_over_the_range(
            function in functions(),
            low in -3.0..1.0_f64,
            width in 0.01..4.0_f64,
            share in 0.0..1.0_f64,
        ) {
            let range = Interval { low, high: low + width };
            let at = function.evaluate(low + share * width);
            let slopes = function.slopes(range);
            let curvatures = function.curvatures(range);
            prop_assert!(slopes.least <= at.slope.value + at.slope.error && at.slope.value - at.slope.error <= slopes.most);
            // Tolerance: rounding of values up to 1e4.
            prop_assert!(curvatures.least <= at.curvature + 1e-9 && at.curvature - 1e-9 <= curvatures.most);
        }
    }
}
