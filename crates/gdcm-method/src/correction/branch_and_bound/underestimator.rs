//! A convex underestimator of the objective over one node (part of the box of the scales), and its
//! lower bounds.

use super::objective::{Curvature, Differentiable, Expansion, Objective};
use super::term::{Derivatives, Exponential, Function, Rounded, Term, both};

/// A term's underestimator with the range of its difference. Newton's method keeps to the box of
/// the node only, so beyond the range the underestimator continues along its tangent and bends up:
/// any convex continuation is valid, and this one keeps the minimum near.
#[derive(Clone, Copy, Debug)]
struct TermUnder {
    /// The lines in the convex envelopes of its two exponentials; `None` where the term is convex
    /// over the node and is its own underestimator.
    envelopes: Option<[Option<Line>; 2]>,
    range: (f64, f64),
}

impl TermUnder {
    fn of(term: &Term, region: &DifferenceBounds) -> Self {
        let (low, high) = region.range(term.from, term.to);
        let range = (low, high.max(low));
        let envelopes = match &term.function {
            Function::Exponential {
                forward, backward, ..
            } if !term.function.is_convex_over(range) => Some([
                envelope(forward, range),
                envelope(backward, (-range.1, -range.0)),
            ]),
            _ => None,
        };
        Self { envelopes, range }
    }

    fn is_exact(&self) -> bool {
        self.envelopes.is_none()
    }

    /// The term's difference at `scales`, kept inside the range.
    fn difference(&self, term: &Term, scales: &[f64]) -> f64 {
        (scales[term.to] - scales[term.from]).clamp(self.range.0, self.range.1)
    }

    /// The underestimator of `function` at `u` in the range.
    fn inside(&self, function: &Function, u: f64) -> Derivatives {
        match (function, &self.envelopes) {
            (
                Function::Exponential {
                    forward, backward, ..
                },
                Some([ahead, behind]),
            ) => both(
                enveloped(forward, ahead.as_ref(), u),
                enveloped(backward, behind.as_ref(), -u),
            ),
            _ => function.at(u),
        }
    }
}

/// Convex function of the scales that nowhere in the node exceeds the objective.
pub(crate) struct Underestimator<'a> {
    objective: &'a Objective,
    unders: Vec<TermUnder>,
    beyond: f64,
}

impl<'a> Underestimator<'a> {
    /// Work of construction for each term: up to fourteen steps to a tangent.
    pub(crate) const WORK_PER_TERM: u64 = 12;

    /// The underestimator of `objective` over `region`, with curvature `beyond` outside the ranges
    /// of the differences.
    pub(crate) fn new(objective: &'a Objective, region: &DifferenceBounds, beyond: f64) -> Self {
        let unders = objective
            .terms
            .iter()
            .map(|term| TermUnder::of(term, region))
            .collect();
        Self {
            objective,
            unders,
            beyond,
        }
    }

    /// Whether it equals the objective: every term is convex over the node.
    pub(crate) fn is_exact(&self) -> bool {
        self.unders.iter().all(TermUnder::is_exact)
    }

    /// The terms that are not convex over the node.
    fn nonconvex(&self) -> impl Iterator<Item = (&'a Term, &TermUnder)> {
        self.objective
            .terms
            .iter()
            .zip(&self.unders)
            .filter(|(_, under)| !under.is_exact())
    }

    /// The term furthest above its envelope at `scales` (kept inside the node's ranges), with that
    /// distance less its rounding.
    pub(crate) fn widest_gap(&self, scales: &[f64]) -> Option<(&'a Term, f64)> {
        let gap = |(term, under): (&'a Term, &TermUnder)| {
            let u = under.difference(term, scales);
            let above = term.function.at(u).value;
            let below = under.inside(&term.function, u).value;
            (term, above.value - below.value - above.error - below.error)
        };
        self.nonconvex().map(gap).max_by(|a, b| a.1.total_cmp(&b.1))
    }

