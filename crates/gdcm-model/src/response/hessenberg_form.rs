//! A state-space model transformed so that each frequency costs O(n^2) operations, for n states:
//! balanced (`balancing.rs`), and reduced to upper Hessenberg form (`householder_reduction.rs`).

use nalgebra::DMatrix;
use pulp::Arch;

use super::balancing::balance;
use super::householder_reduction::HouseholderReduction;
use super::pivot_threshold::Subdiagonal;
use crate::dataset::{Pair, StateSpace};

/// Minimum `alpha`, 2^-450 rad/s: a slower model's poles are effectively zero at any frequency in
/// use.
const LEAST_ALPHA: f64 = f64::from_bits((1023 - 450) << 52);

/// A model's system matrix, prepared for state elimination. ^T denotes the transpose.
///
/// ```text
/// [ G - (s / alpha) I   K   ]
/// [ L                   D^T ]     H(s)^T = D^T - L (G - (s / alpha) I)^-1 K
/// ```
///
/// G (n x n) is zero below its first subdiagonal; L has a row per input, and its first row is zero
/// except for its last entry `l`; K has a column per output. Steps from the model `(A, B, C, D)`,
/// with `H(s) = C (s I - A)^-1 B + D`:
///
/// 1. Balance A by a diagonal similarity, which makes the result independent of state units.
/// 2. Divide A by alpha and B by another power of two, so that their largest entries are near 1;
///    scale C to preserve the response; swap the input with the largest column in B to the front.
/// 3. Householder reflections make A Hessenberg and the first column in B a multiple of the first
///    unit vector.
/// 4. Transpose the system matrix and reverse the states, which restores the Hessenberg form: A^T
///    becomes G, B^T becomes L, C^T becomes K.
///
/// The cost per frequency grows with L's row count. A model with fewer outputs than inputs is
/// therefore stored as its dual `(A^T, C^T, B^T, D^T)`, whose response is the transpose and whose
/// inputs are the model's outputs.
#[derive(Clone, Debug)]
pub(super) struct HessenbergForm {
    /// State count `n`.
    pub order: usize,
    /// Row count of L: inputs (of the dual if `dual`).
    pub inputs: usize,
    /// Column count of K: outputs (of the dual if `dual`).
    pub outputs: usize,
    /// Whether this is the dual: L then has a row per output, K a column per input.
    dual: bool,
    /// Index of the input that was swapped with the first input, because its column in B is the
    /// largest.
    first_input: usize,
    /// `1 / alpha`.
    pub frequency_scale: f64,
    /// `l`, the last entry in the first row of L; the others are zero.
    pub first_l_entry: f64,
    /// G's subdiagonal entries, one for each column except the last.
    pub subdiagonals: Vec<Subdiagonal>,
    /// Initial values of the rows that become complex during elimination: the first row of
    /// `[G K]`, then all rows of `[L D^T]` except the first.
    pub initial_rows: Vec<f64>,
    /// All rows of `[G K]` except the first, each divided by its subdiagonal entry unless this is
    /// negligible.
    next_rows: Vec<f64>,
    /// First row of `D^T`.
    pub feed_through: Vec<f64>,
}

impl HessenbergForm {
    /// Computes the reduced form for a model whose A is replaced by `a`. `arch` affects only the
    /// computing time: the result is the same bit for bit on every instruction set.
    pub fn new(arch: Arch, a: DMatrix<f64>, model: &StateSpace) -> Self {
        // Steps 1 and 2.
        let mut system = ScaledSystem::new(a, model);
        let first_input = system.swap_largest_input_first();
        let order = system.a.nrows();
        let inputs = system.b.ncols();
        let outputs = system.c.nrows();
        let dual = system.dual;
        let frequency_scale = system.frequency_scale;
        // Step 3.
        let mut rows = system.into_rows();
        arch.dispatch(HouseholderReduction {
            rows: &mut rows,
            states: order,
        });
        // Step 4.
        let reduced = ReversedSystem {
            rows,
            order,
            inputs,
            outputs,
        };
        let mut subdiagonals = Vec::new();
        let mut next_rows = Vec::new();
        for row in 1..order {
            let subdiagonal = Subdiagonal::new(reduced.entry(row, row - 1), order);
            next_rows.extend(reduced.scaled_row(row, subdiagonal.reciprocal));
            subdiagonals.push(subdiagonal);
        }
        Self {
            order,
            inputs,
            outputs,
            dual,
            first_input,
            frequency_scale,
            first_l_entry: reduced.first_l_entry(),
            subdiagonals,
            initial_rows: reduced.initial_rows(),
            next_rows,
            feed_through: reduced.feed_through(),
        }
    }

