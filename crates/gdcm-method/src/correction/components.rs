//! Groups of channels that constrained entries connect, and whether the constraints are feasible
//! together (M8 and M9).
//!
//! ```text
//! value of a node = offset + s      s: the scale of its component
//! value of an input's node = x_i,  of an output's node = -y_o
//! x_i, y_o: coordinates of the input and output channels (logarithms of gains, or delays)
//! ```
//!
//! A *constrained entry* is a response whose net gain or delay must equal its delta, the gain or
//! delay that it needs. The *components* are the connected components in a graph with the channels
//! as nodes and the constrained entries as edges ([`super::constraints`]). A constrained entry
//! prescribes the difference between two nodes in one component, which does not depend on `s`: the
//! constraints leave the scales free, within the box.

use gdcm_model::dataset::Pair;

use super::branch_and_bound::rounded::Rounded;
use super::constraints::{Constraints, PairNodes};
use super::interval::Interval;

/// Infeasibility, in coordinates, up to which a component is accepted as feasible: a relative error
/// of 1e-9 in a gain product, or 1e-9 of the problem's time unit in a delay sum, well below the
/// tolerance for a met entry (`infeasible_entries`).
pub(crate) const ACCEPTED_INFEASIBILITY: f64 = 1e-9;

/// The components, each with the permitted interval for its scale. A channel without a constrained
/// entry is a component by itself.
#[derive(Clone, Debug)]
pub(crate) struct Components {
    /// Placements: inputs, then outputs.
    nodes: Vec<Placement>,
    inputs: usize,
    /// For each component, the minimum scale at which all its channels are inside the box.
    pub(crate) lower: Vec<f64>,
    /// For each component, the maximum scale at which all its channels are inside the box.
    pub(crate) upper: Vec<f64>,
    /// For each component, its infeasibility: the largest inconsistency among constraints that form
    /// a loop, or the amount by which the box is too narrow.
    infeasibility: Vec<f64>,
}

impl Components {
    /// Finds the components that the constrained entries form.
    ///
    /// ```text
    /// 1  offsets: first node of each component at 0, the others along a spanning tree of entries
    /// 2  interval of each scale, from the box; if it is empty, the component is infeasible
    /// 3  move the offsets so that scale 0 is the middle of each interval: there, no channel is far
    ///    outside the box; then the new intervals, as in 2
    /// 4  components with entries that close a loop and do not fit the offsets are infeasible, too
    /// ```
    pub(crate) fn new(constraints: &Constraints) -> Self {
        // Step 1
        let mut placed: Vec<Option<Placement>> = vec![None; constraints.nodes()];
        let mut count = 0;
        for node in 0..placed.len() {
            if placed[node].is_none() {
                placed[node] = Some(Placement {
                    component: count,
                    offset: Rounded::default(),
                });
                count += 1;
                place_connected_nodes(&mut placed, constraints);
            }
        }
        let mut components = Self {
            nodes: placed.into_iter().flatten().collect(),
            inputs: constraints.inputs,
            lower: vec![f64::NEG_INFINITY; count],
            upper: vec![f64::INFINITY; count],
            infeasibility: vec![0.0; count],
        };
        // Step 2
        components.set_intervals(constraints);
        // Step 3
        components.centre_offsets(constraints.range);
        components.set_intervals(constraints);
        // Step 4
        components.check_loops(constraints);
        components
    }

    pub(crate) fn count(&self) -> usize {
        self.lower.len()
    }