    /// Each term (from, to) that is not convex over the node but is convex at `scales`, with the
    /// end of its concave interval, furthest end first. The parts beyond the ends are easily
    /// bounded, and the rest is convex in these terms.
    pub(crate) fn concave_ends(&self, scales: &[f64]) -> Vec<(usize, usize, f64)> {
        let end = |(term, under): (&'a Term, &TermUnder)| {
            let u = under.difference(term, scales);
            let end = term.function.concave_end(u, under.range)?;
            Some((term, end, (end - u).abs()))
        };
        let mut ends: Vec<(&Term, f64, f64)> = self.nonconvex().filter_map(end).collect();
        ends.sort_by(|a, b| b.2.total_cmp(&a.2));
        ends.into_iter()
            .map(|(term, end, _)| (term.from, term.to, end))
            .collect()
    }

    /// The term whose slope varies most over the node, weighted with its range: it hides the sign
    /// of a scale's slope, or the uniqueness of the minimum.
    pub(crate) fn widest_slope(&self) -> Option<&'a Term> {
        let variation = |(term, under): (&'a Term, &TermUnder)| {
            let slopes = term.function.slopes(under.range);
            (
                term,
                (slopes.most - slopes.least) * (under.range.1 - under.range.0),
            )
        };
        let terms = self.objective.terms.iter().zip(&self.unders).map(variation);
        terms
            .max_by(|a, b| a.1.total_cmp(&b.1))
            .map(|(term, _)| term)
    }

    fn at(&self, term: &Term, under: &TermUnder, scales: &[f64]) -> Derivatives {
        let u = scales[term.to] - scales[term.from];
        let end = u.clamp(under.range.0, under.range.1);
        let mut at = under.inside(&term.function, end);
        let beyond = u - end;
        if beyond != 0.0 {
            let bend = self.beyond * beyond;
            let rise = (at.slope.value + 0.5 * bend) * beyond;
            let moved = at.slope.error * beyond.abs()
                + 4.0 * f64::EPSILON * (rise.abs() + (at.slope.value * u).abs());
            at.value.add(Rounded {
                value: rise,
                error: moved,
            });
            at.slope.add(Rounded {
                value: bend,
                error: 2.0 * f64::EPSILON * (bend.abs() + self.beyond * u.abs()),
            });
            at.curvature = self.beyond;
        }
        at
    }
}

impl Differentiable for Underestimator<'_> {
    fn expand(&self, scales: &[f64], _curvature: Curvature, into: &mut Expansion) {
        into.clear(self.objective.constant);
        for (term, under) in self.objective.terms.iter().zip(&self.unders) {
            let at = self.at(term, under, scales);
            into.value.add(at.value);
            // Convex up to the rounding of the interval's ends.
            into.add(term, at.slope, at.curvature.max(0.0));
        }
    }

    fn work(&self) -> u64 {
        2 * self.objective.terms.len() as u64
    }
}

/// Lower bound over a box, for a function that is convex there, from its tangent plane at `scales`
/// (inside the box), less the rounding of the value, of every slope and of their sum.
pub(super) fn tangent_bound(
    scales: &[f64],
    at: &Expansion,
    (lower, upper): (&[f64], &[f64]),
) -> f64 {
    let mut bound = at.value.value - at.value.error;
    for scale in 0..scales.len() {
        let slope = at.gradient[scale];
        let error = at.gradient_error[scale];
        let down = (slope + error).max(0.0) * (scales[scale] - lower[scale]).max(0.0);
        let up = (error - slope).max(0.0) * (upper[scale] - scales[scale]).max(0.0);
        bound -= down.max(up);
    }
    // Each of the n + 1 differences rounds a figure between the value and the bound; each product
    // four times, of their sum.
    bound - (scales.len() as f64 + 5.0) * f64::EPSILON * at.value.value.abs().max(bound.abs())
}

