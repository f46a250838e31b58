//! A state-space model in the coordinates in which one frequency costs O(n^2).

use nalgebra::DMatrix;
use pulp::Arch;

use super::{BLOCK, HouseholderReduction, Subdiagonal, SystemTable, balance};
use crate::dataset::{Pair, StateSpace};

/// Columns that elimination computes at once.
pub const PANEL: usize = 3;

/// Neighbouring entries of a row.
pub type Entries = [f64; PANEL];

/// Least `alpha`, 2^-450 rad/s: the poles of a slower model are all in zero, as seen from any frequency in use.
const LEAST_ALPHA: f64 = f64::from_bits((1023 - 450) << 52);

/// Rows of zeros after those of a model, for tiles of up to four rows.
const PADDING: usize = 3;

/// The system matrix of a model, ready for elimination of its states.
///
/// ```text
/// [ G - j (omega / alpha) I   K  ]
/// [ L                         D' ]     H(j omega)' = D' - L (G - j (omega / alpha) I)^-1 K
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
    order: usize,
    inputs: usize,
    outputs: usize,
    dual: bool,
    /// The input that is the first row of L, the one of the largest column of B; the first is in its place.
    first_input: usize,
    frequency_scale: f64,
    gain: f64,
    /// One for each column of G, those that make the last panel whole included.
    subdiagonals: Vec<[Subdiagonal; PANEL]>,
    /// The first row of `[G K]` and all rows of `[L D']` but the first, panel by panel of columns.
    complex_rows: Vec<Entries>,
    /// The other rows of `[G K]`, each divided by its subdiagonal entry, panel by panel of columns.
    next_rows: Vec<[Entries; PANEL]>,
    /// The first row of D', panel by panel.
    feed_through: Vec<Entries>,
}

impl HessenbergForm {
    /// The reduced form of a model: the same bits on every instruction set, on which only the time depends.
    pub fn of(arch: Arch, model: &StateSpace) -> Self {
        let dual = model.outputs() < model.inputs();
        let matrices = [model.a(), model.b(), model.c(), model.d()];
        let [mut a, mut b, mut c, mut d] = if dual {
            let [a, b, c, d] = matrices.map(DMatrix::transpose);
            [a, c, b, d]
        } else {
            matrices.map(DMatrix::clone)
        };
        balance(&mut a, &mut b, &mut c);
        let frequency_scale = 1.0 / power_of_two_below(largest_magnitude(a.as_slice())).max(LEAST_ALPHA);
        let (first_input, largest) = largest_column(&b);
        let input_scale = 1.0 / power_of_two_below(largest);
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
        let mut table = table(&a, &b, &c, &d);
        arch.dispatch(HouseholderReduction(&mut table));
        let gain = if order > 0 && inputs > 0 { table.row(0)[order] } else { 0.0 };
        let subdiagonals = subdiagonals(&table);
        let rows = RowsOfPanels::of(&table, &subdiagonals, inputs, outputs);
        let RowsOfPanels { complex_rows, next_rows, feed_through } = rows;
        Self {
            order,
            inputs,
            outputs,
            dual,
            first_input,
            frequency_scale,
            gain,
            subdiagonals,
            complex_rows,
            next_rows,
            feed_through,
        }
    }

    /// Number of states, `n`.
    #[inline(always)]
    pub fn order(&self) -> usize {
        self.order
    }

    /// Rows of L: inputs of the model, or of its dual.
    #[inline(always)]
    pub fn inputs(&self) -> usize {
        self.inputs
    }

    /// Columns of K: outputs of the model, or of its dual.
    #[inline(always)]
    pub fn outputs(&self) -> usize {
        self.outputs
    }

