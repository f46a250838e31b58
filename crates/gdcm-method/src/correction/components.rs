//! Channels connected by constrained products, and feasible targets of the constrained entries (M8
//! and M9, stage 1).

use gdcm_model::dataset::Pair;

use super::branch_and_bound::objective::Objective;
use super::branch_and_bound::rounded::Rounded;
use super::branch_and_bound::term::{Function, Term};
use super::channels::Channel;
use super::interval::Interval;
use super::problem::Problem;

/// Constraints on the channels: the prescribed sums of coordinates for the constrained entries, and
/// a box.
///
/// The channels are the *nodes* of a graph, the inputs first. The value of an input node is its
/// coordinate, that of an output node is minus its coordinate, so that a constrained entry
/// prescribes the difference between two nodes.
#[derive(Clone, Debug)]
pub(crate) struct Constraints {
    pub(crate) outputs: usize,
    pub(crate) inputs: usize,
    pub(crate) entries: Vec<ConstrainedSum>,
    /// Permitted range of the coordinate, the same for every channel.
    pub(crate) range: Interval,
}

/// A constrained entry and its prescribed sum.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ConstrainedSum {
    pub(crate) pair: Pair,
    /// Prescribed sum of the two channels' coordinates.
    pub(crate) sum: f64,
}

/// The nodes of a response's input and output.
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
                    sum: coordinate.coordinate(entry.delta),
                })
                .collect(),
            range: problem.range(),
        }
    }

    /// Returns constraints on the same channels, with other entries.
    pub(crate) fn with_entries(&self, entries: Vec<ConstrainedSum>) -> Self {
        Self { entries, ..*self }
    }

    /// Returns the number of nodes, inputs plus outputs.
    pub(crate) fn nodes(&self) -> usize {
        self.inputs + self.outputs
    }

    /// Returns the nodes of an entry's input and output channel.
    pub(crate) fn nodes_of(&self, pair: Pair) -> PairNodes {
        PairNodes {
            input: pair.input,
            output: self.inputs + pair.output,
        }
    }

    /// Returns the channel of a node.
    pub(crate) fn channel(&self, node: usize) -> Channel {
        if node < self.inputs {
            Channel::Input(node)
        } else {
            Channel::Output(node - self.inputs)
        }
    }

    /// Returns the permitted range of a node's value.
    pub(crate) fn node_range(&self, node: usize) -> Interval {
        if node < self.inputs {
            self.range
        } else {
            self.range.mirrored()
        }
    }
}

/// The component of a node, and its offset in it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Placement {
    pub(crate) component: usize,
    /// Value of the node if the scale of its component is 0. Its error accumulates over the
    /// constrained sums between the first node of the component and this node; both ends of the
    /// scale contribute too.
    pub(crate) offset: Rounded,
}

impl Placement {
    /// Returns the placement of the node at the other end of a constrained entry, `by` above this
    /// node.
    fn across(self, by: f64) -> Self {
        // Error: the conversion of `by` to a logarithm or another time unit has rounded once.
        let mut offset = Rounded {
            value: by,
            error: f64::EPSILON * by.abs(),
        };
        offset.add(self.offset);
        Self { offset, ..self }
    }
}

/// Placements of the input nodes and of the output nodes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Nodes<'a> {
    pub(crate) inputs: &'a [Placement],
    pub(crate) outputs: &'a [Placement],
}

/// Coordinates of the inputs and of the outputs.
#[derive(Clone, Debug)]
pub(crate) struct ChannelCoordinates {
    pub(crate) inputs: Vec<f64>,
    pub(crate) outputs: Vec<f64>,
}

