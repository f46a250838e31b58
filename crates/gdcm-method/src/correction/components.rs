//! The channels that held products tie together, and what the held entries can be held at (stage 1).

use gdcm_model::dataset::Pair;

use super::problem::Problem;
use crate::correction::branch_and_bound::objective::Objective;
use crate::correction::branch_and_bound::term::{Function, Rounded, Term};

/// What is asked of the channels: sums of coordinates over the held entries, in a box.
///
/// The channels are *nodes* here, the inputs first: an input's value is its coordinate, an output's is minus its coordinate, so that a
/// held entry asks for a difference of two nodes.
#[derive(Clone, Debug)]
pub(crate) struct Held {
    /// Number of output channels.
    pub(crate) outputs: usize,
    /// Number of input channels.
    pub(crate) inputs: usize,
    /// Each held entry with the sum of its delta.
    pub(crate) entries: Vec<(Pair, f64)>,
    /// Least and greatest value of every channel.
    pub(crate) range: (f64, f64),
}

impl Held {
    /// What a problem asks.
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

    /// The input's and the output's node of an entry.
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

/// Where a node sits in its component.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Placement {
    /// Index of the component.
    pub(crate) component: usize,
    /// Value of the node where the component's scale is 0. Its rounding is that of the held sums on the way from the component's first
    /// node, and of the ends of the component's scale.
    pub(crate) offset: Rounded,
}

impl Placement {
    /// Where the node at the other end of a held entry sits, `by` away.
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

/// The connected components of the bipartite graph of the held entries, one free scale each (M8, structure).
///
/// With the scale `s` of its component a node has the value `offset + s`, so that what a held entry asks for does not depend on `s`: in
/// logarithms of gains, or in delays. A channel in no held entry is a component of its own.
#[derive(Clone, Debug)]
pub(crate) struct Components {
    /// The inputs, then the outputs.
    nodes: Vec<Placement>,
    /// Number of inputs.
    inputs: usize,
    /// Least scale of each component that keeps its channels inside the box.
    pub(crate) lower: Vec<f64>,
    /// Greatest scale of each component that keeps its channels inside the box.
    pub(crate) upper: Vec<f64>,
    /// How far each component is from being possible: the worst disagreement of a loop, or what the box lacks.
    strain: Vec<f64>,
}

/// Strain below which a component counts as possible as asked: well below the 1e-8 of M8, and its product's error stays
/// below 1e-9.
pub(crate) const STRAIN: f64 = 1e-9;

impl Components {
    /// The components of the held entries.
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

    /// The nodes of the inputs, and those of the outputs.
    pub(crate) fn sides(&self) -> (&[Placement], &[Placement]) {
        self.nodes.split_at(self.inputs)
    }

    /// The sum that two channels of one component have at every scale.
    pub(crate) fn sum(&self, pair: Pair) -> f64 {
        self.nodes[pair.input].offset.value - self.nodes[self.inputs + pair.output].offset.value
    }

    /// Whether everything can be held as asked.
    pub(crate) fn are_possible(&self) -> bool {
        self.strain.iter().all(|strain| *strain <= STRAIN)
    }

    /// Logarithm (or delay) of each input and of each output at these scales.
    pub(crate) fn channels(&self, scales: &[f64]) -> (Vec<f64>, Vec<f64>) {
        let value = |node: &Placement| node.offset.value + scales[node.component];
        let (inputs, outputs) = self.sides();
        // From zero, so that no zero is a negative one.
        (
            inputs.iter().map(value).collect(),
            outputs.iter().map(|node| 0.0 - value(node)).collect(),
        )
    }

    /// Moves every scale's zero to the middle of its interval: no channel is then far outside the box at scale 0.
    fn centre(&mut self, (low, high): (f64, f64)) {
        // A scale at its end differs from the exact one by the rounding of `low` or `high`, and of what is taken from it.
        let error = 2.0 * f64::EPSILON * low.abs().max(high.abs());
        for node in &mut self.nodes {
            let middle = 0.5 * (self.lower[node.component] + self.upper[node.component]);
            node.offset.add(Rounded {
                value: middle,
                error,
            });
        }
    }

    /// The interval of each scale; where the box leaves none, the middle of what is lacking.
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

/// Places everything that held entries tie to what is placed, along a spanning tree.
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

/// The sums nearest to those asked for that the box and the loops allow.
#[derive(Clone, Debug)]
pub(crate) struct Reached {
    /// Each held entry with its target, in the order asked.
    pub(crate) targets: Vec<(Pair, f64)>,
    /// Components of the held entries at their targets.
    pub(crate) components: Components,
    /// A point of the box that reaches the targets, a value for each node. Only where something is out of reach.
    pub(crate) point: Option<Vec<f64>>,
}

/// Finds the targets: `min sum (x_o + y_i - delta)^2` over the held entries, in the box (M8, reachability; M9).
///
/// Components that are possible as asked keep what is asked, exactly. `minimise` returns the minimum of a sum of squares over
/// a box; it is only called where something is out of reach.
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
