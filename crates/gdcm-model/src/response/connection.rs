//! Structural connection from inputs to outputs.

use nalgebra::DMatrix;

use crate::dataset::{Pair, PairTable, StateSpace};

/// Returns for each response whether a chain of nonzero entries leads from the input through `B`,
/// any number of times through `A`, and `C` (or directly through `D`) to the output.
///
/// Without such a chain the response is zero at every frequency (a structural zero). Its computed
/// values are rounding errors, and their ratios are meaningless (M6). A numerically zero response
/// (M6a), by contrast, has a chain, but is negligible.
pub fn connected(model: &StateSpace) -> PairTable<bool> {
    // `reached[input][state]`.
    let reached: Vec<Vec<bool>> = (0..model.inputs())
        .map(|input| reached_states(model, input))
        .collect();
    PairTable::from_fn(model.outputs(), model.inputs(), |pair| {
        model.d()[(pair.output, pair.input)] != 0.0
            || output_sees(model, pair.output, &reached[pair.input])
    })
}

/// Returns whether an output has a nonzero entry in `C` for any marked state.
fn output_sees(model: &StateSpace, output: usize, marked: &[bool]) -> bool {
    model
        .c()
        .row(output)
        .iter()
        .zip(marked)
        .any(|(c, marked)| *marked && *c != 0.0)
}

/// Returns the states on a chain of nonzero entries from a response's input to its output.
pub(super) fn connecting_states(model: &StateSpace, pair: Pair) -> Vec<usize> {
    let reached = reached_states(model, pair.input);
    let c = model.c().row(pair.output);
    let seen = spread(
        &model.a().transpose(),
        c.iter().map(|c| *c != 0.0).collect(),
    );
    (0..model.order())
        .filter(|&state| reached[state] && seen[state])
        .collect()
}

/// Marks the states that an input reaches through `B` and `A`.
fn reached_states(model: &StateSpace, input: usize) -> Vec<bool> {
    let b = model.b().column(input);
    spread(model.a(), b.iter().map(|b| *b != 0.0).collect())
}

/// Marks all states that can be reached from the marked states through the columns of `a`: a
/// nonzero entry (i, j) leads from state j to state i.
fn spread(a: &DMatrix<f64>, mut reached: Vec<bool>) -> Vec<bool> {
    let mut open: Vec<usize> = (0..reached.len()).filter(|&state| reached[state]).collect();
    let mut unreached = reached.len() - open.len();
    while let Some(from) = open.pop() {
        if unreached == 0 {
            break;
        }
        for (to, a) in a.column(from).iter().enumerate() {
            if *a != 0.0 && !reached[to] {
                reached[to] = true;
                unreached -= 1;
                open.push(to);
            }
        }
    }
    reached
}

#[cfg(test)]
mod tests {
    use nalgebra::dmatrix;

    use super::*;

    #[test]
    fn separate_lags_are_not_connected() {
        let a = dmatrix![-1.0, 0.0; 0.0, -2.0];
        let b = dmatrix![1.0, 0.0; 0.0, 1.0];
        let c = dmatrix![1.0, 0.0; 0.0, 1.0];
        let model = StateSpace::new(a, b, c, dmatrix![0.0, 0.0; 0.0, 0.0]).unwrap();
        let table = connected(&model);
        assert_eq!(
            table.marked().collect::<Vec<_>>(),
            [Pair::new(0, 0), Pair::new(1, 1)]
        );
    }

    #[test]
    fn a_chain_of_states_or_the_feed_through_connects() {
        let a = dmatrix![-1.0, 0.0; 3.0, -2.0];
        let b = dmatrix![1.0, 0.0; 0.0, 0.0];
        let c = dmatrix![0.0, 1.0];
        let model = StateSpace::new(a, b, c, dmatrix![0.0, 5.0]).unwrap();
        assert_eq!(connected(&model).marked().count(), 2);
    }
}
