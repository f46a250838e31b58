//! A state-space model in the coordinates in which one frequency costs O(n^2).

use nalgebra::DMatrix;
use nalgebra::linalg::balancing;
use pulp::Arch;

use crate::dataset::StateSpace;

use super::householder_reduction::HouseholderReduction;
use super::subdiagonal::Subdiagonal;
use super::system_table::{BLOCK, SystemTable};

/// Columns that elimination computes at once.
pub const PANEL: usize = 4;

/// A model with its system matrix balanced, scaled, and reduced to upper Hessenberg form.
///
/// `H(j omega) = D - C Y`, `(F - j (omega / alpha) I) Y = B`, with F of n x n zero below its first subdiagonal, B of n
/// x m and C of p x n. Balancing (a diagonal similarity) makes the units of the states irrelevant; alpha, a power of
/// two, brings the largest entry of F to order 1; Householder reflections make F Hessenberg. A model with fewer outputs
/// than inputs is held as its dual `(A', C', B', D')`, whose response is the transpose: the work at each frequency
/// grows with the columns of B.
#[derive(Clone, Debug)]
pub struct HessenbergForm {
    sides: usize,
    dual: bool,
    frequency_scale: f64,
    /// `[F B; C 0]`, each row of F but the first divided by its subdiagonal entry.
    table: SystemTable,
    /// One for each column but the last.
    subdiagonals: Vec<Subdiagonal>,
    /// The divided rows, panel by panel of their columns.
    panels: Vec<[f64; PANEL]>,
    d: DMatrix<f64>,
}

impl HessenbergForm {
    /// The reduced form of a model: the same bits on every instruction set, on which only the time depends.
    pub fn of(arch: Arch, model: &StateSpace) -> Self {
        let dual = model.outputs() < model.inputs();
        let matrices = [model.a(), model.b(), model.c(), model.d()];
        let [mut a, mut b, mut c, d] = if dual {
            let [a, b, c, d] = matrices.map(DMatrix::transpose);
            [a, c, b, d]
        } else {
            matrices.map(DMatrix::clone)
        };
        balance(&mut a, &mut b, &mut c);
        let frequency_scale = 1.0 / power_of_two_below(largest_magnitude(a.as_slice()));
        a *= frequency_scale;
        b *= frequency_scale;
        let mut table = table(&a, &b, &c);
        arch.dispatch(HouseholderReduction(&mut table));
        let subdiagonals = divide_rows(&mut table);
        let panels = panels(&table);
        Self { sides: b.ncols(), dual, frequency_scale, table, subdiagonals, panels, d }
    }

    /// Number of states, `n`.
    #[inline(always)]
    pub fn order(&self) -> usize {
        self.table.states()
    }

    /// Number of right-hand sides, the columns of B.
    #[inline(always)]
    pub fn sides(&self) -> usize {
        self.sides
    }

    /// Number of rows of C.
    #[inline(always)]
    pub fn outputs(&self) -> usize {
        self.d.nrows()
    }

    /// Whether this is the dual: rows of C then belong to inputs and columns of B to outputs.
    #[inline(always)]
    pub fn is_dual(&self) -> bool {
        self.dual
    }

    /// `1 / alpha`.
    #[inline(always)]
    pub fn frequency_scale(&self) -> f64 {
        self.frequency_scale
    }

    /// The entry below the diagonal in each column but the last.
    #[inline(always)]
    pub fn subdiagonals(&self) -> &[Subdiagonal] {
        &self.subdiagonals
    }

    /// The panel of the first row of `[F B]` that begins in column `first`.
    #[inline(always)]
    pub fn first_row(&self, first: usize) -> &[f64; PANEL] {
        &self.table.row(0).as_chunks().0[first / PANEL]
    }

    /// The row that has a one below the diagonal of `column`, right of that: its entries of F and those of B.
    #[inline(always)]
    pub fn unit_row(&self, column: usize) -> (&[f64], &[f64]) {
        let (order, row) = (self.order(), self.table.row(column + 1));
        (&row[column + 1..order], &row[order..order + self.sides])
    }

