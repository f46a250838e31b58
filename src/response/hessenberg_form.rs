//! A state-space model in the coordinates in which one frequency costs O(n^2).

use nalgebra::DMatrix;
use nalgebra::linalg::{Hessenberg, balancing};

use crate::dataset::StateSpace;

/// Subdiagonal entries below this part the model in two; the largest entry is of order 1, and a double has 16 digits.
const NEGLIGIBLE: f64 = 1e-70;

/// A model with its system matrix balanced, scaled, and reduced to upper Hessenberg form.
///
/// `H(j omega) = D - C Y`, `(F - j (omega / alpha) I) Y = B`, with F of n x n zero below its first subdiagonal, B of n x m
/// and C of p x n. Balancing (a diagonal similarity) makes the units of the states irrelevant; alpha, a power of two, brings
/// the largest entry of F to order 1; Householder reflections make F Hessenberg in `14/3 n^3` operations (Golub & Van Loan,
/// "Matrix Computations", 4th ed. 2013, 7.4.2 and 7.5.7). A model with fewer outputs than inputs is held as its dual
/// `(A', C', B', D')`, whose response is the transpose: the work at each frequency grows with the columns of B.
#[derive(Clone, Debug)]
pub struct HessenbergForm {
    order: usize,
    sides: usize,
    dual: bool,
    frequency_scale: f64,
    /// `[F B]`, row by row.
    rows: Vec<f64>,
    /// One over each subdiagonal entry of F; zero where that is negligible.
    reciprocals: Vec<f64>,
    /// C, row by row.
    c: Vec<f64>,
    d: DMatrix<f64>,
}

impl HessenbergForm {
    /// The reduced form of a model.
    pub fn of(model: &StateSpace) -> Self {
        let dual = model.outputs() < model.inputs();
        let (mut a, mut b, mut c, d) = if dual {
            let [a, b, c, d] = [model.a(), model.c(), model.b(), model.d()].map(DMatrix::transpose);
            (a, b, c, d)
        } else {
            (model.a().clone(), model.b().clone(), model.c().clone(), model.d().clone())
        };
        balance(&mut a, &mut b, &mut c);
        let frequency_scale = 1.0 / power_of_two_below(a.amax());
        a *= frequency_scale;
        b *= frequency_scale;
        if a.nrows() > 2 {
            let (q, f) = Hessenberg::new(a).unpack();
            (a, b, c) = (f, q.tr_mul(&b), c * q);
        }
        let (order, sides) = b.shape();
        let mut rows = DMatrix::zeros(order + sides, order);
        rows.rows_mut(0, order).copy_from(&a.transpose());
        rows.rows_mut(order, sides).copy_from(&b.transpose());
        Self {
            order,
            sides,
            dual,
            frequency_scale,
            rows: rows.as_slice().to_vec(),
            reciprocals: (1..order).map(|row| reciprocal(a[(row, row - 1)])).collect(),
            c: c.transpose().as_slice().to_vec(),
            d,
        }
    }

    /// Number of states, `n`.
    #[inline(always)]
    pub fn order(&self) -> usize {
        self.order
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

    /// Row `row` of `[F B]` from the diagonal of F on.
    #[inline(always)]
    pub fn row_from_diagonal(&self, row: usize) -> &[f64] {
        let width = self.order + self.sides;
        &self.rows[row * width + row..(row + 1) * width]
    }

    /// One over the entry of F below the diagonal in `column`; `None` where it is negligible.
    #[inline(always)]
    pub fn subdiagonal_reciprocal(&self, column: usize) -> Option<f64> {
        let reciprocal = self.reciprocals[column];
        (reciprocal != 0.0).then_some(reciprocal)
    }

    /// Row `row` of C.
    #[inline(always)]
    pub fn c_row(&self, row: usize) -> &[f64] {
        &self.c[row * self.order..(row + 1) * self.order]
    }

    /// The entry of D in a row, for one right-hand side.
    #[inline(always)]
    pub fn d(&self, row: usize, side: usize) -> f64 {
        self.d[(row, side)]
    }
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
            HessenbergForm::of(&StateSpace::new(a, b, c, DMatrix::zeros(p, m)).unwrap())
        };
        assert_eq!((model(6, 4).sides(), model(6, 4).is_dual()), (4, false));
        assert_eq!((model(1, 3).sides(), model(1, 3).is_dual()), (1, true));
    }

    #[test]
    fn a_row_is_the_rest_of_a_row_of_f_followed_by_its_row_of_b() {
        let model =
            StateSpace::new(dmatrix![1.0, 1.25; 1.5, 1.75], dmatrix![2.0; 3.0], dmatrix![1.0, 1.0], dmatrix![0.0]);
        let form = HessenbergForm::of(&model.unwrap());
        assert_eq!(form.row_from_diagonal(1), [1.75, 3.0]);
        assert_eq!(form.subdiagonal_reciprocal(0), Some(1.0 / 1.5));
    }
}
