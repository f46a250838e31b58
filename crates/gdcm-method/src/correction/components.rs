//! Channels tied together by constrained products, and the feasible targets of the constrained
//! entries (stage 1).

use gdcm_model::dataset::Pair;

use super::problem::Problem;
use crate::correction::branch_and_bound::objective::Objective;
use crate::correction::branch_and_bound::term::{Function, Rounded, Term};

/// Constraints on the channels: sums of coordinates over the constrained entries, in a box.
///
/// The channels are *nodes* here, the inputs first: an input's value is its coordinate, an output's
/// is minus its coordinate, so that a constrained entry prescribes a difference of two nodes.
#[derive(Clone, Debug)]
pub(crate) struct Held {
    pub(crate) outputs: usize,
    pub(crate) inputs: usize,
    /// Each constrained entry with its delta as a sum of coordinates.
    pub(crate) entries: Vec<(Pair, f64)>,
    /// Least and greatest value of every channel.
    pub(crate) range: (f64, f64),
}

impl Held {
    /// Constraints of `problem`.
    pub(crate) fn of(problem: &Problem) -> Self {
        let coordinate = problem.coordinate();
        Self {
            outputs: problem.delta.outputs(),
            inputs: problem.delta.inputs(),
            entries: problem
                .held_entries()
                .map(|(pair, delta)| (pair, coordinate.of(delta)))
                .collect(),
            range: problem.range(),
        }
    }

    /// Number of nodes.
    pub(crate) fn nodes(&self) -> usize {
        self.inputs + self.outputs
    }

    /// Nodes of an entry's input and output.
    pub(crate) fn nodes_of(&self, pair: Pair) -> (usize, usize) {
        (pair.input, self.inputs + pair.output)
    }

    /// Least and greatest value of a node.
    pub(crate) fn ends(&self, node: usize) -> (f64, f64) {
        let (low, high) = self.range;
        if node < self.inputs {
            (low, high)
        } else {
            (-high, -low)
        }
    }
}

/// Position of a node in its component.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Placement {
    pub(crate) component: usize,
    /// Value of the node where the component's scale is 0. Its rounding is the rounding of the
    /// constrained sums on the way from the component's first node, and of the ends of the
    /// component's scale.
    pub(crate) offset: Rounded,
}

impl Placement {
    /// Position of the node at the other end of a constrained entry, at the distance `by`.
    fn across(self, by: f64) -> Self {
        // A logarithm, or a time in another unit, is rounded once.
        let mut offset = Rounded {
            value: by,
            error: f64::EPSILON * by.abs(),
        };
        offset.add(self.offset);
        Self { offset, ..self }
    }
}

/// Connected components of the bipartite graph of the constrained entries, one free scale each (M8,
/// structure).
///
/// With the scale `s` of its component a node has the value `offset + s`, so that the sum of a
/// constrained entry does not depend on `s`: in logarithms of gains, or in delays. A channel
/// without a constrained entry is a component of its own.
#[derive(Clone, Debug)]
pub(crate) struct Components {
    /// The inputs, then the outputs.
    nodes: Vec<Placement>,
    inputs: usize,
    /// Least scale of each component that keeps its channels inside the box.
    pub(crate) lower: Vec<f64>,
    /// Greatest scale of each component that keeps its channels inside the box.
    pub(crate) upper: Vec<f64>,
    /// Infeasibility of each component: the worst disagreement of a loop, or the width that the box
    /// lacks.
    strain: Vec<f64>,
}

/// Strain below which a component counts as feasible: well below the 1e-8 of M8, so that the error
/// of its product stays below 1e-9.
pub(crate) const STRAIN: f64 = 1e-9;

impl Components {
    /// Components of the constrained entries.
    pub(crate) fn new(held: &Held) -> Self {
        let mut placed: Vec<Option<Placement>> = vec![None; held.nodes()];
        let mut count = 0;
        for node in 0..placed.len() {
            if placed[node].is_none() {
                placed[node] = Some(Placement {
                    component: count,
                    offset: Rounded::default(),
                });
                count += 1;
                spread(&mut placed, held);
            }
        }
        let mut components = Self {
            nodes: placed.into_iter().flatten().collect(),
            inputs: held.inputs,
            lower: vec![f64::NEG_INFINITY; count],
            upper: vec![f64::INFINITY; count],
            strain: vec![0.0; count],
        };
        components.close_box(held);
        components.centre(held.range);
        components.close_box(held);
        for (pair, sum) in &held.entries {
            let miss = (components.sum(*pair) - sum).abs();
            let strain = &mut components.strain[components.nodes[pair.input].component];
            *strain = strain.max(miss);
        }
        components
    }

    /// Number of components.
    pub(crate) fn count(&self) -> usize {
        self.lower.len()
    }

    /// Nodes of the inputs and of the outputs.
    pub(crate) fn sides(&self) -> (&[Placement], &[Placement]) {
        self.nodes.split_at(self.inputs)
    }

    /// Sum of two channels of one component, the same at every scale.
    pub(crate) fn sum(&self, pair: Pair) -> f64 {
        self.nodes[pair.input].offset.value - self.nodes[self.inputs + pair.output].offset.value
    }

