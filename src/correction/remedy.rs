//! What would let every held entry be held.

use super::components::Components;
use super::reach::{Held, is_reachable};
use crate::dataset::Pair;

/// Single changes that would do, in sums of logarithms or of delays.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Remedy {
    /// Least upper bound that would do, the lower one as it is.
    pub(crate) upper: Option<f64>,
    /// Greatest lower bound that would do, the upper one as it is.
    pub(crate) lower: Option<f64>,
    /// The entries of which each, freed alone, would do.
    pub(crate) free: Vec<Pair>,
}

/// Least and greatest offset of the channels of one component.
struct Spread {
    inputs: (f64, f64),
    outputs: (f64, f64),
}

/// The single changes that let everything in `held` be held; `suspects` are the entries of its conflicts.
pub(crate) fn remedy(held: &Held, suspects: &[Pair]) -> Remedy {
    let (low, high) = held.range;
    let components = Components::new(held.outputs, held.inputs, &held.entries, held.range);
    let without = |freed: &Pair| Held {
        entries: held.entries.iter().filter(|(pair, _)| pair != freed).copied().collect(),
        ..held.clone()
    };
    let free = suspects.iter().filter(|pair| is_reachable(&without(pair))).copied().collect();
    if !loops_agree(&components, held) {
        return Remedy { upper: None, lower: None, free };
    }
    let spreads: Vec<Spread> = (0..components.count()).filter_map(|component| spread(&components, component)).collect();
    let widest =
        spreads.iter().map(|spread| (spread.inputs.1 - spread.inputs.0).max(spread.outputs.1 - spread.outputs.0));
    let widest = widest.fold(0.0, f64::max);
    let half_sum = |ends: fn(&Spread) -> f64| spreads.iter().map(move |spread| 0.5 * ends(spread));
    let highest = half_sum(|spread| spread.inputs.1 + spread.outputs.1).fold(f64::NEG_INFINITY, f64::max);
    let lowest = half_sum(|spread| spread.inputs.0 + spread.outputs.0).fold(f64::INFINITY, f64::min);
    let rounding = 1e-12 * (1.0 + low.abs() + high.abs());
    Remedy {
        upper: (lowest >= low - rounding).then(|| high.max(low + widest).max(highest)),
        lower: (highest <= high + rounding).then(|| low.min(high - widest).min(lowest)),
        free,
    }
}

/// Whether every loop of held entries leads back to where it began.
fn loops_agree(components: &Components, held: &Held) -> bool {
    held.entries.iter().all(|(pair, sum)| {
        let reached = components.inputs[pair.input].offset + components.outputs[pair.output].offset;
        (reached - sum).abs() <= super::reach::STRAIN
    })
}

/// The spread of a component with both inputs and outputs; a single channel is always possible.
fn spread(components: &Components, component: usize) -> Option<Spread> {
    let ends = |channels: &[super::components::Placement]| {
        let offsets = channels.iter().filter(|channel| channel.component == component).map(|channel| channel.offset);
        offsets.fold(None, |ends: Option<(f64, f64)>, offset| match ends {
            Some((least, most)) => Some((least.min(offset), most.max(offset))),
            None => Some((offset, offset)),
        })
    };
    Some(Spread { inputs: ends(&components.inputs)?, outputs: ends(&components.outputs)? })
}