/// Lower bound from the tangent plane and the Hessian next to `scales`, where the slopes are almost
/// zero.
///
/// `reach` is `sqrt(diagonal of H^-1)` for a Hessian `H` that the function's own does not fall
/// below while no scale is further than `within` from `scales`; 0 for a fixed scale. With the
/// gradient `g` known to `e`, and `r = sum (|g| + e) reach`, the parabola `g d + d' H d / 2` is
/// nowhere below `-r^2 / 2` and turns before any scale has moved by `r reach`; beyond, a convex
/// function keeps rising. A scale that its slope has `pushed` against its bound can only raise the
/// function.
pub(super) fn quadratic_bound(
    at: &Expansion,
    reach: &[f64],
    within: f64,
    pushed: impl Fn(usize) -> bool,
) -> Option<f64> {
    let mut sum = 0.0;
    for (scale, reach) in reach.iter().enumerate() {
        if !pushed(scale) {
            sum += (at.gradient[scale].abs() + at.gradient_error[scale]) * reach;
        }
    }
    let farthest = sum * reach.iter().fold(0.0_f64, |most, reach| most.max(*reach));
    // A millionth above the parabola's depth covers the rounding of the sum and of the inverse.
    let bound = at.value.value - at.value.error - 0.5 * sum * sum * (1.0 + 1e-6);
    (farthest <= within).then_some(bound - 4.0 * f64::EPSILON * bound.abs())
}

/// Scales whose differences stay within bounds: `s_j - s_i <= bound(i, j)` for any two, the ground
/// included.
///
/// The bounds are closed under addition (shortest paths; "difference bound matrices"), so that each
/// is the tightest implied bound.
#[derive(Clone, Debug)]
pub(crate) struct DifferenceBounds {
    count: usize,
    bounds: Vec<f64>,
}

impl DifferenceBounds {
    /// The box `lower <= s <= upper`, the ground last.
    pub(crate) fn of_box(lower: &[f64], upper: &[f64]) -> Self {
        let count = lower.len();
        let mut bounds = vec![0.0; count * count];
        for from in 0..count {
            for to in (0..count).filter(|&to| to != from) {
                bounds[from * count + to] = upper[to] - lower[from];
            }
        }
        Self { count, bounds }
    }

    /// Least and greatest `s_to - s_from`.
    pub(crate) fn range(&self, from: usize, to: usize) -> (f64, f64) {
        (
            -self.bounds[to * self.count + from],
            self.bounds[from * self.count + to],
        )
    }

    /// The part with `s_to - s_from <= most`, with the implied bounds of every other difference, or
    /// `None` where it is empty.
    pub(crate) fn below(&self, from: usize, to: usize, most: f64) -> Option<Self> {
        let count = self.count;
        if most + self.bounds[to * count + from] < 0.0 {
            return None;
        }
        let mut part = self.clone();
        for i in 0..count {
            for j in (0..count).filter(|&j| j != i) {
                let before = self.bounds[i * count + from];
                let after = self.bounds[to * count + j];
                // Rounded outward, so that no point of the part is lost.
                let implied = before
                    + most
                    + after
                    + 2.0 * f64::EPSILON * (before.abs() + most.abs() + after.abs());
                let bound = &mut part.bounds[i * count + j];
                *bound = bound.min(implied);
            }
        }
        part.bounds[from * count + to] = part.bounds[from * count + to].min(most);
        Some(part)
    }

    /// The part with `s_to - s_from >= least`, or `None` where it is empty.
    pub(crate) fn above(&self, from: usize, to: usize, least: f64) -> Option<Self> {
        self.below(to, from, -least)
    }

    /// Tightest bounds that contain these and `scales`.
    pub(crate) fn hull(&self, scales: &[f64]) -> Self {
        let count = self.count;
        let bound =
            |index: usize| self.bounds[index].max(scales[index % count] - scales[index / count]);
        Self {
            count,
            bounds: (0..count * count).map(bound).collect(),
        }
    }