    /// Returns the placements, inputs and outputs separately.
    pub(crate) fn nodes(&self) -> Nodes<'_> {
        let (inputs, outputs) = self.nodes.split_at(self.inputs);
        Nodes { inputs, outputs }
    }

    /// Returns the sum `x_i + y_o` for two channels in the same component; it does not depend on
    /// the scale.
    pub(crate) fn sum(&self, pair: Pair) -> f64 {
        self.nodes[pair.input].offset.value - self.nodes[self.inputs + pair.output].offset.value
    }

    /// Returns whether all constraints are feasible together.
    pub(crate) fn are_possible(&self) -> bool {
        self.infeasibility
            .iter()
            .all(|infeasibility| *infeasibility <= ACCEPTED_INFEASIBILITY)
    }

    /// Returns whether an entry's component is infeasible.
    pub(crate) fn is_infeasible(&self, pair: Pair) -> bool {
        self.infeasibility[self.nodes[pair.input].component] > ACCEPTED_INFEASIBILITY
    }

    /// Returns every channel's coordinate (gain logarithm, or delay) at the given scales.
    pub(crate) fn channels(&self, scales: &[f64]) -> ChannelCoordinates {
        let nodes = self.nodes();
        ChannelCoordinates {
            inputs: nodes
                .inputs
                .iter()
                .map(|node| node.offset.value + scales[node.component])
                .collect(),
            // `0.0 - x`, not `-x`, which would turn zero into -0.
            outputs: nodes
                .outputs
                .iter()
                .map(|node| 0.0 - (node.offset.value + scales[node.component]))
                .collect(),
        }
    }

    /// Step 3: shifts the offsets so that scale 0 is in the middle of each component's interval.
    /// The intervals must then be set again.
    fn centre_offsets(&mut self, range: Interval) {
        // A scale at an interval end has two rounding errors: in the range end, and from
        // subtracting the offset.
        let error = 2.0 * f64::EPSILON * range.low.abs().max(range.high.abs());
        for node in &mut self.nodes {
            let middle = 0.5 * (self.lower[node.component] + self.upper[node.component]);
            node.offset.add(Rounded {
                value: middle,
                error,
            });
        }
    }

    /// Steps 2 and 3: sets the interval for every scale. An empty interval is replaced by its
    /// midpoint and recorded as infeasibility.
    fn set_intervals(&mut self, constraints: &Constraints) {
        self.lower.fill(f64::NEG_INFINITY);
        self.upper.fill(f64::INFINITY);
        for (index, node) in self.nodes.iter().enumerate() {
            let range = constraints.node_range(index);
            let lower = &mut self.lower[node.component];
            let upper = &mut self.upper[node.component];
            *lower = lower.max(range.low - node.offset.value);
            *upper = upper.min(range.high - node.offset.value);
        }
        for component in 0..self.count() {
            let excess = self.lower[component] - self.upper[component];
            if excess > 0.0 {
                self.infeasibility[component] = excess;
                let middle = 0.5 * (self.lower[component] + self.upper[component]);
                self.lower[component] = middle;
                self.upper[component] = middle;
            }
        }
    }

    /// Step 4: raises every component's infeasibility to the largest inconsistency among its loops.
    fn check_loops(&mut self, constraints: &Constraints) {
        for entry in &constraints.entries {
            let inconsistency = (self.sum(entry.pair) - entry.sum).abs();
            let component = self.nodes[entry.pair.input].component;
            self.infeasibility[component] = self.infeasibility[component].max(inconsistency);
        }
    }
}

/// A node's component, and its offset in this component.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Placement {
    pub(crate) component: usize,
    /// Node value at scale 0. The error bound sums the rounding along the spanning tree from the
    /// component's first node, and the rounding when the offset is shifted to centre the scale's
    /// interval (step 3).
    pub(crate) offset: Rounded,
}

impl Placement {
    /// Returns the placement for the node at a constrained entry's other end, whose value exceeds
    /// this node's by `difference`.
    fn across(self, difference: f64) -> Self {
        // Error: converting the delta to a logarithm or another time unit has rounded once.
        let mut offset = Rounded {
            value: difference,
            error: f64::EPSILON * difference.abs(),
        };
        offset.add(self.offset);
        Self { offset, ..self }
    }
}

#[derive(Clone, Copy, Debug)]
pub(crate) struct Nodes<'a> {
    pub(crate) inputs: &'a [Placement],
    pub(crate) outputs: &'a [Placement],
}

/// Channel coordinates, inputs and outputs separately.
#[derive(Clone, Debug)]
pub(crate) struct ChannelCoordinates {
    pub(crate) inputs: Vec<f64>,
    pub(crate) outputs: Vec<f64>,
}

/// Step 1: places every node that constrained entries connect with a placed node, along a spanning
/// tree.
fn place_connected_nodes(placed: &mut [Option<Placement>], constraints: &Constraints) {
    let mut grown = true;
    while grown {
        grown = false;
        for entry in &constraints.entries {
            let PairNodes { input, output } = constraints.nodes_of(entry.pair);
            match (placed[input], placed[output]) {
                // input node - output node = x_i + y_o, the prescribed sum
                (Some(known), None) => placed[output] = Some(known.across(-entry.sum)),
                (None, Some(known)) => placed[input] = Some(known.across(entry.sum)),
                _ => continue,
            }
            grown = true;
        }
    }
}