    /// Returns the model's own output count and input count, also for a dual.
    pub fn model_shape(&self) -> [usize; 2] {
        if self.dual {
            [self.inputs, self.outputs]
        } else {
            [self.outputs, self.inputs]
        }
    }

    /// Returns the model's response that corresponds to row `input` in L and column `output` in K.
    pub fn pair(&self, input: usize, output: usize) -> Pair {
        let input = if input == 0 {
            self.first_input
        } else if input == self.first_input {
            0
        } else {
            input
        };
        if self.dual {
            Pair::new(input, output)
        } else {
            Pair::new(output, input)
        }
    }

    /// Returns the entry count in a row of `[G K]`.
    pub fn width(&self) -> usize {
        self.order + self.outputs
    }

    /// Returns row `column + 1` of `[G K]`, counted from 0, from the diagonal on, divided by its
    /// subdiagonal entry, which lies in `column`, unless that is negligible.
    #[inline(always)]
    pub fn next_row(&self, column: usize) -> &[f64] {
        &self.next_rows[column * self.width()..][column + 1..self.width()]
    }
}

/// A model or its dual, balanced, with the largest entries in A and B between 1 and 2 (steps 1 and
/// 2).
struct ScaledSystem {
    a: DMatrix<f64>,
    b: DMatrix<f64>,
    c: DMatrix<f64>,
    d: DMatrix<f64>,
    dual: bool,
    /// `1 / alpha`.
    frequency_scale: f64,
}

impl ScaledSystem {
    fn new(a: DMatrix<f64>, model: &StateSpace) -> Self {
        let dual = model.outputs() < model.inputs();
        let mut a = if dual { a.transpose() } else { a };
        let [mut b, mut c, d] = if dual {
            [model.c(), model.b(), model.d()].map(DMatrix::transpose)
        } else {
            [model.b(), model.c(), model.d()].map(DMatrix::clone)
        };
        balance(&mut a, &mut b, &mut c);
        let frequency_scale = 1.0 / power_of_two_below(a.amax()).max(LEAST_ALPHA);
        let input_scale = 1.0 / power_of_two_below(b.amax());
        a *= frequency_scale;
        b *= input_scale;
        // Multiply by the larger factor first, so that no intermediate result underflows.
        let output_scale = 1.0 / input_scale;
        c *= frequency_scale.max(output_scale);
        c *= frequency_scale.min(output_scale);
        Self {
            a,
            b,
            c,
            d,
            dual,
            frequency_scale,
        }
    }

    /// Swaps the first input with the input that has the largest column in B, and returns the
    /// latter's index.
    fn swap_largest_input_first(&mut self) -> usize {
        let mut largest = 0;
        for input in 1..self.b.ncols() {
            let is_larger = self
                .b
                .column(input)
                .amax()
                .total_cmp(&self.b.column(largest).amax())
                .is_gt();
            if is_larger {
                largest = input;
            }
        }
        if largest > 0 {
            self.b.swap_columns(0, largest);
            self.d.swap_columns(0, largest);
        }
        largest
    }

    /// Returns the matrix `[A B; C D]`, transposed so that each row is contiguous in memory.
    fn into_rows(self) -> DMatrix<f64> {
        let order = self.a.nrows();
        let inputs = self.b.ncols();
        let outputs = self.c.nrows();
        let mut rows = DMatrix::zeros(order + inputs, order + outputs);
        // Each matrix with its first row and column in `[A B; C D]`.
        for (matrix, row, column) in [
            (self.a, 0, 0),
            (self.b, 0, order),
            (self.c, order, 0),
            (self.d, order, order),
        ] {
            rows.view_mut((column, row), (matrix.ncols(), matrix.nrows()))
                .tr_copy_from(&matrix);
        }
        rows
    }
}

/// The reduced system matrix `[G K; L D^T]`: transposed, with the states in reversed order.
struct ReversedSystem {
    /// The matrix before transposition and reversal, with each row stored as a column: the
    /// transposed matrix therefore already has the same index order.
    rows: DMatrix<f64>,
    order: usize,
    inputs: usize,
    outputs: usize,
}

impl ReversedSystem {
    fn entry(&self, row: usize, column: usize) -> f64 {
        self.rows[(self.reversed(row), self.reversed(column))]
    }

    /// Returns the index before the states are reversed; inputs and outputs follow the states in
    /// the original order.
    fn reversed(&self, index: usize) -> usize {
        if index < self.order {
            self.order - 1 - index
        } else {
            index
        }
    }