    /// Whether this is the dual: rows of L then belong to outputs and columns of K to inputs.
    #[inline(always)]
    pub fn is_dual(&self) -> bool {
        self.dual
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

    /// `1 / alpha`.
    #[inline(always)]
    pub fn frequency_scale(&self) -> f64 {
        self.frequency_scale
    }

    /// The one entry of the first row of L.
    #[inline(always)]
    pub fn gain(&self) -> f64 {
        self.gain
    }

    /// Panels of columns of G.
    #[inline(always)]
    pub fn state_panels(&self) -> usize {
        self.subdiagonals.len()
    }

    /// Panels of columns of K, which follow those of G.
    #[inline(always)]
    pub fn output_panels(&self) -> usize {
        self.feed_through.len()
    }

    /// The entries of G below the diagonal in the columns of a panel.
    #[inline(always)]
    pub fn subdiagonals(&self, panel: usize) -> &[Subdiagonal; PANEL] {
        &self.subdiagonals[panel]
    }

    /// A panel of `R` of the rows that become complex: the first row of `[G K]` and all of `[L D']` but the first.
    #[inline(always)]
    pub fn complex_rows<const R: usize>(&self, panel: usize, tile: usize) -> &[Entries; R] {
        let rows = self.inputs.max(1) + PADDING;
        &self.complex_rows[panel * rows + tile * R..].as_chunks().0[0]
    }

    /// A panel of the other rows of `[G K]`, each with a one below the diagonal.
    #[inline(always)]
    pub fn next_rows(&self, panel: usize) -> &[[Entries; PANEL]] {
        let blocks = self.state_panels();
        &self.next_rows[panel * blocks..][..blocks]
    }

    /// A panel of outputs of the first row of D'.
    #[inline(always)]
    pub fn feed_through(&self, output_panel: usize) -> &Entries {
        &self.feed_through[output_panel]
    }
}

/// The rows of a system matrix, panel by panel of columns.
struct RowsOfPanels {
    complex_rows: Vec<Entries>,
    next_rows: Vec<[Entries; PANEL]>,
    feed_through: Vec<Entries>,
}

impl RowsOfPanels {
    /// The rows of the transpose of a table, with its states in reversed order.
    fn of(table: &SystemTable, subdiagonals: &[[Subdiagonal; PANEL]], inputs: usize, outputs: usize) -> Self {
        let (order, blocks, zeros) = (table.states(), subdiagonals.len(), vec![0.0; table.width()]);
        let panels = blocks + outputs.div_ceil(PANEL);
        let mut rows = Self {
            complex_rows: Vec::with_capacity(panels * (inputs.max(1) + PADDING)),
            next_rows: Vec::with_capacity(panels * blocks),
            feed_through: Vec::with_capacity(panels - blocks),
        };
        for panel in 0..panels {
            let columns: [&[f64]; PANEL] = std::array::from_fn(|offset| {
                let row = match panel.checked_sub(blocks) {
                    None => order.checked_sub(panel * PANEL + offset + 1),
                    Some(panel) => {
                        Some(panel * PANEL + offset).filter(|output| *output < outputs).map(|row| order + row)
                    }
                };
                row.map_or(&zeros[..], |row| table.row(row))
            });
            rows.push(order, inputs, columns, subdiagonals);
            if panel >= blocks {
                rows.feed_through.push(columns.map(|column| if inputs > 0 { column[order] } else { 0.0 }));
            }
        }
        rows
    }

