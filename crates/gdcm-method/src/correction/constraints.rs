//! A problem's constraints in coordinates: prescribed sums over two channels, and a box (M8, M9).
//!
//! ```text
//! x_i + y_o = sum       for each constrained entry (output o, input i)
//! low <= x, y <= high
//! ```
//!
//! `x_i` and `y_o` are the coordinates of the input and output channels: logarithms of gains, or
//! delays. A *constrained entry* is a response whose net gain or delay must equal its delta, the
//! gain or delay that it needs. The channels are the *nodes* in a graph, the inputs first, then the
//! outputs. An input node has the value `v = x_i`, an output node `v = -y_o`, so that a constrained
//! entry prescribes the difference between two nodes.

use gdcm_model::dataset::Pair;

use super::channels::Channel;
use super::interval::Interval;
use super::problem::Problem;

/// The constrained entries with their prescribed sums, and the box.
#[derive(Clone, Debug)]
pub(crate) struct Constraints {
    pub(crate) outputs: usize,
    pub(crate) inputs: usize,
    pub(crate) entries: Vec<ConstrainedSum>,
    /// Permitted coordinates, the same for every channel.
    pub(crate) range: Interval,
}

/// A constrained entry and its prescribed sum.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ConstrainedSum {
    pub(crate) pair: Pair,
    /// Prescribed sum `x_i + y_o`.
    pub(crate) sum: f64,
}

/// Nodes for a response's input and output.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PairNodes {
    pub(crate) input: usize,
    pub(crate) output: usize,
}

impl Constraints {
    /// Collects the constraints in `problem`.
    pub(crate) fn new(problem: &Problem) -> Self {
        let coordinate = problem.coordinate();
        Self {
            outputs: problem.delta.outputs(),
            inputs: problem.delta.inputs(),
            entries: problem
                .constrained_entries()
                .map(|entry| ConstrainedSum {
                    pair: entry.pair,
                    sum: coordinate.transform(entry.delta),
                })
                .collect(),
            range: problem.range(),
        }
    }

    /// Returns constraints on the same channels, with other entries.
    pub(crate) fn with_entries(&self, entries: Vec<ConstrainedSum>) -> Self {
        Self { entries, ..*self }
    }

    /// Returns the node count, inputs plus outputs.
    pub(crate) fn nodes(&self) -> usize {
        self.inputs + self.outputs
    }

    /// Returns the nodes for an entry's input and output channel.
    pub(crate) fn nodes_of(&self, pair: Pair) -> PairNodes {
        PairNodes {
            input: pair.input,
            output: self.inputs + pair.output,
        }
    }

    /// Returns the channel that a node represents.
    pub(crate) fn channel(&self, node: usize) -> Channel {
        if node < self.inputs {
            Channel::Input(node)
        } else {
            Channel::Output(node - self.inputs)
        }
    }

    /// Returns the permitted range for a node's value.
    pub(crate) fn node_range(&self, node: usize) -> Interval {
        if node < self.inputs {
            self.range
        } else {
            self.range.mirrored()
        }
    }
}
