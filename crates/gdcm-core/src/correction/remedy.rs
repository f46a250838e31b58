//! What would let every held entry be held.

use super::*;
use crate::dataset::Pair;

/// Single changes after which every held entry can be held at its delta; empty where it takes several.
#[derive(Clone, Debug, PartialEq)]
pub struct Remedy {
    /// What is held: gains, or delays in seconds.
    pub quantity: Quantity,
    /// Least upper bound that does, the lower one as it is, rounded up to three digits.
    pub upper: Option<f64>,
    /// Greatest lower bound that does, the upper one as it is, rounded down to three digits; none for delays.
    pub lower: Option<f64>,
    /// The held entries of which each, freed alone, does.
    pub free: Vec<Pair>,
}

impl Remedy {
    /// The remedy for `held`, the held entries of `problem`; `suspects` are the entries of its conflicts.
    pub(crate) fn new(
        problem: &Problem,
        held: &Held,
        suspects: &[Pair],
        effort: &Effort<'_>,
    ) -> Result<Self, SearchStopped> {
        let (quantity, coordinate) = (problem.quantity, problem.coordinate());
        let Changes { upper, lower, free } = changes(held, suspects, effort)?;
        // A bound that is not the obstacle stays as it is.
        let upper = upper.map(|upper| three_digits_up(coordinate.value(upper)).max(problem.bounds.upper));
        let lower = lower.map(|lower| three_digits_down(coordinate.value(lower)).min(problem.bounds.lower));
        Ok(Self { quantity, upper, lower: lower.filter(|_| quantity.has_lower_bound()), free })
    }

    /// The remedies in words; empty where there is none.
    pub fn words(&self, inputs: &[String], outputs: &[String]) -> String {
        let unit = self.quantity.unit();
        let upper = self.upper.map(|upper| format!("an upper bound of {upper}{unit}"));
        let lower = self.lower.map(|lower| format!("a lower bound of {lower}{unit}"));
        let free = self.free.iter().map(|&pair| format!("freeing {}", pair_name(pair, inputs, outputs)));
        let ways: Vec<String> = upper.into_iter().chain(lower).chain(free).collect();
        if ways.is_empty() { String::new() } else { format!("Any one of these lets all be held: {}.", ways.join("; ")) }
    }
}

/// Single changes that would do, in sums of coordinates.
struct Changes {
    upper: Option<f64>,
    lower: Option<f64>,
    free: Vec<Pair>,
}

/// Least and greatest offset of the channels of one component.
struct Spread {
    inputs: (f64, f64),
    outputs: (f64, f64),
}

fn changes(held: &Held, suspects: &[Pair], effort: &Effort<'_>) -> Result<Changes, SearchStopped> {
    let (low, high) = held.range;
    let components = Components::new(held.outputs, held.inputs, &held.entries, held.range);
    let without = |freed: &Pair| Held {
        entries: held.entries.iter().filter(|(pair, _)| pair != freed).copied().collect(),
        ..held.clone()
    };
    let mut free = Vec::new();
    for pair in suspects {
        // Each channel is placed by a walk along the held entries.
        effort.spend(((held.inputs + held.outputs) * held.entries.len()) as u64 / 8);
        effort.check()?;
        if is_reachable(&without(pair)) {
            free.push(*pair);
        }
    }
    if !loops_agree(&components, held) {
        return Ok(Changes { upper: None, lower: None, free });
    }
    let spreads: Vec<Spread> = (0..components.count()).filter_map(|component| spread(&components, component)).collect();
    let widest =
        spreads.iter().map(|spread| (spread.inputs.1 - spread.inputs.0).max(spread.outputs.1 - spread.outputs.0));
    let widest = widest.fold(0.0, f64::max);
    let half_sum = |ends: fn(&Spread) -> f64| spreads.iter().map(move |spread| 0.5 * ends(spread));
    let highest = half_sum(|spread| spread.inputs.1 + spread.outputs.1).fold(f64::NEG_INFINITY, f64::max);
    let lowest = half_sum(|spread| spread.inputs.0 + spread.outputs.0).fold(f64::INFINITY, f64::min);
    let rounding = 1e-12 * (1.0 + low.abs() + high.abs());
    Ok(Changes {
        upper: (lowest >= low - rounding).then(|| high.max(low + widest).max(highest)),
        lower: (highest <= high + rounding).then(|| low.min(high - widest).min(lowest)),
        free,
    })
}

/// Whether every loop of held entries leads back to where it began.
fn loops_agree(components: &Components, held: &Held) -> bool {
    held.entries.iter().all(|(pair, sum)| {
        let reached = components.inputs[pair.input].offset.value + components.outputs[pair.output].offset.value;
        (reached - sum).abs() <= super::STRAIN
    })
}

/// The spread of a component with both inputs and outputs; a single channel is always possible.
fn spread(components: &Components, component: usize) -> Option<Spread> {
    let ends = |channels: &[super::Placement]| {
        let offsets =
            channels.iter().filter(|channel| channel.component == component).map(|channel| channel.offset.value);
        offsets.fold(None, |ends: Option<(f64, f64)>, offset| match ends {
            Some((least, most)) => Some((least.min(offset), most.max(offset))),
            None => Some((offset, offset)),
        })
    };
    Some(Spread { inputs: ends(&components.inputs)?, outputs: ends(&components.outputs)? })
}