    /// Returns a row of `[G K; L D^T]`, multiplied by a factor.
    fn scaled_row(&self, row: usize, factor: f64) -> impl Iterator<Item = f64> {
        (0..self.order + self.outputs).map(move |column| factor * self.entry(row, column))
    }

    /// Returns the first row of `[G K]`, zero without states, then all rows of `[L D^T]` except the
    /// first.
    fn initial_rows(&self) -> Vec<f64> {
        let mut rows = Vec::new();
        if self.order > 0 {
            rows.extend(self.scaled_row(0, 1.0));
        } else {
            rows.resize(self.outputs, 0.0);
        }
        for row in self.order + 1..self.order + self.inputs {
            rows.extend(self.scaled_row(row, 1.0));
        }
        rows
    }

    /// Returns `l`, the last entry in the first row of L; zero without states or inputs.
    fn first_l_entry(&self) -> f64 {
        if self.order > 0 && self.inputs > 0 {
            self.entry(self.order, self.order - 1)
        } else {
            0.0
        }
    }

    /// Returns the first row of `D^T`; zero without inputs.
    fn feed_through(&self) -> Vec<f64> {
        if self.inputs > 0 {
            self.scaled_row(self.order, 1.0).skip(self.order).collect()
        } else {
            vec![0.0; self.outputs]
        }
    }
}

/// Returns the largest power of two that does not exceed `value`, within 2^-1000 ... 2^1000; 1 for
/// zero.
fn power_of_two_below(value: f64) -> f64 {
    if value == 0.0 {
        return 1.0;
    }
    value.log2().floor().clamp(-1e3, 1e3).exp2()
}

#[cfg(test)]
mod tests {
    use nalgebra::dmatrix;

    use super::*;

    fn form(model: &StateSpace) -> HessenbergForm {
        HessenbergForm::new(Arch::new(), model.a().clone(), model)
    }

    #[test]
    fn the_scale_is_a_power_of_two_that_brings_the_largest_entry_between_one_and_two() {
        assert_eq!(
            [0.0, 1.0, 1.999, 40.0, 0.3].map(power_of_two_below),
            [1.0, 1.0, 1.0, 32.0, 0.25]
        );
    }

    #[test]
    fn the_inputs_or_outputs_whichever_are_fewer_are_solved_for() {
        let model = |p, m| {
            let a = dmatrix![-1.0];
            let b = DMatrix::zeros(1, m);
            let c = DMatrix::zeros(p, 1);
            form(&StateSpace::new(a, b, c, DMatrix::zeros(p, m)).unwrap())
        };
        assert_eq!((model(6, 4).inputs, model(6, 4).dual), (4, false));
        assert_eq!((model(1, 3).inputs, model(1, 3).dual), (1, true));
    }

    #[test]
    fn a_model_of_one_state_and_no_reduction_is_its_own_system_matrix() {
        let model = StateSpace::new(
            dmatrix![-1.5],
            dmatrix![1.0, 1.5],
            dmatrix![4.0; 5.0],
            dmatrix![0.1, 0.2; 0.3, 0.4],
        );
        let form = form(&model.unwrap());
        // `first_input`: the second input has the larger column in B.
        assert_eq!(
            (form.first_l_entry, form.pair(0, 1), form.pair(1, 0)),
            (1.5, Pair::new(1, 1), Pair::new(0, 0))
        );
        assert_eq!(form.initial_rows, [-1.5, 4.0, 5.0, 1.0, 0.1, 0.3]);
        assert_eq!(form.feed_through, [0.2, 0.4]);
    }

    #[test]
    fn next_rows_have_a_one_below_the_diagonal_and_the_first_input_reaches_one_state() {
        let a = dmatrix![1.0, 1.25, 0.5; 1.5, 1.75, -1.0; 0.25, 0.5, -0.75];
        let model = StateSpace::new(
            a,
            dmatrix![2.0; 3.0; 1.0],
            dmatrix![1.0, 1.0, 2.0],
            dmatrix![0.0],
        );
        let form = form(&model.unwrap());
        let next: Vec<&[f64]> = form.next_rows.chunks_exact(4).collect();
        // Tolerance: rounding errors of a few operations. There are two next rows.
        assert!(
            next.len() == 2 && (next[0][0] - 1.0).abs() < 1e-15 && (next[1][1] - 1.0).abs() < 1e-15
        );
        assert_eq!(next[1][0], 0.0);
        assert_eq!(form.next_row(1), &next[1][2..]);
        // A reflection preserves |B| = sqrt(14); the scaling divides it by 2, the power of two
        // below 3.
        assert!((form.first_l_entry.abs() - 14.0_f64.sqrt() / 2.0).abs() < 1e-14);
    }
}