    /// Bytes of the bounds of `count` scales.
    pub(crate) fn bytes(count: usize) -> usize {
        count * count * size_of::<f64>()
    }

    /// Writes the least and greatest value of each scale.
    pub(crate) fn write_box(&self, lower: &mut [f64], upper: &mut [f64]) {
        let ground = self.count - 1;
        for scale in 0..ground {
            (lower[scale], upper[scale]) = self.range(ground, scale);
            // An empty interval can only be rounding: `below` has refused empty parts.
            upper[scale] = upper[scale].max(lower[scale]);
        }
    }

    /// Whether `scales` satisfies the bounds.
    pub(crate) fn holds(&self, scales: &[f64]) -> bool {
        let slack = 1e-13;
        (0..self.count).all(|i| {
            (0..self.count)
                .all(|j| scales[j] - scales[i] <= self.bounds[i * self.count + j] + slack)
        })
    }
}

/// The line of a convex envelope: it replaces the exponential left of `until`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Line {
    until: f64,
    at: f64,
    value: Rounded,
    slope: f64,
}

/// The exponential at `v`, with the line of its envelope, if any, instead of the part left of
/// `until`.
pub(super) fn enveloped(function: &Exponential, line: Option<&Line>, v: f64) -> Derivatives {
    match line {
        Some(line) if v < line.until => {
            let rise = line.slope * (v - line.at);
            let moved = f64::EPSILON * (2.0 * rise.abs() + (line.slope * v).abs());
            let mut value = line.value;
            value.add(Rounded {
                value: rise,
                error: moved,
            });
            Derivatives {
                value,
                slope: Rounded {
                    value: line.slope,
                    error: 0.0,
                },
                curvature: 0.0,
            }
        }
        _ if function.is_zero() => Derivatives::default(),
        _ => function.at(v, v.exp()),
    }
}

/// Line of the convex envelope of an exponential over `[low, high]`: `None` where it is convex
/// there, the chord where the line from the left end is nowhere tangent, else the tangent, with the
/// exponential itself to the right of it.
pub(super) fn envelope(function: &Exponential, (low, high): (f64, f64)) -> Option<Line> {
    if function.is_zero() || low >= function.inflection() {
        return None;
    }
    let start = function.at(low, low.exp());
    let end = function.at(high, high.exp());
    // Height of the tangent at b over the left end: falls as b moves right of the inflection.
    let overshoot =
        |b: f64, at: &Derivatives| at.value.value + at.slope.value * (low - b) - start.value.value;
    if high <= function.inflection() || overshoot(high, &end) >= 0.0 {
        return Some(chord((low, start.value), (high, end.value)));
    }
    let mut over = function.inflection().max(low);
    let mut under = high;
    let mut tangent = end;
    // Newton's method from the bracket's right side; any point there is valid, so a near-tangent is
    // enough.
    for _ in 0..14 {
        let excess = overshoot(under, &tangent);
        let newton = under - excess / (tangent.curvature * (low - under));
        let next = if over < newton && newton < under {
            newton
        } else {
            0.5 * (over + under)
        };
        let at = function.at(next, next.exp());
        if overshoot(next, &at) > 0.0 {
            over = next;
        } else {
            under = next;
            tangent = at;
        }
        if -overshoot(under, &tangent) <= 1e-9 * start.value.value {
            break;
        }
    }
    let error = start.value.error + tangent.value.error + 2.0 * tangent.slope.error * (under - low);
    let value = Rounded {
        value: tangent.value.value,
        error: error + 4.0 * f64::EPSILON * start.value.value,
    };
    Some(Line {
        until: under,
        at: under,
        value,
        slope: tangent.slope.value,
    })
}