/// Connected components of the bipartite graph of constrained entries, each with a free scale (M8,
/// structure).
///
/// With the scale `s` of its component, a node has the value `offset + s`. A constrained sum, which
/// is a difference of two nodes, therefore does not depend on `s`. The coordinates are logarithms
/// of gains, or delays. A channel without a constrained entry is a component by itself.
#[derive(Clone, Debug)]
pub(crate) struct Components {
    /// Placements of the inputs, then of the outputs.
    nodes: Vec<Placement>,
    inputs: usize,
    /// Minimum scale of each component for which all its channels are inside the box.
    pub(crate) lower: Vec<f64>,
    /// Maximum scale of each component for which all its channels are inside the box.
    pub(crate) upper: Vec<f64>,
    /// Infeasibility of each component: the largest inconsistency among constraints that form a
    /// loop, or the amount by which the bounds are too narrow.
    strain: Vec<f64>,
}

/// Infeasibility up to which a component is accepted as feasible: well below the 1e-8 of M8, so
/// that the relative error of a product of gains stays below 1e-9.
pub(crate) const STRAIN: f64 = 1e-9;

impl Components {
    /// Finds the components that the constrained entries form.
    pub(crate) fn new(constraints: &Constraints) -> Self {
        let mut placed: Vec<Option<Placement>> = vec![None; constraints.nodes()];
        let mut count = 0;
        for node in 0..placed.len() {
            if placed[node].is_none() {
                placed[node] = Some(Placement {
                    component: count,
                    offset: Rounded::default(),
                });
                count += 1;
                place_tied_nodes(&mut placed, constraints);
            }
        }
        let mut components = Self {
            nodes: placed.into_iter().flatten().collect(),
            inputs: constraints.inputs,
            lower: vec![f64::NEG_INFINITY; count],
            upper: vec![f64::INFINITY; count],
            strain: vec![0.0; count],
        };
        components.close_box(constraints);
        components.centre(constraints.range);
        components.close_box(constraints);
        components.strain_loops(constraints);
        components
    }

    pub(crate) fn count(&self) -> usize {
        self.lower.len()
    }

    /// Returns the placements of the input nodes and of the output nodes.
    pub(crate) fn nodes(&self) -> Nodes<'_> {
        let (inputs, outputs) = self.nodes.split_at(self.inputs);
        Nodes { inputs, outputs }
    }

    /// Returns the sum of the coordinates of two channels in the same component, which does not
    /// depend on the scale.
    pub(crate) fn sum(&self, pair: Pair) -> f64 {
        self.nodes[pair.input].offset.value - self.nodes[self.inputs + pair.output].offset.value
    }

    /// Returns whether all constraints are feasible together.
    pub(crate) fn are_possible(&self) -> bool {
        self.strain.iter().all(|strain| *strain <= STRAIN)
    }

    /// Returns whether the component of an entry is infeasible.
    fn is_strained(&self, pair: Pair) -> bool {
        self.strain[self.nodes[pair.input].component] > STRAIN
    }

    /// Returns the coordinate of every channel (logarithm of the gain, or delay) at the given
    /// scales.
    pub(crate) fn channels(&self, scales: &[f64]) -> ChannelCoordinates {
        let nodes = self.nodes();
        ChannelCoordinates {
            inputs: nodes
                .inputs
                .iter()
                .map(|node| node.offset.value + scales[node.component])
                .collect(),
            // `0.0 -` instead of a negation, which would turn zero into -0.
            outputs: nodes
                .outputs
                .iter()
                .map(|node| 0.0 - (node.offset.value + scales[node.component]))
                .collect(),
        }
    }

    /// Shifts the offsets so that scale 0 is the middle of each component's interval, and no
    /// channel is far outside the box there.
    fn centre(&mut self, range: Interval) {
        // A scale at its end has two rounding errors: the end of the range, and the subtraction of
        // the offset.
        let error = 2.0 * f64::EPSILON * range.low.abs().max(range.high.abs());
        for node in &mut self.nodes {
            let middle = 0.5 * (self.lower[node.component] + self.upper[node.component]);
            node.offset.add(Rounded {
                value: middle,
                error,
            });
        }
    }

    /// Sets the interval of every scale. An empty interval is replaced by its midpoint and recorded
    /// as infeasibility.
    fn close_box(&mut self, constraints: &Constraints) {
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
            let lacking = self.lower[component] - self.upper[component];
            if lacking > 0.0 {
                self.strain[component] = lacking;
                let middle = 0.5 * (self.lower[component] + self.upper[component]);
                self.lower[component] = middle;
                self.upper[component] = middle;
            }
        }
    }

    /// Raises the infeasibility of every component to the largest inconsistency of its loops.
    fn strain_loops(&mut self, constraints: &Constraints) {
        for entry in &constraints.entries {
            let miss = (self.sum(entry.pair) - entry.sum).abs();
            let strain = &mut self.strain[self.nodes[entry.pair.input].component];
            *strain = strain.max(miss);
        }
    }
}

