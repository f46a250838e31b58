//! Channels connected by constrained products, and the feasible targets of constrained entries (M8
//! and M9, stage 1).

use gdcm_model::dataset::Pair;

use super::branch_and_bound::objective::Objective;
use super::branch_and_bound::rounded::Rounded;
use super::branch_and_bound::term::{Function, Term};
use super::channels::Channel;
use super::interval::Interval;
use super::problem::Problem;

/// Constraints on the channels: prescribed coordinate sums of the constrained entries, and a box.
///
/// The channels are *nodes* here, the inputs first: an input's value is its coordinate, an output's
/// is minus its coordinate, so that a constrained entry prescribes the difference between two
/// nodes.
#[derive(Clone, Debug)]
pub(crate) struct Constraints {
    pub(crate) outputs: usize,
    pub(crate) inputs: usize,
    pub(crate) entries: Vec<ConstrainedSum>,
    /// Coordinate range, the same for every channel.
    pub(crate) range: Interval,
}

/// A constrained entry.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ConstrainedSum {
    pub(crate) pair: Pair,
    /// Prescribed sum of the two channels' coordinates.
    pub(crate) sum: f64,
}

/// Nodes of a response's two channels.
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

    /// Returns the same channels with other constraints.
    pub(crate) fn with_entries(&self, entries: Vec<ConstrainedSum>) -> Self {
        Self { entries, ..*self }
    }

    /// Returns the number of nodes: inputs and outputs.
    pub(crate) fn nodes(&self) -> usize {
        self.inputs + self.outputs
    }

    /// Returns the nodes of an entry's input and output.
    pub(crate) fn nodes_of(&self, pair: Pair) -> PairNodes {
        PairNodes {
            input: pair.input,
            output: self.inputs + pair.output,
        }
    }

    /// Returns a node's channel.
    pub(crate) fn channel(&self, node: usize) -> Channel {
        if node < self.inputs {
            Channel::Input(node)
        } else {
            Channel::Output(node - self.inputs)
        }
    }

    /// Returns the range of a node's value.
    pub(crate) fn node_range(&self, node: usize) -> Interval {
        if node < self.inputs {
            self.range
        } else {
            self.range.mirrored()
        }
    }
}

/// A node's position in its component.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Placement {
    pub(crate) component: usize,
    /// The node's value where the component's scale is 0. Rounding arises in the constrained sums
    /// between the component's first node and this node, and at both ends of the scale.
    pub(crate) offset: Rounded,
}

impl Placement {
    /// Returns the position across a constrained entry, at the distance `by`.
    fn across(self, by: f64) -> Self {
        // The conversion of `by` to a logarithm or another time unit has rounded once.
        let mut offset = Rounded {
            value: by,
            error: f64::EPSILON * by.abs(),
        };
        offset.add(self.offset);
        Self { offset, ..self }
    }
}

/// Input nodes and output nodes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Nodes<'a> {
    pub(crate) inputs: &'a [Placement],
    pub(crate) outputs: &'a [Placement],
}

/// Input coordinates and output coordinates.
#[derive(Clone, Debug)]
pub(crate) struct ChannelCoordinates {
    pub(crate) inputs: Vec<f64>,
    pub(crate) outputs: Vec<f64>,
}

/// Connected components in the bipartite graph of constrained entries, each with a free scale (M8,
/// structure).
///
/// With its component's scale `s` a node has the value `offset + s`, so that a constrained sum does
/// not depend on `s`: in logarithmic gains, or in delays. A channel without a constrained entry is
/// a component by itself.
#[derive(Clone, Debug)]
pub(crate) struct Components {
    /// Positions of the inputs, then of the outputs.
    nodes: Vec<Placement>,
    inputs: usize,
    /// Minimum scale of each component that keeps its channels inside the box.
    pub(crate) lower: Vec<f64>,
    /// Maximum scale of each component that keeps its channels inside the box.
    pub(crate) upper: Vec<f64>,
    /// Infeasibility of each component: the largest inconsistency among constraints that form a
    /// loop, or the amount by which the bounds are too narrow.
    strain: Vec<f64>,
}