/// The line through both ends, lowered by their rounding.
fn chord((low, start): (f64, Rounded), (high, end): (f64, Rounded)) -> Line {
    let slope = if high > low {
        (end.value - start.value) / (high - low)
    } else {
        0.0
    };
    let error =
        start.error + end.error + 4.0 * f64::EPSILON * (start.value.abs() + end.value.abs());
    let value = start.value.min(end.value - slope * (high - low));
    Line {
        until: f64::INFINITY,
        at: low,
        value: Rounded { value, error },
        slope,
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::correction::branch_and_bound::term::ProductEntry;

    fn exponential(weight: f64, centre: f64) -> Exponential {
        Exponential::of(&[ProductEntry::new(weight, centre, Rounded::default())]).0
    }

    fn objective(forward: (f64, f64), backward: (f64, f64), range: (f64, f64)) -> Objective {
        let function = Function::exponential(
            exponential(forward.0, forward.1),
            exponential(backward.0, backward.1),
        );
        let terms = vec![Term {
            from: 0,
            to: 1,
            function,
        }];
        Objective {
            lower: vec![range.0, 0.0],
            upper: vec![range.1, 0.0],
            terms,
            constant: Rounded::default(),
        }
    }

    proptest! {
        #[test]
        fn the_underestimator_is_convex_and_nowhere_above_the_objective(
            forward in (0.01..10.0_f64, 0.05..20.0_f64),
            backward in (prop_oneof![Just(0.0), 0.01..10.0_f64], 0.05..20.0_f64),
            low in -3.0..1.0_f64,
            width in 0.01..4.0_f64,
        ) {
            let objective = objective(forward, backward, (low, low + width));
            let region = DifferenceBounds::of_box(&objective.lower, &objective.upper);
            let underestimator = Underestimator::new(&objective, &region, 1.0);
            let mut at = Expansion::zero(2);
            let mut steepness = f64::INFINITY;
            for step in 0..=200 {
                let scales = [low + width * f64::from(step) / 200.0, 0.0];
                underestimator.expand(&scales, Curvature::True, &mut at);
                let value = objective.value(&scales);
                prop_assert!(at.value.value - at.value.error <= value, "{} is above {}", at.value.value, value);
                // The difference is measured from node 0 to node 1: the slope of node 1 falls as
                // the scale of node 0 rises.
                let rounding = 1e-9 * (1.0 + steepness.abs().min(1e9));
                prop_assert!(at.gradient[1] <= steepness + rounding, "{} after {}", at.gradient[1], steepness);
                steepness = at.gradient[1];
            }
        }

        #[test]
        fn two_exponentials_are_convex_wherever_they_say_so(
            forward in (0.01..10.0_f64, 0.05..20.0_f64),
            backward in (0.01..10.0_f64, 0.05..20.0_f64),
            at in -3.0..3.0_f64,
        ) {
            let function = Function::exponential(exponential(forward.0, forward.1), exponential(backward.0, backward.1));
            let convex = function.is_convex_over((at, at));
            let curvature = function.at(at).curvature;
            // The interval is widened by 1e-11; the curvature there is as small as that times its
            // own slope.
            prop_assert!(convex == (curvature > 0.0) || curvature.abs() <= 1e-6, "{} {}", convex, curvature);
        }

        #[test]
        fn bounds_on_slope_and_curvature_hold_over_the_range(
            forward in (0.01..10.0_f64, 0.05..20.0_f64),
            backward in (0.01..10.0_f64, 0.05..20.0_f64),
            low in -3.0..1.0_f64,
            width in 0.01..4.0_f64,
            share in 0.0..1.0_f64,
        ) {
            let function = Function::exponential(exponential(forward.0, forward.1), exponential(backward.0, backward.1));
            let range = (low, low + width);
            let at = function.at(low + share * width);
            let slopes = function.slopes(range);
            let curvatures = function.curvatures(range);
            prop_assert!(slopes.least <= at.slope.value + at.slope.error && at.slope.value - at.slope.error <= slopes.most);
            // Rounding of numbers up to 1e4.
            prop_assert!(curvatures.least <= at.curvature + 1e-9 && at.curvature - 1e-9 <= curvatures.most);
        }
    }
}