    /// Appends the rows of a panel, whose columns are rows of the table.
    fn push(&mut self, order: usize, inputs: usize, columns: [&[f64]; PANEL], subdiagonals: &[[Subdiagonal; PANEL]]) {
        let state = |state: Option<usize>| state.map_or([0.0; PANEL], |state| columns.map(|column| column[state]));
        self.complex_rows.push(state(order.checked_sub(1)));
        self.complex_rows.extend((1..inputs).map(|input| columns.map(|column| column[order + input])));
        self.complex_rows.extend([[0.0; PANEL]; PADDING]);
        for (block, subdiagonals) in subdiagonals.iter().enumerate() {
            self.next_rows.push(std::array::from_fn(|offset| {
                let next = state(order.checked_sub(block * PANEL + offset + 2));
                next.map(|entry| entry * subdiagonals[offset].reciprocal)
            }));
        }
    }
}

/// The subdiagonal entries of A from the last on.
fn subdiagonals(table: &SystemTable) -> Vec<[Subdiagonal; PANEL]> {
    let order = table.states();
    let of_column = |column: usize| match order.checked_sub(column + 1) {
        Some(row) if row > 0 => Subdiagonal::new(table.row(row)[row - 1], order),
        _ => Subdiagonal::NONE,
    };
    (0..order.div_ceil(PANEL)).map(|panel| std::array::from_fn(|offset| of_column(panel * PANEL + offset))).collect()
}

/// The column with the largest absolute value, and that; the first if all are zero.
fn largest_column(matrix: &DMatrix<f64>) -> (usize, f64) {
    let columns = matrix.as_slice().chunks_exact(matrix.nrows().max(1)).map(largest_magnitude).enumerate();
    columns.fold((0, 0.0), |largest, next| if next.1 > largest.1 { next } else { largest })
}

/// `[A B; C D]`.
fn table(a: &DMatrix<f64>, b: &DMatrix<f64>, c: &DMatrix<f64>, d: &DMatrix<f64>) -> SystemTable {
    let order = a.nrows();
    let mut table = SystemTable::zeros(order, b.ncols(), c.nrows());
    for (matrix, row, column) in [(a, 0, 0), (b, 0, order), (c, order, 0), (d, order, order)] {
        let width = table.width();
        let rows = table.numbers_mut()[row * width..].chunks_exact_mut(width);
        // Stored by columns: the transpose is, row by row, what goes into the table.
        let transpose = matrix.transpose();
        for (entries, values) in rows.zip(transpose.as_slice().chunks_exact(matrix.ncols().max(1))) {
            entries[column..column + values.len()].copy_from_slice(values);
        }
    }
    table
}

/// The largest absolute value. Eight maxima of every eighth number each do not wait for one another.
fn largest_magnitude(numbers: &[f64]) -> f64 {
    let (blocks, rest) = numbers.as_chunks::<BLOCK>();
    let mut largest = [0.0_f64; BLOCK];
    for block in blocks {
        for (largest, number) in largest.iter_mut().zip(block) {
            // Not `max`, which has an answer for numbers that are none, and takes twice as long.
            *largest = if number.abs() > *largest { number.abs() } else { *largest };
        }
    }
    rest.iter().map(|number| number.abs()).chain(largest).fold(0.0, f64::max)
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

    #[test]
    fn the_scale_is_a_power_of_two_that_brings_the_largest_entry_between_one_and_two() {
        assert_eq!([0.0, 1.0, 1.999, 40.0, 0.3].map(power_of_two_below), [1.0, 1.0, 1.0, 32.0, 0.25]);
    }

    #[test]
    fn the_inputs_or_outputs_whichever_are_fewer_are_solved_for() {
        let model = |p, m| {
            let (a, b, c) = (dmatrix![-1.0], DMatrix::zeros(1, m), DMatrix::zeros(p, 1));
            HessenbergForm::of(Arch::new(), &StateSpace::new(a, b, c, DMatrix::zeros(p, m)).unwrap())
        };
        assert_eq!((model(6, 4).inputs(), model(6, 4).is_dual()), (4, false));
        assert_eq!((model(1, 3).inputs(), model(1, 3).is_dual()), (1, true));
    }

    #[test]
    fn a_model_of_one_state_and_no_reduction_is_its_own_system_matrix() {
        let model =
            StateSpace::new(dmatrix![-1.5], dmatrix![1.0, 1.5], dmatrix![4.0; 5.0], dmatrix![0.1, 0.2; 0.3, 0.4]);
        let form = HessenbergForm::of(Arch::new(), &model.unwrap());
        // The second input has the larger column of B.
        assert_eq!((form.gain(), form.pair(0, 1), form.pair(1, 0)), (1.5, Pair::new(1, 1), Pair::new(0, 0)));
        assert_eq!(form.complex_rows::<2>(0, 0), &[[-1.5, 0.0, 0.0], [1.0, 0.0, 0.0]]);
        assert_eq!(form.complex_rows::<2>(1, 0), &[[4.0, 5.0, 0.0], [0.1, 0.3, 0.0]]);
        assert_eq!(form.feed_through(0), &[0.2, 0.4, 0.0]);
    }

    #[test]
    fn next_rows_have_a_one_below_the_diagonal_and_the_first_input_reaches_one_state() {
        let a = dmatrix![1.0, 1.25, 0.5; 1.5, 1.75, -1.0; 0.25, 0.5, -0.75];
        let model = StateSpace::new(a, dmatrix![2.0; 3.0; 1.0], dmatrix![1.0, 1.0, 2.0], dmatrix![0.0]);
        let form = HessenbergForm::of(Arch::new(), &model.unwrap());
        let next = form.next_rows(0)[0];
        // A handful of roundings; there are two next rows.
        assert!((next[0][0] - 1.0).abs() < 1e-15 && (next[1][1] - 1.0).abs() < 1e-15);
        assert_eq!((next[1][0], next[2]), (0.0, [0.0; PANEL]));
        // |B| = sqrt(14), which a reflection keeps, over the power of two below 3.
        assert!((form.gain().abs() - 14.0_f64.sqrt() / 2.0).abs() < 1e-14);
    }
}
