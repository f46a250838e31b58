//! The channels that held products tie together, and what the held entries can be held at (stage 1).

use super::{Function, Objective, Rounded, Term};
use crate::dataset::Pair;

/// Where a channel sits in its component.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Placement {
    /// Index of the component.
    pub(crate) component: usize,
    /// Logarithm of the gain (or the delay) where the component's scale is 0. Its rounding is that of the held sums on the way
    /// from the component's first channel, and of the ends of the component's scale.
    pub(crate) offset: Rounded,
}

impl Placement {
    /// Where the channel at the other end of a held entry sits.
    fn across(self, sum: f64) -> Self {
        // A logarithm, or a time in another unit, is rounded once.
        let mut offset = Rounded { value: sum, error: f64::EPSILON * sum.abs() };
        offset.add(Rounded { value: -self.offset.value, error: self.offset.error });
        Self { offset, ..self }
    }
}

/// The connected components of the bipartite graph of the held entries, one free scale each (M8, structure).
///
/// With the scale `s` of its component an input has the logarithm `offset + s` and an output `offset - s`, so that the sum over
/// a held entry does not depend on `s`. Delays are the same with seconds for logarithms. A channel in no held entry is a
/// component of its own.
#[derive(Clone, Debug)]
pub(crate) struct Components {
    pub(crate) inputs: Vec<Placement>,
    pub(crate) outputs: Vec<Placement>,
    /// Least scale of each component that keeps its channels inside the box.
    pub(crate) lower: Vec<f64>,
    /// Greatest scale of each component that keeps its channels inside the box.
    pub(crate) upper: Vec<f64>,
    /// How far each component is from being possible: the worst disagreement of a loop, or what the box lacks.
    pub(crate) strain: Vec<f64>,
}

impl Components {
    /// The components of `outputs` x `inputs` channels in `[low, high]` with these sums held.
    pub(crate) fn new(outputs: usize, inputs: usize, held: &[(Pair, f64)], (low, high): (f64, f64)) -> Self {
        let mut placed = Placed { inputs: vec![None; inputs], outputs: vec![None; outputs], count: 0 };
        for input in 0..inputs {
            if placed.inputs[input].is_none() {
                placed.spread(input, held);
            }
        }
        let (inputs, outputs) = placed.finish();
        let count = inputs.iter().chain(&outputs).map(|channel| channel.component + 1).max().unwrap_or(0);
        let mut components = Self {
            inputs,
            outputs,
            lower: vec![f64::NEG_INFINITY; count],
            upper: vec![f64::INFINITY; count],
            strain: vec![0.0; count],
        };
        components.close_box(low, high);
        components.centre(low, high);
        components.close_box(low, high);
        for (pair, sum) in held {
            let strain = &mut components.strain[components.inputs[pair.input].component];
            let reached = components.inputs[pair.input].offset.value + components.outputs[pair.output].offset.value;
            *strain = strain.max((reached - sum).abs());
        }
        components
    }

    /// Number of components.
    pub(crate) fn count(&self) -> usize {
        self.lower.len()
    }

    /// Logarithm (or delay) of each input and of each output at these scales.
    pub(crate) fn channels(&self, scales: &[f64]) -> (Vec<f64>, Vec<f64>) {
        let inputs = self.inputs.iter().map(|channel| channel.offset.value + scales[channel.component]).collect();
        let outputs = self.outputs.iter().map(|channel| channel.offset.value - scales[channel.component]).collect();
        (inputs, outputs)
    }

    /// Moves every scale's zero to the middle of its interval: no channel is then far outside the box at scale 0.
    fn centre(&mut self, low: f64, high: f64) {
        let middle = |component: usize| 0.5 * (self.lower[component] + self.upper[component]);
        // A scale at its end differs from the exact one by the rounding of `low` or `high`, and of what is taken from it.
        let ends = 2.0 * f64::EPSILON * low.abs().max(high.abs());
        for channel in &mut self.inputs {
            channel.offset.add(Rounded { value: middle(channel.component), error: ends });
        }
        for channel in &mut self.outputs {
            channel.offset.add(Rounded { value: -middle(channel.component), error: ends });
        }
    }

