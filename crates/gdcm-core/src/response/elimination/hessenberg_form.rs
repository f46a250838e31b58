//! A state-space model in the coordinates in which one frequency costs O(n^2).

use nalgebra::DMatrix;
use pulp::Arch;

use super::{HouseholderReduction, Subdiagonal, balance};
use crate::dataset::{Pair, StateSpace};

/// Least `alpha`, 2^-450 rad/s: the poles of a slower model are all in zero, as seen from any frequency in use.
const LEAST_ALPHA: f64 = f64::from_bits((1023 - 450) << 52);

/// The system matrix of a model, ready for elimination of its states.
///
/// ```text
/// [ G - (s / alpha) I   K  ]
/// [ L                   D' ]     H(s)' = D' - L (G - (s / alpha) I)^-1 K
/// ```
///
/// G of n x n is zero below its first subdiagonal; the first row of L, which has one for each input, is zero but for its
/// last entry; K has a column for each output. All come from the model (A, B, C, D) in these steps: balancing (a diagonal
/// similarity) makes the units of the states irrelevant; alpha and another power of two bring the largest entries of A and
/// B to order 1; Householder reflections make A Hessenberg and the first column of B a multiple of the first unit vector; then the
/// system matrix is transposed, and the order of the states reversed, which makes it so again.
///
/// The work at each frequency grows with the rows of L. A model with fewer outputs than inputs is therefore held as its
/// dual `(A', C', B', D')`, whose response is the transpose and whose inputs are the outputs of the model.
#[derive(Clone, Debug)]
pub struct HessenbergForm {
    /// Number of states, `n`.
    pub order: usize,
    /// Rows of L: inputs of the model, or of its dual.
    pub inputs: usize,
    /// Columns of K: outputs of the model, or of its dual.
    pub outputs: usize,
    /// Whether this is the dual: rows of L then belong to outputs and columns of K to inputs.
    pub dual: bool,
    /// The input that is the first row of L, the one of the largest column of B; the first is in its place.
    first_input: usize,
    /// `1 / alpha`.
    pub frequency_scale: f64,
    /// The one entry of the first row of L.
    pub gain: f64,
    /// The entry below the diagonal of each column of G but the last.
    pub subdiagonals: Vec<Subdiagonal>,
    /// The first row of `[G K]` and all rows of `[L D']` but the first.
    pub complex_rows: Vec<f64>,
    /// The other rows of `[G K]`, each divided by its subdiagonal entry.
    next_rows: Vec<f64>,
    /// The first row of D'.
    pub feed_through: Vec<f64>,
}

impl HessenbergForm {
    /// The reduced form of a model with `a` in place of its A: the same bits on every instruction set, on which only the
    /// time depends.
    pub fn of(arch: Arch, a: DMatrix<f64>, model: &StateSpace) -> Self {
        let dual = model.outputs() < model.inputs();
        let mut a = if dual { a.transpose() } else { a };
        let [mut b, mut c, mut d] = if dual {
            [model.c(), model.b(), model.d()].map(DMatrix::transpose)
        } else {
            [model.b(), model.c(), model.d()].map(DMatrix::clone)
        };
        balance(&mut a, &mut b, &mut c);
        let frequency_scale = 1.0 / power_of_two_below(a.amax()).max(LEAST_ALPHA);
        let first_input = (0..b.ncols()).rev().max_by(|&x, &y| b.column(x).amax().total_cmp(&b.column(y).amax()));
        let first_input = first_input.unwrap_or(0);
        let input_scale = 1.0 / power_of_two_below(b.amax());
        a *= frequency_scale;
        b *= input_scale;
        // One after the other, the larger first: what both leave in range must not underflow between them.
        let (one, other) = (frequency_scale, 1.0 / input_scale);
        c *= one.max(other);
        c *= one.min(other);
        if first_input > 0 {
            b.swap_columns(0, first_input);
            d.swap_columns(0, first_input);
        }
        let (order, inputs, outputs) = (a.nrows(), b.ncols(), c.nrows());
        let mut rows = DMatrix::zeros(order + inputs, order + outputs);
        for (matrix, row, column) in [(a, 0, 0), (b, 0, order), (c, order, 0), (d, order, order)] {
            rows.view_mut((column, row), (matrix.ncols(), matrix.nrows())).tr_copy_from(&matrix);
        }
        arch.dispatch(HouseholderReduction { rows: &mut rows, states: order });
        // An entry of the system matrix: the transpose, with the states in reversed order.
        let reversed = |state: usize| if state < order { order - 1 - state } else { state };
        let entry = |row: usize, column: usize| rows[(reversed(row), reversed(column))];
        let subdiagonals: Vec<_> = (1..order).map(|row| Subdiagonal::new(entry(row, row - 1), order)).collect();
        let width = order + outputs;
        let row_of = |row: usize, factor: f64| (0..width).map(move |column| factor * entry(row, column));
        let next_rows = (1..order).flat_map(|row| row_of(row, subdiagonals[row - 1].reciprocal)).collect();
        let active = if order > 0 { row_of(0, 1.0).collect() } else { vec![0.0; width] };
        let others = (order + 1..order + inputs).flat_map(|row| row_of(row, 1.0));
        Self {
            gain: if order > 0 && inputs > 0 { entry(order, order - 1) } else { 0.0 },
            complex_rows: active.into_iter().chain(others).collect(),
            feed_through: if inputs > 0 { row_of(order, 1.0).skip(order).collect() } else { vec![0.0; outputs] },
            next_rows,
            subdiagonals,
            order,
            inputs,
            outputs,
            dual,
            first_input,
            frequency_scale,
        }
    }

