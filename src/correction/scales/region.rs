//! A part of the box of the scales.

/// The scales whose differences stay within bounds: `s_j - s_i <= bound(i, j)` for any two nodes, the ground (scale 0) included.
#[derive(Clone, Debug)]
pub(crate) struct Region {
    nodes: usize,
    bounds: Vec<f64>,
}

impl Region {
    /// The box `lower <= s <= upper`, the ground last.
    pub(crate) fn of_box(lower: &[f64], upper: &[f64]) -> Self {
        let nodes = lower.len();
        let mut bounds = vec![0.0; nodes * nodes];
        for from in 0..nodes {
            for to in (0..nodes).filter(|&to| to != from) {
                bounds[from * nodes + to] = upper[to] - lower[from];
            }
        }
        Self { nodes, bounds }
    }

    /// The least and the greatest `s_to - s_from`.
    pub(crate) fn range(&self, from: usize, to: usize) -> (f64, f64) {
        (-self.bounds[to * self.nodes + from], self.bounds[from * self.nodes + to])
    }

    /// The part with `s_to - s_from <= most`, with what follows for every other difference, or `None` where it is empty.
    pub(crate) fn below(&self, from: usize, to: usize, most: f64) -> Option<Self> {
        let nodes = self.nodes;
        if most + self.bounds[to * nodes + from] < 0.0 {
            return None;
        }
        let mut part = self.clone();
        for i in 0..nodes {
            for j in (0..nodes).filter(|&j| j != i) {
                let (before, after) = (self.bounds[i * nodes + from], self.bounds[to * nodes + j]);
                // Rounded outward, so that no point of the part is lost.
                let implied = before + most + after + 2.0 * f64::EPSILON * (before.abs() + most.abs() + after.abs());
                let bound = &mut part.bounds[i * nodes + j];
                *bound = bound.min(implied);
            }
        }
        part.bounds[from * nodes + to] = part.bounds[from * nodes + to].min(most);
        Some(part)
    }

    /// The part with `s_to - s_from >= least`, or `None` where it is empty.
    pub(crate) fn above(&self, from: usize, to: usize, least: f64) -> Option<Self> {
        self.below(to, from, -least)
    }

    /// The least region of this kind that holds this one and `scales`.
    pub(crate) fn hull(&self, scales: &[f64]) -> Self {
        let nodes = self.nodes;
        let bound = |index: usize| self.bounds[index].max(scales[index % nodes] - scales[index / nodes]);
        Self { nodes, bounds: (0..nodes * nodes).map(bound).collect() }
    }

    /// Writes the least and greatest scale of each node.
    pub(crate) fn write_box(&self, lower: &mut [f64], upper: &mut [f64]) {
        let ground = self.nodes - 1;
        for node in 0..ground {
            (lower[node], upper[node]) = self.range(ground, node);
            // An empty interval can only be rounding: `below` has refused empty parts.
            upper[node] = upper[node].max(lower[node]);
        }
    }

    /// Whether the region holds `scales`.
    pub(crate) fn holds(&self, scales: &[f64]) -> bool {
        let slack = 1e-13;
        (0..self.nodes)
            .all(|i| (0..self.nodes).all(|j| scales[j] - scales[i] <= self.bounds[i * self.nodes + j] + slack))
    }
}
