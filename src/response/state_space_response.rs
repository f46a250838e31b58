//! The frequency response of a state-space model, by Hessenberg reduction.

use nalgebra::linalg::{Hessenberg, balancing};
use nalgebra::{Complex, DMatrix};

use crate::dataset::{PairTable, StateSpace};

/// `H(j omega) = C (j omega I - A)^-1 B + D` at each `omega` \[rad/s\]: a p x m table of `N` values.
///
/// `A` is balanced (a diagonal similarity, so that the units of the states do not matter), reduced once to upper Hessenberg
/// form `A = T F T^-1` in O(n^3), and for each frequency `(j omega I - F) X = T^-1 B` is solved by Gaussian elimination with
/// row exchanges in O(n^2 m); then `H = (C T) X + D`. Laub, "Efficient multivariable frequency response computations",
/// IEEE Trans. Automatic Control 26(2), 1981. Where `j omega` is a pole the values are not finite.
pub fn evaluate(model: &StateSpace, omega: &[f64]) -> PairTable<Vec<Complex<f64>>> {
    let (p, m) = (model.outputs(), model.inputs());
    let reduced = HessenbergForm::of(model);
    let mut table = PairTable::from_fn(p, m, |_| Vec::with_capacity(omega.len()));
    let mut workspace = Workspace::of(&reduced);
    for &omega in omega {
        workspace.solve(&reduced, omega);
        for (pair, values) in table.iter_mut() {
            let mut sum = Complex::new(model.d()[(pair.output, pair.input)], 0.0);
            let solution = workspace.solution(pair.input);
            for (c, x) in reduced.c.row(pair.output).iter().zip(solution) {
                sum += x * *c;
            }
            values.push(sum);
        }
    }
    table
}

/// The model in balanced coordinates with an upper Hessenberg system matrix.
struct HessenbergForm {
    /// F, n x n, zero below the first subdiagonal.
    f: DMatrix<f64>,
    /// T^-1 B, n x m.
    b: DMatrix<f64>,
    /// C T, p x n.
    c: DMatrix<f64>,
}

impl HessenbergForm {
    fn of(model: &StateSpace) -> Self {
        let (mut a, mut b, mut c) = (model.a().clone(), model.b().clone(), model.c().clone());
        if model.order() < 2 {
            return Self { f: a, b, c };
        }
        // `a` becomes S^-1 A S; the entries of S are powers of two, so nothing is rounded.
        let scale = balancing::balance_parlett_reinsch(&mut a);
        for (state, &s) in scale.iter().enumerate() {
            b.row_mut(state).scale_mut(1.0 / s);
            c.column_mut(state).scale_mut(s);
        }
        let (q, f) = Hessenberg::new(a).unpack();
        Self { b: q.transpose() * b, c: c * q, f }
    }
}

/// What one frequency needs, kept from one to the next.
struct Workspace {
    order: usize,
    inputs: usize,
    /// Rows of `j omega I - F` under elimination, row-major.
    rows: Vec<Complex<f64>>,
    /// Right-hand sides, then the solution, one column of length n for each input.
    columns: Vec<Complex<f64>>,
}

impl Workspace {
    fn of(reduced: &HessenbergForm) -> Self {
        let (order, inputs) = reduced.b.shape();
        let zero = Complex::new(0.0, 0.0);
        Self { order, inputs, rows: vec![zero; order * order], columns: vec![zero; order * inputs] }
    }

    fn solution(&self, input: usize) -> &[Complex<f64>] {
        &self.columns[input * self.order..(input + 1) * self.order]
    }

    fn solve(&mut self, reduced: &HessenbergForm, omega: f64) {
        self.load(reduced, omega);
        for pivot in 0..self.order.saturating_sub(1) {
            self.eliminate(pivot);
        }
        for input in 0..self.inputs {
            self.substitute_back(input);
        }
    }

