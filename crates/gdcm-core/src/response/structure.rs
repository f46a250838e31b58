//! Which outputs an input can reach at all.

use nalgebra::DMatrix;

use crate::dataset::{Pair, PairTable, StateSpace};

/// Whether each response of a model is more than a structural zero: whether a chain of entries that are not zero leads from
/// the input through `B`, any number of times through `A`, and `C` (or at once through `D`) to the output.
///
/// Where it is not, the response is zero whatever the frequency. Computed responses would be rounding errors there, of which no
/// ratio could be taken (M6).
pub fn connected(model: &StateSpace) -> PairTable<bool> {
    let reached: Vec<Vec<bool>> = (0..model.inputs()).map(|input| reached_states(model, input)).collect();
    PairTable::from_fn(model.outputs(), model.inputs(), |pair| {
        let through_states = || {
            let row = model.c().row(pair.output);
            row.iter().zip(&reached[pair.input]).any(|(c, reached)| *reached && *c != 0.0)
        };
        model.d()[(pair.output, pair.input)] != 0.0 || through_states()
    })
}

/// The states that lie on a chain of entries from the input of a response to its output.
pub(super) fn leading_states(model: &StateSpace, pair: Pair) -> Vec<usize> {
    let reached = reached_states(model, pair.input);
    let seen = spread(&model.a().transpose(), model.c().row(pair.output).iter().map(|c| *c != 0.0).collect());
    (0..model.order()).filter(|&state| reached[state] && seen[state]).collect()
}

fn reached_states(model: &StateSpace, input: usize) -> Vec<bool> {
    spread(model.a(), model.b().column(input).iter().map(|b| *b != 0.0).collect())
}

/// The marked states, and those that the columns of `a` lead to from them.
fn spread(a: &DMatrix<f64>, mut reached: Vec<bool>) -> Vec<bool> {
    let mut open: Vec<usize> = (0..reached.len()).filter(|&state| reached[state]).collect();
    let mut left = reached.len() - open.len();
    while let Some(from) = open.pop() {
        if left == 0 {
            break;
        }
        for (to, a) in a.column(from).iter().enumerate() {
            if *a != 0.0 && !reached[to] {
                reached[to] = true;
                left -= 1;
                open.push(to);
            }
        }
    }
    reached
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::dmatrix;

    #[test]
    fn two_separate_lags_do_not_answer_to_each_other() {
        let (a, b, c) = (dmatrix![-1.0, 0.0; 0.0, -2.0], dmatrix![1.0, 0.0; 0.0, 1.0], dmatrix![1.0, 0.0; 0.0, 1.0]);
        let model = StateSpace::new(a, b, c, dmatrix![0.0, 0.0; 0.0, 0.0]).unwrap();
        let table = connected(&model);
        assert_eq!(table.marked().collect::<Vec<_>>(), [Pair::new(0, 0), Pair::new(1, 1)]);
    }

    #[test]
    fn a_chain_of_states_or_the_feed_through_connects() {
        let (a, b, c) = (dmatrix![-1.0, 0.0; 3.0, -2.0], dmatrix![1.0, 0.0; 0.0, 0.0], dmatrix![0.0, 1.0]);
        let model = StateSpace::new(a, b, c, dmatrix![0.0, 5.0]).unwrap();
        assert_eq!(connected(&model).marked().count(), 2);
    }
}
