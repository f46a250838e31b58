//! Which outputs an input can reach at all.

use crate::dataset::{PairTable, StateSpace};

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

fn reached_states(model: &StateSpace, input: usize) -> Vec<bool> {
    let mut reached: Vec<bool> = model.b().column(input).iter().map(|b| *b != 0.0).collect();
    let mut open: Vec<usize> = (0..reached.len()).filter(|&state| reached[state]).collect();
    let mut left = reached.len() - open.len();
    while let Some(from) = open.pop() {
        if left == 0 {
            break;
        }
        for (to, a) in model.a().column(from).iter().enumerate() {
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
    use crate::dataset::Pair;
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