    /// The interval of each scale; where the box leaves none, the middle of what is lacking.
    fn close_box(&mut self, low: f64, high: f64) {
        self.lower.fill(f64::NEG_INFINITY);
        self.upper.fill(f64::INFINITY);
        let inputs = self
            .inputs
            .iter()
            .map(|channel| (channel.component, low - channel.offset.value, high - channel.offset.value));
        let outputs = self
            .outputs
            .iter()
            .map(|channel| (channel.component, channel.offset.value - high, channel.offset.value - low));
        for (component, least, most) in inputs.chain(outputs) {
            self.lower[component] = self.lower[component].max(least);
            self.upper[component] = self.upper[component].min(most);
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

struct Placed {
    inputs: Vec<Option<Placement>>,
    outputs: Vec<Option<Placement>>,
    count: usize,
}

impl Placed {
    /// Places everything that held entries tie to `input`, along a spanning tree.
    fn spread(&mut self, input: usize, held: &[(Pair, f64)]) {
        let component = self.count;
        self.count += 1;
        self.inputs[input] = Some(Placement { component, offset: Rounded::default() });
        let mut grown = true;
        while grown {
            grown = false;
            for (pair, sum) in held {
                match (self.inputs[pair.input], self.outputs[pair.output]) {
                    (Some(known), None) => {
                        self.outputs[pair.output] = Some(known.across(*sum));
                        grown = true;
                    }
                    (None, Some(known)) => {
                        self.inputs[pair.input] = Some(known.across(*sum));
                        grown = true;
                    }
                    _ => {}
                }
            }
        }
    }

    /// Every output that is still alone becomes a component of its own.
    fn finish(self) -> (Vec<Placement>, Vec<Placement>) {
        let mut count = self.count;
        let mut alone = || {
            count += 1;
            Placement { component: count - 1, offset: Rounded::default() }
        };
        let outputs = self.outputs.into_iter().map(|placement| placement.unwrap_or_else(&mut alone)).collect();
        let inputs = self.inputs.into_iter().map(|placement| placement.unwrap_or_else(&mut alone)).collect();
        (inputs, outputs)
    }
}

/// What is asked of the channels: sums of coordinates over the held entries, in a box.
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

/// The sums nearest to those asked for that the box and the loops allow.
#[derive(Clone, Debug)]
pub(crate) struct Reached {
    /// Each held entry with its target, in the order asked.
    pub(crate) targets: Vec<(Pair, f64)>,
    /// Components of the held entries at their targets.
    pub(crate) components: Components,
    /// A point of the box that reaches the targets: inputs, then minus the outputs. Only where something is out of reach.
    pub(crate) point: Option<Vec<f64>>,
}

/// Strain below which a component counts as possible as asked: well below the 1e-8 of M8, and its product's error stays
/// below 1e-9.
pub(crate) const STRAIN: f64 = 1e-9;

/// Finds the targets: `min sum (x_o + y_i - delta)^2` over the held entries, in the box (M8, reachability; M9).
///
/// Components that are possible as asked keep what is asked, exactly. `minimise` returns the minimum of a sum of squares over
/// a box; it is only called where something is out of reach.
pub(crate) fn reach<E>(held: &Held, minimise: impl FnOnce(&Objective) -> Result<Vec<f64>, E>) -> Result<Reached, E> {
    let asked = Components::new(held.outputs, held.inputs, &held.entries, held.range);
    if asked.strain.iter().all(|strain| *strain <= STRAIN) {
        return Ok(Reached { targets: held.entries.clone(), components: asked, point: None });
    }
    let strained = |pair: &Pair| asked.strain[asked.inputs[pair.input].component] > STRAIN;
    let objective = nearest(held, strained);
    let point = minimise(&objective)?;
    let target = |(pair, delta): &(Pair, f64)| {
        let reached = point[pair.input] - point[held.inputs + pair.output];
        (*pair, if strained(pair) { reached } else { *delta })
    };
    let targets: Vec<(Pair, f64)> = held.entries.iter().map(target).collect();
    let components = Components::new(held.outputs, held.inputs, &targets, held.range);
    Ok(Reached { targets, components, point: Some(point) })
}

/// Whether everything can be held as asked.
pub(crate) fn is_reachable(held: &Held) -> bool {
    let asked = Components::new(held.outputs, held.inputs, &held.entries, held.range);
    asked.strain.iter().all(|strain| *strain <= STRAIN)
}

/// The least squares problem of stage 1: one scale for each input and (with its sign turned) each output.
fn nearest(held: &Held, strained: impl Fn(&Pair) -> bool) -> Objective {
    let (low, high) = held.range;
    let mut lower = vec![low; held.inputs];
    let mut upper = vec![high; held.inputs];
    lower.extend(std::iter::repeat_n(-high, held.outputs).chain([0.0]));
    upper.extend(std::iter::repeat_n(-low, held.outputs).chain([0.0]));
    let terms = held.entries.iter().filter(|(pair, _)| strained(pair)).map(|(pair, delta)| Term {
        from: held.inputs + pair.output,
        to: pair.input,
        function: Function::Quadratic { weight: 1.0, centre: Rounded { value: *delta, error: 0.0 }, relative: 0.0 },
    });
    Objective { lower, upper, terms: terms.collect(), constant: Rounded::default() }
}
