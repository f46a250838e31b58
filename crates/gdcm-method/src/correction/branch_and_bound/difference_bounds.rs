//! Parts of the scale box, given by bounds on the difference between every two scales: `s_to -
//! s_from <= bound(from, to)`. The *scales* are the unknowns in the search ([`super`]), each
//! between a lower and an upper bound; the last one, the *ground*, is always 0, so that a
//! difference from it is a scale itself. Differences are bounded because each term in the objective
//! depends on one.

use crate::correction::interval::Interval;

/// Largest excess over a bound that counts as a rounding error.
const ROUNDING: f64 = 1e-13;

/// Bounds on scale differences: `s_to - s_from <= bound(from, to)` for every two scales, the ground
/// included.
///
/// As edge lengths in a graph, the bounds are shortest paths ("difference bound matrices"): each is
/// the tightest bound implied by the others.
#[derive(Clone, Debug)]
pub(crate) struct DifferenceBounds {
    /// Scale count, including the ground.
    count: usize,
    /// The bounds, count x count: `bound(from, to)` at `from * count + to`.
    bounds: Vec<f64>,
}

impl DifferenceBounds {
    /// Creates the bounds for the box `lower <= s <= upper`; the ground is the last entry.
    pub(crate) fn from_box(lower: &[f64], upper: &[f64]) -> Self {
        let count = lower.len();
        let mut bounds = vec![0.0; count * count];
        for from in 0..count {
            for to in 0..count {
                if to != from {
                    bounds[from * count + to] = upper[to] - lower[from];
                }
            }
        }
        Self { count, bounds }
    }

    /// Returns the range of `s_to - s_from`.
    pub(crate) fn range(&self, from: usize, to: usize) -> Interval {
        Interval {
            low: -self.bounds[to * self.count + from],
            high: self.bounds[from * self.count + to],
        }
    }

    /// Returns the part with `s_to - s_from <= most`, with every other bound tightened accordingly;
    /// `None` if it is empty.
    pub(crate) fn below(&self, from: usize, to: usize, most: f64) -> Option<Self> {
        let count = self.count;
        if most + self.bounds[to * count + from] < 0.0 {
            return None;
        }
        let mut part = self.clone();
        // The new bound shortens the path from i to j that leads through it: i, from, to, j.
        for i in 0..count {
            for j in 0..count {
                if j == i {
                    continue;
                }
                let before = self.bounds[i * count + from];
                let after = self.bounds[to * count + j];
                // Round outward, so that no point is lost.
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

    /// Returns the part with `s_to - s_from >= least`; `None` if it is empty.
    pub(crate) fn above(&self, from: usize, to: usize, least: f64) -> Option<Self> {
        self.below(to, from, -least)
    }

    /// Returns the tightest bounds that contain this part and the point `scales`.
    pub(crate) fn hull(&self, scales: &[f64]) -> Self {
        let count = self.count;
        let mut bounds = self.bounds.clone();
        for from in 0..count {
            for to in 0..count {
                let bound = &mut bounds[from * count + to];
                *bound = bound.max(scales[to] - scales[from]);
            }
        }
        Self { count, bounds }
    }

    /// Returns the memory needed for the bounds on `count` scales \[bytes\].
    pub(crate) fn bytes(count: usize) -> usize {
        count * count * size_of::<f64>()
    }

    /// Writes each scale's minimum and maximum, without the ground.
    pub(crate) fn write_box(&self, lower: &mut [f64], upper: &mut [f64]) {
        let ground = self.count - 1;
        for scale in 0..ground {
            // `not_empty`: an interval can be empty only by rounding, since `below` returns `None`
            // for an empty part.
            let range = self.range(ground, scale).not_empty();
            lower[scale] = range.low;
            upper[scale] = range.high;
        }
    }

    /// Returns whether `scales` satisfies the bounds, up to rounding.
    pub(crate) fn contains(&self, scales: &[f64]) -> bool {
        (0..self.count).all(|from| {
            (0..self.count).all(|to| {
                scales[to] - scales[from] <= self.bounds[from * self.count + to] + ROUNDING
            })
        })
    }
}