/// Infeasibility below which a component counts as feasible: well below the 1e-8 of M8, so that the
/// relative error in a product of gains stays below 1e-9.
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

    /// Returns the number of components.
    pub(crate) fn count(&self) -> usize {
        self.lower.len()
    }

    /// Returns the nodes on both sides.
    pub(crate) fn nodes(&self) -> Nodes<'_> {
        let (inputs, outputs) = self.nodes.split_at(self.inputs);
        Nodes { inputs, outputs }
    }

    /// Returns the coordinate sum of two channels in the same component; the scale does not change
    /// it.
    pub(crate) fn sum(&self, pair: Pair) -> f64 {
        self.nodes[pair.input].offset.value - self.nodes[self.inputs + pair.output].offset.value
    }

    /// Whether every entry can be constrained to its delta.
    pub(crate) fn are_possible(&self) -> bool {
        self.strain.iter().all(|strain| *strain <= STRAIN)
    }

    /// Whether an entry's component is infeasible.
    fn is_strained(&self, pair: Pair) -> bool {
        self.strain[self.nodes[pair.input].component] > STRAIN
    }

    /// Returns every channel's logarithm (or delay) at these scales.
    pub(crate) fn channels(&self, scales: &[f64]) -> ChannelCoordinates {
        let nodes = self.nodes();
        ChannelCoordinates {
            inputs: nodes
                .inputs
                .iter()
                .map(|node| node.offset.value + scales[node.component])
                .collect(),
            // Subtracted from zero, so that no zero is negative.
            outputs: nodes
                .outputs
                .iter()
                .map(|node| 0.0 - (node.offset.value + scales[node.component]))
                .collect(),
        }
    }

    /// Moves every scale's zero to the middle of its interval, so that no channel is far outside
    /// the box at scale 0.
    fn centre(&mut self, range: Interval) {
        // A scale at its end differs from the exact value by two roundings: the range's end, and
        // the offset subtracted from it.
        let error = 2.0 * f64::EPSILON * range.low.abs().max(range.high.abs());
        for node in &mut self.nodes {
            let middle = 0.5 * (self.lower[node.component] + self.upper[node.component]);
            node.offset.add(Rounded {
                value: middle,
                error,
            });
        }
    }

    /// Sets every scale's interval; an empty interval is replaced by its midpoint.
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

    /// Raises the infeasibility of every component to the largest inconsistency in its loops.
    fn strain_loops(&mut self, constraints: &Constraints) {
        for entry in &constraints.entries {
            let miss = (self.sum(entry.pair) - entry.sum).abs();
            let strain = &mut self.strain[self.nodes[entry.pair.input].component];
            *strain = strain.max(miss);
        }
    }
}

/// Places every node that constrained entries tie to a placed node, along a spanning tree.
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

/// Feasible sums nearest to the prescribed sums, subject to the box and the loops.
#[derive(Clone, Debug)]
pub(crate) struct Reached {
    /// The constrained entries with their targets, ordered like [`Constraints::entries`].
    pub(crate) targets: Vec<ConstrainedSum>,
    /// Components with the constrained entries at their targets.
    pub(crate) components: Components,
    /// A point in the box that reaches the targets, a value for each node; `None` where every entry
    /// is feasible.
    pub(crate) point: Option<Vec<f64>>,
}

/// Finds the targets: `min sum (x_o + y_i - delta)^2` over the constrained entries, in the box (M8,
/// reachability; M9).
///
/// Feasible components keep the prescribed sums exactly. `minimise` returns the minimum of a sum of
/// squares over a box; it is only called where an entry is infeasible.
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

/// Builds the least squares problem of stage 1 over the infeasible components: a scale for each
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
