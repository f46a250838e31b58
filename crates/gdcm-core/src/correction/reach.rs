//! Stage 1: what the held entries can be held at.

use super::branch_and_bound::{Function, Objective, Rounded, Term};
use super::components::Components;
use crate::dataset::Pair;

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
