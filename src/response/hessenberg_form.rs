//! A state-space model in the coordinates in which one frequency costs O(n^2).

use nalgebra::DMatrix;
use nalgebra::linalg::balancing;
use pulp::Arch;

use crate::dataset::StateSpace;

use super::householder_reduction::HouseholderReduction;
use super::system_table::{BLOCK, SystemTable};

/// Subdiagonal entries below this part the model in two; the largest entry is of order 1, and a double has 16 digits.
const NEGLIGIBLE: f64 = 1e-70;

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
    /// `[F B; C 0]`.
    table: SystemTable,
    /// One over each subdiagonal entry of F; zero where that is negligible.
    reciprocals: Vec<f64>,
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
        let reciprocals = (1..a.nrows()).map(|row| reciprocal(table.row(row)[row - 1])).collect();
        Self { sides: b.ncols(), dual, frequency_scale, table, reciprocals, d }
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

    /// Numbers in a row of `[F B]`, the zeros included that make it whole vectors.
    #[inline(always)]
    pub fn width(&self) -> usize {
        self.table.width()
    }

    /// Entries of row `row` of `[F B]` from column `first` on.
    #[inline(always)]
    pub fn entries<const N: usize>(&self, row: usize, first: usize) -> &[f64; N] {
        self.table.numbers()[row * self.width() + first..].first_chunk().expect("rows are whole blocks")
    }

    /// Row `row` of `[F B]`, with zeros up to the width.
    #[inline(always)]
    pub fn row(&self, row: usize) -> &[f64] {
        self.table.row(row)
    }

    /// One over each entry of F below the diagonal, column by column; zero where that is negligible.
    #[inline(always)]
    pub fn reciprocals(&self) -> &[f64] {
        &self.reciprocals
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
        for (from, entries) in matrix.column_iter().enumerate() {
            for (entry, value) in table.numbers_mut()[row * width..].chunks_exact_mut(width).zip(entries.iter()) {
                entry[column + from] = *value;
            }
        }
    }
    table
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
            *largest = largest.max(number.abs());
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

/// One over a subdiagonal entry, or zero where it is negligible.
fn reciprocal(subdiagonal: f64) -> f64 {
    if subdiagonal.abs() < NEGLIGIBLE { 0.0 } else { 1.0 / subdiagonal }
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
    fn a_row_is_a_row_of_f_followed_by_its_row_of_b_and_zeros() {
        let model =
            StateSpace::new(dmatrix![1.0, 1.25; 1.5, 1.75], dmatrix![2.0; 3.0], dmatrix![1.0, 1.0], dmatrix![0.0]);
        let form = HessenbergForm::of(Arch::new(), &model.unwrap());
        assert_eq!(form.row(1)[1..], [1.75, 3.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
        assert_eq!(form.reciprocals(), [1.0 / 1.5]);
    }
}
