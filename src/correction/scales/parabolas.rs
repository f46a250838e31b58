//! Entries compared by a difference of logarithms or of delays.

use super::link::{Link, Shape};
use super::sum::Sum;

/// One entry of a least squares objective: `share (wanted - offset - (s_input - s_output))^2`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Entry {
    /// Node of the entry's output.
    pub(crate) output: usize,
    /// Node of its input (the ground, for an output's own departure).
    pub(crate) input: usize,
    /// Weight of the entry.
    pub(crate) share: f64,
    /// What the entry is to be.
    pub(crate) wanted: f64,
    /// What it is where both scales are 0.
    pub(crate) offset: f64,
}

impl Entry {
    /// The entry seen from the lesser node: from, to, and the difference of their scales that meets it.
    fn ordered(&self) -> (usize, usize, f64) {
        let difference = self.wanted - self.offset;
        if self.output < self.input {
            (self.output, self.input, difference)
        } else {
            (self.input, self.output, -difference)
        }
    }

    fn size(&self) -> f64 {
        self.wanted.abs() + self.offset.abs()
    }
}

/// The entries of two nodes.
#[derive(Clone, Copy, Default)]
struct Gathered {
    weight: f64,
    moment: f64,
    size: f64,
}

/// One parabola for each two nodes that share an entry, and what remains of the objective at the bottoms of all.
pub(crate) fn parabolas(entries: &[Entry], nodes: usize) -> (Vec<Link>, Sum) {
    let mut gathered = vec![Gathered::default(); nodes * nodes];
    for entry in entries {
        let (from, to, difference) = entry.ordered();
        let group = &mut gathered[from * nodes + to];
        group.weight += entry.share;
        group.moment += entry.share * difference;
        group.size = group.size.max(entry.size());
    }
    let mut constant = Sum::default();
    for entry in entries {
        let (from, to, difference) = entry.ordered();
        let group = gathered[from * nodes + to];
        // Inside a component no scale changes the entry.
        let met = if from == to { 0.0 } else { group.moment / group.weight };
        constant.add(entry.share, difference - met, entry.size() + met.abs(), 8.0);
    }
    let mut links = Vec::new();
    for from in 0..nodes {
        for to in from + 1..nodes {
            let Gathered { weight, moment, size } = gathered[from * nodes + to];
            if weight > 0.0 {
                links.push(Link { from, to, shape: Shape::Parabola { weight, centre: moment / weight, size } });
            }
        }
    }
    (links, constant)
}
