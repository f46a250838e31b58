//! A problem's objective as a function of the scales that its constrained entries leave free (M8,
//! proof).
//!
//! ```text
//! F = sum w (delta - net)^2 + alpha sum (channel - neutral)^2,     w = 1 for a fitted entry
//! coordinate of net = offset + s_input - s_output
//! ```
//!
//! `w` is 0 for an ignored entry. `s_input` and `s_output` are the scales of the components
//! ([`super::components`]) that contain the entry's input and output; `offset` is the coordinate of
//! the net value at scales 0. A channel's deviation from neutral is an entry with the weight
//! `alpha`; its other scale is the *ground*, a last scale that is always 0.

use super::branch_and_bound::exponential::{CombinedEntries, ProductEntry};
use super::branch_and_bound::objective::Objective;
use super::branch_and_bound::quadratic::{SquareEntry, quadratic_terms};
use super::branch_and_bound::rounded::Rounded;
use super::branch_and_bound::term::{Function, Term, TermSum};
use super::components::Components;
use super::problem::{Entry, Problem};
use super::quantity::{Coordinate, GainObjective, Quantity, SQUARED_DECIBEL};

/// Rounding level of the objective, relative to the summed squares of the deltas: rounding in a sum
/// of squares is proportional to the summed values.
const RELATIVE_ROUNDING: f64 = 1e-9;
/// Rounding level of an output's squared deviation from neutral: the square of a rounding error.
const SQUARED_ROUNDING: f64 = 1e-20;

/// Builds the objective of `problem` over the scales of `components`, in the problem's coordinate.
pub(crate) fn scaled_objective(problem: &Problem, components: &Components) -> Objective {
    let mut entries = fit_entries(problem, components);
    if problem.alpha > 0.0 {
        entries.extend(departures(problem, components));
    }
    let scales = components.count() + 1;
    let coordinate = problem.coordinate();
    let TermSum { terms, constant } = match problem.quantity {
        Quantity::Gain(GainObjective::Ratio) => ratio_terms(&entries, scales),
        Quantity::Gain(GainObjective::Decibel) => quadratic_terms(
            &in_coordinate(&entries, coordinate, SQUARED_DECIBEL),
            scales,
        ),
        Quantity::Delay | Quantity::SignedDelay => {
            quadratic_terms(&in_coordinate(&entries, coordinate, 1.0), scales)
        }
    };
    let mut lower = components.lower.clone();
    let mut upper = components.upper.clone();
    // Last scale: the ground.
    lower.push(0.0);
    upper.push(0.0);
    Objective {
        lower,
        upper,
        terms,
        constant,
    }
}

/// A summand of the objective: a fitted entry, or a channel's deviation from neutral.
struct ScaledEntry {
    /// Index of the output's scale; the ground, if the entry is an input's deviation from neutral.
    output: usize,
    /// Index of the input's scale; the ground, if the entry is an output's deviation from neutral.
    input: usize,
    /// `w`, or `alpha`.
    weight: f64,
    /// Delta gain, delta delay \[s\] or neutral value.
    delta: f64,
    /// Coordinate of the net value if both scales are 0.
    offset: Rounded,
}

/// Lists the fitted entries, each with its two components' scales.
fn fit_entries(problem: &Problem, components: &Components) -> Vec<ScaledEntry> {
    let nodes = components.nodes();
    let mut entries = Vec::new();
    for Entry { pair, delta } in problem.fit_entries() {
        let output = nodes.outputs[pair.output];
        let input = nodes.inputs[pair.input];
        let mut offset = -output.offset;
        offset.add(input.offset);
        entries.push(ScaledEntry {
            output: output.component,
            input: input.component,
            weight: 1.0,
            delta,
            offset,
        });
    }
    entries
}

/// Lists the channels' regularised deviations from neutral, each as an entry whose other scale is
/// the ground.
fn departures(problem: &Problem, components: &Components) -> Vec<ScaledEntry> {
    let ground = components.count();
    let delta = problem.quantity.neutral();
    let nodes = components.nodes();
    let mut entries = Vec::new();
    for output in nodes.outputs {
        entries.push(ScaledEntry {
            output: output.component,
            input: ground,
            weight: problem.alpha,
            delta,
            offset: -output.offset,
        });
    }
    if problem.quantity.regularises_inputs() {
        for input in nodes.inputs {
            entries.push(ScaledEntry {
                output: ground,
                input: input.component,
                weight: problem.alpha,
                delta,
                offset: input.offset,
            });
        }
    }
    entries
}

/// Converts the deltas to coordinates, which are the targets, and multiplies the weights by
/// `factor`: the unit of a squared residual per squared coordinate.
fn in_coordinate(entries: &[ScaledEntry], coordinate: Coordinate, factor: f64) -> Vec<SquareEntry> {
    entries
        .iter()
        .map(|entry| SquareEntry {
            output: entry.output,
            input: entry.input,
            weight: factor * entry.weight,
            target: coordinate.transform(entry.delta),
            offset: entry.offset,
        })
        .collect()
}

/// Combines entries compared as ratios into one term for each pair of scales that share an entry, a
/// function of `u = s_to - s_from` with `from < to`. Its `forward` part contains the entries whose
/// input is in component `to`, its `backward` part those whose input is in `from`.
fn ratio_terms(entries: &[ScaledEntry], scales: usize) -> TermSum {
    // The entries with these output and input scales are at `output * scales + input`.
    let mut groups: Vec<Vec<ProductEntry>> = vec![Vec::new(); scales * scales];
    let mut constant = Rounded::default();
    for entry in entries {
        let product = ProductEntry::new(entry.weight, entry.delta, entry.offset);
        if entry.output == entry.input {
            // Both channels in one component: no scale changes the entry.
            constant.add(product.square());
        } else {
            groups[entry.output * scales + entry.input].push(product);
        }
    }
    let mut terms = Vec::new();
    for from in 0..scales {
        for to in from + 1..scales {
            let forward = CombinedEntries::new(&groups[from * scales + to]);
            let backward = CombinedEntries::new(&groups[to * scales + from]);
            constant.add(forward.least);
            constant.add(backward.least);
            if !(forward.exponential.is_zero() && backward.exponential.is_zero()) {
                terms.push(Term {
                    from,
                    to,
                    function: Function::exponential(forward.exponential, backward.exponential),
                });
            }
        }
    }
    TermSum { terms, constant }
}

/// Returns the objective's rounding level, in the problem's coordinate.
///
/// It is 1e-9 times the summed squares of the fitted deltas, plus `1e-20 alpha` per output, and
/// never zero.
pub(crate) fn rounding_floor(problem: &Problem) -> f64 {
    let coordinate = problem.coordinate();
    let delta_squares: f64 = problem
        .fit_entries()
        .map(|entry| delta_square(problem.quantity, coordinate, entry.delta))
        .sum();
    let departure_squares = SQUARED_ROUNDING * problem.alpha * problem.delta.outputs() as f64;
    (RELATIVE_ROUNDING * delta_squares + departure_squares).max(f64::MIN_POSITIVE)
}

/// Returns the square of an entry's delta, in the unit of its squared residual. In dB a squared
/// neper is added, so that a delta gain of 1, which is 0 dB, has a rounding level too.
fn delta_square(quantity: Quantity, coordinate: Coordinate, delta: f64) -> f64 {
    match quantity {
        Quantity::Gain(GainObjective::Ratio) => delta * delta,
        Quantity::Gain(GainObjective::Decibel) => SQUARED_DECIBEL * (delta.ln().powi(2) + 1.0),
        Quantity::Delay | Quantity::SignedDelay => coordinate.transform(delta).powi(2),
    }
}
