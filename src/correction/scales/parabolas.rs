//! Entries compared by a difference of logarithms or of delays.

use super::link::{Link, Shape};

/// One entry of a least squares objective: `share (difference - (s_input - s_output))^2`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Entry {
    /// Node of the entry's output.
    pub(crate) output: usize,
    /// Node of its input (the ground, for an output's own departure).
    pub(crate) input: usize,
    /// Weight of the entry.
    pub(crate) share: f64,
    /// Difference of the scales that meets the entry.
    pub(crate) difference: f64,
}

impl Entry {
    /// The entry seen from the lesser node.
    fn ordered(&self) -> (usize, usize, f64) {
        if self.output < self.input {
            (self.output, self.input, self.difference)
        } else {
            (self.input, self.output, -self.difference)
        }
    }
}

/// One parabola for each two nodes that share an entry, and what remains of the objective at the bottoms of all.
pub(crate) fn parabolas(entries: &[Entry], nodes: usize) -> (Vec<Link>, f64) {
    let mut weight = vec![0.0; nodes * nodes];
    let mut moment = vec![0.0; nodes * nodes];
    for entry in entries {
        let (from, to, difference) = entry.ordered();
        weight[from * nodes + to] += entry.share;
        moment[from * nodes + to] += entry.share * difference;
    }
    let centre = |from: usize, to: usize| moment[from * nodes + to] / weight[from * nodes + to];
    let remains = |entry: &Entry| {
        let (from, to, difference) = entry.ordered();
        // Inside a component no scale changes the entry.
        let met = if from == to { 0.0 } else { centre(from, to) };
        entry.share * (difference - met).powi(2)
    };
    let constant = entries.iter().map(remains).sum();
    let mut links = Vec::new();
    for from in 0..nodes {
        for to in from + 1..nodes {
            let weight = weight[from * nodes + to];
            if weight > 0.0 {
                links.push(Link {
                    from,
                    to,
                    shape: Shape::Parabola {
                        weight,
                        centre: centre(from, to),
                    },
                });
            }
        }
    }
    (links, constant)
}