    /// Whether every entry can be constrained to its delta.
    pub(crate) fn are_possible(&self) -> bool {
        self.strain.iter().all(|strain| *strain <= STRAIN)
    }

    /// Logarithm (or delay) of each input and of each output at these scales.
    pub(crate) fn channels(&self, scales: &[f64]) -> (Vec<f64>, Vec<f64>) {
        let value = |node: &Placement| node.offset.value + scales[node.component];
        let (inputs, outputs) = self.sides();
        // Subtracted from zero, so that no zero is negative.
        (
            inputs.iter().map(value).collect(),
            outputs.iter().map(|node| 0.0 - value(node)).collect(),
        )
    }

    /// Moves every scale's zero to the middle of its interval, so that no channel is far outside
    /// the box at scale 0.
    fn centre(&mut self, (low, high): (f64, f64)) {
        // A scale at its end differs from the exact value by the rounding of `low` or `high`, and
        // of the offset subtracted from it.
        let error = 2.0 * f64::EPSILON * low.abs().max(high.abs());
        for node in &mut self.nodes {
            let middle = 0.5 * (self.lower[node.component] + self.upper[node.component]);
            node.offset.add(Rounded {
                value: middle,
                error,
            });
        }
    }

    /// Sets the interval of each scale; an empty interval is replaced by its midpoint.
    fn close_box(&mut self, held: &Held) {
        self.lower.fill(f64::NEG_INFINITY);
        self.upper.fill(f64::INFINITY);
        for (index, node) in self.nodes.iter().enumerate() {
            let (least, most) = held.ends(index);
            let lower = &mut self.lower[node.component];
            let upper = &mut self.upper[node.component];
            *lower = lower.max(least - node.offset.value);
            *upper = upper.min(most - node.offset.value);
        }
        for component in 0..self.count() {
            let lacking = self.lower[component] - self.upper[component];
            if lacking > 0.0 {
                self.strain[component] = lacking;
                let middle = 0.5 * (self.lower[component] + self.upper[component]);
                (self.lower[component], self.upper[component]) = (middle, middle);
            }
        }
    }
}

/// Places every node that constrained entries tie to a placed node, along a spanning tree.
fn spread(placed: &mut [Option<Placement>], held: &Held) {
    let mut grown = true;
    while grown {
        grown = false;
        for (pair, sum) in &held.entries {
            let (input, output) = held.nodes_of(*pair);
            match (placed[input], placed[output]) {
                (Some(known), None) => placed[output] = Some(known.across(-sum)),
                (None, Some(known)) => placed[input] = Some(known.across(*sum)),
                _ => continue,
            }
            grown = true;
        }
    }
}

/// Feasible sums nearest to the prescribed sums, subject to the box and the loops.
#[derive(Clone, Debug)]
pub(crate) struct Reached {
    /// Each constrained entry with its target, in the order of `entries`.
    pub(crate) targets: Vec<(Pair, f64)>,
    /// Components of the constrained entries at their targets.
    pub(crate) components: Components,
    /// A point of the box that reaches the targets, a value for each node; only where an entry is
    /// infeasible.
    pub(crate) point: Option<Vec<f64>>,
}

/// Finds the targets: `min sum (x_o + y_i - delta)^2` over the constrained entries, in the box (M8,
/// reachability; M9).
///
/// Feasible components keep the prescribed sums exactly. `minimise` returns the minimum of a sum of
/// squares over a box; it is only called where an entry is infeasible.
pub(crate) fn reach<E>(
    held: &Held,
    minimise: impl FnOnce(&Objective) -> Result<Vec<f64>, E>,
) -> Result<Reached, E> {
    let asked = Components::new(held);
    if asked.are_possible() {
        return Ok(Reached {
            targets: held.entries.clone(),
            components: asked,
            point: None,
        });
    }
    let strained = |pair: Pair| asked.strain[asked.nodes[pair.input].component] > STRAIN;
    let point = minimise(&nearest(held, strained))?;
    let target = |&(pair, delta): &(Pair, f64)| {
        let (input, output) = held.nodes_of(pair);
        (
            pair,
            if strained(pair) {
                point[input] - point[output]
            } else {
                delta
            },
        )
    };
    let targets: Vec<(Pair, f64)> = held.entries.iter().map(target).collect();
    let components = Components::new(&Held {
        entries: targets.clone(),
        ..*held
    });
    Ok(Reached {
        targets,
        components,
        point: Some(point),
    })
}

/// The least squares problem of stage 1: one scale for each node, and the ground.
fn nearest(held: &Held, strained: impl Fn(Pair) -> bool) -> Objective {
    let ends = (0..held.nodes())
        .map(|node| held.ends(node))
        .chain([(0.0, 0.0)]);
    let (lower, upper) = ends.unzip();
    let terms = held
        .entries
        .iter()
        .filter(|(pair, _)| strained(*pair))
        .map(|&(pair, delta)| {
            let (to, from) = held.nodes_of(pair);
            let centre = Rounded {
                value: delta,
                error: 0.0,
            };
            Term {
                from,
                to,
                function: Function::Quadratic {
                    weight: 1.0,
                    centre,
                    relative: 0.0,
                },
            }
        });
    Objective {
        lower,
        upper,
        terms: terms.collect(),
        constant: Rounded::default(),
    }
}