    fn load(&mut self, reduced: &HessenbergForm, omega: f64) {
        let n = self.order;
        for row in 0..n {
            for column in row.saturating_sub(1)..n {
                self.rows[row * n + column] = Complex::new(-reduced.f[(row, column)], 0.0);
            }
            self.rows[row * n + row].im = omega;
        }
        for (value, b) in self.columns.iter_mut().zip(reduced.b.iter()) {
            *value = Complex::new(*b, 0.0);
        }
    }

    /// Clears the one entry below the diagonal of column `pivot`, the larger of the two candidates on the diagonal.
    fn eliminate(&mut self, pivot: usize) {
        let n = self.order;
        let (above, below) = self.rows.split_at_mut((pivot + 1) * n);
        let (upper, lower) = (&mut above[pivot * n + pivot..], &mut below[pivot..n]);
        let exchange = lower[0].l1_norm() > upper[0].l1_norm();
        if exchange {
            upper.swap_with_slice(lower);
        }
        if lower[0] == Complex::new(0.0, 0.0) {
            return;
        }
        let factor = lower[0] / upper[0];
        for (lower, upper) in lower[1..].iter_mut().zip(&upper[1..]) {
            *lower -= factor * upper;
        }
        for column in self.columns.chunks_exact_mut(n) {
            if exchange {
                column.swap(pivot, pivot + 1);
            }
            let known = column[pivot];
            column[pivot + 1] -= factor * known;
        }
    }

    fn substitute_back(&mut self, input: usize) {
        let n = self.order;
        let column = &mut self.columns[input * n..(input + 1) * n];
        for row in (0..n).rev() {
            let mut sum = column[row];
            for (entry, known) in self.rows[row * n + row + 1..(row + 1) * n].iter().zip(&column[row + 1..]) {
                sum -= entry * known;
            }
            column[row] = sum / self.rows[row * n + row];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::dmatrix;

    fn siso(a: DMatrix<f64>, b: DMatrix<f64>, c: DMatrix<f64>, d: f64) -> StateSpace {
        StateSpace::new(a, b, c, dmatrix![d]).unwrap()
    }

    fn only(table: PairTable<Vec<Complex<f64>>>) -> Complex<f64> {
        table.iter().next().unwrap().1[0]
    }

    #[test]
    fn a_first_order_lag_has_its_known_response() {
        // 1 / (j omega + 2) at omega = 3: (2 - 3j) / 13.
        let value = only(evaluate(&siso(dmatrix![-2.0], dmatrix![1.0], dmatrix![1.0], 0.0), &[3.0]));
        assert!((value - Complex::new(2.0 / 13.0, -3.0 / 13.0)).norm() < 1e-16);
    }

    #[test]
    fn a_model_of_order_zero_is_its_feed_through() {
        let empty = siso(DMatrix::zeros(0, 0), DMatrix::zeros(0, 1), DMatrix::zeros(1, 0), 2.5);
        assert_eq!(only(evaluate(&empty, &[1.0])), Complex::new(2.5, 0.0));
    }

    #[test]
    fn an_undamped_oscillator_at_its_own_frequency_is_not_finite() {
        let oscillator = siso(dmatrix![0.0, 1.0; -4.0, 0.0], dmatrix![0.0; 1.0], dmatrix![1.0, 0.0], 0.0);
        assert!(!only(evaluate(&oscillator, &[2.0])).is_finite());
    }

    #[test]
    fn units_of_the_states_do_not_matter() {
        let (a, b, c) = (dmatrix![-1.0, 2.0; -3.0, -0.5], dmatrix![1.0; 0.5], dmatrix![1.0, -2.0]);
        let scale = DMatrix::from_diagonal(&nalgebra::dvector![1e-9, 1e9]);
        let inverse = DMatrix::from_diagonal(&nalgebra::dvector![1e9, 1e-9]);
        let plain = only(evaluate(&siso(a.clone(), b.clone(), c.clone(), 0.1), &[1.3]));
        let scaled = only(evaluate(&siso(&scale * a * &inverse, scale * b, c * inverse, 0.1), &[1.3]));
        // The scaling itself rounds each entry once.
        assert!((plain - scaled).norm() < 1e-14 * plain.norm());
    }
}
