//! The objective as a function of the scales that the held entries leave free.

use super::branch_and_bound::{
    Function, Group, Objective, Rounded, SquareEntry, Term, fixed_square, product, quadratic_terms,
};
use super::components::Components;
use super::problem::Problem;
use super::quantity::{GainObjective, Quantity, SQUARED_DECIBEL};

/// The objective of `problem` over the scales of `components`, in the problem's coordinate.
pub(crate) fn objective(problem: &Problem, components: &Components) -> Objective {
    let ground = components.count();
    let (quantity, coordinate) = (problem.quantity, problem.coordinate());
    let fit = problem.fit_entries().map(|(pair, delta)| {
        let (output, input) = (components.outputs[pair.output], components.inputs[pair.input]);
        let mut offset = output.offset;
        offset.add(input.offset);
        SquareEntry { output: output.component, input: input.component, weight: 1.0, delta, offset }
    });
    let departure = components.outputs.iter().filter(|_| problem.alpha > 0.0).map(|output| SquareEntry {
        output: output.component,
        input: ground,
        weight: problem.alpha,
        delta: quantity.neutral(),
        offset: output.offset,
    });
    let regularised = problem.alpha > 0.0 && quantity.regularises_inputs();
    let departure_of_inputs = components.inputs.iter().filter(|_| regularised).map(|input| SquareEntry {
        output: ground,
        input: input.component,
        weight: problem.alpha,
        delta: quantity.neutral(),
        offset: input.offset,
    });
    let entries: Vec<SquareEntry> = fit.chain(departure).chain(departure_of_inputs).collect();
    let in_coordinate = |factor: f64| -> Vec<SquareEntry> {
        let square = |entry: &SquareEntry| SquareEntry {
            weight: factor * entry.weight,
            delta: coordinate.of(entry.delta),
            ..*entry
        };
        entries.iter().map(square).collect()
    };
    let (terms, constant) = match quantity {
        Quantity::Gain(GainObjective::Ratio) => ratio_terms(&entries, ground + 1),
        Quantity::Gain(GainObjective::Decibel) => quadratic_terms(&in_coordinate(SQUARED_DECIBEL), ground + 1),
        Quantity::Delay | Quantity::SignedDelay => quadratic_terms(&in_coordinate(1.0), ground + 1),
    };
    let (mut lower, mut upper) = (components.lower.clone(), components.upper.clone());
    lower.push(0.0);
    upper.push(0.0);
    Objective { lower, upper, terms, constant }
}

/// One term for each two scales that share an entry: `forward` holds the entries whose input has the greater index.
fn ratio_terms(entries: &[SquareEntry], scales: usize) -> (Vec<Term>, Rounded) {
    let mut groups: Vec<Group> = vec![Group::default(); scales * scales];
    let mut constant = Rounded::default();
    for SquareEntry { output, input, weight, delta, offset } in entries {
        if output == input {
            constant.add(fixed_square(*weight, *delta, product(offset.value, offset.error)));
        } else {
            groups[output * scales + input].add(*weight, *delta, offset.value, offset.error);
        }
    }
    let mut terms = Vec::new();
    for from in 0..scales {
        for to in from + 1..scales {
            let (forward, ahead) = groups[from * scales + to].exponential();
            let (backward, behind) = groups[to * scales + from].exponential();
            constant.add(ahead);
            constant.add(behind);
            if !(forward.is_zero() && backward.is_zero()) {
                terms.push(Term { from, to, function: Function::exponential(forward, backward) });
            }
        }
    }
    (terms, constant)
}

/// The objective below which rounding decides, not the search, in the problem's coordinate: a billionth of the objective without
/// any correction (the rounding of a sum of squares grows with the root of what the squares are taken of), and for the outputs,
/// known to their rounding, its square.
pub(crate) fn floor(problem: &Problem) -> f64 {
    let coordinate = problem.coordinate();
    let square = |delta: f64| match problem.quantity {
        Quantity::Gain(GainObjective::Ratio) => delta * delta,
        Quantity::Gain(GainObjective::Decibel) => SQUARED_DECIBEL * (delta.ln().powi(2) + 1.0),
        Quantity::Delay | Quantity::SignedDelay => coordinate.of(delta).powi(2),
    };
    let energy: f64 = problem.fit_entries().map(|(_, delta)| square(delta)).sum();
    (1e-9 * energy + 1e-20 * problem.alpha * problem.delta.outputs() as f64).max(f64::MIN_POSITIVE)
}