    /// Panels of columns of `[F B]`.
    #[inline(always)]
    pub fn panels(&self) -> usize {
        self.table.width() / PANEL
    }

    /// The columns from `first` on of all rows of [`unit_row`](Self::unit_row).
    #[inline(always)]
    pub fn panel(&self, first: usize) -> &[[f64; PANEL]] {
        let rows = self.subdiagonals.len();
        &self.panels[first / PANEL * rows..][..rows]
    }

    /// Row `row` of C.
    #[inline(always)]
    pub fn c_row(&self, row: usize) -> &[f64] {
        &self.table.row(self.order() + row)[..self.order()]
    }

    /// The entry of D in a row, for one right-hand side.
    #[inline(always)]
    pub fn d(&self, row: usize, side: usize) -> f64 {
        self.d[(row, side)]
    }
}

/// `[A B; C 0]`.
fn table(a: &DMatrix<f64>, b: &DMatrix<f64>, c: &DMatrix<f64>) -> SystemTable {
    let mut table = SystemTable::zeros(a.nrows(), b.ncols(), c.nrows());
    for (matrix, row, column) in [(a, 0, 0), (b, 0, a.ncols()), (c, a.nrows(), 0)] {
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

/// Divides each row but the first by its subdiagonal entry.
fn divide_rows(table: &mut SystemTable) -> Vec<Subdiagonal> {
    let (order, width) = (table.states(), table.width());
    let rows = table.numbers_mut().chunks_exact_mut(width).take(order).enumerate().skip(1);
    let divide = |(row, numbers): (usize, &mut [f64])| {
        let subdiagonal = Subdiagonal::new(numbers[row - 1], order);
        numbers.iter_mut().for_each(|number| *number *= subdiagonal.reciprocal);
        subdiagonal
    };
    rows.map(divide).collect()
}

/// All rows but the first of `[A B]`, panel by panel of their columns.
fn panels(table: &SystemTable) -> Vec<[f64; PANEL]> {
    let mut panels = Vec::with_capacity(table.states() * table.width() / PANEL);
    for panel in 0..table.width() / PANEL {
        panels.extend((1..table.states()).map(|row| table.row(row).as_chunks().0[panel]));
    }
    panels
}

/// Makes rows and columns of `a` alike in norm by a diagonal similarity of powers of two, so that nothing is rounded.
fn balance(a: &mut DMatrix<f64>, b: &mut DMatrix<f64>, c: &mut DMatrix<f64>) {
    if a.nrows() < 2 {
        return;
    }
    let scale = balancing::balance_parlett_reinsch(a);
    for (state, &scale) in scale.iter().enumerate() {
        b.row_mut(state).scale_mut(1.0 / scale);
        c.column_mut(state).scale_mut(scale);
    }
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
    fn the_side_with_fewer_channels_is_solved_for() {
        let model = |p, m| {
            let (a, b, c) = (dmatrix![-1.0], DMatrix::zeros(1, m), DMatrix::zeros(p, 1));
            HessenbergForm::of(Arch::new(), &StateSpace::new(a, b, c, DMatrix::zeros(p, m)).unwrap())
        };
        assert_eq!((model(6, 4).sides(), model(6, 4).is_dual()), (4, false));
        assert_eq!((model(1, 3).sides(), model(1, 3).is_dual()), (1, true));
    }

    #[test]
    fn rows_are_divided_by_their_subdiagonal_entry() {
        let model =
            StateSpace::new(dmatrix![1.0, 1.25; 1.5, 1.75], dmatrix![2.0; 3.0], dmatrix![1.0, 1.0], dmatrix![0.0]);
        let form = HessenbergForm::of(Arch::new(), &model.unwrap());
        assert_eq!(form.first_row(0), &[1.0, 1.25, 2.0, 0.0]);
        assert_eq!(form.unit_row(0), (&[1.75 * (1.0 / 1.5)][..], &[3.0 * (1.0 / 1.5)][..]));
        assert_eq!(form.panel(0), [[1.0, 1.75 * (1.0 / 1.5), 3.0 * (1.0 / 1.5), 0.0]]);
        assert_eq!(form.subdiagonals()[0].entry, 1.5);
    }
}
