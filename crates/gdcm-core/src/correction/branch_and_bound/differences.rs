//! The part of the box of the scales that a node stands for.

/// The scales whose differences stay within bounds: `s_j - s_i <= bound(i, j)` for any two, the ground (0) included.
///
/// The bounds are closed under addition (shortest paths; "difference bound matrices"), so that each is the least that follows.
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

    /// The least and the greatest `s_to - s_from`.
    pub(crate) fn range(&self, from: usize, to: usize) -> (f64, f64) {
        (-self.bounds[to * self.count + from], self.bounds[from * self.count + to])
    }

    /// The part with `s_to - s_from <= most`, with what follows for every other difference, or `None` where it is empty.
    pub(crate) fn below(&self, from: usize, to: usize, most: f64) -> Option<Self> {
        let count = self.count;
        if most + self.bounds[to * count + from] < 0.0 {
            return None;
        }
        let mut part = self.clone();
        for i in 0..count {
            for j in (0..count).filter(|&j| j != i) {
                let (before, after) = (self.bounds[i * count + from], self.bounds[to * count + j]);
                // Rounded outward, so that no point of the part is lost.
                let implied = before + most + after + 2.0 * f64::EPSILON * (before.abs() + most.abs() + after.abs());
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

    /// The least bounds that hold these and `scales`.
    pub(crate) fn hull(&self, scales: &[f64]) -> Self {
        let count = self.count;
        let bound = |index: usize| self.bounds[index].max(scales[index % count] - scales[index / count]);
        Self { count, bounds: (0..count * count).map(bound).collect() }
    }

    /// Bytes that the bounds of so many scales take.
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

    /// Whether the bounds hold `scales`.
    pub(crate) fn holds(&self, scales: &[f64]) -> bool {
        let slack = 1e-13;
        (0..self.count)
            .all(|i| (0..self.count).all(|j| scales[j] - scales[i] <= self.bounds[i * self.count + j] + slack))
    }
}