/// Places every node that constrained entries connect with a placed node, along a spanning tree.
fn place_tied_nodes(placed: &mut [Option<Placement>], constraints: &Constraints) {
    let mut grown = true;
    while grown {
        grown = false;
        for entry in &constraints.entries {
            let PairNodes { input, output } = constraints.nodes_of(entry.pair);
            match (placed[input], placed[output]) {
                (Some(known), None) => placed[output] = Some(known.across(-entry.sum)),
                (None, Some(known)) => placed[input] = Some(known.across(entry.sum)),
                _ => continue,
            }
            grown = true;
        }
    }
}

/// Result of stage 1: the feasible sums nearest to the prescribed sums, subject to the box and the
/// loops.
#[derive(Clone, Debug)]
pub(crate) struct Reached {
    /// The constrained entries with their targets, in the order of [`Constraints::entries`].
    pub(crate) targets: Vec<ConstrainedSum>,
    /// Components for the constrained entries at their targets.
    pub(crate) components: Components,
    /// A point in the box that attains the targets, one value per node; `None` if every entry is
    /// feasible.
    pub(crate) point: Option<Vec<f64>>,
}

/// Finds the targets: `min sum (x_o + y_i - delta)^2` over the constrained entries, subject to the
/// box (M8, reachability; M9).
///
/// Feasible components keep their prescribed sums exactly. `minimise` returns the minimum of a sum
/// of squares over a box; it is called only if an entry is infeasible.
pub(crate) fn reach<E>(
    constraints: &Constraints,
    minimise: impl FnOnce(&Objective) -> Result<Vec<f64>, E>,
) -> Result<Reached, E> {
    let asked = Components::new(constraints);
    if asked.are_possible() {
        return Ok(Reached {
            targets: constraints.entries.clone(),
            components: asked,
            point: None,
        });
    }
    let point = minimise(&nearest_sums(constraints, &asked))?;
    let mut targets = constraints.entries.clone();
    for target in &mut targets {
        if asked.is_strained(target.pair) {
            let nodes = constraints.nodes_of(target.pair);
            target.sum = point[nodes.input] - point[nodes.output];
        }
    }
    let components = Components::new(&constraints.with_entries(targets.clone()));
    Ok(Reached {
        targets,
        components,
        point: Some(point),
    })
}

/// Builds the least-squares problem of stage 1 for the infeasible components: one scale for each
/// node, and the ground.
fn nearest_sums(constraints: &Constraints, asked: &Components) -> Objective {
    let mut lower = Vec::new();
    let mut upper = Vec::new();
    for node in 0..constraints.nodes() {
        let range = constraints.node_range(node);
        lower.push(range.low);
        upper.push(range.high);
    }
    lower.push(0.0);
    upper.push(0.0);
    let mut terms = Vec::new();
    for entry in &constraints.entries {
        if asked.is_strained(entry.pair) {
            let nodes = constraints.nodes_of(entry.pair);
            let centre = Rounded {
                value: entry.sum,
                error: 0.0,
            };
            terms.push(Term {
                from: nodes.output,
                to: nodes.input,
                function: Function::Quadratic {
                    weight: 1.0,
                    centre,
                    relative: 0.0,
                },
            });
        }
    }
    Objective {
        lower,
        upper,
        terms,
        constant: Rounded::default(),
    }
}