    /// The model's response of a row of L and a column of K.
    pub fn pair(&self, input: usize, output: usize) -> Pair {
        let input = if input == 0 {
            self.first_input
        } else if input == self.first_input {
            0
        } else {
            input
        };
        if self.dual { Pair::new(input, output) } else { Pair::new(output, input) }
    }

    /// Entries in a row of `[G K]`.
    pub fn width(&self) -> usize {
        self.order + self.outputs
    }

    /// The row that has a one below the diagonal in this column, from the next column on.
    #[inline(always)]
    pub fn next_row(&self, column: usize) -> &[f64] {
        &self.next_rows[column * self.width()..][column + 1..self.width()]
    }
}

/// The largest power of two that does not exceed `value`, within 2^-1000 ... 2^1000; 1 for zero.
fn power_of_two_below(value: f64) -> f64 {
    if value == 0.0 {
        return 1.0;
    }
    value.log2().floor().clamp(-1e3, 1e3).exp2()
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::dmatrix;

    fn form(model: &StateSpace) -> HessenbergForm {
        HessenbergForm::of(Arch::new(), model.a().clone(), model)
    }

    #[test]
    fn the_scale_is_a_power_of_two_that_brings_the_largest_entry_between_one_and_two() {
        assert_eq!([0.0, 1.0, 1.999, 40.0, 0.3].map(power_of_two_below), [1.0, 1.0, 1.0, 32.0, 0.25]);
    }

    #[test]
    fn the_inputs_or_outputs_whichever_are_fewer_are_solved_for() {
        let model = |p, m| {
            let (a, b, c) = (dmatrix![-1.0], DMatrix::zeros(1, m), DMatrix::zeros(p, 1));
            form(&StateSpace::new(a, b, c, DMatrix::zeros(p, m)).unwrap())
        };
        assert_eq!((model(6, 4).inputs, model(6, 4).dual), (4, false));
        assert_eq!((model(1, 3).inputs, model(1, 3).dual), (1, true));
    }

    #[test]
    fn a_model_of_one_state_and_no_reduction_is_its_own_system_matrix() {
        let model =
            StateSpace::new(dmatrix![-1.5], dmatrix![1.0, 1.5], dmatrix![4.0; 5.0], dmatrix![0.1, 0.2; 0.3, 0.4]);
        let form = form(&model.unwrap());
        // The second input has the larger column of B.
        assert_eq!((form.gain, form.pair(0, 1), form.pair(1, 0)), (1.5, Pair::new(1, 1), Pair::new(0, 0)));
        assert_eq!(form.complex_rows, [-1.5, 4.0, 5.0, 1.0, 0.1, 0.3]);
        assert_eq!(form.feed_through, [0.2, 0.4]);
    }

    #[test]
    fn next_rows_have_a_one_below_the_diagonal_and_the_first_input_reaches_one_state() {
        let a = dmatrix![1.0, 1.25, 0.5; 1.5, 1.75, -1.0; 0.25, 0.5, -0.75];
        let model = StateSpace::new(a, dmatrix![2.0; 3.0; 1.0], dmatrix![1.0, 1.0, 2.0], dmatrix![0.0]);
        let form = form(&model.unwrap());
        let next: Vec<&[f64]> = form.next_rows.chunks_exact(4).collect();
        // A handful of roundings; there are two next rows.
        assert!(next.len() == 2 && (next[0][0] - 1.0).abs() < 1e-15 && (next[1][1] - 1.0).abs() < 1e-15);
        assert_eq!(next[1][0], 0.0);
        assert_eq!(form.next_row(1), &next[1][2..]);
        // |B| = sqrt(14), which a reflection keeps, over the power of two below 3.
        assert!((form.gain.abs() - 14.0_f64.sqrt() / 2.0).abs() < 1e-14);
    }
}
